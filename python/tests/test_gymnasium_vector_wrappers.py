"""Gymnasium's wrappers of vector environments around twins of its environments, beside its own environments."""

import os

import gymnasium
import numpy as np
import pytest
from common import AUTORESETS
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import vector as wrappers
from vector_pairs import assert_equal_over_episodes, ours, theirs

WRAPPERS = {
    "FlattenObservation": {},
    "ReshapeObservation": {"shape": (2, 2)},
    "DtypeObservation": {"dtype": np.float64},
    "RescaleObservation": {"min_obs": np.array([0, -np.inf, 0, -np.inf], np.float32), "max_obs": np.array([1, np.inf, 1, np.inf], np.float32)},
    "ClipReward": {"min_reward": -0.25, "max_reward": 0.75},
    "ClipAction": {},
    "RescaleAction": {"min_action": np.float32(1), "max_action": np.float32(2)},
}
# Gymnasium refuses wrappers of observations where an episode ends and begins in one step.
WRAPPED = [(name, mode) for name in WRAPPERS for mode in AUTORESETS[:2] if mode == "NextStep" or not name.endswith("Observation")]


@pytest.mark.parametrize("num_envs", [1, 3])
@pytest.mark.parametrize(("name", "mode"), WRAPPED)
def test_a_wrapper_of_a_batch_is_that_of_its_environments(name, mode, num_envs):
    id, limit = ("MountainCarContinuous-v0", {"max_episode_steps": 11}) if name.endswith("Action") else ("CartPole-v1", {})
    given, vector_kwargs = WRAPPERS[name], {"autoreset_mode": AutoresetMode(mode)}
    wraps = [lambda env: getattr(gymnasium.wrappers, name)(env, **given)]
    each = gymnasium.make_vec(f"libration/{id}", num_envs, "sync", vector_kwargs, wraps, starts="gymnasium", **limit)
    batch = getattr(wrappers, name)(ours(num_envs, id, autoreset_mode=mode, **limit), **given)
    assert assert_equal_over_episodes(batch, each) > 2


BY_FUNCTION = {
    "RecordEpisodeStatistics": wrappers.RecordEpisodeStatistics,
    "NormalizeReward": wrappers.NormalizeReward,
    "NormalizeObservation": wrappers.NormalizeObservation,
    "TransformReward": lambda envs: wrappers.TransformReward(envs, lambda rewards: rewards - 0.5),
    "TransformObservation": lambda envs: wrappers.TransformObservation(envs, lambda rows: -rows),
    "VectorizeTransformObservation": lambda envs: wrappers.VectorizeTransformObservation(envs, gymnasium.wrappers.FlattenObservation),
    "VectorizeTransformReward": lambda envs: wrappers.VectorizeTransformReward(envs, gymnasium.wrappers.TransformReward, func=lambda reward: 2 * reward),
    "TransformAction": lambda envs: wrappers.TransformAction(envs, lambda actions: 1 - actions),
}
BY_FUNCTIONS = [(name, mode) for name in BY_FUNCTION for mode in AUTORESETS[:2] if mode == "NextStep" or not name.endswith("Observation")]


@pytest.mark.parametrize(("name", "mode"), BY_FUNCTIONS + [pair for pair in WRAPPED if not pair[0].endswith("Action")])
def test_a_wrapper_of_our_batch_is_that_of_the_sync_vector_env_of_gymnasium(name, mode):
    wrap = BY_FUNCTION.get(name) or (lambda envs: getattr(wrappers, name)(envs, **WRAPPERS[name]))
    assert assert_equal_over_episodes(wrap(ours(autoreset_mode=mode)), wrap(theirs(mode=mode))) > 3


def test_observations_are_normal_when_their_mean_stands():
    one = wrappers.NormalizeObservation(ours())
    one.reset(seed=1)
    one.action_space.seed(1)
    for _ in range(400):
        one.step(one.action_space.sample())
    one.update_running_mean = False
    mean = one.obs_rms.mean.copy()
    rows = np.array([one.step(one.action_space.sample())[0] for _ in range(200)])
    assert np.array_equal(one.obs_rms.mean, mean)
    assert np.allclose(rows.mean(axis=(0, 1)), 0, atol=0.5) and np.allclose(rows.var(axis=(0, 1)), 1, atol=0.6)


@pytest.mark.parametrize("mode", AUTORESETS[:2])
@pytest.mark.parametrize("name", ["ClipAction", "RescaleAction"])
def test_a_wrapper_of_actions_of_our_pendulums_is_that_of_gymnasium(name, mode):
    """Rewards of Pendulum differ by roundings: Gymnasium subtracts turns of a rounded 2π."""
    one, other = (
        getattr(wrappers, name)(envs, **WRAPPERS[name])
        for envs in (ours(id="Pendulum-v1", autoreset_mode=mode), theirs(id="Pendulum-v1", mode=mode))
    )
    # Gymnasium multiplies actions of float32 in float32.
    close = lambda a, b: np.allclose(a, b, rtol=1e-4, atol=1e-5)  # noqa: E731
    assert_equal_over_episodes(one, other, steps=20, equal=close)


@pytest.mark.parametrize("mode", AUTORESETS[:2])
def test_a_list_of_infos_has_a_dictionary_for_each_environment(mode):
    def listed(envs):
        return wrappers.DictInfoToList(wrappers.RecordEpisodeStatistics(envs))

    one, other = listed(ours(autoreset_mode=mode)), listed(theirs(mode=mode))
    assert one.reset(seed=3)[1] == other.reset(seed=3)[1] == [{}, {}, {}]
    one.action_space.seed(3)
    ended = 0
    for _ in range(100):
        actions = one.action_space.sample()
        infos, others = one.step(actions)[4], other.step(actions)[4]
        for info in (*infos, *others):
            if "episode" in info:
                info["episode"].pop("t")
                ended += 1
        assert data_equivalence(infos, others)
    assert ended > 6


def test_a_list_of_infos_has_the_parameters_of_each_environment():
    envs = wrappers.DictInfoToList(ours(gravity=np.array([9.0, 10.0, 11.0]), parameter_infos=True))
    assert [info["parameters"] for info in envs.reset(seed=0)[1]] == [{"gravity": 9.0}, {"gravity": 10.0}, {"gravity": 11.0}]


@pytest.mark.skipif(not hasattr(wrappers, "RecordVideo"), reason="this Gymnasium has no such wrapper")
def test_videos_begin_at_their_steps_and_episodes(tmp_path):
    pytest.importorskip("pygame"), pytest.importorskip("moviepy")
    envs = wrappers.RecordVideo(
        ours(2, render_mode="rgb_array"), str(tmp_path / "videos"), name_prefix="cart", step_trigger=lambda step: step in (0, 25), video_length=5
    )
    envs.reset(seed=0)
    for _ in range(40):
        envs.step(envs.action_space.sample())
    envs.close()
    assert {name for name in os.listdir(tmp_path / "videos") if name.endswith(".mp4")} == {"cart-step-0.mp4", "cart-step-25.mp4"}


def test_tensors_of_torch_go_in_and_come_out():
    torch = pytest.importorskip("torch")
    envs = wrappers.NumpyToTorch(ours())
    observations, _ = envs.reset(seed=0)
    assert isinstance(observations, torch.Tensor) and tuple(observations.shape) == (3, 4)
    observations, rewards, *_ = envs.step(torch.tensor([0, 1, 1]))
    assert isinstance(observations, torch.Tensor) and isinstance(rewards, torch.Tensor)
