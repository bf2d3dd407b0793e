"""Computing a table of the force, and certifying its error.

The table consists of polynomials on pieces of the meridional plane (`tweezer.optics.rays.charts`).
Each interpolates the quadrature at Chebyshev nodes. A piece whose coefficients decay too slowly is
bisected. Then the table is compared with the quadrature at random positions, and pieces that miss
the tolerance are bisected again. Twice the largest difference is the certified error.

Lengths are in radii of the bead and forces in n_m P/c: one table serves every power, and all scenes
that differ only in scale.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from tweezer.compiled import address
from tweezer.forces.data import Data, Part, packed
from tweezer.forces.force import KERNEL, Kernel, evaluated
from tweezer.optics.beyond import unreached
from tweezer.optics.polynomials import ORDER
from tweezer.optics.rays import charts
from tweezer.optics.rays.charts import HEAD, NO_PIECE, Blocks
from tweezer.optics.rays.quadrature import VANISHING
from tweezer.optics.table import Evaluate, Progress, processors
from tweezer.values.arrays import Array
from tweezer.values.errors import TweezerError

if TYPE_CHECKING:
    pass

Integers = NDArray[np.int64]

#: Accept a piece when its estimated error is below this fraction of the tolerance
_DONE = 0.3
#: Safety factor of the certified error
_SAFETY = 2.0
#: Smallest number of random positions at which a table is compared with the quadrature
_COMPARED = 20_000
#: Smallest number of them on each piece
_COMPARED_PER_PIECE = 24
#: Number of the worst pieces that are compared again
_CLOSER = 24
#: Number of random positions on each of these
_COMPARED_CLOSER = 300
#: Largest number of rounds of comparison and bisection
_REPAIRS = 8
#: Largest number of pieces; reached if the force is not smooth in a block (total reflection)
_MOST_PIECES = 6_000
#: Largest number of bisections along x, and along y
_MOST_HALVINGS = 20
#: Smallest rho, in bead radii, at which F_rho/rho is evaluated
_NEAREST = 1e-6
#: Positions in one call of the quadrature
_CHUNK = 512

#: Chebyshev nodes on a piece, from 1 to -1
_NODES = np.cos(np.pi * (np.arange(ORDER) + 0.5) / ORDER)
#: Matrix from values at the nodes to Chebyshev coefficients
_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_NODES, ORDER - 1))
#: Matrix from Chebyshev coefficients to coefficients of powers
_TO_POWERS = np.array(
    [np.pad(chebyshev.cheb2poly(row), (0, ORDER))[:ORDER] for row in np.eye(ORDER)]
).T


@dataclass(frozen=True)
class Made:
    """A force table as stored: polynomials on pieces of the meridional plane.

    Lengths are in radii of the bead, forces in n_m P/c (refractive index, power, speed of light).
    """

    half_angle: float
    """rad, of the cone of light"""
    reach: float
    """range, distance from the focus"""
    frames: Array
    """(blocks, 4): x from, 1/width, y from, 1/width of each block of `charts.Blocks`"""
    roots: NDArray[np.int32]
    """(blocks,) first entry of each block's index"""
    index: NDArray[np.int32]
    """pages of entries, see `charts`"""
    heads: Array
    """(n, HEAD) centre and 1/half-width of each piece along x, then along y"""
    pieces: Array
    """(n, components, ORDER powers of x, ORDER powers of y): F_rho/rho, F_z, M_phi/rho"""
    certified: float
    """bound on the error of the force"""
    largest: float
    """largest force found within the range"""
    seconds: float
    """time of the computation"""

    @property
    def moment(self) -> bool:
        """Whether the torque (3.25) is tabled."""
        return self.pieces.shape[1] > 2

    @property
    def count(self) -> int:
        """Number of pieces of the table, each with its own polynomials."""
        return len(self.pieces)

    def kernel(self, *, gradient: bool) -> Kernel:
        """Return the kernel that reads this table, and adds gradients if `gradient`."""
        return charts.kernel(gradient=gradient, moment=self.moment)

    def data(self, unit: float, strength: float, beyond: Part) -> Data:
        """Return the data of the kernel.

        `unit` is the radius of the bead (m), and `strength` n_m P/c of the light (N). The force
        outside the table's range is `beyond`.
        """
        shape = np.array(
            [unit, math.tan(self.half_angle / 2), self.reach, strength, self.certified * strength]
        )  # fmt: skip
        pieces = self.pieces.ravel()
        return packed(shape, self.frames, self.roots, self.index, self.heads, pieces, beyond)


