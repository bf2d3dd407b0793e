"""The force of one ray on a sphere, (3.14)-(3.25), from the series of its emergent rays.

A ray of power P hits the sphere at the angle alpha and is refracted to beta. In the plane of
incidence, with directions as complex numbers and the incident ray along 1, it leaves as

* the reflected ray, with the power P R and the direction exp(i (pi + 2 alpha)) mirrored, and
* emergent rays n = 0, 1, ..., with the power P T^2 R^n. They are turned by alpha' + n beta', where
  alpha' = 2 alpha - 2 beta and beta' = pi - 2 beta.

See Ashkin, Biophys. J. 61, 569 (1992), and Roosen, Can. J. Phys. 57, 1260 (1979). Q is the
momentum that the sphere receives, in units of n_m P/c: Q_sc along the ray, Q_gr across it.

The sign of the gradient force is corrected: (3.21) with the direction (3.23) repels for n_P > n_m.
Here G = -Q_gr/sqrt(S), S = sin^2(alpha), so that the force on the sphere is

    F = (n_m P/c) (Q_sc u + G n/r),

where n is the vector from the centre of the sphere to the nearest point of the ray's axis, and
|n| = r sqrt(S). Nothing is divided by |n|, so the force is smooth through alpha = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from .equations import Equation
from .symbols import (
    ALONG_RAY,
    COS_ALPHA,
    COS_BETA,
    COS_SQUARED,
    EFFICIENCIES,
    FIELD_IMAGINARY,
    FIELD_REAL,
    GRADIENT,
    GRADIENT_RATE,
    IMPACT,
    INDEX_RATIO,
    JONES,
    OF_AVERAGED,
    OF_CIRCULAR,
    PER_COSINES,
    PLACE,
    POLARISATION_RATES,
    POSITION,
    RADIUS,
    RAY,
    SCATTERING,
    SCATTERING_RATE,
    SINE_SQUARED,
    SPLIT_GRADIENT,
    SPLIT_SCATTERING,
    SURFACE,
    over_S,
    vector,
)

alpha, beta = sp.symbols("alpha beta", positive=True)
#: power reflected and transmitted at the surface, (3.17) and (3.18)
R_i = sp.Symbol("R", positive=True)
T_i = sp.Symbol("T", positive=True)

# --- the series of emergent rays -------------------------------------------------------------
_order = sp.Symbol("n", integer=True, nonnegative=True)
_ratio = sp.Symbol("z")


def emergent_series() -> sp.Expr:
    """Q_sc + i Q_gr, with the sum over the emergent rays done symbolically.

    |R exp(i beta')| < 1 as R < 1, so the geometric series converges to 1/(1 - z).
    """
    series = sp.summation(_ratio**_order, (_order, 0, sp.oo))
    converged = series.args[0].expr
    reflected = R_i * sp.exp(sp.I * (sp.pi + 2 * alpha))
    first, step = 2 * alpha - 2 * beta, sp.pi - 2 * beta
    refracted = T_i**2 * sp.exp(sp.I * first) * converged.subs(_ratio, R_i * sp.exp(sp.I * step))
    return 1 - reflected - refracted


def _denominator() -> sp.Expr:
    return 1 + R_i**2 + 2 * R_i * sp.cos(2 * beta)


#: (3.19) with (3.20), and (3.21) with (3.22), as the thesis prints them
Q_sc = (
    1
    + R_i * sp.cos(2 * alpha)
    - T_i**2 * (sp.cos(2 * alpha - 2 * beta) + R_i * sp.cos(2 * alpha)) / _denominator()
)
Q_gr = (
    R_i * sp.sin(2 * alpha)
    - T_i**2 * (sp.sin(2 * alpha - 2 * beta) + R_i * sp.sin(2 * alpha)) / _denominator()
)


def absorbed_angular_momentum() -> sp.Expr:
    """Return the torque on the sphere about its centre, in units of r sin(alpha) n_m P/c: zero.

    The incident ray passes the centre at r sin(alpha), and every emergent ray leaves at the
    angle alpha to the normal, so at the same distance and turning the same way. The difference
    is 1 minus the power that leaves, R + T^2/(1 - R), which is 1 for T = 1 - R.
    """
    leaving = R_i + T_i**2 * sp.summation(R_i**_order, (_order, 0, sp.oo)).args[0].expr
    return sp.simplify((1 - leaving).subs(T_i, 1 - R_i))


# --- without trigonometry --------------------------------------------------------------------
S, mu = SINE_SQUARED.symbol, INDEX_RATIO.symbol
r = RADIUS.symbol

C, c, b = COS_SQUARED.symbol, COS_ALPHA.symbol, COS_BETA.symbol
_contrast = (1 - mu) * (1 + mu)
#: Cosines: C = cos^2(alpha), cos(alpha), and b = cos(beta)/mu by Snell's law (3.14). There
#: mu^2 b^2 = 1 - mu^2 S is written so that nothing cancels where the ray grazes
COSINES: dict[sp.Symbol, sp.Expr] = {C: 1 - S, c: sp.sqrt(C), b: sp.sqrt(C + _contrast / mu**2)}
cos_squared_beta = _contrast + mu**2 * (1 - S)

#: Named parts of the efficiencies, as functions of S, the cosines and the parts before them.
#: X = q R/T of each polarisation, and g, have the factor 1 - mu^2 and so vanish exactly at equal
#: indices; 1 - T, which would cancel, does not occur. One division serves both polarisations.
q, w_s, w_p, y, y_s, y_p, g, a, X_s, X_p = vector(SURFACE)
SURFACE_PARTS: dict[sp.Symbol, sp.Expr] = {
    q: c * b,
    w_s: c + b,
    w_p: c + mu**2 * b,
    y: 1 / (w_s * w_p),
    y_s: w_p * y,
    y_p: w_s * y,
    g: _contrast / (2 * mu**2) * y_s,
    a: _contrast / (2 * mu) * (1 - (1 + mu**2) * S),
    X_s: g**2,
    X_p: (a * y_p) ** 2,
}


def denominator(X: sp.Expr) -> sp.Expr:
    """|1 + R exp(-2 i beta)|^2 of (3.19)-(3.22), up to a factor, by X = q R/T."""
    return C + 4 * mu**2 * X * (q + X)


D_s, D_p, t_s, t_p = vector(OF_CIRCULAR)
CIRCULAR_PARTS: dict[sp.Symbol, sp.Expr] = {
    D_s: C + (_contrast / (2 * mu)) ** 2,
    D_p: C + a**2,
    t_s: X_s * D_p,
    t_p: X_p * D_s,
}
V_s, V_p, V, N = vector(OF_AVERAGED)
AVERAGED_PARTS: dict[sp.Symbol, sp.Expr] = {
    V_s: y_s**2,
    V_p: (mu * y_p) ** 2,
    V: V_s + V_p,
    N: X_s * V_s + X_p * V_p,
}


@dataclass(frozen=True)
class Light:
    """Terms of the efficiencies: sums over polarisations, and their common factor.

    For one polarisation zeroth, first, second = 1, X, X^2 and scale = 4 mu^2/denominator(X). Other
    light is brought to one fraction, because divisions are the largest cost of a ray.
    """

    zeroth: sp.Expr
    first: sp.Expr
    second: sp.Expr
    scale: sp.Expr


def polarised(X: sp.Expr, D: sp.Expr | None = None) -> Light:
    """Light of one polarisation, of X = q R/T; D: its denominator."""
    return Light(sp.Integer(1), X, X**2, 4 * mu**2 / (denominator(X) if D is None else D))


S_POLARISED, P_POLARISED = polarised(X_s, D_s), polarised(X_p, D_p)
#: circular or unpolarised light: the mean of Q over s and p, not Q of the mean R
CIRCULAR = Light(D_s + D_p, t_s + t_p, X_s * t_s + X_p * t_p, 2 * mu**2 / (D_s * D_p))
#: (3.17): R averaged over both before it enters (3.19)-(3.22); X = N/V
AVERAGED = Light(V**2, N * V, N**2, 4 * mu**2 / (C * V**2 + 2 * mu**2 * N))


def reflectance(X: sp.Expr) -> sp.Expr:
    """R of (3.17): T = q/(q + X) is 1 - R."""
    return X / (q + X)


def scattering(light: Light) -> sp.Expr:
    """Q_sc (3.19) without trigonometry and without cancellation, for one polarisation

    Q_sc = 4 mu^2 [q X + 2 cos^2(alpha) (X^2 + S g^2)]/denominator(X).
    Every term is positive, and vanishes with R and 1 - mu.
    """
    refracted = S * g**2 * light.zeroth
    return light.scale * (q * light.first + 2 * C * (light.second + refracted))


def gradient(light: Light) -> sp.Expr:
    """G = -Q_gr/sqrt(S), (3.21), likewise; positive where the ray attracts."""
    return light.scale * (C * g * (q + S) * light.zeroth - 2 * c * light.second)


#: The same for the compiler: what both efficiencies share is computed once
scale, e, z = vector(EFFICIENCIES)


def efficiency_parts(light: Light) -> dict[sp.Symbol, sp.Expr]:
    """Parts that Q_sc and G share."""
    return {scale: light.scale, e: 2 * c * light.second, z: C * g * light.zeroth}


def shared_scattering(light: Light) -> sp.Expr:
    """Q_sc of `scattering` by these parts."""
    return scale * (q * light.first + c * e + 2 * S * g * z)


def shared_gradient(light: Light) -> sp.Expr:  # noqa: ARG001
    """G of `gradient` by these parts."""
    return scale * (z * (q + S) - e)


#: efficiencies of a totally reflected ray, R = 1 and T = 0: n_P < n_m, sin(alpha) >= n_P/n_m
TOTAL_SCATTERING = 2 * C
TOTAL_GRADIENT = -2 * c


Efficiency = Callable[[Light], sp.Expr]


def split(efficiency: Efficiency) -> sp.Expr:
    """(Q_s - Q_p)/(2 S), without the cancellation of the difference as S goes to 0.

    With K = 1 - mu^2 and f = (1 + mu^2) (2 - S (1 + mu^2)), X_s - X_p and D_s - D_p are S times
    K^2 y^2 (mu^2 f w_s^2 - K^2)/(4 mu^4) and K^2 f/(4 mu^2). So N_s D_p - N_p D_s, a polynomial in
    these two steps, has the factor S.
    """
    X, D, step_X, step_D, s = sp.symbols("X D step_X step_D s")
    n_p = sp.expand(efficiency(polarised(X, D)) * D)
    n_s = n_p.subs(X, X + s * step_X)
    divided = sp.cancel(sp.expand(n_s * D - n_p * (D + s * step_D)) / s)
    f = (1 + mu**2) * (2 - (1 + mu**2) * S)
    k = (_contrast / (2 * mu)) ** 2
    values = {
        s: S,
        X: X_p,
        D: D_p,
        step_X: k * (f * y_p**2 - (_contrast / mu * y) ** 2),
        step_D: k * f,
    }
    return sp.collect(divided, (step_X, step_D), sp.factor).subs(values) / (2 * D_s * D_p)


#: all named parts, and d/dS of each by its name
PARTS = {**SURFACE_PARTS, **CIRCULAR_PARTS, **AVERAGED_PARTS, **efficiency_parts(CIRCULAR)}
PART_RATES = {
    each.symbol: over_S(each).symbol
    for each in (*SURFACE, *OF_CIRCULAR, *OF_AVERAGED, *EFFICIENCIES)
}
#: 1/(2 q): d cos(alpha)/dS = -1/(2 cos(alpha)) = -h b and db/dS = -1/(2 b) = -h cos(alpha)
h = PER_COSINES.symbol
per_cosines = 1 / (2 * q)


def rate_in_S(expression: sp.Expr) -> sp.Expr:
    """d/dS by the chain rule through the cosines and the named parts."""
    through_parts = sum(expression.diff(part) * rate for part, rate in PART_RATES.items())
    through_cosines = -h * (expression.diff(c) * b + expression.diff(b) * c)
    return expression.diff(S) - expression.diff(C) + through_cosines + through_parts


def rate_of_part(part: sp.Symbol, value: sp.Expr) -> sp.Expr:
    """d/dS of a named part; of k/D as -(k/D)^2 D'/k, without another division."""
    if part in (y_s, y_p):
        return -(part**2) * PART_RATES[w_s if part == y_s else w_p]
    numerator, divisor = sp.fraction(value)
    if rate_in_S(divisor) == 0 or rate_in_S(numerator) != 0:
        return rate_in_S(value)
    return -(part**2) * rate_in_S(divisor) / numerator


def in_S(expression: sp.Expr) -> sp.Expr:
    """An efficiency as a function of S alone."""
    for part, value in reversed({**COSINES, **PARTS}.items()):
        expression = expression.subs(part, value)
    return expression


# --- the ray in space ------------------------------------------------------------------------
u = vector(RAY)
p = vector(POSITION)

#: from the centre p of the bead to the nearest point of the ray through the focus along u
#: (the origin is the focus), orthogonal to u; and S = |n|^2/r^2
n_of_p = (u.T * p)[0] * u - p
S_of_p = (n_of_p.T * n_of_p)[0] / r**2

n = vector(IMPACT)
Qs, dQs, G, dG = vector((SCATTERING, SCATTERING_RATE, GRADIENT, GRADIENT_RATE))

#: force in units of n_m P/c (3.24)
force = Qs * u + G * n / r

#: S and the force by p/r instead of n/r. With s = u.p/r the ray passes the centre at n/r = s u -
#: p/r, so that S is |p/r|^2 - s^2. The force is (Q_sc + s G) u - G p/r, whose second term has the
#: same direction for all rays
place, s = sp.Matrix(vector(PLACE)), ALONG_RAY.symbol
along_ray = (u.T * place)[0]
S_by_place = (place.T * place)[0] - s**2
force_along_ray = (Qs + s * G) * u


def _gradient_over_position(
    along_n: sp.MatrixBase, coefficients: dict[sp.Symbol, sp.Symbol]
) -> sp.MatrixBase:
    """Chain rule over p: n' = u u^T - 1, S' = -2 n/r^2 (n is orthogonal to u)."""
    dn = u * u.T - sp.eye(3)
    dS = -2 * n.T / r**2
    through_S = sp.zeros(3, 1)
    for coefficient, derivative in coefficients.items():
        through_S += along_n.diff(coefficient) * derivative
    return along_n.jacobian(n) * dn + through_S * dS


#: dF/dp, row i column j = dF_i/dp_j
force_gradient = _gradient_over_position(force, {Qs: dQs, G: dG})

#: (3.25): each ray's force applied where it enters, at n - r cos(alpha) u from the centre. What
#: the thesis computes; the true torque of a lossless sphere is zero (absorbed_angular_momentum).
moment = (n - r * c * u).cross(force)
#: the same with u.n = 0 and |u| = 1: (Q_sc + cos(alpha) G) n x u
moment_reduced = (Qs + c * G) * n.cross(u)

#: gradient of (3.25): d cos(alpha)/dS = -1/(2 cos(alpha))
_Qm, _dQm = sp.symbols("Q_m dQ_m", real=True)
moment_gradient = _gradient_over_position(_Qm * n.cross(u), {_Qm: _dQm}).subs(
    {_Qm: Qs + c * G, _dQm: dQs + c * dG - G / (2 * c)}
)

# --- light of one polarisation ---------------------------------------------------------------
_jones_x, _jones_y = (
    JONES[0].symbol + sp.I * JONES[1].symbol,
    JONES[2].symbol + sp.I * JONES[3].symbol,
)


def _carried(axis: sp.MatrixBase) -> sp.Matrix:
    """A field along `axis` in the pupil, turned with its ray from z to u; orthogonal to u."""
    z = sp.Matrix([0, 0, 1])
    return axis - (axis.T * u)[0] / (1 + u[2]) * (u + z)


#: the field of a ray, of unit length for a unit Jones vector (a, b): real and imaginary part
electric_field = _jones_x * _carried(sp.Matrix([1, 0, 0])) + _jones_y * _carried(
    sp.Matrix([0, 1, 0])
)
field_real, field_imaginary = (
    sp.Matrix([part(entry) for entry in electric_field.applyfunc(sp.expand)])
    for part in (sp.re, sp.im)
)

E, H = vector(FIELD_REAL), vector(FIELD_IMAGINARY)


def _power_along(direction: sp.MatrixBase) -> sp.Expr:
    """|field . direction|^2."""
    return (E.T * direction)[0] ** 2 + (H.T * direction)[0] ** 2


#: S (f_s - f_p), f the parts of the power polarised across the plane of incidence and in it. That
#: plane holds u and n, and |n|^2 = r^2 S: so sigma is a polynomial, smooth through the axis.
sigma = (_power_along(u.cross(n)) - _power_along(n)) / r**2
#: dsigma/dp: with u.n = 0 and a field orthogonal to u, n' = u u^T - 1 acts as -1
sigma_gradient = -sp.Matrix([sigma.diff(component) for component in n])

X, Y = SPLIT_SCATTERING.symbol, SPLIT_GRADIENT.symbol
dsigma = vector(POLARISATION_RATES)
#: Q_sc = (Q_s + Q_p)/2 + sigma X and G likewise with Y; what the turning plane of incidence adds to
#: dF/dp and dM/dp
turning_force = (X * u + Y * n / r) * dsigma.T
turning_moment = (X + c * Y) * n.cross(u) * dsigma.T

EMERGENT_RAYS = Equation("-", "sum over the emergent rays", r"Q_{sc} + i Q_{gr}", emergent_series())
SCATTERING_FORCE = Equation("3.19", "scattering efficiency", r"Q_{sc}", Q_sc)
GRADIENT_FORCE = Equation("3.21", "gradient efficiency", r"Q_{gr}", Q_gr)
REFLECTANCE = Equation("3.17", "averaged reflectance", r"R", in_S(reflectance(N / V)))
SCATTERING_REDUCED = Equation(
    "3.19", "without trigonometry", r"Q_{sc}",
    scattering(S_POLARISED),
)  # fmt: skip
GRADIENT_REDUCED = Equation(
    "3.21", "without trigonometry", r"-Q_{gr}/\sqrt{S}", gradient(S_POLARISED)
)
MOMENT = Equation("3.25", "moment of a force applied at the entry point", r"M", moment_reduced)
