"""Drag and thermal noise (2.13-2.20) solved exactly over a step, and their limit of first order.

One coordinate of a bead is in a harmonic trap of rate kappa = k/beta (0 without one). During the
step the slow velocity u is constant or grows in proportion to the time:

    dx = v dt,   dv = ((u - v)/tau - (kappa/tau) x) dt + sqrt(2 (kT/m)/tau) dW,   tau = m/beta.

Every function of the step h is written by d, the displacement per initial velocity:

    j = int d,  l = int j,  e_xx = 1 - kappa j/tau,  e_vv = 1 - d/tau - kappa j/tau,
    Var x = (kT/m) c_xx,  Cov = (kT/m) d^2/tau,  Var v = (kT/m) c_vv.

Their closed forms lose all digits if the two rates are close to each other or the step is short.
Two parts are emitted instead: the Taylor series of a short step, and the exact step from h to 2 h.
For a bead with more drag than spring both are sums of terms of one sign. A step of any length, made
by doubling, therefore keeps its digits.
"""

from __future__ import annotations

import sympy as sp

from .equations import Equation
from .symbols import (
    COVARIANCE_V,
    COVARIANCE_X,
    DISPLACEMENT,
    FIRST_INTEGRAL,
    RADIUS,
    RELAXATION,
    SECOND_INTEGRAL,
    STEP,
    STEP_IN_SWINGS,
    STEP_IN_TAU,
    STEP_IN_TRAP,
    TRAP_RATE,
    VISCOSITY,
)

h, tau, kappa = STEP.symbol, RELAXATION.symbol, TRAP_RATE.symbol
d, j, l = DISPLACEMENT.symbol, FIRST_INTEGRAL.symbol, SECOND_INTEGRAL.symbol
c_xx, c_vv = COVARIANCE_X.symbol, COVARIANCE_V.symbol

#: powers of the step that the series of a short step holds: complete to rounding for
#: h <= tau/64 and kappa h <= 1/64
ORDER = 8

# --- the closed forms, by the two rates and their exponentials over the step --------------------
#: rates of the slow and of the fast decay, and e^(-rate h)
slow, fast = sp.symbols("lambda_s lambda_f", positive=True)
E_slow, E_fast = sp.symbols("E_s E_f", positive=True)
#: 1/tau is their sum, kappa/tau their product
BY_RATES = {tau: 1 / (slow + fast), kappa: slow * fast / (slow + fast)}

_apart = fast - slow


def _gone(rate: sp.Expr, left: sp.Expr) -> sp.Expr:
    """int_0^h e^(-rate s) ds, of which `left` = e^(-rate h)."""
    return (1 - left) / rate


#: d, j, l and the covariances as integrals of exponentials
CLOSED = {
    d: (E_slow - E_fast) / _apart,
    j: (_gone(slow, E_slow) - _gone(fast, E_fast)) / _apart,
    l: ((h - _gone(slow, E_slow)) / slow - (h - _gone(fast, E_fast)) / fast) / _apart,
    c_xx: 2 * (slow + fast) / _apart**2 * (
        _gone(2 * slow, E_slow**2)
        - 2 * _gone(slow + fast, E_slow * E_fast)
        + _gone(2 * fast, E_fast**2)
    ),
    c_vv: 2 * (slow + fast) / _apart**2 * (
        slow**2 * _gone(2 * slow, E_slow**2)
        - 2 * slow * fast * _gone(slow + fast, E_slow * E_fast)
        + fast**2 * _gone(2 * fast, E_fast**2)
    ),
}  # fmt: skip


def over_time(expression: sp.Expr) -> sp.Expr:
    """d/dh of an expression of h and the exponentials over it."""
    return (
        expression.diff(h)
        - slow * E_slow * expression.diff(E_slow)
        - fast * E_fast * expression.diff(E_fast)
    )


def twice(expression: sp.Expr) -> sp.Expr:
    """An expression of h and the exponentials over it, of 2 h."""
    return expression.subs({h: 2 * h, E_slow: E_slow**2, E_fast: E_fast**2}, simultaneous=True)


# --- the propagator and the covariance -----------------------------------------------------------
e_xx = 1 - kappa * j / tau
e_vx = -kappa * d / tau
e_vv = 1 - d / tau - kappa * j / tau

#: dz = A z dt + ...
A = sp.Matrix([[0, 1], [-kappa / tau, -1 / tau]])

PROPAGATOR = Equation(
    "-",
    "what a step leaves of position and velocity",
    r"e^{A h}",
    sp.Matrix([[e_xx, d], [e_vx, e_vv]]),
)
#: over kT/m
COVARIANCE = Equation(
    "2.16",
    "covariance of the thermal motion of a step, of position and velocity",
    r"\tfrac{m}{kT}\Sigma",
    sp.Matrix([[c_xx, d**2 / tau], [d**2 / tau, c_vv]]),
)

#: weights for the position and the velocity after a step. They multiply v, the initial slow
#: velocity (u less kappa x), and the rise of u over the step
STEP_WEIGHTS = {
    "by_v": d,
    "by_u": j / tau,
    "by_rise": l / (tau * h),
    "decay": e_vv,
    "v_by_u": d / tau,
    "v_by_rise": j / (tau * h),
    "c_xv": COVARIANCE.rhs[0, 1],
}

