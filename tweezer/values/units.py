"""Conversion of users' quantities to SI numbers: text such as "500 nm", and quantities of pint.

Pint does the conversion. It is imported at the first unit that is not in `FREQUENT`. Text may only
contain units of `_UNIT`, because other units of pint have a meaning that a user of a microscope
does not expect (px is 1/96 inch, point is 1/72 inch, Hz as an angular velocity is 1 rad/s). A
quantity of pint, from any registry, is converted by its own registry.
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
"""Forms in which a quantity may be given: a number in the SI unit, text with a unit, a quantity of
pint, or a number of xarray with the attribute `units`."""
QuantitiesLike: TypeAlias = Union[QuantityLike, "NDArray[Any]", Sequence["QuantitiesLike"]]
"""Forms in which several quantities may be given: an array, or a (nested) list of quantities."""

_NUMBER_AND_UNIT = re.compile(
    r"(?P<number>[+-]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?:[eE][+-]?[0-9]++)?)\s*+(?P<unit>.*)"
)
_NUMBER = re.compile(r"\s*[+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?\s*")
_COMPLEX = re.compile(r"[0-9.eEj+ -]{1,100}")
_NAME = (
    r"(?:[fpnuµμmcdk]?(?:m|s|sec|W|g|Pa|P|K|N|l|L|rad|mol|bar)"
    r"|hPa|m?[Tt]orr|atm"
    r"|[zafpnm]?J|joules?|eV"
    r"|(?:femto|pico|nano|micro|milli|centi|kilo)?"
    r"(?:meter|metre|second|watt|gram|pascal|poise|kelvin|newton|liter|litre|radian)s?"
    r"|microns?|angstroms?|Å|min|minutes?|h|hours?|days?"
    r"|deg|degrees?|°|rpm|turns?|revolutions?)"
)
#: Pattern of products of powers, such as kg/m^3 or kg/(m s); pint alone would also do arithmetic
_POWER = rf"{_NAME}(?:(?:\^|\*\*)-?[1-9]|[²³])?"
_FACTORS = rf"{_POWER}(?:(?:\s*[*/·]\s*|\s+){_POWER}){{0,7}}"
_PRODUCT = rf"(?:1\s*/\s*)?{_FACTORS}(?:\s*/\s*\({_FACTORS}\))?"
_UNIT = re.compile(rf"{_PRODUCT}|[MG]Pa|degC|degF|°[CF]|celsius|fahrenheit|dBm")
#: Pattern of units that are valid only for a frequency
_HERTZ = re.compile(r"[mkM]?Hz|1/s")
#: Pattern of units of spectral densities
_PER_HERTZ = re.compile(rf"(?:1|{_POWER})\s*/\s*Hz")
#: Temperature at 0 degC, K
_ZERO_CELSIUS = 273.15
#: Usual units for each SI unit, the most probable first
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
    "Pa": ("mbar", "Pa", "bar"),
    "mol/kg": ("mol/kg", "mmol/kg"),
}


@functools.cache
def registry() -> pint.UnitRegistry:
    """Return the unit registry for all text, created once."""
    import pint

    # no cache on disk: pint's cache names files of the environment that wrote it
    return pint.UnitRegistry()


def to_si(value: Any, unit: str, low: float = -math.inf, high: float = math.inf) -> float:
    """Return a quantity as a number in an SI unit.

    A number without a unit is assumed to be in this unit. Text, quantities of any pint registry,
    and xarray numbers with the attribute `units` are converted.

    Parameters
    ----------
    value : float, str or quantity
        The quantity.
    unit : str
        The SI unit.
    low, high : float, optional
        Allowed range, in `unit`.

    Raises
    ------
    ValueError
        For anything else, for a value that is not finite, and for a value outside the range. The
        message states what is allowed.
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
    """Return a number without unit with the unit that was probably meant, such as "1.5 um".

    It is the first usual unit for which the number is within `bounds`, given in the SI unit `unit`.
    Returns "" if no unit fits.
    """
    for other in _USUAL.get(unit, ()):
        if other != unit and bounds[0] <= _from_text(f"{number:.17g} {other}", unit) <= bounds[1]:
            return f"{number:g} {other}"
    return ""


