"""First-order slow model: sphere.

Made by `python -m derivation` from derivation/multiscale.py; do not edit.
SymPy 1.14.0. 1408 operations, 274 temporaries.

The expansion (4.11) solved to order epsilon: q' = u - tau (Du) u with
u = (F + W)/beta_v and tau = m/beta_v. Free of stiffness.

State:

* [0] `q1` [m] position of the bead's centre along N1, (2.1)
* [1] `q2` [m] position of the bead's centre along N2, (2.1)
* [2] `q3` [m] position of the bead's centre along N3, (2.1)
* [3] `e0` [1] Euler parameter e0, (2.1)
* [4] `e1` [1] Euler parameter e1, (2.1)
* [5] `e2` [1] Euler parameter e2, (2.1)
* [6] `e3` [1] Euler parameter e3, (2.1)

Parameters:

* [0] `m` [kg] mass of the bead, (2.3)
* [1] `I` [kg m^2] moment of inertia of the sphere, I_PP, (2.6)
* [2] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [3] `beta_w` [N m s] rotational drag coefficient, (2.15)
* [4] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [5] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [6] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

import math

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3")
PARAMS = ("m", "I", "beta_v", "beta_w", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment", "force_gradient", "moment_gradient")
JACOBIAN_INPUTS = (
    "force",
    "moment",
    "force_gradient",
    "moment_gradient",
    "force_curvature",
    "moment_curvature",
)
LINEAR_DRAG = False


@njit(cache=True)
def rhs(t, state, force, moment, force_gradient, moment_gradient, params, out):
    """Rate of change of the state.

    t: time since release [s]
    state: (7) q1, q2, q3, e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    params: (7) m, I, beta_v, beta_w, W1, W2, W3
    out: (7) filled with the result.
    197 operations, 34 temporaries.
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
    W1 = params[4]
    W2 = params[5]
    W3 = params[6]
    Fdot1 = DF11 * (F1 + W1) / beta_v + DF12 * (F2 + W2) / beta_v + DF13 * (F3 + W3) / beta_v
    Fdot2 = DF21 * (F1 + W1) / beta_v + DF22 * (F2 + W2) / beta_v + DF23 * (F3 + W3) / beta_v
    Fdot3 = DF31 * (F1 + W1) / beta_v + DF32 * (F2 + W2) / beta_v + DF33 * (F3 + W3) / beta_v
    Mdot1 = DM11 * (F1 + W1) / beta_v + DM12 * (F2 + W2) / beta_v + DM13 * (F3 + W3) / beta_v
    Mdot2 = DM21 * (F1 + W1) / beta_v + DM22 * (F2 + W2) / beta_v + DM23 * (F3 + W3) / beta_v
    Mdot3 = DM31 * (F1 + W1) / beta_v + DM32 * (F2 + W2) / beta_v + DM33 * (F3 + W3) / beta_v
    x0 = m / (beta_v * beta_v)
    x1 = 1.0 / beta_v
    x2 = 1.0 / beta_w
    x3 = e2 * e2
    x4 = e3 * e3
    x5 = e0 * e0
    x6 = e1 * e1
    x7 = x5 + x6
    x8 = 1.0 / (x3 + x4 + x7)
    x9 = 2.0 * e0
    x10 = e3 * x9
    x11 = 2.0 * e1
    x12 = x8 * (e2 * x11 + x10)
    x13 = e2 * x9
    x14 = x8 * (2.0 * e1 * e3 - x13)
    x15 = -x3
    x16 = -x4
    x17 = x8 * (x15 + x16 + x7)
    x18 = I / (beta_w * beta_w)
    x19 = -1.0 / 2.0 * x18 * (Mdot1 * x17 + Mdot2 * x12 + Mdot3 * x14) + (1.0 / 2.0) * x2 * (
        M1 * x17 + M2 * x12 + M3 * x14
    )
    x20 = x8 * (2.0 * e1 * e2 - x10)
    x21 = e1 * x9
    x22 = x8 * (2.0 * e2 * e3 + x21)
    x23 = x5 - x6
    x24 = x8 * (x16 + x23 + x3)
    x25 = -x18 * (Mdot1 * x20 + Mdot2 * x24 + Mdot3 * x22) + x2 * (M1 * x20 + M2 * x24 + M3 * x22)
    x26 = (1.0 / 2.0) * e2
    x27 = x8 * (e3 * x11 + x13)
    x28 = x8 * (2.0 * e2 * e3 - x21)
    x29 = x8 * (x15 + x23 + x4)
    x30 = -x18 * (Mdot1 * x27 + Mdot2 * x28 + Mdot3 * x29) + x2 * (M1 * x27 + M2 * x28 + M3 * x29)
    x31 = (1.0 / 2.0) * e3
    x32 = (1.0 / 2.0) * e0
    x33 = (1.0 / 2.0) * e1
    out[0] = -Fdot1 * x0 + x1 * (F1 + W1)
    out[1] = -Fdot2 * x0 + x1 * (F2 + W2)
    out[2] = -Fdot3 * x0 + x1 * (F3 + W3)
    out[3] = -e1 * x19 - x25 * x26 - x30 * x31
    out[4] = e0 * x19 - x25 * x31 + x26 * x30
    out[5] = e3 * x19 + x25 * x32 - x30 * x33
    out[6] = -e2 * x19 + x25 * x33 + x30 * x32


