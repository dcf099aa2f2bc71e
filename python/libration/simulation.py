"""Simulation of one or several trajectories."""

from __future__ import annotations

import itertools
import math
import warnings
from typing import Any, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._requests import coordinates, integrator_name, loop_request, system_request, whole
from ._html import table
from ._plots import Panels, plot_trajectory
from ._keywords import check_keywords
from ._settings import count as _whole_between, nearest, number
from .ensemble import Ensemble
from .systems import CustomSystem, known

__all__ = ["Trajectory", "simulate"]

MOST_STEPS: int = _native._MOST_STEPS

_FLOATS = {"f64": np.float64, "f32": np.float32}


class Trajectory(Mapping[str, np.ndarray]):
    """Columns of one or several trajectories: ``step``, ``t``, coordinates, velocities and ``energy``; ``trajectory`` for several.

    ``trajectory["q"]`` is the coordinate ``q``, and ``trajectory["q'"]`` its velocity. Columns of ``bf16`` are arrays of ``float32``, with the exact values.
    """

    def __init__(
        self, columns: dict[str, NDArray[Any]], units: dict[str, str], ended: dict[str, Any]
    ) -> None:
        self._columns = columns
        self.units: Mapping[str, str] = units
        """Unit of each column, if known; ``1`` for a column without unit."""
        self.stopped: dict[str, Any] | None = ended if "step" in ended else None
        """First ``step`` of a single trajectory that is not finite, its ``t`` in s, and the ``reason``, with a remedy if the step is
        unstable."""
        self.not_finite: dict[str, Any] | None = ended if "count" in ended else None
        """For several trajectories: ``count`` of those that are not finite in the end, the ``first`` ten of them, and the ``reason``,
        if known."""
        self.newton_residual: dict[str, Any] | None = ended.get("newton_residual")
        """Of an implicit integrator that iterates: the ``largest`` correction by a further Newton step as a part of the change of a state, its
        ``step`` and ``t``, and the numbers of ``examined`` and ``exceeding`` steps. A run with more than 1e-6 warns: its numbers are wrong."""
        if "error" in ended:
            warnings.warn(ended["error"], RuntimeWarning, stacklevel=3)

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._columns:
            raise KeyError(f"no column {name!r}: {nearest(str(name), self._columns)}")
        return self._columns[name]

    def __iter__(self) -> Any:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def t(self) -> NDArray[np.float64]:
        """Times in s, ``(rows,)``."""
        return self["t"]

    @property
    def q(self) -> NDArray[Any]:
        """Copy of the coordinates, ``(rows, dimension)``."""
        return self._stacked("")

    @property
    def v(self) -> NDArray[Any]:
        """Copy of the velocities of the coordinates, ``(rows, dimension)``."""
        return self._stacked("'")

    @property
    def energy(self) -> NDArray[Any]:
        """Energies per unit mass, ``(rows,)``, in ``units["energy"]``."""
        return self["energy"]

    def _stacked(self, prime: str) -> NDArray[Any]:
        found = [self[name + prime] for name in self if f"{name}'" in self]
        if not found:
            raise AttributeError(f"no column is a coordinate with a velocity: there are {', '.join(self)}")
        return np.stack(found, axis=1)

    def to_pandas(self) -> Any:
        """Return a ``pandas.DataFrame`` of all columns."""
        import pandas  # type: ignore[import-untyped]

        return pandas.DataFrame(dict(self))

    def plot(self) -> Panels:
        """Draw all columns over time by matplotlib, in a panel for each unit, and return the axes of the panels.

        ``trajectory.plot()[0].figure.savefig("trajectory.png")`` writes the figure to a file.

        Raises
        ------
        ImportError
            Without matplotlib: ``pip install 'libration[plots]'``.
        """
        return plot_trajectory(self, self.units, self._end(), None if self.stopped is None else self.stopped["t"])

    def _end(self) -> str:
        """Return what became of states that are not finite."""
        if self.stopped is not None:
            return f": not finite from t = {self.stopped['t']:.6g} s"
        return "" if self.not_finite is None else f": {self.not_finite['count']} not finite in the end"

    def _repr_html_(self) -> str:
        count = int(self["trajectory"].max()) + 1 if "trajectory" in self else 1
        what = "Trajectory" if count == 1 else f"{count} trajectories"
        names = [name for name in self if name != "trajectory"]
        rows = [(name, self.units.get(name, ""), *_extent(self[name].astype(float))) for name in names]
        head = ("column", "unit", "first", "last", "least", "largest")
        return f"<p>{what}, {len(self['t'])} rows{self._end()}</p>{table(head, rows, 2)}"

    def __repr__(self) -> str:
        return f"<Trajectory of {len(self['t'])} rows: {', '.join(self)}>"


