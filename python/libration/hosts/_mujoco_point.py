"""Points of MuJoCo models: given data, keyframes, defaults and equilibria."""

from __future__ import annotations

import copy
import os
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._settings import nearest
from ._mujoco_equilibrium import imbalance, settle
from ._mujoco_names import number_of_actuators
from ._mujoco_operating_point import operating_point_of, standing_of

Array = NDArray[np.float64]

STATES = ("given", "keyframe", "default", "settled")
INTEGRATION = int(mujoco.mjtState.mjSTATE_INTEGRATION)


def model_of(model: Any) -> tuple[Any, str]:
    """Return a copy of a model, and its title."""
    if isinstance(model, mujoco.MjModel):
        own = copy.deepcopy(model)
    elif isinstance(model, (str, os.PathLike)):
        path = os.fspath(model)
        if not os.path.isfile(path):
            text = "; help: use mujoco.MjModel.from_xml_string for XML text" if str(path).lstrip().startswith("<") else ""
            raise ValueError(f"model is {str(path)[:60]!r}, and there is no such file; expected the path of an XML or MJB file{text}")
        read = mujoco.MjModel.from_binary_path if str(path).endswith(".mjb") else mujoco.MjModel.from_xml_path
        try:
            own = read(str(path))
        except Exception as error:
            raise ValueError(f"model {str(path)!r} does not compile: {' '.join(str(error).split())}") from None
    else:
        raise TypeError(f"model must be an MjModel or a path, not {type(model).__name__}")
    return own, bytes(own.names).split(b"\0", 1)[0].decode() or "MuJoCo model"


def point_of(
    model: Any, data: Any, keyframe: str | int | None, state: str | None, dt: float
) -> tuple[Any, list[str], dict[str, Any] | None]:
    """Return data at the point, notes of what it is, and where it is from the requested one if it was searched for.

    An equilibrium is that of steps of ``dt``: contacts rest deeper where the timestep changes their stiffness.
    """
    if state is not None and state not in STATES:
        raise ValueError(f"state is {state!r}: {nearest(str(state), STATES)}")
    if data is not None and keyframe is not None:
        raise ValueError("data and keyframe are both given; expected one of them")
    for name, given in (("given", data is not None), ("keyframe", keyframe is not None or model.nkey > 0)):
        if state == name and not given:
            raise ValueError(f"state is {name!r}, but there is no {'data' if name == 'given' else 'keyframe'}")
    if state == "default" and (data is not None or keyframe is not None):
        raise ValueError("state is 'default', but data or a keyframe is given; expected neither")
    point = mujoco.MjData(model)
    if data is not None:
        if not isinstance(data, mujoco.MjData):
            raise TypeError(f"data must be an MjData, not {type(data).__name__}")
        if (len(data.qpos), len(data.qvel), len(data.act), len(data.ctrl)) != (model.nq, model.nv, model.na, model.nu):
            raise ValueError(f"data has {len(data.qpos)} positions and {len(data.ctrl)} commands, but model has {model.nq} and {model.nu}")
        point = copy_of(model, data)
        notes = [f"the point is the given data at {data.time:g} s"]
    elif keyframe is not None or state == "keyframe":
        number = _keyframe(model, 0 if keyframe is None else keyframe)
        mujoco.mj_resetDataKeyframe(model, point, number)
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_KEY, number)
        notes = [f"the point is keyframe {name!r}" if name else f"the point is keyframe {number}"]
    else:
        notes = ["the point is the default configuration qpos0"]
    if data is None:
        space_queues(model, point, dt, np.array(point.ctrl))
    for name in ("qpos", "qvel", "act", "ctrl"):
        values = getattr(point, name)
        if not np.isfinite(values).all():
            at = int(np.argmin(np.isfinite(values)))
            raise ValueError(f"{name}[{at}] is {values[at]}; expected finite numbers")
    if state == "settled":
        for warning in point.warning:
            warning.number = 1
        time, notes = point.time, [notes[0].replace("the point is", "the search for an equilibrium begins at")]
        model.opt.timestep = dt
        start = copy_of(model, point)
        start.qvel[:] = 0
        mujoco.mj_forward(model, start)
        notes.append(settle(model, point))
        end = copy_of(model, point)
        mujoco.mj_forward(model, end)
        where = operating_point_of(model, start, end, notes[-1], imbalance(model, end)[0])
        where["run"] = standing_of(model, start)
        point.time = time
        space_queues(model, point, dt, np.array(point.ctrl))
        return point, notes, where
    return point, notes, None


def _keyframe(model: Any, keyframe: str | int) -> int:
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_KEY, k) or f"key[{k}]" for k in range(model.nkey)]
    if not names:
        raise ValueError(f"keyframe is {keyframe!r}, but the model has no keyframe")
    if isinstance(keyframe, str):
        if keyframe not in names:
            raise ValueError(f"keyframe is {keyframe!r}: {nearest(keyframe, names)}")
        return names.index(keyframe)
    if isinstance(keyframe, bool) or not isinstance(keyframe, (int, np.integer)):
        raise TypeError(f"keyframe must be a name or a number, not {type(keyframe).__name__}")
    if not 0 <= keyframe < len(names):
        raise ValueError(f"keyframe is {keyframe}; expected 0 to {len(names) - 1}")
    return int(keyframe)


def state_of(model: Any, data: Any) -> Array:
    state = np.empty(mujoco.mj_stateSize(model, INTEGRATION))
    mujoco.mj_getState(model, data, state, INTEGRATION)
    return state


def copy_of(model: Any, data: Any) -> Any:
    """Return new data with the same state, and without messages of instability."""
    own = silent_data(model)
    mujoco.mj_setState(model, own, state_of(model, data), INTEGRATION)
    return own


def silent_data(model: Any) -> Any:
    """Return new data without messages of instability: MuJoCo prints and logs only the first warning of a kind."""
    own = mujoco.MjData(model)
    for warning in own.warning:
        warning.number = 1
    return own


def has_warned(data: Any) -> bool:
    """Return whether silent data has had a warning."""
    return any(warning.number > 1 for warning in data.warning)


def space_queues(model: Any, data: Any, dt: float, values: Array | None = None) -> None:
    """Write the times of delayed commands as if the timestep had always been ``dt``, and values if they are given."""
    if not getattr(model, "nhistory", 0):
        return
    for k in range(number_of_actuators(model)):
        samples = int(model.actuator_history[k][0])
        if not samples:
            continue
        width = int(model.actuator_ctrlnum[k]) if hasattr(model, "actuator_ctrlnum") else 1
        first = int(model.actuator_ctrladr[k]) if hasattr(model, "actuator_ctrladr") else k
        address = int(model.actuator_historyadr[k])
        # A queue is: a number of the user, the place of the newest sample, times, and values.
        newest = int(data.history[address + 1])
        kept = data.history[address + 2 + samples : address + 2 + samples + samples * width].reshape(samples, width)
        kept = np.roll(kept, -(newest + 1), axis=0) if values is None else np.tile(values[first : first + width], (samples, 1))
        mujoco.mj_initCtrlHistory(model, data, k, data.time + dt * np.arange(-samples, 0.0), np.ascontiguousarray(kept))
