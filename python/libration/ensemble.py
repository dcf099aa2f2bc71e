"""Ensembles of trajectories."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._requests import description_of, rows, text
from ._keywords import check_keywords
from ._settings import count, positive
from .equations import EquationSystem
from .systems import CustomSystem, Program, known, seen

__all__ = ["Ensemble"]


class Ensemble:
    """Many trajectories of a system, which the engine steps together.

    Parameters
    ----------
    system:
        As in :func:`~libration.simulate`.
    integrator:
        Name from :data:`~libration.INTEGRATORS`, except ``"exact"``.
    dt:
        Time step in s.
    q, v:
        Initial positions and velocities, ``(N, dimension)``, or ``(N,)`` for one degree of freedom (default of ``v``: zeros).
    dtype:
        Float type of every operation: ``"float64"`` or ``"float32"``.
    threads:
        Number of threads (0: one per core). The bits of a trajectory are independent of ``threads`` and ``N``.

    Raises
    ------
    TypeError, ValueError
        For an invalid value; the message has the name of the parameter and the allowed values.
    MemoryError
        If there is not enough memory.
    """

    @check_keywords
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
        if isinstance(self.system, EquationSystem):
            at, speed = self.system._starts(at, None if v is None else speed)
        if at.shape != speed.shape:
            raise ValueError(f"q has shape {at.shape} and v {speed.shape}, but they must be equal")
        if 0 in at.shape:
            raise ValueError(f"q has shape {at.shape}, but there must be at least one trajectory")
        for name, start in (("q", at), ("v", speed)):
            with np.errstate(over="ignore"):
                if not np.isfinite(start.astype(self.dtype)).all():
                    raise ValueError(f"{name} is not finite in {self.dtype}")
        threads = count("threads", threads, 0, 1024)
        self._step, self._len = 0, len(at)
        if isinstance(self.system, CustomSystem):
            self._trajectories: Any = Program(self.integrator, self.system)
            # The engine has its own lock; this one is for NumPy arrays.
            self._turn = threading.RLock()
            self._state = (at.astype(self.dtype), speed.astype(self.dtype))
        else:
            description, single = description_of(self.system), bool(self.dtype == np.float32)
            self._trajectories = _native.Trajectories(description, self.integrator, self.dt, at, speed, single, threads)

    @property
    def step(self) -> int:
        """Number of steps taken."""
        return self._step if isinstance(self.system, CustomSystem) else self._trajectories._step()

    @property
    def time(self) -> float:
        """Time in s."""
        return self.step * self.dt

    @property
    def q(self) -> NDArray[Any]:
        """Copy of the positions, ``(N, dimension)``."""
        if isinstance(self.system, CustomSystem):
            return self._state[0].copy()
        q = self._trajectories._states()[0]
        return q[:, : self.system._positions].copy() if isinstance(self.system, EquationSystem) else q

    @property
    def v(self) -> NDArray[Any]:
        """Copy of the velocities, ``(N, dimension)``; of a system by equations also of the states of first order."""
        if isinstance(self.system, CustomSystem):
            return self._state[1].copy()
        v = self._trajectories._states()[1]
        if not isinstance(self.system, EquationSystem):
            return v
        return v[:, : len(self.system.states) - self.system._positions].copy()

    @property
    def energy(self) -> NDArray[Any]:
        """Energies per unit mass, ``(N,)``, in J/kg."""
        if isinstance(self.system, EquationSystem) and not self.system.summary["energy"]:
            raise ValueError(f"the system {self.system.name} has no energy")
        if not isinstance(self.system, CustomSystem):
            return self._trajectories._energies()
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
        """Take ``steps`` steps of ``dt`` seconds.

        Raises
        ------
        ValueError
            For an invalid number of steps, or an acceleration with a wrong shape.
        KeyboardInterrupt
            Between two steps, after Ctrl-C.
        """
        steps = count("steps", steps, 0, 2**62)
        if not isinstance(self.system, CustomSystem):
            self._trajectories._advance(steps)
            return
        dt = self.dtype.type(self.dt)
        # An overflow is infinite, as in the engine.
        with self._turn, np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for _ in range(steps):
                self._state = self._trajectories.step(*self._state, dt)
                self._step += 1

    def __len__(self) -> int:
        return self._len

    def __copy__(self) -> Ensemble:
        raise TypeError("an Ensemble cannot be copied; help: make another from its q and v")

    def __reduce__(self) -> Any:
        raise TypeError("an Ensemble cannot be pickled; help: make another from its q and v")
