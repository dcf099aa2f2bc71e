"""Functions that know the names of what they take."""

from __future__ import annotations

import functools
import inspect
from typing import Callable, ParamSpec, TypeVar

from ._settings import nearest

P = ParamSpec("P")
R = TypeVar("R")


def named(function: Callable[P, R]) -> Callable[P, R]:
    """The same function, which tells who takes a wrong keyword of the nearest right one."""
    known = [name for name in inspect.signature(function).parameters if name != "self"]

    @functools.wraps(function)
    def taken(*args: P.args, **kwargs: P.kwargs) -> R:
        for name in kwargs:
            if name not in known:
                raise TypeError(f"unexpected keyword argument {name!r}: {nearest(name, known)}")
        return function(*args, **kwargs)

    return taken
