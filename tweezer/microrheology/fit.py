"""Maximum-likelihood fit of one medium to the spectra of a trapped bead along several axes."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tweezer.calibration.whittle import COORDINATES, Periodogram, inverse, scored
from tweezer.microrheology.medium import Medium, ViscoelasticBead
from tweezer.values.arrays import Array

#: Largest number of Maxwell elements of a fit.
MOST = 5
#: Half the change of a coordinate for computing a derivative.
_DIFFERENCE = 1e-4
#: Ratio of an element's viscosity to the mean viscosity, at most and, inverted, at least.
_RATIO = 1e4
#: Shortest relaxation time of an element, in sampling intervals.
_SHORTEST = 0.1
#: Number of relaxation times at which a further element is tried.
_TIMES = 9
#: Viscosities of a further element that are tried, over the steady viscosity.
_STRENGTHS = (0.2, 2.0)
#: Number of trials from which a fit is started, and the tolerance of the first fits.
_STARTS, _ROUGHLY = 3, 1e-2
#: Initial value of the noise, over the density at the highest frequencies.
_NOISE = 0.1


@dataclass(frozen=True)
class AxisSpectrum:
    """Periodogram along an axis, with the known temperature and detector of its bead."""

    axis: str
    whole: Periodogram
    """periodogram up to the Nyquist frequency"""
    periodogram: Periodogram
    """part of it that is fitted"""
    bead: ViscoelasticBead
    """bead without elements, at the stiffness and drag from which a fit starts"""
    per_viscosity: float
    """ratio of drag to viscosity, m: 6 pi r for a sphere of radius r far from walls"""


@dataclass(frozen=True)
class MediumFit:
    """Medium, and a stiffness for each axis, at given coordinates of a fit.

    The coordinates are ln eta_s, each ln eta_j, each ln tau_j, ln k for each axis, and for a fit
    with noise the noise coordinate of `COORDINATES` for each axis.
    """

    spectra: tuple[AxisSpectrum, ...]
    elements: int
    """number of Maxwell elements"""
    noisy: bool
    """whether white noise is fitted"""
    coordinates: Array
    """(parameters,)"""

    @property
    def medium(self) -> Medium:
        """Solvent and elements, in the order of the coordinates."""
        return self._medium(self.coordinates)

    def stiffness(self, i: int) -> float:
        """Return the stiffness along axis number `i`, N/m."""
        return math.exp(self.coordinates[1 + 2 * self.elements + i])

    def stiffness_error(self, i: int) -> float:
        """Return the relative standard uncertainty of the stiffness along axis number `i`."""
        at = 1 + 2 * self.elements + i
        return math.sqrt(self.covariance[at, at])

    def error(self, slopes: Array) -> Array:
        """Return the standard uncertainty (n,) of functions of the medium, by the delta method.

        `slopes` (1 + 2 elements, n) are their derivatives, in the rows of `Medium.slopes`.
        """
        of_medium = self.covariance[: len(slopes), : len(slopes)]
        return np.sqrt(np.einsum("in,ij,jn->n", slopes, of_medium, slopes))

    def _medium(self, coordinates: Array) -> Medium:
        """Return the medium at other coordinates."""
        n = self.elements
        eta, *others = np.exp(coordinates[: 1 + 2 * n]).tolist()
        return Medium(eta, tuple(others[:n]), tuple(others[n:]))

    def bead(self, i: int, coordinates: Array | None = None) -> ViscoelasticBead:
        """Return the bead along axis number `i`, at these or at other coordinates."""
        x, of = self.coordinates if coordinates is None else coordinates, self.spectra[i]
        medium, first = self._medium(x), 1 + 2 * self.elements
        noise = of.bead.noise
        if self.noisy:
            found = COORDINATES["noise"].to(float(x[first + len(self.spectra) + i]), of.periodogram)
            noise = found or 0.0
        return dataclasses.replace(
            of.bead, stiffness=math.exp(x[first + i]), drag=of.per_viscosity * medium.solvent,
            drags=tuple(of.per_viscosity * each for each in medium.viscosities),
            times=medium.times, noise=noise,
        )  # fmt: skip

    def likelihood(self, coordinates: Array) -> float:
        """Return the log-likelihood at `coordinates`, the sum over the axes."""
        return sum(
            each.periodogram.log_likelihood(self.bead(i, coordinates))
            for i, each in enumerate(self.spectra)
        )

    def _slopes(self, coordinates: Array) -> Iterator[tuple[AxisSpectrum, Array, Array]]:
        """Yield for each axis its spectrum, expected density (blocks,) and derivatives of its log.

        The derivatives (parameters, blocks) are central differences.
        """
        low, high = self.ends
        first, axes = 1 + 2 * self.elements, len(self.spectra)
        for i, each in enumerate(self.spectra):
            slopes = np.zeros((len(coordinates), len(each.periodogram.frequencies)))
            own = [first + i, *([first + axes + i] if self.noisy else [])]
            for j in (*range(first), *own):
                ends = np.clip(coordinates[j] + _DIFFERENCE * np.array([-1, 1]), low[j], high[j])
                logs = []
                for end in ends:
                    moved = coordinates.copy()
                    moved[j] = end
                    logs.append(np.log(each.periodogram.expected(self.bead(i, moved))))
                slopes[j] = (logs[1] - logs[0]) / (ends[1] - ends[0])
            yield each, each.periodogram.expected(self.bead(i, coordinates)), slopes

    def _ascent(self, coordinates: Array) -> tuple[Array, Array]:
        """Return the gradient of the log-likelihood and Fisher's information."""
        upward, information = np.zeros(len(coordinates)), np.zeros((len(coordinates),) * 2)
        for each, expected, slopes in self._slopes(coordinates):
            weighted = slopes * each.periodogram.counts
            upward += weighted @ (each.periodogram.density / expected - 1)
            information += weighted @ slopes.T
        return upward, information

    @cached_property
    def ends(self) -> Array:
        """Smallest and largest coordinates, (2, parameters)."""
        first = self.spectra[0]
        middle = math.log(first.bead.drag / first.per_viscosity)
        duration = first.periodogram.samples * first.periodogram.step
        viscosity = [middle - math.log(_RATIO), middle + math.log(_RATIO)]
        time = [math.log(_SHORTEST * first.periodogram.step), math.log(duration)]
        ends = [viscosity] * (1 + self.elements) + [time] * self.elements
        ends += [[-600.0, 600.0]] * len(self.spectra)
        ends += [[0.0, 1.0]] * (len(self.spectra) if self.noisy else 0)
        return np.array(ends).T

    @cached_property
    def log_likelihood(self) -> float:
        """Log-likelihood, for comparison with other fits of the same ordinates."""
        return self.likelihood(self.coordinates)

    @property
    def criterion(self) -> float:
        """Bayesian information criterion, -2 ln L + p ln N with p parameters and N ordinates."""
        ordinates = sum(float(each.periodogram.counts.sum()) for each in self.spectra)
        return -2 * self.log_likelihood + len(self.coordinates) * math.log(ordinates)

    @property
    def gain_alone(self) -> float:
        """Gain in log-likelihood if each axis has a medium of its own."""
        n, axes = 1 + 2 * self.elements, len(self.spectra)
        gain = -self.log_likelihood
        for i, each in enumerate(self.spectra):
            own = self.coordinates[[*range(n), *range(n + i, len(self.coordinates), axes)]]
            gain += MediumFit((each,), self.elements, self.noisy, own).best().log_likelihood
        return gain

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the coordinates, (parameters, parameters), by Fisher's information."""
        return inverse(self._ascent(self.coordinates)[1])

    def at(self, coordinates: Array) -> MediumFit:
        """Return this fit at other coordinates."""
        return dataclasses.replace(self, coordinates=coordinates)

    def best(self, tolerance: float = 1e-4) -> MediumFit:
        """Return the fit of largest likelihood that Fisher's scoring finds from here."""
        low, high = self.ends
        start = np.clip(self.coordinates, low, high)
        return self.at(scored(start, self.ends, self.likelihood, self._ascent, tolerance))

    def with_noise(self) -> MediumFit:
        """Return this fit with white noise in addition, at its best."""
        noise = np.full(len(self.spectra), _NOISE)
        more = np.concatenate([self.coordinates, noise])
        return dataclasses.replace(self, noisy=True, coordinates=more).best()

    def with_element(self) -> MediumFit:
        """Return this fit with a further element, at its best from several relaxation times."""
        first, n = self.spectra[0].periodogram, self.elements
        x = self.coordinates
        steady = math.log(np.exp(x[: 1 + n]).sum())
        trials = []
        for time in np.geomspace(first.step, first.samples * first.step / 10, _TIMES):
            for strength in _STRENGTHS:
                moved = np.insert(
                    x, [1 + n, 1 + 2 * n], [steady + math.log(strength), math.log(time)]
                )
                more = dataclasses.replace(self, elements=n + 1, coordinates=moved)
                trials.append(more)
        trials.sort(key=lambda each: each.log_likelihood, reverse=True)
        found = [each.best(_ROUGHLY) for each in trials[:_STARTS]]
        return max(found, key=lambda each: each.log_likelihood).best()


def fits_of(
    spectra: Sequence[AxisSpectrum], *, noise: bool
) -> tuple[MediumFit, tuple[MediumFit, ...]]:
    """Return the fit with the lowest criterion, and those with one thing more.

    These have another element, or white noise. If `noise`, fits with white noise are compared, too.
    The number of elements is increased until the criterion rises.
    """
    first = spectra[0]
    x = [math.log(first.bead.drag / first.per_viscosity)]
    x += [math.log(each.bead.stiffness) for each in spectra]
    newtonian = MediumFit(tuple(spectra), 0, noisy=False, coordinates=np.array(x)).best()
    starts = [newtonian, newtonian.with_noise()] if noise else [newtonian]
    fit, larger = min(map(_increased, starts), key=lambda pair: pair[0].criterion)
    return fit, (*larger, *([fit.with_noise()] if noise and not fit.noisy else []))


def _increased(fit: MediumFit) -> tuple[MediumFit, tuple[MediumFit, ...]]:
    """Return the fit of lowest criterion with `fit.elements` or more, and the next larger one."""
    while fit.elements < MOST:
        more = fit.with_element()
        if more.criterion >= fit.criterion:
            return fit, (more,)
        fit = more
    return fit, ()
