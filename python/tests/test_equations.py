"""Systems by equations."""

import dataclasses
import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import libration

SYSTEMS = Path(__file__).parents[2] / "examples" / "systems"


def pendulum(**given):
    return libration.System(
        acceleration={"q": "-g*sin(q)"},
        parameters={"g": (9.0, "m/s^2")},
        energy="q'^2/2 + g*(1 - cos(q))",
        **given,
    )


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("integrator", [name for name in libration.INTEGRATORS if name != "exact"])
def test_trajectories_have_the_bits_of_the_catalogue(integrator, dtype):
    q = np.linspace(-2, 2, 37)
    ensembles = [
        libration.Ensemble(system, integrator=integrator, dt=0.01, q=q, v=0.1 * q, dtype=dtype)
        for system in (pendulum(), libration.System("pendulum", omega2=9.0))
    ]
    for ensemble in ensembles:
        ensemble.advance(1)
        ensemble.advance(20)
    own, compiled = ensembles
    assert np.array_equal(own.q, compiled.q) and np.array_equal(own.v, compiled.v)
    assert own.q.dtype == dtype and own.step == 21
    # The catalogue computes its energy in another order.
    spacing = np.finfo(dtype).eps * np.abs(compiled.energy).max()
    assert np.abs(own.energy - compiled.energy).max() <= 8 * spacing


def test_columns_have_the_names_and_units_of_the_system():
    system = pendulum(start={"q": 1.0}, units={"q": "rad", "energy": "J"})
    found = libration.simulate(system, integrator="rk4", dt=0.01, steps=4, num_trajectories=3, spread=0.5)
    assert list(found) == ["trajectory", "step", "t", "q", "q'", "energy"]
    assert [found.units[name] for name in ("q", "q'", "energy")] == ["rad", "rad/s", "J"]
    assert found["q"][:3].tolist() == [0.5, 1.0, 1.5]
    np.testing.assert_array_equal(found.q[:, 0], found["q"])
    np.testing.assert_array_equal(found.v[:, 0], found["q'"])
    decay = libration.System(rate={"x": "-x"}, start={"x": 1.0})
    with pytest.raises(AttributeError, match="there are step, t, x"):
        libration.simulate(decay, integrator="rk4", dt=0.01, steps=4).q


def test_a_simulation_begins_at_the_given_state_and_warns_of_a_lost_order():
    options = {"integrator": "velocity-verlet", "dt": 0.01, "steps": 5, "q": 0.7, "v": -0.2}
    found = libration.simulate(pendulum(start={"q": 1.0}), **options)
    wanted = libration.simulate(libration.System("pendulum", omega2=9.0), **options)
    assert found.q[0, 0] == 0.7 and found.v[0, 0] == -0.2
    np.testing.assert_array_equal(found.q, wanted.q)
    damped = libration.System(acceleration={"q": "-9*q - q'"}, start={"q": 1.0})
    with pytest.warns(UserWarning, match="`blanes-moan-srkn-6-4` does not suppose"):
        libration.simulate(damped, integrator="blanes-moan-srkn-6-4", dt=0.01, steps=5)


def test_an_energy_that_diverges_in_a_run_warns():
    system = libration.System(acceleration={"q": "-9*q"}, energy="q'^2/2 + 9*q^2/2", start={"q": 0.1})
    libration.simulate(system, integrator="velocity-verlet", dt=0.66, steps=200)
    with pytest.warns(RuntimeWarning, match="the energy goes from .* though the forces conserve it"):
        libration.simulate(system, integrator="velocity-verlet", dt=0.75, steps=200)


def test_files_are_systems_with_parameters_that_can_be_replaced():
    cart = libration.System.from_toml(SYSTEMS / "cart_pole.toml", pole=0.2)
    assert cart.states == ("x", "theta", "x'", "theta'") and cart.inputs == ("u",)
    assert cart.parameters["pole"] == 0.2 and cart.replace(pole=0.3).parameters["pole"] == 0.3
    again = pickle.loads(pickle.dumps(cart))
    assert again == cart and again != cart.replace(pole=0.3)
    with pytest.raises(ValueError, match="unknown parameter `pol`"):
        libration.System.from_toml(SYSTEMS / "cart_pole.toml", pol=0.2)


