"""Twins of Gymnasium's classic control: the same steps, with latencies, jitter, noise and parameters that vary.

``libration/CartPole-v1``, ``libration/Pendulum-v1``, ``libration/MountainCar-v0``, ``libration/MountainCarContinuous-v0`` and
``libration/Acrobot-v1`` have spaces, constants, integrators, rewards, terminations and time limits of Gymnasium's environments of these names.
"""

from __future__ import annotations

from typing import Any, Callable, TypeVar

import gymnasium

from ._classic_envs import ClassicEnv, ClassicVectorEnv
from ._classic_systems import CLASSIC, system_of
from ._environment_keywords import (
    ClassicAcrobotKeywords,
    ClassicAcrobotVectorKeywords,
    ClassicCartPoleKeywords,
    ClassicCartPoleVectorKeywords,
    ClassicMountainCarContinuousKeywords,
    ClassicMountainCarContinuousVectorKeywords,
    ClassicMountainCarKeywords,
    ClassicMountainCarVectorKeywords,
    ClassicPendulumKeywords,
    ClassicPendulumVectorKeywords,
    Unpack,
)
from ._environment_pages import vector_page

__all__ = [
    "AcrobotEnv",
    "AcrobotVectorEnv",
    "CartPoleEnv",
    "CartPoleVectorEnv",
    "MountainCarContinuousEnv",
    "MountainCarContinuousVectorEnv",
    "MountainCarEnv",
    "MountainCarVectorEnv",
    "PendulumEnv",
    "PendulumVectorEnv",
]

Class = TypeVar("Class", bound=type[Any])

_ARGUMENTS = """
    Each of these numbers may vary: `Uniform(low, high)`, `LogUniform(low, high)`, `LogNormal(mean, std)`, `Gaussian(std, mean)`, or an array `(num_envs,)`.

    Task (default: that of Gymnasium):

    - `starts` (`"libration"`): `"libration"` draws starts that depend on seed, environment and episode only; `"gymnasium"` has the starts that
      NumPy draws for Gymnasium with the same seed.
    - `start`: a number or a range for each state, by its name: {states}.
    - `observe`, `reward`, `terminated`: expressions of the task.
    - `project`: expressions that replace states after each step of the integrator, by name.
    - `actions`: commands of discrete actions.
    - `max_action`{most}: largest action.
    - `inner`, `targets`, `inner_period`: a controller between actions and inputs.
    - `chunk`: `(H, s)`, of whose `H` actions `s` are used.

    Timing and noise (all 0 by default):

    - `action_delay`, `observation_delay`: latency in s; a pair `(low, high)` is drawn for each episode.
    - `inference`, `inference_mode` (`\"asynchronous\"`): the time in s of each answer of the policy, `LogNormal(mean, std)` or another distribution; `\"synchronous\"` for a system that waits.
    - `jitter`: standard deviation of the length of each step of the integrator, relative to its length; or `("uniform", std)`.
    - `skew`: standard deviation of the rate of the clock of an episode; or `("uniform", std)`.
    - `observation_noise`: standard deviation of the noise of each observed number, in its unit; or `("uniform", std)`.

    Engine:

    - `integrator` (`"{integrator}"`): a name from `libration.INTEGRATORS` except `"exact"`.
    - `dt` (`{dt}`): time between two actions in s.
    - `substeps`: steps of the integrator between two actions (default: the smallest number up to 20 for which all latencies are whole steps; else steps begin where latencies end).
    - `dtype` (`"{dtype}"`): `"float32"` or `"float64"` for states and rewards; observations of `reset` and `step` are `float32`.
    - `threads` (`1`): number of threads; 0 is one per core.
    - `parameter_infos` (`False`): whether `info` has `parameters`, the numbers that differ between episodes.
    - `render_mode` (`None`): `"rgb_array"` for pictures of Gymnasium, which require Pygame.
    """
_OF_VECTORS = """
    `rollout` returns observations in `dtype`; `reset` and `step` round them to `float32`.
    """


