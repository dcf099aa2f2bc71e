"""Keywords of environments as values of JSON, which specs of Gymnasium keep.

``EnvSpec.to_json`` takes dictionaries, lists, strings and numbers only. A distribution is a list of its name and its two numbers.
"""

from __future__ import annotations

import copy
from enum import Enum
from numbers import Real
from typing import Any, Mapping

import numpy as np

from ._settings import is_several, number, shown
from .equations import EquationSystem
from .systems import with_commands
from .perturbations import PD, Gaussian, LogNormal, LogUniform, Uniform

_KINDS = {"uniform": Uniform, "log-uniform": LogUniform, "lognormal": LogNormal, "gaussian": Gaussian, "pd": PD}
_SYSTEM_KEYS = {"text", "file", "parameters"}


def json_value(value: Any) -> Any:
    """Return a keyword as a value of JSON, which :func:`keyword_value` reads; an object of another type is returned as it is."""
    if isinstance(value, Uniform):
        return ["uniform", *([float(value.std)] if value.ends is None else value.ends)]  # type: ignore[arg-type]
    if isinstance(value, LogUniform):
        return ["log-uniform", float(value.low), float(value.high)]
    if isinstance(value, LogNormal):
        return ["lognormal", float(value.mean), float(value.std)]
    if isinstance(value, Gaussian):
        return ["gaussian", float(value.std), float(value.mean)]
    if isinstance(value, PD):
        return ["pd", float(value.kp), float(value.kd)]
    value = with_commands(value)
    if isinstance(value, EquationSystem):
        text, file, given = value._text
        return {"text": text, "file": file, "parameters": dict(given)}
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.dtype) or (isinstance(value, type) and issubclass(value, np.generic)):
        return np.dtype(value).name
    if hasattr(value, "shape") and hasattr(value, "tolist"):
        # Of largest actions (num_envs, inputs) a list for each input.
        return json_value(np.asarray(value).T.tolist())
    if isinstance(value, Real) and not isinstance(value, (int, float)):
        return float(value)
    if isinstance(value, Mapping):
        return {key: json_value(one) for key, one in value.items()}
    return [json_value(one) for one in value] if is_several(value) else value


def keyword_value(value: Any) -> Any:
    """Return the keyword of a value of JSON: ``["uniform", 10, 20]`` is ``Uniform(10, 20)``; arrays of the caller are copied."""
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, Mapping):
        return {key: keyword_value(one) for key, one in value.items()}
    if not is_several(value) or not value:
        return value
    kind, *numbers = value
    if isinstance(kind, str) and kind in _KINDS and len(numbers) == 2 and all(map(_is_number, numbers)):
        return _KINDS[kind](*numbers)
    # A range of the standard deviation of a law, or a distribution for each input.
    return type(value)(keyword_value(one) for one in value) if type(value) in (list, tuple) else value


def named_keyword_value(name: str, value: Any) -> Any:
    """Return the keyword of a value of JSON; errors of distributions begin with its name."""
    try:
        return keyword_value(value)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}: {error}") from None


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) or getattr(value, "shape", None) == ()


def system_value(value: Any) -> Any:
    """Return the system of a value of JSON.

    Raises
    ------
    TypeError
        For a dictionary whose entries have other types.
    """
    if not isinstance(value, Mapping) or set(value) != _SYSTEM_KEYS:
        return value
    for key, kind, expected in (("text", str, "a string"), ("file", str, "a string"), ("parameters", Mapping, "a dictionary of numbers")):
        if not isinstance(value[key], kind):
            raise TypeError(f"{key} of system is {shown(value[key])}, but it must be {expected}")
    given = [(name, number(f"parameter {name!r} of system", x, "finite")) for name, x in value["parameters"].items()]
    return EquationSystem._again(value["text"], value["file"], given)


def _spec(env: Any) -> Any:
    return vars(env).get("_spec")


def _set_spec(env: Any, spec: Any) -> None:
    if spec is not None:
        spec, given = copy.copy(spec), spec.kwargs
        spec.kwargs = {name: json_value(value) for name, value in given.items()}
    vars(env)["_spec"] = spec


class _Spec(property):
    """A property of environments that is None on their class, as in Gymnasium."""

    def __get__(self, env: Any, cls: type | None = None) -> Any:
        return None if env is None else super().__get__(env, cls)


JSON_SPEC: Any = _Spec(_spec, _set_spec, doc="Spec of Gymnasium, whose keywords are values of JSON.")
"""An attribute ``spec`` of environments."""
