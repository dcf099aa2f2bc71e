"""Equilibria of MuJoCo models under constant commands."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from ._mujoco_coordinates import Coordinates
from ._mujoco_names import state_names
from ._mujoco_operating_point import is_near

Array = NDArray[np.float64]

BALANCE = 1e-6
"""Largest sum of forces at an equilibrium, relative to the sum of their absolute values."""
MOST_ITERATIONS = 50
MOST_STEPS = 20_000
# Damped steps after which Newton's method searches near the point: contacts close in them.
_SHORT_RELAXATIONS = (10, 30, 100, 300, 1000)


def imbalance(model: Any, data: Any) -> tuple[float, int]:
    """Return the largest sum of forces relative to their sizes, and the number of its velocity.

    Forces below a thousandth of the largest one, or of the weight at the distance of the model's extent, count as that. The data must be that of ``mj_forward``.
    """
    if not model.nv:
        return 0.0, 0
    inertia = inertia_of(model, data)
    rest = np.abs(inertia @ data.qacc)
    forces = (data.qfrc_bias, data.qfrc_passive, data.qfrc_actuator, data.qfrc_applied, data.qfrc_constraint)
    size = np.sum(np.abs(forces), axis=0) + np.abs(inertia) @ np.abs(data.qacc)
    weight = float(model.body_mass.sum()) * float(np.linalg.norm(model.opt.gravity)) * float(model.stat.extent)
    size = np.maximum(size, max(1e-3 * float(size.max()), 1e-3 * weight, 1e-300))
    relative = np.nan_to_num(rest / size, nan=np.inf)
    return float(relative.max()), int(np.argmax(relative))


def inertia_of(model: Any, data: Any) -> Array:
    """Return the joint-space inertia, velocities × velocities."""
    dense = np.zeros((model.nv, model.nv))
    if not model.nv:
        return dense
    try:
        mujoco.mj_fullM(model, data, dense)
    except TypeError:
        # Before MuJoCo 4.
        mujoco.mj_fullM(model, dense, data.qM)
    return dense


def is_equilibrium(model: Any, data: Any) -> bool:
    """Whether nothing moves and all forces balance, after ``mj_forward``."""
    at_rest = not np.any(np.abs(data.qvel) > 1e-9) and not np.any(np.abs(data.act_dot) > BALANCE * (1 + np.abs(data.act)))
    return bool(at_rest) and imbalance(model, data)[0] <= BALANCE


def settle(model: Any, data: Any) -> str:
    """Move the data to an equilibrium; return how it was found.

    The equilibrium near the point comes first, by Newton's method from the point, and then after short relaxations in which contacts
    close. A relaxation is a simulation whose velocities are set to zero whenever the kinetic energy falls. A long one follows if
    there is none: it ends wherever the model comes to rest. Commands stay as they are.

    Raises
    ------
    ValueError
        If no search finds an equilibrium; the message has the state that accelerates most.
    """
    data.qvel[:] = 0
    start = data.qpos.copy(), data.act.copy()
    steps, relaxed = 0, start
    for most in (0, *_SHORT_RELAXATIONS):
        data.qpos[:], data.act[:], data.qvel[:] = *relaxed, 0
        steps += _relax(model, data, most - steps) if most else 0
        relaxed = data.qpos.copy(), data.act.copy()
        iterations = _newton(model, data)
        if is_equilibrium(model, data) and is_near(model, start[0], data.qpos):
            how = f"{iterations} iterations of Newton's method"
            return f"{how} found the equilibrium near the request" + (f" after {steps} damped steps" if steps else "")
    data.qpos[:], data.act[:], data.qvel[:] = *relaxed, 0
    steps += _relax(model, data, MOST_STEPS)
    iterations = _newton(model, data)
    if is_equilibrium(model, data):
        return f"a damped simulation of {steps} steps and {iterations} iterations of Newton's method found the equilibrium"
    names = state_names(model)
    worst = int(np.argmax(np.abs(np.nan_to_num(data.qacc, nan=np.inf)))) if model.nv else 0
    what = f"{names[model.nv + worst]} still changes by {data.qacc[worst]:.3g} per second" if model.nv else "activations still change"
    raise ValueError(
        f"no equilibrium found after {steps} damped steps: {what}; "
        "help: begin nearer to one, or give commands that hold the model against gravity"
    )


def _residual(model: Any, data: Any) -> Array:
    mujoco.mj_forward(model, data)
    return np.concatenate([data.qacc, data.act_dot])


def _newton(model: Any, data: Any) -> int:
    """Solve for positions and activations without acceleration, with steps of least norm that are halved until they improve."""
    base = Coordinates(model, data.qpos)
    nv, unknown = model.nv, np.r_[0 : model.nv, 2 * model.nv : 2 * model.nv + model.na]
    state = base.state(data)
    state[nv : 2 * nv] = 0

    def residual(z: Array) -> Array:
        base.write(z, data)
        return _residual(model, data)

    rest = residual(state)
    iterations = 0
    for iterations in range(MOST_ITERATIONS):
        if not rest.any() or not np.isfinite(rest).all():
            break
        columns = []
        for j in unknown:
            above, below = state.copy(), state.copy()
            above[j] += 1e-6
            below[j] -= 1e-6
            columns.append((residual(above) - residual(below)) / (above[j] - below[j]))
        jacobian = np.stack(columns, axis=1)
        if not np.isfinite(jacobian).all():
            break
        shift = np.linalg.lstsq(jacobian, -rest, rcond=1e-9)[0]
        shift *= min(1.0, 0.5 / max(float(np.max(np.abs(shift))), 1e-300))
        factor, size = 1.0, float(np.linalg.norm(rest))
        while factor > 1e-6:
            tried = state.copy()
            tried[unknown] += factor * shift
            rest_tried = residual(tried)
            if np.linalg.norm(rest_tried) < (1 - 1e-4 * factor) * size:
                break
            factor /= 2
        else:
            break
        state, rest = tried, rest_tried
    residual(state)
    return iterations


def _relax(model: Any, data: Any, most: int) -> int:
    """Simulate at most so many steps with velocities that are set to zero whenever the kinetic energy falls."""
    step = 0
    for step in range(1, most + 1):
        mujoco.mj_step(model, data)
        if not np.isfinite(data.qacc).all() or np.any(np.abs(data.qpos) > 1e6):
            break
        if float(data.qvel @ inertia_times(model, data)) < 0:
            data.qvel[:] = 0
        if step % 100 == 0:
            speed = data.qvel.copy()
            data.qvel[:] = 0
            mujoco.mj_forward(model, data)
            if is_equilibrium(model, data):
                return step
            data.qvel[:] = speed
    data.qvel[:] = 0
    mujoco.mj_forward(model, data)
    return step


def inertia_times(model: Any, data: Any) -> Array:
    """Return the inertia times the acceleration: the sum of forces."""
    force = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, force, data.qacc)
    return force
