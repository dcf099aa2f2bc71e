"""The contract of Gymnasium's vector environments."""

import copy
import functools
import gc
import os
import pickle
import threading

import gymnasium
import numpy as np
import pytest
from common import AUTORESETS, IDS, NAMES, PERTURBED, Lent
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.utils import performance
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import libration


def made(name, num_envs, mode="NextStep", **given):
    return gymnasium.make_vec(IDS[name], num_envs, autoreset_mode=mode, **given)


# Positions have no bounds, and accelerations a unit.
@pytest.mark.filterwarnings("ignore:.*Box observation space.*:UserWarning")
@pytest.mark.filterwarnings("ignore:.*For Box action spaces.*:UserWarning")
@pytest.mark.parametrize("name", NAMES)
def test_the_checker_of_gymnasium_has_nothing_to_say(name):
    env = gymnasium.make(IDS[name], render_mode="rgb_array")
    check_env(env.unwrapped)
    env.close()


@pytest.mark.skipif(
    not hasattr(performance, "benchmark_vector_step"), reason="this Gymnasium has no such benchmark"
)
@pytest.mark.parametrize("mode", AUTORESETS)
@pytest.mark.parametrize("name", NAMES)
def test_the_benchmark_of_gymnasium_takes_far_more_steps_of_a_thousand_than_of_one(name, mode):
    many = made(name, 1000, mode)
    together = performance.benchmark_vector_step(many, target_duration=0.05, seed=0)
    alone = performance.benchmark_step(gymnasium.make(IDS[name]), 0.05, seed=0)
    # A thousand are stepped in one call: a small part of that is left whatever else the machine does.
    assert together > 20 * alone


@pytest.mark.parametrize("perturbed", [{}, PERTURBED], ids=["ideal", "perturbed"])
@pytest.mark.parametrize("mode", AUTORESETS)
@pytest.mark.parametrize("name", NAMES)
def test_trajectories_are_those_of_single_environments_side_by_side(name, mode, perturbed):
    limits = dict(max_episode_steps=17, start_position=(-1.0, 1.0), **perturbed)
    if name != "Pendulum":
        limits["bound"] = 1.1
    ours = made(name, 5, mode, **limits)
    theirs = SyncVectorEnv(
        [lambda: gymnasium.make(IDS[name], **limits)] * 5,
        autoreset_mode=AutoresetMode(mode),
    )
    rng = np.random.default_rng(3)
    # Once under one seed, then as it goes on, then with a seed for some.
    masks = [{}, {}, {"options": {"reset_mask": np.array([True, False, True, False, True])}}]
    for seed, options in zip([11, None, [5, None, None, 9, 2]], masks):
        # SyncVectorEnv takes the mask out of the dictionary.
        copied = [{key: dict(value) for key, value in options.items()} for _ in range(2)]
        found, infos = ours.reset(seed=seed, **copied[0])
        wanted, wanted_infos = theirs.reset(seed=seed, **copied[1])
        np.testing.assert_array_equal(found, wanted)
        assert infos == wanted_infos == {}
        ended = 0
        for _ in range(60):
            actions = rng.uniform(-1, 1, (5, 1)).astype(np.float32) * ours.single_action_space.high
            found, wanted = ours.step(actions), theirs.step(actions)
            for mine, other in zip(found[:4], wanted[:4]):
                np.testing.assert_array_equal(mine, other)
                assert mine.shape == other.shape
            done = found[2] | found[3]
            ended += done.sum()
            same_infos(found[4], wanted[4])
            if mode == "Disabled" and done.any():
                mask = {"reset_mask": done}
                found, wanted = ours.reset(options=dict(mask)), theirs.reset(options=dict(mask))
                np.testing.assert_array_equal(found[0], wanted[0])
        assert ended >= 15
    ours.close()
    theirs.close()


