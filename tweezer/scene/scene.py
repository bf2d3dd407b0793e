"""The description of one experiment: bead, medium, lens, beam, wall, start, forces, and so on.

Scenes are TOML files. Quantities may carry units ("500 nm"); bare numbers are SI. A scene is
immutable, and every way to make one validates it.
"""

from __future__ import annotations

import difflib
import itertools
import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self, get_args, get_origin

from pydantic import Field, ValidationError, model_validator
from pydantic_core import ErrorDetails

from tweezer.scene.choices import EVALUATORS, METHODS, MODELS, Evaluator, methods
from tweezer.scene.courses import Section, refusal, with_tables
from tweezer.scene.materials import Material, materials
from tweezer.scene.sections import (
    ALTERNATIVES,
    BELONGING,
    FILLED,
    NAMED,
    WITHIN_LAYERS,
    Bead,
    Beam,
    Camera,
    Forces,
    Lens,
    Medium,
    Optics,
    Simulation,
    Start,
    Wall,
)
from tweezer.scene.theory import NO_MAP, Choice, chosen_theory, named_beams
from tweezer.scene.water import LIQUID, Water, water
from tweezer.values.errors import SceneError, UnitWarning, warn
from tweezer.values.files import read_text
from tweezer.values.rounding import least
from tweezer.values.saved import kind_of_file
from tweezer.values.shown import Card, Row, as_html, as_text
from tweezer.values.units import TABLE_RADII, TEMPERATURE, Quantity, as_given, quantity_of, to_si

SHIPPED = Path(__file__).parents[1] / "scenes"

#: Knudsen number up to which the medium is taken as a continuum (thesis, 2.2.2)
KNUDSEN_LIMIT = 1e-3

#: the key that a scene has in place of one that says the same
_HALVES = {(section, other): key for section, pairs in ALTERNATIVES.items() for key, other in pairs}

#: Thickness of the thinnest cell of two walls, in radii
THINNEST = 20.0
#: Distance of a wall from the bead's centre from which on memory leaves it out, in radii
FREE = 20.0
#: Part of a depth within which two places are one
_SAME_PLACE = 1e-9

#: Largest number of frames of a run
_MOST_FRAMES = 10_000_000
#: One of several beams, counted from 1
_NUMBERED = re.compile(r"beam\[([1-9][0-9]*)\]")

#: Words and numbers that mean true or false, as a scene file does not have them
_SWITCHES = {
    **dict.fromkeys(("true", "yes", "on", "1"), "true"),
    **dict.fromkeys(("false", "no", "off", "0"), "false"),
}

