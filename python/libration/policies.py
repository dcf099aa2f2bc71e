"""Policies that the engine evaluates without Python between steps."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ._settings import number

__all__ = ["Constant", "Linear", "MLP", "Policy", "Random"]


def _finite(name: str, values: Any) -> np.ndarray:
    if hasattr(values, "detach"):
        # Parameters of PyTorch have a gradient, which NumPy refuses.
        values = values.detach().cpu()
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {array.dtype}, but it must be real numbers")
    with np.errstate(over="ignore"):
        array = array.astype(np.float64)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is not finite everywhere")
    return array


def _per_action(name: str, value: Any, actions: int) -> list[float]:
    """Return a number for each action."""
    if np.ndim(value) == 0:
        return [number(name, value, "finite")] * actions
    numbers = _finite(name, value).ravel()
    if numbers.size != actions:
        raise ValueError(f"{name} has {numbers.size} numbers, but it must have one or {actions}")
    return numbers.tolist()


class Policy:
    """Base class of the policies."""

    def _request(self, observations: int, actions: int) -> dict[str, Any]:
        """Return the policy in the format of the engine, for numbers of observed values and of actions."""
        known = ", ".join(name for name in __all__ if name != "Policy")
        raise TypeError(f"{type(self).__name__} is not a policy of the engine; expected one of {known}")

    @staticmethod
    def _numbers(name: str, numbers: Any, hidden: Sequence[int] = (), activation: str = "tanh") -> dict[str, Any]:
        return {
            "name": name,
            "numbers": np.ascontiguousarray(numbers, dtype=np.float64),
            "hidden": list(hidden),
            "activation": activation,
        }


@dataclass(frozen=True)
class Linear(Policy):
    """Linear policy ``weights @ observation + bias``, in m/s² (pendulum: rad/s²), or in N for a system with ``m`` and ``k``."""

    weights: ArrayLike
    """One weight per observed number; for several actions a row for each."""
    bias: ArrayLike = 0.0
    """One number, or one per action."""

    def _request(self, observations: int, actions: int) -> dict[str, Any]:
        weights = _finite("weights", self.weights).ravel()
        if weights.size != observations * actions:
            rows = "" if actions == 1 else f" for each of {actions} actions"
            raise ValueError(
                f"there are {weights.size} weights, but there must be {observations * actions}, "
                f"one per observed number{rows}"
            )
        return self._numbers("linear", [*weights, *_per_action("bias", self.bias, actions)])


@dataclass(frozen=True)
class Random(Policy):
    """Random policy: uniform between two actions, drawn from the seed of the environment."""

    low: ArrayLike
    """One number, or one per action."""
    high: ArrayLike

    def _request(self, observations: int, actions: int) -> dict[str, Any]:
        lows, highs = (_per_action(name, getattr(self, name), actions) for name in ("low", "high"))
        for low, high in zip(lows, highs):
            if low >= high:
                raise ValueError(f"actions are from {low!r} to {high!r}, but low must be below high")
        return self._numbers("random", [*lows, *highs])


@dataclass(frozen=True)
class Constant(Policy):
    """Constant policy: the same action in every step."""

    action: ArrayLike = 0.0
    """One number, or one per input."""

    def _request(self, observations: int, actions: int) -> dict[str, Any]:
        return self._numbers("constant", _per_action("action", self.action, actions))


@dataclass(frozen=True)
class MLP(Policy):
    """A multilayer perceptron whose last layer is linear and has an output for each action.

    ``layers`` are pairs of a matrix ``(outputs, inputs)`` and biases ``(outputs,)``, as in PyTorch's ``Linear``. ``activation``,
    ``"tanh"`` or ``"relu"``, applies to all layers except the last.
    """

    layers: Sequence[tuple[ArrayLike, ArrayLike]]
    activation: str = field(default="tanh")

    def _request(self, observations: int, actions: int) -> dict[str, Any]:
        if self.activation not in ("tanh", "relu"):
            raise ValueError(f"activation is {self.activation!r}, but it must be 'tanh' or 'relu'")
        if not self.layers:
            raise ValueError("there are no layers, but there must be at least one")
        parts, widths, inputs = [], [], observations
        for i, layer in enumerate(self.layers):
            if not isinstance(layer, (tuple, list)) or len(layer) != 2:
                raise TypeError(f"layer {i} is no pair of a matrix and biases")
            matrix, biases = layer
            matrix, biases = _finite(f"matrix {i}", matrix), _finite(f"biases {i}", biases)
            outputs = len(biases) if biases.ndim == 1 else -1
            if matrix.shape != (outputs, inputs):
                raise ValueError(
                    f"matrix {i} has shape {matrix.shape} and its biases {biases.shape}, but they must be "
                    f"(outputs, {inputs}) and (outputs,)"
                )
            parts += [matrix.ravel(), biases]
            widths.append(outputs)
            inputs = outputs
        if widths[-1] != actions:
            raise ValueError(f"the last layer has {widths[-1]} outputs, but it must have {actions}")
        return self._numbers("network", np.concatenate(parts), widths[:-1], self.activation)
