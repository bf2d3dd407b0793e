"""Microrheology of a recording: moduli of the medium from the thermal motion of a trapped bead."""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import LinAlgWarning
from scipy.special import chdtrc

from tweezer.calibration import digits
from tweezer.calibration.axis import APART, UNCERTAIN, findings_of
from tweezer.calibration.by_axis import ByAxis
from tweezer.calibration.equipartition import equipartition
from tweezer.calibration.findings import IMPROBABLE, Finding, Fits, spectrum_p_value
from tweezer.calibration.fits import Record
from tweezer.calibration.histogram import resolution_of
from tweezer.calibration.setup import Known, Setup
from tweezer.calibration.whittle import MOTION, WhittleFit, best_start, usable
from tweezer.microrheology.fit import MOST, AxisSpectrum, MediumFit, fits_of
from tweezer.microrheology.medium import Medium, ViscoelasticBead
from tweezer.microrheology.results import (
    AxisRheology,
    Element,
    Interval,
    Modulus,
    Residuals,
    Rheology,
)
from tweezer.reading.recording import Recording, load_recording
from tweezer.scene.arguments import numbers_in_si
from tweezer.values.arrays import Array, Complex
from tweezer.values.errors import ResultError
from tweezer.values.printed import printed
from tweezer.values.units import QuantitiesLike, QuantityLike

if TYPE_CHECKING:
    import xarray as xr

#: Half the width of a 95 % interval, in standard uncertainties.
_INTERVAL = 1.96
#: Number of frequencies of the moduli in a decade, by default.
_PER_DECADE = 10
#: Number of bins of the residuals.
_BINS = 60
#: Smallest number of ordinates in a bin of the residuals.
_LEAST = 4
#: Density of the medium for estimating fluid inertia, kg/m^3.
_DENSITY = 1000.0
#: Relative change of the drag by fluid inertia above which a finding reports it.
_INERTIA = 0.1
#: Viscosity for which drags are computed, Pa s: drags are proportional to it.
_UNIT = 1.0


