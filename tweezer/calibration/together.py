"""Calibrations of several recordings of one trap, put together."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from tweezer.calibration.findings import REFUTED, Finding
from tweezer.calibration.results import AxisCalibration, Calibration


@dataclass(frozen=True)
class Together:
    """One quantity of one axis by several recordings."""

    axis: str
    quantity: str
    """"stiffness" (N/m), "drag" (kg/s) or "sensitivity" (m/V)"""
    mean: float | None
    """weighted by the uncertainties, of the recordings that nothing speaks against; None if there
    are fewer than two, or they do not agree"""
    uncertainty: float | None
    """its standard uncertainty"""
    recordings: tuple[str, ...]
    """those of the mean"""
    p_value: float | None
    """probability of values further apart, by chi-square"""
    findings: tuple[Finding, ...]
    """why there is no mean"""


def _stiffness(axis: AxisCalibration) -> tuple[float, float] | None:
    found = axis["power spectrum"]
    return found.stiffness, found.uncertainty


def _drag(axis: AxisCalibration) -> tuple[float, float] | None:
    fit = axis.free_fit
    return None if fit.drag_uncertainty is None else (fit.bead.drag, fit.drag_uncertainty)


def _sensitivity(axis: AxisCalibration) -> tuple[float, float] | None:
    if axis.sensitivity is None or axis.sensitivity_uncertainty is None:
        return None
    return axis.sensitivity, axis.sensitivity_uncertainty


QUANTITIES: dict[str, Callable[[AxisCalibration], tuple[float, float] | None]] = {
    "stiffness": _stiffness,
    "drag": _drag,
    "sensitivity": _sensitivity,
}


def together(calibrations: Sequence[Calibration]) -> tuple[Together, ...]:
    """What several recordings of one trap tell together, axis by axis.

    Weighted means of what the fits of their spectra give, where no finding speaks against it; and
    where the values differ by more than their uncertainties, a finding instead.
    """
    axes = dict.fromkeys(axis.axis for each in calibrations for axis in each.axes)
    return tuple(
        found
        for axis in axes
        for quantity in QUANTITIES
        if (found := _of_one(calibrations, axis, quantity)) is not None
    )


def _of_one(calibrations: Sequence[Calibration], name: str, quantity: str) -> Together | None:
    every = [
        (each.name, axis, found)
        for each in calibrations
        for axis in each.axes
        if axis.axis == name
        and (each.free is None or name not in [free.axis for free in each.free.axes])
        and (found := QUANTITIES[quantity](axis))
    ]
    if not every:
        return None
    trusted = [
        (recording, *found)
        for recording, axis, found in every
        if not axis["power spectrum"].findings and 0 < found[1] < abs(found[0])
    ]
    if len(trusted) < 2:
        text = f"{name}: {quantity}: fewer than two recordings that nothing speaks against"
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
