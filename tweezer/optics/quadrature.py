"""Rays of a product rule that integrates over the cone of light with spectral convergence.

The sum over rays (3.26) becomes an integral over directions u. A rule is a set of directions with
weights, summed by the same code as the thesis's grid (`tweezer.optics.kernels`). There are two
kinds of rules, each with n nodes in the cosine x of the angle to a pole and m in the azimuth about
it:

* the disc, about the beam's axis: Gauss-Legendre in x = cos(theta), trapezoidal in the azimuth. It
  serves beads that every ray hits well inside the edge. The integrand is then singular only at
  complex directions, where cos(alpha) = 0; their distance from the real ones gives the rate of
  convergence, and so n and m, in advance.
* rings, about the line from the focus to the bead: all rays at an angle g to that line meet the
bead
  at the same angle of incidence alpha, with

      cos(alpha) = (d/r) sqrt(x^2 +- delta^2),  delta^2 = |1 - (r/d)^2|,

  + if the focus is inside the bead (d < r), - if it is outside. The interval of x = cos(g) is cut
  into panels where the integrand is not smooth: where rays graze the bead, where the rim of the
  cone begins or ceases to cut the ring (two values of g), and where total reflection begins.
  cos(alpha) is smooth in t with x = delta sinh(t) or delta cosh(t); for small delta nodes are
  concentrated near cos(alpha) = 0 instead. A substitution with a double zero removes the square
  roots at the rim; the zero is triple if another singularity lies close beyond. At grazing
  incidence the efficiencies vanish, so the derivative over the position has no boundary term and
  needs no other rays.

The last coefficients of the expansions in x (Legendre) and the azimuth (Legendre or Fourier)
estimate the error. A rule that misses its part of the tolerance is repeated with more nodes.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Chebyshev, Legendre, Polynomial, chebyshev
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from tweezer.compiled import cached_njit

Array = NDArray[np.float64]

#: Numbers of nodes along x, in the order in which they are tried; multiples of a vector's length. A
#: tuple shows the compiler that none is negative, which lets it vectorise loops over nodes
LEVELS = (4, 8, 12, 16, 20, 24, 28, 32, 40, 48, 64, 96)
#: Largest number of nodes in the azimuth
MOST_AZIMUTHS = 64
#: Largest number of rays in a rule
MOST_RAYS = 4096
#: Largest number of panels for a position
MOST_PANELS = 192
#: Largest number of rays in a disc; beyond it rings cost less
LARGEST_DISC = 800

#: Number of last coefficients of an expansion that estimate its error
TAIL = 4
#: Estimated relative error of rings and of arcs: factor * tail^power, with tail the largest of the
#: last coefficients. (Gauss's and the trapezoidal rule err by coefficients of about twice the last
#: order that they resolve.) Fitted to tighter rules; (along x, azimuth) of (factor, power)
ERROR_OF_RINGS = ((2.5, 1.75), (10.0, 2.0))
ERROR_OF_ARCS = ((6.0, 1.6), (1.5, 1.75))
#: Weights of the last coefficients in the tail: the earlier ones matter only if the last two are
#: small by chance
_NEAR = (1.0, 1.0, 0.05, 0.05)

#: First row of the half circle in the table of azimuths
_CIRCLE = 2 + TAIL
#: Nodes per decimal digit; one more if the panel starts at a double zero
_NODES_PER_DIGIT = 2.6
#: Possible orders of the zero of the substitution at an end of a panel
_ORDERS = (1, 2, 3)
#: delta below which nodes are concentrated near cos(alpha) = 0
_SMALL_DELTA = 0.1
#: delta below which the focus counts as on the surface of the bead
_NO_DELTA = 1e-7
#: A singularity nearer to a panel's end than this fraction of its length is "close"
_CLOSE = 0.15
#: Smallest distance of singular angles that do not affect each other, rad
_APART = 0.2
#: Angles closer than this are merged, rad: the error is of order gap^(3/2)
_NO_GAP = 1e-8
#: Lower bound on the width of a ring in cos(theta), in units of sin^2(theta_m/2)
_NO_WIDTH = 1e-300
#: 1/n_mP^2 - 1 below which the index of the bead counts as close to that of the medium
_NEARLY_EQUAL = 0.05
#: Taylor coefficients of sin(x)/x in x^2, highest first
_SINE = tuple((-1.0) ** k / math.factorial(2 * k + 1) for k in reversed(range(11)))
#: Largest number of coefficients of the light's series whose sum stays in registers
SHORT = 20
#: Taylor coefficients of exp(x), highest first
_EXP = tuple(1.0 / math.factorial(k) for k in reversed(range(13)))
#: arcsin(sqrt(q))/sqrt(q) on [0, 1/2] as a polynomial in q, highest coefficient first
ARCSINE = tuple(
    Chebyshev.interpolate(
        lambda q: np.divide(np.arcsin(np.sqrt(q)), np.sqrt(q), out=np.ones_like(q), where=q > 0),
        21,
        domain=[0.0, 0.5],
    )
    .convert(kind=Polynomial)
    .coef[::-1]
)
_ARCSINE_HIGH, _ARCSINE_LOW = ARCSINE[:11], ARCSINE[11:]
#: Number of classes of a ring's width in cos(theta), for the number of its azimuths
_WIDTHS = 16


class Rule(NamedTuple):
    """What the nodes of a scene are computed from, beside the position of the bead.

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
    nodes: Array
    """(level, pair of orders, 3, node): position from a panel's first end, 0 to 1; from its other
    end, without cancellation; and weight"""
    tail: Array
    """(level, TAIL, node) the last Legendre coefficients of a weighted value of 1 at a node"""
    azimuth: Array
    """(m, 5 + 2 TAIL, node). Half an arc: position from 0 to 1, weight, and the last coefficients.
    Half a circle: cosine, sine, weight, and the last coefficients"""
    harmonics: NDArray[np.int64]
    """(width,) degree of the light in the azimuth, by the width of the ring"""
    aliased: Array
    """(level,) N, bound on the aliasing of the light's harmonics on the nodes of the disc"""
    radiance: Array
    """(level, node) weight of the disc's nodes times n_m/c times power per solid angle, N"""


