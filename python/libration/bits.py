"""The first bit in which two recordings differ."""

from __future__ import annotations

import zipfile
import zlib
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native

__all__ = ["FirstDifference", "first_difference"]


Numbers = np.ndarray[Any, np.dtype[Any]]

# What numpy raises for files that are no arrays.
_UNREADABLE = (OSError, EOFError, ValueError, zipfile.BadZipFile, zlib.error)


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
    """Numbers that differ in all, of files ``.npz`` in all arrays."""
    array: str | None = None
    """Of files ``.npz`` the name of the array with this number, else None."""


def first_difference(a: ArrayLike | PathLike[str], b: ArrayLike | PathLike[str]) -> FirstDifference | None:
    """Return where two recordings differ first, in the order of their axes; None if all bits agree.

    Parameters
    ----------
    a, b:
        Arrays of the same shape and type, such as steps × environments × components, or paths of files ``.npy``. Numbers of ``float32``
        and of integers are compared as they are; ``0.0`` and ``-0.0`` differ. Or paths of two files ``.npz``, whose arrays have the same
        names; they are compared in the order of the first file.

    Raises
    ------
    TypeError, ValueError
        If they are no numbers, or if their shapes, types or names of arrays differ, or if a file cannot be read.
    """
    first, second = _loaded("a", a), _loaded("b", b)
    if not isinstance(first, dict) and not isinstance(second, dict):
        return _of_arrays("a", first, "b", second)
    if not isinstance(first, dict) or not isinstance(second, dict):
        several, one = ("a", "b") if isinstance(first, dict) else ("b", "a")
        raise ValueError(f"{several} is a file .npz and {one} a single array; expected two files .npz, or one of the arrays of {several}")
    if set(first) != set(second):
        only = [f"only {name} has {', '.join(sorted(own - other))}" for name, own, other in _names(first, second) if own - other]
        raise ValueError(f"a and b have arrays of different names: {'; '.join(only)}; expected the same names")
    found = [(name, _of_arrays(f"a[{name!r}]", values, f"b[{name!r}]", second[name])) for name, values in first.items()]
    differences = [replace(difference, array=name) for name, difference in found if difference is not None]
    return replace(differences[0], differing=sum(d.differing for d in differences)) if differences else None


def _names(first: dict[str, Numbers], second: dict[str, Numbers]) -> tuple[tuple[str, set[str], set[str]], ...]:
    """Return the names of arrays in each file, and those in the other one."""
    return ("a", set(first), set(second)), ("b", set(second), set(first))


def _of_arrays(name: str, first: Numbers, other: str, second: Numbers) -> FirstDifference | None:
    if first.shape != second.shape or first.dtype != second.dtype:
        raise ValueError(
            f"{name} is {first.dtype} of shape {first.shape} and {other} {second.dtype} of shape {second.shape}; "
            "expected the same shape and type"
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


def _loaded(name: str, value: Any) -> Numbers | dict[str, Numbers]:
    """Return an array, or the arrays of a file ``.npz`` by name."""
    if not isinstance(value, (str, PathLike)):
        return _checked(name, np.asarray(value))
    try:
        with open(value, "rb") as stream:
            file = np.load(stream, allow_pickle=False)
            arrays = {key: file[key] for key in file.files} if isinstance(file, np.lib.npyio.NpzFile) else None
    except _UNREADABLE as error:
        raise ValueError(f"{name} cannot be read: {error}; expected a file .npy or .npz of numbers") from None
    if arrays is None:
        return _checked(name, file)
    return {key: _checked(f"{name}[{key!r}]", array) for key, array in arrays.items()}


def _checked(name: str, array: Numbers) -> Numbers:
    if array.dtype not in (np.float64, np.float32) and not np.issubdtype(array.dtype, np.integer) and array.dtype != np.bool_:
        raise TypeError(f"{name} has type {array.dtype}; expected float64, float32, integers or truth values")
    return array


def _of_integers(first: Numbers, second: Numbers) -> FirstDifference | None:
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
