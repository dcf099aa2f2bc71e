"""Base classes of Gymnasium environments of the engine."""

from __future__ import annotations

import copy
from typing import Any, overload

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from ._arrays import numbers_of
from ._attributes import SETTABLE, keywords_of, refused, unknown
from ._environment_keywords import Unpack, VectorKeywords
from ._episode_states import options_of
from ._presets import Preset
from ._settings import check_within_episode, ends
from ._spaces import single_spaces
from ._spec_keywords import JSON_SPEC
from .environments import Environments
from .equations import EquationSystem
from .linear import LinearPlant
from .systems import System, with_commands

_ATTRIBUTES = ("action_space", "metadata", "observation_space", "render_mode", "spec", "state")
"""Attributes of each environment besides its keywords."""
METADATA: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 30}


def _metadata(settings: Any) -> dict[str, Any]:
    """Return what is known of an environment, with pictures in real time."""
    # A system that waits for its answers takes their time as well.
    step = settings["dt"] * settings["substeps"] + settings.get("mean_wait", 0.0)
    return {"render_modes": [*METADATA["render_modes"]], "render_fps": max(1, round(1.0 / step))}


def checked_render_mode(render_mode: str | None) -> str | None:
    if render_mode not in (None, "rgb_array"):
        raise ValueError(f"render_mode is {render_mode!r}, but it must be 'rgb_array' or None")
    return render_mode


def _pictures(envs: Environments) -> tuple[np.ndarray, ...]:
    """Return a picture of each environment: of a preset its bodies, of another system its states."""
    from ._render import picture, state_picture

    if envs._seeder is None:
        raise ResetNeeded("render was called before reset; expected reset first")
    preset, states = envs.preset, envs.states.astype(float)
    if isinstance(preset, Preset):
        return tuple(picture(preset, *state) for state in states)
    return tuple(state_picture(envs._state_names(), state) for state in states)


