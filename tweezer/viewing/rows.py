"""Numbers as a page tells them: with a unit, and as many digits as their error leaves."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from tweezer.rounding import rounded
from tweezer.sweeps.quantities import SHOWN
from tweezer.viewing.content import Row


def of_number(name: str, value: float, error: float | None, unit: str = "") -> Row:
    """A number in the prefix that suits it, with as many digits as its error leaves."""
    factor, prefixed = _prefix(value, unit)
    if error is None or not error > 0:
        return Row(name, f"{factor * value:.4g} {prefixed}".rstrip())
    number, uncertainty = rounded(factor * value, factor * error)
    return Row(name, f"{number} {prefixed}".rstrip(), f"{uncertainty} {prefixed}".rstrip())


#: Powers of ten and their prefixes, from the largest
_PREFIXES = {0: "", -3: "m", -6: "µ", -9: "n", -12: "p", -15: "f", -18: "a", -21: "z"}


def _prefix(value: float, unit: str) -> tuple[float, str]:
    if not unit or value == 0 or not math.isfinite(value):
        return 1.0, unit
    power = next((each for each in _PREFIXES if abs(value) >= 10.0**each), -21)
    return 10.0**-power, _PREFIXES[power] + unit


def si(value: float, unit: str, digits: int = 3) -> str:
    """A number in the prefix that suits it."""
    factor, prefixed = _prefix(value, unit)
    return f"{float(f'{factor * value:.{digits}g}'):.6g} {prefixed}"  # 300, not 3e+02


def computed_by(attributes: Mapping[str, Any]) -> str:
    """With what a result was computed, as its attributes have it."""
    libraries = ", ".join(
        f"{name.removesuffix('_version')} {attributes[name]}"
        for name in ("tweezer_version", "numpy_version", "scipy_version", "numba_version")
        if name in attributes
    )
    return f"Computed by {libraries}."


def shown(name: str, value: float, error: float, unit: str, *, trusted: bool = True) -> Row:
    """A number in the unit in which figures and tables have it; one not finite is "not known"."""
    scale, unit = SHOWN.get(unit, (1.0, "" if unit == "1" else unit))
    if not math.isfinite(value):
        return Row(name, "not known", "", trusted=False)
    if not 0 < error < math.inf:
        return Row(name, f"{scale * value:.4g} {unit}".rstrip(), "", trusted)
    number, uncertainty = rounded(scale * value, scale * error)
    if value == 0:
        number, uncertainty = "0", f"{scale * error:.2g}"
    return Row(name, f"{number} {unit}".rstrip(), f"{uncertainty} {unit}".rstrip(), trusted)
