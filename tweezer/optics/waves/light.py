"""The light of one beam as waves, and the sphere it falls on."""

from __future__ import annotations

import cmath
import dataclasses
import functools
import math
from dataclasses import dataclass

import numpy as np

from tweezer.forces.equilibria import Search
from tweezer.forces.rings import Box
from tweezer.optics.beam import cone, relative_radius
from tweezer.optics.light import SPEED_OF_LIGHT, Light, jones_vector
from tweezer.optics.mask import mask_of
from tweezer.optics.waves.focus import Face, Focus, State, of_harmonics, states
from tweezer.optics.waves.pupil import Pupil, Shape
from tweezer.scene import Scene
from tweezer.scene.theory import FARTHEST_IN_WAVES
from tweezer.values.arrays import Array

#: Distance up to which compiled loops compute the force, in distances at which the bead is lost
BEYOND_LOSS = 1.25
#: Distance up to which the force is sampled evenly: so many radii plus so many wavelengths in the
#: medium, as a small bead's trap reaches many radii
_RADII, _WAVELENGTHS = 5.0, 10.0
#: Spacing of samples, in wavelengths in the medium: the force ripples at half a wavelength
_SPACING = 0.05
#: Search range for rings, in addition to the bead's radius and diameter: from the axis in the focal
#: plane, in 1/(k sin theta), and along the axis, in depths of focus 2/(k sin^2 theta)
_ASIDE, _DEPTHS = 6.0, 6.0
#: Distance from an equilibrium at which the force must pull back, in spacings of samples
_BESIDE = 0.1


@dataclass(frozen=True, eq=False)
class Waves(Light):
    """The light of one beam as plane waves, and a layered sphere."""

    wavenumber: float
    """k in the medium, 1/m"""
    states: tuple[State, ...]
    """the polarised parts of the light"""
    face: Face | None
    """a plane face before the focus"""
    pupil: Pupil | None
    """phase over the pupil; None if it is even"""
    shells: tuple[tuple[float, complex], ...]
    """outer radius, m, and index relative to the medium, from the core outwards"""
    absorbs: bool
    """whether the sphere absorbs light: if not, the light exerts no torque"""
    ends: float = math.inf
    """distance from the focus at which searches of the force end, m. In light with a mask each
    force takes longer the farther the bead is"""

    @property
    def size_parameter(self) -> float:
        """Size parameter k a of the bead: wavenumber in the medium times radius."""
        return self.wavenumber * self.radius

    @property
    def symmetric(self) -> bool:
        """Whether the light is the same all around its axis; see `Light.symmetric`."""
        one = all(len({part.angular_momentum for part in each.parts}) == 1 for each in self.states)
        return one and not self.uneven

    @property
    def uneven(self) -> bool:
        """Whether the pupil's factor differs around the axis; `states` then do not contain it."""
        return self.pupil is not None and not self.pupil.even

    @property
    def harmonic_states(self) -> tuple[State, ...]:
        """Polarised parts of the light with all harmonics of the pupil's factor."""
        if self.pupil is None:
            return self.states
        return of_harmonics(self.states, self.pupil.orders)

    @property
    def kinds(self) -> frozenset[tuple[int | None, bool]]:
        """Harmonic of the pupil of each part of the light, and whether the part is odd."""
        parts = (part for each in self.harmonic_states for part in each.parts)
        return frozenset((part.order, part.odd) for part in parts)

    @property
    def foci(self) -> Array:
        """Approximate positions of the brightest light from the nominal focus, (n, 3) m.

        If the pupil has a factor, the nominal focus itself comes last.
        """
        nominal = super().foci
        if self.pupil is None:
            return nominal
        return np.vstack([self.pupil.foci / self.wavenumber, nominal])

    @property
    def farthest(self) -> float:
        """Distance from the focus up to which the force is computed, m."""
        return min(FARTHEST_IN_WAVES / self.wavenumber, self.ends)

    @functools.cached_property
    def focus(self) -> Focus:
        """Plane waves behind the lens."""
        return Focus(self.cone, self.face, self.pupil)

    @property
    def search(self) -> Search:
        """Lengths by which the force is searched: it changes over wavelengths, and never jumps."""
        wavelength = 2 * math.pi / self.wavenumber
        spacing = _SPACING * wavelength
        near = min(_RADII * self.radius + _WAVELENGTHS * wavelength, self.ends / 2)
        depth = wavelength / (math.pi * self.cone.spread**2)
        # a line from a place within the reach ends where waves are computed
        reach = min(self.reach(depth, near), max(near, self.farthest / 2))
        # of two plane waves the wavenumbers along the axis differ by k (1 - cos theta) at most
        coarsest = _SPACING * wavelength / (2 * math.sin(self.cone.half_angle / 2) ** 2)
        return Search(near, spacing, _BESIDE * spacing, reach, coarsest, known=self.farthest)

    @property
    def box(self) -> Box:
        """Box in which rings and positions off the axis are searched.

        A part of the angular momentum l is brightest about l/(k sin theta) from the axis.
        """
        parts = [abs(part.angular_momentum) for each in self.states for part in each.parts]
        sine = self.cone.spread
        width = self.radius + (_ASIDE + max(parts, default=0)) / (self.wavenumber * sine)
        depth = 2 / (self.wavenumber * sine**2)
        # the force is evaluated up to one radius beyond every position in the box
        ends = self.farthest - self.radius
        width = min(width, ends / 2)
        reach = min(2 * self.radius + _DEPTHS * depth, _height(width, sine, ends))
        return Box(width, depth, reach, sine, self.farthest)

    def of_radius(self, radius: float) -> Waves:
        """Return this light with the sphere, and all its layers, scaled to another radius, m."""
        factor = radius / self.radius
        shells = tuple((outer * factor, index) for outer, index in self.shells)
        return dataclasses.replace(self, radius=radius, shells=shells)


