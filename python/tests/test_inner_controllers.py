"""Environments of several rates: a policy gives targets to an inner controller that samples more often."""

import numpy as np
import pytest

from libration import PD, Environments, System, Uniform
from libration.policies import Linear

ARM = System(
    acceleration={"q": "u/m - 3*q"},
    parameters={"m": 0.5},
    inputs=["u"],
    task={"reward": "-q^2", "start": {"q": (-1, 1)}},
)


def arm(num_envs=3, **given):
    return Environments(ARM, num_envs, **{"dtype": "float64", "integrator": "rk4", **given})


def test_a_held_target_moves_alike_whatever_the_rate_of_the_policy():
    """0.02 s × 1 is 0.01 s × 2: the inner controller and the integrator have 1 ms in both."""
    slow, fast = (arm(dt=dt, inner=PD(40.0, 6.0), inner_period=0.001) for dt in (0.02, 0.01))
    assert (slow.substeps, fast.substeps) == (20, 10)
    slow.reset(seed=1), fast.reset(seed=1)
    for k in range(50):
        targets = np.full((3, 1), np.sin(k))
        slow.step(targets), fast.step(targets), fast.step(targets)
        assert np.array_equal(slow.states, fast.states)


def test_an_inner_controller_holds_its_command_for_its_period():
    envs = arm(1, dt=0.02, inner=PD(40.0, 6.0), inner_period=0.01, substeps=4)
    envs.reset(seed=0)
    (x, v), target = envs.states[0], 0.7
    envs.step(np.full((1, 1), target))
    # The exact motion of q'' = c - 3q under a held acceleration; RK4 in steps of 5 ms errs by (0.005·√3)⁵/120 a step.
    omega = np.sqrt(3.0)
    for _ in range(2):
        c = (40.0 * (target - x) - 6.0 * v) / 0.5
        rest, cos, sin = c / 3.0, np.cos(omega * 0.01), np.sin(omega * 0.01)
        x, v = rest + (x - rest) * cos + v / omega * sin, -(x - rest) * omega * sin + v * cos
    np.testing.assert_allclose(envs.states[0], [x, v], rtol=0, atol=1e-9)


@pytest.mark.parametrize(("gain", "grows"), [(9.0, False), (18.0, True)])
def test_a_loop_of_two_rates_grows_as_the_product_over_the_common_period(gain, grows):
    """A policy at 20 Hz around a PD controller at 100 Hz: the spectral radius is that of the product of the five inner periods."""
    dt, period = 0.05, 0.01
    a, b = np.array([[0.0, 1.0], [-3.0, 0.0]]), np.array([[0.0], [2.0]])
    # The series of the exponential under a held input, of a matrix below 0.1: twelve terms are exact.
    block, held, term = np.block([[a, b], [np.zeros((1, 3))]]) * period, np.eye(3), np.eye(3)
    for k in range(1, 13):
        term = term @ block / k
        held = held + term
    ad, bd = held[:2, :2], held[:2, 2:]
    inner = np.block([[ad - bd @ np.array([[40.0, 6.0]]), bd * 40.0], [np.zeros((1, 2)), np.eye(1)]])
    policy = np.array([[-gain, -0.2]])
    product = np.linalg.matrix_power(inner, 5)
    radius = max(abs(np.linalg.eigvals(product[:2, :2] + product[:2, 2:] @ policy)))
    envs = arm(200, dt=dt, inner=PD(40.0, 6.0), inner_period=period, substeps=5)
    envs.reset(seed=2)
    envs.rollout(Linear([-gain, -0.2]), 40)
    early = np.linalg.norm(envs.states)
    envs.rollout(Linear([-gain, -0.2]), 40)
    growth = (np.linalg.norm(envs.states) / early) ** (1 / 40)
    assert (radius > 1) == grows
    # The phase of a complex pair changes the norm by at most the condition of its vectors, 40 periods apart: 5 %.
    assert abs(growth / radius - 1) < 0.05, (growth, radius)


def test_targets_arrive_late_but_the_inner_controller_does_not():
    late, timely = arm(2, dt=0.02, inner=PD(40.0, 6.0), inner_period=0.01, action_delay=0.02), arm(2, dt=0.02, inner=PD(40.0, 6.0), inner_period=0.01)
    late.reset(seed=3), timely.reset(seed=3)
    late.step(np.ones((2, 1))), timely.step(np.zeros((2, 1)))
    assert np.array_equal(late.states, timely.states)
    late.step(np.zeros((2, 1))), timely.step(np.ones((2, 1)))
    assert np.array_equal(late.states, timely.states)


