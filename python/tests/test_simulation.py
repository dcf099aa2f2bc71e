"""Trajectories from Python: those of the engine, whoever computes the force."""

import copy
import math
import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest

import libration
from libration import CustomSystem, Ensemble, Steps, System, simulate
from libration.policies import MLP, Random

METHODS = [name for name in libration.INTEGRATORS if name != "exact"]
SPRING = System("oscillator", omega2=10.0)


def spring(q, v):
    return -10.0 * q


def test_a_trajectory_has_named_columns_with_units_and_ends_where_the_exact_solution_does():
    path = simulate(SPRING, integrator="exact", dt=0.1, steps=100, save_every=30)
    assert list(path) == ["step", "t", "q", "q'", "energy"]
    assert [path.units[name] for name in path] == ["1", "s", "m", "m/s", "J/kg"]
    np.testing.assert_array_equal(path["step"], [0, 30, 60, 90, 100])
    assert path.q.shape == path.v.shape == (5, 1) and path.stopped is None
    assert list(path.to_pandas().columns) == list(path)
    # Each of the 100 steps rounds both coordinates, which are at most 1 and √10.
    expected = np.cos(math.sqrt(10) * path.t)
    assert np.abs(path.q[:, 0] - expected).max() < 100 * 4 * np.finfo(float).eps


@pytest.mark.parametrize("integrator", METHODS)
@pytest.mark.parametrize("single", [False, True])
def test_a_custom_system_steps_to_the_bits_of_the_catalogue(integrator, single):
    rng = np.random.default_rng(1)
    q, v = rng.normal(size=(2, 37, 2))
    dtype = np.float32 if single else np.float64
    built_in = Ensemble(SPRING, integrator=integrator, dt=0.03, q=q, v=v, dtype=dtype)
    for positional in (False, True):
        # The constant has the type of the array, as a parameter of the catalogue has.
        own = CustomSystem(lambda q, v: -dtype(10.0) * q, positional=positional)
        mine = Ensemble(own, integrator=integrator, dt=0.03, q=q, v=v, dtype=dtype)
        mine.advance(50)
        if not positional:
            built_in.advance(50)
        np.testing.assert_array_equal(mine.q, built_in.q)
        np.testing.assert_array_equal(mine.v, built_in.v)
        assert mine.q.dtype == built_in.q.dtype == dtype
    assert (built_in.step, built_in.time) == (50, 50 * 0.03)


# Explicit Euler and others of order 1 add energy, of which a single trajectory warns.
@pytest.mark.filterwarnings("ignore:the energy goes")
@pytest.mark.parametrize("integrator", METHODS)
def test_simulate_and_an_ensemble_take_the_same_steps(integrator):
    path = simulate("pendulum", integrator=integrator, dt=0.05, steps=200, q=2.0, v=0.1)
    swings = Ensemble("pendulum", integrator=integrator, dt=0.05, q=[2.0, 1.0], v=[0.1, 0.0])
    swings.advance(120)
    swings.advance(80)
    assert (swings.q[0, 0], swings.v[0, 0]) == (path["q"][-1], path["q'"][-1])
    assert swings.energy[0] == path.energy[-1]


@pytest.mark.parametrize("integrator", libration.IMPLICIT_INTEGRATORS)
def test_implicit_integrators_step_the_catalogue_and_equations_alike(integrator):
    equations = System(acceleration={"q": "-9*sin(q)"}, energy="q'^2/2 - 9*cos(q)", start={"q": 1.0})
    path = simulate(System("pendulum", omega2=9.0), integrator=integrator, dt=0.05, steps=100, q=1.0)
    own = simulate(equations, integrator=integrator, dt=0.05, steps=100)
    np.testing.assert_array_equal(own["q"], path["q"])
    with pytest.raises(ValueError, match="implicit ones are those of simulate and analyze only"):
        Ensemble("pendulum", integrator=integrator, dt=0.05, q=[1.0], v=[0.0])


