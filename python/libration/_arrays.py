"""What the engine asks Python to do with arrays where that is rare."""

from __future__ import annotations

from typing import Any

import numpy as np


def actions(given: Any, num_envs: int, dtype: str) -> np.ndarray:
    """Make actions an array that the engine can read. What it can read as it is does not come here.

    Raises
    ------
    TypeError
        If they are no real numbers.
    ValueError
        If there are more or fewer than one for each environment.
    """
    if not isinstance(given, np.ndarray) and hasattr(given, "__dlpack__"):
        try:
            array = np.from_dlpack(given)
        except RuntimeError as error:
            # As NumPy says of numbers that it has not.
            raise TypeError(f"actions are of a type that NumPy has not: {error}") from error
    else:
        array = np.asarray(given)
    if isinstance(given, np.ma.MaskedArray):
        raise TypeError("actions are a masked array, but all of them must be there: use filled()")
    if array.dtype.kind not in "fiu":
        raise TypeError(
            f"actions have dtype {array.dtype}, but they must be real numbers: "
            f"an array of {dtype} is read without a copy"
        )
    if array.shape not in ((num_envs,), (num_envs, 1)):
        raise ValueError(
            f"actions have shape {array.shape}, but it must be ({num_envs}, 1) or ({num_envs},)"
        )
    # What is too large for the dtype becomes infinite, and is refused as such.
    with np.errstate(over="ignore"):
        return array.astype(dtype, order="C")


def infos(
    num_envs: int,
    same_step: bool,
    environments: list[int],
    seen: np.ndarray,
    lost: list[bool],
) -> dict[str, Any]:
    """Tell of episodes that ended, as Gymnasium's vector environments do."""
    told: dict[str, Any] = {}
    ended = np.zeros(num_envs, dtype=np.bool_)
    ended[environments] = True
    if any(lost):
        marks = np.zeros(num_envs, dtype=np.bool_)
        marks[environments] = lost
        told = {"lost": marks, "_lost": marks.copy()}
    if not same_step:
        return told
    final_obs = np.full(num_envs, None, dtype=object)
    for n, row in zip(environments, seen):
        final_obs[n] = row
    # What would be told of the end in the other modes is told of it here.
    return {
        "final_obs": final_obs,
        "_final_obs": ended,
        "final_info": told,
        "_final_info": ended.copy(),
    }
