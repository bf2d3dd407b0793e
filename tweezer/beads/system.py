"""Several beads of a scene, bound: what acts on them, and their mobility."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.beads.forces import (
    CHAIN,
    DLVO,
    HERTZ,
    PARAMETERS,
    SPRING,
    WCA,
    Acting,
    add_forces,
    tensions,
)
from tweezer.beads.many import FAR, Fluid, fluid_of, mobility
from tweezer.beads.scalars import Scalars
from tweezer.forces.chains import chain
from tweezer.forces.data import packed
from tweezer.forces.force import Force, bound
from tweezer.optics import Beams, LightForce, light_force
from tweezer.scene import Scene
from tweezer.scene.bead import BeadProperties, bead_properties
from tweezer.scene.sections import Between, Tether
from tweezer.scene.several import pairs
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann

#: Displacement by which the stiffness of all forces is found, over the smallest radius
_APART = 1e-4


@dataclass(frozen=True, eq=False)
class System:
    """Several beads with all that acts on them."""

    scene: Scene
    beads: tuple[BeadProperties, ...]
    lights: tuple[Force, ...]
    """force of all beams on each bead"""

    @functools.cached_property
    def acting(self) -> Acting:
        """Forces in the form for compiled loops."""
        scene = self.scene
        light = packed(*(bound(each, gradient=False) for each in self.lights))
        names, radii = scene.bead_names, [each.radius for each in scene.beads]
        ends, points, laws, parameters = [], [], [], []
        chains = [np.zeros((0, 5))]
        for tether in scene.tether:
            a, b = (*map(names.index, tether.between), -1)[:2]
            ends.append((a, b))
            points.append(tether.point or (0.0, 0.0, 0.0))
            law, numbers = _of_tether(tether, self.kT, chains)
            laws.append(law)
            parameters.append(numbers)
        if scene.forces.between is not None:
            for i, j in pairs(len(radii)):
                law, numbers = _of_surfaces(scene.forces.between, radii[i], radii[j])
                ends.append((i, j))
                points.append((0.0, 0.0, 0.0))
                laws.append(law)
                parameters.append(numbers)
        return Acting(
            light,
            np.array([each.weight for each in self.beads], dtype=float),
            np.array(radii),
            np.array(ends, dtype=np.int64).reshape(-1, 2),
            np.array(points, dtype=float).reshape(-1, 3),
            np.array(laws, dtype=np.int64),
            np.array(parameters, dtype=float).reshape(-1, PARAMETERS),
            np.concatenate(chains),
        )

    @property
    def kT(self) -> float:
        """Thermal energy, J."""
        return Boltzmann * self.scene.noise_temperature

    @property
    def start(self) -> Array:
        """Positions at the start, (beads, 3) m."""
        return np.array([each.start for each in self.scene.beads], dtype=float)

    @functools.cached_property
    def scalars(self) -> Scalars:
        """Mobilities of a pair of beads."""
        a, b = self.scene.beads
        return Scalars((a.radius, b.radius), self.scalars_unit)

    @property
    def steady(self) -> bool:
        """Whether the light does not change in time."""
        return all(each.steady for each in self.lights)

    def foci(self, time: float) -> Array:
        """Return the foci of all beams at a time, s, (n, 3) m."""
        light = self.lights[0]
        return light.foci(time) if isinstance(light, LightForce | Beams) else np.zeros((1, 3))

    def outside(self, times: Array, x: Array) -> NDArray[np.bool_]:
        """Return which beads are lost at times (n,), s, and positions (..., n, beads, 3), m.

        A bead is lost if it is farther than `simulation.loss_distance` from every focus.
        """
        foci = np.stack([self.foci(t) for t in ([times[0]] if self.steady else times)])
        apart = np.linalg.norm(x[..., None, :] - foci[:, None], axis=-1).min(axis=-1)
        lost: NDArray[np.bool_] = apart > self.scene.simulation.loss_distance
        return lost

    @functools.cached_property
    def fluid(self) -> Fluid:
        """Radii and viscosity for the mobility of more than two beads."""
        radii = np.array([each.radius for each in self.scene.beads])
        held = not self.scene.tether and self.scene.forces.between is None and self.steady
        near = not held or self.gaps(self.start).min() < FAR * radii.max()
        return fluid_of(radii, self.scalars_unit, near=near)

    @property
    def scalars_unit(self) -> float:
        """1/(6 pi mu), m s/kg."""
        return 1 / (6 * math.pi * self.scene.medium.viscosity)

    def mobility(self, positions: Array) -> Array:
        """Return the mobility of the beads at positions (beads, 3), m, (3 beads, 3 beads) s/kg."""
        if len(self.beads) > 2:
            return mobility(self.fluid, positions)
        between = positions[1] - positions[0]
        rho = float(np.linalg.norm(between))
        of = self.scalars.at(np.array([rho - sum(self.scalars.radii)]))
        along = np.outer(between, between) / rho**2
        across = np.eye(3) - along
        own, other, cross = (
            float(x[0]) * along + float(y[0]) * across
            for x, y in ((of.x11, of.y11), (of.x22, of.y22), (of.x12, of.y12))
        )
        return np.block([[own, cross], [cross, other]])

    def mobility_of_pair(self, i: int, j: int, gaps: Array) -> Array:
        """Return the mobility of a distance by opposite forces at gaps (n,), m: (n,) s/kg."""
        radii = float(self.acting.radius[i]), float(self.acting.radius[j])
        return Scalars(radii, self.scalars_unit).at(gaps).relative_x

    def gaps(self, positions: Array) -> Array:
        """Return the gaps of all pairs at positions (..., beads, 3), m: (..., pairs) m."""
        radii = self.acting.radius
        first, second = np.array(list(pairs(len(radii)))).T
        apart = np.linalg.norm(positions[..., second, :] - positions[..., first, :], axis=-1)
        found: Array = apart - radii[first] - radii[second]
        return found

    def tension(self, positions: Array) -> Array:
        """Return the force between each two beads at positions (n, beads, 3), m: (n, pairs) N.

        It is positive if it pulls them together.
        """
        found = np.zeros((len(positions), len(self.beads) * (len(self.beads) - 1) // 2))
        tensions(self.acting, np.ascontiguousarray(positions), found)
        return found

    def forces(self, positions: Array, time: float = 0.0) -> Array:
        """Return all forces but drag and noise at positions (n, beads, 3), m: (n, beads, 3) N."""
        found = np.empty(positions.shape)
        add_forces(self.acting, time, np.ascontiguousarray(positions), found)
        return found

    def stiffness(self, positions: Array, time: float = 0.0) -> Array:
        """Return minus the derivative of the forces at positions (beads, 3), m, by differences.

        It is (3 beads, 3 beads) N/m.
        """
        size = positions.size
        step = _APART * min(each.radius for each in self.scene.beads)
        moves = step * np.eye(size).reshape(size, *positions.shape)
        ahead, behind = (self.forces(positions + sign * moves, time) for sign in (1, -1))
        return -(ahead - behind).reshape(size, size).T / (2 * step)


def _of_tether(tether: Tether, kT: float, chains: list[Array]) -> tuple[int, list[float]]:
    """Return the law and the parameters of a tether; append the table of a chain to `chains`."""
    if tether.model == "spring":
        return SPRING, [tether.stiffness or 0.0, tether.length or 0.0, 0.0, 0.0]
    assert tether.contour_length is not None
    assert tether.persistence_length is not None
    table, _ = chain(
        tether.model, contour_length=tether.contour_length,
        persistence_length=tether.persistence_length, temperature=kT / Boltzmann,
        stretch_modulus=tether.stretch_modulus,
    ).table()  # fmt: skip
    first = sum(map(len, chains))
    chains.append(table)
    return CHAIN, [first, first + len(table), 0.0, 0.0]


def _of_surfaces(between: Between, radius_1: float, radius_2: float) -> tuple[int, list[float]]:
    """Return the law and the parameters of the force between two surfaces."""
    reduced = radius_1 * radius_2 / (radius_1 + radius_2)
    match between.kind:
        case "dlvo":
            pull = (between.hamaker_constant or 0.0) * reduced / 6
            found = DLVO, [between.strength or 0.0, between.debye_length or 1.0, pull, 0.0]
        case "wca":
            found = WCA, [between.strength or 0.0, between.range or 0.0, 0.0, 0.0]
        case "hertz":
            hard = 4 / 3 * (between.modulus or 0.0) * math.sqrt(reduced)
            found = HERTZ, [hard, between.range or 0.0, 0.0, 0.0]
        case _:
            found = SPRING, [between.stiffness or 0.0, between.gap or 0.0, 0.0, 0.0]
    return found


def system(scene: Scene) -> System:
    """Return the beads of a scene, bound."""
    alone = [scene.alone(number) for number in range(1, len(scene.beads) + 1)]
    return System(
        scene, tuple(map(bead_properties, alone)), tuple(light_force(each) for each in alone)
    )
