"""Tests of bodies."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import libration
from libration import Bodies


def leapfrog(bodies: Bodies, dt: float, steps: int) -> Any:
    """Drift, kick, drift in NumPy."""
    q, v = bodies.positions.copy(), bodies.velocities.copy()
    strength = bodies.gravitational_constant * bodies.masses
    for _ in range(steps):
        q += 0.5 * dt * v
        offset = q[None, :, :] - q[:, None, :]
        square = (offset**2).sum(-1) + bodies.softening**2
        np.fill_diagonal(square, np.inf)
        v += dt * (strength[None, :, None] * offset / square[..., None] ** 1.5).sum(1)
        q += 0.5 * dt * v
    return q, v


def test_a_cluster_moves_as_ten_lines_of_numpy_move_it() -> None:
    cluster = Bodies.published("plummer", count=37, seed=5, softening=0.05)
    motion = libration.simulate_bodies(cluster, integrator="leapfrog", dt=0.01, steps=50, every=10)
    q, v = leapfrog(cluster, 0.01, 50)
    assert motion.positions.shape == (6, 37, 3) and np.allclose(motion.t, 0.1 * np.arange(6))
    # 50 steps of sums of 37 terms: some hundred roundings.
    assert np.abs(motion.positions[-1] - q).max() < 1e-13 and np.abs(motion.velocities[-1] - v).max() < 1e-13
    again = libration.simulate_bodies(cluster, integrator="leapfrog", dt=0.01, steps=50, every=10, threads=1)
    assert np.array_equal(motion.positions, again.positions)


def test_predictions_of_the_energy_agree_with_the_measurement() -> None:
    planets = Bodies.published("outer-solar-system")
    assert planets.names[0] == "sun" and len(planets) == 6
    motion = libration.simulate_bodies(planets, integrator="wisdom-holman", dt=100.0, steps=5000)
    energy = motion.conserved["energy"]
    # The error of order 2 has no next term of order 3.
    assert 0.8 < energy["largest_change"] / energy["predicted_by_order"] < 1.25
    assert energy["predicted_by_rounding"] < 1e-3 * energy["largest_change"]
    assert "energy" in repr(motion) and "momentum" in motion._repr_html_() and motion.stopped is None


def test_collisions_end_a_motion_and_name_the_bodies() -> None:
    two = Bodies(
        [1.0, 1.0], [[0, 0, 0], [1, 0, 0]], np.zeros((2, 3)), radii=[0.1, 0.2], names=["a", "b"]
    )
    motion = libration.simulate_bodies(two, integrator="velocity-verlet", dt=0.01, steps=1000)
    assert motion.stopped is not None and "`a` and `b` collide at t = 0.7" in motion.stopped
    assert motion.results["steps"] < 100


def test_files_have_the_bodies(tmp_path: Path) -> None:
    rows = tmp_path / "two.csv"
    rows.write_text("name,mass,x,y,z,vx,vy,vz\nsun,1,0,0,0,0,0,0\nplanet,0,1,0,0,0,1,0\n")
    read = Bodies.read(rows)
    assert read.names == ["sun", "planet"] and read.name == "two"
    turn = libration.simulate_bodies(read, integrator="wisdom-holman", dt=2 * np.pi, steps=3)
    # Whole turns of a circle around a body that stays.
    assert np.abs(turn.positions[-1] - read.positions).max() < 1e-14


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"masses": [1.0, -1.0]}, "body 1: mass = -1"),
        ({"positions": np.zeros((2, 2))}, r"positions has shape \(2, 2\); expected \(2, 3\)"),
        ({"velocities": np.full((2, 3), np.nan)}, "body 0: vx = NaN"),
        ({"softening": -1.0}, "softening is -1.0"),
        ({"names": ["a"]}, "names has 1 names; expected 2"),
        ({"names": ["a", "a"]}, "two bodies have the same name"),
    ],
)
def test_wrong_bodies_are_refused(change: dict[str, Any], message: str) -> None:
    fields: dict[str, Any] = {"masses": [1.0, 1.0], "positions": [[0, 0, 0], [1, 0, 0]], "velocities": np.zeros((2, 3))}
    with pytest.raises(ValueError, match=message):
        Bodies(**{**fields, **change})


def test_bodies_at_one_place_cannot_start() -> None:
    with pytest.raises(ValueError, match="`a` and `b` are at the same place"):
        libration.simulate_bodies(Bodies([1.0, 1.0], np.zeros((2, 3)), np.zeros((2, 3)), names=["a", "b"]), integrator="leapfrog", dt=0.1, steps=1)


def test_wrong_options_are_refused() -> None:
    eight = Bodies.published("figure-eight")
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"integrator": "leapfrogg"}, "did you mean `leapfrog`"),
        ({"dt": 0.0}, "dt"),
        ({"steps": 0}, "steps is 0"),
        ({"every": 0}, "every is 0"),
    ]
    for change, message in wrong:
        options: dict[str, Any] = {"integrator": "leapfrog", "dt": 0.1, "steps": 1, **change}
        with pytest.raises(ValueError, match=message):
            libration.simulate_bodies(eight, **options)
    of_wrong_type: list[dict[str, Any]] = [{"compensated": "no"}, {"steps": True}, {"integrator": None}, {"threads": 1.5}]
    for change in of_wrong_type:
        options = {"integrator": "leapfrog", "dt": 0.1, "steps": 1, **change}
        with pytest.raises(TypeError, match=next(iter(change))):
            libration.simulate_bodies(eight, **options)
    with pytest.raises(ValueError, match="'plummer' requires count"):
        Bodies.published("plummer")
    with pytest.raises(ValueError, match="did you mean `figure-eight`"):
        Bodies.published("figure-eigth")


def test_ions_move_as_ten_lines_of_numpy_move_them() -> None:
    rng = np.random.default_rng(2)
    q = np.stack(np.meshgrid(*[[0.0, 1.2]] * 3), -1).reshape(8, 3) + rng.uniform(-0.05, 0.05, (8, 3))
    v, masses, charges = rng.uniform(-0.1, 0.1, (8, 3)), rng.uniform(1, 2, 8), np.tile([1.0, -1.0], 4)
    ions = Bodies(masses, q, v, charges=charges, pair_potential="q1*q2/r + hard/r^9", parameters={"hard": 0.1})
    assert ions.gravitational_constant == 0 and Bodies(masses, q, v).gravitational_constant == 1
    motion = libration.simulate_bodies(ions, integrator="leapfrog", dt=0.01, steps=100)
    for _ in range(100):
        q += 0.005 * v
        offset = q[None, :, :] - q[:, None, :]
        r = np.sqrt((offset**2).sum(-1)) + np.eye(8)
        slope = -np.outer(charges, charges) / r**2 - 0.9 / r**10
        np.fill_diagonal(slope, 0)
        v += 0.01 * ((slope / r)[..., None] * offset).sum(1) / masses[:, None]
        q += 0.005 * v
    # Some hundred roundings of numbers of about 1.
    assert np.abs(motion.positions[-1] - q).max() < 1e-13
    assert motion.results["pair_potential"] == "q1*q2/r + hard/r^9"
    energy = motion.conserved["energy"]
    assert 0.5 < energy["predicted_by_order"] / energy["largest_change"] < 2


def test_arrays_that_were_changed_are_checked_again() -> None:
    for name, value in (("charges", np.zeros(1)), ("radii", np.zeros(3)), ("names", ["a"]), ("masses", np.ones(3))):
        bodies = Bodies([1.0, 1.0], np.eye(3)[:2], np.zeros((2, 3)), pair_potential="q1*q2/r", charges=[1.0, 1.0])
        setattr(bodies, name, value)
        with pytest.raises(ValueError, match="numbers for"):
            libration.simulate_bodies(bodies, integrator="leapfrog", dt=0.01, steps=5)


def test_wrong_pair_potentials_name_what_is_wrong() -> None:
    places = np.eye(3)
    cases: list[tuple[dict[str, Any], str]] = [
        ({"pair_potential": "q1*q2/d"}, "pair_potential: unknown name `d`"),
        ({"pair_potential": "1/"}, "pair_potential: found the end"),
        ({"parameters": {"k": 1.0}}, "without a pair_potential"),
        ({"pair_potential": "r", "parameters": {"r": 1.0}}, "`r` is given twice"),
        ({"pair_potential": "r", "charges": [1.0]}, "charges has shape"),
        ({"pair_potential": "r", "charges": [1.0, np.nan, 0.0]}, "charge = NaN"),
        ({"gravitational_constant": -1.0}, "gravitational_constant"),
    ]
    for keywords, message in cases:
        with pytest.raises(ValueError, match=message.replace("(", r"\(")):
            Bodies([1.0, 1.0, 1.0], places, places, **keywords)
    wrong_types: list[tuple[dict[str, Any], str]] = [
        ({"pair_potential": 3}, "pair_potential is int"),
        ({"pair_potential": "k*r", "parameters": {"k": "1"}}, "k"),
        ({"pair_potential": "k*r", "parameters": {"k": True}}, "k"),
        ({"pair_potential": "k*r", "parameters": [1]}, "parameters is list"),
        ({"name": 3}, "name is int"),
    ]
    for keywords, message in wrong_types:
        with pytest.raises(TypeError, match=message):
            Bodies([1.0, 1.0, 1.0], places, places, **keywords)
    with pytest.raises(TypeError, match="positions has complex numbers"):
        Bodies([1.0, 1.0, 1.0], 1j * places, places)
    with pytest.raises(ValueError, match="softening without gravity"):
        Bodies.published("frozen-argon", softening=0.1)
    with pytest.raises(ValueError, match="charge = 1.0 has no effect; expected a pair potential"):
        Bodies([1.0, 1.0, 1.0], places, places, charges=[0.0, 1.0, 0.0])
    with pytest.raises(ValueError, match="mass = 0; expected a mass above 0 with a pair potential"):
        Bodies([1.0, 0.0, 1.0], places, places, pair_potential="r")
