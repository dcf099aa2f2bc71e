"""Audits of energies of simulations in NumPy."""

import json

import numpy as np
import pytest

import libration


def verlet(dt: float, curl: float = 0.0, duration: float = 200.0):
    """A particle in a plane, on springs, with a force that is no gradient."""
    force = lambda q: -q + curl * np.array([-q[1], q[0]])
    q, v = np.array([1.0, 0.3]), np.array([0.2, 0.7])
    energies = [0.5 * (q @ q + v @ v)]
    for _ in range(round(duration / dt)):
        v = v + 0.5 * dt * force(q)
        q = q + dt * v
        v = v + 0.5 * dt * force(q)
        energies.append(0.5 * (q @ q + v @ v))
    return dt * np.arange(len(energies)), energies


def test_a_clean_simulation_has_order_2_and_no_fault(tmp_path):
    report = libration.audit_energy([verlet(dt) for dt in (0.2, 0.1)], dt=[0.2, 0.1], horizon=1000)
    assert report.holds and report.findings == []
    # The next order of the size is (dt/2)²/4: 0.5 % at dt = 0.2.
    assert report.results["oscillation_law"]["exponent"]["value"] == pytest.approx(2, abs=0.02)
    assert report.largest_dt["low"] <= report.largest_dt["dt"] <= report.largest_dt["high"]
    report.save(tmp_path / "audit.html")
    report.save(tmp_path / "audit.json")
    assert "libration audit" in (tmp_path / "audit.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "audit.json").read_text())["drift_cause"] == "unresolved"


def test_without_time_steps_there_is_no_largest_step():
    report = libration.audit_energy([verlet(dt) for dt in (0.2, 0.1)])
    assert report.largest_dt is None and "dt assumed" in report.answer


def test_a_force_with_curl_is_named():
    report = libration.audit_energy([verlet(dt, curl=1e-4) for dt in (0.2, 0.1)])
    assert not report.holds
    assert report.findings[0]["kind"] == "step-independent-drift"


def test_a_stated_tolerance_is_judged_and_an_exceeded_one_does_not_hold():
    traces, steps = [verlet(dt) for dt in (0.2, 0.1)], [0.2, 0.1]
    assert libration.audit_energy(traces, dt=steps).tolerance_verdict is None
    # The energy deviates by about dt²/4 of itself: 1e-2 and 2.5e-3.
    exceeded = libration.audit_energy(traces, dt=steps, tolerance=1e-6)
    assert exceeded.tolerance_verdict["outcome"] == "exceeds" and not exceeded.holds
    assert exceeded.verdict["outcome"] == "no-fault"
    kept = libration.audit_energy(traces, dt=steps, tolerance=0.02)
    assert kept.tolerance_verdict["outcome"] == "within" and kept.holds
    # Relative to a stated energy, whatever the constant of the potential.
    raised = [(t, np.asarray(energies) + 1000) for t, energies in traces]
    assert libration.audit_energy(raised, dt=steps, tolerance=0.02, scale=0.8).holds
    assert not libration.audit_energy(raised, dt=steps, tolerance=1e-4, scale=0.8).holds


@pytest.mark.parametrize(
    ("traces", "dt", "message"),
    [
        ([verlet(0.2)], None, "expected at least 2"),
        ([verlet(0.2), verlet(0.2)], None, "the same time step"),
        ([verlet(0.2), verlet(0.1)], [0.1], "expected one for each of 2 traces"),
        ([verlet(0.2), ([1, 2], [1, 2])], None, "has 2 samples"),
        ([verlet(0.2), (np.arange(200), np.full(200, np.nan))], None, "expected a finite number"),
    ],
)
def test_unusable_traces_are_refused_with_the_reason(traces, dt, message):
    with pytest.raises(ValueError, match=message):
        libration.audit_energy(traces, dt=dt)
