"""Sweeps: a function over a grid of its keywords, with a table of the results."""

from __future__ import annotations

import inspect
import itertools
import math
from typing import Any, Callable, Iterable, Mapping, Sequence

import numpy as np

from ._keywords import check_keywords
from ._progress import Progress, ProgressDisplay
from ._settings import count, is_several, nearest, shown
from ._sweep_table import SweepTable
from ._sweep_values import labels_of, row_of

__all__ = ["Sweep", "SweepTable", "sweep"]

Row = dict[str, Any]
"""Results of a point by name, and a message."""

_MOST_POINTS = 10_000_000

_ERROR = ""
"""Key of the message in a row. No result has an empty name."""


class Sweep:
    """A grid of calls of a function.

    The points are numbered in the order of the grid: the last key of ``over`` changes first. :meth:`rows` computes a part of the points in
    any process, and :meth:`table` joins the rows of all points. Both are pickled, so that any engine can distribute the parts:
    ``docs/cluster.md`` has three.

    Parameters
    ----------
    function:
        The function to call, such as :func:`libration.analyze`, :func:`libration.advise`, :func:`libration.run_lab`, ``libration.probe`` or
        a function of your own. Its result is a number, a mapping, or a result of the package.
    config:
        Keywords with the same value at all points.
    over:
        The list of values of each swept keyword, in the order of the columns. A dotted key sets a value within a dictionary of a keyword:
        ``"config.system.oscillator.omega2"``.
    units:
        Units of columns by name, for the page. Times and latencies of the package have theirs.

    Raises
    ------
    TypeError, ValueError
        For a keyword that the function does not have or that is missing, a key without values, or a key that ``config`` also has.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        config: Mapping[str, Any] | None = None,
        *,
        over: Mapping[str, Iterable[Any]],
        units: Mapping[str, str] | None = None,
    ) -> None:
        if not callable(function):
            raise TypeError(f"function is {shown(function)}; expected a function, such as libration.analyze")
        for name, table in (("config", config), ("over", over), ("units", units)):
            if not isinstance(table, Mapping) and not (table is None and name != "over"):
                raise TypeError(f"{name} must be a mapping, not {type(table).__name__}")
        self.function = function
        self.config: dict[str, Any] = dict(config or {})
        self.over: dict[str, list[Any]] = {key: _values(key, values) for key, values in over.items()}
        self.units: dict[str, str] = dict(units or {})
        if not self.over:
            raise ValueError("over is empty; expected at least one keyword with its values")
        if len(self) > _MOST_POINTS:
            raise ValueError(f"over has {len(self):,} points; expected at most {_MOST_POINTS:,}")
        for key in self.over:
            _check_target(self.config, self.over, key)
        self._hides_progress = _check_signature(function, self.keywords(0))

    def __len__(self) -> int:
        return math.prod(len(values) for values in self.over.values())

    def __repr__(self) -> str:
        grid = " × ".join(f"{len(values)} {key}" for key, values in self.over.items())
        return f"<Sweep of {self.name}: {grid}>"

    @property
    def name(self) -> str:
        """Name of the function."""
        return str(getattr(self.function, "__qualname__", None) or type(self.function).__name__.lower())

    def indices(self, point: int) -> tuple[int, ...]:
        """Return the numbers of the values of a point, one per key of ``over``."""
        point = count("point", point, 0, len(self) - 1)
        found = []
        for values in reversed(self.over.values()):
            point, index = divmod(point, len(values))
            found.append(index)
        return tuple(reversed(found))

    def keywords(self, point: int) -> dict[str, Any]:
        """Return the keywords of the call of a point, with dictionaries, lists and arrays of its own."""
        keywords = {key: _fresh(value) for key, value in self.config.items()}
        for (key, values), index in zip(self.over.items(), self.indices(point)):
            keyword, *inner = key.split(".")
            if not inner:
                keywords[keyword] = _fresh(values[index])
                continue
            table = keywords[keyword] = dict(keywords.get(keyword) or {})
            for name in inner[:-1]:
                table[name] = dict(table.get(name) or {})
                table = table[name]
            table[inner[-1]] = _fresh(values[index])
        return keywords

    def parts(self, number: int) -> list[range]:
        """Return the numbers of all points as at most ``number`` ranges of nearly equal length, in order."""
        number = min(count("number", number, 1, _MOST_POINTS), len(self))
        ends = [len(self) * i // number for i in range(number + 1)]
        return [range(first, last) for first, last in itertools.pairwise(ends)]

    def rows(self, part: Iterable[int]) -> list[Row]:
        """Return the results of the points of a part.

        An exception of a call is the ``error`` of its row, and the other points are computed. Ctrl-C ends the sweep.
        """
        found: list[Row] = []
        for point in part:
            keywords = self.keywords(point)
            if self._hides_progress:
                keywords.setdefault("progress", False)
            try:
                found.append({**row_of(self.function(**keywords)), _ERROR: None})
            # A call of `exit` would end a worker of a cluster.
            except (Exception, SystemExit) as error:
                found.append(self.failed(f"{type(error).__name__}: {error}"))
        return found

    @staticmethod
    def failed(message: str) -> Row:
        """Return the row of a point without results."""
        return {_ERROR: message}

    def table(self, rows: Sequence[Row]) -> SweepTable:
        """Return the table of the rows of all points, in the order of the grid.

        Raises
        ------
        ValueError
            If there are not as many rows as points.
        """
        if len(rows) != len(self):
            raise ValueError(f"there are {len(rows)} rows; expected {len(self)}, one for each point")
        labels = {key: labels_of(values) for key, values in self.over.items()}
        columns: dict[str, list[Any]] = {key: [] for key in labels}
        for values in itertools.product(*labels.values()):
            for key, value in zip(labels, values):
                columns[key].append(value)
        for name in dict.fromkeys(name for row in rows for name in row if name != _ERROR):
            column = [row.get(name) for row in rows]
            # Results often contain the swept keywords themselves.
            is_repeated = name in labels and all(value in (None, asked) for value, asked in zip(column, columns[name]))
            if any(value is not None for value in column) and not is_repeated:
                columns[f"result.{name}" if name in labels or name == "error" else name] = column
        columns["error"] = [row[_ERROR] for row in rows]
        return SweepTable(self.name, labels, columns, self.units)

    def run(self, *, progress: Progress = None) -> SweepTable:
        """Compute all points in this process."""
        rows: list[Row] = []
        with ProgressDisplay(progress) as display:
            for point in range(len(self)):
                rows += self.rows([point])
                display.update(len(rows) / len(self), f"{len(rows):,} of {len(self):,} points")
        return self.table(rows)


@check_keywords
def sweep(
    function: Callable[..., Any],
    config: Mapping[str, Any] | None = None,
    *,
    over: Mapping[str, Iterable[Any]],
    units: Mapping[str, str] | None = None,
    progress: Progress = None,
) -> SweepTable:
    """Return the table of a function over a grid of its keywords, computed in this process.

    :func:`libration.cluster.sweep` computes the same table on many machines.

    Parameters
    ----------
    function, config, over, units:
        As for :class:`Sweep`.
    progress:
        ``True``, ``False``, ``None`` (in a terminal or notebook), or a function ``(fraction, description)``.

    Raises
    ------
    TypeError, ValueError
        As for :class:`Sweep`, before any call.
    """
    return Sweep(function, config, over=over, units=units).run(progress=progress)


def _fresh(value: Any) -> Any:
    """Return a value whose containers a call may change without changing those of other calls."""
    if type(value) is dict:
        return {key: _fresh(one) for key, one in value.items()}
    if type(value) in (list, tuple, set):
        return type(value)(map(_fresh, value))
    return value.copy() if isinstance(value, np.ndarray) else value


def _values(key: Any, values: Any) -> list[Any]:
    if not isinstance(key, str) or not all(key.split(".")):
        raise ValueError(f"over has the key {key!r}; expected a keyword, or a dotted key such as 'config.dt'")
    if key == "error":
        raise ValueError("over has the key 'error', which is a column of each table; expected another keyword")
    if hasattr(values, "tolist"):
        values = values.tolist()
    if isinstance(values, Mapping) or not (is_several(values) or isinstance(values, Iterable)) or isinstance(values, (str, bytes)):
        raise TypeError(f"over[{key!r}] is {shown(values)}; expected a list of values")
    found = list(values)
    if not found:
        raise ValueError(f"over[{key!r}] is empty; expected at least one value")
    return found


def _check_target(config: Mapping[str, Any], over: Mapping[str, Any], key: str) -> None:
    """Check that a key has a place of its own among the keywords.

    Raises
    ------
    ValueError
        If ``config`` or another key of ``over`` has a value in that place.
    """
    for other in over:
        if other != key and key.startswith(f"{other}."):
            raise ValueError(f"over has {other!r} and {key!r}; expected one of them")
    table: Any = config
    names = key.split(".")
    for depth, name in enumerate(names):
        path = ".".join(names[:depth])
        if not isinstance(table, Mapping):
            raise ValueError(f"over has {key!r}, but config[{path!r}] is {shown(table)}; expected a dictionary")
        if name not in table:
            return
        table = table[name]
    if len(names) == 1:
        raise ValueError(f"over and config both have {key!r}; expected one of them")


def _check_signature(function: Callable[..., Any], keywords: Mapping[str, Any]) -> bool:
    """Return whether the function shows progress by default.

    Raises
    ------
    TypeError
        If it does not take these keywords.
    """
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        # Some functions of C have no signature.
        return False
    kinds = inspect.Parameter
    named = [name for name, one in parameters.items() if one.kind in (kinds.POSITIONAL_OR_KEYWORD, kinds.KEYWORD_ONLY)]
    if not any(one.kind is kinds.VAR_KEYWORD for one in parameters.values()):
        for name in keywords:
            if name not in named:
                raise TypeError(f"unknown keyword {name!r} of the function: {nearest(name, named)}")
    for name in named:
        if parameters[name].default is kinds.empty and name not in keywords:
            raise TypeError(f"{name} is missing; expected it in config or in over")
    return "progress" in named
