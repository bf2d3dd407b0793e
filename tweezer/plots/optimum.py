"""Figure of the mask that makes a trap stiffest, and of the force with and without it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from tweezer.optics.at_rest import at_rest
from tweezer.optics.binding import light_force
from tweezer.plots import style
from tweezer.scene import Scene
from tweezer.scene.bead import bead_properties
from tweezer.values.arrays import Array
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    from tweezer.optics.optimised import Optimum

#: Range of the force on both sides, wavelengths in the medium, and places
_RANGE, _PLACES = 0.6, 121


@style.styled
def optimum_figure(best: Optimum, given: Scene) -> Figure:
    """Draw amplitude and phase of a mask, and the force along the axis of its goal.

    Parameters
    ----------
    best : Optimum
        Result of `tweezer.optimise`.
    given : Scene
        Scene without the mask.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    figure = style.new(style.PAGE, 2.9)
    amplitude, phase, force = figure.subplots(1, 3, width_ratios=[1, 1, 1.4])
    field = best.mask if np.iscomplexobj(best.mask) else np.exp(1j * best.mask)
    x = np.linspace(-1, 1, len(field))
    outside = np.hypot(x, x[:, None]) > 1
    shown = {"origin": "lower", "extent": (-1, 1, -1, 1)}
    values = np.ma.masked_array(np.abs(field), outside)
    image = amplitude.imshow(values, cmap="viridis", vmin=0, **shown)
    figure.colorbar(image, ax=amplitude, location="bottom", label="amplitude")
    turns = np.ma.masked_array(np.angle(field), outside)
    image = phase.imshow(turns, cmap="twilight", vmin=-np.pi, vmax=np.pi, **shown)
    figure.colorbar(image, ax=phase, location="bottom", label="phase (rad)")
    for axes in (amplitude, phase):
        axes.set(xticks=[], yticks=[])
    along = best.goal[1] if best.goal != "sum" else "x"
    wavelength = given.beam.wavelength / given.medium.refractive_index
    away = np.linspace(-_RANGE, _RANGE, _PLACES) * wavelength
    rest, series = at_rest(given), style.SERIES
    if rest is not None:
        pull = _force(given, rest.position, along, away)
        force.plot(per("um") * away, per("pN") * pull, label="without", **series[1].curve)
    pull = _force(best.scene, np.zeros(3), along, away)
    force.plot(per("um") * away, per("pN") * pull, label="with the mask", **series[0].curve)
    force.set(xlabel=f"displacement along {along} (µm)", ylabel=f"force along {along} (pN)")
    style.legend_above(force, 2)
    style.add_letters([amplitude, phase, force])
    style.add_title(figure, f"Stiffest trap of {given.name}, for {best.goal}")
    return figure


def _force(scene: Scene, place: Array, along: str, away: Array) -> Array:
    """Return the force of light and weight at displacements from a place along an axis, (n,) N."""
    i = "xyz".index(along)
    field = light_force(scene).field(place + away[:, None] * np.eye(3)[i])
    return np.asarray(field.force[:, i] + bead_properties(scene).weight[i])
