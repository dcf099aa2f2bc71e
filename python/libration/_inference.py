"""The time that a policy takes to answer, drawn for every action."""

from __future__ import annotations

import math
import numbers
import warnings
from dataclasses import dataclass
from typing import Any, Mapping

from ._episode_numbers import Request, episode_number
from ._settings import (
    MANY_SUBSTEPS,
    MOST_SUBSTEPS,
    common,
    delays,
    ends,
    equal_steps,
    inner_count,
    nearest,
    number,
    positive,
    shown,
    warn_of,
)
from .perturbations import LogNormal, LogUniform, Uniform

MODES = ("asynchronous", "synchronous")
"""What a system does until the answer arrives: goes on with its step under the action before, or waits before it."""

_PARTS = 8
"""Steps of the integrator in the mean of answers, where the caller does not choose: rounding them moves each by a sixteenth of it at most."""


@dataclass(frozen=True)
class Inference:
    """The time of an answer in the format of the engine."""

    law: Request
    mean: float
    largest: float
    """The largest number that is drawn, in s."""
    waits: bool
    """Whether the system waits for the answer."""

    @property
    def is_latency(self) -> bool:
        """Whether all answers take the same time and the system does not wait: a latency."""
        low, high = self.law[1]
        return not self.waits and self.law[0] == "uniform" and low == high


def inference_of(value: Any, mode: Any) -> Inference | None:
    """Return the times of answers; None for no time.

    Raises
    ------
    TypeError, ValueError
        With the name of the keyword, its value and what is allowed.
    """
    if not isinstance(mode, str) or mode not in MODES:
        raise ValueError(f"inference_mode is {shown(mode)}: {nearest(str(mode), MODES)}")
    if value is None:
        if mode != "asynchronous":
            raise TypeError(f"inference_mode is {mode!r}, but inference is not given: the time of an answer in s")
        return None
    waits = mode == "synchronous"
    if isinstance(value, LogNormal):
        return Inference(("lognormal", [value.mean, value.std]), value.mean, value.mean + 8 * value.std, waits)
    if isinstance(value, (Uniform, LogUniform)):
        kind, [low, high] = episode_number("inference", value, 1, "finite and at least 0", lambda x: 0 <= x < math.inf)
        mean = (low + high) / 2 if kind == "uniform" or low == high else (high - low) / math.log(high / low)
        return Inference((kind, [low, high]), mean, high, waits)
    if not isinstance(value, numbers.Real) and getattr(value, "shape", None) != ():
        raise TypeError(
            f"inference is {value!r}, but it must be a number in s, ('lognormal', mean, std), LogNormal(mean, std), Uniform(low, high) or "
            "LogUniform(low, high)"
        )
    seconds = number("inference", value, "finite and at least 0", lambda x: 0 <= x < math.inf)
    return Inference(("uniform", [seconds, seconds]), seconds, seconds, waits)


def with_inference(given: Mapping[str, Any], inference: Inference, period: float | None, used: int) -> dict[str, Any]:
    """Return the keywords of environments, with the number of substeps that times of answers require.

    The same time for all answers is a latency. ``period`` is that of an inner controller, and ``used`` the number of used actions of a chunk.
    """
    dt, asked = positive("dt", given["dt"]), given["substeps"]
    if hasattr(given["action_delay"], "action_delay"):
        raise TypeError("action_delay is an identified loop, but with inference it must be a number in s or a pair")
    late = {name: ends(name, given[name], least=0.0) for name in ("action_delay", "observation_delay")}
    if inference.waits:
        for name, (_, most) in late.items():
            if most > 0:
                raise ValueError(f"{name} is {most!r} s, but with inference_mode='synchronous' it must be 0")
        return dict(given)
    if inference.is_latency:
        return {**given, "action_delay": tuple(x + inference.mean for x in late["action_delay"])}
    if asked is None:
        periods = inner_count(dt, period, None, used)
        least = min(MANY_SUBSTEPS * used, math.ceil(_PARTS * dt / inference.mean)) if inference.mean > 0 else 1
        tried = range(math.ceil(least / periods) * periods, MOST_SUBSTEPS + 1, periods)
        found = equal_steps(dt, tried, late)
        # Steps of different lengths have no place for times that are rounded: latencies that no number of equal steps serves are refused.
        asked = delays(dt, None, late, periods)[0] if found is None else found[0]
        if asked > max(MANY_SUBSTEPS * used, periods):
            warn_of(asked, dt, late)
    return {**given, "substeps": asked}


def common_with(given: dict[str, Any], inference: Inference | None, period: float | None, used: int) -> dict[str, Any]:
    """Return the settings that environments of all systems have, with ``answers``, the times of answers in the format of the engine.

    Raises
    ------
    TypeError, ValueError
        As :func:`libration._settings.common`, and for answers that take longer than the engine keeps.
    """
    if inference is None:
        return {**common(given, period, used), "answers": None}
    stated = with_inference(given, inference, period, used)
    try:
        settings = common(stated, period, used)
    except ValueError as error:
        if not inference.is_latency or not str(error).startswith("action_delay"):
            raise
        name = "inference" if given["action_delay"] == 0.0 else "action_delay and inference"
        raise ValueError(f"{name}{str(error).removeprefix('action_delay')}") from None
    if inference.is_latency:
        return {**settings, "answers": None}
    steps = inference.largest / settings["dt"]
    if not steps + settings["action_delay"][1] < 4096:
        raise ValueError(
            f"inference takes up to {inference.largest:.6g} s, which is {steps:.6g} steps of {settings['dt']:g} s, but it must be at most "
            f"{4095 - settings['action_delay'][1]} of them"
        )
    if inference.waits:
        return {**settings, "answers": (inference.law, max(1, math.ceil(steps))), "mean_wait": inference.mean}
    if settings["dt"] > inference.mean > 0:
        warnings.warn(
            f"inference has a mean of {inference.mean:.6g} s, but its times are rounded to steps of {settings['dt']:.6g} s; help: more substeps",
            stacklevel=2,
        )
    return {**settings, "answers": (inference.law, 0)}
