"""Steps and derivatives of an FMU, with rows that are independent of each other."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._settings import positive
from ._fmu_description import Description
from ._fmu_process import FmuProcess

Array = NDArray[np.float64]

# How rows become independent of each other, from the fastest to the safest.
WAYS = {"CoSimulation": ("state", "reset", "instance"), "ModelExchange": ("reset", "instance")}


class Simulation:
    """The steps and derivatives of an FMU, by requests to its process."""

    def __init__(self, described: Description, load: dict[str, Any], timeout: float) -> None:
        # The folder lives as long as the process.
        self.described, self.size, self.width = described, len(load["readers"]), len(load["action"])
        self.process = FmuProcess(described.name, load, positive("timeout", timeout))

    def step(self, states: Array, actions: Array, dt: float) -> Array:
        states, actions = _rows("states", states, self.size), _rows("actions", actions, self.width)
        if len(actions) != len(states):
            raise ValueError(f"actions has {len(actions)} rows; expected {len(states)}, as many as states")
        dt = positive("dt", dt)
        after = np.full(states.shape, np.nan)
        for row, (state, action) in enumerate(zip(states, actions)):
            if np.isfinite(state).all() and np.isfinite(action).all():
                after[row] = self.pair(state, action, dt)[1]
        return after

    def pair(self, state: Array | None, action: Array, dt: float) -> Array:
        """Return the states at both ends of a step, from the start values without a state; NaN if the FMU discards it."""
        found = self.process.request("step", None if state is None else state.tolist(), action.tolist(), dt)
        return np.full((2, self.size), np.nan) if found is None else np.array([found["before"], found["after"]], dtype=np.float64)

    def start(self) -> Array:
        """Return the start values of the states of a model exchange."""
        return np.array(self.process.request("point"), dtype=np.float64)

    def next_event(self) -> float | None:
        """Return the time of the next event of a model exchange at the start."""
        found: float | None = self.process.request("event")
        return found

    def rates(self, state: Array, action: Array) -> Array:
        return np.array(self.process.request("rates", state.tolist(), action.tolist()), dtype=np.float64)

    def columns(self, state: Array, action: Array) -> Array:
        """Return the directional derivatives: states and outputs × states and inputs."""
        found = self.process.request("columns", state.tolist(), action.tolist())
        return np.array(found, dtype=np.float64).reshape(self.size + self.width, -1).T


def independent(
    described: Description, load: dict[str, Any], action: Array, dt: float, timeout: float, names: tuple[str, ...], notes: list[str]
) -> tuple[Simulation, Array]:
    """Return the steps of an FMU by the fastest way that makes rows independent, and the states at both ends of the step at the point.

    Raises
    ------
    ValueError
        If a state does not keep the value that was set, or if no way makes rows independent.
    """
    ways, failures = WAYS[described.kind], []
    for way in ways:
        if way == "state" and not described.interface.canGetAndSetFMUstate:
            failures.append("the FMU cannot save its state")
            continue
        simulation = Simulation(described, {**load, "way": way}, timeout)
        fresh = simulation.pair(None, action, dt)
        if not np.isfinite(fresh).all():
            raise ValueError(f"{described.name} discards a step of {dt:g} s at the point, or returns values that are not finite")
        start = fresh[0]
        try:
            first = simulation.pair(start, action, dt)
            for j in range(len(start)):
                moved = start.copy()
                moved[j] += 1e-3 * max(1.0, abs(start[j]))
                _check_set(described.name, names, moved, simulation.pair(moved, action, dt)[0])
            again = simulation.pair(start, action, dt)
        except (RuntimeError, ValueError) as error:
            failures.append(str(error))
            simulation.process.close()
            if way == ways[-1]:
                raise
            continue
        if again.tobytes() == first.tobytes() and _near(first, fresh).all():
            if way != ways[0]:
                by = "resets the FMU" if way == "reset" else "makes a new instance of the FMU"
                notes.append(f"each row {by}: {failures[0]}")
            return simulation, fresh
        what = {"state": "restored state", "reset": "reset", "instance": "new instance"}[way]
        failures.append(f"a step after a {what} differs from the first one")
    raise ValueError(f"{described.name} has a memory that a new instance does not clear: {failures[-1]}")


def _near(found: Array, wanted: Array) -> NDArray[np.bool_]:
    """Whether values are equal. Initial equations may compute a state again, with rounding."""
    return np.asarray(np.abs(found - wanted) <= 1e-9 * np.maximum(1.0, np.abs(wanted)))


def _check_set(name: str, names: tuple[str, ...], wanted: Array, found: Array) -> None:
    off = ~_near(found, wanted)
    # A step that the FMU discards has NaN.
    if off.any() and np.isfinite(found).all():
        j = int(np.argmax(off))
        raise ValueError(
            f"{names[j]} of {name} is {found[j]:g} after the initialisation, but was set to {wanted[j]:g}: it is no free state; "
            "help: name other states"
        )


def _rows(name: str, value: Array, width: int) -> Array:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name} has shape {array.shape}; expected (rows, {width})")
    return array
