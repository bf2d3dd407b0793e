"""Results of a calibration: the stiffness along each axis by several methods, with findings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from tweezer.calibration.answers import Answer
from tweezer.calibration.by_axis import ByAxis
from tweezer.calibration.findings import Finding
from tweezer.calibration.free import Diffusion
from tweezer.calibration.left_out import NOTHING, LeftOut
from tweezer.calibration.quantities import QUANTITIES
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.wall import Height
from tweezer.calibration.whittle import Detected
from tweezer.values.measured import DIMENSIONS, Measured, Result, figure
from tweezer.values.printed import pair, printed, with_error
from tweezer.values.shown import Card, Row, Shown, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tweezer.reading import Recording


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
        """Whether the record does not determine the stiffness."""
        return any(finding.name == "undetermined" for finding in self.findings)

    @property
    def told(self) -> str:
        """The stiffness with its uncertainty and unit."""
        if self.undetermined:
            return "not determined"
        return with_error(self.stiffness, self.uncertainty, "pN/um")

    @property
    def doubt(self) -> str:
        """Reason not to trust it; "" without a finding."""
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
        """All findings about the record or a number, in the order of their notes."""
        every = [*self.findings, *(f for each in self.estimates for f in each.findings)]
        return [each for each in dict.fromkeys(every) if each.name != "undetermined"]

    def mark(self, against: Iterable[Finding]) -> str:
        """By which notes something is not trusted; "" if by none."""
        listed = self.listed
        numbers = ", ".join(str(listed.index(each) + 1) for each in against if each in listed)
        return numbers and f"not trusted: {numbers}"

    def table(self, *, in_words: bool = False) -> Table:
        """Return a row for each method with its findings, as numbers of notes or as text."""
        rows = []
        for each in self.estimates:
            k, error = pair(each.stiffness, each.uncertainty, "pN/um")
            judgement = self.mark(each.findings)
            if each.undetermined:
                k = error = "-"
                judgement = "; ".join(filter(None, ["not determined", judgement]))
            if in_words:
                judgement = each.doubt
            rows.append((each.method, k, error, judgement))
        return Table((f"{self.axis}: stiffness by", "pN/um", "+-", ""), tuple(rows))

    def card(self) -> Card:
        """Return a row for each method, and numbered notes with the findings."""
        rows = tuple(
            Row(each.method, each.told, self.mark(each.findings)) for each in self.estimates
        )
        notes = tuple(f"{i}  {each.text}" for i, each in enumerate(self.listed, start=1))
        return Card("Stiffness", f"the {self.axis} axis", rows, notes=notes)

    def by(self, method: str) -> Estimate | None:
        """The estimate by a method, if there is one."""
        return next((each for each in self.estimates if each.method == method), None)


@dataclass(frozen=True, repr=False)
class Calibration(Result):
    """Stiffness of a trap from a recording, SI."""

    QUANTITIES: ClassVar = QUANTITIES

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

    def plot(self, recording: Recording) -> Figure:
        """Draw the recording that was calibrated: `tweezer.plots.calibration_figure`."""
        return figure("calibration_figure", recording, self)

    def quantities(self) -> Iterator[Measured]:
        """Stiffness, corner frequency and diffusion of each axis; NaN along the others."""
        names = DIMENSIONS["axis"]
        numbers = np.full((len(QUANTITIES), 2, len(names)), np.nan)
        for axis in self.axes:
            stiffness, fit, free = axis["power spectrum"], axis.fit, axis.free_fit
            numbers[..., names.index(axis.axis)] = (
                (stiffness.stiffness, stiffness.uncertainty),
                (fit.bead.corner_frequency, fit.corner_frequency_uncertainty),
                (free.bead.diffusion, axis.diffusion_uncertainty),
            )
        for quantity, (values, errors) in zip(QUANTITIES, numbers, strict=True):
            yield quantity(values, errors)

    def words(self) -> dict[str, str]:
        """Whether the fits of the spectra can be trusted, and why not."""
        caveats = [
            f"{axis.axis}: {caveat}"
            for axis in self.axes
            if (caveat := axis["power spectrum"].caveat)
        ]
        outcome = "not to be trusted" if caveats else "calibrated"
        return {"outcome": outcome, "caveat": "; ".join(caveats)}

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
            unit = "um^2/s" if self.unit == "m" else "V^2/s"
            doubt = "; ".join(each.text for each in self.free.findings)
            told = with_error(self.free.diffusion, self.free.uncertainty, unit)
            rows.append(Row("diffusion, as of a free bead", told, doubt))
        rows += [
            Row("temperature", f"{self.temperature:.5g} K"),
            Row("drag", "fitted" if self.drag is None else printed(self.drag, "nN s/m")),
            Row("samples", f"{self.samples}, {1 / self.step:.5g} Hz"),
        ]
        tables = tuple(axis.table(in_words=True) for axis in self.axes if axis.axis not in free)
        notes = [self.note] if self.note else []
        return Card("Calibration", self.name, tuple(rows), tables, tuple(notes))
