#!/usr/bin/env python3
"""Libration's rollouts beside NumPy, numba, a loop in C and PufferLib's CartPole: the same transitions.

    cargo build --release
    python3 -m venv target/peers && target/peers/bin/pip install numpy numba tbb
    target/peers/bin/pip download --no-deps --no-binary pufferlib pufferlib
    tar xzf pufferlib-*.tar.gz --directory target
    target/peers/bin/python benches/rollouts.py --pufferlib target/pufferlib-3.0.0 [--json FILE]

The case is the report's: an oscillator, semi-implicit Euler, 17 bytes a transition (position and velocity
interleaved, action, reward, done), here with the loop closed by a linear policy. Each takes its turn, several
times over, into warm buffers; ratios are medians of ratios of the same round, with their quartiles. NumPy is
written both plainly and with `out=`, numba in one loop and in several, C with time outside and in tiles; of
each the fastest one of the round counts. The C compiler is that of `CC`, or cc. Of PufferLib's sources only
`pufferlib/ocean/cartpole/cartpole.h` is read: where pip fails to prepare the metadata, unpack the archive by
hand.
Exits with 1 if a bar is missed or a peer is not to be had.
"""

import argparse
import ctypes
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

# The other script is imported for numba's threading layer, which is chosen before numba is loaded. Its
# compiled form would lie about in the sources.
sys.dont_write_bytecode = True

from peers import ROOT, np, numba

BENCHES = pathlib.Path(__file__).resolve().parent
# Time step, stiffness over mass, the two gains of the policy, bound of the position. The policy damps: in the
# 2048 steps at most between two starts the amplitude falls to a hundredth, so that no number gets so small
# that the processor takes the slow path.
CASE = tuple(map(np.float32, (0.01, 10.0, -2.0, -0.5, 10.0)))
# For NumPy's functions: of a number it makes an array at each call, a third of the time of a small batch.
ARRAYS = [np.array(number, np.float32) for number in (CASE[0], -CASE[1], *CASE[2:], -0.1)]
TABLE = [(256, 512), (1024, 512), (2048, 1024), (4096, 1024)]
SMALL, CARTPOLES = (256, 16), 4096
TILE = 256
# Rows of actions that CartPole goes through, again and again.
DRAWN = 128
# What is to be reached: peer, task, environments, horizon (None: that of the swing-up), times as fast.
BARS = [("numpy", "regulate", *case, bar) for case, bar in zip(TABLE, (40.0, 12.0, 8.0, 5.0))]
BARS += [("numba", "regulate", *case, 1.6) for case in TABLE]
BARS += [("C loop", "regulate", *SMALL, 2.0), ("CartPole", "swing-up", CARTPOLES, None, 8.0)]
# Not on all threads, but on one.
ALONE = ("C loop", "CartPole")


class Absent(Exception):
    """A peer is not to be had, and why."""


class Buffers:
    """What a rollout writes, and the states that it goes on from."""

    def __init__(self, environments, horizon):
        # Filled, so that every page is there before the first rollout.
        self.states = np.full((horizon, environments, 2), np.nan, np.float32)
        self.actions = np.full((horizon, environments), np.nan, np.float32)
        self.rewards = np.full((horizon, environments), np.nan, np.float32)
        self.dones = np.full((horizon, environments), False)
        self.x, self.v = np.empty(environments, np.float32), np.empty(environments, np.float32)
        self.start(1.0)

    def arrays(self):
        return self.states, self.actions, self.rewards, self.dones, self.x, self.v

    def start(self, x):
        self.x[:], self.v[:] = x, 0.0


def plain(states, actions, rewards, dones, x, v):
    """As one writes it."""
    dt, w2, gain_x, gain_v, xmax = CASE
    for t in range(len(rewards)):
        states[t, :, 0] = x
        states[t, :, 1] = v
        action = gain_x * x + gain_v * v
        actions[t] = action
        v += dt * (-w2 * x + action)
        x += dt * v
        rewards[t] = -(x * x + np.float32(0.1) * v * v)
        dones[t] = np.abs(x) > xmax


