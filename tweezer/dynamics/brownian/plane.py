"""The gap beside a wall as the radius of a motion in a plane, whose noise is the same everywhere.

With the gap g in radii a of the bead, the time in a^2/D and mu the mobility towards the wall over
that far away, the gap moves by

    dg = (a F/kT) mu dt + mu' dt + sqrt(2 mu) dB.

It is the length of W in a plane, by r = int_0^g dg/sqrt(2 mu(g)), if W moves by

    dW = {(a F/kT) sqrt(2 mu)/2 + [mu'/sqrt(2 mu) - 1/r]/2} (W/r) dt + dB,   g = g(|W|),

as Ito's formula says (`derivation.wall`). Lubrication, mu -> g, makes the last term vanish at
contact, so there the drift is as smooth as the force, and nothing is left to be done by hand: no
drift that the changing mobility brings, no reflection, no rule for a collision. The density of W is
that of Boltzmann. Far away W moves as the gap does, over sqrt(2).

Where W points does not matter to the law of its length. So a step begins at W = (r, 0), and the
state of a bead is its place alone.

Between two planes mu is that of both (`tweezer.fluid.wall`), and W is taken about the nearer one.
Past the middle the same functions hold, counted from the other.

What a step needs of g, or of r^2, is read from polynomials on intervals whose ends have few digits
in binary, so that the bits of a number say which one it is in.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import cache_functions, cached_njit, named_njit
from tweezer.compiled.lanes import (
    LANES,
    as_lanes,
    as_words,
    below,
    chosen,
    lanes,
    root,
    spread,
    store,
    transposed,
)
from tweezer.compiled.stack import on_stack
from tweezer.fluid.wall import BesideWall
from tweezer.forces.data import Data, number, packed
from tweezer.generated import wall

cache_functions(wall)

Array = NDArray[np.float64]

#: Bits of the fraction of a number that its interval is known by: 8 intervals from 2^e to 2^(e + 1)
_BITS = 3
_PARTS = 1 << _BITS
#: Powers of two at which the intervals of g begin and end, and those of r^2
_GAPS, _SQUARES = (-16, 26), (-15, 50)
#: Coefficients of a polynomial
_TERMS = 6
#: Gap from which on mu is in proportion to it, down to contact
_CONTACT = 1e-5
#: Nodes and weights of the quadrature of an interval
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
#: Places in an interval, from -1 to 1, that fix its polynomials; and what makes them of its values
_PLACES = -np.cos(np.pi * (np.arange(_TERMS) + 0.5) / _TERMS)
_FITTED = np.linalg.inv(np.vander(_PLACES, increasing=True))
#: Numbers that eight places take
_NUMBERS = LANES * LANES
#: Steps of Newton's method from the place before
_NEWTON = 5
#: Bits of a fraction that its interval leaves, and bits of the number 1
_FRACTION = np.uint64((1 << (52 - _BITS)) - 1)
_ONE = np.uint64(0x3FF0000000000000)
_SHIFT = np.uint64(52 - _BITS)
#: Number of the interval that ends at the first power of two, counted from the bits of zero
_BEFORE_GAPS = (_GAPS[0] + 1023) * _PARTS - 1
_BEFORE_SQUARES = (_SQUARES[0] + 1023) * _PARTS - 1

#: Entries of the data: position of the nearer plane, direction away from it along z, radius, gap
#: and r between two planes, D/a^2, polynomials over g and over r^2
POSITION, NORMAL, RADIUS, ROOM, LENGTH, RATE, OF_GAPS, OF_SQUARES = range(8)


# --- the functions, and their polynomials --------------------------------------------------------


@named_njit(inner=True, error_model="numpy")
def _together(one, other):  # type: ignore[no-untyped-def]
    """Resistances of two planes added up, less that far away, as mobilities."""
    return one * other / (one + other - one * other)


@named_njit(inner=True, error_model="numpy")
def _mobilities(g, room):  # type: ignore[no-untyped-def]
    """Towards the plane and its derivative, along it, turn, spin, and roll times that along it."""
    of = wall.mobilities(g)
    towards, by_gap, along, turn, spin, roll = of[0], of[5], of[1], of[3], of[2], of[4] * of[1]
    if room < np.inf:
        other = wall.mobilities(room - g)
        both = towards + other[0] - towards * other[0]
        by_gap = (other[0] / both) ** 2 * by_gap - (towards / both) ** 2 * other[5]
        towards = _together(towards, other[0])
        along, turn = _together(along, other[1]), _together(turn, other[3])
        spin, roll = _together(spin, other[2]), roll - other[4] * other[1]
    return towards, by_gap, along, turn, spin, roll


@named_njit(inner=True, error_model="numpy")
def _length(low, high, room):  # type: ignore[no-untyped-def]
    """r(high) - r(low) of two gaps of an interval."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    found = 0.0
    for i in range(_NODES.size):
        found += _WEIGHTS[i] / math.sqrt(2.0 * _mobilities(middle + half * _NODES[i], room)[0])
    return half * found


