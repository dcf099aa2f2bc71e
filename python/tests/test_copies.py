"""Copies of environments: they continue as the original does, and nothing that one does changes the other."""

import copy
import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError, ResetNeeded

import libration
from libration.classic_control import CartPoleEnv, CartPoleVectorEnv
from libration.envs import PendulumEnv

SPRING = libration.System(acceleration={"q": "-10*q + u"}, inputs=["u"])


class CountingEnv(CartPoleEnv):
    """A subclass with an attribute of its own."""

    def __init__(self):
        super().__init__(starts="gymnasium")
        self.counts = {"steps": 0}

    def step(self, action):
        self.counts["steps"] += 1
        return super().step(action)


def cost(before, actions, after):
    return -after[:, 0]


SINGLE = {
    "preset": PendulumEnv,
    "equations": lambda: gymnasium.make("libration/System-v0", system=SPRING, dt=0.1, reward="-q^2").unwrapped,
    "twin": CartPoleEnv,
    "subclass": CountingEnv,
}
VECTOR = {
    "Environments": lambda: libration.Environments("Pendulum", 2),
    "preset": lambda: libration.VectorEnv("Pendulum", 2),
    "twin": lambda: CartPoleVectorEnv(2, starts="gymnasium", copy=False),
    "task": lambda: libration.CustomTaskVectorEnv("Pendulum", 2, task=cost),
}
COPIES = {"copy": copy.copy, "deepcopy": copy.deepcopy, "pickle": lambda env: pickle.loads(pickle.dumps(env))}


def state_of(env):
    return np.copy(env.states if hasattr(env, "states") else env.state)


@pytest.mark.parametrize("how", COPIES)
@pytest.mark.parametrize("make", [*SINGLE.values(), *VECTOR.values()], ids=[*SINGLE, *(f"vector-{name}" for name in VECTOR)])
def test_a_copy_has_the_state_of_the_original_and_moves_independently_of_it(make, how):
    env = make()
    env.reset(seed=3)
    actions = [env.action_space.sample() for _ in range(5)]
    env.step(actions[0])
    has_generator = getattr(env, "np_random", None) is not None
    other = COPIES[how](env)
    before = state_of(env)
    np.testing.assert_array_equal(state_of(other), before)
    wanted = [np.copy(env.step(action)[0]) for action in actions]
    np.testing.assert_array_equal(state_of(other), before)
    found = [np.copy(other.step(action)[0]) for action in actions]
    np.testing.assert_array_equal(found, wanted)
    if has_generator:
        assert other.np_random is not env.np_random
    if isinstance(env, CountingEnv):
        assert (env.counts, other.counts) == ({"steps": 6}, {"steps": 6})


@pytest.mark.parametrize("how", COPIES)
@pytest.mark.parametrize("make", SINGLE.values(), ids=SINGLE)
def test_copies_of_single_environments_raise_the_errors_of_gymnasium(make, how):
    env = COPIES[how](make())
    action = env.action_space.sample()
    with pytest.raises(ResetNeeded):
        env.step(action)
    with pytest.raises(ResetNeeded):
        env.set_state(env.state)
    env.reset(seed=0)
    env.close()
    with pytest.raises(ClosedEnvironmentError):
        env.step(action)


def test_environments_of_linear_plants_refuse_every_copy():
    env = libration.LinearVectorEnv(libration.LinearPlant.mechanical(1.0, 0.1, 10.0, 1.0), 2, period=0.01)
    for how in COPIES.values():
        with pytest.raises(TypeError, match="cannot be .*; help: make others with the same arguments"):
            how(env)
