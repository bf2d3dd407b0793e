"""What a recording of thermal motion tells of the trap: stiffness, potential, escape times."""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.constants import Boltzmann
from scipy.linalg import LinAlgWarning, cholesky, inv, solve_triangular
from scipy.optimize import least_squares, minimize
from scipy.special import chdtri, ndtr

from tweezer.analysis.recording import Recording, load_recording
from tweezer.analysis.spectra import (
    TrappedBead,
    autocovariance,
    mean_squared_displacement,
    power_spectrum,
    standard_error,
    statistical_inefficiency,
)
from tweezer.bead import bead_properties
from tweezer.errors import ResultError
from tweezer.scene import Scene

Array = NDArray[np.float64]

#: the spectrum is fitted up to so many times the frequency where it rolls off; to where the square
#: of the part that leaked, times the ordinates, is that; and over no fewer ordinates than that
_RANGE, _LEAKAGE, _LEAST_ORDINATES = 20.0, 0.1, 50
#: lags of the fits in time, in relaxation times, and how many
_LAGS, _LAG_COUNT = (0.1, 2.0), 10
#: after so many relaxation times nothing is remembered
_FORGOTTEN = 20.0

#: what is not trusted: a record of fewer relaxation times, for with 21 of them one free bead in a
#: hundred looks trapped (D. A. Dickey and W. A. Fuller, J. Am. Stat. Assoc. 74, 427 (1979)); a
#: relative uncertainty above; a spectrum whose p-value is below; two numbers further apart, in
#: standard uncertainties; a start further from the mean, in standard deviations
_RELAXATIONS, _UNCERTAIN, _IMPROBABLE, _APART, _FAR = 30.0, 0.3, 1e-3, 4.0, 6.0

#: K, which a medium may have
_TEMPERATURES = (50.0, 5000.0)
#: standard deviation of a Gaussian over the median of the distance to its middle
_DEVIATION_PER_MEDIAN = 1.4826

#: bins of a histogram: how far from the mean they reach and how wide they may be, in standard
#: deviations; the independent samples that one needs, and that those at two deviations should have
_REACH, _NARROWEST, _WIDEST = 4.0, 0.2, 0.5
_COUNTS, _COUNTS_AT_TWO = 10.0, 20.0
_DENSITY_AT_TWO = math.exp(-2) / math.sqrt(2 * math.pi)
#: how far up a potential is taken for a parabola, in k_B T, and the bins that this needs
_PARABOLA, _LEAST_BINS = 2.0, 5


@dataclass(frozen=True)
class Estimate:
    """The stiffness of a trap by one method."""

    method: str
    """"equipartition", "power spectrum", "power spectrum, drag fitted", "displacement" (MSD),
    "autocorrelation" or "potential\""""
    stiffness: float
    """k, N/m"""
    uncertainty: float
    """standard uncertainty of k, N/m; statistical alone, temperature and drag taken as exact"""
    caveat: str
    """why it is not to be trusted; empty if nothing speaks against it"""


@dataclass(frozen=True)
class SpectrumFit:
    """A fit to a power spectrum by maximum likelihood."""

    bead: TrappedBead
    """stiffness and drag as fitted, or the drag as given"""
    stiffness_uncertainty: float
    """standard uncertainty, N/m"""
    drag_uncertainty: float | None
    """standard uncertainty, kg/s; None for a given drag. That of D = k_B T/beta is as large in
    proportion"""
    corner_frequency_uncertainty: float
    """standard uncertainty of k/(2 pi beta), Hz"""
    highest_frequency: float
    """Hz, fitted up to"""
    log_likelihood: float
    """of the fit, to compare it with others of the same ordinates"""
    p_value: float
    """how probable a spectrum as ill-fitting or worse is; too large rather than too small, by the
    parameters fitted"""


@dataclass(frozen=True)
class AxisCalibration:
    """The trap along one axis."""

    axis: str
    centre: float
    """mean position, m"""
    estimates: tuple[Estimate, ...]
    fit: SpectrumFit
    """with the drag given; the one below if none was"""
    free_fit: SpectrumFit
    """corner frequency and diffusion both fitted: the drag is k_B T/D"""
    relaxations: float
    """the record, in relaxation times of `fit`"""

    @property
    def diffusion_uncertainty(self) -> float:
        """Standard uncertainty of k_B T/beta of `free_fit`, m^2/s."""
        bead = self.free_fit.bead
        return bead.diffusion * (self.free_fit.drag_uncertainty or 0.0) / bead.drag

    def __getitem__(self, method: str) -> Estimate:
        return next(estimate for estimate in self.estimates if estimate.method == method)


