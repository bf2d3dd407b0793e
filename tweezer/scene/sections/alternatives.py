"""Keys with alternatives, keys that depend on a choice, and keys that the scene fills in."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

from pydantic import (
    ModelWrapValidatorHandler,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from tweezer.scene.choices import SHAPES
from tweezer.scene.courses import Section, refusal
from tweezer.scene.media import GASES, parted_by
from tweezer.values.units import to_si

#: Pairs of keys for the same property, of which exactly one must be given
ALTERNATIVES: dict[str, tuple[tuple[str, str], ...]] = {
    "bead": (("radius", "diameter"),),
    "bead.layers": (("radius", "diameter"),),
    "bead.spheres": (("radius", "diameter"),),
    "beam": (("power", "power_through_pupil"), ("sigma", "waist")),
}
#: Shapes that accept each key that not all accept
ACCEPTING: dict[str, tuple[str, ...]] = {
    key: tuple(each.name for each in SHAPES.values() if key in each.needs + each.may)
    for key in dict.fromkeys(key for each in SHAPES.values() for key in each.needs + each.may)
}
#: Keys that belong to some choices of another key, and are refused with other choices
BELONGING: dict[str, dict[str, tuple[str, tuple[str, ...]]]] = {
    "bead": {
        **{key: ("shape", names) for key, names in ACCEPTING.items()},
        "radius": ("shape", tuple(each.name for each in SHAPES.values() if each.sized)),
        **dict.fromkeys(
            ("density", "material"),
            ("shape", tuple(each.name for each in SHAPES.values() if "given" not in each.needs)),
        ),
        "refractive_index": (
            "shape",
            tuple(each.name for each in SHAPES.values() if each.index is not False),
        ),
    },
    "beam": {
        "sigma": ("profile", ("gaussian", "donut")),
        "profile_radius": ("profile", ("table",)),
        "profile_intensity": ("profile", ("table",)),
        "jones": ("polarisation", ("linear",)),
        "order": ("polarisation", ("cylindrical",)),
    },
    "medium": {
        **{key: ("name", parted_by(key)) for key in ("fraction", "molality", "pressure")},
        "accommodation": ("name", GASES),
    },
    "start": {"ball_radius": ("drawn", ("ball",))},
}
#: Keys of a homogeneous bead, which are refused in addition to `layers`
WITHIN_LAYERS = ("radius", "diameter", "refractive_index", "material")
#: Key that names the material of a section, and the keys that follow from the name
NAMED: dict[str, tuple[str, tuple[str, ...]]] = {
    "bead": ("material", ("refractive_index", "density")),
    "medium": ("name", ("refractive_index", "density", "viscosity", "mean_free_path")),
}
#: Key under which a section lists the keys that the scene has filled in
FILLED = "filled in"


class Filled(Section):
    """Base of a section with keys whose values the scene may fill in, for example from a material.

    Values that were filled in are omitted when the section is written.
    """

    _filled: frozenset[str] = PrivateAttr(frozenset())

    @property
    def filled(self) -> frozenset[str]:
        """Keys whose values the scene has filled in."""
        return self._filled

    @model_validator(mode="wrap")
    @classmethod
    def _some_filled_in(cls, data: Any, validated: ModelWrapValidatorHandler[Self]) -> Self:
        """Validate the section and record its filled-in keys, which `data` lists under `FILLED`."""
        if not isinstance(data, dict) or FILLED not in data:
            return validated(data)
        section = validated({key: value for key, value in data.items() if key != FILLED})
        section._filled = frozenset(data[FILLED])
        return section

    @model_serializer(mode="wrap")
    def _as_given(self, as_dict: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Return the section as a mapping, without the values that the scene has filled in."""
        said: dict[str, Any] = as_dict(self)
        return {key: value for key, value in said.items() if key not in self._unsaid()}

    def _unsaid(self) -> frozenset[str]:
        """Return the keys that are omitted when the section is written."""
        return self._filled


def with_half(data: Any, key: str, other: str, low: float, high: float) -> Any:
    """Return the data of a section with `key` set to half of `other`, if `other` is given.

    For example, a diameter is replaced by the radius. Exactly one of the two keys must be given.

    Parameters
    ----------
    data : mapping
        Keys and values of the section.
    key : str
        Key to set, such as "radius".
    other : str
        Its alternative, such as "diameter".
    low, high : float
        Allowed range of `key`.
    """
    if not isinstance(data, dict):
        return data
    exactly_one(data, key, other)
    if other not in data:
        return data
    data = dict(data)
    value = data.pop(other)
    try:
        half = to_si(value, "m", 2 * low, 2 * high) / 2
    except ValueError as error:
        raise refusal(f"{other} = {value!r}: {error}") from None
    return {**data, key: half}


def exactly_one(data: Mapping[str, Any], key: str, other: str) -> None:
    """Raise a refusal unless exactly one of the keys `key` and `other` is given."""
    given = [name for name in (key, other) if data.get(name) is not None]
    if len(given) != 1:
        both = "give only one" if given else "one is required"
        raise refusal(f"{key} or {other}: {both}")
