"""Tasks of Ray: options, results in order, cancellation."""

from __future__ import annotations

from typing import Any, Callable, Sequence

from ._settings import count, positive

try:
    import ray
    from ray.exceptions import NodeDiedError, OutOfMemoryError, RayTaskError, WorkerCrashedError
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(f"libration.cluster requires Ray ({error}); help: pip install 'libration[ray]'", name=error.name) from error

_SECONDS_TO_CANCEL = 10.0
"""Time after which a cancelled task is killed."""


def start() -> None:
    """Connect to Ray: to the cluster of ``RAY_ADDRESS``, to one that runs on this machine, or to a new one."""
    if not ray.is_initialized():
        ray.init()


def cpus(num_cpus: Any) -> float:
    """Return the number of CPUs of a task: 1 or more, of which each is a thread.

    Raises
    ------
    TypeError, ValueError
        For any other number.
    """
    number = positive("num_cpus", num_cpus)
    if number < 1 or number != int(number):
        raise ValueError(f"num_cpus is {num_cpus!r}, but it must be a whole number from 1")
    return number


def attempts(retries: Any) -> int:
    """Return the largest number of repetitions of a task, -1 for any."""
    return count("retries", retries, -1, 2**31 - 1)


def granted_threads() -> int:
    """Return the number of threads that Ray grants this task."""
    return max(1, int(ray.get_runtime_context().get_assigned_resources().get("CPU", 1)))


def results_of(references: Sequence[Any], report: Callable[[int], None], lost: Callable[[int, str], Any] | None = None) -> list[Any]:
    """Return the results of tasks in their order, and cancel all after the first exception or after Ctrl-C.

    Exceptions of a task are raised as they are. ``lost`` returns the result of a task whose workers died more often than its retries, by its
    number and a message.
    """
    numbers = {reference: i for i, reference in enumerate(references)}
    found: list[Any] = [None] * len(numbers)
    pending = list(references)
    try:
        while pending:
            done, pending = ray.wait(pending, num_returns=len(pending), timeout=0.0)
            if not done:
                done, pending = ray.wait(pending, num_returns=1, timeout=0.5)
            for reference in done:
                try:
                    found[numbers[reference]] = ray.get(reference)
                except (WorkerCrashedError, NodeDiedError, OutOfMemoryError) as error:
                    if lost is None:
                        raise
                    found[numbers[reference]] = lost(numbers[reference], f"{type(error).__name__}: the worker of the point died, also in each retry")
            report(len(references) - len(pending))
    except BaseException as error:
        cancel(pending)
        if isinstance(error, RayTaskError):
            raise error.cause from None
        raise
    return found


def cancel(pending: Sequence[Any]) -> None:
    """Cancel tasks as by Ctrl-C, and kill those that do not end."""
    for reference in pending:
        ray.cancel(reference, force=False)
    if pending:
        _, pending = ray.wait(list(pending), num_returns=len(pending), timeout=_SECONDS_TO_CANCEL)
    for reference in pending:
        ray.cancel(reference, force=True)
