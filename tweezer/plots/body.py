"""Figure of the trap of a body: its outline in two planes, and force and torque about it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from scipy.spatial.transform import Rotation

from tweezer.optics import light_force
from tweezer.plots import style
from tweezer.plots.scene import change_note, draw_cones, title_of
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tweezer.trap import BodyTrap


@style.styled
def body_trap_figure(scene: Scene, trap: BodyTrap) -> Figure:
    """Draw a trapped body in two planes, the force along the axes, and the torque over its angle.

    Without a stable equilibrium the body is drawn at the focus, as released.

    Parameters
    ----------
    scene : Scene
        Scene of the trap.
    trap : BodyTrap
        Result of `tweezer.characterise`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    held = trap.equilibrium
    position = np.array(held.position if held else (0.0, 0.0, 0.0))
    orientation = np.array(held.orientation if held else scene.start.orientation)
    reach = 2.2 * trap.t_matrix.radius + float(np.abs(position).max())
    figure = style.new(style.PAGE, 4.6)
    axes = figure.subplot_mosaic([["xz", "yz"], ["force", "torque"]], height_ratios=(1.4, 1))
    for name in ("xz", "yz"):
        _draw_body(axes[name], scene, position, orientation, name, reach)
    _draw_force(axes["force"], scene, position, orientation, reach)
    _draw_torque(axes["torque"], scene, position, orientation)
    style.add_letters(list(axes.values()))
    style.add_title(figure, title_of(scene))
    at = "at its stable equilibrium" if held else "as released: no stable equilibrium was found"
    style.add_notes(
        figure,
        [
            change_note(scene),
            f"The body {at}. Force and torque of the light alone. Red lines: edges of the cone of "
            "light.",
        ],
    )
    return figure


def outline(scene: Scene, orientation: Array, plane: str) -> list[Array]:
    """Return the outlines of a body seen along the normal of a plane, (n, 2) m each.

    Parameters
    ----------
    scene : Scene
        Scene of the body.
    orientation : ndarray, shape (4,)
        Euler parameters.
    plane : str
        "xz" or "yz".

    Returns
    -------
    list of ndarray
        One closed line for each sphere, and otherwise one for the convex hull of the body. A body
        in a file or given has no outline; the sphere that encloses it is returned.
    """
    across, along = "xyz".index(plane[0]), "xyz".index(plane[1])
    frame = Rotation.from_quat(orientation, scalar_first=True).as_matrix()
    angle = np.linspace(0, 2 * np.pi, 181)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    bead = scene.bead
    if bead.spheres is not None:
        centres = np.array(bead.centres) @ frame.T
        return [
            centre[[across, along]] + each.radius * circle
            for centre, each in zip(centres, bead.spheres, strict=True)
        ]
    # points that touch planes all around: from the support and its derivative
    angle = np.linspace(0, 2 * np.pi, 1441)
    axis = np.cross(np.eye(3)[across], np.eye(3)[along])
    turned = Rotation.from_rotvec(np.outer(np.pi / 2 - angle, axis)) * Rotation.from_matrix(frame)
    reach = bead.body.support(-1.0, turned.as_quat(scalar_first=True)) * np.ones(angle.size)
    slope = np.gradient(np.concatenate([reach[-2:-1], reach, reach[1:2]]), angle[1])[1:-1]
    normal = np.stack([np.cos(angle), np.sin(angle)])
    points = reach * normal + slope * np.stack([-normal[1], normal[0]])
    return [points.T]


def _draw_body(
    axes: Axes, scene: Scene, position: Array, orientation: Array, plane: str, reach: float
) -> None:
    """Draw the outline of the body and the cone of light in a plane."""
    across, along = "xyz".index(plane[0]), "xyz".index(plane[1])
    width = reach * per("um")
    direction = np.array([1.0, 0.0]) if plane == "xz" else np.array([0.0, 1.0])
    draw_cones(axes, scene, width, direction, ec=style.LIGHT, fc="none", alpha=0.6, lw=0.8)
    for points in outline(scene, orientation, plane):
        shown = (points + position[[across, along]]) * per("um")
        axes.add_patch(
            Polygon(shown, facecolor=style.PATH, alpha=0.35, edgecolor=style.PATH, lw=1.4)
        )
    axes.plot(0, 0, "+", color=style.LIGHT, ms=7, mew=1.2)
    axes.set(
        xlim=(-width, width), ylim=(-width, width), aspect="equal", xlabel=f"{plane[0]} (µm)",
        ylabel="z along the light (µm)",
    )  # fmt: skip
    axes.set_title(f"{plane[0]}z plane, to scale")


def _draw_force(
    axes: Axes, scene: Scene, position: Array, orientation: Array, reach: float
) -> None:
    """Draw each component of the force along its own axis through the body's position."""
    light = light_force(scene)
    far = np.linspace(-reach, reach, 301)
    turned_bodies = np.tile(orientation, (far.size, 1))
    for i, name in enumerate("xyz"):
        points = np.tile(position, (far.size, 1))
        points[:, i] += far
        force = light.field(points, orientations=turned_bodies).force[:, i]
        axes.plot(far * per("um"), force * per("pN"), **style.AXES[name].curve, label=name)
    axes.axhline(0, color=style.MUTED, lw=0.6)
    axes.set(xlabel="displacement (µm)", ylabel="force (pN)")
    axes.set_title("force along each axis, orientation held")
    axes.legend(loc="upper right", title="axis")


def _draw_torque(axes: Axes, scene: Scene, position: Array, orientation: Array) -> None:
    """Draw each component of the torque over the angle about its own axis."""
    light = light_force(scene)
    angle = np.linspace(-np.pi / 2, np.pi / 2, 181)
    points = np.tile(position, (angle.size, 1))
    held = Rotation.from_quat(orientation, scalar_first=True)
    for i, name in enumerate("xyz"):
        about = angle[:, None] * np.eye(3)[i]
        bodies = (Rotation.from_rotvec(about) * held).as_quat(scalar_first=True)
        torque = light.field(points, orientations=bodies).moment[:, i]
        axes.plot(np.degrees(angle), torque * per("pN um"), **style.AXES[name].curve, label=name)
    axes.axhline(0, color=style.MUTED, lw=0.6)
    axes.set(xlabel="angle (degrees)", ylabel="torque (pN µm)", xticks=(-90, -45, 0, 45, 90))
    axes.set_title("torque about each axis, position held")
