"""Systems of the catalogue by equations, and their environments."""

import numpy as np
import pytest

import libration
from libration import SYSTEMS, System, simulate

STARTS = {1: ([1.2], [-0.4]), 2: ([0.4, 0.1], [-0.2, 1.9])}



@pytest.mark.parametrize("integrator", ["symplectic-euler", "rk4", "yoshida4"])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("name", sorted(set(SYSTEMS) - {"driven-oscillator"}))
def test_equations_without_commands_have_the_bits_of_the_catalogue(name, dtype, integrator):
    system = System(name)
    states = system.equations().states
    q, v = STARTS[len(states) // 2]
    given = {"integrator": integrator, "dt": 0.0123, "steps": 200, "dtype": dtype}
    compiled = simulate(system, q=q, v=v, **given)
    found = simulate(system.equations(start=dict(zip(states, q + v))), **given)
    moved = np.stack([found[state] for state in states], axis=-1)
    assert np.array_equal(np.concatenate([compiled.q, compiled.v], axis=-1).reshape(moved.shape), moved)


def test_the_drive_of_the_equations_is_that_of_the_catalogue():
    system = System("driven-oscillator")
    compiled = simulate(system, integrator="rk4", dt=0.01, steps=100, q=[1.0, 0.0], v=[0.0, 1.0])
    found = simulate(system.equations(start={"q": 1.0}), integrator="rk4", dt=0.01, steps=100)
    # The catalogue has time as a coordinate, which its steps add up.
    assert np.allclose(compiled["q"], found["q"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", sorted(SYSTEMS))
def test_each_system_of_the_catalogue_is_an_environment_with_a_command_for_each_coordinate(name):
    system = System(name)
    states = system.equations().states
    coordinates = states[: len(states) // 2]
    task = {"dt": 0.01, "reward": f"-{states[0]}^2", "start": {state: (0.9, 1.1) for state in coordinates}, "max_action": 2.0}
    env = libration.VectorEnv(system, 3, **task)
    seen, _ = env.reset(seed=5)
    assert env.single_action_space.shape == (len(coordinates),) and seen.shape == (3, len(states))
    pushed, pulled = (libration.VectorEnv(system, 3, **task) for _ in range(2))
    for other, action in ((pushed, 1.0), (pulled, -1.0)):
        other.reset(seed=5)
        moved = other.step(np.full((3, len(coordinates)), action, np.float32))[0]
        # A command is an acceleration: half of it times dt squared, and of the velocities all of it times dt.
        difference = moved[:, len(coordinates):] - env.step(np.zeros((3, len(coordinates)), np.float32))[0][:, len(coordinates):]
        assert np.allclose(difference, action * 0.01, rtol=2e-3)
        env.reset(seed=5)


def test_commands_of_a_system_with_a_mass_are_forces():
    env = libration.VectorEnv(System("damped-oscillator", m=2.0, k=0.0, gamma=0.0), 1, dt=0.1, reward="0", start={"q": 0.0, "q'": 0.0})
    env.reset(seed=0)
    moved = env.step(np.array([[3.0]], np.float32))[0]
    assert np.allclose(moved, [[0.5 * 1.5 * 0.01, 0.15]], rtol=1e-6)


def test_a_name_of_the_catalogue_that_is_no_preset_is_told_how_to_be_an_environment():
    with pytest.raises(ValueError, match=r"unknown environment 'kepler'.*help: System\('kepler'\) and a task"):
        libration.VectorEnv("kepler", 2)
    with pytest.raises(TypeError, match=r"an environment is \['Pendulum'\], but it must be the name of a preset"):
        libration.VectorEnv(["Pendulum"], 4)


def test_an_orbit_starts_where_it_is_no_singularity():
    env = libration.VectorEnv(System("kepler"), 2, dt=0.01, reward="-1")
    env.reset(seed=0)
    seen, _, terminated, _, infos = env.step(np.zeros((2, 2), np.float32))
    assert np.isfinite(seen).all() and not terminated.any() and "lost" not in infos


def test_the_spec_of_an_environment_of_the_catalogue_is_json_and_makes_it_again():
    gymnasium = pytest.importorskip("gymnasium")
    env = gymnasium.make("libration/System-v0", system=System("duffing", alpha=-2.0), dt=0.01, reward="-q^2", start={"q": (0.5, 1.0)})
    again = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    assert np.array_equal(env.reset(seed=3)[0], again.reset(seed=3)[0])
    assert all(np.array_equal(env.step([0.5])[0], again.step([0.5])[0]) for _ in range(20))


def test_data_sets_take_systems_of_the_catalogue(tmp_path):
    settings = {"num_envs": 4, "steps": 10, "dt": 0.1, "task": {"expressions": {"observe": ["q", "q'"], "reward": "-q^2"}}}
    written = [libration.datasets.write(tmp_path / name, settings, system=system) for name, system in (
        ("a", System("pendulum")), ("b", System("pendulum").equations()))]
    assert written[0].transitions == written[1].transitions == 40
    assert libration.datasets.verify(tmp_path / "a", replay=True) == []
