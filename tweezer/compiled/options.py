"""Faster comparison of Numba's compilation options.

Numba compares all options, defaults included, whenever it looks up a function during a compilation,
which takes a fifteenth of the compile time. If the options that were set are equal, all options
are, so the defaults need not be compared.
"""

from __future__ import annotations

from typing import Any

from numba.core.targetconfig import TargetConfig

_by_all_values = TargetConfig.__eq__


def _equal(one: TargetConfig, other: object) -> Any:
    """Return whether two sets of options are equal, comparing the options that were set first."""
    if isinstance(other, TargetConfig) and one._values == other._values:
        return True
    return _by_all_values(one, other)


def compare_by_what_is_set() -> None:
    """Replace the comparison of Numba's options by `_equal`."""
    kind: Any = TargetConfig
    kind.__eq__ = _equal
    kind.__hash__ = lambda _: hash(TargetConfig)  # the same for all values, as in Numba
