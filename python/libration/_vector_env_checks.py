"""Checks of a vector environment: each yields a sentence with the lines of code that show it, for every breach."""

from __future__ import annotations

import copy
from typing import Any, Callable, Iterator

import numpy as np
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array, iterate

from ._vector_env_episodes import EPISODES
from ._vector_env_trial import Found, NotChecked, Subject, Trial, first_difference, leaves, replaced, rows

__all__ = ["CHECKS"]

#: Steps of checks that need no end of an episode.
FEW = 10


def spaces(subject: Subject) -> Iterator[Found]:
    env = subject.first
    if env.num_envs != subject.num_envs:
        yield f"num_envs is {env.num_envs}, but it must be {subject.num_envs}", subject.lines("print(env.num_envs)")
    for kind in ("observation", "action"):
        single, batch = getattr(env, f"single_{kind}_space"), getattr(env, f"{kind}_space")
        wanted = batch_space(single, env.num_envs)
        if _types(batch.sample()) != _types(wanted.sample()):
            yield f"{kind}_space is {batch}, but {env.num_envs} of single_{kind}_space are {wanted}", subject.lines(f"print(env.{kind}_space)", f"print(gymnasium.vector.utils.batch_space(env.single_{kind}_space, env.num_envs))")


def autoreset_mode(subject: Subject) -> Iterator[Found]:
    if subject.mode is None:
        told = (subject.first.metadata or {}).get("autoreset_mode")
        yield f'metadata["autoreset_mode"] is {told!r}, but it must be a gymnasium.vector.AutoresetMode', subject.lines('print(env.metadata.get("autoreset_mode"))')


def results_of_reset(subject: Subject) -> Iterator[Found]:
    result = subject.env().reset(seed=subject.seed)
    code = subject.lines(f"result = env.reset(seed={subject.seed})")
    if not (isinstance(result, tuple) and len(result) == 2):
        yield "reset does not return two values, observations and infos", (*code, "print(result)")
        return
    observations, infos = result
    if not subject.first.observation_space.contains(observations):
        yield f"the observations of reset are not in observation_space: {_types(observations)}", (*code, "print(env.observation_space.contains(result[0]))   # True is expected")
    if not isinstance(infos, dict):
        yield f"the infos of reset are a {type(infos).__name__}, but they must be a dict", (*code, "print(result[1])")


def samples_of_actions(subject: Subject) -> Iterator[Found]:
    env = subject.env()
    env.reset(seed=subject.seed)
    space = copy.deepcopy(env.action_space)
    space.seed(subject.seed)
    try:
        env.step(space.sample())
    except Exception as error:
        told = f"{type(error).__name__}: {error}"
        if subject.sample is None:
            subject.refusal = told
        yield f"step refuses a sample of action_space: {told}", subject.lines(f"env.reset(seed={subject.seed})", "env.step(env.action_space.sample())")


def results_of_step(subject: Subject) -> Iterator[Found]:
    env = subject.env()
    env.reset(seed=subject.seed)
    code = subject.lines(f"env.reset(seed={subject.seed}); result = env.step(env.action_space.sample())")
    result = env.step(next(subject.actions(env)))
    if not (isinstance(result, tuple) and len(result) == 5):
        yield "step does not return five values", code
        return
    if not env.observation_space.contains(result[0]):
        yield f"the observations of step are not in observation_space: {_types(result[0])}", (*code, "print(env.observation_space.contains(result[0]))   # True is expected")
    for place, name, kinds in ((1, "rewards", "f"), (2, "terminations", "b"), (3, "truncations", "b")):
        value = result[place]
        wanted = "a NumPy array of floats" if kinds == "f" else "a NumPy array of bool"
        if not (isinstance(value, np.ndarray) and value.dtype.kind in kinds and value.shape == (env.num_envs,)):
            yield f"{name} are {_types(value)}, but they must be {wanted} of the shape ({env.num_envs},)", (*code, f"print(result[{place}])")
    if not isinstance(result[4], dict):
        yield f"infos are a {type(result[4]).__name__}, but they must be a dict", (*code, "print(result[4])")


