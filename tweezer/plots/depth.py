"""Figure of a fit of the bead's initial height z from positions in the plane of the camera."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from tweezer.plots import style
from tweezer.tracking.profile import LEVEL
from tweezer.values.errors import ResultError
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tweezer.reading import Track
    from tweezer.tracking import DepthFit


@style.styled
def depth_figure(track: Track, found: DepthFit) -> Figure:
    """Draw track and fit, whitened residuals, height over time, and misfit over the initial z.

    Parameters
    ----------
    track : Track
        Track that was fitted.
    found : DepthFit
        Result of `tweezer.fit_depth`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    figure = style.new(style.PAGE, 5.0)
    panels = figure.subplot_mosaic([["plane", "profile"], ["residuals", "depth"]])
    time = (track.times - found.start_time) * per("ms")
    path = found.path
    if path is None:
        raise ResultError(
            "DepthFit: was loaded from a file of `tweezer fit-depth --out`, which has no path to "
            "draw; use `tweezer.save` to keep it"
        )
    plane, residuals = panels["plane"], panels["residuals"]
    for k, axis in enumerate("xy"):
        mark = style.AXES[axis]
        seen = track.positions[:, k] * per("um")
        plane.plot(time, seen, ms=2.5, label=axis, **mark.points)
        plane.plot(time, path.predicted[:, k] * per("um"), lw=1.0, **mark.curve)
        residuals.plot(time, path.residuals[:, k], ms=2.5, **mark.points)
        out = path.weights[:, k] < 0.5
        for axes, values in ((plane, track.positions * per("um")), (residuals, path.residuals)):
            axes.plot(time[out], values[out, k], "x", ms=5, color=style.LIGHT)
    plane.set(xlabel="time (ms)", ylabel="position (µm)")
    plane.set_title("recorded and predicted; crosses: outliers")
    plane.legend(loc="best", ncols=2)
    for level in (-2, 0, 2):
        residuals.axhline(level, color=style.MUTED, lw=0.6, ls="-" if level == 0 else ":")
    residuals.set(xlabel="time (ms)", ylabel="whitened residual", ylim=(-6, 6))
    residuals.set_title(f"independent if the model applies: p = {found.p_value:.2g}")
    panels["depth"].plot(time, path.predicted[:, 2] * per("um"), **style.AXES["z"].curve)
    panels["depth"].set(xlabel="time (ms)", ylabel="z along the light (µm)")
    panels["depth"].set_title("z, estimated by the filter")
    _draw_profile(panels["profile"], found)
    style.add_letters(panels.values())
    style.add_title(figure, f"{found.name} · {found.scene}", found.statement)
    return figure


def _draw_profile(axes: Axes, found: DepthFit) -> None:
    """Draw the misfit, -2 log(likelihood), over the initial height.

    Confidence intervals are shaded, and points mark the minima.
    """
    z, misfit = np.array(found.profile).T
    axes.plot(z * per("um"), misfit, color=style.PATH)
    axes.axhline(LEVEL, color=style.MUTED, lw=0.8, ls="--")
    for low, high in found.intervals:
        axes.axvspan(low * per("um"), high * per("um"), color=style.SHADE, lw=0, zorder=0)
    for each in found.minima:
        axes.plot(each.z * per("um"), each.misfit, **style.SERIES[0].points)
    axes.set_yscale("symlog", linthresh=10)  # a power of ten: smaller numbers would overlap
    axes.set(xlabel="z at the release (µm)", ylabel="misfit above the minimum", ylim=(-0.5, None))
    axes.set_title("profile likelihood; shaded: 95 % confidence")
