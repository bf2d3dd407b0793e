"""The light of one beam on a bead in the terms of ray optics."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tweezer.forces.data import Data, packed
from tweezer.forces.equilibria import Search
from tweezer.forces.force import Kernel
from tweezer.forces.rings import Box
from tweezer.optics.beam import cone
from tweezer.optics.light import SPEED_OF_LIGHT, Light, jones_vector
from tweezer.optics.rays.ray_sum import Rays, Sphere
from tweezer.scene import Scene
from tweezer.values.arrays import Array

#: Distance up to which the force is sampled evenly, and the spacing of samples, in radii
_NEAR, _SPACING = 20.0, 0.02
#: Distances from the axis in the plane of the focus, and from the focus along the axis, up to which
#: rings are sought, in radii
_ASIDE, _AHEAD = 2.0, 4.0


@dataclass(frozen=True, eq=False)
class RayLight(Light):
    """The light of one beam as rays, and the sphere they fall on."""

    index_ratio: float
    """n_m/n_P: refractive index of the medium over that of the bead"""
    polarisation: str
    """of the rays; "circular" for unpolarised light too, whose rays exert the same force"""
    jones: Array
    """(4,) Jones vector as (re, im) pairs; zeros where the light is not linear"""
    torque: bool
    """whether the torque (3.25) is computed"""

    @property
    def sphere(self) -> Sphere:
        """Radius and relative index of the bead, in the form that the kernels read."""
        return Sphere(self.radius, self.index_ratio)

    @property
    def symmetric(self) -> bool:
        """Whether the light is the same all around its axis; see `Light.symmetric`."""
        return self.polarisation != "linear"

    @property
    def search(self) -> Search:
        """Lengths by which the force is searched: it changes over radii; a sum on a grid jumps."""
        spacing = _SPACING * self.radius
        near = _NEAR * self.radius
        return Search(near, spacing, beside=spacing, reach=self.reach(0.0, near))

    @property
    def box(self) -> Box:
        """Box in which rings and positions off the axis are searched, about a point-like focus."""
        r = self.radius
        return Box(_ASIDE * r, r, _AHEAD * r, math.tan(self.cone.half_angle))

    def regions(self) -> tuple[Kernel, Data]:
        """Return a kernel that numbers the regions in which the force is smooth, and its data."""
        from tweezer.optics.rays.regions import number_of_region

        return number_of_region, packed(self.radius, self.cone.half_angle)

    def rays(self, *, gradient: bool) -> Rays:
        """Return the settings that a kernel is compiled for; gradient: whether to add gradients."""
        return Rays(self.polarisation, self.index_ratio > 1, gradient, self.torque)


def light_on_bead(scene: Scene) -> RayLight:
    """Return the light of the one beam of `scene` as rays, and its bead."""
    n_m = scene.medium.refractive_index
    polarisation = scene.beam.polarisation
    return RayLight(
        cone=cone(scene),
        momentum_per_energy=n_m / SPEED_OF_LIGHT,
        radius=scene.bead.radius,
        index_ratio=n_m / scene.bead.index.real,
        polarisation="circular" if polarisation == "unpolarised" else polarisation,
        jones=jones_vector(scene.beam),
        torque=scene.beam.torque == "thesis",
    )
