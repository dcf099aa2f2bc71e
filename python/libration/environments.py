"""Vector environments that require NumPy only."""

from __future__ import annotations

import copy
from typing import Any, Mapping, Sequence

import numpy as np

from . import _native
from ._keywords import check_keywords
from ._presets import PRESETS, Preset
from ._settings import AUTORESET, count, native, nearest
from ._tasks import EquationPreset, native_equations
from .equations import EquationSystem
from .policies import Policy
from .rollout import Rollout

__all__ = ["Environments"]


class Environments(_native.Batch):
    """Environments that the engine steps together.

    ``reset`` and ``step`` follow Gymnasium's vector environments, without Gymnasium. :class:`libration.envs.VectorEnv` adds spaces,
    specs and rendering.

    Parameters
    ----------
    name:
        ``"Oscillator"``, ``"Pendulum"`` or ``"Duffing"``, or a system by equations (:class:`libration.EquationSystem`), whose inputs
        are the actions.
    num_envs:
        Number of environments.
    max_episode_steps:
        Number of actions after which an episode is truncated; ``math.inf`` or -1 for no limit (default: that of the
        environment).
    autoreset_mode:
        Reset after an episode: ``"NextStep"``, ``"SameStep"`` or ``"Disabled"``, as in Gymnasium.
    integrator:
        ``"explicit-euler"``, ``"symplectic-euler"``, ``"symplectic-euler-drift-first"``, ``"velocity-verlet"``, ``"textbook-verlet"``,
        ``"leapfrog"``, ``"rk4"``, ``"yoshida4"`` or ``"suzuki4"``.
    dt:
        Time between two actions in s.
    substeps:
        Steps of the integrator between two actions (default: the smallest number for which all latencies are whole steps).
    action_delay, observation_delay:
        Latencies of actions and observations in s: a number, or a pair ``(low, high)``, from which each episode draws one.
    jitter:
        Jitter ``ε`` of each step of the integrator, ``dt·(1 + ε)``: the standard deviation of a Gaussian, or ``("uniform", std)``,
        ``("gaussian", std)``. Negative steps become zero.
    skew:
        Skew of the clock of an episode; as ``jitter``.
    observation_noise:
        Noise of each observed number, in its unit; as ``jitter``.
    max_action:
        Largest absolute action: an acceleration in m/s² (pendulum: rad/s²), or a force in N for a system with ``m`` and ``k``. Larger
        actions are clipped, and their cost is that of the clipped action. Of a system by equations one number, or one for each input.
    start_position, start_velocity:
        Start of an episode in m and m/s (pendulum: rad and rad/s): a number, or a pair ``(low, high)``.
    observe, reward, terminated:
        The task on a system by equations: expressions of the observed numbers (default: all states), the reward, and comparisons that
        end an episode. They have the names of the system and ``t``, the time since the episode began. ``reward`` also has the inputs,
        and ``before(x)`` for a state before the step. Default: the task of the system.
    start:
        Start of an episode of a system by equations: a number or a pair ``(low, high)`` for each state by its name.
    dtype:
        Float type of all operations: ``"float32"`` or ``"float64"``.
    threads:
        Number of threads (0: one per core). The results are independent of it.
    copy:
        Whether each step returns arrays that later steps do not overwrite. Otherwise the steps fill ``buffers`` arrays in turn
        (default: 2).
    **parameters:
        Parameters of the system (``omega2``, or ``m`` and ``k``; ``alpha``, ``beta``) and of the task (``position_cost``, ``velocity_cost``,
        ``effort_cost``, ``bound``).

    Raises
    ------
    TypeError
        For an unknown keyword, or a value of the wrong type.
    ValueError
        For an invalid value; the message has the name of the parameter and the allowed values.
    """

    preset: Preset | EquationPreset
    num_envs: int

    _reset_needed: type[Exception] = RuntimeError
    _closed_error: type[Exception] = RuntimeError

    def __init__(
        self,
        name: str | EquationSystem,
        num_envs: int = 1,
        *,
        max_episode_steps: float | None = None,
        autoreset_mode: Any = "NextStep",
        integrator: str = "velocity-verlet",
        dt: float | None = None,
        substeps: int | None = None,
        action_delay: Any = 0.0,
        observation_delay: Any = 0.0,
        jitter: Any = 0.0,
        skew: Any = 0.0,
        observation_noise: Any = 0.0,
        max_action: float | None = None,
        start_position: Any = None,
        start_velocity: Any = None,
        observe: Sequence[str] | None = None,
        reward: str | None = None,
        terminated: Sequence[str] | None = None,
        start: Mapping[str, Any] | None = None,
        dtype: Any = "float32",
        threads: int = 1,
        copy: bool = True,
        buffers: int | None = None,
        **parameters: Any,
    ) -> None:
        if not isinstance(name, EquationSystem) and name not in PRESETS:
            raise ValueError(f"unknown environment {name!r}: {nearest(str(name), PRESETS)}")
        mode = getattr(autoreset_mode, "value", autoreset_mode)
        if mode not in AUTORESET:
            raise ValueError(
                f"autoreset_mode is {autoreset_mode!r}: {nearest(str(mode), AUTORESET)}"
            )
        given = {
            "num_envs": num_envs,
            "max_episode_steps": max_episode_steps,
            "autoreset_mode": mode,
            "integrator": integrator,
            "dt": dt,
            "substeps": substeps,
            "action_delay": action_delay,
            "observation_delay": observation_delay,
            "jitter": jitter,
            "skew": skew,
            "observation_noise": observation_noise,
            "max_action": max_action,
            "start_position": start_position,
            "start_velocity": start_velocity,
            "observe": observe,
            "reward": reward,
            "terminated": terminated,
            "start": start,
            "dtype": _name_of(dtype),
            "threads": threads,
            "copy": copy,
            "buffers": buffers,
        }
        if not isinstance(copy, (bool, np.bool_)):
            raise TypeError(f"copy must be True or False, not {type(copy).__name__}")
        if copy and buffers is not None:
            raise TypeError("buffers is given, but it belongs to copy=False")
        self._arguments = (name, {**given, **parameters})
        self._settings: Mapping[str, Any]
        if isinstance(name, EquationSystem):
            found = native_equations(name, {**given, "parameters": parameters})
            self.preset, self._settings = found
        else:
            self.preset = PRESETS[name]
            self._settings = native(self.preset, {**given, "parameters": parameters})
        self._seeder: np.random.Generator | None = None
        self.num_envs = self._settings["num_envs"]
        kept = 0 if copy else count("buffers", 2 if buffers is None else buffers, 1, 1_000_000)
        self._set_up(self._settings, kept)

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin new episodes.

        Parameters
        ----------
        seed:
            An ``int`` for ``[seed, seed + 1, …]``, or a list with an ``int`` or ``None`` for each environment. An environment with a
            seed begins its first episode under that seed, independently of all others. Without a seed it begins its next
            episode, or its first one under a seed of the operating system.
        options:
            ``{"reset_mask": array}``: a ``bool`` array ``(num_envs,)`` that selects the environments to reset, at least one.

        Returns
        -------
        observations:
            Observations of all environments, ``(num_envs, n)``.
        infos:
            An empty dictionary.

        Raises
        ------
        TypeError
            For seeds that are not integers, or a mask that is not a ``bool`` array.
        ValueError
            For seeds or a mask with a wrong length, a negative seed, or a mask without ``True``.
        """
        return self._begin(self._seeds(seed), options)

    def _begin(
        self, seeds: list[int | None], options: dict[str, Any] | None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        mask = None
        if options is not None and "reset_mask" in options:
            mask = self._mask(options["reset_mask"])
        if self._seeder is None:
            self._seeder = np.random.default_rng()
            fresh = self._seeder.integers(2**63, size=self.num_envs, dtype=np.uint64).tolist()
            # Environments outside the mask have no episode yet, and begin one with the others.
            seeds = [
                new if old is None or (mask is not None and not mask[n]) else old
                for n, (old, new) in enumerate(zip(seeds, fresh))
            ]
            mask = None
        return self._reset(seeds, mask), {}

    def _seeds(self, seed: Any) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, (int, np.integer)) and not isinstance(seed, bool):
            seeds: list[int | None] = [int(seed) + n for n in range(self.num_envs)]
        else:
            try:
                if isinstance(seed, (str, bytes, bytearray)):
                    raise TypeError
                seeds = list(seed)
            except TypeError:
                raise TypeError(
                    f"seed must be an integer, a list or None, not {type(seed).__name__}"
                ) from None
        if len(seeds) != self.num_envs:
            raise ValueError(
                f"there are {len(seeds)} seeds, but there must be one for each of "
                f"{self.num_envs} environments"
            )
        for n, one in enumerate(seeds):
            if one is not None:
                seeds[n] = count(f"seed of environment {n}", one, 0, 2**64 - 1)
        return seeds

    def _mask(self, mask: Any) -> np.ndarray:
        if not isinstance(mask, np.ndarray):
            raise TypeError(f"options['reset_mask'] must be a NumPy array, not {type(mask).__name__}")
        if mask.shape != (self.num_envs,):
            raise ValueError(
                f"options['reset_mask'] has shape {mask.shape}, but it must be ({self.num_envs},)"
            )
        if mask.dtype != np.bool_:
            raise TypeError(f"options['reset_mask'] has dtype {mask.dtype}, but it must be bool")
        if not mask.any():
            raise ValueError("options['reset_mask'] has no True, but it must have at least one")
        # A byte of an array of ``bool`` need not be 0 or 1.
        return np.ascontiguousarray(mask).view(np.uint8) != 0

    @check_keywords
    def rollout(
        self,
        policy: Policy,
        horizon: int,
        *,
        log_probabilities: bool = False,
        values: bool = False,
        out: Rollout | None = None,
    ) -> Rollout:
        """Return a rollout of ``horizon`` steps of every environment under a policy of :mod:`libration.policies`.

        Parameters
        ----------
        log_probabilities, values:
            Whether the rollout has arrays of log-probabilities of actions and of values, ``(horizon, num_envs)`` each.
        out:
            A rollout to overwrite; it also determines which arrays there are.

        Raises
        ------
        TypeError
            For a policy that is not one of the engine; a Python function can act through ``step``.
        ValueError
            For a policy or an ``out`` with a wrong shape or dtype. Without a ``reset``, Gymnasium's ``ResetNeeded``.
        MemoryError
            If there is not enough memory.
        KeyboardInterrupt
            Between two steps, after Ctrl-C; ``out`` then has part of the rollout.
        """
        observations = len(self.preset.seen)
        if not isinstance(policy, Policy):
            raise TypeError(
                f"policy must be one of libration.policies, not {type(policy).__name__}; help: a Python function can act through step"
            )
        request = policy._request(observations, len(self.preset.actions))
        if out is None:
            horizon = count("horizon", horizon, 1, 2**40)
            out = Rollout(self._memory(horizon, bool(log_probabilities), bool(values)))
        elif not isinstance(out, Rollout):
            raise TypeError(f"out must be a Rollout, not {type(out).__name__}")
        elif out.rewards.shape != (horizon, self.num_envs):
            raise ValueError(
                f"out has shape {out.rewards.shape}, but it must be ({horizon}, {self.num_envs})"
            )
        # An interrupted rollout has no last observations.
        out.last_observations = np.empty(0)
        out.last_observations = self._rollout(request, out._memory)
        return out

    @property
    def states(self) -> np.ndarray:
        """True positions and velocities, ``(num_envs, 2)``, without noise and latency; of a system by equations its states."""
        return self._states()

    @property
    def substeps(self) -> int:
        """Steps of the integrator between two actions."""
        return self._settings["substeps"]

    def close(self) -> None:
        """Release memory and threads; ``reset`` and ``step`` then fail."""
        self._close()

    def __repr__(self) -> str:
        settings = self._settings
        return (
            f"{type(self).__name__}({self.preset.name!r}, num_envs={self.num_envs}, dt={settings['dt'] * self.substeps:g}, "
            f"substeps={self.substeps}, integrator={settings['integrator']!r}, dtype={settings['dtype']!r})"
        )

    def __reduce__(self) -> Any:
        return _again, (type(self), self._arguments, self._state(), self._seeder, self._extras())

    def _extras(self) -> dict[str, Any]:
        """Return the attributes of a subclass that copies need."""
        return {}

    @classmethod
    def _construct(cls, name: str | EquationSystem, given: dict[str, Any]) -> Environments:
        return cls(name, **given)

    def __copy__(self) -> Environments:
        return self.__deepcopy__({})

    def __deepcopy__(self, memo: dict[int, Any]) -> Environments:
        function, arguments = self.__reduce__()
        # The arguments contain random number generators.
        return function(*copy.deepcopy(arguments, memo))


def _name_of(dtype: Any) -> str:
    # NumPy takes None for float64.
    if dtype is None:
        raise TypeError("dtype must be float32 or float64, not None")
    return np.dtype(dtype).name


def _again(cls: Any, made_of: Any, state: Any, seeder: Any, extras: dict[str, Any]) -> Any:
    """Restore pickled environments."""
    copy = cls._construct(*made_of)
    copy._restore(state)
    copy._seeder = seeder
    copy.__dict__.update(extras)
    return copy
