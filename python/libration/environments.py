"""Many environments at once, with NumPy and nothing else."""

from __future__ import annotations

import copy
from typing import Any, Mapping

import numpy as np

from . import _native
from ._named import named
from ._presets import PRESETS, Preset
from ._settings import AUTORESET, count, native, nearest
from .policies import Policy
from .rollout import Rollout

__all__ = ["Environments"]


class Environments(_native.Batch):
    """Environments that are stepped together by the engine.

    ``reset`` and ``step`` are those of Gymnasium's vector environments, but nothing of Gymnasium is needed:
    :class:`libration.envs.VectorEnv` adds spaces, specs and rendering.

    Parameters
    ----------
    name:
        ``"Oscillator"``, ``"Pendulum"`` or ``"Duffing"``.
    num_envs:
        How many.
    max_episode_steps:
        Actions after which an episode is truncated; ``math.inf`` for never. By default that of the environment.
    autoreset_mode:
        What follows an episode: ``"NextStep"``, ``"SameStep"`` or ``"Disabled"``, as Gymnasium defines them.
    integrator:
        ``"explicit-euler"``, ``"symplectic-euler"``, ``"symplectic-euler-drift-first"``, ``"velocity-verlet"``, ``"textbook-verlet"``,
        ``"leapfrog"``, ``"rk4"``, ``"yoshida4"`` or ``"suzuki4"``.
    dt:
        Seconds from action to action.
    substeps:
        Steps of the integrator from action to action. By default 1, or as few as make all latencies whole numbers of them.
    action_delay, observation_delay:
        Seconds by which actions take effect late and observations are old; a number, or two ends between which it is drawn for every
        episode.
    jitter:
        Noise of the length of every step of the integrator, ``dt·(1 + ε)``: the standard deviation of a Gaussian ``ε``, or
        ``("uniform", std)``, ``("gaussian", std)``. No step is negative.
    skew:
        The same for the rate of the clock of a whole episode.
    observation_noise:
        The same for every number that is observed, in its unit.
    max_action:
        The largest action of either sign: an acceleration in m/s² (rad/s² of a pendulum), or a force in N where the system is given
        by ``m`` and ``k``. Larger actions are cut off at it, and are paid for as such.
    start_position, start_velocity:
        Where an episode begins, in m and m/s (rad and rad/s of a pendulum): a number, or two ends.
    dtype:
        ``"float32"`` or ``"float64"``: of all that is computed.
    threads:
        How many; 0 for as many as there are cores. What comes out does not depend on it.
    copy:
        Whether the arrays of a step stay as they are for as long as somebody has them. Otherwise every step fills the same ``buffers``
        again and again, one after the other.
    **parameters:
        Of the system (``omega2``, or ``m`` and ``k``; ``alpha``, ``beta``) and of the task (``position_cost``, ``velocity_cost``,
        ``effort_cost``, ``bound``).

    Raises
    ------
    TypeError
        For an unknown keyword, or a value of the wrong type.
    ValueError
        For a value that cannot be, with its name and what is allowed.
    """

    preset: Preset
    num_envs: int

    _reset_needed: type[Exception] = RuntimeError
    _closed_error: type[Exception] = RuntimeError

    def __init__(
        self,
        name: str,
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
        dtype: Any = "float32",
        threads: int = 1,
        copy: bool = True,
        buffers: int = 2,
        **parameters: Any,
    ) -> None:
        if name not in PRESETS:
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
            "dtype": _name_of(dtype),
            "threads": threads,
            "copy": copy,
            "buffers": buffers,
        }
        self.preset = PRESETS[name]
        self._made_of = (name, {**given, **parameters})
        self._settings: Mapping[str, Any] = native(self.preset, {**given, "parameters": parameters})
        self._seeder: np.random.Generator | None = None
        self.num_envs = self._settings["num_envs"]
        kept = 0 if copy else count("buffers", buffers, 1, 1_000_000)
        self._set_up(self._settings, kept)

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin episodes.

        Parameters
        ----------
        seed:
            An ``int`` for ``[seed, seed + 1, …]``, or one or ``None`` for each environment. An environment with a seed begins its first
            episode under it, which is the same whatever surrounds it; without, its next one, or a first one under a seed from the
            system.
        options:
            ``{"reset_mask": array}``, of ``bool`` and shape ``(num_envs,)``: which are reset, at least one.

        Returns
        -------
        observations:
            Of all environments, ``(num_envs, n)``.
        infos:
            Empty.

        Raises
        ------
        TypeError
            For seeds that are no integers, or a mask that is no array of ``bool``.
        ValueError
            For seeds or a mask of another length, a negative seed, or a mask without a ``True``.
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
            # Who is not reset has not begun either, and begins with the others.
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
            raise ValueError("options['reset_mask'] has no True, but it must have one at least")
        # A byte of an array of ``bool`` need not be 0 or 1.
        return np.ascontiguousarray(mask).view(np.uint8) != 0

    @named
    def rollout(
        self,
        policy: Policy,
        horizon: int,
        *,
        log_probabilities: bool = False,
        values: bool = False,
        out: Rollout | None = None,
    ) -> Rollout:
        """Act ``horizon`` times in every environment, under a policy of :mod:`libration.policies`.

        Parameters
        ----------
        log_probabilities, values:
            Whether there is to be room for the logarithms of the densities of actions, and for values, ``(horizon, num_envs)`` each.
        out:
            A rollout that is filled again, and then says what is asked for.

        Raises
        ------
        TypeError
            For a policy that is none of the engine's: to act from Python, use ``step``.
        ValueError
            For a policy or an ``out`` of another shape or dtype; in Gymnasium's words where there was no ``reset``.
        MemoryError
            If there is no room.
        KeyboardInterrupt
            Between two steps, after Ctrl-C: ``out`` holds a part of it then.
        """
        observations = len(self.preset.seen)
        if not isinstance(policy, Policy):
            raise TypeError(
                f"policy must be one of libration.policies, not {type(policy).__name__}: to act from Python, use step"
            )
        told = policy._told(observations)
        if out is None:
            horizon = count("horizon", horizon, 1, 2**40)
            out = Rollout(self._memory(horizon, bool(log_probabilities), bool(values)))
        elif not isinstance(out, Rollout):
            raise TypeError(f"out must be a Rollout, not {type(out).__name__}")
        elif out.rewards.shape != (horizon, self.num_envs):
            raise ValueError(
                f"out has shape {out.rewards.shape}, but it must be ({horizon}, {self.num_envs})"
            )
        # Of a rollout that is interrupted they are not those that follow.
        out.last_observations = np.empty(0)
        out.last_observations = self._rollout(told, out._memory)
        return out

    @property
    def states(self) -> np.ndarray:
        """Positions and velocities, ``(num_envs, 2)``, as they are and not as they are observed."""
        return self._states()

    def __reduce__(self) -> Any:
        return _again, (type(self), self._made_of, self._state(), self._seeder, self._extras())

    def _extras(self) -> dict[str, Any]:
        """What a class adds that a copy is to have."""
        return {}

    @classmethod
    def _made(cls, name: str, given: dict[str, Any]) -> Environments:
        return cls(name, **given)

    def __copy__(self) -> Environments:
        return self.__deepcopy__({})

    def __deepcopy__(self, memo: dict[int, Any]) -> Environments:
        function, arguments = self.__reduce__()
        # Generators of random numbers are among them.
        return function(*copy.deepcopy(arguments, memo))


def _name_of(dtype: Any) -> str:
    # NumPy takes None for float64.
    if dtype is None:
        raise TypeError("dtype must be float32 or float64, not None")
    return np.dtype(dtype).name


def _again(cls: Any, made_of: Any, state: Any, seeder: Any, extras: dict[str, Any]) -> Any:
    """Environments as they were when they were pickled."""
    copy = cls._made(*made_of)
    copy._restore(state)
    copy._seeder = seeder
    copy.__dict__.update(extras)
    return copy