def rheology(
    source: Recording | xr.Dataset | str | Path,
    *,
    temperature: QuantityLike | None = None,
    radius: QuantityLike | None = None,
    wall: QuantityLike | None = None,
    exposure: QuantityLike | None = None,
    diode: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None,
    noise: QuantityLike | None = None,
    leave_out: Sequence[str | tuple[float, float]] = (),
    drift: QuantityLike | None = None,
    fit_range: str | tuple[float, float] | None = None,
    frequencies: QuantitiesLike | None = None,
) -> Rheology:
    """Return storage and loss modulus of the medium about a trapped bead, from its thermal motion.

    The medium is a solvent with Maxwell elements, mu(s) = eta_s + sum eta_j/(1 + s tau_j), so its
    complex modulus is G* = s mu(s) at s = 2 pi i f. The bead in its harmonic trap is a network
    without mass. Its autocovariance is a sum of exponentials, so the spectrum of the samples is
    known exactly. It includes all aliases, the exposure and the leakage of a finite recording
    (`TrappedBead.sampled_spectrum`). It is fitted by maximum likelihood for
    exponentially distributed ordinates (P. Whittle, Ark. Mat. 2, 423 (1953)), along all axes
    together: the medium is the same for all, and each axis has its own stiffness.

    The Bayesian information criterion determines the number of elements, from 0 to 5, and whether
    the samples contain white noise. Confidence intervals follow from Fisher's information by the
    delta method. The differences to the fits with another element and with white noise are added
    in quadrature.

    Parameters
    ----------
    source : Recording, xarray.Dataset, str or Path
        A recording in metres, or a source for `load_recording`.
    temperature : float or str, optional
        Temperature of the medium, K. For a run of tweezer, temperature and radius default to its
        scene.
    radius : float or str, optional
        Radius of the bead, m.
    wall : float or str, optional
        Distance of the bead centre from a wall perpendicular to the beam, m. The mobility beside
        the wall then applies instead of 6 pi r.
    exposure : float or str, optional
        Exposure time of each position, s, from 0 to the sampling interval. If it is not given, 0
        is assumed, and a finding reports motion blur that is present or possible.
    diode : float, str or pair, optional
        Photodiode response: half-power frequency of the delayed part, Hz, optionally with the
        fraction that is detected without delay.
    noise : float or str, optional
        Standard deviation of the white detector noise, m. By default, or with "fit", it is fitted
        if that lowers the Bayesian information criterion.
    leave_out : sequence of str or pair, optional
        Frequency bands to remove from the recording, "49 Hz..51 Hz" or two numbers, Hz.
    drift : float or str, optional
        Frequency below which drift is removed, Hz.
    fit_range : str or pair, optional
        Frequency range of the fit, "10 Hz..10 kHz" or two numbers, Hz.
    frequencies : array_like, optional
        Frequencies of the moduli, Hz. Default: ten per decade in the range in which they are
        valid, from the inverse duration to half the sampling rate.

    Returns
    -------
    Rheology
        Moduli and Maxwell elements with 95 % confidence intervals, and the trap along each axis.

    Raises
    ------
    ResultError
        Without a temperature or a radius, for positions in volts, for frequencies outside the
        range, and for everything that `calibrate` refuses.

    Notes
    -----
    The inertia of bead and fluid is neglected. An elasticity that does not relax within the
    recording cannot be distinguished from the trap, so it is part of the stiffness.

    Examples
    --------
    >>> thermal = {"forces": {"brownian": True}, "simulation": {"model": "overdamped"}}
    >>> run = tweezer.simulate(tweezer.load_scene("silica-1um").replace(**thermal), "20 ms")
    >>> found = tweezer.rheology(tweezer.load_recording(run).since("2 ms"))
    >>> len(found.elements)  # water: no Maxwell element beside the solvent
    1
    """
    recording = source if isinstance(source, Recording) else load_recording(source)
    setup = Setup(
        temperature=temperature, radius=radius, wall=wall, exposure=exposure, diode=diode,
        noise=noise, leave_out=leave_out, drift=drift, fit_range=fit_range,
    )  # fmt: skip
    return analysed(recording, setup, frequencies)


def analysed(
    recording: Recording, setup: Setup, frequencies: QuantitiesLike | None = None
) -> Rheology:
    """Return the rheology of a recording, with bead, wall and detector from `setup`.

    The moduli are computed at `frequencies`, Hz, by default ten per decade.
    """
    known = _known(recording, setup)
    unmeasured = digits.of_samples(recording.positions) if recording.scene is None else ()
    records = [
        Record(recording, axis, known, signal, (), None, (), unmeasured)
        for axis, signal in zip(recording.axes, recording.positions.T, strict=True)
    ]
    try:
        with (
            warnings.catch_warnings(action="error", category=LinAlgWarning),
            np.errstate(divide="raise", over="raise", invalid="raise"),
        ):
            signals = [known.left_out.without(each.signal, recording.step) for each in records]
            spectra = [_spectrum(*each) for each in zip(records, signals, strict=True)]
            fit, larger = fits_of(spectra, noise=known.detector.noise is None)
            axes = [
                _along(record, signal, fit, larger, i)
                for i, (record, signal) in enumerate(zip(records, signals, strict=True))
            ]
    except (ArithmeticError, ValueError, np.linalg.LinAlgError, LinAlgWarning):
        raise ResultError(
            f"{recording.name}: no bead in a trap moves like this signal; it may be noise, or "
            "another quantity"
        ) from None
    band = _band(spectra)
    at = _frequencies(recording.name, frequencies, band)
    unsure = 0.0
    if known.wall is not None:
        unsure = max(known.wall.relative_uncertainty(axis) for axis in recording.axes)
    storage, loss = _moduli(fit, larger, at, unsure)
    elements = _elements(fit, larger, unsure)
    inertia = _inertia(recording, known, fit.medium, at)
    assert known.radius is not None
    return Rheology(
        recording.name, known.temperature, known.radius, known.detector.exposure,
        len(signals[0]), recording.step, recording.note, band, tuple(at.tolist()), storage, loss,
        elements, fit.noisy, ByAxis(axes),
        tuple(_remarks(fit, elements, band, at, inertia)), float(inertia.max()),
        known.left_out,
    )  # fmt: skip


