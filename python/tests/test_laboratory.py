"""Theory, advice, the laboratory and data sets from Python."""

import copy
import json
import math
import os
import pickle
import signal
import threading

import numpy as np
import pytest

import libration
from libration import LQR, PD, PID, Gaussian, Observer, Steps, System, Uniform, advise, analyze, run_lab

SPRING = System("oscillator", omega2=10.0)


def test_theory_of_a_step_has_the_parts_of_the_program_s_json():
    answer = analyze(SPRING, integrator="velocity-verlet", dt=0.01, max_drift=1e-3)
    # The trace of the matrix is 2 − z², z = ωΔt; it is stable up to z = 2.
    assert answer.trace == pytest.approx(2 - 10.0 * 0.01**2, rel=1e-15)
    assert answer["determinant_minus_one"] == 0.0
    assert answer["stability_windows"][0][1] == pytest.approx(2 / math.sqrt(10), rel=1e-14)
    assert answer.largest_dt["energy_drift"] > 0.01
    assert "trace" in repr(answer) and "<table>" in answer._repr_html_()
    with pytest.raises(AttributeError, match="trase"):
        answer.trase


def test_a_latency_that_theory_forbids_is_one_that_a_simulation_does_not_stand():
    loop = {"integrator": "exact", "dt": 0.01, "feedback": PD(10.0, 2.0)}
    # Where a command that arrives within a step splits it, as it does in the simulation.
    critical = analyze(SPRING, **loop).critical_latency_split_steps * 0.01
    for latency, stands in ((0.97 * critical, True), (1.03 * critical, False)):
        path = libration.simulate(SPRING, **loop, latency=latency, steps=20_000, save_every=20_000)
        assert (path.energy[-1] < path.energy[0]) == stands


def test_the_radius_of_the_plant_and_that_of_the_loop_have_names_of_their_own():
    loop = {"integrator": "exact", "dt": 0.0608, "feedback": (23.97, 2.47), "latency": Steps(0.5)}
    plant = System("oscillator", omega2=15.98)
    answer = analyze(plant, **loop, jitter=Gaussian(0.068), loss=0.41)
    assert answer.spectral_radius == 1.0
    assert answer.closed_loop_spectral_radius == pytest.approx(0.972274008985203, rel=1e-14)
    # By NumPy: tools/loop_reference.py.
    assert answer.mean_square_growth == pytest.approx(0.0281475368382684, rel=1e-10)
    assert answer.lyapunov_exponent is None


def test_textbook_verlet_is_said_to_be_another_method_where_forces_depend_on_velocities():
    step = {"integrator": "textbook-verlet", "dt": 0.01}
    assert "another method" in analyze("damped-oscillator", **step).note
    for work in (
        lambda: libration.simulate("damped-oscillator", **step, steps=3),
        lambda: libration.Ensemble("damped-oscillator", **step, q=[[0.5]]),
    ):
        with pytest.warns(UserWarning, match="another method"):
            work()
    # Where nothing is to be said of it a warning would fail the test.
    libration.simulate("oscillator", **step, steps=3)


def test_jitter_skew_loss_and_cost_are_answered():
    answer = analyze(
        SPRING,
        integrator="exact",
        dt=0.01,
        feedback=(10.0, 2.0),
        latency=0.01,
        jitter=Uniform(0.1),
        skew=Gaussian(0.01),
        loss=0.1,
        cost_weights=(5.0, 0.5, 0.0),
    )
    assert answer.mean_square_radius < 1 and answer.cost > 0


@pytest.mark.parametrize(
    "change, told",
    [
        ({"max_drift": 0.0}, "max_drift"),
        ({"system": "kepler", "max_drift": 0.1}, "max_drift requires"),
        ({"system": "kepler", "integrator": "exact"}, "integrator"),
        ({"feedback": (1.0, 1.0), "loss": 1.0}, "loss"),
        ({"feedback": (1.0, 1.0), "cost_weights": (1.0, 1.0)}, "cost_weights"),
        ({"system": lambda q, v: -q}, "CustomSystem"),
        ({"steps": 10**16}, "steps"),
    ],
)
def test_what_theory_does_not_answer_is_refused_in_the_words_of_python(change, told):
    asked = {"system": "oscillator", "integrator": "rk4", "dt": 0.01, **change}
    with pytest.raises((TypeError, ValueError), match=told) as raised:
        analyze(asked.pop("system"), **asked)
    assert "--" not in str(raised.value)


