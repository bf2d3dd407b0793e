"""The start in z from tracks in the plane: coverage and length of the interval, bias.

Tracks are of the unscaled bead with thermal motion, by the exponential Heun method under the map,
released from rest where the thesis releases it, with the noise of a camera. The fit is told the
scene, and neither the depth nor the noise. Coverage is of the 95 % interval, with that of Clopper
and Pearson about it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine
from tweezer.analysis import Track, fit_depth
from tweezer.scene import Scene

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


#: motions are followed until the bead rests in the trap
BEADS = (
    Study("thesis-500nm", 12e-3, 5e3, 15e-9),
    Study("thesis-990nm", 10e-3, 5e3, 15e-9),
    Study("thesis-1950nm", 50e-3, 1e3, 15e-9),
)
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


def tracks(study: Study, count: int) -> Iterator[Track]:
    """Tracks with thermal motion and noise."""
    scene = unscaled(study.scene)
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
        yield Track(study.scene, run["time"].values, seen)


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    counts = (4, 1) if quick else (200, 8)
    studies = [
        _study(study, count, say)
        for of, count in zip((BEADS, CAMERAS), counts, strict=True)
        for study in of
    ]
    beads = len(BEADS)
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick,
            "beads": studies[:beads], "cameras": studies[beads:],
        }
    )  # fmt: skip
    return results


def _study(study: Study, count: int, say: Callable[[str], object]) -> Results:
    scene = unscaled(study.scene)
    z = scene.start_position[2]
    off, lengths, covered, undetermined, seconds = [], [], 0, 0, []
    for i, track in enumerate(tracks(study, count)):
        say(f"{study.scene}, {study.rate:g} Hz, {1e9 * study.noise:g} nm: track {i + 1}")
        start = time.perf_counter()
        found = fit_depth(track, scene)
        seconds.append(time.perf_counter() - start)
        off.append(found.z - z)
        lengths.append(sum(high - low for low, high in found.intervals))
        covered += any(low <= z <= high for low, high in found.intervals)
        undetermined += not found.determined
    interval = binomtest(covered, count).proportion_ci(0.95)
    length = float(np.mean(lengths))
    return {
        "scene": study.scene, "duration_s": study.duration, "rate_Hz": study.rate,
        "noise_m": study.noise, "tracks": count, "coverage": covered / count,
        "coverage_from": interval.low, "coverage_to": interval.high,
        "bias_m": float(np.mean(off)), "bias_error_m": float(np.std(off) / np.sqrt(count)),
        "deviation_m": float(np.std(off)), "interval_m": length,
        "bias_of_interval": float(np.mean(off)) / length, "undetermined": undetermined,
        "seconds": float(np.median(seconds)),
    }  # fmt: skip
