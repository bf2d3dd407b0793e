"""Scaled model (4.17): translation and rotation of a rigid body.

Made by `python -m derivation` from derivation/multiscale.py and derivation/rigid_body.py; do not edit.
SymPy 1.14.0. 424 operations, 119 temporaries.

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
* [4] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [5] `beta_w` [N m s] rotational drag coefficient, (2.15)
* [6] `a2` [1] scaling factor of the generalised active forces, (4.12)
* [7] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [8] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [9] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3", "v1", "v2", "v3", "omega1", "omega2", "omega3")
PARAMS = ("m", "I1", "I2", "I3", "beta_v", "beta_w", "a2", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ("force", "moment", "force_gradient", "moment_gradient")


@njit(cache=True)
def rhs(state, force, moment, params, out):
    """Rate of change of the state.

    state: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (10) as listed above
    out: (13) filled with the result.
    122 operations, 26 temporaries.
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
    m = params[0]
    I1 = params[1]
    I2 = params[2]
    I3 = params[3]
    beta_v = params[4]
    beta_w = params[5]
    a2 = params[6]
    W1 = params[7]
    W2 = params[8]
    W3 = params[9]
    x0 = (1.0 / 2.0) * omega1
    x1 = (1.0 / 2.0) * e2
    x2 = (1.0 / 2.0) * e3
    x3 = (1.0 / 2.0) * e0
    x4 = (1.0 / 2.0) * e1
    x5 = a2 / m
    x6 = omega2 * omega3
    x7 = 2.0 * e0
    x8 = e3 * x7
    x9 = 2.0 * e1
    x10 = e2 * e2
    x11 = e3 * e3
    x12 = e0 * e0
    x13 = e1 * e1
    x14 = x12 + x13
    x15 = 1.0 / (x10 + x11 + x14)
    x16 = M2 * x15
    x17 = e2 * x7
    x18 = M3 * x15
    x19 = -x10
    x20 = -x11
    x21 = M1 * x15
    x22 = omega1 * omega3
    x23 = e1 * x7
    x24 = x12 - x13
    x25 = omega1 * omega2
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = -e1 * x0 - omega2 * x1 - omega3 * x2
    out[4] = e0 * x0 - omega2 * x2 + omega3 * x1
    out[5] = e3 * x0 + omega2 * x3 - omega3 * x4
    out[6] = -e2 * x0 + omega2 * x4 + omega3 * x3
    out[7] = x5 * (F1 + W1 - beta_v * v1)
    out[8] = x5 * (F2 + W2 - beta_v * v2)
    out[9] = x5 * (F3 + W3 - beta_v * v3)
    out[10] = (
        I2 * x6
        - I3 * x6
        + a2
        * (
            -beta_w * omega1
            + x16 * (e2 * x9 + x8)
            + x18 * (2.0 * e1 * e3 - x17)
            + x21 * (x14 + x19 + x20)
        )
    ) / I1
    out[11] = (
        -I1 * x22
        + I3 * x22
        + a2
        * (
            -beta_w * omega2
            + x16 * (x10 + x20 + x24)
            + x18 * (2.0 * e2 * e3 + x23)
            + x21 * (2.0 * e1 * e2 - x8)
        )
    ) / I2
    out[12] = (
        I1 * x25
        - I2 * x25
        + a2
        * (
            -beta_w * omega3
            + x16 * (2.0 * e2 * e3 - x23)
            + x18 * (x11 + x19 + x24)
            + x21 * (e3 * x9 + x17)
        )
    ) / I3


