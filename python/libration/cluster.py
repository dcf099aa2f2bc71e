"""Sweeps, data sets and rollouts on a cluster of Ray, with the bits of one process.

Requires Ray: ``pip install 'libration[ray]'``. Without a connection, the functions connect to the cluster of the environment variable
``RAY_ADDRESS``, or to one that runs on this machine, or start Ray here. All nodes need the same version of the package.
"""

from __future__ import annotations

from typing import Any, Callable, Iterable, Mapping

# First, for its error message without Ray.
from ._ray_tasks import attempts, cpus, ray, results_of, start
from ._cluster_collector import CollectedRollout, Collector, collect
from ._cluster_rollout import rollout
from ._keywords import check_keywords
from ._progress import Progress, ProgressDisplay
from .sweeps import Row, Sweep, SweepTable

__all__ = ["CollectedRollout", "Collector", "collect", "rollout", "sweep"]

_PARTS_PER_CPU = 16
"""Tasks for each CPU: enough that all end at about the same time, and few enough that starting them takes no time."""


@check_keywords
def sweep(
    function: Callable[..., Any],
    config: Mapping[str, Any] | None = None,
    *,
    over: Mapping[str, Iterable[Any]],
    units: Mapping[str, str] | None = None,
    num_cpus: int = 1,
    retries: int = 10,
    progress: Progress = None,
) -> SweepTable:
    """Return the table of a function over a grid of its keywords, computed on a cluster.

    The table has the bits of :func:`libration.sweep`. A task whose worker or node dies is repeated. Ctrl-C cancels all tasks.

    Parameters
    ----------
    function, config, over, units:
        As for :class:`libration.Sweep`. A function of a module must be importable on all nodes; Ray sends one of a script or a notebook.
    num_cpus:
        Number of CPUs of a task, for functions with threads.
    retries:
        Largest number of repetitions of a task whose worker or node dies (-1: any). Beyond it, its points are rows with an ``error``.
    progress:
        As for :func:`libration.sweep`.

    Raises
    ------
    TypeError, ValueError
        As for :class:`libration.Sweep`, before any call.
    """
    grid = Sweep(function, config, over=over, units=units)
    granted, repetitions = cpus(num_cpus), attempts(retries)
    start()
    task = ray.remote(_rows).options(num_cpus=granted, max_retries=repetitions)
    tasks_at_once = max(1, int(ray.cluster_resources().get("CPU", 1) / granted))
    parts = grid.parts(min(len(grid), _PARTS_PER_CPU * tasks_at_once))
    shared = ray.put(grid)
    with ProgressDisplay(progress) as display:

        def report(done: int) -> None:
            display.update(done / len(parts), f"{done:,} of {len(parts):,} parts of {len(grid):,} points")

        def lost(number: int, message: str) -> list[Row]:
            return [grid.failed(message) for _ in parts[number]]

        found = results_of([task.remote(shared, part) for part in parts], report, lost)
    return grid.table([row for rows in found for row in rows])


def _rows(grid: Sweep, part: range) -> list[Row]:
    return grid.rows(part)
