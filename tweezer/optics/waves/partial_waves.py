"""The light about the bead, as amplitudes P_nm of its partial waves.

With the bead at (rho, 0, z), light of helicity l and angular momentum j about the axis has the
amplitudes p_nm = 2 pi i^m P_nm,

    P_nm = i^-j integral g(u) f^l_nm(u) J_{m-j}(k rho sin(theta)) exp(i k z u) du,   u = cos(theta),

g the amplitude of its plane waves (Mazolli, Maia Neto and Nussenzveig, Proc. R. Soc. A 459, 3021,
2003). The integral is a sum over the nodes of `tweezer.optics.waves.nodes`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from tweezer.compiled import named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, store
from tweezer.forces.data import matrix, number, vector

Array = Any

#: Compiler options of the sums
OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "inner": True}

#: Seed of the recurrence of Bessel functions
_SEED = 1e-30
#: Smallest argument of a Bessel function
_LEAST = 1e-30

# columns of a rule: number of nodes, that number padded, largest phase, first node, first entry of
# its harmonics
NODES, PADDED, PHASE, FIRST_NODE, FIRST_HARMONIC = range(5)
# rows of the nodes: 1 - cos(theta), sin(theta), and the weighted amplitudes of each part
BELOW, SINE, AMPLITUDE = range(3)
# columns of a part: helicity, J_z, coefficient (re, im)
HELICITY, MOMENTUM, RE, IM = range(4)


class Source(NamedTuple):
    """The light and the nodes of integration, from which the amplitudes P_nm are computed."""

    wavenumber: float
    """k, 1/m"""
    shift: float
    """rad: the light has the phase `shift` (1 - cos(theta)), which its amplitudes leave out"""
    radius: float
    """of the bead, m"""
    half_angle: float
    """theta_m, polar angle of the outermost wave, rad"""
    sine: float
    """sin(theta_m)"""
    phases: Array
    """(2,) largest phase over the cone for each 1/k that the bead is off across and along the
    light, rad"""
    dropped: float
    """bound on the Bessel functions of the orders that are left out, if the bead is in the light.
    Orders m that are left out enter squared. If the bead is beside the light, the bound is its
    square"""
    rules: Array
    """(rules, 5) numbers of each rule of integration, see NODES and so on"""
    nodes: Array
    """(2 + 2 parts, nodes of all rules), see BELOW and so on; real, imaginary part of each part"""
    harmonics: Array
    """of all rules, one after the other: for each order (nodes, degrees), of the degrees from |m|
    down to a multiple of LANES"""
    parts: Array
    """(parts, 4) of the light, see HELICITY and so on"""
    begins: Array
    """(orders,) first of the harmonics of each order, over the number of nodes"""
    highest: int
    """degree and order of the tables of harmonics"""


@named_njit(**OPTIONS)
def source_of(data, first):  # type: ignore[no-untyped-def]
    """Return the `Source` whose fields begin at the entry `first` of a force's data."""
    return Source(
        number(data, first), number(data, first + 1), number(data, first + 2),
        number(data, first + 3), number(data, first + 4), vector(data, first + 5),
        number(data, first + 6), matrix(data, first + 7), matrix(data, first + 8),
        vector(data, first + 9), matrix(data, first + 10), vector(data, first + 11),
        int(number(data, first + 12)),
    )  # fmt: skip


@named_njit(**OPTIONS)
def rule_for(source, rho, z):  # type: ignore[no-untyped-def]
    """Return the number of the rule that integrates the light about a bead at (rho, z), m.

    It is the rule with the fewest nodes whose largest phase is not exceeded, or -1.
    """
    phase = source.wavenumber * (source.radius * source.half_angle + rho * source.phases[0])
    phase += abs(source.wavenumber * z - source.shift) * source.phases[1]
    for at in range(source.rules.shape[0]):
        if phase <= source.rules[at, PHASE]:
            return at
    return -1


@named_njit(**OPTIONS)
def bessel_functions(source, rule, rho, bessel, norm):  # type: ignore[no-untyped-def]
    """Fill `bessel` (orders, nodes) with J_v(k rho sin(theta)) times norm (nodes,), v = 0, 1, ...

    At each node the recurrence goes down from an order where J_v is below rounding, with an
    arbitrary value there (Miller). `norm` is filled with the factor that this leaves, from
    J_0 + 2 (J_2 + J_4 + ...) = 1. `rule` is the number of a rule of `source`, and `rho` is the
    bead's distance from the axis (m). Both arrays are flattened, with a padded number of nodes.
    Returns the largest order that contributes.
    """
    padded = int(source.rules[rule, PADDED])
    first = int(source.rules[rule, FIRST_NODE])
    lateral = source.wavenumber * rho
    largest = lateral * source.sine
    if largest == 0.0:
        for q in range(padded):
            bessel[q] = norm[q] = 1.0
        return 0
    top = begin(largest)
    bessel[: (top + 2) * padded] = 0.0
    for q in range(padded):
        x = max(lateral * source.nodes[SINE, first + q], _LEAST)
        norm[q] = 2.0 / x  # until the sum replaces it below
        bessel[begin(x) * padded + q] = _SEED
    for block in range(0, padded, LANES):
        two_over_x = lanes(norm, block)
        above, here = spread(0.0), lanes(bessel, top * padded + block)
        even = spread(0.0)
        for v in range(top, 0, -1):
            at = (v - 1) * padded + block
            before = lanes(bessel, at) + float(v) * two_over_x * here - above
            store(bessel, at, before)
            above, here = here, before
            if v % 2 == 1 and v > 1:
                even = even + before
        store(norm, block, here + 2.0 * even)
    # the outermost node is the first, and has the largest Bessel functions of high order. A bead in
    # the light has much stronger waves of low order; beside it their sums may cancel
    least = source.dropped * abs(norm[0])
    if rho > source.radius:
        least *= source.dropped
    for v in range(top, 0, -1):
        if abs(bessel[v * padded]) > least:
            return min(v + 1, top)
    return 1


