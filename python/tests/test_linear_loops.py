"""Many loops around linear plants from Python."""

import math

import numpy as np
import pytest

import libration
from libration import LQR, LinearLoops, LinearPlant, LinearVectorEnv, StateFeedback

A, B = np.array([[0.0, 1.0], [-4.0, -0.4]]), np.array([[0.0], [1.0]])
SPRING = LinearPlant(A, B, states=["angle (rad)", "rate (rad/s)"], inputs=["torque (N m)"])


def test_a_loop_without_a_controller_is_the_step_response_of_the_plant():
    rows = LinearLoops(SPRING, period=0.1, disturbance={"torque": 2.0}).rollout(50)
    assert rows.states.shape == (51, 1, 2) and rows.inputs.shape == (51, 1, 1)
    t, omega = rows.time[:, 0], math.sqrt(4 - 0.04)
    wanted = 0.5 * (1 - np.exp(-0.2 * t) * (np.cos(omega * t) + 0.2 / omega * np.sin(omega * t)))
    # Fifty steps with some roundings each.
    np.testing.assert_allclose(rows.states[:, 0, 0], wanted, atol=1e-13)
    np.testing.assert_array_equal(rows.outputs, rows.states)


def test_a_latency_of_a_part_of_a_period_splits_the_step_as_a_numpy_loop_does():
    scipy_linalg = pytest.importorskip("scipy.linalg")
    period, late, gain = 0.1, 0.03, np.array([[3.0, 1.0]])

    def step(h):
        whole = scipy_linalg.expm(np.block([[A, B], [np.zeros((1, 3))]]) * h)
        return whole[:2, :2], whole[:2, 2:]

    loops = LinearLoops(SPRING, StateFeedback(gain), 3, period=period, latency=late, x0=[[1, 0], [0, 1], [2, -1]])
    rows = loops.rollout(40)
    x, u = rows.states[0].T, np.zeros((1, 3))
    (phi, gamma), (phi_rest, gamma_rest) = step(late), step(period - late)
    for k in range(40):
        np.testing.assert_allclose(rows.states[k], x.T, atol=1e-12)
        command = -gain @ x
        x = phi_rest @ (phi @ x + gamma @ u) + gamma_rest @ command
        u = command


def test_the_mean_cost_under_noise_and_jitter_is_that_of_the_advice():
    settings = {"period": 0.1, "latency": 0.03, "jitter": 0.1, "loss": 0.1}
    advice = libration.advise(SPRING, LQR([10, 1], [0.1]), **settings)
    loops = LinearLoops(SPRING, LQR([10, 1], [0.1]), 1000, noise=True, seed=5, threads=2, **settings)
    before = loops.step(200)
    after = loops.step(400)
    rates = (after.cost - before.cost) / (after.time - before.time).mean()
    error = rates.std(ddof=1) / math.sqrt(len(rates))
    assert abs(rates.mean() - advice["cost"]) < 4 * error


def test_in_place_of_a_lost_command_acts_zero_or_the_last_one():
    gain = np.array([[3.0, 1.0]])
    for missing in ("hold", "zero"):
        loops = LinearLoops(SPRING, StateFeedback(gain), 100, period=0.1, loss=0.3, missing=missing, x0=[1.0, 0.0])
        rows = loops.rollout(100)
        command = -(rows.states @ gain.T)[1:-1, :, 0]
        acting = rows.inputs[:, :, 0]
        lost = abs(acting[1:-1] - command) > 1e-12
        instead = acting[:-2] if missing == "hold" else np.zeros_like(command)
        np.testing.assert_array_equal(acting[1:-1][lost], instead[lost])
        # 9,900 draws: five standard deviations of their mean.
        assert abs(lost.mean() - 0.3) < 5 * math.sqrt(0.21 / lost.size)


def test_bits_do_not_depend_on_the_number_of_loops_and_threads():
    def states(number, threads):
        loops = LinearLoops(
            SPRING, LQR([10, 1], [0.1]), number, period=0.1, output_latency=0.05, jitter=0.1, noise=True, threads=threads, seed=2
        )
        return loops.rollout(60, every=20).states

    all = states(100, 1)
    for number, threads in ((1, 1), (17, 2), (100, 2)):
        np.testing.assert_array_equal(states(number, threads), all[:, :number])


def test_reset_and_constants_act_as_described():
    loops = LinearLoops(SPRING, StateFeedback([[3.0, 1.0]]), period=0.05, reference={"angle": 1.0})
    # 0 = −4x − 3(x − 1).
    assert loops.step(1000).states[0, 0] == pytest.approx(3 / 7, abs=1e-12)
    loops.set_disturbance([1.0])
    assert loops.step(1000).states[0, 0] == pytest.approx(4 / 7, abs=1e-12)
    loops.reset(x0=[0.5, 0.0])
    assert loops.step_count == 0 and loops.step(0).states.tolist() == [[0.5, 0.0]]