@njit(cache=True)
def jacobian(state, force, moment, force_gradient, moment_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    state: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    params: (10) as listed above
    out: (13, 13) filled with the result.
    302 operations, 93 temporaries.
    """
    e0 = state[3]
    e1 = state[4]
    e2 = state[5]
    e3 = state[6]
    omega1 = state[10]
    omega2 = state[11]
    omega3 = state[12]
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
    a2 = params[6]
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
    x14 = -beta_v * x13
    x15 = 2.0 * e0
    x16 = e3 * x15
    x17 = 2.0 * e1
    x18 = e2 * x17 + x16
    x19 = e2 * e2
    x20 = e3 * e3
    x21 = e0 * e0
    x22 = e1 * e1
    x23 = x21 + x22
    x24 = x19 + x20 + x23
    x25 = 1.0 / x24
    x26 = 1.0 / I1
    x27 = a2 * x26
    x28 = x25 * x27
    x29 = x18 * x28
    x30 = e2 * x15
    x31 = 2.0 * e1 * e3 - x30
    x32 = x28 * x31
    x33 = -x19
    x34 = -x20
    x35 = x23 + x33 + x34
    x36 = x28 * x35
    x37 = 1.0 / (x24 * x24)
    x38 = x15 * x37
    x39 = M1 * x35
    x40 = M2 * x18
    x41 = M3 * x31
    x42 = M1 * x25
    x43 = x15 * x42
    x44 = M2 * x25
    x45 = 2.0 * e3
    x46 = x44 * x45
    x47 = 2.0 * e2
    x48 = x25 * x47
    x49 = M3 * x48
    x50 = -x43 - x46 + x49
    x51 = x17 * x37
    x52 = M1 * x48
    x53 = x17 * x44
    x54 = M3 * x25
    x55 = x15 * x54
    x56 = x37 * x47
    x57 = x37 * x45
    x58 = x15 * x44
    x59 = x17 * x54
    x60 = x42 * x45
    x61 = -x58 - x59 + x60
    x62 = -I3 * omega3
    x63 = I2 * omega2
    x64 = 2.0 * e1 * e2 - x16
    x65 = 1.0 / I2
    x66 = a2 * x65
    x67 = x25 * x66
    x68 = x64 * x67
    x69 = e1 * x15
    x70 = e3 * x47 + x69
    x71 = x67 * x70
    x72 = x21 - x22
    x73 = x19 + x34 + x72
    x74 = x67 * x73
    x75 = M1 * x64
    x76 = M2 * x73
    x77 = M3 * x70
    x78 = -x52 + x53 - x55
    x79 = M2 * x48 + x17 * x42 + x45 * x54
    x80 = I1 * omega1
    x81 = e3 * x17 + x30
    x82 = 1.0 / I3
    x83 = a2 * x82
    x84 = x25 * x83
    x85 = x81 * x84
    x86 = 2.0 * e2 * e3 - x69
    x87 = x84 * x86
    x88 = x20 + x33 + x72
    x89 = x84 * x88
    x90 = M1 * x81
    x91 = M2 * x86
    x92 = M3 * x88
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
    out[7, 0] = DF11 * x13
    out[7, 1] = DF12 * x13
    out[7, 2] = DF13 * x13
    out[7, 3] = 0.0
    out[7, 4] = 0.0
    out[7, 5] = 0.0
    out[7, 6] = 0.0
    out[7, 7] = x14
    out[7, 8] = 0.0
    out[7, 9] = 0.0
    out[7, 10] = 0.0
    out[7, 11] = 0.0
    out[7, 12] = 0.0
    out[8, 0] = DF21 * x13
    out[8, 1] = DF22 * x13
    out[8, 2] = DF23 * x13
    out[8, 3] = 0.0
    out[8, 4] = 0.0
    out[8, 5] = 0.0
    out[8, 6] = 0.0
    out[8, 7] = 0.0
    out[8, 8] = x14
    out[8, 9] = 0.0
    out[8, 10] = 0.0
    out[8, 11] = 0.0
    out[8, 12] = 0.0
    out[9, 0] = DF31 * x13
    out[9, 1] = DF32 * x13
    out[9, 2] = DF33 * x13
    out[9, 3] = 0.0
    out[9, 4] = 0.0
    out[9, 5] = 0.0
    out[9, 6] = 0.0
    out[9, 7] = 0.0
    out[9, 8] = 0.0
    out[9, 9] = x14
    out[9, 10] = 0.0
    out[9, 11] = 0.0
    out[9, 12] = 0.0
    out[10, 0] = DM11 * x36 + DM21 * x29 + DM31 * x32
    out[10, 1] = DM12 * x36 + DM22 * x29 + DM32 * x32
    out[10, 2] = DM13 * x36 + DM23 * x29 + DM33 * x32
    out[10, 3] = x27 * (-x38 * x39 - x38 * x40 - x38 * x41 - x50)
    out[10, 4] = x27 * (
        2.0 * M1 * e1 * x25
        + 2.0 * M2 * e2 * x25
        + 2.0 * M3 * e3 * x25
        - x39 * x51
        - x40 * x51
        - x41 * x51
    )
    out[10, 5] = x27 * (-x39 * x56 - x40 * x56 - x41 * x56 - x52 + x53 - x55)
    out[10, 6] = x27 * (-x39 * x57 - x40 * x57 - x41 * x57 - x61)
    out[10, 7] = 0.0
    out[10, 8] = 0.0
    out[10, 9] = 0.0
    out[10, 10] = -beta_w * x27
    out[10, 11] = x26 * (I2 * omega3 + x62)
    out[10, 12] = x26 * (-I3 * omega2 + x63)
    out[11, 0] = DM11 * x68 + DM21 * x74 + DM31 * x71
    out[11, 1] = DM12 * x68 + DM22 * x74 + DM32 * x71
    out[11, 2] = DM13 * x68 + DM23 * x74 + DM33 * x71
    out[11, 3] = x66 * (-x38 * x75 - x38 * x76 - x38 * x77 - x61)
    out[11, 4] = x66 * (-x51 * x75 - x51 * x76 - x51 * x77 - x78)
    out[11, 5] = x66 * (-x56 * x75 - x56 * x76 - x56 * x77 + x79)
    out[11, 6] = x66 * (-x43 - x46 + x49 - x57 * x75 - x57 * x76 - x57 * x77)
    out[11, 7] = 0.0
    out[11, 8] = 0.0
    out[11, 9] = 0.0
    out[11, 10] = x65 * (-I1 * omega3 - x62)
    out[11, 11] = -beta_w * x66
    out[11, 12] = x65 * (I3 * omega1 - x80)
    out[12, 0] = DM11 * x85 + DM21 * x87 + DM31 * x89
    out[12, 1] = DM12 * x85 + DM22 * x87 + DM32 * x89
    out[12, 2] = DM13 * x85 + DM23 * x87 + DM33 * x89
    out[12, 3] = x83 * (-x38 * x90 - x38 * x91 - x38 * x92 - x78)
    out[12, 4] = x83 * (-x51 * x90 - x51 * x91 - x51 * x92 - x58 - x59 + x60)
    out[12, 5] = x83 * (-x50 - x56 * x90 - x56 * x91 - x56 * x92)
    out[12, 6] = x83 * (-x57 * x90 - x57 * x91 - x57 * x92 + x79)
    out[12, 7] = 0.0
    out[12, 8] = 0.0
    out[12, 9] = 0.0
    out[12, 10] = x82 * (I1 * omega2 - x63)
    out[12, 11] = x82 * (-I2 * omega1 + x80)
    out[12, 12] = -beta_w * x83


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, moment, params, out)
