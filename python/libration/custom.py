"""Environments whose rewards a Python function computes."""

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
from ._arrays import choices
from ._environment_keywords import CustomTaskKeywords, Unpack
from ._episode_numbers import largest
from ._gymnasium_envs import VectorEnv
from .equations import EquationSystem
from .linear import LinearPlant
from .systems import System, with_commands

__all__ = ["CustomTaskVectorEnv"]


class CustomTaskVectorEnv(gymnasium.vector.VectorEnv):
    """Gymnasium vector environment with rewards and terminations from a Python function.

    The engine computes system, integrator, latencies, clocks and noise, bit for bit. It calls ``task`` once per step with arrays of all
    environments. A step takes the time of ``task`` and of several NumPy calls. Rollouts inside the engine are not available.

    Parameters
    ----------
    name:
        Name of a preset, or a system, as in :class:`libration.VectorEnv`.
    num_envs:
        Number of environments.
    task:
        Function ``task(before, actions, after)``. ``before`` and ``after`` are true states, ``(N, states)``, such as position and
        velocity; ``actions`` are limited to ``max_action``, ``(N, inputs)``. It returns rewards ``(N,)``, or a pair of rewards and
        terminations ``(N,)``.
    **given:
        Keywords of :class:`libration.Environments`, except the costs of tasks.

    Raises
    ------
    TypeError, ValueError
        As for :class:`libration.Environments`; in a step, if the result of ``task`` has a wrong shape or type.
    """

    def __init__(
        self,
        name: str | EquationSystem | System | LinearPlant,
        num_envs: int = 1,
        *,
        task: Callable[[np.ndarray, np.ndarray, np.ndarray], Any],
        autoreset_mode: str | AutoresetMode = "NextStep",
        **given: Unpack[CustomTaskKeywords],
    ) -> None:
        if not callable(task):
            raise TypeError(f"task must be a function, not {type(task).__name__}")
        for price in ("position_cost", "velocity_cost", "effort_cost", "bound"):
            if price in given:
                raise TypeError(f"unexpected keyword argument {price!r}: the task determines rewards")
        endless: dict[str, Any] = {} if name == "Pendulum" else {"bound": np.inf}
        name = with_commands(name)
        if isinstance(name, EquationSystem):
            for own in ("reward", "terminated"):
                if own in given:
                    raise TypeError(f"unexpected keyword argument {own!r}: the task determines rewards")
            endless = {"reward": "0", "terminated": []}
        mode = getattr(autoreset_mode, "value", autoreset_mode)
        # Under SAME_STEP this class resets: the task decides after the inner step whether an episode has ended.
        inner = "Disabled" if mode == "SameStep" else mode
        kept = given.pop("copy", True)
        if kept is not True:
            raise ValueError(f"copy is {kept!r}, but it must be True; the arrays of a task are always new")
        self.inner = VectorEnv(name, num_envs, autoreset_mode=inner, **endless, **given)
        self.task = task
        self.num_envs = self.inner.num_envs
        self._mode = AutoresetMode(mode)
        self.metadata = {**self.inner.metadata, "autoreset_mode": self._mode}
        self.render_mode = self.inner.render_mode
        for space in ("action_space", "observation_space"):
            setattr(self, space, getattr(self.inner, space))
            setattr(self, f"single_{space}", getattr(self.inner, f"single_{space}"))
        saturation = self.inner._settings["subject"]["saturation"]
        if not isinstance(saturation, float) and any(kind != "constant" for kind, _ in saturation):
            raise ValueError(f"max_action is {given['max_action']!r}, but it must be a number or one for each input")
        self._most = np.array(largest(saturation))
        self._ended = np.zeros(self.num_envs, bool)
        self._turn = threading.RLock()

    @property
    def states(self) -> NDArray[Any]:
        """True states, ``(num_envs, states)``, such as position and velocity."""
        return self.inner.states

    def reset(
        self, *, seed: Any = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        with self._turn:
            observations, infos = self.inner.reset(seed=seed, options=options)
            if seed is not None:
                self._np_random, self._np_random_seed = self.inner._np_random, self.inner._np_random_seed
            mask = (options or {}).get("reset_mask")
            self._ended[slice(None) if mask is None else mask] = False
            return observations, infos

    def step(
        self, actions: Any
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        with self._turn:
            return self._step(actions)

    def _step(self, actions: Any) -> Any:
        # Under NEXT_STEP these environments are reset in this step.
        began = self._ended.copy()
        if self._mode is AutoresetMode.DISABLED and began.any():
            raise ResetNeeded(f"episodes of {np.flatnonzero(began).tolist()} are over; help: reset them first")
        before = self.states
        observations, rewards, lost, truncated, infos = self.inner.step(actions)
        # Terminations of the engine hold even if the task fails.
        self._ended = lost | truncated
        shape = (self.num_envs, len(self.inner.preset.actions))
        levels, dtype = self.inner._settings["levels"], rewards.dtype.name
        taken = (choices(actions, self.num_envs, levels, dtype) if levels else read(actions, shape, dtype)).reshape(shape)
        most = self._most.astype(dtype)
        try:
            paid = self.task(before, np.clip(taken, -most, most), self.states)
            if isinstance(paid, tuple) and len(paid) != 2:
                raise ValueError(f"the task returned {len(paid)} values, but it must return rewards, or rewards and ends of episodes")
            given, over = paid if isinstance(paid, tuple) else (paid, np.zeros(self.num_envs, bool))
            rewards = self._row("rewards", given, "fiu").astype(observations.dtype)
            # As in the engine, a reward that is no number ends an episode.
            unpaid = ~np.isfinite(rewards) & ~began
            if unpaid.any():
                lost = lost | unpaid
                marks = infos.get("lost", False) | unpaid
                infos = {**infos, "lost": marks, "_lost": marks.copy()}
            terminated = (self._row("ends of episodes", over, "b") & ~began) | lost
        except BaseException:
            # Under SAME_STEP a failed task must not delay the reset.
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
                if "parameters" in infos:
                    infos = {**infos, **self.inner._parameter_infos(ended)}
                infos = {
                    "final_obs": final,
                    "_final_obs": ended,
                    "final_info": infos,
                    "_final_info": ended.copy(),
                }
                observations = self.inner.reset(options={"reset_mask": ended})[0]
                if "parameters" in infos["final_info"]:
                    infos |= self.inner._parameter_infos()
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
        # Locks cannot be pickled.
        return {name: value for name, value in self.__dict__.items() if name != "_turn"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _turn=threading.RLock())

    def __copy__(self) -> CustomTaskVectorEnv:
        return self.__deepcopy__({})

    def __deepcopy__(self, memo: dict[int, Any]) -> CustomTaskVectorEnv:
        twin: CustomTaskVectorEnv = object.__new__(type(self))
        twin.__dict__.update(self.__dict__, inner=copy.deepcopy(self.inner, memo), _np_random=copy.deepcopy(self._np_random, memo))
        twin._ended, twin._turn = self._ended.copy(), threading.RLock()
        return twin

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """As :meth:`libration.VectorEnv.call`."""
        return self.inner.call(name, *args, **kwargs)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """As :meth:`libration.VectorEnv.get_attr`."""
        return self.inner.get_attr(name)

    def set_attr(self, name: str, values: Any) -> None:
        """As :meth:`libration.VectorEnv.set_attr`."""
        self.inner.set_attr(name, values)
        self.render_mode = self.inner.render_mode

    def render(self) -> Any:
        return self.inner.render()

    def close_extras(self, **kwargs: Any) -> None:
        # Gymnasium also closes environments whose constructor failed.
        if "inner" in self.__dict__:
            self.inner.close()
