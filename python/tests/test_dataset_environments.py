"""The environment with which a data set was written."""

import minari
import numpy as np
import pytest

import libration
from libration import datasets

COMMON = {"num_envs": 3, "steps": 60, "chunk": {"num_envs": 3, "steps": 60}, "max_episode_steps": 25}
ACTING = {"delays": {"action": 0.014, "observation": [0.007, 0.007]}, "substeps": 3, "dt": 0.007}
REGULATE = {"regulate": {"position": 2.0, "velocity": 0.3, "effort": 0.01, "bound": 1.5}}
RANDOM = {"random": {"low": -3.0, "high": 3.0}}
SPRING = libration.System(
    acceleration={"q": "-k*q + u"},
    parameters={"k": 10.0},
    inputs=["u"],
    task={"reward": "-q^2 - 0.01*u^2", "start": {"q": 1, "q'": 0}, "terminated": ["q < -0.9"]},
)

CASES = {
    "oscillator": {**ACTING, "policy": RANDOM, "task": REGULATE, "start": {"q": [1.0, 1.0], "v": [0.5, 0.5]}},
    "force": {"system": {"oscillator": {"m": 2.0, "k": 7.0}}, "policy": RANDOM, "task": REGULATE},
    "pendulum": {
        **ACTING,
        "system": {"pendulum": {"omega2": 9.0}},
        "task": {"swing-up": {"velocity": 0.2, "effort": 0.03}},
        "policy": RANDOM,
        "integrator": "rk4",
    },
    "duffing": {"system": {"duffing": {"alpha": -2.0, "beta": 0.5}}, "task": REGULATE, "policy": RANDOM, "dtype": "f64"},
    "equations": {"system": {"equations": {"max_action": 1.0}}, "policy": RANDOM, "substeps": 2},
}


def written(folder, case, **more):
    system = SPRING.replace(k=12.0) if case == "equations" else None
    datasets.write(folder, {**COMMON, **CASES[case]}, system=system, **more)
    return folder


@pytest.mark.parametrize("case", CASES)
def test_the_recovered_environment_repeats_each_episode_bit_for_bit(tmp_path, case):
    folder = written(tmp_path / "data", case, format="minari")
    env = datasets.recover_environment(folder)
    episodes = list(minari.MinariDataset(folder / "data").iterate_episodes())
    assert len(episodes) >= 6
    ends = set()
    for episode in episodes:
        assert episode.observations.dtype == env.observation_space.dtype
        np.testing.assert_array_equal(env.reset()[0], episode.observations[0])
        for t, action in enumerate(episode.actions):
            observation, reward, terminated, truncated, _ = env.step(action)
            np.testing.assert_array_equal(observation, episode.observations[t + 1])
            assert episode.rewards[t] == reward and episode.terminations[t] == terminated
        # The end of the data set also truncates.
        assert len(episode.actions) < 25 or truncated
        ends.add("terminated" if terminated else "truncated" if truncated else "stopped")
    assert "truncated" in ends or "terminated" in ends


@pytest.mark.parametrize("case", CASES)
def test_minari_recovers_the_environment_from_the_metadata(tmp_path, case):
    folder = written(tmp_path / "data", case, format="minari")
    dataset = minari.MinariDataset(folder / "data")
    assert dataset.env_spec == datasets.environment_spec(folder)
    found = dataset.recover_environment()
    wanted = datasets.recover_environment(folder)
    assert found.spec == wanted.spec and found.observation_space == wanted.observation_space
    np.testing.assert_array_equal(found.reset(seed=1)[0], wanted.reset(seed=1)[0])
    for _ in range(10):
        found_step, wanted_step = (env.step(np.ones(1, found.action_space.dtype)) for env in (found, wanted))
        np.testing.assert_array_equal(found_step[0], wanted_step[0])
        assert found_step[1:] == wanted_step[1:]


@pytest.mark.parametrize("format", ["npy", "parquet"])
def test_the_environment_of_other_formats_is_recovered_and_may_change(tmp_path, format):
    folder = written(tmp_path / "data", "pendulum", format=format)
    env = datasets.recover_environment(folder, render_mode="rgb_array", action_delay=0.0, max_episode_steps=2)
    assert env.get_wrapper_attr("omega2") == 9.0 and env.get_wrapper_attr("action_delay") == 0.0
    assert env.get_wrapper_attr("observation_delay") == (0.007, 0.007) and env.get_wrapper_attr("substeps") == 3
    env.reset(seed=0)
    assert env.render().shape == (300, 300, 3)
    assert [env.step(np.zeros(1, np.float32))[3] for _ in range(2)] == [False, True]


def test_noise_and_clocks_are_those_of_the_data_set(tmp_path):
    noise = {"jitter": 0.1, "skew": 0.02, "observation": 0.03}
    datasets.write(tmp_path / "data", {**COMMON, "noise": noise, "start": {"q": [-1.0, 2.0], "v": [0.0, 0.5]}})
    env = datasets.recover_environment(tmp_path / "data")
    found = {name: env.get_wrapper_attr(name) for name in ("jitter", "skew", "observation_noise", "start_position", "start_velocity")}
    assert found == dict(jitter=0.1, skew=0.02, observation_noise=0.03, start_position=[-1.0, 2.0], start_velocity=[0.0, 0.5])


def test_a_system_and_a_task_of_no_environment_are_an_error_with_those_that_are(tmp_path):
    datasets.write(tmp_path / "data", {**COMMON, "system": {"pendulum": {}}, "task": REGULATE})
    with pytest.raises(ValueError, match="'pendulum' with the task 'regulate'; expected 'oscillator' with 'regulate', 'pendulum' with 'swing-up'"):
        datasets.recover_environment(tmp_path / "data")


def test_a_folder_without_a_data_set_is_an_error(tmp_path):
    (tmp_path / "manifest.jsonl").write_text("[]\n")
    for folder in (tmp_path, tmp_path / "none"):
        with pytest.raises(ValueError, match="has no data set .*expected a folder that datasets.write has written"):
            datasets.environment_spec(folder)
