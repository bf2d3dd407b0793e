"""Where the forces on a bead cancel, and whether they hold the bead there."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.forces.force import Force

Array = NDArray[np.float64]
Point = tuple[float, float, float]
Tensor = tuple[Point, Point, Point]
#: force, N, at points (n, 3) m; and its component along a line, N, at distances (n,) m on it
NetForce = Callable[[Array], Array]
Component = Callable[[Array], Array]

#: to how much a zero is located, in radii
_ZERO = 1e-14
#: Smallest tolerance that `scipy.optimize.brentq` takes
_ROUNDING = 4 * np.finfo(float).eps
#: Pull where there is one by definition, N
_PULLING = 1e-300
#: distances of samples from where it is sought that an equilibrium off the axis may be
_NEAR = 150.0
#: distances of samples between two places that are two equilibria
_SAME = 0.05
#: part of the force beside it that may be left at an equilibrium off the axis
_VANISHED = 1e-7

FOCUS: Point = (0.0, 0.0, 0.0)

DIRECTIONS: dict[str, Point] = {
    "+x": (1.0, 0.0, 0.0), "-x": (-1.0, 0.0, 0.0),
    "+y": (0.0, 1.0, 0.0), "-y": (0.0, -1.0, 0.0),
    "+z": (0.0, 0.0, 1.0), "-z": (0.0, 0.0, -1.0),
}  # fmt: skip


class Search(NamedTuple):
    """Lengths by which a force is searched for its zeros and its largest values, m."""

    reach: float
    """how far lines are searched"""
    spacing: float
    """distance of samples on them"""
    beside: float
    """distance from an equilibrium at which the force must pull back"""
    besides: tuple[float, ...] = ()
    """z, m from the origin, of more samples on lines along z: next to walls, say"""

    def line(self) -> Array:
        """Samples from 0 to the reach, m."""
        return np.linspace(0.0, self.reach, math.ceil(self.reach / self.spacing * (1 - 1e-9)) + 1)

    def whole_line(self) -> Array:
        """Samples on both sides of 0, m."""
        ahead = self.line()
        return np.concatenate([-ahead[:0:-1], ahead])


@dataclass(frozen=True)
class Equilibrium:
    """A place where all forces but drag cancel."""

    position: Point
    """m from the focus"""
    stable: bool
    """whether a bead beside it returns: every eigenvalue of dF_i/dx_j has a negative real part, and
    `Search.beside` off it along every axis the force pulls back"""
    stiffness: Tensor
    """k_ij = -dF_i/dx_j, N/m, the light's own derivative; not symmetric in general"""
    eigenvalues: Point
    """real parts of the eigenvalues of k, rising, N/m; over beta_v the rates of return (5.2)"""
    residual: float
    """size of the force left there, N"""

    @property
    def turn(self) -> float:
        """(dF_y/dx - dF_x/dy)/2, N/m: how stiffly the light pushes a bead off the axis round it.

        It is half the circulation of the force about the axis, per area, and zero where the force
        has a potential.
        """
        return (self.stiffness[0][1] - self.stiffness[1][0]) / 2


def nearest_stable(every: Iterable[Equilibrium]) -> Equilibrium | None:
    """The stable one nearest the focus."""
    stable = (place for place in every if place.stable)
    return min(stable, key=lambda place: math.hypot(*place.position), default=None)


def equilibria(
    radius: float, search: Search, force: Force, net_force: NetForce
) -> Iterator[Equilibrium]:
    """Every change of sign of the net force along the axis, within the reach of the search.

    radius: of the bead, m. force: whose gradient is the stiffness.
    """
    for zero in _zeros_on_axis(FOCUS, radius, search, net_force):
        yield _equilibrium(np.array([0.0, 0.0, zero]), search, force, net_force)


