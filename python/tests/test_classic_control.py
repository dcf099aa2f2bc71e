"""Twins of Gymnasium's classic control, step by step beside Gymnasium."""

import copy
import pickle

import gymnasium
import numpy as np
import pytest
from common import AUTORESETS

import libration
from libration._classic_systems import CLASSIC, system_of
from libration.check_environments_match import check_environments_match, main
from libration.check_vector_env import check_vector_env

IDS = [each.id for each in CLASSIC.values()]


def twin(id, **given):
    return gymnasium.make(f"libration/{id}", starts="gymnasium", **given)


def exact_action(env, generator):
    """Actions of Pendulum as ``float64``: Gymnasium multiplies those of ``float32`` in ``float32``."""
    return generator.uniform(-2, 2, 1) if "Pendulum" in env.spec.id else env.action_space.sample()


# Observations of float64 states are equal after rounding to float32. Rewards of Pendulum differ since Gymnasium subtracts turns of a rounded
# 2π: 2.4e-16 rad a turn, times angles up to π.
REWARD_TOLERANCES = {"Pendulum-v1": 1e-11}


@pytest.mark.parametrize("id", ["CartPole-v1", "Pendulum-v1", "MountainCar-v0"])
def test_a_twin_moves_as_gymnasium_over_ten_thousand_steps(id):
    reward = REWARD_TOLERANCES.get(id, 0.0)
    match = check_environments_match(
        id, lambda: twin(id), steps=10_000, seeds=[3], sample=exact_action, tolerance_ulps=0, reward_tolerance=reward
    )
    assert match, str(match)


# Measured over 5000 steps: one unit of an angle below π in float64, and a unit of a position below 0.6 in float32, in which Gymnasium computes
# MountainCarContinuous. The reward there is the float32 of an action's square.
@pytest.mark.parametrize(
    ("id", "roundings", "reward_tolerance"),
    [("Acrobot-v1", 4 * np.spacing(np.pi), 0.0), ("MountainCarContinuous-v0", 2 * np.spacing(np.float32(0.6)), np.spacing(np.float32(0.1)))],
)
def test_each_step_of_a_twin_is_that_of_gymnasium_to_a_few_roundings(id, roundings, reward_tolerance):
    """Both are compared from equal states: over an episode a rounding grows, that of the chaotic Acrobot 10¹⁰ times."""
    other, own = gymnasium.make(id).unwrapped, twin(id).unwrapped
    own.reset(seed=0), other.reset(seed=0)
    other.action_space.seed(0)
    largest = 0.0
    for step in range(2000):
        if step % 100 == 0:
            # Gymnasium takes the first step of MountainCarContinuous in float64.
            other.reset(seed=step)
            other.step(other.action_space.sample())
        own.set_state(np.asarray(other.state, float))
        action = other.action_space.sample()
        _, reward, over, _, _ = other.step(action)
        _, own_reward, own_over, _, _ = own.step(action)
        assert abs(own_reward - reward) <= reward_tolerance and own_over == over
        largest = max(largest, np.abs(own.state - other.state).max())
    assert 0 < largest < roundings, largest


def test_the_first_steps_of_acrobot_are_those_of_gymnasium():
    other, own = gymnasium.make("Acrobot-v1"), twin("Acrobot-v1")
    for seed in range(5):
        rows = [env.reset(seed=seed)[0] for env in (other, own)]
        for _ in range(60):
            assert np.array_equal(*rows)
            rows = [env.step(2 * (seed % 2))[0] for env in (other, own)]


@pytest.mark.parametrize("id", IDS)
def test_a_twin_has_the_spaces_and_the_limit_of_gymnasium(id):
    for make in (gymnasium.make, lambda id: gymnasium.make_vec(id, 3, vectorization_mode="sync")):
        other = make(id)
        own = gymnasium.make_vec(f"libration/{id}", 3) if other.unwrapped.__class__.__name__ == "SyncVectorEnv" else make(f"libration/{id}")
        assert own.observation_space == other.observation_space and own.action_space == other.action_space
        assert own.observation_space.dtype == np.float32
        assert own.spec.max_episode_steps == other.spec.max_episode_steps
        own.close(), other.close()


