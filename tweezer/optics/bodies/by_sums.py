"""The force and torque of light on a body of any shape, by direct sums over partial waves."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tweezer.forces.data import Data, renumbered
from tweezer.forces.force import Kernel, Wrench
from tweezer.optics.binding import Beams
from tweezer.optics.bodies.binding import body_data
from tweezer.optics.bodies.kernel import ABSORBED, DERIVATIVE, body_kernel, body_sums, of_strength
from tweezer.optics.bodies.shapes import t_matrix
from tweezer.optics.bodies.t_matrix import TMatrix
from tweezer.optics.light import LightForce
from tweezer.optics.waves.light import BEYOND_LOSS, Waves, waves_on_bead
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError


@dataclass(frozen=True, eq=False)
class LightOnBody(LightForce):
    """Force and torque of the light of one beam on a body, from its T-matrix."""

    light: Waves
    """the light, with the radius of the sphere that encloses the body"""
    body: TMatrix
    """the body"""
    tolerance: float
    """relative, of the force"""
    reach: float
    """distance from the focus up to which compiled loops compute the force, m"""
    upright: tuple[float, ...]
    """Euler parameters where none are given"""
    alike: LightOnBody | None = None
    """force of the same light and body with another power, whose tables are rescaled"""

    @property
    def oriented(self) -> bool:
        """Whether the force depends on the orientation or turns the body: always."""
        return True

    @property
    def symmetric(self) -> bool:
        """Whether the force is the same all around the axis of the light: never for a body."""
        return False

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """Return force and torque at positions and orientations of the body; see `Force.field`.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        gradient : bool, optional
            Whether to compute gradients over the position too.
        time : float or ndarray, shape (n,), optional
            Time, s.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters. Default: those of the start.
        """
        return super(LightOnBody, self._reaching(positions)).field(
            positions, gradient=gradient, time=time,
            orientations=self._turned(positions, orientations),
        )  # fmt: skip

    def derivative(self, positions: Array, orientations: Array | None = None) -> Array:
        """Return the derivative of force and torque over position and orientation, (n, 6, 6).

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters. Default: those of the start.

        Returns
        -------
        ndarray, shape (n, 6, 6)
            d(F, M)/d(r, angle), with rotations about the laboratory's axes; N/m, N, N and N m.
        """
        sums = self._sums(positions, orientations, derivative=True)
        return sums[:, DERIVATIVE:].reshape(-1, 6, 6)

    def absorbed_power(
        self,
        positions: Array,
        orientations: Array | None = None,
        *,
        time: float = 0.0,  # noqa: ARG002
    ) -> Array:
        """Return the power of the light that the body absorbs, (n,) W.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters. Default: those of the start.
        time : float, optional
            Time, s. The light is constant.
        """
        sums = self._sums(positions, orientations, derivative=False)
        return self.light.cone.power * sums[:, ABSORBED]

    def _sums(self, positions: Array, orientations: Array | None, *, derivative: bool) -> Array:
        """Return the sums of `kernel.body_sums` at positions and orientations, (n, 44)."""
        found: Array = body_sums()(
            np.require(positions, np.float64, ["C", "W"]),  # compiled for arrays that are writable
            np.require(self._turned(positions, orientations), np.float64, ["C", "W"]),
            self._reaching(positions).data, derivative,
        )  # fmt: skip
        return found

    def _turned(self, positions: Array, orientations: Array | None) -> Array:
        """Return Euler parameters (n, 4) of length 1; those of the start if none are given."""
        if orientations is None:
            orientations = np.broadcast_to(self.upright, (len(positions), 4))
        return orientations / np.linalg.norm(orientations, axis=1, keepdims=True)

    def _reaching(self, positions: Array) -> LightOnBody:
        """Return this force with a reach, doubled as often as necessary, to all of `positions`."""
        farthest = float(np.linalg.norm(positions, axis=1).max(initial=0.0))
        force = self
        while farthest > force.reach:
            if farthest > self.light.farthest:
                raise SceneError(
                    f"positions = {farthest:.3g}: waves are computed up to "
                    f"{self.light.farthest:.3g} m from the focus; allowed: up to that"
                )
            force = force._farther
        return force

    @functools.cached_property
    def _farther(self) -> LightOnBody:
        """Copy of this force with twice the reach."""
        alike = None if self.alike is None else self.alike._farther
        return dataclasses.replace(self, reach=2 * self.reach, alike=alike)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return body_kernel(), self.data

    @functools.cached_property
    def data(self) -> Data:
        """Data of the compiled sums."""
        if self.alike is None:
            return body_data(self.body, self.light, self.tolerance, self.reach)
        ratio = self.light.strength / self.alike.light.strength
        return renumbered(self.alike.data, of_strength(self.alike.data, ratio))

    def allowed_error(self, force: Array) -> Array:
        """Return the largest error within the tolerance, (n,) N; force: (n, 3) N."""
        size = np.linalg.norm(force, axis=1)
        return 2 * self.tolerance * (size + self.light.strength)

    def of_radius(self, radius: float) -> LightForce:
        """Refuse: a body of another size has another T-matrix."""
        raise SceneError(f"bead.radius = {radius:.4g}: a body is not scaled; make another scene")


def by_sums(scene: Scene) -> LightOnBody:
    """Return the force of the light of `scene` on a body that is not a sphere.

    Tables do not depend on the power: they are computed for 1 W, kept, and rescaled.
    """
    alike = _of_one_watt(scene.of_power(1.0))
    light = dataclasses.replace(waves_on_bead(scene), radius=alike.body.radius)
    return dataclasses.replace(alike, light=light, alike=alike, upright=scene.start.orientation)


@functools.lru_cache(maxsize=8)
def _of_one_watt(scene: Scene) -> LightOnBody:
    """Return the force of the light of a scene whose power is 1 W; the last few are kept."""
    body = t_matrix(scene)
    light = dataclasses.replace(waves_on_bead(scene), radius=body.radius)
    return LightOnBody(
        light, body, scene.optics.tolerance, BEYOND_LOSS * scene.simulation.loss_distance,
        scene.start.orientation,
    )  # fmt: skip


def derivative_of(
    force: LightForce | Beams, positions: Array, orientations: Array, time: float
) -> Array:
    """Return the derivative of force and torque of all beams, (n, 6, 6).

    Parameters
    ----------
    force : LightForce or Beams
        Light of one beam or of several on a body.
    positions : ndarray, shape (n, 3)
        Positions, m.
    orientations : ndarray, shape (n, 4)
        Euler parameters.
    time : float
        Time, s.
    """
    if isinstance(force, LightOnBody):
        return force.derivative(positions, orientations)
    found = np.zeros((len(positions), 6, 6))
    for factor, light, place, turned, down in _each(force, positions, orientations, time):
        sign = np.tile([1.0, -1.0, -1.0], 2) if down else np.ones(6)
        found += factor * sign[:, None] * sign * light.derivative(place, turned)
    return found


def absorbed_of(
    force: LightForce | Beams, positions: Array, orientations: Array, time: float
) -> Array:
    """Return the power that a body absorbs from all beams, (n,) W.

    Parameters
    ----------
    force : LightForce or Beams
        Light of one beam or of several on a body.
    positions : ndarray, shape (n, 3)
        Positions, m.
    orientations : ndarray, shape (n, 4)
        Euler parameters.
    time : float
        Time, s.
    """
    if isinstance(force, LightOnBody):
        return force.absorbed_power(positions, orientations)
    found = np.zeros(len(positions))
    for factor, light, place, turned, _ in _each(force, positions, orientations, time):
        found += factor * light.absorbed_power(place, turned)
    return found


def _each(
    force: LightForce | Beams, positions: Array, orientations: Array, time: float
) -> Iterator[tuple[float, LightOnBody, Array, Array, bool]]:
    """Yield each lit beam: factor of its power, its force, the pose in its frame, whether down."""
    if not isinstance(force, Beams):
        return  # the only beam has no power
    for moved, light in zip(force.forces, force.lights, strict=True):
        if not isinstance(light, LightOnBody):
            continue  # a beam without power
        turned = orientations
        if moved.down:  # half a turn about x, as the beam
            w, x, y, z = orientations.T
            turned = np.stack([-x, w, -z, y], axis=1)
        factor = float(moved.strength.at(time)[0])
        yield factor, light, moved.within(positions, time), turned, moved.down