def finite_rewards(subject: Subject) -> Iterator[Found]:
    for time, step in enumerate(subject.trial.steps):
        rewards = np.asarray(step.rewards)
        if rewards.dtype.kind == "f" and not np.isfinite(rewards).all():
            index = int(np.argmin(np.isfinite(rewards)))
            code = subject.lines(f"env.reset(seed={subject.seed}); print([env.step(env.action_space.sample())[1] for _ in range({time + 1})])   # finite is expected")
            yield f"the reward of sub-environment {index} in step {time} is {rewards[index]}", code
            return


def masks_of_infos(subject: Subject) -> Iterator[Found]:
    code = subject.lines(f"env.reset(seed={subject.seed}); infos = env.step(env.action_space.sample())[4]")
    seen: set[str] = set()
    for infos in (subject.trial.infos, *(step.infos for step in subject.trial.steps)):
        for sentence in _unmasked(infos, subject.num_envs, "infos"):
            if sentence not in seen:
                seen.add(sentence)
                yield sentence, (*code, "print(infos)")


def _unmasked(infos: dict[str, Any], count: int, path: str) -> Iterator[str]:
    for key, value in infos.items():
        if isinstance(key, str) and key.startswith("_") and key[1:] in infos:
            continue
        mask = infos.get(f"_{key}")
        if not (isinstance(mask, np.ndarray) and mask.dtype == bool and mask.shape == (count,)):
            yield f"{path}[{key!r}] has no mask {path}['_{key}'] of {count} bool"
        if isinstance(value, dict):
            yield from _unmasked(value, count, f"{path}[{key!r}]")


def _types(value: Any) -> str:
    if isinstance(value, (dict, tuple, np.ndarray)):
        return ", ".join(f"{name} {array.dtype} {array.shape}" for name, array in leaves(value, "array"))
    return f"a {type(value).__name__}"


def difference(subject: Subject, one: Trial, other: Trial, pairs: list[tuple[int, int]], steps: int, until_end: bool = True) -> str | None:
    """Return where pairs of rows of two trials differ, or None; of each pair only the first episode counts unless told otherwise."""
    if (found := _rows_differ(subject, (one.observations, other.observations), pairs, "after reset")) is not None:
        return found
    left = list(pairs)
    for time, (a, b) in enumerate(zip(one.steps[:steps], other.steps[:steps])):
        for name in ("rewards", "terminations", "truncations"):
            for i, j in left:
                x, y = getattr(a, name)[i], getattr(b, name)[j]
                if x != y and not (x != x and y != y):
                    return f"{name}[{i}] of step {time} is {x} and {y}"
        if (found := _rows_differ(subject, (a.observations, b.observations), left, f"of step {time}")) is not None:
            return found
        if until_end:
            left = [(i, j) for i, j in left if not (a.ended[i] or b.ended[j])]
    return None


def _rows_differ(subject: Subject, batches: tuple[Any, Any], pairs: list[tuple[int, int]], when: str) -> str | None:
    one, other = (_each(subject, batch) for batch in batches)
    for i, j in pairs:
        if (found := first_difference(one[i], other[j], "the observation")) is not None:
            return f"{found} in sub-environment {i} {when}"
    return None


def _each(subject: Subject, batch: Any) -> list[Any]:
    """Return the observations of a batch of any size."""
    count = len(next(leaves(batch))[1])
    space = batch_space(subject.first.single_observation_space, count)
    return list(iterate(space, batch))


def same(count: int) -> list[tuple[int, int]]:
    return [(i, i) for i in range(count)]


def seeds_repeat(subject: Subject) -> Iterator[Found]:
    trial = subject.trial
    env = subject.env()
    # Directly after the end of an episode, when an autoreset may be due.
    again = subject.play(env, (step.actions for step in trial.steps), beyond=0)
    for name in ("a second environment with the same seed", "the same environment after another reset with the seed"):
        found = difference(subject, trial, again, same(subject.num_envs), len(again.steps), until_end=False)
        if found is not None:
            code = subject.lines(f"actions = [env.action_space.sample() for _ in range({len(again.steps)})]", "for _ in range(2): print(env.reset(seed=0), [env.step(a)[0] for a in actions])")
            yield f"{name} does something else after the same actions: {found}", code
        again = subject.play(env, (step.actions for step in trial.steps))


