"""Numbers of environments that differ between episodes or environments, and states that a caller gives."""

import copy
import pickle

import numpy as np
import pytest

import libration
from libration import Environments, Gaussian, LogUniform, System, Uniform
from libration.policies import Linear

SPRING = System(
    acceleration={"q": "-omega2*q + u"},
    parameters={"omega2": 10.0},
    inputs=["u"],
    task={"observe": ["q", "q'", "omega2"], "reward": "-q^2 - 0.001*u^2", "start": {"q": (-1, 1)}},
)


def rollout(envs, horizon=64):
    width = len(envs.preset.seen)
    envs.reset(seed=5)
    return envs.rollout(Linear([-3.0, -1.0, 0.5][:width]), horizon)


CONSTANTS = {
    "Oscillator": [{"omega2": 7.0}, {"m": 3.0, "k": 20.0}, {"bound": 0.4}, {"position_cost": 0.3}],
    "Pendulum": [{"omega2": 7.0}, {"velocity_cost": 0.02}],
    "Duffing": [{"alpha": -0.7, "beta": 1.3}, {"effort_cost": 0.2}],
}


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize(("name", "constants"), [(name, each) for name, all_of_them in CONSTANTS.items() for each in all_of_them])
def test_a_range_of_one_number_leaves_every_bit_of_a_preset(name, constants, dtype):
    common = {"num_envs": 37, "dtype": dtype, "action_delay": 0.05, "jitter": 0.1, "max_episode_steps": 30, "autoreset_mode": "SameStep"}
    ranges = {key: Uniform(value, value) for key, value in constants.items()}
    fixed, varied = Environments(name, **common, **constants), Environments(name, **common, **ranges)
    one, other = rollout(fixed), rollout(varied)
    if dtype == "float32" and "m" in constants:
        # k/m and 1/m are quotients of the float type here, and of float64 there: one rounding of a step of the state apart.
        np.testing.assert_allclose(other.observations, one.observations, rtol=0, atol=64 * np.finfo(np.float32).eps)
        return
    assert np.array_equal(one.observations, other.observations) and np.array_equal(one.rewards, other.rewards)
    assert np.array_equal(one.terminated, other.terminated)


def test_each_episode_draws_its_parameters_in_their_ranges():
    drawn = {"omega2": Uniform(10.0, 20.0), "velocity_cost": LogUniform(0.01, 1.0), "effort_cost": Gaussian(0.1, mean=0.5)}
    envs = Environments(
        "Pendulum", 4096, **drawn, max_action=Uniform(2.0, 6.0), jitter=Uniform(0.0, 0.2), action_delay=(0.0, 0.1),
        observation_noise=Uniform(0.1, 0.3), max_episode_steps=2, autoreset_mode="SameStep", parameter_infos=True,
    )
    infos = envs.reset(seed=1)[1]
    first = envs.parameters
    assert set(first) == {*drawn, "max_action", "jitter", "action_delay", "observation_noise"}
    # Means of 4096 draws, within five of their standard errors.
    for name, mean, std in [
        ("omega2", 15.0, 10 / 12**0.5), ("effort_cost", 0.5, 0.1), ("max_action", 4.0, 4 / 12**0.5),
        ("jitter", 0.1, 0.2 / 12**0.5), ("observation_noise", 0.2, 0.2 / 12**0.5),
    ]:
        assert abs(first[name].mean() - mean) < 5 * std / 64, name
    assert abs(np.log(first["velocity_cost"]).mean() - np.log(0.1)) < 5 * np.log(100) / 12**0.5 / 64
    assert set(np.round(first["action_delay"] / 0.05).astype(int)) == {0, 1, 2}
    assert first["omega2"].min() >= 10 and first["omega2"].max() <= 20
    assert np.array_equal(infos["parameters"]["omega2"], first["omega2"]) and infos["_parameters"].all()
    for _ in range(2):
        told = envs.step(np.zeros((4096, 1), np.float32))[4]["parameters"]
    assert not np.any(envs.parameters["omega2"] == first["omega2"])
    assert np.array_equal(told["omega2"], envs.parameters["omega2"])


def test_the_skew_of_an_episode_is_the_error_of_its_step():
    envs = Environments("Oscillator", 200, skew=0.1, omega2=0.0, integrator="explicit-euler", dt=0.02, parameter_infos=True, dtype="float64")
    envs.reset(seed=3, options={"state": [0.0, 1.0]})
    skews = envs.parameters["skew"]
    infos = envs.step(np.zeros((200, 1)))[4]
    # A free particle of speed 1: its position is the length of the step.
    assert np.allclose(envs.states[:, 0] / 0.02 - 1, skews, rtol=0, atol=1e-15)
    assert np.array_equal(infos["parameters"]["skew"], skews)
    # Four standard errors of the standard deviation of 200 normal numbers, σ/√(2·200).
    assert abs(skews.std() - 0.1) < 4 * 0.1 / 20


