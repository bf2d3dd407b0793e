"""Tests whether a record agrees with a bead in a harmonic trap at rest, before any estimate."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, fdtrc, kolmogorov, ndtr

from tweezer.calibration.left_out import NOTHING, LeftOut
from tweezer.calibration.settling import FAR, spread, unsettled
from tweezer.calibration.spectra import TrappedBead, standard_error
from tweezer.calibration.whittle import (
    MOTION,
    STIFFNESS,
    Periodogram,
    WhittleFit,
    best_start,
    fitted,
)
from tweezer.values.arrays import Array
from tweezer.values.printed import printed
from tweezer.values.rounding import time_taken

#: Probability below which a record of a trapped bead is considered improbable, as a finding.
IMPROBABLE = 1e-3
#: Probability below which a p-value that is printed with the result is a finding.
REFUTED = 1e-2
#: Probability below which a disturbance that shifts an estimate by `HARM` or more is a finding.
_UNLIKELY = 1e-2
#: Shift of an estimate that is harmless, in its standard uncertainties.
HARM = 0.5
#: Shortest record, in relaxation times. With a length of 21, one free bead in a hundred looks
#: trapped (D. A. Dickey and W. A. Fuller, J. Am. Stat. Assoc. 74, 427 (1979)).
_RELAXATIONS = 30.0
#: Length of a record that is certainly sufficient, in relaxation times.
_LONG = 300.0
#: Half the width of a 95 % interval of a corner frequency, in standard uncertainties.
_INTERVAL = 1.96
#: Lowest frequency of a fit above which slow motion counts as excluded, over 1/duration.
_NEXT = 1.5
#: Fraction of samples at the extreme value above which the detector's range may end there.
_CLIPPED = 0.01
#: Smallest ratio of that number of samples to the number at the next value; by rounding it is <= 1.
_HEAPED = 2
#: Number of cosines that describe slow motion, of half a period in the record, one period, ...
SLOW = 4
#: Largest number of half periods in a record at which a drift can resemble a line in the spectrum.
_SLOWEST = 40
#: Largest distance between ordinates of the same line, and largest number of lines listed.
_LINE, _LINES_TOLD = 3, 3
#: Harmless shift by an unknown exposure, which may be 0, in standard uncertainties.
_HARM_IF_ANY = 1.0
#: Exposures that are tested if none is given, in sampling intervals.
_EXPOSURES = (1.0, 0.5, 0.25)
#: Twice the difference of log-likelihoods that excludes an exposure: p = 0.014.
_NOT_EXCLUDED = 6.0
#: Highest frequency, Hz, up to which the inertia of a fluid is not suspected.
_FAST = 5e3
#: Smallest fraction of the noise variance for which a finding names rounding as the cause.
_BY_ROUNDING = 0.25
#: Tolerance of the fits in tests.
_ROUGHLY = 1e-2
#: Smallest fraction of the information on white noise that stiffness and drag do not absorb.
_DISTINCT = 1e-3


@dataclass(frozen=True)
class Finding:
    """Reason not to trust a record or an estimate, with a name and a text."""

    name: str
    """short name. About the digits: "lost", "repeated", "interpolated", "copied", "rounded",
    "turns", "order"; about the record: "stuck", "clipped", "start", "outlier", "free", "drift",
    "halves", "line", "noise", "blur", "exposure", "spectrum", "drag"; about a bead in gas:
    "broadened", "axes", "width", "metres"; about a number: "one-call", "few", "apart",
    "undetermined\""""
    text: str
    """explanation for the user"""


def in_words(findings: Iterable[Finding]) -> str:
    """Return the texts of findings in one line."""
    return "; ".join(each.text for each in findings)


@dataclass(frozen=True)
class Fits:
    """Spectrum of a record, and the fits with which tests compare it."""

    whole: Periodogram
    """periodogram of the record, up to Nyquist's frequency"""
    fit: WhittleFit
    """fit with the given drag; the same as `free` if no drag was given"""
    free: WhittleFit
    """fit of stiffness and drag"""
    left_out: LeftOut = NOTHING
    """drift and bands excluded from the record"""

    def per(self, response: float) -> Fits:
        """Return these fits for the signal divided by `response`, V/m or a number."""
        fit = self.fit.per(response)
        free = fit if self.free is self.fit else self.free.per(response)
        return Fits(self.whole.per(response), fit, free, self.left_out)


