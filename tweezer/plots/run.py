"""Figure of a run: its path, positions, and speeds or distance over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from scipy.spatial.transform import Rotation

from tweezer.dynamics import bound_once
from tweezer.plots import style
from tweezer.plots.body import outline
from tweezer.plots.scene import (
    caveat_note,
    change_note,
    draw_cones,
    draw_walls,
    planes,
    title_of,
)
from tweezer.results.io import scene_of
from tweezer.results.run import Run
from tweezer.runs import summarise
from tweezer.runs.resolved import resolved
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: Speed below which nothing is drawn, over the largest speed
_SLOWEST = 5e-5
#: Widest and narrowest panel of a path, as its width over its height
_NARROW, _WIDE = 0.62, 1.15
#: Part of the length of a path after which its colours end: the bead is at rest
_TRAVELLED = 0.995
#: Ratio of terminal and actual speed at the end from which the difference is explained
_APART = 1.5
#: Ratio of the ranges of a record and of its second half from which only the latter is shown
_BEYOND = 3.0
#: Number of bins of a histogram of positions
_BINS = 60
#: Colours of times; the lightest ones are left out, which white paper would hide
_TIMES = ListedColormap(colormaps[style.VALUES](np.linspace(0.0, 0.88, 256)))


class _Path(NamedTuple):
    """Path of a bead in the plane that the axis of the light spans with the point of release."""

    lateral: Array
    """(n,) coordinates from the axis, towards the release, µm"""
    z: Array
    """(n,) coordinates along the light, µm"""
    direction: Array
    """(2,) unit vector of the lateral coordinate in the plane of x and y"""
    limits: Array
    """(2, 2) ends of both axes, µm"""

    @property
    def shape(self) -> float:
        """Width over height of its panel."""
        width, height = np.diff(self.limits, axis=1).ravel()
        return float(width / height)


@style.styled
def run_figure(run: xr.Dataset) -> Figure:
    """Draw the path in the plane of the beam's axis, and coordinates and speeds over time.

    With thermal motion each coordinate is drawn in a panel with its histogram. The distance to the
    equilibrium replaces the speeds, which are not defined by the samples. Without a known
    equilibrium it is the distance to the focus. Samples too far apart to show the motion are drawn
    as points.

    Parameters
    ----------
    run : xarray.Dataset
        Run of `tweezer.simulate`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    scene, path, thermal = scene_of(run), _path(run), _thermal(run)
    figure = style.new(style.PAGE, 5.2 if thermal else 4.3)
    left = 1.2 * path.shape
    if thermal:
        names = ["x", "y", "z", "distance"]
        rows: list[Any] = [["path", name, f"{name} histogram"] for name in names]
        axes = figure.subplot_mosaic(rows, width_ratios=(left, 1.25, 0.25))
        _draw_records(axes, run)
        beside = [axes[name] for name in names]
    else:
        rows = [["path", "position"], ["path", "speed"]]
        axes = figure.subplot_mosaic(rows, width_ratios=(left, 1.5), height_ratios=(1, 1.1))
        _draw_position(axes["position"], run)
        _draw_speed(axes["speed"], run)
        axes["position"].sharex(axes["speed"])
        axes["position"].tick_params(labelbottom=False)
        beside = [axes["position"], axes["speed"]]
    _draw_path(axes["path"], run, path)
    figure.align_ylabels(beside)
    style.add_letters([axes["path"], *beside])
    style.add_title(figure, title_of(scene, run.attrs["title"]))
    style.add_notes(figure, [change_note(scene), " ".join(_notes(run, path)), caveat_note(scene)])
    return figure


