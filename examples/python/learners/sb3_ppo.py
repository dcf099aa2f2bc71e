"""PPO of Stable-Baselines3 swings a pendulum up, in many environments that are one vector environment.

    pip install '.[gymnasium]' stable-baselines3
    python examples/python/learners/sb3_ppo.py [--steps 300000] [--action-delay 0.05]
    python examples/python/learners/sb3_ppo.py --check

Stable-Baselines3 has vector environments of its own, so :class:`Adapter` translates. The first shows the
return before and after, and where the time goes. The second steps the adapter beside ``DummyVecEnv`` over
single environments, and compares every bit of what comes out.

What came out, with stable-baselines3 2.9.2 and gymnasium 1.4: from −317 to −74 in 303,104 steps, of whose
time 0.1% was the environments'; with commands that are 0.05 s late to −65.
"""

from __future__ import annotations

import argparse
import time
from typing import Any, Sequence

import gymnasium
import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import DummyVecEnv, VecEnv, VecMonitor

import libration  # registers the environments

NAME = "libration/PendulumSwingUp-v0"


class Adapter(VecEnv):
    """A vector environment of Gymnasium as one of Stable-Baselines3.

    It must reset in the same step, since that is what a ``VecEnv`` does: an observation after ``done`` is the
    first of the next episode, and the last of the old one is ``infos[n]["terminal_observation"]``.
    """

    def __init__(self, envs: gymnasium.vector.VectorEnv) -> None:
        if envs.metadata["autoreset_mode"] != AutoresetMode.SAME_STEP:
            raise ValueError("a VecEnv resets in the same step: autoreset_mode must be 'SameStep'")
        self.envs = envs
        self.seconds = 0.0  # inside of the environments, and of nothing else
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> np.ndarray:
        # Only seeds can be told to single environments, and seed() has made one for each, or None.
        if any(self._options):
            raise ValueError("options are not passed on")
        observations, _ = self.envs.reset(seed=self._seeds)
        self.reset_infos = [{} for _ in range(self.num_envs)]
        # They are for one reset: the next one goes on.
        self._reset_seeds()
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        before = time.perf_counter()
        observations, rewards, terminated, truncated, told = self.envs.step(self._actions)
        self.seconds += time.perf_counter() - before

        # What is terminated in the very step of its time limit is over: nothing may be bootstrapped.
        late = truncated & ~terminated
        infos = [{"TimeLimit.truncated": cut} for cut in late.tolist()]
        dones = terminated | truncated
        for n in np.flatnonzero(dones):
            infos[n]["terminal_observation"] = told["final_obs"][n]
        for key, values in told.get("final_info", {}).items():
            # A key with an underscore says for whom the key without it holds.
            if not key.startswith("_"):
                for n in np.flatnonzero(told["final_info"][f"_{key}"]):
                    infos[n][key] = values[n].item()
        return observations, rewards, dones, infos

    def close(self) -> None:
        self.envs.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        return self.envs.render()

    # All environments are one object, so an attribute is that of all, and cannot be set or called for one.

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(self.envs, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        raise NotImplementedError("environments are set up by gymnasium.make_vec")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        raise NotImplementedError("there are no single environments whose method could be called")

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        return [False] * len(list(self._get_indices(indices)))


def made(num_envs: int, name: str = NAME, **settings: Any) -> Adapter:
    return Adapter(gymnasium.make_vec(name, num_envs=num_envs, autoreset_mode="SameStep", **settings))


def check(num_envs: int, steps: int) -> None:
    """The adapter is DummyVecEnv over single environments, only faster."""
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
        ours = made(num_envs, name, **settings)
        theirs = DummyVecEnv([lambda: gymnasium.make(name, **settings)] * num_envs)
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
                same &= all(np.array_equal(info[key], info2[key]) for key in info)
            ended += int(arrays[-1].sum())
            cut += sum(info["TimeLimit.truncated"] for info in infos)
        if not same or not cut:
            raise SystemExit(f"{name}: the adapter is not DummyVecEnv")
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
    adapter = made(given.num_envs, **settings)
    model = PPO(
        "MlpPolicy",
        VecMonitor(adapter),
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
        judge = VecMonitor(made(100, **settings))
        judge.seed(1_000_000)
        mean, deviation = evaluate_policy(model, judge, n_eval_episodes=100)
        return f"{mean:7.0f} ± {deviation:.0f}"

    print(f"return before  {evaluated()}")
    before = time.perf_counter()
    model.learn(given.steps)
    seconds = time.perf_counter() - before
    print(f"return after   {evaluated()}   (100 episodes, after {model.num_timesteps:,} steps)")
    print(
        f"{model.num_timesteps / seconds:,.0f} steps/s; {adapter.seconds / seconds:.1%} of the time is the "
        f"environments', which alone make {model.num_timesteps / adapter.seconds:,.0f} steps/s"
    )


if __name__ == "__main__":
    main()
