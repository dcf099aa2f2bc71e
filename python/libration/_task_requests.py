"""Tasks of environments of systems by equations, with what keywords change in them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Mapping, Sequence

import numpy as np

from ._episode_numbers import check_float_type
from ._settings import TASK_OPTIONS, count, ends, inner_count, is_several, number, positive, shown
from ._toml import text_of
from .equations import EquationSystem
from .perturbations import PD

Table = Mapping[str, Any]


@dataclass(frozen=True)
class TaskRequest:
    """The task of environments of a system: that of its file, with the keywords of the caller in place of parts of it."""

    text: str | None
    """The table of the task; None for that of the file."""
    observed: tuple[str, ...]
    """Expressions of the observed numbers."""
    actions: tuple[str, ...]
    """Names of the actions: targets, or inputs."""
    levels: tuple[float, ...]
    """Commands of discrete actions."""
    inner_period: float | None
    """Period of the inner controller in s, if there is one."""
    length: int = 1
    """Number of actions of a chunk."""
    used: int = 1
    """Number of actions of a chunk that are used."""
    controller_text: str | None = None
    """With a chunk and an inner controller: the table of the task with the names of the caller, of which those of a chunk are made."""


def task_request(system: EquationSystem, keywords: Table) -> TaskRequest:
    """Return the task of environments, from the keywords of tasks, ``chunk`` and ``dt``, the period of an action in s.

    Raises
    ------
    TypeError, ValueError
        For the first invalid keyword; the message has its name, its value and the allowed values.
    """
    task = {name: keywords[name] for name in TASK_OPTIONS}
    own: Table | None = system.summary["task"]
    if isinstance(task["inner"], PD):
        task |= _pd_targets(system, task["inner"], task["targets"])
    inner = _chosen(task, own, "inner", {})
    if not isinstance(inner, Mapping):
        raise TypeError(f"inner must be libration.PD or a dictionary of expressions, not {type(inner).__name__}")
    period = _chosen(task, own, "inner_period", None)
    if inner and period is None:
        raise TypeError("inner_period is required with inner: the time in s between samples of the controller")
    if task["actions"] is not None:
        task["actions"] = _levels(task["actions"], keywords["dtype"])
        if not task["actions"]:
            raise ValueError("actions is [], but it must be at least two commands in ascending order")
    _check_reward(system, task, own, keywords["chunk"])
    levels = tuple(_levels(_chosen(task, own, "actions", ()), keywords["dtype"]))
    chunk, length, used, controller_text = keywords["chunk"], 1, 1, None
    if chunk is not None:
        if not inner and task["inner_period"] is not None:
            raise TypeError("inner_period is given, but it belongs to an inner controller")
        dt = positive("dt", keywords["dt"])
        whole = task | _chunk(system, chunk, task, own, dt)
        if inner:
            # The reward has the names of the chunk.
            controller_text = _text(system, {**task, "reward": "0"}, own)
        task = whole
        # That of the file is of a controller that the caller replaced.
        own = {**own, "inner_period": None} if own and not inner else own
        inner_count(dt, period if inner else None, None)
        length, used = chunk
    is_changed = any(value is not None for value in task.values())
    return TaskRequest(
        text=_text(system, task, own) if is_changed else None,
        observed=tuple(_chosen(task, own, "observe", system.states)),
        actions=tuple(_chosen(task, own, "targets", ())) or system.inputs,
        levels=levels,
        inner_period=period if inner else None,
        length=length,
        used=used,
        controller_text=controller_text,
    )


def _check_reward(system: EquationSystem, task: Table, own: Table | None, chunk: Any) -> None:
    """Refuse a chunk or an inner controller where the reward that the system came with has the input in place of which they are."""
    if task["reward"] is not None or own is None or (chunk is None and task["inner"] is None):
        return
    for name in system.inputs:
        if re.search(rf"(?<![A-Za-z0-9_']){re.escape(name)}(?![A-Za-z0-9_'(])", own["reward"]):
            given, actions = ("inner", "targets") if chunk is None else ("chunk", "commands of the chunk")
            raise ValueError(
                f"{given} is given, but the reward of the task has the input {name}, and actions are {actions}: "
                f"give another reward, without {name}"
            )


def _levels(actions: Any, dtype: str) -> list[float]:
    """Return the commands of discrete actions as floats."""
    if getattr(actions, "ndim", 1) != 1 or not (is_several(actions) or hasattr(actions, "tolist")):
        raise TypeError(f"actions is {shown(actions)}, but it must be a list of commands")
    levels = [number(f"actions[{i}]", x, "finite") for i, x in enumerate(actions)]
    for i, level in enumerate(levels):
        check_float_type(f"actions[{i}]", ("constant", [level]), dtype)
    with np.errstate(over="ignore"):
        rounded = np.array(levels).astype(dtype if dtype == "float32" else "float64")
    if len(levels) == 1 or (np.diff(rounded) <= 0).any():
        raise ValueError(f"actions is {levels}, but it must be at least two commands in ascending order in {dtype}")
    return levels


def _chosen(task: Table, own: Table | None, name: str, default: Any) -> Any:
    """Return a key of the task of the caller, else of the file, else its default."""
    if task[name] is not None:
        return task[name]
    return own[name] if own else default


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
    system: EquationSystem, chunk: Any, task: Table, own: Table | None, dt: float
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


def _text(system: EquationSystem, task: Table, own: Table | None) -> str:
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
    table["actions"] = [float(x) for x in table["actions"]] or None
    # The file's ranges hold for what is not given.
    starts = {**own["start"], **table["start"]}
    table["start"] = {name: ends(f"start of {name}", value) for name, value in starts.items()}
    return text_of("task", {"task": table})
