"""Quantities with units at the boundary: text such as "500 nm", and those of pint, to SI floats.

Pint does the conversion; it is imported at the first unit that is not of `FREQUENT`. Of its units
only those of `_UNIT` are known here in text: others mean something else than a user of a microscope
expects (px is 1/96 inch, point 1/72 inch, Hz as an angular speed 1 rad/s). A quantity of pint, of
whatever registry, is converted by its own.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, Union, get_args

from pydantic import BeforeValidator, GetCoreSchemaHandler, GetJsonSchemaHandler, WithJsonSchema
from pydantic_core import PydanticCustomError, core_schema

from tweezer.values.prefixes import FREQUENT

if TYPE_CHECKING:
    import numpy as np
    import pint
    import xarray as xr
    from numpy.typing import NDArray

QuantityLike: TypeAlias = Union[float, str, "pint.Quantity[Any]", "xr.DataArray"]
"""What a quantity is given as: a number in the SI unit, text with a unit, a quantity of pint, or a
number of xarray with the attribute `units`."""
QuantitiesLike: TypeAlias = Union[QuantityLike, "NDArray[Any]", Sequence["QuantitiesLike"]]
"""The same of several: an array, or a list of quantities, of lists, ..."""

_NUMBER_AND_UNIT = re.compile(
    r"(?P<number>[+-]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?:[eE][+-]?[0-9]++)?)\s*+(?P<unit>.*)"
)
_NUMBER = re.compile(r"\s*[+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?\s*")
_COMPLEX = re.compile(r"[0-9.eEj+ -]{1,100}")
_NAME = (
    r"(?:[fpnuµμmcdk]?(?:m|s|sec|W|g|Pa|P|K|N|l|L|rad)"
    r"|[zafpnm]?J|joules?|eV"
    r"|(?:femto|pico|nano|micro|milli|centi|kilo)?"
    r"(?:meter|metre|second|watt|gram|pascal|poise|kelvin|newton|liter|litre|radian)s?"
    r"|microns?|angstroms?|Å|min|minutes?|h|hours?|days?"
    r"|deg|degrees?|°|rpm|turns?|revolutions?)"
)
#: products of powers, such as kg/m^3 or kg/(m s); pint would also calculate and read comments
_POWER = rf"{_NAME}(?:(?:\^|\*\*)-?[1-9]|[²³])?"
_FACTORS = rf"{_POWER}(?:(?:\s*[*/·]\s*|\s+){_POWER}){{0,7}}"
_PRODUCT = rf"(?:1\s*/\s*)?{_FACTORS}(?:\s*/\s*\({_FACTORS}\))?"
_UNIT = re.compile(rf"{_PRODUCT}|degC|degF|°[CF]|celsius|fahrenheit|dBm")
#: of a frequency alone
_HERTZ = re.compile(r"[mkM]?Hz|1/s")
#: K at 0 degC
_ZERO_CELSIUS = 273.15
#: how each SI unit is usually written, the likeliest first
_USUAL = {
    "m": ("um", "nm", "mm", "m"),
    "s": ("ms", "us", "s", "min"),
    "W": ("mW", "uW", "W"),
    "K": ("degC", "K", "degF"),
    "Pa s": ("mPa s", "Pa s", "cP"),
    "kg/m^3": ("g/cm^3", "kg/m^3"),
    "m/s": ("um/s", "mm/s", "m/s"),
    "rad/s": ("rad/s", "deg/s", "rpm"),
    "1/s": ("Hz", "kHz"),
    "rad": ("rad", "deg"),
    "V": ("V", "mV", "uV"),
    "J": ("aJ", "zJ", "J"),
}


@functools.cache
def registry() -> pint.UnitRegistry:
    """The one unit registry."""
    import pint

    # no cache on disk: pint's names files of the environment that wrote it, which others share
    return pint.UnitRegistry()


def to_si(value: Any, unit: str, low: float = -math.inf, high: float = math.inf) -> float:
    """`value` in the SI unit `unit`: a bare number as it is, text and quantities by their unit.

    A quantity is pint's, of any registry, or a number of xarray that has the attribute `units`.
    Raises `ValueError`, saying what is allowed, for anything else, and for what is not finite
    or not from `low` to `high`.
    """
    value = without_unit(value, unit)
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):  # NumPy's
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"must be a number{_or_text(unit)}")
    try:
        number = _from_text(value, unit) if isinstance(value, str) else float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError("must be finite")
    if not low <= number <= high:
        meant = "" if isinstance(value, str) else in_usual_unit(number, unit, (low, high))
        written = f'; for {meant} write "{meant}"' if meant else ""
        raise ValueError(f"must be from {low:g} to {high:g} {unit}".rstrip() + written)
    return number


def in_usual_unit(number: float, unit: str, bounds: tuple[float, float]) -> str:
    """Return a bare number with the unit in which it probably was meant, such as "1.5 um".

    The unit is the first usual one in which the number lies within `bounds`, given in the SI unit
    `unit`. Return "" if no unit fits.
    """
    for other in _USUAL.get(unit, ()):
        if other != unit and bounds[0] <= _from_text(f"{number:.17g} {other}", unit) <= bounds[1]:
            return f"{number:g} {other}"
    return ""


def array_in_si(values: Any, unit: str) -> NDArray[np.float64]:
    """Numbers of any shape in the SI unit `unit`, as `to_si` reads one.

    An array of numbers, also pint's or xarray's with its unit; or a list of what `to_si` reads.
    Raises `ValueError` for anything else.
    """
    values = without_unit(values, unit)
    if isinstance(values, list | tuple):
        if any(isinstance(each, str | list | tuple) or _has_unit(each) for each in values):
            values = [array_in_si(each, unit) for each in values]
    elif isinstance(values, str):
        values = to_si(values, unit)
    import numpy as np

    try:
        return np.asarray(values, np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"must be numbers{_or_text(unit)}") from None


def in_base_units(values: Any) -> tuple[NDArray[np.float64], str]:
    """Numbers of any shape and dimension in SI base units, and the name of their unit.

    For what has no unit of its own, such as the entries of a force. A number without a unit is
    taken as it is; the name is "" if none has one. Raises `ValueError` for anything else than
    `array_in_si` takes, and for units of different dimensions.
    """
    import numpy as np

    if isinstance(values, list | tuple):
        if any(isinstance(each, str | list | tuple) or _has_unit(each) for each in values):
            parts = [in_base_units(each) for each in values]
            units = {unit for _, unit in parts if unit}
            if len(units) > 1:
                raise ValueError(f"has units of different dimensions: {', '.join(sorted(units))}")
            if len({numbers.shape for numbers, _ in parts}) > 1:
                raise ValueError("must be numbers, as many in each row")
            return np.array([numbers for numbers, _ in parts]), "".join(units)
    elif isinstance(values, str):
        number, text = _number_and_unit(values, "SI")
        if not (_UNIT.fullmatch(text) or _HERTZ.fullmatch(text)):
            raise ValueError(f"has a unit that is not known; known is {_example('SI')}")
        values = registry().Quantity(number, text.replace("·", "*"))
    unit = ""
    if _has_unit(values):
        values = _of_our_registry(values).to_base_units()
        values, unit = values.magnitude, f"{values.units:~}"
    try:
        numbers = np.full(1, math.nan) if np.iscomplexobj(values) else np.asarray(values, float)
    except (TypeError, ValueError):
        numbers = np.full(1, math.nan)
    if np.isnan(numbers).any():  # NumPy's reading of None, too
        raise ValueError(f"must be numbers{_or_text('SI')}")
    return numbers, unit


def _of_our_registry(value: Any) -> pint.Quantity[Any]:
    """A quantity of pint or xarray in the one registry: another one's base units need not be SI."""
    if hasattr(value, "attrs"):
        number, unit = value.values, str(value.attrs["units"])
    else:
        number, unit = value.magnitude, str(value.units)
    try:
        return registry().Quantity(number, unit)
    except Exception as error:  # pint has many, and tokens of Python's are among them
        raise ValueError(f"has a unit that is not known: {unit}") from error


