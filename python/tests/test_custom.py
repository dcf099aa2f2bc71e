"""Tasks of one's own: the engine's environments, paid by a function."""

import copy
import pickle

import numpy as np
import pytest
from common import PERTURBED
from gymnasium.error import ResetNeeded

import libration
from libration import CustomTaskVectorEnv


def regulate(before, actions, after):
    """What the oscillator of the engine pays, and where it ends."""
    q, v = after.T
    return -(q * q + 0.1 * v * v + 0.001 * actions[:, 0] ** 2), np.abs(q) > 0.9


@pytest.mark.parametrize("given", [{}, PERTURBED], ids=["ideal", "perturbed"])
@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_a_task_that_pays_as_the_engine_does_ends_the_same_episodes(mode, given):
    given = {"max_episode_steps": 40, "dtype": "float64", "autoreset_mode": mode, **given}
    own = CustomTaskVectorEnv("Oscillator", 16, task=regulate, **given)
    built_in = libration.VectorEnv("Oscillator", 16, bound=0.9, **given)
    np.testing.assert_array_equal(own.reset(seed=3)[0], built_in.reset(seed=3)[0])
    rng, early, ends = np.random.default_rng(0), 0, 0
    for _ in range(120):
        # More than there is to be had: both pay for what is.
        actions = rng.uniform(-30, 30, (16, 1))
        mine, theirs = own.step(actions), built_in.step(actions)
        for k in (0, 2, 3):
            np.testing.assert_array_equal(mine[k], theirs[k])
        # The prices are those of the engine, added up in another order.
        np.testing.assert_allclose(mine[1], theirs[1], rtol=1e-14, atol=1e-300)
        over = mine[2] | mine[3]
        early, ends = early + mine[2].sum(), ends + over.sum()
        assert mine[4].keys() == theirs[4].keys()
        for n in np.flatnonzero(over) if mode == "SameStep" else ():
            np.testing.assert_array_equal(mine[4]["final_obs"][n], theirs[4]["final_obs"][n])
        if mode == "Disabled" and over.any():
            with pytest.raises(ResetNeeded):
                own.step(actions)
            for envs in (own, built_in):
                envs.reset(options={"reset_mask": over})
    assert ends > 16 and early > 0


def test_a_new_episode_is_neither_paid_nor_over_in_the_step_that_begins_it():
    own = CustomTaskVectorEnv("Duffing", 4, task=lambda b, u, a: (np.ones(4), np.ones(4, bool)))
    own.reset(seed=0)
    for step in range(6):
        seen, rewards, terminated, _, _ = own.step(np.zeros((4, 1)))
        assert (terminated == (step % 2 == 0)).all() and (rewards == (step % 2 == 0)).all()
        if step % 2:
            np.testing.assert_array_equal(seen, own.states.astype(seen.dtype))


@pytest.mark.parametrize(
    "task, told",
    [
        (lambda b, u, a: np.zeros(3), "rewards"),
        (lambda b, u, a: (np.zeros(4), False), "ends of episodes"),
        (lambda b, u, a: (np.zeros(4), np.ones(4)), "ends of episodes"),
        (lambda b, u, a: np.zeros(4, complex), "rewards"),
    ],
)
def test_a_task_that_gives_something_else_is_told_so(task, told):
    own = CustomTaskVectorEnv("Pendulum", 4, task=task)
    own.reset(seed=0)
    with pytest.raises((TypeError, ValueError), match=told):
        own.step(np.zeros((4, 1)))


def test_what_is_no_task_is_refused():
    with pytest.raises(TypeError, match="task"):
        CustomTaskVectorEnv("Pendulum", 4, task=3)
    with pytest.raises(TypeError, match="effort_cost"):
        CustomTaskVectorEnv("Pendulum", 4, task=regulate, effort_cost=1.0)


