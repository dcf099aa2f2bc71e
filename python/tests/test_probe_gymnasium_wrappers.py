"""Audits of environments as they are given: through their wrappers, with the observations that ``step`` returns."""

from collections import deque

import gymnasium
import numpy as np
import pytest
from gymnasium import wrappers
from gymnasium.spaces import Box, Discrete

import libration
from libration import probe

# Those without an attribute of their timestep.
TIMESTEPS = {"MountainCarContinuous-v0": 1.0, "MountainCar-v0": 1.0}


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


class Flaky(gymnasium.Wrapper):
    """Observations are those of the step before with a probability, or in each n-th step."""

    def __init__(self, env, probability=0.0, every=0):
        super().__init__(env)
        self.probability, self.every, self.calls = probability, every, 0
        self.draw = np.random.default_rng(1)

    def reset(self, **keywords):
        self.last, info = self.env.reset(**keywords)
        return self.last, info

    def step(self, action):
        before = self.last
        self.last, *rest = self.env.step(action)
        self.calls += 1
        is_old = self.draw.random() < self.probability or (self.every and self.calls % self.every == 0)
        return (before if is_old else self.last, *rest)


class Replacing(gymnasium.Wrapper):
    """Few actions, or observations, are others."""

    def __init__(self, env, probability, of):
        super().__init__(env)
        self.probability, self.of = probability, of
        self.draw = np.random.default_rng(3)

    def step(self, action):
        is_other = self.draw.random() < self.probability
        if is_other and self.of == "action":
            space = self.env.action_space
            action = (int(action) + 1) % int(space.n) if isinstance(space, Discrete) else self.draw.uniform(-1, 1, space.shape)
        observation, *rest = self.env.step(action)
        return (observation + 0.1 if is_other and self.of == "observation" else observation, *rest)


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


class Repeated(gymnasium.Wrapper):
    """Each action acts for several steps, as by ``RepeatAction`` of newer releases of Gymnasium."""

    def __init__(self, env, count):
        super().__init__(env)
        self.count = count

    def step(self, action):
        for _ in range(self.count):
            result = self.env.step(action)
        return result


class Slider(gymnasium.Env):
    """A mass on a spring, v' = v + dt (u - 4 q - v/5) and q' = q + dt v', which may use the action before, or observe the state before."""

    action_space = Box(-1, 1, (1,), np.float64)
    observation_space = Box(-9, 9, (2,), np.float64)
    dt = 0.05

    def __init__(self, late=False, stale=False):
        self.late, self.stale, self.state, self.held = late, stale, None, [0.0]

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.state, self.held = np.zeros(2), [0.0]
        return self.state, {}

    def step(self, action):
        q, v = before = self.state
        used, self.held = (self.held[0] if self.late else float(action[0])), [float(action[0])]
        v = v + self.dt * (used - 4 * q - 0.2 * v)
        self.state = np.array([q + self.dt * v, v])
        return before if self.stale else self.state, 0.0, False, False, {}


A, B = np.array([[1 - 4 * 0.05**2, 0.05 * 0.99], [-4 * 0.05, 0.99]]), np.array([[0.05**2], [0.05]])


def kinds(report):
    return [finding["kind"] for finding in report.findings]


def made(name):
    return gymnasium.make(name, disable_env_checker=True)


def audit(name, *wrapped):
    """The audit of an environment by its name in wrappers, each a function or a class."""
    env = Slider() if name == "Slider" else made(name)
    for wrapper in wrapped:
        env = wrapper(env)
    return probe.gymnasium(env, dt=TIMESTEPS.get(name))


def late_by(steps):
    return lambda env: Late(env, steps)


@pytest.mark.parametrize(
    "wrapper",
    [
        Scaled,
        lambda env: wrappers.TransformAction(env, lambda u: 0.5 * u, env.action_space),
        # From ±2 to ±1.
        lambda env: wrappers.RescaleAction(env, np.float64(-2), np.float64(2)),
        lambda env: Scaled(wrappers.ClipAction(env)),
    ],
)
def test_scaled_actions_scale_the_effect_of_the_action(wrapper):
    report = audit("Slider", wrapper)
    assert report.A == pytest.approx(A, abs=1e-9) and report.B == pytest.approx(B / 2, rel=1e-9)
    assert report.findings == [] and report.verdict["outcome"] == "no-fault"
    assert "actions and observations go through" in " ".join(report.notes)


