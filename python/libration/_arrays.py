"""Conversions of arrays for the engine, outside the fast path."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np


def actions(given: Any, shape: Sequence[int], dtype: str) -> np.ndarray:
    """Return actions as an array for the engine. Arrays that the engine reads directly bypass this function.

    Raises
    ------
    TypeError
        If they are not real numbers.
    ValueError
        If there are not exactly as many as ``shape`` says, ``(num_envs, n)``.
    """
    array = _array(given)
    if array.dtype.kind not in "fiu":
        raise TypeError(
            f"actions have dtype {array.dtype}, but they must be real numbers: "
            f"an array of {dtype} is read without a copy"
        )
    allowed = [tuple(shape)] + [(shape[0],)] * (shape[1] == 1) + [(shape[1],)] * (shape[0] == 1 < shape[1])
    if array.shape not in allowed:
        raise ValueError(
            f"actions have shape {array.shape}, but it must be {' or '.join(map(str, allowed))}"
        )
    with np.errstate(over="ignore"):
        converted = array.reshape(shape if shape[1] > 1 else array.shape).astype(dtype, order="C")
    beyond = np.isfinite(array).reshape(converted.shape) & ~np.isfinite(converted)
    if beyond.any():
        place = tuple(int(i) for i in np.argwhere(beyond.reshape(shape))[0])
        index = ", ".join(map(str, place[: 1 if shape[1] == 1 else 2]))
        raise ValueError(f"actions[{index}] is {array.reshape(shape)[place]}, but it must be finite in {dtype}")
    # The engine refuses what is not finite itself.
    return converted


def choices(given: Any, num_envs: int, levels: list[float], dtype: str) -> np.ndarray:
    """Return the commands of discrete actions ``(num_envs,)``; action ``i`` is the command ``levels[i]``.

    Raises
    ------
    TypeError
        If they are not integers.
    ValueError
        If their shape is wrong, or one is no action.
    """
    array = _array(given)
    if array.dtype.kind not in "iu":
        raise TypeError(f"actions have dtype {array.dtype}, but they must be integers from 0 to {len(levels) - 1}")
    if array.shape != (num_envs,) and not (num_envs == 1 and array.shape == ()):
        raise ValueError(f"actions have shape {array.shape}, but it must be ({num_envs},)")
    array = array.reshape(num_envs)
    if array.min() < 0 or array.max() >= len(levels):
        n = int(np.argmax((array < 0) | (array >= len(levels))))
        raise ValueError(f"actions[{n}] is {array[n]}, but it must be 0 to {len(levels) - 1}")
    return np.array(levels, dtype).take(array.astype(np.int64, copy=False))


def real_numbers(given: Any) -> np.ndarray:
    """Return actions as an array.

    Raises
    ------
    TypeError
        If they are not real numbers.
    """
    array = _array(given)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"actions have dtype {array.dtype}, but they must be real numbers")
    return array


def numbers_of(given: Any) -> np.ndarray:
    """Return a copy of actions that the engine has taken."""
    return np.array(_array(given), dtype=float)


def _array(given: Any) -> np.ndarray:
    """Return actions as an array.

    Raises
    ------
    TypeError
        If NumPy has no such type, or values are missing.
    """
    if isinstance(given, np.ma.MaskedArray):
        raise TypeError("actions are a masked array, but all values must be present; help: use filled()")
    if isinstance(given, np.ndarray) or not hasattr(given, "__dlpack__"):
        try:
            return np.asarray(given)
        except ValueError:
            raise ValueError(f"actions are {given!r}, but they must have rows of one length") from None
    try:
        return np.from_dlpack(given)
    except RuntimeError as error:
        raise TypeError(f"actions are of a type that NumPy has not: {error}") from error


def infos(
    num_envs: int,
    same_step: bool,
    environments: list[int],
    seen: np.ndarray,
    lost: list[bool],
) -> dict[str, Any]:
    """Return the infos of ended episodes, as in Gymnasium's vector environments."""
    info: dict[str, Any] = {}
    ended = np.zeros(num_envs, dtype=np.bool_)
    ended[environments] = True
    if any(lost):
        marks = np.zeros(num_envs, dtype=np.bool_)
        marks[environments] = lost
        info = {"lost": marks, "_lost": marks.copy()}
    if not same_step:
        return info
    final_obs = np.full(num_envs, None, dtype=object)
    for n, row in zip(environments, seen):
        final_obs[n] = row
    # In the other modes these infos belong to the end of the episode, too.
    return {
        "final_obs": final_obs,
        "_final_obs": ended,
        "final_info": info,
        "_final_info": ended.copy(),
    }
