"""Fits of the power spectrum along one axis: of the motion, the detector and the sensitivity."""

from __future__ import annotations

import dataclasses
import itertools
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tweezer.calibration.answers import Answer, KnownDrag
from tweezer.calibration.driving import Drive
from tweezer.calibration.findings import Finding, Fits
from tweezer.calibration.setup import Known
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.whittle import (
    MOTION,
    STIFFNESS,
    Evidence,
    Periodogram,
    WhittleFit,
    best_start,
    fitted,
    usable,
)
from tweezer.reading.recording import Recording
from tweezer.values.arrays import Array

#: Initial values of fitted detector parameters: exposure in sampling intervals, diode frequency
#: over the Nyquist frequency, fraction detected without delay, and noise over the density at the
#: highest frequencies.
_GUESSES = {
    "exposure": (0.3, 0.8),
    "diode_frequency": (0.2, 0.6, 1.5),
    "diode_fraction": (0.2, 0.6),
    "noise": (0.1, 0.6),
}
#: Number of these initial values from which a fit is started.
_TRIED = 2
#: Smallest number of blocks for such a fit.
_LEAST_BLOCKS = 50
#: Highest frequency of a preliminary fit without the detector, in units of the roll-off.
_BEFORE_DETECTOR = 2.0
#: Half the width of the band that is excluded around a drive frequency, in ordinates
_BESIDE = 1.499


@dataclass(frozen=True)
class Record:
    """A record along one axis, with the known properties of its bead and detector."""

    recording: Recording
    axis: str
    known: Known
    signal: Array
    """(n,) signal without its responses to a drive, m or V"""
    beside: tuple[Evidence, ...]
    """evidence in addition to the spectrum: responses to the drive, and an uncertain drag"""
    drive: Drive | None
    unfollowed: tuple[float, ...]
    """frequencies, Hz, at which the column of the stage contains only noise of its sensor"""
    unmeasured: tuple[Finding, ...]
    """findings against the samples of all axes"""

    @property
    def positions(self) -> Array:
        """(n,) positions as recorded."""
        return self.recording.positions[:, self.recording.axes.index(self.axis)]

    @cached_property
    def bead(self) -> TrappedBead:
        """Bead with the known temperature, masses, detector and drag; unknown values are NaN."""
        return self.known.bead(self.axis, self.recording.step)

    @property
    def answers(self) -> tuple[Answer, ...]:
        """Responses to the motion of the stage."""
        return tuple(each for each in self.beside if isinstance(each, Answer))

    @property
    def all_frequencies(self) -> bool:
        """Whether a fit uses all frequencies, because detector or fluid affect the highest."""
        bead = self.bead
        fitted = self.known.detector.fitted
        return bool(fitted or bead.displaced_mass or bead.diode_frequency or bead.noise)

    @property
    def drag_known(self) -> bool:
        """Whether the drag is given."""
        return not math.isnan(self.bead.drag)

    def periodogram(self, signal: Array) -> Periodogram:
        """Return the periodogram of a signal (n,), without the drive's lines and excluded bands."""
        step = self.recording.step
        bin_ = 1 / (len(signal) * step)
        lines = () if self.drive is None else self.drive.frequencies
        driven = [(each - _BESIDE * bin_, each + _BESIDE * bin_) for each in lines]
        left = self.known.left_out.of_record(len(signal), step)
        return Periodogram.of(signal, step, (*driven, *left))


def fits_of(record: Record, signal: Array) -> Fits:
    """Return the spectral fits of a record, with its known drag and with the drag fitted.

    `signal` (n,), m or V, is the signal of the record without drift and excluded bands.
    """
    detector, left = record.known.detector.fitted, record.known.left_out
    scaled = record.recording.unit == "V" or bool(record.answers)
    whole = record.periodogram(signal)
    low, high = left.fit_range
    ranged = whole[(whole.frequencies >= low) & (whole.frequencies <= high)]
    # without masses if the signal is not in metres yet: they are negligible for an initial value
    first = record.bead
    if scaled:
        first = dataclasses.replace(first, mass=None, displaced_mass=None, drag=math.nan)
    start = best_start(ranged, signal, first)
    part = usable(ranged, start, to_the_end=record.all_frequencies)
    if scaled or detector:
        return Fits(whole, *_of_detector(record, part, start, scaled=scaled), left)
    return Fits(whole, *_of_motion(record, part, start), left)


