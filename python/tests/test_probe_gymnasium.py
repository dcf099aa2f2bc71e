"""Audits of Gymnasium environments."""

import gymnasium
import pytest

from libration import probe


def test_pendulum_is_kick_drift():
    report = probe.gymnasium("Pendulum-v1")
    assert report.integrators == ["symplectic-euler"] and report.order == 1 and report.findings == []
    # Upright, ω² = 3 g/(2 l) = 15 1/s², and z + 1/z = 2 + ω² dt².
    half = 1 + 15 * 0.05**2 / 2
    assert report.spectral_radius == pytest.approx(half + (half**2 - 1) ** 0.5, rel=1e-9)


@pytest.mark.parametrize(
    ("kinematics", "integrator"), [("euler", "explicit-euler"), ("semi-implicit euler", "symplectic-euler")]
)
def test_cart_pole_is_what_its_attribute_says(kinematics, integrator):
    env = gymnasium.make("CartPole-v1")
    env.unwrapped.kinematics_integrator = kinematics
    report = probe.gymnasium(env, 0.0, action_attribute="force_mag")
    assert report.integrators == [integrator] and report.findings == [] and report.order == 1
    assert report.results["notes"][0] == f"the simulator calls its integrator {kinematics}"


def test_acrobot_is_rk4_by_its_results_alone():
    report = probe.gymnasium("Acrobot-v1")
    assert report.integrators == ["rk4"] and report.order == 4 and report.findings == []
    assert report.notes[0] == "the simulator calls its integrator unknown"


def test_a_discrete_action_that_pushes_leaves_no_equilibrium():
    report = probe.gymnasium("CartPole-v1")
    assert [finding["kind"] for finding in report.findings] == ["no-equilibrium"] and report.holds
    assert report.results["inputs"] == []


def test_an_environment_that_ignores_its_timestep_is_found():
    class Fixed(gymnasium.Env):
        action_space = gymnasium.spaces.Box(-1, 1, (1,))
        observation_space = gymnasium.spaces.Box(-9, 9, (2,))
        dt, state = 0.05, None

        def reset(self, *, seed=None, options=None):
            self.state = [0.0, 0.0]
            return self.state, {}

        def step(self, action):
            q, v = self.state
            v = v + 0.05 * (float(action[0]) - 4 * q)
            self.state = [q + 0.05 * v, v]
            return self.state, 0.0, False, False, {}

    report = probe.gymnasium(Fixed())
    assert [finding["kind"] for finding in report.findings] == ["ignores-dt"] and report.largest_dt is None
