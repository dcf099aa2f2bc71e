"""Each fault that is planted into a correct vector environment is found by the check that is made for it, and by its name."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from libration.check_environments_match import check_environments_match
from libration.check_vector_env import check_vector_env, main


class Walk(VectorEnv):
    """Random walks that a command pushes: correct in all three modes of autoreset."""

    def __init__(self, num_envs: int, mode: AutoresetMode = AutoresetMode.NEXT_STEP) -> None:
        self.num_envs = num_envs
        self.metadata = {"autoreset_mode": mode}
        self.single_observation_space = Box(-np.inf, np.inf, (2,), np.float32)
        self.single_action_space = Box(-1.0, 1.0, (1,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.random = [np.random.default_rng() for _ in range(num_envs)]
        self.place = np.zeros((num_envs, 2), np.float32)
        self.age = np.zeros(num_envs, int)
        self.last = np.zeros(num_envs, int)
        self.is_due = np.zeros(num_envs, bool)

    def reset(self, *, seed: Any = None, options: Any = None) -> Any:
        if seed is not None:
            seeds = [seed + i for i in range(self.num_envs)] if isinstance(seed, int) else seed
            self.random = [np.random.default_rng(each) for each in seeds]
        for i in np.flatnonzero((options or {}).get("reset_mask", np.ones(self.num_envs, bool))):
            self.begin(i)
        return self.place.copy(), self.infos(np.ones(self.num_envs, bool))

    def begin(self, i: int) -> None:
        self.place[i] = self.random[i].uniform(-1.0, 1.0, 2)
        self.age[i], self.is_due[i] = 0, False
        self.last[i] = self.random[i].integers(5, 12)

    def move(self, i: int, action: np.ndarray) -> float:
        self.place[i] += [action[0], self.random[i].normal()]
        self.age[i] += 1
        return float(self.place[i, 0])

    def infos(self, mask: np.ndarray) -> dict[str, Any]:
        return {"age": self.age.copy(), "_age": mask}

    def step(self, actions: Any) -> Any:
        rewards, ended, infos = np.zeros(self.num_envs), np.zeros(self.num_envs, bool), {}
        for i in range(self.num_envs):
            if self.is_due[i] and self.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP:
                self.begin(i)
                continue
            rewards[i] = self.move(i, actions[i])
            ended[i] = self.age[i] >= self.last[i]
        self.is_due = ended.copy()
        if ended.any() and self.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP:
            infos["final_obs"] = np.full(self.num_envs, None, object)
            for i in np.flatnonzero(ended):
                infos["final_obs"][i] = self.place[i].copy()
            infos["_final_obs"], infos["_final_info"] = ended.copy(), ended.copy()
            infos["final_info"] = {"age": self.age.copy(), "_age": ended.copy()}
            for i in np.flatnonzero(ended):
                self.begin(i)
        infos |= self.infos(np.ones(self.num_envs, bool))
        return self.place.copy(), rewards, ended, np.zeros(self.num_envs, bool), infos


class WithoutMode(Walk):
    def __init__(self, num_envs: int) -> None:
        super().__init__(num_envs)
        self.metadata = {**self.metadata}
        self.metadata["autoreset_mode"] = "next_step"

    def step(self, actions: Any) -> Any:
        self.metadata["autoreset_mode"] = AutoresetMode.NEXT_STEP
        return super().step(actions)


class WiderSpace(Walk):
    def __init__(self, num_envs: int) -> None:
        super().__init__(num_envs)
        self.observation_space = Box(-np.inf, np.inf, (num_envs, 3), np.float32)


class DoubleStart(Walk):
    def reset(self, **given: Any) -> Any:
        observations, infos = super().reset(**given)
        return observations.astype(float), infos


class RewardsAsList(Walk):
    def step(self, actions: Any) -> Any:
        observations, rewards, *rest = super().step(actions)
        return observations, list(rewards), *rest


class WithoutMasks(Walk):
    def infos(self, mask: np.ndarray) -> dict[str, Any]:
        return {"age": self.age.copy()}


class Unseeded(Walk):
    def move(self, i: int, action: np.ndarray) -> float:
        reward = super().move(i, action)
        self.place[i, 1] += np.random.normal()
        return reward


class StaleReset(Walk):
    """A reset does not clear that an autoreset is due."""

    def reset(self, **given: Any) -> Any:
        due = self.is_due.copy()
        result = super().reset(**given)
        self.is_due = due
        return result


class OneStart(Walk):
    def reset(self, *, seed: Any = None, options: Any = None) -> Any:
        return super().reset(seed=[seed] * self.num_envs if isinstance(seed, int) else seed, options=options)


class SeededForever(Walk):
    seed = 0

    def reset(self, *, seed: Any = None, options: Any = None) -> Any:
        self.seed = self.seed if seed is None else seed
        return super().reset(seed=self.seed, options=options)


class Aliased(Walk):
    def step(self, actions: Any) -> Any:
        _, *rest = super().step(actions)
        return self.place, *rest

    def reset(self, **given: Any) -> Any:
        return self.place, super().reset(**given)[1]


class WritesIntoActions(Walk):
    def step(self, actions: Any) -> Any:
        result = super().step(actions)
        actions *= 0.5
        return result


class Coupled(Walk):
    def step(self, actions: Any) -> Any:
        return super().step(actions - actions.mean(axis=0))


class RewardedReset(Walk):
    def step(self, actions: Any) -> Any:
        due = self.is_due.copy()
        observations, rewards, *rest = super().step(actions)
        return observations, np.where(due, 1.0, rewards), *rest


class StartsWithAction(Walk):
    def step(self, actions: Any) -> Any:
        due = self.is_due.copy()
        observations, *rest = super().step(actions)
        self.place[due] += actions[due]
        return self.place.copy(), *rest


class StaysOpen(Walk):
    def close(self, **given: Any) -> None:
        pass


class WithoutFinalObservation(Walk):
    def __init__(self, num_envs: int) -> None:
        super().__init__(num_envs, AutoresetMode.SAME_STEP)

    def step(self, actions: Any) -> Any:
        *rest, infos = super().step(actions)
        return *rest, {key: value for key, value in infos.items() if "final_obs" not in key}


class LastOfOldEpisode(Walk):
    def __init__(self, num_envs: int) -> None:
        super().__init__(num_envs, AutoresetMode.SAME_STEP)

    def step(self, actions: Any) -> Any:
        observations, *rest, infos = super().step(actions)
        for i in np.flatnonzero(infos.get("_final_obs", [])):
            observations[i] = infos["final_obs"][i]
        return observations, *rest, infos


class ResetsAll(Walk):
    def __init__(self, num_envs: int) -> None:
        super().__init__(num_envs, AutoresetMode.DISABLED)

    def reset(self, *, seed: Any = None, options: Any = None) -> Any:
        return super().reset(seed=seed)


class TakesOptions(Walk):
    def __init__(self, num_envs: int) -> None:
        super().__init__(num_envs, AutoresetMode.DISABLED)

    def reset(self, *, seed: Any = None, options: Any = None) -> Any:
        mine = copy.copy(options)
        (options or {}).pop("reset_mask", None)
        return super().reset(seed=seed, options=mine)


class CountsRows(Walk):
    def move(self, i: int, action: np.ndarray) -> float:
        return super().move(i, action * self.num_envs)


class OneSeedOnly(Walk):
    def reset(self, *, seed: Any = None, options: Any = None) -> Any:
        if isinstance(seed, list):
            raise TypeError("seed must be an integer")
        return super().reset(seed=seed, options=options)


class FollowsTheFirst(Walk):
    """Every sub-environment takes the action of the first."""

    def step(self, actions: Any) -> Any:
        return super().step(np.full_like(actions, actions[0]))


class PaysNothingKnown(Walk):
    def move(self, i: int, action: np.ndarray) -> float:
        return float("nan") if i == 1 else super().move(i, action)


class OneDictionary(Walk):
    """Each step clears and fills the same infos."""

    def step(self, actions: Any) -> Any:
        *results, infos = super().step(actions)
        self.told = vars(self).get("told", {})
        self.told.clear()
        self.told.update(infos)
        return *results, self.told


FAULTS = {
    FollowsTheFirst: "independent sub-environments",
    PaysNothingKnown: "finite rewards",
    OneDictionary: "results stay as they are",
    WithoutMode: "autoreset mode",
    WiderSpace: "spaces",
    DoubleStart: "results of reset",
    RewardsAsList: "results of step",
    WithoutMasks: "masks of infos",
    Unseeded: "repetition by seed",
    StaleReset: "repetition by seed",
    OneStart: "different seeds",
    SeededForever: "different seeds",
    Aliased: "results stay as they are",
    WritesIntoActions: "actions stay as they are",
    Coupled: "independent sub-environments",
    RewardedReset: "autoreset in the next step",
    StartsWithAction: "autoreset in the next step",
    StaysOpen: "closing",
    WithoutFinalObservation: "autoreset in the same step",
    LastOfOldEpisode: "autoreset in the same step",
    ResetsAll: "partial resets",
    TakesOptions: "partial resets",
}


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_a_correct_environment_has_neither_breaches_nor_remarks(mode: AutoresetMode) -> None:
    report = check_vector_env(lambda n: Walk(n, mode))
    assert report.is_correct and not report.remarks, str(report)
    assert len(report.passed) == 17 and len(report.not_checked) == 2, str(report)


@pytest.mark.parametrize("faulty", list(FAULTS))
def test_a_planted_fault_is_found_by_its_check(faulty: type[Walk]) -> None:
    report = check_vector_env(faulty)
    assert FAULTS[faulty] in {breach.check for breach in report.breaches}, str(report)
    breach = next(breach for breach in report.breaches if breach.check == FAULTS[faulty])
    assert breach.sentence and 2 <= len(breach.lines) <= 3, breach


@pytest.mark.parametrize(("faulty", "check"), [(CountsRows, "independence of num_envs"), (OneSeedOnly, "lists of seeds")])
def test_what_gymnasium_does_not_promise_is_a_remark(faulty: type[Walk], check: str) -> None:
    report = check_vector_env(faulty)
    assert report.is_correct and [remark.check for remark in report.remarks] == [check], str(report)


@pytest.mark.parametrize("faulty", [Coupled, FollowsTheFirst, CountsRows])
def test_the_lines_of_a_finding_about_rows_run_and_show_two_different_results(faulty: type[Walk], capsys: pytest.CaptureFixture[str]) -> None:
    report = check_vector_env(faulty, source="made(NUM)")
    (found,) = [each for each in (*report.breaches, *report.remarks) if each.check.startswith("independen")][:1]

    def printed(made: Any) -> list[str]:
        exec("\n".join(found.lines), {"made": made, "gymnasium": gymnasium, "np": np, "copy": copy})
        return capsys.readouterr().out.replace("]\n [", "], [").strip().split("\n")

    one, two = printed(faulty)
    assert one != two
    # What is correct prints the same twice.
    one, two = printed(Walk)
    assert one == two


def test_an_environment_that_cannot_be_closed_is_told_with_what_else_is_found():
    class Open(gymnasium.vector.SyncVectorEnv):
        def close(self, **kwargs):
            raise RuntimeError("no")

        def __del__(self):
            """That of Gymnasium closes it once more."""

    report = check_vector_env(lambda n: Open([lambda: gymnasium.make("CartPole-v1")] * n))
    assert [breach.check for breach in report.breaches] == ["closing"] and "it raises RuntimeError: no" in str(report)


def test_lines_have_the_functions_that_were_given() -> None:
    report = check_vector_env(lambda n: RewardsAsList(n), sample=lambda env, random: np.full((env.num_envs, 1), random.uniform(), np.float32))
    (found,) = [breach for breach in report.breaches if breach.check == "results of step"]
    assert found.lines[0] == "env = make(3)" and "env.step(sample(env, random))" in found.lines[1]


def test_what_is_written_into_a_result_does_not_change_the_environment() -> None:
    report = check_vector_env(Aliased)
    assert "results are copies" in {breach.check for breach in report.breaches}, str(report)


@pytest.mark.parametrize("seed", range(4))
def test_episodes_of_one_step_are_no_breach(seed: int) -> None:
    def make(num_envs: int) -> VectorEnv:
        return gymnasium.make_vec("Blackjack-v1", num_envs, vectorization_mode="sync", vector_kwargs={"autoreset_mode": AutoresetMode.DISABLED})

    # Of Gymnasium: it takes `reset_mask` out of the options of its caller.
    found = [breach.sentence for breach in check_vector_env(make, seed=seed).breaches]
    assert all(sentence.startswith("reset changes its options") for sentence in found), found


def test_a_given_environment_without_spec_is_checked_as_far_as_one_environment_goes() -> None:
    report = check_vector_env(Walk(4))
    assert report.is_correct and "independence of num_envs" in dict(report.not_checked), str(report)


def test_the_environments_of_the_package_keep_the_contract() -> None:
    for mode in ("NextStep", "SameStep", "Disabled"):
        for id in ("libration/Oscillator-v0", "libration/PendulumSwingUp-v0"):
            report = check_vector_env(lambda n: gymnasium.make_vec(id, n, autoreset_mode=mode, max_episode_steps=20))
            assert report.is_correct and not report.remarks, str(report)


def test_the_command_has_exit_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["libration/PendulumSwingUp-v0", "--max-steps", "250"]) == 0
    assert main(["CartPole-v1", "--vectorization-mode", "sync", "--autoreset-mode", "next-step"]) == 0
    # Of Gymnasium: `SyncVectorEnv.reset` takes `reset_mask` out of the options of its caller.
    assert main(["CartPole-v1", "--vectorization-mode", "sync", "--autoreset-mode", "disabled"]) == 1
    assert "reset changes its options" in capsys.readouterr().out
    assert main(["Nope-v1"]) == 2
    assert main(["CartPole-v1", "--num-envs", "1"]) == 2
    assert "num_envs is 1, but it must be at least 2" in capsys.readouterr().err


def test_an_id_may_have_the_prefix_of_the_registry_or_of_a_module(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = ["--vectorization-mode", "sync", "--autoreset-mode", "next-step", "--max-steps", "30"]
    plain, prefixed = (capsys.readouterr().out for id in ("CartPole-v1", "gym:CartPole-v1") if main([id, *options]) == 0)
    assert plain == prefixed
    assert check_vector_env("gym:libration/CartPole-v1", max_steps=30).is_correct
    text = "import gymnasium\ngymnasium.register('Pole-v0', entry_point='libration.classic_control:CartPoleEnv')\n"
    (tmp_path / "registers_pole.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    for id in ("registers_pole:Pole-v0", "gym:registers_pole:Pole-v0"):
        assert main([id, *options]) == 0
    assert main(["gym:Nope-v1"]) == 2 and main(["nope:Pole-v0"]) == 2
    assert check_environments_match("gym:CartPole-v1", "CartPole-v1", steps=10)


@pytest.mark.parametrize(
    ("given", "error", "told"),
    [
        ({"env": 3}, TypeError, "env is 3"),
        ({"env": Walk, "num_envs": True}, TypeError, "num_envs is True"),
        ({"env": Walk, "max_steps": 0}, ValueError, "max_steps is 0"),
        ({"env": Walk, "seed": -1}, ValueError, "seed is -1"),
        ({"env": lambda n: n}, TypeError, "env makes a int"),
    ],
)
def test_wrong_arguments_are_named(given: dict[str, Any], error: type[Exception], told: str) -> None:
    with pytest.raises(error, match=told):
        check_vector_env(**given)
