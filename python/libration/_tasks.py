"""Environments of systems by equations: settings, and what is known of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Mapping, Sequence

from ._settings import OPTIONS, TASK_OPTIONS, common, ends, is_several, law, number, refuse_others
from ._toml import text_of
from .equations import EquationSystem

SMALLEST_OPTIONS = [name for name in OPTIONS if name not in ("start_position", "start_velocity")]


@dataclass(frozen=True)
class EquationPreset:
    """What environments of a system are called and show."""

    name: str
    seen: tuple[str, ...]
    """Expressions of the observed numbers."""
    actions: tuple[str, ...]
    """Names of the inputs."""

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
    refuse_others(given.pop("parameters"), (), SMALLEST_OPTIONS)
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
    if any(value is not None for value in task.values()):
        text = _task(system, task, own)
    seen = own["observe"] if own else list(system.states)
    seen = list(task["observe"]) if task["observe"] is not None else seen
    given["max_episode_steps"] = math.inf if given["max_episode_steps"] is None else given["max_episode_steps"]
    most, inputs = given["max_action"], system.inputs
    most = math.inf if most is None else most
    settings = common(given)
    above = lambda x: x > 0  # noqa: E731
    settings["subject"] = {
        "equations": system._text,
        "task": text,
        "saturation": [
            number("max_action", x, "greater than 0", above) for x in _each("max_action", most, len(inputs))
        ],
        "noise": [law("observation_noise", x) for x in _each_law(given["observation_noise"], len(seen))],
    }
    return EquationPreset(system.name, tuple(seen), inputs), settings


def _task(system: EquationSystem, task: Mapping[str, Any], own: Mapping[str, Any] | None) -> str:
    """Return the table of a task, with what the file of the system says in place of what is not given."""
    own = own or {"observe": list(system.states), "reward": None, "terminated": [], "start": {}}
    table = {name: own[name] if value is None else value for name, value in task.items()}
    if table["reward"] is None:
        raise TypeError("reward is required: an expression, as in reward='-x^2 - 0.01*u^2'")
    if not isinstance(table["reward"], str):
        raise TypeError(f"reward must be an expression, not {type(table['reward']).__name__}")
    for name in ("observe", "terminated"):
        texts = table[name]
        if isinstance(texts, str) or not is_several(texts) or not all(isinstance(x, str) for x in texts):
            raise TypeError(f"{name} is {texts!r}, but it must be a list of expressions")
    if not isinstance(table["start"], Mapping):
        raise TypeError(f"start must be a dictionary, not {type(table['start']).__name__}")
    # The file's ranges hold for what is not given.
    starts = {**own["start"], **table["start"]}
    table["start"] = {name: ends(f"start of {name}", value) for name, value in starts.items()}
    return text_of("task", {"task": table})


def _each(name: str, value: Any, count: int) -> Sequence[Any]:
    """Return a value for each of ``count``."""
    if getattr(value, "shape", ()) != ():
        value = value.tolist()
    if not is_several(value):
        return [value] * count
    if len(value) != count:
        raise ValueError(f"{name} has {len(value)} numbers, but it must have one or {count}")
    return value


def _each_law(value: Any, count: int) -> Sequence[Any]:
    """Return a law for each observed number."""
    if is_several(value) and value and not isinstance(value[0], str):
        return _each("observation_noise", value, count)
    return [value] * count
