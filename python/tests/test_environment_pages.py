"""The documentation of each environment class: its sections, and numbers that are those of the environment."""

import ast
import inspect
import math
import re

import gymnasium
import numpy as np
import pytest

import libration
from common import IDS, NAMES
from libration import _environment_keywords as keywords
from libration import classic_control, envs
from libration._classic_systems import CLASSIC, system_of

SECTIONS = ["Description", "Action space", "Observation space", "Rewards", "Starting state", "Episode end", "Arguments"]
CLASSES = [f"{name}{kind}" for name in (*NAMES, "System") for kind in ("Env", "VectorEnv")]
TWINS = [f"{name}{kind}" for name in CLASSIC for kind in ("Env", "VectorEnv")]
SPRING = libration.System(acceleration={"q": "-10*q + u"}, inputs=["u"], task={"reward": "-q^2 - 0.01*u^2", "start": {"q": (-1, 1)}})


def page_of(name, module=envs):
    return inspect.cleandoc(getattr(module, name).__doc__)


def section(name, title, module=envs):
    return re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", page_of(name, module), re.MULTILINE | re.DOTALL)[1]


def table(name, title, module=envs):
    """The rows of the table of a section, without its head."""
    rows = [line.strip("|").split("|") for line in section(name, title, module).splitlines() if line.startswith("|")]
    assert len(rows[0]) == 5
    return [[cell.strip() for cell in row] for row in rows[2:]]


def limits(rows):
    return np.array([[float(cell) for cell in row[2:4]] for row in rows]).T


def arguments(name, module=envs):
    """The arguments of a page, and the defaults that it states."""
    heads = [line.split(":")[0] for line in section(name, "Arguments", module).splitlines() if line.startswith("- `")]
    return {key: value for head in heads for key, value in re.findall(r"`(\w+)`(?: \(`(.*?)`\))?", head)}


@pytest.mark.parametrize("name", CLASSES)
def test_a_page_has_the_sections_of_gymnasium(name):
    assert re.findall(r"^## (.*)$", page_of(name), re.MULTILINE) == SECTIONS
    assert page_of(name).splitlines()[0].lower().startswith(("environment ``libration/", "vector environment ``libration/"))
    assert all(section(name, title).strip() for title in SECTIONS)


@pytest.mark.parametrize("name", NAMES)
def test_tables_of_a_page_are_the_spaces(name):
    single, vector = gymnasium.make(IDS[name]), gymnasium.make_vec(IDS[name], 3)
    for class_, env in ((f"{name}Env", single), (f"{name}VectorEnv", vector)):
        for title, kind in (("Action space", "action_space"), ("Observation space", "observation_space")):
            space = getattr(env, kind)
            one = getattr(env, f"single_{kind}", space)
            low, high = limits(table(class_, title))
            assert np.array_equal(low, one.low) and np.array_equal(high, one.high)
            shape = str(space.shape).replace("3, ", "num_envs, ", 1) if env is vector else str(space.shape)
            assert f"with shape `{shape}`" in section(class_, title)
    steps = int(re.search(r"after (\d+) actions", section(f"{name}Env", "Episode end"))[1])
    assert single.spec.max_episode_steps == steps


@pytest.mark.parametrize("class_", CLASSES)
def test_a_page_has_each_argument(class_):
    kinds = [class_.replace("VectorEnv", "VectorKeywords").replace("Env", "Keywords")]
    if class_.startswith("System"):
        kinds = ["EngineKeywords", "TaskKeywords", "RenderKeywords", *["BatchKeywords"] * ("Vector" in class_)]
    typed = set().union(*(getattr(keywords, kind).__optional_keys__ for kind in kinds))
    own = {"system"} if class_.startswith("System") else set()
    own |= {"num_envs"} if "Vector" in class_ else set()
    missing = (typed | own) - set(arguments(class_))
    if not class_.startswith("System"):
        missing -= {"m", "k"} if "a mass `m` in kg and a stiffness `k` in N/m" in section(class_, "Arguments") else set()
    assert not missing
    assert set(arguments(class_)) <= typed | own


@pytest.mark.parametrize("name", NAMES)
def test_defaults_of_a_page_are_those_of_the_environment(name):
    stated = {key: ast.literal_eval(value.replace("math.pi", repr(math.pi))) for key, value in arguments(f"{name}Env").items() if value}
    assert {"dt", "omega2" if name != "Duffing" else "alpha", "velocity_cost", "start_position"} <= set(stated)
    env, same = (libration.Environments(name, 4, **given) for given in ({}, {k: v for k, v in stated.items() if k != "render_mode"}))
    assert env._settings == same._settings


