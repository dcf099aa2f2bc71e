"""Vector environments that require NumPy only."""

from __future__ import annotations

import copy
from functools import cached_property
from typing import TYPE_CHECKING, Any, Mapping, Sequence, overload

import numpy as np

from . import _native
from ._environment_keywords import Unpack, VectorKeywords
from ._episode_states import episode_numbers, options_of, refuse_options, rows_of, start_of
from ._keywords import check_keywords
from ._preset_equations import has_varied, native_varied
from ._presets import PRESETS, Preset
from ._settings import AUTORESET, count, native, nearest, shown
from ._spec_keywords import named_keyword_value
from ._tasks import EquationPreset, native_equations
from .equations import EquationSystem
from .linear import LinearPlant
from .systems import SYSTEMS, System, with_commands
from .perturbations import PD
from .policies import Policy
from .rollout import Rollout

if TYPE_CHECKING:
    from gymnasium.spaces import Box, Discrete, Space
    from numpy.typing import DTypeLike

    from ._environment_keywords import Autoreset, Delay, Inference, Law, LawOfEach, Range, Varied

__all__ = ["Environments"]


class Environments(_native.Batch):
    """Environments that the engine steps together.

    ``reset`` and ``step`` follow Gymnasium's vector environments, without Gymnasium. :class:`libration.envs.VectorEnv` adds specs and
    rendering. ``single_observation_space``, ``single_action_space``, ``observation_space`` and ``action_space`` are those of ``VectorEnv``; they
    require Gymnasium.

    Parameters
    ----------
    name:
        ``"Oscillator"``, ``"Pendulum"`` or ``"Duffing"``, or a system by equations (:class:`libration.EquationSystem`), whose inputs are the
        actions. One of the catalogue (:class:`libration.System`) is its :meth:`~libration.System.equations`.
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
        Steps of the integrator between two actions, of equal length. Default: the smallest number up to 20 for which all latencies are whole
        steps; else a step begins where each latency ends, and their lengths differ. With an inner controller or a chunk, and with latencies that
        episodes draw, the smallest number up to 1000.
    action_delay, observation_delay:
        Latencies of actions and observations in s: a number, or a pair ``(low, high)``, from which each episode draws one. The engine draws whole
        steps of the integrator, ``low``, ``low + dt/substeps``, … ``high``, each as likely; more ``substeps`` make the values finer. A latency
        within ``dt`` can raise the default of ``substeps``, which changes how the system is integrated: a comparison with and without latency
        requires the same ``substeps`` in both.
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
    project:
        States by name, and the expressions that replace them after each step of the integrator, such as hard stops: they have ``before(x)``
        and the length ``dt`` of the step.
    actions:
        Commands of discrete actions, in ascending order: the action ``i`` is the command ``actions[i]``. A policy of the engine gives a
        command, of which the nearest one is taken.
    inner, targets, inner_period:
        An inner controller between actions and inputs: ``PD(kp, kd)`` for a system with as many inputs as coordinates, whose actions are then
        targets of the coordinates, ``kp·(target - q) - kd·q'``; or an expression of the state and of ``targets``, names of actions, for each
        input. It samples every ``inner_period`` seconds, of which ``dt`` is a whole multiple.
        Latencies and ``max_action`` are those of the targets.
    chunk:
        ``(H, s)`` for a policy that answers with a chunk of ``H`` actions, one for each ``dt``, of which ``s`` are used: a step of the
        environment takes ``s·dt``, and an action has ``H`` numbers for each input or target, time by time. ``action_delay`` or ``inference`` is
        the time that the policy needs to answer. The chunk before is in effect until then; of a chunk that arrives late, the actions whose time has passed are
        left out.
    inference:
        The time in s that a policy takes to answer an observation: a number, or a distribution from which every action draws its own:
        ``LogNormal(mean, std)`` or ``("lognormal", mean, std)``, ``Uniform(low, high)``, ``LogUniform(low, high)``. What is
        drawn above ``mean + 8·std`` counts as that. ``action_delay`` comes on top. :attr:`parameters` has the time of the next answer.
    inference_mode:
        ``"asynchronous"``: the system goes on under the newest action that has arrived. Times are rounded to steps of the integrator, of which
        the mean has at least eight where ``substeps`` is not given, with at most 20 of them in ``dt`` unless latencies need more.
        ``"synchronous"``: the system waits for each answer under its last command, and a step takes ``dt`` and the time of the answer, which
        errors of the clock do not change. Reward and termination are those of the whole step.
    threads:
        Number of threads (0: one per core). The results are independent of it.
    copy:
        Whether each step returns arrays that nothing overwrites.
    buffers:
        With ``copy=False``: the number of arrays that steps fill in turn (default: 2). :meth:`reset` and :meth:`set_state` return new arrays.
    parameter_infos:
        Whether ``infos`` of ``reset`` and ``step`` have :attr:`parameters`.
    **parameters:
        Parameters of the system (``omega2``, or ``m`` and ``k``; ``alpha``, ``beta``) and of the task (``position_cost``, ``velocity_cost``,
        ``effort_cost``, ``bound``); of a system by equations all of its parameters. A number; ``Uniform(low, high)``, ``LogUniform(low,
        high)``, ``LogNormal(mean, std)`` or ``Gaussian(std, mean)``, from which each episode draws; or an array ``(num_envs,)``. ``max_action`` takes the same, and
        ``jitter`` and ``observation_noise`` take ``Uniform(low, high)`` for the standard deviation of an episode.

    Raises
    ------
    TypeError
        For an unknown keyword, or a value of the wrong type.
    ValueError
        For an invalid value; the message has the name of the parameter and the allowed values.
    """

    preset: Preset | EquationPreset
    num_envs: int
    if TYPE_CHECKING:
        single_observation_space: Space[Any]
        single_action_space: Space[Any]
        observation_space: Space[Any]
        action_space: Space[Any]
    else:
        # Only these four import Gymnasium.
        single_observation_space = cached_property(lambda self: self._single_spaces()[0])
        single_action_space = cached_property(lambda self: self._single_spaces()[1])
        observation_space = cached_property(lambda self: self._batched(self.single_observation_space))
        action_space = cached_property(lambda self: self._batched(self.single_action_space))

    _rounds = False
    """Whether observations of resets and steps are ``float32`` whatever the float type of the engine."""
    _reset_needed: type[Exception] = RuntimeError
    _closed_error: type[Exception] = RuntimeError

    @overload
    def __init__(self, name: str, num_envs: int = 1, **given: Unpack[VectorKeywords]) -> None: ...

    # A system by equations has parameters of any name.
    @overload
    def __init__(self, name: EquationSystem | System | LinearPlant, num_envs: int = 1, **given: Any) -> None: ...

    def __init__(
        self,
        name: str | EquationSystem | System | LinearPlant,
        num_envs: int = 1,
        *,
        max_episode_steps: float | None = None,
        autoreset_mode: Autoreset = "NextStep",
        integrator: str = "velocity-verlet",
        dt: float | None = None,
        substeps: int | None = None,
        action_delay: Delay = 0.0,
        observation_delay: Delay = 0.0,
        jitter: Law = 0.0,
        skew: Law = 0.0,
        observation_noise: LawOfEach = 0.0,
        max_action: Varied | Sequence[Varied] | None = None,
        start_position: Range | None = None,
        start_velocity: Range | None = None,
        observe: Sequence[str] | None = None,
        reward: str | None = None,
        terminated: Sequence[str] | None = None,
        start: Mapping[str, Any] | None = None,
        project: Mapping[str, str] | None = None,
        actions: Sequence[float] | None = None,
        targets: Sequence[str] | None = None,
        inner: PD | Mapping[str, str] | None = None,
        inner_period: float | None = None,
        chunk: tuple[int, int] | None = None,
        inference: Inference = None,
        inference_mode: str = "asynchronous",
        dtype: DTypeLike = "float32",
        threads: int = 1,
        copy: bool = True,
        buffers: int | None = None,
        parameter_infos: bool = False,
        **parameters: Any,
    ) -> None:
        if not isinstance(name, (str, System, EquationSystem, LinearPlant)):
            raise TypeError(
                f"an environment is {shown(name)}, but it must be the name of a preset, a System, an EquationSystem or a LinearPlant"
            )
        subject: str | EquationSystem = with_commands(name)
        if not isinstance(subject, EquationSystem) and subject not in PRESETS:
            help = f"; help: System({subject!r}) and a task" if subject in SYSTEMS else ""
            raise ValueError(f"unknown environment {subject!r}: {nearest(str(subject), PRESETS)}{help}")
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
            "project": project,
            "actions": actions,
            "targets": targets,
            "inner": inner,
            "inner_period": inner_period,
            "chunk": chunk,
            "inference": inference,
            "inference_mode": inference_mode,
            "dtype": _name_of(dtype),
            "threads": threads,
            "copy": copy,
            "buffers": buffers,
            "parameter_infos": parameter_infos,
        }
        if not isinstance(copy, (bool, np.bool_)):
            raise TypeError(f"copy must be True or False, not {type(copy).__name__}")
        if not isinstance(parameter_infos, (bool, np.bool_)):
            raise TypeError(f"parameter_infos must be True or False, not {type(parameter_infos).__name__}")
        if copy and buffers is not None:
            raise TypeError("buffers is given, but it belongs to copy=False")
        given = {key: named_keyword_value(key, value) for key, value in given.items()}
        parameters = {key: named_keyword_value(key, value) for key, value in parameters.items()}
        self._arguments = (subject, {**given, **parameters})
        self._settings: Mapping[str, Any]
        if isinstance(subject, EquationSystem):
            found = native_equations(subject, {**given, "parameters": parameters})
            self.preset, self._settings = found
        else:
            self.preset, stated = PRESETS[subject], {**given, "parameters": parameters}
            self._settings = (native_varied if has_varied(stated) else native)(self.preset, stated)
            if self._settings["lengths"] and "catalogued" in self._settings["subject"]:
                # Steps of different lengths are those of programs.
                self._settings = native_varied(self.preset, stated)
        self._seeder: np.random.Generator | None = None
        self.num_envs = self._settings["num_envs"]
        self._buffers = 0 if copy else count("buffers", 2 if buffers is None else buffers, 1, 1_000_000)
        self._set_up(self._settings, self._buffers, self._rounds)

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
            ``reset_mask``: a ``bool`` array ``(num_envs,)`` that selects the environments to reset, at least one.
            ``state``: the states to start from, as for :meth:`set_state`. ``low`` and ``high``: ends of the ranges from which starts are
            drawn in place of the usual ones, numbers for all states, ``(n,)``, or dictionaries by name.

        Returns
        -------
        observations:
            Observations of all environments, ``(num_envs, n)``.
        infos:
            ``parameters`` under ``parameter_infos``, else an empty dictionary.

        Raises
        ------
        TypeError
            For seeds that are not integers, or a mask that is not a ``bool`` array.
        ValueError
            For seeds or a mask with a wrong length, a negative seed, a mask without ``True``, or other options.
        """
        return self._begin(self._seeds(seed), options)

    def _begin(
        self, seeds: list[int | None], options: dict[str, Any] | None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        options = options_of(options)
        mask = which = given = None
        if options:
            refuse_options(options)
            mask = self._mask(options["reset_mask"]) if "reset_mask" in options else None
            which = np.arange(self.num_envs) if mask is None else np.flatnonzero(mask)
            given = start_of(options, self._state_names(), self.num_envs, which, self._settings["dtype"])
        if self._seeder is None:
            self._seeder = np.random.default_rng()
            fresh = self._seeder.integers(2**63, size=self.num_envs, dtype=np.uint64).tolist()
            # Environments outside the mask have no episode yet, and begin one with the others.
            seeds = [
                new if old is None or (mask is not None and not mask[n]) else old
                for n, (old, new) in enumerate(zip(seeds, fresh))
            ]
            mask = None
        observations = self._reset(seeds, mask)
        if given is not None and which is not None:
            ours, rows = (self._set_states, given) if "state" in options else (self._start_within, given.T)
            observations = ours(rows.tolist(), which.tolist())
        infos = self._parameter_infos(mask) if self._settings["parameter_infos"] else {}
        return observations, infos

    def set_state(self, states: Any, mask: np.ndarray | None = None) -> np.ndarray:
        """Put environments at states, from which their episodes go on, and return the observations.

        What an environment observes, and what acts on it, before its latencies are over is that of a beginning. An environment whose episode
        is over keeps waiting for its reset.

        Parameters
        ----------
        states:
            Numbers of the states, ``(num_envs, n)`` or ``(n,)`` for all, in the order of :attr:`states`; or a dictionary with all states by
            name.
        mask:
            A ``bool`` array ``(num_envs,)`` that selects the environments to change (default: all).

        Raises
        ------
        TypeError, ValueError
            For states or a mask with a wrong shape or type, or numbers that are not finite. Without a ``reset``, Gymnasium's
            ``ResetNeeded``.
        """
        which = np.arange(self.num_envs) if mask is None else np.flatnonzero(self._mask(mask, "mask"))
        if self._seeder is None:
            raise self._reset_needed("set_state was called before reset; expected reset first")
        given = rows_of("states", states, self._state_names(), self.num_envs, which, self._settings["dtype"])
        return self._set_states(given.tolist(), which.tolist())

    def _state_names(self) -> tuple[str, ...]:
        name = self._arguments[0]
        return name.states if isinstance(name, EquationSystem) else ("position", "velocity")

    @property
    def parameters(self) -> dict[str, np.ndarray]:
        """Numbers of the current episodes that differ between episodes or environments, by name, ``(num_envs,)`` each.

        These are parameters, ``max_action`` (with several inputs ``max_action_u``), ``action_delay`` and ``observation_delay`` in s, the
        standard deviations ``jitter`` and ``observation_noise``, ``skew``, the relative error of the rate of the clock, and ``inference``, the
        time in s of the answer to the present observation.
        """
        return episode_numbers(self._settings, self.preset.actions, self._episode_numbers())

    def _parameter_infos(self, mask: np.ndarray | None = None) -> dict[str, Any]:
        """Return the numbers of the episodes, of all or in a mask, as Gymnasium's vector environments give dictionaries of single ones."""
        mask = np.ones(self.num_envs, dtype=np.bool_) if mask is None else mask
        return {"parameters": _spread(self.parameters, mask), "_parameters": mask.copy()}

    def _final_parameters(self) -> dict[str, np.ndarray]:
        """Return the numbers that the episodes will have after the next step, if they end with it."""
        return episode_numbers(self._settings, self.preset.actions, self._episode_numbers(1))

    def _told(self, results: Any, before: dict[str, np.ndarray]) -> tuple[Any, ...]:
        """Return the results of a step with the numbers of the episodes, and of those that ended.

        The engine calls it under ``parameter_infos``.
        """
        *others, infos = results
        if "final_info" in infos:
            ended = infos["_final_info"]
            final = {"parameters": _spread(before, ended), "_parameters": ended.copy()}
            infos = {**infos, "final_info": {**infos["final_info"], **final}}
        return (*others, {**infos, **self._parameter_infos()})

    def _seeds(self, seed: Any) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, (int, np.integer)) and not isinstance(seed, bool):
            seeds: list[int | None] = [int(seed) + n for n in range(self.num_envs)]
        else:
            # Sets have no order, and dictionaries and strings are no seeds.
            if not isinstance(seed, (list, tuple, range, np.ndarray)) or isinstance(seed, np.ma.MaskedArray) or np.ndim(seed) == 0:
                raise TypeError(f"seed must be an integer, a list or None, not {type(seed).__name__}")
            seeds = list(seed)
        if len(seeds) != self.num_envs:
            raise ValueError(
                f"there are {len(seeds)} seeds, but there must be one for each of "
                f"{self.num_envs} environments"
            )
        for n, one in enumerate(seeds):
            if one is not None:
                seeds[n] = count(f"seed of environment {n}", one, 0, 2**64 - 1)
        return seeds

    def _mask(self, mask: Any, name: str = "options['reset_mask']") -> np.ndarray:
        if not isinstance(mask, np.ndarray) or isinstance(mask, np.ma.MaskedArray):
            raise TypeError(f"{name} must be a NumPy array, not {type(mask).__name__}")
        if mask.shape != (self.num_envs,):
            raise ValueError(
                f"{name} has shape {mask.shape}, but it must be ({self.num_envs},)"
            )
        if mask.dtype != np.bool_:
            raise TypeError(f"{name} has dtype {mask.dtype}, but it must be bool")
        if not mask.any():
            raise ValueError(f"{name} has no True, but it must have at least one")
        # A byte of an array of ``bool`` need not be 0 or 1.
        return np.ascontiguousarray(mask).view(np.uint8) != 0

    @check_keywords
    def rollout(
        self,
        policy: Policy,
        horizon: int,
        *,
        log_probs: bool = False,
        values: bool = False,
        out: Rollout | None = None,
    ) -> Rollout:
        """Return a rollout of ``horizon`` steps of every environment under a policy of :mod:`libration.policies`.

        Parameters
        ----------
        log_probs, values:
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
            out = Rollout(self._memory(horizon, bool(log_probs), bool(values)))
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

    def _single_spaces(self) -> tuple[Box, Box | Discrete]:
        try:
            from ._spaces import single_spaces
        except ImportError as error:
            raise ImportError(f"spaces of environments require Gymnasium ({error}); help: pip install 'libration[gymnasium]'") from error
        return single_spaces(self.preset, self._settings)

    def _batched(self, space: Space[Any]) -> Space[Any]:
        from gymnasium.vector.utils import batch_space

        return batch_space(space, self.num_envs)

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
    try:
        return np.dtype(dtype).name
    except TypeError:
        raise TypeError(f"dtype must be float32 or float64, not {dtype!r}") from None


def _again(cls: Any, made_of: Any, state: Any, seeder: Any, extras: dict[str, Any]) -> Any:
    """Restore pickled environments."""
    copy = cls._construct(*made_of)
    copy._restore(state)
    copy._seeder = seeder
    copy.__dict__.update(extras)
    return copy


def _spread(values: Mapping[str, np.ndarray], mask: np.ndarray) -> dict[str, Any]:
    """Return arrays by name, each with the mask of the environments that have it."""
    table: dict[str, Any] = {}
    for name, array in values.items():
        table |= {name: np.where(mask, array, array.dtype.type(0)), f"_{name}": mask.copy()}
    return table
