"""Gains of servos: whether they hold at a time step, by which margin, and with which integrator."""

from __future__ import annotations

import json
import math
from os import PathLike
from pathlib import Path
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._json import json_text
from ._keywords import check_keywords
from ._settings import count, positive
from ._step_functions import contiguous, names, numbers_of

__all__ = ["GainReport", "Gains", "gains"]

# Those of MuJoCo whose steps the engine has.
_INTEGRATORS = ("euler", "symplectic-euler", "implicitfast", "implicit", "rk4")


class GainReport:
    """The results; :attr:`results` has all numbers under the keys of ``libration gains --json``."""

    def __init__(self, results: dict[str, Any], page: str) -> None:
        self.results = results
        self._page = page

    def __repr__(self) -> str:
        return f"<GainReport: {self.answer}>"

    @property
    def answer(self) -> str:
        """The answer in a few sentences."""
        return str(self.results["answer"])

    @property
    def holds(self) -> bool:
        """Whether the gains hold."""
        return bool(self.results["holds"])

    def _limit(self, value: float | None) -> float:
        if value is None:
            return math.nan if self.verdict["outcome"] == "unknown" else math.inf
        return float(value)

    @property
    def largest_factor(self) -> float:
        """The largest factor of all gains of position, with the same gains of velocity; infinite
        if there is none, NaN beside the verdict ``unknown``."""
        return self._limit(self.results["largest_factor"])

    @property
    def largest_kv(self) -> dict[str, float]:
        """The largest gain of velocity of each joint, with all others as they are; infinite
        if there is none, NaN beside the verdict ``unknown``."""
        return {joint["name"]: self._limit(joint["largest_kv"]) for joint in self.results["joints"]}

    @property
    def measured(self) -> dict[str, Any] | None:
        """The step of the simulator itself with these gains: its modes and the limits of each servo. None of a servo model alone."""
        found: dict[str, Any] | None = self.results["measured"]
        return found

    @property
    def verdict(self) -> dict[str, Any]:
        """The outcome, its evidence, and what was not examined."""
        return dict(self.results["verdict"])

    @property
    def largest_kp(self) -> dict[str, float]:
        """The largest gain of position of each joint, with all others as they are; infinite
        if there is none, NaN beside the verdict ``unknown``."""
        return {joint["name"]: self._limit(joint["largest_kp"]) for joint in self.results["joints"]}

    @property
    def fewest_substeps(self) -> int | None:
        """The fewest substeps with which the gains hold; None if 1000 do not."""
        found: int | None = self.results["fewest_substeps"]
        return found

    @property
    def joints(self) -> list[dict[str, Any]]:
        """Each joint, alone and within all others."""
        return list(self.results["joints"])

    @property
    def modes(self) -> list[dict[str, Any]]:
        """The modes of all joints together, the fastest first."""
        return list(self.results["modes"])

    @property
    def integrators(self) -> list[dict[str, Any]]:
        """All integrators with these gains."""
        return list(self.results["integrators"])

    def save(self, path: str | PathLike[str]) -> None:
        """Write the HTML page, or with the suffix ``.json`` all numbers; one that is not finite is null."""
        text = json_text(self.results) if str(path).endswith(".json") else self._page
        Path(path).write_text(text, encoding="utf-8")


