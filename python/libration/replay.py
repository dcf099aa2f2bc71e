"""Replay buffers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._named import named
from ._settings import count, number
from .environments import Environments
from .rollout import Rollout

__all__ = ["ReplayBuffer", "Sequences", "Transitions"]


@dataclass(frozen=True)
class Transitions:
    """Transitions that were drawn: ``B`` of them."""

    numbers: NDArray[np.uint64]
    """By which priorities are changed, ``(B,)``."""
    observations: NDArray[Any]
    """``(B, n)``."""
    actions: NDArray[Any]
    """``(B, 1)``."""
    rewards: NDArray[Any]
    """What was paid, with the discounted steps after it as far as one looks ahead, ``(B,)``."""
    next_observations: NDArray[Any]
    """What was seen after the last of these steps, ``(B, n)``; the last observation of the episode where it ended."""
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    discounts: NDArray[Any]
    """What the value of the next observations counts, ``(B,)``: 0 where the episode was over."""
    weights: NDArray[Any]
    """What each counts for the mean to be that of uniform draws, ``(B,)``; 1 at most."""


@dataclass(frozen=True)
class Sequences:
    """Stretches of ``T`` steps that were drawn: ``B`` of them."""

    numbers: NDArray[np.uint64]
    """Of the first transition of each, ``(B,)``."""
    observations: NDArray[Any]
    """``(B, T, n)``."""
    actions: NDArray[Any]
    """``(B, T, 1)``."""
    rewards: NDArray[Any]
    """``(B, T)``."""
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    mask: NDArray[np.bool_]
    """Whether the episode goes on in which the stretch began, ``(B, T)``."""
    next_observations: NDArray[Any]
    """What was seen after the last step of the mask, ``(B, n)``."""


class ReplayBuffer:
    """The last transitions of environments, of which batches are drawn.

    Parameters
    ----------
    environments:
        Whose rollouts come in.
    steps:
        How many of each environment are kept.
    priorities:
        Whether transitions have priorities.
    ends:
        Room for ends of episodes, by default a quarter of all transitions: where there are more, the oldest steps go earlier.
    seed:
        Of all draws. Draw ``number`` is the same whatever was drawn before.

    Raises
    ------
    ValueError
        For a capacity of nothing.
    MemoryError
        If there is no room.
    """

    @named
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
        settings = environments._settings
        self.seed = count("seed", seed, 0, 2**64 - 1)
        #: The number of the next draw.
        self.number = 0
        self._buffer = _native.Buffer(
            count("steps", steps, 1, 2**40),
            settings["num_envs"],
            len(environments.preset.seen),
            settings["dtype"] == "float32",
            bool(priorities),
            None if ends is None else count("ends", ends, 1, 2**40),
        )

    def __len__(self) -> int:
        return len(self._buffer)

    def __copy__(self) -> ReplayBuffer:
        raise TypeError("a ReplayBuffer cannot be copied")

    def __reduce__(self) -> Any:
        raise TypeError("a ReplayBuffer cannot be pickled")

    def insert(self, rollout: Rollout) -> None:
        """Take what a rollout holds; the oldest steps make room for it.

        Raises
        ------
        ValueError
            For a rollout of other environments, or of more steps than are kept.
        """
        if not isinstance(rollout, Rollout):
            raise TypeError(f"rollout must be a Rollout, not {type(rollout).__name__}")
        self._buffer._insert(rollout._memory, rollout.last_observations)

    def sample(
        self,
        batch_size: int,
        *,
        steps: int = 1,
        gamma: float = 0.99,
        correction: float | None = None,
    ) -> Transitions:
        """Draw transitions with replacement, each as likely.

        Parameters
        ----------
        steps:
            How far each looks ahead: its reward is the discounted sum of so many.
        gamma:
            The discount, from 0 to 1.
        correction:
            Draw in proportion to priorities, and correct for that with this exponent, from 0 to 1 (Schaul et al. 2016, section 3.4).

        Raises
        ------
        ValueError
            If there is nothing to draw, or a ``correction`` without priorities.
        MemoryError
            If there is no room for the batch.
        """
        asked = self._asked(batch_size, steps, gamma)
        if correction is not None:
            asked["correction"] = number("correction", correction, "0 to 1")
        drawn = Transitions(**self._buffer._sample(asked))
        self.number += 1
        return drawn

    def sample_sequences(self, batch_size: int, steps: int) -> Sequences:
        """Draw stretches of so many steps with replacement, each as likely.

        Raises
        ------
        ValueError
            If no environment has as many steps in the buffer.
        MemoryError
            If there is no room for the batch.
        """
        drawn = Sequences(**self._buffer._sequences(self._asked(batch_size, steps, 1.0)))
        self.number += 1
        return drawn

    def update_priorities(
        self, numbers: NDArray[np.uint64], priorities: ArrayLike, exponent: float = 0.6
    ) -> int:
        """Give transitions other priorities: they are drawn in proportion to ``priority ** exponent``.

        Parameters
        ----------
        numbers:
            Of transitions that were drawn, ``(B,)``.
        priorities:
            ``(B,)``, none of them negative: sizes of errors, as a rule.

        Returns
        -------
        int
            How many of them are still there.

        Raises
        ------
        ValueError
            For other shapes, a priority that is negative or not finite, or a buffer without priorities.
        """
        which, errors = np.asarray(numbers), np.asarray(priorities)
        if which.dtype.kind not in "iu" or errors.dtype.kind not in "fiu":
            raise TypeError(
                f"numbers have dtype {which.dtype} and priorities {errors.dtype}, but they must be whole and real numbers"
            )
        if which.ndim != 1 or which.shape != errors.shape or (which < 0).any():
            raise ValueError(
                f"numbers have shape {which.shape} and priorities {errors.shape}, but they must be (B,), and "
                "numbers those that were drawn"
            )
        exponent = number("exponent", exponent, "finite")
        which, errors = which.astype(np.uint64), errors.astype(np.float64)
        return self._buffer._update(np.ascontiguousarray(which), np.ascontiguousarray(errors), exponent)

    def _asked(self, batch_size: int, steps: int, gamma: float) -> dict[str, Any]:
        asked = {
            "len": count("batch_size", batch_size, 1, 2**32),
            "seed": count("seed", self.seed, 0, 2**64 - 1),
            "number": count("number", self.number, 0, 2**64 - 1),
            "steps": count("steps", steps, 1, 2**32),
            "gamma": number("gamma", gamma, "0 to 1"),
            "correction": None,
        }
        return asked
