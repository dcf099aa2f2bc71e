"""Audits of environments as they are given: through their wrappers, with the observations that ``step`` returns."""

from collections import deque

import gymnasium
import numpy as np
import pytest
from gymnasium import wrappers
from gymnasium.spaces import Box, Discrete

import libration
from libration import probe

# Pendulum-v1 upright: 3/(m l²) of the torque per second, by symplectic Euler in steps of 0.05 s.
B = np.array([[3 * 0.05**2], [3 * 0.05]])
# CartPole-v1 has a discrete action, MountainCar-v0 no attribute of its timestep.
IDS = {"Pendulum-v1": {}, "MountainCarContinuous-v0": {"dt": 1.0}, "CartPole-v1": {}, "Acrobot-v1": {}, "MountainCar-v0": {"dt": 1.0}}


class Late(gymnasium.Wrapper):
    """Actions are used ``steps`` steps later."""

    def __init__(self, env, steps=1):
        super().__init__(env)
        self.waiting, self.steps = deque(), steps

    def reset(self, **keywords):
        self.waiting = deque([self.idle] * self.steps)
        return self.env.reset(**keywords)

    @property
    def idle(self):
        space = self.env.action_space
        return 1 if isinstance(space, Discrete) else np.zeros(space.shape)

    def step(self, action):
        self.waiting.append(action)
        return self.env.step(self.waiting.popleft())


class Stale(gymnasium.Wrapper):
    """Observations are those of the step before."""

    def reset(self, **keywords):
        self.last, info = self.env.reset(**keywords)
        return self.last, info

    def step(self, action):
        shown = self.last
        self.last, *rest = self.env.step(action)
        return (shown, *rest)


class Scaled(gymnasium.ActionWrapper):
    """Half of each action."""

    def action(self, action):
        return 0.5 * action


class Sluggish(gymnasium.Wrapper):
    """Actions go through a filter whose state the environment does not show."""

    def reset(self, **keywords):
        self.held = np.zeros(self.env.action_space.shape)
        return self.env.reset(**keywords)

    def step(self, action):
        self.held = 0.8 * self.held + 0.2 * np.asarray(action)
        return self.env.step(self.held)


class Slider(gymnasium.Env):
    """A mass on a spring whose own step may use the action before, or observe the state before."""

    action_space = Box(-1, 1, (1,), np.float64)
    observation_space = Box(-9, 9, (2,), np.float64)

    def __init__(self, late=False, stale=False):
        self.late, self.stale, self.dt, self.state, self.held = late, stale, 0.05, None, [0.0]

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.state, self.held = np.zeros(2), [0.0]
        return self.state, {}

    def step(self, action):
        q, v = self.state
        before = np.array([q, v])
        used, self.held = (self.held[0] if self.late else float(action[0])), [float(action[0])]
        v = v + self.dt * (used - 4 * q - 0.2 * v)
        self.state = np.array([q + self.dt * v, v])
        return before if self.stale else self.state, 0.0, False, False, {}


def kinds(report):
    return [finding["kind"] for finding in report.findings]


def made(name):
    return gymnasium.make(name, disable_env_checker=True)


def audit(env, name):
    return probe.gymnasium(env, **IDS[name])


def test_scaled_actions_scale_the_effect_of_the_action():
    assert audit(made("Pendulum-v1"), "Pendulum-v1").B == pytest.approx(B, rel=1e-9)
    for wrapper in (
        Scaled(made("Pendulum-v1")),
        wrappers.TransformAction(made("Pendulum-v1"), lambda u: 0.5 * u, made("Pendulum-v1").action_space),
        # From ±4 to ±2 N m.
        wrappers.RescaleAction(made("Pendulum-v1"), np.float32(-4), np.float32(4)),
    ):
        report = audit(wrapper, "Pendulum-v1")
        assert report.B == pytest.approx(B / 2, rel=1e-6), wrapper
        assert report.verdict["outcome"] == "no-fault" and type(wrapper).__name__ in " ".join(report.notes)
    clipped = audit(wrappers.ClipAction(made("Pendulum-v1")), "Pendulum-v1")
    assert clipped.B == pytest.approx(B, rel=1e-6) and clipped.verdict["outcome"] == "no-fault"


def test_repeated_actions_are_one_longer_step():
    report = audit(wrappers.RepeatAction(made("Pendulum-v1"), 4), "Pendulum-v1")
    step = np.array([[1 + 15 * 0.05**2, 0.05], [15 * 0.05, 1.0]])
    assert report.results["dt"] == 0.2 and report.A == pytest.approx(np.linalg.matrix_power(step, 4), rel=1e-8)
    # ω² = 15 1/s², in the limit of small steps.
    assert report.modes[0]["flow"]["growth_rate"] == pytest.approx(15**0.5, rel=1e-6)


@pytest.mark.parametrize("name", ["Pendulum-v1", "MountainCarContinuous-v0"])
def test_late_and_sluggish_continuous_actions_are_found(name):
    for steps in (1, 2):
        report = audit(Late(made(name), steps), name)
        assert kinds(report)[0] == "late-command" and report.hidden_latency[0]["late_steps"] == steps
        assert report.verdict["outcome"] == "fault"
    assert "hidden-state" in kinds(audit(Sluggish(made(name)), name))


