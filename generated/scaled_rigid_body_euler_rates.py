"""Scaled model (4.17): translation and rotation of a rigid body, Euler-parameter rates.

Made by `python -m derivation` from derivation/multiscale.py and derivation/rigid_body.py and derivation/drag.py; do not edit.
SymPy 1.14.0. 2537 operations, 522 temporaries.

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
PARAMS = ("m", "I1", "I2", "I3", "a2", "W1", "W2", "W3")
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
    params: (8) m, I1, I2, I3, a2, W1, W2, W3
    out: (14) filled with the result.
    257 operations, 53 temporaries.
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
    a2 = params[4]
    W1 = params[5]
    W2 = params[6]
    W3 = params[7]
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
    x30 = omega2 * omega3
    x31 = b_parallel * x0
    x32 = M2 * x11
    x33 = 2.0 * e1 * e3 - x23
    x34 = M3 * x11
    x35 = M1 * x11
    x36 = e3 * x4 + x13
    x37 = x16 + x26 + x7
    x38 = (-x31 + 1.0 / b_spin) * (x12 * x33 + x15 * x37 + x19 * x36)
    x39 = v1 * x11
    x40 = v2 * x11
    x41 = v3 * x11
    x42 = x11 * (x14 * x40 + x25 * x39 + x37 * x41)
    x43 = x18 * x40 + x22 * x39 + x36 * x41
    x44 = x11 * x37
    x45 = (
        I2 * x30
        - I3 * x30
        + a2
        * (
            -omega1 * x31
            - x11 * x33 * x38
            + x20 * (x36 * x42 - x43 * x44)
            + x27 * x35
            + x32 * x5
            + x33 * x34
        )
    ) / I1
    x46 = omega1 * omega3
    x47 = x11 * x36
    x48 = x27 * x39 + x33 * x41 + x40 * x5
    x49 = (
        -I1 * x46
        + I3 * x46
        + a2
        * (
            -omega2 * x31
            + x18 * x32
            + x20 * (x11 * x37 * x48 - x33 * x42)
            + x22 * x35
            + x34 * x36
            - x38 * x47
        )
    ) / I2
    x50 = 2.0 * e3
    x51 = omega1 * omega2
    x52 = (
        I1 * x51
        - I2 * x51
        + a2
        * (
            -omega3 * x31
            + x14 * x32
            + x20 * (x11 * x33 * x43 - x47 * x48)
            + x25 * x35
            + x34 * x37
            - x38 * x44
        )
    ) / I3
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
    out[10] = -e0 * x28 + x29 * (-x24 * x45 - x4 * x49 - x50 * x52)
    out[11] = -e1 * x28 + x29 * (x2 * x45 + x4 * x52 - x49 * x50)
    out[12] = -e2 * x28 + x29 * (x2 * x49 - x24 * x52 + x45 * x50)
    out[13] = -e3 * x28 + x29 * (x2 * x52 + x24 * x49 - x4 * x45)


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
    params: (8) m, I1, I2, I3, a2, W1, W2, W3
    out: (14, 14) filled with the result.
    2280 operations, 469 temporaries.
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
    a2 = params[4]
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
    x60 = x16 * x37
    x61 = 1.0 / (x22 * x22)
    x62 = x61 * x8
    x63 = x32 * x37
    x64 = x27 * x61
    x65 = x37 * x43
    x66 = x36 * x61
    x67 = x24 * x6
    x68 = x14 * x33 + x37 * x44 - x67
    x69 = b_roll * x49
    x70 = x0 * x69
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
    x89 = -b_turn * x0 * x49
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
    x134 = a2 * x133
    x135 = 1.0 / I3
    x136 = a2 * x135
    x137 = 1.0 / I1
    x138 = a2 * x137
    x139 = x132 * (-x121 * x134 - x122 * x136 - x123 * x138)
    x140 = x132 * (-x134 * x92 - x136 * x91 - x138 * x90)
    x141 = 2.0 * e1 * e3 - x102
    x142 = x141 * x23
    x143 = x137 * x6
    x144 = a2 * x143
    x145 = x142 * x144
    x146 = e2 * x14
    x147 = x146 + x7
    x148 = x147 * x23
    x149 = x133 * x40
    x150 = a2 * x149
    x151 = x148 * x150
    x152 = x106 + x18 + x34
    x153 = x152 * x23
    x154 = x135 * x14
    x155 = a2 * x154
    x156 = x153 * x155
    x157 = x132 * (-x145 - x151 - x156)
    x158 = x141 * x33 + x147 * x44 + x152 * x24
    x159 = x158 / (b_spin * b_spin)
    x160 = x132 * (-x145 * x159 - x151 * x159 - x156 * x159)
    x161 = b_parallel * b_parallel
    x162 = x158 * x161 * x5
    x163 = v1 * x23
    x164 = v2 * x23
    x165 = v3 * x23
    x166 = x104 * x163 + x152 * x165 + x164 * x8
    x167 = x166 * x23
    x168 = x105 * x163 + x147 * x165 + x164 * x36
    x169 = x147 * x167 - x153 * x168
    x170 = b_parallel * x51
    x171 = -x142 * x162 + x161 * x32 * x5 - x169 * x170
    x172 = x107 * x163 + x141 * x165 + x164 * x27
    x173 = -x141 * x167 + x152 * x172 * x23
    x174 = -x148 * x162 + x161 * x43 * x5 - x170 * x173
    x175 = x141 * x168 * x23 - x148 * x172
    x176 = -x153 * x162 + x16 * x161 * x5 - x170 * x175
    x177 = x132 * (-x144 * x171 - x150 * x174 - x155 * x176)
    x178 = x32 * x49
    x179 = x158 * (x2 * x5 - x49)
    x180 = b_parallel * b_turn * x32 * x5 - x142 * x179 - x169 * x52 - x178
    x181 = x43 * x49
    x182 = b_parallel * b_turn * x43 * x5 - x148 * x179 - x173 * x52 - x181
    x183 = x16 * x49
    x184 = b_parallel * b_turn * x16 * x5 - x153 * x179 - x175 * x52 - x183
    x185 = x132 * (-x144 * x180 - x150 * x182 - x155 * x184)
    x186 = 2.0 * x170
    x187 = x158 * x186
    x188 = x175 * x49
    x189 = x5 * x54
    x190 = x153 * x187 - x16 * x186 + x175 * x189 + x188
    x191 = x169 * x49
    x192 = x142 * x187 + x169 * x189 - x186 * x32 + x191
    x193 = x173 * x49
    x194 = x148 * x187 + x173 * x189 - x186 * x43 + x193
    x195 = x132 * (-x144 * x192 - x150 * x194 - x155 * x190)
    x196 = (edot0 * edot0) + (edot1 * edot1) + (edot2 * edot2) + (edot3 * edot3)
    x197 = -x196 * x23
    x198 = x196 * x61
    x199 = 2.0 * x198
    x200 = x16 * x43
    x201 = M2 * x23
    x202 = M1 * x23
    x203 = b_parallel * x49
    x204 = -x203 + 1.0 / b_spin
    x205 = x158 * x204
    x206 = x137 * (
        I2 * x200
        - I3 * x200
        + a2
        * (M3 * x142 - b_parallel * x178 + b_roll * x191 + x107 * x202 - x142 * x205 + x201 * x27)
    )
    x207 = x16 * x32
    x208 = x133 * (
        -I1 * x207
        + I3 * x207
        + a2
        * (M3 * x148 - b_parallel * x181 + b_roll * x193 + x105 * x202 - x148 * x205 + x201 * x36)
    )
    x209 = x32 * x43
    x210 = x135 * (
        I1 * x209
        - I2 * x209
        + a2
        * (M3 * x153 - b_parallel * x183 + b_roll * x188 + x104 * x202 - x153 * x205 + x201 * x8)
    )
    x211 = 8.0 / (x131 * x131)
    x212 = x211 * (-x14 * x210 - x206 * x6 - x208 * x40)
    x213 = x16 * x58
    x214 = x43 * x9
    x215 = I2 * x214
    x216 = I3 * x213
    x217 = x23 * x37
    x218 = x168 * x217
    x219 = x167 * x6
    x220 = x147 * x61
    x221 = x166 * x37
    x222 = v1 * x37
    x223 = v2 * x37
    x224 = x152 * x61
    x225 = v3 * x37
    x226 = x165 * x37
    x227 = x163 * x40
    x228 = x164 * x6
    x229 = -x226 - x227 + x228
    x230 = -x119 * x222 - x223 * x62 - x224 * x225 - x229
    x231 = x164 * x37
    x232 = x165 * x6
    x233 = x14 * x163
    x234 = -x231 - x232 + x233
    x235 = -x118 * x222 - x220 * x225 - x223 * x66 - x234
    x236 = x141 * x61
    x237 = x204 * (x12 * x142 + x148 * x58 + x153 * x9 - x220 * x65 - x224 * x60 - x236 * x63 + x78)
    x238 = M1 * x37
    x239 = M2 * x37
    x240 = M3 * x37
    x241 = x202 * x37
    x242 = x14 * x201
    x243 = M3 * x23
    x244 = x243 * x40
    x245 = x12 * x203
    x246 = x23 * x40
    x247 = x205 * x246
    x248 = -x241 - x242 + x244 + x245 - x247
    x249 = (
        I2 * x213
        - I3 * x214
        + a2
        * (
            b_roll
            * x49
            * (
                2.0 * e0 * x152 * x168 * x61
                + x147 * x23 * x230
                - x153 * x235
                - x218
                + x219
                - x220 * x221
            )
            + 2.0 * e0 * x141 * x158 * x204 * x61
            - x120 * x238
            - x142 * x237
            - x236 * x240
            - x239 * x64
            - x248
        )
        + x215
        - x216
    )
    x250 = x12 * x16
    x251 = x32 * x9
    x252 = I1 * x251
    x253 = I3 * x250
    x254 = x172 * x217
    x255 = x167 * x40
    x256 = x224 * x37
    x257 = x163 * x37
    x258 = x14 * x164
    x259 = x165 * x40
    x260 = -x257 - x258 + x259
    x261 = -x120 * x222 - x223 * x64 - x225 * x236 - x260
    x262 = x201 * x37
    x263 = x243 * x6
    x264 = x14 * x202
    x265 = x203 * x58
    x266 = x23 * x6
    x267 = x205 * x266
    x268 = -x262 - x263 + x264 + x265 + x267
    x269 = (
        -I1 * x250
        + I3 * x251
        + a2
        * (
            b_roll * x49 * (-x142 * x230 + x153 * x261 - x172 * x256 + x221 * x236 + x254 + x255)
            + 2.0 * e0 * x147 * x158 * x204 * x61
            - x118 * x238
            - x148 * x237
            - x220 * x240
            - x239 * x66
            - x268
        )
        - x252
        + x253
    )
    x270 = x12 * x43
    x271 = x32 * x58
    x272 = I1 * x271
    x273 = I2 * x270
    x274 = x172 * x266
    x275 = x168 * x23
    x276 = x275 * x40
    x277 = x168 * x236
    x278 = x202 * x40
    x279 = M3 * x217
    x280 = x201 * x6
    x281 = x203 * x9
    x282 = x205 * x217
    x283 = -x278 - x279 + x280 + x281 + x282
    x284 = (
        I1 * x270
        - I2 * x271
        + a2
        * (
            -M3 * x256
            + b_roll
            * x49
            * (
                2.0 * e0 * x147 * x172 * x61
                + x141 * x23 * x235
                - x148 * x261
                - x274
                - x276
                - x277 * x37
            )
            + 2.0 * e0 * x152 * x158 * x204 * x61
            - x119 * x238
            - x153 * x237
            - x239 * x62
            - x283
        )
        + x272
        - x273
    )
    x285 = x198 * x7
    x286 = 2.0 * x206
    x287 = x43 * x58
    x288 = -I2 * x287
    x289 = x16 * x9
    x290 = -I3 * x289
    x291 = x167 * x37
    x292 = x168 * x266
    x293 = x224 * x6
    x294 = v1 * x6
    x295 = v2 * x6
    x296 = v3 * x6
    x297 = -x119 * x294 - x224 * x296 - x231 - x232 + x233 - x295 * x62
    x298 = -x118 * x294 - x220 * x296 - x229 - x295 * x66
    x299 = x204 * (
        2.0 * e0 * x23 * x43
        + 2.0 * e3 * x23 * x32
        + 2.0 * edot3 * x147 * x23
        - x142 * x71
        - x153 * x58
        - x220 * x74
        - x224 * x72
        - x236 * x73
        - x67
    )
    x300 = M1 * x6
    x301 = M2 * x6
    x302 = M3 * x6
    x303 = x14 * x23
    x304 = x14 * x243 + x201 * x40 + x202 * x6 + x203 * x71 - x205 * x303
    x305 = (
        I2 * x289
        + I3 * x287
        + a2
        * (
            -x120 * x300
            - x142 * x299
            + x205 * x236 * x6
            - x236 * x302
            - x301 * x64
            + x304
            + x69 * (x148 * x297 - x153 * x298 - x166 * x220 * x6 + x168 * x293 + x291 + x292)
        )
        + x288
        + x290
    )
    x306 = x16 * x71
    x307 = I3 * x306
    x308 = x14 * x167
    x309 = (
        2.0 * e1 * v1 * x23
        + 2.0 * e2 * v2 * x23
        + 2.0 * e3 * v3 * x23
        - x120 * x294
        - x236 * x296
        - x295 * x64
    )
    x310 = (
        I1 * x306
        - I3 * x271
        + a2
        * (
            b_roll
            * x49
            * (
                2.0 * e1 * x141 * x166 * x61
                - x142 * x297
                + x152 * x23 * x309
                - x172 * x293
                - x274
                - x308
            )
            + 2.0 * e1 * x147 * x158 * x204 * x61
            - x118 * x300
            - x148 * x299
            - x220 * x302
            - x283
            - x301 * x66
        )
        + x272
        - x307
    )
    x311 = x43 * x71
    x312 = I2 * x311
    x313 = -x14 * x275
    x314 = (
        -I1 * x311
        - I2 * x251
        + a2
        * (
            -M3 * x293
            + b_roll
            * x49
            * (
                2.0 * e1 * x147 * x172 * x61
                + x141 * x23 * x298
                - x148 * x309
                - x254
                - x277 * x6
                - x313
            )
            + 2.0 * e1 * x152 * x158 * x204 * x61
            - x119 * x300
            - x153 * x299
            - x262
            - x263
            + x264
            + x265
            + x267
            - x301 * x62
        )
        + x252
        + x312
    )
    x315 = x102 * x198
    x316 = 2.0 * x208
    x317 = M2 * x40
    x318 = M3 * x40
    x319 = M1 * x40
    x320 = x204 * (
        2.0 * edot1 * x152 * x23
        - x117
        - x142 * x9
        - x148 * x71
        - x220 * x81
        - x224 * x79
        - x236 * x80
    )
    x321 = x166 * x40
    x322 = x224 * x40
    x323 = v1 * x40
    x324 = v2 * x40
    x325 = v3 * x40
    x326 = -x119 * x323 - x224 * x325 - x260 - x324 * x62
    x327 = x14 * x165 + x163 * x6 + x164 * x40
    x328 = -x118 * x323 - x220 * x325 - x324 * x66 + x327
    x329 = (
        -I2 * x306
        - I3 * x270
        + a2
        * (
            b_roll * x49 * (x148 * x326 - x153 * x328 + x168 * x322 - x220 * x321 + x276 + x308)
            + 2.0 * e2 * x141 * x158 * x204 * x61
            - x120 * x319
            - x142 * x320
            - x236 * x318
            - x278
            - x279
            + x280
            + x281
            + x282
            - x317 * x64
        )
        + x273
        + x307
    )
    x330 = x12 * x32
    x331 = -I1 * x330
    x332 = x172 * x23
    x333 = -x332 * x40
    x334 = -x120 * x323 - x226 - x227 + x228 - x236 * x325 - x324 * x64
    x335 = (
        I1 * x289
        + I3 * x330
        + a2
        * (
            -x118 * x319
            - x148 * x320
            + x205 * x220 * x40
            - x220 * x318
            + x304
            - x317 * x66
            + x69 * (-x142 * x326 + x153 * x334 - x172 * x322 + x236 * x321 + x291 + x333)
        )
        + x290
        + x331
    )
    x336 = x32 * x71
    x337 = I1 * x336
    x338 = x14 * x332
    x339 = (
        -I1 * x214
        + I2 * x336
        + a2
        * (
            -M3 * x322
            + b_roll
            * x49
            * (
                2.0 * e2 * x147 * x172 * x61
                + x141 * x23 * x328
                - x148 * x334
                - x218
                - x277 * x40
                - x338
            )
            + 2.0 * e2 * x152 * x158 * x204 * x61
            - x119 * x319
            - x153 * x320
            - x248
            - x317 * x62
        )
        + x215
        - x337
    )
    x340 = x198 * x25
    x341 = 2.0 * x210
    x342 = x14 * x224
    x343 = v1 * x14
    x344 = v2 * x14
    x345 = v3 * x14
    x346 = -x119 * x343 - x224 * x345 + x327 - x344 * x62
    x347 = -x118 * x343 - x220 * x345 - x257 - x258 + x259 - x344 * x66
    x348 = x204 * (
        2.0 * edot2 * x141 * x23
        - x12 * x148
        - x153 * x71
        - x220 * x88
        - x224 * x86
        - x236 * x87
        - x82
    )
    x349 = M1 * x14
    x350 = M2 * x14
    x351 = M3 * x14
    x352 = (
        -I2 * x250
        + I3 * x311
        + a2
        * (
            b_roll
            * x49
            * (-x14 * x166 * x220 + x148 * x346 - x153 * x347 + x168 * x342 + x255 + x313)
            + 2.0 * e3 * x141 * x158 * x204 * x61
            - x120 * x349
            - x142 * x348
            - x236 * x351
            - x268
            - x350 * x64
        )
        + x253
        - x312
    )
    x353 = -x120 * x343 - x234 - x236 * x345 - x344 * x64
    x354 = (
        -I1 * x213
        - I3 * x336
        + a2
        * (
            b_roll
            * x49
            * (
                2.0 * e3 * x141 * x166 * x61
                - x142 * x346
                + x152 * x23 * x353
                - x172 * x342
                - x219
                + x338
            )
            + 2.0 * e3 * x147 * x158 * x204 * x61
            - x118 * x349
            - x148 * x348
            - x220 * x351
            - x241
            - x242
            + x244
            + x245
            - x247
            - x350 * x66
        )
        + x216
        + x337
    )
    x355 = (
        I1 * x287
        + I2 * x330
        + a2
        * (
            -M3 * x342
            - x119 * x349
            - x153 * x348
            + x205 * x342
            + x304
            - x350 * x62
            + x69 * (x14 * x172 * x220 - x14 * x277 + x142 * x347 - x148 * x353 + x292 + x333)
        )
        + x288
        + x331
    )
    x356 = -x105 * x224 + x119 * x147
    x357 = x144 * x69
    x358 = x105 * x141 * x61 - x107 * x220
    x359 = x155 * x69
    x360 = x107 * x152 * x61 - x119 * x141
    x361 = x150 * x69
    x362 = x152 * x27 * x61 - x236 * x8
    x363 = x141 * x36 * x61 - x220 * x27
    x364 = x220 * x8 - x224 * x36
    x365 = -I2 * x88
    x366 = I3 * x79
    x367 = x203 * x6
    x368 = x204 * (-x14 * x153 - x142 * x6 - x148 * x40)
    x369 = -I2 * x79 + I3 * x88 + a2 * (-x142 * x368 + x367) + x365 + x366
    x370 = I1 * x87
    x371 = -I3 * x72
    x372 = x203 * x40
    x373 = I1 * x72 - I3 * x87 + a2 * (-x148 * x368 + x372) + x370 + x371
    x374 = -I1 * x80
    x375 = I2 * x74
    x376 = x14 * x203
    x377 = -I1 * x74 + I2 * x80 + a2 * (-x153 * x368 + x376) + x374 + x375
    x378 = I2 * x81
    x379 = I3 * x86
    x380 = x203 * x37
    x381 = x142 * x37
    x382 = x14 * x148
    x383 = x153 * x40
    x384 = x204 * (x381 - x382 + x383)
    x385 = -I2 * x86 - I3 * x81 + a2 * (-x142 * x384 - x380) + x378 + x379
    x386 = I3 * x60
    x387 = -I1 * x60 + I3 * x80 + a2 * (-x148 * x384 + x376) + x374 + x386
    x388 = I2 * x65
    x389 = I1 * x65 + I2 * x87 + a2 * (-x153 * x384 - x372) - x370 - x388
    x390 = x148 * x37
    x391 = x14 * x142
    x392 = x153 * x6
    x393 = x204 * (x390 + x391 - x392)
    x394 = I2 * x60 + I3 * x74 + a2 * (-x142 * x393 - x376) - x375 - x386
    x395 = I1 * x73
    x396 = -I1 * x86 - I3 * x73 + a2 * (-x148 * x393 - x380) + x379 + x395
    x397 = I1 * x63
    x398 = I1 * x88 - I2 * x63 + a2 * (-x153 * x393 + x367) + x365 + x397
    x399 = x148 * x6
    x400 = x142 * x40
    x401 = x153 * x37
    x402 = x204 * (x399 - x400 + x401)
    x403 = I2 * x72 - I3 * x65 + a2 * (-x142 * x402 + x372) + x371 + x388
    x404 = I1 * x79 + I3 * x63 + a2 * (-x148 * x402 - x367) - x366 - x397
    x405 = -I1 * x81 - I2 * x73 + a2 * (-x153 * x402 - x380) + x378 + x395
    x406 = x132 * (-x115 * x134 * x14 + x124 * x136 + x125 * x138)
    x407 = x132 * (-x134 * x95 + x136 * x94 + x138 * x93)
    x408 = x138 * x381
    x409 = x134 * x382
    x410 = x136 * x383
    x411 = x132 * (x408 - x409 + x410)
    x412 = x132 * (x159 * x408 - x159 * x409 + x159 * x410)
    x413 = x137 * x37
    x414 = a2 * x413
    x415 = x133 * x14
    x416 = a2 * x415
    x417 = x135 * x40
    x418 = a2 * x417
    x419 = x132 * (x171 * x414 - x174 * x416 + x176 * x418)
    x420 = x132 * (x180 * x414 - x182 * x416 + x184 * x418)
    x421 = x132 * (x190 * x418 + x192 * x414 - x194 * x416)
    x422 = x211 * (-x14 * x208 + x206 * x37 + x210 * x40)
    x423 = x198 * x26
    x424 = x103 * x198
    x425 = x414 * x69
    x426 = x418 * x69
    x427 = x416 * x69
    x428 = x132 * (-x116 * x136 * x6 + x126 * x134 + x127 * x138)
    x429 = x132 * (x134 * x98 - x136 * x96 + x138 * x97)
    x430 = x138 * x391
    x431 = x134 * x390
    x432 = x136 * x392
    x433 = x132 * (x430 + x431 - x432)
    x434 = x132 * (x159 * x430 + x159 * x431 - x159 * x432)
    x435 = x137 * x14
    x436 = a2 * x435
    x437 = x133 * x37
    x438 = a2 * x437
    x439 = x135 * x6
    x440 = a2 * x439
    x441 = x132 * (x171 * x436 + x174 * x438 - x176 * x440)
    x442 = x132 * (x180 * x436 + x182 * x438 - x184 * x440)
    x443 = x132 * (-x190 * x440 + x192 * x436 + x194 * x438)
    x444 = x211 * (x14 * x206 + x208 * x37 - x210 * x6)
    x445 = x146 * x198
    x446 = x436 * x69
    x447 = x440 * x69
    x448 = x438 * x69
    x449 = x132 * (-x114 * x138 * x40 + x128 * x136 + x129 * x134)
    x450 = x132 * (-x100 * x138 + x101 * x134 + x136 * x99)
    x451 = x138 * x400
    x452 = x134 * x399
    x453 = x136 * x401
    x454 = x132 * (-x451 + x452 + x453)
    x455 = x132 * (-x159 * x451 + x159 * x452 + x159 * x453)
    x456 = x137 * x40
    x457 = a2 * x456
    x458 = x133 * x6
    x459 = a2 * x458
    x460 = x135 * x37
    x461 = a2 * x460
    x462 = x132 * (-x171 * x457 + x174 * x459 + x176 * x461)
    x463 = x132 * (-x180 * x457 + x182 * x459 + x184 * x461)
    x464 = x132 * (x190 * x461 - x192 * x457 + x194 * x459)
    x465 = x211 * (-x206 * x40 + x208 * x6 + x210 * x37)
    x466 = x457 * x69
    x467 = x461 * x69
    x468 = x459 * x69
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
        DM11 * x139
        + DM21 * x140
        + DM31 * x157
        + Db11 * x185
        + Db31 * x177
        + Db41 * x160
        + Db51 * x195
    )
    out[10, 1] = (
        DM12 * x139
        + DM22 * x140
        + DM32 * x157
        + Db12 * x185
        + Db32 * x177
        + Db42 * x160
        + Db52 * x195
    )
    out[10, 2] = (
        DM13 * x139
        + DM23 * x140
        + DM33 * x157
        + Db13 * x185
        + Db33 * x177
        + Db43 * x160
        + Db53 * x195
    )
    out[10, 3] = -e0 * x212 + x132 * (-x143 * x249 - x149 * x269 - x154 * x284) + x19 * x199 + x197
    out[10, 4] = -e1 * x212 + x132 * (-x143 * x305 - x149 * x310 - x154 * x314 - x286) + x285
    out[10, 5] = -e2 * x212 + x132 * (-x143 * x329 - x149 * x335 - x154 * x339 - x316) + x315
    out[10, 6] = -e3 * x212 + x132 * (-x143 * x352 - x149 * x354 - x154 * x355 - x341) + x340
    out[10, 7] = x132 * (-x356 * x357 - x358 * x359 - x360 * x361)
    out[10, 8] = x132 * (-x357 * x364 - x359 * x363 - x361 * x362)
    out[10, 9] = 0.0
    out[10, 10] = -edot0 * x217 + x132 * (-x143 * x369 - x149 * x373 - x154 * x377)
    out[10, 11] = x132 * (-x143 * x385 - x149 * x387 - x154 * x389) - x23 * x28
    out[10, 12] = x132 * (-x143 * x394 - x149 * x396 - x154 * x398) - x23 * x38
    out[10, 13] = -x10 * x23 + x132 * (-x143 * x403 - x149 * x404 - x154 * x405)
    out[11, 0] = (
        DM11 * x406
        + DM21 * x407
        + DM31 * x411
        + Db11 * x420
        + Db31 * x419
        + Db41 * x412
        + Db51 * x421
    )
    out[11, 1] = (
        DM12 * x406
        + DM22 * x407
        + DM32 * x411
        + Db12 * x420
        + Db32 * x419
        + Db42 * x412
        + Db52 * x421
    )
    out[11, 2] = (
        DM13 * x406
        + DM23 * x407
        + DM33 * x411
        + Db13 * x420
        + Db33 * x419
        + Db43 * x412
        + Db53 * x421
    )
    out[11, 3] = -e0 * x422 + x132 * (x249 * x413 - x269 * x415 + x284 * x417 + x286) + x285
    out[11, 4] = -e1 * x422 + x132 * (x305 * x413 - x310 * x415 + x314 * x417) + x17 * x199 + x197
    out[11, 5] = -e2 * x422 + x132 * (x329 * x413 - x335 * x415 + x339 * x417 + x341) + x423
    out[11, 6] = -e3 * x422 + x132 * (-x316 + x352 * x413 - x354 * x415 + x355 * x417) + x424
    out[11, 7] = x132 * (x356 * x425 + x358 * x426 - x360 * x427)
    out[11, 8] = x132 * (-x362 * x427 + x363 * x426 + x364 * x425)
    out[11, 9] = 0.0
    out[11, 10] = x132 * (x369 * x413 - x373 * x415 + x377 * x417) - x23 * x29
    out[11, 11] = -edot1 * x266 + x132 * (x385 * x413 - x387 * x415 + x389 * x417)
    out[11, 12] = -x11 * x23 + x132 * (x394 * x413 - x396 * x415 + x398 * x417)
    out[11, 13] = x132 * (x403 * x413 - x404 * x415 + x405 * x417) - x23 * x39
    out[12, 0] = (
        DM11 * x428
        + DM21 * x429
        + DM31 * x433
        + Db11 * x442
        + Db31 * x441
        + Db41 * x434
        + Db51 * x443
    )
    out[12, 1] = (
        DM12 * x428
        + DM22 * x429
        + DM32 * x433
        + Db12 * x442
        + Db32 * x441
        + Db42 * x434
        + Db52 * x443
    )
    out[12, 2] = (
        DM13 * x428
        + DM23 * x429
        + DM33 * x433
        + Db13 * x442
        + Db33 * x441
        + Db43 * x434
        + Db53 * x443
    )
    out[12, 3] = -e0 * x444 + x132 * (x249 * x435 + x269 * x437 - x284 * x439 + x316) + x315
    out[12, 4] = (
        -e1 * x444
        + x132 * (2.0 * e0 * x133 * x310 + 2.0 * e3 * x137 * x305 - x314 * x439 - x341)
        + x423
    )
    out[12, 5] = -e2 * x444 + x132 * (x329 * x435 + x335 * x437 - x339 * x439) + x197 + x199 * x20
    out[12, 6] = -e3 * x444 + x132 * (x286 + x352 * x435 + x354 * x437 - x355 * x439) + x445
    out[12, 7] = x132 * (x356 * x446 - x358 * x447 + x360 * x448)
    out[12, 8] = x132 * (x362 * x448 - x363 * x447 + x364 * x446)
    out[12, 9] = 0.0
    out[12, 10] = x132 * (x369 * x435 + x373 * x437 - x377 * x439) - x23 * x41
    out[12, 11] = -x13 * x23 + x132 * (x385 * x435 + x387 * x437 - x389 * x439)
    out[12, 12] = -edot2 * x246 + x132 * (x394 * x435 + x396 * x437 - x398 * x439)
    out[12, 13] = x132 * (x403 * x435 + x404 * x437 - x405 * x439) - x23 * x30
    out[13, 0] = (
        DM11 * x449
        + DM21 * x450
        + DM31 * x454
        + Db11 * x463
        + Db31 * x462
        + Db41 * x455
        + Db51 * x464
    )
    out[13, 1] = (
        DM12 * x449
        + DM22 * x450
        + DM32 * x454
        + Db12 * x463
        + Db32 * x462
        + Db42 * x455
        + Db52 * x464
    )
    out[13, 2] = (
        DM13 * x449
        + DM23 * x450
        + DM33 * x454
        + Db13 * x463
        + Db33 * x462
        + Db43 * x455
        + Db53 * x464
    )
    out[13, 3] = -e0 * x465 + x132 * (-x249 * x456 + x269 * x458 + x284 * x460 + x341) + x340
    out[13, 4] = -e1 * x465 + x132 * (-x305 * x456 + x310 * x458 + x314 * x460 + x316) + x424
    out[13, 5] = -e2 * x465 + x132 * (-x286 - x329 * x456 + x335 * x458 + x339 * x460) + x445
    out[13, 6] = -e3 * x465 + x132 * (-x352 * x456 + x354 * x458 + x355 * x460) + x18 * x199 + x197
    out[13, 7] = x132 * (-x356 * x466 + x358 * x467 + x360 * x468)
    out[13, 8] = x132 * (x362 * x468 + x363 * x467 - x364 * x466)
    out[13, 9] = 0.0
    out[13, 10] = x132 * (-x369 * x456 + x373 * x458 + x377 * x460) - x15 * x23
    out[13, 11] = x132 * (-x385 * x456 + x387 * x458 + x389 * x460) - x23 * x42
    out[13, 12] = x132 * (-x394 * x456 + x396 * x458 + x398 * x460) - x23 * x31
    out[13, 13] = -edot3 * x303 + x132 * (-x403 * x456 + x404 * x458 + x405 * x460)


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
