#!/usr/bin/env python3
"""Writes crates/libration-linear/tests/linear/known_numbers/fractional_hold.txt, with NumPy 2.4.6 and SciPy 1.17.1.

A command with a latency of f periods, 0 < f < 1, acts from f·h to the end of the period and to f·h of the next one:

    x[k+1] = Phi x[k] + G0 u[k] + G1 u[k-1]

`scipy.signal.cont2discrete` steps the plant whose states include the held command, d/dt (x, u) = (Ax + Bu, 0), first by f·h with
u[k-1], then by (1-f)·h with u[k]. The integrals of exp(As)B, by `scipy.integrate.quad_vec`, agree to 1e-13.

Each line: plant, f, then Phi (3 x 3), G0 (3 x 2), G1 (3 x 2) by rows.

usage: fractional_hold_reference.py > fractional_hold.txt
"""
import numpy as np
from scipy.integrate import quad_vec
from scipy.linalg import expm
from scipy.signal import cont2discrete

PERIOD = 0.4
# A damped oscillator with an integrator, and an unstable plant. The same in known_numbers.
PLANTS = [
    ([[0, 1, 0], [-9, -0.5, 0], [1, 0, 0]], [[0, 0], [2, 0.25], [0, 1]]),
    ([[1.5, -2, 0.5], [0.25, -3, 1], [0, 4, 0.75]], [[1, -1], [0.5, 0], [0, 2]]),
]


def held_step(A, B, seconds):
    n, m = B.shape
    augmented = np.block([[A, B], [np.zeros((m, n + m))]])
    shape = np.zeros((n + m, 1)), np.eye(n + m), np.zeros((n + m, 1))
    step = cont2discrete((augmented, *shape), seconds, method="zoh")[0]
    return step[:n, :n], step[:n, n:]


for number, (A, B) in enumerate(PLANTS):
    A, B = np.array(A, float), np.array(B, float)
    for f in [0.1, 0.25, 0.5, 0.8, 0.99]:
        phi_1, gamma_1 = held_step(A, B, f * PERIOD)
        phi_2, G0 = held_step(A, B, (1 - f) * PERIOD)
        Phi, G1 = phi_2 @ phi_1, phi_2 @ gamma_1
        for matrix, span in [(G0, (0, (1 - f) * PERIOD)), (G1, ((1 - f) * PERIOD, PERIOD))]:
            integral = quad_vec(lambda s: expm(A * s) @ B, *span, epsabs=1e-15, epsrel=1e-14)[0]
            assert np.allclose(integral, matrix, rtol=1e-13, atol=1e-13)
        print(number, f, *(repr(float(x)) for M in (Phi, G0, G1) for x in M.ravel()))
