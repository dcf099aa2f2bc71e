"""Attributes of single environments, as vector environments tell them."""

from __future__ import annotations

import math
from typing import Any, Iterable

import numpy as np

from ._presets import Preset
from ._settings import TASK_OPTIONS, nearest, shown
from .environments import Environments
from .equations import EquationSystem

SETTABLE = "render_mode"
"""The attribute that may change after construction, with one value for all environments."""

_OF_ALL = ("num_envs", "autoreset_mode", "threads", "copy", "buffers")
_OF_PRESET = ("dt", "max_action", "start_position", "start_velocity")
_OF_TASK = TASK_OPTIONS


def keywords_of(envs: Environments) -> dict[str, Any]:
    """Return the keywords of each environment: those that were given, else their defaults. A caller may change lists and arrays."""
    system, given = envs._arguments
    unused: tuple[str, ...]
    found = {name: value for name, value in given.items() if name not in _OF_ALL}
    if isinstance(system, EquationSystem):
        unused, defaults = ("start_position", "start_velocity"), {"max_action": math.inf, **(system.summary["task"] or {})}
        found = {**system.parameters, **found}
    else:
        preset = envs.preset
        assert isinstance(preset, Preset)
        unused, defaults = _OF_TASK, {name: getattr(preset, name) for name in _OF_PRESET}
        found = {**({} if "m" in found else preset.parameters), **preset.costs, **found}
    for name in unused:
        found.pop(name, None)
    limit = envs._settings["limit"]
    defaults |= {"substeps": envs.substeps, "max_episode_steps": math.inf if limit is None else limit}
    found["max_episode_steps"] = None
    return {name: copied(defaults.get(name) if value is None else value) for name, value in found.items()}


def copied(value: Any) -> Any:
    """Return a value with copies of its lists, dictionaries and arrays."""
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, dict):
        return {key: copied(one) for key, one in value.items()}
    return type(value)(copied(one) for one in value) if type(value) in (list, tuple) else value


def unknown(name: str, known: Iterable[str]) -> AttributeError:
    """Return the error for an attribute that environments do not have."""
    return AttributeError(f"environments have no attribute {name!r}: {nearest(name, known)}")


def refused(name: str, value: Any, keywords: Iterable[str]) -> AttributeError:
    """Return the error for an attribute that cannot be set."""
    help = ""
    if name in keywords:
        help = f"; help: make other environments with {name}={shown(value)}"
    elif name == "state":
        help = "; help: reset() begins an episode from start values"
    return AttributeError(f"{name} of single environments cannot be set to {shown(value)}; expected {SETTABLE}{help}")