def test_a_function_of_positions_and_velocities_is_a_system():
    built_in = simulate(SPRING, integrator="rk4", dt=0.05, steps=90, save_every=40)
    own = CustomSystem(spring, energy=lambda q, v: ((v * v + 10.0 * q * q) / 2.0)[:, 0])
    for system in (spring, own):
        path = simulate(system, integrator="rk4", dt=0.05, steps=90, save_every=40, q=1.0)
        for name in ("step", "t", "q", "q'"):
            np.testing.assert_array_equal(path[name], built_in[name])
        assert np.isnan(path.energy).all() == (system is spring)
    np.testing.assert_allclose(path.energy, built_in.energy, rtol=4 * np.finfo(float).eps)


def test_a_step_that_needs_the_force_twice_at_a_place_computes_it_once_if_it_is_positional():
    for positional, wanted in ((False, 2 * 10), (True, 10 + 1)):
        calls = []
        own = CustomSystem(lambda q, v: (calls.append(1), -q)[1], positional=positional)
        Ensemble(own, integrator="velocity-verlet", dt=0.1, q=[1.0]).advance(10)
        assert len(calls) == wanted


def test_a_force_may_use_its_memory_again_and_may_not_write_what_it_is_given():
    room = np.zeros((2, 1))

    def again(q, v):
        room[:] = -10.0 * q
        return room

    def writes(q, v):
        v += 1.0
        return -q

    given = {"integrator": "rk4", "dt": 0.01, "q": [1.0, 2.0]}
    mine, wanted = Ensemble(again, **given), Ensemble(SPRING, **given)
    for all in (mine, wanted):
        all.advance(3)
    np.testing.assert_array_equal(mine.q, wanted.q)
    with pytest.raises(ValueError, match="read-only"):
        Ensemble(writes, **given).advance(1)


