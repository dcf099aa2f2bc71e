"""Servos of MuJoCo models that are at a limit of their forces, or that do not act."""

from __future__ import annotations

import copy
from typing import Any, Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray

from ._mujoco_names import name_of, number_of_actuators
from ._mujoco_operating_point import servos_of
from ._mujoco_point import copy_of

Array = NDArray[np.float64]

REACH = 1e-5
"""Deviation of a position or velocity within which a force must not meet its limit: the derivative of the force is measured on it."""


def idle_servos(model: Any, moments: Array, servos: list[int], forces: Array) -> list[str]:
    """Return why each servo that does not act does not; moments are servos × velocities, and forces those at the point."""
    found = []
    is_off = bool(model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_ACTUATION))
    for place, k in enumerate(servos):
        group = int(np.asarray(model.actuator_group).reshape(-1)[k])
        why = None
        if is_off:
            why = "actuation is disabled by option/flag"
        elif 0 <= group < 31 and int(getattr(model.opt, "disableactuator", 0)) >> group & 1:
            why = f"its group {group} is disabled by actuatorgroupdisable"
        elif not moments[place].any():
            why = "it moves no joint at the point"
            if forces[place]:
                # A taut tendon has a stiffness that grows with its force.
                why += f", where only its force of {forces[place]:.3g} acts, by its direction"
        if why:
            found.append(f"`{name_of(model, 'actuator', k)}` does not act: {why}")
    return found


def free_forces(model: Any, point: Any) -> tuple[list[str], list[str]]:
    """Remove the limits of forces that stay within them near the point, in place.

    The derivative of such a force is that without its limit, at any gain. Returns what is at a limit and has no derivative, and notes.
    """
    servos = servos_of(model)
    if model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_ACTUATION) or not servos:
        return [], []
    at_limit, least = [], (np.inf, "")
    removed: list[tuple[Array, int]] = []
    for name, (low, high), flags, number, forces in _limited(model, point):
        here = forces[0]
        inside = min(high - here, here - low)
        change = float(np.max(np.abs(forces - here)))
        if change < inside:
            removed.append((flags, number))
        elif change > 0:
            limit = f"its force limit ({low:g} to {high:g})"
            at = f"{name} is at {limit}, where gains have no derivative"
            near = f"{name} meets {limit} within a deviation of {REACH:g}, over which gains are measured"
            at_limit.append(at if inside <= 0 else near)
        if change > 0:
            least = min(least, (REACH * inside / change, name))
    for flags, number in removed:
        flags[number] = 0
    notes = []
    if not at_limit and np.isfinite(least[0]):
        notes.append(f"{least[1]} meets its force limit at a deviation of {least[0]:.2g}; the result is valid only while deviations are smaller")
    return at_limit, notes


def _limited(model: Any, point: Any) -> Iterator[tuple[str, Array, Array, int, Array]]:
    """Yield name, range, flags, number and forces of all that has a limit: at the point, and beside it in each position and velocity."""
    actuators, tendons = range(number_of_actuators(model)), getattr(model, "tendon_actfrclimited", np.zeros(0))
    joints = getattr(model, "jnt_actfrclimited", np.zeros(0))
    outputs = np.asarray(getattr(model, "actuator_outadr", np.arange(len(actuators)))).reshape(-1)
    if np.any(model.actuator_forcelimited):
        # A tendon scales the forces of its actuators.
        forces = _forces(model, point, ("actuator_forcelimited", "tendon_actfrclimited"))[0]
        for k in actuators:
            if model.actuator_forcelimited[k]:
                name = f"`{name_of(model, 'actuator', k)}`"
                yield name, model.actuator_forcerange[k], model.actuator_forcelimited, k, forces[:, outputs[k]]
    if np.any(tendons):
        forces = _forces(model, point, ("tendon_actfrclimited",))[0]
        is_of_tendon = np.asarray(model.actuator_trntype) == int(mujoco.mjtTrn.mjTRN_TENDON)
        for k in np.flatnonzero(tendons):
            own = [outputs[a] for a in actuators if is_of_tendon[a] and model.actuator_trnid[a][0] == k]
            name = f"tendon `{name_of(model, 'tendon', int(k))}`"
            yield name, model.tendon_actfrcrange[k], tendons, int(k), forces[:, own].sum(axis=1)
    if np.any(joints):
        forces = _forces(model, point, ("jnt_actfrclimited",))[1]
        for k in np.flatnonzero(joints):
            name = f"joint `{name_of(model, 'joint', int(k))}`"
            yield name, model.jnt_actfrcrange[k], joints, int(k), forces[:, int(model.jnt_dofadr[k])]


def _forces(model: Any, point: Any, flags: tuple[str, ...]) -> tuple[Array, Array]:
    """Return forces of actuators and on velocities without limits of these kinds: at the point, and beside it on both sides of each state."""
    free = copy.deepcopy(model)
    for flag in flags:
        if hasattr(free, flag):
            getattr(free, flag)[:] = 0
    of_actuators, of_velocities = [], []
    for number in range(-1, 2 * model.nv):
        for side in (REACH, -REACH) if number >= 0 else (0.0,):
            data = copy_of(free, point)
            if number >= model.nv:
                data.qvel[number - model.nv] += side
            elif number >= 0:
                change = np.zeros(model.nv)
                change[number] = 1.0
                mujoco.mj_integratePos(free, data.qpos, change, side)
            mujoco.mj_fwdPosition(free, data)
            mujoco.mj_fwdVelocity(free, data)
            mujoco.mj_fwdActuation(free, data)
            of_actuators.append(np.array(data.actuator_force))
            of_velocities.append(np.array(data.qfrc_actuator))
    return np.stack(of_actuators), np.stack(of_velocities)
