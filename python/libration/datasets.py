"""Data sets of rollouts on the disk: streamed, resumed, verified."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping

from . import _native
from ._named import named
from ._progress import Progress, Shown
from ._settings import count
from ._toml import text_of

__all__ = ["Flaw", "SETTINGS", "Written", "verify", "write"]

SETTINGS: str = _native._dataset_settings()
"""The settings of the default data set, as a file with comments."""


@dataclass(frozen=True)
class Written:
    """What is in a data set."""

    folder: Path
    transitions: int
    bytes: int
    chunks: int


@dataclass(frozen=True)
class Flaw:
    """What is wrong with a data set."""

    chunk: str
    """Which part of it; empty if it is all of it."""
    path: Path
    """Which file, in its folder."""
    what: str
    repaired: bool = False
    """Whether the file has been computed again and replaced."""


@named
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
    """Write a data set chunk by chunk: what ``libration rollout`` does. Ctrl-C loses no chunk that is finished.

    Parameters
    ----------
    out:
        A folder, which is made.
    settings:
        A dictionary with the keys of :data:`SETTINGS`, or the path of a file.
    transitions:
        How many in place of what the settings say, rounded up to whole steps of all environments.
    format:
        ``"parquet"``, ``"npy"`` or ``"minari"``.
    shard:
        Which part, from 1 on, and of how many.
    resume:
        Resume an interrupted run: the bytes are those of an uninterrupted one. What is there is read first, and broken files are
        computed again.
    threads:
        How many; 0 for as many as there are cores.

    Raises
    ------
    ValueError
        For settings that cannot be, or a folder that holds something else, before anything is written.
    OSError
        If a file cannot be written.
    """
    if not isinstance(format, str):
        raise TypeError(f"format must be a string, not {type(format).__name__}")
    if not isinstance(shard, (tuple, list)) or len(shard) != 2:
        raise TypeError(f"shard is {shard!r}, but it must be which and of how many, as (1, 4)")
    index, of = shard
    writing = {
        "out": Path(out),
        "transitions": None if transitions is None else count("transitions", transitions, 1, 2**63),
        "format": format,
        "shard": [count("shard", index, 0, 2**32), count("number of shards", of, 0, 2**32)],
        "resume": bool(resume),
        "threads": count("threads", threads, 0, 1024),
    }
    with Shown(progress) as shown:

        def tell(done: int, total: int, size: int) -> None:
            shown.tell(done / max(total, 1), f"{done:,} transitions, {size / 1e9:.2f} GB")

        told = _native._write_dataset(text_of("settings", settings), writing, tell if shown.wanted else None)
    return Written(Path(out), *told)


@named
def verify(
    folder: str | os.PathLike[str],
    *,
    replay: bool = False,
    repair: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> list[Flaw]:
    """Read a data set and say what is wrong with it, if anything: what ``libration verify`` does.

    With ``replay`` it is computed again from its settings, and compared. With ``repair`` broken files (missing, truncated or altered
    ones) are computed again and replaced: they are in the list with ``repaired`` true, and have the bytes that they had.

    Raises
    ------
    ValueError
        If there is no data set; with ``replay`` or ``repair`` also if another version of the package wrote it.
    OSError
        If its manifest cannot be read, or a file cannot be replaced.
    """
    with Shown(progress) as shown:

        def tell(_: int, __: int, size: int) -> None:
            shown.tell(0.0, f"{size / 1e9:.2f} GB")

        threads = count("threads", threads, 0, 1024)
        told = tell if shown.wanted else None
        flaws = _native._verify_dataset(Path(folder), bool(replay), bool(repair), threads, told)
    return [Flaw(chunk, Path(path), what, repaired) for chunk, path, what, repaired in flaws]
