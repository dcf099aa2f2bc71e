"""How late may commands be? Advice, then the same loop in an environment, with and without that delay.

1. ``libration.advise`` derives from the model how much latency a PD loop around an oscillator stands.
2. An environment of the same oscillator is closed by the same gains, 1000 episodes at once, under several delays.
3. The growth that is measured stands beside the one that theory predicts; with matplotlib a figure is drawn, too.

    pip install matplotlib
    python latency_budget.py --figure budget.png
"""

import argparse
import math

import numpy as np

import libration
from libration.policies import Linear

PERIOD = 0.01  # s, between two commands
GAINS = libration.PD(kp=10.0, kd=2.0)
SYSTEM = libration.System("oscillator", omega2=10.0)


def budget() -> float:
    """The latency in s up to which the loop is stable, by the theory of its exact steps."""
    advice = libration.advise(SYSTEM, GAINS, period=PERIOD, latency=0.05)
    print(advice.answer)
    (latency,) = (entry for entry in advice["loop"]["budgets"] if entry["kind"] == "latency")
    return latency["stable_up_to"]


def amplitudes(latency: float, episodes: int = 1000, seconds: float = 8.0) -> np.ndarray:
    """Root mean square of the distance from the equilibrium, action by action, in an environment with that delay."""
    envs = libration.Environments(
        "Oscillator",
        episodes,
        integrator="rk4",
        dt=PERIOD,
        substeps=10,
        action_delay=latency,
        omega2=10.0,
        max_action=math.inf,
        max_episode_steps=math.inf,
        bound=math.inf,
        threads=0,
    )
    envs.reset(seed=0)
    loop = Linear([-GAINS.kp, -GAINS.kd])
    seen = envs.rollout(loop, round(seconds / PERIOD)).observations.astype(np.float64)
    # Energy has no zero crossings, which a distance has.
    return np.sqrt((seen[..., 0] ** 2 + seen[..., 1] ** 2 / 10.0).mean(axis=1))


def predicted_growth(latency: float) -> float:
    """By how much the loop grows in a second, as theory has it."""
    step = libration.analyze(SYSTEM, integrator="exact", dt=PERIOD, feedback=GAINS, latency=latency)
    return math.log(step.closed_loop_spectral_radius) / PERIOD


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--figure", metavar="FILE", help="draw into this file (needs matplotlib)")
    figure = parser.parse_args().figure

    limit = budget()
    print(f"\nstable up to {limit:.4f} s\n\n  latency/s  predicted growth/s⁻¹  measured/s⁻¹")
    # Whole thousandths of a second: the environment takes ten steps of the integrator from command to command.
    lates = [0.0, *(round(1000 * limit * share) / 1000 for share in (0.5, 0.9, 1.1, 1.3))]
    curves = {}
    for late in lates:
        size = amplitudes(late)
        # The slowest mode is alone once the others have decayed: the slope of the second half.
        half = len(size) // 2
        measured = np.polyfit(PERIOD * np.arange(half), np.log(size[-half:]), 1)[0]
        curves[late] = size, predicted_growth(late)
        print(f"  {late:9.3f}  {curves[late][1]:20.3f}  {measured:12.3f}")
    if figure:
        draw(figure, curves, limit)


def draw(file: str, curves: dict, limit: float) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    _, axes = pyplot.subplots(figsize=(8, 4.5), layout="constrained")
    for late, (size, growth) in curves.items():
        t = PERIOD * np.arange(len(size))
        (line,) = axes.semilogy(t, size, label=f"{1000 * late:.0f} ms late")
        middle = len(t) // 2
        axes.semilogy(t, size[middle] * np.exp(growth * (t - t[middle])), ":", color=line.get_color())
    axes.set(
        xlabel="time in s",
        ylabel="amplitude (rms of 1000 episodes) in m",
        title=f"A loop that stands {1000 * limit:.0f} ms (dotted: growth that theory predicts)",
        ylim=(1e-4, 1e2),
    )
    axes.legend()
    pyplot.savefig(file, dpi=120)


if __name__ == "__main__":
    main()
