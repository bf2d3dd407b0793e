"""Figures of runs. Each function returns a matplotlib Figure and touches no global state."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from tweezer.analysis import summarise
from tweezer.io import scene_of
from tweezer.optics.rays import polar_sine_and_cosine

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MICRO, _MILLI = 1e6, 1e3
_COLOURS = {"x": "#4477aa", "y": "#ee6677", "z": "#228833"}
_LIGHT, _PATH, _MUTED = "#cc3311", "#332288", "#777777"


def run_figure(run: xr.Dataset) -> Figure:
    """The path in the plane of the beam's axis, coordinates and speeds over time."""
    figure = Figure(figsize=(11.0, 6.0))
    axes = figure.subplot_mosaic(
        [["path", "position"], ["path", "speed"]],
        width_ratios=(1, 1.2),
        gridspec_kw={
            "left": 0.06, "right": 0.93, "bottom": 0.09, "top": 0.88,
            "wspace": 0.22, "hspace": 0.09,
        },
    )  # fmt: skip
    _draw_path(axes["path"], run)
    _draw_position(axes["position"], run)
    _draw_speed(axes["speed"], run)
    axes["position"].sharex(axes["speed"])
    axes["position"].tick_params(labelbottom=False)
    figure.align_ylabels([axes["position"], axes["speed"]])
    model = run.attrs["model"]
    if model == "scaled":
        model += f", a₂ = {scene_of(run).simulation.scaling_factor:g}"
    figure.suptitle(f"{run.attrs['title']}\n{model} · {run.attrs['method']}", fontsize=11)
    return figure


def _milliseconds(run: xr.Dataset) -> np.ndarray:
    return run["time"].values * _MILLI


def _draw_path(axes: Axes, run: xr.Dataset) -> None:
    """Distance from the axis, signed by the side of the start, against z; bead to scale."""
    scene = scene_of(run)
    position = run["position"].values * _MICRO
    start = position[0, :2]
    direction = start / np.linalg.norm(start) if start.any() else np.array([1.0, 0.0])
    lateral, z = position[:, :2] @ direction, position[:, 2]
    radius = scene.bead.radius * _MICRO
    reach = 1.15 * max(np.abs(lateral).max() + radius, np.abs(z).max() + radius, 3 * radius)
    sine, cosine = polar_sine_and_cosine(np.array([scene.lens.radius]), scene.lens, scene.medium)
    slope = float(sine[0] / cosine[0])
    for side in (-1, 1):
        cone = [(0, 0), (-slope * reach, side * reach), (slope * reach, side * reach)]
        axes.add_patch(Polygon(cone, color=_LIGHT, alpha=0.07, lw=0, zorder=0))
    axes.plot(lateral, z, color=_PATH, lw=1.6, zorder=3)
    for i, filled in ((0, False), (-1, True)):
        axes.add_patch(
            Circle((lateral[i], z[i]), radius, facecolor=_PATH if filled else "none",
                   edgecolor=_PATH, alpha=0.35 if filled else 0.9, lw=1.0, zorder=2)
        )  # fmt: skip
    axes.annotate("start", (lateral[0], z[0]), ha="center", va="center", fontsize=8, color=_MUTED)
    axes.plot(0, 0, "+", color=_LIGHT, ms=9, mew=1.4, zorder=4)
    axes.set(
        xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal",
        xlabel="lateral position, towards the start (µm)", ylabel="z along the light (µm)",
    )  # fmt: skip
    axes.set_title("path, bead and cone of light to scale; + focus", fontsize=9)


def _draw_position(axes: Axes, run: xr.Dataset) -> None:
    for axis, colour in _COLOURS.items():
        values = run["position"].sel(axis=axis) * _MICRO
        axes.plot(_milliseconds(run), values, color=colour, lw=1.5, label=axis)
    axes.axhline(0, color=_MUTED, lw=0.6)
    _mark_closest_approach(axes, run, "")
    axes.set_ylabel("position (µm)")
    axes.legend(frameon=False, ncols=3, fontsize=9)


def _draw_speed(axes: Axes, run: xr.Dataset) -> None:
    """Actual and terminal speed (5.2), with the Reynolds number (5.1) on the right."""
    time = _milliseconds(run)
    axes.plot(time, run["speed"], color=_PATH, lw=1.6, label="actual")
    axes.plot(time, run["terminal_speed"], color=_LIGHT, lw=1.1, ls="--", label="terminal (5.2)")
    _mark_closest_approach(axes, run, "first closest\napproach")
    fast = float(run["speed"].max())
    if fast > 0:
        axes.set_yscale("log")
        axes.set_ylim(fast * 5e-5, fast * 3)
        number_per_speed = float(run["reynolds_number"].max()) / fast
        right = axes.secondary_yaxis(
            "right",
            functions=(
                lambda speed: np.asarray(speed) * number_per_speed,
                lambda number: np.asarray(number) / number_per_speed,
            ),
        )
        right.set_ylabel("Reynolds number (5.1)")
    axes.set(xlabel="time (ms)", ylabel="speed (m/s)")
    axes.legend(frameon=False, fontsize=9)


def _mark_closest_approach(axes: Axes, run: xr.Dataset, label: str) -> None:
    time = summarise(run).closest_approach_time
    if time is None:
        return
    axes.axvline(time * _MILLI, color=_MUTED, lw=0.8, ls=":")
    axes.annotate(
        label, (time * _MILLI, 1), xycoords=("data", "axes fraction"),
        xytext=(3, -3), textcoords="offset points", va="top", fontsize=7, color=_MUTED,
    )  # fmt: skip
