"""Gymnasium vector environments of linear plants."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from ._arrays import real_numbers
from ._environment_keywords import LoopKeywords, Unpack
from ._episode_states import options_of
from ._settings import count, nearest, number
from .linear_loops import OpenLoops

__all__ = ["LinearVectorEnv"]

_TIMING = (
    *("period", "latency", "output_latency", "jitter", "skew", "loss", "missing", "cost_weights", "measurement_noise"),
    *("disturbance", "noise", "threads"),
)


class LinearVectorEnv(gymnasium.vector.VectorEnv):
    """Loops around a linear plant whose controller is the policy.

    An action has a command for each input of the plant, and an observation a measurement of each output; both have the latencies of
    the loop. The reward is minus the cost of the period. All episodes begin and end together: they are truncated after
    ``max_episode_steps`` periods, and the next step resets them. An environment whose states are not finite is terminated; its
    reward is 0 until the reset.

    Parameters
    ----------
    plant:
        As in :class:`~libration.LinearLoops`.
    num_envs:
        Number of environments.
    start:
        Largest initial size of each state, ``(states,)`` or a number; an episode starts uniformly within it.
    max_action:
        Largest size of an action, which is clipped (default: no limit).
    max_episode_steps:
        Number of periods of an episode.
    **timing:
        ``period``, ``latency``, ``output_latency``, ``jitter``, ``skew``, ``loss``, ``missing``, ``cost_weights``,
        ``measurement_noise``, ``disturbance``, ``noise`` and ``threads``, as in :class:`~libration.LinearLoops`.
    """

    metadata: dict[str, Any] = {"autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        plant: Any,
        num_envs: int = 1,
        *,
        start: ArrayLike = 1.0,
        max_action: float = np.inf,
        max_episode_steps: int = 1000,
        **timing: Unpack[LoopKeywords],
    ) -> None:
        for name in timing:
            if name in ("controller", "reference", "x0", "seed", "num_loops"):
                raise TypeError(f"unexpected keyword argument {name!r}: the policy is the controller, and start gives the states")
            if name not in _TIMING:
                own = ("start", "max_action", "max_episode_steps", *_TIMING)
                raise TypeError(f"unexpected keyword argument {name!r}: {nearest(name, own)}")
        self._loops = OpenLoops(plant, None, count("num_envs", num_envs, 1, 2**40), **timing)
        self.num_envs = self._loops.num_loops
        states, inputs, outputs = (
            len(names) for names in (self._loops.state_names, self._loops.input_names, self._loops.output_names)
        )
        self._start = np.broadcast_to(np.asarray(start, dtype=np.float64), (states,))
        if not (np.isfinite(self._start).all() and (self._start >= 0).all()):
            raise ValueError(f"start is {start!r}; expected finite numbers of at least 0")
        self._most = number("max_action", max_action, "greater than 0", lambda x: x > 0)
        self._limit = count("max_episode_steps", max_episode_steps, 1, 2**62)
        self.single_observation_space = Box(-np.inf, np.inf, (outputs,), np.float64)
        self.single_action_space = Box(-self._most, self._most, (inputs,), np.float64)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._cost: NDArray[np.float64] | None = None
        self._ended = False
        self._lost = np.zeros(self.num_envs, dtype=bool)

    def __copy__(self) -> LinearVectorEnv:
        # A shallow copy would step the loops of the original.
        raise TypeError("a LinearVectorEnv cannot be copied; help: make others with the same arguments")

    @property
    def loops(self) -> OpenLoops:
        """The loops, with names, units and period."""
        return self._loops

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Begin an episode in all environments; ``seed`` is a number. There are no ``options``."""
        self._expect_open()
        if isinstance(seed, list):
            raise TypeError("seed is a list; expected a number: environment n draws from stream n of one seed")
        for name in options_of(options):
            raise ValueError(f"options has {name!r}; expected no options")
        super().reset(seed=seed)
        observations = self._begin()
        return observations, {}

    def _expect_open(self) -> None:
        if self.closed:
            raise ClosedEnvironmentError("the environments are closed; expected open ones")

    def _begin(self) -> NDArray[np.float64]:
        start = self.np_random.uniform(-self._start, self._start, (self.num_envs, len(self._start)))
        self._loops.reset(int(self.np_random.integers(2**63)), start)
        row = self._loops.step(0)
        self._cost, self._ended = row.cost, False
        self._lost[:] = False
        return row.outputs

    def step(
        self, actions: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        self._expect_open()
        if self._cost is None:
            raise ResetNeeded("step was called before reset; expected reset first")
        nothing = np.zeros(self.num_envs, dtype=bool)
        if self._ended:
            return self._begin(), np.zeros(self.num_envs), nothing, nothing.copy(), {}
        commands = real_numbers(actions).astype(np.float64)
        if commands.shape != self.action_space.shape:
            raise ValueError(f"actions have shape {commands.shape}; expected {self.action_space.shape}")
        commands = np.ascontiguousarray(np.clip(commands, -self._most, self._most))
        if not (finite := np.isfinite(commands)).all():
            n, i = np.argwhere(~finite)[0]
            name = self._loops.input_names[i]
            raise ValueError(f"actions have the entry {commands[n, i]} for {name!r} in environment {n}; expected finite numbers")
        row = self._loops.command(commands)
        lost = ~(np.isfinite(row.cost) & np.isfinite(row.states).all(axis=1))
        with np.errstate(invalid="ignore"):
            rewards = np.where(lost, 0.0, self._cost - row.cost)
        terminated = lost & ~self._lost
        self._cost, self._lost = row.cost, lost
        self._ended = self._loops.step_count >= self._limit or bool(lost.all())
        truncated = np.full(self.num_envs, self._ended) & ~lost
        return row.outputs, rewards, terminated, truncated, {"lost": lost.copy(), "_lost": lost.copy()} if lost.any() else {}