class VectorEnv(Environments, gymnasium.vector.VectorEnv):
    """Gymnasium vector environment of the engine.

    See :class:`libration.Environments` for all keywords; ``render_mode`` may be ``"rgb_array"``.

    ``step`` returns rewards of the ``dtype`` of the environments, ``(num_envs,)``: the numbers of the engine without a conversion or a
    copy. Gymnasium's ``SyncVectorEnv`` returns the same numbers as ``float64``. ``terminated`` and ``truncated`` are ``bool``,
    ``(num_envs,)``, as there.
    """

    metadata = METADATA
    spec = JSON_SPEC
    _takes_name = True
    """Whether the class takes the name of a system or a system first."""
    _reset_needed = ResetNeeded
    _closed_error = ClosedEnvironmentError

    @overload
    def __init__(self, name: str, num_envs: int = 1, *, render_mode: str | None = None, **given: Unpack[VectorKeywords]) -> None: ...

    # A system by equations has parameters of any name.
    @overload
    def __init__(self, name: EquationSystem | System | LinearPlant, num_envs: int = 1, *, render_mode: str | None = None, **given: Any) -> None: ...

    def __init__(
        self,
        name: str | EquationSystem | System | LinearPlant,
        num_envs: int = 1,
        *,
        render_mode: str | None = None,
        **given: Any,
    ) -> None:
        subject: str | EquationSystem = with_commands(name)
        self.render_mode = checked_render_mode(render_mode)
        super().__init__(subject, num_envs, **given)
        self.metadata = {
            **_metadata(self._settings),
            "autoreset_mode": AutoresetMode(self._settings["autoreset"]),
        }
        spaces = single_spaces(self.preset, self._settings)
        self.single_observation_space, self.single_action_space = spaces
        self.observation_space, self.action_space = (batch_space(s, self.num_envs) for s in spaces)

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[np.ndarray, dict[str, Any]]:
        # A refused reset changes nothing.
        results = self._begin(self._seeds(seed), options)
        if isinstance(seed, (int, np.integer)):
            gymnasium.vector.VectorEnv.reset(self, seed=int(seed))
        elif seed is not None:
            # Gymnasium's word for a seed that no number tells.
            self._np_random_seed = -1
        return results

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Return one picture per environment, ``(300, 300, 3)`` of ``uint8``, if ``render_mode`` is ``"rgb_array"``."""
        if self.render_mode is None:
            gymnasium.logger.warn("render was called, but render_mode is None: nothing is drawn")
            return None
        return _pictures(self)

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Return the result of ``render``, or the value of an attribute, of each environment, as ``SyncVectorEnv`` does.

        Raises
        ------
        AttributeError
            For a name that single environments do not have.
        """
        if name == "render":
            pictures = self.render(*args, **kwargs)
            return (None,) * self.num_envs if pictures is None else pictures
        return self.get_attr(name)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return the value of an attribute of each environment, as ``SyncVectorEnv`` does.

        Attributes are the keywords of single environments, such as ``dt`` or ``omega2``; ``state``, a row of ``states``; and
        ``observation_space``, ``action_space``, ``metadata``, ``render_mode`` and ``spec``. An attribute that was assigned to the vector
        environment has its value for each environment.

        Raises
        ------
        AttributeError
            For an unknown attribute; the message has the nearest name.
        """
        if name == "render":
            return self.call(name)
        if name == "state":
            return tuple(self.states)
        if name == "parameters":
            table = self.parameters
            return tuple({key: float(values[n]) for key, values in table.items()} for n in range(self.num_envs))
        keywords = keywords_of(self)
        given: Any = keywords.get(name)
        if np.shape(given) == (self.num_envs,) and name in self.parameters:
            # One for each environment.
            return tuple(given)
        if name == "metadata":
            value = {key: one for key, one in self.metadata.items() if key != "autoreset_mode"}
        elif name in ("observation_space", "action_space"):
            value = getattr(self, f"single_{name}")
        elif name in keywords:
            value = keywords[name]
        elif name == "spec" or (name in vars(self) and not name.startswith("_")):
            value = getattr(self, name)
        elif callable(getattr(type(self), name, None)):
            raise AttributeError(f"{name} is a method of all environments; expected render or an attribute; help: envs.{name}(…)")
        else:
            raise unknown(name, [*keywords, *_ATTRIBUTES])
        return (value,) * self.num_envs

    def set_attr(self, name: str, values: Any) -> None:
        """Set an attribute of each environment: a list or tuple has a value for each, another value is that of all.

        Only ``render_mode`` can be set, with one value for all environments. The engine has the keywords since construction.

        Raises
        ------
        ValueError
            If there is not one value for each environment, or for a ``render_mode`` that is not allowed.
        AttributeError
            For another attribute.
        """
        each = list(values) if isinstance(values, (list, tuple)) else [values] * self.num_envs
        if len(each) != self.num_envs:
            raise ValueError(f"{name} has {len(each)} values, but there must be one for each of {self.num_envs} environments")
        if name != SETTABLE:
            self.get_attr(name)
            raise refused(name, values, keywords_of(self))
        if any(value != each[0] for value in each):
            raise ValueError(f"{name} is {values!r}, but it must be the same for all environments")
        self.render_mode = checked_render_mode(each[0])

    def close_extras(self, **kwargs: Any) -> None:
        self._close()

    def _extras(self) -> dict[str, Any]:
        names = ("_spec", "render_mode", "_np_random", "_np_random_seed", "closed")
        return {name: self.__dict__[name] for name in names if name in self.__dict__}

    @classmethod
    def _construct(cls, name: str | EquationSystem, given: dict[str, Any]) -> Environments:
        make: Any = cls
        return make(name, **given) if cls._takes_name else make(**given)

    def close(self, **kwargs: Any) -> None:
        gymnasium.vector.VectorEnv.close(self, **kwargs)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.preset.name}, num_envs={self.num_envs})"


class _Batch(Environments):
    """The environments of a single one, with the errors of Gymnasium."""

    _reset_needed = ResetNeeded
    _closed_error = ClosedEnvironmentError


class RoundedBatch(_Batch):
    """The same, with observations of ``float32``."""

    _rounds = True


class Env(gymnasium.Env):
    """Single Gymnasium environment of the engine.

    ``gymnasium.make`` adds the time limit.
    """

    metadata = METADATA
    spec = JSON_SPEC
    _batch_class: type[Environments] = _Batch
    _action: Any = None
    """The last one of the episode, for pictures."""

    def __init__(
        self, name: str | EquationSystem | System | LinearPlant, *, render_mode: str | None = None, **given: Any
    ) -> None:
        for unknown in ("num_envs", "autoreset_mode", "copy", "buffers", "max_episode_steps"):
            if unknown in given:
                raise TypeError(f"unexpected keyword argument {unknown!r}: it belongs to vector environments")
        subject: str | EquationSystem = with_commands(name)
        self.render_mode = checked_render_mode(render_mode)
        self._all = self._batch_class(subject, max_episode_steps=np.inf, autoreset_mode="Disabled", **given)
        preset = self._all.preset
        for late in ("action_delay", "observation_delay"):
            if isinstance(preset, Preset) and isinstance(given.get(late), (int, float, tuple)):
                # The limit of `gymnasium.make` is that of the registered environment.
                check_within_episode(late, ends(late, given[late]), given.get("dt") or preset.dt, preset.max_episode_steps)
        self._tells: bool = self._all._settings["parameter_infos"]
        self.metadata = _metadata(self._all._settings)
        self.observation_space, self.action_space = single_spaces(self._all.preset, self._all._settings)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        if options is not None and "reset_mask" in options_of(options):
            raise ValueError("options has 'reset_mask', but it belongs to vector environments")
        # A refused reset changes nothing.
        observations, infos = self._all.reset(seed=None if seed is None else [seed], options=options)
        super().reset(seed=seed)
        if self._action is not None:
            self._action = None
        return observations[0], _single(infos)

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        results = self._all._step_single(action)
        if self.render_mode is not None:
            self._action = numbers_of(action)
        if self._tells:
            results[4]["parameters"] = self.parameters
        return results

    def render(self) -> np.ndarray | None:
        if self.render_mode is None:
            gymnasium.logger.warn("render was called, but render_mode is None: nothing is drawn")
            return None
        return _pictures(self._all)[0]

    @property
    def parameters(self) -> dict[str, float]:
        """Numbers of the current episode that differ between episodes, by name."""
        return {name: float(values[0]) for name, values in self._all.parameters.items()}

    def set_state(self, state: Any) -> np.ndarray:
        """Put the environment at a state, from which its episode goes on, and return the observation; see :meth:`VectorEnv.set_state`."""
        return self._all.set_state(state)[0]

    @property
    def state(self) -> np.ndarray:
        """True position and velocity, without noise and latency; of a system by equations its states."""
        return self._all.states[0]

    # With these three a vector environment of Gymnasium tells the same attributes as one of the engine.

    def has_wrapper_attr(self, name: str) -> bool:
        return super().has_wrapper_attr(name) or name in self._keywords()

    def get_wrapper_attr(self, name: str) -> Any:
        keywords = self._keywords()
        if name in keywords:
            return keywords[name]
        if not hasattr(self, name):
            raise unknown(name, [*keywords, *_ATTRIBUTES])
        return super().get_wrapper_attr(name)

    def set_wrapper_attr(self, name: str, value: Any, *, force: bool = True) -> bool:
        keywords = self._keywords()
        if name in keywords or name == "state":
            raise refused(name, value, keywords)
        if name == SETTABLE:
            value = checked_render_mode(value)
        return super().set_wrapper_attr(name, value, force=force)

    def _keywords(self) -> dict[str, Any]:
        # ``gymnasium.make`` adds the time limit.
        return {name: value for name, value in keywords_of(self._all).items() if name != "max_episode_steps"}

    def __copy__(self) -> Env:
        # A shallow copy would step the original.
        return copy.deepcopy(self)

    def close(self) -> None:
        self._all._close()


def _single(infos: dict[str, Any]) -> dict[str, Any]:
    """Return the infos of the only environment."""
    if "parameters" not in infos:
        return infos
    names = [name for name in infos["parameters"] if not name.startswith("_")]
    return {"parameters": {name: float(infos["parameters"][name][0]) for name in names}}
