"""Drag of a bead: a compiled kernel and its data, which return the mobilities at a position.

In a fluid that is symmetric about N3, as beside a wall perpendicular to N3, a bead has five
mobilities (`derivation.drag`). Two apply to translation perpendicular and parallel to N3, two to
rotation about these directions, and one to rolling. In an unbounded fluid they follow from Stokes's
law (2.13-2.15).

They are entries of the symmetric 6 x 6 mobility matrix of a body about its centre of mass
(`Drag.mobility_matrices`). Compiled loops read only these five. With the 21 independent entries of
the full matrix, its product with force and torque would take 1.5 times as long, and the drag of a
given motion 5.8 times as long.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numba import typeof, types

from tweezer.compiled import address, cached_njit
from tweezer.forces.data import DATA, Data, Part, number, packed
from tweezer.forces.force import POSE, Pose
from tweezer.scene.sphere import drag_of_rotation, drag_of_translation
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

Kernel = Callable[[Any, Data, Any], None]


class Mobility(NamedTuple):
    """Mobilities of n beads, velocity per force; the kernel of a drag fills the arrays."""

    value: Array
    """(n, 5): parallel and perpendicular to a wall across N3, s/kg; turn, across N3, and spin,
    about it, 1/(N m s); roll, the velocity along N1 by a torque about N2, 1/(N s)"""
    gradient: Array
    """(n, 5, 3) gradients with respect to the position, per m; (0, 5, 3) if not requested"""


class Walls(Protocol):
    """Planes perpendicular to z. The mobility towards them vanishes at contact."""

    @property
    def planes(self) -> tuple[tuple[float, float], ...]:
        """Position, m, and normal, 1 or -1 towards the bead, of one plane or two."""

    @property
    def radius(self) -> float:
        """Distance of the centre from a plane at contact, m."""

    @property
    def stokes(self) -> Stokes:
        """Drag far from the planes."""


class Drag(ABC):
    """Drag of a bead, as a compiled kernel with data."""

    @property
    def uniform(self) -> bool:
        """Whether the drag is the same at every position and time and in every direction, without
        rolling.
        """
        return False

    @property
    def oriented(self) -> bool:
        """Whether the drag depends on the orientation of the bead."""
        return False

    @property
    def walls(self) -> Walls | None:
        """Walls, beside which thermal motion requires a special scheme; None without walls."""
        return None

    @abstractmethod
    def compiled(self) -> tuple[Kernel, Data]:
        """Return the compiled kernel `kernel(pose, data, mobility)` and its data."""

    @property
    def part(self) -> Part:
        """Address of the compiled kernel with its data, for compiled loops."""
        kernel, data = self.compiled()
        return Part(address(kernel, DRAG_KERNEL), data)

    def mobilities(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Mobility:
        """Return the five mobilities at positions of the bead, and their gradients if requested.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        gradient : bool, optional
            Whether to compute gradients too.
        time : float or ndarray, shape (n,), optional
            Time, s.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters of length 1, for a drag that depends on them. Default: (1, 0, 0, 0).

        Raises
        ------
        SceneError
            For positions of another shape.
        """
        places = np.require(positions, np.float64, ["C", "W"])
        n = len(places)
        if places.shape != (n, 3):
            raise SceneError(f"positions: must be of shape (n, 3), not {places.shape}")
        turned = np.zeros((0, 4))
        if self.oriented:
            unturned = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
            turned = unturned if orientations is None else orientations
        pose = Pose(np.full(n, time, np.float64), places, turned, np.zeros((0, 3)))
        found = Mobility(np.zeros((n, 5)), np.zeros((n if gradient else 0, 5, 3)))
        kernel, data = self.compiled()
        kernel(pose, data, found)
        return found

    def mobility_matrices(
        self,
        positions: Array,
        *,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Array:
        """Return the mobility matrices about the centre of mass.

        The product of a matrix with the force and the torque on the bead is its velocity and its
        angular velocity, with components along N1, N2 and N3. It is symmetric and positive
        definite.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Centre of the bead relative to the focus, m.
        time : float or ndarray, shape (n,), optional
            Time, s.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters of length 1, for a drag that depends on the orientation; (1, 0, 0, 0)
            if not given.

        Returns
        -------
        ndarray, shape (n, 6, 6)
            Mobility matrices: translation due to a force, s/kg, rotation due to a torque, 1/(N m
            s), and the blocks that couple them, 1/(N s).

        Raises
        ------
        SceneError
            If the positions have another shape.
        """
        value = self.mobilities(positions, time=time, orientations=orientations).value
        matrices = by_axis(value)[:, :, None] * np.eye(6)
        rolling = value[:, 4, None]
        matrices[:, [0, 4], [4, 0]] = rolling
        matrices[:, [1, 3], [3, 1]] = -rolling
        return matrices


@cached_njit()
def _uniform(pose, data, mobility):  # type: ignore[no-untyped-def]
    """Kernel of a drag that is the same everywhere; its data are beta_v, kg/s, and
    beta_w, N m s.
    """
    for at in range(len(pose.position)):
        mobility.value[at, :2] = 1.0 / number(data, 0)
        mobility.value[at, 2:4] = 1.0 / number(data, 1)
        mobility.value[at, 4] = 0.0
    mobility.gradient[:] = 0.0


@dataclass(frozen=True)
class Stokes(Drag):
    """Drag of a sphere in an unbounded fluid without inertia (2.13-2.15)."""

    translation: float
    """beta_v = 6 pi mu r, kg/s"""
    rotation: float
    """beta_w = 8 pi mu r^3, N m s"""

    @property
    def uniform(self) -> bool:
        """Whether the drag is the same everywhere: True."""
        return True

    def compiled(self) -> tuple[Kernel, Data]:
        """Return the compiled kernel and its data, beta_v and beta_w."""
        return _uniform, packed(self.translation, self.rotation)


def stokes(viscosity: float, radius: float) -> Stokes:
    """Return the drag of a sphere, from the viscosity, Pa s, and the radius, m (2.15)."""
    return Stokes(drag_of_translation(viscosity, radius), drag_of_rotation(viscosity, radius))


def by_axis(value: Array) -> Array:
    """Return mobilities along N1, N2, N3 and about them, (n, 6), from the five (n, 5).

    Rolling, which couples force and rotation, is omitted. N1 and N2 are parallel to the wall.
    """
    return value[:, [0, 0, 1, 2, 2, 3]]


_MOBILITY = typeof(Mobility(np.zeros((0, 5)), np.zeros((0, 5, 3))))
DRAG_KERNEL = types.void(POSE, DATA, _MOBILITY)
"""signature of a kernel"""
