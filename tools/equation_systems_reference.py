#!/usr/bin/env python3
"""States of the systems in examples/systems by SciPy's DOP853, from equations that are written here once more.

usage: equation_systems_reference.py > crates/libration-analyze/tests/equations/dop853.json   (requires NumPy and SciPy)
"""
import json
import numpy as np
from numpy import cos, sin
from scipy.integrate import solve_ivp

def double_pendulum(t, y):
    # M(a, b) (a'', b'') = f by the Lagrangian.
    m1, m2, l1, l2, g = 1.0, 0.5, 1.0, 0.7, 9.81
    a, b, va, vb = y
    M = np.array([[(m1 + m2) * l1**2, m2 * l1 * l2 * cos(a - b)], [m2 * l1 * l2 * cos(a - b), m2 * l2**2]])
    f = [-m2 * l1 * l2 * vb**2 * sin(a - b) - (m1 + m2) * g * l1 * sin(a), m2 * l1 * l2 * va**2 * sin(a - b) - m2 * g * l2 * sin(b)]
    return [va, vb, *np.linalg.solve(M, f)]

def cart_pole(t, y):
    # A uniform pole of half length l: inertia 4/3 m l^2 about the pivot.
    M_, m, l, g = 1.0, 0.1, 0.5, 9.81
    x, a, vx, va = y
    M = np.array([[M_ + m, m * l * cos(a)], [m * l * cos(a), 4 / 3 * m * l**2]])
    return [vx, va, *np.linalg.solve(M, [m * l * va**2 * sin(a), m * g * l * sin(a)])]

def van_der_pol(t, y):
    return [y[1], 1.5 * (1 - y[0] ** 2) * y[1] - y[0]]

def lorenz(t, y):
    return [10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2]]

def dc_motor(t, y):
    angle, rate, current = y
    return [rate, (0.05 * current - 1e-4 * rate - 0.02 * angle) / 2e-4, (-1.2 * current - 0.05 * rate) / 0.01]

def chain(t, y):
    x, v = np.r_[0.0, y[:4], 0.0], y[4:]
    tension = np.diff(x) + 0.3 * np.diff(x) ** 3
    return [*v, *np.diff(tension)]

def planar_quadrotor(t, y):
    m, d, g = 0.5, 0.1, 9.81
    x, z, a, vx, vz, va = y
    return [vx, vz, va, -g * sin(a) - d / m * vx, g * cos(a) - d / m * vz - g, 0.0]

def magnetic_bearing(t, y):
    c, i, s = 2e-6, 1.5, 5e-4
    return [y[1], (c * i**2 / (s - y[0]) ** 2 - c * i**2 / (s + y[0]) ** 2 - 5.0 * y[1]) / 2.0]

def three_body(t, y):
    mu = 0.012277471
    z, v = complex(y[0], y[1]), complex(y[2], y[3])
    pull = (1 - mu) * (z + mu) / abs(z + mu) ** 3 + mu * (z - 1 + mu) / abs(z - 1 + mu) ** 3
    a = z - 2j * v - pull
    return [v.real, v.imag, a.real, a.imag]

# System, start, end in s.  The order of the states is that of `libration simulate`.
RUNS = [
    (double_pendulum, [1.2, -0.4, 0, 0], 3.0),
    (cart_pole, [0, 0.1, 0, 0], 2.0),
    (van_der_pol, [0.1, 0], 10.0),
    (lorenz, [1, 1, 20], 5.0),
    (dc_motor, [1.0, 0, 0.5], 0.5),
    (chain, [0.5, 0, -0.2, 0, 0, 0, 0, 0], 10.0),
    (planar_quadrotor, [0, 1.0, 0.2, 0.5, 0, -0.1], 2.0),
    (magnetic_bearing, [1e-5, 0], 0.01),
    (three_body, [0.994, 0, 0, -2.00158510637908], 3.0),
]

runs = []
for system, start, end in RUNS:
    run = solve_ivp(system, (0, end), np.array(start, float), method="DOP853", rtol=1e-13, atol=1e-15)
    runs.append({"system": system.__name__, "end": end, "state": run.y[:, -1].tolist()})
print(json.dumps({"scipy": __import__("scipy").__version__, "runs": runs}, indent=1))