@pytest.mark.parametrize(
    "given, message",
    [
        ({"num_loops": 0}, "num_loops is 0"),
        ({"reference": {"angel": 1.0}}, "unknown name 'angel': did you mean 'angle'"),
        ({"disturbance": [1.0, 2.0]}, "disturbance has shape"),
        ({"x0": [1.0]}, "x0 has shape"),
        ({"loss": 1.5}, "loss"),
        ({"latncy": 1.0}, "unexpected keyword argument 'latncy'"),
    ],
)
def test_wrong_arguments_are_refused_by_name(given, message):
    with pytest.raises((TypeError, ValueError), match=message):
        LinearLoops(SPRING, LQR([10, 1], [0.1]), **given)


def test_a_policy_outside_acts_as_the_controller_inside():
    pytest.importorskip("gymnasium")
    settings = {"period": 0.1, "latency": 0.03, "output_latency": 0.12, "jitter": 0.1, "loss": 0.1}
    gain = np.array([[3.0, 1.0]])
    envs = libration.LinearVectorEnv(SPRING, 5, max_episode_steps=30, noise=True, **settings)
    observations, _ = envs.reset(seed=4)
    start = envs.loops.step(0).states
    total = 0.0
    for k in range(30):
        observations, rewards, terminated, truncated, _ = envs.step(-observations @ gain.T)
        total = total + rewards
        assert not terminated.any() and truncated.all() == (k == 29)
    # The seed of the loops follows from that of the environments.
    random = np.random.Generator(type(envs.np_random.bit_generator)(np.random.SeedSequence(4)))
    np.testing.assert_array_equal(random.uniform(-1, 1, (5, 2)), start)
    inside = LinearLoops(
        SPRING, StateFeedback(gain), 5, noise=True, x0=start, seed=int(random.integers(2**63)), cost_weights=None, **settings
    )
    row = inside.step(30)
    np.testing.assert_allclose(row.states, envs.loops.step(0).states, atol=1e-12)
    np.testing.assert_allclose(-total, row.cost, rtol=1e-12)
    observations, rewards, *_ = envs.step(np.zeros((5, 1)))
    assert (rewards == 0).all() and envs.loops.step_count == 0


def test_an_environment_passes_gymnasiums_checks_of_spaces():
    pytest.importorskip("gymnasium")
    envs = libration.LinearVectorEnv(SPRING, 4, max_action=2.0, start=[0.1, 0.0])
    observations, _ = envs.reset(seed=1)
    assert envs.observation_space.contains(observations)
    assert (np.abs(observations[:, 0]) <= 0.1).all() and (observations[:, 1] == 0).all()
    same, _ = envs.reset(seed=1)
    np.testing.assert_array_equal(observations, same)
    observations, rewards, *_ = envs.step(envs.action_space.sample())
    assert envs.observation_space.contains(observations) and (rewards <= 0).all()


def test_an_environment_names_the_keywords_that_it_takes():
    with pytest.raises(TypeError, match="unexpected keyword argument 'latencies': did you mean 'latency'"):
        LinearVectorEnv(SPRING, latencies=1.0)
    with pytest.raises(TypeError, match="the policy is the controller"):
        LinearVectorEnv(SPRING, controller=LQR([10, 1], [0.1]))


def test_an_environment_names_actions_that_are_not_finite():
    pytest.importorskip("gymnasium")
    for most, action in ((np.inf, np.nan), (2.0, np.nan), (np.inf, np.inf)):
        envs = LinearVectorEnv(SPRING, 3, max_action=most)
        envs.reset(seed=1)
        before = envs.loops.step(0).states
        with pytest.raises(ValueError, match=f"actions have the entry {action} for 'torque' in environment 1; expected finite numbers"):
            envs.step([[0.0], [action], [0.0]])
        np.testing.assert_array_equal(envs.loops.step(0).states, before)
    # A largest action clips what is infinite.
    envs = LinearVectorEnv(SPRING, 1, max_action=2.0)
    envs.reset(seed=1)
    envs.step([[np.inf]])
    assert envs.loops.step(0).inputs.tolist() == [[2.0]]


def test_an_environment_has_no_options():
    pytest.importorskip("gymnasium")
    envs = LinearVectorEnv(SPRING, 2)
    with pytest.raises(ValueError, match="options has 'x0'; expected no options"):
        envs.reset(options={"x0": [1.0, 0.0]})
    for options in (None, {}):
        observations, _ = envs.reset(seed=1, options=options)
        assert observations.shape == (2, 2)
