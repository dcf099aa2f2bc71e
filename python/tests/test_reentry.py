"""Nobody waits for ever: whoever cannot have environments now gets them later, or is told so."""

import os
import subprocess
import sys

import pytest

# Each script takes a second. What hangs cannot be interrupted: so each is a process of its own.
PATIENCE = 30

HEAD = """
import os, signal, sys, threading, time
import numpy as np
import libration
from libration.policies import Constant, Random

def made(num_envs=1000, substeps=20, **given):
    envs = libration.Environments("Pendulum", num_envs, substeps=substeps, **given)
    envs.reset(seed=0)
    return envs

def tell(signal_number):
    threading.Timer(0.1, os.kill, (os.getpid(), signal_number)).start()
"""

SCRIPTS = {
    "a_rollout_is_read_while_another_thread_fills_it": """
envs = made()
out = envs.rollout(Constant(), 200)
worker = threading.Thread(target=envs.rollout, args=(Constant(), 200), kwargs={"out": out})
worker.start()
while worker.is_alive():
    out.episodes, out.transitions
worker.join()
""",
    "threads_that_ask_again_and_again_take_turns": """
envs = made(64, 1)
rollout = envs.rollout(Random(-1, 1), 16)
buffer = libration.ReplayBuffer(envs, steps=100)
buffer.insert(rollout)
work = (lambda: buffer.sample(256), lambda: buffer.insert(rollout), lambda: envs.rollout(Random(-1, 1), 16), lambda: envs.states)
done, end = [0] * len(work), time.monotonic() + 1

def again(i):
    while time.monotonic() < end:
        work[i]()
        done[i] += 1

threads = [threading.Thread(target=again, args=(i,)) for i in range(len(work))]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
# Without turns the second and the last had one, or none.
assert min(done) > 10, done
""",
    "two_threads_fill_one_rollout": """
some, others = made(), made()
out = some.rollout(Constant(), 200)
workers = [
    threading.Thread(target=envs.rollout, args=(Constant(), 200), kwargs={"out": out})
    for envs in (some, others)
]
[worker.start() for worker in workers]
[worker.join() for worker in workers]
""",
    "environments_are_closed_while_another_thread_fills_a_rollout": """
envs, found = made(), []
worker = threading.Thread(target=lambda: found.append(envs.rollout(Constant(), 1000)))
worker.start()
time.sleep(0.05)
envs._close()
worker.join()
assert np.isfinite(found[0].rewards).all()
""",
    "a_handler_of_a_signal_looks_at_environments_amid_a_rollout": """
envs, told = made(substeps=2000), []

def look(*_):
    try:
        told.append(envs.states)
    except RuntimeError as error:
        told.append(error)

signal.signal(signal.SIGTERM, look)
tell(signal.SIGTERM)
envs.rollout(Constant(), 400)
assert len(told) == 1
envs.step(np.zeros(1000))
""",
    "actions_are_made_by_asking_the_environments_that_take_them": """
envs = made(3)

class Asking:
    def __array__(self, dtype=None, copy=None):
        return envs.states[:, 0]

try:
    envs.step(Asking())
except RuntimeError:
    pass
envs.step(np.zeros(3))
""",
    "a_finalizer_looks_at_environments_amid_a_step": """
import gc
envs = made(3, autoreset_mode="SameStep", max_episode_steps=2)

class Ring:
    def __init__(self):
        self.itself = self

    def __del__(self):
        try:
            envs.states
        except RuntimeError:
            pass

gc.set_threshold(5)
for _ in range(500):
    Ring()
    envs.step([1.0, 2.0, 3.0])
""",
    "somebody_who_waits_for_another_thread_is_interrupted": """
envs = made(substeps=20_000)
threading.Thread(target=envs.rollout, args=(Constant(), 2000), daemon=True).start()
time.sleep(0.1)
signal.signal(signal.SIGINT, signal.default_int_handler)
tell(signal.SIGINT)
try:
    envs.states
except KeyboardInterrupt:
    os._exit(0)
sys.exit("nobody interrupted")
""",
    "a_process_is_forked_while_another_thread_rolls_out": """
envs = made(substeps=2000)
worker = threading.Thread(target=envs.rollout, args=(Constant(), 100))
worker.start()
time.sleep(0.05)
child = os.fork()
if child == 0:
    # It would wait for a thread that it does not have.
    signal.alarm(5)
    try:
        envs.states
    except RuntimeError:
        pass
    os._exit(0)
assert os.waitpid(child, 0)[1] == 0
worker.join()
""",
    "a_process_ends_while_a_thread_of_it_rolls_out": """
envs = made()

def work():
    while True:
        envs.rollout(Random(-1, 1), 50)

threading.Thread(target=work, daemon=True).start()
time.sleep(0.1)
""",
}


@pytest.mark.skipif(os.name != "posix", reason="signals are others on this platform")
@pytest.mark.parametrize("case", SCRIPTS)
def test_nothing_hangs_where(case):
    ran = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", "-c", HEAD + SCRIPTS[case]],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert ran.returncode == 0 and ran.stderr == "", ran.stderr
