"""Jacobians by differences: their true errors beside the estimated ones."""

import numpy as np
import pytest

from libration._derivatives import extrapolated_jacobian


def pendulum(z):
    """A step of symplectic Euler of 0.01 s of a damped pendulum: angle, rate and torque."""
    rate = z[1] + 0.01 * (-9.81 * np.sin(z[0]) - 0.1 * z[1] + z[2])
    return np.array([z[0] + 0.01 * rate, rate])


def of_pendulum(z):
    of_rate = np.array([-0.0981 * np.cos(z[0]), 1 - 0.001, 0.01])
    return np.stack([np.array([1.0, 0.0, 0.0]) + 0.01 * of_rate, of_rate])


# Function, derivative, number of variables, and range of each.
FUNCTIONS = {
    "sin(x)": (np.sin, lambda z: np.diag(np.cos(z)), 1, 10),
    "sin(10 x)": (lambda z: np.sin(10 * z), lambda z: np.diag(10 * np.cos(10 * z)), 1, 2),
    "exp(x)": (np.exp, lambda z: np.diag(np.exp(z)), 1, 3),
    "x y z": (lambda z: np.array([z.prod()]), lambda z: np.array([[z[1] * z[2], z[0] * z[2], z[0] * z[1]]]), 3, 3),
    "sin(x) exp(y)": (
        lambda z: np.array([np.sin(z[0]) * np.exp(z[1])]),
        lambda z: np.exp(z[1]) * np.array([[np.cos(z[0]), np.sin(z[0])]]),
        2,
        3,
    ),
    "1/(1 + x²)": (lambda z: 1 / (1 + z**2), lambda z: np.diag(-2 * z / (1 + z**2) ** 2), 1, 5),
    "(x³ - 2 x)/(2 + x²)": (
        lambda z: (z**3 - 2 * z) / (2 + z**2),
        lambda z: np.diag(((3 * z**2 - 2) * (2 + z**2) - (z**3 - 2 * z) * 2 * z) / (2 + z**2) ** 2),
        1,
        5,
    ),
    "pendulum": (pendulum, of_pendulum, 3, 3),
}


def quotients(name, seed, points=1000):
    """The largest true error of an entry relative to its estimate at random points, and the largest estimate relative to its row."""
    function, derivative, n, reach = FUNCTIONS[name]
    random, found, sizes = np.random.default_rng(seed), [], []
    for _ in range(points):
        z = random.uniform(-reach, reach, n)
        jacobian, estimates = extrapolated_jacobian(function, z, np.maximum(np.abs(z), 1.0))
        found.append(np.max(np.abs(jacobian - derivative(z)) / estimates))
        sizes.append(np.max(estimates / np.maximum(1.0, np.max(np.abs(jacobian), axis=1, keepdims=True))))
    return np.array(found), np.array(sizes)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_true_error_is_less_than_the_estimate_but_for_single_points(name):
    found, sizes = quotients(name, 0)
    # Seeds 0 to 4 have one of 40,000 points above 1, with 1.03, and 99.9 % below 0.39; 40,000 other points had one with 1.17. The estimate
    # is from a few samples of rounding, and that of other libraries of sin and exp differs, so that a few points may be above 1.
    assert np.quantile(found, 0.995) < 1 and found.max() < 2
    # Nor is it so large that it says nothing: it is at most 1e-11 here, and the median of the quotients 0.03 to 0.13.
    assert sizes.max() < 1e-10 and np.median(found) > 1e-3
