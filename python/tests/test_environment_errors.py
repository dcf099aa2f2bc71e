"""Errors of environments: the name of the argument, its value and what is allowed."""

import copy

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError

import libration
from libration import Environments, System, VectorEnv
from libration.classic_control import CartPoleEnv, CartPoleVectorEnv
from libration.envs import PendulumEnv

ARM = System(acceleration={"q": "u/m - 3*q"}, parameters={"m": 0.5}, inputs=["u"])


@pytest.mark.parametrize("given", [{}, {"substeps": 3}, {"observation_delay": (0.0, 0.1)}])
def test_a_latency_of_many_steps_is_shown_in_few_digits(given):
    with pytest.raises(ValueError, match=r"^action_delay is 1e\+300 s, which is \de\+301 steps of 0.\d+ s, but it must be at most 4096 of them$"):
        Environments("Pendulum", 2, action_delay=1e300, **given)


@pytest.mark.parametrize("options", [5, 0, [], "ab", [("state", 1)], np.array([]), np.array([1, 2])])
@pytest.mark.parametrize(
    "make",
    [
        lambda: Environments("Pendulum", 2),
        lambda: VectorEnv("Pendulum", 2),
        PendulumEnv,
        CartPoleEnv,
        lambda: CartPoleVectorEnv(2),
        lambda: CartPoleVectorEnv(2, starts="gymnasium"),
        lambda: libration.CustomTaskVectorEnv("Pendulum", 2, task=lambda before, actions, after: after[:, 0]),
        lambda: libration.LinearVectorEnv(libration.LinearPlant.mechanical(1.0, 0.1, 10.0, 1.0), 2, period=0.01),
    ],
)
def test_options_that_are_no_dictionary_are_an_error_with_their_type(make, options):
    with pytest.raises(TypeError, match=f"^options must be a dictionary, not {type(options).__name__}$"):
        make().reset(options=options)


@pytest.mark.parametrize(
    ("actions", "error", "text"),
    [
        (np.array(3), TypeError, r"actions is array\(3\), but it must be a list of commands"),
        (3, TypeError, "actions is 3, but it must be a list"),
        (np.ones((2, 2)), TypeError, "actions is array.*, but it must be a list"),
        ([0, "a"], TypeError, r"actions\[1\] must be a number, not str"),
        ([0, float("nan")], ValueError, r"actions\[1\] is nan, but it must be finite"),
        ([0, 1e300], ValueError, r"actions\[1\] is 1e\+300, but it must be finite in float32"),
        ([1, 1 + 1e-12], ValueError, r"actions is \[1.0, 1.000000000001\], but it must be .* ascending order in float32"),
        ([1, -1], ValueError, "actions is .* ascending order in float32"),
        ([1], ValueError, "actions is .* at least two commands"),
    ],
)
def test_wrong_actions_are_an_error_of_this_name(actions, error, text):
    with pytest.raises(error, match=f"^{text}"):
        Environments(ARM, 2, dt=0.1, reward="-q^2", actions=actions)
    assert Environments(ARM, 2, dt=0.1, reward="-q^2", actions=[1, 1 + 1e-12], dtype="float64").preset.levels == (1.0, 1 + 1e-12)


def test_actions_of_a_file_must_differ_in_the_float_type():
    system = System(acceleration={"q": "u"}, inputs=["u"], task={"reward": "0", "actions": [1.0, 1.0 + 1e-12]})
    with pytest.raises(ValueError, match="^actions is .* in float32"):
        Environments(system, 2, dt=0.1)


def test_constants_must_be_finite_in_the_float_type():
    with pytest.raises(ValueError, match=r"^m is 1e\+300, but it must be finite in float32"):
        Environments(ARM, 2, dt=0.1, reward="-q^2", m=1e300)
    with pytest.raises(ValueError, match=r"^m is 1e\+300, but it must be finite in float32"):
        Environments(ARM.replace(m=1e300), 2, dt=0.1, reward="-q^2")
    Environments(ARM, 2, dt=0.1, reward="-q^2", m=1e300, dtype="float64")
    Environments(ARM.replace(m=1e300), 2, dt=0.1, reward="-q^2", m=np.array([1.0, 2.0]))


@pytest.mark.parametrize(("dt", "dtype"), [(1e-320, "float64"), (1e-310, "float64"), (1e-40, "float32"), (1e39, "float32"), (1e300, "float32")])
@pytest.mark.parametrize("name", ["Pendulum", ARM])
def test_a_time_step_must_be_a_normal_number(name, dt, dtype):
    given = {} if name == "Pendulum" else {"reward": "-q^2"}
    with pytest.raises(ValueError, match=f"^dt is .* s, but a step of the integrator must be .* s in {dtype}"):
        Environments(name, 2, dt=dt, dtype=dtype, **given)
    with pytest.raises(ValueError, match=r"^dt is 2e-38 s, with 4 substeps 5e-39 s, but a step"):
        Environments(name, 2, dt=2e-38, substeps=4, **given)


