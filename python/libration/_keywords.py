"""Error messages for unknown keywords."""

from __future__ import annotations

import functools
import inspect
from typing import Callable, ParamSpec, TypeVar

from ._settings import nearest

P = ParamSpec("P")
R = TypeVar("R")


def check_keywords(function: Callable[P, R]) -> Callable[P, R]:
    """Return the function with an error message that has the nearest name of an unknown keyword."""
    known = [name for name in inspect.signature(function).parameters if name not in ("self", "cls")]

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        for name in kwargs:
            if name not in known:
                raise TypeError(f"unexpected keyword argument {name!r}: {nearest(name, known)}")
        return function(*args, **kwargs)

    return checked
