"""Scaled model (4.17): translation.

Made by `python -m derivation` from derivation/multiscale.py and derivation/rigid_body.py; do not edit.
SymPy 1.14.0. 25 operations, 3 temporaries.

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
* [1] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [2] `a2` [1] scaling factor of the generalised active forces, (4.12)
* [3] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [4] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [5] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

from numba import njit

STATE = ("q1", "q2", "q3", "v1", "v2", "v3")
PARAMS = ("m", "beta_v", "a2", "W1", "W2", "W3")
RHS_INPUTS = ("force",)
JACOBIAN_INPUTS = ("force", "force_gradient")


@njit(cache=True)
def rhs(state, force, params, out):
    """Rate of change of the state.

    state: (6) q1, q2, q3, v1, v2, v3
    force: (3) F1, F2, F3
    params: (6) m, beta_v, a2, W1, W2, W3
    out: (6) filled with the result.
    13 operations, 1 temporaries.
    """
    v1 = state[3]
    v2 = state[4]
    v3 = state[5]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    m = params[0]
    beta_v = params[1]
    a2 = params[2]
    W1 = params[3]
    W2 = params[4]
    W3 = params[5]
    x0 = a2 / m
    out[0] = v1
    out[1] = v2
    out[2] = v3
    out[3] = x0 * (F1 + W1 - beta_v * v1)
    out[4] = x0 * (F2 + W2 - beta_v * v2)
    out[5] = x0 * (F3 + W3 - beta_v * v3)


@njit(cache=True)
def jacobian(state, force, force_gradient, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    state: (6) q1, q2, q3, v1, v2, v3
    force: (3) F1, F2, F3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    params: (6) m, beta_v, a2, W1, W2, W3
    out: (6, 6) filled with the result.
    12 operations, 2 temporaries.
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
    m = params[0]
    beta_v = params[1]
    a2 = params[2]
    x0 = a2 / m
    x1 = -beta_v * x0
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
    out[3, 0] = DF11 * x0
    out[3, 1] = DF12 * x0
    out[3, 2] = DF13 * x0
    out[3, 3] = x1
    out[3, 4] = 0.0
    out[3, 5] = 0.0
    out[4, 0] = DF21 * x0
    out[4, 1] = DF22 * x0
    out[4, 2] = DF23 * x0
    out[4, 3] = 0.0
    out[4, 4] = x1
    out[4, 5] = 0.0
    out[5, 0] = DF31 * x0
    out[5, 1] = DF32 * x0
    out[5, 2] = DF33 * x0
    out[5, 3] = 0.0
    out[5, 4] = 0.0
    out[5, 5] = x1


@njit(cache=True)
def rates(state, force, moment, force_gradient, moment_gradient, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(state, force, params, out)