def test_advice_says_what_a_loop_stands_and_can_be_asked_again_on_the_command_line(tmp_path):
    told = []
    loop = {"period": 0.05, "latency": 0.05, "jitter": 0.05}
    good = advise(SPRING, PD(10.0, 2.0), **loop, progress=lambda *a: told.append(a))
    assert good.holds and good["loop"]["budgets"] and "latency" in good.answer.lower()
    assert told and all(0 <= part <= 1 for part, _ in told)
    bad = advise(SPRING, (10.0, 2.0), latency=0.2, period=0.05)
    assert not bad.holds
    file = tmp_path / "asked.toml"
    file.write_text(good.request)
    again = advise(config=file)
    assert again["loop"]["budgets"] == good["loop"]["budgets"]


@pytest.mark.parametrize(
    "controller",
    [
        PID(10.0, 8.0, 2.0),
        LQR((10.0, 1.0, 0.1)),
        Observer(weights=(10.0, 1.0, 0.1), noise=(1.0, 1e-6)),
        Observer(gains=(10.0, 2.0), correction=(0.1, 1.0)),
    ],
    ids=lambda c: type(c).__name__,
)
def test_every_controller_is_advised_on(controller):
    assert advise(SPRING, controller, period=0.05).holds


def test_what_is_not_said_of_a_start_is_the_origin():
    assert advise("oscillator", q=[1.0, 0.5], horizon=1.0).v == [0.0, 0.0]


def test_advice_has_a_page_if_one_is_wanted(tmp_path):
    plain = advise("pendulum", tolerance=("energy", 1e-4), horizon=1.0, q=1.0)
    with pytest.raises(ValueError, match="page=True"):
        plain.save(tmp_path / "none.html")
    advise(SPRING, (10.0, 2.0), period=0.05, page=True).save(tmp_path / "page.html")
    assert "<html" in (tmp_path / "page.html").read_text().lower()


@pytest.mark.parametrize(
    "asked, error, told",
    [
        ({}, TypeError, "system"),
        ({"system": "oscillator", "config": {}}, TypeError, "config"),
        ({"system": "oscillator", "latency": 0.1}, ValueError, "controller"),
        ({"system": "oscillator", "controller": (10.0, 2.0), "period": -1.0}, ValueError, "period"),
        ({"system": "oscillator", "controller": (10.0, 2.0), "loss": 2.0}, ValueError, "loss"),
        ({"system": "oscillator", "tolerance": ("speed", 1.0)}, ValueError, "energy"),
        ({"config": {"loop": {"latncy": 1.0}}}, ValueError, "latency"),
        ({"system": "oscillator", "tolerance": 3}, TypeError, "tolerance is 3"),
        ({"system": "oscillator", "controller": 3}, ValueError, "controller is 3"),
        ({"system": "oscillator", "controller": (1.0, 2.0), "skew": Gaussian(0.1)}, TypeError, "skew"),
        ({"system": "oscillator", "controller": Observer(noise=3)}, ValueError, "noise"),
        ({"system": "oscillator", "contoller": (1.0, 2.0)}, TypeError, "did you mean 'controller'"),
    ],
)
def test_what_cannot_be_advised_on_is_refused_by_name(asked, error, told):
    with pytest.raises(error, match=told):
        advise(**asked)


def test_answers_are_copied_and_pickled():
    step = analyze(SPRING, integrator="rk4", dt=0.01)
    advice = advise(SPRING, (10.0, 2.0), period=0.05)
    for answer in (step, advice):
        for other in (copy.copy(answer), copy.deepcopy(answer), pickle.loads(pickle.dumps(answer))):
            assert type(other) is type(answer) and dict(other) == dict(answer)
    assert copy.copy(advice).holds


def test_ctrl_c_ends_a_long_analysis():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            # A nonlinear system is simulated, for minutes.
            analyze("pendulum", integrator="suzuki4", dt=0.01, steps=10**9)
        timer.join()
    finally:
        signal.signal(signal.SIGINT, before)


def test_the_laboratory_gives_findings_series_claims_and_files(tmp_path):
    told = []
    results = run_lab(
        {"spectrum": {"dt": 0.02}},
        studies=["spectrum"],
        effort="quick",
        out=tmp_path,
        progress=lambda part, what: told.append((part, what)),
    )
    assert results.json["config"]["spectrum"]["dt"] == 0.02
    assert results.findings and not results.disagreements and results.claims
    finding = results.findings[0]
    assert results[finding.id] is finding and finding.study == "spectrum" and finding.agrees
    assert results.report == tmp_path / "report.html" and results.report.stat().st_size > 0
    stored = json.loads((tmp_path / "results.json").read_text())
    assert [f["id"] for f in stored["studies"][0]["findings"]] == [f.id for f in results.findings]
    name, columns = next(iter(results.series.items()))
    assert (tmp_path / "data" / f"{name}.parquet").exists()
    assert len({len(column) for column in columns.values()}) == 1
    assert finding.id in results._repr_html_() and "agree" in repr(results)
    assert told and told[0][1].startswith("spectrum")
    frame = results.to_pandas()
    assert frame.loc[finding.id, "measured"] == finding.measured and len(frame) == len(stored["studies"][0]["findings"])


