"""Rotation by Euler parameters (A.2)-(A.9).

Made by `python -m derivation` from derivation/euler_parameters.py; do not edit.
SymPy 1.14.0. 143 operations, 27 temporaries.

For e of any length but 0, where nothing else is said.
"""

import math

from numba import njit


@njit(cache=True)
def rotation_matrix(e, out):
    """R (A.2): body to inertial components.

    e: (4) e0, e1, e2, e3
    out: (3, 3) filled with the result.
    47 operations, 14 temporaries.
    """
    e0 = e[0]
    e1 = e[1]
    e2 = e[2]
    e3 = e[3]
    x0 = e2 * e2
    x1 = e3 * e3
    x2 = e0 * e0
    x3 = e1 * e1
    x4 = x2 + x3
    x5 = 1.0 / (x0 + x1 + x4)
    x6 = -x0
    x7 = -x1
    x8 = 2.0 * e0
    x9 = e3 * x8
    x10 = e2 * x8
    x11 = 2.0 * e1
    x12 = x2 - x3
    x13 = e1 * x8
    out[0, 0] = x5 * (x4 + x6 + x7)
    out[0, 1] = x5 * (2.0 * e1 * e2 - x9)
    out[0, 2] = x5 * (e3 * x11 + x10)
    out[1, 0] = x5 * (e2 * x11 + x9)
    out[1, 1] = x5 * (x0 + x12 + x7)
    out[1, 2] = x5 * (2.0 * e2 * e3 - x13)
    out[2, 0] = x5 * (2.0 * e1 * e3 - x10)
    out[2, 1] = x5 * (2.0 * e2 * e3 + x13)
    out[2, 2] = x5 * (x1 + x12 + x6)


@njit(cache=True)
def angular_velocity(e, edot, out):
    """omega = L e'/|e|^2 (A.7), body frame.

    e: (4) e0, e1, e2, e3
    edot: (4) edot0, edot1, edot2, edot3
    out: (3) filled with the result.
    36 operations, 5 temporaries.
    """
    e0 = e[0]
    e1 = e[1]
    e2 = e[2]
    e3 = e[3]
    edot0 = edot[0]
    edot1 = edot[1]
    edot2 = edot[2]
    edot3 = edot[3]
    x0 = 1.0 / ((e0 * e0) + (e1 * e1) + (e2 * e2) + (e3 * e3))
    x1 = 2.0 * edot1
    x2 = 2.0 * edot0
    x3 = 2.0 * edot3
    x4 = 2.0 * edot2
    out[0] = x0 * (e0 * x1 - e1 * x2 - e2 * x3 + e3 * x4)
    out[1] = x0 * (e0 * x4 + e1 * x3 - e2 * x2 - e3 * x1)
    out[2] = x0 * (e0 * x3 - e1 * x4 + e2 * x1 - e3 * x2)


@njit(cache=True)
def euler_rates(e, omega, out):
    """e' = L^T omega/4: the rates with e.e' = 0 (A.22).

    e: (4) e0, e1, e2, e3
    omega: (3) omega1, omega2, omega3
    out: (4) filled with the result.
    26 operations, 5 temporaries.
    """
    e0 = e[0]
    e1 = e[1]
    e2 = e[2]
    e3 = e[3]
    omega1 = omega[0]
    omega2 = omega[1]
    omega3 = omega[2]
    x0 = (1.0 / 2.0) * omega1
    x1 = (1.0 / 2.0) * e2
    x2 = (1.0 / 2.0) * e3
    x3 = (1.0 / 2.0) * e0
    x4 = (1.0 / 2.0) * e1
    out[0] = -e1 * x0 - omega2 * x1 - omega3 * x2
    out[1] = e0 * x0 - omega2 * x2 + omega3 * x1
    out[2] = e3 * x0 + omega2 * x3 - omega3 * x4
    out[3] = -e2 * x0 + omega2 * x4 + omega3 * x3


@njit(cache=True)
def project(e, edot, out):
    """n = e/|e| and its rate, which meet (A.21) and (A.22), in place of (A.26).

    e: (4) e0, e1, e2, e3
    edot: (4) edot0, edot1, edot2, edot3
    out: (8) filled with the result.
    34 operations, 3 temporaries.
    """
    e0 = e[0]
    e1 = e[1]
    e2 = e[2]
    e3 = e[3]
    edot0 = edot[0]
    edot1 = edot[1]
    edot2 = edot[2]
    edot3 = edot[3]
    x0 = (e0 * e0) + (e1 * e1) + (e2 * e2) + (e3 * e3)
    x1 = 1.0 / math.sqrt(x0)
    x2 = (e0 * edot0 + e1 * edot1 + e2 * edot2 + e3 * edot3) / x0
    out[0] = e0 * x1
    out[1] = e1 * x1
    out[2] = e2 * x1
    out[3] = e3 * x1
    out[4] = x1 * (-e0 * x2 + edot0)
    out[5] = x1 * (-e1 * x2 + edot1)
    out[6] = x1 * (-e2 * x2 + edot2)
    out[7] = x1 * (-e3 * x2 + edot3)
