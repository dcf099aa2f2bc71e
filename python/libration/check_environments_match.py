"""Comparison of two environments of Gymnasium step by step.

``python -m libration.check_environments_match CartPole-v1 libration/CartPole-v1 --second starts=gymnasium`` compares registered environments, with
exit code 1 if they differ.
"""

from __future__ import annotations

import argparse
import json
import math
import numbers
import sys
from dataclasses import dataclass
from typing import Any, Callable, Mapping, Sequence

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Discrete, MultiBinary, MultiDiscrete

from ._vector_env_trial import registered_id

__all__ = ["EnvironmentsMatch", "check_environments_match", "main"]

Make = gymnasium.Env | str | Callable[[], gymnasium.Env]


@dataclass(frozen=True)
class EnvironmentsMatch:
    """What :func:`check_environments_match` has found.

    An ulp is the distance of neighbouring floats at the largest size that an observed number has in a bounded observation space, else at the
    largest size so far.
    """

    names: tuple[str, str]
    steps: int
    """Steps of each seed."""
    compared: int
    """Steps of all seeds that were compared."""
    episodes: int
    """Ended episodes of all seeds."""
    seeds: tuple[int, ...]
    observation_ulps: tuple[float, ...]
    """Largest difference of each observed number in ulps."""
    reward_difference: float
    """Largest difference of rewards relative to the largest of them, or to 1."""
    equal_observations: float
    """Share of steps after which all observed numbers are equal."""
    difference: str | None
    """The first difference beyond a tolerance: seed, step, and what differs."""

    @property
    def matches(self) -> bool:
        """Whether no difference is beyond the tolerance."""
        return self.difference is None

    def __bool__(self) -> bool:
        return self.matches

    def __str__(self) -> str:
        first, second = self.names
        # A seed ends at its first difference.
        steps = f"{len(self.seeds)} × {self.steps}" if self.matches else f"{self.compared} of {len(self.seeds)} × {self.steps}"
        head = f"{first} and {second}: {steps} steps, {self.episodes} episodes"
        ulps = ", ".join(f"{x:.3g}" for x in self.observation_ulps)
        lines = [
            f"{head}: {'match' if self.matches else 'differ'}",
            f"observations: at most {ulps} ulps apart, equal after {100 * self.equal_observations:.4g} % of the steps",
            f"rewards: at most {self.reward_difference:.3g} apart, relative to the largest",
        ]
        if self.difference is not None:
            lines.append(f"first difference beyond the tolerance: {self.difference}")
            if self.compared == 0 and any(self.observation_ulps):
                lines.append("help: episodes start elsewhere; the twins of Libration have the starts of Gymnasium with starts='gymnasium'")
        return "\n".join(lines)


def check_environments_match(
    first: Make,
    second: Make,
    *,
    steps: int = 10_000,
    seeds: Sequence[int] = (0, 1, 2),
    tolerance_ulps: float = 4.0,
    reward_tolerance: float = 1e-12,
    sample: Callable[[gymnasium.Env, np.random.Generator], Any] | None = None,
) -> EnvironmentsMatch:
    """Step two environments with the same seeds and actions, and compare what they return.

    Each seed resets both; after the end of an episode both are reset without a seed. The comparison of a seed ends at its first difference
    beyond the tolerance.

    Parameters
    ----------
    first, second : gymnasium.Env, str or callable
        Environments, ids of registered ones, or functions that return one.
    steps : int
        Steps of each seed.
    seeds : sequence of int
        Seeds of resets and of actions.
    tolerance_ulps : float
        Largest allowed difference of observed numbers in ulps.
    reward_tolerance : float
        Largest allowed difference of rewards relative to the largest, or to 1.
    sample : callable, optional
        A function of the first environment and of a generator that returns an action (default: samples of its action space).

    Raises
    ------
    TypeError, ValueError
        For an invalid argument, and for spaces that differ.
    """
    if isinstance(seeds, (str, bytes)) or not hasattr(seeds, "__iter__"):
        raise TypeError(f"seeds is {seeds!r}, but it must be a list of integers")
    all_seeds = list(seeds)
    for name, value in (("steps", steps), *((f"seeds[{i}]", seed) for i, seed in enumerate(all_seeds))):
        if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
            raise TypeError(f"{name} is {value!r}, but it must be an integer")
        if value < (name == "steps"):
            raise ValueError(f"{name} is {value}, but it must be at least {int(name == 'steps')}")
    if not all_seeds:
        raise ValueError("seeds is empty, but it must have at least one seed")
    for name, tolerance in (("tolerance_ulps", tolerance_ulps), ("reward_tolerance", reward_tolerance)):
        if isinstance(tolerance, bool) or not (isinstance(tolerance, numbers.Real) and tolerance >= 0):
            raise ValueError(f"{name} is {tolerance!r}, but it must be a number of at least 0")
    if first is second and isinstance(first, gymnasium.Env):
        raise ValueError("first and second are the same environment, but they must be two")
    envs: list[gymnasium.Env] = []
    try:
        envs += (_made(each) for each in (first, second))
        names = (_name(envs[0]), _name(envs[1]))
        for space in ("observation_space", "action_space"):
            own, other = (getattr(env, space) for env in envs)
            if own != other:
                raise ValueError(f"{space} of {names[0]} is {own}, of {names[1]} {other}, but they must be equal")
        if not isinstance(envs[0].observation_space, (Box, Discrete, MultiBinary, MultiDiscrete)):
            kind = type(envs[0].observation_space).__name__
            raise ValueError(f"observation_space of {names[0]} is a {kind}, but it must be an array; help: gymnasium.wrappers.FlattenObservation")
        run = _Run(envs, (float(tolerance_ulps), float(reward_tolerance)), sample)
        for seed in all_seeds:
            run.seed(int(seed), int(steps))
    finally:
        for env, given in zip(envs, (first, second)):
            if env is not given:
                env.close()
    return run.result(names, int(steps), tuple(int(seed) for seed in all_seeds))


