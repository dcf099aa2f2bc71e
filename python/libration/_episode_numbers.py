"""Numbers of environments that differ between episodes or environments."""

from __future__ import annotations

import math
from typing import Any, Callable, Sequence

import numpy as np

from ._settings import is_several, number
from .perturbations import Gaussian, LogNormal, LogUniform, Uniform

Request = tuple[str, list[float]]
"""A kind of number and what it needs, in the format of the engine."""


def is_varied(value: Any) -> bool:
    """Whether a number differs between episodes or environments."""
    return isinstance(value, (Gaussian, LogNormal, LogUniform, Uniform)) or _has_values(value)


def episode_number(name: str, value: Any, num_envs: int, allowed: str = "finite", holds: Any = math.isfinite) -> Request:
    """Return a constant, a distribution, or a number for each environment in the format of the engine.

    Raises
    ------
    TypeError, ValueError
        With the name of the number, its value and what is allowed.
    """
    if isinstance(value, Uniform):
        if value.ends is None:
            raise ValueError(f"{name} is {value!r}, but it must have two ends: Uniform(low, high)")
        return "uniform", [number(f"an end of {name}", x, allowed, holds) for x in value.ends]
    if isinstance(value, LogUniform):
        return "log-uniform", [number(f"an end of {name}", x, allowed, holds) for x in (value.low, value.high)]
    if isinstance(value, LogNormal):
        return "lognormal", [number(f"{key} of {name}", x, "finite", math.isfinite) for key, x in (("mean", value.mean), ("std", value.std))]
    if isinstance(value, Gaussian):
        if not holds(-1.0):
            raise ValueError(f"{name} is {value!r}, but it must be {allowed}: Uniform(low, high) or LogUniform(low, high)")
        return "gaussian", [float(value.mean), float(value.std)]
    if _has_values(value):
        values = value.tolist() if hasattr(value, "tolist") else list(value)
        # Elsewhere a pair is a range.
        is_pair = isinstance(value, tuple) and len(values) == 2
        if is_pair or len(values) != num_envs or (getattr(value, "ndim", 1) != 1):
            shape = getattr(value, "shape", (len(values),))
            help = f"; help: Uniform({values[0]!r}, {values[1]!r})" if is_pair else ""
            raise ValueError(f"{name} has shape {shape}, but it must have a number for each environment: ({num_envs},){help}")
        return "each", [number(f"{name}[{n}]", x, allowed, holds) for n, x in enumerate(values)]
    return "constant", [number(name, value, allowed, holds)]


def check_float_type(name: str, request: Request, dtype: str, allowed: str = "finite", holds: Callable[[Any], Any] = np.isfinite) -> None:
    """Raise a ValueError for a number that its rounding to the float type does not allow."""
    kind, values = request
    if dtype not in ("float32", "float64"):
        return
    if kind == "log-uniform":
        allowed, holds = "finite and greater than 0", lambda x: 0 < x < math.inf
    with np.errstate(over="ignore", under="ignore"):
        rounded = np.array(values).astype(dtype)
    for value, own in zip(values, rounded):
        if not holds(own):
            raise ValueError(f"{name} is {value!r}, but it must be {allowed} in {dtype}")


def largest_commands(value: Any, inputs: int, num_envs: int) -> list[Request]:
    """Return the largest command of each input: one for all, one for each, or an array ``(num_envs, inputs)``, of one input ``(num_envs,)`` or a list."""
    value = math.inf if value is None else value
    if getattr(value, "ndim", 1) == 2:
        if value.shape != (num_envs, inputs):
            raise ValueError(f"max_action has shape {value.shape}, but it must be ({num_envs}, {inputs})")
        columns: Sequence[Any] = list(value.T)
    elif inputs == 1 and (getattr(value, "shape", None) == (num_envs,) or (isinstance(value, list) and len(value) == num_envs > 1)):
        columns = [value]
    else:
        columns = each("max_action", value, inputs)
    return [episode_number("max_action", x, num_envs, "greater than 0", lambda x: x > 0) for x in columns]


def largest_command_names(saturation: Any, actions: Sequence[str]) -> list[str]:
    """Return the names of largest commands in ``parameters``, from the settings of the engine; none if all are constants."""
    if isinstance(saturation, float) or all(kind == "constant" for kind, _ in saturation):
        return []
    return ["max_action"] if len(actions) == 1 else [f"max_action_{name}" for name in actions]


def largest(saturation: Any) -> list[float]:
    """Return the largest command of each input in any episode, from the settings of the engine."""
    return [saturation] if isinstance(saturation, float) else [max(values) for _, values in saturation]


def each(name: str, value: Any, length: int) -> Sequence[Any]:
    """Return a value for each of ``length``."""
    if getattr(value, "shape", ()) != ():
        value = value.tolist()
    if not is_several(value):
        return [value] * length
    if len(value) != length:
        raise ValueError(f"{name} has {len(value)} numbers, but it must have one or {length}")
    return value


def scaled_law(name: str, value: Any) -> tuple[Any, list[float]]:
    """Return a law of errors, and the range of the factor of its standard deviation that each episode draws."""
    kind, std = ("gaussian", value) if isinstance(value, Uniform) else (None, value)
    if is_several(value) and len(value) == 2 and isinstance(value[0], str) and isinstance(value[1], Uniform):
        kind, std = value
    if kind is None or std.ends is None:
        return value, [1.0, 1.0]
    low, high = (number(name, x, "finite and at least 0", lambda x: 0 <= x < math.inf) for x in std.ends)
    return (kind, high), [low / high if high > 0 else 1.0, 1.0]


def _has_values(value: Any) -> bool:
    return is_several(value) or (getattr(value, "shape", ()) != () and hasattr(value, "tolist"))
