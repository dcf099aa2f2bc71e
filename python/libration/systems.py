"""Systems and integrators of the catalogue, and custom systems."""

from __future__ import annotations

import os
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Callable, Mapping, Sequence, TypedDict, overload

import numpy as np

from . import _native
from ._settings import nearest, number
from .equations import EquationSystem
from .linear import LinearPlant

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = ["CustomSystem", "IMPLICIT_INTEGRATORS", "INTEGRATORS", "RUNGE_KUTTA_METHODS", "SPLITTING_METHODS", "SYSTEMS", "System"]

# Starts of systems by equations whose motion from zero is none.
_STARTS: Mapping[str, Mapping[str, float]] = {"kepler": {"x": 1.0, "y'": 1.0}}

INTEGRATORS: Mapping[str, str] = MappingProxyType(dict(_native._integrators()))
"""Description of each integrator, by name. ``"exact"`` is for linear systems only, not for ensembles or environments."""

IMPLICIT_INTEGRATORS: Mapping[str, str] = MappingProxyType(dict(_native._implicit_integrators()))
"""Description of each implicit integrator, by name: for :func:`simulate` and :func:`analyze`."""

SPLITTING_METHODS: Mapping[str, str] = MappingProxyType({name: f"{about}; {source}" for name, about, source in _native._splitting_methods()})
"""Description and source of each published splitting method, by name: integrators for all that takes one of :data:`INTEGRATORS`."""

RUNGE_KUTTA_METHODS: Mapping[str, str] = MappingProxyType(
    {name: f"{about}; {source}" for name, about, source in _native._runge_kutta_methods()}
)
"""Description and source of each published Runge–Kutta method, by name: integrators for all that takes one of :data:`INTEGRATORS`."""

SYSTEMS: Mapping[str, str] = MappingProxyType({entry[0]: entry[1] for entry in _native._systems()})
"""Description of each system, by name."""

_DIMENSIONS = {name: range(least, most + 1) for name, _, least, most, _ in _native._systems()}


class EquationKeywords(TypedDict, total=False):
    """Keywords of :class:`~libration.EquationSystem` besides ``acceleration``, ``rate`` and ``name``."""

    parameters: Mapping[str, Any] | None
    inputs: Sequence[str]
    let: Mapping[str, str] | None
    energy: str | None
    start: Mapping[str, float] | None
    units: Mapping[str, str] | None
    task: Mapping[str, Any] | None
    description: str


