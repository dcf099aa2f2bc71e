"""Latencies, distributions of clocks, and controllers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Sequence

from ._settings import is_several, number
from ._settings import law as _law

__all__ = ["Gaussian", "LQR", "Observer", "PD", "PID", "Steps", "Uniform"]


@dataclass(frozen=True)
class Steps:
    """A latency in steps, whole or fractional; a plain number is a latency in seconds."""

    number: float


def _check_rms(rms: float) -> None:
    number("rms", rms, "finite and at least 0", lambda x: 0 <= x < math.inf)


@dataclass(frozen=True)
class Gaussian:
    """Normal distribution of steps or clock rates, with a relative standard deviation. A plain number is equivalent."""

    rms: float

    def __post_init__(self) -> None:
        _check_rms(self.rms)


@dataclass(frozen=True)
class Uniform:
    """Uniform distribution of steps or clock rates, with a relative standard deviation."""

    rms: float

    def __post_init__(self) -> None:
        _check_rms(self.rms)


@dataclass(frozen=True)
class PD:
    """PD controller with the command ``-position·q - velocity·v``.

    The command is an acceleration with gains in s⁻² and s⁻¹, or a force with gains in N/m and N·s/m for a system with ``m`` and ``k``.
    """

    position: float
    velocity: float


@dataclass(frozen=True)
class PID:
    """PID controller of the position, with a filter of the derivative and anti-windup by back-calculation."""

    proportional: float
    integral: float
    derivative: float
    filter: float = 0.0
    """Time constant of the filter of the derivative, in s."""
    most: float = math.inf
    """Largest command, in m/s², or in N for a system with ``m`` and ``k``."""
    tracking: float = 1.0
    """Time constant of the anti-windup, in s."""


@dataclass(frozen=True)
class LQR:
    """LQR controller, from weights of position², velocity² and command²; of a linear plant ``LQR(Q, R)``.

    The design minimises the weighted sum over the samples. The cost of :func:`advise` is the mean over continuous time. Both have the
    same minimum only in the limit of short periods.
    """

    weights: Sequence[float]
    """Weights of position², velocity² and command²; with ``inputs`` those of the states, a matrix or its diagonal."""
    inputs: Any = None
    """Weights of the inputs of a linear plant, a matrix or its diagonal."""
    outputs: Any = None
    """Weights of the outputs of a linear plant, which add to those of the states; ``weights`` may be None then."""


@dataclass(frozen=True)
class Observer:
    """State feedback with an observer of the position, from ``weights`` or ``gains``, and ``noise`` or ``correction``."""

    weights: Sequence[float] | None = None
    """LQR weights of position², velocity² and command²."""
    gains: Sequence[float] | None = None
    """Gains of position and velocity."""
    noise: Sequence[float] | None = None
    """Noise of a Kalman filter: intensity of the process noise in (m/s²)²·s, and variance of the measurement in m²."""
    correction: Sequence[float] | None = None
    """Observer gains of the position, and of the velocity in 1/s."""


Controller = PD | PID | LQR | Observer


def law(name: str, value: Any) -> tuple[str, float] | None:
    """Return a distribution in the format of the engine."""
    if value is None:
        return None
    return _law(name, value)


def latency(value: Any) -> tuple[str, float] | None:
    """Return a latency in the format of the engine."""
    if value is None:
        return None
    if isinstance(value, Steps):
        return "steps", number("latency", value.number, "finite and at least 0")
    return "seconds", number("latency", value, "finite and at least 0")


def gains(name: str, value: Any) -> list[float] | None:
    """Return the gains of position and velocity."""
    if value is None:
        return None
    if isinstance(value, PD):
        value = (value.position, value.velocity)
    return numbers(name, value, 2)


def numbers(name: str, value: Any, count: int) -> list[float]:
    """Return ``value`` as ``count`` floats."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if not is_several(value) or len(value) != count:
        raise ValueError(f"{name} is {value!r}, but it must be {count} numbers")
    return [number(name, x, "a number", lambda _: True) for x in value]
