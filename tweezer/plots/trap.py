"""Figure of a trap: the force along two lines, and its field."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from tweezer.dynamics import bound_once
from tweezer.plots import style
from tweezer.plots.scene import caveat_note, change_note, draw_cones, planes, title_of
from tweezer.scene import Scene
from tweezer.values.prefixes import per

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tweezer.trap import Escape, Trap

#: Force below which no field lines are drawn, over the largest force
_NO_LINES = 1e-3


@style.styled
def trap_figure(scene: Scene, trap: Trap) -> Figure:
    """Draw the force along the axis and across it, and the force field around the trap.

    The force is the sum of light and weight. Without a stable equilibrium the lines run through the
    focus.

    Parameters
    ----------
    scene : Scene
        Scene of the trap.
    trap : Trap
        Result of `tweezer.characterise`.

    Returns
    -------
    Figure
        Matplotlib figure.
    """
    trap.check_scene_alone("the figure of a trap")
    figure = style.new(style.PAGE, 4.1)
    axes = figure.subplot_mosaic([["axial", "field"], ["lateral", "field"]], width_ratios=(1, 1.3))
    _draw_curve(axes["axial"], scene, trap, "z")
    _draw_curve(axes["lateral"], scene, trap, "x")
    _draw_field(axes["field"], scene, trap)
    figure.align_ylabels([axes["axial"], axes["lateral"]])
    style.add_letters([axes["axial"], axes["lateral"], axes["field"]])
    style.add_title(figure, title_of(scene))
    power = f"{trap.power_through_pupil * per('mW'):.3g} mW through the pupil"
    told = [
        f"{power}. Force of light and weight, by {trap.evaluator}. "
        "Hollow points: escape forces; arrows: direction of the force; +: focus."
    ]
    if scene.lit:
        told.append("Red lines: edges of the cone of light.")
    if trap.equilibrium:
        told.append("Dashed: stiffness at the equilibrium; circle: bead there.")
    style.add_notes(figure, [change_note(scene), " ".join(told), caveat_note(scene)])
    return figure


def _centre(trap: Trap) -> np.ndarray:
    """Return the position of the equilibrium, or of the focus without one, (3,), m."""
    return np.array(trap.equilibrium.position if trap.equilibrium else (0.0, 0.0, 0.0))


def _reach(scene: Scene, trap: Trap) -> float:
    """Return half the width of the figure, which is centred on the origin, m."""
    r = scene.body.size
    shown = np.vstack([_centre(trap), *(beam.position for beam in scene.beams)])
    farthest = max((escape.force_at for escape in trap.escapes), default=0.0)
    return max(3.5 * r, float(np.abs(shown).max()) + max(2 * r, 1.5 * farthest))


def _net_force(scene: Scene, points: np.ndarray) -> np.ndarray:
    """Return all forces except drag on the bead at positions (..., 3), m, as (..., 3), N.

    Contact with a wall is ignored.
    """
    return bound_once(scene).net_force_apart(points.reshape(-1, 3)).reshape(points.shape)


def _free(scene: Scene, z: np.ndarray) -> np.ndarray:
    """Return those of the heights `z`, m, at which the bead is not in a wall."""
    return z if scene.wall is None else z[scene.room(z) > 0]


def _largest_shown(scene: Scene, trap: Trap, largest: float) -> float:
    """Return the largest force that a figure shows, pN.

    It is limited if the force of a wall is much larger, so that the optical force remains visible.
    `largest` is the largest force in the figure, pN.
    """
    if not scene.forces.dlvo or not trap.escapes:
        return largest
    *_, across, _ = sorted(escape.force for escape in trap.escapes)
    return min(largest, 2 * across * per("pN"))


def _draw_curve(axes: Axes, scene: Scene, trap: Trap, axis: str) -> None:
    """Draw one component of the force along its own axis, with its slope and the escape forces."""
    along = "xyz".index(axis)
    centre, reach = _centre(trap), _reach(scene, trap)
    coordinates = np.linspace(-reach, reach, 601)
    if axis == "z":
        coordinates = _free(scene, coordinates)
        for plane, normal in planes(scene):
            touching = plane + normal * scene.body.support(normal) * per("um")
            axes.axvspan(touching, -normal * 3 * per("um") * reach, **style.SOLID)
    points = np.tile(centre, (coordinates.size, 1))
    points[:, along] = coordinates
    force = _net_force(scene, points)[:, along] * per("pN")
    colour = style.AXES[axis].colour
    axes.axhline(0, color=style.MUTED, lw=0.6)
    axes.axvline(0, color=style.LIGHT, lw=0.6, ls=":")
    axes.plot(coordinates * per("um"), force, color=colour, lw=2.0, zorder=3)
    extent = _largest_shown(scene, trap, np.abs(force).max()) or 1.0
    axes.set(
        xlim=(-reach * per("um"), reach * per("um")), ylim=(-1.75 * extent, 1.75 * extent),
        xlabel=f"{axis} (µm)", ylabel=f"$F_{axis}$ (pN)",
    )  # fmt: skip
    axes.set_title(
        f"{'held on a ring' if trap.ring else 'no stable equilibrium'}; through the focus"
        if not trap.equilibrium
        else "along the light"
        if axis == "z"
        else "across it, through the equilibrium"
    )
    if trap.equilibrium is None:
        return
    stiffness = trap.equilibrium.stiffness[along][along]
    escapes = [escape for escape in trap.escapes if escape.direction[1] == axis]
    way = 0.8 * min(escape.force_at for escape in escapes) * np.array([-1, 1])
    axes.plot(
        (centre[along] + way) * per("um"), -stiffness * way * per("pN"),
        color=style.INK, lw=1.0, ls="--", zorder=4, label=f"{stiffness * per('pN/um'):.3g} pN/µm",
    )  # fmt: skip
    axes.plot(centre[along] * per("um"), 0, "o", color=style.PATH, ms=4, zorder=4)
    for escape in escapes:
        _mark_escape(axes, escape, float(centre[along]), colour)
    axes.legend(loc="upper right" if axis == "x" else "lower left")


def _mark_escape(axes: Axes, escape: Escape, centre: float, colour: str) -> None:
    """Mark the escape force on the curve; `centre`: equilibrium along the axis, m."""
    side = 1 if escape.direction[0] == "+" else -1
    place = ((centre + side * escape.force_at) * per("um"), -side * escape.force * per("pN"))
    axes.plot(*place, "o", mfc="white", mec=colour, ms=4, zorder=5)
    # on the side away from the trap, unless the axes end there
    outward = side if abs(place[0]) < 0.6 * axes.get_xlim()[1] else -side
    axes.annotate(
        f"{escape.force * per('pN'):.3g} pN", place, xytext=(6 * outward, -4 * side),
        textcoords="offset points", ha="left" if outward > 0 else "right",
        va="top" if side > 0 else "bottom", fontsize=style.SMALL, color=style.NOTE,
    )  # fmt: skip


def _draw_field(axes: Axes, scene: Scene, trap: Trap) -> None:
    """Draw direction and magnitude of the force over the bead's position (x, z); bead to scale."""
    centre, r = _centre(trap), scene.body.size
    x = z = np.linspace(-1, 1, 201) * _reach(scene, trap)
    points = np.zeros((z.size, x.size, 3))
    points[..., 0], points[..., 2] = np.meshgrid(x, z)
    held = z if scene.wall is None else np.clip(z, *_free(scene, z)[[0, -1]])
    points[..., 2] = held[:, None]  # forces inside a wall are undefined
    force = _net_force(scene, points) * per("pN")
    size = np.linalg.norm(force, axis=-1)
    if np.ptp(size) > 0:
        most = _largest_shown(scene, trap, size.max())
        shown = axes.pcolormesh(
            x * per("um"), z * per("um"), size,
            vmin=0, vmax=most, cmap=style.FROM_ZERO, shading="gouraud", zorder=0, rasterized=True,
        )  # fmt: skip
        axes.figure.colorbar(shown, ax=axes, label="force (pN)", fraction=0.046, pad=0.03)
        # unit vectors, because interpolation between samples would follow the larger force
        strong = size[..., None] > _NO_LINES * size.max()
        lines = np.divide(force, size[..., None], out=np.full_like(force, np.nan), where=strong)
        axes.streamplot(
            x * per("um"), z * per("um"), lines[..., 0], lines[..., 2],
            density=1.3, color=style.NOTE, linewidth=0.6, arrowsize=0.8, zorder=2,
        )  # fmt: skip
    else:
        axes.text(
            0.5, 0.6, "no force of light", transform=axes.transAxes, ha="center", va="center",
            color=style.NOTE,
        )  # fmt: skip
    reach = _reach(scene, trap) * per("um")
    if scene.lit:
        edge: dict[str, Any] = {
            "ec": style.LIGHT,
            "fc": "none",
            "alpha": 0.6,
            "lw": 0.8,
            "zorder": 2.7,
        }
        draw_cones(axes, scene, reach, np.array([1.0, 0.0]), **edge)
    for plane, normal in planes(scene):
        touching = plane + normal * r * per("um")
        axes.axhspan(touching, -normal * reach, fc="white", lw=0, zorder=2.5)
        axes.axhspan(plane, -normal * reach, **(style.SOLID | {"zorder": 2.6}))
    if trap.equilibrium:
        axes.add_patch(
            Circle((centre[0] * per("um"), centre[2] * per("um")), r * per("um"), facecolor="none",
                   edgecolor=style.PATH, lw=1.4, zorder=3)
        )  # fmt: skip
    foci = per("um") * np.array([beam.position for beam in scene.beams])
    axes.plot(foci[:, 0], foci[:, 2], "+", color=style.LIGHT, ms=7, mew=1.2, zorder=4)
    axes.set(
        xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal",
        xlabel="x (µm)", ylabel="z along the light (µm)",
    )  # fmt: skip
    axes.set_title("force on a bead centred there, to scale")