@njit(cache=True)
def jacobian(
    t,
    state,
    force,
    moment,
    force_gradient,
    moment_gradient,
    force_curvature,
    moment_curvature,
    params,
    out,
):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    t: time since release [s]
    state: (7) q1, q2, q3, e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    force_curvature: (3, 3) HF11, HF12, HF13, HF21, HF22, HF23, HF31, HF32, HF33
    moment_curvature: (3, 3) HM11, HM12, HM13, HM21, HM22, HM23, HM31, HM32, HM33
    params: (7) m, I, beta_v, beta_w, W1, W2, W3
    out: (7, 7) filled with the result.
    994 operations, 183 temporaries.
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
    HF11 = force_curvature[0, 0]
    HF12 = force_curvature[0, 1]
    HF13 = force_curvature[0, 2]
    HF21 = force_curvature[1, 0]
    HF22 = force_curvature[1, 1]
    HF23 = force_curvature[1, 2]
    HF31 = force_curvature[2, 0]
    HF32 = force_curvature[2, 1]
    HF33 = force_curvature[2, 2]
    HM11 = moment_curvature[0, 0]
    HM12 = moment_curvature[0, 1]
    HM13 = moment_curvature[0, 2]
    HM21 = moment_curvature[1, 0]
    HM22 = moment_curvature[1, 1]
    HM23 = moment_curvature[1, 2]
    HM31 = moment_curvature[2, 0]
    HM32 = moment_curvature[2, 1]
    HM33 = moment_curvature[2, 2]
    m = params[0]
    I = params[1]
    beta_v = params[2]
    beta_w = params[3]
    W1 = params[4]
    W2 = params[5]
    W3 = params[6]
    Mdot1 = DM11 * (F1 + W1) / beta_v + DM12 * (F2 + W2) / beta_v + DM13 * (F3 + W3) / beta_v
    Mdot2 = DM21 * (F1 + W1) / beta_v + DM22 * (F2 + W2) / beta_v + DM23 * (F3 + W3) / beta_v
    Mdot3 = DM31 * (F1 + W1) / beta_v + DM32 * (F2 + W2) / beta_v + DM33 * (F3 + W3) / beta_v
    x0 = 1.0 / beta_v
    x1 = DF12 * DF21
    x2 = DF13 * DF31
    x3 = m / (beta_v * beta_v)
    x4 = DF23 * DF32
    x5 = e2 * e2
    x6 = e3 * e3
    x7 = e0 * e0
    x8 = e1 * e1
    x9 = x7 + x8
    x10 = x5 + x6 + x9
    x11 = 1.0 / x10
    x12 = 2.0 * e0
    x13 = e3 * x12
    x14 = 2.0 * e1 * e2 - x13
    x15 = x11 * x14
    x16 = 1.0 / beta_w
    x17 = (1.0 / 2.0) * e2
    x18 = x16 * x17
    x19 = e2 * x12
    x20 = 2.0 * e1
    x21 = e3 * x20 + x19
    x22 = x11 * x21
    x23 = (1.0 / 2.0) * e3
    x24 = x16 * x23
    x25 = -x5
    x26 = -x6
    x27 = x25 + x26 + x9
    x28 = x11 * x27
    x29 = (1.0 / 2.0) * e1
    x30 = x16 * x29
    x31 = -x15 * x18 - x22 * x24 - x28 * x30
    x32 = e2 * x20 + x13
    x33 = x11 * x32
    x34 = e1 * x12
    x35 = 2.0 * e2 * e3 - x34
    x36 = x11 * x35
    x37 = x7 - x8
    x38 = x26 + x37 + x5
    x39 = x11 * x38
    x40 = -x18 * x39 - x24 * x36 - x30 * x33
    x41 = 2.0 * e1 * e3 - x19
    x42 = x11 * x41
    x43 = 2.0 * e2
    x44 = e3 * x43 + x34
    x45 = x11 * x44
    x46 = x25 + x37 + x6
    x47 = x11 * x46
    x48 = -x18 * x45 - x24 * x47 - x30 * x42
    x49 = HM11 + x0 * (DF11 * DM11 + DF21 * DM12 + DF31 * DM13)
    x50 = 1.0 / (beta_w * beta_w)
    x51 = I * x50
    x52 = x17 * x51
    x53 = x23 * x51
    x54 = x29 * x51
    x55 = x15 * x52 + x22 * x53 + x28 * x54
    x56 = HM21 + x0 * (DF11 * DM21 + DF21 * DM22 + DF31 * DM23)
    x57 = x33 * x54 + x36 * x53 + x39 * x52
    x58 = HM31 + x0 * (DF11 * DM31 + DF21 * DM32 + DF31 * DM33)
    x59 = x42 * x54 + x45 * x52 + x47 * x53
    x60 = HM12 + x0 * (DF12 * DM11 + DF22 * DM12 + DF32 * DM13)
    x61 = HM22 + x0 * (DF12 * DM21 + DF22 * DM22 + DF32 * DM23)
    x62 = HM32 + x0 * (DF12 * DM31 + DF22 * DM32 + DF32 * DM33)
    x63 = HM13 + x0 * (DF13 * DM11 + DF23 * DM12 + DF33 * DM13)
    x64 = HM23 + x0 * (DF13 * DM21 + DF23 * DM22 + DF33 * DM23)
    x65 = HM33 + x0 * (DF13 * DM31 + DF23 * DM32 + DF33 * DM33)
    x66 = 1.0 / (x10 * x10)
    x67 = x12 * x66
    x68 = x27 * x67
    x69 = x32 * x67
    x70 = x41 * x67
    x71 = x11 * x12
    x72 = M1 * x71
    x73 = M2 * x11
    x74 = 2.0 * e3
    x75 = x73 * x74
    x76 = x11 * x43
    x77 = M3 * x76
    x78 = -x72 - x75 + x77
    x79 = Mdot1 * x71
    x80 = x11 * x74
    x81 = Mdot2 * x80
    x82 = Mdot3 * x76
    x83 = -x79 - x81 + x82
    x84 = x16 * (-M1 * x68 - M2 * x69 - M3 * x70 - x78) - x51 * (
        -Mdot1 * x68 - Mdot2 * x69 - Mdot3 * x70 - x83
    )
    x85 = x14 * x67
    x86 = x38 * x67
    x87 = x44 * x67
    x88 = M2 * x71
    x89 = x11 * x20
    x90 = M3 * x89
    x91 = M1 * x80
    x92 = -x88 - x90 + x91
    x93 = Mdot2 * x71
    x94 = Mdot3 * x89
    x95 = Mdot1 * x80
    x96 = -x93 - x94 + x95
    x97 = x16 * (-M1 * x85 - M2 * x86 - M3 * x87 - x92) - x51 * (
        -Mdot1 * x85 - Mdot2 * x86 - Mdot3 * x87 - x96
    )
    x98 = x21 * x67
    x99 = x35 * x67
    x100 = x46 * x67
    x101 = M1 * x76
    x102 = M3 * x71
    x103 = x20 * x73
    x104 = -x101 - x102 + x103
    x105 = Mdot1 * x76
    x106 = Mdot3 * x71
    x107 = Mdot2 * x89
    x108 = -x105 - x106 + x107
    x109 = x16 * (-M1 * x98 - M2 * x99 - M3 * x100 - x104) - x51 * (
        -Mdot1 * x98 - Mdot2 * x99 - Mdot3 * x100 - x108
    )
    x110 = x20 * x66
    x111 = x110 * x32
    x112 = x110 * x41
    x113 = x110 * x27
    x114 = x16 * (
        2.0 * M1 * e1 * x11
        - M1 * x113
        + 2.0 * M2 * e2 * x11
        - M2 * x111
        + 2.0 * M3 * e3 * x11
        - M3 * x112
    ) - x51 * (
        2.0 * Mdot1 * e1 * x11
        - Mdot1 * x113
        + 2.0 * Mdot2 * e2 * x11
        - Mdot2 * x111
        + 2.0 * Mdot3 * e3 * x11
        - Mdot3 * x112
    )
    x115 = x110 * x14
    x116 = x110 * x38
    x117 = x110 * x44
    x118 = x16 * (-M1 * x115 - M2 * x116 - M3 * x117 - x104) - x51 * (
        -Mdot1 * x115 - Mdot2 * x116 - Mdot3 * x117 - x108
    )
    x119 = x110 * x21
    x120 = x110 * x35
    x121 = x110 * x46
    x122 = x16 * (-M1 * x119 - M2 * x120 - M3 * x121 - x88 - x90 + x91) - x51 * (
        -Mdot1 * x119 - Mdot2 * x120 - Mdot3 * x121 - x93 - x94 + x95
    )
    x123 = (1.0 / 2.0) * x16
    x124 = x123 * (M1 * x28 + M2 * x33 + M3 * x42)
    x125 = (1.0 / 2.0) * x51
    x126 = x125 * (Mdot1 * x28 + Mdot2 * x33 + Mdot3 * x42)
    x127 = x124 - x126
    x128 = x43 * x66
    x129 = x128 * x32
    x130 = x128 * x41
    x131 = x128 * x27
    x132 = x16 * (-M1 * x131 - M2 * x129 - M3 * x130 - x101 - x102 + x103) - x51 * (
        -Mdot1 * x131 - Mdot2 * x129 - Mdot3 * x130 - x105 - x106 + x107
    )
    x133 = x128 * x14
    x134 = x128 * x38
    x135 = x128 * x44
    x136 = M1 * x89 + M2 * x76 + M3 * x80
    x137 = Mdot1 * x89 + Mdot2 * x76 + Mdot3 * x80
    x138 = x16 * (-M1 * x133 - M2 * x134 - M3 * x135 + x136) - x51 * (
        -Mdot1 * x133 - Mdot2 * x134 - Mdot3 * x135 + x137
    )
    x139 = x128 * x21
    x140 = x128 * x35
    x141 = x128 * x46
    x142 = x16 * (-M1 * x139 - M2 * x140 - M3 * x141 - x78) - x51 * (
        -Mdot1 * x139 - Mdot2 * x140 - Mdot3 * x141 - x83
    )
    x143 = x123 * (M1 * x15 + M2 * x39 + M3 * x45)
    x144 = x125 * (Mdot1 * x15 + Mdot2 * x39 + Mdot3 * x45)
    x145 = x143 - x144
    x146 = x66 * x74
    x147 = x146 * x27
    x148 = x146 * x32
    x149 = x146 * x41
    x150 = x16 * (-M1 * x147 - M2 * x148 - M3 * x149 - x92) - x51 * (
        -Mdot1 * x147 - Mdot2 * x148 - Mdot3 * x149 - x96
    )
    x151 = x14 * x146
    x152 = x146 * x44
    x153 = x146 * x38
    x154 = x16 * (-M1 * x151 - M2 * x153 - M3 * x152 - x72 - x75 + x77) - x51 * (
        -Mdot1 * x151 - Mdot2 * x153 - Mdot3 * x152 - x79 - x81 + x82
    )
    x155 = x146 * x21
    x156 = x146 * x35
    x157 = x146 * x46
    x158 = x16 * (-M1 * x155 - M2 * x156 - M3 * x157 + x136) - x51 * (
        -Mdot1 * x155 - Mdot2 * x156 - Mdot3 * x157 + x137
    )
    x159 = x123 * (M1 * x22 + M2 * x36 + M3 * x47)
    x160 = x125 * (Mdot1 * x22 + Mdot2 * x36 + Mdot3 * x47)
    x161 = x159 - x160
    x162 = e0 * x123
    x163 = -x15 * x24 + x162 * x28 + x18 * x22
    x164 = x162 * x33 + x18 * x36 - x24 * x39
    x165 = x162 * x42 + x18 * x47 - x24 * x45
    x166 = (1.0 / 2.0) * e0
    x167 = x166 * x51
    x168 = (1.0 / 2.0) * I * e3 * x11 * x14 * x50 - x167 * x28 - x22 * x52
    x169 = (1.0 / 2.0) * I * e3 * x11 * x38 * x50 - x167 * x33 - x36 * x52
    x170 = (1.0 / 2.0) * I * e3 * x11 * x44 * x50 - x167 * x42 - x47 * x52
    x171 = x15 * x162 - x22 * x30 + x24 * x28
    x172 = x162 * x39 + x24 * x33 - x30 * x36
    x173 = x162 * x45 + x24 * x42 - x30 * x47
    x174 = (1.0 / 2.0) * I * e1 * x11 * x21 * x50 - x15 * x167 - x28 * x53
    x175 = (1.0 / 2.0) * I * e1 * x11 * x35 * x50 - x167 * x39 - x33 * x53
    x176 = (1.0 / 2.0) * I * e1 * x11 * x46 * x50 - x167 * x45 - x42 * x53
    x177 = x15 * x30 + x162 * x22 - x18 * x28
    x178 = x162 * x36 - x18 * x33 + x30 * x39
    x179 = x162 * x47 - x18 * x42 + x30 * x45
    x180 = (1.0 / 2.0) * I * e2 * x11 * x27 * x50 - x15 * x54 - x167 * x22
    x181 = (1.0 / 2.0) * I * e2 * x11 * x32 * x50 - x167 * x36 - x39 * x54
    x182 = (1.0 / 2.0) * I * e2 * x11 * x41 * x50 - x167 * x47 - x45 * x54
    out[0, 0] = DF11 * x0 - x3 * (HF11 + x0 * ((DF11 * DF11) + x1 + x2))
    out[0, 1] = DF12 * x0 - x3 * (HF12 + x0 * (DF11 * DF12 + DF12 * DF22 + DF13 * DF32))
    out[0, 2] = DF13 * x0 - x3 * (HF13 + x0 * (DF11 * DF13 + DF12 * DF23 + DF13 * DF33))
    out[0, 3] = 0.0
    out[0, 4] = 0.0
    out[0, 5] = 0.0
    out[0, 6] = 0.0
    out[1, 0] = DF21 * x0 - x3 * (HF21 + x0 * (DF11 * DF21 + DF21 * DF22 + DF23 * DF31))
    out[1, 1] = DF22 * x0 - x3 * (HF22 + x0 * ((DF22 * DF22) + x1 + x4))
    out[1, 2] = DF23 * x0 - x3 * (HF23 + x0 * (DF13 * DF21 + DF22 * DF23 + DF23 * DF33))
    out[1, 3] = 0.0
    out[1, 4] = 0.0
    out[1, 5] = 0.0
    out[1, 6] = 0.0
    out[2, 0] = DF31 * x0 - x3 * (HF31 + x0 * (DF11 * DF31 + DF21 * DF32 + DF31 * DF33))
    out[2, 1] = DF32 * x0 - x3 * (HF32 + x0 * (DF12 * DF31 + DF22 * DF32 + DF32 * DF33))
    out[2, 2] = DF33 * x0 - x3 * (HF33 + x0 * ((DF33 * DF33) + x2 + x4))
    out[2, 3] = 0.0
    out[2, 4] = 0.0
    out[2, 5] = 0.0
    out[2, 6] = 0.0
    out[3, 0] = DM11 * x31 + DM21 * x40 + DM31 * x48 + x49 * x55 + x56 * x57 + x58 * x59
    out[3, 1] = DM12 * x31 + DM22 * x40 + DM32 * x48 + x55 * x60 + x57 * x61 + x59 * x62
    out[3, 2] = DM13 * x31 + DM23 * x40 + DM33 * x48 + x55 * x63 + x57 * x64 + x59 * x65
    out[3, 3] = -x109 * x23 - x17 * x97 - x29 * x84
    out[3, 4] = -x114 * x29 - x118 * x17 - x122 * x23 - x127
    out[3, 5] = -x132 * x29 - x138 * x17 - x142 * x23 - x145
    out[3, 6] = -x150 * x29 - x154 * x17 - x158 * x23 - x161
    out[4, 0] = DM11 * x163 + DM21 * x164 + DM31 * x165 + x168 * x49 + x169 * x56 + x170 * x58
    out[4, 1] = DM12 * x163 + DM22 * x164 + DM32 * x165 + x168 * x60 + x169 * x61 + x170 * x62
    out[4, 2] = DM13 * x163 + DM23 * x164 + DM33 * x165 + x168 * x63 + x169 * x64 + x170 * x65
    out[4, 3] = x109 * x17 + x127 + x166 * x84 - x23 * x97
    out[4, 4] = x114 * x166 - x118 * x23 + x122 * x17
    out[4, 5] = x132 * x166 - x138 * x23 + x142 * x17 + x161
    out[4, 6] = -x143 + x144 + x150 * x166 - x154 * x23 + x158 * x17
    out[5, 0] = DM11 * x171 + DM21 * x172 + DM31 * x173 + x174 * x49 + x175 * x56 + x176 * x58
    out[5, 1] = DM12 * x171 + DM22 * x172 + DM32 * x173 + x174 * x60 + x175 * x61 + x176 * x62
    out[5, 2] = DM13 * x171 + DM23 * x172 + DM33 * x173 + x174 * x63 + x175 * x64 + x176 * x65
    out[5, 3] = -x109 * x29 + x145 + x166 * x97 + x23 * x84
    out[5, 4] = x114 * x23 + x118 * x166 - x122 * x29 - x159 + x160
    out[5, 5] = x132 * x23 + x138 * x166 - x142 * x29
    out[5, 6] = x127 + x150 * x23 + x154 * x166 - x158 * x29
    out[6, 0] = DM11 * x177 + DM21 * x178 + DM31 * x179 + x180 * x49 + x181 * x56 + x182 * x58
    out[6, 1] = DM12 * x177 + DM22 * x178 + DM32 * x179 + x180 * x60 + x181 * x61 + x182 * x62
    out[6, 2] = DM13 * x177 + DM23 * x178 + DM33 * x179 + x180 * x63 + x181 * x64 + x182 * x65
    out[6, 3] = x109 * x166 + x161 - x17 * x84 + x29 * x97
    out[6, 4] = -x114 * x17 + x118 * x29 + x122 * x166 + x145
    out[6, 5] = -x124 + x126 - x132 * x17 + x138 * x29 + x142 * x166
    out[6, 6] = -x150 * x17 + x154 * x29 + x158 * x166


