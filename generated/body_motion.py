"""Inertial forces and moments of a body of any shape (Kirchhoff).

Made by `python -m derivation` from derivation/body_motion.py; do not edit.
SymPy 1.14.0. 365 operations, 60 temporaries.

Of the symmetric matrix of inertia the upper triangle is read.
"""

from numba import njit


@njit(cache=True)
def kirchhoff(velocity, inertia, out):
    """N(V) = (omega x p, omega x l + u x p) with (p, l) = M V, body frame.

    velocity: (6) u1, u2, u3, omega1, omega2, omega3
    inertia: (6, 6) as listed above
    out: (6) filled with the result.
    96 operations, 6 temporaries.
    """
    u1 = velocity[0]
    u2 = velocity[1]
    u3 = velocity[2]
    omega1 = velocity[3]
    omega2 = velocity[4]
    omega3 = velocity[5]
    M11 = inertia[0, 0]
    M12 = inertia[0, 1]
    M13 = inertia[0, 2]
    M14 = inertia[0, 3]
    M15 = inertia[0, 4]
    M16 = inertia[0, 5]
    M22 = inertia[1, 1]
    M23 = inertia[1, 2]
    M24 = inertia[1, 3]
    M25 = inertia[1, 4]
    M26 = inertia[1, 5]
    M33 = inertia[2, 2]
    M34 = inertia[2, 3]
    M35 = inertia[2, 4]
    M36 = inertia[2, 5]
    M44 = inertia[3, 3]
    M45 = inertia[3, 4]
    M46 = inertia[3, 5]
    M55 = inertia[4, 4]
    M56 = inertia[4, 5]
    M66 = inertia[5, 5]
    x0 = M13 * u1 + M23 * u2 + M33 * u3 + M34 * omega1 + M35 * omega2 + M36 * omega3
    x1 = M12 * u1 + M22 * u2 + M23 * u3 + M24 * omega1 + M25 * omega2 + M26 * omega3
    x2 = M11 * u1 + M12 * u2 + M13 * u3 + M14 * omega1 + M15 * omega2 + M16 * omega3
    x3 = M16 * u1 + M26 * u2 + M36 * u3 + M46 * omega1 + M56 * omega2 + M66 * omega3
    x4 = M15 * u1 + M25 * u2 + M35 * u3 + M45 * omega1 + M55 * omega2 + M56 * omega3
    x5 = M14 * u1 + M24 * u2 + M34 * u3 + M44 * omega1 + M45 * omega2 + M46 * omega3
    out[0] = omega2 * x0 - omega3 * x1
    out[1] = -omega1 * x0 + omega3 * x2
    out[2] = omega1 * x1 - omega2 * x2
    out[3] = omega2 * x3 - omega3 * x4 + u2 * x0 - u3 * x1
    out[4] = -omega1 * x3 + omega3 * x5 - u1 * x0 + u3 * x2
    out[5] = omega1 * x4 - omega2 * x5 + u1 * x1 - u2 * x2