def same_infos(found, wanted):
    """What is told is the same; where nothing is told of an environment, it does not matter what stands there."""
    assert sorted(found) == sorted(wanted)
    for key in found:
        if isinstance(found[key], dict):
            same_infos(found[key], wanted[key])
        elif found[key].dtype == object:
            for mine, other in zip(found[key], wanted[key]):
                np.testing.assert_array_equal(mine, other)
        else:
            np.testing.assert_array_equal(found[key], wanted[key])


@pytest.mark.parametrize("mode", AUTORESETS)
def test_a_spec_makes_an_equal_environment(mode):
    env = made("Pendulum", 3, mode, action_delay=0.05, jitter=("gaussian", 0.05))
    assert env.metadata["autoreset_mode"] is AutoresetMode(mode)
    other = gymnasium.make_vec(env.spec)
    assert other.num_envs == 3 and other.metadata == env.metadata and other.spec == env.spec
    actions = np.ones((3, 1), np.float32)
    np.testing.assert_array_equal(env.reset(seed=2)[0], other.reset(seed=2)[0])
    for mine, same in zip(env.step(actions), other.step(actions)):
        np.testing.assert_array_equal(mine, same)


def test_the_call_of_the_readme_makes_what_it_says():
    env = gymnasium.make_vec(
        "libration/Oscillator-v0",
        num_envs=4096,
        integrator="velocity-verlet",
        action_delay=0.015,
        jitter=("gaussian", 0.05),
        skew=("uniform", 0.001),
    )
    observations, _ = env.reset(seed=0)
    assert observations.shape == (4096, 2) and observations.dtype == np.float32
    assert env.observation_space.contains(observations)
    for _ in range(3):
        observations, rewards, terminated, truncated, infos = env.step(env.action_space.sample())
    assert rewards.shape == terminated.shape == truncated.shape == (4096,) and infos == {}
    assert terminated.dtype == truncated.dtype == np.bool_
    assert (rewards <= 0).all()


def test_an_environment_is_the_same_beside_any_number_of_others_and_on_any_number_of_threads():
    def run(num_envs, threads, mode):
        env = made("Pendulum", num_envs, mode, threads=threads, max_episode_steps=13, **PERTURBED)
        seen = [env.reset(seed=7)[0][:3].copy()]
        for t in range(40):
            observations, _, terminated, truncated, _ = env.step(np.full((num_envs, 1), 0.5 * (t % 13)))
            done = terminated | truncated
            if mode == "Disabled" and done.any():
                observations, _ = env.reset(options={"reset_mask": done})
            # What is seen where nothing moves is seen again.
            if not (mode == "NextStep" and done[0]):
                seen.append(observations[:3].copy())
        return np.array(seen[:36])

    wanted = run(3, 1, "SameStep")
    for num_envs, threads in [(64, 1), (70, 2), (5000, 2)]:
        np.testing.assert_array_equal(run(num_envs, threads, "SameStep"), wanted)
    np.testing.assert_array_equal(run(3, 1, "Disabled"), wanted)


@pytest.mark.parametrize(
    ("given", "error", "said"),
    [
        (dict(intergrator="rk4"), TypeError, "intergrator.*did you mean 'integrator'"),
        (dict(integrator="verlet"), ValueError, "unknown integrator `verlet`: did you mean `velocity-verlet`"),
        (dict(action_delay=-0.1), ValueError, "action_delay is -0.1, but it must be finite and at least 0"),
        (dict(action_delay=(0.0, np.pi)), ValueError, "action_delay is from 0.0 to 3.14.* but it must be whole steps"),
        (dict(dt=0.0), ValueError, "dt is 0.0, but it must be finite and greater than 0"),
        (dict(dt="fast"), TypeError, "dt must be a number, not str"),
        (dict(jitter=("normal", 0.1)), ValueError, "law of jitter is 'normal'"),
        (dict(skew=-1), ValueError, "skew is -1.0"),
        (dict(omega2=-1.0), ValueError, "omega2"),
        (dict(dtype="int8"), ValueError, "unknown dtype `int8`"),
        (dict(autoreset_mode="Never"), ValueError, "autoreset_mode is 'Never'"),
        (dict(max_episode_steps=0), ValueError, "max_episode_steps is 0, but it must be 1 to"),
        (dict(num_envs=0), ValueError, "num_envs is 0"),
        (dict(start_position=(1.0, -1.0)), ValueError, "start_position is from 1.0 to -1.0"),
        (dict(render_mode="human"), ValueError, "render_mode is 'human'"),
        (dict(threads=-1), ValueError, "threads is -1"),
        (dict(num_envs=2**40), MemoryError, "memory"),
    ],
)
def test_what_cannot_be_is_refused_with_its_name_and_what_is_allowed(given, error, said):
    with pytest.raises(error, match=said):
        libration.VectorEnv("Pendulum", **given)


