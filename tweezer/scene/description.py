"""The keys of a scene, and the quantities that follow from them."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import AliasChoices, Field

from tweezer.scene.body import Body
from tweezer.scene.choices import Evaluator
from tweezer.scene.courses import NAME, Section
from tweezer.scene.keys import SEVERAL
from tweezer.scene.media import CONTINUUM, GASES
from tweezer.scene.sections import (
    Bead,
    Beam,
    Camera,
    Detector,
    Feedback,
    Forces,
    Heat,
    Lens,
    LockIn,
    Medium,
    Mirror,
    Optics,
    Simulation,
    Start,
    Tether,
    Wall,
)
from tweezer.scene.temperatures import Heating
from tweezer.scene.theory import Choice, chosen_theory
from tweezer.values.errors import SceneError
from tweezer.values.units import to_si

#: Largest number of beads in a scene
MOST_BEADS = 100
#: Distance of a wall from the bead's centre, in radii, from which the memory neglects it
FREE = 20.0


class Description(Section):
    """The keys of a scene, with derived quantities. `Scene` is a description that was checked."""

    name: str = Field(
        "scene",
        pattern=NAME,
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
    more_beads: Annotated[tuple[Bead, ...], Field(max_length=MOST_BEADS - 1)] = Field(
        (), description="of a file with several [[bead]]: all but the first"
    )
    more_beams: Annotated[tuple[Beam, ...], Field(max_length=100)] = Field(
        (), description="of a file with several [[beam]]: all but the first"
    )
    start: Start
    tether: Annotated[tuple[Tether, ...], Field(max_length=1000)] = Field(
        (), description="molecules and springs between beads; none if not given"
    )
    wall: Wall | None = Field(None, description="a plane that ends the fluid; none if not given")
    mirror: Mirror | None = Field(
        None, description="a plane that reflects light; none if not given"
    )
    heat: Heat | None = Field(None, description="heating by the light; none if not given")
    forces: Forces = Field(default_factory=Forces)
    camera: Camera | None = Field(
        None, description="a camera whose frames a run has beside the positions; none if not given"
    )
    detector: Detector | None = Field(
        None, description="a photodiode whose signals a run contains; none if not given"
    )
    lock_in: LockIn | None = Field(
        None,
        validation_alias=AliasChoices("lock_in", "lock-in"),
        description="an amplifier that records the motion about a frequency; none if not given",
    )
    feedback: Feedback | None = Field(
        None, description="a controller that acts by what it measures; none if not given"
    )
    optics: Optics = Field(default_factory=Optics)
    simulation: Simulation

    @property
    def heating(self) -> Heating:
        """Temperatures of medium and bead in the light, and their effect on the motion.

        Raises `SceneError` if the scene has heat but its light was not computed
        (`tweezer.optics.heat.heated`).
        """
        if self.heat is None:
            return Heating()
        if self.heat.found is None:
            raise SceneError(
                "heat: the temperatures follow from the light; tweezer.medium(scene) computes them"
            )
        return self.heat.found

    @property
    def noise_temperature(self) -> float:
        """Temperature of the bead's thermal motion, K: that of the medium unless light heats it."""
        return self.medium.temperature + self.heating.water + self.heating.noise

    @property
    def beads(self) -> tuple[Bead, ...]:
        """All beads."""
        return self.bead, *self.more_beads

    @property
    def bead_names(self) -> list[str]:
        """Names of all beads; their numbers, from 1, for those without a name."""
        return [bead.name or str(i) for i, bead in enumerate(self.beads, start=1)]

    def every(self, kind: str) -> tuple[Any, ...]:
        """Return all sections of a kind of which there may be several, such as "beam"."""
        return (getattr(self, kind), *getattr(self, SEVERAL[kind]))

    @property
    def beams(self) -> tuple[Beam, ...]:
        """All beams."""
        return self.beam, *self.more_beams

    @property
    def body(self) -> Body:
        """The bead as a rigid body."""
        return self.bead.body.starting(self.start.orientation)

    @property
    def plain(self) -> bool:
        """Whether there is only one beam, along +z through the origin, constant in time, whose
        pupil is the same after half a turn, and nothing reflects it.
        """
        beam = self.beam
        still = beam.motion is None and beam.modulation is None
        central = beam.direction == "up" and not any(beam.position) and beam.even
        mirrored = self.mirror is not None or (self.wall is not None and self.wall.reflects)
        return not self.more_beams and still and central and not mirrored

    @property
    def light_moves(self) -> bool:
        """Whether the focus of any beam moves."""
        return any(beam.motion is not None for beam in self.beams)

    @property
    def last_change(self) -> float:
        """Time after which no beam moves or changes any more, s; 0 if none ever does."""
        courses = [
            each
            for beam in self.beams
            for each in (beam.motion, beam.modulation, beam.phasing)
            if each
        ]
        return max((each.last_change for each in courses), default=0.0)

    def allows(self, by: Evaluator) -> bool:
        """Return whether the light has the symmetry that an evaluator requires."""
        linear = self.lit and any(beam.polarisation == "linear" for beam in self.beams)
        return not (self.theory in by.symmetric and linear)

    @property
    def start_position(self) -> tuple[float, float, float]:
        """Position at which the bead is released, relative to the focus, m."""
        x, y, z = self.start.position
        if self.start.frame == "lens":
            z -= self.lens.focal_length or 0.0
        return x, y, z

    @property
    def vorticity_time(self) -> float:
        """Time r^2 rho_m/mu_m, s, in which vorticity diffuses over a bead radius r.

        rho_m and mu_m are the density and viscosity of the medium.
        """
        return self.body.size**2 * self.medium.density / self.medium.viscosity

    @property
    def knudsen(self) -> float:
        """Mean free path of the molecules over the radius of the bead."""
        return self.medium.mean_free_path / self.body.size

    @property
    def rarefied(self) -> bool:
        """Whether the medium is a named gas that is no continuum for the inertia about the bead."""
        return self.medium.name in GASES and self.knudsen > CONTINUUM

    @property
    def lag(self) -> float:
        """Delay 2 sqrt(tau_f t/pi) at the end t of the run, s, due to hydrodynamic memory.

        tau_f is `vorticity_time`. Multiplied by the bead's speed, it is the distance by which the
        bead lags behind one in a fluid without inertia, if the force changes slowly.
        """
        return 2 * math.sqrt(self.vorticity_time * self.simulation.duration / math.pi)

    def gap(self, z: Any) -> Any:
        """Return the distance between wall and surface of the bead, m, for its centre at height z.

        `z` is measured from the focus, m. Raises `SceneError` for a scene without a wall.
        """
        if self.wall is None:
            raise SceneError("wall: the scene has no wall")
        return self.body.gap((self.wall.position, self.wall.normal), z)

    def room(self, z: Any) -> Any:
        """Return the distance between the bead's surface and the nearer of both walls, m."""
        gap = self.gap(z)
        if self.wall is None or self.wall.opposite is None:
            return gap
        middle = abs(self.wall.opposite - self.wall.position) / 2 - self.body.support(
            self.wall.normal
        )
        return middle - abs(gap - middle)

    @property
    def free_of_walls(self) -> float:
        """Distance from the focus within which the bead is 20 radii or more from walls, m."""
        return float(self.room(0.0)) - (FREE - 1) * self.body.size if self.wall else math.inf

    @property
    def draws(self) -> bool:
        """Whether the run draws random numbers, so that it accepts a seed."""
        seen = self.camera is not None and any(self.camera.noises)
        return self.forces.brownian or seen or (self.detector is not None and self.detector.noise)

    @property
    def rotates(self) -> bool:
        """Whether anything rotates the bead; otherwise rotation is not computed."""
        turned = self.turned_by_light or any(self.start.angular_velocity)
        return turned or self.forces.brownian_torque

    @property
    def turned_by_light(self) -> bool:
        """Whether the light exerts a torque: in ray optics that of the thesis, in wave optics by
        absorption, or on a body that is not a sphere.
        """
        if self.theory == "waves":
            return self.bead.absorbs or self.bead.shape != "sphere"
        return self.lit and any(beam.torque == "thesis" for beam in self.beams)

    @property
    def theory(self) -> str:
        """Theory of the light: "rays" or "waves"."""
        return self._theory.theory

    @property
    def theory_reason(self) -> str:
        """Reason for this theory, in one clause."""
        return self._theory.reason

    @property
    def _theory(self) -> Choice:
        """Choice of the theory with its reason; ray optics for a scene without light."""
        if not self.lit:
            return Choice("rays", "no light")
        return chosen_theory(
            self.optics,
            self.bead,
            self.medium,
            self.lens,
            self.beams,
            self.simulation.loss_distance,
        )

    @property
    def table_radii(self) -> float:
        """Range of the force map from the focus, in bead radii."""
        reach = self.optics.table_range
        return to_si(reach, "m") / self.body.size if isinstance(reach, str) else reach

    @property
    def table_reach(self) -> float:
        """Range of the force map from the focus, m."""
        reach = self.optics.table_range
        return to_si(reach, "m") if isinstance(reach, str) else reach * self.body.size

    @property
    def noisy_light(self) -> bool:
        """Whether any beam has noise."""
        return any(beam.noise is not None for beam in self.beams)

    @property
    def lit(self) -> bool:
        """Whether any beam has power and optical forces act."""
        lit = any(beam.power or beam.power_through_pupil for beam in self.beams)
        return self.forces.optical and lit
