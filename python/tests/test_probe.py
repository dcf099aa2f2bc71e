"""Audits of steps that are Python functions: faults that are planted on purpose, limits, and errors."""

import dataclasses
import functools
import json
import math

import numpy as np
import pytest

import libration
from libration import LQR, probe
from libration.hosts import Host

DT = 0.01
OMEGA2 = 9.0


def pendulum(x, u, dt, damping=0.0):
    """Symplectic Euler."""
    v = x[1] + dt * (-OMEGA2 * math.sin(x[0]) - damping * x[1] + u[0])
    return [x[0] + dt * v, v]


def energy(x):
    return 0.5 * x[1] ** 2 + OMEGA2 * (1 - math.cos(x[0]))


def pendulums(states, actions, dt):
    v = states[:, 1] + dt * (-OMEGA2 * np.sin(states[:, 0]) + actions[:, 0])
    return np.stack([states[:, 0] + dt * v, v], axis=1)


def audit(step, x=(0.0, 0.0), u=(0.0,), dt=DT, **keywords):
    return probe(step, x, u, dt, **keywords)


def kinds(report):
    return [finding["kind"] for finding in report.findings]


def text_of(report, kind):
    (found,) = [finding["text"] for finding in report.findings if finding["kind"] == kind]
    return found


# ------------------------------------------------------------------ a clean step


def test_a_clean_step_has_no_finding_and_its_integrator_and_order_are_known():
    report = audit(pendulum, energy=energy, conservative=True, observe=lambda x: [math.cos(x[0]), math.sin(x[0]), x[1]])
    assert report.findings == [] and report.holds
    assert report.integrators == ["symplectic-euler"] and report.order == 1
    assert audit(pendulums, batched=True).findings == []
    assert audit(lambda x, u, dt: pendulum(x, u, dt, damping=0.3)).findings == []


def test_the_largest_step_is_that_of_theory():
    # ω dt = 2 in symplectic Euler. Near it the growth is the root of the distance, and 1e-5 count as growth: far below 1e-7 of the step.
    assert audit(pendulum).largest_dt == pytest.approx(2 / math.sqrt(OMEGA2), rel=1e-7)


def test_matrices_are_those_of_the_step():
    report = audit(pendulum)
    # Differences of steps have eleven digits.
    assert report.A == pytest.approx(np.array([[1 - OMEGA2 * DT**2, DT], [-OMEGA2 * DT, 1.0]]), abs=1e-11)
    assert report.B == pytest.approx(np.array([[DT**2], [DT]]), abs=1e-11)


def test_the_plant_has_the_step_as_its_exact_step_and_a_loop_around_it_has_limits():
    report = audit(pendulum)
    from_plant = report.plant.A * DT
    power, exponential = np.eye(2), np.eye(2)
    for k in range(1, 20):
        power = power @ from_plant / k
        exponential = exponential + power
    assert exponential == pytest.approx(report.A, abs=1e-11)
    assert report.sampled_plant.dt == DT
    advice = report.advise(LQR([10.0, 1.0], [1.0]), latency=0.02)
    (latency,) = [budget for budget in advice["budgets"] if budget["kind"] == "latency"]
    assert 0.02 < latency["stable_up_to"] < 10


@functools.cache
def late_report():
    """The audit of a step that uses the command of the call before; it takes 100 000 steps."""
    held = [0.0]

    def late(x, u, dt):
        used, held[0] = held[0], u[0]
        return pendulum(x, [used], dt)

    return audit(late)


def test_a_latency_of_the_step_is_added_to_that_of_the_loop():
    controller = LQR([10.0, 1.0], [1.0])
    wanted = audit(pendulum).advise(controller, latency=0.03 + DT)
    found = late_report().advise(controller, latency=0.03)
    # The plants agree up to the differences of steps.
    assert found["growth"] == pytest.approx(wanted["growth"], rel=1e-8)


# ------------------------------------------------------------------ faults


def test_a_command_that_is_one_step_late_is_found():
    report = late_report()
    assert kinds(report) == ["late-command"] and not report.holds
    assert report.hidden_latency[0]["late_steps"] == 1.0 and report.hidden_latency[0]["late"] == DT