def array_in_si(values: Any, unit: str) -> NDArray[np.float64]:
    """Return numbers of any shape in the SI unit `unit`, each converted as by `to_si`.

    They may be an array of numbers, also of pint or xarray with its unit, or nested lists of
    quantities. Raises `ValueError` for anything else.
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
    """Return numbers of any shape and dimension in SI base units, with the name of their unit.

    This is for values whose unit is not known in advance, such as parameters of a user's force.
    Numbers without a unit are returned unchanged; the name is "" if none has a unit. Raises
    `ValueError` for values that `array_in_si` does not accept, and for units of different
    dimensions.
    """
    import numpy as np

    if isinstance(values, list | tuple):
        if any(isinstance(each, str | list | tuple) or _has_unit(each) for each in values):
            parts = [in_base_units(each) for each in values]
            units = {unit for _, unit in parts if unit}
            if len(units) > 1:
                raise ValueError(f"has units of different dimensions: {', '.join(sorted(units))}")
            if len({numbers.shape for numbers, _ in parts}) > 1:
                raise ValueError("must be numbers, equally many in each row")
            return np.array([numbers for numbers, _ in parts]), "".join(units)
    elif isinstance(values, str):
        number, text = _number_and_unit(values, "SI")
        if not (_UNIT.fullmatch(text) or _HERTZ.fullmatch(text)):
            raise ValueError(f"has an unknown unit; write, for example, {_example('SI')}")
        values = registry().Quantity(number, text.replace("·", "*"))
    unit = ""
    if _has_unit(values):
        values = _of_our_registry(values).to_base_units()
        values, unit = values.magnitude, f"{values.units:~}"
    try:
        numbers = np.full(1, math.nan) if np.iscomplexobj(values) else np.asarray(values, float)
    except (TypeError, ValueError):
        numbers = np.full(1, math.nan)
    if np.isnan(numbers).any():  # NumPy also converts None to NaN
        raise ValueError(f"must be numbers{_or_text('SI')}")
    return numbers, unit


def _of_our_registry(value: Any) -> pint.Quantity[Any]:
    """Return a quantity of pint or xarray in the registry of this module.

    This is needed because the base units of another registry may differ from SI units.
    """
    if hasattr(value, "attrs"):
        number, unit = value.values, str(value.attrs["units"])
    else:
        number, unit = value.magnitude, str(value.units)
    try:
        return registry().Quantity(number, unit)
    except Exception as error:  # pint raises errors of many types, even of Python's tokenizer
        raise ValueError(f"has an unknown unit: {unit}") from error


def without_unit(value: Any, unit: str) -> Any:
    """Return the number or array of a quantity in the SI unit `unit`.

    Values without a unit are returned unchanged. Raises `ValueError` for a quantity of another
    dimension.
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
    except Exception as error:  # from any version of pint, or a similar library
        raise ValueError(f"has the wrong unit; {_convertible(str(value.units), unit)}") from error
    # pint converts 1 Hz to 1 rad/s, an angle to a plain number, and 5 delta_degC to 5 K
    angle = turns and "rad" not in unit
    if angle or difference or (unit == "rad/s" and not turns):
        raise ValueError(f"has the wrong unit; {_convertible(str(value.units), unit)}")
    return number.magnitude


def _has_unit(value: Any) -> bool:
    """Return whether a value is a quantity of pint, or of xarray with the attribute `units`."""
    attributes = getattr(value, "attrs", None)
    if isinstance(attributes, dict):
        return "units" in attributes and hasattr(value, "values")
    return hasattr(value, "magnitude") and hasattr(value, "to_base_units")


def bare(value: Any) -> Any:
    """Return the number in a text without a unit; anything else unchanged."""
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value


def as_given(value: Any) -> str:
    """Return a value as text, a quantity with the short name of its unit."""
    if not _has_unit(value):
        return str(value)
    if hasattr(value, "attrs"):
        return f"{value.values} {value.attrs['units']}"
    return f"{value:~}"


def listed(value: Any) -> Any:
    """Return an array of numbers or quantities as a list; anything else unchanged."""
    return list(value) if getattr(value, "ndim", 0) else value


def _or_text(unit: str) -> str:
    """Return the end of a message: the unit of a number, or a text that may be given instead."""
    return f" in {unit}, or text with a unit such as {_example(unit)}" if unit else ""


def _example(unit: str) -> str:
    """Return an example of text for a quantity in an SI unit, in quotes, such as '"500 nm"'."""
    examples = {"m": '"500 nm"', "W": '"80 mW"', "K": '"20 degC"', "s": '"20 ms"', "1/s": '"50 Hz"',
                "SI": '"20 pN/um"'}  # fmt: skip
    return examples.get(unit, f'"1.0 {unit}"')


def _from_text(text: str, unit: str) -> float:
    """Return the number in the SI unit `unit` for a text such as "500 nm"."""
    number, given = _number_and_unit(text, unit)
    if (factor := FREQUENT.get(unit, {}).get(given)) is not None:
        return number * factor
    if unit == "K" and given == "degC":
        return number + _ZERO_CELSIUS
    return _by_pint(number, given, unit)


