"""Gymnasium environments as steps of their internal state."""

from __future__ import annotations

import copy
import numbers
import warnings
from typing import Any, Sequence

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .._keywords import check_keywords
from .._settings import nearest, positive
from ._gymnasium_steps import ALIKE, IMPULSES, Responses, Steps
from ._gymnasium_wrappers import unwrapped_copy
from .host import Host
from .measured_delay import MeasuredDelay, StrayResults, measured_delay

Array = NDArray[np.float64]

# States, actions, pairs of a position and its rate, and angles that the environment wraps.
_KNOWN: dict[str, tuple[tuple[str, ...], str, tuple[tuple[int, int], ...], tuple[int, ...]]] = {
    "Pendulum": (("angle (rad)", "angle' (rad/s)"), "torque (N m)", ((0, 1),), ()),
    "CartPole": (("cart (m)", "cart' (m/s)", "pole (rad)", "pole' (rad/s)"), "force (N)", ((0, 1), (2, 3)), ()),
    "Acrobot": (
        ("shoulder (rad)", "elbow (rad)", "shoulder' (rad/s)", "elbow' (rad/s)"),
        "torque (N m)",
        ((0, 2), (1, 3)),
        (0, 1),
    ),
}
_TIMESTEPS = ("dt", "tau", "timestep", "time_step")


@check_keywords
def gymnasium_host(
    env: Any,
    action: Any = None,
    *,
    state: Any = None,
    dt: float | None = None,
    state_attribute: str = "state",
    dt_attribute: str | None = None,
    action_attribute: str | None = None,
    states: Sequence[str] | None = None,
    inputs: Sequence[str] | None = None,
) -> Host:
    """Return a Gymnasium environment as a step of its internal state.

    An environment that was never reset is reset first, and keeps its state. The state is that of the environment without wrappers, in the
    precision that it has inside, not its observation. Actions go through the wrappers, and observations are those that ``step``
    returns. Wrappers of rewards, records and time limits are left out; those whose observations are no function of a state, too, and the
    audit names these. Each call sets all plain attributes of the environment to what they were, unless they are a memory of earlier calls.
    The environment itself is never changed: the host has a copy.

    Parameters
    ----------
    env:
        An environment, or the id of one: ``"Pendulum-v1"``.
    action:
        The action at the point (default: zero, or the middle one of discrete actions). A discrete action is fixed: it has no
        derivative, and the host has no actions.
    state:
        The point (default: zero for Pendulum, CartPole and Acrobot; for others the current state, or that of ``reset(seed=0)``).
    dt:
        Timestep in s at which the step is described (default: that of the environment, as often as wrappers repeat it). It is required of an
        environment without an attribute of its timestep, which then has this timestep only.
    state_attribute, dt_attribute:
        Names of the attributes with the state and the timestep (default of the latter: ``dt``, ``tau``, ``timestep`` or
        ``time_step``).
    action_attribute:
        Name of an attribute that is the action, while the discrete action stays fixed: ``"force_mag"`` of CartPole.
    states, inputs:
        Names of states and actions, with units in parentheses.

    Raises
    ------
    TypeError, ValueError
        For an environment without these attributes, or a state or action of another size; the message names the attribute.
    """
    outer, wrappers, left_out = unwrapped_copy(env)
    inner = outer.unwrapped
    kind = next((name for name in _KNOWN if type(inner).__name__.startswith(name)), None)
    named, input_name, positions, angles = _KNOWN[kind] if kind else ((), "action (command)", (), ())
    _reset_once(outer, state_attribute)
    title = inner.spec.id if getattr(inner, "spec", None) is not None else type(inner).__name__
    clock = _clock(inner, dt_attribute, title, dt is not None)
    start = _start(inner, state, state_attribute, np.zeros(len(named)) if kind else None, title)
    notes: list[str] = []
    fixed, vector = _action(outer, action, action_attribute, notes)
    simulation = Steps(outer, state_attribute, clock, action_attribute, fixed, angles, bool(wrappers))
    timestep = positive("dt", getattr(inner, clock) if dt is None and clock is not None else dt)
    size, count = len(start), len(vector)
    labels = tuple(states) if states is not None else named or tuple(f"x{k + 1}" for k in range(size))
    of_inputs = tuple(inputs) if inputs is not None else (input_name,) if count == 1 else tuple(f"u{k + 1}" for k in range(count))
    for what, names, expected in (("states", labels, size), ("inputs", of_inputs[:count], count)):
        if len(names) != expected:
            raise ValueError(f"{what} has {len(names)} names; expected {expected}")
    try:
        after = simulation.step(start[np.newaxis], vector[np.newaxis], timestep)[0]
        repeated = simulation.count or 1
        if dt is None and repeated > 1:
            timestep *= repeated
            after = simulation.step(start[np.newaxis], vector[np.newaxis], timestep)[0]
        memory = _memory(simulation, start, vector, timestep, bool(wrappers))
    except Exception as error:
        raise ValueError(f"{title} fails in a step at the point: {type(error).__name__}: {error}") from error
    if wrappers:
        notes.append(f"actions and observations go through {', '.join(wrappers)}")
    if repeated > 1:
        notes.append(f"a step is {repeated} steps of the environment")
    simulation.settle()
    parts = _unexamined(simulation, wrappers, left_out)
    not_examined, late_inputs, old_observation, strays = _delays(simulation, start, vector, timestep, parts)
    if simulation.is_single:
        notes.append("the environment keeps its state in float32: differences have about three digits")
    if angles:
        notes.append(f"the environment wraps {', '.join(labels[k] for k in angles)}; the host removes the jumps by 2π")
    at_rest = bool(np.max(np.abs(after - start), initial=0.0) <= 1e-12 * max(1.0, float(np.max(np.abs(start), initial=0.0))))
    if not at_rest:
        notes.append("the point is no equilibrium: a step changes it")
    return Host(
        step=simulation.step,
        state=start,
        action=vector,
        dt=timestep,
        states=labels,
        inputs=of_inputs[:count],
        title=title,
        integrator=str(getattr(inner, "kinematics_integrator", "unknown")),
        version=f"Gymnasium {gymnasium.__version__}",
        positions=positions,
        equilibrium=at_rest,
        notes=tuple(notes),
        memory=memory,
        fixed_dt=clock is None,
        observe=simulation.observe if simulation.is_observed else None,
        not_examined=tuple(not_examined),
        direct_inputs=of_inputs[:count] if action_attribute is not None else (),
        measured_inputs=late_inputs,
        measured_observation=old_observation,
        stray_results=strays,
    )


