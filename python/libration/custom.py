"""Tasks of one's own: what the engine's environments pay, said by Python."""

from __future__ import annotations

import copy
import threading
from typing import Any, Callable

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from ._arrays import actions as read
from .envs import VectorEnv

__all__ = ["CustomTaskVectorEnv"]


class CustomTaskVectorEnv(gymnasium.vector.VectorEnv):
    """Environments of the engine that pay what a function says.

    System, integrator, latencies, clocks and noise are the engine's, bit for bit; rewards and ends of episodes are those of ``task``, which is
    called once a step with arrays of all environments. A step costs what that takes and several calls of NumPy besides, where the engine
    alone takes one call; rollouts inside the engine are not to be had.

    Parameters
    ----------
    name:
        ``"Oscillator"``, ``"Pendulum"`` or ``"Duffing"``.
    num_envs:
        How many.
    task:
        ``task(before, actions, after)`` of positions and velocities ``(N, 2)``, as they are and not as they are observed, and of actions
        ``(N, 1)`` within ``max_action``, gives rewards ``(N,)``, or a pair of them and whether each episode is over, ``(N,)``.
    **given:
        As for :class:`libration.Environments`; prices of tasks are not among them.

    Raises
    ------
    TypeError, ValueError
        As there; in a step, where the task gives something else.
    """

    def __init__(
        self,
        name: str,
        num_envs: int = 1,
        *,
        task: Callable[[np.ndarray, np.ndarray, np.ndarray], Any],
        autoreset_mode: Any = "NextStep",
        **given: Any,
    ) -> None:
        if not callable(task):
            raise TypeError(f"task must be a function, not {type(task).__name__}")
        for price in ("position_cost", "velocity_cost", "effort_cost", "bound"):
            if price in given:
                raise TypeError(f"unexpected keyword argument {price!r}: the task says what is paid")
        endless: dict[str, Any] = {} if name == "Pendulum" else {"bound": np.inf}
        mode = getattr(autoreset_mode, "value", autoreset_mode)
        # Who is reset in the step that ends an episode is reset here: the task has yet to say that it has ended.
        inner = "Disabled" if mode == "SameStep" else mode
        kept = given.pop("copy", True)
        if kept is not True:
            raise ValueError(f"copy is {kept!r}, but it must be True: what the task makes is new in any case")
        self.inner = VectorEnv(name, num_envs, autoreset_mode=inner, **endless, **given)
        self.task = task
        self.num_envs = self.inner.num_envs
        self._mode = AutoresetMode(mode)
        self.metadata = {**self.inner.metadata, "autoreset_mode": self._mode}
        self.render_mode = self.inner.render_mode
        for space in ("action_space", "observation_space"):
            setattr(self, space, getattr(self.inner, space))
            setattr(self, f"single_{space}", getattr(self.inner, f"single_{space}"))
        self._most = self.inner._settings["saturation"]
        self._ended = np.zeros(self.num_envs, bool)
        self._turn = threading.RLock()

    @property
    def states(self) -> NDArray[Any]:
        """Positions and velocities, ``(num_envs, 2)``."""
        return self.inner.states

    def reset(
        self, *, seed: Any = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        with self._turn:
            observations, infos = self.inner.reset(seed=seed, options=options)
            mask = (options or {}).get("reset_mask")
            self._ended[slice(None) if mask is None else mask] = False
            return observations, infos

    def step(
        self, actions: Any
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        with self._turn:
            return self._step(actions)

    def _step(self, actions: Any) -> Any:
        # Under NEXT_STEP these begin anew in this step.
        began = self._ended.copy()
        if self._mode is AutoresetMode.DISABLED and began.any():
            raise ResetNeeded(f"episodes of {np.flatnonzero(began).tolist()} are over: reset them first")
        before = self.states
        observations, rewards, lost, truncated, infos = self.inner.step(actions)
        # Whatever the task does: what the engine says of the end holds.
        self._ended = lost | truncated
        taken = read(actions, self.num_envs, rewards.dtype.name).reshape(self.num_envs, 1)
        try:
            paid = self.task(before, np.clip(taken, -self._most, self._most), self.states)
            given, over = paid if isinstance(paid, tuple) else (paid, np.zeros(self.num_envs, bool))
            rewards = self._row("rewards", given, "fiu").astype(observations.dtype)
            terminated = (self._row("ends of episodes", over, "b") & ~began) | lost
        except BaseException:
            # Whoever is reset in the step that ends an episode does not wait for the task.
            if self._mode is AutoresetMode.SAME_STEP and self._ended.any():
                self.inner.reset(options={"reset_mask": self._ended})
                self._ended = np.zeros(self.num_envs, bool)
            raise
        rewards[lost | began] = 0
        ended = terminated | truncated
        if self._mode is AutoresetMode.SAME_STEP:
            self._ended = np.zeros(self.num_envs, bool)
            if ended.any():
                final = np.full(self.num_envs, None, dtype=object)
                for n in np.flatnonzero(ended):
                    final[n] = observations[n].copy()
                infos = {
                    "final_obs": final,
                    "_final_obs": ended,
                    "final_info": infos,
                    "_final_info": ended.copy(),
                }
                observations = self.inner.reset(options={"reset_mask": ended})[0]
        else:
            self.inner._end(terminated)
            self._ended = ended
        return observations, rewards, terminated, truncated, infos

    def _row(self, name: str, values: Any, kinds: str) -> NDArray[Any]:
        row = np.asarray(values)
        if row.shape != (self.num_envs,):
            raise ValueError(f"{name} of the task have shape {row.shape}, but it must be ({self.num_envs},)")
        if row.dtype.kind not in kinds:
            allowed = "bool" if kinds == "b" else "real numbers"
            raise TypeError(f"{name} of the task have dtype {row.dtype}, but they must be {allowed}")
        return row

    def __getstate__(self) -> dict[str, Any]:
        # Whose turn it is belongs to this process.
        return {name: value for name, value in self.__dict__.items() if name != "_turn"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _turn=threading.RLock())

    def __copy__(self) -> CustomTaskVectorEnv:
        return self.__deepcopy__({})

    def __deepcopy__(self, memo: dict[int, Any]) -> CustomTaskVectorEnv:
        twin: CustomTaskVectorEnv = object.__new__(type(self))
        twin.__dict__.update(self.__dict__, inner=copy.deepcopy(self.inner, memo))
        twin._ended, twin._turn = self._ended.copy(), threading.RLock()
        return twin

    def render(self) -> Any:
        return self.inner.render()

    def close_extras(self, **kwargs: Any) -> None:
        # Gymnasium closes what could not be made, too.
        if "inner" in self.__dict__:
            self.inner.close()
