"""Rays in tiles, so that rays far from the bead cost nothing.

A ray through the focus along u hits the bead at p if it passes the centre within r:
|u x p| < r, so |u . p| > d cos(asin(r/d)). A tile of neighbouring rays is within a small angle w
of its mean direction c. If it contains a ray that hits, the line to the bead is within
asin(r/d) + w of c. The sum over the tiles that satisfy this misses no ray that hits.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.forces.data import Data, matrix, number, packed, vector
from tweezer.forces.force import KERNEL, Kernel
from tweezer.optics.rays.ray_sum import SUMS, Rays, Sphere, ray_sum
from tweezer.optics.turning import put
from tweezer.values.arrays import Array

#: Rays in a tile; a multiple of the vector length of processors
TILE = 32


class Tiles(NamedTuple):
    """Rays through the focus in tiles of neighbours; incomplete tiles are padded with dark rays."""

    rays: Array
    """(4, ray) unit vectors u_i and n_m P_i/c, N: rows U1, U2, U3, WEIGHT; tile after tile"""
    centres: Array
    """(3, tile) mean directions, unit vectors"""
    spread_cos: Array
    """(tile,) cosine of the largest angle w between a ray and its tile's mean direction"""
    spread_sin: Array
    """(tile,) sine of that angle"""


def tiles(directions: Array, strengths: Array) -> Tiles:
    """Return rays in tiles of neighbours: they are sorted into strips along x, cut along y.

    `directions` (3, n) are unit vectors, and `strengths` (n,) are n_m P_i/c of each ray (N).
    """
    count = strengths.size
    strips = max(1, round(math.sqrt(count / TILE)))
    by_x = np.argsort(directions[0], kind="stable")
    order = [
        strip[np.argsort(directions[1][strip], kind="stable")]
        for strip in np.array_split(by_x, strips)
    ]
    groups = [strip[i : i + TILE] for strip in order for i in range(0, len(strip), TILE)]
    index = np.array([np.pad(group, (0, TILE - len(group)), mode="edge") for group in groups])
    filled = np.array([np.arange(TILE) < len(group) for group in groups])
    in_tiles = np.ascontiguousarray(directions[:, index])
    centres = in_tiles.mean(axis=2)
    centres /= np.linalg.norm(centres, axis=0)
    # from the chord, as the cosine loses digits at small angles
    chord = np.linalg.norm(in_tiles - centres[:, :, None], axis=0).max(axis=1)
    spread = 2 * np.arcsin(np.minimum(chord / 2, 1.0)) * (1 + 1e-9) + 1e-12
    strengths = np.where(filled, strengths[index], 0.0)
    rays = np.concatenate([in_tiles, strengths[None]]).reshape(4, -1)
    return Tiles(rays, centres, np.cos(spread), np.sin(spread))


@cached_njit(error_model="numpy", nogil=True)
def near(tiles, tile, p1, p2, p3, radius):  # type: ignore[no-untyped-def]
    """Return whether a ray of the tile of that number may hit a bead at p = (p1, p2, p3), m.

    radius: of the bead, m.
    """
    squared = p1 * p1 + p2 * p2 + p3 * p3
    if squared <= radius * radius:
        return True
    # d times cosine and sine of asin(r/d), the angle of a tangent
    tangent = math.sqrt(squared - radius * radius)
    centres = tiles.centres
    along = abs(centres[0, tile] * p1 + centres[1, tile] * p2 + centres[2, tile] * p3)
    # d cos(asin(r/d) + w); no test beyond a right angle
    least = tangent * tiles.spread_cos[tile] - radius * tiles.spread_sin[tile]
    return along >= least * (1.0 - 1e-12)


def grid_data(tiles: Tiles, sphere: Sphere, jones: Any) -> Data:
    """Return the data of `grid_kernel`. jones: Jones vector (4,), as (re, im) pairs."""
    return packed(*sphere, jones, *tiles)


@functools.cache
def grid_kernel(rays: Rays) -> Kernel:
    """Return the kernel that sums over the rays of the thesis's grid (3.26); its error is NaN."""
    add_up = ray_sum(rays, by_grid=True, in_rings=False)
    gradient, moment = rays.gradient, rays.moment

    @cached_njit(KERNEL, **SUMS)
    def sum_over_grid(pose, data, wrench):  # type: ignore[no-untyped-def]
        """Add the force of the rays that may hit each bead, as a kernel.

        `data` contains the radius (m), n_m/n_P, the Jones vector and the fields of `Tiles`.
        """
        radius, n_mP, jones = number(data, 0), number(data, 1), vector(data, 2)
        tiles = Tiles(matrix(data, 3), matrix(data, 4), vector(data, 5), vector(data, 6))
        found = np.empty(24)
        for at in range(pose.position.shape[0]):
            p1, p2, p3 = pose.position[at, 0], pose.position[at, 1], pose.position[at, 2]
            found[:] = 0.0
            first = count = tiles.spread_cos.size
            # the sum runs over each run of tiles that may be hit; the last round ends the last run
            for tile in range(count + 1):
                hit = tile < count and near(tiles, tile, p1, p2, p3, radius)
                if hit and first == count:
                    first = tile
                elif not hit and first < count:
                    add_up(
                        tiles.rays, first * TILE, tile * TILE, p1, p2, p3, radius, n_mP,
                        (jones[0], jones[1], jones[2], jones[3]), found,
                    )  # fmt: skip
                    first = count
            put(found, 1.0, 0.0, gradient, moment, at, wrench)
            wrench.error[at] = np.nan

    return sum_over_grid