def without_unit(value: Any, unit: str) -> Any:
    """The number or array of a quantity with a unit, in the SI unit `unit`; all else as it is.

    Raises `ValueError` for a quantity of another dimension.
    """
    if not _has_unit(value):
        return value
    if hasattr(value, "attrs"):
        if value.attrs["units"] in (unit, unit or "1"):
            return value.values
        value = _of_our_registry(value)
    try:
        number = value.to(unit)
        turns = "radian" in dict(value.to_base_units().unit_items())
        difference = any(name.startswith("delta_") for name, _ in value.unit_items())
    except Exception as error:  # pint of whatever version, or what behaves as pint
        raise ValueError(f"has the wrong unit; {_convertible(str(value.units), unit)}") from error
    # pint takes 1 Hz as 1 rad/s, an angle as a plain number, and a difference of 5 degC as 5 K
    angle = turns and "rad" not in unit
    if angle or difference or (unit == "rad/s" and not turns):
        raise ValueError(f"has the wrong unit; {_convertible(str(value.units), unit)}")
    return number.magnitude


def _has_unit(value: Any) -> bool:
    """Whether it is a quantity of pint, or of xarray with the attribute `units`."""
    attributes = getattr(value, "attrs", None)
    if isinstance(attributes, dict):
        return "units" in attributes and hasattr(value, "values")
    return hasattr(value, "magnitude") and hasattr(value, "to_base_units")