def rule(half_angle: float, series: Array, strength: float, tolerance: float) -> Rule:
    """The rule for a cone of light.

    half_angle: rad. series: as `Rule.series`. strength: n_m P/c, N. tolerance: relative, of
    the force.
    """
    nodes, tail = _panel_tables()
    full = _summed_fast(series)
    # a short series costs the same in whole and in part
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
        tolerance, nodes, tail, _azimuth_tables(), _harmonics(needed, tolerance), aliased, disc,
    )  # fmt: skip


def _needed(series: Array, tolerance: float) -> Array:
    """The series without last coefficients that sum to less than `tolerance` of the whole."""
    left = np.cumsum(np.abs(series[::-1]))[::-1]
    return np.ascontiguousarray(series[: max(1, int((left > tolerance * left[0]).sum()))])


def _summed_fast(series: Array) -> Array:
    """The series as SHORT powers, highest first, unless that loses digits."""
    if series.size > SHORT:
        return series
    powers = np.pad(chebyshev.cheb2poly(series), (0, SHORT - series.size))[::-1]
    y = np.linspace(-1, 1, 200)
    difference = np.polyval(powers, y) - chebyshev.chebval(y, series)
    lossless = np.abs(difference).max() < 1e-14 * np.abs(series).sum()
    return np.ascontiguousarray(
        powers if lossless else np.pad(series, (0, SHORT + 1 - series.size))
    )


def _harmonics(series: Array, tolerance: float) -> NDArray[np.int64]:
    """Degree of the light in the azimuth's cosine, for rings of growing width in cos(theta)."""
    half = (np.arange(_WIDTHS) + 1) / _WIDTHS  # of a ring's width, in units of half the cone's
    centre = (1 - half[:, None]) * np.linspace(-1, 1, 5)
    n = len(series)
    nodes = chebyshev.chebpts1(n)
    values = chebyshev.chebval(centre[..., None] + half[:, None, None] * nodes, series)
    to_series = chebyshev.chebvander(nodes, n - 1) * 2 / n
    to_series[:, 0] /= 2
    return np.array([max(len(_needed(part, tolerance)) - 1 for part in row)
                     for row in values @ to_series])  # fmt: skip


@functools.cache
def _panel_tables() -> tuple[Array, Array]:
    """Gauss nodes after substitutions with zeros of the given orders at the ends."""
    nodes = np.zeros((len(LEVELS), len(_ORDERS) ** 2, 3, LEVELS[-1]))
    tail = np.zeros((len(LEVELS), TAIL, LEVELS[-1]))
    for level, count in enumerate(LEVELS):
        x, w = leggauss(count)
        z = (x + 1) / 2
        for i, low in enumerate(_ORDERS):
            for j, high in enumerate(_ORDERS):
                rising, slope = _substitution(low, high)
                falling, _ = _substitution(high, low)
                pair = i * len(_ORDERS) + j
                nodes[level, pair, :, :count] = rising(z), falling(1 - z), slope(z) * w / 2
        tail[level, :, :count] = _legendre_tails(x)
    return nodes, tail


@functools.cache
def _substitution(low: int, high: int) -> tuple[Polynomial, Polynomial]:
    """The polynomial from 0 to 1 whose slope has zeros of order low - 1 and high - 1."""
    z = Polynomial([0, 1])
    slope = z ** (low - 1) * (1 - z) ** (high - 1)
    total = slope.integ()
    return total / total(1), slope / total(1)


def _legendre_tails(x: Array) -> Array:
    """Last coefficients resolved by the Gauss nodes x, for a weighted value of 1, (TAIL, n)."""
    degrees = np.maximum(len(x) - 1 - np.arange(TAIL), 0)
    return np.array([(2 * degree + 1) * Legendre.basis(degree)(x) for degree in degrees])


@functools.cache
def _azimuth_tables() -> Array:
    table = np.zeros((MOST_AZIMUTHS + 1, 5 + 2 * TAIL, MOST_AZIMUTHS + 1))
    for m in range(1, MOST_AZIMUTHS + 1):
        x, w = leggauss(m)
        table[m, : 2 + TAIL, :m] = (x + 1) / 2, w / 2, *_legendre_tails(x)
        j = np.arange(m + 1)
        ends = np.where((j == 0) | (j == m), 0.5, 1.0)
        harmonics = np.maximum(m - np.arange(TAIL), 0)
        table[m, _CIRCLE:, : m + 1] = (
            np.cos(np.pi * j / m),
            np.sin(np.pi * j / m),
            ends * np.pi / m,
            *(np.cos(np.pi * j * k / m) * (1 if k in (0, m) else 2) for k in harmonics),
        )
    return table


# --- the rules of a position ----------------------------------------------------------------------

