"""The sections of a scene: bead, medium, lens, beam, start, forces, camera, optics, simulation."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeAlias

from pydantic import (
    AfterValidator,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    StrictBool,
    StrictInt,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from tweezer.scene.choices import EVALUATORS, INERTIAS, METHODS, MODELS, THEORIES, methods, told
from tweezer.scene.courses import Modulation, Motion, Section, Vector, Velocity, refusal
from tweezer.scene.materials import materials
from tweezer.values.rounding import most
from tweezer.values.units import (
    BEAD_RADIUS,
    BEAM_SIGMA,
    Acceleration,
    AngularSpeed,
    BeadRadius,
    BeamSigma,
    ComplexIndex,
    Density,
    Energy,
    Frequency,
    LossDistance,
    MomentOfInertia,
    PositiveLength,
    PositiveTime,
    Power,
    Quantity,
    RadiiOrLength,
    RefractiveIndex,
    Temperature,
    Viscosity,
    WallPosition,
    Wavelength,
    complex_number,
    entries,
    to_si,
)

#: Largest number of samples of a run
MOST_SAMPLES = 10_000_000
#: keys that say the same thing in two ways: exactly one of each pair is given
ALTERNATIVES: dict[str, tuple[tuple[str, str], ...]] = {
    "bead": (("radius", "diameter"),),
    "bead.layers": (("radius", "diameter"),),
    "beam": (("power", "power_through_pupil"), ("sigma", "waist")),
}

#: keys that go with some choices of another key, and are refused with the others
BELONGING: dict[str, dict[str, tuple[str, tuple[str, ...]]]] = {
    "beam": {
        "sigma": ("profile", ("gaussian", "donut")),
        "profile_radius": ("profile", ("table",)),
        "profile_intensity": ("profile", ("table",)),
        "jones": ("polarisation", ("linear",)),
    },
    "start": {"ball_radius": ("drawn", ("ball",))},
}

#: Keys of a bead that it does not have beside `layers`
WITHIN_LAYERS = ("radius", "diameter", "refractive_index", "material")

#: key of a section that names what it is made of, and the keys that the name gives
NAMED: dict[str, tuple[str, tuple[str, ...]]] = {
    "bead": ("material", ("refractive_index", "density")),
    "medium": ("name", ("refractive_index", "density", "viscosity")),
}
#: key under which a scene says which keys of a section it has filled in
FILLED = "filled in"

if TYPE_CHECKING:
    ModelName: TypeAlias = str
    MethodName: TypeAlias = str
    InertiaName: TypeAlias = str
    TheoryName: TypeAlias = str
    EvaluatorName: TypeAlias = str
    MaterialName: TypeAlias = str
else:
    ModelName = Literal[tuple(MODELS)]
    MethodName = Literal[("auto", *METHODS)]
    InertiaName = Literal[tuple(INERTIAS)]
    TheoryName = Literal[("auto", *THEORIES)]
    EvaluatorName = Literal[("auto", *EVALUATORS)]
    MaterialName = Literal[tuple(materials())]

EulerParameter = Annotated[float, Quantity("", -1e100, 1e100)]
AngularVelocity = Annotated[tuple[AngularSpeed, AngularSpeed, AngularSpeed], entries(3)]
Orientation = Annotated[
    tuple[EulerParameter, EulerParameter, EulerParameter, EulerParameter], entries(4)
]
Moments = Annotated[tuple[MomentOfInertia, MomentOfInertia, MomentOfInertia], entries(3)]
ProfileRadii = Annotated[tuple[Annotated[float, Quantity("m", 0, 1)], ...], entries(4, 10_000)]
Intensities = Annotated[tuple[Annotated[float, Quantity("", 0, 1e100)], ...], entries(4, 10_000)]
Amplitude = Annotated[tuple[float, float], complex_number(1e100)]


def _normalised(jones: tuple[Amplitude, Amplitude]) -> tuple[Amplitude, Amplitude]:
    """`jones` at length 1; left as it is where it has that length, so that JSON keeps it."""
    length = math.hypot(*jones[0], *jones[1])
    if length < 1e-100:
        raise PydanticCustomError("jones", "must not both be 0")
    if abs(length - 1) < 1e-14:
        return jones
    (a, b), (c, d) = jones
    return (a / length, b / length), (c / length, d / length)


Jones = Annotated[tuple[Amplitude, Amplitude], entries(2), AfterValidator(_normalised)]


def _with_half(data: Any, key: str, other: str, low: float, high: float) -> Any:
    """`data` with `other` rewritten as `key` = `other`/2; exactly one must be there."""
    if not isinstance(data, dict):
        return data
    _exactly_one(data, key, other)
    if other not in data:
        return data
    data = dict(data)
    value = data.pop(other)
    try:
        half = to_si(value, "m", 2 * low, 2 * high) / 2
    except ValueError as error:
        raise refusal(f"{other} = {value!r}: {error}") from None
    return {**data, key: half}


def _exactly_one(data: Mapping[str, Any], key: str, other: str) -> None:
    given = [name for name in (key, other) if data.get(name) is not None]
    if len(given) != 1:
        both = "not both" if given else "one is needed"
        raise refusal(f"{key} or {other}: {both}")


class Filled(Section):
    """A section of which the scene may fill in some keys: they are not said again when it is."""

    _filled: frozenset[str] = PrivateAttr(frozenset())

    @property
    def filled(self) -> frozenset[str]:
        """Keys whose values the scene has filled in."""
        return self._filled

    @model_validator(mode="wrap")
    @classmethod
    def _some_filled_in(cls, data: Any, validated: ModelWrapValidatorHandler[Self]) -> Self:
        """Remember which they are."""
        if not isinstance(data, dict) or FILLED not in data:
            return validated(data)
        section = validated({key: value for key, value in data.items() if key != FILLED})
        section._filled = frozenset(data[FILLED])
        return section

    @model_serializer(mode="wrap")
    def _as_given(self, as_dict: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without what others give."""
        said: dict[str, Any] = as_dict(self)
        return {key: value for key, value in said.items() if key not in self._unsaid()}

    def _unsaid(self) -> frozenset[str]:
        return self._filled


