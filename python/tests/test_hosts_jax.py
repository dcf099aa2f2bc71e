"""Hosts: functions of JAX as steps in float64."""

import numpy as np
import pytest

jax = pytest.importorskip("jax")

import jax.numpy as jnp  # noqa: E402

from libration import probe  # noqa: E402
from libration.hosts import Host, jax_host  # noqa: E402

EPS = np.finfo(float).eps


def pendulum(xp):
    """A step of symplectic Euler of a damped pendulum with a torque, with the functions of ``xp``."""

    def step(x, u, dt):
        rate = x[1] + dt * (-9.81 * xp.sin(x[0]) - 0.1 * x[1] + u[0])
        return xp.stack([x[0] + dt * rate, rate])

    return step


def one(host, state=None, action=None, dt=None):
    state = host.state if state is None else np.array(state, dtype=float)
    action = host.action if action is None else np.array(action, dtype=float)
    return host.step(state[np.newaxis], action[np.newaxis], host.dt if dt is None else dt)[0]


def network(n):
    """A step with products of matrices, exponentials and a solution of equations."""
    matrix = np.random.default_rng(n).normal(size=(n, n)) / np.sqrt(n)

    def step(x, u, dt):
        return x + dt * (jnp.tanh(matrix @ x) + jnp.exp(-(x**2)) + jnp.linalg.solve(matrix, x) + u[0])

    return step


def test_a_step_is_that_of_numpy_to_the_rounding_of_its_sums():
    host = jax_host(pendulum(jnp), [0.3, -0.4], [0.7], 0.01)
    assert host.version == f"JAX {jax.__version__}"
    random = np.random.default_rng(1)
    states, actions = random.normal(size=(200, 2)), random.normal(size=(200, 1))
    found = host.step(states, actions, 0.01)
    expected = np.stack([pendulum(np)(x, u, 0.01) for x, u in zip(states, actions)])
    # XLA may leave out the rounding of a product that it adds. The rate has three products and four sums; each rounds by at most half
    # an EPS of the largest partial sum. Two units are for the sines. The position has one more product and sum.
    terms = np.abs(states[:, 1]) + 0.01 * (9.81 + 0.1 * np.abs(states[:, 1]) + np.abs(actions[:, 0]))
    sizes = np.stack([np.abs(states[:, 0]) + 0.01 * terms, terms], axis=1)
    assert (np.abs(found - expected) <= (7 / 2 + 2 + 1) * EPS * sizes).all()
    assert isinstance(host, Host) and host.title == "step" and host.inputs == ("u1",)


def test_a_step_of_exact_products_is_that_of_numpy_bit_for_bit():
    def step(x, u, dt):
        return x + dt * (x[::-1] * 0.5 - u)

    host = jax_host(step, [0.3, 0.7], [0.1, 0.2], 0.25)
    states = np.random.default_rng(2).normal(size=(50, 2))
    # Products by powers of two have no rounding.
    expected = np.stack([step(x, np.array([0.1, 0.2]), 0.25) for x in states])
    assert host.step(states, np.tile([0.1, 0.2], (50, 1)), 0.25).tobytes() == expected.tobytes()


@pytest.mark.parametrize("n", [1, 2, 5, 12, 31])
def test_a_row_in_a_batch_has_the_bits_of_the_row_alone(n):
    host = jax_host(network(n), np.zeros(n), [0.0], 0.1)
    random = np.random.default_rng(3)
    states, actions = random.normal(size=(75, n)), random.normal(size=(75, 1))
    batch = host.step(states, actions, 0.1)
    for k in range(75):
        assert host.step(states[k : k + 1], actions[k : k + 1], 0.1).tobytes() == batch[k : k + 1].tobytes()
    assert host.step(states[:0], actions[:0], 0.1).shape == (0, n)


def test_the_derivatives_are_those_of_the_formula():
    host = jax_host(pendulum(jnp), [0.3, -0.4], [0.7], 0.01)
    h, c = 0.01, np.cos(0.3)
    a, b = np.array([[1 - 9.81 * h * h * c, h - 0.1 * h * h], [-9.81 * h * c, 1 - 0.1 * h]]), np.array([[h * h], [h]])
    assert host.reference_source == "jax.jacfwd"
    assert host.reference_A == pytest.approx(a, rel=8 * EPS) and host.reference_B == pytest.approx(b, rel=8 * EPS)


def test_steps_are_in_float64_and_the_global_option_stays():
    before = jax.config.jax_enable_x64
    host = jax_host(lambda x, u, dt: x * (1 + 2.0**-30), [1.0], (), 0.1)
    assert one(host)[0] == 1 + 2.0**-30 and host.notes == ("the point is no equilibrium: a step changes it",)
    assert host.reference_A.dtype == np.float64 and host.reference_B.shape == (1, 0)
    assert jax.config.jax_enable_x64 == before and jnp.ones(1).dtype == (jnp.float64 if before else jnp.float32)


