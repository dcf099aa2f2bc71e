"""A data set in shards, each a task of Ray."""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import time
from pathlib import Path
from typing import Any, Mapping

import ray

from . import datasets
from ._keywords import check_keywords
from ._progress import Progress, ProgressDisplay
from ._ray_tasks import attempts, cpus, granted_threads, results_of, start
from ._settings import count
from ._toml import text_of
from .equations import EquationSystem, check_system
from .systems import System, with_commands

_SETTINGS = "settings.toml"
_SECONDS_TO_WAIT = 60.0
"""Time for which a task waits for the lock of the one before, whose node may still be dying."""


@check_keywords
def rollout(
    settings: Mapping[str, Any] | str | os.PathLike[str] | None,
    out: str | os.PathLike[str],
    *,
    shards: int,
    system: EquationSystem | System | None = None,
    transitions: int | None = None,
    format: str = "parquet",
    num_cpus: int = 1,
    retries: int = -1,
    resume: bool = False,
    progress: Progress = None,
) -> datasets.Written:
    """Write one data set of rollouts on a cluster, with the bytes of :func:`libration.datasets.write`.

    Each shard is a task that writes to ``OUT.parts`` beside ``out``. All nodes must see this folder under the same path. A task whose worker
    or node dies is repeated and continues after its last chunk. At the end the parts become one data set with one manifest, and
    ``OUT.parts`` is removed. Ctrl-C and errors cancel the tasks; the parts stay for ``resume``.

    Parameters
    ----------
    settings:
        As for :func:`libration.datasets.write`; only this process reads the file.
    out:
        Output folder.
    shards:
        Number of shards, at most the number of groups of environments.
    system, transitions, format:
        As for :func:`libration.datasets.write`; ``"minari"`` has one shard.
    num_cpus:
        Number of CPUs of a shard. It has as many threads.
    retries:
        Largest number of repetitions of a shard whose worker or node dies (-1: any).
    resume:
        Whether to continue an interrupted run with the same settings and number of shards.
    progress:
        As for :func:`libration.datasets.write`.

    Raises
    ------
    TypeError, ValueError
        For invalid settings, a folder with other content, or parts of another run, before anything is written.
    OSError
        If a file cannot be written, or a node does not see the folder.
    """
    shards = count("shards", shards, 1, 1_000_000)
    granted, repetitions = cpus(num_cpus), attempts(retries)
    if not isinstance(format, str):
        raise TypeError(f"format must be a string, not {type(format).__name__}")
    if format == "minari" and shards > 1:
        raise ValueError(f"shards is {shards}, but the format 'minari' has no shards; expected 1")
    subject = with_commands(system)
    check_system("cluster.rollout", subject, settings=settings)
    if subject is not None and isinstance(settings, Mapping):
        datasets._check_replaced(settings)
    text = text_of("settings", settings)
    folder = Path(out).absolute()
    parts, joined = (folder.with_name(folder.name + ending) for ending in (".parts", ".parts.joined"))
    given: dict[str, Any] = {"system": system, "transitions": transitions, "format": format, "resume": True, "progress": False}
    if resume and joined.exists():
        # Their removal was interrupted.
        shutil.rmtree(joined)
    if resume and not parts.exists() and folder.is_dir() and any(folder.iterdir()):
        # The run was interrupted after the join, or it was one of a single process.
        return datasets.write(folder, settings, **{**given, "progress": progress})
    _check_folders(folder, parts, shards, text, resume)
    start()
    parts.mkdir(parents=True, exist_ok=True)
    (parts / _SETTINGS).write_text(text, encoding="utf-8")
    try:
        task = ray.remote(_write_shard).options(num_cpus=granted, max_retries=repetitions)
        with ProgressDisplay(progress) as display:
            shown = _Written(parts, shards, display)
            results_of([task.remote(str(parts), text, (i, shards), given) for i in range(1, shards + 1)], shown.report)
    except (TypeError, ValueError):
        # Settings are checked before a manifest is written.
        if not any(parts.glob("*/manifest.jsonl")):
            shutil.rmtree(parts)
        raise
    written = datasets.join([parts / _name(i, shards) for i in range(1, shards + 1)], folder, link=True, resume=folder.exists(), progress=False)
    # Parts of which only some files are left could not be resumed.
    parts.rename(joined)
    shutil.rmtree(joined)
    return written


def _name(index: int, shards: int) -> str:
    return f"{index:0{len(str(shards))}}-of-{shards}"


def _check_folders(folder: Path, parts: Path, shards: int, text: str, resume: bool) -> None:
    """Check that the folders are free, or have an interrupted run of the same settings.

    Raises
    ------
    ValueError
        If they do not.
    """
    if folder.exists() and not (resume and parts.exists()) and (not folder.is_dir() or any(folder.iterdir())):
        raise ValueError(f"out is {folder}, which has other content; expected a folder that is empty or missing")
    if not parts.exists():
        return
    if not resume:
        raise ValueError(f"{parts} has parts of an interrupted run; expected no such folder; help: resume=True, or delete it")
    for path in parts.iterdir():
        found = re.fullmatch(r"\d+-of-(\d+)", path.name)
        if found and int(found[1]) != shards:
            raise ValueError(f"shards is {shards}, but {parts} has parts of {found[1]} shards; expected {found[1]}")
    before = parts / _SETTINGS
    if before.exists() and before.read_text(encoding="utf-8") != text:
        raise ValueError(f"settings differ from those of the interrupted run in {before}; expected the same")


def _write_shard(parts: str, text: str, shard: tuple[int, int], given: dict[str, Any]) -> None:
    """Write or continue a shard, in a task."""
    settings = Path(parts) / _SETTINGS
    if not settings.is_file() or settings.read_text(encoding="utf-8") != text:
        raise OSError(f"node {socket.gethostname()} does not see {settings}; expected out on a file system that all nodes share")
    deadline = time.monotonic() + _SECONDS_TO_WAIT
    while True:
        try:
            datasets.write(settings.with_name(_name(*shard)), settings, shard=shard, threads=granted_threads(), **given)
            return
        except (OSError, ValueError) as error:
            if "another process" not in str(error) or time.monotonic() > deadline:
                raise
            time.sleep(0.2)


class _Written:
    """Progress of all shards, from their manifests."""

    def __init__(self, parts: Path, shards: int, display: ProgressDisplay) -> None:
        self._display, self._total = display, 0
        self._manifests = {parts / _name(i, shards) / "manifest.jsonl": 0 for i in range(1, shards + 1)}
        self._transitions = 0

    def report(self, finished: int) -> None:
        if not self._display.enabled:
            return
        for path, offset in self._manifests.items():
            if not path.exists():
                continue
            with path.open("rb") as file:
                file.seek(offset)
                lines = file.read()
            lines = lines[: lines.rfind(b"\n") + 1]
            self._manifests[path] += len(lines)
            for line in map(json.loads, lines.splitlines()):
                if "data" in line:
                    self._total = line["data"]["num_envs"] * line["data"]["steps"]
                else:
                    self._transitions += line["holds"]["transitions"]
        done = f"{self._transitions:,} transitions, {finished} of {len(self._manifests)} shards"
        self._display.update(self._transitions / max(self._total, 1), done)
