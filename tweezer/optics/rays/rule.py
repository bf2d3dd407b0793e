"""Tables of a product rule over the cone of light: nodes, weights, and what estimates their error.

The method is described in `tweezer.optics.rays.panels`.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Polynomial, chebyshev, legendre
from numpy.typing import NDArray

from tweezer.values.arrays import Array

#: Numbers of nodes along x, in the order in which they are tried; multiples of a vector's length. A
#: tuple shows the compiler that none is negative, which lets it vectorise loops over nodes
LEVELS = (4, 8, 12, 16, 20, 24, 28, 32, 40, 48, 64, 96)
#: Numbers of nodes in the azimuth of half a ring or arc, in the order in which they are tried
AZIMUTHS_TRIED = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 20, 24, 32, 48, 64)
#: Largest number of nodes in the azimuth
MOST_AZIMUTHS = AZIMUTHS_TRIED[-1]
#: Largest number of rays in a rule
MOST_RAYS = 4096
#: Number of last coefficients of an expansion that estimate its error
TAIL = 4
#: First row of the half circle in the table of azimuths
CIRCLE = 2 + TAIL
#: Possible orders of the zero of the substitution at an end of a panel
ORDERS = (1, 2, 3)
#: Largest number of coefficients of the light's series whose sum stays in registers
SHORT = 20
#: Number of classes of a ring's width in cos(theta), for the number of its azimuths
WIDTHS = 16


class Rule(NamedTuple):
    """Tables from which the nodes of a scene are computed for a given position of the bead.

    Tables are padded with zeros; indices are (level, ...) along x and (m, ...) for m azimuths.
    """

    half_angle: float
    """theta_m of the cone, rad"""
    series: Array
    """n_m/c times the power per solid angle, N/sr, on y = -1 (rim) to 1 (axis), linear in
    cos(theta): SHORT powers, highest first, or more than SHORT Chebyshev coefficients"""
    left_out: float
    """bound on the error of the series, N/sr"""
    full: Array
    """the series to rounding, for positions with so little light that this matters"""
    rounding: float
    """bound on the error of `full`, N/sr"""
    strength: float
    """n_m P/c of all rays, N"""
    tolerance: float
    """relative, of the force"""
    nodes: Array
    """(level, pair of orders, 3, node): position from a panel's first end, 0 to 1; from its other
    end, without cancellation; and weight"""
    tail: Array
    """(level, TAIL, node) the last Legendre coefficients of a weighted value of 1 at a node"""
    azimuth: Array
    """(m, 5 + 2 TAIL, node). Half an arc, for m in `AZIMUTHS_TRIED`: position from its middle to
    its end, 0 to 1, weight, and the last coefficients. Half a circle: cosine, sine, weight, and the
    last coefficients"""
    missed: Array
    """(2, width, number of azimuths tried) estimated relative error of the azimuth, of circles and
    of arcs, by the width of the ring"""
    degree: float
    """degree of the light in the azimuth of the widest ring"""
    aliased: Array
    """(level,) N, bound on the aliasing of the light's harmonics on the nodes of the disc"""
    radiance: Array
    """(level, node) weight of the disc's nodes times n_m/c times power per solid angle, N"""


def rule(half_angle: float, series: Array, strength: float, tolerance: float) -> Rule:
    """Return the tables of nodes for a cone of light.

    Parameters
    ----------
    half_angle : float
        Half angle of the cone, rad.
    series : ndarray
        Chebyshev coefficients of n_m/c times the power per solid angle, N/sr, as in `Rule.series`.
    strength : float
        n_m P/c, N.
    tolerance : float
        Relative tolerance of the force.
    """
    nodes, tail = _panel_tables()
    full = _summed_fast(series)
    # shortening a short series would save nothing
    needed = series if full.size == SHORT else _needed(series, 1e-3 * tolerance)
    rounding = 1e-15 * float(np.abs(series).sum())
    left_out = float(np.abs(series[needed.size :]).sum()) + rounding
    disc = np.zeros((len(LEVELS), LEVELS[-1]))
    aliased = np.zeros(len(LEVELS))
    for level, count in enumerate(LEVELS):
        too_high = float(np.abs(series[2 * count - 4 :]).sum())
        aliased[level] = too_high * 4 * math.pi * math.sin(half_angle / 2) ** 2
        place, _, weight = nodes[level, 0, :, :count]
        light = chebyshev.chebval(2 * place - 1, series)
        disc[level, :count] = light * weight * 2 * math.sin(half_angle / 2) ** 2
    return Rule(
        half_angle, _summed_fast(needed), left_out, full, rounding, strength,
        tolerance, nodes, tail, _azimuth_tables(), _missed(needed), _degree(needed, tolerance),
        aliased, disc,
    )  # fmt: skip


