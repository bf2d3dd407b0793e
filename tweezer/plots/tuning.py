"""Figure of a search for the scaling factor: savings in work and loss of accuracy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from tweezer.plots import style
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    from tweezer.runs import Tuning


@style.styled
def tuning_figure(tuning: Tuning, name: str) -> Figure:
    """Draw deviation and force calls of the scaled bead over its scaling factor.

    Parameters
    ----------
    tuning : Tuning
        Result of `tweezer.tune`.
    name : str
        Name of the scene, for the title.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    figure = style.new(style.COLUMN, 3.9)
    off, work = figure.subplots(2, sharex=True)
    factors = [entry.scaling_factor for entry in tuning.entries]
    deviations, errors = (
        np.array([getattr(entry, key) for entry in tuning.entries], np.float64) * per("um")
        for key in ("deviation", "deviation_error")
    )
    scaled, unscaled = style.SERIES[:2]
    off.errorbar(factors, deviations, errors, ecolor=style.MUTED, **scaled.both)
    off.set(xscale="log", yscale="log", ylabel="deviation (µm)")
    off.axvline(tuning.epsilon, color=style.MUTED, lw=0.8, ls=":")
    off.annotate(
        "ε", (tuning.epsilon, 0.2), xycoords=("data", "axes fraction"), ha="left", va="top",
        xytext=(3, 0), textcoords="offset points", color=style.NOTE,
    )  # fmt: skip
    calls = [entry.force_calls for entry in tuning.entries]
    work.loglog(factors, calls, label="scaled", **scaled.both)
    work.axhline(tuning.unscaled.force_calls, label="unscaled, exponential", **unscaled.curve)
    work.set(xlabel="scaling factor a₂", ylabel="force calls")
    style.legend_above(work, 2)
    figure.align_ylabels([off, work])
    style.add_letters([off, work])
    told = f"{per('ms') * tuning.duration:.4g} ms of the scaled model, by {tuning.method}"
    style.add_title(figure, name, told)
    return figure
