"""Environments of systems by equations: settings, and what is known of them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any, Mapping, Sequence

import numpy as np

from ._episode_numbers import Request, check_float_type, each, episode_number, largest_commands, scaled_law
from ._settings import OPTIONS, TASK_OPTIONS, common, count, ends, inner_count, is_several, law, number, positive, refuse_others
from ._toml import text_of
from .equations import EquationSystem
from .perturbations import PD

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
    given = dict(given)
    parameters = given.pop("parameters")
    _check_parameter_names(system)
    refuse_others(parameters, system.parameters, [*SMALLEST_OPTIONS, *system.parameters])
    for name in ("start_position", "start_velocity"):
        if given[name] is not None:
            raise TypeError(f"{name} belongs to environments of the catalogue; help: start={{{system.states[0]!r}: (-1, 1)}}")
    if not system.inputs:
        raise ValueError(f"the system {system.name!r} has no inputs, but actions need at least one: inputs=['u']")
    if given["dt"] is None:
        raise TypeError("dt is required: the time between two actions in s")
    task = {name: given.pop(name) for name in TASK_OPTIONS}
    own = system.summary["task"]
    text = None
    if isinstance(task["inner"], PD):
        task |= _pd_targets(system, task["inner"], task["targets"])
    inner = task["inner"] if task["inner"] is not None else own["inner"] if own else {}
    if not isinstance(inner, Mapping):
        raise TypeError(f"inner must be a dictionary, not {type(inner).__name__}")
    period = task["inner_period"] if task["inner_period"] is not None or not own else own["inner_period"]
    if inner and period is None:
        raise TypeError("inner_period is required with inner: the time in s between samples of the controller")
    chunk, used, length = given.pop("chunk"), 1, 1
    if chunk is not None:
        if not inner and task["inner_period"] is not None:
            raise TypeError("inner_period is given, but it belongs to an inner controller")
        dt = positive("dt", given["dt"])
        task |= _chunk(system, chunk, task, own, dt)
        # That of the file is of a controller that the caller replaced.
        own = {**own, "inner_period": None} if own and not inner else own
        inner_count(dt, period if inner else None, None)
        length, used = chunk
        given["dt"] = dt * used
    if any(value is not None for value in task.values()):
        text = _task(system, task, own)
    seen, levels = (own["observe"], own["actions"]) if own else (list(system.states), [])
    seen = list(task["observe"]) if task["observe"] is not None else seen
    levels = [float(x) for x in task["actions"]] if task["actions"] is not None else levels
    targets = task["targets"] if task["targets"] is not None else own["targets"] if own else []
    actions = tuple(targets) if targets else system.inputs
    given["max_episode_steps"] = math.inf if given["max_episode_steps"] is None else given["max_episode_steps"]
    num_envs = count("num_envs", given["num_envs"], 1, 2**40)
    numbers = {name: episode_number(name, value, num_envs) for name, value in parameters.items()}
    varied = {name: number for name, number in numbers.items() if number[0] != "constant"}
    _check_varied_names(varied)
    constants = {name: values[0] for name, (_, values) in numbers.items() if name not in varied}
    given["jitter"], clock = scaled_law("jitter", given["jitter"])
    given["observation_noise"], sensor = scaled_law("observation_noise", given["observation_noise"])
    settings = common(given, period if inner else None, used)
    if clock[0] != clock[1] and settings["skew"][1] > 0:
        raise ValueError(f"skew is {given['skew']!r}, but it must be 0 where each episode draws its jitter")
    if levels and given["max_action"] is not None and not (np.ndim(given["max_action"]) == 0 and given["max_action"] == math.inf):
        raise TypeError("max_action is given, but discrete actions have commands of their own")
    settings["levels"] = levels
    saturation = _of_each_time(largest_commands(given["max_action"], len(actions) // length, num_envs), length, given["max_action"])
    _check_varied_count(varied, saturation)
    for name, request in varied.items():
        check_float_type(name, request, settings["dtype"])
    for request in saturation:
        check_float_type("max_action", request, settings["dtype"], "greater than 0", lambda x: x > 0)
    settings["subject"] = {
        "equations": (system.replace(**constants) if constants else system)._text,
        "task": text,
        "varied": list(varied.items()),
        "saturation": saturation,
        "noise": [law("observation_noise", x) for x in _each_law(given["observation_noise"], len(seen))],
        "error_scale": [clock, sensor],
        "lengths": settings["lengths"],
    }
    return EquationPreset(system.name, tuple(seen), actions, tuple(levels)), settings


def _check_parameter_names(system: EquationSystem) -> None:
    for name in system.parameters:
        if name in _ARGUMENTS:
            raise ValueError(
                f"the system {system.name!r} has a parameter {name!r}, but {name!r} is a keyword of environments; "
                f"help: give the parameter another name, such as '{name}_'"
            )


def _check_varied_names(varied: Mapping[str, Request]) -> None:
    for name in varied:
        if name.startswith("_"):
            raise ValueError(
                f"the parameter {name!r} varies, but Gymnasium's infos take names that begin with '_' for masks; "
                f"help: give the parameter another name, such as '{name.lstrip('_') or 'p'}'"
            )


def _check_varied_count(varied: Mapping[str, Request], saturation: Sequence[Request]) -> None:
    commands = len(saturation) if any(kind != "constant" for kind, _ in saturation) else 0
    if (found := len(varied) + commands) > _MOST_VARIED:
        raise ValueError(
            f"{found} numbers vary, {len(varied)} parameters and {commands} largest actions, but it must be at most {_MOST_VARIED}; "
            "help: give some of them one number for all environments"
        )


def _pd_targets(system: EquationSystem, gains: PD, targets: Sequence[str] | None) -> dict[str, Any]:
    """Return the keys of a task whose actions are targets of a PD controller of each coordinate."""
    coordinates = [name for name in system.states if f"{name}'" in system.states]
    if len(coordinates) != len(system.inputs):
        raise ValueError(
            f"inner is {gains!r}, but it must be a dictionary of expressions: the system has {len(coordinates)} coordinates and "
            f"{len(system.inputs)} inputs"
        )
    stiffness, damping = (number(f"{name} of inner", x, "finite") for name, x in (("kp", gains.kp), ("kd", gains.kd)))
    targets = [f"target_{name}" for name in coordinates] if targets is None else targets
    if len(targets) != len(coordinates):
        raise ValueError(f"targets is {targets!r}, but it must have a name for each coordinate: {', '.join(coordinates)}")
    commands = {u: f"{stiffness!r}*({target} - {q}) - {damping!r}*{q}'" for u, target, q in zip(system.inputs, targets, coordinates)}
    return {"targets": targets, "inner": commands}


def _chunk(
    system: EquationSystem, chunk: Any, task: Mapping[str, Any], own: Mapping[str, Any] | None, dt: float
) -> dict[str, Any]:
    """Return the keys of a task whose actions are chunks: ``(H, s)`` commands for periods of ``dt``, of which ``s`` are used."""
    if not is_several(chunk) or len(chunk) != 2:
        raise ValueError(f"chunk is {chunk!r}, but it must be two integers (H, s): of H actions s are used")
    length, used = count("length of chunk", chunk[0], 1, 1000), count("used actions of chunk", chunk[1], 1, 1000)
    if used > length:
        raise ValueError(f"chunk is {chunk!r}, but its second number must be at most its first")
    if task["actions"] is not None or (own and own["actions"]):
        raise TypeError("chunk is given, but discrete actions have no chunks")
    table = own or {"targets": [], "inner": {}}
    targets = task["targets"] if task["targets"] is not None else table["targets"]
    inner = task["inner"] if task["inner"] is not None else table["inner"]
    _check_targets(system, targets, inner)
    names = list(targets) or list(system.inputs)
    inner = inner or {name: name for name in names}

    def chosen(name: str, first: int, end: int) -> str:
        """Return the command of a time within these periods, and the last one behind the end."""
        if end - first == 1:
            return f"{name}_{first}"
        middle = (first + end) // 2
        # A thousandth of a period is no intended difference.
        return f"if(age < {(middle - 1e-3) * dt!r}, {chosen(name, first, middle)}, {chosen(name, middle, end)})"

    commands = {name: chosen(name, 0, length) for name in names}
    pattern = re.compile("|".join(rf"(?<![A-Za-z0-9_'])({re.escape(name)})(?![A-Za-z0-9_'(])" for name in names))
    texts = {u: pattern.sub(lambda found: f"({commands[found.group()]})", text) for u, text in inner.items()}
    return {"targets": [f"{name}_{i}" for i in range(length) for name in names], "inner": texts}


def _check_targets(system: EquationSystem, targets: Any, inner: Mapping[str, Any]) -> None:
    """Check names of targets and expressions of an inner controller, of which chunks make others."""
    if isinstance(targets, str) or not is_several(targets) or not all(isinstance(name, str) for name in targets):
        raise TypeError(f"targets is {targets!r}, but it must be a list of names")
    for name, text in inner.items():
        if not isinstance(text, str):
            raise TypeError(f"inner of {name} must be an expression, not {type(text).__name__}")
    if bool(targets) != bool(inner):
        raise ValueError("targets and inner are given alone, but they must be given together")
    taken = {*system.states, *system.parameters, *system.inputs}
    for i, name in enumerate(targets):
        if name in taken or name in targets[:i]:
            raise ValueError(f"targets has {name!r}, but it must be a name of its own")


def _of_each_time(commands: list[Request], length: int, given: Any) -> list[Request]:
    """Return the largest command of each time of a chunk."""
    if length > 1 and any(kind not in ("constant", "each") for kind, _ in commands):
        raise ValueError(f"max_action is {given!r}, but with a chunk it must be a number or one for each environment")
    return commands * length


def _task(system: EquationSystem, task: Mapping[str, Any], own: Mapping[str, Any] | None) -> str:
    """Return the table of a task, with what the file of the system says in place of what is not given."""
    empty: dict[str, Any] = {"observe": list(system.states), "reward": None, "terminated": [], "start": {}, "project": {}, "inner": {}}
    own = {**empty, "actions": [], "targets": [], "inner_period": None, **(own or {})}
    table = {name: own[name] if value is None else value for name, value in task.items()}
    if task["inner"] is not None and not task["inner"] and task["inner_period"] is None:
        # What samples nothing has no period.
        table["inner_period"] = None
    if table["reward"] is None:
        raise TypeError("reward is required: an expression, as in reward='-x^2 - 0.01*u^2'")
    if not isinstance(table["reward"], str):
        raise TypeError(f"reward must be an expression, not {type(table['reward']).__name__}")
    for name in ("observe", "terminated", "targets"):
        texts = table[name]
        if isinstance(texts, str) or not is_several(texts) or not all(isinstance(x, str) for x in texts):
            raise TypeError(f"{name} is {texts!r}, but it must be a list of expressions")
    for name in ("start", "project", "inner"):
        if not isinstance(table[name], Mapping):
            raise TypeError(f"{name} must be a dictionary, not {type(table[name]).__name__}")
    for key in ("project", "inner"):
        for name, text in table[key].items():
            if not isinstance(text, str):
                raise TypeError(f"{key} of {name} must be an expression, not {type(text).__name__}")
    if not is_several(table["actions"]) and not hasattr(table["actions"], "tolist"):
        raise TypeError(f"actions is {table['actions']!r}, but it must be a list of commands")
    table["actions"] = [number("actions", x, "finite") for x in table["actions"]] or None
    # The file's ranges hold for what is not given.
    starts = {**own["start"], **table["start"]}
    table["start"] = {name: ends(f"start of {name}", value) for name, value in starts.items()}
    return text_of("task", {"task": table})


def _each_law(value: Any, length: int) -> Sequence[Any]:
    """Return a law for each observed number."""
    if is_several(value) and value and not isinstance(value[0], str):
        return each("observation_noise", value, length)
    return [value] * length
