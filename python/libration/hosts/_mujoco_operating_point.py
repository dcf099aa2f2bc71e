"""Operating points of MuJoCo models: how far an equilibrium is from the requested point, and what changed on the way."""

from __future__ import annotations

from collections import Counter
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from ._mujoco_names import name_of, number_of_actuators, state_names

Array = NDArray[np.float64]

FAR_ROTATION = 0.5
"""Largest rotation in rad of an equilibrium that is near the request: beyond it the linearisations of both have little in common."""
FAR_TRANSLATION = 0.1
"""The same for translations, in parts of the extent of the model."""
RUN_SECONDS = 5.0
_MOST_RUN_STEPS = 10_000
_MOST_FACTOR = 64.0
_BISECTIONS = 6


def changes_of(model: Any, start: Array, end: Array) -> Array:
    """Return the change of each position from one configuration to another, as a velocity over a second."""
    change = np.zeros(model.nv)
    mujoco.mj_differentiatePos(model, change, 1.0, np.ascontiguousarray(start), np.ascontiguousarray(end))
    return change


def relative_changes(model: Any, change: Array) -> Array:
    """Return the size of each change in parts of the largest one of a point that is near."""
    limit = np.full(model.nv, FAR_ROTATION)
    for joint in range(model.njnt):
        kind, first = int(model.jnt_type[joint]), int(model.jnt_dofadr[joint])
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            limit[first : first + 3] = FAR_TRANSLATION * model.stat.extent
        elif kind == mujoco.mjtJoint.mjJNT_SLIDE:
            limit[first] = FAR_TRANSLATION * model.stat.extent
    return np.abs(np.nan_to_num(change, nan=np.inf)) / np.maximum(limit, 1e-300)


def is_near(model: Any, start: Array, end: Array) -> bool:
    """Whether a configuration is near another one."""
    return bool(np.all(relative_changes(model, changes_of(model, start, end)) <= 1))


def constraints_of(model: Any, data: Any) -> Counter[str]:
    """Return what holds the model at data of ``mj_forward``: contacts, limits, equality constraints and friction, with their numbers."""
    found: Counter[str] = Counter()
    for k in range(data.ncon):
        if data.contact[k].efc_address >= 0:
            bodies = ["a flex" if geom < 0 else name_of(model, "body", int(model.geom_bodyid[geom])) for geom in data.contact[k].geom]
            found[f"contact of {bodies[1]} and {bodies[0]}"] += 1
    kinds, numbers = np.asarray(data.efc_type)[: data.nefc], np.asarray(data.efc_id)[: data.nefc]
    for key, what, element in (
        ("LIMIT_JOINT", "limit of joint", "joint"),
        ("LIMIT_TENDON", "limit of tendon", "tendon"),
        ("EQUALITY", "equality constraint", "equality"),
    ):
        for number in sorted(set(numbers[kinds == int(getattr(mujoco.mjtConstraint, f"mjCNSTR_{key}"))].tolist())):
            found[f"{what} {name_of(model, element, int(number))}"] += 1
    return found


def operating_point_of(model: Any, start: Any, point: Any, method: str, residual: float) -> dict[str, Any]:
    """Return what an equilibrium has in common with the requested point; both are data of ``mj_forward``."""
    change = changes_of(model, start.qpos, point.qpos)
    sizes = relative_changes(model, change)
    before, after = constraints_of(model, start), constraints_of(model, point)
    largest = int(np.argmax(sizes)) if model.nv else 0
    name, unit = _named(state_names(model)[largest]) if model.nv else ("", "")
    return {
        "method": method,
        "changes": change.tolist(),
        "largest": {"name": name, "unit": unit, "change": float(change[largest]) if model.nv else 0.0},
        "relative_change": float(sizes[largest]) if model.nv else 0.0,
        "residual": residual if np.isfinite(residual) else 1.0,
        "gained": _counted(after - before),
        "lost": _counted(before - after),
    }


def _named(name: str) -> tuple[str, str]:
    text, _, unit = name.rpartition(" (")
    return text, unit.removesuffix(")")


def _counted(found: Counter[str]) -> list[str]:
    return [f"{what} ({count})" if count > 1 else what for what, count in sorted(found.items())]


def servos_of(model: Any) -> list[int]:
    """Return the actuators whose forces fall with their lengths or velocities."""
    affine = int(mujoco.mjtBias.mjBIAS_AFFINE)
    bias = np.asarray(model.actuator_biasprm)
    return [k for k in range(number_of_actuators(model)) if int(model.actuator_biastype[k]) == affine and (bias[k, 1] < 0 or bias[k, 2] < 0)]


def standing_of(model: Any, start: Any) -> dict[str, Any]:
    """Return whether the model stays near the point in a run under its commands, and if not the least factor of gains with which it does."""
    seconds = min(RUN_SECONDS, _MOST_RUN_STEPS * float(model.opt.timestep))
    found: dict[str, Any] = {"seconds": seconds, "stands": _stays(model, start, seconds), "least_factor": None, "tried_up_to": 1.0}
    position_servos = [k for k in servos_of(model) if model.actuator_biasprm[k, 1] < 0]
    if found["stands"] or not position_servos:
        return found
    gains, bias = np.array(model.actuator_gainprm), np.array(model.actuator_biasprm)

    def stays(factor: float) -> bool:
        model.actuator_gainprm[position_servos, 0] = factor * gains[position_servos, 0]
        model.actuator_biasprm[position_servos, 1] = factor * bias[position_servos, 1]
        return _stays(model, start, seconds)

    low, high = 1.0, 1.5
    try:
        while not stays(high) and high < _MOST_FACTOR:
            low, high = high, 1.5 * high
        found["tried_up_to"] = high
        if stays(high):
            for _ in range(_BISECTIONS):
                middle = float(np.sqrt(low * high))
                low, high = (low, middle) if stays(middle) else (middle, high)
            found["least_factor"] = high
    finally:
        model.actuator_gainprm[:], model.actuator_biasprm[:] = gains, bias
    return found


def _stays(model: Any, start: Any, seconds: float) -> bool:
    """Whether a run from rest at the point under its commands ends and remains near it."""
    data = mujoco.MjData(model)
    for warning in data.warning:
        warning.number = 1
    for name in ("qpos", "act", "ctrl", "qfrc_applied", "xfrc_applied", "mocap_pos", "mocap_quat", "eq_active"):
        getattr(data, name)[:] = getattr(start, name)
    steps = max(1, round(seconds / float(model.opt.timestep)))
    parts = min(steps, 25)
    for _ in range(parts):
        mujoco.mj_step(model, data, nstep=max(1, steps // parts))
        if not np.isfinite(data.qpos).all() or not is_near(model, start.qpos, data.qpos):
            return False
    return True
