"""Latencies, distributions of clocks, and controllers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Sequence

from ._settings import ends, is_several, number
from ._settings import law as _law

__all__ = ["Gaussian", "LQR", "LogNormal", "LogUniform", "Observer", "PD", "PID", "Steps", "Uniform"]


@dataclass(frozen=True)
class Steps:
    """A latency in steps, whole or fractional; a plain number is a latency in seconds."""

    number: float


def _check_std(std: float) -> None:
    number("std", std, "finite and at least 0", lambda x: 0 <= x < math.inf)


@dataclass(frozen=True)
class Gaussian:
    """Normal distribution with a standard deviation.

    Of steps or clock rates it is relative and has the mean zero; a plain number is equivalent. A parameter of an environment requires a
    ``mean``.
    """

    std: float
    mean: float = 0.0

    def __post_init__(self) -> None:
        _check_std(self.std)
        number("mean", self.mean, "finite")


class Uniform:
    """Uniform distribution: ``Uniform(std)`` around zero, or ``Uniform(low, high)``.

    Steps and clock rates have a relative standard deviation, as in ``jitter=Uniform(0.05)``. Parameters of environments have two ends, as in
    ``omega2=Uniform(10, 20)``.
    """

    std: float | None
    """Standard deviation of a distribution around zero."""
    ends: tuple[float, float] | None
    """Ends of a distribution between two numbers."""

    def __init__(self, low: float | None = None, high: float | None = None, *, std: float | None = None) -> None:
        if (low is None) == (std is None) or (high is not None and low is None):
            raise TypeError("Uniform takes a standard deviation, Uniform(std), or two ends, Uniform(low, high)")
        if high is None:
            self.std, self.ends = (low if std is None else std), None
            assert self.std is not None
            _check_std(self.std)
        else:
            self.std, self.ends = None, ends("Uniform", (low, high))

    def __repr__(self) -> str:
        return f"Uniform({self.std!r})" if self.ends is None else f"Uniform({self.ends[0]!r}, {self.ends[1]!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Uniform) and (self.std, self.ends) == (other.std, other.ends)

    def __hash__(self) -> int:
        return hash((self.std, self.ends))


@dataclass(frozen=True)
class LogUniform:
    """Distribution of a parameter of an environment between two ends above zero whose logarithm is uniform."""

    low: float
    high: float

    def __post_init__(self) -> None:
        number("low", self.low, "finite and greater than 0", lambda x: 0 < x < math.inf)
        number("high", self.high, "finite and at least low", lambda x: self.low <= x < math.inf)


@dataclass(frozen=True)
class LogNormal:
    """Distribution above zero, with a mean and a standard deviation, whose logarithm is normal.

    Of a parameter of an environment, or of the time of an inference.
    """

    mean: float
    std: float

    def __post_init__(self) -> None:
        number("mean of LogNormal", self.mean, "finite and greater than 0", lambda x: 0 < x < math.inf)
        number("std of LogNormal", self.std, "finite and at least 0", lambda x: 0 <= x < math.inf)


@dataclass(frozen=True)
class PD:
    """PD controller with the command ``-kp·q - kd·v``.

    The command is an acceleration with gains in s⁻² and s⁻¹, or a force with gains in N/m and N·s/m for a system with ``m`` and ``k``.
    """

    kp: float
    """Gain of the position."""
    kd: float
    """Gain of the velocity."""


@dataclass(frozen=True)
class PID:
    """PID controller of the position, with a filter of the derivative and anti-windup by back-calculation."""

    kp: float
    """Proportional gain."""
    ki: float
    """Integral gain."""
    kd: float
    """Derivative gain."""
    filter: float = 0.0
    """Time constant of the filter of the derivative, in s."""
    max_command: float = math.inf
    """Largest command, in m/s², or in N for a system with ``m`` and ``k``."""
    tracking: float = 1.0
    """Time constant of the anti-windup, in s."""


@dataclass(frozen=True)
class LQR:
    """LQR controller, from weights of position², velocity² and command²; of a linear plant ``LQR(Q, R)``.

    The design minimises the weighted sum over the samples. The cost of :func:`advise` is the mean over continuous time. Both have the
    same minimum only in the limit of short periods.
    """

    weights: Any
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

FILE_KEYS = {
    PD: {"kp": "position", "kd": "velocity"},
    PID: {"kp": "proportional", "ki": "integral", "kd": "derivative", "max_command": "most"},
}
"""Keys that files have for fields of controllers, where they differ."""


def file_table(controller: Any) -> dict[str, Any]:
    """Return the fields of a controller by their keys in files."""
    keys = FILE_KEYS.get(type(controller), {})
    return {keys.get(name, name): value for name, value in vars(controller).items()}


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
        value = (value.kp, value.kd)
    return numbers(name, value, 2)


def numbers(name: str, value: Any, count: int) -> list[float]:
    """Return ``value`` as ``count`` floats."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if not is_several(value) or len(value) != count:
        raise ValueError(f"{name} is {value!r}, but it must be {count} numbers")
    return [number(name, x, "a number", lambda _: True) for x in value]
