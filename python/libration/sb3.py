"""Vector environments of Stable-Baselines3: ``libration.sb3.VecEnv``."""

from __future__ import annotations

import time
import warnings
from typing import Any, NoReturn, Sequence

try:
    from stable_baselines3.common.monitor import Monitor
    from stable_baselines3.common.vec_env import VecEnv as _BaseVecEnv
except ImportError as error:
    raise ImportError(f"libration.sb3 requires Stable-Baselines3 ({error}); help: pip install 'libration[sb3]'") from error

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from .custom import CustomTaskVectorEnv
from ._presets import PRESETS
from .envs import NAMESPACE, VectorEnv
from .equations import EquationSystem

__all__ = ["VecEnv"]


class _RunningInfo(dict[str, Any]):
    """Info of all environments whose episode goes on: one object, which therefore cannot change.

    A dictionary per environment would take longer than the step of the engine.
    """

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("infos of environments whose episode goes on are one dictionary, which cannot change; help: info.copy()")

    __setitem__ = __delitem__ = __ior__ = _refuse  # type: ignore[assignment]
    clear = pop = popitem = setdefault = update = _refuse  # type: ignore[assignment]

    def __reduce__(self) -> Any:
        # Copies, also by pickle, are dictionaries that can change.
        return dict, (dict(self),)


_RUNNING = _RunningInfo({"TimeLimit.truncated": False})


