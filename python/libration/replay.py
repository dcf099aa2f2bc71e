"""Replay buffers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._keywords import check_keywords
from ._settings import count, number
from .environments import Environments
from .rollout import Rollout

__all__ = ["ReplayBuffer", "Sequences", "Transitions"]


def _is_share(value: float) -> bool:
    return 0 <= value <= 1


@dataclass(frozen=True)
class Transitions:
    """Batch of ``B`` transitions, each with ``n`` observed numbers and ``m`` actions."""

    indices: NDArray[np.uint64]
    """Indices for :meth:`ReplayBuffer.update_priorities`, ``(B,)``."""
    observations: NDArray[Any]
    """Observations before the actions, ``(B, n)``."""
    actions: NDArray[Any]
    """Actions as in ``Rollout.actions``, ``(B, m)``."""
    rewards: NDArray[Any]
    """Discounted sums of rewards over ``steps`` steps, ``(B,)``."""
    next_observations: NDArray[Any]
    """Observations after the last of these steps, ``(B, n)``; the final observation if the episode ended."""
    terminated: NDArray[np.bool_]
    """Whether the episode terminated with the last of these steps, ``(B,)``."""
    truncated: NDArray[np.bool_]
    """Whether the time limit truncated the episode at the last of these steps, ``(B,)``."""
    discounts: NDArray[Any]
    """Discounts of the values of ``next_observations``, ``(B,)``; 0 if the episode terminated."""
    weights: NDArray[Any]
    """Importance weights relative to uniform sampling, ``(B,)``; at most 1."""


@dataclass(frozen=True)
class Sequences:
    """Batch of ``B`` sequences of ``T`` steps, each with ``n`` observed numbers and ``m`` actions."""

    indices: NDArray[np.uint64]
    """Indices of the first transitions, ``(B,)``."""
    observations: NDArray[Any]
    """Observations before the actions, ``(B, T, n)``."""
    actions: NDArray[Any]
    """Actions as in ``Rollout.actions``, ``(B, T, m)``."""
    rewards: NDArray[Any]
    """Rewards, ``(B, T)``."""
    terminated: NDArray[np.bool_]
    """Whether the episode terminated with the step, ``(B, T)``."""
    truncated: NDArray[np.bool_]
    """Whether the time limit truncated the episode at the step, ``(B, T)``."""
    mask: NDArray[np.bool_]
    """Whether a step belongs to the episode of the first step, ``(B, T)``."""
    next_observations: NDArray[Any]
    """Observations after the last step of the mask, ``(B, n)``."""


class ReplayBuffer:
    """Replay buffer of the last transitions of environments.

    Parameters
    ----------
    environments:
        Environments of the rollouts to insert, with any numbers of observed numbers and actions. Of discrete actions
        commands are stored, those of the policy before the nearest level was taken; of a chunk all its actions.
    steps:
        Capacity in steps per environment.
    priorities:
        Whether transitions have priorities.
    ends:
        Capacity for ends of episodes (default: a quarter of all transitions). If it is full, the oldest steps are dropped earlier.
    seed:
        Seed of all draws. Draw ``number`` is independent of earlier draws.

    Raises
    ------
    TypeError, ValueError
        For an invalid argument, such as a capacity of zero.
    MemoryError
        If there is not enough memory.
    """

    @check_keywords
    def __init__(
        self,
        environments: Environments,
        steps: int,
        *,
        priorities: bool = False,
        ends: int | None = None,
        seed: int = 0,
    ) -> None:
        if not isinstance(environments, Environments):
            raise TypeError(f"environments must be Environments, not {type(environments).__name__}")
        preset = environments.preset
        if not isinstance(priorities, bool):
            raise TypeError(f"priorities must be True or False, not {type(priorities).__name__}")
        settings = environments._settings
        self.seed = count("seed", seed, 0, 2**64 - 1)
        #: Number of the next draw.
        self.number = 0
        self._dtype = np.dtype(settings["dtype"])
        self._sizes = [len(preset.seen), len(preset.actions)]
        self._shown = f"steps={steps}, num_envs={settings['num_envs']}, priorities={priorities}, dtype='{self._dtype}'"
        self._buffer = _native.Buffer(
            count("steps", steps, 1, 2**40),
            settings["num_envs"],
            self._sizes,
            settings["dtype"] == "float32",
            priorities,
            None if ends is None else count("ends", ends, 1, 2**40),
        )

    def __len__(self) -> int:
        return len(self._buffer)

    def __repr__(self) -> str:
        observations, actions = self._sizes
        return f"ReplayBuffer({self._shown}; {len(self)} transitions with {observations} observed numbers and {actions} actions)"

    def __copy__(self) -> ReplayBuffer:
        raise TypeError("a ReplayBuffer cannot be copied")

    def __reduce__(self) -> Any:
        raise TypeError("a ReplayBuffer cannot be pickled")

    def insert(self, rollout: Rollout) -> None:
        """Insert a rollout; it replaces the oldest steps.

        Raises
        ------
        ValueError
            For a rollout with another number of environments, observed numbers or actions, of another dtype, or with more steps or
            ends of episodes than the capacity. The buffer is then unchanged.
        """
        if not isinstance(rollout, Rollout):
            raise TypeError(f"rollout must be a Rollout, not {type(rollout).__name__}")
        if rollout.rewards.dtype != self._dtype:
            raise ValueError(f"the rollout has the dtype {rollout.rewards.dtype}, but the buffer has {self._dtype}")
        self._buffer._insert(rollout._memory, rollout.last_observations)

    def sample(
        self,
        batch_size: int,
        *,
        steps: int = 1,
        gamma: float = 0.99,
        correction: float | None = None,
    ) -> Transitions:
        """Return ``batch_size`` transitions, drawn uniformly with replacement.

        Parameters
        ----------
        steps:
            Number of steps of the discounted sum of rewards.
        gamma:
            Discount factor, from 0 to 1.
        correction:
            Sample in proportion to priorities, with importance weights of this exponent, 0 to 1 (Schaul et al. 2016, section 3.4).

        Raises
        ------
        ValueError
            If the buffer is empty, or for a ``correction`` without priorities.
        MemoryError
            If there is not enough memory for the batch.
        """
        request = self._sample_request(batch_size, steps, gamma)
        if correction is not None:
            request["correction"] = number("correction", correction, "0 to 1", _is_share)
        drawn = Transitions(**self._buffer._sample(request))
        self.number += 1
        return drawn

    def sample_sequences(self, batch_size: int, steps: int) -> Sequences:
        """Return ``batch_size`` sequences of ``steps`` steps, drawn uniformly with replacement.

        Raises
        ------
        ValueError
            If no environment has enough steps in the buffer.
        MemoryError
            If there is not enough memory for the batch.
        """
        drawn = Sequences(**self._buffer._sequences(self._sample_request(batch_size, steps, 1.0)))
        self.number += 1
        return drawn

    def update_priorities(
        self, indices: NDArray[np.uint64], priorities: ArrayLike, exponent: float = 0.6
    ) -> int:
        """Set priorities; transitions are drawn in proportion to ``priority ** exponent``.

        Parameters
        ----------
        indices:
            Numbers of drawn transitions, ``(B,)``.
        priorities:
            Non-negative priorities, such as absolute errors, ``(B,)``.

        Returns
        -------
        int
            Number of these transitions that are still in the buffer.

        Raises
        ------
        ValueError
            For a wrong shape, a priority that is negative or not finite, or a buffer without priorities.
        """
        which, errors = np.asarray(indices), np.asarray(priorities)
        if which.shape == errors.shape == (0,):
            return 0
        if which.dtype.kind not in "iu" or errors.dtype.kind not in "fiu":
            raise TypeError(
                f"indices have dtype {which.dtype} and priorities {errors.dtype}, but they must be whole numbers and real numbers"
            )
        if which.ndim != 1 or which.shape != errors.shape or (which < 0).any():
            raise ValueError(
                f"indices have shape {which.shape} and priorities {errors.shape}, but they must be (B,), and "
                "indices those that were drawn"
            )
        exponent = number("exponent", exponent, "finite")
        which, errors = which.astype(np.uint64), errors.astype(np.float64)
        limits = np.finfo(self._dtype)
        large = errors[np.isfinite(errors) & (errors > limits.max)]
        if large.size:
            raise ValueError(f"a priority is {large[0]:g}, but it must be at most {limits.max:g} in {self._dtype}")
        # What is not zero stays so.
        errors = np.where((errors > 0) & (errors < limits.tiny), limits.tiny, errors)
        return self._buffer._update(np.ascontiguousarray(which), np.ascontiguousarray(errors), exponent)

    def _sample_request(self, batch_size: int, steps: int, gamma: float) -> dict[str, Any]:
        request = {
            "len": count("batch_size", batch_size, 1, 2**32),
            "seed": count("seed", self.seed, 0, 2**64 - 1),
            "number": count("number", self.number, 0, 2**64 - 1),
            "steps": count("steps", steps, 1, 2**32),
            "gamma": number("gamma", gamma, "0 to 1", _is_share),
            "correction": None,
        }
        return request
