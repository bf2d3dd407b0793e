"""Full model (A.25): translation and rotation of a sphere.

Made by `python -m derivation` from derivation/rigid_body.py and derivation/drag.py; do not edit.
SymPy 1.14.0. 1373 operations, 299 temporaries.

A sphere: K (A.17) vanishes. State (e, omega), which no constraint can leave.

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
* [1] `I` [kg m^2] moment of inertia of the sphere, I_PP, (2.6)
* [2] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [3] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [4] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3", "v1", "v2", "v3", "omega1", "omega2", "omega3")
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
LINEAR_DRAG = True


@njit(cache=True)
def rhs(t, state, force, moment, mobility, params, out):
    """Rate of change of the state.

    t: time since release [s]
    state: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    params: (5) m, I, W1, W2, W3
    out: (13) filled with the result.
    183 operations, 49 temporaries.
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
    I = params[1]
    W1 = params[2]
    W2 = params[3]
    W3 = params[4]
    x0 = (1.0 / 2.0) * omega1
    x1 = (1.0 / 2.0) * e2
    x2 = (1.0 / 2.0) * e3
    x3 = (1.0 / 2.0) * e0
    x4 = (1.0 / 2.0) * e1
    x5 = 1.0 / m
    x6 = 1.0 / (b_parallel * b_turn - (b_roll * b_roll))
    x7 = b_turn * x6
    x8 = 2.0 * e0
    x9 = e3 * x8
    x10 = 2.0 * e2
    x11 = e1 * x10 + x9
    x12 = e1 * e1
    x13 = e3 * e3
    x14 = e0 * e0
    x15 = e2 * e2
    x16 = x14 + x15
    x17 = 1.0 / (x12 + x13 + x16)
    x18 = omega1 * x17
    x19 = e1 * x8
    x20 = 2.0 * e2 * e3 - x19
    x21 = omega3 * x17
    x22 = -x12
    x23 = -x13
    x24 = x16 + x22 + x23
    x25 = omega2 * x17
    x26 = b_roll * x6
    x27 = 2.0 * e1 * e2 - x9
    x28 = e2 * x8
    x29 = 2.0 * e1 * e3 + x28
    x30 = x14 - x15
    x31 = x12 + x23 + x30
    x32 = 1.0 / I
    x33 = b_parallel * x6
    x34 = M2 * x17
    x35 = 2.0 * e1 * e3 - x28
    x36 = M3 * x17
    x37 = M1 * x17
    x38 = e3 * x10 + x19
    x39 = x13 + x22 + x30
    x40 = (-x33 + 1.0 / b_spin) * (x18 * x35 + x21 * x39 + x25 * x38)
    x41 = v1 * x17
    x42 = v2 * x17
    x43 = v3 * x17
    x44 = x17 * (x20 * x42 + x29 * x41 + x39 * x43)
    x45 = x24 * x42 + x27 * x41 + x38 * x43
    x46 = x17 * x39
    x47 = x17 * x38
    x48 = x11 * x42 + x31 * x41 + x35 * x43
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = -e1 * x0 - omega2 * x1 - omega3 * x2
    out[4] = e0 * x0 - omega2 * x2 + omega3 * x1
    out[5] = e3 * x0 + omega2 * x3 - omega3 * x4
    out[6] = -e2 * x0 + omega2 * x4 + omega3 * x3
    out[7] = x5 * (F1 + W1 - v1 * x7 + x26 * (x11 * x18 + x20 * x21 + x24 * x25))
    out[8] = x5 * (F2 + W2 - v2 * x7 + x26 * (-x18 * x31 - x21 * x29 - x25 * x27))
    out[9] = x5 * (F3 + W3 - v3 / b_perpendicular)
    out[10] = x32 * (
        -omega1 * x33
        + x11 * x34
        - x17 * x35 * x40
        + x26 * (x38 * x44 - x45 * x46)
        + x31 * x37
        + x35 * x36
    )
    out[11] = x32 * (
        -omega2 * x33
        + x24 * x34
        + x26 * (x17 * x39 * x48 - x35 * x44)
        + x27 * x37
        + x36 * x38
        - x40 * x47
    )
    out[12] = x32 * (
        -omega3 * x33
        + x20 * x34
        + x26 * (x17 * x35 * x45 - x47 * x48)
        + x29 * x37
        + x36 * x39
        - x40 * x46
    )


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
    params: (5) m, I, W1, W2, W3
    out: (13, 13) filled with the result.
    1190 operations, 250 temporaries.
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
    I = params[1]
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
    x13 = 1.0 / m
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
    x56 = x13 * x42
    x57 = b_roll * x56
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
    x73 = -b_turn * x56
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
    x91 = 1.0 / I
    x92 = x29 * x91
    x93 = x22 * x92
    x94 = 2.0 * e1 * e3 - x76
    x95 = x29 * x94
    x96 = x91 * x95
    x97 = x79 * x92
    x98 = e3 * x21 + x31
    x99 = x24 + x34 + x78
    x100 = x30 * x94 + x33 * x99 + x37 * x98
    x101 = x100 / (b_spin * b_spin)
    x102 = x101 * x96
    x103 = b_parallel * b_parallel
    x104 = x100 * x103 * x18
    x105 = v1 * x29
    x106 = v2 * x29
    x107 = v3 * x29
    x108 = x105 * x77 + x106 * x32 + x107 * x99
    x109 = x29 * x98
    x110 = x105 * x75 + x106 * x36 + x107 * x98
    x111 = x29 * x99
    x112 = x108 * x109 - x110 * x111
    x113 = x112 * x18
    x114 = b_roll * x113
    x115 = x91 * (-b_parallel * x114 + omega1 * x103 * x18 - x104 * x95)
    x116 = x100 * (x15 * x18 - x42)
    x117 = x91 * (b_parallel * b_turn * omega1 * x18 - b_turn * x114 - omega1 * x42 - x116 * x95)
    x118 = b_parallel * x44
    x119 = x100 * x118
    x120 = x91 * (-omega1 * x118 + x112 * x42 + x113 * x46 + x119 * x95)
    x121 = x19 * x29
    x122 = M1 * x121
    x123 = x29 * x65
    x124 = M2 * x123
    x125 = x21 * x29
    x126 = M3 * x125
    x127 = M2 * x22
    x128 = x48 * x94
    x129 = x128 * x19
    x130 = M1 * x79
    x131 = b_parallel * x42
    x132 = -x131 + 1.0 / b_spin
    x133 = x100 * x132
    x134 = x125 * x133
    x135 = x48 * x98
    x136 = x135 * x19
    x137 = x48 * x99
    x138 = x137 * x19
    x139 = -omega1 * x129 - omega2 * x136 - omega3 * x138 - x89
    x140 = x132 * x95
    x141 = x110 * x121
    x142 = x29 * x53
    x143 = x108 * x142
    x144 = v1 * x49
    x145 = v2 * x49
    x146 = v3 * x19
    x147 = x107 * x19
    x148 = x105 * x21
    x149 = x106 * x53
    x150 = -x147 - x148 + x149
    x151 = -x137 * x146 - x144 * x77 - x145 * x32 - x150
    x152 = x106 * x19
    x153 = x107 * x53
    x154 = x105 * x65
    x155 = -x152 - x153 + x154
    x156 = -x135 * x146 - x144 * x75 - x145 * x36 - x155
    x157 = x128 * x53
    x158 = x123 * x133
    x159 = x135 * x53
    x160 = x137 * x53
    x161 = -omega1 * x157 - omega2 * x159 - omega3 * x160 - x55
    x162 = x108 * x121
    x163 = x110 * x142
    x164 = v1 * x61
    x165 = v2 * x61
    x166 = v3 * x53
    x167 = -x137 * x166 - x152 - x153 + x154 - x164 * x77 - x165 * x32
    x168 = -x135 * x166 - x150 - x164 * x75 - x165 * x36
    x169 = M1 * x125
    x170 = M2 * x142
    x171 = M3 * x121
    x172 = x128 * x21
    x173 = x121 * x133
    x174 = x135 * x21
    x175 = x137 * x21
    x176 = -omega1 * x172 - omega2 * x174 - omega3 * x175 - x69 - x70 + x71
    x177 = x110 * x125
    x178 = x108 * x123
    x179 = v1 * x62
    x180 = v2 * x62
    x181 = v3 * x21
    x182 = x105 * x19
    x183 = x106 * x65
    x184 = x107 * x21
    x185 = -x182 - x183 + x184
    x186 = -x137 * x181 - x179 * x77 - x180 * x32 - x185
    x187 = x105 * x53 + x106 * x21 + x107 * x65
    x188 = -x135 * x181 - x179 * x75 - x180 * x36 + x187
    x189 = x108 * x125
    x190 = -x110 * x123
    x191 = x135 * x65
    x192 = x137 * x65
    x193 = v1 * x68
    x194 = v2 * x68
    x195 = v3 * x65
    x196 = -x137 * x195 + x187 - x193 * x77 - x194 * x32
    x197 = -x135 * x195 - x182 - x183 + x184 - x193 * x75 - x194 * x36
    x198 = x128 * x65
    x199 = -omega1 * x198 - omega2 * x191 - omega3 * x192 + x67
    x200 = M2 * x121
    x201 = M3 * x142
    x202 = M1 * x123
    x203 = x133 * x142
    x204 = -x200 - x201 + x202 + x203
    x205 = b_roll * x42
    x206 = x205 * x91
    x207 = x132 * x48
    x208 = x132 * x91 * x94
    x209 = -x135 * x208
    x210 = -x137 * x208
    x211 = x75 * x92
    x212 = x109 * x91
    x213 = x36 * x92
    x214 = x101 * x212
    x215 = x105 * x79 + x106 * x22 + x107 * x94
    x216 = -x108 * x95 + x215 * x29 * x99
    x217 = x18 * x216
    x218 = b_roll * x217
    x219 = x91 * (-b_parallel * x218 + omega2 * x103 * x18 - x104 * x109)
    x220 = x91 * (b_parallel * b_turn * omega2 * x18 - b_turn * x218 - omega2 * x42 - x109 * x116)
    x221 = x91 * (-omega2 * x118 + x109 * x119 + x216 * x42 + x217 * x46)
    x222 = x121 * x215
    x223 = -x128 * x146 - x144 * x79 - x145 * x22 - x185
    x224 = x109 * x132
    x225 = M1 * x75
    x226 = M2 * x36
    x227 = x142 * x215
    x228 = (
        2.0 * e1 * v1 * x29
        + 2.0 * e2 * v2 * x29
        + 2.0 * e3 * v3 * x29
        - x128 * x166
        - x164 * x79
        - x165 * x22
    )
    x229 = -x169 + x170 - x171 + x173
    x230 = -x125 * x215
    x231 = -x128 * x181 - x147 - x148 + x149 - x179 * x79 - x180 * x22
    x232 = M1 * x142 + M2 * x125 + M3 * x123 - x158
    x233 = x123 * x215
    x234 = -x128 * x195 - x155 - x193 * x79 - x194 * x22
    x235 = x122 + x124 - x126 + x134
    x236 = -x132 * x135 * x91 * x99
    x237 = x77 * x92
    x238 = x32 * x92
    x239 = x111 * x91
    x240 = x101 * x239
    x241 = -x109 * x215 + x110 * x29 * x94
    x242 = x18 * x241
    x243 = b_roll * x242
    x244 = x91 * (-b_parallel * x243 + omega3 * x103 * x18 - x104 * x111)
    x245 = x91 * (b_parallel * b_turn * omega3 * x18 - b_turn * x243 - omega3 * x42 - x111 * x116)
    x246 = x91 * (-omega3 * x118 + x111 * x119 + x241 * x42 + x242 * x46)
    x247 = x111 * x132
    x248 = M1 * x77
    x249 = M2 * x32
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
        DM11 * x97 + DM21 * x93 + DM31 * x96 + Db11 * x117 + Db31 * x115 + Db41 * x102 + Db51 * x120
    )
    out[10, 1] = (
        DM12 * x97 + DM22 * x93 + DM32 * x96 + Db12 * x117 + Db32 * x115 + Db42 * x102 + Db52 * x120
    )
    out[10, 2] = (
        DM13 * x97 + DM23 * x93 + DM33 * x96 + Db13 * x117 + Db33 * x115 + Db43 * x102 + Db53 * x120
    )
    out[10, 3] = x91 * (
        -M3 * x129
        + b_roll
        * x42
        * (2.0 * e0 * x110 * x48 * x99 - x108 * x136 - x111 * x156 - x141 + x143 + x151 * x29 * x98)
        + 2.0 * e0 * x100 * x132 * x48 * x94
        + x122
        + x124
        - x126
        - x127 * x49
        - x130 * x49
        + x134
        - x139 * x140
    )
    out[10, 4] = x91 * (
        2.0 * M1 * e1 * x29
        + 2.0 * M2 * e2 * x29
        + 2.0 * M3 * e3 * x29
        - M3 * x157
        + b_roll * x42 * (-x108 * x159 + x109 * x167 + x110 * x160 - x111 * x168 + x162 + x163)
        + 2.0 * e1 * x100 * x132 * x48 * x94
        - x127 * x61
        - x130 * x61
        - x140 * x161
        - x158
    )
    out[10, 5] = x91 * (
        -M3 * x172
        + b_roll * x42 * (-x108 * x174 + x109 * x186 + x110 * x175 - x111 * x188 + x177 + x178)
        + 2.0 * e2 * x100 * x132 * x48 * x94
        - x127 * x62
        - x130 * x62
        - x140 * x176
        - x169
        + x170
        - x171
        + x173
    )
    out[10, 6] = x91 * (
        -M3 * x198
        + b_roll * x42 * (-x108 * x191 + x109 * x196 + x110 * x192 - x111 * x197 + x189 + x190)
        + 2.0 * e3 * x100 * x132 * x48 * x94
        - x127 * x68
        - x130 * x68
        - x140 * x199
        - x204
    )
    out[10, 7] = x206 * (x135 * x77 - x137 * x75)
    out[10, 8] = x206 * (x135 * x32 - x137 * x36)
    out[10, 9] = 0.0
    out[10, 10] = x91 * (-x131 - x207 * (x94 * x94))
    out[10, 11] = x209
    out[10, 12] = x210
    out[11, 0] = (
        DM11 * x211
        + DM21 * x213
        + DM31 * x212
        + Db11 * x220
        + Db31 * x219
        + Db41 * x214
        + Db51 * x221
    )
    out[11, 1] = (
        DM12 * x211
        + DM22 * x213
        + DM32 * x212
        + Db12 * x220
        + Db32 * x219
        + Db42 * x214
        + Db52 * x221
    )
    out[11, 2] = (
        DM13 * x211
        + DM23 * x213
        + DM33 * x212
        + Db13 * x220
        + Db33 * x219
        + Db43 * x214
        + Db53 * x221
    )
    out[11, 3] = x91 * (
        -M3 * x136
        + b_roll * x42 * (x108 * x129 + x111 * x223 - x138 * x215 - x151 * x95 + x189 + x222)
        + 2.0 * e0 * x100 * x132 * x48 * x98
        - x139 * x224
        - x204
        - x225 * x49
        - x226 * x49
    )
    out[11, 4] = x91 * (
        -M3 * x159
        + b_roll
        * x42
        * (2.0 * e1 * x108 * x48 * x94 - x160 * x215 - x167 * x95 - x178 - x227 + x228 * x29 * x99)
        + 2.0 * e1 * x100 * x132 * x48 * x98
        - x161 * x224
        - x225 * x61
        - x226 * x61
        - x229
    )
    out[11, 5] = x91 * (
        -M3 * x174
        + x133 * x174
        - x176 * x224
        + x205 * (x108 * x172 + x111 * x231 + x162 - x175 * x215 - x186 * x95 + x230)
        - x225 * x62
        - x226 * x62
        + x232
    )
    out[11, 6] = x91 * (
        -M3 * x191
        + b_roll
        * x42
        * (2.0 * e3 * x108 * x48 * x94 - x143 - x192 * x215 - x196 * x95 + x233 + x234 * x29 * x99)
        + 2.0 * e3 * x100 * x132 * x48 * x98
        - x199 * x224
        - x225 * x68
        - x226 * x68
        - x235
    )
    out[11, 7] = x206 * (-x128 * x77 + x48 * x79 * x99)
    out[11, 8] = x206 * (-x128 * x32 + x22 * x48 * x99)
    out[11, 9] = 0.0
    out[11, 10] = x209
    out[11, 11] = x91 * (-x131 - x207 * (x98 * x98))
    out[11, 12] = x236
    out[12, 0] = (
        DM11 * x237
        + DM21 * x238
        + DM31 * x239
        + Db11 * x245
        + Db31 * x244
        + Db41 * x240
        + Db51 * x246
    )
    out[12, 1] = (
        DM12 * x237
        + DM22 * x238
        + DM32 * x239
        + Db12 * x245
        + Db32 * x244
        + Db42 * x240
        + Db52 * x246
    )
    out[12, 2] = (
        DM13 * x237
        + DM23 * x238
        + DM33 * x239
        + Db13 * x245
        + Db33 * x244
        + Db43 * x240
        + Db53 * x246
    )
    out[12, 3] = x91 * (
        -M3 * x138
        + b_roll
        * x42
        * (2.0 * e0 * x215 * x48 * x98 - x109 * x223 - x110 * x129 + x156 * x29 * x94 - x177 - x227)
        + 2.0 * e0 * x100 * x132 * x48 * x99
        - x139 * x247
        - x229
        - x248 * x49
        - x249 * x49
    )
    out[12, 4] = x91 * (
        -M3 * x160
        + b_roll
        * x42
        * (2.0 * e1 * x215 * x48 * x98 - x109 * x228 - x110 * x157 + x168 * x29 * x94 - x190 - x222)
        + 2.0 * e1 * x100 * x132 * x48 * x99
        - x161 * x247
        - x200
        - x201
        + x202
        + x203
        - x248 * x61
        - x249 * x61
    )
    out[12, 5] = x91 * (
        -M3 * x175
        + x133 * x175
        - x176 * x247
        + x205
        * (2.0 * e2 * x215 * x48 * x98 - x109 * x231 - x110 * x172 - x141 + x188 * x29 * x94 - x233)
        + x235
        - x248 * x62
        - x249 * x62
    )
    out[12, 6] = x91 * (
        -M3 * x192
        + x133 * x192
        - x199 * x247
        + x205 * (-x109 * x234 - x110 * x198 + x163 + x191 * x215 + x197 * x95 + x230)
        + x232
        - x248 * x68
        - x249 * x68
    )
    out[12, 7] = x206 * (-x135 * x79 + x48 * x75 * x94)
    out[12, 8] = x206 * (-x135 * x22 + x36 * x48 * x94)
    out[12, 9] = 0.0
    out[12, 10] = x210
    out[12, 11] = x236
    out[12, 12] = x91 * (-x131 - x207 * (x99 * x99))


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
