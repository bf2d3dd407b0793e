"""Full model (A.25): translation and rotation of a sphere.

Made by `python -m derivation` from derivation/rigid_body.py; do not edit.
SymPy 1.14.0. 373 operations, 108 temporaries.

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
* [2] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [3] `beta_w` [N m s] rotational drag coefficient, (2.15)
* [4] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [5] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [6] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3", "e0", "e1", "e2", "e3", "v1", "v2", "v3", "omega1", "omega2", "omega3")
PARAMS = ("m", "I", "beta_v", "beta_w", "W1", "W2", "W3")
RHS_INPUTS = ("force", "moment")
JACOBIAN_INPUTS = ("force", "moment", "force_gradient", "moment_gradient")


@njit(cache=True)
def rhs(state, force, moment, params, out):
    """Rate of change of the state.

    state: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    params: (7) m, I, beta_v, beta_w, W1, W2, W3
    out: (13) filled with the result.
    105 operations, 24 temporaries.
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
    I = params[1]
    beta_v = params[2]
    beta_w = params[3]
    W1 = params[4]
    W2 = params[5]
    W3 = params[6]
    x0 = (1.0 / 2.0) * omega1
    x1 = (1.0 / 2.0) * e2
    x2 = (1.0 / 2.0) * e3
    x3 = (1.0 / 2.0) * e0
    x4 = (1.0 / 2.0) * e1
    x5 = 1.0 / m
    x6 = 1.0 / I
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
    x22 = e1 * x7
    x23 = x12 - x13
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
    out[10] = x6 * (
        -beta_w * omega1
        + x16 * (e2 * x9 + x8)
        + x18 * (2.0 * e1 * e3 - x17)
        + x21 * (x14 + x19 + x20)
    )
    out[11] = x6 * (
        -beta_w * omega2
        + x16 * (x10 + x20 + x23)
        + x18 * (2.0 * e2 * e3 + x22)
        + x21 * (2.0 * e1 * e2 - x8)
    )
    out[12] = x6 * (
        -beta_w * omega3
        + x16 * (2.0 * e2 * e3 - x22)
        + x18 * (x11 + x19 + x23)
        + x21 * (e3 * x9 + x17)
    )


