"""Specs of Gymnasium with distributions, arrays and systems: JSON, text, and the environments that they make."""

import copy
import json
from fractions import Fraction

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode

import libration
from libration import PD, Gaussian, LogUniform, Uniform

SYSTEM = libration.System(
    acceleration={"q": "-k*q + u"}, parameters={"k": 10.0}, inputs=["u"], task={"reward": "-q^2", "start": {"q": (-1, 1)}}, name="spring"
).replace(k=7.0)
ARM = libration.System(
    acceleration={"x": "u", "y": "w"}, inputs=["u", "w"], task={"reward": "-x^2", "start": {"x": (-1, 1)}}, name="arm"
)
PENDULUM, CART, OWN = "libration/PendulumSwingUp-v0", "libration/CartPole-v1", "libration/System-v0"

CASES = [
    (PENDULUM, {"omega2": Uniform(10, 20), "velocity_cost": LogUniform(0.01, 1), "effort_cost": Gaussian(0.0001, mean=0.001)}),
    (PENDULUM, {"action_delay": (0.0, 0.05), "observation_delay": Uniform(0, 0.1), "jitter": Uniform(0.1), "skew": Gaussian(0.01)}),
    (PENDULUM, {"jitter": Uniform(0, 0.1), "observation_noise": ("uniform", Uniform(0, 0.02)), "max_action": Uniform(2, 4)}),
    (PENDULUM, {"dtype": np.float64, "omega2": np.float64(12.0), "threads": np.int64(1)}),
    (PENDULUM, {"dt": Fraction(1, 50), "omega2": Uniform(Fraction(21, 2), np.float32(12)), "start_position": (Fraction(-1, 2), np.array(0.5))}),
    (CART, {"length": Uniform(0.3, 0.7), "starts": "gymnasium"}),
    (OWN, {"system": SYSTEM, "dt": 0.01, "k": LogUniform(1, 10), "start": {"q": Uniform(-2, 2)}}),
    (OWN, {"system": SYSTEM, "dt": 0.02, "inner": PD(40.0, 6.0), "inner_period": 0.01}),
    (OWN, {"system": ARM, "dt": 0.02, "max_action": [Uniform(1, 2), 3.0]}),
]
OF_VECTORS = [
    (PENDULUM, {"omega2": np.array([10.0, 12.0, 14.0]), "autoreset_mode": AutoresetMode.SAME_STEP, "max_action": np.array([1.0, 2.0, 3.0])}),
    (OWN, {"system": ARM, "dt": 0.02, "max_action": np.arange(1.0, 7.0).reshape(3, 2)}),
]


def assert_equal(one, other):
    one.action_space.seed(5)
    assert one.unwrapped.__class__ is other.unwrapped.__class__ and one.action_space == other.action_space
    assert np.array_equal(one.reset(seed=3)[0], other.reset(seed=3)[0])
    for _ in range(15):
        action = one.action_space.sample()
        for mine, wanted in zip(one.step(action)[:4], other.step(action)[:4]):
            assert np.array_equal(mine, wanted)


@pytest.mark.parametrize(("id", "given"), CASES)
def test_a_spec_in_json_makes_the_same_environment(id, given):
    env = gymnasium.make(id, **given)
    spec = EnvSpec.from_json(env.spec.to_json())
    assert spec == env.spec and json.loads(env.spec.to_json())["kwargs"] == env.spec.kwargs
    again = gymnasium.make(spec)
    assert again.spec == env.spec
    assert_equal(again, env)


@pytest.mark.parametrize(("id", "given"), CASES + OF_VECTORS)
def test_a_spec_of_a_batch_in_json_makes_the_same_batch(id, given):
    envs = gymnasium.make_vec(id, 3, **given)
    spec = EnvSpec.from_json(envs.spec.to_json())
    assert spec == envs.spec
    again = gymnasium.make_vec(spec)
    assert again.spec == envs.spec and again.num_envs == 3
    assert_equal(again, envs)
    assert_equal(gymnasium.make_vec(envs.spec), envs)


def test_a_spec_shows_distributions_in_words():
    env = gymnasium.make(PENDULUM, omega2=Uniform(10, 20), velocity_cost=LogUniform(0.01, 1))
    assert env.spec.kwargs == {"omega2": ["uniform", 10.0, 20.0], "velocity_cost": ["log-uniform", 0.01, 1.0]}
    assert env.spec.pprint(disable_print=True).startswith(f"id={PENDULUM}\nmax_episode_steps=200")
    assert env.get_wrapper_attr("omega2") == Uniform(10, 20)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"omega2": ["uniform", 20, 10]}, "Uniform is from 20"),
        ({"omega2": ["log-uniform", 0, 10]}, "low is 0"),
        ({"omega2": ["uniform", 0.1]}, "omega2"),
        ({"omega2": ["unifrom", 1, 2]}, "omega2"),
        ({"omega2": ["uniform", None, 2]}, "omega2"),
        ({"velocity_cost": ["log-uniform", {}, 2], "num_envs": 3}, r"velocity_cost\[0\] must be a number"),
        ({"jitter": ["gaussian", None, 0.1]}, "jitter"),
        ({"action_delay": ["uniform", 0.0, None]}, "action_delay"),
    ],
)
def test_wrong_distributions_in_words_are_refused(given, text):
    with pytest.raises((TypeError, ValueError), match=text):
        libration.Environments("Pendulum", **given)


@pytest.mark.parametrize(
    ("entry", "text"),
    [
        ({"parameters": [1]}, r"parameters of system is \[1\], but it must be a dictionary of numbers"),
        ({"parameters": {"k": "1"}}, "parameter 'k' of system must be a number, not str"),
        ({"text": 1}, "text of system is 1, but it must be a string"),
        ({"file": None}, "file of system is None, but it must be a string"),
    ],
)
def test_a_wrong_dictionary_of_a_system_is_an_error_with_its_entry(entry, text):
    system = gymnasium.make(OWN, system=SYSTEM, dt=0.01).spec.kwargs["system"]
    assert gymnasium.make(OWN, system=system, dt=0.01).unwrapped.parameters == {}
    with pytest.raises(TypeError, match=text):
        libration.envs.SystemEnv({**system, **entry}, dt=0.01)


def test_a_change_of_what_was_given_leaves_the_environment_and_its_copies():
    costs, actions = np.array([0.1, 0.2]), [-1.0, 1.0]
    envs, twins = libration.VectorEnv("Pendulum", 2, velocity_cost=costs), gymnasium.make_vec(CART, 2, actions=actions, length=costs)
    costs[:] = 5.0
    actions.append(2.0)
    for other in (copy.deepcopy(envs), copy.deepcopy(twins.unwrapped)):
        other.reset(seed=0)
        assert other.get_attr("velocity_cost" if other.get_attr("dt")[0] == 0.05 else "length") == (0.1, 0.2)
    assert copy.deepcopy(twins.unwrapped).single_action_space.n == 2


def test_what_json_cannot_have_fails_as_gymnasium_says():
    class Latency:
        def action_delay(self, dt, substeps=None):
            return 0.0, dt

    env = gymnasium.make(PENDULUM, action_delay=Latency())
    with pytest.raises(TypeError, match="Latency is not JSON serializable"):
        env.spec.to_json()
