"""Descriptions of simulators for the engine."""

from __future__ import annotations

from typing import Any, Iterable

import numpy as np

from ._step_functions import signals
from .hosts.host import Host, Recording


def description_of(host: Host) -> dict[str, Any]:
    """Return a host as the keys that the engine reads."""
    described: dict[str, Any] = {
        "title": host.title,
        "state": host.state.tolist(),
        "action": host.action.tolist(),
        "dt": host.dt,
        "states": signals("states", host.states),
        "inputs": signals("inputs", host.inputs),
        "integrator": host.integrator,
        "version": host.version,
        "notes": list(host.notes),
        "validity": list(host.validity),
        "energy": host.energy is not None,
    }
    if host.positions:
        described["pairs"] = [list(pair) for pair in host.positions]
        if host.mass is not None and len(host.mass) == len(host.positions):
            described["mass"] = host.mass.tolist()
        if len(host.joint_damping) == len(host.positions):
            described["joint_damping"] = [float(damping) for damping in host.joint_damping]
    if host.reference_A is not None and host.reference_B is not None:
        described["reference"] = {
            "source": host.reference_source,
            "exact": host.reference_is_exact,
            "a": host.reference_A.tolist(),
            "b": host.reference_B.tolist(),
        }
    if host.fixed_dt:
        described["fixed_dt"] = True
    for key, value in (("not_examined", host.not_examined), ("direct_inputs", [name.split(" (")[0] for name in host.direct_inputs])):
        if value:
            described[key] = list(value)
    if host.measured_inputs:
        described["measured_inputs"] = [one._asdict() for one in host.measured_inputs]
    if host.measured_observation is not None:
        described["measured_observation"] = host.measured_observation._asdict()
    if host.stray_results is not None:
        described["stray_results"] = host.stray_results._asdict()
    if host.operating_point is not None:
        described["operating_point"] = host.operating_point
    if host.delays:
        described["stated_delays"] = list(host.delays)
    if host.recordings:
        described["recordings"] = described_recordings(host.recordings)
    return described


def described_recordings(recordings: Iterable[Recording]) -> list[dict[str, Any]]:
    """Return pairs of recordings as the keys that the engine reads, without those that have numbers that are not finite."""
    return [
        {"name": name, "shape": list(first.shape), "first": first.ravel().tolist(), "second": second.ravel().tolist()}
        for name, first, second in recordings
        if np.isfinite(first).all() and np.isfinite(second).all()
    ]
