#!/usr/bin/env python3
"""Makes crates/libration-advise/tests/reference/redesigns.json (--seed 1): controllers of least cost for loops with latency,
jitter and loss, found by two programs that know only the definition of the loop in linear_loop_reference.py.

  * WITHOUT jitter and loss: the plant with all commands and measurements under way, built here from matrix exponentials of block
    matrices (C. F. Van Loan, 1978), and SciPy's solve_discrete_are for the regulator and for the filter. The answer has the cost
    and the first Markov parameters of the controller, D, CB, CAB, ..., which do not depend on its coordinates.
  * WITH jitter and loss: no theory at all. A general minimiser (BFGS) changes all entries of A, B, C and D of a controller and
    asks linear_loop_reference.py for the cost. The answer has the least cost that it finds.
"""
import argparse, json, sys
import numpy as np
from scipy.linalg import block_diag, expm, solve_discrete_are
from scipy.optimize import minimize
import linear_loop_reference as loops

def integrals(p, h):
    """Of h seconds with a held command: the step, the covariance of the noise, the cost form and the cost of the noise."""
    A, B, n, nu = p["a"], p["b"], *p["b"].shape
    N = n + nu
    F = np.block([[A, B], [np.zeros((nu, N))]])
    Q, W = block_diag(p["qx"], p["qu"]), block_diag(p["g"] @ p["g"].T, np.zeros((nu, nu)))
    zero = np.zeros((N, N))
    E = expm(np.block([[-F.T, Q], [zero, F]]) * h)          # cost
    step = E[N:, N:]
    form = step.T @ E[:N, N:]
    noise = expm(np.block([[F, W], [zero, -F.T]]) * h)[:N, N:] @ step.T
    nodes, weights = np.polynomial.legendre.leggauss(24)
    constant = 0.0
    for s, w in zip(h * (nodes + 1) / 2, weights * h / 2):
        e = expm(F * s)
        constant += w * (h - s) * np.trace(Q @ e @ W @ e.T)
    return step, noise, form, constant

def augmented(p):
    """F, G, H, W, V and the cost form of (z, u), with z = plant, the commands before this one, the samples that are under way."""
    n, nu = p["b"].shape
    ny, h = len(p["c"]), p["period"]
    whole = lambda v: int(np.floor(v + 1e-9))
    S, R = [whole(v) for v in p["input_latency"]], [whole(v) for v in p["output_latency"]]
    g = [v - s for v, s in zip(p["input_latency"], S)]
    f = [v - r for v, r in zip(p["output_latency"], R)]
    at = n
    commands, samples = [], []
    for s in S:                                             # u_{k-1} .. u_{k-s-1}
        commands.append(list(range(at, at + s + 1)))
        at += s + 1
    for r, part in zip(R, f):
        samples.append(list(range(at, at + r + (part > 1e-9))))
        at += r + (part > 1e-9)
    size, us = at, list(range(at, at + nu))
    total = size + nu
    unit = np.eye(total)
    row = lambda i, back: unit[us[i]] if back == 0 else unit[commands[i][back - 1]]
    acting = np.array([row(i, S[i] + 1) for i in range(nu)])    # before its takeover in this period
    X, noise = unit[:n].copy(), np.zeros((n, n))
    taken = [None] * ny                                     # samples of this period: rows, and covariance with x and each other
    cross, own = np.zeros((ny, n)), np.zeros((ny, ny))
    cost, constant = np.zeros((total, total)), 0.0
    events = sorted({0.0, 1.0} | {round(x, 12) for x in g} | {round(1 - x, 12) for x in f if x > 1e-9})
    for k, phase in enumerate(events):
        for j in range(ny):
            if abs((1 - f[j] if f[j] > 1e-9 else 0.0) - phase) < 1e-9:
                taken[j] = p["c"][j] @ X + p["d"][j] @ acting
                cross[j] = p["c"][j] @ noise
                own[j, :] = own[:, j] = cross @ p["c"][j]
                own[j, j] = p["c"][j] @ noise @ p["c"][j] + p["output_noise"][j]
        for i in range(nu):
            if abs(g[i] - phase) < 1e-9:
                acting[i] = row(i, S[i])
        if k + 1 == len(events):
            break
        step, added, form, alone = integrals(p, (events[k + 1] - phase) * h)
        both = np.vstack([X, acting])
        cost += both.T @ form @ both
        constant += alone + np.trace(form[:n, :n] @ noise)
        X = step[:n] @ both
        noise = step[:n, :n] @ noise @ step[:n, :n].T + added[:n, :n]
        cross = cross @ step[:n, :n].T
    next_, W, H = np.zeros((size, total)), np.zeros((size, size)), np.zeros((ny, total))
    next_[:n], W[:n, :n] = X, noise
    V = np.zeros((ny, ny))
    for i in range(nu):
        for b, place in enumerate(commands[i]):
            next_[place] = row(i, b)
    for j in range(ny):
        if not samples[j]:
            H[j], V[j, j] = taken[j], p["output_noise"][j]
            continue
        H[j] = unit[samples[j][-1]]
        next_[samples[j][0]] = taken[j]
        for b, place in enumerate(samples[j][1:]):
            next_[place] = unit[samples[j][b]]
        W[samples[j][0], :n] = W[:n, samples[j][0]] = cross[j]
        for k in range(ny):
            if samples[k]:
                W[samples[j][0], samples[k][0]] = own[j, k]
    return next_[:, :size], next_[:, size:], H[:, :size], W, V, cost, constant

