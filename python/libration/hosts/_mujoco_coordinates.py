"""Minimal coordinates of MuJoCo: the positions of joints, with rotation vectors in place of quaternions."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Coordinates:
    """The map between states (positions, velocities, activations) and those of MuJoCo around a reference position.

    Rotations of ball and free joints are rotation vectors from the reference, in the frame of the body. All other numbers are those
    of MuJoCo, bit for bit.
    """

    def __init__(self, model: Any, qpos: Array) -> None:
        self.nv, self.na = int(model.nv), int(model.na)
        self.size = 2 * self.nv + self.na
        self.reference = np.array(qpos, dtype=np.float64)
        of_q: list[int] = []
        of_v: list[int] = []
        self.rotations: list[tuple[int, int]] = []
        for joint in range(model.njnt):
            kind, q, v = int(model.jnt_type[joint]), int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
            if kind == mujoco.mjtJoint.mjJNT_FREE:
                of_q += range(q, q + 3)
                of_v += range(v, v + 3)
                q, v = q + 3, v + 3
            if kind in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
                self.rotations.append((q, v))
                mujoco.mju_normalize4(self.reference[q : q + 4])
            else:
                of_q.append(q)
                of_v.append(v)
        self.of_q, self.of_v = np.array(of_q, dtype=int), np.array(of_v, dtype=int)

    def state(self, data: Any) -> Array:
        """Return the state of an MjData."""
        state = np.empty(self.size)
        state[self.of_v] = data.qpos[self.of_q]
        for q, v in self.rotations:
            mujoco.mju_subQuat(state[v : v + 3], data.qpos[q : q + 4], self.reference[q : q + 4])
        state[self.nv : 2 * self.nv] = data.qvel
        state[2 * self.nv :] = data.act
        return state

    def write(self, state: Array, data: Any) -> None:
        """Write a state into an MjData."""
        data.qpos[self.of_q] = state[self.of_v]
        for q, v in self.rotations:
            quaternion = self.reference[q : q + 4].copy()
            mujoco.mju_quatIntegrate(quaternion, state[v : v + 3].copy(), 1.0)
            data.qpos[q : q + 4] = quaternion
        data.qvel[:] = state[self.nv : 2 * self.nv]
        data.act[:] = state[2 * self.nv :]

    def chart(self, state: Array) -> Array:
        """Return the derivative of these coordinates by the tangent space at a state, states × states.

        It is the identity except for rotations: the logarithm of ``exp(φ)exp(δ)`` is ``φ + J⁻¹(φ)δ`` with the right Jacobian ``J`` of
        the rotation group (G. S. Chirikjian, Stochastic Models, Information Theory, and Lie Groups 2, 2012, section 10.8).
        """
        derivative = np.eye(self.size)
        for _, v in self.rotations:
            phi = state[v : v + 3]
            angle = float(np.linalg.norm(phi))
            cross = np.array([[0.0, -phi[2], phi[1]], [phi[2], 0.0, -phi[0]], [-phi[1], phi[0], 0.0]])
            # The factor is 1/angle² − (1 + cos angle)/(2 angle sin angle), which cancels for small angles.
            half = 0.5 * angle
            series = 1 / 12 + angle**2 / 720 + angle**4 / 30240
            factor = (1 - half / np.tan(half)) / angle**2 if angle > 1e-2 else series
            derivative[v : v + 3, v : v + 3] = np.eye(3) + 0.5 * cross + factor * cross @ cross
        return derivative
