"""Delays of MuJoCo actuators and sensors, as the simulator reads them step by step."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from .._keywords import check_keywords
from .._settings import count, positive
from .._settings import number as finite
from ._mujoco_names import name_of, number_of_actuators
from ._mujoco_point import model_of, space_queues

_INTERPOLATION = ("zoh", "linear", "cubic")


@dataclass(frozen=True)
class DelayRecord:
    """The delays of an actuator or sensor over the steps of a simulation."""

    name: str
    kind: str
    """``"actuator"`` or ``"sensor"``."""
    delay: float
    """The delay of the model in s."""
    samples: int
    """The length of its queue, ``nsample``."""
    interpolation: str
    """``"zoh"``, ``"linear"`` or ``"cubic"``."""
    nominal: float
    """The delay in steps by exact arithmetic, if the timestep divides it to 1e-9 or the queue is interpolated; the next whole number
    otherwise. At least 1, and at most the length of the queue."""
    steps: dict[float, int]
    """The number of steps for each delay that was read: in whole steps, and to a thousandth where the queue is interpolated. MuJoCo's cubic
    interpolation is not exact on a ramp beside the newest sample, where it reads another delay."""
    first: int | None
    """The first step at which the delay is not the nominal one; None if there is none. Steps count from 0 where the queue is full of
    commands of the simulation."""


@check_keywords
def delay_audit(model: Any, *, steps: int = 100_000, dt: float | None = None, time: float = 0.0) -> tuple[DelayRecord, ...]:
    """Return the delays in steps that MuJoCo uses for each delayed actuator and sensor.

    MuJoCo reads a queue by time: it compares ``time - delay`` with the times of its samples. ``time`` is a sum of rounded timesteps, so
    that a queue with more samples than the delay has steps is read one step late where the sum has been rounded up. The audit gives
    ramps to a model of sliders that has the same timestep, delays and queues; the dynamics of the model have no part in it.

    The delays of an audit (``report.delays`` of :func:`libration.probe`) are those of any simulator, and of commands only: a ramp is seen
    in the states after each step, so that they include all that delays a command, to a thousandth of a step, and need a command that acts on
    a state. This audit is for MuJoCo models only. It has sensors, actuators without effect on the states, models with more states than an
    audit may have, any starting time, and the delay that the model should have.

    Parameters
    ----------
    model:
        An ``MjModel``, or the path of an XML or MJB file.
    steps:
        Number of steps that are counted.
    dt:
        Timestep in s (default: that of the model).
    time:
        Time in s at which the simulation begins: the rounding of later times is coarser.

    Raises
    ------
    TypeError, ValueError
        For a file that does not compile, or an invalid number.
    """
    own, _ = model_of(model)
    number = count("steps", steps, 1, 100_000_000)
    timestep = positive("dt", own.opt.timestep if dt is None else dt)
    begin = finite("time", time, "finite")
    queues = _queues(own)
    if not queues:
        return ()
    copy = mujoco.MjModel.from_xml_string(_xml(queues))
    copy.opt.timestep = timestep
    for k, queue in enumerate(q for q in queues if q[1] == "actuator"):
        copy.actuator_delay[k] = queue[2]
    for k, queue in enumerate(q for q in queues if q[1] == "sensor"):
        copy.sensor_delay[k] = queue[2]
    data = mujoco.MjData(copy)
    data.time = begin
    space_queues(copy, data, timestep, np.zeros(copy.nu))
    for k in range(copy.nsensor):
        samples = int(copy.sensor_history[k][0])
        before = data.time + timestep * np.arange(-samples, 0.0)
        mujoco.mj_initSensorHistory(copy, data, k, before, np.zeros((samples, 1)), 0.0)
    longest = max(queue[3] for queue in queues)
    found: list[Counter[float]] = [Counter() for _ in queues]
    first: list[int | None] = [None] * len(queues)
    nominal = [_nominal(delay, timestep, samples, interp > 0) for _, _, delay, samples, interp in queues]
    times = np.full(longest + 2, np.nan)
    for k in range(number + longest + 1):
        times[k % len(times)] = data.time
        data.ctrl[:] = k
        mujoco.mj_step(copy, data)
        if k <= longest:
            continue
        for i, value in enumerate((*data.actuator_force, *data.sensordata)):
            late = k - value if i < copy.nu else (times[k % len(times)] - value) / timestep
            delay = round(float(late), 3 if queues[i][4] else 0)
            found[i][delay] += 1
            if delay != round(nominal[i], 3) and first[i] is None:
                first[i] = k - longest - 1
    return tuple(
        DelayRecord(name, kind, delay, samples, _INTERPOLATION[interp], nominal[i], dict(sorted(found[i].items())), first[i])
        for i, (name, kind, delay, samples, interp) in enumerate(queues)
    )


def _queues(model: Any) -> list[tuple[str, str, float, int, int]]:
    """Return name, kind, delay, samples and interpolation of what is delayed, actuators first."""
    found = []
    for kind, number in (("actuator", number_of_actuators(model)), ("sensor", model.nsensor)):
        for k in range(number if hasattr(model, f"{kind}_delay") else 0):
            if (delay := float(getattr(model, f"{kind}_delay")[k])) > 0:
                samples, interp = (int(value) for value in getattr(model, f"{kind}_history")[k])
                found.append((name_of(model, kind, k), kind, delay, samples, interp))
    return found


def _xml(queues: list[tuple[str, str, float, int, int]]) -> str:
    """Return a model of sliders without force, with the same queues; sensors are clocks."""
    parts: dict[str, list[str]] = {"body": [], "actuator": [], "sensor": []}
    for k, (_, kind, delay, samples, interp) in enumerate(queues):
        queue = f'delay="{delay!r}" nsample="{samples}" interp="{_INTERPOLATION[interp]}"'
        if kind == "actuator":
            parts["body"].append(f'<body><joint name="j{k}" type="slide"/><geom size="0.1" contype="0" conaffinity="0"/></body>')
            parts["actuator"].append(f'<general joint="j{k}" gear="0" gainprm="1" {queue}/>')
        else:
            parts["sensor"].append(f"<clock {queue}/>")
    text = {name: "".join(rows) for name, rows in parts.items()}
    return (
        f'<mujoco><option gravity="0 0 0"/><worldbody>{text["body"]}</worldbody>'
        f"<actuator>{text['actuator']}</actuator><sensor>{text['sensor']}</sensor></mujoco>"
    )


def _nominal(delay: float, dt: float, samples: int, is_interpolated: bool) -> float:
    exact = delay / dt
    is_whole = abs(exact - round(exact)) <= 1e-9 * max(1.0, exact)
    found = float(round(exact)) if is_whole else exact if is_interpolated else float(np.ceil(exact))
    return max(1.0, min(found, float(samples)))
