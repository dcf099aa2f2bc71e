"""Conversion of arguments to requests of the engine."""

from __future__ import annotations

from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._settings import count, number
from .perturbations import gains, law, numbers
from .perturbations import latency as _latency
from .equations import EquationSystem
from .systems import IMPLICIT_INTEGRATORS, INTEGRATORS, RUNGE_KUTTA_METHODS, SPLITTING_METHODS, CustomSystem, System, known


def integrator_name(integrator: Any) -> str:
    """Return the name of an integrator that exists."""
    text("integrator", integrator)
    known = [*INTEGRATORS, *IMPLICIT_INTEGRATORS, *SPLITTING_METHODS, *RUNGE_KUTTA_METHODS]
    if integrator not in known:
        near = f"did you mean {close[0]!r}? " if (close := get_close_matches(integrator, known, n=1)) else ""
        listed = ", ".join(known[: len(INTEGRATORS) + len(IMPLICIT_INTEGRATORS)])
        tables = "libration.SPLITTING_METHODS and libration.RUNGE_KUTTA_METHODS"
        raise ValueError(f"unknown integrator {integrator!r}: {near}known are {listed}, and those of {tables}")
    return str(integrator)


def system_request(system: Any, q: Any, v: Any) -> tuple[Any, list[float] | None, list[float] | None]:
    """Return a system of the catalogue or by equations and its start in the format of the engine."""
    system = known(system)
    if isinstance(system, CustomSystem):
        raise TypeError(f"system is {type(system).__name__}; expected a system of the catalogue or an EquationSystem")
    return description_of(system), coordinates("q", q), coordinates("v", v)


def description_of(system: System | EquationSystem) -> Any:
    """Return a system in the format of the engine."""
    return system._text if isinstance(system, EquationSystem) else system._request()


def loop_request(
    feedback: Any, latency: Any, jitter: Any, skew: Any, loss: Any = None, cost_weights: Any = None
) -> dict[str, Any]:
    """Return a loop and its imperfections in the format of the engine."""
    return {
        "feedback": gains("feedback", feedback),
        "latency": _latency(latency),
        "jitter": law("jitter", jitter),
        "skew": law("skew", skew),
        "loss": None if loss is None else number("loss", loss, "at least 0 and below 1"),
        "cost_weights": None if cost_weights is None else numbers("cost_weights", cost_weights, 3),
    }


def coordinates(name: str, value: ArrayLike | None) -> list[float] | None:
    if value is None:
        return None
    array = np.atleast_1d(np.asarray(value))
    if array.dtype.kind not in "fiu" or array.ndim != 1:
        raise TypeError(f"{name} must be a number or a list of numbers, not {value!r:.60}")
    with np.errstate(over="ignore"):
        array = array.astype(np.float64)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is {array.tolist()}, but it must be finite")
    return array.tolist()


def whole(name: str, value: Any, least: int = 1) -> int:
    return count(name, value, least, 2**63 - 1)


def text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a string, not {type(value).__name__}")
    return value


def rows(name: str, values: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {array.dtype}, but it must be real numbers")
    array = np.ascontiguousarray(array, np.float64)
    if array.ndim == 1:
        array = array[:, np.newaxis]
    if array.ndim != 2:
        raise ValueError(f"{name} has shape {array.shape}, but it must be (N, dimension) or (N,)")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is not finite everywhere")
    return array
