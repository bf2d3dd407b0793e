"""Equilibria: positions at which the forces on a bead cancel, and their stability."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tweezer.forces.force import Wrench
from tweezer.values.arrays import Array
from tweezer.values.bracketing import zero
from tweezer.values.vectors import Comparable, Vector, fixed

#: function of points (n, 3) m: all forces but drag, (n, 3) N
NetForce = Callable[[Array], Array]
#: function of points (n, 3) m: forces without drag and weight, with `gradient=True` gradients too
Field = Callable[..., Wrench]
#: function of a position (3,), m, and the stiffness there (3, 3), N/m: the rate at which a bead
#: spirals out of an equilibrium, 1/s; 0 if it comes to rest
SpiralRate = Callable[[Array, Array], float]
#: function of distances (n,) m on a line: component of the force along it, (n,) N
Component = Callable[[Array], Array]

#: Error to which a zero is located, in radii of the bead
_ZERO = 1e-14
#: Smallest pull at the start of an interval, N: rounding may make a positive pull smaller
_PULLING = 1e-300
#: Spacing of samples where they are not even, as a part of their distance from the origin
_GROWTH = 0.02
#: Largest distance of an equilibrium off the axis from the start of its search, in spacings
_NEAR = 150.0
#: Smallest distance between two equilibria, in spacings
_SAME = 0.05
#: Largest force at an equilibrium off the axis, as a part of the force beside it
_VANISHED = 1e-7
#: Smallest stiffness over the largest of an equilibrium beside the axes of the foci: on a ring, the
#: force vanishes everywhere
_FLAT = 1e-6

FOCUS = fixed((0.0, 0.0, 0.0))

DIRECTIONS: dict[str, tuple[float, float, float]] = {
    "+x": (1.0, 0.0, 0.0), "-x": (-1.0, 0.0, 0.0),
    "+y": (0.0, 1.0, 0.0), "-y": (0.0, -1.0, 0.0),
    "+z": (0.0, 0.0, 1.0), "-z": (0.0, 0.0, -1.0),
}  # fmt: skip


class Search(NamedTuple):
    """Lengths that control the search for zeros and largest values of a force, m."""

    near: float
    """distance from the origin up to which lines are sampled evenly"""
    spacing: float
    """distance between samples there"""
    beside: float
    """distance from an equilibrium at which the force must be restoring"""
    reach: float
    """distance up to which lines are searched; beyond `near` the spacing of samples grows with the
    distance"""
    coarsest: float = math.inf
    """largest distance between samples"""
    besides: tuple[float, ...] = ()
    """z of additional samples on lines along z, for example next to walls, m"""
    farthest: float = 0.0
    """largest distance on the axis at which the light may carry the weight of the bead, m"""
    known: float = math.inf
    """distance from the origin up to which the force is known, m"""

    def edges(self, end: float, samples: float = 1.0) -> Array:
        """Return positions on a line from 0 to `end`, m: one for every `samples` samples."""
        evenly = min(end, self.near)
        count = math.ceil(evenly / (samples * self.spacing) * (1 - 1e-9))
        near = np.linspace(0.0, evenly, count + 1)
        if end <= self.near * (1 + 1e-9):
            return near
        widest, last, far = samples * self.coarsest, self.near, []
        while last < end:
            last += min(samples * _GROWTH * last, widest)
            far.append(last)
        return np.append(near, np.array(far) * (end / last))

    def to_the_end(self, origin: Array, direction: str) -> float:
        """Return the distance from `origin` to the end of the reach or of the known force, m."""
        if math.isinf(self.known):
            return self.reach
        ahead = float(origin @ np.array(DIRECTIONS[direction]))
        left = self.known**2 - float(origin @ origin)
        return min(self.reach, math.sqrt(max(left + ahead**2, 0.0)) - ahead)

    def line(self) -> Array:
        """Return the samples of a line from 0 to the reach, (n,) m."""
        return self.edges(self.reach)

    def whole_line(self) -> Array:
        """Return the samples of a line on both sides of 0, up to the reach, (n,) m."""
        ahead = self.line()
        return np.concatenate([-ahead[:0:-1], ahead])


@dataclass(frozen=True, eq=False)
class Equilibrium(Comparable):
    """A position at which all forces except drag cancel."""

    position: Vector
    """(3,) m from the focus"""
    stable: bool
    """whether a displaced bead returns to it. Three conditions apply: all eigenvalues of
    `stiffness` have positive real parts, the force is restoring at the distance `Search.beside`
    along every axis, and the linear motion with the inertia of the scene's model does not grow
    (`spiral_rate`)"""
    stiffness: Vector
    """matrix k_ij = -dF_i/dx_j, (3, 3) N/m, from the gradient of the force; may be asymmetric"""
    eigenvalues: Vector
    """(3,) N/m, real parts of the eigenvalues of k in ascending order; divided by beta_v, they are
    relaxation rates (5.2)"""
    residual: float
    """magnitude of the remaining force, N"""
    spiral_rate: float = 0.0
    """growth rate of a spiral motion away from the equilibrium, 1/s, which occurs if inertia and
    the azimuthal force of the light outweigh the drag; otherwise 0"""

    @property
    def stiffness_xyz(self) -> Array:
        """The trap stiffness along x, y and z: k_xx, k_yy, k_zz, (3,) N/m."""
        return fixed(np.diag(self.stiffness))

    @property
    def turn(self) -> float:
        """Stiffness (dF_y/dx - dF_x/dy)/2, N/m, with which the light pushes a bead around the axis.

        It is half the circulation of the force about the axis, per area, and zero if the force has
        a potential.
        """
        return float(self.stiffness[0, 1] - self.stiffness[1, 0]) / 2


def nearest_stable(every: Iterable[Equilibrium]) -> Equilibrium | None:
    """Return the stable equilibrium nearest the focus; None if none is stable."""
    stable = (place for place in every if place.stable)
    return min(stable, key=lambda place: math.hypot(*place.position), default=None)


def equilibria(
    radius: float, search: Search, field: Field, net_force: NetForce, spiral_rate: SpiralRate
) -> Iterator[Equilibrium]:
    """Yield the equilibria on the axis, at which the net force changes its sign.

    Parameters
    ----------
    radius : float
        Radius of the bead, m.
    search : Search
        Lengths of the search.
    field : callable
        Force whose gradient is the stiffness.
    net_force : callable
        Sum of all forces but drag.
    spiral_rate : callable
        Rate of a growing spiral about a position, see `SpiralRate`.
    """
    for z in _zeros_on_axis(FOCUS, radius, search, net_force):
        yield equilibrium_at(np.array([0.0, 0.0, z]), search, field, net_force, spiral_rate)


def equilibria_about(
    foci: Array,
    radius: float,
    search: Search,
    field: Field,
    net_force: NetForce,
    spiral_rate: SpiralRate,
    beside: Iterable[Array] = (),
) -> Iterator[Equilibrium]:
    """Yield the equilibria near the axes of several foci, and stable ones beside them.

    Newton's method (`scipy.optimize.root`) starts at each focus and at every sign change of the
    axial force on its axis. The axis is searched at least as far as the other foci.

    Parameters
    ----------
    foci : ndarray, shape (n, 3)
        The foci, m.
    radius : float
        Radius of the bead, m.
    search : Search
        Lengths of the search.
    field : callable
        Force whose gradient is the stiffness.
    net_force : callable
        Sum of all forces but drag.
    spiral_rate : callable
        Rate of a growing spiral about a position, see `SpiralRate`.
    beside : iterable of ndarray, shape (3,), optional
        Further positions at which Newton's method starts, m.
    """
    apart = np.linalg.norm(foci[:, None] - foci, axis=2).max()
    search = search._replace(reach=min(max(search.reach, float(apart)), search.known / 2))
    found: list[Array] = []

    def new(start: Array) -> Array | None:
        """Return the zero of the force near a position, unless it is known already."""
        place = _vanishing(start, radius, search, field, net_force)
        if place is None or any(
            np.linalg.norm(place - other) < _SAME * search.spacing for other in found
        ):
            return None
        found.append(place)
        return place

    for focus in foci:
        zeros = [0.0, *_zeros_on_axis(focus, radius, search, net_force)]
        for start in focus + np.outer(zeros, [0.0, 0.0, 1.0]):
            if (place := new(start)) is not None:
                yield equilibrium_at(place, search, field, net_force, spiral_rate)
    for start in beside:
        if any(np.linalg.norm(start - other) < search.spacing for other in found):
            continue
        if (place := new(start)) is not None:
            there = equilibrium_at(place, search, field, net_force, spiral_rate)
            if there.stable and there.eigenvalues[0] > _FLAT * there.eigenvalues[2]:
                yield there


def _zeros_on_axis(
    focus: Array, radius: float, search: Search, net_force: NetForce
) -> Iterator[float]:
    """Yield where the axial force changes its sign on the axis through a focus, m from there.

    radius: of the bead, m.
    """
    axial = along(net_force, focus, "+z")
    z = np.union1d(search.whole_line(), np.array(search.besides) - focus[2])
    sign = np.sign(axial(z))
    z, sign = z[sign != 0], sign[sign != 0]
    opposed = np.flatnonzero(sign[:-1] * sign[1:] < 0)  # not where a force is undefined
    changes = [(z[i], z[i + 1], sign[i]) for i in opposed]
    for below, above, before in changes + list(_far_changes(axial, search)):
        pull = axial if before > 0 else opposite(axial)
        yield end_of_pull(pull, below, above, _ZERO * radius)


def _far_changes(axial: Component, search: Search) -> Iterator[tuple[float, float, float]]:
    """Yield intervals beyond the reach in which the light ceases to carry the weight of the bead.

    Each is given by its ends, m, and the sign of the axial force at the lower one.

    Far from the focus light fades and weight is left. So the force on an axis that light still
    decides at the reach changes its sign beyond, up to where a bead is lost at most.
    """
    if search.farthest <= search.reach:
        return
    ends = search.reach * np.append(
        2.0 ** np.arange(math.ceil(math.log2(search.farthest / search.reach))),
        search.farthest / search.reach,
    )
    for side in (-1.0, 1.0):
        signs = np.sign(axial(side * ends))
        for i in np.flatnonzero(signs[:-1] * signs[1:] < 0):
            low, high = sorted((side * ends[i], side * ends[i + 1]))
            yield low, high, float(signs[i] if side > 0 else signs[i + 1])


def _vanishing(
    start: Array, radius: float, search: Search, field: Field, net_force: NetForce
) -> Array | None:
    """Return the position near `start` (3,), m, where the net force vanishes; None if none does.

    radius: of the bead, m, the unit of length of Newton's method.
    """
    from scipy.optimize import root

    size = float(np.linalg.norm(net_force(start + radius * np.eye(3)), axis=1).max())
    if size == 0.0:
        return None

    def scaled(place: Array) -> Array:
        """Return the net force at a position in bead radii, in units of `size`."""
        if np.linalg.norm(radius * place) > search.known:
            raise AstrayError
        return net_force(radius * place[None])[0] / size

    def gradient(place: Array) -> Array:
        """Return the derivative of `scaled`; the weight has none."""
        return field(radius * place[None], gradient=True).force_gradient[0] * radius / size

    try:
        found = root(scaled, start / radius, jac=gradient, tol=_ZERO)
    except AstrayError:
        return None
    place: Array = found.x * radius
    near = np.linalg.norm(place - start) < _NEAR * search.spacing
    return place if near and np.abs(scaled(found.x)).max() < _VANISHED else None


class AstrayError(Exception):
    """Newton's method has left the region of the search."""