def test_states_of_first_order_are_velocities_and_time_is_nobodys():
    system = libration.System(
        acceleration={"x": "cos(t) - x + s"}, rate={"s": "-2*s"}, start={"x": 1.0, "s": 3.0}
    )
    one = libration.simulate(system, integrator="rk4", dt=0.01, steps=50)
    many = libration.Ensemble(
        system, integrator="rk4", dt=0.01, q=[[1.0], [2.0]], v=[[0.0, 3.0], [0.0, 1.0]]
    )
    many.advance(50)
    assert many.q.shape == (2, 1) and many.v.shape == (2, 2)
    assert [many.q[0, 0], *many.v[0]] == [one["x"][-1], one["x'"][-1], one["s"][-1]]
    # RK4 multiplies a decay by 1 - z + z^2/2 - z^3/6 + z^4/24 each step, to the rounding of 50 steps.
    z = 0.02
    factor = 1 - z + z**2 / 2 - z**3 / 6 + z**4 / 24
    assert one["s"][-1] == pytest.approx(3 * factor**50, rel=1e-14)


def test_equations_are_a_plant_for_budgets_and_analyses():
    cart = libration.System.from_toml(SYSTEMS / "cart_pole.toml")
    plant = cart.plant()
    # Of the equations at rest: g/l over 4/3 - m/M.
    assert plant.A[3][1] == pytest.approx(9.81 / 0.5 / (4 / 3 - 0.1 / 1.1), rel=1e-14)
    assert "exact derivatives" in repr(plant.operating_point) and plant.operating_point.x.tolist() == [0, 0, 0, 0]
    advice = libration.advise(cart, libration.LQR([1, 10, 0, 1], [0.1]), period=0.02, latency=0.03)
    same = libration.advise(plant, libration.LQR([1, 10, 0, 1], [0.1]), period=0.02, latency=0.03)
    assert advice.margin == same.margin > 1
    analysis = libration.analyze(cart, integrator="velocity-verlet", dt=0.01, steps=1000)
    assert analysis.motion["order"] == 1 and analysis.motion["classical_order"] == 2


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: pendulum(foo=1), "unexpected keyword argument 'foo'"),
        (lambda: libration.System(acceleration={"x": "-kk*x"}, parameters={"k": 1}), "did you mean `k`"),
        (lambda: libration.System(acceleration="-x"), "acceleration must be a dictionary"),
        (lambda: libration.System(acceleration={"x": "-x"}, inputs="u"), "a list of names"),
        (lambda: pendulum(units={"p": "m"}), "the names are `q`, `energy`"),
        (lambda: libration.simulate(pendulum(), integrator="rk5", dt=0.1, steps=1), "did you mean 'rk4'"),
        (lambda: libration.simulate(pendulum(), integrator="rk4", dt=0.1, steps=1, q=[1, 2]), "q has 2 numbers; .* has 1 coord"),
        (lambda: libration.simulate(pendulum(), integrator="rk4", dt=0.1, steps=1, latency=0.1), "latency is given"),
        (lambda: libration.Ensemble(pendulum(), dt=0.1, q=np.zeros((3, 2))), r"must be \(N, 1\): q"),
        (lambda: libration.analyze(pendulum(), integrator="exact", dt=0.1), "exact"),
        (lambda: libration.Environments(pendulum(), 4), "has no inputs, but actions need at least one"),
        (lambda: pendulum(task="-q^2"), "task must be a dictionary"),
        (lambda: pendulum(task={"reward": "-p^2"}), "unknown name `p`"),
        (lambda: pendulum(task={"rewrad": "-q^2"}), "did you mean `reward`"),
    ],
)
def test_wrong_equations_and_options_are_refused_by_name(make, message):
    with pytest.raises((TypeError, ValueError), match=message):
        make()


def test_the_laboratory_runs_the_studies_that_apply_to_a_system(tmp_path):
    file = SYSTEMS / "van_der_pol.toml"
    results = libration.run_lab(
        {"convergence": {"coarsest": 128}},
        system=libration.System.from_toml(file, mu=0.8),
        studies=["convergence", "stability"],
        effort="quick",
        out=tmp_path,
    )
    assert list(results.seconds) == ["convergence", "stability"] and not results.disagreements
    assert results["convergence.Van-der-Pol.velocity-verlet.global-order"].predicted == 1.0
    assert results.json["system"]["parameters"][0]["value"] == 0.8
    assert results.json["config"]["system"] == {"equations": "Van der Pol"}
    applies = {"determinism", "precision", "convergence", "stability"}
    assert set(results.not_applicable) == set(libration.STUDIES) - applies and results.claims == []
    assert results.not_applicable["nonlinear"] == "the file has no `energy`"
    stored = json.loads((tmp_path / "results.json").read_text())
    assert [f["id"] for study in stored["studies"] for f in study["findings"]] == [f.id for f in results.findings]
    assert all((tmp_path / "data" / f"{name}.parquet").exists() for name in results.series)
    assert f"libration lab --system {file} --set mu=0.8 --effort quick" in results.report.read_text()


