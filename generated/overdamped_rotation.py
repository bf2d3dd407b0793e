"""Overdamped model (5.2): translation and rotation.

Made by `python -m derivation` from derivation/multiscale.py; do not edit.
SymPy 1.14.0. 523 operations, 122 temporaries.

Without inertia: the same for a sphere and for any other body of this drag.

State:

* [0] `q1` [m] position of the bead's centre along N1, (2.1)
* [1] `q2` [m] position of the bead's centre along N2, (2.1)
* [2] `q3` [m] position of the bead's centre along N3, (2.1)
* [3] `e0` [1] Euler parameter e0, (2.1)
* [4] `e1` [1] Euler parameter e1, (2.1)
* [5] `e2` [1] Euler parameter e2, (2.1)
* [6] `e3` [1] Euler parameter e3, (2.1)

Parameters:

* [0] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [1] `beta_w` [N m s] rotational drag coefficient, (2.15)
* [2] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [3] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [4] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3")
PARAMS = ("beta_v", "beta_w", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ("force", "moment", "force_gradient", "moment_gradient")


@njit(cache=True)
def rhs(state, force, moment, params, out):
    """Rate of change of the state.

    state: (7) q1, q2, q3, e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (5) beta_v, beta_w, W1, W2, W3
    out: (7) filled with the result.
    91 operations, 26 temporaries.
    """
    e0 = state[3]
    e1 = state[4]
    e2 = state[5]
    e3 = state[6]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    M1 = moment[0]
    M2 = moment[1]
    M3 = moment[2]
    beta_v = params[0]
    beta_w = params[1]
    W1 = params[2]
    W2 = params[3]
    W3 = params[4]
    x0 = 1.0 / beta_v
    x1 = 2.0 * e0
    x2 = e3 * x1
    x3 = 2.0 * e1
    x4 = e2 * e2
    x5 = e3 * e3
    x6 = e0 * e0
    x7 = e1 * e1
    x8 = x6 + x7
    x9 = 1.0 / (x4 + x5 + x8)
    x10 = M2 * x9
    x11 = e2 * x1
    x12 = M3 * x9
    x13 = -x4
    x14 = -x5
    x15 = M1 * x9
    x16 = (1.0 / 2.0) / beta_w
    x17 = x16 * (x10 * (e2 * x3 + x2) + x12 * (2.0 * e1 * e3 - x11) + x15 * (x13 + x14 + x8))
    x18 = e1 * x1
    x19 = x6 - x7
    x20 = x10 * (x14 + x19 + x4) + x12 * (2.0 * e2 * e3 + x18) + x15 * (2.0 * e1 * e2 - x2)
    x21 = e2 * x16
    x22 = x10 * (2.0 * e2 * e3 - x18) + x12 * (x13 + x19 + x5) + x15 * (e3 * x3 + x11)
    x23 = e3 * x16
    x24 = e0 * x16
    x25 = e1 * x16
    out[0] = x0 * (F1 + W1)
    out[1] = x0 * (F2 + W2)
    out[2] = x0 * (F3 + W3)
    out[3] = -e1 * x17 - x20 * x21 - x22 * x23
    out[4] = e0 * x17 - x20 * x23 + x21 * x22
    out[5] = e3 * x17 + x20 * x24 - x22 * x25
    out[6] = -e2 * x17 + x20 * x25 + x22 * x24


@njit(cache=True)
def jacobian(state, force, moment, force_gradient, moment_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    state: (7) q1, q2, q3, e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    params: (5) beta_v, beta_w, W1, W2, W3
    out: (7, 7) filled with the result.
    432 operations, 96 temporaries.
    """
    e0 = state[3]
    e1 = state[4]
    e2 = state[5]
    e3 = state[6]
    M1 = moment[0]
    M2 = moment[1]
    M3 = moment[2]
    DF11 = force_gradient[0, 0]
    DF12 = force_gradient[0, 1]
    DF13 = force_gradient[0, 2]
    DF21 = force_gradient[1, 0]
    DF22 = force_gradient[1, 1]
    DF23 = force_gradient[1, 2]
    DF31 = force_gradient[2, 0]
    DF32 = force_gradient[2, 1]
    DF33 = force_gradient[2, 2]
    DM11 = moment_gradient[0, 0]
    DM12 = moment_gradient[0, 1]
    DM13 = moment_gradient[0, 2]
    DM21 = moment_gradient[1, 0]
    DM22 = moment_gradient[1, 1]
    DM23 = moment_gradient[1, 2]
    DM31 = moment_gradient[2, 0]
    DM32 = moment_gradient[2, 1]
    DM33 = moment_gradient[2, 2]
    beta_v = params[0]
    beta_w = params[1]
    x0 = 1.0 / beta_v
    x1 = 2.0 * e0
    x2 = e3 * x1
    x3 = 2.0 * e1 * e2 - x2
    x4 = e2 * e2
    x5 = e3 * e3
    x6 = e0 * e0
    x7 = e1 * e1
    x8 = x6 + x7
    x9 = x4 + x5 + x8
    x10 = 1.0 / x9
    x11 = (1.0 / 2.0) / beta_w
    x12 = e2 * x11
    x13 = x10 * x12
    x14 = e2 * x1
    x15 = 2.0 * e1
    x16 = e3 * x15 + x14
    x17 = e3 * x11
    x18 = x10 * x17
    x19 = -x4
    x20 = -x5
    x21 = x19 + x20 + x8
    x22 = e1 * x11
    x23 = x10 * x22
    x24 = -x13 * x3 - x16 * x18 - x21 * x23
    x25 = e2 * x15 + x2
    x26 = e1 * x1
    x27 = 2.0 * e2 * e3 - x26
    x28 = x6 - x7
    x29 = x20 + x28 + x4
    x30 = -x13 * x29 - x18 * x27 - x23 * x25
    x31 = 2.0 * e1 * e3 - x14
    x32 = 2.0 * e2
    x33 = e3 * x32 + x26
    x34 = x19 + x28 + x5
    x35 = -x13 * x33 - x18 * x34 - x23 * x31
    x36 = 1.0 / (x9 * x9)
    x37 = x1 * x36
    x38 = M1 * x37
    x39 = M2 * x37
    x40 = M3 * x37
    x41 = M1 * x10
    x42 = x1 * x41
    x43 = M2 * x10
    x44 = 2.0 * e3
    x45 = x43 * x44
    x46 = M3 * x10
    x47 = x32 * x46
    x48 = -x42 - x45 + x47
    x49 = -x21 * x38 - x25 * x39 - x31 * x40 - x48
    x50 = x1 * x43
    x51 = x15 * x46
    x52 = x41 * x44
    x53 = -x50 - x51 + x52
    x54 = -x29 * x39 - x3 * x38 - x33 * x40 - x53
    x55 = x32 * x41
    x56 = x1 * x46
    x57 = x15 * x43
    x58 = -x55 - x56 + x57
    x59 = -x16 * x38 - x27 * x39 - x34 * x40 - x58
    x60 = x11 * (x21 * x41 + x25 * x43 + x31 * x46)
    x61 = x15 * x36
    x62 = M2 * x61
    x63 = M3 * x61
    x64 = M1 * x61
    x65 = (
        2.0 * M1 * e1 * x10
        + 2.0 * M2 * e2 * x10
        + 2.0 * M3 * e3 * x10
        - x21 * x64
        - x25 * x62
        - x31 * x63
    )
    x66 = -x29 * x62 - x3 * x64 - x33 * x63 - x58
    x67 = -x16 * x64 - x27 * x62 - x34 * x63 - x50 - x51 + x52
    x68 = x11 * (x29 * x43 + x3 * x41 + x33 * x46)
    x69 = x32 * x36
    x70 = M2 * x69
    x71 = M3 * x69
    x72 = M1 * x69
    x73 = -x21 * x72 - x25 * x70 - x31 * x71 - x55 - x56 + x57
    x74 = x15 * x41 + x32 * x43 + x44 * x46
    x75 = -x29 * x70 - x3 * x72 - x33 * x71 + x74
    x76 = -x16 * x72 - x27 * x70 - x34 * x71 - x48
    x77 = x11 * (x16 * x41 + x27 * x43 + x34 * x46)
    x78 = x36 * x44
    x79 = M1 * x78
    x80 = M2 * x78
    x81 = M3 * x78
    x82 = -x21 * x79 - x25 * x80 - x31 * x81 - x53
    x83 = -x29 * x80 - x3 * x79 - x33 * x81 - x42 - x45 + x47
    x84 = -x16 * x79 - x27 * x80 - x34 * x81 + x74
    x85 = e0 * x11
    x86 = x10 * x85
    x87 = x13 * x16 - x18 * x3 + x21 * x86
    x88 = x13 * x27 - x18 * x29 + x25 * x86
    x89 = x13 * x34 - x18 * x33 + x31 * x86
    x90 = -x16 * x23 + x18 * x21 + x3 * x86
    x91 = x18 * x25 - x23 * x27 + x29 * x86
    x92 = x18 * x31 - x23 * x34 + x33 * x86
    x93 = -x13 * x21 + x16 * x86 + x23 * x3
    x94 = -x13 * x25 + x23 * x29 + x27 * x86
    x95 = -x13 * x31 + x23 * x33 + x34 * x86
    out[0, 0] = DF11 * x0
    out[0, 1] = DF12 * x0
    out[0, 2] = DF13 * x0
    out[0, 3] = 0.0
    out[0, 4] = 0.0
    out[0, 5] = 0.0
    out[0, 6] = 0.0
    out[1, 0] = DF21 * x0
    out[1, 1] = DF22 * x0
    out[1, 2] = DF23 * x0
    out[1, 3] = 0.0
    out[1, 4] = 0.0
    out[1, 5] = 0.0
    out[1, 6] = 0.0
    out[2, 0] = DF31 * x0
    out[2, 1] = DF32 * x0
    out[2, 2] = DF33 * x0
    out[2, 3] = 0.0
    out[2, 4] = 0.0
    out[2, 5] = 0.0
    out[2, 6] = 0.0
    out[3, 0] = DM11 * x24 + DM21 * x30 + DM31 * x35
    out[3, 1] = DM12 * x24 + DM22 * x30 + DM32 * x35
    out[3, 2] = DM13 * x24 + DM23 * x30 + DM33 * x35
    out[3, 3] = -x12 * x54 - x17 * x59 - x22 * x49
    out[3, 4] = -x12 * x66 - x17 * x67 - x22 * x65 - x60
    out[3, 5] = -x12 * x75 - x17 * x76 - x22 * x73 - x68
    out[3, 6] = -x12 * x83 - x17 * x84 - x22 * x82 - x77
    out[4, 0] = DM11 * x87 + DM21 * x88 + DM31 * x89
    out[4, 1] = DM12 * x87 + DM22 * x88 + DM32 * x89
    out[4, 2] = DM13 * x87 + DM23 * x88 + DM33 * x89
    out[4, 3] = x12 * x59 - x17 * x54 + x49 * x85 + x60
    out[4, 4] = x12 * x67 - x17 * x66 + x65 * x85
    out[4, 5] = x12 * x76 - x17 * x75 + x73 * x85 + x77
    out[4, 6] = x12 * x84 - x17 * x83 - x68 + x82 * x85
    out[5, 0] = DM11 * x90 + DM21 * x91 + DM31 * x92
    out[5, 1] = DM12 * x90 + DM22 * x91 + DM32 * x92
    out[5, 2] = DM13 * x90 + DM23 * x91 + DM33 * x92
    out[5, 3] = x17 * x49 - x22 * x59 + x54 * x85 + x68
    out[5, 4] = x17 * x65 - x22 * x67 + x66 * x85 - x77
    out[5, 5] = x17 * x73 - x22 * x76 + x75 * x85
    out[5, 6] = x17 * x82 - x22 * x84 + x60 + x83 * x85
    out[6, 0] = DM11 * x93 + DM21 * x94 + DM31 * x95
    out[6, 1] = DM12 * x93 + DM22 * x94 + DM32 * x95
    out[6, 2] = DM13 * x93 + DM23 * x94 + DM33 * x95
    out[6, 3] = -x12 * x49 + x22 * x54 + x59 * x85 + x77
    out[6, 4] = -x12 * x65 + x22 * x66 + x67 * x85 + x68
    out[6, 5] = -x12 * x73 + x22 * x75 - x60 + x76 * x85
    out[6, 6] = -x12 * x82 + x22 * x83 + x84 * x85


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, moment, params, out)
