"""Calibration beside a wall: how often the intervals hold what is true, from contact to far away.

Records of a bead with the mobilities of the exact series (`tests.reference.wall`) are drawn
exactly: without inertia as an Ornstein-Uhlenbeck process, with it by the spectrum of the flow that
the wall reflects (`tests.reference.reflected_flow`). The height is given, and the drag far away;
or the wall is found by the drag in records at several heights. In water of 20 degC, on all cores.
"""

from __future__ import annotations

import math
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.signal import lfilter

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.hydro import (
    DENSITY,
    PART,
    RECORDS,
    RESPONSE,
    TEMPERATURE,
    VISCOSITY,
    WATER,
    Number,
    importlib_version,
    judged,
)
from tests.benchmarks.timing import machine, on_all_cores
from tests.reference import detected_bead, reflected_flow, wall
from tests.reference.detected_bead import BOLTZMANN
from tweezer.calibration import AxisCalibration
from tweezer.reading import Recording

Results = dict[str, Any]

RADIUS = 500e-9
FAR = 6 * math.pi * VISCOSITY * RADIUS
VOLUME = 4 / 3 * math.pi * RADIUS**3
STIFFNESS = 2e-5
#: of the stage, Hz and m
DRIVE = 37.0, 500e-9
#: by how much the bead moves with the focus
SHIFT = 0.8
#: axes, and whether they are across the wall
AXES = {"x": False, "z": True}


class Study(NamedTuple):
    """Records at one gap, or at several."""

    kind: str
    """steady, driven, fluid or series"""
    gaps: tuple[float, ...]
    """radii"""
    axes: tuple[str, ...] = ("x", "z")
    rate: float = 20e3
    """Hz"""
    samples: int = 2**15
    stiffness: float = STIFFNESS
    """N/m"""

    @property
    def records(self) -> int:
        """How many are drawn: fewer where each takes long."""
        return RECORDS // 2 if self.kind in ("driven", "fluid") else RECORDS


GAPS = (0.2, 0.5, 1.0, 2.0, 5.0)
STEADY = tuple(Study("steady", (gap,)) for gap in GAPS)
DRIVEN = tuple(Study("driven", (gap,)) for gap in GAPS[::2])
FLUID = tuple(
    Study("fluid", (gap,), axes, 100e3, 2**16, 1e-4)
    for gap, axes in ((1.0, ("x",)), (2.0, ("x", "z")), (5.0, ("x", "z")))
)
SERIES = (Study("series", GAPS, rate=10e3, samples=2**13),)


@cache
def mobility(gap: float, axis: str) -> float:
    """Over that far away, by the exact series."""
    across, along, *_ = wall.mobilities(gap)
    return float(across if AXES[axis] else along)


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    studies = [*STEADY[:: 4 if quick else 1], *DRIVEN[: 1 if quick else None], *FLUID, *SERIES]
    part = 2 if quick else PART
    tasks = [
        (s, seed, part)
        for seed in range(1, 1 + RECORDS // PART)
        for s in studies
        if seed <= (1 if quick else s.records // PART)
    ]
    found = on_all_cores(calibrated, tasks, say)
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick,
            "pylake": importlib_version(),
            "studies": [
                {**s._asdict(), "records": 2 if quick else s.records, **judged(found[s])}
                for s in studies
            ],
        }
    )  # fmt: skip
    return results


def calibrated(study: Study, seed: int, count: int) -> tuple[list[Number], dict[str, int]]:
    """All numbers of so many records, and the findings against what is right."""
    numbers: list[Number] = []
    findings: Counter[str] = Counter()
    of = {"steady": _steady, "driven": _driven, "fluid": _fluid, "series": _series}[study.kind]
    rng = np.random.default_rng([seed, *(int(10 * gap) for gap in study.gaps), len(study.kind)])
    for _ in range(count):
        for each in of(study, rng):
            if isinstance(each, AxisCalibration):
                findings.update(finding.name for finding in each.findings)
            else:
                numbers.append(each)
    return numbers, dict(findings)


def drawn(study: Study, gap: float, rng: np.random.Generator) -> np.ndarray:
    """Thermal motion without inertia, (samples, axes) m."""
    columns = []
    for axis in study.axes:
        kept = math.exp(-study.stiffness * mobility(gap, axis) / (FAR * study.rate))
        deviation = math.sqrt(BOLTZMANN * TEMPERATURE / study.stiffness)
        noise = deviation * rng.standard_normal(study.samples)
        noise[1:] *= math.sqrt(1 - kept**2)
        columns.append(lfilter([1.0], [1.0, -kept], noise))
    return np.stack(columns, axis=1)


def _recording(study: Study, signal: np.ndarray, unit: str, **more: Any) -> Recording:
    times = np.arange(study.samples) / study.rate
    return Recording(times, signal, study.axes, name="record", unit=unit, **more)


def _known(gap: float) -> dict[str, Any]:
    return {
        "temperature": TEMPERATURE, "exposure": 0.0, "wall": (1 + gap) * RADIUS, "radius": RADIUS
    }  # fmt: skip


def _told(study: Study, by: str, axis: AxisCalibration) -> Iterator[Number]:
    """Stiffness, drag and metres a volt, as far as there are any."""
    gap, name = study.gaps[0], axis.axis
    estimate, fit = axis["power spectrum"], axis.free_fit
    by = f"{name}, {by}"
    yield Number(by, "stiffness", estimate.stiffness, estimate.uncertainty, study.stiffness)
    if fit.drag_uncertainty is not None:
        true = FAR / mobility(gap, name)
        yield Number(by, "drag", fit.bead.drag, fit.drag_uncertainty, true)
    if axis.sensitivity is not None and axis.sensitivity_uncertainty is not None:
        yield Number(by, "m/V", axis.sensitivity, axis.sensitivity_uncertainty, 1 / RESPONSE)


