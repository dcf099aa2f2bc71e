"""Functional Mock-up Units of FMI 2 and 3 as steps, in a process of their own."""

from __future__ import annotations

import os
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .._derivatives import extrapolated_jacobian
from .._keywords import check_keywords
from .._settings import nearest, positive
from ._fmu_description import describe, labels, load_of
from ._fmu_simulation import Simulation, independent
from .host import Host

Array = NDArray[np.float64]
Names = dict[str, tuple[str, ...]]

_DERIVATIVES = ("directional", "differences")
# Part of the largest entry of a row by which directional derivatives may differ from differences, as in the audit of a step. Those of
# an FMU may be differences themselves.
_DIFFERENCE = 1e-4


@check_keywords
def fmu_host(
    path: str | os.PathLike[str],
    *,
    dt: float | None = None,
    inputs: Sequence[str] | None = None,
    states: Sequence[str] | Mapping[str, str] | None = None,
    start_values: Mapping[str, Any] | None = None,
    kind: str | None = None,
    timeout: float = 60.0,
) -> Host:
    """Return an FMU as a host. It runs in a child process, so that its crash is an error of this one.

    A row of a co-simulation FMU begins in the initialisation mode, the only one in which FMI lets states be set. The FMU returns there
    by a saved state, a reset or a new instance. What is no state begins each step at its start value.

    A model exchange FMU has no step: the step is that of forward Euler, and :func:`fmu_plant` has the derivatives. Its directional
    derivatives are the reference of the matrices of the step. A note has the entry in which they differ most from differences of the
    derivatives of states, which for a short step is too small an effect on the step to be a finding.

    Parameters
    ----------
    path:
        The path of an FMU, or of the folder with its files.
    dt:
        Macro step in s (default: the fixed step of the FMU, or that of its default experiment).
    inputs:
        Names of the inputs that are actions (default: continuous scalars). They are constant in a step.
    states:
        Names of the states of a co-simulation; or for each state the variable that sets it: ``{"x": "x_start"}`` (default: the continuous
        states of the model structure).
    start_values:
        Values of variables at the point, by name.
    kind:
        ``"CoSimulation"`` or ``"ModelExchange"`` (default: the first one that the FMU has).
    timeout:
        Longest time in s of a step, after which the process of the FMU is ended. Loading has at least 60 s.

    Raises
    ------
    TypeError, ValueError
        For a file that is no FMU, an unknown variable, or a state that cannot be set.
    RuntimeError, TimeoutError
        If the FMU reports an error, ends its process or does not answer; the next call starts it anew. A step that the FMU discards
        returns NaN.
    """
    described = describe(path, kind)
    timestep = positive("dt", described.macro_step() if dt is None else dt)
    values = _values(start_values)
    chosen, fixed = described.inputs(inputs)
    exchange = described.kind == "ModelExchange"
    if exchange and states is not None:
        raise ValueError("states is given, but a model exchange FMU has its own states; expected kind='CoSimulation'")
    readers, setters = (described.continuous_states(),) * 2 if exchange else described.settable_states(states)
    load = load_of(described, values, chosen, readers, setters, [])
    action = np.array(load["action"], dtype=np.float64)
    notes: list[str] = []
    simulation, (start, after) = independent(described, load, action, timestep, timeout, labels(readers), notes)
    if exchange:
        notes.append("a model exchange FMU has no step of its own: the step is that of forward Euler")
        event = simulation.next_event()
        if event is not None and event <= load["time"] + timestep:
            notes.append(f"the FMU has a time event at {event:g} s, which the step leaves out")
    else:
        notes.append(
            f"the macro step of {timestep:g} s is a latency: values that are exchanged at its ends are up to {timestep:g} s old in between"
        )
        hidden = [v.name for v in described.continuous_states() if v not in readers]
        what = f"the continuous states {', '.join(hidden)}" if hidden else "what is no state"
        notes.append(f"each step begins at {load['time']:g} s, with {what} at the start")
        if described.inner_step is not None:
            parts = timestep / described.inner_step
            whole = abs(parts - round(parts)) <= 1e-9 * max(1.0, parts)
            fits = f"{round(parts)} of them in a macro step" if whole and parts > 0.5 else "the macro step is no multiple of it"
            notes.append(f"the FMU states inner steps of {described.inner_step:g} s: {fits}")
        if not described.interface.canHandleVariableCommunicationStepSize:
            notes.append("the FMU declares a constant macro step: other timesteps may fail")
    if fixed:
        notes.append(f"inputs stay at their start values: {', '.join(fixed)}")
    rest = bool(np.max(np.abs(after - start), initial=0.0) <= 1e-12 * max(1.0, float(np.max(np.abs(start), initial=0.0))))
    if not rest:
        notes.append("the point is no equilibrium: a step changes it")
    a: Array | None = None
    b: Array | None = None
    if exchange and described.has_directional:
        columns = simulation.columns(start, action)
        wrong = _disagreement(simulation, described.directional, columns, start, action, (labels(readers), labels(chosen)))
        notes += [] if wrong is None else [wrong]
        a, b = np.eye(len(start)) + timestep * columns[:, : len(start)], timestep * columns[:, len(start) :]
    return Host(
        step=simulation.step,
        state=start,
        action=action,
        dt=timestep,
        states=labels(readers),
        inputs=labels(chosen),
        title=str(described.model.modelName),
        integrator="Euler" if exchange else "unknown",
        version=str(described.model.generationTool or ""),
        equilibrium=rest,
        notes=tuple(notes),
        reference_A=a,
        reference_B=b,
        reference_source="" if a is None else described.directional,
        exchange_latency=0.0 if exchange else timestep,
    )


