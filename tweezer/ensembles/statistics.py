"""Running statistics of an ensemble, in memory independent of trajectories and time.

The moments of values x are stored as [n, mean, M2, ...]: the number of values, their mean, and the
sums M_p of (x - mean)^p. The moments of two sets are joined by the formulas of Pebay (Sandia report
SAND2008-6212), which avoid cancellation. Joining in the same order gives the same bits.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.fft import prev_fast_len

from tweezer.dynamics.layout import QUANTITIES
from tweezer.values.arrays import Array

#: Largest number of samples in a window of a spectrum
WINDOW = 2**14
#: Largest number of times at which moments over the trajectories are computed
_TIMES = 10_000
#: Number of histogram bins between -loss_distance and +loss_distance, where beads count as lost
_BINS = 2**15
#: Number of lags of the mean-square displacement per decade
_LAGS = 10
#: Number of values processed at a time, which fit the processor's cache
_CACHED = 2**16


def moments(values: Array, order: int) -> Array:
    """Return the moments [n, mean, M2, ..., M_order] of values (n, ...) over their first axis.

    The result has the shape (order + 1, ...). M_p is the sum of (x - mean)^p, and NaN are excluded.
    """
    whole = np.empty((order + 1, *values.shape[1:]))
    valid = ~np.isnan(values)
    where: Any = True if valid.all() else valid
    whole[0] = valid.sum(axis=0)
    near = np.nan_to_num(np.fmin.reduce(values))  # shift, so that the variance of equal values is 0
    off = values - near
    mean = off.sum(axis=0, where=where) / np.maximum(whole[0], 1)
    whole[1] = near + mean
    off -= mean
    power = off.copy()
    for p in range(2, order + 1):
        power *= off
        power.sum(axis=0, where=where, out=whole[p])
    return whole


def joined(a: Array, b: Array) -> Array:
    """Combine the `moments` of two sets of values.

    Moments up to order 2 or 4 are supported. The moments of an empty set are all 0.
    """
    na, nb = a[0], b[0]
    n = np.maximum(na + nb, 1)
    fa, fb = na / n, nb / n
    apart = b[1] - a[1]
    whole = a + b
    whole[1] = a[1] + apart * fb
    whole[2] += apart**2 * na * fb
    if len(a) > 3:
        whole[3] += apart**3 * na * fb * (fa - fb) + 3 * apart * (fa * b[2] - fb * a[2])
        whole[4] += (
            apart**4 * na * fb * (fa**2 - fa * fb + fb**2)
            + 6 * apart**2 * (fa**2 * b[2] + fb**2 * a[2])
            + 4 * apart * (fa * b[3] - fb * a[3])
        )
    return whole


def error_of_part(part: float, number: int) -> float:
    """Return the standard error of a fraction `part` measured with `number` beads.

    It is half the width of E. B. Wilson's interval for one standard deviation, which is above 0
    even if the fraction is 0 or 1.
    """
    return math.sqrt(part * (1 - part) / number + 1 / (4 * number**2)) / (1 + 1 / number)


@dataclass(frozen=True)
class Plan:
    """Plan of an ensemble's statistics: which quantities to average, over which samples."""

    times: Array
    """(samples,) times of the samples, s, evenly spaced"""
    quantities: dict[str, slice]
    """columns of a sample by quantity: "position" and, if the model has them, "velocity" and
    "angular_velocity" """
    skipped: int
    """number of first samples that enter only the moments over time"""
    reach: float
    """half the width of the histogram, m"""
    origin: tuple[float, ...]
    """reference point near the beads, m, subtracted before squaring to avoid cancellation"""
    displacements: bool
    """whether displacements between samples are physical; otherwise msd and psd are omitted"""
    beads: tuple[str, ...] = ()
    """names of several beads, whose positions follow each other in the columns of a sample"""

    @property
    def axes(self) -> int:
        """Number of columns of the positions of all beads."""
        return len(self.origin)

    @property
    def window(self) -> int:
        """Number of samples in a window for spectra and mean-square displacements.

        The samples after `skipped` are divided into equal windows of at most 2^14 samples. The
        length is rounded down to one for which Fourier transforms are fast.
        """
        left = len(self.times) - self.skipped
        return int(prev_fast_len(left // math.ceil(left / WINDOW), real=True))

    @property
    def cuts(self) -> list[int]:
        """Boundaries between windows of samples, at which the statistics are accumulated.

        These are the index of the first sample of each window, also of the windows in the skipped
        part, followed by the total number of samples.
        """
        end = len(self.times)
        before = range(0, self.skipped, WINDOW)
        within = range(self.skipped, end - self.window + 1, self.window)
        return sorted({*before, *within, within[-1] + self.window, end})

    @property
    def every(self) -> int:
        """Interval, in samples, between samples at which moments over trajectories are computed."""
        return math.ceil(len(self.times) / _TIMES)

    @property
    def lags(self) -> NDArray[np.int64]:
        """Lags of the mean-square displacement, in samples, evenly spaced in the logarithm.

        They extend to half a window.
        """
        most = self.window // 2
        number = 1 + math.ceil(_LAGS * math.log10(most)) if most > 1 else 1
        return np.unique(np.geomspace(1, most, number).round().astype(np.int64))


class Statistics:
    """Statistics of some of the trajectories, accumulated block by block.

    A block is a group of trajectories, a window a group of successive samples. `moments` contains
    arrays as returned by the function `moments`, and `sums` contains quantities that are added,
    such as histogram counts and numbers of samples lost.
    """

    def __init__(self, plan: Plan) -> None:
        """Start without trajectories, with all arrays zero."""
        self.plan = plan
        kept, lags, axes = -(-len(plan.times) // plan.every), len(plan.lags), plan.axes
        # moments to order 4, (5, times, columns), and to order 2, (3, axes, numbers)
        self.moments = {
            name: np.zeros((5, kept, columns.stop - columns.start))
            for name, columns in plan.quantities.items()
        }
        self.moments |= {
            # over windows, for each axis: the window averages u of x and v of x^2, and u v
            "average": np.zeros((3, axes, 3)),
        }
        if plan.displacements:
            self.moments["msd"] = np.zeros((3, axes, lags))
            self.moments["psd"] = np.zeros((3, axes, plan.window // 2))
        self.sums = {
            "counts": np.zeros((_BINS, axes)),
            # over blocks: squares of counts, products of counts and samples, squares of samples
            "counts_squared": np.zeros((_BINS, axes)),
            "counts_samples": np.zeros((_BINS, axes)),
            "samples_squared": np.zeros(1),
            "samples": np.zeros(1),
            "blocks": np.zeros(1),
            "windows_lost": np.zeros(1),
            "samples_lost": np.zeros(1),
            "trajectories_lost": np.zeros(1),
            "trajectories": np.zeros(1),
        }

    def arrays(self) -> dict[str, Array]:
        """Return all arrays by name, for a checkpoint."""
        return self.moments | self.sums

    @classmethod
    def of(cls, plan: Plan, arrays: Mapping[str, Array]) -> Self:
        """Return the statistics from the arrays that `arrays` returned."""
        made = cls(plan)
        for group in (made.moments, made.sums):
            group.update((name, arrays[name]) for name in group)
        return made

    def add_piece(self, first: int, samples: Array) -> None:
        """Add samples (trajectories, samples, columns) to the moments over the trajectories.

        Samples of several beads are (trajectories, samples, beads, columns). `first` is the index
        of the first of these samples. A `Statistics` is given each sample of its trajectories once,
        until its block is closed.
        """
        every = self.plan.every
        samples = samples.reshape(*samples.shape[:2], -1)
        kept, samples = -(-first // every), samples[:, -first % every :: every]
        if not samples.size:
            return
        length = max(1, _CACHED // samples[:, 0].size)
        for i in range(0, samples.shape[1], length):
            some = np.ascontiguousarray(samples[:, i : i + length])
            found = moments(some.reshape(len(some), -1), 4).reshape(5, -1, some.shape[2])
            at = slice(kept + i, kept + i + some.shape[1])
            for name, columns in self.plan.quantities.items():
                self.moments[name][:, at] = found[..., columns]

    def add_window(self, first: int, position: Array) -> None:
        """Add a window to all statistics over time: histogram, averages, displacements, spectrum.

        `position` is (trajectories, samples, 3), m, or (trajectories, samples, beads, 3). It is NaN
        after a loss. `first` is the index of its first sample.
        """
        plan = self.plan
        position = position.reshape(*position.shape[:2], -1)
        lost = np.isnan(position[..., 0])
        self.sums["samples_lost"] += lost.sum()
        if first < plan.skipped:
            return
        self._count(position[~lost] if lost.any() else position.reshape(-1, plan.axes))
        if position.shape[1] == plan.window:
            whole = ~lost[:, -1]
            self.sums["windows_lost"] += (~whole).sum()
            if whole.any():
                self._add_windows(position[whole])

    def _count(self, position: Array) -> None:
        """Add positions (n, axes), m, to the histogram."""
        for axis in range(self.plan.axes):
            bins = ((position[:, axis] / self.plan.reach + 1) * (_BINS / 2)).astype(np.int64)
            self.sums["counts"][:, axis] += np.bincount(
                np.clip(bins, 0, _BINS - 1), minlength=_BINS
            )
        self.sums["samples"] += len(position)

    def _add_windows(self, position: Array) -> None:
        """Add windows of positions without a loss, (n, samples of a window, axes), m."""
        step = self.plan.times[1] - self.plan.times[0]
        together = max(1, _CACHED // position[0].size)
        for i in range(0, len(position), together):
            some = (position[i : i + together] - self.plan.origin).swapaxes(1, 2)
            some = np.ascontiguousarray(some)
            mean, square = some.mean(axis=2), np.square(some).mean(axis=2)
            found = {"average": np.stack([mean, square, mean * square], axis=2)}
            if self.plan.displacements:
                found["msd"] = _msd(some, self.plan.lags)
                found["psd"] = _psd(some - mean[..., None], step)
            for name, values in found.items():
                self.moments[name] = joined(self.moments[name], moments(values, 2))

    def close(self, lost_time: Array) -> None:
        """Complete a block, after all its windows were added, by computing the sums over blocks.

        `lost_time` (trajectories,) is in s, and infinite for a bead that was not lost.
        """
        sums = self.sums
        sums["counts_squared"] = sums["counts"] ** 2
        sums["counts_samples"] = sums["counts"] * sums["samples"]
        sums["samples_squared"] = sums["samples"] ** 2
        sums["blocks"] += 1
        sums["trajectories"] += len(lost_time)
        sums["trajectories_lost"] += np.isfinite(lost_time).sum()

    def join(self, other: Statistics) -> Statistics:
        """Return the statistics of the trajectories of both, whose blocks must all be closed."""
        moments = {name: joined(self.moments[name], other.moments[name]) for name in self.moments}
        sums = {name: self.sums[name] + other.sums[name] for name in self.sums}
        return Statistics.of(self.plan, moments | sums)

    def dataset(self) -> xr.Dataset:
        """Return the statistics as a dataset, with errors; `tweezer.ensemble` describes it."""
        plan = self.plan
        times = plan.times[:: plan.every]
        dataset = xr.Dataset(
            coords={
                "time": ("time", times, _about("s", "time since release")),
            }
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            for name in plan.quantities:
                about = QUANTITIES[name]
                self._put_moments(dataset, name, ("time", about.dimension), about.unit)
            self._put_averages(dataset)
            self._put_histogram(dataset)
            if plan.displacements:
                self._put_displacements(dataset)
            else:
                dataset.attrs["comment"] = (
                    "msd and psd left out: the method's displacements from step to step are not "
                    "those of the motion"
                )
        left = self.moments["position"][0, :, 0]
        dataset["trajectories_left"] = ("time", left, _about("1", "trajectories not yet lost"))
        for name, long_name in (
            ("trajectories", "trajectories"),
            ("trajectories_lost", "trajectories lost before the end"),
            ("samples_lost", "samples after a loss, in none of the statistics"),
            ("windows_lost", "windows not used, because the bead was lost in or before them"),
        ):
            dataset[name] = ((), self.sums[name][0], _about("1", long_name))
        dataset["windows"] = ((), self.moments["average"][0].max(), _about("1", "windows used"))
        if len(plan.beads) > 1:
            columns = dataset.rename(axis="column").coarsen(column=3)
            dataset = columns.construct(column=("bead", "axis"))
            dataset.coords["bead"] = "bead", list(plan.beads), {"long_name": "name of the bead"}
        dataset.coords["axis"] = "axis", *QUANTITIES["position"].coordinate
        return dataset

    def _put_moments(
        self, dataset: xr.Dataset, name: str, dimensions: tuple[str, str], unit: str
    ) -> None:
        """Add mean, variance, skewness and excess kurtosis over the trajectories to a dataset.

        `name` and `unit` describe the quantity, and `dimensions` are those of each array.
        """
        count, mean, m2, m3, m4 = self.moments[name]
        count, mean = np.where(count > 0, [count, mean], np.nan)
        variance, fourth = m2 / (count - 1), m4 / count
        of_mean = np.sqrt(variance / count)
        of_variance = np.sqrt((fourth - variance**2 * (count - 3) / (count - 1)) / count)
        over = f"of the {name.replace('_', ' ')} over the trajectories"
        square = f"({unit})^2" if "/" in unit else f"{unit}^2"
        _put(dataset, f"{name}_mean", dimensions, mean, of_mean, unit, f"mean {over}",
             "trajectories")  # fmt: skip
        _put(dataset, f"{name}_variance", dimensions, variance, of_variance, square,
             f"variance {over}", "trajectories")  # fmt: skip
        dataset[f"{name}_skewness"] = (
            dimensions, m3 / count / (m2 / count) ** 1.5, _about("1", f"skewness {over}"),
        )  # fmt: skip
        dataset[f"{name}_kurtosis"] = (
            dimensions, fourth / (m2 / count) ** 2 - 3, _about("1", f"excess kurtosis {over}"),
        )  # fmt: skip

    def _put_averages(self, dataset: xr.Dataset) -> None:
        """Add mean and variance of the position over all samples of the windows to a dataset.

        Errors follow from the scatter among windows. In the code, u and v are window averages of x
        and x^2, averaged over windows like their product uv; u2 and v2 are the sums of squared
        deviations of u and v.
        """
        count, (u, v, uv), (u2, v2, _) = self.moments["average"].swapaxes(1, 2)
        n = count[0]
        mean_error2 = u2 / (n - 1) / n
        variance = v - u**2 + mean_error2
        covariance = (uv - u * v) * n / (n - 1)
        error2 = (v2 / (n - 1) + 4 * u**2 * u2 / (n - 1) - 4 * u * covariance) / n
        mean = np.where(n > 0, u + self.plan.origin, np.nan)
        _put(dataset, "stationary_mean", ("axis",), mean, np.sqrt(mean_error2), "m",
             "mean of the position over trajectories and time", "windows")  # fmt: skip
        _put(dataset, "stationary_variance", ("axis",), variance,
             np.sqrt(np.maximum(error2, 0)), "m^2",
             "variance of the position over trajectories and time", "windows")  # fmt: skip

    def _put_displacements(self, dataset: xr.Dataset) -> None:
        """Add mean-square displacement and spectrum, with errors from the scatter of windows."""
        plan = self.plan
        step = plan.times[1] - plan.times[0]
        frequency = np.fft.rfftfreq(plan.window, step)[1:]
        dataset.coords["lag"] = ("lag", plan.lags * step, _about("s", "lag"))
        dataset.coords["frequency"] = ("frequency", frequency, _about("Hz", "frequency"))
        for name, dimension, unit, long_name in (
            ("msd", "lag", "m^2", "mean-square displacement"),
            ("psd", "frequency", "m^2/Hz", "one-sided power spectral density"),
        ):
            count, mean, m2 = self.moments[name]
            error = np.sqrt(m2 / (count - 1) / count)
            _put(dataset, name, ("axis", dimension), mean, error, unit, long_name, "windows")

    def _put_histogram(self, dataset: xr.Dataset) -> None:
        """Add counts and density of the position to a dataset, over the range of bins in use.

        The error of the ratio of counts to samples follows from the scatter among blocks (Cochran,
        Sampling Techniques, 2.11).
        """
        sums, width = self.sums, 2 * self.plan.reach / _BINS
        filled = np.flatnonzero(sums["counts"].any(axis=1))
        held = slice(filled[0], filled[-1] + 1) if len(filled) else slice(0)
        counts, squared, mixed = (
            sums[name][held] for name in ("counts", "counts_squared", "counts_samples")
        )
        samples, blocks = sums["samples"], sums["blocks"]
        part = counts / samples
        scatter = squared - 2 * part * mixed + part**2 * sums["samples_squared"]
        scatter *= blocks / np.where(blocks > 1, blocks - 1, np.nan)
        error = np.sqrt(np.maximum(scatter, 0)) / samples
        centres = (np.arange(_BINS)[held] + 0.5) * width - self.plan.reach
        dataset.coords["bin"] = ("bin", centres, _about("m", "centre of the bin"))
        dataset["counts"] = (("bin", "axis"), counts, _about("1", "samples in the bin"))
        _put(dataset, "density", ("bin", "axis"), part / width, error / width, "1/m",
             "probability density of the position", "blocks of trajectories")  # fmt: skip


def _msd(position: Array, lags: NDArray[np.int64]) -> Array:
    """Return the mean-square displacement (..., lags), m^2, in windows of positions (..., samples).

    `lags` are in samples. Displacements begin half a lag apart, because more of them would overlap
    and add little information.
    """
    displaced = np.empty((*position.shape[:-1], len(lags)))
    for j, lag in enumerate(lags):
        between = max(1, lag // 2)
        step = position[..., lag::between] - position[..., :-lag:between]
        displaced[..., j] = np.einsum("...t,...t->...", step, step) / step.shape[-1]
    return displaced


def _psd(position: Array, step: float) -> Array:
    """Return the one-sided power spectral density, m^2/Hz, at the frequencies above 0.

    `position` (..., samples), m, contains windows with the mean 0, and `step` is the sampling
    interval, s.
    """
    samples = position.shape[-1]
    amplitude = np.fft.rfft(position)[..., 1:]
    power = np.square(amplitude.real)
    power += np.square(amplitude.imag)
    power *= 2 * step / samples
    if samples % 2 == 0:
        power[..., -1] /= 2  # the Nyquist frequency has no separate negative frequency
    return power


def _put(
    dataset: xr.Dataset, name: str, dimensions: tuple[str, ...], value: Array, error: Array,
    unit: str, long_name: str, over: str,
) -> None:  # fmt: skip
    """Add a quantity `name` and its standard error, `name`_error, to a dataset.

    `over` names the independent parts whose scatter gives the error, such as "windows".
    """
    dataset[name] = (dimensions, value, _about(unit, long_name))
    dataset[name].attrs["ancillary_variables"] = f"{name}_error"
    dataset[f"{name}_error"] = (dimensions, error, _about(unit, f"standard error: {long_name}"))
    for key in (name, f"{name}_error"):
        if np.isnan(dataset[key]).all():
            dataset[key].attrs["comment"] = f"not known: takes at least 2 {over}"


def _about(units: str, long_name: str) -> dict[str, str]:
    """Return the attributes of a variable of a dataset."""
    return {"units": units, "long_name": long_name}
