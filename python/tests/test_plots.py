"""Figures and tables of results: what they show, with which units, and what they need."""

import dataclasses
import os
import re
import subprocess
import sys

import numpy as np
import pytest

os.environ["MPLBACKEND"] = "Agg"

import libration
from libration import LQR, LinearPlant, System
from libration._plots import LARGEST_SHARE, share_of_allowed, with_unit

pyplot = pytest.importorskip("matplotlib.pyplot")

SPRING = System("oscillator", omega2=10.0)
PLANT = LinearPlant.mechanical(np.eye(2), 0.1 * np.eye(2), [[10.0, -10.0], [-10.0, 10.0]], [[1.0], [0.0]])
CART = System(
    acceleration={"x": "-x + u", "y": "-4*y"},
    inputs=["u"],
    start={"x": 1.0, "y": 0.5},
    units={"x": "m", "y": "rad"},
)


@pytest.fixture(autouse=True)
def closed_figures():
    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def results():
    return libration.run_lab(studies=["spectrum"], effort="quick", progress=False)


def drawn(axes):
    """The axes, after their figure was drawn: warnings are errors."""
    axes[0].figure.canvas.draw()
    return axes


def test_a_trajectory_has_a_panel_for_each_unit_with_its_columns():
    axes = drawn(libration.simulate("kepler", integrator="rk4", dt=0.01, steps=100).plot())
    assert [axis.get_ylabel() for axis in axes] == ["x, y (m)", "x', y' (m/s)", "energy (J/kg)"]
    assert [len(axis.lines) for axis in axes] == [2, 2, 1]
    assert axes[-1].get_xlabel() == "time (s)" and axes[0].get_title() == "Trajectory of 1 s"


def test_each_of_several_trajectories_is_a_line():
    for jitter in (None, 0.1):
        path = libration.simulate(SPRING, integrator="rk4", dt=0.01, steps=50, num_trajectories=3, spread=0.1, feedback=(10.0, 2.0), jitter=jitter)
        axes = drawn(path.plot())
        assert axes[0].get_title() == f"3 trajectories of {path.t.max():.6g} s"
        for n, line in enumerate(axes[0].lines):
            rows = path["trajectory"] == n
            assert np.array_equal(line.get_data(), [path.t[rows], path["q"][rows]])


def test_a_trajectory_that_overflows_is_drawn_on_a_logarithmic_axis_and_its_heading_says_where_it_ends():
    path = libration.simulate(SPRING, integrator="explicit-euler", dt=1.0, steps=1000)
    axes = drawn(path.plot())
    assert axes[0].get_title().endswith(f"not finite from t = {path.stopped['t']:g} s")
    assert [axis.get_yscale() for axis in axes] == ["log"] * 3 and axes[0].get_ylabel() == "|q| (m)"
    several = libration.simulate(SPRING, integrator="explicit-euler", dt=1.0, steps=1000, num_trajectories=2, spread=0.1)
    assert drawn(several.plot())[0].get_title().endswith("2 not finite in the end")


def test_an_analysis_of_a_step_shows_eigenvalues_stable_steps_and_stable_latencies():
    axes = drawn(libration.analyze(SPRING, integrator="velocity-verlet", dt=0.1).plot())
    assert [axis.get_xlabel() for axis in axes] == ["real part", "time step (s)", "error, in the unit of the state"]
    assert "velocity-verlet" in axes[0].get_title() and "spectral radius 1" in axes[0].get_title()
    assert axes[1].texts[0].get_text() == "0.6325"
    loop = libration.analyze(SPRING, integrator="exact", dt=0.01, feedback=(10.0, 2.0), latency=0.02)
    axes = drawn(loop.plot())
    assert axes[1].get_xlabel() == "latency (s)"
    assert float(axes[1].texts[0].get_text()) == pytest.approx(loop.critical_latency_seconds, rel=1e-3)


def test_an_analysis_whose_numbers_are_not_finite_says_so():
    axes = drawn(libration.analyze("duffing", integrator="suzuki4", dt=30.0, steps=50).plot())
    assert axes[0].get_title().endswith("spectral radius not finite")