def test_parameters_depend_on_the_seed_alone():
    given = {"omega2": Uniform(10, 20), "max_action": Uniform(1, 2)}
    many, few = Environments("Pendulum", 40, threads=2, **given), Environments("Pendulum", 3, **given)
    many.reset(seed=9), few.reset(seed=11)
    for name in ("omega2", "max_action"):
        assert np.array_equal(many.parameters[name][2:5], few.parameters[name])


def test_a_parameter_that_varies_is_what_moves_the_system():
    envs = libration.Environments(SPRING, 50, dt=0.01, integrator="rk4", omega2=Uniform(1.0, 30.0), dtype="float64")
    start = envs.reset(seed=3)[0]
    assert np.array_equal(start[:, 2], envs.parameters["omega2"])
    for _ in range(100):
        seen = envs.step(np.zeros((50, 1)))[0]
    # RK4 in steps of 0.01 s at 5.5 rad/s: (ωΔt)⁵/120 a step.
    omega = np.sqrt(start[:, 2])
    np.testing.assert_allclose(seen[:, 0], start[:, 0] * np.cos(omega), atol=100 * (0.055**5) / 120)


def test_an_array_gives_each_environment_its_number_in_all_episodes():
    values = np.linspace(1, 30, 20)
    common = {"dt": 0.01, "max_episode_steps": 3, "autoreset_mode": "SameStep", "dtype": "float64"}
    envs = Environments(SPRING, 20, omega2=values, max_action=np.linspace(1, 2, 20), **common)
    envs.reset(seed=0)
    for _ in range(7):
        envs.step(np.zeros((20, 1)))
        assert np.array_equal(envs.parameters["omega2"], values)
        assert np.array_equal(envs.parameters["max_action"], np.linspace(1, 2, 20))
    alone = Environments(SPRING, 1, omega2=float(values[4]), **common)
    envs.reset(seed=0), alone.reset(seed=4)
    assert np.array_equal(envs.step(np.ones((20, 1)))[0][4, :2], alone.step(np.ones((1, 1)))[0][0, :2])


def test_the_limit_of_a_command_that_varies_is_the_limit_of_its_episode():
    system = System(acceleration={"x": "u"}, inputs=["u"], task={"reward": "u", "start": {"x": (0, 0)}})
    envs = Environments(system, 200, dt=0.5, max_action=Uniform(0.5, 2.0), dtype="float64")
    envs.reset(seed=0)
    most = envs.parameters["max_action"]
    assert np.array_equal(envs.step(np.full((200, 1), 9.0))[1], most)
    assert np.array_equal(envs.step(np.full((200, 1), -9.0))[1], -most)


def test_copies_and_pickles_keep_the_numbers_of_the_episode():
    envs = Environments(SPRING, 9, dt=0.01, omega2=Uniform(1, 30), max_action=Uniform(1, 2), parameter_infos=True)
    envs.reset(seed=1)
    for twin in (copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))):
        assert np.array_equal(twin.parameters["omega2"], envs.parameters["omega2"])
        actions = np.full((9, 1), 5.0, np.float32)
        assert np.array_equal(twin.step(actions)[0], copy.deepcopy(envs).step(actions)[0])
        assert "parameters" in twin.step(actions)[4]


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"omega2": Uniform(0.1)}, ValueError, r"omega2 is Uniform\(0.1\), but it must have two ends"),
        ({"omega2": (10, 20)}, ValueError, r"omega2 has shape \(2,\).*help: Uniform\(10, 20\)"),
        ({"omega2": [10, 20, float("nan")]}, ValueError, r"omega2\[2\] is nan"),
        ({"omega2": "10"}, TypeError, "omega2 must be a number, not str"),
        ({"omega3": Uniform(1, 2)}, TypeError, "did you mean 'omega2'"),
        ({"max_action": Uniform(-1, 1)}, ValueError, "an end of max_action is -1.0"),
        ({"max_action": Gaussian(1.0, mean=3.0)}, ValueError, "max_action is Gaussian"),
        ({"jitter": Uniform(0, 0.1), "skew": 0.1}, ValueError, "skew is 0.1, but it must be 0"),
        ({"jitter": Gaussian(0.1, mean=1.0)}, ValueError, "around zero"),
        ({"omega2": Uniform(1, 2), "m": 1.0, "k": 1.0}, TypeError, "omega2 is given with m and k"),
        ({"m": Uniform(1, 2)}, TypeError, "m is given alone"),
        ({"bound": Uniform(-1, 1)}, ValueError, "bound is -1.0, but it must be greater than 0"),
        ({"bound": -1.0, "omega2": Uniform(1, 2)}, ValueError, "bound is -1.0"),
        ({"m": 0.0, "k": 1.0, "effort_cost": Uniform(0, 1)}, ValueError, "`m` is 0.0, but it must be"),
        ({"omega2": Uniform(-2, -1)}, ValueError, "`omega2` is -2.0"),
        ({"omega2": Uniform(1, 1e39)}, ValueError, "omega2"),
        ({"omega2": -1.0, "action_delay": 0.00314159}, ValueError, "`omega2` is -1.0"),
        ({"observation_noise": [0.1, 0.2], "omega2": Uniform(1, 2)}, ValueError, "observation_noise"),
        ({"parameter_infos": 1}, TypeError, "parameter_infos must be True or False"),
    ],
)
def test_wrong_ranges_are_refused_by_name(given, error, text):
    with pytest.raises(error, match=text):
        Environments("Oscillator", 3, **given)