def preallocated(states, actions, rewards, dones, x, v):
    """Nothing is allocated, and what goes into a buffer is computed there."""
    dt, stiffness, gain_x, gain_v, xmax, weight = ARRAYS
    scratch = np.empty_like(x)
    for state, action, reward, done in zip(states, actions, rewards, dones):
        state[:, 0] = x
        state[:, 1] = v
        np.multiply(x, gain_x, out=action)
        np.multiply(v, gain_v, out=scratch)
        np.add(action, scratch, out=action)
        np.multiply(x, stiffness, out=scratch)
        np.add(scratch, action, out=scratch)
        np.multiply(scratch, dt, out=scratch)
        np.add(v, scratch, out=v)
        np.multiply(v, dt, out=scratch)
        np.add(x, scratch, out=x)
        np.multiply(x, x, out=reward)
        np.multiply(v, v, out=scratch)
        np.multiply(scratch, weight, out=scratch)
        np.subtract(scratch, reward, out=reward)
        np.abs(x, out=scratch)
        np.greater(scratch, xmax, out=done)


if numba:

    @numba.njit(parallel=True)
    def fused(states, actions, rewards, dones, x, v, dt, w2, gain_x, gain_v, xmax):
        """The report's loop: a tile of environments stays in the nearest cache for all steps."""
        horizon, count = rewards.shape
        for tile in numba.prange((count + TILE - 1) // TILE):
            begin = tile * TILE
            end = min(begin + TILE, count)
            # Copies, so that the compiler knows them apart from the buffers.
            qs, ps = x[begin:end].copy(), v[begin:end].copy()
            for t in range(horizon):
                for i in range(end - begin):
                    e, q, p = begin + i, qs[i], ps[i]
                    states[t, e, 0] = q
                    states[t, e, 1] = p
                    action = gain_x * q + gain_v * p
                    actions[t, e] = action
                    p += dt * (-w2 * q + action)
                    q += dt * p
                    rewards[t, e] = -(q * q + np.float32(0.1) * p * p)
                    dones[t, e] = abs(q) > xmax
                    qs[i], ps[i] = q, p
            x[begin:end], v[begin:end] = qs, ps

    @numba.njit(parallel=True)
    def split(states, actions, rewards, dones, x, v, dt, w2, gain_x, gain_v, xmax):
        """A loop for each array that is written: numba makes vectors of these, and none of the fused loop."""
        horizon, count = rewards.shape
        for tile in numba.prange((count + TILE - 1) // TILE):
            begin = tile * TILE
            end = min(begin + TILE, count)
            q, p = x[begin:end].copy(), v[begin:end].copy()
            for t in range(horizon):
                state, action = states[t, begin:end], actions[t, begin:end]
                reward, done = rewards[t, begin:end], dones[t, begin:end]
                for i in range(q.size):
                    state[i, 0] = q[i]
                    state[i, 1] = p[i]
                for i in range(q.size):
                    action[i] = gain_x * q[i] + gain_v * p[i]
                for i in range(q.size):
                    p[i] += dt * (-w2 * q[i] + action[i])
                for i in range(q.size):
                    q[i] += dt * p[i]
                for i in range(q.size):
                    reward[i] = -(q[i] * q[i] + np.float32(0.1) * p[i] * p[i])
                for i in range(q.size):
                    done[i] = abs(q[i]) > xmax
            x[begin:end], v[begin:end] = q, p


def compiled(folder, source, *options):
    """A C file of this folder as a library."""
    library = pathlib.Path(folder) / f"{source}.so"
    compiler = os.environ.get("CC", "cc").split()
    command = [*compiler, "-O3", "-march=native", "-shared", "-fPIC", *options, BENCHES / f"{source}.c"]
    try:
        subprocess.run([*command, "-o", library, "-lm"], check=True, capture_output=True, text=True)
    except FileNotFoundError:
        raise Absent(f"no {compiler[0]}") from None
    except subprocess.CalledProcessError as fault:
        raise Absent(f"{compiler[0]}: {fault.stderr.strip()}") from None
    return ctypes.CDLL(str(library))


def python_peer(function, *more):
    """A rollout of NumPy or numba; what is returned prepares it for buffers."""

    def prepare(buffers, repetitions):
        def run():
            for _ in range(repetitions):
                function(*buffers.arrays(), *more)

        return run

    return prepare


def c_peer(library, order):
    """A rollout in C, called once for all repetitions."""
    library.repeat.argtypes = [ctypes.c_void_p, ctypes.c_size_t] + 6 * [ctypes.c_void_p]
    library.repeat.argtypes += 2 * [ctypes.c_size_t] + 5 * [ctypes.c_float]
    library.repeat.restype = None
    function = ctypes.cast(library[order], ctypes.c_void_p)

    def prepare(buffers, repetitions):
        horizon, environments = buffers.rewards.shape
        pointers = [array.ctypes.data for array in buffers.arrays()]
        numbers = [environments, horizon, *map(float, CASE)]
        return lambda: library.repeat(function, repetitions, *pointers, *numbers)

    return prepare


def rollout_peers(folder):
    """How to prepare each of the peers, by name and way of writing it; and why one is not to be had."""
    found, absent = {"numpy": {"plain": python_peer(plain), "out=": python_peer(preallocated)}}, {}
    if numba:
        found["numba"] = {"fused": python_peer(fused, *CASE), "split": python_peer(split, *CASE)}
    else:
        absent["numba"] = "no numba"
    try:
        library = compiled(folder, "rollout")
        found["C loop"] = {
            "time outside": c_peer(library, "rollout"),
            "tiled": c_peer(library, "rollout_tiled"),
        }
    except Absent as fault:
        absent["C loop"] = str(fault)
    return found, absent


# What the header of CartPole names of raylib, for a window that is never opened.
RAYLIB = """
typedef struct { unsigned char r, g, b, a; } Color;
typedef struct { float x, y; } Vector2;
enum { KEY_ESCAPE, KEY_TAB };
#define InitWindow(...) ((void)0)
#define CloseWindow() ((void)0)
#define SetTargetFPS(...) ((void)0)
#define ToggleFullscreen() ((void)0)
#define IsKeyDown(...) 0
#define IsKeyPressed(...) 0
#define BeginDrawing() ((void)0)
#define EndDrawing() ((void)0)
#define ClearBackground(...) ((void)0)
#define DrawLine(...) ((void)0)
#define DrawLineEx(...) ((void)0)
#define DrawRectangle(...) ((void)0)
#define DrawText(...) ((void)0)
"""


def cartpole(folder, sources):
    """A function that takes PufferLib's environments so many steps on, with random forces."""
    if not sources:
        raise Absent("--pufferlib")
    header = pathlib.Path(sources) / "pufferlib/ocean/cartpole/cartpole.h"
    if not header.is_file():
        raise Absent(f"no {header}")
    (pathlib.Path(folder) / "raylib.h").write_text(RAYLIB)
    library = compiled(folder, "cartpole", "-fvisibility=hidden", "-I", str(header.parent), "-I", str(folder))
    library.batch.argtypes, library.batch.restype = [ctypes.c_size_t, ctypes.c_int], ctypes.c_void_p
    library.advance.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t]
    library.advance.restype = None
    library.episodes.argtypes, library.episodes.restype = [ctypes.c_void_p], ctypes.c_double
    # Continuous actions, as in PufferLib's own test of performance.
    batch = library.batch(CARTPOLES, 1)
    if not batch:
        raise Absent("no memory")
    actions = np.random.default_rng(0).uniform(-1, 1, (DRAWN, CARTPOLES)).astype(np.float32)

    def run():
        library.advance(batch, actions.ctypes.data, DRAWN)

    # An episode ends after 200 steps in any case.
    for _ in range(-(-200 // DRAWN)):
        run()
    assert library.episodes(batch) >= CARTPOLES, "CartPole does not come to the end of its episodes"
    return run


def size_of(environments, horizon):
    """How a case is called."""
    return f"{environments} × {horizon}" if horizon else str(environments)


def repetitions_of(environments, horizon):
    """Rollouts from one start: calls cost nothing beside them."""
    return max(1, (1 << 19) // (environments * horizon))


def timed(run, transitions, seconds, start=lambda: None):
    """Transitions a second, the median over so many seconds of runs."""
    rates, begun = [], time.perf_counter()
    while len(rates) < 3 or time.perf_counter() - begun < seconds:
        start()
        before = time.perf_counter()
        run()
        rates.append(transitions / (time.perf_counter() - before))
    return statistics.median(rates)


def own_rates(program, file=None):
    """The processor, and Libration's rates by task, environments, horizon and threads."""
    if file:
        text = pathlib.Path(file).read_text()
    else:
        command = [program, "bench", "--rollouts", "--json"]
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    answer = json.loads(text)
    return answer.get("machine", {}).get("cpu", "unknown"), {
        (rate["task"], rate["num_envs"], rate["horizon"], rate["threads"]): rate["transitions_per_second"]
        for rate in answer["rollouts"]
        # As the peers have it.
        if rate["layout"] == "interleaved"
    }


def own_rate(own, task, environments, horizon, threads):
    """One of them; the best over the horizons if that is None. A small rollout takes fewer threads than it may."""
    found = [
        (number, rate)
        for (*key, length, number), rate in own.items()
        if key == [task, environments] and number <= threads and horizon in (None, length)
    ]
    if not found:
        size = size_of(environments, horizon)
        raise SystemExit(f"no rate of Libration: {task}, {size}, threads: {threads}")
    return max(found)[1]


def check(peers):
    """The peers do the same work: after 64 steps their states, actions and rewards agree."""
    # No multiple of a tile, and some begin beyond the bound.
    wanted, start = None, np.linspace(-12, 12, 2 * TILE + 7, dtype=np.float32)
    for name, ways in peers.items():
        for way, prepare in ways.items():
            buffers = Buffers(len(start), 64)
            buffers.start(start)
            prepare(buffers, 1)()
            *numbers, dones, x, v = buffers.arrays()
            # The bound is judged by each peer's own positions: near it, the last bit decides.
            after = np.concatenate([buffers.states[1:, :, 0], x[None]])
            assert (dones == (np.abs(after) > CASE[-1])).all(), f"{name} ({way}) ends other episodes"
            assert 0 < dones.sum() < dones.size
            numbers += [x, v]
            wanted = wanted or numbers
            for one, other in zip(numbers, wanted):
                # A policy that damps amplifies no rounding: 64 steps of a few units in the last place, where
                # the compiler may fuse a product with a sum.
                apart = np.abs(one - other).max() / np.abs(other).max()
                assert apart <= 1e-5, f"{name} ({way}) does other work: {apart:.1e} apart"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--libration", default=str(ROOT / "target/release/libration"))
    parser.add_argument("--own", help="file with the answer of `libration bench --rollouts --json`")
    parser.add_argument("--pufferlib", help="folder of PufferLib's sources")
    most = numba.config.NUMBA_NUM_THREADS if numba else os.cpu_count()
    parser.add_argument("--threads", type=int, default=most, help="threads of numba and of Libration")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=0.2, help="for each peer and case of a round")
    parser.add_argument("--json", help="file for all rates and ratios")
    arguments = parser.parse_args()
    if arguments.rounds < 1:
        parser.error(f"--rounds is {arguments.rounds}; it must be at least 1")
    if not 1 <= arguments.threads <= most:
        parser.error(f"--threads is {arguments.threads}; it must be between 1 and {most}")
    if numba:
        numba.set_num_threads(arguments.threads)
    with tempfile.TemporaryDirectory() as folder:
        return measure(arguments, folder)


def measure(arguments, folder):
    peers, absent = rollout_peers(folder)
    check(peers)
    runs = {}
    for case in [SMALL, *TABLE]:
        buffers, repetitions = Buffers(*case), repetitions_of(*case)
        transitions = case[0] * case[1] * repetitions
        for name, ways in peers.items():
            for way, prepare in ways.items():
                run = prepare(buffers, repetitions)
                runs[name, way, "regulate", *case] = run, transitions, lambda b=buffers: b.start(1.0)
    try:
        run = cartpole(folder, arguments.pufferlib)
        runs["CartPole", "PufferLib", "swing-up", CARTPOLES, None] = run, CARTPOLES * DRAWN, lambda: None
    except Absent as fault:
        absent["CartPole"] = str(fault)
    versions = f"NumPy {np.__version__}, "
    versions += f"numba {numba.__version__} on {arguments.threads} threads" if numba else "no numba"
    print(versions)
    print("Rates in 10⁶ transitions a second; ratios with their quartiles.\n")
    ratios, rates = {}, {}
    for _ in range(arguments.rounds):
        cpu, own = own_rates(arguments.libration, arguments.own)
        fastest = {}
        for (name, way, *case), (run, transitions, start) in runs.items():
            rate = timed(run, transitions, arguments.seconds, start)
            rates.setdefault((*case, name, way), []).append(rate)
            fastest[name, *case] = max(rate, fastest.get((name, *case), 0.0))
        for name, *case, _ in BARS:
            if name not in absent:
                rate = own_rate(own, *case, 1 if name in ALONE else arguments.threads)
                ratios.setdefault((name, *case), []).append(rate / fastest[name, *case])
        for (*case, threads), rate in own.items():
            way = "1 thread" if threads == 1 else f"{threads} threads"
            rates.setdefault((*case, "Libration", way), []).append(rate)
    table = sorted(rates.items(), key=lambda item: (item[0][0], item[0][1], item[0][2] or 0))
    for (task, environments, horizon, name, way), values in table:
        size, rate = size_of(environments, horizon), statistics.median(values) / 1e6
        print(f"  {task:9s} {size:12s} {name + ', ' + way:22s} {rate:10.1f}")
    print()
    missed, rows = 0, []
    for name, task, environments, horizon, bar in BARS:
        print(f"  {task:9s} {size_of(environments, horizon):12s} over {name}: ", end="")
        if name in absent:
            print(f"not to be had: {absent[name]}")
            missed += 1
            continue
        values = sorted(ratios[name, task, environments, horizon])
        median = statistics.median(values)
        low, high = values[len(values) // 4], values[(3 * len(values)) // 4]
        verdict = "reached" if median >= bar else "MISSED"
        missed += verdict == "MISSED"
        print(f"{median:6.1f}  [{low:.1f}, {high:.1f}], wanted {bar}: {verdict}")
        threads = 1 if name in ALONE else arguments.threads
        rows.append(dict(peer=name, task=task, num_envs=environments, horizon=horizon, threads=threads,
                         ratio=median, quartiles=[low, high], wanted=bar))
    if arguments.json:
        listed = [
            dict(task=task, num_envs=environments, horizon=horizon, name=name, way=way,
                 transitions_per_second=statistics.median(values))
            for (task, environments, horizon, name, way), values in table
        ]
        answer = dict(schema="libration.rollouts/2", cpu=cpu, versions=versions, rounds=arguments.rounds,
                      threads=arguments.threads, rates=listed, rows=rows, absent=absent)
        pathlib.Path(arguments.json).write_text(json.dumps(answer, indent=1) + "\n")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
