"""A table of the force of waves in light without an axis of symmetry: splines over a box.

As a function of the bead's position, the force of focused light is band-limited: along each axis
no wave number exceeds B. It is sampled at the Chebyshev nodes of a box. On an ellipse with the foci
+-L and the half axes L (rho +- 1/rho)/2, a band-limited function is at most
exp(B L (rho - 1/rho)/2) times its largest value on the real axis, M (Bernstein). The polynomial
through n nodes on [-L, L] therefore errs by at most

    4 M rho^(1 - n) exp(B L (rho - 1/rho)/2)/(rho - 1),   for every rho > 1.

The polynomial is replaced by a spline of degree 7 with the spacing h of knots,

    F(x, y, z) = sum_ijk c_ijk B(x/h_x - i) B(y/h_y - j) B(z/h_z - k).

Along each axis the coefficients c are a matrix times the samples: the least squares at many places.
Its difference from the polynomial is a matrix times the samples too, and so known everywhere.

Lengths are in 1/k, forces in n_m P/c, moments in n_m P/(c k).
"""

from __future__ import annotations

import functools
import math
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from tweezer.compiled import address, cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, store, total
from tweezer.compiled.stack import borrowed, on_stack
from tweezer.forces.data import Data, Part, begin_of, packed, part
from tweezer.forces.force import KERNEL, Kernel, Wrench, evaluated
from tweezer.generated import spline
from tweezer.optics.beyond import add_one, unreached
from tweezer.optics.polynomials import INNER
from tweezer.optics.table import Evaluate, Progress, processors
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Number of coefficients along each axis that count at a position
ORDER = LANES
#: First spacing of knots, in 1/B, for the tolerance 1e-7
_SPACING = 1.1
#: Largest number of coefficients of a table
_MOST_NUMBERS = 8_000_000
#: Errors along one axis as parts of the tolerance: of the polynomial, and of the spline
_OF_SERIES, _OF_SPLINE = 2e-3, 0.1
#: Factor from the largest difference found to the largest everywhere
_SAFETY = 2.0
#: Number of random places at which a table is compared with the force
_COMPARED = 2000
#: Search for the number of intervals: most trials, factor above the estimate, and the part of the
#: intervals below which fewer are tried
_TRIALS, _SPARE, _MUCH_LESS = 6, 1.02, 0.93
#: Numbers of places in the least squares and in the search for the largest difference, per interval
_FITTED, _SEARCHED = 4, 6
#: Number of places that a thread computes at a time, and of rows of differences
_CHUNK, _ROWS = 512, 64

#: Coefficients of the powers of the place in an interval, for each weight
_WEIGHTS = np.zeros((ORDER, ORDER))
spline.spline_weights(_WEIGHTS)

#: Entries of a kernel's work space: weights of x, of y, and their derivatives
_X, _Y, _DX, _DY, _ROOM = (LANES * k for k in range(5))


@dataclass(frozen=True)
class Spline:
    """A force table as stored: splines over a box.

    Lengths are in 1/k and forces in n_m P/c, with wavenumber k, refractive index n_m and power P.
    """

    low: Array
    """(3,) corner of the box with the lowest coordinates"""
    spacing: Array
    """(3,) of the knots"""
    coefficients: Array
    """(intervals + 7 along x, along y, functions, along z); functions: the force and, if tabled,
    the torque"""
    reach: float
    """distance between a focus and the nearest face of the box"""
    certified: float
    """bound on the error of the force"""
    largest: float
    """largest force found in the box"""
    seconds: float
    """time of the computation"""

    @property
    def intervals(self) -> tuple[int, int, int]:
        """Numbers of intervals between knots along x, y and z."""
        x, y, _, z = (each - ORDER + 1 for each in self.coefficients.shape)
        return x, y, z

    @property
    def count(self) -> int:
        """Number of pieces of the table, each with its own polynomials."""
        return math.prod(self.intervals)

    def kernel(self, *, gradient: bool) -> Kernel:
        """Return the kernel that reads this table, and adds gradients if `gradient`."""
        return spline_kernel(gradient=gradient, functions=self.coefficients.shape[2])

    def data(self, unit: float, strength: float, beyond: Part) -> Data:
        """Return the data of the kernel.

        `unit` is 1/k (m) and `strength` n_m P/c (N). The force outside the box is `beyond`.
        """
        shape = np.array([
            1 / unit, strength, self.certified * strength, *self.low, *(1 / self.spacing),
            *self.intervals,
        ])  # fmt: skip
        return packed(shape, _WEIGHTS, self.coefficients.ravel(), beyond)


