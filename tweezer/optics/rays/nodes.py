"""Rays of a rule with their weights, and the last coefficients of the force that they sum.

The method is described in `tweezer.optics.rays.panels`. A ring is all rays at one angle g to a
pole, the line from the focus to the bead or its continuation; its node is x = cos(g). The azimuth
about that line is counted from the side of the beam's axis. q = sin^2(half the azimuth) runs from 0
to 1.

The functions share their arguments. `place`, a `panels.Place`, is the position of the bead. `rule`,
a `rule.Rule`, contains the tables of nodes and the light. The array `rules` (rules, columns) of
this position has the columns named in `panels`, and `k` is the number of one rule. `rays` is the
workspace of `scratch`, whose rows are named below.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from tweezer.compiled import cached_njit
from tweezer.compiled.lanes import LANES, lanes, spread, store
from tweezer.optics.rays.panels import (
    ARCS,
    AZIMUTHS,
    BEGIN,
    DISC,
    KIND,
    LEVEL,
    PAIR,
    POLE,
    SPAN,
    pole_of,
)
from tweezer.optics.rays.rule import CIRCLE, LEVELS, MOST_RAYS, SHORT, TAIL

#: Weights of the last coefficients in the tail: the earlier ones matter only if the last two are
#: small by chance
_NEAR = (1.0, 1.0, 0.05, 0.05)
#: Lower bound on the width of a ring in cos(theta), in units of sin^2(theta_m/2), theta_m the half
#: angle of the cone
_NO_WIDTH = 1e-300
#: Taylor coefficients of sin(x)/x in x^2, highest first
_SINE = tuple((-1.0) ** k / math.factorial(2 * k + 1) for k in reversed(range(11)))
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

# rows of the workspace with one number for each ray: direction, weight (its n_m P/c, N), size of
# its force (N), efficiencies and their derivatives, sin^2 of incidence
U1, U2, U3, WEIGHT, FORCE, Q_OF, DQ_OF, G_OF, DG_OF, S_OF = range(10)
# rows for each ring or node. A ring has cos(g), sin(g), its weight and half the azimuth at which an
# arc ends; also 1 - cos(theta) at q = 0 and its change with q, in sin^2(theta_m/2). A node has q
# and the argument of the light's series. Two rows are workspace, one the sums over x per azimuth
_X, _S, _W, _SHARE, _NEAREST, _PER_Q, _Q, _Y, _WORK_1, _WORK_2, _AROUND = range(10, 21)
# integrals of the light over each ring, times 1, q and q^2
_ONE, _FIRST, _SECOND = range(21, 24)
_ROWS = 24
#: Padding of rows. Rows a power of two apart would compete for the same lines of the cache
_APART_IN_CACHE = 72


@cached_njit()
def scratch():  # type: ignore[no-untyped-def]
    """Return the workspace for the largest rule: an array with a row for each quantity of a ray.

    The numbers of the rows are constants of this module, such as WEIGHT.
    """
    return np.empty((_ROWS, 2 * MOST_RAYS + _APART_IN_CACHE))


@cached_njit(error_model="numpy", nogil=True, inner=True)
def rays_of(place, rule, rules, k, full, rays, gradient):  # type: ignore[no-untyped-def]
    """Fill `rays` with the rays of rule k, in the frame with the bead at (lateral, 0, axial).

    By symmetry only those with u2 >= 0 are needed, with twice the weight. A ring is replaced by two
    rays, or three for gradients (`_gathered`). `full` selects the full series of the light, for
    positions with little light. `gradient` states whether gradients are summed. `place` is the
    bead's position as seen from the focus, and `rule` the tables of nodes and the light. `rules[k]`
    has kind and size of the rule. `rays` has a row for each quantity of a ray. Returns the number
    of rays.
    """
    if rules[k, KIND] == DISC:
        return _disc_rays(rule, rules, k, rays)
    _rings(place, rule, rules, k, rays)
    series = rule.full if full else rule.series
    return _gathered(place, rule, rules, k, series, gradient, rays)


@cached_njit(error_model="numpy", nogil=True, inner=True)
def rays_of_linear(place, rule, rules, k, full, rays, gradient):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Fill `rays` with the rays of rule k for linearly polarised light; returns their number.

    There is one at every azimuth of every ring, on both sides of the plane u2 = 0: the force of a
    ray depends on its azimuth here. `rays_of` describes the arguments.
    """
    if rules[k, KIND] == DISC:
        count = _disc_rays(rule, rules, k, rays)
    else:
        _rings(place, rule, rules, k, rays)
        count = _ring_nodes(rule, rules, k, rule.full if full else rule.series, rays)
        _spread_out(place, rules, k, rays)
    for i in range(count):
        rays[WEIGHT, i] *= 0.5
        rays[U1, count + i] = rays[U1, i]
        rays[U2, count + i] = -rays[U2, i]
        rays[U3, count + i] = rays[U3, i]
        rays[WEIGHT, count + i] = rays[WEIGHT, i]
    return 2 * count


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _disc_rays(rule, rules, k, rays):  # type: ignore[no-untyped-def]
    """Fill `rays` with the rays of a disc: nodes in cos(theta) times azimuths about the axis.

    They are on one side of the plane u2 = 0, with twice the weight. `rule` contains the tables of
    nodes and the light, and `rules[k]` the numbers of nodes. `rays` has a row for each quantity of
    a ray. Returns the number of rays.
    """
    level, m = int(rules[k, LEVEL]), int(rules[k, AZIMUTHS])
    n = LEVELS[level]
    u1, u2, u3, weight, x, s = rays[U1], rays[U2], rays[U3], rays[WEIGHT], rays[_X], rays[_S]
    rest, radiance = rule.nodes[level, 0, 1], rule.radiance[level]
    circle = rule.azimuth[m, CIRCLE:]
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


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _rings(place, rule, rules, k, rays):  # type: ignore[no-untyped-def]
    """Fill rows of `rays` with the rings of rule k, one number for each ring.

    A ring is all rays at one angle g to the pole, the line from the focus to the bead or its
    continuation. The rows are cos(g), sin(g), sin^2 of incidence and the weight of the integral
    over cos(g). Two rows give 1 - cos(theta), theta the angle to the beam's axis, as a linear
    function of q = sin^2(half the azimuth about the pole). For arcs a row contains their ends.
    `place` is the bead's position as seen from the focus, `rule` contains the tables of nodes, and
    `rules[k]` the panel of the rule and its pole. Rows are filled up to a multiple of `LANES`, with
    rings without weight.
    """
    level, pair = int(rules[k, LEVEL]), int(rules[k, PAIR])
    pole, begin, span = rules[k, POLE], rules[k, BEGIN], rules[k, SPAN]
    n = (LEVELS[level] + LANES - 1) // LANES * LANES
    ratio, delta, beside = place.ratio, place.delta, place.beside
    cos_tilt, sin_tilt = place.cos_tilt, place.sin_tilt
    x, s, w, share, sine_squared = rays[_X], rays[_S], rays[_W], rays[_SHARE], rays[S_OF]
    nodes = rule.nodes[level, pair]
    fraction, rest, weight = nodes[0], nodes[1], nodes[2]
    if place.crowded:  # nodes even in cos(alpha) or x, else in t, see `panels`
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
        pole_t = pole_of(place)
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
    if rules[k, KIND] == ARCS:
        for i in range(n):
            # a ring as narrow as a point, far away: its arc is empty or full, never 0/0
            part = (2.0 - nearest[i]) / max(per_q[i], _NO_WIDTH)
            share[i] = _arcsine_of_root(min(max(part, 0.0), 1.0))
            w[i] *= 4.0 * share[i]


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _ring_nodes(rule, rules, k, series, rays):  # type: ignore[no-untyped-def]
    """Fill rows of `rays` with q and weight of all nodes of rings or arcs; returns their number.

    q is sin^2(half the azimuth about the line to the bead), counted from the side of the beam's
    axis. The weight includes the light there. `rule` contains the tables of nodes and `rules[k]`
    their numbers. The light is `series`, `Rule.series` or `Rule.full`. `rays` contains the rings.
    """
    n, m = LEVELS[int(rules[k, LEVEL])], int(rules[k, AZIMUTHS])
    if rules[k, KIND] == ARCS:
        count = n * m
        _arc_nodes(rule.azimuth[m], m, n, rays)
    else:
        count = n * (m + 1)
        _circle_nodes(rule.azimuth[m], m, n, rays)
    _times_radiance(series, rays[_Y], rays[WEIGHT], rays, count)
    return count


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract"}, inner=True)
def _moments(azimuth, cut, m, n, series, rays):  # type: ignore[no-untyped-def]
    """Fill rows of `rays` with integrals over each ring of the light times 1, q and q^2.

    q is sin^2(half the azimuth about the line to the bead), from the side of the beam's axis.
    `azimuth` is the entry of `Rule.azimuth` for m azimuths. If `cut`, the n rings are arcs that end
    at the rim of the cone. The light is `series`. The ring's weight is included.
    """
    nearest, per_q, share, w = rays[_NEAREST], rays[_PER_Q], rays[_SHARE], rays[_W]
    one_of, first_of, second_of = rays[_ONE], rays[_FIRST], rays[_SECOND]
    horner = series.size == SHORT
    top = 0  # first power that is not zero: the series is padded with zeros before it
    while horner and top < SHORT - 1 and series[top] == 0.0:
        top += 1
    for i in range(0, n, LANES):
        highest = 1.0 - lanes(nearest, i)
        width, part = lanes(per_q, i), lanes(share, i)
        one = first = second = spread(0.0)
        for j in range(0, m if cut else m + 1, 2):  # two at a time, as each waits for its own sums
            if cut:
                q_a, q_b = (
                    _sine_squared(azimuth[0, j] * part),
                    _sine_squared(azimuth[0, j + 1] * part),
                )
                share_a, share_b = azimuth[1, j], azimuth[1, j + 1]
            else:
                q_a = spread(0.5 * (1.0 - azimuth[CIRCLE, j]))
                q_b = spread(0.5 * (1.0 - azimuth[CIRCLE, j + 1]))
                share_a, share_b = 2.0 * azimuth[CIRCLE + 2, j], 2.0 * azimuth[CIRCLE + 2, j + 1]
            y_a, y_b = highest - width * q_a, highest - width * q_b
            a = b = spread(series[top])
            if horner:
                for c in range(top + 1, SHORT):
                    a, b = a * y_a + series[c], b * y_b + series[c]
            else:
                a, b = _chebyshev(series, y_a), _chebyshev(series, y_b)
            a, b = a * share_a, b * share_b
            one = one + (a + b)
            a, b = a * q_a, b * q_b
            first = first + (a + b)
            second = second + (a * q_a + b * q_b)
        weight = lanes(w, i)
        store(one_of, i, weight * one)
        store(first_of, i, weight * first)
        store(second_of, i, weight * second)


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract"}, inner=True)
def _sine_squared(angle):  # type: ignore[no-untyped-def]
    """Return sin^2 of eight angles in [0, pi/2], rad, to rounding, by the Taylor series of sin."""
    y = angle * angle
    value = spread(_SINE[0])
    for k in range(1, len(_SINE)):
        value = value * y + _SINE[k]
    return y * value * value


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract"}, inner=True)
def _chebyshev(series, y):  # type: ignore[no-untyped-def]
    """Return a Chebyshev series at eight numbers y in [-1, 1], by Clenshaw's recurrence."""
    value = last = spread(0.0)
    twice = y + y
    for k in range(series.size - 1, 0, -1):
        value, last = twice * value - last + series[k], value
    return y * value - last + series[0]


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _arc_nodes(azimuth, m, n, rays):  # type: ignore[no-untyped-def]
    """Fill rows of `rays` with q, weight and argument of the light's series at all nodes of arcs.

    q is sin^2(half the azimuth about the line to the bead). The argument is 1 at the beam's axis
    and -1 at the rim of the cone. `azimuth` is the entry of `Rule.azimuth` for m azimuths. Each of
    the n rings has m nodes. The weight does not include the power of the light.
    """
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


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _circle_nodes(azimuth, m, n, rays):  # type: ignore[no-untyped-def]
    """Fill rows of `rays` with q, weight and argument of the light's series for whole rings.

    q is sin^2(half the azimuth about the line to the bead). The argument is 1 at the beam's axis
    and -1 at the rim of the cone. `azimuth` is the entry of `Rule.azimuth` for m azimuths. Each of
    the n rings has m + 1 nodes from q = 0 to 1. The weight does not include the power of the light.
    """
    q, y, weight, w = rays[_Q], rays[_Y], rays[WEIGHT], rays[_W]
    nearest, per_q = rays[_NEAREST], rays[_PER_Q]
    for j in range(m + 1):
        at = j * n
        here, part = 0.5 * (1.0 - azimuth[CIRCLE, j]), 2.0 * azimuth[CIRCLE + 2, j]
        for i in range(n):
            q[at + i] = here
            y[at + i] = 1.0 - (nearest[i] + per_q[i] * here)
            weight[at + i] = part * w[i]


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _gathered(place, rule, rules, k, series, gradient, rays):  # type: ignore[no-untyped-def]
    """Fill `rays` with two or three rays for each ring that exert the force of the whole ring.

    q is sin^2(half the azimuth about the line to the bead). All rays of a ring have the same
    efficiencies, so their force is linear in u and its gradient quadratic, and u is linear in q.
    The rays with q = 0 and q = 1, for the gradient also q = 1/2, thus replace the ring if their
    weights have the same sums of 1, q (and q^2). `place` is the bead's position, `rules[k]` has the
    numbers of nodes, and `series` is the light. With `gradient` gradients are summed. Returns the
    number of rays.
    """
    n, m = LEVELS[int(rules[k, LEVEL])], int(rules[k, AZIMUTHS])
    _moments(rule.azimuth[m], rules[k, KIND] == ARCS, m, n, series, rays)
    weight, one, first, second = rays[WEIGHT], rays[_ONE], rays[_FIRST], rays[_SECOND]
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
    _aim(place, rules[k, POLE], 0, n, 1.0, 0.0, rays)
    _aim(place, rules[k, POLE], n, n, -1.0, 0.0, rays)
    if not gradient:
        return 2 * n
    _aim(place, rules[k, POLE], 2 * n, n, 0.0, 1.0, rays)
    return 3 * n


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _aim(place, pole, at, n, cosine, sine, rays):  # type: ignore[no-untyped-def]
    """Fill in the directions of n rays, one on each ring, at one azimuth about the pole.

    `pole` is 1 for the line from the focus to the bead, -1 for its continuation. `at` is the number
    of the first ray. The azimuth has this `cosine` and `sine`.
    """
    u1, u2, u3, x, s = rays[U1], rays[U2], rays[U3], rays[_X], rays[_S]
    cos_tilt, sin_tilt = place.cos_tilt, place.sin_tilt
    for i in range(n):
        axial, towards = pole * x[i], s[i] * cosine
        u1[at + i] = sin_tilt * axial - cos_tilt * towards
        u2[at + i] = s[i] * sine
        u3[at + i] = cos_tilt * axial + sin_tilt * towards


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _spread_out(place, rules, k, rays):  # type: ignore[no-untyped-def]
    """Fill in the direction u of one ray for each node of rings or arcs, on the side u2 >= 0.

    `place` is the bead's position. `rules[k]` has the numbers of nodes and the pole of the rings.
    `rays` contains cosine and sine of the angle to the pole for each ring, and q for each node.
    """
    n, m = LEVELS[int(rules[k, LEVEL])], int(rules[k, AZIMUTHS])
    along = rules[k, POLE]
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
    """Return exp(t) for |t| up to 3.1 to rounding, by the Taylor series of exp(t/8).

    Unlike `math.exp`, loops over it are vectorised.
    """
    y = 0.125 * t
    value = 0.0
    for coefficient in _EXP:
        value = value * y + coefficient
    value *= value  # exp(t/8) to the 8th power: three squares
    value *= value
    return value * value


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _arcsine_of_root(q):  # type: ignore[no-untyped-def]
    """Return arcsin(sqrt(q)) for q in [0, 1] to rounding, in rad; loops over it are vectorised."""
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
    """Return sin of an angle in [0, pi/2], rad, to rounding; loops over it are vectorised."""
    y = angle * angle
    value = 0.0
    for coefficient in _SINE:
        value = value * y + coefficient
    return angle * value


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def _times_radiance(series, y, weight, rays, count):  # type: ignore[no-untyped-def]
    """Multiply the first `count` weights by n_m/c times the light's power per solid angle, N/sr.

    The light is `series` (`Rule.series`). If it has SHORT entries they are powers, summed by
    Horner's rule, and otherwise Chebyshev coefficients, summed by Clenshaw's. `y` (count,) is its
    argument at each node.
    """
    if series.size == SHORT:
        # the compiler knows its length and keeps it in registers
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


@cached_njit(
    error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"}, inner=True
)
def tails(rule, rules, k, rays, linear, gradient):  # type: ignore[no-untyped-def]
    """Return the largest of the last coefficients of rule k, along its nodes and in azimuth, N.

    The force of its rays is in the row FORCE of the workspace `rays`. It is expanded in Legendre
    polynomials of the cosine x of the angle to the pole. In the azimuth it is expanded in Legendre
    polynomials or in cosines. Small last coefficients show that the nodes suffice. `linear` states
    whether the light is linearly polarised, `gradient` whether gradients are summed. For rings
    gathered into a few rays the second result is 0.
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
        of_azimuth[j] = total
    tail = rule.tail[level]
    along = around = 0.0
    for c in range(TAIL):
        coefficient = 0.0
        for i in range(n):
            coefficient += tail[c, i] * of_node[i]
        along = max(along, _NEAR[c] * abs(coefficient))
    if gathered:
        return along, around
    last = rule.azimuth[m, 2:] if cut else rule.azimuth[m, CIRCLE + 3 :]
    for c in range(TAIL):
        coefficient = 0.0
        for j in range(azimuths):
            coefficient += last[c, j] * of_azimuth[j]
        around = max(around, _NEAR[c] * abs(coefficient))
    return along, around
