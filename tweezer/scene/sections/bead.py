"""Section of a scene: the bead."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from tweezer.scene.body import Body
from tweezer.scene.choices import SHAPES, at, told
from tweezer.scene.courses import NAME, Vector, refusal
from tweezer.scene.sections.alternatives import WITHIN_LAYERS, with_half
from tweezer.scene.sections.given import Given
from tweezer.scene.sections.shapes import (
    ClusterSpheres,
    Layers,
    MaterialName,
    ProfilePoints,
    Round,
    SemiAxes,
    ShapeName,
    centre_of_mass,
    check_apart,
    check_keys,
    check_profile,
    follows,
)
from tweezer.values.errors import SceneError
from tweezer.values.printed import printed
from tweezer.values.units import (
    BEAD_RADIUS,
    BeadRadius,
    ComplexIndex,
    Density,
    MomentOfInertia,
    PositiveLength,
    entries,
)

Moments = Annotated[tuple[MomentOfInertia, MomentOfInertia, MomentOfInertia], entries(3)]


class Bead(Round):
    """The bead. `diameter` may be given in place of `radius`, `material` in place of density and
    index, and `layers` in place of radius and index.
    """

    name: str | None = Field(
        None, pattern=NAME, description="name of one of several beads. Default: its number"
    )
    start: Vector | None = Field(
        None,
        description="of several beads, the centre of this one at the start. Default: the focus of "
        "the beam with the same number",
    )
    shape: ShapeName = Field("sphere", description=f"shape of the bead; {told(SHAPES.values())}")
    length: PositiveLength | None = Field(
        None, description="length of a spheroid, cylinder or capsule along its axis"
    )
    semi_axes: SemiAxes | None = Field(
        None, description="semi-axes of an ellipsoid along x, y and z of the body"
    )
    spheres: ClusterSpheres | None = Field(
        None,
        description="spheres of a rigid cluster, whose centre of mass is the bead position",
    )
    points: ProfilePoints | None = Field(
        None,
        description="radius and height of each corner of a profile, from the axis to the axis",
    )
    file: str | None = Field(
        None,
        description="file .tmat.h5 with the T-matrix of the body in the standard format, about "
        "its centre of mass; of a mesh the file .stl, .obj or .ply",
    )
    scale: PositiveLength | None = Field(
        None, description="length of one unit of the file of a mesh"
    )
    given: Given | None = Field(None, description="mass, inertia and drag of a body")
    t_matrix: str | None = Field(
        None,
        description="file .tmat.h5 with the T-matrix of an ellipsoid, cylinder, capsule, profile, "
        "mesh or given body about its centre of mass; not needed without light",
    )
    layers: Layers | None = Field(
        None,
        description="concentric layers from the core outwards, for coated or hollow beads",
    )
    density: Density = Field(
        None,
        validate_default=True,
        description="mean density of the bead, rho_b (Table B.1); in a cluster, of the spheres "
        "without their own; not needed with a `material`, or if every layer or sphere has one",
    )
    radius: BeadRadius = Field(
        None,
        validate_default=True,
        description="radius r; with layers that of the outermost; of a spheroid, cylinder or "
        "capsule across its axis; of a body in a file or given that of the enclosing sphere",
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
        if (shape := data.get("shape") or "sphere") not in list(SHAPES):
            # at once, because the other keys depend on it
            raise refusal(f"shape = {shape!r}: allowed: {', '.join(map(repr, SHAPES))}")
        if reason := follows(data):
            for key in ("radius", "diameter"):
                if data.get(key) is not None:
                    raise refusal(f"{key} = {data[key]}: cannot be combined with {reason}")
            return data
        for key in ("material", "density") if data.get("given") is not None else ():
            if data.get(key) is not None:
                raise refusal(f"{key} = {data[key]}: cannot be combined with given; remove it")
        if data.get("layers") is None:
            return with_half(data, "radius", "diameter", *BEAD_RADIUS)
        for key in WITHIN_LAYERS:
            if data.get(key) is not None:
                raise refusal(
                    f"{key} = {data[key]}: cannot be combined with layers, which have their own"
                )
        return data

    @field_validator("density", mode="before")
    @classmethod
    def _mean(cls, value: Any, info: ValidationInfo) -> Any:
        """Return the density, which follows from mass and volume if these are given."""
        if "given" not in info.data:  # which is not valid
            return 1000.0
        of = info.data["given"]
        if of is None and value is None:
            raise PydanticCustomError("missing", "Field required")
        return value if of is None else of.mass / of.volume

    @field_validator("radius", mode="before")
    @classmethod
    def _outermost(cls, value: Any, info: ValidationInfo) -> Any:
        """Return the radius of the outermost layer, or a first value if it follows."""
        shape = SHAPES.get(info.data.get("shape", ""))
        if shape is None or not shape.sized:
            return BEAD_RADIUS[0]
        layers = info.data.get("layers", ())  # missing from the data if they are not valid
        if layers is None:
            return value
        return layers[-1].radius if layers else BEAD_RADIUS[0]

    @model_validator(mode="after")
    def _some_shape(self) -> Self:
        """Refuse keys of another shape, missing keys and impossible bodies; enclose the body."""
        check_keys(self.shape, vars(self))
        if self.spheres is not None:
            check_apart(self.spheres)
        if self.points is not None:
            check_profile(self.points)
        try:
            size = self.body.size
        except SceneError as error:
            raise refusal(str(error)) from None
        if not SHAPES[self.shape].sized:
            low, high = BEAD_RADIUS
            if not low <= size <= high:
                raise refusal(
                    f"shape = {self.shape!r}: the body reaches {size:.4g} m from its centre of "
                    f"mass; must be from {low:g} to {high:g} m"
                )
            self.__dict__["radius"] = size
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
        follow = {"density"} if self.given is not None else set()
        if self.layers is not None or not SHAPES[self.shape].sized:
            follow.add("radius")
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
        found: Body = at(SHAPES[self.shape].solid)(self)
        return found

    @property
    def size_in_words(self) -> str:
        """Size of the bead with its shape, unless it is a sphere."""
        lengths = {"diameter": self.diameter, "length": self.length, "semi_axes": self.semi_axes}
        said = {key: printed(each, "um") for key, each in lengths.items() if each is not None}
        said |= {"spheres": str(len(self.spheres or ())), "file": Path(self.file or "").name}
        return SHAPES[self.shape].size.format(**said)

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
    def indexed(self) -> bool:
        """Whether the bead as a whole has a refractive index."""
        return self.layers is not None or self.refractive_index is not None

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
