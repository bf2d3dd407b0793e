"""Orientations of a run or an ensemble: checks, sampling interval, lags, and reading in groups."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.layout import EULER
from tweezer.scene.arguments import numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.units import QuantitiesLike

if TYPE_CHECKING:
    import xarray as xr

#: Number of default lags per decade
_LAGS = 10
#: Longest default lag, as a fraction of the samples
_LONGEST = 1 / 8
#: Number of orientations that are read at a time
_READ = 500_000
#: Relative rounding error of sampling intervals
_ROUNDING = 1e-6
#: Largest deviation of the length of Euler parameters from 1
_LENGTH = 1e-3


@dataclass(frozen=True)
class Samples:
    """Orientations of one body at equal intervals of time, in one trajectory or in several."""

    orientation: xr.DataArray
    """(trajectory, time, euler_parameter), or without the trajectory for a run; NaN after a loss"""
    step: float
    """sampling interval, s"""

    @classmethod
    def of(cls, source: xr.Dataset, name: str, skip: float) -> Self:
        """Return the orientations of a result from `skip`, s, after its first sample.

        `name` is the name of the result in messages. Raises `ResultError` without orientations, or
        with fewer than two at equal intervals.
        """
        if not {"orientation", "time"} <= {*getattr(source, "variables", ())}:
            raise ResultError(
                f"{name}: contains no orientation over time; must be a run, or trajectories of an "
                "ensemble, of a body that rotates"
            )
        orientation, time = source["orientation"], _seconds(source["time"], name)
        over = [*map(str, orientation.dims)]
        if {*over} | {"trajectory"} != {"trajectory", "time", "euler_parameter"}:
            raise ResultError(
                f"{name}: orientation is over ({', '.join(over)}); must be over "
                "(time, euler_parameter) or (trajectory, time, euler_parameter)"
            )
        if orientation.sizes["euler_parameter"] != EULER:
            raise ResultError("orientation: must have 4 Euler parameters, scalar first")
        trajectories = orientation.sizes.get("trajectory")
        if trajectories == 0:
            raise ResultError(f"{name}: contains no trajectory")
        if trajectories == 1:
            orientation = orientation.isel(trajectory=0)
        if not (np.diff(time) > 0).all():
            raise ResultError("time: must increase from sample to sample")
        kept = np.flatnonzero(time - time[:1] >= skip * (1 - _ROUNDING))
        if len(kept) < 2:
            after = f" after skip = {skip:g} s" if skip else ""
            raise ResultError(f"{name}: contains fewer than 2 samples{after}")
        intervals = np.diff(time[kept])
        step = float(intervals[0])
        # a run that ends with an event has its last sample there
        uneven = ~(np.abs(intervals - step) <= _ROUNDING * step + 4 * np.spacing(abs(time[-1])))
        if uneven[:-1].any():
            raise ResultError("time: the sampling interval changes; samples must be evenly spaced")
        kept = kept[:-1] if uneven[-1] else kept
        orientation = orientation.transpose(..., "time", "euler_parameter")
        return cls(orientation.isel(time=slice(int(kept[0]), int(kept[-1]) + 1)), step)

    @property
    def number(self) -> int:
        """Number of samples of a trajectory."""
        return int(self.orientation.sizes["time"])

    @property
    def successive(self) -> bool:
        """Whether there is one trajectory, whose parts are successive blocks of time."""
        return "trajectory" not in self.orientation.dims

    def groups(self) -> Iterator[Array]:
        """Yield Euler parameters (trajectories, time, 4) of length 1, as many as fit the memory.

        Raises `ResultError` if their length differs from 1.
        """
        total = 1 if self.successive else int(self.orientation.sizes["trajectory"])
        at_once = max(1, _READ // self.number)
        for begin in range(0, total, at_once):
            some = self.orientation
            if not self.successive:
                some = some.isel(trajectory=slice(begin, begin + at_once))
            e = np.asarray(some.values, np.float64).reshape(-1, self.number, EULER)
            length = np.linalg.norm(e, axis=-1, keepdims=True)
            if (np.abs(length - 1) > _LENGTH).any():
                raise ResultError("orientation: Euler parameters must have the length 1")
            yield e / length

    def default_lags(self) -> NDArray[np.int64]:
        """Return lags (m,) in samples, evenly spaced in their logarithm."""
        longest = max(1, int(self.number * _LONGEST))
        count = 1 + int(np.ceil(_LAGS * np.log10(longest)))
        return np.unique(np.round(np.geomspace(1, longest, count)).astype(np.int64))

    def lags_at(self, lags: QuantitiesLike) -> NDArray[np.int64]:
        """Return lags, s, in samples, rounded and ascending.

        Raises `ResultError` for a lag outside the record.
        """
        given: Any = np.atleast_1d(numbers_in_si("lags", lags, "s")) / self.step
        longest = self.number - 1
        if given.ndim != 1 or not given.size or not ((given > 0.5) & (given < longest + 0.5)).all():
            raise ResultError(
                f"lags: must be from the sampling interval, {self.step:.3g} s, to "
                f"{longest * self.step:.3g} s"
            )
        return np.unique(np.round(given).astype(np.int64))


def _seconds(time: xr.DataArray, name: str) -> Array:
    """Return times (n,) in s, converted from the unit of a dataset. Raises `ResultError`."""
    if time.dtype.kind not in "fiu":
        raise ResultError(f"{name}: time: must be numbers in s, not {time.dtype}")
    return numbers_in_si(f"{name}: time", time, "s")
