#!/usr/bin/env python3
"""Prints the delays in steps that MuJoCo uses for delayed actuators, and their effect on a loop near its delay limit.

MuJoCo reads a queue at ``time - delay``, and ``time`` is a sum of rounded timesteps. A sample that was written exactly ``delay`` ago
is skipped if ``time - delay`` is more than 1e-15 s below its time. Then the sample before it is read, if the queue has it: with
``nsample`` equal to the delay in steps there is none, and the delay is exact.

  * DELAYS: for each timestep and delay of d steps the share of steps with a delay of d + 1, its longest run, and the first such step,
    with a queue of one sample more than necessary; the last columns are the same for the queue of d samples and for a delay of
    (d - 1/2) steps.
  * LOOP: a mass of 1 kg with a delayed motor and the feedback u = -c v, whose gain is between the limits of d + 1 and d steps.

usage: mujoco_delay_audit.py [--steps 100000]
"""
import argparse

import mujoco
import numpy as np

TIMESTEPS = (0.001, 0.002, 0.005, 0.01, 0.01 / 3, 1 / 64)
DELAYS = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10)
SLIDER = """<mujoco><option timestep="{dt!r}" gravity="0 0 0"/><worldbody><body><joint name="slider" type="slide"/>
<geom size="0.1" mass="1"/></body></worldbody><actuator>
<general name="late" joint="slider" gear="{gear}" delay="{delay!r}" nsample="{samples}"/></actuator></mujoco>"""


def slider(dt, delay, samples, gear=1):
    model = mujoco.MjModel.from_xml_string(SLIDER.format(dt=dt, delay=delay, samples=samples, gear=gear))
    # All digits, whatever the compiler of the XML keeps.
    model.opt.timestep, model.actuator_delay[0] = dt, delay
    return model, mujoco.MjData(model)


def delays(dt, delay, samples, steps):
    """The delay in steps that each step of a ramp uses, from where the queue is full."""
    model, data = slider(dt, delay, samples, gear=0)
    late = np.empty(steps + samples + 1, dtype=int)
    for k in range(len(late)):
        data.ctrl[0] = k
        mujoco.mj_step(model, data)
        late[k] = k - round(data.actuator_force[0])
    return late[samples + 1 :]


def longest_run(condition):
    """The longest run of true entries."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], condition.astype(int), [0]])))
    return int(np.max(edges[1::2] - edges[::2], initial=0))


def growth(dt, d, samples, delay, gain, steps, pieces=10):
    """Factors per step by which the speed of the loop grows in pieces of a simulation that is not renormalised."""
    model, data = slider(dt, delay, samples)
    data.qvel[0] = 1.0
    size, logs = 0.0, []
    for _ in range(pieces):
        peak = 0.0
        for k in range(steps // pieces):
            data.ctrl[0] = -gain * data.qvel[0]
            mujoco.mj_step(model, data)
            if k >= steps // pieces - 40:
                peak = max(peak, abs(data.qvel[0]))
        logs.append((np.log(peak) - size) / (steps // pieces))
        size = np.log(peak)
        if not 1e-100 < peak < 1e100:
            break
    return np.exp(logs), size


def radius(d, hc):
    """The spectral radius of v' = v - hc v(k - d)."""
    return np.max(np.abs(np.roots([1.0, -1.0] + [0.0] * (d - 1) + [hc])))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=100_000, help="number of steps (default: 100000)")
    steps = parser.parse_args().steps
    print(f"MuJoCo {mujoco.__version__}, {steps} steps")
    print("dt (s)      d  one step late  longest run  first step  delays        d samples  d - 1/2 steps")
    for dt in TIMESTEPS:
        for d in DELAYS:
            late = delays(dt, d * dt, d + 1, steps)
            exact = "exact" if (delays(dt, d * dt, d, steps) == d).all() else "DEVIATES"
            half = "exact" if (delays(dt, (d - 0.5) * dt, d + 1, steps) == d).all() else "DEVIATES"
            share, first = np.mean(late != d), np.flatnonzero(late != d)
            values = ",".join(str(value) for value in np.unique(late))
            print(
                f"{dt:<10.6g} {d:2d}  {share:12.2%}  {longest_run(late != d):11d}  {first[0] if len(first) else '-':>10}"
                f"  {values:<12}  {exact:<9}  {half}"
            )
    print("\nLoop u = -c v: c dt is the mean of the limits for d and d + 1 steps")
    print("dt (s)      d  c dt     radius(d)  radius(d + 1)  queue    factors per step in tenths of the simulation")
    for dt, d in ((0.005, 3), (0.01, 3), (0.01, 5), (0.002, 5)):
        hc = np.mean([2 * np.sin(np.pi / (2 * (2 * n + 1))) for n in (d, d + 1)])
        for samples, delay, label in ((d, d * dt, "d"), (d + 1, d * dt, "d + 1"), (d + 1, (d - 0.5) * dt, "d - 1/2")):
            factors, size = growth(dt, d, samples, delay, hc / dt, steps=20_000)
            print(
                f"{dt:<10.6g} {d:2d}  {hc:.4f}  {radius(d, hc):9.5f}  {radius(d + 1, hc):13.5f}  {label:<7}  "
                + " ".join(f"{factor:.5f}" for factor in factors)
                + f"  log10 of the last speed: {size / np.log(10):.0f}"
            )


if __name__ == "__main__":
    main()
