"""The laboratory: studies with predictions and measurements."""

from __future__ import annotations

import html
import json
import os
import shutil
import tempfile
import weakref
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Iterable, Mapping

import numpy as np

from . import _native
from ._keywords import check_keywords
from ._plots import Panels, plot_findings
from ._progress import Progress, ProgressDisplay
from ._toml import text_of
from .equations import EquationSystem, check_system

__all__ = ["Finding", "Results", "STUDIES", "run_lab"]

STUDIES: Mapping[str, str] = MappingProxyType(dict(_native._studies()))
"""The question of each study, by name."""


@dataclass(frozen=True)
class Finding:
    """A measurement and its prediction."""

    id: str
    """Identifier ``study.subject.quantity``."""
    study: str
    text: str
    """Description of the measured quantity."""
    unit: str
    """Unit of both numbers; ``1`` for a number without unit."""
    predicted: float | None
    """Prediction of theory, if there is one."""
    measured: float | None
    """Measured value."""
    relation: str
    """Predicted relation of the measurement to the prediction: ``equal``, ``at-most`` or ``at-least``."""
    tolerance: float | None
    """Allowed difference, in the unit."""
    tolerance_reason: str
    verdict: str
    """``agrees``, ``disagrees`` or ``measured``."""
    undecided: str | None
    """Reason for a missing verdict, if a verdict was expected."""
    command: str
    """Command that recomputes this finding alone."""

    @property
    def agrees(self) -> bool:
        return self.verdict == "agrees"


class Results:
    """Results of a run of the laboratory."""

    def __init__(self, found: dict[str, Any], series: Any, folder: Path) -> None:
        self.json: dict[str, Any] = found
        """Content of ``results.json``: machine, configuration, and the record of each study with its findings, claims and tables."""
        self.folder = folder
        """Folder of ``report.html``, ``results.json``, ``data`` and ``figures``."""
        self.series: Mapping[str, Mapping[str, np.ndarray]] = {
            f"{study}-{name}": columns for study, name, columns, _ in series
        }
        """Data of the figures: the columns of each series, by the name of its file, ``study-series``."""
        self.units: Mapping[str, Mapping[str, str]] = {
            f"{study}-{name}": units for study, name, _, units in series
        }
        """Units of these columns."""
        self.findings: list[Finding] = [
            Finding(study=study["name"], **{k: v for k, v in finding.items()})
            for study in found["studies"]
            for finding in study["findings"]
        ]
        """Findings of all studies, in the order of the report."""
        self.claims: list[dict[str, Any]] = [claim for study in found["studies"] for claim in study["claims"]]
        """Claims of the source report with their verdicts; none of a system by equations."""
        self.not_applicable: dict[str, str] = {
            other["study"]: other["because"] for other in found.get("not_applicable", ())
        }
        """Reason of each study that does not apply to a system by equations, by name."""

    @property
    def report(self) -> Path:
        """Path of the report page."""
        return self.folder / "report.html"

    @property
    def disagreements(self) -> list[Finding]:
        """Findings that disagree with theory."""
        return [finding for finding in self.findings if finding.verdict == "disagrees"]

    @property
    def seconds(self) -> dict[str, float]:
        """Run time of each study in s."""
        return {study["name"]: study["seconds"] for study in self.json["studies"]}

    def __getitem__(self, id: str) -> Finding:
        for finding in self.findings:
            if finding.id == id:
                return finding
        raise KeyError(id)

    def to_pandas(self) -> Any:
        """Return a ``pandas.DataFrame`` of all findings, with their identifiers as index."""
        import pandas  # type: ignore[import-untyped]

        return pandas.DataFrame([vars(finding) for finding in self.findings]).set_index("id")

    def __repr__(self) -> str:
        return f"<Results of {len(self.json['studies'])} studies: {self._summary()}>"

    def _summary(self) -> str:
        judged = [finding for finding in self.findings if finding.verdict != "measured"]
        agree = sum(finding.agrees for finding in judged)
        return f"{agree} of {len(judged)} findings agree with theory"

    def plot(self) -> Panels:
        """Draw the difference from the prediction of each finding, relative to the allowed one, and return the axes, ``(1,)``.

        Findings without a prediction are left out. ``folder / "figures"`` has the figures of the studies.

        Raises
        ------
        ImportError
            Without matplotlib: ``pip install 'libration[plots]'``.
        """
        return plot_findings(self.findings, self._summary())

    def _repr_html_(self) -> str:
        sign = {"agrees": "✓", "disagrees": "✗", "measured": ""}
        rows = (
            f"<tr><td style='text-align:left' title='{html.escape(f.text)}'>{html.escape(f.id)}</td>"
            f"<td>{_number(f.predicted)}</td><td>{_number(f.measured)}</td>"
            f"<td style='text-align:left'>{html.escape(f.unit)}</td><td>{sign[f.verdict]}</td></tr>"
            for f in self.findings
        )
        head = "".join(f"<th>{name}</th>" for name in ("finding", "predicted", "measured", "unit", ""))
        return (
            f"<p>{self._summary()}</p><div style='max-height:24em;overflow:auto'>"
            f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
        )