def _metres_and_volts(
    study: Study, x: np.ndarray, **known: Any
) -> Iterator[Number | AxisCalibration]:
    for unit, by, response in (("m", "metres", 1.0), ("V", "volts", RESPONSE)):
        recording = _recording(study, response * x, unit)
        for axis in tweezer.calibrate(recording, drag=FAR, **known).axes:
            if unit == "m":
                yield axis
            yield from _told(study, by, axis)


def _steady(study: Study, rng: np.random.Generator) -> Iterator[Number | AxisCalibration]:
    (gap,) = study.gaps
    x = drawn(study, gap, rng)
    yield from _metres_and_volts(study, x, **_known(gap))
    # the height is off by as much as is said
    said = 0.1 * gap * RADIUS
    uncertain = _known(gap) | {"wall": ((1 + gap) * RADIUS + said * rng.standard_normal(), said)}
    for axis in tweezer.calibrate(_recording(study, x, "m"), drag=FAR, **uncertain).axes:
        k, fit = axis["power spectrum"], axis.fit
        by = f"{axis.axis}, uncertain height"
        yield Number(by, "stiffness", k.stiffness, k.uncertainty, study.stiffness)
        if fit.drag_uncertainty is not None:
            true = FAR / mobility(gap, axis.axis)
            yield Number(by, "drag", fit.bead.drag, fit.drag_uncertainty, true)


def _driven(study: Study, rng: np.random.Generator) -> Iterator[Number | AxisCalibration]:
    (gap,) = study.gaps
    x = drawn(study, gap, rng)
    f, size = DRIVE
    s = 2j * math.pi * f
    wave = size * np.exp(s * np.arange(study.samples) / study.rate)
    for i, axis in enumerate(study.axes):
        drag = FAR / mobility(gap, axis)
        x[:, i] += (s * drag / (s * drag + study.stiffness) * wave).imag
    recording = _recording(study, RESPONSE * x, "V", drive=wave.imag)
    for each in tweezer.calibrate(recording, **_known(gap)).axes:
        yield each
        yield from _told(study, "stage", each)


@cache
def _density(study: Study, axis: str) -> reflected_flow.Density:
    (gap,) = study.gaps
    return reflected_flow.Density(
        study.stiffness, FAR, TEMPERATURE, DENSITY * VOLUME, WATER * VOLUME, 1 + gap,
        mobility(gap, axis), AXES[axis],
    )  # fmt: skip


def _fluid(study: Study, rng: np.random.Generator) -> Iterator[Number | AxisCalibration]:
    (gap,) = study.gaps
    columns = [
        detected_bead.drawn(
            _density(study, axis), 1 / study.rate, study.samples, int(rng.integers(2**31)),
            aliases=100,
        )[0]
        for axis in study.axes
    ]  # fmt: skip
    x = np.stack(columns, axis=1)
    masses = {"mass": DENSITY * VOLUME, "displaced_mass": WATER * VOLUME}
    yield from _metres_and_volts(study, x, **_known(gap), **masses)
    yield from _pylake(study, RESPONSE * x[:, 0])


def _pylake(study: Study, volts: np.ndarray) -> Iterator[Number]:
    """Along the wall by lumicks.pylake, up to 0.45 of the rate with ten aliases on each side."""
    try:
        from lumicks import pylake
    except ImportError:
        return
    model = pylake.PassiveCalibrationModel(
        bead_diameter=2e6 * RADIUS, viscosity=VISCOSITY, temperature=TEMPERATURE - 273.15,
        hydrodynamically_correct=True, fast_sensor=True, rho_sample=WATER, rho_bead=DENSITY,
        distance_to_surface=1e6 * (1 + study.gaps[0]) * RADIUS,
    )._alias_model(study.rate, 10)  # fmt: skip
    spectrum = pylake.calculate_power_spectrum(volts, study.rate, (1.0, 0.45 * study.rate), 100)
    with warnings.catch_warnings(action="ignore"):
        fit = pylake.fit_power_spectrum(spectrum, model)
    for quantity, name, factor, true in (
        ("stiffness", "stiffness", 1e-3, study.stiffness),
        ("m/V", "displacement_sensitivity", 1e-6, 1 / RESPONSE),
    ):
        value, error = getattr(fit, name), getattr(fit, f"{name}_std_err")
        if value is not None and error is not None:
            yield Number("x, pylake", quantity, float(factor * value), float(factor * error), true)


def _series(study: Study, rng: np.random.Generator) -> Iterator[Number | AxisCalibration]:
    known = {"temperature": TEMPERATURE, "exposure": 0.0}
    calibrations = [
        tweezer.calibrate(_recording(study, drawn(study, gap, rng), "m"), **known)
        for gap in study.gaps
    ]
    heights = [(1 + gap) * RADIUS for gap in study.gaps]
    focus = [height / SHIFT for height in heights]
    for by, drag, shift in (
        ("all given", FAR, SHIFT), ("drag fitted", None, SHIFT), ("shift fitted", FAR, None),
        ("both fitted", None, None),
    ):  # fmt: skip
        found = tweezer.find_wall(calibrations, focus, radius=RADIUS, drag=drag, shift=shift)
        # scores and biases over the nearest height: the wall itself is at 0
        first = found.heights[0]
        nearest = heights[0]
        yield Number(by, "wall", found.position + nearest, found.uncertainty, nearest)
        yield Number(by, "nearest height", first.distance, first.uncertainty, nearest)
        if found.drag_uncertainty is not None:
            yield Number(by, "drag far away", found.drag, found.drag_uncertainty, FAR)
        if found.shift_uncertainty is not None:
            yield Number(by, "shift", found.shift, found.shift_uncertainty, SHIFT)
