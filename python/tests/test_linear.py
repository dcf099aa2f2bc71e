"""Loops around linear plants from Python."""

import json
import types

import numpy as np
import pytest

import libration
from libration import (
    LQG,
    LQR,
    PD,
    PID,
    Butterworth2,
    Cascade,
    Difference,
    Lag,
    LinearPlant,
    MovingAverage,
    StateFeedback,
    StateSpace,
    Steps,
    advise,
)
from libration.linear import plant_of

A, B = np.array([[0.0, 1.0], [4.0, -0.2]]), np.array([[0.0, 0.0], [1.0, 0.5]])
PENDULUM = LinearPlant(A, B[:, 0], states=["angle (rad)", "rate (rad/s)"], inputs=["torque (N m)"])


def limit(advice, kind, channel=None):
    (found,) = [b for b in advice["budgets"] if b["kind"] == kind and b.get("channel") == channel]
    return found["stable_up_to"]


def test_an_object_with_matrices_is_a_plant_and_its_labels_are_names():
    system = types.SimpleNamespace(
        A=A, B=B, C=[[1.0, 0.0]], D=np.zeros((1, 2)), dt=0, state_labels=["angle", "rate"], input_labels=["left", "right"]
    )
    advice = advise(
        system, LQR(np.diag([10, 1]), np.diag([1, 0.1])), latency=[0.003, 0.010], output_latency=0.02, jitter=0.05
    )
    assert advice.holds and "is stable" in advice.answer
    # Feedback of the state measures the states.
    assert [signal["name"] for signal in advice["outputs"]] == ["angle", "rate"]
    assert limit(advice, "latency", "right") > 0.1
    assert limit(advice, "output-latency", "rate") > 0.02
    # The request is a file that gives the same answer.
    repeated = json.loads(libration._native._advise(advice.request, False, False, None)[0])
    # Its commands name a file, those of a call have the call.
    of = [[{**budget, "command": None} for budget in each["budgets"]] for each in (repeated, advice)]
    assert of[0] == of[1]


def test_the_gain_is_that_of_the_riccati_equation_of_the_sampled_plant():
    advice = advise(PENDULUM, LQR([10, 1], [0.1]), period=0.05)
    gain = np.array(advice["gain"])
    # Value iteration, with weights that are integrated by Simpson's rule over many short steps.
    n, h, parts = 2, 0.05, 200
    whole = np.zeros((3, 3))
    whole[:2, :2], whole[:2, 2] = A, B[:, 0]

    def flow(t):
        term, total = np.eye(3), np.eye(3)
        for k in range(1, 25):
            term = term @ whole * t / k
            total = total + term
        return total

    weight = np.diag([10, 1, 0.1])
    simpson = [1 if k in (0, parts) else 4 if k % 2 else 2 for k in range(parts + 1)]
    cost = sum(w * flow(h * k / parts).T @ weight @ flow(h * k / parts) for k, w in enumerate(simpson)) * h / parts / 3
    phi, gamma = flow(h)[:n, :n], flow(h)[:n, n:]
    x = np.zeros((n, n))
    for _ in range(3000):
        k = np.linalg.solve(cost[n:, n:] + gamma.T @ x @ gamma, gamma.T @ x @ phi + cost[n:, :n])
        x = cost[:n, :n] + phi.T @ x @ phi - (phi.T @ x @ gamma + cost[:n, n:]) @ k
    assert gain == pytest.approx(k, rel=1e-10)


def test_every_controller_of_a_linear_plant_is_taken():
    measured = LinearPlant(A, B[:, 0], [[1.0, 0.0]], inputs=["u"], outputs=["y"])
    for controller in (
        LQG([10, 1], [0.1], [1e-4]),
        StateFeedback([[20.0, 5.0]]),
        StateSpace(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[-20.0]]),
        [("y", "u", PID(20.0, 1.0, 5.0, 0.01))],
    ):
        plant = LinearPlant(A - 3 * np.eye(2), B[:, 0], [[1.0, 0.0]], inputs=["u"], outputs=["y"])
        if not isinstance(controller, StateSpace):
            plant = measured
        advice = advise(plant, controller, latency=Steps(1.5), loss=0.01)
        assert advice.growth < 0 and limit(advice, "latency") > 0.015, controller


