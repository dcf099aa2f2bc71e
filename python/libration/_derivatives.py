"""Jacobians by central differences."""

from __future__ import annotations

from typing import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Steps relative to the scale of a variable: 1/16, 1/64, … The first ones suit smooth functions, to rounding. The last ones suit
# functions that bend on a thousandth of the scale.
_STEPS = tuple(2.0**-k for k in range(4, 26, 2))
# Steps at which the slopes on both sides are compared.
_MIDDLE_STEPS = _STEPS[3:8]
_LEAST_STEPS = 3
_SHORT_STEP = float(np.finfo(np.float64).eps) ** (1 / 3)


def central_jacobian(function: Callable[[Array], Array], z: Array, scale: Array) -> Array:
    """Return the Jacobian by one central difference for each variable, with about ten digits."""
    columns = []
    for j in range(len(z)):
        above, below, width = _pair(function, z, j, _SHORT_STEP * scale[j])
        columns.append((above - below) / width)
    return np.stack(columns, axis=1)


def extrapolated_jacobian(function: Callable[[Array], Array], z: Array, scale: Array) -> tuple[Array, Array]:
    """Return the Jacobian and estimates of the absolute error of its entries.

    Central differences of falling steps are extrapolated to zero by Richardson's scheme, and each entry is that of the smallest
    estimated error (C. J. F. Ridders, Advances in Engineering Software 4, 1982). The estimate includes the rounding of the
    function. At a kink it includes half the difference of the slopes on both sides. Steps to where the function is not finite are left
    out; a column of NaN with infinite errors means that fewer than three were left.
    """
    centre = function(z)
    noise = _noise(function, z, scale)
    pairs = [_column(function, centre, noise, z, j, scale[j]) for j in range(len(z))]
    return np.stack([value for value, _ in pairs], axis=1), np.stack([error for _, error in pairs], axis=1)


def _noise(function: Callable[[Array], Array], z: Array, scale: Array) -> Array:
    """Return the rounding of the function: the largest second difference at ten points so close that it is linear otherwise.

    It includes the rounding of terms that cancel. J. J. Moré and S. M. Wild, SIAM Journal on Scientific Computing 33, 2011.
    """
    points = np.stack([function(z + k * 2.0**-40 * scale) for k in range(-5, 5)])
    return np.max(np.abs(np.diff(points, 2, axis=0)), axis=0)


def _column(
    function: Callable[[Array], Array], centre: Array, noise: Array, z: Array, j: int, scale: float
) -> tuple[Array, Array]:
    table: list[Array] = []
    rows: list[tuple[Array, Array]] = []
    bends: list[Array] = []
    for step in _STEPS:
        above, below, width = _pair(function, z, j, step * scale)
        if not (np.isfinite(above).all() and np.isfinite(below).all()):
            table, rows, bends = [], [], []
            continue
        rounding = (noise + 2 * np.finfo(np.float64).eps * np.maximum(np.abs(above), np.abs(below))) / width
        row = [(above - below) / width]
        best, least = row[0], np.full(centre.shape, np.inf)
        for order, before in enumerate(table, start=1):
            # Steps fall by 4, and the error has even powers of the step.
            row.append(row[-1] + (row[-1] - before) / (16.0**order - 1.0))
            error = np.maximum(np.abs(row[-1] - row[-2]), np.abs(row[-1] - before)) + rounding
            best, least = np.where(error < least, row[-1], best), np.minimum(error, least)
        table = row
        rows.append((best, least))
        if step in _MIDDLE_STEPS:
            bends.append(np.abs(above - 2 * centre + below) / width)
    if len(rows) < _LEAST_STEPS:
        return np.full(centre.shape, np.nan), np.full(centre.shape, np.inf)
    values, errors = (np.stack(part) for part in zip(*rows))
    # The least of many estimates is too small by chance. So the error is at least the distance to the next best values.
    order_of_errors = np.argsort(errors, axis=0, kind="stable")[:_LEAST_STEPS]
    values = np.take_along_axis(values, order_of_errors, axis=0)
    error = np.maximum(np.take_along_axis(errors, order_of_errors[:1], axis=0)[0], np.ptp(values, axis=0))
    if len(bends) > 2:
        # Half the difference of the slopes falls by 4 from step to step if the function is smooth, and grows by 4 by rounding.
        kink = np.maximum.reduce(bends) < 2 * np.minimum.reduce(bends)
        error[kink] += bends[-1][kink]
    return values[0], error


def _pair(function: Callable[[Array], Array], z: Array, j: int, step: float) -> tuple[Array, Array, float]:
    """Return the function on both sides of a variable, and their distance."""
    right, left = z.copy(), z.copy()
    right[j] += step
    left[j] -= step
    return function(right), function(left), float(right[j] - left[j])
