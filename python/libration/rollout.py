"""Rollouts of environments."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._keywords import check_keywords
from ._native import Memory
from ._settings import number

__all__ = ["Rollout"]


class Rollout:
    """Tensors of a rollout of ``T`` steps of ``N`` environments with ``n`` observed numbers.

    The arrays are views of the memory of the engine. If the rollout is overwritten (``out=``), they show the new data. They stay valid
    after the rollout and its environments are deleted.
    """

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        arrays = memory._arrays()
        #: Observations before the actions, ``(T, N, n)``.
        self.observations: NDArray[Any] = arrays["observations"]
        #: Actions of the policy, ``(T, N, 1)``.
        self.actions: NDArray[Any] = arrays["actions"]
        #: Rewards, ``(T, N)``.
        self.rewards: NDArray[Any] = arrays["rewards"]
        #: Whether the episode terminated, ``(T, N)``.
        self.terminated: NDArray[np.bool_] = arrays["terminated"]
        #: Whether the episode was truncated, ``(T, N)``.
        self.truncated: NDArray[np.bool_] = arrays["truncated"]
        #: Log-probabilities of the actions, ``(T, N)``, with ``log_probs=True``.
        self.log_probs: NDArray[Any] | None = arrays.get("log_probabilities")
        #: Values of the observations, ``(T, N)``, with ``values=True``; the caller writes them.
        self.values: NDArray[Any] | None = arrays.get("values")
        #: Observations after the last step, ``(N, n)``.
        self.last_observations: NDArray[Any] = np.empty(0)

    @property
    def episodes(self) -> dict[str, NDArray[Any]]:
        """Ended episodes, by step and environment: ``steps``, ``environments``, ``lengths``, ``returns``, ``lost`` and
        ``final_observations``."""
        return self._memory._ends()

    @property
    def transitions(self) -> NDArray[np.bool_]:
        """Whether each step is a transition, ``(T, N)``; false for a reset or an environment that waits for one."""
        return self._memory._transitions()

    @check_keywords
    def advantages(
        self,
        gamma: float = 0.99,
        gae_lambda: float = 0.95,
        *,
        last_values: ArrayLike,
        final_values: ArrayLike = (),
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return generalised advantage estimates and returns, ``(T, N)`` each, from ``values``.

        Parameters
        ----------
        gamma, gae_lambda:
            Discounts of rewards and of errors, from 0 to 1. With ``gae_lambda=1`` the returns are sums of discounted rewards.
        last_values:
            Values of ``last_observations``, ``(N,)``.
        final_values:
            Values of the ``final_observations`` of ``episodes``, one per ended episode; used for truncated ones.

        Raises
        ------
        ValueError
            If the rollout has no ``values``, or the number of other values is wrong.
        """
        if self.values is None:
            raise ValueError("the rollout has no values; help: call rollout with values=True")
        discounts = [number("gamma", gamma, "finite"), number("gae_lambda", gae_lambda, "finite")]
        last, final = (np.asarray(x, dtype=np.float64).ravel() for x in (last_values, final_values))
        found = self._memory._estimates(discounts[0], discounts[1], last.tolist(), final.tolist())
        advantages, returns = found
        return advantages, returns
