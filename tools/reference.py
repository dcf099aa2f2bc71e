#!/usr/bin/env python3
"""Makes crates/libration/tests/reference/systems.json: exact solutions of the built-in systems.

Run it, from anywhere, with a Python that has mpmath (1.3 or later):

    pip install mpmath
    python tools/reference.py

Each case is a system, its parameters, a start, a time, and the exact state and energy at that
time. Every solution is worked out with 50 digits from a closed form where there is one, confirmed
by an independent Taylor integration of the equation of motion to 25 digits, and then rounded to
the nearest double. Parameters, starts and times are doubles, taken at their exact values.
"""

import json
from pathlib import Path

from mpmath import (
    acos, asin, cos, diff, ellipf, ellipfun, ellipk, exp, findroot, lu_solve, matrix, mp, mpf,
    odefun, pi, sin, sqrt,
)

mp.dps = 50


# Accelerations and energies, as the textbooks have them.

def oscillator(p, q, v):
    return [-p["omega2"] * x for x in q]

def oscillator_energy(p, q, v):
    return sum(u * u for u in v) / 2 + p["omega2"] * sum(x * x for x in q) / 2

def damped(p, q, v):
    return [-p["omega2"] * q[0] - p["gamma"] * v[0]]

def driven(p, q, v):
    force = p["amplitude"] * cos(p["drive"] * q[1])
    return [-p["omega2"] * q[0] - p["gamma"] * v[0] + force, mpf(0)]

def driven_energy(p, q, v):
    return oscillator_energy(p, q[:1], v[:1])

def pendulum(p, q, v):
    return [-p["omega2"] * sin(q[0])]

def pendulum_energy(p, q, v):
    return v[0] ** 2 / 2 + p["omega2"] * (1 - cos(q[0]))

def duffing(p, q, v):
    return [-p["alpha"] * q[0] - p["beta"] * q[0] ** 3]

def duffing_energy(p, q, v):
    return v[0] ** 2 / 2 + p["alpha"] * q[0] ** 2 / 2 + p["beta"] * q[0] ** 4 / 4

def kepler(p, q, v):
    r = sqrt(q[0] ** 2 + q[1] ** 2)
    return [-p["mu"] * x / r ** 3 for x in q]

def kepler_energy(p, q, v):
    return (v[0] ** 2 + v[1] ** 2) / 2 - p["mu"] / sqrt(q[0] ** 2 + q[1] ** 2)

def henon_heiles(p, q, v):
    x, y = q
    return [-x - 2 * p["lambda"] * x * y, -y - p["lambda"] * (x * x - y * y)]

def henon_heiles_energy(p, q, v):
    (x, y), (a, b) = q, v
    return (a * a + b * b) / 2 + (x * x + y * y) / 2 + p["lambda"] * (x * x * y - y ** 3 / 3)


# Closed forms: the position as a function of time. Velocities are derivatives.

def solve_oscillator(p, q, v):
    w = sqrt(p["omega2"])
    return lambda t: [x * cos(w * t) + u / w * sin(w * t) for x, u in zip(q, v)]

def solve_damped(p, q, v):
    """Underdamped: Landau and Lifshitz, Mechanics, eq. (25.4)."""
    half = p["gamma"] / 2
    w = sqrt(p["omega2"] - half ** 2)
    sine = (v[0] + half * q[0]) / w
    return lambda t: [exp(-half * t) * (q[0] * cos(w * t) + sine * sin(w * t))]

def solve_driven(p, q, v):
    """The steady state, Landau and Lifshitz, eq. (26.4), and a transient that fits the start."""
    drive, phase = p["drive"], p["drive"] * q[1]
    # a cos + b sin of the angle drive * t + phase solves the driven equation.
    detuning, loss = p["omega2"] - drive ** 2, p["gamma"] * drive
    a, b = lu_solve(matrix([[detuning, loss], [-loss, detuning]]), matrix([p["amplitude"], 0]))
    steady = lambda t: a * cos(drive * t + phase) + b * sin(drive * t + phase)
    steady_velocity = drive * (-a * sin(phase) + b * cos(phase))
    transient = solve_damped(p, [q[0] - steady(0)], [v[0] - steady_velocity])
    return lambda t: [steady(t) + transient(t)[0], q[1] + t]

def solve_pendulum(p, q, v):
    """Swinging: sin(q/2) = k sn(omega t + phase, k), hence v = 2 omega k cn(omega t + phase, k)."""
    w = sqrt(p["omega2"])
    k = sqrt(sin(q[0] / 2) ** 2 + (v[0] / (2 * w)) ** 2)
    assert k < 1 and abs(q[0]) <= pi
    phase = ellipf(asin(sin(q[0] / 2) / k), k * k)
    if v[0] < 0:
        phase = 2 * ellipk(k * k) - phase
    return lambda t: [2 * asin(k * ellipfun("sn", w * t + phase, k=k))]

def solve_duffing(p, q, v):
    """About all wells: q = A cn(W t + phase, m), W^2 = alpha + beta A^2, m = beta A^2/(2 W^2)."""
    alpha, beta = p["alpha"], p["beta"]
    amplitude = sqrt((sqrt(alpha ** 2 + 4 * beta * duffing_energy(p, q, v)) - alpha) / beta)
    w = sqrt(alpha + beta * amplitude ** 2)
    m = beta * amplitude ** 2 / (2 * w ** 2)
    assert 0 < m < 1
    phase = ellipf(acos(q[0] / amplitude), m)
    if v[0] > 0:
        phase = -phase
    return lambda t: [amplitude * ellipfun("cn", w * t + phase, m=m)]

