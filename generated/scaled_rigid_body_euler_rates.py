"""Scaled model (4.17): translation and rotation of a rigid body, Euler-parameter rates.

Made by `python -m derivation` from derivation/multiscale.py and derivation/rigid_body.py; do not edit.
SymPy 1.14.0. 1196 operations, 264 temporaries.

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
* [1] `I1` [kg m^2] principal moment of inertia about P1, (A.13)
* [2] `I2` [kg m^2] principal moment of inertia about P2, (A.13)
* [3] `I3` [kg m^2] principal moment of inertia about P3, (A.13)
* [4] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [5] `beta_w` [N m s] rotational drag coefficient, (2.15)
* [6] `a2` [1] scaling factor of the generalised active forces, (4.12)
* [7] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [8] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [9] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
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
PARAMS = ("m", "I1", "I2", "I3", "beta_v", "beta_w", "a2", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ("force", "moment", "force_gradient", "moment_gradient")


@njit(cache=True)
def rhs(state, force, moment, params, out):
    """Rate of change of the state.

    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (10) as listed above
    out: (14) filled with the result.
    179 operations, 28 temporaries.
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
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
    beta_v = params[4]
    beta_w = params[5]
    a2 = params[6]
    W1 = params[7]
    W2 = params[8]
    W3 = params[9]
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
    x10 = omega2 * omega3
    x11 = 2.0 * e0
    x12 = e3 * x11
    x13 = M2 * x6
    x14 = e2 * x11
    x15 = M3 * x6
    x16 = -x1
    x17 = -x2
    x18 = M1 * x6
    x19 = (
        I2 * x10
        - I3 * x10
        + a2
        * (
            -beta_w * omega1
            + x13 * (e2 * x9 + x12)
            + x15 * (2.0 * e1 * e3 - x14)
            + x18 * (x16 + x17 + x5)
        )
    ) / I1
    x20 = 2.0 * e2
    x21 = omega1 * omega3
    x22 = e1 * x11
    x23 = x3 - x4
    x24 = (
        -I1 * x21
        + I3 * x21
        + a2
        * (
            -beta_w * omega2
            + x13 * (x1 + x17 + x23)
            + x15 * (e3 * x20 + x22)
            + x18 * (2.0 * e1 * e2 - x12)
        )
    ) / I2
    x25 = 2.0 * e3
    x26 = omega1 * omega2
    x27 = (
        I1 * x26
        - I2 * x26
        + a2
        * (
            -beta_w * omega3
            + x13 * (2.0 * e2 * e3 - x22)
            + x15 * (x16 + x2 + x23)
            + x18 * (e3 * x9 + x14)
        )
    ) / I3
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
    out[10] = -e0 * x7 + x8 * (-x19 * x9 - x20 * x24 - x25 * x27)
    out[11] = -e1 * x7 + x8 * (x11 * x19 + x20 * x27 - x24 * x25)
    out[12] = -e2 * x7 + x8 * (x11 * x24 + x19 * x25 - x27 * x9)
    out[13] = -e3 * x7 + x8 * (x11 * x27 - x19 * x20 + x24 * x9)


