#!/usr/bin/env python3
"""Makes crates/libration-analyze/tests/reference/loops.json: how second moments of control loops grow.

Run it, from anywhere, with a Python that has NumPy and SciPy:

    pip install numpy scipy
    python tools/loop_reference.py

It uses nothing of Libration. Each case is a plant, a feedback `u = -KP q - KD v`, a latency in steps, a law of
step times and a probability of losses. The program builds the step of the whole loop, `(q, v, waiting commands,
acting command)`, as a matrix M, averages the Kronecker product of M with itself over step times (by quadrature) and
over losses (by their probabilities), and takes the spectral radius with LAPACK.

A step of length h observes the state at its beginning and computes a command. With a latency of d + p steps
(d whole, 0 <= p < 1) the command of d steps ago takes over after the part p of the step; if that command is lost,
the acting one stays. Relative step times are 1 + e with the law of e; a negative step has length zero.
"""

import json
from pathlib import Path

import numpy as np
from scipy.linalg import eig, expm, matrix_balance
from scipy.special import erfc, roots_hermitenorm, roots_legendre

GAUSSIAN, UNIFORM = "gaussian", "uniform"


# A step of h seconds of q'' = -s q - g v + u with a constant u, as a matrix on (q, v, u).

def rate(s, g):
    return np.array([[0.0, 1.0, 0.0], [-s, -g, 1.0], [0.0, 0.0, 0.0]])

def exact(s, g, h):
    return expm(h * rate(s, g))

def rk4(s, g, h):
    x = h * rate(s, g)
    one = np.eye(3)
    return one + x @ (one + x / 2 @ (one + x / 3 @ (one + x / 4)))

def kick(s, g, h):
    return np.array([[1.0, 0.0, 0.0], [-h * s, 1.0 - h * g, h], [0.0, 0.0, 1.0]])

