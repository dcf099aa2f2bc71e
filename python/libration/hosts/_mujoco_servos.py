"""Servos of MuJoCo models as matrices."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._keywords import check_keywords
from ._mujoco_equilibrium import inertia_of
from ._mujoco_names import state_names
from ._mujoco_notes import notes_of
from ._mujoco_point import copy_of, model_of, point_of

Array = NDArray[np.float64]

# Forces of servos and springs are linear in positions and velocities, so that the step matters little.
_STEP = 1e-5
# The error of such a derivative by rounding, for forces of one unit.
_ROUNDING = 2 * float(np.finfo(np.float64).eps) / _STEP
NO_GAINS = "no force of an actuator depends on a position: there are no gains of position"
"""The note on a model without servos."""
# What notes say of contacts and other constraints.
_VALID_WHILE = "; the result is valid only while "


@check_keywords
def mujoco_servos(
    model: Any,
    data: Any = None,
    *,
    keyframe: str | int | None = None,
    state: str | None = None,
) -> dict[str, Any]:
    """Return inertia, gains, stiffness and damping of a model at a point, as matrices of its velocities.

    Gains are the derivatives of the forces of all actuators by positions and velocities, at constant commands and activations. The
    stiffness is that of gravity and of springs of joints and tendons. The damping is that of joints, which the integrator ``Euler``
    treats implicitly unless ``eulerdamp`` is disabled; that of tendons counts as a gain of velocity, which it treats explicitly. The
    point is chosen as in :func:`mujoco_host`. Contacts and other constraints have no part in it, and gravity is no stiffness of a body on
    a free joint that only they hold: it falls without them.

    Raises
    ------
    TypeError, ValueError
        As :func:`mujoco_host`, and for a model without actuators.
    """
    own, _ = model_of(model)
    if not own.nu:
        raise ValueError("model has no actuators; expected servos: actuators whose forces depend on positions")
    point, notes, _ = point_of(own, data, keyframe, state, float(own.opt.timestep))
    forward = copy_of(own, point)
    mujoco.mj_forward(own, forward)
    notes += notes_of(own, forward, False)
    acceleration = _free_fall(own, forward)
    error = _ROUNDING * _size(own, forward, acceleration)
    kp, stiffness = (_without(error, found) for found in _derivatives(own, point, acceleration, positions=True))
    kv, passive = _derivatives(own, point, acceleration, positions=False)
    if not kp.any():
        notes.append(NO_GAINS)
    damping = np.diag(np.array(own.dof_damping, dtype=np.float64))
    integrator = mujoco.mjtIntegrator(own.opt.integrator).name.removeprefix("mjINT_").lower()
    if integrator == "euler" and own.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP):
        integrator = "symplectic-euler"
    return {
        "joints": list(state_names(own)[: own.nv]),
        "mass": inertia_of(own, forward).tolist(),
        "kp": kp.tolist(),
        "kv": _without(error, kv + passive - damping).tolist(),
        "stiffness": stiffness.tolist(),
        "damping": damping.tolist(),
        "dt": float(own.opt.timestep),
        "integrator": integrator,
        "notes": [of_free_motion(note) for note in notes if "equilibrium" not in note],
    }


def _free_fall(model: Any, data: Any) -> Array:
    """Return the acceleration by gravity of free joints that nothing but constraints holds, and zero for all other velocities."""
    found = np.zeros(model.nv)
    gravity = np.array(model.opt.gravity)
    if model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY):
        return found
    for joint in np.flatnonzero(np.asarray(model.jnt_type) == int(mujoco.mjtJoint.mjJNT_FREE)):
        first = int(model.jnt_dofadr[joint])
        falls = data.qacc_smooth[first : first + 3]
        # Servos of other joints accelerate the base, too.
        if np.linalg.norm(falls - gravity) < np.linalg.norm(falls):
            found[first : first + 3] = gravity
    return found


def _size(model: Any, data: Any, acceleration: Array) -> float:
    """Return the size of the largest force whose rounding is in derivatives."""
    inertial = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, inertial, acceleration)
    parts = (data.qfrc_actuator, data.qfrc_passive, data.qfrc_bias, inertial)
    return float(np.max(np.sum(np.abs(parts), axis=0), initial=0.0))


def _without(error: float, values: Array) -> Array:
    """Return values in which those that do not exceed their error are zero."""
    return np.where(np.abs(values) > error, values, 0.0)


def of_free_motion(note: str) -> str:
    """Return a note on what acts at the point, for an analysis of motion without it."""
    what, found, _ = note.partition(_VALID_WHILE)
    return f"{what}; gains are those of motion without them" if found else note


def _derivatives(model: Any, point: Any, acceleration: Array, positions: bool) -> tuple[Array, Array]:
    """Return minus the derivatives of the forces of actuators, and of all others, by positions or velocities.

    The force that accelerates the changing inertia is one of the others.
    """

    def forces(number: int, step: float) -> tuple[Array, Array]:
        data = copy_of(model, point)
        if positions:
            change = np.zeros(model.nv)
            change[number] = 1.0
            mujoco.mj_integratePos(model, data.qpos, change, step)
        else:
            data.qvel[number] += step
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        inertial = np.zeros(model.nv)
        mujoco.mj_mulM(model, data, inertial, acceleration)
        return np.array(data.qfrc_actuator), np.array(data.qfrc_passive - data.qfrc_bias - inertial)

    of_actuators, of_others = np.zeros((model.nv, model.nv)), np.zeros((model.nv, model.nv))
    for number in range(model.nv):
        above, below = forces(number, _STEP), forces(number, -_STEP)
        of_actuators[:, number] = -(above[0] - below[0]) / (2 * _STEP)
        of_others[:, number] = -(above[1] - below[1]) / (2 * _STEP)
    return of_actuators, of_others
