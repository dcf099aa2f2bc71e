"""Time per loop and period of LinearLoops and of a NumPy loop over periods, in the same run.

    python tools/linear_loops_speed.py

Requires the package `libration`, NumPy and SciPy. The plant is two masses in a row with two forces. Each command has a latency of a
part of a period, so a period has three parts. Both programs compute states and commands; LinearLoops also integrates the cost.
"""

import time

import numpy as np
from scipy.linalg import expm

from libration import LinearLoops, LinearPlant, StateFeedback

LOOPS, PERIODS, PERIOD = 4096, 200, 0.05
LATE = np.array([0.4, 0.3]) * PERIOD
STIFFNESS, DAMPING = np.array([[30.0, -10.0], [-20.0, 20.0]]), np.diag([0.2, 0.2])
A = np.block([[np.zeros((2, 2)), np.eye(2)], [-STIFFNESS, -DAMPING]])
B = np.vstack([np.zeros((2, 2)), np.diag([1.0, 2.0])])
GAIN = np.array([[1.0, 0, 2, 0], [0, 1, 0, 1]])


def part(h):
    """Return Φ, Γ and Cholesky's factor of the covariance of white noise (Van Loan)."""
    whole = expm(np.block([[A, B], [np.zeros((2, 6))]]) * h)
    pair = expm(np.block([[-A, B @ B.T], [np.zeros((4, 4)), A.T]]) * h)
    covariance = pair[4:, 4:].T @ pair[:4, 4:]
    return whole[:4, :4], whole[:4, 4:], np.linalg.cholesky((covariance + covariance.T) / 2)


def by_numpy(x, noisy, random):
    edges = np.array([0, LATE[1], LATE[0], PERIOD])
    parts = [part(h) for h in np.diff(edges)]
    acting = np.zeros((LOOPS, 2))
    for _ in range(PERIODS):
        command = -x @ GAIN.T
        for (phi, gamma, factor), arriving in zip(parts, (1, 0, None)):
            x = x @ phi.T + acting @ gamma.T
            if noisy:
                x += random.standard_normal((LOOPS, 4)) @ factor.T
            if arriving is not None:
                acting[:, arriving] = command[:, arriving]
    return x


def least(run):
    """Return the least CPU seconds of five runs, in nanoseconds per loop and period."""
    found = []
    for _ in range(5):
        began = time.process_time()
        run()
        found.append(time.process_time() - began)
    return min(found) * 1e9 / (LOOPS * PERIODS)


def main():
    random = np.random.default_rng(1)
    start = random.uniform(-1, 1, (LOOPS, 4))
    for noisy, jitter in ((False, 0.0), (True, 0.0), (True, 0.05)):
        loops = LinearLoops(
            LinearPlant(A, B), StateFeedback(GAIN), LOOPS, period=PERIOD, latency=list(LATE), noise=noisy, jitter=jitter, x0=start
        )
        if not noisy:
            np.testing.assert_allclose(loops.step(PERIODS).states, by_numpy(start, False, random), atol=1e-12)
        own = least(lambda: loops.step(PERIODS))
        name = f"noise {'on' if noisy else 'off'}, jitter {jitter}"
        if jitter:
            print(f"{name}: LinearLoops {own:.1f} ns")
        else:
            other = least(lambda: by_numpy(start, noisy, random))
            print(f"{name}: LinearLoops {own:.1f} ns, NumPy {other:.1f} ns, ratio {other / own:.1f}")


if __name__ == "__main__":
    main()
