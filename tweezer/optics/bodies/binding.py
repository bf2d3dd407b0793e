"""The T-matrix of a body and the light, as the compiled sums read them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled.lanes import LANES
from tweezer.forces.data import Data, packed
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


def needed_degree(t_matrix: TMatrix, small: float) -> int:
    """Return the degree beyond which S - 1 is below `small`, as a part of its largest element."""
    l = t_matrix.modes[:, 0]
    size = np.abs(t_matrix.change)
    largest = size.max()
    if largest == 0:
        return 1
    by_mode = np.maximum(np.sqrt((size**2).sum(axis=0)), np.sqrt((size**2).sum(axis=1)))
    of_degree = np.array([by_mode[l == n].max() for n in range(1, t_matrix.degree + 1)])
    beyond = np.cumsum(of_degree[::-1])[::-1]
    return max(1, int((beyond > small * largest).sum()))


def body_data(t_matrix: TMatrix, light: Waves, tolerance: float, reach: float) -> Data:
    """Return the data of `kernel.body_kernel` for a body up to `reach`, m, from the focus.

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
    small = max(_SMALL * tolerance, _ROUNDING)
    whole, degree = t_matrix, needed_degree(t_matrix, small)
    t_matrix = whole.cut(degree)
    stride = -(-(degree + 1 + MARGIN) // LANES) * LANES
    highest = stride - 1
    states = full_states(light.states)
    nodes = Nodes(light.focus, light.odd, small)
    blocks, scattering, gathered, signs = _blocks(t_matrix, highest)
    cut = whole.change.copy()
    cut[: len(t_matrix.modes), : len(t_matrix.modes)] = 0
    # |dF| <= (|dt| |v| + |t| |dv|) n_m/c with |t| <= 2 |p| and |v| <= 4 |p|
    unsure = 6 * (np.linalg.norm(cut) + len(t_matrix.modes) ** 0.5 * whole.error)
    return packed(
        light.strength * _UNIT, light.strength, tolerance, nodes.error * light.strength, unsure,
        of_states(states), guarded_elements(np.stack(elements(highest))),
        _delta_table(degree + MARGIN, stride).ravel(), np.array([1.0, -1.0] * (LANES // 2)),
        blocks, scattering, gathered, signs, float(degree), float(t_matrix.axial),
        *source(light, states, nodes, reach, highest, small),
    )  # fmt: skip


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
