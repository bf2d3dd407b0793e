"""Maximum-likelihood fits of the spectrum of a trapped bead."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.optimize import minimize

from tweezer.calibration.spectra import (
    TrappedBead,
    power_spectrum,
    statistical_inefficiency,
    within,
)
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann

#: Highest frequency of a fit of the motion, in units of the roll-off of the spectrum.
_RANGE = 20.0
#: Largest product of the number of ordinates and the squared fraction due to leakage.
_LEAKAGE = 0.1
#: Smallest number of ordinates of a fit.
_LEAST_ORDINATES = 50
#: Number of blocks of a periodogram, evenly spaced in the logarithm of the frequency.
_BLOCKS = 1000

#: First step of a fit, in the logarithm of each parameter.
_FIRST_STEP = 0.2
#: Half the change of a coordinate for computing a derivative.
_DIFFERENCE = 1e-4
#: Largest step of Fisher's scoring, in each coordinate.
_LONGEST = 1.0
#: Largest number of steps of Fisher's scoring.
_MOST_STEPS = 60
#: Initial damping of its steps, and the damping at which it gives up.
_DAMPING = (1e-3, 1e9)
#: Standard uncertainties above which a detector parameter is detected, and of its upper limit.
_SEEN, _BOUND = 4.0, 2.0

#: Parameters of a fit of the motion alone.
STIFFNESS = ("stiffness",)
MOTION = ("stiffness", "drag")


class Coordinate(NamedTuple):
    """Transformation of a bead's parameter to the coordinate in which a fit varies it.

    The likelihood is a smooth function of the coordinate up to the ends of the parameter.
    """

    of: Callable[[TrappedBead, Periodogram], float]
    """function from a bead and a periodogram to the coordinate"""
    to: Callable[[float, Periodogram], float | None]
    """function from the coordinate and a periodogram to the parameter, in SI"""
    ends: tuple[float, float]
    """smallest and largest coordinate"""


def _logarithm(name: str) -> Coordinate:
    """Return the coordinate of a positive parameter of `TrappedBead`: its logarithm."""
    return Coordinate(
        lambda bead, _: math.log(getattr(bead, name)), lambda x, _: math.exp(x), (-600.0, 600.0)
    )


COORDINATES = {
    "stiffness": _logarithm("stiffness"),
    "drag": _logarithm("drag"),
    "response": _logarithm("response"),
    # (exposure/step)^2, to which the power that a short exposure removes is proportional
    "exposure": Coordinate(
        lambda bead, by: (bead.exposure / by.step) ** 2,
        lambda x, by: math.sqrt(x) * by.step,
        (0.0, 1.0),
    ),
    # (f_Nyquist/f_3)^2, to which the power that a fast diode of frequency f_3 removes is
    # proportional
    "diode_frequency": Coordinate(
        lambda bead, by: (0.5 / by.step / (bead.diode_frequency or math.inf)) ** 2,
        lambda x, by: 0.5 / by.step / math.sqrt(x) if x else None,
        (0.0, 1e8),
    ),
    "diode_fraction": Coordinate(
        lambda bead, _: bead.diode_fraction**2, lambda x, _: math.sqrt(x), (0.0, 1.0)
    ),
    # density of the white noise over the density at the highest frequencies
    "noise": Coordinate(
        lambda bead, by: 2 * by.step * bead.noise**2 / by.floor,
        lambda x, by: math.sqrt(x * by.floor / (2 * by.step)),
        (0.0, 1e8),
    ),
}


#: Coordinates at which an upper limit is meaningless, because larger values are impossible.
_TRIVIAL = {"exposure": 1.0, "diode_fraction": 1.0}


class Evidence(Protocol):
    """Measured number with a Gaussian uncertainty, used in a fit in addition to the spectrum."""

    def misfit(self, bead: TrappedBead) -> float:
        """Return the deviation from the expected number for a bead, in standard uncertainties."""
        ...

    def per(self, response: float) -> Evidence:
        """Return the evidence for the signal divided by `response`, V/m or a number."""
        ...


@dataclass(frozen=True)
class Periodogram:
    """Periodogram of a record, averaged over blocks in which the spectrum is nearly constant.

    Its ordinates are the densities at the Fourier frequencies. For a signal in V, densities are in
    V^2/Hz.
    """

    frequencies: Array
    """(blocks,) mean frequency of each block, Hz"""
    density: Array
    """(blocks,) mean one-sided power spectral density of each block, m^2/Hz"""
    counts: Array
    """(blocks,) number of ordinates in each block"""
    step: float
    """sampling interval, s"""
    samples: float
    """number of samples of the record; infinite to ignore leakage"""
    floor: float
    """density at the highest frequencies of the record, m^2/Hz, the unit of the noise density"""
    ends: Array
    """(blocks, 2) frequencies of the lowest and the highest ordinate of each block, Hz"""
    ordinates: Array
    """(ordinates,) density at every Fourier frequency of the record, m^2/Hz"""
    without: tuple[tuple[float, float], ...] = ()
    """bands of frequencies, Hz, whose ordinates are excluded"""
    beside: tuple[Evidence, ...] = ()
    """further measured numbers that a fit uses"""

    @classmethod
    def of(
        cls, positions: Array, step: float, without: Sequence[tuple[float, float]] = ()
    ) -> Periodogram:
        """Return the periodogram of `positions` (n,), m, sampled every `step`, s.

        `without` contains the bands, Hz, whose ordinates are excluded.
        """
        n = (len(positions) - 1) // 2
        edges = np.unique(np.geomspace(1, n + 1, min(_BLOCKS, n)).astype(int)) - 1
        starts = np.arange(n) if n <= _BLOCKS else edges[:-1]
        spectrum = power_spectrum(positions, step)
        return cls.in_blocks(spectrum, starts, step, len(positions), without)

    @classmethod
    def in_blocks(
        cls,
        spectrum: tuple[Array, Array],
        starts: NDArray[np.int64],
        step: float,
        samples: int,
        without: Sequence[tuple[float, float]] = (),
    ) -> Periodogram:
        """Return the periodogram of a record in blocks that begin at the ordinates `starts`.

        `spectrum` contains frequencies, Hz, and densities of a record with this number of
        `samples`, taken every `step`, s. `without` is as in `of`.
        """
        frequencies, density = spectrum
        n = frequencies.size
        used = (~within(frequencies, without)).astype(np.float64)
        counts = np.add.reduceat(used, starts)
        kept = counts > 0
        f, mean = (
            np.add.reduceat(values * used, starts)[kept] / counts[kept]
            for values in (frequencies, density)
        )
        ends = frequencies[np.stack([starts, [*(starts[1:] - 1), n - 1]], axis=1)][kept]
        return cls(
            f, mean, counts[kept], step, samples, float(mean[-1]), ends, density,
            tuple(without),
        )  # fmt: skip

    def __getitem__(self, part: slice | NDArray[np.bool_]) -> Periodogram:
        return dataclasses.replace(
            self,
            frequencies=self.frequencies[part],
            density=self.density[part],
            counts=self.counts[part],
            ends=self.ends[part],
        )

    @cached_property
    def covered(self) -> tuple[Array, Array]:
        """Frequencies, Hz, and densities, m^2/Hz, of the single ordinates in the blocks."""
        duration = self.samples * self.step
        index = np.rint(self.ends * duration).astype(np.int64)
        gaps = np.flatnonzero(index[1:, 0] > index[:-1, 1] + 1)
        runs = zip(index[[0, *(gaps + 1)], 0], index[[*gaps, -1], 1], strict=True)
        inside = np.concatenate([np.arange(first, last + 1) for first, last in runs])
        frequencies = inside / duration
        if self.without:
            kept = ~within(frequencies, self.without)
            inside, frequencies = inside[kept], frequencies[kept]
        return frequencies, self.ordinates[inside - 1]

    def per(self, response: float) -> Periodogram:
        """Return the periodogram of the signal divided by `response`, V/m or a number."""
        return dataclasses.replace(
            self,
            density=self.density / response**2,
            floor=self.floor / response**2,
            ordinates=self.ordinates / response**2,
            beside=tuple(each.per(response) for each in self.beside),
        )

    def expected(self, bead: TrappedBead) -> Array:
        """Return the expected density for a record of `bead`, (blocks,) m^2/Hz."""
        return bead.sampled_spectrum(self.frequencies, self.step, self.samples)

    def log_likelihood(self, bead: TrappedBead) -> float:
        """Return the log-likelihood of a bead, for exponentially distributed ordinates.

        It includes the further evidence (P. Whittle, Ark. Mat. 2, 423 (1953)).
        """
        try:
            with np.errstate(all="raise", under="ignore"):
                expected = self.expected(bead)
                squares = sum(each.misfit(bead) ** 2 for each in self.beside)
        except ArithmeticError:
            return -math.inf
        if not (expected > 0).all():  # rounding errors, far from any real bead
            return -math.inf
        return -float(self.counts @ (np.log(expected) + self.density / expected)) - squares / 2

    def at(
        self, bead: TrappedBead, free: Sequence[str], coordinates: Sequence[float] | Array
    ) -> TrappedBead:
        """Return `bead` with its parameters `free` at other `coordinates` (free,)."""
        changed = {
            name: COORDINATES[name].to(float(x), self)
            for name, x in zip(free, coordinates, strict=True)
        }
        return dataclasses.replace(bead, **changed)  # type: ignore[arg-type]

    def coordinates(self, bead: TrappedBead, free: Sequence[str]) -> Array:
        """Return the coordinates of a bead's parameters `free`, (free,)."""
        return np.array([COORDINATES[name].of(bead, self) for name in free])

    def differences(
        self, of: Callable[[TrappedBead], Array], bead: TrappedBead, free: Sequence[str]
    ) -> Array:
        """Return the derivatives of a function of a bead with respect to coordinates, (free, ...).

        They are central differences, or one-sided at the end of a coordinate's range.
        """
        here, slopes = self.coordinates(bead, free), []
        with np.errstate(all="raise", under="ignore"):
            for i, name in enumerate(free):
                ends = np.clip(here[i] + _DIFFERENCE * np.array([-1, 1]), *COORDINATES[name].ends)
                below, above = (
                    of(self.at(bead, free, [*here[:i], end, *here[i + 1 :]])) for end in ends
                )
                slopes.append((above - below) / (ends[1] - ends[0]))
        return np.array(slopes)

    def slopes(self, bead: TrappedBead, free: Sequence[str]) -> Array:
        """Return the derivatives of the log of the expected density, (free, blocks)."""
        return self.differences(lambda each: np.log(self.expected(each)), bead, free)

    def slopes_beside(self, bead: TrappedBead, free: Sequence[str]) -> Array:
        """Return the derivatives of the misfits of the further evidence, (free, evidence)."""

        def misfits(each: TrappedBead) -> Array:
            return np.array([one.misfit(each) for one in self.beside])

        return self.differences(misfits, bead, free)


