"""Hosts: FMUs of FMI 2 and 3 in a process of their own. The FMUs are compiled here."""

import gc
import os
import time

import numpy as np
import pytest

fmpy = pytest.importorskip("fmpy")

from fmu import COMPILER, FAULTS, make_fmu  # noqa: E402

from libration import probe  # noqa: E402
from libration.hosts import Host, fmu_host, fmu_plant  # noqa: E402

pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler")

VERSIONS = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture(scope="module")
def make(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmu")
    return lambda version=2, **options: make_fmu(folder, version, **options)


def one(host, state=None, action=None, dt=None):
    state = host.state if state is None else np.array(state, dtype=float)
    action = host.action if action is None else np.array(action, dtype=float)
    return host.step(state[np.newaxis], action[np.newaxis], host.dt if dt is None else dt)[0]


def euler(x, u, dt, parts):
    """Steps of forward Euler of the oscillator, in the order of operations of the FMU."""
    for _ in range(parts):
        rate = np.array([x[1], 1.0 * (1 - x[0] * x[0]) * x[1] - x[0] + u[0]])
        x = x + dt / parts * rate
    return x


def simulated(path, kind, dt, state, u, **options):
    """The states after a step of FMPy."""
    start = {"x0": state[0], "x1": state[1], "u": u}
    signals = np.array([(0.0, u), (1.0, u)], dtype=[("time", float), ("u", float)])
    result = fmpy.simulate_fmu(
        str(path), fmi_type=kind, stop_time=dt, output_interval=dt, start_values=start, input=signals, output=["x0", "x1"], **options
    )
    return np.array([result["x0"][-1], result["x1"][-1]])


@VERSIONS
@pytest.mark.parametrize(("options", "note"), [({}, ""), ({"saves": False}, "each row resets the FMU: the FMU cannot save its state")])
def test_a_step_of_co_simulation_is_that_of_fmpy_and_of_its_formula_bit_for_bit(make, version, options, note):
    path = make(version, **options)
    host = fmu_host(path, kind="CoSimulation")
    assert isinstance(host, Host) and note in " ".join(host.notes) and ("resets" in " ".join(host.notes)) == bool(note)
    random = np.random.default_rng(1)
    for state, u in zip(random.normal(size=(3, 2)), random.normal(size=3)):
        found = one(host, state, [u])
        assert found.tobytes() == simulated(path, "CoSimulation", 0.01, state, u).tobytes()
        assert found.tobytes() == euler(state, [u], 0.01, 10).tobytes()


@VERSIONS
def test_a_row_does_not_depend_on_other_rows_and_earlier_calls(make, version):
    host = fmu_host(make(version))
    random = np.random.default_rng(2)
    states, actions = random.normal(size=(20, 2)), random.normal(size=(20, 1))
    batch = host.step(states, actions, 0.01)
    one(host, dt=0.3)
    for k in (7, 19, 0):
        assert host.step(states[k : k + 1], actions[k : k + 1], 0.01).tobytes() == batch[k : k + 1].tobytes()
    assert np.isnan(one(host, [np.nan, 0.0])).all() and host.step(states[:0], actions[:0], 0.01).shape == (0, 2)


def test_names_the_point_and_notes_are_those_of_the_description(make):
    host = fmu_host(make(), start_values={"x0": 0.5, "mu": 3.0, "u": 0.25})
    assert (host.states, host.inputs, host.title) == (("x0 (m)", "x1 (m/s)"), ("u (m/s2)",), "VanDerPol")
    assert host.version == fmu_host(make(3)).version == "Stub 1.2"
    assert host.state.tolist() == [0.5, 0.0] and host.action.tolist() == [0.25] and host.dt == 0.01
    assert one(host, [0.0, 1.0], [0.0], 0.001)[1] == 1.003
    assert "the macro step of 0.01 s is a latency" in host.notes[0] and not host.equilibrium
    assert fmu_host(make(), start_values={"x0": 0.0}).equilibrium


@VERSIONS
def test_a_state_that_is_not_named_begins_at_its_start(make, version):
    host = fmu_host(make(version), states=["x1"], start_values={"x0": 0.5})
    assert host.states == ("x1 (m/s)",) and "with the continuous states x0 at the start" in " ".join(host.notes)
    for velocity in (0.3, -0.2):
        assert one(host, [velocity])[0] == euler(np.array([0.5, velocity]), [0.0], 0.01, 10)[1]


@VERSIONS
def test_a_parameter_may_set_a_state(make, version):
    host = fmu_host(make(version), states={"x0": "x0_start", "x1": "x1"})
    assert one(host, [0.3, 0.1]).tobytes() == euler(np.array([0.3, 0.1]), [0.0], 0.01, 10).tobytes()


@VERSIONS
def test_a_step_of_model_exchange_is_that_of_fmpy_bit_for_bit(make, version):
    path = make(version)
    host = fmu_host(path, kind="ModelExchange", dt=0.01)
    state, u = np.array([0.7, -0.3]), 0.2
    found = one(host, state, [u])
    assert found.tobytes() == simulated(path, "ModelExchange", 0.01, state, u, solver="Euler", step_size=0.01).tobytes()
    assert found.tobytes() == euler(state, [u], 0.01, 1).tobytes()
    assert host.integrator == "Euler" and "no step of its own" in " ".join(host.notes)


@VERSIONS
def test_a_state_event_of_model_exchange_leaves_nothing_behind(make, version):
    host = fmu_host(make(version), kind="ModelExchange", dt=0.1, start_values={"floor": 0.0, "x0": 1.0})
    before = one(host, [1.0, -1.0])
    bounced = one(host, [0.05, -1.0])
    assert bounced[1] == -euler(np.array([0.05, -1.0]), [0.0], 0.1, 1)[1]
    assert one(host, [1.0, -1.0]).tobytes() == before.tobytes() and one(host, [0.05, -1.0]).tobytes() == bounced.tobytes()


@VERSIONS
def test_the_plant_is_that_of_the_formula(make, version):
    x0, x1 = 0.5, 0.8
    a, b = [[0, 1], [-2 * x0 * x1 - 1, 1 - x0**2]], [[0], [1]]
    for options in ({}, {"derivatives": "differences"}):
        found = fmu_plant(make(version), start_values={"x0": x0, "x1": x1}, **options)
        for matrix, expected in zip(found, (a, b, [[1, 0], [1, 0]], [[0], [2]])):
            assert matrix == pytest.approx(np.array(expected), abs=1e-11 if options else 1e-15)
    assert found[4] == {"states": ("x0 (m)", "x1 (m/s)"), "inputs": ("u (m/s2)",), "outputs": ("x0 (m)", "y")}
    chosen = fmu_plant(make(version, directional=False), inputs=[], outputs=["y"])
    assert chosen[1].shape == (2, 0) and chosen[2] == pytest.approx(np.array([[1.0, 0.0]])) and chosen[3].shape == (1, 0)


@VERSIONS
def test_the_reference_of_model_exchange_agrees_with_differences_of_the_step(make, version):
    host = fmu_host(make(version), kind="ModelExchange", dt=0.01, start_values={"x1": 0.4})
    assert host.reference_source == f"fmi{version}GetDirectionalDerivative"
    columns = []
    for j in range(3):
        point, h = np.concatenate([host.state, host.action]), 1e-5
        pair = [one(host, moved[:2], moved[2:]) for moved in (point + h * np.eye(3)[j], point - h * np.eye(3)[j])]
        columns.append((pair[0] - pair[1]) / (2 * h))
    # The rounding of a state divided by the step; the third derivative is zero.
    both = np.concatenate([host.reference_A, host.reference_B], axis=1)
    assert np.stack(columns, axis=1) == pytest.approx(both, abs=10 * np.finfo(float).eps * 2 / 1e-5)
    host = fmu_host(make(version, directional=False), kind="ModelExchange", dt=0.01)
    assert host.reference_A is None and host.reference_source == "" and fmu_host(make(version)).reference_A is None


@VERSIONS
def test_a_wrong_directional_derivative_is_found(make, version):
    """It is -1.01 in place of -1, by the position; the rate has no other entry larger than 1."""

    def audit(fault, dt):
        values = {"x0": 0.0, "fault": FAULTS[fault] if fault else 0}
        return probe.fmu(make(version), kind="ModelExchange", dt=dt, start_values=values)

    def kinds(report):
        return [finding["kind"] for finding in report.findings]

    text = f"fmi{version}GetDirectionalDerivative is -1.01 of the derivative of x1 (m/s) by x0 (m), but differences are -1"
    # 0.1 s × 0.01 is a thousandth of the row of the step.
    wrong = audit("wrong derivative", 0.1)
    assert "derivatives-differ" in kinds(wrong) and text in wrong.notes
    assert wrong.results["reference"]["source"] == f"fmi{version}GetDirectionalDerivative"
    if version == 2:
        # What follows does not depend on the version, and an audit takes seconds.
        return
    # 0.001 s × 0.01 are less than the 1e-4 that derivatives may differ.
    small = audit("wrong derivative", 0.001)
    assert "derivatives-differ" not in kinds(small) and text in small.notes
    # The longer the step, the larger is what a false difference would weigh.
    right = audit(None, 0.1)
    assert "derivatives-differ" not in kinds(right) and not any("GetDirectional" in note for note in right.notes)


@VERSIONS
def test_a_plant_of_wrong_directional_derivatives_is_an_error_by_default(make, version):
    options = {"start_values": {"x0": 0.0, "fault": FAULTS["wrong derivative"]}}
    message = r"GetDirectionalDerivative is -1.01 of the derivative of x1 \(m/s\) by x0 \(m\), but differences are -1; expected the same"
    with pytest.raises(ValueError, match=message):
        fmu_plant(make(version), **options)
    assert fmu_plant(make(version), derivatives="directional", **options)[0][1, 0] == -1.01
    assert fmu_plant(make(version), derivatives="differences", **options)[0][1, 0] == pytest.approx(-1, abs=1e-11)


@VERSIONS
def test_a_crash_is_an_error_that_names_the_fmu_and_its_function(make, version):
    path = make(version)
    host = fmu_host(path, start_values={"fault": FAULTS["crash"], "x0": 2.5})
    first = one(host)
    with pytest.raises(RuntimeError, match=rf"{path.name} ended its process by SIGSEGV in fmi{version}DoStep.*a pointer is null"):
        one(host, [1.0, 0.0])
    # The next call starts it anew.
    assert one(host).tobytes() == first.tobytes()


@VERSIONS
def test_an_exit_an_error_and_silence_are_errors(make, version):
    path = make(version)
    for fault, error, message in (
        ("exit", RuntimeError, rf"{path.name} ended its process with exit code 3"),
        ("error", RuntimeError, rf"{path.name}: fmi{version}DoStep failed with status 3"),
        ("hang", TimeoutError, rf"{path.name} gave no answer in 3 s \(step\)"),
    ):
        start = time.monotonic()
        with pytest.raises(error, match=message):
            fmu_host(path, start_values={"fault": FAULTS[fault]}, timeout=3.0)
        assert time.monotonic() - start < 30


@VERSIONS
def test_a_discarded_step_returns_nan(make, version):
    host = fmu_host(make(version), start_values={"fault": FAULTS["discard"]})
    after = host.step(np.array([[1.0, 0.0], [3.5, 0.0], [1.0, 0.0]]), np.zeros((3, 1)), 0.01)
    assert np.isnan(after[1]).all() and after[0].tobytes() == after[2].tobytes() and np.isfinite(after[0]).all()


@VERSIONS
def test_a_saved_state_that_leaves_the_mode_is_replaced_by_a_reset(make, version):
    host = fmu_host(make(version), start_values={"fault": FAULTS["faulty restore"]})
    assert "each row resets the FMU: " in " ".join(host.notes)
    assert one(host, [0.3, 0.1]).tobytes() == euler(np.array([0.3, 0.1]), [0.0], 0.01, 10).tobytes()


@VERSIONS
def test_a_memory_that_nothing_clears_is_an_error(make, version):
    with pytest.raises(ValueError, match="has a memory that a new instance does not clear"):
        fmu_host(make(version), start_values={"fault": FAULTS["leak"]})


def test_a_state_that_does_not_keep_its_value_is_an_error(make):
    with pytest.raises(ValueError, match=r"x1 \(m/s\) of .* but was set to 0.001: it is no free state"):
        fmu_host(make(), states={"x1": "mu"})


def test_the_process_and_the_files_end_with_the_host(make):
    host = fmu_host(make())
    simulation = host.step.__self__
    process, folder = simulation.process.process, simulation.described.folder.path
    assert process.poll() is None and os.path.isdir(folder)
    del host, simulation
    gc.collect()
    assert process.poll() is not None and not os.path.exists(folder)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda make: fmu_host("no such file.fmu"), "no such file"),
        (lambda make: fmu_host(3), "must be the path of an FMU, not int"),
        (lambda make: fmu_host(__file__), "is no valid FMU"),
        (lambda make: fmu_host(make(), kind="CoSimulatoin"), "did you mean 'CoSimulation'"),
        (lambda make: fmu_host(make(exchange=False), kind="ModelExchange"), "has no ModelExchange; it has CoSimulation"),
        (lambda make: fmu_host(make(step="")), "dt is missing"),
        (lambda make: fmu_host(make(), states=["x2"]), "states has 'x2', which is no variable of .*x0_start, x1"),
        (lambda make: fmu_host(make(), states=["y"]), "has initial='calculated', so that it cannot be set.*x0, x1"),
        (lambda make: fmu_host(make(lists=False, exchange=False)), "lists no continuous states; .*x0, x1"),
        (lambda make: fmu_host(make(), inputs=["mu"]), "causality is 'parameter'; expected 'input'"),
        (lambda make: fmu_host(make(), start_values={"um": 1.0}), "start_values has 'um'.*did you mean"),
        (lambda make: fmu_host(make(), start_values={"y": 1.0}), "variables that cannot be set: y"),
        (lambda make: fmu_host(make(), kind="ModelExchange", states=["x0"]), "has its own states"),
        (lambda make: fmu_host(make(), statse=["x0"]), "did you mean 'states'"),
        (lambda make: fmu_plant(make(directional=False), derivatives="directional"), "provides none"),
        (lambda make: fmu_plant(make(), derivatives="difference"), "did you mean 'differences'"),
    ],
)
def test_errors_name_what_is_wrong(make, call, message):
    with pytest.raises((TypeError, ValueError, RuntimeError), match=message):
        call(make)
