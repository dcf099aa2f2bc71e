"""Systems and integrators by name, and systems of one's own."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Callable, Mapping

import numpy as np

from . import _native
from ._settings import nearest, number

__all__ = ["CustomSystem", "INTEGRATORS", "SYSTEMS", "System"]

INTEGRATORS: Mapping[str, str] = MappingProxyType(dict(_native._integrators()))
"""What each integrator is, by name. ``"exact"`` steps exist of linear systems, and not in ensembles or environments."""

SYSTEMS: Mapping[str, str] = MappingProxyType({entry[0]: entry[1] for entry in _native._systems()})
"""What each system is, by name."""

_DIMENSIONS = {name: range(least, most + 1) for name, _, least, most, _ in _native._systems()}


class System:
    """A system of the catalogue.

    Parameters
    ----------
    name:
        One of :data:`SYSTEMS`.
    **parameters:
        In SI units; those that are not given take their defaults.

    Raises
    ------
    ValueError
        For an unknown name or parameter, or a value that is not allowed.

    Examples
    --------
    >>> System("oscillator", m=2.0, k=20.0)  # commands are forces in N
    System('oscillator', m=2.0, k=20.0)
    """

    def __init__(self, name: str, **parameters: float) -> None:
        if not isinstance(name, str):
            raise TypeError(f"a system is known by its name, not by {type(name).__name__}")
        given = [(key, number(key, value, "finite")) for key, value in parameters.items()]
        self.name = name
        self.parameters: Mapping[str, float] = MappingProxyType(
            dict(_native._parameters((name, given)))
        )

    @property
    def dimensions(self) -> range:
        """The numbers of degrees of freedom in which it exists."""
        return _DIMENSIONS[self.name]

    def __repr__(self) -> str:
        return f"System({', '.join([repr(self.name), *(f'{k}={v!r}' for k, v in self.parameters.items())])})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, System) and self._told() == other._told()

    def __hash__(self) -> int:
        return hash((self.name, tuple(self.parameters.items())))

    def _told(self) -> tuple[str, list[tuple[str, float]]]:
        return self.name, list(self.parameters.items())

    def __reduce__(self) -> Any:
        return _again, self._told()


def _again(name: str, parameters: list[tuple[str, float]]) -> System:
    return System(name, **dict(parameters))


@dataclass(frozen=True)
class CustomSystem:
    """A system of one's own, of which Python computes the force.

    It is stepped by the engine's integrators, operation by operation on whole arrays, and in ``float64`` and ``float32`` to the bits that the
    engine would give. Every step costs a few calls of ``acceleration`` and some NumPy operations: with thousands of trajectories some tens of
    times as long as a system of the catalogue takes, and with few of them ten (velocity Verlet) to fifty (Suzuki) microseconds, most of which is
    spent between calls.
    """

    acceleration: Callable[[np.ndarray, np.ndarray], Any]
    """The acceleration ``a(q, v)`` of arrays ``(N, D)``, as an array ``(N, D)``. What it is given cannot be written."""
    energy: Callable[[np.ndarray, np.ndarray], Any] | None = None
    """The energy per unit mass, ``(N,)``, if there is one."""
    positional: bool = False
    """Whether the acceleration depends on positions alone: then it is not computed twice from the same ones."""

    def __post_init__(self) -> None:
        for name in ("acceleration", "energy"):
            function = getattr(self, name)
            if not callable(function) and not (name == "energy" and function is None):
                raise TypeError(f"{name} must be a function, not {type(function).__name__}")


def known(system: Any) -> System | CustomSystem:
    """A system, whatever it was called."""
    if isinstance(system, (System, CustomSystem)):
        return system
    if isinstance(system, str):
        if system not in SYSTEMS:
            raise ValueError(f"unknown system {system!r}: {nearest(system, SYSTEMS)}")
        return System(system)
    if callable(system):
        return CustomSystem(system)
    raise TypeError(
        f"system must be a name, a System or a function of positions and velocities, not {type(system).__name__}"
    )


def seen(array: np.ndarray) -> np.ndarray:
    """The array for who must not write it."""
    view = array.view()
    view.flags.writeable = False
    return view


class Program:
    """A step of an integrator as the list of its operations, to be done with arrays."""

    def __init__(self, integrator: str, system: CustomSystem) -> None:
        self.operations, self.constants, self.next = _native._program(integrator)
        self.system = system
        # Positions of which the acceleration is known.
        self.known: tuple[np.ndarray, np.ndarray] | None = None

    def step(self, q: np.ndarray, v: np.ndarray, dt: Any) -> tuple[np.ndarray, np.ndarray]:
        """Positions and velocities after a step of ``dt`` seconds."""
        values: list[Any] = []
        # Constants are rounded as the engine rounds them.
        number = q.dtype.type
        for name, a, b, c in self.operations:
            if name == "multiply":
                value = values[a] * values[b]
            elif name == "add":
                value = values[a] + values[b]
            elif name == "subtract":
                value = values[a] - values[b]
            elif name == "acceleration":
                value = self.acceleration(values[a], values[b])
            elif name == "ratio":
                value = values[a] * number(b) / number(c)
            elif name == "negative":
                value = -values[a]
            elif name == "constant":
                value = number(self.constants[a])
            else:
                value = (q, v, dt)[a]
            values.append(value)
        return values[self.next[0]], values[self.next[1]]

    def acceleration(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        if self.system.positional and self.known is not None and self.known[0] is q:
            return self.known[1]
        found = np.asarray(self.system.acceleration(seen(q), seen(v)))
        if found.shape != q.shape:
            raise ValueError(f"the acceleration has shape {found.shape}, but it must be {q.shape}")
        if found.dtype.kind not in "fiu":
            raise TypeError(f"the acceleration has dtype {found.dtype}, but it must be real numbers")
        # Whoever computes it may use that memory again.
        found = found.astype(q.dtype)
        self.known = q, found
        return found
