"""Fits of scenes to recordings: coverage of the confidence intervals, and reports.

Recordings come from ensembles with the force map, either as `run` writes them or as a camera with
blur and noise sees them. The fits start from wrong first guesses, with the force by quadrature.
They run on all cores.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest

import tweezer
from tests.benchmarks.timing import machine, on_all_cores
from tweezer.reading import Recording
from tweezer.scene import value_at

Results = dict[str, Any]

#: of the bead that is not trapped yet, in every recording, s
BEFORE = 0.02
BEADS: dict[str, dict[str, Any]] = {
    "1 um silica, 10 mW": {
        "bead": {"diameter": "1 um"},
        "beam": {"power_through_pupil": "10 mW"},
    },
    "1.5 um polystyrene, 20 mW": {
        "bead": {"diameter": "1.5 um", "refractive_index": 1.59, "density": "1050 kg/m^3"},
        "beam": {"power_through_pupil": "20 mW"},
    },
    "3 um silica, 20 mW": {
        "bead": {"diameter": "3 um"},
        "beam": {"power_through_pupil": "20 mW"},
    },
}
TRUE = {
    "forces": {"brownian": True},
    "optics": {"evaluator": "map"},
    "start": {"position": [0.0, 0.0, 0.0], "frame": "focus"},
}
#: First guesses, over the truth
WRONG = {"bead.diameter": 1.06, "beam.power_through_pupil": 1.3, "medium.viscosity": 1.2}

SIZE = ("bead.diameter",)
BOTH = ("bead.diameter", "beam.power_through_pupil")
FIRST = ("1 um silica, 10 mW",)
STEPS = (10e-6, 50e-6, 200e-6, 1e-3)


class Study(NamedTuple):
    """Recordings of several beads with several steps, and the fitted keys."""

    name: str
    free: tuple[str, ...]
    beads: tuple[str, ...]
    steps: tuple[float, ...]
    """s"""
    samples: int
    records: int
    """of each bead by each step"""
    axes: str = "xyz"
    camera: bool = False
    """whether a camera sees the bead, exposed all the time, with noise; else the run's own samples
    are fitted"""
    model: str | None = None
    """that the scene names; without one it is that of a run, with the memory of the fluid"""
    inertia: str | None = None
    """of the fluid, that the scene names"""


EVERY = (tuple(BEADS), STEPS, 10_000, 5)
STUDIES = (
    Study("samples of a run", SIZE, *EVERY),
    Study("samples of a run", BOTH, *EVERY),
    Study("a camera", BOTH, tuple(BEADS), STEPS[1:], 5_000, 5, camera=True),
    Study(
        "samples, model overdamped", BOTH, tuple(BEADS), STEPS[::2], 10_000, 1, model="overdamped"
    ),
    Study(
        "samples, medium.inertia none", BOTH, tuple(BEADS), STEPS[::2], 10_000, 1, inertia="none"
    ),
    Study(
        "a camera, x and y", (*BOTH, "medium.viscosity"), FIRST, (0.4e-3,), 5_000, 2, "xy",
        camera=True,
    ),
)  # fmt: skip


def scene(study: Study, bead: str, step: float) -> tweezer.Scene:
    """Return the scene of the recordings."""
    samples = study.samples + round(BEFORE / step)
    medium = {} if study.inertia is None else {"inertia": study.inertia}
    simulation = {"duration": f"{samples * step} s", "samples": samples + 1, "model": study.model}
    truth = tweezer.load_scene("silica-1um").replace(
        **TRUE, **BEADS[bead], medium=medium,
        simulation={key: value for key, value in simulation.items() if value is not None},
    )  # fmt: skip
    if not study.camera:
        return truth
    camera = {"rate": 1 / step, "exposure": step, "noise": "3 nm"}
    if "z" in study.axes:
        camera["noise_along"] = "15 nm"
    return truth.replace(camera=camera, simulation={"samples": 11})


def recordings(study: Study, bead: str, step: float, seed: int) -> Iterator[Recording]:
    """The recordings of one bead by one step."""
    found = tweezer.ensemble(scene(study, bead, step), study.records, seed=seed)
    what, when = ("seen", "frame_time") if study.camera else ("position", "time")
    times = found[when].values
    kept = slice(len(times) - study.samples, None)
    for i, positions in enumerate(found[what].values):
        yield Recording(
            times[kept], positions[kept, : len(study.axes)], tuple(study.axes), name=f"record {i}"
        )


def _fitted(study: Study, bead: str, step: float, recording: Recording) -> Results:
    truth = scene(study, bead, step)
    wrong = {key: WRONG[key] * value_at(truth, key) for key in study.free}
    with warnings.catch_warnings(action="ignore"):
        guess = truth.replace(optics={"evaluator": "auto"})
        for key, value in wrong.items():
            section, _, name = key.partition(".")
            guess = guess.replace(**{section: {name: value}})
        found = tweezer.fit(recording, guess, free=study.free)
    return {
        "bead": bead,
        "step": step,
        "statement": found.statement,
        "p_value": found.p_value,
        "keys": {
            each.key: [value_at(truth, each.key), each.value, *each.interval, each.determined]
            for each in found.keys
        },
    }  # fmt: skip


def measure(*, quick: bool = False, say: Any = lambda _: None) -> Results:
    """Coverage, bias and words of each study."""
    studies = [each._replace(records=1, samples=1500) if quick else each for each in STUDIES]
    if quick:
        studies = [each._replace(beads=each.beads[:1], steps=each.steps[:1]) for each in studies]
    tasks = [
        (study, bead, step, recording)
        for number, study in enumerate(studies)
        for i, bead in enumerate(study.beads)
        for j, step in enumerate(study.steps)
        for recording in recordings(study, bead, step, 1 + 100 * number + 10 * i + j)
    ]
    fits = on_all_cores(_fitted, tasks, say)
    found = [_summary(study, fits[study]) for study in studies]
    return {"machine": machine(), "studies": found}


def _summary(study: Study, fits: list[Results]) -> Results:
    keys = {}
    for key in study.free:
        every = [each["keys"][key] for each in fits]
        covered = [
            (low is None or low <= true) and (high is None or true <= high)
            for true, _, low, high, _ in every
        ]
        told = [inside for inside, (*_, determined) in zip(covered, every, strict=True)
                if determined]  # fmt: skip
        off = np.array([value / true - 1 for true, value, *_ in every])
        # in standard errors, of those that are determined
        scores = np.array(
            [3.92 * (value - true) / (high - low) for true, value, low, high, sure in every if sure]
        )
        lengths = [
            (high - low) / true for true, _, low, high, _ in every if None not in (low, high)
        ]
        low, high = binomtest(sum(covered), len(fits)).proportion_ci(0.95)
        keys[key] = {
            "inside": sum(covered), "inside_from": low, "inside_to": high,
            "bias": float(off.mean()), "bias_error": _error(off),
            "score": float(scores.mean()) if scores.size else None, "score_error": _error(scores),
            "half_interval": float(np.median(lengths) / 2) if lengths else None,
            "determined": len(told), "determined_inside": sum(told),
        }  # fmt: skip
    return {
        "name": study.name, "steps": study.steps, "samples": study.samples, "records": len(fits),
        "keys": keys, "least_p_value": min(each["p_value"] for each in fits),
        "refuted": sum(each["p_value"] < 0.01 for each in fits),
        "statement": fits[0]["statement"],
    }  # fmt: skip


def _error(numbers: Any) -> float | None:
    """Standard error of the mean."""
    return float(np.std(numbers, ddof=1) / np.sqrt(len(numbers))) if len(numbers) > 1 else None
