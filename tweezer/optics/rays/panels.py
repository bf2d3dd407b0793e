"""Rays of a product rule that integrates over the cone of light with spectral convergence.

The sum over rays (3.26) becomes an integral over directions u. A rule is a set of directions with
weights, summed by the same code as the thesis's grid (`tweezer.optics.rays.ray_sum`). There are two
kinds of rules. Each has n nodes in the cosine x of the angle to a pole and m in the azimuth about
it:

* The disc, about the beam's axis, is Gauss-Legendre in x = cos(theta) and trapezoidal in the
  azimuth. It serves beads that every ray hits well inside the edge. The integrand is then singular
  only at complex directions, where cos(alpha) = 0. Their distance from the real ones gives the rate
  of convergence, and so n and m, in advance.
* Rings are about the line from the focus to the bead. All rays at an angle g to that line meet the
  bead at the same angle of incidence alpha, with

      cos(alpha) = (d/r) sqrt(x^2 +- delta^2),  delta^2 = |1 - (r/d)^2|.

  The sign is + if the focus is inside the bead (d < r) and - if it is outside. The interval of
  x = cos(g) is cut into panels where the integrand is not smooth. This is where rays graze the
  bead, where the rim of the cone begins or ceases to cut the ring (two values of g), and where
  total reflection begins. The cosine cos(alpha) is smooth in t with x = delta sinh(t) or delta
  cosh(t); for small delta nodes are concentrated near cos(alpha) = 0 instead. A substitution with a
  double zero removes the square roots at the rim. The zero is triple if another singularity is
  close beyond it. At grazing incidence the efficiencies vanish, so the derivative over the position
  has no boundary term and needs no other rays.

The error is estimated from the last coefficients of the expansions in x (Legendre) and the azimuth
(Legendre or Fourier). On rings of light that is not linear the azimuth needs no such estimate. The
efficiencies are constant there, and the series of the light shows which part of it the nodes do not
resolve. A rule that misses its part of the tolerance is repeated with more nodes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.optics.rays.rule import AZIMUTHS_TRIED, LEVELS, MOST_AZIMUTHS, MOST_RAYS, WIDTHS

#: Largest number of panels for a position
MOST_PANELS = 192
#: Largest number of rays in a disc; beyond it rings cost less
LARGEST_DISC = 800
#: Estimated relative error of rings and of arcs: factor * tail^power, with tail the largest of the
#: last coefficients. (Gauss's and the trapezoidal rule err by coefficients of about twice the last
#: order that they resolve.) Fitted to tighter rules; (along x, azimuth) of (factor, power)
ERROR_OF_RINGS = ((2.5, 1.75), (10.0, 2.0))
ERROR_OF_ARCS = ((6.0, 1.6), (1.5, 1.75))
#: Nodes per decimal digit; one more if the panel starts at a double zero
_NODES_PER_DIGIT = 2.6
#: delta below which nodes are concentrated near cos(alpha) = 0
_SMALL_DELTA = 0.1
#: delta below which the focus counts as on the surface of the bead
_NO_DELTA = 1e-7
#: A singularity nearer to a panel's end than this fraction of its length is "close"
_CLOSE = 0.15
#: Smallest distance of singular angles that do not affect each other, rad
_APART = 0.2
#: Share of the tolerance for the azimuth
_AZIMUTH = 0.1
#: Angles closer than this are merged, rad: the error is of order gap^(3/2)
_NO_GAP = 1e-8
#: 1/n_mP^2 - 1 below which the index of the bead counts as close to that of the medium
_NEARLY_EQUAL = 0.05

# columns of the table of the rules of a position
KIND, LEVEL, AZIMUTHS, POLE, BEGIN, SPAN, PAIR, WIDTH, MISSED = range(9)
COLUMNS = 9
RATE_X, RATE_AZIMUTH = BEGIN, SPAN
# kinds of rules
DISC, RINGS, ARCS = 0, 1, 2


class Place(NamedTuple):
    """Position of the bead, seen from the focus."""

    ratio: float
    """d/r, the distance of the bead's centre from the focus over the bead's radius"""
    cos_tilt: float
    """cosine of gamma, the angle between the beam's axis and the line to the bead"""
    sin_tilt: float
    """sine of gamma"""
    delta: float
    """sqrt(|1 - (r/d)^2|), which vanishes for a focus on the surface of the bead"""
    beside: bool
    """whether the focus is outside the bead, d > r"""
    crowded: bool
    """whether the focus is so close to the surface that nodes are concentrated there"""


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


@cached_njit(error_model="numpy", nogil=True, inner=True)
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