# columns of the table of the rules of a position
KIND, LEVEL, AZIMUTHS, _POLE, _BEGIN, _SPAN, _PAIR = range(7)
COLUMNS = 7
RATE_X, RATE_AZIMUTH = _BEGIN, _SPAN
# kinds of rules
DISC, RINGS, ARCS = 0, 1, 2


class Place(NamedTuple):
    """Position of the bead, seen from the focus."""

    ratio: float
    """d/r"""
    cos_tilt: float
    sin_tilt: float
    """of the angle gamma between the beam's axis and the line to the bead"""
    delta: float
    beside: bool
    """whether d > r"""
    crowded: bool
    """whether delta is small"""


@cached_njit(error_model="numpy", nogil=True)
def place_of(lateral, axial, radius):  # type: ignore[no-untyped-def]
    """The `Place` of a bead at `lateral` from the axis and `axial` along it."""
    distance = math.hypot(lateral, axial)
    ratio = distance / radius
    cos_tilt, sin_tilt = 1.0, 0.0
    if distance > 0.0:
        cos_tilt, sin_tilt = axial / distance, lateral / distance
    beside = ratio > 1.0 + 0.5 * _NO_DELTA**2
    if beside:
        delta = math.sqrt((1.0 - 1.0 / ratio) * (1.0 + 1.0 / ratio))
    else:
        near = math.sqrt(max((1.0 - ratio) * (1.0 + ratio), 0.0))
        delta = min(max(near, _NO_DELTA) / max(ratio, 1e-3), 1e3)
    return Place(ratio, cos_tilt, sin_tilt, delta, beside, delta < _SMALL_DELTA)


@cached_njit(error_model="numpy", nogil=True)
def rules_of(place, rule, n_mP, rules):  # type: ignore[no-untyped-def]
    """Fill the table of rules of a position; returns their number."""
    digits = 1.0 - math.log10(rule.tolerance)
    if _disc(place, rule, n_mP, digits, rules):
        return 1
    return _panels(place, rule, n_mP, digits, rules)


@cached_njit(error_model="numpy", nogil=True)
def _ellipse(re, im):  # type: ignore[no-untyped-def]
    """Half the long axis of the ellipse with foci -1 and 1 through a point of the complex plane."""
    return 0.5 * (math.sqrt((re - 1.0) ** 2 + im * im) + math.sqrt((re + 1.0) ** 2 + im * im))


@cached_njit(error_model="numpy", nogil=True)
def _level_of(nodes):  # type: ignore[no-untyped-def]
    """The smallest level with at least `nodes` nodes; the last one if none has."""
    for level in range(len(LEVELS)):
        if LEVELS[level] >= nodes:
            return level
    return len(LEVELS) - 1