def test_an_inner_controller_by_expressions_has_targets_of_its_own():
    two = System(acceleration={"x": "a", "y": "b"}, inputs=["a", "b"])
    envs = Environments(
        two, 4, dt=0.02, reward="-(x - radius*cos(phase))^2", targets=["radius", "phase"],
        inner={"a": "9*(radius*cos(phase) - x) - 3*x'", "b": "9*(radius*sin(phase) - y) - 3*y'"}, inner_period=0.02, dtype="float64",
    )
    envs.reset(seed=0)
    for _ in range(600):
        rewards = envs.step(np.tile([0.5, 2.0], (4, 1)))[1]
    np.testing.assert_allclose(envs.states[:, :2], np.tile([0.5 * np.cos(2), 0.5 * np.sin(2)], (4, 1)), atol=1e-6)
    assert np.abs(rewards).max() < 1e-12


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"inner": PD(1, 1), "inner_period": 0.003}, ValueError, "inner_period is 0.003 s, but dt = 0.02 s"),
        ({"inner": PD(1, 1), "inner_period": 0.01, "substeps": 3}, ValueError, "multiple of the 2 periods"),
        ({"inner_period": 0.01}, ValueError, "belongs to an inner controller"),
        ({"inner": {"u": "target"}, "inner_period": 0.01}, ValueError, "without targets"),
        ({"inner": {"u": "q"}, "targets": ["q"], "inner_period": 0.01}, ValueError, "`q` is given twice"),
        ({"inner": {"w": "target"}, "targets": ["target"], "inner_period": 0.01}, ValueError, "unknown name `w`"),
        ({"inner": {}, "targets": ["target"]}, ValueError, "`u` has no command"),
        ({"inner": {"u": "target + u"}, "targets": ["target"], "inner_period": 0.01}, ValueError, "unknown name `u`"),
        ({"inner": "target"}, TypeError, "inner must be libration.PD or a dictionary of expressions, not str"),
        ({"inner": PD(1, 1)}, TypeError, "inner_period is required with inner"),
        ({"inner": PD(1, 1), "inner_period": 0.01, "targets": ["a", "b"]}, ValueError, "a name for each coordinate: q"),
        ({"inner": PD("stiff", 1)}, TypeError, "kp of inner must be a number"),
    ],
)
def test_wrong_inner_controllers_are_refused_by_name(given, error, text):
    with pytest.raises(error, match=text):
        arm(dt=0.02, **given)


CART = System(acceleration={"x": "u"}, inputs=["u"], task={"reward": "-x^2", "start": {"x": (-1, 1)}})


@pytest.mark.parametrize(("used", "delay"), [(3, 0.0), (3, 0.08), (1, 0.12), (3, 0.2), (6, 0.05)])
def test_a_chunk_gives_the_command_of_each_time_and_leaves_out_what_has_passed(used, delay):
    """Six actions for 50 ms each, of which some are used before the next chunk takes over, ``delay`` after its observation."""
    dt, length = 0.05, 6
    envs = Environments(CART, 2, dt=dt, chunk=(length, used), action_delay=delay, integrator="rk4", dtype="float64")
    envs.reset(seed=0)
    x, v = envs.states[0]
    rng = np.random.default_rng(0)
    chunks = rng.normal(size=(8, length))
    for chunk in chunks:
        envs.step(np.tile(chunk, (2, 1)))
    # Time in steps of 5 ms, of which all periods and delays are multiples: the chunk of the latest observation that has been answered.
    tick = 0.005
    for n in range(round(8 * used * dt / tick)):
        time = n * tick
        answered = int(np.floor((time - delay) / (used * dt) + 1e-9))
        command = 0.0
        if answered >= 0:
            index = int(np.floor((time - answered * used * dt) / dt + 1e-9))
            command = chunks[answered][min(index, length - 1)]
        x, v = x + v * tick + command * tick**2 / 2, v + command * tick
    np.testing.assert_allclose(envs.states[0], [x, v], rtol=0, atol=1e-12)