def _number_and_unit(text: str, unit: str) -> tuple[float, str]:
    """Return the number and the unit in a text; raises `ValueError` unless it has both.

    `unit` is the required SI unit, for the message.
    """
    match = _NUMBER_AND_UNIT.fullmatch(text.strip())
    if not match or not unit:
        raise ValueError(f"must be a number{_or_text(unit)}")
    if not match["unit"]:
        raise ValueError(f"has no unit; write a bare number in {unit}, or {_example(unit)}")
    return float(match["number"]), match["unit"]


def _by_pint(number: float, text: str, unit: str) -> float:
    """Return a number with the unit `text` in the SI unit `unit`, converted by pint."""
    import pint

    try:
        known = _HERTZ if unit == "1/s" else _PER_HERTZ if unit.endswith("/Hz") else _UNIT
        if not known.fullmatch(text):
            raise ValueError(f"has an unknown unit; {_convertible(text, unit)}")
        return float(registry().Quantity(number, text.replace("·", "*")).to(unit).magnitude)
    except pint.errors.PintError:
        raise ValueError(f"has the wrong unit; {_convertible(text, unit)}") from None


def _convertible(text: str, unit: str) -> str:
    """Return the end of a message, on the units that are allowed instead of the unit `text`.

    It suggests a unit if `text` differs from it only in case, spaces, signs of a product or the
    degree sign.
    """
    if not unit:
        return "must be a number without one"
    usual = _USUAL.get(unit, ())
    meant = [f"; did you mean {each}?" for each in usual if _folded(each) == _folded(text)]
    such = [f", such as {', '.join(each for each in usual if each != unit)}"] if usual else [""]
    return f"must be convertible to {unit}{(meant or such)[0]}"


def _folded(unit: str) -> str:
    """Return a unit in a form for comparison: lower case, without signs of products, powers or
    degrees.
    """
    return re.sub(r"[\s*·^°]|deg(?=[a-z])", "", re.sub("[µμ]", "u", unit.lower()))


@dataclasses.dataclass(frozen=True)
class Quantity:
    """Annotation of a Pydantic field for a quantity in the SI unit `unit`, from `low` to `high`.

    The JSON schema contains all three. `usual` is the range of magnitudes in an optical trap. A
    number without a unit that is outside it (and not 0) is read in `unit`, but was probably meant
    in another unit.
    """

    unit: str
    low: float
    high: float
    usual: tuple[float, float] = (0.0, math.inf)

    def doubt(self, value: Any) -> str:
        """Return the end of a warning for a number that is unusual in the SI unit; "" for a usual
        number.
        """
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
        """Return the schema with which Pydantic converts a value to SI and checks its range."""
        within = functools.partial(to_si, unit=self.unit, low=self.low, high=self.high)
        return _reading(within).__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the JSON schema with range and unit."""
        return {**handler(schema), "minimum": self.low, "maximum": self.high, "unit": self.unit}


def quantity_of(*annotations: Any) -> Quantity | None:
    """Return the `Quantity` in annotations such as `Length | None` or `tuple[Length, ...]`, or
    None.
    """
    for each in annotations:
        found = each if isinstance(each, Quantity) else quantity_of(*get_args(each))
        if found:
            return found
    return None


def entries(least: int, most: int | None = None) -> BeforeValidator:
    """Return a Pydantic validator for a list of `least` to `most` entries, or exactly `least`."""
    count = f"{least}" if most is None else f"{least} to {most}"

    def check(value: Any) -> Any:
        """Return the value, an array as a list; raise an error for a wrong number of entries."""
        value = listed(value)
        if isinstance(value, list | tuple) and not least <= len(value) <= (most or least):
            raise PydanticCustomError("entries", "must have {count} entries", {"count": count})
        return value

    return BeforeValidator(check)


def complex_number(largest: float) -> BeforeValidator:
    """Return a Pydantic validator that reads a complex number as a pair of real and imaginary part.

    It accepts a real or complex number, text such as "0.5-0.5j", or a list [real, imaginary].
    Neither part may exceed `largest` in magnitude.
    """

    def parse(value: Any) -> tuple[float, float]:
        """Return the real and imaginary part of a value."""
        real, imaginary = (to_si(part, "", -largest, largest) for part in _parts(value))
        return real, imaginary

    return _reading(parse)


def _reading(read: Callable[[Any], Any]) -> BeforeValidator:
    """Return a Pydantic validator from a function that raises `ValueError` for invalid values."""

    def checked(value: Any) -> Any:
        """Return `read(value)`, with its `ValueError` converted to an error of Pydantic."""
        try:
            return read(value)
        except ValueError as error:
            raise PydanticCustomError("quantity", "{reason}", {"reason": str(error)}) from None

    return BeforeValidator(checked)


def _parts(value: Any) -> tuple[Any, Any]:
    """Return the real and imaginary part of a complex number in any form that users may give."""
    value = without_unit(value, "")
    if isinstance(value, str):
        try:
            if not _COMPLEX.fullmatch(value):  # `complex` also accepts "inf", "nan" and 1_000
                raise ValueError
            value = complex(value.replace(" ", ""))
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
    """Return a user's refractive index: a number if it is real, else real and imaginary part."""
    real, imaginary = _parts(value)
    imaginary = to_si(imaginary, "")
    if not 0 <= imaginary <= _INDEX_IMAGINARY:
        raise ValueError(
            f"the imaginary part must be from 0 to {_INDEX_IMAGINARY:g}: a negative one is gain"
        )
    if imaginary == 0:
        return to_si(real, "", *_INDEX)
    return to_si(real, "", *_INDEX_REAL), imaginary


