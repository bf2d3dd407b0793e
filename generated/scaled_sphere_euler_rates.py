"""Scaled model (4.17): translation and rotation of a sphere, Euler-parameter rates.

Made by `python -m derivation` from derivation/multiscale.py and derivation/rigid_body.py and derivation/drag.py; do not edit.
SymPy 1.14.0. 2246 operations, 450 temporaries.

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
* [2] `a2` [1] scaling factor of the generalised active forces, (4.12)
* [3] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [4] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [5] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
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
PARAMS = ("m", "I", "a2", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment", "mobility")
JACOBIAN_INPUTS = (
    "force",
    "moment",
    "mobility",
    "force_gradient",
    "moment_gradient",
    "mobility_gradient",
)
LINEAR_DRAG = False


@njit(cache=True)
def rhs(t, state, force, moment, mobility, params, out):
    """Rate of change of the state.

    t: time since release [s]
    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    params: (6) m, I, a2, W1, W2, W3
    out: (14) filled with the result.
    240 operations, 51 temporaries.
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
    b_parallel = mobility[0]
    b_perpendicular = mobility[1]
    b_turn = mobility[2]
    b_spin = mobility[3]
    b_roll = mobility[4]
    m = params[0]
    I = params[1]
    a2 = params[2]
    W1 = params[3]
    W2 = params[4]
    W3 = params[5]
    omega1 = 2.0 * e0 * edot1 - 2.0 * e1 * edot0 - 2.0 * e2 * edot3 + 2.0 * e3 * edot2
    omega2 = 2.0 * e0 * edot2 + 2.0 * e1 * edot3 - 2.0 * e2 * edot0 - 2.0 * e3 * edot1
    omega3 = 2.0 * e0 * edot3 - 2.0 * e1 * edot2 + 2.0 * e2 * edot1 - 2.0 * e3 * edot0
    x0 = 1.0 / (b_parallel * b_turn - (b_roll * b_roll))
    x1 = b_turn * x0
    x2 = 2.0 * e0
    x3 = e3 * x2
    x4 = 2.0 * e2
    x5 = e1 * x4 + x3
    x6 = e1 * e1
    x7 = e3 * e3
    x8 = e0 * e0
    x9 = e2 * e2
    x10 = x8 + x9
    x11 = 1.0 / (x10 + x6 + x7)
    x12 = omega1 * x11
    x13 = e1 * x2
    x14 = 2.0 * e2 * e3 - x13
    x15 = omega3 * x11
    x16 = -x6
    x17 = -x7
    x18 = x10 + x16 + x17
    x19 = omega2 * x11
    x20 = b_roll * x0
    x21 = a2 / m
    x22 = 2.0 * e1 * e2 - x3
    x23 = e2 * x2
    x24 = 2.0 * e1
    x25 = e3 * x24 + x23
    x26 = x8 - x9
    x27 = x17 + x26 + x6
    x28 = x11 * ((edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3))
    x29 = 1.0 / (4.0 * x6 + 4.0 * x7 + 4.0 * x8 + 4.0 * x9)
    x30 = b_parallel * x0
    x31 = M2 * x11
    x32 = 2.0 * e1 * e3 - x23
    x33 = M3 * x11
    x34 = M1 * x11
    x35 = e3 * x4 + x13
    x36 = x16 + x26 + x7
    x37 = (-x30 + 1.0 / b_spin) * (x12 * x32 + x15 * x36 + x19 * x35)
    x38 = v1 * x11
    x39 = v2 * x11
    x40 = v3 * x11
    x41 = x11 * (x14 * x39 + x25 * x38 + x36 * x40)
    x42 = x18 * x39 + x22 * x38 + x35 * x40
    x43 = x11 * x36
    x44 = a2 / I
    x45 = x44 * (
        -omega1 * x30
        - x11 * x32 * x37
        + x20 * (x35 * x41 - x42 * x43)
        + x27 * x34
        + x31 * x5
        + x32 * x33
    )
    x46 = x11 * x35
    x47 = x27 * x38 + x32 * x40 + x39 * x5
    x48 = x44 * (
        -omega2 * x30
        + x18 * x31
        + x20 * (x11 * x36 * x47 - x32 * x41)
        + x22 * x34
        + x33 * x35
        - x37 * x46
    )
    x49 = 2.0 * e3
    x50 = x44 * (
        -omega3 * x30
        + x14 * x31
        + x20 * (x11 * x32 * x42 - x46 * x47)
        + x25 * x34
        + x33 * x36
        - x37 * x43
    )
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = edot0
    out[4] = edot1
    out[5] = edot2
    out[6] = edot3
    out[7] = x21 * (F1 + W1 - v1 * x1 + x20 * (x12 * x5 + x14 * x15 + x18 * x19))
    out[8] = x21 * (F2 + W2 - v2 * x1 + x20 * (-x12 * x27 - x15 * x25 - x19 * x22))
    out[9] = x21 * (F3 + W3 - v3 / b_perpendicular)
    out[10] = -e0 * x28 + x29 * (-x24 * x45 - x4 * x48 - x49 * x50)
    out[11] = -e1 * x28 + x29 * (x2 * x45 + x4 * x50 - x48 * x49)
    out[12] = -e2 * x28 + x29 * (x2 * x48 - x24 * x50 + x45 * x49)
    out[13] = -e3 * x28 + x29 * (x2 * x50 + x24 * x48 - x4 * x45)