def test_without_a_folder_the_files_go_with_the_results():
    results = run_lab(studies=["spectrum"], effort="quick", progress=False)
    folder = results.folder
    assert results.report.exists()
    del results
    assert not folder.exists()


@pytest.mark.parametrize(
    "asked, error, told",
    [
        ({"studies": ["spektrum"]}, ValueError, "spectrum"),
        ({"studies": "spectrum"}, TypeError, "list"),
        ({"effort": "none"}, ValueError, "quick"),
        ({"config": {"drift": {"dt": [-1.0]}}}, ValueError, "drift.dt"),
        ({"config": {"drfit": {}}}, ValueError, "drift"),
        ({"config": 3}, TypeError, "config"),
        pytest.param(
            {"config": "/dev/zero"},
            ValueError,
            "'/dev/zero' is too long; expected at most",
            marks=pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="a device without an end"),
        ),
        ({"studies": [3]}, TypeError, "names"),
        ({"progress": 3}, TypeError, "progress"),
    ],
)
def test_what_the_laboratory_cannot_run_is_refused_by_name(asked, error, told):
    with pytest.raises(error, match=told):
        run_lab(**asked)


DATA = {"num_envs": 8, "steps": 64, "chunk": {"num_envs": 4, "steps": 16}}


def test_a_data_set_is_resumed_to_the_same_bytes_and_verified(tmp_path):
    whole = libration.datasets.write(tmp_path / "whole", DATA, format="npy", progress=False)
    assert (whole.transitions, whole.chunks) == (8 * 64, 8)
    with pytest.raises(ValueError, match="resume=True"):
        libration.datasets.write(tmp_path / "whole", DATA, format="npy")
    part = tmp_path / "part"

    class Stop(Exception):
        pass

    def stop(done, what):
        raise Stop

    with pytest.raises(Stop):
        libration.datasets.write(part, {**DATA, "steps": 1600}, format="npy", progress=stop)
    (flaw,) = libration.datasets.verify(part)
    assert "is unfinished" in flaw.what and "resume=True continues it" in flaw.what
    full = libration.datasets.write(part, {**DATA, "steps": 1600}, format="npy", resume=True)
    assert full.transitions == 8 * 1600
    assert libration.datasets.verify(part, replay=True) == []
    file = next((tmp_path / "whole").glob("reward/*.npy"))
    raw = bytearray(file.read_bytes())
    raw[-1] ^= 1
    file.write_bytes(raw)
    (flaw,) = libration.datasets.verify(tmp_path / "whole")
    assert str(flaw.path) in str(file) and not flaw.repaired


def test_a_broken_file_is_computed_again_byte_for_byte(tmp_path):
    folder = tmp_path / "whole"
    libration.datasets.write(folder, DATA, format="npy")
    file = next(folder.glob("reward/*.npy"))
    good = file.read_bytes()
    file.write_bytes(good[:-1] + bytes([good[-1] ^ 1]))
    gone = next(folder.glob("action/*.npy"))
    gone.unlink()
    flaws = libration.datasets.verify(folder, repair=True)
    assert {flaw.path for flaw in flaws} == {path.relative_to(folder) for path in (file, gone)}
    assert all(flaw.repaired for flaw in flaws)
    assert file.read_bytes() == good and libration.datasets.verify(folder) == []


def test_a_verification_without_a_replay_names_what_it_did_not_compare(tmp_path):
    libration.datasets.write(tmp_path / "set", DATA, format="npy")
    named = libration.datasets.verify(tmp_path / "set").not_examined
    assert len(named) == 2 and "settings lead to these files" in named[0] and "`ends`" in named[1]
    assert libration.datasets.verify(tmp_path / "set", replay=True).not_examined == ()


@pytest.mark.parametrize(
    "change, error, told",
    [
        ({"settings": {"num_envs": 0}}, ValueError, "num_envs"),
        ({"settings": {"stesp": 1}}, ValueError, "steps"),
        ({"format": "csv"}, ValueError, "parquet"),
        ({"shard": (3, 2)}, ValueError, "shard"),
        ({"shard": (0, 0)}, ValueError, "shard"),
        ({"transitions": 0}, ValueError, "transitions"),
        ({"format": 3}, TypeError, "format"),
        ({"shard": 3}, TypeError, "shard"),
    ],
)
def test_a_data_set_that_cannot_be_is_refused_by_name(tmp_path, change, error, told):
    with pytest.raises(error, match=told):
        libration.datasets.write(tmp_path / "none", **change)
    assert not (tmp_path / "none").exists()


def test_no_data_set_is_said_so(tmp_path):
    with pytest.raises((ValueError, OSError), match="manifest"):
        libration.datasets.verify(tmp_path)
