"""Identification of loops: logs of MuJoCo, which nobody here wrote, and errors."""

import json
import math

import numpy as np
import pytest

from libration import identify

mujoco = pytest.importorskip("mujoco")

DT, PERIOD, NOISE = 0.001, 0.01, 0.01


def mujoco_model(delay: float, dynamics: str) -> "mujoco.MjModel":
    samples = math.ceil(delay / DT) + 2
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="{DT}"/>
        <worldbody><body><joint name="slider" type="slide"/><geom size="0.1"/></body></worldbody>
        <actuator><general joint="slider" {dynamics} gainprm="0" delay="{delay}" nsample="{samples}" interp="zoh"/></actuator></mujoco>"""
    )


def mujoco_log(delay: float, lag: float, periods: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Commands, and noisy measurements of the activation that follows them, once per period."""
    model = mujoco_model(delay, f'dyntype="filterexact" dynprm="{lag}"')
    data = mujoco.MjData(model)
    draws = np.random.default_rng(4)
    commands = np.repeat(draws.uniform(-1, 1, periods // 5), 5)
    times, responses = [], []
    for command in commands:
        data.ctrl[0] = command
        times.append(data.time)
        responses.append(data.act[0] + NOISE * draws.standard_normal())
        for _ in range(round(PERIOD / DT)):
            mujoco.mj_step(model, data)
    return np.array(times), commands, np.array(responses)


def late_steps(delay: float) -> float:
    """The mean number of steps after which MuJoCo uses a command, counted one by one."""
    model = mujoco_model(delay, 'dyntype="integrator"')
    data = mujoco.MjData(model)
    counts = []
    for k in range(200):
        command = (-1.0) ** k
        data.ctrl[0] = command
        for step in range(50):
            before = data.act[0]
            mujoco.mj_step(model, data)
            if np.sign(data.act[0] - before) == command:
                counts.append(step)
                break
        # To the next period.
        for _ in range(50 - step - 1):
            mujoco.mj_step(model, data)
    return float(np.mean(counts))


def test_delay_and_lag_of_a_mujoco_actuator_are_identified_within_their_intervals():
    delay, lag = 0.023, 0.05
    found = identify(*mujoco_log(delay, lag, 600), noise="white", hold="zero", bootstrap=0)
    assert found.results["response"] == "lag"
    assert not found.is_contradicted
    low, high = found.intervals["lag"]
    assert low < lag < high and high - low < 0.02 * lag
    # MuJoCo compares sums of steps: rounding makes a delay of 23 steps one of 23 or of 24.
    counted = DT * late_steps(delay)
    assert delay <= counted <= delay + DT
    low, high = found.intervals["dead_time"]
    assert delay - 0.0002 < low < high < delay + DT + 0.0002 and high - low < 0.0005
    # Both are means of 23 and 24, each over a hundred commands or more: half a step over the root of 100, four times.
    assert abs(found.dead_time - counted) < 4 * 0.05 * DT + (high - low)


def test_an_identified_loop_is_a_range_of_delays_of_environments_and_a_file_of_advise(tmp_path):
    gymnasium = pytest.importorskip("gymnasium")
    found = identify(*mujoco_log(0.023, 0.05, 400), model="lag", noise="white", hold="zero", bootstrap=0)
    low, high = found.intervals["dead_time"]
    assert found.delay_range == (low, high)
    assert found.action_delay(0.01) == pytest.approx((0.0225, 0.025))
    assert found.action_delay(0.01, substeps=1) == pytest.approx((0.02, 0.03))
    envs = gymnasium.make_vec("libration/Oscillator-v0", num_envs=3, dt=0.01, action_delay=found)
    envs.reset(seed=0)
    envs.step(envs.action_space.sample())
    envs.close()
    found.save_loop(tmp_path / "loop.toml")
    assert "[loop]" in (tmp_path / "loop.toml").read_text()
    found.save(tmp_path / "loop.html")
    found.save(tmp_path / "loop.json")
    assert json.loads((tmp_path / "loop.json").read_text())["response"] == "lag"
    assert "<html" in (tmp_path / "loop.html").read_text()


def test_invalid_values_are_refused_by_name():
    t = np.arange(100) * 0.01
    u = np.sign(np.sin(t * 7.0))
    with pytest.raises(ValueError, match="u has 99 values; expected 100"):
        identify(t, u[:-1], u)
    with pytest.raises(ValueError, match=r"y\[3\] is nan"):
        identify(t, u, np.where(np.arange(100) == 3, np.nan, u))
    with pytest.raises(ValueError, match="the command is 1 throughout"):
        identify(t, np.ones(100), u)
    with pytest.raises(ValueError, match="unknown model `lagg`"):
        identify(t, u, u, model="lagg")
    with pytest.raises(ValueError, match="dead time is -1"):
        identify(t, u, u, dead_time=-1.0)
    with pytest.raises(TypeError, match="bootstraps"):
        identify(t, u, u, bootstraps=3)


def test_a_step_within_the_largest_dead_time_is_read_from_rest_and_nothing_is_said_without_evidence():
    t = 0.01 * np.arange(200)
    draws = np.random.default_rng(3)
    late = np.clip(t - 0.13, 0, None)
    y = 1 - np.exp(-late / 0.05) + 0.002 * draws.standard_normal(200)
    u = (t > 0.095).astype(float)
    options = {"model": "lag", "noise": "white", "hold": "zero", "bootstrap": 0}
    found = identify(t, u, y, **options)
    assert found.results["start"] == "rest" and found.verdict["outcome"] == "no-fault"
    # 2 mV/V beside a slope of 20/s: 0.1 ms for one response on it, of which there are ten.
    assert found.dead_time == pytest.approx(0.03, abs=1e-3) and found.lag == pytest.approx(0.05, abs=2e-3)
    # The step in the first row.
    found = identify(t[10:], u[10:], y[10:], command_before=0.0, **options)
    assert found.dead_time == pytest.approx(0.03, abs=1e-3)
    found = identify(t, u, y, start="unknown", **options)
    assert found.verdict["outcome"] == "unknown" and "0 of 1 changes" in found.answer
    with pytest.raises(ValueError, match="unknown start `resting`"):
        identify(t, u, y, start="resting")
    with pytest.raises(ValueError, match="budget"):
        identify(t, u, y, budget=5)


def test_a_command_that_repeats_itself_leaves_no_loop_to_save_and_no_intervals(tmp_path):
    # A square wave with a period of 0.3 s, 33.4 ms late, behind a lag of 50 ms in closed form: dead times up to 0.6 s have rivals 0.3 s apart.
    count, dt, lag, late = 500, 0.01, 0.05, 0.0334
    times = dt * np.arange(count)
    commands = np.where(np.arange(count) % 30 < 15, 1.0, -1.0)
    response, responses = 0.0, []
    for k in range(count):
        responses.append(response)
        # The command of four periods ago acts until the one of three arrives.
        for source, duration in ((k - 4, late - 3 * dt), (k - 3, 4 * dt - late)):
            target = commands[source] if source >= 0 else 0.0
            response = target + (response - target) * math.exp(-duration / lag)
    responses = np.array(responses) + NOISE * np.random.default_rng(5).standard_normal(count)
    found = identify(
        times, commands, responses, model="lag", noise="white", hold="zero", largest_dead_time=0.6, random_arrivals=False, bootstrap=0
    )
    assert found.results["verdict"]["outcome"] == "unknown"
    assert found.intervals == {}
    with pytest.raises(ValueError, match="there is no loop to save: .* fit alike"):
        found.save_loop(tmp_path / "loop.toml")
    assert not (tmp_path / "loop.toml").exists()
    with pytest.raises(ValueError, match="the verdict is unknown"):
        found.delay_range
