"""Figure of a run: its path, positions, and speeds or distance over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from tweezer.plots import style
from tweezer.plots.scene import add_caveat, draw_cones, draw_walls, planes
from tweezer.results.io import scene_of
from tweezer.results.run import Run
from tweezer.runs import summarise
from tweezer.runs.resolved import resolved
from tweezer.scene import Scene
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: Speed below which nothing is drawn, over the largest speed
_SLOWEST = 5e-5


@style.styled
def run_figure(run: xr.Dataset) -> Figure:
    """Draw the path in the plane of the beam's axis, and coordinates and speeds over time.

    With thermal motion the distance to the focus takes the place of the speeds, which have no
    meaning between samples. Samples too far apart to show the motion are drawn as points.

    Parameters
    ----------
    run : xarray.Dataset
        Run of `tweezer.simulate`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    figure = style.new(style.PAGE, 4.3)
    axes = figure.subplot_mosaic(
        [["path", "position"], ["path", "below"]], width_ratios=(1, 1.12), height_ratios=(1, 1.1)
    )
    _draw_path(axes["path"], run)
    _draw_position(axes["position"], run)
    if _thermal(run):
        _draw_distance(axes["below"], run)
    else:
        _draw_speed(axes["below"], run)
    axes["position"].sharex(axes["below"])
    axes["position"].tick_params(labelbottom=False)
    figure.align_ylabels([axes["position"], axes["below"]])
    model = run.attrs["model"]
    if model == "scaled":
        model += f", a₂ = {scene_of(run).simulation.scaling_factor:g}"
    how = [model, run.attrs["method"], run.attrs["message"]]  # the message if it ended early
    style.add_title(figure, run.attrs["title"], " · ".join(filter(None, how)))
    add_caveat(figure, scene_of(run))
    return figure


def _milliseconds(run: xr.Dataset) -> np.ndarray:
    """Return the times of the samples, (n,), ms."""
    return run["time"].values * per("ms")


def _thermal(run: xr.Dataset) -> bool:
    """Return whether the run has thermal motion."""
    return scene_of(run).forces.brownian


def _look(run: xr.Dataset, mark: style.Mark) -> dict[str, Any]:
    """Return the style of a curve through the samples, or of points if samples form no curve.

    Thermal motion is drawn by thin solid lines. More than 10,000 points are drawn as an image,
    because vector graphics would be large.
    """
    many = {"rasterized": run.sizes["time"] > 10_000}
    if not resolved(Run.of(run)):
        return {"ls": "", "marker": ".", "ms": 2, "color": mark.colour, **many}
    if _thermal(run):
        return {"ls": "-", "lw": 0.5, "color": mark.colour, **many}
    return {**mark.curve, **many}


