"""Attributes of Gymnasium's classic control on its twins."""

import copy
import pickle
import time

import gymnasium
import numpy as np
import pytest

from libration import Uniform, classic_control
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
            assert np.array_equal(getattr(own, name), value) and name in dir(own), name
        elif name != "state":
            # A name that a subclass may use.
            setattr(own, name, value)
            continue
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
        if name in {"state", "low", "high"} or name not in OF_RUNS:
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
        ("kinematics_integrator", "euler", "CartPoleEnv(integrator='explicit-euler')"),
        ("theta_threshold_radians", np.float64(0.15), "CartPoleEnv(terminated=['x < -2.4', 'x > 2.4', 'theta < -0.15', 'theta > 0.15'])"),
    ],
)
def test_the_help_of_an_attribute_makes_the_environment_that_gymnasium_has_with_it(name, value, help):
    with pytest.raises(AttributeError) as caught:
        setattr(gymnasium.make("libration/CartPole-v1").unwrapped, name, value)
    assert str(caught.value).endswith(f"help: make another environment: {help}")
    own = eval(help.replace("CartPoleEnv(", "CartPoleEnv(starts='gymnasium', "))
    assert getattr(own, name) == value or name == "kinematics_integrator"
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


@pytest.mark.parametrize(
    ("made", "name", "value"),
    [
        (classic_control.MountainCarEnv, "goal_position", 0.3),
        (classic_control.MountainCarContinuousEnv, "goal_position", 0.3),
        (classic_control.MountainCarContinuousEnv, "min_action", -0.5),
        (classic_control.MountainCarContinuousEnv, "max_action", 1),
        (PendulumEnv, "max_torque", np.float32(1.5)),
        (AcrobotEnv, "AVAIL_TORQUE", [-2.0, 2.0]),
        (AcrobotEnv, "LINK_LENGTH_1", 2.0),
    ],
)
def test_an_environment_that_the_help_makes_has_the_attribute(made, name, value):
    with pytest.raises(AttributeError, match="; help: make another environment: ") as caught:
        setattr(made(), name, value)
    made_of_it = eval(str(caught.value).partition("make another environment: ")[2], vars(classic_control))
    assert getattr(made_of_it, name) == value


def test_the_reward_of_another_goal_is_that_of_gymnasium():
    with pytest.raises(AttributeError) as caught:
        classic_control.MountainCarContinuousEnv().goal_position = -0.4
    own = eval(str(caught.value).partition("make another environment: ")[2], vars(classic_control))
    other = gymnasium.make("MountainCarContinuous-v0").unwrapped
    other.goal_position = -0.4
    own.reset(options={"state": [-0.41, 0.02]}), other.reset(seed=0)
    other.state = np.array([-0.41, 0.02], np.float32)
    one, two = own.step([0.5]), other.step(np.array([0.5], np.float32))
    assert one[1] == pytest.approx(two[1], rel=1e-6) and one[2] and two[2] and one[1] > 99


def test_no_help_has_a_number_that_the_environment_refuses():
    for name, value in (("min_action", 2.0), ("max_action", -1.0), ("max_action", "1")):
        with pytest.raises(AttributeError, match=r"MountainCarContinuousEnv\(max_action=…\)"):
            setattr(classic_control.MountainCarContinuousEnv(), name, value)
    with pytest.raises(AttributeError, match=r"PendulumEnv\(project=\{…\}\)"):
        PendulumEnv().max_speed = 1.0
    with pytest.raises(AttributeError, match=r"state .*help: set_state"):
        CartPoleEnv().state = np.zeros(4)


@pytest.mark.parametrize("most", [0.5, [0.5], (0.5,), np.array([0.5]), np.float32(0.5)])
def test_a_largest_action_is_a_number_in_any_of_its_forms(most):
    env = classic_control.MountainCarContinuousEnv(max_action=most)
    assert env.max_action == 0.5 and env.min_action == -0.5 and type(env.min_action) is float
    assert PendulumEnv(max_action=most).max_torque == 0.5 and type(PendulumEnv(max_action=most).max_torque) is float
    envs = classic_control.MountainCarContinuousVectorEnv(2, max_action=most)
    assert envs.min_action == -0.5 and envs.get_attr("max_action") == (0.5, 0.5)
    envs = classic_control.MountainCarContinuousVectorEnv(2, max_action=np.array([0.5, 0.25]))
    envs.reset(seed=0)
    assert envs.get_attr("min_action") == (-0.5, -0.25) and np.array_equal(envs.max_action, [0.5, 0.25])


