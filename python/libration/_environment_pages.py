"""Documentation of vector environments, from that of single ones."""

from __future__ import annotations

import re
from typing import Any

_OF_VECTORS = """

    Vector environment:

    - `num_envs` (`1`): number of environments. Environment *n* under `reset(seed=s)` is the single environment under `reset(seed=s + n)`.
    - `max_episode_steps`: number of actions after which an episode is truncated; `math.inf` or -1 for no limit.
    - `autoreset_mode` (`"NextStep"`): `"NextStep"`, `"SameStep"` or `"Disabled"`, as in Gymnasium.
    - `copy` (`True`), `buffers` (`2`): with `copy=False` the steps fill `buffers` arrays in turn.
    """


def vector_page(single: type[Any]) -> str:
    """Return the documentation of the vector environment: that of the single one, and what many of them add."""
    page = single.__doc__ or ""
    for old, new in (
        ("Environment ``", "Vector environment ``"),
        ("The action is an integer of ", "The actions are integers with shape `(num_envs,)`, each of "),
        ("The action is an `ndarray` with shape `(", "The actions are an `ndarray` with shape `(num_envs, "),
        ("The observation is an `ndarray` with shape `(", "The observations are an `ndarray` with shape `(num_envs, "),
        ("The observation is an `ndarray` with a number", "The observations are an `ndarray` with a row for each environment, a number"),
        (", by `gymnasium.make`", ", or `max_episode_steps`"),
        (" of `gymnasium.make`", ""),
        ("`info` has", "`infos` has"),
    ):
        page = page.replace(old, new)
    page = re.sub(r"\(num_envs, (\w+),\)`", r"(num_envs, \1)`", page)
    return page.rstrip() + _OF_VECTORS
