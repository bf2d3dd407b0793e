"""Figure of a trap over the height of its focus above a wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from tweezer.plots import style
from tweezer.plots.scene import caveat_note, change_note, title_of
from tweezer.results.io import scene_of
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


@style.styled
def heights_figure(trap: xr.Dataset) -> Figure:
    """Draw stiffness, equilibrium, drag and corner frequency over the height of the focus.

    Crosses on the axis are heights at which nothing holds the bead.

    Parameters
    ----------
    trap : xarray.Dataset
        Result of `tweezer.trap_over_heights`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    figure = style.new(style.PAGE, 4.8)
    panels = figure.subplot_mosaic(
        [["stiffness", "equilibrium"], ["drag", "corner_frequency"]], sharex=True
    )
    height = trap["height"].values * per("um")
    drawn = {
        "stiffness": (trap["stiffness"] * per("pN/um"), "stiffness (pN/µm)"),
        "drag": (trap["drag"] / trap["free_drag"], "drag / drag far from the wall"),
        "corner_frequency": (trap["corner_frequency"], "corner frequency (Hz)"),
    }
    for name, (values, label) in drawn.items():
        for axis, mark in style.AXES.items():
            panels[name].plot(height, values.sel(axis=axis), label=axis, **mark.both)
        panels[name].set(ylabel=label)
        if name == "drag":  # it diverges at contact
            panels[name].set_yscale("log")
            panels[name].yaxis.set_major_locator(LogLocator(subs=(1, 1.5, 2, 3, 5)))
            panels[name].yaxis.set_major_formatter("{x:g}")
            panels[name].yaxis.set_minor_formatter(NullFormatter())
        panels[name].set_ylim(bottom=0.95 if name == "drag" else 0)
    style.legend_above(panels["stiffness"], 3)
    _draw_equilibria(panels["equilibrium"], trap)
    lost = trap["state"].values != "held"
    for axes in panels.values():
        (crosses,) = axes.plot(
            height[lost], np.zeros(lost.sum()), "x", color=style.LIGHT, ms=5, clip_on=False,
            zorder=5, transform=axes.get_xaxis_transform(),
        )  # fmt: skip
        crosses.set_in_layout(False)
    for name in ("drag", "corner_frequency"):
        panels[name].set(xlabel="height of the focus above the wall (µm)")
    scene = scene_of(trap)
    style.add_letters(panels.values())
    style.add_title(figure, f"{title_of(scene)}: trap over the height of its focus")
    notes = [change_note(scene), f"Force by {trap.attrs['force_evaluator']}."]
    if lost.any():
        notes.append("Crosses: nothing holds the bead.")
    style.add_notes(figure, [*notes, caveat_note(scene, cones=False)])
    return figure


def _draw_equilibria(axes: Axes, trap: xr.Dataset) -> None:
    """Draw the equilibrium relative to the focus; in the hatched region the bead would be in the
    wall.
    """
    scene = scene_of(trap)
    normal = scene.wall.normal if scene.wall else 1.0
    height = trap["height"].values * per("um")
    z = trap["equilibrium"].sel(axis="z").values * per("um")
    axes.plot(height, z, zorder=3, **style.AXES["z"].both)
    axes.axhline(0, color=style.LIGHT, lw=0.6, ls=":")
    low, high = axes.get_ylim()
    order = np.argsort(height)
    touching = normal * (scene.body.support(normal) * per("um") - height[order])
    axes.plot(height[order], touching, color=style.MUTED, lw=1.0, label="bead touches the wall")
    behind = np.minimum(touching, low) if normal > 0 else np.maximum(touching, high)
    axes.fill_between(height[order], touching, behind, **style.SOLID)
    axes.set(ylim=(low, high), ylabel="z of the equilibrium (µm)")
    style.legend_above(axes, 1)
