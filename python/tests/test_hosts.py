"""Hosts: MuJoCo models as steps in minimal coordinates."""

import copy
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from libration import probe  # noqa: E402
from libration.hosts import Host, delay_audit, mujoco_host  # noqa: E402

EXAMPLES = Path(__file__).parents[2] / "examples" / "mujoco"
NAMES = ("oscillator", "servo_chain", "humanoid_tree", "muscle_or_tendon", "foot_contact")

STEP = 6e-6
"""The step of central differences here and in mjd_transitionFD."""
# Both differences have the rounding of a state, divided by the step; a hundred of them are allowed for sums in a step of MuJoCo.
# The truncation, STEP²/6 times a third derivative, is less than that for the models here.
DIGITS = 100 * np.finfo(float).eps / STEP

FLOATING = """<mujoco model="floating">
<option timestep="0.005" integrator="{integrator}" gravity="0 0 {gravity}"/><worldbody>
<body name="body" pos="0 0 1"><freejoint name="base"/><geom type="box" size="0.1 0.2 0.3"/>
<body pos="0 0 0.3"><joint name="neck" type="ball" damping="0.2" stiffness="3"/>
<geom type="ellipsoid" size="0.1 0.05 0.15" pos="0.05 0 0.2"/>
<body pos="0 0 0.4"><joint name="rail" type="slide" stiffness="50" damping="1"/><geom size="0.05"/></body></body></body></worldbody>
<actuator><motor joint="rail"/></actuator></mujoco>"""

DELAYED = """<mujoco><option timestep="0.01" gravity="0 0 0"/>
<worldbody><body><joint name="s" type="slide"/><geom size="0.1"/></body></worldbody>
<actuator><motor name="late" joint="s" delay="0.03" nsample="{samples}"/></actuator></mujoco>"""


def floating(integrator="Euler", gravity=0.0):
    return mujoco.MjModel.from_xml_string(FLOATING.format(integrator=integrator, gravity=gravity))


def spinning(model):
    """Data with a turned and moving body."""
    data = mujoco.MjData(model)
    data.qvel[:] = [0.3, -0.2, 0.1, 2.0, -1.0, 0.5, 0.7, 1.5, -0.4, 0.2]
    for _ in range(40):
        mujoco.mj_step(model, data)
    data.ctrl[:] = 0.3
    return data


def differences(host):
    """A and B by central differences of the step."""
    columns = []
    for vector, other in ((host.state, 0), (host.action, 1)):
        for j in range(len(vector)):
            pair = []
            for sign in (1, -1):
                moved = vector.copy()
                moved[j] += sign * STEP
                arguments = (moved, host.action) if other == 0 else (host.state, moved)
                pair.append((moved[j], host.step(arguments[0][np.newaxis], arguments[1][np.newaxis], host.dt)[0]))
            columns.append((pair[0][1] - pair[1][1]) / (pair[0][0] - pair[1][0]))
    both = np.stack(columns, axis=1)
    return both[:, : len(host.state)], both[:, len(host.state) :]


def agree(found, reference):
    size = np.maximum(1.0, np.max(np.abs(reference), axis=1, keepdims=True))
    return (np.abs(found - reference) <= DIGITS * size).all()


def one(host, state=None, action=None, dt=None):
    state, action = host.state if state is None else state, host.action if action is None else action
    return host.step(state[np.newaxis], action[np.newaxis], host.dt if dt is None else dt)[0]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("integrator", ["mjINT_EULER", "mjINT_RK4", "mjINT_IMPLICIT", "mjINT_IMPLICITFAST"])
