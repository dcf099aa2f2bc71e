"""Libration: what integrators, time steps, floats, latency, jitter and clocks do to a simulated system.

The engine's environments are :class:`Environments`; with Gymnasium installed they are registered as ``libration/Oscillator-v0``,
``libration/Pendulum-v0`` and ``libration/Duffing-v0``, for ``gymnasium.make`` and ``gymnasium.make_vec``.
"""

from __future__ import annotations

from ._native import __version__
from . import policies
from .environments import Environments
from .rollout import Rollout

__all__ = ["Environments", "Rollout", "__version__", "policies"]


try:
    from .envs import VectorEnv, register
except ModuleNotFoundError as error:
    # Gymnasium is an extra.
    if error.name is None or error.name.split(".")[0] != "gymnasium":
        raise
else:
    register()
    __all__.append("VectorEnv")
