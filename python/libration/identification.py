"""Dead time, lag, gain and noise of a real loop, from a recording of its commands and responses."""

from __future__ import annotations

import json
import math
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._json import json_text
from ._keywords import check_keywords
from ._settings import count, number, positive
from ._step_functions import vector
from ._toml import text_of

__all__ = ["Identification", "identify"]

# Delays of environments are rounded to this part of a step.
_PARTS = 4


class Identification:
    """What a recording tells of a loop; :attr:`results` has all numbers under the keys of ``libration identify --json``.

    Environments take it as a range of delays: ``libration.VectorEnv(…, action_delay=identified)``.
    """

    def __init__(self, results: dict[str, Any], loop_file: str | None, page: str) -> None:
        self.results = results
        self._loop_file = loop_file
        self._page = page

    def __repr__(self) -> str:
        return f"<Identification: {self.answer}>"

    @property
    def answer(self) -> str:
        """The answer in a few sentences."""
        return str(self.results["answer"])

    @property
    def verdict(self) -> dict[str, Any]:
        """Whether the residuals contradict the model: ``outcome`` (``"no-fault"``, ``"fault"``, ``"unknown"``), ``evidence``, and what was
        ``not_examined``."""
        return dict(self.results["verdict"])

    @property
    def warnings(self) -> list[str]:
        """What restricts the answer."""
        return [str(warning) for warning in self.results["warnings"]]

    @property
    def is_contradicted(self) -> bool:
        """Whether the residuals contradict the model, so that its intervals cannot be trusted."""
        return bool(self.results["is_contradicted"])

    @property
    def parameters(self) -> dict[str, float]:
        """The estimates by key: ``dead_time`` and ``lag`` in s, ``gain``, ``noise_std``, …"""
        return {row["key"]: float(row["value"]) for row in self.results["parameters"]}

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """The 95 % intervals by key; infinite ends where the recording excludes nothing. Empty if the verdict is not ``no-fault``."""
        return {
            row["key"]: (float(row["interval"]["low"]), _end(row["interval"]["high"]))
            for row in self.results["parameters"]
            if row["interval"] is not None
        }

    @property
    def dead_time(self) -> float:
        """The dead time in s; the shorter one of two."""
        return self.parameters["dead_time"]

    @property
    def lag(self) -> float | None:
        """The time constant of the lag in s; None without one."""
        return self.parameters.get("lag")

    @property
    def gain(self) -> float:
        """The gain: units of the response per unit of the command."""
        return self.parameters["gain"]

    @property
    def delay_range(self) -> tuple[float, float]:
        """The dead times that commands may have, in s: the interval of the dead time, with two standard deviations of jitter and the longer
        of two dead times."""
        found = self.results["delay_range"]
        if found is None:
            verdict = self.results["verdict"]
            why = "the recording excludes no long dead time"
            if verdict["outcome"] != "no-fault":
                why = f"the verdict is {verdict['outcome']}: {verdict['evidence']}"
            raise ValueError(f"{why}; help: give the range of action_delay in s")
        low, high = found
        return float(low), float(high)

    def action_delay(self, dt: float, substeps: int | None = None) -> tuple[float, float]:
        """Return :attr:`delay_range` rounded outwards to steps of an environment, in s.

        Parameters
        ----------
        dt:
            The step of the environment in s.
        substeps:
            Steps of the integrator in each step (default: delays are quarters of a step).
        """
        step = positive("dt", dt) / (_PARTS if substeps is None else count("substeps", substeps, 1, 1_000_000))
        low, high = self.delay_range
        # A rounding of a whole number of steps is that number.
        first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
        return first * step, max(first, last) * step

    def save_loop(self, path: str | PathLike[str]) -> None:
        """Write the loop as a file of ``libration advise --config``; fails where the dead time is unknown."""
        if self._loop_file is None:
            raise ValueError(f"there is no loop to save: {self.results['verdict']['evidence']}")
        Path(path).write_text(self._loop_file, encoding="utf-8")

    def save(self, path: str | PathLike[str]) -> None:
        """Write the HTML page, or with the suffix ``.json`` all numbers; one that is not finite is null."""
        text = json_text(self.results) if str(path).endswith(".json") else self._page
        Path(path).write_text(text, encoding="utf-8")


