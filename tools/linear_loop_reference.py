#!/usr/bin/env python3
"""Makes crates/libration-advise/tests/reference/linear_loops.json (--count 60 --seed 1): sampled-data linear control loops with latency, jitter and loss.

Plant       x' = A x + B u + G w,  y = C x + D u,  w white noise of unit intensity.
Controller  runs at t_k:  u_k = Cc m_k + Dc yhat_k,  m_{k+1} = Ac m_k + Bc yhat_k.
Periods     h_k = T (1+skew) (1+eps_k), eps_k independent, Gaussian or uniform of given rms.
Latencies   are given in periods and are all multiples of 1/20, so every event falls on a grid
            of 20 ticks per period.  At a tick: measure first, then let commands take over.

Two unrelated models are used.
  * DELAY LINES (no jitter, no loss): every signal passes a plain shift register clocked at every
    tick.  Nothing in it knows about "whole" and "fractional" parts of a latency.
  * NUMBERED PERIODS (jitter and loss): commands and samples are kept per period as the definition
    numbers them; the second moments are averaged over eps (Gauss quadrature) and loss.
Where both apply they must agree.  --check adds an event-driven Monte Carlo simulation, which shares
no numerical code with them (power series instead of quadrature, histories instead of registers).

usage: linear_loop_reference.py [--check] --count N --seed S     (JSON cases, or self-verification)
"""
import argparse, json, sys
import numpy as np
from scipy.linalg import block_diag, expm, solve_discrete_are

TICKS = 20
ticks = lambda latency: [int(round(TICKS * v)) for v in latency]
radius = lambda M: float(np.max(np.abs(np.linalg.eigvals(M))))

def flow(p, d, nodes=10):
    """Plant over a time d with constant u.  Returns Phi, Gam (x' = Phi x + Gam u), the noise
    covariance W, and S, c such that the mean integral of the cost is trace(S E[xu xu^T]) + c.
    Gauss-Legendre over a short step; d may also be negative (analytic continuation)."""
    n, nu = p["b"].shape
    gen = np.block([[p["a"], p["b"]], [np.zeros((nu, n + nu))]])
    full = expm(gen * d)
    W, S, c = np.zeros((n, n)), np.zeros((n + nu, n + nu)), 0.0
    for s, w in zip(*np.polynomial.legendre.leggauss(nodes)):
        s, w = d * (s + 1) / 2, d * w / 2
        e = expm(gen * s)
        noise = e[:n, :n] @ p["g"] @ p["g"].T @ e[:n, :n].T
        W += w * noise
        S += w * e.T @ block_diag(p["qx"], p["qu"]) @ e
        c += w * (d - s) * np.trace(p["qx"] @ noise)    # order of the double integral swapped
    return full[:n, :n], full[:n, n:], W, S, c

class Model:
    """State vector with named parts, and the two kinds of steps on it.  A step is a tuple
    (F, N, S, c): z -> F z + noise of covariance N, gathering the cost trace(S E[z z^T]) + c."""
    def __init__(self, p, **registers):
        n, nu = p["b"].shape
        self.size, self.p, self.part = 0, p, {}
        for name, k in dict(x=n, m=len(p["ac"]), act=nu, **registers).items():
            self.part[name] = slice(self.size, self.size + k)
            self.size += k
        self.rows = {name: np.eye(self.size)[s] for name, s in self.part.items()}
        self.y = p["c"] @ self.rows["x"] + p["d"] @ self.rows["act"]    # with the command still acting

    def begin(self):    # an instantaneous step: E maps the old state, Ev the new measurement noises
        self.E, self.Ev = np.eye(self.size), np.zeros((self.size, len(self.p["c"])))

    def put(self, name, row, noise=0.0, at=None):
        s = self.part[name] if at is None else self.part[name].start + at
        self.E[s], self.Ev[s] = row, noise

    def shift(self, name, row, noise=0.0):    # move a register by one cell, new entry at its front
        self.put(name, np.vstack([row, self.rows[name][:-1]]))
        self.Ev[self.part[name].start] = noise

    def end(self):
        return self.E, self.Ev @ np.diag(self.p["output_noise"]) @ self.Ev.T, None, 0.0

    def flow(self, d):
        Phi, Gam, W, S, c = flow(self.p, d)
        F, zero, x, act = np.eye(self.size), np.zeros((self.size, self.size)), self.part["x"], self.part["act"]
        N, Sz, xu = zero.copy(), zero.copy(), np.r_[x, act]
        F[x, x], F[x, act], N[x, x], Sz[np.ix_(xu, xu)] = Phi, Gam, W, S
        return F, N, Sz, c

