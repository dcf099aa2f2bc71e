"""Bodies under gravity and other forces between pairs: motions with an audit of what they conserve."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any

import numpy as np

from . import _native
from ._html import table
from ._settings import count as whole
from ._settings import number, positive

__all__ = ["Bodies", "BodyMotion", "simulate_bodies"]

class Bodies:
    """Bodies in space.

    Parameters
    ----------
    masses
        Shape ``(n,)``, at least zero. A body without mass feels the others, which do not feel it.
    positions, velocities
        Shape ``(n, 3)``.
    radii
        Shape ``(n,)``, at least zero [default: zero]. Two bodies whose distance is below the sum of their radii end the motion.
    names
        A name for each body [default: its number].
    gravitational_constant
        In the units of the masses, positions and velocities [default: 1, or 0 with a pair potential].
    softening
        The length ``L`` of the potential ``-G m / sqrt(r**2 + L**2)``.
    pair_potential
        The potential energy of two bodies: an expression of their distance ``r``, masses ``m1``, ``m2`` and charges ``q1``, ``q2``, such as
        ``"4*epsilon*((sigma/r)^12 - (sigma/r)^6)"``. Body 1 is that which comes first. All masses must be positive.
    parameters
        Other names in the potential, with their values.
    charges
        Shape ``(n,)`` [default: zero].

    Raises
    ------
    ValueError
        For arrays of other shapes, and numbers that are not finite or are negative masses or radii.
    """

    def __init__(
        self,
        masses: Any,
        positions: Any,
        velocities: Any,
        *,
        radii: Any = None,
        names: Sequence[str] | None = None,
        gravitational_constant: float | None = None,
        softening: float = 0.0,
        pair_potential: str | None = None,
        parameters: Mapping[str, float] | None = None,
        charges: Any = None,
        name: str = "bodies",
    ) -> None:
        self.masses = np.array(masses, dtype=np.float64)
        if self.masses.ndim != 1:
            raise ValueError(f"masses has shape {self.masses.shape}; expected (n,)")
        count = len(self.masses)
        self.positions = _of_shape("positions", positions, (count, 3))
        self.velocities = _of_shape("velocities", velocities, (count, 3))
        self.radii = np.zeros(count) if radii is None else _of_shape("radii", radii, (count,))
        self.names = [str(i) for i in range(count)] if names is None else [str(name) for name in names]
        if isinstance(names, str) or len(self.names) != count:
            raise ValueError(f"names has {len(self.names)} names; expected {count}")
        if len(set(self.names)) != count:
            raise ValueError("two bodies have the same name; expected a name for each")
        self.charges = np.zeros(count) if charges is None else _of_shape("charges", charges, (count,))
        if pair_potential is not None and not isinstance(pair_potential, str):
            raise TypeError(f"pair_potential is {type(pair_potential).__name__}; expected an expression as a string")
        if not isinstance(name, str):
            raise TypeError(f"name is {type(name).__name__}; expected a string")
        if parameters is not None and not isinstance(parameters, Mapping):
            raise TypeError(f"parameters is {type(parameters).__name__}; expected a dictionary of names and numbers")
        self.pair_potential = pair_potential
        self.parameters = {
            str(key): number(f"parameters[{key!r}]", value, "a finite number", math.isfinite)
            for key, value in (parameters or {}).items()
        }
        if self.parameters and pair_potential is None:
            raise ValueError(f"parameters has {sorted(self.parameters)} without a pair_potential")
        if gravitational_constant is None:
            gravitational_constant = 1.0 if pair_potential is None else 0.0
        self.gravitational_constant = number(
            "gravitational_constant", gravitational_constant, "a finite number of at least 0", lambda x: 0 <= x < math.inf
        )
        self.softening = number("softening", softening, "a length of at least 0", lambda x: 0 <= x < math.inf)
        self.name = name
        _native._check_bodies(self._table())

    @classmethod
    def published(cls, name: str, *, count: int | None = None, seed: int = 0, softening: float = 0.0) -> Bodies:
        """Published initial conditions: ``figure-eight``, ``pythagorean``, ``outer-solar-system``, ``kozai``, ``frozen-argon``, or ``plummer`` with a ``count``
        of bodies and a ``seed``."""
        if name != "plummer" and count is not None:
            raise ValueError(f"count applies to 'plummer' only; {name!r} has fixed bodies")
        if name == "plummer" and count is None:
            raise ValueError("'plummer' requires count")
        known = 0 if count is None else whole("count", count, 2, 1 << 16)
        return cls._of(_native._named_bodies(name, known, whole("seed", seed, 0, (1 << 64) - 1)), softening)

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Bodies:
        """The bodies of a file ``NAME.toml`` or ``NAME.csv``."""
        return cls._of(_native._read_bodies(fspath(path)), None)

    @classmethod
    def _of(cls, fields: dict[str, Any], softening: float | None) -> Bodies:
        fields = dict(fields)
        for key in ("positions", "velocities"):
            fields[key] = fields[key].reshape(-1, 3)
        if softening is not None:
            fields["softening"] = softening
        return cls(**fields)

    def __len__(self) -> int:
        return len(self.masses)

    def __repr__(self) -> str:
        return f"<Bodies: {len(self)} of {self.name}>"

    def _table(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "names": self.names,
            "masses": self.masses.tolist(),
            "radii": self.radii.tolist(),
            "charges": self.charges.tolist(),
            "pair_potential": self.pair_potential,
            "parameters": list(self.parameters.items()),
            "positions": self.positions.ravel().tolist(),
            "velocities": self.velocities.ravel().tolist(),
            "gravitational_constant": self.gravitational_constant,
            "softening": self.softening,
        }


def _of_shape(name: str, values: Any, shape: tuple[int, ...]) -> np.ndarray[Any, Any]:
    if np.iscomplexobj(values):
        raise TypeError(f"{name} has complex numbers; expected real ones")
    array = np.array(values, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}; expected {shape}")
    return array


class BodyMotion:
    """A motion of bodies; :attr:`results` has the keys of ``libration bodies --json``."""

    def __init__(self, bodies: Bodies, results: dict[str, Any], t: np.ndarray[Any, Any], states: np.ndarray[Any, Any]) -> None:
        self.bodies = bodies
        self.results = results
        #: Times of the samples, shape ``(samples,)``.
        self.t = t
        states = states.reshape(len(t), len(bodies), 6)
        #: Shape ``(samples, n, 3)``.
        self.positions = states[..., :3]
        #: Shape ``(samples, n, 3)``.
        self.velocities = states[..., 3:]

    def __repr__(self) -> str:
        energy = self.conserved["energy"]["largest_change"]
        return f"<BodyMotion: {len(self.bodies)} bodies to t = {self.results['t']:g}, energy within {energy:.1e}>"

    def _repr_html_(self) -> str:
        columns = ["quantity", "largest_change", "predicted_by_order", "predicted_by_rounding"]
        rows = [[one[column] for column in columns] for one in self.results["conserved"]]
        return table([column.replace("_", " ") for column in columns], rows)

    @property
    def conserved(self) -> dict[str, dict[str, Any]]:
        """The ``largest_change`` of ``energy``, ``momentum`` and ``angular momentum``, relative to its ``size``, with what the order of the
        integrator and rounding predict."""
        return {one["quantity"]: one for one in self.results["conserved"]}

    @property
    def stopped(self) -> str | None:
        """Why the motion ended before its last step: a collision, or numbers that are not finite."""
        stopped: str | None = self.results["stopped"]
        return stopped


def simulate_bodies(
    bodies: Bodies,
    *,
    integrator: str,
    dt: float,
    steps: int,
    every: int | None = None,
    compensated: bool = False,
    adaptive: bool = False,
    predict: bool = True,
    threads: int = 0,
) -> BodyMotion:
    """Simulate bodies and audit what they conserve.

    Parameters
    ----------
    bodies
        The bodies at time 0.
    integrator
        The name of an explicit integrator, or ``"wisdom-holman"`` for orbits around a heavy first body, also by a table for weak kicks as
        ``"wisdom-holman:aba-10-6-4"``.
    dt, steps
        Time step, in the units of the bodies, and number of steps.
    every
        Steps from sample to sample [default: at most 1000 samples].
    compensated
        Whether positions and velocities keep what their sums round off.
    adaptive
        Whether the length of the steps follows the encounters, reversibly: ``dt`` is the first. Requires a symmetric splitting method.
    predict
        Whether a second run with twice the time step predicts the changes by the order, which takes half of the time again.
    threads
        Number of threads (0: one per core). Results do not depend on it.

    Raises
    ------
    ValueError
        For invalid bodies, an unknown integrator, or one that does not apply.
    MemoryError
        If the samples do not fit.
    """
    if not isinstance(bodies, Bodies):
        raise TypeError(f"bodies is {type(bodies).__name__}; expected Bodies")
    if not isinstance(integrator, str):
        raise TypeError(f"integrator is {type(integrator).__name__}; expected a name")
    for name, flag in (("compensated", compensated), ("predict", predict), ("adaptive", adaptive)):
        if not isinstance(flag, (bool, np.bool_)):
            raise TypeError(f"{name} is {type(flag).__name__}; expected True or False")
    options = {
        "integrator": integrator,
        "dt": positive("dt", dt),
        "steps": whole("steps", steps, 1, _native._MOST_STEPS),
        "every": None if every is None else whole("every", every, 1, _native._MOST_STEPS),
        "compensated": bool(compensated),
        "predict": bool(predict),
        "adaptive": bool(adaptive),
        "threads": whole("threads", threads, 0, 1024),
    }
    audit, t, states = _native._simulate_bodies(bodies._table(), options)
    return BodyMotion(bodies, json.loads(audit), t, states)
