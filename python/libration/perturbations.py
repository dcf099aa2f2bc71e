"""What is wrong with clocks and commands, and who commands."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Sequence

from ._settings import is_several, number
from ._settings import law as _law

__all__ = ["Gaussian", "LQR", "Observer", "PD", "PID", "Steps", "Uniform"]


@dataclass(frozen=True)
class Steps:
    """A latency in steps, which need not be whole; a plain number is one in seconds."""

    number: float


@dataclass(frozen=True)
class Gaussian:
    """A law of step times or clock rates: normal, with a relative standard deviation. A plain number is the same."""

    rms: float


@dataclass(frozen=True)
class Uniform:
    """A law of step times or clock rates: uniform, with a relative standard deviation."""

    rms: float


@dataclass(frozen=True)
class PD:
    """The command ``-position·q - velocity·v``.

    An acceleration, with gains in s⁻² and s⁻¹; a force, with gains in N/m and N·s/m, where the system is given by ``m`` and ``k``.
    """

    position: float
    velocity: float


@dataclass(frozen=True)
class PID:
    """Three terms of the position, with a filter of the derivative and anti-windup by back-calculation."""

    proportional: float
    integral: float
    derivative: float
    filter: float = 0.0
    """Of the derivative, in s."""
    most: float = math.inf
    """Largest command, in m/s², or in N where the system is given by ``m`` and ``k``."""
    tracking: float = 1.0
    """In how many seconds the integral follows the limit."""


@dataclass(frozen=True)
class LQR:
    """The feedback that costs least, designed from the model: weights of position², velocity² and command².

    It minimises the weighted sum over the samples. The cost that :func:`advise` reports is the mean over continuous time; the two
    have the same minimum in the limit of short periods only.
    """

    weights: Sequence[float]


@dataclass(frozen=True)
class Observer:
    """Feedback of a state that is estimated from the position: give ``weights`` or ``gains``, and ``noise`` or ``correction``."""

    weights: Sequence[float] | None = None
    """Of the feedback that costs least."""
    gains: Sequence[float] | None = None
    """Of position and velocity."""
    noise: Sequence[float] | None = None
    """Intensity of the noise on the plant, in (m/s²)²·s, and variance of what is seen, in m²: the estimate is that of a Kalman filter."""
    correction: Sequence[float] | None = None
    """Of the position, and of the velocity in 1/s."""


Controller = PD | PID | LQR | Observer


def law(name: str, value: Any) -> tuple[str, float] | None:
    """A law as the engine is told of it."""
    if value is None:
        return None
    return _law(name, value)


def latency(value: Any) -> tuple[str, float] | None:
    """A latency as the engine is told of it."""
    if value is None:
        return None
    if isinstance(value, Steps):
        return "steps", number("latency", value.number, "finite and at least 0")
    return "seconds", number("latency", value, "finite and at least 0")


def gains(name: str, value: Any) -> list[float] | None:
    """The gains of a feedback of position and velocity."""
    if value is None:
        return None
    if isinstance(value, PD):
        value = (value.position, value.velocity)
    return numbers(name, value, 2)


def numbers(name: str, value: Any, count: int) -> list[float]:
    """So many numbers."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if not is_several(value) or len(value) != count:
        raise ValueError(f"{name} is {value!r}, but it must be {count} numbers")
    return [number(name, x, "a number", lambda _: True) for x in value]
