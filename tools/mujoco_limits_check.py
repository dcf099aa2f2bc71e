#!/usr/bin/env python3
"""Compares limits that libration states for MuJoCo models with limits of simulations of these models.

  * TIMESTEP: `libration.probe.mujoco(model).largest_dt`.
  * GAIN: `libration.gains.mujoco(model).largest_factor`, the largest factor of all gains of position with the same gains of velocity.
    In the simulation the parameters of all actuators are multiplied so that slopes by lengths have the factor, and neither slopes by
    velocities nor forces at the equilibrium change.  Of the oscillator, which has no servo, the spring counts as one.
  * SIMULATION: `mj_step` from a random deviation of 1e-7, which is renormalised every 20 steps.  A limit is the first size at which the
    deviation grows by more than a factor exp(threshold) per step in the second half, by bisection.  What the bisection resolves is its
    bracket, and the distances to the limits with twice the threshold, with half the steps, and where libration counts growth.
  * CONTACT: a model with contacts.  The audit must say that its numbers hold only while the contacts stay.

The table has the stated limits beside the measured ones.  A line ends with DISAGREES if their distance is more than the resolution;
the exit code is 1 then.

usage: mujoco_limits_check.py [--steps 20000] [model ...]
"""
import argparse
import copy
import os
import sys
from pathlib import Path

import libration
import mujoco
import numpy as np
from libration.hosts import mujoco_host
from libration.hosts._mujoco_point import point_of

EXAMPLES = Path(__file__).parents[1] / "examples" / "mujoco"
TREES = ("oscillator", "servo_chain", "humanoid_tree", "muscle_or_tendon")
EXTRA = {
    # Servos with gains of velocity, which Euler treats explicitly and implicitfast implicitly, and a damped tendon between two joints.
    "arm with kv": """<mujoco model="arm with kv"><option timestep="0.002"/>
<default><joint type="hinge" axis="0 1 0" damping="0.3" armature="0.01"/><geom type="capsule" size="0.03" contype="0" conaffinity="0"/>
</default><worldbody><body><joint name="shoulder"/><geom fromto="0 0 0 0 0 -0.4"/><body pos="0 0 -0.4"><joint name="elbow"/>
<geom fromto="0 0 0 0 0 -0.3"/><body pos="0 0 -0.3"><joint name="wrist" damping="0.05"/><geom fromto="0 0 0 0.05 0 -0.1"/></body></body>
</body></worldbody><tendon><fixed name="belt" stiffness="5" damping="0.2"><joint joint="shoulder" coef="1"/>
<joint joint="elbow" coef="-0.7"/></fixed></tendon><actuator><position joint="shoulder" kp="300" kv="6"/>
<position joint="elbow" kp="200" kv="3"/><position joint="wrist" kp="30" kv="0.2"/></actuator></mujoco>""",
    # A base on a free joint, whose translations and rotations are neutral.
    "floating arm": """<mujoco model="floating arm"><option timestep="0.002" gravity="0 0 0"/><worldbody><body><freejoint/>
<geom type="box" size="0.1 0.1 0.1" contype="0" conaffinity="0"/><body pos="0 0 -0.1"><joint name="k" axis="0 1 0" damping="0.1"/>
<geom type="capsule" fromto="0 0 0 0.2 0 -0.4" size="0.03" contype="0" conaffinity="0"/></body></body></worldbody>
<actuator><position joint="k" kp="500"/></actuator></mujoco>""",
    # A ball joint, whose positions are rotation vectors, with three servos and a free mass on a rail.
    "ball joint": """<mujoco model="ball joint"><option timestep="0.002"/><worldbody><body><joint name="b" type="ball" damping="0.5"/>
<geom type="capsule" fromto="0 0 0 0.05 0.02 -0.5" size="0.05" contype="0" conaffinity="0"/>
<body pos="0 0 -0.5"><joint name="rail" type="slide" axis="1 0 0" damping="3" stiffness="900"/><geom size="0.05" contype="0"
conaffinity="0"/></body></body></worldbody><actuator><general joint="b" gear="1 0 0" biastype="affine" gainprm="100" biasprm="0 -100 0"/>
<general joint="b" gear="0 1 0" biastype="affine" gainprm="120" biasprm="0 -120 0"/>
<general joint="b" gear="0 0 1" biastype="affine" gainprm="80" biasprm="0 -80 0"/></actuator></mujoco>""",
}
INTEGRATORS = {
    "Euler": ("EULER", False),
    "Euler, eulerdamp off": ("EULER", True),
    "implicitfast": ("IMPLICITFAST", False),
    "implicit": ("IMPLICIT", False),
    "RK4": ("RK4", False),
}
SIZE = 1e-7
BLOCK = 20
BRACKET = 2e-6
# Growth of the deviation per step.  Double factors on the unit circle make deviations grow like the number of steps without instability.
THRESHOLD, NEUTRAL_THRESHOLD = 5e-5, 1e-3
# libration counts a growth of 1e-5 per step (gains: 1e-7) as instability.
COUNTS = 1e-5