def delay_line_ops(p, h):
    """The steps of one period; every channel has a delay line of 20*latency cells."""
    nu, lin, lout = p["b"].shape[1], ticks(p["input_latency"]), ticks(p["output_latency"])
    M = Model(p, hold=nu, **{f"i{i}": k for i, k in enumerate(lin)}, **{f"o{j}": k for j, k in enumerate(lout)})

    def tick(controller_runs):
        M.begin()
        yhat = np.array([M.rows[f"o{j}"][-1] if k else M.y[j] for j, k in enumerate(lout)])
        if controller_runs:
            M.put("hold", p["cc"] @ M.rows["m"] + p["dc"] @ yhat, p["dc"])
            M.put("m", p["ac"] @ M.rows["m"] + p["bc"] @ yhat, p["bc"])
        hold, hold_noise = M.E[M.part["hold"]].copy(), M.Ev[M.part["hold"]].copy()
        for j, k in enumerate(lout):
            if k:
                M.shift(f"o{j}", M.y[j])
        for i, k in enumerate(lin):
            if k:
                M.put("act", M.rows[f"i{i}"][-1], at=i)
                M.shift(f"i{i}", hold[i], hold_noise[i])
            else:
                M.put("act", hold[i], hold_noise[i], at=i)
        return M.end()

    run = M.flow(h / TICKS)
    return [tick(True), run] + [tick(False), run] * (TICKS - 1)

def numbered_ops(p, h, lost):
    """The steps of one period, commands and samples kept per period.  Registers, newest first:
    input i: u_k .. u_{k-S};  output j: R samples if f=0, R+1 samples if f>0."""
    si = [divmod(v, TICKS) for v in ticks(p["input_latency"])]
    ro = [divmod(v, TICKS) for v in ticks(p["output_latency"])]
    M = Model(p, **{f"i{i}": s + 1 for i, (s, g) in enumerate(si)},
              **{f"o{j}": r + (f > 0) for j, (r, f) in enumerate(ro)})
    # t_k: samples without fractional latency, controller, new entries in the command registers
    M.begin()
    fresh = np.diag([float(r + f == 0) for r, f in ro])      # noise of samples used at once
    yhat = np.array([M.rows[f"o{j}"][-1] if r + f else M.y[j] for j, (r, f) in enumerate(ro)])
    for j, (r, f) in enumerate(ro):
        if f == 0 and r > 0:
            M.shift(f"o{j}", M.y[j], np.eye(len(ro))[j])
    M.put("m", p["ac"] @ M.rows["m"] + p["bc"] @ yhat, p["bc"] @ fresh)
    u, u_noise = p["cc"] @ M.rows["m"] + p["dc"] @ yhat, p["dc"] @ fresh
    for i in range(len(si)):
        M.shift(f"i{i}", u[i], u_noise[i])
    ops, run = [M.end()], M.flow(h / TICKS)
    for q in range(TICKS):
        M.begin()
        for j, (r, f) in enumerate(ro):                      # measurement before the takeover
            if f > 0 and q == TICKS - f:
                M.shift(f"o{j}", M.y[j], np.eye(len(ro))[j])
        for i, (s, g) in enumerate(si):
            if g == q and not lost:                          # the oldest entry is u_{k-S}
                M.put("act", M.rows[f"i{i}"][-1], at=i)
        ops += [M.end(), run]
    return ops

def over_period(ops, P):
    """(map M, covariance at the end, mean cost integral) for the covariance P at the start."""
    M, J = np.eye(len(P)), 0.0
    for F, N, S, c in ops:
        J += 0.0 if S is None else np.sum(S * P) + c
        M, P = F @ M, F @ P @ F.T + N
    return M, P, J

