"""Pictures of the systems, rendered with NumPy."""

from __future__ import annotations

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