#: what `tomllib` raises: besides its own, for numbers too long and lists too deep
_NOT_TOML = (ValueError, RecursionError)
#: largest number of invalid values that are listed for one scene
_MOST_LINES = 20


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
    wall: Wall | None = Field(None, description="a plane that ends the fluid; none if not given")
    forces: Forces = Field(default_factory=Forces)
    camera: Camera | None = Field(
        None, description="a camera whose frames a run has beside the positions; none if not given"
    )
    optics: Optics = Field(default_factory=Optics)
    simulation: Simulation

    def card(self) -> Card:
        """Bead, medium, light, start, forces, and what differs from the shipped scene."""
        bead, medium, motion = self.bead, self.medium, self.simulation
        index = bead.index if bead.index.imag else bead.index.real
        viscosity = f"{1e3 * medium.viscosity:.4g} mPa s"
        power = sum(beam.power_through_pupil or beam.power or 0.0 for beam in self.beams)
        light = f"{1e3 * power:.4g} mW at {1e9 * self.beam.wavelength:.4g} nm"
        light += f", {_counted(self.beams)}" if self.more_beams else ""
        acting = [name for name, on in self.forces if on is True]
        start = ", ".join(f"{round(1e6 * each, 9) + 0.0:.4g}" for each in self.start_position)
        run = f"{1e3 * motion.duration:.4g} ms, {motion.samples} samples"
        made_of = f" of {bead.material}" if bead.material else ""
        rows = [
            Row("bead", f"{2e6 * bead.radius:.4g} um{made_of}, index {index:.5g}, "
                f"{bead.density:.5g} kg/m^3"),
            Row("medium", f"index {medium.refractive_index:.5g}, {viscosity}, "
                f"{medium.temperature:.5g} K"),
            Row("light", f"{light}; computed as {self.theory} ({self.theory_reason})"
                if self.lit else "none"),
            Row("start", f"{start} um from the focus"),
            Row("forces", ", ".join(acting) or "none"),
            Row("run", run),
        ]  # fmt: skip
        if self.wall is not None:
            rows.insert(2, Row("wall", f"at {1e6 * self.wall.position:.4g} um"))
        if changes := self._changes_in_short():
            rows.append(Row("changed", changes))
        return Card("Scene", self.name, tuple(rows))

    def _changes_in_short(self) -> str:
        """What differs from the shipped scene of this name; "" if nothing or there is none."""
        if self.name not in (shipped := shipped_scenes()):
            return ""
        here = by_key(self.model_dump())
        there = by_key(load_scene(shipped[self.name]).model_dump())
        filled = {f"medium.{key}" for key in self.medium.filled}
        filled |= {f"bead.{key}" for key in self.bead.filled}
        keys = sorted((here.keys() | there.keys()) - filled)
        changed = [key for key in keys if here.get(key) != there.get(key)]
        told = []
        if ("beam.power" in here) != ("beam.power" in there):
            told.append(_counted(self.beams))
            changed = [key for key in changed if not key.startswith("beam")]
        return "; ".join([*told, *(f"{key} = {_short(here.get(key))}" for key in changed)])

    def __repr__(self) -> str:
        """A few lines."""
        return as_text(self.card())

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """A table, for Jupyter."""
        return as_html(self.card())

    @model_validator(mode="before")
    @classmethod
    def _medium_by_name(cls, data: Any) -> Any:
        """Fill in what the medium's name gives and the scene does not.

        After what follows here: what comes before validation goes from the last to the first.
        """
        medium = data.get("medium") if isinstance(data, dict) else None
        if not isinstance(medium, dict) or medium.get("name") != "water":
            return data
        missing = [key for key in NAMED["medium"][1] if medium.get(key) is None]
        if not missing:
            return data
        found = _of_water(data, medium, indexed="refractive_index" in missing)
        filled = {key: getattr(found, key) for key in missing}
        return {**data, "medium": {**medium, **filled, FILLED: missing}}

    @model_validator(mode="before")
    @classmethod
    def _bead_of_materials(cls, data: Any) -> Any:
        """Fill in what the materials of bead and layers give and the scene does not."""
        bead = data.get("bead") if isinstance(data, dict) else None
        return {**data, "bead": _of_materials(data, bead)} if isinstance(bead, dict) else data

    @model_validator(mode="before")
    @classmethod
    def _one_index_for_all_beams(cls, data: Any) -> Any:
        """Refuse names in place of an index beside beams of several wavelengths."""
        if isinstance(data, dict):
            _refuse_names_of_indices(data)
        return data

    @model_validator(mode="before")
    @classmethod
    def _wall_of_the_cover(cls, data: Any) -> Any:
        """Put the wall where the face of the cover is, if the scene does not say where it is."""
        if not isinstance(data, dict) or not isinstance(wall := data.get("wall"), dict):
            return data
        lens = data.get("lens")
        cover = lens.get("cover") if isinstance(lens, dict) else getattr(lens, "cover", None)
        if wall.get("position") is not None or cover is None:
            return data
        try:
            depth = cover.get("depth") if isinstance(cover, dict) else cover.depth
            position = -to_si(depth, "m")
        except (ValueError, AttributeError):
            return data  # what is wrong is found where the cover is read
        return {**data, "wall": {**wall, "position": position, FILLED: ["position"]}}

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

    @property
    def light_moves(self) -> bool:
        """Whether the focus of any beam moves."""
        return any(beam.motion is not None for beam in self.beams)

    @property
    def last_change(self) -> float:
        """Time after which no beam moves or changes any more, s; 0 if none does."""
        courses = [each for beam in self.beams for each in (beam.motion, beam.modulation) if each]
        return max((each.last_change for each in courses), default=0.0)

    def with_one_beam(self, beam: Beam, offset: float = 0.0) -> Scene:
        """The scene with that beam alone, along z through the origin, always the same.

        offset: largest distance, m, from the origin at which the beam's focus was; the bead may be
        farther from it by that.
        """
        at_rest = {
            "position": (0.0, 0.0, 0.0),
            "direction": "up",
            "motion": None,
            "modulation": None,
        }
        update = {"beam": beam.model_copy(update=at_rest), "more_beams": ()}
        if self.more_beams or offset:  # all are of one theory
            update["optics"] = self.optics.model_copy(update={"theory": self.theory})
        if offset:
            far = self.simulation.loss_distance + offset
            update["simulation"] = self.simulation.model_copy(update={"loss_distance": far})
        return self.model_copy(update=update)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        self._aperture_in_reach()
        by = EVALUATORS.get(self.optics.evaluator)
        for beam in self.beams:
            if self.lit and self.optics.evaluator == "grid":
                self._wider_than_a_square(beam)
        if by and not self.allows(by):
            raise refusal(NO_MAP)
        if self.lit and self.theory == "rays":
            self._map_of_rays()
        if self.lens.cover is not None:
            self._foci_at_the_depth()
        self._thermal()
        self._beside_the_wall()
        self._inertia_of_the_fluid()
        self._some_frame()
        if self.start.frame == "lens" and self.lens.focal_length is None:
            raise refusal("start.frame = 'lens': needs lens.focal_length")
        self._start_in_the_medium()
        return self

    def of_power(self, power: float) -> Scene:
        """The scene with that power through the pupil, W, by its only beam."""
        beam = self.beam.model_copy(update={"power": None, "power_through_pupil": power})
        return self.model_copy(update={"beam": beam})

    def allows(self, by: Evaluator) -> bool:
        """Return whether the light has the symmetry that an evaluator needs in its theory."""
        linear = any(beam.polarisation == "linear" for beam in self.beams)
        return not (self.theory in by.symmetric and linear)

    def _aperture_in_reach(self) -> None:
        """Refuse a sine map whose outermost rays leave the lens at a right angle or beyond."""
        lens, key, index = self.lens, "medium", self.medium.refractive_index
        if lens.cover is not None:
            key, index = "lens.cover", lens.cover.refractive_index
        if lens.map == "sine" and lens.numerical_aperture and lens.numerical_aperture >= index:
            remedy = (
                "give lens.cover for an oil immersion objective, as "
                '`tweezer new --objective "100x/1.40 oil"` does'
                if lens.cover is None
                else "give the index of the immersion oil"
            )
            raise refusal(
                f"lens.numerical_aperture = {lens.numerical_aperture:g}: must be less than "
                f"{key}.refractive_index = {index:.5g} for the sine map; {remedy}"
            )

    def _map_of_rays(self) -> None:
        """Refuse a range that the map of rays does not have."""
        if not TABLE_RADII[0] <= self.table_radii <= TABLE_RADII[1]:
            raise refusal(
                f"optics.table_range = {self.optics.table_range!r}: is {self.table_radii:.3g} "
                "radii of the bead; must be from "
                f"{TABLE_RADII[0]:g} to {TABLE_RADII[1]:g} of them for rays"
            )

    def _foci_at_the_depth(self) -> None:
        """Refuse foci that are nearer to the face of a cover than its depth, or farther."""
        for name, beam in named_beams(self.beams):
            if beam.position[2]:
                raise refusal(
                    f"{name}.position = {list(beam.position)}: must be at z = 0 beside lens.cover, "
                    "whose depth is that of the focus"
                )
            if beam.motion is not None and beam.motion.along_light:
                raise refusal(f"{name}.motion: must be across the light beside lens.cover")

    def _start_in_the_medium(self) -> None:
        """Refuse a start that is not between the lens, or the face of its cover, and loss."""
        x, y, z = self.start_position
        ball, radius = self.start.ball_radius or 0.0, self.bead.radius
        given = f"start.position = {list(self.start.position)}"
        if self.lens.focal_length is not None and z - ball <= radius - self.lens.focal_length:
            raise refusal(f"{given}: the bead must start beyond the lens, by more than its radius")
        if (cover := self.lens.cover) is not None:
            towards = {"up": z, "down": -z}
            if min(towards[beam.direction] for beam in self.beams) - ball <= radius - cover.depth:
                raise refusal(
                    f"{given}: the bead must start beyond the face of lens.cover, which is "
                    f"{cover.depth:.3g} m before the focus, by more than its radius"
                )
        distance = math.hypot(x, y, z) + ball
        if distance >= self.simulation.loss_distance:
            to = "and its ball reach to" if ball else "is"
            raise refusal(
                f"{given}: {to} {distance:.3g} m from the focus; must be nearer than "
                f"simulation.loss_distance = {self.simulation.loss_distance:.3g} m"
            )

    def _beside_the_wall(self) -> None:
        """Refuse a bead in a wall, a cell that is too thin, and what needs a wall without one."""
        wall, radius = self.wall, self.bead.radius
        if wall is None:
            if self.forces.dlvo is not None:
                raise refusal("forces.dlvo: needs a [wall]")
            return
        cover = self.lens.cover
        if cover is not None and (
            wall.side == "below" or abs(wall.position + cover.depth) > _SAME_PLACE * cover.depth
        ):
            raise refusal(
                f"wall.position = {wall.position:g}, side = {wall.side!r}: with lens.cover the "
                f"wall is its face, at {-cover.depth:g}, and the bead above it"
            )
        z, ball = self.start_position[2], self.start.ball_radius or 0.0
        room = {"wall": self.gap(z)}
        if wall.opposite is not None:
            thickness = abs(wall.opposite - wall.position)
            if thickness < THINNEST * radius * (1 - 1e-9):
                raise refusal(
                    f"wall.opposite = {wall.opposite:g}: {thickness:.3g} m from wall.position; "
                    f"must be at least {THINNEST:g} radii, {least(THINNEST * radius)} m: nearer "
                    "planes do not add up"
                )
            room["wall.opposite"] = thickness - 2 * radius - self.gap(z)
        for name, gap in room.items():
            if gap - ball <= 0:
                raise refusal(
                    f"start.position = {list(self.start.position)}: the bead must start beside "
                    f"{name}, not in it; its gap would be {gap - ball:.3g} m"
                )

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
                f"simulation.method = {method!r}: draws no thermal motion; allowed: auto, "
                f"{', '.join(each.name for each in methods(thermal=True))}"
            )
        if how and model and model not in how.models:
            raise refusal(
                f"simulation.method = {method!r}: cannot follow simulation.model = {model!r}; set "
                f"simulation.model to {_either(how.models)}"
            )
        if model == "first-order" and self.rotates:
            raise refusal(
                "simulation.model = 'first-order': has no rotation with thermal motion; set "
                "simulation.model to overdamped"
            )
        if how and how.spring_only and self._turned_by_light:
            raise refusal(
                f"simulation.method = {method!r}: a spring exerts no torque; allowed: "
                "beam.torque = 'none', and a bead that does not absorb"
            )
        if self.rotates and self.bead.moments_of_inertia and model != "overdamped":
            raise refusal(
                "bead.moments_of_inertia: thermal rotation with inertia is computed for spheres; "
                "remove it, or set simulation.model to overdamped"
            )

    def _some_frame(self) -> None:
        """Refuse a camera that sees nothing of the run, or what is not the bead's motion."""
        if self.camera is None:
            return
        if self.camera.exposure > self.simulation.duration:
            raise refusal(
                f"camera.exposure = {self.camera.exposure:g}: must be at most simulation.duration "
                f"= {self.simulation.duration:g}"
            )
        frames = self.camera.rate * self.simulation.duration
        if frames > _MOST_FRAMES:
            raise refusal(
                f"camera.rate = {self.camera.rate:g}: sees {frames:.3g} frames in "
                f"simulation.duration = {self.simulation.duration:g}; must be at most "
                f"{_MOST_FRAMES:,}"
            )
        method = self.simulation.method
        if method != "auto" and not METHODS[method].displacements:
            raise refusal(
                f"simulation.method = {method!r}: a camera needs displacements, which this method "
                "does not reproduce; allowed: auto, heun"
            )

    def _inertia_of_the_fluid(self) -> None:
        """Refuse what does not go with a fluid that has inertia."""
        inertia, model, method = self.medium.inertia, self.simulation.model, self.simulation.method
        if inertia in (None, "none"):
            return
        said = f"medium.inertia = {inertia!r}"
        if model and not MODELS[model].inertia:
            having = _either([each.name for each in MODELS.values() if each.inertia])
            past = ""
            if inertia == "memory":
                past = (
                    ". The model leaves out that the bead falls behind by up to "
                    f"{self.lag:.2g} s times its speed"
                )
            raise refusal(
                f"{said}: needs inertia, which simulation.model = {model!r} has not; set "
                f"simulation.model to {having}{past}"
            )
        if inertia != "memory":
            return
        if self.wall is not None and min(self.room(self.start_position[2]), self.room(0.0)) < (
            (FREE - 1) * self.bead.radius
        ):
            raise refusal(
                f"{said}: a wall nearer than {FREE:g} radii to start or focus takes up the "
                "vorticity that the bead sheds (the tail falls as t^(-5/2), not t^(-3/2)); "
                "allowed: 'none', 'added-mass'"
            )
        if method != "auto" and not METHODS[method].memory:
            brownian = self.forces.brownian
            allowed = [each.name for each in methods(thermal=brownian) if each.memory]
            raise refusal(
                f"{said}: simulation.method = {method!r} cannot follow it; set simulation.method "
                f"to {_either(['auto', *allowed])}"
            )

    def _wider_than_a_square(self, beam: Beam) -> None:
        """Refuse a beam that the grid of rays would not see."""
        half_side = self.lens.radius / beam.divisions
        if beam.sigma is not None and beam.sigma < half_side * (1 - 1e-9):
            raise refusal(
                f"beam.sigma = {beam.sigma:.3g}: must be at least {least(half_side)} m, half the "
                f"side of a square of the grid, for {beam.divisions} beam.divisions"
            )
        if beam.profile_radius is not None and beam.profile_radius[-1] < 2 * half_side * (1 - 1e-9):
            raise refusal(
                f"beam.profile_radius ends at {beam.profile_radius[-1]:.3g}: must reach "
                f"{least(2 * half_side)} m, the side of a square of the grid, for {beam.divisions} "
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
        if "medium.viscosity" in self.changed or "viscosity" in self.medium.filled:
            return ""
        keys = [
            key for key in ("viscosity", "density", "refractive_index")
            if f"medium.{key}" not in self.changed and key not in self.medium.filled
        ]  # fmt: skip
        *most, last = keys
        return f"{', '.join(most)} and {last}" if most else last

    @property
    def start_position(self) -> tuple[float, float, float]:
        """Where the bead starts, m from the focus."""
        x, y, z = self.start.position
        if self.start.frame == "lens":
            z -= self.lens.focal_length or 0.0
        return x, y, z

    @property
    def vorticity_time(self) -> float:
        """r^2 rho_m/mu_m, s: in it the vorticity that the bead sheds gets as far as its radius."""
        return self.bead.radius**2 * self.medium.density / self.medium.viscosity

    @property
    def lag(self) -> float:
        """2 sqrt(tau_f t/pi) at the end of the run, s.

        Times its speed: the way that a bead in a fluid with inertia is behind one without, where
        the force changes slowly; tau_f is `vorticity_time`.
        """
        return 2 * math.sqrt(self.vorticity_time * self.simulation.duration / math.pi)

    def gap(self, z: Any) -> Any:
        """Distance of the bead's surface from the wall, m, with its centre at z, m from the focus.

        Raises `SceneError` for a scene without a wall.
        """
        if self.wall is None:
            raise SceneError("wall: the scene has none")
        return self.wall.normal * (z - self.wall.position) - self.bead.radius

    def room(self, z: Any) -> Any:
        """The gap to the wall, or to the opposite one, m, whichever is smaller; see `gap`."""
        gap = self.gap(z)
        if self.wall is None or self.wall.opposite is None:
            return gap
        middle = abs(self.wall.opposite - self.wall.position) / 2 - self.bead.radius
        return middle - abs(gap - middle)

    @property
    def free_of_walls(self) -> float:
        """Distance from the focus within which no wall is nearer than 20 radii, m."""
        return float(self.room(0.0)) - (FREE - 1) * self.bead.radius if self.wall else math.inf

    @property
    def draws(self) -> bool:
        """Whether random numbers are drawn, so that a seed has a meaning."""
        return self.forces.brownian or (self.camera is not None and any(self.camera.noises))

    @property
    def rotates(self) -> bool:
        """Whether anything turns the bead: if not, no rotation is computed."""
        turned = self._turned_by_light or any(self.start.angular_velocity)
        return turned or self.forces.brownian_torque

    @property
    def _turned_by_light(self) -> bool:
        """Whether the light exerts a torque: by the thesis's rays, or as waves by absorption."""
        if self.theory == "waves":
            return self.bead.absorbs
        return self.lit and any(beam.torque == "thesis" for beam in self.beams)

    @property
    def theory(self) -> str:
        """Theory that the light is computed with: "rays" or "waves"."""
        return self._theory.theory

    @property
    def theory_reason(self) -> str:
        """Why the light is computed with that theory, in one clause."""
        return self._theory.reason

    @property
    def _theory(self) -> Choice:
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
        """How far the map reaches from the focus, in radii of the bead."""
        reach = self.optics.table_range
        return to_si(reach, "m") / self.bead.radius if isinstance(reach, str) else reach

    @property
    def table_reach(self) -> float:
        """How far the map reaches from the focus, m."""
        reach = self.optics.table_range
        return to_si(reach, "m") if isinstance(reach, str) else reach * self.bead.radius

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

    def decided(self, **sections: Mapping[str, Any]) -> Scene:
        """A copy with what was left open, such as the model: no change of what is described."""
        copy = self._replaced(sections)
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


def _of_water(data: Mapping[str, Any], medium: Mapping[str, Any], *, indexed: bool) -> Water:
    """Water in a scene as it is given; indexed: at the wavelength of its beams."""
    try:
        temperature = to_si(medium.get("temperature"), "K", *TEMPERATURE)
        wavelengths = _wavelengths(data)
    except (ValueError, AttributeError):
        return Water(1000.0, 1e-3, 1.33)  # what is wrong is found where the keys are read
    try:
        return water(temperature, *wavelengths[:1] if indexed else ())
    except ValueError as error:
        cold_or_hot = not LIQUID[0] <= temperature <= LIQUID[1]
        key = "medium.temperature" if cold_or_hot else "beam.wavelength"
        given = medium["temperature"] if cold_or_hot else wavelengths[0]
        way_out = "" if cold_or_hot else "; give medium.refractive_index"
        raise refusal(f"{key} = {given!r}: {error}{way_out}") from None


def _wavelengths(data: Mapping[str, Any]) -> list[float]:
    """Vacuum wavelengths of the beams of a scene as it is given, m.

    Raises `ValueError` or `AttributeError` where it is not valid.
    """
    return [
        to_si(beam.get("wavelength") if isinstance(beam, Mapping) else beam.wavelength, "m")
        for beam in (data.get("beam"), *(data.get("more_beams") or ()))
    ]


def _refuse_names_of_indices(data: Mapping[str, Any]) -> None:
    """Refuse all names that stand for an index if the beams have several wavelengths."""
    try:
        wavelengths = _wavelengths(data)
    except (ValueError, AttributeError):
        return  # what is wrong is found where the beams are read
    if max(wavelengths) == min(wavelengths):
        return
    bead, medium = data.get("bead"), data.get("medium")
    layers = bead.get("layers") if isinstance(bead, dict) else None
    named = [("bead", bead, "material"), ("medium", medium, "name")]
    if isinstance(layers, list | tuple):
        named[:1] = [(f"bead.layers.{i}", each, "material") for i, each in enumerate(layers)]
    given = [
        (f"{section}.{key} = {part[key]!r}", f"{section}.refractive_index")
        for section, part, key in named
        if isinstance(part, dict) and part.get("refractive_index") is None
        if str(part.get(key)) in (*materials(), "water")
    ]
    if given:
        names, indices = (" and ".join(each) for each in zip(*given, strict=True))
        raise refusal(
            f"{names}: {'have' if len(given) > 1 else 'has'} another index for each of the beams' "
            f"wavelengths; give {indices}"
        )


def _of_materials(data: Mapping[str, Any], bead: Mapping[str, Any]) -> dict[str, Any]:
    """A bead of a scene as it is given, with what its materials give."""
    layers = bead.get("layers")
    if layers is None:
        density = getattr(materials().get(str(bead.get("material"))), "density", None)
        return _with_material(data, bead, "bead", density)
    if not isinstance(layers, list | tuple) or not all(isinstance(each, dict) for each in layers):
        return dict(bead)
    density = _mean_density(layers) if bead.get("density") is None else None
    filled = {"density": density, FILLED: ["density"]} if density else {}
    within = [_with_material(data, each, f"bead.layers.{i}", None) for i, each in enumerate(layers)]
    return {**bead, **filled, "layers": within}


def _with_material(
    data: Mapping[str, Any], part: Mapping[str, Any], name: str, density: float | None
) -> dict[str, Any]:
    """A bead or a layer, with the index of its material and a density where it has none."""
    filled: dict[str, Any] = {}
    if part.get("density") is None and density is not None:
        filled["density"] = density
    material = materials().get(str(part.get("material")))
    if material is not None and part.get("refractive_index") is None:
        index = _index_of(material, data, name)
        filled["refractive_index"] = (index.real, index.imag) if index.imag else index.real
    return {**part, **filled, FILLED: list(filled)} if filled else dict(part)


def _index_of(material: Material, data: Mapping[str, Any], name: str) -> complex:
    """Index of a material at the wavelength of the beams of a scene as it is given."""
    try:
        wavelengths = _wavelengths(data)
    except (ValueError, AttributeError):
        return 1.5 + 0j  # what is wrong is found where the beams are read
    try:
        return material.refractive_index(wavelengths[0])
    except ValueError as error:
        raise refusal(
            f"beam.wavelength = {wavelengths[0]:g}: {error}; give {name}.refractive_index"
        ) from None


def _mean_density(layers: Sequence[Mapping[str, Any]]) -> float | None:
    """Density of a bead of layers that all have a material, kg/m^3; None for others."""
    made_of = [materials().get(str(each.get("material"))) for each in layers]
    if not all(made_of):
        return None
    try:
        radii = [
            to_si(each["radius"], "m") if "radius" in each else to_si(each["diameter"], "m") / 2
            for each in layers
        ]
    except (KeyError, ValueError):
        return 1000.0  # what is wrong is found where the layers are read
    cubes = [0.0, *(radius**3 for radius in radii)]
    shells = [b - a for a, b in itertools.pairwise(cubes)]
    mass = sum(of.density * shell for of, shell in zip(made_of, shells, strict=True) if of)
    return mass / cubes[-1] if min(shells) > 0 else 1000.0


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


SceneLike = Scene | str | Path | Mapping[str, Any]
"""a scene, the name of a shipped one, a TOML file, or a mapping of the same form"""


def checked_scene(scene: SceneLike) -> Scene:
    """Return the scene that an argument is or names (see `load_scene`).

    Raises `SceneError` if it is no scene and names none.
    """
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, str | Path | Mapping):
        return load_scene(scene)
    raise SceneError(
        f"scene = {_short(scene)}: must be a Scene, the name of a shipped one, a TOML file or a "
        "mapping"
    )


