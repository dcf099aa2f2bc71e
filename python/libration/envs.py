"""Gymnasium environments of the engine: vector environments and single ones."""

from __future__ import annotations

from typing import Any, Mapping

import gymnasium
from gymnasium.error import DeprecatedEnv

from ._dataset_environments import keywords_of_settings
from ._environment_keywords import (
    DuffingKeywords,
    DuffingVectorKeywords,
    OscillatorKeywords,
    OscillatorVectorKeywords,
    PendulumKeywords,
    PendulumVectorKeywords,
    Unpack,
)
from ._environment_pages import vector_page
from ._gymnasium_envs import METADATA, Env, VectorEnv
from ._presets import PRESETS
from ._spec_keywords import system_value
from .equations import EquationSystem
from .systems import with_commands

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
FORMER_ID = f"{NAMESPACE}/Pendulum-v0"
"""``Pendulum-v1`` is a twin of Gymnasium's own pendulum, another environment."""


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
    - `project`: expressions that replace states after each step of the integrator, by name.
    - `actions`: commands of discrete actions.
    - `inner`, `targets`, `inner_period`: a controller between actions and inputs.
    - `chunk`: `(H, s)`, of whose `H` actions `s` are used.
    - `max_action` (`math.inf`): largest action, or one for each input.
    - Parameters of the system by name: a number, `Uniform(low, high)`, `LogUniform(low, high)`, `LogNormal(mean, std)`, `Gaussian(std, mean)`, or an array `(num_envs,)`.

    Timing and noise (all 0 by default):

    - `action_delay`, `observation_delay`: latency in s; of a pair `(low, high)` each episode draws whole steps of the integrator.
    - `inference`, `inference_mode` (`\"asynchronous\"`): the time in s of each answer of the policy, `LogNormal(mean, std)` or another distribution; `\"synchronous\"` for a system that waits.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"velocity-verlet"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (required): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number up to 20 for which all latencies are whole steps; else steps begin where latencies end).
    - `dtype` (`"float32"`): `"float32"` or `"float64"`.
    - `threads` (`1`): number of threads; 0 is one per core.
    - `parameter_infos` (`False`): whether `info` has `parameters`, the numbers that differ between episodes.
    - `render_mode` (`None`): `"rgb_array"` for pictures: a bar for each state, in the order of `system.states` from the top.
    """

    def __init__(self, system: EquationSystem, **given: Any) -> None:
        super().__init__(_system(system), **given)


class SystemVectorEnv(VectorEnv):
    __doc__ = vector_page(SystemEnv)

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
    system = with_commands(system_value(system))
    if not isinstance(system, EquationSystem):
        raise TypeError(f"system must be a libration.System, not {type(system).__name__}")
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

    - `action_delay`, `observation_delay`: latency in s; of a pair `(low, high)` each episode draws whole steps of the integrator.
    - `inference`, `inference_mode` (`\"asynchronous\"`): the time in s of each answer of the policy, `LogNormal(mean, std)` or another distribution; `\"synchronous\"` for a system that waits.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"velocity-verlet"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (`0.01`): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number up to 20 for which all latencies are whole steps; else steps begin where latencies end).
    - `dtype` (`"float32"`): `"float32"` or `"float64"`.
    - `threads` (`1`): number of threads; 0 is one per core.
    - `parameter_infos` (`False`): whether `info` has `parameters`, the numbers that differ between episodes.
    - `render_mode` (`None`): `"rgb_array"` for pictures.
    """

    def __init__(self, **given: Unpack[OscillatorKeywords]) -> None:
        super().__init__("Oscillator", **given)


class OscillatorVectorEnv(VectorEnv):
    __doc__ = vector_page(OscillatorEnv)

    _takes_name = False

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

    - `action_delay`, `observation_delay`: latency in s; of a pair `(low, high)` each episode draws whole steps of the integrator.
    - `inference`, `inference_mode` (`\"asynchronous\"`): the time in s of each answer of the policy, `LogNormal(mean, std)` or another distribution; `\"synchronous\"` for a system that waits.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"velocity-verlet"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (`0.05`): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number up to 20 for which all latencies are whole steps; else steps begin where latencies end).
    - `dtype` (`"float32"`): `"float32"` or `"float64"`.
    - `threads` (`1`): number of threads; 0 is one per core.
    - `parameter_infos` (`False`): whether `info` has `parameters`, the numbers that differ between episodes.
    - `render_mode` (`None`): `"rgb_array"` for pictures.
    """

    def __init__(self, **given: Unpack[PendulumKeywords]) -> None:
        super().__init__("Pendulum", **given)


class PendulumVectorEnv(VectorEnv):
    __doc__ = vector_page(PendulumEnv)

    _takes_name = False

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

    - `action_delay`, `observation_delay`: latency in s; of a pair `(low, high)` each episode draws whole steps of the integrator.
    - `inference`, `inference_mode` (`\"asynchronous\"`): the time in s of each answer of the policy, `LogNormal(mean, std)` or another distribution; `\"synchronous\"` for a system that waits.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"velocity-verlet"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (`0.05`): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number up to 20 for which all latencies are whole steps; else steps begin where latencies end).
    - `dtype` (`"float32"`): `"float32"` or `"float64"`.
    - `threads` (`1`): number of threads; 0 is one per core.
    - `parameter_infos` (`False`): whether `info` has `parameters`, the numbers that differ between episodes.
    - `render_mode` (`None`): `"rgb_array"` for pictures.
    """

    def __init__(self, **given: Unpack[DuffingKeywords]) -> None:
        super().__init__("Duffing", **given)


class DuffingVectorEnv(VectorEnv):
    __doc__ = vector_page(DuffingEnv)

    _takes_name = False

    def __init__(self, num_envs: int = 1, **given: Unpack[DuffingVectorKeywords]) -> None:
        super().__init__("Duffing", num_envs, **given)


def _renamed(**given: Any) -> Any:
    raise DeprecatedEnv(f"{FORMER_ID} is {NAMESPACE}/PendulumSwingUp-v0 now; {NAMESPACE}/Pendulum-v1 is a twin of Gymnasium's Pendulum-v1")


def register() -> None:
    """Register the environments with Gymnasium; the import of the package does this."""
    entries: dict[str, tuple[str, int | None]] = {preset.id: (preset.name, preset.max_episode_steps) for preset in PRESETS.values()}
    entries["System-v0"] = ("System", None)
    for id, (name, limit) in entries.items():
        known = f"{NAMESPACE}/{id}"
        if known not in gymnasium.registry:
            gymnasium.register(
                id=known,
                entry_point=f"libration.envs:{name}Env",
                vector_entry_point=f"libration.envs:{name}VectorEnv",
                max_episode_steps=limit,
            )
    if FORMER_ID not in gymnasium.registry:
        gymnasium.register(id=FORMER_ID, entry_point=_renamed, vector_entry_point=_renamed)
    if DATASET_ID not in gymnasium.registry:
        gymnasium.register(id=DATASET_ID, entry_point="libration.envs:DatasetEnv")
