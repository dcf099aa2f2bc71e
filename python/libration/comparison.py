"""Comparisons of integrators: which one meets a tolerance with the fewest force evaluations."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any

from . import _native
from ._html import table
from ._json import json_text
from ._requests import system_request
from ._settings import positive

__all__ = ["IntegratorComparison", "compare_integrators"]


class IntegratorComparison:
    """All explicit integrators on a motion; :attr:`results` has the keys of ``libration analyze --compare --json``."""

    def __init__(self, results: dict[str, Any]) -> None:
        self.results = results

    def __repr__(self) -> str:
        best = self.best
        answer = "no integrator" if best is None else f"{best['integrator']} with dt={best['dt']:.6g}"
        return f"<IntegratorComparison: {answer} for an error of {self.results['tolerance']:g} over {self.results['horizon']:g} s>"

    def _repr_html_(self) -> str:
        columns = ["integrator", "order", "stages", "dt", "evaluations", "predicted_evaluations", "error", "energy_error"]
        rows = [[row[column] for column in columns] for row in self.integrators if row["evaluations"] is not None]
        return table([column.replace("_", " ") for column in columns], rows)

    @property
    def integrators(self) -> list[dict[str, Any]]:
        """The integrators, the cheapest first: ``integrator``, ``order``, ``stages``, ``error_constant``, the largest step ``dt`` in s that
        meets the tolerance, its ``evaluations`` of forces and those predicted, its ``error`` and ``energy_error``. Numbers that are not known
        are ``None``."""
        return list(self.results["integrators"])

    @property
    def best(self) -> dict[str, Any] | None:
        """The cheapest of the integrators that were tried; ``None`` if none of them meets the tolerance."""
        first = self.results["integrators"][0]
        return None if first["dt"] is None else dict(first)

    @property
    def verdict(self) -> dict[str, Any]:
        """Whether an integrator meets the tolerance: ``outcome``, ``evidence`` and what was ``not_examined``."""
        return dict(self.results["verdict"])

    def save(self, path: str | PathLike[str]) -> None:
        """Write all numbers as JSON."""
        Path(path).write_text(json_text(self.results), encoding="utf-8")


def compare_integrators(system: Any, *, tolerance: float, horizon: float, q: Any = None, v: Any = None) -> IntegratorComparison:
    """Compare all explicit integrators on a motion: the cheapest for a tolerance.

    Parameters
    ----------
    system
        A name or :class:`System` of the catalogue, or an :class:`EquationSystem`. Inputs are zero.
    tolerance
        The largest error of a state after any step, relative to the largest size of that state in the motion: 1e-13 to 0.1.
    horizon
        The time of the motion in s.
    q, v
        Initial positions and velocities (default: those of the system).

    Raises
    ------
    ValueError
        For a tolerance or horizon out of range, a system at rest, and a motion that ends or that the reference cannot follow.
    """
    limits = positive("tolerance", tolerance), positive("horizon", horizon)
    return IntegratorComparison(json.loads(_native._compare_integrators(system_request(system, q, v), *limits)))