def _displaced(key: str, section: str, changes: Mapping[str, Any]) -> bool:
    """Whether `changes` to a section leave no room for a `key` that was there."""
    for pair in ALTERNATIVES.get(section, ()):
        if key in pair and set(pair) & set(changes):
            return True
    naming, given = NAMED.get(section, ("", ()))
    if key in given and changes.get(naming):
        return True
    if section == "bead" and "layers" in changes:
        return key in WITHIN_LAYERS
    if section == "bead" and key == "layers":
        return "refractive_index" in changes or "material" in changes
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
        data = tomllib.loads(read_text(path))
    except FileNotFoundError:
        raise SceneError(
            f"no scene file {name!r}, and no shipped scene of that name; {_shipped_like(path)}"
        ) from None
    except (*_NOT_TOML, OSError) as error:
        if (kind := kind_of_file(path)) and kind.name != "scene":
            reason = f"is {kind.told}, not a scene{kind.way(name)}"
        elif isinstance(error, UnicodeDecodeError):
            reason = "not a text file in UTF-8"
        elif isinstance(error, OSError):
            reason = f"cannot be read: {error.strerror}"
        else:
            reason = f"not valid TOML: {error}"
        raise SceneError(f"{name!r}: {reason}") from None
    if not data:
        raise SceneError(f"{name!r}: is empty; `tweezer new` writes a scene")
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
    """Return `scene` with dotted keys set to text values, as given on a command line.

    A key is `section.key`, `beam[2].key` of several beams, or `beam.motion.key`. Familiar words
    such as lens.NA stand for keys, see `FAMILIAR`.
    A value is read as TOML where it is TOML ("1e-4", "[0, 0, 1e-6]") and as text otherwise
    ("80 mW"); "True" and "False" are as Python has them. Raises `SceneError`.
    """
    sections: dict[str, Any] = {}
    for key, text in settings.items():
        section, dot, name = key.partition(".")
        if not dot:
            alike = [each for each in settable() if each.rpartition(".")[2] == key]
            meant = f"; did you mean {' or '.join(alike)}?" if alike else ", such as beam.power"
            raise SceneError(f"{key!r}: must be section.key{meant}")
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
        if not dot and name not in of:
            name = familiar(section, name)
        if name in within:
            raise SceneError(f"{key}: {section}.{name} is set twice")
        within[name] = value
    return scene.replace(**sections)


