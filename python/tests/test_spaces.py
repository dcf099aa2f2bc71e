"""Spaces of environments."""

import subprocess
import sys

import numpy as np
import pytest

import libration

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
