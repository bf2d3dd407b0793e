"""Calibration of fast records: the inertia of the fluid, detectors, a driven stage; pylake beside.

Records of beads in water are drawn exactly (`tests.reference.detected_bead`), with the spectrum of
K. Berg-Sorensen and H. Flyvbjerg and all its aliases, at the rates of usual instruments. Counted is
how often the 95 % interval holds what is true, and how far off the mean is. All share one drag, in
water of 20 degC. They are calibrated on all cores.
"""

from __future__ import annotations

import math
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine, on_all_cores
from tests.reference import detected_bead
from tweezer.calibration import AxisCalibration
from tweezer.reading import Recording

Results = dict[str, Any]

TEMPERATURE, VISCOSITY, WATER = 293.15, 1.002e-3, 998.2
#: records of each study, and in one task
RECORDS, PART = 200, 25
#: of polystyrene, kg/m^3
DENSITY = 1050.0
#: of the detector, V/m
RESPONSE = 1e6
#: ordinates in a block of pylake
_PER_BLOCK = 100


class Study(NamedTuple):
    """Records of one bead and detector."""

    kind: str
    """passive, detector or driven"""
    name: str
    diameter: float = 1e-6
    """m"""
    rate: float = 78125.0
    """Hz"""
    stiffness: float = 1e-4
    """N/m"""
    samples: int = 2**17
    exposure: float = 0.0
    """of the step"""
    diode: float = math.inf
    """Hz"""
    through: float = 0.0
    noise: float = 0.0
    """m"""
    drive: tuple[tuple[float, float], ...] = ()
    """frequencies (Hz) and amplitudes (m)"""

    @property
    def drag(self) -> float:
        """kg/s"""
        return 3 * math.pi * VISCOSITY * self.diameter

    @property
    def volume(self) -> float:
        """m^3"""
        return math.pi / 6 * self.diameter**3


PASSIVE = tuple(
    Study("passive", f"{1e6 * diameter:g} um, {rate / 1e3:g} kHz", diameter, rate)
    for diameter in (0.5e-6, 1e-6, 3e-6)
    for rate in (78125.0, 100e3)
)
DETECTORS = (
    Study("detector", "blur", exposure=0.8),
    Study("detector", "diode", diode=14e3, through=0.3),
    Study("detector", "noise", noise=1e-9),
    Study("detector", "diode and noise", diode=14e3, through=0.3, noise=1e-9),
)
DRIVEN = (
    Study("driven", "37 Hz", drive=((37.0, 500e-9),)),
    Study("driven", "three frequencies", drive=((23.0, 500e-9), (61.7, 300e-9), (140.3, 200e-9))),
    Study("driven", "37 Hz, diode", diode=14e3, through=0.3, drive=((37.0, 500e-9),)),
)


class Number(NamedTuple):
    """What a calibration gives."""

    by: str
    quantity: str
    value: float
    uncertainty: float
    true: float


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    studies = [*PASSIVE[:: 3 if quick else 1], *DETECTORS, *DRIVEN]
    count, part = (2, 2) if quick else (RECORDS, PART)
    tasks = [(s, seed, part) for seed in range(1, 1 + count // part) for s in studies]
    found = on_all_cores(calibrated, tasks, say)
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick,
            "pylake": importlib_version(),
            "studies": [{**s._asdict(), "records": count, **judged(found[s])} for s in studies],
        }
    )  # fmt: skip
    return results


