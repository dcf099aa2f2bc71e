"""Names of joints, states and actions of a MuJoCo model, with units."""

from __future__ import annotations

from typing import Any

import mujoco

_AXES = ("x", "y", "z")


def name_of(model: Any, kind: str, number: int) -> str:
    """Return the name of an element, or one like ``joint[3]``."""
    found = mujoco.mj_id2name(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), number)
    # A parenthesis would begin a unit.
    return found.replace("(", "[").replace(")", "]") if found else f"{kind}[{number}]"


def number_of_actuators(model: Any) -> int:
    """Return the number of actuators, which may have several actions each since MuJoCo 4."""
    return int(getattr(model, "nactuator", model.nu))


def joint_names(model: Any) -> tuple[str, ...]:
    return tuple(name_of(model, "joint", joint) for joint in range(model.njnt))


def state_names(model: Any) -> tuple[str, ...]:
    """Return the names of positions, velocities and activations."""
    positions: list[tuple[str, str]] = []
    for joint, name in enumerate(joint_names(model)):
        kind = int(model.jnt_type[joint])
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            positions += [(f"{name} {axis}", "m") for axis in _AXES]
            positions += [(f"{name} rotation {axis}", "rad") for axis in _AXES]
        elif kind == mujoco.mjtJoint.mjJNT_BALL:
            positions += [(f"{name} rotation {axis}", "rad") for axis in _AXES]
        else:
            positions.append((name, "m" if kind == mujoco.mjtJoint.mjJNT_SLIDE else "rad"))
    states = [f"{name} ({unit})" for name, unit in positions] + [f"{name}' ({unit}/s)" for name, unit in positions]
    activations = [f"activation[{number}]" for number in range(model.na)]
    for actuator in range(number_of_actuators(model)):
        first, several = int(model.actuator_actadr[actuator]), int(model.actuator_actnum[actuator])
        for k in range(several if first >= 0 else 0):
            activations[first + k] = f"{name_of(model, 'actuator', actuator)} activation" + (f"[{k}]" if several > 1 else "")
    return tuple(states + activations)


def input_names(model: Any) -> tuple[str, ...]:
    """Return the names of actions."""
    names = [f"ctrl[{number}] (command)" for number in range(model.nu)]
    for actuator in range(number_of_actuators(model)):
        name = name_of(model, "actuator", actuator)
        first = int(model.actuator_ctrladr[actuator]) if hasattr(model, "actuator_ctrladr") else actuator
        several = int(model.actuator_ctrlnum[actuator]) if hasattr(model, "actuator_ctrlnum") else 1
        for k in range(several):
            names[first + k] = f"{name}[{k}] (command)" if several > 1 else f"{name} ({_unit(model, actuator)})"
    return tuple(names)


def _unit(model: Any, actuator: int) -> str:
    """Return the unit of the command of a motor or servo on a joint, or ``command``."""
    joint = int(model.actuator_trnid[actuator][0])
    direct = (
        int(model.actuator_trntype[actuator]) == mujoco.mjtTrn.mjTRN_JOINT
        and int(model.jnt_type[joint]) in (mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE)
        and model.actuator_gear[actuator][0] == 1
        and int(model.actuator_dyntype[actuator]) == mujoco.mjtDyn.mjDYN_NONE
        and int(model.actuator_gaintype[actuator]) == mujoco.mjtGain.mjGAIN_FIXED
    )
    if not direct:
        return "command"
    slides = int(model.jnt_type[joint]) == mujoco.mjtJoint.mjJNT_SLIDE
    gain, bias = model.actuator_gainprm[actuator][0], model.actuator_biasprm[actuator]
    kind = int(model.actuator_biastype[actuator])
    if kind == mujoco.mjtBias.mjBIAS_NONE:
        return ("N" if slides else "N m") if gain == 1 else "command"
    if kind == mujoco.mjtBias.mjBIAS_AFFINE and gain > 0:
        if bias[1] == -gain:
            return "m" if slides else "rad"
        if bias[1] == 0 and bias[2] == -gain:
            return "m/s" if slides else "rad/s"
    return "command"
