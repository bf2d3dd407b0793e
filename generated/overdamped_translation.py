"""Overdamped model (5.2): translation.

Made by `python -m derivation` from derivation/drag.py; do not edit.
SymPy 1.14.0. 36 operations, 3 temporaries.

No rotation: for a bead on which the light exerts no moment.

State:

* [0] `q1` [m] position of the bead's centre along N1, (2.1)
* [1] `q2` [m] position of the bead's centre along N2, (2.1)
* [2] `q3` [m] position of the bead's centre along N3, (2.1)

Parameters:

* [0] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [1] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [2] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3")
PARAMS = ("W1", "W2", "W3")
RHS_INPUTS = ("force", "mobility")
JACOBIAN_INPUTS = ("force", "mobility", "force_gradient", "mobility_gradient")
LINEAR_DRAG = False


@njit(cache=True)
def rhs(t, state, force, mobility, params, out):
    """Rate of change of the state.

    t: time since release [s]
    state: (3) q1, q2, q3
    force: (3) F1, F2, F3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    params: (3) W1, W2, W3
    out: (3) filled with the result.
    6 operations, 0 temporaries.
    """
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    b_parallel = mobility[0]
    b_perpendicular = mobility[1]
    W1 = params[0]
    W2 = params[1]
    W3 = params[2]
    out[0] = b_parallel * (F1 + W1)
    out[1] = b_parallel * (F2 + W2)
    out[2] = b_perpendicular * (F3 + W3)


@njit(cache=True)
def jacobian(t, state, force, mobility, force_gradient, mobility_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    t: time since release [s]
    state: (3) q1, q2, q3
    force: (3) F1, F2, F3
    mobility: (5) b_parallel, b_perpendicular, b_turn, b_spin, b_roll
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    mobility_gradient: (5, 3) as listed above
    params: (3) W1, W2, W3
    out: (3, 3) filled with the result.
    30 operations, 3 temporaries.
    """
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
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
    W1 = params[0]
    W2 = params[1]
    W3 = params[2]
    x0 = F1 + W1
    x1 = F2 + W2
    x2 = F3 + W3
    out[0, 0] = DF11 * b_parallel + Db11 * x0
    out[0, 1] = DF12 * b_parallel + Db12 * x0
    out[0, 2] = DF13 * b_parallel + Db13 * x0
    out[1, 0] = DF21 * b_parallel + Db11 * x1
    out[1, 1] = DF22 * b_parallel + Db12 * x1
    out[1, 2] = DF23 * b_parallel + Db13 * x1
    out[2, 0] = DF31 * b_perpendicular + Db21 * x2
    out[2, 1] = DF32 * b_perpendicular + Db22 * x2
    out[2, 2] = DF33 * b_perpendicular + Db23 * x2


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
