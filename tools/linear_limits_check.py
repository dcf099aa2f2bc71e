#!/usr/bin/env python3
"""Judges the stability limits that libration.advise states for random loops around linear plants, from docs/plants.md alone.

  * MAP OF A PERIOD: events (samples, commands that take over) in order, a matrix exponential between two of them, commands and
    samples in queues.  Its spectral radius decides on latencies and skew.
  * SECOND MOMENTS: E[M (x) M] over the law of the periods (those of negative length have length zero) and over losses.
  * SIMULATION of every tenth plant: all events of a run by their instants, without the map.
A limit agrees if the loop is stable a millionth below and unstable a millionth above (with jitter or losses a hundred-thousandth),
and stable on a grid of sizes below it, whose peaks are searched for narrow windows.  Without a limit the grid goes to the largest
size that was tried.  Limits are those of an imperfection alone; "growth" and "margin" (a factor from 1 up) of all stated ones.

usage: linear_limits_check.py --count 200 --seed 1 [--plant K]     (a line for each disagreement; exit code 1 if there is one)
"""
import argparse, multiprocessing, os, sys
from collections import Counter
import libration
import numpy as np
from scipy.linalg import block_diag, expm, solve_discrete_are
from scipy.optimize import brentq, minimize_scalar
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs
from scipy.stats import norm

# ---------------------------------------------------------------- the judge
def period_map(p, h, late_in, late_out, lost=False):
    """The maps of a period for each length in h, latencies in periods.  The state is: plant, memory, commands that act, the
    commands of each input and the samples of each output under way (newest first)."""
    (n, nu), h = p["b"].shape, np.atleast_1d(h)
    (s, g), (r, f) = (np.divmod(np.round(v, 10), 1) for v in (late_in, late_out))    # 0.3 / 0.1 is not 3
    sizes = np.r_[n, len(p["ac"]), nu, s, r + (f > 0)].astype(int)
    x, m, act, *queues = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1])
    fresh = list(p["c"] @ x + p["d"] @ act)
    reading = np.array([q[-1] if len(q) else y for q, y in zip(queues[nu:], fresh)])
    u, m = p["cc"] @ m + p["dc"] @ reading, p["ac"] @ m + p["bc"] @ reading
    events = [(round(1 - v, 10), 0, j) for j, v in enumerate(f) if v > 0] + [(round(v, 10), 1, i) for i, v in enumerate(g)]
    x, now = np.broadcast_to(x, (len(h), *x.shape)), 0.0
    for phase, kind, channel in sorted(events) + [(1.0, 2, 0)]:
        if phase > now:
            e = expm(p["generator"] * ((phase - now) * h)[:, None, None])
            x, now = e[:, :n, :n] @ x + e[:, :n, n:] @ act, phase
        if kind == 0:
            fresh[channel] = p["c"][channel] @ x + p["d"][channel] @ act
        elif kind == 1 and not (lost and p["missing"] == "hold"):
            act = act.copy()
            act[channel] = 0 if lost else queues[channel][-1] if s[channel] else u[channel]
    rows = [x, m, act]
    for q, new in zip(queues, [*u, *fresh]):
        rows += [new[..., None, :], q[:-1]] if len(q) else []
    return np.concatenate([np.broadcast_to(part, (len(h), *part.shape[-2:])) for part in rows], 1)

def law(p, rms):
    """Relative lengths of periods and their probabilities."""
    half = rms * (3**0.5 if p["law"] == "uniform" else 10)
    z, w = np.polynomial.legendre.leggauss(48 + int((half - (low := max(-half, -1))) * p["speed"]))
    z, w = low + (half - low) * (z + 1) / 2, w * (half - low) / 2
    w = w / (2 * half) if p["law"] == "uniform" else w * norm.pdf(z / rms) / rms
    return np.append(1 + z, 0.0), np.append(w, max(0.0, 1 - w.sum()))    # the rest has length zero

