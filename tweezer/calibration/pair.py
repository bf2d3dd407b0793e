r"""Calibration of two traps whose beads move each other through the fluid.

In one direction, with the mobility M (2, 2) at the distance of the traps and the stiffness
K = diag(k_1, k_2), the displacements of the beads follow

    dx = -M K x dt + noise,   <noise noise^T> = 2 kT M dt.

The modes V, with K V = M^-1 V R and V^T M^-1 V = 1, are independent. Each of them moves like one
bead with the stiffness R_i and the drag 1. So the spectra and cross-spectra of the samples are
V S V^T, where S_i is the spectrum of the samples of mode i, with aliases, leakage and exposure
(`TrappedBead.sampled_spectrum`). They are real. The real part of the periodogram matrix at a
frequency then has a Wishart distribution, of which the fit maximises the likelihood.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tweezer.calibration.findings import REFUTED, Finding, in_words
from tweezer.calibration.left_out import LEAST_ORDINATES, LeftOut
from tweezer.calibration.quantities import SENSITIVITY, STIFFNESS
from tweezer.calibration.spectra import TrappedBead, statistical_inefficiency
from tweezer.calibration.whittle import Periodogram, inverse, scored, usable
from tweezer.fluid.pair import pair_mobilities
from tweezer.reading.recording import LEAST_SAMPLES
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import ResultError
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.units import QuantitiesLike, QuantityLike
from tweezer.values.vectors import Comparable, Vector, fixed

#: Letter of the mobilities in each direction (`pair_mobilities`)
_LETTERS = {"along": "x", "across": "y"}
#: Half the width of a 95 % interval, in standard errors
_INTERVAL = 1.959964
#: Largest logarithmic standard error of a parameter that the record determines
_DETERMINED = 0.5
#: Shortest record, in relaxation times of the slower mode
_RELAXATIONS = 30.0
#: Largest spread of the distance by thermal motion, over the gap; mobilities change by its square
_SPREAD = 0.1
#: Change of a logarithm for a derivative, and the range of a fit about its start
_DIFFERENCE, _RANGE = 1e-6, 20.0
#: Number of frequency bands of the test, and of ordinates in the lowest one
_BANDS, _LOWEST = 20, 20


@dataclass(frozen=True, repr=False, eq=False)
class PairCalibration(Comparable, Shown):
    """Stiffness of two traps with coupled beads, as returned by `calibrate_pair`.

    Entries of arrays of shape (2,) belong to bead 1 and bead 2.
    """

    direction: str
    """direction of the positions: "along" the line of the traps or "across" it"""
    stiffness: Vector
    """k, N/m, shape (2,)"""
    stiffness_error: Vector
    """standard error of `stiffness`, N/m, shape (2,)"""
    stiffness_interval: Vector
    """95 % confidence intervals of `stiffness`, N/m, shape (2, 2), a row for each bead"""
    sensitivity: Vector | None
    """displacement sensitivity, m/V, shape (2,); None for positions in metres"""
    sensitivity_error: Vector | None
    """standard error of `sensitivity`, m/V, shape (2,)"""
    sensitivity_interval: Vector | None
    """95 % confidence intervals of `sensitivity`, m/V, shape (2, 2)"""
    correlation: Vector
    """correlation matrix of the errors of the stiffnesses and then the sensitivities, shape (2, 2)
    or (4, 4)"""
    mobility: Vector
    """mobility matrix of the beads at the distance of the traps, s/kg, shape (2, 2)"""
    uncoupled_stiffness: Vector
    """stiffness by the same record if the coupling is ignored, with Stokes' drag, N/m, shape
    (2,)"""
    uncoupled_sensitivity: Vector | None
    """displacement sensitivity if the coupling is ignored, m/V, shape (2,)"""
    highest_frequency: float
    """highest frequency of the fit, Hz"""
    p_value: float
    """probability of larger deviations of the spectra and the cross-spectrum from the fit"""
    findings: tuple[Finding, ...]
    """findings about the deviations"""

    @property
    def uncoupled_bias(self) -> Array:
        """Relative error of the stiffness if the coupling is ignored, shape (2,)."""
        bias: Array = self.uncoupled_stiffness / self.stiffness - 1
        return bias

    def card(self) -> Card:
        """Return the card with stiffness, sensitivity, the effect of the coupling and p."""
        rows = []
        for k in range(2):
            found = STIFFNESS(self.stiffness[k], self.stiffness_error[k])
            rows.append(found.row(f"stiffness {k + 1}"))
            if self.sensitivity is not None and self.sensitivity_error is not None:
                found = SENSITIVITY(self.sensitivity[k], self.sensitivity_error[k])
                rows.append(found.row(f"sensitivity {k + 1}"))
        bias = ", ".join(f"{100 * each:+.2g} %" for each in self.uncoupled_bias)
        rows.append(Row("stiffness without coupling", bias))
        rows.append(Row("p-value", f"{self.p_value:.2g}"))
        told = in_words(self.findings)
        return Card("PairCalibration", self.direction, tuple(rows), notes=(told,) if told else ())


class _Spectra(NamedTuple):
    """Periodogram matrix of two positions, averaged over blocks of frequencies."""

    frequencies: Array
    """(blocks,) Hz"""
    density: Array
    """(blocks, 2, 2) real part of the one-sided spectral densities, m^2/Hz or V^2/Hz"""
    counts: Array
    """(blocks,) number of ordinates in each block"""
    step: float
    samples: float

    @classmethod
    def of(
        cls, positions: Array, step: float, alone: list[TrappedBead], within: tuple[float, float]
    ) -> _Spectra:
        """Return the blocks in a frequency range, Hz, that leakage does not correlate.

        `alone` contains beads that move approximately like each of the two.
        """
        each = [Periodogram.of(x, step) for x in positions.T]
        both = Periodogram.of(positions.sum(axis=1), step)
        last = min(usable(of, bead).frequencies[-1] for of, bead in zip(each, alone, strict=True))
        f = both.frequencies
        kept = (f >= within[0]) & (f <= min(within[1], last))
        one, two = each[0].density, each[1].density
        cross = (both.density - one - two) / 2
        density = np.stack([one, cross, cross, two], axis=1).reshape(-1, 2, 2)
        return cls(f[kept], density[kept], both.counts[kept], step, both.samples)


class _Pair(NamedTuple):
    """Two coupled beads in harmonic traps, whose spectra are fitted.

    Coordinates are the logarithms of both stiffnesses, and of both sensitivities for positions in
    volts.
    """

    mobility: Array
    temperature: float
    exposure: float

    def expected(self, logs: Array, spectra: _Spectra) -> Array:
        """Return the expected periodogram matrix, (blocks, 2, 2)."""
        modes, shapes = self.modes(np.exp(logs[:2]))
        signals = shapes * np.exp(-logs[2:, None]) if len(logs) > 2 else shapes
        f, step, samples = spectra.frequencies, spectra.step, spectra.samples
        density = np.stack([mode.sampled_spectrum(f, step, samples) for mode in modes], axis=1)
        found: Array = (signals * density[:, None, :]) @ signals.T
        return found

    def modes(self, stiffness: Array) -> tuple[list[TrappedBead], Array]:
        """Return the modes as single beads of drag 1, and their displacements, (bead, mode).

        With the eigenvectors U of K^(1/2) M K^(1/2), V = K^(-1/2) U R^(1/2).
        """
        root = np.sqrt(stiffness)
        rates, vectors = np.linalg.eigh(root[:, None] * self.mobility * root)
        modes = [
            TrappedBead(float(rate), 1.0, self.temperature, exposure=self.exposure)
            for rate in rates
        ]
        return modes, vectors * np.sqrt(rates) / root[:, None]

    def fitted(self, start: Array, spectra: _Spectra) -> tuple[Array, Array]:
        """Return the coordinates of largest likelihood and their covariance."""

        def likelihood(logs: Array) -> float:
            expected = self.expected(logs, spectra)
            traces = np.einsum("fij,fji->f", np.linalg.inv(expected), spectra.density)
            return -float(spectra.counts @ (np.log(np.linalg.det(expected)) + traces))

        def ascent(logs: Array) -> tuple[Array, Array]:
            expected = self.expected(logs, spectra)
            shifted = logs + _DIFFERENCE * np.eye(len(logs))
            changes = np.stack([self.expected(each, spectra) - expected for each in shifted])
            precision = np.linalg.inv(expected)
            slopes = precision @ changes / _DIFFERENCE
            apart = precision @ spectra.density - np.eye(2)
            upward = np.einsum("f,afij,fji->a", spectra.counts, slopes, apart)
            weighted = (spectra.counts[:, None, None] * slopes).reshape(len(logs), -1)
            return upward, weighted @ slopes.transpose(0, 1, 3, 2).reshape(len(logs), -1).T

        ends = np.stack([start - _RANGE, start + _RANGE])
        found = scored(start, ends, likelihood, ascent, 1e-5)
        return found, inverse(ascent(found)[1])


def calibrate_pair(
    positions: QuantitiesLike,
    *,
    interval: QuantityLike,
    distance: QuantityLike,
    radius_1: QuantityLike,
    radius_2: QuantityLike,
    viscosity: QuantityLike,
    temperature: QuantityLike,
    unit: str = "m",
    direction: str = "along",
    exposure: QuantityLike = 0.0,
    fit_range: str | tuple[float, float] | None = None,
) -> PairCalibration:
    r"""Return the stiffness of two traps from the thermal motion of both beads.

    The beads move each other through the fluid, which changes the spectrum of each of them and
    correlates their motion. The spectra and the cross-spectrum are fitted jointly by maximum
    likelihood, with the exact mobility matrix of two spheres at the distance of the traps. The
    model is the exact spectrum of the samples, including aliases and exposure.

    Parameters
    ----------
    positions : array_like, shape (n, 2)
        Positions of bead 1 and bead 2 in one direction, m, or signals of their detectors, V. Both
        must increase in the same direction.
    interval : float or str
        Sampling interval, s.
    distance : float or str
        Distance of the traps, centre to centre, m.
    radius_1, radius_2 : float or str
        Radii of the beads, m.
    viscosity : float or str
        Viscosity of the medium, Pa s.
    temperature : float or str
        Temperature of the medium, K.
    unit : str, optional
        Unit of the positions: "m", or "V" to fit the displacement sensitivities too.
    direction : str, optional
        Direction of the positions: "along" the line of the traps, or "across" it.
    exposure : float or str, optional
        Exposure time of each position, s, from 0 to the sampling interval.
    fit_range : str or pair, optional
        Frequency range of the fit, "10 Hz..10 kHz" or two numbers, Hz. Use it to omit drift at low
        frequencies and noise at high frequencies.

    Returns
    -------
    PairCalibration
        Stiffnesses and sensitivities with standard errors and 95 % confidence intervals, the
        p-value of the fit, and the results if the coupling is ignored. The errors are statistical;
        distance, radii, viscosity and temperature are taken as exact.

    Raises
    ------
    ResultError
        For positions of another shape, for values outside their range, for a record shorter than
        30 relaxation times, if the record does not determine the stiffness, and if thermal
        motion exceeds a tenth of the gap between the beads, which changes their mobilities.
    SceneError
        For a gap between the beads that is too small for the series of their mobilities.

    Notes
    -----
    The p-value follows from a likelihood-ratio test against free spectra in up to 20 frequency
    bands. A finding is reported below 0.01. The inertia of the fluid and of the beads is left out.

    References
    ----------
    J.-C. Meiners and S. R. Quake, Phys. Rev. Lett. 82, 2211 (1999); P. Whittle, J. R. Stat. Soc. B
    15, 125 (1953).

    Examples
    --------
    >>> spread = (1.380649e-23 * 295 / 4e-5) ** 0.5  # in traps of 40 pN/um, m
    >>> x = spread * np.random.default_rng(1).normal(size=(4000, 2))  # independent: rare samples
    >>> found = tweezer.calibrate_pair(
    ...     x, interval="0.1 s", distance="3 um", radius_1="0.5 um", radius_2="0.5 um",
    ...     viscosity="1 mPa s", temperature=295,
    ... )
    >>> bool((abs(found.stiffness - 4e-5) < 3 * found.stiffness_error).all())
    True
    """
    for name, value, allowed in (("unit", unit, ("m", "V")), ("direction", direction, _LETTERS)):
        if value not in allowed:
            raise ResultError(f"{name} = {value!r}: choose from {', '.join(allowed)}")
    x, step = _positions(positions, unit), _in_si("interval", interval, "s")
    radii = _in_si("radius_1", radius_1, "m"), _in_si("radius_2", radius_2, "m")
    mu, apart = _in_si("viscosity", viscosity, "Pa s"), _in_si("distance", distance, "m")
    if apart <= sum(radii):
        raise ResultError(
            f"distance = {apart:g} m: the beads overlap; must exceed the sum of the radii, "
            f"{sum(radii):g} m"
        )
    pair = _Pair(
        _mobility(radii, apart - sum(radii), mu, direction),
        _in_si("temperature", temperature, "K"),
        in_si("exposure", exposure, "s", 0.0, step, error=ResultError),
    )
    within = LeftOut.of("positions", fit_range=fit_range).fit_range
    start, spectra = _start(x, step, pair, unit, within)
    _check_motion(pair, np.exp(start[:2]), apart - sum(radii))
    logs, covariance = pair.fitted(start, spectra)
    _check(pair, logs, covariance, len(x) * step)
    alone = pair._replace(mobility=np.diag(1 / (6 * np.pi * mu * np.array(radii))))
    uncoupled, _ = alone.fitted(logs, spectra)
    p_value = _p_value(pair.expected(logs, spectra), spectra, len(logs))
    return _result(
        direction, pair.mobility, logs, covariance, uncoupled, spectra.frequencies[-1], p_value
    )


def _in_si(name: str, value: QuantityLike, unit: str) -> float:
    """Return a positive number in its SI unit, or raise `ResultError`."""
    return in_si(name, value, unit, np.finfo(float).tiny, error=ResultError)


def _positions(positions: QuantitiesLike, unit: str) -> Array:
    """Return the deviations of the positions from their means, (n, 2), or raise `ResultError`."""
    x = numbers_in_si("positions", positions, unit)
    if x.ndim != 2 or x.shape[1] != 2 or len(x) < LEAST_SAMPLES:
        raise ResultError(
            f"positions: has the shape {x.shape}; must be (n, 2), with {LEAST_SAMPLES} samples or "
            "more"
        )
    if not np.isfinite(x).all():
        raise ResultError("positions: contains values that are not finite; remove them")
    if (np.ptp(x, axis=0) <= 0).any():
        raise ResultError("positions: one of the beads does not move")
    moved: Array = x - x.mean(axis=0)
    return moved


def _mobility(radii: tuple[float, float], gap: float, viscosity: float, direction: str) -> Array:
    """Return the mobility matrix of two spheres in one direction, s/kg, at a gap, m."""
    found = pair_mobilities(*radii, gap, viscosity)
    one, two, both = (float(found[_LETTERS[direction] + name]) for name in ("11", "22", "12"))
    return np.array([[one, both], [both, two]])


def _start(
    x: Array, step: float, pair: _Pair, unit: str, within: tuple[float, float]
) -> tuple[Array, _Spectra]:
    """Return the coordinates at which the fit starts, and the spectra that it uses.

    They follow from the variances, and for volts from the correlation times too. Squares of the
    positions decay twice as fast, but the inefficiency counts both directions of time.
    """
    kT = Boltzmann * pair.temperature
    variances, drags = x.var(axis=0), 1 / np.diag(pair.mobility)
    times = step * np.array([statistical_inefficiency(each**2) for each in x.T])
    stiffness = drags / times if unit == "V" else kT / variances
    alone = [
        TrappedBead(float(k), float(drag), pair.temperature, exposure=pair.exposure)
        for k, drag in zip(stiffness, drags, strict=True)
    ]
    spectra = _Spectra.of(x, step, alone, within)
    if spectra.counts.sum() < min(LEAST_ORDINATES, (len(x) - 1) // 2):
        raise ResultError(
            f"fit_range: leaves {spectra.counts.sum():.0f} frequencies; must leave "
            f"{LEAST_ORDINATES} or more; use a larger range"
        )
    sensitivity = np.sqrt(kT / stiffness / variances)
    of_both = [stiffness, sensitivity] if unit == "V" else [stiffness]
    return np.log(np.concatenate(of_both)), spectra


def _check(pair: _Pair, logs: Array, covariance: Array, duration: float) -> None:
    """Raise `ResultError` if the record is too short or does not determine a parameter."""
    slow = min(pair.modes(np.exp(logs[:2]))[0], key=lambda mode: mode.stiffness)
    if duration * slow.stiffness < _RELAXATIONS:
        raise ResultError(
            f"positions: last {duration * slow.stiffness:.2g} relaxation times; must last "
            f"{_RELAXATIONS:g} or more"
        )
    for k, error in enumerate(np.sqrt(np.diag(covariance))):
        if not 0 < error < _DETERMINED:
            name = "stiffness" if k < 2 else "sensitivity"
            raise ResultError(
                f"positions: do not determine the {name} of trap {k % 2 + 1}; use a longer record "
                "or a shorter interval"
            )


def _check_motion(pair: _Pair, stiffness: Array, gap: float) -> None:
    """Raise `ResultError` if the gap, and with it the mobility, changes by the motion.

    The mean mobility changes by less than the square of the ratio of spread and gap.
    """
    spread = math.sqrt(Boltzmann * pair.temperature * (1 / stiffness).sum())
    if spread > _SPREAD * gap:
        raise ResultError(
            f"distance: thermal motion of {spread:.2g} m exceeds {_SPREAD:.0%} of the gap, "
            f"{gap:.2g} m, so that the mobilities change; use a larger distance or stiffer traps"
        )


def _p_value(expected: Array, spectra: _Spectra, parameters: int) -> float:
    """Return the p-value of the fit against free spectra in bands of frequencies.

    In a band of n ordinates the mean W of whitened periodograms has Wishart's distribution with 2 n
    degrees of freedom. The ratio 2 n (tr W - ln det W - 2), over a third of its
    mean, has approximately the chi-squared distribution of 3 degrees of freedom.
    """
    from scipy.special import chdtrc, psi

    ends = np.cumsum(spectra.counts)
    edges = np.searchsorted(ends, np.geomspace(min(_LOWEST, ends[-1]), ends[-1], _BANDS)) + 1
    root = np.linalg.inv(np.linalg.cholesky(expected))
    whitened = root @ spectra.density @ root.transpose(0, 2, 1) * spectra.counts[:, None, None]
    starts = np.unique([0, *edges[:-1]])
    starts = starts[starts < len(ends)]
    n = np.add.reduceat(spectra.counts, starts)
    w = np.add.reduceat(whitened, starts) / n[:, None, None]
    ratio = 2 * n * (np.trace(w, axis1=1, axis2=2) - np.linalg.slogdet(w)[1] - 2)
    mean = 2 * n * (2 * np.log(n) - psi(n) - psi(n - 0.5))
    return float(chdtrc(3 * len(n) - parameters, (3 * ratio / mean).sum()))


def _result(
    direction: str, mobility: Array, logs: Array, covariance: Array, uncoupled: Array,
    highest: float, p_value: float,
) -> PairCalibration:  # fmt: skip
    """Return the calibration at the coordinates of largest likelihood.

    `uncoupled` contains the coordinates if the coupling is ignored, and `highest` the highest
    frequency of the fit, Hz.
    """
    values, relative = np.exp(logs), np.sqrt(np.diag(covariance))
    errors = values * relative
    intervals = values[:, None] * np.exp(_INTERVAL * relative[:, None] * np.array([-1.0, 1.0]))
    findings: tuple[Finding, ...] = ()
    if p_value < REFUTED:
        told = (
            "the spectra are not those of two coupled beads in harmonic traps "
            f"(p = {p_value:.2g}); check distance, radii and the signs of the detectors, and omit "
            "drift and noise by `fit_range`"
        )
        findings = (Finding("spectra", told),)
    volts = len(logs) > 2
    return PairCalibration(
        direction=direction,
        stiffness=fixed(values[:2]),
        stiffness_error=fixed(errors[:2]),
        stiffness_interval=fixed(intervals[:2]),
        sensitivity=fixed(values[2:]) if volts else None,
        sensitivity_error=fixed(errors[2:]) if volts else None,
        sensitivity_interval=fixed(intervals[2:]) if volts else None,
        correlation=fixed(covariance / np.outer(relative, relative)),
        mobility=fixed(mobility),
        uncoupled_stiffness=fixed(np.exp(uncoupled[:2])),
        uncoupled_sensitivity=fixed(np.exp(uncoupled[2:])) if volts else None,
        highest_frequency=float(highest),
        p_value=p_value,
        findings=findings,
    )
