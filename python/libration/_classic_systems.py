"""Gymnasium's classic control as systems by equations, with its constants and its order of operations.

Sources: ``cartpole.py``, ``pendulum.py``, ``mountain_car.py``, ``continuous_mountain_car.py`` and ``acrobot.py`` of Gymnasium 1.2 to 1.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import inf, pi
from typing import Any, Mapping

from .equations import EquationSystem


@dataclass(frozen=True)
class ClassicSystem:
    """A twin of an environment of Gymnasium."""

    id: str
    """Its identifier there, without a namespace."""
    integrator: str
    dt: float
    max_episode_steps: int
    system: Mapping[str, Any]
    """Keywords of :class:`libration.System`."""
    start: tuple[float, float]
    """The ends from which Gymnasium draws."""
    drawn: tuple[str, ...]
    """States in the order in which Gymnasium draws them; all others start at zero."""
    order: tuple[str, ...]
    """States in the order that they have in Gymnasium."""
    limits: tuple[tuple[float, float], ...]
    """Smallest and largest value of each observed number."""
    dtype: str = "float64"
    """Float type in which Gymnasium computes the motion."""
    max_action: float = inf
    """Largest action in the action space."""
    charges_more: bool = False
    """Whether the reward is that of actions beyond the action space."""
    reward_threshold: float | None = None
    positive: frozenset[str] = frozenset()
    """Parameters that must be greater than 0."""
    rounds_start: bool = False
    """Whether Gymnasium rounds starts to ``float32``."""

    @property
    def name(self) -> str:
        """Name without a version."""
        return self.id.partition("-")[0]


def _within(text: str, low: str, high: str) -> str:
    return f"max({low}, min({high}, {text}))"


_THETA = 12 * 2 * pi / 360

_CARTPOLE = ClassicSystem(
    id="CartPole-v1",
    positive=frozenset({"masscart", "masspole", "length"}),
    reward_threshold=475.0,
    integrator="explicit-euler",
    dt=0.02,
    max_episode_steps=500,
    system={
        "acceleration": {
            "x": "temp - masspole*length*theta''*cos(theta)/(masspole + masscart)",
            "theta": "(gravity*sin(theta) - cos(theta)*temp)/(length*(4/3 - masspole*cos(theta)^2/(masspole + masscart)))",
        },
        "let": {"temp": "(force_mag*u + masspole*length*theta'^2*sin(theta))/(masspole + masscart)"},
        "parameters": {"gravity": 9.8, "masscart": 1.0, "masspole": 0.1, "length": 0.5, "force_mag": 10.0},
        "inputs": ["u"],
        "task": {
            "observe": ["x", "x'", "theta", "theta'"],
            "reward": "1",
            "terminated": ["x < -2.4", "x > 2.4", f"theta < -{_THETA!r}", f"theta > {_THETA!r}"],
            "actions": [-1.0, 1.0],
        },
    },
    start=(-0.05, 0.05),
    drawn=("x", "x'", "theta", "theta'"),
    order=("x", "x'", "theta", "theta'"),
    limits=((-4.8, 4.8), (-inf, inf), (-2 * _THETA, 2 * _THETA), (-inf, inf)),
)

_SPEED = _within("theta'", "-8", "8")

_PENDULUM = ClassicSystem(
    id="Pendulum-v1",
    positive=frozenset({"m", "l"}),
    integrator="symplectic-euler",
    dt=0.05,
    max_episode_steps=200,
    system={
        "acceleration": {"theta": "3*g/(2*l)*sin(theta) + 3/(m*l^2)*u"},
        "parameters": {"g": 10.0, "m": 1.0, "l": 1.0},
        "inputs": ["u"],
        "task": {
            "observe": ["cos(theta)", "sin(theta)", "theta'"],
            "reward": "-(atan2(sin(before(theta)), cos(before(theta)))^2 + 0.1*before(theta')^2 + 0.001*u^2)",
            "project": {"theta": f"before(theta) + {_SPEED}*dt", "theta'": _SPEED},
        },
    },
    start=(-1.0, 1.0),
    drawn=("theta", "theta'"),
    order=("theta", "theta'"),
    limits=((-1.0, 1.0), (-1.0, 1.0), (-8.0, 8.0)),
    max_action=2.0,
)

_CAR_SPEED = _within("x'", "-0.07", "0.07")
_CAR_POSITION = _within(f"before(x) + {_CAR_SPEED}*dt", "-1.2", "0.6")
_CAR: Mapping[str, Any] = {
    "observe": ["x", "x'"],
    "project": {"x": _CAR_POSITION, "x'": f"if({_CAR_POSITION} <= -1.2, max(0, {_CAR_SPEED}), {_CAR_SPEED})"},
}
_CAR_LIMITS = ((-1.2, 0.6), (-0.07, 0.07))

_MOUNTAIN_CAR = ClassicSystem(
    id="MountainCar-v0",
    reward_threshold=-110.0,
    integrator="symplectic-euler",
    dt=1.0,
    max_episode_steps=200,
    system={
        "acceleration": {"x": "u*force + cos(3*x)*(-gravity)"},
        "parameters": {"force": 0.001, "gravity": 0.0025, "goal_velocity": 0.0},
        "inputs": ["u"],
        "task": {
            **_CAR,
            "reward": "-1",
            "terminated": ["min(x - 0.5, x' - goal_velocity) >= 0"],
            "actions": [-1.0, 0.0, 1.0],
        },
    },
    start=(-0.6, -0.4),
    drawn=("x",),
    order=("x", "x'"),
    limits=_CAR_LIMITS,
)

_REACHED = "min(x - 0.45, x' - goal_velocity) >= 0"

_MOUNTAIN_CAR_CONTINUOUS = ClassicSystem(
    id="MountainCarContinuous-v0",
    integrator="symplectic-euler",
    dt=1.0,
    max_episode_steps=999,
    system={
        "acceleration": {"x": "max(-1, min(1, u))*power - 0.0025*cos(3*x)"},
        "parameters": {"power": 0.0015, "goal_velocity": 0.0},
        "inputs": ["u"],
        "task": {**_CAR, "reward": f"if({_REACHED}, 100, 0) - u^2*0.1", "terminated": [_REACHED]},
    },
    start=(-0.6, -0.4),
    drawn=("x",),
    order=("x", "x'"),
    limits=_CAR_LIMITS,
    dtype="float32",
    max_action=1.0,
    charges_more=True,
    reward_threshold=90.0,
)


def _wrapped(name: str) -> str:
    return f"if({name} > pi, {name} - 2*pi, if({name} < -pi, {name} + 2*pi, {name}))"


_ABOVE = "-cos(theta1) - cos(theta2 + theta1) > 1"

_ACROBOT = ClassicSystem(
    id="Acrobot-v1",
    positive=frozenset({"m1", "m2", "l1", "lc1", "lc2", "moi"}),
    reward_threshold=-100.0,
    integrator="rk4",
    dt=0.2,
    max_episode_steps=500,
    system={
        "acceleration": {
            "theta1": "-(d2*theta2'' + phi1)/d1",
            "theta2": "(u + d2/d1*phi1 - m2*l1*lc2*theta1'^2*sin(theta2) - phi2)/(m2*lc2^2 + moi - d2^2/d1)",
        },
        "let": {
            "d1": "m1*lc1^2 + m2*(l1^2 + lc2^2 + 2*l1*lc2*cos(theta2)) + moi + moi",
            "d2": "m2*(lc2^2 + l1*lc2*cos(theta2)) + moi",
            "phi1": "-m2*l1*lc2*theta2'^2*sin(theta2) - 2*m2*l1*lc2*theta2'*theta1'*sin(theta2)"
            " + (m1*lc1 + m2*l1)*9.8*cos(theta1 - pi/2) + phi2",
            "phi2": "m2*lc2*9.8*cos(theta1 + theta2 - pi/2)",
        },
        "parameters": {"m1": 1.0, "m2": 1.0, "l1": 1.0, "lc1": 0.5, "lc2": 0.5, "moi": 1.0},
        "inputs": ["u"],
        "task": {
            "observe": ["cos(theta1)", "sin(theta1)", "cos(theta2)", "sin(theta2)", "theta1'", "theta2'"],
            "reward": f"if({_ABOVE}, 0, -1)",
            "terminated": [_ABOVE],
            "project": {
                "theta1": _wrapped("theta1"),
                "theta2": _wrapped("theta2"),
                "theta1'": _within("theta1'", "-4*pi", "4*pi"),
                "theta2'": _within("theta2'", "-9*pi", "9*pi"),
            },
            "actions": [-1.0, 0.0, 1.0],
        },
    },
    start=(-0.1, 0.1),
    drawn=("theta1", "theta2", "theta1'", "theta2'"),
    order=("theta1", "theta2", "theta1'", "theta2'"),
    limits=(*[(-1.0, 1.0)] * 4, (-4 * pi, 4 * pi), (-9 * pi, 9 * pi)),
    rounds_start=True,
)

CLASSIC: Mapping[str, ClassicSystem] = {
    each.name: each for each in (_CARTPOLE, _PENDULUM, _MOUNTAIN_CAR, _MOUNTAIN_CAR_CONTINUOUS, _ACROBOT)
}


@cache
def system_of(name: str) -> EquationSystem:
    """Return the system of a twin, with its task and its range of starts."""
    classic = CLASSIC[name]
    low, high = classic.start
    start: dict[str, tuple[float, float]] = {state: (low, high) for state in classic.drawn}
    if name == "Pendulum":
        start["theta"] = (-pi, pi)
    task = {**classic.system["task"], "start": start}
    return EquationSystem(**{**classic.system, "task": task}, name=classic.id)
