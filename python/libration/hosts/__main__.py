"""A simulator as a program: ``python -m libration.hosts mujoco arm.xml``.

The first line of its output describes the simulator as JSON, or is ``error: `` and a message. Then each line ``x1 … xn u1 … um dt`` of the
input is answered with a line ``x1 … xn``, the states after a step, and each line ``energy x1 … xn`` with the energy.
"""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

import numpy as np

from .._descriptions import description_of
from .host import Host


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m libration.hosts")
    kinds = parser.add_subparsers(dest="kind", required=True)
    of_mujoco = kinds.add_parser("mujoco", help="a MuJoCo model")
    of_mujoco.add_argument("file")
    of_mujoco.add_argument("--keyframe", help="name or number of a keyframe")
    of_mujoco.add_argument("--dt", type=float, help="timestep in s")
    of_mujoco.add_argument("--settle", action="store_true", help="start from a settled equilibrium")
    of_mujoco.add_argument("--state-scale", help="typical deviations of the states, or one number for all")
    of_mujoco.add_argument("--gains", action="store_true", help="describe servos, and step with gains that lines `gains kp… kv…` set")
    of_mujoco.add_argument("--integrator", help="integrator for --gains")
    of_mujoco.add_argument("--substeps", type=int, default=1, help="substeps for --gains")
    return parser.parse_args()


def _keyframe(arguments: argparse.Namespace) -> Any:
    keyframe = arguments.keyframe
    return int(keyframe) if keyframe is not None and keyframe.isdigit() else keyframe


def _host(arguments: argparse.Namespace) -> Host:
    from .mujoco import mujoco_host

    state = "settled" if arguments.settle else None
    return mujoco_host(arguments.file, keyframe=_keyframe(arguments), state=state, dt=arguments.dt, memory=None)


def _answer(host: Host, line: str) -> str:
    words = line.split()
    n = len(host.state)
    if words[:1] == ["energy"] and host.energy is not None:
        states = np.array([[float(word) for word in words[1:]]])
        return repr(float(host.energy(states)[0]))
    numbers = [float(word) for word in words]
    states, actions = np.array([numbers[:n]]), np.array([numbers[n:-1]])
    return " ".join(repr(float(x)) for x in host.step(states, actions, numbers[-1])[0])


def _scale(text: str, count: int) -> list[float]:
    """Return a typical deviation for each state."""
    numbers = [float(word) for word in text.split(",")]
    if len(numbers) not in (1, count):
        raise ValueError(f"--state-scale has {len(numbers)} numbers; expected 1 or {count}")
    return numbers * count if len(numbers) == 1 else numbers


def _gains(arguments: argparse.Namespace) -> int:
    from ._mujoco_gains import mujoco_gains

    state = "settled" if arguments.settle else None
    keywords = {"dt": arguments.dt, "integrator": arguments.integrator, "substeps": arguments.substeps}
    described, host, gains = mujoco_gains(arguments.file, keyframe=_keyframe(arguments), state=state, **keywords)
    print(json.dumps(described), flush=True)
    for line in sys.stdin:
        if line.startswith("gains"):
            numbers = [float(word) for word in line.split()[1:]]
            gains.set(numbers[: len(numbers) // 2], numbers[len(numbers) // 2 :])
            print("1", flush=True)
        else:
            print(_answer(host, line), flush=True)
    return 0


def main() -> int:
    arguments = _arguments()
    try:
        if arguments.gains:
            return _gains(arguments)
        host = _host(arguments)
        described = description_of(host)
        if arguments.state_scale is not None:
            described["state_scale"] = _scale(arguments.state_scale, len(host.state))
    except ModuleNotFoundError as error:
        print(f"error: {error}; help: pip install 'libration[mujoco]' for this interpreter, {sys.executable}", flush=True)
        return 2
    except (TypeError, ValueError) as error:
        print("error: " + " ".join(str(error).split()), flush=True)
        return 2
    print(json.dumps(described), flush=True)
    for line in sys.stdin:
        print(_answer(host, line), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