def test_the_wrong_sign_of_a_damping_is_found_with_its_size():
    report = audit(lambda x, u, dt: pendulum(x, u, dt, damping=-0.1))
    assert kinds(report) == ["negative-damping"]
    assert report.results["driven_velocities"][0]["rate"] == pytest.approx(0.1, abs=1e-8)


def test_an_upright_pendulum_is_unstable_and_that_is_no_fault():
    report = audit(pendulum, x=(math.pi, 0.0))
    assert report.findings == [] and report.spectral_radius > 1


@pytest.mark.parametrize("with_energy", [False, True])
def test_a_leak_of_a_millionth_per_second_is_found_in_a_conservative_system(with_energy):
    def leaking(x, u, dt):
        return pendulum(x, u, dt, damping=1e-6)

    assert kinds(audit(leaking, conservative=True, energy=energy if with_energy else None)) == ["energy-leak"]
    assert kinds(audit(leaking)) == []


def test_a_batch_that_differs_in_the_last_bit_is_found_and_located():
    def spoiled(states, actions, dt):
        after = pendulums(states, actions, dt)
        if len(after) == 4096:
            after[4095, 1] = np.nextafter(after[4095, 1], np.inf)
        return after

    report = audit(spoiled, batched=True)
    assert kinds(report) == ["bits-differ"]
    assert "first in environment 4095, component 1" in text_of(report, "bits-differ") and "1 ulps" in text_of(report, "bits-differ")


def test_a_stale_observation_is_found():
    held = [[0.0, 0.0]]

    def stale(x):
        shown, held[0] = held[0], list(x)
        return shown

    report = audit(pendulum, observe=stale)
    assert kinds(report) == ["stale-observation"] and "1 step (0.01 s) older" in text_of(report, "stale-observation")


def test_a_random_step_is_found_and_its_audit_ends():
    rng = np.random.default_rng(0)
    report = audit(lambda x, u, dt: pendulum(x, [u[0] + rng.normal()], dt))
    assert kinds(report) == ["not-reproducible"] and report.A is None and report.largest_dt is None
    for read in (lambda: report.plant, lambda: report.sampled_plant, lambda: report.advise(LQR([1, 1], [1]))):
        with pytest.raises(ValueError, match="step"):
            read()


def test_the_same_noise_in_all_environments_is_found():
    rng = np.random.default_rng(0)
    report = audit(lambda states, actions, dt: pendulums(states, actions + rng.normal(), dt), batched=True)
    assert kinds(report) == ["not-reproducible", "same-noise"]


def test_noise_of_each_environment_is_random_and_not_the_same():
    rng = np.random.default_rng(0)
    report = audit(lambda states, actions, dt: pendulums(states, actions + rng.normal(size=actions.shape), dt), batched=True)
    assert kinds(report) == ["not-reproducible"]


def test_a_generator_that_environments_share_is_found_by_a_restart_and_one_for_each_is_not():
    class Noisy:
        def __init__(self, shared):
            self.shared = shared
            self.restart()

        def restart(self):
            self.rng = np.random.default_rng(0)
            self.own = [np.random.default_rng(number) for number in range(4096)]

        def __call__(self, states, actions, dt):
            n = len(states)
            noise = self.rng.normal(size=(n, 1)) if self.shared else np.array([[rng.normal()] for rng in self.own[:n]])
            return pendulums(states, actions + noise, dt)

    for shared, expected in ((True, ["not-reproducible", "shared-generator"]), (False, ["not-reproducible"])):
        noisy = Noisy(shared)
        assert kinds(audit(noisy, batched=True, restart=noisy.restart)) == expected


@pytest.mark.parametrize("returns_single", [False, True])
def test_single_precision_inside_is_found(returns_single):
    def single(x, u, dt):
        v = np.float32(x[1]) + np.float32(dt) * (-np.float32(OMEGA2) * np.sin(np.float32(x[0])) + np.float32(u[0]))
        after = np.array([np.float32(x[0]) + np.float32(dt) * v, v], dtype=np.float32)
        return after if returns_single else after.astype(float)

    report = audit(single)
    assert "single-precision" in kinds(report) and not report.holds


def test_a_step_that_ignores_dt_and_a_state_that_is_no_equilibrium_are_found():
    assert kinds(audit(lambda x, u, dt: pendulum(x, u, DT))) == ["ignores-dt"]
    report = audit(pendulum, x=(0.5, 0.0))
    assert kinds(report) == ["no-equilibrium"] and report.holds
    assert kinds(audit(pendulum, x=(0.5, 0.0), equilibrium=False)) == []


