"""The step of a MuJoCo model with any gains of its servos, at a point that the gains do not move."""

from __future__ import annotations

from typing import Any, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._descriptions import description_of
from .._keywords import check_keywords
from .._settings import count, positive
from ._mujoco_force_limits import free_forces, idle_servos
from ._mujoco_names import name_of, number_of_actuators, state_names
from ._mujoco_operating_point import servos_of
from ._mujoco_other_forces import growth_of_free_motion, other_forces, remove_friction
from ._mujoco_point import copy_of, model_of
from ._mujoco_servos import NO_GAINS, mujoco_servos, of_free_motion
from .host import Host
from .mujoco import host_at_point

Array = NDArray[np.float64]

# Those of the engine that MuJoCo has, and whether they treat the damping of joints implicitly.
_INTEGRATORS = {
    "euler": ("EULER", True),
    "symplectic-euler": ("EULER", False),
    "semi-implicit-euler": ("EULER", False),
    "implicit": ("IMPLICIT", True),
    "implicitfast": ("IMPLICITFAST", True),
    "damping-implicit": ("IMPLICITFAST", True),
    "rk4": ("RK4", True),
}


NO_ARM = 1e-12
"""Largest moment arm, in m or as a ratio, that is none."""


class ServoGains:
    """The gains of the servos of a model, which are changed in place without a change of their forces at the point."""

    def __init__(self, model: Any, point: Any) -> None:
        self.model = model
        forward = copy_of(model, point)
        mujoco.mj_forward(model, forward)
        single = np.asarray(getattr(model, "actuator_outnum", np.ones(number_of_actuators(model), dtype=int))).reshape(-1) == 1
        self.servos = [k for k in servos_of(model) if single[k]]
        outputs = np.asarray(getattr(model, "actuator_outadr", np.arange(number_of_actuators(model)))).reshape(-1)
        self.bias = np.array(model.actuator_biasprm)
        self.lengths = np.array([forward.actuator_length[outputs[k]] for k in self.servos])
        self.rates = np.array([forward.actuator_velocity[outputs[k]] for k in self.servos])
        self.forces = np.array([forward.actuator_force[outputs[k]] for k in self.servos])
        self.moments = _moments(model, point, [int(outputs[k]) for k in self.servos])
        self.forward = forward

    def described(self) -> list[dict[str, Any]]:
        """Return names, gains, the inertia that each servo moves with all others at rest, and the only joint on which it acts."""
        names = state_names(self.model)
        found = []
        for place, k in enumerate(self.servos):
            acts = np.flatnonzero(self.moments[place])
            answer = np.zeros((1, self.model.nv))
            mujoco.mj_solveM(self.model, self.forward, answer, self.moments[place : place + 1])
            mobility = float(answer[0] @ self.moments[place])
            found.append(
                {
                    "name": name_of(self.model, "actuator", k),
                    "kp": float(-self.bias[k, 1]),
                    "kv": float(-self.bias[k, 2]),
                    "inertia": 1 / mobility if mobility > 0 else 0.0,
                    "joint": names[acts[0]].rpartition(" (")[0] if len(acts) == 1 else None,
                }
            )
        return found

    def set(self, kp: Sequence[float], kv: Sequence[float]) -> None:
        """Set the gains of position and velocity of the servos, with their forces at the point as they are."""
        bias = np.array(self.bias)
        for place, k in enumerate(self.servos):
            bias[k, 1], bias[k, 2] = -kp[place], -kv[place]
            bias[k, 0] += (self.bias[k, 1] + kp[place]) * self.lengths[place] + (self.bias[k, 2] + kv[place]) * self.rates[place]
        self.model.actuator_biasprm[:] = bias


def _moments(model: Any, point: Any, outputs: list[int]) -> Array:
    """Return the derivatives of the lengths of actuators by the positions, actuators × velocities."""
    data, found = copy_of(model, point), np.zeros((len(outputs), model.nv))
    mujoco.mj_fwdPosition(model, data)
    for number in range(model.nv):
        data.qvel[:] = 0
        data.qvel[number] = 1.0
        mujoco.mj_fwdVelocity(model, data)
        found[:, number] = np.asarray(data.actuator_velocity)[outputs]
    # A straight leg has a moment arm of roundings.
    return np.where(np.abs(found) > NO_ARM, found, 0.0)


@check_keywords
def mujoco_gains(
    model: Any,
    data: Any = None,
    *,
    keyframe: str | int | None = None,
    state: str | None = None,
    dt: float | None = None,
    integrator: str | None = None,
    substeps: int = 1,
) -> tuple[dict[str, Any], Host, ServoGains]:
    """Return the servos of a model as matrices with the description of its step, the step itself, and its gains.

    The step is that of ``mj_step`` at a timestep of ``dt / substeps``, with contacts, limits and equality constraints, and without friction
    loss, which makes it linear within the hold of friction only. It is not described for an integrator that MuJoCo does not have. The
    point is chosen as in :func:`mujoco_host`.

    Raises
    ------
    ValueError
        As :func:`mujoco_servos`.
    """
    own, _ = model_of(model)
    whole = positive("dt", own.opt.timestep if dt is None else dt)
    is_own = integrator is None or integrator.lower() in _INTEGRATORS
    if integrator is not None and is_own:
        name, is_implicit = _INTEGRATORS[integrator.lower()]
        own.opt.integrator = int(getattr(mujoco.mjtIntegrator, f"mjINT_{name}"))
        flag = int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
        own.opt.disableflags = own.opt.disableflags & ~flag if is_implicit else own.opt.disableflags | flag
    part = whole / count("substeps", substeps, 1, 1000)
    host, own, point = host_at_point(own, data, keyframe=keyframe, state=state, dt=part, memory=False, is_audited=False)
    friction, growth = remove_friction(own, host)
    saturated, of_limits = free_forces(own, point)
    gains = ServoGains(own, point)
    described = mujoco_servos(own, point)
    described.update(saturated=saturated, idle=idle_servos(own, gains.moments, gains.servos, gains.forces))
    others = other_forces(own, gains.forward, gains.servos)
    others["friction"] = friction
    # A taut tendon without a moment arm has a stiffness all the same, which grows with its force.
    taut = [k for k, moments, force in zip(gains.servos, gains.moments, gains.forces) if force and not moments.any()]
    others["actuators"] += [name_of(own, "actuator", k) for k in taut]
    others["undecided"] += growth_of_free_motion(own, host, gains.forward)
    if growth is not None:
        others["undecided"].append(f"while friction loss holds, a mode grows by a factor {growth:.4g} per step")
    if of_limits:
        others["not_examined"].append("deviations at which forces meet their limits")
    described["other_forces"] = others
    if others["commanded"]:
        # At another command their forces may depend on positions.
        described["notes"] = [note for note in described["notes"] if note != NO_GAINS]
    described["dt"] = whole
    if is_own:
        # Notes on contacts are those of the step, in which they act.
        of_model = [note for note in described["notes"] if note == NO_GAINS]
        validity = [of_free_motion(note) if "friction loss" in note else note for note in host.validity]
        described.update(notes=[*host.notes, *validity, *of_limits, *of_model], step=description_of(host), servos=gains.described())
    return described, host, gains
