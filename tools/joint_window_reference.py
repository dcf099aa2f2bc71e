#!/usr/bin/env python3
"""Prints stable latencies that all inputs of a loop have together, in periods: the numbers of
crates/libration-linear/tests/linear/joint_latency_windows.rs (known_windows).

The state of a period is the plant and the past commands. A command that is late by w periods and a
part p acts in [p, h) of its period, the one before it in [0, p). Latencies are scanned in steps of
1/200 period; changes of the spectral radius across 1 are bisected.

usage: joint_window_reference.py
"""
import numpy as np
from scipy.linalg import expm

PLANTS = {  # A, B, state feedback u = -K x, period, own latency of each input in periods
    "oscillators": ([[0, 1, 0, 0], [-9, 0, 2, 0], [0, 0, 0, 1], [1, 0, -4, 0]],
                    [[0, 0], [1, 0], [0, 0], [0.3, 1]],
                    [[0.8, 1.2, 0.1, -0.3], [0.2, 0.4, 0.5, 0.9]], 0.1, [0.0, 0.0]),
    "integrators": ([[0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0]],
                    [[0, 0], [1, 0.2], [0, 0], [-0.3, 1]],
                    [[1, 1.5, 0.2, 0], [0, 0.1, 2, 2.5]], 0.05, [0.3, 1.6]),
    "unstable": ([[0.5, 1, 0], [-1, 0.2, 0.5], [0, 0.3, -1]],
                 [[1, 0], [0, 1], [0.5, 0.5]],
                 [[3, 0.5, 0.2], [-0.4, 2.5, 0.3]], 0.1, [0.7, 0.2]),
}

def radius(A, B, K, h, own, added):
    n, m = B.shape
    def flow(t):
        full = expm(np.block([[A, B], [np.zeros((m, n + m))]]) * t)
        return full[:n, :n], full[:n, n:]
    late = [divmod(b + added, 1.0) for b in own]
    depth = int(max(w for w, _ in late)) + 1
    M = np.zeros((n + depth * m, n + depth * m))    # x, u[k-1], ..., u[k-depth]
    M[:n, :n] = flow(h)[0]
    for i, (w, p) in enumerate(late):
        new = flow(h * (1 - p))[1][:, i]
        old = flow(h * (1 - p))[0] @ flow(h * p)[1][:, i]
        for back, effect in ((int(w), new), (int(w) + 1, old)):
            if back == 0:
                M[:n, :n] -= np.outer(effect, K[i])
            else:
                M[:n, n + (back - 1) * m + i] += effect
    M[n:n + m, :n] = -K
    M[n + m:, n:-m] = np.eye((depth - 1) * m)
    return max(abs(np.linalg.eigvals(M)))

for name, (A, B, K, h, own) in PLANTS.items():
    A, B, K = (np.array(x, float) for x in (A, B, K))
    stable = lambda t: radius(A, B, K, h, own, t) < 1
    grid = np.arange(0, 30, 1 / 200) + 1e-4
    ends, before = ([0.0] if stable(grid[0]) else []), stable(grid[0])
    for low, high in zip(grid[:-1], grid[1:]):
        now = stable(high)
        if now != before:
            for _ in range(50):
                middle = (low + high) / 2
                low, high = (middle, high) if stable(middle) == before else (low, middle)
            ends.append(float(low))
        before = now
    print(name, ends)
