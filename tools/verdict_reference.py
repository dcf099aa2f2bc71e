#!/usr/bin/env python3
"""Compares verdicts of `libration analyze` with eigenvalues and trajectories that it does not compute.

Written with NumPy 2 and SciPy 1; nothing is imported from Libration, which runs as a program.

Linear     Random plants, x' = A x or q'' = -K q - C v, some of them growing, gyroscopic, free or stiff, as files of matrices (--plant)
           and as equations (--system). The update matrices are those of `linear_analysis_reference.py`, from the textbooks.
           Unstable: a multiplier is larger than 1 and than all of exact steps. Multipliers within 1e-6 of the limit are left out.
Nonlinear  Random systems with a smooth right side, as equations. The trajectory of the integrator is that of `libration simulate`, the
           exact one that of DOP853 with tolerances of 1e-12 and, for its own error, 1e-10. Resolved: the largest error is at most 1 % of
           the range of the state. Errors between 0.5 % and 2 % are left out, and motions that DOP853 does not know. An unknown verdict
           is no success and no error.
Both       The exit code is 0 if the first sentence is good, else 1.

usage: verdict_reference.py PROGRAM [--linear 300] [--nonlinear 100] [--integrators N] [--seed 1]
       With --integrators N each system takes N integrators, drawn from all; 0 takes all. Exit code 1 if a verdict is wrong.
"""
import argparse, json, math, re, subprocess, sys, tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from linear_analysis_reference import implicit, implicit_dampers, splittings, taylor

NEAR = 1e-6
SMALL = 0.01
# In seconds, for a command that takes one on a machine that does nothing else.
TIMEOUT = 60


def run(program, *words):
    done = subprocess.run([program, "-q", *map(str, words)], capture_output=True, text=True, timeout=TIMEOUT)
    return done.returncode, done.stdout, done.stderr


def first_sentence(text):
    """The text up to the first point at the end of a sentence."""
    return re.split(r"\.(?:\s|$)", " ".join(text.split()), maxsplit=1)[0]


def outcome(sentence):
    if sentence.startswith("Whether "):
        return "unknown"
    if " is unstable " in sentence:
        return "unstable"
    if " is stable " in sentence:
        return "stable"
    if " does not resolve " in sentence or " diverges" in sentence:
        return "not resolved"
    if " resolves the motion" in sentence:
        return "resolved"
    return f"no verdict: {sentence}"


# Linear systems


def random_plant(rng):
    """The matrix of a plant, and whether its states are positions and velocities."""
    kind = rng.integers(6)
    if kind < 2:
        n = int(rng.integers(1, 4))
        A = rng.normal(size=(n, n)) * 10 ** rng.uniform(-1, 2, size=(n, 1))
        if kind == 0:
            A = A - (max(np.linalg.eigvals(A).real.max(), 0) + rng.uniform(0.01, 1)) * np.eye(n)
        return A, False
    n = int(rng.integers(1, 3))
    X = rng.normal(size=(n, n))
    K = (X @ X.T + 0.1 * np.eye(n)) * 10 ** rng.uniform(-1, 3)
    Y = rng.normal(size=(n, n))
    C = {2: np.zeros((n, n)), 3: Y @ Y.T * 10 ** rng.uniform(-2, 1), 4: (Y - Y.T), 5: 0.3 * (Y + Y.T)}[int(kind)]
    return np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]]), True


def update_matrices(A, is_mechanical):
    steps = {"explicit-euler": taylor(A, 1), "rk4": taylor(A, 4), **implicit(A)}
    if is_mechanical:
        steps |= splittings(A) | implicit_dampers(A)
    return steps


def true_outcome(M, A, dt):
    """Stable or unstable; none near the limit. A stable step may still not resolve modes that grow."""
    own = np.abs(np.linalg.eigvals(M))
    exact = np.exp(np.linalg.eigvals(A).real * dt)
    limit = max(1.0, exact.max())
    if exact.max() > 1 + NEAR:
        # A mode that grows may be inaccurate, and others must not grow: as many multipliers are above 1 as exact ones.
        extra = np.sum(own > 1 + NEAR) > np.sum(exact > 1 - NEAR)
        if extra or np.log(own.max()) > 2 * np.log(limit):
            return "unstable"
        return "stable" if own.max() <= limit * (1 + NEAR) and not extra else None
    if own.max() > 1 + NEAR:
        return "unstable"
    neutral = np.abs(np.linalg.eigvals(A).real).min() < 1e-9
    return "stable" if own.max() < 1 - NEAR or (neutral and own.max() < 1 + 1e-12) else None