@pytest.mark.parametrize("name", NAMES)
def test_the_reward_of_a_page_is_that_of_a_step(name):
    given = {"omega2": 15.0} if name == "Pendulum" else {"bound": 1.2}
    env = libration.Environments(name, 200, dtype="float64", start_position=(-1.5, 1.5), **given)
    observations = env.reset(seed=1)[0]
    (low,), (high,) = limits(table(f"{name}Env", "Action space"))
    actions = np.random.default_rng(2).uniform(2 * low, 2 * high, (200, 1))
    before = env.states
    rewards, terminated = env.step(actions)[1:3]
    u = np.clip(actions[:, 0], low, high)
    if name == "Pendulum":
        q, v = before.T
        theta = q - math.pi
        assert np.allclose(observations, np.stack([np.cos(theta), np.sin(theta), v], axis=1), atol=1e-12)
        assert np.allclose(rewards, np.cos(theta) - 1 - 0.1 * v**2 - 0.001 * u**2, atol=1e-12) and not terminated.any()
    else:
        q, v = env.states.T
        assert np.allclose(observations, before)
        assert np.allclose(rewards, -(1.0 * q**2 + 0.1 * v**2 + 0.001 * u**2), atol=1e-12)
        assert np.array_equal(terminated, np.abs(q) > 1.2) and 0 < terminated.sum() < 200


@pytest.mark.parametrize("name", NAMES)
def test_starts_of_a_page_are_those_of_episodes(name):
    ranges = re.findall(r"\*\[−([\d.π]+), ([\d.π]+)\]\*", section(name + "Env", "Starting state"))
    states = libration.Environments(name, 20_000, dtype="float64")
    states.reset(seed=3)
    assert len(ranges) == 2
    for column, (low, high) in zip(states.states.T, ranges):
        most = math.pi if high == "π" else float(high)
        assert low == high and np.abs(column).max() <= most
        assert column.max() > 0.99 * most and column.min() < -0.99 * most


@pytest.mark.parametrize("name", TWINS)
def test_help_for_a_twin_has_the_sections_of_gymnasium_and_each_argument(name):
    made = getattr(classic_control, name)
    assert re.findall(r"^## (.*)$", inspect.getdoc(made), re.MULTILINE) == SECTIONS
    assert all(section(name, title, classic_control).strip() for title in SECTIONS)
    kind = f"Classic{name.replace('VectorEnv', 'VectorKeywords').replace('Env', 'Keywords')}"
    typed = set(getattr(keywords, kind).__optional_keys__)
    assert set(arguments(name, classic_control)) == typed | ({"num_envs"} if "Vector" in name else set())
    assert kind in str(inspect.signature(made)) and made.__module__ == "libration.classic_control"
    assert "an array `(num_envs,)`" in page_of(name, classic_control)
    common = {*keywords.ClassicKeywords.__optional_keys__, *keywords.BatchKeywords.__optional_keys__}
    assert typed - common == set(system_of(name.removesuffix("Env").removesuffix("Vector")).parameters)


@pytest.mark.parametrize("name", CLASSIC)
def test_tables_and_defaults_of_the_page_of_a_twin_are_those_of_the_environment(name):
    single, envs_of = getattr(classic_control, f"{name}Env"), getattr(classic_control, f"{name}VectorEnv")
    stated = {key: ast.literal_eval(value) for key, value in arguments(f"{name}Env", classic_control).items() if value}
    assert {"dt", "integrator", "dtype", "starts", *system_of(name).parameters} <= set(stated)
    assert {key: stated.pop(key) for key in system_of(name).parameters} == system_of(name).parameters
    env, same, batch = single(), single(**stated), envs_of(3)
    assert env._all._settings == same._all._settings
    for class_, made in ((f"{name}Env", env), (f"{name}VectorEnv", batch)):
        text = section(class_, "Observation space", classic_control)
        low, high = limits(table(class_, "Observation space", classic_control)).astype(np.float32)
        assert np.array_equal(low, env.observation_space.low) and np.array_equal(high, env.observation_space.high)
        assert f"with shape `{str(made.observation_space.shape).replace('3, ', 'num_envs, ', made is batch)}`" in text
    text, space = section(f"{name}Env", "Action space", classic_control), env.action_space
    if isinstance(space, gymnasium.spaces.Discrete):
        assert f"`{space}`" in text and len(re.findall(r"^- \d:", text, re.MULTILINE)) == space.n
    else:
        assert np.array_equal(limits(table(f"{name}Env", "Action space", classic_control)), [space.low, space.high])
    assert f"after {CLASSIC[name].max_episode_steps} actions" in section(f"{name}Env", "Episode end", classic_control)


def test_each_integrator_but_the_exact_one_is_that_of_an_environment():
    for integrator in libration.INTEGRATORS:
        if integrator == "exact":
            with pytest.raises(ValueError):
                libration.Environments("Pendulum", 1, integrator=integrator)
        else:
            libration.Environments("Pendulum", 1, integrator=integrator)


def test_a_system_needs_the_time_between_actions():
    assert arguments("SystemEnv")["dt"] == ""
    with pytest.raises(TypeError, match="dt"):
        envs.SystemEnv(SPRING)
    assert envs.SystemEnv(SPRING, dt=0.01, render_mode="rgb_array").metadata == {"render_modes": ["rgb_array"], "render_fps": 100}
    assert envs.SystemEnv(SPRING, dt=0.01).action_space.high == math.inf
