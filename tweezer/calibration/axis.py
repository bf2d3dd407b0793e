"""Calibration of a trap along one axis: estimates of its stiffness, and findings against them."""

from __future__ import annotations

import math
from collections.abc import Iterator

from scipy.special import chdtrc

from tweezer.calibration import digits
from tweezer.calibration.answers import Answer
from tweezer.calibration.equipartition import corrected, equipartition
from tweezer.calibration.findings import (
    HARM,
    IMPROBABLE,
    SLOW,
    Finding,
    Fits,
    examine,
    relative_variance_of_variance,
    spectrum_p_value,
)
from tweezer.calibration.fits import Record, fits_of
from tweezer.calibration.histogram import potential, resolution_of
from tweezer.calibration.in_time import autocorrelation, displacement, lags_of
from tweezer.calibration.results import AxisCalibration, Estimate, SpectrumFit
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.wall import Height
from tweezer.calibration.whittle import MOTION, STIFFNESS, Detected, WhittleFit
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.printed import printed, signal_unit

#: Largest relative uncertainty of a stiffness that counts as determined.
UNCERTAIN = 0.3
#: Shortest record for displacements and a potential, in relaxation times. In shorter records too
#: many estimates that look determined are wrong.
_FEW = 100.0
#: Largest deviation from the stiffness by the power spectrum without a finding, in standard
#: uncertainties.
APART = 4.0
#: Phase lag of a response above which a finding reports it, in standard uncertainties and in rad.
_LATE = (5.0, 0.02)

#: Largest number of frequencies that are listed
_TOLD = 3
#: Standard deviation of the motion across a wall, over the gap, above which a finding reports it
_ROAMING = 0.3


def along(record: Record) -> AxisCalibration:
    """Return the calibration of a trap along one axis from its record.

    The spectrum is fitted first; the fit then corrects and tests the other estimates. For a record
    in volts, or with a drive, all numbers after the fit are in metres.
    """
    known, answers = record.known, record.answers
    step, unit = record.recording.step, record.recording.unit
    signal = known.left_out.without(record.signal, step)
    left = known.left_out.words(record.signal, signal, step, unit)
    resolution = resolution_of(record.positions)
    fits = fits_of(record, signal)
    fit = fits.fit
    detector = tuple(fit.detected(name) for name in known.detector.fitted)
    scaled, response = "response" in fit.free, fit.bead.response
    if scaled:  # in metres hereafter
        signal, fits, resolution = signal / response, fits.per(response), resolution / response
    bead = fits.fit.bead
    own = _spectrum_fit(fits.fit)
    of_free = own if fits.free is fits.fit else _spectrum_fit(fits.free)
    findings = findings_of(record, signal, fits, resolution)
    # a drift slower than all frequencies of the spectral fits does not affect these fits
    beyond = known.left_out.fit_range[0] > (
        (known.left_out.cosines(len(signal), step) + SLOW) / (2 * len(signal) * step)
    )
    slow = [each for each in findings if each.name == "drift" and beyond]
    findings = [each for each in findings if each not in slow]
    findings += _disagreeing(fits.fit, answers, response)
    if answers and record.drive is not None:
        findings += _jumping(fits.fit, step, record.drive.jumps)
    estimates = []
    for method, found, objections in _numbers(record, signal, fits, slow, resolution):
        k, uncertainty = map(float, found)
        apart = abs(k - bead.stiffness) / math.hypot(uncertainty, own.stiffness_uncertainty)
        against = [*findings, *objections]
        if not 0 < uncertainty <= UNCERTAIN * abs(k):
            against.insert(len(findings), Finding("undetermined", "not determined"))
        elif apart > APART:
            text = f"{apart:.2g} standard uncertainties from the value by the power spectrum"
            against.append(Finding("apart", f"{method}: {text}"))
        estimates.append(Estimate(method, k, uncertainty, tuple(against)))
    relative = fits.fit.uncertainty
    per_volt = 1 / response if scaled else None
    force = bead.stiffness / response if scaled else None
    return AxisCalibration(
        record.axis, float(signal.mean()), tuple(findings), tuple(estimates), own, of_free,
        len(signal) * step / bead.relaxation_time,
        detector, per_volt, per_volt and per_volt * relative(0, 0, 1),
        force, force and force * relative(1, 0, -1), answers,
        (
            *([Finding("left out", left)] if left else []),
            *_undetermined(detector, unit), *_late(fits.fit, answers, response),
            *_unfollowed(record.unfollowed), *_roaming(bead, known.wall),
        ),
        known.drags.get(record.axis),
    )  # fmt: skip