def equilibrium_at(
    place: Array, search: Search, field: Field, net_force: NetForce, spiral_rate: SpiralRate
) -> Equilibrium:
    """Return the equilibrium at a position where the net force vanishes.

    Parameters
    ----------
    place : ndarray, shape (3,)
        Position, m.
    search : Search
        Lengths of the search for equilibria.
    field : Field
        All forces but drag and weight.
    net_force : NetForce
        Sum of all forces but drag.
    spiral_rate : SpiralRate
        Growth rate of the linear motion about a position with a stiffness.

    Returns
    -------
    Equilibrium
        Position, stiffness and stability.
    """
    stiffness = -field(place[None], gradient=True).force_gradient[0]
    eigenvalues = np.sort(np.linalg.eigvals(stiffness).real)
    steps = search.beside * np.array(list(DIRECTIONS.values()))
    pulled_back = eigenvalues[0] > 0 and ((net_force(place + steps) * steps).sum(axis=1) < 0).all()
    spiral = spiral_rate(place, stiffness) if pulled_back else 0.0
    return Equilibrium(
        position=fixed(place),
        stable=bool(pulled_back and spiral == 0),
        stiffness=fixed(stiffness),
        eigenvalues=fixed(eigenvalues),
        residual=float(np.linalg.norm(net_force(place[None]))),
        spiral_rate=spiral,
    )


def along(force: NetForce, origin: Array, direction: str) -> Component:
    """Return the component of a force along a line, as a function of the distance on it, m.

    The line begins at `origin`, (3,) m. `direction` is a name in `DIRECTIONS`, such as "+x".
    """
    start, unit = origin, np.array(DIRECTIONS[direction])

    def component(distances: Array) -> Array:
        """Return the force along the line at distances from its origin."""
        return force(start + np.multiply.outer(distances, unit)) @ unit

    return component


def opposite(component: Component) -> Component:
    """Return the component of a force with the opposite sign."""
    return lambda distances: -component(distances)


def end_of_pull(pull: Component, start: float, stop: float, tolerance: float) -> float:
    """Return the distance at which a pull ceases to be positive, m.

    Parameters
    ----------
    pull : callable
        Pull at a distance. It is positive from `start` on, except for rounding.
    start, stop : float
        Range of distances, m.
    tolerance : float
        Tolerance of the distance, m.
    """

    def pulls(distance: float) -> float:
        """Return the pull at one distance, N; above 0 at the start even if rounding denies it."""
        value = float(pull(np.array([distance]))[0])
        return max(value, _PULLING) if distance == start else value

    return zero(pulls, start, stop, tolerance)
