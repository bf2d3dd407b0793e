"""The page of an ensemble: a moving cloud of beads, or statistics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics import bound_once
from tweezer.ensembles.statistics import error_of_part, joined, moments
from tweezer.results.io import scene_of
from tweezer.scene import Scene
from tweezer.scene.heading import heading, of_changes
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.viewing.arrays import Packed, float32, uint16
from tweezer.viewing.content import Content, Row
from tweezer.viewing.rows import computed_by, of_number
from tweezer.viewing.setting import of_the_picture, plotted_axes, scene_facts
from tweezer.viewing.surroundings import of_the_medium
from tweezer.viewing.turning import orientations

if TYPE_CHECKING:
    import xarray as xr

Numbers = NDArray[np.int64]

#: Largest number of positions in a page, which take 6 bytes each
_MOST = 2_000_000
#: Smallest number of times to which they are thinned, before beads are left out
_TIMES = 200
#: Largest number of times in a page of statistics
_MOST_TIMES = 2000
#: Largest number of bins of a density
_BINS = 500
#: Number of positions read at a time
_READ = 2_000_000


class _Course(NamedTuple):
    """Mean, spread and number of the beads of an ensemble, at each time shown."""

    mean: Array
    """(times, 3) mean position of the beads that are not lost, m"""
    mean_error: Array
    """(times, 3) standard error of the mean, m"""
    spread: Array
    """(times, 3) standard deviation of the positions, m"""
    spread_error: Array
    """(times, 3) standard error of the standard deviation, m"""
    left: Array
    """(times,) number of beads that are not yet lost"""
    near: Array | None
    """(times,) number of beads within a bead radius of the equilibrium; None without one"""


def content(dataset: xr.Dataset) -> Content:
    """Return the content of the page of an ensemble, from its trajectories or its statistics.

    Raises `ResultError` if its scene is not valid.
    """
    scene = scene_of(dataset)
    return (_of_trajectories if "position" in dataset else _of_statistics)(dataset, scene)


def _of_trajectories(dataset: xr.Dataset, scene: Scene) -> Content:
    """Return the content of the page of an ensemble with trajectories: a moving cloud of beads."""
    times, lost_time = dataset["time"].values, dataset["lost_time"].values
    computed = ~np.isnan(lost_time)
    if not computed.any():
        raise ResultError("contains no computed trajectory")
    lost_time = lost_time[computed]
    kept, beads, taken = _thinned(len(times), len(lost_time))
    sphere = scene.bead.shape == "sphere"
    place = bound_once(scene).equilibrium if scene.lit and sphere else None
    centre = None if place is None else np.array(place.position)
    course, positions = _read(dataset, computed, kept, taken, centre, scene.body.size)
    lost = lost_time[taken]
    arrays = {name: uint16(positions[:, :, k].T, "m") for k, name in enumerate("xyz")}
    arrays |= _packed(times[kept], course)
    arrays["lost_time"] = float32(lost, "s")
    if "orientation" in dataset and not sphere:
        axis, *_ = plotted_axes(scene)
        arrays |= orientations(dataset, np.flatnonzero(computed), kept, axis)
    total = len(lost_time)
    return Content(
        kind="ensemble",
        title=heading(scene, dataset.attrs["title"]),
        facts={
            **scene_facts(scene),
            "beads": total,
            "drawn": beads,
            "centre": None if centre is None else centre.tolist(),
            "trajectories": True,
        },
        arrays=arrays,
        summary=_summary(dataset, scene, course, total, int(np.isfinite(lost_time).sum())),
        notes=[
            *of_changes(scene), *_of_thinning(len(times), total, kept, beads),
            *_of_the_cloud(centre is not None), *_of_the_bodies(scene),
            *of_the_picture(scene), f"{computed_by(dataset.attrs)} Seed {dataset.attrs['seed']}.",
        ],
        warning="" if computed.all() else (
            f"This ensemble was stopped early: {np.count_nonzero(~computed)} of its "
            f"{computed.size} trajectories were not computed and are omitted."
        ),
    )  # fmt: skip


def _thinned(times: int, trajectories: int) -> tuple[Numbers, int, Numbers]:
    """Choose evenly spaced times and beads so that the page has at most 2 million positions.

    Times are left out first, down to 200, then beads. Returns the indices of the times, the number
    of beads, and the indices of the beads.
    """
    every = 1
    if times * trajectories > _MOST:
        needed = math.ceil(times * trajectories / _MOST)
        every = max(1, min(needed, (times - 1) // (_TIMES - 1)))
    kept = _one_in(every, times)
    beads = min(trajectories, max(1, _MOST // kept.size))
    return kept, beads, np.linspace(0, trajectories - 1, beads).round().astype(np.int64)


def _one_in(every: int, times: int) -> Numbers:
    """Return the indices of one in `every` of so many times, always including the last."""
    return np.unique([*range(0, times, every), times - 1])


def _read(
    dataset: xr.Dataset, computed: NDArray[np.bool_], kept: Numbers, taken: Numbers,
    centre: Array | None, radius: float,
) -> tuple[_Course, Array]:  # fmt: skip
    """Return the course of all beads at the times shown, and the positions of the beads shown.

    The ensemble is read in blocks of beads, because it may not fit into memory.

    `computed` (trajectories,) selects the beads that were computed. `kept` contains the indices of
    the times and `taken` the indices, among computed beads, of those to show. `centre` (3,) is the
    equilibrium, m, or None, and `radius` the bead's radius, m. Positions are (beads, times, 3) m.
    """
    numbers = np.flatnonzero(computed)
    times = dataset["time"].values[kept]
    at_once = max(1, _READ // dataset.sizes["time"])
    found = np.zeros((5, times.size * 3))
    near = np.zeros(times.size)
    positions = np.empty((taken.size, times.size, 3))
    for first in range(0, numbers.size, at_once):
        some = numbers[first : first + at_once]
        block = dataset["position"][some[0] : some[-1] + 1].values
        block = block[some - some[0]][:, kept]
        found = joined(found, moments(block.reshape(len(some), -1), 4))
        if centre is not None:
            near += (np.linalg.norm(block - centre, axis=2) < radius).sum(axis=0)
        within = (taken >= first) & (taken < first + len(some))
        positions[within] = block[taken[within] - first]
    # number, mean, and sums of powers 2 to 4 of deviations from the mean, by time and axis
    count, mean, m2, _, m4 = found.reshape(5, times.size, 3)
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = np.where(count > 1, m2 / (count - 1), np.nan)
        of_variance = np.sqrt((m4 / count - variance**2 * (count - 3) / (count - 1)) / count)
        course = _Course(
            np.where(count > 0, mean, np.nan), np.sqrt(variance / count), np.sqrt(variance),
            of_variance / (2 * np.sqrt(variance)), count[:, 0], None if centre is None else near,
        )  # fmt: skip
    # error of a standard deviation s: the error of s^2 divided by 2 s
    return course, positions


def _of_statistics(dataset: xr.Dataset, scene: Scene) -> Content:
    """Return the content of the page of an ensemble that stored only statistics."""
    every = -(-dataset.sizes["time"] // _MOST_TIMES)
    kept = _one_in(every, dataset.sizes["time"])
    thin = dataset.isel(time=kept)
    spread = np.sqrt(thin["position_variance"].values)
    with np.errstate(divide="ignore", invalid="ignore"):
        spread_error = thin["position_variance_error"].values / (2 * spread)
    course = _Course(
        thin["position_mean"].values, thin["position_mean_error"].values, spread, spread_error,
        thin["trajectories_left"].values, None,
    )  # fmt: skip
    arrays = _packed(thin["time"].values, course)
    density = dataset[["density"]].coarsen(bin=_together(dataset), boundary="trim").mean()
    arrays |= {
        "bin": float32(density["bin"].values, "m"),
        "density": float32(density["density"].transpose("axis", "bin").values, "1/m"),
    }
    total = int(dataset["trajectories"])
    return Content(
        kind="ensemble",
        title=heading(scene, dataset.attrs["title"]),
        facts={
            **scene_facts(scene), "beads": total, "drawn": 0, "centre": None, "trajectories": False,
        },
        arrays=arrays,
        summary=[
            *_summary(dataset, scene, course, total, int(dataset["trajectories_lost"])),
            *_stationary(dataset),
        ],
        notes=[
            *of_changes(scene),
            "This ensemble contains statistics but no trajectories. The shells show one and two "
            "standard deviations of the beads about their mean along each axis.",
            *_of_times(dataset.sizes["time"], kept),
            *of_the_picture(scene, oriented=False),
            f"{computed_by(dataset.attrs)} Seed {dataset.attrs['seed']}.",
        ],
    )  # fmt: skip


def _together(dataset: xr.Dataset) -> int:
    """Return how many bins of the density are averaged into one so that at most 500 remain."""
    return max(1, -(-dataset.sizes["bin"] // _BINS))


def _packed(times: Array, course: _Course) -> dict[str, Packed]:
    """Return the times and the course of an ensemble as encoded arrays, by name."""
    arrays = {
        "time": float32(times, "s"),
        "mean": float32(course.mean, "m"),
        "mean_error": float32(course.mean_error, "m"),
        "spread": float32(course.spread, "m"),
        "spread_error": float32(course.spread_error, "m"),
        "left": float32(course.left, "1"),
    }
    return arrays if course.near is None else arrays | {"near": float32(course.near, "1")}


def _summary(
    dataset: xr.Dataset, scene: Scene, course: _Course, total: int, lost: int
) -> list[Row]:
    """Return the lines of the summary of an ensemble.

    `total` is the number of beads, and `lost` the number of beads lost before the end.
    """
    rows = [
        Row("beads", f"{total}"),
        Row("lost before the end", *_share(lost, total)),
        of_number("time simulated", float(dataset["time"][-1]), None, "s", in_tables=True),
    ]
    if course.near is not None:
        words = "within one bead radius of the equilibrium at the end"
        rows.append(Row(words, *_share(int(course.near[-1]), total)))
    for name, values, errors in (
        ("mean", course.mean, course.mean_error), ("spread", course.spread, course.spread_error),
    ):  # fmt: skip
        for k, axis in enumerate("xyz"):
            about = f"{name} of {axis} of the remaining beads at the end"
            value, error = float(values[-1, k]), float(errors[-1, k])
            rows.append(
                of_number(about, value, error, "m", in_tables=True)
                if course.left[-1]
                else Row(about, "no beads remain")
            )
    model, method = dataset.attrs["model"], dataset.attrs["method"]
    return [
        *rows,
        Row("model, method", f"{model}; {method}"),
        of_number("step", float(dataset.attrs["step"]), None, "s", in_tables=True),
        Row("light", f"{scene.theory} ({scene.theory_reason})" if scene.lit else "none"),
        *of_the_medium(scene),
        Row("seed", f"{dataset.attrs['seed']}"),
    ]


def _share(number: int, total: int) -> tuple[str, str]:
    """Return a number of beads with its percentage, and the standard error of the percentage.

    The error is half the width of Wilson's interval for one standard deviation.
    """
    if not total:
        return "0", ""
    part = number / total
    return f"{number}, {100 * part:.4g} %", f"± {100 * error_of_part(part, total):.2g} %"


def _stationary(dataset: xr.Dataset) -> list[Row]:
    """Return the lines with mean and variance over beads and time, along each axis."""
    return [
        of_number(
            f"{name} of {axis} over beads and time",
            float(dataset[f"stationary_{name}"][k]), float(dataset[f"stationary_{name}_error"][k]),
            unit, in_tables=True,
        )
        for name, unit in (("mean", "m"), ("variance", "m^2"))
        for k, axis in enumerate("xyz")
    ]  # fmt: skip


def _of_times(times: int, kept: Numbers) -> list[str]:
    """Return a list with a note on times that were left out; empty if all are shown."""
    if kept.size == times:
        return []
    return [
        f"To limit its size, the page contains one in {kept[1]} of {times} times, and the last."
    ]


def _of_thinning(times: int, total: int, kept: Numbers, beads: int) -> list[str]:
    """Return the notes on times and beads that were left out.

    `times` and `total` are the numbers of times and beads. `kept` contains the indices of the times
    shown, and `beads` is the number of beads shown.
    """
    notes = _of_times(times, kept)
    if beads < total:
        notes.append(
            f"The page draws {beads} of {total} beads, evenly chosen. Means, spreads and "
            "percentages include all beads."
        )
    return notes


def _of_the_bodies(scene: Scene) -> list[str]:
    """Return a list with a note on the rotation of the bodies; empty for spheres."""
    if scene.bead.shape == "sphere":
        return []
    return [
        "The first body is drawn at its position and orientation, until it is lost. The alignment "
        "is the mean square of the direction cosines of the body axis over all remaining bodies: "
        "1/3 along each axis if all directions are equally likely."
    ]


def _of_the_cloud(near: bool) -> list[str]:
    """Return the notes on how to read the cloud; `near`: whether the page counts beads near an
    equilibrium.
    """
    notes = [
        "Each point is the centre of a bead at the last sample before the time shown. A lost bead "
        "remains as a ring at its last position; means and spreads exclude it.",
        "The probability density is the number of remaining beads in each cell of a plane, "
        "summed over the direction across the plane, divided by the number of remaining beads and "
        "the cell area. Its axes span the cloud at that time, or the clouds of all times.",
        "The beads do not interact: each was simulated alone in the light.",
    ]
    if near:
        notes.append(
            "Near the equilibrium means within one bead radius of the stable equilibrium nearest "
            "the focus. If the light changes, it is the equilibrium at time 0."
        )
    return notes
