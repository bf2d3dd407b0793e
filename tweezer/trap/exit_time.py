"""Mean time until thermal motion removes a bead from a region, in a field around an axis.

The bead moves in a half plane with the coordinates rho, the distance from the axis, and z, the
height along it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.values.arrays import Array

#: Function of distances rho from the axis and heights z, (n,), m. It returns the forces across and
#: along the axis, (n,), N, and the mobilities across and along it, (n,), s/kg
Field = Callable[[Array, Array], tuple[Array, Array, Array, Array]]
#: Part of a grid, by index ranges of heights and distances from the axis
Slices = tuple[slice, slice]

#: Fraction of the radius, or of an edge, below which a length counts as zero
_SAME = 1e-6
#: Increase of the node distance per distance from the point where nodes are closest
_GROWTH = 0.08
#: Factor of that increase for a finer grid
_FINER = 0.6


@dataclass(frozen=True)
class Region:
    """Ball around the origin, possibly cut off by walls, that a bead leaves, with its nodes."""

    radius: float
    """radius of the ball, m; a bead this far from the origin has left the region"""
    finest: float
    """smallest distance between two nodes, m"""
    low: float = -math.inf
    """height of the lower wall, m, which the bead does not cross"""
    high: float = math.inf
    """height of the upper wall, m, which the bead does not cross"""
    centre: float = 0.0
    """height on the axis where nodes are closest, m"""
    growth: float = _GROWTH
    """increase of the node distance per distance from there"""

    def finer(self, height: float) -> Region:
        """Return the region with nodes about half as far apart, closest at `height`, m."""
        return dataclasses.replace(
            self, finest=self.finest / 2, centre=height, growth=_FINER * self.growth
        )

    def across(self) -> Array:
        """Return the distances of the nodes from the axis, an odd number of them, m."""
        return self._graded(self.radius)

    def has(self, across: Array, along: Array) -> NDArray[np.bool_]:
        """Return which nodes are inside the ball, (heights, distances).

        `across` are the distances of the nodes from the axis, and `along` their heights, m.
        """
        return np.hypot(along[:, None], across) < self.radius * (1 - _SAME)

    def share(self, across: Array, along: Array, begin: Slices, end: Slices) -> Array:
        """Return the fraction of each edge inside the ball, for edges that leave it.

        The edges lead from nodes of the grid to their neighbours along one coordinate.

        Parameters
        ----------
        across : ndarray
            Distances of the nodes from the axis, m.
        along : ndarray
            Heights of the nodes, m.
        begin, end : pair of slice
            Parts of the grid with the nodes and with their neighbours.
        """
        rho = np.broadcast_to(across, (len(along), len(across)))
        z = np.broadcast_to(along[:, None], rho.shape)
        from_rho, from_z, to_rho, to_z = rho[begin], z[begin], rho[end], z[end]
        sideways = from_z == to_z
        fixed = np.where(sideways, from_z, from_rho)
        start, stop = np.where(sideways, (from_rho, to_rho), (from_z, to_z))
        out = np.sqrt(np.maximum(self.radius**2 - fixed**2, 0.0)) * np.sign(stop - start)
        return np.clip((out - start) / (stop - start), _SAME, 1.0)

    def along(self) -> Array:
        """Return the heights of the nodes, an odd number of them, m."""
        nearest = min(max(self.centre, self.low), self.high)
        below = self._graded(nearest - max(-self.radius, self.low))
        above = self._graded(min(self.radius, self.high) - nearest)
        return nearest + np.concatenate([-below[:0:-1], above])

    def _graded(self, end: float) -> Array:
        """Return coordinates from 0 to `end`, m, whose spacing grows from `finest` by `growth`.

        Their number is odd, so every other coordinate spans the same range.
        """
        if end <= 0:
            return np.zeros(1)
        stretch = self.growth * end / self.finest
        logarithm = math.log1p(stretch)
        even = 2 * max(2, math.ceil(logarithm / (2 * self.growth)))
        return end / stretch * np.expm1(np.linspace(0.0, logarithm, even + 1))


@dataclass(frozen=True)
class Edges:
    """Work and mobility on the edges between neighbouring nodes along one coordinate."""

    work: Array
    """work of the force along each edge, in k_B T; (heights, distances), with one fewer in the
    coordinate of the edges"""
    mobility: Array
    """mobility at the middle of each edge, s/kg, in the same shape"""

    def coarse(self, axis: int) -> Edges:
        """Return the edges between every other node; `axis` is the index of their coordinate.

        The index is 0 for the height and 1 for the distance from the axis. The works of two edges
        are added, and their inverse mobilities are averaged.
        """
        even, odd, kept = slice(None, None, 2), slice(1, None, 2), slice(None, None, 2)
        first, second = ((kept, even), (kept, odd)) if axis else ((even, kept), (odd, kept))
        mobility = 2 / (1 / self.mobility[first] + 1 / self.mobility[second])
        return Edges(self.work[first] + self.work[second], mobility)


@dataclass(frozen=True)
class Grid:
    """Nodes in the half plane of an axis, and the edges between them."""

    across: Array
    """distances of the nodes from the axis, m"""
    along: Array
    """heights of the nodes, m"""
    to_side: Edges
    """edges to the next distance from the axis, (heights, distances - 1)"""
    upwards: Edges
    """edges to the next height, (heights - 1, distances)"""

    @classmethod
    def of(cls, region: Region, field: Field, energy: float) -> Grid:
        """Return the grid of a region, with the work in a field relative to `energy` = k_B T, J."""
        across, along = region.across(), region.along()
        inside = _with_neighbours(region.has(across, along))
        z, rho = np.meshgrid(along, (across[1:] + across[:-1]) / 2, indexing="ij")
        wanted = inside[:, 1:] | inside[:, :-1]
        side, _, mobile, _ = _at(field, rho, z, wanted)
        to_side = _works(across, side.T, wanted.T).T / energy
        z, rho = np.meshgrid((along[1:] + along[:-1]) / 2, across, indexing="ij")
        wanted = inside[1:] | inside[:-1]
        _, up, _, mobile_up = _at(field, rho, z, wanted)
        upwards = _works(along, up, wanted) / energy
        return cls(across, along, Edges(to_side, mobile), Edges(upwards, mobile_up))

    def coarse(self) -> Grid:
        """Return the grid of every other node in both coordinates."""
        return Grid(
            self.across[::2], self.along[::2], self.to_side.coarse(1), self.upwards.coarse(0)
        )


def _with_neighbours(nodes: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the nodes (heights, distances) of a mask and their neighbours.

    The neighbours are included because `Grid.coarse` needs the field there too.
    """
    padded = np.pad(nodes, 1)
    return nodes | padded[2:, 1:-1] | padded[:-2, 1:-1] | padded[1:-1, 2:] | padded[1:-1, :-2]


