"""Force, torque and absorbed power of light on a body, from its T-matrix.

With the amplitudes p of the light in the body's frame, t = (S - 1) p and v = 2p + t,

    F = -(n_m/c) Re<t|s|v>,   M = -(1/omega) Re<t|J|v>,   P_abs = -Re<t|v>,

where s is the direction and J the angular momentum. `derivation.bodies` derives the summands. The
amplitudes p are computed as for a sphere, and `rotated` turns them to the body's frame.

A body shifts the light's amplitudes by i k s_j p for each unit it moves along j, and by i J_j p for
each radian that it turns about j. The 6 x 6 derivative follows from these six changes.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numba import types

from tweezer.compiled import cache_functions, cached_njit, named_njit
from tweezer.compiled.lanes import LANES, alternated, lanes, of_lanes, spread, store, total
from tweezer.forces.data import DATA, Data, integers, matrix, number, vector
from tweezer.forces.force import KERNEL, Kernel
from tweezer.generated import bodies
from tweezer.optics.bodies.rotated import MARGIN, OPTIONS, imaginary_of, length_of, row_of, turn
from tweezer.optics.waves.kernel import (
    BEGIN,
    END,
    HIGHEST,
    LOWEST,
    SHARE,
    Waves,
    Weights,
    elements_about,
    neighbours,
)
from tweezer.optics.waves.partial_waves import (
    HELICITY,
    PADDED,
    PHASE,
    add_part,
    begin,
    bessel_functions,
    plane_waves,
    rule_for,
    source_of,
)

cache_functions(bodies)

# entries of the data. The first two are 4 pi^2 n_m P/c and n_m P/c (N). The next three are the
# relative tolerance, the force error at zero force (N), and the error of S - 1 as an operator
(STRENGTH, OF_ALL, TOLERANCE, FLOOR, UNSURE, STATES, ELEMENTS, DELTA, ALTERNATING, SCATTERING,
 PLACES, DEGREE, SPLIT, SOURCE) = range(14)  # fmt: skip
#: Blocks of eight modes that a body without an axis scatters together
TOGETHER = 4
#: Six components: force or translation, torque or rotation
_SIX = 6
#: Numbers of one bead: force and torque, absorbed power, |p|^2, the 6 x 6 derivative
FOUND, ABSORBED, FELT = 8 + _SIX * _SIX, 6, 7
DERIVATIVE = 8
#: Row of the elements of J_+, as in `harmonics.Elements`
_LIFT = 5


def of_strength(data: Data, ratio: float) -> dict[int, float]:
    """Return the numbers of a force's data that change with the power, times a ratio."""
    entries = (STRENGTH, OF_ALL, FLOOR)
    return {each: ratio * float(data.numbers[data.shapes[each, 0]]) for each in entries}


class Body(NamedTuple):
    """The scattering of a body, S - 1, in the form in which `scatter` reads it."""

    scattering: Any
    """elements by column, with all real parts of a column before its imaginary parts. For a body of
    revolution, see `_scatter_about_axis`; else the columns are modes in the order of `places`"""
    places: Any
    """(modes,) entry of each mode in the real parts of an array of amplitudes; empty for a body of
    revolution"""
    degree: int
    """highest degree of S - 1"""
    split: bool
    """whether a mirror plane across the axis keeps the two classes of waves apart"""


class Room(NamedTuple):
    """Arrays for intermediate results, made once for all bodies of a call."""

    bessel: Any
    norm: Any
    re: Any
    im: Any
    work: Any
    light: Any
    """amplitudes in the laboratory's frame, zero beyond the orders of the light"""
    combined: Any
    """combinations of orders, see `rotated.turn`"""
    p: Any
    """amplitudes p in the body's frame"""
    v: Any
    """v = 2p + t"""
    t: Any
    """t = (S - 1) p"""
    gathered: Any
    """amplitudes of one order, or of all modes"""
    of_p: Any
    """(6, ...) s p and J p; empty where no derivatives are computed"""
    of_t: Any
    """(6, ...) s t and J t"""
    back: Any
    """(S - 1) of a time-reversed field, zero above its degree"""


