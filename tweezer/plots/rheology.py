"""Figure of microrheology: the moduli of a medium, and the spectra from which they follow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from tweezer.plots import style
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tweezer.microrheology import Rheology


@style.styled
def rheology_figure(rheology: Rheology) -> Figure:
    """Draw storage and loss modulus, and the spectra of the positions with their residuals.

    Parameters
    ----------
    rheology : Rheology
        Result of `tweezer.rheology`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    figure = style.new(style.PAGE, 3.4)
    axes = figure.subplot_mosaic(
        [["moduli", "spectrum"], ["moduli", "residuals"]], height_ratios=(1, 0.4)
    )
    _draw_moduli(axes["moduli"], rheology)
    _draw_spectra(axes["spectrum"], axes["residuals"], rheology)
    style.add_letters(axes.values())
    style.add_title(figure, f"Rheology of {rheology.name}")
    low, high = rheology.band
    n = len(rheology.elements) - 1
    style.add_notes(
        figure,
        [
            f"{rheology.temperature:.5g} K, radius {rheology.radius * per('um'):.4g} µm, solvent "
            f"and {n} Maxwell element{'s' * (n != 1)}, valid from {low:.3g} to {high:.5g} Hz. "
            "Bands: 95 % confidence intervals; bars: standard errors."
        ],
    )
    return figure


def _draw_moduli(axes: Axes, rheology: Rheology) -> None:
    """Draw both moduli with their intervals; a storage modulus of 0 has only its upper limit."""
    f = np.array(rheology.frequencies)
    parts = ((rheology.storage, "storage, $G'$"), (rheology.loss, "loss, $G''$"))
    for (part, label), mark in zip(parts, style.SERIES, strict=False):
        low, high = np.array(part.low), np.array(part.high)
        if any(part.values):
            axes.plot(f, part.values, label=label, **mark.curve)
            axes.fill_between(f, low, high, color=mark.colour, alpha=0.2, lw=0)
        else:
            axes.plot(f, high, label=f"{label}, at most", color=mark.colour, ls=":")
    axes.set(xscale="log", yscale="log", xlabel="frequency (Hz)", ylabel="modulus (Pa)")
    middle = np.array([*rheology.loss.values, *rheology.storage.values])
    middle = middle[middle > 0]
    axes.set_ylim(middle.min() / 5, middle.max() * 3)
    axes.legend(loc="upper left")


def _draw_spectra(axes: Axes, residuals: Axes, rheology: Rheology) -> None:
    """Draw spectra with their fits, and below them data over fit."""
    axes.sharex(residuals)
    for found in rheology.axes:
        mark, shown = style.AXES[found.axis], found.residuals
        f, error = np.array(shown.frequencies), np.array(shown.uncertainties)
        density, ratios = np.array(shown.density), np.array(shown.ratios)
        bars = {"elinewidth": 0.6, "ms": 2.5, "alpha": 0.6, **mark.points}
        axes.errorbar(f, density, density * error, **bars)
        axes.plot(f, shown.fitted, label=found.axis, **mark.curve)
        residuals.errorbar(f, ratios, error, **bars)
    axes.set(xscale="log", yscale="log", ylabel="PSD (m²/Hz)")
    axes.tick_params(labelbottom=False)
    axes.legend(loc="lower left")
    residuals.axhline(1, color=style.INK, lw=0.8)
    residuals.set(xscale="log", xlabel="frequency (Hz)", ylabel="data / fit")
