"""A cluster of two nodes on this machine: the bits of one process, also when workers and nodes die."""

import filecmp
import os
import signal
import socket
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import libration
from libration.policies import MLP, Linear, Random

if os.environ.get("LIBRATION_REQUIRE_RAY") is None:
    pytest.importorskip("ray")
import ray  # noqa: E402
from ray.cluster_utils import Cluster  # noqa: E402

from libration import cluster  # noqa: E402

SETTINGS = {"num_envs": 96, "steps": 200, "chunk": {"num_envs": 16, "steps": 50}, "noise": {"jitter": 0.05}}
LONG = {"num_envs": 96, "steps": 40_000, "chunk": {"num_envs": 16, "steps": 2000}, "noise": {"jitter": 0.05}}
GRID = {"config": {"system": "oscillator", "integrator": "rk4"}, "over": {"dt": [0.01, 0.02, 0.03, 9.0], "steps": [1, 2]}}
MEMORY = 80 * 2**20


@pytest.fixture(scope="module")
def nodes():
    # Ray notices a dead node after a second, not after tens of them.
    health = {"health_check_period_ms": 300, "health_check_timeout_ms": 600, "health_check_failure_threshold": 3, "health_check_initial_delay_ms": 300}
    head = {"num_cpus": 1, "object_store_memory": MEMORY, "include_dashboard": False, "_system_config": health}
    made = Cluster(initialize_head=True, head_node_args=head)
    made.second = made.add_node(num_cpus=1, object_store_memory=MEMORY)
    ray.init(address=made.address, log_to_driver=False, logging_level="error")
    yield made
    ray.shutdown()
    made.shutdown()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "data"
    libration.datasets.write(out, SETTINGS, format="npy", threads=1)
    return out


@pytest.fixture(scope="module")
def long(tmp_path_factory):
    out = tmp_path_factory.mktemp("long") / "data"
    libration.datasets.write(out, LONG, format="npy", threads=1)
    return out


def same(a, b):
    files = [sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()) for folder in (a, b)]
    return files[0] == files[1] and filecmp.cmpfiles(a, b, files[0], shallow=False)[1:] == ([], [])


def refused(call, error, message, folder):
    before = sorted(folder.iterdir())
    with pytest.raises(error, match=message):
        call()
    assert sorted(folder.iterdir()) == before


LONGEST = 120.0
"""Seconds after which something will never be: a worker alone takes tens of them to start on a busy machine."""


def wait_for(what):
    end = time.monotonic() + LONGEST
    while not (found := what()):
        assert time.monotonic() < end
        time.sleep(0.01)
    return found


def pid_and_wait(path, flag):
    """Write the process to a file, and wait where a file exists, unless nobody interrupts it."""
    Path(path).write_text(str(os.getpid()))
    end = time.monotonic() + LONGEST
    while Path(flag).exists() and time.monotonic() < end:
        time.sleep(0.01)
    return 1.0


def die_once(flag, x):
    """Kill the worker at the first call."""
    if x == 3 and not Path(flag).exists():
        Path(flag).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return 0.1 * x


def die_at_three(x):
    if x == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return x


ray.cloudpickle.register_pickle_by_value(__import__(__name__))


def test_a_sweep_has_the_digest_of_one_process(nodes):
    seen = []
    found = cluster.sweep(libration.analyze, **GRID, progress=lambda part, text: seen.append((part, text)))
    assert found.digest() == libration.sweep(libration.analyze, **GRID).digest()
    assert seen[-1] == (1.0, "8 of 8 parts of 8 points")


def test_a_killed_worker_costs_a_sweep_no_row(nodes, tmp_path):
    config, over = {"flag": str(tmp_path / "flag")}, {"x": [1, 2, 3, 4]}
    found = cluster.sweep(die_once, config, over=over)
    assert (tmp_path / "flag").exists() and found.digest() == libration.sweep(die_once, config, over=over).digest()


