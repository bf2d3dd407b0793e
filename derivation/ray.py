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

from derivation.equations import Equation
from derivation.symbols import (
    COS_ALPHA,
    COS_BETA,
    FRESNEL,
    FRESNEL_RATES,
    GRADIENT,
    GRADIENT_RATE,
    IMPACT,
    INDEX_RATIO,
    POSITION,
    RADIUS,
    RAY,
    SCATTERING,
    SCATTERING_RATE,
    SINE_SQUARED,
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
#: before them: g = sin(alpha - beta)/sqrt(S), Fresnel's reflected amplitudes rho and
#: transmittances T over their common denominators w. rho and g carry the factor 1 - mu^2, so
#: they vanish exactly at equal indices; T is not 1 - R, which would cancel.
w_s, w_p, g, rho_s, rho_p, T_s, T_p = vector(FRESNEL)
FRESNEL_PARTS: dict[sp.Symbol, sp.Expr] = {
    w_s: mu * c + ct,
    w_p: mu * ct + c,
    g: _contrast / w_s,
    rho_s: _contrast / w_s**2,
    rho_p: _contrast * (1 - S * (1 + mu**2)) / w_p**2,
    T_s: 4 * mu * c * ct / w_s**2,
    T_p: 4 * mu * c * ct / w_p**2,
}
_cos_difference = c * ct + mu * S


@dataclass(frozen=True)
class Polarisation:
    """Power reflected and transmitted at the surface for one polarisation."""

    reflectance: sp.Expr
    transmittance: sp.Expr


S_POLARISED = Polarisation(rho_s**2, T_s)
P_POLARISED = Polarisation(rho_p**2, T_p)
#: (3.17): R averaged over both before it enters (3.19)-(3.22)
AVERAGED = Polarisation((rho_s**2 + rho_p**2) / 2, (T_s + T_p) / 2)


def scattering(light: Polarisation) -> sp.Expr:
    """Q_sc (3.19) without trigonometry and without cancellation.

    Q_sc = [4 R cos^2(beta) (T + 2 R cos^2(alpha)) + 2 T^2 sin^2(alpha - beta)]
           / (T^2 + 4 R cos^2(beta)).
    Every term is positive, and vanishes with R and 1 - mu.
    """
    R, T = light.reflectance, light.transmittance
    return (4 * R * ct**2 * (T + 2 * R * c**2) + 2 * T**2 * S * g**2) / (T**2 + 4 * R * ct**2)


def gradient(light: Polarisation) -> sp.Expr:
    """G = -Q_gr/sqrt(S), (3.21), likewise; positive where the ray attracts."""
    R, T = light.reflectance, light.transmittance
    return 2 * (T**2 * g * _cos_difference - 4 * R**2 * ct**2 * c) / (T**2 + 4 * R * ct**2)


#: efficiencies of a totally reflected ray, R = 1 and T = 0: n_P < n_m, sin(alpha) >= n_P/n_m
TOTAL_SCATTERING = 2 * c**2
TOTAL_GRADIENT = -2 * c


def circular(efficiency: Callable[[Polarisation], sp.Expr]) -> sp.Expr:
    """Q for circular or unpolarised light: the mean of Q over s and p, not Q of the mean R."""
    return (efficiency(S_POLARISED) + efficiency(P_POLARISED)) / 2


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

EMERGENT_RAYS = Equation("-", "sum over the emergent rays", r"Q_{sc} + i Q_{gr}", emergent_series())
SCATTERING_FORCE = Equation("3.19", "scattering efficiency", r"Q_{sc}", Q_sc)
GRADIENT_FORCE = Equation("3.21", "gradient efficiency", r"Q_{gr}", Q_gr)
REFLECTANCE = Equation("3.17", "averaged reflectance", r"R", in_S(AVERAGED.reflectance))
SCATTERING_REDUCED = Equation(
    "3.19", "without trigonometry", r"Q_{sc}",
    scattering(Polarisation(R_i, T_i)),
)  # fmt: skip
GRADIENT_REDUCED = Equation(
    "3.21", "without trigonometry", r"-Q_{gr}/\sqrt{S}", gradient(Polarisation(R_i, T_i))
)
MOMENT = Equation("3.25", "moment of a force applied at the entry point", r"M", moment_reduced)