def _known(recording: Recording, setup: Setup) -> Known:
    """Return the known properties of bead, wall and detector.

    Raises `ResultError` for a recording that is not in metres or has a drive, without a radius,
    and for detector parameters that cannot be fitted.
    """
    name = recording.name
    if recording.unit != "m":
        raise ResultError(
            f"{name}: in {'volts' if recording.unit == 'V' else 'watts'}: must be in metres; give "
            'the displacement sensitivity, scale = "0.5 um/V"'
        )
    if recording.drive is not None:
        raise ResultError(f"{name}: has a drive; must be thermal motion alone; omit the drive")
    if recording.scene is None:
        setup = dataclasses.replace(setup, viscosity=_UNIT)
    known = setup.of(recording)
    if known.radius is None:
        raise ResultError(f"{name}: requires the radius of the bead")
    names = {"exposure": "exposure", "diode_frequency": "diode"}
    for each in known.detector.fitted:
        if each in names:
            raise ResultError(
                f"{name}: {names[each]} = 'fit': cannot be distinguished from fast elements of "
                "the medium; must be a value"
            )
    if missing := [axis for axis in recording.axes if axis not in known.drags]:
        raise ResultError(
            f"{name}: {missing[0]}: the mobility beside the wall is not known; read x, y and z"
        )
    return known


def _spectrum(record: Record, signal: Array) -> AxisSpectrum:
    """Return the spectrum of a record to fit, with the bead from which the fit starts."""
    known, detected = record.known, record.bead
    bead = ViscoelasticBead(
        math.nan, math.nan, detected.temperature, exposure=detected.exposure,
        diode_frequency=detected.diode_frequency, diode_fraction=detected.diode_fraction,
        noise=detected.noise,
    )  # fmt: skip
    whole = record.periodogram(signal)
    low, high = known.left_out.fit_range
    ranged = whole[(whole.frequencies >= low) & (whole.frequencies <= high)]
    start = best_start(ranged, signal, bead)
    assert isinstance(start, ViscoelasticBead)
    assert known.viscosity is not None
    return AxisSpectrum(
        record.axis, whole, usable(ranged, start, to_the_end=True), start,
        known.drags[record.axis] / known.viscosity,
    )  # fmt: skip


def _along(
    record: Record, signal: Array, fit: MediumFit, larger: tuple[MediumFit, ...], i: int
) -> AxisRheology:
    """Return trap, residuals and findings along axis number `i`, from its record and the fits."""
    of, bead = fit.spectra[i], fit.bead(i)
    free = (*MOTION, "noise") if fit.noisy else MOTION
    alone = WhittleFit(bead, of.periodogram, free)
    fits = Fits(of.whole, alone, alone, record.known.left_out)
    k = fit.stiffness(i)
    apart = (math.log(each.stiffness(i) / k) / _INTERVAL for each in larger)
    error = math.hypot(fit.stiffness_error(i), *apart)
    by_variance = equipartition(signal, fits)
    found = findings_of(record, signal, fits, resolution_of(record.positions))
    if record.known.detector.noise is None:  # the criterion decides about noise
        found = [each for each in found if each.name != "noise"]
    p_value = spectrum_p_value(alone)
    return AxisRheology(
        record.axis, k, k * error, by_variance[0], by_variance[1], bead.noise, p_value,
        _residuals(alone),
        tuple(_judged(found, p_value, (k, k * error), by_variance, record.axis)),
    )  # fmt: skip


