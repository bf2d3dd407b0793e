"""Drag of a body in a fluid that is the same all around N3, as beside a plane wall across N3.

The mobilities of a body to which a force F and a moment M are applied, n = N3:

    v = b_parallel F + (b_perpendicular - b_parallel) (n.F) n + b_roll M x n,
    w = b_turn M + (b_spin - b_turn) (n.M) n + b_roll n x F.

They may depend on the place. The drag is what balances F and M at the velocities v and w: minus the
inverse of that. Far from everything b_parallel = b_perpendicular = 1/beta_v,
b_turn = b_spin = 1/beta_w and b_roll = 0, which is Stokes's drag (2.13)-(2.14).
"""

from __future__ import annotations

import sympy as sp

from .equations import Equation
from .euler_parameters import R, omega
from .rigid_body import F_others, M_others, m, v
from .symbols import MOBILITY, MOMENT, vector

b_parallel, b_perpendicular, b_turn, b_spin, b_roll = vector(MOBILITY)

#: N3 in inertial components, and in the body's
n = sp.Matrix([0, 0, 1])
n_body = R.T * n


def _along(axis: sp.MatrixBase, x: sp.MatrixBase) -> sp.MatrixBase:
    return axis.dot(x) * axis


def velocity(force: sp.MatrixBase, moment: sp.MatrixBase, axis: sp.MatrixBase) -> sp.MatrixBase:
    """v of a body without inertia, from components of one frame."""
    along = _along(axis, force)
    return b_parallel * (force - along) + b_perpendicular * along + b_roll * moment.cross(axis)


def angular_velocity(
    force: sp.MatrixBase, moment: sp.MatrixBase, axis: sp.MatrixBase
) -> sp.MatrixBase:
    """w of a body without inertia, from components of one frame.

    Written so that the axis drops out to the last bit where b_spin = b_turn.
    """
    about = (b_spin - b_turn) * _along(axis, moment)
    return b_turn * moment + about + b_roll * axis.cross(force)


#: the inverse of the block (b_parallel, b_roll; b_roll, b_turn)
_determinant = b_parallel * b_turn - b_roll**2
z_parallel, z_turn, z_roll = (
    b_turn / _determinant,
    b_parallel / _determinant,
    -b_roll / _determinant,
)


def force(v: sp.MatrixBase, w: sp.MatrixBase, axis: sp.MatrixBase) -> sp.MatrixBase:
    """Drag on the centre, from components of one frame: (2.13) for Stokes's drag."""
    along = _along(axis, v)
    return -(z_parallel * (v - along) + along / b_perpendicular + z_roll * w.cross(axis))


def moment(v: sp.MatrixBase, w: sp.MatrixBase, axis: sp.MatrixBase) -> sp.MatrixBase:
    """Drag on the rotation, from components of one frame: (2.14) for Stokes's drag.

    Written as `angular_velocity` is.
    """
    about = (1 / b_spin - z_turn) * _along(axis, w)
    return -(z_turn * w + about + z_roll * axis.cross(v))


#: Newton's equation (A.12) of a body that turns
acceleration = (F_others + force(v, R * omega, n)) / m
#: drag on the rotation, body frame
drag_moment = moment(R.T * v, omega, n_body)

#: Newton's equation of a body free to turn whose rotation is not followed: no moment acts on it
acceleration_without_rotation = (
    F_others - (v - _along(n, v)) / b_parallel - _along(n, v) / b_perpendicular
) / m

#: (5.2): the velocity, and the angular velocity in the body frame
overdamped_velocity = velocity(F_others, vector(MOMENT), n)
overdamped_angular_velocity = angular_velocity(R.T * F_others, M_others, n_body)
overdamped_velocity_without_rotation = velocity(F_others, sp.zeros(3, 1), n)

MOBILITIES = Equation(
    "-",
    "velocity and angular velocity of a body beside a wall across N3",
    r"\begin{pmatrix}\mathbf{v}\\ \boldsymbol{\omega}\end{pmatrix}",
    overdamped_velocity.col_join(angular_velocity(F_others, vector(MOMENT), n)).applyfunc(
        sp.expand
    ),
)
