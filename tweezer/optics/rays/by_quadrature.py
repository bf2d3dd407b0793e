"""The force of light as an integral over the lens, by quadrature to a tolerance."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from tweezer.forces.data import Data
from tweezer.forces.force import Kernel
from tweezer.optics.light import LightForce
from tweezer.optics.rays.light import RayLight, light_on_bead
from tweezer.optics.rays.quadrature import VANISHING, quadrature_data, quadrature_kernel
from tweezer.optics.rays.rule import Rule, rule
from tweezer.scene import Scene
from tweezer.values.arrays import Array

#: Largest allowed error, in tolerances of |F|
MISSED = 2.0
#: Allowed error by rounding, in n_m P/c; added to that
ROUNDING = 1e-14


@dataclass(frozen=True, eq=False)
class ByQuadrature(LightForce):
    """Force of the light by an integral over the lens, with an estimated error."""

    light: RayLight
    """rays, and the sphere they fall on"""
    rule: Rule
    """tables from which the nodes of the integral are computed"""

    scales = True

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return quadrature_kernel(self.light.rays(gradient=gradient)), self._data

    @functools.cached_property
    def _data(self) -> Data:
        """Data of the kernel: the tables of nodes and the sphere."""
        return quadrature_data(self.rule, self.light.sphere, self.light.jones)

    def allowed_error(self, force: Array) -> Array:
        """Return the largest error within the tolerance, (n,) N; force: (n, 3) N."""
        strength = self.light.strength
        size = np.maximum(np.linalg.norm(force, axis=1), VANISHING * strength)
        return MISSED * self.rule.tolerance * size + ROUNDING * strength


def to_tolerance(light: RayLight, tolerance: float) -> ByQuadrature:
    """Return the force of `light` by quadrature, to a relative tolerance."""
    series = light.momentum_per_energy * light.cone.series
    return ByQuadrature(light, rule(light.cone.half_angle, series, light.strength, tolerance))


def by_quadrature(scene: Scene) -> ByQuadrature:
    """Return the force of the light of `scene` as rays, by quadrature to `optics.tolerance`."""
    return to_tolerance(light_on_bead(scene), scene.optics.tolerance)
