"""Actuators whose effect on the motion changes with their commands, and models without gains, beside differences of ``mj_step``."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from libration import gains  # noqa: E402

ROD = '<geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.3" mass="1" contype="0" conaffinity="0"/>'
SERVO = '<position name="s" joint="j" kp="100" kv="1"/>'
DAMPER = '<damper name="b" joint="j" kv="60" ctrlrange="0 1"/>'


def model_of(actuators, joint="", option=""):
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.002" gravity="0 0 0" {option}/><worldbody><body><joint name="j" axis="0 1 0" {joint}/>{ROD}</body></worldbody>'
        f"<actuator>{actuators}</actuator></mujoco>"
    )


def general(more):
    return f'<general name="b" joint="j" gaintype="affine" {more}/>'


def data_at(model, ctrl=0.0, act=0.0):
    """The last actuator at a command and activation."""
    data = mujoco.MjData(model)
    data.ctrl[-1:], data.act[-1:] = ctrl, act
    return data


def radius(model, point, eps=1e-6):
    n, columns = model.nv, []
    for j in range(2 * n):
        ends = []
        for side in (eps, -eps):
            data = mujoco.MjData(model)
            data.ctrl[:], data.act[:] = point.ctrl, point.act
            [data.qpos, data.qvel][j // n][j % n] += side
            mujoco.mj_step(model, data)
            ends.append(np.concatenate([data.qpos, data.qvel]))
        columns.append((ends[0] - ends[1]) / (2 * eps))
    return float(np.abs(np.linalg.eigvals(np.stack(columns, axis=1))).max())


# A command or activation at which the model is stable, and one at which it grows.
COMMANDED = {
    "damper alone": (model_of(DAMPER), {"ctrl": 0.0}, {"ctrl": 1.0}),
    "damper alone, weak": (model_of(DAMPER), {"ctrl": 0.3}, {"ctrl": 1.0}),
    "damper beside a servo": (model_of(SERVO + DAMPER), {"ctrl": 0.0}, {"ctrl": 1.0}),
    "both gains": (model_of(SERVO + general('gainprm="0 -20000 -30"')), {"ctrl": 0.0}, {"ctrl": 1.0}),
    "negative stiffness": (model_of(SERVO + general('gainprm="0 200 0"')), {"ctrl": 0.2}, {"ctrl": 1.0}),
    "servo with a gain of its own": (model_of(general('gainprm="100 -40000 0" biastype="affine" biasprm="0 -100 -1"')), {"ctrl": 0.0}, {"ctrl": 1.0}),
    "filtered": (model_of(SERVO + general('gainprm="0 0 -80" dyntype="filter" dynprm="10"')), {}, {"ctrl": 1.0, "act": 1.0}),
}


@pytest.mark.parametrize("name", COMMANDED)
def test_a_step_that_is_stable_at_one_command_leaves_the_gains_unknown(name):
    model, calm, grows = COMMANDED[name]
    assert radius(model, data_at(model, **calm)) < 1 + 1e-9 < 1.01 < radius(model, data_at(model, **grows))
    report = gains.mujoco(model, data_at(model, **calm))
    assert report.verdict["outcome"] == "unknown" and not report.holds
    assert "the effect of `b` on the motion changes with the command" in report.answer
    assert "other gains of `b`" in report.verdict["not_examined"]
    assert np.isnan(report.largest_factor) and not report.measured["servos"]
    assert not any("there are no gains" in note for note in report.results["notes"])
    alone = gains.mujoco(model, data_at(model, **calm), integrator="backward-euler")
    assert alone.verdict["outcome"] == "unknown" and "changes with the command" in alone.answer


@pytest.mark.parametrize("name", COMMANDED)
def test_a_step_that_grows_at_the_command_is_unstable_and_no_servo_is_said_to_be_absent(name):
    model, _, grows = COMMANDED[name]
    report = gains.mujoco(model, data_at(model, **grows))
    assert report.verdict["outcome"] == "unstable"
    assert report.measured["spectral_radius"] == pytest.approx(radius(model, data_at(model, **grows)), rel=1e-6)
    assert "without any servo" not in report.answer
    assert "this is that of the point" in report.answer


def test_a_muscle_beside_a_servo_leaves_its_gains_unknown():
    report = gains.mujoco(model_of(SERVO + '<muscle name="b" joint="j" lengthrange="0 1" force="100" tausmooth="0.1"/>'))
    assert report.verdict["outcome"] == "unknown" and "the effect of `b` on the motion" in report.answer


def test_a_damper_in_a_group_that_is_disabled_changes_nothing():
    report = gains.mujoco(model_of(SERVO + DAMPER.replace("/>", ' group="2"/>'), option='actuatorgroupdisable="2"'))
    alone = gains.mujoco(model_of(SERVO))
    assert report.verdict == alone.verdict and report.largest_factor == alone.largest_factor


@pytest.mark.parametrize(
    "actuators",
    [
        '<motor name="a" joint="j" gear="10"/>',
        '<velocity name="a" joint="j" kv="0"/>',
        '<position name="a" joint="j" kp="0"/>',
        '<general name="a" joint="j" biastype="affine" biasprm="0 50 0"/>',
        '<motor name="a" joint="j"/><motor name="b" joint="j"/>',
        DAMPER,
    ],
)
def test_a_model_without_gains_has_none_that_hold(actuators):
    model = model_of(actuators, 'stiffness="100"')
    report = gains.mujoco(model)
    assert report.verdict["outcome"] == "unknown" and "no actuator is a servo with gains" in report.answer
    assert "hold with" not in report.answer and "no larger gain" not in report.answer
    assert np.isnan(report.largest_factor)
    # 10⁶ N m/rad: unstable with any actuator.
    stiff = gains.mujoco(model_of(actuators, 'stiffness="1e6"'))
    assert stiff.verdict["outcome"] == "unstable" and "The gains do not hold" not in stiff.answer


def test_a_spring_beside_an_actuator_that_remains_is_not_unstable_without_any_servo():
    report = gains.mujoco(model_of(SERVO + '<general name="b" joint="j" biastype="affine" biasprm="0 5 0"/>', 'stiffness="1e5"'))
    assert report.verdict["outcome"] == "unstable" and "without any servo" not in report.answer
    assert report.answer.startswith("The step is unstable without gains of the servos, with other actuators as they are (`b`)")
    assert not report.results["unstable_without_servos"] or "other gains of `b`" in report.verdict["not_examined"]


def test_a_servo_whose_gains_are_not_changed_keeps_its_verdict_without_limits():
    if not hasattr(mujoco.mjtGain, "mjGAIN_DCMOTOR"):
        pytest.skip("this MuJoCo has no motors with controllers")
    model = model_of('<dcmotor name="a" joint="j" motorconst="0.5" resistance="1" controller="100 0 1" input="pos"/>')
    report = gains.mujoco(model)
    assert report.verdict["outcome"] == "stable" and report.verdict["not_examined"] == ["other gains of `a`"]
    assert "no larger gain" not in report.answer
