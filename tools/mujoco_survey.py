"""Compare `libration gains --mujoco` with differences and runs of `mj_step`, over all models in folders.

    python tools/mujoco_survey.py target/debug/libration FOLDER ... [--python PROGRAM] [--most N]

The right values use MuJoCo and NumPy alone: the spectral radius of central differences of ``mj_step``, the same on both sides of each
largest gain, and a run of 5 s from the point. Differences are those without friction loss. A model with friction loss whose gains are said to
hold runs from a displacement of 0.01 as well. A line for each model says what agrees; a model whose verdict is `unknown` names its reason.
"""

from __future__ import annotations

import argparse
import copy
import json
import subprocess
from pathlib import Path

import mujoco
import numpy as np

# Differences of these lengths must agree, or the step has no derivative there.
LENGTHS = (1e-5, 1e-6, 1e-7)
AGREES = 1e-4
# Growth that rounding of such differences may show: the root of 1e-10 in a repeated factor.
GROWTH = 1e-4
# Displacement of each position in m or rad, beyond what friction loss holds.
DISPLACEMENT = 0.01


def derivative(model, point, eps):
    nv, na = model.nv, model.na

    def after(change):
        data = mujoco.MjData(model)
        for name in ("qpos", "qvel", "act", "ctrl", "mocap_pos", "mocap_quat", "eq_active"):
            getattr(data, name)[:] = getattr(point, name)
        mujoco.mj_integratePos(model, data.qpos, change[:nv], 1.0)
        data.qvel[:] += change[nv : 2 * nv]
        data.act[:] += change[2 * nv :]
        mujoco.mj_step(model, data)
        return data

    size = 2 * nv + na
    base, columns = after(np.zeros(size)), []
    for j in range(size):
        ends = []
        for side in (eps, -eps):
            data, move = after(side * np.eye(size)[j]), np.zeros(nv)
            mujoco.mj_differentiatePos(model, move, 1.0, base.qpos, data.qpos)
            ends.append(np.concatenate([move, data.qvel - base.qvel, data.act - base.act]))
        columns.append((ends[0] - ends[1]) / (2 * eps))
    return np.stack(columns, axis=1)


def radius(model, point, eps=LENGTHS[1]):
    matrix = derivative(model, point, eps)
    return float(np.abs(np.linalg.eigvals(matrix)).max()) if np.isfinite(matrix).all() else np.inf


def fast_radius(model, point, eps):
    """Return the largest factor of a mode that is fast beside the step."""
    factors = np.linalg.eigvals(derivative(model, point, eps))
    fast = np.abs(factors[np.abs(factors - 1) > 0.5])
    return float(fast.max(initial=0.0))


def with_gains(model, point, servo, kp, kv):
    """Return the model with other gains of a servo, the same force at the point, and no limits of forces.

    The differences with a stiff servo are longer than the deviations at which forces meet their limits.
    """
    own, forward = copy.deepcopy(model), copy.copy(point)
    own.actuator_forcelimited[:] = 0
    for flags in ("jnt_actfrclimited", "tendon_actfrclimited"):
        if hasattr(own, flags):
            getattr(own, flags)[:] = 0
    mujoco.mj_forward(model, forward)
    out = int(model.actuator_outadr[servo]) if hasattr(model, "actuator_outadr") else servo
    bias = own.actuator_biasprm[servo]
    bias[0] += (bias[1] + kp) * forward.actuator_length[out] + (bias[2] + kv) * forward.actuator_velocity[out]
    bias[1], bias[2] = -kp, -kv
    return own


def without_friction(model):
    free = copy.deepcopy(model)
    free.dof_frictionloss[:], free.tendon_frictionloss[:] = 0, 0
    return free


def displaced(model, point):
    """Return the positions of a point with each joint moved, within its range; a free joint stays."""
    change = np.zeros(model.nv)
    for joint in range(model.njnt):
        first, kind = int(model.jnt_dofadr[joint]), int(model.jnt_type[joint])
        if kind in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            here, (low, high) = float(point.qpos[model.jnt_qposadr[joint]]), model.jnt_range[joint]
            sides = [side for side in (DISPLACEMENT, -DISPLACEMENT) if not model.jnt_limited[joint] or low < here + side < high]
            change[first] = sides[0] if sides else 0.0
        elif kind == mujoco.mjtJoint.mjJNT_BALL:
            change[first : first + 3] = DISPLACEMENT / 3
    positions = np.array(point.qpos)
    mujoco.mj_integratePos(model, positions, change, 1.0)
    return positions