def test_lags_shorten_what_latency_is_left_and_stand_in_the_chain():
    free = limit(advise(PENDULUM, StateFeedback([[20.0, 5.0]])), "latency")
    parts = [Lag(0.02, input="torque", name="motor"), Butterworth2(20.0, output=1)]
    late = advise(LinearPlant(A, B[:, 0], states=PENDULUM.states, inputs=PENDULUM.inputs, parts=parts), StateFeedback([[20.0, 5.0]]))
    assert limit(late, "latency") < free - 0.02
    chain = {link["part"]: link["delay"] for link in late["chain"]}
    assert chain["motor"] == 0.02
    # √2/(2πf), as the guide of PX4 has it.
    assert chain["butterworth2 of rate"] == pytest.approx(np.sqrt(2) / (2 * np.pi * 20), rel=1e-12)


def motor(parts=()):
    # The encoder is read twice: as it is, and as a speed.
    c = [[1.0, 0.0], [1.0, 0.0]]
    return LinearPlant(
        [[0.0, 1.0], [0.0, -20.0]],
        [0.0, 200.0],
        c,
        states=["angle (rad)", "speed (rad/s)"],
        inputs=["voltage (V)"],
        outputs=["position (rad)", "velocity (rad)"],
        parts=[Difference("velocity"), *parts],
    )


def test_a_difference_and_an_average_run_with_the_controller():
    gain = StateSpace([], [], [], [[-12.0, -0.6]])
    plain = advise(motor(), gain, period=0.001)
    assert plain["outputs"] == [{"name": "position", "unit": "rad"}, {"name": "velocity", "unit": "rad/s"}]
    averaged = advise(motor([MovingAverage(4, output=1, name="filter")]), gain, period=0.001)
    assert limit(averaged, "latency") < limit(plain, "latency") - 0.0014
    (link,) = [link for link in averaged["chain"] if link["part"] == "filter"]
    assert link["delay"] == pytest.approx(0.0015, rel=1e-12)
    # By plain eigenvalues: the memory is the last three rates, and the last angle.
    phi, gamma = np.eye(4), np.zeros((2, 1))
    term = np.zeros((3, 3))
    term[:2, :2], term[1, 2] = [[0.0, 1.0], [0.0, -20.0]], 200.0
    whole, power = np.eye(3), np.eye(3)
    for k in range(1, 20):
        power = power @ term * 0.001 / k
        whole = whole + power
    phi, gamma = whole[:2, :2], whole[:2, 2:]
    rate = np.array([1.0, 0.0, -1.0, 0.0, 0.0, 0.0]) / 0.001
    command = -12.0 * np.eye(6)[0] - 0.6 * (rate + np.eye(6)[3] + np.eye(6)[4] + np.eye(6)[5]) / 4
    matrix = np.zeros((6, 6))
    matrix[:2, :2] = phi
    matrix[:2] += gamma @ command[np.newaxis]
    matrix[2, 0], matrix[3], matrix[4, 3], matrix[5, 4] = 1.0, rate, 1.0, 1.0
    assert averaged.growth == pytest.approx(2 * np.log(abs(np.linalg.eigvals(matrix)).max()), rel=1e-9)
    with pytest.raises(ValueError, match="averages 0 samples; expected 1 to 100"):
        advise(motor([MovingAverage(0, output=1)]), gain)


