"""Figures of results, by matplotlib, which is imported when a figure is drawn."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any, Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .laboratory import Finding

Panels = NDArray[np.object_]
"""Axes of a figure, ``(panels,)``."""

SMALLEST_SHARE = 1e-4
"""Shares of an allowed difference below this one are drawn at it."""

LARGEST_SHARE = 1e6
"""Shares of an allowed difference above this one are drawn at it."""

LARGEST = 1e200
"""Numbers of this size, whose axes overflow, are left out of a figure."""

MOST_GROWTH = 1e4
"""Growth of a column beyond its start from which a figure shows its absolute values on a logarithmic axis."""

SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")

MOST_TICKS = 5

MOST_NAMES = 20
"""Number of findings that a figure names."""


def panels(rows: int, columns: int, width: float, height: float) -> Panels:
    """Return the axes of a new figure, of ``width`` times ``height`` inches each.

    Raises
    ------
    ImportError
        Without matplotlib.
    """
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("matplotlib is not installed; help: pip install 'libration[plots]'") from error
    size = (width * columns, height * rows)
    _, axes = pyplot.subplots(rows, columns, figsize=size, sharex="col" if rows > 1 else "none", squeeze=False, layout="constrained")
    found: Panels = axes.ravel()
    return found


def with_unit(name: str, unit: str | None) -> str:
    """Return a label with its unit, if there is one."""
    if unit is None or unit in ("", "1"):
        return name
    raised = re.sub(r"\^(-?[0-9]+)", lambda power: power[1].translate(SUPERSCRIPTS), unit)
    return f"{name} ({raised})"


def plot_trajectory(columns: Mapping[str, NDArray[Any]], units: Mapping[str, str], end: str, stopped_at: float | None) -> Panels:
    """Draw the columns over time, in a panel for each unit.

    Parameters
    ----------
    end:
        What became of states that are not finite, for the heading.
    stopped_at:
        Time in s of the first state that is not finite.
    """
    groups: dict[str | int, list[str]] = {}
    for i, name in enumerate(name for name in columns if name not in ("trajectory", "step", "t")):
        # Columns without a known unit need not be comparable.
        groups.setdefault(units.get(name) or i, []).append(name)
    axes = panels(len(groups), 1, 7.0, 2.2 if len(groups) > 1 else 3.5)
    count = int(columns["trajectory"].max()) + 1 if "trajectory" in columns else 1
    # Each of several trajectories has its clock and a row of each step.
    time = columns["t"].reshape(-1, count)
    for axis, names in zip(axes, groups.values()):
        rows = [columns[name].astype(float).reshape(-1, count) for name in names]
        rows = [np.where(np.abs(values) < LARGEST, values, np.nan) for values in rows]
        grows = any(_grows(values) for values in rows)
        for number, (name, values) in enumerate(zip(names, rows)):
            values = np.where(values == 0, np.nan, np.abs(values)) if grows else values
            lines = axis.plot(time, values, color=f"C{number % 10}", alpha=max(0.15, count**-0.5))
            lines[0].set_label(name)
        label = ", ".join(names) if len(names) < 5 else f"{names[0]} … {names[-1]}"
        axis.set_ylabel(with_unit(f"|{label}|" if grows else label, units.get(names[0])))
        if grows:
            axis.set_yscale("log")
        if len(names) > 1:
            legend = axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
            for handle in legend.legend_handles:
                handle.set_alpha(1.0)
        if stopped_at is not None:
            axis.axvline(stopped_at, color="0.4", linestyle=":")
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("time (s)")
    what = "Trajectory" if count == 1 else f"{count} trajectories"
    axes[0].set_title(f"{what} of {np.max(time):.6g} s{end}")
    return axes


def _grows(values: NDArray[Any]) -> bool:
    """Whether values grow over many powers of ten."""
    sizes = np.abs(values[np.isfinite(values) & (values != 0)])
    return len(sizes) > 0 and float(sizes.max()) > MOST_GROWTH * max(float(sizes[0]), 1.0)


def plot_steps(analysis: Mapping[str, Any]) -> Panels:
    """Draw a step: its eigenvalues, stable time steps, stable latencies of its loop, errors, and the modes of its plant."""
    dt, late = analysis["dt"], analysis.get("latency_steps", 0.0) * analysis["dt"]
    linear = analysis.get("linear")
    drawn: list[Callable[[Axes], None]] = []
    if "eigenvalues" in analysis:
        drawn.append(lambda axis: _eigenvalues(axis, analysis))
    if "stability_windows" in analysis:
        named = ("Stable time steps", "time step (s)", f"dt = {dt:.6g} s")
        drawn.append(lambda axis: _windows(axis, analysis["stability_windows"], dt, named))
    if "latency_windows" in analysis:
        windows = [[None if end is None else end * dt for end in window] for window in analysis["latency_windows"]]
        of_loop = ("Stable latencies of the loop", "latency (s)", f"latency = {late:.6g} s")
        drawn.append(lambda axis: _windows(axis, windows, late, of_loop))
    if "motion" in analysis:
        drawn.append(lambda axis: _errors(axis, analysis["motion"]))
    # An oscillator has one mode.
    if linear and "stability_windows" not in analysis:
        drawn.append(lambda axis: _modes(axis, linear["modes"], linear["loop"], "Modes at the equilibrium;\nthose on the left of the line decay"))
    axes = panels(1, len(drawn), 4.5, 4.2)
    for axis, draw in zip(axes, drawn):
        draw(axis)
    return axes


def _radius(minus_one: float | None) -> str:
    if minus_one is None:
        return "not finite"
    if abs(minus_one) >= 1e-3 or minus_one == 0:
        return f"{1 + minus_one:.6g}"
    return f"1 {'+' if minus_one > 0 else '−'} {abs(minus_one):.3g}"


def _eigenvalues(axis: Axes, analysis: Mapping[str, Any]) -> None:
    """Draw eigenvalues of a step with the unit circle."""
    eigenvalues, radius = analysis["eigenvalues"], _radius(analysis["spectral_radius_minus_one"])
    axis.set_title(f"A step of {analysis['integrator']} without feedback\ndt = {analysis['dt']:.6g} s, spectral radius {radius}")
    angle = np.linspace(0, 2 * np.pi, 361)
    axis.plot(np.cos(angle), np.sin(angle), color="0.6", linewidth=1, label="unit circle")
    points = np.array(eigenvalues, dtype=float).reshape(-1, 2)
    axis.plot(points[:, 0], points[:, 1], "x", color="C0", markersize=8, markeredgewidth=2, label="eigenvalues")
    axis.set(aspect="equal", xlabel="real part", ylabel="imaginary part")
    axis.grid(alpha=0.3)
    axis.legend(loc="lower left")


def _windows(axis: Axes, windows: Sequence[Sequence[float | None]], at: float, words: tuple[str, str, str]) -> None:
    """Draw stable ranges of a quantity, and its value; the words are title, label of the axis, and name of the value."""
    title, label, named = words
    axis.set(title=title, xlabel=label)
    ends = [end for window in windows for end in window if end is not None] + [at]
    right = 1.15 * max(ends) or 1.0
    for low, high in windows:
        axis.barh(0, (right if high is None else high) - (low or 0.0), left=low or 0.0, height=0.5, color="C2", alpha=0.5)
        if high is not None:
            axis.annotate(f"{high:.4g}", (high, 0.27), ha="center", va="bottom")
    if not windows:
        axis.annotate("none", (right / 2, 0), ha="center", va="center")
    axis.axvline(at, color="C3", label=named)
    axis.set(xlim=(0, right), ylim=(-0.8, 0.8), yticks=[])
    axis.legend(loc="lower right")


def plot_plant(analysis: Mapping[str, Any]) -> Panels:
    """Draw the eigenvalues of a linear plant and of its loop, and the stable time steps of integrators."""
    steps = [step for step in analysis["steps"] if step["integrator"] != "exact"]
    axes = panels(1, 2 if steps else 1, 5.2, 4.4)
    _modes(axes[0], analysis["modes"], analysis["loop"])
    if steps:
        _largest_steps(axes[1], steps, analysis["dt"])
    return axes


def _modes(
    axis: Axes,
    modes: Sequence[Mapping[str, Any]],
    loop: Mapping[str, Any] | None,
    title: str = "Modes; those on the left of the line decay",
) -> None:
    drawn = [("plant", "x", "C0", modes)] + ([("closed loop", "o", "C1", loop["modes"])] if loop else [])
    sizes: list[float] = []
    for label, marker, colour, found in drawn:
        # Eigenvalues of a sampled plant and of a loop are those of a step. A mode that vanishes in one step has no rate.
        rates = [(mode["growth_rate"], mode["frequency"]) for mode in found]
        points = np.array(rates, dtype=float).reshape(-1, 2) * (1.0, 2 * math.pi)
        points = points[np.isfinite(points).all(axis=1)]
        mirrored = np.concatenate([points, points * (1, -1)])
        axis.plot(mirrored[:, 0], mirrored[:, 1], marker, color=colour, fillstyle="none", markeredgewidth=2, linestyle="none", label=label)
        sizes += [float(size) for size in np.hypot(points[:, 0], points[:, 1]) if size > 0]
    if sizes and max(sizes) > 100 * min(sizes):
        # A power of ten, since ticks are at powers of ten.
        threshold = 10.0 ** math.ceil(math.log10(min(sizes)))
        axis.set_xscale("symlog", linthresh=threshold)
        axis.set_yscale("symlog", linthresh=threshold)
        for scaled in (axis.xaxis, axis.yaxis):
            locator: Any = scaled.get_major_locator()
            locator.set_params(numticks=MOST_TICKS)
    axis.axvline(0, color="0.6", linewidth=1)
    axis.set(xlabel="growth rate (1/s)", ylabel="frequency (rad/s)", title=title)
    axis.grid(alpha=0.3)
    axis.legend(loc="best")


def _largest_steps(axis: Axes, steps: Sequence[Mapping[str, Any]], dt: float | None) -> None:
    limits = [step["largest_stable_dt"] for step in steps]
    known = [limit for limit in limits if limit] + ([dt] if dt else [])
    right, left = (3 * max(known), min(known) / 3) if known else (1.0, 0.1)
    for row, (step, limit) in enumerate(zip(steps, limits)):
        unlimited = limit is None and bool(step["stable_dt"])
        if unlimited or limit:
            axis.barh(row, (right if unlimited else limit) - left, left=left, color="C2", alpha=0.5)
        text = "no limit" if unlimited else f"{limit:.3g}" if limit else "never stable"
        axis.annotate(text, (left, row), xytext=(4, 0), textcoords="offset points", va="center", fontsize="small")
    axis.set(xscale="log", xlim=(left, right), xlabel="time step (s)", title="Stable time steps of the plant")
    axis.set_yticks(range(len(steps)), [step["integrator"] for step in steps])
    axis.invert_yaxis()
    if dt:
        axis.axvline(dt, color="C3", label=f"dt = {dt:.6g} s")
        axis.legend(loc="lower right")


def _errors(axis: Axes, motion: Mapping[str, Any]) -> None:
    """Draw the errors of an integrator on a motion."""
    errors = motion["errors"]
    known = [error["error"] or 0.0 for error in errors]
    for row, error in enumerate(known):
        if error > 0 and math.isfinite(error):
            axis.plot(error, row, "o", color="C0")
        axis.axhline(row, color="0.85", linewidth=1, zorder=0)
    sizes = [error for error in known if error > 0 and math.isfinite(error)] or [1.0]
    # Ticks are at powers of ten.
    axis.set_xscale("log")
    axis.set_xlim(10.0 ** (math.floor(math.log10(min(sizes))) - 0.2), 10.0 ** (math.ceil(math.log10(max(sizes))) + 0.2))
    axis.set_yticks(range(len(errors)), [with_unit(error["name"], error["unit"]) for error in errors])
    axis.invert_yaxis()
    axis.set_xlabel("error, in the unit of the state")
    axis.set_title(f"Errors of {motion['integrator']}\nafter {motion['error_steps']} steps of {motion['dt']:.6g} s")


def share_of_allowed(finding: Finding) -> float | None:
    """Return the difference of a measurement from its prediction relative to the allowed one; None without both."""
    if finding.verdict == "measured" or finding.predicted is None or finding.measured is None:
        return None
    difference = finding.measured - finding.predicted
    excess = {"at-most": max(difference, 0.0), "at-least": max(-difference, 0.0)}.get(finding.relation, abs(difference))
    allowed = finding.tolerance or 0.0
    return excess / allowed if allowed > 0 else 0.0 if excess == 0 else math.inf


def plot_findings(findings: Sequence[Finding], summary: str) -> Panels:
    """Draw the difference from the prediction of each finding, relative to the allowed one, by study."""
    studies = list(dict.fromkeys(finding.study for finding in findings))
    (axis,) = axes = panels(1, 1, 7.0, 1.6 + 0.35 * max(len(studies), 2))
    largest, wrong = 10.0, list[tuple[float, float, str]]()
    for row, study in enumerate(studies):
        shares = [(share_of_allowed(finding), finding) for finding in findings if finding.study == study]
        judged = [(share, finding) for share, finding in shares if share is not None]
        for verdict, colour in (("agrees", "C0"), ("disagrees", "C3")):
            shown = [(min(max(share, SMALLEST_SHARE), LARGEST_SHARE), finding.id) for share, finding in judged if finding.verdict == verdict]
            # Points of a study are spread in its row, so that equal ones are seen.
            heights = row + (np.linspace(-0.3, 0.3, len(shown)) if len(shown) > 1 else np.zeros(len(shown)))
            axis.plot([share for share, _ in shown], heights, ".", color=colour, alpha=0.6)
            largest = max([largest, *(share for share, _ in shown)])
            if verdict == "disagrees":
                wrong += [(share, float(height), name) for (share, name), height in zip(shown, heights)]
    style: dict[str, Any] = {"ha": "right", "va": "center", "fontsize": "small", "color": "C3"}
    style["bbox"] = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0}
    for share, height, name in wrong[:MOST_NAMES]:
        axis.annotate(name, (share, height), xytext=(-6, 0), textcoords="offset points", **style)
    axis.axvline(1.0, color="0.4")
    axis.set(xscale="log", xlim=(SMALLEST_SHARE / 2, 2 * largest), ylim=(len(studies) - 0.5, -0.5))
    axis.set_yticks(range(len(studies)), studies)
    ticks = [SMALLEST_SHARE * 10**n for n in range(0, 12, 2) if SMALLEST_SHARE * 10**n <= 2 * largest]
    axis.set_xticks(ticks, ["≤ 0.0001", *(f"{tick:g}" for tick in ticks[1:])])
    axis.set(xlabel="difference from the prediction / allowed difference (beyond 1: disagrees)", title=summary)
    axis.grid(alpha=0.3)
    return axes
