"""What comes out, to the bit."""

import numpy as np
import pytest
from common import PERTURBED

import libration


def fnv(data: bytes, found: int = 0xCBF29CE484222325) -> int:
    """FNV-1a of 64 bits."""
    for byte in data:
        found = (found ^ byte) * 0x100000001B3 % 2**64
    return found


@pytest.mark.parametrize(("num_envs", "threads"), [(5, 1), (5, 2), (70, 2)])
def test_a_run_is_the_same_in_rust(num_envs, threads):
    # The same run is in crates/libration/tests/rl/golden.rs.
    envs = libration.Environments(
        "Pendulum",
        num_envs,
        autoreset_mode="SameStep",
        max_episode_steps=70,
        threads=threads,
        **PERTURBED,
    )
    envs.reset(seed=7)
    found = fnv(b"")
    for t in range(300):
        seen, rewards, _, truncated, _ = envs.step(np.full(num_envs, 0.5 * (t % 13) - 3))
        for array in (seen[:5], rewards[:5], truncated[:5]):
            found = fnv(array.tobytes(), found)
    assert found == 0x5B479A4F0D35AFB5, hex(found)
