"""Azimuthal orders of the light of an uneven pupil about the bead, by sums over plane waves.

The pupil's factor T differs around the axis. At each node of the polar angle, the light about a
bead at (x, y) has the azimuthal orders

    A_v = (1/N) sum_phi T exp(i k sin(theta) (x cos(phi) + y sin(phi))) exp(-i v phi)

over N azimuths. They take the place of i^v J_v exp(-i v phi_r) of an even pupil, so the amplitudes
of `tweezer.optics.waves.partial_waves` become, in the frame of the scene,

    P_nm = (-i)^m integral g(u) f^l_nm(u) A_(m-j) exp(i k z u) du.

The cost does not depend on T. Opposite azimuths have conjugate phases, and the orders v and -v
share their products.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tweezer.compiled import named_njit
from tweezer.compiled.lanes import LANES, as_words, chosen, lanes, spread, store
from tweezer.forces.data import matrix, number, vector
from tweezer.optics.waves.partial_waves import (
    FIRST_HARMONIC,
    FIRST_NODE,
    HELICITY,
    IM,
    MOMENTUM,
    NODES,
    OPTIONS,
    PADDED,
    RE,
    SINE,
    contracted,
)

Array = Any

#: Number of fields of a `Source`, after which those of the grid follow in the data
_OF_SOURCE = 13
#: Coefficients of sin(x)/x and cos(x) over powers of x^2, to rounding for |x| < pi/4
_SINE = tuple((-1) ** k / math.factorial(2 * k + 1) for k in range(8))
_COSINE = tuple((-1) ** k / math.factorial(2 * k) for k in range(9))
#: pi/2 as a sum of three numbers, of which the first two have few digits, for exact products
_FIRST, _SECOND, _THIRD = 1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21
#: Number that moves the whole part of a sum to the last bits of its word
_WHOLE = 1.5 * 2.0**52
_ODD, _HALF_TURN = np.uint64(1), np.uint64(2)

# columns of a rule: number of azimuths, first entry of its factor, first of its circle
AZIMUTHS, FACTOR, CIRCLE = range(3)


class Grid(NamedTuple):
    """Factor of the pupil on a grid of polar angles and azimuths."""

    rules: Array
    """(rules, 3) numbers of each rule of integration, see AZIMUTHS and so on"""
    factor: Array
    """T of all rules: for each azimuth the real and then the imaginary parts at the nodes"""
    circle: Array
    """cosines, then sines, of the azimuths of all rules"""
    top: int
    """highest order m that is computed"""
    most: int
    """highest order v"""


@named_njit(**OPTIONS)
def grid_of(data, first):  # type: ignore[no-untyped-def]
    """Return the `Grid` that follows the `Source` whose fields begin at the entry `first`."""
    at = first + _OF_SOURCE
    return Grid(
        matrix(data, at), vector(data, at + 1), vector(data, at + 2), int(number(data, at + 3)),
        int(number(data, at + 4)),
    )  # fmt: skip


@named_njit(**OPTIONS)
def size_of(grid, padded):  # type: ignore[no-untyped-def]
    """Return the number of entries of the orders, and of the sums over opposite azimuths."""
    most = 0
    for rule in range(grid.rules.shape[0]):
        most = max(most, int(grid.rules[rule, AZIMUTHS]))
    return (2 * (2 * grid.most + 1) + 2 * most) * padded


@named_njit(**OPTIONS)
def _polynomial(coefficients, x):  # type: ignore[no-untyped-def]
    """Return the sum of coefficients times powers of x, for eight numbers."""
    found = spread(coefficients[-1])
    for k in range(len(coefficients) - 2, -1, -1):
        found = found * x + coefficients[k]
    return found


@named_njit(**OPTIONS)
def _sine_and_cosine(x):  # type: ignore[no-untyped-def]
    """Return sines and cosines of eight angles below 1e5 rad."""
    turned = x * (2.0 / math.pi) + _WHOLE
    quarters = turned - _WHOLE
    word = as_words(turned)
    r = ((x - quarters * _FIRST) - quarters * _SECOND) - quarters * _THIRD
    square = r * r
    sine, cosine = r * _polynomial(_SINE, square), _polynomial(_COSINE, square)
    odd, half = word & _ODD, word & _HALF_TURN
    s, c = chosen(odd, cosine, sine), chosen(odd, sine, cosine)
    turned_cosine = (word + _ODD) & _HALF_TURN
    return chosen(half, -1.0 * s, s), chosen(turned_cosine, -1.0 * c, c)


@named_njit(**OPTIONS)
def azimuthal_orders(source, grid, rule, x, y, room):  # type: ignore[no-untyped-def]
    """Fill `room` with A_v of a bead at (x, y), m: for v = -most..most, re and im at the nodes.

    `rule` is the number of a rule. The last entries of `room` are used for the sums and the
    differences of opposite azimuths.
    """
    padded, first = int(source.rules[rule, PADDED]), int(source.rules[rule, FIRST_NODE])
    count, table = int(grid.rules[rule, AZIMUTHS]), int(grid.rules[rule, FACTOR])
    circle, half = int(grid.rules[rule, CIRCLE]), int(grid.rules[rule, AZIMUTHS]) // 2
    work = 2 * (2 * grid.most + 1) * padded
    k_x, k_y = source.wavenumber * x, source.wavenumber * y
    for p in range(half):
        across = k_x * grid.circle[circle + p] + k_y * grid.circle[circle + count + p]
        for block in range(0, padded, LANES):
            s, c = _sine_and_cosine(
                across * lanes(source.nodes, SINE * source.nodes.shape[1] + first + block)
            )
            at = table + 2 * p * padded + block
            re, im = lanes(grid.factor, at), lanes(grid.factor, at + padded)
            a_re, a_im = re * c - im * s, re * s + im * c
            at += count * padded  # half a turn further, where the phase is the opposite
            re, im = lanes(grid.factor, at), lanes(grid.factor, at + padded)
            b_re, b_im = re * c + im * s, im * c - re * s
            to = work + 4 * p * padded + block
            store(room, to, a_re + b_re)
            store(room, to + padded, a_im + b_im)
            store(room, to + 2 * padded, a_re - b_re)
            store(room, to + 3 * padded, a_im - b_im)
    share = 1.0 / count
    for block in range(0, padded, LANES):
        for v in range(grid.most + 1):
            begin = work + 2 * (v % 2) * padded + block
            c_re, c_im, s_re, s_im = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
            turn = 0
            for p in range(half):
                cosine, sine = grid.circle[circle + turn], grid.circle[circle + count + turn]
                at = begin + 4 * p * padded
                re, im = lanes(room, at), lanes(room, at + padded)
                c_re, c_im = c_re + re * cosine, c_im + im * cosine
                s_re, s_im = s_re + re * sine, s_im + im * sine
                turn += v
                if turn >= count:
                    turn -= count
            to = 2 * (grid.most + v) * padded + block
            store(room, to, share * (c_re + s_im))
            store(room, to + padded, share * (c_im - s_re))
            to = 2 * (grid.most - v) * padded + block
            store(room, to, share * (c_re - s_im))
            store(room, to + padded, share * (c_im + s_re))


@named_njit(**OPTIONS)
def add_uneven_part(source, grid, rule, part, room, low, out):  # type: ignore[no-untyped-def]
    """Add the amplitudes P_nm of a part of the light to `out`; see `partial_waves.add_part`.

    `room` contains A_v (`azimuthal_orders`) and the plane waves of the part.
    """
    count, padded = int(source.rules[rule, NODES]), int(source.rules[rule, PADDED])
    tables = int(source.rules[rule, FIRST_HARMONIC])
    helicity, j = source.parts[part, HELICITY], int(source.parts[part, MOMENTUM])
    c_re, c_im = source.parts[part, RE], source.parts[part, IM]
    for m in range(-grid.top, grid.top + 1):
        order = 2 * (grid.most + m - j) * padded
        for q in range(0, padded, LANES):
            a, b = lanes(room.bessel, order + q), lanes(room.bessel, order + padded + q)
            re, im = lanes(room.re, q), lanes(room.im, q)
            store(room.work, q, a * re - b * im)
            store(room.work, padded + q, a * im + b * re)
        quarter = m % 4  # (-i)^m
        a, b = c_re, c_im
        if quarter == 1:
            a, b = c_im, -c_re
        elif quarter == 2:
            a, b = -c_re, -c_im
        elif quarter == 3:
            a, b = -c_im, c_re
        row = m
        if helicity < 0:
            row = -m
            if m % 2 != 0:
                a, b = -a, -b
        contracted(source, count, padded, tables, m, row, a, b, room.work, low, out)
