"""Scaled model (4.17): translation and rotation of a sphere, Euler-parameter rates.

Made by `python -m derivation` from derivation/multiscale.py and derivation/rigid_body.py; do not edit.
SymPy 1.14.0. 870 operations, 185 temporaries.

The thesis's own state (e, e'), with (A.24) solved in closed form. The constraints (A.21)
and (A.22) hold along exact solutions only: project the state (`kinematics.project`).

State:

* [0] `q1` [m] position of the bead's centre along N1, (2.1)
* [1] `q2` [m] position of the bead's centre along N2, (2.1)
* [2] `q3` [m] position of the bead's centre along N3, (2.1)
* [3] `e0` [1] Euler parameter e0, (2.1)
* [4] `e1` [1] Euler parameter e1, (2.1)
* [5] `e2` [1] Euler parameter e2, (2.1)
* [6] `e3` [1] Euler parameter e3, (2.1)
* [7] `v1` [m/s] velocity of the bead's centre along N1, (2.2)
* [8] `v2` [m/s] velocity of the bead's centre along N2, (2.2)
* [9] `v3` [m/s] velocity of the bead's centre along N3, (2.2)
* [10] `edot0` [1/s] rate of Euler parameter e0, (2.2)
* [11] `edot1` [1/s] rate of Euler parameter e1, (2.2)
* [12] `edot2` [1/s] rate of Euler parameter e2, (2.2)
* [13] `edot3` [1/s] rate of Euler parameter e3, (2.2)

Parameters:

* [0] `m` [kg] mass of the bead, (2.3)
* [1] `I` [kg m^2] moment of inertia of the sphere, I_PP, (2.6)
* [2] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [3] `beta_w` [N m s] rotational drag coefficient, (2.15)
* [4] `a2` [1] scaling factor of the generalised active forces, (4.12)
* [5] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [6] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [7] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = (
    "q1",
    "q2",
    "q3",
    "e0",
    "e1",
    "e2",
    "e3",
    "v1",
    "v2",
    "v3",
    "edot0",
    "edot1",
    "edot2",
    "edot3",
)
PARAMS = ("m", "I", "beta_v", "beta_w", "a2", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ("force", "moment", "force_gradient", "moment_gradient")


@njit(cache=True)
def rhs(state, force, moment, params, out):
    """Rate of change of the state.

    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (8) m, I, beta_v, beta_w, a2, W1, W2, W3
    out: (14) filled with the result.
    162 operations, 26 temporaries.
    """
    e0 = state[3]
    e1 = state[4]
    e2 = state[5]
    e3 = state[6]
    v1 = state[7]
    v2 = state[8]
    v3 = state[9]
    edot0 = state[10]
    edot1 = state[11]
    edot2 = state[12]
    edot3 = state[13]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    M1 = moment[0]
    M2 = moment[1]
    M3 = moment[2]
    m = params[0]
    I = params[1]
    beta_v = params[2]
    beta_w = params[3]
    a2 = params[4]
    W1 = params[5]
    W2 = params[6]
    W3 = params[7]
    omega1 = 2.0 * e0 * edot1 - 2.0 * e1 * edot0 - 2.0 * e2 * edot3 + 2.0 * e3 * edot2
    omega2 = 2.0 * e0 * edot2 + 2.0 * e1 * edot3 - 2.0 * e2 * edot0 - 2.0 * e3 * edot1
    omega3 = 2.0 * e0 * edot3 - 2.0 * e1 * edot2 + 2.0 * e2 * edot1 - 2.0 * e3 * edot0
    x0 = a2 / m
    x1 = e2 * e2
    x2 = e3 * e3
    x3 = e0 * e0
    x4 = e1 * e1
    x5 = x3 + x4
    x6 = 1.0 / (x1 + x2 + x5)
    x7 = x6 * ((edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3))
    x8 = 1.0 / (4.0 * x1 + 4.0 * x2 + 4.0 * x3 + 4.0 * x4)
    x9 = 2.0 * e1
    x10 = 2.0 * e0
    x11 = e3 * x10
    x12 = M2 * x6
    x13 = e2 * x10
    x14 = M3 * x6
    x15 = -x1
    x16 = -x2
    x17 = M1 * x6
    x18 = a2 / I
    x19 = x18 * (
        -beta_w * omega1
        + x12 * (e2 * x9 + x11)
        + x14 * (2.0 * e1 * e3 - x13)
        + x17 * (x15 + x16 + x5)
    )
    x20 = 2.0 * e2
    x21 = e1 * x10
    x22 = x3 - x4
    x23 = x18 * (
        -beta_w * omega2
        + x12 * (x1 + x16 + x22)
        + x14 * (e3 * x20 + x21)
        + x17 * (2.0 * e1 * e2 - x11)
    )
    x24 = 2.0 * e3
    x25 = x18 * (
        -beta_w * omega3
        + x12 * (2.0 * e2 * e3 - x21)
        + x14 * (x15 + x2 + x22)
        + x17 * (e3 * x9 + x13)
    )
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = edot0
    out[4] = edot1
    out[5] = edot2
    out[6] = edot3
    out[7] = x0 * (F1 + W1 - beta_v * v1)
    out[8] = x0 * (F2 + W2 - beta_v * v2)
    out[9] = x0 * (F3 + W3 - beta_v * v3)
    out[10] = -e0 * x7 + x8 * (-x19 * x9 - x20 * x23 - x24 * x25)
    out[11] = -e1 * x7 + x8 * (x10 * x19 + x20 * x25 - x23 * x24)
    out[12] = -e2 * x7 + x8 * (x10 * x23 + x19 * x24 - x25 * x9)
    out[13] = -e3 * x7 + x8 * (x10 * x25 - x19 * x20 + x23 * x9)


@njit(cache=True)
def jacobian(state, force, moment, force_gradient, moment_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    params: (8) m, I, beta_v, beta_w, a2, W1, W2, W3
    out: (14, 14) filled with the result.
    708 operations, 159 temporaries.
    """
    e0 = state[3]
    e1 = state[4]
    e2 = state[5]
    e3 = state[6]
    edot0 = state[10]
    edot1 = state[11]
    edot2 = state[12]
    edot3 = state[13]
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
    m = params[0]
    I = params[1]
    beta_v = params[2]
    beta_w = params[3]
    a2 = params[4]
    x0 = a2 / m
    x1 = -beta_v * x0
    x2 = e0 * e0
    x3 = 4.0 * x2
    x4 = e1 * e1
    x5 = 4.0 * x4
    x6 = e2 * e2
    x7 = 4.0 * x6
    x8 = e3 * e3
    x9 = 4.0 * x8
    x10 = x3 + x5 + x7 + x9
    x11 = 1.0 / x10
    x12 = 2.0 * e0
    x13 = e3 * x12
    x14 = 2.0 * e1 * e2 - x13
    x15 = 1.0 / I
    x16 = a2 * x15
    x17 = x2 + x4
    x18 = x17 + x6 + x8
    x19 = 1.0 / x18
    x20 = 2.0 * e2
    x21 = x19 * x20
    x22 = x16 * x21
    x23 = e2 * x12
    x24 = 2.0 * e1
    x25 = e3 * x24
    x26 = x23 + x25
    x27 = 2.0 * e3
    x28 = x19 * x27
    x29 = x16 * x28
    x30 = -x6
    x31 = -x8
    x32 = x17 + x30 + x31
    x33 = x19 * x24
    x34 = x16 * x33
    x35 = x11 * (-x14 * x22 - x26 * x29 - x32 * x34)
    x36 = e2 * x24
    x37 = x13 + x36
    x38 = e1 * x12
    x39 = 2.0 * e2 * e3 - x38
    x40 = x2 - x4
    x41 = x31 + x40 + x6
    x42 = x11 * (-x22 * x41 - x29 * x39 - x34 * x37)
    x43 = 2.0 * e1 * e3 - x23
    x44 = e3 * x20
    x45 = x38 + x44
    x46 = x30 + x40 + x8
    x47 = x11 * (-x22 * x45 - x29 * x46 - x34 * x43)
    x48 = (edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3)
    x49 = -x19 * x48
    x50 = 1.0 / (x18 * x18)
    x51 = x48 * x50
    x52 = 2.0 * x51
    x53 = edot1 * x12
    x54 = edot0 * x24
    x55 = edot3 * x20
    x56 = edot2 * x27
    x57 = M2 * x19
    x58 = M3 * x19
    x59 = M1 * x19
    x60 = -beta_w * (x53 - x54 - x55 + x56) + x32 * x59 + x37 * x57 + x43 * x58
    x61 = x16 * x24
    x62 = edot2 * x12
    x63 = edot3 * x24
    x64 = edot0 * x20
    x65 = edot1 * x27
    x66 = -beta_w * (x62 + x63 - x64 - x65) + x14 * x59 + x41 * x57 + x45 * x58
    x67 = x16 * x20
    x68 = edot3 * x12
    x69 = edot2 * x24
    x70 = edot1 * x20
    x71 = edot0 * x27
    x72 = -beta_w * (x68 - x69 + x70 - x71) + x26 * x59 + x39 * x57 + x46 * x58
    x73 = x16 * x27
    x74 = 8.0 / (x10 * x10)
    x75 = x74 * (-x60 * x61 - x66 * x67 - x72 * x73)
    x76 = x12 * x50
    x77 = M1 * x76
    x78 = M2 * x76
    x79 = M3 * x76
    x80 = 2.0 * beta_w
    x81 = edot1 * x80
    x82 = x12 * x59
    x83 = x27 * x57
    x84 = x20 * x58
    x85 = x81 - x82 - x83 + x84
    x86 = -x32 * x77 - x37 * x78 - x43 * x79 - x85
    x87 = edot2 * x80
    x88 = x12 * x57
    x89 = x24 * x58
    x90 = x27 * x59
    x91 = x87 - x88 - x89 + x90
    x92 = -x14 * x77 - x41 * x78 - x45 * x79 - x91
    x93 = edot3 * x80
    x94 = x20 * x59
    x95 = x12 * x58
    x96 = x24 * x57
    x97 = x93 - x94 - x95 + x96
    x98 = -x26 * x77 - x39 * x78 - x46 * x79 - x97
    x99 = x38 * x51
    x100 = 2.0 * x16
    x101 = x100 * x60
    x102 = x24 * x50
    x103 = M1 * x102
    x104 = M2 * x102
    x105 = M3 * x102
    x106 = edot0 * x80 + x20 * x57 + x24 * x59 + x27 * x58
    x107 = -x103 * x32 - x104 * x37 - x105 * x43 + x106
    x108 = -x103 * x14 - x104 * x41 - x105 * x45 - x97
    x109 = -x103 * x26 - x104 * x39 - x105 * x46 + x87 - x88 - x89 + x90
    x110 = x23 * x51
    x111 = x100 * x66
    x112 = x20 * x50
    x113 = M2 * x112
    x114 = M3 * x112
    x115 = M1 * x112
    x116 = -x113 * x37 - x114 * x43 - x115 * x32 + x93 - x94 - x95 + x96
    x117 = x106 - x113 * x41 - x114 * x45 - x115 * x14
    x118 = -x113 * x39 - x114 * x46 - x115 * x26 - x85
    x119 = x13 * x51
    x120 = x100 * x72
    x121 = x27 * x50
    x122 = M1 * x121
    x123 = M2 * x121
    x124 = M3 * x121
    x125 = -x122 * x32 - x123 * x37 - x124 * x43 - x91
    x126 = -x122 * x14 - x123 * x41 - x124 * x45 + x81 - x82 - x83 + x84
    x127 = x106 - x122 * x26 - x123 * x39 - x124 * x46
    x128 = x12 * x19
    x129 = beta_w * x16
    x130 = x129 * x5
    x131 = x129 * x7
    x132 = x129 * x9
    x133 = x131 + x132
    x134 = -4.0 * a2 * beta_w * e0 * e1 * x11 * x15
    x135 = -4.0 * a2 * beta_w * e0 * e2 * x11 * x15
    x136 = -4.0 * a2 * beta_w * e0 * e3 * x11 * x15
    x137 = x128 * x16
    x138 = x11 * (x137 * x32 - x14 * x29 + x22 * x26)
    x139 = x11 * (x137 * x37 + x22 * x39 - x29 * x41)
    x140 = x11 * (x137 * x43 + x22 * x46 - x29 * x45)
    x141 = x12 * x16
    x142 = x74 * (x141 * x60 - x66 * x73 + x67 * x72)
    x143 = x36 * x51
    x144 = x25 * x51
    x145 = x129 * x3
    x146 = -4.0 * a2 * beta_w * e1 * e2 * x11 * x15
    x147 = -4.0 * a2 * beta_w * e1 * e3 * x11 * x15
    x148 = x11 * (x137 * x14 - x26 * x34 + x29 * x32)
    x149 = x11 * (x137 * x41 + x29 * x37 - x34 * x39)
    x150 = x11 * (x137 * x45 + x29 * x43 - x34 * x46)
    x151 = x74 * (x141 * x66 + x60 * x73 - x61 * x72)
    x152 = x44 * x51
    x153 = x130 + x145
    x154 = -4.0 * a2 * beta_w * e2 * e3 * x11 * x15
    x155 = x11 * (x137 * x26 + x14 * x34 - x22 * x32)
    x156 = x11 * (x137 * x39 - x22 * x37 + x34 * x41)
    x157 = x11 * (x137 * x46 - x22 * x43 + x34 * x45)
    x158 = x74 * (x141 * x72 - x60 * x67 + x61 * x66)
    out[0, 0] = 0.0
    out[0, 1] = 0.0
    out[0, 2] = 0.0
    out[0, 3] = 0.0
    out[0, 4] = 0.0
    out[0, 5] = 0.0
    out[0, 6] = 0.0
    out[0, 7] = 1.0
    out[0, 8] = 0.0
    out[0, 9] = 0.0
    out[0, 10] = 0.0
    out[0, 11] = 0.0
    out[0, 12] = 0.0
    out[0, 13] = 0.0
    out[1, 0] = 0.0
    out[1, 1] = 0.0
    out[1, 2] = 0.0
    out[1, 3] = 0.0
    out[1, 4] = 0.0
    out[1, 5] = 0.0
    out[1, 6] = 0.0
    out[1, 7] = 0.0
    out[1, 8] = 1.0
    out[1, 9] = 0.0
    out[1, 10] = 0.0
    out[1, 11] = 0.0
    out[1, 12] = 0.0
    out[1, 13] = 0.0
    out[2, 0] = 0.0
    out[2, 1] = 0.0
    out[2, 2] = 0.0
    out[2, 3] = 0.0
    out[2, 4] = 0.0
    out[2, 5] = 0.0
    out[2, 6] = 0.0
    out[2, 7] = 0.0
    out[2, 8] = 0.0
    out[2, 9] = 1.0
    out[2, 10] = 0.0
    out[2, 11] = 0.0
    out[2, 12] = 0.0
    out[2, 13] = 0.0
    out[3, 0] = 0.0
    out[3, 1] = 0.0
    out[3, 2] = 0.0
    out[3, 3] = 0.0
    out[3, 4] = 0.0
    out[3, 5] = 0.0
    out[3, 6] = 0.0
    out[3, 7] = 0.0
    out[3, 8] = 0.0
    out[3, 9] = 0.0
    out[3, 10] = 1.0
    out[3, 11] = 0.0
    out[3, 12] = 0.0
    out[3, 13] = 0.0
    out[4, 0] = 0.0
    out[4, 1] = 0.0
    out[4, 2] = 0.0
    out[4, 3] = 0.0
    out[4, 4] = 0.0
    out[4, 5] = 0.0
    out[4, 6] = 0.0
    out[4, 7] = 0.0
    out[4, 8] = 0.0
    out[4, 9] = 0.0
    out[4, 10] = 0.0
    out[4, 11] = 1.0
    out[4, 12] = 0.0
    out[4, 13] = 0.0
    out[5, 0] = 0.0
    out[5, 1] = 0.0
    out[5, 2] = 0.0
    out[5, 3] = 0.0
    out[5, 4] = 0.0
    out[5, 5] = 0.0
    out[5, 6] = 0.0
    out[5, 7] = 0.0
    out[5, 8] = 0.0
    out[5, 9] = 0.0
    out[5, 10] = 0.0
    out[5, 11] = 0.0
    out[5, 12] = 1.0
    out[5, 13] = 0.0
    out[6, 0] = 0.0
    out[6, 1] = 0.0
    out[6, 2] = 0.0
    out[6, 3] = 0.0
    out[6, 4] = 0.0
    out[6, 5] = 0.0
    out[6, 6] = 0.0
    out[6, 7] = 0.0
    out[6, 8] = 0.0
    out[6, 9] = 0.0
    out[6, 10] = 0.0
    out[6, 11] = 0.0
    out[6, 12] = 0.0
    out[6, 13] = 1.0
    out[7, 0] = DF11 * x0
    out[7, 1] = DF12 * x0
    out[7, 2] = DF13 * x0
    out[7, 3] = 0.0
    out[7, 4] = 0.0
    out[7, 5] = 0.0
    out[7, 6] = 0.0
    out[7, 7] = x1
    out[7, 8] = 0.0
    out[7, 9] = 0.0
    out[7, 10] = 0.0
    out[7, 11] = 0.0
    out[7, 12] = 0.0
    out[7, 13] = 0.0
    out[8, 0] = DF21 * x0
    out[8, 1] = DF22 * x0
    out[8, 2] = DF23 * x0
    out[8, 3] = 0.0
    out[8, 4] = 0.0
    out[8, 5] = 0.0
    out[8, 6] = 0.0
    out[8, 7] = 0.0
    out[8, 8] = x1
    out[8, 9] = 0.0
    out[8, 10] = 0.0
    out[8, 11] = 0.0
    out[8, 12] = 0.0
    out[8, 13] = 0.0
    out[9, 0] = DF31 * x0
    out[9, 1] = DF32 * x0
    out[9, 2] = DF33 * x0
    out[9, 3] = 0.0
    out[9, 4] = 0.0
    out[9, 5] = 0.0
    out[9, 6] = 0.0
    out[9, 7] = 0.0
    out[9, 8] = 0.0
    out[9, 9] = x1
    out[9, 10] = 0.0
    out[9, 11] = 0.0
    out[9, 12] = 0.0
    out[9, 13] = 0.0
    out[10, 0] = DM11 * x35 + DM21 * x42 + DM31 * x47
    out[10, 1] = DM12 * x35 + DM22 * x42 + DM32 * x47
    out[10, 2] = DM13 * x35 + DM23 * x42 + DM33 * x47
    out[10, 3] = -e0 * x75 + x11 * (-x61 * x86 - x67 * x92 - x73 * x98) + x2 * x52 + x49
    out[10, 4] = -e1 * x75 + x11 * (-x101 - x107 * x61 - x108 * x67 - x109 * x73) + x99
    out[10, 5] = -e2 * x75 + x11 * (-x111 - x116 * x61 - x117 * x67 - x118 * x73) + x110
    out[10, 6] = -e3 * x75 + x11 * (-x120 - x125 * x61 - x126 * x67 - x127 * x73) + x119
    out[10, 7] = 0.0
    out[10, 8] = 0.0
    out[10, 9] = 0.0
    out[10, 10] = -edot0 * x128 + x11 * (-x130 - x133)
    out[10, 11] = -x134 - x19 * x53
    out[10, 12] = -x135 - x19 * x62
    out[10, 13] = -x136 - x19 * x68
    out[11, 0] = DM11 * x138 + DM21 * x139 + DM31 * x140
    out[11, 1] = DM12 * x138 + DM22 * x139 + DM32 * x140
    out[11, 2] = DM13 * x138 + DM23 * x139 + DM33 * x140
    out[11, 3] = -e0 * x142 + x11 * (x101 + x141 * x86 + x67 * x98 - x73 * x92) + x99
    out[11, 4] = -e1 * x142 + x11 * (x107 * x141 - x108 * x73 + x109 * x67) + x4 * x52 + x49
    out[11, 5] = -e2 * x142 + x11 * (x116 * x141 - x117 * x73 + x118 * x67 + x120) + x143
    out[11, 6] = -e3 * x142 + x11 * (-x111 + x125 * x141 - x126 * x73 + x127 * x67) + x144
    out[11, 7] = 0.0
    out[11, 8] = 0.0
    out[11, 9] = 0.0
    out[11, 10] = -x134 - x19 * x54
    out[11, 11] = -edot1 * x33 + x11 * (-x133 - x145)
    out[11, 12] = -x146 - x19 * x69
    out[11, 13] = -x147 - x19 * x63
    out[12, 0] = DM11 * x148 + DM21 * x149 + DM31 * x150
    out[12, 1] = DM12 * x148 + DM22 * x149 + DM32 * x150
    out[12, 2] = DM13 * x148 + DM23 * x149 + DM33 * x150
    out[12, 3] = -e0 * x151 + x11 * (x111 + x141 * x92 - x61 * x98 + x73 * x86) + x110
    out[12, 4] = -e1 * x151 + x11 * (x107 * x73 + x108 * x141 - x109 * x61 - x120) + x143
    out[12, 5] = -e2 * x151 + x11 * (x116 * x73 + x117 * x141 - x118 * x61) + x49 + x52 * x6
    out[12, 6] = -e3 * x151 + x11 * (x101 + x125 * x73 + x126 * x141 - x127 * x61) + x152
    out[12, 7] = 0.0
    out[12, 8] = 0.0
    out[12, 9] = 0.0
    out[12, 10] = -x135 - x19 * x64
    out[12, 11] = -x146 - x19 * x70
    out[12, 12] = -edot2 * x21 + x11 * (-x132 - x153)
    out[12, 13] = -x154 - x19 * x55
    out[13, 0] = DM11 * x155 + DM21 * x156 + DM31 * x157
    out[13, 1] = DM12 * x155 + DM22 * x156 + DM32 * x157
    out[13, 2] = DM13 * x155 + DM23 * x156 + DM33 * x157
    out[13, 3] = -e0 * x158 + x11 * (x120 + x141 * x98 + x61 * x92 - x67 * x86) + x119
    out[13, 4] = -e1 * x158 + x11 * (-x107 * x67 + x108 * x61 + x109 * x141 + x111) + x144
    out[13, 5] = -e2 * x158 + x11 * (-x101 - x116 * x67 + x117 * x61 + x118 * x141) + x152
    out[13, 6] = -e3 * x158 + x11 * (-x125 * x67 + x126 * x61 + x127 * x141) + x49 + x52 * x8
    out[13, 7] = 0.0
    out[13, 8] = 0.0
    out[13, 9] = 0.0
    out[13, 10] = -x136 - x19 * x71
    out[13, 11] = -x147 - x19 * x65
    out[13, 12] = -x154 - x19 * x56
    out[13, 13] = -edot3 * x28 + x11 * (-x131 - x153)


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, moment, params, out)
