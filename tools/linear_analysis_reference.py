#!/usr/bin/env python3
"""Makes crates/libration-analyze/tests/reference/linear_analysis.json (--count 12 --seed 1): steps on linear plants and loops around them.

Written from the textbooks, with NumPy 2 and SciPy 1; nothing comes from Libration. Every second plant is mechanical, x = (q, v) and
q'' = -K q - C v, with dampers that are not in proportion to the springs; the others are x' = A x with decaying modes, some of them stiff.

Steps     of h seconds as matrices: expm(A h); Taylor polynomials of A h of degree 1 and 4; products of
          kick(h) = [[1, 0], [-h K, 1 - h C]] and drift(h) = [[1, h], [0, 1]]. Textbook Verlet: q' = q + h v + h^2/2 a,
          v' = v + h/2 (a(q, v) + a(q', v)). Implicit steps as SciPy's solutions of their equations: (1 - h A) y' = y;
          (1 - h/2 A) y' = (1 + h/2 A) y; (1 + h C)(v' - v) = -h (K q + C v), with K (q + h v) in place of K q for stable PD,
          and q' = q + h v'.
Modes     follow from h = 0 in 400 steps, each multiplier to the nearest one, so that none is taken for another.
Stable    up to the first h at which the spectral radius leaves 1, by scanning h and Brent's method.
Loop      u = -K x, with a latency of f periods, 0 < f < 1: the held command is a state. Noise of intensity 1 enters where the
          inputs do; its covariance in a period is what the covariance without a loop loses in it. SciPy solves the Lyapunov equations.

usage: linear_analysis_reference.py --count N --seed S
"""
import argparse, json
import numpy as np
from scipy.linalg import block_diag, expm, solve_continuous_lyapunov, solve_discrete_lyapunov
from scipy.optimize import brentq

def taylor(A, degree):
    def step(h):
        M = term = np.eye(len(A))
        for k in range(1, degree + 1):
            term = term @ A * h / k
            M = M + term
        return M
    return step

def splittings(A):
    n = len(A) // 2
    one, zero = np.eye(n), np.zeros((n, n))
    K, C = -A[n:, :n], -A[n:, n:]
    kick = lambda h: np.block([[one, zero], [-h * K, one - h * C]])
    drift = lambda h: np.block([[one, h * one], [zero, one]])
    verlet = lambda h: kick(h / 2) @ drift(h) @ kick(h / 2)
    def textbook(h):
        q = np.hstack([one - h**2 / 2 * K, h * one - h**2 / 2 * C])
        a, v = np.hstack([-K, -C]), np.hstack([zero, one])
        return np.vstack([q, v + h / 2 * (a + (-K @ q - C @ v))])
    w, p = 1 / (2 - 2 ** (1 / 3)), 1 / (4 - 4 ** (1 / 3))
    compose = lambda weights: lambda h: np.linalg.multi_dot([verlet(x * h) for x in weights])
    return {
        "symplectic-euler": lambda h: drift(h) @ kick(h),
        "symplectic-euler-drift-first": lambda h: kick(h) @ drift(h),
        "velocity-verlet": verlet,
        "textbook-verlet": textbook,
        "leapfrog": lambda h: drift(h / 2) @ kick(h) @ drift(h / 2),
        "yoshida4": compose([w, 1 - 2 * w, w]),
        "suzuki4": compose([p, p, 1 - 4 * p, p, p]),
    }

def implicit(A):
    one = np.eye(len(A))
    backward = lambda h: np.linalg.solve(one - h * A, one)
    cayley = lambda h: np.linalg.solve(one - h / 2 * A, one + h / 2 * A)
    def pade(*coefficients):
        sum_of = lambda h: sum(c * np.linalg.matrix_power(h * A, k) for k, c in enumerate(coefficients))
        return lambda h: np.linalg.solve(sum_of(-h), sum_of(h))
    return {
        "damping-stiffness-implicit": backward, "backward-euler": backward,
        "implicit-midpoint": cayley, "trapezoid": cayley,
        "gauss-legendre-4": pade(1, 1 / 2, 1 / 12), "gauss-legendre-6": pade(1, 1 / 2, 1 / 10, 1 / 120),
    }

def implicit_dampers(A):
    n = len(A) // 2
    one, zero = np.eye(n), np.zeros((n, n))
    K, C = -A[n:, :n], -A[n:, n:]
    def step(predicted):
        def of(h):
            force = np.hstack([-K, -C - predicted * h * K])
            v = np.hstack([zero, one]) + h * np.linalg.solve(one + h * C, force)
            return np.vstack([np.hstack([one, zero]) + h * v, v])
        return of
    return {"damping-implicit": step(0.0), "stable-pd": step(1.0)}

