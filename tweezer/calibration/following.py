"""Response of a trapped bead to a stage that moves in any known way.

The response is the ratio of the signal to the motion of the stage, in bands of frequencies. It is
the sum of cross spectra divided by the sum of the stage's power, with the same weights (J. S.
Bendat and A. G. Piersol, Random Data, chapter 6). It is valid for a triangle, a sweep or a
pseudo-random motion.
"""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from tweezer.calibration.answers import Answer
from tweezer.calibration.spectra import within
from tweezer.values.arrays import Array, Complex

#: Fraction of a record over which both signals fade in and out, to suppress effects of its ends.
_FADES = 0.1
#: Number of iterations in which the bead is fitted to the bands predicted by the previous fit.
_ROUNDS = 4
#: Smallest number of ordinates in a band, and ratio of its upper to its lower end.
_LEAST, _BAND = 8, 1.1
#: Number of ordinates from which the thermal motion is measured.
_FREEDOM = 40
#: Smallest amplitude of a visible response, in standard uncertainties.
_SEEN = 5.0
#: A band contains sensor noise if the predicted response exceeds the first number and the measured
#: response is below the second one, in standard uncertainties. The first is large because a bead
#: fitted to few bands may predict several times too much.
_FORETOLD, _ABSENT = 20.0, 3.0
#: Ratio of the power at the quietest frequencies of white noise to its mean power.
_QUIET = 0.565
#: -ln of the probability that any ordinate of white noise is mistaken for motion.
_CERTAIN = 5.0
#: Number of ordinates over which a median is taken to find the quietest frequencies.
_AROUND = 101
#: Smallest length of a jump of a stage, over the extent of its motion and over the adjacent steps.
_JUMP, _ALONE = 0.05, 3.0
#: Highest frequency at which the motion of a jumping stage is known, over the sampling rate.
_OF_JUMPS = 1 / 8
#: Time before a record whose motion affects it, in relaxation times.
_REMEMBERED = 20.0
#: Smallest number of samples by which a record is extended.
_EXTENDED = 1000
#: Number of corner frequencies that are tried as initial values.
_CORNERS = 60


def jumping(drive: Array) -> float:
    """Return the fraction of a stage's path that is covered by jumps between samples.

    A jump is a step longer than its neighbours. `drive` (n,), m, are the positions of the stage.
    """
    way = np.abs(np.diff(drive))
    beside = np.maximum(np.append(way[1:], 0.0), np.append(0.0, way[:-1]))
    jumps = way[(way > _JUMP * np.ptp(drive)) & (way > _ALONE * beside)]
    return float(jumps.sum() / way.sum())


class _Bands(NamedTuple):
    """Response of a bead to its stage, in the frequency bands in which the stage moves."""

    frequencies: Array
    """(bands,) mean frequency of the stage's motion, weighted by its power, Hz"""
    response: Complex
    """(bands,) complex ratio of signal to stage motion: V/m, or dimensionless for a signal in m"""
    uncertainty: Array
    """(bands,) standard uncertainty of the real and of the imaginary part of the response"""
    stage: Array
    """(bands,) amplitude of a single oscillation with the stage's power in the band, m"""
    ends: Array
    """(bands, 2) lowest and highest frequency of each band, Hz"""


@dataclass(frozen=True)
class Followed:
    """Signal of a bead, separated into its responses to the stage and the remaining motion."""

    still: Array
    """(n,) signal about its mean, without the motion that follows the stage, m or V"""
    answers: tuple[Answer, ...]
    """responses in the bands in which the bead visibly follows the stage"""
    noise: tuple[float, ...] = ()
    """mean frequencies, Hz, of bands in which only the stage's sensor shows motion"""

    @classmethod
    def of(
        cls, signal: Array, stage: Array, step: float, known: Sequence[Answer] = (), *, steady: bool
    ) -> Followed:
        """Separate a signal into the part that follows a stage and the remainder.

        The response in bands in which the bead is not visible follows from the other bands.

        Parameters
        ----------
        signal : ndarray, shape (n,)
            Signal of the bead, m or V.
        stage : ndarray, shape (n,)
            Positions of the stage, m.
        step : float
            Sampling interval of both, s.
        known : sequence of Answer
            Answers of the same bead at frequencies that signal and stage do not contain.
        steady : bool
            Whether the stage does not jump between samples.
        """
        still = signal - signal.mean()
        bands = _bands(still, stage, step, 0.5 / step if steady else _OF_JUMPS / step)
        first = np.abs(bands.response) > _SEEN * bands.uncertainty
        if not (bands.frequencies.size and (first.any() or known)):
            return cls(still, ())
        absent = np.abs(bands.response) < _ABSENT * bands.uncertainty
        followed = np.zeros_like(first)
        for _ in range(_ROUNDS):
            bead = _Nearest.to(bands, first | followed, known, step)
            # select bands by their expected response: selection by the measured response would
            # favour those that are too large by chance
            expected = np.abs(bead.moved(bands.frequencies))
            noise = absent & (expected > _FORETOLD * bands.uncertainty)
            followed = (expected > _SEEN * bands.uncertainty) & ~noise
        still = still - _motion(stage, step, still, bead, bands.ends[noise])
        answers = []
        for i in np.flatnonzero(followed):
            amplitude, error = float(bands.stage[i]), float(bands.stage[i] * bands.uncertainty[i])
            power = abs(bands.response[i] * amplitude) ** 2 - error**2
            seen = math.sqrt(max(power, error**2)), error, cmath.phase(bands.response[i])
            answers.append(Answer(float(bands.frequencies[i]), amplitude, 0.0, *seen))
        return cls(still, tuple(answers), tuple(bands.frequencies[noise].tolist()))


