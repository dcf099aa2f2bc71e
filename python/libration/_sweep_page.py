"""The HTML page of a sweep."""

from __future__ import annotations

import html
import itertools
from typing import Any, Mapping, Sequence

from ._heat_map import Axis, ColorScale, heat_map, is_drawn, line_plot, notation
from ._settings import nearest

_UNITS = {name: "s" for name in ("dt", "latency", "period", "output_latency", "horizon", "action_delay", "observation_delay", "delay")}
_SUFFIXES = {"_seconds": "s", "_steps": "steps", "phase_error_per_step": "rad"}
_BESIDE_UNIT = ("stated", "stable_up_to", "tried_up_to", "measured", "predicted", "tolerance")
"""Columns whose unit is the column ``unit`` beside them."""

_MOST_MAPS = 60
_MOST_SLICES = 6
_MOST_CONSTANTS = 40

_STYLE = """
:root{color-scheme:light dark;--page:light-dark(#fdfdfb,#14171a);--ink:light-dark(#1b1f24,#e6e8ea);--soft:light-dark(#5b6570,#9aa4ae);
--rule:light-dark(#d9dee3,#343a41);--bad:light-dark(#b3261e,#ff8a80);--line:light-dark(#0068a8,#5ab4ee)}
html{background:var(--page);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
body{margin:0 auto;max-width:1000px;padding:32px 20px 80px}
h1{font-size:28px;line-height:1.2}h2{font-size:19px;margin:48px 0 4px;overflow-wrap:anywhere}
p{max-width:70ch;margin:8px 0}.soft{color:var(--soft)}.bad{color:var(--bad)}
figure{margin:12px 0 0}svg{display:block;width:100%;max-width:700px;height:auto}
svg text{font-size:12px;fill:var(--soft)}svg .label{fill:var(--ink);font-size:13px}
.frame{fill:none;stroke:var(--rule)}.tick{stroke:var(--soft)}.line{fill:none;stroke:var(--line);stroke-width:1.6}
.point{fill:var(--line)}.cell{fill:transparent}.cell:hover{stroke:var(--page);stroke-width:2}.missing{fill:var(--rule)}
table{border-collapse:collapse;font-size:14px}th,td{text-align:left;padding:4px 14px 4px 0;border-bottom:1px solid var(--rule);overflow-wrap:anywhere}
nav a{color:inherit;margin-right:14px;display:inline-block}
@media(max-width:600px){svg text{font-size:16px}svg .label{font-size:16px}}
"""


def page_of(
    function: str,
    over: Mapping[str, Sequence[Any]],
    columns: Mapping[str, Sequence[Any]],
    units: Mapping[str, str],
    results: Sequence[str] | None,
    title: str | None,
) -> str:
    """Return the page of a table of a sweep.

    Raises
    ------
    ValueError
        For a result that the table does not have, or that has no numbers.
    """
    found = [name for name in columns if name not in over and name != "error"]
    numeric = [name for name in found if any(is_drawn(value) for value in columns[name])]
    varied = [name for name in numeric if len(set(map(repr, columns[name]))) > 1]
    # First those that need a map.
    varied.sort(key=lambda name: -_dependences(columns[name], over))
    drawn = varied[:_MOST_MAPS] if results is None else list(results)
    for name in drawn:
        if name not in columns:
            raise ValueError(f"results has {name!r}: {nearest(name, found)}")
        if name not in numeric:
            raise ValueError(f"results has {name!r}, which has no numbers; expected some of {', '.join(numeric)}")
    heading = title or f"{function} over {' and '.join(over)}"
    sections = [_section(name, i, over, columns, units) for i, name in enumerate(drawn)]
    links = "".join(f"<a href='#r{i}'>{html.escape(name)}</a>" for i, name in enumerate(drawn))
    body = [f"<h1>{html.escape(heading)}</h1>", _answer(over, columns["error"])]
    if results is None and len(varied) > _MOST_MAPS:
        body.append(f"<p class='soft'>{_MOST_MAPS} of {len(varied)} results are drawn; <code>page(path, results=[…])</code> draws others.</p>")
    body += [f"<nav aria-label='Results'>{links}</nav>", *sections, _constants(found, columns)]
    return (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'><meta name='viewport' content='width=device-width'>"
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; style-src \'unsafe-inline\'; img-src data:">'
        f"<title>{html.escape(heading)}</title><style>{_STYLE}</style></head><body><main>{''.join(body)}</main></body></html>\n"
    )


def _dependences(values: Sequence[Any], over: Mapping[str, Sequence[Any]]) -> int:
    """Return the number of swept keys on which a result depends."""
    found, stride = 0, len(values)
    for labels in over.values():
        block, stride = stride, stride // len(labels)
        found += any(repr(values[i]) != repr(values[i + stride]) for i in range(len(values) - stride) if (i + stride) % block >= stride)
    return found


