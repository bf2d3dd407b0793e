"""Calibration of a bead that oscillates in a gas: its mass, and metres per volt.

The line of the bead in the spectrum of each axis has the resonance frequency Omega, the damping
rate Gamma and the variance V of the signal (`tweezer.calibration.line`). The gas has the drag beta
on the bead (`tweezer.medium`), so the mass is m = beta/Gamma and the stiffness m Omega^2. By
equipartition, <x^2> = k_B T/(m Omega^2), the square of the displacement sensitivity is <x^2>/V.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtr

from tweezer.calibration import digits
from tweezer.calibration.axis import UNCERTAIN
from tweezer.calibration.by_axis import ByAxis
from tweezer.calibration.findings import HARM, IMPROBABLE, REFUTED, Finding, spectrum_p_value, stray
from tweezer.calibration.levitated import LevitatedBead, Resonance
from tweezer.calibration.line import Wander, fitted_line
from tweezer.calibration.results import AxisCalibration, Calibration, Estimate, SpectrumFit
from tweezer.calibration.setup import Known, Setup
from tweezer.calibration.spectra import power_spectrum
from tweezer.calibration.whittle import Periodogram, WhittleFit
from tweezer.fluid.medium import medium
from tweezer.reading.recording import Recording
from tweezer.scene import Scene
from tweezer.scene.bead import bead_properties
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import ResultError
from tweezer.values.printed import printed
from tweezer.values.units import QuantityLike, to_si

#: Shortest record, in damping times 1/Gamma: the damping rate is then known to 26 %.
_DAMPING_TIMES = 30.0
#: Smallest gain in log-likelihood by a line over white noise.
_LEAST_GAIN = 15.0
#: Standard uncertainties in the bound of an error.
_BOUND = 2.0
#: Relative change of a quantity for the derivative of the drag.
_DIFFERENCE = 1e-3
#: Smallest ratio between the density of the bead and that in the scene with a finding.
_APART = 1.5
#: Range of radii for a given density, in the radius of the scene.
_RADII = (1 / 30, 30.0)
#: Arguments that do not apply, and the way to give the quantity.
_REFUSED = {
    "drag": "the drag follows from the gas", "viscosity": "the viscosity follows from the gas",
    "mass": "the mass is determined; give the radius or the density",
    "displaced_mass": "the inertia of the gas is part of the error of the drag",
    "wall": "the drag of a gas beside a wall is not known",
}  # fmt: skip


class Uncertain(NamedTuple):
    """A quantity with its standard uncertainty, in SI units."""

    value: float
    uncertainty: float

    @property
    def relative(self) -> float:
        """Relative uncertainty."""
        return self.uncertainty / self.value

    @classmethod
    def of(cls, name: str, key: str, given: QuantityLike | tuple[QuantityLike, QuantityLike],
           unit: str) -> Uncertain:  # fmt: skip
        """Return a quantity from a number, a text such as "10 mbar +- 5 %", or a pair.

        `name` is the name of the recording, `key` that of the argument, and `unit` its SI unit.
        """
        told = given.replace("±", "+-").split("+-") if isinstance(given, str) else given
        parts = tuple(told) if isinstance(told, list | tuple) else (told,)
        try:
            if not 1 <= len(parts) <= 2:
                raise ValueError("must be a value, optionally with its uncertainty")
            value, error = to_si(parts[0], unit), parts[1] if len(parts) > 1 else 0.0
            if isinstance(error, str) and error.strip().endswith("%"):
                uncertainty = value * float(error.strip().rstrip("%")) / 100
            else:
                uncertainty = to_si(error, unit)
            if value <= 0 or not 0 <= uncertainty < UNCERTAIN * value:
                raise ValueError(
                    f"must be positive, with an uncertainty below {100 * UNCERTAIN:.0f} %"
                )
        except ValueError as error:
            raise ResultError(f"{name}: {key} = {given!r}: {error}") from None
        return cls(value, uncertainty)


@dataclass(frozen=True)
class Gas:
    """Gas about a bead, with its pressure and either the radius or the density of the bead."""

    scene: Scene
    """scene with the given pressure and temperature"""
    pressure: Uncertain
    radius: Uncertain | None
    """radius, m; None if the density is given"""
    density: Uncertain | None
    """density, kg/m^3; None if the radius is given"""

    @classmethod
    def of(cls, name: str, setup: Setup) -> Gas:
        """Return the gas of a setup, for the recording `name`; refuse what does not apply to it."""
        scene = setup.gas
        assert scene is not None
        for key, why in _REFUSED.items():
            if getattr(setup, key) is not None:
                raise ResultError(f"{name}: {key}: cannot be given with a gas; {why}")
        for key in ("exposure", "diode"):
            if getattr(setup, key) == "fit":
                raise ResultError(f"{name}: {key} = 'fit': in a gas it must be a value")
        given = scene.medium.pressure if setup.pressure is None else setup.pressure
        pressure = Uncertain.of(name, "pressure", given, "Pa")  # type: ignore[arg-type]
        changes: dict[str, object] = {"pressure": pressure.value}
        if setup.temperature is not None:
            changes["temperature"] = setup.temperature
        scene = scene.replace(medium=changes)
        if setup.density is not None:
            if setup.radius is not None:
                raise ResultError(
                    f"{name}: radius, density: in a gas one determines the other; omit one of them"
                )
            return cls(
                scene, pressure, None, Uncertain.of(name, "density", setup.density, "kg/m^3")
            )
        of_bead = scene.bead.radius if setup.radius is None else setup.radius
        return cls(scene, pressure, Uncertain.of(name, "radius", of_bead, "m"), None)

    def at(self, radius: float, pressure: float | None = None) -> Scene:
        """Return the scene with a bead of another radius, m, and at another pressure, Pa."""
        return self.scene.replace(
            bead={"radius": radius}, medium={"pressure": pressure or self.pressure.value}
        )

    def radius_at(self, name: str, rate: float) -> float:
        """Return the radius, m, of a bead with the known density and damping rate `rate`, 1/s."""
        from scipy.optimize import brentq

        if self.radius is not None:
            return self.radius.value
        assert self.density is not None
        density, nominal = self.density.value, self.scene.bead.radius

        def excess(log_radius: float) -> float:
            radius = math.exp(log_radius)
            mass = 4 / 3 * math.pi * density * radius**3
            return math.log(bead_properties(self.at(radius)).drag / (mass * rate))

        ends = [math.log(nominal * ratio) for ratio in _RADII]
        if excess(ends[0]) * excess(ends[1]) > 0:
            raise ResultError(
                f"{name}: density = {density:g} kg/m^3: no radius near {printed(nominal, 'nm', 3)} "
                "has the damping rate of the recording; check pressure and density"
            )
        return float(math.exp(brentq(excess, *ends, xtol=1e-9)))


def in_gas(recording: Recording, setup: Setup) -> Calibration:
    """Return the calibration of a bead that oscillates in the gas of `setup`.

    Raises `ResultError` for a recording that does not determine the line of an oscillator.
    """
    name = recording.name
    if recording.drive is not None:
        raise ResultError(f"{name}: has a drive; in a gas it must be thermal motion alone")
    gas = Gas.of(name, setup)
    known = dataclasses.replace(setup, temperature=gas.scene.noise_temperature, radius=None).of(
        recording
    )
    records = [
        _Record(recording, axis, signal, known)
        for axis, signal in zip(recording.axes, recording.positions.T, strict=True)
    ]
    unmeasured = digits.of_samples(recording.positions) if recording.scene is None else ()
    found = [record.findings(unmeasured) for record in records]
    rate, p_value = _common_rate(records, found)
    if p_value < IMPROBABLE:
        text = "the damping rates of the axes differ by more than their uncertainties"
        for each in found:
            each.append(Finding("axes", text))
    of_bead = _bead(name, gas, rate, max(each.line.frequency for each in records))
    bead, detector, unexplained = of_bead.bead, known.detector, _unexplained(of_bead.bead, gas)
    axes = [
        _along(record, of_bead, rate, [*findings, *unexplained], recording.unit)
        for record, findings in zip(records, found, strict=True)
    ]
    return Calibration(
        name, of_bead.temperature.value, bead.drag, bead.mass, None, detector.exposure,
        detector.diode, detector.noise, recording.unit, len(recording.times), recording.step,
        recording.note,
        ByAxis(axes), None, None, known.left_out, bead.radius, gas.scene.medium.viscosity, bead,
    )  # fmt: skip


class _Record:
    """Record along one axis with its line, refused unless it determines the line."""

    def __init__(self, recording: Recording, axis: str, signal: Array, known: Known) -> None:
        self.axis, self.signal, self.step = axis, signal, recording.step
        self._name = f"{recording.name}: {axis}"
        detector = dataclasses.replace(known.bead(axis, self.step), mass=None, displaced_mass=None)
        if known.detector.noise is None:
            detector = dataclasses.replace(detector, noise=math.nan)
        spectrum = power_spectrum(signal, self.step)
        bands = known.left_out.of_record(len(signal), self.step)
        try:
            with np.errstate(divide="raise", over="raise", invalid="raise"):
                self.line = fitted_line(
                    lambda starts: Periodogram.in_blocks(
                        spectrum, starts, self.step, len(signal), bands
                    ),
                    detector, known.left_out.fit_range,
                )  # fmt: skip
                self.covariance = self.line.covariance
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            self._refuse("the spectrum has no line of an oscillator")
        self._refuse_undetermined()

    def _refuse(self, why: str) -> None:
        raise ResultError(
            f"{self._name}: {why}; give the band of the line, --fit-range, or omit this column"
        )

    def _refuse_undetermined(self) -> None:
        """Raise `ResultError` for a bead that does not oscillate, or an undetermined line."""
        line, times = self.line, self.damping_times
        if line.gain < _LEAST_GAIN:
            self._refuse("the spectrum has no line above its noise")
        if line.rate >= 2 * line.frequency:
            raise ResultError(
                f"{self._name}: the bead is overdamped, so its spectrum does not determine the "
                "mass; omit the scene and give --radius and --viscosity"
            )
        if times < _DAMPING_TIMES:
            raise ResultError(
                f"{self._name}: the recording lasts {times:.2g} damping times, so the line is not "
                f"resolved; must be {_DAMPING_TIMES:.0f} or more; record longer"
            )
        if math.sqrt(self.covariance[1, 1]) > UNCERTAIN:
            self._refuse("the width of the line is not determined")

    @property
    def damping_times(self) -> float:
        """Length of the record, in damping times 1/Gamma."""
        return self.duration * self.line.rate

    @property
    def duration(self) -> float:
        """Length of the record, s."""
        return len(self.signal) * self.step

    @property
    def fit(self) -> WhittleFit:
        """Fit of the line as that of a bead with an arbitrary drag."""
        return WhittleFit(self.line.bead(), self.line.periodogram, ())

    def findings(self, unmeasured: Sequence[Finding]) -> list[Finding]:
        """Return the findings about the record and its line."""
        line, error = self.line, math.sqrt(self.covariance[1, 1])
        found = [*unmeasured]
        if (off := stray(self.signal, self.step)) is not None:
            found.append(off)
        wander = Wander.of(self.signal, self.step, line)
        if wander is not None and wander.widening(line.rate) > HARM * error:
            for change, its_error, text in (
                (wander.by_energy, wander.by_energy_error,
                 "changes with the energy of the motion (the trap is anharmonic)"),
                (wander.by_time, wander.by_time_error, "drifts"),
            ):  # fmt: skip
                if 2 * ndtr(-abs(change) / its_error) < IMPROBABLE / 10:
                    wide = 100 * 2 * (change / line.rate) ** 2
                    found.append(
                        Finding("broadened", f"the resonance frequency {text}, which widens the "
                                f"line by about {wide:.2g} %")
                    )  # fmt: skip
        if not found and spectrum_p_value(self.fit) < REFUTED:
            text = "the spectrum disagrees with the line of an oscillator: give --fit-range"
            found.append(Finding("spectrum", text))
        return found


def _common_rate(
    records: Sequence[_Record], found: Sequence[list[Finding]]
) -> tuple[Uncertain, float]:
    """Return the damping rate of all axes, 1/s, and the p-value of its being the same.

    It is the weighted mean over the axes without findings, or over all if all have findings.
    """
    clean = [each for each, against in zip(records, found, strict=True) if not against]
    of = clean or list(records)
    logarithms = np.array([each.line.logarithms[1] for each in of])
    # the variance is inverse to the rate; at the common rate a rate that is too large by chance
    # does not get more weight
    weights = np.array([1 / (each.line.rate * each.covariance[1, 1]) for each in of])
    mean = float(weights @ logarithms / weights.sum())
    weights *= math.exp(mean)
    squares = float(weights @ (logarithms - mean) ** 2)
    p_value = float(chdtrc(len(of) - 1, squares)) if len(of) > 1 else 1.0
    rate = math.exp(mean)
    return Uncertain(rate, rate / math.sqrt(weights.sum())), p_value


class _Known(NamedTuple):
    """Bead in its gas, and the relative errors on which its numbers depend.

    Each error belongs to the damping rate, to the drag in the gas at a known radius, or to the
    given radius or density, in this order.
    """

    bead: LevitatedBead
    errors: Array
    """(3,) relative standard uncertainties"""
    mass: Array
    """(3,) derivatives of ln m by the logarithms"""
    drag: Array
    """(3,) derivatives of ln beta by the logarithms"""
    temperature: Uncertain
    """temperature of the thermal motion, K"""


def _bead(name: str, gas: Gas, rate: Uncertain, frequency: float) -> _Known:
    """Return the bead with the damping rate `rate`, 1/s.

    `frequency` is the largest angular resonance frequency, rad/s, for the inertia of the gas.
    """
    radius = gas.radius_at(name, rate.value)
    found = medium(gas.at(radius))
    vorticity_time = radius**2 * found.density / found.viscosity
    bound = math.hypot(found.drag_error / found.drag, math.sqrt(frequency * vorticity_time))
    if math.isnan(bound):
        raise ResultError(
            f"{name}: medium.viscosity: its error is not known; omit it to use that of the gas"
        )
    up, down = 1 + _DIFFERENCE, 1 - _DIFFERENCE

    def slope(low: Scene, high: Scene) -> float:
        drags = (bead_properties(each).drag for each in (high, low))
        return math.log(next(drags) / next(drags)) / math.log(up / down)

    by_radius = slope(gas.at(down * radius), gas.at(up * radius))
    pressure = gas.pressure.value
    by_pressure = slope(gas.at(radius, down * pressure), gas.at(radius, up * pressure))
    given = gas.radius or gas.density
    assert given is not None
    of_gas = math.hypot(bound / _BOUND, by_pressure * gas.pressure.relative)
    errors = np.array([rate.relative, of_gas, given.relative])
    of_rate, of_drag, of_given = np.eye(3)
    # ln r; a given density rho is 3 beta(r)/(4 pi r^3 Gamma)
    size = of_given if gas.radius else (of_given + of_rate - of_drag) / (by_radius - 3)
    drag = of_drag + by_radius * size
    mass = drag - of_rate

    def uncertain(value: float, slopes: Array) -> Uncertain:
        return Uncertain(value, value * float(np.linalg.norm(slopes * errors)))

    of_bead, volume = found.drag / rate.value, 4 / 3 * math.pi * radius**3
    bead = LevitatedBead(
        *uncertain(of_bead, mass), *uncertain(of_bead / volume, mass - 3 * size),
        *uncertain(radius, size), *uncertain(found.drag, drag), *gas.pressure, found.knudsen,
        found.name,
    )  # fmt: skip
    hot = Uncertain(found.effective_temperature, found.effective_temperature_error / _BOUND)
    return _Known(bead, errors, mass, drag, hot)


def _unexplained(bead: LevitatedBead, gas: Gas) -> list[Finding]:
    """Return a finding if the gas does not explain the width of the line, by the scene's bead."""
    known, unit = gas.scene.bead.density, "kg/m^3"
    found, error = bead.density, bead.density_uncertainty
    if gas.density is not None:
        known, unit, found, error = gas.scene.bead.radius, "m", bead.radius, bead.radius_uncertainty
    assert known is not None
    if abs(math.log(found / known)) < math.log(_APART) + _BOUND * error / found:
        return []
    what = "density" if unit == "kg/m^3" else "radius"
    return [
        Finding(
            "width", "the gas does not explain the width of the line: the bead would have a "
            f"{what} of {found:.3g} {unit}, and in the scene it is {known:.3g} {unit}; check the "
            "pressure"
        )
    ]  # fmt: skip


