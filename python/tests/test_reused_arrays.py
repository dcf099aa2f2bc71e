"""Arrays of ``copy=False``: a step leaves those of the last ``buffers`` steps as they are."""

import numpy as np
import pytest

import libration
from libration.classic_control import CartPoleVectorEnv, MountainCarContinuousVectorEnv, PendulumVectorEnv


def kept(results):
    return [np.copy(array) for array in results]


def assert_unchanged(history):
    for results, values in history:
        for array, value in zip(results, values):
            np.testing.assert_array_equal(array, value)


@pytest.mark.parametrize("twin", [CartPoleVectorEnv, PendulumVectorEnv, MountainCarContinuousVectorEnv])
@pytest.mark.parametrize("starts", ["libration", "gymnasium"])
@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("buffers", [1, 2, 3])
def test_twins_keep_the_arrays_of_the_last_steps_whatever_begins_between_them(twin, starts, mode, dtype, buffers):
    given = {"starts": starts, "autoreset_mode": mode, "max_episode_steps": 3, "dtype": dtype}
    envs, others = twin(3, copy=False, buffers=buffers, **given), twin(3, **given)
    envs.reset(seed=0), others.reset(seed=0)
    envs.action_space.seed(0)
    history, ended = [], np.zeros(3, bool)
    for step in range(20):
        # Resets and states that a caller sets take no turn, however many there are.
        for mask in [ended.copy()] * bool(mode == "Disabled" and ended.any()) + [np.array([True, False, True])] * (step % 4):
            first, second = (one.reset(options={"reset_mask": mask})[0] for one in (envs, others))
            np.testing.assert_array_equal(first, second)
            assert not any(np.shares_memory(first, array) for results, _ in history for array in results)
        if step % 5 == 4:
            states = envs.states
            first = envs.reset(options={"reset_mask": np.array([False, True, False]), "state": states})[0]
            second = envs.set_state(states)
            others.reset(options={"reset_mask": np.array([False, True, False]), "state": states}), others.set_state(states)
            assert not any(np.shares_memory(row, array) for row in (first, second) for results, _ in history for array in results)
        assert_unchanged(history[-buffers:])
        actions = envs.action_space.sample()
        results, wanted = envs.step(actions)[:4], others.step(actions)[:4]
        for mine, theirs in zip(results, wanted):
            np.testing.assert_array_equal(mine, theirs)
            assert mine.dtype == theirs.dtype
        history.append((results, kept(results)))
        assert_unchanged(history[-buffers:])
        ended = results[2] | results[3]
    # The steps fill the same arrays in turn.
    assert all(a is b for a, b in zip(history[-1][0], history[-1 - buffers][0]))


@pytest.mark.parametrize("change", [lambda array: array.setflags(write=False), lambda array: array.resize(2, refcheck=False)])
def test_arrays_of_twins_that_a_caller_changed_are_not_written_again(change):
    envs, others = PendulumVectorEnv(3, copy=False), PendulumVectorEnv(3)
    envs.reset(seed=0), others.reset(seed=0)
    for _ in range(6):
        found, wanted = envs.step(np.ones((3, 1)))[:4], others.step(np.ones((3, 1)))[:4]
        for mine, theirs in zip(found, wanted):
            np.testing.assert_array_equal(mine, theirs)
            assert mine.flags.writeable
            change(mine)


@pytest.mark.parametrize("buffers", [1, 2, 3])
def test_resets_and_states_that_a_caller_sets_return_new_arrays_and_take_no_turn(buffers):
    envs = libration.Environments("Pendulum", 3, autoreset_mode="Disabled", copy=False, buffers=buffers)
    everyone = np.ones(3, bool)
    for call in (
        lambda: envs.reset(options={"reset_mask": everyone})[0],
        lambda: envs.set_state([0.1, 0.0]),
        lambda: envs.reset(options={"reset_mask": everyone, "state": [0.1, 0.0]})[0],
        lambda: envs.reset(options={"low": -0.1, "high": 0.1})[0],
    ):
        envs.reset(seed=0)
        history = [envs.step(np.ones(3))[:4] for _ in range(buffers)]
        values = [kept(results) for results in history]
        seen = call()
        assert not any(np.shares_memory(seen, array) for results in history for array in results)
        assert_unchanged(zip(history, values))
        # The next step fills the oldest arrays.
        assert all(a is b for a, b in zip(history[0], envs.step(np.ones(3))[:4]))