@pytest.mark.parametrize("mode", AUTORESETS)
@pytest.mark.parametrize("id", ["CartPole-v1", "MountainCar-v0"])
def test_a_batch_of_twins_equals_the_sync_vector_env_of_gymnasium(id, mode):
    autoreset = gymnasium.vector.AutoresetMode(mode)
    other = gymnasium.make_vec(id, 5, vectorization_mode="sync", vector_kwargs={"autoreset_mode": autoreset})
    own = gymnasium.make_vec(f"libration/{id}", 5, starts="gymnasium", autoreset_mode=autoreset)
    assert np.array_equal(own.reset(seed=8)[0], other.reset(seed=8)[0])
    own.action_space.seed(1)
    ends = 0
    for _ in range(250):
        actions = own.action_space.sample()
        results = [env.step(actions) for env in (own, other)]
        for one, two in zip(results[0][:4], results[1][:4]):
            assert np.array_equal(one, two)
        over = results[0][2] | results[0][3]
        ends += over.sum()
        if mode == "SameStep" and over.any():
            for one, two in zip(results[0][4]["final_obs"][over], results[1][4]["final_obs"][over]):
                assert np.array_equal(one, two) and one.dtype == two.dtype
        if mode == "Disabled" and over.any():
            rows = [env.reset(options={"reset_mask": over.copy()})[0] for env in (own, other)]
            assert np.array_equal(*rows)
    assert ends > 4
    own.close(), other.close()


@pytest.mark.parametrize("starts", ["libration", "gymnasium"])
def test_a_batch_of_twins_keeps_the_contract_of_gymnasium(starts):
    report = check_vector_env(lambda n: gymnasium.make_vec("libration/CartPole-v1", n, starts=starts), num_envs=3, max_steps=200)
    assert report.is_correct, str(report)


def test_starts_of_libration_do_not_depend_on_the_batch_and_lie_within_those_of_gymnasium():
    envs = gymnasium.make_vec("libration/Pendulum-v1", 2000)
    envs.reset(seed=4)
    few = gymnasium.make_vec("libration/Pendulum-v1", 2)
    few.reset(seed=14)
    assert np.array_equal(envs.states[10:12], few.states)
    assert (np.abs(envs.states) <= [np.pi, 1.0]).all() and (np.abs(envs.states).max(axis=0) > [3.1, 0.99]).all()


def test_options_of_gymnasium_bound_its_starts():
    for id, options in (("CartPole-v1", {"low": -0.2, "high": 0.1}), ("Pendulum-v1", {"x_init": 0.5, "y_init": 0.1})):
        other, own = gymnasium.make(id), twin(id)
        assert np.array_equal(other.reset(seed=2, options=options)[0], own.reset(seed=2, options=options)[0])


def test_parameters_and_imperfections_are_those_of_the_engine():
    late = gymnasium.make_vec("libration/CartPole-v1", 64, action_delay=(0.0, 0.04), jitter=0.1, length=libration.Uniform(0.3, 0.7))
    plain = gymnasium.make_vec("libration/CartPole-v1", 64)
    assert np.array_equal(late.reset(seed=0)[0], plain.reset(seed=0)[0])
    assert set(late.parameters) == {"length", "action_delay"}
    assert 0.3 <= late.parameters["length"].min() < late.parameters["length"].max() <= 0.7
    actions = np.ones(64, int)
    assert not np.array_equal(late.step(actions)[0], plain.step(actions)[0])
    # Half a metre is Gymnasium's own.
    same = gymnasium.make_vec("libration/CartPole-v1", 64, length=libration.Uniform(0.5, 0.5))
    same.reset(seed=0), plain.reset(seed=0)
    for _ in range(9):
        np.testing.assert_allclose(same.step(actions)[0], plain.step(actions)[0], rtol=1e-6)


def test_copies_and_pickles_of_twins_go_on_alike():
    envs = gymnasium.make_vec("libration/CartPole-v1", 4, starts="gymnasium", autoreset_mode="SameStep", action_delay=0.02)
    envs.reset(seed=0)
    for other in (copy.deepcopy(envs), pickle.loads(pickle.dumps(envs)), gymnasium.make_vec(envs.spec)):
        mine = copy.deepcopy(envs)
        if other.spec is envs.spec or not hasattr(other, "_seeder") or other._seeder is None:
            other.reset(seed=0), mine.reset(seed=0)
        for _ in range(60):
            actions = np.ones(4, int)
            assert np.array_equal(mine.step(actions)[0], other.step(actions)[0])


