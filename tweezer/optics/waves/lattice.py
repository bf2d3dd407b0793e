"""A table of the force of waves: polynomials on a lattice of equal pieces.

The force of focused light is band-limited in the bead's position r: it is a sum of
exp(i k (s - s').r) over pairs of directions in the cone. Its wave numbers are thus at most
B = 2 k sin(theta_m) across the light and k (1 - cos(theta_m)) along it. By Bernstein's inequality
its n-th derivatives are at most B^n times the largest force. Consider polynomials of degree n - 1
in the Chebyshev nodes of pieces of half-width h. Along each axis they err by at most 2 (B h/2)^n/n!
of the largest force, wherever the piece is and whatever the bead's size.

Light that is the same all around its axis gives three functions of (rho, z), even in rho:

    F_x + i F_y = zeta (f + i h),   F_z = g,   zeta = x + i y.

Light with a Jones vector adds six, in U, V and W:

    F_x + i F_y += conj(zeta) U + zeta^3 V,   F_z += Re(conj(W) zeta^2).

Lengths are in 1/k, forces in n_m P/c, moments in n_m P/(c k).
"""

from __future__ import annotations

import functools
import math
import time
from dataclasses import dataclass

import numpy as np
from numba import int64
from numpy.polynomial import chebyshev

from tweezer.compiled import address, cached_njit, named_njit
from tweezer.compiled.lanes import (
    LANES,
    anywhere,
    as_words,
    below,
    chosen,
    lanes,
    root,
    spread,
    store,
)
from tweezer.compiled.stack import borrowed, on_stack
from tweezer.forces.data import Data, Part, begin_of, packed, part
from tweezer.forces.force import KERNEL, Kernel, evaluated
from tweezer.optics.beyond import add_one, unreached
from tweezer.optics.polynomials import (
    COEFFICIENTS,
    INNER,
    ORDER,
    PARTS,
    ROWS,
    add_up,
    coordinates,
    put,
    read,
)
from tweezer.optics.table import Evaluate, Progress
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Half-width of a piece, in 1/B, for the tolerance 1e-7
_HALF_WIDTH = 1.6
#: Largest number of polynomials: pieces times functions
_MOST_POLYNOMIALS = 1_000_000
#: Factor from the largest error found to the certified one
_SAFETY = 2.0
#: Smallest number of random places at which a table is compared with the force
_COMPARED = 2000
#: Number of times that the pieces are made smaller
_TRIALS = 4
#: Number of functions of light that is the same all around its axis
EVEN = 3

#: Chebyshev nodes on a piece, from 1 to -1
_NODES = np.cos(np.pi * (np.arange(ORDER) + 0.5) / ORDER)
#: Matrix from values at the nodes to coefficients of powers
_TO_POWERS = np.linalg.inv(np.vander(_NODES, increasing=True))


#: Entries of what the kernel finds of eight beads, and their number: the coordinates along rho and
#: along z on the piece, from -1 to 1, and the entry at which its coefficients begin (-1 outside)
_S, _T, _BEGIN, _FOUND = (LANES * k for k in range(4))
#: A number so large that doubles about it are whole numbers: adding it to a number, also a negative
#: one, and subtracting it again rounds that to a whole number
_ROUNDED = 1.5 * 2.0**52
#: 2^52, whose last 52 bits are 0, and a mask of these bits: in the sum of 2^52 and a whole number
#: as a double, they are that number as an integer
_WHOLE, _FRACTION = 2.0**52, np.uint64(2**52 - 1)


