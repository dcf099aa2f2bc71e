"""Linear plants as systems by equations."""

import pickle

import numpy as np
import pytest
from scipy.linalg import expm

import libration
from libration import EquationSystem, LinearPlant, VectorEnv

MASSES = LinearPlant.mechanical(np.eye(2), 0.1 * np.eye(2), [[20.0, -10.0], [-10.0, 20.0]], [1.0, 0.0], states=["a (m)", "b (m)"], inputs=["f (N)"])
MOTOR = LinearPlant([[-2.0, 0.5], [-0.25, -40.0]], [[0.0], [20.0]], states=["speed (rad/s)", "current (A)"])


@pytest.mark.parametrize("plant", [MASSES, MOTOR])
def test_environments_of_a_plant_move_as_its_matrix_exponential(plant):
    a, b = np.array(plant.A), np.array(plant.B)
    n = len(a)
    power = expm(0.02 * np.block([[a, b], [np.zeros((1, n + 1))]]))
    command = EquationSystem.from_plant(plant).inputs[0]
    envs = VectorEnv(plant, 1, dt=0.02, substeps=40, integrator="rk4", dtype="float64", max_action=5.0, reward=f"-{command}^2")
    state = np.linspace(0.1, 0.4, n)
    envs.reset(seed=0, options={"state": state})
    for step in range(40):
        action = np.sin(step)
        observations = envs.step(np.array([[action]]))[0]
        state = (power @ np.append(state, action))[:n]
    # Of RK4: 40 steps of hλ = 0.02 in each of 40 periods err by (hλ)⁵/120 each, of what has not decayed.
    assert np.abs(observations[0] - state).max() < 1e-8


def test_a_state_with_the_rate_of_its_name_is_a_coordinate_and_units_stay():
    system = EquationSystem.from_plant(MASSES, name="two-masses")
    assert system.name == "two-masses" and system.states == ("a", "b", "a'", "b'") and system.inputs == ("f",)
    assert [state["unit"] for state in system.summary["states"]] == ["m", "m", "m/s", "m/s"]
    assert EquationSystem.from_plant(MOTOR).states == ("speed", "current")
    plain = LinearPlant([[0.0, 1.0], [-1.0, 0.0]], [[0.0], [1.0]])
    assert EquationSystem.from_plant(plain).states == ("x1", "x2")


def test_environments_of_a_plant_have_rollouts_buffers_pickles_and_pictures():
    given = dict(dt=0.02, dtype="float64", max_action=5.0, reward="-a^2 - 0.01*f^2", render_mode="rgb_array")
    envs, others = (VectorEnv(MASSES, 3, **given) for _ in range(2))
    envs.reset(seed=1), others.reset(seed=1)
    rollout = envs.rollout(libration.policies.Linear([1.0, 2.0, 3.0, 4.0]), 5)
    buffer = libration.ReplayBuffer(envs, steps=10)
    buffer.insert(rollout)
    assert buffer.sample(7).observations.shape == (7, 4)
    again = pickle.loads(pickle.dumps(others))
    actions = np.array([[0.5], [-1.0], [2.0]])
    assert np.array_equal(others.step(actions)[0], again.step(actions)[0])
    assert [picture.shape for picture in again.render()] == [(300, 300, 3)] * 3


def test_a_picture_of_states_has_bars_as_long_as_its_axis_says():
    system = libration.System(acceleration={"q": "u"}, rate={"i": "0"}, inputs=["u"])
    env = VectorEnv(system, 1, dt=0.1, reward="0", dtype="float64", render_mode="rgb_array")
    env.reset(seed=0, options={"state": [100.0, -1.0, 0.0]})
    (picture,) = env.render()
    blue, grey = (np.all(np.abs(picture.astype(int) - colour) < 3, axis=2) for colour in ([31, 119, 180], [60, 64, 72]))
    # 300 pixels from -1 to 1: 100 is at 0.9, and -1 at 0.9·asinh(10)/asinh(1000).
    assert np.flatnonzero(blue[50])[[0, -1]].tolist() == pytest.approx([150, 150 * 1.9], abs=2)
    assert np.flatnonzero(grey[150])[[0, -1]].tolist() == pytest.approx([150 * (1 - 0.9 * np.arcsinh(10) / np.arcsinh(1000)), 150], abs=2)
    assert np.count_nonzero(grey[250]) <= 3 and not blue[100:].any()


@pytest.mark.parametrize(
    ("plant", "text"),
    [
        (LinearPlant([[0.5]], [[1.0]], dt=0.1), r"dt of the plant is 0\.1, but it must be None"),
        (LinearPlant([[0.0]], [[1.0]], parts=[libration.Lag(0.1, input=0)]), "the plant has 1 parts, but it must have none"),
        (LinearPlant([[0.0]], [[1.0]], states=["a b"]), "states has 'a b', but in equations"),
        (LinearPlant(np.eye(2), [[1.0], [1.0]], states=["a (m)", "a (s)"]), "states has 'a' twice"),
        (LinearPlant([[0.0]], [[1.0]], states=["a", "b"]), "states has 2 names, but it must have 1"),
        (LinearPlant([[0.0, 2.0], [0.0, 0.0]], [[0.0], [1.0]], states=["a", "a'"]), r"the derivative of 'a' is 2\.0\*a', but it must be \"a'\""),
        (LinearPlant([[0.0, 1.0]], [[1.0]]), "A has shape"),
    ],
)
def test_a_plant_without_equations_is_refused(plant, text):
    with pytest.raises(ValueError, match=text):
        EquationSystem.from_plant(plant)
