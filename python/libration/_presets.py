"""Default settings of the environments."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, pi
from types import MappingProxyType
from typing import Mapping


@dataclass(frozen=True)
class Preset:
    """An environment: a system of the catalogue, a task, and numbers."""

    name: str
    """Name in :class:`libration.Environments`."""
    system: str
    task: str
    dt: float
    """Time between two actions in s."""
    max_action: float
    """Largest acceleration."""
    max_episode_steps: int
    start_position: tuple[float, float]
    start_velocity: tuple[float, float]
    seen: tuple[str, ...]
    """Names of the observed numbers."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """Parameters of the system, in place of those of the catalogue."""
    costs: Mapping[str, float] = field(default_factory=dict)
    """Numbers of the task, in the order of the engine."""

    actions: tuple[str, ...] = ("acceleration",)

    @property
    def id(self) -> str:
        """Identifier in Gymnasium: ``Pendulum-v1`` is that of Gymnasium's own pendulum."""
        return f"{'PendulumSwingUp' if self.name == 'Pendulum' else self.name}-v0"

    @property
    def limits(self) -> tuple[float, ...]:
        """Largest magnitude of each number that is observed without noise."""
        return tuple(1.0 if name.startswith(("cos", "sin")) else inf for name in self.seen)


REGULATE = MappingProxyType(
    {"position_cost": 1.0, "velocity_cost": 0.1, "effort_cost": 0.001, "bound": 10.0}
)

PRESETS: Mapping[str, Preset] = MappingProxyType(
    {
        preset.name: preset
        for preset in (
            Preset(
                name="Oscillator",
                system="oscillator",
                parameters=MappingProxyType({"omega2": 10.0}),
                task="regulate",
                costs=REGULATE,
                dt=0.01,
                max_action=20.0,
                max_episode_steps=500,
                start_position=(-1.0, 1.0),
                start_velocity=(-1.0, 1.0),
                seen=("position", "velocity"),
            ),
            # Gravity, length, time step, limit and the share of gravity that a motor has are those of Gymnasium's Pendulum-v1:
            # 3g/2l = 15 and 3u/ml² = 6.
            Preset(
                name="Pendulum",
                system="pendulum",
                parameters=MappingProxyType({"omega2": 15.0}),
                task="swing-up",
                costs=MappingProxyType({"velocity_cost": 0.1, "effort_cost": 0.001}),
                dt=0.05,
                max_action=6.0,
                max_episode_steps=200,
                start_position=(-pi, pi),
                start_velocity=(-1.0, 1.0),
                seen=("cos", "sin", "velocity"),
            ),
            Preset(
                name="Duffing",
                system="duffing",
                parameters=MappingProxyType({"alpha": -1.0, "beta": 1.0}),
                task="regulate",
                costs=REGULATE,
                dt=0.05,
                max_action=0.5,
                max_episode_steps=400,
                start_position=(-1.5, 1.5),
                start_velocity=(-0.5, 0.5),
                seen=("position", "velocity"),
            ),
        )
    }
)
