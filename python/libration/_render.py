"""Pictures of the systems, rendered with NumPy."""

from __future__ import annotations

from typing import Sequence

import numpy as np

from ._presets import Preset

SIZE = 300
PAPER = (250, 250, 248)
INK = (60, 64, 72)
FAINT = (205, 207, 212)
BODY = (31, 119, 180)


class Canvas:
    """A square picture of part of the plane, with antialiased edges."""

    def __init__(self, half_width: float) -> None:
        self.scale = SIZE / (2 * half_width)
        axis = (np.arange(SIZE) + 0.5) / self.scale - half_width
        self.x, self.y = np.meshgrid(axis, -axis)
        self.pixels = np.empty((SIZE, SIZE, 3))
        self.pixels[:] = PAPER

    def _lay(self, distance: np.ndarray, colour: tuple[int, int, int]) -> None:
        """Fill the region whose signed distance from its edge is negative."""
        cover = np.clip(0.5 - distance * self.scale, 0.0, 1.0)[..., None]
        self.pixels += cover * (np.array(colour, dtype=float) - self.pixels)

    def disc(self, x: float, y: float, radius: float, colour: tuple[int, int, int]) -> None:
        self._lay(np.hypot(self.x - x, self.y - y) - radius, colour)

    def box(self, x: float, y: float, width: float, height: float, colour: tuple[int, int, int]) -> None:
        across, up = np.abs(self.x - x) - width / 2, np.abs(self.y - y) - height / 2
        self._lay(np.maximum(across, up), colour)

    def line(self, points: np.ndarray, width: float, colour: tuple[int, int, int]) -> None:
        """Draw a polyline through points, ``(n, 2)``."""
        nearest = np.full(self.x.shape, np.inf)
        for (ax, ay), (bx, by) in zip(points[:-1], points[1:]):
            dx, dy = bx - ax, by - ay
            along = ((self.x - ax) * dx + (self.y - ay) * dy) / max(dx * dx + dy * dy, 1e-30)
            along = np.clip(along, 0.0, 1.0)
            nearest = np.minimum(nearest, np.hypot(self.x - ax - along * dx, self.y - ay - along * dy))
        self._lay(nearest - width / 2, colour)

    def array(self) -> np.ndarray:
        return self.pixels.round().astype(np.uint8)


def picture(preset: Preset, position: float, velocity: float) -> np.ndarray:
    """Return a picture of the system in a state, ``(300, 300, 3)`` of ``uint8``."""
    if not np.isfinite(position):
        return Canvas(1.0).array()
    return {"pendulum": _pendulum, "oscillator": _spring, "duffing": _well}[preset.system](position)


def state_picture(states: Sequence[str], values: np.ndarray) -> np.ndarray:
    """Return a picture of the states of any system, ``(300, 300, 3)`` of ``uint8``: a row for each, from the top in the order of ``states``.

    A bar goes from zero, in the middle, to the value, coordinates in blue and all others in grey. Tick marks are at ±0.1, ±1, ±10 and ±100; the
    axis is linear within the first of them and logarithmic beyond.
    """
    canvas = Canvas(1.0)
    height = 2.0 / len(states)
    for i, (name, value) in enumerate(zip(states, values.tolist())):
        y = 1.0 - (i + 0.5) * height
        canvas.box(0.0, y, 2.0, 0.008, FAINT)
        for tick in (0.0, 0.1, 1.0, 10.0, 100.0):
            for side in {_place(tick), _place(-tick)}:
                canvas.box(side, y, 0.008, 0.5 * height if tick == 0 else 0.25 * height, FAINT)
        if np.isfinite(value):
            end = _place(value)
            canvas.box(end / 2, y, max(abs(end), 0.012), 0.4 * min(height, 0.5), BODY if f"{name}'" in states else INK)
    return canvas.array()


def _place(value: float) -> float:
    """Return the place of a value on an axis from -1 to 1, with ±100 at ±0.9."""
    return float(np.clip(0.9 * np.arcsinh(10 * value) / np.arcsinh(1000.0), -1.0, 1.0))


def _pendulum(angle: float) -> np.ndarray:
    canvas = Canvas(1.5)
    x, y = float(np.sin(angle)), float(-np.cos(angle))
    canvas.line(np.array([[0.0, -1.0], [0.0, 1.0]]), 0.012, FAINT)
    canvas.line(np.array([[0.0, 0.0], [x, y]]), 0.06, INK)
    canvas.disc(x, y, 0.16, BODY)
    canvas.disc(0.0, 0.0, 0.06, INK)
    return canvas.array()


def _spring(position: float) -> np.ndarray:
    half = max(2.0, 1.3 * abs(position))
    canvas = Canvas(half)
    unit = half / 2.0
    wall = -1.8 * unit
    canvas.box(wall, 0.0, 0.06 * unit, 1.2 * unit, INK)
    canvas.line(np.array([[0.0, -0.6 * unit], [0.0, 0.6 * unit]]), 0.012 * unit, FAINT)
    left = position - 0.25 * unit
    coils = np.linspace(wall, left, 18)
    heights = 0.16 * unit * np.where(np.arange(18) % 2, 1.0, -1.0)
    heights[[0, 1, -2, -1]] = 0.0
    canvas.line(np.column_stack([coils, heights]), 0.03 * unit, INK)
    canvas.box(position, 0.0, 0.5 * unit, 0.5 * unit, BODY)
    return canvas.array()


def _well(position: float) -> np.ndarray:
    half = max(2.0, 1.2 * abs(position))
    canvas = Canvas(half)
    across = np.linspace(-half, half, 121)

    def height(q):
        return np.clip((q**4 / 4 - q**2 / 2) * 1.6, -half, 2 * half)

    canvas.line(np.column_stack([across, height(across) - 0.09]), 0.03 * half / 2, INK)
    canvas.disc(position, float(height(position)) + 0.09, 0.12 * half / 2, BODY)
    return canvas.array()