def equilibria_about(
    foci: Array, radius: float, search: Search, force: Force, net_force: NetForce
) -> Iterator[Equilibrium]:
    """Places near the axis of each focus, (n, 3) m, where the net force vanishes.

    They are sought by Newton's method (`scipy.optimize.root`) from the focus and from every change
    of sign of the axial force on its axis, which is searched up to the other foci at least.
    """
    apart = np.linalg.norm(foci[:, None] - foci, axis=2).max()
    search = search._replace(reach=max(search.reach, float(apart)))
    found: list[Array] = []
    for focus in foci:
        zeros = [0.0, *_zeros_on_axis(point(focus), radius, search, net_force)]
        for start in focus + np.outer(zeros, [0.0, 0.0, 1.0]):
            place = _vanishing(start, radius, search, force, net_force)
            if place is not None and all(
                np.linalg.norm(place - other) > _SAME * search.spacing for other in found
            ):
                found.append(place)
                yield _equilibrium(place, search, force, net_force)


def _zeros_on_axis(
    focus: Point, radius: float, search: Search, net_force: NetForce
) -> Iterator[float]:
    """Changes of sign of the axial force along the axis through a focus, m from there."""
    axial = along(net_force, focus, "+z")
    z = np.union1d(search.whole_line(), np.array(search.besides) - focus[2])
    sign = np.sign(axial(z))
    z, sign = z[sign != 0], sign[sign != 0]
    for i in np.flatnonzero(np.diff(sign)):
        rising = sign[i + 1] > 0
        pull = opposite(axial) if rising else axial
        yield end_of_pull(pull, z[i], z[i + 1], _ZERO * radius)


def _vanishing(
    start: Array, radius: float, search: Search, force: Force, net_force: NetForce
) -> Array | None:
    """The place near `start` where the net force vanishes; None if there is none."""
    from scipy.optimize import root

    size = float(np.linalg.norm(net_force(start + radius * np.eye(3)), axis=1).max())
    if size == 0.0:
        return None

    def scaled(place: Array) -> Array:
        return net_force(radius * place[None])[0] / size

    def gradient(place: Array) -> Array:
        return force.field(radius * place[None], gradient=True).force_gradient[0] * radius / size

    found = root(scaled, start / radius, jac=gradient, tol=_ZERO)
    place: Array = found.x * radius
    near = np.linalg.norm(place - start) < _NEAR * search.spacing
    return place if near and np.abs(scaled(found.x)).max() < _VANISHED else None


def _equilibrium(place: Array, search: Search, force: Force, net_force: NetForce) -> Equilibrium:
    """What there is to know about a place where the net force vanishes, (3,) m."""
    gradient = force.field(place[None], gradient=True).force_gradient[0]
    eigenvalues = np.sort(np.linalg.eigvals(-gradient).real)
    steps = search.beside * np.array(list(DIRECTIONS.values()))
    pulled_back = ((net_force(place + steps) * steps).sum(axis=1) < 0).all()
    return Equilibrium(
        position=point(place),
        stable=bool(eigenvalues[0] > 0 and pulled_back),
        stiffness=tuple(point(-row) for row in gradient),  # type: ignore[arg-type]
        eigenvalues=point(eigenvalues),
        residual=float(np.linalg.norm(net_force(place[None]))),
    )


def along(force: NetForce, origin: Point, direction: str) -> Component:
    """Component along `direction` of the force, at distances (m) from `origin` along it."""
    start, unit = np.array(origin), np.array(DIRECTIONS[direction])

    def component(distances: Array) -> Array:
        return force(start + np.multiply.outer(distances, unit)) @ unit

    return component


def opposite(component: Component) -> Component:
    """Of the other sign."""
    return lambda distances: -component(distances)


def end_of_pull(pull: Component, start: float, stop: float, tolerance: float) -> float:
    """Where `pull` ceases to be positive, between `start`, from which on it is, and `stop`."""
    from scipy.optimize import brentq

    def pulls(distance: float) -> float:
        value = float(pull(np.array([distance]))[0])
        return max(value, _PULLING) if distance == start else value

    return float(brentq(pulls, start, stop, xtol=tolerance, rtol=_ROUNDING))


def point(values: Array) -> Point:
    """Three numbers as a tuple of Python's."""
    return tuple(float(value) for value in values)  # type: ignore[return-value]
