"""The equations of motion written by hand from the thesis's pages, for real or complex states.

Nothing here comes from the derivation. `e` may have any length but 0 where the thesis's formulas
allow it. Fields are functions of position: `force(q)`, `moment(q)` (inertial frame), and their
gradients, which complex-step differentiation then sees.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np


def quaternion_product(a, b):
    return np.array(
        [
            a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
        ]
    )


def rotate(e, vector):
    """E (0, vector) e* / |e|^2: a vector of the body frame in the inertial frame."""
    conjugate = np.array([e[0], -e[1], -e[2], -e[3]])
    pure = np.concatenate([[0], vector])
    return quaternion_product(quaternion_product(e, pure), conjugate)[1:] / (e @ e)


def rotation_matrix(e):
    return np.stack([rotate(e, axis) for axis in np.eye(3)], axis=1)


def L_matrix(e):
    """(A.7) as printed."""
    e0, e1, e2, e3 = e
    return 2 * np.array([[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]])


@dataclass(frozen=True)
class Body:
    """Parameters of one body, in any consistent units.

    Its mobilities grow exponentially: b(q) = mobility * exp(growth q), in the order parallel,
    perpendicular, turn, spin, roll. The first-order model takes the uniform drag instead.
    """

    mass: float
    inertia: np.ndarray
    drag: float
    rotational_drag: float
    weight: np.ndarray
    a2: float = 1.0
    mobility: np.ndarray = dataclasses.field(default_factory=lambda: np.ones(5))
    growth: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((5, 3)))

    def mobilities(self, q):
        """(5,)"""
        return self.mobility * np.exp(self.growth @ q)

    def mobility_gradient(self, q):
        """(5, 3)"""
        return self.mobilities(q)[:, None] * self.growth

    def mobility_matrix(self, q):
        """(6, 6) velocity and angular velocity by force and moment, inertial frame."""
        parallel, perpendicular, turn, spin, roll = self.mobilities(q)
        matrix = np.diag([parallel, parallel, perpendicular, turn, turn, spin])
        matrix[0, 4] = matrix[4, 0] = roll
        matrix[1, 3] = matrix[3, 1] = -roll
        return matrix

    def parameters(self) -> dict[str, float]:
        """By the names that emitted modules use."""
        names = {"m": self.mass, "beta_v": self.drag, "beta_w": self.rotational_drag}
        names |= {"a2": self.a2, "I": self.inertia[0]}
        names |= {f"I{i + 1}": moment for i, moment in enumerate(self.inertia)}
        return names | {f"W{i + 1}": component for i, component in enumerate(self.weight)}


def solve_A24(body: Body, e, edot, moment_in_body_frame):
    """e'' from the 4x4 system (A.24): I-tilde e'' = M-tilde, solved numerically."""
    L = L_matrix(e)
    Ldot = L_matrix(edot)
    I = np.diag(body.inertia)
    w = L @ edot
    K = I @ Ldot @ edot + np.cross(w, I @ w)
    left = np.vstack([I @ L, e])
    right = np.append(moment_in_body_frame - K, -edot @ edot)
    return np.linalg.solve(left, right)


def accelerations(body: Body, field, q, e, v, w, a2):
    """v', and the whole moment in the body frame, by the inverse of the matrix of mobilities."""
    R = rotation_matrix(e)
    resisted = np.linalg.inv(body.mobility_matrix(q)) @ np.concatenate([v, R @ w])
    vdot = a2 * (field.force(q) + body.weight - resisted[:3]) / body.mass
    return vdot, a2 * R.T @ (field.moment(q) - resisted[3:])