@pytest.mark.parametrize(
    ("actions", "error", "said"),
    [
        (np.zeros((2, 1)), ValueError, r"shape \(2, 1\), but it must be \(3, 1\)"),
        (np.zeros((3, 2)), ValueError, "shape"),
        (0.0, ValueError, "shape"),
        (np.array([0.0, np.nan, 0.0]), ValueError, r"actions\[1\] is NaN, but it must be finite"),
        (np.array([0.0, 0.0, -np.inf]), ValueError, r"actions\[2\] is -inf"),
        (np.array([None] * 3), TypeError, "dtype object"),
        (np.zeros((3, 1), complex), TypeError, "dtype complex128"),
        (["a", "b", "c"], TypeError, "dtype"),
        (np.ma.masked_array([1.0, 2.0, 3.0], [0, 1, 0]), TypeError, "masked"),
        (np.ma.masked_array(np.ones(3, np.float32), [0, 1, 0]), TypeError, "masked"),
    ],
)
def test_actions_that_cannot_be_are_refused_and_nothing_has_moved(actions, error, said):
    env = made("Oscillator", 3)
    env.reset(seed=1)
    before = env.states
    with pytest.raises(error, match=said):
        env.step(actions)
    np.testing.assert_array_equal(env.states, before)


class Unknown(Lent):
    """The same of a type that NumPy has not, as bfloat16."""

    def __dlpack__(self, **given):
        raise RuntimeError("Unsupported dtype in DLTensor.")


@pytest.mark.parametrize(
    "integrator",
    "explicit-euler symplectic-euler symplectic-euler-drift-first velocity-verlet textbook-verlet leapfrog rk4 yoshida4 suzuki4".split(),
)
def test_every_integrator_is_one(integrator):
    env = made("Oscillator", 2, integrator=integrator)
    env.reset(seed=0)
    assert np.isfinite(env.step(np.zeros(2))[0]).all()


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_actions_are_taken_from_whatever_holds_them(dtype):
    def stepped(actions):
        env = made("Oscillator", 3, dtype=dtype)
        env.reset(seed=1)
        return env.step(actions)[0]

    wanted = stepped(np.array([[1.0], [-2.0], [3.0]], np.float32))
    for actions in [
        np.array([1, -2, 3]),
        [1.0, -2.0, 3.0],
        np.array([[1.0, 9], [-2.0, 9], [3.0, 9]])[:, :1],
        np.array([3, -2, 1], np.float32)[::-1],
        memoryview(np.array([1.0, -2.0, 3.0])),
        Lent(np.array([1.0, -2.0, 3.0], np.float32)),
        Lent(np.array([1.0, -2.0, 3.0])),
    ]:
        np.testing.assert_array_equal(stepped(actions), wanted)
    with pytest.raises(TypeError, match="a type that NumPy has not"):
        stepped(Unknown(np.array([1, -2, 3])))
    locked = np.array([1, -2, 3], np.float32)
    locked.flags.writeable = False
    np.testing.assert_array_equal(stepped(locked), wanted)
    for narrow in [np.array([1, -np.inf, 3], np.float32), np.array([[1], [np.nan], [3]], np.float32)]:
        with pytest.raises(ValueError, match=r"actions\[1\] is (-inf|NaN), but it must be finite"):
            stepped(narrow)


