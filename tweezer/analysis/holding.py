"""How long a trap holds a bead against thermal motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.constants import Boltzmann
from scipy.integrate import cumulative_trapezoid

from tweezer.analysis.escape import Escape
from tweezer.analysis.exit_time import Field, Grid, Region, mean_time
from tweezer.dynamics import Problem, bound_once
from tweezer.equilibria import Equilibrium
from tweezer.optics import sampled
from tweezer.rounding import micrometres
from tweezer.scene import Scene
from tweezer.shown import Card, Row, Shown

Array = NDArray[np.float64]

#: Longest time that is told from for ever, s
LONGEST = 1e20
#: Work on every straight way out, k_B T, from which on no time is computed: it is longer than that
DEEP = 300.0
#: Number of places on a straight way out
_WAY = 400
#: Distance of the nodes at the focus, in radii and in distances of samples
_FINE_RADII, _FINE_SAMPLES = 0.05, 0.5
#: Smallest gap of the bead from a wall, in radii
_BESIDE_WALL = 1e-3
#: Part of the correction by the coarser grid that is taken as its error
_OF_CORRECTION = 0.5
#: Error of the logarithm from which on nodes are closer
_ENOUGH = 0.05
#: Thermal conductivity of water, W/m/K
_WATER = 0.6
#: Warming of the bead's surface from which on it is said, K
_WARM = 0.1
#: Units of time and their length, s
_UNITS = (
    (365.25 * 86400.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min"), (1.0, "s"),
    (1e-3, "ms"), (0.0, "us"),
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class Lifetime(Shown):
    """How long thermal motion leaves a bead in its trap."""

    time: float
    """mean time from the equilibrium until the bead is lost, s; infinite if longer than 1e20 s"""
    error: float
    """estimated error of that time, s; 0 of an infinite one"""
    lost_at: float
    """distance from the focus at which the bead is lost, m"""

    def card(self) -> Card:
        """How long, and until where."""
        far = Row("lost at", f"{micrometres(self.lost_at)} um from the focus")
        return Card("Lifetime", "", (Row("held for", self.words), far))

    @property
    def words(self) -> str:
        """The time with its error in the usual unit, as "3.2 +- 0.1 h"."""
        if math.isinf(self.time):
            return f"longer than {LONGEST:.0e} s"
        size, unit = next(each for each in _UNITS if self.time >= each[0])
        size = size or 1e-6
        if self.error >= self.time:
            within = 1 + self.error / self.time
            return f"about {self.time / size:.1g} {unit}, within a factor of {within:.1g}"
        if self.time >= 1e5 * size:
            return f"{self.time / size:.1e} {unit}, within {100 * self.error / self.time:.1g} %"
        smallest = 1e-3 * self.time
        digits = max(0, -math.floor(math.log10(max(self.error, smallest) / size)))
        if self.error < smallest:
            return (
                f"{self.time / size:.{digits}f} {unit}, within {100 * self.error / self.time:.1g} %"
            )
        return f"{self.time / size:.{digits}f} +- {self.error / size:.{digits}f} {unit}"


def lifetime(
    scene: Scene,
    equilibrium: Equilibrium | None,
    escapes: tuple[Escape, ...],
    reach: float,
    force_error: float,
) -> Lifetime | None:
    """The lifetime of the trap of `scene`, of which the rest is known: see `Trap.lifetime`."""
    if equilibrium is None or _not_computed(scene, equilibrium, reach):
        return None
    problem = bound_once(scene)
    height = equilibrium.position[2]
    radius = min(reach, scene.simulation.loss_distance)
    energy = Boltzmann * scene.medium.temperature
    region = _region(problem, radius)
    fields = [_field(problem, height, side) for side in ((0,) if problem.symmetric else (0, 1))]
    if min(_least_work(region, field, height) for field in fields) > DEEP * energy:
        return Lifetime(math.inf, 0.0, radius)
    found = [_log_time(region, field, height, energy) for field in fields]
    mean = float(np.mean([log for log, _ in found]))
    if not mean < math.log(LONGEST):
        return Lifetime(math.inf, 0.0, radius)
    apart = float(np.ptp([log for log, _ in found])) / 2
    ways = [escape.range or escape.force_at for escape in escapes]
    by_force = force_error * min(ways) / energy
    error = max(error for _, error in found) + apart + by_force
    return Lifetime(math.exp(mean), math.exp(mean) * math.expm1(error), radius)


def doubt(
    scene: Scene, equilibrium: Equilibrium | None, reach: float, absorbed_power: float | None
) -> str | None:
    """What speaks against the lifetime, or why there is none: see `Trap.lifetime_caveat`."""
    if equilibrium is None:
        return None
    if why := _not_computed(scene, equilibrium, reach):
        return f"not computed {why}"
    warmer = (absorbed_power or 0.0) / (4 * math.pi * _WATER * scene.bead.radius)
    if warmer < _WARM:
        return None
    return (
        f"at the temperature of the medium, but in water the light heats the bead by {warmer:.2g} K"
    )


def _not_computed(scene: Scene, equilibrium: Equilibrium, reach: float) -> str:
    """Why the lifetime of a trap is not computed; empty if it is."""
    if len(scene.beams) > 1:
        return "for several beams"
    if not scene.plain:
        return "for a beam that is not upwards through the origin, moves or changes"
    if scene.forces.dlvo is not None:
        return "with forces.dlvo"
    if abs(equilibrium.position[2]) >= min(reach, scene.simulation.loss_distance):
        return "for an equilibrium beyond simulation.loss_distance"
    return ""


def _region(problem: Problem, radius: float) -> Region:
    """Where the bead is not lost, between the walls of the scene."""
    scene = problem.scene
    finest = _FINE_RADII * scene.bead.radius + _FINE_SAMPLES * problem.light.search.spacing
    low, high = -math.inf, math.inf
    for position, normal in scene.wall.planes if scene.wall else ():
        touching = position + normal * (1 + _BESIDE_WALL) * scene.bead.radius
        low, high = (touching, high) if normal > 0 else (low, touching)
    return Region(radius, finest, low, high)


def _field(problem: Problem, height: float, side: int) -> Field:
    """The forces and mobilities in the half plane along x (side 0) or y (1)."""
    weight = problem.bead.weight[2]
    free = problem.mobilities(np.array([[0.0, 0.0, height]]))[0]

    def field(rho: Array, z: Array) -> tuple[Array, Array, Array, Array]:
        places = np.zeros((len(rho), 3))
        places[:, side], places[:, 2] = rho, z
        force, _ = sampled(problem.scene, places)
        for each in problem.beside_the_light_apart:
            force = force + each.field(places).force
        mobile = np.broadcast_to(free, (len(rho), len(free)))
        if not problem.drag.uniform:
            mobile = problem.mobilities(places)
        return force[:, side], force[:, 2] + weight, mobile[:, side], mobile[:, 2]

    return field


def _least_work(region: Region, field: Field, height: float) -> float:
    """Least work on the straight ways out of a region, or to its walls, from `height`, J."""
    out = np.linspace(0.0, region.radius - abs(height), _WAY)
    still = np.zeros(_WAY)
    up, down = (np.clip(height + way, region.low, region.high) for way in (out, -out))
    ways = (
        (out, field(out, still + height)[0]),
        (up, field(still, up)[1]),
        (down, field(still, down)[1]),
    )
    return min(float(-cumulative_trapezoid(force, x).min()) for x, force in ways)


def _log_time(region: Region, field: Field, height: float, energy: float) -> tuple[float, float]:
    """Logarithm of the mean time, s, and its error; on closer nodes if that is large.

    A heavy bead may be held far from the focus, or in a narrow place.
    """
    log, error = _extrapolated(region, field, height, energy)
    if error > _ENOUGH:
        return _extrapolated(region.finer(height), field, height, energy)
    return log, error


def _extrapolated(
    region: Region, field: Field, height: float, energy: float
) -> tuple[float, float]:
    """The same by the nodes of the region and by every other one of them."""
    grid = Grid.of(region, field, energy)
    fine = mean_time(grid, region, height, energy)
    coarse = mean_time(grid.coarse(), region, height, energy)
    if not math.isfinite(max(fine, coarse)):
        return math.inf, 0.0
    correction = math.log(fine / coarse) / 3
    return math.log(fine) + correction, _OF_CORRECTION * abs(correction)