def radius(M):
    return np.abs(np.linalg.eigvals(M)).max()

def followed(step, values, dt):
    """The multiplier of each mode, from 1 at h = 0."""
    before, last = np.exp(-values * dt / 400), np.ones(len(values))
    for k in range(1, 401):
        found, expected = list(np.linalg.eigvals(step(dt * k / 400))), last * last / before
        before, now = last, []
        for x in expected:
            now.append(found.pop(int(np.argmin(np.abs(np.array(found) - x)))))
        last = np.array(now)
    return last

def first_limit(step, fastest):
    excess = lambda h: radius(step(h)) - 1
    for k in range(1, 2000):
        low, high = max(k - 1, 1e-6) * 0.005 / fastest, k * 0.005 / fastest
        if excess(high) > 0:
            return brentq(excess, low, high, xtol=1e-15 * high, rtol=1e-14)
    return None

def loop(A, B, period, f, gain):
    n, m = B.shape
    G = np.block([[A, B], [np.zeros((m, n + m))]])
    first, second = expm(G * f * period), expm(G * (1 - f) * period)
    P1, H1, P2, H2 = first[:n, :n], first[:n, n:], second[:n, :n], second[:n, n:]
    # States and the command that was computed in the period before.
    M = np.block([[P2 @ P1 - H2 @ gain, P2 @ H1], [-gain, np.zeros((m, m))]])
    rest, phi = solve_continuous_lyapunov(A, -B @ B.T), expm(A * period)
    W = rest - phi @ rest @ phi.T
    P = solve_discrete_lyapunov(M, block_diag(W, np.zeros((m, m))))
    return M, np.sqrt(np.diag(P)[:n])

def pairs(values):
    upper = sorted((x for x in values if x.imag >= 0), key=lambda x: (-x.real, x.imag))
    return np.array(upper)

def case(number, rng):
    if number % 2 == 0:
        n = int(rng.integers(1, 4))
        square = lambda: (lambda X: X @ X.T)(rng.normal(size=(n, n)))
        mass, springs, dampers = square() + n * np.eye(n), 9 * square() + np.eye(n), 0.1 * square()
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, springs), -np.linalg.solve(mass, dampers)]])
        B = np.vstack([np.zeros((n, 1)), np.linalg.solve(mass, rng.normal(size=(n, 1)))])
    else:
        n = int(rng.integers(2, 7))
        A = rng.normal(size=(n, n))
        A -= (np.linalg.eigvals(A).real.max() + 0.3) * np.eye(n)
        if number % 4 == 3:
            A[-1] *= 1000.0                  # a fast state
            A -= max(0.0, np.linalg.eigvals(A).real.max() + 0.3) * np.eye(n)
        B = rng.normal(size=(n, 1))
    values = pairs(np.linalg.eigvals(A))
    fastest = np.abs(values).max()
    dt = float(rng.uniform(0.2, 0.8)) / fastest
    steps = {"exact": lambda h: expm(A * h), "explicit-euler": taylor(A, 1), "rk4": taylor(A, 4)}
    steps |= implicit(A)
    if number % 2 == 0:
        steps |= splittings(A) | implicit_dampers(A)
    of_steps = {}
    for name, step in steps.items():
        followed_values = followed(step, values, dt)
        of_steps[name] = {
            "spectral_radius": radius(step(dt)),
            "multipliers": [[x.real, x.imag] for x in followed_values],
            "largest_stable_dt": None if name == "exact" else first_limit(step, fastest),
        }
    while True:
        gain, f = 0.3 * rng.normal(size=(1, len(A))), float(rng.uniform(0.1, 0.9))
        period = 0.1
        M, deviations = loop(A, B, period, f, gain)
        if radius(M) < 0.999:
            break
    return {
        "a": A.tolist(), "b": B.tolist(), "dt": dt,
        "eigenvalues": [[x.real, x.imag] for x in values],
        "steps": of_steps,
        "loop": {
            "gain": gain.tolist(), "period": period, "latency_periods": f,
            "eigenvalues": [[x.real, x.imag] for x in sorted(pairs(np.linalg.eigvals(M)), key=lambda x: -abs(x))],
            "spectral_radius": radius(M), "deviations": deviations.tolist(),
        },
    }

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("--seed", type=int, required=True)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    cases = [case(number, rng) for number in range(options.count)]
    print("[\n" + ",\n".join(json.dumps(one) for one in cases) + "\n]")