def _page(name: str) -> Callable[[Class], Class]:
    """Return a decorator that adds the arguments of all twins to the documentation of one."""

    def documented(single: Class) -> Class:
        classic = CLASSIC[name]
        states = ", ".join(f"`{state}`" for state in system_of(name).states)
        most = f" (`{classic.max_action}`)" if classic.max_action < float("inf") and not classic.charges_more else ""
        arguments = _ARGUMENTS.format(states=states, most=most, integrator=classic.integrator, dt=classic.dt, dtype=classic.dtype)
        single.__doc__ = (single.__doc__ or "").rstrip() + "\n" + arguments
        return single

    return documented


def _vector_page(single: type[ClassicEnv]) -> str:
    return vector_page(single) + _OF_VECTORS


@_page("CartPole")
class CartPoleEnv(ClassicEnv):
    """Environment ``libration/CartPole-v1``: a twin of Gymnasium's ``CartPole-v1``.

    ## Description

    A pole on a cart, to keep upright. Equations, constants and integrator are those of Gymnasium, after Barto, Sutton and Anderson (1983).

    ## Action space

    The action is an integer of `Discrete(2)`.

    - 0: push the cart to the left with `force_mag`
    - 1: push the cart to the right with `force_mag`

    ## Observation space

    The observation is an `ndarray` with shape `(4,)`. With `observation_noise` no number has a limit.

    | Num | Observation      | Min         | Max        | Unit  |
    |-----|------------------|-------------|------------|-------|
    | 0   | position         | -4.8        | 4.8        | m     |
    | 1   | velocity         | -inf        | inf        | m/s   |
    | 2   | angle            | -0.41887903 | 0.41887903 | rad   |
    | 3   | angular velocity | -inf        | inf        | rad/s |

    ## Rewards

    The reward is 1 for each step.

    ## Starting state

    Position, angle and both velocities are uniform in *[−0.05, 0.05]*.

    ## Episode end

    1. Termination: the position is beyond ±2.4 m, or the angle beyond ±12°.
    2. Truncation: after 500 actions, by `gymnasium.make`.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System:

    - `gravity` (`9.8`): acceleration of gravity in m/s².
    - `masscart` (`1.0`), `masspole` (`0.1`): masses in kg.
    - `length` (`0.5`): half the length of the pole in m.
    - `force_mag` (`10.0`): force of an action in N.
    """

    def __init__(self, **given: Unpack[ClassicCartPoleKeywords]) -> None:
        super().__init__("CartPole", **given)


class CartPoleVectorEnv(ClassicVectorEnv):
    __doc__ = _vector_page(CartPoleEnv)

    def __init__(self, num_envs: int = 1, **given: Unpack[ClassicCartPoleVectorKeywords]) -> None:
        super().__init__("CartPole", num_envs, **given)


@_page("Pendulum")
class PendulumEnv(ClassicEnv):
    """Environment ``libration/Pendulum-v1``: a twin of Gymnasium's ``Pendulum-v1``.

    ## Description

    A pendulum with a motor that cannot lift it in one swing, to swing up. Equations, constants and integrator are those of Gymnasium. The angle
    *θ* is 0 at the top.

    ## Action space

    The action is an `ndarray` with shape `(1,)`, the torque of the motor. Larger actions are clipped.

    | Num | Action | Min  | Max | Unit |
    |-----|--------|------|-----|------|
    | 0   | torque | -2.0 | 2.0 | N·m  |

    ## Observation space

    The observation is an `ndarray` with shape `(3,)`. With `observation_noise` no number has a limit.

    | Num | Observation      | Min  | Max | Unit  |
    |-----|------------------|------|-----|-------|
    | 0   | cos θ            | -1.0 | 1.0 | 1     |
    | 1   | sin θ            | -1.0 | 1.0 | 1     |
    | 2   | angular velocity | -8.0 | 8.0 | rad/s |

    ## Rewards

    *r = −(θ² + 0.1 v² + 0.001 u²)* with angle in *[−π, π]* and velocity before the step and the clipped action. The largest reward is 0.

    ## Starting state

    The angle is uniform in *[−π, π]* rad, the velocity in *[−1, 1]* rad/s.

    ## Episode end

    1. Termination: never.
    2. Truncation: after 200 actions, by `gymnasium.make`.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System:

    - `g` (`10.0`): acceleration of gravity in m/s².
    - `m` (`1.0`): mass in kg.
    - `l` (`1.0`): length in m.
    """

    def __init__(self, **given: Unpack[ClassicPendulumKeywords]) -> None:
        super().__init__("Pendulum", **given)


