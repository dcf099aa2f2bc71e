"""Tasks of one's own: the engine's environments, paid by a function."""

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
    rng, first, ends, over_early = np.random.default_rng(0), np.ones(16, bool), 0, False
    for _ in range(120):
        actions = rng.uniform(-20, 20, (16, 1))
        mine, theirs = own.step(actions), built_in.step(actions)
        # Of a first episode all is the same; which is the next one is for each to say.
        for a, b in zip(mine[2:4], theirs[2:4]):
            np.testing.assert_array_equal(a[first], b[first])
        # The prices are those of the engine, added up in another order.
        np.testing.assert_allclose(mine[1][first], theirs[1][first], rtol=1e-14, atol=1e-300)
        over = mine[2] | mine[3]
        ends += over.sum()
        over_early |= mine[2].any()
        if mode == "SameStep" and over.any():
            for n in np.flatnonzero(over & first):
                np.testing.assert_array_equal(
                    mine[4]["final_obs"][n], theirs[4]["final_obs"][n]
                )
        else:
            np.testing.assert_array_equal(mine[0][first], theirs[0][first])
        first &= ~over
        if mode == "Disabled" and over.any():
            with pytest.raises(ResetNeeded):
                own.step(actions)
            own.reset(options={"reset_mask": over})
            if (theirs[2] | theirs[3]).any():
                built_in.reset(options={"reset_mask": theirs[2] | theirs[3]})
    assert ends > 16 and over_early and not first.any()


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
    ],
)
def test_a_task_that_gives_something_else_is_told_so(task, told):
    own = CustomTaskVectorEnv("Pendulum", 4, task=task)
    own.reset(seed=0)
    with pytest.raises(ValueError, match=told):
        own.step(np.zeros((4, 1)))


def test_what_is_no_task_is_refused():
    with pytest.raises(TypeError, match="task"):
        CustomTaskVectorEnv("Pendulum", 4, task=3)
    with pytest.raises(TypeError, match="effort_cost"):
        CustomTaskVectorEnv("Pendulum", 4, task=regulate, effort_cost=1.0)
