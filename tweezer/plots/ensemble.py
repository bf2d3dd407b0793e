"""The figure of an ensemble: mean and spread over time, distribution at the end, escapes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from tweezer.plots import style
from tweezer.plots.scene import caveat_note, change_note, title_of
from tweezer.results.io import scene_of
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: Largest number of bins of a distribution
_BINS = 40
#: Number of beads read at once
_READ = 1000


@style.styled
def ensemble_figure(ensemble: xr.Dataset) -> Figure:
    """Draw mean and spread of the positions over time, their distribution, and the escapes.

    ensemble: result of `tweezer.ensemble`, with trajectories or of statistics alone. Trajectories
    give the distribution at the end, statistics that over all samples of the stationary part.
    Raises `ResultError` if no trajectory is computed, and for several beads.
    """
    if "bead" in ensemble.dims:
        raise ResultError("ensemble: has several beads; select one by isel(bead=0, drop=True)")
    figure = style.new(style.PAGE, 5.2)
    names = ["x", "y", "z"]
    over_time, beside = figure.subfigures(1, 2, squeeze=False)[0]
    axes = dict(zip(names, over_time.subplots(3, sharex=True), strict=True))
    axes["distribution"], axes["left"] = beside.subplots(2, height_ratios=(1.7, 1))
    time = ensemble["time"].values * per("ms")
    whole = "position" in ensemble
    course = _of_trajectories(ensemble) if whole else _of_statistics(ensemble)
    mean, spread, left, total = course
    for i, name in enumerate(names):
        mark = style.AXES[name]
        middle, half = (values[:, i] * per("um") for values in (mean, spread))
        axes[name].plot(time, middle, color=mark.colour)
        axes[name].fill_between(
            time, middle - half, middle + half, color=mark.colour, alpha=0.2, lw=0
        )
        axes[name].set_ylabel(f"{name} (µm)")
    axes["x"].set_title("mean and spread")
    axes["z"].set_xlabel("time (ms)")
    _draw_distribution(axes["distribution"], ensemble)
    axes["left"].step(time, left, where="post", color=style.SPEED.colour)
    axes["left"].set(xlabel="time (ms)", ylabel="beads not lost", ylim=(0, 1.08 * total))
    axes["left"].set_title("escapes")
    over_time.align_ylabels()
    style.add_letters([axes[name] for name in (*names, "distribution", "left")])
    scene = scene_of(ensemble)
    style.add_title(figure, title_of(scene, ensemble.attrs["title"]))
    note = (
        f"{total} trajectories, of which {total - int(left[-1])} are lost before the end. Shaded: "
        "one standard deviation. A lost bead is left out from then on."
    )
    style.add_notes(figure, [change_note(scene), note, caveat_note(scene, cones=False)])
    return figure


def _of_trajectories(ensemble: xr.Dataset) -> tuple[Array, Array, Array, int]:
    """Return the mean (times, 3) m, the standard deviation (times, 3) m and the number (times,) of
    the beads that are not lost, and the number of trajectories.

    Trajectories are read in groups, because they may not fit into memory.
    """
    lost = ensemble["lost_time"].values
    computed = np.flatnonzero(~np.isnan(lost))
    if not computed.size:
        raise ResultError("contains no computed trajectory")
    position = ensemble["position"].transpose("trajectory", "time", "axis")
    first = position[int(computed[0])].values[0]  # squares of differences from it keep their digits
    number = np.zeros(position.shape[1:])
    total, squares = np.zeros_like(number), np.zeros_like(number)
    for begin in range(0, computed.size, _READ):
        some = position[computed[begin : begin + _READ]].values - first
        number += np.isfinite(some).sum(axis=0)
        total += np.nansum(some, axis=0)
        squares += np.nansum(some**2, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = total / np.where(number > 0, number, np.nan)
        variance = (squares - number * mean**2) / np.where(number > 1, number - 1, np.nan)
    return first + mean, np.sqrt(np.maximum(variance, 0.0)), number[:, 0], computed.size


def _of_statistics(ensemble: xr.Dataset) -> tuple[Array, Array, Array, int]:
    """Return the same as `_of_trajectories` for statistics."""
    mean, variance = (
        ensemble[f"position_{name}"].transpose("time", "axis").values
        for name in ("mean", "variance")
    )
    left = ensemble["trajectories_left"].values
    return mean, np.sqrt(variance), left, int(ensemble["trajectories"])


def _draw_distribution(axes: Axes, ensemble: xr.Dataset) -> None:
    """Draw the distribution of each coordinate at the end, or of all samples of statistics."""
    whole = "position" in ensemble
    for axis, mark in style.AXES.items():
        if whole:
            values = ensemble["position"].sel(axis=axis).isel(time=-1).values * per("um")
            values = values[np.isfinite(values)]
            bins = min(_BINS, max(8, round(math.sqrt(values.size))))
            if values.size:
                axes.hist(values, bins, density=True, histtype="step", label=axis, **mark.curve)
        else:
            density = ensemble["density"].sel(axis=axis).values / per("um")
            axes.plot(ensemble["bin"].values * per("um"), density, label=axis, **mark.curve)
    when = "at the end" if whole else "in all samples"
    axes.set(xlabel=f"position {when} (µm)", ylabel="probability density (1/µm)")
    if axes.has_data():
        style.legend_above(axes, 3)
