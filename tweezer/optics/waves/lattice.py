"""A table of the force of waves: polynomials on a lattice of equal pieces.

The force of focused light is band-limited in the bead's position r: it is a sum of
exp(i k (s - s').r) over pairs of directions in the cone, so its wave numbers are at most
B = 2 k sin(theta_m) across the light and k (1 - cos(theta_m)) along it. By Bernstein's inequality
its n-th derivatives are at most B^n times the largest force. So polynomials of degree n - 1 in the
Chebyshev nodes of pieces of half-width h err by at most 2 (B h/2)^n/n! of it along each axis,
wherever the piece lies and whatever the bead's size.

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
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from tweezer.compiled import address, cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, total
from tweezer.errors import SceneError
from tweezer.forces.data import Data, Part, number, packed, part, vector
from tweezer.forces.force import KERNEL, Kernel, evaluated
from tweezer.optics.beyond import add_one, unreached
from tweezer.optics.table import Evaluate, Progress
from tweezer.optics.waves.partial_waves import OPTIONS

Array = NDArray[np.float64]

#: Number of nodes of a piece along each axis
ORDER = LANES
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

_NODES = np.cos(np.pi * (np.arange(ORDER) + 0.5) / ORDER)
#: Matrix from values at the nodes to coefficients of powers
_TO_POWERS = np.linalg.inv(np.vander(_NODES, increasing=True))


def _digits(numbers: NDArray[np.int64]) -> Array:
    """Binary digits of numbers up to 7, the lowest first, (3, n)."""
    return np.array([(numbers >> digit) & 1 for digit in range(3)], dtype=np.float64)


_K = np.arange(ORDER, dtype=np.int64)
#: Digits of k and of k - 1, and k: powers s^k, and their derivatives k s^(k-1)
_EXPONENTS = np.concatenate([_digits(_K), _digits(np.maximum(_K - 1, 0)), _K[None]]).ravel()


@dataclass(frozen=True)
class Lattice:
    """A table as stored, in 1/k and n_m P/c."""

    reach: float
    """range, distance from the focus"""
    width: Array
    """(2,) of a piece along rho and z"""
    pieces: Array
    """(along z, along rho, functions, ORDER powers of z, ORDER powers of rho)"""
    moment: bool
    """whether the moment is tabled, after the force"""
    certified: float
    """bound on the error of the force"""
    largest: float
    """largest force found within the range"""
    seconds: float
    """time of the computation"""

    @property
    def count(self) -> int:
        """Number of pieces."""
        return int(self.pieces.shape[0] * self.pieces.shape[1])

    def kernel(self, *, gradient: bool) -> Kernel:
        """Kernel that reads it."""
        return lattice_kernel(gradient=gradient)

    def data(self, unit: float, strength: float, beyond: Part) -> Data:
        """Data of the kernel. unit: 1/k, m. strength: n_m P/c, N. beyond: force out of range."""
        return packed(
            1 / unit, strength, self.certified * strength, self.reach, self.width,
            np.array(self.pieces.shape[:3]), self.pieces.ravel(), float(self.moment), beyond,
            _EXPONENTS,
        )  # fmt: skip


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
    """The table of a force within `reach` of the focus.

    band: largest wave numbers across and along the light, in k. symmetric: whether the light is the
    same all around its axis. Pieces are made smaller until the table errs by less than `tolerance`
    of the largest force at random places; twice its largest error there, and that of the force
    itself, is the certified error. Raises `SceneError` for a range of too many pieces.
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
    """Numbers of Chebyshev nodes, for degrees beyond which Bessel functions are below it."""
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
    """Chebyshev coefficients of the functions over [-reach, reach], (functions, along, across).

    Those across the light are of even degree. Also the largest force.
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
    even = 2 * chebyshev.chebvander(rho / reach, across - 2)[:, ::2] / (across / 2)
    even[:, 0] /= 2
    whole = 2 * chebyshev.chebvander(z / reach, along - 1) / along
    whole[:, 0] /= 2
    largest = float(np.linalg.norm(found.force, axis=1).max())
    return np.einsum("fzr,zi,rj->fij", values, whole, even, optimize=True), largest


def _functions(vectors: Array, rho: Array, azimuths: Array) -> Array:
    """f, h, g, and the parts of U, V, W, from vectors (along z, rho, azimuths, 3)."""
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
    """The lattice of a Chebyshev series."""
    counts = _pieces(band, reach, half_width, series.shape[0])
    across = _to_pieces(counts[0], 0.0, 1.0, 2 * series.shape[2] - 2)[:, :, ::2]
    along = _to_pieces(counts[1], -1.0, 1.0, series.shape[1] - 1)
    pieces = np.einsum("fij,zai,rbj->zrfab", series, along, across, optimize=True)
    width = np.array([reach / counts[0], 2 * reach / counts[1]])
    return Lattice(reach, width, np.ascontiguousarray(pieces), moment, 0.0, 0.0, 0.0)


def _pieces(
    band: tuple[float, float], reach: float, half_width: float, functions: int
) -> list[int]:
    """Numbers of pieces along rho and z. Raises `SceneError` if they are too many."""
    counts = [
        max(1, math.ceil(edge * length / (2 * half_width)))
        for edge, length in zip(band, (reach, 2 * reach), strict=True)
    ]
    if math.prod(counts) * functions > _MOST_POLYNOMIALS:
        raise SceneError(
            f"optics.table_range: {math.prod(counts):.2g} pieces are too many for a map, allowed: "
            f"{_MOST_POLYNOMIALS // functions}; take a smaller range, or optics.evaluator = "
            "'quadrature'"
        )
    return counts


def _to_pieces(count: int, begin: float, end: float, degree: int) -> Array:
    """Matrix from Chebyshev coefficients to powers on each piece, (count, ORDER, degree + 1)."""
    middle = begin + (end - begin) * (np.arange(count) + 0.5) / count
    places = middle[:, None] + (end - begin) / (2 * count) * _NODES
    return np.einsum("an,cnd->cad", _TO_POWERS, chebyshev.chebvander(places, degree))


def _compared(evaluate: Evaluate, lattice: Lattice) -> tuple[float, float]:
    """Certified error of the table, and the largest force met."""
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
def lattice_kernel(*, gradient: bool) -> Kernel:
    """Reads a lattice; another force where it ends."""

    @cached_njit(KERNEL, error_model="numpy", nogil=True)
    def read_lattice(pose, data, wrench):  # type: ignore[no-untyped-def]
        wavenumber, strength, certified, reach = (
            number(data, 0), number(data, 1), number(data, 2), number(data, 3),
        )  # fmt: skip
        width, shape, pieces = vector(data, 4), vector(data, 5), vector(data, 6)
        moment = number(data, 7) > 0.0
        across, along, functions = int(shape[1]), int(shape[0]), int(shape[2])
        of_force = functions // 2 if moment else functions
        exponents = vector(data, 9)
        # of the local coordinates, from -1 to 1 on a piece, over rho and z
        per_width, per_height = 2.0 / width[0], 2.0 / width[1]
        found = np.empty((functions, 4))
        for at in range(pose.position.shape[0]):
            x = wavenumber * pose.position[at, 0]
            y = wavenumber * pose.position[at, 1]
            z = wavenumber * pose.position[at, 2]
            square = x * x + y * y
            if square + z * z > reach * reach:
                add_one(part(data, 8), pose, at, wrench)
                continue
            rho = math.sqrt(square)
            s, t = 0.5 * per_width * rho, 0.5 * per_height * (z + reach)
            i, j = min(int(s), across - 1), min(int(t), along - 1)
            first = (j * across + i) * functions * ORDER * LANES
            _read(
                pieces, first, 2.0 * (s - i) - 1.0, 2.0 * (t - j) - 1.0, functions, gradient,
                exponents, found,
            )  # fmt: skip
            if gradient:
                slope = per_width / max(rho, 1e-150)
                for f in range(functions):
                    radial = slope * found[f, 1]
                    found[f, 1], found[f, 2] = radial * x, radial * y
                    found[f, 3] *= per_height
            _put(
                found, 0, of_force, x, y, strength, gradient, wavenumber, at, wrench.force,
                wrench.force_gradient,
            )  # fmt: skip
            if moment:
                _put(
                    found, of_force, of_force, x, y, strength / wavenumber, gradient, wavenumber,
                    at, wrench.moment, wrench.moment_gradient,
                )  # fmt: skip
            wrench.error[at] += certified

    return read_lattice


@named_njit(**OPTIONS)
def _read(pieces, first, s, t, functions, gradient, exponents, found):  # type: ignore[no-untyped-def]
    """Value of each function of a piece, and its derivatives over s and t (columns 1 and 3)."""
    value_of = _powers(exponents, 0, s)
    slope_of = value_of
    if gradient:
        slope_of = _powers(exponents, 3 * LANES, s) * lanes(exponents, 6 * LANES)
    for f in range(functions):
        begin = first + f * ORDER * LANES
        row = lanes(pieces, begin + (ORDER - 1) * LANES)
        climb = spread(0.0)
        for k in range(ORDER - 2, -1, -1):
            if gradient:
                climb = climb * t + row
            row = row * t + lanes(pieces, begin + k * LANES)
        found[f, 0] = total(row * value_of)
        if gradient:
            found[f, 1] = total(row * slope_of)
            found[f, 3] = total(climb * value_of)


@named_njit(**OPTIONS)
def _powers(exponents, first, s):  # type: ignore[no-untyped-def]
    """Eight powers of s, from the binary digits of their exponents."""
    square = s * s
    fourth = square * square
    one = spread(1.0)
    low = one + lanes(exponents, first) * (s - 1.0)
    middle = one + lanes(exponents, first + LANES) * (square - 1.0)
    high = one + lanes(exponents, first + 2 * LANES) * (fourth - 1.0)
    return low * middle * high


@named_njit(**OPTIONS)
def _put(found, f, functions, x, y, unit, gradient, wavenumber, at, vectors, gradients):  # type: ignore[no-untyped-def]
    """Add a vector and its gradient from the functions f, h, g (and U, V, W) at (x, y).

    found: (functions, 4) values and derivatives over x, y, z. f: row of the first of them. Entries
    are read one by one: views of rows would cost more than all else.
    """
    h, g = f + 1, f + 2
    vectors[at, 0] += unit * (found[f, 0] * x - found[h, 0] * y)
    vectors[at, 1] += unit * (found[f, 0] * y + found[h, 0] * x)
    vectors[at, 2] += unit * found[g, 0]
    scale = unit * wavenumber
    if gradient:
        for j in range(3):
            gradients[at, 0, j] += scale * (found[f, j + 1] * x - found[h, j + 1] * y)
            gradients[at, 1, j] += scale * (found[f, j + 1] * y + found[h, j + 1] * x)
            gradients[at, 2, j] += scale * found[g, j + 1]
        gradients[at, 0, 0] += scale * found[f, 0]
        gradients[at, 0, 1] -= scale * found[h, 0]
        gradients[at, 1, 0] += scale * found[h, 0]
        gradients[at, 1, 1] += scale * found[f, 0]
    if functions == EVEN:
        return
    re_2, im_2 = x * x - y * y, 2.0 * x * y
    re_3, im_3 = x * re_2 - y * im_2, x * im_2 + y * re_2
    U, u, V, v, W, w = f + 3, f + 4, f + 5, f + 6, f + 7, f + 8
    for k in range(4 if gradient else 1):
        a = found[U, k] * x + found[u, k] * y + found[V, k] * re_3 - found[v, k] * im_3
        b = found[u, k] * x - found[U, k] * y + found[V, k] * im_3 + found[v, k] * re_3
        c = found[W, k] * re_2 + found[w, k] * im_2
        if k == 0:
            vectors[at, 0] += unit * a
            vectors[at, 1] += unit * b
            vectors[at, 2] += unit * c
        else:
            gradients[at, 0, k - 1] += scale * a
            gradients[at, 1, k - 1] += scale * b
            gradients[at, 2, k - 1] += scale * c
    if gradient:  # d zeta^3 = 3 zeta^2 d zeta, d zeta^2 = 2 zeta d zeta
        along = 3.0 * (found[V, 0] * re_2 - found[v, 0] * im_2)
        across = 3.0 * (found[V, 0] * im_2 + found[v, 0] * re_2)
        gradients[at, 0, 0] += scale * (found[U, 0] + along)
        gradients[at, 0, 1] += scale * (found[u, 0] - across)
        gradients[at, 1, 0] += scale * (found[u, 0] + across)
        gradients[at, 1, 1] += scale * (along - found[U, 0])
        gradients[at, 2, 0] += scale * 2.0 * (found[W, 0] * x + found[w, 0] * y)
        gradients[at, 2, 1] += scale * 2.0 * (found[w, 0] * x - found[W, 0] * y)
