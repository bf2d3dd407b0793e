"""The only table of units in which numbers are shown, with factors derived from their names."""

from __future__ import annotations

import functools
import re

#: Powers of ten of the unit prefixes
_POWERS = {"k": 3, "m": -3, "u": -6, "µ": -6, "n": -9, "p": -12, "f": -15, "a": -18, "z": -21}
_FACTOR = re.compile(
    r"(?P<prefix>[kmuµnpfaz]?)(?:m|s|W|N|J|K|V|Pa|Hz|(?P<gram>g))(?:\^(?P<power>\d))?|rad|1"
    r"|10\^(?P<ten>-\d+)"
)
#: Usual units for each SI unit; tables and figures use the first
_UNITS = {
    "m": ("um", "nm", "mm", "m"),
    "s": ("ms", "us", "s"),
    "W": ("mW", "uW", "W"),
    "K": ("K",),
    "Pa": ("Pa",),
    "Pa s": ("mPa s", "Pa s"),
    "kg/m^3": ("kg/m^3",),
    "m/s": ("m/s", "um/s", "mm/s"),
    "m/s^2": ("m/s^2",),
    "1/s": ("Hz", "kHz"),
    "N": ("pN", "fN", "N"),
    "N/m": ("pN/um", "fN/um", "N/m"),
    "J": ("J", "aJ", "zJ"),
    "V": ("V", "mV", "uV", "µV", "nV"),
    "m^2": ("nm^2",),
    "m^2/s": ("um^2/s",),
    "kg/s": ("nN s/m",),
    "N m": ("pN um",),
    "m/V": ("um/V",),
    "N/V": ("pN/V",),
}
#: SI units whose shown unit does not depend on the magnitude of the number
_ONE_ALONE = ("m^2", "m^2/s", "kg/s", "N m", "m/V", "N/V")


@functools.cache
def factor(unit: str) -> float:
    """Return the factor from a unit to its SI unit, according to its prefixes: 1e-6 for "pN/um"."""
    above, _, below = unit.partition("/")
    return float(f"1e{_power(above) - _power(below.strip('()'))}")


def _power(product: str) -> int:
    """Return the power of ten of a product of units, such as "nN s"."""
    power = 0
    for each in product.split():
        if (match := _FACTOR.fullmatch(each)) is None:
            raise ValueError(
                f"{each!r}: unknown unit; must be m, s, W, N, J, K, V, Pa, Hz or g with a prefix, "
                "rad, 1 or a power of ten such as 10^-3"
            )
        power += _POWERS.get(match["prefix"] or "", 0) * int(match["power"] or 1)
        power += int(match["ten"] or 0) - (3 if match["gram"] else 0)
    return power


#: Factors of common units to the SI unit, equal to Pint's, whose import takes half a second
FREQUENT = {
    unit: {name: factor(name) for name in names}
    for unit, names in _UNITS.items()
    if unit not in _ONE_ALONE
}


@functools.cache
def per(unit: str) -> float:
    """Return the factor from the SI unit to this unit, such as 1e6 for "pN/um"."""
    return float(f"{1 / factor(unit):.12g}")


def in_tables(unit: str) -> tuple[float, str]:
    """Return the factor from an SI unit to the unit used in tables and figures, and its name.

    A unit without a customary one is not converted. The name of "1" is empty.
    """
    name = _UNITS[unit][0] if unit in _UNITS else unit
    return per(name) if name != unit else 1.0, "" if name == "1" else name


def usual_unit(size: float, unit: str) -> tuple[float, str]:
    """Return the factor to SI and the name of the customary unit for a magnitude.

    This is the largest customary unit in which the number is at least 1, for example "nm" for 5e-8
    m and "um" for 5e-6 m. `size` is the magnitude in the SI unit `unit`.
    """
    units = FREQUENT.get(unit, {unit: 1.0})
    below = {name: each for name, each in units.items() if each <= abs(size) * (1 + 1e-9)}
    name = max(below, key=below.__getitem__) if below else min(units, key=units.__getitem__)
    return units[name], name


def prefixed(size: float, unit: str) -> tuple[float, str]:
    """Return the factor and the unit whose prefix makes `size` a number from 1 to 1000."""
    if not unit or size == 0:
        return 1.0, unit
    signs = {0: "", **{power: each for each, power in _POWERS.items() if power < 0}}
    power = next((each for each in signs if abs(size) >= 10.0**each), -21)
    return 10.0**-power, signs[power] + unit
