"""Rings around the beam axis on which the light holds a bead, and equilibria off the axis.

In light with rotational symmetry, the radial and axial forces depend only on z and on the distance
rho from the axis. If both vanish at a point, they vanish on a ring. The azimuthal force on the ring
may differ from zero: light with angular momentum drives the bead around the axis, at the speed v at
which drag balances this force. The force towards the axis then provides the centripetal force,

    F_rho = -m v^2/rho,    F_z = 0,    v = F_phi/beta_v.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.forces.equilibria import AstrayError, NetForce
from tweezer.forces.force import Force
from tweezer.values.arrays import Array
from tweezer.values.printed import printed
from tweezer.values.vectors import Comparable, Vector, fixed

#: Number of samples from the axis to the rim of the box, and of heights per focal depth
_ACROSS, _ALONG = 24, 6
#: Radius of a ring below which it is a point on the axis, in radii of the bead
_ON_AXIS = 1e-3
#: Largest force left on a ring, as a part of the force beside it
_VANISHED = 1e-7
#: Distance below which two positions are the same, in radii of the bead
_SAME = 1e-3
#: Smallest ratio of two rates, of the velocity's and of the position's relaxation, at which inertia
#: has no effect
_MASSLESS = 1e4


class Box(NamedTuple):
    """Region of intense light around the axis, in which rings and equilibria are searched, m."""

    width: float
    """distance from the axis"""
    depth: float
    """distance along the axis over which the light changes"""
    reach: float
    """distance from the focus along the axis"""
    spread: float = 0.0
    """increase of the width with the distance from the focus (tangent of an angle)"""
    known: float = math.inf
    """distance from the focus up to which the force is known"""

    def nodes(self) -> tuple[Array, Array]:
        """Return rho and z of samples in the box, m: two arrays (heights, distances)."""
        count = 2 * math.ceil(self.reach / self.depth * _ALONG) + 1
        z = np.linspace(-self.reach, self.reach, count)[:, None]
        rho = np.linspace(0.0, 1.0, _ACROSS + 1)[1:] * (self.width + np.abs(z) * self.spread)
        return rho, np.broadcast_to(z, rho.shape)

    @property
    def words(self) -> str:
        """Extent of the box in words, for a message."""
        rim = self.width + self.reach * self.spread
        reach = printed(self.reach, "um", 3)
        return f"{printed(rim, 'um', 3)} from the axis and {reach} from the focus"


class Motion(NamedTuple):
    """Mass and mobility of a bead that moves on a ring."""

    mass: float
    """mass that moves with the bead, kg; 0 in a model without inertia"""
    mobility: Callable[[Array], Array]
    """function that returns the mobilities perpendicular and parallel to the axis, (n, 2) s/kg, at
    positions (n, 3) m"""
    beside: float
    """distance from a ring at which the force must be restoring, m"""


@dataclass(frozen=True, eq=False)
class Ring(Comparable):
    """A ring around the axis on which light holds a bead."""

    radius: float
    """m"""
    height: float
    """z of the ring, relative to the focus, m"""
    stiffness: Vector
    """matrix -dF_i/dx_j for rho and z, (2, 2) N/m; in general not symmetric"""
    azimuthal_force: float
    """force of the light along the ring, N; positive if counter-clockwise, seen against the
    light"""
    speed: float
    """speed of the bead on the ring, m/s: the azimuthal force divided by the drag coefficient"""
    residual: float
    """magnitude of the remaining force perpendicular to the ring, N"""
    escapes: tuple[Any, ...] = ()
    """escapes from the ring along straight lines: outwards, inwards, +z, -z"""

    @property
    def position(self) -> Array:
        """Point of the ring at y = 0, (3,) m from the focus."""
        return fixed((self.radius, 0.0, self.height))

    @property
    def stiffness_across(self) -> Array:
        """Stiffness along rho and along z, (2,) N/m."""
        return fixed(np.diag(self.stiffness))

    @property
    def rate(self) -> float:
        """Frequency at which the bead circles the axis, Hz."""
        return self.speed / (2 * math.pi * self.radius)


def rings(
    radius: float, box: Box, force: Force, net_force: NetForce, motion: Motion
) -> Iterator[Ring]:
    """Yield the stable rings in a box, nearest the focus first.

    Newton's method (`scipy.optimize.root`) determines their radius and height. It starts in each
    cell of samples in which both forces change their sign.

    Parameters
    ----------
    radius : float
        Radius of the bead, m.
    box : Box
        Box to search.
    force : Force
        Force with a gradient.
    net_force : NetForce
        Sum of all forces but drag.
    motion : Motion
        Properties of the bead for the motion on a ring.
    """
    found: list[Array] = []
    for start in _starts(box, net_force, np.array([1.0, 0.0])):
        place = ring_near(start, radius, force, net_force, motion, box.known)
        if place is not None and all(np.abs(place - each).max() > _SAME * radius for each in found):
            found.append(place)
    for place in sorted(found, key=lambda each: math.hypot(*each)):
        if ring := held_on(place, force, net_force, motion):
            yield ring


def off_axis(radius: float, box: Box, force: Force, net_force: NetForce) -> Iterator[Array]:
    """Yield positions (3,) off the axis, m, where the net force vanishes.

    This applies to light without rotational symmetry. The search starts in half planes at 0, 45, 90
    and 135 degrees. Positions occur in pairs, because the light is symmetric under half a turn.

    Parameters
    ----------
    radius, box, force, net_force
        As in `rings`.
    """
    found: list[Array] = []
    for angle in np.pi * np.arange(4) / 4:
        to_side = np.array([math.cos(angle), math.sin(angle)])
        for rho, z in _starts(box, net_force, to_side):
            start = np.append(rho * to_side, z)

            def balance(place: Array) -> tuple[Array, Array]:
                """Return the net force at a position, N, and the gradient of the light's, N/m."""
                field = force.field(place[None], gradient=True)
                return net_force(place[None])[0], field.force_gradient[0]

            size = _size(start, radius, net_force)
            place = _balanced(start, balance, radius, size, box.width, box.known)
            if place is None or math.hypot(*place[:2]) < _ON_AXIS * radius:
                continue
            for each in (place, place * [-1, -1, 1]):
                if all(np.linalg.norm(each - other) > _SAME * radius for other in found):
                    found.append(each)
                    yield each


