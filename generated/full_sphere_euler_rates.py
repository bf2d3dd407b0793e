"""Full model (A.25): translation and rotation of a sphere, Euler-parameter rates.

Made by `python -m derivation` from derivation/rigid_body.py and derivation/drag.py; do not edit.
SymPy 1.14.0. 2246 operations, 442 temporaries.

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
* [2] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [3] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [4] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
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
PARAMS = ("m", "I", "W1", "W2", "W3")
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
    params: (5) m, I, W1, W2, W3
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
    W1 = params[2]
    W2 = params[3]
    W3 = params[4]
    omega1 = 2.0 * e0 * edot1 - 2.0 * e1 * edot0 - 2.0 * e2 * edot3 + 2.0 * e3 * edot2
    omega2 = 2.0 * e0 * edot2 + 2.0 * e1 * edot3 - 2.0 * e2 * edot0 - 2.0 * e3 * edot1
    omega3 = 2.0 * e0 * edot3 - 2.0 * e1 * edot2 + 2.0 * e2 * edot1 - 2.0 * e3 * edot0
    x0 = 1.0 / m
    x1 = 1.0 / (b_parallel * b_turn - (b_roll * b_roll))
    x2 = b_turn * x1
    x3 = 2.0 * e0
    x4 = e3 * x3
    x5 = 2.0 * e2
    x6 = e1 * x5 + x4
    x7 = e1 * e1
    x8 = e3 * e3
    x9 = e0 * e0
    x10 = e2 * e2
    x11 = x10 + x9
    x12 = 1.0 / (x11 + x7 + x8)
    x13 = omega1 * x12
    x14 = e1 * x3
    x15 = 2.0 * e2 * e3 - x14
    x16 = omega3 * x12
    x17 = -x7
    x18 = -x8
    x19 = x11 + x17 + x18
    x20 = omega2 * x12
    x21 = b_roll * x1
    x22 = 2.0 * e1 * e2 - x4
    x23 = e2 * x3
    x24 = 2.0 * e1
    x25 = e3 * x24 + x23
    x26 = -x10 + x9
    x27 = x18 + x26 + x7
    x28 = x12 * ((edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3))
    x29 = 1.0 / (4.0 * x10 + 4.0 * x7 + 4.0 * x8 + 4.0 * x9)
    x30 = 1.0 / I
    x31 = b_parallel * x1
    x32 = M2 * x12
    x33 = 2.0 * e1 * e3 - x23
    x34 = M3 * x12
    x35 = M1 * x12
    x36 = e3 * x5 + x14
    x37 = x17 + x26 + x8
    x38 = (-x31 + 1.0 / b_spin) * (x13 * x33 + x16 * x37 + x20 * x36)
    x39 = v1 * x12
    x40 = v2 * x12
    x41 = v3 * x12
    x42 = x12 * (x15 * x40 + x25 * x39 + x37 * x41)
    x43 = x19 * x40 + x22 * x39 + x36 * x41
    x44 = x12 * x37
    x45 = x30 * (
        -omega1 * x31
        - x12 * x33 * x38
        + x21 * (x36 * x42 - x43 * x44)
        + x27 * x35
        + x32 * x6
        + x33 * x34
    )
    x46 = x12 * x36
    x47 = x27 * x39 + x33 * x41 + x40 * x6
    x48 = x30 * (
        -omega2 * x31
        + x19 * x32
        + x21 * (x12 * x37 * x47 - x33 * x42)
        + x22 * x35
        + x34 * x36
        - x38 * x46
    )
    x49 = 2.0 * e3
    x50 = x30 * (
        -omega3 * x31
        + x15 * x32
        + x21 * (x12 * x33 * x43 - x46 * x47)
        + x25 * x35
        + x34 * x37
        - x38 * x44
    )
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = edot0
    out[4] = edot1
    out[5] = edot2
    out[6] = edot3
    out[7] = x0 * (F1 + W1 - v1 * x2 + x21 * (x13 * x6 + x15 * x16 + x19 * x20))
    out[8] = x0 * (F2 + W2 - v2 * x2 + x21 * (-x13 * x27 - x16 * x25 - x20 * x22))
    out[9] = x0 * (F3 + W3 - v3 / b_perpendicular)
    out[10] = -e0 * x28 + x29 * (-x24 * x45 - x48 * x5 - x49 * x50)
    out[11] = -e1 * x28 + x29 * (x3 * x45 - x48 * x49 + x5 * x50)
    out[12] = -e2 * x28 + x29 * (-x24 * x50 + x3 * x48 + x45 * x49)
    out[13] = -e3 * x28 + x29 * (x24 * x48 + x3 * x50 - x45 * x5)


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
    params: (5) m, I, W1, W2, W3
    out: (14, 14) filled with the result.
    2006 operations, 391 temporaries.
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
    x0 = 1.0 / m
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
    x67 = x0 * x49
    x68 = b_roll * x67
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
    x81 = -b_turn * x67
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
    x126 = 1.0 / I
    x127 = x125 * (-x114 * x126 - x115 * x126 - x116 * x126)
    x128 = x125 * (-x126 * x82 - x126 * x83 - x126 * x84)
    x129 = 2.0 * e1 * e3 - x94
    x130 = x129 * x23
    x131 = x126 * x6
    x132 = x130 * x131
    x133 = e2 * x14
    x134 = x133 + x7
    x135 = x134 * x23
    x136 = x126 * x40
    x137 = x135 * x136
    x138 = x18 + x34 + x98
    x139 = x138 * x23
    x140 = x126 * x14
    x141 = x139 * x140
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
    x157 = x129 * x150 + x148 * x99 + x149 * x27
    x158 = -x129 * x152 + x138 * x157 * x23
    x159 = -x135 * x147 + x146 * x43 * x5 - x155 * x158
    x160 = x129 * x153 * x23 - x135 * x157
    x161 = -x139 * x147 + x146 * x16 * x5 - x155 * x160
    x162 = x125 * (-x131 * x156 - x136 * x159 - x140 * x161)
    x163 = x32 * x49
    x164 = x143 * (x2 * x5 - x49)
    x165 = b_parallel * b_turn * x32 * x5 - x130 * x164 - x154 * x52 - x163
    x166 = x43 * x49
    x167 = b_parallel * b_turn * x43 * x5 - x135 * x164 - x158 * x52 - x166
    x168 = x16 * x49
    x169 = b_parallel * b_turn * x16 * x5 - x139 * x164 - x160 * x52 - x168
    x170 = x125 * (-x131 * x165 - x136 * x167 - x140 * x169)
    x171 = 2.0 * x155
    x172 = x143 * x171
    x173 = x160 * x49
    x174 = x5 * x54
    x175 = x139 * x172 - x16 * x171 + x160 * x174 + x173
    x176 = x154 * x49
    x177 = x130 * x172 + x154 * x174 - x171 * x32 + x176
    x178 = x158 * x49
    x179 = x135 * x172 + x158 * x174 - x171 * x43 + x178
    x180 = x125 * (-x131 * x177 - x136 * x179 - x140 * x175)
    x181 = (edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3)
    x182 = -x181 * x23
    x183 = x181 * x60
    x184 = 2.0 * x183
    x185 = M2 * x23
    x186 = M1 * x23
    x187 = b_parallel * x49
    x188 = -x187 + 1.0 / b_spin
    x189 = x143 * x188
    x190 = M3 * x130 - b_parallel * x163 + b_roll * x176 - x130 * x189 + x185 * x27 + x186 * x99
    x191 = M3 * x135 - b_parallel * x166 + b_roll * x178 - x135 * x189 + x185 * x36 + x186 * x97
    x192 = M3 * x139 - b_parallel * x168 + b_roll * x173 - x139 * x189 + x185 * x8 + x186 * x96
    x193 = 8.0 / (x124 * x124)
    x194 = x193 * (-x131 * x190 - x136 * x191 - x140 * x192)
    x195 = x23 * x37
    x196 = x153 * x195
    x197 = x152 * x6
    x198 = x134 * x60
    x199 = x198 * x37
    x200 = x111 * x37
    x201 = v2 * x61
    x202 = x138 * x60
    x203 = v3 * x37
    x204 = x150 * x37
    x205 = x148 * x40
    x206 = x149 * x6
    x207 = -x204 - x205 + x206
    x208 = -v1 * x200 - x201 * x8 - x202 * x203 - x207
    x209 = v1 * x61
    x210 = x149 * x37
    x211 = x150 * x6
    x212 = x14 * x148
    x213 = -x210 - x211 + x212
    x214 = -x198 * x203 - x201 * x36 - x209 * x97 - x213
    x215 = x129 * x60
    x216 = x215 * x37
    x217 = x202 * x37
    x218 = x188 * (x12 * x130 + x135 * x58 + x139 * x9 - x16 * x217 - x199 * x43 - x216 * x32 + x74)
    x219 = M1 * x61
    x220 = M2 * x61
    x221 = x186 * x37
    x222 = x14 * x185
    x223 = M3 * x23
    x224 = x223 * x40
    x225 = x12 * x187
    x226 = x23 * x40
    x227 = x189 * x226
    x228 = -x221 - x222 + x224 + x225 - x227
    x229 = (
        -M3 * x216
        + b_roll
        * x49
        * (
            2.0 * e0 * x138 * x153 * x60
            + x134 * x208 * x23
            - x139 * x214
            - x151 * x199
            - x196
            + x197
        )
        + 2.0 * e0 * x129 * x143 * x188 * x60
        - x130 * x218
        - x219 * x99
        - x220 * x27
        - x228
    )
    x230 = x157 * x195
    x231 = x152 * x40
    x232 = x148 * x37
    x233 = x14 * x149
    x234 = x150 * x40
    x235 = -x232 - x233 + x234
    x236 = -x201 * x27 - x203 * x215 - x209 * x99 - x235
    x237 = x185 * x37
    x238 = x223 * x6
    x239 = x14 * x186
    x240 = x187 * x58
    x241 = x23 * x6
    x242 = x189 * x241
    x243 = -x237 - x238 + x239 + x240 + x242
    x244 = (
        -M3 * x199
        + b_roll * x49 * (-x130 * x208 + x139 * x236 + x151 * x216 - x157 * x217 + x230 + x231)
        + 2.0 * e0 * x134 * x143 * x188 * x60
        - x135 * x218
        - x219 * x97
        - x220 * x36
        - x243
    )
    x245 = x157 * x241
    x246 = x153 * x23
    x247 = x246 * x40
    x248 = x186 * x40
    x249 = M3 * x195
    x250 = x185 * x6
    x251 = x187 * x9
    x252 = x189 * x195
    x253 = -x248 - x249 + x250 + x251 + x252
    x254 = (
        -M1 * x200
        - M3 * x217
        + b_roll
        * x49
        * (
            2.0 * e0 * x134 * x157 * x60
            + x129 * x214 * x23
            - x135 * x236
            - x153 * x216
            - x245
            - x247
        )
        + 2.0 * e0 * x138 * x143 * x188 * x60
        - x139 * x218
        - x220 * x8
        - x253
    )
    x255 = x183 * x7
    x256 = 2.0 * x126
    x257 = x190 * x256
    x258 = x152 * x37
    x259 = x153 * x241
    x260 = x198 * x6
    x261 = x202 * x6
    x262 = x111 * x6
    x263 = v2 * x70
    x264 = v3 * x6
    x265 = -v1 * x262 - x202 * x264 - x210 - x211 + x212 - x263 * x8
    x266 = v1 * x70
    x267 = -x198 * x264 - x207 - x263 * x36 - x266 * x97
    x268 = b_roll * x49
    x269 = x215 * x6
    x270 = x188 * (
        2.0 * e0 * x23 * x43
        + 2.0 * e3 * x23 * x32
        + 2.0 * edot3 * x134 * x23
        - x130 * x69
        - x139 * x58
        - x16 * x261
        - x260 * x43
        - x269 * x32
        - x65
    )
    x271 = M1 * x70
    x272 = M2 * x70
    x273 = x14 * x23
    x274 = x14 * x223 + x185 * x40 + x186 * x6 + x187 * x69 - x189 * x273
    x275 = (
        -M3 * x269
        - x130 * x270
        + x189 * x269
        + x268 * (x135 * x265 - x139 * x267 - x151 * x260 + x153 * x261 + x258 + x259)
        - x27 * x272
        - x271 * x99
        + x274
    )
    x276 = x14 * x152
    x277 = (
        2.0 * e1 * v1 * x23
        + 2.0 * e2 * v2 * x23
        + 2.0 * e3 * v3 * x23
        - x215 * x264
        - x263 * x27
        - x266 * x99
    )
    x278 = (
        -M3 * x260
        + b_roll
        * x49
        * (
            2.0 * e1 * x129 * x151 * x60
            - x130 * x265
            + x138 * x23 * x277
            - x157 * x261
            - x245
            - x276
        )
        + 2.0 * e1 * x134 * x143 * x188 * x60
        - x135 * x270
        - x253
        - x271 * x97
        - x272 * x36
    )
    x279 = -x14 * x246
    x280 = (
        -M1 * x262
        - M3 * x261
        + b_roll
        * x49
        * (
            2.0 * e1 * x134 * x157 * x60
            + x129 * x23 * x267
            - x135 * x277
            - x153 * x269
            - x230
            - x279
        )
        + 2.0 * e1 * x138 * x143 * x188 * x60
        - x139 * x270
        - x237
        - x238
        + x239
        + x240
        + x242
        - x272 * x8
    )
    x281 = x183 * x94
    x282 = x191 * x256
    x283 = M2 * x75
    x284 = x215 * x40
    x285 = M1 * x75
    x286 = x198 * x40
    x287 = x202 * x40
    x288 = x188 * (
        2.0 * edot1 * x138 * x23
        - x109
        - x130 * x9
        - x135 * x69
        - x16 * x287
        - x284 * x32
        - x286 * x43
    )
    x289 = x111 * x40
    x290 = v2 * x75
    x291 = v3 * x40
    x292 = -v1 * x289 - x202 * x291 - x235 - x290 * x8
    x293 = v1 * x75
    x294 = x14 * x150 + x148 * x6 + x149 * x40
    x295 = -x198 * x291 - x290 * x36 - x293 * x97 + x294
    x296 = (
        -M3 * x284
        + b_roll * x49 * (x135 * x292 - x139 * x295 - x151 * x286 + x153 * x287 + x247 + x276)
        + 2.0 * e2 * x129 * x143 * x188 * x60
        - x130 * x288
        - x248
        - x249
        + x250
        + x251
        + x252
        - x27 * x283
        - x285 * x99
    )
    x297 = x157 * x23
    x298 = -x297 * x40
    x299 = -x204 - x205 + x206 - x215 * x291 - x27 * x290 - x293 * x99
    x300 = (
        -M3 * x286
        - x135 * x288
        + x189 * x286
        + x268 * (-x130 * x292 + x139 * x299 + x151 * x284 - x157 * x287 + x258 + x298)
        + x274
        - x283 * x36
        - x285 * x97
    )
    x301 = x14 * x297
    x302 = (
        -M1 * x289
        - M3 * x287
        + b_roll
        * x49
        * (
            2.0 * e2 * x134 * x157 * x60
            + x129 * x23 * x295
            - x135 * x299
            - x153 * x284
            - x196
            - x301
        )
        + 2.0 * e2 * x138 * x143 * x188 * x60
        - x139 * x288
        - x228
        - x283 * x8
    )
    x303 = x183 * x25
    x304 = x192 * x256
    x305 = x14 * x198
    x306 = x14 * x202
    x307 = x111 * x14
    x308 = v2 * x80
    x309 = v3 * x14
    x310 = -v1 * x307 - x202 * x309 + x294 - x308 * x8
    x311 = v1 * x80
    x312 = -x198 * x309 - x232 - x233 + x234 - x308 * x36 - x311 * x97
    x313 = x14 * x215
    x314 = x188 * (
        2.0 * edot2 * x129 * x23
        - x12 * x135
        - x139 * x69
        - x16 * x306
        - x305 * x43
        - x313 * x32
        - x76
    )
    x315 = M1 * x80
    x316 = M2 * x80
    x317 = (
        -M3 * x313
        + b_roll * x49 * (x135 * x310 - x139 * x312 - x151 * x305 + x153 * x306 + x231 + x279)
        + 2.0 * e3 * x129 * x143 * x188 * x60
        - x130 * x314
        - x243
        - x27 * x316
        - x315 * x99
    )
    x318 = -x213 - x215 * x309 - x27 * x308 - x311 * x99
    x319 = (
        -M3 * x305
        + b_roll
        * x49
        * (
            2.0 * e3 * x129 * x151 * x60
            - x130 * x310
            + x138 * x23 * x318
            - x157 * x306
            - x197
            + x301
        )
        + 2.0 * e3 * x134 * x143 * x188 * x60
        - x135 * x314
        - x221
        - x222
        + x224
        + x225
        - x227
        - x315 * x97
        - x316 * x36
    )
    x320 = (
        -M1 * x307
        - M3 * x306
        - x139 * x314
        + x189 * x306
        + x268 * (x130 * x312 - x135 * x318 - x153 * x313 + x157 * x305 + x259 + x298)
        + x274
        - x316 * x8
    )
    x321 = x111 * x134 - x202 * x97
    x322 = x131 * x268
    x323 = x129 * x60 * x97 - x198 * x99
    x324 = x140 * x268
    x325 = -x111 * x129 + x138 * x60 * x99
    x326 = x136 * x268
    x327 = x138 * x27 * x60 - x215 * x8
    x328 = x129 * x36 * x60 - x198 * x27
    x329 = x198 * x8 - x202 * x36
    x330 = x187 * x6
    x331 = x188 * (-x130 * x6 - x135 * x40 - x139 * x14)
    x332 = -x130 * x331 + x330
    x333 = x187 * x40
    x334 = -x135 * x331 + x333
    x335 = x14 * x187
    x336 = -x139 * x331 + x335
    x337 = x187 * x37
    x338 = x130 * x37
    x339 = x188 * (-x135 * x14 + x139 * x40 + x338)
    x340 = -x130 * x339 - x337
    x341 = -x135 * x339 + x335
    x342 = -x139 * x339 - x333
    x343 = x135 * x37
    x344 = x188 * (x130 * x14 - x139 * x6 + x343)
    x345 = -x130 * x344 - x335
    x346 = -x135 * x344 - x337
    x347 = -x139 * x344 + x330
    x348 = x139 * x37
    x349 = x188 * (-x130 * x40 + x135 * x6 + x348)
    x350 = -x130 * x349 + x333
    x351 = -x135 * x349 - x330
    x352 = -x139 * x349 - x337
    x353 = x125 * (-x107 * x126 * x14 + x117 * x126 + x118 * x126)
    x354 = x125 * (x126 * x85 + x126 * x86 - x126 * x87)
    x355 = x126 * x338
    x356 = x135 * x140
    x357 = x136 * x139
    x358 = x125 * (x355 - x356 + x357)
    x359 = x125 * (x144 * x355 - x144 * x356 + x144 * x357)
    x360 = x126 * x37
    x361 = x125 * (x136 * x161 - x140 * x159 + x156 * x360)
    x362 = x125 * (x136 * x169 - x140 * x167 + x165 * x360)
    x363 = x125 * (x136 * x175 - x140 * x179 + x177 * x360)
    x364 = x193 * (x136 * x192 - x140 * x191 + x190 * x360)
    x365 = x183 * x26
    x366 = x183 * x95
    x367 = x268 * x360
    x368 = x125 * (-x108 * x126 * x6 + x119 * x126 + x120 * x126)
    x369 = x125 * (-x126 * x88 + x126 * x89 + x126 * x90)
    x370 = x126 * x343
    x371 = x130 * x140
    x372 = x131 * x139
    x373 = x125 * (x370 + x371 - x372)
    x374 = x125 * (x144 * x370 + x144 * x371 - x144 * x372)
    x375 = x125 * (-x131 * x161 + x140 * x156 + x159 * x360)
    x376 = x125 * (-x131 * x169 + x140 * x165 + x167 * x360)
    x377 = x125 * (-x131 * x175 + x140 * x177 + x179 * x360)
    x378 = x193 * (-x131 * x192 + x140 * x190 + x191 * x360)
    x379 = x133 * x183
    x380 = x125 * (-x106 * x126 * x40 + x121 * x126 + x122 * x126)
    x381 = x125 * (x126 * x91 - x126 * x92 + x126 * x93)
    x382 = x131 * x135
    x383 = x130 * x136
    x384 = x126 * x348
    x385 = x125 * (x382 - x383 + x384)
    x386 = x125 * (x144 * x382 - x144 * x383 + x144 * x384)
    x387 = x125 * (x131 * x159 - x136 * x156 + x161 * x360)
    x388 = x125 * (x131 * x167 - x136 * x165 + x169 * x360)
    x389 = x125 * (x131 * x179 - x136 * x177 + x175 * x360)
    x390 = x193 * (x131 * x191 - x136 * x190 + x192 * x360)
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
        + Db11 * x170
        + Db31 * x162
        + Db41 * x145
        + Db51 * x180
    )
    out[10, 1] = (
        DM12 * x127
        + DM22 * x128
        + DM32 * x142
        + Db12 * x170
        + Db32 * x162
        + Db42 * x145
        + Db52 * x180
    )
    out[10, 2] = (
        DM13 * x127
        + DM23 * x128
        + DM33 * x142
        + Db13 * x170
        + Db33 * x162
        + Db43 * x145
        + Db53 * x180
    )
    out[10, 3] = -e0 * x194 + x125 * (-x131 * x229 - x136 * x244 - x140 * x254) + x182 + x184 * x19
    out[10, 4] = -e1 * x194 + x125 * (-x131 * x275 - x136 * x278 - x140 * x280 - x257) + x255
    out[10, 5] = -e2 * x194 + x125 * (-x131 * x296 - x136 * x300 - x140 * x302 - x282) + x281
    out[10, 6] = -e3 * x194 + x125 * (-x131 * x317 - x136 * x319 - x140 * x320 - x304) + x303
    out[10, 7] = x125 * (-x321 * x322 - x323 * x324 - x325 * x326)
    out[10, 8] = x125 * (-x322 * x329 - x324 * x328 - x326 * x327)
    out[10, 9] = 0.0
    out[10, 10] = -edot0 * x195 + x125 * (-x131 * x332 - x136 * x334 - x140 * x336)
    out[10, 11] = x125 * (-x131 * x340 - x136 * x341 - x140 * x342) - x23 * x28
    out[10, 12] = x125 * (-x131 * x345 - x136 * x346 - x140 * x347) - x23 * x38
    out[10, 13] = -x10 * x23 + x125 * (-x131 * x350 - x136 * x351 - x140 * x352)
    out[11, 0] = (
        DM11 * x353
        + DM21 * x354
        + DM31 * x358
        + Db11 * x362
        + Db31 * x361
        + Db41 * x359
        + Db51 * x363
    )
    out[11, 1] = (
        DM12 * x353
        + DM22 * x354
        + DM32 * x358
        + Db12 * x362
        + Db32 * x361
        + Db42 * x359
        + Db52 * x363
    )
    out[11, 2] = (
        DM13 * x353
        + DM23 * x354
        + DM33 * x358
        + Db13 * x362
        + Db33 * x361
        + Db43 * x359
        + Db53 * x363
    )
    out[11, 3] = -e0 * x364 + x125 * (x136 * x254 - x140 * x244 + x229 * x360 + x257) + x255
    out[11, 4] = -e1 * x364 + x125 * (x136 * x280 - x140 * x278 + x275 * x360) + x17 * x184 + x182
    out[11, 5] = -e2 * x364 + x125 * (x136 * x302 - x140 * x300 + x296 * x360 + x304) + x365
    out[11, 6] = -e3 * x364 + x125 * (x136 * x320 - x140 * x319 - x282 + x317 * x360) + x366
    out[11, 7] = x125 * (x321 * x367 + x323 * x326 - x324 * x325)
    out[11, 8] = x125 * (-x324 * x327 + x326 * x328 + x329 * x367)
    out[11, 9] = 0.0
    out[11, 10] = x125 * (x136 * x336 - x140 * x334 + x332 * x360) - x23 * x29
    out[11, 11] = -edot1 * x241 + x125 * (x136 * x342 - x140 * x341 + x340 * x360)
    out[11, 12] = -x11 * x23 + x125 * (x136 * x347 - x140 * x346 + x345 * x360)
    out[11, 13] = x125 * (x136 * x352 - x140 * x351 + x350 * x360) - x23 * x39
    out[12, 0] = (
        DM11 * x368
        + DM21 * x369
        + DM31 * x373
        + Db11 * x376
        + Db31 * x375
        + Db41 * x374
        + Db51 * x377
    )
    out[12, 1] = (
        DM12 * x368
        + DM22 * x369
        + DM32 * x373
        + Db12 * x376
        + Db32 * x375
        + Db42 * x374
        + Db52 * x377
    )
    out[12, 2] = (
        DM13 * x368
        + DM23 * x369
        + DM33 * x373
        + Db13 * x376
        + Db33 * x375
        + Db43 * x374
        + Db53 * x377
    )
    out[12, 3] = -e0 * x378 + x125 * (-x131 * x254 + x140 * x229 + x244 * x360 + x282) + x281
    out[12, 4] = -e1 * x378 + x125 * (-x131 * x280 + x140 * x275 + x278 * x360 - x304) + x365
    out[12, 5] = -e2 * x378 + x125 * (-x131 * x302 + x140 * x296 + x300 * x360) + x182 + x184 * x20
    out[12, 6] = -e3 * x378 + x125 * (-x131 * x320 + x140 * x317 + x257 + x319 * x360) + x379
    out[12, 7] = x125 * (x321 * x324 - x322 * x323 + x325 * x367)
    out[12, 8] = x125 * (-x322 * x328 + x324 * x329 + x327 * x367)
    out[12, 9] = 0.0
    out[12, 10] = x125 * (-x131 * x336 + x140 * x332 + x334 * x360) - x23 * x41
    out[12, 11] = x125 * (-x131 * x342 + x140 * x340 + x341 * x360) - x13 * x23
    out[12, 12] = -edot2 * x226 + x125 * (-x131 * x347 + x140 * x345 + x346 * x360)
    out[12, 13] = x125 * (-x131 * x352 + x140 * x350 + x351 * x360) - x23 * x30
    out[13, 0] = (
        DM11 * x380
        + DM21 * x381
        + DM31 * x385
        + Db11 * x388
        + Db31 * x387
        + Db41 * x386
        + Db51 * x389
    )
    out[13, 1] = (
        DM12 * x380
        + DM22 * x381
        + DM32 * x385
        + Db12 * x388
        + Db32 * x387
        + Db42 * x386
        + Db52 * x389
    )
    out[13, 2] = (
        DM13 * x380
        + DM23 * x381
        + DM33 * x385
        + Db13 * x388
        + Db33 * x387
        + Db43 * x386
        + Db53 * x389
    )
    out[13, 3] = -e0 * x390 + x125 * (x131 * x244 - x136 * x229 + x254 * x360 + x304) + x303
    out[13, 4] = -e1 * x390 + x125 * (x131 * x278 - x136 * x275 + x280 * x360 + x282) + x366
    out[13, 5] = -e2 * x390 + x125 * (x131 * x300 - x136 * x296 - x257 + x302 * x360) + x379
    out[13, 6] = -e3 * x390 + x125 * (x131 * x319 - x136 * x317 + x320 * x360) + x18 * x184 + x182
    out[13, 7] = x125 * (-x321 * x326 + x322 * x325 + x323 * x367)
    out[13, 8] = x125 * (x322 * x327 - x326 * x329 + x328 * x367)
    out[13, 9] = 0.0
    out[13, 10] = x125 * (x131 * x334 - x136 * x332 + x336 * x360) - x15 * x23
    out[13, 11] = x125 * (x131 * x341 - x136 * x340 + x342 * x360) - x23 * x42
    out[13, 12] = x125 * (x131 * x346 - x136 * x345 + x347 * x360) - x23 * x31
    out[13, 13] = -edot3 * x273 + x125 * (x131 * x351 - x136 * x350 + x352 * x360)


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