def _notes(run: xr.Dataset, path: _Path) -> list[str]:
    """Return the notes on how the run was computed, and on what its figure shows."""
    model = run.attrs["model"]
    if model == "scaled":
        model += f" with a₂ = {scene_of(run).simulation.scaling_factor:g}"
    notes = [f"Model: {model}. Method: {run.attrs['method']}."]
    if message := run.attrs["message"]:  # if it ended early
        notes.append(f"Ended early: {message}.")
    shown = "circle" if scene_of(run).bead.shape == "sphere" else "outline"
    told = (
        f"Open {shown}: bead at the release; filled: at the end; shaded: cone of light; +: focus."
    )
    if not np.array_equal(path.direction, [1.0, 0.0]):
        told += " The lateral position is counted towards the release."
    notes.append(told)
    if _thermal(run):
        return [*notes, "Records that settle are drawn in the range of their second half."]
    if _closest_approach(run) is not None:
        notes.append("Dotted line: first closest approach to the focus.")
    notes.append(
        "Terminal speed: the speed at which the drag balances the other forces. Reynolds number: "
        "speed times diameter times density over viscosity of the medium."
    )
    speed, terminal = (float(run[name][-1]) for name in ("speed", "terminal_speed"))
    if run.attrs.get("fluid_inertia", "").startswith("memory") and terminal > _APART * speed > 0:
        notes.append(
            "Speed and terminal speed differ at the end because the fluid that the bead has set in "
            "motion still pushes on it."
        )
    return notes


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


def _foci(scene: Scene, direction: Array) -> tuple[Array, Array]:
    """Return the lateral coordinates and z of all foci, µm."""
    foci = per("um") * np.array([beam.position for beam in scene.beams])
    return foci[:, :2] @ direction, foci[:, 2]


def _path(run: xr.Dataset) -> _Path:
    """Return the path of the bead, with limits that include it, the foci and nearby walls."""
    scene = scene_of(run)
    position = run["position"].values * per("um")
    start = position[0, :2]
    direction = start / np.linalg.norm(start) if start.any() else np.array([1.0, 0.0])
    lateral, z = position[:, :2] @ direction, position[:, 2]
    radius = scene.body.size * per("um")
    limits = []
    for coordinates, foci in zip((lateral, z), _foci(scene, direction), strict=True):
        low = min(coordinates.min() - radius, foci.min())
        high = max(coordinates.max() + radius, foci.max())
        margin = max(0.12 * (high - low), 0.4 * radius)
        limits.append([low - margin, high + margin])
    (left, right), (low, high) = limits
    height = high - low
    near = [plane for plane, _ in planes(scene) if low - height < plane < high + height]
    low, high = min([low, *near]), max([high, *near])
    if near:
        low, high = low - 0.06 * (high - low), high + 0.06 * (high - low)
    wider = max(0.0, _NARROW * (high - low) - (right - left)) / 2
    higher = max(0.0, (right - left) / _WIDE - (high - low)) / 2
    ends = [[left - wider, right + wider], [low - higher, high + higher]]
    return _Path(lateral, z, direction, np.array(ends))


def _outlines(
    run: xr.Dataset, i: int, place: tuple[float, float], direction: Array
) -> list[Circle | Polygon]:
    """Return the outlines of the bead at sample `i` in the plane of z and a lateral direction.

    `place` is its centre in this plane, um, and `direction` (2,) the direction across the light.
    """
    scene = scene_of(run)
    if scene.bead.shape == "sphere":
        return [Circle(place, scene.body.size * per("um"))]
    to_plane = Rotation.from_euler("z", -np.arctan2(direction[1], direction[0]))
    turned = to_plane * Rotation.from_quat(run["orientation"].values[i], scalar_first=True)
    lines = outline(scene, turned.as_quat(scalar_first=True), "xz")
    return [Polygon(points * per("um") + place) for points in lines]


