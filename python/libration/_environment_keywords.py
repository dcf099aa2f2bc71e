"""Keywords of environments and their types, in one place for all classes. ``libration.Environments`` documents them."""

from __future__ import annotations

import typing
from typing import TYPE_CHECKING, Any, Mapping, Sequence, SupportsFloat, TypedDict

from numpy.typing import DTypeLike, NDArray

if TYPE_CHECKING:
    from gymnasium.vector import AutoresetMode
    from typing_extensions import TypeAlias, Unpack

    from .identification import Identification
    from .perturbations import PD, Gaussian, LogNormal, LogUniform, Uniform

    Range: TypeAlias = SupportsFloat | Sequence[SupportsFloat] | Uniform
    """A number, or a pair ``(low, high)``."""
    Varied: TypeAlias = (
        SupportsFloat | Sequence[SupportsFloat] | tuple[str, float, float] | NDArray[Any] | Uniform | LogUniform | LogNormal | Gaussian
    )
    """A number, a distribution of episodes, or a number for each environment."""
    Inference: TypeAlias = SupportsFloat | tuple[str, float, float] | list[str | float] | LogNormal | LogUniform | Uniform | None
    """The time of an inference in s, or its distribution."""
    Delay: TypeAlias = Range | Identification
    """A latency in s, a range of it, or an identified loop."""
    Law: TypeAlias = SupportsFloat | tuple[str, float] | list[str | float] | Gaussian | Uniform | None
    """A standard deviation, or a pair ``("uniform", std)``."""
    LawOfEach: TypeAlias = Law | Sequence[Any]
    """A distribution, or one for each observed number."""
    Autoreset: TypeAlias = str | AutoresetMode
else:
    # Python 3.10 has no Unpack; what stands for it is an annotation that nothing evaluates.
    Unpack = getattr(typing, "Unpack", typing.Type)

__all__ = ["Unpack"]


class EngineKeywords(TypedDict, total=False):
    """Keywords of every environment."""

    integrator: str
    dt: float | None
    substeps: int | None
    action_delay: Delay
    observation_delay: Delay
    jitter: Law
    skew: Law
    inference: Inference
    inference_mode: str
    observation_noise: LawOfEach
    max_action: Varied | Sequence[Varied] | None
    dtype: DTypeLike
    threads: int
    parameter_infos: bool


class BatchKeywords(TypedDict, total=False):
    """Keywords of vector environments."""

    max_episode_steps: float | None
    autoreset_mode: Autoreset
    copy: bool
    buffers: int | None


class StartKeywords(TypedDict, total=False):
    """Starts of systems of the catalogue."""

    start_position: Range | None
    start_velocity: Range | None


class TaskKeywords(TypedDict, total=False):
    """Tasks on systems by equations."""

    observe: Sequence[str] | None
    reward: str | None
    terminated: Sequence[str] | None
    start: Mapping[str, Any] | None
    project: Mapping[str, str] | None
    actions: Sequence[float] | None
    targets: Sequence[str] | None
    inner: PD | Mapping[str, str] | None
    inner_period: float | None
    chunk: tuple[int, int] | None


class RenderKeywords(TypedDict, total=False):
    """Keywords of Gymnasium environments."""

    render_mode: str | None


class RegulateParameters(TypedDict, total=False):
    """Numbers of the task to rest at the origin."""

    position_cost: Varied
    velocity_cost: Varied
    effort_cost: Varied
    bound: Varied


class SwingUpParameters(TypedDict, total=False):
    """Numbers of the task to stand upright."""

    velocity_cost: Varied
    effort_cost: Varied


class OscillatorParameters(TypedDict, total=False):
    omega2: Varied
    m: Varied
    k: Varied


class PendulumParameters(TypedDict, total=False):
    omega2: Varied


class DuffingParameters(TypedDict, total=False):
    alpha: Varied
    beta: Varied


class Parameters(OscillatorParameters, DuffingParameters, RegulateParameters, total=False):
    """Parameters of all systems of the catalogue and their tasks."""


