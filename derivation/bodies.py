"""The exact force and torque of light on a body of any shape: the sums and what they rest on.

The light about the body is a sum of vector harmonics of helicity l = +1 or -1 with amplitudes
p_nm. In the frame of the body, its matrix S gives the scattered light q = S p. With the change
t = q - p of the light and v = p + q = 2p + t,

    F = -(n_m/c) Re<t|s|v>,    M = -(1/omega) Re<t|J|v>,    absorbed power = -Re<t|v>.

The vector s is the direction of a plane wave and J the angular momentum, see `derivation.waves`.
Because t is a factor of each term, a small body loses no digit. The conventions are
exp(-i omega t) and amplitudes without the factor i^m that `derivation.waves` takes out.
"""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from . import symbols as sy
from .symbols import Quantity
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
# body's axes by i (J.d eps) p. With A and B each one of s and J, and dt = (S - 1) i B p,
#
#     d(-Re<t|A|v>) = -2 Re<dt|A q> - 2 Re<A t|i B p>,    q = p + t.

#: s_x, s_y, s_z, J_x, J_y and J_z on the amplitudes, at (n, m)
GENERATORS = (
    *lateral(_s[0], _s[1]), _s[2], *lateral(_J[0], _J[1]), _J[2],
)  # fmt: skip
GENERATORS_PARTS: Named = (*FORCE_PARTS, *TORQUE_PARTS)


def _pairs(quantities: Iterable[tuple[Quantity, Quantity]]) -> tuple[Pair, ...]:
    return tuple(pair(names) for names in quantities)


_of_p, _of_t = _pairs(sy.GENERATED_P), _pairs(sy.GENERATED_T)
_dt, _Bp = pair(sy.TWICE_CHANGE_RATE), pair(sy.TWICE_GENERATED)
DERIVATIVE_PARTS = named(
    (sy.TWICE_CHANGE_RATE, 2 * pair(sy.CHANGE_RATE)), (sy.TWICE_GENERATED, 2 * pair(sy.GENERATED))
)
#: derivatives of the six -Re<t|A|v> by the generator B
DERIVATIVE = sp.Matrix(
    [
        im_of_product(a_t, _Bp) - re_of_product(_dt, a_p + a_t)
        for a_p, a_t in zip(_of_p, _of_t, strict=True)
    ]
)
