"""A sphere beside a plane wall: its mobilities by smooth factors, and the plane of its gap.

Lengths in radii, mobilities over those far away. With s = 1/(1 + g) of the gap g, the mobilities
are made of factors that are smooth from contact to infinity, so that values and derivatives keep
their digits at both ends; `derivation.wall_coefficients` has their series over w = ln(1 + 2/g).

Brownian motion away from the wall, with kT = 1 and in units of a and of a^2/D far away,

    dg = mu F dt + mu' dt + sqrt(2 mu) dB,

needs a drift mu' that fails near contact and a rule for contact itself. Lubrication makes mu
proportional to g there, and so g the squared radius of a Brownian motion in a plane. For any mu,

    dW = (S F/2 + T) W dt + dB,    r = |W|,    g = g(r) with dg/dr = sqrt(2 mu),
    S = sqrt(2 mu)/r,    T = (mu'/sqrt(2 mu) - 1/r)/(2 r),

has additive noise, and nothing in it is singular but the logarithm of lubrication in T.
"""

from __future__ import annotations

import functools
from fractions import Fraction
from typing import Any

import sympy as sp

from . import wall_coefficients as wc
from .equations import Equation
from .wall_coefficients import Coefficients

# --- mobilities ----------------------------------------------------------------------------------
g = sp.Symbol("g", positive=True)
#: radius over the distance of the centre, and the gap over that distance
s, rest = sp.symbols("s rest", positive=True)
#: 1 - 1/zeta(3): how much less a bead that touches the wall spins
touching = sp.Symbol("TOUCHING", positive=True)
#: the factors by w, and their derivatives over g
FACTORS = sp.symbols("A B C D E")
RATES = sp.symbols("dA dB dC dD dE")
_A, _B, _C, _D, _E = FACTORS

#: a bead that nothing else acts on; roll is a W/U of a bead pulled along the wall
MOBILITIES = {
    "perpendicular": rest * (1 + s * _A),
    "parallel": 1 - s * _B,
    "spin": 1 - s**3 * (touching + rest * _C),
    "turn": 1 - s**3 * _D,
    "roll": s**4 * _E,
}


def over_gap(expression: sp.Expr) -> sp.Expr:
    """Derivative over g of an expression of s, rest and the factors."""
    change = expression.diff(s) * -(s**2) + expression.diff(rest) * s**2
    return change + sum(
        expression.diff(factor) * rate for factor, rate in zip(FACTORS, RATES, strict=True)
    )


SLOPES = {name: over_gap(value) for name, value in MOBILITIES.items()}
#: dw/dg of w = ln(1 + 2/g)
CHANGE_OF_W = -2 * s**2 / (rest * (1 + s))

# --- far away ------------------------------------------------------------------------------------
#: H. Faxen's and H. A. Lorentz's series of the perpendicular mobility over s, up to s^3
FAR = 1 - sp.Rational(9, 8) * s + s**3 / 2
h, K = sp.symbols("h K", positive=True)


def _far_way() -> sp.Expr:
    """sqrt(2) r - K at the height h = 1 + g: the integral of 1/sqrt(mu) by its series over 1/h."""
    series = sp.series(1 / sp.sqrt(FAR), s, 0, 4).removeO()
    return sp.integrate(sp.expand(series.subs(s, 1 / h)), h)


FAR_WAY = _far_way()

# --- the plane -----------------------------------------------------------------------------------
r = sp.Symbol("r", positive=True)
#: the plane's factors by ln of what is near to the gap
PLANE_FACTORS = sp.symbols("G H L P")
_G, _H, _L, _P = PLANE_FACTORS
#: place in the plane, with r = |W|
PLACE = sp.symbols("W_1 W_2", real=True)
#: R = dg/dr = sqrt(2 mu) of any mobility, so that dR/dr = mu'; and F, the slope of -U/kT
root, mu_g, F = sp.symbols("R mu_g F", real=True)
BY_FORCE = root / r
BY_PLACE = (mu_g / root - 1 / r) / (2 * r)
#: of W: its noise is dB
DRIFT = [each * (BY_FORCE * F / 2 + BY_PLACE) for each in PLACE]
#: slope over r of ln of the density e^(-U/kT) R/r
BOLTZMANN = F * root + mu_g / root - 1 / r


def over_place(expression: sp.Expr, along: sp.Symbol) -> sp.Expr:
    """Derivative over a component of W of what depends on W, r, R and g."""
    by_r = expression.diff(r) + root * expression.diff(g) + mu_g * expression.diff(root)
    return expression.diff(along) + along / r * by_r


