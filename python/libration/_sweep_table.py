"""Tables of sweeps."""

from __future__ import annotations

import hashlib
import importlib
import json
import struct
from os import PathLike
from pathlib import Path
from typing import Any, Mapping, Sequence

from ._html import table
from ._sweep_page import page_of

_ROWS_SHOWN = 20


class SweepTable:
    """Results of a sweep: a row for each point in the order of the grid, whatever computed it.

    ``table["spectral_radius"]`` is a column, a list. The swept keys come first, then the results, then ``error``: the message of a call that
    failed, else None. A failed call has None in all results.
    """

    def __init__(self, name: str, over: Mapping[str, Sequence[Any]], columns: Mapping[str, list[Any]], units: Mapping[str, str]) -> None:
        self.name = name
        """Name of the function."""
        self.over: dict[str, list[Any]] = {key: list(values) for key, values in over.items()}
        """Values of each swept key; one that is no number, text or bool is its notation."""
        self.columns: dict[str, list[Any]] = dict(columns)
        """All columns by name."""
        self.units: dict[str, str] = dict(units)
        """Units of columns, as far as they were given."""

    def __len__(self) -> int:
        return len(self.columns["error"])

    def __getitem__(self, name: str) -> list[Any]:
        return self.columns[name]

    @property
    def errors(self) -> list[str]:
        """Messages of the calls that failed, in the order of the grid."""
        return [error for error in self.columns["error"] if error is not None]

    def digest(self) -> str:
        """Return the SHA-256 of the names and of all bits of the values.

        Two engines that compute the same bits have the same digest.
        """
        state = hashlib.sha256()
        for name, values in self.columns.items():
            _add(state, "c", name.encode())
            for value in values:
                if isinstance(value, float):
                    _add(state, "f", struct.pack("<d", value))
                else:
                    _add(state, type(value).__name__[0], str(value).encode())
        return state.hexdigest()

    def to_pandas(self) -> Any:
        """Return a ``pandas.DataFrame`` with the columns of the table.

        Raises
        ------
        ModuleNotFoundError
            Without pandas: ``pip install 'libration[pandas]'``.
        """
        pandas = _required("pandas", "pandas")
        typed = {name: _typed(values) for name, values in self.columns.items()}
        return pandas.DataFrame({name: pandas.Series(values, dtype=kind) for name, (values, kind) in typed.items()})

    def to_parquet(self, path: str | PathLike[str]) -> None:
        """Write the table as a Parquet file, whose metadata key ``libration.sweep`` has function, swept values, units and digest.

        Raises
        ------
        ModuleNotFoundError
            Without pyarrow: ``pip install 'libration[parquet]'``.
        OSError
            If the file cannot be written.
        """
        pyarrow, parquet = (_required(name, "parquet") for name in ("pyarrow", "pyarrow.parquet"))
        types = {"float64": pyarrow.float64(), "Int64": pyarrow.int64(), "boolean": pyarrow.bool_(), "object": pyarrow.string()}
        typed = {name: _typed(values) for name, values in self.columns.items()}
        arrays = {name: pyarrow.array(values, types[kind]) for name, (values, kind) in typed.items()}
        about = {"function": self.name, "over": self.over, "units": self.units, "digest": self.digest()}
        found = pyarrow.table(arrays).replace_schema_metadata({"libration.sweep": json.dumps(about)})
        parquet.write_table(found, Path(path), compression="zstd")

    def page(self, path: str | PathLike[str], *, results: Sequence[str] | None = None, title: str | None = None) -> None:
        """Write an HTML page with a map of each result over the first two swept keys. It works without a network.

        Parameters
        ----------
        results:
            Columns to draw (default: all numbers and bools that vary).
        title:
            Heading of the page (default: the function and its swept keys).

        Raises
        ------
        ValueError
            For a column that the table does not have, or that has no numbers.
        OSError
            If the file cannot be written.
        """
        Path(path).write_text(page_of(self.name, self.over, self.columns, self.units, results, title), encoding="utf-8")

    def __repr__(self) -> str:
        failed = f", {len(self.errors)} failed" if self.errors else ""
        return f"<SweepTable of {self.name}: {len(self)} points over {', '.join(self.over)}{failed}>"

    def _repr_html_(self) -> str:
        names = list(self.columns)
        rows = [[self.columns[name][row] for name in names] for row in range(min(len(self), _ROWS_SHOWN))]
        more = f"<p>{len(self) - _ROWS_SHOWN} more rows</p>" if len(self) > _ROWS_SHOWN else ""
        return f"<div style='overflow:auto'>{table(names, rows, 0)}</div>{more}"


def _add(state: Any, kind: str, content: bytes) -> None:
    state.update(f"{kind}{len(content)}:".encode())
    state.update(content)


def _typed(values: list[Any]) -> tuple[list[Any], str]:
    """Return the values of a column with one type, and the type. A column of texts and numbers becomes texts."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {bool}:
        return values, "boolean"
    if kinds == {int} and all(value is None or -(2**63) <= value < 2**63 for value in values):
        return values, "Int64"
    if kinds and kinds <= {int, float}:
        return [None if value is None else float(value) for value in values], "float64"
    return [None if value is None else str(value) for value in values], "object"


def _required(module: str, extra: str) -> Any:
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        package = module.split(".")[0]
        raise ModuleNotFoundError(f"{package} is not installed; help: pip install 'libration[{extra}]'", name=error.name) from error
