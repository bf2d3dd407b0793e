"""Escape of a bead from its trap along a straight line: force, range and work."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from tweezer.forces.equilibria import (
    DIRECTIONS,
    Component,
    NetForce,
    Search,
    along,
    end_of_pull,
    opposite,
)
from tweezer.scene import Scene
from tweezer.scene.interference import bounds
from tweezer.values.arrays import Array
from tweezer.values.bracketing import maximum
from tweezer.values.constants import Boltzmann

#: Depth of a well, in k_B T, below which thermal motion carries a bead off as if it were not there
LEAST_DEPTH = 1.0
#: Tolerance of the end of the pull, in radii
_END = 1e-10
#: Tolerance of the place of a maximum, in distances of samples
_MAXIMUM = 5e-7
#: Part of the largest restoring force at which the range of a trap ends
FAINT = 0.05
#: Tolerance of that range, in distances of samples
_FAINT_END = 1e-3
#: Relative tolerance of the work
_WORK = 1e-7
#: Length of a panel of the work, in distances of samples
_PANEL = 10.0
#: Number of times that panels of the work are halved, and of their places in all
_HALVINGS, _MOST_PLACES = 12, 20_000
#: Ratio of the error of Kronrod's rule to the difference of both rules, to the power 3/2
#: (Piessens et al., QUADPACK, 1983)
_SHARPER = 200.0

# Gauss's rule with 7 nodes and Kronrod's with 15, on [-1, 1] (Kronrod 1965): the nodes that are not
# negative, and the weights of both
_KRONROD = np.array([
    [0.000000000000000000, 0.209482141084727828, 0.417959183673469388],
    [0.207784955007898468, 0.204432940075298892, 0.0],
    [0.405845151377397167, 0.190350578064785410, 0.381830050505118945],
    [0.586087235467691130, 0.169004726639267903, 0.0],
    [0.741531185599394440, 0.140653259715525919, 0.279705391489276668],
    [0.864864423359769073, 0.104790010322250184, 0.0],
    [0.949107912342758525, 0.063092092629978553, 0.129484966168869693],
    [0.991455371120812640, 0.022935322010529225, 0.0],
])  # fmt: skip
_NODES = np.concatenate([-_KRONROD[:0:-1, 0], _KRONROD[:, 0]])
_WEIGHTS = np.concatenate([_KRONROD[:0:-1, 1:], _KRONROD[:, 1:]]).T


@dataclass(frozen=True)
class Escape:
    """Escape of the bead from an equilibrium along a straight line."""

    direction: str
    """"+x" to "-z\""""
    force: float
    """escape force, N: the largest restoring force on the line. A larger steady force removes the
    bead"""
    force_at: float
    """distance from the equilibrium at which the restoring force is largest, m"""
    range: float | None
    """distance from the equilibrium beyond which the force is no longer restoring, m; None if it
    exceeds `Trap.reach`, or lies behind a wall or where the force is unknown"""
    energy: float
    """work against the force up to `range`, J; if that is None, up to `Trap.reach` or the wall"""
    energy_error: float
    """estimated integration error of `energy`, J, without the error of the force"""
    energy_kT: float
    """`energy` in k_B T of the medium"""
    wall_at: float | None
    """distance from the equilibrium at which the bead touches a wall or mirror, m, if the force is
    restoring up to there; otherwise None"""
    faint_at: float | None = None
    """distance from the equilibrium, m, at which the restoring force has decreased to 5 % of its
    largest value; None if it is larger up to `Trap.reach` or a wall"""


def too_shallow(ways: Iterable[Escape]) -> str:
    """Return the reason why a well is too shallow for a bead; "" if it is not.

    A direction in which the force is restoring up to a wall does not count as an escape.
    """
    free = [each for each in ways if each.wall_at is None]
    easiest = min(free, key=lambda each: each.energy_kT, default=None)
    if easiest is None or easiest.energy_kT >= LEAST_DEPTH:
        return ""
    return (
        f"holds no bead: the way out along {easiest.direction} takes "
        f"{max(easiest.energy_kT, 0.0):.2g} kT, less than {LEAST_DEPTH:g} kT"
    )


