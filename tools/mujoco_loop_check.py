#!/usr/bin/env python3
"""Compares limits that `libration.probe.mujoco(model).advise` states for a loop with simulations of the MuJoCo model by `mj_step`.

The model is a cart with an inverted pendulum.  One controller has a latency of 2.4 periods, the other a period so long that jitter
matters; both have periods of random length and lose commands.

  * SIMULATION: all events of a period in order, as in docs/plants.md.  The controller reads the state of the model, and a command takes
    over within a period, between two `mj_step` or within one, which is divided in two then.  The last step of a period is shorter if the
    period is no whole number of steps; latencies stretch with it.  A lost command never acts.  Deviations are small, and are scaled back
    in each period.
  * PERIODS OF THE MODEL: the matrix of a period, by central differences of the simulation of a period.  Its spectral radius decides on
    latencies, and that of E[M (x) M] over lengths of periods (by quadrature) and losses on jitter and losses.  Bisection gives a limit.
  * GROWTH of simulations at 0.97 and 1.03 of each stated limit, in logarithms of the mean square per period, beside `growth` of advise.
    Without random numbers it is that of a long run.  With them it is that of the second moment, over an ensemble of independent runs
    that are resampled in proportion to their squares after each period: the second moment of a plain ensemble is that of some rare
    outbursts.  The standard error is that of the mean over groups of runs.
  * PLAIN ENSEMBLE: growth of the second moment over the first periods without resampling, beside E[M (x) M] of the stated plant.

The exit code is 1 if a limit of the model is more than 1 % from the stated one, or if a growth has the wrong sign, or is more than four
standard errors and 1 % of the distance of the two growths from the stated one.

usage: mujoco_loop_check.py [--runs 400] [--periods 150] [--seed 1]
"""
import argparse
import os
import sys

import libration
import mujoco
import numpy as np
from scipy.linalg import solve_continuous_are
from scipy.stats import norm

MODEL = """<mujoco model="inverted pendulum on a cart"><option timestep="0.004" integrator="{integrator}"/>
<default><geom contype="0" conaffinity="0"/></default><worldbody><body>
<joint name="cart" type="slide" axis="1 0 0" damping="0.5"/><geom type="box" size="0.1 0.05 0.05" mass="1"/>
<body><joint name="pole" type="hinge" axis="0 1 0" damping="0.02"/><geom type="capsule" fromto="0 0 0 0 0 1.6" size="0.02" mass="0.3"/>
</body></body></worldbody><actuator><motor name="force" joint="cart"/></actuator></mujoco>"""
LOOPS = {
    "slow controller, long latency": (10, 0.2, {"latency": 2.4, "jitter": 0.2, "loss": 0.1}),
    "fast controller, long period": (30, 0.02, {"latency": 0.15, "jitter": 0.2, "loss": 0.02}),
}
"""Steps of the model in a period, weight of commands, and sizes: in periods, as a relative standard deviation (uniform law), and as a
probability."""
WEIGHTS = np.diag([1.0, 4.0, 0.5, 0.5])
SIZE = 1e-6


class Loop:
    """Simulations of the closed loop; their state is that of the model, the command that acts, and those under way, newest first."""

    def __init__(self, model, dt, steps, gain, latency):
        self.model, self.data = model, mujoco.MjData(model)
        self.gain, self.dt, self.steps = gain, dt, steps
        # 0.3 / 0.1 is not 3.
        self.whole, self.part = divmod(round(latency, 10), 1)
        self.whole = int(self.whole)
        self.size = 5 + self.whole

    def hold(self, command, steps):
        """Take steps under a command, the last one shorter if their number is not whole."""
        model, data = self.model, self.data
        data.ctrl[0] = command
        whole = int(steps + 1e-9)
        if whole:
            model.opt.timestep = self.dt
            mujoco.mj_step(model, data, nstep=whole)
        rest = steps - whole
        if rest > 1e-9:
            model.opt.timestep = rest * self.dt
            mujoco.mj_step(model, data)

    def period(self, state, length, lost):
        """The state a period of this relative length later."""
        data = self.data
        x, acting, under_way = state[:4], state[4], list(state[5:])
        under_way.insert(0, -float(self.gain @ x))
        arriving = under_way.pop()
        data.qpos[:], data.qvel[:], data.time = x[:2], x[2:], 0
        self.hold(acting, self.part * length * self.steps)
        if not lost:
            acting = arriving
        self.hold(acting, (1 - self.part) * length * self.steps)
        return np.concatenate([data.qpos, data.qvel, [acting], under_way])

    def matrix(self, length, lost):
        """The matrix of a period by central differences."""
        columns = []
        for unit in np.eye(self.size):
            above, below = (self.period(sign * SIZE * unit, length, lost) for sign in (1, -1))
            columns.append((above - below) / (2 * SIZE))
        return np.stack(columns, axis=1)