def _height(width: float, spread: float, ends: float) -> float:
    """Return the z > 0 at which the rim of a box is the distance `ends` from the focus, m.

    The rim is at `width` + `spread` z from the axis.
    """
    square, half = 1 + spread**2, width * spread
    return (math.sqrt(half**2 + square * (ends**2 - width**2)) - half) / square


def waves_on_bead(scene: Scene) -> Waves:
    """Return the light of the one beam of `scene` as plane waves, and its bead."""
    n_m, cover, beam = scene.medium.refractive_index, scene.lens.cover, scene.beam
    vacuum = 2 * math.pi / beam.wavelength
    face = None if cover is None else Face(cover.refractive_index, n_m, vacuum * cover.depth)
    pupil, light_cone = None, cone(scene)
    in_front = vacuum * (n_m if cover is None else cover.refractive_index)
    spots = []
    for spot in beam.focus or ():
        x, y, z = (in_front * each for each in spot.position)
        spots.append((x, y, z, spot.amplitude * cmath.exp(1j * spot.phase)))
    mask = mask_of(beam, scene.lens.radius)
    factors = beam.wavefront, beam.modulation_terms, beam.axicon, beam.shaped, spots
    if any(factors) or mask is not None:
        of_one_watt = beam.model_copy(update={"power": None, "power_through_pupil": 1.0})
        shape = Shape(of_one_watt, scene.lens.radius) if beam.shaped else None
        pupil = Pupil(
            beam.wavefront,
            scene.lens.map == "tan",
            relative_radius(scene),
            shape,
            tuple(spots),
            mask=mask,
            modulation=beam.modulation_terms,
            axicon=beam.axicon,
        )
        pupil = (pupil.of_phase() if beam.foci == "phase" else pupil).normalised(light_cone)
    uneven = pupil is not None and not pupil.even
    return Waves(
        cone=light_cone,
        momentum_per_energy=n_m / SPEED_OF_LIGHT,
        radius=scene.bead.radius,
        wavenumber=n_m * vacuum,
        states=states(
            beam.polarisation,
            jones_vector(beam),
            beam.vortex,
            face=face is not None,
            uneven=uneven,
            order=(beam.order or 0, beam.order_phase),
        ),
        face=face,
        pupil=pupil,
        shells=tuple((outer, index / n_m) for outer, index in scene.bead.shells),
        absorbs=scene.bead.absorbs,
        ends=math.inf if mask is None else BEYOND_LOSS * scene.simulation.loss_distance,
    )
