#!/usr/bin/env python3
"""Prints the states after 20 implicit steps of 0.1 s of a nonlinear system, for crates/libration-equations/tests/programs/implicit_steps.rs.

Written from the textbooks, with NumPy 2 and SciPy 1; nothing comes from Libration. The system is
    x'' = -2 sin x - 0.3 x' cos y',   y'' = 3 (x - y) - 0.2 y'^3 + 0.1 x'
from x = 1.9, y = -0.4, x' = 0.6, y' = 1.1. Nonlinear equations are solved by scipy.optimize.root to 1e-14, without Newton steps of our own;
derivatives are those of complex steps of 1e-40, without truncation error.

usage: implicit_steps_reference.py
"""
import numpy as np
from scipy.optimize import root

def acceleration(q, v):
    return np.array([
        -2 * np.sin(q[0]) - 0.3 * v[0] * np.cos(v[1]),
        3 * (q[0] - q[1]) - 0.2 * v[1] ** 3 + 0.1 * v[0],
    ])

def rate(y):
    return np.concatenate([y[2:], acceleration(y[:2], y[2:])])

def derivatives(y):
    columns = [rate(y + 1e-40j * e).imag / 1e-40 for e in np.eye(4)]
    J = np.array(columns).T
    return J[2:, :2], J[2:, 2:]

def solved(equation, guess):
    found = root(equation, guess, tol=1e-14, method="hybr")
    return root(equation, found.x, tol=1e-15, method="hybr").x

def velocity_step(explicit):
    """v' = v + h W^-1 force, q' = q + h v'."""
    def step(y, h):
        q, v = y[:2], y[2:]
        W, force = explicit(*derivatives(y), acceleration(q, v), v, h)
        v = v + h * np.linalg.solve(W, force)
        return np.concatenate([q + h * v, v])
    return step

def gauss_legendre(stages):
    """Collocation at the roots of the Legendre polynomial, from NumPy; weights are integrals of Lagrange polynomials."""
    nodes = (np.polynomial.legendre.leggauss(stages)[0] + 1) / 2
    powers = np.vander(nodes, stages, increasing=True)
    exponents = np.arange(1, stages + 1)
    A = (nodes[:, None] ** exponents / exponents) @ np.linalg.inv(powers)
    b = (1 / exponents) @ np.linalg.inv(powers)
    def step(y, h):
        def equation(k):
            K = k.reshape(stages, -1)
            return (np.array([rate(y + h * row @ K) for row in A]) - K).ravel()
        return y + h * b @ solved(equation, np.tile(rate(y), stages)).reshape(stages, -1)
    return step

one = np.eye(2)
STEPS = {
    "DampingImplicit": velocity_step(lambda Aq, Av, a, v, h: (one - h * Av, a)),
    "DampingStiffnessImplicit": velocity_step(
        lambda Aq, Av, a, v, h: (one - h * Av - h * h * Aq, a + h * Aq @ v)),
    "StablePd": velocity_step(lambda Aq, Av, a, v, h: (one - h * Av, a + h * Aq @ v)),
    "BackwardEuler": lambda y, h: solved(lambda z: z - y - h * rate(z), y + h * rate(y)),
    "ImplicitMidpoint": lambda y, h: solved(lambda z: z - y - h * rate((y + z) / 2), y + h * rate(y)),
    "Trapezoid": lambda y, h: solved(lambda z: z - y - h / 2 * (rate(y) + rate(z)), y + h * rate(y)),
    "GaussLegendre4": gauss_legendre(2),
    "GaussLegendre6": gauss_legendre(3),
}

for name, step in STEPS.items():
    y = np.array([1.9, -0.4, 0.6, 1.1])
    for _ in range(20):
        y = step(y, 0.1)
    print(f"        (ImplicitMethod::{name}, [{', '.join(repr(float(x)) for x in y)}]),")
