"""The first bit in which two recordings differ."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native

__all__ = ["FirstDifference", "first_difference"]


@dataclass(frozen=True)
class FirstDifference:
    """The first number that differs between two recordings."""

    index: tuple[int, ...]
    """Its index along each axis, such as step, environment and component."""
    a: float
    b: float
    ulps: int | None
    """Floats between the two numbers, in units in the last place, 0 of ``0.0`` and ``-0.0``; None if one is NaN, and of integers."""
    differing: int
    """Numbers that differ in all."""


def first_difference(a: ArrayLike | PathLike[str], b: ArrayLike | PathLike[str]) -> FirstDifference | None:
    """Return where two recordings differ first, in the order of their axes; None if all bits agree.

    Parameters
    ----------
    a, b:
        Arrays of the same shape and type, such as steps × environments × components, or paths of files ``.npy``. Numbers of ``float32``
        and of integers are compared as they are; ``0.0`` and ``-0.0`` differ.

    Raises
    ------
    TypeError, ValueError
        If they are no numbers, or if their shapes or types differ.
    """
    first, second = _recording("a", a), _recording("b", b)
    if first.shape != second.shape or first.dtype != second.dtype:
        raise ValueError(
            f"a is {first.dtype} of shape {first.shape} and b {second.dtype} of shape {second.shape}; expected the same shape and type"
        )
    if first.dtype.kind in "iub":
        return _of_integers(first, second)
    wide_first, wide_second = (np.ascontiguousarray(array, dtype=np.float64).reshape(-1) for array in (first, second))
    found = _native._first_difference(wide_first, wide_second, list(first.shape) or [1])
    if found is None:
        return None
    index, x, y, ulps, differing = found
    if first.dtype == np.float32 and ulps is not None:
        ulps = _ulps32(x, y)
    return FirstDifference(tuple(index), x, y, ulps, differing)


def _recording(name: str, value: Any) -> np.ndarray[Any, np.dtype[Any]]:
    if isinstance(value, (str, PathLike)):
        try:
            value = np.load(value, allow_pickle=False)
        except (OSError, ValueError) as error:
            raise ValueError(f"{name} cannot be read: {error}; expected a file .npy") from None
    array = np.asarray(value)
    if array.dtype not in (np.float64, np.float32) and not np.issubdtype(array.dtype, np.integer) and array.dtype != np.bool_:
        raise TypeError(f"{name} has type {array.dtype}; expected float64, float32, integers or truth values")
    return array


def _of_integers(first: np.ndarray[Any, np.dtype[Any]], second: np.ndarray[Any, np.dtype[Any]]) -> FirstDifference | None:
    """Compare integers, which may be no floats."""
    differ = np.atleast_1d(first != second)
    if not differ.any():
        return None
    index = tuple(int(k) for k in np.unravel_index(int(np.argmax(differ)), differ.shape))
    a, b = (np.atleast_1d(array)[index].item() for array in (first, second))
    return FirstDifference(index, a, b, None, int(differ.sum()))


def _ulps32(x: float, y: float) -> int:
    def place(value: float) -> int:
        bits = int(np.float32(value).view(np.int32))
        return -(2**31) - bits if bits < 0 else bits

    return abs(place(x) - place(y))