@dataclass(frozen=True)
class Calibration:
    """Stiffness of a trap from a recording, SI."""

    name: str
    temperature: float
    """K"""
    drag: float | None
    """kg/s; None: fitted"""
    mass: float | None
    """kg; None: overdamped"""
    samples: int
    step: float
    """s"""
    note: str
    """what was left out of the recording"""
    axes: tuple[AxisCalibration, ...]

    def __repr__(self) -> str:
        """In short: of each axis the first stiffness that nothing speaks against."""
        told = []
        for axis in self.axes:
            best = min(axis.estimates, key=lambda estimate: bool(estimate.caveat))
            value = f"{1e6 * best.stiffness:.4g} +- {1e6 * best.uncertainty:.2g} pN/um"
            told.append(f"{axis.axis} {'not to be trusted' if best.caveat else value}")
        return f"<Calibration of {self.name}: {', '.join(told)}>"


def calibrate(
    source: Recording | xr.Dataset | str | Path,
    *,
    temperature: float | None = None,
    drag: float | None = None,
    mass: float | None = None,
) -> Calibration:
    """Stiffness of the trap along each axis of a recording, by several methods.

    source: a recording, or what `load_recording` takes. temperature: of the medium, K; drag: beta,
    kg/s; mass: of the bead, kg. For a run of ours they are the scene's if not given (the mass that
    its model has: none where inertia is left out, m/a2 in the scaled model).

    Equipartition: k_B T over the variance, corrected for the mean being that of the record; its
    uncertainty by the statistical inefficiency of the squares. Power spectrum: the periodogram
    expected of the sampled bead (`TrappedBead.sampled_spectrum`: aliases and leakage are in it;
    with a mass the inertial form), fitted by maximum likelihood for ordinates distributed
    exponentially (P. Whittle, Ark. Mat. 2, 423 (1953)), with the drag given and with the drag
    fitted; uncertainties by Fisher's information; the p-value is that of Bartlett's test, by
    Kolmogorov and Smirnov, on the cumulative periodogram over the fit. Displacement and
    autocorrelation: least squares over ten lags, from 0.1 to 2 relaxation times, weighted with the
    covariance that those averages have for Gaussian motion (M. S. Bartlett, J. R. Stat. Soc. Suppl.
    8, 27 (1946)); the autocorrelation takes the rate of decay alone and needs a drag, but no
    temperature. Potential: `potential`.

    Uncertainties are asymptotic: good to a tenth for records of 300 relaxation times or more. Every
    estimate that cannot be trusted says so (`Estimate.caveat`). Raises `ResultError` without a
    temperature, for what `load_recording` refuses, and for a run without thermal motion.
    """
    recording = source if isinstance(source, Recording) else load_recording(source)
    if recording.scene is not None:
        if not recording.scene.forces.brownian:
            raise ResultError(
                f"{recording.name}: made without thermal motion: nothing to calibrate"
            )
        bead = bead_properties(recording.scene)
        if temperature is None:
            temperature = recording.scene.medium.temperature
        drag = bead.drag if drag is None else drag
        mass = _inertia(recording.scene, bead.mass) if mass is None else mass
    if temperature is None:
        raise ResultError(f"{recording.name}: needs the temperature of the medium")
    for name, value in {"temperature": temperature, "drag": drag, "mass": mass}.items():
        if value is not None and not 0 < value < math.inf:
            raise ResultError(f"{recording.name}: {name} = {value}: must be positive")
    coldest, hottest = _TEMPERATURES
    if not coldest <= temperature <= hottest:
        raise ResultError(
            f"{recording.name}: temperature = {temperature:g}: must be from {coldest:g} to "
            f"{hottest:g} K"
        )
    given = TrappedBead(math.nan, math.nan if drag is None else drag, temperature, mass)
    wrong = []
    if recording.scene is not None and recording.scene.simulation.method == "one-call":
        wrong.append("simulated by one-call: displacements from step to step are not the bead's")
    axes = []
    for axis, positions in zip(recording.axes, recording.positions.T, strict=True):
        try:
            with warnings.catch_warnings(action="error", category=LinAlgWarning):
                axes.append(_calibrated(axis, positions, recording.step, given, wrong))
        except (ArithmeticError, ValueError, np.linalg.LinAlgError, LinAlgWarning) as error:
            raise ResultError(
                f"{recording.name}: {axis}: no trapped bead fits this: {str(error).strip()}"
            ) from None
    samples = len(recording.times)
    return Calibration(
        recording.name,
        temperature,
        drag,
        mass,
        samples,
        recording.step,
        recording.note,
        tuple(axes),
    )