@dataclass(frozen=True)
class Lattice:
    """A force table as stored: polynomials on equal pieces of the plane (rho, z).

    Lengths are in 1/k and forces in n_m P/c, with wavenumber k, refractive index n_m and power P.
    """

    reach: float
    """largest distance from the focus at which the table is read"""
    width: Array
    """(2,) of a piece along rho and z"""
    pieces: Array
    """coefficients of the functions of `_functions`: (pieces along z, pieces along rho, functions,
    ORDER powers of z, ORDER powers of rho)"""
    moment: bool
    """whether the torque is tabled, after the force"""
    certified: float
    """bound on the error of the force"""
    largest: float
    """largest force found within the range"""
    seconds: float
    """time of the computation"""

    @property
    def count(self) -> int:
        """Number of pieces of the table, each with its own polynomials."""
        return int(self.pieces.shape[0] * self.pieces.shape[1])

    def kernel(self, *, gradient: bool) -> Kernel:
        """Return the kernel that reads this table, and adds gradients if `gradient`."""
        functions = self.pieces.shape[2] // (2 if self.moment else 1)
        return lattice_kernel(gradient=gradient, functions=functions, moment=self.moment)

    def data(self, unit: float, strength: float, beyond: Part) -> Data:
        """Return the data of the kernel.

        `unit` is 1/k (m) and `strength` n_m P/c (N). The force beyond `reach` is `beyond`.
        """
        along, across = self.pieces.shape[:2]
        shape = np.array(
            [1 / unit, strength, self.certified * strength, self.reach, across, along,
             *(2 / self.width)]
        )  # fmt: skip
        return packed(shape, self.pieces.ravel(), beyond)


def build(
    evaluate: Evaluate,
    *,
    band: tuple[float, float],
    reach: float,
    tolerance: float,
    symmetric: bool,
    moment: bool,
    progress: Progress | None = None,
) -> Lattice:
    """Compute the table of a force around the focus.

    Pieces are made smaller until the table's error is below `tolerance` of the largest force at
    random positions. The certified error is twice the sum of its largest error there and the
    largest error of the force itself.

    Parameters
    ----------
    evaluate : callable
        Force at positions.
    band : pair of float
        Largest wave numbers of the force across and along the light, in k.
    reach : float
        Largest distance from the focus, 1/k.
    tolerance : float
        Error of the force, as a fraction of the largest force.
    symmetric : bool
        Whether the light is rotationally symmetric about its axis.
    moment : bool
        Whether to tabulate the torque too.
    progress : callable, optional
        Called with the finished fraction.

    Raises
    ------
    SceneError
        For a range of too many pieces.
    """
    began = time.perf_counter()
    half_width = _HALF_WIDTH * (tolerance / 1e-7) ** (1 / ORDER)
    functions = (EVEN if symmetric else 3 * EVEN) * (2 if moment else 1)
    _pieces(band, reach, half_width, functions)
    values, largest = _sampled(evaluate, band, reach, tolerance, symmetric, moment)
    if progress:
        progress(0.5)
    for _ in range(_TRIALS):
        lattice = _divided(values, band, reach, half_width, moment)
        error, biggest = _compared(evaluate, lattice)
        largest = max(largest, biggest)
        if error <= tolerance * largest or not largest:
            break
        half_width *= min(0.9, 0.9 * (tolerance * largest / error) ** (1 / ORDER))
    if progress:
        progress(1.0)
    seconds = time.perf_counter() - began
    return Lattice(reach, lattice.width, lattice.pieces, moment, error, largest, seconds)


def _counts(band: tuple[float, float], reach: float, tolerance: float) -> tuple[int, int]:
    """Return the numbers of Chebyshev nodes across and along the light over [-reach, reach].

    The coefficients of a plane wave of wave number b are the Bessel functions J_n(b reach). The
    numbers are the degrees n above which these are below a hundredth of `tolerance`. `band` are the
    wave numbers across and along (in k), and `reach` is in 1/k.
    """
    digits = -math.log(1e-2 * tolerance)
    far = [
        edge * reach + (1.5 * digits) ** (2 / 3) * (edge * reach / 2) ** (1 / 3) + 8
        for edge in band
    ]
    across, along = (2 * math.ceil(each / 2) for each in far)
    return across, along


