"""Figures of a sweep as SVG: a map over two keys, a line over one."""

from __future__ import annotations

import html
import math
from dataclasses import dataclass
from typing import Any, Sequence

_STOPS = ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))
"""Viridis."""
_LEVELS = 48
_MOST_TITLES = 600
"""Cells above which a map has no titles of cells, which would make the page megabytes long."""

_WIDTH, _HEIGHT, _LEFT, _TOP, _RIGHT, _BOTTOM = 460.0, 300.0, 86.0, 12.0, 112.0, 56.0


@dataclass(frozen=True)
class Axis:
    """A swept key with its values."""

    name: str
    unit: str
    values: Sequence[Any]

    @property
    def label(self) -> str:
        return f"{self.name} ({self.unit})" if self.unit else self.name

    def at(self, index: int) -> str:
        return f"{self.name} = {notation(self.values[index])}" + (f" {self.unit}" if self.unit else "")


class ColorScale:
    """Colours of numbers between two ends; logarithmic if the numbers are positive and span three decades."""

    def __init__(self, numbers: Sequence[float]) -> None:
        self.low, self.high = min(numbers), max(numbers)
        self.is_logarithmic = self.low > 0 and self.high / self.low > 1e3

    def level(self, value: float) -> int:
        return min(max(int(self.part(value) * _LEVELS), 0), _LEVELS - 1)

    def part(self, value: float) -> float:
        """Return the place of a number between the ends, from 0 to 1."""
        low, high = self.low, self.high
        if self.is_logarithmic:
            low, high, value = math.log(low), math.log(high), math.log(value)
        # Halves, since the difference of two floats may overflow.
        return 0.5 if high == low else min(max((value / 2 - low / 2) / (high / 2 - low / 2), 0.0), 1.0)

    def number(self, part: float) -> float:
        if self.is_logarithmic:
            return math.exp(math.log(self.low) * (1 - part) + math.log(self.high) * part)
        return self.low * (1 - part) + self.high * part


def notation(value: Any) -> str:
    """Return a value as a short text."""
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    text = f"{value:.4g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 24 else f"{text[:23]}…"


def is_drawn(value: Any) -> bool:
    return isinstance(value, (bool, int, float)) and abs(value) < 1e300


def heat_map(name: str, x: Axis, y: Axis, rows: Sequence[Sequence[Any]], scale: ColorScale, boolean: bool, unit: str) -> str:
    """Return the map of a result. ``rows[i][j]`` is the value at ``x.values[i]`` and ``y.values[j]``; the first is at the bottom."""
    columns, lines = len(x.values), len(y.values)
    width, height = _WIDTH / columns, _HEIGHT / lines
    by_level: dict[int, list[str]] = {}
    missing: list[str] = []
    titles: list[str] = []
    for i in range(columns):
        for j in range(lines):
            value = rows[i][j]
            left, top = _LEFT + i * width, _TOP + _HEIGHT - (j + 1) * height
            cell = f"M{left:.2f} {top:.2f}h{width + 0.05:.2f}v{height + 0.05:.2f}h{-width - 0.05:.2f}z"
            place = by_level.setdefault(scale.level(float(value)), []) if is_drawn(value) else missing
            place.append(cell)
            if columns * lines <= _MOST_TITLES:
                text = html.escape(f"{x.at(i)}, {y.at(j)}: {notation(value)}")
                titles.append(f"<path class='cell' d='{cell}'><title>{text}</title></path>")
    parts = ["<g shape-rendering='crispEdges'>"]
    parts += [f"<path fill='{_color(level)}' d='{''.join(cells)}'/>" for level, cells in sorted(by_level.items())]
    if missing:
        parts.append(f"<path class='missing' d='{''.join(missing)}'/>")
    parts += [*titles, "</g>", _frame()]
    parts += _bottom_ticks(x, [_LEFT + (i + 0.5) * width for i in range(columns)])
    parts += _left_ticks([(_TOP + _HEIGHT - (j + 0.5) * height, notation(y.values[j])) for j in _chosen(lines, 10)], y.label)
    parts.append(_legend(scale, boolean, unit))
    return _svg(f"Map of {name} over {x.name} and {y.name}", parts)


