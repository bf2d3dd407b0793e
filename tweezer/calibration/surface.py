"""Position of a wall, from the drag of a bead at several positions of the focus."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.optimize import least_squares
from scipy.special import chdtrc

from tweezer.calibration.findings import REFUTED, Finding
from tweezer.calibration.quantities import DRAG, FAR_DRAG, HEIGHT, SHIFT, WALL
from tweezer.calibration.results import Calibration
from tweezer.calibration.wall import Height
from tweezer.calibration.whittle import inverse
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.measured import Measured, Result
from tweezer.values.printed import in_unit
from tweezer.values.shown import Card, Row, Table
from tweezer.values.units import QuantitiesLike, QuantityLike

#: Initial values of the smallest gap between bead and wall, in radii, and of the focal shift
_GAPS, _SHIFTS = np.geomspace(1e-2, 30.0, 15), (0.7, 0.85, 1.0)
#: Range of the smallest gap in a fit, in radii
_GAP_ENDS = 1e-4, 1e3
#: Largest uncertainty at which a height counts as determined, over the smallest gap
_UNCERTAIN = 1.0
#: Largest relative uncertainty at which a focal shift counts as determined
_UNSURE_SHIFT = 0.5
#: Range of the focal shift in a fit
_SHIFT_ENDS = 0.05, 20.0
#: Half the change of the unknowns (logarithms) for computing derivatives
_DIFFERENCE = 1e-5


@dataclass(frozen=True, repr=False)
class Surface(Result):
    """Wall beside a bead, located by the drag of the bead at several positions of the focus."""

    QUANTITIES: ClassVar = (WALL, SHIFT, FAR_DRAG)

    position: float
    """position of the focus at which the bead's centre would be in the plane of the wall, m"""
    uncertainty: float
    """standard uncertainty of `position`, m"""
    shift: float
    """displacement of the bead divided by the displacement of the focus"""
    shift_uncertainty: float | None
    """standard uncertainty of `shift`; None if the shift is given"""
    drag: float
    """drag of the bead far from the wall, kg/s"""
    drag_uncertainty: float | None
    """standard uncertainty of `drag`, kg/s; None if the drag is given"""
    heights: tuple[Height, ...]
    """height of the bead above the wall in each recording"""
    recordings: tuple[str, ...]
    """names of the recordings whose drag was used, which have no findings"""
    p_value: float | None
    """p-value of the fit to the drags (chi-square test); None without degrees of freedom"""
    findings: tuple[Finding, ...]
    """reasons not to trust the position; empty if there are none"""

    def quantities(self) -> Iterator[Measured]:
        """Yield the wall position, the focal shift and the drag far from the wall."""
        yield WALL(self.position, self.uncertainty, *(each.text for each in self.findings))
        yield SHIFT(self.shift, self.shift_uncertainty)
        yield FAR_DRAG(self.drag, self.drag_uncertainty)

    def card(self) -> Card:
        """Return the card with wall position, focal shift, drag and p-value, and a table of
        heights.
        """
        wall, shift, drag = self.quantities()
        rows = [wall.row(), shift.row()._replace(value=f"{shift.words} of that"), drag.row()]
        if self.p_value is not None:
            rows.append(Row("p-value", f"{self.p_value:.2g}"))
        heights = tuple(
            (f"{i}", HEIGHT(each.distance, each.uncertainty or None).words)
            for i, each in enumerate(self.heights, start=1)
        )
        return Card("Surface", "", tuple(rows), (Table(("recording", "height"), heights),))

    def printed(self, names: Sequence[str], positions: Sequence[float]) -> Iterator[Table | str]:
        """Yield the table of heights and the wall position, as the command prints them.

        Parameters
        ----------
        names : sequence of str
            Names of the recordings.
        positions : sequence of float
            Positions of the focus in them, m.
        """
        rows = (
            (
                name, in_unit(at, "um"),
                *HEIGHT(height.distance, height.uncertainty).cells,
                "" if name in self.recordings else "not trusted",
            )
            for name, at, height in zip(names, positions, self.heights, strict=True)
        )  # fmt: skip
        yield Table(("height by the drag", "focus, um", "height, um", "+-", ""), tuple(rows))
        wall, shift, _ = self.quantities()
        line = f"the bead's centre would be in the wall with the focus at {wall.words}"
        if self.shift_uncertainty is not None:
            line += f"; it moves by {shift.words} of the focus"
        if self.p_value is not None:
            line += f"; p = {self.p_value:.2g}"
        yield line
        yield from wall.findings


