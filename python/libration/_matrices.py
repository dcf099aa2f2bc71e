"""Conversion of matrices to lists of rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ._settings import shown


def array(name: str, value: ArrayLike) -> np.ndarray:
    """Return real, finite numbers as an array.

    Raises
    ------
    TypeError, ValueError
        If they are not; the message has ``name``.
    """
    try:
        found = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name} is {shown(value)}; expected rows of equal length") from error
    if found.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {found.dtype}; expected real numbers")
    found = found.astype(np.float64)
    if not np.isfinite(found).all():
        raise ValueError(f"{name} has an entry that is not finite; expected finite numbers")
    return found


def matrix(name: str, value: ArrayLike) -> list[list[float]]:
    """Return a matrix row by row; numbers and vectors are rows."""
    rows = np.atleast_2d(array(name, value))
    if rows.ndim != 2:
        raise ValueError(f"{name} has shape {np.shape(value)}; expected a matrix")
    return rows.tolist()


def columns(name: str, value: ArrayLike) -> list[list[float]]:
    """Return a matrix row by row; a vector is a column."""
    found = array(name, value)
    return matrix(name, found[:, np.newaxis] if found.ndim == 1 else found)