@cached_njit(error_model="numpy", nogil=True, inner=True)
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
    nodes = math.ceil(0.9 * decay / rate_x) + int(rule.degree) // 4
    # exact for a product with the light's highest harmonic, as the light may not be smooth
    nodes = max(nodes, int(rule.degree) // 2 + 4)
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
    of_light = (digits - 1.0) * math.log(10.0) / max(rule.degree, 1.0)
    rules[0, RATE_X] = min(rate_x, of_light)
    rules[0, RATE_AZIMUTH] = min(rate_azimuth, of_light)
    return True


@cached_njit(error_model="numpy", nogil=True)
def pole_of(place):  # type: ignore[no-untyped-def]
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


@cached_njit(error_model="numpy", nogil=True, inner=True)
def _panels(place, rule, n_mP, digits, rules):  # type: ignore[no-untyped-def]
    """The panels of rings and arcs; returns their number."""
    cuts = np.empty(MOST_PANELS // 2)
    singular = _singular(place, n_mP)
    top = singular.top
    count = 0
    both = place.beside or top < 2.0
    for side in range(2):
        if not both and (side == 1) == (place.cos_tilt >= 0.0):
            continue  # all rings in one interval, about the pole nearer to the light
        rims = _rims(place, rule, side)
        places = _cuts(place, singular, rims, cuts)
        for k in range(places - 1):
            lo, hi = cuts[k], cuts[k + 1]
            length = hi - lo
            if length <= 1e-15 * top:
                continue
            middle = lo + 0.5 * length
            cut = rims.first < middle < rims.second
            whole = rims.whole_inside if middle <= rims.first else rims.whole_outside
            if not cut and not whole:
                continue
            low, high = _zeros(place, n_mP, singular, rims, lo, hi, cut)
            begin, end = _interval(place, top, lo, hi)
            rules[count, KIND] = ARCS if cut else RINGS
            rules[count, POLE] = 1.0 if side == 0 else -1.0
            rules[count, PAIR] = (low - 1) * 3 + high - 1
            rules[count, BEGIN] = begin
            rules[count, SPAN] = end - begin
            # a panel with a small solid angle needs fewer digits
            share_of_angle = (math.cos(lo) - math.cos(hi)) / (1.0 - math.cos(top))
            wanted = max(digits + math.log10(min(3.0 * share_of_angle, 1.0)), 1.0)
            slope = singular.per_digit + (1.0 if low == 2 else 0.0)
            rules[count, LEVEL] = _level_of(2.0 + slope * wanted)
            rules[count, WIDTH] = _width(place, rule, lo, hi)
            resolve_azimuth(rule, rules, count, _AZIMUTH * rule.tolerance)
            count += 1
    return count


class Singular(NamedTuple):
    """Where the bead makes the integrand over the rings singular."""

    top: float
    """largest angle of a ring to the line, rad"""
    critical: float
    """angle where total reflection begins, rad; -1 without it"""
    onset: float
    """size of x where total reflection begins, which may be complex"""
    pole: float
    """1/n_mP^2 - 1: Q has a pole at cos(alpha) = i/2 times this, of light that stays inside"""
    per_digit: float
    """nodes per decimal digit on a panel from cos(alpha) = 0 to 1"""


@cached_njit(error_model="numpy", nogil=True, inner=True, forceinline=True)
def _singular(place, n_mP):  # type: ignore[no-untyped-def]
    """The `Singular` of a bead at `place`."""
    top = math.pi
    if place.beside:
        top = math.asin(1.0 / place.ratio)
    elif place.crowded or n_mP > 1.0:
        top = 0.5 * math.pi
    critical, onset = -1.0, 1.0
    if n_mP > 1.0:
        inner = n_mP * place.ratio
        onset = math.sqrt(abs(1.0 - 1.0 / max(inner, 1e-6) ** 2))
        if inner > 1.0:
            critical = math.asin(1.0 / inner)
    # the pole sets the nodes per digit; for a bead of nearly the medium's index panels grow from
    # grazing instead
    pole = 1.0 / n_mP**2 - 1.0
    per_digit = _NODES_PER_DIGIT
    if pole > _NEARLY_EQUAL:
        rate = math.acosh(_ellipse(-1.0, pole))
        per_digit = max(per_digit, math.log(10.0) / (ERROR_OF_RINGS[0][1] * rate))
    return Singular(top, critical, onset, pole, per_digit)


class Rims(NamedTuple):
    """The two angles from a pole at which the rim of the cone begins and ceases to cut rings."""

    first: float
    second: float
    whole_inside: bool
    """whether rings inside the first are whole"""
    whole_outside: bool
    """whether rings outside the second are whole"""


@cached_njit(error_model="numpy", nogil=True, inner=True, forceinline=True)
def _rims(place, rule, side):  # type: ignore[no-untyped-def]
    """The `Rims` seen from the pole at the bead (side 0) or the one opposite (side 1)."""
    tilt = math.atan2(place.sin_tilt, place.cos_tilt)
    tilt_here = tilt if side == 0 else math.pi - tilt
    first = abs(rule.half_angle - tilt_here)
    second = rule.half_angle + tilt_here
    whole_outside = second > math.pi
    if whole_outside:
        second = 2.0 * math.pi - second
    return Rims(first, second, tilt_here < rule.half_angle, whole_outside)


@cached_njit(error_model="numpy", nogil=True, inner=True, forceinline=True)
def _cuts(place, singular, rims, cuts):  # type: ignore[no-untyped-def]
    """Fill the angles between which panels lie, rad, in order; returns their number."""
    top, critical = singular.top, singular.critical
    first, second = rims.first, rims.second
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
    cosine = singular.pole if singular.pole <= _NEARLY_EQUAL else 1.0
    while 0.0 < cosine < 0.7 and places < cuts.size:
        sine = math.sqrt((1.0 - cosine) * (1.0 + cosine)) / max(place.ratio, 1e-3)
        if sine < 1.0:
            cuts[places] = min(math.asin(sine), top)
            places += 1
        cosine = 3.0 * cosine
    if singular.onset < 0.5:
        # panels that grow with the distance from the onset
        x = singular.onset
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
    return _without_close(cuts, places, first, second, critical)


@cached_njit(error_model="numpy", nogil=True, inner=True, forceinline=True)
def _zeros(place, n_mP, singular, rims, lo, hi, cut):  # type: ignore[no-untyped-def]
    """Orders of the zeros of the substitution at both ends of a panel: 1, 2 or 3.

    cut: whether the rim cuts the rings of the panel.
    """
    top, critical = singular.top, singular.critical
    close = _CLOSE * (hi - lo)
    low, high = 1, 1
    if cut:
        if lo == rims.first:
            low = 2
        if hi == rims.second:
            high = 3 if math.pi - hi < close else 2
        elif rims.second - hi < close:
            high = 3
    elif hi == top and 0.0 < rims.first - hi < close:
        high = 2
    if critical > 0.0:
        if lo == critical:
            low = 2
        if hi == critical:
            high = 2
    if hi == top and (place.crowded or (n_mP > 1.0 and not place.beside)):
        high = 3
    return low, high


@cached_njit(error_model="numpy", nogil=True, inner=True, forceinline=True)
def _interval(place, top, lo, hi):  # type: ignore[no-untyped-def]
    """Both ends of a panel in the variable of its nodes: t, or cos(alpha) over d/r."""
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
            b = pole_of(place)
    return a, b


@cached_njit(error_model="numpy", nogil=True, inner=True)
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


@cached_njit(error_model="numpy", nogil=True, inner=True)
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


@cached_njit(error_model="numpy", nogil=True, inner=True)
def _width(place, rule, lo, hi):  # type: ignore[no-untyped-def]
    """Class of the width of the rings from `lo` to `hi`, by the part of the cone that they span."""
    widest = 1.0 if lo < 0.5 * math.pi < hi else max(math.sin(lo), math.sin(hi))
    half = 0.5 * (1.0 - math.cos(rule.half_angle))
    return min(int(widest * place.sin_tilt / half * WIDTHS), WIDTHS - 1)


@cached_njit(error_model="numpy", nogil=True, inner=True)
def resolve_azimuth(rule, rules, k, allowed):  # type: ignore[no-untyped-def]
    """Set the azimuths of rule k, of rings or arcs, to miss less than `allowed`, relative."""
    missed = rule.missed[int(rules[k, KIND]) - 1, int(rules[k, WIDTH])]
    tried = 0
    while tried < len(AZIMUTHS_TRIED) - 1 and missed[tried] > allowed:
        tried += 1
    most = _most_azimuths(int(rules[k, LEVEL]))
    while tried > 0 and AZIMUTHS_TRIED[tried] > most:
        tried -= 1
    rules[k, AZIMUTHS], rules[k, MISSED] = AZIMUTHS_TRIED[tried], missed[tried]


@cached_njit(error_model="numpy", nogil=True, inner=True)
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
        wanted = min(max(azimuths * min(ratio_azimuth, 2.0), azimuths + 2), _most_azimuths(level))
        for tried in AZIMUTHS_TRIED:
            if azimuths < tried <= wanted:
                azimuths = tried
    rules[k, LEVEL] = level
    rules[k, AZIMUTHS] = azimuths
    return level > level_now or azimuths > azimuths_now


@cached_njit(error_model="numpy", nogil=True)
def _most_azimuths(level):  # type: ignore[no-untyped-def]
    return min(MOST_AZIMUTHS, MOST_RAYS // LEVELS[level] - 1)


@cached_njit(error_model="numpy", nogil=True, inner=True)
def unknown_light(place, rule, full):  # type: ignore[no-untyped-def]
    """Bound on the force of the light that a series omits, N: |Q| <= 2 for every ray that hits."""
    hit = 4.0 * math.pi * math.sin(0.5 * rule.half_angle) ** 2
    if place.ratio > 1.0:  # on both sides of the focus
        hit = min(hit, 8.0 * math.pi * math.sin(0.5 * math.asin(1.0 / place.ratio)) ** 2)
    return 2.0 * (rule.rounding if full else rule.left_out) * hit
