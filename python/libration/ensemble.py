"""Many trajectories at once, held between calls."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._asked import rows, text
from ._named import named
from ._settings import count, positive
from .systems import Program, System, known, seen

__all__ = ["Ensemble"]


class Ensemble:
    """Many trajectories of a system, stepped together and held between calls.

    Parameters
    ----------
    system:
        As in :func:`~libration.simulate`.
    integrator:
        One of :data:`~libration.INTEGRATORS` but ``"exact"``.
    dt:
        The time step in s.
    q, v:
        Where trajectories start, ``(N, dimension)``, or ``(N,)`` where there is one degree of freedom; by default at rest.
    dtype:
        ``"float64"`` or ``"float32"``: of every operation.
    threads:
        How many; 0 for as many as there are cores. What comes out does not depend on it, nor on ``N``.

    Raises
    ------
    TypeError, ValueError
        For what cannot be, with its name and what is allowed.
    MemoryError
        If there is no room.
    """

    @named
    def __init__(
        self,
        system: Any,
        *,
        integrator: str = "velocity-verlet",
        dt: float,
        q: ArrayLike,
        v: ArrayLike | None = None,
        dtype: Any = "float64",
        threads: int = 0,
    ) -> None:
        self.system = known(system)
        self.integrator = text("integrator", integrator)
        self.dt = positive("dt", dt)
        self.dtype = np.dtype(dtype)
        if self.dtype not in (np.float64, np.float32):
            raise ValueError(f"dtype is {self.dtype}, but it must be float64 or float32")
        at = rows("q", q)
        speed = np.zeros_like(at) if v is None else rows("v", v)
        if at.shape != speed.shape:
            raise ValueError(f"q has shape {at.shape} and v {speed.shape}, but they must be the same")
        if 0 in at.shape:
            raise ValueError(f"q has shape {at.shape}, but there must be a trajectory at least")
        for name, start in (("q", at), ("v", speed)):
            with np.errstate(over="ignore"):
                if not np.isfinite(start.astype(self.dtype)).all():
                    raise ValueError(f"{name} is not finite in {self.dtype}")
        threads = count("threads", threads, 0, 1024)
        self._step, self._len = 0, len(at)
        if isinstance(self.system, System):
            single = bool(self.dtype == np.float32)
            told = self.system._told()
            self._held: Any = _native.Trajectories(
                told, self.integrator, self.dt, at, speed, single, threads
            )
        else:
            self._held = Program(self.integrator, self.system)
            # Threads take turns with what is Python's.
            self._turn = threading.RLock()
            self._state = (at.astype(self.dtype), speed.astype(self.dtype))

    @property
    def step(self) -> int:
        """Steps taken."""
        return self._held._step() if isinstance(self.system, System) else self._step

    @property
    def time(self) -> float:
        """The time in s."""
        return self.step * self.dt

    @property
    def q(self) -> NDArray[Any]:
        """Positions, ``(N, dimension)``: a copy."""
        return self._held._states()[0] if isinstance(self.system, System) else self._state[0].copy()

    @property
    def v(self) -> NDArray[Any]:
        """Velocities, ``(N, dimension)``: a copy."""
        return self._held._states()[1] if isinstance(self.system, System) else self._state[1].copy()

    @property
    def energy(self) -> NDArray[Any]:
        """Energies per unit mass, ``(N,)``, in the unit of a velocity squared, such as J/kg."""
        if isinstance(self.system, System):
            return self._held._energies()
        if self.system.energy is None:
            raise ValueError("the custom system has no energy")
        with self._turn:
            found = np.asarray(self.system.energy(*map(seen, self._state)))
        if found.shape != (len(self),) or found.dtype.kind not in "fiu":
            raise ValueError(
                f"the energy has shape {found.shape} and dtype {found.dtype}, but it must be "
                f"({len(self)},) real numbers"
            )
        return found.astype(self.dtype)

    def advance(self, steps: int) -> None:
        """Take so many steps of ``dt`` seconds.

        Raises
        ------
        ValueError
            For what is no number of steps, or an acceleration of another shape.
        KeyboardInterrupt
            Between two steps, after Ctrl-C.
        """
        steps = count("steps", steps, 0, 2**62)
        if isinstance(self.system, System):
            self._held._advance(steps)
            return
        dt = self.dtype.type(self.dt)
        # What overflows is infinite, as in the engine.
        with self._turn, np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for _ in range(steps):
                self._state = self._held.step(*self._state, dt)
                self._step += 1

    def __len__(self) -> int:
        return self._len

    def __copy__(self) -> Ensemble:
        raise TypeError("an Ensemble cannot be copied: make another of its q and v")

    def __reduce__(self) -> Any:
        raise TypeError("an Ensemble cannot be pickled: make another of its q and v")