period_map = lambda ops: over_period(ops, 0.0 * ops[0][1])[:2]    # with the noise of one period

def nominal_radius(p, **change):
    q = dict(p, **change)
    return radius(period_map(numbered_ops(q, q["period"] * (1 + q["skew"]), False))[0])

def solve_delay_lines(p):
    """(spectral radius, growth, cost, deviations) without jitter and loss."""
    h = p["period"] * (1 + p["skew"])
    ops = delay_line_ops(p, h)
    X, P = period_map(ops)
    rho = radius(X)
    if rho >= 1:
        return rho, 2 * float(np.log(rho)), None, None
    for _ in range(60):                 # P = sum X^k N X^kT, doubling the number of terms
        step = X @ P @ X.T
        P, X = P + step, X @ X
        if np.linalg.norm(step) <= 1e-18 * np.linalg.norm(P):
            break
    return rho, 2 * float(np.log(rho)), over_period(ops, P)[2] / h, np.sqrt(np.diag(P)[:len(p["a"])]).tolist()

def solve_numbered(p, count=40):
    """(spectral radius, growth, cost, deviations) from averaged Kronecker squares."""
    T = p["period"] * (1 + p["skew"])
    gauss = p["law"] == "gaussian"
    x, w = (np.polynomial.hermite.hermgauss if gauss else np.polynomial.legendre.leggauss)(count)
    x, w = (x * (2 if gauss else 3) ** .5 * p["jitter"], w / w.sum()) if p["jitter"] else ([0.0], [1.0])
    branches, K, N = [], 0.0, 0.0
    for eps, w in zip(x, w):
        for lost, q in ((False, w * (1 - p["loss"])), (True, w * p["loss"])):
            if q > 0:
                ops = numbered_ops(p, T * (1 + eps), lost)
                M1, N1 = period_map(ops)
                K, N = K + q * np.kron(M1, M1), N + q * N1
                branches.append((q, ops))
    growth = float(np.log(radius(K)))
    if growth >= 0:
        return nominal_radius(p), growth, None, None
    P = np.linalg.solve(np.eye(len(K)) - K, N.ravel()).reshape(N.shape)
    cost = sum(q * over_period(ops, (P + P.T) / 2)[2] for q, ops in branches) / T
    return nominal_radius(p), growth, float(cost), np.sqrt(np.diag(P)[:len(p["a"])]).tolist()

def solve(p):
    rho = nominal_radius(p)
    answer = solve_delay_lines(p)
    assert abs(answer[0] - rho) < 1e-6 * rho            # two models, one spectral radius
    if p["jitter"] or p["loss"]:
        answer = solve_numbered(p)
    return dict(zip(("spectral_radius", "growth", "cost", "deviations"), answer))

