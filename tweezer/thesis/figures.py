"""Counterparts of the thesis's Figures 5.1 to 5.15 and C.1 to C.12.

The thesis's model is on the left, the unscaled equations on the right. Motion without noise is
dark, motion with thermal force and torque is light. A ring marks the first closest approach (FCA).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tweezer.plots import style
from tweezer.results.io import scene_of
from tweezer.scene.bead import bead_properties
from tweezer.thesis.fluid_inertia import READINGS, Remembered
from tweezer.thesis.lost_bead import Study
from tweezer.thesis.runs import BEADS, Motions, closest_approach
from tweezer.values.errors import SceneError
from tweezer.values.prefixes import factor, per

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_DARK = {"thesis": style.SERIES[0].colour, "unscaled": style.SERIES[1].colour}
_PALE = {"thesis": "#b6c7e2", "unscaled": "#efc7cd"}
_TERMINAL, _MUTED = style.SERIES[3], style.MUTED

Draw = Callable[["Axes", xr.Dataset, xr.Dataset, str], None]


@style.styled
def figure(number: str, motions: Motions) -> Figure:
    """Draw the counterpart of the thesis's figure `number`, "5.1" to "5.15" or "C.1" to "C.12".

    `motions` must be those of the bead in `FIGURES`. Raises `SceneError` for another bead.
    """
    title, bead, draw, same_scale = FIGURES[number]
    if motions.bead != bead:
        raise SceneError(f"figure {number}: shows the {bead} bead, not {motions.bead}")
    drawn = style.new(style.PAGE, 3.1)
    left, right = drawn.subplots(1, 2, sharey=same_scale, sharex=same_scale)
    for axes, side in ((left, "thesis"), (right, "unscaled")):
        run = getattr(motions, side)
        draw(axes, run, getattr(motions, f"{side}_thermal"), side)
        axes.set_title(_heading(run, side))
        axes.tick_params(labelleft=True)  # tick labels on both sides
    told = f"Figure {number}: {title}, {bead[:-2]} nm bead"
    style.add_title(drawn, told, "pale: with thermal motion; ring: first closest approach")
    return drawn


def _heading(run: xr.Dataset, side: str) -> str:
    """Return the title of a panel: the model, its a2, and the status of an incomplete run.

    `side` is "thesis" or "unscaled".
    """
    status = "" if run.attrs["status"] == "complete" else f", {run.attrs['status']}"
    if side == "thesis":
        return f"the thesis's model, a₂ = {scene_of(run).simulation.scaling_factor:g}{status}"
    return f"unscaled{status}"


def _time(run: xr.Dataset) -> np.ndarray:
    """Return the times of the samples of a run, (n,), ms."""
    return run["time"].values * per("ms")


def _mark(
    axes: Axes,
    x: np.ndarray,
    y: np.ndarray,
    run: xr.Dataset,
    marker: str = "o",
    of: str = "",
) -> None:
    """Mark the first closest approach (FCA) of a run on the curve (x, y), if it has one.

    `x` and `y` (n,) are values at the samples. `marker` is "o" for a ring or "*" for a star, and
    `of` is the end of the label.
    """
    approach = closest_approach(run)
    if approach is not None:
        axes.plot(
            x[approach], y[approach], marker, ms=8 if marker == "o" else 4,
            mfc="none" if marker == "o" else "black", mec="black", mew=1.0, ls="",
            label=f"FCA{of}", zorder=5,
        )  # fmt: skip


def _coordinate(axis: str, name: str) -> Draw:
    """Return a function that draws the coordinate `axis` ("x", "y" or "z") over time.

    `name` is its name on the axis of the figure.
    """

    def draw(axes: Axes, run: xr.Dataset, thermal: xr.Dataset, side: str) -> None:
        """Draw the coordinate over time, without noise (dark) and with it (pale)."""
        noisy = thermal["position"].sel(axis=axis).values * per("um")
        path = run["position"].sel(axis=axis).values * per("um")
        axes.plot(_time(thermal), noisy, color=_PALE[side], lw=0.8)
        axes.plot(_time(run), path, color=_DARK[side], lw=1.3)
        _mark(axes, _time(run), path, run)
        axes.axhline(0, color=_MUTED, lw=0.6)
        axes.set(xlabel="time (ms)", ylabel=f"{name} (µm)")

    return draw


def _reynolds_time(axes: Axes, run: xr.Dataset, thermal: xr.Dataset, side: str) -> None:
    """Draw the Reynolds number over time, without noise (dark) and with it (pale)."""
    axes.plot(_time(thermal)[1:], thermal["reynolds_number"][1:], color=_PALE[side], lw=0.6)
    number = run["reynolds_number"].values
    axes.plot(_time(run)[1:], number[1:], color=_DARK[side], lw=1.3)
    _mark(axes, _time(run), number, run)
    axes.set(xlabel="time (ms)", ylabel="Re (5.1)", yscale="log", ylim=(1e-9, 1e-1))


def _reynolds_speed(axes: Axes, run: xr.Dataset, thermal: xr.Dataset, side: str) -> None:
    """Draw the Reynolds number over the speed, without noise (dark) and with it (pale points)."""
    axes.plot(
        thermal["speed"][1:] * per("mm/s"), thermal["reynolds_number"][1:], ".",
        color=_PALE[side], ms=2,
    )  # fmt: skip
    speed, number = run["speed"].values * per("mm/s"), run["reynolds_number"].values
    axes.plot(speed, number, color=_DARK[side], lw=1.3)
    _mark(axes, speed, number, run)
    axes.set(xlabel="speed (mm/s)", ylabel="Re (5.1)")


def _force_distance(axes: Axes, run: xr.Dataset, thermal: xr.Dataset, side: str) -> None:
    """Draw the net motion force over the distance to the focus, with its sign along N3.

    With noise (pale points) it includes the random force, averaged over a sampling interval.
    """
    random = _with_random_force(thermal)
    inner = thermal["distance"].values[1:]
    axes.plot(inner * per("um"), _signed(random) * per("pN"), ".", color=_PALE[side], ms=1.5)
    force = _signed(run["net_force"].values) * per("pN")
    distance = run["distance"].values * per("um")
    axes.plot(distance, force, color=_DARK[side], lw=1.3)
    _mark(axes, distance, force, run)
    axes.axhline(0, color=_MUTED, lw=0.6)
    axes.set(xlabel="distance to the focus (µm)", ylabel="net motion force, sign of N3 (pN)")


def _signed(force: np.ndarray) -> np.ndarray:
    """Return the magnitudes of vectors (n, 3), with the signs of their z components."""
    length: np.ndarray = np.copysign(np.linalg.norm(force, axis=1), force[:, 2])
    return length


def _with_random_force(thermal: xr.Dataset) -> np.ndarray:
    """Return the mean of all forces except drag over each sampling interval, (n - 1, 3), N.

    It follows from a thermal run by Newton's law as (m dv + beta dr)/h. Here dv and dr are the
    changes of velocity and position in the interval h, beta is the drag, and m is the mass (m/a2 in
    the scaled model).
    """
    scene = scene_of(thermal)
    bead = bead_properties(scene)
    mass = bead.mass
    if thermal.attrs["model"] == "scaled":
        mass /= scene.simulation.scaling_factor or 1.0
    step = np.diff(thermal["time"].values)[:, None]
    kick = mass * np.diff(thermal["velocity"].values, axis=0)
    force: np.ndarray = (kick + bead.drag * np.diff(thermal["position"].values, axis=0)) / step
    return force


def _speeds(axes: Axes, run: xr.Dataset, thermal: xr.Dataset, side: str) -> None:
    """Draw the actual and the terminal speed over time, and the actual one with noise (pale)."""
    axes.plot(_time(thermal)[1:], thermal["speed"][1:] * per("mm/s"), color=_PALE[side], lw=0.6)
    actual = run["speed"].values * per("mm/s")
    terminal = run["terminal_speed"].values * per("mm/s")
    axes.plot(_time(run)[1:], actual[1:], color=_DARK[side], lw=2.6, alpha=0.45, label="actual")
    axes.plot(_time(run), terminal, lw=1.0, label="terminal (5.2)", **_TERMINAL.curve)
    _mark(axes, _time(run), actual, run, of=", actual")
    _mark(axes, _time(run), terminal, run, "*", of=", terminal")
    top = max(actual.max(), terminal.max())
    axes.set(xlabel="time (ms)", ylabel="speed (mm/s)", yscale="log", ylim=(1e-5 * top, 3 * top))
    style.headroom(axes, 0.3)
    axes.legend(ncols=2, loc="upper center")


def _energy(axes: Axes, run: xr.Dataset, thermal: xr.Dataset, side: str) -> None:
    """Draw the change of the total energy over time, without noise (dark) and with it (pale)."""
    for of, colour, width in ((thermal, _PALE, 0.6), (run, _DARK, 1.5)):
        energy = of["total_energy"].values * per("zJ")
        axes.plot(_time(of), energy - energy[0], color=colour[side], lw=width)
    energy = (run["total_energy"].values - run["total_energy"].values[0]) * per("zJ")
    _mark(axes, _time(run), energy, run)
    axes.set(xlabel="time (ms)", ylabel="change of total energy (zJ)")


def _planar(axes: Axes, run: xr.Dataset, thermal: xr.Dataset, side: str) -> None:
    """Draw the path in the plane of the camera, q2 over q1, without noise (dark) and with it
    (pale).
    """
    for of, colour, width in ((thermal, _PALE, 0.8), (run, _DARK, 1.5)):
        q1, q2, _ = of["position"].values.T * per("um")
        axes.plot(q1, q2, color=colour[side], lw=width)
    q1, q2, _ = run["position"].values.T * per("um")
    _mark(axes, q1, q2, run)
    axes.plot(0, 0, "+", color=style.LIGHT, ms=7)
    axes.set(xlabel="q1 (µm)", ylabel="q2 (µm)")
    axes.locator_params(axis="x", nbins=6)  # more labels, with three decimals, would overlap


def _orientation(axes: Axes, run: xr.Dataset, thermal: xr.Dataset, _side: str) -> None:
    """Draw the four Euler parameters over time, pale with noise."""
    for i, mark in enumerate(style.SERIES[:4]):
        noisy = thermal["orientation"][:, i]
        axes.plot(_time(thermal), noisy, color=mark.colour, lw=0.6, alpha=0.4)
        if "orientation" in run:
            values = run["orientation"].values[:, i]
        else:  # it does not rotate
            values = np.full(run.sizes["time"], 1.0 if i == 0 else 0.0)
        axes.plot(_time(run), values, lw=1.3, label=f"e{i}", **mark.curve)
    axes.set(xlabel="time (ms)", ylabel="Euler parameters", ylim=(-1.05, 1.4))
    axes.legend(ncols=4, loc="upper center")


_KINDS: tuple[tuple[str, int, str, Draw, bool], ...] = (
    # chapter, first number, title, function that draws, whether both sides have the same scale
    ("5", 1, "q2 against time", _coordinate("y", "q2"), True),
    ("5", 4, "Reynolds number against time", _reynolds_time, True),
    ("5", 7, "Reynolds number against speed", _reynolds_speed, False),
    ("5", 10, "net motion force against distance", _force_distance, False),
    ("5", 13, "terminal and actual speed", _speeds, True),
    ("C", 1, "change of the total energy", _energy, False),
    ("C", 4, "motion in the plane of the camera", _planar, True),
    ("C", 7, "orientation", _orientation, True),
    ("C", 10, "N3 against time, from the focus", _coordinate("z", "q3"), True),
)

#: Figures by number: title, bead, function that draws, whether both sides have the same axes
FIGURES: dict[str, tuple[str, str, Draw, bool]] = {
    f"{chapter}.{first + i}": (title, bead, draw, same_scale)
    for chapter, first, title, draw, same_scale in _KINDS
    for i, bead in enumerate(BEADS)
}


_THEORY_LINES = {"rays": style.SERIES[1], "waves": style.SERIES[0]}


@style.styled
def captures_figure(of_each_theory: Iterable[Mapping[str, Motions]]) -> Figure:
    """Draw q2 and q3 of the three unscaled beads over time, with ray optics and wave optics.

    The runs are without noise. `of_each_theory` has the motions by bead (`BEADS`) for each theory.
    """
    drawn = style.new(style.PAGE, 4.6)
    panels = drawn.subplots(2, len(BEADS), sharex="col")
    by_theory = list(of_each_theory)
    for bead, (above, below) in zip(BEADS, panels.T, strict=True):
        for motions in (by_bead[bead] for by_bead in by_theory):
            run = motions.unscaled
            mark = _THEORY_LINES[motions.theory]
            for axes, axis in ((above, "y"), (below, "z")):
                path = run["position"].sel(axis=axis).values * per("um")
                name = {"rays": "ray optics", "waves": "wave optics"}[motions.theory]
                axes.plot(_time(run), path, label=name, **mark.curve)
        for axes in (above, below):
            axes.axhline(0, color=_MUTED, lw=0.6)
        slowest = max(by_bead[bead].summary("unscaled").outcome_time for by_bead in by_theory)
        above.set(title=f"{bead[:-2]} nm", ylabel="q2 (µm)", xlim=(0, 1.3 * slowest * per("ms")))
        below.set(xlabel="time (ms)", ylabel="q3, from the focus (µm)")
    panels[0, 0].legend()
    style.add_title(drawn, "Unscaled beads in the light of the thesis: ray optics and wave optics")
    return drawn


_READING_LINES = dict(zip(READINGS, ("-", "--", ":"), strict=True))


@style.styled
def memory_figure(by_bead: Mapping[str, Motions], found: Iterable[Remembered]) -> Figure:
    """Draw the effect of fluid inertia on the three beads, with ray optics.

    The upper panels show |q2| of the unscaled bead without and with fluid inertia, the lower ones
    q2 with the printed a2 for each of `READINGS`. `by_bead` has the motions with ray optics, and
    `found` the comparisons, of which only those with ray optics are drawn.
    """
    of_rays = {each.bead: each for each in found if each.theory == "rays"}
    drawn = style.new(style.PAGE, 4.6)
    panels = drawn.subplots(2, len(BEADS))
    for bead, (above, below) in zip(BEADS, panels.T, strict=True):
        motions, each = by_bead[bead], of_rays[bead]
        for run, mark, name in (
            (motions.unscaled, style.SERIES[1], "without fluid inertia"),
            (motions.remembering, style.SERIES[0], "with fluid inertia"),
        ):
            away = np.abs(run["position"].sel(axis="y").values) / factor("nm")
            above.plot(_time(run), away, label=name, **mark.curve)
        ends = each.within[1] * per("ms")
        above.set(
            title=f"{bead[:-2]} nm", ylabel="|q2| (nm)", yscale="log", ylim=(1e-2, 3e3),
            xlim=(0.8 * ends, 1.35 * ends),
        )  # fmt: skip
        for scaled in each.scaled:
            below.plot(
                scaled.time * per("ms"), scaled.q2 * per("um"), color=_DARK["thesis"], lw=1.3,
                ls=_READING_LINES[scaled.reading], label=scaled.outcome,
            )  # fmt: skip
        below.axhline(0, color=_MUTED, lw=0.6)
        below.set(
            xlabel="time (ms)", ylabel="q2 (µm), printed a₂", ylim=(-0.45, 0.3),
            xlim=(0.9 * ends, 2.1 * ends),
        )  # fmt: skip
        below.legend(loc="lower right")
    readings = [
        Line2D([], [], color=_DARK["thesis"], lw=1.3, ls=line, label=reading)
        for reading, line in _READING_LINES.items()
    ]
    style.legend_below(drawn, 3, handles=[*panels[0, 0].get_lines(), *readings])
    style.add_title(
        drawn, "Fluid inertia: the unscaled beads (above), and three readings of the scaling"
    )
    return drawn


#: Titles of the panels of the study
_PANELS = {"a2": "other a₂", "power": "other power", "other": "other changes"}


@style.styled
def study_figure(study: Study) -> Figure:
    """Draw the fate of the 500 nm bead for single changes, and its overshoot by a2 and power."""
    drawn = style.new(style.PAGE, 8.6)
    axes = drawn.subplot_mosaic([["a2", "power"], ["other", "map"]])
    panels = {
        "a2": ("printed", "a2"),
        "power": ("printed", "power"),
        "other": ("printed", "force", "polarisation", "lens", "start"),
    }
    for panel, groups in panels.items():
        shown = [variant for variant in study.variants if variant.group in groups]
        for variant, mark in zip(shown, itertools.cycle(style.SERIES[:3] + style.SERIES[4:])):
            first = variant.group == "printed"
            axes[panel].plot(
                variant.time * per("ms"), variant.q2 * per("um"),
                color="black" if first else mark.colour, lw=1.6 if first else 0.9,
                marker="" if first else mark.marker, ms=3, markevery=max(len(variant.time) // 9, 1),
                ls="-" if variant.as_claimed or first else "--",
                label=f"{variant.name}: {variant.outcome}",
            )  # fmt: skip
        axes[panel].set(xlabel="time (ms)", ylabel="q2 (µm)")
        axes[panel].set_title(_PANELS[panel])
        axes[panel].legend(loc="upper center", bbox_to_anchor=(0.5, -0.17))
    _draw_capture(axes["map"], study)
    low, high = study.kept_interval
    style.add_title(
        drawn,
        "500 nm bead in the scaled model of the thesis; solid: trapped and ringing, or as printed",
        f"Thermal motion, values as printed: {study.kept} of {study.released} beads stay "
        f"(95 % confidence: {100 * low:.0f} % to {100 * high:.0f} %)",
    )
    return drawn


def _draw_capture(axes: Axes, study: Study) -> None:
    """Draw the overshoot by a2 and power, with a cross for a bead that does not end in the trap."""
    columns, rows = np.arange(len(study.factors)), np.arange(len(study.powers))
    image = axes.pcolormesh(
        columns, rows, np.where(study.captured, study.overshoot, np.nan) * per("um"),
        cmap=style.VALUES,
    )  # fmt: skip
    axes.figure.colorbar(image, ax=axes, label="overshoot of q2 (µm)")
    lost_rows, lost_columns = np.nonzero(~study.captured)
    axes.plot(lost_columns, lost_rows, "x", color=style.LIGHT, ms=5)
    axes.set_xticks(columns, [f"{factor:g}" for factor in study.factors], rotation=45)
    axes.set_yticks(rows, [f"{power:g}" for power in study.powers])
    axes.set(xlabel="a₂", ylabel="power before the pupil (mW)")
    axes.set_title("x: not captured; printed: 3e-05, 156 mW")