def examine(
    positions: Array, step: float, fits: Fits, exposure_known: bool, resolution: float
) -> list[Finding]:
    """Return the findings against a recording, which apply to every estimate from it.

    Parameters
    ----------
    positions : ndarray, shape (n,)
        Positions along one axis, m or V.
    step : float
        Sampling interval, s.
    fits : Fits
        Fits of the spectrum.
    exposure_known : bool
        Whether the exposure time is given.
    resolution : float
        Step of the digits of the positions; 0 if they are not digitised.

    Returns
    -------
    list of Finding
        Findings, in the order of their tests.
    """
    few = _like_a_free_bead(len(positions) * step, fits)
    unsteady = _unsteady(positions, step, fits, few is not None)
    drifts = any(each is not None and each.name == "drift" for each in unsteady)
    # a drift occurs mostly at the lowest frequencies
    slowest = _SLOWEST / (2 * len(positions) * step) if drifts else 0.0
    found = [
        stray(positions, step),
        few,
        *unsteady,
        None if exposure_known else _unknown_exposure(fits.fit, step),
        _line(fits, slowest),
        _white(positions, step, fits, exposure_known, resolution),
        _spectrum(fits.free),
        _drag(fits),
    ]
    named: dict[str, Finding] = {}
    for each in found:
        if each:
            named.setdefault(each.name, each)  # two tests detect blur
    # noise adds motion from sample to sample, and an exposure removes it
    hidden = {"blur", "exposure"} if "noise" in named else set()
    if "blur" in named:
        hidden |= {"exposure"}
    return [finding for name, finding in named.items() if name not in hidden]


def relative_variance_of_variance(bead: TrappedBead, whole: Periodogram) -> float:
    """Return the relative variance of the position variance in a record of `bead`.

    The variance of the positions is a sum of independent, exponentially distributed ordinates, at
    the frequencies of the periodogram `whole`.
    """
    power = whole.counts * whole.expected(bead)
    return float((power**2 / whole.counts).sum() / power.sum() ** 2)


def stray(positions: Array, step: float) -> Finding | None:
    """Return a finding for samples far from the median, or at the limit of the detector's range.

    `positions` (n,) are sampled every `step`, s. The median is not affected by outliers.
    """
    off, deviation = spread(positions)
    farthest = int(off.argmax())
    if deviation == 0:
        return Finding("stuck", "more than half of its samples are equal")
    for end, signed in (("largest", positions), ("smallest", -positions)):
        heap, following = (int((signed == each).sum()) for each in _two_largest(signed))
        if heap > max(_CLIPPED * len(positions), _HEAPED * following):
            share = f"{100 * heap / len(positions):.2g} % of its samples equal the {end} one"
            return Finding("clipped", f"{share}, probably the end of the range of the detector")
    begin = unsettled(positions, step) if off[0] > FAR * deviation else None
    if begin is not None:
        return Finding(
            "start", f"it starts {begin.off:.2g} standard deviations from the median: "
            f"omit the beginning, --skip \"{time_taken(begin.time)}\""
        )  # fmt: skip
    if off[farthest] > FAR * deviation:
        away = f"{off[farthest] / deviation:.2g} standard deviations from the median"
        return Finding("outlier", f"sample {farthest + 1} is {away}")
    return None


def _two_largest(numbers: Array) -> tuple[float, float]:
    """Return the largest number and the largest of those below it."""
    largest = numbers.max()
    return float(largest), float(numbers[numbers < largest].max())


def _like_a_free_bead(duration: float, fits: Fits) -> Finding | None:
    """Return a finding if the record, of `duration` s, is similar to that of a free bead.

    This is the case if it lasts for too few relaxation times, or if slow motion is excluded and the
    remaining spectrum has no plateau.
    """
    bead, slowest = fits.free.bead, float(fits.free.periodogram.frequencies[0])
    relaxations = duration / bead.relaxation_time
    if relaxations < _RELAXATIONS:
        text = (
            f"the recording lasts {relaxations:.2g} relaxation times, too few to exclude a free "
            "bead"
        )
        return Finding("free", text)
    least = bead.roll_off * (1 - _INTERVAL * fits.free.uncertainty(1, -1))
    if slowest * duration < _NEXT or least > slowest:
        return None
    text = f"without motion slower than {slowest:.2g} Hz a free bead cannot be excluded"
    return Finding("free", text)


