"""The T-matrix of a body and the light, as the compiled sums read them."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled.lanes import LANES
from tweezer.forces.data import Data, packed
from tweezer.optics.bodies.kernel import TOGETHER, body_sums
from tweezer.optics.bodies.rotated import MARGIN, delta_table, length_of
from tweezer.optics.bodies.t_matrix import TMatrix
from tweezer.optics.waves.binding import ROUNDING, SMALL, UNIT, of_states, source
from tweezer.optics.waves.focus import State
from tweezer.optics.waves.harmonics import elements
from tweezer.optics.waves.kernel import guarded_elements
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.nodes import Nodes
from tweezer.optics.waves.terms import nodes_of
from tweezer.values.arrays import Array

ComplexArray = NDArray[np.complex128]

#: Number of places at which degrees are compared; difference allowed there, of the tolerance
_PLACES, _CUT = 48, 0.2
#: Elements of S - 1 below this part of the largest count as symmetric or zero
_ALIKE = 1e-13


def full_states(states: tuple[State, ...]) -> tuple[State, ...]:
    """Return polarised states without mirror images.

    The mirror image of a state pushes a sphere with the mirror image of the force. A body that is
    not its own mirror image needs both states.
    """
    found = []
    for state in states:
        own, other = (1 + state.handedness) / 2, (1 - state.handedness) / 2
        if own:
            found.append(State(own * state.weight, state.parts))
        if other:
            mirrored = tuple(
                part._replace(helicity=-part.helicity, angular_momentum=-part.angular_momentum)
                for part in state.parts
            )
            found.append(State(other * state.weight, mirrored))
    return tuple(found)


@dataclasses.dataclass(frozen=True)
class _Bound:
    """A body and light, bound as often as degrees are tried."""

    body: TMatrix
    light: Waves
    tolerance: float
    reach: float
    """largest distance from the focus, m"""

    @property
    def small(self) -> float:
        """Error of integrals and sums, as a part of the light."""
        return max(SMALL * self.tolerance, ROUNDING)

    @functools.cached_property
    def reached(self) -> tuple[Waves, Nodes]:
        """The light that counts within the reach, and nodes over its cone."""
        change, degrees = np.abs(self.body.change), self.body.modes[:, 0]
        sizes = np.hypot(np.linalg.norm(change, axis=0), np.linalg.norm(change, axis=1))
        of_degrees = np.array([sizes[degrees == l].max() for l in np.unique(degrees)])
        return nodes_of(self.light, self.small, self.reach, of_degrees)

    @property
    def nodes(self) -> Nodes:
        """Nodes over the cone of light."""
        return self.reached[1]

    @functools.cached_property
    def states(self) -> tuple[State, ...]:
        """Polarised parts of the light, without mirror images."""
        return full_states(self.reached[0].harmonic_states)

    @functools.lru_cache(maxsize=4)  # noqa: B019
    def source(self, highest: int) -> tuple[Any, ...]:
        """Return the fields of `partial_waves.Source` for a highest degree."""
        return source(self.reached[0], self.states, self.nodes, self.reach, highest, self.small)

    def data(self, degree: int, room: int, cut_error: float) -> Data:
        """Return the data for S - 1 up to a degree.

        `room` is a degree for which the tables have room, and `cut_error` the error of the force
        by the degrees that are left out, in n_m P/c.
        """
        light, cut = self.light, self.body.cut(degree)
        stride = -(-(room + 1 + MARGIN) // LANES) * LANES
        highest = stride - 1
        floor = (self.nodes.error + cut_error) * light.strength
        # |dF| <= (|dt| |v| + |t| |dv|) n_m/c with |t| <= 2 |p| and |v| <= 4 |p|. The elements'
        # errors are taken to be independent, so that the norm of dS grows as the root of the modes
        unsure = 6 * len(cut.modes) ** 0.5 * self.body.error
        return packed(
            light.strength * UNIT, light.strength, self.tolerance, floor, unsure,
            of_states(self.states), guarded_elements(np.stack(elements(highest))),
            delta_table(degree + MARGIN, highest), np.array([1.0, -1.0] * (LANES // 2)),
            *_scattering(cut, highest), *self.source(highest),
        )  # fmt: skip


def body_data(t_matrix: TMatrix, light: Waves, tolerance: float, reach: float) -> Data:
    """Return the data of `kernel.body_kernel` for a body up to `reach`, m, from the focus.

    The degree of the sums is the smallest for which forces and torques at some places differ from
    those of the whole T-matrix by less than a part of the tolerance. The places are drawn around
    the focus, with random orientations. Three times this difference is part of the stated error.

    Parameters
    ----------
    t_matrix : TMatrix
        The body.
    light : Waves
        The light, with the radius of the sphere that encloses the body.
    tolerance : float
        Relative tolerance of the force.
    reach : float
        Largest distance from the focus, m.
    """
    far = 2 * (light.radius + 2 * math.pi / light.wavenumber)
    trial = _Bound(t_matrix, light, tolerance, far)
    random = np.random.default_rng(0)
    # half of the places are in the light, half where it reaches the body's edge: there the light
    # on the body has higher degrees
    half = np.repeat([far / 4, far / 2], _PLACES // 2)
    places = half[:, None] * random.uniform(-1.0, 1.0, (_PLACES, 3))
    turned = random.normal(size=(_PLACES, 4))
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)

    def sums(degree: int) -> Array:
        """Return forces and torques times k at the places, in n_m P/c, (places, 6)."""
        found: Array = body_sums()(places, turned, trial.data(degree, highest, 0.0), False)[:, :6]
        return found / light.strength * np.repeat([1.0, light.wavenumber], 3)

    highest = t_matrix.degree
    exact = sums(highest)
    largest = np.linalg.norm(exact[:, :3], axis=1).max()
    degree, error = highest, 0.0
    for lower in range(highest - 1, 0, -1):
        off = float(np.abs(sums(lower) - exact).max())
        if off > _CUT * tolerance * largest:
            break
        degree, error = lower, off
    return _Bound(t_matrix, light, tolerance, reach).data(degree, degree, 3 * error)


def _scattering(body: TMatrix, highest: int) -> tuple[Array, NDArray[np.int32], float, float]:
    """Return S - 1 in the form of `kernel.Body`: elements, places, degree, and whether it splits.

    A body of revolution whose S - 1 differs for m and -m, because it is chiral, counts as one
    without an axis.
    """
    change = _electric_and_magnetic(body.change)
    l, m, magnetic = body.modes[:, 0], body.modes[:, 1], body.modes[:, 2] < 0
    least = _ALIKE * np.abs(change).max()
    if body.axial:
        image = 2 * (l * l - 1 + l - m) + magnetic  # the mode of order -m
        flip = np.where(magnetic, -1.0, 1.0)
        mirrored = flip[:, None] * flip * change[np.ix_(image, image)]
        if np.abs(mirrored - change).max(initial=0) <= least:
            side = (l + magnetic) % 2
            mixed = change[side[:, None] != side]
            split = bool(np.abs(mixed).max(initial=0) <= least)
            return (
                _about_axis(change, body, split), np.zeros(0, np.int32), float(body.degree),
                float(split),
            )  # fmt: skip
    places = LANES + (m + highest + MARGIN) * (highest + 1) + l
    places += magnetic * length_of.py_func(highest)
    padded = -(-len(l) // (TOGETHER * LANES)) * TOGETHER * LANES
    columns = np.zeros((len(l), 2, padded))
    columns[:, 0, : len(l)], columns[:, 1, : len(l)] = change.T.real, change.T.imag
    return columns.ravel(), places.astype(np.int32), float(body.degree), 0.0


def _about_axis(change: ComplexArray, body: TMatrix, split: bool) -> Array:
    """Return the elements of S - 1 of a body of revolution; see `kernel._scatter_about_axis`."""
    l, m, magnetic = body.modes[:, 0], body.modes[:, 1], body.modes[:, 2] < 0
    found = []
    for order in range(body.degree, -1, -1):
        lowest = max(order, 1)
        of_order = np.flatnonzero(m == order)
        # the first class has a magnetic wave at the lowest degree
        in_first = magnetic[of_order] == ((l[of_order] - lowest) % 2 == 0)
        first, other = of_order[in_first], of_order[~in_first]
        padded = -(-len(first) // LANES) * LANES
        for rows, columns in ((first, other), (other, first)):
            for incident in (rows,) if split else (rows, columns):
                part = change[np.ix_(rows, incident)].T
                block = np.zeros((len(incident), 2, padded))
                block[:, 0, : len(rows)], block[:, 1, : len(rows)] = part.real, part.imag
                found.append(block.ravel())
    return np.concatenate(found)


def _electric_and_magnetic(change: ComplexArray) -> ComplexArray:
    """Return S - 1 between electric (first) and magnetic waves, from that between helicities."""
    n = len(change) // 2
    plus, minus = change.reshape(n, 2, n, 2)[:, 0], change.reshape(n, 2, n, 2)[:, 1]
    rows = np.stack([plus + minus, plus - minus], axis=1)
    columns = np.stack([rows[..., 0] + rows[..., 1], rows[..., 0] - rows[..., 1]], axis=-1)
    out: Any = columns.reshape(2 * n, 2 * n) / 2
    return out