def test_a_step_that_hides_a_state_is_found():
    total = [0.0]

    def hidden(x, u, dt):
        total[0] = 0.999 * total[0] + u[0]
        return pendulum(x, [u[0] + total[0]], dt)

    assert {"hidden-state", "not-reproducible"} & set(kinds(audit(hidden)))


def test_an_energy_that_diverges_in_the_run_of_the_audit_is_a_fault():
    def hardening(x, u, dt):
        return [x[0] + dt * x[1], x[1] - dt * (10 * x[0] + x[0] ** 3)]

    def own(x):
        return x[1] ** 2 / 2 + 5 * x[0] ** 2 + x[0] ** 4 / 4

    report = probe(hardening, [1, 0], [], 0.05, energy=own, conservative=True, equilibrium=False)
    assert kinds(report) == ["energy-drift"] and not report.holds and "No fault" not in report.answer
    assert report.verdict == {"outcome": "fault", "evidence": report.findings[0]["text"], "not_examined": ["stability along the motion"]}


@pytest.mark.parametrize("count", [math.floor, lambda parts: max(1, round(parts)), lambda parts: math.ceil(parts - 1e-9)])
def test_a_fixed_inner_step_has_no_rates_of_a_system(count):
    def decay(x, u, dt):
        return [x[0] * 0.99 ** count(dt / 0.01 + 1e-12)]

    report = probe(decay, [0.0], [], 0.05)
    assert kinds(report) == ["fixed-inner-step"] and report.modes[0]["flow"] is None and report.largest_dt is None
    assert "the system that the step approximates is unknown" in report.answer


def test_a_step_beyond_its_limit_is_found():
    report = audit(pendulum, dt=0.7)
    assert kinds(report)[-1] == "unstable-step" and report.largest_dt == pytest.approx(2 / 3, rel=1e-6)


# ------------------------------------------------------------------ other systems


def test_an_exact_step_is_exact():
    c, s = lambda t: math.cos(3 * t), lambda t: math.sin(3 * t)

    def exact(x, u, dt):
        return [c(dt) * x[0] + s(dt) / 3 * x[1], -3 * s(dt) * x[0] + c(dt) * x[1]]

    report = audit(exact, u=(), conservative=True)
    assert report.findings == [] and report.results["order"]["is_exact"]
    assert max(abs(damping) for damping in report.numerical_damping) < 1e-9
    with pytest.raises(ValueError, match="no actions"):
        report.plant


def test_a_system_of_first_order_has_its_integrator_and_its_limit():
    report = audit(lambda x, u, dt: [x[0] + dt * (-5 * x[0] + u[0])], x=(0.0,))
    assert report.findings == [] and "explicit-euler" in report.integrators
    # |1 − 5 dt| = 1. A growth of 1e-5 per step shifts it by 5e-6.
    assert report.largest_dt == pytest.approx(0.4, rel=1e-5)


def test_a_chaotic_system_on_its_motion_has_no_fault():
    def lorenz(x, u, dt):
        def f(x):
            return np.array([10 * (x[1] - x[0]), x[0] * (28 - x[2]) - x[1], x[0] * x[1] - 8 / 3 * x[2]])

        k1 = f(x)
        k2 = f(x + dt / 2 * k1)
        k3 = f(x + dt / 2 * k2)
        return x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + f(x + dt * k3))

    report = audit(lorenz, x=(1.0, 2.0, 20.0), u=(), dt=0.005, equilibrium=False)
    assert [kind for kind in kinds(report) if kind != "nonlinear"] == [] and report.integrators == ["rk4"] and report.order == 4


def test_scales_from_tiny_to_huge_give_the_same_matrices():
    def scaled(x, u, dt):
        return [1e9 * value for value in pendulum([x[0] / 1e9, x[1] / 1e9], [u[0] * 1e-6], dt)]

    report = audit(scaled, x=(0.0, 0.0), u=(0.0,), state_scale=1e9, action_scale=1e6)
    assert report.findings == []
    assert report.A == pytest.approx(np.array([[1 - OMEGA2 * DT**2, DT], [-OMEGA2 * DT, 1.0]]), abs=1e-10)


# ------------------------------------------------------------------ functions of all kinds


