"""Base classes of the twins of Gymnasium's classic control."""

from __future__ import annotations

import copy
import math
from typing import Any, Mapping, Sequence

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Discrete
from gymnasium.utils.seeding import np_random
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ._attributes import copied
from ._classic_attributes import ClassicAttributes
from ._classic_starts import drawn_start, start_bounds, start_ranges
from ._classic_systems import CLASSIC, ClassicSystem, system_of
from ._environment_keywords import BatchKeywords, ClassicKeywords
from ._episode_numbers import episode_number
from ._episode_states import options_of
from ._gymnasium_envs import Env, RoundedBatch, VectorEnv, checked_render_mode
from ._settings import OPTIONS, ends, nearest
from ._spec_keywords import keyword_value
from .environments import Environments
from .perturbations import Gaussian

STARTS = ("libration", "gymnasium")
_RESTORED = {"_arguments", "_given", "_picture", "_seeder", "_settings", "preset"}
"""Attributes of vector environments that a copy has from its construction."""


def _with_defaults(classic: ClassicSystem, num_envs: Any, starts: Any, given: dict[str, Any]) -> dict[str, Any]:
    """Return keywords of the engine with the twin's constants where nothing else is given."""
    parameters = classic.system["parameters"]
    for key in given:
        if key not in OPTIONS and key not in parameters:
            known = {*BatchKeywords.__optional_keys__, *ClassicKeywords.__optional_keys__, *parameters}
            raise TypeError(f"unexpected keyword argument {key!r}: {nearest(key, known)}")
    for key in classic.positive & given.keys():
        value = keyword_value(given[key])
        # A normal distribution has no end; that it draws such numbers is the caller's choice.
        if not isinstance(value, Gaussian):
            episode_number(key, value, num_envs, "greater than 0", lambda x: 0 < x < math.inf)
    if starts not in STARTS:
        raise ValueError(f"starts is {starts!r}: {nearest(str(starts), STARTS)}")
    if starts == "gymnasium" and given.get("start") is not None:
        raise TypeError("start is given, but starts='gymnasium' has the starts of Gymnasium")
    most = math.inf if classic.charges_more else classic.max_action
    return {"integrator": classic.integrator, "dt": classic.dt, "max_action": most, "dtype": classic.dtype, **given}


def _classic(name: str) -> ClassicSystem:
    if name not in CLASSIC:
        raise ValueError(f"unknown environment {name!r}: {nearest(str(name), CLASSIC)}")
    return CLASSIC[name]


def _seen(classic: ClassicSystem, settings: Any, given: dict[str, Any], own: Any) -> Box:
    """Return the observation space: that of Gymnasium, unless keywords change what is observed or how far it goes."""
    is_changed = any(given.get(name) is not None for name in ("observe", "project", "terminated"))
    if is_changed or _starts_outside(classic, keyword_value(given.get("start"))):
        return Box(np.float32(own.low), np.float32(own.high), dtype=np.float32)
    low, high = (np.array(ends, np.float32) for ends in zip(*classic.limits))
    if any(std > 0 for _, std in settings["subject"]["noise"]):
        low, high = np.full_like(low, -np.inf), np.full_like(high, np.inf)
    return Box(low, high, dtype=np.float32)


def _starts_outside(classic: ClassicSystem, start: Mapping[str, Any] | None) -> bool:
    """Whether an episode can start where Gymnasium's observation space ends."""
    limits = dict(zip(classic.system["task"]["observe"], classic.limits))
    ranges = {name: (ends(f"start of {name}", value), limits[name]) for name, value in (start or {}).items() if name in limits}
    return any(low < least or high > most for (low, high), (least, most) in ranges.values())


def _action_space(classic: ClassicSystem, given: dict[str, Any], space: Any) -> Any:
    if isinstance(space, Discrete):
        return space
    if classic.charges_more and given.get("max_action") is None:
        return Box(-classic.max_action, classic.max_action, space.shape, np.float32)
    return Box(np.float32(space.low), np.float32(space.high), dtype=np.float32)


class _Picture:
    """Pictures of Gymnasium's environment."""

    def __init__(self, classic: ClassicSystem) -> None:
        self._places = [system_of(classic.name).states.index(name) for name in classic.order]
        self._env: Any = gymnasium.make(classic.id, render_mode="rgb_array").unwrapped
        self._env.reset(seed=0)

    def __call__(self, state: NDArray[Any], lengths: Mapping[str, Any], action: Any = None) -> NDArray[np.uint8]:
        for name, length in lengths.items():
            setattr(self._env, name, length)
        self._env.state = state[self._places].astype(np.float64)
        # The arrow of the torque.
        self._env.last_u = action
        return self._env.render()

    def close(self) -> None:
        self._env.close()