class _Round(Filled):
    """A section with a `radius`, which `diameter` may stand for."""

    @property
    def diameter(self) -> float:
        """Twice the radius, m."""
        radius: float = vars(self)["radius"]
        return 2 * radius


class Layer(_Round):
    """A sphere, or the shell of one about the layer before. `diameter` may stand for `radius`."""

    radius: BeadRadius = Field(description="outer radius")
    material: MaterialName | None = Field(
        None, description="gives the refractive index at the beam's wavelength, as of the bead"
    )
    refractive_index: ComplexIndex = Field(
        description="refractive index, as of the bead; not needed with a `material`"
    )

    @model_validator(mode="before")
    @classmethod
    def _size(cls, data: Any) -> Any:
        return _with_half(data, "radius", "diameter", *BEAD_RADIUS)


Layers = Annotated[tuple[Layer, ...], entries(1, 20)]


class Bead(_Round):
    """The sphere. `diameter` may be given in place of `radius`, `material` in place of density and
    index, and `layers` in place of radius and index.
    """

    layers: Layers | None = Field(
        None,
        description="spheres about one centre, from the core outwards: a coated bead, a hollow one",
    )
    radius: BeadRadius = Field(
        None, validate_default=True, description="radius r; of layers the outermost"
    )
    material: MaterialName | None = Field(
        None,
        description="what it is made of: gives density and refractive index (at the beam's "
        "wavelength) where the scene has no numbers of its own",
    )
    density: Density = Field(
        description="density of the whole bead, rho_b (Table B.1); not needed with a `material`, "
        "nor with layers that all have one"
    )
    refractive_index: ComplexIndex | None = Field(
        None,
        description="refractive index n_P; of a bead that absorbs, or a metal, complex: "
        '"1.59+0.01j" or [1.59, 0.01]; not needed with a `material`',
    )
    moments_of_inertia: Moments | None = Field(
        None, description="principal moments I11, I22, I33 of a bead that is not uniform (A.13)"
    )

    @model_validator(mode="before")
    @classmethod
    def _size(cls, data: Any) -> Any:
        if not isinstance(data, dict) or data.get("layers") is None:
            return _with_half(data, "radius", "diameter", *BEAD_RADIUS)
        for key in WITHIN_LAYERS:
            if data.get(key) is not None:
                raise refusal(f"{key} = {data[key]}: not beside layers, which have their own")
        return data

    @field_validator("radius", mode="before")
    @classmethod
    def _outermost(cls, value: Any, info: ValidationInfo) -> Any:
        layers = info.data.get("layers", ())  # none in the data if they are not valid
        if layers is None:
            return value
        return layers[-1].radius if layers else BEAD_RADIUS[0]

    @model_validator(mode="after")
    def _some_index(self) -> Self:
        if self.layers is None and self.refractive_index is None:
            raise refusal("refractive_index: missing")
        return self

    @model_validator(mode="after")
    def _from_the_core_outwards(self) -> Self:
        for i, (inner, outer) in enumerate(itertools.pairwise(self.layers or ()), start=1):
            if not outer.radius > inner.radius:
                raise refusal(
                    f"layers.{i}.radius = {outer.radius:g}: must be larger than that of the layer "
                    f"before, {inner.radius:g}"
                )
        return self

    def _unsaid(self) -> frozenset[str]:
        return self.filled if self.layers is None else self.filled | {"radius"}

    @property
    def shells(self) -> tuple[tuple[float, complex], ...]:
        """Outer radius, m, and refractive index of each layer, from the core outwards."""
        if self.layers is None:
            assert self.refractive_index is not None
            return ((self.radius, _complex(self.refractive_index)),)
        return tuple((each.radius, _complex(each.refractive_index)) for each in self.layers)

    @property
    def index(self) -> complex:
        """Refractive index n_P; of layers that of the outermost."""
        return self.shells[-1][1]

    @property
    def absorbs(self) -> bool:
        """Whether light is absorbed anywhere in the bead."""
        return any(index.imag > 0 for _, index in self.shells)

    @model_validator(mode="after")
    def _possible_inertia(self) -> Self:
        if self.moments_of_inertia:
            largest = max(self.moments_of_inertia)
            if largest > sum(self.moments_of_inertia) - largest:
                raise refusal(
                    f"moments_of_inertia = {list(self.moments_of_inertia)}: no body has a moment "
                    "larger than the sum of the other two"
                )
        return self


