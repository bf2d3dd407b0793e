"""Line of a damped oscillator in the spectrum of a record: its fit, and tests of its width."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.whittle import Periodogram, inverse, scored
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann

#: Half the width of the band that is fitted, in full widths at half maximum Gamma/2 pi.
_REACH = 20.0
#: Distance from the line over the width of a block of ordinates.
_FINENESS = 32
#: Ratio of successive damping rates that are tried.
_RATIO = 1.6
#: Smallest number of ordinates in a block from which the floor of the spectrum is estimated.
_LEAST = 8
#: Half the change of a coordinate for computing a derivative.
_DIFFERENCE = 1e-4
#: Half the width of the band of the envelope, in damping rates: the largest and the smallest, Hz.
_ENVELOPE = (2.5, 0.5)
#: Largest fraction of the distance to frequency 0, and to Nyquist's, in that band.
_INSIDE = 0.9


@dataclass(frozen=True)
class Line:
    r"""Line of an oscillator x'' + Gamma x' + Omega^2 x = noise, fitted to a periodogram.

    The coordinates are (Omega - Omega_0)/Gamma_0, ln Gamma, ln V and the noise density over
    `floor`. V is the variance of the signal. The fit starts at Omega_0 and Gamma_0. The expected
    density of the samples is exact: it includes aliases, exposure, diode and leakage
    (`TrappedBead.sampled_spectrum`).
    """

    periodogram: Periodogram
    """ordinates of the band that is fitted"""
    detector: TrappedBead
    """bead with the temperature and the known detector; its noise is NaN if it is fitted"""
    centre: float
    """Omega_0, rad/s"""
    width: float
    """Gamma_0, 1/s"""
    coordinates: Array
    """(4,)"""

    def bead(self, coordinates: Array | None = None) -> TrappedBead:
        """Return a bead with this line and a drag of 1 kg/s, on which the line does not depend."""
        shift, log_rate, log_variance, noise = (
            self.coordinates if coordinates is None else coordinates
        )
        mass = math.exp(-log_rate)
        stiffness = mass * (self.centre + shift * self.width) ** 2
        square = math.exp(log_variance) * stiffness / (Boltzmann * self.detector.temperature)
        level = self.detector.noise
        if math.isnan(level):
            level = math.sqrt(max(noise, 0.0) * self.periodogram.floor / (2 * self._step))
        return dataclasses.replace(
            self.detector, stiffness=stiffness, drag=1.0, mass=mass, displaced_mass=None,
            response=math.sqrt(square), noise=level, wall=None,
        )  # fmt: skip

    @property
    def _step(self) -> float:
        """Sampling interval, s."""
        return self.periodogram.step

    @property
    def free(self) -> list[int]:
        """Indices of the coordinates that are fitted."""
        return [0, 1, 2, 3] if math.isnan(self.detector.noise) else [0, 1, 2]

    @property
    def frequency(self) -> float:
        """Angular resonance frequency Omega, rad/s."""
        return float(self.centre + self.coordinates[0] * self.width)

    @property
    def rate(self) -> float:
        """Damping rate Gamma, 1/s."""
        return math.exp(self.coordinates[1])

    @property
    def logarithms(self) -> Array:
        """(3,) ln Omega, ln Gamma and ln V, with the variance V, m^2 or V^2."""
        return np.array([math.log(self.frequency), *self.coordinates[1:3]])

    @cached_property
    def covariance(self) -> Array:
        """(3, 3) covariance of `logarithms`, by Fisher's information."""
        _, information = self._ascent(self.coordinates)
        covariance = inverse(information[np.ix_(self.free, self.free)])[:3, :3]
        scale = np.array([self.width / self.frequency, 1.0, 1.0])
        return np.asarray(covariance * np.outer(scale, scale))

    @property
    def log_likelihood(self) -> float:
        """Log-likelihood, for comparison with other fits of the same ordinates."""
        return self.periodogram.log_likelihood(self.bead())

    @property
    def gain(self) -> float:
        """Gain in log-likelihood over white noise without a line."""
        part = self.periodogram
        white = part.counts @ part.density / part.counts.sum()
        flat = -float(part.counts @ (math.log(white) + part.density / white))
        return self.log_likelihood - flat

    def _ascent(self, coordinates: Array) -> tuple[Array, Array]:
        """Return the gradient of the log-likelihood and Fisher's information at `coordinates`."""
        part, slopes = self.periodogram, np.zeros((4, len(self.periodogram.frequencies)))
        for i in self.free:
            ends = np.stack([coordinates, coordinates])
            ends[:, i] += _DIFFERENCE * np.array([-1, 1])
            ends[:, 3] = np.maximum(ends[:, 3], 0.0)
            below, above = (np.log(part.expected(self.bead(end))) for end in ends)
            slopes[i] = (above - below) / (ends[1, i] - ends[0, i])
        weighted = slopes * part.counts
        ratio = part.density / part.expected(self.bead(coordinates)) - 1
        return weighted @ ratio, weighted @ slopes.T

    def best(self) -> Line:
        """Return the line of largest likelihood, by Fisher's scoring from this one."""
        lowest = _DIFFERENCE - self.centre / self.width  # a positive frequency
        ends = np.array([[lowest, np.inf], [-600, 600], [-600, 600], [0, 1e8]]).T
        free = self.free

        def whole(part: Array) -> Array:
            return np.concatenate([part, self.coordinates[len(free) :]])

        def ascent(part: Array) -> tuple[Array, Array]:
            upward, information = self._ascent(whole(part))
            return upward[free], information[np.ix_(free, free)]

        found = scored(
            self.coordinates[free], ends[:, free],
            lambda part: self.periodogram.log_likelihood(self.bead(whole(part))), ascent,
        )  # fmt: skip
        return dataclasses.replace(self, coordinates=whole(found))


