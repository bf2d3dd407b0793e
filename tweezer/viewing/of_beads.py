"""The page of a run of several beads: all beads moving in the light, with what joins them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.results.io import scene_of
from tweezer.results.run import Run
from tweezer.scene import Scene
from tweezer.scene.heading import heading, of_changes
from tweezer.scene.several import pairs
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.viewing.arrays import Packed, float32
from tweezer.viewing.content import Content, Row
from tweezer.viewing.of_run import ENDED, moving_light
from tweezer.viewing.rows import computed_by, of_number, si
from tweezer.viewing.setting import of_the_picture, scene_facts
from tweezer.viewing.surroundings import of_the_medium

if TYPE_CHECKING:
    import xarray as xr

#: Largest number of pairs of beads in the plots
_MOST = 6
#: Largest number of steps between samples that resolve the motion. A step is at most a twentieth
#: of the shortest relaxation time
_RESOLVED = 20


def content(dataset: xr.Dataset) -> Content:
    """Return the content of the page of a run of several beads.

    Raises `ResultError` if its scene is not valid.
    """
    run, scene = Run.of(dataset), scene_of(dataset)
    if not np.isfinite(run["position"]).all():
        raise ResultError("contains samples without a position, which cannot be shown")
    status, message = run.attributes["status"], run.attributes["message"]
    alone, kept = scene.alone(1), _plotted(run["distance"])
    return Content(
        kind="beads",
        title=heading(scene, run.attributes["title"]),
        facts={
            **scene_facts(alone),
            **_beads(scene),
            "pairs": [str(run["pair"][k]) for k in kept],
            "thermal": scene.forces.brownian,
            "resolved": _resolved(run, scene),
            "status": status,
            "subtitle": f"{len(scene.beads)} beads over {si(float(run['time'][-1]), 's')}",
        },
        arrays=_arrays(run, alone, kept),
        summary=list(_rows(run, scene)),
        notes=[
            *of_changes(scene), *_of_the_beads(run, scene, len(kept)), *of_the_picture(alone),
            computed_by(run.attributes),
        ],
        warning=f"This run {ENDED[status]}: {message}." if status in ENDED else "",
    )  # fmt: skip


def _beads(scene: Scene) -> dict[str, Any]:
    """Return names and radii, m, of the beads, and what each tether joins, for the picture.

    A tether joins two beads, by their indices, or a bead and a point, m.
    """
    names = scene.bead_names
    tethers = [
        {"beads": [names.index(name) for name in tether.between], "point": tether.point}
        for tether in scene.tether
    ]
    beads = [
        {"name": name, "shells": [radius for radius, _ in each.shells]}
        for name, each in zip(names, scene.beads, strict=True)
    ]
    return {"beads": beads, "tethers": tethers}


def _plotted(distance: Array) -> list[int]:
    """Return the indices of the pairs in the plots: those that come closest, in their order."""
    return sorted(np.argsort(distance.min(axis=0), kind="stable")[:_MOST].tolist())


def _arrays(run: Run, alone: Scene, kept: list[int]) -> dict[str, Packed]:
    """Return the arrays of the page, with distances and forces of the pairs that are kept."""
    arrays = {
        "time": float32(run["time"], "s"),
        "position": float32(run["position"], "m"),
        "force_light": float32(run["optical_force"], "N"),
        "distance": float32(run["distance"][:, kept], "m"),
    }
    if np.any(run["force_between"]):
        arrays["force_between"] = float32(run["force_between"][:, kept], "N")
    return arrays | moving_light(alone, run["time"])


def _resolved(run: Run, scene: Scene) -> bool:
    """Return whether lines between the samples show the motion."""
    time = run["time"]
    if not scene.forces.brownian or len(time) < 2:
        return True
    return bool(time[1] - time[0] <= _RESOLVED * run.attributes["step"])


def _of_the_beads(run: Run, scene: Scene, shown: int) -> list[str]:
    """Return notes on the samples, the forces, the fluid and the pairs that are left out."""
    notes = []
    if len(run["time"]) > 1:
        apart = si(float(run["time"][1] - run["time"][0]), "s")
        notes.append(
            f"The sampling interval is {apart}. The page connects samples by straight lines."
            if _resolved(run, scene)
            else f"The sampling interval is {apart}, too long to resolve the fastest relaxation. "
            "The samples are drawn as points, and the beads jump from one to the next."
        )
    notes.append(
        "The beads move each other through the fluid, without its inertia. A positive force "
        "between two beads pulls them together. Lines between beads are tethers."
    )
    count = len(list(pairs(len(scene.beads))))
    if count > shown:
        notes.append(f"The plots contain the {shown} of {count} pairs that come closest.")
    return notes


def _rows(run: Run, scene: Scene) -> Iterator[Row]:
    """Yield the lines of the summary: outcome, errors, pairs and settings."""
    about = run.attributes
    outcome = about["message"] or about["status"]
    yield Row("outcome", outcome, "", about["status"] not in ENDED)
    yield Row("model, method", f"{about['model']}; {about['method']}")
    yield Row("force by", about["force_evaluator"])
    for k, name in enumerate(run["pair"]):
        yield of_number(f"mean distance, {name}", float(run["distance"][:, k].mean()), unit="m")
        yield of_number(f"smallest gap, {name}", float(run["gap"][:, k].min()), unit="m")
        if np.any(run["force_between"][:, k]):
            mean = float(run["force_between"][:, k].mean())
            yield of_number(f"mean force between, {name}", mean, unit="N")
    if scene.forces.brownian:
        yield Row("step", si(about["step"], "s"))
        yield Row("seed", str(about["seed"]))
    else:
        yield Row("error of the integration", f"up to {si(about['integration_error'], 'm', 1)}")
    if not math.isnan(about["model_error"]):
        yield Row("error by the inertia of the fluid", f"up to {si(about['model_error'], 'm', 1)}")
    yield from of_the_medium(scene.alone(1))
    for name, each in zip(scene.bead_names, scene.beads, strict=True):
        yield Row(f"radius, {name}", si(each.radius, "m", 4))
    yield Row("samples", f"{len(run['time'])}")
