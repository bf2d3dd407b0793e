"""Results of a calibration: the stiffness along each axis by several methods, with findings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from tweezer.calibration.answers import Answer
from tweezer.calibration.by_axis import ByAxis
from tweezer.calibration.findings import Finding, in_words
from tweezer.calibration.free import Diffusion
from tweezer.calibration.left_out import NOTHING, LeftOut
from tweezer.calibration.levitated import DAMPING, RESONANCE, LevitatedBead, Resonance
from tweezer.calibration.quantities import (
    CORNER,
    DETECTOR,
    DIFFUSION,
    DRAG,
    FORCE_SENSITIVITY,
    QUANTITIES,
    SENSITIVITY,
    STIFFNESS,
    signal,
)
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.wall import ACROSS, Height
from tweezer.calibration.whittle import Detected
from tweezer.values.measured import DIMENSIONS, Measured, Result, figure
from tweezer.values.printed import printed, with_error
from tweezer.values.shown import Card, Row, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tweezer.reading import Recording


@dataclass(frozen=True)
class Estimate:
    """Stiffness of a trap, estimated by one method."""

    method: str
    """"equipartition", "power spectrum", "power spectrum, drag fitted", "displacement" (MSD),
    "autocorrelation" or "potential\""""
    stiffness: float
    """k, N/m"""
    uncertainty: float
    """standard uncertainty of k, N/m; statistical only, with temperature and drag taken as exact"""
    findings: tuple[Finding, ...]
    """reasons not to trust the stiffness: findings about the record, then about this number"""

    @property
    def caveat(self) -> str:
        """Texts of the findings, in one line."""
        return in_words(self.findings)

    @property
    def undetermined(self) -> bool:
        """Whether the record leaves the stiffness undetermined."""
        return any(finding.name == "undetermined" for finding in self.findings)

    @property
    def measured(self) -> Measured:
        """The stiffness with its uncertainty and the findings against it."""
        return STIFFNESS(self.stiffness, self.uncertainty, *(each.text for each in self.findings))

    @property
    def told(self) -> str:
        """The stiffness with its uncertainty and unit as text, or "not determined"."""
        return "not determined" if self.undetermined else self.measured.words

    @property
    def doubt(self) -> str:
        """Text with the reasons not to trust the stiffness; "" without a finding."""
        return f"not to be trusted: {self.caveat}" if self.caveat else ""


@dataclass(frozen=True)
class SpectrumFit:
    """Fit of a trapped bead to a power spectrum, by maximum likelihood."""

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
    """log-likelihood, for comparison with other fits of the same ordinates"""
    p_value: float
    """p-value of the fitted spectrum (Bartlett's test); somewhat too large, because parameters were
    fitted"""


