"""Presets as systems by equations, for numbers that vary.

The expressions compute the operations of the compiled environments: a parameter that varies in a range of one number leaves every bit.
"""

from __future__ import annotations

import numbers
from math import inf
from typing import Any, Mapping

from . import _native
from ._episode_numbers import episode_number, is_varied, scaled_law
from ._presets import Preset
from ._settings import CATALOGUE, count, ends, law, native, refuse_of_preset
from ._tasks import native_equations
from .equations import EquationSystem

_RANGES = ("jitter", "observation_noise")


def has_varied(given: Mapping[str, Any]) -> bool:
    """Whether a number of the environments of a preset varies."""
    ranges = any(_is_range(given[name]) for name in _RANGES)
    answers = given["inference"] is not None or given["inference_mode"] != "asynchronous"
    return ranges or answers or any(is_varied(x) for x in [given["max_action"], *given["parameters"].values()])


def _is_range(value: Any) -> bool:
    last = value[-1] if isinstance(value, (tuple, list)) and value else value
    return getattr(last, "ends", None) is not None


def native_varied(preset: Preset, given: dict[str, Any]) -> dict[str, Any]:
    """Return the settings of environments of a preset with numbers that vary, in the format of the engine.

    Raises
    ------
    TypeError, ValueError
        As for environments of constants.
    """
    parameters = given["parameters"]
    of_system = CATALOGUE[preset.system]
    refuse_of_preset(preset, given)
    mass = {"m", "k"} & set(parameters)
    if len(mass) == 1:
        raise TypeError(f"{mass.pop()} is given alone, but m and k must be given together")
    if mass and "omega2" in parameters:
        raise TypeError("omega2 is given with m and k, but it must be given alone")
    own = {name: 1.0 for name in ("m", "k")} if mass else {**preset.parameters}
    starts = {
        "q": given["start_position"] if given["start_position"] is not None else preset.start_position,
        "q'": given["start_velocity"] if given["start_velocity"] is not None else preset.start_velocity,
    }
    starts = {state: ends(name, starts[state]) for state, name in (("q", "start_position"), ("q'", "start_velocity"))}
    task: dict[str, Any] = dict(zip(("observe", "reward", "terminated"), _native._task_expressions(preset.task)))
    costs = dict(preset.costs)
    num_envs = count("num_envs", given["num_envs"], 1, 2**40)
    _check_ends(preset, given, num_envs)
    bound = parameters.get("bound", costs.get("bound"))
    if isinstance(bound, numbers.Real) and bound == inf:
        # No comparison ends an episode.
        task["terminated"] = []
        costs.pop("bound")
        parameters = {name: value for name, value in parameters.items() if name != "bound"}
    system = EquationSystem(
        acceleration=dict(_native._commanded((preset.system, list(own.items())))[0]),
        parameters={**own, **costs},
        inputs=["u"],
        task={**task, "start": starts},
        name=preset.name,
    )
    defaults = {name: getattr(preset, name) for name in ("dt", "max_episode_steps", "max_action")}
    given = {**given, **{name: value for name, value in defaults.items() if given[name] is None}}
    given |= {"start_position": None, "start_velocity": None, "parameters": parameters}
    return native_equations(system, given)[1]


def _check_ends(preset: Preset, given: Mapping[str, Any], num_envs: int) -> None:
    """Raise the errors that environments of constants have at the ends of all ranges."""
    law("observation_noise", scaled_law("observation_noise", given["observation_noise"])[0])
    numbers_of = {name: episode_number(name, value, num_envs, "a number", lambda x: True) for name, value in given["parameters"].items()}
    for end in (min, max):
        # Of a normal distribution the mean, also of the logarithm.
        constants = {name: values[0] if kind in ("gaussian", "lognormal") else end(values) for name, (kind, values) in numbers_of.items()}
        plain = {"parameters": constants, "num_envs": 1, "jitter": 0.0, "observation_noise": 0.0, "max_action": None}
        _native.Batch()._set_up(native(preset, {**given, **plain, "action_delay": 0.0, "observation_delay": 0.0}), 0)