def seeds_differ(subject: Subject) -> Iterator[Found]:
    env = subject.env()
    starts = [copy.deepcopy(env.reset(seed=seed)[0]) for seed in (subject.seed, subject.seed + 1000)]
    if first_difference(*starts) is None:
        raise NotChecked("starts do not depend on the seed")
    if subject.num_envs > 1:
        first, *others = rows(env, "observation", starts[0])
        if all(first_difference(first, other) is None for other in others):
            yield "all sub-environments have the same start", subject.lines(f"print(env.reset(seed={subject.seed})[0])")
    env.reset(seed=subject.seed)
    unseeded = copy.deepcopy(env.reset()[0])
    if first_difference(starts[0], unseeded) is None:
        yield "a reset without seed repeats the start of the seed before it", subject.lines(f"first = env.reset(seed={subject.seed})[0].copy()", "print(env.reset()[0] - first)   # not all zero is expected")


def results_stay(subject: Subject) -> Iterator[Found]:
    env = subject.env()
    kept: list[tuple[str, Any, Any]] = []
    told: set[str] = set()
    observations, _ = env.reset(seed=subject.seed)
    kept.append(("observations of reset", observations, copy.deepcopy(observations)))
    last: Any = None
    for number, actions in zip(range(3), subject.actions(env)):
        result = env.step(actions)
        if result[4] is last and "infos" not in told:
            told.add("infos")
            code = subject.lines(f"env.reset(seed={subject.seed})", "print(env.step(env.action_space.sample())[4] is env.step(env.action_space.sample())[4])   # False is expected")
            yield f"the infos of step {number} are the object that step {number - 1} returned", code
        last = result[4]
        for name, value in zip(("observations", "rewards", "terminations", "truncations"), result):
            kept.append((f"{name} of step {number}", value, copy.deepcopy(value)))
        kept.append((f"infos of step {number}", result[4], copy.deepcopy(result[4])))
        subject.begin_ended(env, np.logical_or(result[2], result[3]))
    for name, value, copied in kept:
        kind = name.split(" ")[0]
        if kind not in told and first_difference(copied, value, kind) is not None:
            told.add(kind)
            code = subject.lines(f"first, _ = env.reset(seed={subject.seed}); kept = copy.deepcopy(first)", "env.step(env.action_space.sample()); print(first, kept)   # equal is expected")
            yield f"the {name} change with the next step: {first_difference(copied, value, kind)}", code


def results_are_copies(subject: Subject) -> Iterator[Found]:
    trial, env = subject.trial, subject.env()
    observations, _ = env.reset(seed=subject.seed)
    _overwrite(observations)
    for number, step in enumerate(trial.steps[:FEW]):
        if step.ended.any():
            break
        result = env.step(copy.deepcopy(step.actions))
        found = first_difference(step.observations, result[0]) or first_difference(step.rewards, result[1], "rewards")
        if found is not None:
            yield f"what is written into results changes later ones: {found} in step {number}", subject.lines(f"observations, _ = env.reset(seed={subject.seed})", "observations[:] = 0; print(env.step(env.action_space.sample()))")
            return
        for value in result[:4]:
            _overwrite(value)


def _overwrite(value: Any) -> None:
    for _, array in leaves(value):
        if array.flags.writeable and array.dtype.kind in "fiub":
            array[...] = array.dtype.type(1)


def actions_stay(subject: Subject) -> Iterator[Found]:
    env = subject.env()
    env.reset(seed=subject.seed)
    for actions in (step.actions for step in subject.trial.steps[:1]):
        given, before = copy.deepcopy(actions), copy.deepcopy(actions)
        env.step(given)
        found = first_difference(before, given, "actions")
        if found is not None:
            yield f"step writes into its actions: {found}", subject.lines(f"env.reset(seed={subject.seed}); actions = env.action_space.sample(); print(actions)", "env.step(actions); print(actions)")