@named_njit(**OPTIONS)
def begin(x):  # type: ignore[no-untyped-def]
    """Return an order v > x above which the Bessel functions J_v(x) are below rounding."""
    if x < 0.1:
        return 10
    return int(x + 7.0 * x ** (1.0 / 3.0)) + 12


@named_njit(**OPTIONS)
def plane_waves(source, rule, part, z, norm, re, im):  # type: ignore[no-untyped-def]
    """Fill re, im (nodes,) with the plane waves of a part of the light at a bead's height z, m.

    They are g(u) exp(i k z u) times the weight of the node, up to a constant phase, over `norm`.
    Here g is the light's amplitude, u = cos(theta) and k the wavenumber. Times the Bessel
    functions, which have the factor `norm`, they are an integrand over the cone. `rule` and `part`
    are numbers of a rule and of a part of the light in `source`.
    """
    first = int(source.rules[rule, FIRST_NODE])
    height = source.wavenumber * z - source.shift
    for q in range(int(source.rules[rule, NODES])):
        turned = -height * source.nodes[BELOW, first + q]
        cosine, sine = math.cos(turned), math.sin(turned)
        a = source.nodes[AMPLITUDE + 2 * part, first + q] / norm[q]
        b = source.nodes[AMPLITUDE + 2 * part + 1, first + q] / norm[q]
        re[q] = a * cosine - b * sine
        im[q] = a * sine + b * cosine


@named_njit(**OPTIONS)
def add_part(source, rule, part, azimuth, most, room, low, out):  # type: ignore[no-untyped-def]
    """Add the amplitudes P_nm of a part of the light to `out`, by sums over the nodes.

    P_nm is the amplitude of the partial wave of degree n and order m about the bead. `rule` and
    `part` are numbers of a rule and of a part of the light in `source`. `azimuth` is (cos, sin) for
    the bead. The Bessel functions up to the order `most`, and the plane waves, are in `room`, a
    `kernel.Room`. `out` is flattened (2, orders, degrees), all real parts before the imaginary
    ones, and its first row has the order m = `low`.
    """
    bessel, re, im, work = room.bessel, room.re, room.im, room.work
    highest = source.highest
    count, padded = int(source.rules[rule, NODES]), int(source.rules[rule, PADDED])
    tables = int(source.rules[rule, FIRST_HARMONIC])
    helicity, j = source.parts[part, HELICITY], int(source.parts[part, MOMENTUM])
    c_re, c_im = turned(source.parts[part, RE], source.parts[part, IM], azimuth, j)
    for v in range(most + 1):
        for q in range(count):
            work[q] = bessel[v * padded + q] * re[q]
            work[padded + q] = bessel[v * padded + q] * im[q]
        for side in range(2 if v > 0 else 1):
            m = j + v if side == 0 else j - v
            if abs(m) > highest:
                continue
            sign = 1.0
            if side == 1 and v % 2 == 1:
                sign = -1.0  # J_-v = (-1)^v J_v
            row = m  # of the table; helicity -1 has the mirror images, see `harmonics`
            if helicity < 0:
                row = -m
                if m % 2 != 0:
                    sign = -sign
            a, b = sign * c_re, sign * c_im
            contracted(source, count, padded, tables, m, row, a, b, work, low, out)


@named_njit(**OPTIONS, forceinline=True)
def contracted(  # type: ignore[no-untyped-def]
    source, count, padded, tables, m, row, a, b, work, low, out
):
    """Add (a + i b) times the sums of harmonics of order `row` and the waves in `work` to `out`.

    `work` contains the real and then the imaginary parts at the nodes of a rule with `count` nodes,
    `padded` to whole lanes, whose harmonics begin at `tables`. The sums, one for each degree, are
    added to the order m of `out`, which is described in `add_part`.
    """
    stride, imaginary = source.highest + 1, out.size // 2
    low_degree = abs(m) // LANES * LANES
    width = stride - low_degree
    table = tables + int(source.begins[row + source.highest]) * count - low_degree
    to = (m - low) * stride
    for block in range(low_degree, stride, LANES):
        sum_re, sum_im = spread(0.0), spread(0.0)
        other_re, other_im = spread(0.0), spread(0.0)
        # two sums over every other node: an addition waits for the one before it
        for q in range(0, count, 2):
            f = lanes(source.harmonics, table + q * width + block)
            sum_re = sum_re + f * work[q]
            sum_im = sum_im + f * work[padded + q]
            f = lanes(source.harmonics, table + (q + 1) * width + block)
            other_re = other_re + f * work[q + 1]
            other_im = other_im + f * work[padded + q + 1]
        sum_re, sum_im = sum_re + other_re, sum_im + other_im
        at = to + block
        store(out, at, lanes(out, at) + a * sum_re - b * sum_im)
        at += imaginary
        store(out, at, lanes(out, at) + a * sum_im + b * sum_re)


@named_njit(**OPTIONS)
def turned(re, im, azimuth, j):  # type: ignore[no-untyped-def]
    """Return (re, im), a complex number, times (-i exp(i phi))^j; azimuth: (cos(phi), sin(phi))."""
    x, y = azimuth[1], -azimuth[0]
    if j < 0:
        y = -y
    for _ in range(abs(j)):
        re, im = re * x - im * y, re * y + im * x
    return re, im
