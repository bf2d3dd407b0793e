"""Figures of runs and traps. Each function returns a Figure and changes no global state."""

from __future__ import annotations

import dataclasses
import math
import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Circle, Polygon
from matplotlib.ticker import LogLocator, NullFormatter
from scipy.constants import Boltzmann

from tweezer import analysis
from tweezer.analysis.resolved import resolved
from tweezer.dynamics import bound_once
from tweezer.io import scene_of
from tweezer.optics import cone, ray_optics_caveat
from tweezer.rounding import with_uncertainty
from tweezer.run import Run
from tweezer.scene import Scene

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from tweezer.analysis import (
        Calibration,
        DepthFit,
        Escape,
        Finding,
        Recording,
        Track,
        Trap,
        Tuning,
    )

_MICRO, _MILLI, _PICO, _NANO = 1e6, 1e3, 1e12, 1e9
_COLOURS = {"x": "#4477aa", "y": "#ee6677", "z": "#228833"}
_LIGHT, _PATH, _MUTED = "#cc3311", "#332288", "#777777"
#: Style of what is solid
_SOLID: dict[str, Any] = {"fc": "#dddddd", "ec": "#aaaaaa", "hatch": "///", "lw": 0, "zorder": 0}
#: Force below which no field lines are drawn, as a part of the largest
_NO_LINES = 1e-3


def _add_title(figure: Figure | SubFigure, text: str, **style: Any) -> None:
    """Title above all panels; `text` is literal, as a dollar sign in a name is no formula."""
    figure.suptitle(text, parse_math=False, **style)


def _add_caveat(figure: Figure, scene: Scene) -> None:
    """The caveat of ray optics, below all panels."""
    if caveat := ray_optics_caveat(scene):
        lines = textwrap.fill(caveat[0].upper() + caveat[1:] + ".", 170)
        figure.text(0.5, 0.008, lines, ha="center", va="bottom", fontsize=7, color=_MUTED)


def run_figure(run: xr.Dataset) -> Figure:
    """The path in the plane of the beam's axis, coordinates and speeds over time.

    With thermal motion the distance to the focus takes the place of the speeds, which have no
    meaning between samples. Samples too far apart to show the motion are drawn as points.
    """
    figure = Figure(figsize=(11.0, 6.0))
    axes = figure.subplot_mosaic(
        [["path", "position"], ["path", "below"]],
        width_ratios=(1, 1.2),
        gridspec_kw={
            "left": 0.075, "right": 0.93, "bottom": 0.14, "top": 0.88,
            "wspace": 0.22, "hspace": 0.09,
        },
    )  # fmt: skip
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
    how = [model, run.attrs["method"], run.attrs["message"]]  # a message if it ended early
    title = textwrap.fill(run.attrs["title"], 100)
    _add_title(figure, f"{title}\n{' · '.join(filter(None, how))}", fontsize=11)
    _add_caveat(figure, scene_of(run))
    return figure


def _milliseconds(run: xr.Dataset) -> np.ndarray:
    return run["time"].values * _MILLI


def _thermal(run: xr.Dataset) -> bool:
    return scene_of(run).forces.brownian


def _style(run: xr.Dataset, width: float) -> dict[str, Any]:
    """Style of a curve of that width through samples, or of points if they do not form a curve."""
    if not resolved(Run.of(run)):
        return {"ls": "", "marker": ".", "ms": 3}
    return {"lw": 0.6 * width if _thermal(run) else width}