def test_a_step_is_that_of_mujoco_bit_for_bit(name, integrator):
    model = mujoco.MjModel.from_xml_path(str(EXAMPLES / f"{name}.xml"))
    model.opt.integrator = getattr(mujoco.mjtIntegrator, integrator)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qvel[:] = np.linspace(-0.1, 0.2, model.nv)
    host = mujoco_host(model, data)
    after = one(host)
    mujoco.mj_step(model, data)
    assert after[host.positions[0][1] : 2 * model.nv].tobytes() == data.qvel.tobytes()
    assert after[2 * model.nv :].tobytes() == data.act.tobytes()
    if model.nq == model.nv:
        assert after[: model.nv].tobytes() == data.qpos.tobytes()
    else:
        back = np.zeros(model.nv)
        mujoco.mj_differentiatePos(model, back, 1.0, model.key_qpos[0], data.qpos)
        assert np.abs(after[3:6] - back[3:6]).max() < 1e-15
        assert after[[0, 1, 2]].tobytes() == data.qpos[[0, 1, 2]].tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_differences_of_the_step_agree_with_those_of_mujoco(name):
    host = mujoco_host(EXAMPLES / f"{name}.xml", keyframe="home")
    assert host.equilibrium
    assert ("4 contacts are active between foot/sole and world/floor" in " ".join(host.validity)) == (name == "foot_contact")
    a, b = differences(host)
    assert agree(a, host.reference_A) and agree(b, host.reference_B)


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "discrete"])
def test_differences_of_a_spinning_body_agree_with_those_of_mujoco(integrator):
    model = floating(integrator)
    host = mujoco_host(model, spinning(model))
    a, b = differences(host)
    assert agree(a, host.reference_A) and agree(b, host.reference_B)
    assert not host.equilibrium and np.abs(one(host)[[3, 4, 5]]).max() > 1e-3


def test_a_call_returns_the_same_bits_whatever_was_called_before():
    for name in NAMES:
        host = mujoco_host(EXAMPLES / f"{name}.xml", keyframe="home")
        first = one(host)
        random = np.random.default_rng(1)
        with np.errstate(all="ignore"):
            for dt in (host.dt, 0.0007, 0.01):
                host.step(host.state + random.normal(0, 0.3, (5, len(host.state))), np.tile(host.action + 0.1, (5, 1)), dt)
            host.step(np.full((2, len(host.state)), 1e12), np.tile(host.action, (2, 1)), host.dt)
            assert np.isnan(one(host, np.full(len(host.state), np.nan))).all()
        assert one(host).tobytes() == first.tobytes()
        pair = host.step(np.stack([host.state + 0.1, host.state]), np.tile(host.action, (2, 1)), host.dt)
        assert pair[1].tobytes() == first.tobytes()