@njit(cache=True)
def matched_start(released, force, moment, params, out):
    """Start of the slow motion for a bead released with (position, ..., velocities).

    released: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (7) m, I, beta_v, beta_w, W1, W2, W3
    out: (7) filled with the result.
    116 operations, 28 temporaries.
    """
    q1 = released[0]
    q2 = released[1]
    q3 = released[2]
    e0 = released[3]
    e1 = released[4]
    e2 = released[5]
    e3 = released[6]
    v1 = released[7]
    v2 = released[8]
    v3 = released[9]
    omega1 = released[10]
    omega2 = released[11]
    omega3 = released[12]
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
    x0 = m / beta_v
    x1 = m / (beta_v * beta_v)
    x2 = I / beta_w
    x3 = 2.0 * e0
    x4 = e3 * x3
    x5 = 2.0 * e1
    x6 = e2 * e2
    x7 = e3 * e3
    x8 = e0 * e0
    x9 = e1 * e1
    x10 = x8 + x9
    x11 = 1.0 / (x10 + x6 + x7)
    x12 = M2 * x11
    x13 = e2 * x3
    x14 = M3 * x11
    x15 = -x6
    x16 = -x7
    x17 = M1 * x11
    x18 = I / (beta_w * beta_w)
    x19 = (1.0 / 2.0) * omega1 * x2 - 1.0 / 2.0 * x18 * (
        x12 * (e2 * x5 + x4) + x14 * (2.0 * e1 * e3 - x13) + x17 * (x10 + x15 + x16)
    )
    x20 = e1 * x3
    x21 = x8 - x9
    x22 = omega2 * x2 - x18 * (
        x12 * (x16 + x21 + x6) + x14 * (2.0 * e2 * e3 + x20) + x17 * (2.0 * e1 * e2 - x4)
    )
    x23 = (1.0 / 2.0) * e2
    x24 = omega3 * x2 - x18 * (
        x12 * (2.0 * e2 * e3 - x20) + x14 * (x15 + x21 + x7) + x17 * (e3 * x5 + x13)
    )
    x25 = (1.0 / 2.0) * e3
    x26 = (1.0 / 2.0) * e0
    x27 = (1.0 / 2.0) * e1
    out[0] = q1 + v1 * x0 - x1 * (F1 + W1)
    out[1] = q2 + v2 * x0 - x1 * (F2 + W2)
    out[2] = q3 + v3 * x0 - x1 * (F3 + W3)
    out[3] = e0 - e1 * x19 - x22 * x23 - x24 * x25
    out[4] = e0 * x19 + e1 - x22 * x25 + x23 * x24
    out[5] = e2 + e3 * x19 + x22 * x26 - x24 * x27
    out[6] = -e2 * x19 + e3 + x22 * x27 + x24 * x26