def test_wrong_ends_are_refused():
    with pytest.raises(ValueError, match="low must be at most high"):
        Uniform(2, 1)
    with pytest.raises(TypeError, match="two ends"):
        Uniform()
    with pytest.raises(ValueError, match="low is 0.0"):
        LogUniform(0.0, 1.0)


@pytest.mark.parametrize("name", ["Oscillator", SPRING])
def test_an_episode_starts_at_the_state_of_the_options(name):
    envs = Environments(name, 4, dt=0.01, action_delay=0.01, observation_delay=0.02)
    state = np.arange(8.0).reshape(4, 2) / 8
    seen = envs.reset(seed=0, options={"state": state})[0]
    assert np.array_equal(seen[:, :2], state.astype(np.float32)) and np.array_equal(envs.states, state.astype(np.float32))
    mask = np.array([True, False, False, True])
    envs.step(np.zeros((4, 1), np.float32))
    moved = envs.states
    envs.reset(options={"state": [0.5, -0.5], "reset_mask": mask})
    assert np.array_equal(envs.states[mask], [[0.5, -0.5]] * 2) and np.array_equal(envs.states[~mask], moved[~mask])
    # Observations of the past are those of a beginning.
    assert np.array_equal(envs.step(np.zeros((4, 1), np.float32))[0][mask, :2], [[0.5, -0.5]] * 2)


def test_an_episode_starts_within_the_ends_of_the_options():
    envs = Environments("Oscillator", 2000)
    envs.reset(seed=0, options={"low": [-0.1, 2.0], "high": {"position": 0.1, "velocity": 3.0}})
    low, high = envs.states.min(axis=0), envs.states.max(axis=0)
    # The expected gap at an end is a 2001st of the width.
    assert (np.abs(low - [-0.1, 2.0]) < [0.002, 0.01]).all() and (np.abs(high - [0.1, 3.0]) < [0.002, 0.01]).all()
    few = Environments("Oscillator", 5)
    few.reset(seed=7, options={"low": -0.2, "high": 0.2})
    envs.reset(seed=0, options={"low": -0.2, "high": 0.2})
    assert np.array_equal(envs.states[7:12], few.states)
    envs.reset(seed=0, options={"low": [-1.0, -1.0], "high": [1.0, 1.0]})
    usual = Environments("Oscillator", 2000)
    usual.reset(seed=0)
    assert np.array_equal(envs.states, usual.states)


def test_an_episode_goes_on_from_the_state_that_is_set():
    envs = Environments(SPRING, 3, dt=0.01, dtype="float64")
    with pytest.raises(RuntimeError, match="before reset"):
        envs.set_state([0.0, 0.0])
    envs.reset(seed=0)
    other = copy.deepcopy(envs)
    envs.step(np.ones((3, 1)))
    saved = envs.states
    after = envs.step(np.ones((3, 1)))[0]
    assert np.array_equal(other.set_state(saved)[:, :2], saved)
    assert np.array_equal(other.step(np.ones((3, 1)))[0], after)


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"stat": 1}, ValueError, "options has 'stat': did you mean 'state'"),
        ({"low": 0.0}, ValueError, "without 'high'"),
        ({"low": 1.0, "high": 0.0}, ValueError, "position from 1.0 to 0.0"),
        ({"state": [0, 0], "low": 0, "high": 1}, ValueError, "one of them"),
        ({"state": [0, 0, 0]}, ValueError, r"shape \(3,\), but it must be \(2,\) or \(2, 2\): position, velocity"),
        ({"state": [0, np.inf]}, ValueError, "inf for velocity"),
        ({"state": [1e300, 0]}, ValueError, "1e\\+300 for position, but it must be finite in float32"),
        ({"state": [0.5]}, ValueError, r"shape \(1,\)"),
        ({"low": -1e38, "high": 3e38}, ValueError, "distance must be finite"),
        ({"state": {"position": 0}}, ValueError, "has no 'velocity'"),
        ({"state": {"position": 0, "speed": 0}}, ValueError, "'speed'"),
        ({"state": "top"}, TypeError, "real numbers"),
    ],
)
def test_wrong_options_are_refused_before_anything_is_reset(options, error, text):
    envs = Environments("Oscillator", 2)
    envs.reset(seed=0)
    before = envs.states
    with pytest.raises(error, match=text):
        envs.reset(seed=1, options=options)
    assert np.array_equal(envs.states, before)