def _extent(column: NDArray[np.float64]) -> tuple[float, ...]:
    """Return the first, last, least and largest number; of the last two without those that are not finite."""
    finite = column[np.isfinite(column)]
    ends = (math.nan, math.nan) if not len(finite) else (float(finite.min()), float(finite.max()))
    return (float(column[0]), float(column[-1]), *ends)


@check_keywords
def simulate(
    system: Any,
    *,
    integrator: str,
    dt: float,
    steps: int,
    q: ArrayLike | None = None,
    v: ArrayLike | None = None,
    dtype: Any = "float64",
    save_every: int = 1,
    num_trajectories: int | None = None,
    spread: float = 0.0,
    threads: int = 0,
    feedback: Any = None,
    latency: Any = None,
    jitter: Any = None,
    skew: Any = None,
    time_stamps: ArrayLike | None = None,
    seed: int = 0,
) -> Trajectory:
    """Return one or several simulated trajectories, as ``libration simulate`` writes them.

    Parameters
    ----------
    system:
        A name, a :class:`~libration.System`, an :class:`~libration.EquationSystem`, a :class:`~libration.CustomSystem` or a function
        ``a(q, v)``. The last two accept ``integrator``, ``dt``, ``steps``, ``q``, ``v``, ``dtype`` and ``save_every`` only. The columns of a
        system by equations have the names of its states.
    integrator:
        Name from :data:`~libration.INTEGRATORS` or :data:`~libration.IMPLICIT_INTEGRATORS`.
    dt:
        Time step in s.
    steps:
        Number of steps, 1 to 2⁵³; ``save_every`` limits the number of rows.
    q, v:
        Initial positions and velocities, a number or ``(dimension,)`` (default: those of the system).
    dtype:
        Float type of every operation: ``"float64"``, ``"float32"``, ``"float16"``, a NumPy type, or ``"bfloat16"``.
    save_every:
        Distance of rows in steps; the first and the last step are always rows.
    num_trajectories, spread, threads:
        Number of trajectories, with starts from ``1 - spread`` to ``1 + spread`` times the start; number of threads (0: one per core).
    feedback:
        Gains of position and velocity, or a :class:`~libration.PD` (default: no loop). The command is an acceleration (gains in s⁻²
        and s⁻¹), or a force (N/m and N·s/m) for a system with ``m`` and ``k``.
    latency:
        Latency of commands, in s or as :class:`~libration.Steps`.
    jitter, skew:
        Distributions of steps and of clock rates: a relative standard deviation, a pair like ``("uniform", 0.1)``, or a
        :class:`~libration.Gaussian` or :class:`~libration.Uniform`.
    time_stamps:
        Time stamps of a recorded clock in s, in place of even steps.
    seed:
        Seed of all random numbers.

    Raises
    ------
    TypeError, ValueError
        For an invalid value, before any work; the message has the name of the parameter and the allowed values.
    MemoryError
        If there is not enough memory for all rows.
    """
    system = known(system)
    if isinstance(system, CustomSystem):
        wrong = {
            "num_trajectories": num_trajectories,
            "feedback": feedback,
            "latency": latency,
            "jitter": jitter,
            "skew": skew,
            "time_stamps": time_stamps,
        }
        for name, value in wrong.items():
            if value is not None:
                raise ValueError(f"{name} is given, but it requires a system of the catalogue")
        for name, value in {"spread": spread, "threads": threads, "seed": seed}.items():
            if value != 0:
                raise ValueError(f"{name} is {value!r}, but it requires a system of the catalogue")
        return _custom(system, integrator, dt, steps, q, v, _float_of(dtype), save_every)
    rows = {
        "steps": whole("steps", steps),
        "dtype": _float_of(dtype),
        "every": whole("save_every", save_every),
        "count": None if num_trajectories is None else whole("num_trajectories", num_trajectories),
        "spread": number("spread", spread, "finite"),
        "threads": whole("threads", threads, 0),
        "seed": whole("seed", seed, 0),
        "time_stamps": coordinates("time_stamps", time_stamps),
    }
    if num_trajectories is None:
        for name, value in {"spread": spread, "threads": threads}.items():
            if value != 0:
                raise ValueError(f"{name} is {value!r}, but there is one trajectory; it requires num_trajectories")
    step = integrator_name(integrator), number("dt", dt, "finite and greater than 0")
    loop = loop_request(feedback, latency, jitter, skew)
    return Trajectory(*_native._simulate(system_request(system, q, v), step, loop, rows))