def _judged(
    found: list[Finding],
    p_value: float,
    likelihood: tuple[float, float],
    variance: tuple[float, float],
    axis: str,
) -> Iterator[Finding]:
    """Yield the findings about a record along an axis, and about its stiffness.

    `likelihood` and `variance` are the stiffness by each method, with its standard uncertainty.
    """
    for each in found:
        if each.name == "spectrum":
            text = f"the residuals are not white (p = {p_value:.2g}): the spectrum is not that of "
            yield Finding("spectrum", f"{axis}: {text}a bead with these elements")
        else:
            yield Finding(each.name, f"{axis}: {each.text}")
    k, error = likelihood
    if error > UNCERTAIN * k:
        yield Finding("undetermined", f"{axis}: the stiffness is not determined")
    apart = abs(k - variance[0]) / math.hypot(error, variance[1])
    if apart > APART:
        text = f"{apart:.2g} standard uncertainties from the stiffness by the likelihood"
        yield Finding("apart", f"{axis}: equipartition: {text}")


def _residuals(fit: WhittleFit) -> Residuals:
    """Return the spectrum and its residuals in bins that are even in the logarithm of frequency."""
    frequencies, density = fit.periodogram.covered
    edges = np.geomspace(frequencies[0], frequencies[-1] * (1 + 1e-9), _BINS + 1)
    bins = np.digitize(frequencies, edges)
    counts = np.bincount(bins)
    kept = counts >= _LEAST
    every = (frequencies, density, density / fit.ratios, fit.ratios)
    means = [(np.bincount(bins, each)[kept] / counts[kept]).tolist() for each in every]
    errors = (1 / np.sqrt(counts[kept])).tolist()
    return Residuals(*map(tuple, (*means, errors)))


def _band(spectra: list[AxisSpectrum]) -> Interval:
    """Return the lowest and highest frequency, Hz, of the ordinates that were fitted."""
    parts = [each.periodogram.ends for each in spectra]
    return max(float(each[0, 0]) for each in parts), min(float(each[-1, 1]) for each in parts)


def _frequencies(name: str, given: QuantitiesLike | None, band: Interval) -> Array:
    """Return the frequencies (n,) of the moduli, Hz; refuse those outside the band."""
    low, high = band
    if given is None:
        first, last = (_PER_DECADE * math.log10(each) for each in band)
        return np.asarray(10 ** (np.arange(math.ceil(first), last) / _PER_DECADE))
    found = np.atleast_1d(numbers_in_si(f"{name}: frequencies", given, "1/s"))
    for each in found.ravel():
        if not low <= each <= high:
            raise ResultError(
                f"{name}: frequencies = {each:g} Hz: must be from {low:.4g} to {high:.4g} Hz, "
                "where the spectrum was fitted"
            )
    return found


def _moduli(
    fit: MediumFit, larger: tuple[MediumFit, ...], frequencies: Array, unsure: float
) -> tuple[Modulus, Modulus]:
    """Return storage and loss modulus with intervals, by the delta method in logarithms.

    The differences to the `larger` fits, and the relative uncertainty `unsure` of the drag, are
    added in quadrature. Without elements the storage modulus is 0, up to the limit by a larger fit.
    """
    storage, loss = (
        Modulus(*(tuple(each.tolist()) for each in part))
        for part in (
            _with_interval(fit, larger, frequencies, of, unsure) for of in (np.real, np.imag)
        )
    )
    return storage, loss


