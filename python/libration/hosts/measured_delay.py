"""Delays of commands and observations, from the calls that show single changes."""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np


class StrayResults(NamedTuple):
    """Results that differ from those of all other calls with the same state and action, after no change of either."""

    strays: int
    """The number of these results."""
    calls: int
    """The number of calls."""


class MeasuredDelay(NamedTuple):
    """A delay that a host has measured."""

    name: str
    """The name of the input, or of the observation."""
    late_steps: float
    """Its steps on average."""
    late_steps_error: float
    """The standard error of this mean."""
    most_steps: float
    """The largest number of steps."""
    calls: int
    """The number of calls that differed from all others."""
    unseen: int
    """The number of these that no result shows."""
    varies: bool
    """Whether it changes from step to step."""


def measured_delay(name: str, responses: Sequence[set[int]]) -> MeasuredDelay | None:
    """Return the delay from the numbers of later calls that respond to each changed call; none if nothing responds.

    Call ``k`` after a change responds if its own age is ``k``: over all changes the sum of these ``k`` has the mean of ages as its mean.
    """
    if not any(responses):
        return None
    ages = [float(sum(calls)) for calls in responses]
    error = float(np.std(ages, ddof=1) / np.sqrt(len(ages))) if len(ages) > 1 else 0.0
    most = float(max(max(calls) for calls in responses if calls))
    varies = any(calls != responses[0] for calls in responses)
    unseen = sum(not calls for calls in responses)
    return MeasuredDelay(name, float(np.mean(ages)), error, most, len(responses), unseen, varies)