def grows(A, dt):
    return bool((np.linalg.eigvals(A).real * dt).max() > NEAR)


def plant_file(A, path):
    rows = ", ".join("[" + ", ".join(repr(float(x)) for x in row) + "]" for row in A)
    path.write_text(f"a = [{rows}]\nb = [{', '.join('[1]' for _ in A)}]\n")


def linear_equations(A, is_mechanical, path):
    n = len(A) // 2 if is_mechanical else len(A)
    names = [f"x{i}" for i in range(n)]
    terms = [*names, *[f"{name}'" for name in names]] if is_mechanical else names
    rows = A[n:] if is_mechanical else A
    text = '[system]\nname = "random"\n'
    text += f"coordinates = {json.dumps(names)}\n" if is_mechanical else ""
    for name, row in zip(names, rows):
        form = " + ".join(f"({float(a)!r})*{term}" for a, term in zip(row, terms))
        text += f'{"acceleration" if is_mechanical else "rate"}.{name} = "{form}"\n'
    text += "start = { " + ", ".join(f"{name} = 1.0" for name in names) + " }\n"
    path.write_text(text)


def check_linear(program, rng, folder, count, per_system, tally):
    for number in range(count):
        A, is_mechanical = random_plant(rng)
        plant, equations = folder / "plant.toml", folder / "system.toml"
        plant_file(A, plant)
        linear_equations(A, is_mechanical, equations)
        steps = update_matrices(A, is_mechanical)
        names = sorted(steps)
        if per_system:
            names = list(rng.choice(names, size=min(per_system, len(names)), replace=False))
        fastest = np.abs(np.linalg.eigvals(A)).max()
        for name in names:
            dt = float(f"{10 ** rng.uniform(-2.5, 1) / fastest:.6g}")
            wanted = true_outcome(steps[name](dt), A, dt)
            if wanted is None:
                tally["near the limit"] += 1
                continue
            for door in (["--plant", plant], ["--system", equations, "--steps", 200]):
                code, text, error = run(program, "analyze", *door, "--integrator", name, "--dt", repr(dt))
                sentence = first_sentence(text)
                found = outcome(sentence)
                if wanted == "unstable" or door[0] == "--plant":
                    is_right = found == wanted or (wanted == "stable" and found == "not resolved" and grows(A, dt))
                else:
                    is_right = found in ("resolved", "not resolved", "unknown")
                is_right &= code == (0 if found in ("stable", "resolved") else 1)
                tally["right" if is_right else "wrong"] += 1
                if not is_right:
                    own = np.abs(np.linalg.eigvals(steps[name](dt))).max()
                    exact = np.abs(np.linalg.eigvals(expm(A * dt))).max()
                    print(f"linear {number} {name} dt {dt} {door[0]}: {sentence!r}, code {code}; "
                          f"radius {own}, exact {exact}: {wanted} {error}\n{A.tolist()}")


# Nonlinear systems

FORMS = [
    (2, ["{x1}", "-{a}*sin({x0}) - {b}*{x1}"]),
    (2, ["{x1}", "-{a}*{x0}^3 - {b}*{x0}"]),
    (2, ["{x1}", "{a}*(1 - {x0}^2)*{x1} - {x0}"]),
    (1, ["{a}*{x0}*(1 - {x0})"]),
    (1, ["-{a}*{x0}^3"]),
    (2, ["{x0}*({a} - {x1})", "{x1}*({x0} - {b})"]),
    (3, ["{a}*({x1} - {x0})", "{x0}*(3 - {x2}) - {x1}", "{x0}*{x1} - {b}*{x2}"]),
    (2, ["{x1}", "-{a}*{x0}/(1 + {x0}^2) - {b}*{x1}*abs({x1})/10"]),
]


def random_nonlinear(rng):
    size, rates = FORMS[int(rng.integers(len(FORMS)))]
    values = {"a": f"{10 ** rng.uniform(-0.5, 1):.4g}", "b": f"{rng.uniform(0, 1):.4g}"}
    names = {f"x{i}": f"x{i}" for i in range(size)}
    rates = [rate.format(**values, **names) for rate in rates]
    start = [float(f"{rng.uniform(0.2, 1.5):.4g}") for _ in range(size)]
    return size, rates, start


