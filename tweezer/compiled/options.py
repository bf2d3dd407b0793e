"""Numba's options of a compilation, compared by those that are set.

Numba compares the values of all options, defaults included, whenever it looks up a function while
it compiles. That is a fifteenth of the time to compile. Options with the same values set are equal,
so the others need not be compared.
"""

from __future__ import annotations

from typing import Any

from numba.core.targetconfig import TargetConfig

_by_all_values = TargetConfig.__eq__


def _equal(one: TargetConfig, other: object) -> Any:
    """Return whether two sets of options have the same values, comparing those that are
    set first.
    """
    if isinstance(other, TargetConfig) and one._values == other._values:
        return True
    return _by_all_values(one, other)


def compare_by_what_is_set() -> None:
    """Replace the comparison of Numba's options by one that compares the options that are set."""
    kind: Any = TargetConfig
    kind.__eq__ = _equal
    kind.__hash__ = lambda _: hash(TargetConfig)  # as Numba's, the same for all values