def described_at(key: str) -> tuple[Quantity | None, str]:
    """The quantity that a dotted key of a scene holds, None if it is none, and its description.

    A key is as in `with_settings`. Raises `SceneError` for a key that no scene has.
    """
    first, *parts = key.split(".")
    within = _kind(first)
    field = Scene.model_fields.get(within)
    for part in parts:
        section = _section_of(field.annotation) if field else None
        name = _HALVES.get((within, part), part)
        fields = section.model_fields if section else {}
        if name not in fields:
            near = _meant(within, part, fields)
            meant = ".".join([first, *parts[: parts.index(part)], *near])
            raise SceneError(f"{key}: unknown key{f'; did you mean {meant}?' if near else ''}")
        within, field = f"{within}.{name}", fields[name]
    if not parts or field is None or _section_of(field.annotation):
        raise SceneError(f"{key}: must be section.key, such as beam.power")
    return quantity_of(*field.metadata, field.annotation), field.description or key


def settable() -> dict[str, tuple[str, ...]]:
    """Every dotted key that `with_settings` takes of a scene with one beam, and its choices if any.

    Choices are names, or "true" and "false".
    """
    found: dict[str, tuple[str, ...]] = {}
    for name, field in Scene.model_fields.items():
        if (section := _section_of(field.annotation)) and name != "more_beams":
            found |= _settable(name, section)
    return found


