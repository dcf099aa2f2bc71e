"""Rollouts inside the engine."""

import gc
import os
import signal
import threading

import numpy as np
import pytest
from common import AUTORESETS, NAMES, PERTURBED

import libration
from libration.policies import MLP, Constant, Linear, Policy, Random

WEIGHTS = {"Oscillator": [-3.0, -1.0], "Pendulum": [-2.0, 1.0, -0.5], "Duffing": [-1.0, -0.5]}


def made(name, num_envs=6, mode="SameStep", **given):
    if name != "Pendulum":
        given = dict(bound=1.3, **given)
    envs = libration.Environments(name, num_envs, autoreset_mode=mode, max_episode_steps=23, **given)
    envs.reset(seed=5)
    return envs


@pytest.mark.parametrize("perturbed", [{}, PERTURBED], ids=["ideal", "perturbed"])
@pytest.mark.parametrize("mode", AUTORESETS[:2])
@pytest.mark.parametrize("name", NAMES)
def test_a_rollout_is_the_steps_that_its_actions_lead_to(name, mode, perturbed):
    one, other = made(name, mode=mode, **perturbed), made(name, mode=mode, **perturbed)
    seen = other._reset([5 + n for n in range(6)])
    found = one.rollout(Linear(WEIGHTS[name], 0.1), 60)
    ends = 0
    for t in range(60):
        np.testing.assert_array_equal(found.observations[t], seen)
        seen, rewards, terminated, truncated, _ = other.step(found.actions[t])
        np.testing.assert_array_equal(found.rewards[t], rewards)
        np.testing.assert_array_equal(found.terminated[t], terminated)
        np.testing.assert_array_equal(found.truncated[t], truncated)
        ends += (terminated | truncated).sum()
    np.testing.assert_array_equal(found.last_observations, seen)
    assert ends == len(found.episodes["steps"]) >= 10
    # Actions are those of the formula, to the roundings of two products and two sums.
    wanted = found.observations @ np.array(WEIGHTS[name], np.float32) + np.float32(0.1)
    np.testing.assert_allclose(found.actions[..., 0], wanted, rtol=1e-5, atol=1e-6)


def test_a_network_answers_as_numpy_does():
    rng = np.random.default_rng(1)
    sizes = [3, 24, 7, 1]
    layers = [
        (rng.normal(size=(n, m)) / np.sqrt(m), rng.normal(size=n) / 4)
        for m, n in zip(sizes, sizes[1:])
    ]
    functions = {"tanh": np.tanh, "relu": lambda x: np.maximum(x, 0)}
    for activation, function in functions.items():
        found = made("Pendulum", 100, dtype="float64").rollout(MLP(layers, activation), 40)
        x = found.observations
        for i, (matrix, biases) in enumerate(layers):
            x = x @ matrix.T + biases
            x = x if i + 1 == len(layers) else function(x)
        # Sums of at most 24 products of about one, and tangents good to 16 units of the last place.
        np.testing.assert_allclose(found.actions, x, rtol=0, atol=1e-13)


def test_random_actions_follow_from_the_seed_and_fill_their_interval():
    found = made("Oscillator", 500).rollout(Random(-2.0, 1.0), 100, log_probs=True)
    same = made("Oscillator", 700, threads=2).rollout(Random(-2.0, 1.0), 100)
    np.testing.assert_array_equal(found.actions, same.actions[:, :500])
    assert found.actions.min() < -1.99 and found.actions.max() > 0.99
    # The mean of 50 000 has a deviation of 3/√12/√50000 = 0.004.
    assert abs(found.actions.mean() + 0.5) < 0.02
    np.testing.assert_allclose(found.log_probs, -np.log(3), rtol=1e-6)


@pytest.mark.parametrize("before", ["steps", "rollout"])
def test_what_is_drawn_follows_from_the_episode_whoever_acted_before(before):
    wanted = made("Pendulum").rollout(Random(-1.0, 1.0), 10).actions
    envs = made("Pendulum")
    for t in range(4):
        envs.step(wanted[t]) if before == "steps" else envs.rollout(Constant(), 1)
    np.testing.assert_array_equal(envs.rollout(Random(-1.0, 1.0), 6).actions, wanted[4:])