@njit(cache=True)
def jacobian(
    t,
    state,
    force,
    moment,
    mobility,
    force_gradient,
    moment_gradient,
    mobility_gradient,
    params,
    out,
):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    t: time since release [s]
    state: (14) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    mobility_gradient: (5, 3) as listed above
    params: (6) m, I, a2, W1, W2, W3
    out: (14, 14) filled with the result.
    2006 operations, 399 temporaries.
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
    M1 = moment[0]
    M2 = moment[1]
    M3 = moment[2]
    b_parallel = mobility[0]
    b_perpendicular = mobility[1]
    b_turn = mobility[2]
    b_spin = mobility[3]
    b_roll = mobility[4]
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
    Db11 = mobility_gradient[0, 0]
    Db12 = mobility_gradient[0, 1]
    Db13 = mobility_gradient[0, 2]
    Db21 = mobility_gradient[1, 0]
    Db22 = mobility_gradient[1, 1]
    Db23 = mobility_gradient[1, 2]
    Db31 = mobility_gradient[2, 0]
    Db32 = mobility_gradient[2, 1]
    Db33 = mobility_gradient[2, 2]
    Db41 = mobility_gradient[3, 0]
    Db42 = mobility_gradient[3, 1]
    Db43 = mobility_gradient[3, 2]
    Db51 = mobility_gradient[4, 0]
    Db52 = mobility_gradient[4, 1]
    Db53 = mobility_gradient[4, 2]
    m = params[0]
    I = params[1]
    a2 = params[2]
    x0 = a2 / m
    x1 = b_turn * b_turn
    x2 = b_parallel * b_turn
    x3 = b_roll * b_roll
    x4 = x2 - x3
    x5 = 1.0 / (x4 * x4)
    x6 = 2.0 * e1
    x7 = e0 * x6
    x8 = 2.0 * e2 * e3 - x7
    x9 = 2.0 * edot3
    x10 = e0 * x9
    x11 = edot2 * x6
    x12 = 2.0 * edot1
    x13 = e2 * x12
    x14 = 2.0 * e3
    x15 = edot0 * x14
    x16 = x10 - x11 + x13 - x15
    x17 = e1 * e1
    x18 = e3 * e3
    x19 = e0 * e0
    x20 = e2 * e2
    x21 = x19 + x20
    x22 = x17 + x18 + x21
    x23 = 1.0 / x22
    x24 = x16 * x23
    x25 = e0 * x14
    x26 = e2 * x6
    x27 = x25 + x26
    x28 = e0 * x12
    x29 = edot0 * x6
    x30 = e2 * x9
    x31 = edot2 * x14
    x32 = x28 - x29 - x30 + x31
    x33 = x23 * x32
    x34 = -x17
    x35 = -x18
    x36 = x21 + x34 + x35
    x37 = 2.0 * e0
    x38 = edot2 * x37
    x39 = edot3 * x6
    x40 = 2.0 * e2
    x41 = edot0 * x40
    x42 = edot1 * x14
    x43 = x38 + x39 - x41 - x42
    x44 = x23 * x43
    x45 = x24 * x8 + x27 * x33 + x36 * x44
    x46 = x45 * x5
    x47 = b_roll * x46
    x48 = x0 * (-b_turn * x47 + v1 * x1 * x5)
    x49 = 1.0 / x4
    x50 = x0 * (b_parallel * b_turn * v1 * x5 - b_parallel * x47 - v1 * x49)
    x51 = b_roll * x5
    x52 = b_turn * x51
    x53 = 2.0 * x52
    x54 = 2.0 * x3
    x55 = x0 * (-v1 * x53 + x45 * x49 + x46 * x54)
    x56 = x23 * x27
    x57 = x23 * x36
    x58 = 2.0 * edot2
    x59 = x23 * x8
    x60 = 1.0 / (x22 * x22)
    x61 = x37 * x60
    x62 = x16 * x8
    x63 = x27 * x32
    x64 = x36 * x43
    x65 = x24 * x6
    x66 = x14 * x33 + x37 * x44 - x65
    x67 = b_roll * x49
    x68 = x0 * x67
    x69 = 2.0 * edot0
    x70 = x6 * x60
    x71 = x33 * x40
    x72 = x24 * x37
    x73 = x44 * x6
    x74 = -x71 + x72 + x73
    x75 = x40 * x60
    x76 = -x14 * x24 - x33 * x6 - x40 * x44
    x77 = x33 * x37
    x78 = x24 * x40
    x79 = x14 * x44
    x80 = x14 * x60
    x81 = -b_turn * x0 * x49
    x82 = x56 * x6
    x83 = x14 * x59
    x84 = x40 * x57
    x85 = x37 * x56
    x86 = x40 * x59
    x87 = x14 * x57
    x88 = x59 * x6
    x89 = x14 * x56
    x90 = x37 * x57
    x91 = x37 * x59
    x92 = x40 * x56
    x93 = x57 * x6
    x94 = e0 * x40
    x95 = e3 * x6
    x96 = x94 + x95
    x97 = 2.0 * e1 * e2 - x25
    x98 = x19 - x20
    x99 = x17 + x35 + x98
    x100 = -x24 * x96 - x33 * x99 - x44 * x97
    x101 = x100 * x5
    x102 = b_roll * x101
    x103 = x0 * (-b_turn * x102 + v2 * x1 * x5)
    x104 = x0 * (b_parallel * b_turn * v2 * x5 - b_parallel * x102 - v2 * x49)
    x105 = x0 * (-v2 * x53 + x100 * x49 + x101 * x54)
    x106 = x23 * x99
    x107 = x23 * x97
    x108 = x23 * x96
    x109 = x77 + x78 - x79
    x110 = x43 * x97
    x111 = x60 * x96
    x112 = x111 * x16
    x113 = x32 * x99
    x114 = x107 * x40
    x115 = x108 * x14
    x116 = x106 * x6
    x117 = x108 * x40
    x118 = x106 * x37
    x119 = x107 * x37
    x120 = x106 * x14
    x121 = x108 * x37
    x122 = x107 * x6
    x123 = v3 * x0 / (b_perpendicular * b_perpendicular)
    x124 = 4.0 * x17 + 4.0 * x18 + 4.0 * x19 + 4.0 * x20
    x125 = 1.0 / x124
    x126 = a2 / I
    x127 = x125 * (-x114 * x126 - x115 * x126 - x116 * x126)
    x128 = x125 * (-x126 * x82 - x126 * x83 - x126 * x84)
    x129 = 2.0 * e1 * e3 - x94
    x130 = x129 * x23
    x131 = x130 * x6
    x132 = x126 * x131
    x133 = e2 * x14
    x134 = x133 + x7
    x135 = x134 * x23
    x136 = x135 * x40
    x137 = x126 * x136
    x138 = x18 + x34 + x98
    x139 = x138 * x23
    x140 = x139 * x14
    x141 = x126 * x140
    x142 = x125 * (-x132 - x137 - x141)
    x143 = x129 * x33 + x134 * x44 + x138 * x24
    x144 = x143 / (b_spin * b_spin)
    x145 = x125 * (-x132 * x144 - x137 * x144 - x141 * x144)
    x146 = b_parallel * b_parallel
    x147 = x143 * x146 * x5
    x148 = v1 * x23
    x149 = v2 * x23
    x150 = v3 * x23
    x151 = x138 * x150 + x148 * x96 + x149 * x8
    x152 = x151 * x23
    x153 = x134 * x150 + x148 * x97 + x149 * x36
    x154 = x134 * x152 - x139 * x153
    x155 = b_parallel * x51
    x156 = -x130 * x147 + x146 * x32 * x5 - x154 * x155
    x157 = x126 * x6
    x158 = x129 * x150 + x148 * x99 + x149 * x27
    x159 = -x129 * x152 + x138 * x158 * x23
    x160 = -x135 * x147 + x146 * x43 * x5 - x155 * x159
    x161 = x126 * x40
    x162 = x129 * x153 * x23 - x135 * x158
    x163 = -x139 * x147 + x146 * x16 * x5 - x155 * x162
    x164 = x126 * x14
    x165 = x125 * (-x156 * x157 - x160 * x161 - x163 * x164)
    x166 = x32 * x49
    x167 = x143 * (x2 * x5 - x49)
    x168 = b_parallel * b_turn * x32 * x5 - x130 * x167 - x154 * x52 - x166
    x169 = x43 * x49
    x170 = b_parallel * b_turn * x43 * x5 - x135 * x167 - x159 * x52 - x169
    x171 = x16 * x49
    x172 = b_parallel * b_turn * x16 * x5 - x139 * x167 - x162 * x52 - x171
    x173 = x125 * (-x157 * x168 - x161 * x170 - x164 * x172)
    x174 = 2.0 * x155
    x175 = x143 * x174
    x176 = x162 * x49
    x177 = x5 * x54
    x178 = x139 * x175 - x16 * x174 + x162 * x177 + x176
    x179 = x154 * x49
    x180 = x130 * x175 + x154 * x177 - x174 * x32 + x179
    x181 = x159 * x49
    x182 = x135 * x175 + x159 * x177 - x174 * x43 + x181
    x183 = x125 * (-x157 * x180 - x161 * x182 - x164 * x178)
    x184 = (edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3)
    x185 = -x184 * x23
    x186 = x184 * x60
    x187 = 2.0 * x186
    x188 = M2 * x23
    x189 = M1 * x23
    x190 = b_parallel * x49
    x191 = -x190 + 1.0 / b_spin
    x192 = x143 * x191
    x193 = M3 * x130 - b_parallel * x166 + b_roll * x179 - x130 * x192 + x188 * x27 + x189 * x99
    x194 = M3 * x135 - b_parallel * x169 + b_roll * x181 - x135 * x192 + x188 * x36 + x189 * x97
    x195 = M3 * x139 - b_parallel * x171 + b_roll * x176 - x139 * x192 + x188 * x8 + x189 * x96
    x196 = 8.0 / (x124 * x124)
    x197 = x196 * (-x157 * x193 - x161 * x194 - x164 * x195)
    x198 = x23 * x37
    x199 = x153 * x198
    x200 = x152 * x6
    x201 = x134 * x60
    x202 = x201 * x37
    x203 = x111 * x37
    x204 = v2 * x61
    x205 = x138 * x60
    x206 = v3 * x37
    x207 = x150 * x37
    x208 = x148 * x40
    x209 = x149 * x6
    x210 = -x207 - x208 + x209
    x211 = -v1 * x203 - x204 * x8 - x205 * x206 - x210
    x212 = v1 * x61
    x213 = x149 * x37
    x214 = x150 * x6
    x215 = x14 * x148
    x216 = -x213 - x214 + x215
    x217 = -x201 * x206 - x204 * x36 - x212 * x97 - x216
    x218 = x129 * x60
    x219 = x218 * x37
    x220 = x205 * x37
    x221 = x191 * (x12 * x130 + x135 * x58 + x139 * x9 - x16 * x220 - x202 * x43 - x219 * x32 + x74)
    x222 = M1 * x61
    x223 = M2 * x61
    x224 = x189 * x37
    x225 = x14 * x188
    x226 = M3 * x23
    x227 = x226 * x40
    x228 = x12 * x190
    x229 = x23 * x40
    x230 = x192 * x229
    x231 = -x224 - x225 + x227 + x228 - x230
    x232 = (
        -M3 * x219
        + b_roll
        * x49
        * (
            2.0 * e0 * x138 * x153 * x60
            + x134 * x211 * x23
            - x139 * x217
            - x151 * x202
            - x199
            + x200
        )
        + 2.0 * e0 * x129 * x143 * x191 * x60
        - x130 * x221
        - x222 * x99
        - x223 * x27
        - x231
    )
    x233 = x158 * x198
    x234 = x152 * x40
    x235 = x148 * x37
    x236 = x14 * x149
    x237 = x150 * x40
    x238 = -x235 - x236 + x237
    x239 = -x204 * x27 - x206 * x218 - x212 * x99 - x238
    x240 = x188 * x37
    x241 = x226 * x6
    x242 = x14 * x189
    x243 = x190 * x58
    x244 = x23 * x6
    x245 = x192 * x244
    x246 = -x240 - x241 + x242 + x243 + x245
    x247 = (
        -M3 * x202
        + b_roll * x49 * (-x130 * x211 + x139 * x239 + x151 * x219 - x158 * x220 + x233 + x234)
        + 2.0 * e0 * x134 * x143 * x191 * x60
        - x135 * x221
        - x222 * x97
        - x223 * x36
        - x246
    )
    x248 = x158 * x244
    x249 = x153 * x23
    x250 = x249 * x40
    x251 = x189 * x40
    x252 = M3 * x198
    x253 = x188 * x6
    x254 = x190 * x9
    x255 = x192 * x198
    x256 = -x251 - x252 + x253 + x254 + x255
    x257 = (
        -M1 * x203
        - M3 * x220
        + b_roll
        * x49
        * (
            2.0 * e0 * x134 * x158 * x60
            + x129 * x217 * x23
            - x135 * x239
            - x153 * x219
            - x248
            - x250
        )
        + 2.0 * e0 * x138 * x143 * x191 * x60
        - x139 * x221
        - x223 * x8
        - x256
    )
    x258 = x186 * x7
    x259 = 2.0 * x126
    x260 = x193 * x259
    x261 = x152 * x37
    x262 = x153 * x244
    x263 = x201 * x6
    x264 = x205 * x6
    x265 = x111 * x6
    x266 = v2 * x70
    x267 = v3 * x6
    x268 = -v1 * x265 - x205 * x267 - x213 - x214 + x215 - x266 * x8
    x269 = v1 * x70
    x270 = -x201 * x267 - x210 - x266 * x36 - x269 * x97
    x271 = x218 * x6
    x272 = x191 * (
        2.0 * e0 * x23 * x43
        + 2.0 * e3 * x23 * x32
        + 2.0 * edot3 * x134 * x23
        - x130 * x69
        - x139 * x58
        - x16 * x264
        - x263 * x43
        - x271 * x32
        - x65
    )
    x273 = M1 * x70
    x274 = M2 * x70
    x275 = x14 * x23
    x276 = x14 * x226 + x188 * x40 + x189 * x6 + x190 * x69 - x192 * x275
    x277 = (
        -M3 * x271
        - x130 * x272
        + x192 * x271
        - x27 * x274
        - x273 * x99
        + x276
        + x67 * (x135 * x268 - x139 * x270 - x151 * x263 + x153 * x264 + x261 + x262)
    )
    x278 = x14 * x152
    x279 = (
        2.0 * e1 * v1 * x23
        + 2.0 * e2 * v2 * x23
        + 2.0 * e3 * v3 * x23
        - x218 * x267
        - x266 * x27
        - x269 * x99
    )
    x280 = (
        -M3 * x263
        + b_roll
        * x49
        * (
            2.0 * e1 * x129 * x151 * x60
            - x130 * x268
            + x138 * x23 * x279
            - x158 * x264
            - x248
            - x278
        )
        + 2.0 * e1 * x134 * x143 * x191 * x60
        - x135 * x272
        - x256
        - x273 * x97
        - x274 * x36
    )
    x281 = -x14 * x249
    x282 = (
        -M1 * x265
        - M3 * x264
        + b_roll
        * x49
        * (
            2.0 * e1 * x134 * x158 * x60
            + x129 * x23 * x270
            - x135 * x279
            - x153 * x271
            - x233
            - x281
        )
        + 2.0 * e1 * x138 * x143 * x191 * x60
        - x139 * x272
        - x240
        - x241
        + x242
        + x243
        + x245
        - x274 * x8
    )
    x283 = x186 * x94
    x284 = x194 * x259
    x285 = M2 * x75
    x286 = x218 * x40
    x287 = M1 * x75
    x288 = x201 * x40
    x289 = x205 * x40
    x290 = x191 * (
        2.0 * edot1 * x138 * x23
        - x109
        - x130 * x9
        - x135 * x69
        - x16 * x289
        - x286 * x32
        - x288 * x43
    )
    x291 = x111 * x40
    x292 = v2 * x75
    x293 = v3 * x40
    x294 = -v1 * x291 - x205 * x293 - x238 - x292 * x8
    x295 = v1 * x75
    x296 = x14 * x150 + x148 * x6 + x149 * x40
    x297 = -x201 * x293 - x292 * x36 - x295 * x97 + x296
    x298 = (
        -M3 * x286
        + b_roll * x49 * (x135 * x294 - x139 * x297 - x151 * x288 + x153 * x289 + x250 + x278)
        + 2.0 * e2 * x129 * x143 * x191 * x60
        - x130 * x290
        - x251
        - x252
        + x253
        + x254
        + x255
        - x27 * x285
        - x287 * x99
    )
    x299 = x158 * x23
    x300 = -x299 * x40
    x301 = -x207 - x208 + x209 - x218 * x293 - x27 * x292 - x295 * x99
    x302 = (
        -M3 * x288
        - x135 * x290
        + x192 * x288
        + x276
        - x285 * x36
        - x287 * x97
        + x67 * (-x130 * x294 + x139 * x301 + x151 * x286 - x158 * x289 + x261 + x300)
    )
    x303 = x14 * x299
    x304 = (
        -M1 * x291
        - M3 * x289
        + b_roll
        * x49
        * (
            2.0 * e2 * x134 * x158 * x60
            + x129 * x23 * x297
            - x135 * x301
            - x153 * x286
            - x199
            - x303
        )
        + 2.0 * e2 * x138 * x143 * x191 * x60
        - x139 * x290
        - x231
        - x285 * x8
    )
    x305 = x186 * x25
    x306 = x195 * x259
    x307 = x14 * x201
    x308 = x14 * x205
    x309 = x111 * x14
    x310 = v2 * x80
    x311 = v3 * x14
    x312 = -v1 * x309 - x205 * x311 + x296 - x310 * x8
    x313 = v1 * x80
    x314 = -x201 * x311 - x235 - x236 + x237 - x310 * x36 - x313 * x97
    x315 = x14 * x218
    x316 = x191 * (
        2.0 * edot2 * x129 * x23
        - x12 * x135
        - x139 * x69
        - x16 * x308
        - x307 * x43
        - x315 * x32
        - x76
    )
    x317 = M1 * x80
    x318 = M2 * x80
    x319 = (
        -M3 * x315
        + b_roll * x49 * (x135 * x312 - x139 * x314 - x151 * x307 + x153 * x308 + x234 + x281)
        + 2.0 * e3 * x129 * x143 * x191 * x60
        - x130 * x316
        - x246
        - x27 * x318
        - x317 * x99
    )
    x320 = -x216 - x218 * x311 - x27 * x310 - x313 * x99
    x321 = (
        -M3 * x307
        + b_roll
        * x49
        * (
            2.0 * e3 * x129 * x151 * x60
            - x130 * x312
            + x138 * x23 * x320
            - x158 * x308
            - x200
            + x303
        )
        + 2.0 * e3 * x134 * x143 * x191 * x60
        - x135 * x316
        - x224
        - x225
        + x227
        + x228
        - x230
        - x317 * x97
        - x318 * x36
    )
    x322 = (
        -M1 * x309
        - M3 * x308
        - x139 * x316
        + x192 * x308
        + x276
        - x318 * x8
        + x67 * (x130 * x314 - x135 * x320 - x153 * x315 + x158 * x307 + x262 + x300)
    )
    x323 = x111 * x134 - x205 * x97
    x324 = x157 * x67
    x325 = x129 * x60 * x97 - x201 * x99
    x326 = x164 * x67
    x327 = -x111 * x129 + x138 * x60 * x99
    x328 = x161 * x67
    x329 = x138 * x27 * x60 - x218 * x8
    x330 = x129 * x36 * x60 - x201 * x27
    x331 = x201 * x8 - x205 * x36
    x332 = x190 * x6
    x333 = x191 * (-x131 - x136 - x140)
    x334 = -x130 * x333 + x332
    x335 = x190 * x40
    x336 = -x135 * x333 + x335
    x337 = x14 * x190
    x338 = -x139 * x333 + x337
    x339 = x190 * x37
    x340 = x130 * x37
    x341 = x135 * x14
    x342 = x139 * x40
    x343 = x191 * (x340 - x341 + x342)
    x344 = -x130 * x343 - x339
    x345 = -x135 * x343 + x337
    x346 = -x139 * x343 - x335
    x347 = x135 * x37
    x348 = x130 * x14
    x349 = x139 * x6
    x350 = x191 * (x347 + x348 - x349)
    x351 = -x130 * x350 - x337
    x352 = -x135 * x350 - x339
    x353 = -x139 * x350 + x332
    x354 = x135 * x6
    x355 = x130 * x40
    x356 = x139 * x37
    x357 = x191 * (x354 - x355 + x356)
    x358 = -x130 * x357 + x335
    x359 = -x135 * x357 - x332
    x360 = -x139 * x357 - x339
    x361 = x125 * (-x107 * x126 * x14 + x117 * x126 + x118 * x126)
    x362 = x125 * (x126 * x85 + x126 * x86 - x126 * x87)
    x363 = x126 * x340
    x364 = x126 * x341
    x365 = x126 * x342
    x366 = x125 * (x363 - x364 + x365)
    x367 = x125 * (x144 * x363 - x144 * x364 + x144 * x365)
    x368 = x126 * x37
    x369 = x125 * (x156 * x368 - x160 * x164 + x161 * x163)
    x370 = x125 * (x161 * x172 - x164 * x170 + x168 * x368)
    x371 = x125 * (x161 * x178 - x164 * x182 + x180 * x368)
    x372 = x196 * (x161 * x195 - x164 * x194 + x193 * x368)
    x373 = x186 * x26
    x374 = x186 * x95
    x375 = x368 * x67
    x376 = x125 * (-x108 * x126 * x6 + x119 * x126 + x120 * x126)
    x377 = x125 * (-x126 * x88 + x126 * x89 + x126 * x90)
    x378 = x126 * x347
    x379 = x126 * x348
    x380 = x126 * x349
    x381 = x125 * (x378 + x379 - x380)
    x382 = x125 * (x144 * x378 + x144 * x379 - x144 * x380)
    x383 = x125 * (x156 * x164 - x157 * x163 + x160 * x368)
    x384 = x125 * (-x157 * x172 + x164 * x168 + x170 * x368)
    x385 = x125 * (-x157 * x178 + x164 * x180 + x182 * x368)
    x386 = x196 * (-x157 * x195 + x164 * x193 + x194 * x368)
    x387 = x133 * x186
    x388 = x125 * (-x106 * x126 * x40 + x121 * x126 + x122 * x126)
    x389 = x125 * (x126 * x91 - x126 * x92 + x126 * x93)
    x390 = x126 * x354
    x391 = x126 * x355
    x392 = x126 * x356
    x393 = x125 * (x390 - x391 + x392)
    x394 = x125 * (x144 * x390 - x144 * x391 + x144 * x392)
    x395 = x125 * (-x156 * x161 + x157 * x160 + x163 * x368)
    x396 = x125 * (x157 * x170 - x161 * x168 + x172 * x368)
    x397 = x125 * (x157 * x182 - x161 * x180 + x178 * x368)
    x398 = x196 * (x157 * x194 - x161 * x193 + x195 * x368)
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
    out[7, 0] = DF11 * x0 + Db11 * x48 + Db31 * x50 + Db51 * x55
    out[7, 1] = DF12 * x0 + Db12 * x48 + Db32 * x50 + Db52 * x55
    out[7, 2] = DF13 * x0 + Db13 * x48 + Db33 * x50 + Db53 * x55
    out[7, 3] = x68 * (x12 * x56 + x57 * x58 + x59 * x9 - x61 * x62 - x61 * x63 - x61 * x64 + x66)
    out[7, 4] = x68 * (
        2.0 * edot3 * x23 * x36 - x56 * x69 - x58 * x59 - x62 * x70 - x63 * x70 - x64 * x70 - x74
    )
    out[7, 5] = x68 * (
        2.0 * edot1 * x23 * x8 - x56 * x9 - x57 * x69 - x62 * x75 - x63 * x75 - x64 * x75 - x76
    )
    out[7, 6] = x68 * (
        2.0 * edot2 * x23 * x27
        - x12 * x57
        - x59 * x69
        - x62 * x80
        - x63 * x80
        - x64 * x80
        + x77
        + x78
        - x79
    )
    out[7, 7] = x81
    out[7, 8] = 0.0
    out[7, 9] = 0.0
    out[7, 10] = x68 * (-x82 - x83 - x84)
    out[7, 11] = x68 * (x85 + x86 - x87)
    out[7, 12] = x68 * (-x88 + x89 + x90)
    out[7, 13] = x68 * (x91 - x92 + x93)
    out[8, 0] = DF21 * x0 + Db11 * x103 + Db31 * x104 + Db51 * x105
    out[8, 1] = DF22 * x0 + Db12 * x103 + Db32 * x104 + Db52 * x105
    out[8, 2] = DF23 * x0 + Db13 * x103 + Db33 * x104 + Db53 * x105
    out[8, 3] = x68 * (
        2.0 * e0 * x16 * x60 * x96
        + 2.0 * e0 * x32 * x60 * x99
        + 2.0 * e0 * x43 * x60 * x97
        - x106 * x12
        - x107 * x58
        - x108 * x9
        - x109
    )
    out[8, 4] = x68 * (
        x106 * x69 - x107 * x9 + x108 * x58 + x110 * x70 + x112 * x6 + x113 * x70 + x76
    )
    out[8, 5] = x68 * (
        x106 * x9 + x107 * x69 - x108 * x12 + x110 * x75 + x112 * x40 + x113 * x75 + x71 - x72 - x73
    )
    out[8, 6] = x68 * (
        -x106 * x58 + x107 * x12 + x108 * x69 + x110 * x80 + x112 * x14 + x113 * x80 + x66
    )
    out[8, 7] = 0.0
    out[8, 8] = x81
    out[8, 9] = 0.0
    out[8, 10] = x68 * (x114 + x115 + x116)
    out[8, 11] = x68 * (2.0 * e3 * x23 * x97 - x117 - x118)
    out[8, 12] = x68 * (2.0 * e1 * x23 * x96 - x119 - x120)
    out[8, 13] = x68 * (2.0 * e2 * x23 * x99 - x121 - x122)
    out[9, 0] = DF31 * x0 + Db21 * x123
    out[9, 1] = DF32 * x0 + Db22 * x123
    out[9, 2] = DF33 * x0 + Db23 * x123
    out[9, 3] = 0.0
    out[9, 4] = 0.0
    out[9, 5] = 0.0
    out[9, 6] = 0.0
    out[9, 7] = 0.0
    out[9, 8] = 0.0
    out[9, 9] = -x0 / b_perpendicular
    out[9, 10] = 0.0
    out[9, 11] = 0.0
    out[9, 12] = 0.0
    out[9, 13] = 0.0
    out[10, 0] = (
        DM11 * x127
        + DM21 * x128
        + DM31 * x142
        + Db11 * x173
        + Db31 * x165
        + Db41 * x145
        + Db51 * x183
    )
    out[10, 1] = (
        DM12 * x127
        + DM22 * x128
        + DM32 * x142
        + Db12 * x173
        + Db32 * x165
        + Db42 * x145
        + Db52 * x183
    )
    out[10, 2] = (
        DM13 * x127
        + DM23 * x128
        + DM33 * x142
        + Db13 * x173
        + Db33 * x165
        + Db43 * x145
        + Db53 * x183
    )
    out[10, 3] = -e0 * x197 + x125 * (-x157 * x232 - x161 * x247 - x164 * x257) + x185 + x187 * x19
    out[10, 4] = -e1 * x197 + x125 * (-x157 * x277 - x161 * x280 - x164 * x282 - x260) + x258
    out[10, 5] = -e2 * x197 + x125 * (-x157 * x298 - x161 * x302 - x164 * x304 - x284) + x283
    out[10, 6] = -e3 * x197 + x125 * (-x157 * x319 - x161 * x321 - x164 * x322 - x306) + x305
    out[10, 7] = x125 * (-x323 * x324 - x325 * x326 - x327 * x328)
    out[10, 8] = x125 * (-x324 * x331 - x326 * x330 - x328 * x329)
    out[10, 9] = 0.0
    out[10, 10] = -edot0 * x198 + x125 * (-x157 * x334 - x161 * x336 - x164 * x338)
    out[10, 11] = x125 * (-x157 * x344 - x161 * x345 - x164 * x346) - x23 * x28
    out[10, 12] = x125 * (-x157 * x351 - x161 * x352 - x164 * x353) - x23 * x38
    out[10, 13] = -x10 * x23 + x125 * (-x157 * x358 - x161 * x359 - x164 * x360)
    out[11, 0] = (
        DM11 * x361
        + DM21 * x362
        + DM31 * x366
        + Db11 * x370
        + Db31 * x369
        + Db41 * x367
        + Db51 * x371
    )
    out[11, 1] = (
        DM12 * x361
        + DM22 * x362
        + DM32 * x366
        + Db12 * x370
        + Db32 * x369
        + Db42 * x367
        + Db52 * x371
    )
    out[11, 2] = (
        DM13 * x361
        + DM23 * x362
        + DM33 * x366
        + Db13 * x370
        + Db33 * x369
        + Db43 * x367
        + Db53 * x371
    )
    out[11, 3] = -e0 * x372 + x125 * (x161 * x257 - x164 * x247 + x232 * x368 + x260) + x258
    out[11, 4] = -e1 * x372 + x125 * (x161 * x282 - x164 * x280 + x277 * x368) + x17 * x187 + x185
    out[11, 5] = -e2 * x372 + x125 * (x161 * x304 - x164 * x302 + x298 * x368 + x306) + x373
    out[11, 6] = -e3 * x372 + x125 * (x161 * x322 - x164 * x321 - x284 + x319 * x368) + x374
    out[11, 7] = x125 * (x323 * x375 + x325 * x328 - x326 * x327)
    out[11, 8] = x125 * (-x326 * x329 + x328 * x330 + x331 * x375)
    out[11, 9] = 0.0
    out[11, 10] = x125 * (x161 * x338 - x164 * x336 + x334 * x368) - x23 * x29
    out[11, 11] = -edot1 * x244 + x125 * (x161 * x346 - x164 * x345 + x344 * x368)
    out[11, 12] = -x11 * x23 + x125 * (x161 * x353 - x164 * x352 + x351 * x368)
    out[11, 13] = x125 * (x161 * x360 - x164 * x359 + x358 * x368) - x23 * x39
    out[12, 0] = (
        DM11 * x376
        + DM21 * x377
        + DM31 * x381
        + Db11 * x384
        + Db31 * x383
        + Db41 * x382
        + Db51 * x385
    )
    out[12, 1] = (
        DM12 * x376
        + DM22 * x377
        + DM32 * x381
        + Db12 * x384
        + Db32 * x383
        + Db42 * x382
        + Db52 * x385
    )
    out[12, 2] = (
        DM13 * x376
        + DM23 * x377
        + DM33 * x381
        + Db13 * x384
        + Db33 * x383
        + Db43 * x382
        + Db53 * x385
    )
    out[12, 3] = -e0 * x386 + x125 * (-x157 * x257 + x164 * x232 + x247 * x368 + x284) + x283
    out[12, 4] = -e1 * x386 + x125 * (-x157 * x282 + x164 * x277 + x280 * x368 - x306) + x373
    out[12, 5] = -e2 * x386 + x125 * (-x157 * x304 + x164 * x298 + x302 * x368) + x185 + x187 * x20
    out[12, 6] = -e3 * x386 + x125 * (-x157 * x322 + x164 * x319 + x260 + x321 * x368) + x387
    out[12, 7] = x125 * (x323 * x326 - x324 * x325 + x327 * x375)
    out[12, 8] = x125 * (-x324 * x330 + x326 * x331 + x329 * x375)
    out[12, 9] = 0.0
    out[12, 10] = x125 * (-x157 * x338 + x164 * x334 + x336 * x368) - x23 * x41
    out[12, 11] = x125 * (-x157 * x346 + x164 * x344 + x345 * x368) - x13 * x23
    out[12, 12] = -edot2 * x229 + x125 * (-x157 * x353 + x164 * x351 + x352 * x368)
    out[12, 13] = x125 * (-x157 * x360 + x164 * x358 + x359 * x368) - x23 * x30
    out[13, 0] = (
        DM11 * x388
        + DM21 * x389
        + DM31 * x393
        + Db11 * x396
        + Db31 * x395
        + Db41 * x394
        + Db51 * x397
    )
    out[13, 1] = (
        DM12 * x388
        + DM22 * x389
        + DM32 * x393
        + Db12 * x396
        + Db32 * x395
        + Db42 * x394
        + Db52 * x397
    )
    out[13, 2] = (
        DM13 * x388
        + DM23 * x389
        + DM33 * x393
        + Db13 * x396
        + Db33 * x395
        + Db43 * x394
        + Db53 * x397
    )
    out[13, 3] = -e0 * x398 + x125 * (x157 * x247 - x161 * x232 + x257 * x368 + x306) + x305
    out[13, 4] = -e1 * x398 + x125 * (x157 * x280 - x161 * x277 + x282 * x368 + x284) + x374
    out[13, 5] = -e2 * x398 + x125 * (x157 * x302 - x161 * x298 - x260 + x304 * x368) + x387
    out[13, 6] = -e3 * x398 + x125 * (x157 * x321 - x161 * x319 + x322 * x368) + x18 * x187 + x185
    out[13, 7] = x125 * (-x323 * x328 + x324 * x327 + x325 * x375)
    out[13, 8] = x125 * (x324 * x329 - x328 * x331 + x330 * x375)
    out[13, 9] = 0.0
    out[13, 10] = x125 * (x157 * x336 - x161 * x334 + x338 * x368) - x15 * x23
    out[13, 11] = x125 * (x157 * x345 - x161 * x344 + x346 * x368) - x23 * x42
    out[13, 12] = x125 * (x157 * x352 - x161 * x351 + x353 * x368) - x23 * x31
    out[13, 13] = -edot3 * x275 + x125 * (x157 * x359 - x161 * x358 + x360 * x368)


@njit(cache=True)
def rates(t, state, force, moment, force_gradient, moment_gradient, mobility, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(t, state, force, moment, mobility, params, out)


@njit(cache=True)
def derivatives(
    t,
    state,
    force,
    moment,
    force_gradient,
    moment_gradient,
    mobility,
    mobility_gradient,
    params,
    out,
):
    """`jacobian`, called alike in every model: with all that any of them takes."""
    jacobian(
        t,
        state,
        force,
        moment,
        mobility,
        force_gradient,
        moment_gradient,
        mobility_gradient,
        params,
        out,
    )
