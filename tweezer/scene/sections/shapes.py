"""Shapes of a bead: their keys, and the sphere that encloses each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import Field, model_validator

from tweezer.scene.choices import SHAPES
from tweezer.scene.courses import Vector, refusal
from tweezer.scene.materials import materials
from tweezer.scene.sections.alternatives import Filled, with_half
from tweezer.values.units import BEAD_RADIUS, BeadRadius, ComplexIndex, Density, entries

if TYPE_CHECKING:
    MaterialName: TypeAlias = str
    ShapeName: TypeAlias = str


if not TYPE_CHECKING:
    MaterialName = Literal[tuple(materials())]
    ShapeName = Literal[tuple(SHAPES)]


class Round(Filled):
    """Base of a section with a `radius`, for which `diameter` may be given instead."""

    @property
    def diameter(self) -> float:
        """Twice the radius, m."""
        radius: float = vars(self)["radius"]
        return 2 * radius


class ClusterSphere(Round):
    """A sphere of a rigid cluster. `diameter` may replace `radius`."""

    radius: BeadRadius = Field(description="radius")
    material: MaterialName | None = Field(
        None,
        description="gives the refractive index at the beam's wavelength, as of the bead, and the "
        "density if the bead has none",
    )
    refractive_index: ComplexIndex = Field(
        description="refractive index, as of the bead; not needed with a `material`"
    )
    density: Density | None = Field(None, description="density. Default: as of the bead")
    position: Vector = Field(description="centre of the sphere in the body's frame")

    @model_validator(mode="before")
    @classmethod
    def _size(cls, data: Any) -> Any:
        """Replace a diameter in the data by the radius."""
        return with_half(data, "radius", "diameter", *BEAD_RADIUS)


ClusterSpheres = Annotated[tuple[ClusterSphere, ...], entries(1, 20)]


def check_keys(shape: str, given: Mapping[str, Any]) -> None:
    """Refuse keys that belong to other shapes, and missing keys of this shape.

    Parameters
    ----------
    shape : str
        Name in `SHAPES`.
    given : mapping
        Values of the keys of all shapes, `layers`, `refractive_index` and `moments_of_inertia`.
    """
    for other in SHAPES.values():
        for key in other.needs:
            if given.get(key) is not None and other.name != shape:
                raise refusal(
                    f"{key}: does not apply to shape = {shape!r}; remove it, or set shape to "
                    f"{other.name}"
                )
            if given.get(key) is None and other.name == shape:
                raise refusal(f"{key}: missing; shape = {shape!r} requires it")
    if shape != "sphere" and given.get("layers") is not None:
        raise refusal(f"layers: do not apply to shape = {shape!r}; remove them, or the shape")
    if not SHAPES[shape].index and given.get("refractive_index") is not None:
        own = "each of the spheres has" if shape == "spheres" else "the file has"
        raise refusal(
            f"refractive_index: does not apply to shape = {shape!r}, because {own} an index; "
            "remove it"
        )
    if shape in ("spheroid", "spheres") and given.get("moments_of_inertia") is not None:
        raise refusal(
            f"moments_of_inertia: follow from density and size for shape = {shape!r}; remove them"
        )
    needs_index = SHAPES[shape].index and given.get("layers") is None
    if needs_index and given.get("refractive_index") is None:
        raise refusal("refractive_index: missing")


def check_apart(spheres: Sequence[ClusterSphere]) -> None:
    """Refuse spheres of a cluster that overlap."""
    for i, one in enumerate(spheres, start=1):
        for j, other in enumerate(spheres[: i - 1], start=1):
            apart = math.dist(one.position, other.position)
            if apart < (one.radius + other.radius) * (1 - 1e-9):
                raise refusal(
                    f"spheres: {j} and {i} overlap; their centres are {apart:.4g} m apart and "
                    f"must be at least {one.radius + other.radius:.4g} m apart"
                )


def enclosing_radius(spheres: Sequence[ClusterSphere], density: float) -> float:
    """Return the radius of the sphere about the centre of mass that encloses a cluster, m.

    `density` is of the spheres that have none of their own.
    """
    centre = centre_of_mass(spheres, density)
    return max(math.dist(each.position, centre) + each.radius for each in spheres)


def densities(spheres: Sequence[ClusterSphere], density: float) -> list[float]:
    """Return the density of each sphere: its own, or `density` if it has none, kg/m^3."""
    return [density if each.density is None else each.density for each in spheres]


def centre_of_mass(spheres: Sequence[ClusterSphere], density: float) -> tuple[float, float, float]:
    """Return the centre of mass of the spheres of a cluster, m; see `enclosing_radius`."""
    each_has = zip(densities(spheres, density), spheres, strict=True)
    masses = [rho / density * each.radius**3 for rho, each in each_has]
    whole = sum(masses)
    x, y, z = (
        sum(mass * each.position[i] for mass, each in zip(masses, spheres, strict=True)) / whole
        for i in range(3)
    )
    return x, y, z
