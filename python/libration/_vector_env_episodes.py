"""Checks of what happens at the end of an episode, and of resets of some sub-environments."""

from __future__ import annotations

import copy
from typing import Callable, Iterator

import numpy as np
from gymnasium.vector import AutoresetMode

from ._vector_env_trial import Found, NotChecked, Subject, first_difference, replaced, rows

__all__ = ["EPISODES"]


def _end(subject: Subject) -> tuple[int, int]:
    """The first step that ends an episode, and its sub-environment."""
    end = subject.trial.first_end
    if end is None:
        raise NotChecked(f"no episode ended within {len(subject.trial.steps)} steps of random actions")
    return end


def _code(subject: Subject, line: str) -> tuple[str, ...]:
    time, _ = _end(subject)
    return subject.lines(f"env.reset(seed={subject.seed}); env.action_space.seed({subject.seed})", f"for _ in range({time + 2}): observations, rewards, terminations, truncations, infos = env.step(env.action_space.sample()); {line}")


def next_step(subject: Subject) -> Iterator[Found]:
    if subject.mode is not AutoresetMode.NEXT_STEP:
        raise NotChecked("the mode is not NEXT_STEP")
    time, i = _end(subject)
    steps = subject.trial.steps
    if time + 1 >= len(steps):
        raise NotChecked("the first episode ends with the last step")
    after = steps[time + 1]
    if after.rewards[i] != 0:
        yield f"the reward of sub-environment {i} is {after.rewards[i]} in the step that resets it, but it must be 0", _code(subject, "print(rewards)")
    if after.ended[i]:
        yield f"sub-environment {i} ends again in the step that resets it", _code(subject, "print(terminations, truncations)")
    env = subject.fresh()
    others = list(subject.actions(env))[::-1]
    actions = [copy.deepcopy(step.actions) for step in steps[: time + 2]]
    actions[time + 1] = replaced(env, actions[time + 1], i, others[0])
    again = subject.play(env, iter(actions)).steps
    one, other = (rows(env, "observation", each[time + 1].observations)[i] for each in (steps, again))
    if (found := first_difference(one, other, "the observation")) is not None:
        yield f"the action of the step that resets sub-environment {i} changes its start: {found}", _code(subject, f"print(observations[{i}])")


def same_step(subject: Subject) -> Iterator[Found]:
    if subject.mode is not AutoresetMode.SAME_STEP:
        raise NotChecked("the mode is not SAME_STEP")
    time, i = _end(subject)
    step = subject.trial.steps[time]
    for key in ("final_obs", "final_info"):
        if key not in step.infos:
            yield f"infos have no {key!r} where episodes end", _code(subject, "print(infos)")
    if "final_obs" not in step.infos:
        return
    mask = step.infos.get("_final_obs")
    if mask is None or not np.array_equal(mask, step.ended):
        yield f"infos['_final_obs'] is {mask}, but {step.ended} have ended", _code(subject, "print(infos)")
    final = step.infos["final_obs"][i]
    if not subject.first.single_observation_space.contains(final):
        yield f"infos['final_obs'][{i}] is not in single_observation_space: {final!r}", _code(subject, "print(infos)")
    start = rows(subject.first, "observation", step.observations)[i]
    if first_difference(final, start, "the observation") is None:
        yield f"the observation of sub-environment {i} is the last of its episode, but it must be the first of the next", _code(subject, "print(observations, infos)")


def partial_resets(subject: Subject) -> Iterator[Found]:
    if subject.mode is not AutoresetMode.DISABLED:
        raise NotChecked("the mode is not DISABLED")
    end = subject.trial.first_end
    before = min(5, len(subject.trial.steps) - 1 if end is None else end[0])
    actions = [step.actions for step in subject.trial.steps]
    if before == 0:
        raise NotChecked("an episode ends with the first step")
    env, other = subject.fresh(), subject.fresh()
    for each in (env, other):
        each.reset(seed=subject.seed)
        for chosen in actions[: before - 1]:
            results = each.step(copy.deepcopy(chosen))
    last = copy.deepcopy(results[0]) if before > 1 else copy.deepcopy(subject.trial.observations)
    mask = np.zeros(subject.num_envs, dtype=bool)
    mask[0] = True
    options = {"reset_mask": mask.copy()}
    code = subject.lines(f"env.reset(seed={subject.seed}); env.step(env.action_space.sample())", f'env.reset(options={{"reset_mask": np.array({mask.tolist()})}})')
    observations = copy.deepcopy(env.reset(options=options)[0])
    if "reset_mask" not in options or not np.array_equal(options["reset_mask"], mask):
        yield "reset changes its options: 'reset_mask' is gone or another", (*code[:1], f'options = {{"reset_mask": np.array({mask.tolist()})}}', "env.reset(seed=0); env.reset(options=options); print(options)")
    pairs = list(zip(rows(env, "observation", last), rows(env, "observation", observations)))
    for i, (was, now) in enumerate(pairs[1:], start=1):
        if (found := first_difference(was, now, "the observation")) is not None:
            yield f"a reset of sub-environment 0 changes the observation of {i}: {found}", code
    one, two = (copy.deepcopy(each.step(copy.deepcopy(actions[before - 1]))) for each in (env, other))
    for i in range(1, subject.num_envs):
        a, b = (rows(env, "observation", each[0])[i] for each in (one, two))
        if (found := first_difference(a, b, "the observation")) is not None:
            yield f"a reset of sub-environment 0 changes the next step of {i}: {found}", code


#: Name, whether Gymnasium promises it, and the check.
EPISODES: tuple[tuple[str, bool, Callable[[Subject], Iterator[Found]]], ...] = (
    ("autoreset in the next step", True, next_step),
    ("autoreset in the same step", True, same_step),
    ("partial resets", True, partial_resets),
)
