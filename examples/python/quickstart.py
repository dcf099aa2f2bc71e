"""Many oscillators under one controller: what does a late command cost?

    pip install '.[gymnasium]'
    python examples/python/quickstart.py
"""

import gymnasium
import numpy as np

import libration
from libration.policies import Linear

# 1. As any vector environment of Gymnasium.
envs = gymnasium.make_vec(
    "libration/Oscillator-v0",
    num_envs=4096,
    integrator="velocity-verlet",
    action_delay=0.015,  # s
    jitter=("gaussian", 0.05),  # of every step, relative
    skew=("uniform", 0.001),  # of the clock of an episode, relative
)
observations, infos = envs.reset(seed=0)
envs.action_space.seed(0)
for _ in range(100):
    observations, rewards, terminated, truncated, infos = envs.step(envs.action_space.sample())
print(f"100 random actions: {rewards.mean():.3f} a step at the end")
envs.close()

# 2. With the policy inside the engine: a million transitions in one call.
#
# Under u = −kq − dq' that is late by τ, an oscillator has s² + ω² + (k + ds)·e^{−sτ} = 0. On the imaginary axis, s = iΩ, the absolute values
# say Ω⁴ − (2ω² + d²)·Ω² + ω⁴ − k² = 0 and the angles τ = arctan(dΩ/k)/Ω: there swings begin to grow. A command that is held for dt is late by half
# of it in any case.
omega2, k, d, dt = 10.0, 25.0, 6.0, 0.01
half = omega2 + d**2 / 2
swing = np.sqrt(half + np.sqrt(half**2 - omega2**2 + k**2))
critical = np.arctan2(d * swing, k) / swing - dt / 2
print(f"commands may be {critical:.3f} s late, says theory")
print("late by     mean return     lost")
for delay in (0.0, 0.04, 0.08, 0.12, 0.13, 0.14, 0.16):
    robots = libration.Environments(
        "Oscillator",
        num_envs=2048,
        autoreset_mode="SameStep",
        omega2=omega2,
        dt=dt,
        action_delay=delay,
        max_action=np.inf,
        max_episode_steps=2000,
    )
    robots.reset(seed=1)
    rollout = robots.rollout(Linear([-k, -d]), 2000)
    returns = rollout.episodes["returns"]
    print(f"{delay:6.2f} s  {returns.mean():12.1f}  {rollout.terminated.sum():7d}")
