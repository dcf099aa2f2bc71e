"""Attributes of single environments, types of results, and Gymnasium's wrappers of vector environments."""

import copy
import pickle
import sys
import types

import gymnasium
import numpy as np
import pytest
from common import AUTORESETS, IDS, NAMES
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import vector as wrappers

import libration

GIVEN = dict(action_delay=0.05, jitter=("gaussian", 0.05), max_action=2.0)
SPRING = libration.System(acceleration={"q": "-k*q + u"}, parameters={"k": 10.0}, inputs=["u"])
TASK = dict(dt=0.01, reward="-q^2", start={"q": (-1, 1)})


def made(name="Pendulum", num_envs=3, **given):
    return gymnasium.make_vec(IDS[name], num_envs, **given)


@pytest.mark.parametrize("name", NAMES)
def test_attributes_are_those_of_single_environments_side_by_side(name):
    ours = made(name, **GIVEN)
    theirs = SyncVectorEnv([lambda: gymnasium.make(IDS[name], **GIVEN)] * 3)
    ours.reset(seed=4)
    theirs.reset(seed=4)
    ours.step(np.ones(3))
    theirs.step(np.ones((3, 1)))
    names = "observation_space action_space metadata render_mode state dt substeps action_delay jitter dtype integrator start_position"
    cost = "velocity_cost"
    for attribute in [*names.split(), cost, *ours.preset.parameters]:
        found, wanted = ours.get_attr(attribute), theirs.get_attr(attribute)
        assert isinstance(found, tuple) and len(found) == 3
        for mine, other in zip(found, wanted):
            if attribute == "metadata":
                # Gymnasium 1.2 adds the mode to the metadata of single environments.
                other = {key: value for key, value in other.items() if key != "autoreset_mode"}
            np.testing.assert_array_equal(mine, other)
        called = ours.call(attribute)
        assert all(np.array_equal(mine, other) for mine, other in zip(called, found))
    np.testing.assert_array_equal(ours.get_attr("state"), ours.states)


def test_attributes_have_the_values_that_were_given_or_else_their_defaults():
    envs = made(**GIVEN)
    assert envs.get_attr("action_delay") == (0.05,) * 3 and envs.get_attr("max_action") == (2.0,) * 3
    assert envs.get_attr("omega2") == (15.0,) * 3 and envs.get_attr("max_episode_steps") == (200,) * 3
    assert made("Oscillator", m=2.0, k=3.0).get_attr("k") == (3.0,) * 3
    assert made(max_episode_steps=-1).get_attr("max_episode_steps") == (np.inf,) * 3
    own = libration.VectorEnv(SPRING, 2, **TASK)
    assert own.get_attr("k") == (10.0, 10.0) and own.get_attr("reward") == ("-q^2", "-q^2")
    assert own.get_attr("max_action") == (np.inf, np.inf)
    envs.goal = 7
    assert envs.get_attr("goal") == (7, 7, 7)


@pytest.mark.parametrize("attribute", ["omega", "start_positions", "unwrapped", "_settings", "np_random"])
def test_an_attribute_that_no_environment_has_is_an_error_with_the_known_names(attribute):
    with pytest.raises(AttributeError, match=f"no attribute '{attribute}': .*known are .*omega2"):
        made().get_attr(attribute)
    with pytest.raises(AttributeError, match="did you mean 'omega2'"):
        gymnasium.make("libration/PendulumSwingUp-v0").unwrapped.get_wrapper_attr("omega")


@pytest.mark.parametrize("method", ["reset", "step", "close", "rollout"])
def test_a_method_of_all_environments_is_not_called_for_each(method):
    envs = made()
    with pytest.raises(AttributeError, match=rf"{method} is a method of all environments; .*envs\.{method}\("):
        envs.call(method)
    assert not envs.closed


