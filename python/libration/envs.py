"""Gymnasium environments of the engine: vector environments and single ones."""

from __future__ import annotations

from typing import Any, Mapping

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.spaces import Box, Discrete
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from ._attributes import SETTABLE, keywords_of, refused, unknown
from ._dataset_environments import keywords_of_settings
from ._episode_numbers import largest
from ._environment_keywords import (
    DuffingKeywords,
    DuffingVectorKeywords,
    OscillatorKeywords,
    OscillatorVectorKeywords,
    PendulumKeywords,
    PendulumVectorKeywords,
    Unpack,
)
from ._presets import PRESETS, Preset
from ._tasks import EquationPreset
from .environments import Environments
from .equations import EquationSystem

__all__ = [
    "DatasetEnv",
    "DuffingEnv",
    "DuffingVectorEnv",
    "OscillatorEnv",
    "OscillatorVectorEnv",
    "PendulumEnv",
    "PendulumVectorEnv",
    "SystemEnv",
    "SystemVectorEnv",
    "VectorEnv",
    "register",
]

NAMESPACE = "libration"
DATASET_ID = f"{NAMESPACE}/Dataset-v0"
_ATTRIBUTES = ("action_space", "metadata", "observation_space", "render_mode", "spec", "state")
"""Attributes of each environment besides its keywords."""
METADATA: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 30}


def _metadata(name: str | EquationSystem, settings: Any) -> dict[str, Any]:
    """Return what is known of an environment, with pictures in real time; a system by equations has none."""
    if isinstance(name, EquationSystem):
        return {"render_modes": []}
    return {**METADATA, "render_fps": max(1, round(1.0 / (settings["dt"] * settings["substeps"])))}


def _spaces(preset: Preset | EquationPreset, settings: dict[str, Any]) -> tuple[Box, Box | Discrete]:
    """Return the observation space and the action space of one environment."""
    dtype, subject = np.dtype(settings["dtype"]), settings["subject"]
    noise = subject["noise"]
    laws = noise if isinstance(noise, list) else [noise] * len(preset.seen)
    limits = [np.inf if law[1] > 0 else limit for law, limit in zip(laws, preset.limits)]
    high = np.array(limits, dtype=dtype)
    seen = Box(-high, high, dtype=dtype)
    if settings["levels"]:
        return seen, Discrete(len(settings["levels"]))
    most = np.broadcast_to(np.array(largest(subject["saturation"]), dtype=dtype), len(preset.actions))
    return seen, Box(-most, most, dtype=dtype)


def _render_mode(name: str | EquationSystem, render_mode: str | None) -> str | None:
    if render_mode not in (None, "rgb_array"):
        raise ValueError(f"render_mode is {render_mode!r}, but it must be 'rgb_array' or None")
    if render_mode is not None and isinstance(name, EquationSystem):
        raise ValueError(f"render_mode is {render_mode!r}, but it must be None: a system by equations has no picture")
    return render_mode


