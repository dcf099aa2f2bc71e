"""Gains and equilibria of MuJoCo models beside differences of ``mj_step`` and runs, which share nothing with the package."""

from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from libration import gains, probe  # noqa: E402
from libration.hosts import mujoco_host  # noqa: E402

EXAMPLES = Path(__file__).parents[2] / "examples" / "mujoco"
HEAD = '<mujoco><option timestep="{dt}" gravity="0 0 {gravity}" integrator="{integrator}"/><default><geom contype="0" conaffinity="0"/></default>'
ROD = '<geom type="capsule" fromto="0 0 0 0 0 {length}" size="0.03" mass="1"/>'
TIED = (
    HEAD.format(dt=0.002, gravity=-9.81, integrator="Euler")
    + '<worldbody><body pos="0 0 1"><joint name="a" axis="0 1 0" damping="0.05"/>'
    + ROD.format(length=0.4)
    + '</body><body pos="0.5 0 1"><joint name="b" axis="0 1 0" damping="0.05"/>'
    + ROD.format(length=0.4)
    + '</body></worldbody><equality><joint joint1="a" joint2="b"/></equality>'
    + '<actuator><position name="servo" joint="a" kp="20"/></actuator></mujoco>'
)
ARM = (
    HEAD.format(dt=0.01, gravity=-9.81, integrator="{integrator}")
    + '<worldbody><body><joint name="shoulder" axis="0 1 0"/>'
    + ROD.format(length=-0.4)
    + '<body pos="0 0 -0.4"><joint name="elbow" axis="0 1 0"/>'
    + ROD.format(length=-0.3)
    + '</body></body></worldbody><actuator><position name="s" joint="shoulder" kp="50" kv="{kv}"/><position name="e" joint="elbow" kp="20" kv="{kv}"/>'
    + '</actuator><keyframe><key name="bent" qpos="0.3 1.2" ctrl="0.3 1.2"/></keyframe></mujoco>'
)
# A rod that stands on its end: its servo holds it if kp is above m g l/2.
STANDING = (
    HEAD.format(dt=0.002, gravity=-9.81, integrator="implicitfast")
    + '<worldbody><body><joint name="ankle" axis="0 1 0" damping="0.1"/>'
    + ROD.format(length=1.0)
    + '</body></worldbody><actuator><position name="servo" joint="ankle" kp="{kp}"/></actuator>'
    + '<keyframe><key name="lean" qpos="0.02" ctrl="0.02"/></keyframe></mujoco>'
)
SPRUNG = (
    HEAD.format(dt=0.01, gravity=0, integrator="Euler")
    + '<worldbody><body><joint name="s" type="slide" stiffness="1e6"/><geom size="0.1" mass="1"/></body><body pos="1 0 0">'
    + '<joint name="t" type="slide"/><geom size="0.1" mass="1"/></body></worldbody>'
    + '<actuator><position name="servo" joint="t" kp="100"/></actuator></mujoco>'
)
WELD = (
    '<mujoco><worldbody><body name="b"><freejoint/><geom type="box" size=".1 .1 .1" mass="1" contype="0" conaffinity="0"/></body></worldbody>'
    '<equality><weld body1="b"/></equality></mujoco>'
)
BOX = """<mujoco><option timestep="0.001"/><default><geom solref="0.005 1"/></default><worldbody><geom type="plane" size="2 2 .1"/>
<body name="box" pos="0 0 .099"><freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body></worldbody></mujoco>"""


def model_of(text):
    return mujoco.MjModel.from_xml_string(text)


def data_at(model, qpos=None, ctrl=None):
    data = mujoco.MjData(model)
    if qpos is not None:
        data.qpos[:] = qpos
    if ctrl is not None:
        data.ctrl[:] = ctrl
    return data


def derivative(model, point, eps=1e-6):
    """Central differences of ``mj_step`` in tangent coordinates."""
    n = model.nv

    def after(change):
        data = mujoco.MjData(model)
        data.qpos[:], data.qvel[:], data.ctrl[:] = point.qpos, point.qvel, point.ctrl
        mujoco.mj_integratePos(model, data.qpos, change[:n], 1.0)
        data.qvel[:] += change[n:]
        mujoco.mj_step(model, data)
        return data

    base, columns = after(np.zeros(2 * n)), []
    for j in range(2 * n):
        ends = []
        for side in (eps, -eps):
            data, move = after(side * np.eye(2 * n)[j]), np.zeros(n)
            mujoco.mj_differentiatePos(model, move, 1.0, base.qpos, data.qpos)
            ends.append(np.concatenate([move, data.qvel - base.qvel]))
        columns.append((ends[0] - ends[1]) / (2 * eps))
    return np.stack(columns, axis=1)