@pytest.mark.parametrize("mode", AUTORESETS)
def test_a_copy_goes_on_as_the_original_does(mode):
    env = made("Duffing", 6, mode, max_episode_steps=9, bound=1.2, **PERTURBED)
    env.reset(seed=4)
    actions = np.linspace(-0.5, 0.5, 6, dtype=np.float32)[:, None]

    def go_on(env, steps):
        seen = []
        for _ in range(steps):
            observations, rewards, terminated, truncated, _ = env.step(actions)
            seen.append(np.column_stack([observations, rewards, terminated, truncated]))
            if mode == "Disabled" and (terminated | truncated).any():
                env.reset(options={"reset_mask": terminated | truncated})
        return np.array(seen)

    go_on(env, 13)
    copies = [copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    wanted = go_on(env, 30)
    for other in copies:
        assert type(other) is type(env) and other.spec == env.spec and other is not env
        np.testing.assert_array_equal(go_on(other, 30), wanted)


def test_arrays_are_of_their_own_or_used_again_in_turn():
    own = made("Oscillator", 3)
    own.reset(seed=0)
    first, second = own.step(np.ones(3)), own.step(np.ones(3))
    assert not any(np.shares_memory(a, b) for a, b in zip(first[:4], second[:4]))
    env = made("Oscillator", 3, copy=False, buffers=3)
    env.reset(seed=0)
    steps = [env.step(np.ones(3)) for _ in range(6)]
    assert all(a is b for a, b in zip(steps[0][:4], steps[3][:4]))
    assert not np.shares_memory(steps[3][0], steps[4][0])
    np.testing.assert_array_equal(steps[5][0], [own.step(np.ones(3))[0] for _ in range(4)][-1])
    # Arrays outlive what made them.
    kept = steps[5][0]
    values = kept.copy()
    env.close()
    del env, steps
    gc.collect()
    np.testing.assert_array_equal(kept, values)


@pytest.mark.parametrize("copies", [True, False])
def test_what_nobody_has_any_more_is_written_again(copies):
    envs = libration.Environments("Oscillator", 3, copy=copies)
    envs.reset(seed=0)
    places = [[array.ctypes.data for array in envs.step(np.ones(3))[:4]] for _ in range(20)]
    assert all(len(set(column)) <= 2 for column in zip(*places))


@pytest.mark.parametrize(
    "hold",
    [
        lambda array: array,
        lambda array: array[:1],
        lambda array: array.view(np.uint8),
        memoryview,
        np.from_dlpack,
        lambda array: array.__dlpack__(),
        lambda array: np.frombuffer(array, array.dtype),
        lambda array: array.flat,
        lambda array: [array],
        lambda array: functools.partial(np.copy, array),
    ],
)
@pytest.mark.parametrize("which", range(4))
@pytest.mark.parametrize("num_envs", [3, 2000])
def test_what_somebody_has_in_whatever_way_is_not_written_again(hold, which, num_envs):
    envs = libration.Environments("Oscillator", num_envs)
    envs.reset(seed=0)
    array = envs.step(np.ones(num_envs))[which]
    held, place = hold(array), array.ctypes.data
    del array
    assert place not in [envs.step(np.ones(num_envs))[which].ctypes.data for _ in range(5)]
    del held


@pytest.mark.parametrize("copies", [True, False])
def test_large_arrays_begin_where_a_cache_line_does(copies):
    envs = libration.Environments("Oscillator", 1111, copy=copies)
    steps = [envs.reset(seed=0)[:1]] + [envs.step(np.ones(1111))[:4] for _ in range(9)]
    assert all(array.ctypes.data % 64 == 0 for arrays in steps for array in arrays)


@pytest.mark.parametrize("num_envs", [1, 15, 16, 17, 33])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_no_action_that_is_not_finite_goes_unseen(num_envs, dtype):
    envs = libration.Environments("Oscillator", num_envs, dtype=dtype)
    envs.reset(seed=0)
    largest = np.finfo(dtype).max
    envs.step(np.full(num_envs, -largest, dtype))
    for n in range(num_envs):
        for wrong in (np.nan, np.inf, -np.inf):
            actions = np.full(num_envs, largest, dtype)
            actions[n] = wrong
            with pytest.raises(ValueError, match=rf"actions\[{n}\] is "):
                envs.step(actions)


@pytest.mark.parametrize("copies", [True, False])
@pytest.mark.parametrize(
    "change",
    [
        lambda array: array.setflags(write=False),
        lambda array: array.resize(2, refcheck=False),
        lambda array: array.resize((0, 3), refcheck=False),
    ],
)
def test_arrays_that_were_changed_are_not_written_again(change, copies):
    # Small ones, which may be resized.
    envs, others = (libration.Environments("Oscillator", 3, copy=copies) for _ in range(2))
    envs.reset(seed=0)
    others.reset(seed=0)
    for _ in range(6):
        found, wanted = envs.step(np.ones(3))[:4], others.step(np.ones(3))[:4]
        for mine, theirs in zip(found, wanted):
            np.testing.assert_array_equal(mine, theirs)
            assert mine.flags.writeable
            change(mine)


def test_actions_that_lie_where_a_step_is_written_are_taken_as_they_were():
    kept = libration.Environments("Oscillator", 64, copy=False, buffers=1)
    fresh = libration.Environments("Oscillator", 64)
    kept.reset(seed=0)
    fresh.reset(seed=0)
    for _ in range(3):
        rewards, wanted = (e.step(np.full(64, 0.5, np.float32))[1] for e in (kept, fresh))
        # What was paid is asked for next, and what is paid for that stands in the same memory.
        mine, theirs = kept.step(rewards), fresh.step(wanted)
        for a, b in zip(mine[:2], theirs[:2]):
            np.testing.assert_array_equal(a, b)


def test_a_single_environment_that_is_closed_says_so():
    env = gymnasium.make("libration/PendulumSwingUp-v0")
    env.reset()
    env.close()
    with pytest.raises(ClosedEnvironmentError):
        env.reset()


def test_who_is_closed_or_not_reset_says_so():
    env = made("Pendulum", 2)
    with pytest.raises(ResetNeeded, match="must be reset before their first step"):
        env.step(np.zeros(2))
    env.close()
    env.close()
    assert env.closed
    for use in (lambda: env.step(np.zeros(2)), lambda: env.reset(), lambda: env.states):
        with pytest.raises(ClosedEnvironmentError, match="closed"):
            use()
    stopped = made("Pendulum", 2, "Disabled", max_episode_steps=1)
    stopped.reset(seed=0)
    stopped.step(np.zeros(2))
    with pytest.raises(ResetNeeded, match="the episode of environment 0 is over"):
        stopped.step(np.zeros(2))
    stopped.reset(options={"reset_mask": np.array([True, False])})
    with pytest.raises(ResetNeeded, match="the episode of environment 1 is over"):
        stopped.step(np.zeros(2))


def test_without_a_seed_every_environment_is_another_whichever_are_reset():
    mask = np.array([True, False, True])
    for options in (None, {"reset_mask": mask}):
        # Who is not reset has not begun either, and begins with the others.
        seen = [made("Pendulum", 3).reset(options=options)[0] for _ in range(2)]
        assert len(np.unique(seen, axis=None)) == 18


@pytest.mark.parametrize(
    ("seed", "error", "said"),
    [
        ([1, 2], ValueError, "there are 2 seeds, but there must be one for each of 3"),
        (-1, ValueError, "seed of environment 0 is -1"),
        (1.5, TypeError, "seed must be an integer, a list or None, not float"),
        (b"abc", TypeError, "seed must be an integer, a list or None, not bytes"),
        ([1, "a", 2], TypeError, "seed of environment 1 must be an integer"),
    ],
)
def test_seeds_that_cannot_be_are_refused(seed, error, said):
    with pytest.raises(error, match=said):
        made("Pendulum", 3).reset(seed=seed)


@pytest.mark.parametrize(
    ("mask", "error", "said"),
    [
        ([True, False, True], TypeError, "must be a NumPy array, not list"),
        (np.array([True, False]), ValueError, "shape"),
        (np.array([1, 0, 1]), TypeError, "dtype int64, but it must be bool"),
        (np.zeros(3, bool), ValueError, "no True"),
    ],
)
def test_masks_that_cannot_be_are_refused_as_gymnasium_does(mask, error, said):
    single = SyncVectorEnv([lambda: gymnasium.make("libration/PendulumSwingUp-v0")] * 3)
    for env in (made("Pendulum", 3), single):
        env.reset(seed=0)
        # Of Gymnasium 1.2 it is an assertion.
        with pytest.raises(error if env is not single else (error, AssertionError)):
            env.reset(options={"reset_mask": mask})
    with pytest.raises(error, match=said):
        made("Pendulum", 3).reset(options={"reset_mask": mask})


def test_pictures_show_where_the_system_is():
    for name in NAMES:
        env = made(name, 2, render_mode="rgb_array", start_position=0.5, start_velocity=0.0)
        env.reset(seed=0)
        pictures = env.render()
        assert len(pictures) == 2 and pictures[0].shape == (300, 300, 3)
        assert pictures[0].dtype == np.uint8 and (pictures[0] == pictures[1]).all()
        for _ in range(10):
            env.step(np.zeros(2))
        assert (env.render()[0] != pictures[0]).any()
        with pytest.warns(UserWarning, match="nothing is drawn"):
            assert made(name, 1).render() is None


def test_threads_that_step_the_same_environments_wait_for_each_other():
    env = made("Pendulum", 5000, threads=2)
    env.reset(seed=0)
    steps = 40

    def work():
        for _ in range(steps):
            env.step(np.zeros((5000, 1), np.float32))

    workers = [threading.Thread(target=work) for _ in range(3)]
    [worker.start() for worker in workers]
    [worker.join() for worker in workers]
    other = made("Pendulum", 5000)
    other.reset(seed=0)
    for _ in range(3 * steps):
        other.step(np.zeros((5000, 1), np.float32))
    np.testing.assert_array_equal(env.states, other.states)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this platform")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork.*:DeprecationWarning")
def test_a_process_that_was_forked_has_threads_of_its_own():
    env = made("Pendulum", 200_000, threads=2, substeps=8)
    env.reset(seed=0)
    env.step(np.zeros(200_000))
    child = os.fork()
    if child == 0:
        env.step(np.zeros(200_000))
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert status == 0


def test_what_is_lost_is_told():
    # The price of such an action is no number of 32 bits.
    env = made("Duffing", 2, bound=np.inf, max_action=1e30)
    env.reset(seed=0)
    for _ in range(3):
        _, rewards, terminated, _, infos = env.step(np.array([1e30, 0.0]))
        assert infos["lost"].tolist() == terminated.tolist() == [True, False] and rewards[0] == 0
        # It begins anew.
        _, rewards, terminated, _, infos = env.step(np.array([1e30, 0.0]))
        assert infos == {} and not terminated.any()


def test_random_numbers_of_a_copy_are_its_own():
    env = made("Pendulum", 2)
    env.reset(seed=3)
    copies = [copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    wanted = env.np_random.random(4)
    for other in copies:
        np.testing.assert_array_equal(other.np_random.random(4), wanted)