def _starts(box: Box, net_force: NetForce, to_side: Array) -> Iterator[Array]:
    """Yield the middles (rho, z), m, of cells of samples in which both forces change their sign.

    The forces are those across and along the axis, in the half plane through the axis along the
    unit vector `to_side`, (2,).
    """
    rho, z = box.nodes()
    places = np.stack([rho * to_side[0], rho * to_side[1], z], axis=-1)
    force = net_force(places.reshape(-1, 3)).reshape(places.shape)
    across, along = force[..., :2] @ to_side, force[..., 2]

    def changes(values: Array) -> NDArray[np.bool_]:
        """Return for each cell whether values at its four corners have both signs."""
        corners = [values[i : i + len(values) - 1, j : j + _ACROSS - 1]
                   for i in (0, 1) for j in (0, 1)]  # fmt: skip
        return (np.min(corners, axis=0) < 0) & (np.max(corners, axis=0) > 0)

    for i, j in zip(*np.nonzero(changes(across) & changes(along)), strict=True):
        yield np.array([rho[i : i + 2, j : j + 2].mean(), z[i : i + 2, j : j + 2].mean()])


def _size(start: Array, radius: float, net_force: NetForce) -> float:
    """Return the largest force one bead radius, m, from a position `start`, N.

    It is the unit of the forces that Newton's method makes vanish.
    """
    return float(np.linalg.norm(net_force(start + radius * np.eye(3)), axis=1).max())


