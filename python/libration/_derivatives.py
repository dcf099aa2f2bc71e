"""Jacobians by central differences."""

from __future__ import annotations

from typing import Callable

import numpy as np
from numpy.typing import NDArray

from . import _native

Array = NDArray[np.float64]

# The step of a central difference with the least error.
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
    return _native._jacobian(lambda points: np.stack([function(point) for point in points]), z, scale)


def _pair(function: Callable[[Array], Array], z: Array, j: int, step: float) -> tuple[Array, Array, float]:
    """Return the function on both sides of a variable, and their distance."""
    right, left = z.copy(), z.copy()
    right[j] += step
    left[j] -= step
    return function(right), function(left), float(right[j] - left[j])
