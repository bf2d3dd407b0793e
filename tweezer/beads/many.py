"""Thermal motion of more than two beads, coupled by the mobility of Rotne, Prager and Yamakawa."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tweezer.beads.forces import add_forces
from tweezer.compiled import cached_njit, named_njit
from tweezer.dynamics.brownian.noise import NOISE, normals
from tweezer.generated import pair
from tweezer.values.arrays import Array


class Fluid(NamedTuple):
    """Spheres and the fluid between them."""

    radius: Array
    """(beads,) m"""
    unit: float
    """1/(6 pi mu), m s/kg"""


@named_njit(error_model="numpy")
def fill(fluid, x, M):  # type: ignore[no-untyped-def]
    """Fill M (3 beads, 3 beads), s/kg, at positions x (beads, 3), m."""
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


@cached_njit(error_model="numpy", nogil=True)
def advance(acting, fluid, kT, seed, step, who, first, per_sample, x, out):  # type: ignore[no-untyped-def]
    """Advance copies of several beads, sample by sample, by Heun's method.

    The mobility has no divergence, so that there is no drift.
    """
    copies, beads = x.shape[:2]
    size = 3 * beads
    drawn = np.empty((size, copies))
    f, ahead = np.empty((copies, beads, 3)), np.empty((copies, beads, 3))
    later = np.empty((copies, beads, 3))
    M, noise = np.empty((size, size)), np.empty((copies, size))
    moved = np.empty((copies, size))
    amplitude = math.sqrt(2.0 * kT * step)
    for s in range(first, first + per_sample * out.shape[1]):
        normals(seed, who, s, NOISE, drawn)
        add_forces(acting, s * step, x, f)
        for i in range(copies):
            fill(fluid, x[i], M)
            L = np.linalg.cholesky(M)
            for j in range(size):
                noise[i, j] = moved[i, j] = 0.0
                for k in range(j + 1):
                    noise[i, j] += amplitude * L[j, k] * drawn[k, i]
                for k in range(size):
                    moved[i, j] += step * M[j, k] * f[i, k // 3, k % 3]
                ahead[i, j // 3, j % 3] = x[i, j // 3, j % 3] + moved[i, j] + noise[i, j]
        add_forces(acting, (s + 1) * step, ahead, later)
        for i in range(copies):
            fill(fluid, ahead[i], M)
            for j in range(size):
                velocity = 0.0
                for k in range(size):
                    velocity += M[j, k] * later[i, k // 3, k % 3]
                x[i, j // 3, j % 3] += 0.5 * (moved[i, j] + step * velocity) + noise[i, j]
        sample = (s + 1 - first) // per_sample
        if sample * per_sample == s + 1 - first:
            out[:, sample - 1] = x