@pytest.mark.parametrize("num_envs", [1, 2])
def test_masked_discrete_actions_are_refused(num_envs):
    envs = CartPoleVectorEnv(num_envs)
    envs.reset(seed=0)
    with pytest.raises(TypeError, match="actions are a masked array"):
        envs.step(np.ma.array([1] * num_envs, mask=[True] * num_envs))


def test_an_error_of_an_action_that_is_an_integer_reaches_the_caller():
    class Action:
        def __index__(self):
            raise KeyError("mine")

    env = CartPoleEnv()
    env.reset(seed=0)
    with pytest.raises(KeyError, match="mine"):
        env.step(Action())


def test_a_single_environment_keeps_no_action_of_the_caller():
    env = PendulumEnv(render_mode="rgb_array")
    env.reset(seed=0)
    env.step(memoryview(np.ones(1, np.float32)))
    assert copy.deepcopy(env).state.tolist() == env.state.tolist()


@pytest.mark.parametrize("refused", [{"seed": 7, "options": {"stat": 1}}, {"seed": 7, "options": {"state": [1.0]}}, {"seed": -7}])
def test_a_refused_reset_changes_no_seed_and_no_start(refused):
    for make in [lambda: CartPoleEnv(starts="gymnasium"), lambda: CartPoleVectorEnv(2, starts="gymnasium"), lambda: VectorEnv("Pendulum", 2)]:
        env, other = make(), make()
        for one in (env, other):
            one.reset(seed=5)
        with pytest.raises(ValueError):
            env.reset(**refused)
        assert env.np_random_seed == 5
        np.testing.assert_array_equal(env.reset()[0], other.reset()[0])


@pytest.mark.parametrize("make", [lambda: VectorEnv("Pendulum", 2), lambda: CartPoleVectorEnv(2, starts="gymnasium")])
def test_masked_arrays_are_no_masks_no_states_and_no_seeds(make):
    env = make()
    width = env.reset(seed=0)[0].shape[1] if isinstance(env, CartPoleVectorEnv) else 2
    with pytest.raises(TypeError, match=r"options\['reset_mask'\] must be a NumPy array, not MaskedArray"):
        env.reset(options={"reset_mask": np.ma.array([True, True], mask=[False, True])})
    with pytest.raises(TypeError, match=r"options\['state'\] is a masked array, but all values must be present"):
        env.reset(options={"state": np.ma.array(np.zeros(width), mask=np.arange(width) == 1)})
    for seed in [{1: 2, 3: 4}, {1, 2}, iter([1, 2]), "12", np.ma.array([1, 2])]:
        with pytest.raises(TypeError, match="seed must be an integer, a list or None, not"):
            env.reset(seed=seed)


def test_rows_of_different_lengths_are_an_error_with_the_name():
    env = VectorEnv("Pendulum", 2)
    env.reset(seed=0)
    with pytest.raises(ValueError, match=r"options\['state'\] is \[\[1, 2\], \[3\]\], but it must have rows of one length"):
        env.reset(options={"state": [[1, 2], [3]]})
    with pytest.raises(ValueError, match=r"options\['state'\] has shapes position \(2,\), velocity \(3,\), but each must be a number or \(2,\)"):
        env.reset(options={"state": {"position": [1, 2], "velocity": [1, 2, 3]}})
    with pytest.raises(ValueError, match=r"actions are \[\[1\], \[1, 2\]\], but they must have rows of one length"):
        env.step([[1], [1, 2]])


def test_no_commands_are_an_error():
    with pytest.raises(ValueError, match=r"^actions is \[\], but it must be at least two commands in ascending order$"):
        VectorEnv(ARM, 2, dt=0.02, reward="-q^2", actions=[])


def test_loops_around_a_plant_are_closed_and_take_real_numbers():
    env = libration.LinearVectorEnv(libration.LinearPlant.mechanical(1.0, 0.1, 10.0, 1.0), 2, period=0.01)
    env.reset(seed=0)
    for actions, message in [(np.ones((2, 1)) * 1j, "complex128"), ([["a"], ["b"]], "<U1"), (np.ma.array(np.ones((2, 1)), mask=True), "masked")]:
        with pytest.raises(TypeError, match=message):
            env.step(actions)
    env.close()
    for call in (env.reset, lambda: env.step(np.ones((2, 1)))):
        with pytest.raises(ClosedEnvironmentError):
            call()


def test_an_action_beyond_the_float_type_is_shown_as_it_was_given():
    env = VectorEnv("Pendulum", 2)
    env.reset(seed=0)
    with pytest.raises(ValueError, match=r"^actions\[1\] is 1e\+39, but it must be finite in float32$"):
        env.step([0.0, 1e39])
    with pytest.raises(TypeError, match="^dtype must be float32 or float64, not 'foo'$"):
        VectorEnv("Pendulum", 2, dtype="foo")