def test_an_analysis_of_a_plant_shows_modes_of_plant_and_loop_and_the_limits_of_integrators():
    analysis = libration.analyze(PLANT, LQR([100.0, 100.0, 1.0, 1.0], [1.0]), dt=0.01, period=0.01, latency=0.004)
    modes, steps = drawn(analysis.plot())
    assert [text.get_text() for text in modes.get_legend().get_texts()] == ["plant", "closed loop"]
    assert modes.get_xlabel() == "growth rate (1/s)" and modes.get_ylabel() == "frequency (rad/s)"
    # The plant is in continuous time, so that its eigenvalues are its rates.
    shown = {complex(x, y) for x, y in zip(*modes.lines[0].get_data())}
    for mode in analysis.modes:
        assert min(abs(complex(*mode["eigenvalue"]) - other) for other in shown) < 1e-9
    labels = dict(zip([tick.get_text() for tick in steps.get_yticklabels()], [text.get_text() for text in steps.texts]))
    assert labels["backward-euler"] == "no limit" and labels["explicit-euler"] == "0.005"
    sampled = LinearPlant([[0.5, 0.1], [0.0, 0.0]], [[0.0], [1.0]], dt=0.1)
    assert len(drawn(libration.analyze(sampled).plot())) == 1


def test_an_analysis_of_equations_shows_errors_with_units_and_modes():
    step, errors, modes = drawn(libration.analyze(CART, integrator="rk4", dt=0.01, steps=100).plot())
    assert "rk4" in step.get_title() and step.get_xlabel() == "real part"
    assert [tick.get_text() for tick in errors.get_yticklabels()] == ["x (m)", "y (rad)", "x' (m/s)", "y' (rad/s)"]
    assert "rk4" in errors.get_title() and "equilibrium" in modes.get_title()


def test_a_finding_that_disagrees_is_right_of_the_line_and_named(results):
    (axis,) = drawn(results.plot())
    assert axis.get_title() == results._summary() and not axis.texts
    assert "allowed difference" in axis.get_xlabel()
    findings = list(results.findings)
    wrong = next(n for n, finding in enumerate(findings) if finding.relation == "equal" and finding.tolerance)
    far = findings[wrong].predicted + 30 * findings[wrong].tolerance
    findings[wrong] = dataclasses.replace(findings[wrong], measured=far, verdict="disagrees")
    assert share_of_allowed(findings[wrong]) == pytest.approx(30, rel=0.05)
    results.findings, kept = findings, results.findings
    (axis,) = drawn(results.plot())
    results.findings = kept
    assert [text.get_text() for text in axis.texts] == [findings[wrong].id]
    assert axis.texts[0].xy[0] == pytest.approx(30, rel=0.05)


def test_the_verdict_of_each_finding_is_on_its_side_of_the_line(results):
    judged = [finding for finding in results.findings if share_of_allowed(finding) is not None]
    assert len(judged) > 10
    for finding in judged:
        assert (share_of_allowed(finding) <= 1 + 1e-12) == finding.agrees, finding.id
    exact = dataclasses.replace(judged[0], relation="equal", tolerance=0.0, predicted=1.0, measured=2.0)
    assert share_of_allowed(exact) > LARGEST_SHARE


def test_labels_have_units_but_not_of_numbers_without_one():
    assert with_unit("energy", "rad^2 s^-2") == "energy (rad² s⁻²)"
    assert with_unit("steps", "1") == with_unit("steps", None) == "steps"


def test_without_matplotlib_the_error_says_what_to_install(monkeypatch, results):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.delitem(sys.modules, "matplotlib.pyplot")
    made = libration.simulate(SPRING, integrator="rk4", dt=0.1, steps=2), libration.analyze(SPRING, integrator="rk4", dt=0.1), results
    for result in made:
        with pytest.raises(ImportError, match=re.escape("pip install 'libration[plots]'")):
            result.plot()


def test_the_import_of_the_package_does_not_import_matplotlib():
    code = "import sys, libration; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_tables_of_notebooks_are_short_escaped_and_without_external_resources(results):
    hostile = "<script>alert(1)</script>"
    named = LinearPlant([[0.0, 1.0], [-1.0, -0.1]], [[0.0], [1.0]], inputs=[hostile])
    shown = [
        libration.simulate(CART, integrator="rk4", dt=0.01, steps=1000, num_trajectories=20)._repr_html_(),
        libration.analyze(PLANT)._repr_html_(),
        libration.analyze(named)._repr_html_(),
        libration.advise(named, LQR([1.0, 1.0], [1.0]), period=0.1, latency=0.01)._repr_html_(),
        libration.advise(SPRING, q=1.0, horizon=1.0)._repr_html_(),
        results._repr_html_(),
    ]
    for text in shown:
        assert "<table>" in text and not re.search(r"<script|http|src=|href=|@import", text)
    for text in shown[:-1]:
        assert len(text) < 6000 and text.count("<tr>") < 40
    assert "&lt;script&gt;" in shown[2] + shown[3]
    assert "x&#x27;" in shown[0] and "m/s" in shown[0] and "20 trajectories" in shown[0]
    advice = libration.advise(SPRING, (10.0, 2.0), latency=0.05)
    table = advice._repr_html_()
    assert "32.6 %" in table and "0.153" in table and "The loop is stable" in table
