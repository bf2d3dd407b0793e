"""Fits of scenes to recordings: how often the intervals hold what is true, and what is said.

Recordings are of an ensemble whose bead moves by the map of the force and is seen by a camera with
blur and noise. The fits begin from wrong guesses, with the force of the quadrature. On all cores.
"""

from __future__ import annotations

import warnings
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest

import tweezer
from tests.benchmarks.timing import machine, on_all_cores
from tweezer.analysis import Recording
from tweezer.scene import value_at

Results = dict[str, Any]

#: of the bead that is not trapped yet, in every recording, s
BEFORE = 0.02
TRUE = {
    "bead": {"diameter": "1 um"},
    "beam": {"power_through_pupil": "10 mW"},
    "forces": {"brownian": True},
    "optics": {"evaluator": "map"},
    "start": {"position": [0.0, 0.0, 0.0], "frame": "focus"},
}
GUESS = {"bead": {"diameter": "1.06 um"}, "beam": {"power_through_pupil": "13 mW"}}


class Study(NamedTuple):
    """Recordings of one camera, and what is fitted to them."""

    name: str
    free: tuple[str, ...]
    rate: float
    frames: int
    along: bool
    """whether z is seen"""
    records: int


STUDIES = (
    Study("in the plane", ("bead.diameter", "beam.power_through_pupil"), 2500.0, 5000, False, 100),
    Study("in space", ("bead.diameter", "beam.power_through_pupil"), 2500.0, 5000, True, 100),
    Study(
        "in the plane, viscosity too",
        ("bead.diameter", "beam.power_through_pupil", "medium.viscosity"),
        2500.0, 5000, False, 10,
    ),
)  # fmt: skip


def scene(study: Study) -> tweezer.Scene:
    """What the recordings of a study are of."""
    camera = {"rate": study.rate, "exposure": 1 / study.rate, "noise": "3 nm"}
    if study.along:
        camera["noise_along"] = "15 nm"
    duration = study.frames / study.rate + BEFORE
    return tweezer.load_scene("silica-1um").replace(
        **TRUE, camera=camera,
        simulation={"model": "overdamped", "duration": duration, "samples": 11},
    )  # fmt: skip


def recordings(study: Study, seed: int = 1) -> list[Recording]:
    """The recordings of a study."""
    truth = scene(study)
    found = tweezer.ensemble(truth, study.records, seed=seed)
    times = found["frame_time"].values
    kept = times > BEFORE
    axes = tuple(map(str, found["seen_axis"].values))
    return [
        Recording(f"record {i}", times[kept], found["seen"].values[i, kept], axes)
        for i in range(study.records)
    ]


def _fitted(study: Study, recording: Recording) -> Results:
    with warnings.catch_warnings(action="ignore"):
        guess = scene(study).replace(**GUESS, optics={"evaluator": "auto"})
        if "medium.viscosity" in study.free:
            guess = guess.replace(medium={"viscosity": "1.2 mPa s"})
        found = tweezer.fit(recording, guess, free=study.free)
    return {
        "statement": found.statement,
        "p_value": found.p_value,
        "keys": {
            each.key: [each.value, *each.interval, each.determined] for each in found.keys
        },
    }  # fmt: skip


def measure(*, quick: bool = False, say: Any = lambda _: None) -> Results:
    """Coverage, bias and words of each study."""
    studies = [each._replace(records=3, frames=1500) if quick else each for each in STUDIES]
    tasks = [(study, each) for study in studies for each in recordings(study)]
    fits = on_all_cores(_fitted, tasks, say)
    found = [_summary(study, fits[study]) for study in studies]
    return {"machine": machine(), "studies": found}


def _summary(study: Study, fits: list[Results]) -> Results:
    truth = scene(study)
    keys = {}
    for key in study.free:
        true = value_at(truth, key)
        values = np.array([each["keys"][key][0] for each in fits])
        ends = [(each["keys"][key][1], each["keys"][key][2]) for each in fits]
        inside = sum(
            (low is None or low <= true) and (high is None or true <= high) for low, high in ends
        )
        low, high = binomtest(inside, len(fits)).proportion_ci(0.95)
        lengths = [high - low for low, high in ends if low is not None and high is not None]
        keys[key] = {
            "true": true, "inside": inside, "inside_from": low, "inside_to": high,
            "bias": float(values.mean() / true - 1),
            "bias_error": float(values.std(ddof=1) / true / np.sqrt(len(fits))),
            "half_interval": float(np.median(lengths) / 2 / true) if lengths else None,
            "determined": sum(bool(each["keys"][key][3]) for each in fits),
        }  # fmt: skip
    return {
        "name": study.name, "rate_Hz": study.rate, "frames": study.frames, "records": len(fits),
        "keys": keys, "least_p_value": min(each["p_value"] for each in fits),
        "statement": fits[0]["statement"],
    }  # fmt: skip