@njit(cache=True)
def initial_layer(t, released, force, moment, params, out):
    """What the release still adds to the slow motion at time t: displacement, velocity,
    angle turned and angular velocity (body frame).

    t: time since release [s]
    released: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (7) m, I, beta_v, beta_w, W1, W2, W3
    out: (12) filled with the result.
    101 operations, 29 temporaries.
    """
    e0 = released[3]
    e1 = released[4]
    e2 = released[5]
    e3 = released[6]
    v1 = released[7]
    v2 = released[8]
    v3 = released[9]
    omega1 = released[10]
    omega2 = released[11]
    omega3 = released[12]
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
    x0 = math.exp(-beta_v * t / m)
    x1 = 1.0 / beta_v
    x2 = x0 * (v1 - x1 * (F1 + W1))
    x3 = m * x1
    x4 = x0 * (v2 - x1 * (F2 + W2))
    x5 = x0 * (v3 - x1 * (F3 + W3))
    x6 = math.exp(-beta_w * t / I)
    x7 = 1.0 / beta_w
    x8 = 2.0 * e0
    x9 = e3 * x8
    x10 = 2.0 * e1
    x11 = e2 * e2
    x12 = e3 * e3
    x13 = e0 * e0
    x14 = e1 * e1
    x15 = x13 + x14
    x16 = 1.0 / (x11 + x12 + x15)
    x17 = M2 * x16
    x18 = e2 * x8
    x19 = M3 * x16
    x20 = -x11
    x21 = -x12
    x22 = M1 * x16
    x23 = x6 * (
        omega1
        - x7 * (x17 * (e2 * x10 + x9) + x19 * (2.0 * e1 * e3 - x18) + x22 * (x15 + x20 + x21))
    )
    x24 = I * x7
    x25 = e1 * x8
    x26 = x13 - x14
    x27 = x6 * (
        omega2
        - x7 * (x17 * (x11 + x21 + x26) + x19 * (2.0 * e2 * e3 + x25) + x22 * (2.0 * e1 * e2 - x9))
    )
    x28 = x6 * (
        omega3
        - x7 * (x17 * (2.0 * e2 * e3 - x25) + x19 * (x12 + x20 + x26) + x22 * (e3 * x10 + x18))
    )
    out[0] = -x2 * x3
    out[1] = -x3 * x4
    out[2] = -x3 * x5
    out[3] = x2
    out[4] = x4
    out[5] = x5
    out[6] = -x23 * x24
    out[7] = -x24 * x27
    out[8] = -x24 * x28
    out[9] = x23
    out[10] = x27
    out[11] = x28


@njit(cache=True)
def rates(t, state, force, moment, force_gradient, moment_gradient, mobility, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(t, state, force, moment, force_gradient, moment_gradient, params, out)