def test_several_largest_actions_are_no_attribute():
    given = {"targets": ["a", "b"], "inner": {"u": "a - b*theta"}, "inner_period": 0.05, "reward": "-theta^2"}
    env = PendulumEnv(max_action=[1.0, 2.0], **given)
    with pytest.raises(AttributeError, match=r"Pendulum has no 'max_torque': max_action is \[1.0, 2.0\]"):
        env.max_torque
    envs = classic_control.PendulumVectorEnv(2, max_action=[Uniform(1.0, 2.0), 2.0], **given)
    assert not hasattr(envs, "max_torque") and envs.dt == 0.05


def test_an_attribute_that_varies_is_that_of_the_current_episode():
    env = gymnasium.make("libration/CartPole-v1", length=Uniform(0.3, 0.7), masspole=0.2).unwrapped
    env.reset(seed=1)
    assert env.length == env.parameters["length"] != 0.5 and env.total_mass == 1.2
    assert env.polemass_length == 0.2 * env.length
    envs = CartPoleVectorEnv(3, length=Uniform(0.3, 0.7))
    envs.reset(seed=1)
    assert np.array_equal(envs.length, envs.parameters["length"]) and envs.length.shape == (3,)
    assert envs.get_attr("polemass_length") == tuple(0.1 * envs.parameters["length"])


def test_a_value_is_the_one_in_use_however_a_caller_reads_it():
    given = {"length": Uniform(0.3, 0.7), "masspole": np.array([0.1, 0.2, 0.3]), "action_delay": (0.0, 0.04), "jitter": ("uniform", Uniform(0.0, 0.1))}
    envs = CartPoleVectorEnv(3, **given)
    envs.reset(seed=1)
    for name in given:
        assert envs.get_attr(name) == envs.call(name) == tuple(envs.parameters[name].tolist())
    assert envs.get_attr("length") == tuple(envs.length) and envs.get_attr("dt") == envs.get_attr("tau") == (0.02,) * 3
    single = gymnasium.make("libration/CartPole-v1", length=Uniform(0.3, 0.7), action_delay=(0.0, 0.04))
    single.reset(seed=1)
    assert single.get_wrapper_attr("length") == single.unwrapped.length == single.unwrapped.parameters["length"] == envs.length[0]
    assert single.get_wrapper_attr("action_delay") == single.unwrapped.parameters["action_delay"]
    car = classic_control.MountainCarContinuousVectorEnv(2)
    assert car.get_attr("max_action") == (car.max_action,) * 2 == (1.0, 1.0)


@pytest.mark.parametrize("given", [{}, {"length": Uniform(0.3, 0.7)}])
def test_attributes_are_those_of_the_last_episode_after_close(given):
    env, envs = CartPoleEnv(**given), CartPoleVectorEnv(2, **given)
    env.reset(seed=1), envs.reset(seed=1)
    names = ("length", "gravity", "polemass_length", "x_threshold", "dt", "jitter")
    before = [[env.get_wrapper_attr(name) for name in names], [envs.get_attr(name) for name in names], env.length]
    state = env.state
    for _ in range(2):
        env.close(), envs.close()
        assert [[env.get_wrapper_attr(name) for name in names], [envs.get_attr(name) for name in names], env.length] == before
        assert np.array_equal(envs.length, before[1][0]) or not given
        assert not hasattr(env, "lenght") and not hasattr(envs, "lenght") and hasattr(env, "gravity") and np.array_equal(env.state, state)
    CartPoleEnv().close()
    with pytest.raises(gymnasium.error.ClosedEnvironmentError):
        env.reset()


def test_the_attributes_of_all_environments_take_a_time_linear_in_their_number():
    envs = CartPoleVectorEnv(20_000, masspole=Uniform(0.1, 0.2))
    envs.reset(seed=0)
    since = time.process_time()
    assert len(set(envs.get_attr("total_mass"))) > 10_000
    # By a table of all numbers for each environment it took more than a minute.
    assert time.process_time() - since < 5


def test_attributes_are_in_dir_and_the_class_has_no_spec():
    for env in (CartPoleEnv(), CartPoleVectorEnv(2)):
        assert {"gravity", "tau", "length", "total_mass"} <= set(dir(env)) and "AVAIL_TORQUE" not in dir(env)
        assert type(env).spec is None and env.spec is None
    assert "x_threshold" not in dir(CartPoleEnv(terminated=["x > 1"]))
    assert gymnasium.make("libration/CartPole-v1").spec.id == "libration/CartPole-v1"


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
    default = CartPoleEnv().get_wrapper_attr("terminated")
    assert CartPoleEnv(terminated=tuple(default)).x_threshold == 2.4
    assert not hasattr(PendulumEnv(project={"theta": "theta"}), "max_speed")