def test_a_cascade_is_the_same_by_pid_controllers_by_matrices_and_by_gains():
    pids = Cascade(
        [("velocity", "voltage", PID(0.6, 0.0, 0.0), "speed")], [("position", "speed", PID(20.0, 0.0, 0.0))], every=5
    )
    inner, outer = [[0.0, -0.6, 0.6]], [[-20.0, 0.0]]
    gains = Cascade(inner, outer, every=5, references=["speed (rad/s)"])
    spaces = Cascade(StateSpace([], [], [], inner), StateSpace([], [], [], outer), every=5)
    found = [advise(motor(), one, period=0.001, latency=0.0004, jitter=0.05) for one in (pids, gains, spaces)]
    for other in found[1:]:
        assert other.growth == pytest.approx(found[0].growth, rel=1e-9)
        assert limit(other, "latency") == pytest.approx(limit(found[0], "latency"), rel=1e-9)
    assert found[0]["controller_matrices"] is None and len(found[0]["schedule"]) == 5 and not found[0]["margins"]
    chain = {(link["part"], link["channel"]): link["delay"] for link in found[1]["chain"]}
    assert chain["hold (half of 5 periods)", "speed"] == pytest.approx(0.0025)
    # With one rate it is an ordinary controller.
    single = advise(motor(), Cascade(inner, outer, every=1), period=0.001)
    plain = advise(motor(), StateSpace([], [], [], [[-12.0, -0.6]]), period=0.001)
    assert single.growth == pytest.approx(plain.growth, rel=1e-12) and single["margins"]
    for cascade, wanted in (
        (Cascade(inner, outer, every=0), "`every` is 0; expected 1 to 100 periods"),
        (Cascade(inner, outer, every=5, outer_latency=6), "expected at most 5"),
        (Cascade([[1.0, 2.0]], outer, every=5), "`gain` is 1 × 2; expected 1 × 3: inputs × outputs and references"),
        (Cascade(pids.inner, [("position", "rate", PID(20.0, 0.0, 0.0))], every=5), "unknown reference `speed`"),
    ):
        with pytest.raises(ValueError, match=wanted):
            advise(motor(), cascade)
    with pytest.raises(TypeError, match="expected \\(output, reference, PID\\)"):
        advise(motor(), Cascade(inner, [("position", PID(1.0, 0.0, 0.0))], every=5))


def test_an_estimate_that_measures_time_costs_less_under_jitter():
    plant = LinearPlant(A, B[:, 0], [[1.0, 0.0]], inputs=["u"], outputs=["y"])
    controller = LQG([10, 1], [0.1], [1e-4])
    timing = {"period": 0.1, "latency": 0.02, "jitter": 0.2}
    nominal, measured = (advise(plant, controller, clock=clock, **timing) for clock in (None, "measured"))
    assert measured["cost"] < nominal["cost"]
    assert measured["ideal_cost"] == pytest.approx(nominal["ideal_cost"], rel=1e-9)
    for error, wanted, refused in (
        (ValueError, "unknown value `sundial` of `clock`", lambda: advise(plant, controller, clock="sundial")),
        (
            ValueError,
            "nothing in the controller depends on the length of a period",
            lambda: advise(PENDULUM, StateFeedback([[20.0, 5.0]]), clock="measured"),
        ),
        (
            ValueError,
            "the controller is a cascade",
            lambda: advise(motor(), Cascade([[0.0, -0.6, 0.6]], [[-20.0, 0.0]], every=5), clock="measured"),
        ),
        (TypeError, "clock requires a linear plant", lambda: advise("oscillator", PD(10.0, 2.0), clock="measured")),
    ):
        with pytest.raises(error, match=wanted):
            refused()


def test_a_sampled_plant_keeps_its_step():
    phi, gamma = np.array([[1.0, 0.01], [0.04, 0.998]]), np.array([[5e-5], [0.01]])
    system = types.SimpleNamespace(A=phi, B=gamma, C=np.eye(2), D=np.zeros((2, 1)), dt=0.01)
    advice = advise(system, StateFeedback([[20.0, 5.0]]), latency=0.02, loss=0.1)
    assert advice.holds and {b["kind"] for b in advice["budgets"]} == {"latency", "output-latency", "loss"}
    # Commands that wait for d periods, by plain eigenvalues.
    stable = []
    for d in range(40):
        whole = np.zeros((2 + d, 2 + d))
        whole[:2, :2] = phi
        command = np.zeros((1, 2 + d))
        command[0, :2] = [-20.0, -5.0]
        if d == 0:
            whole[:2] += gamma @ command
        else:
            whole[:2, 1 + d] += gamma[:, 0]
            whole[2] = command
            for i in range(3, 2 + d):
                whole[i, i - 1] = 1.0
        stable.append(abs(np.linalg.eigvals(whole)).max() < 1)
    assert limit(advice, "latency") == pytest.approx(0.01 * (stable.index(False) - 1), rel=1e-12)
    with pytest.raises(ValueError, match="between its samples"):
        advise(system, StateFeedback([[20.0, 5.0]]), latency=0.015)