def _answer(over: Mapping[str, Sequence[Any]], errors: Sequence[str | None]) -> str:
    grid = " × ".join(f"{len(values)} values of {html.escape(key)}" for key, values in over.items())
    failed = [error for error in errors if error is not None]
    text = f"<p>{len(errors):,} points: {grid}.</p>"
    if failed:
        text += f"<p class='bad'>{len(failed):,} points failed, the first with: {html.escape(failed[0][:300])}</p>"
    return text


def _section(name: str, number: int, over: Mapping[str, Sequence[Any]], columns: Mapping[str, Sequence[Any]], units: Mapping[str, str]) -> str:
    values, unit = columns[name], _unit(name, columns, units)
    axes = [Axis(key, _unit(key, columns, units), labels) for key, labels in over.items()]
    numbers = [float(value) for value in values if is_drawn(value)]
    scale = ColorScale(numbers)
    boolean = all(isinstance(value, bool) for value in values if value is not None)
    if boolean:
        scale = ColorScale([0.0, 1.0])
    figures = []
    rest = axes[2:]
    slices = list(itertools.product(*(range(len(axis.values)) for axis in rest)))
    inner = len(slices)
    for k, at in enumerate(slices[:_MOST_SLICES]):
        sliced = values[k::inner]
        if len(axes) == 1:
            picture = line_plot(name, axes[0], sliced, scale, boolean, unit)
        else:
            lines = len(axes[1].values)
            rows = [sliced[i * lines : (i + 1) * lines] for i in range(len(axes[0].values))]
            picture = heat_map(name, axes[0], axes[1], rows, scale, boolean, unit)
        where = ", ".join(axis.at(index) for axis, index in zip(rest, at))
        caption = f"<figcaption class='soft'>{html.escape(where)}</figcaption>" if where else ""
        figures.append(f"<figure>{caption}{picture}</figure>")
    omitted = f"<p class='soft'>{_MOST_SLICES} of {inner} maps are drawn.</p>" if inner > _MOST_SLICES else ""
    return f"<section id='r{number}'><h2>{html.escape(name)}</h2>{_finding(values, axes, boolean, scale, unit)}{''.join(figures)}{omitted}</section>"


def _finding(values: Sequence[Any], axes: Sequence[Axis], boolean: bool, scale: ColorScale, unit: str) -> str:
    """Return the sentence with the extremes of a result and their places."""
    drawn = [i for i, value in enumerate(values) if is_drawn(value)]
    gaps = len(values) - len(drawn)
    missing = f" {gaps:,} points have no number, drawn in grey." if gaps else ""
    if boolean:
        text = f"Yes at {sum(bool(values[i]) for i in drawn):,} of {len(drawn):,} points."
    else:
        ends = (min(drawn, key=lambda i: values[i]), max(drawn, key=lambda i: values[i]))
        of = f" {unit}" if unit else ""
        text = "From " + " to ".join(f"{notation(values[i])}{of} at {_place(i, axes)}" for i in ends) + "."
        text += " The scale is logarithmic." if scale.is_logarithmic else ""
    return f"<p>{html.escape(text + missing)}</p>"


def _place(point: int, axes: Sequence[Axis]) -> str:
    texts = []
    for axis in reversed(axes):
        point, index = divmod(point, len(axis.values))
        texts.append(axis.at(index))
    return ", ".join(reversed(texts))


def _constants(names: Sequence[str], columns: Mapping[str, Sequence[Any]]) -> str:
    rows = []
    for name in names:
        seen = {repr(value): value for value in columns[name] if value is not None}
        if len(seen) == 1:
            value = next(iter(seen.values()))
            rows.append(f"<tr><th>{html.escape(name)}</th><td>{html.escape(str(value)[:200])}</td></tr>")
    if not rows:
        return ""
    more = f"<p class='soft'>and {len(rows) - _MOST_CONSTANTS} others</p>" if len(rows) > _MOST_CONSTANTS else ""
    return f"<h2>The same at all points</h2><table>{''.join(rows[:_MOST_CONSTANTS])}</table>{more}"


def _unit(name: str, columns: Mapping[str, Sequence[Any]], units: Mapping[str, str]) -> str:
    if name in units:
        return units[name]
    table, _, last = name.rpartition(".")
    beside = columns.get(f"{table}.unit")
    if beside is not None and last in _BESIDE_UNIT:
        found = {text for text in beside if isinstance(text, str)} - {"1"}
        return found.pop() if len(found) == 1 else ""
    return _UNITS.get(last) or next((unit for suffix, unit in _SUFFIXES.items() if last.endswith(suffix)), "")
