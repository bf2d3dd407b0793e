"""Overdamped model (5.2): translation.

Made by `python -m derivation` from derivation/multiscale.py; do not edit.
SymPy 1.14.0. 17 operations, 2 temporaries.

No rotation: for a bead on which the light exerts no moment.

State:

* [0] `q1` [m] position of the bead's centre along N1, (2.1)
* [1] `q2` [m] position of the bead's centre along N2, (2.1)
* [2] `q3` [m] position of the bead's centre along N3, (2.1)

Parameters:

* [0] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [1] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [2] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [3] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3")
PARAMS = ("beta_v", "W1", "W2", "W3")
RHS_INPUTS = ("force",)
JACOBIAN_INPUTS = ("force", "force_gradient")


@njit(cache=True)
def rhs(state, force, params, out):
    """Rate of change of the state.

    state: (3) q1, q2, q3
    force: (3) F1, F2, F3
    params: (4) beta_v, W1, W2, W3
    out: (3) filled with the result.
    7 operations, 1 temporaries.
    """
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    beta_v = params[0]
    W1 = params[1]
    W2 = params[2]
    W3 = params[3]
    x0 = 1.0 / beta_v
    out[0] = x0 * (F1 + W1)
    out[1] = x0 * (F2 + W2)
    out[2] = x0 * (F3 + W3)


@njit(cache=True)
def jacobian(state, force, force_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    state: (3) q1, q2, q3
    force: (3) F1, F2, F3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    params: (4) beta_v, W1, W2, W3
    out: (3, 3) filled with the result.
    10 operations, 1 temporaries.
    """
    DF11 = force_gradient[0, 0]
    DF12 = force_gradient[0, 1]
    DF13 = force_gradient[0, 2]
    DF21 = force_gradient[1, 0]
    DF22 = force_gradient[1, 1]
    DF23 = force_gradient[1, 2]
    DF31 = force_gradient[2, 0]
    DF32 = force_gradient[2, 1]
    DF33 = force_gradient[2, 2]
    beta_v = params[0]
    x0 = 1.0 / beta_v
    out[0, 0] = DF11 * x0
    out[0, 1] = DF12 * x0
    out[0, 2] = DF13 * x0
    out[1, 0] = DF21 * x0
    out[1, 1] = DF22 * x0
    out[1, 2] = DF23 * x0
    out[2, 0] = DF31 * x0
    out[2, 1] = DF32 * x0
    out[2, 2] = DF33 * x0


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, params, out)