def test_weights_of_outputs_add_to_those_of_the_states_and_a_sampled_plant_needs_no_period():
    A, B, C = [[0.0, 1.0], [-4.0, -0.5]], [[0.0], [1.0]], [[2.0, 1.0]]
    plant = libration.LinearPlant(A, B, C)
    outputs = advise(plant, LQR(None, [0.1], outputs=[3.0]), period=0.05)
    states = advise(plant, LQR([[13.0, 6.0], [6.0, 3.0]], [0.1]), period=0.05)
    both = advise(plant, LQR([1.0, 0.0], [0.1], outputs=[3.0]), period=0.05, cost_weights={"outputs": [3.0], "inputs": [0.1]})
    assert both["gain"] == states["gain"] != outputs["gain"]
    weights = ([[12.0, 6.0], [6.0, 3.0]], [0.1])
    assert both["cost"] == advise(plant, LQR([1.0, 0.0], [0.1], outputs=[3.0]), period=0.05, cost_weights=weights)["cost"]
    with pytest.raises(ValueError, match="no weights of `states` or `outputs`"):
        advise(plant, LQR(None, [0.1]))
    with pytest.raises(ValueError, match="'commands'.*expected 'states', 'outputs' and 'inputs'"):
        advise(plant, StateFeedback([[1.0, 1.0]]), cost_weights={"commands": [1.0]})
    sampled = libration.LinearPlant([[1.0, 0.1], [0.0, 0.95]], [[0.005], [0.1]], dt=0.1)
    advice = advise(sampled, LQR([1.0, 1.0], [1.0]), latency=libration.Steps(2))
    assert advice["period"] == 0.1 and advice["budgets"][0]["stated"] == 0.2


def test_missed_deadlines_are_judged_as_by_their_matrices():
    plant = LinearPlant([[0.0, 1.0], [9.0, 0.0]], [0.0, 1.0])
    gain, h = np.array([[14.0, 4.5]]), 0.1
    term = total = np.eye(3)
    generator = np.array([[0.0, 1.0, 0.0], [9.0, 0.0, 1.0], [0.0, 0.0, 0.0]]) * h
    for k in range(1, 20):
        term = term @ generator / k
        total = total + term
    # On the state and the command that acts, which is sent at the end of a period.
    met, missed = total.copy(), total.copy()
    met[2] = np.append(-gain[0], 0.0)
    advice = advise(plant, StateFeedback(gain), period=h, latency=h, deadline_misses="3 of 5", overrun="kill", missing="hold")
    worst = advice["deadline_misses"]["worst_case"]
    product = np.eye(3)
    for outcome in worst["stated"]["sequence"]:
        product = (met if outcome == "met" else missed) @ product
    growth = abs(np.linalg.eigvals(product)).max() ** (1 / len(worst["stated"]["sequence"]))
    assert worst["stated"]["lower"] == pytest.approx(growth, rel=1e-10)
    assert growth > 1 and not advice.holds and worst["stable_up_to"] == 2
    # Jobs that overrun at random and are killed: E[M ⊗ M].
    advice = advise(plant, StateFeedback(gain), period=h, latency=h, overrun_probability=0.1)
    mean = 0.9 * np.kron(met, met) + 0.1 * np.kron(missed, missed)
    growth = np.log(abs(np.linalg.eigvals(mean)).max())
    assert advice["deadline_misses"]["random"]["growth"] == pytest.approx(growth, rel=1e-9)