def test_a_projection_is_what_a_step_leaves():
    bouncing = System(
        acceleration={"x": "-9.81 + u"},
        inputs=["u"],
        task={"reward": "x", "start": {"x": 0.05}, "project": {"x": "max(0, x)", "x'": "if(x < 0, -0.5*x', x')"}},
    )
    envs = Environments(bouncing, 1, dt=0.02, integrator="symplectic-euler", substeps=2, dtype="float64")
    envs.reset(seed=0)
    x, v = 0.05, 0.0
    for _ in range(200):
        envs.step(np.zeros((1, 1)))
        for _ in range(2):
            v = v + -9.81 * 0.01
            x = x + v * 0.01
            x, v = max(0.0, x), -0.5 * v if x < 0 else v
        assert envs.states.tolist() == [[x, v]]


def test_the_length_of_a_step_in_a_projection_is_that_of_the_jittered_step():
    drift = System(
        acceleration={"x": "u"},
        inputs=["u"],
        task={"reward": "0", "start": {"x'": 1.0}, "project": {"x": "before(x) + 2*dt"}},
    )
    envs = Environments(drift, 500, dt=0.01, jitter=0.2, dtype="float64", integrator="symplectic-euler")
    plain = Environments(System(acceleration={"x": "u"}, inputs=["u"]), 500, dt=0.01, jitter=0.2, dtype="float64",
                         integrator="symplectic-euler", reward="0", start={"x'": 1.0})
    envs.reset(seed=0), plain.reset(seed=0)
    for _ in range(10):
        envs.step(np.zeros((500, 1))), plain.step(np.zeros((500, 1)))
    assert np.ptp(plain.states[:, 0]) > 0.01
    # Ten sums of each, each rounded to half a unit of a tenth.
    np.testing.assert_allclose(envs.states[:, 0], 2 * plain.states[:, 0], rtol=0, atol=20 * np.spacing(0.2))


@pytest.mark.parametrize(
    ("task", "text"),
    [
        ({"project": {"y": "0"}}, "unknown name `y`"),
        ({"project": {"x": "z"}}, "unknown name `z`"),
        ({"project": {"x": "x +"}}, "found the end"),
        ({"project": {"x": "t"}}, "unknown name `t`"),
        ({"actions": [1.0]}, "at least two"),
        ({"actions": [1.0, -1.0]}, "ascending"),
    ],
)
def test_wrong_projections_and_actions_are_refused_by_name(task, text):
    with pytest.raises(ValueError, match=text):
        System(acceleration={"x": "u"}, inputs=["u"], task={"reward": "0", **task})


def test_discrete_actions_are_the_commands_of_their_levels():
    envs = Environments(System(acceleration={"x": "u"}, inputs=["u"]), 3, dt=1.0, reward="u", actions=[-2.0, 0.5, 3.0], dtype="float64")
    envs.reset(seed=0)
    assert envs.step(np.array([0, 1, 2]))[1].tolist() == [-2.0, 0.5, 3.0]
    for actions, error in ((np.array([0, 1, 3]), ValueError), (np.array([0, -1, 1]), ValueError), (np.zeros(3), TypeError), (np.array([0, 1]), ValueError)):
        with pytest.raises(error, match="actions"):
            envs.step(actions)
    # The nearest level of a policy's command; of two as near the larger.
    commands = envs.rollout(Linear([0.0, 0.0], bias=1.75), 1).rewards
    assert commands.tolist() == [[3.0] * 3]
    assert envs.rollout(Linear([0.0, 0.0], bias=1.7), 1).rewards.tolist() == [[0.5] * 3]
    assert envs.rollout(Linear([0.0, 0.0], bias=-99.0), 1).rewards.tolist() == [[-2.0] * 3]


