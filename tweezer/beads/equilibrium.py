"""Velocities of several beads without noise, their relaxation rates and their equilibrium."""

from __future__ import annotations

import numpy as np
from scipy.optimize import root

from tweezer.beads.system import System
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Largest distance of an equilibrium from the start, in radii
_NEAR = 5.0


def velocities(bound: System, t: float, x: Array) -> Array:
    """Return the velocities u = M F of the beads at a time, s, and positions (3 beads,), m."""
    place = x.reshape(-1, 3)
    found: Array = bound.mobility(place) @ bound.forces(place[None], t)[0].ravel()
    return found


def rates(system: System, positions: Array, time: float = 0.0) -> Array:
    """Return the relaxation rates of the forces at positions (beads, 3), m, (3 beads,) 1/s."""
    values = np.linalg.eigvals(system.mobility(positions) @ system.stiffness(positions, time))
    return np.sort(values.real)


def equilibrium(system: System) -> Array:
    """Return positions near the start at which all forces vanish, (beads, 3) m.

    Raises `SceneError` if no stable equilibrium without overlap is found there.
    """
    start = system.start
    check_forces(system)
    size = min(each.radius for each in system.scene.beads)

    def residual(x: Array) -> Array:
        return system.forces((x * size).reshape(1, *start.shape))[0].ravel() / scale

    scale = float(np.abs(system.stiffness(start)).max()) * size or 1.0
    found = root(residual, start.ravel() / size, tol=1e-10)
    place = found.x.reshape(start.shape) * size
    apart = np.linalg.norm(place - start, axis=1).max()
    held = found.success and apart < _NEAR * size and system.gaps(place).min() > 0
    if not held or rates(system, place)[0] <= 0:
        raise SceneError(
            f"{system.scene.name}: no stable equilibrium of the beads near their starts; change "
            "bead[1].start, or set start.drawn to no"
        )
    return place


def check_forces(system: System) -> None:
    """Raise `SceneError` for a force at the start that is not finite, as an overlong chain has."""
    if np.isfinite(system.forces(system.start[None])).all():
        return
    for i, tether in enumerate(system.scene.tether, start=1):
        if tether.contour_length is not None:
            raise SceneError(
                f"tether[{i}].contour_length = {tether.contour_length:g}: a chain is longer at the "
                "start than its law allows; start the beads closer to each other"
            )
    raise SceneError(f"{system.scene.name}: a force at the start is not finite")