def test_half_of_the_torque_of_a_pendulum_has_half_of_its_effect():
    # 3/(m l²) of the torque per second, by symplectic Euler in steps of 0.05 s.
    report = audit("Pendulum-v1", Scaled)
    assert report.B == pytest.approx(np.array([[0.0075], [0.15]]) / 2, rel=1e-9) and report.holds


def test_repeated_actions_are_one_longer_step_and_leave_the_system_as_it_is():
    repeated = getattr(wrappers, "RepeatAction", Repeated)
    report = audit("Slider", lambda env: repeated(env, 4))
    assert report.results["dt"] == 0.2 and report.A == pytest.approx(np.linalg.matrix_power(A, 4), abs=1e-9)
    flow = np.reshape(report.results["flow"]["a"], (2, 2))
    assert flow == pytest.approx(np.array([[0.0, 1.0], [-4.0, -0.2]]), abs=1e-7)


@pytest.mark.any_gymnasium
def test_late_and_sluggish_continuous_actions_are_found():
    report = audit("Slider", late_by(2))
    assert kinds(report) == ["late-command"] and report.hidden_latency[0]["late_steps"] == 2.0
    assert report.verdict["outcome"] == "fault" and report.B == pytest.approx(B, rel=1e-9)
    assert kinds(audit("Slider", Sluggish)) == ["hidden-state"]


@pytest.mark.parametrize(("name", "steps"), [("CartPole-v1", 0), ("CartPole-v1", 1), ("MountainCar-v0", 3)])
def test_late_discrete_actions_are_found_and_those_in_time_are_said_to_be(name, steps):
    report = audit(name, late_by(steps))
    (latency,) = report.hidden_latency
    assert (latency["input"], latency["late_steps"]) == ("discrete action", steps)
    assert ("late-command" in kinds(report)) == (steps > 0) and report.holds == (steps == 0), report.answer


@pytest.mark.parametrize("name", ["Slider", "CartPole-v1"])
def test_sticky_actions_are_found(name):
    report = audit(name, lambda env: wrappers.StickyAction(env, 0.25))
    assert {"irregular-delay", "late-command", "not-reproducible"} & set(kinds(report)) and not report.holds


@pytest.mark.parametrize("name", ["Slider", "CartPole-v1"])
@pytest.mark.parametrize(("wrapper", "steps"), [(Stale, 1), (lambda env: wrappers.DelayObservation(env, 2), 2)])
def test_old_observations_are_found(name, wrapper, steps):
    report = audit(name, wrapper)
    assert "stale-observation" in kinds(report) and not report.holds, report.answer
    assert report.results["memory"]["observation"]["mean"] == steps


@pytest.mark.any_gymnasium
@pytest.mark.parametrize("name", ["Slider", "Pendulum-v1", "CartPole-v1"])
@pytest.mark.parametrize("flaky", [{"probability": 0.2}, {"every": 5}])
def test_observations_that_are_old_now_and_then_are_found(name, flaky):
    report = audit(name, lambda env: Flaky(env, **flaky))
    (finding,) = (one for one in report.findings if one["kind"] == "stale-observation")
    assert "changes from step to step" in finding["text"] or "show in no observation" in finding["text"]
    assert report.verdict["outcome"] == "fault" and not report.holds


@pytest.mark.any_gymnasium
@pytest.mark.parametrize("name", ["Slider", "Pendulum-v1", "CartPole-v1"])
@pytest.mark.parametrize("of", ["action", "observation"])
@pytest.mark.parametrize("probability", [0.001, 0.01])
def test_results_that_a_wrapper_replaces_now_and_then_are_not_called_late(name, of, probability):
    report = audit(name, lambda env: Replacing(env, probability, of))
    assert kinds(report) == ["not-reproducible"] and "have no cause in this call or those before" in report.answer
    assert report.verdict["outcome"] == "fault" and all(not one["late_steps"] for one in report.hidden_latency)