def _memory(simulation: Steps, start: Array, vector: Array, dt: float, is_wrapped: bool) -> bool:
    """Return whether the rows of the host continue a simulation, after a choice of the attributes that live on."""
    moved = start + 0.01 * np.maximum(1.0, np.abs(start))
    other = vector + 0.01 * np.maximum(1.0, np.abs(vector))
    changes: list[tuple[Array, Array, Any]] = [(moved, other, simulation.fixed)]
    if simulation.fixed is not None:
        # An attribute of zero would hide them.
        vector = other
        changes += [(start, vector, one) for one in simulation.other_actions()[:1]]
    found = simulation.has_memory(start, vector, changes, dt)
    if found is False:
        # The memory may be in attributes, which were the same before each call.
        simulation.keeps_attributes = True
        if simulation.has_memory(start, vector, changes, dt) is True or simulation.remembers(start, vector, changes, dt):
            return True
        simulation.keeps_attributes = False
    return found is True or (found is None and is_wrapped)


def _reset_once(outer: Any, name: str) -> None:
    """Reset an environment that never was, with its state as it is: a queue of late actions may be filled by then only."""
    inner = outer.unwrapped
    if getattr(inner, "_np_random", None) is not None:
        return
    before = copy.deepcopy(getattr(inner, name, None))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        outer.reset(seed=0)
    if before is not None:
        setattr(inner, name, before)


def _unexamined(simulation: Steps, kept: Sequence[str], left_out: Sequence[str]) -> list[str]:
    """Return what an audit does not examine, apart from the lateness of actions."""
    names = ["rewards and ends of episodes", f"delays of fewer than one in {IMPULSES} steps", f"a memory that acts after more than {ALIKE} steps"]
    if left_out:
        what = "wrapper" if len(left_out) == 1 else "wrappers"
        names.insert(0, f"{len(left_out)} {what} ({', '.join(left_out)})")
    if "MaxAndSkipObservation" in kept:
        names.append("observations of MaxAndSkipObservation, which are of two states")
    if not simulation.is_observed:
        names.append("observations, which are no real numbers")
    if simulation.draws:
        names.append("random numbers of the environment, which are the same in each step")
    return names


_Delays = tuple[list[str], tuple[MeasuredDelay, ...], MeasuredDelay | None, StrayResults | None]


def _delays(simulation: Steps, start: Array, vector: Array, dt: float, names: list[str]) -> _Delays:
    """Return ``names`` and what else is not examined, the lateness of a discrete action, or of actions whose delay varies at random, the
    age of observations if it varies, and results that differ by themselves."""
    late: MeasuredDelay | None = None
    tried: list[Responses] = []
    if simulation.fixed is None:
        changed = vector + 0.01 * np.maximum(1.0, np.abs(vector))
        if (calls := simulation.responses(start, vector, (start, changed, None), dt)) is not None:
            tried.append(calls)
            late = measured_delay("action", calls.states)
        if late is not None and not late.varies:
            # The audit itself finds it.
            late = None
    else:
        vector = vector + np.maximum(1.0, np.abs(vector))
        for other in simulation.other_actions():
            if (calls := simulation.responses(start, vector, (start, vector, other), dt)) is not None:
                tried.append(calls)
                late = measured_delay("discrete action", calls.states)
            if late is not None:
                break
        else:
            names = [*names, "lateness of discrete actions"]
    moved = start + 0.01 * np.maximum(1.0, np.abs(start))
    age = None
    if (calls := simulation.responses(start, vector, (moved, vector, simulation.fixed), dt)) is not None:
        tried.append(calls)
        # A late state is one of the audit itself.
        if all(own == {0} for own in calls.states):
            age = measured_delay("observation", calls.observations)
    strays = sum(calls.strays for calls in tried)
    found = StrayResults(strays, sum(calls.calls for calls in tried)) if strays else None
    return names, () if late is None else (late,), age if age is not None and age.varies else None, found