def test_render_is_called_for_each_environment():
    envs = made(render_mode="rgb_array")
    envs.reset(seed=0)
    pictures = envs.call("render")
    assert len(pictures) == 3 and all(np.array_equal(a, b) for a, b in zip(pictures, envs.render()))
    with pytest.warns(UserWarning, match="nothing is drawn"):
        assert made().call("render") == (None, None, None)


@pytest.mark.parametrize(
    ("attribute", "values", "error", "told"),
    [
        ("dt", 0.1, AttributeError, "dt of single environments cannot be set to 0.1; expected render_mode; help: .*dt=0.1"),
        ("omega2", [1.0, 2.0, 3.0], AttributeError, r"omega2 .* cannot be set to \[1.0, 2.0, 3.0\]; expected render_mode"),
        ("state", np.zeros(2), AttributeError, "state .* cannot be set to .*; expected render_mode; help: reset"),
        ("observation_space", None, AttributeError, "observation_space .* cannot be set to None; expected render_mode"),
        ("omega", 1.0, AttributeError, "no attribute 'omega': did you mean 'omega2'"),
        ("render_mode", ["rgb_array", None, None], ValueError, "must be the same for all environments"),
        ("render_mode", "human", ValueError, "render_mode is 'human', but it must be 'rgb_array' or None"),
        ("render_mode", ["rgb_array"], ValueError, "render_mode has 1 values, but there must be one for each of 3"),
    ],
)
def test_an_attribute_that_cannot_be_set_is_an_error_with_its_value_and_what_is_allowed(attribute, values, error, told):
    envs = made()
    with pytest.raises(error, match=told):
        envs.set_attr(attribute, values)
    assert envs.render_mode is None and envs.get_attr("omega2") == (15.0,) * 3


@pytest.mark.parametrize("attribute", ["dt", "omega2", "state"])
def test_single_environments_refuse_what_vector_environments_refuse(attribute):
    theirs = SyncVectorEnv([lambda: gymnasium.make("libration/PendulumSwingUp-v0")] * 2)
    theirs.reset(seed=0)
    with pytest.raises(AttributeError, match=f"{attribute} of single environments cannot be set to 0.1; expected render_mode"):
        theirs.set_attr(attribute, 0.1)


@pytest.mark.parametrize("values", ["rgb_array", ["rgb_array"] * 3, ("rgb_array",) * 3])
def test_a_render_mode_that_is_set_draws(values):
    envs = made()
    envs.reset(seed=0)
    envs.set_attr("render_mode", values)
    assert envs.get_attr("render_mode") == ("rgb_array",) * 3 and envs.render()[2].shape == (300, 300, 3)
    for other in (copy.copy(envs), pickle.loads(pickle.dumps(envs))):
        assert other.get_attr("render_mode") == ("rgb_array",) * 3


def test_environments_with_a_task_by_a_function_have_the_same_attributes():
    envs = libration.CustomTaskVectorEnv("Pendulum", 3, task=lambda before, actions, after: after[:, 1], **GIVEN)
    envs.reset(seed=0)
    assert envs.get_attr("action_delay") == (0.05,) * 3 and envs.call("dt") == (0.05,) * 3
    envs.set_attr("render_mode", "rgb_array")
    assert envs.render_mode == "rgb_array" and len(envs.call("render")) == 3


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("mode", AUTORESETS)
def test_rewards_have_the_dtype_of_the_environments_and_the_numbers_of_gymnasium(dtype, mode):
    settings = dict(dtype=dtype, max_episode_steps=7)
    ours = made(autoreset_mode=mode, **settings)
    theirs = SyncVectorEnv(
        [lambda: gymnasium.make("libration/PendulumSwingUp-v0", **settings)] * 3, autoreset_mode=AutoresetMode(mode)
    )
    assert np.array_equal(ours.reset(seed=1)[0], theirs.reset(seed=1)[0])
    for _ in range(7):
        found, wanted = (envs.step(np.ones((3, 1), dtype))[:4] for envs in (ours, theirs))
        assert [array.dtype for array in found] == [dtype, dtype, bool, bool]
        # SyncVectorEnv adds Python's floats of single environments.
        assert [array.dtype for array in wanted] == [dtype, np.float64, bool, bool]
        assert all(np.array_equal(mine, other) for mine, other in zip(found, wanted))
    assert found[3].all()
    single = gymnasium.make("libration/PendulumSwingUp-v0", dtype=dtype)
    single.reset(seed=1)
    assert [type(value) for value in single.step(np.ones(1, dtype))[1:4]] == [float, bool, bool]


