"""First-order slow model of a body of any shape: V = B (W - M B W' - N(V_0)).

Made by `python -m derivation` from derivation/body_motion.py; do not edit.
SymPy 1.14.0. 1119 operations, 198 temporaries.

V_0 = B W, and B is the inverse of the drag. `rhs` is the overdamped motion. It is
correct to first order in the inertia M if force and moment are those of
`slow_wrench`.
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

Parameters:

* [0] `B11` [s/kg] mobility along P1, along P1
* [1] `B12` [s/kg] mobility along P1, along P2
* [2] `B13` [s/kg] mobility along P1, along P3
* [3] `B14` [1/(N s)] mobility along P1, about P1
* [4] `B15` [1/(N s)] mobility along P1, about P2
* [5] `B16` [1/(N s)] mobility along P1, about P3
* [6] `B22` [s/kg] mobility along P2, along P2
* [7] `B23` [s/kg] mobility along P2, along P3
* [8] `B24` [1/(N s)] mobility along P2, about P1
* [9] `B25` [1/(N s)] mobility along P2, about P2
* [10] `B26` [1/(N s)] mobility along P2, about P3
* [11] `B33` [s/kg] mobility along P3, along P3
* [12] `B34` [1/(N s)] mobility along P3, about P1
* [13] `B35` [1/(N s)] mobility along P3, about P2
* [14] `B36` [1/(N s)] mobility along P3, about P3
* [15] `B44` [1/(N m s)] mobility about P1, about P1
* [16] `B45` [1/(N m s)] mobility about P1, about P2
* [17] `B46` [1/(N m s)] mobility about P1, about P3
* [18] `B55` [1/(N m s)] mobility about P2, about P2
* [19] `B56` [1/(N m s)] mobility about P2, about P3
* [20] `B66` [1/(N m s)] mobility about P3, about P3
* [21] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [22] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [23] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
* [24] `M11` [kg] inertia along P1, along P1
* [25] `M12` [kg] inertia along P1, along P2
* [26] `M13` [kg] inertia along P1, along P3
* [27] `M14` [kg m] inertia along P1, about P1
* [28] `M15` [kg m] inertia along P1, about P2
* [29] `M16` [kg m] inertia along P1, about P3
* [30] `M22` [kg] inertia along P2, along P2
* [31] `M23` [kg] inertia along P2, along P3
* [32] `M24` [kg m] inertia along P2, about P1
* [33] `M25` [kg m] inertia along P2, about P2
* [34] `M26` [kg m] inertia along P2, about P3
* [35] `M33` [kg] inertia along P3, along P3
* [36] `M34` [kg m] inertia along P3, about P1
* [37] `M35` [kg m] inertia along P3, about P2
* [38] `M36` [kg m] inertia along P3, about P3
* [39] `M44` [kg m^2] inertia about P1, about P1
* [40] `M45` [kg m^2] inertia about P1, about P2
* [41] `M46` [kg m^2] inertia about P1, about P3
* [42] `M55` [kg m^2] inertia about P2, about P2
* [43] `M56` [kg m^2] inertia about P2, about P3
* [44] `M66` [kg m^2] inertia about P3, about P3
"""

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3")
PARAMS = (
    "B11",
    "B12",
    "B13",
    "B14",
    "B15",
    "B16",
    "B22",
    "B23",
    "B24",
    "B25",
    "B26",
    "B33",
    "B34",
    "B35",
    "B36",
    "B44",
    "B45",
    "B46",
    "B55",
    "B56",
    "B66",
    "W1",
    "W2",
    "W3",
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
)
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ()
LINEAR_DRAG = False


