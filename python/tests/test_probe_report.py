"""Reports of audits: attributes, files, and calls that repeat them."""

import functools
import html
import json
import math
import re

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


# ------------------------------------------------------------------ calls that repeat an audit


def energy(x):
    return 0.5 * x[1] ** 2 + 9.0 * (1 - np.cos(x[0]))


def test_a_call_repeats_the_audit(tmp_path):
    mass = np.array([2.0])
    names = ["<a> (rad)", "b"]
    report = probe(pendulum, np.zeros(2), [0], np.float64(DT), energy=energy, pairs=[(0, 1)], mass=mass, states=names, batched=False)
    expected = "libration.probe(pendulum, [0.0, 0.0], [0], 0.01, energy=energy, states=['<a> (rad)', 'b'], mass=[2.0], pairs=[(0, 1)])"
    assert report.repeat_command == expected
    again = eval(report.repeat_command)
    assert again.results == report.results and again.repeat_command == expected
    report.save(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    # Each word is an element.
    assert expected in html.unescape(re.sub("<[^>]*>", "", page)) and "<a> (rad)" not in page


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        (lambda: probe(pendulum, [0.0, 0.0], [0.0], DT, complex_step=True), "(pendulum, [0.0, 0.0], [0.0], 0.01, complex_step=True)"),
        (lambda: probe(pendulum, (0, 0), 0.0, dt=DT, equilibrium=False), "(pendulum, (0, 0), 0.0, 0.01, equilibrium=False)"),
        (lambda: probe(lambda x, u, dt: x - dt * x, [0.0], dt=DT, notes=("one",)), "(step, [0.0], (), 0.01, notes=('one',))"),
        (lambda: probe(functools.partial(pendulum), [0, 0], [0], DT, energy=lambda x: x[0]), "(step, [0, 0], [0], 0.01, energy=energy)"),
        (lambda: probe(Linear().step, np.full(30, 1 / 3), (), DT, equilibrium=False), "(step, state, (), 0.01, equilibrium=False)"),
        (lambda: probe(pendulum, [0, 0], [0], DT, title="a 'b'"), """(pendulum, [0, 0], [0], 0.01, title="a 'b'")"""),
        (lambda: probe(pendulum, [0, 0], [0], DT, title=200 * "t", states=iter("ab")), "(pendulum, [0, 0], [0], 0.01, states=states, title=title)"),
    ],
)
def test_arguments_have_their_notation_or_the_name_of_their_parameter(call, expected):
    assert call().repeat_command == f"libration.probe{expected}"


class Linear:
    def step(self, x, u, dt):
        return x - dt * x


def test_a_call_repeats_the_audit_of_an_environment():
    gymnasium = pytest.importorskip("gymnasium")
    report = probe.gymnasium("Pendulum-v1", state=np.zeros(2), dt=0.02, conservative=True)
    assert report.repeat_command == "libration.probe.gymnasium('Pendulum-v1', state=[0.0, 0.0], dt=0.02, conservative=True)"
    assert eval(report.repeat_command).results == report.results
    assert probe.gymnasium(gymnasium.make("Pendulum-v1"), [0.5]).repeat_command == "libration.probe.gymnasium(env, [0.5])"


def test_a_call_repeats_the_audit_of_a_function_of_jax():
    jnp = pytest.importorskip("jax.numpy")

    def filtered(x, u, dt):
        return x + dt * (u - x)

    assert probe.jax(filtered, [0.0], jnp.zeros(1), DT, threads=2).repeat_command == "libration.probe.jax(filtered, [0.0], [0.0], 0.01, threads=2)"


def test_a_call_repeats_the_audit_of_a_model_of_mujoco(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    # Calls do not depend on the time step; an audit of fewer steps is shorter.
    text = "<mujoco><option timestep='.1'/><worldbody><body><joint axis='0 1 0'/><geom size='.1' pos='0 0 -1'/></body></worldbody></mujoco>"
    report = probe.mujoco(mujoco.MjModel.from_xml_string(text), dt=0.05)
    assert report.repeat_command == "libration.probe.mujoco(model, dt=0.05)"
    path = tmp_path / "pendulum.xml"
    path.write_text(text, encoding="utf-8")
    assert probe.mujoco(path, dt=0.05).repeat_command == f"libration probe --mujoco {path} --dt 0.05"
    assert probe.mujoco(str(path), state="default").repeat_command == f"libration.probe.mujoco({str(path)!r}, state='default')"