class VectorEnv(Environments, gymnasium.vector.VectorEnv):
    """Gymnasium vector environment of the engine.

    See :class:`libration.Environments` for all keywords; ``render_mode`` may be ``"rgb_array"``.

    ``step`` returns rewards of the ``dtype`` of the environments, ``(num_envs,)``: the numbers of the engine without a conversion or a
    copy. Gymnasium's ``SyncVectorEnv`` returns the same numbers as ``float64``. ``terminated`` and ``truncated`` are ``bool``,
    ``(num_envs,)``, as there.
    """

    metadata = METADATA
    _reset_needed = ResetNeeded
    _closed_error = ClosedEnvironmentError

    def __init__(
        self,
        name: str | EquationSystem,
        num_envs: int = 1,
        *,
        render_mode: str | None = None,
        **given: Any,
    ) -> None:
        self.render_mode = _render_mode(name, render_mode)
        super().__init__(name, num_envs, **given)
        self.metadata = {
            **_metadata(name, self._settings),
            "autoreset_mode": AutoresetMode(self._settings["autoreset"]),
        }
        spaces = _spaces(self.preset, dict(self._settings))
        self.single_observation_space, self.single_action_space = spaces
        self.observation_space, self.action_space = (batch_space(s, self.num_envs) for s in spaces)

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[np.ndarray, dict[str, Any]]:
        seeds = self._seeds(seed)
        if isinstance(seed, (int, np.integer)):
            gymnasium.vector.VectorEnv.reset(self, seed=int(seed))
        elif seed is not None:
            # Gymnasium's word for a seed that no number tells.
            self._np_random_seed = -1
        return self._begin(seeds, options)

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Return one picture per environment, ``(300, 300, 3)`` of ``uint8``, if ``render_mode`` is ``"rgb_array"``."""
        if self.render_mode is None:
            gymnasium.logger.warn("render was called, but render_mode is None: nothing is drawn")
            return None
        from ._render import picture

        preset = self.preset
        assert isinstance(preset, Preset), "a system by equations has no render mode"
        return tuple(picture(preset, *state) for state in self.states.astype(float))

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
        keywords = keywords_of(self)
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
        self.render_mode = _render_mode(self._arguments[0], each[0])

    def close_extras(self, **kwargs: Any) -> None:
        self._close()

    def _extras(self) -> dict[str, Any]:
        names = ("spec", "render_mode", "_np_random", "_np_random_seed", "closed")
        return {name: self.__dict__[name] for name in names if name in self.__dict__}

    @classmethod
    def _construct(cls, name: str | EquationSystem, given: dict[str, Any]) -> Environments:
        make: Any = cls
        return make(name, **given) if cls in (VectorEnv, SystemVectorEnv) else make(**given)

    def close(self, **kwargs: Any) -> None:
        gymnasium.vector.VectorEnv.close(self, **kwargs)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.preset.name}, num_envs={self.num_envs})"


class Env(gymnasium.Env):
    """Single Gymnasium environment of the engine.

    ``gymnasium.make`` adds the time limit.
    """

    metadata = METADATA

    def __init__(
        self, name: str | EquationSystem, *, render_mode: str | None = None, **given: Any
    ) -> None:
        for unknown in ("num_envs", "autoreset_mode", "copy", "buffers", "max_episode_steps"):
            if unknown in given:
                raise TypeError(f"unexpected keyword argument {unknown!r}: it belongs to vector environments")
        self.render_mode = _render_mode(name, render_mode)
        self._all = Environments(
            name, max_episode_steps=np.inf, autoreset_mode="Disabled", **given
        )
        self.metadata = _metadata(name, self._all._settings)
        self._all._reset_needed, self._all._closed_error = ResetNeeded, ClosedEnvironmentError
        spaces = _spaces(self._all.preset, dict(self._all._settings))
        self.observation_space, self.action_space = spaces

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=seed)
        if options is not None and "reset_mask" in options:
            raise ValueError("options has 'reset_mask', but it belongs to vector environments")
        observations, infos = self._all.reset(seed=None if seed is None else [seed], options=options)
        return observations[0], _single(infos)

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        observations, rewards, terminated, truncated, infos = self._all.step(action)
        info: dict[str, Any] = {"lost": True} if "lost" in infos else {}
        if "parameters" in infos:
            info |= _single({"parameters": infos["parameters"]})
        return observations[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info

    def render(self) -> np.ndarray | None:
        if self.render_mode is None:
            gymnasium.logger.warn("render was called, but render_mode is None: nothing is drawn")
            return None
        from ._render import picture

        preset = self._all.preset
        assert isinstance(preset, Preset), "a system by equations has no render mode"
        return picture(preset, *self._all.states[0].astype(float))

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
            value = _render_mode(self._all._arguments[0], value)
        return super().set_wrapper_attr(name, value, force=force)

    def _keywords(self) -> dict[str, Any]:
        # ``gymnasium.make`` adds the time limit.
        return {name: value for name, value in keywords_of(self._all).items() if name != "max_episode_steps"}

    def close(self) -> None:
        self._all._close()


def _single(infos: dict[str, Any]) -> dict[str, Any]:
    """Return the infos of the only environment."""
    if "parameters" not in infos:
        return infos
    names = [name for name in infos["parameters"] if not name.startswith("_")]
    return {"parameters": {name: float(infos["parameters"][name][0]) for name in names}}


def _vector_page(single: type[Env]) -> str:
    """Return the documentation of the vector environment: that of the single one, and what many of them add."""
    page = single.__doc__ or ""
    for old, new in (
        ("Environment ``", "Vector environment ``"),
        ("The action is an `ndarray` with shape `(", "The actions are an `ndarray` with shape `(num_envs, "),
        ("The observation is an `ndarray` with shape `(", "The observations are an `ndarray` with shape `(num_envs, "),
        ("The observation is an `ndarray` with a number", "The observations are an `ndarray` with a row for each environment, a number"),
        (",)`", ")`"),
        (", by `gymnasium.make`", ", or `max_episode_steps`"),
        (" of `gymnasium.make`", ""),
        ("`info` has", "`infos` has"),
    ):
        page = page.replace(old, new)
    return page.rstrip() + _OF_VECTORS


_OF_VECTORS = """

    Vector environment:

    - `num_envs` (`1`): number of environments. Environment *n* under `reset(seed=s)` is the single environment under `reset(seed=s + n)`.
    - `max_episode_steps`: number of actions after which an episode is truncated; `math.inf` or -1 for no limit.
    - `autoreset_mode` (`"NextStep"`): `"NextStep"`, `"SameStep"` or `"Disabled"`, as in Gymnasium.
    - `copy` (`True`), `buffers` (`2`): with `copy=False` the steps fill `buffers` arrays in turn.
    """


class SystemEnv(Env):
    """Environment ``libration/System-v0``: a system by its equations.

    ## Description

    Any system of ordinary differential equations, a `libration.EquationSystem`: `libration.System(acceleration={...})` or
    `libration.System.from_toml(path)`. Its inputs are the actions. The task is that of the system, or that of the arguments.

    ## Action space

    The action is an `ndarray` with shape `(inputs,)`. Larger actions are clipped.

    | Num | Action         | Min           | Max          | Unit             |
    |-----|----------------|---------------|--------------|------------------|
    | i   | input *i*      | -`max_action` | `max_action` | of the input     |

    ## Observation space

    The observation is an `ndarray` with a number for each expression of `observe`. Without noise a number that is a single sine or cosine is in
    *[−1, 1]*.

    | Num | Observation           | Min  | Max | Unit              |
    |-----|-----------------------|------|-----|-------------------|
    | i   | `observe[i]`          | -inf | inf | of the expression |

    ## Rewards

    The reward is the expression `reward` of the states after the step, the clipped actions, and `before(x)` for a state before the step.

    ## Starting state

    Each state of `start` has its number, or is uniform in its range. The others start as the system does.

    ## Episode end

    1. Termination: one of the comparisons `terminated` holds after the step.
    2. Truncation: after `max_episode_steps` actions of `gymnasium.make`; without it, never.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System and task:

    - `system`: the system; it needs at least one input.
    - `observe` (all states), `reward`, `terminated` (none): expressions of the task (default: those of the task of the system).
    - `start`: a number or a range for each state, by its name.
    - `max_action` (`math.inf`): largest action, or one for each input.

    Timing and noise (all 0 by default):

    - `action_delay`, `observation_delay`: latency in s; a pair `(low, high)` is drawn for each episode.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"velocity-verlet"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (required): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number for which all latencies are whole steps).
    - `dtype` (`"float32"`): `"float32"` or `"float64"`.
    - `threads` (`1`): number of threads; 0 is one per core.
    """

    metadata = {"render_modes": []}

    def __init__(self, system: EquationSystem, **given: Any) -> None:
        super().__init__(_system(system), **given)


class SystemVectorEnv(VectorEnv):
    __doc__ = _vector_page(SystemEnv)

    metadata = {"render_modes": []}

    def __init__(self, system: EquationSystem, num_envs: int = 1, **given: Any) -> None:
        super().__init__(_system(system), num_envs, **given)


class DatasetEnv(Env):
    """Single environment ``libration/Dataset-v0``, with which a data set was written.

    Parameters
    ----------
    settings:
        The settings in the manifest of the data set (``data``).
    **given:
        Keywords of :class:`libration.Environments` in place of those of the data set, and ``render_mode``.
    """

    metadata = METADATA

    def __init__(self, settings: Mapping[str, Any], **given: Any) -> None:
        name, keywords = keywords_of_settings(settings)
        super().__init__(name, **{**keywords, **given})


def _system(system: Any) -> EquationSystem:
    if not isinstance(system, EquationSystem):
        raise TypeError(f"system must be a libration.EquationSystem, not {type(system).__name__}")
    return system


class OscillatorEnv(Env):
    """Environment ``libration/Oscillator-v0``: a mass on a spring, to bring to rest.

    ## Description

    A mass on a spring without friction. The equation of motion is *q'' = −ω² q + u* with the position *q* in m and the action *u*. The task is
    to bring the mass to rest at the origin.

    ## Action space

    The action is an `ndarray` with shape `(1,)`, the acceleration by the motor. With `m` and `k` it is a force in N. Larger actions are clipped.

    | Num | Action       | Min   | Max  | Unit |
    |-----|--------------|-------|------|------|
    | 0   | acceleration | -20.0 | 20.0 | m/s² |

    ## Observation space

    The observation is an `ndarray` with shape `(2,)`.

    | Num | Observation | Min  | Max | Unit |
    |-----|-------------|------|-----|------|
    | 0   | position    | -inf | inf | m    |
    | 1   | velocity    | -inf | inf | m/s  |

    ## Rewards

    *r = −(position_cost · q² + velocity_cost · v² + effort_cost · u²)* with position and velocity after the step and the clipped action. The
    largest reward is 0.

    ## Starting state

    Position and velocity are uniform in *[−1, 1]* m and *[−1, 1]* m/s.

    ## Episode end

    1. Termination: the position is beyond ±`bound`.
    2. Truncation: after 500 actions, by `gymnasium.make`.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System and task:

    - `omega2` (`10.0`): *ω²* in s⁻²; or a mass `m` in kg and a stiffness `k` in N/m.
    - `position_cost` (`1.0`), `velocity_cost` (`0.1`), `effort_cost` (`0.001`): weights of the reward.
    - `bound` (`10.0`): largest position in m; `math.inf` for none.
    - `max_action` (`20.0`): largest action.
    - `start_position` (`(-1.0, 1.0)`), `start_velocity` (`(-1.0, 1.0)`): a number, or a range.

    Timing and noise (all 0 by default):

    - `action_delay`, `observation_delay`: latency in s; a pair `(low, high)` is drawn for each episode.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"velocity-verlet"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (`0.01`): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number for which all latencies are whole steps).
    - `dtype` (`"float32"`): `"float32"` or `"float64"`.
    - `threads` (`1`): number of threads; 0 is one per core.
    - `render_mode` (`None`): `"rgb_array"` for pictures.
    """

    def __init__(self, **given: Unpack[OscillatorKeywords]) -> None:
        super().__init__("Oscillator", **given)


class OscillatorVectorEnv(VectorEnv):
    __doc__ = _vector_page(OscillatorEnv)

    def __init__(self, num_envs: int = 1, **given: Unpack[OscillatorVectorKeywords]) -> None:
        super().__init__("Oscillator", num_envs, **given)


class PendulumEnv(Env):
    """Environment ``libration/PendulumSwingUp-v0``: a pendulum to swing up.

    ## Description

    A pendulum with a motor that cannot lift it in one swing. The equation of motion is *q'' = −ω² sin q + u* with the angle *q* in rad from the
    hanging position and the action *u*. The task is to swing the pendulum up and to keep it upright. Gravity, motor, time step and time limit
    are those of Gymnasium's `Pendulum-v1`. Below, *θ = q − π* is the angle from the top.

    ## Action space

    The action is an `ndarray` with shape `(1,)`, the angular acceleration by the motor. Larger actions are clipped.

    | Num | Action               | Min  | Max | Unit   |
    |-----|----------------------|------|-----|--------|
    | 0   | angular acceleration | -6.0 | 6.0 | rad/s² |

    ## Observation space

    The observation is an `ndarray` with shape `(3,)`. With `observation_noise` no number has a limit.

    | Num | Observation      | Min  | Max | Unit  |
    |-----|------------------|------|-----|-------|
    | 0   | cos θ            | -1.0 | 1.0 | 1     |
    | 1   | sin θ            | -1.0 | 1.0 | 1     |
    | 2   | angular velocity | -inf | inf | rad/s |

    ## Rewards

    *r = cos θ − 1 − velocity_cost · v² − effort_cost · u²* with angle and velocity before the step and the clipped action. The largest reward
    is 0: the pendulum stands still.

    ## Starting state

    The angle *q* is uniform in *[−π, π]* rad, the velocity in *[−1, 1]* rad/s.

    ## Episode end

    1. Termination: never.
    2. Truncation: after 200 actions, by `gymnasium.make`.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System and task:

    - `omega2` (`15.0`): *ω²* in s⁻².
    - `velocity_cost` (`0.1`), `effort_cost` (`0.001`): weights of the reward.
    - `max_action` (`6.0`): largest action in rad/s².
    - `start_position` (`(-math.pi, math.pi)`), `start_velocity` (`(-1.0, 1.0)`): a number, or a range.

    Timing and noise (all 0 by default):

    - `action_delay`, `observation_delay`: latency in s; a pair `(low, high)` is drawn for each episode.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"velocity-verlet"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (`0.05`): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number for which all latencies are whole steps).
    - `dtype` (`"float32"`): `"float32"` or `"float64"`.
    - `threads` (`1`): number of threads; 0 is one per core.
    - `render_mode` (`None`): `"rgb_array"` for pictures.
    """

    def __init__(self, **given: Unpack[PendulumKeywords]) -> None:
        super().__init__("Pendulum", **given)


class PendulumVectorEnv(VectorEnv):
    __doc__ = _vector_page(PendulumEnv)

    def __init__(self, num_envs: int = 1, **given: Unpack[PendulumVectorKeywords]) -> None:
        super().__init__("Pendulum", num_envs, **given)


class DuffingEnv(Env):
    """Environment ``libration/Duffing-v0``: a mass between two wells, to bring to rest on the hill.

    ## Description

    A mass in a potential with two wells. The equation of motion is *q'' = −α q − β q³ + u* with the position *q* in m and the action *u*. With
    the defaults the wells are at ±1 m. The task is to bring the mass to rest at the origin, the top of the hill between them, which is unstable.

    ## Action space

    The action is an `ndarray` with shape `(1,)`, the acceleration by the motor. Larger actions are clipped.

    | Num | Action       | Min  | Max | Unit |
    |-----|--------------|------|-----|------|
    | 0   | acceleration | -0.5 | 0.5 | m/s² |

    ## Observation space

    The observation is an `ndarray` with shape `(2,)`.

    | Num | Observation | Min  | Max | Unit |
    |-----|-------------|------|-----|------|
    | 0   | position    | -inf | inf | m    |
    | 1   | velocity    | -inf | inf | m/s  |

    ## Rewards

    *r = −(position_cost · q² + velocity_cost · v² + effort_cost · u²)* with position and velocity after the step and the clipped action. The
    largest reward is 0.

    ## Starting state

    Position and velocity are uniform in *[−1.5, 1.5]* m and *[−0.5, 0.5]* m/s.

    ## Episode end

    1. Termination: the position is beyond ±`bound`.
    2. Truncation: after 400 actions, by `gymnasium.make`.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System and task:

    - `alpha` (`-1.0`): *α* in s⁻².
    - `beta` (`1.0`): *β* in m⁻²s⁻².
    - `position_cost` (`1.0`), `velocity_cost` (`0.1`), `effort_cost` (`0.001`): weights of the reward.
    - `bound` (`10.0`): largest position in m; `math.inf` for none.
    - `max_action` (`0.5`): largest action in m/s².
    - `start_position` (`(-1.5, 1.5)`), `start_velocity` (`(-0.5, 0.5)`): a number, or a range.

    Timing and noise (all 0 by default):

    - `action_delay`, `observation_delay`: latency in s; a pair `(low, high)` is drawn for each episode.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"velocity-verlet"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (`0.05`): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number for which all latencies are whole steps).
    - `dtype` (`"float32"`): `"float32"` or `"float64"`.
    - `threads` (`1`): number of threads; 0 is one per core.
    - `render_mode` (`None`): `"rgb_array"` for pictures.
    """

    def __init__(self, **given: Unpack[DuffingKeywords]) -> None:
        super().__init__("Duffing", **given)


class DuffingVectorEnv(VectorEnv):
    __doc__ = _vector_page(DuffingEnv)

    def __init__(self, num_envs: int = 1, **given: Unpack[DuffingVectorKeywords]) -> None:
        super().__init__("Duffing", num_envs, **given)


def register() -> None:
    """Register the environments with Gymnasium; the import of the package does this."""
    entries: dict[str, tuple[str, int | None]] = {preset.id: (preset.name, preset.max_episode_steps) for preset in PRESETS.values()}
    # Its former identifier, of which Gymnasium says that it is out of date.
    entries |= {"Pendulum-v0": entries["PendulumSwingUp-v0"], "System-v0": ("System", None)}
    for id, (name, limit) in entries.items():
        known = f"{NAMESPACE}/{id}"
        if known not in gymnasium.registry:
            gymnasium.register(
                id=known,
                entry_point=f"libration.envs:{name}Env",
                vector_entry_point=f"libration.envs:{name}VectorEnv",
                max_episode_steps=limit,
            )
    if DATASET_ID not in gymnasium.registry:
        gymnasium.register(id=DATASET_ID, entry_point="libration.envs:DatasetEnv")
