"""Starting positions in the search for equilibria of light without an axis, from samples on a grid.

In a cell of the grid the force is nearly linear in the position. A zero of this linear force, near
a cell in which all three components change their sign, is a starting position.
"""

from __future__ import annotations

import itertools

import numpy as np

from tweezer.forces.equilibria import NetForce, Search
from tweezer.values.arrays import Array

#: Edges of a cell across the light, in spacings of samples, and along it, in the largest of them
_ACROSS, _ALONG = 2.5, 4.0
#: Largest distance of a zero from the centre of its cell along each axis, in edges
_NEAR = 1.0
#: Real part below which an eigenvalue of the gradient may be negative at the zero itself, over the
#: largest one: the gradient in a cell is approximate
_UNSTABLE = 0.1
#: Corners of a cell about its centre, in edges
_CORNERS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))


def starts(foci: Array, half: Array, search: Search, net_force: NetForce) -> Array:
    """Return approximate positions near foci where a force vanishes and may be stable.

    Parameters
    ----------
    foci : ndarray, shape (n, 3)
        Positions about which light is bright, m.
    half : ndarray, shape (3,)
        Half-widths of the box that is searched about each focus, m.
    search : Search
        Lengths over which the force changes.
    net_force : callable
        Sum of all forces but drag.

    Returns
    -------
    ndarray, shape (m, 3)
        Positions, m.
    """
    edge = np.array([_ACROSS, _ACROSS, 0.0]) * search.spacing
    edge[2] = max(edge[0], min(_ALONG * search.coarsest, half[2] / 2))
    low = foci.min(axis=0) - half
    shape = np.ceil((foci.max(axis=0) + half - low) / edge).astype(int) + 2
    every = []
    for focus in foci:
        first, last = (np.floor((focus + side * half - low) / edge).astype(int) for side in (-1, 1))
        axes = (np.arange(a, b + 1) for a, b in zip(first, last, strict=True))
        every.append(np.ravel_multi_index(np.meshgrid(*axes, indexing="ij"), shape).ravel())
    cells = np.array(np.unravel_index(np.unique(np.concatenate(every)), shape)).T
    corners = (cells[:, None] + (_CORNERS + 0.5).astype(int)).reshape(-1, 3)
    numbers, where = np.unique(np.ravel_multi_index(corners.T, shape), return_inverse=True)
    places = low + edge * np.array(np.unravel_index(numbers, shape)).T
    force = np.full(places.shape, np.nan)
    known = np.linalg.norm(places, axis=1) < search.known
    force[known] = net_force(places[known])
    of_cells = force[where.ravel()].reshape(-1, len(_CORNERS), 3)
    changes = ((of_cells.min(axis=1) <= 0) & (of_cells.max(axis=1) >= 0)).all(axis=1)
    of_cells, centres = of_cells[changes], low + edge * (cells[changes] + 0.5)
    slopes = np.einsum("nck,cj->nkj", of_cells, _CORNERS) / (_CORNERS**2).sum(axis=0)
    shift = -(np.linalg.pinv(slopes) @ of_cells.mean(axis=1)[..., None])[..., 0]
    rates = np.linalg.eigvals(slopes / edge).real
    stable = rates.max(axis=1) < _UNSTABLE * np.abs(rates).max(axis=1)
    found: Array = (centres + edge * shift)[stable & (np.abs(shift) <= _NEAR).all(axis=1)]
    return found