def bare(value: Any) -> Any:
    """The number of a text without a unit; all else as it is."""
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value


def as_given(value: Any) -> str:
    """A value as text, a quantity with its unit in short."""
    if not _has_unit(value):
        return str(value)
    if hasattr(value, "attrs"):
        return f"{value.values} {value.attrs['units']}"
    return f"{value:~}"


def listed(value: Any) -> Any:
    """An array of numbers, or of quantities with a unit, as a list of them; all else as it is."""
    return list(value) if getattr(value, "ndim", 0) else value


def _or_text(unit: str) -> str:
    return f" in {unit}, or text with a unit such as {_example(unit)}" if unit else ""


def _example(unit: str) -> str:
    examples = {"m": '"500 nm"', "W": '"80 mW"', "K": '"20 degC"', "s": '"20 ms"', "1/s": '"50 Hz"',
                "SI": '"20 pN/um"'}  # fmt: skip
    return examples.get(unit, f'"1.0 {unit}"')


def _from_text(text: str, unit: str) -> float:
    number, given = _number_and_unit(text, unit)
    if (factor := FREQUENT.get(unit, {}).get(given)) is not None:
        return number * factor
    if unit == "K" and given == "degC":
        return number + _ZERO_CELSIUS
    return _by_pint(number, given, unit)


def _number_and_unit(text: str, unit: str) -> tuple[float, str]:
    """A text's two parts; raises `ValueError` if it has not both."""
    match = _NUMBER_AND_UNIT.fullmatch(text.strip())
    if not match or not unit:
        raise ValueError(f"must be a number{_or_text(unit)}")
    if not match["unit"]:
        raise ValueError(f"has no unit; write a bare number in {unit}, or {_example(unit)}")
    return float(match["number"]), match["unit"]


def _by_pint(number: float, text: str, unit: str) -> float:
    import pint

    try:
        known = _HERTZ if unit == "1/s" else _UNIT
        if not known.fullmatch(text):
            raise ValueError(f"has a unit that is not known; {_convertible(text, unit)}")
        return float(registry().Quantity(number, text.replace("·", "*")).to(unit).magnitude)
    except pint.errors.PintError:
        raise ValueError(f"has the wrong unit; {_convertible(text, unit)}") from None


def _convertible(text: str, unit: str) -> str:
    """What is allowed in place of the unit `text`, with the one that was meant where that is seen.

    It differs in capitals, spaces, signs of a product, or the degree of a temperature.
    """
    if not unit:
        return "must be a number without one"
    usual = _USUAL.get(unit, ())
    meant = [f"; did you mean {each}?" for each in usual if _folded(each) == _folded(text)]
    such = [f", such as {', '.join(each for each in usual if each != unit)}"] if usual else [""]
    return f"must be convertible to {unit}{(meant or such)[0]}"


def _folded(unit: str) -> str:
    return re.sub(r"[\s*·^°]|deg(?=[a-z])", "", re.sub("[µμ]", "u", unit.lower()))