def _sampled(
    evaluate: Evaluate,
    band: tuple[float, float],
    reach: float,
    tolerance: float,
    symmetric: bool,
    moment: bool,
) -> tuple[Array, float]:
    """Return the Chebyshev series of the functions of (rho, z), and the largest force sampled.

    `_functions` describes the force, and then the torque, by these functions. The series is
    (functions, along, across), over [-reach, reach] of z and of rho. As the functions are even in
    rho, `across` counts even degrees alone. `build` describes the arguments.
    """
    across, along = _counts(band, reach, tolerance)
    rho = reach * chebyshev.chebpts1(across)[across // 2 :]
    z = reach * chebyshev.chebpts1(along)
    azimuths = np.zeros(1) if symmetric else np.arange(3) * math.pi / 3
    grid = np.stack(np.meshgrid(z, rho, azimuths, indexing="ij"), axis=-1).reshape(-1, 3)
    places = np.stack(
        [grid[:, 1] * np.cos(grid[:, 2]), grid[:, 1] * np.sin(grid[:, 2]), grid[:, 0]], axis=1
    )
    found = evaluate(places)
    shape = along, rho.size, azimuths.size
    functions = [
        _functions(field.reshape((*shape, 3)), rho, azimuths)
        for field in (found.force, found.moment)[: 2 if moment else 1]
    ]
    values = np.concatenate(functions)
    # values at the nodes times these are coefficients; half of the nodes of rho are its negatives
    even = 2 * chebyshev.chebvander(rho / reach, across - 2)[:, ::2] / (across / 2)
    even[:, 0] /= 2
    whole = 2 * chebyshev.chebvander(z / reach, along - 1) / along
    whole[:, 0] /= 2
    largest = float(np.linalg.norm(found.force, axis=1).max())
    return np.einsum("fzr,zi,rj->fij", values, whole, even, optimize=True), largest


def _functions(vectors: Array, rho: Array, azimuths: Array) -> Array:
    """Return the functions of (rho, z) that describe a field of vectors, (functions, along z, rho).

    They are f, h, g, then the real and imaginary parts of U, V, W for a vector F(x, y, z). With
    zeta = x + i y, F_x + i F_y = zeta (f + i h) + conj(zeta) U + zeta^3 V and
    F_z = g + Re(conj(W) zeta^2). `vectors` are (along z, rho, azimuths, 3), with `rho` in 1/k and
    `azimuths` in rad. Light that is the same all around its axis has one azimuth and f, h and g
    alone. Other light has three azimuths, evenly over half a turn.
    """
    turn = np.exp(-1j * azimuths)
    lateral = (vectors[..., 0] + 1j * vectors[..., 1]) * turn  # radial + i azimuthal
    axial = vectors[..., 2]
    if azimuths.size == 1:
        middle, g = lateral[..., 0] / rho, axial[..., 0]
        return np.stack([middle.real, middle.imag, g])
    wave = np.exp(-2j * azimuths) / azimuths.size
    middle = lateral.mean(axis=-1) / rho
    U = (lateral * wave.conj()).sum(axis=-1) / rho
    V = (lateral * wave).sum(axis=-1) / rho**3
    W = 2 * (axial * wave.conj()).sum(axis=-1) / rho**2
    pairs = (part for each in (U, V, W) for part in (each.real, each.imag))
    return np.stack([middle.real, middle.imag, axial.mean(axis=-1), *pairs])


def _divided(
    series: Array, band: tuple[float, float], reach: float, half_width: float, moment: bool
) -> Lattice:
    """Return the table of polynomials on pieces that equals a Chebyshev series at their nodes.

    `series` (functions, along, across) is a result of `_sampled`, and `build` describes `band`,
    `reach` and `moment`. A piece has the `half_width` in 1/B, with the wave number B of the band.
    The errors are not known yet and set to 0.
    """
    counts = _pieces(band, reach, half_width, series.shape[0])
    across = _to_pieces(counts[0], 0.0, 1.0, 2 * series.shape[2] - 2)[:, :, ::2]
    along = _to_pieces(counts[1], -1.0, 1.0, series.shape[1] - 1)
    pieces = np.einsum("fij,zai,rbj->zrfab", series, along, across, optimize=True)
    width = np.array([reach / counts[0], 2 * reach / counts[1]])
    return Lattice(reach, width, np.ascontiguousarray(pieces), moment, 0.0, 0.0, 0.0)


def _pieces(
    band: tuple[float, float], reach: float, half_width: float, functions: int
) -> list[int]:
    """Return the numbers of pieces along rho and z. Raises `SceneError` if they are too many.

    `band` are wave numbers B along both (in k), and `reach` is in 1/k. A piece has the `half_width`
    in 1/B. `functions` is the number of functions on each piece.
    """
    counts = [
        max(1, math.ceil(edge * length / (2 * half_width)))
        for edge, length in zip(band, (reach, 2 * reach), strict=True)
    ]
    if math.prod(counts) * functions > _MOST_POLYNOMIALS:
        raise SceneError(
            f"optics.table_range: {math.prod(counts):.2g} pieces are too many for a map, allowed: "
            f"{_MOST_POLYNOMIALS // functions}; choose a smaller range, or optics.evaluator = "
            "'quadrature'"
        )
    return counts


def _to_pieces(count: int, begin: float, end: float, degree: int) -> Array:
    """Return the matrices that convert a Chebyshev series on [-1, 1] to powers on equal pieces.

    `count` pieces divide [begin, end]. The matrices are (count, ORDER, degree + 1), for powers of
    the coordinate from -1 to 1 on a piece, and Chebyshev coefficients up to `degree`.
    """
    middle = begin + (end - begin) * (np.arange(count) + 0.5) / count
    places = middle[:, None] + (end - begin) / (2 * count) * _NODES
    return np.einsum("an,cnd->cad", _TO_POWERS, chebyshev.chebvander(places, degree))


def _compared(evaluate: Evaluate, lattice: Lattice) -> tuple[float, float]:
    """Return the certified error of a table, and the largest force found, in n_m P/c.

    The table is compared with `evaluate` at random positions within its range.
    """
    rng = np.random.default_rng(5)
    count = max(_COMPARED, lattice.count)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    places = lattice.reach * 0.999 * rng.random((count, 1)) ** 0.5 * directions
    exact = evaluate(places)
    kernel = address(lattice.kernel(gradient=False), KERNEL)
    reader = Part(kernel, lattice.data(1.0, 1.0, unreached()))
    read = evaluated(reader, places, False)
    error = np.linalg.norm(read.force - exact.force, axis=1).max() + exact.error.max()
    return _SAFETY * float(error), float(np.linalg.norm(exact.force, axis=1).max())


@functools.cache
def lattice_kernel(*, gradient: bool, functions: int, moment: bool) -> Kernel:
    """Return the kernel that reads a `Lattice`, and another force beyond its reach.

    The kernel adds gradients if `gradient`. The force has `functions` functions of (rho, z); with
    `moment` the torque has as many. The entries of its data are numbers and lengths, coefficients,
    and the other force.
    """
    kinds, all_functions = 3 if gradient else 1, 2 * functions if moment else functions
    of_rows = all_functions * ROWS * (2 if gradient else 1)
    of_values, of_piece = kinds * all_functions * LANES, all_functions * COEFFICIENTS
    second = kinds * functions * LANES

    @cached_njit(KERNEL, error_model="numpy", nogil=True)
    def read_lattice(pose, data, wrench):  # type: ignore[no-untyped-def]
        """Add the tabled force, as a kernel: eight beads at a time are looked up and evaluated."""
        pose, data, wrench = borrowed(pose), borrowed(data), borrowed(wrench)
        numbers, shape = data.numbers, begin_of(data, 0)
        wavenumber, strength, certified, reach = (
            numbers[shape], numbers[shape + 1], numbers[shape + 2], numbers[shape + 3],
        )  # fmt: skip
        across, along = numbers[shape + 4], numbers[shape + 5]
        # slopes of the local coordinates, from -1 to 1 on a piece, over rho and z in 1/k
        per_width, per_height = numbers[shape + 6], numbers[shape + 7]
        pieces = begin_of(data, 1)
        first, there = on_stack(LANES, np.int64), on_stack(LANES, np.int64)
        found, rows = on_stack(_FOUND, np.float64), on_stack(of_rows, np.float64)
        values, parts = on_stack(of_values, np.float64), on_stack(PARTS, np.float64)
        n = pose.position.shape[0]
        for at in range(0, n, LANES):
            many = min(LANES, n - at)
            x, y, z = coordinates(pose.position, at, many, found)
            x, y, z = wavenumber * x, wavenumber * y, wavenumber * z
            # beads outside read the first piece, whose values are then left out by `there`
            square = x * x + y * y
            rho = root(square)
            s, t = (0.5 * per_width) * rho, (0.5 * per_height) * (z + reach)
            i, j = _piece(s, across), _piece(t, along)
            store(found, _S, 2.0 * (s - i) - 1.0)
            store(found, _T, 2.0 * (t - j) - 1.0)
            begins = (j * across + i) * float(of_piece) + float(pieces)
            inside = below(square + z * z, spread(reach * reach))
            begins = chosen(inside, begins, spread(-1.0))
            whole = many == LANES and not anywhere(below(begins, spread(0.0)))
            store(first, 0, as_words(begins + _WHOLE) & _FRACTION)
            if whole:
                store(wrench.error, at, lanes(wrench.error, at) + certified)
            else:
                store(found, _BEGIN, begins)
                for k in range(many):
                    there[k] = int64(found[_BEGIN + k] >= 0.0)
                    if there[k] != 0:
                        wrench.error[at + k] += certified
                    else:
                        first[k] = pieces
                        add_one(part(data, 2), pose, at + k, wrench)
            read(numbers, first, all_functions, many, found, _T, _S, gradient, rows, values)
            slope = per_width / rho
            # 0 on the axis, where rho = 0 has no bit set and 1/rho is infinite
            slope = chosen(as_words(rho), slope, spread(0.0))
            _put(
                values, 0, functions, x, y, slope, per_height, strength, wavenumber, gradient,
                parts,
            )  # fmt: skip
            add_up(parts, there, at, many, whole, gradient, wrench.force, wrench.force_gradient)
            if moment:
                _put(
                    values, second, functions, x, y, slope, per_height, strength / wavenumber,
                    wavenumber, gradient, parts,
                )  # fmt: skip
                add_up(
                    parts, there, at, many, whole, gradient, wrench.moment,
                    wrench.moment_gradient,
                )  # fmt: skip

    return read_lattice


@named_njit(**INNER)
def _piece(place, count):  # type: ignore[no-untyped-def]
    """Return the numbers, from 0, of the pieces in which eight beads are, along one axis.

    `place` are coordinates in widths of a piece, from the first piece. There are `count` pieces;
    coordinates beyond them give the first or the last. A coordinate less 1/2, rounded, is its
    floor.
    """
    rounded = ((place - 0.5) + _ROUNDED) - _ROUNDED
    last = spread(count - 1.0)
    within = chosen(below(last, rounded), last, rounded)
    return chosen(below(within, spread(0.0)), spread(0.0), within)


@named_njit(**INNER)
def _function(values, at, slope, per_height, x, y, gradient):  # type: ignore[no-untyped-def]
    """Return one function of (rho, z) and its derivatives over x, y, z in 1/k, for eight beads.

    The output of `read` for this function starts at `values[at]`. It contains the function and its
    derivatives over the local coordinates of z and rho, which run from -1 to 1 on a piece. `slope`
    is (d local/d rho)/rho and `per_height` is d local/dz. x and y are positions of the beads. All
    lengths are in 1/k.

    Compiled code always returns four numbers. Without `gradient` the value replaces the three
    derivatives, which no caller reads.
    """
    value = lanes(values, at)
    if not gradient:
        return value, value, value, value
    radial = slope * lanes(values, at + 2 * LANES)
    return value, radial * x, radial * y, per_height * lanes(values, at + LANES)


@named_njit(**INNER)
def _put(values, at, functions, x, y, slope, per_height, unit, wavenumber, gradient, parts):  # type: ignore[no-untyped-def]
    """Fill `parts` with a vector of eight beads, force or torque, and its gradient.

    With zeta = x + i y the vector is F_x + i F_y = zeta (f + i h) + conj(zeta) U + zeta^3 V and
    F_z = g + Re(conj(W) zeta^2). If `functions` is three (f, h, g) instead of nine, U, V and W are
    zero.

    The output of `read` for these functions starts at `values[at]`. `slope`, `per_height`, x, y and
    `gradient` are described in `_function`. `unit` is the size of the vector, N or N m, for a value
    of 1. `wavenumber` is k, 1/m, and the gradient is in units of `unit` times k. `parts` is
    described in `polynomials.add_up`.
    """
    each = 3 * LANES if gradient else LANES
    f = _function(values, at, slope, per_height, x, y, gradient)
    h = _function(values, at + each, slope, per_height, x, y, gradient)
    g = _function(values, at + 2 * each, slope, per_height, x, y, gradient)
    put(f, h, g, x, y, unit, wavenumber, gradient, parts)
    if functions == EVEN:
        return
    # capital letters: real parts, small ones: imaginary parts
    U = _function(values, at + 3 * each, slope, per_height, x, y, gradient)
    u = _function(values, at + 4 * each, slope, per_height, x, y, gradient)
    V = _function(values, at + 5 * each, slope, per_height, x, y, gradient)
    v = _function(values, at + 6 * each, slope, per_height, x, y, gradient)
    W = _function(values, at + 7 * each, slope, per_height, x, y, gradient)
    w = _function(values, at + 8 * each, slope, per_height, x, y, gradient)
    scale = unit * wavenumber
    # zeta^2 and zeta^3, zeta = x + i y
    re_2, im_2 = x * x - y * y, 2.0 * x * y
    re_3, im_3 = x * re_2 - y * im_2, x * im_2 + y * re_2
    for k in range(4 if gradient else 1):  # the vector (k = 0) and its derivatives over x, y, z
        size = unit if k == 0 else scale
        a = U[k] * x + u[k] * y + V[k] * re_3 - v[k] * im_3
        b = u[k] * x - U[k] * y + V[k] * im_3 + v[k] * re_3
        c = W[k] * re_2 + w[k] * im_2
        if k == 0:
            _add(parts, 0, size * a)
            _add(parts, LANES, size * b)
            _add(parts, 2 * LANES, size * c)
        else:
            _add(parts, (2 + k) * LANES, size * a)
            _add(parts, (5 + k) * LANES, size * b)
            _add(parts, (8 + k) * LANES, size * c)
    if gradient:  # d zeta^3 = 3 zeta^2 d zeta, d zeta^2 = 2 zeta d zeta
        down = 3.0 * (V[0] * re_2 - v[0] * im_2)
        over = 3.0 * (V[0] * im_2 + v[0] * re_2)
        _add(parts, 3 * LANES, scale * (U[0] + down))
        _add(parts, 4 * LANES, scale * (u[0] - over))
        _add(parts, 6 * LANES, scale * (u[0] + over))
        _add(parts, 7 * LANES, scale * (down - U[0]))
        _add(parts, 9 * LANES, scale * 2.0 * (W[0] * x + w[0] * y))
        _add(parts, 10 * LANES, scale * 2.0 * (w[0] * x - W[0] * y))


@named_njit(**INNER)
def _add(parts, at, value):  # type: ignore[no-untyped-def]
    """Add eight numbers to the eight entries of `parts` that begin at `at`."""
    store(parts, at, lanes(parts, at) + value)