@njit(cache=True)
def jacobian(state, force, moment, force_gradient, moment_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    state: (13) as listed above
    force: (3) F1, F2, F3
    moment: (3) M1, M2, M3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    moment_gradient: (3, 3) DM11, DM12, DM13, DM21, DM22, DM23, DM31, DM32, DM33
    params: (7) m, I, beta_v, beta_w, W1, W2, W3
    out: (13, 13) filled with the result.
    268 operations, 84 temporaries.
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
    I = params[1]
    beta_v = params[2]
    beta_w = params[3]
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
    x14 = -beta_v * x13
    x15 = 2.0 * e0
    x16 = e3 * x15
    x17 = 2.0 * e1
    x18 = e2 * x17 + x16
    x19 = 1.0 / I
    x20 = e2 * e2
    x21 = e3 * e3
    x22 = e0 * e0
    x23 = e1 * e1
    x24 = x22 + x23
    x25 = x20 + x21 + x24
    x26 = 1.0 / x25
    x27 = x19 * x26
    x28 = x18 * x27
    x29 = e2 * x15
    x30 = 2.0 * e1 * e3 - x29
    x31 = x27 * x30
    x32 = -x20
    x33 = -x21
    x34 = x24 + x32 + x33
    x35 = x27 * x34
    x36 = 1.0 / (x25 * x25)
    x37 = x15 * x36
    x38 = M1 * x34
    x39 = M2 * x18
    x40 = M3 * x30
    x41 = M1 * x26
    x42 = x15 * x41
    x43 = M2 * x26
    x44 = 2.0 * e3
    x45 = x43 * x44
    x46 = 2.0 * e2
    x47 = x26 * x46
    x48 = M3 * x47
    x49 = -x42 - x45 + x48
    x50 = x17 * x36
    x51 = M1 * x47
    x52 = x17 * x43
    x53 = M3 * x26
    x54 = x15 * x53
    x55 = x36 * x46
    x56 = x36 * x44
    x57 = x15 * x43
    x58 = x17 * x53
    x59 = x41 * x44
    x60 = -x57 - x58 + x59
    x61 = -beta_w * x19
    x62 = 2.0 * e1 * e2 - x16
    x63 = x27 * x62
    x64 = e1 * x15
    x65 = e3 * x46 + x64
    x66 = x27 * x65
    x67 = x22 - x23
    x68 = x20 + x33 + x67
    x69 = x27 * x68
    x70 = M1 * x62
    x71 = M2 * x68
    x72 = M3 * x65
    x73 = -x51 + x52 - x54
    x74 = M2 * x47 + x17 * x41 + x44 * x53
    x75 = e3 * x17 + x29
    x76 = x27 * x75
    x77 = 2.0 * e2 * e3 - x64
    x78 = x27 * x77
    x79 = x21 + x32 + x67
    x80 = x27 * x79
    x81 = M1 * x75
    x82 = M2 * x77
    x83 = M3 * x79
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
    out[10, 0] = DM11 * x35 + DM21 * x28 + DM31 * x31
    out[10, 1] = DM12 * x35 + DM22 * x28 + DM32 * x31
    out[10, 2] = DM13 * x35 + DM23 * x28 + DM33 * x31
    out[10, 3] = x19 * (-x37 * x38 - x37 * x39 - x37 * x40 - x49)
    out[10, 4] = x19 * (
        2.0 * M1 * e1 * x26
        + 2.0 * M2 * e2 * x26
        + 2.0 * M3 * e3 * x26
        - x38 * x50
        - x39 * x50
        - x40 * x50
    )
    out[10, 5] = x19 * (-x38 * x55 - x39 * x55 - x40 * x55 - x51 + x52 - x54)
    out[10, 6] = x19 * (-x38 * x56 - x39 * x56 - x40 * x56 - x60)
    out[10, 7] = 0.0
    out[10, 8] = 0.0
    out[10, 9] = 0.0
    out[10, 10] = x61
    out[10, 11] = 0.0
    out[10, 12] = 0.0
    out[11, 0] = DM11 * x63 + DM21 * x69 + DM31 * x66
    out[11, 1] = DM12 * x63 + DM22 * x69 + DM32 * x66
    out[11, 2] = DM13 * x63 + DM23 * x69 + DM33 * x66
    out[11, 3] = x19 * (-x37 * x70 - x37 * x71 - x37 * x72 - x60)
    out[11, 4] = x19 * (-x50 * x70 - x50 * x71 - x50 * x72 - x73)
    out[11, 5] = x19 * (-x55 * x70 - x55 * x71 - x55 * x72 + x74)
    out[11, 6] = x19 * (-x42 - x45 + x48 - x56 * x70 - x56 * x71 - x56 * x72)
    out[11, 7] = 0.0
    out[11, 8] = 0.0
    out[11, 9] = 0.0
    out[11, 10] = 0.0
    out[11, 11] = x61
    out[11, 12] = 0.0
    out[12, 0] = DM11 * x76 + DM21 * x78 + DM31 * x80
    out[12, 1] = DM12 * x76 + DM22 * x78 + DM32 * x80
    out[12, 2] = DM13 * x76 + DM23 * x78 + DM33 * x80
    out[12, 3] = x19 * (-x37 * x81 - x37 * x82 - x37 * x83 - x73)
    out[12, 4] = x19 * (-x50 * x81 - x50 * x82 - x50 * x83 - x57 - x58 + x59)
    out[12, 5] = x19 * (-x49 - x55 * x81 - x55 * x82 - x55 * x83)
    out[12, 6] = x19 * (-x56 * x81 - x56 * x82 - x56 * x83 + x74)
    out[12, 7] = 0.0
    out[12, 8] = 0.0
    out[12, 9] = 0.0
    out[12, 10] = 0.0
    out[12, 11] = 0.0
    out[12, 12] = x61


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, moment, params, out)