def test_a_redesign_is_cheaper_with_the_latency_it_is_made_for():
    advice = advise(PENDULUM, LQR([10, 1], [0.1]), period=0.05, latency=0.08, redesign=True)
    assert advice["redesign"]["cost"] < advice["cost"]
    with pytest.raises(ValueError, match="redesign requires a linear plant"):
        advise("oscillator", PD(10.0, 2.0), redesign=True)


MASS, DAMPING, STIFFNESS = [[2.0, 0.5], [0.5, 1.0]], [[0.3, -0.1], [-0.1, 0.2]], [[50.0, -20.0], [-20.0, 30.0]]


def response(plant, s):
    """The transfer matrix of a plant."""
    n = np.shape(plant.A)[0]
    return np.asarray(plant.C) @ np.linalg.solve(s * np.eye(n) - plant.A, plant.B) + plant.D


def test_a_mechanical_plant_has_the_response_of_its_masses_dampers_and_springs():
    plant = LinearPlant.mechanical(MASS, DAMPING, STIFFNESS, [1.0, 0.0], states=["motor (rad)", "load (rad)"], inputs=["torque (N m)"])
    assert plant.states == ["motor (rad)", "load (rad)", "motor' (rad/s)", "load' (rad/s)"]
    assert plant.outputs == ["motor (rad)", "load (rad)"] and plant.inputs == ["torque (N m)"] and plant.dt is None
    for omega in (0.1, 3.0, 40.0):
        s = 1j * omega
        wanted = np.linalg.solve(s**2 * np.array(MASS) + s * np.array(DAMPING) + STIFFNESS, [[1.0], [0.0]])
        np.testing.assert_allclose(response(plant, s), wanted, rtol=1e-12)
    # By default each coordinate has an input, and noise enters where the inputs do.
    free = LinearPlant.mechanical(2.0)
    np.testing.assert_array_equal(free.A, [[0, 1], [0, 0]])
    np.testing.assert_array_equal(np.hstack([free.B, free.G]), [[0, 0], [0.5, 0.5]])
    other = LinearPlant.mechanical(MASS, C=[[0, 0, 1, 0]], G=[0, 0, 1, 0], D=[[0.0, 7.0]], parts=[Lag(0.01, input=0)])
    np.testing.assert_array_equal(other.C, [[0, 0, 1, 0]])
    np.testing.assert_array_equal(other.G, [[0], [0], [1], [0]])
    np.testing.assert_array_equal(other.D, [[0, 7]])
    assert other.outputs == ["y1"] and len(other.parts) == 1
    np.testing.assert_array_equal(LinearPlant.mechanical(MASS, D=[[0, 1], [2, 3]]).D, [[0, 1], [2, 3]])
    # The request has the names and the units.
    advice = advise(plant, LQR([1, 1, 1, 1], [1]), period=0.1)
    assert advice["states"][3] == {"name": "load'", "unit": "rad/s"} and advice.holds


NUMERATORS = [[[1.0], [2.0, 3.0]], [[0.0], [1.0, 0.5, 3.0]]]
DENOMINATORS = [[[5.0, 1.0], [3.0, 4.0, 1.0]], [[1.0], [2.0, 1.0, 4.0]]]


def rational(numerators, denominators, s):
    return [[np.polyval(n, s) / np.polyval(d, s) for n, d in zip(*rows)] for rows in zip(numerators, denominators)]


def test_a_plant_of_transfer_functions_has_their_response():
    plant = LinearPlant.transfer_function(NUMERATORS, DENOMINATORS, inputs=["left", "right"], outputs=["a (m)", "b (m)"])
    assert plant.inputs == ["left", "right"] and plant.outputs == ["a (m)", "b (m)"] and len(plant.states) == 5
    for s in (0.3j, 2.0j, 1.0 + 5.0j):
        np.testing.assert_allclose(response(plant, s), rational(NUMERATORS, DENOMINATORS, s), rtol=1e-12, atol=1e-15)
    one = LinearPlant.transfer_function([0.1], [1.0, -0.9], dt=0.01)
    assert one.dt == 0.01 and advise(one, StateSpace([], [], [], [[-1.0]]), period=0.01).holds
    np.testing.assert_array_equal([one.A, one.C * one.B], [[[0.9]], [[0.1]]])
    array = LinearPlant.transfer_function(np.array([[[0.0, 1.0]]]), np.array([[[1.0, 2.0]]]))
    np.testing.assert_array_equal([array.A, array.C * array.B], [[[-2.0]], [[1.0]]])


