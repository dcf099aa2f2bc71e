"""Adapters of other simulators: each is a step in minimal coordinates, without memory of earlier calls."""

from .host import Host

__all__ = ["Host", "delay_audit", "gymnasium_host", "mujoco_host", "mujoco_servos"]


def __getattr__(name: str) -> object:
    """Import an adapter when it is used, since each needs a package of its own."""
    if name == "mujoco_host":
        from .mujoco import mujoco_host

        return mujoco_host
    if name == "mujoco_servos":
        from .mujoco_servos import mujoco_servos

        return mujoco_servos
    if name == "gymnasium_host":
        from .gymnasium import gymnasium_host

        return gymnasium_host
    if name == "delay_audit":
        from .mujoco_delays import delay_audit

        return delay_audit
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