@named_njit(**OPTIONS)
def body_of(data):  # type: ignore[no-untyped-def]
    """Return the `Body` of a force's data."""
    return Body(
        vector(data, SCATTERING), integers(data, PLACES), int(number(data, DEGREE)),
        number(data, SPLIT) != 0.0,
    )  # fmt: skip


@named_njit(**OPTIONS)
def room_for(source, body, derivative):  # type: ignore[no-untyped-def]
    """Return the `Room` for the largest rule of a `Source`; `derivative`: with derivatives."""
    nodes = int(source.rules[-1, PADDED])
    stride, length = source.highest + 1, length_of(source.highest)
    rows = max(8 * (stride + LANES), 2 * len(body.places))
    six = _SIX if derivative else 0
    return Room(
        np.empty((begin(source.rules[-1, PHASE]) + 3) * nodes), np.empty(nodes), np.empty(nodes),
        np.empty(nodes), np.empty(2 * nodes), np.empty((2, length)),
        np.empty((3, 8 * stride * LANES)), np.zeros((2, length)), np.zeros((2, length)),
        np.zeros((2, length)), np.empty(rows),
        np.zeros((six, 2, length)), np.zeros((six, 2, length)),
        np.zeros((2, length)),
    )  # fmt: skip


@named_njit(**OPTIONS)
def scatter(body, p, highest, gathered, t):  # type: ignore[no-untyped-def]
    """Fill `t` with (S - 1) p; `gathered` is room for amplitudes."""
    if len(body.places) == 0:
        _scatter_about_axis(body, p, highest, gathered, t)
        return
    imaginary, modes = imaginary_of(highest), len(body.places)
    source, out = p.ravel(), t.ravel()
    padded = len(body.scattering) // (2 * modes)
    for i in range(modes):
        gathered[i] = source[body.places[i]]
        gathered[modes + i] = source[body.places[i] + imaginary]
    for first in range(0, padded, TOGETHER * LANES):
        a_re, b_re, c_re, d_re = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        a_im, b_im, c_im, d_im = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        at = first
        for i in range(modes):
            x, y, part = gathered[i], gathered[modes + i], at + padded
            re, im = lanes(body.scattering, at), lanes(body.scattering, part)
            a_re, a_im = a_re + re * x - im * y, a_im + re * y + im * x
            re, im = lanes(body.scattering, at + LANES), lanes(body.scattering, part + LANES)
            b_re, b_im = b_re + re * x - im * y, b_im + re * y + im * x
            re = lanes(body.scattering, at + 2 * LANES)
            im = lanes(body.scattering, part + 2 * LANES)
            c_re, c_im = c_re + re * x - im * y, c_im + re * y + im * x
            re = lanes(body.scattering, at + 3 * LANES)
            im = lanes(body.scattering, part + 3 * LANES)
            d_re, d_im = d_re + re * x - im * y, d_im + re * y + im * x
            at += 2 * padded
        for block, (re, im) in enumerate(((a_re, a_im), (b_re, b_im), (c_re, c_im), (d_re, d_im))):
            lower = first + block * LANES
            for i in range(lower, min(lower + LANES, modes)):
                place, lane = body.places[i], i - lower
                out[place], out[place + imaginary] = of_lanes(re, lane), of_lanes(im, lane)