def full(body: Body, field, state, *, a2: float = 1.0, rotates: bool = True):
    """(q', e', v', omega'), the state of the emitted `full` and `scaled` models."""
    if not rotates:
        q, v = state[:3], state[3:]
        resisted = v / np.diag(body.mobility_matrix(q))[:3]
        return np.concatenate([v, a2 * (field.force(q) + body.weight - resisted) / body.mass])
    q, e, v, w = state[:3], state[3:7], state[7:10], state[10:]
    vdot, moment = accelerations(body, field, q, e, v, w, a2)
    wdot = (moment - np.cross(w, body.inertia * w)) / body.inertia
    edot = quaternion_product(e, np.concatenate([[0], w])) / 2
    return np.concatenate([v, edot, vdot, wdot])


def full_by_A24(body: Body, field, state, *, a2: float = 1.0):
    """(q', e', v', e'') with e'' from the 4x4 solve; the thesis's state."""
    q, e, v, edot = state[:3], state[3:7], state[7:10], state[10:]
    vdot, moment = accelerations(body, field, q, e, v, L_matrix(e) @ edot, a2)
    return np.concatenate([v, edot, vdot, solve_A24(body, e, edot, moment)])


def overdamped(body: Body, field, state):
    """(q') or (q', e'), (5.2)."""
    q = state[:3]
    matrix, force = body.mobility_matrix(q), field.force(q) + body.weight
    if len(state) == 3:
        return matrix[:3, :3] @ force
    moved = matrix @ np.concatenate([force, field.moment(q)])
    e = state[3:]
    w = rotation_matrix(e).T @ moved[3:]
    return np.concatenate([moved[:3], quaternion_product(e, np.concatenate([[0], w])) / 2])


def first_order(body: Body, field, state):
    """(q') or (q', e'): the slow model, u - tau (Du) u, and the rotation likewise."""
    q = state[:3]
    u = (field.force(q) + body.weight) / body.drag
    velocity = u - body.mass / body.drag * (field.force_gradient(q) @ u) / body.drag
    if len(state) == 3:
        return velocity
    e = state[3:]
    to_body = rotation_matrix(e).T
    w0 = to_body @ field.moment(q) / body.rotational_drag
    w0_rate = to_body @ (field.moment_gradient(q) @ u) / body.rotational_drag
    w = w0 - (body.inertia * w0_rate + np.cross(w0, body.inertia * w0)) / body.rotational_drag
    return np.concatenate([velocity, quaternion_product(e, np.concatenate([[0], w])) / 2])


def complex_step_jacobian(function, state):
    """d(function)/d(state) to rounding: no difference is taken."""
    step = 1e-200
    columns = []
    for i in range(len(state)):
        shifted = np.array(state, dtype=complex)
        shifted[i] += 1j * step
        columns.append(function(shifted).imag / step)
    return np.stack(columns, axis=1)


@dataclass(frozen=True)
class QuadraticField:
    """Force and moment as quadratic forms of the position, with their exact derivatives."""

    c_force: np.ndarray
    """(3, 10): over 1, q1..q3, and the six products"""
    c_moment: np.ndarray

    def force(self, q):
        return self.c_force @ self._monomials(q)

    def moment(self, q):
        return self.c_moment @ self._monomials(q)

    def force_gradient(self, q):
        return self.c_force @ self._monomial_gradient(q)

    def moment_gradient(self, q):
        return self.c_moment @ self._monomial_gradient(q)

    def force_curvature(self, q, u):
        """Rate of the gradient along u: linear in u, as the gradient is linear in q."""
        return self.force_gradient(q + u) - self.force_gradient(q)

    def moment_curvature(self, q, u):
        return self.moment_gradient(q + u) - self.moment_gradient(q)

    @staticmethod
    def _monomials(q):
        x, y, z = q
        return np.array([1, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x])

    @staticmethod
    def _monomial_gradient(q):
        x, y, z = q
        o = 0 * x
        return np.array(
            [
                [o, o, o], [o + 1, o, o], [o, o + 1, o], [o, o, o + 1],
                [2 * x, o, o], [o, 2 * y, o], [o, o, 2 * z],
                [y, x, o], [o, z, y], [z, o, x],
            ]
        )  # fmt: skip
