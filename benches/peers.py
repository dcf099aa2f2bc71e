#!/usr/bin/env python3
"""Libration beside NumPy and numba: the same oscillators, the same float, the same number of steps.

    cargo build --release
    python3 -m venv target/peers && target/peers/bin/pip install numpy numba tbb
    target/peers/bin/python benches/peers.py [--json target/peers.json]

Each takes its turn, several times over; ratios are medians of ratios of the same round, with their
quartiles. NumPy works in place, as a user writes it and with preallocated results. numba runs in parallel
and keeps a block of particles in the cache for all steps. Exits with 1 if a bar is missed, unless the
arithmetic of the machine, measured by `libration bench`, does not go as far. `libration lab` judges the
ratios of the file if its configuration names it, as `peers` under `[throughput]`.
"""

import argparse
import glob
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

# numba loads TBB by name; pip puts it where the loader does not look.
libraries = glob.glob(os.path.join(sys.prefix, "lib*", "libtbb.so*"))
os.environ.setdefault("NUMBA_THREADING_LAYER", "tbb" if libraries else "omp")
if libraries and os.path.dirname(libraries[0]) not in os.environ.get("LD_LIBRARY_PATH", ""):
    folder = os.path.dirname(libraries[0])
    os.environ["LD_LIBRARY_PATH"] = folder + ":" + os.environ.get("LD_LIBRARY_PATH", "")
    os.execv(sys.executable, [sys.executable, *sys.argv])

import numpy as np

try:
    import numba
except ImportError:
    numba = None

OMEGA2, DT, FUSED = 10.0, 1e-3, 200
ROOT = pathlib.Path(__file__).resolve().parent.parent
# What is to be reached: implementation, peer, number of particles, times as fast.
BARS = [
    ("fused", "numpy in place", 1_000, 80.0),
    ("fused", "numpy in place", 100_000, 12.0),
    ("fused", "numpy in place", 10_000_000, 45.0),
    ("threads", "numba blocked", 100_000, 1.5),
    ("threads", "numba blocked", 10_000_000, 1.5),
]


def in_place(x, v, steps):
    """As one writes it: the products still make new arrays."""
    stiffness, dt = x.dtype.type(-OMEGA2), x.dtype.type(DT)
    for _ in range(steps):
        a = stiffness * x
        v += dt * a
        x += dt * v


def preallocated(x, v, steps):
    """Nothing is allocated."""
    stiffness, dt, scratch = x.dtype.type(-OMEGA2), x.dtype.type(DT), np.empty_like(x)
    for _ in range(steps):
        np.multiply(x, stiffness, out=scratch)
        np.multiply(scratch, dt, out=scratch)
        np.add(v, scratch, out=v)
        np.multiply(v, dt, out=scratch)
        np.add(x, scratch, out=x)


PEERS = {"numpy in place": in_place, "numpy out=": preallocated}

