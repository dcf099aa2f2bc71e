"""Tests of temperatures of Langevin thermostats."""

import numpy as np
import pytest

import libration


def test_temperatures_are_the_closed_forms_and_those_of_a_simulation_in_numpy() -> None:
    z, friction = 1.0, 2.0
    words = ["BAOAB", "OBABO", "ABOBA", "OABAO"]
    found = libration.analyze_temperature(libration.System("oscillator", omega2=1.0), temperature=0.5, friction=friction, dt=z, thermostats=words)
    rows = {row["thermostat"]: row for row in found.thermostats}
    narrow = 1 - z**2 / 4
    forms = {"BAOAB": (1, narrow), "OBABO": (1 / narrow, 1), "ABOBA": (1, 1 / narrow), "OABAO": (narrow, 1)}
    rng = np.random.default_rng(1)
    for word, (qq, vv) in forms.items():
        row = rows[word]
        assert row["configuration"]["predicted_bias"] == pytest.approx(qq - 1, abs=1e-12)
        assert row["kinetic"]["predicted_bias"] == pytest.approx(vv - 1, abs=1e-12)
        q, v = np.zeros(100_000), np.zeros(100_000)
        decay = np.exp(-friction * z / word.count("O"))
        for _ in range(40):
            for letter in word:
                h = z / word.count(letter)
                if letter == "A":
                    q = q + h * v
                elif letter == "B":
                    v = v - h * q
                else:
                    v = decay * v + np.sqrt(1 - decay**2) * rng.standard_normal(len(v))
        # A variance of n draws has the relative standard error √(2/n).
        for numpy, bias, form in [(q, row["configuration"], qq), (v, row["kinetic"], vv)]:
            assert abs(np.mean(numpy**2) - form) < 4 * form * np.sqrt(2 / len(numpy))
            assert abs(bias["measured_bias"] - (form - 1)) < 4 * bias["standard_error"]
    assert found.recommended == "BAOAB" and "BAOAB" in repr(found) and "OABAO" in found._repr_html_()


def test_a_system_by_equations_has_the_masses_of_its_energy() -> None:
    with pytest.raises(ValueError, match="forces without a potential"):
        libration.analyze_temperature(libration.EquationSystem(acceleration={"x": "y - 2*x", "y": "(x - 2*y)/100"}), temperature=1.0, friction=1.0)
    own = libration.EquationSystem(
        acceleration={"x": "y - 2*x", "y": "(x - 2*y)/100"}, energy="x'^2/2 + 100*y'^2/2 + x^2 + y^2 - x*y"
    )
    found = libration.analyze_temperature(own, temperature=1.0, friction=1.0, thermostats=["BAOAB"], steps=320_000)
    assert found.results["mass"] == [[1.0, 0.0], [0.0, 100.0]]
    squares = np.linalg.eigvals(np.array([[2.0, -1.0], [-0.01, 0.02]]))
    assert found.frequencies == pytest.approx(np.sqrt(np.sort(squares)))
    assert found.dt == pytest.approx(1 / found.frequencies[-1])


def test_a_start_in_another_valley_is_a_start_of_each_system() -> None:
    # Without a velocity the start is only the valley.
    options = {"temperature": 0.01, "friction": 0.5, "thermostats": ["BAOAB"], "steps": 3200}
    for system in (libration.System("duffing"), libration.System("duffing").equations()):
        found = [libration.analyze_temperature(system, q=q, **options).results["equilibrium"] for q in (0.3, -0.3)]
        # The bottoms of the potential −q²/2 + q⁴/4.
        assert found == pytest.approx(np.array([[1.0], [-1.0]]), abs=1e-8)


@pytest.mark.parametrize(
    ("system", "changes", "what"),
    [
        ("oscillator", {"friction": 0.0}, "friction"),
        ("oscillator", {"temperature": -1.0}, "temperature"),
        ("oscillator", {"thermostats": ["BAXAB"]}, "`X` is no letter"),
        ("oscillator", {"thermostats": ["BAAB"]}, "the word has no O"),
        ("oscillator", {"steps": 1}, "steps is 1"),
        ("damped-oscillator", {}, "depends on a velocity"),
        ("kepler", {}, "no equilibrium"),
    ],
)
def test_wrong_requests_are_refused(system: str, changes: dict, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        libration.analyze_temperature(system, **{"temperature": 1.0, "friction": 1.0, **changes})
    with pytest.raises(TypeError, match="expected a list of words"):
        libration.analyze_temperature("oscillator", temperature=1.0, friction=1.0, thermostats="BAOAB")