def test_the_model_and_data_stay_unchanged(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    model = mujoco.MjModel.from_xml_path(str(EXAMPLES / "foot_contact.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data)
    state, size = np.empty(mujoco.mj_stateSize(model, 32767)), 32767
    mujoco.mj_getState(model, data, state, size)
    before, acceleration, options = state.copy(), data.qacc.copy(), copy.deepcopy(model.opt)
    host = mujoco_host(model, data, dt=0.001, state="settled")
    one(host, host.state + 0.1)
    host.step(np.full((1, len(host.state)), 1e11), host.action[np.newaxis], 0.1)
    host.energy(host.state[np.newaxis])
    mujoco.mj_getState(model, data, state, size)
    assert state.tobytes() == before.tobytes() and data.qacc.tobytes() == acceleration.tobytes()
    assert model.opt.timestep == options.timestep and model.opt.disableflags == options.disableflags
    assert not list(tmp_path.iterdir()), "MuJoCo wrote a log"


def test_energy_is_that_of_the_spring_and_the_mass():
    host = mujoco_host(EXAMPLES / "oscillator.xml")
    states = np.array([[0.1, 0.0], [0.0, 2.0], [0.3, -1.0]])
    assert host.energy(states) == pytest.approx(50 * states[:, 0] ** 2 + 0.5 * states[:, 1] ** 2, rel=1e-14)
    assert host.mass == pytest.approx(np.eye(1))


def test_names_have_units():
    host = mujoco_host(floating())
    assert host.states[2:6] == ("base z (m)", "base rotation x (rad)", "base rotation y (rad)", "base rotation z (rad)")
    assert host.states[9:12] == ("rail (m)", "base x' (m/s)", "base y' (m/s)")
    assert host.inputs == ("actuator[0] (N)",) and host.version == f"MuJoCo {mujoco.__version__}"
    assert mujoco_host(EXAMPLES / "servo_chain.xml").inputs[0] == "shoulder servo (rad)"
    assert mujoco_host(EXAMPLES / "muscle_or_tendon.xml").states[-1] == "wrist servo activation"


def test_settling_finds_the_equilibrium():
    model = mujoco.MjModel.from_xml_path(str(EXAMPLES / "servo_chain.xml"))
    data = mujoco.MjData(model)
    data.ctrl[:] = model.key_ctrl[0]
    assert not mujoco_host(model, data).equilibrium
    host = mujoco_host(model, data, state="settled")
    assert host.equilibrium and "Newton" in " ".join(host.notes)
    assert host.state[:5] == pytest.approx(model.key_qpos[0], abs=1e-9)
    assert np.abs(one(host) - host.state).max() < 1e-12


def test_a_fall_has_no_equilibrium():
    with pytest.raises(ValueError, match="no equilibrium found"):
        mujoco_host(floating(gravity=-9.81), state="settled")


def test_a_queue_lives_on_with_memory_only():
    model = mujoco.MjModel.from_xml_string(DELAYED.format(samples=3))
    push = np.ones(1)
    host = mujoco_host(model)
    assert one(host, action=push)[1] == 0 and one(host, action=push)[1] == 0
    assert "no effect within a step" in " ".join(host.notes) and "delays" in " ".join(host.notes)
    host = mujoco_host(model, memory=True)
    for _ in range(2):
        speeds = []
        for k in range(6):
            speeds.append(one(host, np.zeros(2), push if k == 0 else 0 * push)[1])
        assert [k for k, speed in enumerate(speeds) if speed] == [3]
        host.reset()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mujoco_host("no such file.xml"), "no such file"),
        (lambda: mujoco_host(3), "must be an MjModel or a path"),
        (lambda: mujoco_host(EXAMPLES / "oscillator.xml", keyframe="hom"), "did you mean 'home'"),
        (lambda: mujoco_host(EXAMPLES / "oscillator.xml", keyframe=4), "expected 0 to 0"),
        (lambda: mujoco_host(EXAMPLES / "oscillator.xml", state="setled"), "did you mean 'settled'"),
        (lambda: mujoco_host(EXAMPLES / "oscillator.xml", state="given"), "there is no data"),
        (lambda: mujoco_host(EXAMPLES / "oscillator.xml", kyframe="home"), "did you mean 'keyframe'"),
    ],
)
def test_errors_name_what_is_wrong(call, message):
    with pytest.raises((TypeError, ValueError), match=message):
        call()


def test_a_state_that_is_not_finite_and_a_file_that_does_not_compile_are_errors(tmp_path):
    model = floating()
    data = mujoco.MjData(model)
    data.qpos[1] = np.nan
    with pytest.raises(ValueError, match=r"qpos\[1\] is nan"):
        mujoco_host(model, data)
    path = tmp_path / "bad.xml"
    path.write_text("<mujoco><worldbody><body><joint/></body></worldbody></mujoco>")
    with pytest.raises(ValueError, match="does not compile: .*mass"):
        mujoco_host(path)


