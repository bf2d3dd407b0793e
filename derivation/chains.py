r"""Force and extension of a polymer between two points.

With l the extension over the contour length Lc, f = F Lp/kT and s = kT/(Lp S), where Lp is the
persistence length and S the stretch modulus,

    worm-like chain   f = 1/(4 (1 - l)^2) - 1/4 + l + ...,
    Odijk             l = 1 - 1/(2 sqrt f) + s f,
    twistable         l = 1 - 1/(2 sqrt f) + s f/(1 - c^2),   c = c_0 + c_1 f,
    freely jointed    l = (coth u - 1/u) (1 + s f),   u = 2 f.

The constant c is the twist-stretch coupling g = g_0 + g_1 F over sqrt(S C), where C is the twist
rigidity. The derivatives are exact. The emitted forms keep their digits: the law of Marko and
Siggia has no difference of nearly equal terms at small l, and Langevin's function has a series at
small u. The root y of f replaces f where it occurs.

References
----------
J. F. Marko and E. D. Siggia, Macromolecules 28, 8759 (1995).
C. Bouchiat et al., Biophys. J. 76, 409 (1999): the powers of l from 2 to 7.
T. Odijk, Macromolecules 28, 7016 (1995).
S. B. Smith, Y. Cui and C. Bustamante, Science 271, 795 (1996): freely jointed segments.
P. Gross et al., Nature Physics 7, 731 (2011): twist.
"""

from __future__ import annotations

import sympy as sp

from . import symbols as sy

l, u, e = (
    each.symbol for each in (sy.SCALED_EXTENSION, sy.LANGEVIN_ARGUMENT, sy.LANGEVIN_DECAY)
)  # fmt: skip
y, s = sy.ROOT_FORCE.symbol, sy.COMPLIANCE.symbol
c_0, c_1 = (each.symbol for each in sy.TWIST_COUPLING)

#: coefficients of l^2 to l^7
_BOUCHIAT = ("-0.5164228", "-2.737418", "16.07497", "-38.87607", "39.49944", "-14.17718")
#: number of terms of the series of Langevin's function, and the argument below which it is used:
#: there the first term that is left out is below 1e-16
TERMS, SMALL = 10, sp.Rational(1, 2)

# --- worm-like chains -----------------------------------------------------------------------------
#: 1/(4 (1 - l)^2) - 1/4 + l
marko_siggia = l * (2 - l) / (4 * (1 - l) ** 2) + l
_powers = l**2 * sp.horner(
    sum(sp.Float(each) * l**power for power, each in enumerate(_BOUCHIAT)), wrt=l
)
bouchiat = marko_siggia + _powers


def thermal_shortening() -> sp.Expr:
    """Return (1 - l) Lc of a nearly straight chain of a bending rigidity `A` under a force `F`.

    By equipartition, the mean square of each of the two slopes is the integral of
    kT/(A q^2 + F)/(2 pi) over all wave numbers q. Half of their sum is the shortening.
    """
    q, A, F, kT = sp.symbols("q A F kT", positive=True)
    return sp.integrate(kT / (A * q**2 + F), (q, 0, sp.oo)) / sp.pi


#: extension of a stiff chain that stretches, and of one that also twists
odijk = 1 - 1 / (2 * y) + s * y**2
_coupling = c_0 + c_1 * y**2
twistable = 1 - 1 / (2 * y) + s * y**2 / (1 - _coupling**2)

# --- freely jointed segments ----------------------------------------------------------------------
#: partition function of a segment over that without force
partition = sp.sinh(u) / u
#: Langevin's function, with e = exp(-2 u)
langevin = (1 + e) / (1 - e) - 1 / u


def langevin_series() -> sp.Expr:
    """Return the series of Langevin's function, sum B_2n 2^2n u^(2n-1)/(2n)! for n from 1."""
    terms = [sp.bernoulli(2 * n) * 4**n / sp.factorial(2 * n) for n in range(1, TERMS + 1)]
    return u * sp.horner(sum(each * u ** (2 * n) for n, each in enumerate(terms)), wrt=u)


def with_slope(expression: sp.Expr, variable: sp.Symbol) -> sp.Matrix:
    """Return an expression and its derivative."""
    return sp.Matrix([expression, sp.diff(expression, variable)])


def _polynomial_with_slope(expression: sp.Expr, variable: sp.Symbol) -> sp.Matrix:
    """Return a polynomial and its derivative, both by Horner's rule."""
    return with_slope(expression, variable).applyfunc(
        lambda each: sp.horner(sp.expand(each), wrt=variable)
    )


MARKO_SIGGIA = with_slope(marko_siggia, l)
BOUCHIAT = MARKO_SIGGIA + _polynomial_with_slope(_powers, l)
ODIJK = with_slope(odijk, y)
TWISTABLE = with_slope(twistable, y)
LANGEVIN = sp.Matrix([langevin, 1 / u**2 - 4 * e / (1 - e) ** 2])
LANGEVIN_SERIES = _polynomial_with_slope(langevin_series(), u)
