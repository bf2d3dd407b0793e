"""The force of light as the thesis has it: a sum over the rays of squares of the pupil (3.26)."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from tweezer.forces.data import Data
from tweezer.forces.force import Kernel
from tweezer.optics.light import LightForce
from tweezer.optics.rays.by_quadrature import ByQuadrature, to_tolerance
from tweezer.optics.rays.grid import Tiles, grid_data, grid_kernel, tiles
from tweezer.optics.rays.light import RayLight, light_on_bead
from tweezer.optics.rays.pupil import grid
from tweezer.scene import Scene


@dataclass(frozen=True, eq=False)
class ByGrid(LightForce):
    """Force of the light by the sum over the thesis's rays; it has no error estimate of its own."""

    light: RayLight
    """rays, and the sphere they fall on"""
    tiles: Tiles
    """the rays of the grid, in groups of neighbours"""
    tolerance: float
    """relative, of the quadrature that the sum is compared with"""

    scales = True
    smooth = False
    symmetric = False

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return grid_kernel(self.light.rays(gradient=gradient)), self._data

    @functools.cached_property
    def _data(self) -> Data:
        """Data of the kernel: the rays and the sphere."""
        return grid_data(self.tiles, self.light.sphere, self.light.jones)

    def certain(self) -> ByQuadrature:
        """Return the force of the same light by quadrature, which estimates its error."""
        return self._integral

    @functools.cached_property
    def _integral(self) -> ByQuadrature:
        """Force of the same light by quadrature."""
        return to_tolerance(self.light, self.tolerance)


def by_grid(scene: Scene) -> ByGrid:
    """Return the force of the light of `scene` by `beam.divisions` squares across the pupil."""
    light = light_on_bead(scene)
    rays = grid(scene.lens, scene.beam, scene.medium)
    in_tiles = tiles(rays.directions, light.momentum_per_energy * rays.powers)
    return ByGrid(light, in_tiles, scene.optics.tolerance)
