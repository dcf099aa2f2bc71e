"""Derivatives of a step by complex numbers."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Its square is no part of any number, so that nothing cancels and the result has rounding errors only.
_PART = 1e-100


def complex_step(step: Callable[..., Any], state: Array, action: Array, dt: float, batched: bool) -> tuple[Array, Array]:
    """Return the derivatives of a step by the states, n × n, and by the actions, n × m.

    The imaginary part of ``f(x + i ε)`` over ε is the derivative of a function that is analytic and computes with complex numbers
    throughout (W. Squire and G. Trapp, SIAM Review 40, 1998).

    Raises
    ------
    TypeError, ValueError
        If the step returns real numbers, or numbers of another shape.
    """
    n = len(state)
    point = np.concatenate([state, action]).astype(np.complex128)
    columns = []
    for k in range(len(point)):
        moved = point.copy()
        moved[k] += 1j * _PART
        x, u = moved[:n], moved[n:]
        found = np.asarray(step(x[np.newaxis], u[np.newaxis], dt) if batched else step(x, u, dt))
        if found.dtype.kind != "c":
            raise TypeError(f"step returned {found.dtype} for complex numbers; expected complex numbers; help: leave complex_step out")
        if found.size != n:
            raise ValueError(f"step returned an array of shape {found.shape}; expected {n} numbers")
        columns.append(found.reshape(n).imag / _PART)
    derivatives = np.stack(columns, axis=1)
    return derivatives[:, :n], derivatives[:, n:]
