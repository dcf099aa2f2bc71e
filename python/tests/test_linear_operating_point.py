"""Linear plants of nonlinear functions at operating points that are solved for."""

import numpy as np
import pytest

from libration import Difference, LinearPlant

GRAVITY = 9.81


def pendulum(x, u, length=0.7):
    """The angle from the top."""
    return [x[1], GRAVITY / length * np.sin(x[0]) + u[0]]


def cart_pole(x, u, cart=1.0, pole=0.1, length=0.5):
    """A. G. Barto, R. S. Sutton and C. W. Anderson, IEEE Transactions on Systems, Man, and Cybernetics 13, 1983, without friction."""
    _, speed, angle, rate = x
    push = (u[0] + pole * length * rate**2 * np.sin(angle)) / (cart + pole)
    turn = GRAVITY * np.sin(angle) - np.cos(angle) * push
    turn /= length * (4 / 3 - pole * np.cos(angle) ** 2 / (cart + pole))
    return [speed, push - pole * length * turn * np.cos(angle) / (cart + pole), rate, turn]


def quadrotor(x, u, mass=0.65, inertia=0.0075, arm=0.16, thrust=1e-5, drag=0.35, wind=4.0):
    """A planar quadrotor with quadratic drag in a steady wind; the inputs are the speeds of its rotors."""
    _, _, pitch, vx, vz, rate = x
    relative = np.array([vx - wind, vz])
    pull = -drag * np.hypot(*relative) * relative / mass
    left, right = thrust * u[0] ** 2, thrust * u[1] ** 2
    up = (left + right) / mass
    return [vx, vz, rate, pull[0] - up * np.sin(pitch), pull[1] + up * np.cos(pitch) - GRAVITY, arm * (left - right) / inertia]


def close(found, exact, plant):
    """Whether entries, states and then inputs, have at most the error that the plant states.

    The error is relative to the largest entry of the row in units of the scales. It is an estimate from few differences of random
    roundings, so twice as much is allowed, and ten roundings of the exact entries.
    """
    point = plant.operating_point
    exact = np.asarray(exact, dtype=float)
    sizes = np.max(np.abs(exact) * point.scale, axis=1, keepdims=True)
    allowed = (2 * point.jacobian_error + 10 * np.finfo(float).eps) * sizes
    return (np.abs(found - exact) * point.scale <= allowed).all() and point.jacobian_error < 1e-8


def rows(plant):
    """A and B side by side."""
    return np.hstack([plant.A, plant.B])


def test_an_inverted_pendulum_has_the_square_of_its_rate_g_over_l():
    plant = LinearPlant.linearize(pendulum, [0.3, 0.1], 0.0)
    assert np.abs(plant.operating_point.x).max() < 1e-15
    assert close(rows(plant), np.hstack([[[0, 1], [GRAVITY / 0.7, 0]], [[0], [1]]]), plant)
    hanging = LinearPlant.linearize(pendulum, [2.5, 0.1], 0.0)
    assert hanging.operating_point.x == pytest.approx([np.pi, 0], abs=1e-15)
    assert close(rows(hanging), [[0, 1, 0], [-GRAVITY / 0.7, 0, 1]], hanging)
    # sin of the double next to π is 1.2e-16.
    assert hanging.operating_point.residual < 3e-15
    assert f"residual {hanging.operating_point.residual:.1e}" in repr(hanging)


def test_a_torque_that_holds_a_pendulum_is_solved_for():
    plant = LinearPlant.linearize(
        pendulum, [0.4, 0.1], 0.0, fixed_states="angle", free_inputs=[0], states=["angle (rad)", "rate (rad/s)"]
    )
    point = plant.operating_point
    assert point.x == pytest.approx([0.4, 0], abs=1e-15)
    assert point.u == pytest.approx([-GRAVITY / 0.7 * np.sin(0.4)], rel=1e-15)
    assert close(rows(plant), [[0, 1, 0], [GRAVITY / 0.7 * np.cos(0.4), 0, 1]], plant)
    assert plant.states == ["angle (rad)", "rate (rad/s)"]


def test_a_cart_pole_is_that_of_its_closed_form_wherever_the_cart_stands():
    plant = LinearPlant.linearize(cart_pole, [2.0, 0.1, 0.2, 0.0], 0.0)
    # Nothing depends on the position of the cart, so it stays where the search began.
    assert plant.operating_point.x == pytest.approx([2.0, 0, 0, 0], abs=1e-12)
    inverse = 1 / (0.5 * (4 / 3 - 0.1 / 1.1))
    a = np.zeros((4, 4))
    a[0, 1] = a[2, 3] = 1
    a[3, 2], a[1, 2] = GRAVITY * inverse, -0.1 * 0.5 / 1.1 * GRAVITY * inverse
    b = [[0], [(1 + 0.05 / 1.1 * inverse) / 1.1], [0], [-inverse / 1.1]]
    assert close(rows(plant), np.hstack([a, b]), plant)