def _draw_path(axes: Axes, run: xr.Dataset, path: _Path) -> None:
    """Draw the path as distance from the axis against z, with colours that follow the time."""
    scene = scene_of(run)
    lateral, z, direction, limits = path
    radius = scene.body.size * per("um")
    reach = float(np.abs(limits).max())
    draw_cones(axes, scene, reach, direction, **style.CONE)
    draw_walls(axes, scene, reach)
    time = _milliseconds(run)
    points = np.column_stack([lateral, z])
    travelled = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    curve, thermal = resolved(Run.of(run)), _thermal(run)
    rest = time[-1]
    if curve and not thermal:
        rest = time[np.searchsorted(travelled, _TRAVELLED * travelled[-1])]
    many = run.sizes["time"] > 10_000
    if curve:
        drawn: Any = LineCollection(
            list(np.stack([points[:-1], points[1:]], axis=1)), array=time[:-1],
            lw=0.5 if thermal else 1.6, cmap=_TIMES, zorder=3, rasterized=many, capstyle="round",
        )  # fmt: skip
        axes.add_collection(drawn)
    else:
        drawn = axes.scatter(lateral, z, s=2, c=time, cmap=_TIMES, zorder=3, rasterized=many)
    drawn.set_clim(time[0], rest if rest > time[0] else time[-1])
    axes.figure.colorbar(
        drawn, cax=axes.inset_axes((1.04, 0.0, 0.045, 1.0)), label="time (ms)",
        extend="max" if rest < time[-1] else "neither",
    )  # fmt: skip
    if curve and not thermal:
        _draw_direction(axes, points, travelled, 0.02 * reach)
    for i, filled in ((0, False), (-1, True)):
        for shape in _outlines(run, i, (lateral[i], z[i]), direction):
            shape.set(
                facecolor=style.BEAD if filled else "none", edgecolor=style.PATH,
                alpha=0.35 if filled else 0.9, lw=0.8, zorder=2,
            )  # fmt: skip
            axes.add_patch(shape)
    below = z[len(z) // 2] > z[0]  # the side without the path
    axes.annotate(
        "release", (lateral[0], z[0] - radius if below else z[0] + radius), ha="center",
        va="top" if below else "bottom", xytext=(0, -2 if below else 2),
        textcoords="offset points", fontsize=style.SMALL, color=style.NOTE, zorder=4,
        bbox={"fc": "white", "ec": "none", "pad": 0.5, "alpha": 0.8},
    )  # fmt: skip
    axes.plot(*_foci(scene, direction), "+", color=style.LIGHT, ms=7, mew=1.2, zorder=4)
    axes.set(
        xlim=limits[0], ylim=limits[1], aspect="equal", xlabel="lateral position (µm)",
        ylabel="z along the light (µm)",
    )  # fmt: skip
    axes.set_title("path, to scale" if curve else "samples, to scale")


def _draw_direction(axes: Axes, points: Array, travelled: Array, length: float) -> None:
    """Draw arrows along a path, at a third and at two thirds of its length.

    `points` (n, 2) are positions, µm, and `travelled` (n,) the path lengths up to them, µm. An
    arrow has this `length`, µm.
    """
    for part in (1 / 3, 2 / 3):
        tip = part * travelled[-1]
        if tip <= length:
            continue
        behind, ahead = (
            (np.interp(at, travelled, points[:, 0]), np.interp(at, travelled, points[:, 1]))
            for at in (tip - length, tip)
        )
        axes.annotate(
            "", ahead, behind, zorder=4,
            arrowprops={"arrowstyle": "-|>", "color": style.INK, "lw": 0.8, "mutation_scale": 8},
        )  # fmt: skip


def _draw_position(axes: Axes, run: xr.Dataset) -> None:
    """Draw the coordinates over time."""
    for below, (axis, mark) in enumerate(style.AXES.items()):
        values = run["position"].sel(axis=axis) * per("um")
        axes.plot(_milliseconds(run), values, label=axis, zorder=3 - below / 4, **_look(run, mark))
    axes.axhline(0, color=style.MUTED, lw=0.6)
    _draw_contact(axes, scene_of(run))
    _mark_closest_approach(axes, run)
    axes.set_ylabel("position (µm)")
    style.widen(style.legend_above(axes, 3, markerscale=3))


def _draw_contact(axes: Axes, scene: Scene) -> None:
    """Draw the height at which the bead touches a wall, if it is close to the range of the axes."""
    low, high = axes.get_ylim()
    for plane, normal in planes(scene):
        touching = plane + normal * scene.body.support(normal) * per("um")
        if abs(touching - (low + high) / 2) < high - low:
            axes.axhline(touching, color=style.MUTED, lw=0.8, ls="--", zorder=2)
            axes.annotate(
                "z where the bead touches the wall", (1, touching),
                xycoords=("axes fraction", "data"), xytext=(-3, 3), textcoords="offset points",
                ha="right", fontsize=style.SMALL, color=style.NOTE,
            )  # fmt: skip


def _draw_records(axes: dict[str, Axes], run: xr.Dataset) -> None:
    """Draw each coordinate, and the distance to the equilibrium or the focus, over time.

    Each has its histogram beside it.
    """
    scene = scene_of(run)
    position = run["position"].transpose("time", "axis").values * per("um")
    records = {axis: position[:, i] for i, axis in enumerate("xyz")}
    at_rest = not any(beam.motion for beam in scene.beams)
    held = bound_once(scene).equilibrium if scene.lit and at_rest else None
    centre = held.position if held else np.zeros(3)
    records["distance"] = np.linalg.norm(position - np.multiply(centre, per("um")), axis=1)
    for name, values in records.items():
        mark = style.AXES.get(name, style.SPEED)
        record, histogram = axes[name], axes[f"{name} histogram"]
        record.plot(_milliseconds(run), values, **_look(run, mark))
        record.set(xlim=_milliseconds(run)[[0, -1]], ylim=_settled(values))
        if name == "z":
            _draw_contact(record, scene)
        histogram.sharey(record)
        histogram.hist(
            values, _BINS, range=record.get_ylim(), orientation="horizontal", color=mark.colour,
            alpha=0.7,
        )  # fmt: skip
        histogram.tick_params(labelleft=False, bottom=False, labelbottom=False)
        record.set_ylabel(f"{name} (µm)")
        if name != "distance":
            record.sharex(axes["distance"])
            record.tick_params(labelbottom=False)
    axes["distance"].set(xlabel="time (ms)", ylim=(0, None))
    axes["distance"].set_title(f"distance to the {'equilibrium' if held else 'focus'}")
    axes["distance histogram"].set_xlabel("samples")


def _settled(values: Array) -> tuple[float, float]:
    """Return the range of a record to show: that of its second half if the rest goes far beyond."""
    ranges = [
        (float(some.min()), float(some.max())) for some in (values[len(values) // 2 :], values)
    ]
    (low, high), (least, most) = ranges
    if most - least < _BEYOND * (high - low):
        low, high = least, most
    margin = 0.1 * (high - low) or 1e-3
    return low - margin, high + margin


def _draw_speed(axes: Axes, run: xr.Dataset) -> None:
    """Draw actual and terminal speed over time, with the Reynolds number."""
    time = _milliseconds(run)
    look = _look(run, style.SPEED)
    if resolved(Run.of(run)):  # the terminal speed lies on it for most of the way
        look |= {"lw": 2.6, "alpha": 0.45}
    axes.plot(time, run["speed"], label="speed", **look)
    terminal = _look(run, style.TERMINAL)
    axes.plot(time, run["terminal_speed"], label="terminal speed", **terminal)
    _mark_closest_approach(axes, run)
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
        right.set_ylabel("Reynolds number")
    axes.set(xlabel="time (ms)", ylabel="speed (m/s)")
    style.legend_above(axes, 2)


def _mark_closest_approach(axes: Axes, run: xr.Dataset) -> None:
    """Mark the time of the first closest approach by a line, if there is one."""
    time = _closest_approach(run)
    if time is not None:
        axes.axvline(time * per("ms"), color=style.MUTED, lw=0.8, ls=":")


def _closest_approach(run: xr.Dataset) -> float | None:
    """Return the time of the first closest approach, s; None without one and for thermal motion,
    which has many.
    """
    return None if _thermal(run) else summarise(run).closest_approach_time