def find_wall(
    calibrations: Sequence[Calibration],
    positions: QuantitiesLike,
    *,
    radius: QuantityLike,
    drag: QuantityLike | None = None,
    shift: float | None = 1.0,
) -> Surface:
    """Return the position of a wall, from the drag of a bead at several heights above it.

    The height of the bead's centre above the wall is shift (position - position of the wall). The
    unknowns are fitted to the logarithms of the measured drags along all axes by least squares,
    with the weights of their uncertainties. The drag at each height follows from the exact
    mobilities of a sphere beside a wall.

    Parameters
    ----------
    calibrations : sequence of Calibration
        Calibration of a recording at each height. Each must determine the drag: the recording is in
        metres or has a drive, and fluid inertia is not included.
    positions : array_like, shape (n,)
        Position of the focus or the stage in each recording, m, increasing away from the wall.
    radius : float or str
        Radius of the bead, m.
    drag : float or str, optional
        Drag far from the wall, kg/s. Default: fitted.
    shift : float, optional
        Displacement of the bead divided by the displacement of the focus or stage; None to fit it.
        Behind a cover glass the focus moves less than the objective.

    Returns
    -------
    Surface
        Position of the wall and height of the bead in each recording, with findings.

    Raises
    ------
    ResultError
        If numbers are missing or invalid, or there are fewer drags than unknowns.
    """
    places = numbers_in_si("positions", positions, "m")
    radius = in_si("radius", radius, "m", error=ResultError)
    drag = None if drag is None else in_si("drag", drag, "kg/s", error=ResultError)
    if places.shape != (len(calibrations),) or not np.isfinite(places).all():
        raise ResultError(
            f"positions: must be {len(calibrations)} finite numbers, one for each recording"
        )
    for name, value in (("radius", radius), ("drag", drag), ("shift", shift)):
        if value is not None and not 0 < value < math.inf:
            raise ResultError(f"{name} = {value}: must be positive")
    if any(each.displaced_mass is not None for each in calibrations):
        raise ResultError(
            "the wall position is determined without fluid inertia; omit the fluid density"
        )
    drags = _Drags.of(calibrations, places)
    unknown = 1 + (drag is None) + (shift is None)
    distinct = len(np.unique(drags.positions))
    if distinct < unknown:
        raise ResultError(
            f"{distinct} positions have a drag without findings; must be {unknown} or "
            f"more to fit {unknown} unknowns"
        )
    fit = _Fit(drags, float(places.min()), radius, shift, drag)
    found = fit.best()
    covariance = inverse(fit.information(found))

    def with_error(of: Callable[[Array], Array]) -> tuple[Array, Array]:
        """Return a function of the unknowns at the best fit, and its standard uncertainty."""
        slopes = fit.differences(of, found)
        return of(found), np.sqrt(np.einsum("i...,ij,j...->...", slopes, covariance, slopes))

    wall, uncertainty = with_error(fit.wall)
    distances, errors = with_error(lambda unknowns: fit.heights(unknowns, places))
    of_drag, drag_error = with_error(lambda unknowns: np.exp(fit.parts(unknowns)[2]))
    of_shift, shift_error = with_error(lambda unknowns: np.exp(fit.parts(unknowns)[1]))
    residuals = fit.residuals(found)
    freedom = len(residuals) - unknown
    p_value = float(chdtrc(freedom, residuals @ residuals)) if freedom else None
    findings = []
    free = shift is None and not shift_error < _UNSURE_SHIFT * of_shift
    if free or not errors.min() < _UNCERTAIN * (distances.min() - radius):
        findings.append(
            Finding(
                "undetermined",
                "the drags do not determine the wall position accurately; record at smaller gaps, "
                "or give the focal shift",
            )
        )
    if p_value is not None and p_value < REFUTED:
        findings.append(Finding("apart", "the drags are inconsistent with one bead above one wall"))
    return Surface(
        float(wall), float(uncertainty),
        float(of_shift), float(shift_error) if shift is None else None,
        float(of_drag), float(drag_error) if drag is None else None,
        tuple(Height(float(h), float(e), radius) for h, e in zip(distances, errors, strict=True)),
        drags.recordings, p_value, tuple(findings),
    )  # fmt: skip