def test_a_point_that_kills_each_worker_is_an_error_and_no_lost_sweep(nodes):
    found = cluster.sweep(die_at_three, over={"x": [1, 2, 3, 4]}, retries=1)
    assert found["value"] == [1, 2, None, 4] and found["error"][2].startswith("WorkerCrashedError: the worker of the point died, also in each retry")


def test_an_error_of_a_call_is_in_its_row_on_a_cluster_too(nodes):
    found = cluster.sweep(libration.analyze, {"system": "oscillator", "integrator": "rk4", "steps": 1}, over={"dt": [0.1, -1.0]})
    assert found["error"][0] is None and "dt" in found["error"][1]


def test_ctrl_c_cancels_all_tasks_of_a_sweep(nodes, tmp_path):
    path, flag = tmp_path / "pid", tmp_path / "flag"
    flag.touch()
    thread = threading.Thread(target=lambda: (wait_for(path.exists), time.sleep(0.1), os.kill(os.getpid(), signal.SIGINT)))
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        cluster.sweep(pid_and_wait, {"path": str(path)}, over={"flag": [str(flag)]})
    thread.join()
    # The CPU is free again, although the flag still exists.
    wait_for(lambda: ray.available_resources().get("CPU") == 2.0)


@pytest.mark.parametrize("shards", [1, 2, 3])
def test_any_number_of_shards_gives_the_bytes_of_one_process(nodes, whole, tmp_path, shards):
    out = tmp_path / "data"
    found = cluster.rollout(SETTINGS, out, shards=shards, format="npy")
    assert same(out, whole) and sorted(tmp_path.iterdir()) == [out]
    assert (found.transitions, found.chunks) == (96 * 200, 24) and found.folder == out
    assert libration.datasets.verify(out) == []


def test_a_system_by_equations_has_the_bytes_of_one_process(nodes, tmp_path):
    task = {"reward": "-q^2 - 0.01*u^2", "start": {"q": (-1, 1)}}
    driven = libration.System(acceleration={"q": "-10*q + u"}, inputs=["u"], task=task)
    policy = {"policy": {"linear": {"weights": [-2.0, -1.0]}}, "num_envs": 32, "chunk": {"num_envs": 16}}
    libration.datasets.write(tmp_path / "one", policy, system=driven, transitions=3200)
    cluster.rollout(policy, tmp_path / "two", shards=2, system=driven, transitions=3200)
    assert same(tmp_path / "one", tmp_path / "two")


