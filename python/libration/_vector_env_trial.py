"""Trials of vector environments, from which their checks read."""

from __future__ import annotations

import contextlib
import copy
import importlib
from dataclasses import dataclass, field
from typing import Any, Callable, Iterator

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array, iterate

__all__ = ["Breach", "Found", "NotChecked", "Step", "Subject", "first_difference", "leaves", "registered_id", "replaced", "rows", "spec_of"]

#: A sentence, and the lines that show it.
Found = tuple[str, tuple[str, ...]]


@dataclass(frozen=True)
class Breach:
    """What breaks the contract: the name of the check, a sentence, and three lines of code that show it."""

    check: str
    sentence: str
    lines: tuple[str, ...]


def registered_id(name: str) -> str:
    """Return the id in Gymnasium's registry of a name such as ``gym:CartPole-v1``, ``CartPole-v1`` or ``module:Name-v0``."""
    return name.removeprefix("gym:")


def spec_of(id: str) -> EnvSpec:
    """Return the spec of an id, after the import of its module."""
    module, _, name = id.rpartition(":")
    if module:
        importlib.import_module(module)
    return gymnasium.spec(name)


class NotChecked(Exception):
    """A check that cannot be done, with the reason."""


@dataclass
class Step:
    """The results of a step, as they were when it returned."""

    actions: Any
    observations: Any
    rewards: Any
    terminations: Any
    truncations: Any
    infos: dict[str, Any]

    @property
    def ended(self) -> np.ndarray:
        """Which sub-environments ended an episode."""
        return np.logical_or(self.terminations, self.truncations)


@dataclass
class Trial:
    """What followed a reset with a seed."""

    observations: Any
    infos: dict[str, Any]
    steps: list[Step] = field(default_factory=list)

    @property
    def first_end(self) -> tuple[int, int] | None:
        """The first step at which an episode ends, and the first sub-environment that ends there."""
        for time, step in enumerate(self.steps):
            if step.ended.any():
                return time, int(np.argmax(step.ended))
        return None


class Subject:
    """A vector environment, how it is made, and trials of it."""

    def __init__(
        self,
        env: Any,
        num_envs: int,
        max_steps: int,
        seed: int,
        source: str | None,
        sample: Callable[[VectorEnv, np.random.Generator], Any] | None,
    ) -> None:
        self.num_envs, self.max_steps, self.seed, self.sample = num_envs, max_steps, seed, sample
        #: Why step refuses actions; found by the check of actions.
        self.refusal: str | None = None
        self._make: Callable[[int], VectorEnv] | None = None
        self._given: VectorEnv | None = None
        self._made: list[VectorEnv] = []
        if isinstance(env, str):
            env = registered_id(env)
            spec_of(env)
            self._make, self.source = lambda n: gymnasium.make_vec(env, n), f'gymnasium.make_vec("{env}", NUM)'
        elif isinstance(env, VectorEnv):
            self._given, self.num_envs, self.source = env, env.num_envs, "..."
            if (spec := env.spec) is not None:
                self._make, self.source = lambda n: gymnasium.make_vec(spec, n), f'gymnasium.make_vec("{spec.id}", NUM)'
        elif callable(env):
            # A lambda has no name that a reader can write.
            name = getattr(env, "__qualname__", "<")
            self._make, self.source = env, f"{'make' if '<' in name else name}(NUM)"
        else:
            raise TypeError(f"env is {env!r}, but it must be a VectorEnv, a function of num_envs that returns one, or an id")
        self.source = source or self.source
        first = self.env()
        if not isinstance(first, VectorEnv):
            raise TypeError(f"env makes a {type(first).__name__}, but it must make a gymnasium.vector.VectorEnv")
        self.first = first
        mode = (getattr(first, "metadata", None) or {}).get("autoreset_mode")
        self.mode = mode if isinstance(mode, AutoresetMode) else None
        told = f", {self.mode.name}" if self.mode else ""
        self.name = f"{first}{told}"
        self._trial: Trial | None = None

    def env(self, num_envs: int | None = None) -> VectorEnv:
        """Return an environment of this many sub-environments that no other check uses, or the given one."""
        wanted = num_envs or self.num_envs
        if self._make is None:
            assert self._given is not None
            if wanted != self._given.num_envs:
                raise NotChecked("a given environment without spec has one number of sub-environments: give a function of num_envs")
            return self._given
        made = self._make(wanted)
        self._made.append(made)
        return made

    def fresh(self, num_envs: int | None = None) -> VectorEnv:
        """Return an environment that has done nothing yet."""
        if self._make is None:
            raise NotChecked("a given environment without spec cannot be made twice: give a function of num_envs")
        return self.env(num_envs)

    def close(self) -> None:
        """Close what was made here."""
        for env in self._made:
            # What is wrong with it the check of closing tells.
            with contextlib.suppress(Exception):
                if not env.closed:
                    env.close()

    def lines(self, *code: str, num_envs: int | None = None) -> tuple[str, ...]:
        """Return lines of code, the first of which makes the environment; ``sample`` is the caller's function, and ``random`` a generator."""
        if self.sample is not None:
            code = tuple(line.replace("env.action_space.sample()", "sample(env, random)") for line in code)
        return (f"env = {self.source.replace('NUM', str(num_envs or self.num_envs))}", *code)

    @property
    def trial(self) -> Trial:
        """The trial from the seed to the step behind the first end of an episode."""
        if self._trial is None:
            self._trial = self.play(self.env(), self.actions(self.first))
        return self._trial

    def actions(self, env: VectorEnv) -> Iterator[Any]:
        """Yield random actions that follow from the seed."""
        if self.refusal is not None:
            raise NotChecked(f"step refuses samples of action_space ({self.refusal}): give a function sample")
        random = np.random.default_rng(self.seed)
        space = copy.deepcopy(env.action_space)
        space.seed(self.seed)
        for _ in range(self.max_steps):
            yield space.sample() if self.sample is None else self.sample(env, random)

    def play(self, env: VectorEnv, actions: Iterator[Any], seed: Any = None, beyond: int = 2) -> Trial:
        """Reset, then step until ``beyond`` steps after the first end of an episode."""
        observations, infos = env.reset(seed=self.seed if seed is None else seed)
        trial, left = Trial(copy.deepcopy(observations), copy.deepcopy(infos)), None
        for chosen in actions:
            result = env.step(copy.deepcopy(chosen))
            step = Step(chosen, *copy.deepcopy(result))
            trial.steps.append(step)
            if left is None and step.ended.any():
                left = beyond
            if left is not None:
                if left == 0:
                    break
                left -= 1
            self.begin_ended(env, step.ended)
        return trial

    def begin_ended(self, env: VectorEnv, ended: np.ndarray) -> None:
        """Reset the sub-environments that ended, in the mode ``DISABLED``; the other modes do so themselves."""
        if self.mode is AutoresetMode.DISABLED and ended.any():
            env.reset(options={"reset_mask": np.array(ended)})


