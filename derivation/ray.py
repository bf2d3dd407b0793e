"""The force of one ray on a sphere, (3.14)-(3.25), from the series of its emergent rays.

A ray of power P hits the sphere at the angle alpha and is refracted to beta. In the plane of
incidence, with directions as complex numbers and the incident ray along 1, it leaves as

* the reflected ray: power P R, direction exp(i (pi + 2 alpha)) mirrored, and
* emergent rays n = 0, 1, ...: power P T^2 R^n, turned by alpha' + n beta' with
  alpha' = 2 alpha - 2 beta and beta' = pi - 2 beta

(Ashkin, Biophys. J. 61, 569 (1992), and Roosen, Can. J. Phys. 57, 1260 (1979)). Q is the
momentum the sphere takes, in units of n_m P/c: Q_sc along the ray, Q_gr across it.

The sign of the gradient force: (3.21) with the direction (3.23) repels for n_P > n_m. Here
G = -Q_gr/sqrt(S), S = sin^2(alpha), so that the force on the sphere is

    F = (n_m P/c) (Q_sc u + G n/r),

n the vector from the centre of the sphere to the nearest point of the ray's axis, |n| = r sqrt(S).
Nothing is divided by |n|: the force is smooth through alpha = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from .equations import Equation
from .symbols import (
    COS_ALPHA,
    COS_BETA,
    FIELD_IMAGINARY,
    FIELD_REAL,
    FRESNEL,
    FRESNEL_RATES,
    GRADIENT,
    GRADIENT_RATE,
    IMPACT,
    INDEX_RATIO,
    JONES,
    POLARISATION_RATES,
    POSITION,
    RADIUS,
    RAY,
    SCATTERING,
    SCATTERING_RATE,
    SINE_SQUARED,
    SPLIT_GRADIENT,
    SPLIT_SCATTERING,
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
    """Torque on the sphere about its centre, in units of r sin(alpha) n_m P/c: zero.

    The incident ray passes the centre at r sin(alpha), and every emergent ray leaves at the
    angle alpha to the normal, so at the same distance and turning the same way. What is left
    is 1 minus the power that leaves, R + T^2/(1 - R), which is 1 for T = 1 - R.
    """
    leaving = R_i + T_i**2 * sp.summation(R_i**_order, (_order, 0, sp.oo)).args[0].expr
    return sp.simplify((1 - leaving).subs(T_i, 1 - R_i))


# --- without trigonometry --------------------------------------------------------------------
S, mu = SINE_SQUARED.symbol, INDEX_RATIO.symbol
r = RADIUS.symbol

#: cos(alpha), and cos(beta) by Snell's law (3.14): 1 - mu^2 S, written so that nothing cancels
#: as the ray grazes
cos_alpha = sp.sqrt(1 - S)
c, ct = COS_ALPHA.symbol, COS_BETA.symbol
cos_beta = sp.sqrt((1 - mu) * (1 + mu) + mu**2 * c**2)

_contrast = (1 - mu) * (1 + mu)

#: Named parts of the efficiencies, as functions of S, cos(alpha), cos(beta) and of the parts
#: before them. Fresnel's transmittances have the factor 4 mu q, q = cos(alpha) cos(beta), and his
#: reflected amplitudes the factor 1 - mu^2: they vanish exactly at equal indices, and T is not
#: 1 - R, which would cancel. One division serves both polarisations.
q, w_s, w_p, y, V_s, V_p, a, rho2_s, rho2_p, g = vector(FRESNEL)
FRESNEL_PARTS: dict[sp.Symbol, sp.Expr] = {
    q: c * ct,
    w_s: mu * c + ct,
    w_p: mu * ct + c,
    y: 1 / (w_s**2 * w_p**2),
    V_s: w_p**2 * y,
    V_p: w_s**2 * y,
    a: 1 - S * (1 + mu**2),
    rho2_s: _contrast**2,
    rho2_p: _contrast**2 * a**2,
    g: _contrast * w_s * V_s,
}


@dataclass(frozen=True)
class Polarisation:
    """Power reflected and transmitted at the surface, by V = T/(4 mu q) and rho2 = R/V^2."""

    rho2: sp.Expr
    V: sp.Expr

    @property
    def reflectance(self) -> sp.Expr:
        """R of (3.17)."""
        return self.rho2 * self.V**2

    @property
    def transmittance(self) -> sp.Expr:
        """T of (3.18)."""
        return 4 * mu * q * self.V


S_POLARISED = Polarisation(rho2_s, V_s)
P_POLARISED = Polarisation(rho2_p, V_p)
#: (3.17): R averaged over both before it enters (3.19)-(3.22)
AVERAGED = Polarisation(2 * (rho2_s * V_s**2 + rho2_p * V_p**2) / (V_s + V_p) ** 2, (V_s + V_p) / 2)


def _scattering_parts(light: Polarisation) -> tuple[sp.Expr, sp.Expr]:
    rho2, V = light.rho2, light.V
    return (
        rho2 * V * (4 * mu * q + 2 * rho2 * V * c**2) + 8 * mu**2 * c**2 * S * g**2,
        4 * mu**2 * c**2 + rho2,
    )


def _gradient_parts(light: Polarisation) -> tuple[sp.Expr, sp.Expr]:
    rho2, V = light.rho2, light.V
    return (
        2 * (4 * mu**2 * c**2 * g * (q + mu * S) - rho2**2 * V**2 * c),
        4 * mu**2 * c**2 + rho2,
    )


def scattering(light: Polarisation) -> sp.Expr:
    """Q_sc (3.19) without trigonometry and without cancellation.

    T^2 = 16 mu^2 cos^2(alpha) cos^2(beta) V^2, so that cos^2(beta) leaves the fraction:

    Q_sc = [rho2 V (4 mu q + 2 rho2 V cos^2(alpha)) + 8 mu^2 cos^2(alpha) sin^2(alpha - beta)]
           / (4 mu^2 cos^2(alpha) + rho2).
    Every term is positive, and vanishes with R and 1 - mu.
    """
    numerator, denominator = _scattering_parts(light)
    return numerator / denominator


def gradient(light: Polarisation) -> sp.Expr:
    """G = -Q_gr/sqrt(S), (3.21), likewise; positive where the ray attracts."""
    numerator, denominator = _gradient_parts(light)
    return numerator / denominator


#: efficiencies of a totally reflected ray, R = 1 and T = 0: n_P < n_m, sin(alpha) >= n_P/n_m
TOTAL_SCATTERING = 2 * c**2
TOTAL_GRADIENT = -2 * c


Efficiency = Callable[[Polarisation], sp.Expr]
_PARTS: dict[Efficiency, Callable[[Polarisation], tuple[sp.Expr, sp.Expr]]] = {
    scattering: _scattering_parts,
    gradient: _gradient_parts,
}


def circular(efficiency: Efficiency) -> sp.Expr:
    """Q for circular or unpolarised light: the mean of Q over s and p, not Q of the mean R.

    Over one common denominator, as divisions are what a ray costs most.
    """
    n_s, d_s = _PARTS[efficiency](S_POLARISED)
    n_p, d_p = _PARTS[efficiency](P_POLARISED)
    return (n_s * d_p + n_p * d_s) / (2 * d_s * d_p)


def split(efficiency: Efficiency) -> sp.Expr:
    """(Q_s - Q_p)/(2 S), without the cancellation of the difference as S goes to 0.

    With K = 1 - mu^2, rho2_s - rho2_p = S K^2 (1 + mu^2) (1 + a) and V_s - V_p = -S K^2 y. So
    N_s D_p - N_p D_s, a polynomial in these two steps, has the factor S.
    """
    rho2, V, step_rho2, step_V, s = sp.symbols("rho2 V step_rho2 step_V s")
    n_p, d_p = _PARTS[efficiency](Polarisation(rho2, V))
    n_s, d_s = _PARTS[efficiency](Polarisation(rho2 + s * step_rho2, V + s * step_V))
    divided = sp.cancel(sp.expand(n_s * d_p - n_p * d_s) / s)
    values = {
        s: S,
        rho2: P_POLARISED.rho2,
        V: P_POLARISED.V,
        step_rho2: rho2_s * (1 + mu**2) * (1 + a),
        step_V: -rho2_s * y,
    }
    denominator = _PARTS[efficiency](S_POLARISED)[1] * d_p.subs(values)
    return sp.collect(sp.expand(divided), (step_rho2, step_V), sp.factor).subs(values) / (
        2 * denominator
    )


#: d/dS of the named parts, by name
FRESNEL_PART_RATES = dict(zip(FRESNEL_PARTS, vector(FRESNEL_RATES), strict=True))


def rate_in_S(expression: sp.Expr) -> sp.Expr:
    """d/dS by the chain rule through cos(alpha), cos(beta) and the named parts.

    d cos(alpha)/dS = -1/(2 cos(alpha)) and d cos(beta)/dS = -mu^2/(2 cos(beta)).
    """
    through_parts = sum(expression.diff(part) * rate for part, rate in FRESNEL_PART_RATES.items())
    through_cosines = -expression.diff(c) / (2 * c) - expression.diff(ct) * mu**2 / (2 * ct)
    return expression.diff(S) + through_cosines + through_parts


def in_S(expression: sp.Expr) -> sp.Expr:
    """An efficiency as a function of S alone."""
    for part, value in reversed(FRESNEL_PARTS.items()):
        expression = expression.subs(part, value)
    return expression.subs(ct, cos_beta).subs(c, cos_alpha)


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
REFLECTANCE = Equation("3.17", "averaged reflectance", r"R", in_S(AVERAGED.reflectance))
SCATTERING_REDUCED = Equation(
    "3.19", "without trigonometry", r"Q_{sc}",
    scattering(S_POLARISED),
)  # fmt: skip
GRADIENT_REDUCED = Equation(
    "3.21", "without trigonometry", r"-Q_{gr}/\sqrt{S}", gradient(S_POLARISED)
)
MOMENT = Equation("3.25", "moment of a force applied at the entry point", r"M", moment_reduced)
