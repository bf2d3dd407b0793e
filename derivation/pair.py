r"""Two spheres: bispherical harmonics, the mobility of Rotne and Prager, the motion of a pair.

In bispherical coordinates xi, eta, with lengths in their scale c,

    z = sinh(xi)/X,   rho = sin(eta)/X,   X = cosh(xi) - nu,   nu = cos(eta).

Stokes flow with the pressure mu Q is u = x Q/2 + v with harmonic Q and v. The harmonics are

    f_n = sqrt(X) e^(s (n + 1/2) xi) P_n^m(nu),   s = +1 or -1,

without the sign of Condon and Shortley. Their derivatives along z, rho and x contain only the
degrees n - 1, n and n + 1. On a sphere rho/z = sin(eta)/sinh(xi), so the velocity V of the surface
gives Q and the other components of v in terms of W = v_z. The continuity equation is then block
tridiagonal.

Two beads at the distance rho have the relative mobility a n n + b (1 - n n). Its drift makes their
distance an autonomous process,

    d rho = [a F + kT (a' + 2 a/rho)] dt + sqrt(2 kT a) dB,

which is the gap beside a wall (`derivation.wall`) with F + 2 kT/rho in place of F.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from . import wall
from .equations import Equation

# --- bispherical coordinates ---------------------------------------------------------------------
#: degree, order and sign of a harmonic; e^xi; cos(eta) and sin(eta)
n, m, nu, sine = sp.symbols("n m nu sine")
t = sp.Symbol("t", positive=True)
sinh, cosh = (t - 1 / t) / 2, (t + 1 / t) / 2
X = cosh - nu
z, rho = sinh / X, sine / X
#: P_n^m and its derivative over nu, of the order with which all others are expressed
P, dP = sp.symbols("P dP")


def over_nu(expression: sp.Expr, order: sp.Expr) -> sp.Expr:
    """Derivative over nu of an expression of P_n^order, by Legendre's equation."""
    second = (2 * nu * dP - (n * (n + 1) - order**2 / (1 - nu**2)) * P) / (1 - nu**2)
    return (
        expression.diff(nu)
        + expression.diff(sine) * (-nu / sine)
        + expression.diff(P) * dP
        + expression.diff(dP) * second
    )


def over_xi(expression: sp.Expr) -> sp.Expr:
    """Derivative over xi of an expression of t = e^xi."""
    return t * expression.diff(t)


