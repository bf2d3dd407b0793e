"""Numbers in the summary of a page, with units and as many digits as their errors justify."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from tweezer.values import prefixes
from tweezer.values.rounding import rounded
from tweezer.values.signs import typeset
from tweezer.viewing.content import Row

#: Text in place of a number or an error that is not known
NOT_KNOWN = "not known"


def of_number(
    name: str, value: float, error: float | None = None, unit: str = "", *,
    in_tables: bool = False, trusted: bool = True,
) -> Row:  # fmt: skip
    """Return a line of the summary for a number, with as many digits as its error justifies.

    Parameters
    ----------
    name : str
        Name of the quantity.
    value : float
        Value in the SI unit `unit`. One that is not finite is shown as not known.
    error : float, optional
        Error, in the same unit. It is None for a number without an error, such as a given one, and
        NaN or infinite if it is unknown.
    unit : str, optional
        The SI unit.
    in_tables : bool, optional
        Whether the number has the unit of figures and tables. Otherwise it has a prefix that suits
        its size.
    trusted : bool, optional
        Whether the number can be trusted.
    """
    if not math.isfinite(value):
        return Row(name, NOT_KNOWN, "", trusted=False)
    known = error is not None and 0 < error < math.inf
    size = value if value or not known or error is None else error
    factor, shown = prefixes.in_tables(unit) if in_tables else prefixes.prefixed(size, unit)
    shown = typeset(shown)
    if error is None or not known:
        told = "" if error is None or error == 0 else NOT_KNOWN
        return Row(name, f"{factor * value:.4g} {shown}".rstrip(), told, trusted)
    number, uncertainty = rounded(factor * value, factor * error)
    if value == 0:
        number, uncertainty = "0", f"{factor * error:.2g}"
    return Row(name, f"{number} {shown}".rstrip(), f"± {uncertainty} {shown}".rstrip(), trusted)


def si(value: float, unit: str, digits: int = 3) -> str:
    """Return an SI value as text with a suitable unit prefix; "not known" if it is not finite."""
    if not math.isfinite(value):
        return NOT_KNOWN
    factor, name = prefixes.prefixed(value, unit)
    return f"{float(f'{factor * value:.{digits}g}'):.6g} {typeset(name)}"  # 300, not 3e+02


def computed_by(attributes: Mapping[str, Any]) -> str:
    """Return a sentence with the versions that computed a result, from its attributes."""
    libraries = ", ".join(
        f"{name.removesuffix('_version')} {attributes[name]}"
        for name in ("tweezer_version", "numpy_version", "scipy_version", "numba_version")
        if name in attributes
    )
    return f"Computed by {libraries}."
