"""The gap beside a wall as the radius of a motion in a plane, whose noise is the same everywhere.

Let g be the gap in radii a of the bead, and measure time in a^2/D. With mu, the mobility towards
the wall over its value far away, the gap moves by

    dg = (a F/kT) mu dt + mu' dt + sqrt(2 mu) dB.

It is the length of a vector W in a plane, by r = int_0^g dg/sqrt(2 mu(g)), if W moves by

    dW = {(a F/kT) sqrt(2 mu)/2 + [mu'/sqrt(2 mu) - 1/r]/2} (W/r) dt + dB,   g = g(|W|),

as Ito's formula shows (`derivation.wall`). Lubrication, mu -> g, makes the last term vanish at
contact, so there the drift is as smooth as the force. A step therefore requires no separate drift
for the changing mobility, no reflection and no rule for a collision. The density of W is
Boltzmann's. Far away W moves as the gap does, over sqrt(2).

The direction of W does not affect the law of its length. So a step begins at W = (r, 0), and the
state of a bead is its position alone.

Between two planes mu includes both (`tweezer.fluid.wall`), and W is taken about the nearer one.
Beyond the middle the same functions apply, counted from the other plane.

A step evaluates its functions of g, or of r^2, by polynomials on intervals. The ends of the
intervals have few binary digits, so the bits of a number give the interval that contains it.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np

from tweezer.compiled import cached_njit, named_njit
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
from tweezer.fluid.drag import Walls
from tweezer.fluid.wall import between_walls
from tweezer.forces.data import Data, number, packed
from tweezer.generated import wall
from tweezer.values.arrays import Array

#: Bits of the fraction of a number that its interval is known by: 8 intervals from 2^e to 2^(e + 1)
_BITS = 3
_PARTS = 1 << _BITS
#: Powers of two at which the intervals of g begin and end, and those of r^2
_GAPS, _SQUARES = (-16, 26), (-15, 50)
#: Coefficients of a polynomial
_TERMS = 6
#: Nodes and weights of the quadrature of an interval
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
#: Points of an interval, from -1 to 1, that fix its polynomials; matrix from values to coefficients
_PLACES = -np.cos(np.pi * (np.arange(_TERMS) + 0.5) / _TERMS)
_FITTED = np.linalg.inv(np.vander(_PLACES, increasing=True))
#: Number of values that are read for eight positions
_NUMBERS = LANES * LANES
#: Steps of Newton's method from a gap that is right to a hundredth
_NEWTON = 4
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


class Mobilities(NamedTuple):
    """Mobilities of a bead beside a plane over those far away, one value for each gap."""

    towards: Array
    """mu, of translation perpendicular to the plane"""
    slope: Array
    """derivative of `towards` by the gap in radii"""
    along: Array
    """of translation parallel to the plane"""
    turn: Array
    """of rotation about an axis parallel to the plane"""
    spin: Array
    """of rotation about the normal of the plane"""
    roll: Array
    """angular velocity by a force along the plane, over the velocity that the force gives far away
    divided by the radius
    """


@cached_njit(error_model="numpy")
def _fill(gaps, room, out):  # type: ignore[no-untyped-def]
    """Fill out (6, n) with the fields of `Mobilities` in their order, at gaps (n,) in radii.

    room: gap to the other plane plus that to this one, in radii; infinite for one plane.
    """
    for i in range(gaps.size):
        found = between_walls(gaps[i], room)
        out[0, i], out[1, i], out[2, i] = found[0], found[5], found[1]
        out[3, i], out[4, i], out[5, i] = found[3], found[2], found[4]


def _mobilities(gaps: Array, room: float) -> Mobilities:
    """Return the mobilities at gaps of any shape, in radii, beside one plane or between two.

    room: sum of the gaps to both planes, in radii; infinite for one plane.
    """
    found = np.empty((6, gaps.size))
    _fill(gaps.ravel(), room, found)
    return Mobilities(*found.reshape(6, *gaps.shape))


def _length(low: Array, high: Array, room: float) -> Array:
    """Return r(high) - r(low), the integral of dg/sqrt(2 mu(g)), by Gauss quadrature.

    `low` and `high` are gaps in radii, each pair within one interval of the tables. `room` is the
    sum of the gaps to both planes, in radii, or infinite for one plane.
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    found = np.zeros_like(middle)
    for node, weight in zip(_NODES.tolist(), _WEIGHTS.tolist(), strict=True):
        found += weight / np.sqrt(2.0 * _mobilities(middle + half * node, room).towards)
    return half * found


