"""Rollouts of environments on actors of Ray."""

from __future__ import annotations

import pickle
from typing import Any, Callable, Iterator, Mapping

import numpy as np
import ray
from numpy.typing import NDArray
from ray.exceptions import RayActorError, RaySystemError, RayTaskError, ObjectLostError, NodeDiedError, WorkerCrashedError

from ._keywords import check_keywords
from ._ray_tasks import attempts, cpus, start
from ._settings import OPTIONS, count
from .environments import Environments
from .policies import Policy

_DEATHS = (RayActorError, RaySystemError, ObjectLostError, NodeDiedError, WorkerCrashedError)

_SECONDS_TO_START = 20.0
"""Time after which an actor that waits for CPUs does without."""

Tensors = dict[str, Any]
"""Arrays of a rollout by name."""


class CollectedRollout:
    """Tensors of a rollout of ``T`` steps of all ``N`` environments, in their order, as :class:`libration.Rollout` has them."""

    def __init__(self, parts: list[Tensors]) -> None:
        def joined(name: str, axis: int = 1) -> NDArray[Any]:
            return np.concatenate([part[name] for part in parts], axis=axis)

        #: Observations before the actions, ``(T, N, n)``.
        self.observations = joined("observations")
        #: Actions of the policy, ``(T, N, actions)``.
        self.actions = joined("actions")
        #: Rewards, ``(T, N)``.
        self.rewards = joined("rewards")
        #: Whether the episode terminated, ``(T, N)``.
        self.terminated = joined("terminated")
        #: Whether the episode was truncated, ``(T, N)``.
        self.truncated = joined("truncated")
        #: Whether each step is a transition, ``(T, N)``; false for a reset.
        self.transitions = joined("transitions")
        #: Log-probabilities of the actions, ``(T, N)``, with ``log_probs=True``.
        self.log_probs: NDArray[Any] | None = joined("log_probs") if "log_probs" in parts[0] else None
        #: Observations after the last step, ``(N, n)``.
        self.last_observations = joined("last_observations", 0)
        first = np.cumsum([0] + [part["rewards"].shape[1] for part in parts])
        ends = {name: np.concatenate([part["episodes"][name] for part in parts]) for name in parts[0]["episodes"]}
        ends["environments"] += np.repeat(first[:-1], [len(part["episodes"]["steps"]) for part in parts]).astype(ends["environments"].dtype)
        order = np.lexsort((ends["environments"], ends["steps"]))
        #: Ended episodes, by step and environment: ``steps``, ``environments``, ``lengths``, ``returns``, ``lost`` and ``final_observations``.
        self.episodes = {name: values[order] for name, values in ends.items()}


