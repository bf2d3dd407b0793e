"""The exact force of focused light on a sphere: harmonics, Mie coefficients, bilinear sums.

The light about the bead is a sum of vector harmonics of helicity l = +1 or -1 with amplitudes
p_nm; the scattered light has the amplitudes q = S p. A plane wave along s carries momentum along
s, so that the force is

    F = -(n_m/c) (<q|s|q> - <p|s|p>),    M = -(1/omega) (<q|J|q> - <p|J|p>).

The sphere's matrix S is diagonal in the electric and the magnetic part of each (n, m), with the
elements 1 - 2 a_n and 1 - 2 b_n. See Bohren and Huffman, Absorption and Scattering of Light by
Small Particles, chapter 4, and for layers Yang, Appl. Opt. 42, 1710 (2003). The direction s is a
vector operator, so it couples n to n-1, n and n+1 alone. Five elements follow from its algebra with
J. Within n it changes its sign with the helicity, and exchanges electric and magnetic parts.
Between n and n+1 it does not depend on the helicity, and keeps the parts.

The conventions are exp(-i omega t) and amplitudes p_nm = 2 pi i^m P_nm. The factor exp(i k s.r)
moves the bead by r.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain

import sympy as sp

from . import symbols as sy
from .equations import Equation
from .symbols import Quantity

n, m = sy.DEGREE.symbol, sy.ORDER.symbol
#: helicity
l = sp.Symbol("l", real=True)

# --- the direction between harmonics -----------------------------------------------------------
Element = dict[tuple[str, int], sp.Expr]


def direction(n: sp.Expr, m: sp.Expr, c: Callable[[sp.Expr], sp.Expr], d: sp.Expr) -> Element:
    """Return the elements of s_z, s_+ and s_- from (n, m) to n - 1, n and n + 1.

    The commutators [J_i, s_j] = i eps_ijk s_k fix these forms except for c(n) and d.
    """
    j, k = n - m, n + m
    return {
        ("z", -1): c(n) * sp.sqrt(j * k),
        ("z", 0): d * m,
        ("z", 1): c(n + 1) * sp.sqrt((j + 1) * (k + 1)),
        ("+", -1): c(n) * sp.sqrt(j * (j - 1)),
        ("+", 0): d * sp.sqrt(j * (k + 1)),
        ("+", 1): -c(n + 1) * sp.sqrt((k + 1) * (k + 2)),
        ("-", -1): -c(n) * sp.sqrt(k * (k - 1)),
        ("-", 0): d * sp.sqrt(k * (j + 1)),
        ("-", 1): c(n + 1) * sp.sqrt((j + 1) * (j + 2)),
    }


c_of, d_n, _v = sp.Function("c"), sp.Symbol("d"), sp.Function("v")
_to_neighbours = direction(n, m, c_of, d_n)


def _mean(by_direction: dict[str, sp.Expr]) -> sp.Expr:
    """Return x x + y y + z z from z z, + - and - +."""
    return sp.expand(by_direction["z"] + (by_direction["+"] + by_direction["-"]) / 2)


#: <n m|s.J|n m>, and <n m|s.s|n m>: the squares of s_i |n m>
HELICITY = _mean(
    {"z": d_n * m**2, "+": d_n * (n + m) * (n - m + 1), "-": d_n * (n - m) * (n + m + 1)}
)
LENGTH = _mean(
    {
        component: sum(_to_neighbours[component, by_n] ** 2 for by_n in (-1, 0, 1))
        for component in "z+-"
    }
)
#: s.J = l
within_scale = sp.factor(sp.solve(HELICITY - l, d_n)[0])
#: s.s = 1 is v(n) + v(n+1) = 2 n + 1 with n v(n) = l^2 + c(n)^2 n^2 (4 n^2 - 1). At the lowest
#: degree n = l, c vanishes and v(l) = l, so the solution that alternates in sign is absent
_alternating = sp.Symbol("C0")
_v_of_n = sp.rsolve(_v(n) + _v(n + 1) - (2 * n + 1), _v(n)).subs(_alternating, 0)


def between_scale_squared(degree: sp.Expr) -> sp.Expr:
    """Return c(n)^2 at `degree`."""
    value = (n * _v_of_n - l**2) / (n**2 * (2 * n - 1) * (2 * n + 1))
    return sp.factor(value.subs(n, degree))


#: squares of <n m|s_z|n-1 m>, <n+1 m+1|s_+|n m> (itself negative), <n m+1|s_+|n m> and
#: <n-1 m+1|s_+|n m>, and <n m|s_z|n m> itself, of harmonics of helicity l
along_squared = between_scale_squared(n) * (n - m) * (n + m)
within = within_scale * m
raised_squared = between_scale_squared(n + 1) * (n + m + 1) * (n + m + 2)
turned_squared = within_scale**2 * (n - m) * (n + m + 1)
lowered_squared = between_scale_squared(n) * (n - m) * (n - m - 1)

#: for light of helicity +1
SQUARED_ELEMENTS = (
    sp.Matrix([along_squared, within, raised_squared, turned_squared, lowered_squared])
    .subs(l, 1)
    .applyfunc(sp.factor)
)

# --- the sphere --------------------------------------------------------------------------------
index, inner_index = sy.RELATIVE_INDEX.symbol, sy.INNER_INDEX.symbol
g = sy.FIELD_DERIVATIVE.symbol
g_psi, g_chi = (quantity.symbol for quantity in sy.OUTER_DERIVATIVES)
ratio = sy.OUTER_RATIO.symbol
g_psi_in, g_chi_in, g_psi_out, g_chi_out = (quantity.symbol for quantity in sy.LAYER_DERIVATIVES)

# A wave of degree n is f(z), z = m k r, with f a sum of two Riccati-Bessel functions. Electric
# waves have continuous m f and f', and magnetic waves continuous f and m f'.

#: psi_n, psi_n', chi_n and chi_n' at x, and psi_n and psi_n' at m x
psi, dpsi, chi, dchi = sp.symbols(r"{\psi_n} {\psi_n'} {\chi_n} {\chi_n'}", real=True)
psi_inside, dpsi_inside = sp.symbols(r"{\psi_n(mx)} {\psi_n'(mx)}", complex=True)


def mie_coefficient(*, electric: bool) -> sp.Expr:
    """Return a_n or b_n, for psi_n - a_n xi_n outside and a multiple of psi_n inside."""
    coefficient, inside = sp.symbols("a d")
    f = psi - coefficient * (psi - sp.I * chi)
    df = dpsi - coefficient * (dpsi - sp.I * dchi)
    scale, scale_of_slope = (index, 1) if electric else (1, index)
    continuity = (
        f - scale * inside * psi_inside,
        df - scale_of_slope * inside * dpsi_inside,
    )
    return sp.factor(sp.solve(continuity, (coefficient, inside))[coefficient])


# The reduced logarithmic derivative g = z f'/f - (n+1) is carried from the core outwards. For psi_n
# at a small z it is -z^2/(2n+3), which keeps its digits in a difference.

#: g of electric waves outside a surface, from g inside; g of magnetic waves is continuous
electric_across = (
    (index - inner_index) * (index + inner_index) * (n + 1) + index**2 * g
) / inner_index**2


#: Yang's step through a layer in terms of g; the second solution may be chi_n or xi_n
layer = ((g - g_chi_in) * g_psi_out - ratio * (g - g_psi_in) * g_chi_out) / (
    (g - g_chi_in) - ratio * (g - g_psi_in)
)
#: P and Q, up to one factor, of the Mie coefficient P/(P - iQ): real where the index is
reflected = sp.Matrix([ratio * (g - g_psi), g - g_chi])


# --- complex numbers by their parts --------------------------------------------------------------
@dataclass(frozen=True)
class Pair:
    """A complex number as its real and imaginary part."""

    re: sp.Expr
    im: sp.Expr

    def __add__(self, other: Pair) -> Pair:
        return Pair(self.re + other.re, self.im + other.im)

    def __sub__(self, other: Pair) -> Pair:
        return Pair(self.re - other.re, self.im - other.im)

    def __mul__(self, other: Pair) -> Pair:
        return Pair(
            self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re
        )

    def __rmul__(self, factor: sp.Expr) -> Pair:
        return Pair(factor * self.re, factor * self.im)

    @property
    def conjugate(self) -> Pair:
        """Complex conjugate."""
        return Pair(self.re, -self.im)

    @property
    def value(self) -> sp.Expr:
        """Complex number as one expression."""
        return self.re + sp.I * self.im


def pair(quantities: tuple[Quantity, Quantity]) -> Pair:
    """Return the complex number of two symbols, its real and imaginary part."""
    real, imaginary = quantities
    return Pair(real.symbol, imaginary.symbol)


Named = tuple[tuple[Quantity, sp.Expr], ...]


def named(*values: tuple[tuple[Quantity, Quantity], Pair]) -> Named:
    """Return names and expressions for the parts of complex numbers."""
    return tuple(
        chain.from_iterable(((names[0], value.re), (names[1], value.im)) for names, value in values)
    )


def re_of_product(a: Pair, b: Pair) -> sp.Expr:
    """Re(a* b)."""
    return a.re * b.re + a.im * b.im


def im_of_product(a: Pair, b: Pair) -> sp.Expr:
    """Im(a* b)."""
    return a.re * b.im - a.im * b.re


# --- the summands ------------------------------------------------------------------------------
P, above, before = pair(sy.AMPLITUDE), pair(sy.ABOVE), pair(sy.BEFORE)
up, up_above, up_before = pair(sy.UP), pair(sy.UP_ABOVE), pair(sy.UP_BEFORE)
down, down_above, down_before = pair(sy.DOWN), pair(sy.DOWN_ABOVE), pair(sy.DOWN_BEFORE)
partner, partner_up, partner_down = (
    pair(sy.PARTNER), pair(sy.PARTNER_UP), pair(sy.PARTNER_DOWN)
)  # fmt: skip
U, U_before, V = pair(sy.WEIGHT_ABOVE), pair(sy.WEIGHT_BEFORE), pair(sy.WEIGHT_WITHIN)
K = sy.WEIGHT_OF_TURN.symbol
al, al_above, be = sy.ALONG.symbol, sy.ALONG_ABOVE.symbol, sy.WITHIN.symbol
e1, e0, em = sy.RAISED.symbol, sy.TURNED.symbol, sy.LOWERED.symbol
e1_down, e0_down, em_down = (
    sy.RAISED_DOWN.symbol, sy.TURNED_DOWN.symbol, sy.LOWERED_DOWN.symbol
)  # fmt: skip
lift, lift_down = sy.LIFT.symbol, sy.LIFT_DOWN.symbol
#: a float, as the printer writes a fraction with a division
_HALF = sp.Float(0.5)

# Each pair of neighbours is counted once. The element of s_- from m+1 equals the one of s_+ to m+1.
# The factor i^m of the amplitudes leaves i: F_x + i F_y = -(sum P* h_-)*, where
# h_- = i (e1 U* up_above + ...).
_G, _G_before, _H = pair(sy.SENT_ON), pair(sy.SENT_BACK), pair(sy.TURNED_OVER)
FORCE_PARTS = named(
    (sy.SENT_ON, U * P),
    (sy.SENT_BACK, U_before.conjugate * P),
    (sy.TURNED_OVER, V * partner),
)


def _across(part_of_product: Callable[[Pair, Pair], sp.Expr]) -> sp.Expr:
    """Return a part of sum e (weighted amplitude)* (amplitude at m+1)."""
    return (
        e1 * part_of_product(_G, up_above)
        + em * part_of_product(_G_before, up_before)
        + e0 * part_of_product(_H, up)
    )


FORCE = sp.Matrix(
    [
        _across(im_of_product),
        _across(re_of_product),
        -2 * al_above * re_of_product(_G, above) - be * re_of_product(P, _H),
    ]
)

# The direction at (n, m): contributions of the neighbours, and the same with weights.
_ADDED = {
    ("plus", "before"): e1_down * down_before,
    ("plus", "within"): e0_down * partner_down,
    ("plus", "above"): em_down * down_above,
    ("minus", "before"): em * up_before,
    ("minus", "within"): e0 * partner_up,
    ("minus", "above"): e1 * up_above,
    ("z", "before"): al * before,
    ("z", "within"): be * partner,
    ("z", "above"): al_above * above,
}
_s = {component: pair(names) for component, names in sy.DIRECTED.items()}
_h = {component: pair(names) for component, names in sy.WEIGHTED.items()}


def _from_neighbours(component: str) -> Iterator[Pair]:
    return (pair(sy.NEIGHBOURS[component, place]) for place in ("before", "within", "above"))


def _directed(component: str) -> Pair:
    """Return s_+ P over -i, s_- P over i, or s_z P, at (n, m)."""
    from_before, from_within, from_above = _from_neighbours(component)
    return from_before + from_within + from_above


def _weighted(component: str) -> Pair:
    """Return `_directed` with the weights of the change of momentum."""
    from_before, from_within, from_above = _from_neighbours(component)
    return U_before * from_before + V * from_within + U.conjugate * from_above


#: s_x P over i/2, s_y P over -1/2, and s_z P twice
_DIRECTION_PARTS = named(
    *((sy.NEIGHBOURS[key], value) for key, value in _ADDED.items()),
    *((sy.DIRECTED[component], _directed(component)) for component in ("plus", "minus", "z")),
    (sy.DIRECTED["x"], _s["minus"] - _s["plus"]),
    (sy.DIRECTED["y"], _s["plus"] + _s["minus"]),
    (sy.DIRECTED["twice_z"], 2 * _s["z"]),
)
#: h_x over i and h_y over -1
_LATERAL = named(
    (sy.WEIGHTED["x"], _HALF * _h["minus"] - _HALF * _h["plus"]),
    (sy.WEIGHTED["y"], _HALF * _h["plus"] + _HALF * _h["minus"]),
)
GRADIENT_PARTS = (
    *_DIRECTION_PARTS,
    *named(
        *((sy.WEIGHTED[component], _weighted(component)) for component in ("plus", "minus", "z"))
    ),
    *_LATERAL,
)
#: -Re(P* h_i)
FORCE_AT = sp.Matrix(
    [im_of_product(P, _h["x"]), re_of_product(P, _h["y"]), -re_of_product(P, _h["z"])]
)
#: -2 Re(h_i* i s_j P) = 2 Im(h_i* s_j P)
_GRADIENT = (
    im_of_product(_h["x"], _s["x"]),
    re_of_product(_h["x"], _s["y"]),
    -re_of_product(_h["x"], _s["twice_z"]),
    -re_of_product(_h["y"], _s["x"]),
    im_of_product(_h["y"], _s["y"]),
    -im_of_product(_h["y"], _s["twice_z"]),
    re_of_product(_h["z"], _s["x"]),
    -im_of_product(_h["z"], _s["y"]),
    im_of_product(_h["z"], _s["twice_z"]),
)
FORCE_AND_GRADIENT = sp.Matrix([*FORCE_AT, *_GRADIENT])

#: M and the absorbed power; the angular momentum keeps n and the helicity
MOMENT = sp.Matrix(
    [
        -K * lift * im_of_product(up, P),
        K * lift * re_of_product(up, P),
        -K * m * re_of_product(P, P),
        -K * re_of_product(P, P),
    ]
)
MOMENT_GRADIENT_PARTS = (
    *_DIRECTION_PARTS,
    *named(
        (sy.WEIGHTED["plus"], (K * lift_down) * down),
        (sy.WEIGHTED["minus"], (K * lift) * up),
        (sy.WEIGHTED["z"], (K * m) * P),
    ),
    *_LATERAL,
)
MOMENT_GRADIENT = sp.Matrix(_GRADIENT)

# --- a plane face before the focus ---------------------------------------------------------------
n1, n2 = sy.INDEX_BEFORE_FACE.symbol, sy.INDEX_BEHIND_FACE.symbol
cos1, cos2 = sy.COSINE_BEFORE_FACE.symbol, sy.COSINE_BEHIND_FACE.symbol
#: Fresnel's transmitted amplitudes
t_p = 2 * n1 * cos1 / (n2 * cos1 + n1 * cos2)
t_s = 2 * n1 * cos1 / (n1 * cos1 + n2 * cos2)
#: sqrt of (power per solid angle behind the face, over that before it)
COVER_AMPLITUDES = sp.Matrix([t_p, t_s]) * (n2 / n1) ** sp.Rational(3, 2) * cos2 / cos1


def _reflected_at_a_face() -> sp.Matrix:
    """Return Fresnel's reflected amplitudes r_p and r_s, from the continuity of E and H.

    Along e_theta, E cos(theta) and n E are continuous, and along e_phi, E and n E cos(theta). The
    field of the reflected wave along e_theta has the tangential part of the opposite sign.
    """
    r, t = sp.symbols("r t")
    p = sp.solve([cos1 * (1 - r) - cos2 * t, n1 * (1 + r) - n2 * t], [r, t])[r]
    s = sp.solve([1 + r - t, n1 * cos1 * (1 - r) - n2 * cos2 * t], [r, t])[r]
    return sp.Matrix([p, s])


REFLECTED_AMPLITUDES = _reflected_at_a_face()


def _by_snell() -> sp.Matrix:
    """Return the reflected amplitudes with the factor n1^2 - n2^2, which nothing else cancels.

    Snell's law n1^2 (1 - cos1^2) = n2^2 (1 - cos2^2) makes the numerator times the denominator a
    multiple of this factor. Differences of terms with nearly equal indices would lose their digits.
    """
    found = []
    for r in REFLECTED_AMPLITUDES:
        above, below = sp.fraction(sp.together(r))
        squared = sp.expand(above * below).subs(cos2**2, 1 - (n1 / n2) ** 2 * (1 - cos1**2))
        found.append(sp.factor(squared) / below**2)
    return sp.Matrix(found)


#: The same for indices that may be nearly equal
REFLECTED_BY_SNELL = _by_snell()

HELICITY_OF_HARMONICS = Equation(
    "-", "s.J = l", r"\langle nm|s\cdot J|nm\rangle", sp.factor(HELICITY)
)
LENGTH_OF_DIRECTION = Equation(
    "-",
    "s.s = 1",
    r"\langle nm|s\cdot s|nm\rangle",
    sp.collect(LENGTH, (c_of(n), c_of(n + 1), d_n), sp.factor),
)
MIE_ELECTRIC = Equation("-", "scattered electric wave", "a_n", mie_coefficient(electric=True))
MIE_MAGNETIC = Equation("-", "scattered magnetic wave", "b_n", mie_coefficient(electric=False))
ACROSS_A_SURFACE = Equation("-", "electric wave across a surface", r"g_{out}", electric_across)
THROUGH_A_LAYER = Equation("-", "through a layer", r"g_{out}", layer)
