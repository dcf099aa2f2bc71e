"""Check of the contract of :class:`gymnasium.vector.VectorEnv`.

``python -m libration.check_vector_env CartPole-v1`` checks a registered environment, with exit code 1 if it breaks the contract. The prefix
``gym:``, as in ``gym:CartPole-v1``, is that of Gymnasium's registry and may be left out.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from typing import Any, Callable, Sequence

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv

from ._vector_env_checks import CHECKS
from ._vector_env_trial import Breach, NotChecked, Subject, registered_id, spec_of

__all__ = ["VectorEnvReport", "check_vector_env", "main"]


@dataclass(frozen=True)
class VectorEnvReport:
    """What :func:`check_vector_env` has found.

    ``breaches`` break what Gymnasium documents; ``remarks`` are properties that it does not promise, such as rows that do not depend on
    ``num_envs``. ``passed`` are the names of checks, ``not_checked`` pairs of a name and the reason.
    """

    name: str
    breaches: tuple[Breach, ...]
    remarks: tuple[Breach, ...]
    passed: tuple[str, ...]
    not_checked: tuple[tuple[str, str], ...]

    @property
    def is_correct(self) -> bool:
        """Whether nothing breaks the contract."""
        return not self.breaches

    def __str__(self) -> str:
        lines = [f"{self.name}: {_plural(len(self.breaches), 'breach', 'breaches')}, {_plural(len(self.remarks), 'remark')}, {len(self.passed)} checks passed"]
        for kind, found in (("breach", self.breaches), ("remark", self.remarks)):
            for breach in found:
                lines += [f"{kind}: {breach.check}: {breach.sentence}", *(f"    {line}" for line in breach.lines)]
        lines += [f"not checked: {name}: {reason}" for name, reason in self.not_checked]
        return "\n".join(lines)


def check_vector_env(
    env: VectorEnv | str | Callable[[int], VectorEnv],
    *,
    num_envs: int = 3,
    max_steps: int = 1000,
    seed: int = 0,
    sample: Callable[[VectorEnv, np.random.Generator], Any] | None = None,
    source: str | None = None,
) -> VectorEnvReport:
    """Check that a vector environment keeps the contract of Gymnasium.

    Parameters
    ----------
    env : gymnasium.vector.VectorEnv, str or callable
        A function of ``num_envs`` that returns a new environment; or the id of a registered one; or an environment, which is made again
        from its ``spec``. Without ``spec`` the checks that need two environments are not done.
    num_envs : int
        Sub-environments of each trial, at least 2.
    max_steps : int
        Most steps of a trial, which ends at the first end of an episode.
    seed : int
        Seed of resets and of actions.
    sample : callable, optional
        A function of the environment and of a generator that returns actions, where ``action_space.sample()`` will not do.
    source : str, optional
        How a reader makes the environment, for the lines of a breach; by default what ``env`` tells.

    Returns
    -------
    VectorEnvReport
        ``print`` shows each breach with at most three lines of code that show where it is.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what it must be.
    """
    for name, value, least in (("num_envs", num_envs, 2), ("max_steps", max_steps, 1), ("seed", seed, 0)):
        if isinstance(value, bool) or not isinstance(value, int):
            raise TypeError(f"{name} is {value!r}, but it must be an integer")
        if value < least:
            raise ValueError(f"{name} is {value}, but it must be at least {least}")
    subject = Subject(env, num_envs, max_steps, seed, source, sample)
    breaches: list[Breach] = []
    remarks: list[Breach] = []
    passed: list[str] = []
    not_checked: list[tuple[str, str]] = []
    try:
        for name, is_promised, check in CHECKS:
            try:
                found = [Breach(name, *each) for each in check(subject)]
            except NotChecked as reason:
                not_checked.append((name, str(reason)))
                continue
            except Exception as error:
                found = [Breach(name, f"it raises {type(error).__name__}: {error}", subject.lines("env.reset(seed=0)"))]
            (breaches if is_promised else remarks).extend(found)
            if not found:
                passed.append(name)
    finally:
        subject.close()
    return VectorEnvReport(subject.name, tuple(breaches), tuple(remarks), tuple(passed), tuple(not_checked))


def _plural(count: int, noun: str, many: str | None = None) -> str:
    return f"{count} {noun if count == 1 else many or noun + 's'}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Check the environments of a command line and return the exit code: 0 if all keep the contract, 1 if one does not."""
    parser = argparse.ArgumentParser(
        prog="python -m libration.check_vector_env",
        description="Check that vector environments keep the contract of Gymnasium.",
    )
    parser.add_argument("id", nargs="+", help="id of a registered environment, such as CartPole-v1, gym:CartPole-v1 or module:Name-v0")
    parser.add_argument(
        "--vectorization-mode",
        choices=("sync", "async", "vector_entry_point"),
        help="how gymnasium.make_vec makes it; default: its own vector environment, otherwise sync",
    )
    parser.add_argument(
        "--autoreset-mode",
        choices=("next-step", "same-step", "disabled", "all"),
        help="mode of sync and async; default: all three of them",
    )
    parser.add_argument("--num-envs", type=int, default=3, help="sub-environments; default: 3")
    parser.add_argument("--max-steps", type=int, default=1000, help="most steps of a trial; default: 1000")
    parser.add_argument("--seed", type=int, default=0, help="seed of resets and actions; default: 0")
    given = parser.parse_args(arguments)
    is_correct = True
    for id in given.id:
        try:
            trials = _trials(id, given.vectorization_mode, given.autoreset_mode)
            for make, source in trials:
                report = check_vector_env(make, num_envs=given.num_envs, max_steps=given.max_steps, seed=given.seed, source=source)
                print(report)
                is_correct &= report.is_correct
        except (gymnasium.error.Error, ImportError, TypeError, ValueError) as error:
            print(f"{parser.prog}: {id}: {error}", file=sys.stderr)
            return 2
    return 0 if is_correct else 1


def _trials(id: str, mode: str | None, autoreset: str | None) -> list[tuple[Callable[[int], VectorEnv], str]]:
    """Return the environments of an id, as functions of ``num_envs`` with the lines that make them."""
    id = registered_id(id)
    spec = spec_of(id)
    if mode is None:
        mode = "sync" if spec.vector_entry_point is None else "vector_entry_point"
    if mode == "vector_entry_point":
        if autoreset is not None:
            raise ValueError(f"--autoreset-mode is {autoreset}, but it must be left out: the vector environment of {id} has a mode of its own")
        return [(lambda n: gymnasium.make_vec(id, n, vectorization_mode=mode), f'gymnasium.make_vec("{id}", NUM, vectorization_mode="{mode}")')]
    chosen = [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP, AutoresetMode.DISABLED]
    if autoreset not in (None, "all"):
        chosen = [each for each in chosen if each.name.lower().replace("_", "-") == autoreset]

    def trial(autoreset_mode: AutoresetMode) -> tuple[Callable[[int], VectorEnv], str]:
        kwargs = {"autoreset_mode": autoreset_mode}
        source = f'gymnasium.make_vec("{id}", NUM, vectorization_mode="{mode}", vector_kwargs={{"autoreset_mode": gymnasium.vector.{autoreset_mode}}})'
        return lambda n: gymnasium.make_vec(id, n, vectorization_mode=mode, vector_kwargs=dict(kwargs)), source

    return [trial(each) for each in chosen]


if __name__ == "__main__":
    sys.exit(main())
