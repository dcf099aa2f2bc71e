"""Replay buffers: what is drawn is what was inserted."""

import numpy as np
import pytest

from libration import Environments, ReplayBuffer, System, Uniform
from libration.classic_control import AcrobotVectorEnv, CartPoleVectorEnv, MountainCarContinuousVectorEnv, MountainCarVectorEnv, PendulumVectorEnv
from libration.policies import Random


def filled(steps=50, rollouts=3, horizon=20, **more):
    envs = Environments("Oscillator", 8, max_episode_steps=7, dtype="float64")
    envs.reset(seed=1)
    buffer = ReplayBuffer(envs, steps, **more)
    all = []
    for _ in range(rollouts):
        rollout = envs.rollout(Random(-1.0, 1.0), horizon)
        buffer.insert(rollout)
        all.append([rollout.observations.copy(), rollout.rewards.copy(), rollout.transitions.copy()])
    return buffer, [np.concatenate(parts) for parts in zip(*all)]


def test_what_is_drawn_is_what_was_inserted_and_the_oldest_is_gone():
    buffer, (seen, rewards, transitions) = filled()
    drawn = buffer.sample(500)
    step, n = np.divmod(drawn.indices.astype(int), 8)
    assert step.min() >= 10 and step.max() < 60 and transitions[step, n].all()
    np.testing.assert_array_equal(drawn.observations, seen[step, n])
    np.testing.assert_array_equal(drawn.rewards, rewards[step, n])
    # Where an episode goes on, what is seen next is what the next step begins with.
    goes_on = ~(drawn.terminated | drawn.truncated) & (step < 59)
    np.testing.assert_array_equal(
        drawn.next_observations[goes_on], seen[step[goes_on] + 1, n[goes_on]]
    )
    assert len(buffer) == transitions[10:].sum() and drawn.truncated.any()
    np.testing.assert_array_equal(drawn.discounts, 0.99)


def test_a_draw_has_a_number_by_which_it_can_be_repeated():
    buffer, _ = filled()
    one, two = buffer.sample(64), buffer.sample(64)
    assert (one.indices != two.indices).any()
    buffer.number = 0
    np.testing.assert_array_equal(buffer.sample(64).indices, one.indices)


def test_what_ends_is_drawn_with_what_was_seen_last_and_nothing_counts_after_it():
    # Who is fast leaves so narrow a bound, and others are cut off.
    fast = {"bound": 1.2, "start_velocity": (-5.0, 5.0), "max_episode_steps": 15}
    envs = Environments("Oscillator", 8, dtype="float64", **fast)
    envs.reset(seed=2)
    buffer = ReplayBuffer(envs, 60)
    rollout = envs.rollout(Random(-4.0, 4.0), 60)
    buffer.insert(rollout)
    drawn = buffer.sample(2000, gamma=0.5)
    step, n = np.divmod(drawn.indices.astype(int), 8)
    for name in ("actions", "terminated", "truncated"):
        np.testing.assert_array_equal(getattr(drawn, name), getattr(rollout, name)[step, n])
    assert drawn.terminated.any() and drawn.truncated.any()
    np.testing.assert_array_equal(drawn.discounts, np.where(drawn.terminated, 0.0, 0.5))
    ends = rollout.episodes
    last = dict(zip(zip(ends["steps"], ends["environments"]), ends["final_observations"]))
    for i in np.flatnonzero(drawn.terminated | drawn.truncated):
        np.testing.assert_array_equal(drawn.next_observations[i], last[step[i], n[i]])


def test_rewards_look_ahead_as_far_as_they_are_told():
    buffer, (_, rewards, _) = filled()
    drawn = buffer.sample(200, steps=3, gamma=0.5)
    step, n = np.divmod(drawn.indices.astype(int), 8)
    whole = drawn.discounts == 0.5**3
    assert whole.any() and not whole.all()
    of = [rewards[np.minimum(step + k, 59), n] * 0.5**k for k in range(3)]
    # Three products and two sums, each of which rounds once.
    np.testing.assert_allclose(drawn.rewards[whole], sum(of)[whole], rtol=8 * np.finfo(float).eps)


def test_sequences_are_stretches_of_one_environment():
    buffer, (seen, _, _) = filled()
    drawn = buffer.sample_sequences(40, 5)
    step, n = np.divmod(drawn.indices.astype(int), 8)
    assert drawn.observations.shape == (40, 5, 2) and drawn.actions.shape == (40, 5, 1)
    for t in range(5):
        on = drawn.mask[:, t]
        np.testing.assert_array_equal(drawn.observations[on, t], seen[step[on] + t, n[on]])
    assert drawn.mask[:, 0].all() and not drawn.mask.all()


def test_what_has_a_priority_of_zero_is_never_drawn():
    buffer, _ = filled(priorities=True)
    everything = np.unique(buffer.sample(5000).indices)
    assert buffer.update_priorities(everything, np.arange(len(everything)) % 2) == len(everything)
    drawn = buffer.sample(2000, correction=0.5)
    assert set(drawn.indices) <= set(everything[1::2])
    assert drawn.weights.max() == 1.0


