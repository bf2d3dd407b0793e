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
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from tweezer.compiled import address, cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, total
from tweezer.errors import SceneError
from tweezer.forces.data import Data, Part, number, packed, part, vector
from tweezer.forces.force import KERNEL, Kernel, Wrench, evaluated
from tweezer.optics.beyond import add_one, unreached
from tweezer.optics.waves.partial_waves import OPTIONS

Array = NDArray[np.float64]
Progress = Callable[[float], None]

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


class Evaluate(Protocol):
    """The function that a table interpolates."""

    def __call__(self, positions: Array) -> Wrench:
        """Force, moment and estimated error at positions (n, 3)."""


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
        powers = np.empty(2 * LANES)
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
            s, t = rho / width[0], (z + reach) / width[1]
            i, j = min(int(s), across - 1), min(int(t), along - 1)
            first = (j * across + i) * functions * ORDER * LANES
            _read(
                pieces, first, 2.0 * (s - i) - 1.0, 2.0 * (t - j) - 1.0, functions, gradient,
                powers, found,
            )  # fmt: skip
            if gradient:
                slope, climb = 2.0 / width[0] / max(rho, 1e-150), 2.0 / width[1]
                for f in range(functions):
                    radial = slope * found[f, 1]
                    found[f, 1], found[f, 2] = radial * x, radial * y
                    found[f, 3] *= climb
            _put(found[:of_force], x, y, strength, gradient, wavenumber, at,
                 wrench.force, wrench.force_gradient)  # fmt: skip
            if moment:
                _put(found[of_force:], x, y, strength / wavenumber, gradient, wavenumber, at,
                     wrench.moment, wrench.moment_gradient)  # fmt: skip
            wrench.error[at] += certified

    return read_lattice


@named_njit(**OPTIONS)
def _read(pieces, first, s, t, functions, gradient, powers, found):  # type: ignore[no-untyped-def]
    """Value of each function of a piece, and its derivatives over s and t (columns 1 and 3)."""
    power = 1.0
    for k in range(LANES):
        powers[k] = power
        power *= s
    value_of = lanes(powers, 0)
    slope_of = value_of
    if gradient:
        powers[LANES] = 0.0
        for k in range(1, LANES):
            powers[LANES + k] = k * powers[k - 1]
        slope_of = lanes(powers, LANES)
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
def _put(found, x, y, unit, gradient, wavenumber, at, vectors, gradients):  # type: ignore[no-untyped-def]
    """Add a vector and its gradient from the functions f, h, g (and U, V, W) at (x, y).

    found: (functions, 4) values and derivatives over x, y, z.
    """
    f, h, g = found[0], found[1], found[2]
    vectors[at, 0] += unit * (f[0] * x - h[0] * y)
    vectors[at, 1] += unit * (f[0] * y + h[0] * x)
    vectors[at, 2] += unit * g[0]
    more = found.shape[0] > EVEN
    re_2, im_2 = x * x - y * y, 2.0 * x * y
    re_3, im_3 = x * re_2 - y * im_2, x * im_2 + y * re_2
    if more:
        U, u, V, v, W, w = found[3], found[4], found[5], found[6], found[7], found[8]
        vectors[at, 0] += unit * (U[0] * x + u[0] * y + V[0] * re_3 - v[0] * im_3)
        vectors[at, 1] += unit * (u[0] * x - U[0] * y + V[0] * im_3 + v[0] * re_3)
        vectors[at, 2] += unit * (W[0] * re_2 + w[0] * im_2)
    if not gradient:
        return
    scale = unit * wavenumber
    out = gradients[at]
    for j in range(3):
        out[0, j] += scale * (f[1 + j] * x - h[1 + j] * y)
        out[1, j] += scale * (f[1 + j] * y + h[1 + j] * x)
        out[2, j] += scale * g[1 + j]
    out[0, 0] += scale * f[0]
    out[0, 1] -= scale * h[0]
    out[1, 0] += scale * h[0]
    out[1, 1] += scale * f[0]
    if more:
        for j in range(3):
            k = 1 + j
            out[0, j] += scale * (U[k] * x + u[k] * y + V[k] * re_3 - v[k] * im_3)
            out[1, j] += scale * (u[k] * x - U[k] * y + V[k] * im_3 + v[k] * re_3)
            out[2, j] += scale * (W[k] * re_2 + w[k] * im_2)
        # d zeta^3 = 3 zeta^2 d zeta, d zeta^2 = 2 zeta d zeta
        out[0, 0] += scale * (U[0] + 3.0 * (V[0] * re_2 - v[0] * im_2))
        out[0, 1] += scale * (u[0] - 3.0 * (V[0] * im_2 + v[0] * re_2))
        out[1, 0] += scale * (u[0] + 3.0 * (V[0] * im_2 + v[0] * re_2))
        out[1, 1] += scale * (3.0 * (V[0] * re_2 - v[0] * im_2) - U[0])
        out[2, 0] += scale * 2.0 * (W[0] * x + w[0] * y)
        out[2, 1] += scale * 2.0 * (w[0] * x - W[0] * y)