def _draw_path(axes: Axes, run: xr.Dataset) -> None:
    """Draw z and the distance from the axis, which is positive on the side of the release."""
    scene = scene_of(run)
    position = run["position"].values * per("um")
    start = position[0, :2]
    direction = start / np.linalg.norm(start) if start.any() else np.array([1.0, 0.0])
    lateral, z = position[:, :2] @ direction, position[:, 2]
    radius = scene.body.size * per("um")
    foci = per("um") * np.array([beam.position for beam in scene.beams])
    across = np.abs(np.append(lateral, foci[:, :2] @ direction)).max()
    along = np.abs(np.append(z, foci[:, 2])).max()
    reach = 1.15 * max(across + radius, along + radius, 3 * radius)
    near = [plane for plane, _ in planes(scene) if abs(plane) < 1.5 * reach]
    reach = max(reach, *(1.15 * abs(plane) for plane in near), 0.0)
    draw_cones(axes, scene, reach, direction, color=style.LIGHT, alpha=0.07, lw=0, zorder=0)
    axes.plot(lateral, z, zorder=3, **_look(run, style.SERIES[0]))
    for i, filled in ((0, False), (-1, True)):
        axes.add_patch(
            Circle((lateral[i], z[i]), radius, facecolor=style.PATH if filled else "none",
                   edgecolor=style.PATH, alpha=0.35 if filled else 0.9, lw=0.8, zorder=2)
        )  # fmt: skip
    draw_walls(axes, scene, reach)
    below = z[len(z) // 2] > z[0]  # the side that the path leaves free
    axes.annotate(
        "start", (lateral[0], z[0] - radius if below else z[0] + radius), ha="center",
        va="top" if below else "bottom", xytext=(0, -2 if below else 2),
        textcoords="offset points", fontsize=style.SMALL, color=style.NOTE, zorder=4,
        bbox={"fc": "white", "ec": "none", "pad": 0.5, "alpha": 0.8},
    )  # fmt: skip
    axes.plot(foci[:, :2] @ direction, foci[:, 2], "+", color=style.LIGHT, ms=7, mew=1.2, zorder=4)
    axes.set(
        xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal",
        xlabel="lateral position, towards the start (µm)", ylabel="z along the light (µm)",
    )  # fmt: skip
    shown = "path" if resolved(Run.of(run)) else "samples"
    axes.set_title(f"{shown}, bead and light to scale; + focus")


def _draw_position(axes: Axes, run: xr.Dataset) -> None:
    """Draw the coordinates over time."""
    for below, (axis, mark) in enumerate(style.AXES.items()):
        values = run["position"].sel(axis=axis) * per("um")
        axes.plot(_milliseconds(run), values, label=axis, zorder=3 - below / 4, **_look(run, mark))
    axes.axhline(0, color=style.MUTED, lw=0.6)
    _draw_contact(axes, scene_of(run))
    _mark_closest_approach(axes, run, "")
    axes.set_ylabel("position (µm)")
    style.widen(style.legend_above(axes, 3, markerscale=3))


def _draw_contact(axes: Axes, scene: Scene) -> None:
    """Draw the height at which the bead touches a wall, if it is close to the range of the axes."""
    low, high = axes.get_ylim()
    for plane, normal in planes(scene):
        touching = plane + normal * scene.body.support(normal) * per("um")
        if abs(touching - (low + high) / 2) < high - low:
            axes.axhline(touching, color=style.AXES["z"].colour, lw=0.8, ls="--", zorder=2)
            axes.annotate(
                "z where the bead touches the wall", (1, touching),
                xycoords=("axes fraction", "data"), xytext=(-3, 3), textcoords="offset points",
                ha="right", fontsize=style.SMALL, color=style.NOTE,
            )  # fmt: skip


def _draw_distance(axes: Axes, run: xr.Dataset) -> None:
    """Draw the distance to the focus over time."""
    axes.plot(_milliseconds(run), run["distance"] * per("um"), **_look(run, style.SERIES[0]))
    axes.set(xlabel="time (ms)", ylabel="distance to the focus (µm)")
    axes.set_ylim(bottom=0)


def _draw_speed(axes: Axes, run: xr.Dataset) -> None:
    """Draw actual and terminal speed (5.2) over time, with the Reynolds number (5.1)."""
    time = _milliseconds(run)
    look = _look(run, style.SERIES[0])
    if resolved(Run.of(run)):  # the terminal speed coincides with it most of the time
        look |= {"lw": 2.6, "alpha": 0.45}
    axes.plot(time, run["speed"], label="actual", **look)
    terminal = _look(run, style.SERIES[1])
    axes.plot(time, run["terminal_speed"], label="terminal (5.2)", **terminal)
    _mark_closest_approach(axes, run, "first closest\napproach")
    fast = float(run["speed"].max())
    if fast > 0:
        axes.set_yscale("log")
        axes.set_ylim(fast * _SLOWEST, fast * 3)
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
    style.legend_above(axes, 2)


def _mark_closest_approach(axes: Axes, run: xr.Dataset, label: str) -> None:
    """Mark the time of the first closest approach by a line, except for thermal motion."""
    time = summarise(run).closest_approach_time
    if time is None or _thermal(run):  # thermal motion has many close approaches
        return
    axes.axvline(time * per("ms"), color=style.MUTED, lw=0.8, ls=":")
    late = time * per("ms") > _milliseconds(run)[-1] / 2
    axes.annotate(
        label, (time * per("ms"), 1), xycoords=("data", "axes fraction"),
        xytext=(-3 if late else 3, -3), textcoords="offset points", va="top",
        ha="right" if late else "left", fontsize=style.SMALL, color=style.NOTE,
    )  # fmt: skip
