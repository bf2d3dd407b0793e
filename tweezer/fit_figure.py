"""The figure of a fit of a scene: the profile likelihood of each key."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from tweezer.analysis import SceneFit
from tweezer.analysis.profile import LEVEL
from tweezer.units import usual_unit

_LINE, _SHADE = "#004488", "#ddaa33"


def fit_figure(found: SceneFit) -> Figure:
    """The least misfit over the other keys against each key; shaded: 95 % confidence."""
    figure = Figure(figsize=(4.2 * len(found.keys), 3.6), layout="constrained")
    panels = figure.subplots(1, len(found.keys), squeeze=False)[0]
    for panel, each in zip(panels, found.keys, strict=True):
        factor, unit = usual_unit(each.value, each.unit)
        values, misfit = np.array(each.profile).T
        near = np.isfinite(misfit)
        if near.sum() > 3:  # its root is nearly straight on both sides
            side = np.where(values[near] < each.value, -1.0, 1.0)
            root = PchipInterpolator(values[near], side * np.sqrt(np.maximum(misfit[near], 0.0)))
            along = np.linspace(values[near][0], values[near][-1], 200)
            panel.plot(along / factor, root(along) ** 2, lw=1.2, color=_LINE)
        panel.plot(values[near] / factor, misfit[near], "o", ms=4, color=_LINE)
        panel.axhline(LEVEL, color="0.4", lw=0.8, ls="--")
        ends = [
            outermost if end is None else end
            for end, outermost in zip(each.interval, (values[0], values[-1]), strict=True)
        ]
        panel.axvspan(*(end / factor for end in ends), color=_SHADE, alpha=0.25, lw=0)
        panel.set(xlabel=f"{each.key} ({unit})" if unit else each.key, ylim=(-0.3, 3 * LEVEL))
        if not each.determined:
            panel.set_title("not determined", fontsize=9)
    panels[0].set_ylabel("misfit above the least")
    figure.suptitle(found.statement, fontsize=9, wrap=True)
    return figure