_NAMES = {"float64": "f64", "float32": "f32", "float16": "f16", "bfloat16": "bf16"}


def _float_of(dtype: Any) -> str:
    """Return the engine's name of a float type."""
    name = dtype if isinstance(dtype, str) else np.dtype(dtype).name if dtype is not None else None
    if name not in _NAMES:
        raise ValueError(f"dtype is {dtype!r}: {nearest(str(name), _NAMES)}")
    return _NAMES[name]


def _finite(all: Ensemble) -> bool:
    return bool(np.isfinite(all.q).all() and np.isfinite(all.v).all())


def _custom(
    system: CustomSystem, integrator: str, dt: Any, steps: Any, q: Any, v: Any, float: str, every: Any
) -> Trajectory:
    # Python takes minutes for this many steps.
    steps, every = _whole_between("steps", steps, 1, 10**9), whole("save_every", every)
    if float not in _FLOATS:
        raise ValueError(f"dtype is {float!r}, but it must be float32 or float64 for a custom system")
    if q is None:
        raise ValueError("q is missing; a custom system has no default start")
    start = np.array([coordinates("q", q)])
    speed = None if v is None else np.array([coordinates("v", v)])
    one = Ensemble(system, integrator=integrator, dt=dt, q=start, v=speed, dtype=_FLOATS[float])
    if steps > MOST_STEPS:
        raise ValueError(f"steps is {steps}, but it must be 1 to {MOST_STEPS}")
    kept = itertools.chain([0], range(every, steps, every), [steps])
    steps_kept: list[int] = []
    positions: list[NDArray[Any]] = []
    velocities: list[NDArray[Any]] = []
    energies, ended = [], {}
    for step in kept:
        one.advance(step - one.step)
        if not _finite(one):
            # Repeats the steps since the last row one by one.
            again = Ensemble(
                system, integrator=integrator, dt=dt, q=positions[-1:], v=velocities[-1:], dtype=one.dtype
            )
            while _finite(again) and again.step < step - steps_kept[-1]:
                again.advance(1)
            # A force that is not deterministic may stay finite in the repetition.
            step = steps_kept[-1] + again.step
            ended = {"step": step, "t": step * one.dt, "reason": "the state is not finite"}
            break
        steps_kept.append(step)
        positions.append(one.q[0])
        velocities.append(one.v[0])
        energies.append(math.nan if system.energy is None else one.energy[0])
    columns: dict[str, NDArray[Any]] = {"step": np.array(steps_kept, np.uint64)}
    columns["t"] = columns["step"] * one.dt
    names = ["q"] if start.shape[1] == 1 else [f"q{i}" for i in range(start.shape[1])]
    for prime, rows in (("", positions), ("'", velocities)):
        for i, name in enumerate(names):
            columns[name + prime] = np.array([row[i] for row in rows], one.dtype)
    columns["energy"] = np.array(energies, one.dtype)
    return Trajectory(columns, {"step": "1", "t": "s"}, ended)
