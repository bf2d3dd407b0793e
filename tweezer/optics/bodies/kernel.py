"""Force, torque and absorbed power of light on a body, from its T-matrix.

With the amplitudes p of the light in the body's frame, t = (S - 1) p and v = 2p + t,

    F = -(n_m/c) Re<t|s|v>,   M = -(1/omega) Re<t|J|v>,   P_abs = -Re<t|v>,

where s is the direction and J the angular momentum. `derivation.bodies` derives the summands. The
light's amplitudes p are those of the sphere, and `rotated` turns them to the body's frame.

A body shifts the light's amplitudes by i k s_j p for each unit it moves along j, and by i J_j p for
each radian that it turns about j. The 6 x 6 derivative follows from these six changes.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numba import types

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, store, total
from tweezer.forces.data import DATA, integers, matrix, number, vector
from tweezer.forces.force import KERNEL, Kernel
from tweezer.optics.bodies.rotated import MARGIN, OPTIONS, imaginary_of, length_of, row_of, turn
from tweezer.optics.bodies._summands import direction
from tweezer.optics.waves.kernel import (
    BEGIN,
    END,
    HIGHEST,
    LOWEST,
    SHARE,
    _electric_and_magnetic,
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

# entries of the data. The first five are numbers: 4 pi^2 n_m P/c (N), n_m P/c (N), the relative
# tolerance, the error of the force where it vanishes (N), and the error of S - 1 as an operator
(STRENGTH, OF_ALL, TOLERANCE, FLOOR, UNSURE, STATES, ELEMENTS, DELTA, ALTERNATING, BLOCKS,
 SCATTERING, GATHERED, SIGNS, DEGREE, AXIAL, SOURCE) = range(16)  # fmt: skip
# columns of the blocks of S - 1: rows, first entry of the matrix, vectors, first entry of the lists
ROWS, ENTRY, VECTORS, LIST = range(4)
#: Six components: force or translation, torque or rotation
_SIX = 6
#: Numbers of one bead: force and torque, absorbed power, |p|^2, the 6 x 6 derivative
FOUND, ABSORBED, FELT = 8 + _SIX * _SIX, 6, 7
_DERIVATIVE = 8
#: Rows of the elements, as in `harmonics.Elements`
_ALONG, _WITHIN, _RAISED, _TURNED, _LOWERED, _LIFT = range(6)


class Body(NamedTuple):
    """The scattering of a body, S - 1, as blocks that couple lists of amplitudes."""

    blocks: Any
    """(blocks, 4) see ROWS and so on"""
    scattering: Any
    """elements of all blocks by column: real parts of a column, then its imaginary parts"""
    gathered: Any
    """index of each amplitude of each vector of a block, in the real parts of `rotated`'s arrays"""
    signs: Any
    """(like `gathered`) sign with which it enters"""
    degree: int
    """highest degree of S - 1"""


class Room(NamedTuple):
    """Arrays for intermediate results, made once for all bodies of a call."""

    bessel: Any
    norm: Any
    re: Any
    im: Any
    work: Any
    light: Any
    """amplitudes in the laboratory's frame"""
    combined: Any
    """combinations of orders, see `rotated.turn`"""
    p: Any
    """amplitudes p in the body's frame"""
    v: Any
    """v = 2p + t"""
    t: Any
    """t = (S - 1) p"""
    gathered: Any
    """(2 vectors, rows) amplitudes of a block, real and imaginary"""
    changes: Any
    """(6, ...) derivatives dp of p; empty where no derivatives are computed"""
    answers: Any
    """(6, ...) (S - 1) dp"""
    of_v: Any
    """(6, ...) s v and J v"""
    of_t: Any
    """(6, ...) s t and J t"""


@named_njit(**OPTIONS)
def body_of(data):  # type: ignore[no-untyped-def]
    """Return the `Body` of a force's data."""
    return Body(
        matrix(data, BLOCKS), vector(data, SCATTERING), integers(data, GATHERED),
        vector(data, SIGNS), int(number(data, DEGREE)),
    )  # fmt: skip


@named_njit(**OPTIONS)
def room_for(source, body, derivative):  # type: ignore[no-untyped-def]
    """Return the `Room` for the largest rule of a `Source`; `derivative`: with derivatives."""
    nodes = int(source.rules[-1, PADDED])
    stride, length = source.highest + 1, length_of(source.highest)
    rows = 0
    for block in range(len(body.blocks)):
        rows = max(rows, int(body.blocks[block, ROWS]))
    six = _SIX if derivative else 0
    return Room(
        np.empty((begin(source.rules[-1, PHASE]) + 3) * nodes), np.empty(nodes), np.empty(nodes),
        np.empty(nodes), np.empty(2 * nodes), np.empty((2, length)),
        np.empty((2, 8 * stride * stride)), np.zeros((2, length)), np.zeros((2, length)),
        np.zeros((2, length)), np.empty((2 * 2, rows)), np.zeros((six, 2, length)),
        np.zeros((six, 2, length)), np.zeros((six, 2, length)), np.zeros((six, 2, length)),
    )  # fmt: skip


