"""Speed of systems by equations against other ways to step them.

    python tools/equation_speed.py

Requires a release wheel of this package, NumPy, SciPy, numexpr and numba. Each line is a ratio of medians of one run on one thread: the time of
the other way divided by that of the block machine. The results are compared on the way.
"""

from __future__ import annotations

import statistics
import time
from typing import Callable

import numba
import numexpr
import numpy as np
from scipy.integrate import solve_ivp

import libration

ROUNDS = 7
DT = 0.01
GRAVITY, CART, POLE, LENGTH = 9.81, 1.0, 0.1, 0.5
TOTAL = CART + POLE

CART_POLE = libration.System(
    acceleration={
        "x": "push - pole*length*theta''*cos(theta)/total",
        "theta": "(g*sin(theta) - cos(theta)*push) / (length*(4/3 - pole*cos(theta)^2/total))",
    },
    let={"total": "cart + pole", "push": "pole*length*theta'^2*sin(theta)/total"},
    parameters={"cart": CART, "pole": POLE, "length": LENGTH, "g": GRAVITY},
    start={"theta": 0.1},
)


def seconds(work: Callable[[], object]) -> float:
    """Return the median time of a call after a first one."""
    work()
    times = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        work()
        times.append(time.perf_counter() - begun)
    return statistics.median(times)


def starts(count: int) -> tuple[np.ndarray, np.ndarray]:
    q = np.zeros((count, 2))
    q[:, 1] = np.linspace(0.05, 0.5, count)
    return q, np.zeros((count, 2))


def numpy_rates(x, theta, vx, vtheta, out):
    """Write the accelerations into ``out``, in place."""
    sine, cosine, push, below = out[2], out[3], out[4], out[5]
    np.sin(theta, out=sine)
    np.cos(theta, out=cosine)
    np.multiply(vtheta, vtheta, out=push)
    push *= POLE * LENGTH / TOTAL
    push *= sine
    np.multiply(cosine, cosine, out=below)
    below *= -POLE / TOTAL
    below += 4 / 3
    below *= LENGTH
    angular, linear = out[1], out[0]
    np.multiply(cosine, push, out=angular)
    sine *= GRAVITY
    np.subtract(sine, angular, out=angular)
    angular /= below
    np.multiply(angular, cosine, out=linear)
    linear *= -POLE * LENGTH / TOTAL
    linear += push


class InPlace:
    """RK4 by whole arrays in place; ``rates`` computes the accelerations."""

    def __init__(self, count: int, rates: Callable[..., None]) -> None:
        q, v = starts(count)
        self.state = [q[:, 0].copy(), q[:, 1].copy(), v[:, 0].copy(), v[:, 1].copy()]
        self.at = [np.empty(count) for _ in range(4)]
        self.sum = [np.empty(count) for _ in range(4)]
        self.out = [np.empty(count) for _ in range(6)]
        self.rates = rates

    def step(self) -> None:
        state, at, total, out = self.state, self.at, self.sum, self.out
        for stage, (weight, ahead) in enumerate(((1, 0.5), (2, 0.5), (2, 1.0), (1, 0.0))):
            now = state if stage == 0 else at
            self.rates(*now, out)
            slopes = [now[2], now[3], out[0], out[1]]
            for i in range(4):
                if stage == 0:
                    np.multiply(slopes[i], weight, out=total[i])
                elif weight == 1:
                    total[i] += slopes[i]
                else:
                    np.add(total[i], slopes[i], out=total[i])
                    np.add(total[i], slopes[i], out=total[i])
            if ahead:
                new = [slopes[i] * (DT * ahead) for i in range(4)]
                for i in range(4):
                    np.add(state[i], new[i], out=at[i])
        for i in range(4):
            total[i] *= DT / 6
            state[i] += total[i]


def numexpr_rates(x, theta, vx, vtheta, out):
    names = {"theta": theta, "w": vtheta, "g": GRAVITY, "a": POLE * LENGTH / TOTAL, "b": POLE / TOTAL, "l": LENGTH}
    push = "(a*w*w*sin(theta))"
    numexpr.evaluate(
        f"(g*sin(theta) - cos(theta)*{push}) / (l*(4/3 - b*cos(theta)*cos(theta)))", names, out=out[1]
    )
    names["angular"] = out[1]
    numexpr.evaluate(f"{push} - a*angular*cos(theta)", names, out=out[0])


@numba.njit(fastmath=False)
def numba_steps(state, count, dt):
    for n in range(state.shape[1]):
        x, theta, vx, vtheta = state[0, n], state[1, n], state[2, n], state[3, n]
        for _ in range(count):
            s0 = s1 = s2 = s3 = 0.0
            a, b, c, d = x, theta, vx, vtheta
            for stage in range(4):
                sine, cosine = np.sin(b), np.cos(b)
                push = POLE * LENGTH * d * d * sine / TOTAL
                angular = (GRAVITY * sine - cosine * push) / (LENGTH * (4 / 3 - POLE * cosine * cosine / TOTAL))
                linear = push - POLE * LENGTH * angular * cosine / TOTAL
                weight = 1.0 if stage == 0 or stage == 3 else 2.0
                s0 += weight * c
                s1 += weight * d
                s2 += weight * linear
                s3 += weight * angular
                ahead = dt if stage == 2 else 0.5 * dt
                a, b, c, d = x + ahead * c, theta + ahead * d, vx + ahead * linear, vtheta + ahead * angular
            x += dt / 6 * s0
            theta += dt / 6 * s1
            vx += dt / 6 * s2
            vtheta += dt / 6 * s3
        state[0, n], state[1, n], state[2, n], state[3, n] = x, theta, vx, vtheta


