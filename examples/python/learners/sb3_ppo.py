"""PPO of Stable-Baselines3 swings a pendulum up, in many environments that are one vector environment.

    pip install '.[sb3]'
    python examples/python/learners/sb3_ppo.py [--steps 300000] [--action-delay 0.05]
    python examples/python/learners/sb3_ppo.py --check

Stable-Baselines3 has vector environments of its own; :class:`libration.sb3.VecEnv` is one of them. The first
command shows the return before and after, and where the time goes. The second steps ``VecEnv`` beside
``DummyVecEnv`` over single environments, and compares every bit of what comes out.

What came out, with stable-baselines3 2.9.2 and gymnasium 1.4: from −317 to −57 in 303,104 steps, of whose
time 0.8% was the environments'; with commands that are 0.05 s late to −54.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv

import libration.sb3

NAME = "libration/PendulumSwingUp-v0"


class Timed(libration.sb3.VecEnv):
    """The environments, and the time inside of them."""

    seconds = 0.0

    def step_wait(self) -> Any:
        before = time.perf_counter()
        result = super().step_wait()
        self.seconds += time.perf_counter() - before
        return result


def check(num_envs: int, steps: int) -> None:
    """Compare with ``DummyVecEnv`` over single environments."""
    # Late commands, an uneven clock and a noisy sensor: all that an environment draws must agree, too.
    unsteady = {
        "action_delay": (0.0, 0.05),
        "jitter": ("gaussian", 0.05),
        "skew": ("uniform", 0.001),
        "observation_noise": 0.01,
    }
    # The pendulum is only ever truncated, but an oscillator with a near bound is terminated, too.
    near = {"bound": 1.0, "start_velocity": (-5.0, 5.0), "max_episode_steps": 60}
    # Delays are whole steps of the integrator, of which these are enough.
    pendulum = {**unsteady, "substeps": 50}
    oscillator = {**unsteady, **near}
    for name, settings in ((NAME, pendulum), ("libration/Oscillator-v0", oscillator)):
        ours = libration.sb3.VecEnv(name, num_envs, **settings)
        theirs = DummyVecEnv([lambda: Monitor(gymnasium.make(name, **settings))] * num_envs)
        ours.seed(7)
        theirs.seed(7)
        same = np.array_equal(ours.reset(), theirs.reset())
        random = np.random.default_rng(0)
        space = ours.action_space
        ended = cut = 0
        seconds = [0.0, 0.0]
        for _ in range(steps):
            actions = random.uniform(space.low, space.high, (num_envs, 1)).astype(space.dtype)
            came = []
            for which, envs in enumerate((ours, theirs)):
                before = time.perf_counter()
                came.append(envs.step(actions))
                seconds[which] += time.perf_counter() - before
            (*arrays, infos), (*arrays2, infos2) = came
            same &= all(np.array_equal(a, b) for a, b in zip(arrays, arrays2))
            for info, info2 in zip(infos, infos2):
                same &= info.keys() == info2.keys()
                for episode in (info.get("episode", {}), info2.get("episode", {})):
                    # The time since the construction, which no two objects have in common.
                    episode.pop("t", None)
                same &= all(np.array_equal(info[key], info2[key]) for key in info)
            ended += int(arrays[-1].sum())
            cut += sum(info["TimeLimit.truncated"] for info in infos)
        if not same or not cut:
            raise SystemExit(f"{name}: VecEnv differs from DummyVecEnv")
        speeds = [num_envs * steps / taken for taken in seconds]
        print(
            f"{name}: {num_envs}·{steps} steps are the same; "
            f"{cut} episodes truncated, {ended - cut} terminated; "
            f"{speeds[0]:,.0f} steps/s, DummyVecEnv {speeds[1]:,.0f}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=300_000, help="of all environments together")
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--action-delay", type=float, default=0.0, help="in seconds")
    # At the default of 0.1 PPO settles for hanging still, a local optimum: see docs/python.md. This is as
    # large beside the cost of the angle as in Gymnasium's Pendulum-v1.
    parser.add_argument("--velocity-cost", type=float, default=0.02)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--check", action="store_true", help="compare with DummyVecEnv, and learn nothing")
    given = parser.parse_args()
    if given.check:
        check(given.num_envs, 500)
        return

    # The networks are so small that threads would wait for each other more than they compute.
    torch.set_num_threads(1)
    settings = {"action_delay": given.action_delay, "velocity_cost": given.velocity_cost}
    envs = Timed(NAME, given.num_envs, **settings)
    model = PPO(
        "MlpPolicy",
        envs,
        n_steps=64,
        batch_size=512,
        n_epochs=10,
        gamma=0.95,
        gae_lambda=0.95,
        learning_rate=1e-3,
        # Noise of 1 would be little beside actions of ±6.
        policy_kwargs={"log_std_init": 1.0},
        seed=given.seed,
        device="cpu",
    )

    def evaluated() -> str:
        # Its seeds are none of those that are trained on.
        judge = libration.sb3.VecEnv(NAME, 100, **settings)
        judge.seed(1_000_000)
        mean, deviation = evaluate_policy(model, judge, n_eval_episodes=100)
        return f"{mean:7.0f} ± {deviation:.0f}"

    print(f"return before  {evaluated()}")
    before = time.perf_counter()
    model.learn(given.steps)
    seconds = time.perf_counter() - before
    print(f"return after   {evaluated()}   (100 episodes, after {model.num_timesteps:,} steps)")
    print(
        f"{model.num_timesteps / seconds:,.0f} steps/s; {envs.seconds / seconds:.1%} of the time is the "
        f"environments', which alone make {model.num_timesteps / envs.seconds:,.0f} steps/s"
    )


if __name__ == "__main__":
    main()