class Region(NamedTuple):
    """Box about the foci of light, in which a force is tabulated. Lengths are in 1/k."""

    band: Array
    """(3,) largest wave numbers of the force along x, y and z, in k"""
    low: Array
    """(3,) corner with the lowest coordinates"""
    high: Array
    """(3,) corner with the highest coordinates"""

    @property
    def farthest(self) -> float:
        """Bound on the distance of the box from the origin."""
        return float(np.linalg.norm(np.maximum(-self.low, self.high)))

    def intervals(self, tolerance: float, *, moment: bool) -> list[int]:
        """Return the numbers of intervals between knots along the axes with which a fit begins.

        Raises `SceneError` for a box that takes too many coefficients.

        Parameters
        ----------
        tolerance : float
            Error of the force, as a fraction of the largest force.
        moment : bool
            Whether to tabulate the torque too.
        """
        spacing = _SPACING * (tolerance / 1e-7) ** (1 / ORDER)
        counts = [
            max(1, math.ceil(2 * phase / spacing))
            for phase in self.band * (self.high - self.low) / 2
        ]
        _not_too_many(counts, 6 if moment else 3)
        return counts


class _Fit(NamedTuple):
    """A spline along one axis as matrices that multiply samples at Chebyshev nodes."""

    coefficients: Array
    """(coefficients, nodes)"""
    difference: Array
    """(places, nodes): the polynomial through the samples, less the spline"""
    gain: float
    """largest value of the spline for samples of +-1"""


def build(
    evaluate: Evaluate,
    *,
    region: Region,
    reach: float,
    tolerance: float,
    moment: bool,
    progress: Progress | None = None,
) -> Spline:
    """Compute the table of a force in a box.

    The errors of polynomial, spline and force add up to the certified error. It is at least twice
    the largest difference from the force at random positions.

    Parameters
    ----------
    evaluate : callable
        Force at positions.
    region : Region
        The box.
    reach : float
        Distance between the foci and the faces of the box, 1/k.
    tolerance : float
        Error of the force, as a fraction of the largest force.
    moment : bool
        Whether to tabulate the torque too.
    progress : callable, optional
        Called with the finished fraction.

    Raises
    ------
    SceneError
        For a box that takes too many coefficients.
    """
    began = time.perf_counter()
    band, low, high = region
    half = (high - low) / 2
    counts = region.intervals(tolerance, moment=moment)
    phases = [float(each) for each in band * half]
    nodes = [_nodes(phase, _OF_SERIES * tolerance) for phase in phases]
    values, error = _sampled(evaluate, low + half, half, nodes, moment, progress)
    largest = float(np.linalg.norm(values[..., :3], axis=-1).max())
    fits, splines = [], 0.0
    for axis in range(3):
        fit, difference = _fitted(values, axis, counts[axis], _OF_SPLINE * tolerance * largest)
        fits.append(fit)
        splines += difference
    x, y, z = (fit.coefficients for fit in fits)
    coefficients = np.einsum("ai,bj,ck,ijkf->abfc", x, y, z, values, optimize=True)
    gain = math.prod(fit.gain for fit in fits)
    series = sum(map(_remainder, phases, nodes)) * largest
    bound = gain * (series + error) + _SAFETY * splines
    counts = [len(fit.coefficients) - ORDER + 1 for fit in fits]
    made = Spline(low, 2 * half / counts, np.ascontiguousarray(coefficients), reach, 0.0, 0.0, 0.0)
    found, biggest = _compared(evaluate, made, high)
    certified, largest = max(bound, _SAFETY * found), max(largest, biggest)
    if progress:
        progress(1.0)
    seconds = time.perf_counter() - began
    return Spline(low, made.spacing, made.coefficients, reach, certified, largest, seconds)


def _not_too_many(counts: list[int], functions: int) -> None:
    """Refuse a table whose coefficients would be too many.

    `counts` are the numbers of intervals along the axes, for each of `functions`.
    """
    numbers = functions * math.prod(count + ORDER - 1 for count in counts)
    if numbers > _MOST_NUMBERS:
        raise SceneError(
            f"optics.table_range: {numbers:.2g} coefficients are too many for a map about all "
            f"foci, allowed: {_MOST_NUMBERS:.2g}; choose a smaller range, or optics.evaluator = "
            "'quadrature'"
        )


def _remainder(phase: float, nodes: int) -> float:
    """Return the largest error of the polynomial through samples of a band-limited function.

    The error is a part of the function's largest value; `phase` is B L. The bound is the smallest
    over all ellipses.
    """
    rho = 1 + np.geomspace(0.01, 1e3, 2000)
    exponent = (1 - nodes) * np.log(rho) + phase * (rho - 1 / rho) / 2
    return float(np.exp((exponent + np.log(4 / (rho - 1))).min()))