def designed(p, count=12):
    """The cost per second, the Markov parameters and the matrices of the LQG controller."""
    F, G, H, W, V, cost, constant = augmented(p)
    size, m = G.shape
    Q, N, R = cost[:size, :size], cost[:size, size:], cost[size:, size:]
    S = solve_discrete_are(F, G, Q, R, s=N)
    L = np.linalg.solve(R + G.T @ S @ G, G.T @ S @ F + N.T)
    M = solve_discrete_are(F.T, H.T, W, V)
    innovation = H @ M @ H.T + V
    K = np.linalg.solve(innovation, H @ M).T
    for X in (F - G @ L, F - F @ K @ H):
        assert max(abs(np.linalg.eigvals(X))) < 1 - 1e-6
    # The cost of the regulator with known states, and what the error of the estimate adds.
    P = M - K @ innovation @ K.T
    least = (np.trace(S @ W) + np.trace(L.T @ (R + G.T @ S @ G) @ L @ P) + constant) / p["period"]
    T = np.eye(size) - K @ H
    step = F - G @ L
    a, b, c, d = controller = step @ T, step @ K, -L @ T, -L @ K
    markov, power = [d], b
    for _ in range(count - 1):
        markov.append(c @ power)
        power = a @ power
    return least, [x.tolist() for x in markov], controller

def plant(rng, n, nu, ny, direct):
    A, B = loops.random_plant(rng, n, nu, False)
    speed = 10 ** rng.uniform(-1, 1)
    latency = lambda most: float(rng.choice([0.0, 1.0, rng.uniform(0, most)]))
    half = rng.standard_normal((n, n)) * 0.7
    return dict(a=A * speed, b=B * speed, c=rng.standard_normal((ny, n)),
                d=0.2 * rng.standard_normal((ny, nu)) * direct,
                g=rng.standard_normal((n, int(rng.integers(1, 3)))) * np.sqrt(speed),
                period=float(rng.uniform(.1, .4) / speed), law="gaussian", jitter=0.0, skew=0.0, loss=0.0,
                qx=half @ half.T + 0.1 * np.eye(n), qu=np.diag(rng.uniform(.1, 2, nu)),
                output_noise=10 ** rng.uniform(-3, -.5, ny), input_latency=[latency(2.6) for _ in range(nu)],
                output_latency=[latency(1.6) for _ in range(ny)])

def minimised(p, start):
    """The least cost that a minimiser finds from the matrices of a controller, and the cost of that controller."""
    shapes = [x.shape for x in start]
    cuts = np.cumsum([a * b for a, b in shapes])[:-1]
    flat = np.concatenate([x.ravel() for x in start])
    known, flow = {}, loops.flow                            # the plant does not change
    def cost(v):
        q = dict(p, **{k: x.reshape(s) for k, x, s in zip(("ac", "bc", "cc", "dc"), np.split(v, cuts), shapes)})
        found = loops.solve_numbered(q, 16)[2]
        return 1e6 if found is None or found <= 0 else found
    loops.flow = lambda q, d, nodes=10: known[d] if d in known else known.setdefault(d, flow(q, d, nodes))
    try:
        best = flat
        for _ in range(4):
            found = minimize(lambda v: np.log(cost(v)), best, method="BFGS", options=dict(gtol=1e-8))
            better, best = cost(found.x) < cost(best) * (1 - 1e-9), found.x
            if not better:
                break
        return cost(best), cost(flat)
    finally:
        loops.flow = flow

def to_json(p):
    names = dict(a="a", b="b", c="c", d="d", g="g", state_weights="qx", input_weights="qu", output_noise="output_noise")
    same = ("period", "input_latency", "output_latency", "law", "jitter", "skew", "loss", "cost", "markov")
    return dict({k: p[v].tolist() for k, v in names.items()}, **{k: p[k] for k in same if k in p})

def main(seed):
    rng, even, drawn = np.random.default_rng(seed), [], []
    while len(even) < 12:
        n = int(rng.integers(1, 6))
        nu, ny = (int(rng.integers(1, min(3, n) + 1)) for _ in "ab")
        p = plant(rng, n, nu, ny, len(even) % 4 == 3)
        try:
            p["cost"], p["markov"], _ = designed(p)
        except (np.linalg.LinAlgError, AssertionError):
            continue
        even.append(p)
    # With jitter of at most 0.17, so that the program's law of periods, which is not clipped at zero, is that of the loops.
    for n, late, early, jitter, loss in [(1, 0.5, 0.0, 0.15, 0.0), (1, 0.5, 0.0, 0.0, 0.2), (1, 1.0, 0.35, 0.12, 0.1)]:
        while True:
            p = plant(rng, n, 1, 1, False)
            p.update(input_latency=[late], output_latency=[early])
            try:
                start = designed(p)[2]
            except (np.linalg.LinAlgError, AssertionError):
                continue
            p.update(jitter=jitter, loss=loss)
            p["cost"], before = minimised(p, start)
            if before < 1e5 and p["cost"] < 0.99999 * before:
                break
        print(f"n={n} jitter={jitter} loss={loss}: {before} -> {p['cost']}", file=sys.stderr, flush=True)
        drawn.append(p)
    return dict(even=[to_json(p) for p in even], drawn=[to_json(p) for p in drawn])

if __name__ == "__main__":
    ap = argparse.ArgumentParser(description="reference results for controllers of least cost")
    ap.add_argument("--seed", type=int, default=1)
    print(json.dumps(main(ap.parse_args().seed)))