def _number(x: float | None) -> str:
    return "" if x is None else f"{x:.6g}"


@check_keywords
def run_lab(
    config: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    *,
    system: EquationSystem | None = None,
    studies: Iterable[str] | None = None,
    effort: str | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Progress = None,
) -> Results:
    """Run studies and return their results, as ``libration lab`` does.

    Parameters
    ----------
    config:
        A dictionary with the keys of a configuration file, or the path of one. Missing keys have the values of the source report.
    system:
        A system by equations (:class:`libration.EquationSystem`), as for ``libration lab --system FILE``: its studies in place of those of the
        oscillator. Keys of a dictionary that have no effect on them are errors; those of a file are ignored.
    studies:
        Names from :data:`STUDIES` (default: all that apply and do not measure this machine, which are ``throughput``, ``memory``, ``rollout``
        and ``storage``; :attr:`Results.not_applicable` has those that do not apply).
    effort:
        ``"quick"``, ``"standard"`` or ``"thorough"``.
    out:
        Output folder of report, results, data and figures (default: a temporary folder, which is removed together with the results).
    progress:
        ``True``, ``False``, ``None`` (in a terminal or notebook), or a function ``(fraction, description)``.

    Raises
    ------
    TypeError, ValueError
        For an invalid configuration, or a study that does not apply to the system, before any work.
    OSError
        If the folder cannot be written, or another run uses it.
    """
    check_system("run_lab", system, config=config)
    config_text = text_of("config", config)
    names = None
    if studies is not None:
        if isinstance(studies, str):
            raise TypeError("studies must be a list of names, not a single one")
        names = list(studies)
        if not all(isinstance(name, str) for name in names):
            raise TypeError(f"studies are {names!r}, but they must be names")
    if effort is not None and not isinstance(effort, str):
        raise TypeError(f"effort must be a string, not {type(effort).__name__}")
    display = ProgressDisplay(progress)
    folder = Path(tempfile.mkdtemp(prefix="libration-") if out is None else out)
    try:
        found = _run(config_text, _request(system, config), names, effort, folder, display)
    except BaseException:
        if out is None:
            shutil.rmtree(folder, ignore_errors=True)
        raise
    results = Results(*found, folder)
    if out is None:
        weakref.finalize(results, shutil.rmtree, folder, ignore_errors=True)
    return results


def _request(system: EquationSystem | None, config: Any) -> dict[str, Any] | None:
    """Return the system with the keys of a configuration that is a dictionary; of a table also ``table.key``."""
    if system is None:
        return None
    tables = config if isinstance(config, Mapping) else {}
    keys = [str(table) for table in tables]
    keys += [f"{table}.{key}" for table, inner in tables.items() if isinstance(inner, Mapping) for key in inner]
    return {"equations": system._text, "keys": keys}


def _run(
    config_text: str,
    system: dict[str, Any] | None,
    names: list[str] | None,
    effort: str | None,
    folder: Path,
    display: ProgressDisplay,
) -> tuple[dict[str, Any], Any]:
    with display:

        def report(study: str, number: int, of: int, what: str, done: int, total: int) -> None:
            part = (max(number - 1, 0) + done / max(total, 1)) / max(of, 1)
            display.update(part, f"{study} ({number} of {of}): {what}" if what else study)

        callback = report if display.enabled else None
        found, series = _native._run_lab(config_text, system, names, effort, folder, callback)
    return json.loads(found), series
