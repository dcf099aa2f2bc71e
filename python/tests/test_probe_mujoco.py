"""Audits, gains and loops of MuJoCo models."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from libration import StateFeedback, gains, probe  # noqa: E402
from libration.hosts import mujoco_host  # noqa: E402

EXAMPLES = Path(__file__).parents[2] / "examples" / "mujoco"
SLIDER = """<mujoco><option timestep="0.01" gravity="0 0 0"/>
<worldbody><body><joint name="s" type="slide" {joint}/><geom size="0.1" mass="1"/></body></worldbody>
<actuator>{actuator}</actuator></mujoco>"""
DELAYED = '<motor name="late" joint="s" delay="0.03" nsample="{samples}"/>'
FLOATING = """<mujoco><option timestep="0.002" gravity="0 0 {gravity}"/><worldbody><body pos="0 0 5"><freejoint/>
<geom type="box" size="0.1 0.1 0.1"/><body pos="0 0 -0.1"><joint name="k" axis="0 1 0" damping="0.1"/>
<geom type="capsule" fromto="0 0 0 0.2 0 -0.4" size="0.03" contype="0" conaffinity="0"/></body></body></worldbody>
<actuator><position joint="k" kp="500"/></actuator></mujoco>"""
BALL = """<mujoco><option timestep="0.002"/><worldbody><body><joint name="b" type="ball" damping="0.5"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.5" size="0.05"/></body></worldbody></mujoco>"""
CART = """<mujoco><option timestep="0.01"/><default><geom contype="0" conaffinity="0"/></default><worldbody><body>
<joint name="cart" type="slide" axis="1 0 0" damping="0.5"/><geom type="box" size="0.1 0.05 0.05" mass="1"/><body>
<joint name="pole" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 1.6" size="0.02" mass="0.3"/></body></body></worldbody>
<actuator><motor joint="cart"/></actuator></mujoco>"""


def slider(joint="", actuator=""):
    return mujoco.MjModel.from_xml_string(SLIDER.format(joint=joint, actuator=actuator))


def example(name, integrator, explicit_damping=False):
    model = mujoco.MjModel.from_xml_path(str(EXAMPLES / f"{name}.xml"))
    model.opt.integrator = int(getattr(mujoco.mjtIntegrator, f"mjINT_{integrator}"))
    if explicit_damping:
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
    return model


def audit(model, **keywords):
    """The audit of ``probe.mujoco`` without the drift of the energy, which takes 60 000 steps."""
    return probe.host(dataclasses.replace(mujoco_host(model, memory=None, **keywords), energy=None))


def kinds(report):
    return [finding["kind"] for finding in report.findings]


