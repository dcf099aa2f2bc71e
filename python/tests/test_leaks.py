"""Nothing is kept that nobody has: memory that the process holds, after much of the same."""

import copy
import ctypes
import gc
import os
import pickle

import numpy as np
import pytest
from common import AUTORESETS, PERTURBED

import libration
from libration.policies import MLP, Random

STATM = "/proc/self/statm"

# An allocator keeps some pages and gives back others, and a first thread has an arena of its own:
# that comes to some 400 kB whatever is done. What is looked for comes again with every turn.
ROOM = 1 << 20


def trim():
    """Give back to the system what is not in use, where the C library can."""
    give_back = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if give_back is not None:
        give_back(0)


def held():
    """Bytes of this process that are in memory."""
    gc.collect()
    # What others of the tests gave back is not to hide what is taken here.
    trim()
    with open(STATM) as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def grown(work, turns):
    """How much more is held after so many turns, before which some fill what is filled once."""
    for turn in range(turns // 10):
        work(turn)
    before = held()
    for turn in range(turns):
        work(turn)
    return held() - before


@pytest.fixture(autouse=True)
def only_new_objects_are_collected():
    """Let collections skip what earlier tests have imported, which takes a fifth of a second each time."""
    gc.freeze()
    yield
    gc.unfreeze()


needs_memory = pytest.mark.skipif(
    not os.path.exists(STATM), reason="no account of memory on this platform"
)


@needs_memory
def test_the_account_of_memory_tells_of_a_leak():
    kept = []
    assert grown(lambda _: kept.append(bytearray(4096)), 1000) > ROOM


@needs_memory
def test_a_quarter_of_a_million_steps_leak_nothing():
    # One lost pointer a step would be 2 MB, twice the room. All that a step can tell is told: what ended, what was
    # seen last, what was lost.
    envs = libration.Environments(
        "Duffing", 1, autoreset_mode="SameStep", max_episode_steps=5, max_action=1e30, bound=np.inf
    )
    envs.reset(seed=0)
    actions = [np.full((1, 1), action, np.float32) for action in (0.5, 0.1, -0.5, 1e30)]
    step, told = envs.step, 0
    for t in range(10_000):
        told += len(step(actions[t & 3])[4])
    assert told > 1000
    before = held()
    for t in range(250_000):
        step(actions[t & 3])
    assert held() - before < ROOM


@needs_memory
def test_steps_of_arrays_that_are_used_again_or_converted_leak_nothing():
    # An array of rewards that was lost in every turn would be 2000 of 4 kB, eight times the room.
    envs = libration.Environments("Pendulum", 1000, copy=False, buffers=3)
    envs.reset(seed=0)
    given = [np.zeros(1000), np.zeros(1000, np.int8), memoryview(np.zeros(1000, np.float32))]
    assert grown(lambda turn: envs.step(given[turn % 3]), 2000) < ROOM


@needs_memory
def test_what_is_refused_leaks_nothing():
    envs = libration.Environments("Pendulum", 500)
    envs.reset(seed=0)
    policy, nan = MLP([(np.ones((1, 2)), np.ones(1))]), np.full(500, np.nan, np.float32)

    def work(_):
        for use in (
            lambda: envs.step(nan),
            lambda: envs.step([0.0]),
            lambda: envs.reset(seed=-1),
            lambda: envs.rollout(policy, 5),
            lambda: envs._restore((bytes(1000), False, bytes(500))),
            lambda: libration.Environments("Pendulum", 500, omega2=-1.0),
        ):
            with pytest.raises(ValueError):
                use()

    # A kilobyte is what any of them would lose at least.
    assert grown(work, 3000) < ROOM


@needs_memory
@pytest.mark.parametrize("close", [True, False], ids=["closed", "forgotten"])
def test_four_hundred_constructions_leak_nothing(close):
    def work(turn):
        given = {} if turn % 2 else PERTURBED
        envs = libration.VectorEnv(
            "Pendulum",
            64,
            autoreset_mode=AUTORESETS[turn % 3],
            threads=1 + turn % 2,
            copy=turn % 5 > 0,
            **given,
        )
        envs.reset(seed=turn)
        envs.step(np.zeros(64, np.float32))
        if close:
            envs.close()

    # One of them is of 5 kB at least, besides its threads: 2 MB, twice the room.
    assert grown(work, 400) < ROOM


@needs_memory
def test_rollouts_and_copies_leak_nothing():
    envs = libration.Environments("Oscillator", 64, max_episode_steps=7, autoreset_mode="SameStep")
    envs.reset(seed=0)
    again = envs.rollout(Random(-1, 1), 20)
    values = np.zeros(64)

    def work(_):
        found = envs.rollout(Random(-1, 1), 20, values=True, log_probs=True)
        found.values[:] = 0.0
        found.advantages(last_values=values, final_values=np.zeros(len(found.episodes["steps"])))
        found.transitions.sum()
        envs.rollout(Random(-1, 1), 20, out=again)
        for other in (pickle.loads(pickle.dumps(envs)), copy.deepcopy(envs), copy.copy(envs)):
            other.step(values)

    # A rollout is of 40 kB, and a copy of 5: 2 MB at least, twice the room.
    assert grown(work, 400) < ROOM


def test_arrays_outlive_their_environments_and_what_is_made_after_them():
    arrays, values = [], []
    for turn in range(30):
        envs = libration.Environments(
            "Pendulum", 300, copy=turn % 2 == 0, max_episode_steps=3, autoreset_mode="SameStep"
        )
        seen, _ = envs.reset(seed=turn)
        for _ in range(3):
            *step, infos = envs.step(np.ones(300))
        found = envs.rollout(Random(-1, 1), 7, values=True)
        of_rollout = [found.observations, found.rewards, found.terminated, found.values]
        final = [infos["final_obs"][7], found.last_observations, found.episodes["returns"]]
        held = [*step, *of_rollout, *final, envs.states]
        found.values[:] = turn
        arrays += held
        values += [array.copy() for array in held]
        if turn % 3:
            envs._close()
        del envs, found, seen, step, of_rollout, final, infos, held
        gc.collect()
    # Others take the memory that was given back.
    others = [libration.Environments("Duffing", 300) for _ in range(100)]
    for other in others:
        other.reset(seed=1)
        other.rollout(Random(-1, 1), 7)
    for array, wanted in zip(arrays, values, strict=True):
        np.testing.assert_array_equal(array, wanted)
