"""States and numbers of the episodes of environments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._episode_numbers import largest_command_names
from ._settings import nearest

OPTIONS = ("reset_mask", "state", "low", "high")


def options_of(options: Any) -> dict[str, Any]:
    """Return a copy of the options of ``reset``; without options it is empty."""
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise TypeError(f"options must be a dictionary, not {type(options).__name__}")
    return dict(options)


def refuse_options(options: Mapping[str, Any]) -> None:
    """Raise a ValueError for options of ``reset`` that have no effect."""
    for name in options:
        if name not in OPTIONS:
            raise ValueError(f"options has {name!r}: {nearest(str(name), OPTIONS)}")
    if "state" in options and ("low" in options or "high" in options):
        raise ValueError("options has 'state' and ends of ranges, but it must have one of them")
    for name, other in (("low", "high"), ("high", "low")):
        if name in options and other not in options:
            raise ValueError(f"options has {name!r} without {other!r}, but it must have both")


def start_of(
    options: Mapping[str, Any], names: Sequence[str], num_envs: int, which: NDArray[np.intp], dtype: Any
) -> NDArray[np.float64] | None:
    """Return states of the chosen environments, the ends of ranges of starts ``(2, n)``, or None where the options have neither."""
    if "state" in options:
        return rows_of("options['state']", options["state"], names, num_envs, which, dtype)
    if "low" not in options:
        return None
    one = np.zeros(1, np.intp)
    low, high = (rows_of(f"options[{name!r}]", _all_of_them(options[name], names), names, 1, one, dtype)[0] for name in ("low", "high"))
    if (low > high).any():
        i = int(np.argmax(low > high))
        raise ValueError(f"options has {names[i]} from {low[i]} to {high[i]}, but low must be at most high")
    with np.errstate(over="ignore"):
        width = (high - low).astype(dtype)
    if not np.isfinite(width).all():
        i = int(np.argmin(np.isfinite(width)))
        raise ValueError(f"options has {names[i]} from {low[i]} to {high[i]}, but the distance must be finite")
    return np.stack([low, high])


def _all_of_them(value: Any, names: Sequence[str]) -> Any:
    """Return a number for each state where there is one for all."""
    return np.full(len(names), value) if not isinstance(value, Mapping) and np.ndim(value) == 0 else value


def rows_of(
    name: str, value: Any, names: Sequence[str], rows: int, which: NDArray[np.intp], dtype: Any
) -> NDArray[np.float64]:
    """Return the chosen rows of numbers of states, finite in the float type of the environments."""
    if isinstance(value, Mapping):
        for key in value:
            if key not in names:
                raise ValueError(f"{name} has {key!r}: {nearest(str(key), names)}")
        for key in names:
            if key not in value:
                raise ValueError(f"{name} has no {key!r}, but it must have {', '.join(names)}")
        columns = [_array(f"{name}[{key!r}]", value[key]) for key in names]
        try:
            value = np.stack(np.broadcast_arrays(*columns), axis=-1)
        except ValueError:
            shapes = ", ".join(f"{key} {column.shape}" for key, column in zip(names, columns))
            raise ValueError(f"{name} has shapes {shapes}, but each must be a number or ({rows},)") from None
    array = _array(name, value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {array.dtype}, but it must have real numbers")
    if array.shape not in ((len(names),), (rows, len(names))):
        allowed = f"({len(names)},)" if rows == 1 else f"({len(names)},) or ({rows}, {len(names)})"
        raise ValueError(f"{name} has shape {array.shape}, but it must be {allowed}: {', '.join(names)}")
    chosen = np.broadcast_to(array.astype(np.float64), (rows, len(names)))[which]
    with np.errstate(over="ignore"):
        finite = np.isfinite(chosen.astype(dtype))
    if not finite.all():
        n, i = np.argwhere(~finite)[0]
        raise ValueError(f"{name} has {chosen[n, i]} for {names[i]}, but it must be finite in {np.dtype(dtype).name}")
    return chosen


def _array(name: str, value: Any) -> NDArray[Any]:
    if isinstance(value, np.ma.MaskedArray):
        raise TypeError(f"{name} is a masked array, but all values must be present; help: use filled()")
    try:
        return np.asarray(value)
    except ValueError:
        raise ValueError(f"{name} is {value!r}, but it must have rows of one length") from None


def episode_numbers(settings: Mapping[str, Any], inputs: Sequence[str], drawn: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Return the numbers that vary by name, from all that the engine draws for each episode."""
    subject = settings["subject"]
    names = [*(name for name, _ in subject.get("varied", [])), *largest_command_names(subject["saturation"], inputs)]
    found = {name: drawn[:, i].copy() for i, name in enumerate(names)}
    for i, name in enumerate(("observation_delay", "action_delay")):
        if name in settings["ranges"]:
            found[name] = drawn[:, len(names) + i] * drawn.dtype.type(settings["dt"])
    laws = {"jitter": settings["jitter"][1], "observation_noise": _noise(subject["noise"])}
    for i, (name, std) in enumerate(laws.items()):
        low, high = subject.get("error_scale", [[1.0, 1.0]] * 2)[i]
        if low != high:
            found[name] = drawn[:, len(names) + 2 + i] * drawn.dtype.type(std)
    if subject.get("answers") is not None:
        found["inference"] = drawn[:, len(names) + 4].copy()
    if settings["skew"][1] > 0:
        found["skew"] = drawn[:, -1] - drawn.dtype.type(1)
    return found


def _noise(laws: Any) -> float:
    return max(std for _, std in laws) if isinstance(laws, list) else laws[1]