def second_moments(branches):
    """The spectral radius of P -> sum of w M P M^T."""
    maps = np.concatenate([np.sqrt(w)[:, None, None] * m for w, m in branches])
    size = maps.shape[1]
    _, values, rows = np.linalg.svd(maps.reshape(len(maps), -1), full_matrices=False)    # the same operator in fewer terms
    maps = (values[:, None] * rows)[values > 1e-15 * values[0]].reshape(-1, size, size)
    step = lambda v: (maps @ v.reshape(size, size) @ maps.transpose(0, 2, 1)).sum(0).ravel()
    for ncv in (60, 240) if size > 20 else ():           # several eigenvalues: those of queues are close to each other
        try:
            return np.abs(eigs(LinearOperator((size**2,) * 2, step, dtype=float), 4, v0=np.eye(size).ravel(), ncv=ncv, tol=1e-11,
                               maxiter=400, return_eigenvectors=False)).max()
        except ArpackNoConvergence:
            pass
    i, j = np.triu_indices(size)                        # the matrix of the operator on symmetric P
    entries = lambda p, q: sum(m[i][:, p] * m[j][:, q] for m in maps)
    return np.abs(np.linalg.eigvals((entries(i, j) + entries(j, i)) * np.where(i == j, 0.5, 1))).max()

def growth(p, late_in=0.0, late_out=0.0, jitter=0.0, skew=0.0, loss=0.0):
    """The factor per period: of the state without jitter and losses, else of its second moments."""
    late_in, late_out = (np.broadcast_to(v, k) for v, k in ((late_in, p["b"].shape[1]), (late_out, len(p["c"]))))
    h, late_in, late_out = p["period"] * (1 + skew), late_in / (1 + skew), late_out / (1 + skew)    # a latency in s stays
    if jitter == 0 and loss == 0:
        return np.abs(np.linalg.eigvals(period_map(p, h, late_in, late_out)[0])).max()
    lengths, w = law(p, jitter) if jitter else (np.ones(1), np.ones(1))
    branches = ((1 - loss, False), (loss, True))
    return second_moments([(w * q, period_map(p, h * lengths, late_in, late_out, lost)) for q, lost in branches if q > 0])