def escapes(
    scene: Scene, search: Search, net_force: NetForce, origin: Array, *, symmetric: bool
) -> tuple[Escape, ...]:
    """Return the escapes from an equilibrium, one for each of `DIRECTIONS`.

    Parameters
    ----------
    scene : Scene
        Scene of the trap.
    search : Search
        Lengths of the search.
    net_force : callable
        Sum of all forces but drag.
    origin : ndarray, shape (3,)
        The equilibrium, m.
    symmetric : bool
        Whether the force is rotationally symmetric about the axis and the origin on it. Then one
        lateral direction is computed for all.
    """
    found: dict[str, Escape] = {}
    for name in DIRECTIONS:
        alike = found.get("+x") if symmetric and name[1] != "z" else None
        found[name] = (
            dataclasses.replace(alike, direction=name)
            if alike else _escape(scene, search, net_force, origin, name)
        )  # fmt: skip
    return tuple(found.values())


def escapes_from_ring(
    scene: Scene, search: Search, net_force: NetForce, origin: Array
) -> tuple[Escape, ...]:
    """Return the escapes across a ring: outwards, inwards, +z and -z.

    Parameters
    ----------
    scene : Scene
        Bead, medium, lens and beam.
    search : Search
        Lengths by which the largest force is searched.
    net_force : NetForce
        Sum of all forces but drag.
    origin : ndarray, shape (3,)
        Position of the ring on the x axis, m.

    Returns
    -------
    tuple of Escape
        One escape for each direction.
    """
    ways = {"outwards": "+x", "inwards": "-x", "+z": "+z", "-z": "-z"}
    return tuple(
        dataclasses.replace(_escape(scene, search, net_force, origin, along), direction=name)
        for name, along in ways.items()
    )


def largest(component: Component, distances: Array, spacing: float) -> tuple[float, float]:
    """Return the largest value between the ends of `distances`, and its distance.

    The samples are `spacing` (m) apart.
    """
    return _refined(component, distances, component(distances), _MAXIMUM * spacing)


def _escape(
    scene: Scene, search: Search, net_force: NetForce, origin: Array, direction: str
) -> Escape:
    """Return the escape from `origin` (3,), m, along a direction, "+x" to "-z"."""
    r = scene.body.size
    pull = opposite(along(net_force, origin, direction))
    farthest = search.to_the_end(origin, direction)
    wall_at = _to_wall(scene, origin, direction, farthest)
    edges = search.edges(farthest if wall_at is None else wall_at, _PANEL)
    distances = _places(edges[:-1], edges[1:]).ravel()
    values = pull(distances)
    let_go = np.flatnonzero(values <= 0)
    end = None
    if let_go.size:
        last = let_go[0]
        start = distances[last - 1] if last else 0.0
        end = end_of_pull(pull, start, distances[last], _END * r)
        distances, values = np.append(distances[:last], end), np.append(values[:last], 0.0)
    whole = np.flatnonzero(edges <= (edges[-1] if end is None else end))
    panels = _Panels(edges[whole[:-1]], edges[whole[1:]], values[: len(_NODES) * (len(whole) - 1)])
    begun = edges[whole[-1]]
    if end is not None and end > begun:
        panels = panels.joined(_Panels.of(pull, np.array([begun]), np.array([end])))
    energy, energy_error = _integral(pull, panels)
    force, at = _refined(pull, distances, values, _MAXIMUM * search.spacing)
    past = np.flatnonzero((distances > at) & (values <= FAINT * force))
    faint_at = None
    if past.size:
        first = max(int(past[0]), 1)
        faint_at = end_of_pull(
            lambda there: pull(there) - FAINT * force, max(at, distances[first - 1]),
            distances[first], _FAINT_END * search.spacing,
        )  # fmt: skip
    return Escape(
        direction=direction,
        force=force,
        force_at=at,
        range=end,
        energy=energy,
        energy_error=energy_error,
        energy_kT=energy / (Boltzmann * scene.noise_temperature),
        wall_at=wall_at if end is None else None,
        faint_at=faint_at,
    )