# --- a step of 2 h from one of h -----------------------------------------------------------------
DOUBLED = {
    d: e_xx * d + d * e_vv,
    j: j + e_xx * j + d**2,
    l: l + h * j + e_xx * l + d * j,
    c_xx: c_xx + e_xx**2 * c_xx + 2 * e_xx * d * (d**2 / tau) + d**2 * c_vv,
    c_vv: c_vv + e_vx**2 * c_xx + 2 * e_vx * e_vv * (d**2 / tau) + e_vv**2 * c_vv,
}

# --- a short step --------------------------------------------------------------------------------
#: h/tau, kappa h^2/tau, and without inertia kappa h
p, q, g = STEP_IN_TAU.symbol, STEP_IN_SWINGS.symbol, STEP_IN_TRAP.symbol


def _series() -> dict[sp.Symbol, sp.Expr]:
    """Taylor's series in h of the five functions, by powers of p and q."""
    s = sp.Symbol("s", positive=True)  # the time, in steps
    damping, pull = sp.Poly(p, s, p, q), sp.Poly(q, s, p, q)
    # d = h D with D'' = -p D' - q D, D(0) = 0, D'(0) = 1
    terms = [damping.zero, damping.one]
    for n in range(ORDER + 3):
        following = -damping * (n + 1) * terms[n + 1] - pull * terms[n]
        terms.append(following * sp.Rational(1, (n + 2) * (n + 1)))
    of_d = sum((term * sp.Poly(s, s, p, q) ** n for n, term in enumerate(terms)), damping.zero)
    of_j = of_d.integrate(s)
    of_l = of_j.integrate(s)
    of_xx = 2 * (of_d**2).integrate(s)
    of_vv = 2 * ((1 - damping * of_d - pull * of_j) ** 2).integrate(s)
    leading = {d: h, j: h**2, l: h**3, c_xx: h**2 * p, c_vv: p}
    whole = zip(leading, (of_d, of_j, of_l, of_xx, of_vv), strict=True)
    return {name: leading[name] * _cut(series.eval(s, 1)) for name, series in whole}


def _cut(series: sp.Poly) -> sp.Expr:
    """The powers p^a q^b with a + 2 b < ORDER, nested."""
    kept = sum(
        coefficient * p**a * q**b for (a, b), coefficient in series.terms() if a + 2 * b < ORDER
    )
    return sp.horner(kept, p, q)


SHORT = _series()

# --- without inertia: dx = (u - kappa x) dt + sqrt(2 D) dW ----------------------------------------
#: d = int e^(-kappa s) ds, and j its integral
e_x = 1 - kappa * d
#: as `STEP_WEIGHTS`; spread = Var x/D
STEP_WEIGHTS_WITHOUT_INERTIA = {"by_u": d, "by_rise": j / h, "spread": d * (1 + e_x)}
DOUBLED_WITHOUT_INERTIA = {d: d + e_x * d, j: j + h * d + e_x * j}
SHORT_WITHOUT_INERTIA = {
    d: h * sp.horner(sum((-g) ** n / sp.factorial(n + 1) for n in range(ORDER)), g),
    j: h**2 * sp.horner(sum((-g) ** n / sp.factorial(n + 2) for n in range(ORDER)), g),
}

# --- first order in tau: the flux of the corrected Smoluchowski equation --------------------------
x, t, D = sp.Symbol("x", real=True), sp.Symbol("t", real=True), sp.Symbol("D", positive=True)
density, u = sp.Function("n")(x, t), sp.Function("u")(x)


def _first_order_flux() -> tuple[sp.Expr, sp.Expr]:
    """Return orders 0 and 1 in tau of the flux, from the moments of Kramers' equation over v.

    The moments n, J, K, M are of order 0 to 3, and kT/m = D/tau. They satisfy
    n_t = -J_x,  J_t = -K_x - (J - u n)/tau,  K_t = -M_x - 2 (K - u J)/tau + 2 D n/tau^2.
    Their leading orders are K = D n/tau + K_0 and M = 3 D J/tau.
    """
    J_0 = u * density - D * density.diff(x)
    n_t = -J_0.diff(x)
    # order 1/tau of K_t
    K_0 = u * J_0 - (3 * D * J_0.diff(x) + D * n_t) / 2
    # order 1 of J_t
    J_0_t = u * n_t - D * n_t.diff(x)
    return J_0, sp.expand(-J_0_t - K_0.diff(x))


FLUX_0, FLUX_1 = _first_order_flux()

SMOLUCHOWSKI = Equation(
    "-",
    "flux of the bead's position to first order in tau: Wilemski (1976), Titulaer (1978)",
    r"J",
    (1 - tau * u.diff(x)) * FLUX_0,
)

# --- thermal torque ------------------------------------------------------------------------------
r, mu = RADIUS.symbol, VISCOSITY.symbol
#: drag of translation and rotation (2.15)
_beta_v, _beta_w = 6 * sp.pi * mu * r, 8 * sp.pi * mu * r**3

ARM_OF_TORQUE = Equation(
    "2.17",
    "length by which the noise of the force gives that of the torque, "
    "sqrt(2 beta_w kT) = L_C sqrt(2 beta_v kT)",
    "L_C",
    sp.sqrt(_beta_w / _beta_v),
)
