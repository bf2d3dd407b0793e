"""Sections of a scene: the start, the forces, the camera, and the computation of the motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeAlias

from pydantic import BeforeValidator, Field, StrictBool, StrictInt, model_validator
from pydantic_core import PydanticCustomError

from tweezer.scene.choices import METHODS, MODELS, methods, told
from tweezer.scene.courses import Section, Vector, Velocity, refusal
from tweezer.scene.sections.between import Between
from tweezer.values.rounding import most
from tweezer.values.units import (
    Acceleration,
    AngularSpeed,
    Energy,
    Frequency,
    LossDistance,
    PositiveLength,
    PositiveTime,
    Quantity,
    entries,
)

#: Largest number of samples of a run
MOST_SAMPLES = 10_000_000
if TYPE_CHECKING:
    ModelName: TypeAlias = str
    MethodName: TypeAlias = str
else:
    ModelName = Literal[tuple(MODELS)]
    MethodName = Literal[("auto", *METHODS)]
EulerParameter = Annotated[float, Quantity("", -1e100, 1e100)]
AngularVelocity = Annotated[tuple[AngularSpeed, AngularSpeed, AngularSpeed], entries(3)]


def _euler_parameters(value: Any) -> Any:
    """Return Euler parameters, those of an axis (3 numbers) turning z to it by the shortest way."""
    if not isinstance(value, list | tuple) or len(value) != 3:
        return value
    if any(isinstance(each, bool) for each in value):
        return value
    try:
        x, y, z = (float(each) for each in value)
    except (TypeError, ValueError):
        return value
    length = math.hypot(x, y, z)
    if not 0 < length < math.inf:
        raise PydanticCustomError("axis", "an axis must have a finite length above 0")
    x, y, z = x / length, y / length, z / length
    if z == -1.0:
        return (0.0, 1.0, 0.0, 0.0)
    # the sum of z and the axis is halfway between them
    half = math.hypot(x, y, 1 + z)
    return (half / 2, 0.0 - y / half, x / half, 0.0)


Orientation = Annotated[
    tuple[EulerParameter, EulerParameter, EulerParameter, EulerParameter],
    entries(4), BeforeValidator(_euler_parameters),
]  # fmt: skip


class Start(Section):
    """Release of the bead: position, orientation and velocities, given or drawn at random."""

    frame: Literal["focus", "lens"] = Field(
        "focus",
        description="origin of `position`: the focus, or the lens as in Table 5.1 of the thesis",
    )
    position: Vector = Field(description="centre of the bead, with z along the light")
    drawn: Literal["no", "equilibrium", "ball", "boltzmann"] = Field(
        "no",
        description="no: released at `position` with `velocity`. With thermal motion also "
        "equilibrium: at the stable equilibrium nearest the focus; ball: uniformly within "
        "`ball_radius` of `position`; boltzmann: normally distributed about the equilibrium with "
        "the trap stiffness and thermal velocities. A sphere is released with the given "
        "`orientation`, and a body of another shape with the orientation of the equilibrium",
    )
    ball_radius: PositiveLength | None = Field(
        None, description="radius of the ball from which the release is drawn"
    )
    velocity: Velocity = Field((0.0, 0.0, 0.0), description="velocity at the release")
    orientation: Orientation = Field(
        (1.0, 0.0, 0.0, 0.0),
        description="Euler parameters e0 to e3, not all 0, scalar first, from the body to the "
        "laboratory; or the direction of the z axis of the body, 3 numbers",
    )
    angular_velocity: AngularVelocity = Field(
        (0.0, 0.0, 0.0), description="angular velocity at the release, in the body frame"
    )

    @model_validator(mode="after")
    def _some_ball(self) -> Self:
        """Refuse a ball radius unless the start is drawn from a ball, and the reverse."""
        if (self.drawn == "ball") != (self.ball_radius is not None):
            raise refusal("ball_radius: must be given if drawn = 'ball', and only then")
        return self

    @model_validator(mode="after")
    def _some_orientation(self) -> Self:
        """Refuse Euler parameters that are all 0."""
        if math.hypot(*self.orientation) < 1e-100:
            raise refusal(
                f"orientation = {list(self.orientation)}: the Euler parameters must not all be 0"
            )
        return self


class Dlvo(Section):
    """Force between bead and wall across an electrolyte: B exp(-gap/l_D) - A_H r/(6 gap)."""

    strength: Energy = Field(
        description="strength B of the double-layer repulsion between sphere and plane"
    )
    debye_length: PositiveLength = Field(description="Debye length l_D")
    hamaker_constant: Energy = Field(
        0.0, description="Hamaker constant A_H of the van der Waals attraction, without retardation"
    )


class Forces(Section):
    """Forces that act on the bead, in addition to drag."""

    optical: StrictBool = Field(True, description="optical force (3.26)")
    gravity: StrictBool = Field(True, description="gravity (2.11)")
    buoyancy: StrictBool = Field(True, description="buoyancy (2.12)")
    brownian: StrictBool = Field(False, description="thermal motion (2.16, 2.18-2.20)")
    brownian_torque: StrictBool = Field(
        False, description="thermal rotation (2.17), which adds the orientation to the state"
    )
    recoil: StrictBool = Field(
        False,
        description="recoil of photons, which heats the bead in thermal motion; noticeable in high "
        "vacuum",
    )
    gravitational_acceleration: Acceleration = Field(
        9.80665,
        description="gravitational acceleration g along -z; negative for light that travels "
        "downwards",
    )
    dlvo: Dlvo | None = Field(
        None,
        description="force between bead and wall (Derjaguin, Landau, Verwey, Overbeek). Default: "
        "none",
    )
    between: Between | None = Field(
        None, description="force between the surfaces of each two beads. Default: none"
    )


class Camera(Section):
    """A camera that records the bead: positions averaged over an exposure, and noise."""

    rate: Frequency = Field(description="frame rate; the exposure of frame j begins at j/rate")
    exposure: Annotated[float, Quantity("s", 0, 1e6)] = Field(
        0.0, description="exposure time, over which a frame averages the position; at most 1/rate"
    )
    noise: Annotated[float, Quantity("m", 0, 1e-3)] = Field(
        0.0, description="standard deviation of the white noise of x and y in a frame"
    )
    noise_along: Annotated[float, Quantity("m", 0, 1e-3)] | None = Field(
        None, description="standard deviation of the noise of z. Default: z is not recorded"
    )

    @model_validator(mode="after")
    def _within_a_frame(self) -> Self:
        """Refuse an exposure longer than the time between frames."""
        longest = 1 / self.rate
        if self.exposure > longest * (1 + 1e-9):
            raise refusal(
                f"exposure = {self.exposure:g}: must be at most {most(longest, 6)} s, the time "
                "between frames"
            )
        return self

    @property
    def axes(self) -> tuple[str, ...]:
        """Recorded axes: "x" and "y", with "z" if the height is recorded."""
        return ("x", "y") if self.noise_along is None else ("x", "y", "z")

    @property
    def noises(self) -> tuple[float, ...]:
        """Standard deviations of the noise along the recorded axes, m."""
        across = self.noise, self.noise
        return across if self.noise_along is None else (*across, self.noise_along)


class Simulation(Section):
    """Computation of the motion: model, method, tolerances, duration and output."""

    model: ModelName | None = Field(
        None,
        description=f"equations of motion; {told(MODELS.values())}. Default: the fastest model "
        "whose error is below the tolerance",
    )
    scaling_factor: Annotated[float, Quantity("", 1e-12, 1)] | None = Field(
        None, description="scaling factor a2 of the scaled model (4.12)"
    )
    rotation_state: Literal["angular-velocity", "euler-rates"] = Field(
        "angular-velocity",
        description="state of the rotation in addition to e: omega, or e' as in the thesis (A.25)",
    )
    method: MethodName = Field(
        "auto",
        description="integration method; auto: chosen by stiffness and tolerance; "
        f"{told(methods(thermal=False))}. With thermal motion: {told(methods(thermal=True))}",
    )
    step: PositiveTime | None = Field(
        None,
        description="fixed step of a compiled method, instead of adaptive steps; with thermal "
        "motion the largest step, instead of one from the time scales of the scene",
    )
    relative_tolerance: Annotated[float, Quantity("", 1e-13, 0.1)] = Field(
        1e-7, description="relative tolerance of a step"
    )
    position_tolerance: PositiveLength = Field(
        1e-11,
        description="absolute tolerance of a step in position; the method exponential uses it "
        "where the bead is fastest, and down to a hundredth of it elsewhere. Methods that control "
        "velocities, which exponential does not, use this value per ms for them",
    )
    orientation_tolerance: Annotated[float, Quantity("", 1e-16, 1)] = Field(
        1e-8,
        description="absolute tolerance in the Euler parameters; rotation rates use this value "
        "per ms",
    )
    duration: PositiveTime = Field(description="simulated time")
    samples: Annotated[StrictInt, Field(ge=2, le=MOST_SAMPLES)] = Field(
        2001, description="number of evenly spaced times in the output, including both ends"
    )
    most_force_calls: Annotated[StrictInt, Field(ge=100, le=10**12)] = Field(
        10**8, description="largest number of force evaluations, after which the run fails"
    )
    loss_distance: LossDistance = Field(
        20e-6, description="distance from the focus at which the run ends as lost"
    )

    @model_validator(mode="after")
    def _scaled_by(self) -> Self:
        """Refuse the scaled model without its factor a2, and fixed steps for methods that do not
        accept them.
        """
        if self.model == "scaled" and self.scaling_factor is None:
            raise refusal("scaling_factor: missing; the scaled model requires it")
        if self.step is not None and self.method != "auto" and not METHODS[self.method].fixed_steps:
            raise refusal("step: requires a compiled method; other methods have no fixed steps")
        return self
