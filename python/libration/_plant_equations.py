"""Linear plants as systems by equations."""

from __future__ import annotations

import re
from typing import Any, Iterable

import numpy as np
from numpy.typing import NDArray

from ._matrices import columns, matrix
from .linear import LinearPlant


def keywords_of_plant(plant: LinearPlant) -> dict[str, Any]:
    """Return the keywords of a system with the equations of a plant; see :meth:`libration.EquationSystem.from_plant`."""
    if plant.dt is not None:
        raise ValueError(f"dt of the plant is {plant.dt!r}, but it must be None: equations are those of continuous time; help: LinearVectorEnv")
    if plant.parts:
        raise ValueError(f"the plant has {len(plant.parts)} parts, but it must have none: their delays have no equations; help: LinearVectorEnv")
    a, b = np.array(matrix("A", plant.A)), np.array(columns("B", plant.B))
    if a.shape[0] != a.shape[1] or b.shape[0] != a.shape[0]:
        raise ValueError(f"A has shape {a.shape} and B {b.shape}, but they must be (n, n) and (n, m)")
    states, units = _named("states", plant.states, "x", len(a))
    inputs, units_of_inputs = _named("inputs", plant.inputs, "u", b.shape[1])
    rows = [_sum(row, [*states, *inputs]) for row in np.hstack([a, b])]
    # Coordinates: states whose derivative is the state with their name and a stroke.
    rates = {state: states.index(f"{state}'") for state in states if f"{state}'" in states}
    for state in rates:
        if rows[states.index(state)] != f"{state}'":
            raise ValueError(f"the derivative of {state!r} is {rows[states.index(state)]}, but it must be {state + chr(39)!r}: rename one of them")
    strokes = {f"{state}'" for state in rates}
    for key, all_names in (("states", [s for s in states if s not in strokes]), ("inputs", inputs)):
        for each in all_names:
            if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", each):
                raise ValueError(f"{key} has {each!r}, but in equations a name must have letters, digits and _ only, or the stroke of a velocity")
    return {
        "acceleration": {state: rows[place] for state, place in rates.items()} or None,
        "rate": {state: row for state, row in zip(states, rows) if state not in rates and state not in strokes} or None,
        "inputs": inputs,
        "units": {key: unit for key, unit in {**units, **units_of_inputs}.items() if unit and key not in strokes} or None,
    }


def _named(key: str, names: Iterable[str] | None, letter: str, count: int) -> tuple[list[str], dict[str, str]]:
    """Return names without their units, and units by name."""
    pairs = [str(name).partition(" (") for name in ([f"{letter}{i + 1}" for i in range(count)] if names is None else names)]
    if len(pairs) != count:
        raise ValueError(f"{key} has {len(pairs)} names, but it must have {count}")
    found = [name for name, _, _ in pairs]
    for i, name in enumerate(found):
        if name in found[:i]:
            raise ValueError(f"{key} has {name!r} twice, but it must have names that differ")
    return found, {name: unit.removesuffix(")") for name, _, unit in pairs}


def _sum(factors: NDArray[Any], names: list[str]) -> str:
    """Return an expression of the sum of products; a factor of 1 is left out."""
    terms = [name if x == 1 else f"{float(x)!r}*{name}" for x, name in zip(factors.tolist(), names) if x != 0]
    return " + ".join(terms) or "0"