def monte_carlo(p, rng, paths=400, periods=1500):
    """Event-driven simulation; (z-score of the cost, its relative standard error, z-scores of the
    variances at t_k) against the results stored in p."""
    A, B, C, D = p["a"], p["b"], p["c"], p["d"]
    n, nu, ny, nc = len(A), B.shape[1], len(C), len(p["ac"])
    terms = 40                                         # power series in time: Phi, Gam, W
    fi, gm, ws = [np.eye(n)], [np.zeros((n, nu)), B], [np.zeros((n, n)), p["g"] @ p["g"].T]
    for k in range(1, terms):
        fi.append(A @ fi[-1] / k)
        gm.append(A @ gm[-1] / (k + 1))
        ws.append((A @ ws[-1] + ws[-1] @ A.T) / (k + 1))
    s, r = np.round(p["input_latency"], 9), np.round(p["output_latency"], 9)
    S, R = np.floor(s).astype(int), np.floor(r).astype(int)
    g, f = np.round(s - S, 9), np.round(r - R, 9)
    normal = lambda *shape: rng.standard_normal((paths, *shape))
    apply = lambda M, v: np.einsum("pij,pj->pi", M, v)

    def advance(x, u, d):
        Phi, Gam, W = (np.tensordot(d[:, None] ** np.arange(terms), co[:terms], 1) for co in (fi, gm, ws))
        lam, vec = np.linalg.eigh(W)
        return apply(Phi, x) + apply(Gam, u) + apply(vec, np.sqrt(np.maximum(lam, 0)) * normal(n))

    # events inside a period, in order: kind 0 measure, 1 take over, 2 end of the period
    events = [(round(1 - f[j], 9), 0, j) for j in range(ny) if f[j] > 0]
    events = sorted(events + [(g[i], 1, i) for i in range(nu)]) + [(1.0, 2, 0)]
    x, m, act, commands, samples = np.zeros((paths, n)), np.zeros((paths, nc)), np.zeros((paths, nu)), {}, {}
    burn = 10 + int(np.ceil(-16 / p["growth"]))
    total, squares = np.zeros(paths), np.zeros((paths, n))
    measure = lambda j: x @ C[j] + act @ D[j] + np.sqrt(p["output_noise"][j]) * normal()
    for k in range(burn + periods):
        unit = normal() if p["law"] == "gaussian" else rng.uniform(-3**.5, 3**.5, paths)
        h = p["period"] * (1 + p["skew"]) * (1 + p["jitter"] * unit)
        arrives = rng.random(paths) >= p["loss"]
        yhat, squares = np.zeros((paths, ny)), squares + x ** 2 * (k >= burn)
        for j in range(ny):
            samples[j, k] = measure(j) if f[j] == 0 else None
            yhat[:, j] = samples.pop((j, k - R[j] - (f[j] > 0)), 0.0)
        commands[k] = m @ p["cc"].T + yhat @ p["dc"].T
        m = m @ p["ac"].T + yhat @ p["bc"].T
        # the cost is looked at once per period, at a uniformly random instant of the period
        look, now, seen = rng.random(paths), np.zeros(paths), np.zeros(paths)
        for phase, kind, c in events:
            here = (look >= now) & (look < phase)
            for target in (np.where(here, look, now), np.full(paths, phase)):
                if np.any(target > now):
                    x = advance(x, act, (target - now) * h)
                value = np.sum((x @ p["qx"]) * x, 1) + np.sum((act @ p["qu"]) * act, 1)
                seen, here, now = np.where(here, value, seen), False, target
            if kind == 0:
                samples[c, k] = measure(c)
            elif kind == 1 and k >= S[c]:
                act = act.copy()
                act[arrives, c] = commands[k - S[c]][arrives, c]
        total += h * (seen - p["cost"]) * (k >= burn)
    err = total.std(ddof=1) / np.sqrt(paths)
    z = (squares.mean(0) / periods - np.square(p["deviations"])) / (squares.std(0, ddof=1) / periods / paths**.5)
    return total.mean() / err, err / (periods * p["period"] * (1 + p["skew"])) / p["cost"], z

# ---------------------------------------------------------------- random cases
def random_plant(rng, n, nu, stable):
    """Block-triangular plant; at most one block that is not asymptotically stable."""
    blocks, wild = [], stable
    while (room := n - sum(map(len, blocks))) > 0:
        kind = int(rng.integers(0, 2) if wild or rng.random() < 0.3 else rng.integers(2, 7))
        if room == 1:
            kind = {1: 0, 3: 2, 5: 4, 6: 4}.get(kind, kind)
        w, z, q = rng.uniform(0.7, 2.5), rng.uniform(0.02, 0.5), rng.uniform(0.3, 2.0)
        blocks.append(np.array([[[-q]], [[0, 1], [-w * w, -2 * z * w]],           # lag, oscillator
                                [[0.5 * q]], [[0, 1], [-w * w, 0.5 * z * w]],     # unstable ones
                                [[0.0]], [[0.0, 1], [0, 0]], [[0, 1], [0, -q]]    # integrators, inertia
                                ][kind]))
        wild = wild or kind >= 2
    A, B, at = block_diag(*blocks), 0.3 * rng.standard_normal((n, nu)), 0
    for b in blocks:
        B[at + len(b) - 1] = rng.standard_normal(nu) + np.sign(rng.standard_normal(nu))
        if len(b) == 2 and rng.random() < 0.7:
            B[at] = 0
        A[at:at + len(b), at + len(b):] = 0.3 * rng.standard_normal((len(b), n - at - len(b)))
        at += len(b)
    if rng.random() < 0.5:
        Q = np.linalg.qr(rng.standard_normal((n, n)))[0] * rng.uniform(0.6, 1.6, n)
        A, B = np.linalg.solve(Q, A @ Q), np.linalg.solve(Q, B)
    return A, B

