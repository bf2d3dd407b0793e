"""The light of one beam as waves, and the sphere it falls on."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass

from tweezer.optics.beam import cone
from tweezer.optics.light import SPEED_OF_LIGHT, Light, jones_vector
from tweezer.optics.waves.focus import Face, Focus, State, states
from tweezer.scene import Scene


@dataclass(frozen=True, eq=False)
class Waves(Light):
    """The light of one beam as plane waves, and a layered sphere."""

    wavenumber: float
    """k in the medium, 1/m"""
    states: tuple[State, ...]
    """the polarised parts of the light"""
    face: Face | None
    """a plane face before the focus"""
    shells: tuple[tuple[float, complex], ...]
    """outer radius, m, and index relative to the medium, from the core outwards"""
    absorbs: bool
    """whether the sphere absorbs light: if not, the light exerts no torque"""

    @property
    def size_parameter(self) -> float:
        """k a."""
        return self.wavenumber * self.radius

    @property
    def symmetric(self) -> bool:
        """Whether the light is the same all around its axis."""
        return all(len({part.angular_momentum for part in each.parts}) == 1 for each in self.states)

    @property
    def odd(self) -> bool:
        """Whether its parts are odd in sin(theta) beside their amplitudes."""
        parts = [part for each in self.states for part in each.parts]
        return any((part.helicity + part.angular_momentum) % 2 for part in parts)

    @functools.cached_property
    def focus(self) -> Focus:
        """The plane waves behind the lens."""
        return Focus(self.cone, self.face)

    def of_radius(self, radius: float) -> Waves:
        """The same on a sphere scaled to that radius, m."""
        factor = radius / self.radius
        shells = tuple((outer * factor, index) for outer, index in self.shells)
        return dataclasses.replace(self, radius=radius, shells=shells)


def waves_on_bead(scene: Scene) -> Waves:
    """The light of the one beam of `scene` as waves, on its bead."""
    n_m, cover, beam = scene.medium.refractive_index, scene.lens.cover, scene.beam
    vacuum = 2 * math.pi / beam.wavelength
    face = None if cover is None else Face(cover.refractive_index, n_m, vacuum * cover.depth)
    return Waves(
        cone=cone(scene),
        momentum_per_energy=n_m / SPEED_OF_LIGHT,
        radius=scene.bead.radius,
        wavenumber=n_m * vacuum,
        states=states(beam.polarisation, jones_vector(beam), beam.vortex, face=face is not None),
        face=face,
        shells=tuple((outer, index / n_m) for outer, index in scene.bead.shells),
        absorbs=scene.bead.absorbs,
    )
