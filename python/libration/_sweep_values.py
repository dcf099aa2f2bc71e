"""Values of sweeps: results as scalars by name, and swept values as scalars."""

from __future__ import annotations

import dataclasses
import re
from typing import Any, Iterator, Mapping, Sequence

from .analysis import Advice
from .laboratory import Results
from .probe_report import ProbeReport

Scalar = float | int | bool | str | None

_NAMES = ("kind", "integrator", "name")
"""Keys that name an entry of a list, such as a budget or an integrator."""

_AT_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def row_of(result: Any) -> dict[str, Scalar]:
    """Return the scalars of a result by their dotted names.

    Lists of numbers are left out. The entries of a list of mappings have the names of these, if they are different.

    Raises
    ------
    TypeError
        If the result has no scalars.
    """
    found: dict[str, Scalar] = {}
    for name, value in () if result is None else _scalars("", _mapping(result)):
        if name in found or not name:
            raise TypeError(f"the function returned two results with the name {name!r}" if name else "the function returned a result without a name")
        found[name] = value
    if not found:
        raise TypeError(f"the function returned {type(result).__name__}; expected a number, a mapping or a result of the package")
    return found


def labels_of(values: Sequence[Any]) -> list[Scalar]:
    """Return swept values as scalars: themselves, or their notation. A value without a notation has its number."""
    found: list[Scalar] = []
    for number, value in enumerate(values, 1):
        is_scalar, scalar = _scalar(value)
        if not is_scalar:
            text = " ".join(repr(value).split())
            named = getattr(value, "__qualname__", None)
            scalar = str(named) if named else f"{type(value).__name__} {number}" if _AT_ADDRESS.search(text) else text
        found.append(scalar)
    return found


def _mapping(result: Any) -> Any:
    if isinstance(result, Results):
        keys = ("measured", "predicted", "tolerance", "verdict", "unit")
        return {finding.id: {key: getattr(finding, key) for key in keys} for finding in result.findings}
    if isinstance(result, ProbeReport):
        return {"holds": result.holds, **result.results}
    if isinstance(result, Mapping):
        if isinstance(result, Advice):
            # Its throughput is the speed of a machine.
            return {"holds": result.holds, **{key: one for key, one in result.items() if key != "throughput"}}
        return result
    if dataclasses.is_dataclass(result) and not isinstance(result, type):
        return {field.name: getattr(result, field.name) for field in dataclasses.fields(result)}
    return {"value": result}


def _scalars(prefix: str, value: Any) -> Iterator[tuple[str, Scalar]]:
    is_scalar, scalar = _scalar(value)
    if is_scalar:
        yield prefix, scalar
    elif isinstance(value, Mapping):
        for key, one in value.items():
            yield from _scalars(f"{prefix}.{key}" if prefix else str(key), one)
    elif isinstance(value, (list, tuple)) and value and all(isinstance(one, Mapping) for one in value):
        names = [_name(one) for one in value]
        if None not in names and len(set(names)) == len(names):
            for name, one in zip(names, value):
                yield from _scalars(f"{prefix}.{name}", one)


def _name(entry: Mapping[str, Any]) -> str | None:
    for key in _NAMES:
        if isinstance(entry.get(key), str):
            channel = entry.get("channel")
            return f"{entry[key]} of {channel}" if isinstance(channel, str) else str(entry[key])
    return None


def _scalar(value: Any) -> tuple[bool, Scalar]:
    """Return whether a value is a scalar, and the scalar of Python."""
    if getattr(value, "shape", None) == () and hasattr(value, "item"):
        value = value.item()
    # A subclass, such as an enumeration, is the number or the text.
    for kind in (bool, int, float, str):
        if isinstance(value, kind):
            return True, kind(value)
    return value is None, None
