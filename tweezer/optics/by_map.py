"""The force of light by interpolation in a table; by quadrature outside the table's range."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import address
from tweezer.errors import SceneError
from tweezer.forces.data import Data, Part
from tweezer.forces.force import KERNEL, Kernel, Wrench, bound, evaluated
from tweezer.optics import charts
from tweezer.optics.by_quadrature import ByQuadrature, to_tolerance
from tweezer.optics.light import LightForce, light_on_bead
from tweezer.optics.table import Table, stored
from tweezer.optics.tabulate import Made, Progress, build
from tweezer.scene import Scene
from tweezer.theory import NO_MAP

Array = NDArray[np.float64]

#: Tolerance of the quadrature that a table is made from, as a part of the table's
_FINER = 0.03


@dataclass(frozen=True, eq=False)
class ByMap(LightForce):
    """The polynomials of a table, with its certified error."""

    made: Made
    tolerance: float
    """relative, of the quadrature outside the table's range"""

    scales = True

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """See `Force.field`. The quadrature is compiled only if a position is out of range."""
        if gradient not in self._parts:
            kernel = address(self._kernel(gradient=gradient), KERNEL)
            self._parts[gradient] = Part(kernel, self._data(charts.unreached()))
        wrench = evaluated(self._parts[gradient], positions, gradient, time, orientations)
        outside = np.isinf(wrench.error)
        if outside.any():
            beyond = self._beyond.field(positions[outside], gradient=gradient)
            for everywhere, there in zip(wrench, beyond, strict=True):
                if len(everywhere):
                    everywhere[outside] = there
        return wrench

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """See `Force.compiled`."""
        data = self._with_gradient if gradient else self._without_gradient
        return self._kernel(gradient=gradient), data

    def _kernel(self, *, gradient: bool) -> Kernel:
        return charts.kernel(gradient=gradient, moment=self.made.moment)

    def _data(self, beyond: Part) -> Data:
        return self.made.data(self.light.radius, self.light.strength, beyond)

    @functools.cached_property
    def _with_gradient(self) -> Data:
        return self._data(bound(self._beyond, gradient=True))

    @functools.cached_property
    def _without_gradient(self) -> Data:
        return self._data(bound(self._beyond, gradient=False))

    @functools.cached_property
    def _beyond(self) -> ByQuadrature:
        return to_tolerance(self.light, self.tolerance)


def by_map(scene: Scene) -> ByMap:
    """The force of the light of `scene`, from its table: see `force_map`."""
    return ByMap(light_on_bead(scene), force_map(scene).made, scene.optics.tolerance)


def force_map(scene: Scene, progress: Progress | None = None) -> Table:
    """The table of the force of a scene's light, from the user's cache folder or computed and
    stored.

    It reaches `optics.table_range` from the focus. Its tolerance is `optics.table_tolerance`
    times the largest force there. progress: called with the finished part, 0 to 1, while it is
    computed; a second process that needs the same table waits for the first. One table serves every
    power of the light, and all scenes that differ only in scale.

    Raises `SceneError` for a scene without light, or with linear polarisation. Warns
    (`PhysicsWarning`) if the tolerance is not reached; `Table.certified_error` is the bound that
    holds. Warns if the file is damaged, and is then computed again, or if it cannot be written.
    """
    if scene.more_beams:
        raise SceneError("beam: a map is of one beam; a run makes that of each that it needs")
    light = light_on_bead(scene)
    if not scene.lit:
        raise SceneError("optics.evaluator = 'map': there is no light to map the force of")
    if scene.beam.polarisation == "linear":
        raise SceneError(NO_MAP)
    in_radii = dataclasses.replace(light, radius=1.0, momentum_per_energy=1 / light.cone.power)

    def make() -> Made:
        finer = max(1e-13, _FINER * scene.optics.table_tolerance)
        return build(
            to_tolerance(in_radii, finer).field,
            half_angle=light.cone.half_angle,
            tolerance=scene.optics.table_tolerance,
            reach=scene.table_radii,
            moment=light.torque,
            progress=progress,
        )

    made, path = stored(in_radii, scene, make)
    return Table(made, light.radius, light.strength, path)
