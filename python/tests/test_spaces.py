"""Spaces of environments."""

import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest

import libration
from libration import classic_control
from libration.classic_control import AcrobotEnv, CartPoleEnv, MountainCarEnv, PendulumEnv

TWO = libration.System(acceleration={"q": "u - 3*q", "p": "w - p"}, inputs=["u", "w"])
SPACES = ("single_observation_space", "single_action_space", "observation_space", "action_space")


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("Pendulum", {}),
        ("Oscillator", {"observation_noise": 0.1, "dtype": "float64"}),
        (TWO, {"dt": 0.1, "reward": "-q^2", "max_action": [1.0, 2.0]}),
        (TWO.replace(), {"dt": 0.1, "reward": "-q^2", "chunk": (3, 1)}),
        (libration.System(acceleration={"q": "u"}, inputs=["u"]), {"dt": 0.1, "reward": "-q^2", "actions": [-1, 1]}),
    ],
)
def test_environments_have_the_spaces_of_the_vector_environment(name, given):
    own, other = libration.Environments(name, 3, **given), libration.VectorEnv(name, 3, **given)
    for space in SPACES:
        assert getattr(own, space) == getattr(other, space)
    observations = own.reset(seed=0)[0]
    assert observations in own.observation_space
    own.action_space.seed(0)
    assert np.shape(own.step(own.action_space.sample())[1]) == (3,)


def test_spaces_without_gymnasium_are_an_error_with_what_to_install():
    code = """
import sys
sys.modules["gymnasium"] = None
import libration
envs = libration.Environments("Pendulum", 2)
envs.reset(seed=0)
for name in ("single_observation_space", "single_action_space", "observation_space", "action_space"):
    try:
        getattr(envs, name)
    except ImportError as error:
        assert "require Gymnasium" in str(error) and "help: pip install" in str(error), error
    else:
        raise AssertionError(name)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("twin", "given"),
    [
        (CartPoleEnv, {"terminated": ["x < -10", "x > 10"]}),
        (CartPoleEnv, {"terminated": ["x > 2.4"]}),
        (CartPoleEnv, {"start": {"x": (5, 6)}}),
        (CartPoleEnv, {"start": {"theta": libration.Uniform(-1, 1)}}),
        (PendulumEnv, {"start": {"theta'": [-20.0, 20.0]}}),
        (MountainCarEnv, {"start": {"x": -2.0}}),
        (AcrobotEnv, {"start": {"theta2'": (0, 60)}}),
    ],
)
def test_observations_of_twins_with_other_ends_or_starts_are_in_their_space(twin, given):
    env = twin(**given)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for seed in range(20):
            observation, _ = env.reset(seed=seed)
            assert observation in env.observation_space
            for _ in range(200):
                observation, _, terminated, _, _ = env.step(env.action_space.sample() if seed else env.action_space.sample() * 0)
                assert observation in env.observation_space
                if terminated:
                    break
    # The vector environment has the same space.
    vector = getattr(classic_control, twin.__name__.replace("Env", "VectorEnv"))
    assert vector(2, **given).single_observation_space == env.observation_space


def test_the_spec_of_a_twin_makes_the_same_space():
    env = gymnasium.make("libration/CartPole-v1", start={"x": libration.Uniform(-5, 5)})
    spec = gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json())
    assert gymnasium.make(spec).observation_space == env.observation_space


def test_twins_whose_starts_lie_within_have_the_space_of_gymnasium():
    for twin, start in ((CartPoleEnv, {"x": (-2, 2)}), (PendulumEnv, {"theta": (-20, 20), "theta'": 8.0}), (AcrobotEnv, {"theta1": (-9, 9)})):
        assert twin(start=start).observation_space == twin().observation_space