@named_njit(**OPTIONS)
def scatter(body, p, highest, gathered, t):  # type: ignore[no-untyped-def]
    """Fill `t` with (S - 1) p, block by block; `gathered` is room for amplitudes of a block."""
    imaginary = imaginary_of(highest)
    source, out = p.ravel(), t.ravel()
    for b in range(len(body.blocks)):
        rows, entry = int(body.blocks[b, ROWS]), int(body.blocks[b, ENTRY])
        many, first = int(body.blocks[b, VECTORS]), int(body.blocks[b, LIST])
        for i in range(many):
            for j in range(rows):
                index = body.gathered[first + i * rows + j]
                sign = body.signs[first + i * rows + j]
                gathered[2 * i, j] = sign * source[index]
                gathered[2 * i + 1, j] = sign * source[index + imaginary]
        for block in range(0, rows, LANES):
            a_re, a_im, b_re, b_im = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
            at = entry + block
            for j in range(rows):
                s_re, s_im = lanes(body.scattering, at), lanes(body.scattering, at + rows)
                x, y = gathered[0, j], gathered[1, j]
                a_re = a_re + s_re * x - s_im * y
                a_im = a_im + s_re * y + s_im * x
                if many > 1:
                    x, y = gathered[2, j], gathered[3, j]
                    b_re = b_re + s_re * x - s_im * y
                    b_im = b_im + s_re * y + s_im * x
                at += 2 * rows
            _spread_out(body, out, imaginary, first + block, a_re, a_im)
            if many > 1:
                _spread_out(body, out, imaginary, first + rows + block, b_re, b_im)


@named_njit(**OPTIONS)
def _spread_out(body, out, imaginary, first, re, im):  # type: ignore[no-untyped-def]
    """Store eight amplitudes re, im at the places of entries `first`... of the lists of a body."""
    values = np.empty(2 * LANES)
    store(values, 0, re)
    store(values, LANES, im)
    for i in range(LANES):
        sign = body.signs[first + i]
        if sign != 0.0:
            index = body.gathered[first + i]
            out[index] = sign * values[i]
            out[index + imaginary] = sign * values[LANES + i]


@named_njit(**OPTIONS)
def _neighbours(own, partner, at, stride, imaginary):  # type: ignore[no-untyped-def]
    """Return the amplitudes about (n, m) for eight degrees n, as the summands take them."""
    down, up = at - stride, at + stride
    return (
        lanes(own, down - 1), lanes(own, down - 1 + imaginary),
        lanes(own, down), lanes(own, down + imaginary),
        lanes(own, down + 1), lanes(own, down + 1 + imaginary),
        lanes(own, at - 1), lanes(own, at - 1 + imaginary),
        lanes(own, at), lanes(own, at + imaginary),
        lanes(own, at + 1), lanes(own, at + 1 + imaginary),
        lanes(own, up - 1), lanes(own, up - 1 + imaginary),
        lanes(own, up), lanes(own, up + imaginary),
        lanes(own, up + 1), lanes(own, up + 1 + imaginary),
        lanes(partner, down), lanes(partner, down + imaginary),
        lanes(partner, at), lanes(partner, at + imaginary),
        lanes(partner, up), lanes(partner, up + imaginary),
    )  # fmt: skip


@named_njit(**OPTIONS)
def _elements_about(table, size, of, stride):  # type: ignore[no-untyped-def]
    """Return the elements of the direction between (n, m) and its neighbours, eight degrees n."""
    below = of - stride
    return (
        lanes(table, _ALONG * size + of), lanes(table, _ALONG * size + of + 1),
        lanes(table, _WITHIN * size + of),
        lanes(table, _RAISED * size + below - 1), lanes(table, _TURNED * size + below),
        lanes(table, _LOWERED * size + below + 1),
        lanes(table, _RAISED * size + of), lanes(table, _TURNED * size + of),
        lanes(table, _LOWERED * size + of),
    )  # fmt: skip