class OscillatorKeywords(EngineKeywords, StartKeywords, OscillatorParameters, RegulateParameters, RenderKeywords, total=False):
    """Keywords of the single environment."""


class PendulumKeywords(EngineKeywords, StartKeywords, PendulumParameters, SwingUpParameters, RenderKeywords, total=False):
    """Keywords of the single environment."""


class DuffingKeywords(EngineKeywords, StartKeywords, DuffingParameters, RegulateParameters, RenderKeywords, total=False):
    """Keywords of the single environment."""


class OscillatorVectorKeywords(OscillatorKeywords, BatchKeywords, total=False):
    """Keywords of the vector environment."""


class PendulumVectorKeywords(PendulumKeywords, BatchKeywords, total=False):
    """Keywords of the vector environment."""


class DuffingVectorKeywords(DuffingKeywords, BatchKeywords, total=False):
    """Keywords of the vector environment."""


class SingleKeywords(EngineKeywords, StartKeywords, TaskKeywords, Parameters, total=False):
    """Keywords of single environments of any system of the catalogue, without ``render_mode``."""


class VectorKeywords(SingleKeywords, BatchKeywords, total=False):
    """Keywords of vector environments of any system of the catalogue, without ``render_mode``."""


class ClassicKeywords(EngineKeywords, TaskKeywords, RenderKeywords, total=False):
    """Keywords of all twins of Gymnasium's classic control."""

    starts: str


class ClassicCartPoleKeywords(ClassicKeywords, total=False):
    """Keywords of the single twin, with the constants of its system."""

    gravity: Varied
    masscart: Varied
    masspole: Varied
    length: Varied
    force_mag: Varied


class ClassicPendulumKeywords(ClassicKeywords, total=False):
    """Keywords of the single twin, with the constants of its system."""

    g: Varied
    m: Varied
    l: Varied


class ClassicMountainCarKeywords(ClassicKeywords, total=False):
    """Keywords of the single twin, with the constants of its system."""

    force: Varied
    gravity: Varied
    goal_velocity: Varied


class ClassicMountainCarContinuousKeywords(ClassicKeywords, total=False):
    """Keywords of the single twin, with the constants of its system."""

    power: Varied
    goal_velocity: Varied


class ClassicAcrobotKeywords(ClassicKeywords, total=False):
    """Keywords of the single twin, with the constants of its system."""

    m1: Varied
    m2: Varied
    l1: Varied
    lc1: Varied
    lc2: Varied
    moi: Varied


class ClassicCartPoleVectorKeywords(ClassicCartPoleKeywords, BatchKeywords, total=False):
    """Keywords of the vector environment."""


class ClassicPendulumVectorKeywords(ClassicPendulumKeywords, BatchKeywords, total=False):
    """Keywords of the vector environment."""


class ClassicMountainCarVectorKeywords(ClassicMountainCarKeywords, BatchKeywords, total=False):
    """Keywords of the vector environment."""


class ClassicMountainCarContinuousVectorKeywords(ClassicMountainCarContinuousKeywords, BatchKeywords, total=False):
    """Keywords of the vector environment."""


class ClassicAcrobotVectorKeywords(ClassicAcrobotKeywords, BatchKeywords, total=False):
    """Keywords of the vector environment."""


class CustomTaskKeywords(
    EngineKeywords, StartKeywords, OscillatorParameters, DuffingParameters, RenderKeywords, total=False
):
    """Keywords of environments whose task is a function: all but those of tasks, buffers and ``autoreset_mode``."""

    max_episode_steps: float | None
    observe: Sequence[str] | None
    start: Mapping[str, Any] | None
    copy: bool


class LoopKeywords(TypedDict, total=False):
    """Timing and noise of environments of linear plants; ``libration.LinearLoops`` documents them."""

    period: float | None
    latency: Any
    output_latency: Any
    jitter: Any
    skew: float | None
    loss: float | None
    missing: str | None
    cost_weights: Any
    measurement_noise: Any
    disturbance: Any
    noise: bool
    threads: int