def _draw_path(axes: Axes, run: xr.Dataset) -> None:
    """Distance from the axis, signed by the side of the start, against z; bead to scale."""
    scene = scene_of(run)
    position = run["position"].values * _MICRO
    start = position[0, :2]
    direction = start / np.linalg.norm(start) if start.any() else np.array([1.0, 0.0])
    lateral, z = position[:, :2] @ direction, position[:, 2]
    radius = scene.bead.radius * _MICRO
    foci = _MICRO * np.array([beam.position for beam in scene.beams])
    across = np.abs(np.append(lateral, foci[:, :2] @ direction)).max()
    along = np.abs(np.append(z, foci[:, 2])).max()
    reach = 1.15 * max(across + radius, along + radius, 3 * radius)
    near = [plane for plane, _ in _planes(scene) if abs(plane) < 1.5 * reach]
    reach = max(reach, *(1.15 * abs(plane) for plane in near), 0.0)
    _draw_cones(axes, scene, reach, direction, color=_LIGHT, alpha=0.07, lw=0, zorder=0)
    axes.plot(lateral, z, color=_PATH, zorder=3, **_style(run, 1.6))
    for i, filled in ((0, False), (-1, True)):
        axes.add_patch(
            Circle((lateral[i], z[i]), radius, facecolor=_PATH if filled else "none",
                   edgecolor=_PATH, alpha=0.35 if filled else 0.9, lw=1.0, zorder=2)
        )  # fmt: skip
    _draw_walls(axes, scene, reach)
    below = z[len(z) // 2] > z[0]  # the side without the path
    axes.annotate(
        "start", (lateral[0], z[0] - radius if below else z[0] + radius), ha="center",
        va="top" if below else "bottom", xytext=(0, -2 if below else 2),
        textcoords="offset points", fontsize=8, color=_MUTED,
    )  # fmt: skip
    axes.plot(foci[:, :2] @ direction, foci[:, 2], "+", color=_LIGHT, ms=9, mew=1.4, zorder=4)
    axes.set(
        xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal",
        xlabel="lateral position, towards the start (µm)", ylabel="z along the light (µm)",
    )  # fmt: skip
    shown = "path" if resolved(Run.of(run)) else "samples"
    axes.set_title(f"{shown}, bead and cone of light to scale; + focus", fontsize=9)


def _planes(scene: Scene) -> list[tuple[float, float]]:
    """Of each wall its z, um, and the direction along z from it to the bead."""
    return [(_MICRO * z, normal) for z, normal in (scene.wall.planes if scene.wall else ())]


def _draw_walls(axes: Axes, scene: Scene, reach: float) -> None:
    """What is solid, in a figure with z upwards to `reach`, um; where the bead's centre stops."""
    for plane, normal in _planes(scene):
        if abs(plane) < reach:
            axes.axhspan(plane, -normal * reach, **_SOLID)
            touching = plane + normal * scene.bead.radius * _MICRO
            axes.axhline(touching, color=_MUTED, lw=0.8, ls="--", zorder=2)


def _draw_cones(
    axes: Axes, scene: Scene, reach: float, direction: np.ndarray, **style: Any
) -> None:
    """Cone of light of each beam before and behind its focus, for a figure that shows `reach`.

    direction: (2,) along the figure's horizontal axis. Lengths in um. Moving beams are drawn at
    their position at rest.
    """
    length = 3 * reach
    for beam in scene.beams:
        slope = math.tan(cone(scene.with_one_beam(beam)).half_angle)
        x, z = _MICRO * np.array(beam.position[:2]) @ direction, _MICRO * beam.position[2]
        for side in (-1, 1):
            end = z + side * length
            triangle = [(x, z), (x - slope * length, end), (x + slope * length, end)]
            axes.add_patch(Polygon(triangle, **style))


def _draw_position(axes: Axes, run: xr.Dataset) -> None:
    style = _style(run, 1.5)
    for below, (axis, colour) in enumerate(_COLOURS.items()):
        values = run["position"].sel(axis=axis) * _MICRO
        axes.plot(
            _milliseconds(run), values, color=colour, label=axis, zorder=3 - below / 4, **style
        )
    axes.axhline(0, color=_MUTED, lw=0.6)
    _draw_contact(axes, scene_of(run))
    _mark_closest_approach(axes, run, "")
    axes.set_ylabel("position (µm)")
    axes.legend(frameon=False, ncols=3, fontsize=9)


def _draw_contact(axes: Axes, scene: Scene) -> None:
    """Where z has the bead touch a wall, if that is about where the axes end."""
    low, high = axes.get_ylim()
    for plane, normal in _planes(scene):
        touching = plane + normal * scene.bead.radius * _MICRO
        if abs(touching - (low + high) / 2) < high - low:
            axes.axhline(touching, color=_COLOURS["z"], lw=0.8, ls="--", zorder=2)
            axes.annotate(
                "z where the bead touches the wall", (1, touching),
                xycoords=("axes fraction", "data"), xytext=(-3, 3), textcoords="offset points",
                ha="right", fontsize=7, color=_MUTED,
            )  # fmt: skip


def _draw_distance(axes: Axes, run: xr.Dataset) -> None:
    axes.plot(_milliseconds(run), run["distance"] * _MICRO, color=_PATH, **_style(run, 1.5))
    axes.set(xlabel="time (ms)", ylabel="distance to the focus (µm)")
    axes.set_ylim(bottom=0)


def _draw_speed(axes: Axes, run: xr.Dataset) -> None:
    """Actual and terminal speed (5.2), with the Reynolds number (5.1) on the right."""
    time = _milliseconds(run)
    axes.plot(time, run["speed"], color=_PATH, label="actual", **_style(run, 1.6))
    fast = float(run["speed"].max())
    terminal = {"lw": 1.1, **_style(run, 1.1)}
    if resolved(Run.of(run)):
        terminal["ls"] = "--"
    axes.plot(time, run["terminal_speed"], color=_LIGHT, label="terminal (5.2)", **terminal)
    _mark_closest_approach(axes, run, "first closest\napproach")
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
    time = analysis.summarise(run).closest_approach_time
    if time is None or _thermal(run):  # thermal motion comes close many times
        return
    axes.axvline(time * _MILLI, color=_MUTED, lw=0.8, ls=":")
    axes.annotate(
        label, (time * _MILLI, 1), xycoords=("data", "axes fraction"),
        xytext=(3, -3), textcoords="offset points", va="top", fontsize=7, color=_MUTED,
    )  # fmt: skip


def trap_figure(scene: Scene, trap: Trap) -> Figure:
    """Force along the axis and across it, and the field of force around the trap.

    Forces are the sum of light and weight. Without a stable equilibrium the curves run through the
    focus.
    """
    figure = Figure(figsize=(11.0, 6.0))
    axes = figure.subplot_mosaic(
        [["axial", "field"], ["lateral", "field"]],
        width_ratios=(1, 1.05),
        gridspec_kw={
            "left": 0.09, "right": 0.94, "bottom": 0.14, "top": 0.86,
            "wspace": 0.2, "hspace": 0.38,
        },
    )  # fmt: skip
    _draw_curve(axes["axial"], scene, trap, "z")
    _draw_curve(axes["lateral"], scene, trap, "x")
    _draw_field(axes["field"], scene, trap)
    figure.align_ylabels([axes["axial"], axes["lateral"]])
    power = trap.power_through_pupil * _MILLI
    _add_title(
        figure,
        f"{scene.title}\n{power:.3g} mW through the pupil · light and weight · {trap.evaluator}",
        fontsize=11,
    )
    _add_caveat(figure, scene)
    return figure


def _centre(trap: Trap) -> np.ndarray:
    return np.array(trap.equilibrium.position if trap.equilibrium else (0.0, 0.0, 0.0))


def _reach(scene: Scene, trap: Trap) -> float:
    """Half the width of the figure, m from the origin."""
    r = scene.bead.radius
    shown = np.vstack([_centre(trap), *(beam.position for beam in scene.beams)])
    farthest = max((escape.force_at for escape in trap.escapes), default=0.0)
    return max(3.5 * r, float(np.abs(shown).max()) + max(2 * r, 1.5 * farthest))


def _net_force(scene: Scene, points: np.ndarray) -> np.ndarray:
    """All forces but drag on a bead at `points` (..., 3) m that touches no wall."""
    return bound_once(scene).net_force_apart(points.reshape(-1, 3)).reshape(points.shape)


def _free(scene: Scene, z: np.ndarray) -> np.ndarray:
    """Those of z, m, at which the bead is not in a wall."""
    return z if scene.wall is None else z[scene.room(z) > 0]


def _largest_shown(scene: Scene, trap: Trap, largest: float) -> float:
    """The largest force that a figure shows, pN, of those there are.

    Beside the force of a wall that of the light would not be seen.
    """
    if not scene.forces.dlvo or not trap.escapes:
        return largest
    *_, across, _ = sorted(escape.force for escape in trap.escapes)
    return min(largest, 2 * across * _PICO)


def _draw_curve(axes: Axes, scene: Scene, trap: Trap, axis: str) -> None:
    """One component of the force along its own axis, with slope and escape forces."""
    along = "xyz".index(axis)
    centre, reach = _centre(trap), _reach(scene, trap)
    coordinates = np.linspace(-reach, reach, 601)
    if axis == "z":
        coordinates = _free(scene, coordinates)
        for plane, normal in _planes(scene):
            touching = plane + normal * scene.bead.radius * _MICRO
            axes.axvspan(touching, -normal * 3 * _MICRO * reach, **_SOLID)
    points = np.tile(centre, (coordinates.size, 1))
    points[:, along] = coordinates
    force = _net_force(scene, points)[:, along] * _PICO
    colour = _COLOURS[axis]
    axes.axhline(0, color=_MUTED, lw=0.6)
    axes.axvline(0, color=_LIGHT, lw=0.6, ls=":")
    axes.plot(coordinates * _MICRO, force, color=colour, lw=1.6, zorder=3)
    extent = _largest_shown(scene, trap, np.abs(force).max()) or 1.0
    axes.set(
        xlim=(-reach * _MICRO, reach * _MICRO), ylim=(-1.35 * extent, 1.35 * extent),
        xlabel=f"{axis} (µm)", ylabel=f"$F_{axis}$ (pN)",
    )  # fmt: skip
    axes.set_title("no stable equilibrium; through the focus" if not trap.equilibrium else
                   "along the light" if axis == "z" else "across it, through the equilibrium",
                   fontsize=9)  # fmt: skip
    if trap.equilibrium is None:
        return
    stiffness = trap.equilibrium.stiffness[along][along]
    escapes = [escape for escape in trap.escapes if escape.direction[1] == axis]
    way = 0.8 * min(escape.force_at for escape in escapes) * np.array([-1, 1])
    axes.plot(
        (centre[along] + way) * _MICRO, -stiffness * way * _PICO,
        color=_MUTED, lw=1.1, ls="--", zorder=2, label=f"{stiffness * _MICRO:.3g} pN/µm",
    )  # fmt: skip
    axes.plot(centre[along] * _MICRO, 0, "o", color=_PATH, ms=5, zorder=4)
    for escape in escapes:
        _mark_escape(axes, escape, float(centre[along]), colour)
    axes.legend(frameon=False, fontsize=8, loc="upper right" if axis == "x" else "lower left")


def _mark_escape(axes: Axes, escape: Escape, centre: float, colour: str) -> None:
    side = 1 if escape.direction[0] == "+" else -1
    place = ((centre + side * escape.force_at) * _MICRO, -side * escape.force * _PICO)
    axes.plot(*place, "o", mfc="white", mec=colour, ms=5, zorder=5)
    # on the side away from the trap, unless the axes end there
    outward = side if abs(place[0]) < 0.6 * axes.get_xlim()[1] else -side
    axes.annotate(
        f"{escape.force * _PICO:.3g} pN", place, xytext=(6 * outward, -4 * side),
        textcoords="offset points", ha="left" if outward > 0 else "right",
        va="top" if side > 0 else "bottom", fontsize=8, color=colour,
    )  # fmt: skip


def _draw_field(axes: Axes, scene: Scene, trap: Trap) -> None:
    """Direction and size of the force on a bead by the position of its centre; bead to scale."""
    centre, r = _centre(trap), scene.bead.radius
    x = z = np.linspace(-1, 1, 201) * _reach(scene, trap)
    points = np.zeros((z.size, x.size, 3))
    points[..., 0], points[..., 2] = np.meshgrid(x, z)
    held = z if scene.wall is None else np.clip(z, *_free(scene, z)[[0, -1]])
    points[..., 2] = held[:, None]  # in a wall no force has a meaning
    force = _net_force(scene, points) * _PICO
    size = np.linalg.norm(force, axis=-1)
    if np.ptp(size) > 0:
        most = _largest_shown(scene, trap, size.max())
        shown = axes.pcolormesh(
            x * _MICRO, z * _MICRO, size,
            vmin=0, vmax=most, cmap="Blues", shading="gouraud", zorder=0, rasterized=True,
        )  # fmt: skip
        axes.figure.colorbar(shown, ax=axes, label="force (pN)", fraction=0.046, pad=0.03)
        # unit vectors, or interpolation between samples would follow the larger force
        strong = size[..., None] > _NO_LINES * size.max()
        lines = np.divide(force, size[..., None], out=np.full_like(force, np.nan), where=strong)
        axes.streamplot(
            x * _MICRO, z * _MICRO, lines[..., 0], lines[..., 2],
            density=1.3, color="#444444", linewidth=0.6, arrowsize=0.8, zorder=2,
        )  # fmt: skip
    else:
        axes.text(
            0.5,
            0.5,
            "no force of light",
            transform=axes.transAxes,
            ha="center",
            va="center",
            color=_MUTED,
        )
    reach = _reach(scene, trap) * _MICRO
    if scene.lit:
        style: dict[str, Any] = {"ec": _LIGHT, "fc": "none", "alpha": 0.6, "lw": 0.8, "zorder": 2.7}
        _draw_cones(axes, scene, reach, np.array([1.0, 0.0]), **style)
    for plane, normal in _planes(scene):
        touching = plane + normal * r * _MICRO
        axes.axhspan(touching, -normal * reach, fc="white", lw=0, zorder=2.5)
        axes.axhspan(plane, -normal * reach, **(_SOLID | {"zorder": 2.6}))
    if trap.equilibrium:
        axes.add_patch(
            Circle((centre[0] * _MICRO, centre[2] * _MICRO), r * _MICRO, facecolor="none",
                   edgecolor=_PATH, lw=1.4, zorder=3)
        )  # fmt: skip
    foci = _MICRO * np.array([beam.position for beam in scene.beams])
    axes.plot(foci[:, 0], foci[:, 2], "+", color=_LIGHT, ms=9, mew=1.4, zorder=4)
    axes.set(
        xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal",
        xlabel="x (µm)", ylabel="z along the light (µm)",
    )  # fmt: skip
    axes.set_title("force on the bead centred there; bead and cone to scale; + focus", fontsize=9)


def heights_figure(trap: xr.Dataset) -> Figure:
    """Stiffness, equilibrium, drag and corner frequency over the height of the focus.

    trap: as `tweezer.trap_over_heights` gives it. Crosses on the axis are heights at which nothing
    holds the bead.
    """
    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    panels = figure.subplot_mosaic(
        [["stiffness", "equilibrium"], ["drag", "corner_frequency"]], sharex=True
    )
    height = trap["height"].values * _MICRO
    drawn = {
        "stiffness": (trap["stiffness"] * _MICRO, "stiffness (pN/µm)"),
        "drag": (trap["drag"] / trap["free_drag"], "drag over that far away"),
        "corner_frequency": (trap["corner_frequency"], "corner frequency (Hz)"),
    }
    for name, (values, label) in drawn.items():
        for axis, style in (("x", ".-"), ("y", "--"), ("z", ".-")):
            panels[name].plot(
                height, values.sel(axis=axis), style, color=_COLOURS[axis], lw=1.4, label=axis
            )
        panels[name].set(ylabel=label)
        if name == "drag":  # beyond all bounds at contact
            panels[name].set_yscale("log")
            panels[name].yaxis.set_major_locator(LogLocator(subs=(1, 1.5, 2, 3, 5)))
            panels[name].yaxis.set_major_formatter("{x:g}")
            panels[name].yaxis.set_minor_formatter(NullFormatter())
        panels[name].set_ylim(bottom=0.95 if name == "drag" else 0)
    panels["stiffness"].legend(frameon=False, ncols=3, fontsize=9)
    _draw_equilibria(panels["equilibrium"], trap)
    lost = trap["state"].values != "held"
    for axes in panels.values():
        (crosses,) = axes.plot(
            height[lost], np.zeros(lost.sum()), "x", color=_LIGHT, ms=6, clip_on=False, zorder=5,
            transform=axes.get_xaxis_transform(),
        )  # fmt: skip
        crosses.set_in_layout(False)
    for name in ("drag", "corner_frequency"):
        panels[name].set(xlabel="height of the focus above the wall (µm)")
    name, evaluated = scene_of(trap).name, trap.attrs["force_evaluator"]
    _add_title(figure, f"{name}, over the height of its focus · {evaluated}", fontsize=11)
    _add_caveat(figure, scene_of(trap))
    return figure


def _draw_equilibria(axes: Axes, trap: xr.Dataset) -> None:
    """Where the bead is held, from the focus; below the line it would be in the wall."""
    scene = scene_of(trap)
    normal = scene.wall.normal if scene.wall else 1.0
    height = trap["height"].values * _MICRO
    z = trap["equilibrium"].sel(axis="z").values * _MICRO
    axes.plot(height, z, ".-", color=_COLOURS["z"], lw=1.4, zorder=3)
    axes.axhline(0, color=_LIGHT, lw=0.6, ls=":")
    low, high = axes.get_ylim()
    order = np.argsort(height)
    touching = normal * (scene.bead.radius * _MICRO - height[order])
    axes.plot(height[order], touching, color=_MUTED, lw=1.0, label="bead touches the wall")
    behind = np.minimum(touching, low) if normal > 0 else np.maximum(touching, high)
    axes.fill_between(height[order], touching, behind, **_SOLID)
    axes.set(ylim=(low, high), ylabel="equilibrium, z from the focus (µm)")
    axes.legend(frameon=False, fontsize=9)


def tuning_figure(tuning: Tuning, name: str) -> Figure:
    """Deviation and force calls of the scaled bead as functions of its scaling factor."""
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    off, work = figure.subplots(2, sharex=True)
    factors = [entry.scaling_factor for entry in tuning.entries]
    deviations, errors = (
        np.array([getattr(entry, key) for entry in tuning.entries], np.float64) * _MICRO
        for key in ("deviation", "deviation_error")
    )
    off.errorbar(factors, deviations, errors, fmt="o-", ms=5, lw=1.6, color=_PATH, ecolor=_MUTED)
    off.set(xscale="log", yscale="log", ylabel="off the unscaled bead (µm)")
    off.axvline(tuning.epsilon, color=_MUTED, lw=0.8, ls=":")
    off.annotate(
        "ε", (tuning.epsilon, 0.2), xycoords=("data", "axes fraction"), ha="left", va="top",
        xytext=(3, 0), textcoords="offset points", color=_MUTED,
    )  # fmt: skip
    calls = [entry.force_calls for entry in tuning.entries]
    work.loglog(factors, calls, "o-", ms=5, lw=1.6, color=_PATH, label="scaled")
    work.axhline(
        tuning.unscaled.force_calls, color=_LIGHT, lw=1.1, ls="--", label="unscaled, exponential"
    )
    work.set(xlabel="scaling factor a₂", ylabel="force calls")
    work.legend(frameon=False, fontsize=9)
    _add_title(
        figure,
        f"{name}: {_MILLI * tuning.duration:.4g} ms of the scaled model, by {tuning.method}",
        fontsize=11,
    )
    return figure


def calibration_figure(recording: Recording, calibration: Calibration) -> Figure:
    """Trajectory, density, power spectrum, mean squared displacement and potential, with fits.

    Bars are standard errors. Spectra are averaged over bins of frequency for the figure only; the
    fits are those of `calibration`. A record in volts is drawn in metres, one with a drive without
    the motion that the stage causes.
    """
    figure = Figure(figsize=(13.0, 7.2), layout="constrained")
    draw_calibration(figure, recording, calibration)
    return figure


def draw_calibration(
    figure: Figure | SubFigure, recording: Recording, calibration: Calibration
) -> None:
    """Draw what `calibration_figure` has."""
    recording = analysis.in_metres(recording, calibration)
    axes = figure.subplot_mosaic(
        [["trajectory", "trajectory", "density"], ["spectrum", "displacement", "potential"]]
    )
    _draw_trajectory(axes["trajectory"], recording)
    _draw_density(axes["density"], recording)
    _draw_spectrum(axes["spectrum"], recording, calibration)
    _draw_displacement(axes["displacement"], recording, calibration)
    _draw_potential(axes["potential"], recording, calibration)
    drag = "drag fitted"
    if calibration.drag is not None:
        drag = f"drag {calibration.drag * _NANO:.3g} nN s/m"
    if calibration.wall is not None:
        drag += " far away" if calibration.drag is not None else ""
        drag += f" · {calibration.wall.distance * _MICRO:.4g} µm from a wall"
    _add_title(
        figure,
        f"{calibration.name}\n{calibration.temperature:.5g} K · {drag} · "
        f"{calibration.samples} samples, one every {calibration.step * _MILLI:.3g} ms",
        fontsize=11,
    )


def _draw_trajectory(axes: Axes, recording: Recording) -> None:
    """A long record thinned to as many samples as a figure can show."""
    shown = slice(None, None, -(-len(recording.times) // 6000))
    for axis, positions in zip(recording.axes, recording.positions.T, strict=True):
        about = (positions - positions.mean()) * _NANO
        axes.plot(
            recording.times[shown], about[shown], color=_COLOURS[axis], lw=0.5, alpha=0.8,
            label=axis,
        )  # fmt: skip
    axes.margins(x=0)
    axes.set(xlabel="time (s)", ylabel="from the mean (nm)")
    axes.legend(frameon=False, ncols=3, fontsize=9, loc="upper right")
    axes.set_title("trajectory", fontsize=9)


def _draw_density(axes: Axes, recording: Recording) -> None:
    if len(recording.axes) < 2:
        axes.set_axis_off()
        return
    x, y = ((recording.positions[:, i] - recording.positions[:, i].mean()) * _NANO for i in (0, 1))
    reach = 4 * max(x.std(), y.std()) * np.array([-1, 1])
    _, _, _, shown = axes.hist2d(
        x, y, bins=64, range=[reach, reach], density=True, cmap="Blues", rasterized=True
    )
    axes.figure.colorbar(shown, ax=axes, label="probability density (1/nm²)", fraction=0.046)
    axes.set(
        aspect="equal", xlabel=f"{recording.axes[0]} from the mean (nm)",
        ylabel=f"{recording.axes[1]} (nm)",
    )  # fmt: skip
    axes.set_title("density", fontsize=9)


def _draw_spectrum(axes: Axes, recording: Recording, calibration: Calibration) -> None:
    for found, positions in zip(calibration.axes, recording.positions.T, strict=True):
        frequencies, density = analysis.power_spectrum(positions, recording.step)
        edges = np.geomspace(frequencies[0], frequencies[-1] * (1 + 1e-9), 61)
        bins = np.digitize(frequencies, edges)
        counts = np.bincount(bins)
        kept = counts >= 4
        at, mean = (
            np.bincount(bins, values)[kept] / counts[kept] for values in (frequencies, density)
        )
        colour = _COLOURS[found.axis]
        axes.errorbar(
            at, mean, mean / np.sqrt(counts[kept]), fmt=".", ms=3, lw=0.7, color=colour, alpha=0.6
        )
        drawn = frequencies >= at[0]
        frequencies = frequencies[drawn]
        fitted = frequencies <= found.fit.highest_frequency
        bead, uncertainty = found.fit.bead, found.fit.corner_frequency_uncertainty
        curve = bead.sampled_spectrum(frequencies, recording.step)
        corner = with_uncertainty(bead.corner_frequency, uncertainty, "±")
        axes.plot(
            frequencies[fitted], curve[fitted], color=colour, lw=1.4, zorder=3,
            label=f"{found.axis}: $f_c$ = {corner} Hz{_mark(found.findings)}",
        )  # fmt: skip
        axes.plot(frequencies, curve, color=colour, lw=0.8, ls=":", zorder=3)
        axes.axvline(bead.corner_frequency, ymax=0.08, color=colour, lw=1.0)
        for answer in found.answers:
            axes.axvline(answer.frequency, ymin=0.92, color=colour, lw=1.0)
    axes.set(xscale="log", yscale="log", xlabel="frequency (Hz)", ylabel="density (m²/Hz)")
    _legend_below(axes)
    form = "Lorentzian" if calibration.mass is None else "inertial form"
    if calibration.displaced_mass is not None:
        form = "hydrodynamic form"
    if not all(found.fit.bead.seen_as_it_is for found in calibration.axes):
        form += " as detected"
    axes.set_title(f"power spectrum; {form} with its aliases", fontsize=9)


def _draw_displacement(axes: Axes, recording: Recording, calibration: Calibration) -> None:
    step = recording.step
    for found, positions in zip(calibration.axes, recording.positions.T, strict=True):
        longest = min(len(positions) // 4, 10 * found.fit.bead.relaxation_time / step)
        lags = np.unique(np.geomspace(1, max(longest, 10), 24).astype(int))
        values = analysis.mean_squared_displacement(positions)[lags]
        errors = [
            analysis.standard_error((positions[lag:] - positions[:-lag]) ** 2) for lag in lags
        ]
        colour, estimate = _COLOURS[found.axis], found.by("displacement") or found.estimates[0]
        axes.errorbar(
            lags * step, values * _NANO**2, np.array(errors) * _NANO**2,
            fmt="o", ms=3, lw=0.8, color=colour, alpha=0.7,
        )  # fmt: skip
        bead = dataclasses.replace(found.fit.bead, stiffness=estimate.stiffness)
        times = np.geomspace(lags[0], lags[-1], 200) * step
        axes.plot(
            times, bead.mean_squared_displacement(times) * _NANO**2, color=colour, lw=1.2,
            label=f"{found.axis}: {_stiffness(estimate.stiffness, estimate.uncertainty)}"
            f"{_mark(estimate.findings)}",
        )  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel="lag (s)", ylabel="displacement² (nm²)")
    for along in (axes.xaxis, axes.yaxis):
        low, high = along.get_view_interval()
        if high < 100 * low:  # less than two decades
            along.set_major_locator(LogLocator(subs=(1, 2, 5)))
            along.set_minor_formatter(NullFormatter())
    _legend_below(axes)
    axes.set_title("mean squared displacement", fontsize=9)


def _draw_potential(axes: Axes, recording: Recording, calibration: Calibration) -> None:
    kT = Boltzmann * calibration.temperature
    for found, positions in zip(calibration.axes, recording.positions.T, strict=True):
        well = analysis.potential(positions, calibration.temperature)
        colour = _COLOURS[found.axis]
        label = "too few independent samples"
        if well.stiffness is not None and well.uncertainty is not None and well.minimum is not None:
            estimate = found["potential"]
            label = _stiffness(estimate.stiffness, estimate.uncertainty) + _mark(estimate.findings)
            reach = math.sqrt(2 * 4.5 * kT / well.stiffness) * np.linspace(-1, 1, 101)
            axes.plot(
                (well.minimum - found.centre + reach) * _NANO, well.stiffness * reach**2 / 2 / kT,
                color=colour, lw=1.2,
            )  # fmt: skip
        axes.errorbar(
            (well.coordinates - found.centre) * _NANO, well.energy / kT, well.errors / kT,
            fmt="o", ms=3, lw=0.8, color=colour, alpha=0.7, label=f"{found.axis}: {label}",
        )  # fmt: skip
    axes.set(xlabel="from the mean (nm)", ylabel="potential ($k_B T$)")
    axes.set_ylim(bottom=-0.3)
    _legend_below(axes)
    axes.set_title("potential, from the histogram", fontsize=9)


def _stiffness(k: float, uncertainty: float) -> str:
    return f"k = {with_uncertainty(k * _MICRO, uncertainty * _MICRO, '±')} pN/µm"


def _mark(findings: tuple[Finding, ...]) -> str:
    return ", not trusted" if findings else ""


def _legend_below(axes: Axes) -> None:
    """Legend below the axes, away from the data."""
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.2))


def depth_figure(track: Track, found: DepthFit) -> Figure:
    """Track and fit, whitened residuals, the depth over time, and the misfit over the start."""
    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    panels = figure.subplot_mosaic([["plane", "profile"], ["residuals", "depth"]])
    time = (track.times - found.start_time) * _MILLI
    path = found.path
    plane, residuals = panels["plane"], panels["residuals"]
    for k, axis in enumerate("xy"):
        seen = track.positions[:, k] * _MICRO
        plane.plot(time, seen, ".", ms=3, color=_COLOURS[axis], label=axis)
        plane.plot(time, path.predicted[:, k] * _MICRO, color=_COLOURS[axis], lw=1.0)
        residuals.plot(time, path.residuals[:, k], ".", ms=3, color=_COLOURS[axis])
        out = path.weights[:, k] < 0.5
        for axes, values in ((plane, track.positions * _MICRO), (residuals, path.residuals)):
            axes.plot(time[out], values[out, k], "x", ms=6, color=_LIGHT)
    plane.set(xlabel="time (ms)", ylabel="position (µm)")
    plane.set_title("seen, and as each frame was predicted; crosses: outliers", fontsize=9)
    plane.legend(frameon=False, fontsize=9)
    for level in (-2, 0, 2):
        residuals.axhline(level, color=_MUTED, lw=0.6, ls="-" if level == 0 else ":")
    residuals.set(xlabel="time (ms)", ylabel="whitened residual", ylim=(-6, 6))
    residuals.set_title(f"independent if the model holds: p = {found.p_value:.2g}", fontsize=9)
    panels["depth"].plot(time, path.predicted[:, 2] * _MICRO, color=_COLOURS["z"])
    panels["depth"].set(xlabel="time (ms)", ylabel="z along the light (µm)")
    panels["depth"].set_title("the coordinate not seen, as the filter has it", fontsize=9)
    _draw_profile(panels["profile"], found)
    title = f"{found.name} · {found.scene}\n{found.statement}"
    _add_title(figure, title, fontsize=10, wrap=True)
    return figure


def _draw_profile(axes: Axes, found: DepthFit) -> None:
    from tweezer.analysis.profile import LEVEL

    """Misfit as a function of the start, with interval and minima."""
    z, misfit = np.array(found.profile).T
    axes.plot(z * _MICRO, misfit, color=_PATH, lw=1.2)
    axes.axhline(LEVEL, color=_MUTED, lw=0.8, ls="--")
    for low, high in found.intervals:
        axes.axvspan(low * _MICRO, high * _MICRO, color=_COLOURS["z"], alpha=0.25, lw=0)
    for each in found.minima:
        axes.plot(each.z * _MICRO, each.misfit, "o", ms=5, color=_PATH)
    axes.set_yscale("symlog", linthresh=2 * LEVEL)
    axes.set(xlabel="z of the start (µm)", ylabel="misfit above the least", ylim=(-0.5, None))
    axes.set_title("profile likelihood; shaded: 95 % confidence", fontsize=9)