def _waves(series: Array) -> Complex:
    """Return the Fourier components (n//2 + 1,) of a series (n,) about its mean.

    The ends of the series fade out (Tukey window), which suppresses leakage. The components have
    the unit of the series.
    """
    from scipy.fft import rfft
    from scipy.signal.windows import tukey

    return np.asarray(rfft(tukey(len(series), _FADES) * (series - series.mean())))


def _white(power: Array) -> float:
    """Return the mean power of the white noise of a stage's sensor.

    `power` contains the squared Fourier components of the stage's position. The noise is estimated
    from the tenth of the frequencies with the least power, as medians over 101 neighbours.
    """
    from scipy.ndimage import median_filter

    return float(np.quantile(median_filter(power, _AROUND, mode="nearest"), 0.1)) / _QUIET


def _stands_out(power: Array, noise: float) -> NDArray[np.bool_]:
    """Return which ordinates of `power` exceed the largest one that is plausible for white noise.

    `noise` is the mean power of the noise, in the unit of `power`; the result has the shape of
    `power`.
    """
    return np.asarray(power > noise * (math.log(len(power)) + _CERTAIN))


def _bands(signal: Array, stage: Array, step: float, highest: float) -> _Bands:
    """Return the response of a signal to its stage in bands up to the frequency `highest`, Hz.

    `signal` (n,), m or V, and `stage` (n,), m, are sampled every `step`, s. Bands in which the
    stage does not move are omitted. The response is the least-squares ratio of the Fourier
    components, after subtracting the noise of the stage's sensor from its power.
    """
    of_stage, of_signal = _waves(stage), _waves(signal)
    frequencies = np.arange(len(of_stage)) / (len(stage) * step)
    power = np.abs(of_stage) ** 2
    of_sensor = _white(power)
    moved = _stands_out(power, of_sensor)  # frequencies at which the stage moves
    moved[0] = False
    edges = [1]
    while edges[-1] < np.searchsorted(frequencies, highest):
        edges.append(max(edges[-1] + _LEAST, math.ceil(edges[-1] * _BAND)))
    half = (1 - 5 * _FADES / 8) * len(stage) / 2  # half the sum of the window
    rows: list[tuple[Any, ...]] = []
    for first, last in itertools.pairwise(edges):
        within = np.arange(first, min(last, len(power)))
        used = within[moved[within]]
        if not used.size:
            continue
        S, X = of_stage[used], of_signal[used]  # Fourier components of stage and signal
        total = float(power[used].sum()) - used.size * of_sensor
        response = complex(np.vdot(S, X) / total)
        rest = of_signal[within].copy()
        rest[moved[within]] -= response * S
        at = float(power[used] @ frequencies[used]) / float(power[used].sum())
        # the remainder includes the noise of the stage's sensor
        left = float((np.abs(rest) ** 2).sum())
        left += (within.size - used.size) * abs(response) ** 2 * of_sensor
        ends = frequencies[within[0]], frequencies[within[-1]]
        rows.append((at, response, total, left, within.size - 1, ends))
    if not rows:
        none = np.empty(0)
        return _Bands(none, none.astype(complex), none, none, np.empty((0, 2)))
    frequency, responses, totals, squares, counts, ends = zip(*rows, strict=True)
    noise = _smooth(np.array(squares), np.array(counts))
    return _Bands(
        np.array(frequency), np.array(responses), np.sqrt(noise / (2 * np.array(totals))),
        np.sqrt(totals) / half, np.array(ends),
    )  # fmt: skip


