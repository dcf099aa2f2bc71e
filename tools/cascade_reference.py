#!/usr/bin/env python3
"""Makes crates/libration-advise/tests/reference/cascades.json (--count 24 --seed 1): loops whose controllers filter their samples, or are cascades.

Plant, periods, latencies and losses are those of linear_loop_reference.py.  At t_k, the beginning of period k, the controller does:

Output filters   in their order, each on the sample y of its output, with the samples it has had before:
                 average  (y_k + ... + y_{k-n+1}) / n        difference  (y_k - y_{k-1}) / T, T the nominal period.
Cascade          outer, if k is a multiple of `every`:  r = Co mo + Do y,  mo <- Ao mo + Bo y.  This r acts from period
                 k + outer_latency until the next one does.
                 inner, if k is a multiple of `inner_every`:  u = Ci mi + Di [y; r],  mi <- Ai mi + Bi [y; r].
                 Otherwise u is the one of the period before.
Input filters    in their order, each on the command of its input, as those of the outputs.

Registers hold exactly the numbers named above.  A loop repeats after `round` periods; its second moments are carried through all of
them.  Growth is per period, cost per second, deviations are the rms over the periods of a round.

usage: cascade_reference.py --count N --seed S     (JSON cases)
"""
import argparse, json, sys
import numpy as np
from linear_loop_reference import TICKS, Model, over_period, period_map, radius, random_case, ticks

def filter_cells(filters, side):
    return {f"{side}f{number}": size - 1 for number, (_, _, size) in enumerate(filters)}

def registers(p):
    """The numbers that the controller keeps from period to period."""
    cells = filter_cells(p["output_filters"], "o") | filter_cells(p["input_filters"], "i")
    if "every" in p:
        nr, nu = len(p["outer"]["d"]), len(p["inner"]["d"])
        cells |= dict(mi=len(p["inner"]["a"]), mo=len(p["outer"]["a"]), r=nr, u=nu)
        cells |= {f"next{age}": nr for age in range(1, p["outer_latency"] + 1)}    # r computed `age` periods ago
    else:
        cells["mc"] = len(p["own"]["a"])
    return cells

def run_filters(M, p, side, value, noise):
    """Each filter in its turn, on rows over the state and over the new measurement noises."""
    for number, (channel, kind, size) in enumerate(p[side + "_filters"]):
        name = f"{side[0]}f{number}"
        before = M.rows[name]
        if size > 1:
            M.put(name, np.vstack([value[channel], before[:-1]]))
            M.Ev[M.part[name].start] = noise[channel]
        if kind == "average":
            value[channel], noise[channel] = (value[channel] + before.sum(0)) / size, noise[channel] / size
        else:
            value[channel], noise[channel] = (value[channel] - before[0]) / p["period"], noise[channel] / p["period"]

def control(M, p, k, value, noise):
    """The commands of period k, as rows over the state and over the new measurement noises."""
    value, noise = value.copy(), noise.copy()
    run_filters(M, p, "output", value, noise)
    rows = M.rows
    if "every" not in p:
        own = p["own"]
        M.put("mc", own["a"] @ rows["mc"] + own["b"] @ value, own["b"] @ noise)
        u, u_noise = own["c"] @ rows["mc"] + own["d"] @ value, own["d"] @ noise
    else:
        o, i, late = p["outer"], p["inner"], p["outer_latency"]
        fresh, fresh_noise = o["c"] @ rows["mo"] + o["d"] @ value, o["d"] @ noise
        if k % p["every"] == 0:
            M.put("mo", o["a"] @ rows["mo"] + o["b"] @ value, o["b"] @ noise)
        # every period each reference grows older; those that are not of a run are never used
        for age in range(late, 0, -1):
            M.put(f"next{age}", fresh if age == 1 else rows[f"next{age - 1}"], fresh_noise if age == 1 else 0.0)
        r, r_noise = rows["r"], 0.0 * fresh_noise
        if (k - late) % p["every"] == 0:
            r, r_noise = (fresh, fresh_noise) if late == 0 else (rows[f"next{late}"], r_noise)
        M.put("r", r, r_noise)
        seen, seen_noise = np.vstack([value, r]), np.vstack([noise, r_noise])
        u, u_noise = rows["u"], np.zeros((len(rows["u"]), len(noise)))
        if k % p["inner_every"] == 0:
            u, u_noise = i["c"] @ rows["mi"] + i["d"] @ seen, i["d"] @ seen_noise
            M.put("mi", i["a"] @ rows["mi"] + i["b"] @ seen, i["b"] @ seen_noise)
        M.put("u", u, u_noise)
    u, u_noise = np.array(u), np.array(u_noise)
    run_filters(M, p, "input", u, u_noise)
    return u, u_noise

