"""The time that a policy takes to answer, drawn for every action."""

from __future__ import annotations

import math
import numbers
from dataclasses import dataclass
from typing import Any, Mapping

from ._episode_numbers import Request, episode_number
from ._settings import MANY_SUBSTEPS, MOST_SUBSTEPS, ends, equal_steps, inner_count, nearest, number, positive
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


def inference_of(value: Any, mode: Any) -> Inference | None:
    """Return the times of answers; None for no time.

    Raises
    ------
    TypeError, ValueError
        With the name of the keyword, its value and what is allowed.
    """
    if mode not in MODES:
        raise ValueError(f"inference_mode is {mode!r}: {nearest(str(mode), MODES)}")
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
    low, high = inference.law[1]
    if inference.law[0] == "uniform" and low == high:
        return {**given, "action_delay": tuple(x + low for x in late["action_delay"])}
    if asked is None:
        periods = inner_count(dt, period, None, used)
        least = min(MANY_SUBSTEPS, math.ceil(_PARTS * dt / inference.mean)) if inference.mean > 0 else 1
        tried = range(math.ceil(least / periods) * periods, MOST_SUBSTEPS + 1, periods)
        found = equal_steps(dt, tried, late)
        # Latencies that no number of steps serves are told with the others.
        asked = None if found is None else found[0]
    return {**given, "substeps": asked}


def native_answers(inference: Inference, settings: dict[str, Any]) -> tuple[Request, int] | None:
    """Return times of answers in the format of the engine; those of a system that waits lengthen its steps in ``settings``.

    Raises
    ------
    ValueError
        For answers that take longer than the engine keeps.
    """
    low, high = inference.law[1]
    if not inference.waits and inference.law[0] == "uniform" and low == high:
        return None
    steps = inference.largest / settings["dt"]
    if not steps < 4096:
        raise ValueError(
            f"inference takes up to {inference.largest:.6g} s, which is {steps:.6g} steps of {settings['dt']:g} s, but it must be at most "
            "4096 of them"
        )
    waits = 0
    if inference.waits:
        # No step of waiting is longer than one of the integrator.
        waits = max(1, math.ceil(steps))
        settings["substeps"] += waits
        settings["action_delay"] = [waits, waits]
    return inference.law, waits