def radius(model, point):
    return float(np.abs(np.linalg.eigvals(derivative(model, point))).max())


def with_gains(model, kp=None, kv=None, servo=0, length=0.0):
    """The model with other gains of a servo and the same force at rest at this length."""
    changed = model_of_copy(model)
    bias = changed.actuator_biasprm[servo]
    if kp is not None:
        bias[0] += (bias[1] + kp) * length
        bias[1] = -kp
    if kv is not None:
        bias[2] = -kv
    return changed


def model_of_copy(model):
    import copy

    return copy.deepcopy(model)


def audit(model, state_scale=None, **keywords):
    """The audit of ``probe.mujoco`` without the drift of the energy, which takes 150 000 steps of a weld."""
    import dataclasses

    return probe.host(dataclasses.replace(mujoco_host(model, memory=None, **keywords), energy=None), state_scale=state_scale)


def test_joints_that_a_constraint_ties_are_stable_by_gains_as_by_probe():
    model = model_of(TIED)
    report, audited = gains.mujoco(model), audit(model)
    wanted = radius(model, data_at(model))
    # Differences with a step of 1e-6 in the curved impedance of the constraint.
    assert report.measured["spectral_radius"] == pytest.approx(wanted, abs=1e-6) and wanted < 1
    assert audited.results["spectral_radius"] == pytest.approx(wanted, abs=1e-6)
    assert report.holds and report.verdict["outcome"] == "stable"
    # One set of modes: probe linearises with actions, gains without.
    for own, other in zip(report.measured["modes"], audited.modes, strict=True):
        assert own["radius"] == pytest.approx(other["radius"], abs=1e-9) and own["states"][0][0] == other["states"][0][0]
    limit = report.measured["servos"][0]["largest_kp"]
    assert radius(with_gains(model, kp=0.99 * limit), data_at(model)) < 1 < radius(with_gains(model, kp=1.01 * limit), data_at(model))


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "RK4"])
@pytest.mark.parametrize("kv", [0, 0.2])
def test_a_point_that_is_no_equilibrium_is_named_and_its_step_is_that_of_the_simulator(integrator, kv):
    model = model_of(ARM.format(integrator=integrator, kv=kv))
    report = gains.mujoco(model, keyframe="bent")
    wanted = radius(model, data_at(model, [0.3, 1.2], [0.3, 1.2]))
    assert report.measured["spectral_radius"] == pytest.approx(wanted, abs=1e-6)
    assert report.verdict["outcome"] == "unknown" and not report.holds and "no equilibrium" in report.answer.split(". ")[0]
    settled = gains.mujoco(model, keyframe="bent", state="settled")
    point = mujoco_host(model, keyframe="bent", state="settled").state[:2]
    assert settled.measured["equilibrium"]["holds"] and settled.measured["operating_point"]["relative_change"] < 1
    here = data_at(model, point, [0.3, 1.2])
    assert settled.measured["spectral_radius"] == pytest.approx(radius(model, here), abs=1e-6)
    for name, number in (("kp", 0), ("kv", 1)):
        limit = settled.measured["servos"][0][f"largest_{name}"]
        if limit and np.isfinite(limit):
            inside, outside = (with_gains(model, **{name: part * limit}, length=point[0]) for part in (0.98, 1.02))
            assert radius(inside, here) < 1 + 1e-6 < radius(outside, here), (name, limit)


@pytest.mark.parametrize("kp", [1.0, 4.0, 4.8])
def test_servos_that_are_too_weak_are_named_with_the_least_gain_that_stands(kp):
    # m g l/2 of the rod of 1 m, whose centre is at its middle: 4.905 N m/rad.
    least = 9.81 / 2
    report = audit(model_of(STANDING.format(kp=kp)), keyframe="lean", state="settled")
    point = report.results["operating_point"]
    assert not report.holds and kinds(report)[0] == "operating-point"
    # The equilibrium near the request is kp (0.02 − q) = −m g l/2 sin q, and not the rod that hangs.
    q = mujoco_host(model_of(STANDING.format(kp=kp)), keyframe="lean", state="settled").state[0]
    assert kp * (0.02 - q) + least * np.sin(q) == pytest.approx(0, abs=1e-5) and abs(q) < 1
    assert not point["run"]["stands"] and "too weak" in report.answer.split(". ")[0]
    # A run of 5 s needs some more than the least gain of the theory, and 0.5 rad of lean at most: kp (q − 0.02) = m g l/2 sin q there.
    standing = least * np.sin(0.5) / 0.48
    assert 0.98 * standing < kp * point["run"]["least_factor"] < 1.1 * least * 1.1


