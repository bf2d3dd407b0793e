"""The force of rays by interpolation in a table."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from tweezer.optics import table
from tweezer.optics.mapped import Mapped
from tweezer.optics.rays.by_quadrature import to_tolerance
from tweezer.optics.rays.light import RayLight, light_on_bead
from tweezer.optics.rays.tabulate import Made, build
from tweezer.optics.table import Progress, Table, sources
from tweezer.scene import Scene
from tweezer.scene.theory import NO_MAP
from tweezer.values.errors import SceneError

#: Tolerance of the quadrature that a table is made from, as a part of the table's
_FINER = 0.03

_SOURCES = sources(
    "generated.ray", "optics.polynomials",
    *(
        f"optics.rays.{name}"
        for name in (
            "by_map", "by_quadrature", "charts", "light", "nodes", "panels", "quadrature",
            "ray_sum", "rule", "tabulate",
        )
    ),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class ByMap(Mapped):
    """Force of rays read from a map, which in radii of the bead is the same for every radius."""

    def of_radius(self, radius: float) -> Self:
        """Return the force of the same light on a bead of another radius, m."""
        scaled = self.light.of_radius(radius)
        outside = self.outside.of_radius(radius)
        return dataclasses.replace(self, light=scaled, unit=radius, outside=outside)


def by_map(scene: Scene) -> ByMap:
    """Return the force of the rays of `scene`, read from its map; made if not stored."""
    rays = light_on_bead(scene)
    made, _ = _stored(scene, rays)
    return ByMap(rays, made, rays.radius, to_tolerance(rays, scene.optics.tolerance))


def ray_map(scene: Scene, progress: Progress | None = None) -> Table:
    """Return the map of the force of the rays of `scene`: see `tweezer.optics.force_map`."""
    rays = light_on_bead(scene)
    made, path = _stored(scene, rays, progress)
    return Table(made, rays.radius, rays.strength, path)


def _stored(
    scene: Scene, rays: RayLight, progress: Progress | None = None
) -> tuple[Made, Path | None]:
    """Return the map of a scene and the file it is stored in; it is made if there is no file.

    The file's name follows from everything that affects the map. In units of the radius and of
    n_m P/c, radius and power do not affect it.
    """
    if scene.beam.polarisation == "linear":
        raise SceneError(NO_MAP)
    in_radii = dataclasses.replace(rays, radius=1.0, momentum_per_energy=1 / rays.cone.power)
    tolerance, reach = scene.optics.table_tolerance, scene.table_radii

    def make() -> Made:
        """Compute the map by a quadrature that is more accurate than the map's tolerance."""
        return build(
            to_tolerance(in_radii, max(1e-13, _FINER * tolerance)).field,
            half_angle=rays.cone.half_angle,
            tolerance=tolerance,
            reach=reach,
            moment=rays.torque,
            progress=progress,
        )

    key = table.key(
        _SOURCES, rays.cone, rays.cone.half_angle, rays.index_ratio, rays.polarisation, rays.torque,
        tolerance, reach,
    )  # fmt: skip
    return table.stored(key, tolerance, Made, make)