@pytest.mark.parametrize("mode", AUTORESETS)
def test_advantages_are_those_of_the_definition(mode):
    found = made("Duffing", 9, mode, dtype="float64").rollout(Constant(0.1), 50, values=True)
    rng = np.random.default_rng(2)
    found.values[:] = rng.normal(size=(50, 9))
    last, final = rng.normal(size=9), rng.normal(size=len(found.episodes["steps"]))
    advantages, returns = found.advantages(0.9, 0.8, last_values=last, final_values=final)
    ended = found.terminated | found.truncated
    at = {(t, n): v for t, n, v in zip(found.episodes["steps"], found.episodes["environments"], final)}
    moves = found.transitions
    wanted = np.zeros((51, 9))
    for t, n in ((t, n) for t in reversed(range(50)) for n in range(9)):
        if not moves[t, n]:
            continue
        if ended[t, n]:
            value, follows = (0.0 if found.terminated[t, n] else at[t, n]), 0.0
        else:
            value, follows = (last[n] if t == 49 else found.values[t + 1, n]), wanted[t + 1, n]
        error = found.rewards[t, n] + 0.9 * value - found.values[t, n]
        wanted[t, n] = error + 0.9 * 0.8 * follows
    np.testing.assert_allclose(advantages, wanted[:50], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(returns, np.where(moves, wanted[:50] + found.values, 0), rtol=1e-12, atol=1e-12)


def test_memory_is_filled_again_and_outlives_whoever_made_it():
    envs = made("Pendulum", 300)
    out = envs.rollout(Random(-1, 1), 20)
    observations, first = out.observations, out.observations.copy()
    assert envs.rollout(Random(-1, 1), 20, out=out) is out
    assert np.shares_memory(out.observations, observations) and (observations != first).any()
    kept = observations.copy()
    envs._close()
    del envs, out
    gc.collect()
    np.testing.assert_array_equal(observations, kept)


@pytest.mark.parametrize("buffers", [1, 2])
def test_what_is_seen_last_in_a_rollout_is_no_array_of_a_step(buffers):
    envs = libration.Environments("Pendulum", 4, copy=False, buffers=buffers)
    envs.reset(seed=0)
    rollout = envs.rollout(Constant(1.0), 5)
    kept = rollout.last_observations.copy()
    for _ in range(3):
        envs.step(np.full(4, 3.0))
    np.testing.assert_array_equal(rollout.last_observations, kept)


@pytest.mark.parametrize("mode", ["NextStep", "Disabled"])
def test_a_long_rollout_can_be_interrupted(mode):
    given = dict(substeps=1_000_000, max_episode_steps=1, autoreset_mode=mode)
    envs = libration.Environments("Oscillator", 100, **given)
    envs.reset(seed=0)
    # A process in the background may have been told to ignore it.
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            # It would take minutes.
            envs.rollout(Constant(), 10_000)
        timer.join()
    finally:
        signal.signal(signal.SIGINT, handler)
    if mode == "Disabled":
        # What ended before stands.
        with pytest.raises(RuntimeError, match="is over: reset it"):
            envs.step(np.zeros(100))
        envs.reset()
    # It goes on.
    envs.step(np.zeros(100))


@pytest.mark.parametrize(
    ("policy", "error", "said"),
    [
        (Linear([1.0, 2.0]), ValueError, "there are 2 weights, but there must be 3"),
        (MLP([1, 2]), TypeError, "layer 0 is no pair"),
        (Policy(), TypeError, "Policy is not a policy of the engine"),
        (Linear([1.0, np.nan, 2.0]), ValueError, "weights is not finite"),
        (Linear(["a", "b", "c"]), TypeError, "weights has dtype"),
        (Random(1.0, 1.0), ValueError, "from 1.0 to 1.0"),
        (Constant(np.inf), ValueError, "action is inf"),
        (MLP([]), ValueError, "no layers"),
        (MLP([(np.zeros((1, 2)), np.zeros(1))]), ValueError, r"matrix 0 has shape \(1, 2\)"),
        (MLP([(np.zeros((2, 3)), np.zeros(2))]), ValueError, "2 outputs"),
        (MLP([(np.zeros((1, 3)), np.zeros(1))], "gelu"), ValueError, "activation is 'gelu'"),
        (MLP([(np.zeros((300, 3)), np.zeros(300)), (np.zeros((1, 300)), np.zeros(1))]), ValueError, "300; it must be 256"),
        (lambda seen: seen, TypeError, "policy must be one of libration.policies"),
    ],
)
def test_policies_that_cannot_act_are_refused(policy, error, said):
    with pytest.raises(error, match=said):
        made("Pendulum").rollout(policy, 5)


def test_rollouts_that_cannot_be_are_refused():
    envs = made("Pendulum")
    out = envs.rollout(Constant(), 5)
    with pytest.raises(ValueError, match="horizon is 0"):
        envs.rollout(Constant(), 0)
    with pytest.raises(MemoryError, match="a rollout of 1099511627776 steps"):
        envs.rollout(Constant(), 2**40)
    with pytest.raises(ValueError, match=r"out has shape \(5, 6\)"):
        envs.rollout(Constant(), 6, out=out)
    with pytest.raises(ValueError, match="of another dtype"):
        made("Pendulum", dtype="float64").rollout(Constant(), 5, out=out)
    with pytest.raises(ValueError, match="numbers that an environment of the rollout shows is 3; it must be 2"):
        made("Duffing").rollout(Constant(), 5, out=out)
    with pytest.raises(ValueError, match="the rollout has no values"):
        out.advantages(last_values=np.zeros(6))