def test_an_object_with_numerators_and_denominators_is_a_plant():
    controller = LQG([1] * 5, [1, 1], [0.01, 0.01])
    wanted = LinearPlant.transfer_function(NUMERATORS, DENOMINATORS)
    lists = {"num": NUMERATORS, "den": [[np.array(one) for one in row] for row in DENOMINATORS]}
    names = {"input_labels": ["left", "right"], "output_labels": ["a", "b"], "state_labels": []}
    new = {"num_list": lists["num"], "den_list": lists["den"], "num": None, "den": None}
    for given in (lists, new):
        system = types.SimpleNamespace(**given, **names, dt=0, to_ss=lambda: 1 / 0)
        found = plant_of(system)
        assert (found.inputs, found.outputs, found.dt) == (["left", "right"], ["a", "b"], None)
        for matrix in "ABCD":
            np.testing.assert_array_equal(getattr(found, matrix), getattr(wanted, matrix))
    advice = advise(system, controller, period=0.1)
    assert [signal["name"] for signal in advice["inputs"]] == ["left", "right"]
    # SciPy's have one input, with a common denominator of several outputs.
    plain = types.SimpleNamespace(num=np.array([1.0, 2.0]), den=np.array([1.0, 3.0, 4.0]), dt=0.1)
    common = types.SimpleNamespace(num=np.array([[0.0, 1.0], [1.0, 2.0]]), den=np.array([1.0, 3.0]), dt=None)
    for system, outputs, dt in ((plain, 1, 0.1), (common, 2, None)):
        found = plant_of(system)
        assert (np.shape(found.C)[0], found.dt) == (outputs, dt)
        s = 0.5j
        polynomials = np.polyval(system.num.T, s) / np.polyval(system.den, s)
        np.testing.assert_allclose(response(found, s)[:, 0], polynomials, rtol=1e-14)
    with pytest.raises(ValueError, match="system.dt is True"):
        advise(types.SimpleNamespace(num=[1.0], den=[1.0, 1.0], dt=True), controller)


def test_transfer_functions_of_other_packages_are_plants():
    signal = pytest.importorskip("scipy.signal")
    s = 0.7j
    for system in (
        signal.TransferFunction([1.0, 2.0], [1.0, 3.0, 4.0]),
        signal.TransferFunction([[0.0, 1.0], [1.0, 2.0]], [1.0, 3.0]),
        signal.TransferFunction([1.0], [1.0, -0.5], dt=0.1),
        signal.ZerosPolesGain([-1.0], [-2.0, -3.0], 4.0),
    ):
        a, b, c, d = (getattr(system.to_ss(), name) for name in "ABCD")
        wanted = c @ np.linalg.solve(s * np.eye(len(a)) - a, b) + d
        found = plant_of(system)
        assert found.dt == system.dt
        np.testing.assert_allclose(response(found, s), wanted, rtol=1e-13)