def rows_are_independent(subject: Subject) -> Iterator[Found]:
    trial = subject.trial
    # Also the first, whose actions an environment may give to all.
    for index in (subject.num_envs - 1, 0):
        env = subject.fresh()
        others = list(subject.actions(env))[::-1]
        changed = [replaced(env, step.actions, index, other) for step, other in zip(trial.steps, others)]
        again = subject.play(env, iter(changed))
        found = difference(subject, trial, again, [(i, i) for i in range(subject.num_envs) if i != index], len(again.steps))
        if found is not None:
            code = subject.lines(
                f"one, two = env.action_space.sample(), env.action_space.sample(); many = [one, one.copy()]; many[1][{index}] = two[{index}]",
                f"for actions in many: env.reset(seed={subject.seed}); print(np.delete(env.step(actions)[0], {index}, axis=0))   # equal is expected",
            )
            yield f"other actions of sub-environment {index} change another one: {found}", code
            return


def rows_do_not_depend_on_their_number(subject: Subject) -> Iterator[Found]:
    trial = subject.trial
    for i in range(subject.num_envs):
        env = subject.fresh(1)
        alone = [_only(subject, env, step.actions, i) for step in trial.steps]
        other = subject.play(env, iter(alone), seed=subject.seed + i)
        found = difference(subject, trial, other, [(i, 0)], len(other.steps))
        if found is not None:
            code = subject.lines(
                f"actions = env.action_space.sample(); print(env.reset(seed={subject.seed})[0][{i}], env.step(actions)[0][{i}])",
                f"one = {subject.source.replace('NUM', '1')}; print(one.reset(seed={subject.seed + i})[0][0], one.step(actions[{i}:{i + 1}])[0][0])   # equal is expected",
            )
            yield f"sub-environment {i} of {subject.num_envs} with the seed {subject.seed} is not that of one environment with the seed {subject.seed + i}: {found}", code
            return


def _only(subject: Subject, env: Any, actions: Any, index: int) -> Any:
    row = copy.deepcopy(rows(subject.first, "action", actions)[index])
    out: Any = create_empty_array(env.single_action_space, n=1, fn=np.zeros)
    return concatenate(env.single_action_space, [row], out)


def lists_of_seeds(subject: Subject) -> Iterator[Found]:
    seeds = [subject.seed + i for i in range(subject.num_envs)]
    code = subject.lines(f"print(env.reset(seed={subject.seed})[0])", f"print(env.reset(seed={seeds})[0])   # equal is expected")
    try:
        observations, _ = subject.env().reset(seed=seeds)  # type: ignore[arg-type]
    except Exception as error:
        yield f"reset takes no list of seeds: {type(error).__name__}: {error}", code
        return
    found = first_difference(subject.trial.observations, observations)
    if found is not None:
        yield f"seeds {seeds} are not those of the seed {subject.seed}: {found}", code


def closing(subject: Subject) -> Iterator[Found]:
    env = subject.fresh()
    env.reset(seed=subject.seed)
    env.close()
    env.close()
    if not env.closed:
        yield "closed is False after close()", subject.lines("env.close(); print(env.closed)")


#: Name, whether Gymnasium promises it, and the check.
CHECKS: tuple[tuple[str, bool, Callable[[Subject], Iterator[Found]]], ...] = (
    ("spaces", True, spaces),
    ("autoreset mode", True, autoreset_mode),
    ("results of reset", True, results_of_reset),
    ("samples of actions", True, samples_of_actions),
    ("results of step", True, results_of_step),
    ("finite rewards", True, finite_rewards),
    ("masks of infos", True, masks_of_infos),
    ("repetition by seed", True, seeds_repeat),
    ("different seeds", True, seeds_differ),
    ("results stay as they are", True, results_stay),
    ("results are copies", True, results_are_copies),
    ("actions stay as they are", True, actions_stay),
    ("independent sub-environments", True, rows_are_independent),
    *EPISODES,
    ("closing", True, closing),
    ("independence of num_envs", False, rows_do_not_depend_on_their_number),
    ("lists of seeds", False, lists_of_seeds),
)