@dataclass(frozen=True)
class WhittleFit:
    """Bead whose spectrum fits a periodogram best, with the uncertainties of its parameters."""

    bead: TrappedBead
    periodogram: Periodogram
    """the fitted periodogram"""
    free: tuple[str, ...]
    """names of the fitted parameters"""

    @cached_property
    def log_likelihood(self) -> float:
        """Log-likelihood, for comparison with other fits of the same ordinates."""
        return self.periodogram.log_likelihood(self.bead)

    @cached_property
    def ratios(self) -> Array:
        """(ordinates,) measured spectral density divided by the fitted one, at each frequency.

        If the model is correct, the ratios are independent and exponentially distributed with mean
        1. They are not averaged over the blocks of frequencies.
        """
        part = self.periodogram
        frequencies, density = part.covered
        return density / self.bead.sampled_spectrum(frequencies, part.step, part.samples)

    @cached_property
    def slopes(self) -> Array:
        """Derivatives of ln S, with the expected density S, by the coordinates, (free, blocks)."""
        return self.periodogram.slopes(self.bead, self.free)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the coordinates, (free, free), by Fisher's information."""
        information = (self.slopes * self.periodogram.counts) @ self.slopes.T
        if self.periodogram.beside:
            beside = self.periodogram.slopes_beside(self.bead, self.free)
            information = information + beside @ beside.T
        return inverse(information)

    def per(self, response: float) -> WhittleFit:
        """Return this fit for the signal divided by `response`, V/m or a number."""
        part = self.periodogram
        return WhittleFit(
            dataclasses.replace(
                self.bead, response=self.bead.response / response, noise=self.bead.noise / response
            ),
            part.per(response),
            self.free,
        )

    def uncertainty(self, k: float, drag: float, response: float = 0.0) -> float:
        """Return the standard uncertainty of a weighted sum of logarithms of fitted parameters.

        `k`, `drag` and `response` are the weights of the logarithms of stiffness, drag and
        response. For example, (1, -1) gives the relative uncertainty of the corner frequency.
        """
        weights = {"stiffness": k, "drag": drag, "response": response}
        of_free = np.array([weights.get(name, 0.0) for name in self.free])
        return math.sqrt(of_free @ self.covariance @ of_free)

    def _gain(self, name: str) -> float:
        """Return the gain in log-likelihood by a detector parameter, over a fit without it."""
        without: dict[str, float | None] = {name: 0.0}
        if name == "diode_frequency":
            without = {name: None, "diode_fraction": 0.0}
        bead = dataclasses.replace(self.bead, **without)  # type: ignore[arg-type]
        free = tuple(each for each in self.free if each not in without)
        return self.log_likelihood - fitted(self.periodogram, bead, free).log_likelihood

    def detected(self, name: str) -> Detected:
        """Return a fitted parameter of the detector, with its uncertainty and its limit."""
        coordinate, i = COORDINATES[name], self.free.index(name)
        x, error = coordinate.of(self.bead, self.periodogram), math.sqrt(self.covariance[i, i])
        value = coordinate.to(x, self.periodogram)
        seen = x > _SEEN * error and self._gain(name) > _SEEN**2 / 2
        uncertainty = value * error / (2 * x) if seen and value else None
        highest, end = x + _BOUND * error, _TRIVIAL.get(name, math.inf)
        if name == "noise":  # at most the whole density at the highest frequencies
            highest = min(highest, 1.0)
        limit = coordinate.to(highest, self.periodogram) if highest < end else None
        if name == "diode_frequency" and limit is not None and limit < self.bead.corner_frequency:
            limit = None
        return Detected(name, value if seen else None, uncertainty, limit)