def line_plot(name: str, x: Axis, values: Sequence[Any], scale: ColorScale, boolean: bool, unit: str) -> str:
    """Return the line of a result over one key; lines break at points without a number."""
    by_value = all(is_drawn(value) and not isinstance(value, bool) for value in x.values)
    axis = ColorScale([float(value) for value in x.values]) if by_value else None
    places = [
        _LEFT + _WIDTH * (0.03 + 0.94 * (axis.part(float(v)) if axis else i / max(len(x.values) - 1, 1))) for i, v in enumerate(x.values)
    ]
    path, points, is_open = [], [], False
    for i, value in enumerate(values):
        if not is_drawn(value):
            is_open = False
            continue
        top = _TOP + _HEIGHT * (0.96 - 0.92 * scale.part(float(value)))
        path.append(f"{'L' if is_open else 'M'}{places[i]:.2f} {top:.2f}")
        is_open = True
        if len(values) <= _MOST_TITLES:
            text = html.escape(f"{x.at(i)}: {notation(value)}")
            points.append(f"<circle class='point' cx='{places[i]:.2f}' cy='{top:.2f}' r='3'><title>{text}</title></circle>")
    parts = [_frame(), f"<path class='line' d='{''.join(path)}'/>", *points, *_bottom_ticks(x, places)]
    shares = (0.0, 1.0) if boolean else (0.0, 0.25, 0.5, 0.75, 1.0)
    marks = [(_TOP + _HEIGHT * (0.96 - 0.92 * share), _end(scale, share, boolean)) for share in shares]
    parts += _left_ticks(marks, f"{name} ({unit})" if unit else name)
    return _svg(f"{name} over {x.name}", parts)


def _svg(name: str, parts: Sequence[str]) -> str:
    width, height = _LEFT + _WIDTH + _RIGHT, _TOP + _HEIGHT + _BOTTOM
    return (
        f"<svg viewBox='0 0 {width:g} {height:g}' role='img' aria-label='{html.escape(name, quote=True)}'>"
        f"{''.join(parts)}</svg>"
    )


def _frame() -> str:
    return f"<rect class='frame' shape-rendering='crispEdges' x='{_LEFT}' y='{_TOP}' width='{_WIDTH}' height='{_HEIGHT}'/>"


def _bottom_ticks(x: Axis, places: Sequence[float]) -> list[str]:
    longest = max(len(notation(value)) for value in x.values)
    top = _TOP + _HEIGHT
    parts, last = [], -math.inf
    for i in range(len(places)):
        if abs(places[i] - last) < max(44.0, 7.0 * longest + 10.0):
            continue
        last = places[i]
        parts.append(f"<path class='tick' d='M{last:.2f} {top}v5'/>")
        parts.append(f"<text x='{last:.2f}' y='{top + 19}' text-anchor='middle'>{html.escape(notation(x.values[i]))}</text>")
    parts.append(f"<text class='label' x='{_LEFT + _WIDTH / 2}' y='{top + 44}' text-anchor='middle'>{html.escape(x.label)}</text>")
    return parts


def _left_ticks(marks: Sequence[tuple[float, str]], label: str) -> list[str]:
    parts = []
    for place, text in marks:
        parts.append(f"<path class='tick' d='M{_LEFT} {place:.2f}h-5'/>")
        parts.append(f"<text x='{_LEFT - 8}' y='{place + 4:.2f}' text-anchor='end'>{html.escape(text[:10])}</text>")
    move = f"translate(14 {_TOP + _HEIGHT / 2}) rotate(-90)"
    parts.append(f"<text class='label' transform='{move}' text-anchor='middle'>{html.escape(label)}</text>")
    return parts


def _legend(scale: ColorScale, boolean: bool, unit: str) -> str:
    left = _LEFT + _WIDTH + 16
    levels = (0, _LEVELS - 1) if boolean else range(_LEVELS)
    step = _HEIGHT / len(levels)
    parts = [
        f"<rect shape-rendering='crispEdges' fill='{_color(level)}' x='{left}' y='{_TOP + _HEIGHT - (i + 1) * step:.2f}' width='14' height='{step + 0.3:.2f}'/>"
        for i, level in enumerate(levels)
    ]
    for share in (0.0, 1.0) if boolean else (0.0, 0.25, 0.5, 0.75, 1.0):
        top = _TOP + _HEIGHT * (1 - share)
        base = min(max(top + 4, _TOP + 10), _TOP + _HEIGHT)
        parts.append(f"<text x='{left + 20}' y='{base:.2f}'>{html.escape(_end(scale, share, boolean))}</text>")
    if unit:
        parts.append(f"<text class='label' x='{left}' y='{_TOP + _HEIGHT + 19}'>{html.escape(unit)}</text>")
    return "".join(parts)


def _end(scale: ColorScale, share: float, boolean: bool) -> str:
    if boolean:
        return "yes" if share else "no"
    return notation(float(scale.number(share)))


def _chosen(number: int, most: int) -> list[int]:
    """Return at most ``most`` indices at equal distances."""
    return list(range(0, number, max(1, math.ceil(number / most))))


def _color(level: int) -> str:
    place = level / (_LEVELS - 1) * (len(_STOPS) - 1)
    first = min(int(place), len(_STOPS) - 2)
    rest = place - first
    mixed = (round(a * (1 - rest) + b * rest) for a, b in zip(_STOPS[first], _STOPS[first + 1]))
    return "#" + "".join(f"{channel:02x}" for channel in mixed)
