"""Overdamped model (5.2): translation and rotation.

Made by `python -m derivation` from derivation/drag.py; do not edit.
SymPy 1.14.0. 1454 operations, 301 temporaries.

Without inertia: the same for a sphere and for any other body of this drag.

State:

* [0] `q1` [m] position of the bead's centre along N1, (2.1)
* [1] `q2` [m] position of the bead's centre along N2, (2.1)
* [2] `q3` [m] position of the bead's centre along N3, (2.1)
* [3] `e0` [1] Euler parameter e0, (2.1)
* [4] `e1` [1] Euler parameter e1, (2.1)
* [5] `e2` [1] Euler parameter e2, (2.1)
* [6] `e3` [1] Euler parameter e3, (2.1)

Parameters:

* [0] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [1] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [2] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3")
PARAMS = ("W1", "W2", "W3")
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
    state: (7) q1, q2, q3, e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    params: (3) W1, W2, W3
    out: (7) filled with the result.
    147 operations, 48 temporaries.
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
    b_parallel = mobility[0]
    b_perpendicular = mobility[1]
    b_turn = mobility[2]
    b_spin = mobility[3]
    b_roll = mobility[4]
    W1 = params[0]
    W2 = params[1]
    W3 = params[2]
    x0 = F1 + W1
    x1 = F2 + W2
    x2 = F3 + W3
    x3 = 2.0 * e0
    x4 = e3 * x3
    x5 = 2.0 * e1 * e2 + x4
    x6 = e1 * e1
    x7 = e2 * e2
    x8 = e0 * e0
    x9 = e3 * e3
    x10 = x8 + x9
    x11 = 1.0 / (x10 + x6 + x7)
    x12 = M2 * x11
    x13 = e2 * x3
    x14 = 2.0 * e1 * e3 - x13
    x15 = x11 * x14
    x16 = -x7
    x17 = x8 - x9
    x18 = x16 + x17 + x6
    x19 = M1 * x11
    x20 = M3 * x15 + x12 * x5 + x18 * x19
    x21 = 2.0 * e3
    x22 = e1 * x21 + x13
    x23 = x0 * x11
    x24 = e1 * x3
    x25 = 2.0 * e2 * e3 - x24
    x26 = x1 * x11
    x27 = -x6
    x28 = x10 + x16 + x27
    x29 = x11 * x2
    x30 = x22 * x23 + x25 * x26 + x28 * x29
    x31 = e2 * x21 + x24
    x32 = x11 * x31
    x33 = 2.0 * e1 * e2 - x4
    x34 = x17 + x27 + x7
    x35 = x23 * x33 + x26 * x34 + x29 * x31
    x36 = x11 * x28
    x37 = M3 * x32 + x12 * x34 + x19 * x33
    x38 = M3 * x36 + x12 * x25 + x19 * x22
    x39 = (b_spin - b_turn) * (x15 * x20 + x32 * x37 + x36 * x38)
    x40 = (
        (1.0 / 2.0) * b_roll * (x30 * x32 - x35 * x36)
        + (1.0 / 2.0) * b_turn * x20
        + (1.0 / 2.0) * x15 * x39
    )
    x41 = x14 * x29 + x18 * x23 + x26 * x5
    x42 = b_roll * (x11 * x28 * x41 - x15 * x30) + b_turn * x37 + x32 * x39
    x43 = (1.0 / 2.0) * e2
    x44 = b_roll * (x11 * x14 * x35 - x32 * x41) + b_turn * x38 + x36 * x39
    x45 = (1.0 / 2.0) * e3
    x46 = (1.0 / 2.0) * e0
    x47 = (1.0 / 2.0) * e1
    out[0] = M2 * b_roll + b_parallel * x0
    out[1] = -M1 * b_roll + b_parallel * x1
    out[2] = b_perpendicular * x2
    out[3] = -e1 * x40 - x42 * x43 - x44 * x45
    out[4] = e0 * x40 - x42 * x45 + x43 * x44
    out[5] = e3 * x40 + x42 * x46 - x44 * x47
    out[6] = -e2 * x40 + x42 * x47 + x44 * x46


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
    state: (7) q1, q2, q3, e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    mobility_gradient: (5, 3) as listed above
    params: (3) W1, W2, W3
    out: (7, 7) filled with the result.
    1307 operations, 253 temporaries.
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
    W1 = params[0]
    W2 = params[1]
    W3 = params[2]
    x0 = F1 + W1
    x1 = F2 + W2
    x2 = F3 + W3
    x3 = 2.0 * e0
    x4 = e1 * x3
    x5 = 2.0 * e3
    x6 = e2 * x5 + x4
    x7 = e1 * e1
    x8 = e2 * e2
    x9 = e0 * e0
    x10 = e3 * e3
    x11 = x10 + x9
    x12 = x11 + x7 + x8
    x13 = 1.0 / (x12 * x12)
    x14 = e2 * x3
    x15 = e1 * x5 + x14
    x16 = x13 * x15
    x17 = e3 * x3
    x18 = 2.0 * e1 * e2 - x17
    x19 = -x7
    x20 = -x8
    x21 = x11 + x19 + x20
    x22 = x13 * x21
    x23 = x16 * x6 - x18 * x22
    x24 = (1.0 / 2.0) * e1
    x25 = b_roll * x24
    x26 = 2.0 * e1 * e3 - x14
    x27 = -x10 + x9
    x28 = x20 + x27 + x7
    x29 = x13 * x6
    x30 = x13 * x18 * x26 - x28 * x29
    x31 = (1.0 / 2.0) * e3
    x32 = b_roll * x31
    x33 = x13 * x21 * x28 - x16 * x26
    x34 = (1.0 / 2.0) * e2
    x35 = b_roll * x34
    x36 = -x23 * x25 - x30 * x32 - x33 * x35
    x37 = 2.0 * e2 * e3 - x4
    x38 = x13 * x26
    x39 = 2.0 * e1
    x40 = e2 * x39 + x17
    x41 = x13 * x21 * x40 - x37 * x38
    x42 = x19 + x27 + x8
    x43 = x13 * x26 * x42 - x29 * x40
    x44 = -x22 * x42 + x29 * x37
    x45 = -x25 * x44 - x32 * x43 - x35 * x41
    x46 = 1.0 / x12
    x47 = b_turn * x46
    x48 = x26 * x46
    x49 = b_spin - b_turn
    x50 = x49 * (x13 * (x21 * x21) + x13 * (x26 * x26) + x13 * (x6 * x6))
    x51 = x26 * x47 + x48 * x50
    x52 = x46 * x6
    x53 = x47 * x6 + x50 * x52
    x54 = x21 * x46
    x55 = x21 * x47 + x50 * x54
    x56 = -x24 * x51 - x31 * x55 - x34 * x53
    x57 = x49 * (x16 * x21 + x18 * x29 + x28 * x38)
    x58 = x18 * x47 + x52 * x57
    x59 = x28 * x47 + x48 * x57
    x60 = x15 * x47 + x54 * x57
    x61 = -x24 * x59 - x31 * x60 - x34 * x58
    x62 = x49 * (x22 * x37 + x29 * x42 + x38 * x40)
    x63 = x40 * x47 + x48 * x62
    x64 = x42 * x47 + x52 * x62
    x65 = x37 * x47 + x54 * x62
    x66 = -x24 * x63 - x31 * x65 - x34 * x64
    x67 = x1 * x46
    x68 = x0 * x46
    x69 = x2 * x48 + x28 * x68 + x40 * x67
    x70 = x18 * x68 + x2 * x52 + x42 * x67
    x71 = x26 * x46 * x70 - x52 * x69
    x72 = x15 * x68 + x2 * x54 + x37 * x67
    x73 = x52 * x72 - x54 * x70
    x74 = x21 * x46 * x69 - x48 * x72
    x75 = -x24 * x73 - x31 * x71 - x34 * x74
    x76 = M1 * x46
    x77 = M2 * x46
    x78 = M3 * x52 + x18 * x76 + x42 * x77
    x79 = M3 * x48 + x28 * x76 + x40 * x77
    x80 = M3 * x54 + x15 * x76 + x37 * x77
    x81 = x48 * x79 + x52 * x78 + x54 * x80
    x82 = x48 * x81
    x83 = x52 * x81
    x84 = x54 * x81
    x85 = -x24 * x82 - x31 * x84 - x34 * x83
    x86 = x79 - x82
    x87 = x78 - x83
    x88 = x80 - x84
    x89 = -x24 * x86 - x31 * x88 - x34 * x87
    x90 = x13 * x3
    x91 = M1 * x90
    x92 = M2 * x90
    x93 = x3 * x38
    x94 = x3 * x76
    x95 = x5 * x77
    x96 = 2.0 * e2
    x97 = x46 * x96
    x98 = M3 * x97
    x99 = -x94 - x95 + x98
    x100 = -M3 * x93 - x28 * x91 - x40 * x92 - x99
    x101 = x49 * x81
    x102 = x101 * x97
    x103 = -x102
    x104 = x3 * x46
    x105 = x104 * x70
    x106 = x39 * x46
    x107 = x106 * x72
    x108 = x29 * x3
    x109 = x0 * x3
    x110 = x1 * x90
    x111 = x2 * x3
    x112 = x2 * x46
    x113 = x112 * x3
    x114 = x68 * x96
    x115 = x39 * x67
    x116 = -x113 - x114 + x115
    x117 = -x109 * x16 - x110 * x37 - x111 * x22 - x116
    x118 = x109 * x13
    x119 = x3 * x67
    x120 = x112 * x39
    x121 = x5 * x68
    x122 = -x119 - x120 + x121
    x123 = -x110 * x42 - x111 * x29 - x118 * x18 - x122
    x124 = x22 * x3
    x125 = x3 * x77
    x126 = M3 * x106
    x127 = x5 * x76
    x128 = -x125 - x126 + x127
    x129 = -M3 * x108 - x128 - x18 * x91 - x42 * x92
    x130 = M1 * x16
    x131 = x76 * x96
    x132 = M3 * x104
    x133 = x39 * x77
    x134 = -x131 - x132 + x133
    x135 = -M3 * x124 - x130 * x3 - x134 - x37 * x92
    x136 = x49 * (
        x100 * x48
        + x104 * x80
        + x106 * x78
        - x108 * x78
        - x124 * x80
        + x129 * x52
        + x135 * x54
        - x79 * x93
        - x79 * x97
    )
    x137 = (
        b_roll
        * (2.0 * e0 * x13 * x21 * x70 - x105 + x107 - x108 * x72 + x117 * x46 * x6 - x123 * x54)
        + b_turn * x100
        - x101 * x93
        + x103
        + x136 * x48
    )
    x138 = x101 * x106
    x139 = x104 * x69
    x140 = x72 * x97
    x141 = x3 * x68
    x142 = x5 * x67
    x143 = x112 * x96
    x144 = -x141 - x142 + x143
    x145 = -x110 * x40 - x111 * x38 - x118 * x28 - x144
    x146 = (
        b_roll * (-x117 * x48 - x124 * x69 + x139 + x140 + x145 * x54 + x72 * x93)
        + b_turn * x129
        - x101 * x108
        + x136 * x52
        + x138
    )
    x147 = x101 * x104
    x148 = x106 * x69
    x149 = x70 * x97
    x150 = (
        b_roll
        * (2.0 * e0 * x13 * x6 * x69 + x123 * x26 * x46 - x145 * x52 - x148 - x149 - x70 * x93)
        + b_turn * x135
        - x101 * x124
        + x136 * x54
        + x147
    )
    x151 = x13 * x39
    x152 = M2 * x151
    x153 = x38 * x39
    x154 = M1 * x151
    x155 = (
        2.0 * M1 * e1 * x46
        + 2.0 * M2 * e2 * x46
        + 2.0 * M3 * e3 * x46
        - M3 * x153
        - x152 * x40
        - x154 * x28
    )
    x156 = x46 * x5
    x157 = x101 * x156
    x158 = x104 * x72
    x159 = x106 * x70
    x160 = x29 * x39
    x161 = x22 * x39
    x162 = x0 * x39
    x163 = x1 * x151
    x164 = x2 * x39
    x165 = -x119 - x120 + x121 - x16 * x162 - x163 * x37 - x164 * x22
    x166 = x13 * x162
    x167 = -x116 - x163 * x42 - x164 * x29 - x166 * x18
    x168 = -M3 * x160 - x134 - x152 * x42 - x154 * x18
    x169 = -M3 * x161 - x125 - x126 + x127 - x130 * x39 - x152 * x37
    x170 = x49 * (
        x104 * x78
        - x106 * x80
        - x153 * x79
        + x155 * x48
        + x156 * x79
        - x160 * x78
        - x161 * x80
        + x168 * x52
        + x169 * x54
    )
    x171 = (
        b_roll * (x158 + x159 - x160 * x72 + x161 * x70 + x165 * x52 - x167 * x54)
        + b_turn * x155
        - x101 * x153
        + x157
        + x170 * x48
    )
    x172 = x156 * x72
    x173 = (
        2.0 * e1 * x0 * x46
        + 2.0 * e2 * x1 * x46
        + 2.0 * e3 * x2 * x46
        - x163 * x40
        - x164 * x38
        - x166 * x28
    )
    x174 = (
        b_roll
        * (2.0 * e1 * x13 * x26 * x72 - x148 - x161 * x69 - x165 * x48 - x172 + x173 * x21 * x46)
        + b_turn * x168
        - x101 * x160
        + x147
        + x170 * x52
    )
    x175 = -x156 * x70
    x176 = (
        b_roll
        * (2.0 * e1 * x13 * x6 * x69 - x139 - x153 * x70 + x167 * x26 * x46 - x173 * x52 - x175)
        + b_turn * x169
        - x101 * x161
        - x138
        + x170 * x54
    )
    x177 = (1.0 / 2.0) * b_roll
    x178 = (1.0 / 2.0) * b_turn
    x179 = (1.0 / 2.0) * x49
    x180 = x177 * x73 + x178 * x79 + x179 * x82
    x181 = x13 * x96
    x182 = M2 * x181
    x183 = x38 * x96
    x184 = M1 * x181
    x185 = -M3 * x183 - x131 - x132 + x133 - x182 * x40 - x184 * x28
    x186 = x29 * x96
    x187 = x22 * x96
    x188 = x0 * x96
    x189 = x1 * x181
    x190 = x2 * x96
    x191 = -x144 - x16 * x188 - x189 * x37 - x190 * x22
    x192 = x13 * x188
    x193 = x112 * x5 + x39 * x68 + x67 * x96
    x194 = -x18 * x192 - x189 * x42 - x190 * x29 + x193
    x195 = M3 * x156 + x39 * x76 + x77 * x96
    x196 = -M3 * x186 - x18 * x184 - x182 * x42 + x195
    x197 = -M3 * x187 - x130 * x96 - x182 * x37 - x99
    x198 = x49 * (
        2.0 * e3 * x46 * x78
        - x104 * x79
        - x183 * x79
        + x185 * x26 * x46
        - x186 * x78
        - x187 * x80
        + x196 * x46 * x6
        + x197 * x21 * x46
        - x80 * x97
    )
    x199 = (
        b_roll * (x149 + x172 - x186 * x72 + x187 * x70 + x191 * x52 - x194 * x54)
        + b_turn * x185
        - x101 * x183
        - x147
        + x198 * x48
    )
    x200 = -x69 * x97
    x201 = -x113 - x114 + x115 - x189 * x40 - x190 * x38 - x192 * x28
    x202 = (
        b_roll * (x158 + x183 * x72 - x187 * x69 - x191 * x48 + x200 + x201 * x54)
        + b_turn * x196
        - x101 * x186
        + x157
        + x198 * x52
    )
    x203 = x156 * x69
    x204 = (
        b_roll
        * (2.0 * e2 * x13 * x6 * x69 - x105 - x183 * x70 + x194 * x26 * x46 - x201 * x52 - x203)
        + b_turn * x197
        - x101 * x187
        + x103
        + x198 * x54
    )
    x205 = x177 * x74 + x178 * x78 + x179 * x83
    x206 = x13 * x5
    x207 = M1 * x206
    x208 = M2 * x206
    x209 = x38 * x5
    x210 = -M3 * x209 - x128 - x207 * x28 - x208 * x40
    x211 = x29 * x5
    x212 = x22 * x5
    x213 = x0 * x5
    x214 = x1 * x206
    x215 = x2 * x5
    x216 = -x16 * x213 + x193 - x214 * x37 - x215 * x22
    x217 = x13 * x213
    x218 = -x141 - x142 + x143 - x18 * x217 - x214 * x42 - x215 * x29
    x219 = -M3 * x211 - x18 * x207 - x208 * x42 - x94 - x95 + x98
    x220 = -M3 * x212 - x130 * x5 + x195 - x208 * x37
    x221 = x49 * (
        x106 * x79
        + x156 * x80
        - x209 * x79
        + x210 * x48
        - x211 * x78
        - x212 * x80
        + x219 * x52
        + x220 * x54
        + x78 * x97
    )
    x222 = (
        b_roll * (x140 + x175 - x211 * x72 + x212 * x70 + x216 * x52 - x218 * x54)
        + b_turn * x210
        - x101 * x209
        + x138
        + x221 * x48
    )
    x223 = -x122 - x214 * x40 - x215 * x38 - x217 * x28
    x224 = (
        b_roll
        * (2.0 * e3 * x13 * x26 * x72 - x107 + x203 + x21 * x223 * x46 - x212 * x69 - x216 * x48)
        + b_turn * x219
        - x101 * x211
        + x102
        + x221 * x52
    )
    x225 = (
        b_roll * (x159 + x200 - x209 * x70 + x211 * x69 + x218 * x48 - x223 * x52)
        + b_turn * x220
        - x101 * x212
        + x157
        + x221 * x54
    )
    x226 = x177 * x71 + x178 * x80 + x179 * x84
    x227 = e0 * x177
    x228 = x227 * x23 + x30 * x35 - x32 * x33
    x229 = x227 * x44 - x32 * x41 + x35 * x43
    x230 = (1.0 / 2.0) * e0
    x231 = x230 * x51 - x31 * x53 + x34 * x55
    x232 = x230 * x59 - x31 * x58 + x34 * x60
    x233 = x230 * x63 - x31 * x64 + x34 * x65
    x234 = x230 * x73 - x31 * x74 + x34 * x71
    x235 = x230 * x82 - x31 * x83 + x34 * x84
    x236 = x230 * x86 - x31 * x87 + x34 * x88
    x237 = x227 * x33 + x23 * x32 - x25 * x30
    x238 = x227 * x41 - x25 * x43 + x32 * x44
    x239 = x230 * x53 - x24 * x55 + x31 * x51
    x240 = x230 * x58 - x24 * x60 + x31 * x59
    x241 = x230 * x64 - x24 * x65 + x31 * x63
    x242 = x230 * x74 - x24 * x71 + x31 * x73
    x243 = x230 * x83 - x24 * x84 + x31 * x82
    x244 = x230 * x87 - x24 * x88 + x31 * x86
    x245 = x227 * x30 - x23 * x35 + x25 * x33
    x246 = x227 * x43 + x25 * x41 - x35 * x44
    x247 = x230 * x55 + x24 * x53 - x34 * x51
    x248 = x230 * x60 + x24 * x58 - x34 * x59
    x249 = x230 * x65 + x24 * x64 - x34 * x63
    x250 = x230 * x71 + x24 * x74 - x34 * x73
    x251 = x230 * x84 + x24 * x83 - x34 * x82
    x252 = x230 * x88 + x24 * x87 - x34 * x86
    out[0, 0] = DF11 * b_parallel + DM21 * b_roll + Db11 * x0 + Db51 * M2
    out[0, 1] = DF12 * b_parallel + DM22 * b_roll + Db12 * x0 + Db52 * M2
    out[0, 2] = DF13 * b_parallel + DM23 * b_roll + Db13 * x0 + Db53 * M2
    out[0, 3] = 0.0
    out[0, 4] = 0.0
    out[0, 5] = 0.0
    out[0, 6] = 0.0
    out[1, 0] = DF21 * b_parallel - DM11 * b_roll + Db11 * x1 - Db51 * M1
    out[1, 1] = DF22 * b_parallel - DM12 * b_roll + Db12 * x1 - Db52 * M1
    out[1, 2] = DF23 * b_parallel - DM13 * b_roll + Db13 * x1 - Db53 * M1
    out[1, 3] = 0.0
    out[1, 4] = 0.0
    out[1, 5] = 0.0
    out[1, 6] = 0.0
    out[2, 0] = DF31 * b_perpendicular + Db21 * x2
    out[2, 1] = DF32 * b_perpendicular + Db22 * x2
    out[2, 2] = DF33 * b_perpendicular + Db23 * x2
    out[2, 3] = 0.0
    out[2, 4] = 0.0
    out[2, 5] = 0.0
    out[2, 6] = 0.0
    out[3, 0] = (
        DF11 * x36
        + DF21 * x45
        + DM11 * x61
        + DM21 * x66
        + DM31 * x56
        + Db31 * x89
        + Db41 * x85
        + Db51 * x75
    )
    out[3, 1] = (
        DF12 * x36
        + DF22 * x45
        + DM12 * x61
        + DM22 * x66
        + DM32 * x56
        + Db32 * x89
        + Db42 * x85
        + Db52 * x75
    )
    out[3, 2] = (
        DF13 * x36
        + DF23 * x45
        + DM13 * x61
        + DM23 * x66
        + DM33 * x56
        + Db33 * x89
        + Db43 * x85
        + Db53 * x75
    )
    out[3, 3] = -x137 * x24 - x146 * x34 - x150 * x31
    out[3, 4] = -x171 * x24 - x174 * x34 - x176 * x31 - x180
    out[3, 5] = -x199 * x24 - x202 * x34 - x204 * x31 - x205
    out[3, 6] = -x222 * x24 - x224 * x34 - x225 * x31 - x226
    out[4, 0] = (
        DF11 * x228
        + DF21 * x229
        + DM11 * x232
        + DM21 * x233
        + DM31 * x231
        + Db31 * x236
        + Db41 * x235
        + Db51 * x234
    )
    out[4, 1] = (
        DF12 * x228
        + DF22 * x229
        + DM12 * x232
        + DM22 * x233
        + DM32 * x231
        + Db32 * x236
        + Db42 * x235
        + Db52 * x234
    )
    out[4, 2] = (
        DF13 * x228
        + DF23 * x229
        + DM13 * x232
        + DM23 * x233
        + DM33 * x231
        + Db33 * x236
        + Db43 * x235
        + Db53 * x234
    )
    out[4, 3] = x137 * x230 - x146 * x31 + x150 * x34 + x180
    out[4, 4] = x171 * x230 - x174 * x31 + x176 * x34
    out[4, 5] = x199 * x230 - x202 * x31 + x204 * x34 + x226
    out[4, 6] = (1.0 / 2.0) * e0 * x222 + (1.0 / 2.0) * e2 * x225 - x205 - x224 * x31
    out[5, 0] = (
        DF11 * x237
        + DF21 * x238
        + DM11 * x240
        + DM21 * x241
        + DM31 * x239
        + Db31 * x244
        + Db41 * x243
        + Db51 * x242
    )
    out[5, 1] = (
        DF12 * x237
        + DF22 * x238
        + DM12 * x240
        + DM22 * x241
        + DM32 * x239
        + Db32 * x244
        + Db42 * x243
        + Db52 * x242
    )
    out[5, 2] = (
        DF13 * x237
        + DF23 * x238
        + DM13 * x240
        + DM23 * x241
        + DM33 * x239
        + Db33 * x244
        + Db43 * x243
        + Db53 * x242
    )
    out[5, 3] = x137 * x31 + x146 * x230 - x150 * x24 + x205
    out[5, 4] = (1.0 / 2.0) * e0 * x174 + (1.0 / 2.0) * e3 * x171 - x176 * x24 - x226
    out[5, 5] = x199 * x31 + x202 * x230 - x204 * x24
    out[5, 6] = x180 + x222 * x31 + x224 * x230 - x225 * x24
    out[6, 0] = (
        DF11 * x245
        + DF21 * x246
        + DM11 * x248
        + DM21 * x249
        + DM31 * x247
        + Db31 * x252
        + Db41 * x251
        + Db51 * x250
    )
    out[6, 1] = (
        DF12 * x245
        + DF22 * x246
        + DM12 * x248
        + DM22 * x249
        + DM32 * x247
        + Db32 * x252
        + Db42 * x251
        + Db52 * x250
    )
    out[6, 2] = (
        DF13 * x245
        + DF23 * x246
        + DM13 * x248
        + DM23 * x249
        + DM33 * x247
        + Db33 * x252
        + Db43 * x251
        + Db53 * x250
    )
    out[6, 3] = -x137 * x34 + x146 * x24 + x150 * x230 + x226
    out[6, 4] = -x171 * x34 + x174 * x24 + x176 * x230 + x205
    out[6, 5] = (1.0 / 2.0) * e0 * x204 + (1.0 / 2.0) * e1 * x202 - x180 - x199 * x34
    out[6, 6] = -x222 * x34 + x224 * x24 + x225 * x230


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