def _edges(powers: tuple[int, int]) -> Array:
    """Return the ends of all intervals between two powers of 2, eight to each doubling, ascending.

    powers: exponents of the first end and the last one.
    """
    at = np.arange((powers[1] - powers[0]) * _PARTS + 1)
    found: Array = np.ldexp(1.0 + at % _PARTS / _PARTS, powers[0] + at // _PARTS)
    return found


def _within(edges: Array) -> Array:
    """Return the points of each interval at which polynomials are fitted, (intervals, terms).

    edges: (intervals + 1,) ends of the intervals.
    """
    return edges[:-1, None] + (0.5 + 0.5 * _PLACES) * np.diff(edges)[:, None]


def _functions(first: Array, gaps: Array, r: Array, room: float) -> Array:
    """Return the eight functions that a step reads, (..., 8), at gaps of any shape (...).

    The first is `first`: r^2/g in the table over g, g/r^2 in the table over r^2. Then come
    S = sqrt(2 mu)/r and T, where (S F/2 + T) W is the drift of W under the force F. Units are
    kT/radius for F and radius^2/D for time. The others are the mobilities along the plane, of
    turning, spinning and rolling, and a zero. `gaps` are g and `r` the lengths r, in radii. `room`
    is the sum of the gaps to both planes, in radii, or infinite for one plane.
    """
    of = _mobilities(gaps, room)
    scale = np.sqrt(2.0 * of.towards)
    drift = 0.5 * (of.slope / scale - 1.0 / r) / r
    columns = first, scale / r, drift, of.along, of.turn, of.spin, of.roll, np.zeros_like(r)
    return np.stack(columns, axis=-1)


def _polynomials(values: Array, first: Array, last: Array) -> Array:
    """Return coefficients (intervals + 2, terms, 8) of polynomials fitted to the functions.

    values: (intervals, terms, 8) at the points of each interval. first, last: (8,) constants that
    hold below the first interval and above the last one.
    """
    found = np.zeros((len(values) + 2, _TERMS, LANES))
    found[0, 0], found[-1, 0] = first, last
    for k in range(_TERMS):
        found[1:-1] += _FITTED[:, k, None] * values[:, None, k]
    return found


@functools.cache
def tables(room: float) -> tuple[float, Array, Array]:
    """Return r between two planes and the tables of the eight functions over g and over r^2.

    `room` is the sum of the gaps to both planes, in radii. For one plane it and the first result
    are infinite. The tables are polynomial coefficients (intervals + 2, terms, 8); outside the
    intervals the functions are constant.
    """
    edges = _edges(_GAPS)
    edges = edges[: np.searchsorted(edges, 0.5 * room) + 1]
    near = np.array([wall.CONTACT])
    r_near = np.sqrt(2.0 * near * near / _mobilities(near, room).towards)
    lengths = _length(np.append(near, edges[:-1]), edges, room)
    r = r_near + np.cumsum(lengths)
    between = math.inf
    if room < math.inf:
        between = 2 * float(r[-2] + _length(edges[-2:-1], np.array([0.5 * room]), room)[0])
    gaps = _within(edges)
    there = r[:-1, None] + _length(np.repeat(edges[:-1, None], _TERMS, axis=1), gaps, room)
    ends = _functions(r * r / edges, edges, r, room)
    of_gaps = _polynomials(_functions(there * there / gaps, gaps, there, room), ends[0], ends[-1])

    squares = _edges(_SQUARES)
    squares = squares[: np.searchsorted(squares, 0.25 * between**2) + 1]
    within = np.vstack([_within(squares), np.repeat(squares[[0, -1], None], _TERMS, axis=1)])
    lengths = np.sqrt(within)
    begin = np.clip(np.searchsorted(r, lengths) - 1, 0, len(edges) - 2)
    gaps = np.exp(np.interp(np.log(lengths), np.log(r), np.log(edges)))
    for _ in range(_NEWTON):
        off = r[begin] + _length(edges[begin], gaps, room) - lengths
        gaps -= off * np.sqrt(2.0 * _mobilities(gaps, room).towards)
    values = _functions(gaps / within, gaps, lengths, room)
    return between, of_gaps, _polynomials(values[:-2], values[-2, 0], values[-1, 0])


def data_of(walls: Walls, kT: float) -> Data:
    """Return the data that a step beside walls reads: geometry, diffusion rate and tables.

    kT: thermal energy, J.
    """
    (position, normal), *others = walls.planes
    room = math.inf
    if others:
        room = abs(others[0][0] - position) / walls.radius - 2.0
    between, of_gaps, of_squares = tables(room)
    rate = kT / walls.stokes.translation / walls.radius**2
    return packed(position, normal, walls.radius, room, between, rate, of_gaps, of_squares)


# --- what a step reads ---------------------------------------------------------------------------


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _read(numbers, begin, count, before, of, found):  # type: ignore[no-untyped-def]
    """Fill found (64,) with the eight functions at each of eight arguments, g or r^2.

    The table has `count` rows and begins at the index `begin` of the flat data `numbers`. The
    leading bits of an argument in `of` select its row, and its other bits are its position within
    the interval. `before` is the number that the leading bits give for the first row.
    """
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
    """Return for eight beads the gap to the nearer plane, the direction from it, and its position.

    `data` comes from `data_of`, and `z` are positions (m). The gap is in radii and at least 0. The
    direction is 1 or -1 along z, and the position of the plane is in m.
    """
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
    """Return r, S, T and the mobilities of eight beads, from their gaps.

    g: gaps in radii. away: directions 1 or -1 away from the plane, along z. The drift of W in the
    plane of the gap is (S F/2 + T) W, for the force F in kT/radius and the time in radius^2/D. The
    mobilities, over those far away, are a tuple of translation along the plane, turning, spinning
    and rolling; rolling is angular velocity times radius over the velocity far away, with the sign
    of `away`.
    """
    found = on_stack(_NUMBERS, np.float64)
    _read(data.numbers, data.shapes[OF_GAPS, 0], data.shapes[OF_GAPS, 1], _BEFORE_GAPS, g, found)
    square, S, T, along, turn, spin, roll, _ = transposed(found, 0)
    return root(square * g), S, T, (along, turn, spin, away * roll)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def by_square(data, square, away):  # type: ignore[no-untyped-def]
    """Return the gap, S, T and the mobilities of eight beads, from the squared length r^2 of W.

    `away` is the direction 1 or -1 from the plane from which r is counted. The gap is in radii. The
    drift of W is (S F/2 + T) W for the force F in kT/radius and time in radius^2/D. The mobilities,
    over those far away, are along the plane, of turning, spinning and rolling. Between two planes,
    r beyond the middle is counted from the other one.
    """
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
    """Return r^2 counted from the nearer of two planes, for eight values.

    `square` is counted from the first plane; W may have passed the second plane, where it is
    reflected. `between` is r from one plane to the other.
    """
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
    """Convert functions read at r from the nearer plane to r from the first plane, in place.

    `square` and `folded` are eight values of r^2, counted from the first plane and from the nearer
    one. `found` (64,), filled by `_read` at `folded`, changes for the beads beyond the middle.
    """
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
