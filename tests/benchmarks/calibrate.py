"""Calibration of recordings with a known trap: coverage of confidence intervals, and findings.

Recordings are drawn exactly (`tests.reference.trapped_bead`). Some describe cameras at three rates
that are exposed for none or all of each frame. Others have 40 and 820 relaxation times, with drift
or white noise. The coverage of the 95 % interval refers to the numbers without a finding.
Recordings are calibrated on all cores. `speed` then measures the processor time for long recordings
on one core and compares it with pylake's fit of the spectrum.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import time
import tracemalloc
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from scipy.signal import lfilter

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine
from tests.reference.trapped_bead import BOLTZMANN, trapped
from tweezer.calibration import AxisCalibration
from tweezer.reading import Recording

Results = dict[str, Any]

#: of the first round; each has its own
SEED = 1
#: rounds, and records of each study in one
ROUNDS, RECORDS = 4, 50
TEMPERATURE = 293.15
#: of a bead of 1 um in water, kg/s
DRAG = 6 * math.pi * 1.002e-3 * 0.5e-6
#: samples of a camera's record
FRAMES = 6000
#: samples of the records whose calibration is timed, and their rate, Hz
LENGTHS, RATE = (100_000, 1_000_000, 10_000_000), 78125.0


class Study(NamedTuple):
    """Records of one trap, disturbed in one way."""

    stiffness: float
    """N/m"""
    step: float
    """s"""
    samples: int
    drag_given: bool
    exposure: float = 0.0
    """of the step"""
    exposure_given: bool = False
    noise: float = 0.0
    """standard deviations of the motion"""
    drift: float = 0.0
    """over the record, in standard deviations of the motion"""


CAMERAS = tuple(
    Study(stiffness, 1 / rate, FRAMES, drag_given, exposure, exposure_given)
    for exposure, exposure_given in ((1.0, True), (0.0, False), (1.0, False))
    for rate in (20e3, 2500.0, 500.0)
    for stiffness in (50e-6, 12e-6)
    for drag_given in (True, False)
)
_RELAXATION = DRAG / 1e-5
DISTURBED = tuple(
    Study(1e-5, 0.1 * _RELAXATION, 10 * relaxations, drag_given, noise=noise, drift=drift)
    for noise, drift in (
        (0.0, 0.0), (0.05, 0.0), (0.1, 0.0), (0.3, 0.0), (0.0, 0.3), (0.0, 1.0), (0.0, 3.0)
    )
    for relaxations in (820, 40)
    for drag_given in (True, False)
)  # fmt: skip


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    every, count = (8, 2) if quick else (1, RECORDS)
    tasks = [
        (study, SEED + i, count)
        for i in range(1 if quick else ROUNDS)
        for study in (*CAMERAS, *DISTURBED)[::every]
    ]
    found: dict[Study, list[AxisCalibration]] = {study: [] for study, *_ in tasks}
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), mp_context=context) as executor:
        parts = executor.map(calibrated, *zip(*tasks, strict=True))
        for i, ((study, *_), part) in enumerate(zip(tasks, parts, strict=True), 1):
            found[study] += part
            say(f"{i} of {len(tasks)} sets of records")
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick, "speed": speed(quick=quick, say=say),
            "cameras": [_judged(s, found[s]) for s in CAMERAS if s in found],
            "disturbed": [_judged(s, found[s]) for s in DISTURBED if s in found],
        }
    )  # fmt: skip
    return results


def speed(*, quick: bool, say: Callable[[str], object]) -> Results:
    """Processor time and memory of whole calibrations of long records, and the time of pylake."""
    from lumicks import pylake

    step, stiffness = 1 / RATE, 5e-5
    decay = math.exp(-stiffness / DRAG * step)
    size = math.sqrt(BOLTZMANN * TEMPERATURE / stiffness * (1 - decay**2))
    rows = []
    for samples in (20_000,) if quick else LENGTHS:
        kicks = size * np.random.default_rng(SEED).standard_normal(samples)
        x = lfilter([1], [1, -decay], kicks)  # exact; it starts in the middle of the trap
        times = step * np.arange(samples)
        recording = Recording(times, x[:, None], ("x",), name="record")

        def ours(recording: Recording = recording) -> object:
            return tweezer.calibrate(recording, temperature=TEMPERATURE, drag=DRAG, exposure=0.0)

        def theirs(x: np.ndarray = x) -> object:
            return pylake.calibrate_force(
                1e6 * x, bead_diameter=1.0, temperature=TEMPERATURE - 273.15, viscosity=1.002e-3,
                sample_rate=RATE, num_points_per_block=100,
            )  # fmt: skip

        seconds, of_pylake = (
            _processor_time(run, 3 if samples < 1e7 else 2) for run in (ours, theirs)
        )
        tracemalloc.start()
        ours()
        memory = tracemalloc.get_traced_memory()[1] / x.nbytes
        tracemalloc.stop()
        rows.append({"samples": samples, "seconds": seconds, "pylake": of_pylake, "memory": memory})
        say(f"{samples} samples")
    return {"machine": machine(), "records": rows}


def _processor_time(run: Callable[[], object], repeats: int) -> float:
    """Return the least of some calls after a first one, s."""
    found = []
    for _ in range(1 + repeats):
        before = time.process_time()
        run()
        found.append(time.process_time() - before)
    return min(found[1:])


def calibrated(study: Study, seed: int, count: int) -> list[AxisCalibration]:
    """Of so many records."""
    drag = DRAG if study.drag_given else None
    exposure = study.exposure * study.step if study.exposure_given else None
    times = np.arange(study.samples) * study.step
    recordings = [
        Recording(times, x[:, None], ("x",), name="record") for x in records(study, seed, count)
    ]
    return [
        tweezer.calibrate(r, temperature=TEMPERATURE, drag=drag, exposure=exposure).axes[0]
        for r in recordings
    ]


def records(study: Study, seed: int, count: int) -> np.ndarray:
    """Positions (count, samples), m."""
    x = trapped(
        study.step, study.samples, study.stiffness, DRAG, None, TEMPERATURE, seed, count,
        exposure=study.exposure * study.step,
    )  # fmt: skip
    size = math.sqrt(BOLTZMANN * TEMPERATURE / study.stiffness)
    noise = np.random.default_rng(1000 + seed).standard_normal(x.shape)
    return x + size * (study.noise * noise + study.drift * np.linspace(-0.5, 0.5, study.samples))


def _judged(study: Study, found: list[AxisCalibration]) -> Results:
    marks = Counter(finding.name for each in found for finding in each.findings)
    methods = {}
    for method in dict.fromkeys(e.method for each in found for e in each.estimates):
        estimates = [e for each in found for e in each.estimates if e.method == method]
        inside = np.array(
            [abs(e.stiffness - study.stiffness) < 1.96 * e.uncertainty for e in estimates]
        )
        unmarked = np.array([not e.findings for e in estimates])
        methods[method] = {
            "records": len(estimates),
            "inside": int(inside.sum()),
            "unmarked": int(unmarked.sum()),
            "unmarked_and_inside": int((unmarked & inside).sum()),
        }
    return {
        **study._asdict(), "records": len(found), "rate_Hz": 1 / study.step,
        "relaxations": study.samples * study.step * study.stiffness / DRAG,
        "clean": sum(not each.findings for each in found), "findings": dict(marks),
        "methods": methods,
    }  # fmt: skip
