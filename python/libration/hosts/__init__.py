"""Adapters of other simulators: each is a step in minimal coordinates, without memory of earlier calls."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .host import Host

if TYPE_CHECKING:
    from ._mujoco_servos import mujoco_servos
    from .fmu import fmu_host, fmu_plant
    from .gymnasium import gymnasium_host
    from .jax import jax_host
    from .mujoco import mujoco_host
    from .mujoco_delays import delay_audit

# Each adapter is imported when it is used, since it needs a package of its own.
_ADAPTERS = {
    "delay_audit": "mujoco_delays",
    "fmu_host": "fmu",
    "fmu_plant": "fmu",
    "gymnasium_host": "gymnasium",
    "jax_host": "jax",
    "mujoco_host": "mujoco",
    "mujoco_servos": "_mujoco_servos",
}

__all__ = [
    "Host",
    "delay_audit",
    "fmu_host",
    "fmu_plant",
    "gymnasium_host",
    "jax_host",
    "mujoco_host",
    "mujoco_servos",
]


def __getattr__(name: str) -> Any:
    if name in _ADAPTERS:
        return getattr(import_module(f".{_ADAPTERS[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
