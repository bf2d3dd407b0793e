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
from tweezer.optics.bodies.kernel import body_sums
from tweezer.optics.bodies.rotated import MARGIN, length_of
from tweezer.optics.bodies.rotation import wigner_delta
from tweezer.optics.bodies.t_matrix import TMatrix
from tweezer.optics.waves.binding import of_states, source
from tweezer.optics.waves.focus import State
from tweezer.optics.waves.harmonics import elements
from tweezer.optics.waves.kernel import guarded_elements
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.nodes import Nodes
from tweezer.values.arrays import Array

ComplexArray = NDArray[np.complex128]

#: Error of integrals and sums, as a part of the tolerance: the force is small beside the light
_SMALL = 1e-3
#: Smallest error of integrals
_ROUNDING = 2e-15
#: Force of the sums, in n_m P/c
_UNIT = 4 * math.pi**2
#: Number of places at which degrees are compared; difference allowed there, of the tolerance
_PLACES, _CUT = 24, 0.2
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
        return max(_SMALL * self.tolerance, _ROUNDING)

    @functools.cached_property
    def nodes(self) -> Nodes:
        """Nodes over the cone of light."""
        return Nodes(self.light.focus, self.light.odd, self.small)

    @functools.cached_property
    def states(self) -> tuple[State, ...]:
        """Polarised parts of the light, without mirror images."""
        return full_states(self.light.states)

    @functools.lru_cache(maxsize=4)  # noqa: B019
    def source(self, highest: int) -> tuple[Any, ...]:
        """Return the fields of `partial_waves.Source` for a highest degree."""
        return source(self.light, self.states, self.nodes, self.reach, highest, self.small)

    def data(self, degree: int, room: int, cut_error: float) -> Data:
        """Return the data for S - 1 up to a degree.

        `room` is a degree for which the tables have room, and `cut_error` the error of the force
        by the degrees that are left out, in n_m P/c.
        """
        light, cut = self.light, self.body.cut(degree)
        stride = -(-(room + 1 + MARGIN) // LANES) * LANES
        highest = stride - 1
        floor = (self.nodes.error + cut_error) * light.strength
        # |dF| <= (|dt| |v| + |t| |dv|) n_m/c with |t| <= 2 |p| and |v| <= 4 |p|
        unsure = 6 * len(cut.modes) ** 0.5 * self.body.error
        return packed(
            light.strength * _UNIT, light.strength, self.tolerance, floor, unsure,
            of_states(self.states), guarded_elements(np.stack(elements(highest))),
            _delta_table(degree + MARGIN, stride).ravel(), np.array([1.0, -1.0] * (LANES // 2)),
            *_blocks(cut, highest), float(degree), float(cut.axial), *self.source(highest),
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
    places = random.uniform(-far / 4, far / 4, (_PLACES, 3))
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


def _delta_table(degree: int, stride: int) -> Array:
    """Return Delta^n_mk = d^n_mk(pi/2) by k, m >= 0 and n, `stride` of each, up to a degree."""
    table = np.zeros((stride, stride, stride))
    for n, delta in enumerate(wigner_delta(degree)):
        table[: n + 1, : n + 1, n] = delta[n:, n:].T
    return table


def _blocks(t_matrix: TMatrix, highest: int) -> tuple[Array, Array, NDArray[np.int32], Array]:
    """Return S - 1 as blocks, in the form of `kernel.Body`."""
    change, degree = _electric_and_magnetic(t_matrix.change), t_matrix.degree
    l, m, kind = t_matrix.modes[:, 0], t_matrix.modes[:, 1], (t_matrix.modes[:, 2] < 0)
    largest = np.abs(change).max()
    every = np.arange(len(l))
    if not t_matrix.axial:
        lists = [[(every, np.ones(len(l)))]]
    else:
        image = 2 * (l * l - 1 + l - m) + kind  # the mode of order -m
        flipped = np.where(kind, -1.0, 1.0)
        mirrored = flipped[:, None] * flipped[None, :] * change[np.ix_(image, image)]
        alike = np.abs(mirrored - change).max() <= _ALIKE * largest
        # a mirror plane keeps electric waves of one parity of n apart from magnetic ones of it
        side = (l + kind) % 2
        split = np.abs(change[side[:, None] != side[None, :]]).max(initial=0) <= _ALIKE * largest
        lists = []
        for order in range(0 if alike else -degree, degree + 1):
            for parity in (0, 1) if split else (None,):
                own = every[(m == order) & ((side == parity) | (parity is None))]
                if own.size == 0:
                    continue
                vectors = [(own, np.ones(len(own)))]
                if alike and order > 0:
                    vectors.append((image[own], flipped[own]))
                lists.append(vectors)
    place = LANES + (m + highest + MARGIN) * (highest + 1) + l + kind * length_of.py_func(highest)
    rows, numbers, indices, signs = [], [], [], []
    entry = first = 0
    for vectors in lists:
        own = vectors[0][0]
        size = -(-len(own) // LANES) * LANES
        block = np.zeros((size, 2, size))
        part = change[np.ix_(own, own)].T  # by column
        block[: len(own), 0, : len(own)] = part.real
        block[: len(own), 1, : len(own)] = part.imag
        rows.append((size, entry, len(vectors), first))
        numbers.append(block.ravel())
        for of, sign in vectors:
            more = size - len(of)
            indices.append(np.pad(place[of], (0, more)))
            signs.append(np.pad(sign, (0, more)))
        entry += block.size
        first += size * len(vectors)
    return (
        np.array(rows, float), np.concatenate(numbers),
        np.concatenate(indices).astype(np.int32), np.concatenate(signs),
    )  # fmt: skip


def _electric_and_magnetic(change: ComplexArray) -> ComplexArray:
    """Return S - 1 between electric (first) and magnetic waves, from that between helicities."""
    n = len(change) // 2
    plus, minus = change.reshape(n, 2, n, 2)[:, 0], change.reshape(n, 2, n, 2)[:, 1]
    rows = np.stack([plus + minus, plus - minus], axis=1)
    columns = np.stack([rows[..., 0] + rows[..., 1], rows[..., 0] - rows[..., 1]], axis=-1)
    out: Any = columns.reshape(2 * n, 2 * n) / 2
    return out
