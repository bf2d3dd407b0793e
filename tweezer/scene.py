"""The description of one experiment: bead, medium, lens, beam, start, forces, optics, simulation.

Scenes are TOML files. Quantities may carry units ("500 nm"); bare numbers are SI. A scene is
immutable, and every way to make one validates it.
"""

from __future__ import annotations

import difflib
import itertools
import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeAlias, get_args

from pydantic import (
    AfterValidator,
    Field,
    StrictBool,
    StrictInt,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails, PydanticCustomError

from tweezer.choices import EVALUATORS, METHODS, MODELS, methods, told
from tweezer.courses import (
    Modulation,
    Motion,
    Section,
    Vector,
    Velocity,
    refusal,
    with_tables,
)
from tweezer.errors import SceneError, UnitWarning, warn
from tweezer.units import (
    BEAD_RADIUS,
    BEAM_SIGMA,
    Acceleration,
    AngularSpeed,
    BeadRadius,
    BeamSigma,
    Density,
    LossDistance,
    MomentOfInertia,
    PositiveLength,
    PositiveTime,
    Power,
    Quantity,
    Temperature,
    Viscosity,
    complex_number,
    entries,
    quantity_of,
    to_si,
)

SHIPPED = Path(__file__).parent / "scenes"

#: Knudsen number up to which the medium is taken as a continuum (thesis, 2.2.2)
KNUDSEN_LIMIT = 1e-3

#: keys that say the same thing in two ways: exactly one of each pair is given
ALTERNATIVES: dict[str, tuple[tuple[str, str], ...]] = {
    "bead": (("radius", "diameter"),),
    "beam": (("power", "power_through_pupil"), ("sigma", "waist")),
}

#: the key that a scene has in place of one that says the same
_HALVES = {(section, other): key for section, pairs in ALTERNATIVES.items() for key, other in pairs}

#: One of several beams, counted from 1
_NUMBERED = re.compile(r"beam\[([1-9][0-9]*)\]")

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

#: why the light of a scene has no map
NO_MAP = (
    "optics.evaluator = 'map': needs light that is the same all around the axis; allowed with "
    "beam.polarisation: 'averaged-reflectance' or 'circular'"
)

#: what `tomllib` raises: besides its own, for numbers too long and lists too deep
_NOT_TOML = (ValueError, RecursionError)

if TYPE_CHECKING:
    ModelName: TypeAlias = str
    MethodName: TypeAlias = str
    EvaluatorName: TypeAlias = str
else:
    ModelName = Literal[tuple(MODELS)]
    MethodName = Literal[("auto", *METHODS)]
    EvaluatorName = Literal[("auto", *EVALUATORS)]

RefractiveIndex = Annotated[float, Quantity("", 1, 10)]
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


class Bead(Section):
    """The sphere. `diameter` may be given in place of `radius`."""

    radius: BeadRadius = Field(description="radius r")
    density: Density = Field(description="density of the bead, rho_b (Table B.1)")
    refractive_index: RefractiveIndex = Field(description="refractive index n_P")
    moments_of_inertia: Moments | None = Field(
        None, description="principal moments I11, I22, I33 of a bead that is not uniform (A.13)"
    )

    @model_validator(mode="before")
    @classmethod
    def _size(cls, data: Any) -> Any:
        return _with_half(data, "radius", "diameter", *BEAD_RADIUS)

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


class Medium(Section):
    """The fluid around the bead."""

    refractive_index: RefractiveIndex = Field(description="refractive index n_m")
    density: Density = Field(description="density rho_m")
    viscosity: Viscosity = Field(description="dynamic viscosity mu_m")
    temperature: Temperature = Field(description="absolute temperature T")
    mean_free_path: PositiveLength = Field(
        3e-10, description="mean free path of the molecules, lambda_mfp (2.2.2)"
    )


class Lens(Section):
    """The objective. Rays leave its pupil and pass through the focus."""

    map: Literal["tan", "sine"] = Field(
        description="where a ray from pupil radius rho goes: tan(theta) = rho/f (thesis, 3.2), or "
        "sin(theta) = (rho/R) NA/n_m, the sine condition of an aplanatic objective"
    )
    radius: PositiveLength = Field(description="radius of the pupil, R_obj")
    focal_length: PositiveLength | None = Field(None, description="f; needed by the tan map")
    numerical_aperture: Annotated[float, Quantity("", 1e-3, 10)] | None = Field(
        None, description="NA; needed by the sine map"
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

    wavelength: PositiveLength = Field(description="vacuum wavelength")
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
        "rho^2 exp(-rho^2/(2 sigma^2)); table: through the points of profile_radius and "
        "profile_intensity",
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
    polarisation: Literal["averaged-reflectance", "circular", "linear"] = Field(
        "circular",
        description="circular (or unpolarised): Q averaged over s and p; averaged-reflectance: "
        "the thesis's (3.17), R averaged; linear: Q of s and p as `jones` divides the light",
    )
    jones: Jones | None = Field(
        None,
        description="Jones vector of linear light in the pupil, amplitudes along x and y, at "
        'length 1: each a number, text such as "0.5+0.5j", or [real, imaginary]; along x if not '
        "given. Complex amplitudes make the light elliptical",
    )
    torque: Literal["none", "thesis"] = Field(
        "none",
        description="none: light turns no lossless isotropic sphere; thesis: (3.25), each force "
        "applied where the ray enters",
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
                    f"{name}: not for {chooser} = {choice!r}, only for {' and '.join(choices)}"
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


class Optics(Section):
    """How the force of the light is computed."""

    evaluator: EvaluatorName = Field("auto", description=told(EVALUATORS.values()))
    tolerance: Annotated[float, Quantity("", 1e-13, 0.1)] = Field(
        1e-8, description="relative tolerance of the quadrature"
    )
    table_tolerance: Annotated[float, Quantity("", 1e-12, 0.1)] = Field(
        1e-7, description="tolerance of the map, as a part of the largest force"
    )
    table_range: Annotated[float, Quantity("", 0.5, 20)] = Field(
        3.0, description="how far the map reaches from the focus, in radii of the bead"
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
        description="absolute tolerance of a step in position; in velocity, this per ms, where the "
        "method controls velocities: exponential does not",
    )
    orientation_tolerance: Annotated[float, Quantity("", 1e-16, 1)] = Field(
        1e-8, description="absolute tolerance in Euler parameters; in rotation rates, this per ms"
    )
    duration: PositiveTime = Field(description="time simulated")
    samples: Annotated[StrictInt, Field(ge=2, le=10_000_000)] = Field(
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


class Scene(Section):
    """A validated scene. Make one with `load_scene`, change it with `replace`."""

    name: str = Field(
        "scene",
        pattern=r"^\w[^/\\\x00-\x1f\x7f]{0,99}$",
        description="name of the scene, and of its result files",
    )
    description: str = Field("", description="one line on what it shows")
    changed: dict[str, str] = Field(
        default_factory=dict,
        description="written by `replace`, not by hand: what was changed since the description was "
        "written, by key",
    )
    bead: Bead
    medium: Medium
    lens: Lens
    beam: Beam
    more_beams: Annotated[tuple[Beam, ...], Field(max_length=100)] = Field(
        (), description="of a file with several [[beam]]: all but the first"
    )
    start: Start
    forces: Forces = Field(default_factory=Forces)
    optics: Optics = Field(default_factory=Optics)
    simulation: Simulation

    def __repr__(self) -> str:
        """In short: the bead, the power, and what differs from the shipped scene of this name."""
        power = sum(beam.power_through_pupil or beam.power or 0.0 for beam in self.beams)
        told = f"{2e6 * self.bead.radius:.4g} um bead, {1e3 * power:.4g} mW"
        if self.name in (shipped := shipped_scenes()):
            here = by_key(self.model_dump())
            there = by_key(load_scene(shipped[self.name]).model_dump())
            changed = [key for key in sorted(here | there) if here.get(key) != there.get(key)]
            if ("beam.power" in here) != ("beam.power" in there):
                told += f"; {_counted(self.beams)}"
                changed = [key for key in changed if not key.startswith("beam")]
            told = "; ".join([told, *(f"{key} = {_short(here.get(key))}" for key in changed)])
        return f"<Scene {self.name!r}: {told}>"

    __str__ = __repr__

    @model_validator(mode="before")
    @classmethod
    def _several_beams(cls, data: Any) -> Any:
        if isinstance(data, dict) and isinstance(beams := data.get("beam"), list | tuple):
            if not beams:
                raise refusal("beam: at least one is needed")
            if "more_beams" in data:
                raise refusal("more_beams: not beside beam = [...], which gives all of them")
            data = {**data, "beam": beams[0], "more_beams": list(beams[1:])}
        return data

    @property
    def beams(self) -> tuple[Beam, ...]:
        """All beams."""
        return self.beam, *self.more_beams

    @property
    def plain(self) -> bool:
        """Whether there is one beam only, along z through the origin, always the same."""
        beam = self.beam
        still = beam.motion is None and beam.modulation is None
        return not self.more_beams and still and beam.direction == "up" and not any(beam.position)

    def with_one_beam(self, beam: Beam) -> Scene:
        """The scene with that beam alone, along z through the origin, always the same."""
        at_rest = {
            "position": (0.0, 0.0, 0.0),
            "direction": "up",
            "motion": None,
            "modulation": None,
        }
        return self.model_copy(update={"beam": beam.model_copy(update=at_rest), "more_beams": ()})

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        aperture = self.lens.numerical_aperture
        if self.lens.map == "sine" and aperture and aperture >= self.medium.refractive_index:
            raise refusal(
                f"lens.numerical_aperture = {aperture}: must be less than "
                f"medium.refractive_index = {self.medium.refractive_index} for the sine map"
            )
        for beam in self.beams:
            if self.lit and self.optics.evaluator == "grid":
                self._wider_than_a_square(beam)
            by = EVALUATORS.get(self.optics.evaluator)
            if by and by.symmetric and beam.polarisation == "linear":
                raise refusal(NO_MAP)
        self._thermal()
        if self.start.frame == "lens" and self.lens.focal_length is None:
            raise refusal("start.frame = 'lens': needs lens.focal_length")
        x, y, z = self.start_position
        ball = self.start.ball_radius or 0.0
        lens = -math.inf
        if self.lens.focal_length is not None:
            lens = self.bead.radius - self.lens.focal_length
        if z - ball <= lens:
            raise refusal(
                f"start.position = {list(self.start.position)}: the bead must start beyond the "
                "lens, by more than its radius"
            )
        distance = math.hypot(x, y, z) + ball
        if distance >= self.simulation.loss_distance:
            to = "and its ball reach to" if ball else "is"
            raise refusal(
                f"start.position = {list(self.start.position)}: {to} {distance:.3g} m "
                "from the focus; must be nearer than simulation.loss_distance = "
                f"{self.simulation.loss_distance:.3g} m"
            )
        return self

    def _thermal(self) -> None:
        """Refuse what does not go with thermal motion, or not without."""
        method, model = self.simulation.method, self.simulation.model
        how = None if method == "auto" else METHODS[method]
        if not self.forces.brownian:
            if how and how.thermal:
                raise refusal(f"simulation.method = {method!r}: is for forces.brownian = true")
            if self.start.drawn != "no":
                raise refusal(f"start.drawn = {self.start.drawn!r}: is for forces.brownian = true")
            if self.forces.brownian_torque:
                raise refusal("forces.brownian_torque = True: needs forces.brownian = true")
            return
        if how and not how.thermal:
            raise refusal(
                f"simulation.method = {method!r}: draws no thermal motion; allowed with "
                f"forces.brownian: auto, {', '.join(each.name for each in methods(thermal=True))}"
            )
        if how and model and model not in how.models:
            raise refusal(
                f"simulation.method = {method!r}: not with model = {model!r}; allowed: "
                f"{', '.join(how.models)}"
            )
        if model == "first-order" and self.rotates:
            raise refusal(
                "simulation.model = 'first-order': with thermal motion without rotation only"
            )
        torque = self.lit and any(each.torque != "none" for each in self.beams)
        if how and how.spring_only and torque:
            raise refusal(
                f"simulation.method = {method!r}: a spring exerts no torque; allowed: "
                "beam.torque = 'none'"
            )
        if self.rotates and self.bead.moments_of_inertia and model != "overdamped":
            raise refusal(
                "bead.moments_of_inertia: with thermal motion a rotation with inertia is that of a "
                "sphere; allowed: model = 'overdamped', or no moments"
            )

    def _wider_than_a_square(self, beam: Beam) -> None:
        """Refuse a beam that the grid of rays would not see."""
        half_side = self.lens.radius / beam.divisions
        if beam.sigma is not None and beam.sigma < half_side:
            raise refusal(
                f"beam.sigma = {beam.sigma:.3g}: must be at least {half_side:.3g} m, half the "
                f"side of a square of the grid, for {beam.divisions} beam.divisions"
            )
        if beam.profile_radius is not None and beam.profile_radius[-1] < 2 * half_side:
            raise refusal(
                f"beam.profile_radius ends at {beam.profile_radius[-1]:.3g}: must reach "
                f"{2 * half_side:.3g} m, the side of a square of the grid, for {beam.divisions} "
                "beam.divisions"
            )

    def __eq__(self, other: object) -> bool:
        """Whether both describe the same, however they came about."""
        return isinstance(other, Scene) and self._said() == other._said()

    def __hash__(self) -> int:
        return hash(self._said())

    def _said(self) -> tuple[Any, ...]:
        return tuple(getattr(self, key) for key in type(self).model_fields if key != "changed")

    @property
    def title(self) -> str:
        """The description; of a scene changed since it was written, the name and the changes."""
        if not self.changed:
            return self.description or self.name
        changes = ", ".join(f"{key} = {value}" for key, value in self.changed.items())
        if (stale := self._of_another_temperature) and "medium.temperature" in self.changed:
            changes += f" ({stale} as before)"
        return f"{self.name}, changed: {changes}"

    @property
    def _of_another_temperature(self) -> str:
        """What of the medium a change of the temperature would change, and nobody did."""
        if "medium.viscosity" in self.changed:
            return ""
        keys = ("viscosity", "density", "refractive_index")
        *most, last = [key for key in keys if f"medium.{key}" not in self.changed]
        return f"{', '.join(most)} and {last}" if most else last

    @property
    def start_position(self) -> tuple[float, float, float]:
        """Where the bead starts, m from the focus."""
        x, y, z = self.start.position
        if self.start.frame == "lens":
            z -= self.lens.focal_length or 0.0
        return x, y, z

    @property
    def rotates(self) -> bool:
        """Whether anything turns the bead: if not, no rotation is computed."""
        turned_by_light = self.lit and any(beam.torque == "thesis" for beam in self.beams)
        turned = turned_by_light or any(self.start.angular_velocity)
        return turned or self.forces.brownian_torque

    @property
    def lit(self) -> bool:
        """Whether there is any light."""
        lit = any(beam.power or beam.power_through_pupil for beam in self.beams)
        return self.forces.optical and lit

    def replace(self, **sections: Any) -> Scene:
        """A changed copy, validated again.

        `scene.replace(beam={"power": "80 mW"})` changes the named keys of a section and keeps
        the others; a key displaces the one that says the same in another way (diameter, radius),
        and a choice the keys that do not go with it (profile = uniform displaces sigma).
        Of several beams, `beam=[...]` replaces all, and `**{"beam[2]": {...}}` changes the second.
        The title of the copy names what was changed, unless a new description is among it.

        Raises `SceneError`. Warns (`PhysicsWarning`) of a temperature changed without the
        viscosity.
        """
        replaced = self._replaced(sections)
        changed = self._changes(replaced, sections)
        copy = replaced.model_copy(update={"changed": changed})
        if copy.medium.temperature != self.medium.temperature and copy._of_another_temperature:
            warn(
                f"medium.temperature = {changed['medium.temperature']}: "
                f"{copy._of_another_temperature} are still those of "
                f"{self.medium.temperature:g} K; water's viscosity falls by 2 % a kelvin"
            )
        return copy.model_copy(update={"changed": {}}) if "description" in sections else copy

    def _changes(self, replaced: Scene, sections: Mapping[str, Any]) -> dict[str, str]:
        """What `changed` becomes with `sections`: earlier changes that still hold, and new ones."""
        before, after = by_key(self.model_dump()), by_key(replaced.model_dump())

        def differs(key: str) -> bool:
            section, _, name = key.partition(".")
            other = _HALVES.get((_kind(section), name), name)
            field = key if key in after else f"{section}.{other}"
            return bool(before.get(field) != after.get(field))

        changed = {key: text for key, text in self.changed.items() if not differs(key)}
        for section, given in sections.items():
            if isinstance(getattr(replaced, _kind(section)), Section) and not isinstance(
                given, list | tuple
            ):
                for key, value in dict(given).items():
                    if differs(f"{section}.{key}"):
                        changed[f"{section}.{key}"] = _as_text(value)
        if isinstance(sections.get("beam"), list | tuple) and replaced.beams != self.beams:
            changed["beam"] = f"{len(replaced.beams)} of them"
        return dict(sorted(changed.items()))

    def decided(self, **simulation: Any) -> Scene:
        """A copy with the model and method that were left open: no change of what is described."""
        copy = self._replaced({"simulation": simulation})
        return copy.model_copy(update={"changed": self.changed})

    def _replaced(self, sections: Mapping[str, Any]) -> Scene:
        if "more_beams" in sections:
            raise SceneError(
                "more_beams: beam = [...] replaces all beams, and beam[2] changes the second"
            )
        data = self.model_dump(exclude_none=True)
        beams = [data["beam"], *data.pop("more_beams")]
        if len(beams) > 1:
            data["beam"] = beams
        try:
            read = with_tables(sections, Path())
        except ValueError as error:
            raise SceneError(str(error)) from None
        for section, changes in read.items():
            if section == "beam" and len(beams) > 1 and not isinstance(changes, list | tuple):
                key = ".".join(["beam", *changes][:2]) if isinstance(changes, Mapping) else "beam"
                raise SceneError(f"{key}: of which beam? The scene has {_named(beams)}")
            if numbered := _NUMBERED.fullmatch(section):
                at = int(numbered[1]) - 1
                if len(beams) == 1 or not 0 <= at < len(beams):
                    raise SceneError(f"{section}: the scene has {_named(beams)}")
                if "beam" in sections:
                    raise SceneError(f"{section}: not beside beam, which gives all of them")
                beams[at] = _changed_section(beams[at], "beam", changes)
                data["beam"] = beams
            else:
                data[section] = _changed_section(data.get(section), section, changes)
        return _validated(data, sections)


def _kind(section: str) -> str:
    """What a section is: beam[2] is a beam."""
    return "beam" if _NUMBERED.fullmatch(section) else section


def _counted(beams: Sequence[Any]) -> str:
    return "one beam" if len(beams) == 1 else f"{len(beams)} beams"


def _named(beams: Sequence[Any]) -> str:
    """How many there are, and their names."""
    names = "beam" if len(beams) == 1 else f"beam[1] to beam[{len(beams)}]"
    return f"{_counted(beams)}, {names}"


def _changed_section(before: Any, section: str, changes: Any) -> Any:
    """A section of a scene as a mapping, with changes; of another form, the changes."""
    if not isinstance(changes, Mapping) or not isinstance(before, dict):
        return changes
    kept = {key: value for key, value in before.items() if not _displaced(key, section, changes)}
    return kept | {key: _within(kept.get(key), value) for key, value in changes.items()}


def _within(before: Any, change: Any) -> Any:
    """A section within a section, changed; one of another kind takes its place."""
    if isinstance(change, Mapping) and isinstance(before, dict) and "kind" not in change:
        return {**before, **change}
    return change


def by_key(scene: Mapping[str, Any]) -> dict[str, Any]:
    """The values of a scene as a mapping, by `section.key`; of several beams by `beam[1].key`."""
    sections = dict(scene.items())
    if more := sections.pop("more_beams", ()):
        beams = sections.pop("beam"), *more
        sections |= {f"beam[{i}]": beam for i, beam in enumerate(beams, start=1)}
    return {
        f"{section}.{key}": value
        for section, values in sections.items()
        if isinstance(values, dict) and section != "changed"
        for key, value in values.items()
    }


def checked_scene(scene: Scene) -> Scene:
    """`scene`, or `SceneError` if it is none, but a name, say."""
    if not isinstance(scene, Scene):
        raise SceneError(
            f"scene = {_short(scene)}: must be a Scene, which tweezer.load_scene gives for a name, "
            "a file or a mapping"
        )
    return scene


def _displaced(key: str, section: str, changes: Mapping[str, Any]) -> bool:
    """Whether `changes` to a section leave no room for a `key` that was there."""
    for pair in ALTERNATIVES.get(section, ()):
        if key in pair and set(pair) & set(changes):
            return True
    chooser, choices = BELONGING.get(section, {}).get(key, ("", ()))
    return chooser in changes and changes[chooser] not in choices


def shipped_scenes() -> dict[str, Path]:
    """Shipped scene files by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def load_scene(source: str | Path | Mapping[str, Any]) -> Scene:
    """The scene of a shipped name, a TOML file, or a mapping of the same form.

    Raises `SceneError` with one line per bad value: the key, the value, and what is allowed.
    Warns (`PhysicsWarning`) where the continuum drag (2.13) does not hold, and (`UnitWarning`) of
    numbers without a unit that are unusual in the SI unit.
    """
    if isinstance(source, Mapping):
        try:
            data = with_tables(source, Path())
        except ValueError as error:
            raise SceneError(str(error)) from None
        return _validated(data, source)
    name = str(source)
    if not name:
        raise SceneError("no scene is named: must be a shipped scene or a TOML file")
    path = shipped_scenes().get(name, Path(name))
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise SceneError(
            f"no scene file {name!r}, and no shipped scene of that name; {_shipped_like(path)}"
        ) from None
    except UnicodeDecodeError:
        raise SceneError(f"{name!r}: not a text file in UTF-8") from None
    except _NOT_TOML as error:
        raise SceneError(f"{name!r}: not valid TOML: {error}") from None
    except OSError as error:
        raise SceneError(f"{name!r}: cannot be read: {error.strerror}") from None
    try:
        whole = with_tables(data, path.parent)
    except ValueError as error:
        raise SceneError(f"{name!r}: {error}") from None
    return _validated({"name": path.stem, **whole}, data)


def _shipped_like(path: Path) -> str:
    shipped = list(shipped_scenes())
    near = difflib.get_close_matches(path.name.removesuffix(".toml"), shipped, n=1, cutoff=0.5)
    near += [name for name in shipped if path.stem and path.stem in name]
    return f"did you mean {near[0]}?" if near else f"shipped: {', '.join(shipped)}"


def with_settings(scene: Scene, settings: Mapping[str, str]) -> Scene:
    """`scene` with dotted keys set to text values, as given on a command line.

    A key is `section.key`, `beam[2].key` of several beams, or `beam.motion.key`.
    A value is read as TOML where it is TOML ("1e-4", "[0, 0, 1e-6]") and as text otherwise
    ("80 mW"); "True" and "False" are as Python has them. Raises `SceneError`.
    """
    sections: dict[str, Any] = {}
    for key, text in settings.items():
        section, dot, name = key.partition(".")
        if not dot:
            raise SceneError(f"{key!r}: must be section.key, such as beam.power")
        within = sections.setdefault(section, {})
        outer, dot, inner = name.partition(".")
        of = getattr(
            getattr(Scene.model_fields.get(_kind(section)), "annotation", None), "model_fields", {}
        )
        if dot and outer in of and _section_of(of[outer].annotation):  # beam.motion.velocity
            within, name = within.setdefault(outer, {}), inner
            if not isinstance(within, dict):
                raise SceneError(f"{section}.{outer}: given as a whole, and key by key")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except _NOT_TOML:
            value = {"True": True, "False": False}.get(text, text)
        within[name] = value
    return scene.replace(**sections)


def _validated(data: dict[str, Any], given: Mapping[str, Any]) -> Scene:
    """The scene of `data`; warns of bare numbers in the part of it that a user has `given`."""
    try:
        scene = Scene.model_validate(data)
    except ValidationError as error:
        several = isinstance(data.get("beam"), list | tuple) or bool(data.get("more_beams"))
        lines = (" ".join(line.splitlines()) for line in _lines(error, several))
        raise SceneError("\n".join(lines)) from None
    knudsen = scene.medium.mean_free_path / (2 * scene.bead.radius)
    if knudsen > KNUDSEN_LIMIT:
        warn(
            f"Knudsen number {knudsen:.2g} is above {KNUDSEN_LIMIT:g}: the medium is not a "
            "continuum for this bead, and Stokes' drag (2.13) is too strong"
        )
    for doubt in _doubts(given):
        warn(doubt, UnitWarning)
    return scene


def _doubts(given: Mapping[str, Any], section: Any = None, within: str = "") -> Iterator[str]:
    """A line for each key whose number has no unit and is unusual in the SI unit.

    given: keys of a section, or sections of the scene. within: the name of that section, with a
    dot.
    """
    fields = (section or Scene).model_fields
    for key, value in given.items():
        kind = _HALVES.get((_kind(within.removesuffix(".")), key), _kind(key))
        if kind not in fields:  # the file of a table
            continue
        annotation, metadata = fields[kind].annotation, fields[kind].metadata
        if inner := _section_of(annotation):
            for name, part in _each(key, value):
                if isinstance(part, Mapping):
                    yield from _doubts(part, inner, f"{within}{name}.")
        elif quantity := quantity_of(*metadata, annotation):
            doubts = ((number, quantity.doubt(number)) for number in _numbers(value))
            unusual = (f"{within}{key} = {number} {doubt}" for number, doubt in doubts if doubt)
            yield from itertools.islice(unusual, 1)


def _each(section: str, value: Any) -> list[tuple[str, Any]]:
    """The section, or those of a list, by name."""
    if isinstance(value, list | tuple):
        name, first = ("beam", 2) if section == "more_beams" else (section, 1)
        return [(f"{name}[{i}]", each) for i, each in enumerate(value, start=first)]
    return [(section, value)]


def _numbers(value: Any) -> Iterator[Any]:
    """What a value holds: itself, or what is in the list."""
    if isinstance(value, list | tuple):
        for each in value:
            yield from _numbers(each)
    else:
        yield value


def _lines(error: ValidationError, several: bool) -> Iterator[str]:
    """One line per bad value, in the order of the scene. several: whether it has several beams."""
    for details in error.errors(include_url=False):
        where = details["loc"]
        if several and where[:1] == ("beam",):
            where = ("beam[1]", *where[1:])
        elif where[:1] == ("more_beams",) and len(where) > 1:  # as the file has them: [[beam]]
            where = (f"beam[{int(where[1]) + 2}]", *where[2:])
        key = ".".join(str(part) for part in where)
        if details["type"] == "scene":
            yield f"{key}.{details['msg']}" if key else details["msg"]
        elif details["type"] == "missing":
            yield f"{key}: missing"
        elif details["type"] == "extra_forbidden":
            yield f"{key} = {_short(details['input'])}: unknown key; {_known_keys(details)}"
        else:
            yield f"{key} = {_short(details['input'])}: {_allowed(details, key)}"


def _as_text(value: Any) -> str:
    """A value as a scene file has it, in short."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return _clipped(f"{{{', '.join(f'{key} = {_as_text(of)}' for key, of in value.items())}}}")
    if isinstance(value, list | tuple):
        return _clipped(f"[{', '.join(map(_as_text, value))}]")
    return f"{value:g}" if isinstance(value, float) else str(value)


def _short(value: Any) -> str:
    try:
        return _clipped(repr(value))
    except RecursionError:
        return f"a {type(value).__name__} too deep to show"


def _clipped(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."


def _known_keys(details: ErrorDetails) -> str:
    section: Any = Scene
    for part in details["loc"][:-1]:
        if not isinstance(part, int):  # the number of a beam
            section = _section_of(section.model_fields[str(part)].annotation)
    keys = [key for key in section.model_fields if key != "changed"]
    names = [str(part) for part in details["loc"][:-1] if not isinstance(part, int)]
    for pair in ALTERNATIVES.get(".".join(names).replace("more_beams", "beam"), ()):
        keys += [key for key in pair if key not in keys]
    if "times" in keys:
        keys.append("file")
    near = difflib.get_close_matches(str(details["loc"][-1]), keys, n=1)
    return f"did you mean {near[0]}?" if near else f"allowed: {', '.join(keys)}"


def _section_of(annotation: Any) -> Any:
    """The section within annotations such as `Motion | None` or `tuple[Beam, ...]`."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return annotation
    return next(filter(None, map(_section_of, get_args(annotation))), None)


def _allowed(details: ErrorDetails, key: str) -> str:
    kind, context = details["type"], details.get("ctx", {})
    match kind:
        case "literal_error":
            return f"allowed: {context['expected']}"
        case "greater_than_equal":
            return f"must be at least {context['ge']:g}"
        case "less_than_equal":
            return f"must be at most {context['le']:g}"
        case "bool_type":
            return "must be true or false"
        case "int_type" | "int_from_float":
            return "must be a whole number"
        case "tuple_type":
            return "must be a list"
        case "model_type" | "dict_type":
            name = "[beam]" if _NUMBERED.fullmatch(key) else details["loc"][-1]
            return f"must be a section [{name}]"
        case "string_type":
            return "must be text"
        case "string_pattern_mismatch":
            return "must begin with a letter or digit, and have no /, \\ and at most 100 characters"
        case _:
            return details["msg"]
