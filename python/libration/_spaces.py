"""Spaces of Gymnasium of the environments of the engine."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np
from gymnasium.spaces import Box, Discrete

from ._episode_numbers import largest
from ._presets import Preset
from ._tasks import EquationPreset


def single_spaces(preset: Preset | EquationPreset, settings: Mapping[str, Any]) -> tuple[Box, Box | Discrete]:
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