@named_njit(**OPTIONS)
def _applied(own, partner, table, size, at, of, stride, imaginary, m):  # type: ignore[no-untyped-def]
    """Return s_x, s_y, s_z, J_x, J_y and J_z times a field at (n, m), as (re, im), eight n."""
    n = _neighbours(own, partner, at, stride, imaginary)
    pr, pi, mr, mi, zr, zi = direction(*n, *_elements_about(table, size, of, stride))
    lift = lanes(table, _LIFT * size + of)
    lift_down = lanes(table, _LIFT * size + of - stride)
    # J_+ v and J_- v at (n, m)
    jpr, jpi = lift_down * n[2], lift_down * n[3]
    jmr, jmi = lift * n[14], lift * n[15]
    return (
        0.5 * (pr + mr), 0.5 * (pi + mi), 0.5 * (pi - mi), 0.5 * (mr - pr), zr, zi,
        0.5 * (jpr + jmr), 0.5 * (jpi + jmi), 0.5 * (jpi - jmi), 0.5 * (jmr - jpr),
        m * n[8], m * n[9],
    )  # fmt: skip


@named_njit(**OPTIONS)
def wrench_sums(p, t, v, table, degree, highest, found):  # type: ignore[no-untyped-def]
    """Add -Re<t|A|v> for the six A, -Re<t|v> and |p|^2 to `found`; table: elements."""
    stride, imaginary = highest + 1, imaginary_of(highest)
    size = (2 * highest + 1) * stride
    x, y, z = spread(0.0), spread(0.0), spread(0.0)
    a, b, c = spread(0.0), spread(0.0), spread(0.0)
    lost, felt = spread(0.0), spread(0.0)
    for component in range(2):
        own, partner, answer, light = v[component], v[1 - component], t[component], p[component]
        for m in range(-degree, degree + 1):
            row, elements = row_of(m, highest), stride + LANES + (m + highest) * stride
            for block in range(abs(m) // LANES * LANES, degree + 1, LANES):
                at = row + block
                re, im = lanes(answer, at), lanes(answer, at + imaginary)
                f = _applied(
                    own, partner, table, size, at, elements + block, stride, imaginary, float(m)
                )
                x = x - (re * f[0] + im * f[1])
                y = y - (re * f[2] + im * f[3])
                z = z - (re * f[4] + im * f[5])
                a = a - (re * f[6] + im * f[7])
                b = b - (re * f[8] + im * f[9])
                c = c - (re * f[10] + im * f[11])
                lost = lost - (re * lanes(own, at) + im * lanes(own, at + imaginary))
                u, w = lanes(light, at), lanes(light, at + imaginary)
                felt = felt + (u * u + w * w)
    for i, value in enumerate((x, y, z, a, b, c, lost, felt)):
        found[i] += total(value)


@named_njit(**OPTIONS)
def _apply_all(field, table, degree, highest, turned, out):  # type: ignore[no-untyped-def]
    """Fill `out` (6, ...) with s_j and J_j times a field up to a degree; i times, if `turned`."""
    stride, imaginary = highest + 1, imaginary_of(highest)
    size = (2 * highest + 1) * stride
    for component in range(2):
        own, partner = field[component], field[1 - component]
        for m in range(-degree, degree + 1):
            row, elements = row_of(m, highest), stride + LANES + (m + highest) * stride
            for block in range(abs(m) // LANES * LANES, degree + 1, LANES):
                at = row + block
                f = _applied(
                    own, partner, table, size, at, elements + block, stride, imaginary, float(m)
                )
                for j in range(_SIX):
                    re, im = f[2 * j], f[2 * j + 1]
                    if turned:
                        store(out[j, component], at, -im)
                        store(out[j, component], at + imaginary, re)
                    else:
                        store(out[j, component], at, re)
                        store(out[j, component], at + imaginary, im)


@named_njit(**OPTIONS)
def derivative_sums(body, p, t, v, table, highest, room, found):  # type: ignore[no-untyped-def]
    """Add the derivatives of the six sums over the six motions of the body to `found`.

    They are -Re(<dt|A v> + <A t|2 dp + dt>), by A and motion, over k r and over angles.
    """
    degree, imaginary = body.degree, imaginary_of(highest)
    _apply_all(p, table, degree + 1, highest, True, room.changes)
    _apply_all(v, table, degree, highest, False, room.of_v)
    _apply_all(t, table, degree + 1, highest, False, room.of_t)
    for j in range(_SIX):
        scatter(body, room.changes[j], highest, room.gathered, room.answers[j])
    for i in range(_SIX):
        for j in range(_SIX):
            sum_ = spread(0.0)
            for component in range(2):
                of_v, of_t = room.of_v[i, component], room.of_t[i, component]
                change, answer = room.changes[j, component], room.answers[j, component]
                for m in range(-degree - 1, degree + 2):
                    row = row_of(m, highest)
                    for block in range(abs(m) // LANES * LANES, degree + 2, LANES):
                        at = row + block
                        re, im = lanes(answer, at), lanes(answer, at + imaginary)
                        sum_ = sum_ - (
                            re * lanes(of_v, at) + im * lanes(of_v, at + imaginary)
                        )
                        re = re + 2.0 * lanes(change, at)
                        im = im + 2.0 * lanes(change, at + imaginary)
                        sum_ = sum_ - (
                            re * lanes(of_t, at) + im * lanes(of_t, at + imaginary)
                        )
            found[_DERIVATIVE + _SIX * i + j] += total(sum_)


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
    out[:] = found
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
                            at = _DERIVATIVE + _SIX * (of + k) + over + l
                            value += frame[i, k] * found[at] * frame[j, l]
                    out[_DERIVATIVE + _SIX * (of + i) + over + j] = value
        # a turned body turns its force too: d(R F)/d eps = ... - [F x]
        x, y, z = out[of], out[of + 1], out[of + 2]
        at = _DERIVATIVE + _SIX * of + 3
        out[at + 1] += z
        out[at + 2] -= y
        out[at + _SIX] -= z
        out[at + _SIX + 2] += x
        out[at + 2 * _SIX] += y
        out[at + 2 * _SIX + 1] -= x


@named_njit(**OPTIONS)
def add_up(  # type: ignore[no-untyped-def]
    data, source, body, derivative, position, orientation, room, frame, found, out
):
    """Fill `out` with the sums for one body, in the laboratory; return whether a rule reaches it.

    The entries are force (N), torque (N m), the share of the light's power that the body absorbs,
    the power of the waves that it feels in the same unit, and, if `derivative`, the 6 x 6
    derivative over position (m) and angles about the laboratory's axes.
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
    if number(data, AXIAL) != 0.0:
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
        room.light[:] = 0.0
        for part in range(int(states[state, BEGIN]), int(states[state, END])):
            plane_waves(source, rule, part, z, room.norm, room.re, room.im)
            k = 1 if source.parts[part, HELICITY] < 0 else 0
            add_part(
                source, rule, part, azimuth, most, room, -highest - MARGIN,
                room.light[k, LANES : LANES + 2 * imaginary],
            )  # fmt: skip
        _electric_and_magnetic(room.light, 2 * imaginary + LANES)
        orders = max(abs(states[state, LOWEST]), abs(states[state, HIGHEST]))
        turn(
            room.light, vector(data, DELTA), vector(data, ALTERNATING), highest,
            int(orders) + most, alpha, beta, gamma, room.combined, room.p,
        )  # fmt: skip
        scatter(body, room.p, highest, room.gathered, room.t)
        share = states[state, SHARE]
        light, answer, both = room.p.ravel(), room.t.ravel(), room.v.ravel()
        scale = math.sqrt(share)
        for i in range(light.size):
            light[i] *= scale
            answer[i] *= scale
            both[i] = 2.0 * light[i] + answer[i]
        wrench_sums(room.p, room.t, room.v, table, degree, highest, found)
        if derivative:
            derivative_sums(body, room.p, room.t, room.v, table, highest, room, found)
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
                found[_DERIVATIVE + _SIX * i + j] *= over
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
        found, out, frame = np.empty(FOUND), np.empty(FOUND), np.empty((3, 3))
        tolerance, floor = number(data, TOLERANCE), number(data, FLOOR)
        unsure = number(data, UNSURE) * number(data, OF_ALL)
        turned = len(pose.orientation) > 0
        upright = np.array([1.0, 0.0, 0.0, 0.0])
        for at in range(pose.position.shape[0]):
            orientation = pose.orientation[at] if turned else upright
            if not add_up(
                data, source, body, gradient, pose.position[at], orientation, room, frame, found,
                out,
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
                        wrench.force_gradient[at, i, j] += out[_DERIVATIVE + _SIX * i + j]
                        wrench.moment_gradient[at, i, j] += out[_DERIVATIVE + _SIX * (3 + i) + j]

    return add_force_on_body


#: Type of the compiled `body_sums`
_SUMS = types.float64[:, ::1](
    types.float64[:, ::1], types.float64[:, ::1], DATA, types.boolean
)


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
        found, frame = np.empty(FOUND), np.empty((3, 3))
        out = np.full((len(positions), FOUND), np.nan)
        for at in range(len(positions)):
            add_up(
                data, source, body, derivative, positions[at], orientations[at], room, frame,
                found, out[at],
            )  # fmt: skip
        return out

    return sums_of