def round_of(p):
    return int(np.lcm(p["every"], p["inner_every"])) if "every" in p else 1

def delay_line_ops(p, h, k):
    """The steps of period k; every channel has a delay line of 20*latency cells."""
    nu, lin, lout = p["b"].shape[1], ticks(p["input_latency"]), ticks(p["output_latency"])
    M = Model(p, hold=nu, **registers(p), **{f"i{i}": n for i, n in enumerate(lin)},
              **{f"o{j}": n for j, n in enumerate(lout)})

    def tick(controller_runs):
        M.begin()
        yhat = np.array([M.rows[f"o{j}"][-1] if n else M.y[j] for j, n in enumerate(lout)])
        hold, hold_noise = M.rows["hold"], np.zeros((nu, len(lout)))
        if controller_runs:
            hold, hold_noise = control(M, p, k, yhat, np.eye(len(lout)))
            M.put("hold", hold, hold_noise)
        for j, n in enumerate(lout):
            if n:
                M.shift(f"o{j}", M.y[j])
        for i, n in enumerate(lin):
            if n:
                M.put("act", M.rows[f"i{i}"][-1], at=i)
                M.shift(f"i{i}", hold[i], hold_noise[i])
            else:
                M.put("act", hold[i], hold_noise[i], at=i)
        return M.end()

    run = M.flow(h / TICKS)
    return [tick(True), run] + [tick(False), run] * (TICKS - 1)

def numbered_ops(p, h, lost, k):
    """The steps of period k, commands and samples kept per period."""
    si = [divmod(v, TICKS) for v in ticks(p["input_latency"])]
    ro = [divmod(v, TICKS) for v in ticks(p["output_latency"])]
    M = Model(p, **registers(p), **{f"i{i}": s + 1 for i, (s, g) in enumerate(si)},
              **{f"o{j}": r + (f > 0) for j, (r, f) in enumerate(ro)})
    M.begin()
    fresh = np.diag([float(r + f == 0) for r, f in ro])      # noise of samples used at once
    yhat = np.array([M.rows[f"o{j}"][-1] if r + f else M.y[j] for j, (r, f) in enumerate(ro)])
    for j, (r, f) in enumerate(ro):
        if f == 0 and r > 0:
            M.shift(f"o{j}", M.y[j], np.eye(len(ro))[j])
    u, u_noise = control(M, p, k, yhat, fresh)
    for i in range(len(si)):
        M.shift(f"i{i}", u[i], u_noise[i])
    ops, run = [M.end()], M.flow(h / TICKS)
    for q in range(TICKS):
        M.begin()
        for j, (r, f) in enumerate(ro):                      # measurement before the takeover
            if f > 0 and q == TICKS - f:
                M.shift(f"o{j}", M.y[j], np.eye(len(ro))[j])
        for i, (s, g) in enumerate(si):
            if g == q and not lost:
                M.put("act", M.rows[f"i{i}"][-1], at=i)
        ops += [M.end(), run]
    return ops