def solve_kepler(p, q, v):
    """From perihelion on the positive x axis, by Kepler's equation E - e sin E = n t."""
    assert q[1] == 0 and v[0] == 0 and q[0] > 0 and v[1] > 0
    a = 1 / (2 / q[0] - v[1] ** 2 / p["mu"])
    e = 1 - q[0] / a
    n = sqrt(p["mu"] / a ** 3)
    assert 0 <= e < 1

    def position(t):
        anomaly = findroot(lambda E: E - e * sin(E) - n * t, n * t + e * sin(n * t))
        return [a * (cos(anomaly) - e), a * sqrt(1 - e * e) * sin(anomaly)]

    return position


SYSTEMS = {
    "oscillator": (oscillator, oscillator_energy, solve_oscillator),
    "damped-oscillator": (damped, oscillator_energy, solve_damped),
    "driven-oscillator": (driven, driven_energy, solve_driven),
    "pendulum": (pendulum, pendulum_energy, solve_pendulum),
    "duffing": (duffing, duffing_energy, solve_duffing),
    "kepler": (kepler, kepler_energy, solve_kepler),
    "henon-heiles": (henon_heiles, henon_heiles_energy, None),
}

# name, system, parameters, q, v, time.
#
# Where the start has no acceleration, or no velocity, or the time is a special one, a method may
# look better than it is: its leading error vanishes there. These starts and times are generic.
CASES = [
    ("oscillator in 1 dimension", "oscillator", {"omega2": 10.0}, [1.0], [0.5], 2.0),
    ("oscillator in 3 dimensions", "oscillator", {"omega2": 10.0},
     [1.0, -0.25, 0.5], [0.0, 2.0, -1.5], 2.0),
    ("damped oscillator", "damped-oscillator", {"omega2": 10.0, "gamma": 0.75}, [1.0], [0.5], 2.25),
    ("driven oscillator", "driven-oscillator",
     {"omega2": 10.0, "gamma": 0.25, "amplitude": 1.5, "drive": 2.5}, [0.5, 0.25], [-1.0, 1.0], 2.0),
    ("driven oscillator without damping", "driven-oscillator",
     {"omega2": 10.0, "gamma": 0.0, "amplitude": 1.5, "drive": 2.5}, [0.5, 0.25], [-1.0, 1.0], 2.0),
    ("pendulum, swinging to 2.5 rad", "pendulum", {"omega2": 9.81}, [2.5], [0.5], 1.25),
    ("Duffing, hardening spring", "duffing", {"alpha": 1.0, "beta": 2.0}, [1.0], [1.5], 2.0),
    ("Duffing, double well", "duffing", {"alpha": -1.0, "beta": 1.0}, [1.25], [-0.75], 3.0),
    ("Kepler, eccentricity 0.6", "kepler", {"mu": 1.0}, [0.4, 0.0], [0.0, 2.0], 3.0),
    ("Henon-Heiles, strong coupling", "henon-heiles", {"lambda": 1.0},
     [0.25, 0.125], [0.25, -0.25], 6.0),
    ("Henon-Heiles, weak coupling", "henon-heiles", {"lambda": 0.5},
     [0.5, -0.25], [0.125, 0.5], 4.0),
]


def taylor(acceleration, p, q, v, time, digits):
    """The state at `time` by mpmath's Taylor series, with `digits` digits."""
    D = len(q)
    with mp.workdps(digits):
        flow = odefun(lambda t, y: list(y[D:]) + acceleration(p, y[:D], y[D:]), 0, q + v)
        y = flow(time)
    return y[:D], y[D:]


def solve(name, system, parameters, q, v, time):
    acceleration, energy, closed = SYSTEMS[system]
    p = {key: mpf(value) for key, value in parameters.items()}
    q, v, time = [mpf(x) for x in q], [mpf(x) for x in v], mpf(time)
    digits = 25
    end_q, end_v = taylor(acceleration, p, q, v, time, 40 if closed is None else digits)
    if closed is None:
        exact_q, exact_v = end_q, end_v
        end_q, end_v = taylor(acceleration, p, q, v, time, digits)
    else:
        position = closed(p, q, v)
        exact_q = position(time)
        exact_v = [diff(lambda t: position(t)[i], time) for i in range(len(q))]
    error = max(abs(a - b) for a, b in zip(exact_q + exact_v, list(end_q) + list(end_v)))
    assert error < mpf(10) ** (5 - digits), f"{name}: {error}"
    print(f"{name}: confirmed to {float(error):.0e}")
    return {
        "name": name,
        "system": system,
        "parameters": parameters,
        "time": float(time),
        "start": {"q": [float(x) for x in q], "v": [float(x) for x in v],
                  "energy": float(energy(p, q, v))},
        "end": {"q": [float(x) for x in exact_q], "v": [float(x) for x in exact_v],
                "energy": float(energy(p, exact_q, exact_v))},
    }


def main():
    root = Path(__file__).resolve().parent.parent
    path = root / "crates/libration/tests/reference/systems.json"
    made_by = "tools/reference.py"
    cases = [solve(*case) for case in CASES]
    path.write_text(json.dumps({"made_by": made_by, "cases": cases}, indent=1) + "\n")


if __name__ == "__main__":
    main()