def _smooth(squares: Array, freedom: Array) -> Array:
    """Return the thermal power of each band, (bands,), averaged over neighbouring bands.

    `squares` (bands,) are sums of squared Fourier components without the response, and `freedom`
    (bands,) the numbers of ordinates in them. Each band is averaged with as many neighbours on both
    sides as provide 40 ordinates.
    """
    means = np.empty(len(squares))
    for i in range(len(squares)):
        beside = 0
        near = slice(i, i + 1)
        while freedom[near].sum() < min(_FREEDOM, freedom.sum()):
            beside += 1
            near = slice(max(i - beside, 0), i + beside + 1)
        means[i] = squares[near].sum() / freedom[near].sum()
    return means


class _Nearest(NamedTuple):
    """Overdamped bead with a delayed signal, as a model of a measured response."""

    corner: float
    """corner frequency of the trap, Hz"""
    late: float
    """delay of the signal relative to the motion of the stage, s"""
    by_position: float
    """ratio of signal to bead position: V/m, or dimensionless for a signal in m"""

    def moved(self, frequencies: Array) -> Complex:
        """Return the complex ratio of signal to stage motion at `frequencies` (n,), Hz."""
        follows = 1j * frequencies / (1j * frequencies + self.corner)
        late = np.exp(-2j * np.pi * frequencies * self.late)
        return np.asarray(self.by_position * follows * late)

    @classmethod
    def to(
        cls, bands: _Bands, seen: NDArray[np.bool_], known: Sequence[Answer], step: float
    ) -> _Nearest:
        """Return the bead whose response is nearest to the measured ones, by least squares.

        The fit uses the bands selected by `seen` (bands,), and the `known` responses at other
        frequencies. The delay is expected to be about one `step`, s. Far below the corner frequency
        only this expectation distinguishes a delay from the relaxation time.
        """
        f = np.append(bands.frequencies[seen], [each.frequency for each in known])
        response = np.append(bands.response[seen], [each.response for each in known])
        error = np.append(bands.uncertainty[seen], [each.response_uncertainty for each in known])
        weights = 1 / error**2

        def nearest(logarithm: float, steps: float) -> _Nearest:
            unit = cls(math.exp(logarithm), float(steps) * step, 1.0)
            moved = unit.moved(f)
            overlap = float(weights @ (moved.conj() * response).real)
            return unit._replace(by_position=overlap / float(weights @ np.abs(moved) ** 2))

        def misfit(coordinates: Array) -> float:
            off = np.abs(response - nearest(*coordinates).moved(f))
            return float(weights @ off**2 + coordinates[1] ** 2)

        grid = np.linspace(math.log(f.min() / 30), math.log(f.max() * 30), _CORNERS)
        start = min(grid, key=lambda each: misfit(np.array([each, 0.0])))
        options = {"xatol": 1e-6, "fatol": 1e-6}
        bounds = [(grid[0], grid[-1]), (-np.inf, np.inf)]
        found = minimize(misfit, [start, 0.0], method="Nelder-Mead", bounds=bounds, options=options)
        return nearest(*found.x)


def _motion(stage: Array, step: float, signal: Array, bead: _Nearest, noise: Array) -> Array:
    """Return the part (n,) of a bead's signal that follows the stage, about its mean.

    The response of `bead` multiplies the Fourier components of `stage` (n,), m, sampled every
    `step`, s. The decay of motion from before the record is fitted to the beginning of `signal`
    (n,). `noise` (bands, 2), Hz, contains the ends of the bands with noise of the stage's sensor.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    n, rate = len(stage), 2 * math.pi * bead.corner
    before = min(max(math.ceil(_REMEMBERED / (rate * step)), _EXTENDED), n - 1)
    # beyond its ends the motion is continued antisymmetrically, and fades
    extended = np.pad(stage - stage.mean(), before, mode="reflect", reflect_type="odd")
    fade = np.sin(np.pi / 2 * np.arange(before) / before) ** 2
    extended[:before] *= fade
    extended[-before:] *= fade[::-1]
    length = next_fast_len(len(extended), real=True)
    waves = rfft(extended, length)
    power = np.abs(waves) ** 2
    frequencies = np.arange(len(waves)) / (length * step)
    of_sensor = _white(power)
    moves = _stands_out(power, of_sensor) & ~within(frequencies, noise)
    waves[~moves] = 0.0
    waves[moves] *= 1 - of_sensor / power[moves]  # Wiener filter for the sensor's noise
    waves *= bead.moved(frequencies)
    moved = irfft(waves, length)[before : before + n]
    # motion of the stage before the record leaves a response that decays
    left = np.exp(-rate * step * np.arange(min(before, n)))
    off = (signal - moved)[: left.size]
    moved[: left.size] += float(left @ off) / float(left @ left) * left
    return np.asarray(moved - moved.mean())