def _to_wall(scene: Scene, origin: Array, direction: str, reach: float) -> float | None:
    """Return the distance from `origin` at which the bead touches a wall or mirror, m.

    It is None beyond `reach`, m.
    """
    if direction[1] != "z":
        return None
    side = 1.0 if direction[0] == "+" else -1.0
    ahead = [side * (z - origin[2]) for z, normal in bounds(scene).items() if normal == -side]
    distance = min(ahead, default=math.inf) - scene.body.support(-side)
    return distance if distance < reach else None


def _refined(
    component: Component, distances: Array, values: Array, tolerance: float
) -> tuple[float, float]:
    """Return the largest value between the ends of `distances`, and its distance within
    `tolerance`, m.

    values: the component at `distances` (n,), m.
    """
    best = int(values.argmax())
    sampled = float(values[best]), float(distances[best])
    low, high = distances[max(best - 1, 0)], distances[min(best + 1, len(distances) - 1)]
    return max(sampled, maximum(component, low, high, tolerance))


# ------------------------------------------------------------------------------------------- work


def _places(low: Array, high: Array) -> Array:
    """Return the Gauss-Kronrod nodes of panels between `low` and `high` (panels,), m: (panels,
    nodes).
    """
    return (low + high)[:, None] / 2 + (high - low)[:, None] / 2 * _NODES


@dataclass(frozen=True)
class _Panels:
    """Panels of a line for the quadrature, with the component of the force at their nodes."""

    low: Array
    """(panels,) lower ends, m"""
    high: Array
    """(panels,) upper ends, m"""
    values: Array
    """(panels * nodes,) N, at the nodes"""

    @classmethod
    def of(cls, component: Component, low: Array, high: Array) -> _Panels:
        """Return the panels between these ends, (panels,) m, with the component evaluated at the
        nodes.
        """
        return cls(low, high, component(_places(low, high).ravel()))

    def joined(self, other: _Panels) -> _Panels:
        """Return these panels followed by those of `other`."""
        return _Panels(
            np.append(self.low, other.low),
            np.append(self.high, other.high),
            np.append(self.values, other.values),
        )

    def integrals(self) -> tuple[Array, Array]:
        """Return the integral over each panel, J, and its estimated error, both (panels,)."""
        values, half = self.values.reshape(-1, len(_NODES)), (self.high - self.low) / 2
        by_kronrod, by_gauss = half * (_WEIGHTS @ values.T)
        mean = by_kronrod / (2 * half)
        rough = half * (np.abs(values - mean[:, None]) @ _WEIGHTS[0])
        apart = np.abs(by_kronrod - by_gauss)
        share = np.divide(apart, rough, out=np.zeros_like(apart), where=rough > 0)
        return by_kronrod, rough * np.minimum(1.0, (_SHARPER * share) ** 1.5)


def _integral(component: Component, panels: _Panels) -> tuple[float, float]:
    """Return the integral over the panels and its estimated error, J.

    Panels with large errors are halved. All panels of a round are evaluated together, because one
    position at a time costs ten times as much.
    """
    value = error = 0.0
    places = 0
    if not panels.low.size:  # nothing pulls back
        return value, error
    for turn in range(_HALVINGS + 1):
        values, errors = panels.integrals()
        places += panels.values.size
        allowed = _WORK * abs(value + values.sum()) * (panels.high - panels.low)
        again = errors > allowed / max(float(panels.high[-1]), 1e-300)
        if turn == _HALVINGS or places > _MOST_PLACES:
            again[:] = False
        value, error = value + values[~again].sum(), error + errors[~again].sum()
        if not again.any():
            break
        low, high = panels.low[again], panels.high[again]
        middle = (low + high) / 2
        panels = _Panels.of(component, np.append(low, middle), np.append(middle, high))
    return float(value), float(error)