def test_a_step_may_change_its_arguments_and_return_the_same_array_again():
    buffer = np.empty(2)

    def careless(x, u, dt):
        buffer[:] = pendulum(x, u, dt)
        x[:], u[:] = np.nan, np.nan
        return buffer

    report = audit(careless)
    assert report.findings == [] and report.A.tolist() == audit(pendulum).A.tolist()

    def careless_batch(states, actions, dt):
        states[:] = pendulums(states, actions, dt)
        actions[:] = np.nan
        return states

    assert audit(careless_batch, batched=True).findings == []


def test_lists_tuples_integers_and_objects_of_numbers_are_results():
    assert audit(lambda x, u, dt: tuple(pendulum(x, u, dt))).findings == []
    assert audit(lambda x, u, dt: np.array(pendulum(x, u, dt), dtype=object)).findings == []
    # A counter that is an integer has no derivative, but is no error.
    assert audit(lambda x, u, dt: [int(round(x[0])), x[1]]).A is not None


def test_an_exception_of_the_step_is_raised_as_it_is():
    class Broken(Exception):
        pass

    def broken(x, u, dt):
        raise Broken("joint 3")

    for keywords in ({}, {"batched": True}):
        with pytest.raises(Broken, match="joint 3"):
            audit(broken, **keywords)
    for name in ("energy", "observe"):
        with pytest.raises(Broken, match="joint 3"):
            audit(pendulum, **{name: lambda x: broken(x, None, None)})


