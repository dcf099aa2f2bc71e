"""Environments of systems by equations: settings, and what is known of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Mapping, Sequence

import numpy as np

from ._native import Batch
from ._episode_numbers import Request, check_float_type, each, episode_number, largest_command_names, largest_commands, scaled_law
from ._inference import common_with, inference_of
from ._settings import OPTIONS, count, is_several, law, refuse_others
from ._task_requests import TaskRequest, task_request
from .equations import EquationSystem

SMALLEST_OPTIONS = [name for name in OPTIONS if name not in ("start_position", "start_velocity")]
_ARGUMENTS = {*OPTIONS, "name", "self", "system"}
"""Names that no parameter of the system of an environment can have, since the environment takes them."""
_MOST_VARIED = 64
"""Most numbers of an environment that vary: parameters, and the largest command of each action if one of them varies."""


@dataclass(frozen=True)
class EquationPreset:
    """What environments of a system are called and show."""

    name: str
    seen: tuple[str, ...]
    """Expressions of the observed numbers."""
    actions: tuple[str, ...]
    """Names of the inputs."""
    levels: tuple[float, ...] = ()
    """Commands of discrete actions."""

    @property
    def limits(self) -> tuple[float, ...]:
        """Largest magnitude of each number that is observed without noise."""
        return tuple(1.0 if _is_bounded(text) else math.inf for text in self.seen)


def _is_bounded(expression: str) -> bool:
    """Whether an expression is a sine or a cosine and nothing else."""
    head, _, rest = expression.strip().lstrip("-").partition("(")
    return head.strip() in ("sin", "cos") and rest.endswith(")") and ")" not in rest[:-1]


def native_equations(
    system: EquationSystem, given: dict[str, Any]
) -> tuple[EquationPreset, dict[str, Any]]:
    """Return settings of environments of a system in the format of the engine.

    Raises
    ------
    TypeError, ValueError
        For the first invalid keyword; the message has its name, its value and the allowed values.
    """
    parameters = given["parameters"]
    _check_parameter_names(system)
    refuse_others(parameters, system.parameters, [*SMALLEST_OPTIONS, *system.parameters])
    _check_system(system, given)
    task = task_request(system, given)
    num_envs = count("num_envs", given["num_envs"], 1, 2**40)
    varied, constants = _episode_numbers(parameters, num_envs)
    jitter, clock = scaled_law("jitter", given["jitter"])
    noise, sensor = scaled_law("observation_noise", given["observation_noise"])
    limit = math.inf if given["max_episode_steps"] is None else given["max_episode_steps"]
    # A step of the environment takes all used actions of a chunk.
    dt = given["dt"] if task.used == 1 else given["dt"] * task.used
    inference = inference_of(given["inference"], given["inference_mode"])
    settings = common_with({**given, "dt": dt, "jitter": jitter, "max_episode_steps": limit}, inference, task.inner_period, task.used)
    if clock[0] != clock[1] and settings["skew"][1] > 0:
        raise ValueError(f"skew is {given['skew']!r}, but it must be 0 where each episode draws its jitter")
    settings["levels"] = list(task.levels)
    saturation = _saturation(given["max_action"], task, num_envs)
    for name, value in {**system.parameters, **constants}.items():
        if name not in varied:
            check_float_type(name, ("constant", [value]), settings["dtype"])
    _check_varied(varied, saturation, settings["dtype"])
    _check_command_names(varied, saturation, task.actions)
    settings["subject"] = {
        "equations": (system.replace(**constants) if constants else system)._text,
        "task": task.text,
        "varied": list(varied.items()),
        "saturation": saturation,
        "noise": [law("observation_noise", x) for x in _each_law(noise, len(task.observed))],
        "error_scale": [clock, sensor],
        "lengths": settings["lengths"],
        "answers": settings["answers"],
    }
    if task.controller_text is not None:
        _check_controller(task, settings)
    return EquationPreset(system.name, task.observed, task.actions, task.levels), settings


def _check_controller(task: TaskRequest, settings: Mapping[str, Any]) -> None:
    """Let the engine check an inner controller with the names of the caller, as without a chunk."""
    subject = dict(settings["subject"])
    subject["task"] = task.controller_text
    subject["saturation"] = [("constant", [math.inf])] * (len(task.actions) // task.length)
    # One environment has one of the numbers of all.
    subject["varied"] = [(name, ("constant", values[:1]) if kind == "each" else (kind, values)) for name, (kind, values) in subject["varied"]]
    Batch()._set_up({**settings, "num_envs": 1, "threads": 1, "subject": subject}, 0)


def _check_system(system: EquationSystem, given: Mapping[str, Any]) -> None:
    """Check that a system makes environments with these keywords."""
    for name in ("start_position", "start_velocity"):
        if given[name] is not None:
            raise TypeError(f"{name} belongs to environments of the catalogue; help: start={{{system.states[0]!r}: (-1, 1)}}")
    if not system.inputs:
        raise ValueError(f"the system {system.name!r} has no inputs, but actions need at least one: inputs=['u']")
    if given["dt"] is None:
        raise TypeError("dt is required: the time between two actions in s")


def _episode_numbers(parameters: Mapping[str, Any], num_envs: int) -> tuple[dict[str, Request], dict[str, float]]:
    """Return the parameters that vary, and the values of the others."""
    numbers = {name: episode_number(name, value, num_envs) for name, value in parameters.items()}
    varied = {name: number for name, number in numbers.items() if number[0] != "constant"}
    for name in varied:
        if name.startswith("_"):
            raise ValueError(
                f"the parameter {name!r} varies, but Gymnasium's infos take names that begin with '_' for masks; "
                f"help: give the parameter another name, such as '{name.lstrip('_') or 'p'}'"
            )
    return varied, {name: values[0] for name, (_, values) in numbers.items() if name not in varied}


def _saturation(most: Any, task: TaskRequest, num_envs: int) -> list[Request]:
    """Return the largest command of each action."""
    if task.levels and most is not None and not (np.ndim(most) == 0 and most == math.inf):
        raise TypeError("max_action is given, but discrete actions have commands of their own")
    commands = largest_commands(most, len(task.actions) // task.length, num_envs)
    if task.length > 1 and any(kind not in ("constant", "each") for kind, _ in commands):
        raise ValueError(f"max_action is {most!r}, but with a chunk it must be a number or one for each environment")
    return commands * task.length


def _check_varied(varied: Mapping[str, Request], saturation: Sequence[Request], dtype: str) -> None:
    """Check how many numbers vary, and that they have their values in the float type."""
    commands = len(saturation) if any(kind != "constant" for kind, _ in saturation) else 0
    if (found := len(varied) + commands) > _MOST_VARIED:
        raise ValueError(
            f"{found} numbers vary, {len(varied)} parameters and {commands} largest actions, but it must be at most {_MOST_VARIED}; "
            "help: give some of them one number for all environments"
        )
    for name, request in varied.items():
        check_float_type(name, request, dtype)
    for request in saturation:
        check_float_type("max_action", request, dtype, "greater than 0", lambda x: x > 0)


def _check_command_names(varied: Mapping[str, Request], saturation: Sequence[Request], actions: Sequence[str]) -> None:
    """Check that no parameter that varies has the name under which infos have a largest command."""
    for name in largest_command_names(saturation, actions):
        if name in varied:
            raise ValueError(
                f"the parameter {name!r} varies, but infos have the largest action of {name.removeprefix('max_action_')!r} under this name; "
                f"help: give the parameter another name, such as '{name}_'"
            )


def _check_parameter_names(system: EquationSystem) -> None:
    for name in system.parameters:
        if name in _ARGUMENTS:
            raise ValueError(
                f"the system {system.name!r} has a parameter {name!r}, but {name!r} is a keyword of environments; "
                f"help: give the parameter another name, such as '{name}_'"
            )


def _each_law(value: Any, length: int) -> Sequence[Any]:
    """Return a law for each observed number."""
    if is_several(value) and value and not isinstance(value[0], str):
        return each("observation_noise", value, length)
    return [value] * length
