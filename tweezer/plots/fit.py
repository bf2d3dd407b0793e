"""Figure of a fit of a scene: the profile likelihood of each key."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from tweezer.plots import style
from tweezer.tracking.profile import LEVEL
from tweezer.values.prefixes import usual_unit

if TYPE_CHECKING:
    from tweezer.tracking import SceneFit


@style.styled
def fit_figure(found: SceneFit) -> Figure:
    """Draw the misfit, -2 log(likelihood), over each key, minimised over the other keys.

    The 95 % confidence intervals are shaded.

    Parameters
    ----------
    found : SceneFit
        Result of `tweezer.fit`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    columns = min(len(found.keys), 3)
    rows = math.ceil(len(found.keys) / columns)
    figure = style.new(style.COLUMN if columns == 1 else style.PAGE, 0.4 + 2.3 * rows)
    panels = figure.subplots(rows, columns, squeeze=False)
    for panel in panels.flat[len(found.keys) :]:
        panel.remove()
    for panel, each in zip(panels.flat, found.keys, strict=False):
        factor, unit = usual_unit(each.value, each.unit)
        values, misfit = np.array(each.profile).T
        near = np.isfinite(misfit)
        if near.sum() > 3:  # the square root of the misfit is nearly straight on both sides
            side = np.where(values[near] < each.value, -1.0, 1.0)
            root = PchipInterpolator(values[near], side * np.sqrt(np.maximum(misfit[near], 0.0)))
            along = np.linspace(values[near][0], values[near][-1], 200)
            panel.plot(along / factor, root(along) ** 2, color=style.PATH)
        panel.plot(values[near] / factor, misfit[near], **style.SERIES[0].points)
        panel.axhline(LEVEL, color=style.MUTED, lw=0.8, ls="--")
        ends = [
            outermost if end is None else end
            for end, outermost in zip(each.interval, (values[0], values[-1]), strict=True)
        ]
        panel.axvspan(*(end / factor for end in ends), color=style.SHADE, lw=0, zorder=0)
        panel.set(xlabel=f"{each.key} ({unit})" if unit else each.key, ylim=(-0.3, 3 * LEVEL))
        if not each.determined:
            panel.set_title("not determined")
    if len(found.keys) > 1:
        style.add_letters(panels.flat[: len(found.keys)])
    for panel in panels[:, 0]:
        panel.set_ylabel("misfit above the minimum")
    style.add_title(figure, found.statement)
    return figure