@dataclass(frozen=True)
class _Task:
    """The function that a table interpolates, and the table's domain."""

    evaluate: Evaluate
    """returns the force at positions (n, 3)"""
    moment: bool
    """whether the torque (3.25) is tabled"""
    parts: Blocks
    """rectangles of the charts' coordinates"""
    half_angle: float
    """of the cone of light, rad"""
    reach: float
    """largest distance from the focus"""

    def exact(self, rho: Array, z: Array) -> tuple[Array, float]:
        """Compute F_rho, F_z (and M_phi) at positions (rho, z), (n,) each, on all processors.

        Returns them as (n, 2 or 3), and the largest estimated error.
        """
        positions = np.stack([rho, np.zeros_like(rho), z], axis=1)
        chunks = [positions[i : i + _CHUNK] for i in range(0, max(len(positions), 1), _CHUNK)]
        with ThreadPoolExecutor(processors()) as pool:
            fields = list(pool.map(self.evaluate, chunks))
        values = np.concatenate([field.force[:, [0, 2]] for field in fields])
        if self.moment:
            turning = np.concatenate([field.moment[:, 1:2] for field in fields])
            values = np.concatenate([values, turning], axis=1)
        if not np.isfinite(values).all():
            raise TweezerError("the quadrature gave a force that is not finite")
        return values, max(float(field.error.max(initial=0.0)) for field in fields)


@dataclass(frozen=True)
class _Draft:
    """Pieces of a table under construction: a Chebyshev series of the force on each cell."""

    cells: Integers
    """(n, 5): block, number of bisections along x and y, index along x and y from 0"""
    head: Array
    """(n, 4) centre and 1/half-width along x, then along y"""
    series: Array
    """(n, components, ORDER, ORDER) Chebyshev coefficients"""
    tails: Array
    """(n, 2) estimated error of the force along x and y, from the last coefficients"""

    def __len__(self) -> int:
        return len(self.cells)

    def __getitem__(self, chosen: NDArray[np.bool_]) -> _Draft:
        """Return the pieces that are marked in `chosen`, (n,)."""
        return _Draft(
            self.cells[chosen], self.head[chosen], self.series[chosen], self.tails[chosen]
        )


def _joined(drafts: list[_Draft]) -> _Draft:
    """Return the pieces of several drafts as one."""
    return _Draft(
        np.concatenate([draft.cells for draft in drafts]),
        np.concatenate([draft.head for draft in drafts]),
        np.concatenate([draft.series for draft in drafts]),
        np.concatenate([draft.tails for draft in drafts]),
    )


@dataclass(frozen=True)
class _Sample:
    """The exact force at positions in the meridional plane, to compare a table with."""

    rho: Array
    """(n,) distance from the axis"""
    z: Array
    """(n,) along the axis, from the focus"""
    force: Array
    """(n, 2) F_rho and F_z"""
    error: float
    """largest estimated error of the quadrature"""