def _unsteady(positions: Array, step: float, fits: Fits, looks_free: bool) -> list[Finding | None]:
    """Return findings for a mean that drifts, and for a variance that differs between the halves.

    `positions` (n,), m, are sampled every `step`, s. The test of drift compares the slowest cosines
    in the record (DCT-II, half a period and more) that were not removed with the spectrum of the
    remainder. Each cosine is nearly independent and Gaussian with the variance S/(2 step), where S
    is the spectral density at its frequency. Fisher's F is used because S is fitted itself. Free
    diffusion resembles a drift, so for a bead that `looks_free` a drift is reported only if the
    remainder is long.
    """
    samples, fit = len(positions), fits.fit
    first = 1 + fits.left_out.cosines(samples, step)
    slow, rest = np.empty(SLOW), positions.copy()
    for i in range(SLOW):
        cosine = _cosine(first + i, samples)
        slow[i] = np.einsum("i,i", positions, cosine)
        cosine *= slow[i]
        rest -= cosine
    whole = Periodogram.of(rest, step, fits.whole.without)
    slowest = (first + SLOW) / (2 * samples * step)
    # the frequencies that are not affected by removing the cosines
    kept = (whole.frequencies > max(slowest, fits.left_out.fit_range[0])) & (
        whole.frequencies <= fit.periodogram.frequencies[-1]
    )
    start = fit.bead
    if fit.free in (STIFFNESS, MOTION):
        drag = fit.bead.drag if fit.free == STIFFNESS else math.nan
        start = best_start(whole, rest, dataclasses.replace(fit.bead, drag=drag))
    whole = dataclasses.replace(whole, beside=fit.periodogram.beside)
    steady = fitted(whole[kept], start, fit.free, _ROUGHLY)
    at = np.arange(first, first + SLOW) / (2 * samples * step)
    expected = steady.bead.sampled_spectrum(at, step) / (2 * step)
    # degrees of freedom of the plateau S(0) = 4 k_B T beta/k^2 (beta: drag, k: stiffness)
    freedom = 2 / steady.uncertainty(-2, 1) ** 2
    p_value = 2 * min(
        float(fdtrc(m, freedom, (slow[:m] ** 2 / expected[:m]).mean())) for m in (1, SLOW)
    )
    relative = relative_variance_of_variance(steady.bead, whole)
    excess = float((slow**2 - expected).sum()) / samples
    share = excess / steady.bead.variance
    found: list[Finding | None] = []
    strays = looks_free and samples * step < _LONG * steady.bead.relaxation_time
    if p_value < _UNLIKELY and share > HARM * math.sqrt(relative) and not strays:
        text = (
            f"it drifts, {printed(math.sqrt(excess), 'nm', 2)} rms below {at[-1]:.2g} Hz, which "
            f"increases the variance by {100 * share:.0f} % unless it is removed"
        )
        found.append(Finding("drift", text))
    early, late = np.array_split(rest, 2)
    ratio = float(np.var(early) / np.var(late))
    of_half = 1 / relative  # degrees of freedom: 2/(relative variance of half a record)
    p_value = 2 * float(fdtrc(of_half, of_half, max(ratio, 1 / ratio)))
    if p_value < IMPROBABLE:
        text = f"its first half has {ratio:.2g} times the variance of its second"
        found.append(Finding("halves", text))
    elif _short_times_differ(early, late):
        text = "its halves differ in how the bead moves from sample to sample"
        found.append(Finding("halves", text))
    return found


def _cosine(half_periods: int, samples: int) -> Array:
    """Return a normalised cosine (samples,) with `half_periods` half periods, a row of the DCT-II.

    Its angles form a square table, in which each is the sum of a row angle and a column angle. This
    saves most evaluations of the cosine.
    """
    side = math.isqrt(samples) + 1
    unit = 1j * np.pi * half_periods / samples
    rows = np.exp(unit * side * np.arange(side)) * math.sqrt(2 / samples)
    columns = np.exp(unit * (np.arange(side) + 0.5))
    table = np.stack([rows.real, -rows.imag], axis=1) @ np.stack([columns.real, columns.imag])
    return np.asarray(table.ravel()[:samples])


def _short_times_differ(first: Array, second: Array) -> bool:
    """Return whether two parts of a record, (n,), m, differ in their mean squared steps."""
    squares = [np.diff(half) ** 2 for half in (first, second)]
    error = math.hypot(*map(standard_error, squares))
    apart = abs(squares[0].mean() - squares[1].mean())
    return bool(2 * ndtr(-apart / error) < IMPROBABLE / 10)


