"""A sphere beside a plane wall: its mobilities by smooth factors, and the plane of its gap.

Lengths are in radii, and mobilities relative to those far away. Let g be the gap and
s = 1/(1 + g). The mobilities are products of factors that are smooth from contact to infinity, so
values and derivatives keep their digits at both ends. `derivation.wall_coefficients` computes their
series over w = ln(1 + 2/g).

Brownian motion away from the wall, with kT = 1 and in units of a and of a^2/D far away,

    dg = mu F dt + mu' dt + sqrt(2 mu) dB,

requires a drift mu' that fails near contact and a rule for contact itself. Lubrication makes mu
proportional to g there, so g is the squared radius of a Brownian motion in a plane. For any mu,

    dW = (S F/2 + T) W dt + dB,    r = |W|,    g = g(r) with dg/dr = sqrt(2 mu),
    S = sqrt(2 mu)/r,    T = (mu'/sqrt(2 mu) - 1/r)/(2 r),

has additive noise, and its only singularity is the logarithm of lubrication in T.
"""

from __future__ import annotations

import functools
import math
from fractions import Fraction
from typing import Any

import sympy as sp

from . import wall_coefficients as wc
from .equations import Equation
from .symbols import RELAXATION, STEP
from .wall_coefficients import Series

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
PLANE_PROCESS = Equation(
    "-",
    "the point in the plane, in radii and a^2/D, F in kT/a; its noise is that of Brownian motion",
    "dW",
    sp.MatMul(sp.Matrix(PLACE), (BY_FORCE * F / 2 + BY_PLACE) * sp.Symbol("dt"), evaluate=False)
    + sp.Matrix(sp.symbols("dB_1 dB_2")),
)
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

# --- with inertia --------------------------------------------------------------------------------
#: step, its initial relaxation time m mu, and e^(-h/tau)
h, tau = STEP.symbol, RELAXATION.symbol
E = sp.Symbol("E", positive=True)
#: <(x - x_0) v> over kT mu for a free bead with Maxwell's initial velocity: half the rate of its
#: mean squared displacement
CORRELATION = 1 - E
#: An exact step with the initial mobility omits terms of first order in mu' from the means of x and
#: v. The equation dv = -(v/tau) (1 - (mu'/mu) (x - x_0)) dt + ... drives them by <(x - x_0) v>.
#: Here they are divided by the drift kT mu'
CHANGE_OF_PLACE = h - 2 * tau * (1 - E) + h * E
CHANGE_OF_VELOCITY = 1 - E - h * E / tau
#: The noise of the position has the variance 2 kT mu h'; the plane causes the drift in the time h'
SPREADING = h - 2 * tau * (1 - E) + tau * (1 - E**2) / 2


def over_time(expression: sp.Expr) -> sp.Expr:
    """Return d/dh of an expression of h and E."""
    return expression.diff(h) - E / tau * expression.diff(E)


# --- what is emitted ------------------------------------------------------------------------------
#: Terms of a series that are emitted
TERMS = 10


def tables(series: Series) -> dict[str, Any]:
    """Return all values that `templates/wall.py.jinja` uses, by name."""
    return {
        "contact": float(wc.CONTACT),
        "touching": float(wc.spin_at_contact()),
        "pieces": wc.PIECES,
        "pieces_per_w": float(wc.PIECES / wc.range_of_w()),
        "rows": [_row(piece) for piece in series],
        "factors": _names(),
        "values": MOBILITIES,
        "slopes": SLOPES,
        "change_of_w": CHANGE_OF_W,
        "bounds": bounds(series),
    }


def bounds(series: Series) -> dict[str, tuple[float, float]]:
    """Largest relative error of each mobility and of its derivative, from CONTACT to infinity.

    By what the degrees left out can add to a factor, the last of those made counted once more for
    all beyond: each is smaller than the one before by a factor of 8 and more.
    """
    step, points = float(wc.range_of_w() / wc.PIECES), 32
    known = [g, s, rest, touching, *FACTORS, *RATES]
    rules = {
        name: sp.lambdify(known, [value, slope, *_by_errors(value), *_by_errors(slope)], "math")
        for name, value in MOBILITIES.items()
        for slope in (SLOPES[name],)
    }
    worst = {name: [0.0, 0.0] for name in MOBILITIES}
    for at, piece in enumerate(series):
        left = [[abs(c) for c in each[TERMS:]] for each in piece]
        errors = [sum(each) + each[-1] for each in left]
        slopes = [
            2 / step * (sum(c * k**2 for k, c in enumerate(each, TERMS)) + each[-1] * wc.MADE**2)
            for each in left
        ]
        for point in range(points + 1):
            x = 2 * point / points - 1
            gap = 2 / math.expm1(step * max(at + point / points, 1e-3))
            share = 1 / (1 + gap)
            change = float(CHANGE_OF_W.subs({s: share, rest: 1 - share}))
            factors = [_value(each, x) for each in piece]
            rates = [change * 2 / step * _slope(each, x) for each in piece]
            place = (gap, share, 1 - share, float(wc.spin_at_contact()), *factors, *rates)
            off = [*errors, *(abs(change) * each for each in slopes)]
            for name, rule in rules.items():
                value, slope, *by = rule(*place)
                for k, true in enumerate((value, slope)):
                    weights = by[k * len(off) : (k + 1) * len(off)]
                    error = sum(abs(w) * e for w, e in zip(weights, off, strict=True)) / abs(true)
                    worst[name][k] = max(worst[name][k], error)
    return {name: (_upward(value), _upward(slope)) for name, (value, slope) in worst.items()}


def _by_errors(expression: sp.Expr) -> list[sp.Expr]:
    """Derivatives over the factors and their rates."""
    return [expression.diff(each) for each in (*FACTORS, *RATES)]


def _value(series: list[float], x: float) -> float:
    return math.fsum(c * math.cos(k * math.acos(x)) for k, c in enumerate(series))


def _slope(series: list[float], x: float) -> float:
    """Derivative over x: T_k' = k U_(k-1)."""
    before, own, whole = 0.0, 1.0, 0.0
    for k, c in enumerate(series[1:], 1):
        whole += c * k * own
        before, own = own, 2 * x * own - before
    return whole


def _upward(value: float) -> float:
    """Return a number of two digits that is not less than `value`."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / unit * 1.01) * unit:.1e}")


def _names() -> dict[str, dict[str, list[str]]]:
    """Return the entries of a row with the powers of each factor, and those of its derivative."""
    n, found = len(FACTORS), {}
    for at, factor in enumerate(FACTORS):
        powers = [f"c[{n * power + at}]" for power in range(TERMS)]
        slope = [f"{float(power)} * {name}" for power, name in enumerate(powers)]
        found[str(factor)] = {"value": powers, "slope": [powers[1], *slope[2:]]}
    return found


def _row(piece: list[list[float]]) -> tuple[float, ...]:
    """Return the powers of a piece: all factors for each power."""
    by_factor = [_powers([Fraction(c) for c in series[:TERMS]]) for series in piece]
    return tuple(float(by[power]) for power in range(TERMS) for by in by_factor)


def _powers(series: list[Fraction]) -> list[Fraction]:
    """Convert a Chebyshev series to powers, exactly."""
    whole = [Fraction(0)] * len(series)
    for degree, coefficient in enumerate(series):
        for power, factor in enumerate(_chebyshev(degree)):
            whole[power] += coefficient * factor
    return whole


@functools.cache
def _chebyshev(degree: int) -> tuple[int, ...]:
    x = sp.Symbol("x")
    return tuple(int(c) for c in reversed(sp.Poly(sp.chebyshevt(degree, x), x).all_coeffs()))