def _nodes(phase: float, error: float) -> int:
    """Return an even number of Chebyshev nodes that leaves at most an error; see `_remainder`."""
    count = 2 * math.ceil(phase / 2) + 2
    while _remainder(phase, count) > error:
        count += 2
    return count


def _sampled(
    evaluate: Evaluate,
    centre: Array,
    half: Array,
    nodes: list[int],
    moment: bool,
    progress: Progress | None,
) -> tuple[Array, float]:
    """Return force, and torque if `moment`, at the nodes of a box, and the largest error of forces.

    The samples are (along x, along y, along z, functions). The box is given by its `centre` and its
    half-widths; `build` describes the other arguments.
    """
    evaluate(centre[None])  # computes tables, which threads then share
    axes = (
        c + h * chebyshev.chebpts1(n)
        for c, h, n in zip(centre.tolist(), half.tolist(), nodes, strict=True)
    )
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    chunks = [places[i : i + _CHUNK] for i in range(0, len(places), _CHUNK)]
    values, error = np.empty((len(places), 6 if moment else 3)), 0.0
    with ThreadPoolExecutor(processors()) as pool:
        for i, found in enumerate(pool.map(evaluate, chunks)):
            rows = values[i * _CHUNK :][: len(found.force)]
            rows[:, :3] = found.force
            if moment:
                rows[:, 3:] = found.moment
            error = max(error, float(found.error.max()))
            if progress:
                progress(0.95 * (i + 1) / len(chunks))
    return values.reshape(*nodes, -1), error


def _fitted(values: Array, axis: int, count: int, allowed: float) -> tuple[_Fit, float]:
    """Return the spline along an axis, and the largest difference of the force from the series.

    `count` is the number of intervals tried first, and `allowed` the wanted difference. `values`
    are samples at Chebyshev nodes of all axes.
    """
    lines = np.moveaxis(values[..., :3], axis, 0).reshape(values.shape[axis], -1)
    most = 2 * count
    for _ in range(_TRIALS):
        fit = _fit(values.shape[axis], count)
        blocks = np.array_split(fit.difference, math.ceil(len(fit.difference) / _ROWS))
        largest = max(
            float(np.linalg.norm((rows @ lines).reshape(-1, 3), axis=1).max()) for rows in blocks
        )
        better = max(1, math.ceil(_SPARE * count * (largest / allowed) ** (1 / ORDER)))
        if count == most or (largest <= allowed and better > _MUCH_LESS * count):
            break
        count = min(better, most)
    return fit, largest


@functools.lru_cache(maxsize=16)
def _fit(nodes: int, count: int) -> _Fit:
    """Return the spline with `count` intervals for samples at a number of Chebyshev nodes."""
    degree = nodes - 1
    to_series = 2 / nodes * chebyshev.chebvander(chebyshev.chebpts1(nodes), degree).T
    to_series[0] /= 2
    places = chebyshev.chebpts1(_FITTED * count)
    wanted = chebyshev.chebvander(places, degree) @ to_series
    coefficients = np.asarray(
        np.linalg.lstsq(_spline(places, count), wanted, rcond=None)[0], np.float64
    )
    places = np.linspace(-1.0, 1.0, _SEARCHED * count + 1)
    values = _spline(places, count) @ coefficients
    difference = np.asarray(chebyshev.chebvander(places, degree) @ to_series - values)
    return _Fit(coefficients, difference, float(np.abs(values).sum(axis=1).max()))


def _spline(places: Array, count: int) -> Array:
    """Return the matrix from coefficients to the values of a spline at places in [-1, 1].

    `count` is the number of intervals; the matrix is (places, count + 7).
    """
    scaled = count * (places + 1) / 2
    first = np.clip(scaled, 0, count - 1).astype(int)
    powers = np.vander(scaled - first, ORDER, increasing=True)
    found = np.zeros((len(places), count + ORDER - 1))
    columns: NDArray[np.int_] = first[:, None] + np.arange(ORDER)
    found[np.arange(len(places))[:, None], columns] = powers @ _WEIGHTS
    return found


def _compared(evaluate: Evaluate, made: Spline, high: Array) -> tuple[float, float]:
    """Return the largest error of a table at random positions, and the largest force there.

    `high` is the corner of the box with the highest coordinates.
    """
    rng = np.random.default_rng(5)
    places = rng.uniform(made.low, high, (_COMPARED, 3))
    exact = evaluate(places)
    read = read_alone(made, places)
    error = np.linalg.norm(read.force - exact.force, axis=1).max() + exact.error.max()
    return float(error), float(np.linalg.norm(exact.force, axis=1).max())


def read_alone(made: Spline, places: Array) -> Wrench:
    """Return the forces of a table at places (n, 3) in 1/k; the error is infinite outside of it."""
    kernel = address(made.kernel(gradient=False), KERNEL)
    return evaluated(Part(kernel, made.data(1.0, 1.0, unreached())), places, False)