def ring_near(
    start: Array,
    radius: float,
    force: Force,
    net_force: NetForce,
    motion: Motion,
    known: float,
) -> Array | None:
    """Return radius and height of the ring near `start` on which the forces cancel, or None.

    Parameters
    ----------
    start : ndarray, shape (2,)
        First guess of radius and height, m.
    radius, force, net_force, motion
        As in `rings`.
    known : float
        Distance from the focus up to which the force is known, m.

    Returns
    -------
    ndarray, shape (2,), or None
        Radius and height, m.
    """

    def balance(place: Array) -> tuple[Array, Array]:
        """Return the forces across and along the axis at (rho, z), and their derivatives.

        The centripetal force is subtracted: the force round the axis moves the bead against drag.
        """
        rho, z = place
        if rho <= 0:
            raise AstrayError
        at = np.array([[rho, 0.0, z]])
        (across, around, along), mobility = net_force(at)[0], motion.mobility(at)[0, 0]
        gradient = force.field(at, gradient=True).force_gradient[0]
        slopes = gradient[np.ix_([0, 2], [0, 2])]
        outwards = motion.mass * mobility**2 / rho
        slopes[0] += outwards * (2 * around * gradient[1, [0, 2]] - [around**2 / rho, 0.0])
        return np.array([across + outwards * around**2, along]), slopes

    size = _size(np.array([start[0], 0.0, start[1]]), radius, net_force)
    place = _balanced(start, balance, radius, size, radius + float(start[0]), known)
    return None if place is None or place[0] < _ON_AXIS * radius else place


def _balanced(
    start: Array,
    balance: Callable[[Array], tuple[Array, Array]],
    radius: float,
    size: float,
    farthest: float,
    known: float,
) -> Array | None:
    """Return the position near `start` where forces vanish, by Newton's method, or None.

    `balance` returns the forces, N, and their gradient, N/m, at a position. `size` is the magnitude
    of the forces around the start, N. The search ends at the distance `farthest` from the start and
    `known` from the focus, m; `radius` belongs to the bead, m.
    """
    from scipy.optimize import root

    if size == 0.0:
        return None

    def scaled(place: Array) -> tuple[Array, Array]:
        """Return forces and gradient in units of `size` and of the bead's radius."""
        there = radius * place
        if np.linalg.norm(there - start) > farthest or np.linalg.norm(there) > known:
            raise AstrayError
        forces, gradient = balance(there)
        return forces / size, gradient * (radius / size)

    try:
        solved = root(scaled, start / radius, jac=True, tol=1e-14)
    except AstrayError:
        return None
    place: Array = solved.x * radius
    return place if np.abs(solved.fun).max() < _VANISHED else None


def held_on(place: Array, force: Force, net_force: NetForce, motion: Motion) -> Ring | None:
    """Return the ring at a radius and a height, or None if a bead does not stay on it.

    Parameters
    ----------
    place : ndarray, shape (2,)
        Radius and height, m.
    force, net_force, motion
        As in `rings`.
    """
    rho, z = place
    at = np.array([[rho, 0.0, z]])
    (across, around, along), (b, b_z) = net_force(at)[0], motion.mobility(at)[0]
    gradient = force.field(at, gradient=True).force_gradient[0]
    slopes = gradient[np.ix_([0, 2], [0, 2])]
    speed = b * around
    m = motion.mass
    slow = np.linalg.eigvals(np.array([[b], [b_z]]) * slopes)
    steps = motion.beside * np.array([[1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1]])
    beside = net_force(at + steps) + np.array([m * speed**2 / rho, 0, 0])
    if not (slow.real.max() < 0 and ((beside * steps).sum(axis=1) < 0).all()):
        return None
    if m and 1 / (m * max(b, b_z)) < _MASSLESS * np.abs(slow).max():
        turn = speed / rho
        # rho, z, and the speeds along rho, around the axis and along z
        matrix = np.array(
            [
                [0, 0, 1, 0, 0],
                [0, 0, 0, 0, 1],
                [slopes[0, 0] / m - turn**2, slopes[0, 1] / m, -1 / (m * b), 2 * turn, 0],
                [gradient[1, 0] / m, gradient[1, 2] / m, -turn, -1 / (m * b), 0],
                [slopes[1, 0] / m, slopes[1, 1] / m, 0, 0, -1 / (m * b_z)],
            ]
        )
        if not np.linalg.eigvals(matrix).real.max() < 0:
            return None
    return Ring(
        radius=float(rho),
        height=float(z),
        stiffness=fixed(-slopes),
        azimuthal_force=float(around),
        speed=float(speed),
        residual=math.hypot(across + m * speed**2 / rho, along),
    )
