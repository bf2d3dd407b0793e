"""Sections of a scene: the bead and its layers, the medium, the wall."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeAlias

from pydantic import Field, StrictInt, ValidationInfo, field_validator, model_validator

from tweezer.scene.body import Body
from tweezer.scene.choices import INERTIAS, SHAPES, told
from tweezer.scene.courses import refusal
from tweezer.scene.sections.alternatives import WITHIN_LAYERS, Filled, with_half
from tweezer.scene.sections.shapes import (
    ClusterSpheres,
    MaterialName,
    Round,
    ShapeName,
    centre_of_mass,
    check_apart,
    check_keys,
    densities,
    enclosing_radius,
)
from tweezer.scene.sphere import Sphere
from tweezer.values.printed import printed
from tweezer.values.units import (
    BEAD_RADIUS,
    BeadRadius,
    ComplexIndex,
    Density,
    MomentOfInertia,
    PositiveLength,
    RefractiveIndex,
    Temperature,
    Viscosity,
    WallPosition,
    entries,
)

if TYPE_CHECKING:
    InertiaName: TypeAlias = str
else:
    InertiaName = Literal[tuple(INERTIAS)]
Moments = Annotated[tuple[MomentOfInertia, MomentOfInertia, MomentOfInertia], entries(3)]


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


class Bead(Round):
    """The bead. `diameter` may be given in place of `radius`, `material` in place of density and
    index, and `layers` in place of radius and index.
    """

    shape: ShapeName = Field("sphere", description=f"shape of the bead; {told(SHAPES.values())}")
    length: PositiveLength | None = Field(None, description="length of a spheroid along its axis")
    spheres: ClusterSpheres | None = Field(
        None,
        description="spheres of a rigid cluster, whose centre of mass is the bead position",
    )
    file: str | None = Field(
        None, description="file .tmat.h5 with the T-matrix of the body in the standard format"
    )
    layers: Layers | None = Field(
        None,
        description="concentric layers from the core outwards, for coated or hollow beads",
    )
    density: Density = Field(
        description="mean density of the bead, rho_b (Table B.1); in a cluster, of the spheres "
        "without their own; not needed with a `material`, or if every layer or sphere has one"
    )
    radius: BeadRadius = Field(
        None,
        validate_default=True,
        description="radius r; with layers that of the outermost; of a spheroid across its axis; "
        "of a body in a file that of the sphere that encloses it",
    )
    material: MaterialName | None = Field(
        None,
        description="material of the bead; sets the density and the refractive index at the "
        "wavelength of the beam, unless the scene gives them",
    )
    refractive_index: ComplexIndex | None = Field(
        None,
        description="refractive index n_P; complex for metals and absorbing beads, e.g. "
        '"1.59+0.01j" or [1.59, 0.01]; not needed with a `material`',
    )
    moments_of_inertia: Moments | None = Field(
        None, description="principal moments of inertia I11, I22, I33 of a non-uniform bead (A.13)"
    )

    @model_validator(mode="before")
    @classmethod
    def _size(cls, data: Any) -> Any:
        """Replace a diameter in the data by the radius; refuse size and index beside layers."""
        if not isinstance(data, dict):
            return data
        if data.get("shape") == "spheres" and data.get("spheres") is None:
            raise refusal("spheres: missing; shape = 'spheres' requires them")
        if data.get("spheres") is not None:
            for key in ("radius", "diameter"):
                if data.get(key) is not None:
                    raise refusal(f"{key} = {data[key]}: cannot be combined with spheres")
            return data
        if data.get("layers") is None:
            return with_half(data, "radius", "diameter", *BEAD_RADIUS)
        for key in WITHIN_LAYERS:
            if data.get(key) is not None:
                raise refusal(
                    f"{key} = {data[key]}: cannot be combined with layers, which have their own"
                )
        return data

    @field_validator("radius", mode="before")
    @classmethod
    def _outermost(cls, value: Any, info: ValidationInfo) -> Any:
        """Return the radius of the outermost layer, or the one that encloses a cluster."""
        spheres = info.data.get("spheres", ())  # missing from the data if they are not valid
        if spheres is not None:
            density = info.data.get("density")
            return enclosing_radius(spheres, density) if spheres and density else BEAD_RADIUS[0]
        layers = info.data.get("layers", ())
        if layers is None:
            return value
        return layers[-1].radius if layers else BEAD_RADIUS[0]

    @model_validator(mode="after")
    def _some_shape(self) -> Self:
        """Refuse keys of another shape, missing keys and spheres that overlap."""
        check_keys(self.shape, vars(self))
        if self.spheres is not None:
            check_apart(self.spheres)
        return self

    @model_validator(mode="after")
    def _from_the_core_outwards(self) -> Self:
        """Refuse layers whose radii do not increase."""
        for i, (inner, outer) in enumerate(itertools.pairwise(self.layers or ()), start=1):
            if not outer.radius > inner.radius:
                raise refusal(
                    f"layers.{i}.radius = {outer.radius:g}: must be larger than the previous "
                    f"one, {inner.radius:g}"
                )
        return self

    def _unsaid(self) -> frozenset[str]:
        """Return the keys omitted when the bead is written: those that follow from others."""
        follow = set() if self.layers is None and self.spheres is None else {"radius"}
        return self.filled | follow | ({"shape"} if self.shape == "sphere" else set())

    @property
    def shells(self) -> tuple[tuple[float, complex], ...]:
        """Outer radius, m, and refractive index of each layer, from the core outwards.

        A cluster has the index of its first sphere, and a T-matrix NaN.
        """
        if self.spheres is not None:
            return ((self.radius, _complex(self.spheres[0].refractive_index)),)
        if self.layers is None:
            index = math.nan if self.refractive_index is None else self.refractive_index
            return ((self.radius, _complex(index)),)
        return tuple((each.radius, _complex(each.refractive_index)) for each in self.layers)

    @property
    def body(self) -> Body:
        """The bead as a rigid body: size, mass, moments of inertia, gap to a plane.

        A body in a T-matrix file has the size and mass of the sphere that encloses it.
        """
        if self.length is None and self.spheres is None:
            return Sphere(self.radius, self.density, self.moments_of_inertia)
        from tweezer.scene.solids import Cluster, Spheroid  # imports NumPy

        if self.length is not None:
            return Spheroid(self.radius, self.length / 2, self.density)
        spheres = self.spheres or ()
        radii = [each.radius for each in spheres]
        return Cluster(self.centres, radii, densities(spheres, self.density))

    @property
    def size_in_words(self) -> str:
        """Size of the bead with its shape, unless it is a sphere."""
        diameter = printed(self.diameter, "um")
        if self.length is not None:
            return f"spheroid, {diameter} across, {printed(self.length, 'um')} along its axis"
        if self.spheres is not None:
            return f"{len(self.spheres)} spheres within {diameter}"
        return (
            diameter if self.file is None else f"body in {Path(self.file).name}, within {diameter}"
        )

    @property
    def centres(self) -> list[tuple[float, float, float]]:
        """Centres of the spheres of a cluster from their centre of mass, m."""
        spheres = self.spheres or ()
        a, b, c = centre_of_mass(spheres, self.density)
        return [(x - a, y - b, z - c) for x, y, z in (each.position for each in spheres)]

    @property
    def index(self) -> complex:
        """Refractive index n_P; for layers that of the outermost."""
        return self.shells[-1][1]

    @property
    def absorbs(self) -> bool:
        """Whether light is absorbed anywhere in the bead, as far as the scene knows."""
        indices = [index for _, index in self.shells]
        indices += [_complex(each.refractive_index) for each in self.spheres or ()]
        return any(index.imag > 0 for index in indices)

    @model_validator(mode="after")
    def _possible_inertia(self) -> Self:
        """Refuse moments of inertia that no body can have."""
        if self.moments_of_inertia:
            largest = max(self.moments_of_inertia)
            if largest > sum(self.moments_of_inertia) - largest:
                raise refusal(
                    f"moments_of_inertia = {list(self.moments_of_inertia)}: no body has a moment "
                    "larger than the sum of the other two"
                )
        return self


def _complex(index: float | tuple[float, float]) -> complex:
    """Return a refractive index, a number or a pair of real and imaginary part, as complex."""
    return complex(*index) if isinstance(index, tuple) else complex(index)


class Medium(Filled):
    """The fluid around the bead."""

    name: Literal["water"] | None = Field(
        None,
        description="name of the fluid; water sets refractive index (at the wavelength of the "
        "beam), density and viscosity at the temperature, unless the scene gives them",
    )
    refractive_index: RefractiveIndex = Field(
        description="refractive index n_m; not needed with a `name`"
    )
    density: Density = Field(description="density rho_m; not needed with a `name`")
    viscosity: Viscosity = Field(description="dynamic viscosity mu_m; not needed with a `name`")
    temperature: Temperature = Field(description="absolute temperature T")
    mean_free_path: PositiveLength = Field(
        3e-10, description="mean free path of the molecules, lambda_mfp (2.2.2)"
    )
    inertia: InertiaName | None = Field(
        None,
        description=f"fluid inertia that acts on the bead; {told(INERTIAS.values())}. Default: "
        "memory for the model full if the method supports it, otherwise none",
    )
    poles: Annotated[StrictInt, Field(ge=1, le=100)] | None = Field(
        None,
        description="number of poles of the hydrodynamic memory. Default: determined by the "
        "duration and the tolerance",
    )

    @model_validator(mode="after")
    def _poles_of_a_memory(self) -> Self:
        """Refuse a number of poles for a fluid without hydrodynamic memory."""
        if self.poles is not None and self.inertia not in (None, "memory"):
            raise refusal(
                f"poles: does not apply to inertia = {self.inertia!r}; remove it, or set inertia "
                "to memory"
            )
        return self


class Wall(Filled):
    """A plane across the light that ends the fluid, on one side of the bead; none if not given."""

    position: WallPosition = Field(
        description="height z of the plane relative to the focus; not needed with lens.cover, "
        "whose face is then the wall"
    )
    side: Literal["above", "below"] = Field(
        "above", description="side of the plane on which the bead is; above means larger z"
    )
    opposite: WallPosition | None = Field(
        None,
        description="height z of a second plane on the other side of the bead. The added drag of "
        "the planes is summed (Oseen)",
    )

    @property
    def normal(self) -> float:
        """Direction along z from the plane to the bead: 1 above, -1 below."""
        return 1.0 if self.side == "above" else -1.0

    @property
    def planes(self) -> tuple[tuple[float, float], ...]:
        """Position z, m, and normal (1 or -1 along z, to the bead) of each plane."""
        first = self.position, self.normal
        return (first,) if self.opposite is None else (first, (self.opposite, -self.normal))

    @model_validator(mode="after")
    def _opposite_beyond(self) -> Self:
        """Refuse a second plane that is not on the bead's side of the first one."""
        if self.opposite is not None and self.normal * (self.opposite - self.position) <= 0:
            raise refusal(
                f"opposite = {self.opposite:g}: must be on the side of the bead, {self.side} "
                f"position = {self.position:g}"
            )
        return self
