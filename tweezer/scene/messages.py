"""Messages on invalid values of a scene, one line each, and on numbers without a unit."""

from __future__ import annotations

import itertools
from collections.abc import Container, Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from tweezer.scene.courses import Section
from tweezer.scene.keys import HALVES, NUMBERED, SEVERAL, kind_of, nearest_key, section_of
from tweezer.scene.sections import ALTERNATIVES, NAMED
from tweezer.values.units import as_given, quantity_of

#: Words and numbers that users may write for true and false, which scene files do not accept
_SWITCHES = {
    **dict.fromkeys(("true", "yes", "on", "1"), "true"),
    **dict.fromkeys(("false", "no", "off", "0"), "false"),
}


#: Sections by the key with all but the first
_KINDS = {key: kind for kind, key in SEVERAL.items()}


def lines_of(
    error: ValidationError, scene: type[Section], several: Container[str]
) -> Iterator[str]:
    """Yield one line per invalid value, in the order of the scene.

    `scene` is the class of scenes, and `several` contains the sections of which the scene has more
    than one, such as "beam".
    """
    errors = error.errors(include_url=False)
    wrong = {details["loc"] for details in errors}
    for details in errors:
        where = details["loc"]
        section = _KINDS.get(str(where[0]), str(where[0])) if where else ""
        name, filled = NAMED.get(section, ("", ()))
        if details["type"] == "missing" and (*where[:-1], name) in wrong and where[-1] in filled:
            continue  # a valid name would fill in this key
        kind = _KINDS.get(str(where[0])) if where else None
        if where and where[0] in several:
            where = (f"{where[0]}[1]", *where[1:])
        elif where[:1] == ("tether",) and len(where) > 1:
            where = (f"tether[{int(where[1]) + 1}]", *where[2:])
        elif kind and len(where) > 1:  # numbered as in the file: [[beam]]
            where = (f"{kind}[{int(where[1]) + 2}]", *where[2:])
        key = ".".join(str(part) for part in where)
        named = _clipped(key)
        if details["type"] == "scene":
            yield f"{key}.{details['msg']}" if key else details["msg"]
        elif details["type"] == "missing":
            yield f"{named}: missing"
        elif details["type"] == "extra_forbidden":
            known = _known_keys(details, scene)
            yield f"{named} = {in_short(details['input'])}: unknown key; {known}"
        else:
            yield f"{named} = {in_short(details['input'])}: {_allowed(details, key)}"


def _allowed(details: ErrorDetails, key: str) -> str:
    """Return the allowed values for an invalid one, from Pydantic's report; `key`: dotted name."""
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
            found = NUMBERED.fullmatch(key)
            name = f"[{found[1]}]" if found else details["loc"][-1]
            return f"must be a section [{name}]"
        case "string_type":
            return "must be text"
        case "string_pattern_mismatch":
            return "must begin with a letter or digit, and have no /, \\ and at most 100 characters"
        case _:
            return details["msg"]


def _known_keys(details: ErrorDetails, scene: type[Section]) -> str:
    """Return the key that an unknown one probably means, or all keys of its section, as a phrase.

    `details` is Pydantic's report, and `scene` the class of scenes.
    """
    section: Any = scene
    for part in details["loc"][:-1]:
        if not isinstance(part, int):  # the number of a beam
            section = section_of(section.model_fields[str(part)].annotation)
    keys = [key for key in section.model_fields if key != "changed"]
    names = [str(part) for part in details["loc"][:-1] if not isinstance(part, int)]
    if names:
        names[0] = _KINDS.get(names[0], names[0])
    for pair in ALTERNATIVES.get(".".join(names), ()):
        keys += [key for key in pair if key not in keys]
    if "times" in keys:
        keys.append("file")
    near = nearest_key(".".join(names), str(details["loc"][-1]), keys)
    return f"did you mean {near[0]}?" if near else f"allowed: {', '.join(keys)}"


def doubts_of(given: Mapping[str, Any], section: type[Section], within: str = "") -> Iterator[str]:
    """Yield a warning for each key with a number without unit that is unusual in SI units.

    Such a number, for example a wavelength of 1064 (m), probably lacks its unit. `given` has values
    of a section by key, or sections of a scene by name. `section` is the class of that section, or
    the class of scenes. `within` is the dotted name of the section with a final dot, such as
    "beam.motion."; it is "" for a scene.
    """
    fields = section.model_fields
    for key, value in given.items():
        # a diameter is judged by the annotation of the radius, which replaces it in the class
        kind = HALVES.get((kind_of(within.removesuffix(".")), key), kind_of(key))
        if kind not in fields:  # for example the file of a table
            continue
        annotation, metadata = fields[kind].annotation, fields[kind].metadata
        if inner := section_of(annotation):
            for name, part in _each(key, value):
                if isinstance(part, Mapping):
                    yield from doubts_of(part, inner, f"{within}{name}.")
        elif quantity := quantity_of(*metadata, annotation):
            doubts = ((number, quantity.doubt(number)) for number in _numbers(value))
            unusual = (f"{within}{key} = {number} {doubt}" for number, doubt in doubts if doubt)
            yield from itertools.islice(unusual, 1)


def _each(section: str, value: Any) -> list[tuple[str, Any]]:
    """Return name and value of a section, or of each section in a list.

    Sections of a list are numbered: beam[1], or beam[2] for the first of `more_beams`.
    """
    if isinstance(value, list | tuple):
        name, first = (_KINDS[section], 2) if section in _KINDS else (section, 1)
        return [(f"{name}[{i}]", each) for i, each in enumerate(value, start=first)]
    return [(section, value)]


def _numbers(value: Any) -> Iterator[Any]:
    """Yield the numbers in a value: the value itself, or each element of nested lists."""
    if isinstance(value, list | tuple):
        for each in value:
            yield from _numbers(each)
    else:
        yield value


def either(names: Sequence[str]) -> str:
    """Return names as a choice, such as "a, b or c"."""
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def as_toml(value: Any) -> str:
    """Return a value as a scene file contains it, cut at 60 characters."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return _clipped(f"{{{', '.join(f'{key} = {as_toml(of)}' for key, of in value.items())}}}")
    if isinstance(value, list | tuple):
        return _clipped(f"[{', '.join(map(as_toml, value))}]")
    return f"{value:g}" if isinstance(value, float) else _clipped(as_given(value))


def in_short(value: Any) -> str:
    """Return `repr` of a value, cut at 60 characters."""
    try:
        return _clipped(repr(value))
    except RecursionError:
        return f"a {type(value).__name__} too deep to show"


def _clipped(text: str) -> str:
    """Return a text, cut at 60 characters."""
    return text if len(text) <= 60 else text[:57] + "..."


def counted(every: Sequence[Any], kind: str = "beam") -> str:
    """Return the number of beams, or of sections of another kind, in words."""
    return f"one {kind}" if len(every) == 1 else f"{len(every)} {kind}s"


def numbered(every: Sequence[Any], kind: str = "beam") -> str:
    """Return the number of beams, or of sections of another kind, and their names."""
    names = kind if len(every) == 1 else f"{kind}[1] to {kind}[{len(every)}]"
    return f"{counted(every, kind)}, {names}"
