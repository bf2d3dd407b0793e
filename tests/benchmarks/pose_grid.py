"""Energy of a body of revolution on a grid of poses, from the force and torque of the light alone.

A pose is a position and the direction n of the body's axis, where n and -n are the same. With the
angle alpha between n and x, and the angle psi of n about x from y, the grid is a product of Gauss's
nodes in x, y, z and alpha (to 90 degrees) and of equal steps in psi. The work along a path from one
pose to all others gives the energies. They are integrals of the polynomials through the nodes.

The force of light has no potential, so the energy depends on the path. Two paths are taken: one
rotates the body before it leaves the line of the foci, the other rotates it last.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from tweezer.optics import light_force
from tweezer.scene import Scene

Array = NDArray[np.float64]

#: Poses whose force is computed in one call
_AT_ONCE = 20_000


@dataclass(frozen=True)
class Nodes:
    """Gauss's nodes of an interval, and integrals of the polynomial through values at them."""

    at: Array
    weight: Array
    work: Array
    """(n, n): integral from `origin` to each node"""
    origin: float

    @classmethod
    def of(cls, low: float, high: float, count: int, origin: float | None = None) -> Nodes:
        """Return nodes from `low` to `high`; the default origin of integrals is the middle."""
        middle, half = (low + high) / 2, (high - low) / 2
        origin = middle if origin is None else origin
        s, w = legendre.leggauss(count)
        coefficients = np.linalg.inv(legendre.legvander(s, count - 1))
        integral = legendre.legint(coefficients, lbnd=(origin - middle) / half)
        return cls(middle + half * s, half * w, half * legendre.legval(s, integral).T, origin)


@dataclass(frozen=True)
class PoseGrid:
    """Poses of a body in a scene whose foci lie on the x axis."""

    scene: Scene
    x: Nodes
    y: Nodes
    z: Nodes
    alpha: Nodes
    psi: Array

    @classmethod
    def of(
        cls, scene: Scene, half_widths: tuple[float, float], z: tuple[float, float],
        counts: tuple[int, int, int, int, int],
    ) -> PoseGrid:  # fmt: skip
        """Return a grid with y = 0 and the middle z among its odd numbers of nodes.

        Parameters
        ----------
        scene : Scene
            Scene with a spheroid.
        half_widths : tuple of float
            Largest x and y, m.
        z : tuple of float
            Smallest and largest z, m.
        counts : tuple of int
            Number of nodes in x, y, z, alpha and psi.
        """
        (wide, across), (nx, ny, nz, n_alpha, n_psi) = half_widths, counts
        psi = (np.arange(n_psi) + 0.5) * 2 * np.pi / n_psi
        return cls(
            scene, Nodes.of(-wide, wide, nx, 0.0), Nodes.of(-across, across, ny),
            Nodes.of(*z, nz), Nodes.of(0.0, np.pi / 2, n_alpha, 0.0), psi,
        )  # fmt: skip

    def directions(self, alpha: Array) -> Array:
        """Return the axes n of the body for each alpha and psi, (n, psi, 3)."""
        a, p = np.broadcast_arrays(alpha[:, None], self.psi)
        return np.stack([np.cos(a), np.sin(a) * np.cos(p), np.sin(a) * np.sin(p)], axis=-1)

    def _forces(self, x: Array, y: Array, z: Array, alpha: Array) -> tuple[Array, Array]:
        """Return force and torque at all poses, (x, y, z, alpha, psi, 3).

        The torque is projected on the axis about which alpha increases: (x, y, z, alpha, psi).
        """
        n = self.directions(alpha)
        shape = (len(x), len(y), len(z), *n.shape[:2])
        axes = np.broadcast_to(n, (*shape, 3)).reshape(-1, 3)
        where = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
        where = np.broadcast_to(where[..., None, None, :], (*shape, 3)).reshape(-1, 3)
        # the shortest rotation from z to n
        e = np.stack([1 + axes[:, 2], -axes[:, 1], axes[:, 0], np.zeros(len(axes))], axis=-1)
        e /= np.linalg.norm(e, axis=1, keepdims=True)
        light = light_force(self.scene)
        parts = np.arange(_AT_ONCE, len(e), _AT_ONCE)
        found = [
            light.field(np.ascontiguousarray(at), orientations=np.ascontiguousarray(turned))
            for at, turned in zip(np.split(where, parts), np.split(e, parts), strict=True)
        ]
        force = np.concatenate([each.force for each in found]).reshape(*shape, 3)
        body, medium = self.scene.body, self.scene.medium
        sinking = body.mass - medium.density * body.volume
        force[..., 2] -= sinking * self.scene.forces.gravitational_acceleration
        torque = np.concatenate([each.moment for each in found]).reshape(*shape, 3)
        about = np.stack([0 * self.psi, -np.sin(self.psi), np.cos(self.psi)], axis=-1)
        return force, (torque * about).sum(axis=-1)

    def energies(self) -> tuple[Array, Array]:
        """Return the energies, J, (x, y, z, alpha, psi), by the two paths.

        The first path moves the body along x while it lies along x, rotates it there, and moves it
        along z and then y. The second moves it along x, z and y, and rotates it last.
        """
        x, y, z, alpha = self.x, self.y, self.z, self.alpha
        force, torque = self._forces(x.at, y.at, z.at, alpha.at)
        lying, _ = self._forces(x.at, y.at, z.at, np.zeros(1))
        lying = lying[..., 0, 0, :]
        j, k = len(y.at) // 2, len(z.at) // 2
        along_x = -x.work @ lying[:, j, k, 0]
        turned = -np.einsum("ab,xyzbp->xyzap", alpha.work, torque)
        along_z = -np.einsum("zw,xwap->xzap", z.work, force[:, j, ..., 2])
        along_y = -np.einsum("yv,xvzap->xyzap", y.work, force[..., 1])
        first = along_x[:, None, None] + turned[:, j, k]
        early = first[:, None, None] + along_z[:, None] + along_y
        along_z = -np.einsum("zw,xw->xz", z.work, lying[:, j, :, 2])
        along_y = -np.einsum("yv,xvz->xyz", y.work, lying[..., 1])
        moved = along_x[:, None, None] + along_z[:, None] + along_y
        return early, moved[..., None, None] + turned

    def probabilities(self, energies: Array, kT: float) -> Array:
        """Return the probability of each node by Boltzmann's weight, (x, y, z, alpha, psi)."""
        p = np.exp(-(energies - energies.min()) / kT)
        for axis, nodes in enumerate((self.x.weight, self.y.weight, self.z.weight)):
            p *= nodes.reshape([-1 if each == axis else 1 for each in range(5)])
        p *= (self.alpha.weight * np.sin(self.alpha.at))[:, None]
        return np.asarray(p / p.sum())