def _settable(within: str, section: Any) -> dict[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    for name, field in section.model_fields.items():
        inner = _section_of(field.annotation)
        if inner and inner in get_args(field.annotation):  # one section, not a list of them
            found |= _settable(f"{within}.{name}", inner)
        else:
            found[f"{within}.{name}"] = _choices(field.annotation)
    others = (key for pair in ALTERNATIVES.get(within, ()) for key in pair)
    return found | {f"{within}.{key}": () for key in others if f"{within}.{key}" not in found}


def _choices(annotation: Any) -> tuple[str, ...]:
    """The names that an annotation allows; none where it allows other values."""
    if annotation is bool:
        return "true", "false"
    if get_origin(annotation) is Literal:
        return tuple(map(str, get_args(annotation)))
    return next(filter(None, map(_choices, get_args(annotation))), ())


def value_at(scene: Scene, key: str) -> Any:
    """The value of a dotted key of `scene`, as in `with_settings`; None if it has none.

    Raises `SceneError` for a key that no scene has.
    """
    described_at(key)
    first, *parts = key.split(".")
    numbered = _NUMBERED.fullmatch(first)
    within, value = _kind(first), getattr(scene, _kind(first))
    if numbered and (number := int(first[5:-1])) != 1:
        value = scene.beams[number - 1] if number <= len(scene.beams) else None
    for part in parts:
        name = _HALVES.get((within, part), part)
        doubled = name != part and not hasattr(value, part)
        value = getattr(value, name if doubled else part, None)
        if doubled and value is not None:
            value *= 2
        within = f"{within}.{name}"
    return value


def _validated(data: dict[str, Any], given: Mapping[str, Any]) -> Scene:
    """The scene of `data`; warns of bare numbers in the part of it that a user has `given`."""
    try:
        scene = Scene.model_validate(data)
    except ValidationError as error:
        several = isinstance(data.get("beam"), list | tuple) or bool(data.get("more_beams"))
        lines = (" ".join(line.splitlines()) for line in _lines(error, several))
        shown = list(itertools.islice(lines, _MOST_LINES))
        if (more := error.error_count() - len(shown)) > 0 and len(shown) == _MOST_LINES:
            shown.append(f"and {more} more")
        raise SceneError("\n".join(shown)) from None
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
    errors = error.errors(include_url=False)
    wrong = {details["loc"] for details in errors}
    for details in errors:
        where = details["loc"]
        name, filled = NAMED.get(str(where[0]), ("", ())) if where else ("", ())
        if details["type"] == "missing" and (where[0], name) in wrong and where[-1] in filled:
            continue  # the right name would give it
        if several and where[:1] == ("beam",):
            where = ("beam[1]", *where[1:])
        elif where[:1] == ("more_beams",) and len(where) > 1:  # as the file has them: [[beam]]
            where = (f"beam[{int(where[1]) + 2}]", *where[2:])
        key = ".".join(str(part) for part in where)
        named = _clipped(key)
        if details["type"] == "scene":
            yield f"{key}.{details['msg']}" if key else details["msg"]
        elif details["type"] == "missing":
            yield f"{named}: missing"
        elif details["type"] == "extra_forbidden":
            yield f"{named} = {_short(details['input'])}: unknown key; {_known_keys(details)}"
        else:
            yield f"{named} = {_short(details['input'])}: {_allowed(details, key)}"


def _either(names: Sequence[str]) -> str:
    """Return names as a choice, such as "a, b or c"."""
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


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
    return f"{value:g}" if isinstance(value, float) else _clipped(as_given(value))


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
    near = _meant(".".join(names).replace("more_beams", "beam"), str(details["loc"][-1]), keys)
    return f"did you mean {near[0]}?" if near else f"allowed: {', '.join(keys)}"


#: what people call keys of a scene, by section
FAMILIAR = {
    "bead": {
        "size": "diameter", "d": "diameter", "a": "radius", "r": "radius", "n": "refractive_index",
        "index": "refractive_index", "rho": "density",
    },
    "medium": {
        "n": "refractive_index", "index": "refractive_index", "T": "temperature",
        "eta": "viscosity", "mu": "viscosity", "rho": "density",
    },
    "lens": {"NA": "numerical_aperture", "f": "focal_length"},
    "beam": {"lambda": "wavelength", "w0": "waist", "P": "power"},
    "simulation": {"dt": "step", "time": "duration", "steps": "samples"},
    "forces": {"thermal": "brownian", "noise": "brownian", "weight": "gravity"},
}  # fmt: skip


def familiar(section: str, name: str) -> str:
    """Return the key of a section that a word such as NA stands for, or the word itself."""
    words = {word.lower(): key for word, key in FAMILIAR.get(_kind(section), {}).items()}
    return words.get(name.lower(), name)


def _meant(section: str, name: str, keys: Iterable[str]) -> list[str]:
    """Return the key of a section that an unknown one probably means, if any, in a list."""
    if (key := familiar(section, name)) != name:
        return [key]
    halves = [key for pair in ALTERNATIVES.get(section, ()) for key in pair]
    return difflib.get_close_matches(name, [*keys, *halves], n=1)


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
            meant = _SWITCHES.get(str(details["input"]).lower())
            return f"must be true or false{f'; did you mean {meant}?' if meant else ''}"
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