@dataclass(frozen=True)
class Detected:
    """Fitted parameter of the detector."""

    name: str
    """"exposure" (s), "diode_frequency" (Hz), "diode_fraction" or "noise" (m)"""
    value: float | None
    """fitted value; None if the record does not determine it"""
    uncertainty: float | None
    """standard uncertainty of `value`; None if not determined"""
    limit: float | None
    """95 % limit beyond which the effect would be visible: an upper limit, or a lower limit for a
    frequency; None without a limit"""


def inverse(information: Array) -> Array:
    """Return the covariance (n, n) of parameters from Fisher's information (n, n) on them.

    A parameter without information gets an uncertainty of 10^6.
    """
    values, vectors = eigh(information)
    return np.asarray((vectors / np.maximum(values, 1e-12)) @ vectors.T)


def fitted(
    periodogram: Periodogram, start: TrappedBead, free: tuple[str, ...], tolerance: float = 1e-4
) -> WhittleFit:
    """Return the maximum-likelihood fit of some parameters of a bead.

    Fits of stiffness and drag alone use the simplex method, all others Fisher's scoring.

    Parameters
    ----------
    periodogram : Periodogram
        Periodogram of the positions.
    start : TrappedBead
        Start of the fit.
    free : tuple of str
        Names of the fitted parameters.
    tolerance : float, optional
        Tolerance of the coordinates. A tenth of it applies to the log-likelihood.
    """
    if not set(free) <= set(MOTION) or periodogram.beside:
        return _scored(periodogram, start, free, tolerance)
    first = periodogram.coordinates(start, free)
    found = minimize(
        lambda coordinates: -periodogram.log_likelihood(periodogram.at(start, free, coordinates)),
        first,
        method="Nelder-Mead",
        options={
            "xatol": tolerance, "fatol": tolerance / 10,
            "initial_simplex": first + _FIRST_STEP * np.eye(len(free) + 1, len(free), -1),
        },
    ).x  # fmt: skip
    return WhittleFit(periodogram.at(start, free, found), periodogram, free)