def build(
    evaluate: Evaluate,
    *,
    half_angle: float,
    tolerance: float,
    reach: float,
    moment: bool,
    progress: Progress | None = None,
) -> Made:
    """Compute the table of a force for a cone of light.

    The certified error is twice the largest error at `_COMPARED` or more random positions, plus the
    error of the quadrature.

    Parameters
    ----------
    evaluate : callable
        Force at positions.
    half_angle : float
        Half angle of the cone, rad.
    tolerance : float
        Error of the force, as a fraction of the largest force within reach.
    reach : float
        Largest distance from the focus, radii.
    moment : bool
        Whether to tabulate the torque (3.25).
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Raises
    ------
    TweezerError
        If `evaluate` returns a force that is not finite.
    """
    started = time.perf_counter()
    task = _Task(evaluate, moment, charts.blocks(half_angle, reach), half_angle, reach)
    cells = np.zeros((len(task.parts.chart), 5), np.int64)
    cells[:, 0] = np.arange(len(cells))
    cells = _halved(cells, np.ones((len(cells), 2), np.bool_))
    rng = np.random.default_rng(20_231)
    tell: Progress = progress or (lambda _: None)
    largest = VANISHING
    drafts: list[_Draft] = []
    samples: list[_Sample] = []
    for repair in range(_REPAIRS + 1):
        report = (lambda part: tell(0.8 * part)) if not repair else (lambda _: None)
        others = sum(map(len, drafts))
        new, largest = _refined(cells, task, tolerance, largest, others, report)
        drafts.append(new)
        draft = _joined(drafts)
        made = _packed(draft, task)
        each = max(_COMPARED_PER_PIECE, math.ceil(_COMPARED / len(draft)))
        samples.append(_sample(new, task, each, rng))
        worst = _worst(made, samples)
        if _SAFETY * worst.max() <= tolerance * largest:
            closer = np.isin(np.arange(len(draft)), np.argsort(worst)[-_CLOSER:])
            samples.append(_sample(draft[closer], task, _COMPARED_CLOSER, rng))
            worst = _worst(made, samples)
        largest = max(largest, *(np.hypot(*sample.force.T).max() for sample in samples))
        own = max(sample.error for sample in samples)
        allowed = max(tolerance * largest - own, tolerance * largest / 2)
        missed = _SAFETY * worst > 0.8 * allowed
        missed &= (draft.cells[:, 1:3] < _MOST_HALVINGS).all(axis=1)
        met = _SAFETY * worst.max() <= allowed
        if met or not missed.any() or len(draft) > _MOST_PIECES // 2:
            break
        poor = draft[missed]
        cells = _halved(poor.cells, poor.tails >= 0.5 * poor.tails.max(axis=1, keepdims=True))
        drafts = [draft[~missed]]
    tell(1.0)
    return dataclasses.replace(
        made,
        certified=float(_SAFETY * worst.max() + own),
        largest=float(largest),
        seconds=time.perf_counter() - started,
    )


def _bounds(cells: Integers, parts: Blocks) -> Array:
    """Return the rectangles of cells (see `_Draft.cells`), (n, 4): x from, to, y from, to."""
    low, high = parts.bounds[cells[:, 0], 0::2], parts.bounds[cells[:, 0], 1::2]
    width = (high - low) * 0.5 ** cells[:, 1:3]
    start = low + width * cells[:, 3:5]
    return np.stack([start, start + width], axis=2).reshape(-1, 4)


def _halved(cells: Integers, along: NDArray[np.bool_]) -> Integers:
    """Return cells (see `_Draft.cells`) bisected along the axes that are marked in `along` (n, 2).

    A cell that is marked along x and y gives four, and one that is not marked remains.
    """
    for axis in range(2):
        split = along[:, axis]
        cells = cells.copy()
        cells[split, 1 + axis] += 1
        cells[split, 3 + axis] *= 2
        second = cells[split]
        second[:, 3 + axis] += 1
        cells, along = np.concatenate([cells, second]), np.concatenate([along, along[split]])
    return cells