@pytest.mark.parametrize("limited", [lambda y: np.clip(y, -0.03, 0.03), lambda y: np.clip(y, -0.003, 0.003), np.sign])
def test_observations_at_their_limits_are_not_old(limited):
    report = audit("Pendulum-v1", lambda env: wrappers.TransformObservation(env, limited, env.observation_space))
    assert kinds(report) == [] and report.results["memory"]["observed"] == "asked"


def test_observations_with_noise_are_found():
    draw = np.random.default_rng(1)
    report = audit("Slider", lambda env: wrappers.TransformObservation(env, lambda y: y + 0.01 * draw.normal(size=2), None))
    assert kinds(report) == ["not-reproducible"] and "observations of the same state vary" in report.answer


@pytest.mark.parametrize(
    ("wrapper", "name"),
    [
        (wrappers.NormalizeObservation, "NormalizeObservation"),
        (lambda env: wrappers.FrameStackObservation(env, 3), "FrameStackObservation"),
        (lambda env: wrappers.TimeAwareObservation(wrappers.TimeLimit(env, 9)), "TimeAwareObservation"),
    ],
)
def test_wrappers_whose_observations_are_no_function_of_the_state_are_named(wrapper, name):
    report = audit("Slider", Scaled, wrapper)
    assert report.B == pytest.approx(B / 2, rel=1e-9)
    assert f"1 wrapper ({name})" in report.verdict["not_examined"] and f"1 wrapper ({name})" in report.answer


def test_observations_that_are_functions_of_the_state_have_no_finding():
    for wrapper in (
        lambda env: wrappers.RescaleObservation(env, np.float64(-1), np.float64(1)),
        lambda env: wrappers.TransformObservation(env, lambda y: np.sin(y[:1]), Box(-1, 1, (1,), np.float64)),
        lambda env: wrappers.FlattenObservation(wrappers.ReshapeObservation(env, (2, 1))),
    ):
        report = audit("Slider", wrapper)
        assert kinds(report) == [] and report.results["memory"]["observed"] == "asked"


def test_a_discretised_action_is_in_time():
    report = audit("Slider", lambda env: wrappers.DiscretizeAction(env, 5))
    assert report.hidden_latency[0]["late_steps"] == 0.0 and report.B.shape == (2, 0)


def test_wrappers_of_rewards_records_and_time_limits_do_not_matter():
    def many(env):
        env = wrappers.RecordEpisodeStatistics(wrappers.TimeLimit(wrappers.ClipReward(env, -1, 1), 3))
        return wrappers.Autoreset(env)

    report = audit("Slider", many)
    assert report.B == pytest.approx(B, rel=1e-9) and report.holds
    assert report.verdict["not_examined"] == [
        "rewards and ends of episodes",
        "delays of fewer than one in 16 steps",
        "a memory that acts after more than 512 steps",
    ]


@pytest.mark.any_gymnasium
def test_a_memory_of_the_environment_itself_is_found():
    assert kinds(audit("Slider")) == []
    late = probe.gymnasium(Slider(late=True))
    assert kinds(late) == ["late-command"] and late.hidden_latency[0]["late_steps"] == 1.0
    assert late.B == pytest.approx(B, rel=1e-9)
    assert kinds(probe.gymnasium(Slider(stale=True))) == ["stale-observation"]


class Filtered(Slider):
    """The same mass, whose action goes through a filter with a gain of 1; its memory is a number or an array."""

    def __init__(self, part, as_array=False):
        super().__init__()
        self.part, self.filtered = part, np.zeros(1) if as_array else 0.0

    def step(self, action):
        self.filtered = self.filtered + self.part * ((action if isinstance(self.filtered, np.ndarray) else float(action[0])) - self.filtered)
        return super().step(np.atleast_1d(self.filtered))


