"""Systems of the catalogue by equations, with a command for each coordinate.

The expressions compute the operations of the compiled systems: both have the same bits.
"""

from __future__ import annotations

from typing import Any, Mapping

from .equations import EquationSystem

_RADIUS = "(1/sqrt(x*x + y*y))^3"

ACCELERATIONS: Mapping[str, Mapping[str, str]] = {
    "oscillator": {"q": "-omega2*q"},
    "damped-oscillator": {"q": "-omega2*q - gamma*q'"},
    "driven-oscillator": {"q": "-omega2*q - gamma*q' + amplitude*cos(drive*t)"},
    "pendulum": {"q": "-omega2*sin(q)"},
    "duffing": {"q": "-alpha*q - beta*(q*q*q)"},
    "kepler": {"x": f"-mu*{_RADIUS}*x", "y": f"-mu*{_RADIUS}*y"},
    "henon-heiles": {"x": "-x - lambda*(x*y + x*y)", "y": "-y - lambda*(x*x - y*y)"},
}

_STARTS: Mapping[str, Mapping[str, float]] = {"kepler": {"x": 1.0, "y'": 1.0}}
"""Starts of systems that have none at zero."""


def commanded(name: str, has_mass: bool) -> dict[str, str]:
    """Return the accelerations of a system with its commands: ``u`` of one coordinate, ``u_x`` and ``u_y`` of two.

    A command is an acceleration, or a force where the system has a mass.
    """
    free = ACCELERATIONS[name]
    command = {q: "u" if len(free) == 1 else f"u_{q}" for q in free}
    if has_mass:
        return {q: f"{text.replace('omega2', '(k/m)')} + {command[q]}*(1/m)" for q, text in free.items()}
    return {q: f"{text} + {command[q]}" for q, text in free.items()}


def equations_of(system: Any, **given: Any) -> EquationSystem:
    """Return a system of the catalogue by equations; ``given`` are keywords of :class:`libration.EquationSystem`."""
    accelerations = commanded(system.name, "m" in system.parameters)
    inputs = ["u"] if len(accelerations) == 1 else [f"u_{q}" for q in accelerations]
    of_system: dict[str, Any] = {
        "acceleration": accelerations,
        "parameters": dict(system.parameters),
        "inputs": inputs,
        "start": _STARTS.get(system.name),
        "name": system.name,
    }
    return EquationSystem(**{**of_system, **given})
