"""Gains of servos: limits by theory, by matrices and of MuJoCo models."""

import json
import math

import numpy as np
import pytest

import libration
from libration import gains

DT = 0.01
# Limits of a few joints are searched to 1e-13 of their size.
CLOSE = 1e-12


def test_a_servo_without_damping_has_the_limit_of_symplectic_euler():
    report = gains(2.0, 100.0, dt=DT)
    # kp dt²/M = 4.
    assert report.largest_factor == pytest.approx(4 * 2.0 / DT**2 / 100.0, rel=CLOSE) and report.holds
    assert report.largest_kp == {"joint 1": pytest.approx(4 * 2.0 / DT**2, rel=CLOSE)}


def test_explicit_damping_lowers_the_limit_and_implicit_damping_raises_it():
    inertia, kv = 1.0, 20.0
    limit = {
        # (4 − 2 d) M/dt² with d = kv dt/M, and (4 + 2 d) M/dt².
        "symplectic-euler": (4 - 2 * kv * DT / inertia) * inertia / DT**2,
        "implicitfast": (4 + 2 * kv * DT / inertia) * inertia / DT**2,
    }
    for integrator, kp in limit.items():
        assert gains(inertia, 10.0, kv, dt=DT, integrator=integrator).largest_kp["joint 1"] == pytest.approx(kp, rel=CLOSE)


def test_eulers_step_of_mujoco_treats_damping_of_joints_implicitly_and_that_of_servos_explicitly():
    of_joint = gains(1.0, 10.0, damping=20.0, dt=DT, integrator="Euler")
    of_servo = gains(1.0, 10.0, 20.0, dt=DT, integrator="Euler")
    assert of_joint.largest_factor == pytest.approx((4 + 0.4) / DT**2 / 10, rel=CLOSE)
    assert of_servo.largest_factor == pytest.approx((4 - 0.4) / DT**2 / 10, rel=CLOSE)


def test_the_limit_of_coupled_joints_is_that_of_their_fastest_mode():
    mass = np.array([[2.0, 0.6], [0.6, 0.5]])
    kp = np.diag([300.0, 80.0])
    fastest = np.max(np.linalg.eigvals(np.linalg.solve(mass, kp)).real)
    report = gains(mass, kp, dt=DT, joints=["shoulder (rad)", "elbow (rad)"])
    assert report.largest_factor == pytest.approx(4 / DT**2 / fastest, rel=CLOSE)
    assert [joint["name"] for joint in report.joints] == ["shoulder", "elbow"]
    # All others as they are: the limit of one joint is above that of all together.
    assert report.largest_kp["elbow"] > report.largest_factor * 80


def test_a_verdict_has_no_threshold_and_no_range_of_sizes():
    # det = 1 + kp dt²/2 of a torque held on a free mass.
    held = gains(1.0, 1e-5, dt=0.1, integrator="rk4", held_torque=True)
    assert not held.holds and held.largest_factor == 0
    assert held.results["spectral_radius_minus_one"] == pytest.approx(2.5e-8, rel=1e-7)
    # kp < 2 (2 − kv dt)/dt² = 2.
    beyond = gains(1.0, 2.00001, 19.9, dt=0.1)
    assert not beyond.holds and beyond.largest_kp == {"joint 1": pytest.approx(2, rel=CLOSE)}
    tiny = gains(1e-300, 1.0, dt=1e-200)
    assert tiny.holds and tiny.largest_kp == {"joint 1": pytest.approx(4e100, rel=CLOSE)}


def test_no_limit_is_beside_an_unknown_verdict():
    # Forces across two equal joints make their motion grow by less than rounding.
    report = gains([1.0, 1.0], [[1, 1e-12], [-1e-12, 1]], dt=DT)
    assert report.verdict["outcome"] == "unknown" and not report.holds
    assert math.isnan(report.largest_factor) and all(map(math.isnan, report.largest_kp.values()))