class Collector:
    """Rollouts of environments that are divided among actors; made by :func:`collect`. A context manager."""

    def __init__(
        self,
        environments: Environments,
        policy: Policy | Callable[[Any], Policy],
        horizon: int,
        actors: int,
        seed: int,
        log_probs: bool,
        num_cpus: float,
        retries: int,
    ) -> None:
        self._policy, self._horizon, self._log_probs = policy, horizon, log_probs
        self._num_cpus, self._retries = num_cpus, retries
        total = environments.num_envs
        bounds = [total * i // actors for i in range(actors + 1)]
        self._ranges = [range(first, last) for first, last in zip(bounds, bounds[1:])]
        # A state is that after the last rollout which the collector returned.
        self._states: list[bytes] = [pickle.dumps(_slice(environments, part, seed)) for part in self._ranges]
        self._actors: list[Any] = [None] * actors
        self._is_closed = False

    def __enter__(self) -> Collector:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Collector of {self._ranges[-1].stop} environments on {len(self._actors)} actors>"

    def collect(self, weights: Any = None) -> CollectedRollout:
        """Return the next rollout of all environments.

        An actor that dies is made again and repeats its part, with the same bits.

        Parameters
        ----------
        weights:
            Argument of ``policy``, or a reference of it in the object store.

        Raises
        ------
        RuntimeError
            If the collector is closed.
        ray.exceptions.RayError
            If actors die more often than ``retries``.
        """
        return CollectedRollout(self._collected(weights, fetch=True))

    def collect_refs(self, weights: Any = None) -> list[Any]:
        """Return the next rollout as references of the object store: for each actor a dictionary of arrays, in the order of the environments.

        The arrays stay on their nodes. Those of a node that dies later are lost.
        """
        return self._collected(weights, fetch=False)

    def close(self) -> None:
        """End the actors."""
        self._is_closed = True
        self._end_actors()

    def _collected(self, weights: Any, fetch: bool) -> list[Any]:
        if self._is_closed:
            raise RuntimeError("the collector is closed; expected collect before close")
        shared = weights if isinstance(weights, ray.ObjectRef) else ray.put(weights)
        results: list[Any] = [None] * len(self._actors)
        states: list[bytes] = [b""] * len(self._actors)
        left, failures = set(range(len(self._actors))), 0
        try:
            while left:
                self._make_actors()
                running = {i: self._actors[i].rollout.remote(shared) for i in sorted(left)}
                for i, (tensors, state) in running.items():
                    try:
                        states[i] = ray.get(state)
                        results[i] = ray.get(tensors) if fetch else tensors
                        left.discard(i)
                    except _DEATHS:
                        self._end_actor(i)
                        failures += 1
                        if 0 <= self._retries < failures:
                            raise
        except BaseException as error:
            # Other actors may be ahead of the last rollout that was returned.
            self._end_actors()
            if isinstance(error, RayTaskError):
                raise error.cause from None
            raise
        self._states = states
        return results

    def _make_actors(self) -> None:
        """Make the actors that are missing."""
        missing = [i for i, actor in enumerate(self._actors) if actor is None]
        for i in missing:
            self._actors[i] = self._made(i, self._num_cpus)
        ready = {self._actors[i].__ray_ready__.remote(): i for i in missing}
        _, waiting = ray.wait(list(ready), num_returns=len(ready), timeout=_SECONDS_TO_START) if ready else ([], [])
        for reference in waiting:
            # A cluster that has lost a node may have no CPU left for the actor, which then shares one.
            self._end_actor(ready[reference])
            self._actors[ready[reference]] = self._made(ready[reference], 0)

    def _made(self, index: int, num_cpus: float) -> Any:
        made = ray.remote(_Actor).options(num_cpus=num_cpus, scheduling_strategy="SPREAD")
        return made.remote(self._states[index], self._policy, self._horizon, self._log_probs, int(self._num_cpus))

    def _end_actor(self, index: int) -> None:
        if self._actors[index] is not None:
            ray.kill(self._actors[index])
            self._actors[index] = None

    def _end_actors(self) -> None:
        for index in range(len(self._actors)):
            self._end_actor(index)


@check_keywords
def collect(
    environments: Environments,
    policy: Policy | Callable[[Any], Policy],
    *,
    horizon: int,
    actors: int,
    seed: int = 0,
    log_probs: bool = False,
    num_cpus: int = 1,
    retries: int = -1,
) -> Collector:
    """Return a collector of rollouts for a learner: weights in, tensors out.

    The rollouts have the bits of ``environments.reset(seed=seed)`` and of each ``environments.rollout(…)`` after it in one process, whatever
    the number of actors.

    Parameters
    ----------
    environments:
        Environments whose settings are used; they are not stepped.
    policy:
        A policy of :mod:`libration.policies`, or a function that returns one for the weights of each rollout, such as ``policies.MLP``.
    horizon:
        Number of steps of a rollout.
    actors:
        Number of actors, at most that of environments.
    seed:
        Seed of the environments.
    log_probs:
        Whether rollouts have log-probabilities of the actions.
    num_cpus:
        Number of CPUs of an actor. It has as many threads.
    retries:
        Largest number of times that actors are made again in a rollout (-1: any).

    Raises
    ------
    TypeError, ValueError
        For an invalid value, before any actor is made.
    """
    if not isinstance(environments, Environments):
        raise TypeError(f"environments must be libration.Environments, not {type(environments).__name__}")
    if isinstance(policy, Policy):
        policy._request(len(environments.preset.seen), len(environments.preset.actions))
    elif not callable(policy):
        raise TypeError(f"policy must be one of libration.policies or a function of weights, not {type(policy).__name__}")
    horizon = count("horizon", horizon, 1, 2**40)
    actors = count("actors", actors, 1, environments.num_envs)
    seed = count("seed", seed, 0, 2**64 - environments.num_envs)
    granted, repetitions = cpus(num_cpus), attempts(retries)
    start()
    available = ray.cluster_resources().get("CPU", 0)
    if actors * granted > available:
        most = f"expected at most {int(available / granted)}"
        raise ValueError(f"actors is {actors} with {granted:g} CPUs each, but the cluster has {available:g} CPUs; {most}")
    return Collector(environments, policy, horizon, actors, seed, bool(log_probs), granted, repetitions)


class _Actor:
    """Some of the environments, in a process of Ray."""

    def __init__(self, state: bytes, policy: Policy | Callable[[Any], Policy], horizon: int, log_probs: bool, threads: int) -> None:
        self._envs = _with_threads(pickle.loads(state), threads)
        self._policy, self._horizon, self._log_probs = policy, horizon, log_probs

    @ray.method(num_returns=2)
    def rollout(self, weights: Any) -> tuple[Tensors, bytes]:
        policy = self._policy if isinstance(self._policy, Policy) else self._policy(weights)
        found = self._envs.rollout(policy, self._horizon, log_probs=self._log_probs)
        names = ("observations", "actions", "rewards", "terminated", "truncated", "transitions", "last_observations", "episodes", "log_probs")
        tensors = {name: getattr(found, name) for name in names}
        return {name: value for name, value in tensors.items() if value is not None}, pickle.dumps(self._envs)


def _with_threads(environments: Environments, threads: int) -> Environments:
    """Return environments with another number of threads, which changes no bits."""
    again, (kind, (subject, given), *others) = environments.__reduce__()
    made: Environments = again(kind, (subject, {**given, "threads": threads}), *others)
    return made


def _slice(environments: Environments, part: range, seed: int) -> Environments:
    """Return some of the environments, after a reset."""
    subject, given = environments._arguments
    keywords: dict[str, Any] = {**given, "num_envs": len(part)}
    for name, value in _of_each(given, environments.num_envs, len(environments.preset.actions)):
        keywords[name] = value[part.start : part.stop]
    made = type(environments)._construct(subject, keywords)
    made.reset(seed=list(range(seed + part.start, seed + part.stop)))
    return made


def _of_each(given: Mapping[str, Any], num_envs: int, inputs: int) -> Iterator[tuple[str, NDArray[Any]]]:
    """Return the keywords with a number for each environment."""
    for name, value in given.items():
        is_input = name == "max_action" and inputs == num_envs
        if (name not in OPTIONS or name == "max_action") and not is_input and np.ndim(value) == 1 and len(value) == num_envs:
            yield name, np.asarray(value)
