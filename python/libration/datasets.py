"""Data sets of rollouts on the disk."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Sequence

from . import _native
from ._dataset_environments import keywords_of_settings, read_settings
from ._keywords import check_keywords
from ._progress import Progress, ProgressDisplay
from ._settings import count
from ._toml import text_of
from .equations import EquationSystem, check_system
from .systems import System, with_commands

__all__ = ["Flaw", "Flaws", "SETTINGS", "Written", "environment_spec", "join", "recover_environment", "verify", "write"]

SETTINGS: str = _native._dataset_settings()
"""Default settings file, with comments."""

_KEYS_OF_EQUATIONS = {"system": "equations", "system.equations": "max_action", "task": "expressions"}
"""The only key of each table of the settings whose others a system by equations replaces."""


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


class Flaws(list[Flaw]):
    """The defects of a data set."""

    not_examined: tuple[str, ...] = ()
    """The parts of the data set that were not compared with anything, in words."""


@check_keywords
def write(
    out: str | os.PathLike[str],
    settings: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    *,
    system: EquationSystem | System | None = None,
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
    system:
        A system by equations (:class:`libration.EquationSystem`), or one of the catalogue as its equations, in place of that of the settings, as ``libration rollout --system FILE``. Its
        task is ``{"task": {"expressions": {...}}}`` of the settings, or else its own. ``{"system": {"equations": {"max_action": 10.0}}}`` of
        the settings limits actions. Keys of a dictionary that belong to systems of the catalogue are errors; those of a file are ignored.
    transitions:
        Number of transitions, rounded up to whole steps of all environments (default: that of the settings).
    format:
        ``"parquet"``, ``"npy"`` or ``"minari"``.
    shard:
        Shard ``(index, number)`` of the environments, with an index from 1 to number.
    resume:
        Resume an interrupted run after its last chunk, with the same bytes as without interruption. Files that are missing or truncated are
        written again; :func:`verify` reads all of them.
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
    subject = with_commands(system)
    check_system("datasets.write", subject, settings=settings)
    if subject is not None and isinstance(settings, Mapping):
        _check_replaced(settings)
    source = None if subject is None else subject._text
    text = text_of("settings", settings)
    with ProgressDisplay(progress) as display:

        def report(done: int, total: int, size: int) -> None:
            display.update(done / max(total, 1), f"{done:,} transitions, {size / 1e9:.2f} GB")

        counts = _native._write_dataset(text, source, writing, report if display.enabled else None)
    return Written(Path(out), *counts)


def _check_replaced(settings: Mapping[str, Any]) -> None:
    """Check that settings have no key that a system by equations replaces.

    Raises
    ------
    ValueError
        With the key and the one that is allowed in its place.
    """
    if settings.get("start") is not None:
        raise ValueError(
            "settings has 'start', which a system by equations replaces; expected 'task.expressions.start' or none"
        )
    for path, allowed in _KEYS_OF_EQUATIONS.items():
        table: Any = settings
        for key in path.split("."):
            table = table.get(key) if isinstance(table, Mapping) else None
        for key in table if isinstance(table, Mapping) else ():
            if key != allowed:
                raise ValueError(
                    f"settings has '{path}.{key}', which a system by equations replaces; expected '{path}.{allowed}' or none"
                )


@check_keywords
def join(
    parts: Sequence[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    link: bool = False,
    resume: bool = False,
    progress: Progress = None,
) -> Written:
    """Join the shards of a data set, as ``libration join`` does. The result has the bytes that a single run writes.

    Parameters
    ----------
    parts:
        Folders of all shards, in any order.
    out:
        Output folder of the data set.
    link:
        Link files instead of copying them, where the file system can. They are not read, and share their bytes with the shards, which may then be
        removed.
    resume:
        Resume an interrupted join.

    Raises
    ------
    ValueError
        If the shards are not those of one data set, or one is missing, unfinished or there twice, before anything is written.
    OSError
        If a file cannot be read or written.
    """
    if isinstance(parts, (str, os.PathLike)):
        raise TypeError(f"parts is {parts!r}, but it must be a list of folders")
    folders = [Path(part) for part in parts]
    with ProgressDisplay(progress) as display:

        def report(done: int, _: int, size: int) -> None:
            display.update(0.0, f"{done:,} transitions, {size / 1e9:.2f} GB")

        callback = report if display.enabled else None
        counts = _native._join_datasets(folders, Path(out), bool(link), bool(resume), callback)
    return Written(Path(out), *counts)


@check_keywords
def verify(
    folder: str | os.PathLike[str],
    *,
    replay: bool = False,
    repair: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Flaws:
    """Return the defects of a data set, as ``libration verify`` prints them, and in ``not_examined`` what was not compared.

    Without ``replay`` that is whether the settings lead to these files, and the counts of ended episodes; of a data set of another
    version it is all but checksums. With ``replay`` the data set is recomputed from its settings and compared. With ``repair`` missing, truncated or altered files are
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
        found, not_examined = _native._verify_dataset(Path(folder), bool(replay), bool(repair), threads, callback)
    flaws = Flaws(Flaw(chunk, Path(path), what, repaired) for chunk, path, what, repaired in found)
    flaws.not_examined = tuple(not_examined)
    return flaws


def environment_spec(folder: str | os.PathLike[str]) -> Any:
    """Return the specification of the environment with which a data set was written, a ``gymnasium.envs.registration.EnvSpec``.

    It becomes JSON and back without loss (``to_json``). ``gymnasium.make`` makes the environment from it.

    Raises
    ------
    ModuleNotFoundError
        Without Gymnasium.
    ValueError
        If the folder has no data set, or its system and task are those of no environment of the package.
    """
    from gymnasium.envs.registration import EnvSpec

    from .envs import DATASET_ID

    settings = read_settings(folder)
    keywords_of_settings(settings)
    limit = settings["max_episode_steps"] or None
    return EnvSpec(DATASET_ID, "libration.envs:DatasetEnv", max_episode_steps=limit, kwargs={"settings": settings})


def recover_environment(folder: str | os.PathLike[str], **changed: Any) -> Any:
    """Return the single Gymnasium environment with which a data set was written, in any format.

    System, integrator, task, latencies, noise, start and time limit are those of the data set; the policy and the seed are not part of an
    environment.

    Parameters
    ----------
    **changed:
        Keywords of :class:`libration.Environments` in place of those of the data set, and those of ``gymnasium.make``.

    Raises
    ------
    ModuleNotFoundError, ValueError
        As for :func:`environment_spec`.
    """
    import gymnasium

    spec = environment_spec(folder)
    try:
        return gymnasium.make(spec, **changed)
    except (TypeError, KeyError, AttributeError, IndexError, OverflowError, RecursionError) as error:
        if changed and _can_be_made(spec):
            raise
        raise ValueError(
            f"{os.fspath(folder)!r} has settings of which no environment can be made ({type(error).__name__}: {error}); "
            "expected those of datasets.write"
        ) from None


def _can_be_made(spec: Any) -> bool:
    """Whether an environment can be made without changed keywords."""
    import gymnasium

    try:
        gymnasium.make(spec).close()
    except Exception:
        return False
    return True
