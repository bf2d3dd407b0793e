"""Forces on several beads: light and weight of each, and forces between them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import cached_njit, call, named_njit
from tweezer.forces.chains import tension
from tweezer.forces.data import Data, part
from tweezer.forces.force import Pose, Wrench, clear
from tweezer.values.arrays import Array

#: Laws of force over the gap of two surfaces
SPRING, DLVO, WCA, HERTZ, CHAIN = range(5)
#: Numbers of a law
PARAMETERS = 4
#: Gap below which the van der Waals attraction of smooth surfaces does not grow, m
CLOSEST = 0.165e-9


class Acting(NamedTuple):
    """Forces on the beads, as compiled loops read them."""

    light: Data
    """a part for each bead: the force of all beams on it"""
    weight: Array
    """(beads, 3) N, weight less buoyancy"""
    radius: Array
    """(beads,) m"""
    ends: NDArray[np.int64]
    """(bonds, 2) beads of each bond; the second is -1 for a bond to a point"""
    points: Array
    """(bonds, 3) m, the points of such bonds"""
    laws: NDArray[np.int64]
    """(bonds,) law of each bond"""
    parameters: Array
    """(bonds, 4) its parameters: those of `surface_force`, or the first row of the table of a
    chain and the row after its last"""
    chains: Array
    """(rows, 5) tables of all chains: see `tweezer.forces.chains.tension`"""


@named_njit(inner=True, error_model="numpy")
def surface_force(law, p, gap):  # type: ignore[no-untyped-def]
    """Return the force between two surfaces at a gap, N, positive if it pulls them together.

    The parameters p depend on the law, with the reduced radius a_e:

    * spring: stiffness, and length at rest
    * DLVO: energy B, Debye length, and A_H a_e/6
    * WCA: energy and range
    * Hertz: 4/3 E* sqrt(a_e), and the gap at which the layers touch
    """
    if law == SPRING:
        return p[0] * (gap - p[1])
    if law == DLVO:
        near = max(gap, CLOSEST)
        return p[2] / (near * near) - p[0] / p[1] * math.exp(-gap / p[1])
    if law == WCA:
        s = gap + p[1]
        if s > 2.0 ** (1.0 / 6.0) * p[1]:
            return 0.0
        sixth = (p[1] / s) ** 6
        return -24.0 * p[0] * sixth * (2.0 * sixth - 1.0) / s
    into = p[1] - gap
    return -p[0] * into * math.sqrt(into) if into > 0.0 else 0.0


@named_njit(inner=True, error_model="numpy")
def bond(acting, k, x, i, toward):  # type: ignore[no-untyped-def]
    """Return the tension of a bond k in the copy i, N; fill `toward` (3,) from its first end.

    x: (copies, beads, 3) m. `toward` is the unit vector from the first bead to the other end.
    """
    a, b = acting.ends[k]
    distance = 0.0
    for j in range(3):
        end = acting.points[k, j] if b < 0 else x[i, b, j]
        toward[j] = end - x[i, a, j]
        distance += toward[j] * toward[j]
    distance = math.sqrt(distance)
    gap = distance - acting.radius[a]
    if b >= 0:
        gap -= acting.radius[b]
    for j in range(3):
        toward[j] = toward[j] / distance if distance > 0.0 else 0.0
    law, p = acting.laws[k], acting.parameters[k]
    if law == CHAIN:
        return tension(gap, acting.chains[int(p[0]) : int(p[1])])[0]
    return surface_force(law, p, gap)


@cached_njit(error_model="numpy", nogil=True)
def add_forces(acting, time, x, f):  # type: ignore[no-untyped-def]
    """Fill f (copies, beads, 3) N with the forces on beads at x (copies, beads, 3) m.

    time: s.
    """
    copies, beads = x.shape[:2]
    times, place = np.full(copies, time), np.empty((copies, 3))
    wrench = Wrench(
        np.empty((copies, 3)), np.empty((copies, 3)), np.empty((0, 3, 3)), np.empty((0, 3, 3)),
        np.empty(copies),
    )  # fmt: skip
    turned, driven = np.empty((0, 4)), np.empty((0, 3))
    for k in range(beads):
        place[:] = x[:, k]
        clear(wrench)
        light = part(acting.light, k)
        call(light.kernel, (Pose(times, place, turned, driven), light.data, wrench))
        for i in range(copies):
            for j in range(3):
                f[i, k, j] = wrench.force[i, j] + acting.weight[k, j]
    toward = np.empty(3)
    for k in range(acting.laws.size):
        a, b = acting.ends[k]
        for i in range(copies):
            pull = bond(acting, k, x, i, toward)
            for j in range(3):
                f[i, a, j] += pull * toward[j]
                if b >= 0:
                    f[i, b, j] -= pull * toward[j]


@cached_njit(error_model="numpy")
def tensions(acting, x, found):  # type: ignore[no-untyped-def]
    """Add to found (n, pairs) N the force between each two beads at x (n, beads, 3) m."""
    beads = x.shape[1]
    toward = np.empty(3)
    for k in range(acting.laws.size):
        a, b = min(acting.ends[k]), max(acting.ends[k])
        if a >= 0:
            pair = a * beads - a * (a + 1) // 2 + b - a - 1
            for i in range(x.shape[0]):
                found[i, pair] += bond(acting, k, x, i, toward)