def growth(model, point, dt, steps=3000):
    """Growth per step of a deviation of 1e-7 in a simulation, over its second half."""
    model.opt.timestep = dt
    data, size, logs = mujoco.MjData(model), 1e-7, []
    for warning in data.warning:
        warning.number = 1
    data.ctrl[:] = point.ctrl
    deviation = np.random.default_rng(0).normal(size=model.nq + model.nv)
    for _ in range(steps // 20):
        deviation *= size / np.linalg.norm(deviation)
        data.qpos[:], data.qvel[:] = point.qpos + deviation[: model.nq], deviation[model.nq :]
        mujoco.mj_step(model, data, nstep=20)
        deviation = np.concatenate([data.qpos - point.qpos, data.qvel])
        logs.append(np.log(np.linalg.norm(deviation) / size))
    half = np.cumsum(logs[len(logs) // 2 :])
    return np.polyfit(20 * np.arange(len(half)), half, 1)[0]


def test_the_oscillator_is_symplectic_euler_to_the_last_digits():
    report = probe.mujoco(str(EXAMPLES / "oscillator.xml"))
    # ω dt = 2. Near it the growth is the root of the distance, and 1e-5 count as growth.
    assert report.integrators == ["symplectic-euler"] and report.largest_dt == pytest.approx(0.2, rel=1e-7)
    assert report.findings == [] and report.order == 1
    assert report.results["recognition"]["by_results"]["candidates"][0]["distance"] < 1e-13


@pytest.mark.parametrize(
    ("integrator", "explicit_damping", "names"),
    [
        ("EULER", False, {"euler", "damping-implicit"}),
        ("EULER", True, {"symplectic-euler"}),
        ("IMPLICITFAST", False, {"euler", "damping-implicit"}),
        ("IMPLICIT", False, {"euler", "damping-implicit"}),
        ("RK4", False, {"rk4"}),
    ],
)
def test_the_limits_of_a_chain_of_servos_are_those_of_its_simulation(integrator, explicit_damping, names):
    def model():
        return example("servo_chain", integrator, explicit_damping)

    report, servos = audit(model(), keyframe=0), gains.mujoco(model(), keyframe=0)
    assert set(report.integrators) & names and not set(report.integrators) - names and report.findings == []
    point = mujoco.MjData(model())
    mujoco.mj_resetDataKeyframe(model(), point, 0)
    # 1e-3 from the limit a deviation grows by some 1e-3 per step; 1500 steps resolve 1e-4.
    assert growth(model(), point, report.largest_dt * 0.999) < 1e-4 < growth(model(), point, report.largest_dt * 1.001)
    for part in (0.999, 1.001):
        stiffer, start = model(), mujoco.MjData(model())
        factor = part * servos.largest_factor
        start.qpos[:] = point.qpos
        # The same forces at the same positions.
        start.ctrl[:] = point.qpos + (point.ctrl - point.qpos) / factor
        stiffer.actuator_gainprm[:, 0] *= factor
        stiffer.actuator_biasprm[:, 1] *= factor
        assert (growth(stiffer, start, 0.002) > 1e-4) == (part > 1)


def test_gains_of_velocity_are_explicit_in_euler_and_implicit_in_implicitfast():
    kp, kv, dt = 100.0, 20.0, 0.01
    model = slider(actuator=f'<position joint="s" kp="{kp}" kv="{kv}"/>')
    for integrator, sign in (("EULER", -1), ("IMPLICITFAST", 1)):
        model.opt.integrator = int(getattr(mujoco.mjtIntegrator, f"mjINT_{integrator}"))
        # (4 ± 2 kv dt/M) M/dt²; a growth of 1e-7 per step counts.
        assert gains.mujoco(model).largest_kp["s"] == pytest.approx((4 + sign * 2 * kv * dt) / dt**2, rel=1e-6)


def test_gravity_is_no_stiffness_of_a_base_that_falls():
    with_gravity, without = (
        gains.mujoco(mujoco.MjModel.from_xml_string(FLOATING.format(gravity=gravity))) for gravity in (-9.81, 0)
    )
    assert without.holds and without.largest_factor < np.inf
    for key in ("kp", "kv"):
        fell, stood = ([joint[key] for joint in report.results["joints"]] for report in (with_gravity, without))
        assert fell == pytest.approx(stood, rel=1e-9, abs=1e-9)
    assert with_gravity.verdict["outcome"] == "unknown" and "no equilibrium" in with_gravity.answer
    # Limits beside gains of which nothing is known would be read as gains that hold.
    assert np.isnan(with_gravity.largest_factor)


def test_a_derivative_below_its_error_is_zero():
    # The gain of velocity is what remains of a damping of 2 beside a force of the servo of 3e5 N.
    servo = slider('damping="2"', '<position joint="s" kp="1e6"/>')
    data = mujoco.MjData(servo)
    data.qpos[0], data.qvel[0] = 0.3, 0.7
    (joint,) = gains.mujoco(servo, data).results["joints"]
    assert joint["kv"] == 0 and joint["kp"] == pytest.approx(1e6, rel=1e-9)
    (joint,) = gains.mujoco(slider('damping="2"', '<position joint="s" kp="100" kv="1e-4"/>')).results["joints"]
    assert joint["kv"] == pytest.approx(1e-4, rel=1e-6)


def test_the_report_has_the_version_of_mujoco():
    report = probe.mujoco(slider())
    assert report.results["version"] == f"MuJoCo {mujoco.__version__}" and report.results["libration_version"]


def test_contacts_are_stated_by_an_audit_and_have_a_part_in_gains():
    model = str(EXAMPLES / "foot_contact.xml")
    report = audit(model, keyframe="home")
    assert kinds(report) == ["limited-validity"] and report.holds
    assert "4 contacts are active" in report.answer and "valid only while these contacts stay" in report.answer
    servos = gains.mujoco(model, keyframe="home")
    assert any("4 contacts are active between foot/sole and world/floor (4)" in note for note in servos.results["notes"])
    assert servos.holds and servos.measured["spectral_radius"] == pytest.approx(report.results["spectral_radius"], abs=1e-8)


@pytest.mark.parametrize("samples", [3, 4])
def test_an_irregular_delay_is_found_in_a_queue_that_is_longer_than_the_delay(samples):
    report = audit(slider(actuator=DELAYED.format(samples=samples)))
    # The delay itself is one that the model states.
    assert kinds(report) == ["irregular-delay"] * (samples > 3)
    audited = report.results["delays"][0]["delays"]
    assert [delay for delay, _ in audited] == [3.0, 4.0][: samples - 2]
    # The mean of all audited steps of 0.01 s.
    mean = sum(delay * count for delay, count in audited) / sum(count for _, count in audited)
    assert report.hidden_latency[0]["late"] == pytest.approx(0.01 * mean)


def test_a_ball_joint_is_three_angles_and_a_model_needs_no_actuator():
    report = audit(mujoco.MjModel.from_xml_string(BALL))
    assert report.results["states"][:3] == ["b rotation x (rad)", "b rotation y (rad)", "b rotation z (rad)"]
    assert report.findings == [] and report.B.shape == (6, 0)
    with pytest.raises(ValueError, match="no actions"):
        report.plant


def test_a_mocap_body_that_holds_a_free_one_is_audited_with_its_constraints():
    report = audit(
        mujoco.MjModel.from_xml_string(
            """<mujoco><option gravity="0 0 0"/><worldbody><body mocap="true" name="m"><geom size="0.1" contype="0" conaffinity="0"/>
            </body><body name="b"><freejoint/><geom size="0.1" contype="0" conaffinity="0"/></body></worldbody>
            <equality><weld body1="m" body2="b"/></equality></mujoco>"""
        )
    )
    assert "equality constraints" in report.answer and report.A is not None


def test_the_latency_limit_of_a_loop_is_that_of_the_model():
    model = mujoco.MjModel.from_xml_string(CART)
    report = audit(model)
    gain, period = np.array([-1.0, -40.0, -3.0, -12.0]), 0.02
    (latency,) = [b for b in report.advise(StateFeedback(gain[None]), period=period)["budgets"] if b["kind"] == "latency"]

    def simulated(late, periods=3000):
        """Growth per period; a command takes over within a step, which is divided there."""
        data, dt = mujoco.MjData(model), model.opt.timestep
        whole, part = divmod(late / period, 1)
        queue, acting, logs = [0.0] * int(whole), 0.0, []
        data.qpos[1] = 1e-6
        for _ in range(periods):
            queue.append(-gain @ np.concatenate([data.qpos, data.qvel]))
            arriving, before = queue.pop(0), part * period
            for command, seconds in ((acting, before), (arriving, period - before)):
                data.ctrl[0] = command
                while seconds > 1e-12:
                    model.opt.timestep = min(dt, seconds)
                    mujoco.mj_step(model, data)
                    seconds -= model.opt.timestep
            acting, size = arriving, np.linalg.norm([*data.qpos, *data.qvel]) / 1e-6
            model.opt.timestep = dt
            data.qpos[:], data.qvel[:], acting = data.qpos / size, data.qvel / size, acting / size
            queue = [command / size for command in queue]
            logs.append(np.log(size))
        return np.polyfit(np.arange(periods // 2), np.cumsum(logs)[periods - periods // 2 :], 1)[0]

    # A divided step is not quite the step that was audited: 1e-4 of the limit. At 3 % the growth is some 1e-3 per period.
    assert simulated(0.997 * latency["stable_up_to"]) < 0 < simulated(1.003 * latency["stable_up_to"])


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: probe.mujoco("missing.xml"), ValueError, "there is no such file; expected the path of an XML or MJB file"),
        (lambda: probe.mujoco(3), TypeError, "model must be an MjModel or a path, not int"),
        (lambda: probe.mujoco(str(EXAMPLES / "oscillator.xml"), keyframe="hme"), ValueError, "did you mean 'home'"),
        (lambda: probe.mujoco(slider(), dt=0), ValueError, r"dt is 0\.0, but it must be finite and greater than 0"),
        (lambda: probe.mujoco(slider(), state="setled"), ValueError, "did you mean 'settled'"),
        (lambda: gains.mujoco(slider()), ValueError, "model has no actuators; expected servos"),
        (lambda: gains.mujoco(example("servo_chain", "DISCRETE"), keyframe=0), ValueError, "'discrete'; expected euler, symplectic-euler"),
        (lambda: gains.mujoco(example("servo_chain", "EULER"), substep=2), TypeError, "did you mean 'substeps'"),
    ],
)
def test_an_error_names_the_value_and_what_is_allowed(call, error, message):
    with pytest.raises(error, match=message):
        call()


def test_motors_are_no_servos_and_that_is_a_note():
    report = gains.mujoco(slider(actuator='<motor joint="s"/>'))
    assert np.isnan(report.largest_factor) and report.verdict["outcome"] == "unknown" and any("no gains of position" in note for note in report.results["notes"])
