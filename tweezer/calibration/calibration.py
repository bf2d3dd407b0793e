"""Calibration of a trap from a recording of thermal motion: stiffness, potential, escape times."""

from __future__ import annotations

import dataclasses
import itertools
import math
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgWarning
from scipy.special import chdtrc

from tweezer.calibration import digits
from tweezer.calibration.answers import Answer, KnownDrag
from tweezer.calibration.by_axis import ByAxis
from tweezer.calibration.driving import Drive
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
from tweezer.calibration.free import Diffusion, Given, not_trapped
from tweezer.calibration.histogram import potential, resolution_of
from tweezer.calibration.in_time import autocorrelation, displacement, lags_of
from tweezer.calibration.inertia import Inertia
from tweezer.calibration.left_out import NOTHING, LeftOut
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.wall import ACROSS, Height
from tweezer.calibration.whittle import (
    MOTION,
    STIFFNESS,
    Detected,
    Evidence,
    Periodogram,
    WhittleFit,
    best_start,
    fitted,
    usable,
)
from tweezer.reading.recording import Recording, load_recording
from tweezer.scene.arguments import in_si
from tweezer.scene.bead import bead_properties
from tweezer.scene.sphere import drag_of_translation
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import ResultError
from tweezer.values.rounding import most, rounded, with_uncertainty
from tweezer.values.shown import Card, Row, Shown, Table
from tweezer.values.units import TEMPERATURE, QuantityLike, bare

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

#: Largest relative uncertainty of a stiffness that counts as determined.
_UNCERTAIN = 0.3
#: Shortest record for displacements and a potential, in relaxation times: in shorter ones too many
#: estimates that look determined are wrong.
_FEW = 100.0
#: Largest deviation from the stiffness by the power spectrum, in standard uncertainties.
_APART = 4.0

#: First guesses of what a detector does, for a fit: exposure in steps, frequency of a diode in that
#: of Nyquist and the part that it detects at once, noise in the density at the highest frequencies.
_GUESSES = {
    "exposure": (0.3, 0.8),
    "diode_frequency": (0.2, 0.6, 1.5),
    "diode_fraction": (0.2, 0.6),
    "noise": (0.1, 0.6),
}
#: Number of these guesses that a fit is tried from.
_TRIED = 2
#: Smallest number of blocks of that fit.
_LEAST_BLOCKS = 50
#: Highest frequency of a first fit before that of a detector, in units of the roll-off.
_BEFORE_DETECTOR = 2.0
#: Deviation of the phase of an answer that is said, in standard uncertainties and in rad.
_LATE = (5.0, 0.02)

#: Largest number of frequencies that are listed
_TOLD = 3

#: Motion across a wall, of the gap, from which on it is said: a standard deviation
_ROAMING = 0.3
#: Axes of a run
_EVERY_AXIS = ("x", "y", "z")
#: Half the width of what is left out about the frequency of a drive, in ordinates
_BESIDE = 1.499
#: Number of places at which the drag of a run is taken
_PLACES = 1000

#: Relative excess of an exposure over the step that is allowed, as the step is as uncertain.
_UNEVEN = 1e-3


@dataclass(frozen=True)
class Estimate:
    """The stiffness of a trap by one method."""

    method: str
    """"equipartition", "power spectrum", "power spectrum, drag fitted", "displacement" (MSD),
    "autocorrelation" or "potential\""""
    stiffness: float
    """k, N/m"""
    uncertainty: float
    """standard uncertainty of k, N/m; only statistical: temperature and drag count as exact"""
    findings: tuple[Finding, ...]
    """reasons not to trust it: findings against the record, then against this number; empty if
    there are none"""

    @property
    def caveat(self) -> str:
        """The findings in words."""
        return "; ".join(finding.text for finding in self.findings)

    @property
    def undetermined(self) -> bool:
        """Whether the record does not tell the stiffness."""
        return any(finding.name == "undetermined" for finding in self.findings)

    @property
    def told(self) -> str:
        """The stiffness with its uncertainty and unit."""
        if self.undetermined:
            return "not determined"
        return f"{with_uncertainty(1e6 * self.stiffness, 1e6 * self.uncertainty)} pN/um"

    @property
    def doubt(self) -> str:
        """Why it is not to be trusted; "" if nothing speaks against it."""
        return f"not to be trusted: {self.caveat}" if self.caveat else ""


@dataclass(frozen=True)
class SpectrumFit:
    """A fit to a power spectrum by maximum likelihood."""

    bead: TrappedBead
    """bead with the fitted stiffness, and the fitted or given drag"""
    stiffness_uncertainty: float
    """standard uncertainty, N/m"""
    drag_uncertainty: float | None
    """standard uncertainty of the drag, kg/s; None for a given drag. D = k_B T/beta has the same
    relative uncertainty"""
    corner_frequency_uncertainty: float
    """standard uncertainty of k/(2 pi beta), Hz"""
    highest_frequency: float
    """highest frequency of the fit, Hz"""
    log_likelihood: float
    """log-likelihood, to compare with other fits of the same ordinates"""
    p_value: float
    """probability of a spectrum that fits as badly or worse; rather too large, because of the
    fitted parameters"""


