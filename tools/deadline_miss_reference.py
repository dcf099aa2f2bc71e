#!/usr/bin/env python3
"""Makes crates/libration-advise/tests/reference/deadline_misses.json: sampled-data linear loops whose controller overruns its deadlines.

Written from the definition alone: a loop is simulated job by job, with a processor, a queue and registers as plain variables. Its
maps are what the simulation makes of unit vectors.

Job         of period k begins at t_k = k T (1+skew), reads the measurements that have arrived, and computes
            u = Cc m + Dc yhat,  m <- Ac m + Bc yhat.  Its deadline is the end of the period.
kill        an unfinished job ends without a trace.
skip        it goes on; no job begins until it is finished.
queue       it goes on; the latest job waits in place of any that waited before.
Commands    of a job that is finished in period j take over at t_j plus the latency of each input.
missing     where a period sends no commands: hold (the command that acts stays) or zero.

Worst case  all cyclic sequences of up to LONGEST periods that fit "m of K" give the lower bound by spectral radii; all walks of
            WALK periods give the upper bound by norms.
Random      a job that has the processor overruns the end of the period with probability p: second moments of the jump system
            in its textbook form, with one covariance for each state of the processor.

usage: deadline_miss_reference.py --count N --seed S
"""
import argparse, itertools, json, sys
import numpy as np
from scipy.linalg import expm, solve_discrete_are

TICKS = 10
LONGEST, WALK = 8, 12


class Loop:
    """Variables: plant x, memory m, acting command, registers of commands and of samples (newest first), and the measurements that
    an unfinished job has read."""

    def __init__(self, p, strategy, missing):
        self.p, self.strategy, self.missing = p, strategy, missing
        n, nu = p["b"].shape
        h = p["period"] * (1 + p["skew"]) / TICKS
        whole = expm(np.block([[p["a"], p["b"]], [np.zeros((nu, n + nu))]]) * h)
        self.phi, self.gamma = whole[:n, :n], whole[:n, n:]
        self.inputs = [divmod(round(TICKS * v), TICKS) for v in p["input_latency"]]
        self.outputs = [divmod(round(TICKS * v), TICKS) for v in p["output_latency"]]
        # A register holds the period's own value and all that are still under way.
        self.shape = dict(x=n, m=len(p["ac"]), act=nu, y=len(p["c"]))
        for i, (w, _) in enumerate(self.inputs):
            self.shape[f"u{i}"] = 2 * (w + 1)       # value, and whether there is one: 1 command, 0 none
        for j, (w, f) in enumerate(self.outputs):
            self.shape[f"s{j}"] = w + 1 + (f > 0)

    def period(self, v, running, outcome):
        """One period of one loop: v are the variables, changed in place. Returns whether a job is unfinished at the end."""
        p = self.p
        u0 = v["act"].copy()
        def sample(j):
            value = p["c"][j] @ v["x"] + p["d"][j] @ v["act"]
            v[f"s{j}"] = np.r_[value, v[f"s{j}"][:-1]]
        for j, (w, f) in enumerate(self.outputs):
            if f == 0:
                sample(j)
        seen = np.array([v[f"s{j}"][w] for j, (w, f) in enumerate(self.outputs)])
        sent = None
        def finish(measured):
            command = p["cc"] @ v["m"] + p["dc"] @ measured
            v["m"] = p["ac"] @ v["m"] + p["bc"] @ measured
            return command
        if self.strategy == "kill":
            v["y"] = seen
            if outcome == "met":
                sent = finish(seen)
            running = False
        elif self.strategy == "skip":
            if not running:
                v["y"] = seen
            if outcome == "met":
                sent = finish(v["y"])
            running = outcome == "missed"
        else:
            waiting = seen if running else None
            if not running:
                v["y"] = seen
            if outcome in ("met", "late"):
                sent = finish(v["y"])
                if running:                          # the one that waits has the processor now
                    v["y"] = waiting
                    if outcome == "met":
                        sent = finish(v["y"])
            running = outcome != "met"
        for i, (w, f) in enumerate(self.inputs):
            entry = [0.0, 0.0] if sent is None else [sent[i], 1.0]
            v[f"u{i}"] = np.r_[entry, v[f"u{i}"][:-2]]
        for tick in range(TICKS):
            for j, (w, f) in enumerate(self.outputs):
                if f > 0 and tick == TICKS - f:
                    sample(j)
            for i, (w, f) in enumerate(self.inputs):
                if f == tick:
                    value, there = v[f"u{i}"][2 * w: 2 * w + 2]
                    if there:
                        v["act"][i] = value
                    elif self.missing == "zero":
                        v["act"][i] = 0.0
            v["x"] = self.phi @ v["x"] + self.gamma @ v["act"]
        return running