class Gains:
    """Limits of gains: ``libration.gains(M, kp, kv, dt=…)`` of matrices, ``libration.gains.mujoco(model)`` of a MuJoCo model."""

    @check_keywords
    def __call__(
        self,
        mass: ArrayLike,
        kp: ArrayLike,
        kv: ArrayLike | None = None,
        *,
        dt: float,
        integrator: str = "symplectic-euler",
        substeps: int = 1,
        held_torque: bool = False,
        stiffness: ArrayLike | None = None,
        damping: ArrayLike | None = None,
        joints: Sequence[str] | None = None,
    ) -> GainReport:
        """Return whether servos ``M q̈ = −(kp + stiffness) q − (kv + damping) q̇`` hold at a time step.

        Parameters
        ----------
        mass:
            Inertia, joints × joints, or its diagonal.
        kp, kv:
            Gains of position and velocity, for each joint or joints × joints (default of ``kv``: zero).
        dt:
            Time step of the simulator in s.
        integrator:
            Its name here or in a simulator: ``"symplectic-euler"``, ``"euler"`` (MuJoCo's, with implicit damping of joints),
            ``"implicitfast"``, ``"implicit"``, ``"rk4"``, ``"backward-euler"``, …
        substeps:
            Steps of the integrator in each time step.
        held_torque:
            Whether the torques of servos are computed once per time step and held over its substeps, as by a controller outside of the
            simulator (default: anew in each substep).
        stiffness, damping:
            Those of joints besides their servos.
        joints:
            Names with units in parentheses.

        Raises
        ------
        TypeError, ValueError
            For an invalid value; the message has the name of the parameter and what is allowed.
        """
        described: dict[str, Any] = {"mass": _entries("mass", mass), "kp": _entries("kp", kp)}
        for name, value in (("kv", kv), ("stiffness", stiffness), ("damping", damping)):
            if value is not None:
                described[name] = _entries(name, value)
        if held_torque:
            described["torque"] = "held"
        if joints is not None:
            described["joints"] = _names(joints)
        return _report(described, positive("dt", dt), substeps, integrator)

    @check_keywords
    def mujoco(
        self,
        model: Any,
        data: Any = None,
        *,
        keyframe: str | int | None = None,
        state: str | None = None,
        dt: float | None = None,
        integrator: str | None = None,
        substeps: int = 1,
    ) -> GainReport:
        """Return whether the servos of a MuJoCo model hold: an ``MjModel``, or the path of an XML or MJB file.

        The verdict and the limits are those of the measured step of ``mj_step``, as in :func:`libration.probe`, with contacts, limits and
        equality constraints as they are at the point, and without friction loss, which holds small deviations only. The verdict is
        ``unknown`` for a step that does not grow if no actuator has gains, or if one has another effect on the motion at each command. A
        servo model stands beside it: all actuators, by the derivatives of their forces;
        gravity and springs of joints and tendons are the stiffness. ``dt`` and ``integrator`` are those of the model by default; with an
        integrator that MuJoCo does not have the result is that of the servo model alone. The other parameters are those of
        :func:`libration.hosts.mujoco_host`.
        """
        from .hosts._mujoco_gains import mujoco_gains

        described, host, servos = mujoco_gains(
            model, data, keyframe=keyframe, state=state, dt=dt, integrator=integrator, substeps=substeps
        )
        own_dt, own = described.pop("dt"), described.pop("integrator")
        if integrator is None and own not in _INTEGRATORS:
            allowed = ", ".join(_INTEGRATORS)
            raise ValueError(f"the integrator of the model is {own!r}; expected {allowed}; help: give integrator, or use probe.mujoco")
        return _report(described, own_dt, substeps, integrator or own, host.step, servos.set)


gains = Gains()


def _report(
    described: dict[str, Any],
    dt: float,
    substeps: int,
    integrator: str,
    step: Callable[..., Any] | None = None,
    set_gains: Callable[..., None] | None = None,
) -> GainReport:
    if not isinstance(integrator, str):
        raise TypeError(f"integrator must be a string, not {type(integrator).__name__}")
    parts = count("substeps", substeps, 1, 1000)
    answer, page = _native._gains(json.dumps(described), dt, parts, integrator, step and contiguous(step, 2), set_gains)
    return GainReport(json.loads(answer), page)


def _entries(name: str, value: ArrayLike) -> Any:
    found = np.atleast_1d(numbers_of(name, value))
    if found.ndim > 2:
        raise ValueError(f"{name} has shape {found.shape}; expected a number for each joint, or joints × joints")
    if not np.isfinite(found).all():
        at = tuple(int(k) for k in np.argwhere(~np.isfinite(found))[0])
        raise ValueError(f"{name}{list(at)} is {found[at]}; expected finite numbers")
    return found.tolist()


def _names(joints: Sequence[str]) -> list[str]:
    found = names("joints", joints)
    if repeated := [name for k, name in enumerate(found) if name in found[:k]]:
        raise ValueError(f"joints has {repeated[0]!r} twice; expected different names")
    return found