def _switch_or_rise(value: Any) -> bool | float:
    """Return a user's true or false, or a temperature rise per power in K/W."""
    if isinstance(value, bool):
        return value
    try:
        return to_si(value, "K/W", *_RISE)
    except ValueError:
        raise ValueError(
            f'must be true, false, or a rise per power such as "15 K/W", up to {_RISE[1]:g} K/W'
        ) from None


def _radii_or_length(value: Any) -> float | str:
    """Return a user's range of a force map: a number of bead radii, or a length as text in m."""
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


# The ranges are wide: they ensure that everything computed from a scene is finite, and detect
# mistakes in units. `usual` (see `Quantity`) applies to beads in liquids.
#: Range of a real refractive index
_INDEX = (1.0, 10.0)
#: Range of the real part of a complex refractive index, which is small for metals
_INDEX_REAL = (0.01, 10.0)
#: Largest imaginary part of a refractive index
_INDEX_IMAGINARY = 100.0
#: Range of a temperature rise per power of light, K/W
_RISE = (0.0, 1e12)
#: Allowed range of a force map in bead radii, and in m
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
SwitchOrRise = Annotated[
    bool | float,
    _reading(_switch_or_rise),
    WithJsonSchema({"anyOf": [
        {"type": "boolean"},
        {"type": "number", "minimum": _RISE[0], "maximum": _RISE[1], "unit": "K/W"},
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
#: Up to that of the molecules in ultrahigh vacuum
FreePath = Annotated[float, Quantity("m", 1e-18, 1e12)]
Wavelength = Annotated[float, Quantity("m", 1e-18, 1e-3, usual=(1e-8, 1e-4))]
#: Any length up to 1 m, which means that the bead is never lost
LossDistance = Annotated[float, Quantity("m", 1e-18, 1)]
#: Ranges of a bead radius and of a beam's sigma, m; also of half a diameter and half a waist
BEAD_RADIUS = (1e-9, 1e-3)
BEAM_SIGMA = (1e-9, 1.0)
#: Range of the temperature of a medium, K
TEMPERATURE = (50.0, 5000.0)
BeadRadius = Annotated[float, Quantity("m", *BEAD_RADIUS)]
BeamSigma = Annotated[float, Quantity("m", *BEAM_SIGMA, usual=(0, 0.05))]
Time = Annotated[float, Quantity("s", 0, 1e6, usual=(0, 10))]
PositiveTime = Annotated[float, Quantity("s", 1e-15, 1e6, usual=(0, 10))]
Power = Annotated[float, Quantity("W", 0, 1e6, usual=(0, 10))]
Pressure = Annotated[float, Quantity("Pa", 1e-10, 2e5)]
Modulus = Annotated[float, Quantity("Pa", 1e-9, 1e9)]
Molality = Annotated[float, Quantity("mol/kg", 0, 6)]
Density = Annotated[float, Quantity("kg/m^3", 1e-6, 1e6, usual=(100, 3e4))]
#: Down to that of a gas in ultrahigh vacuum
FluidDensity = Annotated[float, Quantity("kg/m^3", 1e-18, 1e6, usual=(100, 3e4))]
Viscosity = Annotated[float, Quantity("Pa s", 1e-12, 1e9, usual=(0, 0.3))]
Temperature = Annotated[float, Quantity("K", *TEMPERATURE)]
Speed = Annotated[float, Quantity("m/s", -1e6, 1e6, usual=(0, 20))]
Acceleration = Annotated[float, Quantity("m/s^2", -1e6, 1e6)]
Frequency = Annotated[float, Quantity("1/s", 1e-6, 1e12)]
Angle = Annotated[float, Quantity("rad", -1e6, 1e6)]
AngularSpeed = Annotated[float, Quantity("rad/s", -1e12, 1e12)]
#: Range of the position of a wall, m
WALL = (-1e-2, 1e-2)
WallPosition = Annotated[float, Quantity("m", *WALL)]
Energy = Annotated[float, Quantity("J", -1e-12, 1e-12, usual=(0, 1e-15))]
MomentOfInertia = Annotated[float, Quantity("kg m^2", 1e-50, 1e-3)]