def round_radius(p, model=numbered_ops, **change):
    """Spectral radius of a round without jitter and losses."""
    q = dict(p, **change)
    h, X = q["period"] * (1 + q["skew"]), None
    for k in range(round_of(q)):
        step = period_map(model(q, h, False, k) if model is numbered_ops else model(q, h, k))[0]
        X = step if X is None else step @ X
    return radius(X)

def solve_delay_lines(p):
    h, count = p["period"] * (1 + p["skew"]), round_of(p)
    rounds = [op for k in range(count) for op in delay_line_ops(p, h, k)]
    X, P = period_map(rounds)
    rho = radius(X)
    growth = 2 * float(np.log(rho)) / count
    if rho >= 1:
        return rho, growth, None, None
    for _ in range(60):
        step = X @ P @ X.T
        P, X = P + step, X @ X
        if np.linalg.norm(step) <= 1e-18 * np.linalg.norm(P):
            break
    cost, squares = 0.0, 0.0
    for k in range(count):
        squares = squares + np.diag(P)[:len(p["a"])]
        ops = delay_line_ops(p, h, k)
        cost += over_period(ops, P)[2]
        P = over_period(ops, P)[1]
    return rho, growth, float(cost) / h / count, np.sqrt(squares / count).tolist()

def solve_numbered(p, nodes=40):
    """Averaged Kronecker squares of each period, one after the other."""
    T, count = p["period"] * (1 + p["skew"]), round_of(p)
    x, w = (np.polynomial.hermite.hermgauss if p["law"] == "gaussian" else np.polynomial.legendre.leggauss)(nodes)
    x, w = (x * (2 if p["law"] == "gaussian" else 3) ** .5 * p["jitter"], w / w.sum()) if p["jitter"] else ([0.0], [1.0])
    periods, whole, inflow = [], None, None
    for k in range(count):
        branches, K, N = [], 0.0, 0.0
        for eps, weight in zip(x, w):
            for lost, q in ((False, weight * (1 - p["loss"])), (True, weight * p["loss"])):
                if q > 0:
                    ops = numbered_ops(p, T * (1 + eps), lost, k)
                    M1, N1 = period_map(ops)
                    K, N = K + q * np.kron(M1, M1), N + q * N1
                    branches.append((q, ops))
        periods.append((branches, K, N))
        whole = K if whole is None else K @ whole
        inflow = N.ravel() if inflow is None else K @ inflow + N.ravel()
    rho = round_radius(p)
    growth = float(np.log(radius(whole))) / count
    if growth >= 0:
        return rho, growth, None, None
    P = np.linalg.solve(np.eye(len(whole)) - whole, inflow).reshape(N.shape)
    cost, squares = 0.0, 0.0
    for branches, K, N in periods:
        P = (P + P.T) / 2
        squares = squares + np.diag(P)[:len(p["a"])]
        cost += sum(q * over_period(ops, P)[2] for q, ops in branches)
        P = (K @ P.ravel()).reshape(P.shape) + N
    return rho, growth, float(cost) / T / count, np.sqrt(squares / count).tolist()

def solve(p):
    answer = solve_delay_lines(p)
    assert abs(answer[0] - round_radius(p)) < 1e-6 * max(answer[0], 1e-3)     # two models, one spectral radius
    if p["jitter"] or p["loss"]:
        answer = solve_numbered(p)
    return dict(zip(("spectral_radius", "growth", "cost", "deviations"), answer))

# ---------------------------------------------------------------- random cases
def random_filters(rng, channels, most):
    """Averages on some channels."""
    return [(int(j), "average", int(rng.integers(2, 5))) for j in range(channels) if rng.random() < 0.6][:most]