class VecEnv(_BaseVecEnv):
    """Vector environment of the engine as a ``VecEnv`` of Stable-Baselines3.

    Episodes reset in the same step (``autoreset_mode="SameStep"``): an observation after ``done`` is the first of the next episode.
    ``infos[n]`` of an ended episode has ``terminal_observation``, the last observation of the old episode; ``TimeLimit.truncated``;
    ``lost``, if the environment was lost; and ``episode``, as ``Monitor`` and ``VecMonitor`` write it. Rewards are ``float32``, as those of
    ``DummyVecEnv``. ``DummyVecEnv`` over single environments returns the same bits.

    Infos of environments whose episode goes on are one dictionary for all, which cannot change.

    Parameters
    ----------
    env:
        An id (``"libration/PendulumSwingUp-v0"``, or ``"Pendulum"``), a class such as :class:`libration.envs.PendulumVectorEnv`, a system by
        equations (:class:`libration.EquationSystem`), or a vector environment of the package with ``autoreset_mode="SameStep"``.
    num_envs:
        Number of environments (default: 1); of a vector environment its own.
    monitor:
        Whether infos of ended episodes have ``episode``: ``r``, the return; ``l``, the number of steps; ``t``, the time since the
        construction in s. ``VecMonitor`` is then superfluous.
    **given:
        Keywords of the environments, as those of :class:`libration.VectorEnv`.

    Raises
    ------
    TypeError
        For keywords beside a vector environment, or another type of ``env``.
    ValueError
        For another ``autoreset_mode``, or ``copy=False``: Stable-Baselines3 keeps observations of earlier steps.

    Examples
    --------
    >>> PPO("MlpPolicy", VecEnv("libration/PendulumSwingUp-v0", 64, action_delay=0.05)).learn(300_000)
    """

    def __init__(self, env: Any, num_envs: int | None = None, *, monitor: bool = True, **given: Any) -> None:
        self.envs = _made(env, num_envs, given)
        self._monitor = bool(monitor)
        self._actions: Any = None
        self._begin = time.time()
        self._returns = np.zeros(self.envs.num_envs)
        self._lengths = np.zeros(self.envs.num_envs, dtype=np.int64)
        super().__init__(self.envs.num_envs, self.envs.single_observation_space, self.envs.single_action_space)

    @property
    def spec(self) -> Any:
        """Specification of the environments, if ``gymnasium.make_vec`` made them."""
        return self.envs.spec

    def reset(self) -> NDArray[Any]:
        """Begin an episode in all environments, under the seeds of :meth:`seed` once."""
        if any(self._options):
            raise ValueError(f"options are {self._options!r}; expected no options")
        seeds = None if all(seed is None for seed in self._seeds) else self._seeds
        observations, _ = self.envs.reset(seed=seeds)
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        # Seeds and options belong to one reset.
        self._reset_seeds()
        self._reset_options()
        self._returns[:] = 0.0
        self._lengths[:] = 0
        return observations

    def step_async(self, actions: Any) -> None:
        self._actions = actions

    def step_wait(self) -> tuple[NDArray[Any], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        observations, rewards, terminated, truncated, told = self.envs.step(self._actions)
        dones = terminated | truncated
        self._returns += rewards
        self._lengths += 1
        infos: list[dict[str, Any]] = [_RUNNING] * self.num_envs
        ended = np.flatnonzero(dones)
        if len(ended):
            # An episode that terminates in the step of its time limit is over: nothing may be bootstrapped.
            late = truncated & ~terminated
            final = told["final_info"]
            keys = [key for key in final if not key.startswith("_")]
            now = round(time.time() - self._begin, 6)
            rows = zip(ended.tolist(), late[ended].tolist(), self._returns[ended].tolist(), self._lengths[ended].tolist())
            for n, cut, total, length in rows:
                infos[n] = info = {"TimeLimit.truncated": cut, "terminal_observation": told["final_obs"][n]}
                for key in keys:
                    # The mask tells for which environments there is a value.
                    if final[f"_{key}"][n]:
                        info[key] = final[key][n].item()
                if self._monitor:
                    info["episode"] = {"r": round(total, 6), "l": length, "t": now}
            self._returns[ended] = 0.0
            self._lengths[ended] = 0
        return observations, rewards.astype(np.float32, copy=False), dones, infos

    def close(self) -> None:
        self.envs.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """Return a picture of each environment, or None for each without ``render_mode="rgb_array"``."""
        if self.envs.render_mode is None:
            warnings.warn("render_mode is None; expected 'rgb_array' for pictures", stacklevel=2)
            return [None] * self.num_envs
        return list(self.envs.render())

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of single environments, as :meth:`libration.VectorEnv.get_attr`."""
        return self._chosen(self.envs.get_attr(attr_name), indices)

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of single environments to one value, as :meth:`libration.VectorEnv.set_attr`."""
        chosen = list(self._get_indices(indices))
        if len(set(chosen)) < self.num_envs:
            values = list(self.envs.get_attr(attr_name))
            for n in chosen:
                values[n] = value
        else:
            values = [value] * self.num_envs
        self.envs.set_attr(attr_name, values)
        if attr_name == "render_mode":
            self.render_mode = self.envs.render_mode
            self.metadata = {"render_modes": [] if self.render_mode is None else ["human", "rgb_array"]}

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Return the results of a method of single environments, as :meth:`libration.VectorEnv.call`."""
        return self._chosen(self.envs.call(method_name, *method_args, **method_kwargs), indices)

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Return whether the environments do the work of a wrapper: that of ``Monitor``, with ``monitor``."""
        is_wrapped = self._monitor and isinstance(wrapper_class, type) and issubclass(wrapper_class, Monitor)
        return [is_wrapped] * len(list(self._get_indices(indices)))

    def _chosen(self, values: Sequence[Any], indices: Any) -> list[Any]:
        return [values[n] for n in self._get_indices(indices)]

    def __repr__(self) -> str:
        return f"VecEnv({self.envs!r})"


def _made(env: Any, num_envs: int | None, given: dict[str, Any]) -> Any:
    """Return a vector environment that resets in the same step."""
    if isinstance(env, (str, type, EquationSystem)):
        options = {"num_envs": 1 if num_envs is None else num_envs, "autoreset_mode": "SameStep", **given}
        if isinstance(env, str):
            made = gymnasium.make_vec(env if "/" in env else f"{NAMESPACE}/{PRESETS[env].id if env in PRESETS else env}", **options)
        elif isinstance(env, type):
            made = env(**options)
        else:
            made = VectorEnv(env, **options)
    else:
        made = env
        if num_envs is not None or given:
            name = "num_envs" if num_envs is not None else next(iter(given))
            raise TypeError(f"{name} is given, but the environments exist already; help: give it to {type(env).__name__}")
    if not isinstance(made, (VectorEnv, CustomTaskVectorEnv)):
        raise TypeError(
            f"env is of type {type(made).__name__}; expected a vector environment of libration, its class, a System, or an id such as "
            "'libration/PendulumSwingUp-v0'"
        )
    mode = made.metadata["autoreset_mode"]
    if mode is not AutoresetMode.SAME_STEP:
        raise ValueError(f"autoreset_mode is {mode.value!r}; expected 'SameStep', the reset of Stable-Baselines3")
    if isinstance(made, VectorEnv) and not made._arguments[1]["copy"]:
        raise ValueError("copy is False; expected True, since Stable-Baselines3 keeps observations of earlier steps")
    return made