if numba:
    BLOCK = 1024

    @numba.njit(parallel=True)
    def _blocked(x, v, stiffness, dt, steps):
        for block in numba.prange((x.size + BLOCK - 1) // BLOCK):
            q = x[block * BLOCK : (block + 1) * BLOCK]
            p = v[block * BLOCK : (block + 1) * BLOCK]
            for _ in range(steps):
                for i in range(q.size):
                    p[i] += dt * (stiffness * q[i])
                    q[i] += dt * p[i]

    def blocked(x, v, steps):
        _blocked(x, v, x.dtype.type(-OMEGA2), x.dtype.type(DT), steps)

    PEERS["numba blocked"] = blocked


def peer_rate(peer, x, v, seconds):
    """Particle-steps a second, the median over so many seconds of runs."""
    count = x.size
    # As many as Libration takes in a pass. NumPy at ten million particles takes 50 ms a step, and its rate
    # does not depend on their number.
    steps = 8 if count >= 1_000_000 and peer.startswith("numpy") else FUSED
    rates, begun = [], time.perf_counter()
    while len(rates) < 3 or time.perf_counter() - begun < seconds:
        start = time.perf_counter()
        PEERS[peer](x, v, steps)
        rates.append(count * steps / (time.perf_counter() - start))
    return statistics.median(rates)


def own_rates(program, counts, effort):
    """Rates of Libration by implementation, float and number of particles."""
    command = [program, "bench", "--implementation", "fused,threads", "--effort", effort, "--json"]
    command += ["--num-trajectories", ",".join(map(str, counts)), "--dtype", "f32,f64"]
    answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return {
        (rate["implementation"], rate["dtype"], rate["count"]): rate["steps_per_second"]
        for rate in answer["rates"]
    }


def machine(program):
    """The processor, and the steps a second that independent arithmetic amounts to on one core, by float."""
    command = [program, "bench", "--effort", "quick", "--json"]
    # Exit code 1 says that a ratio was missed, which is no reason to measure nothing.
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode not in (0, 1):
        run.check_returncode()
    answer = json.loads(run.stdout)
    table = next(table for table in answer["tables"] if table["name"] == "fused steps")
    rows = [dict(zip(table["columns"], row)) for row in table["rows"]]
    return answer["machine"]["cpu"], {
        row["float"]: 1e9 * row["independent arithmetic (10⁹ steps/s)"]
        for row in rows
        if row["integrator"] == "symplectic Euler"
    }


def check(program):
    """The peers do the same work: their bits are those of Libration."""
    command = [program, "simulate", "--system", "oscillator", "--set", f"omega2={OMEGA2}"]
    command += ["--integrator", "symplectic-euler", "--dt", str(DT), "--steps", "1000"]
    command += ["--save-every", "1000", "--q", "1", "--v", "0", "--format", "json"]
    answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    wanted = [answer["rows"][-1][answer["columns"].index(name)] for name in ("q0", "v0")]
    for name, peer in PEERS.items():
        x, v = np.ones(7), np.zeros(7)
        peer(x, v, 1000)
        assert (x == wanted[0]).all() and (v == wanted[1]).all(), f"{name} gives other bits"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--libration", default=str(ROOT / "target/release/libration"))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", help="file for all ratios")
    arguments = parser.parse_args()
    if arguments.rounds < 1:
        parser.error(f"--rounds is {arguments.rounds}; it must be at least 1")
    check(arguments.libration)
    counts = sorted({bar[2] for bar in BARS})
    cpu, peak = machine(arguments.libration)
    versions = f"NumPy {np.__version__}, "
    versions += f"numba {numba.__version__} on {numba.get_num_threads()} threads" if numba else "no numba"
    print(versions)
    print("Rates in 10⁹ particle-steps a second; ratios with their quartiles.\n")
    ratios, rates = {}, {}
    arrays = {
        (kind, count): (np.ones(count, kind), np.zeros(count, kind))
        for kind in ("f4", "f8")
        for count in counts
    }
    for pair in arrays.values():
        for peer in PEERS.values():
            peer(*pair, 1)
    for _ in range(arguments.rounds):
        own = own_rates(arguments.libration, counts, "quick")
        for (kind, count), (x, v) in arrays.items():
            number = {"f4": "f32", "f8": "f64"}[kind]
            for peer in PEERS:
                rate = peer_rate(peer, x, v, 0.2)
                rates.setdefault((peer, number, count), []).append(rate)
                for implementation in ("fused", "threads"):
                    ratio = own[implementation, number, count] / rate
                    ratios.setdefault((implementation, peer, number, count), []).append(ratio)
        for key, rate in own.items():
            rates.setdefault(key, []).append(rate)
    for (name, number, count), values in sorted(rates.items(), key=lambda item: item[0][1:]):
        print(f"  {number}  N = {count:<9d} {name:16s} {statistics.median(values) / 1e9:10.3f}")
    print()
    missed, rows = 0, []
    for implementation, peer, count, bar in BARS:
        if peer not in PEERS:
            print(f"{implementation} over {peer}: not to be had")
            missed += 1
            continue
        for number in ("f32", "f64"):
            values = sorted(ratios[implementation, peer, number, count])
            median = statistics.median(values)
            low, high = values[len(values) // 4], values[(3 * len(values)) // 4]
            cores = numba.get_num_threads() if numba and implementation == "threads" else 1
            most = peak[number] * cores / statistics.median(rates[peer, number, count])
            verdict = "reached" if median >= bar else "MISSED"
            if median < bar and most < bar:
                verdict = f"beyond this machine, whose arithmetic goes to {most:.1f}"
            missed += verdict == "MISSED"
            print(f"  {number}  N = {count:<9d} {implementation} over {peer}: {median:7.1f}", end="")
            print(f"  [{low:.1f}, {high:.1f}], wanted {bar}: {verdict}")
            rows.append(dict(implementation=implementation, peer=peer, dtype=number, count=count,
                             ratio=median, quartiles=[low, high], wanted=bar, most=most))
    if arguments.json:
        answer = dict(schema="libration.peers/2", cpu=cpu, versions=versions, rounds=arguments.rounds,
                      rows=rows)
        pathlib.Path(arguments.json).write_text(json.dumps(answer, indent=1) + "\n")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