@pytest.mark.parametrize("name", ["CartPole-v1", "Acrobot-v1", "MountainCar-v0"])
def test_late_discrete_actions_are_found_and_those_in_time_are_said_to_be(name):
    for steps in (0, 1, 3):
        report = audit(Late(made(name), steps), name)
        (latency,) = report.hidden_latency
        assert (latency["input"], latency["late_steps"]) == ("discrete action", steps)
        assert ("late-command" in kinds(report)) == (steps > 0) and report.holds == (steps == 0), report.answer


@pytest.mark.parametrize("name", ["Pendulum-v1", "CartPole-v1"])
def test_sticky_actions_are_found(name):
    report = audit(wrappers.StickyAction(made(name), 0.25), name)
    assert {"irregular-delay", "late-command", "not-reproducible"} & set(kinds(report)) and not report.holds


@pytest.mark.parametrize("name", ["Pendulum-v1", "CartPole-v1"])
def test_old_observations_are_found(name):
    for env in (Stale(made(name)), wrappers.DelayObservation(made(name), 2)):
        report = audit(env, name)
        assert "stale-observation" in kinds(report) and not report.holds, report.answer


def test_observations_of_noise_and_of_running_means_are_found_or_named():
    draw = np.random.default_rng(1)
    noisy = wrappers.TransformObservation(made("Pendulum-v1"), lambda y: y + 0.01 * draw.normal(size=3), None)
    report = audit(noisy, "Pendulum-v1")
    assert kinds(report) == ["not-reproducible"] and "observations of the same state vary" in report.answer
    for wrapper, name in (
        (lambda env: wrappers.NormalizeObservation(env), "NormalizeObservation"),
        (lambda env: wrappers.FrameStackObservation(env, 3), "FrameStackObservation"),
        (lambda env: wrappers.TimeAwareObservation(env), "TimeAwareObservation"),
    ):
        report = audit(wrapper(Scaled(made("Pendulum-v1"))), "Pendulum-v1")
        assert report.B == pytest.approx(B / 2, rel=1e-9)
        assert f"1 wrapper ({name})" in report.verdict["not_examined"] and f"1 wrapper ({name})" in report.answer


def test_observations_that_are_functions_of_the_state_have_no_finding():
    for wrapper in (
        lambda env: wrappers.RescaleObservation(env, np.float32(-1), np.float32(1)),
        lambda env: wrappers.DtypeObservation(env, np.float64),
        lambda env: wrappers.TransformObservation(env, lambda y: y[:1], Box(-1, 1, (1,), np.float32)),
        lambda env: wrappers.FlattenObservation(wrappers.ReshapeObservation(env, (3, 1))),
    ):
        report = audit(wrapper(made("Pendulum-v1")), "Pendulum-v1")
        assert kinds(report) == [] and report.results["memory"]["observed"] == "asked"
    coarse = audit(wrappers.DiscretizeAction(made("Pendulum-v1"), 5), "Pendulum-v1")
    assert coarse.hidden_latency[0]["late_steps"] == 0.0


def test_wrappers_of_rewards_records_and_time_limits_do_not_matter():
    env = wrappers.RecordEpisodeStatistics(wrappers.TimeLimit(wrappers.ClipReward(made("Pendulum-v1"), -1, 1), 3))
    report = audit(wrappers.Autoreset(env), "Pendulum-v1")
    assert report.B == pytest.approx(B, rel=1e-9) and report.holds
    assert report.verdict["not_examined"] == ["rewards and ends of episodes"]


def test_a_memory_of_the_environment_itself_is_found():
    assert kinds(probe.gymnasium(Slider())) == []
    late = probe.gymnasium(Slider(late=True))
    assert kinds(late) == ["late-command"] and late.hidden_latency[0]["late_steps"] == 1.0
    # v' = v + dt u, q' = q + dt v'.
    assert late.B == pytest.approx(np.array([[0.05**2], [0.05]]), rel=1e-9)
    assert kinds(probe.gymnasium(Slider(stale=True))) == ["stale-observation"]


def test_an_attribute_in_place_of_a_discrete_action_has_no_lateness_of_its_own():
    for steps in (0, 1):
        report = probe.gymnasium(Late(made("CartPole-v1"), steps), 0.0, action_attribute="force_mag", state=[0.0] * 4)
        force, action = report.hidden_latency
        assert force["late_steps"] is None and action["late_steps"] == steps
        assert report.advise(libration.LQR(np.eye(4), np.eye(1))) is not None


def test_an_environment_without_a_timestep_has_one_only():
    report = audit(made("MountainCar-v0"), "MountainCar-v0")
    assert report.largest_dt is None and report.order is None
    assert "modes of the system and the longest stable step" in report.verdict["not_examined"]


def test_environments_whose_state_cannot_be_set_are_refused_with_the_reason():
    with pytest.raises(ValueError, match="state and time step are in the engine.*help: libration.analyze"):
        probe.gymnasium(libration.envs.PendulumEnv())
    with pytest.raises(TypeError, match="several environments; expected a single one"):
        probe.gymnasium(gymnasium.make_vec("CartPole-v1", 2))