def load(name, integrator):
    model = mujoco.MjModel.from_xml_string(EXTRA[name]) if name in EXTRA else mujoco.MjModel.from_xml_path(str(EXAMPLES / f"{name}.xml"))
    kind, off = INTEGRATORS[integrator]
    model.opt.integrator = int(getattr(mujoco.mjtIntegrator, f"mjINT_{kind}"))
    if off:
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
    return model


def settled(model):
    """Arguments of libration for the equilibrium at the keyframe, or the nearest one, and its data."""
    keywords = {"keyframe": 0 if model.nkey else None, "state": None}
    if not mujoco_host(model, **keywords).equilibrium:
        keywords["state"] = "settled"
    point, _ = point_of(model, None, keywords["keyframe"], keywords["state"], model.opt.timestep)
    return keywords, point


def is_oscillator(model):
    return model.nu == 1 and int(model.actuator_biastype[0]) == int(mujoco.mjtBias.mjBIAS_NONE)


def scale(model, point, factor):
    """Multiply slopes of forces by lengths; set the commands and activations that leave forces at the point as they are."""
    if is_oscillator(model):
        model.jnt_stiffness[:] *= factor
        return
    mujoco.mj_forward(model, point)
    for k in range(model.nu):
        if int(model.actuator_biastype[k]) == int(mujoco.mjtBias.mjBIAS_MUSCLE):
            # Peak force and speed of shortening: the slope by velocities is their ratio.
            for parameters in (model.actuator_gainprm[k], model.actuator_biasprm[k]):
                parameters[2] *= factor
                parameters[6] *= factor
            continue
        model.actuator_gainprm[k][0] *= factor
        model.actuator_biasprm[k][1] *= factor
        gain, bias = model.actuator_gainprm[k][0], model.actuator_biasprm[k]
        wanted = (point.actuator_force[k] - bias[0] - bias[1] * point.actuator_length[k]) / gain
        if (first := model.actuator_actadr[k]) >= 0:
            point.act[first] = wanted
        if int(model.actuator_dyntype[k]) in (int(mujoco.mjtDyn.mjDYN_NONE), int(mujoco.mjtDyn.mjDYN_FILTER)):
            point.ctrl[k] = wanted


