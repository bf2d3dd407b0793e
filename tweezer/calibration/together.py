"""Weighted means of the calibrations of several recordings of one trap."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from tweezer.calibration.findings import REFUTED, Finding
from tweezer.calibration.quantities import DRAG, SENSITIVITY, STIFFNESS
from tweezer.calibration.results import Calibration
from tweezer.values.measured import Measured
from tweezer.values.shown import Table


@dataclass(frozen=True)
class Together:
    """Weighted mean of one quantity along one axis, over several recordings."""

    axis: str
    """"x", "y" or "z\""""
    quantity: str
    """"stiffness" (N/m), "drag" (kg/s) or "sensitivity" (m/V)"""
    mean: float | None
    """mean of the recordings without findings, weighted by their uncertainties; None if there are
    fewer than two, or they do not agree"""
    uncertainty: float | None
    """standard uncertainty of `mean`"""
    recordings: tuple[str, ...]
    """names of the recordings that the mean includes"""
    p_value: float | None
    """p-value for the same true value in all recordings (chi-square test)"""
    findings: tuple[Finding, ...]
    """reasons why there is no mean"""

    def measured(self, *, metric: bool) -> Measured:
        """Return the mean, with the findings that explain a missing mean.

        If `metric`, the recordings are in metres, so a sensitivity is a ratio of lengths.
        """
        of = next(each for each in _QUANTITIES if each.name == self.quantity)
        if metric and of == SENSITIVITY:
            of = of._replace(unit="1")
        return of(self.mean, self.uncertainty, *(each.text for each in self.findings))


#: Quantities that are averaged over recordings
_QUANTITIES = (STIFFNESS, DRAG, SENSITIVITY)


def together(calibrations: Sequence[Calibration]) -> tuple[Together, ...]:
    """Combine the calibrations of several recordings of one trap, axis by axis.

    Parameters
    ----------
    calibrations : sequence of Calibration
        Calibrations of the recordings.

    Returns
    -------
    tuple of Together
        Weighted mean of each quantity from the fits of the spectra, over the recordings without
        findings. If the values differ by more than their uncertainties, it contains a finding
        instead of the mean.
    """
    axes = dict.fromkeys(axis.axis for each in calibrations for axis in each.axes)
    return tuple(
        found
        for axis in axes
        for quantity in _QUANTITIES
        if (found := _of_one(calibrations, axis, quantity.name)) is not None
    )


def _of_one(calibrations: Sequence[Calibration], name: str, quantity: str) -> Together | None:
    """Return the mean of a quantity along the axis `name`; None if no recording determines it."""
    every = [
        (each.name, axis, found)
        for each in calibrations
        for axis in each.trapped
        if axis.axis == name and (found := axis.numbers.get(quantity))
    ]
    if not every:
        return None
    trusted = [
        (recording, float(found.value), float(found.errors))
        for recording, axis, found in every
        if not axis["power spectrum"].findings and 0 < found.errors < abs(found.value)
    ]
    if len(trusted) < 2:
        text = f"{name}: {quantity}: fewer than two recordings without findings"
        return Together(name, quantity, None, None, (), None, (Finding("few", text),))
    recordings, values, errors = zip(*trusted, strict=True)
    weights = 1 / np.square(errors)
    mean = float(weights @ np.array(values) / weights.sum())
    p_value = float(chdtrc(len(values) - 1, weights @ (np.array(values) - mean) ** 2))
    if p_value < REFUTED:
        text = f"{name}: {quantity}: the recordings differ by more than their uncertainties"
        finding = Finding("apart", text)
        return Together(name, quantity, None, None, recordings, p_value, (finding,))
    error = 1 / math.sqrt(weights.sum())
    return Together(name, quantity, mean, error, recordings, p_value, ())


def printed(
    calibrations: Sequence[Calibration], means: Sequence[Together]
) -> Iterator[Table | str]:
    """Yield, for each quantity, a table over recordings with their mean, or why it is missing."""
    metric = any(each.unit != "V" for each in calibrations)
    for each in means:
        mean = each.measured(metric=metric)
        rows = [
            (
                calibration.name, *found._replace(of=mean.of).cells,
                "" if calibration.name in each.recordings else "not trusted",
            )
            for calibration in calibrations
            for axis in calibration.axes
            if axis.axis == each.axis and (found := axis.numbers.get(each.quantity))
        ]  # fmt: skip
        if each.mean is not None:
            rows.append(("together", *mean.cells, f"p = {each.p_value:.2g}"))
        yield Table((f"{each.axis}: {each.quantity}", mean.of.scale[1], "+-", ""), tuple(rows))
        yield from mean.findings
