"""The mobilities of two spheres as series over their gap, for compiled code.

The variable is w = ln(1 + 2 (a_1 + a_2)/gap). As functions of the distance d of the centres the
mobilities are singular for -(a_1 + a_2) <= d <= a_1 + a_2 only, at the distance pi from the real
axis of w. Their Chebyshev series therefore converge fast from contact to infinity. The mobility
along the line is divided by gap/d, so that it keeps its digits near contact.

The series depend on the ratio of the radii alone. They are computed once, in seconds, and stored in
the user's cache folder.
"""

from __future__ import annotations

import functools
import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tweezer.compiled import cache_functions, cached_njit
from tweezer.fluid import pair as exact
from tweezer.fluid import two_spheres
from tweezer.fluid.pair import NAMES, mobilities, scales
from tweezer.generated import pair
from tweezer.optics.table import kept
from tweezer.scene.several import LARGEST_RATIO
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

cache_functions(pair)

#: Smallest gap, over the harmonic mean of the radii
_LOWEST = 1e-5
#: Pieces of w, and terms of each, which compiled code knows
_PIECES, _TERMS = 10, pair.TERMS
_ALONG = NAMES.index("relative_x")


@dataclass(frozen=True)
class PairTable:
    """Series of the mobilities of two spheres, over 1/(6 pi mu) and powers of the first radius.

    The compiled function `tweezer.generated.pair.mobilities` reads the first four fields.
    """

    powers: Array
    """(pieces, terms, 18): powers of the place in a piece of w, the highest first, of mobilities in
    the order of `tweezer.fluid.pair.NAMES`"""
    total: float
    """sum of the radii, over the first"""
    lowest: float
    """smallest gap of the series, over the first radius. Below it relative_x is proportional to the
    gap, and the others are constant"""
    per_w: float
    """pieces in a unit of w"""
    error: float
    """estimated largest error relative to the mobilities of separate spheres; of relative_x
    relative to its value"""

    def mobilities(self, gaps: Array) -> tuple[Array, Array]:
        """Return mobilities and derivatives, (18, n) each, at gaps over the first radius, (n,)."""
        gaps = np.ascontiguousarray(gaps, np.float64)
        found = np.empty((2, len(gaps), len(NAMES)))
        _fill(self.powers, self.total, self.lowest, self.per_w, gaps, found)
        return found[0].T, found[1].T


@cached_njit(error_model="numpy", nogil=True)
def _fill(powers, total, lowest, per_w, gaps, found):  # type: ignore[no-untyped-def]
    """Fill found (2, n, 18) with mobilities and derivatives at gaps (n,)."""
    for at in range(len(gaps)):
        pair.mobilities(powers, total, lowest, per_w, gaps[at], found[0, at], found[1, at])


def pair_table(ratio: float) -> PairTable:
    """Return the table for a ratio a_2/a_1 of the radii; compute it unless it is stored.

    Parameters
    ----------
    ratio : float
        Second radius over the first, from 1/20 to 20.
    """
    if not 1 / LARGEST_RATIO <= ratio <= LARGEST_RATIO:
        raise SceneError(
            f"ratio of radii = {ratio:g}: too unequal for a table of the mobilities of two "
            f"spheres; allowed: from {1 / LARGEST_RATIO:g} to {LARGEST_RATIO:g}"
        )
    return _table(float(f"{ratio:.12g}"))


@functools.lru_cache(maxsize=64)
def _table(ratio: float) -> PairTable:
    key = hashlib.sha256(f"{_SOURCES}{ratio!r}".encode()).hexdigest()
    made, _ = kept(key, PairTable, lambda: _make(ratio))
    return made


#: code that computes a table, as it was when the program started: a part of the table's key
_SOURCES = "".join(
    Path(each).read_text(encoding="utf-8")
    for each in (__file__, exact.__file__, two_spheres.__file__)
)


def _make(ratio: float) -> PairTable:
    """Compute the series from exact mobilities at Chebyshev's nodes."""
    total, lowest = 1 + ratio, 2 * _LOWEST * ratio / (1 + ratio)
    most = np.log1p(2 * total / lowest)
    nodes = np.cos(np.pi * (np.arange(_TERMS) + 0.5) / _TERMS)
    series = np.empty((_PIECES, _TERMS, len(NAMES)))
    rounding = 0.0
    for piece in range(_PIECES):
        gaps = 2 * total / np.expm1((piece + (1 + nodes) / 2) * most / _PIECES)
        values = np.empty((_TERMS, len(NAMES)))
        for at, gap in enumerate(gaps):
            values[at], error = mobilities(1.0, ratio, float(gap), two_spheres.DECAY)
            rounding = max(rounding, error)
        values[:, _ALONG] /= gaps / (gaps + total)
        waves = np.cos(np.pi * np.outer(np.arange(_TERMS), np.arange(_TERMS) + 0.5) / _TERMS)
        series[piece] = 2 / _TERMS * waves @ values
        series[piece, 0] /= 2
    # the terms decrease fast: the last one exceeds all that are left out
    left = np.abs(series[:, -1]).max(axis=0) / scales(1.0, ratio)
    left[_ALONG] = np.abs(series[:, -1, _ALONG] / series[:, 0, _ALONG]).max()
    powers = np.array([_powers(piece) for piece in series])
    return PairTable(powers, total, lowest, float(_PIECES / most), float(left.max() + rounding))


def _powers(series: Array) -> Array:
    """Return a Chebyshev series, (terms, functions), as powers, the highest first."""
    from numpy.polynomial.chebyshev import cheb2poly

    columns = [cheb2poly(column) for column in series.T]
    padded = [np.pad(each, (0, len(series) - len(each))) for each in columns]
    return np.array(padded).T[::-1].copy()