def test_the_laboratory_finds_the_same_in_a_file_and_in_a_system_of_the_same_equations():
    file = libration.System.from_toml(SYSTEMS / "van_der_pol.toml")
    own = libration.System(
        acceleration={"x": "mu*(1 - x^2)*x' - x"}, parameters={"mu": 1.0}, start={"x": 0.1}, name="Van der Pol"
    ).replace(mu=file.parameters["mu"])
    found = [
        libration.run_lab(system=system, studies=["precision"], effort="quick", progress=False)
        for system in (file, own)
    ]
    # A system that was made in Python has no file for the commands.
    first, second = ([dataclasses.replace(f, command="") for f in results.findings] for results in found)
    assert first and first == second
    assert "libration lab --system FILE --set mu=" in found[1].report.read_text()


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"config": {"start": {"q": 2.0}}}, ValueError, "config has `start`, which has no effect: the system `system` takes"),
        ({"config": {"drift": {"dt": [0.1]}}}, ValueError, "config has `drift`.*predictions are those of harmonic motion"),
        ({"config": {"convergence": {"systems": ["kepler"]}}}, ValueError, "config has `convergence.systems`"),
        ({"config": {"controller": {}}}, ValueError, "config has `controller`.*`advise` reads it"),
        ({"config": {"precision": {}}}, ValueError, "`precision` of a system by equations has no settings"),
        ({"studies": ["determinism", "latency"]}, ValueError, "studies: the study `latency` does not apply to `system`"),
        ({"studies": ["nonlinear"]}, ValueError, "changes by .* of its size"),
        ({"studies": ["convergense"]}, ValueError, "did you mean `convergence`"),
        ({"system": "mine.toml"}, TypeError, r"help: System.from_toml\('mine.toml'\)"),
        ({"system": libration.System("pendulum")}, TypeError, "it must be a system by equations"),
        ({"system": None, "config": pendulum()}, TypeError, r"config is <EquationSystem.*run_lab\(system=…\)"),
    ],
)
def test_what_does_not_go_with_a_system_in_the_laboratory_is_refused_by_name(tmp_path, given, error, message):
    damped = libration.System(acceleration={"q": "-q - 0.1*q'"}, energy="q'^2/2 + q^2/2", start={"q": 1.0})
    with pytest.raises(error, match=message):
        libration.run_lab(**{"system": damped, "out": tmp_path / "none", **given})
    assert not (tmp_path / "none").exists()


SETTINGS = {"num_envs": 6, "steps": 40, "dt": 0.02, "chunk": {"num_envs": 3, "steps": 10}}
SETTINGS |= {"policy": {"random": {"low": -4.0, "high": 4.0}}}


def write(out, settings=SETTINGS, **given):
    return libration.datasets.write(out, settings, format="npy", **given)