@pytest.mark.any_gymnasium
# Each kind of memory with each part, at rest or at an action.
@pytest.mark.parametrize("part", [0.02, 0.1, 0.5, 0.9])
@pytest.mark.parametrize(("as_array", "action"), [(False, None), (True, [0.3])])
def test_a_filter_of_the_environment_itself_is_found_though_it_forgets_slowly(part, as_array, action):
    # It takes 36/part calls until a filter has forgotten an action to all digits.
    report = probe.gymnasium(Filtered(part, as_array), action)
    assert report.verdict["outcome"] == "fault"
    if "late-command" in kinds(report):
        # The mean age of the actions in the filter.
        assert report.hidden_latency[0]["late_steps"] == pytest.approx((1 - part) / part, rel=1e-6)
    else:
        assert {"hidden-state", "not-reproducible"} & set(kinds(report))


class Worn(Slider):
    """The same mass with a counter of its own: its damping falls, its spring stiffens, or its action ends."""

    def __init__(self, what):
        super().__init__()
        self.what, self.count, self.used = what, 0, 0.0

    def step(self, action):
        self.count, self.used = self.count + 1, self.used + abs(float(action[0]))
        result = super().step(np.zeros(1) if self.what == "action" and self.count > 60 else action)
        before = {"damping": self.state[1] * self.count, "use": self.state[1] * self.used, "spring": -self.state[0] * self.count}
        self.state = self.state + np.array([0.0, 1e-3 * before.get(self.what, 0.0)])
        return (self.state, *result[1:])


@pytest.mark.any_gymnasium
@pytest.mark.parametrize("what", ["damping", "spring", "use", "action"])
def test_a_counter_of_the_environment_itself_is_never_no_fault(what):
    report = probe.gymnasium(Worn(what))
    assert report.verdict["outcome"] in ("fault", "unknown"), report.answer
    assert probe.gymnasium(Worn("nothing")).verdict["outcome"] == "no-fault"


class Queued(Slider):
    """The same mass with a queue of late actions, which a reset fills."""

    def __init__(self, steps):
        super().__init__()
        self.steps, self.state, self.queue = steps, np.zeros(2), []

    def reset(self, *, seed=None, options=None):
        self.queue = [np.zeros(1)] * self.steps
        return super().reset(seed=seed)

    def step(self, action):
        self.queue.append(action)
        return super().step(self.queue.pop(0))


@pytest.mark.any_gymnasium
@pytest.mark.parametrize(("steps", "is_reset"), [(1, True), (3, False)])
def test_a_queue_that_a_reset_fills_is_found_before_a_reset_too(steps, is_reset):
    env = Queued(steps)
    env.state = np.array([0.01, 0.0])
    if is_reset:
        env.reset(seed=0)
    report = probe.gymnasium(env)
    assert "late-command" in kinds(report) and report.hidden_latency[0]["late_steps"] == steps
    # The point is that of the environment, and the environment stays as it is.
    assert report.results["state"] == list(env.state) and len(env.queue) == (steps if is_reset else 0)


def test_an_attribute_in_place_of_a_discrete_action_is_as_late_as_the_action():
    report = probe.gymnasium(Late(made("CartPole-v1"), 1), 0.0, action_attribute="force_mag", state=[0.0] * 4)
    force, action = report.hidden_latency
    assert force["late_steps"] is None and action["late_steps"] == 1.0
    advice = report.advise(libration.LQR(np.eye(4), np.eye(1)))
    assert '"latency" = [0.02]' in advice.request


def test_an_environment_without_a_timestep_has_one_only():
    report = audit("MountainCar-v0")
    assert report.largest_dt is None and report.order is None
    assert "modes of the system and the longest stable step" in report.verdict["not_examined"]


def test_environments_whose_state_cannot_be_set_are_refused_with_the_reason():
    with pytest.raises(ValueError, match="state and time step are in the engine.*help: libration.analyze"):
        probe.gymnasium(libration.envs.PendulumEnv())
    with pytest.raises(TypeError, match="several environments; expected a single one"):
        probe.gymnasium(gymnasium.make_vec("CartPole-v1", 2))
