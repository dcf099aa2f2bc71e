"""The same bytes on 1 to 3 nodes and in 1 to 4 shards, while nodes are killed at random.

    pip install '.[ray]'
    python examples/python/cluster_kills.py [--kills 50] [--seed 1]

All nodes are on this machine. Ray notices a dead node after its health checks, which are faster here than by default.
"""

from __future__ import annotations

import argparse
import hashlib
import random
import tempfile
import threading
import time
from pathlib import Path

import ray
from ray.cluster_utils import Cluster

import libration
import libration.cluster

SETTINGS = {
    "num_envs": 96,
    "steps": 3000,
    "dt": 1e-4,
    "substeps": 400,
    "chunk": {"num_envs": 8, "steps": 100},
    "noise": {"jitter": 0.05},
}
NODE = {"num_cpus": 1, "object_store_memory": 80 * 2**20}
HEALTH = {"health_check_period_ms": 500, "health_check_timeout_ms": 500, "health_check_failure_threshold": 3}


def digest(folder: Path) -> str:
    """Of the names and bytes of all files."""
    state = hashlib.sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        state.update(str(path.relative_to(folder)).encode() + b"\0" + path.read_bytes())
    return state.hexdigest()[:16]


def killed_rollout(cluster: Cluster, workers: list, out: Path, shards: int, kills: int, chance: random.Random) -> int:
    """Write a data set while nodes die, and return how many did."""
    thread = threading.Thread(target=libration.cluster.rollout, args=(SETTINGS, out), kwargs={"shards": shards, "format": "npy"})
    thread.start()
    done = 0
    while thread.is_alive() and done < kills:
        thread.join(chance.uniform(0.2, 1.5))
        if thread.is_alive() and any(out.with_name(f"{out.name}.parts").glob("*/manifest.jsonl")):
            i = chance.randrange(len(workers))
            cluster.remove_node(workers[i], allow_graceful=False)
            workers[i] = cluster.add_node(**NODE)
            done += 1
    thread.join()
    return done


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    head = {**NODE, "num_cpus": 0, "include_dashboard": False, "_system_config": HEALTH}
    cluster = Cluster(initialize_head=True, head_node_args=head)
    ray.init(address=cluster.address, log_to_driver=False, logging_level="error")
    with tempfile.TemporaryDirectory() as folder:
        alone = Path(folder) / "alone"
        libration.datasets.write(alone, SETTINGS, format="npy", threads=1)
        print(f"one process: {digest(alone)}")
        total, configurations = 0, 12
        for nodes in (1, 2, 3):
            workers = [cluster.add_node(**NODE) for _ in range(nodes)]
            for shards in (1, 2, 3, 4):
                out, start = Path(folder) / f"{nodes}-{shards}", time.perf_counter()
                kills = killed_rollout(cluster, workers, out, shards, -(-(given.kills - total) // configurations), chance)
                total, configurations = total + kills, configurations - 1
                seconds = time.perf_counter() - start
                print(f"nodes {nodes}, shards {shards}, kills {kills}: {digest(out)}, {seconds:.1f} s", flush=True)
                assert digest(out) == digest(alone)
            for node in workers:
                cluster.remove_node(node)
    print(f"{total} nodes were killed, and all bytes are the same")
    ray.shutdown()
    cluster.shutdown()


if __name__ == "__main__":
    main()
