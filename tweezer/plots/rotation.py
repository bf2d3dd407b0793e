"""Figure of the rotation of a body: displacement, autocorrelation and spectrum."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from tweezer.plots import style
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    import xarray as xr


@style.styled
def rotation_figure(rotation: xr.Dataset) -> Figure:
    """Draw angular displacement, autocorrelation and spectrum of a body's axis.

    Bands are standard errors. The displacement is omitted if it was not computed.

    Parameters
    ----------
    rotation : xarray.Dataset
        Result of `tweezer.rotation`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    names = [name for name in ("msad", "p", "psd") if name == "p" or name in rotation]
    figure = style.new(style.PAGE, 2.9)
    panels = dict(zip(names, figure.subplots(1, len(names), squeeze=False)[0], strict=True))
    lag = rotation["lag"].values * per("ms")
    for name, x in (("msad", lag), ("psd", rotation["frequency"].values)):
        if name not in panels:
            continue
        for axis, mark in style.AXES.items():
            value, error = (
                rotation[f"{name}{end}"].sel(axis=axis).values for end in ("", "_error")
            )
            panels[name].loglog(x, value, label=axis, **mark.curve)
            panels[name].fill_between(
                x, value - error, value + error, color=mark.colour, alpha=0.2, lw=0
            )  # fmt: skip
        style.legend_above(panels[name], 3)
    for k, mark in zip((1, 2), style.SERIES, strict=False):
        value, error = rotation[f"p{k}"].values, rotation[f"p{k}_error"].values
        panels["p"].errorbar(lag, value, error, label=f"P$_{k}$", **mark.both)
    panels["p"].axhline(0, color=style.MUTED, lw=0.6)
    panels["p"].set(xscale="log", xlabel="lag (ms)", ylabel="autocorrelation")
    style.legend_above(panels["p"], 2)
    if "msad" in panels:
        panels["msad"].set(xlabel="lag (ms)", ylabel="mean squared angular\ndisplacement (rad²)")
    panels["psd"].set(xlabel="frequency (Hz)", ylabel="PSD of the axis (1/Hz)")
    style.add_letters(panels.values())
    n = ", ".join(f"{each:.3g}" for each in rotation["body_direction"].values)
    style.add_title(figure, "Rotation of a body", f"axis ({n}) in the body's frame")
    return figure
