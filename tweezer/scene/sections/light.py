"""Sections of a scene: the lens and its cover, beams, and the computation of optical forces."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeAlias

from pydantic import AfterValidator, Field, StrictInt, model_validator
from pydantic_core import PydanticCustomError

from tweezer.scene.choices import EVALUATORS, THEORIES, told
from tweezer.scene.courses import Modulation, Motion, Section, Vector, refusal
from tweezer.scene.sections.alternatives import BELONGING, exactly_one, with_half
from tweezer.scene.sections.interference import OfCoherent
from tweezer.scene.sections.pupil import OfPupil
from tweezer.values.units import (
    BEAM_SIGMA,
    Angle,
    BeamSigma,
    Frequency,
    PositiveLength,
    Power,
    Quantity,
    RadiiOrLength,
    RefractiveIndex,
    Wavelength,
    complex_number,
    entries,
)

if TYPE_CHECKING:
    TheoryName: TypeAlias = str
    EvaluatorName: TypeAlias = str
else:
    TheoryName = Literal[("auto", *THEORIES)]
    EvaluatorName = Literal[("auto", *EVALUATORS)]
ProfileRadii = Annotated[tuple[Annotated[float, Quantity("m", 0, 1)], ...], entries(4, 10_000)]
Intensities = Annotated[tuple[Annotated[float, Quantity("", 0, 1e100)], ...], entries(4, 10_000)]
Amplitude = Annotated[tuple[float, float], complex_number(1e100)]


def _normalised(jones: tuple[Amplitude, Amplitude]) -> tuple[Amplitude, Amplitude]:
    """Return a Jones vector scaled to length 1.

    A vector of this length within rounding is returned unchanged, so that saving and loading do not
    change it.
    """
    length = math.hypot(*jones[0], *jones[1])
    if length < 1e-100:
        raise PydanticCustomError("jones", "must not both be 0")
    if abs(length - 1) < 1e-14:
        return jones
    (a, b), (c, d) = jones
    return (a / length, b / length), (c / length, d / length)


Jones = Annotated[tuple[Amplitude, Amplitude], entries(2), AfterValidator(_normalised)]


class Cover(Section):
    """A plane face between another medium, such as cover glass, and the medium of the bead."""

    refractive_index: RefractiveIndex = Field(
        description="refractive index of the medium in front of the face, from which the light "
        "comes"
    )
    depth: Annotated[float, Quantity("m", 0, 1e-2)] = Field(
        description="distance from the face to the nominal focus, to which the light would "
        "converge without the face"
    )


class Lens(Section):
    """The objective. Rays leave its pupil and pass through the focus."""

    map: Literal["tan", "sine"] = Field(
        description="angle theta of a ray from pupil radius rho. tan: tan(theta) = rho/f (thesis, "
        "3.2); sine: sin(theta) = (rho/R) NA/n_m, the sine condition of an aplanatic objective. "
        "With a cover, theta and the index refer to the medium in front of its face"
    )
    radius: PositiveLength = Field(description="radius of the pupil, R_obj")
    focal_length: PositiveLength | None = Field(
        None, description="focal length f; required by the tan map"
    )
    numerical_aperture: Annotated[float, Quantity("", 1e-3, 10)] | None = Field(
        None, description="numerical aperture NA; required by the sine map"
    )
    cover: Cover | None = Field(
        None, description="plane face in front of the focus; requires wave optics. Default: none"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        """Refuse a lens without the key that its map from pupil to angle requires."""
        if self.map == "tan" and self.focal_length is None:
            raise refusal("focal_length: missing; the tan map requires it")
        if self.map == "sine" and self.numerical_aperture is None:
            raise refusal("numerical_aperture: missing; the sine map requires it")
        return self


class LaserNoise(Section):
    """Noise of a laser in thermal motion, for a bead that oscillates at low damping.

    The power spectral densities are one-sided, and white up to a corner frequency.
    """

    power: Annotated[float, Quantity("1/Hz", 0, 1)] = Field(
        0.0, description="spectral density of the relative change of the power"
    )
    position: Annotated[float, Quantity("m^2/Hz", 0, 1e-6)] = Field(
        0.0, description="spectral density of the position of the focus along each axis"
    )
    corner: Frequency | None = Field(
        None, description="corner frequency of both spectra. Default: none, white"
    )


class Beam(OfPupil, OfCoherent):
    """The laser in the pupil. `waist` (1/e^2 radius, 2 sigma) may be given in place of `sigma`."""

    wavelength: Wavelength = Field(description="vacuum wavelength")
    power: Power | None = Field(
        None, description="total power P_t before the pupil cuts the beam (3.4)"
    )
    power_through_pupil: Power | None = Field(
        None, description="power through the pupil; replaces `power`"
    )
    profile: Literal["gaussian", "uniform", "donut", "table"] = Field(
        "gaussian",
        description="intensity over the pupil radius rho. gaussian: exp(-rho^2/(2 sigma^2)) (3.3); "
        "uniform: constant within the pupil, with no light outside; donut: TEM*01, rho^2 "
        "exp(-rho^2/(2 sigma^2)), which in wave optics requires a vortex, or radial or azimuthal "
        "polarisation; table: interpolated between the points of profile_radius and "
        "profile_intensity",
    )
    sigma: BeamSigma | None = Field(
        None,
        description="standard deviation of the Gaussian intensity in the pupil (3.3), half the "
        "waist; for the donut that of its Gaussian factor",
    )
    profile_radius: ProfileRadii | None = Field(
        None, description="radii rho of a table, ascending from 0; no light beyond the last"
    )
    profile_intensity: Intensities | None = Field(
        None, description="intensities at these radii, in any unit"
    )
    polarisation: Literal[
        "averaged-reflectance",
        "circular",
        "unpolarised",
        "linear",
        "radial",
        "azimuthal",
        "cylindrical",
    ] = Field(
        "circular",
        description="circular: helicity +1, (1, i) in the pupil; unpolarised; linear: given by "
        "`jones`; radial, azimuthal: along rho or around the axis, requires wave optics; "
        "cylindrical: along (cos, sin)(l phi + phi_0), with `order` and `order_phase`, requires "
        "wave optics; "
        "averaged-reflectance: equation (3.17) of the thesis, with R averaged, requires ray "
        "optics. In ray optics, circular and unpolarised are the same: Q is averaged over s and p",
    )
    vortex: Annotated[StrictInt, Field(ge=-50, le=50)] = Field(
        0,
        description="charge l of an optical vortex, phase l phi around the axis; requires wave "
        "optics. A gaussian profile becomes Laguerre-Gauss with p = 0, "
        "rho^(2|l|) exp(-rho^2/(2 sigma^2)); other profiles keep their intensity",
    )
    jones: Jones | None = Field(
        None,
        description="Jones vector of linear light in the pupil: amplitudes along x and y, each a "
        'number, text such as "0.5+0.5j", or [real, imaginary], scaled to length 1. Complex '
        "amplitudes give elliptical light; (1, -1j) is circular with helicity -1. Default: along x",
    )
    order: Annotated[StrictInt, Field(ge=-20, le=20)] | None = Field(
        None, description="order l of cylindrical polarisation; 1 is radial for a phase of 0, and "
        "0 is linear"
    )  # fmt: skip
    order_phase: Angle = Field(0.0, description="angle phi_0 of cylindrical polarisation")
    torque: Literal["none", "thesis"] = Field(
        "none",
        description="none: no torque on a lossless sphere, and in wave optics the absorption "
        "torque on an absorbing one; thesis: equation (3.25), with each force applied where the "
        "ray enters the bead",
    )
    divisions: Annotated[StrictInt, Field(ge=3, le=5000)] = Field(
        100, description="number of squares across the pupil, n_div (3.1)"
    )
    position: Vector = Field(
        (0.0, 0.0, 0.0), description="position of the focus relative to the origin of the scene"
    )
    direction: Literal["up", "down"] = Field(
        "up",
        description="up: the light travels along +z; down: it travels along -z from a second lens "
        "above, rotated by 180 degrees about x",
    )
    motion: Motion | None = Field(None, description="motion of the focus. Default: none")
    modulation: Modulation | None = Field(
        None, description="modulation of the power. Default: none"
    )
    noise: LaserNoise | None = Field(
        None, description="noise of the power and of the position, in thermal motion. Default: none"
    )

    @model_validator(mode="before")
    @classmethod
    def _one_way(cls, data: Any) -> Any:
        """Replace a waist in the data by sigma, and use a Jones vector along x for linear light
        without one.
        """
        if not isinstance(data, dict):
            return data
        for key, other in (("sigma", "sigma_y"), ("waist", "waist_y")):
            if isinstance(data.get(key), list | tuple) and len(data[key]) == 2:
                data = {**data, key: data[key][0], other: data[key][1]}
        if "waist_y" in data:
            data = with_half(data, "sigma_y", "waist_y", *BEAM_SIGMA)
        if "waist" in data:
            data = with_half(data, "sigma", "waist", *BEAM_SIGMA)
        if data.get("polarisation") == "linear" and data.get("jones") is None:
            data = {**data, "jones": (1, 0)}
        return data

    @model_validator(mode="after")
    def _keys_of_the_choices(self) -> Self:
        """Refuse keys that do not belong to the chosen profile or polarisation, and missing keys of
        these choices.
        """
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
                    raise refusal(f"{name}: one is required")
                raise refusal(f"{key}: missing; {chooser} = {choice!r} requires it")
        return self

    @model_validator(mode="after")
    def _round_or_gaussian(self) -> Self:
        """Refuse an elliptical, off-centre or Hermite-Gaussian beam that is not Gaussian or has a
        vortex.
        """
        keys = [
            key for key in ("sigma_y", "offset", "hermite", "angle")
            if getattr(self, key) not in (None, 0.0, (0.0, 0.0))
        ]  # fmt: skip
        if keys and self.profile != "gaussian":
            raise refusal(f"{keys[0]}: requires profile = 'gaussian'; remove it")
        if keys and self.vortex:
            raise refusal(f"{keys[0]}: cannot be combined with a vortex; remove one of them")
        if self.order_phase and self.polarisation != "cylindrical":
            raise refusal("order_phase: requires polarisation = 'cylindrical'; remove it")
        if keys == ["angle"]:
            raise refusal("angle: requires sigma_y or hermite; remove it")
        return self

    @model_validator(mode="after")
    def _mask_of_even_phase(self) -> Self:
        """Refuse a mask or sectors in light whose phase or polarisation turns around the axis."""
        if self.pattern is None and self.foci == "field":
            return self
        what = "sectors" if self.sectors else "a mask"
        if self.vortex:
            remedy = "remove one of them" if self.sectors else "add the phase to the mask"
            raise refusal(f"vortex = {self.vortex}: cannot be combined with {what}; {remedy}")
        if self.polarisation in ("radial", "azimuthal", "cylindrical"):
            raise refusal(
                f"polarisation = {self.polarisation!r}: cannot be combined with {what}; allowed: "
                "circular, linear, unpolarised"
            )
        return self

    @model_validator(mode="after")
    def _one_power(self) -> Self:
        """Refuse a beam without a power, or with both."""
        given = {"power": self.power, "power_through_pupil": self.power_through_pupil}
        exactly_one(given, *given)
        return self

    @model_validator(mode="after")
    def _whole_table(self) -> Self:
        """Refuse an intensity profile whose radii do not ascend from 0, or differ in number from
        the intensities.
        """
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
                    f"profile_radius.{i} = {larger}: must be larger than the previous one, {radius}"
                )
        if max(self.profile_intensity) < 1e-100:
            raise refusal("profile_intensity: must not all be 0")
        return self


class Optics(Section):
    """Computation of the optical force: theory, evaluator and tolerances."""

    theory: TheoryName = Field(
        "auto",
        description="auto: waves, if wave optics supports the scene and the bead diameter is at "
        "most about 30 um, otherwise rays; " + told(THEORIES.values()),
    )
    evaluator: EvaluatorName = Field("auto", description=told(EVALUATORS.values()))
    tolerance: Annotated[float, Quantity("", 1e-13, 0.1)] = Field(
        1e-8, description="relative tolerance of the quadrature"
    )
    table_tolerance: Annotated[float, Quantity("", 1e-12, 0.1)] = Field(
        1e-7, description="tolerance of the force map relative to the largest force"
    )
    table_range: RadiiOrLength = Field(
        3.0,
        description="range of the force map from the focus: a number of bead radii, or a length "
        'such as "5 um"',
    )