def random_loop(rng, number):
    shaky, cascade = number % 3 == 1, number % 2 == 1
    p = random_case(rng, shaky)
    if p is None:
        return None
    n, nu, ny = len(p["a"]), p["b"].shape[1], len(p["c"])
    own = {key: np.asarray(p.pop(key + "c"), float) for key in "abcd"}
    p["ac"] = np.zeros((0, 0))                    # the controller is not that of the model
    p.update(input_filters=[], output_filters=[])
    if cascade:
        nr = int(rng.integers(1, 3))
        follow = lambda rows: 0.4 * rng.standard_normal((rows, nr))
        size = int(rng.integers(0, 2))
        p["inner"] = dict(own, b=np.hstack([own["b"], follow(len(own["a"]))]), d=np.hstack([own["d"], follow(nu)]))
        p["outer"] = dict(a=0.6 * np.eye(size), b=0.3 * rng.standard_normal((size, ny)),
                          c=0.3 * rng.standard_normal((nr, size)), d=0.3 * rng.standard_normal((nr, ny)))
        p["inner_every"], p["every"] = ((1, int(rng.integers(2, 7))) if rng.random() < .7 else (2, int(rng.choice([3, 4]))))
        p["outer_latency"] = int(rng.integers(0, p["every"] + 1)) if rng.random() < .5 else 0
        if rng.random() < .4:
            p["output_filters"] = random_filters(rng, ny, 1)
    else:
        # one more output: the first once more, which the controller reads as its rate
        p["c"], p["d"] = np.vstack([p["c"], p["c"][:1]]), np.vstack([p["d"], p["d"][:1]])
        p["output_noise"] = np.append(p["output_noise"], 1e-6)
        p["output_latency"] = p["output_latency"] + [p["output_latency"][0]]
        more = lambda rows: 0.05 * p["period"] * rng.standard_normal((rows, 1))
        own = dict(own, b=np.hstack([own["b"], more(len(own["a"]))]), d=np.hstack([own["d"], more(nu)]))
        p["own"] = own
        p["output_filters"] = random_filters(rng, ny, ny) + [(ny, "difference", 2)]
        if rng.random() < .5:
            p["output_filters"].append((ny, "average", 3))
        if rng.random() < .5:
            p["input_filters"] = random_filters(rng, nu, nu)
    size = len(period_map(numbered_ops(p, 1.0, False, 0))[0])
    if size > (13 if shaky else 40):
        return None                               # keeps the Kronecker square small
    count = round_of(p)
    ideal = round_radius(p, input_latency=[0.0] * nu, output_latency=[0.0] * len(p["c"]), skew=0.0)
    return p if ideal ** (1 / count) < 0.98 and round_radius(p) ** (1 / count) < 1.3 else None

def cases(count, seed):
    rng, found, unstable = np.random.default_rng(seed), [], 0
    while len(found) < count:
        try:
            p = random_loop(rng, len(found))
        except np.linalg.LinAlgError:
            continue
        if p is None:
            continue
        p.update(solve(p))
        bad = p["cost"] is None
        if abs(p["growth"]) < 0.005 or bad and 6 * unstable > len(found):
            continue
        unstable += bad
        found.append(p)
    return found

def to_json(p):
    names = dict(a="a", b="b", c="c", d="d", g="g", state_weights="qx", input_weights="qu",
                 output_noise="output_noise")
    same = ("period", "input_latency", "output_latency", "law", "jitter", "skew", "loss", "output_filters",
            "input_filters", "spectral_radius", "growth", "cost", "deviations")
    matrices = lambda own: {key: value.tolist() for key, value in own.items()}
    kind = dict(cascade=dict(inner=matrices(p["inner"]), outer=matrices(p["outer"]), every=p["every"],
                             inner_every=p["inner_every"], outer_latency=p["outer_latency"])) if "every" in p else \
        dict(controller=matrices(p["own"]))
    return dict({k: p[v].tolist() for k, v in names.items()}, **{k: p[k] for k in same}, **kind)

if __name__ == "__main__":
    ap = argparse.ArgumentParser(description="reference results for loops with filters and cascades")
    for name, default in (("--count", 12), ("--seed", 1)):
        ap.add_argument(name, type=int, default=default)
    o = ap.parse_args()
    json.dump({"cases": [to_json(p) for p in cases(o.count, o.seed)]}, sys.stdout)
    print()
