"""Scaled model (4.17): translation.

Made by `python -m derivation` from derivation/multiscale.py and derivation/rigid_body.py and derivation/drag.py; do not edit.
SymPy 1.14.0. 53 operations, 8 temporaries.

No rotation: for a bead on which the light exerts no moment.

State:

* [0] `q1` [m] position of the bead's centre along N1, (2.1)
* [1] `q2` [m] position of the bead's centre along N2, (2.1)
* [2] `q3` [m] position of the bead's centre along N3, (2.1)
* [3] `v1` [m/s] velocity of the bead's centre along N1, (2.2)
* [4] `v2` [m/s] velocity of the bead's centre along N2, (2.2)
* [5] `v3` [m/s] velocity of the bead's centre along N3, (2.2)

Parameters:

* [0] `m` [kg] mass of the bead, (2.3)
* [1] `a2` [1] scaling factor of the generalised active forces, (4.12)
* [2] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [3] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [4] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3", "v1", "v2", "v3")
PARAMS = ("m", "a2", "W1", "W2", "W3")
RHS_INPUTS = ("force", "mobility")
JACOBIAN_INPUTS = ("force", "mobility", "force_gradient", "mobility_gradient")
LINEAR_DRAG = True


@njit(cache=True)
def rhs(t, state, force, mobility, params, out):
    """Rate of change of the state.

    t: time since release [s]
    state: (6) q1, q2, q3, v1, v2, v3
    force: (3) F1, F2, F3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    params: (5) m, a2, W1, W2, W3
    out: (6) filled with the result.
    14 operations, 2 temporaries.
    """
    v1 = state[3]
    v2 = state[4]
    v3 = state[5]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    b_parallel = mobility[0]
    b_perpendicular = mobility[1]
    m = params[0]
    a2 = params[1]
    W1 = params[2]
    W2 = params[3]
    W3 = params[4]
    x0 = 1.0 / b_parallel
    x1 = a2 / m
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = x1 * (F1 + W1 - v1 * x0)
    out[4] = x1 * (F2 + W2 - v2 * x0)
    out[5] = x1 * (F3 + W3 - v3 / b_perpendicular)


@njit(cache=True)
def jacobian(t, state, force, mobility, force_gradient, mobility_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    t: time since release [s]
    state: (6) q1, q2, q3, v1, v2, v3
    force: (3) F1, F2, F3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    mobility_gradient: (5, 3) as listed above
    params: (5) m, a2, W1, W2, W3
    out: (6, 6) filled with the result.
    39 operations, 6 temporaries.
    """
    v1 = state[3]
    v2 = state[4]
    v3 = state[5]
    b_parallel = mobility[0]
    b_perpendicular = mobility[1]
    DF11 = force_gradient[0, 0]
    DF12 = force_gradient[0, 1]
    DF13 = force_gradient[0, 2]
    DF21 = force_gradient[1, 0]
    DF22 = force_gradient[1, 1]
    DF23 = force_gradient[1, 2]
    DF31 = force_gradient[2, 0]
    DF32 = force_gradient[2, 1]
    DF33 = force_gradient[2, 2]
    Db11 = mobility_gradient[0, 0]
    Db12 = mobility_gradient[0, 1]
    Db13 = mobility_gradient[0, 2]
    Db21 = mobility_gradient[1, 0]
    Db22 = mobility_gradient[1, 1]
    Db23 = mobility_gradient[1, 2]
    m = params[0]
    a2 = params[1]
    x0 = a2 / m
    x1 = x0 / (b_parallel * b_parallel)
    x2 = v1 * x1
    x3 = -x0 / b_parallel
    x4 = v2 * x1
    x5 = v3 * x0 / (b_perpendicular * b_perpendicular)
    out[0, 0] = 0.0
    out[0, 1] = 0.0
    out[0, 2] = 0.0
    out[0, 3] = 1.0
    out[0, 4] = 0.0
    out[0, 5] = 0.0
    out[1, 0] = 0.0
    out[1, 1] = 0.0
    out[1, 2] = 0.0
    out[1, 3] = 0.0
    out[1, 4] = 1.0
    out[1, 5] = 0.0
    out[2, 0] = 0.0
    out[2, 1] = 0.0
    out[2, 2] = 0.0
    out[2, 3] = 0.0
    out[2, 4] = 0.0
    out[2, 5] = 1.0
    out[3, 0] = DF11 * x0 + Db11 * x2
    out[3, 1] = DF12 * x0 + Db12 * x2
    out[3, 2] = DF13 * x0 + Db13 * x2
    out[3, 3] = x3
    out[3, 4] = 0.0
    out[3, 5] = 0.0
    out[4, 0] = DF21 * x0 + Db11 * x4
    out[4, 1] = DF22 * x0 + Db12 * x4
    out[4, 2] = DF23 * x0 + Db13 * x4
    out[4, 3] = 0.0
    out[4, 4] = x3
    out[4, 5] = 0.0
    out[5, 0] = DF31 * x0 + Db21 * x5
    out[5, 1] = DF32 * x0 + Db22 * x5
    out[5, 2] = DF33 * x0 + Db23 * x5
    out[5, 3] = 0.0
    out[5, 4] = 0.0
    out[5, 5] = -x0 / b_perpendicular


@njit(cache=True)
def rates(t, state, force, moment, force_gradient, moment_gradient, mobility, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(t, state, force, mobility, params, out)


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
    jacobian(t, state, force, mobility, force_gradient, mobility_gradient, params, out)
