"""Variation of a scene's keys in a sweep, on a grid or case by case."""

from __future__ import annotations

import itertools
import math
import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tweezer.scene import described_at
from tweezer.sweeps.tables import columns_of
from tweezer.values.errors import SceneError, UnitWarning, warn
from tweezer.values.units import Quantity, listed, to_si

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd
    import xarray as xr

#: Value of a key in SI units, as the result contains it
Value = float | int | bool | str

#: Largest number of cases
_MOST = 10**6
#: Name of the dimension of a table of cases
CASE = "case"
#: Keys of a beam that change the light only by a factor
_POWERS = ("power", "power_through_pupil")

_RANGE = re.compile(r"(?P<low>.+?)\.\.(?P<high>[^:]+):(?P<count>[0-9]+)(?::(?P<spacing>log))?")


class Varied(NamedTuple):
    """A key of a scene that a sweep varies, with its values."""

    key: str
    """section and name, as in `bead.diameter`"""
    values: tuple[Value, ...]
    """numbers in SI units, or texts"""
    unit: str
    """SI unit of the values; "" for a key that is not a quantity with a unit"""
    about: str
    """description of the key"""


class Axis(NamedTuple):
    """A dimension of the result: one key, or the keys of a table, which vary together."""

    name: str
    """name of the dimension: the key, or "case" for a table"""
    varied: tuple[Varied, ...]
    """the keys along this dimension, with equal numbers of values"""

    @property
    def size(self) -> int:
        """Number of values of each key."""
        return len(self.varied[0].values)


@dataclass(frozen=True)
class Cases:
    """The cases of a sweep: every combination of the entries of its axes."""

    axes: tuple[Axis, ...]
    """dimensions of the result"""

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of entries along each axis."""
        return tuple(axis.size for axis in self.axes)

    @property
    def count(self) -> int:
        """Number of cases."""
        return math.prod(self.shape)

    def settings(self, index: int) -> dict[str, str]:
        """Return the keys and values of a case, as arguments for `tweezer.scene.with_settings`.

        `index` is the index of the case among all combinations.
        """
        places = np.unravel_index(index, self.shape)
        return {
            each.key: _as_setting(each.values[place])
            for axis, place in zip(self.axes, places, strict=True)
            for each in axis.varied
        }

    def by_light(self) -> list[list[int]]:
        """Return the indices of the cases, in groups that differ only in the power of the light."""
        numbers = np.arange(self.count).reshape(self.shape)
        powers = [
            i for i, axis in enumerate(self.axes) if all(map(_is_a_power, axis.varied))
        ]  # fmt: skip
        last = range(len(self.axes) - len(powers), len(self.axes))
        moved = np.moveaxis(numbers, powers, last)
        size = math.prod(self.axes[i].size for i in powers)
        groups: list[list[int]] = moved.reshape(-1, size).tolist()
        return groups

    def describe(self) -> dict[str, dict[str, list[Value]]]:
        """Return the values by dimension and key."""
        return {
            axis.name: {each.key: list(each.values) for each in axis.varied} for axis in self.axes
        }


def _is_a_power(each: Varied) -> bool:
    """Return whether a key is the power of a beam, to which the force is proportional."""
    section, _, key = each.key.partition(".")
    return section.startswith("beam") and key in _POWERS


def _as_setting(value: Value) -> str:
    """Return a value as text that `tweezer.scene.with_settings` converts back to the same value."""
    return value if isinstance(value, str) else repr(value)


def cases_of(
    over: Mapping[str, Any] | pd.DataFrame | xr.Dataset | None,
    table: str | Path | Mapping[str, Any] | pd.DataFrame | xr.Dataset | None,
) -> Cases:
    """Return the cases of a sweep: every combination of keys in `over` and rows of `table`.

    `over` contains keys with their values, and `table` has keys that vary together, row by row.
    Raises `SceneError` for unknown keys and invalid values.
    """
    if hasattr(over, "columns") or hasattr(over, "data_vars"):
        if table is not None:
            raise SceneError("over: a table cannot be combined with cases; omit one of them")
        over, table = None, over
    if over is not None and not isinstance(over, Mapping):
        raise SceneError("over: must be a mapping of keys to lists of values, or a table")
    axes = [Axis(str(key), (_apart(_varied(key, given)),)) for key, given in (over or {}).items()]
    if table is not None:
        varied = tuple(_varied(key, given) for key, given in columns_of(table))
        if not varied or len({len(each.values) for each in varied}) != 1:
            raise SceneError("cases: must have a column for each key, all of the same length")
        axes.insert(0, Axis(CASE, varied))
    if not axes:
        raise SceneError("over: nothing to sweep over; name a key with its values, or cases")
    keys = [each.key for axis in axes for each in axis.varied]
    for key, count in Counter(keys).items():
        if count > 1:
            raise SceneError(f"{key}: is swept over twice")
    cases = Cases(tuple(axes))
    if cases.count > _MOST:
        raise SceneError(f"{cases.count} cases: must be at most {_MOST}")
    return cases


def read_over(texts: Iterable[str]) -> dict[str, list[Any]]:
    """Return keys and their values from texts such as "KEY=FROM..TO:COUNT" or "KEY=a,b,c".

    A range includes both ends. With ":log" at the end, neighbouring values have equal ratios.
    Raises `SceneError` for other texts.
    """
    over: dict[str, list[Any]] = {}
    for text in texts:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not equals or not values:
            raise SceneError(
                f"over {text!r}: must be KEY=FROM..TO:COUNT, KEY=FROM..TO:COUNT:log or KEY=a,b,c"
            )
        if key in over:
            raise SceneError(f"{key}: is swept over twice")
        over[key] = _range(key, values) if ".." in values else _split(values)
    return over


def _range(key: str, text: str) -> list[Any]:
    """Return the values of a range "FROM..TO:COUNT" or "FROM..TO:COUNT:log" of a key.

    If the ends have a unit, values are texts with the key's unit. Raises `SceneError` for other
    texts.
    """
    match = _RANGE.fullmatch(text)
    if len(_split(text)) > 1:
        raise SceneError(f"over {key} = {text}: must be a list or a range, not both")
    if not match:
        raise SceneError(
            f"over {key} = {text}: must be FROM..TO:COUNT, such as 0.2um..3um:40, with :log at the "
            "end for equal ratios"
        )
    quantity, _ = described_at(key)
    ends = [match[end].strip() for end in ("low", "high")]
    low, high = (_number(key, end, quantity) for end in ends)
    in_units = quantity is not None and quantity.unit != ""
    bare = [_bare(end) for end in ends]
    if in_units and bare[0] != bare[1]:
        raise SceneError(f"over {key} = {text}: give both ends a unit")
    count = int(match["count"])
    if not 2 <= count <= _MOST:
        raise SceneError(f"over {key} = {text}: COUNT must be from 2 to {_MOST}")
    if match["spacing"] and (low <= 0 or high <= 0):
        raise SceneError(f"over {key} = {text}: both ends must be above 0 for :log")
    spaced = np.geomspace if match["spacing"] else np.linspace
    values = spaced(low, high, count).tolist()
    if quantity is None or not in_units or bare[0]:
        return list(values)
    return [f"{value!r} {quantity.unit}" for value in values]


def _bare(text: str) -> bool:
    """Return whether a text is a number without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _number(key: str, text: str, quantity: Quantity | None) -> float:
    """Return one end of a range in SI units; `quantity` describes the key, None without a unit.

    Raises `SceneError` if it is not a number.
    """
    try:
        value = _in_si(text, quantity)
    except ValueError as error:
        raise SceneError(f"over {key} = {text!r}: {error}") from None
    if isinstance(value, bool | str):
        raise SceneError(f"over {key} = {text!r}: an end of a range must be a number")
    return float(value)


