"""Thermal motion of more than two beads.

Beads that are near each other have the mobility of `tweezer.fluid.many`, with lubrication of pairs:

    R = inv(M_far) + sum over pairs [inv(M_exact) - inv(M_far of the pair)].

Without torques, the velocities follow from the forces by the first block M of inv(R). Its
divergence gives a drift, kT div M, by random differences: with normal numbers w,

    kT div M = <kT [M(x + d w/2) - M(x - d w/2)] w/d>.

Beads that are far apart have the mobility of Rotne, Prager and Yamakawa. It has no divergence.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.beads.forces import add_forces
from tweezer.compiled import cached_njit, named_njit
from tweezer.dynamics.brownian.noise import NOISE, normals
from tweezer.fluid.pair_table import pair_table
from tweezer.generated import pair
from tweezer.values.arrays import Array

#: Gap over the largest radius from which beads are far
FAR = 8.0
#: Displacement d of the random differences, and the smallest gap, over the largest radius
_DIFFERENCE, _CLOSEST = 1e-5, 1e-5
#: Largest number of times that all overlapping beads are moved apart
_MOST_SWEEPS = 1000
#: Powers of length in the mobilities: x and y, tr, rr
_POWERS = np.array([1] * 6 + [2] * 4 + [3] * 6)


class Fluid(NamedTuple):
    """Spheres and the fluid between them."""

    radius: Array
    """(beads,) m"""
    unit: float
    """1/(6 pi mu), m s/kg"""
    pairs: NDArray[np.int64]
    """(pairs, 2) beads of each pair, the larger one first; (0, 2) for beads that are far"""
    powers: Array
    """(pairs, pieces, terms, 18) tables of the pairs: see `tweezer.fluid.pair_table`"""
    numbers: Array
    """(pairs, 3) their sums of radii, smallest gaps and pieces per unit of w"""


def fluid_of(radii: Array, unit: float, *, near: bool) -> Fluid:
    """Return spheres and fluid in the form for compiled loops.

    Parameters
    ----------
    radii : ndarray, shape (beads,)
        Radii, m.
    unit : float
        1/(6 pi mu), m s/kg.
    near : bool
        Whether lubrication is included.
    """
    pairs, powers, numbers = [], [], []
    for i in range(len(radii) if near else 0):
        for j in range(i):
            a, b = (i, j) if radii[i] > radii[j] else (j, i)
            table = pair_table(radii[b] / radii[a])
            pairs.append((a, b))
            powers.append(table.powers)
            numbers.append((table.total, table.lowest, table.per_w))
    shape = pair_table(1.0).powers.shape if near else (1, 1, 1)
    return Fluid(
        radii, unit, np.array(pairs, np.int64).reshape(-1, 2),
        np.array(powers).reshape(-1, *shape), np.array(numbers, float).reshape(-1, 3),
    )  # fmt: skip


@named_njit(inner=True, error_model="numpy")
def _blocks(m, line, out):  # type: ignore[no-untyped-def]
    """Fill out (12, 12) with the mobility of a pair from its 16 values m, as `fluid.many` does.

    line: (3,) unit vector from the first to the second sphere.
    """
    turned = np.array(
        [[0.0, -line[2], line[1]], [line[2], 0.0, -line[0]], [-line[1], line[0], 0.0]]
    )
    for j in range(3):
        for k in range(3):
            nn = line[j] * line[k]
            across = (1.0 if j == k else 0.0) - nn
            for first, x, y in ((0, 0, 3), (6, 10, 13)):
                out[first + j, first + k] = m[x] * nn + m[y] * across
                out[first + 3 + j, first + 3 + k] = m[x + 1] * nn + m[y + 1] * across
                cross = m[x + 2] * nn + m[y + 2] * across
                out[first + j, first + 3 + k] = out[first + 3 + j, first + k] = cross
            for row, column, value in (
                (6, 0, m[6]), (6, 3, m[7]), (9, 0, -m[8]), (9, 3, -m[9]),
            ):  # fmt: skip
                out[row + j, column + k] = out[column + k, row + j] = value * turned[j, k]


@cached_njit(error_model="numpy", nogil=True)
def fill(fluid, x, M):  # type: ignore[no-untyped-def]
    """Fill M (3 beads, 3 beads), s/kg, at positions x (beads, 3), m."""
    if len(fluid.pairs) == 0:
        _fill_far(fluid, x, M)
        return
    beads = x.shape[0]
    size = fluid.radius.max()
    far, near = np.zeros((6 * beads, 6 * beads)), np.zeros((6 * beads, 6 * beads))
    for a in range(beads):
        radius = fluid.radius[a] / size
        for j in range(3):
            far[3 * a + j, 3 * a + j] = 1.0 / radius
            far[3 * (beads + a) + j, 3 * (beads + a) + j] = 0.75 / radius**3
    value, slope, m, line = np.empty(18), np.empty(18), np.empty(16), np.empty(3)
    exact, approximate = np.empty((12, 12)), np.empty((12, 12))
    at = np.empty(12, np.int64)
    for p in range(len(fluid.pairs)):
        a, b = fluid.pairs[p]
        one, two = fluid.radius[a] / size, fluid.radius[b] / size
        r = 0.0
        for j in range(3):
            line[j] = (x[b, j] - x[a, j]) / size
            r += line[j] * line[j]
        r = math.sqrt(r)
        line /= r
        gap = max(r - one - two, _CLOSEST)
        total, lowest, per_w = fluid.numbers[p]
        pair.mobilities(fluid.powers[p], total, lowest, per_w, gap / one, value, slope)
        for k in range(16):
            m[k] = value[k] / one ** _POWERS[k]
        m[2] = 0.5 * (m[0] + m[1] - value[16] / one)
        _blocks(m, line, exact)
        along, across = pair.rotne_prager(one, two, r)
        turn, spin, roll = pair.rotne_prager_turning(r)
        m[:] = np.array([
            1.0 / one, 1.0 / two, along, 1.0 / one, 1.0 / two, across, 0.0, turn, turn, 0.0,
            0.75 / one**3, 0.75 / two**3, spin, 0.75 / one**3, 0.75 / two**3, roll,
        ])  # fmt: skip
        _blocks(m, line, approximate)
        add = np.linalg.inv(exact) - np.linalg.inv(approximate)
        for j in range(3):
            at[j], at[3 + j] = 3 * a + j, 3 * b + j
            at[6 + j], at[9 + j] = 3 * (beads + a) + j, 3 * (beads + b) + j
        for j in range(12):
            for k in range(12):
                if j // 3 != k // 3:
                    far[at[j], at[k]] = approximate[j, k]
                near[at[j], at[k]] += add[j, k]
    whole = np.linalg.inv(np.linalg.inv(far) + near)
    scale = 0.5 * fluid.unit / size
    for j in range(3 * beads):
        for k in range(3 * beads):
            M[j, k] = scale * (whole[j, k] + whole[k, j])


@named_njit(error_model="numpy")
def _fill_far(fluid, x, M):  # type: ignore[no-untyped-def]
    """Fill M (3 beads, 3 beads), s/kg, with the mobility of Rotne, Prager and Yamakawa."""
    beads = x.shape[0]
    for a in range(beads):
        for j in range(3):
            for k in range(3):
                M[3 * a + j, 3 * a + k] = fluid.unit / fluid.radius[a] if j == k else 0.0
        for b in range(a):
            r = 0.0
            for j in range(3):
                r += (x[a, j] - x[b, j]) ** 2
            r = math.sqrt(r)
            along, across = pair.rotne_prager(fluid.radius[a], fluid.radius[b], r)
            for j in range(3):
                for k in range(3):
                    nn = (x[a, j] - x[b, j]) * (x[a, k] - x[b, k]) / (r * r)
                    value = fluid.unit * ((along - across) * nn + (across if j == k else 0.0))
                    M[3 * a + j, 3 * b + k] = M[3 * b + k, 3 * a + j] = value


def mobility(fluid: Fluid, positions: Array) -> Array:
    """Return the mobility of spheres at positions (beads, 3), m, (3 beads, 3 beads) s/kg."""
    found = np.empty((positions.size, positions.size))
    fill(fluid, np.ascontiguousarray(positions), found)
    return found


@named_njit(error_model="numpy")
def _drift(fluid, kT, x, w, M, moved, out):  # type: ignore[no-untyped-def]
    """Fill out (3 beads,) with kT div M, m/s, by a random difference along w (3 beads,).

    M (3 beads, 3 beads) and moved (beads, 3) are overwritten.
    """
    step = _DIFFERENCE * fluid.radius.max()
    out[:] = 0.0
    for sign in (1.0, -1.0):
        for j in range(w.size):
            moved[j // 3, j % 3] = x[j // 3, j % 3] + sign * 0.5 * step * w[j]
        fill(fluid, moved, M)
        for j in range(w.size):
            for k in range(w.size):
                out[j] += sign * kT / step * M[j, k] * w[k]


@named_njit(error_model="numpy")
def _separate(fluid, x):  # type: ignore[no-untyped-def]
    """Move beads that overlap apart along their line, by twice the depth; x (beads, 3) m.

    This is repeated while it makes others overlap.
    """
    for _ in range(_MOST_SWEEPS):
        moved = False
        for a in range(x.shape[0]):
            for b in range(a):
                r = 0.0
                for j in range(3):
                    r += (x[a, j] - x[b, j]) ** 2
                r = math.sqrt(r)
                deep = fluid.radius[a] + fluid.radius[b] - r
                if deep > 0.0:
                    moved = True
                    for j in range(3):
                        away = deep * (x[a, j] - x[b, j]) / r
                        x[a, j] += away
                        x[b, j] -= away
        if not moved:
            return


@cached_njit(error_model="numpy", nogil=True)
def advance(acting, fluid, kT, seed, step, who, first, per_sample, x, out):  # type: ignore[no-untyped-def]
    """Advance copies of several beads, sample by sample, by Heun's method.

    Parameters
    ----------
    acting : Acting
        Forces.
    fluid : Fluid
        Spheres and fluid.
    kT : float
        Thermal energy, J.
    seed : int
        Seed of the random numbers.
    step : float
        Length of a step, s.
    who : ndarray of int64, shape (copies,)
        Numbers of the trajectories, which determine the random numbers.
    first : int
        Number of the first step.
    per_sample : int
        Number of steps from sample to sample.
    x : ndarray, shape (copies, beads, 3)
        Positions, m; replaced.
    out : ndarray, shape (copies, samples, beads, 3)
        Filled with the positions after every `per_sample` steps, m.
    """
    copies, beads = x.shape[:2]
    size = 3 * beads
    near = len(fluid.pairs) > 0
    drawn = np.empty((2 * size if near else size, copies))
    f, ahead = np.empty((copies, beads, 3)), np.empty((copies, beads, 3))
    later, place = np.empty((copies, beads, 3)), np.empty((beads, 3))
    M, noise = np.empty((size, size)), np.empty((copies, size))
    moved, drift = np.empty((copies, size)), np.zeros((copies, size))
    amplitude = math.sqrt(2.0 * kT * step)
    for s in range(first, first + per_sample * out.shape[1]):
        normals(seed, who, s, NOISE, drawn)
        add_forces(acting, s * step, x, f)
        for i in range(copies):
            if near:
                _drift(fluid, kT, x[i], drawn[size:, i].copy(), M, place, drift[i])
            fill(fluid, x[i], M)
            L = np.linalg.cholesky(M)
            for j in range(size):
                noise[i, j] = step * drift[i, j]
                moved[i, j] = 0.0
                for k in range(j + 1):
                    noise[i, j] += amplitude * L[j, k] * drawn[k, i]
                for k in range(size):
                    moved[i, j] += step * M[j, k] * f[i, k // 3, k % 3]
                ahead[i, j // 3, j % 3] = x[i, j // 3, j % 3] + moved[i, j] + noise[i, j]
            if near:
                _separate(fluid, ahead[i])
        add_forces(acting, (s + 1) * step, ahead, later)
        for i in range(copies):
            fill(fluid, ahead[i], M)
            for j in range(size):
                velocity = 0.0
                for k in range(size):
                    velocity += M[j, k] * later[i, k // 3, k % 3]
                x[i, j // 3, j % 3] += 0.5 * (moved[i, j] + step * velocity) + noise[i, j]
            if near:
                _separate(fluid, x[i])
        sample = (s + 1 - first) // per_sample
        if sample * per_sample == s + 1 - first:
            out[:, sample - 1] = x
