#!/usr/bin/env python3
"""The textbook's oscillator in plain NumPy, for comparison bit for bit.

Nothing here is written to suit another program: these are the formulas as they stand in a book,
in double and in single precision, on NumPy scalars and on NumPy arrays. It needs NumPy 2, where a
Python number takes the type of the NumPy number that it meets; in NumPy 1 it would widen float32.

Prints a line `setting i m k dt x v` for each setting, then a line `f64 rk4 i n bits bits` for each
state: number type, method, setting, number of steps, and position and velocity in hexadecimal.

    python textbook.py
"""

import numpy as np

assert np.lib.NumpyVersion(np.__version__) >= "2.0.0", np.__version__

# Mass in kg, stiffness in N/m, time step in s, initial position in m and velocity in m/s.
SETTINGS = [
    (1.0, 10.0, 0.01, 1.0, 0.0),
    (2.5, 3.0, 0.03, -0.7, 1.3),
]
PRINTED = [1, 2, 3, 10, 100, 1_000, 10_000, 100_000]
# Arrays repeat the same arithmetic, more slowly.
PRINTED_ON_ARRAYS = [1, 2, 3, 10, 100, 1_000]


def explicit_euler(x, v, dt, a):
    return x + dt * v, v + dt * a(x)


def symplectic_euler(x, v, dt, a):
    v = v + dt * a(x)
    x = x + dt * v
    return x, v


def symplectic_euler_drift_first(x, v, dt, a):
    x = x + dt * v
    v = v + dt * a(x)
    return x, v


def velocity_verlet(x, v, dt, a):
    v = v + 0.5 * dt * a(x)
    x = x + dt * v
    v = v + 0.5 * dt * a(x)
    return x, v


def textbook_verlet(x, v, dt, a):
    a_old = a(x)
    x = x + dt * v + 0.5 * dt * dt * a_old
    v = v + 0.5 * dt * (a_old + a(x))
    return x, v


def leapfrog(x, v, dt, a):
    x = x + 0.5 * dt * v
    v = v + dt * a(x)
    x = x + 0.5 * dt * v
    return x, v


def rk4(x, v, dt, a):
    k1x, k1v = v, a(x)
    k2x, k2v = v + 0.5 * dt * k1v, a(x + 0.5 * dt * k1x)
    k3x, k3v = v + 0.5 * dt * k2v, a(x + 0.5 * dt * k2x)
    k4x, k4v = v + dt * k3v, a(x + dt * k3x)
    x = x + dt / 6 * (k1x + 2 * k2x + 2 * k3x + k4x)
    v = v + dt / 6 * (k1v + 2 * k2v + 2 * k3v + k4v)
    return x, v


W1 = 1 / (2 - 2 ** (1 / 3))
W0 = 1 - 2 * W1


def yoshida4(x, v, dt, a):
    for w in [W1, W0, W1]:
        x, v = velocity_verlet(x, v, w * dt, a)
    return x, v


P = 1 / (4 - 4 ** (1 / 3))


def suzuki4(x, v, dt, a):
    for w in [P, P, 1 - 4 * P, P, P]:
        x, v = velocity_verlet(x, v, w * dt, a)
    return x, v


METHODS = {
    "explicit-euler": explicit_euler,
    "symplectic-euler": symplectic_euler,
    "symplectic-euler-drift-first": symplectic_euler_drift_first,
    "velocity-verlet": velocity_verlet,
    "textbook-verlet": textbook_verlet,
    "leapfrog": leapfrog,
    "rk4": rk4,
    "yoshida4": yoshida4,
    "suzuki4": suzuki4,
}


def simulate(step, m, k, dt, x, v, printed):
    """Yields the state after each number of steps in `printed`."""
    omega2 = k / m

    def a(x):
        return -omega2 * x

    done = 0
    for target in printed:
        for _ in range(done, target):
            x, v = step(x, v, dt, a)
        done = target
        yield target, x, v


def show(float_type, method, setting, step, x, v):
    assert x.dtype == v.dtype == float_type
    bits = {np.float64: np.uint64, np.float32: np.uint32}[float_type]
    name = {np.float64: "f64", np.float32: "f32"}[float_type]
    print(name, method, setting, step, f"{x.view(bits):x}", f"{v.view(bits):x}")


def main():
    for i, setting in enumerate(SETTINGS):
        print("setting", i, *setting)
    for float_type in [np.float64, np.float32]:
        for method, step in METHODS.items():
            for i, setting in enumerate(SETTINGS):
                scalars = [float_type(c) for c in setting]
                for n, x, v in simulate(step, *scalars, PRINTED):
                    show(float_type, method, i, n, x, v)
            arrays = [np.array(column, float_type) for column in zip(*SETTINGS)]
            for n, x, v in simulate(step, *arrays, PRINTED_ON_ARRAYS):
                for i in range(len(SETTINGS)):
                    show(float_type, method, i, n, x[i], v[i])


if __name__ == "__main__":
    main()
