"""Attributes of Gymnasium's classic control that its twins have: their values, and the keywords that change them."""

from __future__ import annotations

import itertools
import re
from functools import cache
from math import inf, pi
from types import MappingProxyType
from typing import Any, Callable, Mapping, NamedTuple

import numpy as np
from gymnasium.spaces import Space
from numpy.typing import NDArray

from ._attributes import copied, keywords_of
from ._classic_systems import CLASSIC, ClassicSystem
from ._environment_keywords import BatchKeywords, ClassicKeywords
from ._gymnasium_envs import checked_render_mode
from ._settings import shown
from .environments import Environments

Value = Callable[[Mapping[str, Any]], Any]
Advice = Callable[[Any], str]


class OtherTask(Exception):
    """A keyword replaces what an attribute describes; the argument is the keyword."""


class Attribute(NamedTuple):
    """An attribute of an environment of Gymnasium."""

    value: Value
    """Its value, from the keywords of the twin and the numbers of its episodes."""
    advice: Advice = lambda value: ""
    """Arguments that change it to a value."""


def _text(value: Any) -> str:
    return shown(value.item() if isinstance(value, np.generic) else value)


def _arguments(arguments: str) -> Advice:
    return lambda value: arguments.format(_text(value))


def _of(keyword: str) -> Attribute:
    return Attribute(lambda given: given[keyword], _arguments(f"{keyword}={{}}"))


def _constant(value: Any) -> Attribute:
    return Attribute(lambda _: value)


def _stop(system: str, value: Any) -> Attribute:
    """Return an attribute that the default of ``project`` has."""
    project = CLASSIC[system].system["task"]["project"]

    def stop(given: Mapping[str, Any]) -> Any:
        if given["project"] != project:
            raise OtherTask("project")
        return value

    return Attribute(stop, _arguments("project={{…}}"))


def _end(pattern: str, group: int, arguments: str) -> Attribute:
    """Return an attribute that is a number in ``terminated``; ``N`` in the pattern is a number."""
    expression = re.compile(pattern.replace("N", r"([-+.\deE]+)"))

    def end(given: Mapping[str, Any]) -> float:
        found = expression.fullmatch("; ".join(map(str, given["terminated"])))
        if found is None:
            raise OtherTask("terminated")
        return float(found[group])

    return Attribute(end, _arguments(arguments))


def _limit(given: Mapping[str, Any]) -> Any:
    most = given["max_action"]
    if isinstance(most, (list, tuple)):
        if len(most) != 1:
            raise OtherTask("max_action")
        most = most[0]
    # An array has a number for each environment.
    return most if isinstance(most, np.ndarray) else float(most)


def _car_limit(given: Mapping[str, Any]) -> Any:
    most = _limit(given)
    # The car takes at most 1, whatever a policy may command.
    return np.minimum(most, 1.0) if isinstance(most, np.ndarray) else min(most, 1.0)


def _limit_advice(sign: int, most: float = inf) -> Advice:
    def advice(value: Any) -> str:
        is_number = isinstance(value, (int, float, np.number))
        return f"max_action={_text(sign * value)}" if is_number and 0 < sign * value <= most else "max_action=…"

    return advice


def _array(ends: tuple[float, ...]) -> NDArray[np.float32]:
    return np.array(ends, np.float32)


def _rule(given: Mapping[str, Any]) -> str:
    return {"explicit-euler": "euler", "symplectic-euler": "semi-implicit euler"}.get(given["integrator"], given["integrator"])


_SCREEN = {"screen_width": _constant(600), "screen_height": _constant(400)}
_THETA = CLASSIC["CartPole"].limits[2][1] / 2
_FALLEN = r"x < -N; x > \1; theta < -N; theta > \2"
_ANGLES = "'theta < -{0}', 'theta > {0}'"
_LOW, _HIGH = (_stop("MountainCar", _array(ends)) for ends in zip(*CLASSIC["MountainCar"].limits))
_CAR = {
    "min_position": _stop("MountainCar", -1.2),
    "max_position": _stop("MountainCar", 0.6),
    "max_speed": _stop("MountainCar", 0.07),
    **_SCREEN,
}
_REACHED = "min(x - {0}, x' - goal_velocity) >= 0"
_AT_GOAL = r"min\(x - N, x' - goal_velocity\) >= 0"