def fitted_line(
    whole: Callable[[NDArray[np.int64]], Periodogram],
    detector: TrappedBead,
    band: tuple[float, float],
) -> Line:
    """Return the line of largest likelihood in a band of frequencies.

    It is sought at the largest product of frequency and density. The ordinates are averaged over
    blocks that are narrow compared with their distance from the line. They are fitted within 20
    widths of the line.

    Parameters
    ----------
    whole : callable
        Function from the first ordinate (blocks,) of each block to the periodogram of the record.
    detector : TrappedBead
        Bead with the temperature and the known detector; its noise is NaN if it is to be fitted.
    band : tuple of float
        Lowest and highest frequency, Hz.
    """
    first = whole(np.arange(1))
    duration, ordinates = first.samples * first.step, first.ordinates.size
    weights = first.ordinates * np.arange(1, ordinates + 1)
    at = np.arange(1, ordinates + 1) / duration
    kept = (at >= band[0]) & (at <= band[1])
    for low, high in first.without:
        kept &= (at < low) | (at > high)
    peak = float(at[np.where(kept, weights, 0.0).argmax()])
    part = _within(_blocks(whole, peak * duration, ordinates), band)
    line = _start(part, detector, 2 * math.pi * peak)
    for _ in range(2):
        middle, reach = line.frequency / (2 * math.pi), _REACH * line.rate / (2 * math.pi)
        near = (max(band[0], middle - reach), min(band[1], middle + reach))
        part = _within(_blocks(whole, middle * duration, ordinates), near)
        coordinates = np.array([0.0, *line.coordinates[1:3], _noise(line, part)])
        line = Line(part, detector, line.frequency, line.rate, coordinates).best()
    return line


def _noise(line: Line, part: Periodogram) -> float:
    """Return the noise coordinate of a line for another periodogram with another floor."""
    return float(line.coordinates[3]) * line.periodogram.floor / part.floor