class _Run:
    """Differences so far."""

    def __init__(self, envs: Sequence[gymnasium.Env], tolerances: tuple[float, float], sample: Callable[..., Any] | None) -> None:
        self.envs, self.sample = envs, sample
        self.tolerance, self.reward_tolerance = tolerances
        self.count = self.equal = self.episodes = self.compared = 0
        space = envs[0].observation_space
        ends = [np.abs(getattr(space, name, np.zeros(()))) for name in ("low", "high")]
        self.largest: Any = np.where(np.isfinite(ends[0]) & np.isfinite(ends[1]), np.maximum(*ends), 0)
        self.apart: Any = 0.0
        self.reward = [1.0, 0.0]
        self.difference: str | None = None

    def seed(self, seed: int, steps: int) -> None:
        generator = np.random.default_rng(seed)
        self.envs[0].action_space.seed(seed)
        rows = [env.reset(seed=seed)[0] for env in self.envs]
        if self.observed(rows, f"seed {seed}, reset"):
            return
        for step in range(steps):
            space = self.envs[0].action_space
            action = space.sample() if self.sample is None else self.sample(self.envs[0], generator)
            results: list[Any] = [env.step(action) for env in self.envs]
            self.compared += 1
            place = f"seed {seed}, step {step}"
            if self.observed([result[0] for result in results], place):
                return
            if self.rewarded([float(result[1]) for result in results], place):
                return
            for i, flag in ((2, "terminated"), (3, "truncated")):
                own, other = (bool(result[i]) for result in results)
                if own != other:
                    self.found(f"{place}: {flag} is {own} and {other}")
                    return
            if results[0][2] or results[0][3]:
                self.episodes += 1
                if self.observed([env.reset()[0] for env in self.envs], f"{place}, reset"):
                    return

    def observed(self, rows: Sequence[Any], place: str) -> bool:
        """Compare observations and return whether they are too far apart."""
        own, other = (np.atleast_1d(np.asarray(row)) for row in rows)
        if own.shape != other.shape or own.dtype != other.dtype:
            return self.found(f"{place}: observations are {own.dtype}{own.shape} and {other.dtype}{other.shape}")
        self.count += 1
        if np.array_equal(own, other, equal_nan=own.dtype.kind == "f"):
            self.equal += 1
            return False
        if own.dtype.kind != "f":
            i = int(np.argmax((own != other).ravel()))
            return self.found(f"{place}: observation[{i}] is {own.flat[i]!r} and {other.flat[i]!r}")
        # Numbers that are equal, also if they are not finite, are not apart.
        same = (own == other) | (np.isnan(own) & np.isnan(other))
        with np.errstate(invalid="ignore"):
            apart = np.where(same, 0.0, np.abs(own.astype(np.float64) - other.astype(np.float64)))
        size = np.maximum(np.abs(own), np.abs(other))
        self.largest = np.maximum(self.largest, np.where(np.isfinite(size), size, 0))
        self.apart = np.maximum(self.apart, apart)
        ulps = self.ulps(own.dtype)
        if (~(ulps <= self.tolerance)).any():
            i = int(np.argmax(~(ulps <= self.tolerance)))
            return self.found(f"{place}: observation[{i}] is {own.flat[i]!r} and {other.flat[i]!r}")
        return False

    def ulps(self, dtype: Any) -> np.ndarray:
        """Return the largest difference of each number in ulps; none where all were equal."""
        if np.dtype(dtype).kind != "f":
            return np.zeros(1)
        spacing = np.spacing(np.asarray(self.largest, dtype)).astype(np.float64)
        return np.ravel(self.apart / spacing)

    def rewarded(self, pair: Sequence[float], place: str) -> bool:
        own, other = pair
        if own == other or (math.isnan(own) and math.isnan(other)):
            return False
        apart = abs(own - other)
        if math.isfinite(apart):
            self.reward = [max(self.reward[0], abs(own), abs(other)), max(self.reward[1], apart)]
        if not (math.isfinite(apart) and self.reward[1] <= self.reward_tolerance * self.reward[0]):
            return self.found(f"{place}: reward is {own!r} and {other!r}")
        return False

    def found(self, text: str) -> bool:
        self.difference = self.difference or text
        return True

    def result(self, names: tuple[str, str], steps: int, seeds: tuple[int, ...]) -> EnvironmentsMatch:
        ulps = self.ulps(self.envs[0].observation_space.dtype or np.float64)
        return EnvironmentsMatch(
            names=names,
            steps=steps,
            compared=self.compared,
            episodes=self.episodes,
            seeds=seeds,
            observation_ulps=tuple(float(x) for x in ulps),
            reward_difference=self.reward[1] / self.reward[0],
            equal_observations=self.equal / max(1, self.count),
            difference=self.difference,
        )