def worker_of(parts):
    """Return the process of a task that has written a chunk and is not finished."""
    with_chunk = [m for m in parts.glob("*/manifest.jsonl") if 2 < m.read_bytes().count(b"\n") < 40]
    for manifest in with_chunk:
        for process in Path("/proc").glob("[0-9]*"):
            try:
                if any(os.readlink(fd) == str(manifest) for fd in (process / "fd").iterdir()):
                    return int(process.name)
            except OSError:
                pass
    return None


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="finds the worker by its open files")
def test_the_shard_of_a_killed_worker_continues_to_the_same_bytes(nodes, long, tmp_path):
    out, parts, kills = tmp_path / "data", tmp_path / "data.parts", []

    def kill():
        for _ in range(2):
            kills.append(wait_for(lambda: (pid := worker_of(parts)) not in kills and pid))
            os.kill(kills[-1], signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    cluster.rollout(LONG, out, shards=2, format="npy")
    thread.join()
    assert len(kills) == 2 and os.getpid() not in kills and same(out, long)


def test_a_killed_node_changes_no_byte(nodes, long, tmp_path):
    out, found = tmp_path / "data", []
    thread = threading.Thread(target=lambda: found.append(cluster.rollout(LONG, out, shards=2, format="npy")))
    thread.start()
    manifests = tmp_path / "data.parts"
    wait_for(lambda: len([m for m in manifests.glob("*/manifest.jsonl") if m.read_bytes().count(b"\n") > 2]) == 2)
    assert thread.is_alive()
    nodes.remove_node(nodes.second, allow_graceful=False)
    try:
        thread.join(60)
        assert found and same(out, long)
    finally:
        nodes.second = nodes.add_node(num_cpus=1, object_store_memory=MEMORY)


def test_parts_stay_after_ctrl_c_and_resume_to_the_same_bytes(nodes, long, tmp_path):
    out, parts = tmp_path / "data", tmp_path / "data.parts"
    seen = []

    def interrupt(part, text):
        seen.append(part)
        if 0 < part < 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cluster.rollout(LONG, out, shards=2, format="npy", progress=interrupt)
    assert parts.is_dir() and not out.exists() and 0 < seen[-1] < 1
    wait_for(lambda: ray.available_resources().get("CPU") == 2.0)
    refused(lambda: cluster.rollout(LONG, out, shards=2), ValueError, "parts of an interrupted run.*help: resume=True", tmp_path)
    refused(lambda: cluster.rollout(LONG, out, shards=3, resume=True), ValueError, "shards is 3, but .* has parts of 2 shards", tmp_path)
    refused(lambda: cluster.rollout(SETTINGS, out, shards=2, resume=True), ValueError, "settings differ", tmp_path)
    kept = [(path, path.stat().st_mtime_ns) for path in parts.glob("*/reward/*.npy")]
    cluster.rollout(LONG, out, shards=2, format="npy", resume=True)
    assert kept and [(out / "reward" / path.name).stat().st_mtime_ns for path, _ in kept] == [when for _, when in kept]
    assert same(out, long) and not parts.exists()
    assert cluster.rollout(LONG, out, shards=2, format="npy", resume=True).chunks == 120


def test_an_interrupted_removal_of_the_parts_leaves_a_whole_data_set_that_resumes(nodes, whole, tmp_path, monkeypatch):
    out = tmp_path / "data"

    def interrupted(folder):
        os.remove(next(Path(folder).glob("*/manifest.jsonl")))
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("shutil.rmtree", interrupted)
        with pytest.raises(KeyboardInterrupt):
            cluster.rollout(SETTINGS, out, shards=2, format="npy")
    assert cluster.rollout(SETTINGS, out, shards=2, format="npy", resume=True).chunks == 24
    assert same(out, whole) and sorted(tmp_path.iterdir()) == [out]


def test_a_resumed_run_that_never_began_runs_on_the_cluster(nodes, whole, tmp_path):
    out = tmp_path / "data"
    out.mkdir()
    refused(lambda: cluster.rollout(SETTINGS, out, shards=7, format="npy", resume=True), ValueError, "7", tmp_path)
    cluster.rollout(SETTINGS, out, shards=2, format="npy", resume=True)
    assert same(out, whole)


@pytest.mark.parametrize(
    ("keywords", "error", "message"),
    [
        ({"shards": 0}, ValueError, "shards is 0, but it must be 1 to"),
        ({"shards": "2"}, TypeError, "shards must be an integer"),
        ({"shards": 7}, ValueError, "7"),
        ({"shards": 2, "num_cpus": 0.5}, ValueError, "num_cpus is 0.5, but it must be a whole number from 1"),
        ({"shards": 2, "retries": -2}, ValueError, "retries is -2, but it must be -1 to"),
        ({"shards": 2, "format": "minari"}, ValueError, "shards is 2, but the format 'minari' has no shards; expected 1"),
        ({"shards": 2, "format": "csv"}, ValueError, "csv"),
        ({"shards": 2, "settings": {"environment": 3}}, ValueError, "unknown key `environment`.*did you mean `num_envs`"),
        ({"shard": 2}, TypeError, "did you mean 'shards'"),
    ],
)
def test_wrong_arguments_of_a_rollout_leave_no_file(nodes, tmp_path, keywords, error, message):
    refused(lambda: cluster.rollout(**{"settings": SETTINGS, "out": tmp_path / "data", **keywords}), error, message, tmp_path)


def test_a_folder_with_other_content_is_refused(nodes, tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "mine.txt").touch()
    refused(lambda: cluster.rollout(SETTINGS, tmp_path / "data", shards=2), ValueError, "has other content; expected a folder", tmp_path)


def test_a_node_without_the_folder_is_named(nodes, tmp_path):
    from libration._cluster_rollout import _write_shard

    with pytest.raises(OSError, match=f"node {socket.gethostname()} does not see .*; expected out on a file system that all nodes share"):
        _write_shard(str(tmp_path / "elsewhere"), "", (1, 1), {})


def environments(num_envs=10):
    return libration.Environments(
        "Pendulum", num_envs, jitter=0.05, action_delay=(0.0, 0.05), max_episode_steps=20, omega2=np.linspace(10, 20, num_envs)
    )


def assert_equal(found, wanted):
    names = ("observations", "actions", "rewards", "terminated", "truncated", "transitions", "last_observations")
    for name in names:
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name), strict=True)
    for name, values in wanted.episodes.items():
        np.testing.assert_array_equal(found.episodes[name], values, strict=True)


