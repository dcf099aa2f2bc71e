"""Attributes of Gymnasium's classic control on its twins."""

import copy
import pickle

import gymnasium
import numpy as np
import pytest

from libration import Uniform
from libration._attributes import keywords_of
from libration._classic_systems import CLASSIC
from libration.classic_control import AcrobotEnv, CartPoleEnv, CartPoleVectorEnv, MountainCarEnv, PendulumEnv

IDS = [each.id for each in CLASSIC.values()]
# Those that Gymnasium sets on every environment, and those of a run or a picture.
OF_GYMNASIUM = {"action_space", "metadata", "np_random", "np_random_seed", "observation_space", "render_mode", "spec", "unwrapped"}
OF_RUNS = {"action_arrow", "clock", "domain_fig", "isopen", "last_u", "prev_done", "screen", "screens", "state", "steps", "steps_beyond_terminated", "surf"}


def public(env):
    names = [name for name in dir(env) if not name.startswith("_") and name not in OF_GYMNASIUM]
    return {name: getattr(env, name) for name in names if not callable(getattr(env, name))}


@pytest.mark.parametrize("id", IDS)
def test_attributes_of_gymnasium_have_their_values_and_cannot_be_set(id):
    own = gymnasium.make(f"libration/{id}").unwrapped
    own.reset(seed=0)
    for name, value in public(gymnasium.make(id).unwrapped).items():
        if name not in OF_RUNS:
            assert np.array_equal(getattr(own, name), value), name
        with pytest.raises(AttributeError, match=rf"{name} of {CLASSIC[id.partition('-')[0]].name}Env cannot be set to .*; help: "):
            setattr(own, name, value)


def test_attributes_of_the_vector_environment_of_gymnasium_have_their_values_and_cannot_be_set():
    own = gymnasium.make_vec("libration/CartPole-v1", num_envs=3).unwrapped
    own.reset(seed=0)
    theirs = public(gymnasium.make_vec("CartPole-v1", num_envs=3).unwrapped)
    shared = {name: value for name, value in theirs.items() if not hasattr(gymnasium.vector.VectorEnv, name) and "space" not in name}
    assert {"length", "tau", "max_episode_steps", "low", "steps"} <= set(shared)
    for name, value in shared.items():
        if name not in {"num_envs", "low", "high"} | OF_RUNS:
            assert getattr(own, name) == value and own.get_attr(name) == (value,) * 3, name
        if name != "num_envs":
            for set_it in (lambda: setattr(own, name, value), lambda: own.set_attr(name, value)):
                with pytest.raises(AttributeError, match=rf"{name} .*cannot be set to .*; help: "):
                    set_it()