def random_controller(rng, kind, p):
    """Controller matrices Ac, Bc, Cc, Dc designed for the loop without latency."""
    A, B, C, D, T = p["a"], p["b"], p["c"], p["d"], p["period"]
    n, nu, ny = len(A), B.shape[1], len(C)
    Ad, Bd, W, _, _ = flow(p, T, nodes=20)
    none = np.zeros((nu, ny))
    if kind == "pid":
        k, w = min(nu, ny), p["speed"]       # gains per channel in units of the plant's own speed
        mix, pick = np.linalg.pinv(-C[:k] @ np.linalg.solve(A, B) + D[:k]), np.eye(k, ny)
        kp, ki, kd, pole = (rng.uniform(a, b, k) for a, b in ((.1, .8), (.1, .6), (0, .3), (.2, .7)))
        dgain = kd * (1 - pole) / (T * w)    # derivative: (y - filtered y) / filter time
        return (block_diag(np.eye(k), np.diag(pole)), np.vstack([T * w * pick, np.diag(1 - pole) @ pick]),
                -mix @ np.hstack([np.diag(ki), -np.diag(dgain)]), -mix @ np.diag(kp + dgain) @ pick)
    X = solve_discrete_are(Ad, Bd, p["qx"] * T, p["qu"] * T)
    K = np.linalg.solve(p["qu"] * T + Bd.T @ X @ Bd, Bd.T @ X @ Ad)
    if kind == "state":
        return np.zeros((0, 0)), np.zeros((0, ny)), np.zeros((nu, 0)), -K
    V = np.diag(np.maximum(p["output_noise"], 1e-2))
    X = solve_discrete_are(Ad.T, C.T, W + 1e-3 * np.eye(n) * np.trace(W), V)
    Lf = np.linalg.solve(C @ X @ C.T + V, C @ X).T
    if np.any(D):                            # predictor; memory = [estimate, last command]
        ac = np.block([[Ad - Bd @ K - Ad @ Lf @ C, -Ad @ Lf @ D], [-K, np.zeros((nu, nu))]])
        return ac, np.vstack([Ad @ Lf, np.zeros((nu, ny))]), np.hstack([-K, np.zeros((nu, nu))]), none
    if rng.random() < 0.5:                   # predictor
        return Ad - Bd @ K - Ad @ Lf @ C, Ad @ Lf, -K, none
    keep, step = np.eye(n) - Lf @ C, Ad - Bd @ K     # filter: uses the newest measurement at once
    return step @ keep, step @ Lf, -K @ keep, -K @ Lf

def random_case(rng, shaky):
    """One draw; None if the loop without latency has no decent margin or the case is too large."""
    kind = str(rng.choice(["state", "lqg", "pid"], p=[.4, .35, .25]))
    n, top = int(rng.integers(2, 4 if shaky else 9)), 2 if shaky else 3
    nu, ny = (int(rng.integers(1, min(top, n) + 1)) for _ in "ab")
    speed = 10 ** rng.uniform(-1, 1)
    A, B = random_plant(rng, n, nu, kind == "pid")
    C = rng.standard_normal((ny, n))
    D = 0.2 * rng.standard_normal((ny, nu)) * (rng.random() < 0.35)
    if kind == "state":
        ny, C, D = n, np.eye(n), np.zeros((n, nu))
    half = rng.standard_normal((n, n)) * 0.7
    G = rng.standard_normal((n, int(rng.integers(1, 4)))) * rng.uniform(0.2, 1)

    def latency():
        q = rng.random()
        return 0.0 if q < .3 else int(rng.integers(1, 21 if q < .8 else 61)) / TICKS

    p = dict(a=A * speed, b=B * speed, c=C, d=D, g=G * np.sqrt(speed), speed=speed,
             period=float(rng.uniform(.08, .5) / speed), law=str(rng.choice(["gaussian", "uniform"])),
             jitter=0.0, skew=float(rng.choice([0, 0.05, -0.03])), loss=0.0,
             qx=half @ half.T + 0.1 * np.eye(n), qu=np.diag(rng.uniform(.1, 2, nu)),
             output_noise=(10 ** rng.uniform(-3, -.5, ny)) * (rng.random(ny) > .15),
             input_latency=[latency() for _ in range(nu)], output_latency=[latency() for _ in range(ny)])
    if shaky:
        mode = rng.integers(0, 3)            # jitter, loss, both
        p["jitter"] = float(rng.uniform(.02, .15)) if mode != 1 else 0.0
        p["loss"] = float(rng.choice([.1, .3])) if mode != 0 else 0.0
    p["ac"], p["bc"], p["cc"], p["dc"] = random_controller(rng, kind, p)
    if shaky and len(numbered_ops(p, 1.0, False)[0][0]) - nu > 12:
        return None                          # keeps the Kronecker square small
    ideal = nominal_radius(p, input_latency=[0.0] * nu, output_latency=[0.0] * ny, skew=0.0)
    return p if ideal < 0.96 and nominal_radius(p) < 1.6 else None

