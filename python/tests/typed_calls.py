"""Calls that a type checker must accept, and wrong ones that it must refuse: an ignored error that is none is an error too.

``test_stubs.py`` checks this file; nothing runs its functions.
"""
# mypy: warn-unused-ignores, disallow-untyped-defs, check-untyped-defs

from __future__ import annotations

import gymnasium
import numpy as np

import libration
from libration import hosts
from libration import Advice, Analysis, Gaussian, Identification, Results, Trajectory
from libration.classic_control import AcrobotEnv, CartPoleEnv, CartPoleVectorEnv, MountainCarContinuousVectorEnv, MountainCarEnv
from libration.classic_control import PendulumEnv as ClassicPendulumEnv
from libration.envs import DuffingEnv, OscillatorEnv, PendulumEnv, PendulumVectorEnv, SystemEnv, SystemVectorEnv


def environments(cart: libration.EquationSystem, identified: Identification) -> None:
    PendulumEnv()
    PendulumEnv(action_delay=0.05, render_mode="rgb_array")
    PendulumEnv(action_delay=(0.0, 0.05), jitter=("uniform", 0.1), skew=Gaussian(0.01), observation_noise=np.float32(0.1))
    PendulumEnv(action_delay=identified, start_position=[-1.0, 1.0], dtype=np.float64, max_action=6)
    PendulumVectorEnv(4)
    PendulumVectorEnv(num_envs=4, autoreset_mode="SameStep", copy=False, buffers=3)
    PendulumVectorEnv(4, autoreset_mode=gymnasium.vector.AutoresetMode.DISABLED, max_episode_steps=-1)
    OscillatorEnv(m=2.0, k=20.0, bound=np.inf)
    DuffingEnv(alpha=libration.Uniform(-1.0, -0.5), beta=np.ones(1), position_cost=libration.LogUniform(1.0, 2.0))
    SystemEnv(cart, dt=0.02, pole=libration.Gaussian(0.1, mean=1.0), inner=libration.PD(1.0, 1.0), inner_period=0.01)
    SystemEnv(cart, dt=0.02, reward="-x^2", start={"x": (-1, 1)}, max_action=[10.0])
    SystemVectorEnv(cart, 4, dt=0.02, observe=["x"], terminated=("abs(x) > 1",))
    libration.Environments("Oscillator", 4, dt=0.02, omega2=10.0, substeps=2, threads=0)
    libration.VectorEnv(cart, 4, dt=0.02, max_action=np.ones(2), observation_noise=[0.1, ("uniform", 0.1)])
    libration.CustomTaskVectorEnv("Pendulum", 4, task=lambda before, actions, after: after[:, 1], action_delay=0.05)
    libration.LinearVectorEnv(libration.LinearPlant.mechanical(1.0, 0.1, 10.0, 1.0), 4, latency=0.004, max_action=2.0)
    gymnasium.make_vec("libration/PendulumSwingUp-v0", num_envs=4, action_delay=0.05)
    vector: gymnasium.vector.VectorEnv = PendulumVectorEnv(4)
    single: gymnasium.Env = PendulumEnv()
    vector.reset(seed=0), single.reset(seed=0)


class Upright(CartPoleEnv):
    def __init__(self, threshold: float = 0.1) -> None:
        super().__init__(terminated=[f"theta < -{threshold}", f"theta > {threshold}"], length=1.0)
        self.steps = 0


def gravity_of(env: CartPoleEnv, envs: CartPoleVectorEnv | None = None) -> float:
    return env.gravity if envs is None else envs.get_attr("gravity")[0]


def twins() -> None:
    CartPoleEnv()
    CartPoleEnv(length=1.0, action_delay=(0.0, 0.04), starts="gymnasium", render_mode="rgb_array")
    CartPoleVectorEnv(4)
    CartPoleVectorEnv(num_envs=4, masspole=libration.Uniform(0.05, 0.2), gravity=np.ones(4), max_episode_steps=200, copy=False)
    ClassicPendulumEnv(g=9.81, m=1, l=libration.Gaussian(0.1, mean=1.0), max_action=3.0)
    MountainCarEnv(force=0.002, gravity=0.002, goal_velocity=0.01, observe=["x"])
    MountainCarContinuousVectorEnv(2, power=0.002, autoreset_mode="SameStep")
    CartPoleEnv(length=("uniform", 0.4, 0.6))
    AcrobotEnv(m1=1.0, m2=2.0, l1=1.0, lc1=0.5, lc2=0.5, moi=1.0, actions=[-1.0, 1.0])
    single: gymnasium.Env = CartPoleEnv()
    vector: gymnasium.vector.VectorEnv = CartPoleVectorEnv(2)
    gravity_of(Upright(), CartPoleVectorEnv(2)), single.reset(seed=0), vector.reset(seed=0)


