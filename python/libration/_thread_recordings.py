"""Recordings of a step that several threads call at once."""

from __future__ import annotations

import sys
import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._settings import count
from .hosts.host import Host, Recording, Step

Array = NDArray[np.float64]

_CALLS = 64
_ROWS = 8
# Part of a scale by which states and actions lie around the point: that of the other checks of bits.
_SPREAD = 1 / 32
# Time in s after which the interpreter may switch threads; that of Python, 5 ms, is longer than most steps.
_SWITCH = 1e-6


def thread_count(value: Any) -> int | None:
    """Return the number of threads, or None without threads.

    Raises
    ------
    TypeError, ValueError
        If it is not a whole number from 2 to 64.
    """
    return None if value is None else count("threads", value, 2, 64)


def thread_recording(host: Host, state_scale: Array, action_scale: Array, threads: int, batched: bool) -> Recording:
    """Return the results of the same calls in the main thread and in several threads at once, calls × threads × states.

    Each thread makes the same calls but begins at another one, so that threads that share memory write different numbers to it. All
    threads wait for each other before each call.

    Parameters
    ----------
    state_scale, action_scale:
        Typical deviations of the n states and m actions, in whose neighbourhood calls are made.
    batched:
        Whether a call has several rows, which count as calls of their own.

    Raises
    ------
    ValueError
        If a result in one of the threads is not finite, although those in the main thread are. Exceptions of the step are raised as they are.
    """
    rows = _ROWS if batched else 1
    states = _around(host.state, state_scale, _CALLS * rows).reshape(_CALLS, rows, -1)
    actions = _around(host.action, action_scale, _CALLS * rows).reshape(_CALLS, rows, -1)
    alone = _in_this_thread(host, states, actions)
    together = _Threads(host.step, states, actions, host.dt, threads).run()
    if np.isfinite(alone).all() and not np.isfinite(together).all():
        state = host.states[int(np.argwhere(~np.isfinite(together))[0][-1])]
        raise ValueError(f"step has a number in {state!r} that is not finite in {threads} threads at once, but not in one")
    wide = (_CALLS * rows, threads, len(host.state))
    first = np.broadcast_to(alone[:, np.newaxis], together.shape)
    # Threads × rows to rows × threads, so that a row counts as a call.
    pair = [np.swapaxes(found, 1, 2).reshape(wide) for found in (first, together)]
    return f"{threads} threads at once against one", pair[0], pair[1]


def _around(center: Array, scale: Array, number: int) -> Array:
    turns = (np.arange(number * len(center)) * 0.6180339887498949 + 0.1) % 1.0
    found: Array = center + _SPREAD * scale * (turns.reshape(number, len(center)) - 0.5)
    return found


def _in_this_thread(host: Host, states: Array, actions: Array) -> Array:
    """Return the results, calls × rows × states."""
    return np.stack([np.array(host.step(x, u, host.dt)) for x, u in zip(states.copy(), actions.copy())])


class _Threads:
    """The same calls in several threads at once."""

    def __init__(self, step: Step, states: Array, actions: Array, dt: float, threads: int) -> None:
        self.step, self.states, self.actions, self.dt, self.number = step, states, actions, dt, threads
        self.found = np.empty((len(states), threads, *states.shape[1:]))
        self.barrier = threading.Barrier(threads)
        self.raised: list[BaseException] = []

    def run(self) -> Array:
        """Return the results, calls × threads × rows × states."""
        workers = [threading.Thread(target=self._call_all, args=(thread,), daemon=True) for thread in range(self.number)]
        before = sys.getswitchinterval()
        sys.setswitchinterval(_SWITCH)
        try:
            for worker in workers:
                worker.start()
            for worker in workers:
                worker.join()
        finally:
            sys.setswitchinterval(before)
            # After an interrupt of the main thread no thread makes another call.
            self.barrier.abort()
        if self.raised:
            raise self.raised[0]
        return self.found

    def _call_all(self, thread: int) -> None:
        calls = len(self.states)
        try:
            for k in range(calls):
                call = (k + thread * calls // self.number) % calls
                x, u = self.states[call].copy(), self.actions[call].copy()
                if not self._all_are_ready():
                    return
                self.found[call, thread] = self.step(x, u, self.dt)
        except BaseException as error:
            self.raised.append(error)
            self.barrier.abort()

    def _all_are_ready(self) -> bool:
        """Wait for the other threads; False after an exception in one of them."""
        try:
            self.barrier.wait()
        except threading.BrokenBarrierError:
            return False
        return True
