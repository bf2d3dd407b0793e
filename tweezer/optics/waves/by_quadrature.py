"""The force of light as waves, by quadrature over the lens."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.forces.data import Data
from tweezer.forces.force import Kernel, Wrench
from tweezer.optics.light import LightForce
from tweezer.optics.waves.binding import Sums, sums
from tweezer.optics.waves.kernel import absorption, waves_kernel
from tweezer.optics.waves.light import Waves, waves_on_bead
from tweezer.scene import Scene
from tweezer.scene.theory import LARGEST_IN_WAVES, no_rays
from tweezer.values.errors import SceneError

Array = NDArray[np.float64]

#: Largest allowed error, in estimates
_MISSED = 2.0
#: Distance up to which compiled loops compute the force: of the distance at which the bead is lost
_BEYOND_LOSS = 1.25


@dataclass(frozen=True, eq=False)
class WavesByQuadrature(LightForce):
    """The sum over partial waves, whose amplitudes are integrals over the lens."""

    light: Waves
    tolerance: float
    """relative, of the force"""
    reach: float
    """distance from the focus up to which compiled loops compute the force, m; beyond, its error is
    infinite"""
    alike: WavesByQuadrature | None = None
    """the same of another power, whose tables serve here too"""

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """See `Force.field`. Places beyond the reach take more nodes."""
        if (there := self._reaching(positions)) is not self:
            return there.field(positions, gradient=gradient)
        return super().field(positions, gradient=gradient, time=time, orientations=orientations)

    def absorbed_power(self, positions: Array) -> Array:
        """See `LightForce.absorbed_power`."""
        if not self.light.absorbs:
            return super().absorbed_power(positions)
        there = self._reaching(positions)
        share: Array = absorption()(np.require(positions, np.float64, ["C"]), there.sums.data)
        return self.light.cone.power * share

    def _reaching(self, positions: Array) -> WavesByQuadrature:
        """The same up to the farthest of `positions` at least."""
        farthest = float(np.linalg.norm(positions, axis=1).max(initial=0.0))
        if farthest > self.reach:
            _not_too_far(self.light, "positions", farthest, "allowed: up to that")
        force = self
        while farthest > force.reach:
            force = force._farther
        return force

    @functools.cached_property
    def _farther(self) -> WavesByQuadrature:
        """The same up to twice the distance, bound once."""
        alike = None if self.alike is None else self.alike._farther
        return dataclasses.replace(self, reach=2 * self.reach, alike=alike)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """See `Force.compiled`."""
        return waves_kernel(moment=self.light.absorbs), self.sums.data

    @functools.cached_property
    def sums(self) -> Sums:
        """What the compiled sums read."""
        if self.alike is not None:
            return self.alike.sums.of_strength(self.light.strength)
        return sums(self.light, self.tolerance, self.reach)

    def allowed_error(self, force: Array) -> Array:
        """See `LightForce.allowed_error`."""
        size = np.linalg.norm(force, axis=1)
        return _MISSED * (self.tolerance * size + self.sums.allowed * self.light.strength)

    def of_radius(self, radius: float) -> WavesByQuadrature:
        """See `LightForce.of_radius`."""
        return WavesByQuadrature(self.light.of_radius(radius), self.tolerance, self.reach)


def _not_too_far(light: Waves, name: str, distance: float, remedy: str) -> None:
    """Raise `SceneError` for a distance from the focus, m, that would take too many nodes."""
    if distance > light.farthest:
        raise SceneError(
            f"{name} = {distance:.3g}: waves are computed up to {light.farthest:.3g} m from the "
            f"focus; {remedy}"
        )


def _smaller(scene: Scene, name: str) -> str:
    """Return the remedy for a setting that is too large for wave optics."""
    smaller = f"set a smaller {name}"
    if no_rays(scene.bead, scene.lens, scene.beams):
        return smaller
    return f"{smaller} or optics.theory = 'rays'"


def by_quadrature(scene: Scene) -> WavesByQuadrature:
    """The force of the light of `scene` as waves, to `optics.tolerance`.

    What does not depend on the power is computed once for each light.
    """
    alike = _of_one_watt(scene.of_power(1.0))
    return dataclasses.replace(alike, light=waves_on_bead(scene), alike=alike)


@functools.lru_cache(maxsize=8)
def _of_one_watt(scene: Scene) -> WavesByQuadrature:
    """The same of a scene whose light is of 1 W."""
    light = waves_on_bead(scene)
    if light.size_parameter > LARGEST_IN_WAVES:
        raise SceneError(
            f"bead.radius = {light.radius:.3g}: waves are computed for beads up to "
            f"{LARGEST_IN_WAVES / light.wavenumber:.3g} m; {_smaller(scene, 'bead.radius')}"
        )
    loss = scene.simulation.loss_distance
    name = "simulation.loss_distance"
    _not_too_far(light, name, loss, _smaller(scene, name))
    return WavesByQuadrature(light, scene.optics.tolerance, _BEYOND_LOSS * loss)