def _inertia(scene: Scene, mass: float) -> float | None:
    """The mass that the scene's model has."""
    model = scene.simulation.model
    if model == "scaled":
        return mass / (scene.simulation.scaling_factor or 1.0)
    return mass if model == "full" else None


def _calibrated(
    axis: str, positions: Array, step: float, given: TrappedBead, wrong: list[str]
) -> AxisCalibration:
    """The trap along one axis; wrong: what speaks against all that comes of how the bead moves."""
    positions = np.ascontiguousarray(positions)
    free, fit = _fit_spectrum(positions, step, given)
    bead, known = fit.bead, not math.isnan(given.drag)
    duration = len(positions) * step

    general = []
    relaxations = duration / bead.relaxation_time
    if relaxations < _RELAXATIONS:
        general.append(
            f"the record is {relaxations:.2g} relaxation times: a free bead looks so too"
        )
    # by the median, which what is far off does not move
    off = np.abs(positions - np.median(positions))
    spread = _DEVIATION_PER_MEDIAN * float(np.median(off))
    farthest = int(off.argmax())
    if spread == 0:
        general.append("more than half of its samples are the same number")
    elif off[0] > _FAR * spread:
        away = off[0] / spread
        general.append(f"it starts {away:.2g} standard deviations off: leave out the beginning")
    elif off[farthest] > _FAR * spread:
        away = off[farthest] / spread
        general.append(f"sample {farthest + 1} is {away:.2g} standard deviations off")
    if 2 * (free.log_likelihood - fit.log_likelihood) > _APART**2:  # S. S. Wilks
        ratio = free.bead.drag / bead.drag
        general.append(
            f"temperature and drag contradict the diffusion, that of {ratio:.3g} times this drag"
        )
    of_model = [*general, *wrong]
    if free.p_value < _IMPROBABLE:
        of_model.append(f"the spectrum is not that of a trapped bead (p = {free.p_value:.1g})")

    estimates = [
        Estimate("power spectrum", bead.stiffness, fit.stiffness_uncertainty, "; ".join(of_model))
    ]

    def add(method: str, found: tuple[float, float], caveats: list[str]) -> None:
        k, uncertainty = found
        apart = abs(k - bead.stiffness) / math.hypot(uncertainty, fit.stiffness_uncertainty)
        if apart > _APART:
            text = f"{apart:.2g} standard uncertainties from that of the power spectrum"
            caveats = [*caveats, text]
        estimates.append(Estimate(method, float(k), float(uncertainty), "; ".join(caveats)))

    if known:
        fitted = free.bead.stiffness, free.stiffness_uncertainty
        add("power spectrum, drag fitted", fitted, of_model)
    add("equipartition", _equipartition(positions, step, bead), general)
    lags = _lags(len(positions), step, bead)
    add("displacement", _displacement(positions, step, bead, lags, known), of_model)
    if known:
        add("autocorrelation", _autocorrelation(positions, step, bead, lags), of_model)
    well = potential(positions, bead.temperature)
    if well.stiffness is not None and well.uncertainty is not None:
        add("potential", (well.stiffness, well.uncertainty), general)
    judged = tuple(map(_judged, estimates))
    return AxisCalibration(axis, float(positions.mean()), judged, fit, free, relaxations)


def _judged(estimate: Estimate) -> Estimate:
    size = abs(estimate.stiffness)
    if 0 < estimate.uncertainty <= _UNCERTAIN * size:
        return estimate
    caveat = "not determined"
    if size > 0 and estimate.uncertainty > 0:
        caveat += f": uncertain by {100 * estimate.uncertainty / size:.2g} %"
    return dataclasses.replace(estimate, caveat="; ".join(filter(None, [caveat, estimate.caveat])))


