"""Polynomials of transfer functions."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from ._matrices import array
from ._settings import shown


def polynomials(name: str, value: Any) -> list[Any]:
    """Return a polynomial, or one for each output and input as nested lists.

    Raises
    ------
    TypeError, ValueError
        For another structure, or coefficients that are not finite real numbers.
    """
    depth = _depth(value)
    if depth == 1:
        return _polynomial(name, value)
    if depth != 3:
        raise TypeError(
            f"{name} is {shown(value)}; expected a polynomial, as [1, 2], or one for each output and input, as [[[1], [2, 1]]]"
        )
    return [
        [_polynomial(f"{name}[{j}][{i}]", one) for i, one in enumerate(_entries(f"{name}[{j}]", row))] for j, row in enumerate(value)
    ]


def of_object(system: Any) -> tuple[Any, Any] | None:
    """Return numerators and denominators of a ``control.TransferFunction`` or ``scipy.signal.TransferFunction``; None for others."""
    for names in (("num_list", "den_list"), ("num", "den")):
        if all(hasattr(system, name) for name in names):
            numerator, denominator = (getattr(system, name) for name in names)
            if _depth(numerator) == 2 and _depth(denominator) == 1:
                # SciPy has several outputs of one input, with a common denominator.
                return [[row] for row in numerator], [[denominator]] * len(numerator)
            return numerator, denominator
    return None


def _polynomial(name: str, value: Any) -> list[float]:
    if _depth(value) != 1:
        raise TypeError(f"{name} is {shown(value)}; expected the coefficients of a polynomial, as [1, 2]")
    return array(name, value).tolist()


def _entries(name: str, row: Any) -> Sequence[Any]:
    if not _is_several(row):
        raise TypeError(f"{name} is {shown(row)}; expected a polynomial for each input")
    return row


def _depth(value: Any) -> int:
    """Return how many lists stand in each other at the first entry."""
    depth = 0
    while _is_several(value):
        depth += 1
        if not len(value):
            break
        value = value[0]
    return depth


def _is_several(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim > 0
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes))
