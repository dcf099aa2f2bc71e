"""Recordings of MuJoCo models that should have the same bits."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray

from ._mujoco_point import INTEGRATION, copy_of, has_warned, silent_data
from .host import Recording

Array = NDArray[np.float64]

_STEPS = 20
_ENVIRONMENTS = 8
_THREADS = 4
_PHYSICS = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)


def recordings_of(model: Any, point: Any) -> tuple[Recording, ...]:
    """Return pairs of recordings from near the point: with states restored between steps, and over threads.

    A run that diverges is not repeated over threads, where each would print its warnings.
    """
    (plain, diverges), (restored, _) = (_trajectory(model, point, restore) for restore in (False, True))
    found: list[Recording] = [(f"{_STEPS} steps with the state restored between steps", plain, restored)]
    if not diverges:
        starts = np.stack([_start(model, point, number) for number in range(_ENVIRONMENTS)])
        alone, threads = _rollout(model, point, starts, 1), _rollout(model, point, starts, _THREADS)
        found.append((f"{_ENVIRONMENTS} environments on {_THREADS} threads", alone, threads))
    return tuple(found)


def _trajectory(model: Any, point: Any, restore: bool) -> tuple[Array, bool]:
    """Return the physics state after each step, steps × components, and whether MuJoCo warned."""
    data = copy_of(model, point)
    data.qvel[:] += 0.01
    found = np.empty((_STEPS, mujoco.mj_stateSize(model, _PHYSICS)))
    state = np.empty(mujoco.mj_stateSize(model, INTEGRATION))
    diverges = False
    for row in found:
        if restore:
            mujoco.mj_getState(model, data, state, INTEGRATION)
            data = silent_data(model)
            mujoco.mj_setState(model, data, state, INTEGRATION)
        mujoco.mj_step(model, data)
        diverges = diverges or has_warned(data)
        mujoco.mj_getState(model, data, row, _PHYSICS)
    return found, diverges


def _start(model: Any, point: Any, number: int) -> Array:
    data = copy_of(model, point)
    data.qvel[:] += 0.01 * (number + 1) / _ENVIRONMENTS
    state = np.empty(mujoco.mj_stateSize(model, _PHYSICS))
    mujoco.mj_getState(model, data, state, _PHYSICS)
    return state


def _rollout(model: Any, point: Any, starts: Array, threads: int) -> Array:
    """Return the physics states, steps × environments × components."""
    control = np.tile(np.array(point.ctrl), (len(starts), _STEPS, 1))
    data = [mujoco.MjData(model) for _ in range(threads)]
    states, _ = rollout.rollout(model, data, starts, control if control.size else None, nstep=_STEPS)
    return np.ascontiguousarray(np.swapaxes(np.asarray(states), 0, 1))