def _fit_spectrum(
    positions: Array, step: float, given: TrappedBead
) -> tuple[SpectrumFit, SpectrumFit]:
    """With the drag fitted, and with the drag given (again the former if it is not)."""
    from scipy.stats import kstest

    samples = len(positions)
    frequencies, density = power_spectrum(positions, step)
    starts = _guesses(positions, step, frequencies[density.argmax()], given)
    if not math.isnan(given.drag):
        starts += [dataclasses.replace(start, drag=given.drag) for start in starts]
    start = min(
        starts,
        key=lambda bead: _unlikelihood(density, bead.sampled_spectrum(frequencies, step, samples)),
    )
    # leakage correlates the ordinates; it must stay below the noise of their sum
    leakage = (
        start.sampled_spectrum(frequencies, step, samples)
        / start.sampled_spectrum(frequencies, step)
        - 1
    )
    leaking = np.flatnonzero(np.arange(frequencies.size) * leakage**2 > _LEAKAGE)
    within = int((frequencies <= _RANGE * start.roll_off).sum())
    used = slice(max(min(within, *leaking[:1], frequencies.size), _LEAST_ORDINATES))
    frequencies, density = frequencies[used], density[used]

    def fitted(start: TrappedBead, free: int) -> SpectrumFit:
        """The first `free` of stiffness and drag are."""

        def bead(logarithms: Array) -> TrappedBead:
            k, drag = [*np.exp(logarithms), start.drag][:2]
            return dataclasses.replace(start, stiffness=float(k), drag=float(drag))

        def expected(logarithms: Array) -> Array:
            return bead(logarithms).sampled_spectrum(frequencies, step, samples)

        found = minimize(
            lambda logarithms: _unlikelihood(density, expected(logarithms)),
            np.log([start.stiffness, start.drag])[:free],
            method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-5},
        ).x  # fmt: skip
        covariance = _inverse_information(lambda logarithms: np.log(expected(logarithms)), found)
        best = bead(found)
        of_corner = np.array([1.0, -1.0])[:free]
        passed = np.cumsum(density / expected(found))
        return SpectrumFit(
            best,
            best.stiffness * math.sqrt(covariance[0, 0]),
            best.drag * math.sqrt(covariance[1, 1]) if free == 2 else None,
            best.corner_frequency * math.sqrt(of_corner @ covariance @ of_corner),
            float(frequencies[-1]),
            -_unlikelihood(density, expected(found)),
            float(kstest(passed[:-1] / passed[-1], "uniform").pvalue),
        )

    free_fit = fitted(start, 2)
    if math.isnan(given.drag):
        return free_fit, free_fit
    return free_fit, fitted(dataclasses.replace(free_fit.bead, drag=given.drag), 1)


def _unlikelihood(density: Array, expected: Array) -> float:
    """Minus the logarithm of the likelihood of ordinates distributed exponentially."""
    if not (expected > 0).all():  # rounding, far from any bead there is
        return math.inf
    return float(np.sum(np.log(expected) + density / expected))


def _inverse_information(expected: Callable[[Array], Array], at: Array) -> Array:
    """Covariance of the parameters `at` that make values, each uncertain by 1.

    One that the values do not show at all is uncertain by 10^6.
    """
    slopes = np.stack(
        [(expected(at + d) - expected(at - d)) / 2e-4 for d in 1e-4 * np.eye(at.size)]
    )
    return inv(slopes @ slopes.T + 1e-12 * np.eye(at.size))


def _guesses(positions: Array, step: float, peak: float, given: TrappedBead) -> list[TrappedBead]:
    """Beads to start a fit from: an overdamped one, and with a mass one that rings at `peak`."""
    k = Boltzmann * given.temperature / np.var(positions)
    # the squares forget twice as fast; where the bead rings, that is in m/beta
    memory = step * statistical_inefficiency((positions - positions.mean()) ** 2)
    guesses = [dataclasses.replace(given, stiffness=k, drag=k * memory)]
    if given.mass is not None:
        ringing = given.mass * (2 * math.pi * peak) ** 2
        guesses.append(dataclasses.replace(given, stiffness=ringing, drag=given.mass / memory))
    return guesses


