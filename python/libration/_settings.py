"""Conversion of keywords to settings of the engine."""

from __future__ import annotations

import difflib
import math
import numbers
import sys
import warnings
from typing import Any, Container, Iterable, Mapping, Sequence

from ._native import _systems
from ._presets import Preset

AUTORESET = ("NextStep", "SameStep", "Disabled")

MOST_SUBSTEPS = 1000
"""Largest number of substeps in the search for whole latencies."""

MANY_SUBSTEPS = 20
"""Substeps above which a warning says what they cost."""


_FORMER = {
    "float": "dtype",
    "every": "save_every",
    "count": "num_trajectories",
    "environments": "num_envs",
    "limit": "max_episode_steps",
    "lam": "gae_lambda",
    "log_probabilities": "log_probs",
}
"""Names of keywords in former versions and in files, with those that they have here."""


LAW_SYNONYMS = {name: "gaussian" for name in ("normal", "norm", "gauss", "gaus", "randn", "n")} | {
    name: "uniform" for name in ("rectangular", "rect", "flat", "rand", "equal", "u")
}
"""Other names of laws, of NumPy, SciPy and textbooks."""


def nearest(name: str, known: Iterable[str], synonyms: Mapping[str, str] = _FORMER) -> str:
    """Return a hint for an unknown name; the same thing by another name comes before one that is spelled alike."""
    known = sorted(known)
    meant = synonyms.get(name, synonyms.get(name.lower()))
    near = [meant] if meant in known else difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"{hint}known are {', '.join(known)}"


def shown(value: Any) -> str:
    """Return a value as text on one line, of at most 60 characters."""
    return " ".join(repr(value).split())[:60]


def number(name: str, value: Any, allowed: str, holds=math.isfinite) -> float:
    """Return ``value`` as a float.

    Raises
    ------
    TypeError
        If it is not a real number.
    ValueError
        If it is not allowed.
    """
    if getattr(value, "shape", None) == () and hasattr(value, "item"):
        # An array of no dimensions is a number.
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name} must be a number, not {type(value).__name__}")
    try:
        value = float(value)
    except OverflowError:
        # An integer or a fraction may be larger than any float.
        value = math.inf if value > 0 else -math.inf
    if math.isnan(value) or not holds(value):
        raise ValueError(f"{name} is {value!r}, but it must be {allowed}")
    return value


def positive(name: str, value: Any) -> float:
    return number(name, value, "finite and greater than 0", lambda x: 0 < x < math.inf)


