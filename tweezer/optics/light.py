"""The light of one beam on a bead, and the interface of its force."""

from __future__ import annotations

import dataclasses
import functools
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from tweezer.forces.data import Data, Part
from tweezer.forces.equilibria import Search
from tweezer.forces.force import Force, Kernel, Wrench, bound, evaluated
from tweezer.forces.rings import Box
from tweezer.optics.beam import Cone
from tweezer.scene.sections import Beam
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: How far the force is searched at least, in lengths of the light
LENGTHS = 5.0

SPEED_OF_LIGHT = 299792458.0
"""c, m/s (Table B.1)"""


@dataclass(frozen=True, eq=False)
class Light(ABC):
    """Light of one beam, and the sphere that it falls on; subclasses add the theory of light."""

    cone: Cone
    """the light behind the lens"""
    momentum_per_energy: float
    """n_m/c of the light in the medium (refractive index over speed of light), s/m"""
    radius: float
    """of the bead, m"""

    @property
    def strength(self) -> float:
        """Momentum per time of all the light, n_m P/c, N: the unit of the forces of tables."""
        return self.momentum_per_energy * self.cone.power

    @property
    @abstractmethod
    def symmetric(self) -> bool:
        """Whether the light is the same all around its axis."""

    @property
    @abstractmethod
    def search(self) -> Search:
        """Lengths that control the search for zeros and largest values of the force."""

    def reach(self, depth: float, least: float) -> float:
        """Return the distance to which the force is searched, m, at least `least`.

        It is five times the length of the light: the distance at which the beam is as wide as the
        bead, plus the depth of focus with wave optics.
        """
        return max(least, LENGTHS * (self.radius / self.cone.spread + depth))

    @property
    @abstractmethod
    def box(self) -> Box:
        """Box in which rings and positions off the axis are searched."""

    @property
    def foci(self) -> Array:
        """Approximate positions of the brightest light from the nominal focus, (n, 3) m."""
        return np.zeros((1, 3))

    def of_radius(self, radius: float) -> Self:
        """Return this light with the sphere scaled to another radius, m."""
        return dataclasses.replace(self, radius=radius)

    def regions(self) -> tuple[Kernel, Data] | None:
        """Return None: the force is smooth everywhere; see `Force.regions`."""
        return None


def jones_vector(beam: Beam) -> Array:
    """Return the Jones vector (4,) of linear light as (re, im) pairs; zeros for other light."""
    return np.array(beam.jones or np.zeros((2, 2))).ravel()


@dataclass(frozen=True, eq=False)
class LightForce(Force):
    """Force of the light of one beam on a bead.

    Each subclass evaluates it in another way: a sum over rays or waves, a quadrature or a table.
    """

    light: Light
    """the light, and the sphere it falls on"""

    scales: ClassVar[bool] = False
    """whether the force depends only on the position in bead radii, as in ray optics"""
    smooth: ClassVar[bool] = True
    """whether the force is that of continuous light. A sum over a grid of rays has jumps, and far
    from the focus a few rays exert a force that does not decrease"""

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """Return force and torque at positions of the bead; see `Force.field`.

        The bound kernel is kept, because looking it up takes as long as computing the force.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        gradient : bool, optional
            Whether to compute gradients too.
        time : float or ndarray, shape (n,), optional
            Time, s.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters.
        """
        if gradient not in self._parts:
            self._parts[gradient] = bound(self, gradient=gradient)
        return evaluated(self._parts[gradient], positions, gradient, time, orientations)

    @property
    def search(self) -> Search:
        """Lengths by which the force is searched; near the focus alone if it is not smooth."""
        search = self.light.search
        return search if self.smooth else search._replace(reach=search.near)

    @property
    def box(self) -> Box:
        """Box in which rings and positions off the axis are searched; see `Light.box`."""
        return self.light.box

    @property
    def symmetric(self) -> bool:
        """Whether the force is the same all around the axis of the light."""
        return self.light.symmetric

    def foci(self, time: float = 0.0) -> Array:  # noqa: ARG002
        """Return the positions about which light is brightest, (n, 3) m; see `Beams.foci`."""
        return self.light.foci

    @functools.cached_property
    def _parts(self) -> dict[bool, Part]:
        """The bound force with gradients (True) and without, filled when used."""
        return {}

    def regions(self) -> tuple[Kernel, Data] | None:
        """Return a kernel that numbers the regions in which the force is smooth, and its data."""
        return self.light.regions()

    def absorbed_power(self, positions: Array, *, time: float = 0.0) -> Array:  # noqa: ARG002
        """Return the power that the bead absorbs at `positions` (n, 3) m and a time, s; (n,) W."""
        return np.zeros(len(positions))

    def certain(self) -> LightForce:
        """Return the force of the same light by an evaluator that estimates its error."""
        return self

    def error_of(self, positions: Array, field: Wrench, time: float | Array = 0.0) -> Array:
        """Return the error of the force, (n,) N: its estimate, or the difference from `certain`."""
        return error_by(self.certain(), positions, field, time)

    def allowed_error(self, force: Array) -> Array:
        """Return the largest error that the scene allows for a force (n, 3), N; (n,) N."""
        return np.full(len(force), np.inf)

    def of_radius(self, radius: float) -> LightForce:
        """Return the force of the same light on a bead of another radius, m.

        Raises `SceneError` for an evaluator whose force does not scale with the radius.
        """
        if radius == self.light.radius:
            return self
        if not self.scales:
            raise SceneError(
                f"bead.radius: {type(self).__name__} gives the force at {self.light.radius:.4g} m "
                f"alone, as it does not scale with the radius; {radius:.4g} m is needed"
            )
        return dataclasses.replace(self, light=self.light.of_radius(radius))


def error_by(certain: Force, positions: Array, field: Wrench, time: float | Array) -> Array:
    """Return the error of the force of a field, (n,) N.

    It is the field's own estimate, if that is known for all positions. If any of it is NaN, all
    errors are differences from the force `certain`, plus the error of that force.

    Parameters
    ----------
    certain : Force
        Force to compare with.
    positions : ndarray, shape (n, 3)
        Positions from the focus, m.
    field : Wrench
        Force and torque at these positions.
    time : float or ndarray, shape (n,)
        Time, s.
    """
    if not np.isnan(field.error).any():
        return field.error
    exact = certain.field(positions, time=time)
    return np.linalg.norm(field.force - exact.force, axis=1) + exact.error