@pytest.mark.parametrize(
    "make, error, wanted",
    [
        (lambda: LinearPlant.mechanical([[1, 0], [0, 0]]), ValueError, "the mass matrix is singular: `q2` has no inertia"),
        (lambda: LinearPlant.mechanical(MASS, [[1.0]]), ValueError, "`damping` is 1 × 1; expected 2 × 2"),
        (lambda: LinearPlant.mechanical(MASS, force=[1, 2, 3]), ValueError, "`force` is 3 × 1; expected 2 rows"),
        (lambda: LinearPlant.mechanical(MASS, C=[1, 2, 3]), ValueError, "`C` is 1 × 3; expected 4 columns"),
        (lambda: LinearPlant.mechanical(MASS, stiffness=[[np.inf]]), ValueError, "stiffness has an entry that is not finite"),
        (lambda: LinearPlant.mechanical([[1, 2], [3]]), ValueError, "mass is .*; expected rows of equal length"),
        (lambda: LinearPlant.mechanical(MASS, states=["q"]), ValueError, "1 names of states for 2 states"),
        (lambda: LinearPlant.mechanical(MASS, states="ab"), TypeError, "states is 'ab'; expected a list"),
        (lambda: LinearPlant.mechanical(MASS, stifness=MASS), TypeError, "'stifness': did you mean 'stiffness'"),
        (lambda: LinearPlant.transfer_function([1, 0, 0], [1, 1]), ValueError, "numerator of higher degree than its denominator"),
        (lambda: LinearPlant.transfer_function([1], [0.0]), ValueError, "a denominator of zero"),
        (lambda: LinearPlant.transfer_function(1, [1, 1]), TypeError, "numerator is 1; expected a polynomial"),
        (lambda: LinearPlant.transfer_function([[1]], [[1, 1]]), TypeError, r"numerator is \[\[1\]\]; expected a polynomial"),
        (lambda: LinearPlant.transfer_function([[[1], 2]], [[[1], [2]]]), TypeError, r"numerator\[0\]\[1\] is 2; expected the coeff"),
        (lambda: LinearPlant.transfer_function([[[1]], 2], [[[1]], [[2]]]), TypeError, r"numerator\[1\] is 2; expected a polynomial"),
        (lambda: LinearPlant.transfer_function([[[1], [1]]], [[[1, 1]]]), ValueError, "`denominator` is 1 × 1; expected 1 × 2 polynom"),
        (lambda: LinearPlant.transfer_function([1], [1, np.nan]), ValueError, "denominator has an entry that is not finite"),
        (lambda: LinearPlant.transfer_function([1j], [1, 1]), TypeError, "numerator has dtype complex128"),
        (lambda: LinearPlant.transfer_function([1], [1, 1], dt=True), TypeError, "dt must be a number, not bool"),
        (lambda: LinearPlant.transfer_function([1], [1, 1], dt=0), ValueError, "dt is 0.0, but it must be finite and greater than 0"),
    ],
)
def test_plants_of_other_forms_name_what_is_wrong(make, error, wanted):
    with pytest.raises(error, match=wanted):
        make()


def test_a_tolerance_is_a_pair():
    latency = advise(PENDULUM, StateFeedback([[20.0, 5.0]]), tolerance=("cost", 0.5))["budgets"][0]
    assert 0 < latency["tolerated_up_to"] < latency["stable_up_to"]
    for tolerance in ({"cost": 0.05}, "cost", ("cost",), (0.05, "cost"), 0.05):
        with pytest.raises(TypeError, match=r"tolerance is .*; expected a pair like \('cost', 0.05\)"):
            advise(PENDULUM, StateFeedback([[20.0, 5.0]]), tolerance=tolerance)
        with pytest.raises(TypeError, match=r"expected a pair like \('energy', 1e-6\)"):
            advise("oscillator", PD(10.0, 2.0), tolerance=tolerance)


def test_a_controller_of_another_package_is_shown_on_one_line_with_help():
    class System:
        def __repr__(self):
            return "StateSpace(\narray([[1.]]),\n        array([[2.]]))"

    system = System()
    for controller, name in ((system, "controller"), (Cascade(system, [[1.0]], every=2), "inner")):
        system.A = system.B = system.C = system.D = [[1.0]]
        with pytest.raises(TypeError) as raised:
            advise(PENDULUM, controller)
        message = str(raised.value)
        assert message.startswith(f"{name} is StateSpace( array([[1.]]), array([[2.]])); expected")
        assert message.endswith(
            "help: libration.StateSpace(A, B, C, D) is u = C m + D y, without the minus of a negative feedback"
        )
    del system.D
    with pytest.raises(TypeError) as raised:
        advise(PENDULUM, system)
    assert "help" not in str(raised.value) and "\n" not in str(raised.value)


