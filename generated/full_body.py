"""Full model of a body of any shape: M V' + N(V) = W - R V.

Made by `python -m derivation` from derivation/body_motion.py; do not edit.
SymPy 1.14.0. 403 operations, 52 temporaries.

H is the inverse of the inertia M. M may contain the added mass of the fluid.
q is the centre of mass, and the moment is that about it. The matrices are constant and
symmetric; rows and columns 1-3 are along P1..P3, rows and columns 4-6 about them.

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

* [0] `M11` [kg] inertia along P1, along P1
* [1] `M12` [kg] inertia along P1, along P2
* [2] `M13` [kg] inertia along P1, along P3
* [3] `M14` [kg m] inertia along P1, about P1
* [4] `M15` [kg m] inertia along P1, about P2
* [5] `M16` [kg m] inertia along P1, about P3
* [6] `M22` [kg] inertia along P2, along P2
* [7] `M23` [kg] inertia along P2, along P3
* [8] `M24` [kg m] inertia along P2, about P1
* [9] `M25` [kg m] inertia along P2, about P2
* [10] `M26` [kg m] inertia along P2, about P3
* [11] `M33` [kg] inertia along P3, along P3
* [12] `M34` [kg m] inertia along P3, about P1
* [13] `M35` [kg m] inertia along P3, about P2
* [14] `M36` [kg m] inertia along P3, about P3
* [15] `M44` [kg m^2] inertia about P1, about P1
* [16] `M45` [kg m^2] inertia about P1, about P2
* [17] `M46` [kg m^2] inertia about P1, about P3
* [18] `M55` [kg m^2] inertia about P2, about P2
* [19] `M56` [kg m^2] inertia about P2, about P3
* [20] `M66` [kg m^2] inertia about P3, about P3
* [21] `H11` [1/kg] inverse inertia along P1, along P1
* [22] `H12` [1/kg] inverse inertia along P1, along P2
* [23] `H13` [1/kg] inverse inertia along P1, along P3
* [24] `H14` [1/(kg m)] inverse inertia along P1, about P1
* [25] `H15` [1/(kg m)] inverse inertia along P1, about P2
* [26] `H16` [1/(kg m)] inverse inertia along P1, about P3
* [27] `H22` [1/kg] inverse inertia along P2, along P2
* [28] `H23` [1/kg] inverse inertia along P2, along P3
* [29] `H24` [1/(kg m)] inverse inertia along P2, about P1
* [30] `H25` [1/(kg m)] inverse inertia along P2, about P2
* [31] `H26` [1/(kg m)] inverse inertia along P2, about P3
* [32] `H33` [1/kg] inverse inertia along P3, along P3
* [33] `H34` [1/(kg m)] inverse inertia along P3, about P1
* [34] `H35` [1/(kg m)] inverse inertia along P3, about P2
* [35] `H36` [1/(kg m)] inverse inertia along P3, about P3
* [36] `H44` [1/(kg m^2)] inverse inertia about P1, about P1
* [37] `H45` [1/(kg m^2)] inverse inertia about P1, about P2
* [38] `H46` [1/(kg m^2)] inverse inertia about P1, about P3
* [39] `H55` [1/(kg m^2)] inverse inertia about P2, about P2
* [40] `H56` [1/(kg m^2)] inverse inertia about P2, about P3
* [41] `H66` [1/(kg m^2)] inverse inertia about P3, about P3
* [42] `R11` [kg/s] drag along P1, along P1
* [43] `R12` [kg/s] drag along P1, along P2
* [44] `R13` [kg/s] drag along P1, along P3
* [45] `R14` [N s] drag along P1, about P1
* [46] `R15` [N s] drag along P1, about P2
* [47] `R16` [N s] drag along P1, about P3
* [48] `R22` [kg/s] drag along P2, along P2
* [49] `R23` [kg/s] drag along P2, along P3
* [50] `R24` [N s] drag along P2, about P1
* [51] `R25` [N s] drag along P2, about P2
* [52] `R26` [N s] drag along P2, about P3
* [53] `R33` [kg/s] drag along P3, along P3
* [54] `R34` [N s] drag along P3, about P1
* [55] `R35` [N s] drag along P3, about P2
* [56] `R36` [N s] drag along P3, about P3
* [57] `R44` [N m s] drag about P1, about P1
* [58] `R45` [N m s] drag about P1, about P2
* [59] `R46` [N m s] drag about P1, about P3
* [60] `R55` [N m s] drag about P2, about P2
* [61] `R56` [N m s] drag about P2, about P3
* [62] `R66` [N m s] drag about P3, about P3
* [63] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [64] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [65] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3", "v1", "v2", "v3", "omega1", "omega2", "omega3")
PARAMS = (
    "M11",
    "M12",
    "M13",
    "M14",
    "M15",
    "M16",
    "M22",
    "M23",
    "M24",
    "M25",
    "M26",
    "M33",
    "M34",
    "M35",
    "M36",
    "M44",
    "M45",
    "M46",
    "M55",
    "M56",
    "M66",
    "H11",
    "H12",
    "H13",
    "H14",
    "H15",
    "H16",
    "H22",
    "H23",
    "H24",
    "H25",
    "H26",
    "H33",
    "H34",
    "H35",
    "H36",
    "H44",
    "H45",
    "H46",
    "H55",
    "H56",
    "H66",
    "R11",
    "R12",
    "R13",
    "R14",
    "R15",
    "R16",
    "R22",
    "R23",
    "R24",
    "R25",
    "R26",
    "R33",
    "R34",
    "R35",
    "R36",
    "R44",
    "R45",
    "R46",
    "R55",
    "R56",
    "R66",
    "W1",
    "W2",
    "W3",
)
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ()
LINEAR_DRAG = False


@njit(cache=True)
def rhs(t, state, force, moment, params, out):
    """Rate of change of the state.

    t: time since release [s]
    state: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (66) as listed above
    out: (13) filled with the result.
    403 operations, 52 temporaries.
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
    M11 = params[0]
    M12 = params[1]
    M13 = params[2]
    M14 = params[3]
    M15 = params[4]
    M16 = params[5]
    M22 = params[6]
    M23 = params[7]
    M24 = params[8]
    M25 = params[9]
    M26 = params[10]
    M33 = params[11]
    M34 = params[12]
    M35 = params[13]
    M36 = params[14]
    M44 = params[15]
    M45 = params[16]
    M46 = params[17]
    M55 = params[18]
    M56 = params[19]
    M66 = params[20]
    H11 = params[21]
    H12 = params[22]
    H13 = params[23]
    H14 = params[24]
    H15 = params[25]
    H16 = params[26]
    H22 = params[27]
    H23 = params[28]
    H24 = params[29]
    H25 = params[30]
    H26 = params[31]
    H33 = params[32]
    H34 = params[33]
    H35 = params[34]
    H36 = params[35]
    H44 = params[36]
    H45 = params[37]
    H46 = params[38]
    H55 = params[39]
    H56 = params[40]
    H66 = params[41]
    R11 = params[42]
    R12 = params[43]
    R13 = params[44]
    R14 = params[45]
    R15 = params[46]
    R16 = params[47]
    R22 = params[48]
    R23 = params[49]
    R24 = params[50]
    R25 = params[51]
    R26 = params[52]
    R33 = params[53]
    R34 = params[54]
    R35 = params[55]
    R36 = params[56]
    R44 = params[57]
    R45 = params[58]
    R46 = params[59]
    R55 = params[60]
    R56 = params[61]
    R66 = params[62]
    W1 = params[63]
    W2 = params[64]
    W3 = params[65]
    x0 = (1.0 / 2.0) * omega1
    x1 = (1.0 / 2.0) * e2
    x2 = (1.0 / 2.0) * e3
    x3 = (1.0 / 2.0) * e0
    x4 = (1.0 / 2.0) * e1
    x5 = 2.0 * e0
    x6 = e2 * x5
    x7 = 2.0 * e1
    x8 = e3 * x7 + x6
    x9 = e2 * e2
    x10 = e3 * e3
    x11 = e0 * e0
    x12 = e1 * e1
    x13 = x11 + x12
    x14 = 1.0 / (x10 + x13 + x9)
    x15 = e3 * x5
    x16 = 2.0 * e1 * e2 - x15
    x17 = v1 * x14
    x18 = e1 * x5
    x19 = 2.0 * e2 * e3 + x18
    x20 = v3 * x14
    x21 = -x10
    x22 = x11 - x12
    x23 = x21 + x22 + x9
    x24 = v2 * x14
    x25 = x16 * x17 + x19 * x20 + x23 * x24
    x26 = e2 * x7 + x15
    x27 = 2.0 * e1 * e3 - x6
    x28 = -x9
    x29 = x13 + x21 + x28
    x30 = x17 * x29 + x20 * x27 + x24 * x26
    x31 = F2 + W2
    x32 = F3 + W3
    x33 = F1 + W1
    x34 = 2.0 * e2 * e3 - x18
    x35 = x10 + x22 + x28
    x36 = x17 * x8 + x20 * x35 + x24 * x34
    x37 = M13 * x30 + M23 * x25 + M33 * x36 + M34 * omega1 + M35 * omega2 + M36 * omega3
    x38 = M12 * x30 + M22 * x25 + M23 * x36 + M24 * omega1 + M25 * omega2 + M26 * omega3
    x39 = (
        -R11 * x30
        - R12 * x25
        - R13 * x36
        - R14 * omega1
        - R15 * omega2
        - R16 * omega3
        - omega2 * x37
        + omega3 * x38
        + x14 * x26 * x31
        + x14 * x27 * x32
        + x14 * x29 * x33
    )
    x40 = M11 * x30 + M12 * x25 + M13 * x36 + M14 * omega1 + M15 * omega2 + M16 * omega3
    x41 = (
        -R12 * x30
        - R22 * x25
        - R23 * x36
        - R24 * omega1
        - R25 * omega2
        - R26 * omega3
        + omega1 * x37
        - omega3 * x40
        + x14 * x16 * x33
        + x14 * x19 * x32
        + x14 * x23 * x31
    )
    x42 = (
        -R13 * x30
        - R23 * x25
        - R33 * x36
        - R34 * omega1
        - R35 * omega2
        - R36 * omega3
        - omega1 * x38
        + omega2 * x40
        + x14 * x31 * x34
        + x14 * x32 * x35
        + x14 * x33 * x8
    )
    x43 = M16 * x30 + M26 * x25 + M36 * x36 + M46 * omega1 + M56 * omega2 + M66 * omega3
    x44 = M15 * x30 + M25 * x25 + M35 * x36 + M45 * omega1 + M55 * omega2 + M56 * omega3
    x45 = (
        M1 * x14 * x29
        + M2 * x14 * x26
        + M3 * x14 * x27
        - R14 * x30
        - R24 * x25
        - R34 * x36
        - R44 * omega1
        - R45 * omega2
        - R46 * omega3
        - omega2 * x43
        + omega3 * x44
        - x25 * x37
        + x36 * x38
    )
    x46 = M14 * x30 + M24 * x25 + M34 * x36 + M44 * omega1 + M45 * omega2 + M46 * omega3
    x47 = (
        M1 * x14 * x16
        + M2 * x14 * x23
        + M3 * x14 * x19
        - R15 * x30
        - R25 * x25
        - R35 * x36
        - R45 * omega1
        - R55 * omega2
        - R56 * omega3
        + omega1 * x43
        - omega3 * x46
        + x30 * x37
        - x36 * x40
    )
    x48 = (
        M1 * x14 * x8
        + M2 * x14 * x34
        + M3 * x14 * x35
        - R16 * x30
        - R26 * x25
        - R36 * x36
        - R46 * omega1
        - R56 * omega2
        - R66 * omega3
        - omega1 * x44
        + omega2 * x46
        + x25 * x40
        - x30 * x38
    )
    x49 = x14 * (
        H13 * x39
        + H23 * x41
        + H33 * x42
        + H34 * x45
        + H35 * x47
        + H36 * x48
        + omega1 * x25
        - omega2 * x30
    )
    x50 = x14 * (
        H12 * x39
        + H22 * x41
        + H23 * x42
        + H24 * x45
        + H25 * x47
        + H26 * x48
        - omega1 * x36
        + omega3 * x30
    )
    x51 = x14 * (
        H11 * x39
        + H12 * x41
        + H13 * x42
        + H14 * x45
        + H15 * x47
        + H16 * x48
        + omega2 * x36
        - omega3 * x25
    )
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = -e1 * x0 - omega2 * x1 - omega3 * x2
    out[4] = e0 * x0 - omega2 * x2 + omega3 * x1
    out[5] = e3 * x0 + omega2 * x3 - omega3 * x4
    out[6] = -e2 * x0 + omega2 * x4 + omega3 * x3
    out[7] = x16 * x50 + x29 * x51 + x49 * x8
    out[8] = x23 * x50 + x26 * x51 + x34 * x49
    out[9] = x19 * x50 + x27 * x51 + x35 * x49
    out[10] = H14 * x39 + H24 * x41 + H34 * x42 + H44 * x45 + H45 * x47 + H46 * x48
    out[11] = H15 * x39 + H25 * x41 + H35 * x42 + H45 * x45 + H55 * x47 + H56 * x48
    out[12] = H16 * x39 + H26 * x41 + H36 * x42 + H46 * x45 + H56 * x47 + H66 * x48


@njit(cache=True)
def rates(t, state, force, moment, force_gradient, moment_gradient, mobility, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(t, state, force, moment, params, out)
