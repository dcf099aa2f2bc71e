"""Twins of Gymnasium in a batch of the engine, and Gymnasium's own in a ``SyncVectorEnv``."""

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode

import libration  # noqa: F401


def ours(num_envs=3, id="CartPole-v1", **given):
    return gymnasium.make_vec(f"libration/{id}", num_envs, vectorization_mode="vector_entry_point", starts="gymnasium", **given)


def theirs(num_envs=3, id="CartPole-v1", mode="NextStep", **given):
    return gymnasium.make_vec(id, num_envs, vectorization_mode="sync", vector_kwargs={"autoreset_mode": AutoresetMode(mode)}, **given)


def assert_equal_over_episodes(one, other, steps=100, seed=123, equal=np.array_equal):
    """Both have the same spaces, and the same results of a reset and of some steps; returns the number of ended episodes."""
    for name in ("num_envs", "observation_space", "single_observation_space", "action_space", "single_action_space"):
        assert getattr(one, name) == getattr(other, name), name
    (start, infos), (other_start, other_infos) = one.reset(seed=seed), other.reset(seed=seed)
    assert data_equivalence(start, other_start) and data_equivalence(infos, other_infos)
    one.action_space.seed(seed)
    ended = 0
    for _ in range(steps):
        actions = one.action_space.sample()
        assert actions in other.action_space
        results, others = one.step(actions), other.step(actions)
        assert all(equal(result, wanted) for result, wanted in zip(results[:4], others[:4]))
        # Rewards of the engine have its float type.
        assert all(results[i].dtype == others[i].dtype for i in (0, 2, 3))
        for table in (results[4], others[4]):
            if "episode" in table:
                # The time on the clock.
                assert table["episode"].pop("t").shape == (one.num_envs,)
        assert data_equivalence(results[4], others[4]), (results[4], others[4])
        ended += np.count_nonzero(results[2] | results[3])
    one.close(), other.close()
    return ended