def _needed(series: Array, tolerance: float) -> Array:
    """Return a series without the last coefficients, whose sizes sum to less than `tolerance`.

    `tolerance` is a part of the sum of all sizes.
    """
    left = np.cumsum(np.abs(series[::-1]))[::-1]
    return np.ascontiguousarray(series[: max(1, int((left > tolerance * left[0]).sum()))])


def _summed_fast(series: Array) -> Array:
    """Return a Chebyshev series in the form that `Rule.series` has.

    These are SHORT powers, highest first. If there are more than SHORT Chebyshev coefficients, or
    if powers lose digits, these coefficients are returned instead.
    """
    if series.size > SHORT:
        return series
    powers = np.pad(chebyshev.cheb2poly(series), (0, SHORT - series.size))[::-1]
    y = np.linspace(-1, 1, 200)
    difference = np.polyval(powers, y) - chebyshev.chebval(y, series)
    lossless = np.abs(difference).max() < 1e-14 * np.abs(series).sum()
    return np.ascontiguousarray(
        powers if lossless else np.pad(series, (0, SHORT + 1 - series.size))
    )


def _degree(series: Array, tolerance: float) -> float:
    """Return the degree of the light in the cosine of the azimuth, on rings as wide as the cone."""
    return len(_needed(series, tolerance)) - 1


def _missed(series: Array) -> Array:
    """Return `Rule.missed`: the error of sums over the azimuth of a ring instead of an integral.

    It depends on the ring's width in cos(theta) and the number of azimuths. It is the unresolved
    part of the light times sin^4 of half the azimuth. This is the highest moment that forces and
    gradients need (`tweezer.optics.rays.nodes`).
    """
    half = (np.arange(WIDTHS) + 1) / WIDTHS  # of a ring's width, in units of half the cone's
    tried = np.array(AZIMUTHS_TRIED)
    missed = np.empty((2, WIDTHS, tried.size))
    # circles, at any distance from the axis: coefficients of cos(k azimuth), k >= 2 m
    count = len(series) + 2
    cosine = chebyshev.chebpts1(count)
    centre = (1 - half[:, None]) * np.linspace(-1, 1, 5)
    light = chebyshev.chebval(centre[..., None] + half[:, None, None] * cosine, series)
    transform = chebyshev.chebvander(cosine, count - 1) * 2 / count
    missed[0] = _left(light, cosine, transform, 2 * tried)
    # arcs up to the rim that are part of a ring: Legendre coefficients of degree 4 m and higher
    count = 32 * math.ceil((2.5 * len(series) + 16) / 32)
    x, w = _gauss(count)
    transform = legendre.legvander(x, count - 1) * (np.arange(count) + 0.5) * w[:, None]
    part = np.linspace(0.06, 1.0, 12)[:, None]  # sin^2 of half the azimuth where the arc ends
    cosine = np.cos(2 * np.arcsin(np.sqrt(part)) * x)
    light = chebyshev.chebval(half[:, None, None] * (cosine + 2 * part - 1) - 1, series)
    missed[1] = _left(light, cosine, transform, 4 * tried)
    return missed