def machine(count: int, system=CART_POLE) -> libration.Ensemble:
    q, v = starts(count)
    return libration.Ensemble(system, integrator="rk4", dt=DT, q=q, v=v, threads=1)


def environments() -> None:
    """Print the speed of environments by equations as a part of that of the presets with the same bits."""
    oscillator = libration.System(acceleration={"q": "-10*q + u"}, inputs=["u"])
    pendulum = libration.System(acceleration={"q": "-15*sin(q) + u"}, inputs=["u"])
    cases = [
        ("Oscillator", oscillator, {"reward": "-(q^2 + 0.1*q'^2 + 0.001*u^2)", "terminated": ["abs(q) > 10"]}, 0.01),
        (
            "Pendulum",
            pendulum,
            {"observe": ["-cos(q)", "-sin(q)", "q'"], "reward": "-cos(before(q)) - 1 - 0.1*before(q')^2 - 0.001*u^2"},
            0.05,
        ),
    ]
    count = 4096
    for name, system, task, dt in cases:
        preset = libration.Environments(name, count)
        start = {"q": preset.preset.start_position, "q'": preset.preset.start_velocity}
        limits = {"max_action": preset.preset.max_action, "max_episode_steps": preset.preset.max_episode_steps}
        own = libration.Environments(system, count, dt=dt, start=start, **limits, **task)
        actions = np.zeros((count, 1), np.float32)
        policy = libration.policies.Linear(np.full(len(preset.preset.seen), -0.1))
        times = []
        for all_ in (preset, own):
            all_.reset(seed=0)
            step = seconds(lambda: [all_.step(actions) for _ in range(50)])
            memory = all_.rollout(policy, 100)
            times.append((step, seconds(lambda: all_.rollout(policy, 100, out=memory))))
        ratios = [compiled / mine for compiled, mine in zip(*times)]
        print(f"{f'{name} by equations / preset, f32':34} N = {count:6}  {ratios[0]:8.2f} (step) {ratios[1]:.2f} (rollout)")


def main() -> None:
    environments()
    numexpr.set_num_threads(1)
    count, steps = 100_000, 20
    own = machine(count)
    ours = seconds(lambda: own.advance(steps)) / steps
    for name, rates in (("NumPy in place", numpy_rates), ("numexpr", numexpr_rates)):
        peer = InPlace(count, rates)
        theirs = seconds(peer.step)
        check = machine(count)
        check.advance(1 + ROUNDS)
        assert np.allclose(check.q[:, 1], peer.state[1], rtol=1e-12, atol=1e-14), name
        print(f"{name:34} N = {count:6}  {theirs / ours:8.2f}")
    q, v = starts(count)
    state = np.vstack([q.T, v.T]).copy()
    theirs = seconds(lambda: numba_steps(state, steps, DT)) / steps
    check = machine(count)
    check.advance((1 + ROUNDS) * steps)
    assert np.allclose(check.q[:, 1], state[1], rtol=1e-8, atol=1e-10)
    print(f"{'numba, one thread, no fastmath':34} N = {count:6}  {theirs / ours:8.2f}")

    count = 4096
    few = machine(count)
    ours = seconds(lambda: few.advance(200)) / 200

    def accelerations(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        theta, speed = q[:, 1], v[:, 1]
        sine, cosine = np.sin(theta), np.cos(theta)
        push = POLE * LENGTH * speed**2 * sine / TOTAL
        angular = (GRAVITY * sine - cosine * push) / (LENGTH * (4 / 3 - POLE * cosine**2 / TOTAL))
        return np.stack([push - POLE * LENGTH * angular * cosine / TOTAL, angular], axis=1)

    custom = machine(count, libration.CustomSystem(accelerations))
    theirs = seconds(lambda: custom.advance(20)) / 20
    print(f"{'CustomSystem (Python function)':34} N = {count:6}  {theirs / ours:8.2f}")

    steps = 100_000
    run = lambda: libration.simulate(CART_POLE, integrator="rk4", dt=0.001, steps=steps, every=steps)  # noqa: E731
    ours = seconds(run) / (4 * steps)

    def rate(_: float, y: np.ndarray) -> list[float]:
        a = accelerations(y[None, :2], y[None, 2:])[0]
        return [y[2], y[3], a[0], a[1]]

    def plain(_: float, y: np.ndarray) -> list[float]:
        from math import cos, sin

        _, theta, vx, w = y
        push = POLE * LENGTH * w * w * sin(theta) / TOTAL
        angular = (GRAVITY * sin(theta) - cos(theta) * push) / (LENGTH * (4 / 3 - POLE * cos(theta) ** 2 / TOTAL))
        return [vx, w, push - POLE * LENGTH * angular * cos(theta) / TOTAL, angular]

    for name, function in (("solve_ivp, math", plain), ("solve_ivp, NumPy", rate)):
        evaluations = solve_ivp(function, (0, 10), [0, 0.1, 0, 0], rtol=1e-9, atol=1e-9).nfev
        solve = lambda: solve_ivp(function, (0, 10), [0, 0.1, 0, 0], rtol=1e-9, atol=1e-9)  # noqa: B023, E731
        theirs = seconds(solve) / evaluations
        print(f"{name + ', per evaluation':34} N =      1  {theirs / ours:8.2f}")

    print(f"{'reading a system of 9 lines':34} {1e3 * seconds(lambda: CART_POLE.replace(pole=0.2)):8.3f} ms")


if __name__ == "__main__":
    main()