def test_a_step_that_computes_in_float32_has_a_note():
    inner = jax.jit(lambda x: jnp.sin(x.astype(jnp.float32)))
    host = jax_host(lambda x, u, dt: x + dt * inner(x), [0.0], (), 0.1)
    assert host.equilibrium and "step computes in float32 inside: differences have about three digits" in host.notes[0]

    def loop(x, u, dt):
        return jax.lax.fori_loop(0, 3, lambda _, y: y + dt * jnp.float32(y), x)

    assert "computes in float32" in " ".join(jax_host(loop, [0.0], (), 0.1).notes)
    assert one(jax_host(lambda x, u, dt: jnp.float32(x), [0.1], (), 0.1))[0] == np.float32(0.1)


def test_constants_in_float32_have_a_note():
    gain = jnp.array([0.1], dtype=jnp.float32)
    host = jax_host(lambda x, u, dt: gain * x, [1.0], (), 0.1)
    assert "step has constants in float32" in host.notes[0] and one(host)[0] == float(np.float32(0.1))
    assert "constants" not in " ".join(jax_host(lambda x, u, dt: np.array([0.1]) * x, [1.0], (), 0.1).notes)


def test_a_row_that_is_not_finite_returns_nan_and_leaves_the_others():
    def step(x, u, dt):
        # A loop that never ends for NaN.
        return jax.lax.while_loop(lambda y: ~(jnp.abs(y[0]) <= 1.0), lambda y: y / 2, x)

    host = jax_host(step, [0.5], [0.0], 0.1)
    after = host.step(np.array([[8.0], [np.nan], [0.25], [3.0]]), np.array([[0.0], [0.0], [0.0], [np.inf]]), 0.1)
    assert np.isnan(after[[1, 3]]).all() and after[[0, 2], 0].tolist() == [1.0, 0.25]


def test_energy_is_that_of_each_row():
    host = jax_host(pendulum(jnp), [0.0, 0.0], [0.0], 0.01, energy=lambda x: 0.5 * x[1] ** 2 - 9.81 * jnp.cos(x[0]), title="Pendulum")
    states = np.random.default_rng(4).normal(size=(40, 2))
    assert host.energy(states) == pytest.approx(0.5 * states[:, 1] ** 2 - 9.81 * np.cos(states[:, 0]), rel=1e-13)
    assert host.equilibrium and host.title == "Pendulum"


def test_a_function_without_forward_derivative_has_no_reference():
    @jax.custom_vjp
    def half(x):
        return x / 2

    half.defvjp(lambda x: (half(x), None), lambda _, g: (g / 2,))
    host = jax_host(lambda x, u, dt: half(x), [0.0], (), 0.1)
    assert host.reference_A is None and host.reference_source == "" and "jax.jacfwd gives no reference" in host.notes[0]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: jax_host(lambda x, u, dt: x, [0.0]), "dt is missing"),
        (lambda: jax_host(3, [0.0], (), 0.1), "step must be a function, not int"),
        (lambda: jax_host(lambda x, u, dt: x, [0.0], (), -0.1), "dt is -0.1"),
        (lambda: jax_host(lambda x, u, dt: x, [[0.0]], (), 0.1), r"state has shape \(1, 1\)"),
        (lambda: jax_host(lambda x, u, dt: x, [0.0, np.inf], (), 0.1), r"state\[1\] is not finite"),
        (lambda: jax_host(lambda x, u, dt: x[0], [0.0], (), 0.1), r"shape \(\); expected \(1,\)"),
        (lambda: jax_host(lambda x, u, dt: (x,), [0.0], (), 0.1), "returns a tuple"),
        (lambda: jax_host(lambda x, u, dt: x > 0, [0.0], (), 0.1), "type bool; expected float64"),
        (lambda: jax_host(lambda x, u, dt: x if x[0] > 0 else -x, [0.0], (), 0.1), "cannot trace step.*jax.lax.cond"),
        (lambda: jax_host(lambda x, u, dt: x * float(dt), [0.0], (), 0.1), "cannot trace step"),
        (lambda: jax_host(lambda x, u: x, [0.0], (), 0.1), "step fails at the point: TypeError"),
        (lambda: jax_host(lambda x, u, dt: x, [0.0], (), 0.1, states=["a", "b"]), "states has 2 names; expected 1"),
        (lambda: jax_host(lambda x, u, dt: x, [0.0], (), 0.1, energy=lambda x: x), "energy returns an array"),
        (lambda: jax_host(lambda x, u, dt: x, [0.0], (), 0.1, titel="x"), "did you mean 'title'"),
    ],
)
def test_errors_name_what_is_wrong(call, message):
    with pytest.raises((TypeError, ValueError), match=message):
        call()


def test_a_function_of_jax_gives_the_same_bits_in_several_threads():
    before = jax.config.jax_enable_x64
    report = probe.jax(pendulum(jnp), [0.0, 0.0], [0.0], 0.01, threads=4)
    assert report.findings == [] and report.bits["checks"][-1]["name"] == "4 threads at once against one"
    assert jax.config.jax_enable_x64 == before


def test_the_jacobian_of_jax_is_the_matrix_of_the_step():
    report = probe.jax(pendulum(jnp), [0.0, 0.0], [0.0], 0.01)
    host = jax_host(pendulum(jnp), [0.0, 0.0], [0.0], 0.01)
    assert np.array_equal(report.A, host.reference_A) and report.jacobian_error <= 8 * EPS