def test_a_collector_has_the_bits_of_one_process_also_after_its_actors_die(nodes):
    envs = environments()
    with cluster.collect(envs, Random(-6.0, 6.0), horizon=30, actors=2, seed=5, log_probs=True) as collector:
        found = [collector.collect()]
        ray.kill(collector._actors[1])
        found += [collector.collect(), collector.collect()]
    envs.reset(seed=5)
    for one in found:
        wanted = envs.rollout(Random(-6.0, 6.0), 30, log_probs=True)
        assert_equal(one, wanted)
        np.testing.assert_array_equal(one.log_probs, wanted.log_probs)
    with pytest.raises(RuntimeError, match="the collector is closed"):
        collector.collect()


def test_weights_of_each_rollout_go_to_all_actors_and_references_come_back(nodes):
    envs = environments()
    weights = [[-2.0, 1.0, -0.5], [1.0, 0.0, 0.0]]
    with cluster.collect(envs, Linear, horizon=5, actors=2) as collector:
        first = collector.collect(weights[0])
        with pytest.raises(ValueError, match="there are 2 weights, but there must be 3"):
            collector.collect([1.0, 2.0])
        # An error changes no state, though some actors may have been ahead.
        parts = ray.get(collector.collect_refs(ray.put(weights[1])))
    envs.reset(seed=0)
    assert_equal(first, envs.rollout(Linear(weights[0]), 5))
    wanted = envs.rollout(Linear(weights[1]), 5)
    np.testing.assert_array_equal(np.concatenate([part["rewards"] for part in parts], axis=1), wanted.rewards)


@pytest.mark.parametrize(
    ("keywords", "error", "message"),
    [
        ({"actors": 0}, ValueError, "actors is 0, but it must be 1 to 10"),
        ({"actors": 3}, ValueError, "actors is 3 with 1 CPUs each, but the cluster has 2 CPUs; expected at most 2"),
        ({"horizon": 0}, ValueError, "horizon is 0"),
        ({"seed": -1}, ValueError, "seed is -1"),
        ({"policy": 3}, TypeError, "policy must be one of libration.policies or a function of weights, not int"),
        ({"policy": Linear([1.0])}, ValueError, "there are 1 weights, but there must be 3"),
        ({"environments": "Pendulum"}, TypeError, "environments must be libration.Environments, not str"),
        ({"actor": 2}, TypeError, "did you mean 'actors'"),
    ],
)
def test_wrong_arguments_of_a_collector_are_refused(nodes, keywords, error, message):
    with pytest.raises(error, match=message):
        cluster.collect(**{"environments": environments(), "policy": MLP, "horizon": 5, "actors": 2, **keywords})
