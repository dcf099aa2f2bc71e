"""Facts about a MuJoCo model at a point that limit the validity of an audit."""

from __future__ import annotations

from collections import Counter
from typing import Any

import mujoco
import numpy as np

from ._mujoco_names import name_of, number_of_actuators

_CONSTRAINTS = {
    "mjCNSTR_EQUALITY": "rows of equality constraints",
    "mjCNSTR_FRICTION_DOF": "joints with friction loss",
    "mjCNSTR_FRICTION_TENDON": "tendons with friction loss",
    "mjCNSTR_LIMIT_JOINT": "joints at a limit",
    "mjCNSTR_LIMIT_TENDON": "tendons at a limit",
}


def notes_of(model: Any, data: Any, memory: bool) -> list[str]:
    """Return the notes; the data must be that of ``mj_forward``."""
    return [*_contacts(model, data), *_constraints(model, data), *_actuators(model, data), *_delays(model, memory), *_options(model)]


def _contacts(model: Any, data: Any) -> list[str]:
    pairs: Counter[str] = Counter()
    for k in range(data.ncon):
        geoms = [int(geom) for geom in data.contact[k].geom]
        if data.contact[k].efc_address < 0:
            continue
        labels = [_geom(model, geom) if geom >= 0 else "flex" for geom in geoms]
        pairs[f"{labels[1]} and {labels[0]}"] += 1
    if not pairs:
        return []
    total = sum(pairs.values())
    between = ", ".join(f"{pair} ({count})" for pair, count in pairs.most_common(6))
    more = f", and {len(pairs) - 6} more pairs" if len(pairs) > 6 else ""
    active = "1 contact is" if total == 1 else f"{total} contacts are"
    return [f"{active} active between {between}{more}; the result is valid only while these contacts stay"]


def _geom(model: Any, geom: int) -> str:
    body = name_of(model, "body", int(model.geom_bodyid[geom]))
    return f"{body}/{name_of(model, 'geom', geom)}"


def _constraints(model: Any, data: Any) -> list[str]:
    notes = []
    kinds = np.asarray(data.efc_type)[: data.nefc]
    for key, what in _CONSTRAINTS.items():
        if count := int(np.sum(kinds == int(getattr(mujoco.mjtConstraint, key)))):
            first, _, rest = what.partition(" ")
            active = f"1 {first.removesuffix('s')} {rest} acts" if count == 1 else f"{count} {what} act"
            notes.append(f"{active} at the point; the result is valid only while this stays so")
    return notes


def _actuators(model: Any, data: Any) -> list[str]:
    clamped = [
        f"ctrl[{k}] = {data.ctrl[k]:g}"
        for k in range(model.nu if not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CLAMPCTRL else 0)
        if model.actuator_ctrllimited[k] and not model.actuator_ctrlrange[k][0] < data.ctrl[k] < model.actuator_ctrlrange[k][1]
    ]
    notes = [f"commands at a limit of ctrlrange have no derivative: {', '.join(clamped[:6])}"] if clamped else []
    limited, saturated, kinked = [], [], []
    for k in range(number_of_actuators(model)):
        if model.actuator_actlimited[k] and (first := int(model.actuator_actadr[k])) >= 0:
            low, high = model.actuator_actrange[k]
            if not low < data.act[first + model.actuator_actnum[k] - 1] < high:
                limited.append(name_of(model, "actuator", k))
        if model.actuator_forcelimited[k]:
            low, high = model.actuator_forcerange[k]
            out = int(model.actuator_outadr[k]) if hasattr(model, "actuator_outadr") else k
            if not low < data.actuator_force[out] < high:
                saturated.append(name_of(model, "actuator", k))
        if int(model.actuator_dyntype[k]) == mujoco.mjtDyn.mjDYN_MUSCLE and not model.actuator_dynprm[k][2]:
            kinked.append(name_of(model, "actuator", k))
    if kinked:
        notes.append(
            "muscles activate faster than they deactivate, and tausmooth is zero, so they have no derivative at rest: "
            + ", ".join(kinked[:6])
        )
    if limited:
        notes.append(f"activations at a limit of actrange have no derivative: {', '.join(limited[:6])}")
    if saturated:
        notes.append(f"actuators at their force limit have no derivative: {', '.join(saturated[:6])}")
    return notes


def _delays(model: Any, memory: bool) -> list[str]:
    if not hasattr(model, "actuator_delay"):
        return []
    delayed = [k for k in range(number_of_actuators(model)) if model.actuator_delay[k] > 0]
    if not delayed:
        return []
    names = ", ".join(f"{name_of(model, 'actuator', k)} ({model.actuator_delay[k]:g} s)" for k in delayed[:6])
    if memory:
        return [f"commands are delayed: {names}; their queues live on from call to call"]
    return [f"commands are delayed: {names}; each call begins with a queue at rest, so these actions have no effect within a step"]


def _options(model: Any) -> list[str]:
    notes = []
    flags, option = mujoco.mjtDisableBit, model.opt
    if int(option.integrator) == mujoco.mjtIntegrator.mjINT_EULER and np.any(model.dof_damping):
        how = "explicitly, since eulerdamp is disabled" if option.disableflags & flags.mjDSBL_EULERDAMP else "implicitly (eulerdamp)"
        notes.append(f"Euler integrates joint damping {how}")
    skipped = [
        name
        for name in ("constraint", "equality", "frictionloss", "limit", "contact", "spring", "damper", "gravity", "actuation")
        if option.disableflags & getattr(flags, f"mjDSBL_{name.upper()}")
    ]
    if skipped:
        notes.append(f"disabled by option/flag: {', '.join(skipped)}")
    if hasattr(mujoco.mjtEnableBit, "mjENBL_SLEEP") and option.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP:
        notes.append("bodies may fall asleep; a call wakes them all")
    if model.nplugin:
        notes.append(f"{model.nplugin} plug-ins act; their states begin each call as at the point")
    if getattr(model, "nplastic", 0):
        notes.append(f"{model.nplastic} numbers of plastic state begin each call as at the point")
    if np.any(np.asarray(model.actuator_dyntype) == int(mujoco.mjtDyn.mjDYN_USER)) or mujoco.get_mjcb_control() is not None:
        notes.append("user callbacks act in each step")
    return notes
