"""Full model (A.25): translation and rotation of a rigid body, Euler-parameter rates.

Made by `python -m derivation` from derivation/rigid_body.py and derivation/drag.py; do not edit.
SymPy 1.14.0. 2527 operations, 509 temporaries.

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
PARAMS = ("m", "I1", "I2", "I3", "W1", "W2", "W3")
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
    params: (7) m, I1, I2, I3, W1, W2, W3
    out: (14) filled with the result.
    254 operations, 53 temporaries.
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
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
    W1 = params[4]
    W2 = params[5]
    W3 = params[6]
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
    x30 = omega2 * omega3
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
    x45 = (
        I2 * x30
        - I3 * x30
        - omega1 * x31
        - x12 * x33 * x38
        + x21 * (x36 * x42 - x43 * x44)
        + x27 * x35
        + x32 * x6
        + x33 * x34
    ) / I1
    x46 = omega1 * omega3
    x47 = x12 * x36
    x48 = x27 * x39 + x33 * x41 + x40 * x6
    x49 = (
        -I1 * x46
        + I3 * x46
        - omega2 * x31
        + x19 * x32
        + x21 * (x12 * x37 * x48 - x33 * x42)
        + x22 * x35
        + x34 * x36
        - x38 * x47
    ) / I2
    x50 = 2.0 * e3
    x51 = omega1 * omega2
    x52 = (
        I1 * x51
        - I2 * x51
        - omega3 * x31
        + x15 * x32
        + x21 * (x12 * x33 * x43 - x47 * x48)
        + x25 * x35
        + x34 * x37
        - x38 * x44
    ) / I3
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
    out[10] = -e0 * x28 + x29 * (-x24 * x45 - x49 * x5 - x50 * x52)
    out[11] = -e1 * x28 + x29 * (x3 * x45 - x49 * x50 + x5 * x52)
    out[12] = -e2 * x28 + x29 * (-x24 * x52 + x3 * x49 + x45 * x50)
    out[13] = -e3 * x28 + x29 * (x24 * x49 + x3 * x52 - x45 * x5)


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
    params: (7) m, I1, I2, I3, W1, W2, W3
    out: (14, 14) filled with the result.
    2273 operations, 456 temporaries.
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
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
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
    x60 = x16 * x37
    x61 = 1.0 / (x22 * x22)
    x62 = x61 * x8
    x63 = x32 * x37
    x64 = x27 * x61
    x65 = x37 * x43
    x66 = x36 * x61
    x67 = x24 * x6
    x68 = x14 * x33 + x37 * x44 - x67
    x69 = x0 * x49
    x70 = b_roll * x69
    x71 = 2.0 * edot0
    x72 = x16 * x6
    x73 = x32 * x6
    x74 = x43 * x6
    x75 = x33 * x40
    x76 = x24 * x37
    x77 = x44 * x6
    x78 = -x75 + x76 + x77
    x79 = x16 * x40
    x80 = x32 * x40
    x81 = x40 * x43
    x82 = -x14 * x24 - x33 * x6 - x40 * x44
    x83 = x33 * x37
    x84 = x24 * x40
    x85 = x14 * x44
    x86 = x14 * x16
    x87 = x14 * x32
    x88 = x14 * x43
    x89 = -b_turn * x69
    x90 = x56 * x6
    x91 = x14 * x59
    x92 = x40 * x57
    x93 = x37 * x56
    x94 = x40 * x59
    x95 = x14 * x57
    x96 = x59 * x6
    x97 = x14 * x56
    x98 = x37 * x57
    x99 = x37 * x59
    x100 = x40 * x56
    x101 = x57 * x6
    x102 = e0 * x40
    x103 = e3 * x6
    x104 = x102 + x103
    x105 = 2.0 * e1 * e2 - x25
    x106 = x19 - x20
    x107 = x106 + x17 + x35
    x108 = -x104 * x24 - x105 * x44 - x107 * x33
    x109 = x108 * x5
    x110 = b_roll * x109
    x111 = x0 * (-b_turn * x110 + v2 * x1 * x5)
    x112 = x0 * (b_parallel * b_turn * v2 * x5 - b_parallel * x110 - v2 * x49)
    x113 = x0 * (-v2 * x53 + x108 * x49 + x109 * x54)
    x114 = x107 * x23
    x115 = x105 * x23
    x116 = x104 * x23
    x117 = x83 + x84 - x85
    x118 = x105 * x61
    x119 = x104 * x61
    x120 = x107 * x61
    x121 = x115 * x40
    x122 = x116 * x14
    x123 = x114 * x6
    x124 = x116 * x40
    x125 = x114 * x37
    x126 = x115 * x37
    x127 = x114 * x14
    x128 = x116 * x37
    x129 = x115 * x6
    x130 = v3 * x0 / (b_perpendicular * b_perpendicular)
    x131 = 4.0 * x17 + 4.0 * x18 + 4.0 * x19 + 4.0 * x20
    x132 = 1.0 / x131
    x133 = 1.0 / I2
    x134 = 1.0 / I3
    x135 = 1.0 / I1
    x136 = x132 * (-x121 * x133 - x122 * x134 - x123 * x135)
    x137 = x132 * (-x133 * x92 - x134 * x91 - x135 * x90)
    x138 = 2.0 * e1 * e3 - x102
    x139 = x138 * x23
    x140 = x135 * x6
    x141 = x139 * x140
    x142 = e2 * x14
    x143 = x142 + x7
    x144 = x143 * x23
    x145 = x133 * x40
    x146 = x144 * x145
    x147 = x106 + x18 + x34
    x148 = x147 * x23
    x149 = x134 * x14
    x150 = x148 * x149
    x151 = x132 * (-x141 - x146 - x150)
    x152 = x138 * x33 + x143 * x44 + x147 * x24
    x153 = x152 / (b_spin * b_spin)
    x154 = x132 * (-x141 * x153 - x146 * x153 - x150 * x153)
    x155 = b_parallel * b_parallel
    x156 = x152 * x155 * x5
    x157 = v1 * x23
    x158 = v2 * x23
    x159 = v3 * x23
    x160 = x104 * x157 + x147 * x159 + x158 * x8
    x161 = x160 * x23
    x162 = x105 * x157 + x143 * x159 + x158 * x36
    x163 = x143 * x161 - x148 * x162
    x164 = b_parallel * x51
    x165 = -x139 * x156 + x155 * x32 * x5 - x163 * x164
    x166 = x107 * x157 + x138 * x159 + x158 * x27
    x167 = -x138 * x161 + x147 * x166 * x23
    x168 = -x144 * x156 + x155 * x43 * x5 - x164 * x167
    x169 = x138 * x162 * x23 - x144 * x166
    x170 = -x148 * x156 + x155 * x16 * x5 - x164 * x169
    x171 = x132 * (-x140 * x165 - x145 * x168 - x149 * x170)
    x172 = x32 * x49
    x173 = x152 * (x2 * x5 - x49)
    x174 = b_parallel * b_turn * x32 * x5 - x139 * x173 - x163 * x52 - x172
    x175 = x43 * x49
    x176 = b_parallel * b_turn * x43 * x5 - x144 * x173 - x167 * x52 - x175
    x177 = x16 * x49
    x178 = b_parallel * b_turn * x16 * x5 - x148 * x173 - x169 * x52 - x177
    x179 = x132 * (-x140 * x174 - x145 * x176 - x149 * x178)
    x180 = 2.0 * x164
    x181 = x152 * x180
    x182 = x169 * x49
    x183 = x5 * x54
    x184 = x148 * x181 - x16 * x180 + x169 * x183 + x182
    x185 = x163 * x49
    x186 = x139 * x181 + x163 * x183 - x180 * x32 + x185
    x187 = x167 * x49
    x188 = x144 * x181 + x167 * x183 - x180 * x43 + x187
    x189 = x132 * (-x140 * x186 - x145 * x188 - x149 * x184)
    x190 = (edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3)
    x191 = -x190 * x23
    x192 = x190 * x61
    x193 = 2.0 * x192
    x194 = M2 * x23
    x195 = M1 * x23
    x196 = x16 * x43
    x197 = b_parallel * x49
    x198 = -x197 + 1.0 / b_spin
    x199 = x152 * x198
    x200 = x135 * (
        I2 * x196
        - I3 * x196
        + M3 * x139
        - b_parallel * x172
        + b_roll * x185
        + x107 * x195
        - x139 * x199
        + x194 * x27
    )
    x201 = x16 * x32
    x202 = x133 * (
        -I1 * x201
        + I3 * x201
        + M3 * x144
        - b_parallel * x175
        + b_roll * x187
        + x105 * x195
        - x144 * x199
        + x194 * x36
    )
    x203 = x32 * x43
    x204 = x134 * (
        I1 * x203
        - I2 * x203
        + M3 * x148
        - b_parallel * x177
        + b_roll * x182
        + x104 * x195
        - x148 * x199
        + x194 * x8
    )
    x205 = 8.0 / (x131 * x131)
    x206 = x205 * (-x14 * x204 - x200 * x6 - x202 * x40)
    x207 = x23 * x37
    x208 = x162 * x207
    x209 = x161 * x6
    x210 = x143 * x61
    x211 = x160 * x37
    x212 = v1 * x37
    x213 = v2 * x37
    x214 = x147 * x61
    x215 = v3 * x37
    x216 = x159 * x37
    x217 = x157 * x40
    x218 = x158 * x6
    x219 = -x216 - x217 + x218
    x220 = -x119 * x212 - x213 * x62 - x214 * x215 - x219
    x221 = x158 * x37
    x222 = x159 * x6
    x223 = x14 * x157
    x224 = -x221 - x222 + x223
    x225 = -x118 * x212 - x210 * x215 - x213 * x66 - x224
    x226 = x16 * x58
    x227 = I3 * x226
    x228 = x43 * x9
    x229 = x138 * x61
    x230 = x198 * (x12 * x139 + x144 * x58 + x148 * x9 - x210 * x65 - x214 * x60 - x229 * x63 + x78)
    x231 = M1 * x37
    x232 = M2 * x37
    x233 = M3 * x37
    x234 = x195 * x37
    x235 = x14 * x194
    x236 = M3 * x23
    x237 = x236 * x40
    x238 = x12 * x197
    x239 = x23 * x40
    x240 = x199 * x239
    x241 = -2.0 * I2 * edot3 * x43 - x234 - x235 + x237 + x238 - x240
    x242 = (
        2.0 * I2 * edot2 * x16
        - I3 * x228
        + b_roll
        * x49
        * (
            2.0 * e0 * x147 * x162 * x61
            + x143 * x220 * x23
            - x148 * x225
            - x208
            + x209
            - x210 * x211
        )
        + 2.0 * e0 * x138 * x152 * x198 * x61
        - x120 * x231
        - x139 * x230
        - x227
        - x229 * x233
        - x232 * x64
        - x241
    )
    x243 = x166 * x207
    x244 = x161 * x40
    x245 = x214 * x37
    x246 = x157 * x37
    x247 = x14 * x158
    x248 = x159 * x40
    x249 = -x246 - x247 + x248
    x250 = -x120 * x212 - x213 * x64 - x215 * x229 - x249
    x251 = x12 * x16
    x252 = x32 * x9
    x253 = I1 * x252
    x254 = x194 * x37
    x255 = x236 * x6
    x256 = x14 * x195
    x257 = x197 * x58
    x258 = x23 * x6
    x259 = x199 * x258
    x260 = -2.0 * I3 * edot1 * x16 - x254 - x255 + x256 + x257 + x259
    x261 = (
        -I1 * x251
        + 2.0 * I3 * edot3 * x32
        + b_roll * x49 * (-x139 * x220 + x148 * x250 - x166 * x245 + x211 * x229 + x243 + x244)
        + 2.0 * e0 * x143 * x152 * x198 * x61
        - x118 * x231
        - x144 * x230
        - x210 * x233
        - x232 * x66
        - x253
        - x260
    )
    x262 = x166 * x258
    x263 = x162 * x23
    x264 = x263 * x40
    x265 = x162 * x229
    x266 = x12 * x43
    x267 = I2 * x266
    x268 = x32 * x58
    x269 = x195 * x40
    x270 = M3 * x207
    x271 = x194 * x6
    x272 = x197 * x9
    x273 = x199 * x207
    x274 = -2.0 * I1 * edot2 * x32 - x269 - x270 + x271 + x272 + x273
    x275 = (
        2.0 * I1 * edot1 * x43
        - I2 * x268
        - M3 * x245
        + b_roll
        * x49
        * (
            2.0 * e0 * x143 * x166 * x61
            + x138 * x225 * x23
            - x144 * x250
            - x262
            - x264
            - x265 * x37
        )
        + 2.0 * e0 * x147 * x152 * x198 * x61
        - x119 * x231
        - x148 * x230
        - x232 * x62
        - x267
        - x274
    )
    x276 = x192 * x7
    x277 = 2.0 * x200
    x278 = x161 * x37
    x279 = x162 * x258
    x280 = x214 * x6
    x281 = v1 * x6
    x282 = v2 * x6
    x283 = v3 * x6
    x284 = -x119 * x281 - x214 * x283 - x221 - x222 + x223 - x282 * x62
    x285 = -x118 * x281 - x210 * x283 - x219 - x282 * x66
    x286 = b_roll * x49
    x287 = x43 * x58
    x288 = -I2 * x287
    x289 = x16 * x9
    x290 = x198 * (
        2.0 * e0 * x23 * x43
        + 2.0 * e3 * x23 * x32
        + 2.0 * edot3 * x143 * x23
        - x139 * x71
        - x148 * x58
        - x210 * x74
        - x214 * x72
        - x229 * x73
        - x67
    )
    x291 = M1 * x6
    x292 = M2 * x6
    x293 = M3 * x6
    x294 = x195 * x6
    x295 = x194 * x40
    x296 = x14 * x236
    x297 = x197 * x71
    x298 = x14 * x23
    x299 = -x199 * x298
    x300 = -I3 * x289 + x294 + x295 + x296 + x297 + x299
    x301 = (
        I2 * x289
        + I3 * x287
        - x120 * x291
        - x139 * x290
        + x199 * x229 * x6
        - x229 * x293
        + x286 * (x144 * x284 - x148 * x285 - x160 * x210 * x6 + x162 * x280 + x278 + x279)
        + x288
        - x292 * x64
        + x300
    )
    x302 = x14 * x161
    x303 = (
        2.0 * e1 * v1 * x23
        + 2.0 * e2 * v2 * x23
        + 2.0 * e3 * v3 * x23
        - x120 * x281
        - x229 * x283
        - x282 * x64
    )
    x304 = x16 * x71
    x305 = I3 * x304
    x306 = (
        2.0 * I1 * edot0 * x16
        - I3 * x268
        + b_roll
        * x49
        * (
            2.0 * e1 * x138 * x160 * x61
            - x139 * x284
            + x147 * x23 * x303
            - x166 * x280
            - x262
            - x302
        )
        + 2.0 * e1 * x143 * x152 * x198 * x61
        - x118 * x291
        - x144 * x290
        - x210 * x293
        - x274
        - x292 * x66
        - x305
    )
    x307 = x43 * x71
    x308 = I2 * x307
    x309 = -x14 * x263
    x310 = (
        -I1 * x307
        - I2 * x252
        - M3 * x280
        + b_roll
        * x49
        * (2.0 * e1 * x143 * x166 * x61 + x138 * x23 * x285 - x144 * x303 - x243 - x265 * x6 - x309)
        + 2.0 * e1 * x147 * x152 * x198 * x61
        - x119 * x291
        - x148 * x290
        + x253
        - x254
        - x255
        + x256
        + x257
        + x259
        - x292 * x62
        + x308
    )
    x311 = x102 * x192
    x312 = 2.0 * x202
    x313 = M2 * x40
    x314 = M3 * x40
    x315 = M1 * x40
    x316 = x198 * (
        2.0 * edot1 * x147 * x23
        - x117
        - x139 * x9
        - x144 * x71
        - x210 * x81
        - x214 * x79
        - x229 * x80
    )
    x317 = x160 * x40
    x318 = x214 * x40
    x319 = v1 * x40
    x320 = v2 * x40
    x321 = v3 * x40
    x322 = -x119 * x319 - x214 * x321 - x249 - x320 * x62
    x323 = x14 * x159 + x157 * x6 + x158 * x40
    x324 = -x118 * x319 - x210 * x321 - x320 * x66 + x323
    x325 = (
        -I2 * x304
        - I3 * x266
        + b_roll * x49 * (x144 * x322 - x148 * x324 + x162 * x318 - x210 * x317 + x264 + x302)
        + 2.0 * e2 * x138 * x152 * x198 * x61
        - x120 * x315
        - x139 * x316
        - x229 * x314
        + x267
        - x269
        - x270
        + x271
        + x272
        + x273
        + x305
        - x313 * x64
    )
    x326 = x166 * x23
    x327 = -x326 * x40
    x328 = -x120 * x319 - x216 - x217 + x218 - x229 * x321 - x320 * x64
    x329 = x12 * x32
    x330 = -I1 * x329
    x331 = (
        I1 * x289
        + I3 * x329
        - x118 * x315
        - x144 * x316
        + x199 * x210 * x40
        - x210 * x314
        + x286 * (-x139 * x322 + x148 * x328 - x166 * x318 + x229 * x317 + x278 + x327)
        + x300
        - x313 * x66
        + x330
    )
    x332 = x14 * x326
    x333 = x32 * x71
    x334 = I1 * x333
    x335 = (
        -I1 * x228
        + 2.0 * I2 * edot0 * x32
        - M3 * x318
        + b_roll
        * x49
        * (
            2.0 * e2 * x143 * x166 * x61
            + x138 * x23 * x324
            - x144 * x328
            - x208
            - x265 * x40
            - x332
        )
        + 2.0 * e2 * x147 * x152 * x198 * x61
        - x119 * x315
        - x148 * x316
        - x241
        - x313 * x62
        - x334
    )
    x336 = x192 * x25
    x337 = 2.0 * x204
    x338 = x14 * x214
    x339 = v1 * x14
    x340 = v2 * x14
    x341 = v3 * x14
    x342 = -x119 * x339 - x214 * x341 + x323 - x340 * x62
    x343 = -x118 * x339 - x210 * x341 - x246 - x247 + x248 - x340 * x66
    x344 = x198 * (
        2.0 * edot2 * x138 * x23
        - x12 * x144
        - x148 * x71
        - x210 * x88
        - x214 * x86
        - x229 * x87
        - x82
    )
    x345 = M1 * x14
    x346 = M2 * x14
    x347 = M3 * x14
    x348 = (
        -I2 * x251
        + 2.0 * I3 * edot0 * x43
        + b_roll
        * x49
        * (-x14 * x160 * x210 + x144 * x342 - x148 * x343 + x162 * x338 + x244 + x309)
        + 2.0 * e3 * x138 * x152 * x198 * x61
        - x120 * x345
        - x139 * x344
        - x229 * x347
        - x260
        - x308
        - x346 * x64
    )
    x349 = -x120 * x339 - x224 - x229 * x341 - x340 * x64
    x350 = (
        -I1 * x226
        - I3 * x333
        + b_roll
        * x49
        * (
            2.0 * e3 * x138 * x160 * x61
            - x139 * x342
            + x147 * x23 * x349
            - x166 * x338
            - x209
            + x332
        )
        + 2.0 * e3 * x143 * x152 * x198 * x61
        - x118 * x345
        - x144 * x344
        - x210 * x347
        + x227
        - x234
        - x235
        + x237
        + x238
        - x240
        + x334
        - x346 * x66
    )
    x351 = (
        I1 * x287
        + I2 * x329
        - M3 * x338
        - x119 * x345
        - x148 * x344
        + x199 * x338
        + x286 * (x139 * x343 + x14 * x166 * x210 - x14 * x265 - x144 * x349 + x279 + x327)
        + x288
        + x294
        + x295
        + x296
        + x297
        + x299
        + x330
        - x346 * x62
    )
    x352 = -x105 * x214 + x119 * x143
    x353 = x140 * x286
    x354 = x105 * x138 * x61 - x107 * x210
    x355 = x149 * x286
    x356 = x107 * x147 * x61 - x119 * x138
    x357 = x145 * x286
    x358 = x147 * x27 * x61 - x229 * x8
    x359 = x138 * x36 * x61 - x210 * x27
    x360 = x210 * x8 - x214 * x36
    x361 = x197 * x6
    x362 = I2 * x88
    x363 = I3 * x79
    x364 = x198 * (-x139 * x6 - x14 * x148 - x144 * x40)
    x365 = -I2 * x79 + 2.0 * I3 * e3 * x43 - x139 * x364 + x361 - x362 + x363
    x366 = -I3 * x72
    x367 = x197 * x40
    x368 = I1 * x87 + x367
    x369 = I1 * x72 - I3 * x87 - x144 * x364 + x366 + x368
    x370 = I2 * x74
    x371 = x14 * x197
    x372 = I1 * x80 - x371
    x373 = -I1 * x74 + 2.0 * I2 * e2 * x32 - x148 * x364 + x370 - x372
    x374 = -2.0 * I2 * e2 * x43
    x375 = x139 * x37
    x376 = x14 * x144
    x377 = x148 * x40
    x378 = x198 * (x375 - x376 + x377)
    x379 = x197 * x37
    x380 = -2.0 * I3 * e3 * x16 + x379
    x381 = -I2 * x86 - I3 * x81 - x139 * x378 - x374 - x380
    x382 = I3 * x60
    x383 = -I1 * x60 + 2.0 * I3 * e2 * x32 - x144 * x378 - x372 + x382
    x384 = I2 * x65
    x385 = 2.0 * I1 * e0 * x43 + 2.0 * I2 * e3 * x32 - x148 * x378 - x368 - x384
    x386 = x144 * x37
    x387 = x139 * x14
    x388 = x148 * x6
    x389 = x198 * (x386 + x387 - x388)
    x390 = 2.0 * I2 * e0 * x16 + 2.0 * I3 * e1 * x43 - x139 * x389 - x370 - x371 - x382
    x391 = -2.0 * I1 * e1 * x32
    x392 = -I1 * x86 - I3 * x73 - x144 * x389 - x380 - x391
    x393 = I1 * x63 + x361
    x394 = I1 * x88 - I2 * x63 - x148 * x389 - x362 + x393
    x395 = x144 * x6
    x396 = x139 * x40
    x397 = x148 * x37
    x398 = x198 * (x395 - x396 + x397)
    x399 = I2 * x72 - I3 * x65 - x139 * x398 + x366 + x367 + x384
    x400 = 2.0 * I1 * e2 * x16 + 2.0 * I3 * e0 * x32 - x144 * x398 - x363 - x393
    x401 = -I1 * x81 - I2 * x73 - x148 * x398 - x374 - x379 - x391
    x402 = x132 * (-x115 * x133 * x14 + x124 * x134 + x125 * x135)
    x403 = x132 * (-x133 * x95 + x134 * x94 + x135 * x93)
    x404 = x135 * x375
    x405 = x133 * x376
    x406 = x134 * x377
    x407 = x132 * (x404 - x405 + x406)
    x408 = x132 * (x153 * x404 - x153 * x405 + x153 * x406)
    x409 = x135 * x37
    x410 = x133 * x14
    x411 = x134 * x40
    x412 = x132 * (x165 * x409 - x168 * x410 + x170 * x411)
    x413 = x132 * (x174 * x409 - x176 * x410 + x178 * x411)
    x414 = x132 * (x184 * x411 + x186 * x409 - x188 * x410)
    x415 = x205 * (-x14 * x202 + x200 * x37 + x204 * x40)
    x416 = x192 * x26
    x417 = x103 * x192
    x418 = x286 * x409
    x419 = x286 * x411
    x420 = x286 * x410
    x421 = x132 * (-x116 * x134 * x6 + x126 * x133 + x127 * x135)
    x422 = x132 * (x133 * x98 - x134 * x96 + x135 * x97)
    x423 = x135 * x387
    x424 = x133 * x386
    x425 = x134 * x388
    x426 = x132 * (x423 + x424 - x425)
    x427 = x132 * (x153 * x423 + x153 * x424 - x153 * x425)
    x428 = x135 * x14
    x429 = x133 * x37
    x430 = x134 * x6
    x431 = x132 * (x165 * x428 + x168 * x429 - x170 * x430)
    x432 = x132 * (x174 * x428 + x176 * x429 - x178 * x430)
    x433 = x132 * (-x184 * x430 + x186 * x428 + x188 * x429)
    x434 = x205 * (x14 * x200 + x202 * x37 - x204 * x6)
    x435 = x142 * x192
    x436 = x286 * x428
    x437 = x286 * x430
    x438 = x286 * x429
    x439 = x132 * (-x114 * x135 * x40 + x128 * x134 + x129 * x133)
    x440 = x132 * (-x100 * x135 + x101 * x133 + x134 * x99)
    x441 = x135 * x396
    x442 = x133 * x395
    x443 = x134 * x397
    x444 = x132 * (-x441 + x442 + x443)
    x445 = x132 * (-x153 * x441 + x153 * x442 + x153 * x443)
    x446 = x135 * x40
    x447 = x133 * x6
    x448 = x134 * x37
    x449 = x132 * (-x165 * x446 + x168 * x447 + x170 * x448)
    x450 = x132 * (-x174 * x446 + x176 * x447 + x178 * x448)
    x451 = x132 * (x184 * x448 - x186 * x446 + x188 * x447)
    x452 = x205 * (-x200 * x40 + x202 * x6 + x204 * x37)
    x453 = x286 * x446
    x454 = x286 * x448
    x455 = x286 * x447
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
    out[7, 3] = x70 * (x12 * x56 + x57 * x58 + x59 * x9 - x60 * x62 - x63 * x64 - x65 * x66 + x68)
    out[7, 4] = x70 * (
        2.0 * edot3 * x23 * x36 - x56 * x71 - x58 * x59 - x62 * x72 - x64 * x73 - x66 * x74 - x78
    )
    out[7, 5] = x70 * (
        2.0 * edot1 * x23 * x8 - x56 * x9 - x57 * x71 - x62 * x79 - x64 * x80 - x66 * x81 - x82
    )
    out[7, 6] = x70 * (
        2.0 * edot2 * x23 * x27
        - x12 * x57
        - x59 * x71
        - x62 * x86
        - x64 * x87
        - x66 * x88
        + x83
        + x84
        - x85
    )
    out[7, 7] = x89
    out[7, 8] = 0.0
    out[7, 9] = 0.0
    out[7, 10] = x70 * (-x90 - x91 - x92)
    out[7, 11] = x70 * (x93 + x94 - x95)
    out[7, 12] = x70 * (-x96 + x97 + x98)
    out[7, 13] = x70 * (-x100 + x101 + x99)
    out[8, 0] = DF21 * x0 + Db11 * x111 + Db31 * x112 + Db51 * x113
    out[8, 1] = DF22 * x0 + Db12 * x111 + Db32 * x112 + Db52 * x113
    out[8, 2] = DF23 * x0 + Db13 * x111 + Db33 * x112 + Db53 * x113
    out[8, 3] = x70 * (
        2.0 * e0 * x104 * x16 * x61
        + 2.0 * e0 * x105 * x43 * x61
        + 2.0 * e0 * x107 * x32 * x61
        - x114 * x12
        - x115 * x58
        - x116 * x9
        - x117
    )
    out[8, 4] = x70 * (
        x114 * x71 - x115 * x9 + x116 * x58 + x118 * x74 + x119 * x72 + x120 * x73 + x82
    )
    out[8, 5] = x70 * (
        x114 * x9 + x115 * x71 - x116 * x12 + x118 * x81 + x119 * x79 + x120 * x80 + x75 - x76 - x77
    )
    out[8, 6] = x70 * (
        -x114 * x58 + x115 * x12 + x116 * x71 + x118 * x88 + x119 * x86 + x120 * x87 + x68
    )
    out[8, 7] = 0.0
    out[8, 8] = x89
    out[8, 9] = 0.0
    out[8, 10] = x70 * (x121 + x122 + x123)
    out[8, 11] = x70 * (2.0 * e3 * x105 * x23 - x124 - x125)
    out[8, 12] = x70 * (2.0 * e1 * x104 * x23 - x126 - x127)
    out[8, 13] = x70 * (2.0 * e2 * x107 * x23 - x128 - x129)
    out[9, 0] = DF31 * x0 + Db21 * x130
    out[9, 1] = DF32 * x0 + Db22 * x130
    out[9, 2] = DF33 * x0 + Db23 * x130
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
        DM11 * x136
        + DM21 * x137
        + DM31 * x151
        + Db11 * x179
        + Db31 * x171
        + Db41 * x154
        + Db51 * x189
    )
    out[10, 1] = (
        DM12 * x136
        + DM22 * x137
        + DM32 * x151
        + Db12 * x179
        + Db32 * x171
        + Db42 * x154
        + Db52 * x189
    )
    out[10, 2] = (
        DM13 * x136
        + DM23 * x137
        + DM33 * x151
        + Db13 * x179
        + Db33 * x171
        + Db43 * x154
        + Db53 * x189
    )
    out[10, 3] = -e0 * x206 + x132 * (-x140 * x242 - x145 * x261 - x149 * x275) + x19 * x193 + x191
    out[10, 4] = -e1 * x206 + x132 * (-x140 * x301 - x145 * x306 - x149 * x310 - x277) + x276
    out[10, 5] = -e2 * x206 + x132 * (-x140 * x325 - x145 * x331 - x149 * x335 - x312) + x311
    out[10, 6] = -e3 * x206 + x132 * (-x140 * x348 - x145 * x350 - x149 * x351 - x337) + x336
    out[10, 7] = x132 * (-x352 * x353 - x354 * x355 - x356 * x357)
    out[10, 8] = x132 * (-x353 * x360 - x355 * x359 - x357 * x358)
    out[10, 9] = 0.0
    out[10, 10] = -edot0 * x207 + x132 * (-x140 * x365 - x145 * x369 - x149 * x373)
    out[10, 11] = x132 * (-x140 * x381 - x145 * x383 - x149 * x385) - x23 * x28
    out[10, 12] = x132 * (-x140 * x390 - x145 * x392 - x149 * x394) - x23 * x38
    out[10, 13] = -x10 * x23 + x132 * (-x140 * x399 - x145 * x400 - x149 * x401)
    out[11, 0] = (
        DM11 * x402
        + DM21 * x403
        + DM31 * x407
        + Db11 * x413
        + Db31 * x412
        + Db41 * x408
        + Db51 * x414
    )
    out[11, 1] = (
        DM12 * x402
        + DM22 * x403
        + DM32 * x407
        + Db12 * x413
        + Db32 * x412
        + Db42 * x408
        + Db52 * x414
    )
    out[11, 2] = (
        DM13 * x402
        + DM23 * x403
        + DM33 * x407
        + Db13 * x413
        + Db33 * x412
        + Db43 * x408
        + Db53 * x414
    )
    out[11, 3] = -e0 * x415 + x132 * (x242 * x409 - x261 * x410 + x275 * x411 + x277) + x276
    out[11, 4] = -e1 * x415 + x132 * (x301 * x409 - x306 * x410 + x310 * x411) + x17 * x193 + x191
    out[11, 5] = -e2 * x415 + x132 * (x325 * x409 - x331 * x410 + x335 * x411 + x337) + x416
    out[11, 6] = -e3 * x415 + x132 * (-x312 + x348 * x409 - x350 * x410 + x351 * x411) + x417
    out[11, 7] = x132 * (x352 * x418 + x354 * x419 - x356 * x420)
    out[11, 8] = x132 * (-x358 * x420 + x359 * x419 + x360 * x418)
    out[11, 9] = 0.0
    out[11, 10] = x132 * (x365 * x409 - x369 * x410 + x373 * x411) - x23 * x29
    out[11, 11] = -edot1 * x258 + x132 * (x381 * x409 - x383 * x410 + x385 * x411)
    out[11, 12] = -x11 * x23 + x132 * (x390 * x409 - x392 * x410 + x394 * x411)
    out[11, 13] = x132 * (x399 * x409 - x400 * x410 + x401 * x411) - x23 * x39
    out[12, 0] = (
        DM11 * x421
        + DM21 * x422
        + DM31 * x426
        + Db11 * x432
        + Db31 * x431
        + Db41 * x427
        + Db51 * x433
    )
    out[12, 1] = (
        DM12 * x421
        + DM22 * x422
        + DM32 * x426
        + Db12 * x432
        + Db32 * x431
        + Db42 * x427
        + Db52 * x433
    )
    out[12, 2] = (
        DM13 * x421
        + DM23 * x422
        + DM33 * x426
        + Db13 * x432
        + Db33 * x431
        + Db43 * x427
        + Db53 * x433
    )
    out[12, 3] = -e0 * x434 + x132 * (x242 * x428 + x261 * x429 - x275 * x430 + x312) + x311
    out[12, 4] = (
        -e1 * x434
        + x132 * (2.0 * e0 * x133 * x306 + 2.0 * e3 * x135 * x301 - x310 * x430 - x337)
        + x416
    )
    out[12, 5] = -e2 * x434 + x132 * (x325 * x428 + x331 * x429 - x335 * x430) + x191 + x193 * x20
    out[12, 6] = -e3 * x434 + x132 * (x277 + x348 * x428 + x350 * x429 - x351 * x430) + x435
    out[12, 7] = x132 * (x352 * x436 - x354 * x437 + x356 * x438)
    out[12, 8] = x132 * (x358 * x438 - x359 * x437 + x360 * x436)
    out[12, 9] = 0.0
    out[12, 10] = x132 * (x365 * x428 + x369 * x429 - x373 * x430) - x23 * x41
    out[12, 11] = -x13 * x23 + x132 * (x381 * x428 + x383 * x429 - x385 * x430)
    out[12, 12] = -edot2 * x239 + x132 * (x390 * x428 + x392 * x429 - x394 * x430)
    out[12, 13] = x132 * (x399 * x428 + x400 * x429 - x401 * x430) - x23 * x30
    out[13, 0] = (
        DM11 * x439
        + DM21 * x440
        + DM31 * x444
        + Db11 * x450
        + Db31 * x449
        + Db41 * x445
        + Db51 * x451
    )
    out[13, 1] = (
        DM12 * x439
        + DM22 * x440
        + DM32 * x444
        + Db12 * x450
        + Db32 * x449
        + Db42 * x445
        + Db52 * x451
    )
    out[13, 2] = (
        DM13 * x439
        + DM23 * x440
        + DM33 * x444
        + Db13 * x450
        + Db33 * x449
        + Db43 * x445
        + Db53 * x451
    )
    out[13, 3] = -e0 * x452 + x132 * (-x242 * x446 + x261 * x447 + x275 * x448 + x337) + x336
    out[13, 4] = -e1 * x452 + x132 * (-x301 * x446 + x306 * x447 + x310 * x448 + x312) + x417
    out[13, 5] = -e2 * x452 + x132 * (-x277 - x325 * x446 + x331 * x447 + x335 * x448) + x435
    out[13, 6] = -e3 * x452 + x132 * (-x348 * x446 + x350 * x447 + x351 * x448) + x18 * x193 + x191
    out[13, 7] = x132 * (-x352 * x453 + x354 * x454 + x356 * x455)
    out[13, 8] = x132 * (x358 * x455 + x359 * x454 - x360 * x453)
    out[13, 9] = 0.0
    out[13, 10] = x132 * (-x365 * x446 + x369 * x447 + x373 * x448) - x15 * x23
    out[13, 11] = x132 * (-x381 * x446 + x383 * x447 + x385 * x448) - x23 * x42
    out[13, 12] = x132 * (-x390 * x446 + x392 * x447 + x394 * x448) - x23 * x31
    out[13, 13] = -edot3 * x298 + x132 * (-x399 * x446 + x400 * x447 + x401 * x448)


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