@pytest.mark.parametrize(
    ("name", "value", "help"),
    [
        ("length", 1.0, "CartPoleEnv(length=1.0)"),
        ("force_mag", 5, "CartPoleEnv(force_mag=5)"),
        ("tau", 0.01, "CartPoleEnv(dt=0.01)"),
        ("theta_threshold_radians", 0.4, "CartPoleEnv(terminated=['x < -2.4', 'x > 2.4', 'theta < -0.4', 'theta > 0.4'])"),
        ("x_threshold", 1.0, f"CartPoleEnv(terminated=['x < -1.0', 'x > 1.0', 'theta < -{np.pi / 15}', 'theta > {np.pi / 15}'])"),
        ("kinematics_integrator", "semi-implicit", "CartPoleEnv(integrator='symplectic-euler')"),
    ],
)
def test_the_help_of_an_attribute_makes_the_environment_that_gymnasium_has_with_it(name, value, help):
    with pytest.raises(AttributeError) as caught:
        setattr(gymnasium.make("libration/CartPole-v1").unwrapped, name, value)
    assert str(caught.value).endswith(f"help: make another environment: {help}")
    own = eval(help.replace("CartPoleEnv(", "CartPoleEnv(starts='gymnasium', "))
    other = gymnasium.make("CartPole-v1").unwrapped
    setattr(other, name, value)
    other.polemass_length = other.masspole * other.length
    assert np.array_equal(own.reset(seed=2)[0], other.reset(seed=2)[0])
    ended = False
    for step in range(200):
        one, two = own.step(step // 3 % 2), other.step(step // 3 % 2)
        assert np.array_equal(one[0], two[0]) and one[1:4] == two[1:4]
        if ended := one[2]:
            break
    assert ended


def test_the_help_of_a_single_goal_has_the_task_of_gymnasium():
    with pytest.raises(AttributeError, match=r"MountainCarEnv\(terminated=\[\"min\(x - 0.3, x' - goal_velocity\) >= 0\"\]\)"):
        gymnasium.make("libration/MountainCar-v0").unwrapped.goal_position = 0.3
    with pytest.raises(AttributeError, match=r"PendulumEnv\(max_action=1.0\)"):
        PendulumEnv().max_torque = 1.0
    with pytest.raises(AttributeError, match=r"PendulumEnv\(project=\{…\}\)"):
        PendulumEnv().max_speed = 1.0
    with pytest.raises(AttributeError, match=r"state .*help: set_state"):
        CartPoleEnv().state = np.zeros(4)


def test_an_attribute_that_varies_is_that_of_the_current_episode():
    env = gymnasium.make("libration/CartPole-v1", length=Uniform(0.3, 0.7), masspole=0.2).unwrapped
    env.reset(seed=1)
    assert env.length == env.parameters["length"] != 0.5 and env.total_mass == 1.2
    assert env.polemass_length == 0.2 * env.length
    envs = CartPoleVectorEnv(3, length=Uniform(0.3, 0.7))
    envs.reset(seed=1)
    assert np.array_equal(envs.length, envs.parameters["length"]) and envs.length.shape == (3,)
    assert envs.get_attr("polemass_length") == tuple(0.1 * envs.parameters["length"])


@pytest.mark.parametrize(
    ("made", "change"),
    [
        (CartPoleVectorEnv, lambda envs: envs.get_attr("actions")[0].reverse()),
        (CartPoleVectorEnv, lambda envs: envs.get_attr("start")[0].clear()),
        (CartPoleEnv, lambda env: env.get_wrapper_attr("terminated").clear()),
        (AcrobotEnv, lambda env: env.AVAIL_TORQUE.append(3.0)),
        (MountainCarEnv, lambda env: env.low.fill(5)),
        (CartPoleEnv, lambda env: env.metadata["render_modes"].clear()),
    ],
)
def test_a_change_of_what_was_read_leaves_other_twins(made, change):
    def seen(env):
        env.reset(seed=1)
        actions = [1] * getattr(env, "num_envs", 1)
        steps = [env.step(actions if "Vector" in made.__name__ else 1)[0].tolist() for _ in range(5)]
        table = {name: np.asarray(getattr(env, name)).tolist() for name in ("AVAIL_TORQUE", "low", "x_threshold") if hasattr(env, name)}
        return copy.deepcopy((steps, table, keywords_of(env._batch()), env.action_space, env.metadata))

    unchanged, first = seen(made()), made()
    change(first)
    assert seen(first)[:4] == unchanged[:4]
    assert seen(made()) == unchanged == seen(copy.deepcopy(made()))


def test_a_task_of_the_caller_has_no_attributes_of_gymnasiums_task():
    env = CartPoleEnv(terminated=["x > 1"])
    with pytest.raises(AttributeError, match=r"no 'x_threshold': terminated is \['x > 1'\]"):
        env.x_threshold
    assert not hasattr(env, "theta_threshold_radians") and env.length == 0.5
    assert not hasattr(env, "lenght") and not hasattr(env, "_nothing")


@pytest.mark.parametrize("made", [CartPoleEnv, CartPoleVectorEnv])
def test_copies_and_pickles_have_and_refuse_the_attributes(made):
    env = made(length=0.7)
    for other in (copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        assert other.length == 0.7
        with pytest.raises(AttributeError, match=r"length=1.0"):
            other.length = 1.0
        other.mine = 3
        assert other.mine == 3


@pytest.mark.parametrize(("id", "keyword", "attribute"), [("CartPole-v1", "length", "length"), ("Acrobot-v1", "l1", "LINK_LENGTH_1")])
def test_a_picture_has_the_length_of_its_episode(monkeypatch, id, keyword, attribute):
    drawn = type(gymnasium.make(id).unwrapped)
    # Without Pygame: only the number that Gymnasium draws.
    monkeypatch.setattr(drawn, "render", lambda env: getattr(env, attribute))
    env = gymnasium.make(f"libration/{id}", render_mode="rgb_array", **{keyword: 0.9}).unwrapped
    env.reset(seed=0)
    assert env.render() == 0.9
    envs = gymnasium.make_vec(f"libration/{id}", 3, render_mode="rgb_array", **{keyword: Uniform(0.3, 0.7)})
    envs.reset(seed=0)
    assert envs.render() == tuple(envs.parameters[keyword])
