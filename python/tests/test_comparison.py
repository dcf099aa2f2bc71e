"""Tests of published splitting methods and of comparisons of integrators."""

import numpy as np
import pytest

import libration


def test_the_best_integrator_returns_to_the_start_of_a_closed_orbit() -> None:
    turn = 2 * np.pi
    comparison = libration.compare_integrators("kepler", tolerance=1e-6, horizon=turn, q=[0.7, 0.0], v=[0.0, np.sqrt(1.3 / 0.7)])
    best = comparison.best
    assert best is not None and best["evaluations"] == min(
        row["evaluations"] for row in comparison.integrators if row["evaluations"] is not None
    )
    steps = round(turn / best["dt"])
    end = libration.simulate(
        "kepler", integrator=best["integrator"], dt=turn / steps, steps=steps, save_every=steps, q=[0.7, 0.0], v=[0.0, np.sqrt(1.3 / 0.7)]
    )
    # Sizes of the states are 1.3, 1, 1 and 1.4.
    assert abs(end.q[-1, 0] - 0.7) < 1.3e-6 and abs(end.q[-1, 1]) < 1e-6
    assert best["integrator"] in repr(comparison) and best["integrator"] in comparison._repr_html_()


def test_a_system_by_equations_is_compared_from_its_own_start_or_from_another() -> None:
    energy = "q'^2/2 + omega2*(1 - cos(q))"
    own = libration.System("pendulum", omega2=2.0).equations(energy=energy, start={"q": 0.3})
    by_name = libration.compare_integrators(libration.System("pendulum", omega2=2.0), tolerance=1e-6, horizon=5.0, q=1.0, v=0.5)
    begun = libration.compare_integrators(own, tolerance=1e-6, horizon=5.0, q=1.0, v=0.5)
    # The same numbers to the last bit.
    assert begun.results == by_name.results
    assert libration.compare_integrators(own, tolerance=1e-6, horizon=5.0).results != begun.results
    with pytest.raises(ValueError, match="^q has 2 numbers; `pendulum` has 1 coordinates$"):
        libration.compare_integrators(own, tolerance=1e-6, horizon=5.0, q=[1.0, 2.0])
    with pytest.raises(TypeError, match="CustomSystem; expected a system of the catalogue or an EquationSystem"):
        libration.compare_integrators(lambda q, v: -q, tolerance=1e-6, horizon=5.0)


@pytest.mark.parametrize(("tolerance", "horizon", "what"), [(0.5, 1.0, "from 1e-13 to 0.1"), (1e-3, -1.0, "horizon")])
def test_wrong_limits_are_refused(tolerance: float, horizon: float, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        libration.compare_integrators("kepler", tolerance=tolerance, horizon=horizon)


def test_splitting_methods_are_integrators_of_simulations_and_ensembles() -> None:
    assert len(libration.SPLITTING_METHODS) == 80
    assert len(libration.RUNGE_KUTTA_METHODS) == 6
    assert "Blanes" in libration.SPLITTING_METHODS["blanes-moan-srkn-11-6"]
    for name in ("blanes-moan-srkn-11-6", "mclachlan-ss17-8"):
        end = libration.simulate("oscillator", integrator=name, dt=0.1, steps=10, q=1.0, v=0.0)
        # ω² = 10; the methods have orders 6 and 8.
        assert abs(end.q[-1, 0] - np.cos(np.sqrt(10.0))) < 1e-6
    with pytest.raises(ValueError, match="did you mean 'ruth-3'") as error:
        libration.analyze("oscillator", integrator="ruth3", dt=0.1)
    assert "kahan-li" not in str(error.value)