def wrong_twins() -> None:
    CartPoleEnv(length=("uniform", 0.4))  # type: ignore[arg-type]
    CartPoleEnv(lenght=1.0)  # type: ignore[call-arg]
    CartPoleEnv(num_envs=4)  # type: ignore[call-arg]
    CartPoleEnv(name="CartPole")  # type: ignore[call-arg]
    CartPoleEnv(g=9.81)  # type: ignore[call-arg]
    CartPoleEnv(start_position=0.0)  # type: ignore[call-arg]
    CartPoleEnv(length="1.0")  # type: ignore[arg-type]
    CartPoleVectorEnv("CartPole")  # type: ignore[arg-type]
    ClassicPendulumEnv(length=1.0)  # type: ignore[call-arg]
    AcrobotEnv(LINK_MASS_1=2.0)  # type: ignore[call-arg]
    gravity_of(CartPoleVectorEnv(2))  # type: ignore[arg-type]


def wrong_environments(cart: libration.EquationSystem) -> None:
    PendulumEnv(action_dely=0.05)  # type: ignore[call-arg]
    PendulumEnv(num_envs=4)  # type: ignore[call-arg]
    PendulumEnv(m=1.0, k=1.0)  # type: ignore[call-arg]
    PendulumEnv(action_delay="0.05")  # type: ignore[arg-type]
    PendulumVectorEnv(4, autoreset_mod="SameStep")  # type: ignore[call-arg]
    libration.Environments("Oscillator", 4, action_dely=0.05)  # type: ignore[call-overload]
    libration.VectorEnv("Oscillator", 4, action_dely=0.05)  # type: ignore[call-overload]
    PendulumVectorEnv("4")  # type: ignore[arg-type]
    OscillatorEnv(omega=10.0)  # type: ignore[call-arg]
    DuffingEnv(omega2=10.0)  # type: ignore[call-arg]
    SystemVectorEnv(num_envs=4, dt=0.02)  # type: ignore[call-arg]
    libration.CustomTaskVectorEnv("Pendulum", 4, task=max, bound=2.0)  # type: ignore[call-arg]
    libration.LinearVectorEnv("plant", 4, latenzy=0.004)  # type: ignore[call-arg]


def systems() -> None:
    spring: libration.System = libration.System("oscillator", m=2.0, k=20.0)
    mine: libration.EquationSystem = libration.System(acceleration={"x": "-x + u"}, inputs=["u"], start={"x": 1.0})
    filled: libration.EquationSystem = libration.System("tank", rate={"level": "-level"}, parameters={"k": (1.0, "m")})
    libration.simulate(mine, integrator="rk4", dt=0.01, steps=10)
    hosts.gymnasium_host("Pendulum-v1")
    libration.System()  # type: ignore[call-overload]
    libration.System(acceleration={"x": "-x"}, input=["u"])  # type: ignore[call-overload]
    libration.System("oscillator", m="2.0")  # type: ignore[call-overload]


def results(step: Analysis, advice: Advice, path: Trajectory, report: Results) -> None:
    growth: float = step.spectral_radius + step.max_energy_drift
    limits: dict[str, float | None] = step.largest_dt
    order: int = step.motion["order"]
    modes: list[dict[str, object]] = step.modes
    loop: float = step.loop["spectral_radius"]
    holds: bool = advice.holds
    answer: str = advice.answer.upper() + advice.request
    budgets: list[dict[str, float]] = advice.loop["budgets"]
    any_key: object = advice["loop"], step["spectral_radius"]
    times: np.ndarray = path.t + path["q"] + path.energy
    measured: float | None = report.findings[0].measured
    reasons: dict[str, str] = report.not_applicable


def wrong_results(step: Analysis, advice: Advice, path: Trajectory) -> None:
    step.spectral_radios  # type: ignore[attr-defined]
    step.spectral_radius.upper()  # type: ignore[attr-defined]
    advice.hold  # type: ignore[attr-defined]
    advice.answer + 1  # type: ignore[operator]
    advice.save(1)  # type: ignore[arg-type]
    path.q0  # type: ignore[attr-defined]


def wrong_functions() -> None:
    libration.simulate("pendulum", integrator="rk4", dt=0.01, step=10)  # type: ignore[call-arg]
    libration.simulate("pendulum", integrator="rk4", dt="0.01", steps=10)  # type: ignore[arg-type]
    libration.analyze("pendulum", integrater="rk4", dt=0.01)  # type: ignore[call-arg]
    libration.advise("pendulum", latncy=0.1)  # type: ignore[call-arg]
    libration.run_lab(study=["drift"])  # type: ignore[call-arg]
    libration.Ensemble("pendulum", dt=0.01, q=[[1.0]], dtyp="float32")  # type: ignore[call-arg]