def gradient(part: sp.Expr, sign: int, order: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """d/dz and d/drho of sqrt(X) e^(sign (n + 1/2) xi) times a part, over the same factor."""
    along = over_xi(part) + (sign * (n + sp.Rational(1, 2)) + sinh / (2 * X)) * part
    around = -sine * (over_nu(part, order) - part / (2 * X))
    # the coordinates are conformal: both scale factors are 1/X
    slopes = [
        X**2 * (over_xi(each) * along - sine * over_nu(each, order) * around) for each in (z, rho)
    ]
    return slopes[0], slopes[1]


def neighbour(shift: int, order: sp.Expr) -> sp.Expr:
    """P_(n+shift)^order by P and dP, from the recurrences of Legendre's functions."""
    if shift == 0:
        return P
    below = ((1 - nu**2) * dP + n * nu * P) / (n + order)
    if shift < 0:
        return below
    return ((2 * n + 1) * nu * P - (n + order) * below) / (n - order + 1)


def raised(part: sp.Expr, order: int) -> sp.Expr:
    """P_n^(order+1) by P_n^order, given by P = P_n^0 and its derivative."""
    return sine * over_nu(part, sp.Integer(0)) + order * nu / sine * part


def legendre(shift: int, order: int) -> sp.Expr:
    """P_(n+shift)^order by P = P_n^0 and its derivative."""
    part = neighbour(shift, sp.Integer(0))
    for each in range(order):
        part = raised(part, each)
    return part


#: Derivatives by the factors of f_(n-1), f_n and f_(n+1); along z times s
ALONG_Z = (-(n + m) / 2, n + sp.Rational(1, 2), -(n - m + 1) / 2)
ALONG_X = ((n + m) / 2, -sp.Rational(1, 2), -(n - m + 1) / 2)
#: d/drho of m = 0; (d/drho + 1/rho) of m = 1; (d/drho + 2/rho) of m = 2: the order becomes 1, 0, 1
ACROSS = {
    0: (-sp.Rational(1, 2), sp.Integer(1), -sp.Rational(1, 2)),
    1: (n * (n + 1) / 2, -n * (n + 1), n * (n + 1) / 2),
    2: ((n + 1) * (n + 2) / 2, -(n - 1) * (n + 2), n * (n - 1) / 2),
}


def identity_along(sign: int, *, position: bool) -> sp.Expr:
    """Difference of both sides of d f/dz, or of x.grad f, for a symbolic degree and order."""
    by_z, by_rho = gradient(P, sign, m)
    left = z * by_z + rho * by_rho if position else by_z
    right = sum(
        (1 if position else sign) * factor * t ** (sign * shift) * neighbour(shift, m)
        for shift, factor in zip((-1, 0, 1), ALONG_X if position else ALONG_Z, strict=True)
    )
    return on_circle(left - right)


def identity_across(sign: int, order: int) -> sp.Expr:
    """Difference of both sides of (d/drho + order/rho) f, for a symbolic degree."""
    own = legendre(0, order)
    left = gradient(own, sign, sp.Integer(0))[1] + order / rho * own
    right = sum(
        factor * t ** (sign * shift) * legendre(shift, 0 if order == 1 else 1)
        for shift, factor in zip((-1, 0, 1), ACROSS[order], strict=True)
    )
    return on_circle(left - right)


def on_circle(expression: sp.Expr) -> sp.Expr:
    """An expression with even powers of sin(eta) by nu, over its lowest power of sin(eta)."""
    whole = sp.expand(sp.numer(sp.together(expression)))
    polynomial = sp.Poly(whole, sine)
    odd = {power % 2 for (power,) in polynomial.monoms()}
    if len(odd) > 1:
        raise ValueError("even and odd powers of sin(eta)")
    return sp.expand(sum(c * (1 - nu**2) ** (p // 2) for (p,), c in polynomial.terms()))


# --- surfaces ------------------------------------------------------------------------------------
#: Velocity of a surface, pressure, and the components of 2 v: orders 0 and 2, and the half of v_z
V_z, V_rho, V_phi, W, radius_, height = sp.symbols("V_z V_rho V_phi W rho_s z_s")
Q = 2 * (V_z - W) / height
U_0 = V_rho - V_phi - radius_ / height * (V_z - W)
U_2 = V_rho + V_phi - radius_ / height * (V_z - W)
#: for motion along the line of centres, where U_1 is in place of both
U_1 = 2 * V_rho - 2 * radius_ / height * (V_z - W)
#: Products by the factors of P_(n-1), P_n and P_(n+1): nu P_n^m, and sin(eta) P_n^m, whose order
#: increases or decreases by 1
COSINE = ((n + m) / (2 * n + 1), sp.Integer(0), (n - m + 1) / (2 * n + 1))
RAISED = (-1 / (2 * n + 1), sp.Integer(0), 1 / (2 * n + 1))
LOWERED = (n * (n + 1) / (2 * n + 1), sp.Integer(0), -n * (n + 1) / (2 * n + 1))


def identity_product(factors: tuple[Any, ...], order: int, to: int) -> sp.Expr:
    """Difference of both sides of nu P, where the order remains, or of sin(eta) P."""
    own = (nu if to == order else sine) * legendre(0, order)
    right = sum(
        factor.subs(m, order) * legendre(shift, to)
        for shift, factor in zip((-1, 0, 1), factors, strict=True)
    )
    return on_circle(own - right)


# --- the continuity equation ---------------------------------------------------------------------
#: how outgoing coefficients follow from the values of a surface: any function of the degree
outgoing = sp.Function("o")

Operator = dict[int, sp.Expr]


def rows(factors: tuple[Any, ...], order: int) -> Operator:
    """Factors of the degrees n - 1, n, n + 1 in row n; degree n gives `factors` to three rows."""
    return {
        -shift: sp.sympify(factor).subs(m, order).subs(n, n - shift)
        for shift, factor in zip((-1, 0, 1), factors, strict=True)
    }


def composed(after: Operator, before: Operator) -> Operator:
    """The rows of a product, with the factor `outgoing` of the degree between both."""
    found: Operator = {}
    for first, a in after.items():
        for second, b in before.items():
            term = a * outgoing(n + first) * b.subs(n, n + first)
            found[first + second] = found.get(first + second, sp.Integer(0)) + term
    return found


def continuity(order: int, sign: int) -> Operator:
    """Rows of the continuity equation over V_z - W on a surface with sinh(xi) = 1; cosh is C.

    The powers of e^xi belong to the singular factor of each degree.
    """
    C = sp.Symbol("C")
    spread = tuple(3 * (each == 1) + factor for each, factor in enumerate(ALONG_X))
    pressure = {shift: -2 * value for shift, value in rows(COSINE, order).items()}
    pressure[0] = pressure[0] + 2 * C
    parts = [(rows(spread, order), pressure)]
    if order == 0:
        lateral = {shift: -2 * value for shift, value in rows(RAISED, 0).items()}
        parts.append((rows(ACROSS[1], 1), lateral))
    else:
        for of, factors in ((0, LOWERED), (2, RAISED)):
            lateral = {shift: -value for shift, value in rows(factors, 1).items()}
            parts.append((rows(ACROSS[of], of), lateral))
    slope = rows(tuple(sign * each for each in ALONG_Z), order)
    parts.append((slope, {0: sp.Integer(-2)}))
    whole: Operator = {}
    for after, before in parts:
        for shift, value in composed(after, before).items():
            whole[shift] = whole.get(shift, sp.Integer(0)) + value
    return whole


# --- the mobility of Rotne, Prager and Yamakawa --------------------------------------------------
a_1, a_2, r = sp.symbols("a_1 a_2 r", positive=True)
_sum, _square = a_1 + a_2, (a_1 - a_2) ** 2
_share = (a_1**2 + a_2**2) / (3 * r**2)
#: factors of 1 and of n n, over 1/(6 pi mu): of spheres that are apart, and that overlap
APART = (3 / (4 * r) * (1 + _share), 3 / (4 * r) * (1 - 3 * _share))
OVERLAP = tuple(
    each / (32 * r**3 * a_1 * a_2)
    for each in (16 * r**3 * _sum - (_square + 3 * r**2) ** 2, 3 * (_square - r**2) ** 2)
)
#: angular velocity n_1 x F by a force on the other, and by a torque on it along and across the line
TURN = 3 / (4 * r**2)
TURNS = (3 / (4 * r**3), -3 / (8 * r**3))


def divergence(parts: tuple[sp.Expr, ...]) -> sp.Expr:
    """Radial part of the divergence of A 1 + B n n in space."""
    one, other = parts
    return one.diff(r) + other.diff(r) + 2 * other / r


# --- the motion of a pair ------------------------------------------------------------------------
#: relative mobilities along and across the line, as functions of the distance
along, across = (sp.Function(name)(r) for name in "ab")
place = sp.symbols("x y z", real=True)
_distance = sp.sqrt(sum(each**2 for each in place))


def tensor() -> sp.Matrix:
    """The relative mobility in Cartesian axes."""
    line = sp.Matrix(place) / _distance
    of = {name: name.subs(r, _distance) for name in (along, across)}
    return of[along] * line * line.T + of[across] * (sp.eye(3) - line * line.T)


def at_distance(expression: Any) -> Any:
    """An expression of the place at the point (0, 0, r)."""
    return expression.doit().subs({place[0]: 0, place[1]: 0}).doit().subs(place[2], r).doit()


def drift() -> sp.Matrix:
    """The divergence of the relative mobility at (0, 0, r), over kT."""
    mobility = tensor()
    found = [sum(mobility[i, j].diff(place[j]) for j in range(3)) for i in range(3)]
    return sp.Matrix([at_distance(each) for each in found])


def drift_of_distance() -> sp.Expr:
    """Mean rate of the distance without a force, over kT, by Ito's formula."""
    mobility = tensor()
    curved = sum(
        mobility[i, j] * _distance.diff(place[i]).diff(place[j]) for i in range(3) for j in range(3)
    )
    return sp.simplify(drift()[2] + at_distance(curved))


DISTANCE = Equation(
    "-",
    "drift of the distance of two beads without forces",
    r"\langle d\rho \rangle/(kT\,dt)",
    along.diff(r) + 2 * along / r,
)
#: distance of the centres, beside the place |W| in the plane; force over kT that the plane requires
distance = sp.Symbol("d", positive=True)
FORCE_IN_PLANE = wall.F + 2 / distance

# --- what is emitted -----------------------------------------------------------------------------
#: terms of a series, and number of mobilities
TERMS, MOBILITIES = 14, 18
#: factor of the mobility along the line that vanishes with the gap, by the sum of the radii
gap, total = sp.symbols("gap total", positive=True)
VANISHING = 1 / (1 + total / gap)
#: place in the series, w, and its derivative over the gap
PLACE = sp.log(1 + 2 * total / gap)
CHANGE_OF_PLACE = sp.factor(PLACE.diff(gap))


def tables() -> dict[str, Any]:
    """Return all values that `templates/pair.py.jinja` uses, by name."""
    return {
        "terms": TERMS,
        "mobilities": MOBILITIES,
        "apart": tuple(sp.factor(each) for each in _along_and_across(APART)),
        "overlap": _along_and_across(OVERLAP),
        "turn": TURN,
        "turns": TURNS,
        "vanishing": VANISHING,
        "vanishing_slope": sp.factor(VANISHING.diff(gap)),
        "change": CHANGE_OF_PLACE,
    }


def _along_and_across(parts: tuple[sp.Expr, ...]) -> tuple[sp.Expr, sp.Expr]:
    """The mobilities along and across the line, from the factors of 1 and of n n."""
    one, other = parts
    return one + other, one