@dataclass(frozen=True, repr=False)
class AxisCalibration(Result):
    """Calibration of a trap along one axis."""

    QUANTITIES: ClassVar = (
        *QUANTITIES, DRAG, SENSITIVITY, FORCE_SENSITIVITY, RESONANCE, DAMPING
    )  # fmt: skip

    axis: str
    """"x", "y" or "z\""""
    centre: float
    """mean position, m"""
    findings: tuple[Finding, ...]
    """findings about the record, which apply to every estimate"""
    estimates: tuple[Estimate, ...]
    """stiffness by each method; `axis["power spectrum"]` returns one by its name"""
    fit: SpectrumFit
    """fit with the given drag; the same as `free_fit` if no drag was given"""
    free_fit: SpectrumFit
    """fit of corner frequency and diffusion D, with the drag k_B T/D"""
    relaxations: float
    """length of the record, in relaxation times of `fit`"""
    detector: tuple[Detected, ...] = ()
    """parameters of the detector that were fitted"""
    sensitivity: float | None = None
    """displacement sensitivity, m/V; for a driven record in m, the ratio of true to recorded
    metres; None if not fitted"""
    sensitivity_uncertainty: float | None = None
    """standard uncertainty of `sensitivity`"""
    force_sensitivity: float | None = None
    """stiffness times sensitivity, N/V or N/m"""
    force_sensitivity_uncertainty: float | None = None
    """standard uncertainty of `force_sensitivity`"""
    answers: tuple[Answer, ...] = ()
    """responses of the bead to the motion of the stage"""
    remarks: tuple[Finding, ...] = ()
    """findings that do not affect a number, such as parameters that are not determined"""
    drag: float | None = None
    """known drag along this axis at the bead's position, kg/s; None if unknown"""
    resonance: Resonance | None = None
    """line of a bead in gas; None in other media"""

    @property
    def diffusion_uncertainty(self) -> float:
        """Standard uncertainty of k_B T/beta of `free_fit`, m^2/s."""
        bead = self.free_fit.bead
        return bead.diffusion * (self.free_fit.drag_uncertainty or 0.0) / bead.drag

    def __getitem__(self, method: str) -> Estimate:
        return next(estimate for estimate in self.estimates if estimate.method == method)

    def quantities(self) -> Iterator[Measured]:
        """Yield stiffness, corner frequency and diffusion by the spectrum, drag and sensitivities.

        Drag and sensitivities are included only if they were fitted.
        """
        fit, free = self.fit, self.free_fit
        yield self["power spectrum"].measured
        yield CORNER(fit.bead.corner_frequency, fit.corner_frequency_uncertainty)
        yield DIFFUSION(free.bead.diffusion, self.diffusion_uncertainty)
        if free.drag_uncertainty is not None:
            yield DRAG(free.bead.drag, free.drag_uncertainty)
        if self.sensitivity is not None:
            yield SENSITIVITY(self.sensitivity, self.sensitivity_uncertainty)
        if self.force_sensitivity is not None:
            yield FORCE_SENSITIVITY(self.force_sensitivity, self.force_sensitivity_uncertainty)
        if self.resonance is not None:
            yield from self.resonance.quantities()

    @property
    def listed(self) -> list[Finding]:
        """All findings about the record or an estimate, in the order of their notes."""
        every = [*self.findings, *(f for each in self.estimates for f in each.findings)]
        return [each for each in dict.fromkeys(every) if each.name != "undetermined"]

    @property
    def notes(self) -> list[str]:
        """Texts of the findings in `listed`."""
        return [each.text for each in self.listed]

    def table(self, notes: Sequence[str] | None = None) -> Table:
        """Return a row for each method, with findings as numbers of notes, or as text without
        `notes`.
        """
        rows = []
        for each in self.estimates:
            cells = ("-", "-") if each.undetermined else each.measured.cells
            judgement = each.doubt
            if notes is not None:
                undetermined = "not determined" if each.undetermined else ""
                judgement = "; ".join(filter(None, [undetermined, _mark(each.findings, notes)]))
            rows.append((each.method, *cells, judgement))
        return Table((f"{self.axis}: stiffness by", "pN/um", "+-", ""), tuple(rows))

    def lines(self, unit: str, notes: Sequence[str]) -> Iterator[str]:
        """Yield lines on the results other than the stiffness: spectrum, detector, drive, remarks.

        Parameters
        ----------
        unit : str
            Unit of the recording.
        notes : sequence of str
            Findings, to which the lines refer by number.
        """
        numbers, fit = self.numbers, self.free_fit
        against = list(filter(None, [_mark(self.findings, notes)]))
        parts = [f"corner frequency {_determined(numbers['corner_frequency'])}"]
        if fit.drag_uncertainty is not None:
            parts.append(f"diffusion {_determined(numbers['diffusion'])}")
        if self.resonance is not None:
            parts = [self.resonance.words]
        yield "; ".join((*parts, f"p = {fit.p_value:.2g}", *against))
        every = {**DETECTOR, "noise": signal("noise", "noise", unit)}
        detected = [
            f"{every[each.name].about} {every[each.name](each.value, each.uncertainty).words}"
            for each in self.detector
            if each.value is not None
        ]
        if detected:
            yield "; ".join((*detected, *against))
        if self.sensitivity is not None:
            metres = with_error(self.sensitivity, self.sensitivity_uncertainty, "m")
            parts = [f"recorded metres are {metres}"]
            if unit == "V" and self.force_sensitivity is not None:
                parts = [numbers["sensitivity"].words, numbers["force_sensitivity"].words]
            parts.append(f"drag {DRAG(fit.bead.drag, fit.drag_uncertainty).words}")
            yield "; ".join((*parts, *against))
        for each in self.answers:
            answer = signal("answer", "", unit)(each.signal, each.signal_uncertainty).words
            yield f"stage {each.frequency:.5g} Hz, {printed(each.stage, 'nm')}: {answer}"
        yield from (finding.text for finding in self.remarks)

    def card(self) -> Card:
        """Return a row for each method, and numbered notes with the findings."""
        rows = tuple(
            Row(each.method, each.told, _mark(each.findings, self.notes)) for each in self.estimates
        )
        notes = tuple(f"{i}  {each}" for i, each in enumerate(self.notes, start=1))
        return Card("Stiffness", f"the {self.axis} axis", rows, notes=notes)

    def by(self, method: str) -> Estimate | None:
        """Return the estimate by a method; None if the method was not used."""
        return next((each for each in self.estimates if each.method == method), None)


