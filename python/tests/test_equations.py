"""Systems by equations."""

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
    found = libration.simulate(system, integrator="rk4", dt=0.01, steps=4, count=3, spread=0.5)
    assert list(found) == ["trajectory", "step", "t", "q", "q'", "energy"]
    assert [found.units[name] for name in ("q", "q'", "energy")] == ["rad", "rad/s", "J"]
    assert found["q"][:3].tolist() == [0.5, 1.0, 1.5]
    with pytest.raises(AttributeError, match="only trajectory, step"):
        found.q


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
        (lambda: libration.simulate(pendulum(), integrator="rk5", dt=0.1, steps=1), "did you mean `rk4`"),
        (lambda: libration.simulate(pendulum(), integrator="rk4", dt=0.1, steps=1, q=1), "q is given"),
        (lambda: libration.simulate(pendulum(), integrator="rk4", dt=0.1, steps=1, latency=0.1), "latency is given"),
        (lambda: libration.Ensemble(pendulum(), dt=0.1, q=np.zeros((3, 2))), r"must be \(N, 1\): q"),
        (lambda: libration.analyze(pendulum(), integrator="exact", dt=0.1), "exact"),
        (lambda: libration.Environments(pendulum(), 4), "has no inputs, but actions need at least one"),
    ],
)
def test_wrong_equations_and_options_are_refused_by_name(make, message):
    with pytest.raises((TypeError, ValueError), match=message):
        make()
