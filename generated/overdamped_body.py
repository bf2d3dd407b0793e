"""Overdamped model of a body of any shape: V = B W.

Made by `python -m derivation` from derivation/body_motion.py; do not edit.
SymPy 1.14.0. 192 operations, 45 temporaries.

B is the inverse of the drag.
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
    params: (24) as listed above
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
def rates(t, state, force, moment, force_gradient, moment_gradient, mobility, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(t, state, force, moment, params, out)
