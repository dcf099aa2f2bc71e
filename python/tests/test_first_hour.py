"""What a first user meets: what is meant is done, and what cannot be meant is named."""

from __future__ import annotations

import math
import warnings

import gymnasium
import numpy as np
import pytest

import libration
from libration.policies import MLP


@pytest.mark.parametrize(
    ("given", "error", "told"),
    [
        ({"copy": "no"}, TypeError, "copy must be True or False, not str"),
        ({"buffers": 4}, TypeError, "buffers is given, but it belongs to copy=False"),
        ({"m": 2.0}, TypeError, "m is given alone"),
        ({"k": 2.0}, TypeError, "k is given alone"),
        ({"render_mode": "rgb_array"}, TypeError, "'render_mode': it belongs to VectorEnv"),
    ],
)
def test_keywords_without_effect_are_refused(given, error, told):
    with pytest.raises(error, match=told):
        libration.Environments("Oscillator", 2, **given)


@pytest.mark.parametrize("law", [libration.Gaussian, libration.Uniform])
@pytest.mark.parametrize("rms", [-1.0, math.inf, math.nan])
def test_a_distribution_needs_a_standard_deviation(law, rms):
    with pytest.raises(ValueError, match="std is .*, but it must be finite and at least 0"):
        law(rms)


def test_minus_one_is_no_limit_of_an_episode_as_in_gymnasium():
    for limit in (-1, math.inf):
        envs = libration.Environments("Pendulum", 1, max_episode_steps=limit)
        envs.reset(seed=0)
        ended = [envs.step(np.zeros((1, 1), np.float32))[3].any() for _ in range(500)]
        assert not any(ended)
    with pytest.raises(ValueError, match="max_episode_steps is -2"):
        libration.Environments("Pendulum", 1, max_episode_steps=-2)


def test_many_substeps_are_told_with_latencies_that_need_few():
    with pytest.warns(UserWarning, match=r"takes 500 substeps.*at most 20: action_delay of 0 to 0.0325 s") as told:
        envs = libration.Environments("Oscillator", 2, dt=0.05, action_delay=(0.0, 0.0333))
    assert envs.substeps == 500
    named = float(str(told[0].message).rsplit(" to ", 1)[1].split(" ")[0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # The latency that the warning names needs at most 20 substeps; substeps that are given need no warning.
        assert libration.Environments("Oscillator", 2, dt=0.05, action_delay=(0.0, named)).substeps <= 20
        assert libration.Environments("Oscillator", 2, dt=0.05, action_delay=0.0333, substeps=500).substeps == 500
        assert libration.Environments("Oscillator", 2, dt=0.05, action_delay=0.1).substeps == 1


def test_a_list_of_seeds_leaves_no_stale_seed():
    envs = gymnasium.make_vec("libration/Oscillator-v0", 2)
    envs.reset(seed=5)
    assert envs.np_random_seed == 5
    envs.reset(seed=[8, 9])
    assert envs.np_random_seed == -1


def test_pictures_are_shown_in_real_time():
    for dt in (0.01, 0.05):
        assert gymnasium.make("libration/Oscillator-v0", dt=dt).metadata["render_fps"] == round(1 / dt)
        assert libration.VectorEnv("Oscillator", 2, dt=dt, action_delay=dt / 2).metadata["render_fps"] == round(1 / dt)


def test_environments_tell_what_they_are_and_close():
    envs = libration.Environments("Pendulum", 3, dt=0.02)
    assert repr(envs) == "Environments('Pendulum', num_envs=3, dt=0.02, substeps=1, integrator='velocity-verlet', dtype='float32')"
    envs.reset(seed=0)
    envs.close()
    with pytest.raises(RuntimeError, match="closed"):
        envs.step(np.zeros((3, 1), np.float32))


def test_layers_may_have_gradients():
    class Parameter:
        """What PyTorch's parameters do: NumPy gets them only detached."""

        def __init__(self, values):
            self.values = np.asarray(values, dtype=np.float32)

        def __array__(self, *_, **__):
            raise RuntimeError("Can't call numpy() on Tensor that requires grad.")

        def detach(self):
            return self

        def cpu(self):
            return self.values

    envs = [libration.Environments("Oscillator", 2) for _ in range(2)]
    layer = ([[-2.0, -1.0]], [0.5])
    policies = [MLP([layer]), MLP([tuple(Parameter(part) for part in layer)])]
    for one in envs:
        one.reset(seed=1)
    results = [one.rollout(policy, 5).observations for one, policy in zip(envs, policies)]
    assert np.array_equal(*results)
