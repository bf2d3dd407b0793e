"""The motion of two coupled beads, as a distance, a direction and a place that do not mix.

The mobility of two spheres depends on their distance rho alone. With n from bead 1 to bead 2,
opposite forces move the beads apart with the mobility a along n and b across it. The distance obeys

    d rho = [a f + kT (a' + 2 a/rho)] dt + sqrt(2 kT a) dB,

which is the equation of a gap beside a wall with the force f + 2 kT/rho. So the gap g is a function
of the length of a vector W in a plane, R = int_0^g dg/sqrt(2 kT a), and W has constant noise:

    dW = [S (f + 2 kT/rho) + T] W dt + dB,
    S = sqrt(a/2kT)/R,   T = [kT a'/sqrt(8 kT a) - 1/2R]/R.

Lubrication, a ~ g, keeps T finite at contact. No step crosses the contact.

The other coordinates are n and the place X = c - n phi(rho), with the centre c of the beads,
phi' = m/a and m = (x22 - x11)/2, the mobility of c by opposite forces along n. The noise of X along
n does not depend on that of rho. Across n, X follows r by gamma = (m_y - phi b/rho)/b, with
m_y = (y22 - y11)/2. For equal beads, X is the centre and gamma is 0.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from tweezer.beads.scalars import Scalars
from tweezer.compiled import named_njit
from tweezer.values.arrays import Array

#: Smallest and largest gap of the tables over the sum of the radii, and intervals
_LEAST, _MOST, _PIECES = 1e-7, 1e4, 1500
#: Columns of the tables: the other coordinate (logarithm of R or of the gap), S, T, b over rho^2,
#: gamma, mobilities of X along and across n, phi, phi', b
OTHER, S, T, TURN, GAMMA, ALONG, ACROSS, PHI, SLOPE, B = range(10)


class Plane(NamedTuple):
    """Tables of the functions of a step, as cubic polynomials on even intervals."""

    kT: float
    """thermal energy, J"""
    total: float
    """sum of the radii, m"""
    by_gap: Array
    """(pieces, 4, 10) over the logarithm of the gap, m"""
    by_length: Array
    """(pieces, 4, 10) over the logarithm of R"""
    ends: Array
    """(4,): first argument and 1/interval, of both tables"""


def plane_of(scalars: Scalars, kT: float) -> Plane:
    """Return the tables for two beads.

    Parameters
    ----------
    scalars : Scalars
        Mobilities of the two beads.
    kT : float
        Thermal energy, J.
    """
    total = scalars.radii[0] + scalars.radii[1]
    u = np.linspace(math.log(_LEAST * total), math.log(_MOST * total), _PIECES + 1)
    gap = np.exp(u)
    of = scalars.at(gap)
    a, slope, b = of.relative_x, of.slope_x, of.relative_y
    by_log = CubicSpline(u, gap / np.sqrt(2 * kT * a))
    # below the first gap a is proportional to g
    R = 2 * gap[0] / math.sqrt(2 * kT * a[0]) + by_log.antiderivative()(u)
    m = 0.5 * (of.x22 - of.x11)
    turned = CubicSpline(u, gap * m / a).antiderivative()
    phi = m[0] / a[0] * gap[0] + turned(u)
    rho = total + gap
    root = np.sqrt(2 * kT * a)
    gamma = (0.5 * (of.y22 - of.y11) - phi * b / rho) / b
    mean_x, mean_y = ((s11 + s22 + 2 * s12) / 4 for s11, s22, s12 in (
        (of.x11, of.x22, of.x12), (of.y11, of.y22, of.y12),
    ))  # fmt: skip
    across = mean_y - (0.5 * (of.y22 - of.y11)) ** 2 / b
    columns = np.stack([
        np.log(R), np.sqrt(a / (2 * kT)) / R, (0.5 * kT * slope / root - 0.5 / R) / R, b / rho**2,
        gamma, mean_x - m**2 / a, across, phi, m / a, b,
    ], axis=1)  # fmt: skip
    v = np.linspace(columns[0, OTHER], columns[-1, OTHER], _PIECES + 1)
    at = CubicSpline(columns[:, OTHER], u)(v)
    again = CubicSpline(u, columns)(at)
    again[:, OTHER] = at
    ends = np.array([u[0], 1 / (u[1] - u[0]), v[0], 1 / (v[1] - v[0])])
    return Plane(kT, total, _pieces(u, columns), _pieces(v, again), ends)


def _pieces(knots: Array, columns: Array) -> Array:
    """Return the cubics over fractions of even intervals, (pieces, 4, columns), highest first."""
    step = knots[1] - knots[0]
    found = CubicSpline(knots, columns).c * (step ** np.arange(3, -1, -1))[:, None, None]
    return np.ascontiguousarray(found.transpose(1, 0, 2))


@named_njit(inner=True, error_model="numpy")
def read(table, first, per, argument, found):  # type: ignore[no-untyped-def]
    """Fill found (10,) from a table at an argument; outside, the first column goes on linearly."""
    place = (argument - first) * per
    piece = min(max(int(place), 0), table.shape[0] - 1)
    x = min(max(place - piece, 0.0), 1.0)
    for j in range(table.shape[2]):
        found[j] = ((table[piece, 0, j] * x + table[piece, 1, j]) * x + table[piece, 2, j]) * x
        found[j] += table[piece, 3, j]
    beyond = place - piece - x
    if beyond != 0.0:
        slope = (3.0 * table[piece, 0, 0] * x + 2.0 * table[piece, 1, 0]) * x + table[piece, 2, 0]
        found[0] += beyond * slope