def test_a_picture_is_that_of_gymnasium_of_the_same_state():
    pytest.importorskip("pygame", reason="Gymnasium draws by Pygame, which is no dependency")
    other, own = gymnasium.make("CartPole-v1", render_mode="rgb_array"), twin("CartPole-v1", render_mode="rgb_array")
    other.reset(seed=1), own.reset(seed=1)
    assert np.array_equal(other.render(), own.render())
    own.close(), other.close()


def test_systems_of_twins_have_the_states_that_gymnasium_has():
    for name, classic in CLASSIC.items():
        assert set(classic.order) == set(system_of(name).states) >= set(classic.drawn)
        assert len(classic.limits) == len(system_of(name).summary["task"]["observe"])


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"starts": "gym"}, ValueError, "starts is 'gym'"),
        ({"max_action": 0.5}, TypeError, "max_action is given, but"),
        ({"lenght": 1.0}, TypeError, "did you mean 'length'"),
        ({"startz": "gymnasium"}, TypeError, "'startz': did you mean 'start'.* known are .*, starts,"),
        ({"name": "CartPole"}, TypeError, "unexpected keyword argument 'name': known are .*length"),
    ],
)
def test_wrong_keywords_of_twins_are_refused(given, error, text):
    for make in (lambda **given: gymnasium.make("libration/CartPole-v1", **given), lambda **given: gymnasium.make_vec("libration/CartPole-v1", 2, **given)):
        with pytest.raises(error, match=text):
            make(**given)


@pytest.mark.parametrize("id", ["CartPole-v1", "MountainCar-v0"])
def test_twins_with_the_starts_of_gymnasium_match_as_its_environments_are_called(id, capsys):
    assert main([id, f"libration/{id}", "--second", "starts=gymnasium", "--steps", "300"]) == 0, capsys.readouterr().out
    assert main([id, f"libration/{id}", "--steps", "300"]) == 1
    assert capsys.readouterr().out.endswith("have the starts of Gymnasium with starts='gymnasium'\n")


def test_environments_that_differ_are_told_with_seed_and_step():
    match = check_environments_match("CartPole-v1", lambda: twin("CartPole-v1", gravity=9.81), steps=100, seeds=[5])
    assert not match and match.difference.startswith("seed 5, step 0: observation[3]"), str(match)
    match = check_environments_match("CartPole-v1", lambda: twin("CartPole-v1", force_mag=10.001), steps=50, seeds=[5], tolerance_ulps=1e9)
    assert match.observation_ulps[3] > 100
    class Cut(gymnasium.Wrapper):
        def step(self, action):
            return (*super().step(action)[:3], True, {})
    match = check_environments_match("CartPole-v1", lambda: Cut(gymnasium.make("CartPole-v1")), steps=10, seeds=[0])
    assert match.difference == "seed 0, step 0: truncated is False and True"
    with pytest.raises(ValueError, match="observation_space of CartPole-v1"):
        check_environments_match("CartPole-v1", "Pendulum-v1")
    for given, error in (({"steps": 0}, ValueError), ({"seeds": []}, ValueError), ({"steps": 1.5}, TypeError), ({"tolerance_ulps": -1}, ValueError)):
        with pytest.raises(error, match=next(iter(given))):
            check_environments_match("CartPole-v1", "CartPole-v1", **given)


def test_the_command_compares_registered_environments(capsys):
    ids = ["CartPole-v1", "libration/CartPole-v1"]
    assert main([*ids, "--second", "starts=gymnasium", "--steps", "200", "--seeds", "1"]) == 0
    assert "match" in capsys.readouterr().out
    assert main([*ids, "--steps", "5", "--seeds", "1"]) == 1
    for wrong in (["CartPole-v1", "NoSuch-v0"], [*ids, "--second", "starts"], [*ids, "--steps", "0"]):
        with pytest.raises(SystemExit) as exit:
            main(wrong)
        assert exit.value.code == 2