@check_keywords
def fmu_plant(
    path: str | os.PathLike[str],
    *,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    start_values: Mapping[str, Any] | None = None,
    derivatives: str | None = None,
    timeout: float = 60.0,
) -> tuple[Array, Array, Array, Array, Names]:
    """Return the matrices ``A``, ``B``, ``C`` and ``D`` of a model exchange FMU at its start values, and names.

    ``LinearPlant(A, B, C, D, **names)`` is the plant. Its variables are deviations from the start values.

    Parameters
    ----------
    path, inputs, start_values, timeout:
        As in :func:`fmu_host`.
    outputs:
        Names of the outputs (default: continuous scalars of the model structure).
    derivatives:
        ``"directional"`` or ``"differences"`` (default: directional derivatives if the FMU provides them, after a comparison with
        differences).

    Raises
    ------
    TypeError, ValueError, RuntimeError, TimeoutError
        As :func:`fmu_host`; ``ValueError`` also where differences find no derivative, or by default where directional derivatives differ
        from differences by more than 1e-4 of the largest entry of a row and the estimated error.
    """
    if derivatives is not None and derivatives not in _DERIVATIVES:
        raise ValueError(f"derivatives is {derivatives!r}: {nearest(str(derivatives), _DERIVATIVES)}")
    described = describe(path, "ModelExchange")
    if derivatives == "directional" and not described.has_directional:
        raise ValueError(f"derivatives is 'directional', but {described.name} provides none; expected 'differences'")
    chosen, _ = described.inputs(inputs)
    measured = described.outputs(outputs)
    readers = described.continuous_states()
    load = load_of(described, _values(start_values), chosen, readers, readers, measured)
    simulation = Simulation(described, {**load, "way": "reset"}, timeout)
    n, point = len(readers), np.concatenate([simulation.start(), load["action"]])
    if derivatives == "differences" or not described.has_directional:
        full, error = extrapolated_jacobian(lambda z: simulation.rates(z[:n], z[n:]), point, np.maximum(np.abs(point), 1.0))
        if not (error <= 1e-2 * np.maximum(1.0, np.max(np.abs(full), axis=1, keepdims=True))).all():
            row = int(np.argmax(np.max(error, axis=1)))
            name = (labels(readers) + labels(measured))[row]
            raise ValueError(f"{described.name} has no derivative at the point: differences of {name} do not agree")
    else:
        full = simulation.columns(point[:n], point[n:])
        rows, columns = labels(readers) + labels(measured), (labels(readers), labels(chosen))
        wrong = None
        if derivatives is None:
            wrong = _disagreement(simulation, described.directional, full, point[:n], point[n:], columns, rows)
        if wrong is not None:
            raise ValueError(f"{wrong}; expected the same; help: derivatives='differences', or 'directional' without this check")
    names = {"states": labels(readers), "inputs": labels(chosen), "outputs": labels(measured)}
    return full[:n, :n], full[:n, n:], full[n:, :n], full[n:, n:], names


def _disagreement(
    simulation: Simulation,
    source: str,
    found: Array,
    state: Array,
    action: Array,
    variables: tuple[tuple[str, ...], tuple[str, ...]],
    rows: tuple[str, ...] | None = None,
) -> str | None:
    """Return the entry in which directional derivatives, rows × states and actions, differ most from differences; None if they agree.

    Where the FMU has no rates at displaced points there is no comparison.
    """
    n, point = len(state), np.concatenate([state, action])
    try:
        full, error = extrapolated_jacobian(lambda z: simulation.rates(z[:n], z[n:]), point, np.maximum(np.abs(point), 1.0))
    except (RuntimeError, TimeoutError):
        return None
    # A column of NaN is one without differences; its error is infinite.
    full = np.where(np.isnan(full), found, full)
    size = np.maximum(np.max(np.abs(found), axis=1, keepdims=True), np.max(np.abs(full), axis=1, keepdims=True))
    apart = np.abs(found - full) / (_DIFFERENCE * size + error + np.finfo(np.float64).tiny)
    if not (apart > 1).any():
        return None
    i, j = np.unravel_index(int(np.argmax(apart)), apart.shape)
    names = variables[0] if rows is None else rows
    row = f"the derivative of {names[i]}" if i < n else names[i]
    return f"{source} is {found[i, j]:.6g} of {row} by {(variables[0] + variables[1])[j]}, but differences are {full[i, j]:.6g}"


def _values(start_values: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return start values as numbers, strings and lists."""
    if start_values is None:
        return {}
    if not isinstance(start_values, Mapping):
        raise TypeError(f"start_values is a {type(start_values).__name__}; expected a dict of names and values")
    return {str(name): value.tolist() if hasattr(value, "tolist") else value for name, value in start_values.items()}
