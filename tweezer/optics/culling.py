"""Rays in tiles, so that rays far from the bead cost nothing.

A ray through the focus along u hits the bead at p when it passes the centre within r:
|u x p| < r, so |u . p| > d cos(asin(r/d)). A tile of neighbouring rays lies within a small angle w
of its mean direction c; if it holds a ray that hits, the line to the bead is within asin(r/d) + w
of c. The sum runs over the tiles that satisfy this, and misses no ray that hits.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import cached_njit

Array = NDArray[np.float64]

#: Rays in a tile; a multiple of the vector length of processors
TILE = 32
#: Tiles tested in one batch
TILES_AT_ONCE = 64


class Tiles(NamedTuple):
    """Rays through the focus in tiles of neighbours; incomplete tiles are padded with dark rays."""

    directions: Array
    """(3, tile, ray) unit vectors u_i"""
    strengths: Array
    """(tile, ray) n_m P_i/c, N"""
    centres: Array
    """(3, tile) mean directions, unit vectors"""
    spread_cos: Array
    spread_sin: Array
    """(tile,) cosine and sine of the largest angle w between a ray and its tile's mean direction"""


def tiles(directions: Array, strengths: Array) -> Tiles:
    """`directions` (3, n) and `strengths` (n,) in tiles: strips along x, cut along y."""
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
    return Tiles(
        in_tiles, np.where(filled, strengths[index], 0.0), centres, np.cos(spread), np.sin(spread)
    )


@cached_njit(error_model="numpy", nogil=True)
def rays_near(tiles, first, p1, p2, p3, radius, rays):  # type: ignore[no-untyped-def]
    """Copy to `rays` the tiles from `first` that may hold a ray that hits; returns its count."""
    squared = p1 * p1 + p2 * p2 + p3 * p3
    # d times cosine and sine of asin(r/d), the angle of a tangent; inside the bead all rays hit
    tangent = math.sqrt(max(squared - radius * radius, 0.0))
    inside = squared <= radius * radius
    count = 0
    for tile in range(first, min(first + TILES_AT_ONCE, tiles.spread_cos.size)):
        if not inside:
            along = abs(
                tiles.centres[0, tile] * p1
                + tiles.centres[1, tile] * p2
                + tiles.centres[2, tile] * p3
            )
            # d cos(asin(r/d) + w); no test beyond a right angle
            least = tangent * tiles.spread_cos[tile] - radius * tiles.spread_sin[tile]
            if along < least * (1.0 - 1e-12):
                continue
        for i in range(TILE):
            rays[0, count + i] = tiles.directions[0, tile, i]
            rays[1, count + i] = tiles.directions[1, tile, i]
            rays[2, count + i] = tiles.directions[2, tile, i]
            rays[3, count + i] = tiles.strengths[tile, i]
        count += TILE
    return count
