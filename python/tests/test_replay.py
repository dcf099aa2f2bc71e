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
        (lambda b: b.sample(4, gamma=1.5), ValueError, "gamma is"),
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


PUSHED = System(acceleration={"q": "u - q", "p": "w - 2*p"}, inputs=["u", "w"])
WIDE = {
    "acrobot": (lambda **given: AcrobotVectorEnv(5, **given), 6, 1),
    "two actions": (lambda **given: Environments(PUSHED, 5, dt=0.1, reward="-q^2 - p^2", terminated=["abs(q) > 0.2"], **given), 4, 2),
    "orbit": (lambda **given: Environments(System("kepler"), 5, dt=0.02, reward="-x^2", start={"x": 1.0, "y'": 1.0}, **given), 4, 2),
    "chunk": (lambda **given: Environments(PUSHED, 5, dt=0.1, reward="-q^2", chunk=(3, 2), **given), 4, 6),
    "one number": (lambda **given: Environments(System(rate={"q": "u - q"}, inputs=["u"]), 5, dt=0.1, reward="-q^2", **given), 1, 1),
    "compiled": (lambda **given: Environments("Oscillator", 5, **given), 2, 1),
}


def rollouts(kind, dtype, count=3, horizon=16):
    """Return environments, a buffer that has kept 40 of their 48 steps, and the arrays of all rollouts."""
    make, observed, acted = WIDE[kind]
    envs = make(dtype=dtype, max_episode_steps=9, autoreset_mode="SameStep")
    envs.reset(seed=3)
    buffer = ReplayBuffer(envs, steps=40)
    every, ends = [], {}
    for part in range(count):
        rollout = envs.rollout(Random(-2.0, 2.0), horizon)
        buffer.insert(rollout)
        assert rollout.observations.shape[2:] == (observed,) and rollout.actions.shape[2:] == (acted,)
        names = ("observations", "actions", "rewards", "terminated", "truncated")
        every.append({name: getattr(rollout, name).copy() for name in names})
        episodes = rollout.episodes
        for step, n, last in zip(episodes["steps"], episodes["environments"], episodes["final_observations"]):
            ends[part * horizon + int(step), int(n)] = last
        after = np.array(rollout.last_observations)
    arrays = {name: np.concatenate([part[name] for part in every]) for name in every[0]}
    arrays["observations"] = np.concatenate([arrays["observations"], after[None]])
    return envs, buffer, arrays, ends


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("kind", WIDE)
def test_samples_of_any_width_are_the_arrays_of_the_rollouts(kind, dtype):
    envs, buffer, arrays, ends = rollouts(kind, dtype)
    drawn = buffer.sample(3000)
    step, n = np.divmod(drawn.indices.astype(int), 5)
    assert step.min() == 8 and step.max() == 47
    for name in ("observations", "actions", "rewards", "terminated", "truncated"):
        found = getattr(drawn, name)
        assert found.dtype == arrays[name].dtype and found.shape == (3000, *arrays[name].shape[2:])
        np.testing.assert_array_equal(found, arrays[name][step, n])
    expected = arrays["observations"][step + 1, n]
    ended = drawn.terminated | drawn.truncated
    assert ended.any() and not ended.all() and drawn.terminated.any() == (kind == "two actions")
    for k in np.flatnonzero(ended):
        expected[k] = ends[step[k], n[k]]
    np.testing.assert_array_equal(drawn.next_observations, expected)
    assert drawn.observations.dtype == dtype


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("kind", WIDE)
def test_returns_of_several_steps_are_sums_of_rewards_up_to_the_end_of_the_episode(kind, dtype):
    _, buffer, arrays, ends = rollouts(kind, dtype)
    steps, gamma = 4, 0.75
    drawn = buffer.sample(1000, steps=steps, gamma=gamma)
    ended = arrays["terminated"] | arrays["truncated"]
    lengths = set()
    for k, index in enumerate(drawn.indices.astype(int)):
        first, n = divmod(index, 5)
        last = min(first + steps, 48) - 1
        stops = np.flatnonzero(ended[first : last + 1, n])
        last = first + int(stops[0]) if len(stops) else last
        powers = gamma ** np.arange(last + 1 - first)
        wanted = (powers * arrays["rewards"][first : last + 1, n].astype(float)).sum()
        # Products, sums and powers round up to ten times.
        size = (powers * np.abs(arrays["rewards"][first : last + 1, n].astype(float))).sum()
        assert abs(drawn.rewards[k] - wanted) <= 10 * np.finfo(dtype).eps * size
        over = arrays["terminated"][last, n]
        assert drawn.terminated[k] == over and drawn.truncated[k] == arrays["truncated"][last, n]
        # Powers of 3/4 up to the fourth are exact.
        assert drawn.discounts[k] == (0.0 if over else gamma ** (last + 1 - first))
        after = ends[last, n] if ended[last, n] else arrays["observations"][last + 1, n]
        np.testing.assert_array_equal(drawn.next_observations[k], after)
        lengths.add(last + 1 - first)
    assert lengths == {1, 2, 3, 4}


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("kind", WIDE)
def test_sequences_of_any_width_are_the_arrays_of_the_rollouts(kind, dtype):
    _, buffer, arrays, ends = rollouts(kind, dtype)
    drawn = buffer.sample_sequences(100, 12)
    first, n = np.divmod(drawn.indices.astype(int), 5)
    at = first[:, None] + np.arange(12)
    for name in ("observations", "actions", "rewards", "terminated", "truncated"):
        np.testing.assert_array_equal(getattr(drawn, name), arrays[name][at, n[:, None]])
    ended = (drawn.terminated | drawn.truncated).cumsum(axis=1)
    np.testing.assert_array_equal(drawn.mask, np.pad(ended, ((0, 0), (1, 0)))[:, :-1] == 0)
    last = drawn.mask.sum(axis=1) - 1
    assert last.min() < 11
    for k in range(100):
        step = first[k] + last[k]
        after = ends.get((step, n[k]), arrays["observations"][step + 1, n[k]])
        np.testing.assert_array_equal(drawn.next_observations[k], after)


