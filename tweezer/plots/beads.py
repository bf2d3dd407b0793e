"""Figure of a run of several beads: their displacements, distances and the forces between them."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from tweezer.plots import style
from tweezer.plots.scene import caveat_note, change_note, title_of
from tweezer.results.io import scene_of
from tweezer.values.arrays import Array
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: Number of entries of a legend above which it is left out
_MOST = 6


@style.styled
def beads_figure(run: xr.Dataset) -> Figure:
    """Draw the displacements of several beads, their distances and the forces between them.

    Displacements are along the axis on which the first two beads are farthest apart. Without forces
    between the beads their panel is left out.

    Parameters
    ----------
    run : xarray.Dataset
        Run of `tweezer.simulate` for a scene with several beads.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    scene = scene_of(run)
    position = run["position"].transpose("time", "bead", "axis").values
    along = int(np.argmax(np.abs(position[0, 1] - position[0, 0])))
    axis, names, pairs = "xyz"[along], run["bead"].values, run["pair"].values
    moved = per("nm") * (position - position[0])[:, :, along]
    panels = [(f"displacement in {axis} (nm)", names, moved)]
    panels.append(("distance (µm)", pairs, per("um") * run["distance"].values))
    if np.any(run["force_between"]):
        panels.append(("force between (pN)", pairs, per("pN") * run["force_between"].values))
    figure = style.new(style.PAGE, 0.6 + 1.5 * len(panels))
    axes = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
    thin: dict[str, Any] = {"lw": 0.5, "ls": "-"} if scene.forces.brownian else {}
    time = per("ms") * run["time"].values
    for panel, (label, curves, values) in zip(axes, panels, strict=True):
        _draw(panel, time, curves, values, thin)
        panel.set_ylabel(label)
    axes[-1].set(xlabel="time (ms)", xlim=time[[0, -1]] if len(time) > 1 else None)
    figure.align_ylabels(axes)
    style.add_letters(axes)
    style.add_title(figure, title_of(scene, run.attrs["title"]))
    message = run.attrs["message"]
    about = f"Method: {run.attrs['method']}. Distance of the centres. A positive force attracts."
    ended = f" Ended early: {message}." if message else ""
    caveat = caveat_note(scene.alone(1), cones=False)
    style.add_notes(figure, [change_note(scene), about + ended, caveat])
    return figure


def _draw(axes: Axes, time: Array, names: Array, values: Array, look: dict[str, Any]) -> None:
    """Draw values (n, curves) over times (n,), with a legend of the curves if they are few."""
    for name, mark, curve in zip(names, cycle(style.SERIES), values.T, strict=False):
        many = {"rasterized": len(time) > 10_000}
        axes.plot(time, curve, label=str(name), **(mark.curve | look | many))
    if len(names) <= _MOST:
        style.widen(style.legend_above(axes, len(names)))
