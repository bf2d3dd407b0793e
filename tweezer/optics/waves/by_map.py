"""The force of waves by interpolation in a table."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tweezer.optics import table
from tweezer.optics.light import LightForce
from tweezer.optics.mapped import Mapped
from tweezer.optics.table import Progress, Table, sources
from tweezer.optics.waves import box, by_quadrature
from tweezer.optics.waves.box import Spline
from tweezer.optics.waves.by_quadrature import WavesByQuadrature
from tweezer.optics.waves.lattice import Lattice, build
from tweezer.optics.waves.light import Waves, waves_on_bead
from tweezer.scene import Scene

#: Tolerance of the quadrature that a table is made from, as a part of the table's
FINER = 0.01

_SOURCES = sources(
    "compiled.lanes", "generated.spline", "generated.waves", "optics.mask", "optics.polynomials",
    "optics.sectors", "optics.shaped", "optics.zernike",
    *(
        f"optics.waves.{name}"
        for name in (
            "binding", "box", "by_map", "by_quadrature", "focus", "grid", "harmonics", "kernel",
            "lattice", "light", "nodes", "partial_waves", "pupil", "sphere", "terms",
        )
    ),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class WavesByMap(Mapped):
    """Force of waves on a sphere of one size, read from a map, and by quadrature outside of it."""

    light: Waves
    """plane waves behind the lens, and the sphere"""
    outside: WavesByQuadrature
    """force outside the range of the map"""
    tolerance: float
    """of the map, as a part of the largest force"""

    def of_radius(self, radius: float) -> LightForce:
        """Return the force of this light on a bead of another radius, m; its map is not stored."""
        if radius == self.light.radius:
            return self
        scaled = self.light.of_radius(radius)
        made = _made(scaled, self.tolerance, self.made.reach)
        outside = self.outside.of_radius(radius)
        return dataclasses.replace(self, light=scaled, made=made, outside=outside)


def by_map(scene: Scene) -> WavesByMap:
    """Return the force of the light of `scene` as waves, read from its map; made if not stored."""
    of_bead = waves_on_bead(scene)
    made, _ = _stored(scene, of_bead)
    outside = by_quadrature.by_quadrature(scene)
    unit = 1 / of_bead.wavenumber
    return WavesByMap(of_bead, made, unit, outside, scene.optics.table_tolerance)


def wave_map(scene: Scene, progress: Progress | None = None) -> Table:
    """Return the map of the force of the waves of `scene`: see `tweezer.optics.force_map`."""
    of_bead = waves_on_bead(scene)
    made, path = _stored(scene, of_bead, progress)
    return Table(made, 1 / of_bead.wavenumber, of_bead.strength, path)


def _stored(
    scene: Scene, of_bead: Waves, progress: Progress | None = None
) -> tuple[Lattice | Spline, Path | None]:
    """Return the map of a scene and the file it is stored in; it is made if there is no file.

    The file's name follows from everything that affects the map. In units of 1/k and n_m P/c,
    wavelength and power do not affect it.
    """
    tolerance = scene.optics.table_tolerance
    reach = of_bead.wavenumber * scene.table_reach
    shells = [(of_bead.wavenumber * outer, index) for outer, index in of_bead.shells]
    key = table.key(
        _SOURCES, of_bead.cone, of_bead.cone.half_angle, of_bead.cone.inner, of_bead.states,
        of_bead.face, of_bead.pupil, shells, tolerance, reach,
    )  # fmt: skip
    make = functools.partial(_made, of_bead, tolerance, reach, progress)
    kind: type[Lattice | Spline] = Lattice if _twofold(of_bead) else Spline
    return table.stored(key, tolerance, kind, make)


def _twofold(of_bead: Waves) -> bool:
    """Return whether the force has harmonics 0 and 2 alone about the axis, through its one focus.

    Two parts of the light whose angular momenta differ by m give the harmonic m.
    """
    pupil = of_bead.pupil
    if pupil is not None and (of_bead.uneven or pupil.spots):
        return False
    momenta = [{part.angular_momentum for part in each.parts} for each in of_bead.states]
    return all(max(each) - min(each) in (0, 2) for each in momenta)


def _made(
    of_bead: Waves, tolerance: float, reach: float, progress: Progress | None = None
) -> Lattice | Spline:
    """Compute the map of the force of waves on a bead, in units of 1/k and n_m P/c.

    `tolerance` is a part of the largest force, and `reach` the distance from the focus in 1/k.
    Light of several foci has a box about all of them. `progress` is called with the finished part.
    """
    in_units = _in_units(of_bead)
    angle = in_units.focus.half_angle
    across, along = 2 * math.sin(angle), 2 * math.sin(angle / 2) ** 2
    if _twofold(in_units):
        return build(
            WavesByQuadrature(in_units, FINER * tolerance, 1.01 * reach).field,
            band=(across, along),
            reach=reach,
            tolerance=tolerance,
            symmetric=in_units.symmetric,
            moment=in_units.absorbs,
            progress=progress,
        )
    region = _region(in_units, reach)
    return box.build(
        WavesByQuadrature(in_units, FINER * tolerance, region.farthest).field,
        region=region,
        reach=reach,
        tolerance=tolerance,
        moment=in_units.absorbs,
        progress=progress,
    )


def check_map(scene: Scene) -> None:
    """Raise `SceneError` if the light of a scene needs a box that is too large for a map."""
    of_bead = waves_on_bead(scene)
    if not _twofold(of_bead):
        region = _region(_in_units(of_bead), of_bead.wavenumber * scene.table_reach)
        region.intervals(scene.optics.table_tolerance, moment=of_bead.absorbs)


def _in_units(of_bead: Waves) -> Waves:
    """Return light on a bead with lengths in 1/k and forces in n_m P/c."""
    return dataclasses.replace(
        of_bead.of_radius(of_bead.size_parameter),
        wavenumber=1.0,
        momentum_per_energy=1 / of_bead.cone.power,
        ends=math.inf,
    )


def _region(in_units: Waves, reach: float) -> box.Region:
    """Return the box about all foci of light in units of `_in_units`, and `reach` beyond them."""
    angle, foci = in_units.focus.half_angle, in_units.foci
    across, along = 2 * math.sin(angle), 2 * math.sin(angle / 2) ** 2
    band = np.array([across, across, along])
    return box.Region(band, foci.min(axis=0) - reach, foci.max(axis=0) + reach)
