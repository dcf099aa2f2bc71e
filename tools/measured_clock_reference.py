#!/usr/bin/env python3
"""Makes crates/libration-advise/tests/reference/measured_clock.json (--count 8 --seed 1): controllers that measure the periods.

Plant, periods, latencies and losses are those of linear_loop_reference.py.  At t_k the controller knows the length h of the period
that has just passed:

PID   slope <- (filter slope - kd (y - last)) / (filter + h),  last <- y,  u = -kp y + sum + slope,  sum <- sum - ki h y.
LQG   xe <- Phi(h) xe + Gam(h) u,  xe <- xe + L (y - C xe - D u),  u <- -K xe, with K and L of the nominal period.

A stage is a motion of length h and then the controller at its end, so that stages are independent.

usage: measured_clock_reference.py --count N --seed S     (JSON cases)
"""
import argparse, json, sys
import numpy as np
from scipy.linalg import solve_discrete_are
from linear_loop_reference import TICKS, Model, flow, over_period, period_map, radius, random_plant, ticks

def control(M, p, h, y, noise):
    """The command, as rows over the state and over the measurement noises."""
    rows = M.rows
    if "kp" in p:
        f = p["filter"]
        slope = (f * rows["slope"] - p["kd"] * (y - rows["last"])) / (f + h)
        slope_noise = -p["kd"] * noise / (f + h)
        M.put("slope", slope, slope_noise)
        M.put("last", y, noise)
        M.put("sum", rows["sum"] - p["ki"] * h * y, -p["ki"] * h * noise)
        return -p["kp"] * y + rows["sum"] + slope, -p["kp"] * noise + slope_noise
    phi, gam, _, _, _ = flow(p, h)
    xe = phi @ rows["xe"] + gam @ rows["u"]
    xe = xe + p["l"] @ (y - p["c"] @ xe - p["d"] @ rows["u"])
    u, u_noise = -p["k"] @ xe, -p["k"] @ p["l"] @ noise
    M.put("xe", xe, p["l"] @ noise)
    M.put("u", u, u_noise)
    return u, u_noise

def stage_ops(p, h, lost):
    si = [divmod(v, TICKS) for v in ticks(p["input_latency"])]
    ro = [divmod(v, TICKS) for v in ticks(p["output_latency"])]
    memory = dict(slope=1, last=1, sum=1) if "kp" in p else dict(xe=len(p["a"]), u=p["b"].shape[1])
    M = Model(p, **memory, **{f"i{i}": s + 1 for i, (s, g) in enumerate(si)},
              **{f"o{j}": r + (f > 0) for j, (r, f) in enumerate(ro)})
    ops, run = [], M.flow(h / TICKS)
    for q in range(TICKS):
        M.begin()
        for j, (r, f) in enumerate(ro):                      # measurement before the takeover
            if f > 0 and q == TICKS - f:
                M.shift(f"o{j}", M.y[j], np.eye(len(ro))[j])
        for i, (s, g) in enumerate(si):
            if g == q and not lost:
                M.put("act", M.rows[f"i{i}"][-1], at=i)
        ops += [M.end(), run]
    M.begin()
    fresh = np.diag([float(r + f == 0) for r, f in ro])
    yhat = np.array([M.rows[f"o{j}"][-1] if r + f else M.y[j] for j, (r, f) in enumerate(ro)])
    for j, (r, f) in enumerate(ro):
        if f == 0 and r > 0:
            M.shift(f"o{j}", M.y[j], np.eye(len(ro))[j])
    u, u_noise = control(M, p, h, yhat, fresh)
    for i in range(len(si)):
        M.shift(f"i{i}", u[i], u_noise[i])
    return ops + [M.end()]