@njit(cache=True)
def jacobian(state, force, moment, force_gradient, moment_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    params: (10) as listed above
    out: (14, 14) filled with the result.
    1017 operations, 236 temporaries.
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
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
    beta_v = params[4]
    beta_w = params[5]
    a2 = params[6]
    x0 = a2 / m
    x1 = -beta_v * x0
    x2 = e0 * e0
    x3 = e1 * e1
    x4 = e2 * e2
    x5 = e3 * e3
    x6 = 4.0 * x2 + 4.0 * x3 + 4.0 * x4 + 4.0 * x5
    x7 = 1.0 / x6
    x8 = 2.0 * e0
    x9 = e3 * x8
    x10 = 2.0 * e1 * e2 - x9
    x11 = 1.0 / I2
    x12 = 2.0 * e2
    x13 = x11 * x12
    x14 = x2 + x3
    x15 = x14 + x4 + x5
    x16 = 1.0 / x15
    x17 = a2 * x16
    x18 = x13 * x17
    x19 = e2 * x8
    x20 = 2.0 * e1
    x21 = e3 * x20
    x22 = x19 + x21
    x23 = 1.0 / I3
    x24 = 2.0 * e3
    x25 = x23 * x24
    x26 = x17 * x25
    x27 = -x4
    x28 = -x5
    x29 = x14 + x27 + x28
    x30 = 1.0 / I1
    x31 = x20 * x30
    x32 = x17 * x31
    x33 = x7 * (-x10 * x18 - x22 * x26 - x29 * x32)
    x34 = e2 * x20
    x35 = x34 + x9
    x36 = e1 * x8
    x37 = 2.0 * e2 * e3 - x36
    x38 = x2 - x3
    x39 = x28 + x38 + x4
    x40 = x7 * (-x18 * x39 - x26 * x37 - x32 * x35)
    x41 = 2.0 * e1 * e3 - x19
    x42 = e2 * x24
    x43 = x36 + x42
    x44 = x27 + x38 + x5
    x45 = x7 * (-x18 * x43 - x26 * x44 - x32 * x41)
    x46 = (edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3)
    x47 = -x16 * x46
    x48 = 1.0 / (x15 * x15)
    x49 = x46 * x48
    x50 = 2.0 * x49
    x51 = edot2 * x8
    x52 = edot3 * x20
    x53 = edot0 * x12
    x54 = edot1 * x24
    x55 = x51 + x52 - x53 - x54
    x56 = edot3 * x8
    x57 = edot2 * x20
    x58 = 2.0 * edot1
    x59 = e2 * x58
    x60 = edot0 * x24
    x61 = x56 - x57 + x59 - x60
    x62 = x55 * x61
    x63 = edot1 * x8
    x64 = edot0 * x20
    x65 = edot3 * x12
    x66 = edot2 * x24
    x67 = x63 - x64 - x65 + x66
    x68 = M2 * x16
    x69 = M3 * x16
    x70 = M1 * x16
    x71 = x30 * (I2 * x62 - I3 * x62 + a2 * (-beta_w * x67 + x29 * x70 + x35 * x68 + x41 * x69))
    x72 = x61 * x67
    x73 = x11 * (-I1 * x72 + I3 * x72 + a2 * (-beta_w * x55 + x10 * x70 + x39 * x68 + x43 * x69))
    x74 = x55 * x67
    x75 = x23 * (I1 * x74 - I2 * x74 + a2 * (-beta_w * x61 + x22 * x70 + x37 * x68 + x44 * x69))
    x76 = 8.0 / (x6 * x6)
    x77 = x76 * (-x12 * x73 - x20 * x71 - x24 * x75)
    x78 = edot2 * x61
    x79 = 2.0 * I2
    x80 = edot3 * x55
    x81 = x79 * x80
    x82 = 2.0 * I3
    x83 = x78 * x82
    x84 = x48 * x8
    x85 = M1 * x84
    x86 = M2 * x84
    x87 = M3 * x84
    x88 = beta_w * x58
    x89 = x70 * x8
    x90 = x24 * x68
    x91 = x12 * x69
    x92 = x88 - x89 - x90 + x91
    x93 = a2 * (-x29 * x85 - x35 * x86 - x41 * x87 - x92) + x78 * x79 - x80 * x82 + x81 - x83
    x94 = x58 * x61
    x95 = edot3 * x67
    x96 = 2.0 * I1
    x97 = x95 * x96
    x98 = I3 * x94
    x99 = 2.0 * beta_w
    x100 = edot2 * x99
    x101 = x68 * x8
    x102 = x20 * x69
    x103 = x24 * x70
    x104 = x100 - x101 - x102 + x103
    x105 = -I1 * x94 + a2 * (-x10 * x85 - x104 - x39 * x86 - x43 * x87) + x82 * x95 - x97 + x98
    x106 = x55 * x58
    x107 = edot2 * x67
    x108 = x107 * x96
    x109 = I2 * x106
    x110 = edot3 * x99
    x111 = x12 * x70
    x112 = x69 * x8
    x113 = x20 * x68
    x114 = x110 - x111 - x112 + x113
    x115 = I1 * x106 + a2 * (-x114 - x22 * x85 - x37 * x86 - x44 * x87) - x107 * x79 + x108 - x109
    x116 = x36 * x49
    x117 = 2.0 * x71
    x118 = edot2 * x55
    x119 = -x118 * x79
    x120 = edot3 * x61
    x121 = -x120 * x82
    x122 = x20 * x48
    x123 = M1 * x122
    x124 = M2 * x122
    x125 = M3 * x122
    x126 = edot0 * x99 + x12 * x68 + x20 * x70 + x24 * x69
    x127 = (
        a2 * (-x123 * x29 - x124 * x35 - x125 * x41 + x126) + x118 * x82 + x119 + x120 * x79 + x121
    )
    x128 = edot0 * x61
    x129 = x128 * x82
    x130 = (
        a2 * (-x10 * x123 - x114 - x124 * x39 - x125 * x43) - x107 * x82 + x108 + x128 * x96 - x129
    )
    x131 = edot0 * x55
    x132 = x131 * x79
    x133 = (
        a2 * (x100 - x101 - x102 + x103 - x123 * x22 - x124 * x37 - x125 * x44)
        - x131 * x96
        + x132
        - x79 * x95
        + x97
    )
    x134 = x19 * x49
    x135 = 2.0 * x73
    x136 = x12 * x48
    x137 = M2 * x136
    x138 = M3 * x136
    x139 = M1 * x136
    x140 = (
        -I3 * x106
        + a2 * (x110 - x111 - x112 + x113 - x137 * x35 - x138 * x41 - x139 * x29)
        + x109
        - x128 * x79
        + x129
    )
    x141 = x58 * x67
    x142 = -I1 * x141
    x143 = (
        I3 * x141 + a2 * (-x10 * x139 + x126 - x137 * x39 - x138 * x43) + x120 * x96 + x121 + x142
    )
    x144 = edot0 * x67
    x145 = x144 * x96
    x146 = a2 * (-x137 * x37 - x138 * x44 - x139 * x22 - x92) + x144 * x79 - x145 - x80 * x96 + x81
    x147 = x49 * x9
    x148 = 2.0 * x75
    x149 = x24 * x48
    x150 = M1 * x149
    x151 = M2 * x149
    x152 = M3 * x149
    x153 = -I2 * x94 + a2 * (-x104 - x150 * x29 - x151 * x35 - x152 * x41) + x131 * x82 - x132 + x98
    x154 = (
        a2 * (-x10 * x150 - x151 * x39 - x152 * x43 + x88 - x89 - x90 + x91)
        - x144 * x82
        + x145
        - x78 * x96
        + x83
    )
    x155 = I2 * x141 + a2 * (x126 - x150 * x22 - x151 * x37 - x152 * x44) + x118 * x96 + x119 + x142
    x156 = x16 * x8
    x157 = x12 * x61
    x158 = I3 * x157
    x159 = x24 * x55
    x160 = a2 * beta_w
    x161 = x160 * x20
    x162 = -I2 * x159 + x161
    x163 = -I2 * x157 + I3 * x159 + x158 + x162
    x164 = x20 * x61
    x165 = -I3 * x164
    x166 = x24 * x67
    x167 = x12 * x160
    x168 = I1 * x166 + x167
    x169 = I1 * x164 - I3 * x166 + x165 + x168
    x170 = x20 * x55
    x171 = I2 * x170
    x172 = x12 * x67
    x173 = x160 * x24
    x174 = -I1 * x172 + x173
    x175 = -I1 * x170 + I2 * x172 + x171 + x174
    x176 = -2.0 * I2 * e2 * x55
    x177 = x12 * x55
    x178 = x24 * x61
    x179 = x160 * x8
    x180 = -2.0 * I3 * e3 * x61 + x179
    x181 = -I2 * x178 - I3 * x177 - x176 - x180
    x182 = x61 * x8
    x183 = I3 * x182
    x184 = -I1 * x182 + I3 * x172 + x174 + x183
    x185 = x55 * x8
    x186 = I2 * x185
    x187 = 2.0 * I1 * e0 * x55 + 2.0 * I2 * e3 * x67 - x168 - x186
    x188 = 2.0 * I2 * e0 * x61 + 2.0 * I3 * e1 * x55 - x171 - x173 - x183
    x189 = -2.0 * I1 * e1 * x67
    x190 = x20 * x67
    x191 = -I1 * x178 - I3 * x190 - x180 - x189
    x192 = x67 * x8
    x193 = I1 * x192
    x194 = I1 * x159 - I2 * x192 + x162 + x193
    x195 = I2 * x164 - I3 * x185 + x165 + x167 + x186
    x196 = 2.0 * I1 * e2 * x61 + 2.0 * I3 * e0 * x67 - x158 - x161 - x193
    x197 = -I1 * x177 - I2 * x190 - x176 - x179 - x189
    x198 = x11 * x24
    x199 = x17 * x198
    x200 = x12 * x23
    x201 = x17 * x200
    x202 = a2 * x156
    x203 = x202 * x30
    x204 = x7 * (-x10 * x199 + x201 * x22 + x203 * x29)
    x205 = x7 * (-x199 * x39 + x201 * x37 + x203 * x35)
    x206 = x7 * (-x199 * x43 + x201 * x44 + x203 * x41)
    x207 = x76 * (x12 * x75 - x24 * x73 + x71 * x8)
    x208 = x30 * x8
    x209 = x34 * x49
    x210 = x21 * x49
    x211 = x16 * x20
    x212 = x11 * x202
    x213 = x22 * x23
    x214 = a2 * x211
    x215 = x24 * x30
    x216 = x17 * x215
    x217 = x7 * (x10 * x212 - x213 * x214 + x216 * x29)
    x218 = x214 * x23
    x219 = x7 * (x212 * x39 + x216 * x35 - x218 * x37)
    x220 = x7 * (x212 * x43 + x216 * x41 - x218 * x44)
    x221 = x76 * (-x20 * x75 + x24 * x71 + x73 * x8)
    x222 = x11 * x8
    x223 = x20 * x23
    x224 = x42 * x49
    x225 = x12 * x16
    x226 = x11 * x214
    x227 = a2 * x225 * x30
    x228 = x7 * (x10 * x226 + x202 * x213 - x227 * x29)
    x229 = x202 * x23
    x230 = x7 * (x226 * x39 - x227 * x35 + x229 * x37)
    x231 = x7 * (x226 * x43 - x227 * x41 + x229 * x44)
    x232 = x76 * (-x12 * x71 + x20 * x73 + x75 * x8)
    x233 = x12 * x30
    x234 = x11 * x20
    x235 = x23 * x8
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
    out[10, 0] = DM11 * x33 + DM21 * x40 + DM31 * x45
    out[10, 1] = DM12 * x33 + DM22 * x40 + DM32 * x45
    out[10, 2] = DM13 * x33 + DM23 * x40 + DM33 * x45
    out[10, 3] = -e0 * x77 + x2 * x50 + x47 + x7 * (-x105 * x13 - x115 * x25 - x31 * x93)
    out[10, 4] = -e1 * x77 + x116 + x7 * (-x117 - x127 * x31 - x13 * x130 - x133 * x25)
    out[10, 5] = -e2 * x77 + x134 + x7 * (-x13 * x143 - x135 - x140 * x31 - x146 * x25)
    out[10, 6] = -e3 * x77 + x147 + x7 * (-x13 * x154 - x148 - x153 * x31 - x155 * x25)
    out[10, 7] = 0.0
    out[10, 8] = 0.0
    out[10, 9] = 0.0
    out[10, 10] = -edot0 * x156 + x7 * (-x13 * x169 - x163 * x31 - x175 * x25)
    out[10, 11] = -x16 * x63 + x7 * (-x13 * x184 - x181 * x31 - x187 * x25)
    out[10, 12] = -x16 * x51 + x7 * (-x13 * x191 - x188 * x31 - x194 * x25)
    out[10, 13] = -x16 * x56 + x7 * (-x13 * x196 - x195 * x31 - x197 * x25)
    out[11, 0] = DM11 * x204 + DM21 * x205 + DM31 * x206
    out[11, 1] = DM12 * x204 + DM22 * x205 + DM32 * x206
    out[11, 2] = DM13 * x204 + DM23 * x205 + DM33 * x206
    out[11, 3] = -e0 * x207 + x116 + x7 * (-x105 * x198 + x115 * x200 + x117 + x208 * x93)
    out[11, 4] = -e1 * x207 + x3 * x50 + x47 + x7 * (x127 * x208 - x130 * x198 + x133 * x200)
    out[11, 5] = -e2 * x207 + x209 + x7 * (x140 * x208 - x143 * x198 + x146 * x200 + x148)
    out[11, 6] = -e3 * x207 + x210 + x7 * (-x135 + x153 * x208 - x154 * x198 + x155 * x200)
    out[11, 7] = 0.0
    out[11, 8] = 0.0
    out[11, 9] = 0.0
    out[11, 10] = -x16 * x64 + x7 * (x163 * x208 - x169 * x198 + x175 * x200)
    out[11, 11] = -edot1 * x211 + x7 * (x181 * x208 - x184 * x198 + x187 * x200)
    out[11, 12] = -x16 * x57 + x7 * (x188 * x208 - x191 * x198 + x194 * x200)
    out[11, 13] = -x16 * x52 + x7 * (x195 * x208 - x196 * x198 + x197 * x200)
    out[12, 0] = DM11 * x217 + DM21 * x219 + DM31 * x220
    out[12, 1] = DM12 * x217 + DM22 * x219 + DM32 * x220
    out[12, 2] = DM13 * x217 + DM23 * x219 + DM33 * x220
    out[12, 3] = -e0 * x221 + x134 + x7 * (x105 * x222 - x115 * x223 + x135 + x215 * x93)
    out[12, 4] = (
        -e1 * x221
        + x209
        + x7 * (2.0 * e0 * x11 * x130 + 2.0 * e3 * x127 * x30 - x133 * x223 - x148)
    )
    out[12, 5] = -e2 * x221 + x4 * x50 + x47 + x7 * (x140 * x215 + x143 * x222 - x146 * x223)
    out[12, 6] = -e3 * x221 + x224 + x7 * (x117 + x153 * x215 + x154 * x222 - x155 * x223)
    out[12, 7] = 0.0
    out[12, 8] = 0.0
    out[12, 9] = 0.0
    out[12, 10] = -x16 * x53 + x7 * (x163 * x215 + x169 * x222 - x175 * x223)
    out[12, 11] = -x16 * x59 + x7 * (x181 * x215 + x184 * x222 - x187 * x223)
    out[12, 12] = -edot2 * x225 + x7 * (x188 * x215 + x191 * x222 - x194 * x223)
    out[12, 13] = -x16 * x65 + x7 * (x195 * x215 + x196 * x222 - x197 * x223)
    out[13, 0] = DM11 * x228 + DM21 * x230 + DM31 * x231
    out[13, 1] = DM12 * x228 + DM22 * x230 + DM32 * x231
    out[13, 2] = DM13 * x228 + DM23 * x230 + DM33 * x231
    out[13, 3] = -e0 * x232 + x147 + x7 * (x105 * x234 + x115 * x235 + x148 - x233 * x93)
    out[13, 4] = -e1 * x232 + x210 + x7 * (-x127 * x233 + x130 * x234 + x133 * x235 + x135)
    out[13, 5] = -e2 * x232 + x224 + x7 * (-x117 - x140 * x233 + x143 * x234 + x146 * x235)
    out[13, 6] = -e3 * x232 + x47 + x5 * x50 + x7 * (-x153 * x233 + x154 * x234 + x155 * x235)
    out[13, 7] = 0.0
    out[13, 8] = 0.0
    out[13, 9] = 0.0
    out[13, 10] = -x16 * x60 + x7 * (-x163 * x233 + x169 * x234 + x175 * x235)
    out[13, 11] = -x16 * x54 + x7 * (-x181 * x233 + x184 * x234 + x187 * x235)
    out[13, 12] = -x16 * x66 + x7 * (-x188 * x233 + x191 * x234 + x194 * x235)
    out[13, 13] = -edot3 * x16 * x24 + x7 * (-x195 * x233 + x196 * x234 + x197 * x235)


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, moment, params, out)
