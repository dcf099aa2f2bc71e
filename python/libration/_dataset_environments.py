"""Environments of data sets, from the settings in their manifests."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any, Mapping

from ._presets import PRESETS
from .equations import EquationSystem

_COSTS = {"position": "position_cost", "velocity": "velocity_cost", "effort": "effort_cost", "bound": "bound"}
_FLOATS = {"f32": "float32", "f64": "float64"}
# Bytes of the settings: some thousand, and the text of a system by equations.
_LONGEST_LINE = 1 << 24


def read_settings(folder: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the settings in the manifest of a data set.

    Raises
    ------
    ValueError
        If the folder has no data set.
    """
    path = Path(folder) / "manifest.jsonl"
    try:
        if not path.is_file():
            # To open a named pipe waits for its writer.
            raise ValueError(f"{path.name} is no file")
        with open(path, "rb") as file:
            line = file.readline(_LONGEST_LINE + 1)
        if len(line) > _LONGEST_LINE:
            raise ValueError(f"the first line of {path.name} is longer than {_LONGEST_LINE} bytes")
        settings = json.loads(line.decode("utf-8"))["data"]
        if not isinstance(settings, dict):
            raise ValueError(f"the settings are a {type(settings).__name__}")
        return settings
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise ValueError(f"{os.fspath(folder)!r} has no data set ({error}); expected a folder that datasets.write has written") from None


def keywords_of_settings(settings: Mapping[str, Any]) -> tuple[str | EquationSystem, dict[str, Any]]:
    """Return the environment of the settings of a manifest: its name or system, and the keywords of :class:`libration.Environments`.

    Raises
    ------
    ValueError
        For a system of the catalogue with a task that no environment of the package has, and for settings of another form.
    """
    try:
        return _keywords(settings)
    except (KeyError, TypeError, AttributeError, IndexError, ArithmeticError, RecursionError) as error:
        raise ValueError(f"the data set has settings of another form ({type(error).__name__}: {error}); expected those of datasets.write") from None


def _keywords(settings: Mapping[str, Any]) -> tuple[str | EquationSystem, dict[str, Any]]:
    [(system, parameters)], [(task, numbers)] = settings["system"].items(), settings["task"].items()
    dt, substeps, delays, noise = settings["dt"], settings["substeps"], settings["delays"], settings["noise"]
    keywords: dict[str, Any] = {
        "integrator": settings["integrator"],
        "dt": _period(dt, substeps),
        "substeps": substeps,
        "dtype": _FLOATS.get(settings["dtype"], settings["dtype"]),
        **{f"{name}_delay": tuple(delays[name]) for name in ("observation", "action")},
        **{name: noise[name] for name in ("jitter", "skew")},
        "observation_noise": noise["observation"],
    }
    if system == "equations":
        most = parameters["max_action"]
        keywords["max_action"] = [float(x) for x in most] if isinstance(most, list) else float(most)
        given = [(name, float(value)) for name, value in parameters["parameters"].items()]
        return EquationSystem._again(parameters["text"], "text", given), {**keywords, **numbers}
    names = [preset.name for preset in PRESETS.values() if (preset.system, preset.task) == (system, task)]
    if not names:
        known = ", ".join(f"{preset.system!r} with {preset.task!r}" for preset in PRESETS.values())
        raise ValueError(f"the data set has the system {system!r} with the task {task!r}; expected {known}, or a system by equations")
    keywords |= {name: float(value) for name, value in parameters.items()}
    keywords |= {_COSTS[name]: float(value) for name, value in numbers.items()}
    start = {"start_position": settings["start"]["q"], "start_velocity": settings["start"]["v"]}
    return names[0], {**keywords, **start, "max_action": math.inf}


def _period(dt: float, substeps: int) -> float:
    """Return the time between two actions whose quotient by ``substeps`` is ``dt``, bit for bit, if there is one."""
    product = dt * substeps
    for period in (product, math.nextafter(product, math.inf), math.nextafter(product, 0.0)):
        if period / substeps == dt:
            return period
    return product