def test_a_lost_twin_hinders_no_other(recwarn):
    envs = gymnasium.make_vec("libration/CartPole-v1", 2, starts="gymnasium")
    envs.reset(seed=0)
    envs.set_state(np.array([[0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]]))
    assert envs.step(np.array([0, 0]))[2].tolist() == [True, False]
    envs.set_state(np.array([[0.0] * 4, [1e308, 0.0, 1e308, 1e308]]), np.array([False, True]))
    assert envs.step(np.array([0, 0]))[2].tolist() == [False, True]


def test_the_first_reset_with_a_mask_begins_all():
    envs = gymnasium.make_vec("libration/CartPole-v1", 3, starts="gymnasium", autoreset_mode="SameStep")
    envs.reset(options={"reset_mask": np.array([True, False, False])})
    for _ in range(60):
        assert envs.observation_space.contains(envs.step(np.zeros(3, int))[0])


def test_parameter_infos_leave_the_steps_of_twins():
    given = {"starts": "gymnasium", "autoreset_mode": "SameStep", "max_episode_steps": 3, "length": libration.Uniform(0.4, 0.6)}
    one, other = (gymnasium.make_vec("libration/CartPole-v1", 2, parameter_infos=tells, **given) for tells in (False, True))
    one.reset(seed=0), other.reset(seed=0)
    for _ in range(7):
        results = [env.step(np.array([0, 1])) for env in (one, other)]
        assert np.array_equal(results[0][0], results[1][0]) and results[1][0].dtype == np.float32
    assert "parameters" in results[1][4]


def test_actions_beyond_the_space_cost_what_they_cost_in_gymnasium():
    for id, action in (("MountainCarContinuous-v0", 3.0), ("Pendulum-v1", 5.0)):
        other, own = gymnasium.make(id), twin(id)
        other.reset(seed=0), own.reset(seed=0)
        rewards = [env.step(np.array([action]))[1] for env in (other, own)]
        assert abs(rewards[0] - rewards[1]) < 1e-6


def test_options_of_gymnasium_have_their_meaning_with_starts_of_libration_too():
    car = gymnasium.make_vec("libration/MountainCar-v0", 100)
    car.reset(seed=0, options={"low": -0.5, "high": -0.45})
    assert (car.states[:, 0] >= -0.5).all() and (car.states[:, 0] <= -0.45).all() and not car.states[:, 1].any()
    pendulum = gymnasium.make_vec("libration/Pendulum-v1", 100)
    pendulum.reset(seed=0, options={"x_init": 0.5, "y_init": 0.1})
    assert (np.abs(pendulum.states) <= [0.5, 0.1]).all() and np.ptp(pendulum.states[:, 0]) > 0.9


@pytest.mark.parametrize("starts", ["libration", "gymnasium"])
@pytest.mark.parametrize("options", [{"lwo": 1}, {"x_init": 1.0}, {"state": [0.0] * 4, "low": 0.0}, {"low": 1.0, "high": 0.0}, {"low": np.nan}])
def test_wrong_options_of_twins_are_refused_before_a_reset(starts, options):
    envs, env = gymnasium.make_vec("libration/CartPole-v1", 2, starts=starts), gymnasium.make("libration/CartPole-v1", starts=starts)
    for each in (envs, env):
        each.reset(seed=0)
        before = np.array(each.unwrapped.states if each is envs else each.unwrapped.state)
        with pytest.raises(ValueError, match="options"):
            each.reset(options=options)
        assert np.array_equal(each.unwrapped.states if each is envs else each.unwrapped.state, before)