def _equipartition(positions: Array, step: float, bead: TrappedBead) -> tuple[float, float]:
    squares = (positions - positions.mean()) ** 2
    missing = bead.variance_of_mean(step, len(positions)) / bead.variance
    relative = standard_error(squares) / squares.mean()
    # a record that shows nothing of the relaxation leaves rounding
    variance = squares.mean() / max(1 - missing, 1 / len(positions))
    # the mean of 1/variance is larger than 1/(the mean variance)
    k = Boltzmann * bead.temperature / (variance * (1 + relative**2))
    return k, k * relative


def _lags(samples: int, step: float, bead: TrappedBead) -> NDArray[np.int64]:
    """Lags of a fit in time, in samples."""
    shortest, longest = (lags * bead.relaxation_time / step for lags in _LAGS)
    most = samples // 4
    ends = min(max(shortest, 1), most - 3), min(max(longest, 3), most)
    return np.unique(np.rint(np.geomspace(*ends, _LAG_COUNT)).astype(np.int64))


def _displacement(
    positions: Array, step: float, bead: TrappedBead, lags: NDArray[np.int64], drag_known: bool
) -> tuple[float, float]:
    def predicted(logarithms: Array) -> Array:
        values = [*np.exp(logarithms), bead.drag]
        other = dataclasses.replace(bead, stiffness=values[0], drag=values[1])
        return other.mean_squared_displacement(lags * step)

    covariance = _covariance_of_averages(
        bead, step, len(positions), lags, _of_squared_displacements
    )
    values = mean_squared_displacement(positions)[lags]
    start = np.log([bead.stiffness] if drag_known else [bead.stiffness, bead.drag])
    found, errors = _least_squares(values, covariance, predicted, start)
    k = math.exp(found[0])
    return k, k * float(errors[0])


def _autocorrelation(
    positions: Array, step: float, bead: TrappedBead, lags: NDArray[np.int64]
) -> tuple[float, float]:
    lags = np.concatenate([[0], lags])
    lost = bead.variance_of_mean(step, len(positions)) / bead.variance

    def predicted(logarithms: Array) -> Array:
        k, variance = np.exp(logarithms)
        other = dataclasses.replace(bead, stiffness=k)
        return variance * (other.autocovariance(lags * step) / other.variance - lost)

    covariance = _covariance_of_averages(bead, step, len(positions), lags, _of_products)
    values = autocovariance(positions)[lags]
    start = np.log([bead.stiffness, values[0]])
    found, errors = _least_squares(values, covariance, predicted, start)
    k = math.exp(found[0])
    return k, k * float(errors[0])


Covariance = Callable[[NDArray[np.int64]], Array]
"""of two positions, by their lag"""


def _of_squared_displacements(C: Covariance, s: NDArray[np.int64], i: int, j: int) -> Array:
    return 2 * (C(s + j - i) - C(s - i) - C(s + j) + C(s)) ** 2


def _of_products(C: Covariance, s: NDArray[np.int64], i: int, j: int) -> Array:
    return C(s) * C(s + j - i) + C(s + j) * C(s - i)


def _covariance_of_averages(
    bead: TrappedBead,
    step: float,
    samples: int,
    lags: NDArray[np.int64],
    of_one: Callable[[Covariance, NDArray[np.int64], int, int], Array],
) -> Array:
    """Covariance (lags, lags) of averages over the record.

    of_one: covariance of two of what is averaged, of lags i and j, that start s samples apart; by
    Isserlis's theorem.
    """
    longest = int(lags[-1])
    reach = min(samples, math.ceil(_FORGOTTEN * bead.relaxation_time / step)) + longest
    table = bead.autocovariance(np.arange(reach + 2 * longest + 1) * step)
    apart = np.arange(-reach, reach + 1)
    result = np.empty((lags.size, lags.size))
    for a, i in enumerate(lags):
        for b, j in enumerate(lags[: a + 1]):
            pairs = np.clip(samples - max(i, j) - np.abs(apart), 0, None)
            products = of_one(lambda lag: table[np.abs(lag)], apart, i, j)
            result[a, b] = result[b, a] = pairs @ products / ((samples - i) * (samples - j))
    return result


def _least_squares(
    values: Array, covariance: Array, predicted: Callable[[Array], Array], start: Array
) -> tuple[Array, Array]:
    """The parameters that fit `values` best, and their standard uncertainties.

    These are by the slopes at the start, which is where the covariance is from too.
    """
    size = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(size, size) + 1e-10 * np.eye(size.size)
    root = cholesky(correlation, lower=True)

    def residuals(parameters: Array) -> Array:
        return solve_triangular(root, (values - predicted(parameters)) / size, lower=True)

    found = least_squares(residuals, start, x_scale=0.1).x
    return found, np.sqrt(np.diag(_inverse_information(residuals, start)))