def _scored(
    periodogram: Periodogram, start: TrappedBead, free: tuple[str, ...], tolerance: float
) -> WhittleFit:
    """Return the fit of the parameters `free` by Fisher's scoring, starting at `start`."""

    def likelihood(coordinates: Array) -> float:
        return periodogram.log_likelihood(periodogram.at(start, free, coordinates))

    def ascent(coordinates: Array) -> tuple[Array, Array]:
        bead = periodogram.at(start, free, coordinates)
        ratio = periodogram.density / periodogram.expected(bead) - 1
        slopes = periodogram.slopes(bead, free)
        weighted = slopes * periodogram.counts
        upward, information = weighted @ ratio, weighted @ slopes.T
        if periodogram.beside:
            beside = periodogram.slopes_beside(bead, free)
            upward -= beside @ np.array([each.misfit(bead) for each in periodogram.beside])
            information += beside @ beside.T
        return upward, information

    ends = np.array([COORDINATES[name].ends for name in free]).T
    here = scored(periodogram.coordinates(start, free), ends, likelihood, ascent, tolerance)
    return WhittleFit(periodogram.at(start, free, here), periodogram, free)


def scored(
    start: Array,
    ends: Array,
    likelihood: Callable[[Array], float],
    ascent: Callable[[Array], tuple[Array, Array]],
    tolerance: float = 1e-4,
) -> Array:
    """Return the coordinates (n,) of largest likelihood, by Fisher's scoring.

    Steps are damped as in the Levenberg-Marquardt method, and stay within the ranges of the
    coordinates. The fit ends when a step increases the log-likelihood by less than a tenth of
    `tolerance`.

    Parameters
    ----------
    start : ndarray, shape (n,)
        Coordinates at which the fit starts.
    ends : ndarray, shape (2, n)
        Smallest and largest coordinates.
    likelihood : callable
        Function from coordinates to the log-likelihood.
    ascent : callable
        Function from coordinates to its gradient (n,) and to Fisher's information (n, n).
    tolerance : float, optional
        Tolerance of the coordinates. A tenth of it applies to the log-likelihood.
    """
    low, high = ends
    here, damping = start, _DAMPING[0]
    best = likelihood(here)
    for _ in range(_MOST_STEPS):
        upward, information = ascent(here)
        inside = ~(((here <= low) & (upward < 0)) | ((here >= high) & (upward > 0)))
        if not inside.any():
            break
        scale = np.diag(np.diag(information) + 1e-12)[np.ix_(inside, inside)]
        while damping < _DAMPING[1]:
            matrix = information[np.ix_(inside, inside)] + damping * scale
            step = np.zeros(len(start))
            step[inside] = np.clip(np.linalg.solve(matrix, upward[inside]), -_LONGEST, _LONGEST)
            there = np.clip(here + step, low, high)
            gain = likelihood(there) - best
            if gain >= 0:
                break
            damping *= 10
        else:
            break
        small = gain < tolerance / 10 and bool(np.abs(there - here).max() < 100 * tolerance)
        here, best, damping = there, best + gain, max(damping / 10, 1e-12)
        if small:
            break
    return here