def _split(text: str) -> list[str]:
    """Split a list at its commas, except those within brackets, which belong to a value."""
    values, depth = [""], 0
    for letter in text:
        depth += (letter in "[{") - (letter in "]}")
        if letter == "," and depth == 0:
            values.append("")
        else:
            values[-1] += letter
    return [value.strip() for value in values]


def _varied(key: Any, given: Any) -> Varied:
    """Return a key with its values in SI units; raises `SceneError` for invalid values.

    Values of different types become texts, because an array has one type.
    """
    quantity, about = described_at(str(key))
    given = listed(given)
    single = isinstance(given, str) or getattr(given, "ndim", 1) == 0
    if single or not isinstance(given, Iterable):
        raise SceneError(f"over {key} = {given!r}: must be a list of values")
    values = []
    for each in given:
        plain = each.item() if isinstance(each, np.generic) else each
        try:
            values.append(_in_si(plain, quantity))
        except ValueError as error:
            raise SceneError(f"over {key} = {plain!r}: {error}") from None
    if not values:
        raise SceneError(f"over {key}: has no values")
    kinds = {str if isinstance(value, str) else type(value) for value in values}
    if len(kinds) > 1 and kinds != {int, float}:
        values = [_as_setting(value) for value in values]
    elif float in kinds:
        values = [float(value) for value in values]
    if quantity is not None:
        doubts = (quantity.doubt(value) for value in given)
        for doubt in itertools.islice(filter(None, doubts), 1):
            warn(f"over {key}: {doubt}", UnitWarning)
    unit = quantity.unit if quantity and not isinstance(values[0], str) else ""
    return Varied(str(key), tuple(values), unit, about)


def _apart(varied: Varied) -> Varied:
    """Return a key and its values unchanged; raises `SceneError` if a value occurs twice."""
    seen: set[Value] = set()
    for value in varied.values:
        if value in seen:
            raise SceneError(f"over {varied.key} = {value}: is given twice")
        seen.add(value)
    return varied


def _in_si(given: Any, quantity: Quantity | None) -> Value:
    """Return a value in SI units, as the result of the sweep contains it.

    `quantity` describes the key, None without a unit. Raises `ValueError` for an invalid value.
    """
    if isinstance(given, str) and given.startswith(("{", "[") if quantity is None else "{"):
        return given  # the scene parses it
    if isinstance(given, str):
        try:
            given = tomllib.loads(f"value = {given}")["value"]
        except ValueError:
            if given.startswith("["):
                raise ValueError('text within brackets needs quotes: [0, 0, "2 um"]') from None
            given = {"True": True, "False": False}.get(given, given)
    given = listed(given)
    if isinstance(given, list | tuple):
        return str(_vector_in_si(given, quantity) if quantity else list(given))
    if quantity is not None:
        return to_si(given, quantity.unit)
    return given if isinstance(given, bool | int | float | str) else str(given)


def _vector_in_si(given: Sequence[Any], quantity: Quantity) -> list[Any]:
    """Return a vector, or a list of vectors, in SI units; raises `ValueError` if it is invalid."""
    return [
        _vector_in_si(each, quantity)
        if isinstance(each, list | tuple)
        else to_si(each, quantity.unit)
        for each in map(listed, given)
    ]