@dataclass(frozen=True)
class Potential:
    """Potential energy along a line from how often a bead is where."""

    coordinates: Array
    """(bins,) m, centres of the bins that hold enough"""
    energy: Array
    """(bins,) J, above the bottom of the parabola, or without one above the lowest bin"""
    errors: Array
    """(bins,) standard errors, J"""
    stiffness: float | None
    """curvature of the parabola through what is within 2 k_B T of the bottom, N/m; None if fewer
    than 5 bins are, or they curve downwards"""
    uncertainty: float | None
    """its standard uncertainty, N/m"""
    minimum: float | None
    """bottom of the parabola, m"""


def potential(positions: ArrayLike, temperature: float) -> Potential:
    """U = -k_B T ln p (Boltzmann) from the histogram of `positions` (n,), m, in equilibrium.

    Bins reach 4 standard deviations to both sides of the mean; they are as narrow as a fifth of
    one if a Gaussian would still leave 20 independent samples in those two away, but not wider than
    a half. Those with fewer than 10 independent samples are left out; how many are independent is
    told for each by the statistical inefficiency of being in it. The curvature is corrected for the
    width of the bins (Sheppard). Raises `ResultError` for positions that are no such row, or do not
    change. The curvature's error is that of the mean over the record of its influence
    function, so that it has the correlation between bins in it.
    """
    x = np.asarray(positions, np.float64)
    if x.ndim != 1 or not x.size or not np.isfinite(x).all() or np.ptp(x) == 0:
        raise ResultError("positions: must be a row of finite numbers, not all the same")
    kT, centre, deviation = Boltzmann * temperature, x.mean(), x.std()
    independent = x.size / statistical_inefficiency((x - centre) ** 2)
    width = min(max(_COUNTS_AT_TWO / (_DENSITY_AT_TWO * independent), _NARROWEST), _WIDEST)
    count = math.ceil(2 * _REACH / width)
    edges = width * (np.arange(count + 1) - count / 2)
    bins = np.searchsorted(edges, (x - centre) / deviation) - 1
    at = (edges[:-1] + edges[1:]) / 2
    visited, relative = np.zeros(count), np.full(count, np.inf)
    for index in np.unique(bins[(bins >= 0) & (bins < count)]):
        inside = (bins == index).astype(np.float64)
        visited[index] = inside.mean()
        relative[index] = standard_error(inside) / visited[index]
    enough = relative**2 <= 1 / _COUNTS
    at, visited, relative = at[enough], visited[enough], relative[enough]
    U = -np.log(visited) - relative**2 / 2  # in k_B T; the logarithm is concave
    height = U - U.min(initial=np.inf)
    stiffness = uncertainty = minimum = None
    parabola = _parabola(at, height)
    if parabola is not None:
        (a, b, c), low, influence = parabola
        height = height - (c - b**2 / (4 * a))
        stiffness = float(2 * a * (1 + 2 * a * width**2 / 12) * kT / deviation**2)
        minimum = float(centre - deviation * b / (2 * a))
        weights = np.zeros(count + 2)  # also left and right of all bins
        weights[1 + np.flatnonzero(enough)[low]] = influence / visited[low]
        error = standard_error(weights[np.clip(bins, -1, count) + 1])
        uncertainty = float(error * kT / deviation**2)
    return Potential(
        centre + deviation * at, kT * height, kT * relative, stiffness, uncertainty, minimum
    )


def _parabola(at: Array, height: Array) -> tuple[Array, NDArray[np.int64], Array] | None:
    """Coefficients of the parabola at the bottom, the bins it is of, d(curvature)/d(height).

    Weights and bins are those of a first parabola, so that they know little of the noise.
    """
    if not at.size:
        return None
    lowest, fitted = int(height.argmin()), height
    for _ in range(2):
        high = np.flatnonzero(fitted > _PARABOLA)
        low = np.arange(
            high[high < lowest].max(initial=-1) + 1, high[high > lowest].min(initial=at.size)
        )
        if low.size < _LEAST_BINS:
            return None
        root = np.exp(-np.clip(fitted[low], 0, None) / 2)
        solution = np.linalg.pinv(np.vander(at[low], 3) * root[:, None]) * root
        coefficients = solution @ height[low]
        a, b, _ = coefficients
        if a <= 0:
            return None
        fitted = a * (at + b / (2 * a)) ** 2
        lowest = int(fitted.argmin())
    return coefficients, low, 2 * solution[0]