class ClassicVectorEnv(ClassicAttributes, VectorEnv):
    """Vector environment of a twin of Gymnasium's classic control.

    Parameters
    ----------
    name:
        Name of the twin without its version.
    num_envs:
        Number of environments.
    starts:
        ``"libration"``: starts depend on seed, environment and episode only. ``"gymnasium"``: those of Gymnasium's ``SyncVectorEnv`` with the
        same seeds, which NumPy draws; a step at which episodes begin is slower.
    **given:
        Keywords of :class:`libration.Environments`, such as ``action_delay``, ``jitter`` and ``skew``, and parameters of the system.
    """

    _is_vector = True
    _rounds = True

    def __init__(self, name: str, /, num_envs: int = 1, *, starts: str = "libration", render_mode: str | None = None, **given: Any) -> None:
        self._classic, self._starts = _classic(name), starts
        given.setdefault("max_episode_steps", self._classic.max_episode_steps)
        super().__init__(system_of(name), num_envs, **_with_defaults(self._classic, num_envs, starts, given))
        self._given = copied({"num_envs": num_envs, "starts": starts, "render_mode": render_mode, **given})
        self.render_mode = checked_render_mode(render_mode)
        self._picture: _Picture | None = None
        self.metadata = {**self.metadata, "render_modes": ["rgb_array"], "render_fps": _frames(self._classic, self._settings)}
        self.single_observation_space = _seen(self._classic, self._settings, given, self.single_observation_space)
        self.single_action_space = _action_space(self._classic, given, self.single_action_space)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._generators: list[np.random.Generator | None] = [None] * self.num_envs
        self._ended = np.zeros(self.num_envs, bool)
        self._finish()

    def _batch(self) -> VectorEnv:
        return self

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return the value in use of an attribute or a keyword of each environment.

        Where it varies, it is that of the current episode: under ``length=Uniform(0.3, 0.7)`` ``get_attr("length")`` has numbers, those of
        :attr:`parameters`.

        Raises
        ------
        AttributeError
            For an unknown attribute; the message has the nearest name.
        """
        if name in vars(self) or not self._is_known(name):
            return super().get_attr(name)
        value, is_each = self._in_use(name)
        return tuple(value.tolist()) if is_each else tuple(copied(value) for _ in range(self.num_envs))

    def set_attr(self, name: str, values: Any) -> None:
        if name not in self._given_keywords:
            self._refuse(name, values)
        super().set_attr(name, values)

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        options = options_of(options)
        if self._starts == "libration":
            return super().reset(seed=seed, options=start_ranges(self._classic, options, self._settings["dtype"]))
        bounds = start_bounds(self._classic, options, self._settings["dtype"])
        if "low" in options or "high" in options:
            raise ValueError("options has ends of ranges, but those of Gymnasium's Pendulum are 'x_init' and 'y_init'")
        # The first reset begins all environments, also those outside the mask.
        first = self._seeder is None
        observations, infos = super().reset(seed=seed, options=options)
        everyone = np.ones(self.num_envs, bool)
        mask = options.get("reset_mask", everyone)
        for n, one in enumerate(self._seeds(seed)):
            if mask[n] and one is not None:
                self._generators[n] = np_random(one)[0]
            elif self._generators[n] is None:
                self._generators[n] = np_random(None)[0]
        self._ended[everyone if first else mask] = False
        if "state" not in options:
            observations = self._start(mask, bounds)
        if first and not mask.all():
            observations = self._start(~mask, {})
        return observations, infos

    def _start(self, mask: NDArray[np.bool_], bounds: dict[str, Any]) -> np.ndarray:
        """Put environments at starts of Gymnasium."""
        states = np.zeros((self.num_envs, len(system_of(self._classic.name).states)))
        for n in np.flatnonzero(mask):
            generator = self._generators[n]
            assert generator is not None, "every environment was reset"
            states[n] = drawn_start(self._classic, generator, bounds)
        return super().set_state(states, mask)

    def rollout(self, policy: Any, horizon: int, **given: Any) -> Any:
        if self._starts == "gymnasium":
            raise ValueError("starts is 'gymnasium', but rollout requires starts='libration': NumPy draws the starts of Gymnasium between steps")
        return super().rollout(policy, horizon, **given)

    def step(self, actions: Any) -> Any:
        results = super().step(actions)
        if self._starts == "libration":
            return results
        observations, rewards, terminated, truncated, infos = results
        ended = terminated | truncated
        begun = {"NextStep": self._ended, "SameStep": ended}.get(self._settings["autoreset"])
        if begun is not None and begun.any():
            # In the array that this step returns.
            np.copyto(observations, self._start(begun, {}))
        self._ended = ended
        return observations, rewards, terminated, truncated, infos

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Return one picture of Gymnasium's per environment, if ``render_mode`` is ``"rgb_array"``; it requires Pygame."""
        if self.render_mode is None:
            return super().render()
        if self._picture is None:
            self._picture = _Picture(self._classic)
        return tuple(self._picture(*one) for one in zip(self.states, self._lengths()))

    def close_extras(self, **kwargs: Any) -> None:
        self._keep_numbers()
        if (picture := self.__dict__.get("_picture")) is not None:
            picture.close()
        super().close_extras(**kwargs)

    def _extras(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in _RESTORED}

    def __reduce__(self) -> Any:
        function, (cls, _, state, seeder, extras) = super().__reduce__()
        # As a state, after the arguments: an attribute may refer to the environment.
        return function, (cls, (self._classic.name, self._given), state, seeder, {}), extras

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        function, arguments, extras = self.__reduce__()
        other = memo[id(self)] = function(*copy.deepcopy(arguments, memo))
        vars(other).update(copy.deepcopy(extras, memo))
        return other

    @classmethod
    def _construct(cls, name: Any, given: dict[str, Any]) -> Any:
        # A subclass may have a signature of its own.
        envs = cls.__new__(cls)
        ClassicVectorEnv.__init__(envs, name, **given)
        return envs


