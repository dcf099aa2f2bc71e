"""Latencies that are no simple part of a period: steps begin where they end."""

import math
import warnings

import numpy as np
import pytest

import libration
from libration import Environments, System
from libration.classic_control import PendulumVectorEnv

SPRING = System(acceleration={"q": "-9*q + u"}, inputs=["u"])


def spring(**given):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return Environments(SPRING, 2, dt=0.05, reward="q", start={"q": 1.0}, dtype="float64", **{"integrator": "rk4", **given})


@pytest.mark.parametrize(
    ("given", "substeps"),
    [
        ({"action_delay": 0.0333}, 2),
        ({"action_delay": 0.1333}, 2),
        ({"observation_delay": 0.0333}, 2),
        ({"action_delay": 0.0333, "observation_delay": 0.0217}, 3),
        ({"action_delay": 0.0333, "observation_delay": 0.05 - 0.0333}, 2),
        ({"action_delay": 0.0333, "observation_delay": 0.1}, 2),
        ({"action_delay": 0.03}, 5),
        ({"action_delay": 0.15}, 1),
        ({"action_delay": 0.0333, "substeps": 500}, 500),
    ],
)
def test_a_latency_costs_one_more_step_at_most(given, substeps):
    assert spring(**given).substeps == substeps


@pytest.mark.parametrize("delay", [0.0333, 0.0712, 0.1501])
def test_a_command_arrives_at_its_latency(delay):
    envs = spring(action_delay=delay)
    envs.reset(seed=0)
    commands = [3.0, -1.0, 2.0, 5.0, 0.5, -2.0]
    for command in commands:
        envs.step(np.full((2, 1), command))
    # The exact motion under commands that arrive late. RK4 in steps of 0.05 s errs by (0.15)^5/120 of the motion a step.
    arrivals = [0.0, *(0.05 * k + delay for k in range(6)), math.inf]
    x, v, time = 1.0, 0.0, 0.0
    for held, end in zip([0.0, *commands], arrivals[1:]):
        length = max(0.0, min(end, 0.3) - time)
        time += length
        rest, cos, sin = held / 9, math.cos(3 * length), math.sin(3 * length)
        x, v = rest + (x - rest) * cos + v / 3 * sin, -(x - rest) * 3 * sin + v * cos
    np.testing.assert_allclose(envs.states[0], [x, v], rtol=0, atol=12 * 0.15**5 / 120 * 5)


@pytest.mark.parametrize("delay", [0.0333, 0.0712])
def test_an_observation_is_the_state_one_latency_ago(delay):
    envs = spring(observation_delay=delay)
    envs.reset(seed=0)
    for _ in range(6):
        seen = envs.step(np.zeros((2, 1)))[0]
    np.testing.assert_allclose(seen[0], [math.cos(3 * (0.3 - delay)), -3 * math.sin(3 * (0.3 - delay))], atol=12 * 0.15**5 / 120 * 3)


def test_split_steps_are_those_of_many_substeps_to_the_error_of_the_integrator():
    few, many = (Environments("Pendulum", 8, integrator="rk4", dtype="float64", dt=0.05, action_delay=0.0333, **given) for given in ({}, {"substeps": 500}))
    assert (few.substeps, many.substeps) == (2, 500)
    few.reset(seed=1), many.reset(seed=1)
    for k in range(20):
        actions = np.full((8, 1), np.sin(k))
        one, other = few.step(actions), many.step(actions)
    # (ωΔt)^5/120 a step with ω² = 15 is 6e-7, which grows along an unstable second.
    np.testing.assert_allclose(one[0], other[0], atol=1e-4)
    assert not np.array_equal(one[0], other[0])


def test_jitter_scales_each_part_of_a_period():
    envs = Environments(System(acceleration={"x": "u"}, inputs=["u"]), 4000, dt=0.05, reward="0", start={"x'": 1.0}, action_delay=0.0333, jitter=0.1, dtype="float64")
    envs.reset(seed=0)
    envs.step(np.zeros((4000, 1)))
    travelled = envs.states[:, 0]
    # Two independent errors of 10 % of 0.0333 s and of 0.0167 s; a standard error of a deviation is 1/√8000 of it.
    std = 0.1 * math.hypot(0.0333, 0.0167)
    assert abs(travelled.mean() - 0.05) < 5 * std / math.sqrt(4000) and abs(travelled.std() / std - 1) < 5 / math.sqrt(8000)


def test_split_steps_hold_for_presets_with_every_autoreset(tmp_path):
    for mode in ("NextStep", "SameStep", "Disabled"):
        envs = libration.VectorEnv("Oscillator", 3, dt=0.05, action_delay=0.0333, max_episode_steps=4, autoreset_mode=mode)
        alone = libration.VectorEnv("Oscillator", 1, dt=0.05, action_delay=0.0333, max_episode_steps=4, autoreset_mode=mode)
        assert envs.substeps == 2
        assert np.array_equal(envs.reset(seed=3)[0][1:2], alone.reset(seed=4)[0])
        for _ in range(4):
            assert np.array_equal(envs.step(np.ones((3, 1), np.float32))[0][1:2], alone.step(np.ones((1, 1), np.float32))[0])


@pytest.mark.parametrize(("delay", "substeps"), [(0.02, 5), (0.1 / 3, 3), (0.05, 1), ((0.0, 0.02), 5)])
def test_a_latency_leaves_the_free_system_of_the_same_substeps(delay, substeps):
    given = {"starts": "libration", "dtype": "float64"}
    late, baseline, other = PendulumVectorEnv(4, action_delay=delay, **given), PendulumVectorEnv(4, substeps=substeps, **given), PendulumVectorEnv(4, **given)
    assert late.substeps == substeps
    for envs in (late, baseline, other):
        envs.reset(seed=0, options={"state": [3.0, 0.5]})
        for _ in range(20):
            envs.step(np.zeros((4, 1)))
    np.testing.assert_array_equal(late.states, baseline.states)
    assert (substeps == 1) == np.array_equal(late.states, other.states)


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ({"action_delay": (0.0, 0.1)}, [0.0, 0.05, 0.1]),
        ({"action_delay": libration.Uniform(0.0, 0.02)}, [0.0, 0.01, 0.02]),
        ({"action_delay": (0.0, 0.1), "substeps": 10}, np.arange(21) * 0.005),
    ],
)
def test_an_episode_draws_whole_steps_of_the_integrator_each_as_likely(given, values):
    envs = PendulumVectorEnv(4000, **given)
    envs.reset(seed=0)
    found, counts = np.unique(np.round(envs.parameters["action_delay"], 9), return_counts=True)
    np.testing.assert_allclose(found, values, atol=1e-9)
    # Five standard deviations of a count.
    share = 4000 / len(values)
    assert np.abs(counts - share).max() < 5 * np.sqrt(share)


@pytest.mark.parametrize(("dt", "delay"), [(0.05, 0.033333), (0.01, 0.012345), (0.05, 1e-8), (0.05, 10.0333)])
def test_a_latency_may_be_any_part_of_a_period(dt, delay):
    envs = Environments(SPRING, 1, dt=dt, reward="q", action_delay=delay)
    assert envs.substeps == 2
    envs.reset(seed=0), envs.step(np.zeros((1, 1)))
