"""Temperatures of Langevin thermostats: their bias by the time step, predicted and measured."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any, Iterable

from . import _native
from ._html import table
from ._json import json_text
from ._requests import system_request, text
from ._settings import count, positive

__all__ = ["TemperatureAnalysis", "analyze_temperature"]


class TemperatureAnalysis:
    """Thermostats at a temperature; :attr:`results` has the keys of ``libration analyze --temperature --json``."""

    def __init__(self, results: dict[str, Any]) -> None:
        self.results = results

    def __repr__(self) -> str:
        best = self.recommended or "no thermostat"
        return f"<TemperatureAnalysis: {best} for {self.results['system']} at kT={self.results['temperature']:g} with dt={self.dt:.6g}>"

    def _repr_html_(self) -> str:
        columns = ["fastest_mode_bias", "predicted_bias", "measured_bias", "standard_error", "order", "accurate_dt", "formula"]
        kinds = ["configuration", "kinetic"]
        rows = [[row["thermostat"], kind, *(row[kind][column] for column in columns)] for kind in kinds for row in self.thermostats]
        return table(["thermostat", "temperature", *(column.replace("_", " ") for column in columns)], rows)

    @property
    def dt(self) -> float:
        """The time step in s."""
        return float(self.results["dt"])

    @property
    def frequencies(self) -> list[float]:
        """Angular frequencies of the modes about the equilibrium in rad/s, the slowest first."""
        return list(self.results["frequencies"])

    @property
    def recommended(self) -> str | None:
        """The thermostat with the least bias of positions; ``None`` if none is stable."""
        best = self.results["recommended"]
        return None if best is None else str(best)

    @property
    def thermostats(self) -> list[dict[str, Any]]:
        """The thermostats in the order of the request: ``thermostat``, ``evaluations`` of forces per step, ``stable``, ``stable_dt`` in s,
        ``note``, and for the temperatures ``configuration`` (of positions) and ``kinetic`` (of velocities) each ``formula``, ``order``,
        ``fastest_mode_bias``, ``predicted_bias``, ``measured_bias``, ``standard_error`` and ``accurate_dt`` in s. Biases are relative to
        the temperature. Numbers that are not known are ``None``."""
        return list(self.results["thermostats"])

    def save(self, path: str | PathLike[str]) -> None:
        """Write all numbers as JSON."""
        Path(path).write_text(json_text(self.results), encoding="utf-8")


def analyze_temperature(
    system: Any,
    *,
    temperature: float,
    friction: float,
    dt: float | None = None,
    thermostats: Iterable[str] | None = None,
    steps: int = 1_000_000,
    seed: int = 0,
    q: Any = None,
    v: Any = None,
) -> TemperatureAnalysis:
    """Predict and measure the temperatures of Langevin thermostats.

    Parameters
    ----------
    system
        A name or :class:`System` of the catalogue, or an :class:`EquationSystem`, with forces of positions. Inputs are zero. Masses are
        those of its kinetic energy.
    temperature
        ``kT`` in units of the energy of the system.
    friction
        The friction in 1/s.
    dt
        The time step in s; ``None``: one over the angular frequency of the fastest mode.
    thermostats
        Words of the letters A (drift), B (kick) and O (friction and noise), such as ``"BAOAB"``, and ``"gjf"`` and ``"euler-maruyama"``;
        ``None``: the common ones.
    steps
        Measured steps of each thermostat, over 32 trajectories: 32 to 1e10.
    seed
        The seed of the noise.
    q, v
        Initial positions and velocities (default: those of the system), from which it descends to an equilibrium.

    Raises
    ------
    ValueError
        For a wrong word, a number that is not allowed, and a system without a stable equilibrium, with forces of velocities or without a
        potential.
    """
    step = None if dt is None else positive("dt", dt)
    numbers = positive("temperature", temperature), positive("friction", friction), step
    draws = count("steps", steps, 32, 10_000_000_000), count("seed", seed, 0, 2**64 - 1)
    if isinstance(thermostats, str):
        raise TypeError(f"thermostats is {thermostats!r}; expected a list of words, such as [{thermostats!r}]")
    words = None if thermostats is None else [text("a thermostat", word) for word in thermostats]
    return TemperatureAnalysis(json.loads(_native._analyze_temperature(system_request(system, q, v), numbers, words, draws)))