def _blocks(
    whole: Callable[[NDArray[np.int64]], Periodogram], centre: float, ordinates: int
) -> Periodogram:
    """Return a periodogram with blocks that are narrow beside their distance from an ordinate.

    `centre` is the number of this ordinate, and `ordinates` the number of all.
    """
    steps, distance = [0], 0
    while distance < ordinates:
        distance += max(1, distance // _FINENESS)
        steps.append(distance)
    middle = round(centre) - 1
    starts = np.unique([*(middle - np.array(steps)), *(middle + 1 + np.array(steps))])
    return whole(np.unique([0, *starts[(starts > 0) & (starts < ordinates)]]))


def _within(part: Periodogram, band: tuple[float, float]) -> Periodogram:
    """Return the blocks of a periodogram in a band, Hz, with the lowest density as the floor."""
    part = part[(part.frequencies >= band[0]) & (part.frequencies <= band[1])]
    if part.counts.size < _LEAST:
        raise ArithmeticError("too few frequencies for a fit")
    many = part.density[part.counts >= _LEAST]
    return dataclasses.replace(part, floor=float((many if many.size else part.density).min()))


def _start(part: Periodogram, detector: TrappedBead, centre: float) -> Line:
    """Return the most probable of lines of several widths about the angular frequency `centre`."""
    duration = part.samples * part.step
    rates = np.geomspace(
        2 / duration, 2 * centre, 2 + int(math.log(centre * duration) / math.log(_RATIO))
    )
    power = float(part.counts @ np.maximum(part.density - part.floor, 0.0))
    tried = []
    for rate in rates:
        line = Line(part, detector, centre, rate, np.array([0.0, math.log(rate), 0.0, 1.0]))
        quiet = dataclasses.replace(line.bead(), noise=0.0)
        unit = float(part.counts @ part.expected(quiet))
        coordinates = np.array([0.0, math.log(rate), math.log(power / unit), 0.5])
        tried.append(dataclasses.replace(line, coordinates=coordinates))
    return max(tried, key=lambda each: each.log_likelihood)


@dataclass(frozen=True)
class Wander:
    """Change of the resonance frequency with the energy of the motion, and with time.

    In a harmonic trap at rest both vanish. In an anharmonic one the frequency changes by kappa for
    the mean energy k_B T. As the energy changes at random, this increases the width Gamma by
    2 kappa^2/Gamma.
    """

    by_energy: float
    """kappa, rad/s"""
    by_energy_error: float
    """standard uncertainty of `by_energy`, rad/s"""
    by_time: float
    """half the change of the frequency in the record, rad/s"""
    by_time_error: float
    """standard uncertainty of `by_time`, rad/s"""

    @classmethod
    def of(cls, signal: Array, step: float, line: Line) -> Wander | None:
        r"""Return the change of the frequency in a record; None if the line is too wide for it.

        The signal has the complex envelope a_j about the line, at intervals tau. If the frequency
        is shifted by delta, Im(a_j^* a_{j+1}) has the mean |a_j|^2 delta tau e^(-Gamma tau/2). The
        shift is fitted by kappa (|a_j|^2/<|a|^2> - 1) and a linear function of time, with weights
        1/|a_j|^2.

        Parameters
        ----------
        signal : ndarray, shape (n,)
            Record, m or V.
        step : float
            Sampling interval, s.
        line : Line
            Its line.
        """
        from scipy.fft import ifft, rfft

        duration, middle = len(signal) * step, line.frequency / (2 * math.pi)
        widest, narrowest = (each * line.rate for each in _ENVELOPE)
        half = min(widest, _INSIDE * middle, _INSIDE * (0.5 / step - middle))
        ordinates, centre = int(half * duration), round(middle * duration)
        if half < narrowest:
            return None
        waves = rfft(signal - signal.mean())[centre - ordinates : centre + ordinates]
        tau = duration / (2 * ordinates)
        times = tau * np.arange(2 * ordinates)
        turning = np.exp(-2j * np.pi * (middle - centre / duration) * times)
        envelope = np.asarray(ifft(np.roll(waves, -ordinates))) * turning
        envelope /= math.sqrt(np.mean(np.abs(envelope) ** 2))
        energy = np.abs(envelope[:-1]) ** 2
        turned = (envelope[:-1].conj() * envelope[1:]).imag
        along = 2 * times[:-1] / duration - 1
        design = np.stack([np.ones_like(energy), energy - 1, along])
        inverse_matrix = np.linalg.inv((design * energy) @ design.T)
        found = inverse_matrix @ (design @ turned)
        rest = turned - energy * (found @ design)
        errors = np.sqrt(np.diag(inverse_matrix) * np.mean(rest**2 / energy))
        unit = 1 / (tau * math.exp(-line.rate * tau / 2))
        return cls(*(float(each) for pair in zip(found[1:], errors[1:], strict=True)
                     for each in unit * np.array(pair)))  # fmt: skip

    def widening(self, rate: float) -> float:
        """Return the relative increase of the damping rate `rate`, 1/s, by both changes."""
        return 2 * (self.by_energy**2 + self.by_time**2) / rate**2