@dataclass(frozen=True, repr=False)
class AxisCalibration(Shown):
    """The trap along one axis."""

    axis: str
    centre: float
    """mean position, m"""
    findings: tuple[Finding, ...]
    """findings against the record, and so against every estimate; empty if there are none"""
    estimates: tuple[Estimate, ...]
    fit: SpectrumFit
    """fit with the given drag; `free_fit` if none was given"""
    free_fit: SpectrumFit
    """fit of both corner frequency and diffusion; the drag is k_B T/D"""
    relaxations: float
    """length of the record, in relaxation times of `fit`"""
    detector: tuple[Detected, ...] = ()
    """parameters of the detector that were fitted"""
    sensitivity: float | None = None
    """m/V; for a record in m with a drive true metres by recorded ones; None if not asked"""
    sensitivity_uncertainty: float | None = None
    """its standard uncertainty"""
    force_sensitivity: float | None = None
    """stiffness times sensitivity, N/V or N/m"""
    force_sensitivity_uncertainty: float | None = None
    """its standard uncertainty"""
    answers: tuple[Answer, ...] = ()
    """to the motion of the stage"""
    remarks: tuple[Finding, ...] = ()
    """what the record does not determine, and other things that speak against no number"""
    drag: float | None = None
    """what is known of the drag along this axis, where the bead is, kg/s; None if nothing"""

    @property
    def diffusion_uncertainty(self) -> float:
        """Standard uncertainty of k_B T/beta of `free_fit`, m^2/s."""
        bead = self.free_fit.bead
        return bead.diffusion * (self.free_fit.drag_uncertainty or 0.0) / bead.drag

    def __getitem__(self, method: str) -> Estimate:
        return next(estimate for estimate in self.estimates if estimate.method == method)

    @property
    def listed(self) -> list[Finding]:
        """All that speaks against the record or a number, in the order of the notes' numbers."""
        every = [*self.findings, *(f for each in self.estimates for f in each.findings)]
        return [each for each in dict.fromkeys(every) if each.name != "undetermined"]

    def mark(self, against: Iterable[Finding]) -> str:
        """By which notes something is not trusted; "" if by none."""
        listed = self.listed
        numbers = ", ".join(str(listed.index(each) + 1) for each in against if each in listed)
        return numbers and f"not trusted: {numbers}"

    def table(self, *, in_words: bool = False) -> Table:
        """A row for each method, with what speaks against it: the numbers of notes, or in words."""
        rows = []
        for each in self.estimates:
            k, error = rounded(1e6 * each.stiffness, 1e6 * each.uncertainty)
            judgement = self.mark(each.findings)
            if each.undetermined:
                k = error = "-"
                judgement = "; ".join(filter(None, ["not determined", judgement]))
            if in_words:
                judgement = each.doubt
            rows.append((each.method, k, error, judgement))
        return Table((f"{self.axis}: stiffness by", "pN/um", "+-", ""), tuple(rows))

    def card(self) -> Card:
        """A row for each method, and numbered notes on what speaks against them."""
        rows = tuple(
            Row(each.method, each.told, self.mark(each.findings)) for each in self.estimates
        )
        notes = tuple(f"{i}  {each.text}" for i, each in enumerate(self.listed, start=1))
        return Card("Stiffness", f"the {self.axis} axis", rows, notes=notes)

    def by(self, method: str) -> Estimate | None:
        """The estimate by a method, if there is one."""
        return next((each for each in self.estimates if each.method == method), None)


@dataclass(frozen=True, repr=False)
class Calibration(Shown):
    """Stiffness of a trap from a recording, SI."""

    name: str
    temperature: float
    """K"""
    drag: float | None
    """far from any wall, kg/s; None if fitted"""
    mass: float | None
    """kg; None if overdamped"""
    displaced_mass: float | None
    """kg of fluid in the bead's place; None: without the inertia of the fluid"""
    exposure: float | None
    """s; None if not known, and taken as 0, or fitted"""
    diode: tuple[float, float] | None
    """frequency (Hz) and part that is detected at once; None without one, or fitted"""
    noise: float | None
    """standard deviation of the noise of the detector, m or V, along the first axis if each has its
    own; None without, or fitted"""
    unit: str
    """of the record: "m" or "V\""""
    samples: int
    step: float
    """s"""
    note: str
    """what was omitted from the recording"""
    axes: ByAxis[AxisCalibration]
    """by number or by name: axes["x"]"""
    wall: Height | None = None
    """the bead's height above a wall; None if not given"""
    free: Diffusion | None = None
    """diffusion along the axes without a detected trap; None if a trap is detected along all"""
    left_out: LeftOut = NOTHING
    """what was left out of the record, and of the fits"""
    radius: float | None = None
    """of the bead, m; None if not known"""
    viscosity: float | None = None
    """of the medium, Pa s; None if not known"""

    @property
    def determined(self) -> bool:
        """Whether each axis has a stiffness, or a free bead a diffusion, without a finding."""
        free = [] if self.free is None else [each.axis for each in self.free.axes]
        trapped = [axis for axis in self.axes if axis.axis not in free]
        return (self.free is None or not self.free.findings) and all(
            any(not each.findings for each in axis.estimates) for axis in trapped
        )

    def card(self) -> Card:
        """For each axis the first stiffness that is trusted; what was given; tables of all."""
        free = [] if self.free is None else [each.axis for each in self.free.axes]
        rows = []
        for axis in self.axes:
            if axis.axis in free:
                rows.append(Row(f"stiffness, {axis.axis}", "no trap is detected"))
                continue
            best = min(axis.estimates, key=lambda estimate: bool(estimate.caveat))
            told = f"{best.told}, by {best.method}"
            rows.append(Row(f"stiffness, {axis.axis}", told, best.doubt))
        if self.free is not None:
            factor, unit = (1e12, "um^2/s") if self.unit == "m" else (1.0, "V^2/s")
            errors = factor * self.free.diffusion, factor * self.free.uncertainty
            doubt = "; ".join(each.text for each in self.free.findings)
            told = f"{with_uncertainty(*errors)} {unit}"
            rows.append(Row("diffusion, as of a free bead", told, doubt))
        rows += [
            Row("temperature", f"{self.temperature:.5g} K"),
            Row("drag", "fitted" if self.drag is None else f"{1e9 * self.drag:.4g} nN s/m"),
            Row("samples", f"{self.samples}, {1 / self.step:.5g} Hz"),
        ]
        tables = tuple(axis.table(in_words=True) for axis in self.axes if axis.axis not in free)
        notes = [self.note] if self.note else []
        return Card("Calibration", self.name, tuple(rows), tables, tuple(notes))


