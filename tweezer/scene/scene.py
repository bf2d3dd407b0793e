"""Validated description of an experiment: bead, medium, lens, beam, wall, start, forces, and so on.

Scenes are TOML files. Quantities may have units ("500 nm"); numbers without a unit are SI. A scene
is immutable, and every way to make one validates it.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import ValidationError, model_validator

from tweezer.scene.courses import Section, with_tables
from tweezer.scene.description import Description
from tweezer.scene.files import read_scene, shipped_scenes
from tweezer.scene.filling import filled_in
from tweezer.scene.heating import heats_bead, heats_medium, medium_at
from tweezer.scene.interference import planes
from tweezer.scene.keys import HALVES, NUMBERED, SEVERAL, by_key, changed_section, kind_of
from tweezer.scene.media import GASES
from tweezer.scene.messages import as_toml, counted, doubts_of, in_short, lines_of, numbered
from tweezer.scene.rules import check, warn_of_unused_aperture
from tweezer.scene.sections import Beam
from tweezer.scene.temperatures import Heating
from tweezer.values.errors import SceneError, UnitWarning, warn
from tweezer.values.printed import printed
from tweezer.values.rounding import micrometres
from tweezer.values.shown import Card, Row, as_html, as_text

#: Largest Knudsen number for which the medium is a continuum (thesis, 2.2.2)
KNUDSEN_LIMIT = 1e-3
#: Sections whose choices do not change the temperatures in the light
_KEEPING_HEAT = frozenset({"medium", "optics", "simulation"})
#: Largest number of invalid values that are listed for one scene
_MOST_LINES = 20


class Scene(Description):
    """A validated scene, which `load_scene` creates and `replace` changes."""

    @model_validator(mode="before")
    @classmethod
    def _filled_in(cls, data: Any) -> Any:
        """Fill in values that follow from names, materials and the cover."""
        return filled_in(data) if isinstance(data, dict) else data

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        """Refuse sections that contradict each other."""
        check(self)
        return self

    def card(self) -> Card:
        """Return the card with bead, medium, light, release, forces, and changes to the shipped
        scene.
        """
        bead, medium, motion = self.bead, self.medium, self.simulation
        index = bead.index if bead.index.imag else bead.index.real
        indexed = f", index {index:.5g}" if bead.indexed else ""
        viscosity = printed(medium.viscosity, "mPa s")
        power = sum(beam.power_through_pupil or beam.power or 0.0 for beam in self.beams)
        light = f"{printed(power, 'mW')} at {printed(self.beam.wavelength, 'nm')}"
        light += f", {counted(self.beams)}" if self.more_beams else ""
        acting = [name for name, on in self.forces if on is True]
        start = ", ".join(map(micrometres, self.start_position))
        run = f"{printed(motion.duration, 'ms')}, {motion.samples} samples"
        made_of = f" of {bead.material}" if bead.material else ""
        rows = [
            Row("bead", f"{bead.size_in_words}{made_of}{indexed}, "
                f"{bead.density:.5g} kg/m^3"),
            *self._more_beads_in_words(),
            Row("medium", f"index {medium.refractive_index:.5g}, {viscosity}, "
                f"{medium.temperature:.5g} K"),
            Row("light", f"{light}; {self.theory.removesuffix('s')} optics ({self.theory_reason})"
                if self.lit else "none"),
            Row("start", f"{start} um from the focus"),
            Row("forces", ", ".join(acting) or "none"),
            Row("run", run),
        ]  # fmt: skip
        if medium.viscoelastic:
            rows.insert(2, Row("viscoelastic", medium.relaxation_in_words))
        if self.wall is not None:
            rows.insert(2, Row("wall", self._planes_in_words("wall")))
        if self.heat is not None:
            rows.insert(2, Row("heat", self.heat_in_words()))
        if self.mirror is not None:
            rows.insert(2, Row("mirror", self._planes_in_words("mirror")))
        if changes := self._changes_in_short():
            rows.append(Row("changed", changes))
        return Card("Scene", self.name, tuple(rows))

    def _more_beads_in_words(self) -> list[Row]:
        """Return rows on further beads, and on tethers."""
        rows = []
        for each in self.more_beads:
            made_of = f" of {each.material}" if each.material else ""
            rows.append(Row("bead", f"{each.size_in_words}{made_of}"))
        rows += [Row("tether", f"{each.model} of {' and '.join(each.between)}")
                 for each in self.tether]  # fmt: skip
        return rows

    def heat_in_words(self) -> str:
        """Return what the light heats, with the temperature rises if they were computed."""
        heats = {"medium": heats_medium(self), "bead": heats_bead(self)}
        heated = [name for name, on in heats.items() if on]
        if not heated:
            return "none"
        if self.heat is not None and (found := self.heat.found):
            rises = {"medium": found.water, "bead": found.bead}
            heated = [f"{name} by {rises[name]:.3g} K" for name in heated]
        return f"{' and '.join(heated)}; without convection, thermophoresis and thermal lens"

    def _planes_in_words(self, key: str) -> str:
        """Return the heights of walls, or of the mirror, and how they reflect light."""
        reflecting = [each for each in planes(self) if each.key == key]
        at = [each.position for each in reflecting]
        if key == "wall" and self.wall is not None:
            at = [position for position, _ in self.wall.planes]
        heights = " and ".join(printed(each, "um") for each in at)
        if not reflecting:
            return f"at {heights}"
        index = reflecting[0].refractive_index
        if index is None:
            return f"at {heights}, perfect"
        return f"at {heights}, reflects with index {index if index.imag else index.real:.5g}"

    def _changes_in_short(self) -> str:
        """Return the differences from the shipped scene of this name; "" without any."""
        if self.name not in shipped_scenes():
            return ""
        here = by_key(self.model_dump())
        there = by_key(validated(*read_scene(self.name)).model_dump())
        filled = {f"medium.{key}" for key in self.medium.filled}
        filled |= {f"bead.{key}" for key in self.bead.filled}
        keys = sorted((here.keys() | there.keys()) - filled)
        changed = [key for key in keys if here.get(key) != there.get(key)]
        told = []
        if ("beam.power" in here) != ("beam.power" in there):
            told.append(counted(self.beams))
            changed = [key for key in changed if not key.startswith("beam")]
        return "; ".join([*told, *(f"{key} = {in_short(here.get(key))}" for key in changed)])

    def __repr__(self) -> str:
        """Return the card as a few lines of text."""
        return as_text(self.card())

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """Return the card as HTML, for Jupyter."""
        return as_html(self.card())

    def with_one_beam(self, beam: Beam, offset: float = 0.0) -> Scene:
        """Return the scene with one beam alone, along +z through the origin, at rest and of
        constant power, without reflections.

        Parameters
        ----------
        beam : Beam
            The beam.
        offset : float, optional
            Largest distance of the beam's focus from the origin, m. The loss distance is increased
            by it, because the bead may be that much further from the focus.
        """
        at_rest = {
            "position": (0.0, 0.0, 0.0),
            "direction": "up",
            "motion": None,
            "modulation": None,
            "coherent": None,
            "phase": 0.0,
            "phasing": None,
        }
        update: dict[str, Any] = {
            "beam": beam.model_copy(update=at_rest), "more_beams": (), "mirror": None
        }  # fmt: skip
        if self.wall is not None and self.wall.reflects:
            dark = {"reflects": False, "refractive_index": None}
            update["wall"] = self.wall.model_copy(update=dark)
        if self.more_beams or offset:  # all beams use the same theory
            update["optics"] = self.optics.model_copy(update={"theory": self.theory})
        if offset:
            far = self.simulation.loss_distance + offset
            update["simulation"] = self.simulation.model_copy(update={"loss_distance": far})
        return self.model_copy(update=update)

    def alone(self, number: int) -> Scene:
        """Return the scene with one of its beads alone, without forces between beads.

        Parameters
        ----------
        number : int
            Number of the bead, from 1.

        Raises
        ------
        SceneError
            If there is no such bead.
        """
        if not 1 <= number <= len(self.beads):
            raise SceneError(f"number = {number}: the scene has {numbered(self.beads, 'bead')}")
        bead = self.beads[number - 1]
        if bead.start is None:  # the only bead
            return self
        update: dict[str, Any] = {
            "bead": bead.model_copy(update={"name": None, "start": None}),
            "more_beads": (),
            "tether": (),
            "forces": self.forces.model_copy(update={"between": None}),
            "start": self.start.model_copy(update={"position": bead.start}),
        }
        return self.model_copy(update=update)

    def of_power(self, power: float) -> Scene:
        """Return the scene with this power through the pupil of its only beam, W."""
        beam = self.beam.model_copy(update={"power": None, "power_through_pupil": power})
        return self.model_copy(update={"beam": beam})

    def heated(self, heating: Heating) -> Scene:
        """Return the scene with temperatures that its light causes.

        Properties of the medium that follow from its name change to the temperature about the
        bead. The keys of the scene stay as they are, also when it is saved.
        """
        assert self.heat is not None
        medium = medium_at(self, self.medium.temperature + heating.water)
        heat = self.heat.with_temperatures(heating)
        return self.model_copy(update={"medium": medium, "heat": heat})

    def __eq__(self, other: object) -> bool:
        """Return whether both scenes have equal keys, ignoring their history of changes."""
        return isinstance(other, Scene) and self._said() == other._said()

    def __hash__(self) -> int:
        return hash(self._said())

    def _said(self) -> tuple[Any, ...]:
        """Return the values of all keys except the history of changes, for comparison."""
        return tuple(getattr(self, key) for key in type(self).model_fields if key != "changed")

    @property
    def title(self) -> str:
        """Description of the scene; for a changed scene its name and the changes."""
        if not self.changed:
            return self.description or self.name
        changes = ", ".join(f"{key} = {value}" for key, value in self.changed.items())
        if (stale := self._of_another_temperature) and "medium.temperature" in self.changed:
            changes += f" ({stale} as before)"
        return f"{self.name}, changed: {changes}"

    @property
    def _of_another_temperature(self) -> str:
        """Names of properties of the medium that depend on the temperature but were not changed
        with it, as text.
        """
        if "medium.viscosity" in self.changed or "viscosity" in self.medium.filled:
            return ""
        keys = [
            key for key in ("viscosity", "density", "refractive_index")
            if f"medium.{key}" not in self.changed and key not in self.medium.filled
        ]  # fmt: skip
        *most, last = keys
        return f"{', '.join(most)} and {last}" if most else last

    def replace(self, **sections: Any) -> Scene:
        """Return a changed copy, which is validated again.

        The other keys of a section keep their values. A key removes its alternative (diameter
        removes radius), and a choice removes the keys that do not apply to it (profile = uniform
        removes sigma). The title of the copy names the changes, unless they include a new
        description.

        Parameters
        ----------
        **sections
            New values by section, such as `beam={"power": "80 mW"}`. With several beams,
            `beam=[...]` replaces all, and `**{"beam[2]": {...}}` changes the second.

        Returns
        -------
        Scene
            The changed scene.

        Raises
        ------
        SceneError
            If the changed scene is not valid.

        Warns
        -----
        PhysicsWarning
            If the temperature is changed without the viscosity, or a numerical aperture has no
            effect.

        Examples
        --------
        >>> scene = tweezer.load_scene("silica-1um").replace(bead={"diameter": "0.8 um"})
        >>> scene.bead.radius
        4e-07
        """
        replaced = self._replaced(sections)
        changed = self._changes(replaced, sections)
        copy = replaced.model_copy(update={"changed": changed})
        if copy.medium.temperature != self.medium.temperature and copy._of_another_temperature:
            warn(
                f"medium.temperature = {changed['medium.temperature']}: "
                f"{copy._of_another_temperature} are still those of "
                f"{self.medium.temperature:g} K; the viscosity of water decreases by 2 % per kelvin"
            )
        if copy.lens.numerical_aperture != self.lens.numerical_aperture:
            warn_of_unused_aperture(copy)
        return copy.model_copy(update={"changed": {}}) if "description" in sections else copy

    def _changes(self, replaced: Scene, sections: Mapping[str, Any]) -> dict[str, str]:
        """Return the changes after replacing `sections`: earlier ones that still apply and new
        ones.

        They are texts of values by dotted key.
        """
        before, after = by_key(self.model_dump()), by_key(replaced.model_dump())

        def differs(key: str) -> bool:
            """Return whether the value of a key, or of the stored key for it, has changed."""
            section, _, name = key.partition(".")
            other = HALVES.get((kind_of(section), name), name)
            field = key if key in after else f"{section}.{other}"
            return bool(before.get(field) != after.get(field))

        changed = {key: text for key, text in self.changed.items() if not differs(key)}
        for section, given in sections.items():
            if isinstance(getattr(replaced, kind_of(section)), Section) and not isinstance(
                given, list | tuple
            ):
                for key, value in dict(given).items():
                    if differs(f"{section}.{key}"):
                        changed[f"{section}.{key}"] = as_toml(value)
        for kind in SEVERAL:
            now = replaced.every(kind)
            if isinstance(sections.get(kind), list | tuple) and now != self.every(kind):
                changed[kind] = f"{len(now)} of them"
        return dict(sorted(changed.items()))

    def decided(self, **sections: Mapping[str, Any]) -> Scene:
        """Return a copy in which open choices, such as the model, are resolved.

        The copy counts as the same scene: the list of changes stays as it is.

        Parameters
        ----------
        **sections
            Values of the choices, by section.
        """
        copy = self._replaced(sections)
        if self.heat is not None and self.heat.found and _KEEPING_HEAT.issuperset(sections):
            copy = copy.heated(self.heat.found)
        return copy.model_copy(update={"changed": self.changed})

    def _replaced(self, sections: Mapping[str, Any]) -> Scene:
        """Return a validated copy with changed sections and the old list of changes."""
        data = self.model_dump(exclude_none=True)
        if self.more_beads:  # it follows from the first bead
            del data["start"]["position"]
        every: dict[str, list[Any]] = {}
        for kind, key in SEVERAL.items():
            if key in sections:
                raise SceneError(
                    f"{key}: {kind} = [...] replaces all {kind}s, and {kind}[2] changes the second"
                )
            every[kind] = [data[kind], *data.pop(key)]
            if len(every[kind]) > 1:
                data[kind] = every[kind]
        try:
            read = with_tables(sections, Path())
        except ValueError as error:
            raise SceneError(str(error)) from None
        for section, changes in read.items():
            kind = kind_of(section)
            there = every.get(kind, [])
            if section == kind and len(there) > 1 and not isinstance(changes, list | tuple):
                key = (
                    ".".join([kind, *map(str, changes)][:2])
                    if isinstance(changes, Mapping)
                    else kind
                )
                raise SceneError(
                    f"{key}: does not name a {kind}; the scene has {numbered(there, kind)}"
                )
            if found := NUMBERED.fullmatch(section):
                at = int(found[2]) - 1
                if len(there) == 1 or not 0 <= at < len(there):
                    raise SceneError(f"{section}: the scene has {numbered(there, kind)}")
                if kind in sections:
                    raise SceneError(
                        f"{section}: cannot be combined with {kind}, which gives all {kind}s"
                    )
                there[at] = changed_section(there[at], kind, changes)
                data[kind] = there
            else:
                data[section] = changed_section(data.get(section), section, changes)
        return validated(data, sections)


def validated(data: dict[str, Any], given: Mapping[str, Any]) -> Scene:
    """Return the scene of `data`; warn of numbers without unit in the part `given` by a user."""
    try:
        scene = Scene.model_validate(data)
    except ValidationError as error:
        several = [
            kind for kind, key in SEVERAL.items()
            if isinstance(data.get(kind), list | tuple) or data.get(key)
        ]  # fmt: skip
        lines = (" ".join(line.splitlines()) for line in lines_of(error, Scene, several))
        shown = list(itertools.islice(lines, _MOST_LINES))
        if (more := error.error_count() - len(shown)) > 0 and len(shown) == _MOST_LINES:
            shown.append(f"and {more} more")
        raise SceneError("\n".join(shown)) from None
    knudsen = scene.medium.mean_free_path / (2 * scene.body.size)
    known = scene.medium.name in GASES and scene.bead.shape == "sphere" and scene.wall is None
    if knudsen > KNUDSEN_LIMIT and not known:
        warn(
            f"Knudsen number {knudsen:.2g} is above {KNUDSEN_LIMIT:g}: the medium is not a "
            "continuum for this bead, and Stokes's drag (2.13) is too large"
        )
    for doubt in doubts_of(given, Scene):
        warn(doubt, UnitWarning)
    return scene
