"""Names of the keys of a scene: kinds of sections, alternative words, and changes to a section."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from typing import Any, get_args

from tweezer.scene.courses import Section
from tweezer.scene.sections import ALTERNATIVES, BELONGING, NAMED, WITHIN_LAYERS

#: Stored key for the alternative in a scene file, such as ("bead", "diameter") -> "radius" and
#: ("beam", "waist") -> "sigma"; stored lengths are half of the alternative
HALVES = {(section, other): key for section, pairs in ALTERNATIVES.items() for key, other in pairs}
#: Sections of which a scene may have several, and the key with all but the first
SEVERAL = {"beam": "more_beams", "bead": "more_beads"}
#: Pattern of one of several beams or beads, counted from 1
NUMBERED = re.compile(r"(beam|bead)\[([1-9][0-9]*)\]")
#: Alternative words for keys of a scene, by section
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
    """Return the key of a section that a word such as NA denotes, or the word itself."""
    words = {word.lower(): key for word, key in FAMILIAR.get(kind_of(section), {}).items()}
    return words.get(name.lower(), name)


def nearest_key(section: str, name: str, keys: Iterable[str]) -> list[str]:
    """Return a list with the key that an unknown `name` probably means, or an empty list.

    `section` is the kind of section. `keys` are the stored keys; alternatives to them are
    considered too.
    """
    if (key := familiar(section, name)) != name:
        return [key]
    halves = [key for pair in ALTERNATIVES.get(section, ()) for key in pair]
    return difflib.get_close_matches(name, [*keys, *halves], n=1)


def section_of(annotation: Any) -> Any:
    """Return the class of section in a type such as `Motion | None` or `tuple[Beam, ...]`.

    Returns None for the type of a plain value.
    """
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return annotation
    return next(filter(None, map(section_of, get_args(annotation))), None)


def kind_of(section: str) -> str:
    """Return the kind of a section from its name: "beam" for "beam[2]", otherwise the name."""
    found = NUMBERED.fullmatch(section)
    return found[1] if found else section


def by_key(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a scene by `section.key`; those of several beams by `beam[1].key`.

    `scene` has its sections as mappings by name, as in TOML or JSON.
    """
    sections = dict(scene.items())
    for kind, key in SEVERAL.items():
        if more := sections.pop(key, ()):
            every = sections.pop(kind), *more
            sections |= {f"{kind}[{i}]": each for i, each in enumerate(every, start=1)}
    return {
        f"{section}.{key}": value
        for section, values in sections.items()
        if isinstance(values, dict) and section != "changed"
        for key, value in values.items()
    }


def changed_section(before: Any, section: str, changes: Any) -> Any:
    """Return a section of a scene with changes, without the keys that the changes displace.

    `before` and `changes` are mappings of keys to values. If one of them is not, for example a list
    of beams, the changes replace the section.
    """
    if not isinstance(changes, Mapping) or not isinstance(before, dict):
        return changes
    kept = {key: value for key, value in before.items() if not _displaced(key, section, changes)}
    return kept | {key: _within(kept.get(key), value) for key, value in changes.items()}


def _within(before: Any, change: Any) -> Any:
    """Return a nested section with changes to its keys, or `change` in its place.

    It is replaced if the change names a kind, such as another kind of motion, or is not a mapping.
    """
    if isinstance(change, Mapping) and isinstance(before, dict) and "kind" not in change:
        return {**before, **change}
    return change


def _displaced(key: str, section: str, changes: Mapping[str, Any]) -> bool:
    """Return whether `changes` to a section displace its existing `key`.

    A new diameter displaces the radius, and a new material displaces the old index and density.
    Layers displace the keys of a homogeneous bead. A new choice displaces the keys that belong to
    other choices.
    """
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