def _of_motion(
    record: Record, part: Periodogram, start: TrappedBead
) -> tuple[WhittleFit, WhittleFit]:
    """Return the fits with the known and with a fitted drag, in metres, for a known detector.

    `part` is the periodogram of the frequencies to fit, and `start` the initial bead.
    """
    drag = record.bead.drag
    free = fit = fitted(part, start, MOTION)
    if record.drag_known and not _evaluated(free):
        free = fit = fitted(part, dataclasses.replace(start, drag=drag), STIFFNESS)
    elif record.drag_known:
        fit = fitted(part, dataclasses.replace(free.bead, drag=drag), STIFFNESS)
    elif record.beside:
        fit = fitted(dataclasses.replace(part, beside=record.beside), free.bead, MOTION)
    return fit, free


def _of_detector(
    record: Record, part: Periodogram, start: TrappedBead, *, scaled: bool
) -> tuple[WhittleFit, WhittleFit]:
    """Return the fits with the known and with a fitted drag, including detector parameters.

    `part` is the periodogram of the frequencies to fit, and `start` the initial bead, in the unit
    of the signal. If `scaled` is true, the response, V/m or 1, is fitted too.
    """
    detector, beside = record.known.detector.fitted, record.beside
    if part.counts.sum() < _LEAST_BLOCKS / 2:
        raise ArithmeticError("too few frequencies for a fit")
    early = part
    if detector:
        early_on = part.frequencies <= _BEFORE_DETECTOR * start.roll_off
        early_on[:_LEAST_BLOCKS] = True
        early = part[early_on]
    start = fitted(early, start, MOTION).bead
    part = dataclasses.replace(part, beside=beside)
    names = (*MOTION, *(["response"] if scaled else []), *detector)
    if scaled:
        start = _in_metres(start, record.bead, beside)
    elif record.drag_known:
        start = dataclasses.replace(start, drag=record.bead.drag)
    starts = sorted(
        _guesses(start, detector, part), key=part.log_likelihood, reverse=True
    )[:_TRIED]  # fmt: skip

    def best(free: tuple[str, ...], starts: list[TrappedBead]) -> WhittleFit:
        """Return the most probable of the fits of the parameters `free` from several starts."""
        found = [fitted(part, each, free) for each in starts]
        return max(found, key=lambda fit: fit.log_likelihood)

    if not record.drag_known:
        fit = best(names, starts)
        answers = tuple(each for each in beside if not isinstance(each, KnownDrag))
        if answers == beside or (scaled and not answers):
            return fit, fit
        # the second fit uses only the record, without an independently known drag
        return fit, fitted(dataclasses.replace(part, beside=answers), fit.bead, names)
    fit = best(tuple(name for name in names if name != "drag"), starts)
    if scaled and not beside:
        return fit, fit  # the response in V/m follows from the drag
    return fit, best(names, [fit.bead])


def _evaluated(fit: WhittleFit) -> bool:
    """Return whether a fit has a finite covariance, which it may lack for white noise."""
    try:
        return bool(np.isfinite(fit.covariance).all())
    except (ArithmeticError, np.linalg.LinAlgError):
        return False


def _in_metres(start: TrappedBead, given: TrappedBead, beside: tuple[Evidence, ...]) -> TrappedBead:
    """Return an initial bead in metres, from `start`, which is in the unit of the signal.

    The response, V/m or 1, follows from the most significant response to a drive in `beside`, or
    from the known drag. `given` has the known drag (or NaN) and masses.
    """
    answers = [each for each in beside if isinstance(each, Answer)]
    drags = [each.drag for each in beside if isinstance(each, KnownDrag)]
    if answers:
        largest = max(answers, key=lambda each: each.signal / each.signal_uncertainty)
        moved = abs(complex(start.driven(largest.frequency)))
        square = (largest.signal / (moved * largest.stage)) ** 2
    else:
        square = (drags[0] if drags else given.drag) / start.drag
    drag = start.drag * square if math.isnan(given.drag) else given.drag
    return dataclasses.replace(
        start, stiffness=start.stiffness / start.drag * drag, drag=drag,
        response=math.sqrt(square), mass=given.mass, displaced_mass=given.displaced_mass,
    )  # fmt: skip


def _guesses(start: TrappedBead, detector: tuple[str, ...], part: Periodogram) -> list[TrappedBead]:
    """Return initial beads with all combinations of initial values of the parameters `detector`.

    `start` provides the other parameters. `part` is the periodogram, whose sampling interval and
    density at the highest frequencies are the units of the initial values.
    """
    nyquist = 0.5 / part.step
    units = {
        "exposure": part.step, "diode_frequency": nyquist, "diode_fraction": 1.0,
        "noise": math.sqrt(part.floor / (2 * part.step)),
    }  # fmt: skip
    choices = [[units[name] * each for each in _GUESSES[name]] for name in detector]
    every = [dict(zip(detector, each, strict=True)) for each in itertools.product(*choices)]
    return [dataclasses.replace(start, **each) for each in every]  # type: ignore[arg-type]
