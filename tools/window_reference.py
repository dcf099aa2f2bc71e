#!/usr/bin/env python3
"""Makes crates/libration-analyze/tests/reference/windows.json: the time steps at which a damped oscillator is stable.

Run it, from anywhere, with a Python that has NumPy:

    pip install numpy
    python tools/window_reference.py

It uses nothing of Libration. The update matrix of each method is a product of the textbooks' kicks and drifts, its
spectral radius is taken with LAPACK on a grid of time steps, which is made finer about each of its minima, and each
end of an interval with a radius of at most 1 is found by bisection.
"""

import json
from pathlib import Path

import numpy as np


def matrices(a, b, c, d):
    return np.stack([np.stack([a, b], -1), np.stack([c, d], -1)], -2)

def kick(s, g, h):
    return matrices(np.ones_like(h), np.zeros_like(h), -h * s, 1.0 - h * g)

def drift(h):
    return matrices(np.ones_like(h), h, np.zeros_like(h), np.ones_like(h))

def velocity_verlet(s, g, h):
    return kick(s, g, h / 2) @ drift(h) @ kick(s, g, h / 2)

def textbook_verlet(s, g, h):
    """q' = q + h v + h^2/2 a and v' = v + h/2 (a + a') with a' of the new position and the old velocity."""
    one = np.ones_like(h)
    to_q = matrices(1.0 - h * h / 2 * s, h - h * h / 2 * g, 0.0 * h, one)
    a = np.stack([-s * one, -g * one], -1)
    new = -s * to_q[..., 0, :] + np.stack([0.0 * h, -g * one], -1)
    v = np.stack([0.0 * h, one], -1) + h[..., None] / 2 * (a + new)
    return np.stack([to_q[..., 0, :], v], -2)

def composed(weights):
    def step(s, g, h):
        all_of_it = np.broadcast_to(np.eye(2), h.shape + (2, 2))
        for weight in weights:
            all_of_it = velocity_verlet(s, g, weight * h) @ all_of_it
        return all_of_it
    return step

P = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
W = 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))
METHODS = {
    "velocity-verlet": velocity_verlet,
    "textbook-verlet": textbook_verlet,
    "yoshida4": composed([W, 1.0 - 2.0 * W, W]),
    "suzuki4": composed([P, P, 1.0 - 4.0 * P, P, P]),
}

# Squared frequency in 1/s^2 and damping rate in 1/s: weak, moderate, critical, overdamped, and two very weak ones.
OSCILLATORS = [[10.0, 0.2], [10.0, 1.3], [3.7, 0.83], [4.0, 4.0], [2.0, 7.5], [1.0, 1e-3], [0.3, 0.01]]

# Time steps that are scanned: up to this over the frequency, in so many equal parts.
HORIZON, GRID, FINER = 30.0, 400_000, 2_000


def radius(step, s, g, h):
    return np.abs(np.linalg.eigvals(step(s, g, np.atleast_1d(h)))).max(-1)


def check_slope(step, s, g, end):
    """What the test derives its tolerance from: a part of 1e-9 of a step changes the radius by 1e-12 or more, and
    LAPACK's radius of matrices with entries below 30 is right to 2e-14; where they are larger, ends are steeper."""
    for h in (end * (1.0 - 1e-9), end * (1.0 + 1e-9)):
        assert abs(radius(step, s, g, h)[0] - 1.0) > 1e-12, (s, g, end)


def windows(step, s, g):
    h = np.linspace(0.0, HORIZON / np.sqrt(s), GRID + 1)[1:]
    # Windows far narrower than the grid show as minima.
    for _ in range(2):
        rho = radius(step, s, g, h)
        low = np.flatnonzero((rho[1:-1] <= rho[:-2]) & (rho[1:-1] <= rho[2:]) & (rho[1:-1] > 1.0)) + 1
        h = np.unique(np.concatenate([h, *(np.linspace(h[i - 1], h[i + 1], FINER) for i in low)]))
    stable = radius(step, s, g, h) <= 1.0
    ends = [0.0] if stable[0] else []
    for i in np.flatnonzero(stable[1:] != stable[:-1]):
        low, high = h[i], h[i + 1]
        while (middle := (low + high) / 2) not in (low, high):
            inside = bool(radius(step, s, g, middle)[0] <= 1.0)
            low, high = (middle, high) if inside == stable[i] else (low, middle)
        check_slope(step, s, g, high)
        ends.append(high)
    assert not stable[-1]
    return [[float(a), float(b)] for a, b in zip(ends[::2], ends[1::2])]


def main():
    cases = []
    for name, step in METHODS.items():
        for s, g in OSCILLATORS:
            found = windows(step, s, g)
            cases.append(dict(integrator=name, omega2=s, gamma=g, windows=found))
            print(cases[-1])
    root = Path(__file__).resolve().parent.parent
    path = root / "crates/libration-analyze/tests/reference/windows.json"
    path.write_text(json.dumps({"made by": "tools/window_reference.py", "horizon": HORIZON, "cases": cases}, indent=1) + "\n")


if __name__ == "__main__":
    main()
