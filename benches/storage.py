#!/usr/bin/env python3
"""Libration's replay buffers beside cpprb's, and its Parquet files beside pyarrow's: the same work.

    cargo build --release
    python3 -m venv target/peers && target/peers/bin/pip install numpy cpprb pyarrow
    target/peers/bin/python benches/storage.py [--json FILE] [--folder DIR]

A buffer holds a million transitions of the report's oscillator (position, velocity, action, reward and end of
an episode; cpprb keeps the next observation besides) in 32-bit floats. A batch has 256 of them; by priority, a
batch is drawn and each of it is given another priority. pyarrow has the columns of the data set in memory and
writes them with the same settings: groups of 2^20 rows, Zstandard of level 1, floats as BYTE_STREAM_SPLIT, counts
as DELTA_BINARY_PACKED with extremes, flags as RLE, into files as large as Libration's, waiting for the disk after each.
Libration computes them as well. Each takes its turn, several times over; ratios are medians of ratios of the
same round, with their quartiles.
Exits with 1 if a bar is missed.
"""

import argparse
import importlib.metadata
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import cpprb
import numpy as np
import pyarrow
import pyarrow.parquet

ROOT = pathlib.Path(__file__).resolve().parent.parent
KEPT, BATCH = 1_000_000, 256
# What is to be reached: what, peer, times as fast.
BARS = [("sample", "cpprb", 5.0), ("prioritised", "cpprb", 5.0), ("parquet", "pyarrow", 2.0)]
# The data set that is timed, and as much of it as pyarrow writes at a turn.
SETTINGS, CHUNK = "[policy.random]\n", 1 << 22


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--libration", default=str(ROOT / "target/release/libration"))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=0.5, help="for each peer of a round")
    parser.add_argument("--folder", default=tempfile.gettempdir(), help="where files are written")
    parser.add_argument("--json", help="file for all rates and ratios")
    arguments = parser.parse_args()
    if arguments.rounds < 1:
        parser.error(f"--rounds is {arguments.rounds}; it must be at least 1")
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        return measure(arguments, pathlib.Path(folder))


def measure(arguments, folder):
    peers = {"sample": uniform(), "prioritised": prioritised(), "parquet": parquet(arguments.libration, folder)}
    version = importlib.metadata.version("cpprb")
    versions = f"cpprb {version}, pyarrow {pyarrow.__version__}, NumPy {np.__version__}"
    print(versions)
    rates = {what: ([], []) for what, _, _ in BARS}
    for _ in range(arguments.rounds):
        cpu, threads, own = own_rates(arguments)
        for what, (run, work) in peers.items():
            rates[what][0].append(own[what])
            rates[what][1].append(timed(run, work, arguments.seconds))
    missed, rows = 0, []
    for what, peer, bar in BARS:
        own, its = rates[what]
        ratios = sorted(a / b for a, b in zip(own, its))
        median = statistics.median(ratios)
        quartiles = [ratios[len(ratios) // 4], ratios[(3 * len(ratios)) // 4]]
        verdict = "reached" if median >= bar else "MISSED"
        missed += verdict == "MISSED"
        print(f"  {what:12s} {statistics.median(own):14.0f}/s over {peer} {statistics.median(its):12.0f}/s: {median:6.2f}"
              f"  [{quartiles[0]:.2f}, {quartiles[1]:.2f}], wanted {bar}: {verdict}")
        rows.append(dict(what=what, peer=peer, threads=[threads[what], 1], ratio=median, quartiles=quartiles, wanted=bar,
                         own=statistics.median(own), its=statistics.median(its)))
    if arguments.json:
        answer = dict(schema="libration.storage/1", cpu=cpu, versions=versions, rounds=arguments.rounds, rows=rows)
        pathlib.Path(arguments.json).write_text(json.dumps(answer, indent=1) + "\n")
    return 1 if missed else 0


def own_rates(arguments):
    """The processor, and Libration's threads and rates by what is timed."""
    command = [arguments.libration, "--quiet", "bench", "--storage", "--effort", "standard", "--json"]
    command += ["--folder", arguments.folder]
    answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    threads = {rate["what"]: rate["threads"] for rate in answer["storage"]}
    return answer["machine"].get("cpu") or "unknown", threads, {rate["what"]: rate["rate"] for rate in answer["storage"]}


def timed(run, work, seconds):
    """Units of work a second, over as many runs as fill the time."""
    run()
    count, begun = 0, time.perf_counter()
    while count == 0 or time.perf_counter() - begun < seconds:
        run()
        count += 1
    return work * count / (time.perf_counter() - begun)


FIELDS = {"obs": {"shape": 2}, "act": {"shape": 1}, "rew": {}, "next_obs": {"shape": 2}, "done": {}}


def filled(buffer):
    numbers = np.random.default_rng(0)
    for _ in range(KEPT // 10_000):
        seen = numbers.normal(size=(10_000, 2)).astype(np.float32)
        buffer.add(obs=seen, act=seen[:, :1], rew=-np.abs(seen[:, 0]), next_obs=seen, done=np.zeros(10_000))
    return buffer


def uniform():
    buffer = filled(cpprb.ReplayBuffer(KEPT, FIELDS))
    return lambda: buffer.sample(BATCH), 1


def prioritised():
    buffer = filled(cpprb.PrioritizedReplayBuffer(KEPT, FIELDS, alpha=0.6))

    def run():
        batch = buffer.sample(BATCH, 0.4)
        buffer.update_priorities(batch["indexes"], np.abs(batch["rew"][:, 0]) + 1e-3)

    return run, 1


def parquet(program, folder):
    (folder / "settings.toml").write_text(SETTINGS)
    words = ["--quiet", "rollout", "--config", "settings.toml", "--out", "set", "--transitions", str(CHUNK)]
    subprocess.run([program, *words], check=True, cwd=folder)
    [path] = (folder / "set/transitions").iterdir()
    table = pyarrow.parquet.read_table(path).combine_chunks()
    encodings = {"bool": "RLE", "float": "BYTE_STREAM_SPLIT"}
    encoding = {field.name: encodings.get(str(field.type), "DELTA_BINARY_PACKED") for field in table.schema}
    counts = [name for name, kind in encoding.items() if kind == "DELTA_BINARY_PACKED"]
    theirs = folder / "theirs.parquet"

    def run():
        with open(theirs, "wb") as file:
            pyarrow.parquet.write_table(table, file, row_group_size=1 << 20, compression="zstd", compression_level=1,
                                        use_dictionary=False, column_encoding=encoding, write_statistics=counts)
            file.flush()
            os.fsync(file.fileno())

    return run, table.num_rows


if __name__ == "__main__":
    sys.exit(main())