@dataclass(frozen=True)
class _Drags:
    """Measured drags of a bead along all axes, at several positions of the focus."""

    positions: Array
    """(drags,) position of the focus at which each drag was measured, m"""
    axes: tuple[str, ...]
    """axis along which each drag was measured"""
    logarithms: Array
    """(drags,) logarithms of the drags in kg/s"""
    errors: Array
    """(drags,) standard uncertainties of the logarithms"""
    recordings: tuple[str, ...]
    """names of the recordings with at least one of the drags"""

    @classmethod
    def of(cls, calibrations: Sequence[Calibration], positions: Array) -> _Drags:
        """Return the fitted drags of calibrations that have no findings along their axis.

        A finding that the drag differs from the given one is allowed, because walls change the
        drag. `positions` (calibrations,), m, are the positions of the focus.
        """
        rows = [
            (position, axis.axis, float(drag.value), float(drag.errors), each.name)
            for each, position in zip(calibrations, positions, strict=True)
            for axis in each.axes
            if (drag := axis.numbers.get(DRAG.name)) and 0 < drag.errors < drag.value
            and not {finding.name for finding in axis.findings} - {"drag"}
        ]  # fmt: skip
        if not rows:
            raise ResultError(
                "no recording determines the drag: each is in volts without a drive, or has "
                "findings; record in metres or with a driven stage"
            )
        at, axes, drags, errors, names = zip(*rows, strict=True)
        return cls(
            np.array(at), axes, np.log(drags), np.array(errors) / np.array(drags),
            tuple(dict.fromkeys(names)),
        )  # fmt: skip


@dataclass(frozen=True)
class _Fit:
    """Least-squares fit of a wall to the logarithms of measured drags.

    Its parameters are the logarithms of the smallest gap between bead and wall (in radii), of the
    focal shift and of the drag far from the wall (kg/s). The argument `unknowns` of many methods
    contains those parameters that are not given, in this order.
    """

    drags: _Drags
    nearest: float
    """position of the focus, m, at which the gap is smallest"""
    radius: float
    """radius of the bead, m"""
    shift: float | None
    """displacement of the bead per displacement of the focus; None to fit it"""
    drag: float | None
    """drag far from the wall, kg/s; None to fit it"""

    @property
    def given(self) -> Array:
        """Logarithms of smallest gap (radii), shift and drag (kg/s), (3,); NaN where unknown."""
        return np.array(
            [math.nan, *(math.log(each) if each else math.nan for each in (self.shift, self.drag))]
        )

    def parts(self, unknowns: Array) -> Array:
        """Return the logarithms of gap (radii), shift and drag (kg/s), (3,), with the unknowns."""
        every = self.given
        every[np.isnan(every)] = unknowns
        return every

    def heights(self, unknowns: Array, positions: Array) -> Array:
        """Return the heights of the bead's centre above the wall, m, at focus `positions`, m."""
        gap, shift, _ = self.parts(unknowns)
        return self.radius * (1 + np.exp(gap)) + np.exp(shift) * (positions - self.nearest)

    def wall(self, unknowns: Array) -> Array:
        """Return the position of the focus, m, at which the height of the bead's centre is 0."""
        gap, shift, _ = self.parts(unknowns)
        return np.asarray(self.nearest - self.radius * (1 + np.exp(gap)) / np.exp(shift))

    def residuals(self, unknowns: Array) -> Array:
        """Return the deviations (drags,) of the measured drags, in standard uncertainties."""
        drags = self.drags
        heights = self.heights(unknowns, drags.positions)
        mobilities = [
            Height(h, 0.0, self.radius).mobility(axis)
            for h, axis in zip(heights, drags.axes, strict=True)
        ]
        expected = self.parts(unknowns)[2] - np.log(mobilities)
        return np.asarray((drags.logarithms - expected) / drags.errors)

    def differences(self, of: Callable[[Array], Array], unknowns: Array) -> Array:
        """Return the derivatives (unknowns, ...) of a function of the unknowns."""
        steps = _DIFFERENCE * np.eye(len(unknowns))
        return np.array([of(unknowns + d) - of(unknowns - d) for d in steps]) / (2 * _DIFFERENCE)

    def information(self, unknowns: Array) -> Array:
        """Return Fisher's information on the unknowns, whose inverse is their covariance."""
        slopes = self.differences(self.residuals, unknowns)
        return np.asarray(slopes @ slopes.T)

    def best(self) -> Array:
        """Return the best-fitting unknowns, starting from the best of several gaps and shifts."""
        unknown = np.isnan(self.given)
        drag = float(self.drags.logarithms.min())
        starts = [
            np.array([math.log(gap), math.log(shift), drag])[unknown]
            for gap in _GAPS
            for shift in (_SHIFTS if self.shift is None else (1.0,))
        ]
        start = min(starts, key=lambda each: float((self.residuals(each) ** 2).sum()))
        anywhere = -math.inf, math.inf
        ends = np.array([np.log(_GAP_ENDS), np.log(_SHIFT_ENDS), anywhere])[unknown]
        return np.asarray(least_squares(self.residuals, start, bounds=ends.T).x)