def _at(field: Field, rho: Array, z: Array, wanted: NDArray[np.bool_]) -> list[Array]:
    """Return the four arrays of a field at the points (`rho`, `z`), m, that are `wanted`.

    All arrays have the same two-dimensional shape. At other points the field is not computed, and
    the values are 1.
    """
    found = []
    for each in field(rho[wanted], z[wanted]):
        whole = np.ones(rho.shape)
        whole[wanted] = each
        found.append(whole)
    return found


def _works(nodes: Array, force: Array, wanted: NDArray[np.bool_]) -> Array:
    """Return the work over each edge between nodes (edges, lines), J, from the force at its middle.

    `nodes` (edges + 1,), m, are the coordinates along the edges, and `force` (edges, lines), N, is
    the component along them. A correction uses the second derivative of the force, from
    neighbouring edges that are `wanted`. Without it the work of long edges is wrong by tenths of
    k_B T.
    """
    edge, middle = np.diff(nodes)[:, None], (nodes[1:] + nodes[:-1]) / 2
    curvature = np.zeros_like(force)
    slopes = np.diff(force, axis=0) / np.diff(middle)[:, None]
    curvature[1:-1] = np.diff(slopes, axis=0) / ((middle[2:] - middle[:-2]) / 2)[:, None]
    curvature[1:-1] *= wanted[2:] & wanted[:-2]
    return force * edge + curvature * edge**3 / 24