def test_the_rotors_and_the_pitch_of_a_quadrotor_that_hovers_in_wind_are_solved_for():
    plant = LinearPlant.linearize(
        quadrotor, np.zeros(6), [500, 500], fixed_states=[0, 1, 3, 4, 5], free_inputs=[0, 1], u_scale=100, dt=None
    )
    point = plant.operating_point
    # The drag and the weight are the two sides of a right triangle whose hypotenuse is the thrust.
    drag, weight = 0.35 * 4.0**2, 0.65 * GRAVITY
    speed = np.sqrt(np.hypot(drag, weight) / 2e-5)
    assert point.x == pytest.approx([0, 0, np.arctan(drag / weight), 0, 0, 0], rel=1e-14)
    assert point.u == pytest.approx([speed, speed], rel=1e-14)
    pitch, gain = point.x[2], 2e-5 * speed / 0.65
    a = np.zeros((6, 6))
    a[0, 3] = a[1, 4] = a[2, 5] = 1
    a[3, 2], a[4, 2] = -GRAVITY, -drag / 0.65
    a[3, 3], a[4, 4] = -2 * 0.35 * 4 / 0.65, -0.35 * 4 / 0.65
    b = np.zeros((6, 2))
    b[3], b[4], b[5] = -gain * np.sin(pitch), gain * np.cos(pitch), [2e-5 * speed * 0.16 / 0.0075, -2e-5 * speed * 0.16 / 0.0075]
    assert close(rows(plant), np.hstack([a, b]), plant)


def test_predators_and_prey_agree_with_python_control():
    def rates(x, u):
        hares, lynxes = x
        eaten = 3.2 * hares * lynxes / (50 + hares)
        return [(1.6 + u[0]) * hares * (1 - hares / 125) - eaten, 0.6 * eaten - 0.56 * lynxes]

    plant = LinearPlant.linearize(rates, [20, 30], 0)
    # The equilibrium by scipy.optimize.root of SciPy 1.17.1 with tol=1e-14. K. J. Åström and R. M. Murray, Feedback Systems, second
    # edition, section 3.7, has the model and (20.6, 29.5).
    assert plant.operating_point.x == pytest.approx([20.588235294117652, 29.480968858131487], rel=1e-14)
    # control.linearize of python-control 0.10.2 at the point of its find_operating_point. Its forward differences have a step of 1e-6.
    assert plant.A == pytest.approx(np.array([[0.1262745179531066, -0.9333333323979787], [0.5679999901531119, 0]]), abs=2e-8)
    assert plant.B == pytest.approx(np.array([[17.1972318341318], [0]]), rel=1e-9)


def test_a_step_of_a_simulator_gives_a_sampled_plant():
    def step(x, u, dt):
        # Semi-implicit Euler.
        rate = x[1] + dt * (GRAVITY / 0.7 * np.sin(x[0]) + u[0])
        return [x[0] + dt * rate, rate]

    plant = LinearPlant.linearize(step, [0.3, 0.1], 0.0, dt=0.002)
    assert plant.dt == 0.002
    k, h = GRAVITY / 0.7, 0.002
    assert close(rows(plant), [[1 + h * h * k, h, h * h], [h * k, 1, h]], plant)
    held = LinearPlant.linearize(step, [0.4, 0.0], 0.0, dt=0.002, fixed_states=[0], free_inputs=[0])
    assert held.operating_point.u == pytest.approx([-k * np.sin(0.4)], rel=1e-12)


def test_outputs_are_linearised_at_the_operating_point():
    plant = LinearPlant.linearize(
        pendulum,
        [0.4, 0.0],
        0.0,
        output=lambda x, u: [0.7 * np.sin(x[0]), 3 * u[0] + x[1] ** 2],
        fixed_states=[0],
        free_inputs=[0],
        outputs=["position (m)", "torque"],
        parts=[Difference("position")],
    )
    torque = -GRAVITY / 0.7 * np.sin(0.4)
    assert plant.operating_point.y == pytest.approx([0.7 * np.sin(0.4), 3 * torque], rel=1e-14)
    assert close(np.hstack([plant.C, plant.D]), [[0.7 * np.cos(0.4), 0, 0], [0, 0, 3]], plant)
    assert plant.parts == [Difference("position")]


