"""Full model (A.25): translation and rotation of a sphere, Euler-parameter rates.

Made by `python -m derivation` from derivation/rigid_body.py; do not edit.
SymPy 1.14.0. 863 operations, 181 temporaries.

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
* [4] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [5] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [6] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
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
PARAMS = ("m", "I", "beta_v", "beta_w", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ("force", "moment", "force_gradient", "moment_gradient")


@njit(cache=True)
def rhs(state, force, moment, params, out):
    """Rate of change of the state.

    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (7) m, I, beta_v, beta_w, W1, W2, W3
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
    W1 = params[4]
    W2 = params[5]
    W3 = params[6]
    omega1 = 2.0 * e0 * edot1 - 2.0 * e1 * edot0 - 2.0 * e2 * edot3 + 2.0 * e3 * edot2
    omega2 = 2.0 * e0 * edot2 + 2.0 * e1 * edot3 - 2.0 * e2 * edot0 - 2.0 * e3 * edot1
    omega3 = 2.0 * e0 * edot3 - 2.0 * e1 * edot2 + 2.0 * e2 * edot1 - 2.0 * e3 * edot0
    x0 = 1.0 / m
    x1 = e2 * e2
    x2 = e3 * e3
    x3 = e0 * e0
    x4 = e1 * e1
    x5 = x3 + x4
    x6 = 1.0 / (x1 + x2 + x5)
    x7 = x6 * ((edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3))
    x8 = 1.0 / (4.0 * x1 + 4.0 * x2 + 4.0 * x3 + 4.0 * x4)
    x9 = 2.0 * e1
    x10 = 1.0 / I
    x11 = 2.0 * e0
    x12 = e3 * x11
    x13 = M2 * x6
    x14 = e2 * x11
    x15 = M3 * x6
    x16 = -x1
    x17 = -x2
    x18 = M1 * x6
    x19 = x10 * (
        -beta_w * omega1
        + x13 * (e2 * x9 + x12)
        + x15 * (2.0 * e1 * e3 - x14)
        + x18 * (x16 + x17 + x5)
    )
    x20 = 2.0 * e2
    x21 = e1 * x11
    x22 = x3 - x4
    x23 = x10 * (
        -beta_w * omega2
        + x13 * (x1 + x17 + x22)
        + x15 * (e3 * x20 + x21)
        + x18 * (2.0 * e1 * e2 - x12)
    )
    x24 = 2.0 * e3
    x25 = x10 * (
        -beta_w * omega3
        + x13 * (2.0 * e2 * e3 - x21)
        + x15 * (x16 + x2 + x22)
        + x18 * (e3 * x9 + x14)
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
    out[11] = -e1 * x7 + x8 * (x11 * x19 + x20 * x25 - x23 * x24)
    out[12] = -e2 * x7 + x8 * (x11 * x23 + x19 * x24 - x25 * x9)
    out[13] = -e3 * x7 + x8 * (x11 * x25 - x19 * x20 + x23 * x9)


@njit(cache=True)
def jacobian(state, force, moment, force_gradient, moment_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    params: (7) m, I, beta_v, beta_w, W1, W2, W3
    out: (14, 14) filled with the result.
    701 operations, 155 temporaries.
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
    x0 = 1.0 / m
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
    x15 = x2 + x4
    x16 = x15 + x6 + x8
    x17 = 1.0 / x16
    x18 = 1.0 / I
    x19 = 2.0 * e2
    x20 = x18 * x19
    x21 = x17 * x20
    x22 = e2 * x12
    x23 = 2.0 * e1
    x24 = e3 * x23
    x25 = x22 + x24
    x26 = 2.0 * e3
    x27 = x18 * x26
    x28 = x17 * x27
    x29 = -x6
    x30 = -x8
    x31 = x15 + x29 + x30
    x32 = x18 * x23
    x33 = x17 * x32
    x34 = x11 * (-x14 * x21 - x25 * x28 - x31 * x33)
    x35 = e2 * x23
    x36 = x13 + x35
    x37 = e1 * x12
    x38 = 2.0 * e2 * e3 - x37
    x39 = x2 - x4
    x40 = x30 + x39 + x6
    x41 = x11 * (-x21 * x40 - x28 * x38 - x33 * x36)
    x42 = 2.0 * e1 * e3 - x22
    x43 = e3 * x19
    x44 = x37 + x43
    x45 = x29 + x39 + x8
    x46 = x11 * (-x21 * x44 - x28 * x45 - x33 * x42)
    x47 = (edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3)
    x48 = -x17 * x47
    x49 = 1.0 / (x16 * x16)
    x50 = x47 * x49
    x51 = 2.0 * x50
    x52 = edot1 * x12
    x53 = edot0 * x23
    x54 = edot3 * x19
    x55 = edot2 * x26
    x56 = M2 * x17
    x57 = M3 * x17
    x58 = M1 * x17
    x59 = -beta_w * (x52 - x53 - x54 + x55) + x31 * x58 + x36 * x56 + x42 * x57
    x60 = edot2 * x12
    x61 = edot3 * x23
    x62 = edot0 * x19
    x63 = edot1 * x26
    x64 = -beta_w * (x60 + x61 - x62 - x63) + x14 * x58 + x40 * x56 + x44 * x57
    x65 = edot3 * x12
    x66 = edot2 * x23
    x67 = edot1 * x19
    x68 = edot0 * x26
    x69 = -beta_w * (x65 - x66 + x67 - x68) + x25 * x58 + x38 * x56 + x45 * x57
    x70 = 8.0 / (x10 * x10)
    x71 = x70 * (-x20 * x64 - x27 * x69 - x32 * x59)
    x72 = x12 * x49
    x73 = M1 * x72
    x74 = M2 * x72
    x75 = M3 * x72
    x76 = 2.0 * beta_w
    x77 = edot1 * x76
    x78 = x12 * x58
    x79 = x26 * x56
    x80 = x19 * x57
    x81 = x77 - x78 - x79 + x80
    x82 = -x31 * x73 - x36 * x74 - x42 * x75 - x81
    x83 = edot2 * x76
    x84 = x12 * x56
    x85 = x23 * x57
    x86 = x26 * x58
    x87 = x83 - x84 - x85 + x86
    x88 = -x14 * x73 - x40 * x74 - x44 * x75 - x87
    x89 = edot3 * x76
    x90 = x19 * x58
    x91 = x12 * x57
    x92 = x23 * x56
    x93 = x89 - x90 - x91 + x92
    x94 = -x25 * x73 - x38 * x74 - x45 * x75 - x93
    x95 = x37 * x50
    x96 = 2.0 * x18
    x97 = x59 * x96
    x98 = x23 * x49
    x99 = M1 * x98
    x100 = M2 * x98
    x101 = M3 * x98
    x102 = edot0 * x76 + x19 * x56 + x23 * x58 + x26 * x57
    x103 = -x100 * x36 - x101 * x42 + x102 - x31 * x99
    x104 = -x100 * x40 - x101 * x44 - x14 * x99 - x93
    x105 = -x100 * x38 - x101 * x45 - x25 * x99 + x83 - x84 - x85 + x86
    x106 = x22 * x50
    x107 = x64 * x96
    x108 = x19 * x49
    x109 = M2 * x108
    x110 = M3 * x108
    x111 = M1 * x108
    x112 = -x109 * x36 - x110 * x42 - x111 * x31 + x89 - x90 - x91 + x92
    x113 = x102 - x109 * x40 - x110 * x44 - x111 * x14
    x114 = -x109 * x38 - x110 * x45 - x111 * x25 - x81
    x115 = x13 * x50
    x116 = x69 * x96
    x117 = x26 * x49
    x118 = M1 * x117
    x119 = M2 * x117
    x120 = M3 * x117
    x121 = -x118 * x31 - x119 * x36 - x120 * x42 - x87
    x122 = -x118 * x14 - x119 * x40 - x120 * x44 + x77 - x78 - x79 + x80
    x123 = x102 - x118 * x25 - x119 * x38 - x120 * x45
    x124 = x12 * x17
    x125 = beta_w * x18
    x126 = x125 * x5
    x127 = x125 * x7
    x128 = x125 * x9
    x129 = x127 + x128
    x130 = -4.0 * beta_w * e0 * e1 * x11 * x18
    x131 = -4.0 * beta_w * e0 * e2 * x11 * x18
    x132 = -4.0 * beta_w * e0 * e3 * x11 * x18
    x133 = x124 * x18
    x134 = x11 * (x133 * x31 - x14 * x28 + x21 * x25)
    x135 = x11 * (x133 * x36 + x21 * x38 - x28 * x40)
    x136 = x11 * (x133 * x42 + x21 * x45 - x28 * x44)
    x137 = x12 * x18
    x138 = x70 * (x137 * x59 + x20 * x69 - x27 * x64)
    x139 = x35 * x50
    x140 = x24 * x50
    x141 = x125 * x3
    x142 = -4.0 * beta_w * e1 * e2 * x11 * x18
    x143 = -4.0 * beta_w * e1 * e3 * x11 * x18
    x144 = x11 * (x133 * x14 - x25 * x33 + x28 * x31)
    x145 = x11 * (x133 * x40 + x28 * x36 - x33 * x38)
    x146 = x11 * (x133 * x44 + x28 * x42 - x33 * x45)
    x147 = x70 * (x137 * x64 + x27 * x59 - x32 * x69)
    x148 = x43 * x50
    x149 = x126 + x141
    x150 = -4.0 * beta_w * e2 * e3 * x11 * x18
    x151 = x11 * (x133 * x25 + x14 * x33 - x21 * x31)
    x152 = x11 * (x133 * x38 - x21 * x36 + x33 * x40)
    x153 = x11 * (x133 * x45 - x21 * x42 + x33 * x44)
    x154 = x70 * (x137 * x69 - x20 * x59 + x32 * x64)
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
    out[10, 0] = DM11 * x34 + DM21 * x41 + DM31 * x46
    out[10, 1] = DM12 * x34 + DM22 * x41 + DM32 * x46
    out[10, 2] = DM13 * x34 + DM23 * x41 + DM33 * x46
    out[10, 3] = -e0 * x71 + x11 * (-x20 * x88 - x27 * x94 - x32 * x82) + x2 * x51 + x48
    out[10, 4] = -e1 * x71 + x11 * (-x103 * x32 - x104 * x20 - x105 * x27 - x97) + x95
    out[10, 5] = -e2 * x71 + x106 + x11 * (-x107 - x112 * x32 - x113 * x20 - x114 * x27)
    out[10, 6] = -e3 * x71 + x11 * (-x116 - x121 * x32 - x122 * x20 - x123 * x27) + x115
    out[10, 7] = 0.0
    out[10, 8] = 0.0
    out[10, 9] = 0.0
    out[10, 10] = -edot0 * x124 + x11 * (-x126 - x129)
    out[10, 11] = -x130 - x17 * x52
    out[10, 12] = -x131 - x17 * x60
    out[10, 13] = -x132 - x17 * x65
    out[11, 0] = DM11 * x134 + DM21 * x135 + DM31 * x136
    out[11, 1] = DM12 * x134 + DM22 * x135 + DM32 * x136
    out[11, 2] = DM13 * x134 + DM23 * x135 + DM33 * x136
    out[11, 3] = -e0 * x138 + x11 * (x137 * x82 + x20 * x94 - x27 * x88 + x97) + x95
    out[11, 4] = -e1 * x138 + x11 * (x103 * x137 - x104 * x27 + x105 * x20) + x4 * x51 + x48
    out[11, 5] = -e2 * x138 + x11 * (x112 * x137 - x113 * x27 + x114 * x20 + x116) + x139
    out[11, 6] = -e3 * x138 + x11 * (-x107 + x121 * x137 - x122 * x27 + x123 * x20) + x140
    out[11, 7] = 0.0
    out[11, 8] = 0.0
    out[11, 9] = 0.0
    out[11, 10] = -x130 - x17 * x53
    out[11, 11] = -edot1 * x17 * x23 + x11 * (-x129 - x141)
    out[11, 12] = -x142 - x17 * x66
    out[11, 13] = -x143 - x17 * x61
    out[12, 0] = DM11 * x144 + DM21 * x145 + DM31 * x146
    out[12, 1] = DM12 * x144 + DM22 * x145 + DM32 * x146
    out[12, 2] = DM13 * x144 + DM23 * x145 + DM33 * x146
    out[12, 3] = -e0 * x147 + x106 + x11 * (x107 + x137 * x88 + x27 * x82 - x32 * x94)
    out[12, 4] = -e1 * x147 + x11 * (x103 * x27 + x104 * x137 - x105 * x32 - x116) + x139
    out[12, 5] = -e2 * x147 + x11 * (x112 * x27 + x113 * x137 - x114 * x32) + x48 + x51 * x6
    out[12, 6] = -e3 * x147 + x11 * (x121 * x27 + x122 * x137 - x123 * x32 + x97) + x148
    out[12, 7] = 0.0
    out[12, 8] = 0.0
    out[12, 9] = 0.0
    out[12, 10] = -x131 - x17 * x62
    out[12, 11] = -x142 - x17 * x67
    out[12, 12] = -edot2 * x17 * x19 + x11 * (-x128 - x149)
    out[12, 13] = -x150 - x17 * x54
    out[13, 0] = DM11 * x151 + DM21 * x152 + DM31 * x153
    out[13, 1] = DM12 * x151 + DM22 * x152 + DM32 * x153
    out[13, 2] = DM13 * x151 + DM23 * x152 + DM33 * x153
    out[13, 3] = -e0 * x154 + x11 * (x116 + x137 * x94 - x20 * x82 + x32 * x88) + x115
    out[13, 4] = -e1 * x154 + x11 * (-x103 * x20 + x104 * x32 + x105 * x137 + x107) + x140
    out[13, 5] = -e2 * x154 + x11 * (-x112 * x20 + x113 * x32 + x114 * x137 - x97) + x148
    out[13, 6] = -e3 * x154 + x11 * (-x121 * x20 + x122 * x32 + x123 * x137) + x48 + x51 * x8
    out[13, 7] = 0.0
    out[13, 8] = 0.0
    out[13, 9] = 0.0
    out[13, 10] = -x132 - x17 * x68
    out[13, 11] = -x143 - x17 * x63
    out[13, 12] = -x150 - x17 * x55
    out[13, 13] = -edot3 * x17 * x26 + x11 * (-x127 - x149)


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, moment, params, out)