@pytest.mark.parametrize("starts", ["libration", "gymnasium"])
@pytest.mark.parametrize(
    ("id", "options", "text"),
    [
        ("CartPole-v1", {"low": -1e308, "high": 1e308}, "low = -1e[+]308 and high = 1e[+]308, but high - low must be finite"),
        ("CartPole-v1", {"low": -3e38, "high": 3e38, "dtype": "float32"}, "high - low must be finite in float32"),
        ("Pendulum-v1", {"y_init": 2e38, "dtype": "float32"}, "'y_init'.* at most 1.7e[+]38: twice of it must be finite in float32"),
        ("CartPole-v1", {"low": 1e39, "high": 1e39, "dtype": "float32"}, "'low'.* finite in float32"),
        ("Pendulum-v1", {"x_init": 1e308}, "'x_init'.* at most 8.99e[+]307"),
        ("Pendulum-v1", {"y_init": 1e39, "dtype": "float32"}, "'y_init'.* finite in float32"),
        ("MountainCarContinuous-v0", {"low": 1e300, "high": 1e300}, "'low'.* finite in float32"),
        ("Acrobot-v1", {"high": 1e300}, "'high'.* finite in float32"),
    ],
)
def test_starts_without_a_float_are_refused_before_a_reset(recwarn, starts, id, options, text):
    options = dict(options)
    given = {"starts": starts} | ({"dtype": options.pop("dtype")} if "dtype" in options else {})
    envs, env = gymnasium.make_vec(f"libration/{id}", 2, **given), gymnasium.make(f"libration/{id}", **given).unwrapped
    for each, states in ((envs, lambda: envs.unwrapped.states), (env, lambda: env.state)):
        each.reset(seed=0)
        before = states()
        with pytest.raises(ValueError, match=text):
            each.reset(seed=1, options=options)
        assert np.array_equal(states(), before)
        twin = copy.deepcopy(each)
        assert np.array_equal(each.reset()[0], twin.reset()[0])
    assert not [str(one.message) for one in recwarn if "overflow" in str(one.message)]


def test_keywords_that_change_what_is_observed_change_the_space():
    envs = gymnasium.make_vec("libration/CartPole-v1", 2, observe=["x", "100*theta"])
    assert envs.single_observation_space.shape == (2,) and np.isinf(envs.single_observation_space.high).all()
    assert envs.observation_space.contains(envs.reset(seed=0)[0])
    with pytest.raises(TypeError, match="start is given"):
        gymnasium.make_vec("libration/CartPole-v1", 2, starts="gymnasium", start={"x": 1.0})
    envs = gymnasium.make_vec("libration/CartPole-v1", 2, starts="gymnasium")
    envs.reset(seed=0)
    with pytest.raises(ValueError, match="rollout requires starts='libration'"):
        envs.rollout(libration.policies.Linear([0.0] * 4), 3)


def test_the_former_name_of_the_swing_up_is_an_error_with_its_new_name():
    for make in (gymnasium.make, gymnasium.make_vec):
        with pytest.warns(DeprecationWarning), pytest.raises(gymnasium.error.DeprecatedEnv, match="PendulumSwingUp-v0"):
            make("libration/Pendulum-v0")


def test_integers_that_differ_are_differences():
    class Cell(gymnasium.Env):
        observation_space, action_space = gymnasium.spaces.Discrete(50), gymnasium.spaces.Discrete(2)

        def __init__(self, cell):
            self.cell = cell

        def reset(self, *, seed=None, options=None):
            return self.cell, {}

        def step(self, action):
            return self.cell, 0.0, False, False, {}

    match = check_environments_match(Cell(7), Cell(8), steps=3, seeds=[0])
    assert match.difference == "seed 0, reset: observation[0] is np.int64(7) and np.int64(8)"
    assert check_environments_match(Cell(7), Cell(7), steps=3, seeds=range(2))
    same = Cell(7)
    for given in ({"second": same}, {"second": Cell(7), "seeds": 3}):
        with pytest.raises((ValueError, TypeError)):
            check_environments_match(same, given.pop("second"), **given)


def test_options_and_seeds_of_a_first_reset_with_a_mask_are_for_the_mask():
    mask = np.array([True, False, False])
    envs = [gymnasium.make_vec("libration/CartPole-v1", 3, starts="gymnasium") for _ in range(2)]
    rows = [each.reset(seed=0, options={"low": 1.0, "high": 1.0, "reset_mask": mask})[0] for each in envs]
    for row in rows:
        assert (row[0] == 1.0).all() and (np.abs(row[1:]) <= 0.05).all()
    assert not np.array_equal(rows[0][1:], rows[1][1:])


def test_one_end_of_starts_is_enough_as_in_gymnasium():
    envs = gymnasium.make_vec("libration/CartPole-v1", 200)
    seen = envs.reset(seed=0, options={"low": 0.04})[0]
    assert seen.min() >= np.float32(0.04) and seen.max() <= np.float32(0.05)
    pendulum = gymnasium.make_vec("libration/Pendulum-v1", 2)
    with pytest.raises(ValueError, match="one of them"):
        pendulum.reset(seed=0, options={"low": -0.01, "high": 0.01, "x_init": 3.0})