def _with_interval(
    fit: MediumFit,
    larger: tuple[MediumFit, ...],
    frequencies: Array,
    of: Callable[[Complex], Array],
    unsure: float,
) -> tuple[Array, Array, Array]:
    """Return one modulus, the real or imaginary part `of` G*, and the ends of its intervals, Pa."""
    here, *others = (of(each.medium.modulus(frequencies)) for each in (fit, *larger))
    if not here.any():
        errors = (each.error(of(each.medium.slopes(frequencies))) for each in larger)
        limits = [other + _INTERVAL * error for other, error in zip(others, errors, strict=True)]
        return here, here, np.max(limits, axis=0)
    relative = fit.error(of(fit.medium.slopes(frequencies)) / here)
    squares = (_INTERVAL * relative) ** 2 + (_INTERVAL * unsure) ** 2
    half = np.sqrt(squares + sum(np.log(other / here) ** 2 for other in others))
    return here, here * np.exp(-half), here * np.exp(half)


def _elements(fit: MediumFit, larger: tuple[MediumFit, ...], unsure: float) -> tuple[Element, ...]:
    """Return solvent and elements in the order of their times, with intervals."""
    medium, n = fit.medium, fit.elements
    errors = np.sqrt(np.diag(fit.covariance)[: 1 + 2 * n])
    apart = [math.log(each.medium.solvent / medium.solvent) / _INTERVAL for each in larger]

    def interval(value: float, *errors: float) -> Interval:
        factor = math.exp(_INTERVAL * math.hypot(*errors))
        return value / factor, value * factor

    around = interval(medium.solvent, errors[0], unsure, *apart)
    found = [Element(medium.solvent, around, 0.0, (0.0, 0.0))]
    for j, (viscosity, time) in enumerate(zip(medium.viscosities, medium.times, strict=True), 1):
        of_viscosity = interval(viscosity, errors[j], unsure)
        found.append(Element(viscosity, of_viscosity, time, interval(time, errors[n + j])))
    return tuple(sorted(found, key=lambda each: each.time))


def _inertia(recording: Recording, known: Known, medium: Medium, frequencies: Array) -> Array:
    """Return the relative change of the drag by fluid inertia at `frequencies` (n,), Hz.

    It is sqrt(2 pi f r^2 rho/|mu|) for the radius r, the density rho and the viscosity mu of the
    medium (Basset's force). Runs without fluid inertia have none.
    """
    assert known.radius is not None
    density = _DENSITY
    if recording.scene is not None:
        density = (known.displaced_mass or 0.0) / (4 / 3 * math.pi * known.radius**3)
    angular = 2 * np.pi * frequencies
    viscosity = np.abs(medium.modulus(frequencies)) / angular
    return np.asarray(known.radius * np.sqrt(angular * density / viscosity))


def _remarks(
    fit: MediumFit,
    elements: tuple[Element, ...],
    band: Interval,
    frequencies: Array,
    inertia: Array,
) -> Iterator[Finding]:
    """Yield the findings about the medium."""
    if fit.elements == MOST:
        text = f"the spectrum requires {MOST} elements or more, which are not determined"
        yield Finding("elements", text)
    for number, each in enumerate(elements[1:], 1):
        corner = 1 / (2 * math.pi * each.time)
        if not band[0] <= corner <= band[1]:
            text = f"element {number} relaxes at {corner:.3g} Hz, outside the band of the fit"
            yield Finding("outside", text)
    if len(fit.spectra) > 1:
        gain = fit.gain_alone
        freedom = (len(fit.spectra) - 1) * (1 + 2 * fit.elements)
        if chdtrc(freedom, 2 * max(gain, 0.0)) < IMPROBABLE:
            yield Finding("axes", "the axes contradict each other about the medium")
    if inertia.max() > _INERTIA:
        at = float(frequencies[inertia.argmax()])
        below = frequencies[inertia <= _INERTIA]
        way = f"; end the fit range at {printed(float(below[-1]), 'kHz', 2)}" if below.size else ""
        yield Finding(
            "inertia", f"fluid inertia, which is neglected, changes the drag by "
            f"{100 * inertia.max():.2g} % at {printed(at, 'kHz', 2)}{way}"
        )  # fmt: skip