def test_chunks_of_targets_are_those_of_an_inner_controller():
    given = {"dt": 0.02, "inner": PD(40.0, 6.0), "inner_period": 0.01}
    chunks, single = arm(chunk=(3, 2), **given), arm(**given)
    assert chunks.preset.actions == ("target_q_0", "target_q_1", "target_q_2") and chunks.substeps == 4
    chunks.reset(seed=1), single.reset(seed=1)
    rng = np.random.default_rng(0)
    for _ in range(20):
        actions = rng.normal(size=(3, 3))
        chunks.step(actions)
        single.step(actions[:, :1]), single.step(actions[:, 1:2])
        assert np.array_equal(chunks.states, single.states)


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"chunk": 3}, ValueError, r"chunk is 3, but it must be two integers"),
        ({"chunk": (2, 3)}, ValueError, "its second number must be at most its first"),
        ({"chunk": (0, 0)}, ValueError, "length of chunk is 0"),
        ({"chunk": (3, 1), "actions": [0.0, 1.0]}, TypeError, "discrete actions have no chunks"),
    ],
)
def test_wrong_chunks_are_refused(given, error, text):
    with pytest.raises(error, match=text):
        arm(dt=0.02, **given)
    with pytest.raises(TypeError, match="chunk belongs to environments of a System"):
        Environments("Pendulum", 2, chunk=(3, 1))


def test_limits_of_a_chunk_are_those_of_each_time():
    two = System(acceleration={"x": "a", "y": "b"}, inputs=["a", "b"])
    given = {"dt": 0.1, "reward": "0", "chunk": (2, 1), "dtype": "float64"}
    for most, limits in (([1.0, 5.0], [[1.0, 5.0]] * 3), (np.array([[1.0, 5.0], [2.0, 6.0], [3.0, 7.0]]), [[1.0, 5.0], [2.0, 6.0], [3.0, 7.0]])):
        envs = Environments(two, 3, max_action=most, **given)
        envs.reset(seed=0)
        envs.step(np.full((3, 4), 100.0))
        np.testing.assert_allclose(envs.states[:, 2:], 0.1 * np.array(limits))
    with pytest.raises(ValueError, match="with a chunk it must be a number"):
        Environments(two, 3, max_action=Uniform(1, 2), **given)


def test_a_chunk_may_have_hundreds_of_actions():
    envs = Environments(CART, 1, dt=0.01, chunk=(500, 400), dtype="float64", integrator="rk4")
    envs.reset(seed=0)
    envs.set_state([0.0, 0.0])
    actions = np.arange(500.0)[None]
    envs.step(actions)
    # Velocities are the sums of the first 400 actions times 0.01 s.
    np.testing.assert_allclose(envs.states[0, 1], 0.01 * actions[0, :400].sum(), rtol=1e-12)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"targets": ["m"], "inner": {"u": "-m*q"}, "inner_period": 0.02}, "'m', but it must be a name of its own"),
        ({"inner": {"u": "-q"}, "inner_period": 0.02}, "must be given together"),
        ({"targets": "ab", "inner": {"u": "a"}, "inner_period": 0.02}, "list of names"),
        ({"inner_period": 0.02}, "belongs to an inner controller"),
    ],
)
def test_targets_of_chunks_are_checked_as_without_chunks(given, text):
    with pytest.raises((TypeError, ValueError), match=text):
        arm(dt=0.02, chunk=(2, 1), **given)


@pytest.mark.parametrize("chunk", [None, (3, 1)])
@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("pi", "`pi` is a name of the language"),
        ("age", "`age` is given twice"),
        ("t", "`t` is a name of the language"),
        ("if", "`if` is a name of the language"),
        ("sin", "`sin` is a name of the language"),
        ("pull", "`pull` is given twice"),
        ("", "`` is no name"),
        ("a b", "`a b` is no name"),
    ],
)
def test_no_target_has_a_name_of_expressions_with_or_without_a_chunk(name, text, chunk):
    system = System(acceleration={"q": "pull - q"}, let={"pull": "2*u"}, inputs=["u"], parameters={"k": 1.0})
    given = {"dt": 0.1, "reward": "-q^2", "inner": {"u": "q"}, "inner_period": 0.1, "chunk": chunk, "k": np.array([1.0, 2.0])}
    with pytest.raises(ValueError, match=text):
        Environments(system, 2, targets=[name], **given)
    assert len(Environments(system, 2, targets=["goal"], **given).preset.actions) == (chunk or [1])[0]


def test_a_target_of_a_file_has_no_name_of_expressions():
    task = {"reward": "0", "targets": ["t"], "inner": {"u": "t - q"}, "inner_period": 0.1}
    with pytest.raises(ValueError, match="`t` is a name of the language"):
        Environments(System(acceleration={"q": "u"}, inputs=["u"], task=task), 1, dt=0.1)