def fresh(loop):
    return {name: np.zeros(k) for name, k in loop.shape.items()}


def flags(loop):
    return [name for name in loop.shape if name.startswith("u")]


def pack(loop, v):
    return np.concatenate([v[name][0::2] if name in flags(loop) else v[name] for name in loop.shape])


def unpack(loop, z, there):
    v, at = {}, 0
    for name, k in loop.shape.items():
        if name in there:
            v[name] = np.zeros(k)
            v[name][0::2], v[name][1::2] = z[at: at + k // 2], there[name]
            at += k // 2
        else:
            v[name] = z[at: at + k].copy()
            at += k
    return v


def matrix(loop, sequence, running, there):
    """The map of the variables under a sequence of outcomes, and the processor and the flags behind it."""
    size = len(pack(loop, fresh(loop)))
    columns = []
    for unit in np.eye(size):
        v, busy = unpack(loop, unit, there), running
        for outcome in sequence:
            busy = loop.period(v, busy, outcome)
        columns.append(pack(loop, v))
    return np.array(columns).T, busy, {name: v[name][1::2] for name in flags(loop)}


def fits(missed, m, K):
    return all(sum(missed[i: i + K]) <= m for i in range(len(missed) - K + 1))


def outcomes(strategy):
    return ("met", "missed", "late") if strategy == "queue" else ("met", "missed")


def legal(sequence, running):
    """A late period requires an unfinished job before it."""
    for outcome in sequence:
        if outcome == "late" and not running:
            return False
        running = outcome != "met"
    return True


def worst_case(p, strategy, missing, m, K):
    loop = Loop(p, strategy, missing)
    lead = max([w for w, _ in loop.inputs]) + 1
    best, upper = (0.0, None), 0.0
    # Step matrices depend on the outcomes of the periods before through the flags: all words of lead + 1 outcomes.
    steps = {}
    for word in itertools.product(outcomes(strategy), repeat=lead + 1):
        if not legal(word, True):
            continue
        before = word[:-1]
        there = {f"u{i}": np.array([float(before[-1 - k] != "missed") if k < len(before) else 0.0 for k in range(w + 1)])
                 for i, (w, _) in enumerate(loop.inputs)}
        busy = before[-1] != "met" and strategy != "kill"
        steps[word] = matrix(loop, word[-1:], busy, there)[0]
    kind = lambda o: o != "met"
    for length in range(1, LONGEST + 1):
        for cycle in itertools.product(outcomes(strategy), repeat=length):
            again = cycle * (2 + (K + lead) // length)
            if min(cycle[i:] + cycle[:i] for i in range(length)) != cycle or not fits([kind(o) for o in again], m, K):
                continue
            if not legal(again, kind(cycle[-1])):
                continue
            M = np.eye(len(next(iter(steps.values()))))
            long = cycle * (1 + (lead + length) // length)
            for t in range(len(long) - length, len(long)):
                M = steps[long[t - lead: t + 1]] @ M
            rho = max(abs(np.linalg.eigvals(M))) ** (1 / length)
            if rho > best[0] * (1 + 1e-9):
                best = (rho, cycle)
    # Norms in coordinates of a Lyapunov equation of the periods without misses.
    met = steps[("met",) * (lead + 1)]
    r = max(abs(np.linalg.eigvals(met)))
    X, A = np.eye(len(met)), met / (r * 1.05 + 1e-6)
    for _ in range(12):
        X, A = X + A.T @ X @ A, A @ A
    F = np.linalg.cholesky(X).T
    G = np.linalg.inv(F)
    turned = {word: F @ S @ G for word, S in steps.items()}
    level = {}
    for word in itertools.product(outcomes(strategy), repeat=max(lead, K - 1)):
        if legal(word, True) and fits([kind(o) for o in word], m, K):
            level.setdefault(word, []).append(np.eye(len(met)))
    for _ in range(WALK):
        following = {}
        for word, products in level.items():
            for o in outcomes(strategy):
                longer = word + (o,)
                if not legal(longer[-2:], kind(longer[-2]) if len(longer) < 2 else True) or (o == "late" and word[-1] == "met"):
                    continue
                if not fits([kind(x) for x in longer], m, K):
                    continue
                step = turned[longer[-(lead + 1):]]
                following.setdefault(longer[1:], []).extend(step @ P for P in products)
        level = following
        if sum(map(len, level.values())) > 40000:
            break
    length = _ + 1
    upper = max(np.linalg.norm(P, 2) for products in level.values() for P in products) ** (1 / length)
    return best[0], list(best[1]), upper


def random_growth(p, strategy, missing, probability):
    """The logarithm of the growth of second moments. Latencies are below a period: registers need no flags from before."""
    loop = Loop(p, strategy, missing)
    there = {name: np.zeros(loop.shape[name] // 2) for name in flags(loop)}
    q = probability
    branches = {False: [("met", 1 - q), ("missed", q)]}
    branches[True] = branches[False]
    if strategy == "queue":
        branches[True] = [("missed", q), ("late", (1 - q) * q), ("met", (1 - q) ** 2)]
    modes = [False] if strategy == "kill" else [False, True]
    size = len(pack(loop, fresh(loop)))
    whole = np.zeros((len(modes) * size**2,) * 2)
    for i, busy in enumerate(modes):
        for outcome, weight in branches[busy]:
            M, after, _ = matrix(loop, [outcome], busy, there)
            j = modes.index(after)
            whole[j * size**2: (j + 1) * size**2, i * size**2: (i + 1) * size**2] += weight * np.kron(M, M)
    return float(np.log(max(abs(np.linalg.eigvals(whole)))))


def draw(rng, small):
    n, nu = int(rng.integers(1, 4 if not small else 3)), int(rng.integers(1, 3 if not small else 2))
    a = rng.standard_normal((n, n)) + np.diag(rng.uniform(-1.5, 0.7, n))
    b = rng.standard_normal((n, nu))
    dynamic = rng.random() < 0.5
    ny = int(rng.integers(1, n + 1)) if dynamic else n
    c = rng.standard_normal((ny, n)) if dynamic else np.eye(n)
    d = np.zeros((ny, nu))
    p = dict(a=a, b=b, c=c, d=d, period=float(rng.uniform(0.15, 0.6)), skew=float(rng.choice([0.0, 0.1])))
    whole = expm(np.block([[a, b], [np.zeros((nu, n + nu))]]) * p["period"])
    ad, bd = whole[:n, :n], whole[:n, n:]
    x = solve_discrete_are(ad, bd, np.eye(n), 0.3 * np.eye(nu))
    k = np.linalg.solve(0.3 * np.eye(nu) + bd.T @ x @ bd, bd.T @ x @ ad)
    if dynamic:
        y = solve_discrete_are(ad.T, c.T, np.eye(n), np.eye(ny))
        l = np.linalg.solve(c @ y @ c.T + np.eye(ny), c @ y @ ad.T).T
        p.update(ac=ad - bd @ k - l @ c, bc=l, cc=-k, dc=np.zeros((nu, ny)))
    else:
        p.update(ac=np.zeros((0, 0)), bc=np.zeros((0, n)), cc=np.zeros((nu, 0)), dc=-k)
    late = lambda most: round(TICKS * float(rng.choice([0.0, 0.3, 0.7, 1.0, 1.4]) if most > 1 else rng.choice([0.0, 0.4, 0.8]))) / TICKS
    p["input_latency"] = [late(1 if small else 2) for _ in range(nu)]
    p["output_latency"] = [late(1) if rng.random() < 0.4 else 0.0 for _ in range(ny)]
    return p


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=45)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    rng = np.random.default_rng(args.seed)
    cases = []
    while len(cases) < args.count:
        i = len(cases)
        small = i % 3 == 2
        p = draw(rng, small)
        strategy, missing = ("kill", "skip", "queue")[(i + i // 3) % 3], ("hold", "zero")[(i // 2) % 2]
        m, K = [(1, 2), (1, 3), (2, 3), (1, 4), (2, 4), (2, 5)][int(rng.integers(0, 6))]
        lower, cycle, upper = worst_case(p, strategy, missing, m, K)
        if not 0.3 < lower < 2.5:
            continue
        case = {key: np.asarray(value).tolist() if not isinstance(value, float) else value for key, value in p.items()}
        case.update(strategy=strategy, missing=missing, misses=m, window=K, lower=lower, cycle=cycle, upper=upper)
        if small:
            case["probability"] = float(rng.choice([0.05, 0.2, 0.5]))
            case["growth"] = random_growth(p, strategy, missing, case["probability"])
        cases.append(case)
        print(i, strategy, missing, (m, K), lower, cycle, upper, case.get("growth"), file=sys.stderr)
    json.dump({"cases": cases}, sys.stdout)
    print()


if __name__ == "__main__":
    main()
