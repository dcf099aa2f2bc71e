"""Forces of MuJoCo models besides those of servos whose gains are changed: friction loss, and other actuators."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from ._mujoco_names import name_of, number_of_actuators
from ._mujoco_operating_point import servos_of
from .host import Host

# Lengths of differences within the hold of friction. Their spectral radii must agree, or the step has no derivative there.
_LENGTHS = (1e-7, 1e-8)
# Relative difference of radii that agree, and growth that rounding of such short differences may show.
_AGREES = 1e-3
# Off an equilibrium only modes that are fast beside the step count, by the distance of their factors from 1, and growth beyond this.
_FAST, _GROWTH = 0.5, 1.01
# What a derivative at the point does not have of constraints that act there.
_CONTACT = ("CONTACT_FRICTIONLESS", "CONTACT_PYRAMIDAL", "CONTACT_ELLIPTIC")
_LIMIT = ("LIMIT_JOINT", "LIMIT_TENDON")
_ACTING = {
    "contacts that slip, open or close": _CONTACT,
    "motion away from limits of joints": _LIMIT[:1],
    "motion away from limits of tendons": _LIMIT[1:],
}
_ONE_SIDED = (("contacts", "CONTACT", _CONTACT), ("limits of joints and tendons", "LIMIT", _LIMIT))
# The step is smooth without them: the root of the rounding.
_FREE_LENGTH = 1e-6


def remove_friction(model: Any, host: Host) -> tuple[list[str], float | None]:
    """Remove the friction loss of joints and tendons, in place; return what had some, and the growth per step while it holds.

    Friction that holds makes the step linear for displacements within its hold only. Beyond it friction is a constant force, and the
    derivative is that without friction.
    """
    flags = mujoco.mjtDisableBit
    joints = sorted({int(model.dof_jntid[k]) for k in np.flatnonzero(np.asarray(model.dof_frictionloss) > 0)})
    tendons = np.flatnonzero(np.asarray(model.tendon_frictionloss) > 0)
    is_off = bool(model.opt.disableflags & (int(flags.mjDSBL_FRICTIONLOSS) | int(flags.mjDSBL_CONSTRAINT)))
    if is_off or not (joints or len(tendons)):
        return [], None
    growth = _held_growth(host)
    model.dof_frictionloss[:] = 0
    model.tendon_frictionloss[:] = 0
    names = [f"joint `{name_of(model, 'joint', k)}`" for k in joints]
    return names + [f"tendon `{name_of(model, 'tendon', int(k))}`" for k in tendons], growth


def _factors(host: Host, eps: float) -> NDArray[np.complex128] | None:
    """Return the factors of the modes of a step by central differences; None if they are not finite."""
    change = eps * np.eye(len(host.state))
    actions = np.tile(host.action, (len(change), 1))
    matrix = (host.step(host.state + change, actions, host.dt) - host.step(host.state - change, actions, host.dt)).T / (2 * eps)
    host.reset()
    return np.asarray(np.linalg.eigvals(matrix), dtype=np.complex128) if np.isfinite(matrix).all() else None


def _held_growth(host: Host) -> float | None:
    """Return the largest factor of a mode of the step with the friction that holds, if one grows at an equilibrium."""
    if not host.equilibrium:
        return None
    factors = [_factors(host, eps) for eps in _LENGTHS]
    radii = [0.0 if one is None else float(np.abs(one).max(initial=0.0)) for one in factors]
    is_known = abs(radii[0] - radii[1]) <= _AGREES * max(radii)
    return radii[0] if is_known and radii[0] > 1 + _AGREES else None


def growth_of_free_motion(model: Any, host: Host, data: Any) -> list[str]:
    """Return which constraints that act at the point, but not always, hide a fast mode that grows, in words."""
    found = []
    kinds, flags = set(np.asarray(data.efc_type)[: data.nefc].tolist()), int(model.opt.disableflags)
    for what, flag, names in _ONE_SIDED:
        if not kinds & set(_values(mujoco.mjtConstraint, "mjCNSTR", names)):
            continue
        model.opt.disableflags = flags | int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
        factors = _factors(host, _FREE_LENGTH)
        model.opt.disableflags = flags
        growth = 0.0 if factors is None else float(np.abs(factors[np.abs(factors - 1) > _FAST]).max(initial=0.0))
        if growth > _GROWTH:
            found.append(f"without the {what} that act at the point a fast mode grows by a factor {growth:.4g} per step")
    return found


def other_forces(model: Any, data: Any, changed: list[int]) -> dict[str, Any]:
    """Return what acts besides the servos whose gains are changed, as the engine reads it; the data must be that of ``mj_forward``."""
    acting = [k for k in range(number_of_actuators(model)) if _acts(model, k)]
    commanded = [k for k in acting if _depends_on_command(model, k)]
    others = [k for k in acting if k in commanded or k not in changed and _has_feedback(model, k)]
    kinds = set(np.asarray(data.efc_type)[: data.nefc].tolist())
    motors = [k for k in acting if _holds_by_friction(model, k)]
    return {
        "actuators": [name_of(model, "actuator", k) for k in others],
        "commanded": [name_of(model, "actuator", k) for k in commanded],
        "without_gains": not servos_of(model) and not any(_has_controller(model, k) for k in acting),
        "undecided": [f"the friction of the motor `{name_of(model, 'actuator', k)}` holds small deviations only" for k in motors],
        "not_examined": [what for what, names in _ACTING.items() if kinds & set(_values(mujoco.mjtConstraint, "mjCNSTR", names))],
    }


def _values(enumeration: Any, prefix: str, names: tuple[str, ...]) -> list[int]:
    """Return the values of an enumeration, of those names that this MuJoCo has."""
    found = (getattr(enumeration, f"{prefix}_{name}", None) for name in names)
    return [int(value) for value in found if value is not None]


def _acts(model: Any, actuator: int) -> bool:
    group = int(np.asarray(model.actuator_group).reshape(-1)[actuator])
    is_off = bool(model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_ACTUATION))
    return not is_off and not (0 <= group < 31 and int(getattr(model.opt, "disableactuator", 0)) >> group & 1)


def _is_gain(model: Any, actuator: int, *names: str) -> bool:
    return int(model.actuator_gaintype[actuator]) in _values(mujoco.mjtGain, "mjGAIN", names)


def _is_bias(model: Any, actuator: int, *names: str) -> bool:
    return int(model.actuator_biastype[actuator]) in _values(mujoco.mjtBias, "mjBIAS", names)


def _depends_on_command(model: Any, actuator: int) -> bool:
    """Whether the derivative of the force by positions or velocities changes with the command or the activation."""
    is_affine = _is_gain(model, actuator, "AFFINE") and bool(np.any(model.actuator_gainprm[actuator][1:3]))
    return is_affine or _is_gain(model, actuator, "MUSCLE", "USER") or _is_bias(model, actuator, "USER")


def _has_controller(model: Any, actuator: int) -> bool:
    """Whether an actuator that is no affine servo has gains of its own."""
    is_plugin = int(np.asarray(getattr(model, "actuator_plugin", np.full(actuator + 1, -1)))[actuator]) >= 0
    of_motor = _is_gain(model, actuator, "DCMOTOR") and bool(np.any(model.actuator_gainprm[actuator][4:7]))
    return is_plugin or of_motor or _is_gain(model, actuator, "SO3", "PID")


def _has_feedback(model: Any, actuator: int) -> bool:
    """Whether the force of an actuator depends on positions or velocities, whatever its command."""
    if _is_bias(model, actuator, "AFFINE"):
        by_bias = bool(np.any(model.actuator_biasprm[actuator][1:3]))
    else:
        by_bias = not _is_bias(model, actuator, "NONE")
    damping = [np.asarray(getattr(model, name, np.zeros(actuator + 1)))[actuator] for name in ("actuator_damping", "actuator_dampingpoly")]
    is_motor = _is_gain(model, actuator, "DCMOTOR")
    return by_bias or is_motor or _has_controller(model, actuator) or any(np.any(one) for one in damping)


def _holds_by_friction(model: Any, actuator: int) -> bool:
    """Whether an actuator has the friction of a bristle, which holds a joint at rest."""
    return _is_bias(model, actuator, "DCMOTOR") and bool(np.any(model.actuator_biasprm[actuator][3:5]))