def test_a_muscle_at_rest_has_a_kink_unless_it_is_smoothed():
    text = (EXAMPLES / "muscle_or_tendon.xml").read_text().replace('tausmooth="0.1"', "")
    host = mujoco_host(mujoco.MjModel.from_xml_string(text), keyframe="home")
    assert "no derivative at rest: front muscle, back muscle" in " ".join(host.notes)
    j = host.states.index("front muscle activation")
    moved = np.zeros(len(host.state))
    moved[j] = 1e-6
    above, below = ((one(host, host.state + sign * moved)[j] - one(host)[j]) / (sign * 1e-6) for sign in (1, -1))
    # MuJoCo's time constants: 0.04 / (0.5 + 1.5 act) s down and 0.01 (0.5 + 1.5 act) s up.
    assert above == pytest.approx(1 - host.dt * 0.95 / 0.04, abs=1e-5)
    assert below == pytest.approx(1 - host.dt / 0.0095, abs=1e-5)


def test_runge_kutta_has_no_reference_of_mujoco():
    host = mujoco_host(floating("RK4"))
    assert host.reference_A is None and "RK4" in " ".join(host.notes) and isinstance(host, Host)


def test_a_queue_that_is_longer_than_the_delay_is_read_late():
    exact, = delay_audit(mujoco.MjModel.from_xml_string(DELAYED.format(samples=3)), steps=5000)
    assert (exact.nominal, exact.steps, exact.first) == (3, {3: 5000}, None)
    longer, = delay_audit(mujoco.MjModel.from_xml_string(DELAYED.format(samples=4)), steps=5000)
    assert longer.nominal == 3 and set(longer.steps) == {3, 4} and longer.first is not None
    assert sum(longer.steps.values()) == 5000


QUEUES = """<mujoco><option timestep="0.01" gravity="0 0 0"/>
<worldbody><body><joint name="s" type="slide"/><geom size="0.1"/></body></worldbody>
<actuator><motor name="late" joint="s" delay="0.05" nsample="6"/><motor name="idle" joint="s" gear="0" delay="0.03" nsample="3"/></actuator>
<sensor><jointpos name="p" joint="s" delay="0.05" nsample="7"/>
<jointvel name="v" joint="s" delay="0.025" nsample="4" interp="linear"/></sensor></mujoco>"""


def test_delays_are_those_of_actuators_without_effect_of_sensors_and_of_interpolated_queues():
    records = delay_audit(mujoco.MjModel.from_xml_string(QUEUES), steps=2000)
    assert [(r.name, r.kind, r.interpolation, r.nominal) for r in records] == [
        ("late", "actuator", "zoh", 5),
        ("idle", "actuator", "zoh", 3),
        ("p", "sensor", "zoh", 5),
        ("v", "sensor", "linear", 2.5),
    ]
    late, idle, position, velocity = records
    assert set(late.steps) == {5, 6} and late.steps == position.steps and late.first == position.first
    assert (idle.steps, idle.first, velocity.steps, velocity.first) == ({3: 2000}, None, {2.5: 2000}, None)
    # From 1000 s the sum of timesteps is rounded otherwise.
    assert delay_audit(mujoco.MjModel.from_xml_string(QUEUES), steps=2000, time=1000.0)[0].steps == {5: 2000}


def test_the_audit_of_a_step_finds_the_same_late_steps():
    record, *_ = delay_audit(mujoco.MjModel.from_xml_string(QUEUES), steps=2000)
    (found,) = [delays for delays in probe.mujoco(mujoco.MjModel.from_xml_string(QUEUES)).delays if "late" in delays["input"]]
    assert {round(delay) for delay, _ in found["delays"]} == set(record.steps) == {5, 6}


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"steps": 0}, "steps is 0, but it must be 1 to 100000000"),
        ({"dt": 0}, "dt is 0.0, but it must be finite and greater than 0"),
        ({"time": float("nan")}, "time is nan, but it must be finite"),
        ({"tiem": 0.0}, "did you mean 'time'"),
    ],
)
def test_errors_of_the_audit_of_delays_name_what_is_wrong(keywords, message):
    with pytest.raises((TypeError, ValueError), match=message):
        delay_audit(mujoco.MjModel.from_xml_string(QUEUES), **keywords)