@functools.cache
def spline_kernel(*, gradient: bool, functions: int) -> Kernel:
    """Return the kernel that reads a `Spline`, and another force outside of its box.

    The kernel adds gradients if `gradient`. There are three `functions`, or six with the torque.
    The entries of its data are numbers and lengths, weights, coefficients, and the other force.
    """

    @cached_njit(KERNEL, error_model="numpy", nogil=True)
    def read_spline(pose, data, wrench):  # type: ignore[no-untyped-def]
        """Add the tabled force, as a kernel."""
        pose, data, wrench = borrowed(pose), borrowed(data), borrowed(wrench)
        numbers, shape = data.numbers, begin_of(data, 0)
        weights, begin = begin_of(data, 1), begin_of(data, 2)
        wavenumber, strength = numbers[shape], numbers[shape + 1]
        count_x, count_y, count_z = (
            numbers[shape + 9], numbers[shape + 10], numbers[shape + 11],
        )  # fmt: skip
        along_z = int(count_z) + ORDER - 1
        along_y = functions * along_z
        along_x = (int(count_y) + ORDER - 1) * along_y
        room = on_stack(_ROOM, np.float64)
        for b in range(pose.position.shape[0]):
            x = (wavenumber * pose.position[b, 0] - numbers[shape + 3]) * numbers[shape + 6]
            y = (wavenumber * pose.position[b, 1] - numbers[shape + 4]) * numbers[shape + 7]
            z = (wavenumber * pose.position[b, 2] - numbers[shape + 5]) * numbers[shape + 8]
            if not (0.0 <= x <= count_x and 0.0 <= y <= count_y and 0.0 <= z <= count_z):
                add_one(part(data, 3), pose, b, wrench)
                continue
            i, j = int(min(x, count_x - 1.0)), int(min(y, count_y - 1.0))
            k = int(min(z, count_z - 1.0))
            value, slope = _weights(numbers, weights, x - i)
            store(room, _X, value)
            store(room, _DX, slope)
            value, slope = _weights(numbers, weights, y - j)
            store(room, _Y, value)
            store(room, _DY, slope)
            of_z, slope_z = _weights(numbers, weights, z - k)
            first = begin + i * along_x + j * along_y + k
            wrench.error[b] += numbers[shape + 2]
            for f in range(functions):
                value, over_x, over_y = _summed(
                    numbers, first + f * along_z, along_x, along_y, room, gradient
                )
                if f < 3:
                    wrench.force[b, f] += strength * total(value * of_z)
                    size = strength * wavenumber
                else:
                    wrench.moment[b, f - 3] += strength / wavenumber * total(value * of_z)
                    size = strength
                if gradient:
                    d_x = size * numbers[shape + 6] * total(over_x * of_z)
                    d_y = size * numbers[shape + 7] * total(over_y * of_z)
                    d_z = size * numbers[shape + 8] * total(value * slope_z)
                    slopes = wrench.force_gradient if f < 3 else wrench.moment_gradient
                    slopes[b, f % 3, 0] += d_x
                    slopes[b, f % 3, 1] += d_y
                    slopes[b, f % 3, 2] += d_z

    return read_spline


@named_njit(**INNER)
def _weights(numbers, weights, t):  # type: ignore[no-untyped-def]
    """Return the eight weights at the place t in an interval, 0 to 1, and their derivatives.

    The coefficients of their powers start at `numbers[weights]`.
    """
    value, slope = lanes(numbers, weights + (ORDER - 1) * LANES), spread(0.0)
    for power in range(ORDER - 2, -1, -1):
        slope = slope * t + value
        value = value * t + lanes(numbers, weights + power * LANES)
    return value, slope


@named_njit(**INNER)
def _summed(numbers, first, along_x, along_y, room, gradient):  # type: ignore[no-untyped-def]
    """Return a function summed over x and y, and its derivatives over both, for eight z each.

    The first of its coefficients is `numbers[first]`. Coefficients next to it along x and y are
    `along_x` and `along_y` further. `room` contains the weights. Without `gradient` the derivatives
    are zero.
    """
    value, over_x, over_y = spread(0.0), spread(0.0), spread(0.0)
    for i in range(ORDER):
        row, slope = spread(0.0), spread(0.0)
        at = first + i * along_x
        for j in range(ORDER):
            line = lanes(numbers, at + j * along_y)
            row = row + line * room[_Y + j]
            if gradient:
                slope = slope + line * room[_DY + j]
        value = value + row * room[_X + i]
        if gradient:
            over_x = over_x + row * room[_DX + i]
            over_y = over_y + slope * room[_X + i]
    return value, over_x, over_y