class System:
    """A system of the catalogue; with ``acceleration`` or ``rate`` an :class:`~libration.EquationSystem`.

    Parameters
    ----------
    name:
        Name from :data:`SYSTEMS`.
    **parameters:
        Parameters in SI units (default: those of the catalogue).

    Raises
    ------
    ValueError
        For an unknown name or parameter, or an invalid value.

    Examples
    --------
    >>> System("oscillator", m=2.0, k=20.0)  # commands are forces in N
    System('oscillator', m=2.0, k=20.0)
    """

    name: str
    parameters: Mapping[str, float]

    if TYPE_CHECKING:
        # Type checkers know by the keywords which class a call returns.
        @overload
        def __new__(cls, name: str, **parameters: float) -> System: ...
        @overload
        def __new__(  # type: ignore[misc]
            cls,
            name: str = "system",
            *,
            acceleration: Mapping[str, str],
            rate: Mapping[str, str] | None = None,
            **given: Unpack[EquationKeywords],
        ) -> EquationSystem: ...
        @overload
        def __new__(  # type: ignore[misc]
            cls, name: str = "system", *, rate: Mapping[str, str], **given: Unpack[EquationKeywords]
        ) -> EquationSystem: ...
        def __new__(cls, name: Any = None, **given: Any) -> Any: ...

    else:

        def __new__(cls, name: Any = None, **given: Any) -> Any:
            if "acceleration" in given or "rate" in given:
                if name is not None:
                    given["name"] = name
                return EquationSystem(**given)
            return super().__new__(cls)

        def __init__(self, name: str, **parameters: Any) -> None:
            if not isinstance(name, str):
                raise TypeError(f"name must be a string, not {type(name).__name__}")
            given = [(key, number(key, value, "finite")) for key, value in parameters.items()]
            self.name = name
            self.parameters = MappingProxyType(dict(_native._parameters((name, given))))

    @staticmethod
    def from_toml(path: str | os.PathLike[str], **parameters: float) -> EquationSystem:
        """Return the system of the equations in a file: :meth:`libration.EquationSystem.from_toml`."""
        return EquationSystem.from_toml(path, **parameters)

    def equations(self, **keywords: Unpack[EquationKeywords]) -> EquationSystem:
        """Return this system by equations, with a command for each coordinate. Environments, tasks and data sets take it.

        Parameters
        ----------
        **keywords:
            Keywords of :class:`libration.EquationSystem`, in place of those of this system. ``inputs`` requires ``acceleration``, whose
            expressions have the commands.

        Returns
        -------
        EquationSystem
            With the coordinate ``q`` and the command ``u``, or ``x``, ``y`` and ``u_x``, ``u_y``. A command is an acceleration, or a force in
            N where the system has the mass ``m``. Without commands its motion has the bits of the catalogue's.

        Examples
        --------
        >>> System("kepler").equations().inputs
        ('u_x', 'u_y')
        """
        accelerations, inputs = _native._commanded((self.name, list(self.parameters.items())))
        given: dict[str, Any] = {
            "acceleration": dict(accelerations),
            "parameters": dict(self.parameters),
            "inputs": inputs,
            "start": _STARTS.get(self.name),
            "name": self.name,
        }
        return EquationSystem(**{**given, **keywords})

    @property
    def dimensions(self) -> range:
        """Allowed numbers of degrees of freedom."""
        return _DIMENSIONS[self.name]

    def __repr__(self) -> str:
        return f"System({', '.join([repr(self.name), *(f'{k}={v!r}' for k, v in self.parameters.items())])})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, System) and self._request() == other._request()

    def __hash__(self) -> int:
        return hash((self.name, tuple(self.parameters.items())))

    def _request(self) -> tuple[str, list[tuple[str, float]]]:
        return self.name, list(self.parameters.items())

    def __reduce__(self) -> Any:
        return _again, self._request()


def _again(name: str, parameters: list[tuple[str, float]]) -> System:
    return System(name, **dict(parameters))


def with_commands(system: Any) -> Any:
    """Return a system of the catalogue or a linear plant by equations, and anything else as it is."""
    if isinstance(system, LinearPlant):
        return EquationSystem.from_plant(system)
    return system.equations() if isinstance(system, System) else system


@dataclass(frozen=True)
class CustomSystem:
    """A system whose acceleration is a Python function.

    The integrators of the engine step it, operation by operation on whole arrays, with the bits of the engine in ``float64`` and
    ``float32``. A step takes a few calls of ``acceleration`` and some NumPy operations: 10 µs (velocity Verlet) to 50 µs (Suzuki) for few
    trajectories, and some tens of times the time of a catalogue system for thousands.
    """

    acceleration: Callable[[np.ndarray, np.ndarray], Any]
    """Function ``a(q, v)`` of arrays ``(N, D)`` that returns an array ``(N, D)``. Its arguments are read-only."""
    energy: Callable[[np.ndarray, np.ndarray], Any] | None = None
    """Function that returns the energy per unit mass, ``(N,)``."""
    positional: bool = False
    """Whether the acceleration depends on positions only; it is then computed once per position."""

    def __post_init__(self) -> None:
        for name in ("acceleration", "energy"):
            function = getattr(self, name)
            if not callable(function) and not (name == "energy" and function is None):
                raise TypeError(f"{name} must be a function, not {type(function).__name__}")


def known(system: Any) -> System | CustomSystem | EquationSystem:
    """Return the system of a name, a function or a system."""
    if isinstance(system, (System, CustomSystem, EquationSystem)):
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
    """Return a read-only view of an array."""
    view = array.view()
    view.flags.writeable = False
    return view


class Program:
    """A step of an integrator as a list of array operations."""

    def __init__(self, integrator: str, system: CustomSystem) -> None:
        self.operations, self.constants, self.next = _native._program(integrator)
        self.system = system
        # The last positions and their acceleration.
        self.known: tuple[np.ndarray, np.ndarray] | None = None

    def step(self, q: np.ndarray, v: np.ndarray, dt: Any) -> tuple[np.ndarray, np.ndarray]:
        """Return positions and velocities after a step of ``dt`` seconds."""
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
        # The function may reuse the memory of its result.
        found = found.astype(q.dtype)
        self.known = q, found
        return found
