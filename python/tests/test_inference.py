"""The time of an answer, drawn for every action: rates, order of arrival, waiting, and the moments that theory gives."""

import json

import numpy as np
import pytest

from libration import Environments, LogNormal, LogUniform, System, Uniform
from libration._spec_keywords import json_value

MASS = System(acceleration={"x": "u"}, inputs=["u"], task={"reward": "-x^2", "start": {"x": 0.0}})
SPRING = System(acceleration={"x": "u - 9*x"}, inputs=["u"], task={"reward": "-x^2", "start": {"x": 1.0}})


def envs(system=MASS, num_envs=4, **given):
    return Environments(system, num_envs, **{"dtype": "float64", "dt": 0.05, **given})


def velocities(batch, actions):
    """The velocities after each of these actions, the same for all environments."""
    batch.reset(seed=7)
    found = []
    for action in actions:
        batch.step(np.full((batch.num_envs, 1), action))
        found.append(batch.states[:, 1].copy())
    return np.array(found)


def held_steps(batch, count):
    """How many steps of the integrator each of so many actions was in effect; the velocity is their sum in a system of digits."""
    digit = 2.0**6
    velocity = velocities(batch, [digit**n for n in range(count)])[-1]
    steps = np.rint(velocity / (batch._settings["dt"])).astype(np.int64)
    return np.array([(steps // 64**n) % 64 for n in range(count)])


@pytest.mark.parametrize("law", [LogNormal(0.08, 0.03), Uniform(0.0, 0.2), LogUniform(0.02, 0.2)])
def test_actions_are_in_effect_as_long_as_in_a_simulation_of_ten_lines(law):
    """Means of 20,000 environments, against as many of NumPy's own draws: within five standard errors of both."""
    number, count = 20_000, 6
    batch = envs(num_envs=number, inference=law, substeps=10)
    found = held_steps(batch, count)
    tick, rng, shape = 0.005, np.random.default_rng(3), (count, number)
    if isinstance(law, LogNormal):
        width = np.sqrt(np.log1p((law.std / law.mean) ** 2))
        times = rng.lognormal(np.log(law.mean) - width**2 / 2, width, shape)
    elif isinstance(law, LogUniform):
        times = np.exp(rng.uniform(np.log(law.low), np.log(law.high), shape))
    else:
        times = rng.uniform(*law.ends, shape)
    late = np.rint(times / tick)
    expected = np.zeros(shape)
    for step in range(10 * count):
        # The newest action that has arrived; action n was asked for at step 10·n.
        arrived = np.where(late + 10 * np.arange(count)[:, None] <= step, np.arange(count)[:, None], -1).max(axis=0)
        for n in range(count):
            expected[n] += arrived == n
    for n in range(count):
        error = np.sqrt((found[n].var() + expected[n].var()) / number)
        assert abs(found[n].mean() - expected[n].mean()) <= 5 * error + 1e-12, n
        # A fourth moment within three squared variances gives the standard error of a variance.
        assert found[n].var() == pytest.approx(expected[n].var(), rel=5 * np.sqrt(8 / number), abs=1e-12), n


def test_moments_of_a_loop_whose_answers_take_part_of_a_period_are_those_of_theory():
    """The second moments follow the mean of the Kronecker squares of a period, whose latencies are independent (De Koning, Automatica 1982).

    With the mean latency in all periods the loop would decay.
    """
    number, dt, parts, gains = 40_000, 0.2, 10, np.array([[-20.0, -8.0]])
    batch = envs(SPRING, number, dt=dt, inference=Uniform(0.0, dt), substeps=parts, integrator="velocity-verlet")
    batch.reset(seed=1)
    tick = dt / parts
    # A step of velocity Verlet under a held command.
    a = np.array([[1 - 4.5 * tick**2, tick], [-9 * tick * (1 - 2.25 * tick**2), 1 - 4.5 * tick**2]])
    b = np.array([[tick**2 / 2], [tick * (1 - 2.25 * tick**2)]])
    step = np.block([[a, b], [np.zeros((1, 2)), np.eye(1)]])
    command = np.vstack([np.zeros((2, 3)), np.append(gains, 0.0)])
    keep, power = np.diag([1.0, 1.0, 0.0]), np.linalg.matrix_power
    # The command before acts until the answer to the observation at the start arrives.
    periods = [power(step, parts - late) @ (keep @ power(step, late) + command) for late in range(parts + 1)]
    # Rounded to whole steps, the first and the last latency have half the probability.
    weights = np.array([0.5, *[1.0] * (parts - 1), 0.5]) / parts
    mean = sum(w * np.kron(m, m) for w, m in zip(weights, periods))
    moments = np.outer([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]).ravel()
    for _ in range(8):
        batch.step(batch.states @ gains.T)
        moments = mean @ moments
    squares = batch.states[:, 0] ** 2
    error = squares.std() / np.sqrt(number)
    assert squares.mean() == pytest.approx(moments[0], abs=5 * error)
    # Of this law, and of no other: with equal weights the moment is 5.71, with the mean latency alone 0.019.
    assert moments[0] == pytest.approx(4.56, abs=0.005) and error < 0.08


def test_the_same_time_for_all_answers_is_a_latency():
    given = {"integrator": "rk4", "chunk": (4, 2)}
    one, other = envs(inference=0.08, **given), envs(action_delay=0.08, **given)
    for batch in (one, other):
        batch.reset(seed=3)
    rng = np.random.default_rng(0)
    for _ in range(20):
        chunks = rng.normal(size=(4, 4))
        one.step(chunks), other.step(chunks)
        assert np.array_equal(one.states, other.states)


def test_times_of_answers_come_on_top_of_latencies():
    plain, late = (held_steps(envs(num_envs=50, inference=Uniform(0.0, 0.04), substeps=10, **more), 5) for more in ({}, {"action_delay": 0.1}))
    # Two periods later, the first three actions are in effect as long as without.
    assert np.array_equal(plain[:2], late[:2]) and (late[3:] == 0).all() and not (plain[3:] == 0).all()


def test_chunks_go_on_by_the_time_since_the_observation_that_was_answered():
    """Of the newest chunk that has arrived the command of this time, against the same rule in NumPy for the latencies of single actions."""
    dt, length, used, parts, count = 0.05, 6, 2, 10, 6
    law = Uniform(0.02, 0.25)
    single = held_steps(envs(num_envs=8, dt=used * dt, inference=law, substeps=used * parts), count)
    chunked = envs(num_envs=8, chunk=(length, used), inference=law, substeps=used * parts)
    values = np.random.default_rng(5).normal(size=(count, length))
    chunked.reset(seed=7)
    for n in range(count):
        chunked.step(np.tile(values[n], (8, 1)))
    tick = dt / parts
    for env in range(8):
        # Answers act in the order of their observations, so what was in effect when follows from how long each was.
        order = np.repeat(np.arange(count), single[:, env])
        order = np.concatenate([np.full(count * used * parts - len(order), -1), order])
        commands = [0.0 if n < 0 else values[n][min((k - n * used * parts) // parts, length - 1)] for k, n in enumerate(order)]
        assert chunked.states[env, 1] == pytest.approx(tick * np.sum(commands), abs=1e-12)


def test_a_system_that_waits_goes_on_under_its_last_command_for_the_time_of_the_answer():
    """With the commands 1, 2, 4 … a velocity tells how long each step waited: those times have the law that was asked for."""
    number, law, count, dt = 20_000, LogNormal(0.08, 0.03), 4, 0.05
    batch = envs(num_envs=number, inference=law, inference_mode="synchronous", integrator="velocity-verlet")
    found = velocities(batch, [1.0, 2.0, 4.0, 8.0])
    gained = np.diff(found, axis=0, prepend=0.0)
    # Of the first answer nothing is seen: there was no command before.
    np.testing.assert_allclose(gained[0], dt, rtol=0, atol=1e-12)
    times = np.array([(gained[n] - 2.0**n * dt) / 2.0 ** (n - 1) for n in range(1, count)]).ravel()
    width = np.sqrt(np.log1p((law.std / law.mean) ** 2))
    logarithms = np.log(times)
    assert logarithms.mean() == pytest.approx(np.log(law.mean) - width**2 / 2, abs=5 * width / np.sqrt(times.size))
    assert logarithms.std() == pytest.approx(width, rel=5 / np.sqrt(2 * times.size))


def test_a_chunk_of_a_system_that_waits_uses_its_first_actions():
    batch = envs(num_envs=3, chunk=(5, 2), inference=Uniform(0.1, 0.1), inference_mode="synchronous")
    found = velocities_of_chunks(batch, [[1.0, 2.0, 90.0, 90.0, 90.0], [4.0, 8.0, 90.0, 90.0, 90.0]])
    # Two actions of 50 ms; then 100 ms under the second, and the two of the next chunk.
    np.testing.assert_allclose(found, [[0.15] * 3, [0.15 + 0.2 + 0.6] * 3], rtol=0, atol=1e-12)


def velocities_of_chunks(batch, chunks):
    batch.reset(seed=7)
    found = []
    for chunk in chunks:
        batch.step(np.tile(chunk, (batch.num_envs, 1)))
        found.append(batch.states[:, 1].copy())
    return np.array(found)


@pytest.mark.parametrize("time", [0.08, 0.2])
def test_an_inner_controller_samples_at_its_period_while_the_system_waits(time):
    """Against the exact motion of x'' = u under the commands of the same samples, at 0.05 s and at the arrival of the answer."""
    gains, period = (40.0, 6.0), 0.05
    batch = Environments(
        MASS, 1, dt=0.1, inner=dict(u=f"{gains[0]}*(r - x) - {gains[1]}*x'"), targets=["r"], inner_period=period, start={"x": 1.0}, dtype="float64",
        inference=time, inference_mode="synchronous", integrator="velocity-verlet",
    )
    batch.reset(seed=0)
    x, v, before = 1.0, 0.0, 0.0
    for target in (0.5, -0.5, 2.0):
        batch.step(np.full((1, 1), target))
        waits = [period] * int(time / period + 1e-9) + [time % period if time % period > 1e-9 and period - time % period > 1e-9 else 0.0]
        for r, length in [(before, length) for length in waits] + [(target, period)] * 2:
            u = gains[0] * (r - x) - gains[1] * v
            x, v = x + v * length + u * length**2 / 2, v + u * length
        before = target
        np.testing.assert_allclose(batch.states[0], [x, v], rtol=0, atol=1e-11)


def test_no_time_of_waiting_is_no_step():
    plain, waiting = (envs(SPRING, 3, project={"x'": "(x - before(x))/dt"}, **more) for more in ({}, {"inference": 0.0, "inference_mode": "synchronous"}))
    plain.reset(seed=1), waiting.reset(seed=1)
    for _ in range(5):
        assert np.array_equal(plain.step(np.ones((3, 1)))[0], waiting.step(np.ones((3, 1)))[0])


def test_the_time_of_the_next_answer_is_told():
    batch = envs(num_envs=70, inference=LogNormal(0.08, 0.03), inference_mode="synchronous", parameter_infos=True)
    _, infos = batch.reset(seed=7)
    batch.step(np.ones((70, 1)))
    for _ in range(3):
        told, before = batch.parameters["inference"], batch.states[:, 1].copy()
        *_, infos = batch.step(np.ones((70, 1)))
        # Under the command 1, the velocity grows by the time of the step.
        np.testing.assert_allclose(batch.states[:, 1] - before, told + 0.05, rtol=0, atol=1e-12)
        assert np.array_equal(infos["parameters"]["inference"], batch.parameters["inference"])
    assert "dt=0.05" in repr(batch) and batch.substeps == 1


@pytest.mark.parametrize("mode", ["asynchronous", "synchronous"])
def test_times_of_answers_depend_on_the_episode_alone(mode):
    given = {"inference": ("lognormal", 0.08, 0.03), "inference_mode": mode, "max_episode_steps": 7, "autoreset_mode": "SameStep"}
    actions = np.random.default_rng(2).normal(size=(20, 130, 1))

    def states(num_envs, **more):
        batch = envs(SPRING, num_envs, **given, **more)
        batch.reset(seed=11)
        return [batch.step(all[:num_envs])[0].copy() for all in actions]

    whole, part = states(130, threads=2), states(70)
    assert all(np.array_equal(a[:70], b) for a, b in zip(whole, part))
    # Two episodes with the same start and the same actions differ in the times of their answers alone.
    batch = envs(SPRING, 1, **given)
    batch.reset(seed=11)
    episodes = [[batch.step(np.ones((1, 1)))[0].copy() for _ in range(7)] for _ in range(2)]
    assert not np.array_equal(episodes[0][5], episodes[1][5])


def test_the_answers_of_presets_without_spread_are_a_latency():
    keywords = {"substeps": 4, "dtype": "float64"}
    batch = Environments("Pendulum", 3, inference=LogNormal(0.05, 0.0), **keywords)
    late = Environments("Pendulum", 3, action_delay=0.05, **keywords)
    plain = Environments("Pendulum", 3, **keywords)
    for envs in (batch, late, plain):
        envs.reset(seed=0)
    actions = np.random.default_rng(1).uniform(-1, 1, (30, 3, 1))
    seen, delayed, undelayed = ([envs.step(action)[0] for action in actions] for envs in (batch, late, plain))
    assert np.array_equal(seen, delayed) and not np.array_equal(seen, undelayed)


def test_the_mean_of_answers_has_eight_steps_of_the_integrator_unless_that_takes_more_than_twenty():
    found = [envs(inference=Uniform(0.0, 2 * mean)).substeps for mean in (0.4, 0.05, 0.02, 0.01)]
    assert found == [1, 8, 20, 20]
    # Twenty in each period of a chunk.
    assert envs(inference=LogNormal(0.02, 0.008), dt=0.02, chunk=(50, 25)).substeps == 200


def test_times_that_steps_cannot_tell_are_warned_of():
    with pytest.warns(UserWarning, match="inference has a mean of 0.001 s, but its times are rounded to steps of 0.0025 s"):
        envs(inference=LogNormal(0.001, 0.0003))


def test_largest_commands_and_parameters_of_presets_may_be_lognormal():
    batch = Environments("Pendulum", 2000, max_action=LogNormal(2.0, 0.5), omega2=LogNormal(4.0, 0.0))
    batch.reset(seed=0)
    assert batch.parameters["max_action"].mean() == pytest.approx(2.0, abs=5 * 0.5 / np.sqrt(2000))
    np.testing.assert_allclose(batch.parameters["omega2"], 4.0, rtol=1e-6)


def test_a_picture_of_a_system_that_waits_is_shown_for_the_mean_of_a_step():
    envs = pytest.importorskip("libration.envs")
    batch = envs.PendulumVectorEnv(2, dt=0.05, inference=LogNormal(0.15, 0.03), inference_mode="synchronous")
    assert batch.metadata["render_fps"] == 5


def test_keywords_of_inference_are_those_of_json():
    spec = json.loads(json.dumps(json_value(LogNormal(0.08, 0.03))))
    one, other = (envs(SPRING, inference=x) for x in (spec, ("lognormal", 0.08, 0.03)))
    for batch in (one, other):
        batch.reset(seed=5)
    for _ in range(5):
        assert np.array_equal(one.step(np.ones((4, 1)))[0], other.step(np.ones((4, 1)))[0])


def test_parameters_of_episodes_may_be_lognormal():
    system = System(acceleration={"x": "u - k*x"}, parameters={"k": 1.0}, inputs=["u"], task={"reward": "0"})
    batch = Environments(system, 20_000, dt=0.1, k=LogNormal(4.0, 1.0))
    batch.reset(seed=0)
    drawn = batch.parameters["k"]
    # Of 20,000 numbers; a lognormal one with this ratio has a fourth moment of 4.1 squared variances.
    assert drawn.mean() == pytest.approx(4.0, abs=5 / np.sqrt(20_000)) and drawn.std() == pytest.approx(1.0, rel=5 * np.sqrt(3.1 / 80_000))
    assert (drawn > 0).all()


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"inference": -0.1}, ValueError, "inference is -0.1, but it must be finite and at least 0"),
        ({"inference": ("gaussian", 0.1, 0.01)}, TypeError, "inference is .*, but it must be a number in s"),
        ({"inference": ("lognormal", 0.1)}, TypeError, "inference is .*, but it must be a number in s"),
        ({"inference": (0.1, 0.2)}, TypeError, "inference is .*, but it must be a number in s"),
        ({"inference": Uniform(-0.1, 0.1)}, ValueError, "an end of inference is -0.1"),
        ({"inference": Uniform(0.0, 0.02), "action_delay": 0.05 * 2**-0.5}, ValueError, "action_delay is 0.0353.* s, but it must be whole steps"),
        ({"inference": 0.0123457, "substeps": 3}, ValueError, "^inference is 0.0123457 s"),
        ({"inference": ("lognormal", -0.1, 0.1)}, ValueError, "inference: mean of LogNormal is -0.1"),
        ({"inference": 0.1, "inference_mode": ["synchronous"]}, ValueError, "inference_mode is "),
        ({"jitter": LogNormal(0.1, 0.1)}, ValueError, "jitter is .*around zero, like Gaussian"),
        ({"inference": Uniform(0.0, 100.0), "action_delay": 60.0, "substeps": 2}, ValueError, "inference takes up to 100 s, which is 4000 steps"),
        ({"inference": LogNormal(0.1, 1.0), "substeps": 1000}, ValueError, "inference takes up to 8.1 s, which is 162000 steps"),
        ({"inference": 0.1, "inference_mode": "frozen"}, ValueError, "inference_mode is 'frozen'"),
        ({"inference_mode": "synchronous"}, TypeError, "but inference is not given"),
        ({"inference": 0.1, "inference_mode": "synchronous", "action_delay": 0.05}, ValueError, "action_delay is 0.05 s, but with"),
        ({"inference": 0.1, "inference_mode": "synchronous", "reward": "-t"}, ValueError, "depends on the time t"),
    ],
)
def test_wrong_times_of_answers_are_refused(given, error, text):
    with pytest.raises(error, match=text):
        envs(**given)
