"""Audits of the step of any simulator."""

from __future__ import annotations

import json
import shlex
from os import PathLike
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._descriptions import description_of
from ._keywords import check_keywords
from ._settings import positive
from .hosts.host import Host
from .probe_report import ProbeReport

__all__ = ["Probe", "probe"]

Array = NDArray[np.float64]


class Probe:
    """Audits of steps: ``libration.probe(step, state, action, dt)`` of a function, ``libration.probe.mujoco(model)`` of a MuJoCo model."""

    @check_keywords
    def __call__(
        self,
        step: Callable[..., Any],
        state: ArrayLike,
        action: ArrayLike = (),
        dt: float | None = None,
        *,
        batched: bool = False,
        observe: Callable[..., Any] | None = None,
        energy: Callable[..., Any] | None = None,
        states: Sequence[str] | None = None,
        inputs: Sequence[str] | None = None,
        state_scale: ArrayLike | None = None,
        action_scale: ArrayLike | None = None,
        mass: ArrayLike | None = None,
        pairs: Sequence[tuple[int, int]] | None = None,
        fixed_dt: bool = False,
        equilibrium: bool | None = None,
        conservative: bool = False,
        title: str | None = None,
        notes: Sequence[str] = (),
    ) -> ProbeReport:
        """Audit a step.

        Parameters
        ----------
        step:
            ``step(x, u, dt)`` returns the states ``dt`` seconds after ``x`` under a constant ``u``: n numbers for n and m numbers. With
            ``batched`` it takes and returns rows: environments × n and environments × m.
        state, action:
            The state and the action at which the step is linearised.
        dt:
            Length of a step in s.
        observe:
            ``observe(x)`` returns the observation of a state, to find stale ones. With ``batched`` of rows.
        energy:
            ``energy(x)`` returns the energy of a state, to find its drift. With ``batched`` of rows.
        states, inputs:
            Names with units in parentheses: ``"angle (rad)"``.
        state_scale, action_scale:
            Typical deviations (default: the larger of 1 and the absolute value).
        mass:
            Inertia of the velocities of ``pairs``, for the defect of symplecticity.
        pairs:
            Pairs of the numbers of a position and of its velocity (default: found in the rates).
        fixed_dt:
            Whether the simulator has this step only.
        equilibrium:
            Whether the state is an equilibrium; False: it is on a motion, and that is no finding.
        conservative:
            Whether the system conserves energy, so that a drift that does not depend on the step is a fault.
        title, notes:
            Name of the simulator and facts for the reader of the report.

        Raises
        ------
        TypeError, ValueError
            For an invalid value, or a step whose result has the wrong shape or is not finite. Exceptions of ``step`` are raised as they are.
        """
        if dt is None:
            raise TypeError("dt is missing; expected the length of a step in s")
        point, command = _vector("state", state), _vector("action", action)
        host = Host(
            step=_rows_of(step, len(point), batched),
            state=point,
            action=command,
            dt=positive("dt", dt),
            states=tuple(states) if states is not None else tuple(f"x{i + 1}" for i in range(len(point))),
            inputs=tuple(inputs) if inputs is not None else tuple(f"u{i + 1}" for i in range(len(command))),
            title=title or getattr(step, "__name__", type(step).__name__),
            integrator="",
            energy=None if energy is None else _energies_of(energy, batched),
            mass=None if mass is None else np.asarray(mass, dtype=np.float64),
            positions=tuple((int(i), int(j)) for i, j in pairs or ()),
            notes=tuple(notes),
        )
        described = description_of(host)
        described.update(fixed_dt=bool(fixed_dt), equilibrium=equilibrium, conservative=bool(conservative))
        del described["integrator"]
        for name, scale in (("state_scale", state_scale), ("action_scale", action_scale)):
            if scale is not None:
                described[name] = _vector(name, scale).tolist()
        watch = None if observe is None else _observations_of(observe, batched)
        return _audit(host, described, watch, batched)

    @check_keywords
    def mujoco(
        self,
        model: Any,
        data: Any = None,
        *,
        keyframe: str | int | None = None,
        state: str | None = None,
        dt: float | None = None,
        conservative: bool = False,
    ) -> ProbeReport:
        """Audit a MuJoCo model: an ``MjModel``, or the path of an XML or MJB file. Requires the package ``mujoco``.

        Parameters
        ----------
        data:
            An ``MjData`` with the state, the commands and the applied forces at which the step is linearised.
        keyframe:
            Name or number of a keyframe in its place.
        state:
            ``"given"``, ``"keyframe"``, ``"default"`` or ``"settled"``, see :func:`libration.hosts.mujoco_host`.
        dt:
            Timestep in s (default: that of the model).
        conservative:
            Whether the model conserves energy, so that a drift that does not depend on the timestep is a fault.
        """
        from .hosts import mujoco_host

        host = mujoco_host(model, data, keyframe=keyframe, state=state, dt=dt, memory=None)
        invocation = ""
        if isinstance(model, (str, PathLike)) and data is None and state in (None, "settled"):
            words = ["libration", "probe", "--mujoco", str(model)]
            words += [] if keyframe is None else ["--keyframe", str(keyframe)]
            words += [] if dt is None else ["--dt", repr(host.dt)]
            words += ["--settle"] * (state == "settled") + ["--conservative"] * bool(conservative)
            invocation = shlex.join(words)
        return self.host(host, conservative=conservative, invocation=invocation)

    @check_keywords
    def gymnasium(self, env: Any, action: Any = None, **keywords: Any) -> ProbeReport:
        """Audit an environment of Gymnasium with a state and a timestep as attributes, see :func:`libration.hosts.gymnasium_host`."""
        from .hosts import gymnasium_host

        return self.host(gymnasium_host(env, action, **keywords))

    @check_keywords
    def jax(self, step: Callable[..., Any], state: ArrayLike, action: ArrayLike = (), dt: float | None = None, **keywords: Any) -> ProbeReport:
        """Audit a function of JAX, whose Jacobian by JAX is compared, see :func:`libration.hosts.jax_host`. Requires ``jax``."""
        from .hosts import jax_host

        return self.host(jax_host(step, state, action, dt, **keywords))

    @check_keywords
    def fmu(self, path: str | PathLike[str], **keywords: Any) -> ProbeReport:
        """Audit an FMU of FMI 2 or 3 in a process of its own, see :func:`libration.hosts.fmu_host`. Requires ``fmpy``.

        The step of a co-simulation is its macro step: who exchanges values at its ends adds its length to the latency of a loop.
        """
        from .hosts import fmu_host

        return self.host(fmu_host(path, **keywords))

    @check_keywords
    def host(self, host: Host, *, conservative: bool = False, invocation: str = "") -> ProbeReport:
        """Audit a :class:`libration.hosts.Host`; ``invocation`` is the command that repeats the audit, for its page."""
        described = description_of(host)
        described.update(conservative=bool(conservative), invocation=str(invocation))
        # The rows of a host with memory continue one simulation each.
        return _audit(host, described, None, not host.memory)


