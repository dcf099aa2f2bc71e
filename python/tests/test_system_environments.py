"""Environments of systems by equations."""

import copy
import pickle
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import libration

SYSTEMS = Path(__file__).parents[2] / "examples" / "systems"


def cart(**parameters):
    return libration.System.from_toml(SYSTEMS / "cart_pole.toml", **parameters)


def quadrotor():
    return libration.System.from_toml(SYSTEMS / "planar_quadrotor.toml")


SPRING = libration.System(acceleration={"q": "-10*q + u"}, inputs=["u"])
TASK = {
    "reward": "-(q*q + 0.1*(q'*q') + 0.001*(u*u))",
    "terminated": ["q > 0.9", "q < -0.9"],
    "start": {"q": (-1, 1), "q'": (-1, 1)},
}


@pytest.mark.parametrize("mode", ["SameStep", "NextStep"])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_environments_of_equations_have_the_bits_of_the_preset(dtype, mode):
    common = {"dtype": dtype, "autoreset_mode": mode, "jitter": 0.1, "skew": 0.01, "observation_noise": 0.01}
    common |= {"action_delay": 0.03, "observation_delay": (0.0, 0.02), "max_action": 3.0, "max_episode_steps": 60}
    preset = libration.Environments("Oscillator", 70, bound=0.9, **common)
    own = libration.Environments(SPRING, 70, dt=0.01, **TASK, **common)
    rng = np.random.default_rng(3)
    assert np.array_equal(preset.reset(seed=5)[0], own.reset(seed=5)[0])
    for _ in range(100):
        actions = rng.uniform(-4, 4, (70, 1)).astype(dtype)
        for wanted, found in zip(preset.step(actions)[:4], own.step(actions)[:4]):
            assert np.array_equal(wanted, found)
    for policy in (libration.policies.Linear([-5.0, -1.0], 0.1), libration.policies.Random(-2, 1)):
        wanted, found = (e.rollout(policy, 80, log_probs=True) for e in (preset, own))
        for name in ("observations", "actions", "rewards", "terminated", "truncated", "log_probs"):
            assert np.array_equal(getattr(wanted, name), getattr(found, name)), name
        assert np.array_equal(wanted.last_observations, found.last_observations)
        assert len(wanted.episodes["returns"]) > 70
        for name, column in wanted.episodes.items():
            assert np.array_equal(column, found.episodes[name]), name


def test_the_task_of_a_system_is_that_of_the_keywords():
    own = libration.System(acceleration={"q": "-10*q + u"}, inputs=["u"], task=TASK)
    by_system, by_keywords = libration.Environments(own, 9, dt=0.01), libration.Environments(SPRING, 9, dt=0.01, **TASK)
    assert np.array_equal(by_system.reset(seed=5)[0], by_keywords.reset(seed=5)[0])
    for _ in range(50):
        for found, wanted in zip(by_system.step(np.full((9, 1), 3.0))[:4], by_keywords.step(np.full((9, 1), 3.0))[:4]):
            assert np.array_equal(found, wanted)


def test_the_task_of_a_file_is_that_of_its_expressions():
    environments = libration.Environments(cart(), 200, dt=0.02, integrator="rk4", dtype="float64", max_action=2.0)
    observations, _ = environments.reset(seed=1)
    assert np.abs(observations).max() <= 0.05
    rng, ended = np.random.default_rng(0), 0
    for _ in range(200):
        actions = rng.uniform(-4, 4, (200, 1))
        observations, rewards, terminated, truncated, _ = environments.step(actions)
        x, _, theta, _ = observations.T
        assert np.array_equal(environments.states[:, :2], observations[:, ::2])
        over = (np.abs(x) > 2.4) | (np.abs(theta) > 12 * np.pi / 180)
        assert np.array_equal(terminated, over) and not truncated.any()
        # In the step of a reset nothing is paid.
        paid = np.where(rewards == 0, 0, 1 - 0.001 * np.clip(actions[:, 0], -2, 2) ** 2)
        assert np.allclose(rewards, paid, rtol=1e-15)
        ended += terminated.sum()
    assert ended > 50


def test_several_inputs_have_limits_of_their_own_and_the_steps_of_a_second_program():
    environments = libration.Environments(quadrotor(), 3, dt=0.05, integrator="symplectic-euler", dtype="float64", max_action=[1, 2])
    environments.reset(seed=2)
    before = environments.states
    actions = np.array([[3.0, -0.5], [-0.2, 5.0], [0.3, -7.0]])
    observations, rewards, *_ = environments.step(actions)
    left, right = np.clip(actions[:, 0], -1, 1), np.clip(actions[:, 1], -2, 2)
    (x, z, theta, vx, vz, w), m, g = before.T, 0.5, 9.81
    lift = m * g + left + right
    vx, vz = vx + 0.05 * (-lift * np.sin(theta) - 0.1 * vx) / m, vz + 0.05 * ((lift * np.cos(theta) - 0.1 * vz) / m - g)
    w = w + 0.05 * 0.15 * (right - left) / 0.004
    x, z, theta = x + 0.05 * vx, z + 0.05 * vz, theta + 0.05 * w
    wanted = np.column_stack([x, vx, z, vz, np.sin(theta), np.cos(theta), w])
    # Some ten roundings of numbers of about 10.
    assert np.allclose(observations, wanted, rtol=0, atol=100 * np.finfo(float).eps)
    paid = -(x**2 + z**2 + 0.1 * (vx**2 + vz**2) + theta**2 + 0.01 * (left**2 + right**2))
    assert np.allclose(rewards, paid, rtol=1e-13)