@pytest.mark.parametrize(
    ("kind", "other", "text"),
    [
        ("acrobot", "two actions", "the number of observed numbers of the rollout is 4; it must be 6"),
        ("two actions", "acrobot", "the number of observed numbers of the rollout is 6; it must be 4"),
        ("two actions", "chunk", "the number of actions of the rollout is 6; it must be 2"),
        ("compiled", "one number", "the number of observed numbers of the rollout is 1; it must be 2"),
        ("orbit", "compiled", "the number of observed numbers of the rollout is 2; it must be 4"),
    ],
)
def test_a_rollout_of_another_width_is_refused_and_changes_nothing(kind, other, text):
    _, buffer, _, _ = rollouts(kind, "float64")
    before = buffer.sample(200)
    envs = rollouts(other, "float64")[0]
    with pytest.raises(ValueError, match=text):
        buffer.insert(envs.rollout(Random(-2.0, 2.0), 4))
    buffer.number = 0
    again = buffer.sample(200)
    np.testing.assert_array_equal(again.indices, before.indices)
    np.testing.assert_array_equal(again.observations, before.observations)


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


def test_a_step_to_an_observation_that_is_not_finite_is_lost_and_no_transition():
    falling = System(acceleration={"q": "-1 + 0*u"}, inputs=["u"])
    envs = Environments(falling, 3, dt=0.1, integrator="rk4", observe=["sqrt(q)"], reward="-1", start={"q": 0.5}, dtype="float64")
    envs.reset(seed=0)
    # The height 0.5 - t²/2 is below zero after 1 s.
    rollout = envs.rollout(Random(-1.0, 1.0), 60)
    assert rollout.episodes["lost"].all() and (rollout.episodes["lengths"] >= 10).all() and len(rollout.episodes["lost"]) >= 9
    buffer = ReplayBuffer(envs, 60)
    buffer.insert(rollout)
    # The step that is lost is none, nor is the one that resets.
    assert len(buffer) == 3 * 60 - 2 * len(rollout.episodes["lost"])
    drawn = buffer.sample(5000)
    assert np.isfinite(drawn.observations).all() and np.isfinite(drawn.next_observations).all()


def test_priorities_beyond_the_floats_of_the_buffer_are_refused_and_small_ones_stay():
    envs = Environments("Pendulum", 2)
    envs.reset(seed=0)
    buffer = ReplayBuffer(envs, 10, priorities=True)
    made = "steps=10, num_envs=2, priorities=True, dtype='float32'"
    assert repr(buffer) == f"ReplayBuffer({made}; 0 transitions with 3 observed numbers and 1 actions)"
    buffer.insert(envs.rollout(Random(-1.0, 1.0), 10))
    indices = np.arange(20, dtype=np.uint64)
    with pytest.raises(ValueError, match=r"a priority is 1e\+39, but it must be at most 3.40282e\+38 in float32"):
        buffer.update_priorities(indices, np.full(20, 1e39))
    assert buffer.update_priorities([], []) == 0
    # All are as likely again, though none is a number of float32.
    assert buffer.update_priorities(indices, np.full(20, 1e-46)) == 20
    assert len(np.unique(buffer.sample(2000, correction=0.5).indices)) == 20
