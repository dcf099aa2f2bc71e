"""Reports of audits: attributes, files, and calls that repeat them."""

import json
import math

import numpy as np
import pytest

import libration
from libration import LQR, probe

DT = 0.01


def pendulum(x, u, dt):
    """Symplectic Euler."""
    v = x[1] + dt * (-9.0 * np.sin(x[0]) + u[0])
    return np.array([x[0] + dt * v, v])


@pytest.fixture(scope="module")
def report():
    return probe(pendulum, [0.0, 0.0], [0.0], DT)


@pytest.fixture(scope="module")
def random_report():
    rng = np.random.default_rng(0)
    return probe(lambda x, u, dt: pendulum(x, [u[0] + rng.normal()], dt), [0.0, 0.0], [0.0], DT)


def strict(path):
    """The JSON of a file without NaN and Infinity, which JSON does not have."""

    def refuse(constant):
        raise AssertionError(constant)

    return json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)


def test_a_step_that_was_not_linearised_has_no_numbers_of_its_matrices(random_report, report):
    assert math.isnan(random_report.spectral_radius) and random_report.jacobian_error == math.inf
    assert random_report.modes == [] and random_report.numerical_damping == [] and random_report.A is None
    for read in (lambda: random_report.plant, lambda: random_report.sampled_plant, lambda: random_report.advise(LQR([1, 1], [1]))):
        with pytest.raises(ValueError, match="^the step was not linearised; see findings$"):
            read()
    assert report.spectral_radius == pytest.approx(1.0) and report.jacobian_error < 1e-6


def test_a_number_that_is_not_finite_is_null_in_json(random_report, report, tmp_path):
    random_report.save(tmp_path / "random.json")
    assert strict(tmp_path / "random.json")["spectral_radius"] is None
    results = {**report.results, "state": [math.nan, math.inf], "bits": {"checks": [-math.inf, 1.5, True]}}
    libration.ProbeReport(results, True, "").save(tmp_path / "report.json")
    found = strict(tmp_path / "report.json")
    assert found["state"] == [None, None] and found["bits"] == {"checks": [None, 1.5, True]} and found["step"] == report.results["step"]
    gains = libration.gains(1.0, 100.0, dt=0.001)
    gains.results["dt"] = math.nan
    gains.save(tmp_path / "gains.json")
    assert strict(tmp_path / "gains.json")["dt"] is None