def _made(env: Make) -> gymnasium.Env:
    made = gymnasium.make(registered_id(env)) if isinstance(env, str) else env
    if not isinstance(made, gymnasium.Env) and callable(made):
        made = made()
    if not isinstance(made, gymnasium.Env):
        raise TypeError(f"an environment is {made!r}, but it must be a gymnasium.Env, an id, or a function that returns one")
    return made


def _name(env: gymnasium.Env) -> str:
    return env.spec.id if env.spec is not None else type(env.unwrapped).__name__


def _keywords(texts: Sequence[str]) -> Mapping[str, Any]:
    """Return keywords of ``name=value``, where a value is JSON or text."""
    keywords = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise ValueError(f"{text!r} is no keyword, but it must be like action_delay=0.02")
        try:
            keywords[name] = json.loads(value)
        except json.JSONDecodeError:
            keywords[name] = value
    return keywords


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare the environments of a command line and return the exit code: 0 if they match, 1 if they differ."""
    parser = argparse.ArgumentParser(prog="libration.check_environments_match", description="Compare two environments step by step.")
    parser.add_argument("ids", nargs=2, metavar="ID", help="id of a registered environment")
    for name in ("first", "second"):
        parser.add_argument(f"--{name}", nargs="*", default=[], metavar="NAME=VALUE", help=f"keywords of the {name} environment")
    parser.add_argument("--steps", type=int, default=10_000, help="steps of each seed (default: 10000)")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2], help="seeds (default: 0 1 2)")
    parser.add_argument("--tolerance-ulps", type=float, default=4.0, help="largest allowed difference (default: 4)")
    parser.add_argument("--reward-tolerance", type=float, default=1e-12, help="largest allowed relative difference of rewards (default: 1e-12)")
    given = parser.parse_args(arguments)
    try:
        keywords = [_keywords(texts) for texts in (given.first, given.second)]
        envs = [gymnasium.make(registered_id(id), **own) for id, own in zip(given.ids, keywords)]
        tolerances = {"tolerance_ulps": given.tolerance_ulps, "reward_tolerance": given.reward_tolerance}
        found = check_environments_match(*envs, steps=given.steps, seeds=given.seeds, **tolerances)
    except (gymnasium.error.Error, ImportError, TypeError, ValueError) as error:
        parser.exit(2, f"error: {error}\n")
    print(found)
    return 0 if found.matches else 1


if __name__ == "__main__":
    sys.exit(main())