X, U = (0.0, 0.0), (0.0,)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: probe(pendulum, X, U), TypeError, "dt is missing; expected the length"),
        (lambda: probe(pendulum, X, U, 0), ValueError, r"dt is 0\.0, but it must be finite and greater than 0"),
        (lambda: probe(pendulum, X, U, -0.1), ValueError, r"dt is -0\.1"),
        (lambda: probe(pendulum, X, U, math.nan), ValueError, "dt is nan"),
        (lambda: probe(pendulum, X, U, "0.1"), TypeError, "dt must be a number, not str"),
        (lambda: probe(3, X, U, DT), TypeError, "step is a int; expected a function"),
        (lambda: audit(pendulum, energy=3), TypeError, "energy is a int; expected a function"),
        (lambda: audit(pendulum, observe="x"), TypeError, "observe is a str; expected a function"),
        (lambda: audit(pendulum, x=(0.0, math.nan)), ValueError, r"state\[1\] is nan; expected finite numbers"),
        (lambda: audit(pendulum, x=[[0.0, 0.0]]), ValueError, r"state has shape \(1, 2\); expected one dimension"),
        (lambda: audit(pendulum, x=("a", "b")), TypeError, "state is .*; expected real numbers"),
        (lambda: audit(pendulum, x=None), TypeError, "state is None; expected real numbers"),
        (lambda: audit(pendulum, u=(math.inf,)), ValueError, r"action\[0\] is inf"),
        (lambda: audit(lambda x, u, dt: x, x=np.zeros(101), u=()), ValueError, "`state` has 101 numbers; expected 1 to 100 numbers"),
        (lambda: audit(lambda x, u, dt: x, x=(), u=()), ValueError, "`state` has 0 numbers; expected 1 to 100"),
        (lambda: audit(lambda x, u, dt: None), TypeError, r"step returned None; expected numbers of shape \(2,\)"),
        (lambda: audit(lambda x, u, dt: [None, 1.0]), TypeError, "the result of step is .*; expected real numbers"),
        (lambda: audit(lambda x, u, dt: [1j, 1.0]), TypeError, "the result of step is .*; expected real numbers"),
        (lambda: audit(lambda x, u, dt: {"q": 1}), TypeError, "the result of step is .*; expected real numbers"),
        (lambda: audit(lambda x, u, dt: x[:1]), ValueError, r"step returned an array of shape \(1,\); expected \(2,\)"),
        (lambda: audit(lambda x, u, dt: [x]), ValueError, r"step returned an array of shape \(1, 2\); expected \(2,\)"),
        (lambda: audit(lambda x, u, dt: x * math.nan), ValueError, "has NaN in `x1`; expected finite numbers"),
        (lambda: audit(lambda x, u, dt: x[:1], batched=True), ValueError, r"step returned an array of shape .*; expected \(7, 2\)"),
        (lambda: audit(pendulum, energy=lambda x: x), ValueError, r"energy returned an array of shape \(2,\); expected a number"),
        (lambda: audit(pendulum, energy=lambda x: None), TypeError, "the result of energy is None; expected real numbers"),
        (lambda: audit(pendulums, batched=True, energy=lambda x: x), ValueError, r"energy returned an array of shape .*; expected \(1,\)"),
        (lambda: audit(pendulum, energy=lambda x: math.nan), ValueError, "energy returned nan at the given state; expected a finite number"),
        (lambda: audit(pendulums, batched=True, energy=lambda x: x[:, 0] + math.inf), ValueError, "energy returned inf at the given state"),
        (lambda: audit(pendulum, observe=lambda x: [1.0, math.nan]), ValueError, r"observe returned nan in component 1 for the state \[0\.0, 0\.0\]"),
        (lambda: audit(pendulum, observe=lambda x: []), ValueError, r"observe returned an array of shape \(0,\); expected at least one number"),
        (lambda: audit(pendulums, batched=True, observe=lambda x: x[:, :0]), ValueError, r"observe returned an array of shape \(1, 0\)"),
        (lambda: audit(pendulum, observe=lambda x: x[: 1 + (x[0] != 0)]), ValueError, "observe returned 2 numbers .*, but 1 at the first"),
        (lambda: audit(pendulum, states=["a", "(m)"]), ValueError, r"states\[1\] is '\(m\)'; expected a name, or a name and its unit"),
        (lambda: audit(pendulum, states=["", "b"]), ValueError, r"states\[0\] is ''; expected a name"),
        (lambda: audit(pendulum, inputs=[" "]), ValueError, r"inputs\[0\] is ' '; expected a name"),
        (lambda: audit(pendulum, states=["a"]), ValueError, "`states` has 1 name; expected 2, one for each"),
        (lambda: audit(pendulum, states="ab"), TypeError, "states is the string 'ab'; expected a list of strings"),
        (lambda: audit(pendulum, states=[1, 2]), TypeError, "states has a int; expected strings"),
        (lambda: audit(pendulum, states=["a (m)", "a (m/s)"]), ValueError, "`states` has `a` twice; expected different names"),
        (lambda: audit(pendulum, notes="text"), TypeError, "notes is the string 'text'"),
        (lambda: audit(pendulum, state_scale=[1.0]), ValueError, "`state_scale` has 1 number; expected 2"),
        (lambda: audit(pendulum, state_scale=0.0), ValueError, "`state_scale` is 0 for `x1`; expected finite numbers above 0"),
        (lambda: audit(pendulum, action_scale=math.inf), ValueError, r"action_scale\[0\] is inf"),
        (lambda: audit(pendulum, pairs=[(0, 2)]), ValueError, r"pairs has \(0, 2\); expected two different numbers from 0 to 1"),
        (lambda: audit(pendulum, pairs=[(0, -1)]), ValueError, r"pairs has \(0, -1\)"),
        (lambda: audit(pendulum, pairs=[0, 1]), ValueError, "pairs has 0; expected the numbers of a position and of its velocity"),
        (lambda: audit(pendulum, pairs=[(0, 1), (0, 1)]), ValueError, "expected each state in one pair"),
        (lambda: audit(pendulum, mass=[[1.0]]), ValueError, "mass requires pairs"),
        (lambda: audit(pendulum, pairs=[(0, 1)], mass=np.eye(2)), ValueError, r"mass has shape \(2, 2\); expected 1 × 1"),
        (lambda: audit(pendulum, pairs=[(0, 1)], mass=-1), ValueError, r"mass\[0, 0\] is -1\.0; expected a number above 0"),
        (lambda: audit(pendulum, pairs=[(0, 1)], mass=math.nan), ValueError, r"mass\[0, 0\] is nan; expected finite numbers"),
        (lambda: audit(pendulum, equilibrium="yes"), TypeError, "equilibrium is 'yes'; expected True, False or None"),
        (lambda: audit(pendulum, threads=1), ValueError, "threads is 1, but it must be 2 to 64"),
        (lambda: audit(pendulum, threads=65), ValueError, "threads is 65, but it must be 2 to 64"),
        (lambda: audit(pendulum, threads=2.0), TypeError, "threads must be an integer, not float"),
        (lambda: audit(pendulum, threads=True), TypeError, "threads must be an integer, not bool"),
        (lambda: audit(pendulum, bathced=True), TypeError, "did you mean 'batched'"),
    ],
)
def test_an_error_names_the_value_and_what_is_allowed(call, error, message):
    with pytest.raises(error, match=message):
        call()


