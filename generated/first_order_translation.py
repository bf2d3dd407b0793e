"""First-order slow model: translation.

Made by `python -m derivation` from derivation/multiscale.py; do not edit.
SymPy 1.14.0. 180 operations, 15 temporaries.

The expansion (4.11) solved to order epsilon: q' = u - tau (Du) u with
u = (F + W)/beta_v and tau = m/beta_v. Free of stiffness.

State:

* [0] `q1` [m] position of the bead's centre along N1, (2.1)
* [1] `q2` [m] position of the bead's centre along N2, (2.1)
* [2] `q3` [m] position of the bead's centre along N3, (2.1)

Parameters:

* [0] `m` [kg] mass of the bead, (2.3)
* [1] `beta_v` [kg/s] translational drag coefficient, (2.15)
* [2] `W1` [N] gravity and buoyancy, one constant force, along N1, (2.11-2.12)
* [3] `W2` [N] gravity and buoyancy, one constant force, along N2, (2.11-2.12)
* [4] `W3` [N] gravity and buoyancy, one constant force, along N3, (2.11-2.12)
"""

import math

from numba import njit

STATE = ("q1", "q2", "q3")
PARAMS = ("m", "beta_v", "W1", "W2", "W3")
RHS_INPUTS = ("force", "force_gradient")
JACOBIAN_INPUTS = ("force", "force_gradient", "force_curvature")
LINEAR_DRAG = False


@njit(cache=True)
def rhs(t, state, force, force_gradient, params, out):
    """Rate of change of the state.

    t: time since release [s]
    state: (3) q1, q2, q3
    force: (3) F1, F2, F3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    params: (5) m, beta_v, W1, W2, W3
    out: (3) filled with the result.
    48 operations, 2 temporaries.
    """
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
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
    W1 = params[2]
    W2 = params[3]
    W3 = params[4]
    Fdot1 = DF11 * (F1 + W1) / beta_v + DF12 * (F2 + W2) / beta_v + DF13 * (F3 + W3) / beta_v
    Fdot2 = DF21 * (F1 + W1) / beta_v + DF22 * (F2 + W2) / beta_v + DF23 * (F3 + W3) / beta_v
    Fdot3 = DF31 * (F1 + W1) / beta_v + DF32 * (F2 + W2) / beta_v + DF33 * (F3 + W3) / beta_v
    x0 = m / (beta_v * beta_v)
    x1 = 1.0 / beta_v
    out[0] = -Fdot1 * x0 + x1 * (F1 + W1)
    out[1] = -Fdot2 * x0 + x1 * (F2 + W2)
    out[2] = -Fdot3 * x0 + x1 * (F3 + W3)


@njit(cache=True)
def jacobian(t, state, force, force_gradient, force_curvature, params, out):
    """Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).

    t: time since release [s]
    state: (3) q1, q2, q3
    force: (3) F1, F2, F3
    force_gradient: (3, 3) DF11, DF12, DF13, DF21, DF22, DF23, DF31, DF32, DF33
    force_curvature: (3, 3) HF11, HF12, HF13, HF21, HF22, HF23, HF31, HF32, HF33
    params: (5) m, beta_v, W1, W2, W3
    out: (3, 3) filled with the result.
    90 operations, 5 temporaries.
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
    HF11 = force_curvature[0, 0]
    HF12 = force_curvature[0, 1]
    HF13 = force_curvature[0, 2]
    HF21 = force_curvature[1, 0]
    HF22 = force_curvature[1, 1]
    HF23 = force_curvature[1, 2]
    HF31 = force_curvature[2, 0]
    HF32 = force_curvature[2, 1]
    HF33 = force_curvature[2, 2]
    m = params[0]
    beta_v = params[1]
    x0 = 1.0 / beta_v
    x1 = DF12 * DF21
    x2 = DF13 * DF31
    x3 = m / (beta_v * beta_v)
    x4 = DF23 * DF32
    out[0, 0] = DF11 * x0 - x3 * (HF11 + x0 * ((DF11 * DF11) + x1 + x2))
    out[0, 1] = DF12 * x0 - x3 * (HF12 + x0 * (DF11 * DF12 + DF12 * DF22 + DF13 * DF32))
    out[0, 2] = DF13 * x0 - x3 * (HF13 + x0 * (DF11 * DF13 + DF12 * DF23 + DF13 * DF33))
    out[1, 0] = DF21 * x0 - x3 * (HF21 + x0 * (DF11 * DF21 + DF21 * DF22 + DF23 * DF31))
    out[1, 1] = DF22 * x0 - x3 * (HF22 + x0 * ((DF22 * DF22) + x1 + x4))
    out[1, 2] = DF23 * x0 - x3 * (HF23 + x0 * (DF13 * DF21 + DF22 * DF23 + DF23 * DF33))
    out[2, 0] = DF31 * x0 - x3 * (HF31 + x0 * (DF11 * DF31 + DF21 * DF32 + DF31 * DF33))
    out[2, 1] = DF32 * x0 - x3 * (HF32 + x0 * (DF12 * DF31 + DF22 * DF32 + DF32 * DF33))
    out[2, 2] = DF33 * x0 - x3 * (HF33 + x0 * ((DF33 * DF33) + x2 + x4))


@njit(cache=True)
def matched_start(released, force, params, out):
    """Start of the slow motion for a bead released with (position, ..., velocities).

    released: (6) q1, q2, q3, v1, v2, v3
    force: (3) F1, F2, F3
    params: (5) m, beta_v, W1, W2, W3
    out: (3) filled with the result.
    18 operations, 2 temporaries.
    """
    q1 = released[0]
    q2 = released[1]
    q3 = released[2]
    v1 = released[3]
    v2 = released[4]
    v3 = released[5]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    m = params[0]
    beta_v = params[1]
    W1 = params[2]
    W2 = params[3]
    W3 = params[4]
    x0 = m / beta_v
    x1 = m / (beta_v * beta_v)
    out[0] = q1 + v1 * x0 - x1 * (F1 + W1)
    out[1] = q2 + v2 * x0 - x1 * (F2 + W2)
    out[2] = q3 + v3 * x0 - x1 * (F3 + W3)


@njit(cache=True)
def initial_layer(t, released, force, params, out):
    """What the release still adds to the slow motion at time t: displacement and velocity.

    t: time since release [s]
    released: (6) q1, q2, q3, v1, v2, v3
    force: (3) F1, F2, F3
    params: (5) m, beta_v, W1, W2, W3
    out: (6) filled with the result.
    24 operations, 6 temporaries.
    """
    v1 = released[3]
    v2 = released[4]
    v3 = released[5]
    F1 = force[0]
    F2 = force[1]
    F3 = force[2]
    m = params[0]
    beta_v = params[1]
    W1 = params[2]
    W2 = params[3]
    W3 = params[4]
    x0 = math.exp(-beta_v * t / m)
    x1 = 1.0 / beta_v
    x2 = x0 * (v1 - x1 * (F1 + W1))
    x3 = m * x1
    x4 = x0 * (v2 - x1 * (F2 + W2))
    x5 = x0 * (v3 - x1 * (F3 + W3))
    out[0] = -x2 * x3
    out[1] = -x3 * x4
    out[2] = -x3 * x5
    out[3] = x2
    out[4] = x4
    out[5] = x5


@njit(cache=True)
def rates(t, state, force, moment, force_gradient, moment_gradient, mobility, params, out):
    """`rhs`, called alike in every model: with all that any of them takes."""
    rhs(t, state, force, force_gradient, params, out)