def leaves(value: Any, path: str = "observations") -> Iterator[tuple[str, np.ndarray]]:
    """Yield the arrays of a batch with the expressions that lead to them."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from leaves(part, f"{path}[{key!r}]")
    elif isinstance(value, (tuple, list)):
        for i, part in enumerate(value):
            yield from leaves(part, f"{path}[{i}]")
    else:
        yield path, np.asarray(value)


def first_difference(one: Any, other: Any, path: str = "observations") -> str | None:
    """Return where two values differ and how, or None."""
    pairs, others = list(leaves(one, path)), list(leaves(other, path))
    if len(pairs) != len(others):
        return f"{path} have {len(pairs)} parts, and {len(others)}"
    for (name, a), (_, b) in zip(pairs, others):
        if a.shape != b.shape or a.dtype != b.dtype:
            return f"{name} has the shape {a.shape} and the type {a.dtype}, and {b.shape} and {b.dtype}"
        same = (a == b) | ((a != a) & (b != b)) if a.dtype != object else np.array([x is y or np.array_equal(x, y) for x, y in zip(a.ravel(), b.ravel())])
        if not np.all(same):
            place = tuple(int(i) for i in np.argwhere(~np.asarray(same))[0]) if np.ndim(same) else ()
            return f"{name}{list(place) if place else ''} is {np.asarray(a)[place]!r} and {np.asarray(b)[place]!r}"
    return None


def rows(env: VectorEnv, kind: str, batch: Any) -> list[Any]:
    """Return the observations or the actions of a batch one by one, even where the space of the batch is not what it must be."""
    space = batch_space(getattr(env, f"single_{kind}_space"), env.num_envs)
    return list(iterate(space, batch))


def replaced(env: VectorEnv, actions: Any, index: int, other: Any) -> Any:
    """Return actions of which one is that of ``other``."""
    mixed = [copy.deepcopy(row) for row in rows(env, "action", actions)]
    mixed[index] = copy.deepcopy(rows(env, "action", other)[index])
    out: Any = create_empty_array(env.single_action_space, n=env.num_envs, fn=np.zeros)
    return concatenate(env.single_action_space, mixed, out)