class ClassicEnv(ClassicAttributes, Env):
    """Single environment of a twin of Gymnasium's classic control; see :class:`ClassicVectorEnv`."""

    _batch_class = RoundedBatch
    _last_state: NDArray[Any] | None = None

    def __init__(self, name: str, /, *, starts: str = "libration", render_mode: str | None = None, **given: Any) -> None:
        self._classic, self._starts = _classic(name), starts
        super().__init__(system_of(name), **_with_defaults(self._classic, 1, starts, given))
        self.render_mode = checked_render_mode(render_mode)
        self._picture: _Picture | None = None
        self.metadata = {"render_modes": ["rgb_array"], "render_fps": _frames(self._classic, self._all._settings)}
        self.observation_space = _seen(self._classic, self._all._settings, given, self.observation_space)
        self.action_space = _action_space(self._classic, given, self.action_space)
        self._finish()

    def _batch(self) -> Environments:
        return self._all

    def get_wrapper_attr(self, name: str) -> Any:
        """Return an attribute or a keyword; where it varies, the number of the current episode."""
        if name in vars(self) or not self._is_known(name):
            return super().get_wrapper_attr(name)
        value, is_each = self._in_use(name)
        return float(value[0]) if is_each else value

    def __getstate__(self) -> dict[str, Any]:
        # Surfaces of Pygame cannot be copied.
        return {**self.__dict__, "_picture": None}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        if options is None and self._starts == "libration":
            return super().reset(seed=seed)
        options = options_of(options)
        if self._starts == "libration":
            return super().reset(seed=seed, options=start_ranges(self._classic, options, self._all._settings["dtype"]))
        bounds = start_bounds(self._classic, options, self._all._settings["dtype"])
        if "low" in options or "high" in options:
            raise ValueError("options has ends of ranges, but those of Gymnasium's Pendulum are 'x_init' and 'y_init'")
        observation, info = super().reset(seed=seed, options=options)
        if "state" in options:
            return observation, info
        return self.set_state(drawn_start(self._classic, self.np_random, bounds)), info

    def render(self) -> np.ndarray | None:
        if self.render_mode is None:
            return super().render()
        if self._picture is None:
            self._picture = _Picture(self._classic)
        torque = None
        if self._action is not None and not isinstance(self.action_space, Discrete):
            torque = float(np.clip(self._action.flat[0], -self._classic.max_action, self._classic.max_action))
        return self._picture(self.state, self._lengths()[0], torque)

    @property
    def state(self) -> np.ndarray:
        """States of the system, without noise and latency; after ``close`` the last ones."""
        return super().state if self._last_state is None else self._last_state.copy()

    def close(self) -> None:
        self._keep_numbers()
        if self._is_made and self._last_state is None:
            self._last_state = self.state
        if (picture := self.__dict__.get("_picture")) is not None:
            picture.close()
        super().close()


_FPS: Mapping[str, int] = {"CartPole": 50, "Pendulum": 30, "MountainCar": 30, "MountainCarContinuous": 30, "Acrobot": 15}
"""Frames per second of Gymnasium's environments."""


def _frames(classic: ClassicSystem, settings: Mapping[str, Any]) -> int:
    """Return the frames per second of pictures: those of Gymnasium, in proportion where a step takes another time."""
    return max(1, round(_FPS[classic.name] * classic.dt / (settings["dt"] * settings["substeps"])))
