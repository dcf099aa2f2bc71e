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
    point is chosen as in :func:`mujoco_host`.
    """
    own, _ = model_of(model)
    point, notes = point_of(own, data, keyframe, state, float(own.opt.timestep))
    forward = copy_of(own, point)
    mujoco.mj_forward(own, forward)
    notes += notes_of(own, forward, False)
    kp, stiffness = _derivatives(own, point, positions=True)
    kv, passive = _derivatives(own, point, positions=False)
    damping = np.diag(np.array(own.dof_damping, dtype=np.float64))
    integrator = mujoco.mjtIntegrator(own.opt.integrator).name.removeprefix("mjINT_").lower()
    if integrator == "euler" and own.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP):
        integrator = "symplectic-euler"
    return {
        "joints": list(state_names(own)[: own.nv]),
        "mass": inertia_of(own, forward).tolist(),
        "kp": kp.tolist(),
        "kv": (kv + passive - damping).tolist(),
        "stiffness": stiffness.tolist(),
        "damping": damping.tolist(),
        "dt": float(own.opt.timestep),
        "integrator": integrator,
        "notes": [note for note in notes if "equilibrium" not in note],
    }


def _derivatives(model: Any, point: Any, positions: bool) -> tuple[Array, Array]:
    """Return minus the derivatives of the forces of actuators, and of all others, by positions or velocities."""

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
        return np.array(data.qfrc_actuator), np.array(data.qfrc_passive - data.qfrc_bias)

    of_actuators, of_others = np.zeros((model.nv, model.nv)), np.zeros((model.nv, model.nv))
    for number in range(model.nv):
        above, below = forces(number, _STEP), forces(number, -_STEP)
        of_actuators[:, number] = -(above[0] - below[0]) / (2 * _STEP)
        of_others[:, number] = -(above[1] - below[1]) / (2 * _STEP)
    return of_actuators, of_others