_ATTRIBUTES: Mapping[str, Mapping[str, Attribute]] = {
    "CartPole": {
        "total_mass": Attribute(lambda given: given["masspole"] + given["masscart"], _arguments("masscart=…, masspole=…")),
        "polemass_length": Attribute(lambda given: given["masspole"] * given["length"], _arguments("masspole=…, length=…")),
        "tau": _of("dt"),
        "kinematics_integrator": Attribute(_rule, lambda value: f"integrator={'explicit-euler' if value == 'euler' else 'symplectic-euler'!r}"),
        "x_threshold": _end(_FALLEN, 1, f"terminated=['x < -{{0}}', 'x > {{0}}', {_ANGLES.format(_THETA)}]"),
        "theta_threshold_radians": _end(_FALLEN, 2, f"terminated=['x < -2.4', 'x > 2.4', {_ANGLES}]"),
        **_SCREEN,
    },
    "Pendulum": {
        "dt": _of("dt"),
        "max_torque": Attribute(_limit, _limit_advice(1)),
        "max_speed": _stop("Pendulum", 8),
        "screen_dim": _constant(500),
    },
    "MountainCar": {**_CAR, "low": _LOW, "high": _HIGH, "goal_position": _end(_AT_GOAL, 1, f'terminated=["{_REACHED}"]')},
    "MountainCarContinuous": {
        **_CAR,
        "low_state": _LOW,
        "high_state": _HIGH,
        "goal_position": _end(_AT_GOAL, 1, f'terminated=["{_REACHED}"], reward="if({_REACHED}, 100, 0) - u^2*0.1"'),
        "max_action": Attribute(_car_limit, _limit_advice(1, 1.0)),
        "min_action": Attribute(lambda given: -_car_limit(given), _limit_advice(-1, 1.0)),
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
        "MAX_VEL_1": _stop("Acrobot", 4 * pi),
        "MAX_VEL_2": _stop("Acrobot", 9 * pi),
        "AVAIL_TORQUE": Attribute(lambda given: [float(level) for level in given["actions"]], _arguments("actions={}")),
        "torque_noise_max": _constant(0.0),
        "book_or_nips": _constant("book"),
        "actions_num": Attribute(lambda given: len(given["actions"]), _arguments("actions=[…]")),
        "SCREEN_DIM": _constant(500),
    },
}

_DRAWN = ("length", "LINK_LENGTH_1")
"""Attributes that a picture shows and a keyword changes."""
_OF_STATES = {"state": "set_state(…) or reset(options={'state': …})"}
_OF_STARTS = {"low": "reset(options={'low': …})", "high": "reset(options={'high': …})"}
"""Attributes of Gymnasium's only vector environment of its own, that of CartPole."""
_SPACES = ("action_space", "observation_space", "single_action_space", "single_observation_space")
_SINGLE = frozenset(ClassicKeywords.__optional_keys__)
_VECTOR = _SINGLE | BatchKeywords.__optional_keys__ | {"num_envs"}


@cache
def attributes_of(name: str, is_vector: bool) -> Mapping[str, Attribute]:
    """Return the attributes of Gymnasium's single or vector environment that its twin has."""
    own = {"max_episode_steps": _of("max_episode_steps")} if is_vector else {}
    return MappingProxyType({**{key: _of(key) for key in CLASSIC[name].system["parameters"]}, **_ATTRIBUTES[name], **own})


