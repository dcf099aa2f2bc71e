#!/usr/bin/env python3
"""The Python package beside the engine in Rust, Gymnasium and EnvPool: steps of the same environments in the same run.

    python3 -m venv target/peers && target/peers/bin/pip install '.[gymnasium]' envpool
    target/peers/bin/python benches/python_peers.py [--json target/python_peers.json]

All on one thread. Each takes its turn, several times over; ratios are medians of ratios of the same round, with their quartiles. Exits with
1 if a bar is missed.
"""

import argparse
import itertools
import json
import pathlib
import statistics
import sys
import time

import gymnasium
import numpy as np

import libration
from libration import _native
from libration.policies import Linear

try:
    import envpool
except ImportError:
    envpool = None

MANY, ROUNDS = 4096, 11


def seconds(work, least=0.05):
    """Of one call, from as many as take long enough."""
    count = 1
    while True:
        start = time.perf_counter()
        for _ in range(count):
            work()
        elapsed = time.perf_counter() - start
        if elapsed >= least:
            return elapsed / count
        count = max(2 * count, int(1.2 * count * least / max(elapsed, 1e-9)))


def once(work):
    """Seconds of one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def compared(ours, theirs):
    """How many times as long theirs takes: quartiles of the ratios of rounds, and medians of both in seconds."""
    rounds = [(seconds(ours), seconds(theirs)) for _ in range(ROUNDS)]
    ratios = statistics.quantiles([b / a for a, b in rounds], n=4)
    return ratios, [statistics.median(column) for column in zip(*rounds)]


def steps(env, actions):
    """A step of an environment that has been reset."""
    env.reset(seed=0)
    step = env.step
    return lambda: step(actions)


def episodes(env, actions):
    """A step of a single environment, which is reset where an episode ends."""
    env.reset(seed=0)
    turn = itertools.cycle(actions.tolist())

    def step():
        _, _, terminated, truncated, _ = env.step(next(turn))
        if terminated or truncated:
            env.reset()

    return step


def rows():
    """What is measured: a sentence, what is to be reached and whether that is a lower or an upper end, ratios and medians."""
    zeros = np.zeros((MANY, 1), np.float32)
    for name in ("PendulumSwingUp", "Oscillator"):
        env = gymnasium.make_vec(f"libration/{name}-v0", MANY)
        count = 200

        def in_rust(settings=env._settings):
            return _native._seconds_of_steps(settings, count) / count

        step = steps(env, zeros)
        rounds = [(seconds(step), min(in_rust() for _ in range(3))) for _ in range(ROUNDS)]
        ratios = statistics.quantiles([rust / python for python, rust in rounds], n=4)
        medians = [statistics.median(column) for column in zip(*rounds)]
        yield f"{name}: step of {MANY} over the same in Rust", 0.7, ratios, medians

    # Into memory that is used again, as who learns does: fresh pages cost as much as what is written into them. It is another in each
    # round, on both sides: how fast it is differs with the pages that it got.
    robots, horizon = libration.Environments("Oscillator", MANY), 1024
    robots.reset(seed=0)
    policy = Linear([-2.0, 0.0])
    request = policy._request(2, 1)
    rounds = []
    for _ in range(ROUNDS):
        out = robots.rollout(policy, horizon)
        python = min(once(lambda: robots.rollout(policy, horizon, out=out)) for _ in range(3))
        rust = min(_native._seconds_of_rollouts(robots._settings, request, horizon, 4)[1:])
        rounds.append((python, rust))
    ratios = statistics.quantiles([rust / python for python, rust in rounds], n=4)
    medians = [statistics.median(column) for column in zip(*rounds)]
    yield f"rollout of {MANY} × {horizon} over the same in Rust", 0.95, ratios, medians

    env = gymnasium.make_vec("libration/PendulumSwingUp-v0", MANY)
    theirs = gymnasium.make_vec("Pendulum-v1", MANY, vectorization_mode="sync")
    yield f"step of {MANY} over SyncVectorEnv", 2000, *compared(steps(env, zeros), steps(theirs, zeros))
    if envpool is not None:
        pool = envpool.make_gymnasium("Pendulum-v1", num_envs=MANY, num_threads=1, seed=0)
        pool.reset()
        yield f"step of {MANY} over EnvPool", 100, *compared(steps(env, zeros), lambda: pool.step(zeros))
    choices = np.random.default_rng(0).integers(0, 2, MANY)
    env = gymnasium.make_vec("libration/CartPole-v1", MANY)
    theirs = gymnasium.make_vec("CartPole-v1", MANY, vectorization_mode="vector_entry_point")
    yield f"CartPole: step of {MANY} over Gymnasium's CartPoleVectorEnv", 2, *compared(steps(env, choices), steps(theirs, choices))
    if envpool is not None:
        pool = envpool.make_gymnasium("CartPole-v1", num_envs=MANY, num_threads=1, seed=0)
        pool.reset()
        narrow = choices.astype(np.int32)
        yield f"CartPole: step of {MANY} over EnvPool", 20, *compared(steps(env, choices), lambda: pool.step(narrow))
    ours, theirs = (gymnasium.make(name).unwrapped for name in ("libration/CartPole-v1", "CartPole-v1"))
    yield "CartPole: step of one over Gymnasium's CartPoleEnv", 3, *compared(episodes(ours, choices), episodes(theirs, choices))
    ours, theirs = (gymnasium.make(name).unwrapped for name in ("libration/Pendulum-v1", "Pendulum-v1"))
    torque = np.zeros(1, np.float32)
    yield "Pendulum: step of one over Gymnasium's PendulumEnv", 3, *compared(steps(ours, torque), steps(theirs, torque))

    # A range of one number: the same steps, by a program in place of a compiled environment.
    for name in ("PendulumSwingUp", "Oscillator"):
        preset = gymnasium.make_vec(f"libration/{name}-v0", MANY)
        (omega2,) = set(preset.get_attr("omega2"))
        program = gymnasium.make_vec(f"libration/{name}-v0", MANY, omega2=libration.Uniform(omega2, omega2))
        yield f"{name}: step of {MANY} by expressions over compiled", 0.3, *compared(steps(program, zeros), steps(preset, zeros))

    one, zero = gymnasium.make_vec("libration/PendulumSwingUp-v0", 1), np.zeros((1, 1), np.float32)
    step, count = steps(one, zero), 20_000
    rounds = [
        (
            seconds(step) - _native._seconds_of_steps(one._settings, count) / count,
            seconds(lambda: one._nothing(zero)),
        )
        for _ in range(ROUNDS)
    ]
    ratios = statistics.quantiles([empty / added for added, empty in rounds], n=4)
    medians = [statistics.median(column) for column in zip(*rounds)]
    yield "an empty call over what Python adds to a step of one", 0.1, ratios, medians


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=pathlib.Path, help="where the numbers are written")
    given = parser.parse_args()
    missed, told = 0, []
    for what, bar, (low, median, high), medians in rows():
        met = median >= bar
        missed += not met
        micro = " and ".join(f"{1e6 * x:.3g}" for x in medians)
        mark = "" if met else "  MISSED"
        print(f"{what}: {median:.3g} times ({low:.3g} to {high:.3g}), wanted {bar:g}; {micro} µs{mark}")
        told.append({"what": what, "bar": bar, "ratio": median, "quartiles": [low, high], "seconds": medians})
    if given.json:
        given.json.write_text(json.dumps({"version": libration.__version__, "rows": told}, indent=2))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