@pytest.mark.parametrize("kp", [0.5, 3.0, 6.0])
def test_an_equilibrium_far_from_the_request_is_a_fault_and_never_stable_without_one(kp):
    # A command of 0.4 rad at a lean of 0.4 rad: kp (0.4 − q) = −m g l/2 sin q has no root near it for these gains.
    text = STANDING.format(kp=kp).replace('qpos="0.02" ctrl="0.02"', 'qpos="0.4" ctrl="0.4"')
    leans = np.linspace(-0.1, 0.9, 1001)
    torque = kp * (0.4 - leans) + 9.81 / 2 * np.sin(leans)
    near = bool(np.any(torque[:-1] * torque[1:] <= 0))
    report = audit(model_of(text), keyframe="lean", state="settled")
    assert not report.holds and kinds(report)[0] == "operating-point" and "No fault" not in report.answer
    assert (report.results["operating_point"]["relative_change"] <= 1) == near
    found = gains.mujoco(model_of(text), keyframe="lean", state="settled")
    assert not found.holds and (near or found.verdict["outcome"] == "unknown")


@pytest.mark.parametrize("kp", [6.0, 20.0])
def test_servos_that_stand_are_audited_at_the_equilibrium_near_the_request(kp):
    report = audit(model_of(STANDING.format(kp=kp)), keyframe="lean", state="settled")
    assert report.holds and report.results["operating_point"]["run"]["stands"], report.answer
    change = report.results["operating_point"]["largest"]["change"]
    q = 0.02 + change
    assert kp * (0.02 - q) + 9.81 / 2 * np.sin(q) == pytest.approx(0, abs=1e-5)
    assert ("from the request" in report.answer) == (abs(change) > 0.01)


def test_a_leg_on_the_floor_keeps_its_contacts_and_falls_with_weak_servos():
    model = mujoco.MjModel.from_xml_path(str(EXAMPLES / "foot_contact.xml"))
    model.actuator_gainprm[:, 0] *= 0.1
    model.actuator_biasprm[:, 1] *= 0.1
    point = audit(model, keyframe="home", state="settled").results["operating_point"]
    assert point["relative_change"] < 1 and not point["run"]["stands"]
    start = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, start, 0)
    for part, stands in ((0.9, False), (1.1, True)):
        data, stiffer = mujoco.MjData(model), model_of_copy(model)
        stiffer.actuator_gainprm[:, 0] *= part * point["run"]["least_factor"]
        stiffer.actuator_biasprm[:, 1] *= part * point["run"]["least_factor"]
        data.qpos[:], data.ctrl[:] = start.qpos, start.ctrl
        mujoco.mj_step(stiffer, data, nstep=2500)
        # A leg that falls takes its foot with it.
        assert (abs(data.qpos[0] - start.qpos[0]) < 0.1) == stands


def test_a_spring_that_is_unstable_by_itself_is_not_blamed_on_the_servo():
    report = gains.mujoco(model_of(SPRUNG))
    # h² k/m = 100 gives the factor 49 + √(49² − 1).
    assert report.answer.startswith("The step is unstable without any servo")
    assert report.measured["unstable_without_servos"] == pytest.approx(49 + np.sqrt(49**2 - 1), rel=1e-9)


def test_the_derivative_of_a_weld_is_that_of_short_differences():
    model = model_of(WELD)
    report = audit(model)
    assert "not-differentiable" not in kinds(report)
    wanted = derivative(model, data_at(model), 1e-7)
    # Differences of 1e-7 of a curved impedance: 1e-6 of the largest entry.
    assert np.abs(report.A - wanted).max() < 1e-5 * np.abs(wanted).max()
    finer = audit(model, state_scale=1e-4)
    assert np.abs(finer.A - wanted).max() < 1e-5 * np.abs(wanted).max()


def test_a_contact_that_rests_deeper_in_longer_steps_does_not_end_the_search_for_the_longest_one():
    report = audit(model_of(BOX), state="settled")
    limit = report.results["largest_dt"]
    # solref of 5 ms is that of steps up to 2.5 ms; MuJoCo runs at longer ones with a softer contact.
    assert limit["reason"] is None and limit["rests_elsewhere_from"] > 0.002, limit
    assert "refsafe" in report.answer
    for dt in (0.004, 0.008):
        data = data_at(model_of(BOX))
        longer = model_of(BOX)
        longer.opt.timestep = dt
        mujoco.mj_step(longer, data, nstep=2000)
        assert abs(data.qpos[2] - 0.1) < 0.01 and np.abs(data.qvel).max() < 1e-6


def kinds(report):
    return [finding["kind"] for finding in report.findings]
