"""Coordinates of a force table, in which the force is smooth up to the edges; and its reader.

Lengths are in radii of the bead, forces in n_m P/c: the force of axisymmetric light is then a
function of the bead's polar coordinates (d, gamma) in the meridional plane alone. It is analytic
but for

* the circle d = 1 between gamma = a and b, pi/2 -+ theta_m: the plane through the focus across the
  line to the bead then holds rays of the cone, and F goes like w^2 log(w), w^2 = |1 - d^2|;
* the lines where the bead touches a ray of the rim. Seen from the focus, a bead outside it covers a
  cone; the rays in the band between p + pi/2 and q + pi/2 miss it, p, q = gamma -+ arccos(1/d). It
  touches the rim where p or q is one of a, b or their mirror images -a and pi + a. There F is
  singular as a power 5/2.

So there are four charts (x, y), cut along these lines into rectangular blocks:

    core      d < CORE                 x = rho^2, y = z
    ring      CORE < d < 1             x = w, y = cos(gamma)
    outer     d > 1                    x = P, y = Q
    triangle  d > 1, |P|, |Q| < tau    x = (Q - P)/(2 tau - |y|), y = P + Q

P = tan((p - pi/2)/2) and Q = tan((q - pi/2)/2) need no trigonometry; tau = tan(theta_m/2). With
rho and z, and w = tan(arccos(1/d)),

    P = -(z + rho w)/(d^2 + rho - z w),    Q = -(z - rho w)/(d^2 + rho + z w).

The triangle lies between the circle (x = 0) and the lines p = a and q = b (x = 1). Its width
vanishes in y towards the end points of the arc, where the lines touch the circle. On the ring and
the triangle F is even in x; on the outer chart it is symmetric in P and Q. Functions of rho^2
continue across the axis, (P, Q) -> (1/Q, 1/P).

A block is bisected into pieces along x or y until the tolerance is met. On each piece F_rho/rho,
F_z (and the moment M_phi/rho) are polynomials of degree 7 in x and in y.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import cached_njit
from tweezer.forces.data import integers, matrix, number, part
from tweezer.forces.force import KERNEL, Kernel
from tweezer.optics.beyond import add_one

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Coefficients of a polynomial along x and along y; the kernel's loops are unrolled for this number
ORDER = 8
#: Radius of the core, in bead radii
CORE = 0.6
#: Numbers at the head of a piece: centre and 1/half-width along x, then along y
HEAD = 4

(CORE_CHART, RING, OUTER, TRIANGLE) = range(4)

#: Blocks of the triangle, y < 0 and y > 0
_TRIANGLES = (4, 17)

#: Positions whose pieces the kernel finds in one batch
_BATCH = 64
#: Lower bound on w. Keeps dw/dd finite at d = 1; changes the force by less than 1e-14
_LEAST_W = 1e-8
#: Lower bound on 1/d at nodes outside the table's range
_LEAST_COSINE = 1e-3
#: Index entry without a piece
NO_PIECE = -1


class Blocks(NamedTuple):
    """The blocks of all charts."""

    chart: Integers
    """(n,)"""
    bounds: Array
    """(n, 4): x from, to, y from, to"""


def blocks(half_angle: float, reach: float) -> Blocks:
    """The blocks for a cone of light of that half angle (rad), out to `reach` radii.

    Block 0 is the core, 1 to 3 the ring, and 5 + 5 i + j the part of the outer chart between lines
    i and i + 1 of P, and j and j + 1 of Q. The one between -tau and tau twice is the triangle
    instead: its half y > 0; the other is block 4.
    """
    sine, tau = math.sin(half_angle), math.tan(half_angle / 2)
    farthest = max(math.tan((math.pi / 2 + math.acos(1 / max(reach, 1.0))) / 2), 1.5 / tau)
    across = [-1.0, -sine, sine, 1.0]
    lines = [-farthest, -1 / tau, -tau, tau, 1 / tau, farthest]
    parts = [
        (0.0, CORE**2, -CORE, CORE),
        *((0.0, math.sqrt(1 - CORE**2), *across[i : i + 2]) for i in range(3)),
        (0.0, 1.0, -2 * tau, 0.0),
        *((*lines[i : i + 2], *lines[j : j + 2]) for i in range(5) for j in range(5)),
    ]
    parts[_TRIANGLES[1]] = (0.0, 1.0, 0.0, 2 * tau)
    chart = np.array([CORE_CHART, *[RING] * 3, *[OUTER] * 26])
    chart[list(_TRIANGLES)] = TRIANGLE
    return Blocks(chart, np.array(parts))


def places(chart: Integers, x: Array, y: Array, half_angle: float) -> tuple[Array, Array]:
    """(rho, z) at coordinates x, y (n, ...) of charts (n,), also beyond the axis and w = 0."""
    rho, z = np.empty(x.shape), np.empty(x.shape)
    for each in range(4):
        on = chart == each
        rho[on], z[on] = _places(each, x[on], y[on], half_angle)
    return rho, z


def _places(chart: int, x: Array, y: Array, half_angle: float) -> tuple[Array, Array]:
    if chart == CORE_CHART:
        return np.sqrt(x), y
    if chart == RING:
        d = np.sqrt((1 - x) * (1 + x))
        return d * np.sqrt((1 - y) * (1 + y)), d * y
    if chart == TRIANGLE:
        difference = x * (2 * math.tan(half_angle / 2) - np.abs(y))
        x, y = (y - difference) / 2, (y + difference) / 2
    p, q = math.pi / 2 + 2 * np.arctan(x), math.pi / 2 + 2 * np.arctan(y)
    gamma, eta = (p + q) / 2, (q - p) / 2
    d = 1 / np.maximum(np.cos(eta), _LEAST_COSINE)
    return np.abs(d * np.sin(gamma)), d * np.cos(gamma)


def beyond(chart: Integers, bounds: Array, reach: float) -> NDArray[np.bool_]:
    """Whether `bounds` (n, 4) lie out of reach, by more than rounding, (n,)."""
    slack = 1e-9
    x0, x1, y0, y1 = bounds.T
    nearest = np.where(y0 * y1 <= 0, 0.0, np.minimum(y0**2, y1**2))
    off_core = x0 + nearest > min(CORE, reach) ** 2 + slack
    off_ring = (1 - x1) * (1 + x1) > reach**2 + slack
    p0, p1, q0, q1 = math.pi / 2 + 2 * np.arctan(bounds.T)
    past_an_axis = (p1 + q1 < -slack) | (p0 + q0 > 2 * math.pi + slack)
    past_the_circle = q1 <= p0 + slack
    eta = math.acos(1 / max(reach, 1.0))
    off_outer = past_an_axis | past_the_circle | (q0 - p1 > 2 * eta + slack)
    return np.select(
        [chart == CORE_CHART, chart == RING, chart == OUTER],
        [off_core, off_ring, off_outer | (reach < 1)],
        reach < 1,
    )


@cached_njit(
    error_model="numpy",
    nogil=True,
    inline="always",
    fastmath={"reassoc", "contract", "nsz"},
)
def _chart_of(rho, z, dd, sine, tau):  # type: ignore[no-untyped-def]
    """Block of a position, its coordinates there, and dx/drho, dx/dz, dy/drho, dy/dz."""
    if dd < CORE * CORE:
        return 0, rho * rho, z, 2.0 * rho, 0.0, 0.0, 1.0
    if dd < 1.0:
        w = max(math.sqrt(1.0 - dd), _LEAST_W)
        over_d = 1.0 / math.sqrt(dd)
        y = z * over_d
        cube = over_d * over_d * over_d
        block = 1 + (y >= -sine) + (y >= sine)
        per_w = 1.0 / w
        return block, w, y, -rho * per_w, -z * per_w, -rho * z * cube, rho * rho * cube
    w = max(math.sqrt(dd - 1.0), _LEAST_W)
    below_p, below_q = dd + rho - z * w, dd + rho + z * w
    shared = -1.0 / (below_p * below_q)
    P = (z + rho * w) * below_q * shared
    Q = (z - rho * w) * below_p * shared
    # dP = (1 + P^2)/2 dp, where p = gamma - eta and q = gamma + eta
    half_dd, per_w = 0.5 / dd, 1.0 / w
    by_p, by_q = (1.0 + P * P) * half_dd, (1.0 + Q * Q) * half_dd
    P_rho, P_z = by_p * (z - rho * per_w), by_p * (-rho - z * per_w)
    Q_rho, Q_z = by_q * (z + rho * per_w), by_q * (-rho + z * per_w)
    if max(abs(P), abs(Q)) < tau:
        y = P + Q
        per_width = 1.0 / (2.0 * tau - abs(y))
        x = min((Q - P) * per_width, 1.0)
        turn = x if y >= 0.0 else -x
        y_rho, y_z = P_rho + Q_rho, P_z + Q_z
        x_rho = (Q_rho - P_rho + turn * y_rho) * per_width
        x_z = (Q_z - P_z + turn * y_z) * per_width
        return _TRIANGLES[1] if y >= 0.0 else _TRIANGLES[0], x, y, x_rho, x_z, y_rho, y_z
    i = j = 0
    for line in (-1.0 / tau, -tau, tau, 1.0 / tau):
        i += line <= P
        j += line <= Q
    return 5 + 5 * i + j, P, Q, P_rho, P_z, Q_rho, Q_z


@cached_njit(
    error_model="numpy",
    nogil=True,
    inline="always",
    fastmath={"reassoc", "contract", "nsz"},
)
def _piece_of(block, x, y, frames, roots, index):  # type: ignore[no-untyped-def]
    """Number of the piece at (x, y), or `NO_PIECE`.

    An index entry is the number of a piece, or -2 - (64 start + 8 bits_x + bits_y) for a page: a
    grid of 2^bits_x by 2^bits_y entries over the same rectangle.
    """
    along_x = (x - frames[block, 0]) * frames[block, 1]
    along_y = (y - frames[block, 2]) * frames[block, 3]
    entry = np.int64(roots[block])
    while entry < NO_PIECE:
        page = -2 - entry
        cells_x, cells_y = 1 << ((page >> 3) & 7), 1 << (page & 7)
        along_x *= cells_x
        along_y *= cells_y
        i = min(max(np.int64(along_x), 0), cells_x - 1)
        j = min(max(np.int64(along_y), 0), cells_y - 1)
        along_x -= i
        along_y -= j
        entry = np.int64(index[(page >> 6) + i * cells_y + j])
    return entry


@cached_njit(error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "nsz"})
def find(positions, half_angle, reach, frames, roots, index, piece_out, place_out):  # type: ignore[no-untyped-def]
    """Pieces and coordinates of positions (n, 3), in radii, in a table.

    piece_out: (n,) number of the piece, or `NO_PIECE`. place_out: (n, 7) rho, x, y, and dx/drho,
    dx/dz, dy/drho, dy/dz.
    """
    sine, tau = math.sin(half_angle), math.tan(half_angle / 2.0)
    for at in range(positions.shape[0]):
        x1, x2, z = positions[at, 0], positions[at, 1], positions[at, 2]
        squared = x1 * x1 + x2 * x2
        dd = squared + z * z
        piece_out[at] = NO_PIECE
        if dd <= reach * reach:
            rho = math.sqrt(squared)
            block, x, y, x_rho, x_z, y_rho, y_z = _chart_of(rho, z, dd, sine, tau)
            piece_out[at] = _piece_of(block, x, y, frames, roots, index)
            place_out[at, 0], place_out[at, 1], place_out[at, 2] = rho, x, y
            place_out[at, 3], place_out[at, 4] = x_rho, x_z
            place_out[at, 5], place_out[at, 6] = y_rho, y_z


@cached_njit(
    error_model="numpy",
    nogil=True,
    inline="always",
    fastmath={"reassoc", "contract", "nsz"},
)
def _sum(c, i, y):  # type: ignore[no-untyped-def]
    """c[i] + c[i + 1] y + ... + c[i + 7] y^7."""
    yy = y * y
    low = (c[i] + c[i + 1] * y) + (c[i + 2] + c[i + 3] * y) * yy
    return low + ((c[i + 4] + c[i + 5] * y) + (c[i + 6] + c[i + 7] * y) * yy) * (yy * yy)


@cached_njit(
    error_model="numpy",
    nogil=True,
    inline="always",
    fastmath={"reassoc", "contract", "nsz"},
)
def _slope(c, i, y):  # type: ignore[no-untyped-def]
    """Derivative of `_sum` over y."""
    yy = y * y
    low = (c[i + 1] + 2.0 * c[i + 2] * y) + (3.0 * c[i + 3] + 4.0 * c[i + 4] * y) * yy
    return low + (5.0 * c[i + 5] + 6.0 * c[i + 6] * y + 7.0 * c[i + 7] * yy) * (yy * yy)


@functools.cache
def kernel(*, gradient: bool, moment: bool) -> Kernel:
    """The kernel that reads a table, compiled without the parts that a scene does not need.

    Its data are the radius (m); the cone's half angle (rad); the range (radii); n_m P/c (N), the
    unit of force; the bound on the error of the force (N); `frames`, `roots`, `index` and `pieces`
    of `tweezer.optics.tabulate.Made`; and the force outside the range.
    """
    components = 3 if moment else 2
    width = ORDER * components

    @cached_njit(KERNEL, error_model="numpy", nogil=True, fastmath={"reassoc", "contract", "nsz"})
    def read(pose, data, wrench):  # type: ignore[no-untyped-def]
        radius, half_angle, reach = number(data, 0), number(data, 1), number(data, 2)
        strength, certified = number(data, 3), number(data, 4)
        frames, roots, index = matrix(data, 5), integers(data, 6), integers(data, 7)
        pieces = matrix(data, 8)
        positions = pose.position
        force_out, moment_out = wrench.force, wrench.moment
        force_gradient_out, moment_gradient_out = wrench.force_gradient, wrench.moment_gradient
        per_radius, stiffness = 1.0 / radius, strength / radius
        # a length known at run time only: a loop of known length would be unrolled, not vectorised
        columns = (pieces.shape[1] - HEAD) // ORDER
        # one array for each shape, as an allocation costs as much as a polynomial
        rows = np.empty((5, max(columns, 3)))
        row, row_x, value, by_x, by_y = rows[0], rows[1], rows[2], rows[3], rows[4]
        # all pieces of a batch are found first: branches that are hard to predict stay apart from
        # the polynomials
        size = min(_BATCH, positions.shape[0])
        batch, place = np.empty((size, 3)), np.empty((size, 7))
        piece_of = np.empty(size, np.int64)
        for at in range(positions.shape[0]):
            within = at % _BATCH
            if within == 0:
                many = min(_BATCH, positions.shape[0] - at)
                for i in range(many):
                    for k in range(3):
                        batch[i, k] = positions[at + i, k] * per_radius
                find(batch[:many], half_angle, reach, frames, roots, index, piece_of, place)
            piece = piece_of[within]
            if piece == NO_PIECE:
                add_one(part(data, 9), pose, at, wrench)
                continue
            wrench.error[at] += certified
            x1, x2, rho = batch[within, 0], batch[within, 1], place[within, 0]
            x, y = place[within, 1], place[within, 2]
            c = pieces[piece]
            u, v = (x - c[0]) * c[1], (y - c[2]) * c[3]
            for j in range(columns):
                i = HEAD + j
                term = c[i + 7 * width]
                slope = term
                term = term * u + c[i + 6 * width]
                slope = slope * u + term
                term = term * u + c[i + 5 * width]
                slope = slope * u + term
                term = term * u + c[i + 4 * width]
                slope = slope * u + term
                term = term * u + c[i + 3 * width]
                slope = slope * u + term
                term = term * u + c[i + 2 * width]
                slope = slope * u + term
                term = term * u + c[i + width]
                if gradient:
                    row_x[j] = slope * u + term
                row[j] = term * u + c[i]
            for k in range(components):
                value[k] = _sum(row, ORDER * k, v)
                if gradient:
                    by_x[k] = _sum(row_x, ORDER * k, v) * c[1]
                    by_y[k] = _slope(row, ORDER * k, v) * c[3]
            force_out[at, 0] += strength * value[0] * x1
            force_out[at, 1] += strength * value[0] * x2
            force_out[at, 2] += strength * value[1]
            if moment:
                moment_out[at, 0] += -strength * radius * value[2] * x2
                moment_out[at, 1] += strength * radius * value[2] * x1
            if not gradient:
                continue
            x_rho, x_z = place[within, 3], place[within, 4]
            y_rho, y_z = place[within, 5], place[within, 6]
            per_rho = 1.0 / rho if rho > 0.0 else 0.0
            cos_phi, sin_phi = x1 * per_rho, x2 * per_rho
            f = stiffness * value[0]
            f_rho = stiffness * (by_x[0] * x_rho + by_y[0] * y_rho)
            f_z = stiffness * (by_x[0] * x_z + by_y[0] * y_z)
            g_rho = stiffness * (by_x[1] * x_rho + by_y[1] * y_rho)
            force_gradient_out[at, 0, 0] += f + x1 * cos_phi * f_rho
            force_gradient_out[at, 0, 1] += x1 * sin_phi * f_rho
            force_gradient_out[at, 0, 2] += x1 * f_z
            force_gradient_out[at, 1, 0] += x2 * cos_phi * f_rho
            force_gradient_out[at, 1, 1] += f + x2 * sin_phi * f_rho
            force_gradient_out[at, 1, 2] += x2 * f_z
            force_gradient_out[at, 2, 0] += cos_phi * g_rho
            force_gradient_out[at, 2, 1] += sin_phi * g_rho
            force_gradient_out[at, 2, 2] += stiffness * (by_x[1] * x_z + by_y[1] * y_z)
            if moment:
                m = strength * value[2]
                m_rho = strength * (by_x[2] * x_rho + by_y[2] * y_rho)
                m_z = strength * (by_x[2] * x_z + by_y[2] * y_z)
                moment_gradient_out[at, 0, 0] += -x2 * cos_phi * m_rho
                moment_gradient_out[at, 0, 1] += -m - x2 * sin_phi * m_rho
                moment_gradient_out[at, 0, 2] += -x2 * m_z
                moment_gradient_out[at, 1, 0] += m + x1 * cos_phi * m_rho
                moment_gradient_out[at, 1, 1] += x1 * sin_phi * m_rho
                moment_gradient_out[at, 1, 2] += x1 * m_z

    return read