def test_rewards_that_are_not_finite_are_compared():
    class Paid(gymnasium.Env):
        observation_space, action_space = gymnasium.spaces.Box(-1, 1), gymnasium.spaces.Discrete(2)

        def __init__(self, *rewards):
            self.rewards = rewards

        def reset(self, *, seed=None, options=None):
            self.left = list(self.rewards)
            return np.zeros(1, np.float32), {}

        def step(self, action):
            return np.zeros(1, np.float32), self.left.pop(0), False, False, {}

    compare = lambda one, other: check_environments_match(Paid(*one), Paid(*other), steps=2, seeds=[0])
    assert compare((np.nan, 1.0), (np.nan, 1.0)) and compare((-np.inf, 1.0), (-np.inf, 1.0))
    for one, other in (((np.nan, 0.0), (0.0, 0.0)), ((-np.inf, 0.0), (0.0, 0.0)), ((-np.inf, 5.0), (-np.inf, 0.0))):
        assert "reward" in compare(one, other).difference


def test_an_environment_from_a_pickle_has_the_errors_of_gymnasium():
    for id in ("libration/CartPole-v1", "libration/PendulumSwingUp-v0"):
        env = gymnasium.make(id).unwrapped
        for other in (pickle.loads(pickle.dumps(env)), copy.deepcopy(env)):
            with pytest.raises(gymnasium.error.ResetNeeded):
                other.step(other.action_space.sample())
            other.close()
            with pytest.raises(gymnasium.error.ClosedEnvironmentError):
                other.reset()


def pairs_of(mode, **keywords):
    """A vector environment, and as many single ones behind Gymnasium's vector environment."""
    vector = gymnasium.make_vec("libration/CartPole-v1", 3, autoreset_mode=mode, parameter_infos=True, **keywords)
    single = lambda: gymnasium.make("libration/CartPole-v1", parameter_infos=True, **keywords)  # noqa: E731
    return vector, gymnasium.vector.SyncVectorEnv([single] * 3, autoreset_mode=mode)


def same_infos(own, other):
    assert own.keys() == other.keys()
    for key, value in own.items():
        same_infos(value, other[key]) if isinstance(value, dict) else np.testing.assert_array_equal(value, other[key], err_msg=key)


def test_a_partial_reset_tells_the_numbers_of_those_that_it_resets():
    vector, sync = pairs_of("Disabled", skew=0.1)
    same_infos(vector.reset(seed=2)[1], sync.reset(seed=2)[1])
    mask = np.array([True, False, True])
    same_infos(vector.reset(options={"reset_mask": mask})[1], sync.reset(options={"reset_mask": mask})[1])


def test_the_last_infos_of_an_episode_have_the_time_of_the_answer_to_its_last_observation():
    vector, sync = pairs_of("SameStep", inference=libration.Uniform(0, 0.02), substeps=4, max_episode_steps=3)
    vector.reset(seed=7), sync.reset(seed=7)
    for _ in range(3):
        own, other = (envs.step(np.zeros(3, int))[4] for envs in (vector, sync))
    same_infos(own["final_info"], other["final_info"])
    same_infos(own["parameters"], other["parameters"])


@pytest.mark.parametrize(
    ("make", "given"),
    [
        (libration.classic_control.CartPoleVectorEnv, {"length": -0.5}),
        (libration.classic_control.CartPoleVectorEnv, {"masscart": libration.Uniform(-1.0, 1.0)}),
        (libration.classic_control.PendulumVectorEnv, {"l": np.array([1.0, 0.0])}),
        (libration.classic_control.AcrobotVectorEnv, {"m1": 0}),
    ],
)
def test_lengths_and_masses_are_above_zero(make, given):
    (name,) = given
    with pytest.raises(ValueError, match=f"{name}.* is -?[0-9.]+, but it must be greater than 0$"):
        make(2, **given)


def test_pictures_keep_pace_with_the_time_step():
    frames = lambda env: env.metadata["render_fps"]  # noqa: E731
    cart_pole, pendulum = libration.classic_control.CartPoleEnv, libration.classic_control.PendulumVectorEnv
    assert (frames(cart_pole()), frames(cart_pole(dt=0.01)), frames(cart_pole(substeps=4)), frames(pendulum(2))) == (50, 100, 50, 30)
