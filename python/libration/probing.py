"""Audits of the step of any simulator."""

from __future__ import annotations

import json
import math
import shlex
from os import PathLike
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._complex_step import complex_step as derivatives_of
from ._descriptions import described_recordings, description_of
from ._invocation import python_call
from ._keywords import check_keywords
from ._settings import number, positive
from ._step_functions import callable_of, check_energy, contiguous, energies_of, inertia, names, observations_of, pair_numbers, rows_of_step, vector
from ._thread_recordings import thread_count, thread_recording
from .hosts.host import Host
from .probe_report import ProbeReport

__all__ = ["Probe", "probe"]


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
        restart: Callable[[], Any] | None = None,
        threads: int | None = None,
        states: Sequence[str] | None = None,
        inputs: Sequence[str] | None = None,
        state_scale: ArrayLike | None = None,
        action_scale: ArrayLike | None = None,
        mass: ArrayLike | None = None,
        pairs: Sequence[tuple[int, int]] | None = None,
        complex_step: bool = False,
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
            ``observe(x)`` returns the observation of a state, to find stale ones: at least one number, always as many, and finite. With
            ``batched`` of rows.
        energy:
            ``energy(x)`` returns the energy of a state, to find its drift. At ``state`` it is finite. With ``batched`` of rows.
        restart:
            ``restart()`` starts the simulator anew, generators of random numbers with their seeds, to see whether the same bits follow and
            whether environments share a generator.
        threads:
            Number of threads, 2 to 64, that call the step at once, to see whether they get the bits of one thread (default: none). For a
            step without memory of earlier calls that may be called from several threads.
        states, inputs:
            Names with units in parentheses: ``"angle (rad)"``.
        state_scale, action_scale:
            Typical deviations, numbers or vectors (default: the larger of 1 and the absolute value).
        mass:
            Inertia of the velocities of ``pairs``, symmetric and positive definite, or its diagonal, for the defect of symplecticity.
        pairs:
            Pairs of the numbers of a position and of its velocity (default: found in the rates).
        complex_step:
            Whether the step also computes with complex numbers, whose imaginary parts then are its derivatives with rounding errors
            only. Differences of the step confirm them; if these differ, that is a finding.
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
            For an invalid value, or a function whose result has the wrong shape or is not finite. Exceptions of ``step`` are raised as they are.
        """
        arguments = {name: value for name, value in locals().items() if name != "self"}
        if dt is None:
            raise TypeError("dt is missing; expected the length of a step in s")
        for name, function in (("step", step), ("observe", observe), ("energy", energy), ("restart", restart)):
            if function is not None or name == "step":
                callable_of(name, function)
        if equilibrium not in (None, True, False):
            raise TypeError(f"equilibrium is {equilibrium!r}; expected True, False or None")
        if mass is not None and pairs is None:
            raise ValueError("mass requires pairs: the inertia is that of their velocities")
        number_of_threads = thread_count(threads)
        point, command = vector("state", state), vector("action", action)
        n, m = len(point), len(command)
        timestep = positive("dt", dt)
        a, b = derivatives_of(step, point, command, timestep, batched) if complex_step else (None, None)
        host = Host(
            step=rows_of_step(step, n, batched),
            state=point,
            action=command,
            dt=timestep,
            reference_A=a,
            reference_B=b,
            reference_source="complex steps" if complex_step else "",
            reference_is_exact=bool(complex_step),
            states=tuple(f"x{i + 1}" for i in range(n)) if states is None else tuple(names("states", states)),
            inputs=tuple(f"u{i + 1}" for i in range(m)) if inputs is None else tuple(names("inputs", inputs)),
            title=str(title or getattr(step, "__name__", type(step).__name__)),
            integrator="",
            energy=None if energy is None else energies_of(energy, batched),
            positions=() if pairs is None else pair_numbers(pairs, n),
            notes=tuple(names("notes", notes)),
        )
        described = description_of(host)
        described.update(
            fixed_dt=bool(fixed_dt),
            equilibrium=None if equilibrium is None else bool(equilibrium),
            conservative=bool(conservative),
            invocation=python_call("libration.probe", [Probe.__call__], arguments, _POINT),
        )
        del described["integrator"]
        if mass is not None:
            described["mass"] = inertia(mass, len(host.positions))
        for name, scale, count in (("state_scale", state_scale, n), ("action_scale", action_scale, m)):
            if scale is not None:
                described[name] = vector(name, np.broadcast_to(scale, count) if np.ndim(scale) == 0 else scale).tolist()
        watch = None if observe is None else observations_of(observe, batched)
        return _audit(host, described, watch, restart, batched, number_of_threads)

    @check_keywords
    def mujoco(
        self,
        model: Any,
        data: Any = None,
        *,
        keyframe: str | int | None = None,
        state: str | None = None,
        dt: float | None = None,
        state_scale: ArrayLike | None = None,
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
        state_scale:
            Typical deviations of the states, or one number for all (default: the larger of 1 and the absolute state).
        conservative:
            Whether the model conserves energy, so that a drift that does not depend on the timestep is a fault.
        """
        from .hosts import mujoco_host

        host = mujoco_host(model, data, keyframe=keyframe, state=state, dt=dt, memory=None)
        keywords = {"keyframe": keyframe, "state": state, "dt": dt, "state_scale": state_scale, "conservative": conservative}
        invocation = python_call("libration.probe.mujoco", [Probe.mujoco], {"model": model, "data": data, **keywords}, ("model", "data"))
        if isinstance(model, (str, PathLike)) and data is None and state_scale is None and state in (None, "settled"):
            words = ["libration", "probe", "--mujoco", str(model)]
            words += [] if keyframe is None else ["--keyframe", str(keyframe)]
            words += [] if dt is None else ["--dt", repr(host.dt)]
            words += ["--settle"] * (state == "settled") + ["--conservative"] * bool(conservative)
            invocation = shlex.join(words)
        return self.host(host, state_scale=state_scale, conservative=conservative, invocation=invocation)

    def gymnasium(self, env: Any, action: Any = None, *, conservative: bool = False, **keywords: Any) -> ProbeReport:
        """Audit an environment of Gymnasium with a state and a timestep as attributes, see :func:`libration.hosts.gymnasium_host`."""
        from .hosts import gymnasium_host

        host = gymnasium_host(env, action, **keywords)
        keywords["conservative"] = conservative
        functions: list[Callable[..., Any]] = [Probe.gymnasium, gymnasium_host]
        invocation = python_call("libration.probe.gymnasium", functions, {"env": env, "action": action, **keywords}, ("env", "action"))
        return self.host(host, conservative=conservative, invocation=invocation)

    def jax(
        self,
        step: Callable[..., Any],
        state: ArrayLike,
        action: ArrayLike = (),
        dt: float | None = None,
        *,
        conservative: bool = False,
        threads: int | None = None,
        **keywords: Any,
    ) -> ProbeReport:
        """Audit a function of JAX, see :func:`libration.hosts.jax_host`. Requires ``jax``.

        Its Jacobian is the matrix of the step if differences of the step agree with it.

        ``threads`` as in :func:`libration.probe`.
        """
        from .hosts import jax_host

        host = jax_host(step, state, action, dt, **keywords)
        arguments = {"step": step, "state": state, "action": action, "dt": dt, **keywords, "conservative": conservative, "threads": threads}
        invocation = python_call("libration.probe.jax", [Probe.jax, jax_host], arguments, _POINT)
        return self.host(host, conservative=conservative, invocation=invocation, threads=threads)

    def fmu(self, path: str | PathLike[str], *, conservative: bool = False, **keywords: Any) -> ProbeReport:
        """Audit an FMU of FMI 2 or 3 in a process of its own, see :func:`libration.hosts.fmu_host`. Requires ``fmpy``.

        The step of a co-simulation is its macro step. Values that are exchanged at its ends are up to a macro step old: this is
        :attr:`ProbeReport.exchange_latency`, which :meth:`ProbeReport.advise` adds to the latency of a loop.
        """
        from .hosts import fmu_host

        host = fmu_host(path, **keywords)
        keywords["conservative"] = conservative
        invocation = python_call("libration.probe.fmu", [Probe.fmu, fmu_host], {"path": path, **keywords}, ("path",))
        return self.host(host, conservative=conservative, invocation=invocation)

    @check_keywords
    def host(
        self,
        host: Host,
        *,
        state_scale: ArrayLike | None = None,
        conservative: bool = False,
        invocation: str = "",
        threads: int | None = None,
    ) -> ProbeReport:
        """Audit a :class:`libration.hosts.Host`.

        Parameters
        ----------
        state_scale:
            Typical deviations of the states, or one number for all (default: the larger of 1 and the absolute state).
        invocation:
            The command or call that repeats the audit, for its page (default: none).
        threads:
            As in :func:`libration.probe`; for a host without memory whose step may be called from several threads.
        """
        number_of_threads = thread_count(threads)
        if number_of_threads is not None and host.memory:
            raise ValueError(f"threads is {threads}, but rows of the host continue a simulation; expected None, or a host without memory")
        number("exchange_latency", host.exchange_latency, "finite and at least 0", lambda x: 0 <= x < math.inf)
        described = description_of(host)
        described.update(conservative=bool(conservative), invocation=str(invocation))
        if state_scale is not None:
            count = len(host.state)
            described["state_scale"] = vector("state_scale", np.broadcast_to(state_scale, count) if np.ndim(state_scale) == 0 else state_scale).tolist()
        if "mass" in described:
            described["mass"] = inertia(described["mass"], len(host.positions))
        watch = None if host.observe is None else observations_of(host.observe, True)
        # The rows of a host with memory continue one simulation each.
        return _audit(host, described, watch, None, not host.memory, number_of_threads)


probe = Probe()

_POINT = ("step", "state", "action", "dt")


def _audit(
    host: Host,
    described: dict[str, Any],
    observe: Callable[..., Any] | None,
    restart: Callable[[], Any] | None,
    batched: bool,
    threads: int | None,
) -> ProbeReport:
    if threads is not None:
        scales = [
            np.array(described.get(name, np.maximum(np.abs(values), 1.0)), dtype=np.float64)
            for name, values in (("state_scale", host.state), ("action_scale", host.action))
        ]
        recording = thread_recording(host, scales[0], scales[1], threads, batched)
        described.setdefault("recordings", []).extend(described_recordings([recording]))
    check_energy(host.energy, host.state)
    energy = None if host.energy is None else contiguous(host.energy, 1)
    text = json.dumps(described)
    # A run that diverges overflows, which is a finding.
    with np.errstate(over="ignore", invalid="ignore"):
        answer, holds, page = _native._probe(text, contiguous(host.step, 2), observe, energy, restart, bool(batched))
    results = {**json.loads(answer), "exchange_latency": float(host.exchange_latency)}
    return ProbeReport(results, holds, page)