class PendulumVectorEnv(ClassicVectorEnv):
    __doc__ = _vector_page(PendulumEnv)

    def __init__(self, num_envs: int = 1, **given: Unpack[ClassicPendulumVectorKeywords]) -> None:
        super().__init__("Pendulum", num_envs, **given)


@_page("MountainCar")
class MountainCarEnv(ClassicEnv):
    """Environment ``libration/MountainCar-v0``: a twin of Gymnasium's ``MountainCar-v0``.

    ## Description

    A car in a valley with a motor that is weaker than gravity, to drive up the right hill. Equations, constants and integrator are those of
    Gymnasium, after Moore (1990). Position and velocity have no unit; a step takes the time 1.

    ## Action space

    The action is an integer of `Discrete(3)`.

    - 0: accelerate to the left with `force`
    - 1: do not accelerate
    - 2: accelerate to the right with `force`

    ## Observation space

    The observation is an `ndarray` with shape `(2,)`. With `observation_noise` no number has a limit.

    | Num | Observation | Min   | Max  | Unit |
    |-----|-------------|-------|------|------|
    | 0   | position    | -1.2  | 0.6  | 1    |
    | 1   | velocity    | -0.07 | 0.07 | 1    |

    ## Rewards

    The reward is −1 for each step.

    ## Starting state

    The position is uniform in *[−0.6, −0.4]*, the velocity is 0.

    ## Episode end

    1. Termination: the position is at least 0.5 and the velocity at least `goal_velocity`.
    2. Truncation: after 200 actions, by `gymnasium.make`.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System:

    - `force` (`0.001`): acceleration of an action.
    - `gravity` (`0.0025`): largest acceleration of the slope.
    - `goal_velocity` (`0.0`): least velocity at the goal.
    """

    def __init__(self, **given: Unpack[ClassicMountainCarKeywords]) -> None:
        super().__init__("MountainCar", **given)


class MountainCarVectorEnv(ClassicVectorEnv):
    __doc__ = _vector_page(MountainCarEnv)

    def __init__(self, num_envs: int = 1, **given: Unpack[ClassicMountainCarVectorKeywords]) -> None:
        super().__init__("MountainCar", num_envs, **given)


@_page("MountainCarContinuous")
class MountainCarContinuousEnv(ClassicEnv):
    """Environment ``libration/MountainCarContinuous-v0``: a twin of Gymnasium's ``MountainCarContinuous-v0``.

    ## Description

    A car in a valley with a motor that is weaker than gravity, to drive up the right hill. Equations, constants and integrator are those of
    Gymnasium, after Moore (1990). Position and velocity have no unit; a step takes the time 1.

    ## Action space

    The action is an `ndarray` with shape `(1,)`. The motion clips larger actions at ±1; the reward does not, unless `max_action` is given.

    | Num | Action | Min  | Max | Unit |
    |-----|--------|------|-----|------|
    | 0   | force  | -1.0 | 1.0 | 1    |

    ## Observation space

    The observation is an `ndarray` with shape `(2,)`. With `observation_noise` no number has a limit.

    | Num | Observation | Min   | Max  | Unit |
    |-----|-------------|-------|------|------|
    | 0   | position    | -1.2  | 0.6  | 1    |
    | 1   | velocity    | -0.07 | 0.07 | 1    |

    ## Rewards

    *r = −0.1 u²* with the action *u*, and 100 more for the step that reaches the goal.

    ## Starting state

    The position is uniform in *[−0.6, −0.4]*, the velocity is 0.

    ## Episode end

    1. Termination: the position is at least 0.45 and the velocity at least `goal_velocity`.
    2. Truncation: after 999 actions, by `gymnasium.make`.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System:

    - `power` (`0.0015`): acceleration of the action 1.
    - `goal_velocity` (`0.0`): least velocity at the goal.
    """

    def __init__(self, **given: Unpack[ClassicMountainCarContinuousKeywords]) -> None:
        super().__init__("MountainCarContinuous", **given)


