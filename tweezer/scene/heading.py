"""Titles of pages and figures: the name of a scene and its changes, in words."""

from __future__ import annotations

import json
import re

import numpy as np

from tweezer.scene.scene import Scene
from tweezer.scene.settings import described_at
from tweezer.values.errors import SceneError
from tweezer.values.prefixes import usual_unit

#: Number of changes that a heading lists
_NAMED = 3
#: Sections whose keys are clear without the name of the section
_CLEAR_ALONE = ("beam", "forces", "optics", "simulation")
#: Sections that concern the computation, not the experiment; a heading lists them last
_OF_COMPUTING = ("optics", "simulation")
#: Pattern of the hyphen before a negative number, which becomes a minus sign
_MINUS = r"(?<![\w.])-(?=[\d.])"
#: Pattern of a number and a unit without a space between them
_NUMBER_AT_UNIT = r"^([-+]?[\d.]+(?:[eE][-+]?\d+)?)([^\W\d](?![-+]?\d).*)$"
#: Names of keys in text, where they differ from the key
_IN_PRINT = {
    "forces.brownian": "thermal motion", "forces.optical": "light", "forces.dlvo": "DLVO forces",
    "bead.diameter": "bead diameter", "medium.temperature": "temperature",
    "medium.viscosity": "viscosity",
}  # fmt: skip


def heading(scene: Scene, title: str) -> str:
    """Return the title of a page: the scene's own, or its name with up to three of its changes.

    `title` is the title stored in the result. It is returned unchanged if it is not the scene's
    own, or if the scene is unchanged.
    """
    if not scene.changed or title != scene.title:
        return title
    changes = sorted(scene.changed.items(), key=lambda item: _section(item[0]) in _OF_COMPUTING)
    told = [_change(key, text) for key, text in changes[:_NAMED]]
    if (more := len(changes) - _NAMED) > 0:
        told.append(f"{more} more change{'s' * (more > 1)}")
    *most, last = told
    return f"{scene.name} with {', '.join(most) + ' and ' if most else ''}{last}"


def of_changes(scene: Scene) -> list[str]:
    """Return a list with a note of all changes to the scene as loaded; empty without changes."""
    return [f"The scene is {scene.title}."] if scene.changed else []


def changes(scene: Scene) -> str:
    """Return every change to a scene in words, such as "bead diameter 0.8 um"; "" without one."""
    told = ", ".join(_change(key, text) for key, text in scene.changed.items())
    stale = re.search(r" \([^()]* as before\)$", scene.title)
    return told + (stale[0] if told and stale else "")


def named(key: str) -> str:
    """Return a dotted key of a scene in words, such as "bead diameter" for bead.diameter."""
    if key in _IN_PRINT:
        return _IN_PRINT[key]
    first, *parts = key.split(".")
    shown = (
        parts if parts and _section(key) in _CLEAR_ALONE and "[" not in first else [first, *parts]
    )
    return " ".join(shown).replace("_", " ").replace("[", " ").replace("]", "")


def _change(key: str, text: str) -> str:
    """Return a change in words, such as "bead diameter 0.8 um".

    `key` is the dotted key and `text` the value as it was given; a number without a unit gets one.
    """
    if key == "beam":  # all beams were replaced: "2 of them"
        return text.replace("of them", "beams")
    if text in ("true", "false"):
        return named(key) if text == "true" else f"no {named(key)}"
    value = re.sub(_MINUS, "\N{MINUS SIGN}", _with_unit(key, text))
    return f"{named(key)} {value}"


def _with_unit(key: str, text: str) -> str:
    """Return the value of a key with a unit, such as "0.8 um" for "8e-7" of bead.diameter."""
    try:
        given = json.loads(text)
        sizes = np.array(given, dtype=float)
        quantity, _ = described_at(key)
    except (ValueError, TypeError, SceneError):
        return re.sub(_NUMBER_AT_UNIT, r"\1 \2", text)
    if quantity is None or not quantity.unit:
        return text
    factor, unit = usual_unit(float(np.abs(sizes).max(initial=0.0)), quantity.unit)
    numbers = [f"{size:.6g}" for size in sizes.ravel() / factor]
    return f"({', '.join(numbers)}) {unit}" if sizes.ndim else f"{numbers[0]} {unit}"


def _section(key: str) -> str:
    """Return the section of a dotted key without its index, such as "beam" for beam[2].power."""
    return key.partition(".")[0].partition("[")[0]
