"""What environments did over a horizon."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._named import named
from ._native import Memory
from ._settings import number

__all__ = ["Rollout"]


class Rollout:
    """Tensors of a rollout of ``T`` steps of ``N`` environments that show ``n`` numbers.

    They are the memory that the engine writes, without a copy: a rollout that is filled again shows the new one in all arrays that were
    ever taken of it, and they outlive it and its environments.
    """

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        arrays = memory._arrays()
        #: What was seen before each action, ``(T, N, n)``.
        self.observations: NDArray[Any] = arrays["observations"]
        #: What was asked for, ``(T, N, 1)``.
        self.actions: NDArray[Any] = arrays["actions"]
        #: What it paid, ``(T, N)``.
        self.rewards: NDArray[Any] = arrays["rewards"]
        #: Whether the episode was over, ``(T, N)``.
        self.terminated: NDArray[np.bool_] = arrays["terminated"]
        #: Whether it was cut off, ``(T, N)``.
        self.truncated: NDArray[np.bool_] = arrays["truncated"]
        #: Logarithms of the probability densities of actions, ``(T, N)``, if they were asked for.
        self.log_probabilities: NDArray[Any] | None = arrays.get("log_probabilities")
        #: What observations are worth, ``(T, N)``, to be written by the caller, if they were asked for.
        self.values: NDArray[Any] | None = arrays.get("values")
        #: What is seen after the last step, ``(N, n)``.
        self.last_observations: NDArray[Any] = np.empty(0)

    @property
    def episodes(self) -> dict[str, NDArray[Any]]:
        """Episodes that ended, by step and environment: ``steps``, ``environments``, ``lengths``, ``returns``, ``lost`` and
        ``final_observations``."""
        return self._memory._ends()

    @property
    def transitions(self) -> NDArray[np.bool_]:
        """Whether each step is one, ``(T, N)``: not where an environment stood still or began anew."""
        return self._memory._transitions()

    @named
    def advantages(
        self,
        gamma: float = 0.99,
        lam: float = 0.95,
        *,
        last_values: ArrayLike,
        final_values: ArrayLike = (),
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Generalised advantage estimates and returns, ``(T, N)`` each, from ``values``.

        Parameters
        ----------
        gamma, lam:
            Discounts of rewards and of errors, from 0 to 1. With a ``lam`` of 1 returns are sums of discounted rewards.
        last_values:
            What ``last_observations`` are worth, ``(N,)``.
        final_values:
            What the ``final_observations`` of ``episodes`` are worth, one for each: of those that were cut off it counts.

        Raises
        ------
        ValueError
            If the rollout has no ``values``, or there are more or fewer of the others than are needed.
        """
        if self.values is None:
            raise ValueError("the rollout has no values: ask for them with values=True")
        discounts = [number("gamma", gamma, "finite"), number("lam", lam, "finite")]
        last, final = (np.asarray(x, dtype=np.float64).ravel() for x in (last_values, final_values))
        found = self._memory._estimates(discounts[0], discounts[1], last.tolist(), final.tolist())
        advantages, returns = found
        return advantages, returns