def _refined(
    cells: Integers, task: _Task, tolerance: float, largest: float, others: int, report: Progress
) -> tuple[_Draft, float]:
    """Return pieces on `cells`, bisected until their estimated error is small; the largest force.

    The error may be `tolerance` times the largest force, which is `largest` so far. The table has
    `others` further pieces. `report` is called with the finished part of the area.
    """
    done: list[_Draft] = []
    while len(cells):
        fresh, met = _interpolated(cells, task)
        largest = max(largest, met)
        poor = fresh.tails > _DONE * tolerance * largest
        poor &= fresh.cells[:, 1:3] < _MOST_HALVINGS
        again = poor[:, 0] | poor[:, 1]
        room = _MOST_PIECES - others - sum(map(len, done)) - len(fresh)
        if 3 * again.sum() > room:  # only the worst, as one piece becomes up to four
            size = np.where(again, fresh.tails.max(axis=1), 0.0)
            again[np.argsort(size)[: len(size) - max(room // 3, 0)]] = False
        done.append(fresh[~again])
        cells = _halved(fresh.cells[again], poor[again])
        report(1 - (0.5 ** cells[:, 1:3].sum(axis=1)).sum() / len(task.parts.chart))
    return _joined(done), largest


def _interpolated(cells: Integers, task: _Task) -> tuple[_Draft, float]:
    """Interpolate the force on those of `cells` within reach.

    Returns a piece for each, with its estimated error, and the largest force at a node.
    """
    bounds, chart = _bounds(cells, task.parts), task.parts.chart[cells[:, 0]]
    needed = ~charts.beyond(chart, bounds, task.reach)
    cells, bounds, chart = cells[needed], bounds[needed], chart[needed]
    even = ((chart == charts.RING) | (chart == charts.TRIANGLE)) & (bounds[:, 0] == 0)
    bounds[even, 0] = -bounds[even, 1]  # F is even in x, so one polynomial spans both signs
    centre = (bounds[:, 0::2] + bounds[:, 1::2]) / 2
    half = (bounds[:, 1::2] - bounds[:, 0::2]) / 2
    nodes = centre[:, :, None] + half[:, :, None] * _NODES
    shape = (len(cells), ORDER, ORDER)
    x, y = np.broadcast_to(nodes[:, 0, :, None], shape), np.broadcast_to(nodes[:, 1, None], shape)
    rho, z = charts.places(chart, x, y, task.half_angle)
    rho = np.maximum(rho, _NEAREST)
    # F is symmetric about the diagonal of the outer chart
    square = (chart == charts.OUTER) & (bounds[:, :2] == bounds[:, 2:]).all(axis=1)
    twice = np.zeros(shape, np.bool_)
    twice[even, ORDER // 2 :] = True
    twice[square] = ~np.tri(ORDER, dtype=np.bool_)
    found, _ = task.exact(rho[~twice], z[~twice])
    met = np.hypot(found[:, 0], found[:, 1])[np.hypot(rho, z)[~twice] <= task.reach].max(
        initial=0.0
    )
    values = np.empty((*shape, found.shape[1]))
    values[~twice] = found
    values[even, ORDER // 2 :] = values[even, ORDER // 2 - 1 :: -1]
    values[square] = np.where(
        twice[square][..., None], values[square].swapaxes(1, 2), values[square]
    )
    values[..., 0::2] /= rho[..., None]  # F_rho/rho and M_phi/rho, not F_z
    values = np.moveaxis(values, -1, 1)
    series = _TO_SERIES @ values @ _TO_SERIES.T
    lever = np.ones((len(cells), series.shape[1]))
    lever[:, 0::2] = rho.max(axis=(1, 2))[:, None]
    tails = np.empty((len(cells), 2))
    for axis, sizes in enumerate((np.abs(series).sum(axis=3), np.abs(series).sum(axis=2))):
        last, before = sizes[..., -2:].max(axis=2), sizes[..., -4:-2].max(axis=2)
        ratio = np.minimum(np.sqrt(last / np.maximum(before, 1e-300)), 0.9)
        tails[:, axis] = (last * ratio**2 / (1 - ratio) * lever).max(axis=1)
    tails[square] = tails[square].max(axis=1, keepdims=True)  # keeps squares square
    head = np.stack([centre, 1 / half], axis=2).reshape(-1, HEAD)
    return _Draft(cells, head, series, tails), float(met)


def _packed(draft: _Draft, task: _Task) -> Made:
    """Return the table of the pieces of a draft; its certified error is not known yet: NaN."""
    powers = _TO_POWERS @ draft.series @ _TO_POWERS.T
    low, high = task.parts.bounds[:, 0::2], task.parts.bounds[:, 1::2]
    roots, index = _indexed(draft.cells, len(low))
    return Made(
        half_angle=task.half_angle,
        reach=task.reach,
        frames=np.stack([low, 1 / (high - low)], axis=2).reshape(-1, 4),
        roots=roots,
        index=index,
        heads=draft.head,
        pieces=powers,
        certified=math.nan,
        largest=0.0,
        seconds=0.0,
    )


def _indexed(cells: Integers, blocks: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return the roots and the index by which `charts._piece_of` finds a piece.

    cells: of the pieces, see `_Draft.cells`. blocks: number of blocks. A root is the entry of a
    whole block. An entry that several pieces share becomes a page: a grid of finer entries.
    """
    pieces = cells.tolist()
    index: list[int] = []

    def entry(chosen: list[int], halvings: tuple[int, int], number: tuple[int, int]) -> int:
        """Return the index entry for a cell that contains the pieces `chosen`, or lies in one.

        halvings: how often the block is bisected along x and y for the cell. number: of the cell
        along both, from 0.
        """
        if not chosen:
            return NO_PIECE
        _, x_halvings, y_halvings, _, _ = pieces[chosen[0]]
        if len(chosen) == 1 and x_halvings <= halvings[0] and y_halvings <= halvings[1]:
            return chosen[0]
        deeper = [max(pieces[k][1 + axis] for k in chosen) - halvings[axis] for axis in range(2)]
        bits = [min(max(deeper[a], 0), 4 if deeper[1 - a] > 0 else 7) for a in range(2)]
        page: list[list[int]] = [[] for _ in range(1 << sum(bits))]
        for k in chosen:
            spans = []
            for axis in range(2):
                coarser = halvings[axis] + bits[axis] - pieces[k][1 + axis]
                low, high = pieces[k][3 + axis], pieces[k][3 + axis] + 1
                low, high = (
                    (low << coarser, high << coarser)
                    if coarser >= 0
                    else (low >> -coarser, (low >> -coarser) + 1)
                )
                first = number[axis] << bits[axis]
                spans.append(range(max(low - first, 0), min(high - first, 1 << bits[axis])))
            for i, j in itertools.product(*spans):
                page[(i << bits[1]) + j].append(k)
        start = len(index)
        index.extend([NO_PIECE] * len(page))
        finer = (halvings[0] + bits[0], halvings[1] + bits[1])
        for at, here in enumerate(page):
            place = (number[0] << bits[0]) + (at >> bits[1])
            line = (number[1] << bits[1]) + (at & ((1 << bits[1]) - 1))
            index[start + at] = entry(here, finer, (place, line))
        return -2 - (64 * start + 8 * bits[0] + bits[1])

    roots = [
        entry(np.flatnonzero(cells[:, 0] == block).tolist(), (0, 0), (0, 0))
        for block in range(blocks)
    ]
    return np.array(roots, np.int32), np.array(index, np.int32)


def _sample(draft: _Draft, task: _Task, each: int, rng: np.random.Generator) -> _Sample:
    """Compute the force at `each` random positions of every piece, denser towards its edges."""
    local = np.sin(np.pi * (rng.random((2, len(draft.cells), each)) - 0.5))
    x = draft.head[:, 0, None] + local[0] / draft.head[:, 1, None]
    y = draft.head[:, 2, None] + local[1] / draft.head[:, 3, None]
    rho, z = charts.places(task.parts.chart[draft.cells[:, 0]], x, y, task.half_angle)
    within = np.hypot(rho, z) <= task.reach
    rho, z = rho[within], z[within]
    values, error = task.exact(rho, z)
    return _Sample(rho, z, values[:, :2], error)


def _worst(made: Made, samples: list[_Sample]) -> Array:
    """Return the largest error of each piece at the positions of all samples, (pieces,) n_m P/c."""
    rho = np.concatenate([sample.rho for sample in samples])
    z = np.concatenate([sample.z for sample in samples])
    exact = np.concatenate([sample.force for sample in samples])
    positions = np.stack([rho, np.zeros_like(rho), z], axis=1)
    kernel = address(charts.kernel(gradient=False, moment=made.moment), KERNEL)
    data = made.data(1.0, 1.0, unreached())
    read = evaluated(Part(kernel, data), positions, gradient=False)
    at = np.empty(len(rho), np.int64)
    charts.find(positions, data, at)
    off, inside = np.hypot(*(read.force[:, [0, 2]] - exact).T), at != NO_PIECE
    worst = np.zeros(len(made.pieces))
    np.maximum.at(worst, at[inside], off[inside])
    return worst