def nonlinear_file(size, rates, start, path):
    """As positions and velocities where the first state is the rate of the second one."""
    is_mechanical = size == 2 and rates[0] == "x1"
    text = '[system]\nname = "random"\n'
    if is_mechanical:
        text += 'coordinates = ["x0"]\nacceleration.x0 = "' + rates[1].replace("x1", "x0'") + '"\n'
        text += f"start = {{ x0 = {start[0]}, \"x0'\" = {start[1]} }}\n"
    else:
        text += "".join(f'rate.x{i} = "{rate}"\n' for i, rate in enumerate(rates))
        text += "start = { " + ", ".join(f"x{i} = {x}" for i, x in enumerate(start)) + " }\n"
    path.write_text(text)


def true_errors(rates, start, dt, own):
    """The largest errors relative to the ranges of the states; none where the exact motion is not known."""
    names = ", ".join(f"x{i}" for i in range(len(start)))
    body = ", ".join(rate.replace("^", "**") for rate in rates)
    function = eval(f"lambda {names}: ({body},)", {"sin": math.sin, "abs": abs})
    left = [200_000]

    def right(t, x):
        left[0] -= 1
        if left[0] < 0:
            raise TimeoutError
        return function(*x.tolist())

    times = np.arange(len(own)) * dt
    results = []
    for tolerance in (1e-12, 1e-10):
        try:
            exact = solve_ivp(right, (0, times[-1]), start, "DOP853", times, rtol=tolerance, atol=tolerance)
        except (TimeoutError, OverflowError):
            return None
        if exact.status != 0 or exact.y.shape[1] != len(times):
            return None
        results.append(exact.y.T)
    scale = np.ptp(results[0], axis=0)
    if np.any(np.abs(results[0] - results[1]).max(axis=0) > 1e-3 * scale):
        return None
    return (np.abs(own - results[0]).max(axis=0) / scale).max()


def check_nonlinear(program, rng, folder, count, per_system, tally):
    listed = json.loads(run(program, "list", "--json")[1])
    names = [one["name"] for one in listed["integrators"]]
    for number in range(count):
        if number:
            print(f"nonlinear: {number} systems, {dict(tally)}", file=sys.stderr, flush=True)
        size, rates, start = random_nonlinear(rng)
        path = folder / "nonlinear.toml"
        nonlinear_file(size, rates, start, path)
        chosen = names if not per_system else rng.choice(names, size=per_system, replace=False)
        for name in chosen:
            dt, steps = float(f"{10 ** rng.uniform(-2.5, 0.3):.4g}"), 60
            step = ["--system", path, "--integrator", name, "--dt", dt, "--steps", steps]
            try:
                code, text, error = run(program, "analyze", *step)
            except subprocess.TimeoutExpired:
                tally["too slow"] += 1
                print(f"nonlinear {number} {name} dt {dt}: no verdict in {TIMEOUT} s\n{path.read_text()}", flush=True)
                continue
            if code == 2:
                tally["refused"] += 1
                continue
            found = outcome(first_sentence(text))
            code_is_right = code == (0 if found in ("stable", "resolved") else 1)
            _, rows, _ = run(program, "simulate", *step, "--format", "csv")
            table = [line.split(",") for line in rows.splitlines() if line and not line.startswith("#")]
            own = np.array([[float(x) for x in row[2 : 2 + size]] for row in table[1:]])
            if len(own) != steps + 1 or not np.all(np.isfinite(own)):
                is_right = found in ("not resolved", "unstable", "unknown")
            else:
                error = true_errors(rates, start, dt, own)
                if error is None or SMALL / 2 < error < 2 * SMALL:
                    tally["near the limit"] += 1
                    continue
                # An instability that has not grown yet is one.
                good, bad = ("resolved", "unstable"), ("not resolved", "unstable")
                is_right = found in (good if error <= SMALL else bad)
            if found == "unknown":
                tally["unknown"] += 1
                is_right = True
            is_right &= code_is_right
            tally["right" if is_right else "wrong"] += 1
            if not is_right:
                print(f"nonlinear {number} {name} dt {dt}: {first_sentence(text)!r}, code {code}, error {error}\n{path.read_text()}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--linear", type=int, default=300)
    parser.add_argument("--nonlinear", type=int, default=100)
    parser.add_argument("--integrators", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        for what, check, count in (("linear", check_linear, args.linear), ("nonlinear", check_nonlinear, args.nonlinear)):
            tally = Counter()
            check(args.program, np.random.default_rng(args.seed), Path(name), count, args.integrators, tally)
            print(f"{what}: {count} systems, {dict(tally)}", flush=True)
            wrong += tally["wrong"]
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