def _mark(against: Iterable[Finding], notes: Sequence[str]) -> str:
    """Return "not trusted" with the numbers of the notes on findings; "" without findings."""
    numbers = sorted({notes.index(each.text) + 1 for each in against if each.text in notes})
    return f"not trusted: {', '.join(map(str, numbers))}" if numbers else ""


def _determined(number: Measured) -> str:
    """Return a number in words, or "not determined" if its uncertainty exceeds it."""
    return number.words if 0 < number.errors < number.value else "not determined"


@dataclass(frozen=True, repr=False)
class Calibration(Result):
    """Stiffness of a trap from a recording, SI."""

    QUANTITIES: ClassVar = QUANTITIES

    name: str
    """name of the recording"""
    temperature: float
    """temperature of the medium, K"""
    drag: float | None
    """drag of the bead far from any wall, kg/s; None if fitted"""
    mass: float | None
    """mass of the bead, kg; None if overdamped"""
    displaced_mass: float | None
    """mass of the displaced fluid, kg; None without fluid inertia"""
    exposure: float | None
    """exposure time of a sample, s; None if fitted, or if unknown and taken as 0"""
    diode: tuple[float, float] | None
    """half-power frequency of a photodiode, Hz, and the fraction of the signal that it detects
    without delay; None without a diode, or if fitted"""
    noise: float | None
    """standard deviation of the detector noise along the first axis, m or V; None without noise, or
    if it is fitted"""
    unit: str
    """unit of the record, "m" or "V\""""
    samples: int
    """number of samples"""
    step: float
    """sampling interval, s"""
    note: str
    """samples that were omitted from the recording, in words"""
    axes: ByAxis[AxisCalibration]
    """calibration of each axis, by index or by name: axes["x"]"""
    wall: Height | None = None
    """the bead's height above a wall; None if not given"""
    free: Diffusion | None = None
    """diffusion along the axes on which no trap is detected; None if all have one"""
    left_out: LeftOut = NOTHING
    """drift and bands left out of the record, and the frequency range of the fits"""
    radius: float | None = None
    """radius of the bead, m; None if unknown"""
    viscosity: float | None = None
    """viscosity of the medium, Pa s; None if unknown"""
    levitated: LevitatedBead | None = None
    """bead in the gas of a scene, with mass and density; None in other media"""

    @property
    def trapped(self) -> list[AxisCalibration]:
        """The axes along which a trap is detected."""
        free = [] if self.free is None else [each.axis for each in self.free.axes]
        return [axis for axis in self.axes if axis.axis not in free]

    @property
    def determined(self) -> bool:
        """Whether each axis has a stiffness, or a free bead a diffusion, without a finding."""
        return (self.free is None or not self.free.findings) and all(
            any(not each.findings for each in axis.estimates) for axis in self.trapped
        )

    def plot(self, recording: Recording) -> Figure:
        """Draw the recording that was calibrated: `tweezer.plots.calibration_figure`."""
        return figure("calibration_figure", recording, self)

    def quantities(self) -> Iterator[Measured]:
        """Yield stiffness, corner frequency and diffusion along x, y and z; NaN for absent axes."""
        names = DIMENSIONS["axis"]
        found = np.full((len(QUANTITIES), 2, len(names)), np.nan)
        for axis in self.axes:
            every = (axis.numbers[each.name] for each in QUANTITIES)
            found[..., names.index(axis.axis)] = [(each.value, each.errors) for each in every]
        for quantity, (values, errors) in zip(QUANTITIES, found, strict=True):
            yield quantity(values, errors)

    def words(self) -> dict[str, str]:
        """Return whether the spectral fits can be trusted, and the findings against them."""
        caveats = [
            f"{axis.axis}: {caveat}"
            for axis in self.axes
            if (caveat := axis["power spectrum"].caveat)
        ]
        outcome = "not to be trusted" if caveats else "calibrated"
        return {"outcome": outcome, "caveat": "; ".join(caveats)}

    def card(self) -> Card:
        """Return the card with the first trusted stiffness of each axis, the inputs, and tables of
        all.
        """
        trapped, rows = self.trapped, []
        for axis in self.axes:
            if axis not in trapped:
                rows.append(Row(f"stiffness, {axis.axis}", "no trap is detected"))
                continue
            best = min(axis.estimates, key=lambda estimate: bool(estimate.caveat))
            told = f"{best.told}, by {best.method}"
            rows.append(Row(f"stiffness, {axis.axis}", told, best.doubt))
        if self.free is not None:
            found = self.free.coefficient(self.unit).words
            rows.append(Row("diffusion, as of a free bead", found, in_words(self.free.findings)))
        if self.levitated is not None:
            rows += [self.levitated.numbers[each].row() for each in ("mass", "density", "radius")]
        rows += [
            Row("temperature", f"{self.temperature:.5g} K"),
            Row("drag", "fitted" if self.drag is None else printed(self.drag, "nN s/m")),
            Row("samples", f"{self.samples}, {1 / self.step:.5g} Hz"),
        ]
        tables = tuple(axis.table() for axis in trapped)
        notes = [self.note] if self.note else []
        return Card("Calibration", self.name, tuple(rows), tables, tuple(notes))

    def printed(self) -> Iterator[Table | str]:
        """Yield the tables and lines that the command prints, axis by axis."""
        if self.free is not None:
            yield from self.free.lines(self.unit)
        trapped = self.trapped
        for axis in self.axes:
            if axis in trapped:
                notes = axis.notes
                yield axis.table(notes)
                yield from (f" {number}  {note}" for number, note in enumerate(notes, 1))
                yield from axis.lines(self.unit, notes)
            if self.wall is not None and axis.drag is not None:
                yield _beside(self.wall, axis.axis, axis.drag)
        if self.levitated is not None:
            yield self.levitated.line


def _beside(wall: Height, axis: str, known: float) -> str:
    """Return a line on the drag along an axis, kg/s, that follows from the height above a wall."""
    uncertainty = known * wall.relative_uncertainty(axis) or None
    way = "across" if axis == ACROSS else "along"
    return (
        f"{printed(wall.distance, 'um')} from the wall, {way} it: drag "
        f"{DRAG(known, uncertainty).words}, {1 / wall.mobility(axis):.4g} times that far away"
    )
