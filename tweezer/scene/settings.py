"""Single keys of a scene: their values, their descriptions, and setting them from text."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any, Literal, get_args, get_origin

from tweezer.scene.files import NOT_TOML
from tweezer.scene.keys import (
    HALVES,
    NUMBERED,
    SEVERAL,
    familiar,
    kind_of,
    nearest_key,
    section_of,
)
from tweezer.scene.scene import Scene
from tweezer.scene.sections import ALTERNATIVES
from tweezer.values.errors import SceneError
from tweezer.values.units import Quantity, quantity_of


def with_settings(scene: Scene, settings: Mapping[str, str]) -> Scene:
    """Return `scene` with dotted keys set to text values, as given on a command line.

    A key is `section.key`, `beam[2].key` for several beams or beads, or `beam.motion.key`.
    Alternative words such as lens.NA are accepted (`FAMILIAR`). A value is parsed as TOML if
    possible ("1e-4", "[0, 0, 1e-6]") and is text otherwise ("80 mW"); "True" and "False" are
    accepted as in Python.
    Raises `SceneError` for an unknown key or invalid value.
    """
    sections: dict[str, Any] = {}
    for key, text in settings.items():
        section, dot, name = key.partition(".")
        section = section.replace("-", "_")
        if not dot:
            alike = [each for each in settable() if each.rpartition(".")[2] == key]
            fewest = min((each.count(".") for each in alike), default=0)
            alike = [each for each in alike if each.count(".") == fewest]
            meant = f"; did you mean {' or '.join(alike)}?" if alike else ", such as beam.power"
            raise SceneError(f"{key!r}: must be section.key{meant}")
        within = sections.setdefault(section, {})
        outer, dot, inner = name.partition(".")
        of = getattr(
            getattr(Scene.model_fields.get(kind_of(section)), "annotation", None),
            "model_fields",
            {},
        )
        if dot and outer in of and section_of(of[outer].annotation):  # as in beam.motion.velocity
            within, name = within.setdefault(outer, {}), inner
            if not isinstance(within, dict):
                raise SceneError(f"{section}.{outer}: given both as a whole and by its keys")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except NOT_TOML:
            value = {"True": True, "False": False}.get(text, text)
        if not dot and name not in of:
            name = familiar(section, name)
        if name in within:
            raise SceneError(f"{key}: {section}.{name} is set twice")
        within[name] = value
    return scene.replace(**sections)


def described_at(key: str) -> tuple[Quantity | None, str]:
    """Return the quantity of a dotted key of a scene, or None, and the description of the key.

    Keys have the form described at `with_settings`. Raises `SceneError` for an unknown key.
    """
    first, *parts = key.split(".")
    within = kind_of(first)
    field = Scene.model_fields.get(within)
    for part in parts:
        section = section_of(field.annotation) if field else None
        name = HALVES.get((within, part), part)
        fields = section.model_fields if section else {}
        if name not in fields:
            near = nearest_key(within, part, fields)
            meant = ".".join([first, *parts[: parts.index(part)], *near])
            raise SceneError(f"{key}: unknown key{f'; did you mean {meant}?' if near else ''}")
        within, field = f"{within}.{name}", fields[name]
    if not parts or field is None or section_of(field.annotation):
        raise SceneError(f"{key}: must be section.key, such as beam.power")
    return quantity_of(*field.metadata, field.annotation), field.description or key


def settable() -> dict[str, tuple[str, ...]]:
    """Return the dotted keys that `with_settings` accepts, with their choices, for one beam.

    Choices are names, or "true" and "false".
    """
    found: dict[str, tuple[str, ...]] = {}
    for name, field in Scene.model_fields.items():
        if (section := section_of(field.annotation)) and name not in SEVERAL.values():
            found |= _settable(name, section)
    return found


def _settable(within: str, section: Any) -> dict[str, tuple[str, ...]]:
    """Return the dotted keys of a section and its subsections, with their choices.

    `within` is the dotted name of the section, and `section` its class.
    """
    found: dict[str, tuple[str, ...]] = {}
    for name, field in section.model_fields.items():
        inner = section_of(field.annotation)
        if inner and inner in get_args(field.annotation):  # a single section, not a list of them
            found |= _settable(f"{within}.{name}", inner)
        else:
            found[f"{within}.{name}"] = _choices(field.annotation)
    others = (key for pair in ALTERNATIVES.get(within, ()) for key in pair)
    return found | {f"{within}.{key}": () for key in others if f"{within}.{key}" not in found}


def _choices(annotation: Any) -> tuple[str, ...]:
    """Return the names that the type of a key allows; empty if it allows other values."""
    if annotation is bool:
        return "true", "false"
    if get_origin(annotation) is Literal:
        return tuple(map(str, get_args(annotation)))
    return next(filter(None, map(_choices, get_args(annotation))), ())


def value_at(scene: Scene, key: str) -> Any:
    """Return the value of a dotted key of `scene` (see `with_settings`); None if it is not set.

    Raises `SceneError` for an unknown key.
    """
    described_at(key)
    first, *parts = key.split(".")
    numbered = NUMBERED.fullmatch(first)
    within, value = kind_of(first), getattr(scene, kind_of(first))
    if numbered and (number := int(numbered[2])) != 1:
        every = scene.every(within)
        value = every[number - 1] if number <= len(every) else None
    for part in parts:
        # a diameter is stored as a radius, and a waist as a sigma: twice the stored value
        name = HALVES.get((within, part), part)
        doubled = name != part and not hasattr(value, part)
        value = getattr(value, name if doubled else part, None)
        if doubled and value is not None:
            value *= 2
        within = f"{within}.{name}"
    return value
