"""Mean time for which a trap holds a bead against thermal motion."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from tweezer.dynamics import Problem, bound_once
from tweezer.dynamics.escape import Escape
from tweezer.dynamics.layout import TRANSLATION
from tweezer.forces.equilibria import Equilibrium
from tweezer.forces.rings import Ring
from tweezer.optics import sampled
from tweezer.scene import Scene
from tweezer.scene.interference import separately
from tweezer.trap.exit_time import Field, Grid, Region, mean_time
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.rounding import micrometres
from tweezer.values.shown import Card, Row, Shown

#: Longest time that is distinguished from an infinite one, s
LONGEST = 1e20
#: Work on every straight way out, k_B T, above which the time is not computed, as it exceeds that
DEEP = 300.0
#: Number of positions on a straight way out
_WAY = 400
#: Distance of the nodes at the focus, in radii, plus a part in sampling distances of the force
_FINE_RADII, _FINE_SAMPLES = 0.05, 0.5
#: Smallest gap of the bead from a wall, in radii
_BESIDE_WALL = 1e-3
#: Fraction of the correction from the coarser grid that is taken as its error
_OF_CORRECTION = 0.5
#: Error of the logarithm of the time above which closer nodes are used
_ENOUGH = 0.05
#: Largest sqrt(k m)/drag at which escape is treated as diffusion. The error of the time includes
#: its square, which is about the deviation of the overdamped rate from Kramers's rate at any
#: friction (H. A. Kramers, Physica 7, 284 (1940)).
_LITTLE_DRAG = 0.3
#: Distance of nodes without light, over the radius of the region
_FINE_DARK = 0.02
#: Largest ratio of the lifetime to the time without light at which the light has no effect
_NOTHING = 1.1
#: Thermal conductivity of water, W/m/K
_WATER = 0.6
#: Smallest temperature rise of the bead's surface that is reported, K
_WARM = 0.1
#: Units of time with their lengths, s
_UNITS = (
    (365.25 * 86400.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min"), (1.0, "s"),
    (1e-3, "ms"), (0.0, "us"),
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class Lifetime(Shown):
    """Mean time for which a bead stays in its trap despite thermal motion."""

    time: float
    """mean time from the equilibrium until the bead is lost, s; infinite if longer than 1e20 s"""
    error: float
    """estimated error of `time`, s; 0 if the time is infinite"""
    lost_at: float
    """distance from the focus at which the bead is lost, m"""

    def card(self) -> Card:
        """Return the card with the mean time, and the distance at which the bead is lost."""
        far = Row("lost at", f"{micrometres(self.lost_at)} um from the focus")
        return Card("Lifetime", "", (Row("held for", self.told), far))

    @property
    def told(self) -> str:
        """The time in words; an infinite time is explained."""
        return f"practically for ever ({self.words})" if math.isinf(self.time) else self.words

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
    held: Equilibrium | Ring | None,
    escapes: tuple[Escape, ...],
    reach: float,
    force_error: float,
) -> Lifetime | None:
    """Return the lifetime of a trap (see `Trap.lifetime`), or None.

    Parameters
    ----------
    scene : Scene
        Scene of the trap.
    held : Equilibrium or Ring, optional
        Equilibrium or ring that holds the bead.
    escapes : tuple of Escape
        Escapes from it along straight lines.
    reach : float
        Distance to which the trap was searched, m.
    force_error : float
        Error of the force, N.
    """
    if held is None:
        return None
    problem = bound_once(scene)
    if _not_computed(problem, held, reach):
        return None
    start = _start(held)
    radius = min(reach, scene.simulation.loss_distance)
    energy = Boltzmann * problem.scene.noise_temperature
    region = _region(problem, radius)
    fields = [_field(problem, start, side) for side in ((0,) if problem.symmetric else (0, 1))]
    if min(_least_work(region, field, start) for field in fields) > DEEP * energy:
        return Lifetime(math.inf, 0.0, radius)
    found = [_log_escape_time(region, field, start, energy) for field in fields]
    mean = float(np.mean([log for log, _ in found]))
    if not mean < math.log(LONGEST):
        return Lifetime(math.inf, 0.0, radius)
    apart = float(np.ptp([log for log, _ in found])) / 2
    ways = [escape.range or escape.force_at for escape in escapes]
    by_force = force_error * min(ways) / energy
    by_inertia = _quality(problem, held) ** 2
    error = max(error for _, error in found) + apart + by_force + by_inertia
    return Lifetime(math.exp(mean), math.exp(mean) * math.expm1(error), radius)


def time_without_light(scene: Scene, held: Equilibrium | Ring, reach: float) -> Lifetime:
    """Return the mean time until the bead is lost from the position of its trap without light.

    Thermal motion and weight take it to the same distance from the focus, `reach`, m, or to the
    loss distance if that is smaller, between the same walls. It begins at the equilibrium or ring
    `held`.
    """
    problem = bound_once(scene)
    radius = min(reach, scene.simulation.loss_distance)
    energy = Boltzmann * problem.scene.noise_temperature
    region = dataclasses.replace(
        _region(problem, radius), finest=_FINE_DARK * radius, centre=held.position[2]
    )
    start = _start(held)
    log, error = _extrapolated(region, _field(problem, start, 0, dark=True), start, energy)
    return Lifetime(math.exp(log), math.exp(log) * math.expm1(error), radius)


def adds_nothing(held: Lifetime, without_light: Lifetime | None) -> str:
    """Return a remark if the bead stays as long without light; otherwise ""."""
    if without_light is None:
        return ""
    if held.time - held.error <= _NOTHING * (without_light.time + without_light.error):
        return "the light adds nothing"
    return ""


def doubt(
    scene: Scene, held: Equilibrium | Ring | None, reach: float, absorbed_power: float | None
) -> str | None:
    """Return the effects that the lifetime neglects, or the reason why there is no lifetime.

    Returns None if the lifetime exists and neglects nothing.

    Parameters
    ----------
    scene : Scene
        Scene of the trap.
    held : Equilibrium or Ring, optional
        Equilibrium or ring that holds the bead.
    reach : float
        Distance to which the trap was searched, m.
    absorbed_power : float, optional
        Power that the bead absorbs, W.
    """
    if held is None:
        return None
    problem = bound_once(scene)
    if why := _not_computed(problem, held, reach):
        return f"not computed {why}"
    if problem.scene.heating.bead:
        return None
    # temperature rise of a sphere's surface, by heat conduction through water
    warmer = (absorbed_power or 0.0) / (4 * math.pi * _WATER * scene.bead.radius)
    if warmer < _WARM:
        return None
    return (
        f"at the temperature of the medium, but in water the light heats the bead by {warmer:.2g} K"
    )


def _start(held: Equilibrium | Ring) -> tuple[float, float]:
    """Return the distance from the axis and the height of an equilibrium or ring, m."""
    x, y, z = held.position
    return math.hypot(x, y), float(z)


def _quality(problem: Problem, held: Equilibrium | Ring) -> float:
    """Return the quality factor sqrt(k m)/beta of the stiffest direction.

    k is the stiffness, m the mass and beta the drag. Inertia is negligible far below 1.
    """
    stiffest = float(np.linalg.eigvals(held.stiffness).real.max())
    mobility = float(problem.mobilities(np.array([held.position]))[0, TRANSLATION].max())
    return problem.linear.quality(stiffest, mobility)


def _not_computed(problem: Problem, held: Equilibrium | Ring, reach: float) -> str:
    """Return the reason why the lifetime of a trap is not computed; "" if it is.

    `held` is the equilibrium or ring that holds the bead, and `reach`, m, the distance to which the
    trap was searched.
    """
    scene = problem.scene
    if len(scene.beams) > 1:
        return "for several beams"
    if scene.mirror is not None:
        return "with a mirror"
    if not separately(scene, scene.beams):
        return "with a wall that reflects light"
    if not scene.plain:
        return "for a beam that is not upwards through the origin, moves or changes"
    if scene.forces.dlvo is not None:
        return "with forces.dlvo"
    if np.linalg.norm(held.position) >= min(reach, scene.simulation.loss_distance):
        return "for an equilibrium beyond simulation.loss_distance"
    if not isinstance(held, Ring) and np.any(held.position[:2] != 0):
        return "for an equilibrium off the axis"
    if (quality := _quality(problem, held)) > _LITTLE_DRAG:
        return (
            f"as inertia carries the bead: sqrt(k m)/drag = {quality:.2g} is above {_LITTLE_DRAG}, "
            "where escape is no diffusion (Kramers's regime of low friction); "
            "a run with forces.brownian = true has it"
        )
    return ""


def _region(problem: Problem, radius: float) -> Region:
    """Return the region within `radius`, m, of the focus and between the walls of the scene."""
    scene = problem.scene
    finest = _FINE_RADII * scene.body.size + _FINE_SAMPLES * problem.light.search.spacing
    low, high = -math.inf, math.inf
    for position, normal in scene.wall.planes if scene.wall else ():
        touching = position + normal * (1 + _BESIDE_WALL) * scene.body.support(normal)
        low, high = (touching, high) if normal > 0 else (low, touching)
    return Region(radius, finest, low, high)


def _field(problem: Problem, start: tuple[float, float], side: int, *, dark: bool = False) -> Field:
    """Return the field of force and mobility in the half plane along x (`side` 0) or y (1).

    Without a wall the mobility is uniform, computed at the height of `start` (rho, z), m. If
    `dark`, the force of the light is omitted.
    """
    weight = problem.bead.weight[2]
    free = problem.mobilities(np.array([[0.0, 0.0, start[1]]]))[0]

    def field(rho: Array, z: Array) -> tuple[Array, Array, Array, Array]:
        """Return forces, N, and mobilities, s/kg, across and along the axis (see `Field`)."""
        places = np.zeros((len(rho), 3))
        places[:, side], places[:, 2] = rho, z
        force = np.zeros_like(places) if dark else sampled(problem.scene, places)[0]
        for each in problem.beside_the_light_apart:
            force = force + each.field(places).force
        mobile = np.broadcast_to(free, (len(rho), len(free)))
        if not problem.drag.uniform:
            mobile = problem.mobilities(places)
        return force[:, side], force[:, 2] + weight, mobile[:, side], mobile[:, 2]

    return field


def _least_work(region: Region, field: Field, start: tuple[float, float]) -> float:
    """Return the smallest work, J, on the straight ways from `start` out of a region.

    `start` is (rho, z), m. The ways lead along both coordinates, to the end of the region, to a
    wall, or to the axis.
    """
    rho, height = start
    to_side = np.linspace(rho, math.sqrt(region.radius**2 - height**2), _WAY)
    rim = math.sqrt(region.radius**2 - rho**2)
    still = np.zeros(_WAY)
    up, down = (
        np.linspace(height, min(max(end, region.low), region.high), _WAY) for end in (rim, -rim)
    )
    ways = [
        (to_side, field(to_side, still + height)[0]),
        (up, field(still + rho, up)[1]),
        (down, field(still + rho, down)[1]),
    ]
    if rho > 0:
        inwards = np.linspace(rho, 0.0, _WAY)
        ways.append((inwards, field(inwards, still + height)[0]))
    return min(
        # the work against the force is largest at the barrier, where its integral is smallest
        -float(np.cumsum((force[1:] + force[:-1]) / 2 * np.diff(x)).min())
        for x, force in ways
    )


def _log_escape_time(
    region: Region, field: Field, start: tuple[float, float], energy: float
) -> tuple[float, float]:
    """Return the logarithm of the mean time to escape from `start`, and its error.

    start: (rho, z), m. energy: k_B T, J. The time is in s. If the error is large, the time is
    computed again on a finer grid, because a heavy bead may be held far from the focus, or in a
    narrow region.
    """
    log, error = _extrapolated(region, field, start, energy)
    if error > _ENOUGH:
        return _extrapolated(region.finer(start[1]), field, start, energy)
    return log, error


def _extrapolated(
    region: Region, field: Field, start: tuple[float, float], energy: float
) -> tuple[float, float]:
    """Return the logarithm of the mean time in s, extrapolated to infinitely close nodes.

    It follows from the times on the nodes of the region and on every other node, whose errors
    differ by a factor of 4. Also returns the error. `start` is (rho, z), m, and `energy` k_B T, J.
    """
    grid = Grid.of(region, field, energy)
    fine = mean_time(grid, region, start, energy)
    coarse = mean_time(grid.coarse(), region, start, energy)
    if not math.isfinite(max(fine, coarse)):
        return math.inf, 0.0
    correction = math.log(fine / coarse) / 3
    return math.log(fine) + correction, _OF_CORRECTION * abs(correction)