@cached_njit(error_model="numpy", nogil=True)
def _disc(place, rule, n_mP, digits, rules):  # type: ignore[no-untyped-def]
    """The disc, if every ray hits the bead and few nodes suffice; returns whether it is used.

    cos(alpha) = 0 at cos(g) = +-sqrt(1 - (r/d)^2), imaginary for d < r; cos(beta) = 0 likewise
    with r n_P/n_m.
    """
    rim_cos, rim_sin = math.cos(rule.half_angle), math.sin(rule.half_angle)
    along_rim, across_rim = rim_cos * place.cos_tilt, rim_sin * place.sin_tilt
    # largest angle of a ray to the line, folded: no ray may miss, or be totally reflected
    effective = place.ratio * max(n_mP, 1.0)
    if effective >= 1.0:
        nearest = along_rim - across_rim  # cos(g) at the far side of the rim
        if nearest * place.cos_tilt <= 0.0 or along_rim * place.cos_tilt <= 0.0:
            return False
        sine_far = math.sqrt(max(1.0 - nearest * nearest, 0.0))
        if effective * sine_far >= 0.98:
            return False
    squared = 1.0 - 1.0 / max(effective, 1e-6) ** 2
    re, im = (math.sqrt(squared), 0.0) if squared > 0.0 else (0.0, math.sqrt(-squared))
    centre, half = 0.5 * (1.0 + rim_cos), 0.5 * (1.0 - rim_cos)
    # the error decays as for a function analytic in the Bernstein ellipse through the singularity
    axis_x, axis_azimuth = 1e6, 1e6
    cross = math.sqrt(max(1.0 - squared, 0.0)) * place.sin_tilt
    for sign in (-1.0, 1.0):
        if across_rim > 1e-12:
            axis_azimuth = min(
                axis_azimuth, _ellipse((sign * re - along_rim) / across_rim, im / across_rim)
            )
        for side in (-1.0, 1.0):
            real = (place.cos_tilt * sign * re + side * cross - centre) / half
            axis_x = min(axis_x, _ellipse(real, place.cos_tilt * im / half))
    rate_x, rate_azimuth = math.acosh(max(axis_x, 1.0)), math.acosh(max(axis_azimuth, 1.0))
    if rate_x <= 0.0 or rate_azimuth <= 0.0:
        return False
    decay = 0.5 * digits * math.log(10.0)
    nodes = math.ceil(0.9 * decay / rate_x) + rule.harmonics[-1] // 4
    # exact for a product with the light's highest harmonic, as the light may not be smooth
    nodes = max(nodes, rule.harmonics[-1] // 2 + 4)
    azimuths = 1
    if place.sin_tilt > 0.0:
        azimuths = max(math.ceil(decay / rate_azimuth) + 2, 3)
    level = _level_of(nodes)
    if nodes > LEVELS[-1] or LEVELS[level] * (azimuths + 1) > LARGEST_DISC:
        return False
    rules[0, KIND] = DISC
    rules[0, LEVEL] = level
    rules[0, AZIMUTHS] = azimuths
    # decay of the coefficients for the error estimate; at least that of the light
    of_light = (digits - 1.0) * math.log(10.0) / max(rule.harmonics[-1], 1)
    rules[0, RATE_X] = min(rate_x, of_light)
    rules[0, RATE_AZIMUTH] = min(rate_azimuth, of_light)
    return True


@cached_njit(error_model="numpy", nogil=True)
def _pole_of(place):  # type: ignore[no-untyped-def]
    """t at the pole, where x = 1; outside the bead rays graze it at t = 0."""
    return math.atanh(1.0 / place.ratio) if place.beside else math.asinh(1.0 / place.delta)


@cached_njit(error_model="numpy", nogil=True)
def _depth(angle, delta, beside):  # type: ignore[no-untyped-def]
    """t at the pole minus t at `angle` from it, without cancellation near the pole."""
    x = 1.0 - 2.0 * math.sin(0.5 * angle) ** 2
    pole, here = 1.0 / delta, x / delta
    if beside:
        here = max(here, 1.0)
        a, b = math.sqrt(pole * pole - 1.0), math.sqrt(here * here - 1.0)
    else:
        a, b = math.sqrt(pole * pole + 1.0), math.sqrt(here * here + 1.0)
        if here < 0.0:
            return math.asinh(pole) + math.asinh(-here)
    # difference of areas by the addition theorem of sinh
    return math.asinh((pole - here) * (pole + here) / (a * here + pole * b))


@cached_njit(error_model="numpy", nogil=True)
def _panels(place, rule, n_mP, digits, rules):  # type: ignore[no-untyped-def]
    """The panels of rings and arcs; returns their number."""
    cuts = np.empty(MOST_PANELS // 2)
    tilt = math.atan2(place.sin_tilt, place.cos_tilt)
    top = math.pi
    if place.beside:
        top = math.asin(1.0 / place.ratio)
    elif place.crowded or n_mP > 1.0:
        top = 0.5 * math.pi
    # total reflection begins at x = +-onset, which may be complex
    critical, onset = -1.0, 1.0
    if n_mP > 1.0:
        inner = n_mP * place.ratio
        onset = math.sqrt(abs(1.0 - 1.0 / max(inner, 1e-6) ** 2))
        if inner > 1.0:
            critical = math.asin(1.0 / inner)
    # Q has a pole at cos(alpha) = i (1/n_mP^2 - 1)/2, of light that goes round inside without end.
    # It sets the nodes per digit on a panel from cos(alpha) = 0 to 1; for a bead of nearly
    # the medium's index panels grow from grazing instead
    pole = 1.0 / n_mP**2 - 1.0
    per_digit = _NODES_PER_DIGIT
    if pole > _NEARLY_EQUAL:
        rate = math.acosh(_ellipse(-1.0, pole))
        per_digit = max(per_digit, math.log(10.0) / (ERROR_OF_RINGS[0][1] * rate))
    count = 0
    both = place.beside or top < 2.0
    for side in range(2):
        if not both and (side == 1) == (place.cos_tilt >= 0.0):
            continue  # all rings in one interval, about the pole nearer to the light
        # angles of the two rims from this pole, and whether rings inside the first and outside
        # the second are whole
        tilt_here = tilt if side == 0 else math.pi - tilt
        first = abs(rule.half_angle - tilt_here)
        second = rule.half_angle + tilt_here
        whole_inside = tilt_here < rule.half_angle
        whole_outside = second > math.pi
        if whole_outside:
            second = 2.0 * math.pi - second
        cuts[0], cuts[1], cuts[2], cuts[3] = 0.0, min(first, top), min(second, top), top
        places = 4
        # arcs that begin near the pole, where sqrt(1 - x) is not smooth: panels grow from it
        last = min(second, top)
        growing = 3.0 * max(first, 1e-3 * last)
        while 0.0 < first < growing < 0.7 * last and places < cuts.size:
            cuts[places] = growing
            growing *= 3.0
            places += 1
        if critical > 0.0:
            cuts[places] = min(critical, top)
            places += 1
            for rim in (first, second):
                places = _growing_apart(critical, rim, top, cuts, places)
        cosine = pole if pole <= _NEARLY_EQUAL else 1.0
        while 0.0 < cosine < 0.7 and places < cuts.size:
            sine = math.sqrt((1.0 - cosine) * (1.0 + cosine)) / max(place.ratio, 1e-3)
            if sine < 1.0:
                cuts[places] = min(math.asin(sine), top)
                places += 1
            cosine = 3.0 * cosine
        if onset < 0.5:
            # panels that grow with the distance from the onset
            x = onset
            while x < 0.5 and places < cuts.size:
                x = max(3.0 * x, 1e-5)
                cuts[places] = min(math.acos(min(x, 1.0)), top)
                places += 1
        for k in range(1, places):  # insertion sort
            cut_at, i = cuts[k], k
            while i > 0 and cuts[i - 1] > cut_at:
                cuts[i] = cuts[i - 1]
                i -= 1
            cuts[i] = cut_at
        places = _without_close(cuts, places, first, second, critical)
        for k in range(places - 1):
            lo, hi = cuts[k], cuts[k + 1]
            length = hi - lo
            if length <= 1e-15 * top:
                continue
            middle = lo + 0.5 * length
            cut = first < middle < second
            if not cut and not (whole_inside if middle <= first else whole_outside):
                continue
            low, high = 1, 1
            if cut:
                if lo == first:
                    low = 2
                if hi == second:
                    high = 3 if math.pi - hi < _CLOSE * length else 2
                elif second - hi < _CLOSE * length:
                    high = 3
            elif hi == top and 0.0 < first - hi < _CLOSE * length:
                high = 2
            if critical > 0.0:
                if lo == critical:
                    low = 2
                if hi == critical:
                    high = 2
            if hi == top and (place.crowded or (n_mP > 1.0 and not place.beside)):
                high = 3
            rules[count, KIND] = ARCS if cut else RINGS
            rules[count, _POLE] = 1.0 if side == 0 else -1.0
            rules[count, _PAIR] = (low - 1) * 3 + high - 1
            if place.crowded:
                a, b = math.cos(lo), math.cos(hi)
                if place.beside:
                    a = math.sqrt(max((a - place.delta) * (a + place.delta), 0.0))
                    b = math.sqrt(max((b - place.delta) * (b + place.delta), 0.0))
                if hi == top:
                    b = 0.0
            else:
                a = _depth(lo, place.delta, place.beside)
                b = _depth(hi, place.delta, place.beside)
                if hi == top and place.beside:
                    b = _pole_of(place)
            rules[count, _BEGIN] = a
            rules[count, _SPAN] = b - a
            # a panel with a small solid angle needs fewer digits
            share_of_angle = (math.cos(lo) - math.cos(hi)) / (1.0 - math.cos(top))
            wanted = max(digits + math.log10(min(3.0 * share_of_angle, 1.0)), 1.0)
            slope = per_digit + (1.0 if low == 2 else 0.0)
            rules[count, LEVEL] = _level_of(2.0 + slope * wanted)
            most = _most_azimuths(int(rules[count, LEVEL]))
            rules[count, AZIMUTHS] = min(_azimuths_of(place, rule, lo, hi, cut), most)
            count += 1
    return count


@cached_njit(error_model="numpy", nogil=True)
def _growing_apart(a, b, top, cuts, places):  # type: ignore[no-untyped-def]
    """Cut where panels end that grow from two singular angles close together; how many cuts then.

    To a panel that begins at one of them the other is no farther than half its length.
    """
    gap = max(abs(a - b), _NO_GAP)
    away = 2.0 * gap
    while away < _APART and places + 2 < cuts.size:
        cuts[places] = min(max(a, b) + away, top)
        cuts[places + 1] = min(max(min(a, b) - away, 0.0), top)
        places += 2
        away = 3.0 * away + 2.0 * gap
    return places


@cached_njit(error_model="numpy", nogil=True)
def _without_close(cuts, places, first, second, critical):  # type: ignore[no-untyped-def]
    """Drop cuts close to a rim or to the onset of total reflection; returns the number left.

    The panel beyond such a cut would end close to a square root and converge slowly, and its last
    coefficients would not show it.
    """
    left = 1
    for k in range(1, places - 1):
        before, here, after = cuts[left - 1], cuts[k], cuts[k + 1]
        if here not in (first, second, critical):
            if before in (first, second, critical) and here - before < _CLOSE * (after - here):
                continue
            if after in (first, second, critical) and after - here < _CLOSE * (here - before):
                continue
        cuts[left] = here
        left += 1
    cuts[left] = cuts[places - 1]
    return left + 1


@cached_njit(error_model="numpy", nogil=True)
def _azimuths_of(place, rule, lo, hi, cut):  # type: ignore[no-untyped-def]
    """Azimuths of the rings from `lo` to `hi`, by the part of the cone that they span."""
    widest = 1.0 if lo < 0.5 * math.pi < hi else max(math.sin(lo), math.sin(hi))
    half = 0.5 * (1.0 - math.cos(rule.half_angle))
    width = widest * place.sin_tilt / half
    bucket = min(int(width * _WIDTHS), _WIDTHS - 1)
    harmonics = rule.harmonics[bucket] if width > 0.0 else 0
    azimuths = 5 + int(0.8 * harmonics) if cut else 4 + int(0.6 * harmonics)
    return min(azimuths, MOST_AZIMUTHS)


@cached_njit(error_model="numpy", nogil=True)
def more_nodes(rules, k, ratio_x, ratio_azimuth):  # type: ignore[no-untyped-def]
    """Raise the nodes of rule k where it misses its tolerance; returns whether that was possible.

    ratio_x, ratio_azimuth: ratio of the digits needed to those reached; at most 1 where it
    suffices.
    """
    level_now, azimuths_now = int(rules[k, LEVEL]), int(rules[k, AZIMUTHS])
    level, azimuths = level_now, azimuths_now
    if ratio_x > 1.0:
        nodes = LEVELS[level] * min(max(ratio_x, 1.15), 2.0)
        level = min(max(_level_of(nodes), level + 1), len(LEVELS) - 1)
        if azimuths > _most_azimuths(level):
            level = level_now
    if ratio_azimuth > 1.0:
        azimuths = max(int(azimuths * min(ratio_azimuth, 2.0)), azimuths + 2)
        azimuths = min(azimuths, _most_azimuths(level))
    rules[k, LEVEL] = level
    rules[k, AZIMUTHS] = azimuths
    return level > level_now or azimuths > azimuths_now


@cached_njit(error_model="numpy", nogil=True)
def _most_azimuths(level):  # type: ignore[no-untyped-def]
    return min(MOST_AZIMUTHS, MOST_RAYS // LEVELS[level] - 1)


# --- the rays of a rule ---------------------------------------------------------------------------

# rows of the workspace for the rays of one rule, and for its nodes
U1, U2, U3, WEIGHT, FORCE, Q_OF, DQ_OF, G_OF, DG_OF, S_OF = range(10)
_X, _S, _W, _SHARE, _NEAREST, _PER_Q, _Q, _Y, _WORK_1, _WORK_2, _AROUND = range(10, 21)
_ROWS = 21
#: Padding of rows. Rows a power of two apart would compete for the same lines of the cache
_APART_IN_CACHE = 72


@cached_njit()
def scratch():  # type: ignore[no-untyped-def]
    """Workspace for the largest rule: direction, weight, force of each ray, and more."""
    return np.empty((_ROWS, 2 * MOST_RAYS + _APART_IN_CACHE))


@cached_njit(error_model="numpy", nogil=True)
def rays_of(place, rule, rules, k, full, rays, linear, gradient):  # type: ignore[no-untyped-def]
    """Fill `rays` with those of rule k, in the frame with the bead at (lateral, 0, axial).

    By symmetry those with u2 >= 0 have twice the weight; for `linear` polarisation both sides are
    filled. Rings have all azimuths if `linear`, else as few as suffice (`_gathered`). full: use the
    full series of the light. Returns the number of rays.
    """
    if rules[k, KIND] == DISC:
        count = _disc_rays(rule, rules, k, rays)
    else:
        series = rule.full if full else rule.series
        count = _ring_nodes(place, rule, rules, k, series, rays)
        if not linear:
            return _gathered(place, rules, k, gradient, rays)
        _spread_out(place, rules, k, rays)
    if not linear:
        return count
    for i in range(count):
        rays[WEIGHT, i] *= 0.5
        rays[U1, count + i] = rays[U1, i]
        rays[U2, count + i] = -rays[U2, i]
        rays[U3, count + i] = rays[U3, i]
        rays[WEIGHT, count + i] = rays[WEIGHT, i]
    return 2 * count


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _disc_rays(rule, rules, k, rays):  # type: ignore[no-untyped-def]
    level, m = int(rules[k, LEVEL]), int(rules[k, AZIMUTHS])
    n = LEVELS[level]
    u1, u2, u3, weight, x, s = rays[U1], rays[U2], rays[U3], rays[WEIGHT], rays[_X], rays[_S]
    rest, radiance = rule.nodes[level, 0, 1], rule.radiance[level]
    circle = rule.azimuth[m, _CIRCLE:]
    versine = 2.0 * math.sin(0.5 * rule.half_angle) ** 2
    for i in range(n):
        below = versine * rest[i]
        x[i] = 1.0 - below
        s[i] = math.sqrt(below * (2.0 - below))
    for j in range(m + 1):
        cosine, sine, share = circle[0, j], circle[1, j], 2.0 * circle[2, j]
        at = j * n
        for i in range(n):
            u1[at + i] = s[i] * cosine
            u2[at + i] = s[i] * sine
            u3[at + i] = x[i]
            weight[at + i] = share * radiance[i]
    return (m + 1) * n


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _ring_nodes(place, rule, rules, k, series, rays):  # type: ignore[no-untyped-def]
    """Nodes of rings or arcs: q = sin^2(half the azimuth about the line to the bead), and weight.

    The azimuth is counted from the side of the beam's axis. Returns the number of nodes.
    """
    level, m, pair = int(rules[k, LEVEL]), int(rules[k, AZIMUTHS]), int(rules[k, _PAIR])
    pole, begin, span = rules[k, _POLE], rules[k, _BEGIN], rules[k, _SPAN]
    n = LEVELS[level]
    ratio, delta, beside = place.ratio, place.delta, place.beside
    cos_tilt, sin_tilt = place.cos_tilt, place.sin_tilt
    x, s, w, share, sine_squared = rays[_X], rays[_S], rays[_W], rays[_SHARE], rays[S_OF]
    nodes = rule.nodes[level, pair]
    fraction, rest, weight = nodes[0], nodes[1], nodes[2]
    if place.crowded:
        end = begin + span
        for i in range(n):
            near = end - span * rest[i]
            if beside:
                x[i] = math.sqrt(delta * delta + near * near)
                cos_alpha = min(ratio * near, 1.0)
                sine_squared[i] = (1.0 - cos_alpha) * (1.0 + cos_alpha)
                s[i] = math.sqrt(sine_squared[i]) / ratio
                w[i] = -span * weight[i] * near / x[i]
            else:
                x[i] = min(near, 1.0)
                s[i] = math.sqrt((1.0 - x[i]) * (1.0 + x[i]))
                sine_squared[i] = (ratio * s[i]) ** 2
                w[i] = -span * weight[i]
    else:
        pole_t = _pole_of(place)
        for i in range(n):
            t = pole_t - (begin + span * fraction[i])
            up = _exponential(t)
            down = 1.0 / up
            sinh, cosh = 0.5 * (up - down), 0.5 * (up + down)
            if beside:
                x[i] = delta * cosh
                cos_alpha = min(ratio * delta * abs(sinh), 1.0)
                sine_squared[i] = (1.0 - cos_alpha) * (1.0 + cos_alpha)
                s[i] = math.sqrt(sine_squared[i]) / ratio
                w[i] = span * weight[i] * delta * abs(sinh)
            else:
                x[i] = min(max(delta * sinh, -1.0), 1.0)
                s[i] = math.sqrt((1.0 - x[i]) * (1.0 + x[i]))
                sine_squared[i] = (ratio * s[i]) ** 2
                w[i] = span * weight[i] * delta * cosh
    nearest, per_q = rays[_NEAREST], rays[_PER_Q]
    # 1 - cos(theta) = nearest + per_q q, in units of sin^2(theta_m/2); nearest from the sine of
    # the angle to the axis, as the cosine loses the digits of a narrow cone
    scale = 1.0 / math.sin(0.5 * rule.half_angle) ** 2
    for i in range(n):
        sine = s[i] * pole * cos_tilt - x[i] * sin_tilt
        nearest[i] = scale * sine * sine / (1.0 + x[i] * pole * cos_tilt + s[i] * sin_tilt)
        per_q[i] = 2.0 * scale * sin_tilt * s[i]
    cut = rules[k, KIND] == ARCS
    if cut:
        for i in range(n):
            # a ring as narrow as a point, far away: its arc is empty or full, never 0/0
            part = (2.0 - nearest[i]) / max(per_q[i], _NO_WIDTH)
            share[i] = _arcsine_of_root(min(max(part, 0.0), 1.0))
            w[i] *= 4.0 * share[i]
        _arc_nodes(rule.azimuth[m], m, n, rays)
    else:
        _circle_nodes(rule.azimuth[m], m, n, rays)
    count = n * (m if cut else m + 1)
    _times_radiance(series, rays[_Y], rays[WEIGHT], rays, count)
    return count


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _arc_nodes(azimuth, m, n, rays):  # type: ignore[no-untyped-def]
    """q, weight, and argument of the light's series at all nodes of arcs."""
    q, y, weight, w = rays[_Q], rays[_Y], rays[WEIGHT], rays[_W]
    nearest, per_q, share = rays[_NEAREST], rays[_PER_Q], rays[_SHARE]
    for j in range(m):
        at, place = j * n, azimuth[0, j]
        for i in range(n):
            q[at + i] = place * share[i]
    for i in range(m * n):  # one long loop, as the remainder beside vectors is slow
        sine = _sine(q[i])
        q[i] = sine * sine
    for j in range(m):
        at, part = j * n, azimuth[1, j]
        for i in range(n):
            y[at + i] = 1.0 - (nearest[i] + per_q[i] * q[at + i])
            weight[at + i] = part * w[i]


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _circle_nodes(azimuth, m, n, rays):  # type: ignore[no-untyped-def]
    """The same for whole rings."""
    q, y, weight, w = rays[_Q], rays[_Y], rays[WEIGHT], rays[_W]
    nearest, per_q = rays[_NEAREST], rays[_PER_Q]
    for j in range(m + 1):
        at = j * n
        here, part = 0.5 * (1.0 - azimuth[_CIRCLE, j]), 2.0 * azimuth[_CIRCLE + 2, j]
        for i in range(n):
            q[at + i] = here
            y[at + i] = 1.0 - (nearest[i] + per_q[i] * here)
            weight[at + i] = part * w[i]


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _gathered(place, rules, k, gradient, rays):  # type: ignore[no-untyped-def]
    """Two or three rays for each ring with the same force as all of it; returns their number.

    All rays of a ring have the same efficiencies, so their force is linear in u and its gradient
    quadratic, and u is linear in q. So the rays with q = 0 and q = 1, for the gradient also
    q = 1/2, replace the ring if their weights have the same sums of 1, q (and q^2).
    """
    n, m = LEVELS[int(rules[k, LEVEL])], int(rules[k, AZIMUTHS])
    azimuths = m if rules[k, KIND] == ARCS else m + 1
    weight, q, around = rays[WEIGHT], rays[_Q], rays[_AROUND]
    one, first, second = rays[_W], rays[_SHARE], rays[_NEAREST]
    for i in range(n):
        one[i] = first[i] = second[i] = 0.0
    for j in range(azimuths):
        total = 0.0
        for i in range(n):
            at_q = q[j * n + i]
            here = weight[j * n + i]
            times_q = here * at_q
            one[i] += here
            first[i] += times_q
            second[i] += times_q * at_q
            total += here + times_q
        around[j] = total
    for i in range(n):
        far = first[i]
        weight[i] = one[i] - far
        weight[n + i] = far
    if gradient:
        for i in range(n):
            middle = 4.0 * (first[i] - second[i])
            weight[i] -= 0.5 * middle
            weight[n + i] -= 0.5 * middle
            weight[2 * n + i] = middle
    _aim(place, rules[k, _POLE], 0, n, 1.0, 0.0, rays)
    _aim(place, rules[k, _POLE], n, n, -1.0, 0.0, rays)
    if not gradient:
        return 2 * n
    _aim(place, rules[k, _POLE], 2 * n, n, 0.0, 1.0, rays)
    return 3 * n


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _aim(place, pole, at, n, cosine, sine, rays):  # type: ignore[no-untyped-def]
    """Directions of the n rays from number `at` on, at one azimuth about the pole."""
    u1, u2, u3, x, s = rays[U1], rays[U2], rays[U3], rays[_X], rays[_S]
    cos_tilt, sin_tilt = place.cos_tilt, place.sin_tilt
    for i in range(n):
        axial, towards = pole * x[i], s[i] * cosine
        u1[at + i] = sin_tilt * axial - cos_tilt * towards
        u2[at + i] = s[i] * sine
        u3[at + i] = cos_tilt * axial + sin_tilt * towards


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _spread_out(place, rules, k, rays):  # type: ignore[no-untyped-def]
    """A ray for each node of rings or arcs."""
    n, m = LEVELS[int(rules[k, LEVEL])], int(rules[k, AZIMUTHS])
    along = rules[k, _POLE]
    x, s, q = rays[_X], rays[_S], rays[_Q]
    for j in range(m if rules[k, KIND] == ARCS else m + 1):
        for i in range(n):
            at = j * n + i
            axial, towards = along * x[i], s[i] * (1.0 - 2.0 * q[at])
            rays[U1, at] = place.sin_tilt * axial - place.cos_tilt * towards
            rays[U2, at] = 2.0 * s[i] * math.sqrt(q[at] * (1.0 - q[at]))
            rays[U3, at] = place.cos_tilt * axial + place.sin_tilt * towards


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _exponential(t):  # type: ignore[no-untyped-def]
    """exp for |t| up to 3.1 to rounding, by the Taylor series of exp(t/8), which vectorises."""
    y = 0.125 * t
    value = 0.0
    for coefficient in _EXP:
        value = value * y + coefficient
    value *= value
    value *= value
    return value * value


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _arcsine_of_root(q):  # type: ignore[no-untyped-def]
    """arcsin(sqrt(q)) on [0, 1] to rounding; it vectorises."""
    small = min(q, 1.0 - q)
    # two halves: a longer loop is not unrolled, and the loop around it then not vectorised
    high = low = 0.0
    for coefficient in _ARCSINE_HIGH:
        high = high * small + coefficient
    for coefficient in _ARCSINE_LOW:
        low = low * small + coefficient
    angle = math.sqrt(small) * (high * small ** len(_ARCSINE_LOW) + low)
    return angle if q <= 0.5 else 0.5 * math.pi - angle


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _sine(angle):  # type: ignore[no-untyped-def]
    """sin on [0, pi/2] to rounding, by its Taylor series, which vectorises."""
    y = angle * angle
    value = 0.0
    for coefficient in _SINE:
        value = value * y + coefficient
    return angle * value


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _times_radiance(series, y, weight, rays, count):  # type: ignore[no-untyped-def]
    """Multiply the weights by the light's power per solid angle: Horner's or Clenshaw's sum."""
    if series.size == SHORT:
        # its length is known to the compiler: all in registers
        for i in range(count):
            at_y = y[i]
            value = 0.0
            for k in range(SHORT):
                value = value * at_y + series[k]
            weight[i] *= value
        return
    value_of, last_of = rays[_WORK_1], rays[_WORK_2]
    for i in range(count):
        value_of[i] = 0.0
        last_of[i] = 0.0
    for k in range(series.size - 1, 0, -1):
        coefficient = series[k]
        for i in range(count):
            here = 2.0 * y[i] * value_of[i] - last_of[i] + coefficient
            last_of[i] = value_of[i]
            value_of[i] = here
    for i in range(count):
        weight[i] *= y[i] * value_of[i] - last_of[i] + series[0]


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def tails(rule, rules, k, rays, size, linear, gradient):  # type: ignore[no-untyped-def]
    """Largest of the last coefficients of the forces of rule k along x and in the azimuth, N.

    size: of the forces, N. For rings gathered into a few rays, those in the azimuth are the
    relative coefficients of the light times the size of the forces.
    """
    level, m = int(rules[k, LEVEL]), int(rules[k, AZIMUTHS])
    n = LEVELS[level]
    cut = rules[k, KIND] == ARCS
    azimuths = m if cut else m + 1
    gathered = rules[k, KIND] != DISC and not linear
    of_node, of_azimuth, force = rays[_X], rays[_AROUND], rays[FORCE]
    for i in range(n):
        of_node[i] = 0.0
    in_azimuth = azimuths
    if gathered:
        in_azimuth = 3 if gradient else 2
    for j in range(in_azimuth):
        at = j * n
        total = 0.0
        for i in range(n):
            of_ray = force[at + i]
            if linear:
                of_ray += force[azimuths * n + at + i]
            of_node[i] += of_ray
            total += of_ray
        if not gathered:
            of_azimuth[j] = total
    tail = rule.tail[level]
    last = rule.azimuth[m, 2:] if cut else rule.azimuth[m, _CIRCLE + 3 :]
    along = around = 0.0
    for c in range(TAIL):
        coefficient = 0.0
        for i in range(n):
            coefficient += tail[c, i] * of_node[i]
        along = max(along, _NEAR[c] * abs(coefficient))
        coefficient = 0.0
        for j in range(azimuths):
            coefficient += last[c, j] * of_azimuth[j]
        around = max(around, _NEAR[c] * abs(coefficient))
    if gathered:
        light = 0.0
        for j in range(azimuths):
            light += abs(of_azimuth[j])
        around *= size / light
    return along, around


@cached_njit(error_model="numpy", nogil=True)
def unknown_light(place, rule, full):  # type: ignore[no-untyped-def]
    """Bound on the force of the light that a series omits, N: |Q| <= 2 for every ray that hits."""
    hit = 4.0 * math.pi * math.sin(0.5 * rule.half_angle) ** 2
    if place.ratio > 1.0:  # on both sides of the focus
        hit = min(hit, 8.0 * math.pi * math.sin(0.5 * math.asin(1.0 / place.ratio)) ** 2)
    return 2.0 * (rule.rounding if full else rule.left_out) * hit
