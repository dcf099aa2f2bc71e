"""Hosts: Gymnasium environments as steps of their internal state."""

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from libration.hosts import gymnasium_host  # noqa: E402


def one(host, state=None, action=None, dt=None):
    state, action = host.state if state is None else np.array(state), host.action if action is None else np.array(action)
    return host.step(state[np.newaxis], action[np.newaxis], host.dt if dt is None else dt)[0]


def test_a_pendulum_takes_a_step_of_symplectic_euler():
    host = gymnasium_host("Pendulum-v1")
    rate = -0.4 + (15 * np.sin(0.3) + 3 * 0.7) * 0.01
    assert one(host, [0.3, -0.4], [0.7], 0.01) == pytest.approx([0.3 + rate * 0.01, rate], rel=1e-14)
    assert (host.dt, host.equilibrium, host.inputs) == (0.05, True, ("torque (N m)",))
    assert host.version == f"Gymnasium {gymnasium.__version__}"


def test_the_force_of_a_cart_pole_is_an_action_by_the_name_of_its_attribute():
    fixed = gymnasium_host("CartPole-v1")
    assert len(fixed.action) == 0 and not fixed.equilibrium and "discrete action 1 is fixed" in " ".join(fixed.notes)
    host = gymnasium_host("CartPole-v1", 0.0, action_attribute="force_mag")
    assert host.equilibrium and one(host, action=[10.0]).tobytes() == one(fixed).tobytes()
    assert host.integrator == "euler" and fixed.inputs == ()


def test_termination_leaves_nothing_behind():
    host = gymnasium_host("CartPole-v1")
    first = one(host)
    for _ in range(3):
        assert np.isfinite(one(host, [0.0, 0.0, 2.0, 0.0])).all()
    assert one(host).tobytes() == first.tobytes()


def test_an_angle_has_no_jump_where_the_environment_wraps_it():
    host = gymnasium_host("Acrobot-v1", state=[np.pi - 1e-9, 0.0, 0.5, 0.0])
    assert one(host)[0] > np.pi and "wraps" in " ".join(host.notes)


def test_an_environment_stays_unchanged():
    env = gymnasium.make("Pendulum-v1")
    env.reset(seed=3)
    state = env.unwrapped.state.copy()
    host = gymnasium_host(env)
    one(host, [0.1, 0.2], [1.0], 0.3)
    assert env.unwrapped.dt == 0.05 and env.unwrapped.state.tobytes() == state.tobytes()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: gymnasium_host("MountainCar-v0"), "has no timestep"),
        (lambda: gymnasium_host("Pendulum-v1", state_attribute="stat"), "has no state 'stat'"),
        (lambda: gymnasium_host("Pendulum-v1", dt_attribute="tt"), "has no number 'tt'"),
        (lambda: gymnasium_host("Pendulum-v1", state=[1.0]), r"expected \(2,\)"),
        (lambda: gymnasium_host("CartPole-v1", 7), "from 0 to 1"),
        (lambda: gymnasium_host(3), "must be an environment"),
    ],
)
def test_errors_name_what_is_wrong(call, message):
    with pytest.raises((TypeError, ValueError), match=message):
        call()