probe = Probe()


def _audit(host: Host, described: dict[str, Any], observe: Callable[..., Any] | None, batched: bool) -> ProbeReport:
    energy = None if host.energy is None else _contiguous(host.energy, 1)
    text = json.dumps(described)
    answer, holds, page = _native._probe(text, _contiguous(host.step, 2), observe, energy, bool(batched))
    return ProbeReport(json.loads(answer), holds, page)


def _contiguous(function: Callable[..., Any], ndim: int) -> Callable[..., Array]:
    def called(*arguments: Any) -> Array:
        found = np.ascontiguousarray(function(*arguments), dtype=np.float64)
        if found.ndim != ndim:
            raise ValueError(f"the result has shape {found.shape}; expected {ndim} dimensions")
        return found

    return called


def _vector(name: str, value: ArrayLike) -> Array:
    try:
        found = np.atleast_1d(np.asarray(value, dtype=np.float64))
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {value!r}; expected numbers") from None
    if found.ndim != 1:
        raise ValueError(f"{name} has shape {found.shape}; expected one dimension")
    return found


def _rows_of(step: Callable[..., Any], n: int, batched: bool) -> Callable[[Array, Array, float], Array]:
    """Return the step on rows, with a message for results of another shape."""

    def result(value: Any, shape: tuple[int, ...]) -> Array:
        try:
            found = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            raise TypeError(f"step returned {type(value).__name__}; expected numbers of shape {shape}") from None
        if found.shape != shape:
            raise ValueError(f"step returned an array of shape {found.shape}; expected {shape}")
        return found

    def of_batch(states: Array, actions: Array, dt: float) -> Array:
        return result(step(states, actions, dt), states.shape)

    def of_each(states: Array, actions: Array, dt: float) -> Array:
        # Copies, so that a step may change its arguments.
        return np.stack([result(step(x.copy(), u.copy(), dt), (n,)) for x, u in zip(states, actions)])

    return of_batch if batched else of_each


def _energies_of(energy: Callable[..., Any], batched: bool) -> Callable[[Array], Array]:
    if batched:
        return lambda states: np.asarray(energy(states), dtype=np.float64).reshape(len(states))
    return lambda states: np.array([float(energy(x.copy())) for x in states])


def _observations_of(observe: Callable[..., Any], batched: bool) -> Callable[[Array], Array]:
    if batched:
        return _contiguous(observe, 2)
    return lambda states: np.stack([np.array(observe(x.copy()), dtype=np.float64).reshape(-1) for x in states])