def growth(model, point, dt, steps):
    """Growth of a deviation per step in the second half of a simulation."""
    model.opt.timestep = dt
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    data, nv = mujoco.MjData(model), model.nv
    for warning in data.warning:
        warning.number = 1
    data.ctrl[:] = point.ctrl
    deviation = np.random.default_rng(1).normal(size=2 * nv + model.na)
    deviation *= SIZE / np.linalg.norm(deviation)
    logs = []
    for _ in range(steps // BLOCK):
        data.qpos[:] = point.qpos
        mujoco.mj_integratePos(model, data.qpos, deviation[:nv].copy(), 1.0)
        data.qvel[:], data.act[:] = deviation[nv : 2 * nv], point.act + deviation[2 * nv :]
        mujoco.mj_step(model, data, nstep=BLOCK)
        mujoco.mj_differentiatePos(model, deviation[:nv], 1.0, point.qpos, data.qpos)
        deviation[nv : 2 * nv], deviation[2 * nv :] = data.qvel, data.act - point.act
        size = np.linalg.norm(deviation)
        if not np.isfinite(size) or size > 1e6:
            return np.inf
        logs.append(np.log(size / SIZE))
        deviation *= SIZE / size
    half = np.cumsum(logs[len(logs) // 2 :])
    # A line, since the size of a deviation also oscillates.
    return float(np.polyfit(BLOCK * np.arange(len(half)), half, 1)[0])


def first_unstable(growth_at, low, high, threshold):
    """The size in [low, high] at which the growth passes the threshold; None if it does at neither or both ends."""
    if growth_at(low) > threshold or growth_at(high) <= threshold:
        return None
    while high / low - 1 > BRACKET:
        middle = np.sqrt(low * high)
        if growth_at(middle) > threshold:
            high = middle
        else:
            low = middle
    return np.sqrt(low * high)


def measured(growth_at, stated, is_neutral, steps):
    """The limit of the simulation near the stated one, and the relative resolution."""
    threshold = NEUTRAL_THRESHOLD if is_neutral else THRESHOLD
    limit = first_unstable(lambda size: growth_at(size, steps), 0.97 * stated, 1.03 * stated, threshold)
    if limit is None:
        return None, 0.0
    around = limit * (1 - 20 * BRACKET), 1.03 * stated
    twice = first_unstable(lambda size: growth_at(size, steps), *around, 2 * threshold) or limit
    shorter = first_unstable(lambda size: growth_at(size, steps // 2), *around, threshold) or limit
    return limit, BRACKET + abs(twice / limit - 1) * (1 + COUNTS / threshold) + abs(shorter / limit - 1)


def stated_factor(model, keywords):
    if is_oscillator(model):
        # The spring in place of a servo, on 1 kg.
        integrator = {0: "euler", 1: "rk4", 2: "implicit", 3: "implicitfast"}[int(model.opt.integrator)]
        return libration.gains(1.0, float(model.jnt_stiffness[0]), dt=model.opt.timestep, integrator=integrator).largest_factor
    return libration.gains.mujoco(model, **keywords).largest_factor


def check(name, integrator, steps):
    """Print lines of the table; return whether all agree."""
    model = load(name, integrator)
    dt = model.opt.timestep
    keywords, point = settled(model)
    report = libration.probe.mujoco(model, **keywords)
    is_neutral = name == "floating arm" or (name == "oscillator" and integrator != "RK4")

    def at_dt(size, steps):
        return growth(load(name, integrator), point, size, steps)

    def at_factor(size, steps):
        changed, start = load(name, integrator), copy.copy(point)
        scale(changed, start, size)
        return growth(changed, start, dt, steps)

    agree = True
    factor = stated_factor(model, keywords)
    for what, stated, growth_at in (("timestep (s)", report.largest_dt, at_dt), ("factor of kp", factor, at_factor)):
        if stated is None or not np.isfinite(stated) or stated == 0:
            print(f"{name:<17} {integrator:<21} {what:<13} {'none' if stated is None or stated else 'never':>11}", flush=True)
            continue
        found, resolution = measured(growth_at, stated, is_neutral, steps)
        if found is None:
            agree, rest = False, "no limit within 3 %: DISAGREES"
        else:
            difference = found / stated - 1
            good = abs(difference) <= resolution
            agree &= good
            rest = f"{found:11.7g}  {difference:+10.1e}  {resolution:10.1e}" + ("" if good else "  DISAGREES")
        print(f"{name:<17} {integrator:<21} {what:<13} {stated:11.7g}  {rest}", flush=True)
    return agree


def check_contact():
    """Whether the audit of a foot on the floor says what its numbers are worth."""
    agree = True
    print("\nContact: examples/mujoco/foot_contact.xml")
    for integrator in INTEGRATORS:
        report = libration.probe.mujoco(load("foot_contact", integrator), keyframe=0)
        texts = [finding["text"] for finding in report.findings if finding["kind"] == "limited-validity"]
        notes = [text for text in texts if "contacts are active" in text and "valid only while these contacts stay" in text]
        agree &= bool(notes)
        kinds = ", ".join(finding["kind"] for finding in report.findings) or "none"
        limit = report.results["largest_dt"]
        limit = limit and (limit["reason"] or limit["dt"])
        print(f"{integrator:<21} findings: {kinds}; largest timestep: {limit}; text: {notes[0] if notes else 'MISSING'}", flush=True)
    return agree


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", metavar="model", help="names (default: all)")
    parser.add_argument("--steps", type=int, default=20_000, help="steps of each simulation (default: 20000)")
    arguments = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}, {arguments.steps} steps")
    print(f"{'model':<17} {'integrator':<21} {'limit of':<13} {'stated':>11}  {'simulated':>11}  {'difference':>10}  {'resolution':>10}")
    names = arguments.models or [*TREES, *EXTRA]
    agree = [check(name, integrator, arguments.steps) for name in names for integrator in INTEGRATORS]
    if not arguments.models:
        agree.append(check_contact())
    return 0 if all(agree) else 1


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
