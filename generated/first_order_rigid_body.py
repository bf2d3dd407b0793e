"""First-order slow model: rigid body.

Made by `python -m derivation` from derivation/multiscale.py; do not edit.
SymPy 1.14.0. 1737 operations, 344 temporaries.

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
* [1] `I1` [kg m^2] principal moment of inertia about P1, (A.13)
* [2] `I2` [kg m^2] principal moment of inertia about P2, (A.13)
* [3] `I3` [kg m^2] principal moment of inertia about P3, (A.13)
* [4] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [5] `beta_w` [N m s] rotational drag coefficient, (2.15)
* [6] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [7] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [8] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

import math

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3")
PARAMS = ("m", "I1", "I2", "I3", "beta_v", "beta_w", "W1", "W2", "W3")
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
    params: (9) m, I1, I2, I3, beta_v, beta_w, W1, W2, W3
    out: (7) filled with the result.
    220 operations, 47 temporaries.
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
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
    beta_v = params[4]
    beta_w = params[5]
    W1 = params[6]
    W2 = params[7]
    W3 = params[8]
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
    x18 = M1 * x17 + M2 * x12 + M3 * x14
    x19 = 2.0 * e1 * e2 - x10
    x20 = M1 * x8
    x21 = e1 * x9
    x22 = 2.0 * e2 * e3 + x21
    x23 = M3 * x8
    x24 = x5 - x6
    x25 = x16 + x24 + x3
    x26 = M2 * x8
    x27 = x19 * x20 + x22 * x23 + x25 * x26
    x28 = e3 * x11 + x13
    x29 = 2.0 * e2 * e3 - x21
    x30 = x15 + x24 + x4
    x31 = x20 * x28 + x23 * x30 + x26 * x29
    x32 = 1.0 / (beta_w * beta_w)
    x33 = x31 * x32
    x34 = x27 * x33
    x35 = (1.0 / 2.0) * x18 * x2 - 1.0 / 2.0 * x2 * (
        I1 * x2 * (Mdot1 * x17 + Mdot2 * x12 + Mdot3 * x14) - I2 * x34 + I3 * x34
    )
    x36 = Mdot1 * x8
    x37 = Mdot3 * x8
    x38 = Mdot2 * x8
    x39 = x18 * x33
    x40 = x2 * x27 - x2 * (I1 * x39 + I2 * x2 * (x19 * x36 + x22 * x37 + x25 * x38) - I3 * x39)
    x41 = (1.0 / 2.0) * e2
    x42 = x18 * x27 * x32
    x43 = x2 * x31 - x2 * (-I1 * x42 + I2 * x42 + I3 * x2 * (x28 * x36 + x29 * x38 + x30 * x37))
    x44 = (1.0 / 2.0) * e3
    x45 = (1.0 / 2.0) * e0
    x46 = (1.0 / 2.0) * e1
    out[0] = -Fdot1 * x0 + x1 * (F1 + W1)
    out[1] = -Fdot2 * x0 + x1 * (F2 + W2)
    out[2] = -Fdot3 * x0 + x1 * (F3 + W3)
    out[3] = -e1 * x35 - x40 * x41 - x43 * x44
    out[4] = e0 * x35 - x40 * x44 + x41 * x43
    out[5] = e3 * x35 + x40 * x45 - x43 * x46
    out[6] = -e2 * x35 + x40 * x46 + x43 * x45


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
    params: (9) m, I1, I2, I3, beta_v, beta_w, W1, W2, W3
    out: (7, 7) filled with the result.
    1289 operations, 241 temporaries.
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
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
    beta_v = params[4]
    beta_w = params[5]
    W1 = params[6]
    W2 = params[7]
    W3 = params[8]
    Mdot1 = DM11 * (F1 + W1) / beta_v + DM12 * (F2 + W2) / beta_v + DM13 * (F3 + W3) / beta_v
    Mdot2 = DM21 * (F1 + W1) / beta_v + DM22 * (F2 + W2) / beta_v + DM23 * (F3 + W3) / beta_v
    Mdot3 = DM31 * (F1 + W1) / beta_v + DM32 * (F2 + W2) / beta_v + DM33 * (F3 + W3) / beta_v
    x0 = 1.0 / beta_v
    x1 = DF12 * DF21
    x2 = DF13 * DF31
    x3 = m / (beta_v * beta_v)
    x4 = DF23 * DF32
    x5 = HM11 + x0 * (DF11 * DM11 + DF21 * DM12 + DF31 * DM13)
    x6 = 2.0 * e0
    x7 = e3 * x6
    x8 = 2.0 * e1 * e2 - x7
    x9 = (1.0 / 2.0) * e2
    x10 = e1 * e1
    x11 = e2 * e2
    x12 = e0 * e0
    x13 = e3 * e3
    x14 = x12 + x13
    x15 = x10 + x11 + x14
    x16 = 1.0 / x15
    x17 = 1.0 / (beta_w * beta_w)
    x18 = I2 * x17
    x19 = x16 * x18
    x20 = x19 * x9
    x21 = e2 * x6
    x22 = 2.0 * e1
    x23 = e3 * x22 + x21
    x24 = (1.0 / 2.0) * e3
    x25 = I3 * x17
    x26 = x16 * x25
    x27 = x24 * x26
    x28 = -x11
    x29 = x12 - x13
    x30 = x10 + x28 + x29
    x31 = (1.0 / 2.0) * e1
    x32 = I1 * x17
    x33 = x16 * x32
    x34 = x31 * x33
    x35 = x20 * x8 + x23 * x27 + x30 * x34
    x36 = HM21 + x0 * (DF11 * DM21 + DF21 * DM22 + DF31 * DM23)
    x37 = e2 * x22 + x7
    x38 = e1 * x6
    x39 = 2.0 * e2 * e3 - x38
    x40 = -x10
    x41 = x11 + x29 + x40
    x42 = x20 * x41 + x27 * x39 + x34 * x37
    x43 = HM31 + x0 * (DF11 * DM31 + DF21 * DM32 + DF31 * DM33)
    x44 = 2.0 * e1 * e3 - x21
    x45 = 2.0 * e2
    x46 = e3 * x45 + x38
    x47 = x14 + x28 + x40
    x48 = x20 * x46 + x27 * x47 + x34 * x44
    x49 = 1.0 / beta_w
    x50 = x16 * x49
    x51 = M1 * x16
    x52 = M3 * x16
    x53 = M2 * x16
    x54 = x41 * x53 + x46 * x52 + x51 * x8
    x55 = x23 * x51 + x39 * x53 + x47 * x52
    x56 = x30 * x50 - x49 * (
        I3 * x16 * x17 * x23 * x54 + I3 * x16 * x17 * x55 * x8 - x19 * x23 * x54 - x19 * x55 * x8
    )
    x57 = x30 * x51 + x37 * x53 + x44 * x52
    x58 = x23 * x57
    x59 = x30 * x55
    x60 = -x49 * (-x26 * x58 - x26 * x59 + x33 * x58 + x33 * x59) + x50 * x8
    x61 = x23 * x50 - x49 * (
        I2 * x16 * x17 * x30 * x54 + I2 * x16 * x17 * x57 * x8 - x30 * x33 * x54 - x33 * x57 * x8
    )
    x62 = -x24 * x61 - x31 * x56 - x60 * x9
    x63 = x39 * x57
    x64 = x37 * x55
    x65 = x41 * x50 - x49 * (-x26 * x63 - x26 * x64 + x33 * x63 + x33 * x64)
    x66 = x37 * x50 - x49 * (
        I3 * x16 * x17 * x39 * x54 + I3 * x16 * x17 * x41 * x55 - x19 * x39 * x54 - x19 * x41 * x55
    )
    x67 = x39 * x50 - x49 * (
        I2 * x16 * x17 * x37 * x54 + I2 * x16 * x17 * x41 * x57 - x33 * x37 * x54 - x33 * x41 * x57
    )
    x68 = -x24 * x67 - x31 * x66 - x65 * x9
    x69 = x47 * x50 - x49 * (
        I2 * x16 * x17 * x44 * x54 + I2 * x16 * x17 * x46 * x57 - x33 * x44 * x54 - x33 * x46 * x57
    )
    x70 = x44 * x50 - x49 * (
        I3 * x16 * x17 * x46 * x55 + I3 * x16 * x17 * x47 * x54 - x19 * x46 * x55 - x19 * x47 * x54
    )
    x71 = x44 * x55
    x72 = x47 * x57
    x73 = x46 * x50 - x49 * (-x26 * x71 - x26 * x72 + x33 * x71 + x33 * x72)
    x74 = -x24 * x69 - x31 * x70 - x73 * x9
    x75 = HM12 + x0 * (DF12 * DM11 + DF22 * DM12 + DF32 * DM13)
    x76 = HM22 + x0 * (DF12 * DM21 + DF22 * DM22 + DF32 * DM23)
    x77 = HM32 + x0 * (DF12 * DM31 + DF22 * DM32 + DF32 * DM33)
    x78 = HM13 + x0 * (DF13 * DM11 + DF23 * DM12 + DF33 * DM13)
    x79 = HM23 + x0 * (DF13 * DM21 + DF23 * DM22 + DF33 * DM23)
    x80 = HM33 + x0 * (DF13 * DM31 + DF23 * DM32 + DF33 * DM33)
    x81 = 1.0 / (x15 * x15)
    x82 = x6 * x81
    x83 = x30 * x82
    x84 = x37 * x82
    x85 = x44 * x82
    x86 = x51 * x6
    x87 = 2.0 * e3
    x88 = x53 * x87
    x89 = x45 * x52
    x90 = -x86 - x88 + x89
    x91 = -M1 * x83 - M2 * x84 - M3 * x85 - x90
    x92 = Mdot1 * x16
    x93 = x6 * x92
    x94 = Mdot2 * x16
    x95 = x87 * x94
    x96 = Mdot3 * x16
    x97 = x45 * x96
    x98 = -x93 - x95 + x97
    x99 = I1 * x49
    x100 = M1 * x82
    x101 = M2 * x82
    x102 = M3 * x82
    x103 = x53 * x6
    x104 = x22 * x52
    x105 = x51 * x87
    x106 = -x103 - x104 + x105
    x107 = -x100 * x8 - x101 * x41 - x102 * x46 - x106
    x108 = x107 * x55
    x109 = x45 * x51
    x110 = x52 * x6
    x111 = x22 * x53
    x112 = -x109 - x110 + x111
    x113 = -x100 * x23 - x101 * x39 - x102 * x47 - x112
    x114 = x113 * x54
    x115 = x49 * x91 - x49 * (
        -x108 * x18
        + x108 * x25
        - x114 * x18
        + x114 * x25
        + x99 * (-Mdot1 * x83 - Mdot2 * x84 - Mdot3 * x85 - x98)
    )
    x116 = Mdot1 * x82
    x117 = Mdot2 * x82
    x118 = Mdot3 * x82
    x119 = x6 * x94
    x120 = x22 * x96
    x121 = x87 * x92
    x122 = -x119 - x120 + x121
    x123 = I2 * x49
    x124 = x55 * x91
    x125 = x113 * x57
    x126 = x107 * x49 - x49 * (
        x123 * (-x116 * x8 - x117 * x41 - x118 * x46 - x122)
        - x124 * x25
        + x124 * x32
        - x125 * x25
        + x125 * x32
    )
    x127 = x45 * x92
    x128 = x6 * x96
    x129 = x22 * x94
    x130 = -x127 - x128 + x129
    x131 = I3 * x49
    x132 = x54 * x91
    x133 = x107 * x57
    x134 = x113 * x49 - x49 * (
        x131 * (-x116 * x23 - x117 * x39 - x118 * x47 - x130)
        + x132 * x18
        - x132 * x32
        + x133 * x18
        - x133 * x32
    )
    x135 = x22 * x81
    x136 = x135 * x37
    x137 = x135 * x44
    x138 = x135 * x30
    x139 = (
        2.0 * M1 * e1 * x16
        - M1 * x138
        + 2.0 * M2 * e2 * x16
        - M2 * x136
        + 2.0 * M3 * e3 * x16
        - M3 * x137
    )
    x140 = M1 * x135
    x141 = M2 * x135
    x142 = M3 * x135
    x143 = -x112 - x140 * x8 - x141 * x41 - x142 * x46
    x144 = x143 * x55
    x145 = -x103 - x104 + x105 - x140 * x23 - x141 * x39 - x142 * x47
    x146 = x145 * x54
    x147 = x139 * x49 - x49 * (
        -x144 * x18
        + x144 * x25
        - x146 * x18
        + x146 * x25
        + x99
        * (
            2.0 * Mdot1 * e1 * x16
            - Mdot1 * x138
            + 2.0 * Mdot2 * e2 * x16
            - Mdot2 * x136
            + 2.0 * Mdot3 * e3 * x16
            - Mdot3 * x137
        )
    )
    x148 = Mdot1 * x135
    x149 = Mdot2 * x135
    x150 = Mdot3 * x135
    x151 = x139 * x55
    x152 = x145 * x57
    x153 = x143 * x49 - x49 * (
        x123 * (-x130 - x148 * x8 - x149 * x41 - x150 * x46)
        - x151 * x25
        + x151 * x32
        - x152 * x25
        + x152 * x32
    )
    x154 = x139 * x54
    x155 = x143 * x57
    x156 = x145 * x49 - x49 * (
        x131 * (-x119 - x120 + x121 - x148 * x23 - x149 * x39 - x150 * x47)
        + x154 * x18
        - x154 * x32
        + x155 * x18
        - x155 * x32
    )
    x157 = (1.0 / 2.0) * x49
    x158 = x157 * x57
    x159 = x54 * x55
    x160 = x157 * (-x159 * x18 + x159 * x25 + x99 * (x30 * x92 + x37 * x94 + x44 * x96))
    x161 = x158 - x160
    x162 = x45 * x81
    x163 = x162 * x37
    x164 = x162 * x44
    x165 = x162 * x30
    x166 = -M1 * x165 - M2 * x163 - M3 * x164 - x109 - x110 + x111
    x167 = M1 * x162
    x168 = M2 * x162
    x169 = M3 * x162
    x170 = x22 * x51 + x45 * x53 + x52 * x87
    x171 = -x167 * x8 - x168 * x41 - x169 * x46 + x170
    x172 = x171 * x55
    x173 = -x167 * x23 - x168 * x39 - x169 * x47 - x90
    x174 = x173 * x54
    x175 = x166 * x49 - x49 * (
        -x172 * x18
        + x172 * x25
        - x174 * x18
        + x174 * x25
        + x99 * (-Mdot1 * x165 - Mdot2 * x163 - Mdot3 * x164 - x127 - x128 + x129)
    )
    x176 = Mdot1 * x162
    x177 = Mdot2 * x162
    x178 = Mdot3 * x162
    x179 = x22 * x92 + x45 * x94 + x87 * x96
    x180 = x166 * x55
    x181 = x173 * x57
    x182 = x171 * x49 - x49 * (
        x123 * (-x176 * x8 - x177 * x41 - x178 * x46 + x179)
        - x180 * x25
        + x180 * x32
        - x181 * x25
        + x181 * x32
    )
    x183 = x166 * x54
    x184 = x171 * x57
    x185 = x173 * x49 - x49 * (
        x131 * (-x176 * x23 - x177 * x39 - x178 * x47 - x98)
        + x18 * x183
        + x18 * x184
        - x183 * x32
        - x184 * x32
    )
    x186 = x157 * x54
    x187 = x55 * x57
    x188 = x157 * (x123 * (x41 * x94 + x46 * x96 + x8 * x92) - x187 * x25 + x187 * x32)
    x189 = x186 - x188
    x190 = x81 * x87
    x191 = x190 * x30
    x192 = x190 * x37
    x193 = x190 * x44
    x194 = -M1 * x191 - M2 * x192 - M3 * x193 - x106
    x195 = M1 * x190
    x196 = M3 * x190
    x197 = M2 * x190
    x198 = -x195 * x8 - x196 * x46 - x197 * x41 - x86 - x88 + x89
    x199 = x198 * x55
    x200 = x170 - x195 * x23 - x196 * x47 - x197 * x39
    x201 = x200 * x54
    x202 = x194 * x49 - x49 * (
        -x18 * x199
        - x18 * x201
        + x199 * x25
        + x201 * x25
        + x99 * (-Mdot1 * x191 - Mdot2 * x192 - Mdot3 * x193 - x122)
    )
    x203 = Mdot1 * x190
    x204 = Mdot3 * x190
    x205 = Mdot2 * x190
    x206 = x194 * x55
    x207 = x200 * x57
    x208 = x198 * x49 - x49 * (
        x123 * (-x203 * x8 - x204 * x46 - x205 * x41 - x93 - x95 + x97)
        - x206 * x25
        + x206 * x32
        - x207 * x25
        + x207 * x32
    )
    x209 = x194 * x54
    x210 = x198 * x57
    x211 = x200 * x49 - x49 * (
        x131 * (x179 - x203 * x23 - x204 * x47 - x205 * x39)
        + x18 * x209
        + x18 * x210
        - x209 * x32
        - x210 * x32
    )
    x212 = x157 * x55
    x213 = x54 * x57
    x214 = x157 * (x131 * (x23 * x92 + x39 * x94 + x47 * x96) + x18 * x213 - x213 * x32)
    x215 = x212 - x214
    x216 = x26 * x9
    x217 = (1.0 / 2.0) * e0
    x218 = x217 * x33
    x219 = (1.0 / 2.0) * I2 * e3 * x16 * x17 * x8 - x216 * x23 - x218 * x30
    x220 = (1.0 / 2.0) * I2 * e3 * x16 * x17 * x41 - x216 * x39 - x218 * x37
    x221 = (1.0 / 2.0) * I2 * e3 * x16 * x17 * x46 - x216 * x47 - x218 * x44
    x222 = x217 * x56 - x24 * x60 + x61 * x9
    x223 = x217 * x66 - x24 * x65 + x67 * x9
    x224 = x217 * x70 - x24 * x73 + x69 * x9
    x225 = x19 * x217
    x226 = x24 * x33
    x227 = (1.0 / 2.0) * I3 * e1 * x16 * x17 * x23 - x225 * x8 - x226 * x30
    x228 = (1.0 / 2.0) * I3 * e1 * x16 * x17 * x39 - x225 * x41 - x226 * x37
    x229 = (1.0 / 2.0) * I3 * e1 * x16 * x17 * x47 - x225 * x46 - x226 * x44
    x230 = x217 * x60 + x24 * x56 - x31 * x61
    x231 = x217 * x65 + x24 * x66 - x31 * x67
    x232 = x217 * x73 + x24 * x70 - x31 * x69
    x233 = x19 * x31
    x234 = x217 * x26
    x235 = (1.0 / 2.0) * I1 * e2 * x16 * x17 * x30 - x23 * x234 - x233 * x8
    x236 = (1.0 / 2.0) * I1 * e2 * x16 * x17 * x37 - x233 * x41 - x234 * x39
    x237 = (1.0 / 2.0) * I1 * e2 * x16 * x17 * x44 - x233 * x46 - x234 * x47
    x238 = x217 * x61 + x31 * x60 - x56 * x9
    x239 = x217 * x67 + x31 * x65 - x66 * x9
    x240 = x217 * x69 + x31 * x73 - x70 * x9
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
    out[3, 0] = DM11 * x62 + DM21 * x68 + DM31 * x74 + x35 * x5 + x36 * x42 + x43 * x48
    out[3, 1] = DM12 * x62 + DM22 * x68 + DM32 * x74 + x35 * x75 + x42 * x76 + x48 * x77
    out[3, 2] = DM13 * x62 + DM23 * x68 + DM33 * x74 + x35 * x78 + x42 * x79 + x48 * x80
    out[3, 3] = -x115 * x31 - x126 * x9 - x134 * x24
    out[3, 4] = -x147 * x31 - x153 * x9 - x156 * x24 - x161
    out[3, 5] = -x175 * x31 - x182 * x9 - x185 * x24 - x189
    out[3, 6] = -x202 * x31 - x208 * x9 - x211 * x24 - x215
    out[4, 0] = DM11 * x222 + DM21 * x223 + DM31 * x224 + x219 * x5 + x220 * x36 + x221 * x43
    out[4, 1] = DM12 * x222 + DM22 * x223 + DM32 * x224 + x219 * x75 + x220 * x76 + x221 * x77
    out[4, 2] = DM13 * x222 + DM23 * x223 + DM33 * x224 + x219 * x78 + x220 * x79 + x221 * x80
    out[4, 3] = x115 * x217 - x126 * x24 + x134 * x9 + x161
    out[4, 4] = x147 * x217 - x153 * x24 + x156 * x9
    out[4, 5] = x175 * x217 - x182 * x24 + x185 * x9 + x215
    out[4, 6] = -x186 + x188 + x202 * x217 - x208 * x24 + x211 * x9
    out[5, 0] = DM11 * x230 + DM21 * x231 + DM31 * x232 + x227 * x5 + x228 * x36 + x229 * x43
    out[5, 1] = DM12 * x230 + DM22 * x231 + DM32 * x232 + x227 * x75 + x228 * x76 + x229 * x77
    out[5, 2] = DM13 * x230 + DM23 * x231 + DM33 * x232 + x227 * x78 + x228 * x79 + x229 * x80
    out[5, 3] = x115 * x24 + x126 * x217 - x134 * x31 + x189
    out[5, 4] = x147 * x24 + x153 * x217 - x156 * x31 - x212 + x214
    out[5, 5] = x175 * x24 + x182 * x217 - x185 * x31
    out[5, 6] = x161 + x202 * x24 + x208 * x217 - x211 * x31
    out[6, 0] = DM11 * x238 + DM21 * x239 + DM31 * x240 + x235 * x5 + x236 * x36 + x237 * x43
    out[6, 1] = DM12 * x238 + DM22 * x239 + DM32 * x240 + x235 * x75 + x236 * x76 + x237 * x77
    out[6, 2] = DM13 * x238 + DM23 * x239 + DM33 * x240 + x235 * x78 + x236 * x79 + x237 * x80
    out[6, 3] = -x115 * x9 + x126 * x31 + x134 * x217 + x215
    out[6, 4] = -x147 * x9 + x153 * x31 + x156 * x217 + x189
    out[6, 5] = -x158 + x160 - x175 * x9 + x182 * x31 + x185 * x217
    out[6, 6] = -x202 * x9 + x208 * x31 + x211 * x217


@njit(cache=True)
def matched_start(released, force, moment, params, out):
    """Start of the slow motion for a bead released with (position, ..., velocities).

    released: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (9) m, I1, I2, I3, beta_v, beta_w, W1, W2, W3
    out: (7) filled with the result.
    122 operations, 28 temporaries.
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
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
    beta_v = params[4]
    beta_w = params[5]
    W1 = params[6]
    W2 = params[7]
    W3 = params[8]
    x0 = m / beta_v
    x1 = m / (beta_v * beta_v)
    x2 = 1.0 / beta_w
    x3 = 1.0 / (beta_w * beta_w)
    x4 = 2.0 * e0
    x5 = e3 * x4
    x6 = 2.0 * e1
    x7 = e2 * e2
    x8 = e3 * e3
    x9 = e0 * e0
    x10 = e1 * e1
    x11 = x10 + x9
    x12 = 1.0 / (x11 + x7 + x8)
    x13 = M2 * x12
    x14 = e2 * x4
    x15 = M3 * x12
    x16 = -x7
    x17 = -x8
    x18 = M1 * x12
    x19 = (1.0 / 2.0) * I1 * omega1 * x2 - 1.0 / 2.0 * I1 * x3 * (
        x13 * (e2 * x6 + x5) + x15 * (2.0 * e1 * e3 - x14) + x18 * (x11 + x16 + x17)
    )
    x20 = e1 * x4
    x21 = -x10 + x9
    x22 = I2 * omega2 * x2 - I2 * x3 * (
        x13 * (x17 + x21 + x7) + x15 * (2.0 * e2 * e3 + x20) + x18 * (2.0 * e1 * e2 - x5)
    )
    x23 = (1.0 / 2.0) * e2
    x24 = I3 * omega3 * x2 - I3 * x3 * (
        x13 * (2.0 * e2 * e3 - x20) + x15 * (x16 + x21 + x8) + x18 * (e3 * x6 + x14)
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
    params: (9) m, I1, I2, I3, beta_v, beta_w, W1, W2, W3
    out: (12) filled with the result.
    106 operations, 28 temporaries.
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
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
    beta_v = params[4]
    beta_w = params[5]
    W1 = params[6]
    W2 = params[7]
    W3 = params[8]
    x0 = math.exp(-beta_v * t / m)
    x1 = 1.0 / beta_v
    x2 = x0 * (v1 - x1 * (F1 + W1))
    x3 = m * x1
    x4 = x0 * (v2 - x1 * (F2 + W2))
    x5 = x0 * (v3 - x1 * (F3 + W3))
    x6 = 1.0 / beta_w
    x7 = beta_w * t
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
    x23 = (
        omega1
        - x6 * (x17 * (e2 * x10 + x9) + x19 * (2.0 * e1 * e3 - x18) + x22 * (x15 + x20 + x21))
    ) * math.exp(-x7 / I1)
    x24 = e1 * x8
    x25 = x13 - x14
    x26 = (
        omega2
        - x6 * (x17 * (x11 + x21 + x25) + x19 * (2.0 * e2 * e3 + x24) + x22 * (2.0 * e1 * e2 - x9))
    ) * math.exp(-x7 / I2)
    x27 = (
        omega3
        - x6 * (x17 * (2.0 * e2 * e3 - x24) + x19 * (x12 + x20 + x25) + x22 * (e3 * x10 + x18))
    ) * math.exp(-x7 / I3)
    out[0] = -x2 * x3
    out[1] = -x3 * x4
    out[2] = -x3 * x5
    out[3] = x2
    out[4] = x4
    out[5] = x5
    out[6] = -I1 * x23 * x6
    out[7] = -I2 * x26 * x6
    out[8] = -I3 * x27 * x6
    out[9] = x23
    out[10] = x26
    out[11] = x27


@njit(cache=True)
def rates(t, state, force, moment, force_gradient, moment_gradient, mobility, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(t, state, force, moment, force_gradient, moment_gradient, params, out)