class MountainCarContinuousVectorEnv(ClassicVectorEnv):
    __doc__ = _vector_page(MountainCarContinuousEnv)

    def __init__(self, num_envs: int = 1, **given: Unpack[ClassicMountainCarContinuousVectorKeywords]) -> None:
        super().__init__("MountainCarContinuous", num_envs, **given)


@_page("Acrobot")
class AcrobotEnv(ClassicEnv):
    """Environment ``libration/Acrobot-v1``: a twin of Gymnasium's ``Acrobot-v1``.

    ## Description

    Two links that hang from a fixed joint, with a motor at the joint between them, to swing up. Equations, constants and integrator are those of
    Gymnasium, after Sutton and Barto. The angle *θ₁* is 0 where the first link hangs, *θ₂* is the angle between the links.

    ## Action space

    The action is an integer of `Discrete(3)`.

    - 0: torque of -1 N·m
    - 1: no torque
    - 2: torque of 1 N·m

    ## Observation space

    The observation is an `ndarray` with shape `(6,)`. With `observation_noise` no number has a limit.

    | Num | Observation               | Min        | Max       | Unit  |
    |-----|---------------------------|------------|-----------|-------|
    | 0   | cos θ₁                    | -1.0       | 1.0       | 1     |
    | 1   | sin θ₁                    | -1.0       | 1.0       | 1     |
    | 2   | cos θ₂                    | -1.0       | 1.0       | 1     |
    | 3   | sin θ₂                    | -1.0       | 1.0       | 1     |
    | 4   | angular velocity of *θ₁*  | -12.566371 | 12.566371 | rad/s |
    | 5   | angular velocity of *θ₂*  | -28.274334 | 28.274334 | rad/s |

    ## Rewards

    The reward is −1 for each step, and 0 for the step that reaches the height.

    ## Starting state

    Both angles and both velocities are uniform in *[−0.1, 0.1]*.

    ## Episode end

    1. Termination: the free end is above the joint by more than the length 1, *−cos θ₁ − cos(θ₁ + θ₂) > 1*.
    2. Truncation: after 500 actions, by `gymnasium.make`.

    A state that is not finite is lost: the episode terminates, its last reward is 0, and `info` has `lost`.

    ## Arguments

    System:

    - `m1` (`1.0`), `m2` (`1.0`): masses of the links in kg.
    - `l1` (`1.0`): length of the first link in m.
    - `lc1` (`0.5`), `lc2` (`0.5`): distances of the centres of mass from the joints in m.
    - `moi` (`1.0`): moment of inertia of each link in kg·m².
    """

    def __init__(self, **given: Unpack[ClassicAcrobotKeywords]) -> None:
        super().__init__("Acrobot", **given)


class AcrobotVectorEnv(ClassicVectorEnv):
    __doc__ = _vector_page(AcrobotEnv)

    def __init__(self, num_envs: int = 1, **given: Unpack[ClassicAcrobotVectorKeywords]) -> None:
        super().__init__("Acrobot", num_envs, **given)


def register() -> None:
    """Register the twins with Gymnasium; the import of the package does this."""
    for classic in CLASSIC.values():
        known = f"libration/{classic.id}"
        if known not in gymnasium.registry:
            gymnasium.register(
                id=known,
                entry_point=f"libration.classic_control:{classic.name}Env",
                vector_entry_point=f"libration.classic_control:{classic.name}VectorEnv",
                max_episode_steps=classic.max_episode_steps,
                reward_threshold=classic.reward_threshold,
            )
