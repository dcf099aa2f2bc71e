"""Audits of steps that several threads call at once."""

import dataclasses
import math
import sys
import threading
import time

import numpy as np
import pytest
from test_probe import DT, OMEGA2, audit, kinds, pendulum, pendulums, text_of

from libration import probe
from libration._step_functions import rows_of_step
from libration.hosts import Host


def scratch_step(pause):
    """A step that keeps its rate in memory that all threads share."""
    scratch = np.zeros(1)

    def step(x, u, dt):
        scratch[0] = -OMEGA2 * math.sin(x[0]) + u[0]
        pause()
        v = x[1] + dt * scratch[0]
        return [x[0] + dt * v, v]

    return step


@pytest.mark.parametrize("pause", [lambda: time.sleep(1e-4), lambda: [None for _ in range(5000)]], ids=["sleep", "loop"])
def test_memory_that_threads_share_is_found(pause):
    report = audit(scratch_step(pause), threads=4)
    assert kinds(report) == ["bits-differ"] and not report.holds
    text = text_of(report, "bits-differ")
    assert text.startswith("4 threads at once against one gives other bits: first in step ")
    assert report.bits["checks"][-1]["name"] == "4 threads at once against one"
    # In one thread the step has no fault.
    assert audit(scratch_step(pause)).findings == []


def test_memory_that_threads_share_is_found_in_batches():
    after = np.zeros((4096, 2))

    def batch(states, actions, dt):
        rows = after[: len(states)]
        rows[:] = pendulums(states, actions, dt)
        time.sleep(1e-4)
        return rows.copy()

    assert kinds(audit(batch, batched=True, threads=2)) == ["bits-differ"]
    assert audit(pendulums, batched=True, threads=2).findings == []


def test_a_pure_step_and_one_with_memory_of_each_thread_have_no_finding_in_threads():
    local = threading.local()

    def of_thread(x, u, dt):
        local.rate = -OMEGA2 * math.sin(x[0]) + u[0]
        time.sleep(1e-5)
        v = x[1] + dt * local.rate
        return [x[0] + dt * v, v]

    for step in (pendulum, of_thread):
        report = audit(step, threads=3)
        assert report.findings == []
        assert report.bits["checks"][-1] == {"name": "3 threads at once against one", "difference": None}
    assert "threads" not in str(audit(pendulum).bits["checks"])


def test_all_threads_call_the_step_at_once_and_the_switch_interval_stays():
    barrier, before, threads = threading.Barrier(5, timeout=30), sys.getswitchinterval(), set(threading.enumerate())

    def together(x, u, dt):
        if threading.current_thread() is not threading.main_thread():
            barrier.wait()
        return pendulum(x, u, dt)

    assert audit(together, threads=5).findings == []
    assert sys.getswitchinterval() == before and set(threading.enumerate()) <= threads


@pytest.mark.parametrize("error", [RuntimeError, threading.BrokenBarrierError, SystemExit])
def test_an_exception_in_a_thread_is_raised_as_it_is(error):
    # Libraries of other tests leave threads of their own.
    raised, threads = error("joint 3"), set(threading.enumerate())

    def broken(x, u, dt):
        if threading.current_thread() is not threading.main_thread():
            raise raised
        return pendulum(x, u, dt)

    with pytest.raises(error, match="joint 3") as caught:
        audit(broken, threads=4)
    assert caught.value is raised and set(threading.enumerate()) <= threads


def test_nan_in_threads_only_is_an_error():
    def spoiled(x, u, dt):
        return pendulum(x, u, dt if threading.current_thread() is threading.main_thread() else math.nan)

    with pytest.raises(ValueError, match="step has a number in 'x1' that is not finite in 2 threads at once, but not in one"):
        audit(spoiled, threads=2)


def test_a_host_has_threads_unless_its_rows_continue_a_simulation():
    step = rows_of_step(scratch_step(lambda: time.sleep(1e-4)), 2, False)
    host = Host(step, np.zeros(2), np.zeros(1), DT, ("q", "v"), ("u",), "scratch", "")
    assert kinds(probe.host(host, threads=2)) == ["bits-differ"]
    with pytest.raises(ValueError, match="threads is 2, but rows of the host continue a simulation; expected None"):
        probe.host(dataclasses.replace(host, memory=True), threads=2)