def by_ito(expression: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Drift and squared noise of a function of W, from both components of its noise."""
    slopes = [over_place(expression, along) for along in PLACE]
    drift = sum(
        slope * own + over_place(slope, along) / 2
        for slope, own, along in zip(slopes, DRIFT, PLACE, strict=True)
    )
    return drift, sum(slope**2 for slope in slopes)


def on_circle(expression: sp.Expr) -> sp.Expr:
    """An expression of W at |W| = r."""
    q = sp.Symbol("q", real=True)
    ends = (r * (1 - q**2) / (1 + q**2), 2 * r * q / (1 + q**2))
    return expression.subs(dict(zip(PLACE, ends, strict=True)))


DRIFT_OF_GAP, NOISE_OF_GAP = (sp.factor(on_circle(each)) for each in by_ito(g))
GAP = Equation(
    "-",
    "motion of the gap, by Ito's formula from that in the plane",
    "dg",
    DRIFT_OF_GAP.subs(root, sp.sqrt(2 * sp.Symbol("mu"))) * sp.Symbol("dt")
    + sp.sqrt(NOISE_OF_GAP.subs(root, sp.sqrt(2 * sp.Symbol("mu")))) * sp.Symbol("dB"),
)

# --- its series ----------------------------------------------------------------------------------
share = sp.Symbol("share", positive=True)
#: what falls from contact to far away like S
SHARE = 1 / (1 + r / sp.sqrt(2))
#: near to half the gap, or to the gap near contact
NEAR = r**2 / 2 * share
PLANE = {
    "gap": NEAR * _G,
    "by_force": share * _H,
    "by_place": _L / (1 + r**2),
    "parallel": _P,
}


# --- what is emitted ------------------------------------------------------------------------------
#: Terms of the series of the mobilities' factors, and of the plane's
TERMS, PLANE_TERMS = 10, 9


def tables(made: Coefficients) -> dict[str, Any]:
    """All that `templates/wall.py.jinja` has names for."""
    contact = wc.CONTACT
    low, high = (float(wc.variable(each)) for each in (made.touching, made.far))
    begin, root = made.plane[0], sp.sqrt(2)
    at_contact = dict(zip(PLANE, map(float, _at_begin(begin, made.touching)), strict=True))
    return {
        "contact": float(contact),
        "touching": float(wc.spin_at_contact()),
        "pieces": wc.PIECES,
        "pieces_per_w": float(wc.PIECES / wc.range_of_w()),
        "mobilities": [_row(piece, TERMS) for piece in made.mobilities],
        "factors": _names(FACTORS, TERMS),
        "values": MOBILITIES,
        "slopes": SLOPES,
        "change_of_w": CHANGE_OF_W,
        "r_contact": made.touching,
        "r_far": made.far,
        "plane_begin": low,
        "plane_pieces_per_y": wc.PIECES / (high - low),
        "plane": [_row(piece, PLANE_TERMS) for piece in made.plane],
        "plane_factors": _names(PLANE_FACTORS, PLANE_TERMS),
        "plane_values": PLANE,
        "share": SHARE,
        "near": NEAR,
        "far_rest": FAR_WAY - h,
        "far_constant": float((root * made.far - FAR_WAY.subs(h, 1 + wc.FAR)).evalf()),
        "at_contact": at_contact,
    }


def _at_begin(piece: list[list[float]], touching: float) -> list[sp.Expr]:
    """The plane's values at the begin of a piece, where T_k = (-1)^k."""
    factors = [sum((-1) ** k * c for k, c in enumerate(series)) for series in piece]
    known = {**dict(zip(PLANE_FACTORS, factors, strict=True)), share: SHARE}
    return [value.subs(known).subs(r, touching).evalf() for value in PLANE.values()]


def _names(factors: tuple[sp.Symbol, ...], terms: int) -> dict[str, dict[str, list[str]]]:
    """Of each factor where its powers stand in a row, and those of its derivative."""
    n, found = len(factors), {}
    for at, factor in enumerate(factors):
        powers = [f"c[{n * power + at}]" for power in range(terms)]
        slope = [f"{float(power)} * {name}" for power, name in enumerate(powers)]
        found[str(factor)] = {"value": powers, "slope": [powers[1], *slope[2:]]}
    return found


def _row(piece: list[list[float]], terms: int) -> tuple[float, ...]:
    """The powers of a piece: of each power all factors."""
    by_factor = [_powers([Fraction(c) for c in series[:terms]]) for series in piece]
    return tuple(float(by[power]) for power in range(terms) for by in by_factor)


def _powers(series: list[Fraction]) -> list[Fraction]:
    """A Chebyshev series by powers, exactly."""
    whole = [Fraction(0)] * len(series)
    for degree, coefficient in enumerate(series):
        for power, factor in enumerate(_chebyshev(degree)):
            whole[power] += coefficient * factor
    return whole


@functools.cache
def _chebyshev(degree: int) -> tuple[int, ...]:
    x = sp.Symbol("x")
    return tuple(int(c) for c in reversed(sp.Poly(sp.chebyshevt(degree, x), x).all_coeffs()))