def lengths_and_weights(rms):
    """Relative lengths of periods by quadrature over the uniform law; those below zero have length zero."""
    if rms == 0:
        return [(1.0, 1.0)]
    half = rms * 3**0.5
    low = max(-half, -1.0)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    lengths = 1 + low + (half - low) * (nodes + 1) / 2
    weights = weights * (half - low) / (4 * half)
    rest = 1 - weights.sum()
    return [*zip(lengths, weights), *([(0.0, rest)] if rest > 1e-12 else [])]


def branches_of(loop, jitter, loss):
    """Probabilities and matrices of periods of the model."""
    chances = [(lost, chance) for lost, chance in ((False, 1 - loss), (True, loss)) if chance > 0]
    return [
        (weight * chance, loop.matrix(length, lost)) for length, weight in lengths_and_weights(jitter) for lost, chance in chances
    ]


def moments(loop, jitter, loss):
    return sum(weight * np.kron(matrix, matrix) for weight, matrix in branches_of(loop, jitter, loss))


def moment_growth(loop, jitter, loss):
    """The logarithm of the growth of second moments per period, by matrices of the model."""
    return float(np.log(np.max(np.abs(np.linalg.eigvals(moments(loop, jitter, loss))))))


def quadratic_form(loop, jitter, loss):
    """The quadratic form whose mean a period multiplies by the growth; any other has the same growth, with more noise."""
    values, vectors = np.linalg.eig(moments(loop, jitter, loss).T)
    form = np.real(vectors[:, np.argmax(np.abs(values))]).reshape(loop.size, loop.size)
    return (form + form.T) * np.sign(np.trace(form))


def draw(rng, jitter, loss, count):
    lengths = np.maximum(0.0, 1 + jitter * 3**0.5 * rng.uniform(-1, 1, count))
    return lengths, rng.random(count) < loss


