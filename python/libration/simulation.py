"""Trajectories: of one system, or of several copies of it."""

from __future__ import annotations

import itertools
import math
from typing import Any, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._asked import coordinates, text, told_loop, told_step, whole
from ._named import named
from ._settings import count as _whole_between, nearest, number
from .ensemble import Ensemble
from .systems import CustomSystem, known

__all__ = ["Trajectory", "simulate"]

MOST_STEPS: int = _native._MOST_STEPS

_FLOATS = {"f64": np.float64, "f32": np.float32}


class Trajectory(Mapping[str, np.ndarray]):
    """Rows of a trajectory, or of several, as columns: ``step``, ``t``, ``q0`` …, ``v0`` … and ``energy``, with ``trajectory`` where there
    are several.

    A column is had by its name. Columns of ``bf16`` are arrays of ``float32``, which hold them exactly.
    """

    def __init__(
        self, columns: dict[str, NDArray[Any]], units: dict[str, str], ended: dict[str, Any]
    ) -> None:
        self._columns = columns
        self.units: Mapping[str, str] = units
        """The unit of each column, where it is known; ``1`` if there is none."""
        self.stopped: dict[str, Any] | None = ended if "step" in ended else None
        """Of a lone trajectory that ceased to be finite: the first ``step`` that is not, its ``t`` in seconds, and the ``reason``: also why and
        what to do, where the stability of the step tells."""
        self.not_finite: dict[str, Any] | None = ended if "count" in ended else None
        """Of several trajectories: the ``count`` of those that are not finite in the end, the ``first`` ten of them, and the ``reason`` where
        it is known."""

    def __getitem__(self, name: str) -> NDArray[Any]:
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
        """Positions, ``(rows, dimension)``: a copy."""
        return self._stacked("q")

    @property
    def v(self) -> NDArray[Any]:
        """Velocities, ``(rows, dimension)``: a copy."""
        return self._stacked("v")

    @property
    def energy(self) -> NDArray[Any]:
        """Energies per unit mass, ``(rows,)``, in the unit of a velocity squared: ``units["energy"]``."""
        return self["energy"]

    def _stacked(self, letter: str) -> NDArray[Any]:
        return np.stack([self[name] for name in self if name[0] == letter and name[1:].isdigit()], axis=1)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` of all columns."""
        import pandas  # type: ignore[import-untyped]

        return pandas.DataFrame(dict(self))

    def __repr__(self) -> str:
        return f"<Trajectory of {len(self['t'])} rows: {', '.join(self)}>"


@named
def simulate(
    system: Any,
    *,
    integrator: str,
    dt: float,
    steps: int,
    q: ArrayLike | None = None,
    v: ArrayLike | None = None,
    float: str = "f64",
    every: int = 1,
    count: int | None = None,
    spread: float = 0.0,
    threads: int = 0,
    feedback: Any = None,
    latency: Any = None,
    jitter: Any = None,
    skew: Any = None,
    time_stamps: ArrayLike | None = None,
    seed: int = 0,
) -> Trajectory:
    """Simulate a trajectory, or several from starts around one: what ``libration simulate`` does.

    Parameters
    ----------
    system:
        A name, a :class:`~libration.System`, or a :class:`~libration.CustomSystem` or function ``a(q, v)``, which nothing but
        ``integrator``, ``dt``, ``steps``, ``q``, ``v``, ``float`` and ``every`` are for.
    integrator:
        One of :data:`~libration.INTEGRATORS`.
    dt:
        The time step in s.
    steps:
        How many, 1 to 2⁵³; ``every`` bounds the rows.
    q, v:
        Positions and velocities at the start, a number or ``(dimension,)``; by default those of the catalogue.
    float:
        ``"f64"``, ``"f32"``, ``"f16"`` or ``"bf16"``: of every operation.
    every:
        Rows that are kept: every so many steps, besides the first and the last.
    count, spread, threads:
        Simulate ``count`` trajectories from ``1 - spread`` to ``1 + spread`` times the start, in so many threads; 0 for all cores.
    feedback:
        Close the loop: gains of position and velocity, or a :class:`~libration.PD`. The command is an acceleration (gains in s⁻² and
        s⁻¹), or a force (N/m and N·s/m) where the system is given by ``m`` and ``k``.
    latency:
        How late commands arrive, in s or as :class:`~libration.Steps`.
    jitter, skew:
        The laws of step times and of clock rates: a relative standard deviation, a pair like ``("uniform", 0.1)``, or a
        :class:`~libration.Gaussian` or :class:`~libration.Uniform`.
    time_stamps:
        Those of a recorded clock, in s, in place of even steps.
    seed:
        Of all that is random.

    Raises
    ------
    TypeError, ValueError
        Before any work, with the name of what is wrong and what is allowed.
    MemoryError
        If all rows do not fit.
    """
    system = known(system)
    if isinstance(system, CustomSystem):
        wrong = {
            "count": count,
            "feedback": feedback,
            "latency": latency,
            "jitter": jitter,
            "skew": skew,
            "time_stamps": time_stamps,
        }
        for name, value in wrong.items():
            if value is not None:
                raise ValueError(f"{name} is given, but it is for systems of the catalogue only")
        for name, value in {"spread": spread, "threads": threads, "seed": seed}.items():
            if value != 0:
                raise ValueError(f"{name} is {value!r}, but it is for systems of the catalogue only")
        return _custom(system, integrator, dt, steps, q, v, float, every)
    if count is None:
        for name, value in {"spread": spread, "threads": threads}.items():
            if value != 0:
                raise ValueError(f"{name} is {value!r}, but there is no count of trajectories that it is for")
    columns, units, ended = _native._simulate(
        told_step(system, integrator, dt, q, v),
        told_loop(feedback, latency, jitter, skew),
        {
            "steps": whole("steps", steps),
            "float": text("float", float),
            "every": whole("every", every, 0),
            "count": None if count is None else whole("count", count, 0),
            "spread": number("spread", spread, "finite"),
            "threads": whole("threads", threads, 0),
            "seed": whole("seed", seed, 0),
            "time_stamps": coordinates("time_stamps", time_stamps),
        },
    )
    return Trajectory(columns, units, ended)


def _finite(all: Ensemble) -> bool:
    return bool(np.isfinite(all.q).all() and np.isfinite(all.v).all())


def _custom(
    system: CustomSystem, integrator: str, dt: Any, steps: Any, q: Any, v: Any, float: str, every: Any
) -> Trajectory:
    # Python takes minutes for as many.
    steps, every = _whole_between("steps", steps, 1, 10**9), whole("every", every)
    if float not in _FLOATS:
        raise ValueError(f"float is {float!r}: {nearest(float, _FLOATS)}")
    if q is None:
        raise ValueError("q is missing: a custom system has no start of its own")
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
            # Which of the steps since the last row it was.
            again = Ensemble(
                system, integrator=integrator, dt=dt, q=positions[-1:], v=velocities[-1:], dtype=one.dtype
            )
            while _finite(again) and again.step < step - steps_kept[-1]:
                again.advance(1)
            # A force that is another each time need not do so again.
            step = steps_kept[-1] + again.step
            ended = {"step": step, "t": step * one.dt, "reason": "the state is not finite"}
            break
        steps_kept.append(step)
        positions.append(one.q[0])
        velocities.append(one.v[0])
        energies.append(math.nan if system.energy is None else one.energy[0])
    columns: dict[str, NDArray[Any]] = {"step": np.array(steps_kept, np.uint64)}
    columns["t"] = columns["step"] * one.dt
    for letter, rows in (("q", positions), ("v", velocities)):
        for i in range(start.shape[1]):
            columns[f"{letter}{i}"] = np.array([row[i] for row in rows], one.dtype)
    columns["energy"] = np.array(energies, one.dtype)
    return Trajectory(columns, {"step": "1", "t": "s"}, ended)