def importlib_version() -> str | None:
    """Of pylake; None if it is not installed."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("lumicks.pylake")
    except PackageNotFoundError:
        return None


def calibrated(study: Study, seed: int, count: int) -> tuple[list[Number], dict[str, int]]:
    """All numbers of so many records, and the findings against what is right."""
    numbers: list[Number] = []
    findings: Counter[str] = Counter()
    for i, x in enumerate(records(study, seed, count)):
        of = {"passive": _passive, "detector": _detector, "driven": _driven}[study.kind]
        for each in of(study, x, 1000 * seed + i):
            if isinstance(each, AxisCalibration):
                findings.update(finding.name for finding in each.findings)
            else:
                numbers.append(each)
    return numbers, dict(findings)


def records(study: Study, seed: int, count: int) -> np.ndarray:
    """Thermal motion and noise, (count, samples) m."""

    def density(f: np.ndarray) -> np.ndarray:
        return detected_bead.density(
            f, study.stiffness, study.drag, TEMPERATURE, DENSITY * study.volume,
            WATER * study.volume, study.exposure / study.rate, study.diode, study.through,
        )  # fmt: skip

    x = detected_bead.drawn(density, 1 / study.rate, study.samples, seed, count)
    return x + study.noise * np.random.default_rng(1000 + seed).standard_normal(x.shape)


def _recording(study: Study, signal: np.ndarray, unit: str, **more: Any) -> Recording:
    times = np.arange(study.samples) / study.rate
    return Recording(times, signal[:, None], ("x",), name="record", unit=unit, **more)


def _known(study: Study, *, fluid: bool = True) -> dict[str, Any]:
    masses = {"mass": DENSITY * study.volume, "displaced_mass": WATER * study.volume}
    return {"temperature": TEMPERATURE, "exposure": 0.0, **(masses if fluid else {})}


def _of(by: str, axis: AxisCalibration, study: Study) -> Iterator[Number]:
    """Stiffness, drag and sensitivity of a calibration, as far as it has them."""
    estimate = axis["power spectrum"]
    yield Number(by, "stiffness", estimate.stiffness, estimate.uncertainty, study.stiffness)
    fit = axis.free_fit
    if fit.drag_uncertainty is not None:
        yield Number(by, "drag", fit.bead.drag, fit.drag_uncertainty, study.drag)
    if axis.sensitivity is not None and axis.sensitivity_uncertainty is not None:
        yield Number(by, "m/V", axis.sensitivity, axis.sensitivity_uncertainty, 1 / RESPONSE)


def _passive(study: Study, x: np.ndarray, _: int) -> Iterator[Number | AxisCalibration]:
    metres, volts = _recording(study, x, "m"), _recording(study, RESPONSE * x, "V")
    right = tweezer.calibrate(metres, drag=study.drag, **_known(study)).axes[0]
    yield right
    for estimate in right.estimates:
        yield Number(
            estimate.method, "stiffness", estimate.stiffness, estimate.uncertainty, study.stiffness
        )
    fit = right.free_fit
    assert fit.drag_uncertainty is not None
    yield Number("power spectrum, drag fitted", "drag", fit.bead.drag, fit.drag_uncertainty,
                 study.drag)  # fmt: skip
    in_volts = tweezer.calibrate(volts, drag=study.drag, **_known(study)).axes[0]
    yield from _of("volts", in_volts, study)
    still = tweezer.calibrate(volts, drag=study.drag, **_known(study, fluid=False)).axes[0]
    yield from _of("volts, no inertia", still, study)
    yield from _pylake("pylake", study, RESPONSE * x, fluid=True)
    yield from _pylake("pylake, no inertia", study, RESPONSE * x, fluid=False)
    yield from _pylake("pylake, as called", study, RESPONSE * x, fluid=True, aliases=False)


def _detector(study: Study, x: np.ndarray, _: int) -> Iterator[Number | AxisCalibration]:
    asked: dict[str, Any] = {
        "exposure": "fit" if study.exposure else 0.0,
        "diode": "fit" if math.isfinite(study.diode) else None,
        "noise": "fit" if study.noise else None,
    }
    axis = tweezer.calibrate(_recording(study, x, "m"), **(_known(study) | asked)).axes[0]
    yield axis
    yield from _of("drag fitted", axis, study)
    true = {
        "exposure": study.exposure / study.rate, "diode_frequency": study.diode,
        "diode_fraction": study.through, "noise": study.noise,
    }  # fmt: skip
    for each in axis.detector:
        if each.value is not None and each.uncertainty is not None:
            yield Number("drag fitted", each.name, each.value, each.uncertainty, true[each.name])


def _driven(study: Study, x: np.ndarray, seed: int) -> Iterator[Number | AxisCalibration]:
    t = np.arange(study.samples) / study.rate
    stage, moved = 0 * t, x.copy()
    for f, size in study.drive:
        wave = size * np.exp(2j * np.pi * f * t + 1j * f)
        stage += wave.imag
        moved += (answer(study, f) * wave).imag
    stage += 1e-9 * np.random.default_rng(seed).standard_normal(len(stage))
    signal = RESPONSE * moved
    asked = {"diode": "fit"} if math.isfinite(study.diode) else {}
    for by, fluid in (("volts", True), ("volts, no inertia", False)):
        recording = _recording(study, signal, "V", drive=stage)
        axis = tweezer.calibrate(recording, **_known(study, fluid=fluid), **asked).axes[0]
        if fluid:
            yield axis
        yield from _of(by, axis, study)
    if len(study.drive) == 1:
        yield from _pylake("pylake", study, signal, fluid=True, stage=stage)


def answer(study: Study, f: float) -> complex:
    """Signal, in m, by motion of the stage: by hand."""
    s, m, fluid = 2j * math.pi * f, DENSITY * study.volume, WATER * study.volume
    gamma = study.drag + np.sqrt(4.5 * fluid * study.drag * s) + fluid * s / 2
    passed = study.through**2 + (1 - study.through**2) / (1 + (f / study.diode) ** 2)
    moved = s * (gamma + fluid * s) / (m * s**2 + gamma * s + study.stiffness)
    return complex(moved * math.sqrt(passed))


def _pylake(
    by: str, study: Study, volts: np.ndarray, *, fluid: bool, aliases: bool = True,
    stage: np.ndarray | None = None,
) -> Iterator[Number]:  # fmt: skip
    """By lumicks.pylake: with ten aliases of each side up to Nyquist's frequency, or as it is."""
    try:
        from lumicks import pylake
    except ImportError:
        return
    common = {
        "bead_diameter": 1e6 * study.diameter, "viscosity": VISCOSITY,
        "temperature": TEMPERATURE - 273.15, "hydrodynamically_correct": fluid,
        "fast_sensor": math.isinf(study.diode),
    }  # fmt: skip
    if fluid:
        common |= {"rho_sample": WATER, "rho_bead": DENSITY}
    model = pylake.PassiveCalibrationModel(**common)
    if stage is not None:
        f = study.drive[0][0]
        model = pylake.ActiveCalibrationModel(
            1e6 * stage, volts, sample_rate=study.rate, driving_frequency_guess=f, **common
        )
    highest = 0.45 * study.rate if aliases else 23e3
    without = [] if stage is None else [(f - 3, f + 3)]
    spectrum = pylake.calculate_power_spectrum(
        volts, study.rate, (1.0 if aliases else 100.0, highest), _PER_BLOCK, without
    )
    if aliases:
        model = model._alias_model(study.rate, 10)
    with warnings.catch_warnings(action="ignore"):
        fit = pylake.fit_power_spectrum(spectrum, model)
    values = {
        "stiffness": ("stiffness", 1e-3, study.stiffness),
        "m/V": ("displacement_sensitivity", 1e-6, 1 / RESPONSE),
    }
    for quantity, (name, factor, true) in values.items():
        value, error = getattr(fit, name), getattr(fit, f"{name}_std_err")
        if value is not None and error is not None:
            yield Number(by, quantity, float(factor * value), float(factor * error), true)


def judged(found: list[tuple[list[Number], dict[str, int]]]) -> Results:
    """Of each quantity by each way: how often the interval holds the truth, and the bias."""
    every: dict[tuple[str, str], list[Number]] = {}
    findings: Counter[str] = Counter()
    for numbers, against in found:
        findings.update(against)
        for number in numbers:
            every.setdefault((number.by, number.quantity), []).append(number)
    told = []
    for (by, quantity), numbers in every.items():
        values, errors, true = (
            np.array([getattr(n, name) for n in numbers])
            for name in ("value", "uncertainty", "true")
        )
        scores = (values - true) / errors
        told.append(
            {
                "by": by, "quantity": quantity, "numbers": len(numbers),
                "inside": int((np.abs(scores) < 1.96).sum()),
                "mean_score": float(scores.mean()), "sd_score": float(scores.std()),
                "bias": float((values / true - 1).mean()),
                "uncertainty": float((errors / true).mean()),
            }
        )  # fmt: skip
    return {"findings": dict(findings), "numbers": told}