def findings_of(record: Record, positions: Array, fits: Fits, resolution: float) -> list[Finding]:
    """Return the findings about the record, first those about its digits, then about its motion.

    `positions` (n,), m, are the record without drift and excluded bands, `fits` the fits of its
    spectrum and `resolution`, m, the step of its digits. A simulated run has no findings about
    digits.
    """
    detector, recording = record.known.detector, record.recording
    findings = examine(positions, recording.step, fits, detector.exposure_known, resolution)
    if recording.scene is not None:  # a simulated run has not been rounded for a file
        return findings
    harmless = HARM * math.sqrt(relative_variance_of_variance(fits.fit.bead, fits.whole))
    shown = digits.of_axis(
        record.positions, record.bead.noise, recording.unit, harmless, dated=recording.dated
    )
    return digits.first([*record.unmeasured, *([shown] if shown else [])], findings)


def _numbers(
    record: Record, positions: Array, fits: Fits, slow: list[Finding], resolution: float
) -> Iterator[tuple[str, tuple[float, float], list[Finding]]]:
    """Yield each method with its stiffness and its uncertainty (N/m), and its findings.

    `positions` (n,), m, are the record without drift and excluded bands, `fits` the fits of its
    spectrum and `resolution`, m, the step of its digits. `slow` contains findings about a drift
    that affects all methods except the spectral fits.
    """
    scene, step = record.recording.scene, record.recording.step
    fit, bead, made_by = fits.fit, fits.fit.bead, []
    if scene is not None and scene.simulation.method == "one-call":
        text = "simulated by one-call, whose displacements from step to step are not physical"
        made_by = [Finding("one-call", text)]

    def too_few(method: str) -> list[Finding]:
        """Return a finding if the record is too short for a method."""
        text = f"{method}: fewer than {_FEW:g} relaxation times"
        return [Finding("few", text)] if len(positions) * step / bead.relaxation_time < _FEW else []

    def by_spectrum(each: WhittleFit) -> tuple[float, float]:
        """Return the fitted stiffness and its uncertainty, N/m."""
        return each.bead.stiffness, each.bead.stiffness * each.uncertainty(1, 0)

    yield "power spectrum", by_spectrum(fit), made_by
    if fits.free is not fit:
        yield "power spectrum, drag fitted", by_spectrum(fits.free), made_by
    yield "equipartition", equipartition(positions, fits), slow
    if fit.free in (STIFFNESS, MOTION):  # otherwise more parameters were fitted
        lags = lags_of(len(positions), step, bead)
        missing = record.known.left_out.missing(bead, len(positions), step)
        found = displacement(positions, step, bead, lags, missing, record.drag_known)
        yield "displacement", found, [*slow, *made_by, *too_few("displacement")]
        if record.drag_known:
            found = autocorrelation(positions, step, bead, lags, missing)
            yield "autocorrelation", found, [*slow, *made_by]
    well = potential(positions, bead.temperature, resolution)
    if well.stiffness is not None and well.uncertainty is not None:
        found = corrected(well.stiffness, well.uncertainty, fits)
        yield "potential", found, [*slow, *too_few("potential")]


def _disagreeing(
    fit: WhittleFit, answers: tuple[Answer, ...], response: float
) -> Iterator[Finding]:
    """Yield a finding if responses at several frequencies contradict each other.

    The test is whether the fitted bead differs from them by more than their uncertainties. Their
    signal is divided by `response`, V/m or 1, as in `fit`.
    """
    squares = sum(each.per(response).misfit(fit.bead) ** 2 for each in answers)
    if len(answers) > 1 and chdtrc(len(answers) - 1, squares) < IMPROBABLE:
        text = "its responses to the stage at different frequencies contradict each other"
        yield Finding("drive", text)