def solve(p, nodes=40):
    T, gauss = p["period"] * (1 + p["skew"]), p["law"] == "gaussian"
    x, w = (np.polynomial.hermite.hermgauss if gauss else np.polynomial.legendre.leggauss)(nodes)
    x, w = (x * (2 if gauss else 3) ** .5 * p["jitter"], w / w.sum())
    branches, K, N = [], 0.0, 0.0
    for eps, w in zip(x, w):
        for lost, q in ((False, w * (1 - p["loss"])), (True, w * p["loss"])):
            if q > 0:
                ops = stage_ops(p, T * (1 + eps), lost)
                M1, N1 = period_map(ops)
                K, N = K + q * np.kron(M1, M1), N + q * N1
                branches.append((q, ops))
    rho = radius(period_map(stage_ops(p, T, False))[0])
    growth = float(np.log(radius(K)))
    if growth >= 0:
        return rho, growth, None, None
    P = np.linalg.solve(np.eye(len(K)) - K, N.ravel()).reshape(N.shape)
    cost = sum(q * over_period(ops, (P + P.T) / 2)[2] for q, ops in branches) / T
    return rho, growth, float(cost), np.sqrt(np.diag(P)[:len(p["a"])]).tolist()

def random_loop(rng, number):
    pid = number % 2 == 0
    n = int(rng.integers(2, 4))
    a, b = random_plant(rng, n, 1, pid)
    c = rng.standard_normal((1, n))
    half = rng.standard_normal((n, n)) * 0.7
    latency = lambda: 0.0 if rng.random() < .3 else int(rng.integers(1, 30)) / TICKS
    p = dict(a=a, b=b, c=c, d=np.zeros((1, 1)), g=0.5 * rng.standard_normal((n, 2)), ac=np.zeros((0, 0)),
             period=float(rng.uniform(.1, .5)), law=str(rng.choice(["gaussian", "uniform"])),
             jitter=float(rng.uniform(.03, .1)), skew=float(rng.choice([0, 0.05, -0.03])),
             loss=float(rng.choice([0.0, 0.0, 0.2])), qx=half @ half.T + 0.1 * np.eye(n),
             qu=np.diag(rng.uniform(.1, 2, 1)), output_noise=10 ** rng.uniform(-3, -1, 1),
             input_latency=[latency()], output_latency=[latency()])
    if not pid and rng.random() < .5:
        p["d"] = 0.2 * rng.standard_normal((1, 1))
    T = p["period"]
    if pid:
        static = (-c @ np.linalg.solve(a, b))[0, 0]
        kp, ki, kd = rng.uniform(.2, .8) / static, rng.uniform(.2, .6) / static, rng.uniform(0, .2) / static
        p.update(kp=float(kp), ki=float(ki), kd=float(kd), filter=float(rng.choice([0.0, 0.5 * T])))
        if min(kp, ki, kd) < 0:
            return None
    else:
        phi, gam, w, _, _ = flow(p, T, nodes=20)
        x = solve_discrete_are(phi, gam, p["qx"] * T, p["qu"] * T)
        p["k"] = np.linalg.solve(p["qu"] * T + gam.T @ x @ gam, gam.T @ x @ phi)
        v = np.diag(np.maximum(p["output_noise"], 1e-2))
        x = solve_discrete_are(phi.T, c.T, w + 1e-3 * np.eye(n) * np.trace(w), v)
        p["l"] = np.linalg.solve(c @ x @ c.T + v, c @ x).T
    if len(stage_ops(p, T, False)[0][0]) > 14:
        return None
    return p if radius(period_map(stage_ops(p, T, False))[0]) < 1.1 else None

def cases(count, seed):
    rng, found = np.random.default_rng(seed), []
    while len(found) < count:
        try:
            p = random_loop(rng, len(found))
        except np.linalg.LinAlgError:
            continue
        if p is None:
            continue
        p.update(zip(("spectral_radius", "growth", "cost", "deviations"), solve(p)))
        if abs(p["growth"]) > 0.01:
            found.append(p)
    return found

def to_json(p):
    names = dict(a="a", b="b", c="c", d="d", g="g", state_weights="qx", input_weights="qu",
                 output_noise="output_noise", gain="k", estimator="l")
    same = ("period", "input_latency", "output_latency", "law", "jitter", "skew", "loss", "spectral_radius", "growth",
            "cost", "deviations", "kp", "ki", "kd", "filter")
    return dict({k: p[v].tolist() for k, v in names.items() if v in p}, **{k: p[k] for k in same if k in p})

if __name__ == "__main__":
    ap = argparse.ArgumentParser(description="reference results for controllers that measure the periods")
    for name, default in (("--count", 8), ("--seed", 1)):
        ap.add_argument(name, type=int, default=default)
    o = ap.parse_args()
    json.dump({"cases": [to_json(p) for p in cases(o.count, o.seed)]}, sys.stdout)
    print()