def simulate(p, periods, late_in, late_out):
    """The growth per period of a run, event by event in order of time (in periods), from a random state."""
    n, nu = p["b"].shape
    events = [(float(k), 1, k, 0) for k in range(periods)]
    events += [(round(k + v, 9), 2, k, i) for k in range(periods) for i, v in enumerate(late_in)]
    events += [(round(k - v, 9), 0, k, j) for k in range(periods) for j, v in enumerate(late_out) if k >= v]
    x, act, m, now, flows = np.random.default_rng(7).standard_normal(n), np.zeros(nu), np.zeros(len(p["ac"])), 0.0, {}
    samples, commands, size = {}, {}, []
    for instant, kind, k, channel in sorted(events):
        d, now = round(instant - now, 9), instant
        if d > 0 and d not in flows:
            flows[d] = expm(p["generator"] * d * p["period"])[:n]
        x = flows[d] @ np.append(x, act) if d > 0 else x
        if kind == 0:
            samples[k, channel] = p["c"][channel] @ x + p["d"][channel] @ act
        elif kind == 1:
            y = np.array([samples.pop((k, j), 0.0) for j in range(len(late_out))])
            commands[k], m = p["cc"] @ m + p["dc"] @ y, p["ac"] @ m + p["bc"] @ y
            size.append(np.linalg.norm(x))
        else:
            act[channel] = commands[k][channel]
    return np.exp(np.polyfit(np.arange(periods // 2), np.log(size[-(periods // 2):]), 1)[0])

# ---------------------------------------------------------------- random loops
def random_plant(rng, n, nu, stable):
    blocks, oscillator = [], lambda w, z: [[0, 1], [-w * w, -2 * z * w]]
    while (room := n - sum(map(len, blocks))) > 0:
        kind, w, z = int(rng.choice(4 if stable or len(blocks) > 1 else 7)), rng.uniform(0.3, 2.5), 10 ** rng.uniform(-2.2, -0.2)
        block = [[[-w]], oscillator(w, z), oscillator(w, z), [[-w, w], [0, -w]], oscillator(w, -z / 2), [[0.4 * w]], [[0, 1], [0, 0]]][kind]
        blocks += [np.array(block)] * (len(block) <= room)
    A = block_diag(*blocks) + np.triu(0.2 * rng.standard_normal((n, n)), 2)
    Q = np.linalg.qr(rng.standard_normal((n, n)))[0] * rng.uniform(0.6, 1.6, n)
    return np.linalg.solve(Q, A @ Q), np.linalg.solve(Q, rng.standard_normal((n, nu)) + 0.5)

def with_parts(p, parts):
    """The plant with first-order lags (input, channel, "lag", s) and Butterworth filters (..., "filter", Hz) of channels."""
    A, B, C, D = (p[k] for k in "abcd")
    for on_input, j, kind, value in parts:
        w = 2 * np.pi * value
        a, b, c = map(np.array, ([[-1 / value]], [[1 / value]], [[1]]) if kind == "lag" else
                      ([[0, 1], [-w * w, -2**0.5 * w]], [[0], [w * w]], [[1, 0]]))
        if not on_input:                                # a part of an output is one of an input of the dual plant
            A, B, C, D, a, b, c = A.T, C.T, B.T, D.T, a.T, c.T, b.T
        one, A = np.eye(B.shape[1])[[j]], np.block([[A, B[:, [j]] @ c], [np.zeros((len(a), len(A))), a]])
        B, C, D = np.vstack([B * (1 - one), b @ one]), np.hstack([C, D[:, [j]] @ c]), D * (1 - one)
        if not on_input:
            A, B, C, D = A.T, C.T, B.T, D.T
    return dict(a=A, b=B, c=C, d=D)

def regulator(a, b, q, r, h):
    """The plant of a step and the gain of least cost in continuous time, whose integral over the step is by Gauss-Legendre."""
    n, S, generator = len(a), 0, block_diag(np.hstack([a, b]), np.zeros((b.shape[1], 0)))
    for z, w in zip(*np.polynomial.legendre.leggauss(24)):
        e = expm(generator * h * (z + 1) / 2)
        S = S + w * h / 2 * e.T @ block_diag(q, r) @ e
    (Ad, Bd), cross = np.split(expm(generator * h)[:n], [n], 1), S[:n, n:]
    X = solve_discrete_are(Ad, Bd, S[:n, :n], S[n:, n:], s=cross)
    return Ad, Bd, np.linalg.solve(S[n:, n:] + Bd.T @ X @ Bd, Bd.T @ X @ Ad + cross.T)

def predictor(p, R, V):
    """State-space matrices of a regulator of a predicted state, designed for the plant with its parts.  A sample still sees the
    command before: the memory is the estimate and that command."""
    C, (nu, ny) = p["c"], p["d"].T.shape
    Ad, Bd, K = regulator(p["a"], p["b"], C.T @ C + 0.01 * np.eye(len(p["a"])), np.diag(R), p["period"])
    X = solve_discrete_are(Ad.T, C.T, p["period"] * (np.eye(len(Ad)) + p["b"] @ p["b"].T), np.diag(V))
    L = np.linalg.solve(C @ X @ C.T + np.diag(V), C @ X @ Ad.T).T
    zero, square = np.zeros((nu, ny)), np.zeros((nu, nu))
    return np.block([[Ad - L @ C - Bd @ K, -L @ p["d"]], [-K, square]]), np.vstack([L, zero]), np.hstack([-K, square]), zero

def random_loop(rng):
    """(loop of the judge, plant and controller of libration, keywords of advise, stated imperfections with latencies in periods)."""
    kind, n = str(rng.choice(["lqr", "lqg", "pid", "space"], p=[0.3, 0.25, 0.2, 0.25])), int(rng.integers(2, 5 + 8 * (rng.random() < 0.2)))
    nu, ny = (int(rng.integers(1, min(3, n) + 1)) for _ in "ab")
    speed = 10 ** rng.uniform(-1, 1.5)
    T, (A, B) = rng.uniform(0.04, 0.6) / speed, random_plant(rng, n, nu, kind == "pid")
    A, B, C, D = A * speed, B * speed, rng.standard_normal((ny, n)), 0.3 * rng.standard_normal((ny, nu)) * (rng.random() < 0.35)
    ny, C, D = (n, np.eye(n), np.zeros((n, nu))) if kind == "lqr" else (ny, C, D)
    if kind == "pid":                                   # positive gain of each pair at low frequencies
        dc = np.diagonal(D - C @ np.linalg.solve(A, B))
        B[:, :len(dc)] *= np.sign(dc)
        D[:, :len(dc)] *= np.sign(dc)
    channels = [(True, j) for j in range(nu)] + [(False, j) for j in range(min(ny, 3))]
    parts = [(*channel, str(rng.choice(["lag", "filter"]))) for channel in channels if rng.random() < 0.2]
    parts = [(*part, rng.uniform(0.2, 1.5) * T if part[2] == "lag" else rng.uniform(0.15, 1) / T) for part in parts]
    p = with_parts(dict(a=A, b=B, c=C, d=D), parts)
    p.update(kind=kind, period=T, missing=str(rng.choice(["hold", "zero"])), law=str(rng.choice(["gaussian", "uniform"])),
             speed=T * np.abs(np.linalg.eigvals(p["a"])).max(), generator=block_diag(np.hstack([p["a"], p["b"]]), np.zeros((nu, 0))))
    Q, R, V = (10 ** rng.uniform(-1.5, 1.5, k) for k in (n, nu, ny))
    if kind == "lqr":
        controller, p["design"] = libration.LQR(Q, R), regulator(A, B, np.diag(Q), np.diag(R), T)[2]
    elif kind == "pid":
        gains = [[*rng.uniform(0, 0.9, 2) / abs(g) * [1, speed], rng.uniform(0, 0.3) / abs(g) / speed, T * rng.uniform(0.3, 3)] for g in dc]
        controller = [(f"y{i + 1}", f"u{i + 1}", libration.PID(*g[:3], filter=g[3])) for i, g in enumerate(gains)]
    else:
        controller = libration.LQG(Q, R, V) if kind == "lqg" else libration.StateSpace(*predictor(p, R, V))
    measured = {} if kind == "lqr" else dict(C=C, D=D)
    plant = libration.LinearPlant(A, B, **measured, parts=[(libration.Lag if k == "lag" else libration.Butterworth2)(
        v, **{"input" if on_input else "output": j}) for on_input, j, k, v in parts])
    beyond = 6.0 * (n > 6 or rng.random() < 0.7)        # mostly beyond the limits: advise is fast then, and finds regained windows
    draw = lambda: float(rng.choice([0, rng.integers(1, 5), rng.uniform(0, 2), rng.uniform(0, 9)], p=[0.2, 0.15, 0.35, 0.3])) + beyond * rng.random()
    size = lambda low, high, share: float(rng.uniform(low, high) * (rng.random() < share)) + 0.0
    stated = dict(late_in=[draw() for _ in range(nu)], late_out=[draw() for _ in range(ny)], jitter=size(0.02, 0.3, 0.35),
                  skew=size(-0.2, 0.4, 0.4), loss=size(0.02, 0.3, 0.35))
    for name in ("late_in", "late_out"):                # often one latency for all
        stated[name] = [stated[name][0]] * len(stated[name]) if rng.random() < 0.4 else stated[name]
    keys = dict(period=T, latency=[v * T for v in stated["late_in"]], output_latency=[v * T for v in stated["late_out"]],
                jitter=(p["law"], stated["jitter"]), skew=stated["skew"], loss=stated["loss"], missing=p["missing"])
    return p, (plant, controller), keys, stated

# ---------------------------------------------------------------- the check
def of_all(channel):
    return channel is None or channel.startswith("all ")

def growth_at(p, kind, channel, stated):
    """(the growth as a function of the size of an imperfection, in the unit of the budget; the relative step across a limit)."""
    if kind in ("latency", "output-latency"):
        key, count = ("late_in", p["b"].shape[1]) if kind == "latency" else ("late_out", len(p["c"]))
        pick = np.ones(count) if of_all(channel) else np.eye(count)[int(channel[1:]) - 1]
        return (lambda v: growth(p, **{key: v / p["period"] * pick})), 1e-6
    if kind == "margin":
        scaled = lambda v: {k: min(1.0, v * q) if k == "loss" else v * np.array(q) for k, q in stated.items()}
        return (lambda v: growth(p, **scaled(v))), 1e-5 if stated["jitter"] or stated["loss"] else 1e-6
    return (lambda v: growth(p, **{kind: v})), 1e-6 if kind == "skew" else 1e-5

def judge(f, near, limit, tried, points, start=0.0, special=()):
    """What is wrong with a limit, or None.  A growth within 1e-9 of 1 decides nothing."""
    top = tried if limit is None else limit * (1 - near)
    sizes = sorted({*(start + (top - start) * np.linspace(0, 0.98, points)), top, *(v for v in special if v < top)}, key=abs)
    values = np.array([f(v) for v in sizes])
    if (bad := np.flatnonzero(values[:-1] > 1 + 1e-9)).size:
        return f"unstable below it, at {sizes[bad[0]]!r}: growth {values[bad[0]]!r}"
    peaks = [i for i in range(1, len(sizes) - 1) if values[i] >= max(values[i - 1], values[i + 1], 0.9)]
    for i in sorted(peaks, key=lambda i: -values[i])[:3]:
        ends, options = sorted((sizes[i - 1], sizes[i + 1])), dict(maxiter=10, xatol=1e-6 * abs(top))
        found = minimize_scalar(lambda v: -f(v), bounds=ends, method="bounded", options=options)
        if -found.fun > 1 + 1e-9:
            return f"unstable in a narrow window below it, at {found.x!r}: growth {-found.fun!r}"
    below, above = values[-1], 1.0 if limit is None else f(limit * (1 + near))
    if below < 1 + 1e-9 and above > 1 - 1e-9:
        return None
    limit = limit or tried
    wide = f(0.98 * limit), f(1.02 * limit)
    true = brentq(lambda v: f(v) - 1, 0.98 * limit, 1.02 * limit) if wide[0] < 1 < wide[1] else None
    return f"growth {below!r} at {top!r}, {above!r} just above, {wide} at 0.98 and 1.02 of it; true limit {true!r}"

def random_advice(rng):
    """A loop that is stable without imperfections and not too large, and the advice for it."""
    while True:
        try:
            p, loop, keys, stated = random_loop(rng)
            advice = libration.advise(*loop, **keys)
        except ValueError as error:                     # numpy.linalg.LinAlgError is one: there is no design
            if isinstance(error, np.linalg.LinAlgError) or "unstable without" in str(error) or "in transit" in str(error):
                continue
            raise
        a, b, c, d = (np.array(advice.controller_matrices[k], float) for k in "abcd")
        nm, (nu, ny) = len(a), d.shape
        return dict(p, ac=a.reshape(nm, nm), bc=b.reshape(nm, ny), cc=c.reshape(nu, nm), dc=d), stated, advice

def simulation_disagrees(p, kind, channel, size, rho):
    """What a simulation with a latency contradicts, or None.  Other modes decay in its first half."""
    late, periods = [np.zeros(p["b"].shape[1]), np.zeros(len(p["c"]))], int(np.clip(40 / max(abs(np.log(rho)), 1e-9), 400, 10000))
    late[kind == "output-latency"][int(channel[1:]) - 1] = size / p["period"]
    seen = simulate(p, periods, *late)
    agrees = abs(np.log(seen / rho)) < 0.2 * abs(np.log(rho)) + 4 / periods
    return None if agrees else f"growth {rho!r} at {size!r}, and {seen!r} in a simulation of {periods} periods"

def check(job):
    """(number of judged limits by kind, disagreements) of a plant."""
    seed, number = job
    try:
        p, stated, advice = random_advice(np.random.default_rng(job))
    except ValueError as error:
        return Counter(errors=1), [f"seed {seed} plant {number}: advise fails: {error}"]
    judged, wrong, moments = Counter(), [], stated["jitter"] or stated["loss"]
    name = f"seed {seed} plant {number} ({p['kind']}, {len(p['a'])} states, period {p['period']:.6g} s, {p['law']}, {p['missing']})"
    say = lambda kind, channel, limit, what: wrong.append(f"{name}: {kind} {channel or ''} limit {limit!r}: {what}") if what else None
    if "design" in p and not np.allclose(p["dc"], -p["design"], rtol=1e-6, atol=1e-8 * np.abs(p["design"]).max()):
        say("gain", None, p["dc"].tolist(), f"expected {(-p['design']).tolist()}")
    budgets = [(b["kind"], b.get("channel"), b["stable_up_to"], b["tried_up_to"], b.get("later_windows", [])) for b in advice.budgets]
    budgets += [("margin", None, advice.margin, advice.margin_tried_up_to, [])] * bool(advice.margin_tried_up_to)
    for kind, channel, limit, tried, later in budgets:
        f, near = growth_at(p, kind, channel, stated)
        points = 8 if kind == "margin" and moments else 50 if limit else 25
        jumps = np.arange(1, 21) * p["period"] if "latency" in kind and p["d"].any() else ()
        judged[kind + " of all" * ("latency" in kind and of_all(channel)) + ", none stated" * (limit is None)] += 1
        say(kind, channel, limit, judge(f, near, limit, min(tried, 1 - 1e-6) if kind == "loss" else tried, points, float(kind == "margin"), jumps))
        for window in later:
            judged[kind + ", later windows"] += 1
            start, end = window["from"], window["to"]       # without an end it reaches to the largest that was tried
            inside = [f(v) for v in np.linspace(start * (1 + near), (end or 160 * p["period"]) * (1 - near), 20)]
            outside = [f(v) for v in (start * (1 - near), *([end * (1 + near)] if end else []))]
            if max(inside) > 1 + 1e-9 or min(outside) < 1 - 1e-9:
                say(kind, channel, limit, f"window {window}: largest growth inside {max(inside)!r}, growth just outside {outside}")
        if number % 10 == 0 and limit and "latency" in kind and not of_all(channel) and not judged["simulated"]:
            judged["simulated"] = 2
            for size in (0.98 * limit, 1.02 * limit):
                say(kind, channel, limit, simulation_disagrees(p, kind, channel, size, f(size)))
    judged["growth"], true = 1, np.log(growth(p, **stated)) * (1 if moments else 2)
    if abs(true - advice.growth) > 1e-7 * max(1, abs(true)):
        say("growth", None, advice.growth, f"growth {true!r} for {stated}")
    return judged, wrong

def main():
    ap = argparse.ArgumentParser(description="judge the stability limits of libration.advise")
    for name, default, meaning in (("count", 200, "number of plants"), ("seed", 1, None), ("plant", None, "judge this plant of the seed only")):
        ap.add_argument(f"--{name}", type=int, default=default, help=meaning)
    o = ap.parse_args()
    numbers, judged, wrong = range(o.count) if o.plant is None else [o.plant], Counter(), 0
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        for counts, lines in pool.imap_unordered(check, [(o.seed, k) for k in numbers]):
            judged, wrong = judged + counts, wrong + len(lines)
            for line in lines:
                print(line, flush=True)
    print(f"{len(numbers)} plants; judged: " + ", ".join(f"{k} {v}" for k, v in sorted(judged.items())) + f"; {wrong} disagreements")
    return 1 if wrong else 0

if __name__ == "__main__":
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")    # of the processes that it starts
    sys.exit(main())
