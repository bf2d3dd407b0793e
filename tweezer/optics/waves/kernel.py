"""The force of the light's waves on a sphere, from the momentum of the light before and after.

Force, torque and gradient are sums over the partial waves about the bead, of degree n and order m.
Each wave is coupled with its neighbours in n and m alone. `derivation.waves` derives the summands.

If the light has the helicity +1 alone, it has one component. Otherwise its electric and its
magnetic part are two components. The sums of one component are added to `found`, (25,), in the
frame in which the bead is at (rho, 0, z). With the refractive index n_m of the medium and the power
P, they are in units of 4 pi^2 n_m P/c:

    0-2 force, 1;  3-5 torque, m;  6-14 gradient of the force, row by row, 1/m;
    15-23 gradient of the torque, 1;  24 absorbed power, in 4 pi^2 P.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numba import types

from tweezer.compiled import cache_functions, cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, total
from tweezer.forces.data import DATA, matrix, number, vector
from tweezer.forces.force import KERNEL, Kernel
from tweezer.generated import waves
from tweezer.optics.turning import put
from tweezer.optics.waves.grid import add_uneven_part, azimuthal_orders, grid_of, size_of
from tweezer.optics.waves.partial_waves import (
    HELICITY,
    OPTIONS,
    PADDED,
    PHASE,
    add_part,
    begin,
    bessel_functions,
    plane_waves,
    rule_for,
    source_of,
)

cache_functions(waves)

# entries of the data. The first four are numbers: 4 pi^2 n_m P/c (N), n_m P/c (N), the relative
# tolerance of the force, and its error where it vanishes (N). The states, `Weights.elements`,
# `Weights.sphere` of each component and the entries of the `Source` follow
STRENGTH, OF_ALL, TOLERANCE, FLOOR, STATES, ELEMENTS, SPHERE, SOURCE = range(8)
# columns of the states: power share, handedness, component count, range of parts, range of J_z
SHARE, HANDEDNESS, COMPONENTS, BEGIN, END, LOWEST, HIGHEST = range(7)
# rows of the elements of the direction, as in `harmonics.Elements`
_ALONG, _WITHIN, _RAISED, _TURNED, _LOWERED, _LIFT = range(6)
# rows of the sphere's weights
_U_RE, _U_IM, _V_RE, _V_IM, _K, WEIGHTS = range(6)
#: Numbers computed at a position: force, torque, their gradients, absorbed power
FOUND = 25
ABSORBED = 24
#: Type of the compiled `absorption`
ABSORPTION = types.float64[::1](types.float64[:, ::1], DATA)


class Waves(NamedTuple):
    """Partial waves about the bead of one component of the light, and of the other component."""

    own: Any
    """amplitudes P_nm of the waves of degree n and order m, see `partial_waves`: real parts, then
    imaginary parts, by (m, n)"""
    partner: Any
    """P_nm of the other component, in the same order; of this one again if there is no other"""
    imaginary: int
    """entry of the first imaginary part"""
    first: int
    """lowest order m"""
    last: int
    """highest order m"""
    begin: int
    """entry of order `first`, degree 0"""


class Weights(NamedTuple):
    """Weights of the products of partial waves: matrix elements of the direction, and the sphere's.

    The matrix elements are by (m, n), see `harmonics.Elements`; the weights by n, see
    `sphere.weights`.
    """

    elements: Any
    """flattened (kinds, m, n), with a guard of `stride` + LANES zeros before and after: the sums
    read neighbours of the first and last entries too"""
    sphere: Any
    """rows of U, V and K of one component, flattened, with a guard of LANES zeros before and
    after"""
    stride: int
    """number of degrees n, from 0: from an order m to the next"""
    size: int
    """number of entries (m, n) of each kind of elements"""


def guarded_elements(tables: Any) -> Any:
    """Return `Weights.elements` from tables of the elements, (kinds, orders, degrees)."""
    guard = np.zeros(tables.shape[2] + LANES)
    return np.concatenate([guard, tables.ravel(), guard])


def guarded_sphere(weights: Any) -> Any:
    """Return `Weights.sphere` of each component, from weights (components, rows, degrees)."""
    return np.stack([np.pad(each.ravel(), LANES) for each in weights])


@named_njit(**OPTIONS)
def force_sum(light, weights, found):  # type: ignore[no-untyped-def]
    """Add the force that one component of the light exerts to found[0:3], in 4 pi^2 n_m P/c.

    n_m is the refractive index of the medium, P the power. `light` are the component's `Waves`. The
    sum is over the orders m, and for each over eight degrees n at a time. In it
    `waves.force_summand` couples (m, n) with its neighbours.
    """
    P, partner, imaginary = light.own, light.partner, light.imaginary
    table, sphere, stride, size = weights
    middle = size // stride // 2
    x, y, z = spread(0.0), spread(0.0), spread(0.0)
    for m in range(light.first, light.last + 1):
        row = light.begin + (m - light.first) * stride
        elements = stride + LANES + (m + middle) * stride
        for block in range(abs(m) // LANES * LANES, stride, LANES):
            at, of, n = row + block, elements + block, LANES + block
            up = at + stride
            a, b, c = waves.force_summand(
                lanes(P, at), lanes(P, at + imaginary),
                lanes(P, at + 1), lanes(P, at + 1 + imaginary),
                lanes(partner, at), lanes(partner, at + imaginary),
                lanes(P, up - 1), lanes(P, up - 1 + imaginary),
                lanes(P, up), lanes(P, up + imaginary),
                lanes(P, up + 1), lanes(P, up + 1 + imaginary),
                lanes(sphere, _U_RE * stride + n), lanes(sphere, _U_IM * stride + n),
                lanes(sphere, _U_RE * stride + n - 1), lanes(sphere, _U_IM * stride + n - 1),
                lanes(sphere, _V_RE * stride + n), lanes(sphere, _V_IM * stride + n),
                lanes(table, _ALONG * size + of + 1), lanes(table, _WITHIN * size + of),
                lanes(table, _RAISED * size + of), lanes(table, _TURNED * size + of),
                lanes(table, _LOWERED * size + of),
            )  # fmt: skip
            x, y, z = x + a, y + b, z + c
    found[0] += total(x)
    found[1] += total(y)
    found[2] += total(z)


@named_njit(**OPTIONS)
def neighbours(light, at, stride):  # type: ignore[no-untyped-def]
    """Return the amplitudes P_nm that the summand of (m, n) needs, for eight degrees n at a time.

    P_nm belongs to the partial wave of degree n and order m. The result is P at (n - 1, n, n + 1)
    for the orders m - 1, m, m + 1, and the partner's at n for each. All are pairs of real and
    imaginary parts. In `light`, the entry `at` belongs to (m, n), and `stride` is the number of
    degrees.
    """
    P, partner, imaginary = light.own, light.partner, light.imaginary
    down, up = at - stride, at + stride
    return (
        lanes(P, down - 1), lanes(P, down - 1 + imaginary),
        lanes(P, down), lanes(P, down + imaginary),
        lanes(P, down + 1), lanes(P, down + 1 + imaginary),
        lanes(P, at - 1), lanes(P, at - 1 + imaginary),
        lanes(P, at), lanes(P, at + imaginary),
        lanes(P, at + 1), lanes(P, at + 1 + imaginary),
        lanes(P, up - 1), lanes(P, up - 1 + imaginary),
        lanes(P, up), lanes(P, up + imaginary),
        lanes(P, up + 1), lanes(P, up + 1 + imaginary),
        lanes(partner, down), lanes(partner, down + imaginary),
        lanes(partner, at), lanes(partner, at + imaginary),
        lanes(partner, up), lanes(partner, up + imaginary),
    )  # fmt: skip


@named_njit(**OPTIONS)
def elements_about(weights, of):  # type: ignore[no-untyped-def]
    """Return the matrix elements of the direction s between (n, m) and its neighbours.

    n is the degree, m the order of a partial wave. The elements are for eight degrees n at a time,
    in the order of the emitted gradients' arguments. `of` is the entry of (m, n) in
    `Weights.elements`.
    """
    table, size, below = weights.elements, weights.size, of - weights.stride
    return (
        lanes(table, _ALONG * size + of), lanes(table, _ALONG * size + of + 1),
        lanes(table, _WITHIN * size + of),
        lanes(table, _RAISED * size + below - 1), lanes(table, _TURNED * size + below),
        lanes(table, _LOWERED * size + below + 1),
        lanes(table, _RAISED * size + of), lanes(table, _TURNED * size + of),
        lanes(table, _LOWERED * size + of),
    )  # fmt: skip


@named_njit(**OPTIONS)
def force_and_gradient_sum(light, weights, wavenumber, found):  # type: ignore[no-untyped-def]
    """Add the force that one component of the light exerts, and its gradient, to `found`.

    The force is added to found[0:3], in 4 pi^2 n_m P/c (refractive index of the medium, power). The
    gradient dF_i/dx_j is added to found[6:15], row by row, in this unit per m. `light` are the
    component's `Waves`, and `wavenumber` is k (1/m).
    """
    sphere, stride = weights.sphere, weights.stride
    middle = weights.size // stride // 2
    x, y, z = spread(0.0), spread(0.0), spread(0.0)
    xx, xy, xz = spread(0.0), spread(0.0), spread(0.0)
    yx, yy, yz = spread(0.0), spread(0.0), spread(0.0)
    zx, zy, zz = spread(0.0), spread(0.0), spread(0.0)
    for m in range(max(light.first - 1, -middle), min(light.last + 1, middle) + 1):
        row = light.begin + (m - light.first) * stride
        elements = stride + LANES + (m + middle) * stride
        for block in range(abs(m) // LANES * LANES, stride, LANES):
            n = LANES + block
            at_n = (
                lanes(sphere, _U_RE * stride + n), lanes(sphere, _U_IM * stride + n),
                lanes(sphere, _U_RE * stride + n - 1), lanes(sphere, _U_IM * stride + n - 1),
                lanes(sphere, _V_RE * stride + n), lanes(sphere, _V_IM * stride + n),
            )  # fmt: skip
            a, b, c, aa, ab, ac, ba, bb, bc, ca, cb, cc = waves.force_and_gradient_summand(
                *neighbours(light, row + block, stride), *at_n,
                *elements_about(weights, elements + block),
            )  # fmt: skip
            x, y, z = x + a, y + b, z + c
            xx, xy, xz = xx + aa, xy + ab, xz + ac
            yx, yy, yz = yx + ba, yy + bb, yz + bc
            zx, zy, zz = zx + ca, zy + cb, zz + cc
    found[0] += total(x)
    found[1] += total(y)
    found[2] += total(z)
    for i, row_sums in enumerate(((xx, xy, xz), (yx, yy, yz), (zx, zy, zz))):
        for j, value in enumerate(row_sums):
            found[6 + 3 * i + j] += wavenumber * total(value)


@named_njit(**OPTIONS)
def moment_sum(light, weights, wavenumber, found):  # type: ignore[no-untyped-def]
    """Add the torque that one component of the light exerts, and the power that the bead absorbs.

    The torque is added to found[3:6], in 4 pi^2 n_m P/c times m (refractive index of the medium,
    power). The absorbed power is added to found[24], in 4 pi^2 P. `light` are the component's
    `Waves`, and `wavenumber` is k (1/m).
    """
    P, imaginary = light.own, light.imaginary
    table, sphere, stride, size = weights
    middle = size // stride // 2
    x, y, z, lost = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for m in range(light.first, light.last + 1):
        row = light.begin + (m - light.first) * stride
        elements = stride + LANES + (m + middle) * stride
        for block in range(abs(m) // LANES * LANES, stride, LANES):
            at, up = row + block, row + block + stride
            a, b, c, d = waves.moment_summand(
                lanes(P, at), lanes(P, at + imaginary), lanes(P, up), lanes(P, up + imaginary),
                lanes(sphere, _K * stride + LANES + block), float(m),
                lanes(table, _LIFT * size + elements + block),
            )  # fmt: skip
            x, y, z, lost = x + a, y + b, z + c, lost + d
    found[3] += total(x) / wavenumber
    found[4] += total(y) / wavenumber
    found[5] += total(z) / wavenumber
    found[ABSORBED] += total(lost)


@named_njit(**OPTIONS)
def moment_gradient_sum(light, weights, found):  # type: ignore[no-untyped-def]
    """Add the gradient of the torque that one component of the light exerts to found[15:24].

    It is dM_i/dx_j, row by row, in 4 pi^2 n_m P/c (refractive index of the medium, power). `light`
    are the component's `Waves`.
    """
    stride, size = weights.stride, weights.size
    middle = size // stride // 2
    xx, xy, xz = spread(0.0), spread(0.0), spread(0.0)
    yx, yy, yz = spread(0.0), spread(0.0), spread(0.0)
    zx, zy, zz = spread(0.0), spread(0.0), spread(0.0)
    for m in range(max(light.first - 1, -middle), min(light.last + 1, middle) + 1):
        row = light.begin + (m - light.first) * stride
        elements = stride + LANES + (m + middle) * stride
        for block in range(abs(m) // LANES * LANES, stride, LANES):
            of = elements + block
            at_n = (
                lanes(weights.sphere, _K * stride + LANES + block), float(m),
                lanes(weights.elements, _LIFT * size + of - stride),
                lanes(weights.elements, _LIFT * size + of),
            )  # fmt: skip
            aa, ab, ac, ba, bb, bc, ca, cb, cc = waves.moment_gradient_summand(
                *neighbours(light, row + block, stride), *at_n, *elements_about(weights, of)
            )
            xx, xy, xz = xx + aa, xy + ab, xz + ac
            yx, yy, yz = yx + ba, yy + bb, yz + bc
            zx, zy, zz = zx + ca, zy + cb, zz + cc
    for i, row_sums in enumerate(((xx, xy, xz), (yx, yy, yz), (zx, zy, zz))):
        for j, value in enumerate(row_sums):
            found[15 + 3 * i + j] += total(value)


@named_njit(**OPTIONS)
def both_sides(handedness, found):  # type: ignore[no-untyped-def]
    """Change the sums of one polarised state into a mean over it and its mirror image, y -> -y.

    `found` (25,) are force, torque, their gradients row by row, and absorbed power. With the
    `handedness` h, the state has the share (1 + h)/2 and its mirror image (1 - h)/2. Numbers that
    change their sign in the mirror are multiplied by h. These are the force along y, the torque (an
    axial vector) along x and z, and their derivatives over x and z. For the other numbers the
    derivatives over y are multiplied.
    """
    for i in range(3):
        odd = i == 1
        if odd:
            found[i] *= handedness
        else:
            found[3 + i] *= handedness
        for j in range(3):
            if odd != (j == 1):
                found[6 + 3 * i + j] *= handedness
            else:
                found[15 + 3 * i + j] *= handedness


class Room(NamedTuple):
    """Arrays for intermediate results, made once for all beads of a call."""

    bessel: Any
    """Bessel functions J_v times `norm`, flattened (orders v, nodes); for an uneven pupil the
    orders A_v, see `grid.azimuthal_orders`"""
    norm: Any
    """(nodes,) unknown factor of the Bessel functions, see `partial_waves.bessel_functions`"""
    re: Any
    """(nodes,) real parts of the plane waves of a part of the light, over `norm`"""
    im: Any
    """(nodes,) their imaginary parts"""
    work: Any
    """(2 nodes,) plane waves times Bessel functions of one order: real, then imaginary parts"""
    waves: Any
    """(2 components, real and imaginary parts) amplitudes P_nm"""
    found: Any
    """(25,) of one state: force, torque, their gradients, absorbed power"""


@named_njit(**OPTIONS)
def room_for(source):  # type: ignore[no-untyped-def]
    """Return the `Room` for the largest of the rules of a `Source`."""
    nodes = int(source.rules[-1, PADDED])
    return room_of(source, (begin(source.rules[-1, PHASE]) + 3) * nodes)


@named_njit(**OPTIONS)
def room_of(source, size):  # type: ignore[no-untyped-def]
    """Return the `Room` with a number of entries of the azimuthal functions."""
    nodes = int(source.rules[-1, PADDED])
    orders, stride = 2 * source.highest + 1, source.highest + 1
    return Room(
        np.empty(size), np.empty(nodes), np.zeros(nodes), np.zeros(nodes), np.empty(2 * nodes),
        # with two rows of zeros before and after all orders, and a guard before and after it all
        np.empty((2, 2 * (orders + 4) * stride + 2 * LANES)), np.empty(FOUND),
    )  # fmt: skip


@functools.cache
def _room(*, uneven: bool) -> Any:
    """Return the compiled function that makes the `Room` of a `Source` and its data."""

    @named_njit(**OPTIONS)
    def room_with(source, data):  # type: ignore[no-untyped-def]
        """Return the `Room` for the largest of the rules of a `Source`."""
        if uneven:
            return room_of(source, size_of(grid_of(data, SOURCE), int(source.rules[-1, PADDED])))
        return room_for(source)

    return room_with


@functools.cache
def _summed(*, moment: bool, uneven: bool) -> Any:
    """Return the compiled function that fills `sums` for a bead at (rho, 0, z).

    With `moment` it computes moments and the absorbed power in addition to the force. For an
    `uneven` pupil, sums and bead are in the frame of the scene instead. Its argument
    `gradient` selects gradients: the sums with and without them share the waves.
    """

    @named_njit(**OPTIONS)
    def add_up(  # type: ignore[no-untyped-def]
        data, source, gradient, rule, rho, z, azimuth, room, sums
    ):
        """Fill `sums` (25,) with the sums over all states of the light, ordered as `found`.

        `data` belongs to the kernel and contains the `source`. `rule` is the number of the rule of
        nodes. The bead is at `rho` and `z` (m), and `azimuth` is (cos, sin) of its azimuth in the
        scene. `room` is a `Room`. With `gradient` the gradients are summed too.
        """
        states = matrix(data, STATES)
        elements, spheres = vector(data, ELEMENTS), matrix(data, SPHERE)
        stride = source.highest + 1
        size = (2 * source.highest + 1) * stride
        P, found = room.waves, room.found
        if uneven:
            grid = grid_of(data, SOURCE)
            azimuthal_orders(source, grid, rule, rho * azimuth[0], rho * azimuth[1], room.bessel)
            room.norm[:] = 1.0
            most = grid.most
        else:
            most = bessel_functions(source, rule, rho, room.bessel, room.norm)
        sums[:] = 0.0
        for state in range(states.shape[0]):
            first = max(int(states[state, LOWEST]) - most, -source.highest)
            last = min(int(states[state, HIGHEST]) + most, source.highest)
            if first > last:
                continue  # the light has only orders m too high for the sphere to scatter
            components = int(states[state, COMPONENTS])
            imaginary = (last - first + 5) * stride
            # two components are the helicities +1 and -1 until they are combined below
            for k in range(components):
                P[k, : 2 * imaginary + 2 * LANES] = 0.0
            for part in range(int(states[state, BEGIN]), int(states[state, END])):
                plane_waves(source, rule, part, z, room.norm, room.re, room.im)
                k = 1 if source.parts[part, HELICITY] < 0 else 0
                out = P[k, LANES : LANES + 2 * imaginary]
                if uneven:
                    add_uneven_part(source, grid, rule, part, room, first - 2, out)
                else:
                    add_part(source, rule, part, azimuth, most, room, first - 2, out)
            if components == 2:
                electric_and_magnetic(P, 2 * imaginary + LANES)
            found[:] = 0.0
            for k in range(components):
                light = Waves(
                    P[k], P[components - 1 - k], imaginary, first, last, 2 * stride + LANES
                )
                weights = Weights(elements, spheres[k], stride, size)
                if gradient:
                    force_and_gradient_sum(light, weights, source.wavenumber, found)
                else:
                    force_sum(light, weights, found)
                if moment:
                    moment_sum(light, weights, source.wavenumber, found)
                    if gradient:
                        moment_gradient_sum(light, weights, found)
            both_sides(states[state, HANDEDNESS], found)
            for i in range(FOUND):
                sums[i] += states[state, SHARE] * found[i]

    return add_up


@functools.cache
def waves_kernel(*, moment: bool, uneven: bool) -> Kernel:
    """Return the kernel that adds the force of the light, by sums over partial waves.

    It adds the torque if `moment`, and gradients if the wrench has arrays for them. The data of an
    `uneven` pupil contain a `Grid`. The error of a
    bead too far from the focus for every rule is infinite.
    """
    add_up, room_with = _summed(moment=moment, uneven=uneven), _room(uneven=uneven)

    @cached_njit(KERNEL, error_model="numpy", nogil=True)
    def add_force_of_waves(pose, data, wrench):  # type: ignore[no-untyped-def]
        """Add the force of the light, as a kernel: sums for each bead, turned to its azimuth."""
        strength = number(data, STRENGTH)
        tolerance, floor = number(data, TOLERANCE), number(data, FLOOR)
        source = source_of(data, SOURCE)
        room = room_with(source, data)
        sums, gradient = np.empty(FOUND), len(wrench.force_gradient) > 0
        for at in range(pose.position.shape[0]):
            x, y, z = pose.position[at, 0], pose.position[at, 1], pose.position[at, 2]
            rho = math.hypot(x, y)
            azimuth = (1.0, 0.0)
            if rho > 0.0:
                azimuth = (x / rho, y / rho)
            rule = rule_for(source, rho, z)
            if rule < 0:
                wrench.error[at] = math.inf
                continue
            add_up(data, source, gradient, rule, rho, z, azimuth, room, sums)
            for i in range(FOUND):
                sums[i] *= strength
            size = math.sqrt(sums[0] ** 2 + sums[1] ** 2 + sums[2] ** 2)
            wrench.error[at] += tolerance * size + floor
            if uneven:
                azimuth = (1.0, 0.0)
            put(sums, azimuth[0], azimuth[1], gradient, moment, at, wrench)

    return add_force_of_waves


@functools.cache
def absorption(*, uneven: bool) -> Any:
    """Return the compiled function of the share of the light's power that a bead absorbs, (n,).

    Its arguments are positions (n, 3), m, and the data of `waves_kernel`. The share is NaN where a
    bead is too far from the focus for every rule.
    """
    add_up, room_with = _summed(moment=True, uneven=uneven), _room(uneven=uneven)

    @cached_njit(ABSORPTION, error_model="numpy", nogil=True)
    def absorbed(positions, data):  # type: ignore[no-untyped-def]
        """Return the share of the light's power that beads at positions (n, 3), m, absorb, (n,)."""
        source = source_of(data, SOURCE)
        room = room_with(source, data)
        sums, out = np.empty(FOUND), np.empty(positions.shape[0])
        unit = number(data, STRENGTH) / number(data, OF_ALL)
        for at in range(positions.shape[0]):
            x, y, z = positions[at, 0], positions[at, 1], positions[at, 2]
            rho = math.hypot(x, y)
            azimuth = (1.0, 0.0)
            if rho > 0.0:
                azimuth = (x / rho, y / rho)
            rule = rule_for(source, rho, z)
            out[at] = math.nan
            if rule >= 0:
                add_up(data, source, False, rule, rho, z, azimuth, room, sums)
                out[at] = unit * sums[ABSORBED]
        return out

    return absorbed


@named_njit(**OPTIONS)
def electric_and_magnetic(P, count):  # type: ignore[no-untyped-def]
    """Replace amplitudes p^+, p^- of helicity +1 and -1 by electric and magnetic ones.

    The rows of `P` (2, count or more) become (p^+ + p^-)/sqrt(2) and (p^+ - p^-)/sqrt(2).
    """
    half = math.sqrt(0.5)
    for i in range(count):
        plus, minus = P[0, i], P[1, i]
        P[0, i] = half * (plus + minus)
        P[1, i] = half * (plus - minus)
