"""Gains of servos on joints with friction loss, beside differences and runs of ``mj_step``."""

import copy

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from libration import gains  # noqa: E402

ROD = '<geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.3" mass="1" contype="0" conaffinity="0"/>'
SHORT = '<geom type="capsule" size="0.008" fromto="0 0 0 0 0 0.05" mass="0.02" contype="0" conaffinity="0"/>'
ONE = '<body><joint name="j" axis="0 1 0" {0}/>' + ROD + "</body>"
TWO = ONE.replace("</body>", '<body pos="0 0 0.3"><joint name="k" axis="0 1 0" {1}/>' + SHORT + "</body></body>")
SERVO = '<position name="s" joint="j" kp="{}" kv="1"/>'
# A finger of 20 g on one of 1 kg.
SERVOS = SERVO.format(100) + '<position name="e" joint="k" kp="{}" kv="0.005"/>'
TENDON = '<tendon><fixed name="t" frictionloss="{}"><joint joint="j" coef="1"/></fixed></tendon>'


def model_of(bodies, servos, more="", option=""):
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.002" gravity="0 0 0" {option}/><worldbody>{bodies}</worldbody>{more}<actuator>{servos}</actuator></mujoco>'
    )


SLIDE = '<body><joint name="x" type="slide" frictionloss="3"/><geom size="0.1" mass="1" contype="0" conaffinity="0"/></body>'
# Models whose friction holds gains that do not hold without it, with the servo and the gain of the least margin.
HELD = {
    "finger": (model_of(ONE.replace(ROD, SHORT).format('frictionloss="0.02"'), SERVO.format(20).replace('kv="1"', 'kv="0.005"')), "s", "kp"),
    "long hold": (model_of(ONE.format('frictionloss="5"'), SERVO.format(1e5)), "s", "kp"),
    "stiff hold": (model_of(ONE.format('frictionloss="2" solimpfriction="0.9999 0.9999 0.001"'), SERVO.format(6e4)), "s", "kp"),
    "tendon": (model_of(ONE.format(""), SERVO.format(6e4), TENDON.format(1)), "s", "kp"),
    "implicitfast": (model_of(ONE.format('frictionloss="2"'), SERVO.format(6e4), option='integrator="implicitfast"'), "s", "kp"),
    "RK4": (model_of(ONE.format('frictionloss="2"'), SERVO.format(9e4), option='integrator="RK4"'), "s", "kp"),
    "one of two joints": (model_of(TWO.format("", 'frictionloss="0.05"'), SERVOS.format(40)), "e", "kp"),
    "both joints": (model_of(TWO.format('frictionloss="0.1"', 'frictionloss="0.05"'), SERVOS.format(40)), "e", "kp"),
    "velocity": (model_of(SLIDE, '<velocity name="s" joint="x" kv="1500"/>'), "s", "kv"),
}


def without_friction(model):
    free = copy.deepcopy(model)
    free.dof_frictionloss[:] = 0
    free.tendon_frictionloss[:] = 0
    return free


def with_gain(model, servo, name, gain):
    changed, k = copy.deepcopy(model), mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, servo)
    changed.actuator_biasprm[k, {"kp": 1, "kv": 2}[name]] = -gain
    return changed


