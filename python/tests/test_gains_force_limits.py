"""Gains of servos at their force limits, near them, and of servos that do not act, beside closed forms."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from libration import gains  # noqa: E402

DT, DAMPING = 0.01, 0.1
ROD = '<geom type="capsule" fromto="0 0 0 .5 0 0" size=".03" mass="1" contype="0" conaffinity="0"/>'


SITES = '<worldbody><site name="world"/><body pos="0 0 1"><joint name="k" axis="1 0 0" stiffness="9"/>' + ROD + "<site name='foot'/></body></worldbody>"


def model_of(servo, joint="", option="", inside="", more=""):
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 0 0" timestep="{DT}" {option}>{inside}</option><worldbody><body><joint name="j" axis="0 1 0" '
        f'damping="{DAMPING}" {joint}/>{ROD}</body></worldbody>{more}<actuator>{servo}</actuator></mujoco>'
    )


def servo(kp, more="", joint='joint="j"'):
    return f'<position name="s" {joint} kp="{kp}" kv="1" {more}/>'


def largest_kp(model, kv=1.0):
    """Semi-implicit steps with implicit damping of the joint: (M + hD)(v' − v) = −h (kp q + (kv + D) v), q' = q + h v'."""
    data, inertia = mujoco.MjData(model), np.zeros((1, 1))
    mujoco.mj_forward(model, data)
    try:
        mujoco.mj_fullM(model, data, inertia)
    except TypeError:
        mujoco.mj_fullM(model, inertia, data.qM)
    # The factor −1: 4 (M + hD) = h² kp + 2 h (kv + D).
    return (4 * (inertia[0, 0] + DT * DAMPING) - 2 * DT * (kv + DAMPING)) / DT**2


@pytest.mark.parametrize("kp", [50, 6500, 1e5])
@pytest.mark.parametrize("force", ["0 0.01", "0 3", "0 100", "-3 0", "0.5 1"])
def test_a_servo_at_its_force_limit_has_no_verdict_whatever_its_gain_and_limit(kp, force):
    report = gains.mujoco(model_of(servo(kp, f'forcerange="{force}"')))
    assert report.verdict["outcome"] == "unknown" and not report.holds
    assert "`s` is at its force limit" in report.answer
    withheld(report)


def withheld(report):
    assert np.isnan(report.largest_factor) and np.isnan(report.largest_kp["j"]) and report.fewest_substeps is None
    assert report.measured is None or not report.measured["servos"]
    assert not any(row["holds"] or row["largest_factor"] is not None for row in report.integrators)


@pytest.mark.parametrize(
    "servos, joint, more",
    [
        (servo(6500), 'actuatorfrcrange="0 3"', ""),
        (servo(6500) + '<motor joint="j"/>', 'actuatorfrcrange="0 3"', ""),
        (servo(6500, joint='tendon="t"'), "", '<tendon><fixed name="t" actuatorfrcrange="0 3"><joint joint="j" coef="1"/></fixed></tendon>'),
    ],
)
def test_a_joint_or_tendon_at_its_force_limit_has_no_verdict(servos, joint, more):
    report = gains.mujoco(model_of(servos, joint, more=more))
    assert report.verdict["outcome"] == "unknown" and "is at its force limit" in report.answer
    withheld(report)


@pytest.mark.parametrize("limit", [0.002, 0.02, 2.0])
@pytest.mark.parametrize("where", ["servo", "joint"])
def test_limits_of_gains_within_a_force_limit_are_those_without_it(limit, where):
    force = f"{-limit} {limit}"
    of_servo, of_joint = (f'forcerange="{force}"', "") if where == "servo" else ("", f'actuatorfrcrange="{force}"')
    model = model_of(servo(100, of_servo), of_joint)
    report = gains.mujoco(model)
    assert report.verdict["outcome"] == "stable"
    # Growth of 10⁻⁷ per step counts as none.
    assert report.measured["servos"][0]["largest_kp"] == pytest.approx(largest_kp(model), rel=1e-5)
    assert report.largest_factor == pytest.approx(largest_kp(model) / 100, rel=1e-5)
    # The deviation at which kp q is the limit.
    assert any(f"at a deviation of {limit / 100:.2g};" in note for note in report.results["notes"])


@pytest.mark.parametrize("limit", [1e-9, 0.009])
def test_a_servo_that_meets_its_limit_within_the_difference_has_no_verdict(limit):
    # 10⁻⁵ rad times 1000 N m/rad are 0.01 N m.
    report = gains.mujoco(model_of(servo(1000, f'forcerange="{-limit} {limit}"')))
    assert report.verdict["outcome"] == "unknown" and "meets its force limit" in report.answer
    withheld(report)


def test_a_motor_at_its_force_limit_beside_a_servo_changes_no_limit_of_it():
    model = model_of(servo(100) + '<motor joint="j" forcerange="-1 0"/>')
    report = gains.mujoco(model)
    assert report.verdict["outcome"] == "stable"
    assert report.measured["servos"][0]["largest_kp"] == pytest.approx(largest_kp(model), rel=1e-5)


@pytest.mark.parametrize(
    "model",
    [
        model_of(servo(1e5), inside='<flag actuation="disable"/>'),
        model_of(servo(1e5, 'group="1"'), option='actuatorgroupdisable="1"'),
        model_of(servo(1e5, 'group="30"'), 'stiffness="1"', option='actuatorgroupdisable="0 30"'),
        model_of(servo(1e5, 'gear="0"')),
        model_of('<position name="s" joint="j" kp="10" gear="0"/>'),
        model_of('<position name="s" joint="j" kp="1e5"/>', inside='<flag actuation="disable"/>'),
        model_of('<position name="s" tendon="t" kp="10"/>', more='<tendon><fixed name="t"><joint joint="j" coef="0"/></fixed></tendon>'),
        # The site is on the axis.
        model_of('<position name="s" site="foot" refsite="world" kp="100" gear="0 1 0 0 0 0"/>', more=SITES),
    ],
)
def test_servos_that_do_not_act_have_no_verdict(model):
    report = gains.mujoco(model)
    assert report.verdict["outcome"] == "unknown" and "`s` does not act" in report.answer
    withheld(report)
    alone = gains.mujoco(model, integrator="backward-euler")
    assert alone.verdict["outcome"] == "unknown" and "`s` does not act" in alone.answer


def test_a_tendon_that_is_taut_acts_by_its_force_and_no_servo_is_called_innocent():
    # The rod points at the anchor: the moment arm is 0, and the force of the servo is 0.7 kp.
    text = (
        '<mujoco><option gravity="0 0 0" timestep="0.002"/><worldbody><site name="s0" pos="0 0 1"/><body><joint name="j" axis="0 1 0" '
        'damping="0.1"/><geom type="capsule" fromto="0 0 0 0 0 .3" size=".02" mass="1"/><site name="s1" pos="0 0 .3"/></body></worldbody>'
        '<tendon><spatial name="t"><site site="s0"/><site site="s1"/></spatial></tendon>'
        '<actuator><position name="s" tendon="t" kp="{}"/></actuator></mujoco>'
    )
    slack = gains.mujoco(mujoco.MjModel.from_xml_string(text.format(1000)))
    assert slack.verdict["outcome"] == "unknown" and "only its force of -700 acts" in slack.answer
    taut = gains.mujoco(mujoco.MjModel.from_xml_string(text.format(300_000)))
    assert taut.verdict["outcome"] == "unstable" and "without any servo" not in taut.answer
    assert "without gains of the servos, with other actuators as they are (`s`)" in taut.answer


def test_a_group_that_is_not_disabled_acts():
    model = model_of(servo(100, 'group="2"'), option='actuatorgroupdisable="1"')
    assert gains.mujoco(model).largest_factor == pytest.approx(largest_kp(model) / 100, rel=1e-5)


def test_a_spring_that_is_unstable_without_the_servo_that_does_not_act_is_unstable():
    report = gains.mujoco(model_of(servo(100, 'group="1"'), 'stiffness="1e5"', option='actuatorgroupdisable="1"'))
    assert report.verdict["outcome"] == "unstable" and "without any servo" in report.answer
