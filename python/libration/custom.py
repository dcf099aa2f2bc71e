"""Tasks of one's own: what the engine's environments pay, said by Python."""

from __future__ import annotations

from typing import Any, Callable

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from .envs import VectorEnv

__all__ = ["CustomTaskVectorEnv"]


class CustomTaskVectorEnv(gymnasium.vector.VectorEnv):
    """Environments of the engine that pay what a function says.

    System, integrator, latencies, clocks and noise are the engine's, bit for bit; rewards and ends of episodes are those of ``task``, which is
    called once a step with arrays of all environments. A step costs what that takes and some ten microseconds besides, many times what the
    engine alone takes; rollouts inside the engine are not to be had.

    Parameters
    ----------
    name:
        ``"Oscillator"``, ``"Pendulum"`` or ``"Duffing"``.
    num_envs:
        How many.
    task:
        ``task(before, actions, after)`` of positions and velocities ``(N, 2)``, as they are and not as they are observed, and of actions
        ``(N, 1)``, gives rewards ``(N,)``, or a pair of them and whether each episode is over, ``(N,)``.
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
        self.inner = VectorEnv(name, num_envs, autoreset_mode="Disabled", **endless, **given)
        self.task = task
        self.num_envs = num_envs
        mode = AutoresetMode(getattr(autoreset_mode, "value", autoreset_mode))
        self.metadata = {**self.inner.metadata, "autoreset_mode": mode}
        self.render_mode = self.inner.render_mode
        for space in ("action_space", "observation_space"):
            setattr(self, space, getattr(self.inner, space))
            setattr(self, f"single_{space}", getattr(self.inner, f"single_{space}"))
        self._mode = mode
        self._ended = np.zeros(num_envs, bool)

    @property
    def states(self) -> NDArray[Any]:
        """Positions and velocities, ``(num_envs, 2)``."""
        return self.inner.states

    def reset(
        self, *, seed: Any = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        observations, infos = self.inner.reset(seed=seed, options=options)
        mask = (options or {}).get("reset_mask")
        self._ended[slice(None) if mask is None else mask] = False
        return observations, infos

    def step(
        self, actions: Any
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        late = self._ended.copy()
        if late.any():
            if self._mode is AutoresetMode.DISABLED:
                raise ResetNeeded(f"episodes of {np.flatnonzero(late).tolist()} are over: reset them first")
            self.inner.reset(options={"reset_mask": late})
        before = self.states
        observations, rewards, lost, truncated, _ = self.inner.step(actions)
        actions = np.reshape(np.asarray(actions, rewards.dtype), (self.num_envs, 1))
        paid = self.task(before, actions, self.states)
        rewards, over = paid if isinstance(paid, tuple) else (paid, np.zeros(self.num_envs, bool))
        rewards = self._row("rewards", rewards, observations.dtype)
        terminated = self._row("ends of episodes", over, np.dtype(bool)) | lost
        rewards[lost | late] = 0
        terminated[late] = truncated[late] = False
        self._ended = terminated | truncated
        if late.any():
            # Who began anew has not acted: it steps beside the others, and begins once more.
            observations = self.inner.reset(options={"reset_mask": late})[0]
        infos: dict[str, Any] = {}
        if self._mode is AutoresetMode.SAME_STEP and self._ended.any():
            ended, self._ended = self._ended, np.zeros(self.num_envs, bool)
            infos["final_obs"] = np.full(self.num_envs, None, dtype=object)
            for n in np.flatnonzero(ended):
                infos["final_obs"][n] = observations[n].copy()
            infos["_final_obs"] = ended
            infos["final_info"], infos["_final_info"] = {}, ended.copy()
            observations = self.inner.reset(options={"reset_mask": ended})[0]
        return observations, rewards, terminated, truncated, infos

    def _row(self, name: str, values: Any, dtype: np.dtype[Any]) -> NDArray[Any]:
        row = np.array(values, dtype)
        if row.shape != (self.num_envs,):
            raise ValueError(f"{name} of the task have shape {row.shape}, but it must be ({self.num_envs},)")
        return row

    def render(self) -> Any:
        return self.inner.render()

    def close_extras(self, **kwargs: Any) -> None:
        # Gymnasium closes what could not be made, too.
        if "inner" in self.__dict__:
            self.inner.close()
