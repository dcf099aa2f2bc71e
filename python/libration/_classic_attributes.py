"""Attributes of Gymnasium's classic control that its twins have: their values, and the keywords that change them."""

from __future__ import annotations

from functools import cache
from math import inf, pi
from typing import Any, Callable, Mapping, NamedTuple

import numpy as np

from ._attributes import keywords_of
from ._classic_systems import CLASSIC, ClassicSystem, system_of
from ._settings import shown
from .environments import Environments

Value = Callable[[Mapping[str, Any]], Any]


class Attribute(NamedTuple):
    """An attribute of an environment of Gymnasium."""

    value: Value
    """Its value, from the keywords of the twin and the numbers of its episodes."""
    arguments: str = ""
    """Arguments that change it to ``{}``."""
    keyword: str = ""
    """The keyword whose default has it."""


def _of(keyword: str) -> Attribute:
    return Attribute(lambda given: given[keyword], f"{keyword}={{}}")


def _constant(value: Any, arguments: str = "", keyword: str = "") -> Attribute:
    return Attribute(lambda _: value, arguments, keyword)


def _array(numbers: tuple[float, ...]) -> Value:
    return lambda _: np.array(numbers, np.float32)


def _rule(given: Mapping[str, Any]) -> str:
    return {"explicit-euler": "euler", "symplectic-euler": "semi-implicit euler"}.get(given["integrator"], given["integrator"])


_SCREEN = {"screen_width": _constant(600), "screen_height": _constant(400)}
_THETA = CLASSIC["CartPole"].limits[2][1] / 2
_ANGLES = "'theta < -{0}', 'theta > {0}'"
_LOW, _HIGH = (_constant(ends, "project={{…}}", "project")._replace(value=_array(ends)) for ends in zip(*CLASSIC["MountainCar"].limits))
_CAR = {
    "min_position": _constant(-1.2, "project={{…}}", "project"),
    "max_position": _constant(0.6, "project={{…}}", "project"),
    "max_speed": _constant(0.07, "project={{…}}", "project"),
    **_SCREEN,
}
_REACHED = "terminated=[\"min(x - {}, x' - goal_velocity) >= 0\"]"

_ATTRIBUTES: Mapping[str, Mapping[str, Attribute]] = {
    "CartPole": {
        "total_mass": Attribute(lambda given: given["masspole"] + given["masscart"], "masscart=…, masspole=…"),
        "polemass_length": Attribute(lambda given: given["masspole"] * given["length"], "masspole=…, length=…"),
        "tau": _of("dt"),
        "kinematics_integrator": Attribute(_rule, "integrator='symplectic-euler'"),
        "x_threshold": _constant(2.4, f"terminated=['x < -{{0}}', 'x > {{0}}', {_ANGLES.format(_THETA)}]", "terminated"),
        "theta_threshold_radians": _constant(_THETA, f"terminated=['x < -2.4', 'x > 2.4', {_ANGLES}]", "terminated"),
        **_SCREEN,
    },
    "Pendulum": {
        "dt": _of("dt"),
        "max_torque": _of("max_action")._replace(arguments="max_action={}"),
        "max_speed": _constant(8, "project={{…}}", "project"),
        "screen_dim": _constant(500),
    },
    "MountainCar": {**_CAR, "low": _LOW, "high": _HIGH, "goal_position": _constant(0.5, _REACHED, "terminated")},
    "MountainCarContinuous": {
        **_CAR,
        "low_state": _LOW,
        "high_state": _HIGH,
        "goal_position": _constant(0.45, f"{_REACHED}, reward='…'", "terminated"),
        "max_action": Attribute(lambda given: _limit(given["max_action"]), "max_action={}"),
        "min_action": Attribute(lambda given: -_limit(given["max_action"]), "max_action={}"),
    },
    "Acrobot": {
        "dt": _of("dt"),
        "LINK_LENGTH_1": _of("l1"),
        "LINK_LENGTH_2": _constant(1.0),
        "LINK_MASS_1": _of("m1"),
        "LINK_MASS_2": _of("m2"),
        "LINK_COM_POS_1": _of("lc1"),
        "LINK_COM_POS_2": _of("lc2"),
        "LINK_MOI": _of("moi"),
        "MAX_VEL_1": _constant(4 * pi, "project={{…}}", "project"),
        "MAX_VEL_2": _constant(9 * pi, "project={{…}}", "project"),
        "AVAIL_TORQUE": _of("actions"),
        "torque_noise_max": _constant(0.0),
        "book_or_nips": _constant("book"),
        "actions_num": Attribute(lambda given: len(given["actions"]), "actions=[…]"),
        "SCREEN_DIM": _constant(500),
    },
}