def _clock(inner: Any, name: str | None, title: str, is_given: bool) -> str | None:
    """Return the name of the attribute with the timestep, a number that can be set; None if there is none, and the timestep is given."""
    for one in _TIMESTEPS if name is None else (name,):
        value = getattr(inner, one, None)
        if isinstance(value, numbers.Real) and not isinstance(value, bool):
            if isinstance(getattr(type(inner), one, None), property):
                raise ValueError(f"{one} of {title} is a property, which cannot be set; expected an attribute{_mujoco(inner)}")
            return one
    if name is not None:
        raise ValueError(f"{title} has no number {name!r}: {nearest(name, [k for k in vars(inner) if not k.startswith('_')])}")
    if is_given:
        return None
    wanted = ", ".join(_TIMESTEPS)
    raise ValueError(
        f"{title} has no timestep: it has no number {wanted}; help: name the attribute with dt_attribute, or give dt, "
        f"the only timestep that it has{_mujoco(inner)}"
    )


def _mujoco(inner: Any) -> str:
    return ", or use mujoco_host(env.unwrapped.model, env.unwrapped.data)" if hasattr(inner, "model") and hasattr(inner, "data") else ""


def _start(inner: Any, state: Any, name: str, default: Array | None, title: str) -> Array:
    """Return the point; the environment has a state afterwards."""
    if getattr(inner, name, None) is None:
        inner.reset(seed=0)
    current = getattr(inner, name, None)
    if current is None:
        known = [k for k in vars(inner) if not k.startswith("_")]
        raise ValueError(f"{title} has no state {name!r}: {nearest(name, known)}; help: name it with state_attribute{_mujoco(inner)}")
    try:
        found = np.array(current, dtype=np.float64)
        point = np.array((found if default is None else default) if state is None else state, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{name} of {title} is a {type(current).__name__}; expected a vector of numbers") from None
    if found.ndim != 1:
        raise ValueError(f"{name} of {title} has shape {found.shape}; expected a vector")
    if point.shape != found.shape:
        raise ValueError(f"state has shape {point.shape}; expected {found.shape}")
    if not np.isfinite(point).all():
        raise ValueError(f"state[{int(np.argmin(np.isfinite(point)))}] is not finite; expected finite numbers")
    return point


def _action(outer: Any, action: Any, attribute: str | None, notes: list[str]) -> tuple[Any, Array]:
    """Return the action that is fixed, if one is, and the vector of those that are not."""
    space, inner = outer.action_space, outer.unwrapped
    if isinstance(space, gymnasium.spaces.Discrete):
        first, size = int(space.start), int(space.n)
        fixed = first + size // 2 if action is None or attribute is not None else action
        if isinstance(fixed, bool) or not isinstance(fixed, numbers.Integral) or not space.contains(np.int64(fixed)):
            raise ValueError(f"action is {action!r}; expected an integer from {first} to {first + size - 1}")
        fixed = int(fixed)
        if attribute is None:
            notes.append(f"the discrete action {fixed} is fixed: it has no derivative")
            return fixed, np.zeros(0)
        if not isinstance(value := getattr(inner, attribute, None), numbers.Real):
            known = [k for k in vars(inner) if not k.startswith("_")]
            raise ValueError(f"action_attribute is {attribute!r}, which is no number of the environment: {nearest(attribute, known)}")
        notes.append(f"the action is the attribute {attribute}, with the discrete action {fixed}")
        return fixed, np.array([float(value) if action is None else float(action)])
    if attribute is not None:
        raise ValueError(f"action_attribute is {attribute!r}, but actions are not discrete")
    if not isinstance(space, gymnasium.spaces.Box):
        raise ValueError(f"actions are a {type(space).__name__}; expected a Box or Discrete space")
    vector = np.zeros(space.shape) if action is None else np.array(action, dtype=np.float64)
    if vector.ndim == 0:
        vector = vector[np.newaxis]
    if vector.shape != space.shape or vector.ndim != 1:
        raise ValueError(f"action has shape {vector.shape}; expected {space.shape}, a vector")
    limits = [k for k, (low, x, high) in enumerate(zip(space.low, vector, space.high)) if not low < x < high]
    if limits:
        notes.append(f"actions at a limit have no derivative: {', '.join(str(k) for k in limits)}")
    return None, vector
