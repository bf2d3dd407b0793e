"""Stiffness of a trap from what a camera saw of a simulated bead: how often intervals hold it.

Trajectories of the shipped 1 um silica bead at 10 mW, by the whole force of the light and without
inertia, seen by a camera whose frames are exposed all the time, with noise. Each is
calibrated as a saved run is: by what the camera saw, its exposure and its noise. What is true is
the stiffness of the force where it vanishes.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.hydro import Number, judged
from tests.benchmarks.timing import machine, on_all_cores

Results = dict[str, Any]

#: Number of records of each study, and of those that one task draws
RECORDS, PART = 200, 20
#: Number of frames of a record
FRAMES = 6000
POWER = "10 mW"


class Study(NamedTuple):
    """Records of one camera."""

    rate: float
    """frames a second"""
    noise: float
    """of x and y, m; four times as much of z"""
    drag_given: bool = True


STUDIES = tuple(
    Study(rate, noise, drag_given)
    for rate in (500.0, 2500.0)
    for noise, drag_given in ((5e-9, True), (5e-9, False))
)


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    count, part = (2, 2) if quick else (RECORDS, PART)
    studies = STUDIES[:1] if quick else STUDIES
    tasks = [(study, seed, part) for seed in range(1, 1 + count // part) for study in studies]
    found = on_all_cores(calibrated, tasks, say)
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick,
            "stiffness": true_stiffness(scene(studies[0], FRAMES)),
            "studies": [
                {**study._asdict(), "records": count, **judged(found[study])} for study in studies
            ],
        }
    )  # fmt: skip
    return results


def scene(study: Study, frames: int) -> tweezer.Scene:
    """Of records of so many frames."""
    camera = {
        "rate": study.rate, "exposure": 1 / study.rate, "noise": study.noise,
        "noise_along": 4 * study.noise,
    }  # fmt: skip
    return tweezer.load_scene("silica-1um").replace(
        beam={"power_through_pupil": POWER}, optics={"evaluator": "map"},
        forces={"brownian": True}, start={"drawn": "boltzmann"}, camera=camera,
        simulation={"duration": f"{frames / study.rate:g} s", "samples": frames // 10 + 1,
                    "model": "overdamped"},
    )  # fmt: skip


def true_stiffness(of: tweezer.Scene) -> dict[str, float]:
    """By axis, N/m."""
    equilibrium = tweezer.characterise(of).equilibrium
    return dict(zip("xyz", np.diag(equilibrium.stiffness).tolist(), strict=True))


def calibrated(
    study: Study, seed: int, count: int, frames: int = FRAMES
) -> tuple[list[Number], dict[str, int]]:
    """Numbers that carry no finding, of so many records, and how often each finding was made."""
    of = scene(study, frames)
    true = true_stiffness(of)
    numbers: list[Number] = []
    against: Counter[str] = Counter()
    runs = tweezer.ensemble(of, count, seed=seed, workers=1)
    for i in range(count):
        recording = tweezer.load_recording(runs.isel(trajectory=i))
        known = {}
        if not study.drag_given:  # as a recording from elsewhere
            recording = dataclasses.replace(recording, scene=None)
            known = {"temperature": of.medium.temperature}
        found = tweezer.calibrate(recording, **known)
        for axis in found.axes:
            against.update(finding.name for finding in axis.findings)
            for each in axis.estimates:
                against.update(f.name for f in each.findings if f not in axis.findings)
                if not each.findings:
                    by = f"{axis.axis}, {each.method}"
                    values = each.stiffness, each.uncertainty, true[axis.axis]
                    numbers.append(Number(by, "stiffness", *values))
    return numbers, dict(against)