def test_the_estimated_error_covers_the_true_one_of_functions_that_bend_on_small_lengths():
    for bend in (1.0, 30.0, 1000.0):
        plant = LinearPlant.linearize(lambda x, u: [np.sin(bend * x[0] - 0.3) + u[0]], [0.0], [np.sin(0.3)])
        exact = bend * np.cos(bend * plant.operating_point.x[0] - 0.3)
        assert close(rows(plant), [[exact, 1]], plant), bend
    # Terms of 10 that cancel to zero have more rounding than their difference shows.
    for start in np.linspace(-1, 1, 41):
        force = 10 * np.cos(start) ** 2 / (1 + 0.3 * np.sin(start))
        plant = LinearPlant.linearize(
            lambda x, u: [10 * np.cos(x[0]) ** 2 / (1 + 0.3 * np.sin(x[0])) - u[0]], [start], [force], fixed_states=[0], free_inputs=[0]
        )
        sine = np.sin(start)
        slope = -10 * np.cos(start) * (2 * sine * (1 + 0.3 * sine) + 0.3 * (1 - sine**2)) / (1 + 0.3 * sine) ** 2
        assert close(rows(plant), [[slope, -1]], plant), start
    # Of a magnetic bearing with a gap of 0.4 mm, whose force has poles there, only steps within the gap are used.
    gap = 4e-4
    with np.errstate(divide="raise", invalid="raise"):

        def bearing(x, u):
            if abs(x[0]) >= gap:
                return [np.nan, np.nan]
            return [x[1], 1e-4 * ((1 + u[0]) ** 2 / (gap - x[0]) ** 2 - (1 - u[0]) ** 2 / (gap + x[0]) ** 2)]

        plant = LinearPlant.linearize(bearing, [1e-5, 0], 0.0)
    assert close(rows(plant), [[0, 1, 0], [4e-4 / gap**3, 0, 4e-4 / gap**2]], plant)


def test_functions_may_change_their_arguments_and_return_the_same_array_again():
    memory = np.zeros(2)

    def step(x, u, dt):
        memory[:] = x[0] + dt * x[1], x[1] + dt * (u[0] - x[0])
        x[:] = 7
        u[:] = 7
        return memory

    measured = np.zeros(1)

    def output(x, u):
        measured[0] = np.sin(x[0])
        return measured

    plant = LinearPlant.linearize(step, [0.5, 0.0], [0.1], dt=0.1, output=output)
    assert close(np.hstack([plant.C, plant.D]), [[np.cos(0.1), 0, 0]], plant)
    assert close(rows(plant), [[1, 0.1, 0], [-0.1, 1, 0.1]], plant)
    assert plant.operating_point.x == pytest.approx([0.1, 0], abs=1e-15)


def test_a_hundred_states_are_taken():
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(100, 100)), rng.normal(size=(100, 2))
    plant = LinearPlant.linearize(lambda x, u: a @ x + b @ u, rng.normal(size=100), [1.0, -1.0])
    assert close(rows(plant), np.hstack([a, b]), plant)
    assert plant.operating_point.x == pytest.approx(np.linalg.solve(a, b @ [-1.0, 1.0]), rel=1e-6)


@pytest.mark.parametrize(
    "f, more, message",
    [
        (lambda x, u: [x], {}, r"f returns an array of shape \(1, 2\); expected \(2,\)"),
        (lambda x, u: None, {}, r"f returns None; expected an array of shape \(2,\)"),
        (lambda x, u: [x[1], 1j], {}, "f returns dtype complex128; expected real numbers"),
        (lambda x, u: [x[1], np.nan], {}, "f returns nan at x0 and u0"),
        (lambda x, u: [x[1], -x[0] if x[0] <= 0.2 else np.nan], {}, "f is not finite near state 'x1'"),
        (lambda x, u: [x[1], 1.0], {}, "rate of state 'x2' is 1, and nothing that is solved for"),
        (lambda x, u: [x[1], 1 + x[0] ** 2], {}, r"no equilibrium found: after \d+ iterations the rate of state 'x2' is 1 at x = "),
        (pendulum, {"fixed_states": ["x1", 1]}, "all states are fixed and all inputs are held"),
        (lambda x, u: [x[1], 0.2 - x[0] - np.sign(x[1])], {}, "entry 2 of f has no derivative by state 'x2' at 0"),
        (lambda x, u: [x[1], -x[0] - abs(x[1])], {}, "entry 2 of f has no derivative by state 'x2' at 0"),
        (pendulum, {"fixed_states": "angel", "states": ["angle (rad)", "rate"]}, "unknown name 'angel': did you mean 'angle'"),
        (pendulum, {"free_input": [0]}, "unexpected keyword argument 'free_input': did you mean 'free_inputs'"),
        (pendulum, {"free_inputs": [1]}, "free_inputs is 1, but it must be 0 to 0"),
        (pendulum, {"states": ["angle"]}, "states has 1 names; expected 2"),
        (pendulum, {"x_scale": [1, 0]}, "x_scale has the entry 0; expected numbers above 0"),
        (pendulum, {"x_scale": [1, 1, 1]}, r"x_scale has 3 entries; expected 1 or 2"),
        (pendulum, {"dt": -1}, "dt is -1.0, but it must be finite and greater than 0"),
        (pendulum, {"output": lambda x, u: [np.inf]}, "output returns inf at the operating point"),
        ("pendulum", {}, "f is 'pendulum'; expected a function"),
    ],
)
def test_what_cannot_be_linearised_is_refused_with_the_reason(f, more, message):
    with pytest.raises((TypeError, ValueError), match=message):
        LinearPlant.linearize(f, [0.2, 0.0], 0.0, **more)


def test_a_function_that_remembers_its_calls_is_refused():
    calls = []

    def f(x, u):
        calls.append(None)
        return [x[1], -x[0] + 1e-4 * len(calls)]

    with pytest.raises(ValueError, match="for the same x and u"):
        LinearPlant.linearize(f, [0.2, 0.0], 0.0)