@pytest.mark.parametrize("name", ["start_position", "start_velocity", "action_delay", "observation_delay"])
def test_an_array_is_no_range(name):
    with pytest.raises(TypeError, match=f"^{name} is an array, but it must be a number or have two ends"):
        VectorEnv("Pendulum", 2, **{name: np.array([0.0, 0.05])})


def test_a_distribution_around_zero_is_no_range_and_a_scalar_of_numpy_is_one():
    assert VectorEnv("Pendulum", 2, action_delay=np.float64(0.05), start_position=(np.float32(0.5), np.array(1.0))).num_envs == 2
    with pytest.raises(ValueError, match=r"^action_delay is Uniform\(0.1\), but it must be a number or have two ends, like Uniform\(0, 0.1\)"):
        VectorEnv("Pendulum", 2, action_delay=libration.Uniform(0.1))


@pytest.mark.parametrize(("given", "name"), [({"chunk": (4, 2)}, "chunk"), ({"inner": libration.PD(100, 10), "inner_period": 0.01}, "inner")])
def test_a_reward_with_the_input_allows_no_actions_in_place_of_it(given, name):
    with pytest.raises(ValueError, match=f"^{name} is given, but the reward of the task has the input u, .*give another reward, without u$"):
        libration.classic_control.PendulumVectorEnv(2, **given)


def test_nothing_is_drawn_before_a_reset():
    for made in (PendulumEnv(render_mode="rgb_array"), VectorEnv("Pendulum", 2, render_mode="rgb_array")):
        with pytest.raises(gymnasium.error.ResetNeeded, match="render was called before reset"):
            made.render()


def test_an_unknown_column_of_a_trajectory_is_named_with_the_nearest():
    trajectory = libration.simulate(system=System("oscillator"), integrator="leapfrog", dt=0.1, steps=3)
    with pytest.raises(KeyError, match="no column 'energi'.*energy"):
        trajectory["energi"]


@pytest.mark.parametrize(
    ("call", "former", "name"),
    [
        (lambda: Environments("Pendulum", 4, float="float32"), "float", "dtype"),
        (lambda: Environments("Pendulum", environments=4), "environments", "num_envs"),
        (lambda: libration.simulate("pendulum", integrator="rk4", dt=0.01, steps=1, count=3), "count", "num_trajectories"),
        (lambda: libration.simulate("pendulum", integrator="rk4", dt=0.01, steps=1, every=3), "every", "save_every"),
    ],
)
def test_a_former_keyword_is_told_its_name(call, former, name):
    with pytest.raises(TypeError, match=f"unexpected keyword argument '{former}': did you mean '{name}'"):
        call()


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: VectorEnv("Pendulum", 2, action_delay=40), r"^action_delay is 40 s, but an episode lasts 10 s; did you mean 0.04 \(40 ms\)\?$"),
        (lambda: Environments("Pendulum", 2, action_delay=15.0), r"did you mean 0.015 \(15 ms\)"),
        (lambda: Environments("Pendulum", 2, observation_delay=25), r"^observation_delay is 25 s.* did you mean 0.025 \(25 ms\)"),
        (lambda: VectorEnv("Pendulum", 2, action_delay=(0.0, 30.0)), r"^action_delay is 30 s.* did you mean 0.03 \(30 ms\)"),
        (lambda: VectorEnv("Pendulum", 2, action_delay=(12, 18)), r"^action_delay is 12 s"),
        (lambda: VectorEnv(ARM, 2, dt=0.01, max_episode_steps=100, action_delay=2), r"an episode lasts 1 s; did you mean 0.002 \(2 ms\)"),
        (lambda: gymnasium.make("libration/PendulumSwingUp-v0", action_delay=40), r"action_delay is 40 s, but an episode lasts 10 s"),
    ],
)
def test_a_delay_as_long_as_an_episode_is_refused_with_its_milliseconds(make, text):
    with pytest.raises(ValueError, match=text):
        make()


@pytest.mark.parametrize("delay", [0.04, (0.0, 0.3), 1.5])
def test_a_delay_within_an_episode_is_none(delay):
    assert VectorEnv("Pendulum", 2, action_delay=delay).num_envs == 2


@pytest.mark.parametrize(
    ("law", "meant"),
    [("normal", "gaussian"), ("Normal", "gaussian"), ("gauss", "gaussian"), ("rectangular", "uniform"), ("flat", "uniform"), ("unifrom", "uniform")],
)
def test_a_law_by_another_name_is_named_as_what_it_is(law, meant):
    with pytest.raises(ValueError, match=f"did you mean '{meant}'"):
        VectorEnv("Pendulum", 2, jitter=(law, 0.05))
