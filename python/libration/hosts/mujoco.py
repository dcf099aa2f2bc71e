"""MuJoCo models as steps in minimal coordinates."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._keywords import check_keywords
from .._settings import positive
from ._mujoco_coordinates import Coordinates
from ._mujoco_equilibrium import imbalance, inertia_of, is_equilibrium
from ._mujoco_names import input_names, joint_names, state_names
from ._mujoco_notes import notes_of
from ._mujoco_point import INTEGRATION, copy_of, model_of, point_of, space_queues, state_of
from ._mujoco_recordings import recordings_of
from .host import Host

Array = NDArray[np.float64]

# As the XML has them.
_INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast", "discrete")
# Words of notes about contacts and constraints.
_VALID = "valid only while"
# The best step of central differences is the cube root of the rounding.
_EPS = 6e-6


@check_keywords
def mujoco_host(
    model: Any,
    data: Any = None,
    *,
    keyframe: str | int | None = None,
    state: str | None = None,
    dt: float | None = None,
    memory: bool | None = False,
) -> Host:
    """Return a MuJoCo model at a point as a step in minimal coordinates.

    The states are positions of joints, their velocities and activations. Rotations of ball and free joints are rotation vectors from
    the point, in the frame of the body. A step is one ``mj_step`` of a copy of the model; the model and data are never changed.

    Parameters
    ----------
    model:
        An ``MjModel``, or the path of an XML or MJB file.
    data:
        An ``MjData`` with the point: its state, commands, applied forces and mocap poses.
    keyframe:
        Name or number of a keyframe that is the point.
    state:
        ``"given"`` (that of ``data``), ``"keyframe"`` (the one given or the first), ``"default"`` (``qpos0``), or ``"settled"``: the
        equilibrium near it that Newton's method finds, or else that of a damped simulation from there (default: what is given).
    dt:
        Timestep in s at which the step is described (default: that of the model).
    memory:
        Whether each row continues a simulation: queues of delayed actuators and the warm start live on from call to call. A call with
        another number of rows or timestep begins anew, as ``host.reset()`` does. None: with delayed actuators.

    Raises
    ------
    TypeError, ValueError
        For a file that does not compile, an unknown keyframe, a state that is not finite, or no equilibrium; the message names it.
    """
    return host_at_point(model, data, keyframe=keyframe, state=state, dt=dt, memory=memory)[0]


def host_at_point(
    model: Any,
    data: Any,
    *,
    keyframe: str | int | None,
    state: str | None,
    dt: float | None,
    memory: bool | None,
    is_audited: bool = True,
) -> tuple[Host, Any, Any]:
    """Return the host of :func:`mujoco_host`, the model that it steps, and the point; without recordings and references if not audited."""
    own, title = model_of(model)
    if memory is None:
        memory = bool(np.any(np.asarray(getattr(own, "actuator_delay", ())) > 0))
    # An automatic reset would hide a divergence.
    own.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, "mjDSBL_AUTORESET", 0))
    timestep = positive("dt", own.opt.timestep if dt is None else dt)
    point, notes, where = point_of(own, data, keyframe, state, timestep)
    own.opt.timestep = timestep
    coordinates = Coordinates(own, point.qpos)
    simulation = _Simulation(own, point, coordinates, memory)
    start = coordinates.state(point)
    action = np.array(point.ctrl)
    forward = copy_of(own, point)
    mujoco.mj_forward(own, forward)
    rest = bool(is_equilibrium(own, forward))
    if not rest:
        worst, number = imbalance(own, forward)
        moves = "velocities are not zero" if np.any(forward.qvel) else f"forces leave {worst:.2g} of their size"
        notes.append(f"the point is no equilibrium: {moves}" + (f" at {state_names(own)[number]}" if own.nv and worst > 0 else ""))
    notes += notes_of(own, forward, memory)
    reference_a, reference_b = _reference(own, point, coordinates, simulation, start, action, notes) if is_audited else (None, None)
    host = Host(
        step=simulation.step,
        state=start,
        action=action,
        dt=timestep,
        states=state_names(own),
        inputs=input_names(own),
        title=title,
        integrator=_INTEGRATORS[int(own.opt.integrator)],
        version=f"MuJoCo {mujoco.__version__}",
        energy=simulation.energy if is_audited else None,
        mass=inertia_of(own, forward),
        positions=tuple((k, own.nv + k) for k in range(own.nv)),
        equilibrium=rest,
        notes=tuple(note for note in notes if _VALID not in note),
        validity=tuple(note for note in notes if _VALID in note),
        reference_A=reference_a,
        reference_B=reference_b,
        reference_source="" if reference_a is None else "mjd_transitionFD",
        joint_damping=tuple(float(damping) for damping in np.asarray(own.dof_damping).reshape(-1)),
        delays=_delays_of(own),
        joints=joint_names(own),
        recordings=recordings_of(own, point) if is_audited else (),
        memory=memory,
        reset=simulation.reset,
        operating_point=where,
    )
    return host, own, point


def _delays_of(model: Any) -> tuple[float, ...]:
    """Return the stated delay of each command in s; none where an actuator has several commands."""
    delays = tuple(float(delay) for delay in np.asarray(getattr(model, "actuator_delay", ())).reshape(-1))
    return delays if len(delays) == model.nu else ()


class _Simulation:
    """The steps of a model, from states that are set as a whole."""

    def __init__(self, model: Any, point: Any, coordinates: Coordinates, memory: bool) -> None:
        self.model, self.coordinates, self.memory = model, coordinates, memory
        self.dt = float(model.opt.timestep)
        self.point = state_of(model, point)
        self.data, self.scratch = copy_of(model, point), copy_of(model, point)
        self.begin, self.spacing = self.point, self.dt
        self.rows: list[Array] = []

    def reset(self) -> None:
        self.rows = []

    def step(self, states: Array, actions: Array, dt: float) -> Array:
        model, data, nu = self.model, self.data, self.model.nu
        states = _rows("states", states, self.coordinates.size)
        actions = _rows("actions", actions, nu)
        if len(actions) != len(states):
            raise ValueError(f"actions has {len(actions)} rows; expected {len(states)}, as many as states")
        if dt != self.spacing:
            self._space(positive("dt", dt))
        if len(self.rows) != len(states):
            self.rows = [self.begin] * len(states)
        after = np.empty_like(states)
        for row, (state, action) in enumerate(zip(states, actions)):
            if not (np.isfinite(state).all() and np.isfinite(action).all()):
                after[row] = np.nan
                continue
            mujoco.mj_setState(model, data, self.rows[row] if self.memory else self.begin, INTEGRATION)
            self.coordinates.write(state, data)
            data.ctrl[:] = action
            mujoco.mj_step(model, data)
            after[row] = self.coordinates.state(data)
            if self.memory:
                self.rows[row] = state_of(model, data)
        return after

    def energy(self, states: Array) -> Array:
        """Return the potential and kinetic energy in J of each row."""
        states = _rows("states", states, self.coordinates.size)
        model, data = self.model, self.scratch
        found = np.empty(len(states))
        for row, state in enumerate(states):
            mujoco.mj_setState(model, data, self.point, INTEGRATION)
            self.coordinates.write(state, data)
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            mujoco.mj_energyPos(model, data)
            mujoco.mj_energyVel(model, data)
            found[row] = data.energy.sum()
        return found

    def _space(self, dt: float) -> None:
        """Set the timestep, and set samples in queues that far apart."""
        self.model.opt.timestep = dt
        self.spacing, self.rows = dt, []
        mujoco.mj_setState(self.model, self.data, self.point, INTEGRATION)
        if dt != self.dt:
            space_queues(self.model, self.data, dt)
        self.begin = state_of(self.model, self.data)


def _rows(name: str, value: Array, width: int) -> Array:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name} has shape {array.shape}; expected (rows, {width})")
    return array


def _reference(
    model: Any, point: Any, coordinates: Coordinates, simulation: _Simulation, state: Array, action: Array, notes: list[str]
) -> tuple[Array | None, Array | None]:
    """Return the matrices of ``mjd_transitionFD`` in the same coordinates, or None with a note of its refusal."""
    a, b = np.zeros((coordinates.size, coordinates.size)), np.zeros((coordinates.size, model.nu))
    try:
        mujoco.mjd_transitionFD(model, copy_of(model, point), _EPS, True, a, b, None, None)
    except Exception as error:
        notes.append(f"mjd_transitionFD gives no reference: {' '.join(str(error).split())}")
        return None, None
    # Its matrices are in the tangent space at the state after the step.
    after = simulation.step(state[np.newaxis], action[np.newaxis], simulation.spacing)[0]
    simulation.reset()
    chart = coordinates.chart(after)
    return chart @ a, chart @ b
