"""Force map of light that interferes, by splines over a box (`box`)."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np

from tweezer.forces.composed import Course
from tweezer.optics import table
from tweezer.optics.light import LightForce
from tweezer.optics.mapped import Mapped
from tweezer.optics.table import Progress, Table, sources
from tweezer.optics.waves import box
from tweezer.optics.waves.amplitudes import Path
from tweezer.optics.waves.box import Spline
from tweezer.optics.waves.by_map import FINER
from tweezer.optics.waves.coherent import ByInterference, Interference
from tweezer.scene import Scene

_SOURCES = sources(
    "compiled.lanes", "generated.spline", "generated.waves", "optics.mask", "optics.sectors",
    "optics.shaped", "optics.zernike",
    *(
        f"optics.waves.{name}"
        for name in (
            "amplitudes", "binding", "box", "by_map", "coherent", "coherent_map", "focus", "grid",
            "harmonics", "kernel", "light", "mirror", "nodes", "partial_waves", "pupil", "sphere",
            "terms",
        )
    ),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class CoherentByMap(Mapped):
    """Force of light that interferes, read from a map, and by quadrature outside of it."""

    light: Interference
    """the light, and the sphere"""
    outside: ByInterference
    """force outside the range of the map"""
    tolerance: float
    """of the map, as a part of the largest force"""

    def of_radius(self, radius: float) -> LightForce:
        """Return the force of this light on a bead of another radius, m; its map is not stored."""
        if radius == self.light.radius:
            return self
        outside = self.outside.of_radius(radius)
        made = _made(outside, self.tolerance, self.made.reach)
        return dataclasses.replace(self, light=outside.light, made=made, outside=outside)


def by_coherent_map(scene: Scene, force: ByInterference) -> CoherentByMap:
    """Return the force of light that interferes, read from its map; made if it is not stored."""
    made, _ = _stored(scene, force)
    unit = 1 / force.light.wavenumber
    return CoherentByMap(force.light, made, unit, force, scene.optics.table_tolerance)


def coherent_map(scene: Scene, force: ByInterference, progress: Progress | None = None) -> Table:
    """Return the map of the force of light that interferes: see `tweezer.optics.force_map`."""
    made, path = _stored(scene, force, progress)
    return Table(made, 1 / force.light.wavenumber, force.light.strength, path)


def _stored(
    scene: Scene, force: ByInterference, progress: Progress | None = None
) -> tuple[Spline, FilePath | None]:
    """Return the map of a scene and the file it is stored in; it is made if there is no file.

    The file's name follows from everything that affects the map, in units of 1/k and n_m P/c.
    """
    light, tolerance = force.light, scene.optics.table_tolerance
    k, reach = light.wavenumber, light.wavenumber * scene.table_reach
    shells = [(k * outer, index) for outer, index in light.paths[0].light.shells]
    said = []
    for path in light.paths:
        own = path.light
        cone = (own.cone.half_angle, (own.cone.series / light.power).tolist())
        said.append((
            cone, own.states, own.face, own.pupil, getattr(own, "index", None), path.down,
            (k * path.place.at(0.0)).tolist(), path.strength.at(0.0).tolist(),
            path.phase.at(0.0).tolist(), path.mirror and k * path.mirror,
        ))  # fmt: skip
    key = table.key(_SOURCES, light.cone, said, shells, tolerance, reach)
    make = functools.partial(_made, force, tolerance, reach, progress)
    return table.stored(key, tolerance, Spline, make)


def _made(
    force: ByInterference, tolerance: float, reach: float, progress: Progress | None = None
) -> Spline:
    """Compute the map of light that interferes, in units of 1/k and n_m P/c.

    `tolerance` is a part of the largest force, and `reach` the distance from the foci in 1/k.
    `progress` is called with the finished part. Light from both sides has wave numbers along z up
    to 2 k.
    """
    in_units = _light_in_units(force.light)
    region = _region(in_units, reach)
    return box.build(
        ByInterference(in_units, FINER * tolerance, region.farthest, 0.0).field,
        region=region,
        reach=reach,
        tolerance=tolerance,
        moment=in_units.absorbs,
        progress=progress,
    )


def check_map(scene: Scene, force: ByInterference) -> None:
    """Raise `SceneError` if light that interferes needs a box that is too large for a map."""
    light = force.light
    region = _region(_light_in_units(light), light.wavenumber * scene.table_reach)
    region.intervals(scene.optics.table_tolerance, moment=light.absorbs)


def _light_in_units(light: Interference) -> Interference:
    """Return light that interferes with lengths in 1/k and forces in n_m P/c."""
    k = light.wavenumber
    paths = tuple(_in_units(path, k, light.power) for path in light.paths)
    return dataclasses.replace(
        light, paths=paths, radius=k * light.radius, momentum_per_energy=1 / light.power
    )


def _region(in_units: Interference, reach: float) -> box.Region:
    """Return the box about all foci of light in units of `_light_in_units`, and beyond them."""
    angle = max(path.light.focus.half_angle for path in in_units.paths)
    ways = {path.down != (path.mirror is not None) for path in in_units.paths}
    along = 2.0 if len(ways) > 1 else 2 * math.sin(angle / 2) ** 2
    band = np.array([2 * math.sin(angle), 2 * math.sin(angle), along])
    foci = in_units.foci
    return box.Region(band, foci.min(axis=0) - reach, foci.max(axis=0) + reach)


def _in_units(path: Path, k: float, power: float) -> Path:
    """Return a path that does not move, with lengths in 1/k and forces in n_m P/c."""
    own = path.light.of_radius(k * path.light.radius)
    return dataclasses.replace(
        path,
        light=dataclasses.replace(
            own, wavenumber=1.0, momentum_per_energy=1 / power, ends=math.inf
        ),
        place=Course.constant(*(k * path.place.at(0.0))),
        mirror=None if path.mirror is None else k * path.mirror,
    )
