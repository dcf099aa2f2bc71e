"""Systems by their equations."""

from __future__ import annotations

import json
import os
from types import MappingProxyType
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._keywords import check_keywords
from ._plant_equations import keywords_of_plant
from ._settings import number
from ._toml import text_of
from .linear import LinearPlant
from .operating_point import OperatingPoint

__all__ = ["EquationSystem"]


class EquationSystem:
    """A system ``q̈ = a(q, v, u, t)`` by its equations, with states of first order: ``System(acceleration={...})``.

    The engine steps it as it steps a system of the catalogue: with each integrator, in each float type, many trajectories at once.
    ``docs/systems.md`` has the language of expressions.

    Parameters
    ----------
    acceleration:
        The second derivative of each coordinate, an expression. The velocity of ``x`` is ``x'``, its acceleration ``x''``.
    rate:
        The derivative of each state of first order.
    parameters:
        Parameters by name, or pairs of a value and a unit.
    inputs:
        Names of inputs. They are zero in simulations; controllers drive them.
    let:
        Named parts of expressions.
    energy:
        The energy.
    start:
        Values at the start by name, ``"x'"`` for a velocity (default: zero).
    units:
        Units of coordinates, states of first order, inputs, and of ``"energy"``.
    task:
        The task of environments and data sets: ``observe``, ``reward``, ``terminated`` and ``start``, as in the table ``[task]`` of a file.
    name, description:
        Shown in results.

    Raises
    ------
    TypeError, ValueError
        For an equation that is wrong; the message has its place and the nearest name.

    Examples
    --------
    >>> System(acceleration={"x": "-k/m*x"}, parameters={"k": 10.0, "m": 1.0}, start={"x": 1.0})
    <EquationSystem system: x, x'>
    """

    @check_keywords
    def __init__(
        self,
        *,
        acceleration: Mapping[str, str] | None = None,
        rate: Mapping[str, str] | None = None,
        parameters: Mapping[str, Any] | None = None,
        inputs: Sequence[str] = (),
        let: Mapping[str, str] | None = None,
        energy: str | None = None,
        start: Mapping[str, float] | None = None,
        units: Mapping[str, str] | None = None,
        task: Mapping[str, Any] | None = None,
        name: str = "system",
        description: str = "",
    ) -> None:
        tables = {"acceleration": acceleration, "rate": rate, "parameters": parameters, "let": let}
        tables |= {"start": start, "units": units, "task": task}
        for key, table in tables.items():
            if table is not None and not isinstance(table, Mapping):
                raise TypeError(f"{key} must be a dictionary, not {type(table).__name__}")
        if isinstance(inputs, str):
            raise TypeError(f"inputs is {inputs!r}, but it must be a list of names")
        values: dict[str, Any] = {}
        for key, value in (parameters or {}).items():
            if isinstance(value, tuple):
                size, unit = value
                values[key] = {"value": number(key, size, "finite"), "unit": unit}
            else:
                values[key] = number(key, value, "finite")
        system = {
            "name": name,
            "description": description,
            "coordinates": list(acceleration or {}),
            "inputs": list(inputs),
            "energy": energy,
            "acceleration": acceleration,
            "rate": rate,
            "parameters": values,
            "let": let,
            "start": {key: number(key, value, "finite") for key, value in (start or {}).items()},
            "units": units,
        }
        self._read(text_of("system", {"system": system, "task": task}), "system", [])

    def _read(self, text: str, file: str, given: list[tuple[str, float]]) -> None:
        self._text = (text, file, given)
        self._summary_text = _native._equation_summary(self._text)
        self._summary: dict[str, Any] = json.loads(self._summary_text)
        self.name: str = self._summary["name"]
        names = [state["name"] for state in self._summary["states"]]
        self.states: tuple[str, ...] = tuple(names)
        """Names of coordinates, then of velocities and states of first order."""
        self._positions = sum(f"{name}'" in names for name in names)

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str], **parameters: float) -> EquationSystem:
        """Return the system of a file, with other values of some parameters.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            For a file that is wrong; the message has the line.
        """
        if not isinstance(path, (str, os.PathLike)):
            raise TypeError(f"path must be a path, not {type(path).__name__}")
        return cls._again(
            text_of("path", path),
            os.fspath(path),
            [(key, number(key, value, "finite")) for key, value in parameters.items()],
        )

    @classmethod
    @check_keywords
    def from_plant(cls, plant: LinearPlant, *, task: Mapping[str, Any] | None = None, name: str = "plant") -> EquationSystem:
        """Return a linear plant by equations: simulations, environments and data sets take it with each integrator and float type.

        A state whose derivative is another one, as ``q`` and ``q'`` of :meth:`LinearPlant.mechanical`, becomes a coordinate with an
        acceleration; all others are states of first order, which come last in :attr:`states`. ``G`` has no equation; in place of ``C``
        environments have ``observe``, which is all states by default.

        Parameters
        ----------
        plant:
            A plant in continuous time without ``parts``; :class:`LinearVectorEnv` takes others.
        task:
            As in :class:`EquationSystem`.
        name:
            Shown in results.

        Raises
        ------
        TypeError, ValueError
            For another plant, or a name that is none in an expression.
        """
        if not isinstance(plant, LinearPlant):
            raise TypeError(f"plant must be a libration.LinearPlant, not {type(plant).__name__}")
        return cls(**keywords_of_plant(plant), task=task, name=name)

    @classmethod
    def _again(cls, text: str, file: str, given: list[tuple[str, float]]) -> EquationSystem:
        system = cls.__new__(cls)
        system._read(text, file, given)
        return system

    def replace(self, **parameters: float) -> EquationSystem:
        """Return the system with other values of some parameters."""
        text, file, given = self._text
        new = dict(given) | {key: number(key, value, "finite") for key, value in parameters.items()}
        return self._again(text, file, list(new.items()))

    @property
    def parameters(self) -> Mapping[str, float]:
        """Parameters by name."""
        return MappingProxyType({each["name"]: each["value"] for each in self._summary["parameters"]})

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return tuple(self._summary["inputs"])

    @property
    def summary(self) -> Mapping[str, Any]:
        """Contents of ``libration list FILE --json``: states, parameters and task. Changes to lists of it have no effect on the system."""
        return MappingProxyType(json.loads(self._summary_text))

    def plant(self) -> LinearPlant:
        """Return the linear plant at the equilibrium near the start.

        A system without inputs gets one for each coordinate and state of first order: an addition to its acceleration or rate.

        Raises
        ------
        ValueError
            If there is no equilibrium.
        """
        (a, b, c, d, g), names, (x, u), residual = _native._equation_plant(self._text)
        states, inputs, outputs = (
            [f"{name} ({unit})" if unit else name for name, unit in signals] for signals in names
        )
        point = OperatingPoint(
            x=np.array(x),
            u=np.array(u),
            y=None,
            residual=residual,
            relative_residual=None,
            jacobian_error=None,
            iterations=None,
            scale=None,
        )
        return LinearPlant(
            a, b, c, d, g, states=states, inputs=inputs, outputs=outputs, operating_point=point
        )

    def _starts(self, q: NDArray[np.float64], v: NDArray[np.float64] | None) -> list[NDArray[np.float64]]:
        """Return positions and velocities of all degrees of freedom, of which time is the last."""
        positions, velocities = self._positions, len(self.states) - self._positions
        speed = np.zeros((len(q), velocities)) if v is None else v
        for name, array, names in (
            ("q", q, self.states[:positions]),
            ("v", speed, self.states[positions:]),
        ):
            if array.shape[1] != len(names):
                raise ValueError(
                    f"{name} has shape {array.shape}, but it must be (N, {len(names)}): {', '.join(names)}"
                )
        if len(q) != len(speed):
            raise ValueError(f"q has {len(q)} rows and v {len(speed)}, but they must be equal")
        clock = int(self._summary["time_dependent"])
        still = np.zeros((len(q), velocities - positions + clock))
        return [np.hstack([q, still]), np.hstack([speed, np.ones((len(q), clock))])]

    def __repr__(self) -> str:
        return f"<EquationSystem {self.name}: {', '.join(self.states)}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, EquationSystem) and self._text == other._text

    def __hash__(self) -> int:
        return hash(self._text[0])

    def __reduce__(self) -> Any:
        return EquationSystem._again, self._text


def check_system(function: str, system: Any, **others: Any) -> None:
    """Check that ``system`` is by equations or None, and that no other argument is a system by equations.

    Raises
    ------
    TypeError
        With the name of the argument, and how to call ``function``.
    """
    for name, value in others.items():
        if isinstance(value, EquationSystem):
            raise TypeError(f"{name} is {value!r}, but a system has its own keyword: {function}(system=…)")
    if system is None or isinstance(system, EquationSystem):
        return
    if isinstance(system, (str, os.PathLike)):
        help = f"; help: System.from_toml({os.fspath(system)!r})"
    else:
        help = ", as of System(acceleration=…) or System.from_toml"
    raise TypeError(f"system is {system!r}, but it must be a system by equations{help}")