@dataclasses.dataclass(frozen=True)
class Quantity:
    """Pydantic annotation of a quantity in the SI unit `unit`, from `low` to `high`.

    A JSON schema tells all three. `usual`: from and to, what its size is in an optical trap; a bare
    number beyond, unless it is 0, is read in `unit` but probably meant in another.
    """

    unit: str
    low: float
    high: float
    usual: tuple[float, float] = (0.0, math.inf)

    def doubt(self, value: Any) -> str:
        """Which unit the number `value` is understood in, if that makes it unusual; or nothing."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            return ""
        least, most = self.usual
        if value == 0 or not math.isfinite(value) or least <= abs(value) <= most:
            return ""
        bounds = max(least, self.low), min(most, self.high)
        if value < 0:
            bounds = -bounds[1], -least
        meant = in_usual_unit(value, self.unit, bounds)
        written = f'; {meant} is written "{meant}"' if meant else ""
        return f"is {value:g} {self.unit}{written}"

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        within = functools.partial(to_si, unit=self.unit, low=self.low, high=self.high)
        return _reading(within).__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**handler(schema), "minimum": self.low, "maximum": self.high, "unit": self.unit}


def quantity_of(*annotations: Any) -> Quantity | None:
    """The quantity within annotations such as `Length | None` or `tuple[Length, ...]`."""
    for each in annotations:
        found = each if isinstance(each, Quantity) else quantity_of(*get_args(each))
        if found:
            return found
    return None


def entries(least: int, most: int | None = None) -> BeforeValidator:
    """Pydantic validator of a list with `least` to `most` entries; exactly `least` if not given."""
    count = f"{least}" if most is None else f"{least} to {most}"

    def check(value: Any) -> Any:
        value = listed(value)
        if isinstance(value, list | tuple) and not least <= len(value) <= (most or least):
            raise PydanticCustomError("entries", "must have {count} entries", {"count": count})
        return value

    return BeforeValidator(check)


def complex_number(largest: float) -> BeforeValidator:
    """Pydantic validator that reads a complex number as the pair of its real and imaginary part.

    A number, also a complex one, text such as "0.5-0.5j", or a list [real, imaginary]; neither part
    beyond +-largest.
    """

    def parse(value: Any) -> tuple[float, float]:
        real, imaginary = (to_si(part, "", -largest, largest) for part in _parts(value))
        return real, imaginary

    return _reading(parse)


def _reading(read: Callable[[Any], Any]) -> BeforeValidator:
    """Pydantic validator by a function whose `ValueError` says what is allowed."""

    def checked(value: Any) -> Any:
        try:
            return read(value)
        except ValueError as error:
            raise PydanticCustomError("quantity", "{reason}", {"reason": str(error)}) from None

    return BeforeValidator(checked)


def _parts(value: Any) -> tuple[Any, Any]:
    """Real and imaginary part of a complex number as a user gives it."""
    value = without_unit(value, "")
    if isinstance(value, str):
        try:
            value = complex(value.replace(" ", "") if _COMPLEX.fullmatch(value) else "")
        except ValueError:
            raise ValueError('must be a complex number such as "1j" or "1.59+0.01j"') from None
    if isinstance(value, complex):
        return value.real, value.imag
    if not isinstance(value, list | tuple):
        return value, 0.0
    if len(value) != 2:
        raise ValueError('must be a number, text such as "1.59+0.01j", or [real, imaginary]')
    return value[0], value[1]


def _index(value: Any) -> float | tuple[float, float]:
    """A refractive index: a number where it is real, or else its real and imaginary part."""
    real, imaginary = _parts(value)
    imaginary = to_si(imaginary, "")
    if not 0 <= imaginary <= _INDEX_IMAGINARY:
        raise ValueError(
            f"the imaginary part must be from 0 to {_INDEX_IMAGINARY:g}: a negative one is gain"
        )
    if imaginary == 0:
        return to_si(real, "", *_INDEX)
    return to_si(real, "", *_INDEX_REAL), imaginary


def _radii_or_length(value: Any) -> float | str:
    """A number of radii as it is; a length as text in m."""
    if _has_unit(value):
        try:
            value = without_unit(value, "")
        except ValueError:
            value = f"{to_si(value, 'm'):.15g} m"
    if not isinstance(value, str):
        return to_si(value, "", *TABLE_RADII)
    if _NUMBER.fullmatch(value):
        raise ValueError('has no unit; write a bare number of radii, or a length such as "5 um"')
    return f"{to_si(value, 'm', *_TABLE_LENGTH):.15g} m"


# The ranges are wide: they keep what is computed from a scene finite, and catch a slip of units.
# Of `usual`, see `Quantity`: beads in liquids.
#: from and to, of a real index
_INDEX = (1.0, 10.0)
#: from and to, of the real part of a complex index: metals have small ones
_INDEX_REAL = (0.01, 10.0)
#: Largest imaginary part of an index
_INDEX_IMAGINARY = 100.0
#: from and to, of a map's reach in radii, and in m
TABLE_RADII = (0.5, 20.0)
_TABLE_LENGTH = (1e-8, 1e-3)
RefractiveIndex = Annotated[float, Quantity("", *_INDEX)]
ComplexIndex = Annotated[
    float | tuple[float, float],
    _reading(_index),
    WithJsonSchema({"anyOf": [
        {"type": "number", "minimum": _INDEX[0], "maximum": _INDEX[1], "unit": ""},
        {"type": "array", "prefixItems": [
            {"type": "number", "minimum": _INDEX_REAL[0], "maximum": _INDEX_REAL[1], "unit": ""},
            {"type": "number", "minimum": 0, "maximum": _INDEX_IMAGINARY, "unit": ""},
        ]},
    ]}),
]  # fmt: skip
RadiiOrLength = Annotated[
    float | str,
    _reading(_radii_or_length),
    WithJsonSchema({"anyOf": [
        {"type": "number", "minimum": TABLE_RADII[0], "maximum": TABLE_RADII[1], "unit": "radii"},
        {"type": "number", "minimum": _TABLE_LENGTH[0], "maximum": _TABLE_LENGTH[1], "unit": "m"},
    ]}),
]  # fmt: skip
Length = Annotated[float, Quantity("m", -1, 1, usual=(0, 0.05))]
PositiveLength = Annotated[float, Quantity("m", 1e-18, 1, usual=(0, 0.05))]
Wavelength = Annotated[float, Quantity("m", 1e-18, 1e-3, usual=(1e-8, 1e-4))]
#: Any length: 1 m says that the bead is never lost.
LossDistance = Annotated[float, Quantity("m", 1e-18, 1)]
#: m, from and to: also the ranges of half a diameter and half a waist
BEAD_RADIUS = (1e-9, 1e-3)
BEAM_SIGMA = (1e-9, 1.0)
#: K, from and to: of a medium
TEMPERATURE = (50.0, 5000.0)
BeadRadius = Annotated[float, Quantity("m", *BEAD_RADIUS)]
BeamSigma = Annotated[float, Quantity("m", *BEAM_SIGMA, usual=(0, 0.05))]
Time = Annotated[float, Quantity("s", 0, 1e6, usual=(0, 10))]
PositiveTime = Annotated[float, Quantity("s", 1e-15, 1e6, usual=(0, 10))]
Power = Annotated[float, Quantity("W", 0, 1e6, usual=(0, 10))]
Density = Annotated[float, Quantity("kg/m^3", 1e-6, 1e6, usual=(100, 3e4))]
Viscosity = Annotated[float, Quantity("Pa s", 1e-12, 1e9, usual=(0, 0.3))]
Temperature = Annotated[float, Quantity("K", *TEMPERATURE)]
Speed = Annotated[float, Quantity("m/s", -1e6, 1e6, usual=(0, 20))]
Acceleration = Annotated[float, Quantity("m/s^2", -1e6, 1e6)]
Frequency = Annotated[float, Quantity("1/s", 1e-6, 1e12)]
Angle = Annotated[float, Quantity("rad", -1e6, 1e6)]
AngularSpeed = Annotated[float, Quantity("rad/s", -1e12, 1e12)]
#: m, from and to
WALL = (-1e-2, 1e-2)
WallPosition = Annotated[float, Quantity("m", *WALL)]
Energy = Annotated[float, Quantity("J", -1e-12, 1e-12, usual=(0, 1e-15))]
MomentOfInertia = Annotated[float, Quantity("kg m^2", 1e-50, 1e-3)]