@njit(cache=True)
def kirchhoff_gradient(velocity, inertia, out):
    """dN/dV: out[i, j] = dN_i/dV_j.

    velocity: (6) u1, u2, u3, omega1, omega2, omega3
    inertia: (6, 6) as listed above
    out: (6, 6) filled with the result.
    269 operations, 54 temporaries.
    """
    u1 = velocity[0]
    u2 = velocity[1]
    u3 = velocity[2]
    omega1 = velocity[3]
    omega2 = velocity[4]
    omega3 = velocity[5]
    M11 = inertia[0, 0]
    M12 = inertia[0, 1]
    M13 = inertia[0, 2]
    M14 = inertia[0, 3]
    M15 = inertia[0, 4]
    M16 = inertia[0, 5]
    M22 = inertia[1, 1]
    M23 = inertia[1, 2]
    M24 = inertia[1, 3]
    M25 = inertia[1, 4]
    M26 = inertia[1, 5]
    M33 = inertia[2, 2]
    M34 = inertia[2, 3]
    M35 = inertia[2, 4]
    M36 = inertia[2, 5]
    M44 = inertia[3, 3]
    M45 = inertia[3, 4]
    M46 = inertia[3, 5]
    M55 = inertia[4, 4]
    M56 = inertia[4, 5]
    M66 = inertia[5, 5]
    x0 = M12 * omega3
    x1 = M13 * omega2
    x2 = M24 * omega3
    x3 = M34 * omega2
    x4 = M35 * omega2
    x5 = M13 * u1
    x6 = M23 * u2
    x7 = M33 * u3
    x8 = M36 * omega3
    x9 = x5 + x6 + x7 + x8
    x10 = M34 * omega1
    x11 = -M25 * omega3 + x10
    x12 = M26 * omega3
    x13 = M12 * u1
    x14 = M22 * u2
    x15 = M23 * u3
    x16 = M25 * omega2
    x17 = x13 + x14 + x15 + x16
    x18 = M24 * omega1
    x19 = -M36 * omega2 + x18
    x20 = -M23 * omega1
    x21 = -M14 * omega3 + x4
    x22 = M15 * omega3
    x23 = -M35 * omega1
    x24 = M16 * omega3
    x25 = M11 * u1
    x26 = M12 * u2
    x27 = M13 * u3
    x28 = M14 * omega1
    x29 = x25 + x26 + x27 + x28
    x30 = M15 * omega2
    x31 = -M36 * omega1 + x30
    x32 = -M14 * omega2 + x12
    x33 = -M25 * omega1 + x24
    x34 = M16 * omega2
    x35 = -M26 * omega1
    x36 = M12 * u3
    x37 = M13 * u2
    x38 = x7 + x8
    x39 = x14 + x16
    x40 = M45 * omega3
    x41 = M46 * omega2
    x42 = M46 * omega1
    x43 = M56 * omega2
    x44 = M16 * u1 + M26 * u2 + M36 * u3 + M66 * omega3
    x45 = M45 * omega1
    x46 = M56 * omega3
    x47 = M15 * u1 + M25 * u2 + M35 * u3 + M55 * omega2
    x48 = -M23 * u1
    x49 = x25 + x28
    x50 = -M56 * omega1
    x51 = M45 * omega2
    x52 = M46 * omega3
    x53 = M14 * u1 + M24 * u2 + M34 * u3 + M44 * omega1
    out[0, 0] = -x0 + x1
    out[0, 1] = -M22 * omega3 + M23 * omega2
    out[0, 2] = -M23 * omega3 + M33 * omega2
    out[0, 3] = -x2 + x3
    out[0, 4] = x11 + 2.0 * x4 + x9
    out[0, 5] = -2.0 * x12 - x17 - x19
    out[1, 0] = M11 * omega3 - M13 * omega1
    out[1, 1] = x0 + x20
    out[1, 2] = M13 * omega3 - M33 * omega1
    out[1, 3] = -2.0 * x10 - x21 - x9
    out[1, 4] = x22 + x23
    out[1, 5] = 2.0 * x24 + x29 + x31
    out[2, 0] = -M11 * omega2 + M12 * omega1
    out[2, 1] = -M12 * omega2 + M22 * omega1
    out[2, 2] = -x1 - x20
    out[2, 3] = x17 + 2.0 * x18 + x32
    out[2, 4] = -x29 - 2.0 * x30 - x33
    out[2, 5] = -x34 - x35
    out[3, 0] = -x22 + x34 - x36 + x37
    out[3, 1] = -M22 * u3 + M26 * omega2 + x11 + x38 + x4 + x5 + 2.0 * x6
    out[3, 2] = M33 * u2 - M35 * omega3 - x12 - x13 - 2.0 * x15 - x19 - x39
    out[3, 3] = -M24 * u3 + M34 * u2 - x40 + x41
    out[3, 4] = -M25 * u3 + M35 * u2 - M55 * omega3 + x42 + 2.0 * x43 + x44
    out[3, 5] = -M26 * u3 + M36 * u2 + M66 * omega2 - x45 - 2.0 * x46 - x47
    out[4, 0] = M11 * u3 - M16 * omega1 - x10 - x21 - x38 - 2.0 * x5 - x6
    out[4, 1] = x2 + x35 + x36 + x48
    out[4, 2] = -M33 * u1 + M34 * omega3 + x24 + x26 + 2.0 * x27 + x31 + x49
    out[4, 3] = M14 * u3 - M34 * u1 + M44 * omega3 - 2.0 * x42 - x43 - x44
    out[4, 4] = M15 * u3 - M35 * u1 + x40 + x50
    out[4, 5] = M16 * u3 - M36 * u1 - M66 * omega1 + x51 + 2.0 * x52 + x53
    out[5, 0] = -M11 * u2 + M15 * omega1 + 2.0 * x13 + x15 + x18 + x32 + x39
    out[5, 1] = M22 * u1 - M24 * omega2 - 2.0 * x26 - x27 - x30 - x33 - x49
    out[5, 2] = -x23 - x3 - x37 - x48
    out[5, 3] = -M14 * u2 + M24 * u1 - M44 * omega2 + 2.0 * x45 + x46 + x47
    out[5, 4] = -M15 * u2 + M25 * u1 + M55 * omega1 - 2.0 * x51 - x52 - x53
    out[5, 5] = -M16 * u2 + M26 * u1 - x41 - x50