def calibrate(
    source: Recording | xr.Dataset | str | Path,
    *,
    temperature: QuantityLike | None = None,
    drag: QuantityLike | None = None,
    mass: QuantityLike | None = None,
    displaced_mass: QuantityLike | None = None,
    wall: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None,
    radius: QuantityLike | None = None,
    viscosity: QuantityLike | None = None,
    exposure: QuantityLike | None = None,
    diode: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None,
    noise: QuantityLike | None = None,
    drive: str | None = None,
    leave_out: Sequence[str | tuple[float, float]] = (),
    drift: QuantityLike | None = None,
    fit_range: str | tuple[float, float] | None = None,
) -> Calibration:
    """Return the trap stiffness along each axis of a recording, by several methods.

    The recording is tested first (`tweezer.calibration.findings`). Its findings apply to every
    number of the axis. The methods are:

    * Equipartition: k_B T divided by the variance, corrected for the exposure and for the
      subtracted mean. The uncertainty follows from the sum of the ordinates of the spectrum.
    * Power spectrum: the expected periodogram of the sampled bead (`TrappedBead.sampled_spectrum`,
      with aliases and leakage, and with inertia if masses are given). It is fitted by maximum
      likelihood for exponentially distributed ordinates (P. Whittle, Ark. Mat. 2, 423 (1953)), with
      the drag given and with the drag fitted. The uncertainties follow from Fisher's information,
      and the p-value from Bartlett's test (Kolmogorov and Smirnov).
    * Displacement and autocorrelation: least squares over ten lags, from 0.1 to 2 relaxation times,
      weighted with the covariance of these averages for Gaussian motion (M. S. Bartlett, J. R.
      Stat. Soc. Suppl. 8, 27 (1946)). The autocorrelation uses only the rate of decay. It requires
      a drag but no temperature.
    * Potential: `potential`, with the corrections of equipartition.

    Along axes where no trap is detected, the bead is treated as a free bead. `Calibration.free` has
    its diffusion coefficient and the quantities that follow from it: the viscosity, the radius or
    Boltzmann's constant, whichever is not given.

    `tweezer bench calibrate` measures how often the confidence intervals contain the true value.

    Parameters
    ----------
    source : Recording, xarray.Dataset, str or Path
        A recording, or a source for `load_recording`.
    temperature : float or str, optional
        Temperature of the medium, K. This and the following values default to the scene for a run
        of tweezer.
    drag : float or str, optional
        Drag coefficient beta, kg/s. For a run beside a wall it follows from the mean mobility.
    mass : float or str, optional
        Mass of the bead, kg. For a run it depends on the model and `medium.inertia`: it is none
        without inertia, m/a2 in the scaled model, and m + m_f/2 with an added mass.
    displaced_mass : float or str, optional
        Mass of the displaced fluid, kg, for hydrodynamic memory (`TrappedBead`). Requires `mass`.
    wall : float, str or pair, optional
        Distance of the bead centre from a wall across the light, m, or with its standard
        uncertainty "1.2 um +- 50 nm". Requires `radius`. `drag` is then the drag far from the wall;
        the exact mobilities along and across the wall apply to x and y, and to z. An uncertain
        height gives an uncertain drag, which is one more datum of the spectral fit. With fluid
        inertia, from 1.5 radii along the wall and from 2 radii across it, the drag includes the
        flow that the wall reflects (`tweezer.fluid.reflection`).
    radius : float or str, optional
        Radius of the bead, m.
    viscosity : float or str, optional
        Viscosity of the medium, Pa s. With `radius` it sets the drag.
    exposure : float or str, optional
        Exposure time of each position, s, from 0 to the sampling interval, or "fit". An unknown
        exposure is taken as 0, and a finding reports a recording that may have another one. For a
        run, exposure and noise default to the scene's camera, and to 0 without a camera.
    diode : float, str or pair, optional
        Photodiode response: half-power frequency f_3 of the delayed part, Hz, optionally with the
        fraction a that is detected without delay; or "fit".
    noise : float or str, optional
        Standard deviation of the white detector noise, in the unit of the recording, or "fit". A
        value to fit is determined with its uncertainty, or reported as not determined.
    drive : str, optional
        Heading of the column with the motion of the stage, m, which may move to and fro in any way
        (active calibration, `tweezer.calibration.driving`). One fit then determines stiffness, drag
        and displacement sensitivity from the spectrum and the responses. For a recording in volts
        the displacement sensitivity is always fitted, which requires the drag or a drive.
    leave_out : sequence of str or pair, optional
        Frequency bands to remove from the recording, "49 Hz..51 Hz" or two numbers, Hz. The
        results are corrected for the motion of the bead that this and `drift` remove
        (`tweezer.calibration.left_out`).
    drift : float or str, optional
        Frequency below which drift is removed, in whole cosines, Hz.
    fit_range : str or pair, optional
        Frequency range of the spectral fits, "10 Hz..10 kHz" or two numbers, Hz. The other methods
        use all frequencies.

    Returns
    -------
    Calibration
        Stiffness of each axis by each method, with uncertainties and findings.

    Raises
    ------
    ResultError
        Without a temperature, for an exposure longer than the sampling interval, for a source that
        `load_recording` refuses, for a bead in the wall, and for a run without thermal motion.
    """
    recording = source if isinstance(source, Recording) else load_recording(source, drive)
    if isinstance(source, Recording) and drive is not None:
        raise ResultError(f"{recording.name}: is read already; its drive is its own")
    temperature = _in_si(recording, "temperature", temperature, "K")
    drag = _in_si(recording, "drag", drag, "kg/s")
    mass = _in_si(recording, "mass", mass, "kg")
    fluid = _in_si(recording, "displaced_mass", displaced_mass, "kg")
    radius = _in_si(recording, "radius", radius, "m")
    viscosity = _in_si(recording, "viscosity", viscosity, "Pa s")
    left = LeftOut.of(recording.name, leave_out, drift, fit_range)
    left.refuse_too_much(recording.name, len(recording.times), recording.step)
    poles, on_the_way = TrappedBead.poles, False
    asked = {"exposure": exposure, "diode_frequency": diode, "noise": noise}
    detector = tuple(name for name, value in asked.items() if value == "fit")
    if "diode_frequency" in detector:
        detector += ("diode_fraction",)
    exposure = _in_si(recording, "exposure", None if exposure == "fit" else exposure, "s")
    f3, fraction = _diode(recording, None if diode == "fit" else diode)
    noise = _in_si(recording, "noise", None if noise == "fit" else noise, recording.unit)
    noises = dict.fromkeys(recording.axes, noise or 0.0)
    if noise is None and "noise" not in detector and recording.noise is not None:
        noise = recording.noise[0]
        noises = dict(zip(recording.axes, recording.noise, strict=True))
    if recording.scene is not None:
        if not recording.scene.forces.brownian:
            raise ResultError(
                f"{recording.name}: made without thermal motion: nothing to calibrate"
            )
        if temperature is None:
            temperature = recording.scene.medium.temperature
        radius = recording.scene.bead.radius if radius is None else radius
        if viscosity is None:
            viscosity = recording.scene.medium.viscosity
        if drag is None:
            drag = bead_properties(recording.scene).drag
            on_the_way = wall is None
        of_scene = Inertia.of(recording.scene).masses(recording.scene)
        mass = of_scene[0] if mass is None else mass
        if fluid is None:
            fluid = of_scene[1]
            poles = recording.scene.medium.poles or poles
    elif radius is not None and viscosity is not None and drag is None:
        drag = drag_of_translation(viscosity, radius)
    if exposure is None and "exposure" not in detector:
        exposure = recording.exposure
        if exposure is None and recording.scene is not None:
            exposure = 0.0
    if temperature is None:
        raise ResultError(f"{recording.name}: needs the temperature of the medium")
    positive = {
        "temperature": temperature, "drag": drag, "mass": mass, "displaced_mass": fluid,
        "radius": radius, "viscosity": viscosity,
    }  # fmt: skip
    for name, value in positive.items():
        if value is not None and value <= 0:
            raise ResultError(f"{recording.name}: {name} = {value}: must be positive")
    if fluid is not None and mass is None:
        raise ResultError(f"{recording.name}: the inertia of the fluid needs the bead's mass too")
    height = None if wall is None else Height.of(recording.name, wall, radius)
    if height is not None and fluid is not None:
        _refuse_too_low(recording, height)
    coldest, hottest = TEMPERATURE
    if not coldest <= temperature <= hottest:
        raise ResultError(
            f"{recording.name}: temperature = {temperature:g}: must be from {coldest:g} to "
            f"{hottest:g} K"
        )
    step = recording.step
    if exposure is not None and not 0 <= exposure <= step * (1 + _UNEVEN):
        raise ResultError(
            f"{recording.name}: exposure = {exposure:g} s: must be from 0 to the step of the "
            f"samples, {most(step, 4)} s"
        )
    if noise is not None and noise < 0:
        raise ResultError(f"{recording.name}: noise = {noise:g}: must not be negative")
    moved = None
    if recording.drive is not None:
        moved = Drive.of(recording.drive, step)
        if moved is None:
            raise ResultError(
                f"{recording.name}: the drive does not move to and fro; it must be the column of a "
                "moving stage"
            )
    if recording.unit == "V" and drag is None and moved is None:
        raise ResultError(
            f"{recording.name}: in volts: needs the drag, or the motion of the stage that drives "
            "the bead"
        )
    given = TrappedBead(
        math.nan, math.nan, temperature, mass, min(exposure or 0.0, step), fluid, poles, f3,
        fraction, wall=None if height is None else height.radii,
    )  # fmt: skip
    drags = _drags(recording, drag, height, on_the_way=on_the_way)
    made_by: list[Finding] = []
    if recording.scene is not None and recording.scene.simulation.method == "one-call":
        text = "simulated by one-call: displacements from step to step are not the bead's"
        made_by.append(Finding("one-call", text))
    recorded = None if recording.scene is not None else recording.positions
    known = _Known(
        given, detector, exposure is not None or "exposure" in detector,
        bool(height and height.uncertainty), recording.unit, made_by, left,
        0.0 if moved is None else moved.jumps, () if moved is None else moved.frequencies,
        recorded, recording.dated, () if recorded is None else digits.of_samples(recorded),
    )  # fmt: skip
    signals = [
        moved.answers(signal) if moved else (signal, (), ()) for signal in recording.positions.T
    ]
    if moved and not any(answers for _, answers, _ in signals):
        raise ResultError(f"{recording.name}: no axis moves as the drive does")
    axes: dict[str, AxisCalibration] = {}
    # those that are driven first: they tell the drag of the others
    order = sorted(range(len(signals)), key=lambda i: not signals[i][1])
    for i in order:
        axis, (signal, answers, unfollowed) = recording.axes[i], signals[i]
        beside: tuple[Evidence, ...] = answers
        if axes and not answers and recording.unit == "V" and drag is None:
            beside = (_told_by(next(iter(axes.values())), axis, height),)
        if axis in drags and height is not None and known.uncertain:
            beside = (*beside, KnownDrag(drags[axis], height.relative_uncertainty(axis)))
        try:
            with (
                warnings.catch_warnings(action="error", category=LinAlgWarning),
                np.errstate(divide="raise", over="raise", invalid="raise"),
            ):
                found = _calibrated(
                    axis,
                    signal,
                    step,
                    known.along(i, axis, drags.get(axis), noises[axis]),
                    beside,
                    resolution_of(recording.positions[:, i]),
                )
                remarks = (*found.remarks, *_unfollowed(unfollowed))
                axes[axis] = dataclasses.replace(found, drag=drags.get(axis), remarks=remarks)
        except (ArithmeticError, ValueError, np.linalg.LinAlgError, LinAlgWarning):
            raise ResultError(
                f"{recording.name}: {axis}: no trapped bead moves like this; is it noise, or a "
                "signal of another kind?"
            ) from None
    if height is not None and ACROSS in axes:
        axes[ACROSS] = _of_its_height(axes[ACROSS], height)
    of_free = Given(
        temperature, radius, viscosity, drag, exposure, {} if noise is None else noises,
        {axis: drag / along for axis, along in drags.items()} if drag is not None else {},
        recording.unit, (*left.bands, (0.0, left.drift), *left.of_fit),
    )  # fmt: skip
    free = not_trapped(
        recording.name, {axis: axes[axis].findings for axis in recording.axes},
        np.stack([signal for signal, *_ in signals], axis=1), step, of_free,
    )  # fmt: skip
    if free is not None and known.unmeasured:
        against = digits.first(known.unmeasured, free.findings)
        free = dataclasses.replace(free, findings=tuple(against))
    return Calibration(
        recording.name, temperature, drag, mass, fluid, exposure,
        None if f3 is None else (f3, fraction), noise, recording.unit,
        len(signals[0][0]), step, recording.note, ByAxis(axes[axis] for axis in recording.axes),
        height, free, left, radius, viscosity,
    )  # fmt: skip