def test_threads_take_turns_with_a_custom_system():
    one, many = (Ensemble(spring, dt=0.01, q=[1.0, 2.0]) for _ in range(2))
    one.advance(400)
    threads = [threading.Thread(target=lambda: [many.advance(5) for _ in range(20)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert many.step == 400
    np.testing.assert_array_equal(many.q, one.q)


def test_an_ensemble_is_neither_copied_nor_pickled():
    for all in (Ensemble("pendulum", dt=0.01, q=[1.0]), Ensemble(spring, dt=0.01, q=[1.0])):
        for of in (copy.copy, copy.deepcopy, pickle.dumps):
            with pytest.raises(TypeError, match="make another"):
                of(all)


@pytest.mark.parametrize("energy", [lambda q, v: 1.0, lambda q, v: q, lambda q, v: np.array(["a"])])
def test_an_energy_of_another_shape_is_refused(energy):
    with pytest.raises(ValueError, match="the energy has shape"):
        Ensemble(CustomSystem(spring, energy=energy), dt=0.01, q=[1.0]).energy
    with pytest.raises(TypeError, match="acceleration must be a function"):
        CustomSystem(3)


def test_a_loop_is_late_and_jitters_as_it_is_told():
    loop = {"integrator": "exact", "dt": 0.01, "steps": 2000, "feedback": (10.0, 2.0)}
    at_once = simulate(SPRING, **loop)
    late = simulate(SPRING, **loop, latency=Steps(16.5))
    assert simulate(SPRING, **loop, latency=0.165).energy[-1] == late.energy[-1]
    # It stands 0.153 s.
    assert at_once.energy[-1] < 1e-9 < 1e2 < late.energy[-1]
    one, same, other = (simulate(SPRING, **loop, jitter=0.1, seed=s) for s in (1, 1, 2))
    np.testing.assert_array_equal(one.q, same.q)
    assert (one.q != other.q).any()


def test_copies_start_around_the_start_and_say_which_they_are():
    many = simulate(SPRING, integrator="leapfrog", dt=0.01, steps=5, save_every=5, num_trajectories=3, spread=0.5)
    start = many["step"] == 0
    np.testing.assert_array_equal(many["trajectory"][start], [0, 1, 2])
    np.testing.assert_array_equal(many["q"][start], [0.5, 1.0, 1.5])
    assert many.not_finite is None or many.not_finite["count"] == 0


@pytest.mark.parametrize("float, dtype", [("float64", "f8"), (np.float32, "f4"), ("float16", "f2"), ("bfloat16", "f4")])
def test_every_float_type_has_an_array_that_holds_it(float, dtype):
    path = simulate(SPRING, integrator="rk4", dt=0.01, steps=3, dtype=float)
    assert path["q"].dtype == np.dtype(dtype)


@pytest.mark.parametrize("every", [1, 7])
def test_a_state_that_overflows_ends_a_trajectory_and_says_where(every):
    given = {"integrator": "explicit-euler", "dt": 100.0, "steps": 1000, "save_every": every}
    built_in, own = simulate(SPRING, **given), simulate(spring, q=1.0, **given)
    # A step multiplies by √(1 + ω²Δt²) = 316.2; 10^308 is 123 of them.
    assert abs(built_in.stopped["step"] - 123) <= 2
    for path in (built_in, own):
        assert path.stopped["step"] == built_in.stopped["step"]
        assert 0 < path.stopped["step"] - path["step"][-1] <= every


def test_a_step_beyond_the_limit_of_its_method_is_named_with_the_step_that_it_allows():
    given = {"integrator": "velocity-verlet", "dt": 0.7, "steps": 1000}
    # ω = √10: the limit 2 of ωΔt is at Δt = 0.63245.
    why = "ωΔt = 2.21 exceeds velocity-verlet's limit 2; choose dt below 0.632"
    assert simulate(SPRING, **given).stopped["reason"] == f"the state stopped being finite: {why}"
    assert simulate(SPRING, num_trajectories=2, **given).not_finite["reason"] == why
    assert simulate(SPRING, **{**given, "dt": 0.632}).stopped is None


def test_a_trajectory_may_have_as_many_steps_as_a_float_can_count():
    given = {"integrator": "explicit-euler", "dt": 100.0, "save_every": 2**52}
    assert simulate(SPRING, steps=2**53, **given).stopped["step"] < 200
    with pytest.raises(ValueError, match="9007199254740992"):
        simulate(SPRING, steps=2**53 + 1, **given)


WRONG = [
    ({"system": "oscilator"}, ValueError, "did you mean 'oscillator'"),
    ({"system": 3}, TypeError, "a name, a System or a function"),
    ({"integrator": "verlet"}, ValueError, "velocity-verlet"),
    ({"integrator": None}, TypeError, "integrator"),
    ({"dt": -0.1}, ValueError, "dt"),
    ({"dt": math.nan}, ValueError, "dt"),
    ({"dt": "0.1"}, TypeError, "dt"),
    ({"steps": 0}, ValueError, "steps"),
    ({"steps": 2.5}, TypeError, "steps"),
    ({"steps": 10**12}, MemoryError, "GB of memory are needed.*every"),
    ({"q": [1.0, 2.0], "v": [0.0]}, ValueError, "equally many"),
    ({"q": math.inf}, ValueError, "q"),
    ({"q": "1"}, TypeError, "q"),
    ({"save_every": 0}, ValueError, "save_every"),
    ({"num_trajectories": 0}, ValueError, "num_trajectories"),
    ({"dtype": "f8"}, ValueError, "float64"),
    ({"latency": 0.1}, ValueError, "feedback"),
    ({"latency": -0.1, "feedback": (1.0, 1.0)}, ValueError, "latency"),
    ({"feedback": (1.0,)}, ValueError, "feedback"),
    ({"feedback": (math.nan, 1.0)}, ValueError, "feedback"),
    ({"jitter": ("normal", 0.1)}, ValueError, "gaussian"),
    ({"jitter": -0.1}, ValueError, "jitter"),
    ({"time_stamps": [0.0, 0.1]}, ValueError, "steps"),
    ({"stesp": 3}, TypeError, "did you mean 'steps'"),
    ({"time_stamps": "abc"}, TypeError, "time_stamps"),
    ({"spread": 0.5}, ValueError, "spread is 0.5, but there is one trajectory"),
    ({"feedback": np.array([1.0, 2.0, 3.0])}, ValueError, "feedback"),
    ({"feedback": b"ab"}, ValueError, "feedback"),
    ({"jitter": b"ab"}, TypeError, "jitter"),
    ({"q": np.longdouble("1e400")}, ValueError, "q"),
    ({"system": spring}, ValueError, "q is missing"),
    ({"system": spring, "q": 1.0, "steps": 10**16}, ValueError, "steps"),
    ({"system": spring, "q": 1.0, "seed": 3}, ValueError, "seed"),
    ({"system": spring, "q": "a"}, TypeError, "q must be"),
    ({"system": spring, "q": 1.0, "jitter": 0.1}, ValueError, "jitter"),
]


@pytest.mark.parametrize("change, error, told", WRONG)
def test_what_cannot_be_simulated_is_refused_by_name(change, error, told):
    asked = {"system": "oscillator", "integrator": "rk4", "dt": 0.01, "steps": 10, **change}
    with pytest.raises(error, match=told):
        simulate(asked.pop("system"), **asked)


@pytest.mark.parametrize(
    "change, error, told",
    [
        ({"q": [[1.0, 2.0]], "system": "pendulum"}, ValueError, "pendulum"),
        ({"q": np.zeros((2, 2, 2))}, ValueError, "shape"),
        ({"q": np.zeros((0, 1))}, ValueError, "at least"),
        ({"q": [1.0], "v": [1.0, 2.0]}, ValueError, "shape"),
        ({"q": ["a"]}, TypeError, "q"),
        ({"q": [math.nan]}, ValueError, "q"),
        ({"integrator": "exact"}, ValueError, "exact steps are those of simulate"),
        ({"q": [1e300], "dtype": "float32"}, ValueError, "q is not finite in float32"),
        ({"system": lambda q, v: q + 1j}, TypeError, "complex"),
        ({"dtype": "float16"}, ValueError, "float32"),
        ({"system": lambda q, v: q[:, 0]}, ValueError, "shape"),
    ],
)
def test_what_cannot_be_an_ensemble_is_refused_by_name(change, error, told):
    asked = {"system": "oscillator", "dt": 0.01, "q": [1.0, 2.0], **change}
    with pytest.raises(error, match=told):
        Ensemble(asked.pop("system"), **asked).advance(1)


def test_a_system_has_its_parameters_and_refuses_what_it_has_not():
    joint = System("oscillator", m=2.0, k=20.0)
    # The same motion, but commands are forces.
    assert joint != SPRING and dict(joint.parameters) == {"m": 2.0, "k": 20.0}
    assert repr(joint) == "System('oscillator', m=2.0, k=20.0)"
    assert pickle.loads(pickle.dumps(SPRING)) == SPRING and hash(SPRING) == hash(SPRING)
    assert System("kepler").dimensions == range(2, 3)
    for wrong, told in (({"omega": 1.0}, "did you mean `omega2`"), ({"omega2": -1.0}, "omega2")):
        with pytest.raises(ValueError, match=told):
            System("oscillator", **wrong)


@pytest.mark.skipif(not hasattr(signal, "raise_signal"), reason="no signals")
def test_ctrl_c_ends_a_long_simulation():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            simulate("kepler", integrator="rk4", dt=1e-4, steps=10**9, save_every=10**8)
        timer.join()
        swings = Ensemble("kepler", integrator="rk4", dt=1e-4, q=np.ones((1000, 2)))
        timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            swings.advance(10**9)
        timer.join()
        assert 0 < swings.step < 10**9
    finally:
        signal.signal(signal.SIGINT, before)


SLOW = {"integrator": "suzuki4", "substeps": 100, "jitter": 0.1, "skew": 0.1, "dtype": "float64"}


@pytest.mark.skipif(not hasattr(signal, "raise_signal"), reason="no signals")
@pytest.mark.parametrize(
    "long",
    [
        lambda: simulate(
            "oscillator", integrator="rk4", dt=0.01, steps=10**9, save_every=10**9, feedback=(10.0, 2.0), latency=0.02
        ),
        lambda: simulate("pendulum", integrator="suzuki4", dt=0.01, steps=10**9, save_every=10**9, num_trajectories=1),
        lambda: Ensemble("pendulum", integrator="suzuki4", dt=0.01, q=[[0.5]]).advance(10**10),
        lambda: begun("Pendulum", 1, **SLOW).rollout(Random(-1.0, 1.0), 10**6),
        lambda: begun("Pendulum", 4096).rollout(WIDE, 300),
    ],
    ids=["a loop", "copies", "an ensemble of one", "a rollout of one", "a rollout of a wide network"],
)
def test_ctrl_c_ends_soon_what_is_slow(long):
    sent = []

    def late():
        sent.append(time.process_time())
        signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer = threading.Timer(0.3, late)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            long()
        # What is computed after the signal, however busy the machine is: pieces of 0.05 to 0.5 s, and several times that without optimisation.
        # Pieces of so many steps were some 5 to 40 s.
        assert time.process_time() - sent[0] < 3.0
        timer.join()
    finally:
        signal.signal(signal.SIGINT, before)


def begun(name, num_envs, **given):
    envs = libration.Environments(name, num_envs, **given)
    envs.reset(seed=0)
    return envs


WIDE = MLP(
    [
        (np.full((256, 3), 0.01), np.zeros(256)),
        (np.full((256, 256), 0.01), np.zeros(256)),
        (np.full((1, 256), 0.01), np.zeros(1)),
    ]
)


def test_a_force_that_is_another_each_time_ends_where_it_did():
    calls = []

    def force(q, v):
        calls.append(1)
        return q * np.nan if len(calls) == 30 else -q

    path = simulate(force, integrator="velocity-verlet", dt=0.01, steps=100, save_every=10, q=1.0)
    assert path.stopped["reason"] == "the state is not finite"
    # It is not found again, so it is the row that was to be.
    assert path.stopped["step"] == path["step"][-1] + 10


@pytest.mark.skipif(not hasattr(os, "fork"), reason="nothing is forked here")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_process_that_was_forked_has_threads_of_its_own():
    swings = Ensemble("pendulum", dt=0.01, q=np.linspace(0.1, 2.0, 40_000), threads=2)
    swings.advance(200)
    libration.run_lab(studies=["spectrum"], effort="quick", progress=False)
    child = os.fork()
    if child == 0:
        # Nothing of the tests may go on in it.
        try:
            swings.advance(200)
            libration.run_lab(studies=["spectrum"], effort="quick", progress=False)
            os._exit(0)
        finally:
            os._exit(1)
    swings.advance(200)
    for _ in range(600):
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            break
        time.sleep(0.1)
    else:
        os.kill(child, signal.SIGKILL)
    assert done and status == 0


def test_implicit_steps_that_do_not_solve_their_equations_warn():
    cubic = System(rate={"x": "-x^3"}, start={"x": 10.0})
    with pytest.warns(RuntimeWarning, match="did not solve their equations"):
        path = simulate(cubic, integrator="backward-euler", dt=10.0, steps=1)
    # The root of x + 10 x³ = 10 is 0.966679, and five Newton steps end at 1.41405.
    assert path["x"][-1] == pytest.approx(1.41405, abs=1e-5)
    assert path.newton_residual["exceeding"] == 1 and path.newton_residual["largest"] > 0.01
    solved = simulate(cubic, integrator="backward-euler", dt=1e-3, steps=10)
    assert solved.newton_residual["exceeding"] == 0
    assert simulate(cubic, integrator="rk4", dt=1e-3, steps=10).newton_residual is None