@named_njit(inner=True, error_model="numpy")
def _edge(powers, i):  # type: ignore[no-untyped-def]
    """Where interval i begins."""
    return math.ldexp(1.0 + (i % _PARTS) / _PARTS, powers[0] + i // _PARTS)


@named_njit(inner=True, error_model="numpy")
def _row(first, g, r, room, out):  # type: ignore[no-untyped-def]
    """What is read at a gap; first: r^2/g or g/r^2."""
    towards, by_gap, along, turn, spin, roll = _mobilities(g, room)
    scale = math.sqrt(2.0 * towards)
    out[0] = first
    out[1] = scale / r
    out[2] = 0.5 * (by_gap / scale - 1.0 / r) / r
    out[3], out[4], out[5], out[6], out[7] = along, turn, spin, roll, 0.0


@named_njit(inner=True, error_model="numpy")
def _fit(values, out):  # type: ignore[no-untyped-def]
    """Polynomials through values (terms, 8) at the places of an interval."""
    for i in range(_TERMS):
        for k in range(_TERMS):
            for column in range(LANES):
                out[i, column] += _FITTED[i, k] * values[k, column]


@named_njit(inner=True, error_model="numpy")
def _gap_at(r, g, begin, r_begin, room):  # type: ignore[no-untyped-def]
    """The gap at r, by Newton's method from g; r_begin: r at the gap `begin`."""
    for _ in range(_NEWTON):
        found = r_begin + _length(begin, g, room)
        g -= (found - r) * math.sqrt(2.0 * _mobilities(g, room)[0])
    return g


@cached_njit(error_model="numpy")
def _tables(room):  # type: ignore[no-untyped-def]
    """r between two planes that leave that gap, infinite for one; polynomials over g and over r^2.

    (intervals + 2, terms, 8): before the first and past the last they are constant.
    """
    gaps = (_GAPS[1] - _GAPS[0]) * _PARTS
    squares = (_SQUARES[1] - _SQUARES[0]) * _PARTS
    of_gaps = np.zeros((gaps + 2, _TERMS, LANES))
    of_squares = np.zeros((squares + 2, _TERMS, LANES))
    values = np.empty((_TERMS, LANES))

    g = _edge(_GAPS, 0)
    r = math.sqrt(2.0 * _CONTACT * _CONTACT / _mobilities(_CONTACT, room)[0])
    r += _length(_CONTACT, g, room)
    _row(r * r / g, g, r, room, of_gaps[0, 0])
    edges = np.empty(gaps + 1)
    edges[0], between, filled = r, np.inf, 0
    while filled < gaps and g <= 0.5 * room:
        high = _edge(_GAPS, filled + 1)
        if high > 0.5 * room:
            between = 2.0 * (r + _length(g, 0.5 * room, room))
        for k in range(_TERMS):
            there = g + (0.5 + 0.5 * _PLACES[k]) * (high - g)
            length = r + _length(g, there, room)
            _row(length * length / there, there, length, room, values[k])
        filled += 1
        _fit(values, of_gaps[filled])
        r += _length(g, high, room)
        g = high
        edges[filled] = r
    _row(r * r / g, g, r, room, values[0])
    of_gaps[filled + 1 :, 0] = values[0]

    edge, last, g = 0, 0, _edge(_GAPS, 0)
    for i in range(squares + 1):
        low, high = _edge(_SQUARES, i), _edge(_SQUARES, i + 1)
        if math.sqrt(low) > 0.5 * between:
            break
        last = i
        for k in range(_TERMS):
            square = low if i == squares else low + (0.5 + 0.5 * _PLACES[k]) * (high - low)
            r = math.sqrt(square)
            while edge + 1 < filled and edges[edge + 1] < r:
                edge += 1
            g = _gap_at(r, g, _edge(_GAPS, edge), edges[edge], room)
            _row(g / square, g, r, room, values[k])
        if i == 0:
            of_squares[0, 0] = values[0]
        if i < squares:
            _fit(values, of_squares[i + 1])
    of_squares[last + 2 :, 0] = values[_TERMS - 1]
    return between, of_gaps, of_squares


@functools.cache
def tables(room: float) -> tuple[float, Array, Array]:
    """See `_tables`; room: gap between two planes in radii, infinite for one plane."""
    found: tuple[float, Array, Array] = _tables(room)
    return found


def data_of(drag: BesideWall, kT: float) -> Data:
    """What a step beside a wall takes.

    kT: J.
    """
    (position, normal), *others = drag.planes
    room = math.inf
    if others:
        room = abs(others[0][0] - position) / drag.radius - 2.0
    between, of_gaps, of_squares = tables(room)
    rate = kT / drag.stokes.translation / drag.radius**2
    return packed(position, normal, drag.radius, room, between, rate, of_gaps, of_squares)


# --- what a step reads ---------------------------------------------------------------------------


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _read(numbers, begin, count, before, of, found):  # type: ignore[no-untyped-def]
    """Fill found (64,) with the eight functions at each of eight numbers."""
    rows, places = on_stack(LANES, np.int64), on_stack(LANES, np.float64)
    bits = as_words(of)
    store(rows, 0, bits >> _SHIFT)
    fraction = as_lanes((bits & _FRACTION) | _ONE)
    store(places, 0, (fraction - 1.0) * (2.0 * _PARTS) - 1.0)
    for j in range(LANES):
        row = min(max(rows[j] - before, 0), count - 1)
        first = begin + row * (_TERMS * LANES)
        value = lanes(numbers, first + (_TERMS - 1) * LANES)
        for k in range(_TERMS - 2, -1, -1):
            value = places[j] * value + lanes(numbers, first + k * LANES)
        store(found, LANES * j, value)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def nearest(data, z):  # type: ignore[no-untyped-def]
    """Of eight beads: gap to the nearer plane in radii, direction away from it, its position."""
    radius, normal = number(data, RADIUS), number(data, NORMAL)
    position, room = number(data, POSITION), number(data, ROOM)
    away, plane = spread(normal), spread(position)
    g = (normal * (z - position)) / radius - 1.0
    if room < np.inf:
        other = below(spread(0.5 * room), g)
        g = chosen(other, room - g, g)
        away = chosen(other, -away, away)
        plane = chosen(other, spread(position + normal * (room + 2.0) * radius), plane)
    return chosen(below(g, spread(0.0)), spread(0.0), g), away, plane


@named_njit(inner=True, error_model="numpy", forceinline=True)
def by_gap(data, g, away):  # type: ignore[no-untyped-def]
    """At eight gaps: r; S, T of the drift (S F/2 + T) W; mobilities along the plane and of turning,
    spinning and rolling, over those far away. That of rolling is w/F over b/a, signed as in z.
    """
    found = on_stack(_NUMBERS, np.float64)
    _read(data.numbers, data.shapes[OF_GAPS, 0], data.shapes[OF_GAPS, 1], _BEFORE_GAPS, g, found)
    square, S, T, along, turn, spin, roll, _ = transposed(found, 0)
    return root(square * g), S, T, (along, turn, spin, away * roll)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def by_square(data, square, away):  # type: ignore[no-untyped-def]
    """At eight r^2: the gap, and what `by_gap` gives beside r."""
    found = on_stack(_NUMBERS, np.float64)
    folded, between = square, number(data, LENGTH)
    if between < np.inf:
        folded = _folded(square, between)
    _read(
        data.numbers, data.shapes[OF_SQUARES, 0], data.shapes[OF_SQUARES, 1], _BEFORE_SQUARES,
        folded, found,
    )  # fmt: skip
    if between < np.inf:
        _from_the_other(data, square, folded, found)
    gap, S, T, along, turn, spin, roll, _ = transposed(found, 0)
    return gap * square, S, T, (along, turn, spin, away * roll)


@named_njit(inner=True, error_model="numpy")
def _folded(square, between):  # type: ignore[no-untyped-def]
    """r^2 counted from the nearer of two planes."""
    out = on_stack(LANES, np.float64)
    store(out, 0, square)
    for j in range(LANES):
        if out[j] > 0.25 * between * between:
            r = math.sqrt(out[j]) % (2.0 * between)
            r = min(r, 2.0 * between - r)
            r = min(r, between - r)
            out[j] = r * r
    return lanes(out, 0)


@named_njit(inner=True, error_model="numpy")
def _from_the_other(data, square, folded, found):  # type: ignore[no-untyped-def]
    """What was read at r counted from the nearer plane, as of r counted from the first one."""
    room, between = number(data, ROOM), number(data, LENGTH)
    squares, nearer = on_stack(LANES, np.float64), on_stack(LANES, np.float64)
    store(squares, 0, square)
    store(nearer, 0, folded)
    for j in range(LANES):
        if squares[j] > 0.25 * between * between:
            row = LANES * j
            r, s = math.sqrt(squares[j]), math.sqrt(nearer[j])
            m = r % (2.0 * between)
            back = -1.0 if m > between else 1.0
            other = min(m, 2.0 * between - m) > 0.5 * between
            gap, scale = found[row] * nearer[j], found[row + 1] * s
            # half of mu'/sqrt(2 mu), along r
            change = found[row + 2] * s + 0.5 / max(s, 1e-3)
            if other:
                gap, change = room - gap, -change
                found[row + 6] = -found[row + 6]
            found[row] = gap / squares[j]
            found[row + 1] = back * scale / r
            found[row + 2] = (back * change - 0.5 / r) / r