def _along(
    record: _Record, known: _Known, rate: Uncertain, findings: Sequence[Finding], unit: str
) -> AxisCalibration:
    """Return the calibration of an axis with the line of `record` and the mass of the bead.

    The line has the damping rate common to all axes. Its other parameters follow from their
    covariance with the damping rate.
    """
    line, bead, kT = record.line, known.bead, Boltzmann * known.temperature.value
    by_rate = record.covariance[:, 1] / record.covariance[1, 1]
    shift = math.log(rate.value) - line.logarithms[1]
    omega, _, variance = np.exp(line.logarithms + by_rate * shift).tolist()
    covariance = record.covariance + np.outer(by_rate, by_rate) * (
        rate.relative**2 - record.covariance[1, 1]
    )

    def error(of_mass: float, of_omega: float, of_variance: float, of_kT: float = 0.0,
              of_drag: float = 0.0) -> float:  # fmt: skip
        """Return the relative error of a product of powers of m, Omega, V, k_B T and beta."""
        slopes = of_mass * known.mass + of_drag * known.drag
        weights = np.array([of_omega, slopes[0], of_variance])
        others = [*(slopes * known.errors)[1:], of_kT * known.temperature.relative]
        return math.sqrt(weights @ covariance @ weights + np.square(others).sum())

    k = bead.mass * omega**2
    of_k, sensitivity, of_sensitivity = (
        error(1, 2, 0), math.sqrt(kT / (k * variance)), error(-0.5, -1, -0.5, 0.5)
    )  # fmt: skip
    against = [*findings, *(_metres(sensitivity, of_sensitivity) if unit == "m" else [])]
    estimates = [Estimate("power spectrum", k, k * of_k, tuple(against))]
    if unit == "m":
        by_variance = kT / variance
        uncertainty = by_variance * error(0, 0, 1, 1)
        estimates.append(Estimate("equipartition", by_variance, uncertainty, tuple(against)))
    fit = record.fit
    trapped = dataclasses.replace(
        fit.bead, stiffness=k, drag=bead.drag, mass=bead.mass, response=1.0,
        noise=fit.bead.noise * sensitivity, temperature=known.temperature.value,
    )  # fmt: skip
    own = SpectrumFit(
        trapped, k * of_k, bead.drag_uncertainty,
        trapped.corner_frequency * error(1, 2, 0, of_drag=-1),
        float(fit.periodogram.frequencies[-1]), fit.log_likelihood, spectrum_p_value(fit),
    )  # fmt: skip
    hertz, force = line.frequency / (2 * math.pi), k * sensitivity
    errors = np.sqrt(np.diag(record.covariance))
    resonance = Resonance(
        hertz, hertz * float(errors[0]), line.rate, line.rate * float(errors[1]),
        record.damping_times,
    )  # fmt: skip
    return AxisCalibration(
        record.axis, float(record.signal.mean()) * sensitivity, tuple(against), tuple(estimates),
        own, own, record.duration / trapped.relaxation_time, (), sensitivity,
        sensitivity * of_sensitivity, force, force * error(0.5, 1, -0.5, 0.5), resonance=resonance,
    )  # fmt: skip


def _metres(ratio: float, error: float) -> list[Finding]:
    """Return a finding if recorded metres contradict equipartition with the mass by the width.

    `ratio` is the ratio of true to recorded metres, and `error` its relative uncertainty.
    """
    if 2 * ndtr(-abs(math.log(ratio)) / error) >= IMPROBABLE:
        return []
    text = (
        f"the width of the line and equipartition contradict each other: a recorded metre would be "
        f"{ratio:.3g} m; check scale, pressure and temperature"
    )
    return [Finding("metres", text)]