def usable(
    periodogram: Periodogram, start: TrappedBead, *, to_the_end: bool = False
) -> Periodogram:
    """Return the low-frequency part of a periodogram that a fit starting at `start` should use.

    It ends at 20 times the roll-off of the spectrum, above which the bead hardly moves, or at
    the Nyquist frequency if `to_the_end`. It ends earlier where spectral leakage, the power from
    other frequencies in a finite recording, exceeds the noise of the sum of the ordinates, because
    leakage correlates the ordinates.
    """
    sampled = start.sampled_spectrum(periodogram.frequencies, periodogram.step)
    leakage = periodogram.expected(start) / sampled - 1
    before = np.cumsum(periodogram.counts) - 1
    leaking = np.flatnonzero(before * leakage**2 > _LEAKAGE)
    highest = math.inf if to_the_end else _RANGE * start.roll_off
    within = int((periodogram.frequencies <= highest).sum())
    least = int(np.searchsorted(before, _LEAST_ORDINATES - 1)) + 1
    return periodogram[: max(min(within, *leaking[:1], before.size), least)]


def best_start(periodogram: Periodogram, positions: Array, given: TrappedBead) -> TrappedBead:
    """Return the bead from which a fit starts, the most probable of a few.

    They are an overdamped and, with a mass, an underdamped bead. Their stiffness and drag follow
    from the variance and correlation time of `positions` (n,), m, or from the spectral peak.
    `given` has the temperature, mass and exposure, and the drag, which is NaN if unknown.
    """
    kT = Boltzmann * given.temperature
    k = float(kT / np.var(positions))
    # Relaxation time, s. Squares decay twice as fast, but the inefficiency counts both directions
    # of time. For an underdamped bead the time is m/beta.
    memory = periodogram.step * statistical_inefficiency((positions - positions.mean()) ** 2)
    starts = [dataclasses.replace(given, stiffness=k, drag=k * memory)]
    if given.mass is not None:
        peak = periodogram.frequencies[periodogram.density.argmax()]
        ringing = given.mass * (2 * math.pi * peak) ** 2
        starts.append(dataclasses.replace(given, stiffness=ringing, drag=given.mass / memory))
    if not math.isnan(given.drag):
        starts += [dataclasses.replace(start, drag=given.drag) for start in starts]
    return max(starts, key=periodogram.log_likelihood)