@pytest.mark.parametrize(
    "call, error, told",
    [
        (lambda b: b.sample(0), ValueError, "batch_size"),
        (lambda b: b.sample(4, gamma=1.5), ValueError, "discount"),
        (lambda b: b.sample(4, steps=0), ValueError, "steps"),
        (lambda b: b.sample(4, correction=0.5), ValueError, "priorities"),
        (lambda b: b.update_priorities([1], [1.0]), ValueError, "priorities"),
        (lambda b: b.sample_sequences(4, 60), ValueError, "to draw"),
        (lambda b: b.sample_sequences(2**32, 2**32), MemoryError, "memory"),
        (lambda b: b.sample_sequences(3, 2**32), MemoryError, "memory"),
        (lambda b: b.sample(2**32), MemoryError, "memory"),
        (lambda b: b.insert(3), TypeError, "rollout must be"),
        (lambda b: b.update_priorities([1.5], [1.0]), TypeError, "whole"),
        (lambda b: b.update_priorities([-1], [1.0]), ValueError, "those that were drawn"),
        (lambda b: b.update_priorities([[1]], [[1.0]]), ValueError, "shape"),
        (lambda b: ReplayBuffer(None, 3), TypeError, "environments must be"),
        (lambda b: ReplayBuffer(b, 3, prorities=True), TypeError, "did you mean 'priorities'"),
    ],
)
def test_what_cannot_be_drawn_is_refused_by_name(call, error, told):
    with pytest.raises(error, match=told):
        call(filled()[0])


def test_a_rollout_of_other_environments_is_refused():
    buffer, _ = filled()
    for other in (Environments("Oscillator", 4, dtype="float64"), Environments("Oscillator", 8)):
        other.reset(seed=0)
        with pytest.raises(ValueError):
            buffer.insert(other.rollout(Random(-1.0, 1.0), 5))
    with pytest.raises(ValueError, match="steps of a rollout"):
        envs = Environments("Oscillator", 8, dtype="float64")
        envs.reset(seed=0)
        buffer.insert(envs.rollout(Random(-1.0, 1.0), 51))


@pytest.mark.parametrize("twin", [CartPoleVectorEnv, PendulumVectorEnv, MountainCarVectorEnv, MountainCarContinuousVectorEnv])
def test_a_buffer_takes_rollouts_of_systems_by_equations(twin):
    envs = twin(8, max_episode_steps=10, autoreset_mode="SameStep")
    envs.reset(seed=0)
    rollout = envs.rollout(Random(-1.0, 1.0), 32)
    buffer = ReplayBuffer(envs, steps=40, priorities=True)
    buffer.insert(rollout)
    drawn = buffer.sample(2000)
    step, n = np.divmod(drawn.indices.astype(int), 8)
    for name in ("observations", "actions", "rewards", "terminated", "truncated"):
        np.testing.assert_array_equal(getattr(drawn, name), getattr(rollout, name)[step, n])
    ends = {(s, e): seen for s, e, seen in zip(rollout.episodes["steps"], rollout.episodes["environments"], rollout.episodes["final_observations"])}
    ended = np.flatnonzero(drawn.truncated | drawn.terminated)
    assert len(ended) > 100
    for k in ended:
        np.testing.assert_array_equal(drawn.next_observations[k], ends[step[k], n[k]])
    assert not drawn.discounts[drawn.terminated].any()
    assert buffer.sample_sequences(16, steps=4).observations.shape == (16, 4, len(envs.preset.seen))
    assert buffer.update_priorities(drawn.indices, np.abs(drawn.rewards)) > 0


@pytest.mark.parametrize(
    ("envs", "text"),
    [
        (lambda: AcrobotVectorEnv(2), "length 6 and actions of length 1"),
        (lambda: Environments(System(acceleration={"q": "u - p", "p": "w"}, inputs=["u", "w"]), 2, dt=0.1, reward="0"), "length 4 and actions of length 2"),
        (lambda: Environments(System(rate={"q": "u - q"}, inputs=["u"]), 2, dt=0.1, reward="0"), "length 1 and actions of length 1"),
    ],
)
def test_environments_for_which_there_is_no_buffer_are_refused_with_what_works(envs, text):
    with pytest.raises(ValueError, match=f"observations of {text}; expected lengths 2 to 4 and 1; help: observe="):
        ReplayBuffer(envs(), 10)


@pytest.mark.parametrize("given", [{"jitter": 0.1}, {"omega2": Uniform(10, 20)}, {"action_delay": 0.0333}])
def test_a_buffer_takes_rollouts_of_environments_with_noise_or_parameters_that_vary(given):
    envs = Environments("Pendulum", 8, max_episode_steps=10, autoreset_mode="SameStep", **given)
    envs.reset(seed=0)
    rollout = envs.rollout(Random(-1.0, 1.0), 32)
    buffer = ReplayBuffer(envs, steps=40)
    buffer.insert(rollout)
    drawn = buffer.sample(2000)
    step, n = np.divmod(drawn.indices.astype(int), 8)
    np.testing.assert_array_equal(drawn.observations, rollout.observations[step, n])
    np.testing.assert_array_equal(drawn.rewards, rollout.rewards[step, n])
    np.testing.assert_array_equal(drawn.truncated, rollout.truncated[step, n])
    ends = {(s, e): seen for s, e, seen in zip(rollout.episodes["steps"], rollout.episodes["environments"], rollout.episodes["final_observations"])}
    assert drawn.truncated.sum() > 100
    for k in np.flatnonzero(drawn.truncated)[:50]:
        np.testing.assert_array_equal(drawn.next_observations[k], ends[step[k], n[k]])
