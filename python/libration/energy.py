"""Audits of energy traces: what an energy drift is made of."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._json import json_text
from ._settings import positive

__all__ = ["EnergyReport", "audit_energy"]


class EnergyReport:
    """The results of an audit; :attr:`results` has all numbers under the keys of ``libration audit --json``."""

    def __init__(self, results: dict[str, Any], holds: bool, page: str) -> None:
        self.results = results
        self.holds = holds
        """Whether all verdicts are good: no fault, and all runs within a stated tolerance. Unknown is not good."""
        self._page = page

    def __repr__(self) -> str:
        return f"<EnergyReport: {self.answer}>"

    @property
    def answer(self) -> str:
        """The answer in a few sentences."""
        return str(self.results["answer"])

    @property
    def verdict(self) -> dict[str, Any]:
        """Whether there is a fault: ``outcome`` (``no-fault``, ``fault`` or ``unknown``) and its ``evidence``."""
        return dict(self.results["verdict"])

    @property
    def tolerance_verdict(self) -> dict[str, Any] | None:
        """Whether all runs keep the tolerance: ``within``, ``exceeds`` or ``unknown``; ``None`` without a stated tolerance."""
        verdict = self.results["tolerance_verdict"]
        return None if verdict is None else dict(verdict)

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Faults, and facts that a reader of the numbers must know: ``kind``, ``is_fault``, ``text``, and what to change as ``help``."""
        return list(self.results["findings"])

    @property
    def runs(self) -> list[dict[str, Any]]:
        """The runs, that with the shortest time step first."""
        return list(self.results["runs"])

    @property
    def largest_dt(self) -> dict[str, Any] | None:
        """The largest step for the tolerance over the horizon as ``dt``, with its interval ``low`` and ``high``; ``None`` without ``dt``."""
        largest = self.results["largest_dt"]
        return None if largest is None else dict(largest)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the HTML page, or with the suffix ``.json`` all numbers; one that is not finite is null."""
        text = json_text(self.results) if str(path).endswith(".json") else self._page
        Path(path).write_text(text, encoding="utf-8")


def audit_energy(
    traces: Sequence[tuple[ArrayLike, ArrayLike]],
    dt: Sequence[float] | None = None,
    *,
    tolerance: float | None = None,
    horizon: float | None = None,
    scale: float | None = None,
    titles: Sequence[str] | None = None,
) -> EnergyReport:
    """Audit the energies of runs of the same system at several time steps, by any program.

    Parameters
    ----------
    traces
        Pairs of times in s and energies, one for each run.
    dt
        The time step of each run in s; by default the spacing of the samples, and then there is no largest step.
    tolerance
        The largest deviation from the energy at the start, relative to ``scale``: judges each run. Without it runs have no verdict, and the
        largest step is that for 1e-4.
    horizon
        The duration in s for which the tolerance holds; by default that of the runs.
    scale
        The energy that the tolerance is relative to, such as the mean kinetic energy; by default that at the start.
    titles
        Names of the runs.
    """
    traces = list(traces)
    for name, values in (("dt", dt), ("titles", titles)):
        if values is not None and len(values) != len(traces):
            raise ValueError(f"{name} has {len(values)} values; expected one for each of {len(traces)} traces")
    steps = [None] * len(traces) if dt is None else [positive("dt", step) for step in dt]
    names = [f"run {i + 1}" for i in range(len(traces))] if titles is None else [str(title) for title in titles]
    given = []
    for name, step, trace in zip(names, steps, traces):
        if len(trace) != 2:
            raise ValueError(f"{name} has {len(trace)} parts; expected a pair of times and energies")
        times, energies = (np.ascontiguousarray(part, dtype=np.float64).reshape(-1) for part in trace)
        given.append((name, step, times, energies))
    until = None if horizon is None else positive("horizon", horizon)
    stated = {"tolerance": tolerance, "horizon": horizon, "scale": scale}
    options = "".join(f", {name}={value!r}" for name, value in stated.items() if value is not None)
    limits = [None if value is None else positive(name, value) for name, value in (("tolerance", tolerance), ("scale", scale))]
    call = f"libration.audit_energy(traces, dt={None if dt is None else steps!r}{options})"
    results, holds, page = _native._audit_energy(given, limits[0], until, limits[1], call)
    return EnergyReport(json.loads(results), holds, page)
