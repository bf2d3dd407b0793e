"""Quantities with units at the boundary: text such as "500 nm" to SI floats.

Pint does the conversion; it is imported at the first text quantity, not before.
"""

from __future__ import annotations

import functools
import math
import re
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

if TYPE_CHECKING:
    import pint

_NUMBER_AND_UNIT = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(?P<unit>.*?)\s*"
)


@functools.cache
def registry() -> pint.UnitRegistry:
    """The one unit registry."""
    import pint

    return pint.UnitRegistry(cache_folder=":auto:")


def to_si(value: Any, unit: str) -> float:
    """`value` in the SI unit `unit`: a bare number as it is, text by its unit.

    Raises `ValueError`, saying what is allowed, for anything else.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"must be a number{_or_text(unit)}")
    if isinstance(value, str):
        return _from_text(value, unit)
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError("must be finite")
    return number


def _or_text(unit: str) -> str:
    return f" in {unit}, or text with a unit such as {_example(unit)}" if unit else ""


def _example(unit: str) -> str:
    examples = {"m": '"500 nm"', "W": '"80 mW"', "K": '"20 degC"', "s": '"20 ms"'}
    return examples.get(unit, f'"1.0 {unit}"')


def _from_text(text: str, unit: str) -> float:
    import pint

    match = _NUMBER_AND_UNIT.fullmatch(text)
    if not match or not unit:
        raise ValueError(f"must be a number{_or_text(unit)}")
    if not match["unit"]:
        raise ValueError(f"has no unit; write a bare number in {unit}, or {_example(unit)}")
    try:
        quantity = registry().Quantity(float(match["number"]), match["unit"])
        number = float(quantity.to(unit).magnitude)
    except pint.DimensionalityError:
        raise ValueError(f"has the wrong unit; must be convertible to {unit}") from None
    except (pint.errors.PintError, AttributeError, TypeError, ValueError, SyntaxError):
        raise ValueError(f"has a unit that is not known; must be convertible to {unit}") from None
    if not math.isfinite(number):
        raise ValueError("must be finite")
    return number


def si(unit: str) -> BeforeValidator:
    """Pydantic validator that reads a quantity in `unit`."""

    def parse(value: Any) -> float:
        try:
            return to_si(value, unit)
        except ValueError as error:
            raise PydanticCustomError("quantity", "{reason}", {"reason": str(error)}) from None

    return BeforeValidator(parse)


Length = Annotated[float, si("m")]
PositiveLength = Annotated[float, si("m"), Field(gt=0)]
PositiveTime = Annotated[float, si("s"), Field(gt=0)]
Power = Annotated[float, si("W"), Field(ge=0)]
Density = Annotated[float, si("kg/m^3"), Field(gt=0)]
Viscosity = Annotated[float, si("Pa s"), Field(gt=0)]
Temperature = Annotated[float, si("K"), Field(gt=0)]
Speed = Annotated[float, si("m/s")]
Acceleration = Annotated[float, si("m/s^2")]
AngularSpeed = Annotated[float, si("rad/s")]
MomentOfInertia = Annotated[float, si("kg m^2"), Field(gt=0)]
Number = Annotated[float, si("")]