def _of_its_height(axis: AxisCalibration, height: Height) -> AxisCalibration:
    """The axis across a wall, with a remark if the bead's own motion changes its height by much."""
    bead = axis.fit.bead
    deviation = math.sqrt(Boltzmann * bead.temperature / bead.stiffness)
    part = deviation / (height.distance - height.radius)
    if part < _ROAMING:
        return axis
    text = (
        f"the bead moves by {1e9 * deviation:.2g} nm rms across the wall, {part:.2g} of the gap: "
        "its drag is a mean over heights"
    )
    return dataclasses.replace(axis, remarks=(*axis.remarks, Finding("height", text)))


def _refuse_too_low(recording: Recording, height: Height) -> None:
    """Refuse a height at which the drag with the inertia of the fluid is not known."""
    from tweezer.fluid import LOWEST

    for axis in recording.axes:
        way = "across" if axis == ACROSS else "along"
        if height.radii < LOWEST[way]:
            raise ResultError(
                f"{recording.name}: wall = {height.distance:g}: with the inertia of the fluid the "
                f"drag of {axis}, {way} the wall, is known from {LOWEST[way]:g} radii on; leave "
                "out the displaced mass, or that column"
            )


def _drags(
    recording: Recording, drag: float | None, height: Height | None, *, on_the_way: bool
) -> dict[str, float]:
    """Known drags along the axes, kg/s.

    drag: far from walls; on_the_way: whether they are those of a run's scene, where the bead went.
    """
    if drag is None:
        return {}
    if height is not None:
        return {axis: drag / height.mobility(axis) for axis in recording.axes}
    if not on_the_way or recording.scene is None:
        return dict.fromkeys(recording.axes, drag)
    from tweezer.fluid import drag as drag_of

    beside = drag_of(recording.scene)
    if beside.uniform:
        return dict.fromkeys(recording.axes, drag)
    if recording.axes != _EVERY_AXIS:  # the place is not known
        return {}
    every = max(len(recording.positions) // _PLACES, 1)
    places = recording.positions[::every]
    mobilities = beside.mobilities(places).value.mean(axis=0)
    return {axis: 1 / float(mobilities[int(axis == ACROSS)]) for axis in recording.axes}


def in_metres(recording: Recording, calibration: Calibration) -> Recording:
    """A recording as it was calibrated: in metres, without answers to a drive and what else was
    left out.
    """
    moved = None if recording.drive is None else Drive.of(recording.drive, recording.step)
    columns = [
        (axis.sensitivity or 1.0)
        * calibration.left_out.without(
            moved.answers(signal)[0] if moved else signal, recording.step
        )
        for axis, signal in zip(calibration.axes, recording.positions.T, strict=True)
    ]
    return dataclasses.replace(
        recording, times=recording.times[: len(columns[0])], positions=np.stack(columns, axis=1),
        unit="m", drive=None,
    )  # fmt: skip


def _diode(
    recording: Recording, value: QuantityLike | tuple[QuantityLike, QuantityLike] | None
) -> tuple[float | None, float]:
    """Frequency of a diode, Hz, and the part that it detects at once."""
    if value is None:
        return None, 0.0
    parts: Sequence[QuantityLike]
    if isinstance(value, str):
        parts = value.split(",")
    else:
        parts = value if isinstance(value, tuple) else (value,)
    if len(parts) > 2:
        raise ResultError(
            f"{recording.name}: diode = {value!r}: must be a frequency, and the part from 0 to 1 "
            'that is detected at once: "14 kHz, 0.3"'
        )
    f3 = _in_si(recording, "diode", bare(parts[0]), "1/s")
    fraction = _in_si(recording, "diode", bare(parts[1]), "") if len(parts) == 2 else 0.0
    assert f3 is not None
    assert fraction is not None
    if f3 <= 0 or not 0 <= fraction < 1:
        raise ResultError(
            f"{recording.name}: diode = {value!r}: its frequency must be positive, and the part "
            "that is detected at once from 0 to below 1"
        )
    return f3, fraction


def _in_si(recording: Recording, name: str, value: QuantityLike | None, unit: str) -> float | None:
    """An argument in its SI unit; None if not given."""
    if value is None:
        return None
    return in_si(f"{recording.name}: {name}", value, unit, error=ResultError)


@dataclass(frozen=True)
class _Known:
    """What is given for all axes of a record."""

    bead: TrappedBead
    """temperature, masses and detector; the drag, or NaN"""
    detector: tuple[str, ...]
    """parameters of the detector that are fitted"""
    exposure: bool
    """whether the exposure is given or fitted"""
    uncertain: bool
    """whether a known drag is as uncertain as the bead's height"""
    unit: str
    made_by: list[Finding]
    """findings against every number that uses the dynamics"""
    left_out: LeftOut
    """what is left out of the record"""
    jumps: float
    """part of the way of a stage that it covers within single samples"""
    driven: Sequence[float]
    """frequencies of a drive, Hz, whose ordinates and the two beside each are not fitted"""
    recorded: Array | None
    """(n, axes) positions as the digits of a file show them; None for a run of tweezer, and (n,)
    along one axis"""
    dated: bool
    """whether their order is known"""
    unmeasured: tuple[Finding, ...]
    """findings against the samples of all axes"""

    def along(self, axis: int, name: str, drag: float | None, noise: float) -> _Known:
        """Return the known quantities of one axis: its drag, kg/s, and the detector's noise."""
        exact = drag if drag is not None and not self.uncertain else math.nan
        bead = dataclasses.replace(self.bead, drag=exact, noise=noise, across=name == ACROSS)
        recorded = None if self.recorded is None else self.recorded[:, axis]
        return dataclasses.replace(self, bead=bead, recorded=recorded)

    @property
    def all_frequencies(self) -> bool:
        """Whether the spectrum is known up to Nyquist's frequency, or what it tells there asked."""
        bead = self.bead
        return bool(self.detector or bead.displaced_mass or bead.diode_frequency or bead.noise)

    @property
    def drag(self) -> bool:
        """Whether the drag is given."""
        return not math.isnan(self.bead.drag)


def _told_by(other: AxisCalibration, axis: str, height: Height | None) -> KnownDrag:
    """The drag of a bead along an axis by that along another one."""
    fit = other.free_fit
    assert fit.drag_uncertainty is not None
    ratio = 1.0 if height is None else height.mobility(other.axis) / height.mobility(axis)
    return KnownDrag(ratio * fit.bead.drag, fit.drag_uncertainty / fit.bead.drag)


def _fits(
    signal: Array,
    step: float,
    known: _Known,
    beside: tuple[Evidence, ...],
) -> Fits:
    """The periodogram of a signal, the fit with the drag as known, and that with a free drag."""
    given, detector = known.bead, known.detector
    scaled = known.unit == "V" or any(isinstance(each, Answer) for each in beside)
    bin_ = 1 / (len(signal) * step)
    driven = [(each - _BESIDE * bin_, each + _BESIDE * bin_) for each in known.driven]
    left = known.left_out
    whole = Periodogram.of(signal, step, (*driven, *left.of_record(len(signal), step)))
    low, high = left.fit_range
    ranged = whole[(whole.frequencies >= low) & (whole.frequencies <= high)]
    # without masses where metres are not known yet: they are negligible for a start
    first = given
    if scaled:
        first = dataclasses.replace(given, mass=None, displaced_mass=None, drag=math.nan)
    start = best_start(ranged, signal, first)
    if not (scaled or detector):
        part = usable(ranged, start, to_the_end=known.all_frequencies)
        free = fit = fitted(part, start, MOTION)
        if known.drag and not _evaluated(free):
            free = fit = fitted(part, dataclasses.replace(start, drag=given.drag), STIFFNESS)
        elif known.drag:
            fit = fitted(part, dataclasses.replace(free.bead, drag=given.drag), STIFFNESS)
        elif beside:
            fit = fitted(dataclasses.replace(part, beside=beside), free.bead, MOTION)
        return Fits(whole, fit, free, left)
    part = usable(ranged, start, to_the_end=known.all_frequencies)
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
        start = _in_metres(start, given, beside)
    elif known.drag:
        start = dataclasses.replace(start, drag=given.drag)
    starts = sorted(
        _guesses(start, detector, part), key=part.log_likelihood, reverse=True
    )[:_TRIED]  # fmt: skip

    def best(free: tuple[str, ...], starts: list[TrappedBead]) -> WhittleFit:
        found = [fitted(part, each, free) for each in starts]
        return max(found, key=lambda fit: fit.log_likelihood)

    if not known.drag:
        fit = best(names, starts)
        answers = tuple(each for each in beside if not isinstance(each, KnownDrag))
        if answers == beside or (scaled and not answers):
            return Fits(whole, fit, fit, left)
        # what the record tells by itself
        without_drag = dataclasses.replace(part, beside=answers)
        return Fits(whole, fit, fitted(without_drag, fit.bead, names), left)
    fit = best(tuple(name for name in names if name != "drag"), starts)
    if scaled and not beside:
        return Fits(whole, fit, fit, left)  # volts a metre follow from the drag
    return Fits(whole, fit, best(names, [fit.bead]), left)


def _evaluated(fit: WhittleFit) -> bool:
    """Whether a fit is at a bead that can be computed; a record of white noise leads beyond."""
    try:
        return bool(np.isfinite(fit.covariance).all())
    except (ArithmeticError, np.linalg.LinAlgError):
        return False


def _in_metres(start: TrappedBead, given: TrappedBead, beside: tuple[Evidence, ...]) -> TrappedBead:
    """The start of a fit from one whose unit of length is that of the signal."""
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
    """Beads with detectors that a fit may start from."""
    nyquist = 0.5 / part.step
    units = {
        "exposure": part.step, "diode_frequency": nyquist, "diode_fraction": 1.0,
        "noise": math.sqrt(part.floor / (2 * part.step)),
    }  # fmt: skip
    choices = [[units[name] * each for each in _GUESSES[name]] for name in detector]
    every = [dict(zip(detector, each, strict=True)) for each in itertools.product(*choices)]
    return [dataclasses.replace(start, **each) for each in every]  # type: ignore[arg-type]


def _calibrated(
    axis: str,
    signal: Array,
    step: float,
    known: _Known,
    beside: tuple[Evidence, ...],
    resolution: float,
) -> AxisCalibration:
    """The trap along one axis."""
    recorded, signal = signal, known.left_out.without(signal, step)
    left = known.left_out.words(recorded, signal, step, known.unit)
    fits = _fits(signal, step, known, beside)
    fit = fits.fit
    detector = tuple(fit.detected(name) for name in known.detector)
    scaled = "response" in fit.free
    response = fit.bead.response
    if scaled:  # from here on in metres
        signal, fits = signal / response, fits.per(response)
    positions, fit, free = signal, fits.fit, fits.free
    bead = fit.bead
    own = _spectrum_fit(fit)
    of_free = own if free is fit else _spectrum_fit(free)
    findings = examine(positions, step, fits, known.exposure, resolution / response)
    if known.recorded is not None:
        harmless = HARM * math.sqrt(relative_variance_of_variance(bead, fits.whole))
        shown = digits.of_axis(
            known.recorded, known.bead.noise, known.unit, harmless, dated=known.dated
        )
        findings = digits.first([*known.unmeasured, *([shown] if shown else [])], findings)
    # a drift slower than all frequencies of the fits is not in their way
    beyond = known.left_out.fit_range[0] > (
        (known.left_out.cosines(len(positions), step) + SLOW) / (2 * len(positions) * step)
    )
    slow = [each for each in findings if each.name == "drift" and beyond]
    findings = [each for each in findings if each not in slow]
    answers = tuple(each for each in beside if isinstance(each, Answer))
    findings += _disagreeing(fit, answers, response)
    if answers:
        findings += _jumping(fit, step, known.jumps)

    estimates = []

    def add(method: str, found: tuple[float, float], against: list[Finding]) -> None:
        k, uncertainty = map(float, found)
        apart = abs(k - bead.stiffness) / math.hypot(uncertainty, own.stiffness_uncertainty)
        if not 0 < uncertainty <= _UNCERTAIN * abs(k):
            against = [Finding("undetermined", "not determined"), *against]
        elif apart > _APART:
            text = f"{apart:.2g} standard uncertainties from that of the power spectrum"
            against = [*against, Finding("apart", f"{method}: {text}")]
        estimates.append(Estimate(method, k, uncertainty, (*findings, *against)))

    relaxations = len(positions) * step / bead.relaxation_time
    made_by = known.made_by

    def too_few(method: str) -> list[Finding]:
        text = f"{method}: fewer than {_FEW:g} relaxation times"
        return [Finding("few", text)] if relaxations < _FEW else []

    add("power spectrum", (bead.stiffness, own.stiffness_uncertainty), made_by)
    if free is not fit:
        fitted_too = free.bead.stiffness, of_free.stiffness_uncertainty
        add("power spectrum, drag fitted", fitted_too, made_by)
    add("equipartition", equipartition(positions, fits), slow)
    if fit.free in (STIFFNESS, MOTION):  # else there is more that is as uncertain
        lags = lags_of(len(positions), step, bead)
        missing = known.left_out.missing(bead, len(positions), step)
        found = displacement(positions, step, bead, lags, missing, known.drag)
        add("displacement", found, [*slow, *made_by, *too_few("displacement")])
        if known.drag:
            found = autocorrelation(positions, step, bead, lags, missing)
            add("autocorrelation", found, [*slow, *made_by])
    well = potential(positions, bead.temperature, resolution / response)
    if well.stiffness is not None and well.uncertainty is not None:
        found = corrected(well.stiffness, well.uncertainty, fits)
        add("potential", found, [*slow, *too_few("potential")])
    per_volt = 1 / response if scaled else None
    force = bead.stiffness / response if scaled else None
    return AxisCalibration(
        axis, float(positions.mean()), tuple(findings), tuple(estimates), own, of_free, relaxations,
        detector, per_volt, per_volt and per_volt * fit.uncertainty(0, 0, 1),
        force, force and force * fit.uncertainty(1, 0, -1), answers,
        (
            *([Finding("left out", left)] if left else []),
            *_undetermined(detector, known.unit), *_late(fit, answers, response),
        ),
    )  # fmt: skip


def _disagreeing(fit: WhittleFit, answers: tuple[Answer, ...], response: float) -> list[Finding]:
    """Answers at several frequencies that no bead gives together."""
    squares = sum(each.per(response).misfit(fit.bead) ** 2 for each in answers)
    if len(answers) < 2 or chdtrc(len(answers) - 1, squares) >= IMPROBABLE:
        return []
    text = "its answers to the stage at different frequencies contradict each other"
    return [Finding("drive", text)]


def _jumping(fit: WhittleFit, step: float, jumps: float) -> list[Finding]:
    """Return a stage that jumps between samples, with what the bead moves until the next one.

    Whether it jumps just after a sample or just before the next one changes the size of an answer
    by the step over the relaxation time, half of it to either side.
    """
    off = jumps * step / (2 * fit.bead.relaxation_time)
    if off < HARM * fit.uncertainty(0, 0, 1):
        return []
    text = (
        f"the stage jumps between two samples, which leaves {100 * off:.2g} % open: move it "
        "steadily, as a triangle or a sine, or sample faster"
    )
    return [Finding("drive", text)]


def _unfollowed(frequencies: tuple[float, ...]) -> list[Finding]:
    """Frequencies (Hz) at which the column of a stage is the noise of its sensor."""
    if not frequencies:
        return []
    at = " and ".join(f"{each:.3g}" for each in frequencies[:_TOLD])
    more = " and more" if len(frequencies) > _TOLD else ""
    text = (
        f"at {at} Hz{more} the bead does not follow the stage: the sensor of the stage has noise "
        "there, which is left out"
    )
    return [Finding("sensor", text)]


def _late(fit: WhittleFit, answers: tuple[Answer, ...], response: float) -> list[Finding]:
    """Answers whose phase is not that of the bead, of which only the size is used."""
    for each in answers:
        late, error = each.per(response).late(fit.bead)
        if abs(late) > max(_LATE[0] * error, _LATE[1]):
            delay = 1e3 * late / (2 * math.pi * each.frequency)
            text = (
                f"at {each.frequency:.4g} Hz the record is {abs(delay):.2g} ms "
                f"{'behind' if late > 0 else 'before'} the bead that the stage drives; only the "
                "size of the answer is used"
            )
            return [Finding("late", text)]
    return []


#: Words for what is not determined: the parameter, what bounds it, factor and unit.
_WORDS = {
    "exposure": ("the exposure", "below", 1e3, "ms"),
    "diode_frequency": ("the frequency of a diode", "above", 1e-3, "kHz"),
    "diode_fraction": ("the part that a diode detects at once", "below", 1.0, ""),
    "noise": ("white noise", "below", 1e9, "nm"),
}


def _undetermined(detector: tuple[Detected, ...], unit: str) -> list[Finding]:
    """What was fitted of the detector and is not seen in the record."""
    unseen = [each for each in detector if each.value is None]
    if any(each.name == "diode_frequency" for each in unseen):
        unseen = [each for each in unseen if each.name != "diode_fraction"]
    found = []
    for each in unseen:
        what, side, factor, of = _WORDS[each.name]
        if each.name == "noise" and unit == "V":
            factor, of = 1e3, "mV"
        bound = "" if each.limit is None else f": {side} {factor * each.limit:.2g} {of}".rstrip()
        likely = bound and " (95 %)"
        text = f"the record does not determine {what}{bound}{likely}"
        found.append(Finding("undetermined", text))
    return found


def _spectrum_fit(fit: WhittleFit) -> SpectrumFit:
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