def _left(light: NDArray[np.floating[Any]], cosine: Array, transform: Array, first: Array) -> Array:
    """Return a bound on the part of the light in the coefficients from number `first` upwards.

    It is the sum of their sizes over the mean light of a ring, for the worst of several rings. The
    array `light` (..., rings, nodes), at nodes of the azimuth with this `cosine`, is multiplied by
    sin^4 of half the azimuth. The matrix `transform` maps nodes to coefficients.
    """
    values = light * ((1 - cosine) / 2) ** 2
    coefficients = np.abs(values @ transform)
    after = np.cumsum(coefficients[..., ::-1], axis=-1)[..., ::-1]
    after = np.concatenate([after, np.zeros_like(after[..., :1])], axis=-1)
    left = after[..., np.minimum(first, after.shape[-1] - 1)]
    return np.asarray((left / np.abs(light).mean(axis=-1)[..., None]).max(axis=-2))


@functools.cache
def _panel_tables() -> tuple[Array, Array]:
    """Return `Rule.nodes` and `Rule.tail`: Gauss nodes on a panel from 0 to 1, for each level.

    The nodes follow a substitution whose slope vanishes at the ends, for each pair of ORDERS of the
    zeros.
    """
    nodes = np.zeros((len(LEVELS), len(ORDERS) ** 2, 3, LEVELS[-1]))
    tail = np.zeros((len(LEVELS), TAIL, LEVELS[-1]))
    x, w = (np.concatenate(each) for each in zip(*map(_gauss, LEVELS), strict=True))
    z, ends = (x + 1) / 2, np.cumsum(LEVELS)[:-1]
    for i, low in enumerate(ORDERS):
        for j, high in enumerate(ORDERS):
            rising, slope = _substitution(low, high)
            falling, _ = _substitution(high, low)
            values = np.array([rising(z), falling(1 - z), slope(z) * w / 2])
            for level, of_level in enumerate(np.split(values, ends, axis=1)):
                nodes[level, i * len(ORDERS) + j, :, : LEVELS[level]] = of_level
    for level, count in enumerate(LEVELS):
        tail[level, :, :count] = _legendre_tails(_gauss(count)[0])
    return nodes, tail


@functools.cache
def _substitution(low: int, high: int) -> tuple[Polynomial, Polynomial]:
    """Return the polynomial from 0 to 1 whose slope has zeros of order low - 1 and high - 1.

    They are at 0 and at 1. The slope is returned too.
    """
    z = Polynomial([0, 1])
    slope = z ** (low - 1) * (1 - z) ** (high - 1)
    total = slope.integ()
    return total / total(1), slope / total(1)


def _legendre_tails(x: Array) -> Array:
    """Return the matrix from values at n Gauss nodes x to last Legendre coefficients, (TAIL, n).

    The values are already multiplied by their weights.
    """
    degrees = np.maximum(len(x) - 1 - np.arange(TAIL), 0)
    return np.asarray((2 * degrees + 1)[:, None] * legendre.legvander(x, len(x) - 1).T[degrees])


@functools.cache
def _gauss(count: int) -> tuple[Array, Array]:
    """Return the nodes on [-1, 1] and the weights of the Gauss-Legendre rule of `count` nodes."""
    return legendre.leggauss(count)


@functools.cache
def _azimuth_tables() -> Array:
    """Return `Rule.azimuth`: nodes, weights and last coefficients for each number of azimuths."""
    # padded with nodes without weight, as they are taken in pairs
    table = np.zeros((MOST_AZIMUTHS + 1, 5 + 2 * TAIL, MOST_AZIMUTHS + 2))
    for m in range(1, MOST_AZIMUTHS + 1):
        if m in AZIMUTHS_TRIED:
            # half of 2 m nodes on the whole arc: the light is even in the azimuth
            x, w = (each[m:] for each in _gauss(2 * m))
            even = np.maximum(2 * (m - 1 - np.arange(TAIL)), 0)
            last = (2 * even + 1)[:, None] * legendre.legvander(x, 2 * m).T[even]
            table[m, : 2 + TAIL, :m] = x, w, *last
        j = np.arange(m + 1)
        ends = np.where((j == 0) | (j == m), 0.5, 1.0)
        harmonics = np.maximum(m - np.arange(TAIL), 0)
        table[m, CIRCLE:, : m + 1] = (
            np.cos(np.pi * j / m),
            np.sin(np.pi * j / m),
            ends * np.pi / m,
            *(np.cos(np.pi * j * k / m) * (1 if k in (0, m) else 2) for k in harmonics),
        )
    return table
