"""Bodies against REBOUND on one thread, with the same bodies, integrator and step, in one run: speed, and losses of energy.

``pip install rebound``, then ``python python/benches/bodies.py``. Both take turns; medians count.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
import rebound

import libration

ROUNDS = 15


def seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def ratio(own: Callable[[], object], other: Callable[[], object]) -> float:
    times = [(seconds(own), seconds(other)) for _ in range(ROUNDS)]
    return statistics.median(t[1] for t in times) / statistics.median(t[0] for t in times)


def copied(bodies: libration.Bodies, integrator: str, dt: float) -> rebound.Simulation:
    simulation = rebound.Simulation()
    simulation.G = bodies.gravitational_constant
    simulation.softening = bodies.softening
    simulation.integrator = integrator
    simulation.dt = dt
    for mass, q, v in zip(bodies.masses, bodies.positions, bodies.velocities):
        simulation.add(m=mass, x=q[0], y=q[1], z=q[2], vx=v[0], vy=v[1], vz=v[2])
    return simulation


def compare(name: str, bodies: libration.Bodies, integrators: tuple[str, str], dt: float, steps: int) -> None:
    simulation = copied(bodies, integrators[1], dt)

    def own() -> libration.BodyMotion:
        return libration.simulate_bodies(bodies, integrator=integrators[0], dt=dt, steps=steps, every=steps, predict=False, threads=1)

    speed = ratio(own, lambda: simulation.steps(steps))
    once = copied(bodies, integrators[1], dt)
    once.steps(min(steps, 100))
    once.synchronize()
    positions = np.array([[p.x, p.y, p.z] for p in once.particles])
    few = libration.simulate_bodies(bodies, integrator=integrators[0], dt=dt, steps=min(steps, 100), threads=1)
    off = np.abs(positions - few.positions[-1]).max()
    print(f"{name}: {speed:.2f} times the steps of REBOUND {rebound.__version__} (positions differ by {off:.0e} after 100 steps)")


def energies(bodies: libration.Bodies, dt: float) -> None:
    """Print the largest changes of the energy in 10,000 years, of both with the table (10, 6, 4)."""
    steps, samples = round(3.65e6 / dt), 500
    own = libration.simulate_bodies(bodies, integrator="wisdom-holman:aba-10-6-4", dt=dt, steps=steps, predict=False)
    simulation = copied(bodies, "saba", dt)
    simulation.move_to_com()
    start, largest = simulation.energy(), 0.0
    for _ in range(samples):
        simulation.steps(max(1, steps // samples))
        simulation.synchronize()
        largest = max(largest, abs(simulation.energy() / start - 1))
    lost = own.conserved["energy"]["largest_change"]
    print(f"(10, 6, 4) in steps of {dt:g} days: the energy changes by {lost:.1e}, that of REBOUND by {largest:.1e}")


cluster = libration.Bodies.published("plummer", count=1024, seed=1, softening=0.01)
compare("leapfrog, 1024 bodies", cluster, ("leapfrog", "leapfrog"), 1e-3, 300)
planets = libration.Bodies.published("outer-solar-system")
compare("Wisdom-Holman, outer solar system", planets, ("wisdom-holman", "whfast"), 100.0, 200_000)
for length in (1600.0, 800.0, 400.0):
    energies(planets, length)