def radius(model, eps=1e-6):
    """Spectral radius of central differences at the default pose, which is at rest."""
    n, columns = model.nv, []
    for j in range(2 * n):
        ends = []
        for side in (eps, -eps):
            data = mujoco.MjData(model)
            [data.qpos, data.qvel][j // n][j % n] += side
            mujoco.mj_step(model, data)
            ends.append(np.concatenate([data.qpos, data.qvel]))
        columns.append((ends[0] - ends[1]) / (2 * eps))
    return float(np.abs(np.linalg.eigvals(np.stack(columns, axis=1))).max())


def diverges(model, position=0.0, velocity=0.0, steps=1500):
    """Whether a run of all joints from this displacement and velocity reaches 1000 rad, or 1000 rad/s."""
    own = copy.deepcopy(model)
    own.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    data = mujoco.MjData(own)
    for warning in data.warning:
        warning.number = 1
    data.qpos[:], data.qvel[:] = position, velocity
    for _ in range(steps):
        mujoco.mj_step(own, data)
        if not max(np.abs(data.qpos).max(), np.abs(data.qvel).max()) < 1000:
            return True
    return False


@pytest.mark.parametrize("name", HELD)
def test_gains_that_friction_alone_holds_do_not_hold_and_limits_are_those_of_moving_joints(name):
    model, servo, gain = HELD[name]
    # From 10⁻⁷ rad the model stays; from 0.1 rad, or 10 m/s, it does not.
    far = {"velocity": 10.0} if gain == "kv" else {"position": 0.1}
    assert not diverges(model, 1e-7, steps=300) and diverges(model, **far)
    report = gains.mujoco(model)
    assert report.verdict["outcome"] == "unstable" and not report.holds
    assert report.measured["spectral_radius"] == pytest.approx(radius(without_friction(model)), rel=1e-6)
    row = next(row for row in report.measured["servos"] if row["name"] == servo)
    limit = row[f"largest_{gain}"]
    assert 0 < limit < row[gain]
    below, above = (with_gain(model, servo, gain, part * limit) for part in (0.97, 1.03))
    # Velocities alone have a neutral position.
    assert radius(without_friction(below)) < 1 + 1e-9 < 1.01 < radius(without_friction(above))
    assert not diverges(below, **far) and diverges(above, **far)


def test_the_verdict_names_friction_loss_and_says_what_it_does():
    report = gains.mujoco(HELD["finger"][0])
    assert report.verdict["evidence"].endswith("without friction loss")
    assert report.verdict["not_examined"] == ["friction loss of joint `j`"]
    assert "This is without friction loss: it holds small deviations only" in report.answer
    assert any("1 joint with friction loss acts at the point; gains are those of motion without them" in note for note in report.results["notes"])
    assert gains.mujoco(HELD["tendon"][0]).verdict["not_examined"] == ["friction loss of tendon `t`"]


@pytest.mark.parametrize("bodies, servos, more", [(ONE, SERVO.format(100), ""), (TWO, SERVOS.format(2), TENDON.format(1))])
def test_gains_that_hold_without_friction_hold_with_the_same_limits(bodies, servos, more):
    with_loss = model_of(bodies.format('frictionloss="0.3"', 'frictionloss="0.02"'), servos, more)
    report, free = gains.mujoco(with_loss), gains.mujoco(without_friction(with_loss))
    assert report.verdict["outcome"] == free.verdict["outcome"] == "stable"
    assert report.measured["servos"] == free.measured["servos"] and report.largest_factor == free.largest_factor
    assert not any(diverges(with_loss, start) for start in (1e-7, 1e-3, 0.1))
    assert "friction" not in free.answer


def test_friction_loss_that_a_flag_disables_is_not_named():
    model = copy.deepcopy(HELD["long hold"][0])
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS)
    report = gains.mujoco(model)
    assert report.verdict["outcome"] == "unstable" and "friction" not in report.answer


def test_friction_that_is_unstable_while_it_holds_leaves_the_gains_unknown():
    # A damping of 5000 1/s times 2 ms is 10, of which the constraint takes nine tenths.
    model = model_of(ONE.format('frictionloss="2" solreffriction="-100 -5000"'), SERVO.format(100))
    report = gains.mujoco(model)
    assert radius(model, 1e-8) > 8 and radius(without_friction(model)) < 1
    assert report.verdict["outcome"] == "unknown" and "while friction loss holds, a mode grows by a factor 8.4" in report.answer
    assert not report.measured["servos"]


# A servo that presses a joint against its limit, and one that presses a foot of 100 g against the floor.
PRESSED = {
    "limits of joints and tendons": (
        model_of(ONE.format('range="0 60"'), '<position name="s" joint="j" kp="{kp}" kv="{kv}"/>'.format(kp=100, kv=60)),
        -0.02,
        0.01,
    ),
    "contacts": (
        model_of(
            '<geom type="plane" size="2 2 .1"/><body pos="0 0 .1"><joint name="z" type="slide" axis="0 0 1"/><geom size=".1" mass="0.1"/></body>',
            '<position name="s" joint="z" kp="100" kv="150"/>',
        ),
        -0.02,
        0.01,
    ),
}


@pytest.mark.parametrize("what", PRESSED)
def test_constraints_that_hide_a_fast_mode_of_free_motion_leave_the_gains_unknown(what):
    model, ctrl, away = PRESSED[what]
    data = mujoco.MjData(model)
    data.ctrl[:] = ctrl
    settled = gains.mujoco(model, data, state="settled").measured["operating_point"]["changes"]
    data.qpos[:] += settled
    # It stays where it is pressed, and does not return from a displacement.
    for start, leaves in ((0.0, False), (away, True)):
        own = copy.deepcopy(model)
        own.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        run = mujoco.MjData(own)
        for warning in run.warning:
            warning.number = 1
        run.qpos[:], run.ctrl[:] = data.qpos + start, ctrl
        mujoco.mj_step(own, run, nstep=200)
        assert (not np.abs(run.qpos - data.qpos).max() < 0.5) == leaves
    report = gains.mujoco(model, data)
    assert report.verdict["outcome"] == "unknown" and f"without the {what} that act at the point a fast mode grows" in report.answer
    assert not report.measured["servos"]
