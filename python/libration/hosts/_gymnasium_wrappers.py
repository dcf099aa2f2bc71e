"""Wrappers of an environment: those that an audit keeps, and those that it leaves out."""

from __future__ import annotations

import copy
from typing import Any

import gymnasium

# They change neither actions nor observations, but rewards, pictures, records and ends of episodes.
_WITHOUT_EFFECT = (
    "Autoreset",
    "ClipReward",
    "HumanRendering",
    "NormalizeReward",
    "ObstructView",
    "OrderEnforcing",
    "PassiveEnvChecker",
    "RecordEpisodeStatistics",
    "RecordVideo",
    "RenderCollection",
    "TimeLimit",
    "TransformReward",
)
# Their observations are no function of a state: of several states, of the time, of all earlier observations, or pictures.
_NOT_AUDITED = (
    "AddRenderObservation",
    "AddWhiteNoise",
    "AtariPreprocessing",
    "FrameStackObservation",
    "GrayscaleObservation",
    "NormalizeObservation",
    "ResizeObservation",
    "TimeAwareObservation",
)


def unwrapped_copy(env: Any) -> tuple[Any, list[str], list[str]]:
    """Return a copy of an environment without the wrappers that an audit leaves out, the names of those that it keeps, and of those
    that act but are left out.

    Raises
    ------
    TypeError, ValueError
        For a value that is no environment, or an environment without a copy.
    """
    outer = _copied(env)
    inner = outer.unwrapped
    kept: list[Any] = []
    left_out = []
    layer = outer
    while layer is not inner and getattr(layer, "env", None) is not None:
        own = type(layer).__module__.startswith("gymnasium.wrappers")
        if own and type(layer).__name__ in _NOT_AUDITED:
            left_out.append(type(layer).__name__)
        elif not (own and type(layer).__name__ in _WITHOUT_EFFECT):
            kept.append(layer)
        layer = layer.env
    for above, below in zip(kept, [*kept[1:], inner]):
        if above.env is not below:
            above.env = below
    return (kept[0] if kept else inner), [type(one).__name__ for one in kept], left_out


def _copied(env: Any) -> Any:
    if isinstance(env, str):
        try:
            return gymnasium.make(env, disable_env_checker=True)
        except gymnasium.error.Error as error:
            raise ValueError(f"env is {env!r}: {' '.join(str(error).split())}") from None
    if isinstance(env, gymnasium.vector.VectorEnv):
        raise TypeError(f"env is a {type(env).__name__}, which has several environments; expected a single one")
    if not hasattr(env, "unwrapped") or not hasattr(env, "step"):
        raise TypeError(f"env must be an environment of Gymnasium or its id, not {type(env).__name__}")
    if type(env.unwrapped).__module__.partition(".")[0] == "libration":
        raise ValueError(
            f"env is {type(env.unwrapped).__name__} of Libration, whose state and time step are in the engine and no attributes; "
            "expected an environment that has both; help: libration.analyze of its system has the modes, limits and latency of its steps"
        )
    try:
        return copy.deepcopy(env)
    except Exception as error:
        raise ValueError(f"env {env} has no copy ({type(error).__name__}: {error}); help: give its id") from None