def run_growth(loop, periods):
    """The growth of the square of a run without random numbers, over its second half."""
    state = np.random.default_rng(0).normal(size=loop.size)
    logs = []
    for _ in range(periods):
        state *= SIZE / np.linalg.norm(state)
        state = loop.period(state, 1.0, False)
        logs.append(2 * np.log(np.linalg.norm(state) / SIZE))
    # A line, since the size of a deviation also oscillates.
    return float(np.polyfit(np.arange(periods // 2), np.cumsum(logs)[periods - periods // 2 :], 1)[0])


def ensemble_growth(loop, jitter, loss, runs, periods, seed, weight, groups=8):
    """The growth of the second moment of an ensemble that is resampled in each period, and its standard error."""
    found = []
    for group in range(groups):
        rng = np.random.default_rng([seed, group])
        states = rng.normal(size=(runs, loop.size))
        ratios = []
        for k in range(periods):
            states *= SIZE / np.sqrt(squares(states, weight))[:, None]
            lengths, lost = draw(rng, jitter, loss, runs)
            states = np.stack([loop.period(*case) for case in zip(states, lengths, lost)])
            ratio = squares(states, weight) / SIZE**2
            if k >= periods // 5:
                ratios.append(ratio.mean())
            # Systematic resampling.
            places = (rng.random() + np.arange(runs)) / runs
            states = states[np.minimum(np.searchsorted(np.cumsum(ratio) / ratio.sum(), places), runs - 1)]
        found.append(np.mean(ratios))
    return float(np.log(np.mean(found))), float(np.std(found, ddof=1) / groups**0.5 / np.mean(found))


def plain_growth(loop, jitter, loss, runs, horizon, seed, start):
    """The logarithm of the second moment over a horizon of a plain ensemble relative to the start, and its standard error."""
    rng = np.random.default_rng([seed, 99])
    states = SIZE * (start @ rng.normal(size=(loop.size, runs))).T
    begin = SIZE**2 * np.sum(start**2)
    for _ in range(horizon):
        lengths, lost = draw(rng, jitter, loss, runs)
        states = np.stack([loop.period(*case) for case in zip(states, lengths, lost)])
    values = np.sum(states**2, axis=1) / begin
    return float(np.log(values.mean())), float(values.std(ddof=1) / runs**0.5 / values.mean())


def exact_moment(loop, jitter, loss, horizon, start):
    """The same by matrices of the model."""
    moment = start @ start.T
    branches = branches_of(loop, jitter, loss)
    begin = np.trace(moment)
    for _ in range(horizon):
        moment = sum(weight * matrix @ moment @ matrix.T for weight, matrix in branches)
    return float(np.log(np.trace(moment) / begin))


def squares(states, weight):
    return np.einsum("ki,ij,kj->k", states, weight, states)


def bisect(function, low, high):
    if function(low) > 0 or function(high) <= 0:
        return None
    while high / low - 1 > 1e-6:
        middle = (low + high) / 2
        low, high = (low, middle) if function(middle) > 0 else (middle, high)
    return (low + high) / 2


def check(integrator, label, arguments):
    model = mujoco.MjModel.from_xml_string(MODEL.format(integrator=integrator))
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    report = libration.probe.mujoco(model)
    plant = report.plant
    steps, effort, sizes_stated = LOOPS[label]
    effort = np.eye(1) * effort
    riccati = solve_continuous_are(plant.A, plant.B, WEIGHTS, effort)
    gain = np.linalg.solve(effort, plant.B.T @ riccati)
    dt = report.results["dt"]
    period = steps * dt
    controller = libration.StateFeedback(gain)

    def advise(latency, jitter, loss):
        return report.advise(
            controller, period=period, latency=latency * period, jitter=("uniform", jitter), loss=loss, cost_weights=(WEIGHTS, effort)
        )

    advice = advise(**sizes_stated)
    print(f"\n{label}, {integrator}: {sizes_stated}")
    print(f"gain {np.round(gain[0], 3).tolist()}, period {period:g} s, findings: {report.findings or 'none'}")
    print(advice["answer"])
    limits = {b["kind"]: b["stable_up_to"] for b in advice["budgets"] if b["kind"] in sizes_stated and b.get("channel") is None}
    limits["latency"] = limits["latency"] and limits["latency"] / period
    cases = [(name, limit, dict.fromkeys(sizes_stated, 0.0), name) for name, limit in limits.items()]
    cases.append(("common factor", advice["margin"], None, None))
    agree = True
    print(f"{'limit of':<15} {'stated':>10} {'of the model':>13} {'difference':>11}   at   growth stated    of the model    of simulations")
    for name, limit, _, key in cases:
        if limit is None:
            print(f"{name:<15} {'none':>10}")
            continue

        def sizes(size, key=key):
            if key is None:
                return {name: size * stated for name, stated in sizes_stated.items()}
            return {name: size if name == key else 0.0 for name in sizes_stated}

        def of_model(size):
            at = sizes(size)
            return moment_growth(Loop(model, dt, steps, gain[0], at["latency"]), at["jitter"], at["loss"])

        found = bisect(of_model, 0.9 * limit, 1.1 * limit)
        good = found is not None and abs(found / limit - 1) <= 0.01
        line = f"{name:<15} {limit:10.6g} " + (f"{found:13.6g} {found / limit - 1:+11.1e}" if found else f"{'none near':>13} {'':>11}")
        stated, measured, errors = [], [], []
        for part in (0.97, 1.03):
            at = sizes(part * limit)
            loop = Loop(model, dt, steps, gain[0], at["latency"])
            stated.append(advise(**at)["growth"])
            if at["jitter"] == at["loss"] == 0:
                growth, error = run_growth(loop, 20_000), 0.0
            else:
                weight = quadratic_form(loop, at["jitter"], at["loss"])
                growth, error = ensemble_growth(loop, at["jitter"], at["loss"], arguments.runs, arguments.periods, arguments.seed, weight)
            measured.append(growth)
            errors.append(error)
        apart = stated[1] - stated[0]
        for part, wanted, growth, error in zip((0.97, 1.03), stated, measured, errors):
            sign = growth < 0 if part < 1 else growth > 0
            close = abs(growth - wanted) <= 4 * error + 0.01 * abs(apart) + 1e-4
            good &= sign and close
            resolved = abs(growth) > 3 * error
            print(
                f"{line:<53} {part:.2f}  {wanted:+13.5f}  {of_model(part * limit):+14.5f}  {growth:+11.5f} ± {error:.5f}"
                + ("" if resolved else "  (sign not resolved)")
                + ("" if sign and close else "  DISAGREES"),
                flush=True,
            )
            line = ""
        agree &= good
    loop = Loop(model, dt, steps, gain[0], sizes_stated["latency"])
    start = np.diag([1.0, 1.0, 1.0, 1.0, *[0.0] * (loop.size - 4)])
    print("plain ensemble, stated sizes: logarithm of the second moment over the horizon relative to the start")
    for horizon in (1, 2, 5, 10):
        wanted = exact_moment(loop, sizes_stated["jitter"], sizes_stated["loss"], horizon, start)
        random = sizes_stated["jitter"], sizes_stated["loss"]
        growth, error = plain_growth(loop, *random, 20 * arguments.runs, horizon, arguments.seed, start)
        good = abs(growth - wanted) <= 4 * error + 1e-3
        agree &= good
        print(f"  {horizon:3d} periods: by matrices {wanted:+.4f}, simulated {growth:+.4f} ± {error:.4f}" + ("" if good else "  DISAGREES"))
    return agree


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=400, help="runs of each of eight groups (default: 400)")
    parser.add_argument("--periods", type=int, default=150, help="periods of each run (default: 150)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--integrators", nargs="+", default=["implicitfast", "RK4"], help="default: implicitfast RK4")
    arguments = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}, {arguments.runs} runs of {arguments.periods} periods in each of eight groups")
    return 0 if all([check(integrator, label, arguments) for label in LOOPS for integrator in arguments.integrators]) else 1


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