def count(name: str, value: Any, least: int, most: int) -> int:
    """Return ``value`` as an int in a range."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        raise TypeError(f"{name} must be an integer, not {type(value).__name__}")
    number = int(value)
    if not least <= number <= most:
        raise ValueError(f"{name} is {number}, but it must be {least} to {most}")
    return number


def is_several(value: Any) -> bool:
    """Whether ``value`` is a sequence, but not a string or bytes."""
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes, bytearray))


def ends(name: str, value: Any, least: float = -math.inf) -> tuple[float, float]:
    """Return the ends of a range; a number has two equal ends."""
    if getattr(value, "shape", ()) != ():
        # Of parameters of a system an array has a number for each environment, and a pair might be taken for that.
        raise TypeError(f"{name} is an array, but it must be a number or have two ends, like (0.0, 0.1) or Uniform(0, 0.1)")
    # Scalars of NumPy have a method of this name.
    if hasattr(value, "std") and not hasattr(value, "shape") and getattr(value, "ends", None) is None:
        raise ValueError(f"{name} is {value!r}, but it must be a number or have two ends, like Uniform(0, 0.1)")
    # A uniform distribution between two ends.
    value = getattr(value, "ends", None) or value
    pair = value if is_several(value) else (value, value)
    if len(pair) != 2:
        raise ValueError(f"{name} has {len(pair)} numbers, but it must have one or two")
    allowed = "finite" if least == -math.inf else f"finite and at least {least:g}"
    low, high = (number(name, x, allowed, lambda x: least <= x < math.inf and x > -math.inf) for x in pair)
    if low > high:
        raise ValueError(f"{name} is from {low!r} to {high!r}, but low must be at most high")
    return low, high


def law(name: str, value: Any) -> tuple[str, float]:
    """Return a distribution and its standard deviation."""
    if value is None:
        return "gaussian", 0.0
    if hasattr(value, "std") and not hasattr(value, "shape"):
        # A distribution of :mod:`libration.perturbations`.
        if value.std is None or getattr(value, "mean", 0.0) != 0.0:
            like = "Uniform" if type(value).__name__ == "Uniform" else "Gaussian"
            raise ValueError(f"{name} is {value!r}, but it must be a distribution around zero, like {like}(0.05)")
        value = (type(value).__name__.lower(), value.std)
    if is_several(value):
        if len(value) != 2 or not isinstance(value[0], str):
            raise ValueError(f"{name} is {value!r}, but it must be like ('gaussian', 0.05)")
        kind, rms = value
        if kind not in ("gaussian", "uniform"):
            raise ValueError(f"law of {name} is {kind!r}: {nearest(kind, ('gaussian', 'uniform'), LAW_SYNONYMS)}")
    else:
        kind, rms = "gaussian", value
    at_least_zero = lambda x: 0 <= x < math.inf  # noqa: E731
    return kind, number(name, rms, "finite and at least 0", at_least_zero)


def _steps(seconds: tuple[float, float], dt: float) -> list[int] | None:
    """Return latencies in steps of ``dt``, if they are whole numbers."""
    # ``dt`` may underflow, and the number of steps may overflow.
    exact = [x / dt if dt > 0 else math.inf for x in seconds]
    if math.inf in exact:
        return None
    whole = [round(x) for x in exact]
    # The quotient of two doubles is accurate to some 1e-16; 1e-9 of a step is no intended fraction.
    near = all(abs(x - n) <= 1e-9 * max(1.0, abs(x)) for x, n in zip(exact, whole))
    return whole if near else None


def inner_count(dt: float, inner_period: float | None, substeps: int | None, used: int = 1) -> int:
    """Return how many periods of the inner controller there are between two actions, at least the number of used actions of a chunk."""
    if inner_period is None:
        if substeps is not None and substeps % used:
            raise ValueError(f"substeps is {substeps}, but it must be a multiple of the {used} used actions of a chunk")
        return used
    period = positive("inner_period", inner_period)
    parts = _steps((dt, dt), period)
    if parts is None or not 1 <= parts[0] <= MOST_SUBSTEPS:
        raise ValueError(f"inner_period is {period!r} s, but dt = {dt!r} s must be 1 to {MOST_SUBSTEPS} whole periods")
    if substeps is not None and substeps % parts[0]:
        raise ValueError(f"substeps is {substeps}, but it must be a multiple of the {parts[0]} periods of the inner controller")
    return parts[0]


def parts(dt: float, named: dict[str, tuple[float, float]]) -> tuple[list[float], dict[str, list[int]]] | None:
    """Return the lengths of as few steps as latencies require, and latencies in these steps; None for latencies that are drawn.

    A command arrives at the beginning of a step, and an observation shows the beginning of one.
    """
    # The number of periods may overflow; the engine keeps 4096 steps.
    if any(low != high or not low <= 4096 * dt for low, high in named.values()):
        return None
    late = {name: divmod(low, dt) for name, (low, _) in named.items()}
    # The time within a period at which a command arrives, or that an observation shows; 1e-9 of a period is no intended fraction.
    rest = {name: part if name == "action_delay" else dt - part for name, (_, part) in late.items()}
    cuts: list[float] = [0.0]
    for time in sorted(rest.values()):
        if 1e-9 * dt < time < (1 - 1e-9) * dt and time - cuts[-1] > 1e-9 * dt:
            cuts.append(time)
    lengths = [end - begin for begin, end in zip(cuts, [*cuts[1:], dt])]
    steps = {}
    for name, (periods, _) in late.items():
        place = min(range(len(cuts) + 1), key=lambda i: abs([*cuts, dt][i] - rest[name]))
        whole = int(periods) * len(cuts)
        steps[name] = [whole + (place if name == "action_delay" else len(cuts) - place)] * 2
        if steps[name][0] > 4096:
            return None
    return lengths, steps


def equal_steps(
    dt: float, tried: Iterable[int], named: dict[str, tuple[float, float]]
) -> tuple[int, dict[str, list[int]]] | None:
    """Return the first of these numbers of equal steps for which latencies are whole steps, and latencies in these steps."""
    for parts in tried:
        found = {name: _steps(seconds, dt / parts) for name, seconds in named.items()}
        steps = {name: late for name, late in found.items() if late is not None}
        if len(steps) == len(named):
            return parts, steps
    return None


def delays(
    dt: float, substeps: int | None, named: dict[str, tuple[float, float]], multiple: int = 1
) -> tuple[int, dict[str, list[int]]]:
    """Return the number of substeps, and latencies in substeps."""
    tried = range(multiple, MOST_SUBSTEPS + 1, multiple) if substeps is None else (substeps,)
    if (equal := equal_steps(dt, tried, named)) is not None:
        parts, steps = equal
        for name, (_, most) in steps.items():
            if most > 4096:
                raise ValueError(
                    f"{name} is {named[name][1]!r} s, which is {most:.6g} steps of {dt / parts:g} s, "
                    "but it must be at most 4096 of them"
                )
        return equal
    alone = [
        name
        for name, seconds in named.items()
        if all(_steps(seconds, dt / parts) is None for parts in tried)
    ]
    what = " and ".join(
        f"{name} is {low!r} s" if low == high else f"{name} is from {low!r} to {high!r} s"
        for name, (low, high) in named.items()
        if name in (alone or named)
    )
    of = f"dt/{substeps}" if substeps else f"dt/n with n up to {MOST_SUBSTEPS}"
    raise ValueError(
        f"{what}, but it must be whole steps of the integrator, {of} (dt is {dt!r} s)"
    )


OPTIONS = (
    "num_envs",
    "max_episode_steps",
    "autoreset_mode",
    "integrator",
    "dt",
    "substeps",
    "action_delay",
    "observation_delay",
    "jitter",
    "skew",
    "observation_noise",
    "max_action",
    "start_position",
    "start_velocity",
    "observe",
    "reward",
    "terminated",
    "start",
    "project",
    "actions",
    "targets",
    "inner",
    "inner_period",
    "chunk",
    "inference",
    "inference_mode",
    "dtype",
    "threads",
    "copy",
    "buffers",
    "parameter_infos",
    "render_mode",
)

TASK_OPTIONS = ("observe", "reward", "terminated", "start", "project", "actions", "targets", "inner", "inner_period")
"""Options of tasks by expressions."""

OF_SYSTEMS = (*TASK_OPTIONS, "chunk")
"""Options of environments of systems by equations, which presets do not have."""

CATALOGUE = {name: tuple(entry[0] for entry in all) for name, _, _, _, all in _systems()}
"""Parameters of each system."""


def native(preset: Preset, given: dict[str, Any]) -> dict[str, Any]:
    """Return the settings of environments of the catalogue in the format of the engine.

    Raises
    ------
    TypeError, ValueError
        For the first invalid keyword; the message has its name, its value and the allowed values.
    """
    given = dict(given)
    refuse_of_preset(preset, given)
    parameters = given.pop("parameters")
    of_system = CATALOGUE[preset.system]
    for name in OF_SYSTEMS:
        del given[name]
    system = {name: parameters[name] for name in of_system if name in parameters}
    if len(alone := {"m", "k"} & set(system)) == 1:
        raise TypeError(f"{alone.pop()} is given alone, but m and k must be given together")
    if not {"m", "k"} & set(system):
        system = {**preset.parameters, **system}
    system = {name: number(name, value, "finite") for name, value in system.items()}
    costs = {**preset.costs, **{k: v for k, v in parameters.items() if k in preset.costs}}
    task = []
    for name, value in costs.items():
        if name == "bound":
            task.append(number(name, value, "greater than 0", lambda x: x > 0))
        else:
            task.append(number(name, value, "finite"))
    for name in ("dt", "max_episode_steps", "max_action", "start_position", "start_velocity"):
        given[name] = getattr(preset, name) if given[name] is None else given[name]
    settings = common(given)
    most = number("max_action", given["max_action"], "greater than 0", lambda x: x > 0)
    settings["subject"] = {
        "catalogued": (preset.system, list(system.items())),
        "task": (preset.task, task),
        "start": [ends(name, given[name]) for name in ("start_position", "start_velocity")],
        "saturation": most,
        "noise": law("observation_noise", given["observation_noise"]),
    }
    return settings


def warn_of(substeps: int, dt: float, late: dict[str, tuple[float, float]]) -> None:
    """Warn of latencies that need many steps of the integrator, with those nearby that need few."""
    step = dt / MANY_SUBSTEPS
    near = {name: sorted({round(x / step) * step for x in pair}) for name, pair in late.items() if _steps(pair, dt) is None}
    told = "; ".join(f"{name} of {' to '.join(f'{x:.6g}' for x in values)} s" for name, values in near.items())
    warnings.warn(
        f"each step takes {substeps} substeps, so that all latencies are whole steps of {dt / substeps:.6g} s; multiples of dt = {dt:.6g} s need "
        f"one, multiples of {step:.6g} s at most {MANY_SUBSTEPS}: {told}",
        stacklevel=2,
    )


def refuse_others(given: Iterable[str], taken: Container[str], known: Iterable[str]) -> None:
    """Raise a TypeError for the first keyword that is not taken."""
    for name in given:
        if name == "render_mode":
            raise TypeError("unexpected keyword argument 'render_mode': it belongs to VectorEnv and to gymnasium.make, which draw")
        # An option here belongs to another class and has no effect.
        if name not in taken:
            raise TypeError(f"unexpected keyword argument {name!r}: {nearest(name, known)}")


def refuse_of_preset(preset: Preset, given: Mapping[str, Any]) -> None:
    """Raise a TypeError for the first keyword that environments of a preset do not have, among parameters and options."""
    taken = {*CATALOGUE[preset.system], *preset.costs}
    refuse_others(given["parameters"], taken, [*(name for name in OPTIONS if name not in OF_SYSTEMS), *taken])
    for name in OF_SYSTEMS:
        if given[name] is not None:
            raise TypeError(f"{name} belongs to environments of a System, not to {preset.name!r}")


_NORMAL = {"float32": (2.0**-126, (2 - 2.0**-23) * 2.0**127), "float64": (sys.float_info.min, sys.float_info.max)}
"""The smallest and the largest normal number of each float type."""


def check_step(name: str, dt: float, substeps: int, dtype: str) -> None:
    """Raise a ValueError for a time step that is no normal number of the float type, of which rounding leaves few digits or none."""
    low, high = _NORMAL.get(dtype, (0.0, math.inf))
    if not low <= dt / substeps <= high:
        steps = f", with {substeps} substeps {dt / substeps!r} s," if substeps > 1 else ","
        raise ValueError(f"{name} is {dt!r} s{steps} but a step of the integrator must be {low:.3g} to {high:.3g} s in {dtype}")


def check_within_episode(name: str, delay: tuple[float, float], dt: float, steps: Any) -> None:
    """Fail if a delay is as long as an episode: milliseconds that were given as seconds, as a rule."""
    count = float(steps) if isinstance(steps, numbers.Real) else math.nan
    if not 0.0 < count < math.inf:
        return
    lasts = count * dt
    # A range may end somewhat later than a short episode.
    seconds = delay[1] if delay[1] >= 2 * lasts else delay[0]
    # A delay that is too long in milliseconds as well has another error.
    if seconds / 1000 < lasts <= seconds:
        meant = f"did you mean {seconds / 1000:.6g} ({seconds:.6g} ms)?"
        raise ValueError(f"{name} is {seconds:.6g} s, but an episode lasts {lasts:.6g} s; {meant}")


def common(given: dict[str, Any], inner_period: float | None = None, used: int = 1) -> dict[str, Any]:
    """Return the settings that environments of all systems have."""
    dt = positive("dt", given["dt"])
    substeps = given["substeps"]
    if substeps is not None:
        substeps = count("substeps", substeps, 1, 1_000_000)
        positive("dt/substeps", dt / substeps)
    # An identified loop gives its range of delays for the steps of these environments.
    stated = {
        name: given[name].action_delay(dt, substeps) if hasattr(given[name], "action_delay") else given[name]
        for name in ("observation_delay", "action_delay")
    }
    late = {name: ends(name, value, least=0.0) for name, value in stated.items()}
    for name, delay in late.items():
        check_within_episode(name, delay, dt, given["max_episode_steps"])
    asked, periods = substeps, inner_count(dt, inner_period, substeps, used)
    lengths: list[float] = []
    split = None
    if asked is None and periods == 1 and equal_steps(dt, range(1, MANY_SUBSTEPS + 1), late) is None:
        split = parts(dt, late)
    if split is not None:
        # A few long steps that begin where latencies end take the place of many that are equal.
        lengths, late_steps = split
        substeps = len(lengths)
    else:
        substeps, late_steps = delays(dt, substeps, late, periods)
        if asked is None and substeps > max(MANY_SUBSTEPS, periods):
            warn_of(substeps, dt, late)
    limit = given["max_episode_steps"]
    # -1 is Gymnasium's word for no limit.
    unlimited = isinstance(limit, numbers.Real) and limit in (math.inf, -1)
    limit = None if unlimited else count("max_episode_steps", limit, 1, 2**32 - 1)
    integrator, dtype = given["integrator"], given["dtype"]
    check_step("dt", dt, substeps, str(dtype))
    if not isinstance(integrator, str):
        raise TypeError(f"integrator must be a string, not {type(integrator).__name__}")
    return {
        "num_envs": count("num_envs", given["num_envs"], 1, 2**40),
        "dtype": str(dtype),
        "threads": count("threads", given["threads"], 0, 1024),
        "autoreset": given["autoreset_mode"],
        "integrator": integrator,
        "dt": dt / substeps,
        "substeps": substeps,
        "limit": limit,
        "observation_delay": late_steps["observation_delay"],
        "action_delay": late_steps["action_delay"],
        "jitter": law("jitter", given["jitter"]),
        "skew": law("skew", given["skew"]),
        "levels": [],
        "lengths": lengths,
        "parameter_infos": given["parameter_infos"],
        "ranges": {name: ranges for name, ranges in late.items() if ranges[0] != ranges[1]},
    }