def test_a_data_set_of_a_system_with_projection_and_discrete_actions_replays(tmp_path):
    system = System(
        acceleration={"x": "u"},
        inputs=["u"],
        task={"reward": "-x^2", "start": {"x": (-1, 1)}, "actions": [-1.0, 1.0], "project": {"x'": "max(-0.2, min(0.2, x'))"}},
    )
    libration.datasets.write(tmp_path / "data", {"num_envs": 8, "steps": 40, "dt": 0.1}, system=system)
    assert libration.datasets.verify(tmp_path / "data", replay=True) == []
    with pytest.raises(ValueError, match="discrete `actions` have commands of their own"):
        settings = {"num_envs": 8, "steps": 40, "dt": 0.1, "system": {"equations": {"max_action": 0.5}}}
        libration.datasets.write(tmp_path / "other", settings, system=system)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_infos_tell_the_numbers_of_each_episode_and_of_the_one_that_ended(mode):
    envs = Environments(SPRING, 4, dt=0.01, omega2=Uniform(1, 30), parameter_infos=True, max_episode_steps=3, autoreset_mode=mode, dtype="float64")
    first = envs.reset(seed=0)[1]["parameters"]["omega2"]
    for _ in range(3):
        infos = envs.step(np.zeros((4, 1)))[4]
    assert np.array_equal(infos["parameters"]["omega2"], envs.parameters["omega2"])
    if mode == "SameStep":
        final = infos["final_info"]["parameters"]
        assert np.array_equal(final["omega2"], first) and final["_omega2"].all() and infos["final_info"]["_parameters"].all()
        assert not (infos["parameters"]["omega2"] == first).any()


def test_single_environments_take_an_action_for_each_input():
    gymnasium = pytest.importorskip("gymnasium")
    two = System(acceleration={"a": "u1 - a", "b": "u2 - b"}, inputs=["u1", "u2"])
    env = gymnasium.make("libration/System-v0", system=two, dt=0.05, reward="u1 - 2*u2", max_action=1.0)
    env.reset(seed=0)
    assert env.step(env.action_space.sample() * 0 + np.array([0.5, 0.25], np.float32))[1] == 0.0


def test_a_state_that_is_not_finite_hinders_no_other_environment():
    envs = Environments(SPRING, 2, dt=0.01, dtype="float64", autoreset_mode="Disabled")
    envs.reset(seed=0)
    states = np.array([[0.1, 0.2], [np.nan, 0.0]])
    envs.set_state(states, np.array([True, False]))
    assert envs.states[0].tolist() == [0.1, 0.2]


def test_infos_of_ended_episodes_are_of_those_that_ended():
    falling = System(acceleration={"x": "u"}, parameters={"g": 1.0}, inputs=["u"], task={"reward": "0", "terminated": ["x > 1"], "start": {"x": 0.0}})
    envs = Environments(falling, 2, dt=0.1, g=Uniform(1, 2), parameter_infos=True, autoreset_mode="SameStep", dtype="float64")
    envs.reset(seed=0)
    drawn = envs.parameters["g"]
    envs.set_state([0.0, 0.0])
    envs.set_state([[2.0, 0.0], [0.0, 0.0]])
    final = envs.step(np.zeros((2, 1)))[4]["final_info"]["parameters"]
    assert final["g"].tolist() == [drawn[0], 0.0] and final["_g"].tolist() == [True, False]


@pytest.mark.parametrize("most", [1.0, Uniform(1, 2), np.ones(3)])
def test_a_largest_command_of_discrete_actions_is_refused(most):
    system = System(acceleration={"x": "u"}, inputs=["u"])
    with pytest.raises(TypeError, match="max_action is given, but discrete actions"):
        Environments(system, 3, dt=0.1, reward="0", actions=[-1.0, 1.0], max_action=most)


def test_a_custom_task_tells_the_numbers_of_episodes_that_begin_and_of_those_that_end():
    envs = libration.CustomTaskVectorEnv(
        "Pendulum", 2, task=lambda before, actions, after: (after[:, 1], np.array([True, False])), skew=0.1, parameter_infos=True, autoreset_mode="SameStep"
    )
    first = envs.reset(seed=0)[1]["parameters"]["skew"]
    infos = envs.step(np.zeros((2, 1)))[4]
    final = infos["final_info"]
    assert final["_parameters"].tolist() == final["parameters"]["_skew"].tolist() == [True, False]
    assert final["parameters"]["skew"].tolist() == [first[0], 0.0]
    assert infos["_parameters"].all() and infos["parameters"]["skew"][0] != first[0] and infos["parameters"]["skew"][1] == first[1]
