"""The figure of a free bead: record with drift, displacements, steps, and diffusion by lag."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import LogLocator, NullFormatter

from tweezer.calibration import mean_squared_displacement, standard_error
from tweezer.plots import style
from tweezer.values.prefixes import per
from tweezer.values.rounding import with_uncertainty
from tweezer.values.signs import typeset

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure, SubFigure

    from tweezer.calibration import Calibration
    from tweezer.calibration.free import Diffusion
    from tweezer.reading import Recording
    from tweezer.values.arrays import Array

#: Number of samples of a trajectory that a figure can show
_SHOWN = 6000
#: Largest number of lags, and the longest as a part of the recording
_LAGS, _LONGEST = 20, 1 / 20
#: Number of bins of the steps, and half their range in standard deviations
_BINS, _RANGE = 40, 4.0


def draw_free(
    figure: Figure | SubFigure, recording: Recording, calibration: Calibration, found: Diffusion
) -> None:
    """Draw the record with its drift, mean squared displacement, steps, and diffusion by lag.

    The drift is subtracted from displacements and steps. Curves show the fitted diffusion, and the
    shaded area shows its 95 % confidence interval. A recording in volts is drawn in volts.

    Parameters
    ----------
    figure : Figure or SubFigure
        Figure to draw in.
    recording : Recording
        Recording of the free bead.
    calibration : Calibration
        Calibration of the recording, which contains its name and unit.
    found : Diffusion
        Diffusion fitted to the recording.
    """
    unit = "um" if calibration.unit == "m" else "mV"
    scale, shown = per(unit), typeset(unit)
    records = [f"{axis} over time" for axis in recording.axes]
    rows: list[Any] = [[name, "steps"] for name in records]
    heights = [1 / len(records)] * len(records)
    axes = figure.subplot_mosaic([*rows, ["displacement", "lags"]], height_ratios=[*heights, 1])
    panels = [axes[name] for name in records]
    draw_records(panels, recording, shown, scale)
    rest, drifts = recording.positions.copy(), {each.axis: each.drift for each in found.axes}
    for k, axis in enumerate(recording.axes):
        if axis in drifts:
            drift = drifts[axis] * (recording.times - recording.times.mean())
            panels[k].plot(recording.times, drift * scale, color=style.INK, lw=1.0, ls="--")
            rest[:, k] -= drift
    _draw_steps(axes["steps"], recording, found, rest, shown, scale)
    _draw_lags(axes["displacement"], axes["lags"], recording, found, rest, shown, scale)
    figure.align_ylabels([*panels, axes["displacement"]])
    style.add_letters([panels[0], axes["steps"], axes["displacement"], axes["lags"]])
    style.add_title(figure, f"Diffusion of {calibration.name}")
    note = (
        f"{calibration.samples} samples, one every {calibration.step * per('ms'):.3g} ms. No trap "
        "is detected. Dashed in a: mean drift, which is subtracted in b to d. Lines: the fitted "
        "diffusion D; shaded: its 95 % confidence interval. Bars: standard errors. Motion blur "
        "lowers the points at short lags, and localisation errors raise them. "
        "Long lags contain few independent displacements."
    )
    if any(each.jumps for each in found.axes):
        note += " Jumps of the bead are in the points but not in D."
    style.add_notes(figure, [note])


def _draw_steps(
    axes: Axes, recording: Recording, found: Diffusion, rest: Array, unit: str, scale: float
) -> None:
    """Draw the distribution of the steps along each axis, and the Gaussian of the diffusion.

    rest: (n, axes) positions without the drift. unit, scale: see `draw_records`.
    """
    steps = np.diff(rest, axis=0) * scale
    spread = math.sqrt(2 * found.diffusion * recording.step) * scale
    reach = _RANGE * max(spread, float(steps.std(axis=0).max()))
    for axis, along in zip(recording.axes, steps.T, strict=True):
        look = style.AXES[axis].curve
        axes.hist(
            along, _BINS, range=(-reach, reach), density=True, histtype="step", label=axis, **look
        )
    at = np.linspace(-reach, reach, 201)
    gaussian = np.exp(-(at**2) / (2 * spread**2)) / (spread * math.sqrt(2 * math.pi))
    axes.plot(at, gaussian, color=style.INK, lw=1.4, label="from D")
    axes.set(xlabel=f"step between samples ({unit})", ylabel=f"probability density (1/{unit})")
    style.legend_above(axes, len(recording.axes) + 1)


def _draw_lags(
    axes: Axes, lags_axes: Axes, recording: Recording, found: Diffusion, rest: Array, unit: str,
    scale: float,
) -> None:  # fmt: skip
    """Draw the mean squared displacement and the diffusion coefficient from each lag.

    `axes` and `lags_axes` are the panels of the displacement and of the diffusion, and `rest` (n,
    axes) the positions without drift. `draw_records` describes `unit` and `scale`.
    """
    dimensions = len(recording.axes)
    longest = max(2, int(_LONGEST * len(rest)))
    lags = np.unique(np.geomspace(1, longest, _LAGS).astype(int))
    squared = sum(mean_squared_displacement(along, lags) for along in rest.T)
    errors = np.sqrt(
        [
            sum(standard_error((along[lag:] - along[:-lag]) ** 2) ** 2 for along in rest.T)
            for lag in lags
        ]
    )
    times = lags * recording.step
    per_time = 2 * dimensions * times
    points = style.AXES["x"].points | {"elinewidth": 0.8}
    axes.errorbar(times, squared * scale**2, errors * scale**2, **points)
    axes.plot(
        times, found.diffusion * per_time * scale**2, color=style.INK, label=f"{2 * dimensions} D t"
    )
    ends = np.outer(found.interval, per_time) * scale**2
    axes.fill_between(times, *ends, color=style.SHADE, lw=0, zorder=0)
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="lag t (s)",
        ylabel=f"mean squared displacement ({unit}²)",
    )
    axes.legend(loc="upper left")
    lags_axes.errorbar(times, squared / per_time * scale**2, errors / per_time * scale**2, **points)
    told = with_uncertainty(found.diffusion * scale**2, found.uncertainty * scale**2, "±")
    label = f"D = {told} {unit}²/s" + (", not trusted" if found.findings else "")
    lags_axes.axhline(found.diffusion * scale**2, color=style.INK, label=label)
    lags_axes.axhspan(
        *(end * scale**2 for end in found.interval), color=style.SHADE, lw=0, zorder=0
    )
    lags_axes.set(xscale="log", xlabel="lag t (s)", ylabel=f"diffusion by lag ({unit}²/s)")
    style.legend_above(lags_axes, 1)
    for along in (axes.xaxis, axes.yaxis, lags_axes.xaxis):
        number(along)


def draw_records(panels: list[Axes], recording: Recording, unit: str, scale: float) -> None:
    """Draw the positions along each axis over time, in a panel each, relative to their mean.

    A long recording is thinned to about 6000 samples.

    Parameters
    ----------
    panels : list of Axes
        One panel for each axis of the recording.
    recording : Recording
        Recording to draw.
    unit : str
        Unit of the positions in the figure, typeset.
    scale : float
        Factor from the unit of the recording to `unit`.
    """
    shown = slice(None, None, -(-len(recording.times) // _SHOWN))
    for axes, axis, positions in zip(panels, recording.axes, recording.positions.T, strict=True):
        about = (positions - positions.mean()) * scale
        axes.plot(
            recording.times[shown], about[shown], color=style.AXES[axis].colour, lw=0.4,
            rasterized=True,
        )  # fmt: skip
        axes.margins(x=0)
        axes.set_ylabel(f"{axis} ({unit})")
        if axes is not panels[-1]:
            axes.sharex(panels[-1])
            axes.tick_params(labelbottom=False)
    panels[0].set_title("trajectory")
    panels[-1].set_xlabel("time (s)")


def number(along: Axis) -> None:
    """Write plain numbers at a logarithmic axis that is too short for powers of ten alone."""
    low, high = along.get_view_interval()
    if high < 100 * low:
        short = high < 20 * low
        along.set_major_locator(LogLocator(subs=(1, 2, 5) if short else (1, 3)))
        along.set_major_formatter("{x:g}")
        along.set_minor_formatter(NullFormatter())