@pytest.mark.parametrize("made", [CartPoleEnv, CartPoleVectorEnv])
def test_copies_and_pickles_have_and_refuse_the_attributes(made):
    env = made(length=0.7)
    for other in (copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        assert other.length == 0.7
        with pytest.raises(AttributeError, match=r"length=1.0"):
            other.length = 1.0
        other.mine = 3
        assert other.mine == 3


class Counted(CartPoleVectorEnv):
    """A subclass with a signature and attributes of its own."""

    def __init__(self, n=2):
        super().__init__(n, dt=0.01, length=Uniform(0.3, 0.7))
        self.steps, self.clock = 0, None
        self.me, self._log = self, []
        self.single_observation_space = gymnasium.spaces.Box(-1, 1, (4,))

    def step(self, actions):
        self.steps += 1
        return super().step(actions)


class Named(classic_control.ClassicVectorEnv):
    """A subclass that takes the name of a twin."""


@pytest.mark.parametrize("made", [Counted, lambda: Named("CartPole", 2, starts="gymnasium"), lambda: CartPoleVectorEnv(2, dtype="float32")])
def test_a_copy_of_a_vector_environment_has_its_class_its_attributes_and_its_next_steps(made):
    envs = made()
    envs.reset(seed=3), envs.action_space.seed(1)
    envs.mine = [1, 2]
    envs.step([0, 1])
    for copied in (copy.copy, copy.deepcopy, lambda envs: pickle.loads(pickle.dumps(envs))):
        # A lambda has no pickle; the class has.
        other = copied(envs)
        assert type(other) is type(envs) and other.mine == [1, 2] and other.mine is not envs.mine
        assert other.single_observation_space == envs.single_observation_space and other.get_attr("mine") == ([1, 2],) * 2
        if isinstance(envs, Counted):
            assert other.steps == 1 and other.me is other and other._log == [] and other.tau == 0.01
        assert np.array_equal(copy.deepcopy(other).step([1, 1])[0], copy.deepcopy(envs).step([1, 1])[0])
        assert np.array_equal(other.action_space.sample(), copy.deepcopy(envs).action_space.sample())


def test_a_subclass_may_use_names_that_gymnasium_has_for_its_runs():
    class Own(CartPoleEnv):
        def __init__(self, **given):
            super().__init__(**given)
            self.steps, self.clock, self.low, self.screen = 0, None, -1.0, None
            self.observation_space = gymnasium.spaces.Box(-1, 1, (2,))
            self.offset = 2.0

        @property
        def offset(self):
            return self._offset

        @offset.setter
        def offset(self, value):
            self._offset = value

    for env in (Own(), copy.deepcopy(Own())):
        assert (env.steps, env.low, env.offset) == (0, -1.0, 2.0) and env.observation_space.shape == (2,)


@pytest.mark.parametrize("name", ["action_delay", "jitter", "dt", "reward", "threads", "starts", "inner", "observation_noise"])
def test_a_keyword_is_no_attribute_to_set(name):
    for made in (CartPoleEnv, CartPoleVectorEnv):
        with pytest.raises(AttributeError, match=rf"{name} of {made.__name__} .*; help: make another environment: {made.__name__}\({name}=1\)"):
            setattr(made(), name, 1)


def test_spaces_modes_and_numbers_of_environments_are_checked_where_they_are_set():
    for name in ("num_envs", "autoreset_mode", "copy", "buffers", "max_episode_steps"):
        with pytest.raises(AttributeError, match=rf"{name} of CartPoleVectorEnv cannot be set to 7"):
            setattr(CartPoleVectorEnv(2), name, 7)
    for made in (CartPoleEnv, CartPoleVectorEnv):
        with pytest.raises(TypeError, match="action_space must be a space of Gymnasium, not int"):
            made().action_space = 1
        with pytest.raises(ValueError, match="render_mode is 'human'"):
            made().render_mode = "human"
    env = CartPoleEnv()
    env.num_envs = env.autoreset_mode = 3
    assert env.num_envs == 3


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


def test_what_a_subclass_hides_is_refused_with_the_keyword():
    class Heavy(classic_control.AcrobotEnv):
        LINK_MASS_1 = 50.0

    with pytest.raises(AttributeError, match=r"LINK_MASS_1 of AcrobotEnv cannot be set to 50.0; help: .*AcrobotEnv\(m1=50.0\)"):
        Heavy()

    class Early(classic_control.CartPoleEnv):
        def __init__(self):
            self.gravity = 1.0
            super().__init__()

    with pytest.raises(AttributeError, match="gravity of CartPoleEnv cannot be set to 1.0"):
        Early()


def test_the_largest_action_of_the_car_is_that_of_its_motion():
    car = classic_control.MountainCarContinuousEnv(max_action=2.0)
    assert (car.max_action, car.min_action) == (1.0, -1.0)
    with pytest.raises(AttributeError, match=r"MountainCarContinuousEnv\(max_action=…\)"):
        car.min_action = -3.0
