"""Scaled model (4.17): translation and rotation of a rigid body.

Made by `python -m derivation` from derivation/multiscale.py and derivation/rigid_body.py and derivation/drag.py; do not edit.
SymPy 1.14.0. 1423 operations, 312 temporaries.

Any principal moments of inertia. State (e, omega), which no constraint can leave.

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
* [10] `omega1` [rad/s] angular velocity, body frame, along P1, (2.2)
* [11] `omega2` [rad/s] angular velocity, body frame, along P2, (2.2)
* [12] `omega3` [rad/s] angular velocity, body frame, along P3, (2.2)

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

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3", "v1", "v2", "v3", "omega1", "omega2", "omega3")
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
    state: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    params: (8) m, I1, I2, I3, a2, W1, W2, W3
    out: (13) filled with the result.
    200 operations, 51 temporaries.
    """
    e0 = state[3]
    e1 = state[4]
    e2 = state[5]
    e3 = state[6]
    v1 = state[7]
    v2 = state[8]
    v3 = state[9]
    omega1 = state[10]
    omega2 = state[11]
    omega3 = state[12]
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
    x0 = (1.0 / 2.0) * omega1
    x1 = (1.0 / 2.0) * e2
    x2 = (1.0 / 2.0) * e3
    x3 = (1.0 / 2.0) * e0
    x4 = (1.0 / 2.0) * e1
    x5 = 1.0 / (b_parallel * b_turn - (b_roll * b_roll))
    x6 = b_turn * x5
    x7 = 2.0 * e0
    x8 = e3 * x7
    x9 = 2.0 * e2
    x10 = e1 * x9 + x8
    x11 = e1 * e1
    x12 = e3 * e3
    x13 = e0 * e0
    x14 = e2 * e2
    x15 = x13 + x14
    x16 = 1.0 / (x11 + x12 + x15)
    x17 = omega1 * x16
    x18 = e1 * x7
    x19 = 2.0 * e2 * e3 - x18
    x20 = omega3 * x16
    x21 = -x11
    x22 = -x12
    x23 = x15 + x21 + x22
    x24 = omega2 * x16
    x25 = b_roll * x5
    x26 = a2 / m
    x27 = 2.0 * e1 * e2 - x8
    x28 = e2 * x7
    x29 = 2.0 * e1 * e3 + x28
    x30 = x13 - x14
    x31 = x11 + x22 + x30
    x32 = omega2 * omega3
    x33 = b_parallel * x5
    x34 = M2 * x16
    x35 = 2.0 * e1 * e3 - x28
    x36 = M3 * x16
    x37 = M1 * x16
    x38 = e3 * x9 + x18
    x39 = x12 + x21 + x30
    x40 = (-x33 + 1.0 / b_spin) * (x17 * x35 + x20 * x39 + x24 * x38)
    x41 = v1 * x16
    x42 = v2 * x16
    x43 = v3 * x16
    x44 = x16 * (x19 * x42 + x29 * x41 + x39 * x43)
    x45 = x23 * x42 + x27 * x41 + x38 * x43
    x46 = x16 * x39
    x47 = omega1 * omega3
    x48 = x16 * x38
    x49 = x10 * x42 + x31 * x41 + x35 * x43
    x50 = omega1 * omega2
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = -e1 * x0 - omega2 * x1 - omega3 * x2
    out[4] = e0 * x0 - omega2 * x2 + omega3 * x1
    out[5] = e3 * x0 + omega2 * x3 - omega3 * x4
    out[6] = -e2 * x0 + omega2 * x4 + omega3 * x3
    out[7] = x26 * (F1 + W1 - v1 * x6 + x25 * (x10 * x17 + x19 * x20 + x23 * x24))
    out[8] = x26 * (F2 + W2 - v2 * x6 + x25 * (-x17 * x31 - x20 * x29 - x24 * x27))
    out[9] = x26 * (F3 + W3 - v3 / b_perpendicular)
    out[10] = (
        I2 * x32
        - I3 * x32
        + a2
        * (
            -omega1 * x33
            + x10 * x34
            - x16 * x35 * x40
            + x25 * (x38 * x44 - x45 * x46)
            + x31 * x37
            + x35 * x36
        )
    ) / I1
    out[11] = (
        -I1 * x47
        + I3 * x47
        + a2
        * (
            -omega2 * x33
            + x23 * x34
            + x25 * (x16 * x39 * x49 - x35 * x44)
            + x27 * x37
            + x36 * x38
            - x40 * x48
        )
    ) / I2
    out[12] = (
        I1 * x50
        - I2 * x50
        + a2
        * (
            -omega3 * x33
            + x19 * x34
            + x25 * (x16 * x35 * x45 - x48 * x49)
            + x29 * x37
            + x36 * x39
            - x40 * x46
        )
    ) / I3


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
    state: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    mobility_gradient: (5, 3) as listed above
    params: (8) m, I1, I2, I3, a2, W1, W2, W3
    out: (13, 13) filled with the result.
    1223 operations, 261 temporaries.
    """
    e0 = state[3]
    e1 = state[4]
    e2 = state[5]
    e3 = state[6]
    v1 = state[7]
    v2 = state[8]
    v3 = state[9]
    omega1 = state[10]
    omega2 = state[11]
    omega3 = state[12]
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
    x0 = (1.0 / 2.0) * omega1
    x1 = -x0
    x2 = (1.0 / 2.0) * omega2
    x3 = -x2
    x4 = (1.0 / 2.0) * omega3
    x5 = -x4
    x6 = (1.0 / 2.0) * e1
    x7 = -x6
    x8 = (1.0 / 2.0) * e2
    x9 = -x8
    x10 = (1.0 / 2.0) * e3
    x11 = -x10
    x12 = (1.0 / 2.0) * e0
    x13 = a2 / m
    x14 = b_turn * b_turn
    x15 = b_parallel * b_turn
    x16 = b_roll * b_roll
    x17 = x15 - x16
    x18 = 1.0 / (x17 * x17)
    x19 = 2.0 * e0
    x20 = e3 * x19
    x21 = 2.0 * e2
    x22 = e1 * x21 + x20
    x23 = e1 * e1
    x24 = e3 * e3
    x25 = e0 * e0
    x26 = e2 * e2
    x27 = x25 + x26
    x28 = x23 + x24 + x27
    x29 = 1.0 / x28
    x30 = omega1 * x29
    x31 = e1 * x19
    x32 = 2.0 * e2 * e3 - x31
    x33 = omega3 * x29
    x34 = -x23
    x35 = -x24
    x36 = x27 + x34 + x35
    x37 = omega2 * x29
    x38 = x22 * x30 + x32 * x33 + x36 * x37
    x39 = x18 * x38
    x40 = b_roll * x39
    x41 = x13 * (-b_turn * x40 + v1 * x14 * x18)
    x42 = 1.0 / x17
    x43 = x13 * (b_parallel * b_turn * v1 * x18 - b_parallel * x40 - v1 * x42)
    x44 = 2.0 * b_roll * x18
    x45 = b_turn * x44
    x46 = 2.0 * x16
    x47 = x13 * (-v1 * x45 + x38 * x42 + x39 * x46)
    x48 = 1.0 / (x28 * x28)
    x49 = x19 * x48
    x50 = omega1 * x22
    x51 = omega2 * x36
    x52 = omega3 * x32
    x53 = 2.0 * e1
    x54 = x33 * x53
    x55 = -2.0 * e0 * omega2 * x29 - 2.0 * e3 * omega1 * x29 + x54
    x56 = b_roll * x42
    x57 = x13 * x56
    x58 = x19 * x33
    x59 = x37 * x53
    x60 = x21 * x30
    x61 = x48 * x53
    x62 = x21 * x48
    x63 = x30 * x53
    x64 = x21 * x37
    x65 = 2.0 * e3
    x66 = x33 * x65
    x67 = x63 + x64 + x66
    x68 = x48 * x65
    x69 = x19 * x30
    x70 = x21 * x33
    x71 = x37 * x65
    x72 = -x69 - x70 + x71
    x73 = -b_turn * x13 * x42
    x74 = x29 * x57
    x75 = 2.0 * e1 * e2 - x20
    x76 = e2 * x19
    x77 = e3 * x53 + x76
    x78 = x25 - x26
    x79 = x23 + x35 + x78
    x80 = -x30 * x79 - x33 * x77 - x37 * x75
    x81 = x18 * x80
    x82 = b_roll * x81
    x83 = x13 * (-b_turn * x82 + v2 * x14 * x18)
    x84 = x13 * (b_parallel * b_turn * v2 * x18 - b_parallel * x82 - v2 * x42)
    x85 = x13 * (-v2 * x45 + x42 * x80 + x46 * x81)
    x86 = omega1 * x79
    x87 = omega2 * x75
    x88 = omega3 * x77
    x89 = -x58 - x59 + x60
    x90 = v3 * x13 / (b_perpendicular * b_perpendicular)
    x91 = 1.0 / I1
    x92 = a2 * x91
    x93 = x29 * x92
    x94 = x22 * x93
    x95 = 2.0 * e1 * e3 - x76
    x96 = x29 * x95
    x97 = x92 * x96
    x98 = x79 * x93
    x99 = e3 * x21 + x31
    x100 = x24 + x34 + x78
    x101 = x100 * x33 + x30 * x95 + x37 * x99
    x102 = x101 / (b_spin * b_spin)
    x103 = x102 * x97
    x104 = b_parallel * b_parallel
    x105 = x101 * x104 * x18
    x106 = v1 * x29
    x107 = v2 * x29
    x108 = v3 * x29
    x109 = x100 * x108 + x106 * x77 + x107 * x32
    x110 = x29 * x99
    x111 = x106 * x75 + x107 * x36 + x108 * x99
    x112 = x100 * x29
    x113 = x109 * x110 - x111 * x112
    x114 = x113 * x18
    x115 = b_roll * x114
    x116 = x92 * (-b_parallel * x115 + omega1 * x104 * x18 - x105 * x96)
    x117 = x101 * (x15 * x18 - x42)
    x118 = x92 * (b_parallel * b_turn * omega1 * x18 - b_turn * x115 - omega1 * x42 - x117 * x96)
    x119 = b_parallel * x44
    x120 = x101 * x119
    x121 = x92 * (-omega1 * x119 + x113 * x42 + x114 * x46 + x120 * x96)
    x122 = x19 * x29
    x123 = M1 * x122
    x124 = x29 * x65
    x125 = M2 * x124
    x126 = x21 * x29
    x127 = M3 * x126
    x128 = M2 * x22
    x129 = x48 * x95
    x130 = x129 * x19
    x131 = M1 * x79
    x132 = b_parallel * x42
    x133 = -x132 + 1.0 / b_spin
    x134 = x101 * x133
    x135 = x126 * x134
    x136 = x48 * x99
    x137 = x136 * x19
    x138 = x100 * x48
    x139 = x138 * x19
    x140 = -omega1 * x130 - omega2 * x137 - omega3 * x139 - x89
    x141 = x133 * x96
    x142 = x111 * x122
    x143 = x29 * x53
    x144 = x109 * x143
    x145 = v1 * x49
    x146 = v2 * x49
    x147 = v3 * x19
    x148 = x108 * x19
    x149 = x106 * x21
    x150 = x107 * x53
    x151 = -x148 - x149 + x150
    x152 = -x138 * x147 - x145 * x77 - x146 * x32 - x151
    x153 = x107 * x19
    x154 = x108 * x53
    x155 = x106 * x65
    x156 = -x153 - x154 + x155
    x157 = -x136 * x147 - x145 * x75 - x146 * x36 - x156
    x158 = x129 * x53
    x159 = x124 * x134
    x160 = x136 * x53
    x161 = x138 * x53
    x162 = -omega1 * x158 - omega2 * x160 - omega3 * x161 - x55
    x163 = x109 * x122
    x164 = x111 * x143
    x165 = v1 * x61
    x166 = v2 * x61
    x167 = v3 * x53
    x168 = -x138 * x167 - x153 - x154 + x155 - x165 * x77 - x166 * x32
    x169 = -x136 * x167 - x151 - x165 * x75 - x166 * x36
    x170 = M1 * x126
    x171 = M2 * x143
    x172 = M3 * x122
    x173 = x129 * x21
    x174 = x122 * x134
    x175 = x136 * x21
    x176 = x138 * x21
    x177 = -omega1 * x173 - omega2 * x175 - omega3 * x176 - x69 - x70 + x71
    x178 = x111 * x126
    x179 = x109 * x124
    x180 = v1 * x62
    x181 = v2 * x62
    x182 = v3 * x21
    x183 = x106 * x19
    x184 = x107 * x65
    x185 = x108 * x21
    x186 = -x183 - x184 + x185
    x187 = -x138 * x182 - x180 * x77 - x181 * x32 - x186
    x188 = x106 * x53 + x107 * x21 + x108 * x65
    x189 = -x136 * x182 - x180 * x75 - x181 * x36 + x188
    x190 = x109 * x126
    x191 = -x111 * x124
    x192 = x136 * x65
    x193 = x138 * x65
    x194 = v1 * x68
    x195 = v2 * x68
    x196 = v3 * x65
    x197 = -x138 * x196 + x188 - x194 * x77 - x195 * x32
    x198 = -x136 * x196 - x183 - x184 + x185 - x194 * x75 - x195 * x36
    x199 = x129 * x65
    x200 = -omega1 * x199 - omega2 * x192 - omega3 * x193 + x67
    x201 = M2 * x122
    x202 = M3 * x143
    x203 = M1 * x124
    x204 = x134 * x143
    x205 = -x201 - x202 + x203 + x204
    x206 = x56 * x92
    x207 = x133 * x48
    x208 = I3 * omega3
    x209 = a2 * x133 * x95
    x210 = x136 * x209
    x211 = I2 * omega2
    x212 = x138 * x209
    x213 = 1.0 / I2
    x214 = a2 * x213
    x215 = x214 * x29
    x216 = x215 * x75
    x217 = x110 * x214
    x218 = x215 * x36
    x219 = x102 * x217
    x220 = x106 * x79 + x107 * x22 + x108 * x95
    x221 = x100 * x220 * x29 - x109 * x96
    x222 = x18 * x221
    x223 = b_roll * x222
    x224 = x214 * (-b_parallel * x223 + omega2 * x104 * x18 - x105 * x110)
    x225 = x214 * (b_parallel * b_turn * omega2 * x18 - b_turn * x223 - omega2 * x42 - x110 * x117)
    x226 = x214 * (-omega2 * x119 + x110 * x120 + x221 * x42 + x222 * x46)
    x227 = x122 * x220
    x228 = -x129 * x147 - x145 * x79 - x146 * x22 - x186
    x229 = x110 * x133
    x230 = M1 * x75
    x231 = M2 * x36
    x232 = x143 * x220
    x233 = (
        2.0 * e1 * v1 * x29
        + 2.0 * e2 * v2 * x29
        + 2.0 * e3 * v3 * x29
        - x129 * x167
        - x165 * x79
        - x166 * x22
    )
    x234 = -x170 + x171 - x172 + x174
    x235 = -x126 * x220
    x236 = -x129 * x182 - x148 - x149 + x150 - x180 * x79 - x181 * x22
    x237 = M1 * x143 + M2 * x126 + M3 * x124 - x159
    x238 = x124 * x220
    x239 = -x129 * x196 - x156 - x194 * x79 - x195 * x22
    x240 = x123 + x125 - x127 + x135
    x241 = x214 * x56
    x242 = I1 * omega1
    x243 = a2 * x100 * x133 * x136
    x244 = 1.0 / I3
    x245 = a2 * x244
    x246 = x245 * x29
    x247 = x246 * x77
    x248 = x246 * x32
    x249 = x112 * x245
    x250 = x102 * x249
    x251 = -x110 * x220 + x111 * x29 * x95
    x252 = x18 * x251
    x253 = b_roll * x252
    x254 = x245 * (-b_parallel * x253 + omega3 * x104 * x18 - x105 * x112)
    x255 = x245 * (b_parallel * b_turn * omega3 * x18 - b_turn * x253 - omega3 * x42 - x112 * x117)
    x256 = x245 * (-omega3 * x119 + x112 * x120 + x251 * x42 + x252 * x46)
    x257 = x112 * x133
    x258 = M1 * x77
    x259 = M2 * x32
    x260 = x245 * x56
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
    out[3, 0] = 0.0
    out[3, 1] = 0.0
    out[3, 2] = 0.0
    out[3, 3] = 0.0
    out[3, 4] = x1
    out[3, 5] = x3
    out[3, 6] = x5
    out[3, 7] = 0.0
    out[3, 8] = 0.0
    out[3, 9] = 0.0
    out[3, 10] = x7
    out[3, 11] = x9
    out[3, 12] = x11
    out[4, 0] = 0.0
    out[4, 1] = 0.0
    out[4, 2] = 0.0
    out[4, 3] = x0
    out[4, 4] = 0.0
    out[4, 5] = x4
    out[4, 6] = x3
    out[4, 7] = 0.0
    out[4, 8] = 0.0
    out[4, 9] = 0.0
    out[4, 10] = x12
    out[4, 11] = x11
    out[4, 12] = x8
    out[5, 0] = 0.0
    out[5, 1] = 0.0
    out[5, 2] = 0.0
    out[5, 3] = x2
    out[5, 4] = x5
    out[5, 5] = 0.0
    out[5, 6] = x0
    out[5, 7] = 0.0
    out[5, 8] = 0.0
    out[5, 9] = 0.0
    out[5, 10] = x10
    out[5, 11] = x12
    out[5, 12] = x7
    out[6, 0] = 0.0
    out[6, 1] = 0.0
    out[6, 2] = 0.0
    out[6, 3] = x4
    out[6, 4] = x2
    out[6, 5] = x1
    out[6, 6] = 0.0
    out[6, 7] = 0.0
    out[6, 8] = 0.0
    out[6, 9] = 0.0
    out[6, 10] = x9
    out[6, 11] = x6
    out[6, 12] = x12
    out[7, 0] = DF11 * x13 + Db11 * x41 + Db31 * x43 + Db51 * x47
    out[7, 1] = DF12 * x13 + Db12 * x41 + Db32 * x43 + Db52 * x47
    out[7, 2] = DF13 * x13 + Db13 * x41 + Db33 * x43 + Db53 * x47
    out[7, 3] = x57 * (-x49 * x50 - x49 * x51 - x49 * x52 - x55)
    out[7, 4] = x57 * (-x50 * x61 - x51 * x61 - x52 * x61 - x58 - x59 + x60)
    out[7, 5] = x57 * (-x50 * x62 - x51 * x62 - x52 * x62 + x67)
    out[7, 6] = x57 * (-x50 * x68 - x51 * x68 - x52 * x68 - x72)
    out[7, 7] = x73
    out[7, 8] = 0.0
    out[7, 9] = 0.0
    out[7, 10] = x22 * x74
    out[7, 11] = x36 * x74
    out[7, 12] = x32 * x74
    out[8, 0] = DF21 * x13 + Db11 * x83 + Db31 * x84 + Db51 * x85
    out[8, 1] = DF22 * x13 + Db12 * x83 + Db32 * x84 + Db52 * x85
    out[8, 2] = DF23 * x13 + Db13 * x83 + Db33 * x84 + Db53 * x85
    out[8, 3] = x57 * (x49 * x86 + x49 * x87 + x49 * x88 + x72)
    out[8, 4] = x57 * (x61 * x86 + x61 * x87 + x61 * x88 - x63 - x64 - x66)
    out[8, 5] = x57 * (x62 * x86 + x62 * x87 + x62 * x88 + x89)
    out[8, 6] = x57 * (x19 * x37 + x30 * x65 - x54 + x68 * x86 + x68 * x87 + x68 * x88)
    out[8, 7] = 0.0
    out[8, 8] = x73
    out[8, 9] = 0.0
    out[8, 10] = -x74 * x79
    out[8, 11] = -x74 * x75
    out[8, 12] = -x74 * x77
    out[9, 0] = DF31 * x13 + Db21 * x90
    out[9, 1] = DF32 * x13 + Db22 * x90
    out[9, 2] = DF33 * x13 + Db23 * x90
    out[9, 3] = 0.0
    out[9, 4] = 0.0
    out[9, 5] = 0.0
    out[9, 6] = 0.0
    out[9, 7] = 0.0
    out[9, 8] = 0.0
    out[9, 9] = -x13 / b_perpendicular
    out[9, 10] = 0.0
    out[9, 11] = 0.0
    out[9, 12] = 0.0
    out[10, 0] = (
        DM11 * x98 + DM21 * x94 + DM31 * x97 + Db11 * x118 + Db31 * x116 + Db41 * x103 + Db51 * x121
    )
    out[10, 1] = (
        DM12 * x98 + DM22 * x94 + DM32 * x97 + Db12 * x118 + Db32 * x116 + Db42 * x103 + Db52 * x121
    )
    out[10, 2] = (
        DM13 * x98 + DM23 * x94 + DM33 * x97 + Db13 * x118 + Db33 * x116 + Db43 * x103 + Db53 * x121
    )
    out[10, 3] = x92 * (
        -M3 * x130
        + b_roll
        * x42
        * (
            2.0 * e0 * x100 * x111 * x48
            - x109 * x137
            - x112 * x157
            - x142
            + x144
            + x152 * x29 * x99
        )
        + 2.0 * e0 * x101 * x133 * x48 * x95
        + x123
        + x125
        - x127
        - x128 * x49
        - x131 * x49
        + x135
        - x140 * x141
    )
    out[10, 4] = x92 * (
        2.0 * M1 * e1 * x29
        + 2.0 * M2 * e2 * x29
        + 2.0 * M3 * e3 * x29
        - M3 * x158
        + b_roll * x42 * (-x109 * x160 + x110 * x168 + x111 * x161 - x112 * x169 + x163 + x164)
        + 2.0 * e1 * x101 * x133 * x48 * x95
        - x128 * x61
        - x131 * x61
        - x141 * x162
        - x159
    )
    out[10, 5] = x92 * (
        -M3 * x173
        + b_roll * x42 * (-x109 * x175 + x110 * x187 + x111 * x176 - x112 * x189 + x178 + x179)
        + 2.0 * e2 * x101 * x133 * x48 * x95
        - x128 * x62
        - x131 * x62
        - x141 * x177
        - x170
        + x171
        - x172
        + x174
    )
    out[10, 6] = x92 * (
        -M3 * x199
        + b_roll * x42 * (-x109 * x192 + x110 * x197 + x111 * x193 - x112 * x198 + x190 + x191)
        + 2.0 * e3 * x101 * x133 * x48 * x95
        - x128 * x68
        - x131 * x68
        - x141 * x200
        - x205
    )
    out[10, 7] = x206 * (x136 * x77 - x138 * x75)
    out[10, 8] = x206 * (x136 * x32 - x138 * x36)
    out[10, 9] = 0.0
    out[10, 10] = x92 * (-x132 - x207 * (x95 * x95))
    out[10, 11] = x91 * (I2 * omega3 - x208 - x210)
    out[10, 12] = x91 * (-I3 * omega2 + x211 - x212)
    out[11, 0] = (
        DM11 * x216
        + DM21 * x218
        + DM31 * x217
        + Db11 * x225
        + Db31 * x224
        + Db41 * x219
        + Db51 * x226
    )
    out[11, 1] = (
        DM12 * x216
        + DM22 * x218
        + DM32 * x217
        + Db12 * x225
        + Db32 * x224
        + Db42 * x219
        + Db52 * x226
    )
    out[11, 2] = (
        DM13 * x216
        + DM23 * x218
        + DM33 * x217
        + Db13 * x225
        + Db33 * x224
        + Db43 * x219
        + Db53 * x226
    )
    out[11, 3] = x214 * (
        -M3 * x137
        + b_roll * x42 * (x109 * x130 + x112 * x228 - x139 * x220 - x152 * x96 + x190 + x227)
        + 2.0 * e0 * x101 * x133 * x48 * x99
        - x140 * x229
        - x205
        - x230 * x49
        - x231 * x49
    )
    out[11, 4] = x214 * (
        -M3 * x160
        + b_roll
        * x42
        * (2.0 * e1 * x109 * x48 * x95 + x100 * x233 * x29 - x161 * x220 - x168 * x96 - x179 - x232)
        + 2.0 * e1 * x101 * x133 * x48 * x99
        - x162 * x229
        - x230 * x61
        - x231 * x61
        - x234
    )
    out[11, 5] = x214 * (
        -M3 * x175
        + x134 * x175
        - x177 * x229
        - x230 * x62
        - x231 * x62
        + x237
        + x56 * (x109 * x173 + x112 * x236 + x163 - x176 * x220 - x187 * x96 + x235)
    )
    out[11, 6] = x214 * (
        -M3 * x192
        + b_roll
        * x42
        * (2.0 * e3 * x109 * x48 * x95 + x100 * x239 * x29 - x144 - x193 * x220 - x197 * x96 + x238)
        + 2.0 * e3 * x101 * x133 * x48 * x99
        - x200 * x229
        - x230 * x68
        - x231 * x68
        - x240
    )
    out[11, 7] = x241 * (x100 * x48 * x79 - x129 * x77)
    out[11, 8] = x241 * (x100 * x22 * x48 - x129 * x32)
    out[11, 9] = 0.0
    out[11, 10] = x213 * (-I1 * omega3 + x208 - x210)
    out[11, 11] = x214 * (-x132 - x207 * (x99 * x99))
    out[11, 12] = x213 * (I3 * omega1 - x242 - x243)
    out[12, 0] = (
        DM11 * x247
        + DM21 * x248
        + DM31 * x249
        + Db11 * x255
        + Db31 * x254
        + Db41 * x250
        + Db51 * x256
    )
    out[12, 1] = (
        DM12 * x247
        + DM22 * x248
        + DM32 * x249
        + Db12 * x255
        + Db32 * x254
        + Db42 * x250
        + Db52 * x256
    )
    out[12, 2] = (
        DM13 * x247
        + DM23 * x248
        + DM33 * x249
        + Db13 * x255
        + Db33 * x254
        + Db43 * x250
        + Db53 * x256
    )
    out[12, 3] = x245 * (
        -M3 * x139
        + b_roll
        * x42
        * (2.0 * e0 * x220 * x48 * x99 - x110 * x228 - x111 * x130 + x157 * x29 * x95 - x178 - x232)
        + 2.0 * e0 * x100 * x101 * x133 * x48
        - x140 * x257
        - x234
        - x258 * x49
        - x259 * x49
    )
    out[12, 4] = x245 * (
        -M3 * x161
        + b_roll
        * x42
        * (2.0 * e1 * x220 * x48 * x99 - x110 * x233 - x111 * x158 + x169 * x29 * x95 - x191 - x227)
        + 2.0 * e1 * x100 * x101 * x133 * x48
        - x162 * x257
        - x201
        - x202
        + x203
        + x204
        - x258 * x61
        - x259 * x61
    )
    out[12, 5] = x245 * (
        -M3 * x176
        + x134 * x176
        - x177 * x257
        + x240
        - x258 * x62
        - x259 * x62
        + x56
        * (2.0 * e2 * x220 * x48 * x99 - x110 * x236 - x111 * x173 - x142 + x189 * x29 * x95 - x238)
    )
    out[12, 6] = x245 * (
        -M3 * x193
        + x134 * x193
        - x200 * x257
        + x237
        - x258 * x68
        - x259 * x68
        + x56 * (-x110 * x239 - x111 * x199 + x164 + x192 * x220 + x198 * x96 + x235)
    )
    out[12, 7] = x260 * (-x136 * x79 + x48 * x75 * x95)
    out[12, 8] = x260 * (-x136 * x22 + x36 * x48 * x95)
    out[12, 9] = 0.0
    out[12, 10] = x244 * (I1 * omega2 - x211 - x212)
    out[12, 11] = x244 * (-I2 * omega1 + x242 - x243)
    out[12, 12] = x245 * (-(x100 * x100) * x207 - x132)


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
