"""Shapes of a bead: their keys, and the sphere that encloses each."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import Field, model_validator

from tweezer.scene.choices import SHAPES
from tweezer.scene.courses import Vector, refusal
from tweezer.scene.materials import materials
from tweezer.scene.sections.alternatives import ACCEPTING, Filled, with_half
from tweezer.values.units import (
    BEAD_RADIUS,
    BeadRadius,
    ComplexIndex,
    Density,
    Length,
    Quantity,
    entries,
)

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


class Layer(Round):
    """A layer of a bead: the core, or a shell about the layer before. `diameter` may replace
    `radius`.
    """

    radius: BeadRadius = Field(description="outer radius")
    material: MaterialName | None = Field(
        None,
        description="material of the layer, which sets its refractive index at the wavelength of "
        "the beam",
    )
    refractive_index: ComplexIndex = Field(
        description="refractive index, real or complex; not needed with a `material`"
    )

    @model_validator(mode="before")
    @classmethod
    def _size(cls, data: Any) -> Any:
        """Replace a diameter in the data by the radius."""
        return with_half(data, "radius", "diameter", *BEAD_RADIUS)


Layers = Annotated[tuple[Layer, ...], entries(1, 20)]


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


SemiAxes = Annotated[tuple[BeadRadius, BeadRadius, BeadRadius], entries(3)]
_Across = Annotated[float, Quantity("m", 0.0, BEAD_RADIUS[1])]
ProfilePoints = Annotated[
    tuple[Annotated[tuple[_Across, Length], entries(2)], ...], entries(3, 100)
]
#: Keys whose refusal has its own words
_SAID = ("layers", "moments_of_inertia")


def follows(data: Mapping[str, Any]) -> str:
    """Return the keys from which the size of a bead follows; "" for a bead with a radius.

    Keys in the data that belong to other shapes are refused.
    """
    shape = SHAPES[data.get("shape") or "sphere"]
    for key, names in ACCEPTING.items():
        if data.get(key) is not None and shape.name not in names and key not in _SAID:
            *others, last = names
            choice = f"{', '.join(others)} or {last}" if others else last
            raise refusal(
                f"{key}: does not apply to shape = {shape.name!r}; remove it, or set shape to "
                f"{choice}"
            )
    return "" if shape.sized else " and ".join(shape.needs)


def check_profile(points: Sequence[tuple[float, float]]) -> None:
    """Refuse a profile that is open, touches the axis between its ends, or meets itself."""
    for i in (0, len(points) - 1):
        if points[i][0] != 0:
            raise refusal(f"points.{i} = {list(points[i])}: must be on the axis, at radius 0")
    for i, (r, _) in enumerate(points[1:-1], start=1):
        if not r > 0:
            raise refusal(f"points.{i} = {list(points[i])}: must be off the axis")
    sides = list(itertools.pairwise(points))
    for i, (a, b) in enumerate(sides):
        if a == b:
            raise refusal(f"points: {i} and {i + 1} are at the same place")
        for j, (c, d) in enumerate(sides[: max(i - 1, 0)]):
            if _side(a, b, c) * _side(a, b, d) <= 0 and _side(c, d, a) * _side(c, d, b) <= 0:
                raise refusal(f"points: the lines from {j} and from {i} meet")


def _side(
    start: tuple[float, float], end: tuple[float, float], point: tuple[float, float]
) -> float:
    """Return twice the area of the triangle of a line and a point, with a sign for the side."""
    (a, b), (c, d), (r, z) = start, end, point
    return (c - a) * (z - b) - (d - b) * (r - a)


def check_keys(shape: str, given: Mapping[str, Any]) -> None:
    """Refuse missing keys of a shape, and keys of a sphere that it does not accept.

    Parameters
    ----------
    shape : str
        Name in `SHAPES`.
    given : mapping
        Values of the keys of all shapes, `layers`, `refractive_index` and `moments_of_inertia`.
    """
    of = SHAPES[shape]
    for key in of.needs:
        if given.get(key) is None:
            them = "them" if key.endswith("s") else "it"
            raise refusal(f"{key}: missing; shape = {shape!r} requires {them}")
    if "layers" not in of.may and given.get("layers") is not None:
        raise refusal(f"layers: do not apply to shape = {shape!r}; remove them, or the shape")
    if of.index is False and given.get("refractive_index") is not None:
        own = "each of the spheres has" if shape == "spheres" else "the file has"
        raise refusal(
            f"refractive_index: does not apply to shape = {shape!r}, because {own} an index; "
            "remove it"
        )
    if "moments_of_inertia" not in of.may and given.get("moments_of_inertia") is not None:
        raise refusal(
            f"moments_of_inertia: follow from density and size for shape = {shape!r}; remove them"
        )
    needs_index = of.index and given.get("layers") is None
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


def densities(spheres: Sequence[ClusterSphere], density: float) -> list[float]:
    """Return the density of each sphere: its own, or `density` if it has none, kg/m^3."""
    return [density if each.density is None else each.density for each in spheres]


def centre_of_mass(spheres: Sequence[ClusterSphere], density: float) -> tuple[float, float, float]:
    """Return the centre of mass of the spheres of a cluster, m; see `densities`."""
    each_has = zip(densities(spheres, density), spheres, strict=True)
    masses = [rho / density * each.radius**3 for rho, each in each_has]
    whole = sum(masses)
    x, y, z = (
        sum(mass * each.position[i] for mass, each in zip(masses, spheres, strict=True)) / whole
        for i in range(3)
    )
    return x, y, z
