"""Rules of scenes with several beads, and their pairs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from tweezer.scene.courses import refusal
from tweezer.values.printed import printed

if TYPE_CHECKING:
    from tweezer.scene.description import Description

#: Largest ratio of the radii of two beads
LARGEST_RATIO = 20.0
#: Sections that several beads do not support
_WITHOUT = ("wall", "mirror", "heat", "camera", "detector", "lock_in", "feedback")


def pairs(count: int) -> Iterator[tuple[int, int]]:
    """Yield the indices of each two of a number of beads."""
    return itertools.combinations(range(count), 2)


def check_several(scene: Description) -> None:
    """Refuse several beads that overlap or that the rest of the scene does not support."""
    if not scene.more_beads:
        for key, given in (("name", scene.bead.name), ("start", scene.bead.start)):
            if given is not None:
                raise refusal(f"bead.{key}: requires several beads ([[bead]]); remove it")
        if scene.tether:
            raise refusal("tether: requires several beads ([[bead]]); remove tether")
        if scene.forces.between is not None:
            raise refusal("forces.between: requires several beads ([[bead]]); remove it")
        return
    _names(scene)
    _apart(scene)
    for key in _WITHOUT:
        if getattr(scene, key) is not None:
            raise refusal(f"{key}: requires a single bead; remove {key} or the other beads")
    for i, bead in enumerate(scene.beads, start=1):
        if bead.shape != "sphere":
            raise refusal(f"bead[{i}].shape = {bead.shape!r}: several beads must be spheres")
    _motion(scene)


def _names(scene: Description) -> None:
    """Refuse beads of the same name, and tethers of beads that are not there."""
    names = scene.bead_names
    for name in names:
        if names.count(name) > 1:
            raise refusal(f"bead.name = {name!r}: is given to several beads; must be different")
    for i, tether in enumerate(scene.tether):
        for name in tether.between:
            if name not in names:
                allowed = ", ".join(map(repr, names))
                raise refusal(
                    f"tether[{i + 1}].between = {name!r}: unknown bead; allowed: {allowed}"
                )


def _apart(scene: Description) -> None:
    """Refuse beads that overlap at the start, too unequal ones, and points inside their beads."""
    names = scene.bead_names
    for i, tether in enumerate(scene.tether, start=1):
        if tether.point is not None:
            bead = scene.beads[names.index(tether.between[0])]
            if math.dist(tether.point, bead.start or ()) <= bead.radius:
                raise refusal(
                    f"tether[{i}].point = {list(tether.point)}: is inside its bead at the start; "
                    "must be outside"
                )
    foci = [beam.position for beam in scene.beams] if scene.forces.optical else [(0.0, 0.0, 0.0)]
    for i, bead in enumerate(scene.beads, start=1):
        apart = min(math.dist(bead.start or (), focus) for focus in foci)
        if apart >= scene.simulation.loss_distance:
            raise refusal(
                f"bead[{i}].start = {list(bead.start or ())}: is {apart:.3g} m from the nearest "
                f"focus; must be nearer than simulation.loss_distance = "
                f"{scene.simulation.loss_distance:.3g} m"
            )
    for i, j in pairs(len(scene.beads)):
        a, b = scene.beads[i], scene.beads[j]
        if max(a.radius, b.radius) > LARGEST_RATIO * min(a.radius, b.radius):
            raise refusal(
                f"bead[{j + 1}].radius = {b.radius:g}: too different from bead[{i + 1}]; allowed: "
                f"ratios up to {LARGEST_RATIO:g}"
            )
        gap = math.dist(a.start or (), b.start or ()) - a.radius - b.radius
        if not gap > 0:
            raise refusal(
                f"bead[{j + 1}].start = {list(b.start or ())}: overlaps bead[{i + 1}] by "
                f"{printed(-gap, 'nm')}; must be farther away"
            )


def _motion(scene: Description) -> None:
    """Refuse models, media and starts that several beads do not support."""
    medium, simulation, start = scene.medium, scene.simulation, scene.start
    if medium.inertia == "memory":
        raise refusal(
            "medium.inertia = 'memory': applies to a single bead; several beads are followed "
            "without inertia of the fluid; remove medium.inertia"
        )
    if medium.viscoelastic:
        raise refusal("medium: several beads require a fluid that is viscous only")
    if scene.rarefied:
        raise refusal("medium.pressure: several beads require a liquid or a gas with Kn < 0.01")
    if simulation.model not in (None, "overdamped"):
        raise refusal(
            f"simulation.model = {simulation.model!r}: several beads are followed without inertia; "
            "set simulation.model to overdamped"
        )
    if simulation.method not in ("auto", "heun", "scipy:LSODA"):
        raise refusal(
            f"simulation.method = {simulation.method!r}: several beads are followed by their own "
            "method; set simulation.method to auto"
        )
    if start.drawn not in ("no", "equilibrium"):
        raise refusal(
            f"start.drawn = {start.drawn!r}: allowed for several beads: 'no', 'equilibrium'"
        )
    if scene.rotates or any(start.velocity):
        raise refusal("start, forces: several beads do not rotate and have no initial velocity")
    if scene.forces.recoil or scene.noisy_light:
        raise refusal("forces.recoil, beam.noise: require a single bead; remove them")
