"""Audits of FMUs: the latency of exchanging values, and loops with it. The FMUs are compiled here."""

import dataclasses
import json
import re

import numpy as np
import pytest

fmpy = pytest.importorskip("fmpy")

from fmu import COMPILER, FAULTS, make_fmu  # noqa: E402

from libration import StateFeedback, Steps, probe  # noqa: E402
from libration.hosts import Host  # noqa: E402

pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler")

MACRO_STEP = 0.01
GAIN = np.array([[8.0, 4.0]])


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return make_fmu(tmp_path_factory.mktemp("fmu"), 2)


@pytest.fixture(scope="module")
def report(path):
    return probe.fmu(path, start_values={"x0": 0.0})


@pytest.fixture(scope="module")
def exchanged(path):
    return probe.fmu(path, kind="ModelExchange", dt=MACRO_STEP, timeout=60.0)


def latencies(advice):
    found = re.search(r'^"latency" = \[(.*)\]$', advice.request, re.MULTILINE)
    return [float(one) for one in found[1].split(",")] if found else []


def stable_up_to(advice):
    (budget,) = [one for one in advice["budgets"] if one["kind"] == "latency"]
    return budget["stable_up_to"]


def exponential(a):
    """By scaling and squaring of the series."""
    a = a / 2**10
    power, total = np.eye(len(a)), np.eye(len(a))
    for k in range(1, 20):
        power = power @ a / k
        total = total + power
    return np.linalg.matrix_power(total, 2**10)


def growth(latency):
    """The spectral radius of the loop around the oscillator, whose commands are ``latency`` seconds late.

    A macro step is ten steps of forward Euler. These are exact steps of the plant with the matrix ``log(I + A h)/h``.
    """
    a, b, h = np.array([[0.0, 1.0], [-1.0, 1.0]]), np.array([[0.0], [1.0]]), MACRO_STEP / 10
    flow = sum((-1) ** (k + 1) * np.linalg.matrix_power(a * h, k) / k for k in range(1, 12)) / h
    forced = np.zeros((3, 3))
    forced[:2, :2], forced[:2, 2:] = flow, flow @ np.linalg.solve(a, b)
    whole, late = divmod(latency, MACRO_STEP)
    whole = int(whole)
    # The command before last acts until the last one does.
    first, second = exponential(forced * late), exponential(forced * (MACRO_STEP - late))
    loop = np.zeros((3 + whole, 3 + whole))
    loop[:2, :2] = second[:2, :2] @ first[:2, :2]
    acting = [second[:2, 2:], second[:2, :2] @ first[:2, 2:]]
    # The states, then the commands of one, two, … steps ago; that of now is −K x.
    for age, column in zip((whole, whole + 1), acting):
        if age == 0:
            loop[:2, :2] -= column @ GAIN
        else:
            loop[:2, 1 + age : 2 + age] += column
    loop[2, :2] = -GAIN[0]
    loop[3:, 2:-1] = np.eye(whole)
    return np.max(np.abs(np.linalg.eigvals(loop)))


def test_the_macro_step_is_a_latency_of_the_loop(report):
    # By the limit of small steps the rate of x0 is x1, a velocity, and x1 drives itself at rest, as van der Pol's oscillator does.
    assert report.exchange_latency == MACRO_STEP and [finding["kind"] for finding in report.findings] == ["negative-damping"]
    controller = StateFeedback(GAIN)
    assert latencies(report.advise(controller)) == [MACRO_STEP]
    assert latencies(report.advise(controller, exchange=False)) == []
    assert latencies(report.advise(controller, latency=0.03)) == [0.04]
    assert latencies(report.advise(controller, latency=[Steps(2)], period=0.005)) == [0.02]
    alone = report.advise(controller, exchange=False, latency=MACRO_STEP)
    assert report.advise(controller)["growth"] == alone["growth"] != report.advise(controller, exchange=False)["growth"]
    for wrong in (-0.01, np.nan, [-0.01]):
        with pytest.raises(ValueError, match="latency is .*, but it must be finite and at least 0"):
            report.advise(controller, latency=wrong)
    with pytest.raises(ValueError, match="latency"):
        report.advise(controller, latency=[0.01, 0.02])


def test_the_critical_latency_is_that_of_the_eigenvalues(report):
    limit = stable_up_to(report.advise(StateFeedback(GAIN)))
    # The plant of the audit has the errors of differences.
    assert growth(limit - 1e-6) < 1 < growth(limit + 1e-6)
    # The growth of second moments.
    assert 2 * np.log(growth(MACRO_STEP)) == pytest.approx(report.advise(StateFeedback(GAIN))["growth"], abs=1e-8)


def test_the_latency_is_in_the_file_and_a_model_exchange_has_none(report, exchanged, tmp_path):
    report.save(tmp_path / "report.json")
    assert json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["exchange_latency"] == MACRO_STEP
    assert exchanged.exchange_latency == 0.0


def test_a_call_repeats_the_audit(path, report, exchanged):
    assert report.repeat_command == f"libration.probe.fmu({str(path)!r}, start_values={{'x0': 0.0}})" or len(str(path)) > 100
    call = f"libration.probe.fmu({str(path)!r}, kind='ModelExchange', dt={MACRO_STEP})"
    assert exchanged.repeat_command == call or len(str(path)) > 100


@pytest.mark.parametrize("version", [2, 3])
def test_inner_steps_of_a_fixed_length_leave_the_system_unknown(version, tmp_path_factory):
    inner = 'fixedInternalStepSize="0.001"' if version == 3 else ""
    made = make_fmu(tmp_path_factory.mktemp("fixed"), version, inner=inner)
    report = probe.fmu(made, dt=0.008, start_values={"x0": 0.0, "fault": FAULTS["fixed inner step"]})
    assert [finding["kind"] for finding in report.findings] == ["fixed-inner-step"]
    assert report.results["flow"] is None and report.largest_dt is None and all(mode["flow"] is None for mode in report.modes)
    # Eight steps of forward Euler of a mode that grows by 0.5 1/s: whether the system grows is not known.
    assert report.verdict["outcome"] == "unknown" and not report.holds
    stated = "the FMU states inner steps of 0.001 s: 8 of them in a macro step"
    assert (stated in report.notes) == (version == 3)


def test_equal_inner_steps_that_follow_the_length_have_the_rates_of_the_system(path):
    # Ten steps of forward Euler of 0.001 s, whose own rates are those of log(1 + h s)/h.
    report = probe.fmu(path, start_values={"x0": 0.0}, dt=0.064)
    rate = report.modes[0]["flow"]["growth_rate"]
    assert rate == pytest.approx(0.5, abs=1e-6)


def test_the_latency_of_a_host_is_finite_and_at_least_0():
    def step(states, actions, dt):
        return states + dt * (actions - states)

    host = Host(step, np.zeros(1), np.zeros(1), MACRO_STEP, ("x",), ("u",), "filter", "", exchange_latency=0.25)
    report = probe.host(host)
    assert report.exchange_latency == 0.25 and latencies(report.advise(StateFeedback([[1.0]]), latency=0.5)) == [0.75]
    for wrong in (-1.0, np.inf, np.nan):
        with pytest.raises(ValueError, match="exchange_latency is .*, but it must be finite and at least 0"):
            probe.host(dataclasses.replace(host, exchange_latency=wrong))