def test_an_inertia_is_symmetric_and_positive_definite_in_any_units():
    def masses(x, u, dt):
        v = x[2:] - dt * 9.0 * x[:2]
        return np.concatenate([x[:2] + dt * v, v])

    def of(mass):
        return audit(masses, x=np.zeros(4), u=(), pairs=[(0, 2), (1, 3)], mass=mass)

    for mass, message in (
        ([[2.0, 0.5], [0.25, 2.0]], r"mass\[0, 1\] is 0\.5, but mass\[1, 0\] is 0\.25; expected a symmetric matrix"),
        ([[1.0, 2.0], [2.0, 1.0]], "mass has the eigenvalue -1; expected a positive definite matrix"),
        ([[1.0, 1.0], [1.0, 1.0]], "expected a positive definite matrix"),
        ([1.0, 0.0], r"mass\[1, 1\] is 0\.0; expected a number above 0"),
    ):
        with pytest.raises(ValueError, match=message):
            of(mass)
    for mass in ([1e12, 1e-12], [[1e12, 0.5], [0.5, 1e-12]], [[2.0, 0.1 + 0.2], [0.3, 2.0]]):
        assert of(mass).holds
    # One of a host is checked too.
    host = Host(pendulums, np.zeros(2), np.zeros(1), DT, ("q", "v"), ("u",), "host", "", mass=np.array([[-1.0]]), positions=((0, 1),))
    with pytest.raises(ValueError, match=r"mass\[0, 0\] is -1\.0"):
        probe.host(host)
    with pytest.raises(ValueError, match=r"inputs\[0\] is ''"):
        probe.host(dataclasses.replace(host, mass=None, inputs=("",)))
    with pytest.raises(ValueError, match="energy returned nan"):
        probe.host(dataclasses.replace(host, mass=None, energy=lambda x: x[:, 0] * math.nan))


# ------------------------------------------------------------------ reports


def test_a_report_is_saved_as_a_page_and_as_numbers(tmp_path):
    report = audit(pendulum, title="my pendulum", states=["angle (rad)", "rate (rad/s)"])
    report.save(tmp_path / "report.html")
    report.save(str(tmp_path / "report.json"))
    assert "my pendulum" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["states"] == ["angle (rad)", "rate (rad/s)"]
    assert report.answer in repr(report) and report.plant.states == ["angle (rad)", "rate (rad/s)"]


def test_the_same_audit_has_the_same_results():
    assert audit(pendulum).results == audit(pendulum).results


def test_a_host_with_rows_that_depend_on_each_other_is_found():
    def mixed(states, actions, dt):
        after = pendulums(states, actions, dt)
        after[:, 1] += 1e-12 * len(states)
        return after

    host = Host(mixed, np.zeros(2), np.zeros(1), DT, ("q", "v"), ("u",), "mixed", "")
    assert "bits-differ" in kinds(probe.host(host)) and libration.probe is probe


def test_the_complex_step_is_the_matrix_of_the_step_unless_differences_differ():
    def pendulum(x, u, dt):
        v = x[1] + dt * (-9 * np.sin(x[0]) + u[0])
        return np.array([x[0] + dt * v, v])

    h = 0.01
    report = probe(pendulum, [0.0, 0.0], [0.0], h, complex_step=True)
    assert report.findings == []
    # Eight roundings.
    assert np.allclose(report.A, [[1 - 9 * h * h, h], [-9 * h, 1]], rtol=8 * 2.0**-52, atol=0) and report.jacobian_error < 2e-15
    # The absolute value drops the imaginary part.
    report = probe(lambda x, u, dt: pendulum(x, u, dt) - dt * np.abs(x - 3), [0.0, 0.0], [0.0], h, complex_step=True, equilibrium=False)
    assert [finding["kind"] for finding in report.findings] == ["derivatives-differ"]
    assert abs(report.A[1, 1] - (1 + h)) < 1e-10
    with pytest.raises(TypeError, match="step returned float64 for complex numbers"):
        probe(lambda x, u, dt: pendulum(x.real, u.real, dt), [0.0, 0.0], [0.0], h, complex_step=True)