@named_njit(**OPTIONS)
def _scatter_about_axis(body, p, highest, classes, t):  # type: ignore[no-untyped-def]
    """Fill `t` with (S - 1) p for a body of revolution, order by order.

    The two classes of waves of an order have magnetic waves of every other degree, and electric
    ones between them; the first has a magnetic wave at its lowest degree. S - 1 for the orders m
    and -m is the same if the magnetic amplitudes of -m change their sign.

    The elements are listed by order from the highest, by class of the scattered waves, and by class
    (the same class, then the other one unless `body.split`) and degree of the incident wave.
    `classes` is room for (2 signs of m, 2 classes, 2 parts, degrees).
    """
    degree, stride, imaginary = body.degree, highest + 1, imaginary_of(highest)
    room = stride + LANES
    entry = 0
    # from the highest order: the last block of a row may reach into the row above it
    for m in range(degree, -1, -1):
        lowest = max(m, 1)
        count = degree + 1 - lowest
        padded = -(-count // LANES) * LANES
        many = 2 if m > 0 else 1
        for sign in range(many):
            row = row_of(m if sign == 0 else -m, highest) + lowest
            flip = 1.0 if sign == 0 else -1.0
            for part in range(2):
                to = (4 * sign + part) * room
                for block in range(0, padded, LANES):
                    at = row + part * imaginary + block
                    electric, magnetic = lanes(p[0], at), flip * lanes(p[1], at)
                    store(classes, to + block, alternated(magnetic, electric))
                    store(classes, to + 2 * room + block, alternated(electric, magnetic))
        of_class = count * 2 * padded * (1 if body.split else 2)
        for block in range(0, padded, LANES):
            first = _product(body, classes, room, entry + block, 0, count, padded, many)
            other = _product(body, classes, room, entry + of_class + block, 1, count, padded, many)
            at = row_of(m, highest) + lowest + block
            store(t[0], at, alternated(other[0], first[0]))
            store(t[0], at + imaginary, alternated(other[1], first[1]))
            store(t[1], at, alternated(first[0], other[0]))
            store(t[1], at + imaginary, alternated(first[1], other[1]))
            if many > 1:
                at = row_of(-m, highest) + lowest + block
                store(t[0], at, alternated(other[2], first[2]))
                store(t[0], at + imaginary, alternated(other[3], first[3]))
                store(t[1], at, -alternated(first[2], other[2]))
                store(t[1], at + imaginary, -alternated(first[3], other[3]))
        entry += 2 * of_class


@named_njit(**OPTIONS)
def _product(body, classes, room, at, which, count, padded, many):  # type: ignore[no-untyped-def]
    """Return eight scattered waves of a class, (re, im) for the order m and for -m.

    `at` is the entry of the first element, and `which` the class of the incident waves that come
    first.
    """
    a_re, a_im, b_re, b_im = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    c_re, c_im, d_re, d_im = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for _ in range(1 if body.split else 2):
        x = 2 * which * room
        y = x + 4 * room
        for i in range(count):
            s_re, s_im = lanes(body.scattering, at), lanes(body.scattering, at + padded)
            re, im = classes[x + i], classes[x + room + i]
            a_re, c_re = a_re + s_re * re, c_re + s_im * im
            a_im, c_im = a_im + s_re * im, c_im + s_im * re
            if many > 1:
                re, im = classes[y + i], classes[y + room + i]
                b_re, d_re = b_re + s_re * re, d_re + s_im * im
                b_im, d_im = b_im + s_re * im, d_im + s_im * re
            at += 2 * padded
        which = 1 - which
    return a_re - c_re, a_im + c_im, b_re - d_re, b_im + d_im


@named_njit(**OPTIONS)
def _combine(p, t, degree, highest, v):  # type: ignore[no-untyped-def]
    """Fill `v` with 2p + t up to a degree."""
    imaginary = imaginary_of(highest)
    for component in range(2):
        light, answer, out = p[component], t[component], v[component]
        for m in range(-degree, degree + 1):
            row = row_of(m, highest)
            for block in range(abs(m) // LANES * LANES, degree + 1, LANES):
                for at in (row + block, row + block + imaginary):
                    store(out, at, 2.0 * lanes(light, at) + lanes(answer, at))


@named_njit(**OPTIONS)
def _with_component(  # type: ignore[no-untyped-def]
    sums, light, answer, own, partner, at, stride, imaginary, m, lift_down, lift, about
):
    """Return the sums of `wrench_sums` with what (n, m) of one component adds, eight degrees n."""
    re, im = lanes(answer, at), lanes(answer, at + imaginary)
    n = neighbours(Waves(own, partner, imaginary, 0, 0, 0), at, stride)
    x, y, z = bodies.force_summand(re, im, *n, *about)
    a, b, c, lost = bodies.torque_summand(
        re, im, n[2], n[3], n[8], n[9], n[14], n[15], m, lift_down, lift
    )
    re, im = lanes(light, at), lanes(light, at + imaginary)
    return (
        sums[0] + x, sums[1] + y, sums[2] + z, sums[3] + a, sums[4] + b, sums[5] + c,
        sums[6] + lost, sums[7] + (re * re + im * im),
    )  # fmt: skip


@named_njit(**OPTIONS)
def wrench_sums(p, t, v, table, degree, highest, found):  # type: ignore[no-untyped-def]
    """Add force, torque, absorbed power and |p|^2 to `found`, from p, t and v = 2p + t.

    `table` are the elements of the direction; see `waves.kernel.Weights`.
    """
    stride, imaginary = highest + 1, imaginary_of(highest)
    size = (2 * highest + 1) * stride
    sums = (
        spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0),
        spread(0.0),
    )  # fmt: skip
    for m in range(-degree, degree + 1):
        row, elements = row_of(m, highest), stride + LANES + (m + highest) * stride
        for block in range(abs(m) // LANES * LANES, degree + 1, LANES):
            at, of = row + block, elements + block
            about = elements_about(Weights(table, table, stride, size), of)
            lift_down = lanes(table, _LIFT * size + of - stride)
            lift = lanes(table, _LIFT * size + of)
            sums = _with_component(
                sums, p[0], t[0], v[0], v[1], at, stride, imaginary, float(m), lift_down, lift,
                about,
            )  # fmt: skip
            sums = _with_component(
                sums, p[1], t[1], v[1], v[0], at, stride, imaginary, float(m), lift_down, lift,
                about,
            )  # fmt: skip
    for i, value in enumerate(sums):
        found[i] += total(value)


@named_njit(**OPTIONS)
def _generated(field, table, degree, highest, out):  # type: ignore[no-untyped-def]
    """Fill `out` (6, ...) with s_j and J_j times a field, up to a degree."""
    stride, imaginary = highest + 1, imaginary_of(highest)
    size = (2 * highest + 1) * stride
    for component in range(2):
        own, partner = field[component], field[1 - component]
        for m in range(-degree, degree + 1):
            row, elements = row_of(m, highest), stride + LANES + (m + highest) * stride
            for block in range(abs(m) // LANES * LANES, degree + 1, LANES):
                at, of = row + block, elements + block
                f = bodies.generators(
                    *neighbours(Waves(own, partner, imaginary, 0, 0, 0), at, stride), float(m),
                    lanes(table, _LIFT * size + of - stride), lanes(table, _LIFT * size + of),
                    *elements_about(Weights(table, table, stride, size), of),
                )  # fmt: skip
                for j, (re, im) in enumerate(
                    ((f[0], f[1]), (f[2], f[3]), (f[4], f[5]), (f[6], f[7]), (f[8], f[9]),
                     (f[10], f[11]))
                ):  # fmt: skip
                    store(out[j, component], at, re)
                    store(out[j, component], at + imaginary, im)


@named_njit(**OPTIONS)
def _reversed(m, re, im):  # type: ignore[no-untyped-def]
    """Return amplitudes at (n, m) of a field as those of its time reversal at (n, -m), eight n.

    They are (-1)^(n+m) times the conjugate. By reciprocity (S - 1)^+ is S - 1 between time
    reversals.
    """
    if m % 2 == 0:
        return alternated(re, -re), alternated(-im, im)
    return alternated(-re, re), alternated(im, -im)


@named_njit(**OPTIONS)
def _reversed_sum(one, other, degree, highest, out):  # type: ignore[no-untyped-def]
    """Fill `out` with the time reversal of the sum of two fields up to a degree."""
    imaginary = imaginary_of(highest)
    for component in range(2):
        a, b, reversed_ = one[component], other[component], out[component]
        for m in range(-degree, degree + 1):
            row, to = row_of(m, highest), row_of(-m, highest)
            for block in range(abs(m) // LANES * LANES, degree + 1, LANES):
                at = row + block
                part = at + imaginary
                re, im = _reversed(m, lanes(a, at) + lanes(b, at), lanes(a, part) + lanes(b, part))
                store(reversed_, to + block, re)
                store(reversed_, to + block + imaginary, im)


@named_njit(**OPTIONS)
def _returned(of_t, t, at, opposite, imaginary, m):  # type: ignore[no-untyped-def]
    """Return h = A t + (S - 1)^+ A q at (n, m), eight n, from A t and the reversed second term."""
    re, im = _reversed(m, lanes(t, opposite), lanes(t, opposite + imaginary))
    return lanes(of_t, at) + re, lanes(of_t, at + imaginary) + im


@named_njit(**OPTIONS)
def _added(sums, more):  # type: ignore[no-untyped-def]
    """Return the sums of two tuples of six, one by one."""
    return (
        sums[0] + more[0], sums[1] + more[1], sums[2] + more[2], sums[3] + more[3],
        sums[4] + more[4], sums[5] + more[5],
    )  # fmt: skip


@named_njit(**OPTIONS)
def derivative_sums(body, table, highest, room, found):  # type: ignore[no-untyped-def]
    """Add the derivatives of force and torque over the six motions of the body to `found`.

    They are over k r and over angles, about the body's axes, which turn with it. Two of the six
    components of force and torque are computed together, since the sums wait for memory.
    """
    degree, imaginary = body.degree, imaginary_of(highest)
    _generated(room.p, table, degree + 1, highest, room.of_p)
    _generated(room.t, table, degree + 1, highest, room.of_t)
    for i in range(0, _SIX, 2):
        for which in range(2):
            _reversed_sum(room.of_p[i + which], room.of_t[i + which], degree, highest, room.p)
            scatter(body, room.p, highest, room.gathered, room.t if which == 0 else room.back)
        ones = (spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0))
        others = ones
        for component in range(2):
            a, b, c = room.of_p[0, component], room.of_p[1, component], room.of_p[2, component]
            d, e, f = room.of_p[3, component], room.of_p[4, component], room.of_p[5, component]
            for m in range(-degree - 1, degree + 2):
                row, mirrored = row_of(m, highest), row_of(-m, highest)
                for block in range(abs(m) // LANES * LANES, degree + 2, LANES):
                    at, opposite = row + block, mirrored + block
                    part = at + imaginary
                    of_p = (
                        lanes(a, at), lanes(a, part), lanes(b, at), lanes(b, part), lanes(c, at),
                        lanes(c, part), lanes(d, at), lanes(d, part), lanes(e, at), lanes(e, part),
                        lanes(f, at), lanes(f, part),
                    )  # fmt: skip
                    re, im = _returned(
                        room.of_t[i, component], room.t[component], at, opposite, imaginary, m
                    )
                    ones = _added(ones, bodies.derivative_summand(re, im, *of_p))
                    re, im = _returned(
                        room.of_t[i + 1, component],
                        room.back[component],
                        at,
                        opposite,
                        imaginary,
                        m,
                    )
                    others = _added(others, bodies.derivative_summand(re, im, *of_p))
        for j, value in enumerate(ones):
            found[DERIVATIVE + _SIX * i + j] += total(value)
        for j, value in enumerate(others):
            found[DERIVATIVE + _SIX * (i + 1) + j] += total(value)


@named_njit(**OPTIONS)
def _angles(frame):  # type: ignore[no-untyped-def]
    """Return (cos, sin) of the Euler angles alpha, beta and gamma of a rotation (3, 3)."""
    across = math.hypot(frame[0, 2], frame[1, 2])
    if across == 0.0:
        return (1.0, 0.0), (frame[2, 2], 0.0), (frame[1, 1], frame[1, 0])
    return (
        (frame[0, 2] / across, frame[1, 2] / across), (frame[2, 2], across),
        (-frame[2, 0] / across, frame[2, 1] / across),
    )  # fmt: skip


@named_njit(**OPTIONS)
def _frame_of(orientation, azimuth, out):  # type: ignore[no-untyped-def]
    """Fill `out` (3, 3) with the rotation of Euler parameters (4,), turned back by an azimuth."""
    w, x, y, z = orientation[0], orientation[1], orientation[2], orientation[3]
    out[0, 0], out[0, 1], out[0, 2] = (
        w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)
    )  # fmt: skip
    out[1, 0], out[1, 1], out[1, 2] = (
        2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)
    )  # fmt: skip
    out[2, 0], out[2, 1], out[2, 2] = (
        2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z
    )  # fmt: skip
    cosine, sine = azimuth
    for j in range(3):
        a, b = out[0, j], out[1, j]
        out[0, j], out[1, j] = cosine * a + sine * b, cosine * b - sine * a


@named_njit(**OPTIONS)
def _in_laboratory(frame, azimuth, derivative, found, out):  # type: ignore[no-untyped-def]
    """Fill `out` (like `found`) with force, torque and derivatives turned to the laboratory.

    `frame` (3, 3) is the rotation of the body's axes relative to the bead's azimuth; it is replaced
    by the one relative to the laboratory.
    """
    cosine, sine = azimuth
    for j in range(3):
        a, b = frame[0, j], frame[1, j]
        frame[0, j], frame[1, j] = cosine * a - sine * b, sine * a + cosine * b
    for i in range(FOUND):
        out[i] = found[i]
    for of in range(0, _SIX, 3):
        for i in range(3):
            out[of + i] = 0.0
            for j in range(3):
                out[of + i] += frame[i, j] * found[of + j]
    if not derivative:
        return
    for of in range(0, _SIX, 3):
        for over in range(0, _SIX, 3):
            for i in range(3):
                for j in range(3):
                    value = 0.0
                    for k in range(3):
                        for l in range(3):
                            at = DERIVATIVE + _SIX * (of + k) + over + l
                            value += frame[i, k] * found[at] * frame[j, l]
                    out[DERIVATIVE + _SIX * (of + i) + over + j] = value
        # a turned body turns its force too: d(R F)/d eps = ... - [F x]
        x, y, z = out[of], out[of + 1], out[of + 2]
        at = DERIVATIVE + _SIX * of + 3
        out[at + 1] += z
        out[at + 2] -= y
        out[at + _SIX] -= z
        out[at + _SIX + 2] += x
        out[at + 2 * _SIX] += y
        out[at + 2 * _SIX + 1] -= x


@named_njit(**OPTIONS)
def _mixed(light, begin, end, imaginary):  # type: ignore[no-untyped-def]
    """Replace the two helicities in rows from `begin` to `end` by electric and magnetic parts."""
    half = math.sqrt(0.5)
    plus, minus = light[0], light[1]
    for first in (begin, begin + imaginary):
        for at in range(first, first + end - begin, LANES):
            a, b = half * lanes(plus, at), half * lanes(minus, at)
            store(plus, at, a + b)
            store(minus, at, a - b)


@named_njit(**OPTIONS)
def add_up(  # type: ignore[no-untyped-def]
    data, source, body, derivative, position, orientation, room, frame, own, found, out
):
    """Fill `out` with the sums for one body, in the laboratory; return whether a rule reaches it.

    The first entries are force (N) and torque (N m). The absorbed power and the power of the waves
    about the body follow, as parts of the light's power. If `derivative`, the last entries are the
    6 x 6 derivative over position (m) and angles about the laboratory's axes.
    """
    x, y, z = position[0], position[1], position[2]
    rho = math.hypot(x, y)
    azimuth = (1.0, 0.0)
    if rho > 0.0:
        azimuth = (x / rho, y / rho)
    rule = rule_for(source, rho, z)
    if rule < 0:
        return False
    highest, degree = source.highest, body.degree
    table, states = vector(data, ELEMENTS), matrix(data, STATES)
    _frame_of(orientation, azimuth, frame)
    alpha, beta, gamma = _angles(frame)
    if len(body.places) == 0:
        # the body may turn about its axis: take gamma = 0
        cosine, sine = gamma
        for i in range(3):
            a, b = frame[i, 0], frame[i, 1]
            frame[i, 0], frame[i, 1] = cosine * a - sine * b, sine * a + cosine * b
        gamma = (1.0, 0.0)
    most = bessel_functions(source, rule, rho, room.bessel, room.norm)
    found[:] = 0.0
    imaginary = imaginary_of(highest)
    for state in range(states.shape[0]):
        orders = int(max(abs(states[state, LOWEST]), abs(states[state, HIGHEST]))) + most
        orders = min(orders, highest)
        lower, upper = row_of(-orders, highest), row_of(orders + 1, highest)
        for k in range(2):
            for i in range(lower, upper):
                room.light[k, i] = room.light[k, i + imaginary] = 0.0
        for part in range(int(states[state, BEGIN]), int(states[state, END])):
            plane_waves(source, rule, part, z, room.norm, room.re, room.im)
            k = 1 if source.parts[part, HELICITY] < 0 else 0
            add_part(
                source, rule, part, azimuth, most, room, -highest - MARGIN,
                room.light[k, LANES : LANES + 2 * imaginary],
            )  # fmt: skip
        _mixed(room.light, lower, upper, imaginary)
        turn(
            room.light, vector(data, DELTA), vector(data, ALTERNATING), highest,
            degree + (MARGIN if derivative else 1), orders, alpha, beta, gamma, room.combined,
            room.p,
        )  # fmt: skip
        scatter(body, room.p, highest, room.gathered, room.t)
        _combine(room.p, room.t, degree + 1, highest, room.v)
        own[:] = 0.0
        wrench_sums(room.p, room.t, room.v, table, degree, highest, own)
        if derivative:
            derivative_sums(body, table, highest, room, own)
        for i in range(FOUND if derivative else DERIVATIVE):
            found[i] += states[state, SHARE] * own[i]
    strength, wavenumber = number(data, STRENGTH), source.wavenumber
    unit = strength / number(data, OF_ALL)
    for i in range(3):
        found[i] *= strength
        found[3 + i] *= strength / wavenumber
    found[ABSORBED] *= unit
    found[FELT] *= unit
    if derivative:
        for i in range(_SIX):
            for j in range(_SIX):
                over = strength if i < 3 else strength / wavenumber
                if j < 3:
                    over *= wavenumber
                found[DERIVATIVE + _SIX * i + j] *= over
    _in_laboratory(frame, azimuth, derivative, found, out)
    return True


@functools.cache
def body_kernel() -> Kernel:
    """Return the kernel that adds force and torque of the light on a body, from its T-matrix.

    It adds gradients over the position if the wrench has arrays for them. The error of a body too
    far from the focus for every rule is infinite.
    """

    @cached_njit(KERNEL, error_model="numpy", nogil=True)
    def add_force_on_body(pose, data, wrench):  # type: ignore[no-untyped-def]
        """Add the force and torque of the light on a body, as a kernel."""
        source, body = source_of(data, SOURCE), body_of(data)
        gradient = len(wrench.force_gradient) > 0
        room = room_for(source, body, gradient)
        own, found, out = np.empty(FOUND), np.empty(FOUND), np.empty(FOUND)
        frame = np.empty((3, 3))
        tolerance, floor = number(data, TOLERANCE), number(data, FLOOR)
        unsure = number(data, UNSURE) * number(data, OF_ALL)
        turned = len(pose.orientation) > 0
        upright = np.array([1.0, 0.0, 0.0, 0.0])
        for at in range(pose.position.shape[0]):
            orientation = pose.orientation[at] if turned else upright
            if not add_up(
                data, source, body, gradient, pose.position[at], orientation, room, frame, own,
                found, out,
            ):  # fmt: skip
                wrench.error[at] = math.inf
                continue
            size = math.sqrt(out[0] ** 2 + out[1] ** 2 + out[2] ** 2)
            wrench.error[at] += tolerance * size + floor + unsure * out[FELT]
            for i in range(3):
                wrench.force[at, i] += out[i]
                wrench.moment[at, i] += out[3 + i]
                if gradient:
                    for j in range(3):
                        wrench.force_gradient[at, i, j] += out[DERIVATIVE + _SIX * i + j]
                        wrench.moment_gradient[at, i, j] += out[DERIVATIVE + _SIX * (3 + i) + j]

    return add_force_on_body


#: Type of the compiled `body_sums`
_SUMS = types.float64[:, ::1](types.float64[:, ::1], types.float64[:, ::1], DATA, types.boolean)


@functools.cache
def body_sums() -> Any:
    """Return the compiled function of force, torque, absorbed share and 6 x 6 derivative, (n, 44).

    Its arguments are positions (n, 3), m, Euler parameters (n, 4), the data of `body_kernel`, and
    whether to compute the derivative. A row is NaN where the body is too far from the focus.
    """

    @cached_njit(_SUMS, error_model="numpy", nogil=True)
    def sums_of(positions, orientations, data, derivative):  # type: ignore[no-untyped-def]
        """Return the sums of `add_up` for bodies at positions and orientations."""
        source, body = source_of(data, SOURCE), body_of(data)
        room = room_for(source, body, derivative)
        own, found, frame = np.empty(FOUND), np.empty(FOUND), np.empty((3, 3))
        out = np.full((len(positions), FOUND), np.nan)
        for at in range(len(positions)):
            add_up(
                data, source, body, derivative, positions[at], orientations[at], room, frame,
                own, found, out[at],
            )  # fmt: skip
        return out

    return sums_of