@dataclass(frozen=True)
class EscapeTimes:
    """When beads first are outside a radius."""

    times: Array
    """(trajectories,) s, from the first sample: of the escape, or the end of a record without"""
    escaped: NDArray[np.bool_]
    """(trajectories,)"""
    mean: float | None
    """mean escape time if escapes have a constant rate, s; None without an escape"""
    interval: tuple[float, float | None]
    """95 % confidence interval of that mean, s; no upper end without an escape"""
    p_value: float | None
    """how probable times as unlike those of a constant rate are; None below 5 escapes"""
    survival: tuple[Array, Array, Array, Array]
    """times (s), the part still inside after each, and its 95 % confidence limits; NaN where
    there is none"""


def escape_times(
    times: ArrayLike, positions: ArrayLike, radius: float, centre: ArrayLike = 0.0
) -> EscapeTimes:
    """First times at which each of many trajectories is further than `radius` (m) from `centre`.

    times: (n,) s; positions: (trajectories, n, axes) m, NaN from where a bead was lost; centre:
    (axes,) m. A trajectory that stays inside is censored at its end. An escape is seen at the first
    sample outside: an excursion between two samples is missed.

    The mean is that of maximum likelihood for a constant rate, sum of times over escapes; its
    interval is by chi-square, not below 95 % for records of a fixed length (J. F. Lawless,
    Statistical Models and Methods for Lifetime Data, 4.1). Whether the rate is constant tells the
    score test against Weibull's distribution. Survival: E. L. Kaplan and P. Meier,
    J. Am. Stat. Assoc. 53, 457 (1958), with log-log limits (`scipy.stats.ecdf`).

    Raises `ResultError` if a bead starts outside, or for arrays of other shapes.
    """
    from scipy.stats import CensoredData, ecdf

    t = np.asarray(times, np.float64)
    places = np.asarray(positions, np.float64)
    if places.ndim != 3 or 0 in places.shape or t.shape != places.shape[1:2]:
        raise ResultError(
            f"positions {places.shape}: must be (trajectories, n, axes), with times {t.shape} (n,)"
        )
    if np.isnan(places[:, 0]).any() or not radius > 0:
        raise ResultError("every trajectory needs a place at the first time, and the radius a size")
    away = np.linalg.norm(places - np.asarray(centre), axis=-1)
    outside = ~(away <= radius)
    if outside[:, 0].any():
        start = int(np.argmax(outside[:, 0]))
        raise ResultError(f"trajectory {start} starts outside {radius:g} m: no escape to time")
    escaped = outside.any(axis=1)
    last = np.where(escaped, outside.argmax(axis=1), t.size - 1)
    durations = t[last] - t[0]
    escapes, total = int(escaped.sum()), float(durations.sum())
    upper = 2 * total / chdtri(2 * escapes, 0.975) if escapes else None
    lower = 2 * total / chdtri(2 * escapes + 2, 0.025)
    data = CensoredData(uncensored=durations[escaped], right=durations[~escaped])
    survival = ecdf(data).sf
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # of NaN, as told
        limits = survival.confidence_interval(0.95, method="log-log")
    return EscapeTimes(
        durations,
        escaped,
        total / escapes if escapes else None,
        (lower, upper),
        _constant_rate(durations, escaped) if escapes >= 5 else None,
        (
            survival.quantiles, survival.probabilities,
            limits.low.probabilities, limits.high.probabilities,
        ),
    )  # fmt: skip


def _constant_rate(durations: Array, escaped: NDArray[np.bool_]) -> float:
    """P-value of the score test of an exponential against a Weibull distribution."""
    u = durations * escaped.sum() / durations.sum()
    weighted = u * np.log(u)
    score = escaped.sum() + np.log(u[escaped]).sum() - weighted.sum()
    information = escaped.sum() + (weighted * np.log(u)).sum()
    information -= weighted.sum() ** 2 / escaped.sum()
    return 2 * float(ndtr(-abs(score) / math.sqrt(information)))
