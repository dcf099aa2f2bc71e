"""Starts of episodes of Gymnasium's classic control, from options of its ``reset``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._classic_systems import ClassicSystem, system_of
from ._settings import number


def start_bounds(classic: ClassicSystem, options: dict[str, Any], dtype: str) -> dict[str, Any]:
    """Take the ends of starts out of options of Gymnasium, and return the keywords of :func:`drawn_start`.

    Raises
    ------
    TypeError, ValueError
        For ends that are no range of numbers that are finite in the float type of the states.
    """
    names = ("x_init", "y_init") if classic.name == "Pendulum" else ("low", "high")
    given = {name: number(f"options[{name!r}]", options.pop(name), "finite") for name in names if name in options}
    if classic.rounds_start or dtype == "float32":
        with np.errstate(over="ignore"):
            for name, value in given.items():
                number(f"options[{name!r}]", value, "finite in float32", lambda x: bool(np.isfinite(np.float32(x))))
    if given and "state" in options:
        raise ValueError(f"options has 'state' and {next(iter(given))!r}, but it must have one of them")
    most = float(np.finfo(dtype).max)
    if classic.name == "Pendulum":
        for name, value in given.items():
            if value < 0:
                raise ValueError(f"options[{name!r}] is {value}, but it must be at least 0")
            if value > most / 2:
                raise ValueError(f"options[{name!r}] is {value}, but it must be at most {most / 2:.3g}: twice of it must be finite in {dtype}")
    elif given:
        low, high = given.get("low", classic.start[0]), given.get("high", classic.start[1])
        if low > high:
            raise ValueError(f"options has low = {low} and high = {high}, but low must be at most high")
        if high - low > most:
            raise ValueError(f"options has low = {low} and high = {high}, but high - low must be finite in {dtype}")
    return given


def start_ranges(classic: ClassicSystem, options: dict[str, Any], dtype: str) -> dict[str, Any]:
    """Return options of the engine for those of Gymnasium, whose numbers are for the states that it draws."""
    options = dict(options)
    if classic.name != "Pendulum" and any(np.ndim(options.get(name, 0.0)) != 0 or isinstance(options.get(name), Mapping) for name in ("low", "high")):
        return options
    given = start_bounds(classic, options, dtype)
    if not given:
        return options
    if "low" in options or "high" in options:
        raise ValueError(f"options has {next(iter(given))!r} and ends of ranges, but it must have one of them")
    states = system_of(classic.name).states
    if classic.name == "Pendulum":
        high = {"theta": given.get("x_init", np.pi), "theta'": given.get("y_init", 1.0)}
        low = {name: -value for name, value in high.items()}
    else:
        ends = (given.get("low", classic.start[0]), given.get("high", classic.start[1]))
        low, high = ({name: end if name in classic.drawn else 0.0 for name in states} for end in ends)
    return {**options, "low": low, "high": high}


def drawn_start(classic: ClassicSystem, generator: np.random.Generator, given: dict[str, Any]) -> NDArray[np.float64]:
    """Return the state from which Gymnasium's environment starts, in the order of the system's states."""
    states = dict.fromkeys(system_of(classic.name).states, 0.0)
    if classic.name == "Pendulum":
        high = np.array([given.get("x_init", np.pi), given.get("y_init", 1.0)])
        drawn = generator.uniform(low=-high, high=high)
    else:
        low, high = given.get("low", classic.start[0]), given.get("high", classic.start[1])
        drawn = generator.uniform(low=low, high=high, size=(len(classic.drawn),))
    if classic.rounds_start:
        drawn = drawn.astype(np.float32)
    states.update(zip(classic.drawn, drawn.astype(np.float64)))
    return np.array(list(states.values()))
