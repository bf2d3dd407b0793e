"""Free beads: how often the intervals of the diffusion hold it, and how often no trap is seen.

Tracks in x and y of a 1 um bead in water of 20 degC are drawn exactly
(`tests.reference.free_bead`), as a camera of 20 frames a second sees them: exposed for none or all
of each frame, with a
localisation error and a steady drift. Tracks are analysed on all cores.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine, on_all_cores
from tests.reference.free_bead import free
from tests.reference.trapped_bead import BOLTZMANN
from tweezer.reading import Recording

Results = dict[str, Any]

#: Tracks of each study, and of one task
RECORDS, PART = 200, 25
TEMPERATURE, RADIUS, VISCOSITY = 293.15, 0.5e-6, 1.002e-3
DIFFUSION = BOLTZMANN * TEMPERATURE / (6 * math.pi * VISCOSITY * RADIUS)
STEP = 0.05
#: Thermal displacement along one axis in a frame, m
SIZE = math.sqrt(2 * DIFFUSION * STEP)


class Study(NamedTuple):
    """Tracks of one kind."""

    frames: int
    exposure: float
    """of the frame"""
    noise: float
    """of each coordinate, in `SIZE`"""
    drift: float
    """over the track, in thermal displacements of that time"""
    given: bool
    """whether the exposure and the noise are given"""


STUDIES = (
    Study(1000, 0.0, 0.0, 0.0, given=False),
    Study(1000, 1.0, 0.5, 3.0, given=False),
    Study(1000, 1.0, 2.0, 3.0, given=False),
    Study(250, 1.0, 0.5, 3.0, given=False),
    Study(1000, 1.0, 0.5, 3.0, given=True),
)


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    count, part = (2, 2) if quick else (RECORDS, PART)
    studies = STUDIES[:1] if quick else STUDIES
    tasks = [(study, seed, part) for seed in range(1, 1 + count // part) for study in studies]
    found = on_all_cores(analysed, tasks, say)
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick,
            "studies": [{**study._asdict(), **judged(found[study])} for study in studies],
        }
    )  # fmt: skip
    return results


class Track(NamedTuple):
    """What one track told."""

    seen_free: bool
    """whether along both axes no trap is seen"""
    inside: bool
    """whether the interval of the diffusion holds it"""
    alone: int
    """how many of the two intervals of single axes do"""
    by_covariance: int
    """and how many by covariances"""
    ratio: float
    """diffusion over the true one"""
    uncertainty: float
    """relative"""
    findings: tuple[str, ...]


def analysed(study: Study, seed: int, count: int) -> list[Track | None]:
    """So many tracks by `tweezer.calibrate`; None where it sees a trap along both axes."""
    size = math.sqrt(study.frames) * SIZE
    drawn = free(
        STEP, study.frames, DIFFUSION, (seed, STUDIES.index(study)), count=2 * count,
        exposure=study.exposure * STEP, noise=study.noise * SIZE,
        drift=study.drift * size / (study.frames * STEP),
    )  # fmt: skip
    known = {"exposure": study.exposure * STEP, "noise": study.noise * SIZE} if study.given else {}
    return [
        _track(drawn[2 * i : 2 * i + 2].T, known) for i in range(count)
    ]  # fmt: skip


def _track(positions: np.ndarray, known: dict[str, float]) -> Track | None:
    recording = Recording(STEP * np.arange(len(positions)), positions, ("x", "y"), name="track")
    told = tweezer.calibrate(recording, temperature=TEMPERATURE, **known).free
    if told is None:
        return None
    return Track(
        len(told.axes) == 2,
        told.interval[0] < DIFFUSION < told.interval[1],
        sum(each.interval[0] < DIFFUSION < each.interval[1] for each in told.axes),
        sum(
            abs(each.by_covariance - DIFFUSION) < 1.96 * each.by_covariance_uncertainty
            for each in told.axes
        ),
        told.diffusion / DIFFUSION,
        told.uncertainty / told.diffusion,
        tuple(finding.name for finding in told.findings),
    )


def judged(parts: list[list[Track | None]]) -> Results:
    """Of all tracks of a study."""
    every = [track for part in parts for track in part]
    both = [track for track in every if track is not None and track.seen_free]
    against = Counter(name for track in both for name in track.findings)
    return {
        "tracks": len(every),
        "seen_free": len(both),
        "inside": sum(track.inside for track in both),
        "alone_inside": sum(track.alone for track in both),
        "by_covariance_inside": sum(track.by_covariance for track in both),
        "mean_ratio": float(np.mean([track.ratio for track in both])),
        "uncertainty": float(np.median([track.uncertainty for track in both])),
        "marked": sum(bool(track.findings) for track in both),
        "findings": dict(sorted(against.items())),
    }