def moves_away(model, point, seconds=5.0, positions=None):
    """Return the largest change of a position in a run, relative to 0.5 rad and a tenth of the extent."""
    data, change, largest = mujoco.MjData(model), np.zeros(model.nv), 0.0
    for name in ("qpos", "act", "ctrl", "mocap_pos", "mocap_quat", "eq_active"):
        getattr(data, name)[:] = getattr(point, name)
    if positions is not None:
        data.qpos[:] = positions
    limit = np.full(model.nv, 0.5)
    for joint in range(model.njnt):
        first, kind = int(model.jnt_dofadr[joint]), int(model.jnt_type[joint])
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            limit[first : first + 3] = 0.1 * model.stat.extent
        elif kind == mujoco.mjtJoint.mjJNT_SLIDE:
            limit[first] = 0.1 * model.stat.extent
    for _ in range(max(1, min(10_000, round(seconds / model.opt.timestep)) // 25)):
        mujoco.mj_step(model, data, nstep=25)
        mujoco.mj_differentiatePos(model, change, 1.0, point.qpos, data.qpos)
        largest = max(largest, float(np.max(np.abs(np.nan_to_num(change, nan=np.inf)) / limit)))
    return largest


def diverges_by_its_step(model, point):
    """Whether a run from a displacement leaves the point, and one with a tenth of the step does not."""
    finer = copy.deepcopy(model)
    finer.opt.timestep /= 10
    positions = displaced(model, point)
    return moves_away(model, point, positions=positions) > 1 >= moves_away(finer, point, 0.5, positions)


def report_of(words):
    done = subprocess.run(words, capture_output=True, text=True)
    try:
        return json.loads(done.stdout), done.returncode
    except json.JSONDecodeError:
        return (done.stderr.strip().splitlines() or ["no output"])[-1], done.returncode


def survey(path, words, settle):
    """Return what agrees and what does not."""
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    options = ["--keyframe", "0"] if model.nkey else []
    report, code = report_of([*words, str(path), *options, "--json", *["--settle"] * settle])
    if isinstance(report, str):
        return "refused: " + report[:100], []
    point = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, point, 0)
    measured, outcome, wrong = report["measured"], report["verdict"]["outcome"], []
    if (code == 0) != (outcome == "stable"):
        wrong.append(f"exit code {code} of {outcome}")
    if settle:
        where = measured["operating_point"]
        own = moves_away(model, point)
        # Near the limit a run is decided by its length.
        if where["run"]["stands"] != (own <= 1) and not 0.9 < own < 1.1:
            wrong.append(f"stands {where['run']['stands']}, own run moves {own:.2f} of the limit")
        if outcome == "stable" and own > 1.1:
            wrong.append("stable, but the own run falls")
        mujoco.mj_integratePos(model, point.qpos, np.array(where["changes"]), 1.0)
        point.qvel[:] = 0
        if model.na:
            return f"{outcome} (activations of the equilibrium unknown)", wrong
    has_friction = np.any(model.dof_frictionloss) or np.any(model.tendon_frictionloss)
    if has_friction and outcome == "stable" and diverges_by_its_step(model, point):
        wrong.append(f"stable, but a run from a displacement of {DISPLACEMENT} diverges")
    model = without_friction(model)
    radii = [radius(model, point, eps) for eps in LENGTHS]
    if max(radii) - min(radii) > AGREES * max(radii):
        if outcome == "stable":
            wrong.append(f"stable, own differences vary: {radii}")
        return f"{outcome} ({report['verdict']['evidence'][:90]}); own differences vary {radii[0]:.4g} to {radii[-1]:.4g}", wrong
    own, found = radii[1], measured["spectral_radius"]
    if not measured["is_differentiable"]:
        return f"{outcome}: no derivative; own {own:.6f}", wrong
    if abs(own - found) > AGREES * max(1.0, own):
        wrong.append(f"spectral radius {found:.7f}, own {own:.7f}")
    if outcome == "stable" and own > 1 + GROWTH or outcome == "unstable" and own < 1 + 1e-7:
        wrong.append(f"{outcome}, own spectral radius {own:.7f}")
    limits, unclear, at_rest = 0, 0, measured["equilibrium"]["holds"]
    servos = {mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_ACTUATOR, k) or f"actuator[{k}]": k for k in range(model.nu)}
    for row in measured["servos"]:
        for name in ("kp", "kv"):
            limit = row[f"largest_{name}"]
            if not limit or row["name"] not in servos:
                continue
            growth, varies = [], False
            for part in (0.97, 1.03):
                gains = {"kp": row["kp"], "kv": row["kv"], name: part * limit}
                changed = with_gains(model, point, servos[row["name"]], **gains)
                found = [(radius if at_rest else fast_radius)(changed, point, eps) for eps in LENGTHS[:2]]
                varies = varies or abs(found[0] - found[1]) > 1e-3 * max(found)
                growth.append(found[1])
            # A stiff servo moves into a limit within a step: there is no derivative at these gains.
            if varies:
                unclear += 1
                continue
            limits += 1
            bound = 1 + GROWTH if at_rest else 1.01
            if not growth[0] <= bound < growth[1]:
                wrong.append(f"largest {name} of {row['name']} {limit:.5g}: own {growth[0]:.6f}, {growth[1]:.6f}")
    reason = "" if outcome == "stable" else f" ({report['verdict']['evidence'][:110]})"
    return f"{outcome}{reason}, own radius {own:.6f}, {limits} limits compared, {unclear} without a derivative", wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("libration")
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--python", default="python3")
    parser.add_argument("--most", type=int, default=1000)
    parser.add_argument("--settle", action="store_true")
    arguments = parser.parse_args()
    words = [arguments.libration, "gains", "--python", arguments.python, "--timeout", "120", "--mujoco"]
    paths = [path for folder in arguments.folders for path in (sorted(folder.rglob("*.xml")) if folder.is_dir() else [folder])]
    count = failed = 0
    for path in paths:
        try:
            model = mujoco.MjModel.from_xml_path(str(path))
        except ValueError:
            continue
        if not model.nu or count >= arguments.most:
            continue
        count += 1
        text, wrong = survey(path, words, arguments.settle)
        failed += bool(wrong)
        print(f"{'WRONG' if wrong else 'ok   '} {path.parent.name}/{path.name}: {text}", *wrong, sep="\n      ", flush=True)
    print(f"{count} models, {failed} with a wrong number or verdict")


if __name__ == "__main__":
    main()
