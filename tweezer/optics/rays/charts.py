"""Coordinates of a force table, in which the force is smooth up to the edges; and its reader.

Lengths are in radii of the bead, forces in n_m P/c (refractive index of the medium, power, speed of
light). The force F of axisymmetric light depends only on polar coordinates (d, gamma) of the bead
in the meridional plane: its distance from the focus and its angle to the axis. Let theta_m be the
half angle of the cone of light. F is analytic except in two places:

* The circle d = 1 between gamma = a and b, pi/2 -+ theta_m. There the plane through the focus
  across the line to the bead contains rays of the cone, and F varies as w^2 log(w) with
  w^2 = |1 - d^2|.
* The lines are where the bead touches a ray of the rim. Seen from the focus, a bead outside it
covers a
  cone. The rays in the band between p + pi/2 and q + pi/2 miss it, p, q = gamma -+ arccos(1/d). It
  touches the rim where p or q is one of a, b or their mirror images -a and pi + a. There F is
  singular as a power 5/2.

So there are four charts (x, y), cut along these lines into rectangular blocks:

    core      d < CORE                 x = rho^2, y = z
    ring      CORE < d < 1             x = w, y = cos(gamma)
    outer     d > 1                    x = P, y = Q
    triangle  d > 1, |P|, |Q| < tau    x = (Q - P)/(2 tau - |y|), y = P + Q

P = tan((p - pi/2)/2) and Q = tan((q - pi/2)/2) need no trigonometry; tau = tan(theta_m/2). With
rho and z, and w = tan(arccos(1/d)),

    P = -(z + rho w)/(d^2 + rho - z w),    Q = -(z - rho w)/(d^2 + rho + z w).

The triangle lies between the circle (x = 0) and the lines p = a and q = b (x = 1). Its width
vanishes in y towards the end points of the arc, where the lines touch the circle. On the ring and
the triangle F is even in x; on the outer chart it is symmetric in P and Q. Functions of rho^2
continue across the axis, (P, Q) -> (1/Q, 1/P).

A block is bisected into pieces along x or y until the tolerance is met. On each piece F_rho/rho,
F_z (and the torque M_phi/rho) are polynomials of degree 7 in x and in y.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np
from numba import int64, uint64
from numpy.typing import NDArray

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import (
    LANES,
    anywhere,
    as_lanes,
    as_words,
    below,
    chosen,
    lanes,
    root,
    spread,
    store,
    words,
)
from tweezer.compiled.stack import borrowed, on_stack
from tweezer.forces.data import begin_of, part
from tweezer.forces.force import KERNEL, Kernel
from tweezer.optics.beyond import add_one
from tweezer.optics.polynomials import (
    COEFFICIENTS,
    INNER,
    PARTS,
    ROWS,
    add_up,
    coordinates,
    put,
    read,
)
from tweezer.values.arrays import Array

Integers = NDArray[np.int64]

#: Radius of the core, in bead radii
CORE = 0.6
#: Numbers of the head of a piece: centre and 1/half-width along x, then along y
HEAD = 4

(CORE_CHART, RING, OUTER, TRIANGLE) = range(4)

#: Blocks of the triangle, y < 0 and y > 0
_TRIANGLES = (4, 17)
_LOWER, _UPPER = map(float, _TRIANGLES)
#: First block of the outer chart
_OUTER = 5
#: Numbers of a block's frame
_FRAME = 4

#: Lower bound on w. Keeps dw/dd finite at d = 1; changes the force by less than 1e-14
_LEAST_W = 1e-8
#: Lower bound on 1/d at nodes outside the table's range
_LEAST_COSINE = 1e-3
#: Index entry without a piece
NO_PIECE = -1
#: Binary digits of a part of a block's width, and the largest number below 1 of so many
_DIGITS, _BELOW_1 = 52, 1.0 - 2.0**-52
#: Bits of a number from 1 to 2 that hold these digits
_FRACTION = np.uint64(2**52 - 1)

#: Entries of what the kernel finds of eight beads, and their number: position x1, x2 across the
#: light, rho, block, coordinates u, v on the piece, from -1 to 1, and their derivatives over rho, z
(_X1, _X2, _RHO, _BLOCK, _U, _V, _U_RHO, _U_Z, _V_RHO, _V_Z, _FOUND) = (
    LANES * k for k in range(11)
)
#: Digits of the two parts of blocks' widths, of eight beads
_OF_DIGITS = 2 * LANES
#: Words that are all set
_EVERYWHERE = np.uint64(2**64 - 1)
#: Largest squares of the distance within the core, and within the circle d = 1
_WITHIN_CORE, _WITHIN_CIRCLE = CORE * CORE, 1.0 - 2.0**-53


class Blocks(NamedTuple):
    """The blocks of all charts: rectangles of their coordinates (x, y)."""

    chart: Integers
    """(n,) the chart of each block: CORE_CHART, RING, OUTER or TRIANGLE"""
    bounds: Array
    """(n, 4): x from, to, y from, to"""


def blocks(half_angle: float, reach: float) -> Blocks:
    """Return the blocks of a table: rectangles in coordinates (x, y) in which the force is smooth.

    The cone of light has the half angle theta_m = `half_angle` (rad), and tau = tan(theta_m/2). The
    bead is at most `reach` radii from the focus. P and Q are the coordinates of the outer chart.
    Block 0 is the core and blocks 1 to 3 are the ring. Block 5 + 5 i + j is the part of the outer
    chart from line i of P to the next and from line j of Q to the next. The block between -tau and
    tau twice is the half y > 0 of the triangle instead; the other half is block 4.
    """
    sine, tau = math.sin(half_angle), math.tan(half_angle / 2)
    farthest = max(math.tan((math.pi / 2 + math.acos(1 / max(reach, 1.0))) / 2), 1.5 / tau)
    across = [-1.0, -sine, sine, 1.0]
    lines = [-farthest, -1 / tau, -tau, tau, 1 / tau, farthest]
    parts = [
        (0.0, CORE**2, -CORE, CORE),
        *((0.0, math.sqrt(1 - CORE**2), *across[i : i + 2]) for i in range(3)),
        (0.0, 1.0, -2 * tau, 0.0),
        *((*lines[i : i + 2], *lines[j : j + 2]) for i in range(5) for j in range(5)),
    ]
    parts[_TRIANGLES[1]] = (0.0, 1.0, 0.0, 2 * tau)
    chart = np.array([CORE_CHART, *[RING] * 3, *[OUTER] * 26])
    chart[list(_TRIANGLES)] = TRIANGLE
    return Blocks(chart, np.array(parts))


def places(chart: Integers, x: Array, y: Array, half_angle: float) -> tuple[Array, Array]:
    """Return (rho, z), in radii, at coordinates of charts.

    Parameters
    ----------
    chart : ndarray of int, shape (n,)
        Numbers of the charts.
    x, y : ndarray, shape (n, ...)
        Coordinates. They may be beyond the axis and w = 0, to which nodes of a piece may reach.
    half_angle : float
        Half angle of the cone of light, rad.
    """
    rho, z = np.empty(x.shape), np.empty(x.shape)
    for each in range(4):
        on = chart == each
        rho[on], z[on] = _places(each, x[on], y[on], half_angle)
    return rho, z


def _places(chart: int, x: Array, y: Array, half_angle: float) -> tuple[Array, Array]:
    """Return (rho, z), in radii, at coordinates x, y of one chart; see `places`."""
    if chart == CORE_CHART:
        return np.sqrt(x), y
    if chart == RING:
        d = np.sqrt((1 - x) * (1 + x))
        return d * np.sqrt((1 - y) * (1 + y)), d * y
    if chart == TRIANGLE:
        difference = x * (2 * math.tan(half_angle / 2) - np.abs(y))
        x, y = (y - difference) / 2, (y + difference) / 2
    p, q = math.pi / 2 + 2 * np.arctan(x), math.pi / 2 + 2 * np.arctan(y)
    gamma, eta = (p + q) / 2, (q - p) / 2
    d = 1 / np.maximum(np.cos(eta), _LEAST_COSINE)
    return np.abs(d * np.sin(gamma)), d * np.cos(gamma)


def beyond(chart: Integers, bounds: Array, reach: float) -> NDArray[np.bool_]:
    """Return whether rectangles lie wholly outside the table's range, by more than rounding, (n,).

    `chart` (n,) is the chart of each. `bounds` (n, 4) are its ends in x and in y, and `reach` is
    the range in radii.
    """
    slack = 1e-9
    x0, x1, y0, y1 = bounds.T
    nearest = np.where(y0 * y1 <= 0, 0.0, np.minimum(y0**2, y1**2))
    off_core = x0 + nearest > min(CORE, reach) ** 2 + slack
    off_ring = (1 - x1) * (1 + x1) > reach**2 + slack
    p0, p1, q0, q1 = math.pi / 2 + 2 * np.arctan(bounds.T)
    past_an_axis = (p1 + q1 < -slack) | (p0 + q0 > 2 * math.pi + slack)
    past_the_circle = q1 <= p0 + slack
    eta = math.acos(1 / max(reach, 1.0))
    off_outer = past_an_axis | past_the_circle | (q0 - p1 > 2 * eta + slack)
    return np.select(
        [chart == CORE_CHART, chart == RING, chart == OUTER],
        [off_core, off_ring, off_outer | (reach < 1)],
        reach < 1,
    )


@named_njit(**INNER)
def _core(rho, squared, z, numbers, frames):  # type: ignore[no-untyped-def]
    """Return the place of eight beads in the chart of the core.

    The core is the region of the table in which the focus is near the centre of the bead. The
    result has nine entries. First come the block, and the coordinates x = rho^2 and y = z. The
    fractions of the block's width below x and y follow, then dx/drho, dx/dz, dy/drho and dy/dz.

    rho and z are positions of the beads in radii, and `squared` is rho^2. The frames of the blocks
    start at `numbers[frames]` in the data of the kernel.
    """
    zero = spread(0.0)
    _, part_x = _interval(squared, numbers, frames, 0, 1)
    _, part_y = _interval(z, numbers, frames + 2, 0, 1)
    return zero, squared, z, part_x, part_y, 2.0 * rho, zero, zero, spread(1.0)


@named_njit(**INNER)
def _ring(rho, z, dd, numbers, frames):  # type: ignore[no-untyped-def]
    """Return the place of eight beads in the chart of the ring, with the focus inside the bead.

    rho and z are in radii, and `dd` is d^2 = rho^2 + z^2 < 1. The coordinates are x = sqrt(1 - d^2)
    and y = z/d. Other arguments and the result are as in `_core`.
    """
    w = _largest(root(1.0 - dd), spread(_LEAST_W))
    over_d, per_w = 1.0 / root(dd), 1.0 / w
    y = z * over_d
    cube = over_d * over_d * over_d
    first = frames + _FRAME
    _, part_x = _interval(w, numbers, first, 0, 1)
    i, part_y = _interval(y, numbers, first + 2, _FRAME, 3)
    return (
        1.0 + i, w, y, part_x, part_y, -(rho * per_w), -(z * per_w), -(rho * z * cube),
        rho * rho * cube,
    )  # fmt: skip


@named_njit(**INNER)
def _outside(rho, z, dd, tau, numbers, frames):  # type: ignore[no-untyped-def]
    """Return the place of eight beads in the outer chart or the triangle, as `_core`.

    The focus is outside the bead. rho and z are in radii, `dd` is d^2 = rho^2 + z^2, and `tau` is
    tan(theta_m/2) for the half angle theta_m of the cone. The outer coordinates are
    P = tan((p - pi/2)/2) and Q = tan((q - pi/2)/2), with p, q = gamma -+ arccos(1/d) and gamma the
    bead's angle to the axis.
    """
    w = _largest(root(dd - 1.0), spread(_LEAST_W))
    below_p, below_q = dd + rho - z * w, dd + rho + z * w
    shared = -1.0 / (below_p * below_q)
    P = (z + rho * w) * below_q * shared
    Q = (z - rho * w) * below_p * shared
    # dP = (1 + P^2)/2 dp, where p = gamma - eta and q = gamma + eta
    half_dd, per_w = 0.5 / dd, 1.0 / w
    by_p, by_q = (1.0 + P * P) * half_dd, (1.0 + Q * Q) * half_dd
    P_rho, P_z = by_p * (z - rho * per_w), by_p * (-(z * per_w) - rho)
    Q_rho, Q_z = by_q * (z + rho * per_w), by_q * (z * per_w - rho)
    first = frames + _OUTER * _FRAME
    i, part_p = _interval(P, numbers, first, 5 * _FRAME, 5)
    j, part_q = _interval(Q, numbers, first + 2, _FRAME, 5)
    block = float(_OUTER) + 5.0 * i + j
    inner = below(_largest(_size(P), _size(Q)), spread(tau))
    if not anywhere(inner):
        return block, P, Q, part_p, part_q, P_rho, P_z, Q_rho, Q_z
    y = P + Q
    per_width = 1.0 / (2.0 * tau - _size(y))
    x = (Q - P) * per_width
    x = chosen(below(x, spread(1.0)), x, spread(1.0))
    between = (_TRIANGLES[1] - _TRIANGLES[0]) * _FRAME
    half, part_y = _interval(y, numbers, frames + _TRIANGLES[0] * _FRAME + 2, between, 2)
    turn = x * (2.0 * half - 1.0)
    y_rho, y_z = P_rho + Q_rho, P_z + Q_z
    x_rho = (Q_rho - P_rho + turn * y_rho) * per_width
    x_z = (Q_z - P_z + turn * y_z) * per_width
    triangle = _LOWER + half * (_UPPER - _LOWER)
    return (
        chosen(inner, triangle, block), chosen(inner, x, P), chosen(inner, y, Q),
        chosen(inner, x, part_p), chosen(inner, part_y, part_q), chosen(inner, x_rho, P_rho),
        chosen(inner, x_z, P_z), chosen(inner, y_rho, Q_rho), chosen(inner, y_z, Q_z),
    )  # fmt: skip


@named_njit(**INNER)
def _interval(a, numbers, first, apart, count):  # type: ignore[no-untyped-def]
    """Return the number of the interval that contains `a`, and the part of its width below `a`.

    `a` are eight numbers. There are `count` intervals, one after the other. The beginning of
    interval k is in `numbers` at first + k apart, and 1/width at the next entry.
    """
    number, begin, per_width = spread(0.0), spread(numbers[first]), spread(numbers[first + 1])
    for k in range(1, count):
        at = first + k * apart
        before = below(a, spread(numbers[at]))
        number = chosen(before, number, number + 1.0)
        begin = chosen(before, begin, spread(numbers[at]))
        per_width = chosen(before, per_width, spread(numbers[at + 1]))
    return number, (a - begin) * per_width


@named_njit(**INNER)
def _largest(a, b):  # type: ignore[no-untyped-def]
    """Return the larger of each of eight pairs of numbers."""
    return chosen(below(a, b), b, a)


@named_njit(**INNER)
def _smallest(a, b):  # type: ignore[no-untyped-def]
    """Return the smaller of each of eight pairs of numbers."""
    return chosen(below(b, a), b, a)


@named_njit(**INNER)
def _size(a):  # type: ignore[no-untyped-def]
    """Return the magnitudes of eight numbers."""
    return _largest(a, -a)


@named_njit(**INNER)
def _put_chart(chart, which, gradient, found, digits):  # type: ignore[no-untyped-def]
    """Store the place of eight beads in a chart where the words `which` are set, else keep it.

    `chart` is a result of `_core`. `found` receives its block and coordinates, and with `gradient`
    its derivatives. `digits` receives the binary digits of the fractions of the block's width, by
    which `_piece_of` finds the piece.
    """
    for k in range(3):
        at = _BLOCK + k * LANES
        store(found, at, chosen(which, chart[k], lanes(found, at)))
    for k in range(2):
        # the last 52 bits of a number from 1 to 2 are the digits of what is above 1
        within = as_words(1.0 + _largest(spread(0.0), _smallest(chart[3 + k], spread(_BELOW_1))))
        before = as_lanes(words(digits, k * LANES))
        now = as_lanes(within & _FRACTION)
        store(digits, k * LANES, as_words(chosen(which, now, before)))
    if gradient:
        for k in range(4):
            at = _U_RHO + k * LANES
            store(found, at, chosen(which, chart[5 + k], lanes(found, at)))


@named_njit(**INNER)
def _put_charts(x1, x2, z, data, gradient, found, digits):  # type: ignore[no-untyped-def]
    """Find the chart of each of eight beads; store its place there in `found` and `digits`.

    Positions x1, x2 and z are in radii, and `data` belongs to the kernel. With `gradient` the
    derivatives are stored. The block of a bead beyond the table's range is -1.
    """
    numbers, shape, frames = data.numbers, begin_of(data, 0), begin_of(data, 1)
    tau, reach = numbers[shape + 1], numbers[shape + 2]
    squared = x1 * x1 + x2 * x2
    dd, rho = squared + z * z, root(squared)
    store(found, _X1, x1)
    store(found, _X2, x2)
    store(found, _RHO, rho)
    past_core, past_circle = below(spread(_WITHIN_CORE), dd), below(spread(_WITHIN_CIRCLE), dd)
    inside = below(dd, spread(reach * reach))
    everywhere = spread(_EVERYWHERE)
    _put_chart(_core(rho, squared, z, numbers, frames), everywhere, gradient, found, digits)
    if anywhere(past_core):
        chart = _ring(rho, z, dd, numbers, frames)
        _put_chart(chart, past_core, gradient, found, digits)
        if anywhere(past_circle):
            chart = _outside(rho, z, dd, tau, numbers, frames)
            _put_chart(chart, past_circle, gradient, found, digits)
    store(found, _BLOCK, chosen(inside, lanes(found, _BLOCK), spread(-1.0)))


@named_njit(**INNER)
def _piece_of(block, along_x, along_y, integers, roots, index):  # type: ignore[no-untyped-def]
    """Return the number of the piece that contains a position in a block, or `NO_PIECE`.

    `along_x` and `along_y` are digits of the fractions of the block's width below the position.
    The arrays `roots` and `index` of a table begin at these entries of `integers`, the data as
    32-bit integers.

    An index entry is the number of a piece, or -2 - (64 start + 8 bits_x + bits_y) for a page: a
    grid of 2^bits_x by 2^bits_y entries over the same rectangle. So the digits lead to the piece.
    """
    entry = int64(integers[uint64(roots + block)])
    left_x = left_y = _DIGITS
    while entry < NO_PIECE:
        page = -2 - entry
        bits_x, bits_y = (page >> 3) & 7, page & 7
        left_x -= bits_x
        left_y -= bits_y
        i = (along_x >> left_x) & ((1 << bits_x) - 1)
        j = (along_y >> left_y) & ((1 << bits_y) - 1)
        entry = int64(integers[uint64(index + (page >> 6) + (i << bits_y) + j)])
    return entry


@named_njit(**INNER)
def _find(position, at, many, data, gradient, pieces, size, first, there, found):  # type: ignore[no-untyped-def]
    """Find the pieces of up to eight beads and the beads' coordinates on them.

    The beads are the `many` rows of `position` (n, 3), m, that start at row `at`. The first piece
    starts at entry `pieces` of the kernel's data, and each piece has `size` numbers. With
    `gradient` the derivatives of the coordinates are computed too.

    `first` receives the entry at which the piece of each bead starts, and `found` its coordinates.
    `there` receives 1 for a bead with a piece and 0 for a bead without one. Returns whether all
    eight beads have a piece.
    """
    numbers, integers = data.numbers, data.numbers.view(np.int32)
    roots, index, heads = 2 * begin_of(data, 2), 2 * begin_of(data, 3), uint64(begin_of(data, 4))
    digits = on_stack(_OF_DIGITS, np.int64)
    x1, x2, z = coordinates(position, at, many, found)
    per_radius = 1.0 / numbers[begin_of(data, 0)]
    _put_charts(per_radius * x1, per_radius * x2, per_radius * z, data, gradient, found, digits)
    whole = many == LANES
    for i in range(many):
        block, piece = int64(found[_BLOCK + i]), NO_PIECE
        if block >= 0:
            piece = _piece_of(block, digits[i], digits[LANES + i], integers, roots, index)
        there[i] = int64(piece != NO_PIECE)
        piece = max(piece, 0)  # without a piece the first one is read, and left out by `there`
        first[i] = pieces + size * piece
        whole = whole and there[i] != 0
        head = heads + uint64(HEAD * piece)
        per_x, per_y = numbers[head + uint64(1)], numbers[head + uint64(3)]
        found[_U + i] = (found[_U + i] - numbers[head]) * per_x
        found[_V + i] = (found[_V + i] - numbers[head + uint64(2)]) * per_y
        if gradient:
            found[_U_RHO + i] *= per_x
            found[_U_Z + i] *= per_x
            found[_V_RHO + i] *= per_y
            found[_V_Z + i] *= per_y
    return whole


@cached_njit(error_model="numpy", nogil=True)
def find(positions, data, piece_out):  # type: ignore[no-untyped-def]
    """Fill `piece_out` (n,) with the numbers of the pieces of positions (n, 3) m, or `NO_PIECE`.

    `data` belongs to the kernel of the table.
    """
    first, there = on_stack(LANES, np.int64), on_stack(LANES, np.int64)
    found = on_stack(_FOUND, np.float64)
    n = positions.shape[0]
    for at in range(0, n, LANES):
        many = min(LANES, n - at)
        _find(positions, at, many, data, False, 0, 1, first, there, found)
        for i in range(many):
            piece_out[at + i] = first[i] if there[i] != 0 else NO_PIECE


@named_njit(**INNER)
def _function(values, at, gradient, found):  # type: ignore[no-untyped-def]
    """Return a function of rho and z, and its derivatives over x1, x2 and z, for eight beads.

    In the output `values` of `read` the function starts at `at`, followed by its derivatives over
    the coordinates u and v on the piece. `found` contains the derivatives of u and v over rho and z
    in radii. Compiled code always returns four numbers. Without `gradient` the value replaces the
    derivatives, which no caller reads.
    """
    value = lanes(values, at)
    if not gradient:
        return value, value, value, value
    by_u, by_v = lanes(values, at + LANES), lanes(values, at + 2 * LANES)
    rho = lanes(found, _RHO)
    # 0 on the axis, where rho = 0 has no bit set and 1/rho is infinite
    over_rho = chosen(as_words(rho), 1.0 / rho, spread(0.0))
    radial = over_rho * (by_u * lanes(found, _U_RHO) + by_v * lanes(found, _V_RHO))
    along = by_u * lanes(found, _U_Z) + by_v * lanes(found, _V_Z)
    return value, radial * lanes(found, _X1), radial * lanes(found, _X2), along


@functools.cache
def kernel(*, gradient: bool, moment: bool) -> Kernel:
    """Return the kernel that reads a table, compiled without the parts that a scene does not need.

    The kernel adds gradients if `gradient`, and the torque (3.25) if `moment`. Its data begin with
    the radius (m), tan(theta_m/2) for the half angle theta_m of the cone and the range (radii).
    The unit of force n_m P/c (N) and the bound on the error of the force (N) follow. Then come
    `frames`, `roots`, `index`, `heads` and `pieces` of `tweezer.optics.rays.tabulate.Made`, and the
    force outside the range.
    """
    components, kinds = 3 if moment else 2, 3 if gradient else 1
    of_rows = components * ROWS * (2 if gradient else 1)
    of_values, of_piece = components * kinds * LANES, components * COEFFICIENTS

    @cached_njit(KERNEL, error_model="numpy", nogil=True)
    def read_charts(pose, data, wrench):  # type: ignore[no-untyped-def]
        """Add the tabled force, as a kernel: eight beads at a time are looked up and evaluated."""
        pose, data, wrench = borrowed(pose), borrowed(data), borrowed(wrench)
        numbers, shape = data.numbers, begin_of(data, 0)
        radius, strength, certified = numbers[shape], numbers[shape + 3], numbers[shape + 4]
        per_radius, pieces = 1.0 / radius, begin_of(data, 5)
        first, there = on_stack(LANES, np.int64), on_stack(LANES, np.int64)
        found = on_stack(_FOUND, np.float64)
        rows, values = on_stack(of_rows, np.float64), on_stack(of_values, np.float64)
        parts, zero = on_stack(PARTS, np.float64), spread(0.0)
        none = zero, zero, zero, zero
        n = pose.position.shape[0]
        for at in range(0, n, LANES):
            many = min(LANES, n - at)
            whole = _find(
                pose.position, at, many, data, gradient, pieces, of_piece, first, there, found
            )
            if whole:
                store(wrench.error, at, lanes(wrench.error, at) + certified)
            else:
                for i in range(many):
                    if there[i] != 0:
                        wrench.error[at + i] += certified
                    else:
                        add_one(part(data, 6), pose, at + i, wrench)
            read(numbers, first, components, many, found, _U, _V, gradient, rows, values)
            x1, x2 = lanes(found, _X1), lanes(found, _X2)
            f = _function(values, 0, gradient, found)
            g = _function(values, kinds * LANES, gradient, found)
            put(f, none, g, x1, x2, strength, per_radius, gradient, parts)
            add_up(parts, there, at, many, whole, gradient, wrench.force, wrench.force_gradient)
            if moment:
                m = _function(values, 2 * kinds * LANES, gradient, found)
                put(none, m, none, x1, x2, strength * radius, per_radius, gradient, parts)
                add_up(
                    parts, there, at, many, whole, gradient, wrench.moment,
                    wrench.moment_gradient,
                )  # fmt: skip

    return read_charts