def _complex(index: float | tuple[float, float]) -> complex:
    return complex(*index) if isinstance(index, tuple) else complex(index)


class Medium(Filled):
    """The fluid around the bead."""

    name: Literal["water"] | None = Field(
        None,
        description="water: refractive index (at the beam's wavelength), density and viscosity are "
        "those of water at the temperature, where the scene has no numbers of its own",
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
        description="what of the fluid's inertia the bead feels; none given: memory with the model "
        f"full, where the method takes it; {told(INERTIAS.values())}",
    )
    poles: Annotated[StrictInt, Field(ge=1, le=100)] | None = Field(
        None,
        description="number of poles of the memory; none given: what the duration and the "
        "tolerance need",
    )

    @model_validator(mode="after")
    def _poles_of_a_memory(self) -> Self:
        if self.poles is not None and self.inertia not in (None, "memory"):
            raise refusal(
                f"poles: does not apply to inertia = {self.inertia!r}; remove it, or set inertia "
                "to memory"
            )
        return self


class Cover(Section):
    """A plane face between another medium, such as cover glass, and the medium of the bead."""

    refractive_index: RefractiveIndex = Field(
        description="refractive index of the medium before the face, where the light comes from"
    )
    depth: Annotated[float, Quantity("m", 0, 1e-2)] = Field(
        description="distance from the face to the nominal focus, where the light would converge "
        "without the face"
    )


