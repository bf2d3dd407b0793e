"""Full model (A.25): translation and rotation of a rigid body, Euler-parameter rates.

Made by `python -m derivation` from derivation/rigid_body.py; do not edit.
SymPy 1.14.0. 1182 operations, 259 temporaries.

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
* [6] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [7] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [8] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
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
PARAMS = ("m", "I1", "I2", "I3", "beta_v", "beta_w", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ("force", "moment", "force_gradient", "moment_gradient")


@njit(cache=True)
def rhs(state, force, moment, params, out):
    """Rate of change of the state.

    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (9) m, I1, I2, I3, beta_v, beta_w, W1, W2, W3
    out: (14) filled with the result.
    176 operations, 28 temporaries.
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
    W1 = params[6]
    W2 = params[7]
    W3 = params[8]
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
        - beta_w * omega1
        + x13 * (e2 * x9 + x12)
        + x15 * (2.0 * e1 * e3 - x14)
        + x18 * (x16 + x17 + x5)
    ) / I1
    x20 = 2.0 * e2
    x21 = omega1 * omega3
    x22 = e1 * x11
    x23 = x3 - x4
    x24 = (
        -I1 * x21
        + I3 * x21
        - beta_w * omega2
        + x13 * (x1 + x17 + x23)
        + x15 * (e3 * x20 + x22)
        + x18 * (2.0 * e1 * e2 - x12)
    ) / I2
    x25 = 2.0 * e3
    x26 = omega1 * omega2
    x27 = (
        I1 * x26
        - I2 * x26
        - beta_w * omega3
        + x13 * (2.0 * e2 * e3 - x22)
        + x15 * (x16 + x2 + x23)
        + x18 * (e3 * x9 + x14)
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
    params: (9) m, I1, I2, I3, beta_v, beta_w, W1, W2, W3
    out: (14, 14) filled with the result.
    1006 operations, 231 temporaries.
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
    x0 = 1.0 / m
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
    x11 = x2 + x3
    x12 = x11 + x4 + x5
    x13 = 1.0 / x12
    x14 = 1.0 / I2
    x15 = 2.0 * e2
    x16 = x14 * x15
    x17 = x13 * x16
    x18 = e2 * x8
    x19 = 2.0 * e1
    x20 = e3 * x19
    x21 = x18 + x20
    x22 = 1.0 / I3
    x23 = 2.0 * e3
    x24 = x22 * x23
    x25 = x13 * x24
    x26 = -x4
    x27 = -x5
    x28 = x11 + x26 + x27
    x29 = 1.0 / I1
    x30 = x19 * x29
    x31 = x13 * x30
    x32 = x7 * (-x10 * x17 - x21 * x25 - x28 * x31)
    x33 = e2 * x19
    x34 = x33 + x9
    x35 = e1 * x8
    x36 = 2.0 * e2 * e3 - x35
    x37 = x2 - x3
    x38 = x27 + x37 + x4
    x39 = x7 * (-x17 * x38 - x25 * x36 - x31 * x34)
    x40 = 2.0 * e1 * e3 - x18
    x41 = e2 * x23
    x42 = x35 + x41
    x43 = x26 + x37 + x5
    x44 = x7 * (-x17 * x42 - x25 * x43 - x31 * x40)
    x45 = (edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3)
    x46 = -x13 * x45
    x47 = 1.0 / (x12 * x12)
    x48 = x45 * x47
    x49 = 2.0 * x48
    x50 = edot1 * x8
    x51 = edot0 * x19
    x52 = edot3 * x15
    x53 = edot2 * x23
    x54 = x50 - x51 - x52 + x53
    x55 = M2 * x13
    x56 = M3 * x13
    x57 = M1 * x13
    x58 = edot2 * x8
    x59 = edot3 * x19
    x60 = edot0 * x15
    x61 = edot1 * x23
    x62 = x58 + x59 - x60 - x61
    x63 = edot3 * x8
    x64 = edot2 * x19
    x65 = 2.0 * edot1
    x66 = e2 * x65
    x67 = edot0 * x23
    x68 = x63 - x64 + x66 - x67
    x69 = x62 * x68
    x70 = x29 * (I2 * x69 - I3 * x69 - beta_w * x54 + x28 * x57 + x34 * x55 + x40 * x56)
    x71 = x54 * x68
    x72 = x14 * (-I1 * x71 + I3 * x71 - beta_w * x62 + x10 * x57 + x38 * x55 + x42 * x56)
    x73 = x54 * x62
    x74 = x22 * (I1 * x73 - I2 * x73 - beta_w * x68 + x21 * x57 + x36 * x55 + x43 * x56)
    x75 = 8.0 / (x6 * x6)
    x76 = x75 * (-x15 * x72 - x19 * x70 - x23 * x74)
    x77 = 2.0 * I3
    x78 = edot2 * x68
    x79 = x77 * x78
    x80 = edot3 * x62
    x81 = x47 * x8
    x82 = M1 * x81
    x83 = M2 * x81
    x84 = M3 * x81
    x85 = beta_w * x65
    x86 = x57 * x8
    x87 = x23 * x55
    x88 = x15 * x56
    x89 = -2.0 * I2 * edot3 * x62 + x85 - x86 - x87 + x88
    x90 = 2.0 * I2 * edot2 * x68 - x28 * x82 - x34 * x83 - x40 * x84 - x77 * x80 - x79 - x89
    x91 = x65 * x68
    x92 = edot3 * x54
    x93 = 2.0 * I1
    x94 = x92 * x93
    x95 = 2.0 * beta_w
    x96 = edot2 * x95
    x97 = x55 * x8
    x98 = x19 * x56
    x99 = x23 * x57
    x100 = -2.0 * I3 * edot1 * x68 + x96 - x97 - x98 + x99
    x101 = -I1 * x91 + 2.0 * I3 * edot3 * x54 - x10 * x82 - x100 - x38 * x83 - x42 * x84 - x94
    x102 = x62 * x65
    x103 = I2 * x102
    x104 = 2.0 * I2
    x105 = edot2 * x54
    x106 = edot3 * x95
    x107 = x15 * x57
    x108 = x56 * x8
    x109 = x19 * x55
    x110 = -2.0 * I1 * edot2 * x54 + x106 - x107 - x108 + x109
    x111 = 2.0 * I1 * edot1 * x62 - x103 - x104 * x105 - x110 - x21 * x82 - x36 * x83 - x43 * x84
    x112 = x35 * x48
    x113 = 2.0 * x70
    x114 = edot2 * x62
    x115 = -x104 * x114
    x116 = edot3 * x68
    x117 = x19 * x47
    x118 = M1 * x117
    x119 = M2 * x117
    x120 = M3 * x117
    x121 = edot0 * x95
    x122 = x19 * x57
    x123 = x15 * x55
    x124 = x23 * x56
    x125 = -x116 * x77 + x121 + x122 + x123 + x124
    x126 = x104 * x116 + x114 * x77 + x115 - x118 * x28 - x119 * x34 - x120 * x40 + x125
    x127 = edot0 * x68
    x128 = x127 * x77
    x129 = 2.0 * I1 * edot0 * x68 - x10 * x118 - x105 * x77 - x110 - x119 * x38 - x120 * x42 - x128
    x130 = edot0 * x62
    x131 = x104 * x130
    x132 = (
        -x104 * x92
        - x118 * x21
        - x119 * x36
        - x120 * x43
        - x130 * x93
        + x131
        + x94
        + x96
        - x97
        - x98
        + x99
    )
    x133 = x18 * x48
    x134 = 2.0 * x72
    x135 = x15 * x47
    x136 = M2 * x135
    x137 = M3 * x135
    x138 = M1 * x135
    x139 = (
        -I3 * x102
        + x103
        - x104 * x127
        + x106
        - x107
        - x108
        + x109
        + x128
        - x136 * x34
        - x137 * x40
        - x138 * x28
    )
    x140 = x54 * x65
    x141 = -I1 * x140
    x142 = I3 * x140 - x10 * x138 + x116 * x93 + x125 - x136 * x38 - x137 * x42 + x141
    x143 = edot0 * x54
    x144 = x143 * x93
    x145 = 2.0 * I2 * edot0 * x54 - x136 * x36 - x137 * x43 - x138 * x21 - x144 - x80 * x93 - x89
    x146 = x48 * x9
    x147 = 2.0 * x74
    x148 = x23 * x47
    x149 = M1 * x148
    x150 = M2 * x148
    x151 = M3 * x148
    x152 = -I2 * x91 + 2.0 * I3 * edot0 * x62 - x100 - x131 - x149 * x28 - x150 * x34 - x151 * x40
    x153 = (
        -x10 * x149
        - x143 * x77
        + x144
        - x150 * x38
        - x151 * x42
        - x78 * x93
        + x79
        + x85
        - x86
        - x87
        + x88
    )
    x154 = (
        I2 * x140
        + x114 * x93
        + x115
        + x121
        + x122
        + x123
        + x124
        + x141
        - x149 * x21
        - x150 * x36
        - x151 * x43
    )
    x155 = x13 * x8
    x156 = x15 * x68
    x157 = I3 * x156
    x158 = x23 * x62
    x159 = beta_w * x19
    x160 = -I2 * x158 + x159
    x161 = -I2 * x156 + I3 * x158 + x157 + x160
    x162 = x19 * x68
    x163 = -I3 * x162
    x164 = x23 * x54
    x165 = beta_w * x15
    x166 = I1 * x164 + x165
    x167 = I1 * x162 - I3 * x164 + x163 + x166
    x168 = x19 * x62
    x169 = I2 * x168
    x170 = x15 * x54
    x171 = beta_w * x23
    x172 = -I1 * x170 + x171
    x173 = -I1 * x168 + I2 * x170 + x169 + x172
    x174 = -2.0 * I2 * e2 * x62
    x175 = x15 * x62
    x176 = x23 * x68
    x177 = beta_w * x8
    x178 = -2.0 * I3 * e3 * x68 + x177
    x179 = -I2 * x176 - I3 * x175 - x174 - x178
    x180 = x68 * x8
    x181 = I3 * x180
    x182 = -I1 * x180 + I3 * x170 + x172 + x181
    x183 = x62 * x8
    x184 = I2 * x183
    x185 = 2.0 * I1 * e0 * x62 + 2.0 * I2 * e3 * x54 - x166 - x184
    x186 = 2.0 * I2 * e0 * x68 + 2.0 * I3 * e1 * x62 - x169 - x171 - x181
    x187 = -2.0 * I1 * e1 * x54
    x188 = x19 * x54
    x189 = -I1 * x176 - I3 * x188 - x178 - x187
    x190 = x54 * x8
    x191 = I1 * x190
    x192 = I1 * x158 - I2 * x190 + x160 + x191
    x193 = I2 * x162 - I3 * x183 + x163 + x165 + x184
    x194 = 2.0 * I1 * e2 * x68 + 2.0 * I3 * e0 * x54 - x157 - x159 - x191
    x195 = -I1 * x175 - I2 * x188 - x174 - x177 - x187
    x196 = x14 * x23
    x197 = x13 * x196
    x198 = x15 * x22
    x199 = x13 * x198
    x200 = x155 * x29
    x201 = x7 * (-x10 * x197 + x199 * x21 + x200 * x28)
    x202 = x7 * (-x197 * x38 + x199 * x36 + x200 * x34)
    x203 = x7 * (-x197 * x42 + x199 * x43 + x200 * x40)
    x204 = x75 * (x15 * x74 - x23 * x72 + x70 * x8)
    x205 = x29 * x8
    x206 = x33 * x48
    x207 = x20 * x48
    x208 = x13 * x19
    x209 = x14 * x155
    x210 = x208 * x22
    x211 = x23 * x29
    x212 = x13 * x211
    x213 = x7 * (x10 * x209 - x21 * x210 + x212 * x28)
    x214 = x7 * (x209 * x38 - x210 * x36 + x212 * x34)
    x215 = x7 * (x209 * x42 - x210 * x43 + x212 * x40)
    x216 = x75 * (-x19 * x74 + x23 * x70 + x72 * x8)
    x217 = x14 * x8
    x218 = x19 * x22
    x219 = x41 * x48
    x220 = x13 * x15
    x221 = x14 * x208
    x222 = x155 * x22
    x223 = x220 * x29
    x224 = x7 * (x10 * x221 + x21 * x222 - x223 * x28)
    x225 = x7 * (x221 * x38 + x222 * x36 - x223 * x34)
    x226 = x7 * (x221 * x42 + x222 * x43 - x223 * x40)
    x227 = x75 * (-x15 * x70 + x19 * x72 + x74 * x8)
    x228 = x15 * x29
    x229 = x14 * x19
    x230 = x22 * x8
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
    out[10, 0] = DM11 * x32 + DM21 * x39 + DM31 * x44
    out[10, 1] = DM12 * x32 + DM22 * x39 + DM32 * x44
    out[10, 2] = DM13 * x32 + DM23 * x39 + DM33 * x44
    out[10, 3] = -e0 * x76 + x2 * x49 + x46 + x7 * (-x101 * x16 - x111 * x24 - x30 * x90)
    out[10, 4] = -e1 * x76 + x112 + x7 * (-x113 - x126 * x30 - x129 * x16 - x132 * x24)
    out[10, 5] = -e2 * x76 + x133 + x7 * (-x134 - x139 * x30 - x142 * x16 - x145 * x24)
    out[10, 6] = -e3 * x76 + x146 + x7 * (-x147 - x152 * x30 - x153 * x16 - x154 * x24)
    out[10, 7] = 0.0
    out[10, 8] = 0.0
    out[10, 9] = 0.0
    out[10, 10] = -edot0 * x155 + x7 * (-x16 * x167 - x161 * x30 - x173 * x24)
    out[10, 11] = -x13 * x50 + x7 * (-x16 * x182 - x179 * x30 - x185 * x24)
    out[10, 12] = -x13 * x58 + x7 * (-x16 * x189 - x186 * x30 - x192 * x24)
    out[10, 13] = -x13 * x63 + x7 * (-x16 * x194 - x193 * x30 - x195 * x24)
    out[11, 0] = DM11 * x201 + DM21 * x202 + DM31 * x203
    out[11, 1] = DM12 * x201 + DM22 * x202 + DM32 * x203
    out[11, 2] = DM13 * x201 + DM23 * x202 + DM33 * x203
    out[11, 3] = -e0 * x204 + x112 + x7 * (-x101 * x196 + x111 * x198 + x113 + x205 * x90)
    out[11, 4] = -e1 * x204 + x3 * x49 + x46 + x7 * (x126 * x205 - x129 * x196 + x132 * x198)
    out[11, 5] = -e2 * x204 + x206 + x7 * (x139 * x205 - x142 * x196 + x145 * x198 + x147)
    out[11, 6] = -e3 * x204 + x207 + x7 * (-x134 + x152 * x205 - x153 * x196 + x154 * x198)
    out[11, 7] = 0.0
    out[11, 8] = 0.0
    out[11, 9] = 0.0
    out[11, 10] = -x13 * x51 + x7 * (x161 * x205 - x167 * x196 + x173 * x198)
    out[11, 11] = -edot1 * x208 + x7 * (x179 * x205 - x182 * x196 + x185 * x198)
    out[11, 12] = -x13 * x64 + x7 * (x186 * x205 - x189 * x196 + x192 * x198)
    out[11, 13] = -x13 * x59 + x7 * (x193 * x205 - x194 * x196 + x195 * x198)
    out[12, 0] = DM11 * x213 + DM21 * x214 + DM31 * x215
    out[12, 1] = DM12 * x213 + DM22 * x214 + DM32 * x215
    out[12, 2] = DM13 * x213 + DM23 * x214 + DM33 * x215
    out[12, 3] = -e0 * x216 + x133 + x7 * (x101 * x217 - x111 * x218 + x134 + x211 * x90)
    out[12, 4] = (
        -e1 * x216
        + x206
        + x7 * (2.0 * e0 * x129 * x14 + 2.0 * e3 * x126 * x29 - x132 * x218 - x147)
    )
    out[12, 5] = -e2 * x216 + x4 * x49 + x46 + x7 * (x139 * x211 + x142 * x217 - x145 * x218)
    out[12, 6] = -e3 * x216 + x219 + x7 * (x113 + x152 * x211 + x153 * x217 - x154 * x218)
    out[12, 7] = 0.0
    out[12, 8] = 0.0
    out[12, 9] = 0.0
    out[12, 10] = -x13 * x60 + x7 * (x161 * x211 + x167 * x217 - x173 * x218)
    out[12, 11] = -x13 * x66 + x7 * (x179 * x211 + x182 * x217 - x185 * x218)
    out[12, 12] = -edot2 * x220 + x7 * (x186 * x211 + x189 * x217 - x192 * x218)
    out[12, 13] = -x13 * x52 + x7 * (x193 * x211 + x194 * x217 - x195 * x218)
    out[13, 0] = DM11 * x224 + DM21 * x225 + DM31 * x226
    out[13, 1] = DM12 * x224 + DM22 * x225 + DM32 * x226
    out[13, 2] = DM13 * x224 + DM23 * x225 + DM33 * x226
    out[13, 3] = -e0 * x227 + x146 + x7 * (x101 * x229 + x111 * x230 + x147 - x228 * x90)
    out[13, 4] = -e1 * x227 + x207 + x7 * (-x126 * x228 + x129 * x229 + x132 * x230 + x134)
    out[13, 5] = -e2 * x227 + x219 + x7 * (-x113 - x139 * x228 + x142 * x229 + x145 * x230)
    out[13, 6] = -e3 * x227 + x46 + x49 * x5 + x7 * (-x152 * x228 + x153 * x229 + x154 * x230)
    out[13, 7] = 0.0
    out[13, 8] = 0.0
    out[13, 9] = 0.0
    out[13, 10] = -x13 * x67 + x7 * (-x161 * x228 + x167 * x229 + x173 * x230)
    out[13, 11] = -x13 * x61 + x7 * (-x179 * x228 + x182 * x229 + x185 * x230)
    out[13, 12] = -x13 * x53 + x7 * (-x186 * x228 + x189 * x229 + x192 * x230)
    out[13, 13] = -edot3 * x13 * x23 + x7 * (-x193 * x228 + x194 * x229 + x195 * x230)


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, moment, params, out)