def files(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def spring(**given):
    return libration.System(acceleration={"q": "-k*q + u"}, parameters={"k": 10.0}, inputs=["u"], **given)


TASK = {"observe": ["q", "q'"], "reward": "-q^2 - 0.01*u^2", "terminated": ["abs(q) > 2"], "start": {"q": (-1, 1)}}


def test_a_data_set_of_a_system_has_the_bytes_of_one_of_its_file(tmp_path):
    file, limit = SYSTEMS / "cart_pole.toml", {"max_action": 3.0}
    of_file = {"of": file, "parameters": {"pole": 0.2}, **limit}
    write(tmp_path / "file", {**SETTINGS, "system": {"equations": of_file}})
    cart = libration.System.from_toml(file, pole=0.2)
    written = write(tmp_path / "own", {**SETTINGS, "system": {"equations": limit}}, system=cart)
    assert written.transitions == 240
    assert files(tmp_path / "own") == files(tmp_path / "file")
    write(tmp_path / "other", {**SETTINGS, "system": {"equations": limit}}, system=cart.replace(pole=0.3))
    assert files(tmp_path / "other") != files(tmp_path / "file")


def test_a_data_set_of_a_system_made_in_python_is_resumed_to_the_same_bytes(tmp_path):
    system, part, whole = spring(task=TASK), tmp_path / "part", tmp_path / "whole"

    class Stop(Exception):
        pass

    def stop(done, what):
        raise Stop

    long = {**SETTINGS, "steps": 2000}
    with pytest.raises(Stop):
        write(part, long, system=system, progress=stop)
    (flaw,) = libration.datasets.verify(part)
    assert "is unfinished" in flaw.what
    with pytest.raises(ValueError, match="other"):
        write(part, long, system=system.replace(k=11.0), resume=True)
    write(part, long, system=system, resume=True)
    write(whole, long, system=system)
    assert files(part) == files(whole)
    assert libration.datasets.verify(part, replay=True) == []


def test_the_task_of_a_data_set_is_that_of_the_settings_or_of_the_system(tmp_path):
    write(tmp_path / "own", system=spring(task=TASK))
    write(tmp_path / "given", {**SETTINGS, "task": {"expressions": TASK}}, system=spring())
    other = {**TASK, "reward": "1"}
    write(tmp_path / "other", {**SETTINGS, "task": {"expressions": other}}, system=spring(task=TASK))
    own, given, paid = (files(tmp_path / name) for name in ("own", "given", "other"))
    manifest = Path("manifest.jsonl")
    heads = [json.loads(all.pop(manifest).splitlines()[0])["data"] for all in (own, given, paid)]
    assert heads[0]["task"] == heads[1]["task"] and own == given
    assert heads[0]["task"]["expressions"]["start"] == {"q": [-1.0, 1.0], "q'": [0.0, 0.0]}
    reward = next(path for path in own if path.parts[0] == "reward")
    assert own[reward] != paid[reward]
    assert set(np.load(tmp_path / "other" / reward).ravel()) == {1.0}


@pytest.mark.parametrize(
    ("settings", "given", "error", "message"),
    [
        ({"start": {"q": [1.0, 1.0]}}, {}, ValueError, "settings has 'start'"),
        ({"system": {"oscillator": {"k": 1.0}}}, {}, ValueError, "settings has 'system.oscillator'"),
        ({"system": {"equations": {"of": "mine.toml"}}}, {}, ValueError, "settings has 'system.equations.of'"),
        ({"task": {"regulate": {"bound": 1.0}}}, {}, ValueError, "settings has 'task.regulate'"),
        ({"task": {"expressions": {"reward": "-p"}}}, {}, ValueError, "unknown name `p`"),
        ({"system": {"equations": {"max_action": [1.0, 2.0]}}}, {}, ValueError, "max_action.* has 2 numbers"),
        ({}, {"system": spring()}, ValueError, r"has no table \[task\]; expected \[task.expressions\] in the settings"),
        ({}, {"system": pendulum(task={"reward": "1"})}, ValueError, "has no inputs"),
        ({}, {"system": libration.System("pendulum")}, ValueError, r"has no table \[task\]"),
        ({}, {"system": "pendulum"}, TypeError, "it must be a system by equations"),
        (spring(task=TASK), {"system": None}, TypeError, r"settings is <EquationSystem.*datasets.write\(system=…\)"),
    ],
)
def test_what_does_not_go_with_a_system_in_a_data_set_is_refused_by_name(tmp_path, settings, given, error, message):
    with pytest.raises(error, match=message):
        write(tmp_path / "none", settings, **{"system": spring(task=TASK), **given})
    assert not (tmp_path / "none").exists()


def test_advice_on_a_simulation_of_equations_is_that_of_the_same_catalogue_system():
    own = pendulum(start={"q": 1.2})
    wanted = libration.advise(libration.System("pendulum", omega2=9.0), q=1.2, v=0, tolerance=("trajectory", 1e-2), horizon=4)
    found = libration.advise(own, tolerance=("trajectory", 1e-2), horizon=4)
    steps = [{choice["integrator"]: choice["dt"] or 0.0 for choice in advice.integrators} for advice in (found, wanted)]
    assert steps[0] == steps[1] and len(steps[0]) == 16
    elsewhere = libration.advise(pendulum(), q=1.2, v=0.0, tolerance=("trajectory", 1e-2), horizon=4)
    assert elsewhere.integrators == found.integrators
    assert "q=[1.2], v=[0.0], tolerance" in elsewhere.repeat_command
    for keywords, message in (
        ({"latency": 0.1}, "latency requires a controller"),
        ({"redesign": True}, "redesign requires a controller"),
        ({"q": [1.0, 2.0]}, "q has 2 numbers"),
        ({"tolerance": ("distance", 1)}, "unknown tolerance `distance`"),
        ({"tolerance": ("cost", 1e-3)}, "a cost requires a loop"),
    ):
        with pytest.raises((TypeError, ValueError), match=message):
            libration.advise(own, **keywords)


def test_a_change_of_a_summary_leaves_the_system():
    system = libration.System(
        acceleration={"q": "-q + u"}, inputs=["u"], task={"reward": "-q^2", "actions": [-1.0, 1.0], "start": {"q": (-1, 1)}}
    )
    unchanged = system.summary
    for table in (system.summary["task"], system.summary["task"]["actions"], system.summary["states"], system.summary["inputs"]):
        table.clear()
    assert system.summary == unchanged and unchanged["task"]["actions"] == [-1.0, 1.0]
    actions = [-2.0, 2.0]
    env = libration.envs.SystemEnv(system, dt=0.1, actions=actions)
    actions.append(3.0)
    env.get_wrapper_attr("actions").append(4.0)
    assert env.get_wrapper_attr("actions") == [-2.0, 2.0]