def _white(
    positions: Array, step: float, fits: Fits, exposure_known: bool, resolution: float
) -> Finding | None:
    """Return a finding for white noise, or for less motion from sample to sample than in the fit.

    `positions` (n,), m, are sampled every `step`, s, with digits of the `resolution`, m. This is
    the score test for a constant added to the fitted spectrum (C. R. Rao, Proc. Camb. Philos. Soc.
    44, 50 (1948)). Above the frequencies of the fit it uses the increments of the positions, whose
    spectrum has no leakage. For an overdamped bead, noise and exposure change the shape of the
    spectrum only by such a constant, which may be positive or negative.
    """
    free, part = fits.free, fits.free.periodogram
    increments = Periodogram.of(np.diff(positions), step, fits.whole.without)
    beyond = increments[
        (increments.frequencies > part.frequencies[-1])
        & (increments.frequencies <= fits.left_out.fit_range[1])
    ]
    gain = 4 * np.sin(np.pi * beyond.frequencies * step) ** 2  # of increments over positions
    sampled = free.bead.sampled_spectrum(beyond.frequencies, step)
    n = np.concatenate([part.counts, beyond.counts])
    expected = np.concatenate([part.expected(free.bead), sampled])
    if not (expected > 0).all():
        raise ArithmeticError("a spectrum that vanishes")
    per_noise = 1 / expected
    density = np.concatenate([part.density, beyond.density / gain])
    slopes = np.hstack(
        [
            free.slopes,
            dataclasses.replace(beyond, samples=math.inf, floor=part.floor).slopes(
                free.bead, free.free
            ),
        ]
    )
    fitting = np.hstack([part.counts * free.slopes, np.zeros((len(free.free), beyond.counts.size))])
    covariance = free.covariance
    # the information on the constant that stiffness and drag do not absorb
    influence = n * per_noise - (slopes @ (n * per_noise)) @ covariance @ fitting
    information = float(influence @ per_noise)
    if information < _DISTINCT * float(n @ per_noise**2):
        return None
    added = float(influence @ (density * per_noise - 1)) / information
    p_value = 2 * float(ndtr(-abs(added) * information / math.sqrt(influence**2 @ (1 / n))))
    if p_value >= _UNLIKELY:
        return None
    variance = added / (2 * step)
    shift = covariance @ (fitting @ per_noise) * added
    harm = (
        *(np.abs(shift) / np.sqrt(np.diag(covariance))),
        abs(variance) / free.bead.variance
        / math.sqrt(relative_variance_of_variance(free.bead, fits.whole)),
    )  # fmt: skip
    if max(harm) < HARM:
        return None
    deviation = printed(math.sqrt(abs(variance)), "nm", 2)
    if variance > 0:
        text = f"it contains white noise of about {deviation}"
        rounding = resolution**2 / 12 - free.bead.noise**2
        if rounding > _BY_ROUNDING * variance:
            text += (
                f", of which {printed(math.sqrt(rounding), 'nm', 2)} is the rounding to multiples "
                f"of {printed(resolution, 'nm', 3)}"
            )
        return Finding("noise", f"{text}: give --noise fit")
    text = "the bead moves less from sample to sample than in a trap"
    if not exposure_known:
        text += ", probably by motion blur; give the exposure"
    if not free.bead.displaced_mass and float(part.frequencies[-1]) > _FAST:
        or_blur = "" if exposure_known else ", or motion blur"
        text = (
            "the bead moves less from sample to sample than in a trap, probably by fluid "
            f"inertia{or_blur}"
        )
    elif not free.bead.seen_as_it_is:
        text = "the bead moves less from sample to sample than this detector would record"
    return Finding("blur", text)


def _unknown_exposure(fit: WhittleFit, step: float) -> Finding | None:
    """Return a finding if an exposure that the record does not exclude changes the stiffness.

    The exposures tested are a quarter, half and all of the sampling interval `step`, s. There is
    also a finding if the record agrees much better with an exposure than without.
    """
    exposures = [dataclasses.replace(fit.bead, exposure=part * step) for part in _EXPOSURES]
    exposed = [fitted(fit.periodogram, bead, fit.free, _ROUGHLY) for bead in exposures]
    best = max(exposed, key=lambda each: each.log_likelihood)
    if math.erfc(math.sqrt(max(best.log_likelihood - fit.log_likelihood, 0))) < IMPROBABLE:
        return Finding(
            "blur", "its positions seem averaged over about "
            f"{printed(best.bead.exposure, 'ms', 2)}, with a stiffness of "
            f"{printed(best.bead.stiffness, 'pN/um', 3)}: give the exposure"
        )  # fmt: skip
    likeliest = max(best.log_likelihood, fit.log_likelihood)
    allowed = [e for e in exposed if 2 * (likeliest - e.log_likelihood) < _NOT_EXCLUDED]
    harm = _HARM_IF_ANY * fit.uncertainty(1, 0)
    harmful = [e for e in allowed if abs(math.log(e.bead.stiffness / fit.bead.stiffness)) > harm]
    if not harmful:
        return None
    worst = harmful[0]
    k = f"the stiffness would be {printed(worst.bead.stiffness, 'pN/um', 3)}"
    if worst.uncertainty(1, 0) > 1:
        k = "the stiffness would not be determined"
    return Finding(
        "exposure", "the exposure is not given; if it were "
        f"{printed(worst.bead.exposure, 'ms', 2)}, {k}; give the exposure of the detector, or "
        "exposure = 0 if it does not average"
    )  # fmt: skip