def drift(h):
    return np.array([[1.0, h, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])

def velocity_verlet(s, g, h):
    return kick(s, g, h / 2) @ drift(h) @ kick(s, g, h / 2)

def symplectic_euler(s, g, h):
    return drift(h) @ kick(s, g, h)

STEPS = {
    "exact": exact,
    "rk4": rk4,
    "velocity-verlet": velocity_verlet,
    "symplectic-euler": symplectic_euler,
}


def stiffness_and_damping(system, parameters):
    """Of the system, linearised at the origin: a pendulum is an oscillator there."""
    assert system in ("oscillator", "damped-oscillator", "pendulum")
    return parameters["omega2"], parameters.get("gamma", 0.0)


def loop_step(step, s, g, h, gains, d, p, lost):
    """A step of the loop on (q, v, the last d commands, newest first, the acting command)."""
    n = d + 3
    def coordinate(i):
        row = np.zeros(n)
        row[i] = 1.0
        return row
    q, v, acting = coordinate(0), coordinate(1), coordinate(n - 1)
    new = -gains[0] * q - gains[1] * v
    arriving = acting if lost else (new if d == 0 else coordinate(1 + d))
    for part, command in ((p, acting), (1.0 - p, arriving)):
        if part > 0.0:
            q, v, _ = step(s, g, part * h) @ np.array([q, v, command])
    waiting = [new, *(coordinate(2 + i) for i in range(d - 1))][:d]
    return np.array([q, v, *waiting, arriving])


def legendre(low, high, nodes, pieces):
    x, w = roots_legendre(nodes)
    ends = np.linspace(low, high, pieces + 1)
    for a, b in zip(ends, ends[1:]):
        yield from zip((a + b + (b - a) * x) / 2, (b - a) / 2 * w)


def quadrature(law, nodes):
    """Pairs of a relative step time and its weight."""
    if law is None:
        return [(1.0, 1.0)]
    name, rms = law
    if name == GAUSSIAN and rms < 0.125:
        # Below -8 deviations there is less than a rounding.
        x, w = roots_hermitenorm(nodes)
        return list(zip(1.0 + rms * x, w / np.sqrt(2.0 * np.pi)))
    if name == GAUSSIAN:
        below = 0.5 * erfc(1.0 / (rms * np.sqrt(2.0)))
        density = lambda e: np.exp(-0.5 * (e / rms) ** 2) / (rms * np.sqrt(2.0 * np.pi))
        above = [(1.0 + e, w * density(e)) for e, w in legendre(-1.0, 12.0 * rms, nodes, 16)]
        return [(0.0, below), *above]
    half = np.sqrt(3.0) * rms
    low = max(-half, -1.0)
    above = [(1.0 + e, w / (2.0 * half)) for e, w in legendre(low, half, nodes, 4)]
    return [(0.0, (low + half) / (2.0 * half)), *above]


def mean_square(case, nodes):
    """The spectral radius of E[M x M], and how much an error of the matrix is magnified in it."""
    step = STEPS[case["integrator"]]
    s, g = stiffness_and_damping(case["system"], case["parameters"])
    d = int(case["latency_steps"])
    p = case["latency_steps"] - d
    mean = 0.0
    for length, weight in quadrature(case["jitter"], nodes):
        for lost, share in ((False, 1.0 - case["loss"]), (True, case["loss"])):
            m = loop_step(step, s, g, case["dt"] * length, case["feedback"], d, p, lost)
            mean = mean + weight * share * np.kron(m, m)
    # In units in which rows and columns are alike in size, as LAPACK takes them too.
    mean, _ = matrix_balance(mean)
    values, left, right = eig(mean, left=True, right=True)
    i = np.argmax(np.abs(values))
    l, r = left[:, i], right[:, i]
    condition = np.linalg.norm(l) * np.linalg.norm(r) / abs(np.vdot(l, r)) * np.linalg.norm(mean, 2)
    return abs(values[i]), condition


def case(system, parameters, integrator, dt, feedback, latency_steps, jitter, loss):
    return dict(system=system, parameters=parameters, integrator=integrator, dt=dt, feedback=feedback,
                latency_steps=latency_steps, jitter=jitter, loss=loss)


def oscillator(omega2, *rest):
    return case("oscillator", {"omega2": omega2}, "exact", *rest)


def damped(omega2, gamma, *rest):
    return case("damped-oscillator", {"omega2": omega2, "gamma": gamma}, "exact", *rest)


CASES = [
    # Losses, jitter and a latency of a part of a step at once.
    oscillator(15.98, 0.0608, [23.97, 2.47], 0.5, [GAUSSIAN, 0.068], 0.41),
    # Losses alone: without a latency, within a step, of whole steps, and nearly always.
    oscillator(10.0, 0.05, [10.0, 2.0], 0.0, None, 0.3),
    oscillator(10.0, 0.05, [10.0, 2.0], 0.5, None, 0.3),
    oscillator(4.0, 0.1, [3.0, 1.0], 3.0, None, 0.15),
    oscillator(10.0, 0.05, [10.0, 2.0], 1.25, None, 0.97),
    # Losses under uniform jitter, some of it so large that steps are of length zero.
    oscillator(25.0, 0.04, [30.0, 6.0], 0.0, [UNIFORM, 0.3], 0.2),
    oscillator(25.0, 0.04, [30.0, 6.0], 2.3, [UNIFORM, 0.3], 0.2),
    oscillator(9.0, 0.2, [6.0, 2.0], 0.0, [UNIFORM, 0.8], 0.1),
    # Losses under Gaussian jitter, the same.
    oscillator(1.0, 0.3, [2.0, 1.5], 1.0, [GAUSSIAN, 0.1], 0.25),
    oscillator(6.0, 0.1, [8.0, 2.0], 0.7, [GAUSSIAN, 0.5], 0.3),
    # Damped, overdamped, and hardly damped.
    damped(10.0, 0.4, 0.05, [5.0, 1.0], 0.25, [GAUSSIAN, 0.05], 0.2),
    damped(4.0, 9.0, 0.1, [12.0, 0.5], 1.5, [UNIFORM, 0.2], 0.4),
    damped(3.0, 0.03, 0.08, [4.0, 2.5], 0.5, [GAUSSIAN, 0.12], 0.1),
    # Steps of integrators, also of a pendulum at rest.
    case("oscillator", {"omega2": 10.0}, "velocity-verlet", 0.05, [10.0, 2.0], 0.5, [UNIFORM, 0.2], 0.35),
    case("pendulum", {"omega2": 9.81}, "rk4", 0.1, [5.0, 2.0], 1.5, [GAUSSIAN, 0.1], 0.3),
    case("pendulum", {"omega2": 9.81}, "symplectic-euler", 0.05, [5.0, 2.0], 2.0, None, 0.05),
    # Nothing is lost.
    oscillator(10.0, 0.05, [10.0, 2.0], 0.5, [GAUSSIAN, 0.1], 0.0),
    oscillator(10.0, 0.05, [10.0, 2.0], 4.0, [UNIFORM, 0.25], 0.0),
]


def main():
    for one in CASES:
        (coarse, _), (radius, condition) = mean_square(one, 40), mean_square(one, 60)
        assert abs(coarse / radius - 1.0) < 1e-13, (one, coarse, radius)
        # What the test derives its tolerance from.
        assert condition < 1e3, (one, condition)
        one["mean_square_radius"] = float(radius)
        print(f"{radius:.15f} {condition:8.1f} {one}")
    root = Path(__file__).resolve().parent.parent
    path = root / "crates/libration-analyze/tests/reference/loops.json"
    path.write_text(json.dumps({"made by": "tools/loop_reference.py", "cases": CASES}, indent=1) + "\n")


if __name__ == "__main__":
    main()
