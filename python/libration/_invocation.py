"""Python calls that repeat an audit."""

from __future__ import annotations

import inspect
import keyword
import math
import os
from typing import Any, Callable, Mapping, Sequence

# Characters of a value; a longer one is its parameter's name.
_LONGEST = 100


def python_call(name: str, functions: Sequence[Callable[..., Any]], arguments: Mapping[str, Any], positional: Sequence[str]) -> str:
    """Return a call with all arguments that are no defaults, such as ``libration.probe(pendulum, [0.0, 0.0], [0.0], 0.01)``.

    A function is its name. A value without a short notation is the name of its parameter: ``libration.probe.gymnasium(env)``.

    Parameters
    ----------
    functions:
        Those that have the defaults of the arguments.
    positional:
        Names of the arguments without a keyword.
    """
    defaults = {one.name: one.default for function in functions for one in inspect.signature(function).parameters.values()}
    given = {one: value for one, value in arguments.items() if not _is_default(value, defaults[one])}
    last = max((k for k, one in enumerate(positional) if one in given), default=-1)
    words = [_expression(one, arguments[one]) for one in positional[: last + 1]]
    words += [f"{one}={_expression(one, value)}" for one, value in given.items() if one not in positional]
    return f"{name}({', '.join(words)})"


def _is_default(value: Any, default: Any) -> bool:
    # Arrays have no single truth value.
    return value is default or (type(value) is type(default) and type(value) in (bool, int, float, str, tuple) and bool(value == default))


def _expression(name: str, value: Any) -> str:
    found = _notation(value)
    return name if found is None or len(found) > _LONGEST else found


def _notation(value: Any) -> str | None:
    """Return the value in Python, or None."""
    if hasattr(value, "tolist"):
        return _notation(value.tolist()) if getattr(value, "size", 1) <= _LONGEST else None
    if type(value) is float and not math.isfinite(value):
        return f"float('{value}')"
    if value is None or type(value) in (bool, int, float, str):
        return repr(value)
    if isinstance(value, os.PathLike):
        return repr(os.fspath(value))
    if type(value) in (list, tuple) and len(value) <= _LONGEST:
        parts = [_notation(one) for one in value]
        if any(one is None for one in parts):
            return None
        text = ", ".join(one for one in parts if one is not None)
        return f"[{text}]" if type(value) is list else f"({text},)" if len(parts) == 1 else f"({text})"
    if type(value) is dict and len(value) <= _LONGEST:
        pairs = [(_notation(key), _notation(one)) for key, one in value.items()]
        if any(key is None or one is None for key, one in pairs):
            return None
        return "{" + ", ".join(f"{key}: {one}" for key, one in pairs) + "}"
    # A method needs its object, and a lambda has no name.
    found = getattr(value, "__name__", "") if callable(value) and not hasattr(value, "__self__") else ""
    return found if isinstance(found, str) and found.isidentifier() and not keyword.iskeyword(found) else None