def cases(count, seed):
    rng, found, unstable = np.random.default_rng(seed), [], 0
    while len(found) < count:
        try:
            p = random_case(rng, shaky=len(found) % 5 in (1, 3))    # two in five with jitter or loss
        except np.linalg.LinAlgError:        # a design that does not exist: draw again
            continue
        if p is None:
            continue
        p.update(solve(p))
        bad = p["cost"] is None
        if abs(p["growth"]) < 0.01 or bad and 4 * unstable > len(found):
            continue                         # no marginal cases; about three quarters stable
        unstable += bad
        found.append(p)
    return found

def to_json(p):
    names = dict(a="a", b="b", c="c", d="d", g="g", state_weights="qx", input_weights="qu",
                 output_noise="output_noise")
    same = ("period", "input_latency", "output_latency", "law", "jitter", "skew", "loss",
            "spectral_radius", "growth", "cost", "deviations")
    return dict({k: p[v].tolist() for k, v in names.items()}, **{k: p[k] for k in same},
                controller={k: p[k + "c"].tolist() for k in "abcd"})

def check(count, seed):
    """The models against each other, node counts against each other, and Monte Carlo."""
    models, nodes, rng = 0.0, 0.0, np.random.default_rng(seed + 12345)

    def difference(a, b):                    # growth absolute, everything else relative
        return max(abs(a[1] - b[1]), *(abs(v / w - 1) for v, w in zip([a[0], a[2], *a[3]], [b[0], b[2], *b[3]])))

    for number, p in enumerate(cases(count, seed)):
        line = f"{number:3d} n={len(p['a'])} jitter={p['jitter']:.3f} loss={p['loss']} growth={p['growth']:+.3f}"
        if p["cost"] is not None:
            quiet = dict(p, jitter=0.0, loss=0.0)
            if len(numbered_ops(quiet, 1.0, False)[0][0]) <= 20 and (a := solve_delay_lines(quiet))[2]:
                models = max(models, difference(a, solve_numbered(quiet)))
            if p["jitter"]:
                nodes = max(nodes, difference(solve_numbered(p, 24), solve_numbered(p, 40)))
            if p["growth"] < -0.08:          # slower loops would need longer simulations
                z, err, zs = monte_carlo(p, rng)
                line += f"  z(cost)={z:+.2f} (std error {100 * err:.2f} %)  max|z(variances)|={np.max(np.abs(zs)):.2f}"
        print(line, flush=True)
    print(f"largest difference: delay lines / numbered periods {models:.1e}, 40 / 24 nodes {nodes:.1e}")

if __name__ == "__main__":
    ap = argparse.ArgumentParser(description="reference results for sampled-data loops")
    for name, default in (("--count", 12), ("--seed", 1)):
        ap.add_argument(name, type=int, default=default)
    ap.add_argument("--check", action="store_true")
    o = ap.parse_args()
    if o.check:
        check(o.count, o.seed)
    else:
        json.dump({"cases": [to_json(p) for p in cases(o.count, o.seed)]}, sys.stdout)
