"""The exact force and torque of light on a body of any shape.

The light about the body is a sum of vector harmonics of helicity l = +1 or -1 with amplitudes
p_nm. In the frame of the body, its matrix S gives the scattered light q = S p. With the change
t = q - p of the light and v = p + q = 2p + t,

    F = -(n_m/c) Re<t|s|v>,    M = -(1/omega) Re<t|J|v>,    absorbed power = -Re<t|v>.

The vector s is the direction of a plane wave and J the angular momentum, see `derivation.waves`.
Because t is a factor of each term, a small body loses no digit. The conventions are
exp(-i omega t) and amplitudes without the factor i^m that `derivation.waves` takes out.

Three further results are used at run time without being emitted:

- rotations, by two constant matrices;
- translations;
- the surface integrals of the extended boundary condition method, which give S for a homogeneous
  body of revolution (Waterman, Phys. Rev. D 3, 825 (1971)).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import sympy as sp

from . import symbols as sy
from .equations import Equation
from .waves import Named, Pair, im_of_product, named, pair, re_of_product

_HALF = sp.Float(0.5)

# --- the summands ------------------------------------------------------------------------------
t, v = pair(sy.CHANGE), pair(sy.AMPLITUDE)
_before, _above = pair(sy.BEFORE), pair(sy.ABOVE)
_up_before, _up, _up_above = pair(sy.UP_BEFORE), pair(sy.UP), pair(sy.UP_ABOVE)
_down_before, _down, _down_above = pair(sy.DOWN_BEFORE), pair(sy.DOWN), pair(sy.DOWN_ABOVE)
_partner_down, _partner, _partner_up = (
    pair(sy.PARTNER_DOWN), pair(sy.PARTNER), pair(sy.PARTNER_UP)
)  # fmt: skip
_al, _al_above, _be = sy.ALONG.symbol, sy.ALONG_ABOVE.symbol, sy.WITHIN.symbol
_e1, _e0, _em = sy.RAISED.symbol, sy.TURNED.symbol, sy.LOWERED.symbol
_e1_down, _e0_down, _em_down = (
    sy.RAISED_DOWN.symbol, sy.TURNED_DOWN.symbol, sy.LOWERED_DOWN.symbol
)  # fmt: skip
_m, _lift, _lift_down = sy.ORDER.symbol, sy.LIFT.symbol, sy.LIFT_DOWN.symbol

#: s_+ v, s_- v and s_z v at (n, m). Within n, s exchanges the electric and the magnetic part
DIRECTED = (
    _e1_down * _down_before + _e0_down * _partner_down + _em_down * _down_above,
    _em * _up_before + _e0 * _partner_up + _e1 * _up_above,
    _al * _before + _be * _partner + _al_above * _above,
)
#: J_+ v, J_- v and J_z v at (n, m)
TURNED = (_lift_down * _down, _lift * _up, _m * v)


def parts(values: Iterable[Pair]) -> sp.Matrix:
    """Return real and imaginary parts of complex numbers as a column."""
    return sp.Matrix([part for value in values for part in (value.re, value.im)])


def lateral(plus: Pair, minus: Pair) -> tuple[Pair, Pair]:
    """Return the x and y components, (plus + minus)/2 and (plus - minus)/2i."""
    over_i = Pair(plus.im - minus.im, minus.re - plus.re)
    return _HALF * (plus + minus), _HALF * over_i


_s = tuple(pair(names) for names in sy.DIRECTED_V.values())
_J = tuple(pair(names) for names in sy.TURNED_V.values())
FORCE_PARTS = named(*zip(sy.DIRECTED_V.values(), DIRECTED, strict=True))
TORQUE_PARTS = named(*zip(sy.TURNED_V.values(), TURNED, strict=True))


def _minus_re_of_products(plus: Pair, minus: Pair, along: Pair) -> tuple[sp.Expr, ...]:
    """Return -Re(t* a_i) for the components x, y and z of a vector a."""
    return (
        -_HALF * re_of_product(t, plus + minus),
        -_HALF * im_of_product(t, plus - minus),
        -re_of_product(t, along),
    )


#: -Re(t* s_i v)
FORCE = sp.Matrix(_minus_re_of_products(*_s))
#: -Re(t* J_i v), and -Re(t* v)
TORQUE = sp.Matrix([*_minus_re_of_products(*_J), -re_of_product(t, v)])

# --- derivatives ---------------------------------------------------------------------------------
# A displacement dr of the body changes the light by i k (s.dr) p, a rotation by d eps about the
# body's axes by i (J.d eps) p. With A and B each one of s and J,
#
#     d(-Re<t|A|v>) = 2 Im<h|B p>,    h = A t + (S - 1)^+ A q,    q = p + t.

#: s_x, s_y, s_z, J_x, J_y and J_z on the amplitudes, at (n, m)
GENERATORS = (
    *lateral(_s[0], _s[1]), _s[2], *lateral(_J[0], _J[1]), _J[2],
)  # fmt: skip
GENERATORS_PARTS: Named = (*FORCE_PARTS, *TORQUE_PARTS)


_twice_h = pair(sy.TWICE_RETURNED)
DERIVATIVE_PARTS = named((sy.TWICE_RETURNED, 2 * pair(sy.RETURNED)))
#: derivatives of -Re<t|A|v> by the six generators B
DERIVATIVE = sp.Matrix([im_of_product(_twice_h, pair(names)) for names in sy.GENERATED])

# --- rotations ---------------------------------------------------------------------------------
# A field turned by R = Rz(alpha) Ry(beta) Rz(gamma) has the amplitudes D(R) p, whatever the
# helicity, with D^n = exp(-i alpha J_z) d^n(beta) exp(-i gamma J_z).


def reduced_rotation(n: int, row: int, column: int, cosine: sp.Expr, sine: sp.Expr) -> sp.Expr:
    """Return d^n_{m'm}(beta) over sqrt of `order_norm` of m' and of m, by Wigner's formula.

    Parameters
    ----------
    n : int
        Degree.
    row, column : int
        Orders m' and m.
    cosine, sine : sympy.Expr
        Cosine and sine of beta/2.
    """
    raised = row - column
    return sp.Add(
        *(
            sp.Rational(
                (-1) ** (raised + i),
                sp.factorial(n + column - i)
                * sp.factorial(i)
                * sp.factorial(raised + i)
                * sp.factorial(n - row - i),
            )
            * cosine ** (2 * n - raised - 2 * i)
            * sine ** (raised + 2 * i)
            for i in range(max(0, -raised), min(n + column, n - row) + 1)
        )
    )


def order_norm(n: int, m: int) -> sp.Expr:
    """Return (n + m)! (n - m)!."""
    return sp.factorial(n + m) * sp.factorial(n - m)


def rotation(n: int, cosine: sp.Expr, sine: sp.Expr) -> sp.Matrix:
    """Return d^n(beta) from the cosine and sine of beta/2, with orders from -n to n."""
    return sp.Matrix(
        2 * n + 1,
        2 * n + 1,
        lambda i, j: (
            sp.sqrt(order_norm(n, i - n) * order_norm(n, j - n))
            * reduced_rotation(n, i - n, j - n, cosine, sine)
        ),
    )


def angular_momentum(n: int) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """Return J_x, J_y and J_z between the orders -n to n of one degree."""
    plus = sp.zeros(2 * n + 1)
    for at in range(2 * n):
        order = at - n
        plus[at + 1, at] = sp.sqrt((n - order) * (n + order + 1))
    along = sp.diag(*range(-n, n + 1))
    return (plus + plus.T) / 2, (plus - plus.T) / (2 * sp.I), along


# --- the surface of a body ---------------------------------------------------------------------
r, theta, phi = sp.symbols("r theta phi", positive=True)
#: r'/r on the surface r(theta)
slope = sp.Symbol(r"{\frac{r'}{r}}", real=True)
#: index of the body relative to the medium
index = sp.Symbol("m", complex=True)
#: x = k r, and x_1 = m x inside of the body
x, x_inside = sp.Symbol("x", positive=True), sp.Symbol("x_1", complex=True)

Vector = tuple[sp.Expr, sp.Expr, sp.Expr]


class Factors(NamedTuple):
    """Factors of a wave of one degree n and order m on the surface."""

    radial: sp.Symbol
    """Riccati-Bessel function psi_n or chi_n"""
    radial_slope: sp.Symbol
    """its derivative"""
    polar: sp.Symbol
    """y, the polar part of the spherical harmonic"""
    tau: sp.Symbol
    """y'/nu"""
    pi: sp.Symbol
    """m y/(nu sin(theta))"""
    nu: sp.Symbol
    """sqrt(n (n + 1))"""


#: the test wave, outside, and the wave inside of the body
TEST = Factors(*sp.symbols(r"\zeta {\zeta'} y \tau \pi \nu", complex=True))
INNER = Factors(*sp.symbols(r"\psi_1 {\psi_1'} y_1 \tau_1 \pi_1 \nu_1", complex=True))


def curl(field: Vector) -> Vector:
    """Return the curl of a vector field in spherical coordinates."""
    along, polar, azimuthal = field
    sine = sp.sin(theta)
    return (
        (sp.diff(sine * azimuthal, theta) - sp.diff(polar, phi)) / (r * sine),
        (sp.diff(along, phi) / sine - sp.diff(r * azimuthal, r)) / r,
        (sp.diff(r * polar, r) - sp.diff(along, theta)) / r,
    )


def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product of two vectors."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def wave(kind: str, radial: sp.Expr, harmonic: sp.Expr, nu: sp.Expr, wavenumber: sp.Expr) -> Vector:
    """Return a vector spherical wave.

    Parameters
    ----------
    kind : str
        "M", magnetic: f(kr)/(kr) Phi with Phi = r x grad Y/nu. "N", electric: curl M/k.
    radial : sympy.Expr
        Riccati-Bessel function f, as a function of r.
    harmonic : sympy.Expr
        Spherical harmonic Y.
    nu : sympy.Expr
        sqrt(n (n + 1)).
    wavenumber : sympy.Expr
        Wavenumber k.
    """
    scale = radial / (wavenumber * r * nu)
    magnetic = (
        sp.Integer(0),
        -scale * sp.diff(harmonic, phi) / sp.sin(theta),
        scale * sp.diff(harmonic, theta),
    )
    if kind == "M":
        return magnetic
    return tuple(each / wavenumber for each in curl(magnetic))


def _on_surface(kind: str, sign: int, factors: Factors, at: sp.Expr) -> Vector:
    """Return a wave of the order sign * m, at phi = 0, by its factors; `at` is its x."""
    f, y = sp.Function("f")(r), sp.Function("y")(theta)
    order, wavenumber = sp.Symbol("order"), sp.Symbol("k")
    field = wave(kind, f, y * sp.exp(sign * sp.I * order * phi), factors.nu, wavenumber)
    sine = sp.sin(theta)
    legendre = -sp.cos(theta) / sine * y.diff() - (factors.nu**2 - order**2 / sine**2) * y
    known = (
        (y.diff(theta, 2), legendre),
        (y.diff(), factors.nu * factors.tau),
        (f.diff(), wavenumber * factors.radial_slope),
        (order, factors.pi * factors.nu * sine / y),
        (y, factors.polar),
        (f, factors.radial),
        (wavenumber, at / r),
    )
    result = []
    for each in field:
        value = sp.sympify(each).doit().subs(phi, 0)
        for old, new in known:
            value = sp.expand(value.subs(old, new))
        result.append(value)
    return result[0], result[1], result[2]


def _integrand(test: str, inner: str) -> sp.Expr:
    """Return n.(A x B) over w, with the test wave A of the order -m and the inner wave B."""
    a = _on_surface(test, -1, TEST, x)
    b = _on_surface(inner, 1, INNER, x_inside)
    product = cross(a, b)
    return sp.expand(x * x_inside * (product[0] - slope * product[1]))


#: n.(A x B) dS = SURFACE[A, B] w du dphi of a test wave A and an inner wave B, u = cos(theta)
#: and w = r^2/(x x_1), which does not depend on r
SURFACE = {(test, inner): _integrand(test, inner) for test in "MN" for inner in "MN"}
_OTHER = {"M": "N", "N": "M"}
#: n.(A x curl B - B x curl A)/k likewise, as curl M = k N and curl N = k M. Its integral over the
#: surface is Q. With the test waves' psi_n and chi_n = x y_n(x), T = -Q[psi] Q[psi + i chi]^-1
BOUNDARY = {
    (test, inner): index * SURFACE[test, _OTHER[inner]] + SURFACE[_OTHER[test], inner]
    for test, inner in SURFACE
}

#: depolarisation factor of a spheroid, and its volume over 4 pi/3, in units of 1/k^3
depolarisation, volume = sp.symbols("L V", positive=True)
#: h = 1 - a^2/c^2 of the semi-axes a across and c along, and A = artanh(sqrt(h))/sqrt(h)
flattening, artanh = sp.Symbol("h", real=True), sp.Symbol("A", positive=True)
#: the factor along the axis; the two across it are (1 - L)/2
depolarisation_along = (1 - flattening) * (artanh - 1) / flattening
#: T of the electric waves of degree 1 of a small spheroid
small_spheroid = (
    sp.Rational(2, 9) * sp.I * volume * (index**2 - 1) / (1 + depolarisation * (index**2 - 1))
)

# --- translations --------------------------------------------------------------------------------
# Displaced by d along z, light is multiplied by exp(i k s.d), the sum of Rayleigh. Its elements
# between harmonics of one helicity keep m, and only L = |n - n'| ... n + n' contribute:
# g_L = 2 pi integral f_n'm f_nm P_L du. For waves that leave another body, h_L replaces j_L.
degree, distance = sp.Symbol("L", integer=True, nonnegative=True), sp.Symbol("z", positive=True)


def rayleigh_term(L: sp.Expr, u: sp.Expr, radial: sp.Expr) -> sp.Expr:
    """Return the term i^L (2 L + 1) z_L P_L(u) of exp(i k d u), z_L a spherical Bessel function."""
    return sp.I**L * (2 * L + 1) * radial * sp.legendre(L, u)


_matrix = sp.Symbol("N", integer=True, positive=True)
_Z, _E, _Delta = (sp.MatrixSymbol(name, _matrix, _matrix) for name in ("Z", "E", r"\Delta"))
_n_m, _c, _omega = sp.symbols("n_m c omega", positive=True)


def _bracket(operator: str) -> sp.Expr:
    return sp.re(sp.Symbol(rf"\langle t|{operator}2p+t\rangle"))


FORCE_ON_BODY = Equation("-", "force on a body", "F", -_n_m / _c * _bracket("s|"))
TORQUE_ON_BODY = Equation("-", "torque on a body", "M", -_bracket("J|") / _omega)
POWER_ABSORBED = Equation("-", "power that a body absorbs", "P", -_bracket(""))
ROTATION = Equation(
    "-",
    "rotation by two constant matrices",
    r"d^n(\beta)",
    _Z * _Delta.T * _E * _Delta * _Z.adjoint(),
)
SURFACE_EQUATIONS = tuple(
    Equation(
        "-",
        f"test wave {test}, inner wave {inner}",
        rf"\frac{{n\cdot({test}\times {inner}_1)}}{{w}}",
        SURFACE[test, inner],
    )
    for test, inner in SURFACE
)
SMALL_SPHEROID = Equation("-", "small spheroid", "T_{E1}", small_spheroid)