class ClassicAttributes:
    """Attributes of Gymnasium's environment that a twin has: a caller can read them, and not set them.

    A value is the one in use. Where it varies, it is that of the current episode, of a vector environment an array ``(num_envs,)``. It stays
    readable after ``close``. Changes to lists and arrays that a caller reads have no effect.
    """

    _classic: ClassicSystem
    _is_vector = False
    _is_made = False
    """Whether the construction is over, which sets attributes."""
    _given_keywords: Mapping[str, Any] = MappingProxyType({})
    """Keywords, with their defaults."""
    _constants: Mapping[str, Any] = MappingProxyType({})
    """Values that do not vary, by the name of the attribute."""
    _varying: frozenset[str] = frozenset()
    """Names of attributes that vary."""
    _absent: Mapping[str, str] = MappingProxyType({})
    """Names of attributes that another task does not have, and its keyword."""
    _last_drawn: Mapping[str, NDArray[Any]] | None = None
    """Numbers of the episodes at ``close``."""

    def _table(self) -> Mapping[str, Attribute]:
        return attributes_of(self._classic.name, self._is_vector) if self._is_made else {}

    def _batch(self) -> Environments:
        raise NotImplementedError

    def _finish(self) -> None:
        """End the construction: attributes of Gymnasium's environment have values from now on."""
        envs = self._batch()
        given, constants, varying, absent = keywords_of(envs), {}, set(), {}
        if not self._is_vector:
            # ``gymnasium.make`` adds the time limit.
            del given["max_episode_steps"]
        if isinstance(given["max_action"], np.ndarray):
            given["max_action"] = given["max_action"].tolist()
        drawn = envs.parameters
        fixed = {name: value for name, value in given.items() if name not in drawn}
        if any(name.startswith("max_action_") for name in drawn):
            fixed["max_action"] = []
        for name, attribute in attributes_of(self._classic.name, self._is_vector).items():
            try:
                constants[name] = attribute.value(fixed)
            except KeyError:
                varying.add(name)
            except OtherTask as other:
                absent[name] = other.args[0]
        self._given_keywords, self._constants, self._varying, self._absent = given, constants, frozenset(varying), absent
        self._is_made = True
        self._refuse_hidden()

    def _refuse_hidden(self) -> None:
        """Raise an error for an attribute of a subclass, or one that was set before the construction, that hides one of Gymnasium's."""
        classes = itertools.takewhile(lambda cls: not cls.__module__.startswith("libration."), type(self).__mro__)
        for place in [vars(self), *(vars(cls) for cls in classes)]:
            for name in place.keys() & self._table().keys():
                if not isinstance(place[name], property):
                    self._refuse(name, place[name])

    def _keep_numbers(self) -> None:
        """Keep the numbers of the episodes before the engine releases them."""
        if self._is_made and self._last_drawn is None:
            self._last_drawn = self._batch().parameters

    def _numbers(self) -> Mapping[str, NDArray[Any]]:
        return self._batch().parameters if self._last_drawn is None else self._last_drawn

    def _is_known(self, name: str) -> bool:
        """Whether a name is that of an attribute of Gymnasium's environment or of a keyword."""
        return name in self._table() or name in self._given_keywords

    def _in_use(self, name: str) -> tuple[Any, bool]:
        """Return the value in use of an attribute or a keyword, and whether it is an array with a number for each environment."""
        if name in self._constants:
            return copied(self._constants[name]), False
        if name in self._absent:
            keyword = self._absent[name]
            raise AttributeError(f"{self._classic.name} has no {name!r}: {keyword} is {shown(self._given_keywords[keyword])}")
        if name not in self._varying and name not in self._given_keywords:
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        drawn = self._numbers()
        if name in self._varying:
            return self._table()[name].value({**self._given_keywords, **drawn}), True
        return (drawn[name], True) if name in drawn else (copied(self._given_keywords[name]), False)

    def __getattr__(self, name: str) -> Any:
        if name not in self._table():
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        value, is_each = self._in_use(name)
        return float(value[0]) if is_each and not self._is_vector else value

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._constants, *self._varying})

    def _lengths(self) -> list[dict[str, Any]]:
        """Return the attributes that the picture of each environment shows."""
        num_envs, table = self._batch().num_envs, {}
        for name in _DRAWN:
            if name in self._table():
                value, is_each = self._in_use(name)
                table[name] = value.tolist() if is_each else [value] * num_envs
        return [{name: values[n] for name, values in table.items()} for n in range(num_envs)]

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and self._is_made:
            own = getattr(type(self), name, None)
            if not (isinstance(own, property) and own.fset is not None):
                self._refuse(name, value)
            if name == "render_mode":
                value = checked_render_mode(value)
        super().__setattr__(name, value)

    def _refuse(self, name: str, value: Any) -> None:
        """Raise an error for an attribute that has a meaning in Gymnasium or is a keyword, and no effect in the twin."""
        made = f"{self._classic.name}{'VectorEnv' if self._is_vector else 'Env'}"
        if name in _SPACES:
            if not isinstance(value, Space):
                raise TypeError(f"{name} must be a space of Gymnasium, not {type(value).__name__}")
            return
        if name in self._table():
            arguments = self._table()[name].advice(value)
            help = f"make another environment: {made}({arguments})" if arguments else "this is a constant of the twin"
        elif name in _OF_STATES:
            help = _OF_STATES[name]
        elif name in _OF_STARTS and self._is_vector and self._classic.name == "CartPole":
            help = _OF_STARTS[name]
        elif name != "render_mode" and name in (_VECTOR if self._is_vector else _SINGLE):
            help = f"make another environment: {made}({name}={_text(value)})"
        else:
            return
        raise AttributeError(f"{name} of {made} cannot be set to {shown(value)}; help: {help}")