def test_substeps_and_other_integrators_hold_gains_that_do_not():
    report = gains(1.0, 5e4, 2.0, dt=DT)
    assert not report.holds and report.fewest_substeps == 2 and "do not hold" in report.answer
    assert gains(1.0, 5e4, 2.0, dt=DT, substeps=2).holds
    rows = {row["name"]: row for row in report.integrators}
    assert rows["backward-euler"]["holds"] and rows["backward-euler"]["largest_factor"] is None
    assert gains(1.0, 5e4, dt=DT, integrator="backward-euler").largest_factor == math.inf


def test_a_report_is_saved(tmp_path):
    report = gains([1.0, 2.0], [10.0, 20.0], dt=DT)
    report.save(tmp_path / "gains.html")
    report.save(tmp_path / "gains.json")
    assert "How much does each joint allow?" in (tmp_path / "gains.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "gains.json").read_text(encoding="utf-8"))["holds"] is True
    assert report.answer in repr(report) and report.modes[0]["turn"] > 0 and libration.gains is gains


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: gains(1.0, 1.0), TypeError, "dt"),
        (lambda: gains(1.0, 1.0, dt=0), ValueError, r"dt is 0\.0, but it must be finite and greater than 0"),
        (lambda: gains(None, 1.0, dt=DT), TypeError, "mass is None; expected real numbers"),
        (lambda: gains(1.0, 1j, dt=DT), TypeError, "kp is 1j; expected real numbers"),
        (lambda: gains([[1, 2], [1]], [1, 2], dt=DT), TypeError, r"mass is \[\[1, 2\], \[1\]\]; expected real numbers"),
        (lambda: gains(1.0, 1.0, math.inf, dt=DT), ValueError, r"kv\[0\] is inf; expected finite numbers"),
        (lambda: gains(np.ones((1, 1, 1)), 1.0, dt=DT), ValueError, r"mass has shape \(1, 1, 1\); expected a number for each joint"),
        (lambda: gains([1.0, 2.0], [1.0], dt=DT), ValueError, "`kp` has 1 number; expected 2 numbers, or 2 × 2"),
        (lambda: gains([[1.0, 0.5], [0.0, 1.0]], [1.0, 1.0], dt=DT), ValueError, "`mass` is not symmetric: 0.5 and 0 for"),
        (lambda: gains(-1.0, 1.0, dt=DT), ValueError, "`mass` is -1 for `joint 1`; expected numbers above 0"),
        (lambda: gains([], [], dt=DT), ValueError, "`mass` is that of 0 joints; expected 1 to 50 joints"),
        (lambda: gains(np.ones(51), np.ones(51), dt=DT), ValueError, "`mass` is that of 51 joints; expected 1 to 50"),
        (lambda: gains(1.0, 1.0, dt=DT, substeps=0), ValueError, "substeps is 0, but it must be 1 to 1000"),
        (lambda: gains(1.0, 1.0, dt=DT, substeps=1.5), TypeError, "substeps must be an integer"),
        (lambda: gains(1.0, 1.0, dt=DT, integrator="implicitfas"), ValueError, "unknown integrator `implicitfas`: did you mean `implicitfast`"),
        (lambda: gains(1.0, 1.0, dt=DT, integrator=3), TypeError, "integrator must be a string, not int"),
        (lambda: gains([1.0, 1.0], [1.0, 1.0], dt=DT, joints="ab"), TypeError, "joints is the string 'ab'; expected a list of strings"),
        (lambda: gains([1.0, 1.0], [1.0, 1.0], dt=DT, joints=[1, 2]), TypeError, "joints has a int; expected strings"),
        (lambda: gains([1.0, 1.0], [1.0, 1.0], dt=DT, joints=["a", "a"]), ValueError, "joints has 'a' twice; expected different names"),
        (lambda: gains([1.0, 1.0], [1.0, 1.0], dt=DT, joints=["a"]), ValueError, "`joints` has 1 name; expected 2"),
        (lambda: gains(1.0, 1.0, dt=DT, substep=2), TypeError, "did you mean 'substeps'"),
    ],
)
def test_an_error_names_the_value_and_what_is_allowed(call, error, message):
    with pytest.raises(error, match=message):
        call()
