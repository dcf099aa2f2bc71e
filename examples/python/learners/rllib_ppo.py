"""PPO of RLlib swings a pendulum up, in a vector environment that RLlib makes by itself.

    pip install '.[gymnasium]' 'ray[rllib]' torch
    python examples/python/learners/rllib_ppo.py [--iterations 40] [--action-delay 0.05]

RLlib makes its environments by ``gymnasium.make_vec``: ``gym_env_vectorize_mode="vector_entry_point"`` is all
it takes for them to be one vector environment of the engine, and ``env_config`` are its keywords. Two must be
left as they are. RLlib counts on ``autoreset_mode="NextStep"``, and it keeps rows of observations, which
``copy=False`` would change in its hands. It complains of neither, and learns from what never happened. With
``--vectorize-mode sync`` it puts single environments together.

What came out, with ray 2.60 and gymnasium 1.2.2: from −368 to −56 in 163,840 steps, of whose time less than
0.1% was the environments'.
"""

from __future__ import annotations

import argparse
import math
import time

import gymnasium
import numpy as np
import ray
from ray.rllib.algorithms.algorithm import Algorithm
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core.columns import Columns
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig

# What stands before the colon is imported first, which registers the environments: in whatever process RLlib
# makes them.
NAME = "libration:libration/PendulumSwingUp-v0"


def returns(algorithm: Algorithm, num_envs: int, settings: dict[str, float]) -> np.ndarray:
    """Of one episode in each environment, under the mean of the policy."""
    import torch

    module = algorithm.get_module()
    envs = gymnasium.make_vec(NAME, num_envs=num_envs, autoreset_mode="Disabled", **settings)
    observations, _ = envs.reset(seed=1_000_000)
    total = np.zeros(num_envs)
    while True:
        with torch.no_grad():
            told = module.forward_inference({Columns.OBS: torch.from_dlpack(observations)})
        # The module works on actions between −1 and 1, which RLlib stretches; the first number is the mean.
        mean = told[Columns.ACTION_DIST_INPUTS][:, :1].clamp(-1, 1) * float(envs.single_action_space.high[0])
        observations, rewards, _, truncated, _ = envs.step(mean)
        total += rewards
        if truncated.all():
            envs.close()
            return total


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--iterations", type=int, default=40, help="of 4096 steps each")
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--action-delay", type=float, default=0.0, help="in seconds")
    # At the default of 0.1 PPO settles for hanging still, a local optimum: see docs/python.md. This is as
    # large beside the cost of the angle as in Gymnasium's Pendulum-v1.
    parser.add_argument("--velocity-cost", type=float, default=0.02)
    modes = ("vector_entry_point", "sync")
    parser.add_argument("--vectorize-mode", choices=modes, default=modes[0])
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    settings = {"action_delay": given.action_delay, "velocity_cost": given.velocity_cost}

    ray.init(include_dashboard=False, log_to_driver=False, logging_level="error")
    config = (
        PPOConfig()
        .environment(NAME, env_config=settings)
        .env_runners(
            num_env_runners=0,
            num_envs_per_env_runner=given.num_envs,
            gym_env_vectorize_mode=given.vectorize_mode,
        )
        .learners(num_learners=0)
        .training(
            train_batch_size_per_learner=4096,
            minibatch_size=512,
            num_epochs=10,
            gamma=0.95,
            lambda_=0.95,
            lr=1e-3,
            grad_clip=0.5,
            grad_clip_by="global_norm",
            # Returns are in the hundreds, of which the default of 10 would cut what the critic learns.
            vf_clip_param=math.inf,
        )
        .rl_module(model_config=DefaultModelConfig(fcnet_hiddens=[64, 64], vf_share_layers=False))
        .debugging(seed=given.seed, log_level="ERROR")
    )
    algorithm = config.build_algo()
    made = algorithm.env_runner.env.unwrapped
    print(made)

    def evaluated() -> str:
        came = returns(algorithm, 100, settings)
        return f"{came.mean():7.0f} ± {came.std():.0f}"

    # RLlib's own timer of a step holds what it makes of infos, too: this is of the environments alone.
    seconds = {"environments": 0.0, "all": 0.0}
    step = made.step

    def timed(actions: np.ndarray) -> tuple:
        before = time.perf_counter()
        came = step(actions)
        seconds["environments"] += time.perf_counter() - before
        return came

    made.step = timed
    print(f"return before  {evaluated()}")
    steps = 0
    for _ in range(given.iterations):
        before = time.perf_counter()
        result = algorithm.train()
        seconds["all"] += time.perf_counter() - before
        steps = int(result["env_runners"]["num_env_steps_sampled_lifetime"])
        # Episodes end together, every 200 steps of 64 environments: in most iterations none does.
        mean = result["env_runners"].get("episode_return_mean", math.nan)
        if not math.isnan(mean):
            print(f"  {steps:9,d} steps: {mean:7.0f} while exploring")
    print(f"return after   {evaluated()}   (100 episodes, after {steps:,} steps)")
    print(
        f"{steps / seconds['all']:,.0f} steps/s; {seconds['environments'] / seconds['all']:.2%} of the time "
        f"is the environments', which alone make {steps / seconds['environments']:,.0f} steps/s"
    )
    algorithm.stop()
    ray.shutdown()


if __name__ == "__main__":
    main()