def spectrum_p_value(fit: WhittleFit) -> float:
    """Return the p-value of Bartlett's test (Kolmogorov and Smirnov) for the fitted spectrum.

    The test uses the cumulative periodogram divided by the fit. The limit of its distribution is
    corrected for a finite number of ordinates (Vrbik, Pioneer J. Theor. Appl. Stat. 15, 15 (2018)).
    """
    passed = np.cumsum(fit.ratios)
    n = passed.size - 1
    if n < 1:
        return 1.0
    passed = passed[:-1] / passed[-1]
    before = np.arange(n) / n
    farthest = max(float((passed - before).max()), float((before + 1 / n - passed).max()))
    x = farthest * math.sqrt(n)
    return float(kolmogorov(x + 1 / (6 * math.sqrt(n)) + (x - 1) / (4 * n)))


def _line(fits: Fits, above: float) -> Finding | None:
    """Return a finding for motion at single frequencies above `above`, Hz, such as a vibration.

    The ratios of the periodogram's ordinates to the fitted spectrum are distributed exponentially,
    which determines the distribution of their largest value (R. A. Fisher, Proc. R. Soc. A 125, 54
    (1929)).
    """
    bead, part = fits.free.bead, fits.free.periodogram
    first = int(np.searchsorted(part.covered[0], above, side="right"))
    frequencies, ratio = part.covered[0][first:], fits.free.ratios[first:]
    least = -math.log(-math.expm1(math.log1p(-IMPROBABLE) / max(len(ratio), 1)))
    high = np.flatnonzero(ratio > least)
    expected = bead.sampled_spectrum(frequencies[high], part.step, part.samples)
    excess = float((ratio[high] - 1) @ expected) / (part.samples * part.step)
    share = excess / bead.variance
    harmless = HARM * math.sqrt(relative_variance_of_variance(bead, fits.whole))
    if not high.size or share < harmless:
        return None
    lines = np.split(high, np.flatnonzero(np.diff(high) > _LINE) + 1)
    peaks = [int(line[ratio[line].argmax()]) for line in lines]
    size = dict(zip(high.tolist(), ratio[high] * expected, strict=True))
    peaks.sort(key=lambda i: -size[i])
    told = [f"{frequencies[i]:.3g}" for i in sorted(peaks[:_LINES_TOLD])]
    more = " and more" if len(peaks) > _LINES_TOLD else ""
    return Finding(
        "line", f"it oscillates at {' and '.join(told)} Hz{more}, "
        f"{printed(math.sqrt(excess), 'nm', 2)} rms, which increases the variance by "
        f"{100 * share:.0f} % unless it is removed"
    )  # fmt: skip


def _spectrum(free: WhittleFit) -> Finding | None:
    """Return a finding if the spectrum disagrees with the fit of stiffness and drag."""
    if spectrum_p_value(free) >= REFUTED:
        return None
    text = "the spectrum disagrees with a trapped bead"
    highest = float(free.periodogram.frequencies[-1])
    if not free.bead.displaced_mass and highest > _FAST:
        below = printed(highest, "kHz", 2)
        text += f"; at frequencies up to {below} fluid inertia matters; give it"
    return Finding("spectrum", text)


def _drag(fits: Fits) -> Finding | None:
    """Return a finding if the given drag contradicts the fitted one.

    This is a likelihood-ratio test (S. S. Wilks, Ann. Math. Stat. 9, 60 (1938)).
    """
    gain = 2 * (fits.free.log_likelihood - fits.fit.log_likelihood)
    if chdtrc(1, max(gain, 0)) >= IMPROBABLE:
        return None
    ratio = fits.free.bead.drag / fits.fit.bead.drag
    text = (
        f"temperature and drag contradict the diffusion, which implies {ratio:.3g} times this drag"
    )
    if ratio > 1 and fits.fit.bead.wall is None:
        text += ", as beside a wall"
    return Finding("drag", text)
