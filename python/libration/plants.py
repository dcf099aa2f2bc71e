"""Linear plants of simulators."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._derivatives import extrapolated_jacobian
from ._keywords import check_keywords
from .linear import LinearPlant

__all__ = ["from_mujoco"]


@check_keywords
def from_mujoco(
    model: Any,
    data: Any = None,
    *,
    keyframe: str | int | None = None,
    state: str | None = None,
    dt: float | None = None,
) -> LinearPlant:
    """Return the plant of a step of a MuJoCo model, sampled with its timestep. Requires the package ``mujoco``.

    States are positions of joints, velocities and activations as deviations from the point, inputs are the commands; all states are
    outputs. The matrices are differences of the step with an estimated error, also where ``mjd_transitionFD`` refuses.
    :attr:`ProbeReport.plant` is the same in continuous time.

    Parameters
    ----------
    model:
        An ``MjModel``, or the path of an XML or MJB file.
    data, keyframe, state, dt:
        The point and the timestep, see :func:`libration.hosts.mujoco_host`.

    Raises
    ------
    TypeError, ValueError
        For an invalid value, or a step that has no derivative at the point: a contact or a limit changes there.
    """
    from .hosts import mujoco_host

    host = mujoco_host(model, data, keyframe=keyframe, state=state, dt=dt)
    n, m = len(host.state), len(host.action)
    if m == 0:
        raise ValueError("the model has no actuators; a plant requires an input")
    scale = np.maximum(1.0, np.abs(np.concatenate([host.state, host.action])))

    def step(z: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.float64]]:
        return host.step(z[np.newaxis, :n], z[np.newaxis, n:], host.dt)[0]

    matrices, errors = extrapolated_jacobian(step, np.concatenate([host.state, host.action]), scale)
    sizes = np.max(np.abs(matrices) * scale, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(errors == 0, 0.0, errors * scale / sizes[:, np.newaxis])
    if not np.isfinite(matrices).all() or np.max(relative) > 0.01:
        i = int(np.argmax(np.max(relative, axis=1)))
        raise ValueError(
            f"the step has no derivative at this point: that of {host.states[i]!r} has a relative error of {np.max(relative):.1g}; "
            "a contact or a limit changes there"
        )
    return LinearPlant(matrices[:, :n], matrices[:, n:], dt=host.dt, states=host.states, inputs=host.inputs)
