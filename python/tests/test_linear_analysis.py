"""Analyses of linear plants from Python."""

import json
import types

import numpy as np
import pytest

from libration import LQR, LinearPlant, StateFeedback, Steps, analyze

A, B = np.array([[0.0, 1.0], [-25.0, -0.2]]), np.array([[0.0], [1.0]])
MASS = LinearPlant(A, B, states=["angle (rad)", "rate (rad/s)"], inputs=["torque (N m)"])
LAG = LinearPlant([[-2.0]], [[1.0]])


def step_of(analysis, name):
    (found,) = [step for step in analysis.steps if step["integrator"] == name]
    return found


def test_steps_of_a_plant_are_those_of_numpy():
    dt = 0.1
    analysis = analyze(MASS, dt=dt)
    (mode,) = analysis.modes
    assert mode["natural_frequency"] == pytest.approx(5, abs=1e-14)
    assert mode["damping_ratio"] == pytest.approx(0.02, abs=1e-15)
    matrix = np.eye(2) + dt * A + (dt * A) @ (dt * A) / 2
    for k in (3, 4):
        matrix = matrix + np.linalg.matrix_power(dt * A, k) / (6, 24)[k - 3]
    radius = np.abs(np.linalg.eigvals(matrix)).max()
    found = step_of(analysis, "rk4")
    for value in (found["predicted_spectral_radius"], found["spectral_radius"], found["simulated"]["growth"]):
        assert value == pytest.approx(radius, abs=1e-14)
    of_catalogue = analyze("damped-oscillator", integrator="suzuki4", dt=dt)
    assert set(of_catalogue) & set(analysis) <= {"schema", "dt", "steps", "verdicts"}
    one = analyze(types.SimpleNamespace(A=A, B=B, C=np.eye(2), D=np.zeros((2, 1)), dt=0), dt=dt, integrator="rk4")
    assert one.steps[0]["spectral_radius"] == found["spectral_radius"]
    assert one.steps[0]["modes"][0]["simulated"]["steps"] > 100


def test_a_loop_of_a_plant_has_the_eigenvalues_of_numpy():
    gain, period = np.array([[3.0, 1.0]]), 0.1
    plant = LinearPlant(A, B)
    loop = analyze(plant, StateFeedback(gain), period=period, latency=Steps(1)).loop
    big = np.zeros((3, 3))
    big[:2, :2], big[:2, 2:] = A * period, B * period
    power, term = np.eye(3), np.eye(3)
    for k in range(1, 30):
        term = term @ big / k
        power = power + term
    matrix = np.block([[power[:2, :2], power[:2, 2:]], [-gain, np.zeros((1, 1))]])
    radius = np.abs(np.linalg.eigvals(matrix)).max()
    assert loop["spectral_radius"] == pytest.approx(radius, abs=1e-14)
    assert loop["stable"] == (radius < 1)
    assert len(analyze(MASS, LQR([1, 1], [1])).loop["deviations"]) == 2


@pytest.mark.parametrize(
    "asked, error, message",
    [
        ({"dt": 0.0}, ValueError, "`dt` is 0.0"),
        ({"integrator": "leapfrog"}, ValueError, "integrator leapfrog requires positions and velocities.*explicit-euler, rk4, .*implicit-midpoint, trapezoid, gauss-legendre-4, gauss-legendre-6, exact"),
        ({"integrator": "midpoint"}, ValueError, "unknown integrator `midpoint`"),
        ({"steps": 10}, TypeError, "steps cannot be combined"),
        ({"max_drift": 0.1}, TypeError, "max_drift cannot be combined"),
        ({"latency": 0.1}, TypeError, "latency requires a controller"),
        ({"period": 0.1}, TypeError, "period requires a controller"),
    ],
)
def test_what_does_not_fit_a_plant_is_refused(asked, error, message):
    with pytest.raises(error, match=message) as raised:
        analyze(LAG, **asked)
    assert "--" not in str(raised.value)


def test_systems_of_the_catalogue_require_a_step_and_no_controller():
    for asked, message in [
        ({"integrator": "rk4"}, "dt is missing"),
        ({"dt": 0.1}, "integrator is missing"),
        ({"integrator": "rk4", "dt": 0.1, "period": 0.1}, "period requires a linear plant"),
    ]:
        with pytest.raises(TypeError, match=message):
            analyze("oscillator", **asked)


def test_an_analysis_is_json():
    assert json.loads(json.dumps(dict(analyze(LAG))))["steps"][0]["integrator"] == "exact"