def test_copies_and_pickles_go_on_with_the_same_bits():
    environments = libration.VectorEnv(quadrotor(), 5, dt=0.02, action_delay=0.04, jitter=0.1, observation_noise=0.01)
    environments.reset(seed=3)
    environments.step(np.ones((5, 2)))
    twins = [copy.deepcopy(environments), pickle.loads(pickle.dumps(environments))]
    for _ in range(20):
        wanted = environments.step(np.zeros((5, 2)))
        for twin in twins:
            found = twin.step(np.zeros((5, 2)))
            assert all(np.array_equal(a, b) for a, b in zip(wanted[:4], found[:4]))


def test_an_environment_does_not_depend_on_the_number_of_others_or_threads():
    given = {"dt": 0.02, "jitter": 0.1, "observation_noise": 0.01, "action_delay": (0.0, 0.04), "max_action": 1.0}
    many = libration.Environments(cart(), 300, threads=2, **given)
    one = libration.Environments(cart(), 1, **given)
    many.reset(seed=[None] * 250 + [9] + [None] * 49)
    one.reset(seed=[9])
    for _ in range(150):
        found, wanted = many.step(np.zeros((300, 1))), one.step(np.zeros((1, 1)))
        assert all(np.array_equal(a[250], b[0]) for a, b in zip(found[:4], wanted[:4]))


@pytest.mark.filterwarnings("ignore:.*Box (action|observation) space.*")
def test_gymnasium_takes_environments_of_equations():
    check_env(gymnasium.make("libration/System-v0", system=cart(), dt=0.02, max_action=10.0).unwrapped)
    environments = gymnasium.make_vec("libration/System-v0", num_envs=4, system=quadrotor(), dt=0.02, max_action=[1, 2])
    assert environments.single_action_space.high.tolist() == [1, 2]
    assert environments.single_observation_space.high.tolist() == [np.inf] * 4 + [1, 1, np.inf]
    observations, _ = environments.reset(seed=0)
    assert environments.observation_space.contains(observations)
    limited = gymnasium.make("libration/System-v0", system=cart(), dt=0.02, max_episode_steps=3)
    limited.reset(seed=0)
    assert [limited.step(np.zeros(1, np.float32))[3] for _ in range(3)] == [False, False, True]


def test_tasks_in_python_take_systems_by_equations():
    paid = lambda before, actions, after: -(after**2).sum(axis=1) - actions.sum(axis=1)  # noqa: E731
    environments = libration.CustomTaskVectorEnv(quadrotor(), 4, task=paid, dt=0.02, max_action=[1, 2])
    environments.reset(seed=0)
    rewards = environments.step(np.full((4, 2), 5.0))[1]
    assert np.allclose(rewards, -(environments.states**2).sum(axis=1) - 3, rtol=1e-6)
    with pytest.raises(TypeError, match="'reward': the task determines rewards"):
        libration.CustomTaskVectorEnv(quadrotor(), 4, task=paid, dt=0.02, reward="1")


@pytest.mark.parametrize(
    "given, error, message",
    [
        ({"reward": "x +"}, ValueError, r"found the end(.|\n)*\"reward\" = \"x \+\"\n(.|\n)*\^"),
        ({"observe": ["thetta"]}, ValueError, "did you mean `theta`"),
        ({"terminated": ["x"]}, ValueError, "expected an operator or a comparison"),
        ({"terminated": "x > 1"}, TypeError, "terminated is 'x > 1', but it must be a list"),
        ({"observe": []}, ValueError, "`observe` is empty"),
        ({"observe": ["before(x)"]}, ValueError, r"unknown name `before\(x\)`"),
        ({"terminated": ["u > 1"]}, ValueError, "unknown name `u`"),
        ({"start": {"y": 0}}, ValueError, "unknown state `y`"),
        ({"start": {"x": (1, 0)}}, ValueError, "low must be at most high"),
        ({"rewrd": "1"}, TypeError, "did you mean 'reward'"),
        ({"start_position": 1.0}, TypeError, "belongs to environments of the catalogue"),
        ({"max_action": [1, 2]}, ValueError, "max_action has 2 numbers, but it must have one or 1"),
        ({"observation_noise": [0.1, 0.2]}, ValueError, "observation_noise has 2 numbers"),
        ({"dt": None}, TypeError, "dt is required"),
    ],
)
def test_what_is_wrong_with_a_task_is_said_with_its_name(given, error, message):
    with pytest.raises(error, match=message):
        libration.Environments(cart(), **{"dt": 0.02, **given})


def test_what_environments_of_equations_need_is_said():
    with pytest.raises(ValueError, match="no inputs, but actions need at least one"):
        libration.Environments(libration.System(acceleration={"x": "-x"}), dt=0.1, reward="1")
    with pytest.raises(TypeError, match="reward is required"):
        libration.Environments(SPRING, dt=0.1, observe=["q"])
    with pytest.raises(ValueError, match="reward is required"):
        libration.Environments(SPRING, dt=0.1)
    with pytest.raises(TypeError, match="reward belongs to environments of a System"):
        libration.Environments("Oscillator", reward="1")
    environments = libration.Environments(quadrotor(), 2, dt=0.1)
    environments.reset(seed=0)
    with pytest.raises(ValueError, match=r"actions have shape \(2, 1\), but it must be \(2, 2\)"):
        environments.step(np.zeros((2, 1)))
    with pytest.raises(ValueError, match=r"actions\[1, 0\] is NaN"):
        environments.step(np.array([[0, 0], [np.nan, 0]]))
    with pytest.raises(ValueError, match="there are 3 weights, but there must be 14"):
        environments.rollout(libration.policies.Linear([1, 2, 3]), 5)