@pytest.mark.parametrize("mode", AUTORESETS[:2])
def test_wrappers_of_gymnasium_wrap_it_as_they_wrap_single_environments_side_by_side(mode):
    settings = dict(max_episode_steps=9, render_mode="rgb_array")
    theirs = SyncVectorEnv([lambda: gymnasium.make("libration/PendulumSwingUp-v0", **settings)] * 3, autoreset_mode=AutoresetMode(mode))

    def wrapped(envs):
        envs = wrappers.RecordEpisodeStatistics(envs)
        # Gymnasium refuses this wrapper for the other mode.
        return wrappers.NormalizeObservation(envs) if mode == "NextStep" else envs

    pair = [wrapped(made(autoreset_mode=mode, **settings)), wrapped(theirs)]
    assert np.array_equal(*[envs.reset(seed=3)[0] for envs in pair])
    ended = 0
    for _ in range(25):
        (*found, infos), (*wanted, other_infos) = (envs.step(np.ones((3, 1), np.float32)) for envs in pair)
        assert all(np.array_equal(mine, other) for mine, other in zip(found, wanted))
        assert infos.keys() == other_infos.keys()
        if "episode" in infos:
            ended += 1
            # Gymnasium 1.2 does not count the first step after a reset in the same step.
            assert infos["episode"]["l"].tolist() == other_infos["episode"]["l"].tolist()
            assert set(infos["episode"]["l"].tolist()) <= {8, 9}
            np.testing.assert_allclose(infos["episode"]["r"], other_infos["episode"]["r"], rtol=1e-5)
    assert ended == 2 and pair[0].unwrapped.get_attr("dt") == (0.05,) * 3


@pytest.mark.skipif(not hasattr(wrappers, "RecordVideo"), reason="this Gymnasium has no such wrapper")
def test_the_recorder_of_videos_of_gymnasium_gets_a_picture_of_each_step(monkeypatch, tmp_path):
    clips = []

    class ImageSequenceClip:
        """That of MoviePy, which only writes the file."""

        def __init__(self, frames, fps):
            clips.append((list(frames), fps))

        def write_videofile(self, path, logger):
            pass

    for name in ("moviepy", "moviepy.video", "moviepy.video.io", "moviepy.video.io.ImageSequenceClip"):
        monkeypatch.setitem(sys.modules, name, types.ModuleType(name))
    sys.modules["moviepy.video.io.ImageSequenceClip"].ImageSequenceClip = ImageSequenceClip
    envs = made(render_mode="rgb_array")
    envs = wrappers.RecordVideo(envs, str(tmp_path / "videos"), step_trigger=lambda step: step == 0, video_length=5)
    envs.reset(seed=0)
    for _ in range(7):
        envs.step(np.full((3, 1), 2.0, np.float32))
    envs.close()
    [(frames, fps)] = clips
    assert len(frames) >= 5 and fps == 20 and frames[0].shape == (300, 900, 3)
    assert (frames[0] != frames[4]).any()


# Positions have no bounds, and accelerations a unit.
@pytest.mark.filterwarnings("ignore:.*Box observation space.*:UserWarning")
@pytest.mark.filterwarnings("ignore:.*For Box action spaces.*:UserWarning")
def test_the_checker_of_gymnasium_accepts_single_environments_with_attributes():
    check_env(gymnasium.make("libration/PendulumSwingUp-v0", render_mode="rgb_array", **GIVEN).unwrapped)
