"""Polynomials of two variables on pieces of a table, for eight beads at a time.

A function is a polynomial of degree 7 in u and in v on each piece. Its 64 coefficients are one row
of the eight powers of v for each power of u. A row is summed over u for one bead after the other,
all its powers of v at once, and then over v for all eight beads at once.
"""

from __future__ import annotations

from typing import Any

from tweezer.compiled import named_njit
from tweezer.compiled.lanes import LANES, add_columns, columns, lanes, spread, store, transposed

#: Count of coefficients along u and along v
ORDER = LANES
#: Coefficients of one function on one piece
COEFFICIENTS = ORDER * ORDER
#: Numbers of the rows of one function of eight beads
ROWS = LANES * LANES

#: Coordinates of eight beads
PLACES = 3 * LANES
#: Numbers of the vectors of eight beads and their gradients
PARTS = 12 * LANES

#: Compiler options of functions of lanes, which are to stay in registers
INNER: dict[str, Any] = {"inner": True, "error_model": "numpy", "forceinline": True}


@named_njit(**INNER)
def read(numbers, first, functions, many, found, u, v, gradient, rows, out):  # type: ignore[no-untyped-def]
    """Compute the values of polynomials at the coordinates of up to eight beads, into `out`.

    The coefficients of the `functions` of bead i start at `numbers[first[i]]`. `many` is the number
    of beads. Their coordinates on the pieces start at `found[u]` and `found[v]`.

    `out` receives eight values of each function. With `gradient`, eight derivatives over u and
    eight over v follow. The entries of missing beads are arbitrary. `rows` is work space: `ROWS`
    numbers for each function, or twice as many with `gradient`.
    """
    kinds, slopes = 3 if gradient else 1, functions * ROWS
    for i in range(many):
        begin, along = first[i], found[u + i]
        for f in range(functions):
            row, slope = lanes(numbers, begin + (ORDER - 1) * LANES), spread(0.0)
            for k in range(ORDER - 2, -1, -1):
                if gradient:
                    slope = slope * along + row
                row = row * along + lanes(numbers, begin + k * LANES)
            store(rows, f * ROWS + i * LANES, row)
            if gradient:
                store(rows, slopes + f * ROWS + i * LANES, slope)
            begin += COEFFICIENTS
    across = lanes(found, v)
    square = across * across
    fourth = square * square
    for f in range(functions):
        at = f * kinds * LANES
        c = transposed(rows, f * ROWS)
        store(out, at, _sum(c, across, square, fourth))
        if gradient:
            d = transposed(rows, slopes + f * ROWS)
            store(out, at + LANES, _sum(d, across, square, fourth))
            store(out, at + 2 * LANES, _slope(c, across, square, fourth))


@named_njit(**INNER)
def _sum(c, v, square, fourth):  # type: ignore[no-untyped-def]
    """Return c[0] + c[1] v + ... + c[7] v^7 for eight beads; square, fourth: v^2, v^4."""
    low = (c[0] + v * c[1]) + square * (c[2] + v * c[3])
    return low + fourth * ((c[4] + v * c[5]) + square * (c[6] + v * c[7]))


@named_njit(**INNER)
def _slope(c, v, square, fourth):  # type: ignore[no-untyped-def]
    """Return c[1] + 2 c[2] v + ... + 7 c[7] v^6, the derivative of `_sum` over v."""
    low = (c[1] + v * (2.0 * c[2])) + square * (3.0 * c[3] + v * (4.0 * c[4]))
    return low + fourth * ((5.0 * c[5] + v * (6.0 * c[6])) + square * (7.0 * c[7]))


@named_njit(**INNER)
def put(f, h, g, x, y, unit, per_length, gradient, parts):  # type: ignore[no-untyped-def]
    """Fill `parts` with the vectors unit (f x - h y, f y + h x, g) of eight beads.

    `f`, `h` and `g` are functions of the position, each a value and its derivatives over x, y and
    z. `x` and `y` are coordinates of the beads in 1/per_length. `unit` is the unit of the vector, N
    or N m. With `gradient` the gradients are stored too, in unit per_length. `parts` has `PARTS`
    numbers, in the order that `add_up` describes.
    """
    store(parts, 0, unit * (f[0] * x - h[0] * y))
    store(parts, LANES, unit * (f[0] * y + h[0] * x))
    store(parts, 2 * LANES, unit * g[0])
    if gradient:
        scale = unit * per_length
        for j in range(3):
            at = (3 + j) * LANES
            store(parts, at, scale * (f[j + 1] * x - h[j + 1] * y))
            store(parts, at + 3 * LANES, scale * (f[j + 1] * y + h[j + 1] * x))
            store(parts, at + 6 * LANES, scale * g[j + 1])
        store(parts, 3 * LANES, lanes(parts, 3 * LANES) + scale * f[0])
        store(parts, 4 * LANES, lanes(parts, 4 * LANES) - scale * h[0])
        store(parts, 6 * LANES, lanes(parts, 6 * LANES) + scale * h[0])
        store(parts, 7 * LANES, lanes(parts, 7 * LANES) + scale * f[0])


@named_njit(**INNER)
def coordinates(position, at, many, spare):  # type: ignore[no-untyped-def]
    """Return x, y and z of eight consecutive beads in `position` (n, 3), starting at index `at`.

    If only `many` < 8 are left, the last of them is repeated. `spare` is a workspace of `PLACES`
    numbers.
    """
    if many == LANES:
        return columns(position, 3 * at)
    if many == 1:
        return spread(position[at, 0]), spread(position[at, 1]), spread(position[at, 2])
    for i in range(LANES):
        for k in range(3):
            spare[3 * i + k] = position[at + min(i, many - 1), k]
    return columns(spare, 0)


@named_njit(**INNER)
def add_up(parts, there, at, many, whole, gradient, vectors, gradients):  # type: ignore[no-untyped-def]
    """Add the vectors of up to eight beads, and their gradients, to arrays of all beads.

    `parts` contains the three entries of the vectors, then the nine of the gradients, each for
    eight beads. `there` (8,) is 0 for a bead that is omitted; it is not read if `whole`, when all
    eight count. `at` is the first bead and `many` their number. The arrays are `vectors` (n, 3)
    and, if `gradient`, `gradients` (n, 3, 3).
    """
    if whole:
        x, y, z = lanes(parts, 0), lanes(parts, LANES), lanes(parts, 2 * LANES)
        add_columns(vectors, 3 * at, x, y, z)
    if gradient or not whole:
        for i in range(many):
            if whole or there[i] != 0:
                for k in range(3):
                    if not whole:
                        vectors[at + i, k] += parts[k * LANES + i]
                    if gradient:
                        for j in range(3):
                            gradients[at + i, k, j] += parts[(3 + 3 * k + j) * LANES + i]