@check_keywords
def identify(
    t: ArrayLike,
    u: ArrayLike,
    y: ArrayLike,
    *,
    response_time: ArrayLike | None = None,
    model: str = "auto",
    noise: str = "auto",
    hold: str = "auto",
    plant: Any = None,
    dead_time: float | None = None,
    lag: float | None = None,
    gain: float | None = None,
    largest_dead_time: float | None = None,
    start: str = "auto",
    command_before: float | None = None,
    budget: int | None = None,
    random_arrivals: bool = True,
    bootstrap: int = 100,
    seed: int = 0,
) -> Identification:
    """Identify dead time, lag, gain and noise of a loop from its commands and responses.

    Parameters
    ----------
    t:
        Times of the commands in s, not decreasing.
    u:
        The commands.
    y:
        The responses.
    response_time:
        Times of the responses in s, by the same clock (default: ``t``).
    model:
        ``"delay"``, ``"lag"``, ``"second-order"``, ``"integrated-lag"``, or ``"auto"`` for the best of them.
    noise:
        ``"white"``, ``"coloured"``, ``"disturbance"``, or ``"auto"``.
    hold:
        What the receiver makes of commands between their times: ``"zero"``, ``"linear"``, or ``"auto"``.
    plant:
        A known plant that the command drives through a lag: a file of ``libration advise --plant``, or its keys as a dictionary.
    dead_time, lag, gain:
        Those that are known.
    largest_dead_time:
        The largest dead time to try in s (default: an eighth of the recording, up to 1 s or 50 responses).
    start:
        What is assumed before the first response: ``"rest"``, ``"held"`` (the first command acts, and the loop moves), ``"unknown"``, or
        ``"auto"``: rest if the recording begins with a long hold of the command, or has nearly all of a few changes early, unless the responses
        contradict it.
    command_before:
        The command before the recording (default: the first one).
    budget:
        Most evaluations of the likelihood in the search of a model (default: 1000 to 20,000, fewer for long recordings).
    random_arrivals:
        Whether losses, jitter and two dead times are looked for.
    bootstrap:
        Number of simulated recordings that check the intervals; 0 for none.
    seed:
        Seed of the simulated recordings.

    Raises
    ------
    TypeError, ValueError
        For an invalid value; the message has the name and what is allowed.
    """
    times = vector("t", t)
    arrays = (times, vector("u", u), times if response_time is None else vector("response_time", response_time), vector("y", y))
    for name, (first, second) in {"u": (0, 1), "y": (2, 3)}.items():
        if arrays[first].shape != arrays[second].shape:
            of = "t" if first == 0 or response_time is None else "response_time"
            raise ValueError(f"{name} has {arrays[second].size} values; expected {arrays[first].size}, one for each time of {of}")
    options: dict[str, Any] = {
        "bootstrap": count("bootstrap", bootstrap, 0, 10_000),
        "seed": count("seed", seed, 0, 2**64 - 1),
        "random_arrivals": bool(random_arrivals),
    }
    for name, text in (("model", model), ("noise", noise), ("hold", hold), ("start", start)):
        if not isinstance(text, str):
            raise TypeError(f"{name} must be a string, not {type(text).__name__}")
        options[name] = text
    given = (("dead_time", dead_time), ("lag", lag), ("gain", gain), ("largest_dead_time", largest_dead_time), ("command_before", command_before))
    for name, value in given:
        if value is not None:
            options[name] = number(name, value, "finite")
    if budget is not None:
        options["budget"] = count("budget", budget, 100, 1_000_000_000)
    if plant is not None:
        options["plant"] = text_of("plant", plant)
    contiguous = [np.ascontiguousarray(array) for array in arrays]
    answer, loop_file, page = _native._identify(contiguous, json.dumps(options))
    return Identification(json.loads(answer), loop_file, page)


def _end(value: float | None) -> float:
    return math.inf if value is None else float(value)