@njit(cache=True)
def rhs(t, state, force, moment, params, out):
    """Rate of change of the state.

    t: time since release [s]
    state: (7) q1, q2, q3, e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (45) as listed above
    out: (7) filled with the result.
    192 operations, 45 temporaries.
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
    B11 = params[0]
    B12 = params[1]
    B13 = params[2]
    B14 = params[3]
    B15 = params[4]
    B16 = params[5]
    B22 = params[6]
    B23 = params[7]
    B24 = params[8]
    B25 = params[9]
    B26 = params[10]
    B33 = params[11]
    B34 = params[12]
    B35 = params[13]
    B36 = params[14]
    B44 = params[15]
    B45 = params[16]
    B46 = params[17]
    B55 = params[18]
    B56 = params[19]
    B66 = params[20]
    W1 = params[21]
    W2 = params[22]
    W3 = params[23]
    x0 = 2.0 * e0
    x1 = e2 * x0
    x2 = 2.0 * e1
    x3 = e3 * x2 + x1
    x4 = e2 * e2
    x5 = e3 * e3
    x6 = e0 * e0
    x7 = e1 * e1
    x8 = x6 + x7
    x9 = 1.0 / (x4 + x5 + x8)
    x10 = e3 * x0
    x11 = e2 * x2 + x10
    x12 = M2 * x9
    x13 = 2.0 * e1 * e3 - x1
    x14 = M3 * x9
    x15 = -x4
    x16 = -x5
    x17 = x15 + x16 + x8
    x18 = M1 * x9
    x19 = x11 * x12 + x13 * x14 + x17 * x18
    x20 = 2.0 * e1 * e2 - x10
    x21 = e1 * x0
    x22 = 2.0 * e2 * e3 + x21
    x23 = x6 - x7
    x24 = x16 + x23 + x4
    x25 = x12 * x24 + x14 * x22 + x18 * x20
    x26 = 2.0 * e2 * e3 - x21
    x27 = x15 + x23 + x5
    x28 = x12 * x26 + x14 * x27 + x18 * x3
    x29 = x9 * (F2 + W2)
    x30 = x9 * (F3 + W3)
    x31 = x9 * (F1 + W1)
    x32 = x11 * x29 + x13 * x30 + x17 * x31
    x33 = x20 * x31 + x22 * x30 + x24 * x29
    x34 = x26 * x29 + x27 * x30 + x3 * x31
    x35 = x9 * (B13 * x32 + B23 * x33 + B33 * x34 + B34 * x19 + B35 * x25 + B36 * x28)
    x36 = x9 * (B12 * x32 + B22 * x33 + B23 * x34 + B24 * x19 + B25 * x25 + B26 * x28)
    x37 = x9 * (B11 * x32 + B12 * x33 + B13 * x34 + B14 * x19 + B15 * x25 + B16 * x28)
    x38 = (
        (1.0 / 2.0) * B14 * x32
        + (1.0 / 2.0) * B24 * x33
        + (1.0 / 2.0) * B34 * x34
        + (1.0 / 2.0) * B44 * x19
        + (1.0 / 2.0) * B45 * x25
        + (1.0 / 2.0) * B46 * x28
    )
    x39 = B15 * x32 + B25 * x33 + B35 * x34 + B45 * x19 + B55 * x25 + B56 * x28
    x40 = (1.0 / 2.0) * e2
    x41 = B16 * x32 + B26 * x33 + B36 * x34 + B46 * x19 + B56 * x25 + B66 * x28
    x42 = (1.0 / 2.0) * e3
    x43 = (1.0 / 2.0) * e0
    x44 = (1.0 / 2.0) * e1
    out[0] = x17 * x37 + x20 * x36 + x3 * x35
    out[1] = x11 * x37 + x24 * x36 + x26 * x35
    out[2] = x13 * x37 + x22 * x36 + x27 * x35
    out[3] = -e1 * x38 - x39 * x40 - x41 * x42
    out[4] = e0 * x38 - x39 * x42 + x40 * x41
    out[5] = e3 * x38 + x39 * x43 - x41 * x44
    out[6] = -e2 * x38 + x39 * x44 + x41 * x43


@njit(cache=True)
def slow_velocity(e, force, moment, params, out):
    """V_0 = B W, the twist (u, omega) without inertia, body frame.

    e: (4) e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (45) as listed above
    out: (6) filled with the result.
    143 operations, 35 temporaries.
    """
    e0 = e[0]
    e1 = e[1]
    e2 = e[2]
    e3 = e[3]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    M1 = moment[0]
    M2 = moment[1]
    M3 = moment[2]
    B11 = params[0]
    B12 = params[1]
    B13 = params[2]
    B14 = params[3]
    B15 = params[4]
    B16 = params[5]
    B22 = params[6]
    B23 = params[7]
    B24 = params[8]
    B25 = params[9]
    B26 = params[10]
    B33 = params[11]
    B34 = params[12]
    B35 = params[13]
    B36 = params[14]
    B44 = params[15]
    B45 = params[16]
    B46 = params[17]
    B55 = params[18]
    B56 = params[19]
    B66 = params[20]
    W1 = params[21]
    W2 = params[22]
    W3 = params[23]
    x0 = 2.0 * e0
    x1 = e3 * x0
    x2 = 2.0 * e1
    x3 = e2 * x2 + x1
    x4 = e2 * e2
    x5 = e3 * e3
    x6 = e0 * e0
    x7 = e1 * e1
    x8 = x6 + x7
    x9 = 1.0 / (x4 + x5 + x8)
    x10 = M2 * x9
    x11 = e2 * x0
    x12 = 2.0 * e1 * e3 - x11
    x13 = M3 * x9
    x14 = -x4
    x15 = -x5
    x16 = x14 + x15 + x8
    x17 = M1 * x9
    x18 = x10 * x3 + x12 * x13 + x16 * x17
    x19 = 2.0 * e1 * e2 - x1
    x20 = e1 * x0
    x21 = 2.0 * e2 * e3 + x20
    x22 = x6 - x7
    x23 = x15 + x22 + x4
    x24 = x10 * x23 + x13 * x21 + x17 * x19
    x25 = e3 * x2 + x11
    x26 = 2.0 * e2 * e3 - x20
    x27 = x14 + x22 + x5
    x28 = x10 * x26 + x13 * x27 + x17 * x25
    x29 = x9 * (F2 + W2)
    x30 = x9 * (F3 + W3)
    x31 = x9 * (F1 + W1)
    x32 = x12 * x30 + x16 * x31 + x29 * x3
    x33 = x19 * x31 + x21 * x30 + x23 * x29
    x34 = x25 * x31 + x26 * x29 + x27 * x30
    out[0] = B11 * x32 + B12 * x33 + B13 * x34 + B14 * x18 + B15 * x24 + B16 * x28
    out[1] = B12 * x32 + B22 * x33 + B23 * x34 + B24 * x18 + B25 * x24 + B26 * x28
    out[2] = B13 * x32 + B23 * x33 + B33 * x34 + B34 * x18 + B35 * x24 + B36 * x28
    out[3] = B14 * x32 + B24 * x33 + B34 * x34 + B44 * x18 + B45 * x24 + B46 * x28
    out[4] = B15 * x32 + B25 * x33 + B35 * x34 + B45 * x18 + B55 * x24 + B56 * x28
    out[5] = B16 * x32 + B26 * x33 + B36 * x34 + B46 * x18 + B56 * x24 + B66 * x28


@njit(cache=True)
def slow_wrench(e, force, moment, force_rate, moment_rate, params, out):
    """Force and moment in the inertial frame, for `rates`: those of the light less the
    inertial ones, M B W' + N(V_0). They do not contain the weight. The rates of the
    light's force and moment are those along `slow_velocity`, inertial frame.

    e: (4) e0, e1, e2, e3
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_rate: (3) Fdot1, Fdot2, Fdot3
    moment_rate: (3) Mdot1, Mdot2, Mdot3
    params: (45) as listed above
    out: (6) filled with the result.
    479 operations, 71 temporaries.
    """
    e0 = e[0]
    e1 = e[1]
    e2 = e[2]
    e3 = e[3]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    M1 = moment[0]
    M2 = moment[1]
    M3 = moment[2]
    Fdot1 = force_rate[0]
    Fdot2 = force_rate[1]
    Fdot3 = force_rate[2]
    Mdot1 = moment_rate[0]
    Mdot2 = moment_rate[1]
    Mdot3 = moment_rate[2]
    B11 = params[0]
    B12 = params[1]
    B13 = params[2]
    B14 = params[3]
    B15 = params[4]
    B16 = params[5]
    B22 = params[6]
    B23 = params[7]
    B24 = params[8]
    B25 = params[9]
    B26 = params[10]
    B33 = params[11]
    B34 = params[12]
    B35 = params[13]
    B36 = params[14]
    B44 = params[15]
    B45 = params[16]
    B46 = params[17]
    B55 = params[18]
    B56 = params[19]
    B66 = params[20]
    W1 = params[21]
    W2 = params[22]
    W3 = params[23]
    M11 = params[24]
    M12 = params[25]
    M13 = params[26]
    M14 = params[27]
    M15 = params[28]
    M16 = params[29]
    M22 = params[30]
    M23 = params[31]
    M24 = params[32]
    M25 = params[33]
    M26 = params[34]
    M33 = params[35]
    M34 = params[36]
    M35 = params[37]
    M36 = params[38]
    M44 = params[39]
    M45 = params[40]
    M46 = params[41]
    M55 = params[42]
    M56 = params[43]
    M66 = params[44]
    x0 = 2.0 * e0
    x1 = e2 * x0
    x2 = 2.0 * e1
    x3 = e3 * x2 + x1
    x4 = e2 * e2
    x5 = e3 * e3
    x6 = e0 * e0
    x7 = e1 * e1
    x8 = x6 + x7
    x9 = 1.0 / (x4 + x5 + x8)
    x10 = e3 * x0
    x11 = e2 * x2 + x10
    x12 = M2 * x9
    x13 = 2.0 * e1 * e3 - x1
    x14 = M3 * x9
    x15 = -x4
    x16 = -x5
    x17 = x15 + x16 + x8
    x18 = M1 * x9
    x19 = x11 * x12 + x13 * x14 + x17 * x18
    x20 = 2.0 * e1 * e2 - x10
    x21 = e1 * x0
    x22 = 2.0 * e2 * e3 + x21
    x23 = x6 - x7
    x24 = x16 + x23 + x4
    x25 = x12 * x24 + x14 * x22 + x18 * x20
    x26 = 2.0 * e2 * e3 - x21
    x27 = x15 + x23 + x5
    x28 = x12 * x26 + x14 * x27 + x18 * x3
    x29 = x9 * (F2 + W2)
    x30 = x9 * (F3 + W3)
    x31 = x9 * (F1 + W1)
    x32 = x11 * x29 + x13 * x30 + x17 * x31
    x33 = x20 * x31 + x22 * x30 + x24 * x29
    x34 = x26 * x29 + x27 * x30 + x3 * x31
    x35 = B14 * x32 + B24 * x33 + B34 * x34 + B44 * x19 + B45 * x25 + B46 * x28
    x36 = B11 * x32 + B12 * x33 + B13 * x34 + B14 * x19 + B15 * x25 + B16 * x28
    x37 = B12 * x32 + B22 * x33 + B23 * x34 + B24 * x19 + B25 * x25 + B26 * x28
    x38 = B13 * x32 + B23 * x33 + B33 * x34 + B34 * x19 + B35 * x25 + B36 * x28
    x39 = B15 * x32 + B25 * x33 + B35 * x34 + B45 * x19 + B55 * x25 + B56 * x28
    x40 = B16 * x32 + B26 * x33 + B36 * x34 + B46 * x19 + B56 * x25 + B66 * x28
    x41 = M12 * x36 + M22 * x37 + M23 * x38 + M24 * x35 + M25 * x39 + M26 * x40
    x42 = M11 * x36 + M12 * x37 + M13 * x38 + M14 * x35 + M15 * x39 + M16 * x40
    x43 = Mdot2 * x9
    x44 = Mdot3 * x9
    x45 = Mdot1 * x9
    x46 = x11 * x43 + x13 * x44 + x17 * x45 + x25 * x40 - x28 * x39
    x47 = -x19 * x40 + x20 * x45 + x22 * x44 + x24 * x43 + x28 * x35
    x48 = x19 * x39 - x25 * x35 + x26 * x43 + x27 * x44 + x3 * x45
    x49 = Fdot2 * x9
    x50 = Fdot3 * x9
    x51 = Fdot1 * x9
    x52 = x11 * x49 + x13 * x50 + x17 * x51 + x33 * x40 - x34 * x39
    x53 = x20 * x51 + x22 * x50 + x24 * x49 - x32 * x40 + x34 * x35
    x54 = x26 * x49 + x27 * x50 + x3 * x51 + x32 * x39 - x33 * x35
    x55 = B11 * x52 + B12 * x53 + B13 * x54 + B14 * x46 + B15 * x47 + B16 * x48
    x56 = B12 * x52 + B22 * x53 + B23 * x54 + B24 * x46 + B25 * x47 + B26 * x48
    x57 = B13 * x52 + B23 * x53 + B33 * x54 + B34 * x46 + B35 * x47 + B36 * x48
    x58 = B14 * x52 + B24 * x53 + B34 * x54 + B44 * x46 + B45 * x47 + B46 * x48
    x59 = B15 * x52 + B25 * x53 + B35 * x54 + B45 * x46 + B55 * x47 + B56 * x48
    x60 = B16 * x52 + B26 * x53 + B36 * x54 + B46 * x46 + B56 * x47 + B66 * x48
    x61 = x9 * (
        -M13 * x55
        - M23 * x56
        - M33 * x57
        - M34 * x58
        - M35 * x59
        - M36 * x60
        - x35 * x41
        + x39 * x42
    )
    x62 = M13 * x36 + M23 * x37 + M33 * x38 + M34 * x35 + M35 * x39 + M36 * x40
    x63 = x9 * (
        -M12 * x55
        - M22 * x56
        - M23 * x57
        - M24 * x58
        - M25 * x59
        - M26 * x60
        + x35 * x62
        - x40 * x42
    )
    x64 = x9 * (
        -M11 * x55
        - M12 * x56
        - M13 * x57
        - M14 * x58
        - M15 * x59
        - M16 * x60
        - x39 * x62
        + x40 * x41
    )
    x65 = M15 * x36 + M25 * x37 + M35 * x38 + M45 * x35 + M55 * x39 + M56 * x40
    x66 = M14 * x36 + M24 * x37 + M34 * x38 + M44 * x35 + M45 * x39 + M46 * x40
    x67 = x9 * (
        -M16 * x55
        - M26 * x56
        - M36 * x57
        - M46 * x58
        - M56 * x59
        - M66 * x60
        - x35 * x65
        - x36 * x41
        + x37 * x42
        + x39 * x66
    )
    x68 = M16 * x36 + M26 * x37 + M36 * x38 + M46 * x35 + M56 * x39 + M66 * x40
    x69 = x9 * (
        -M15 * x55
        - M25 * x56
        - M35 * x57
        - M45 * x58
        - M55 * x59
        - M56 * x60
        + x35 * x68
        + x36 * x62
        - x38 * x42
        - x40 * x66
    )
    x70 = x9 * (
        -M14 * x55
        - M24 * x56
        - M34 * x57
        - M44 * x58
        - M45 * x59
        - M46 * x60
        - x37 * x62
        + x38 * x41
        - x39 * x68
        + x40 * x65
    )
    out[0] = F1 + x17 * x64 + x20 * x63 + x3 * x61
    out[1] = F2 + x11 * x64 + x24 * x63 + x26 * x61
    out[2] = F3 + x13 * x64 + x22 * x63 + x27 * x61
    out[3] = M1 + x17 * x70 + x20 * x69 + x3 * x67
    out[4] = M2 + x11 * x70 + x24 * x69 + x26 * x67
    out[5] = M3 + x13 * x70 + x22 * x69 + x27 * x67


@njit(cache=True)
def matched_start(released, force, moment, params, out):
    """Displacement B M (V - V_0) from the release (position, ..., velocities) to the start
    of the slow motion: translation and rotation vector, body frame.

    released: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (45) as listed above
    out: (6) filled with the result.
    305 operations, 47 temporaries.
    """
    e0 = released[3]
    e1 = released[4]
    e2 = released[5]
    e3 = released[6]
    v1 = released[7]
    v2 = released[8]
    v3 = released[9]
    omega1 = released[10]
    omega2 = released[11]
    omega3 = released[12]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    M1 = moment[0]
    M2 = moment[1]
    M3 = moment[2]
    B11 = params[0]
    B12 = params[1]
    B13 = params[2]
    B14 = params[3]
    B15 = params[4]
    B16 = params[5]
    B22 = params[6]
    B23 = params[7]
    B24 = params[8]
    B25 = params[9]
    B26 = params[10]
    B33 = params[11]
    B34 = params[12]
    B35 = params[13]
    B36 = params[14]
    B44 = params[15]
    B45 = params[16]
    B46 = params[17]
    B55 = params[18]
    B56 = params[19]
    B66 = params[20]
    W1 = params[21]
    W2 = params[22]
    W3 = params[23]
    M11 = params[24]
    M12 = params[25]
    M13 = params[26]
    M14 = params[27]
    M15 = params[28]
    M16 = params[29]
    M22 = params[30]
    M23 = params[31]
    M24 = params[32]
    M25 = params[33]
    M26 = params[34]
    M33 = params[35]
    M34 = params[36]
    M35 = params[37]
    M36 = params[38]
    M44 = params[39]
    M45 = params[40]
    M46 = params[41]
    M55 = params[42]
    M56 = params[43]
    M66 = params[44]
    x0 = 2.0 * e0
    x1 = e3 * x0
    x2 = 2.0 * e1
    x3 = e2 * x2 + x1
    x4 = e2 * e2
    x5 = e3 * e3
    x6 = e0 * e0
    x7 = e1 * e1
    x8 = x6 + x7
    x9 = 1.0 / (x4 + x5 + x8)
    x10 = M2 * x9
    x11 = e2 * x0
    x12 = 2.0 * e1 * e3 - x11
    x13 = M3 * x9
    x14 = -x4
    x15 = -x5
    x16 = x14 + x15 + x8
    x17 = M1 * x9
    x18 = x10 * x3 + x12 * x13 + x16 * x17
    x19 = 2.0 * e1 * e2 - x1
    x20 = e1 * x0
    x21 = 2.0 * e2 * e3 + x20
    x22 = x6 - x7
    x23 = x15 + x22 + x4
    x24 = x10 * x23 + x13 * x21 + x17 * x19
    x25 = e3 * x2 + x11
    x26 = 2.0 * e2 * e3 - x20
    x27 = x14 + x22 + x5
    x28 = x10 * x26 + x13 * x27 + x17 * x25
    x29 = x9 * (F2 + W2)
    x30 = x9 * (F3 + W3)
    x31 = x9 * (F1 + W1)
    x32 = x12 * x30 + x16 * x31 + x29 * x3
    x33 = x19 * x31 + x21 * x30 + x23 * x29
    x34 = x25 * x31 + x26 * x29 + x27 * x30
    x35 = -B14 * x32 - B24 * x33 - B34 * x34 - B44 * x18 - B45 * x24 - B46 * x28 + omega1
    x36 = -B15 * x32 - B25 * x33 - B35 * x34 - B45 * x18 - B55 * x24 - B56 * x28 + omega2
    x37 = -B16 * x32 - B26 * x33 - B36 * x34 - B46 * x18 - B56 * x24 - B66 * x28 + omega3
    x38 = (
        -B11 * x32
        - B12 * x33
        - B13 * x34
        - B14 * x18
        - B15 * x24
        - B16 * x28
        + v1 * x16 * x9
        + v2 * x3 * x9
        + v3 * x12 * x9
    )
    x39 = (
        -B12 * x32
        - B22 * x33
        - B23 * x34
        - B24 * x18
        - B25 * x24
        - B26 * x28
        + v1 * x19 * x9
        + v2 * x23 * x9
        + v3 * x21 * x9
    )
    x40 = (
        -B13 * x32
        - B23 * x33
        - B33 * x34
        - B34 * x18
        - B35 * x24
        - B36 * x28
        + v1 * x25 * x9
        + v2 * x26 * x9
        + v3 * x27 * x9
    )
    x41 = M11 * x38 + M12 * x39 + M13 * x40 + M14 * x35 + M15 * x36 + M16 * x37
    x42 = M12 * x38 + M22 * x39 + M23 * x40 + M24 * x35 + M25 * x36 + M26 * x37
    x43 = M13 * x38 + M23 * x39 + M33 * x40 + M34 * x35 + M35 * x36 + M36 * x37
    x44 = M14 * x38 + M24 * x39 + M34 * x40 + M44 * x35 + M45 * x36 + M46 * x37
    x45 = M15 * x38 + M25 * x39 + M35 * x40 + M45 * x35 + M55 * x36 + M56 * x37
    x46 = M16 * x38 + M26 * x39 + M36 * x40 + M46 * x35 + M56 * x36 + M66 * x37
    out[0] = B11 * x41 + B12 * x42 + B13 * x43 + B14 * x44 + B15 * x45 + B16 * x46
    out[1] = B12 * x41 + B22 * x42 + B23 * x43 + B24 * x44 + B25 * x45 + B26 * x46
    out[2] = B13 * x41 + B23 * x42 + B33 * x43 + B34 * x44 + B35 * x45 + B36 * x46
    out[3] = B14 * x41 + B24 * x42 + B34 * x43 + B44 * x44 + B45 * x45 + B46 * x46
    out[4] = B15 * x41 + B25 * x42 + B35 * x43 + B45 * x44 + B55 * x45 + B56 * x46
    out[5] = B16 * x41 + B26 * x42 + B36 * x43 + B46 * x44 + B56 * x45 + B66 * x46


@njit(cache=True)
def rates(t, state, force, moment, force_gradient, moment_gradient, mobility, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(t, state, force, moment, params, out)