class Wall(Filled):
    """A plane across the light that ends the fluid, on one side of the bead; none if not given."""

    position: WallPosition = Field(
        description="z of the plane, along the light from the focus; with lens.cover it is the "
        "face of the cover and need not be given"
    )
    side: Literal["above", "below"] = Field(
        "above", description="where the bead is: above, at larger z than the plane, or below"
    )
    opposite: WallPosition | None = Field(
        None,
        description="z of a second plane, on the other side of the bead. Friction by two planes is "
        "that of each added up (Oseen)",
    )

    @property
    def normal(self) -> float:
        """Direction along z from the plane to the bead: 1 above, -1 below."""
        return 1.0 if self.side == "above" else -1.0

    @property
    def planes(self) -> tuple[tuple[float, float], ...]:
        """Position, m, and normal of each plane."""
        first = self.position, self.normal
        return (first,) if self.opposite is None else (first, (self.opposite, -self.normal))

    @model_validator(mode="after")
    def _opposite_beyond(self) -> Self:
        if self.opposite is not None and self.normal * (self.opposite - self.position) <= 0:
            raise refusal(
                f"opposite = {self.opposite:g}: must be on the side of the bead, {self.side} "
                f"position = {self.position:g}"
            )
        return self


class Lens(Section):
    """The objective. Rays leave its pupil and pass through the focus."""

    map: Literal["tan", "sine"] = Field(
        description="where a ray from pupil radius rho goes: tan(theta) = rho/f (thesis, 3.2), or "
        "sin(theta) = (rho/R) NA/n_m, the sine condition of an aplanatic objective; with a cover "
        "theta and n are those before its face"
    )
    radius: PositiveLength = Field(description="radius of the pupil, R_obj")
    focal_length: PositiveLength | None = Field(None, description="f; needed by the tan map")
    numerical_aperture: Annotated[float, Quantity("", 1e-3, 10)] | None = Field(
        None, description="NA; needed by the sine map"
    )
    cover: Cover | None = Field(
        None, description="a plane face before the focus, for light as waves; none if not given"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.map == "tan" and self.focal_length is None:
            raise refusal("focal_length: missing; the tan map needs it")
        if self.map == "sine" and self.numerical_aperture is None:
            raise refusal("numerical_aperture: missing; the sine map needs it")
        return self


class Beam(Section):
    """The laser in the pupil. `waist` (1/e^2 radius, 2 sigma) may be given in place of `sigma`."""

    wavelength: Wavelength = Field(description="vacuum wavelength")
    power: Power | None = Field(
        None, description="total power P_t before the pupil cuts the beam (3.4)"
    )
    power_through_pupil: Power | None = Field(
        None, description="power that passes the pupil, in place of `power`"
    )
    profile: Literal["gaussian", "uniform", "donut", "table"] = Field(
        "gaussian",
        description="intensity over the pupil radius rho. gaussian: exp(-rho^2/(2 sigma^2)) (3.3); "
        "uniform: the same all over the pupil, and no light beside it; donut: TEM*01, "
        "rho^2 exp(-rho^2/(2 sigma^2)), as waves with a vortex, or radially or azimuthally "
        "polarised; table: through the points of profile_radius and profile_intensity",
    )
    sigma: BeamSigma | None = Field(
        None,
        description="standard deviation of the Gaussian intensity in the pupil (3.3), half the "
        "waist; of the donut, the same of its Gaussian factor",
    )
    profile_radius: ProfileRadii | None = Field(
        None, description="rho of the points of a table, from 0 up; dark beyond the last"
    )
    profile_intensity: Intensities | None = Field(
        None, description="intensity at the points of a table, in any unit"
    )
    polarisation: Literal[
        "averaged-reflectance", "circular", "unpolarised", "linear", "radial", "azimuthal"
    ] = Field(
        "circular",
        description="circular: of helicity +1, (1, i) in the pupil; unpolarised; linear: as "
        "`jones` says; radial, azimuthal: along rho or around the axis, for light as waves; "
        "averaged-reflectance: the thesis's (3.17), R averaged, for rays. To rays circular and "
        "unpolarised light are alike: Q averaged over s and p",
    )
    vortex: Annotated[StrictInt, Field(ge=-50, le=50)] = Field(
        0,
        description="l of the phase l phi around the axis, for light as waves. A gaussian profile "
        "is then Laguerre-Gauss with p = 0, rho^(2|l|) exp(-rho^2/(2 sigma^2)); of other profiles "
        "the intensity stays as it is",
    )
    jones: Jones | None = Field(
        None,
        description="Jones vector of linear light in the pupil, amplitudes along x and y, at "
        'length 1: each a number, text such as "0.5+0.5j", or [real, imaginary]; along x if not '
        "given. Complex amplitudes make the light elliptical: (1, -1j) is circular of helicity -1",
    )
    torque: Literal["none", "thesis"] = Field(
        "none",
        description="none: light turns no lossless isotropic sphere, and as waves one that absorbs "
        "as it must; thesis: (3.25), each force applied where the ray enters",
    )
    divisions: Annotated[StrictInt, Field(ge=3, le=5000)] = Field(
        100, description="n_div, squares across the pupil (3.1)"
    )
    position: Vector = Field(
        (0.0, 0.0, 0.0), description="where the beam's focus is, from the origin of the scene"
    )
    direction: Literal["up", "down"] = Field(
        "up",
        description="up: the light goes along +z; down: it comes through a second lens from above, "
        "along -z, turned by 180 degrees about x",
    )
    motion: Motion | None = Field(None, description="how the focus moves; at rest if not given")
    modulation: Modulation | None = Field(
        None, description="how the power changes; not at all if not given"
    )

    @model_validator(mode="before")
    @classmethod
    def _one_way(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        if "waist" in data:
            data = _with_half(data, "sigma", "waist", *BEAM_SIGMA)
        if data.get("polarisation") == "linear" and data.get("jones") is None:
            data = {**data, "jones": (1, 0)}
        return data

    @model_validator(mode="after")
    def _keys_of_the_choices(self) -> Self:
        for key, (chooser, choices) in BELONGING["beam"].items():
            choice, given = getattr(self, chooser), getattr(self, key) is not None
            name = "sigma or waist" if key == "sigma" else key
            if given and choice not in choices:
                raise refusal(
                    f"{name}: does not apply to {chooser} = {choice!r}; remove it, or set "
                    f"{chooser} to {' or '.join(choices)}"
                )
            if not given and choice in choices:
                if key == "sigma":
                    raise refusal(f"{name}: one is needed")
                raise refusal(f"{key}: missing; {chooser} = {choice!r} needs it")
        return self

    @model_validator(mode="after")
    def _one_power(self) -> Self:
        given = {"power": self.power, "power_through_pupil": self.power_through_pupil}
        _exactly_one(given, *given)
        return self

    @model_validator(mode="after")
    def _whole_table(self) -> Self:
        if self.profile_radius is None or self.profile_intensity is None:
            return self
        if len(self.profile_radius) != len(self.profile_intensity):
            raise refusal(
                f"profile_intensity: has {len(self.profile_intensity)} entries; must have as many "
                f"as profile_radius, {len(self.profile_radius)}"
            )
        if self.profile_radius[0] != 0:
            raise refusal(f"profile_radius.0 = {self.profile_radius[0]}: must be 0")
        for i, (radius, larger) in enumerate(itertools.pairwise(self.profile_radius), start=1):
            if larger < max(radius * (1 + 1e-12), 1e-18):
                raise refusal(
                    f"profile_radius.{i} = {larger}: must be larger than the one before, {radius}"
                )
        if max(self.profile_intensity) < 1e-100:
            raise refusal("profile_intensity: must not all be 0")
        return self


class Start(Section):
    """Where and how the bead is released."""

    frame: Literal["focus", "lens"] = Field(
        "focus", description="origin of `position`: the focus, or the lens as in Table 5.1"
    )
    position: Vector = Field(description="centre of the bead, z along the light")
    drawn: Literal["no", "equilibrium", "ball", "boltzmann"] = Field(
        "no",
        description="no: where `position` says, as `velocity` says; with thermal motion also "
        "equilibrium: at the stable equilibrium nearest the focus; ball: uniformly within "
        "`ball_radius` of `position`; boltzmann: about the equilibrium, as in a harmonic trap of "
        "its stiffness, velocities thermal, `orientation` as it says",
    )
    ball_radius: PositiveLength | None = Field(None, description="radius of the ball")
    velocity: Velocity = Field((0.0, 0.0, 0.0), description="velocity")
    orientation: Orientation = Field(
        (1.0, 0.0, 0.0, 0.0), description="Euler parameters e0..e3 of any length but 0"
    )
    angular_velocity: AngularVelocity = Field(
        (0.0, 0.0, 0.0), description="angular velocity, body frame"
    )

    @model_validator(mode="after")
    def _some_ball(self) -> Self:
        if (self.drawn == "ball") != (self.ball_radius is not None):
            raise refusal("ball_radius: goes with drawn = 'ball', and with nothing else")
        return self

    @model_validator(mode="after")
    def _some_orientation(self) -> Self:
        if math.hypot(*self.orientation) < 1e-100:
            raise refusal(
                f"orientation = {list(self.orientation)}: the Euler parameters must not all be 0"
            )
        return self


class Dlvo(Section):
    """Force between bead and wall across an electrolyte: B exp(-gap/l_D) - A_H r/(6 gap)."""

    strength: Energy = Field(
        description="B of the repulsion of the double layers, of sphere and plane"
    )
    debye_length: PositiveLength = Field(description="Debye length l_D")
    hamaker_constant: Energy = Field(
        0.0, description="A_H of the attraction of van der Waals, without its retardation"
    )


class Forces(Section):
    """Which forces act, besides drag."""

    optical: StrictBool = Field(True, description="the light (3.26)")
    gravity: StrictBool = Field(True, description="gravity (2.11)")
    buoyancy: StrictBool = Field(True, description="buoyancy (2.12)")
    brownian: StrictBool = Field(False, description="thermal motion (2.16, 2.18-2.20)")
    brownian_torque: StrictBool = Field(
        False, description="thermal rotation as well (2.17): the orientation is followed"
    )
    gravitational_acceleration: Acceleration = Field(
        9.80665, description="g, against the light; negative for light that shines downwards"
    )
    dlvo: Dlvo | None = Field(
        None,
        description="force between the bead and the wall (Derjaguin, Landau, Verwey, Overbeek)",
    )


class Camera(Section):
    """A camera that sees the bead: positions averaged over an exposure, and noise."""

    rate: Frequency = Field(description="frames a second; frame j is exposed from j/rate on")
    exposure: Annotated[float, Quantity("s", 0, 1e6)] = Field(
        0.0, description="time over which a frame averages the position, at most 1/rate"
    )
    noise: Annotated[float, Quantity("m", 0, 1e-3)] = Field(
        0.0, description="standard deviation of the white noise of x, and of y, in a frame"
    )
    noise_along: Annotated[float, Quantity("m", 0, 1e-3)] | None = Field(
        None, description="the same of z, along the light; z is not seen if not given"
    )

    @model_validator(mode="after")
    def _within_a_frame(self) -> Self:
        longest = 1 / self.rate
        if self.exposure > longest * (1 + 1e-9):
            raise refusal(
                f"exposure = {self.exposure:g}: must be at most {most(longest, 6)} s, the time "
                "from frame to frame"
            )
        return self

    @property
    def axes(self) -> tuple[str, ...]:
        """What is seen: "x", "y" and perhaps "z"."""
        return ("x", "y") if self.noise_along is None else ("x", "y", "z")

    @property
    def noises(self) -> tuple[float, ...]:
        """Standard deviation of the noise along each axis that is seen, m."""
        across = self.noise, self.noise
        return across if self.noise_along is None else (*across, self.noise_along)


class Optics(Section):
    """How the force of the light is computed."""

    theory: TheoryName = Field(
        "auto",
        description="auto: waves, where the scene has a meaning as waves and the bead is at most "
        "about 30 um across, or else rays; " + told(THEORIES.values()),
    )
    evaluator: EvaluatorName = Field("auto", description=told(EVALUATORS.values()))
    tolerance: Annotated[float, Quantity("", 1e-13, 0.1)] = Field(
        1e-8, description="relative tolerance of the quadrature"
    )
    table_tolerance: Annotated[float, Quantity("", 1e-12, 0.1)] = Field(
        1e-7, description="tolerance of the map, as a part of the largest force"
    )
    table_range: RadiiOrLength = Field(
        3.0,
        description="how far the map reaches from the focus: a number of radii of the bead, or a "
        'length such as "5 um"',
    )


class Simulation(Section):
    """Model, method, tolerances and output."""

    model: ModelName | None = Field(
        None,
        description="none: the cheapest whose error is below the tolerance; "
        + told(MODELS.values()),
    )
    scaling_factor: Annotated[float, Quantity("", 1e-12, 1)] | None = Field(
        None, description="a2 of the scaled model (4.12)"
    )
    rotation_state: Literal["angular-velocity", "euler-rates"] = Field(
        "angular-velocity",
        description="what a rotating bead carries beside e: omega, or e' as the thesis (A.25)",
    )
    method: MethodName = Field(
        "auto",
        description=f"auto: by stiffness and tolerance; {told(methods(thermal=False))}. With "
        f"thermal motion: {told(methods(thermal=True))}",
    )
    step: PositiveTime | None = Field(
        None,
        description="fixed steps of a compiled method, instead of steps by the tolerances; with "
        "thermal motion the longest step, instead of one by the scene's time scales",
    )
    relative_tolerance: Annotated[float, Quantity("", 1e-13, 0.1)] = Field(
        1e-7, description="relative tolerance of a step"
    )
    position_tolerance: PositiveLength = Field(
        1e-11,
        description="absolute tolerance of a step in position; of exponential where the bead is "
        "fastest, and down to a hundredth where it is slower; in velocity, this per ms, where the "
        "method controls velocities: exponential does not",
    )
    orientation_tolerance: Annotated[float, Quantity("", 1e-16, 1)] = Field(
        1e-8, description="absolute tolerance in Euler parameters; in rotation rates, this per ms"
    )
    duration: PositiveTime = Field(description="time simulated")
    samples: Annotated[StrictInt, Field(ge=2, le=MOST_SAMPLES)] = Field(
        2001, description="evenly spaced times in the output, both ends included"
    )
    most_force_calls: Annotated[StrictInt, Field(ge=100, le=10**12)] = Field(
        10**8, description="places at which a run may evaluate the force before it gives up"
    )
    loss_distance: LossDistance = Field(
        20e-6, description="the run ends as lost this far from the focus"
    )

    @model_validator(mode="after")
    def _scaled_by(self) -> Self:
        if self.model == "scaled" and self.scaling_factor is None:
            raise refusal("scaling_factor: missing; the scaled model needs it")
        if self.step is not None and self.method != "auto" and not METHODS[self.method].fixed_steps:
            raise refusal("step: only the compiled methods take fixed steps")
        return self