def _jumping(fit: WhittleFit, step: float, jumps: float) -> Iterator[Finding]:
    """Yield a finding for a stage that jumps between samples, if this affects the sensitivity.

    `jumps` is the fraction of the stage's path that is covered in jumps. A jump may occur at any
    time between two samples, which changes the amplitude of a response by up to `step`, s, over the
    relaxation time: half of it in either direction.
    """
    off = jumps * step / (2 * fit.bead.relaxation_time)
    if off >= HARM * fit.uncertainty(0, 0, 1):
        yield Finding(
            "drive", f"the stage jumps between two samples, an uncertainty of {100 * off:.2g} %: "
            "move it continuously (triangle or sine), or sample faster"
        )  # fmt: skip


def _unfollowed(frequencies: tuple[float, ...]) -> Iterator[Finding]:
    """Yield a finding about `frequencies`, Hz, at which only the stage's sensor shows motion."""
    if frequencies:
        at = " and ".join(f"{each:.3g}" for each in frequencies[:_TOLD])
        more = " and more" if len(frequencies) > _TOLD else ""
        yield Finding(
            "sensor", f"at {at} Hz{more} the bead does not follow the stage: this is noise of "
            "the stage sensor, and is excluded"
        )  # fmt: skip


def _roaming(bead: TrappedBead, height: Height | None) -> Iterator[Finding]:
    """Yield a finding if thermal motion across a wall changes the height of a bead by much."""
    if height is None or not bead.across:
        return
    deviation = math.sqrt(Boltzmann * bead.temperature / bead.stiffness)
    part = deviation / (height.distance - height.radius)
    if part >= _ROAMING:
        yield Finding(
            "height", f"the bead moves by {printed(deviation, 'nm', 2)} rms across the wall, "
            f"{part:.2g} of the gap, so its drag is a mean over heights"
        )  # fmt: skip


def _late(fit: WhittleFit, answers: tuple[Answer, ...], response: float) -> Iterator[Finding]:
    """Yield a finding about the first response whose phase differs from that of the fitted bead.

    The signal of the responses is divided by `response`, V/m or 1, as in `fit`. Fits use only the
    amplitudes, so a phase error reveals a delay of the signal or of the stage's sensor.
    """
    for each in answers:
        late, error = each.per(response).late(fit.bead)
        if abs(late) > max(_LATE[0] * error, _LATE[1]):
            delay = printed(abs(late / (2 * math.pi * each.frequency)), "ms", 2)
            way = "behind" if late > 0 else "before"
            yield Finding(
                "late", f"at {each.frequency:.4g} Hz the signal is {delay} {way} the driven bead; "
                "only the amplitude of the response is used"
            )  # fmt: skip
            return


#: Texts on parameters that are not determined: the parameter, the side of its limit, and its unit.
_WORDS = {
    "exposure": ("the exposure", "below", "ms"),
    "diode_frequency": ("the frequency of a diode", "above", "kHz"),
    "diode_fraction": ("the fraction that a diode detects without delay", "below", ""),
    "noise": ("white noise", "below", "nm"),
}


def _undetermined(detector: tuple[Detected, ...], unit: str) -> Iterator[Finding]:
    """Yield findings about fitted detector parameters that the record does not determine.

    `unit` is the unit of the recording, "m" or "V".
    """
    unseen = [each for each in detector if each.value is None]
    if any(each.name == "diode_frequency" for each in unseen):
        unseen = [each for each in unseen if each.name != "diode_fraction"]
    for each in unseen:
        what, side, of = _WORDS[each.name]
        of = signal_unit(unit) if each.name == "noise" else of
        bound = "" if each.limit is None else f": {side} {printed(each.limit, of, 2)} (95 %)"
        yield Finding("undetermined", f"the recording does not determine {what}{bound}")


def _spectrum_fit(fit: WhittleFit) -> SpectrumFit:
    """Return the public form of a spectral fit, with standard uncertainties in SI units."""
    bead = fit.bead
    return SpectrumFit(
        bead,
        bead.stiffness * fit.uncertainty(1, 0),
        bead.drag * fit.uncertainty(0, 1) if "drag" in fit.free else None,
        bead.corner_frequency * fit.uncertainty(1, -1),
        float(fit.periodogram.frequencies[-1]),
        fit.log_likelihood,
        spectrum_p_value(fit),
    )
