"""The start in z from tracks in the plane: coverage and length of the interval, bias.

Tracks are of the unscaled bead with thermal motion, by the exponential Heun method under the map,
released from rest where the thesis releases it, with the noise of a camera; and of a bead that
starts a tenth of a micrometre above a wall, without inertia. The fit is told the
scene, and neither the depth nor the noise; where it finds power or radius too, it is told one that
is too large. Coverage is of the 95 % interval, with that of Clopper
and Pearson about it: of every track, and of those that determine z. Tracks are fitted on all cores;
the time of a fit is that of its core.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine
from tweezer.reading import Track
from tweezer.scene import Scene
from tweezer.tracking import DepthFit, fit_depth
from tweezer.values.errors import PhysicsWarning

Results = dict[str, Any]

SEED = 1


class Study(NamedTuple):
    """Tracks of one bead and one camera."""

    scene: str
    duration: float
    """s"""
    rate: float
    """Hz, frames"""
    noise: float
    """m"""
    fit: str = ""
    """what else is fitted"""
    wall: bool = False
    """whether the bead starts beside one"""


#: motions are followed until the bead rests in the trap
BEADS = (
    Study("thesis-500nm", 12e-3, 5e3, 15e-9),
    Study("thesis-990nm", 10e-3, 5e3, 15e-9),
    Study("thesis-1950nm", 50e-3, 1e3, 15e-9),
)
#: motions whose scene is not known
UNKNOWN = tuple(Study("thesis-990nm", 10e-3, 5e3, 15e-9, fit) for fit in ("power", "radius"))
#: motions beside a wall, in light so weak that thermal motion is seen on the way
BESIDE = (Study("silica-1um", 40e-3, 1e3, 10e-9, wall=True),)
#: Where the fit beside a wall seeks the start, m: the trap looks alike from both sides
BELOW = (-1.49e-6, 0.0)
#: what the fit is told, over the truth
WRONG = 1.25
CAMERAS = tuple(
    Study("thesis-990nm", 10e-3, rate, noise)
    for rate in (1e3, 10e3)
    for noise in (5e-9, 15e-9, 50e-9)
)


def unscaled(name: str) -> Scene:
    """The scene as the truth has it, and the fit knows it."""
    return tweezer.load_scene(name).replace(
        simulation={"model": "full", "method": "auto"},
        optics={"evaluator": "map", "table_range": 20.0},
    )


def truth(study: Study) -> Scene:
    """The scene of the tracks."""
    scene = unscaled(study.scene)
    if not study.wall:
        return scene
    return scene.replace(
        beam={"power_through_pupil": "5 mW"}, wall={"position": "-2 um"},
        start={"position": ["0.4 um", "0.2 um", "-1.4 um"]}, simulation={"model": "overdamped"},
    )  # fmt: skip


def tracks(study: Study, count: int) -> Iterator[Track]:
    """Tracks with thermal motion and noise."""
    scene = truth(study)
    samples = round(study.duration * study.rate) + 1
    run = tweezer.ensemble(
        scene.replace(
            forces={"brownian": True},
            simulation={"duration": study.duration, "samples": samples},
        ),
        count, seed=SEED,
    )  # fmt: skip
    rng = np.random.default_rng(SEED)
    for positions in run["position"].values[..., :2]:
        seen = positions + study.noise * rng.normal(size=positions.shape)
        yield Track(run["time"].values, seen, name=study.scene)


def told(study: Study) -> Scene:
    """The scene as the fit is told it: what it fits is wrong."""
    scene = truth(study)
    if study.fit == "power":
        return scene.replace(beam={"power": WRONG * scene.beam.power})
    if study.fit == "radius":
        return scene.replace(bead={"radius": WRONG * scene.bead.radius})
    return scene


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    counts = (4, 1, 4, 1) if quick else (200, 100, 100, 8)
    with ProcessPoolExecutor(
        os.cpu_count(), mp_context=multiprocessing.get_context("spawn")
    ) as executor:
        studies = [
            _study(study, count, say, executor)
            for of, count in zip((BEADS, UNKNOWN, BESIDE, CAMERAS), counts, strict=True)
            for study in of
        ]
    beads = len(BEADS) + len(UNKNOWN) + len(BESIDE)
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick,
            "beads": studies[:beads], "cameras": studies[beads:],
        }
    )  # fmt: skip
    return results


def _fit(track: Track, study: Study) -> tuple[DepthFit, float]:
    """The fit, and the s that it took of its core."""
    warnings.simplefilter("ignore", PhysicsWarning)  # said once, by the process in charge
    start = time.process_time()
    fit = [study.fit] if study.fit else []
    found = fit_depth(track, told(study), fit=fit, search=BELOW if study.wall else None)
    return found, time.process_time() - start


def _study(study: Study, count: int, say: Callable[[str], object], executor: Executor) -> Results:
    z = truth(study).start_position[2]
    fits, seconds = [], []
    for found, taken in executor.map(_fit, tracks(study, count), [study] * count):
        fits.append(found)
        seconds.append(taken)
        motion = f"{study.scene} {study.fit}, {study.rate:g} Hz, {1e9 * study.noise:g} nm"
        say(f"{motion}: track {len(fits)}")
    off = np.array([found.z - z for found in fits])
    lengths = np.array([sum(high - low for low, high in found.intervals) for found in fits])
    covered = np.array([any(low <= z <= high for low, high in fit.intervals) for fit in fits])
    determined = np.array([found.determined for found in fits])
    interval = binomtest(int(covered.sum()), count).proportion_ci(0.95)
    bias, deviation = float(off.mean()), float(off.std(ddof=1)) if count > 1 else math.nan
    results: Results = {
        "scene": study.scene, "fit": study.fit, "wall": study.wall,
        "duration_s": study.duration, "rate_Hz": study.rate,
        "noise_m": study.noise, "tracks": count, "coverage": float(covered.mean()),
        "coverage_from": interval.low, "coverage_to": interval.high,
        "bias_m": bias, "bias_error_m": deviation / np.sqrt(count), "deviation_m": deviation,
        "interval_m": float(lengths.mean()), "bias_of_interval": bias / float(lengths.mean()),
        "median_interval_m": float(np.median(lengths)),
        "bias_of_median_interval": bias / float(np.median(lengths)),
        "undetermined": int((~determined).sum()), "seconds": float(np.median(seconds)),
    }  # fmt: skip
    if determined.any():
        own = binomtest(int(covered[determined].sum()), int(determined.sum())).proportion_ci(0.95)
        results["determined"] = {
            "coverage": float(covered[determined].mean()),
            "coverage_from": own.low, "coverage_to": own.high,
            "bias_m": float(off[determined].mean()),
            "median_interval_m": float(np.median(lengths[determined])),
        }  # fmt: skip
    return results
