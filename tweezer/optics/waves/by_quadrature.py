"""The force of light as waves, by quadrature over the lens."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass

import numpy as np

from tweezer.forces.data import Data
from tweezer.forces.force import Kernel, Wrench
from tweezer.optics.light import LightForce
from tweezer.optics.waves.binding import Sums, sums
from tweezer.optics.waves.kernel import absorption, waves_kernel
from tweezer.optics.waves.light import BEYOND_LOSS, Waves, waves_on_bead
from tweezer.scene import Scene
from tweezer.scene.theory import LARGEST_IN_WAVES, no_rays
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Largest error that is allowed, in units of the wanted one
_MISSED = 2.0


@dataclass(frozen=True, eq=False)
class WavesByQuadrature(LightForce):
    """Force of the light by sums over partial waves, with amplitudes integrated over the lens."""

    light: Waves
    """plane waves behind the lens, and the sphere"""
    tolerance: float
    """relative, of the force"""
    reach: float
    """distance from the focus up to which compiled loops compute the force, m; beyond, its error is
    infinite"""
    alike: WavesByQuadrature | None = None
    """force of the same light and bead with another power, whose tables are used instead of
    computing new ones; None if there is none"""

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """Return force and torque at positions of the bead; see `Force.field`.

        Positions beyond the reach are computed with more nodes.

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
        if (there := self._reaching(positions)) is not self:
            return there.field(positions, gradient=gradient)
        return super().field(positions, gradient=gradient, time=time, orientations=orientations)

    def absorbed_power(self, positions: Array, *, time: float = 0.0) -> Array:
        """Return the power of the light that the bead absorbs at `positions` (n, 3) m, (n,) W."""
        if not self.light.absorbs:
            return super().absorbed_power(positions, time=time)
        there = self._reaching(positions)
        share: Array = absorption(uneven=self.light.uneven)(
            np.require(positions, np.float64, ["C"]), there.sums.data
        )
        return self.light.cone.power * share

    def _reaching(self, positions: Array) -> WavesByQuadrature:
        """Return this force with a reach, doubled as often as necessary, to all of `positions`."""
        farthest = float(np.linalg.norm(positions, axis=1).max(initial=0.0))
        if farthest > self.reach:
            _not_too_far(self.light, "positions", farthest, "allowed: up to that")
        force = self
        while farthest > force.reach:
            force = force._farther
        return force

    @functools.cached_property
    def _farther(self) -> WavesByQuadrature:
        """Copy of this force with twice the reach. Its tables are computed once."""
        alike = None if self.alike is None else self.alike._farther
        return dataclasses.replace(self, reach=2 * self.reach, alike=alike)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return waves_kernel(moment=self.light.absorbs, uneven=self.light.uneven), self.sums.data

    @functools.cached_property
    def sums(self) -> Sums:
        """Data that the compiled sums read, with those of `alike` rescaled if there is one."""
        if self.alike is not None:
            return self.alike.sums.of_strength(self.light.strength)
        return sums(self.light, self.tolerance, self.reach)

    def allowed_error(self, force: Array) -> Array:
        """Return the largest error within the tolerance, (n,) N; force: (n, 3) N."""
        size = np.linalg.norm(force, axis=1)
        return _MISSED * (self.tolerance * size + self.sums.allowed * self.light.strength)

    def of_radius(self, radius: float) -> WavesByQuadrature:
        """Return the force of the same light on a bead of another radius, m."""
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
    """Return the force of the light of `scene` as waves, by quadrature to `optics.tolerance`.

    Tables do not depend on the power: they are computed for 1 W, kept, and rescaled.
    """
    alike = _of_one_watt(scene.of_power(1.0))
    return dataclasses.replace(alike, light=waves_on_bead(scene), alike=alike)


@functools.lru_cache(maxsize=8)
def _of_one_watt(scene: Scene) -> WavesByQuadrature:
    """Return the force of the light of a scene whose power is 1 W; the last few are kept.

    Raises `SceneError` if the bead is too large for wave optics, or may go too far from the focus.
    """
    light = waves_on_bead(scene)
    checked_size(scene, light)
    reach = BEYOND_LOSS * scene.simulation.loss_distance
    return WavesByQuadrature(light, scene.optics.tolerance, reach)


def checked_size(scene: Scene, light: Waves) -> None:
    """Raise `SceneError` for a bead too large for wave optics, or that may go too far away."""
    if light.size_parameter > LARGEST_IN_WAVES:
        raise SceneError(
            f"bead.radius = {light.radius:.3g}: waves are computed for beads up to "
            f"{LARGEST_IN_WAVES / light.wavenumber:.3g} m; {_smaller(scene, 'bead.radius')}"
        )
    loss = scene.simulation.loss_distance
    name = "simulation.loss_distance"
    _not_too_far(light, name, loss, _smaller(scene, name))