def mean_time(grid: Grid, region: Region, start: tuple[float, float], energy: float) -> float:
    """Return the mean time until the bead leaves the region, s.

    The bead is a Markov chain between the nodes. Its rates are exact for diffusion under a constant
    force between neighbours (Scharfetter, Gummel, IEEE Trans. Electron Devices 16, 64 (1969)). The
    error decreases with the square of the node distance.

    Parameters
    ----------
    grid : Grid
        Nodes, with the force and the mobilities.
    region : Region
        Region that the bead leaves.
    start : tuple of float
        Initial position (rho, z), m.
    energy : float
        k_B T, J.

    Returns
    -------
    float
        Mean time, s; infinite if it exceeds the range of floating-point numbers.
    """
    from tweezer.trap.elimination import mean_times

    across, along = grid.across, grid.along
    inside = region.has(across, along)
    n, width = inside.shape
    rates, lost = np.zeros((n, width, 2 * width + 1)), np.zeros((n, width))
    every, first, last = slice(None), slice(None, -1), slice(1, None)

    def link(begin: Slices, end: Slices, step: int, edge: Array, work: Array, unit: Array) -> None:
        """Store the rates, 1/s, from the nodes in `begin` to their neighbours in `end`.

        `step` is the difference of the numbers of these nodes, `edge` their distance, m, and `work`
        the work between them, k_B T. A rate is `unit`, m/s, times a Bernoulli function, divided by
        the edge. If only the first node is in the ball, the result is the rate of leaving the ball.
        """
        here, there = inside[begin], inside[end]
        rates[(*begin, width + step)] = np.where(here & there, unit / edge * _bernoulli(-work), 0.0)
        share = np.where(here & ~there, region.share(across, along, begin, end), 1.0)
        leaving = unit / (share * edge) * _bernoulli(-share * work)
        lost[begin] += np.where(here & ~there, leaving, 0.0)

    middle = (across[1:] + across[:-1]) / 2
    # a node is a ring of area 2 pi `areas` with an edge of length 2 pi `middle`; 2 pi cancels
    areas = np.diff(np.concatenate([[0.0], middle, across[-1:]]) ** 2) / 2
    edge, side = np.diff(across), grid.to_side
    unit = energy * side.mobility * middle
    link((every, first), (every, last), 1, edge, side.work, unit / areas[:-1])
    link((every, last), (every, first), -1, edge, -side.work, unit / areas[1:])
    middle = (along[1:] + along[:-1]) / 2
    heights = np.diff(np.concatenate([along[:1], middle, along[-1:]]))[:, None]
    edge, up = np.diff(along)[:, None], grid.upwards
    unit = energy * up.mobility
    link((first, every), (last, every), width, edge, up.work, unit / heights[:-1])
    link((last, every), (first, every), -width, edge, -up.work, unit / heights[1:])
    times = np.zeros(n * width)
    mean_times(rates.reshape(n * width, -1), lost.ravel(), inside.ravel().astype(float), times)
    rho, height = start
    at_height = [np.interp(height, along, column) for column in times.reshape(n, width).T]
    return float(np.interp(rho, across, at_height))


def _bernoulli(x: Array) -> Array:
    """Return the Bernoulli function x/(exp(x) - 1), as 1 - x/2 near 0."""
    small = np.abs(x) < 1e-5
    with np.errstate(over="ignore"):
        return np.where(small, 1 - x / 2, x / np.expm1(np.where(small, 1.0, x)))