def test_bad_input_is_refused_by_name():
    for controller, keywords, error, wanted in (
        (None, {}, TypeError, "controller is missing"),
        (LQR([1, 1, 1], [1]), {}, ValueError, "`states` has 3 numbers; expected 2"),
        (LQR([1, 1, 1]), {}, ValueError, "expected LQR\\(Q, R\\)"),
        (LQR([1, np.nan], [1]), {}, ValueError, "Q has an entry that is not finite"),
        (StateFeedback([[1.0]]), {}, ValueError, "`gain` is 1 × 1; expected 1 × 2"),
        (StateFeedback([[20.0, 5.0]]), {"latency": [1, 2]}, ValueError, "2 values; expected one"),
        (StateFeedback([[20.0, 5.0]]), {"q": [1.0]}, TypeError, "q cannot be combined with a linear plant"),
        (StateFeedback([[20.0, 5.0]]), {"latency": -1.0}, ValueError, "expected a finite number of at least 0"),
        (StateFeedback([[20.0, 5.0]]), {"deadline_misses": (2, 5)}, TypeError, "expected text like '2 of 5'"),
        (StateFeedback([[20.0, 5.0]]), {"deadline_misses": "5 of 2"}, ValueError, "expected `m of K`"),
        (StateFeedback([[20.0, 5.0]]), {"cost_weights": (1, 2, 3)}, TypeError, "expected \\(Q, R\\), weights of states and inputs"),
        (StateFeedback([[20.0, 5.0]]), {"measurement_noise": [0.0, -1.0]}, ValueError, "expected a finite variance of at least 0"),
        (StateFeedback([[20.0, 5.0]]), {"overrun": "drop"}, ValueError, "unknown value `drop`"),
        (PID(1.0, 0.0, 0.0), {}, TypeError, "expected LQR"),
    ):
        with pytest.raises(error, match=wanted):
            advise(PENDULUM, controller, **keywords)
    with pytest.raises(TypeError, match="states is 'xy'; expected a list"):
        advise(LinearPlant(A, B, states="xy"), LQR([1, 1], [1]))
    with pytest.raises(ValueError, match="a"):
        advise(LinearPlant([], []), LQR([1, 1], [1]))
    with pytest.raises(ValueError, match="dt is True"):
        advise(types.SimpleNamespace(A=A, B=B, C=A, D=B, dt=True), LQR([1, 1], [1, 1]))
    for name, value in (("output_latency", 0.1), ("deadline_misses", "1 of 2")):
        with pytest.raises(TypeError, match=f"{name} requires a linear plant"):
            advise("oscillator", PD(10.0, 2.0), **{name: value})


@pytest.mark.parametrize(
    "call",
    [
        lambda: advise(PENDULUM, LQR([10, 1], [0.1]), period=0.05, page=True),
        lambda: advise(PENDULUM, StateFeedback([[20.0, 5.0]]), latency=0.01, jitter=("uniform", 0.05)),
        lambda: advise("oscillator", libration.PD(10.0, 2.0), horizon=1.0, loss=0.1),
        lambda: advise("oscillator", q=[1.0], tolerance=("energy", 1e-3), horizon=1.0),
        lambda: advise("oscillator", libration.PD(-10.0, -2.0)),
    ],
)
def test_the_call_that_repeats_advice_can_be_pasted(call):
    advice = call()
    assert advice.repeat_command.startswith("libration.advise(config={") and "config.toml" not in (advice.page or "")
    again = eval(advice.repeat_command)
    assert again.answer == advice.answer and again.repeat_command == advice.repeat_command


def test_advice_on_a_file_is_repeated_by_the_command_on_that_file(tmp_path):
    file = tmp_path / "my loop.toml"
    file.write_text(advise(PENDULUM, LQR([10, 1], [0.1]), period=0.05).request)
    assert advise(config=file).repeat_command == f"libration advise --config '{file}'"


def test_a_loop_of_the_wrong_sign_has_advice_with_a_verdict_and_a_page():
    advice = advise(PENDULUM, StateFeedback([[-20.0, -5.0]]), period=0.01, page=True)
    assert not advice.holds and advice.verdict["outcome"] == "unstable"
    assert "the opposite sign of all gains" in advice.answer and "The loop is unstable" in advice.page