_OF_RUNS = {"action_arrow", "clock", "domain_fig", "isopen", "last_u", "prev_done", "screen", "screens", "steps", "steps_beyond_terminated", "surf"}
"""Attributes of runs and pictures of Gymnasium's environments, which twins do not have."""
_DRAWN = ("length", "LINK_LENGTH_1")
"""Attributes that a picture shows and a keyword changes."""
_OF_STATES = {"state": "set_state(…) or reset(options={'state': …})", "low": "reset(options={'low': …})", "high": "reset(options={'high': …})"}


def _limit(most: Any) -> Any:
    return 1.0 if isinstance(most, float) and most == inf else most


@cache
def attributes_of(name: str, is_vector: bool) -> Mapping[str, Attribute]:
    """Return the attributes of Gymnasium's single or vector environment that its twin has."""
    own = {"max_episode_steps": _of("max_episode_steps")} if is_vector else {}
    return {**{key: _of(key) for key in CLASSIC[name].system["parameters"]}, **_ATTRIBUTES[name], **own}


class ClassicAttributes:
    """Attributes of Gymnasium's environment that a twin has: a caller can read them, and not set them."""

    _classic: ClassicSystem
    _is_vector = False
    _is_made = False
    """Whether the construction is over, which sets attributes."""

    def _table(self) -> Mapping[str, Attribute]:
        return attributes_of(self._classic.name, self._is_vector) if self._is_made else {}

    def _batch(self) -> Environments:
        raise NotImplementedError

    def __getattr__(self, name: str) -> Any:
        if name not in self._table():
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        return self._value(name, None if self._is_vector else 0)

    def _value(self, name: str, n: int | None) -> Any:
        """Return the value in use: where it varies that of the current episode of environment ``n``, or an array ``(num_envs,)``."""
        attribute, envs = self._table()[name], self._batch()
        given, own, keyword = keywords_of(envs), system_of(self._classic.name).summary["task"], attribute.keyword
        if keyword and given[keyword] != own[keyword]:
            raise AttributeError(f"{self._classic.name} has no {name!r}: {keyword} is {shown(given[keyword])}")
        drawn: Mapping[str, Any] = envs.parameters
        return attribute.value({**given, **(drawn if n is None else {key: float(values[n]) for key, values in drawn.items()})})

    def _lengths(self, n: int) -> Mapping[str, Any]:
        """Return the attributes that pictures of environment ``n`` show."""
        return {name: self._value(name, n) for name in _DRAWN if name in self._table()}

    def __setattr__(self, name: str, value: Any) -> None:
        if self._is_made and not name.startswith("_"):
            self._refuse(name, value)
        super().__setattr__(name, value)

    def _refuse(self, name: str, value: Any) -> None:
        """Raise an AttributeError for an attribute of Gymnasium's environment, which has no effect in its twin."""
        made = f"{self._classic.name}{'VectorEnv' if self._is_vector else 'Env'}"
        if name in self._table():
            arguments = self._table()[name].arguments.format(shown(value))
            help = f"make another environment: {made}({arguments})" if arguments else "this is a constant of the twin"
        elif name in _OF_STATES:
            help = _OF_STATES[name]
        elif name in _OF_RUNS:
            help = "twins have no such attribute"
        else:
            return
        raise AttributeError(f"{name} of {made} cannot be set to {shown(value)}; help: {help}")