def test_a_task_has_actions_of_its_own_within_what_there_is():
    seen = []

    def task(before, actions, after):
        seen.append(actions.copy())
        actions *= 0
        return np.zeros(2)

    own = CustomTaskVectorEnv("Pendulum", 2, task=task)
    own.reset(seed=0)
    actions = np.array([[1.0], [100.0]], np.float32)
    own.step(actions)
    np.testing.assert_array_equal(seen[0], [[1.0], [6.0]])
    np.testing.assert_array_equal(actions, [[1.0], [100.0]])


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_a_task_that_raises_leaves_environments_that_go_on(mode):
    def task(before, actions, after):
        calls.append(1)
        if len(calls) == 3:
            raise ZeroDivisionError
        return np.zeros(2)

    calls = []
    given = {"max_episode_steps": 3, "autoreset_mode": mode}
    own = CustomTaskVectorEnv("Duffing", 2, task=task, **given)
    other = CustomTaskVectorEnv("Duffing", 2, task=lambda b, u, a: np.zeros(2), **given)
    for envs in (own, other):
        envs.reset(seed=0)
    for call in range(1, 9):
        other.step(np.zeros(2))
        if call == 3:
            with pytest.raises(ZeroDivisionError):
                own.step(np.zeros(2))
        else:
            own.step(np.zeros(2))
        np.testing.assert_array_equal(own.states, other.states)


def test_environments_with_a_task_that_can_be_found_again_are_pickled():
    own = CustomTaskVectorEnv("Oscillator", 3, task=regulate)
    own.reset(seed=1)
    own.step(np.ones(3))
    twin = pickle.loads(pickle.dumps(own))
    for _ in range(5):
        for mine, theirs in zip(own.step(np.ones(3))[:4], twin.step(np.ones(3))[:4]):
            np.testing.assert_array_equal(mine, theirs)


def test_a_copy_of_a_task_s_environments_is_another():
    own = CustomTaskVectorEnv("Oscillator", 3, task=lambda b, u, a: -a[:, 0])
    own.reset(seed=1)
    twin, before = copy.copy(own), own.states
    twin.step(np.ones(3))
    np.testing.assert_array_equal(own.states, before)
    third = copy.deepcopy(own)
    for mine, theirs in zip(own.step(np.ones(3))[:4], third.step(np.ones(3))[:4]):
        np.testing.assert_array_equal(mine, theirs)
    np.testing.assert_array_equal(own.states, twin.states)


def test_a_task_sees_the_commands_of_discrete_actions():
    arm, seen = libration.System(acceleration={"q": "u - 3*q"}, inputs=["u"]), []

    def paid(before, commands, after):
        seen.append(commands[:, 0].tolist())
        return -(commands[:, 0] ** 2)

    own = CustomTaskVectorEnv(arm, 3, task=paid, dt=0.02, actions=[-5.0, 0.0, 5.0])
    built_in = libration.VectorEnv(arm, 3, dt=0.02, reward="-u^2", actions=[-5.0, 0.0, 5.0])
    for env in (own, built_in):
        env.reset(seed=7)
    actions = np.array([0, 1, 2])
    np.testing.assert_array_equal(own.step(actions)[1], built_in.step(actions)[1])
    assert seen == [[-5.0, 0.0, 5.0]] and own.np_random_seed == 7


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_a_reward_that_is_no_number_ends_the_episode_as_lost(mode):
    paid = np.array([np.nan, -np.inf, 2.0])
    envs = CustomTaskVectorEnv("Pendulum", 3, task=lambda before, actions, after: paid, autoreset_mode=mode)
    envs.reset(seed=0)
    _, rewards, terminated, truncated, infos = envs.step(np.zeros((3, 1)))
    assert rewards.tolist() == [0, 0, 2] and terminated.tolist() == [True, True, False] and not truncated.any()
    told = infos["final_info"] if mode == "SameStep" else infos
    assert told["lost"].tolist() == told["_lost"].tolist() == [True, True, False]


def test_a_task_that_returns_three_values_is_told_what_it_must_return():
    envs = libration.CustomTaskVectorEnv("Pendulum", 2, task=lambda before, actions, after: (after[:, 0], after[:, 0] > 0, {}))
    envs.reset(seed=0)
    with pytest.raises(ValueError, match="the task returned 3 values, but it must return rewards, or rewards and ends of episodes"):
        envs.step(np.zeros((2, 1)))
