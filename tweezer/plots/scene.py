"""Parts of figures that runs and traps share: cones of light, walls and caveats."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import Polygon

from tweezer.optics import cone_caveat, drawn_cones, ray_optics_caveat
from tweezer.plots import style
from tweezer.scene import Scene
from tweezer.scene.heading import changes
from tweezer.scene.interference import bounds
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def title_of(scene: Scene, title: str = "") -> str:
    """Return the title of a figure: the result's own title if it has one, or the scene's.

    The title of a changed scene is its name; `change_note` has the changes.
    """
    if title and title != scene.title:
        return title
    return f"{scene.name} with changes" if scene.changed else scene.title


def change_note(scene: Scene) -> str:
    """Return a note with every change to the scene; "" without changes."""
    return f"Changed: {changes(scene)}." if scene.changed else ""


def caveat_note(scene: Scene, *, cones: bool = True) -> str:
    """Return the caveat of ray optics, or of the cones if they are drawn; "" without one.

    No scene has both, because a cover glass excludes ray optics.
    """
    caveat = ray_optics_caveat(scene) or (cone_caveat(scene) if cones else None)
    return caveat[0].upper() + caveat[1:] + "." if caveat else ""


def planes(scene: Scene) -> list[tuple[float, float]]:
    """Return the position z, um, and normal of each wall and mirror.

    The normal is the direction along z from the plane to the bead, 1 or -1.
    """
    return [(per("um") * z, normal) for z, normal in bounds(scene).items()]


def draw_walls(axes: Axes, scene: Scene, reach: float) -> None:
    """Draw walls up to a height `reach`, um, and lines at which the bead's centre stops."""
    for plane, normal in planes(scene):
        if abs(plane) < reach:
            axes.axhspan(plane, -normal * reach, **style.SOLID)
            touching = plane + normal * scene.body.support(normal) * per("um")
            axes.axhline(touching, color=style.MUTED, lw=0.8, ls="--", zorder=2)


def draw_cones(axes: Axes, scene: Scene, reach: float, direction: np.ndarray, **how: Any) -> None:
    """Draw the cones of light on both sides of each focus, beyond the figure's edges.

    Moving beams are drawn at their rest position.

    Parameters
    ----------
    axes : Axes
        Axes to draw in.
    scene : Scene
        Scene with the beams.
    reach : float
        Half the height of the figure, um.
    direction : ndarray, shape (2,)
        Unit vector in the plane of x and y along the figure's horizontal axis.
    **how
        Style of the cones.
    """
    length = 3 * reach
    for cone in drawn_cones(scene):
        slope = math.tan(cone.half_angle)
        focus = np.array(cone.beam.position) + cone.offset
        x, z = per("um") * focus[:2] @ direction, per("um") * focus[2]
        for side in (-1, 1):
            end = z + side * length
            triangle = [(x, z), (x - slope * length, end), (x + slope * length, end)]
            axes.add_patch(Polygon(triangle, **how))
