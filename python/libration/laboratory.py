"""The laboratory: studies in which every measurement stands beside its prediction."""

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
from ._named import named
from ._progress import Progress, Shown
from ._toml import text_of

__all__ = ["Finding", "Results", "STUDIES", "run_lab"]

STUDIES: Mapping[str, str] = MappingProxyType(dict(_native._studies()))
"""The question that each study answers, by its name."""


@dataclass(frozen=True)
class Finding:
    """A measurement beside its prediction."""

    id: str
    """``study.subject.quantity``."""
    study: str
    text: str
    """What was measured, in words."""
    unit: str
    """Of both numbers; ``1`` if there is none."""
    predicted: float | None
    """What theory says, if it says anything."""
    measured: float | None
    """What came out."""
    relation: str
    """How the measurement should stand to the prediction: ``equal``, ``at-most`` or ``at-least``."""
    tolerance: float | None
    """How far the two may lie apart, in the unit."""
    tolerance_reason: str
    verdict: str
    """``agrees``, ``disagrees`` or ``measured``."""
    undecided: str | None
    """Why a measurement that was to be judged is not."""

    @property
    def agrees(self) -> bool:
        return self.verdict == "agrees"


class Results:
    """What a run of the laboratory found."""

    def __init__(self, found: dict[str, Any], series: Any, folder: Path) -> None:
        self.json: dict[str, Any] = found
        """All of ``results.json``: the machine, the configuration, and a record of each study with its findings, claims and tables."""
        self.folder = folder
        """Where all files are: ``report.html``, ``results.json``, ``data`` and ``figures``."""
        self.series: Mapping[str, Mapping[str, np.ndarray]] = {
            f"{study}-{name}": columns for study, name, columns, _ in series
        }
        """The numbers behind the figures: columns of each series, which is called ``study-series`` as its file is."""
        self.units: Mapping[str, Mapping[str, str]] = {
            f"{study}-{name}": units for study, name, _, units in series
        }
        """The units of these columns."""
        self.findings: list[Finding] = [
            Finding(study=study["name"], **{k: v for k, v in finding.items()})
            for study in found["studies"]
            for finding in study["findings"]
        ]
        """All findings, study by study."""
        self.claims: list[dict[str, Any]] = [claim for study in found["studies"] for claim in study["claims"]]
        """Sentences of the source report with their verdicts."""

    @property
    def report(self) -> Path:
        """The page with all of it."""
        return self.folder / "report.html"

    @property
    def disagreements(self) -> list[Finding]:
        """The findings that are not what theory says."""
        return [finding for finding in self.findings if finding.verdict == "disagrees"]

    @property
    def seconds(self) -> dict[str, float]:
        """How long each study took."""
        return {study["name"]: study["seconds"] for study in self.json["studies"]}

    def __getitem__(self, id: str) -> Finding:
        for finding in self.findings:
            if finding.id == id:
                return finding
        raise KeyError(id)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` of all findings, by their identifiers."""
        import pandas  # type: ignore[import-untyped]

        return pandas.DataFrame([vars(finding) for finding in self.findings]).set_index("id")

    def __repr__(self) -> str:
        return f"<Results of {len(self.json['studies'])} studies: {self._summary()}>"

    def _summary(self) -> str:
        judged = [finding for finding in self.findings if finding.verdict != "measured"]
        agree = sum(finding.agrees for finding in judged)
        return f"{agree} of {len(judged)} findings agree with theory"

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


@named
def run_lab(
    config: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    *,
    studies: Iterable[str] | None = None,
    effort: str | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Progress = None,
) -> Results:
    """Run studies of the laboratory: what ``libration lab`` does.

    Parameters
    ----------
    config:
        A dictionary with the keys of a configuration file, or the path of one; what is left out is the setting of the source report.
    studies:
        Names out of :data:`STUDIES`; all of them by default.
    effort:
        ``"quick"``, ``"standard"`` or ``"thorough"``.
    out:
        The folder for report, results, data and figures. Without one they lie in a temporary folder, which goes with the results.
    progress:
        ``True``, ``False``, ``None`` for where it can be seen, or a function of the part that is done and what is being done.

    Raises
    ------
    TypeError, ValueError
        For a configuration that cannot be, before any work.
    OSError
        If the folder cannot be written, or another run writes there.
    """
    asked = text_of("config", config)
    names = None
    if studies is not None:
        if isinstance(studies, str):
            raise TypeError("studies must be a list of names, not a single one")
        names = list(studies)
        if not all(isinstance(name, str) for name in names):
            raise TypeError(f"studies are {names!r}, but they must be names")
    if effort is not None and not isinstance(effort, str):
        raise TypeError(f"effort must be a string, not {type(effort).__name__}")
    shown = Shown(progress)
    folder = Path(tempfile.mkdtemp(prefix="libration-") if out is None else out)
    try:
        found = _run(asked, names, effort, folder, shown)
    except BaseException:
        if out is None:
            shutil.rmtree(folder, ignore_errors=True)
        raise
    results = Results(*found, folder)
    if out is None:
        weakref.finalize(results, shutil.rmtree, folder, ignore_errors=True)
    return results


def _run(
    asked: str, names: list[str] | None, effort: str | None, folder: Path, shown: Shown
) -> tuple[dict[str, Any], Any]:
    with shown:

        def tell(study: str, number: int, of: int, what: str, done: int, total: int) -> None:
            part = (max(number - 1, 0) + done / max(total, 1)) / max(of, 1)
            shown.tell(part, f"{study} ({number} of {of}): {what}" if what else study)

        found, series = _native._run_lab(asked, names, effort, folder, tell if shown.wanted else None)
    return json.loads(found), series
