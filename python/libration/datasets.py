"""Data sets of rollouts on the disk."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping

from . import _native
from ._keywords import check_keywords
from ._progress import Progress, ProgressDisplay
from ._settings import count
from ._toml import text_of

__all__ = ["Flaw", "SETTINGS", "Written", "verify", "write"]

SETTINGS: str = _native._dataset_settings()
"""Default settings file, with comments."""


@dataclass(frozen=True)
class Written:
    """Size of a data set that was written."""

    folder: Path
    transitions: int
    bytes: int
    chunks: int


@dataclass(frozen=True)
class Flaw:
    """A defect of a data set."""

    chunk: str
    """Name of the chunk; empty for the whole data set."""
    path: Path
    """Path of the file, relative to the folder."""
    what: str
    """Description of the defect."""
    repaired: bool = False
    """Whether the file was recomputed and replaced."""


@check_keywords
def write(
    out: str | os.PathLike[str],
    settings: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    *,
    transitions: int | None = None,
    format: str = "parquet",
    shard: tuple[int, int] = (1, 1),
    resume: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Written:
    """Write a data set of rollouts, as ``libration rollout`` does. Ctrl-C keeps all finished chunks.

    Parameters
    ----------
    out:
        Output folder, created if it is missing.
    settings:
        A dictionary with the keys of :data:`SETTINGS`, or the path of a settings file (default: the settings of the report).
    transitions:
        Number of transitions, rounded up to whole steps of all environments (default: that of the settings).
    format:
        ``"parquet"``, ``"npy"`` or ``"minari"``.
    shard:
        Shard ``(index, number)`` of the environments, with an index from 1 to number.
    resume:
        Resume an interrupted run, with the same bytes as without interruption. All chunks are checked first, and broken ones are
        recomputed.
    threads:
        Number of threads (0: one per core).

    Raises
    ------
    ValueError
        For invalid settings or a folder with other content, before anything is written.
    OSError
        If a file cannot be written.
    """
    if not isinstance(format, str):
        raise TypeError(f"format must be a string, not {type(format).__name__}")
    if not isinstance(shard, (tuple, list)) or len(shard) != 2:
        raise TypeError(f"shard is {shard!r}, but it must be (index, number), as (1, 4)")
    index, of = shard
    writing = {
        "out": Path(out),
        "transitions": None if transitions is None else count("transitions", transitions, 1, 2**63),
        "format": format,
        "shard": [count("shard", index, 0, 2**32), count("number of shards", of, 0, 2**32)],
        "resume": bool(resume),
        "threads": count("threads", threads, 0, 1024),
    }
    with ProgressDisplay(progress) as display:

        def report(done: int, total: int, size: int) -> None:
            display.update(done / max(total, 1), f"{done:,} transitions, {size / 1e9:.2f} GB")

        counts = _native._write_dataset(text_of("settings", settings), writing, report if display.enabled else None)
    return Written(Path(out), *counts)


@check_keywords
def verify(
    folder: str | os.PathLike[str],
    *,
    replay: bool = False,
    repair: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> list[Flaw]:
    """Return the defects of a data set, as ``libration verify`` prints them.

    With ``replay`` the data set is recomputed from its settings and compared. With ``repair`` missing, truncated or altered files are
    recomputed and replaced; they are in the list with ``repaired`` true, and have their original bytes.

    Raises
    ------
    ValueError
        If the folder has no data set; with ``replay`` or ``repair`` also if another version of the package wrote it.
    OSError
        If its manifest cannot be read, or a file cannot be replaced.
    """
    with ProgressDisplay(progress) as display:

        def report(_: int, __: int, size: int) -> None:
            display.update(0.0, f"{size / 1e9:.2f} GB")

        threads = count("threads", threads, 0, 1024)
        callback = report if display.enabled else None
        flaws = _native._verify_dataset(Path(folder), bool(replay), bool(repair), threads, callback)
    return [Flaw(chunk, Path(path), what, repaired) for chunk, path, what, repaired in flaws]
