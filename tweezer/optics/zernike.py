"""Projection of an array of pixels on the polynomials of Zernike.

In the unit disc a function is a sum over degrees n and orders m,

    T = sum_nm c_nm R_n^|m|(rho) exp(i m phi),   c_nm = (n + 1)/pi integral T R_n^|m| exp(-i m phi).

The polynomials of one degree are also spanned by

    Q_nk = C_(n-k)^(k+1)(x) (1 - x^2)^(k/2) P_k(y/sqrt(1 - x^2)),   k = 0, ..., n,

with the polynomials of Gegenbauer C and of Legendre P. Both are orthogonal in the disc, so that a
rotation within each degree connects them. It follows from their values on the rim, where
R_n^|m| = 1. Over the pixels of a column of an array, the integral of Q_nk along y is known, up to
the rim. Along x it is smooth between the edges of columns and the points where the rim crosses the
edge of a row.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tweezer.values.arrays import Array, Complex

#: Nodes and weights of Gauss and Legendre by their number
gauss = functools.lru_cache(maxsize=64)(np.polynomial.legendre.leggauss)
#: Error of the integrals over x, as a part of the largest |T|
_ERROR = 1e-14
#: Number of places along x that are integrated together
_TOGETHER = 32


def projected(values: Complex, width: float, degree: int) -> Complex:
    """Return the coefficients c_nm of an array of square pixels about the centre of the disc.

    Parameters
    ----------
    values : ndarray, shape (rows, columns)
        T of the pixels: x ascends over the columns and y over the rows. T is 0 outside the array.
    width : float
        Width of all columns, in radii of the disc.
    degree : int
        Highest degree n.

    Returns
    -------
    ndarray, shape (degree + 1, 2 degree + 1)
        c_nm of the degree n and the order m = -degree, ..., degree.
    """
    rows, columns = values.shape
    size = width / columns
    edges = size * (np.arange(rows + 1) - rows / 2)
    alpha, weight = _places(size * (np.arange(columns + 1) - columns / 2), edges, degree)
    x, y = np.cos(alpha), np.sin(alpha)
    steps = -np.diff(np.pad(values, ((1, 1), (0, 0))), axis=0)  # of T across each edge of a row
    right = np.floor(x / size + columns / 2).astype(int)
    there = right < columns
    x, y, weight, right = (each[there] for each in (x, y, weight, right))
    along = _along_y(edges, y, steps, right, degree) * (weight * y**2)
    found = np.zeros((degree + 1, degree + 1), np.complex128)
    for j, of_x in enumerate(_across(x, y, degree)):
        k = np.arange(degree + 1 - j)
        found[k + j, k] = np.einsum("kp,kp->k", of_x, along[j % 2, : len(k)])
    return _turned_into_orders(found)


def _places(columns: Array, rows: Array, degree: int) -> tuple[Array, Array]:
    """Return angles alpha in (0, pi/2), x = cos(alpha), and weights of integrals over alpha.

    The rule of Gauss and Legendre is applied between the edges of columns and the points where the
    rim crosses the edges of rows.
    """
    crossed = np.arccos(columns[np.abs(columns) < 1]), np.arcsin(rows[np.abs(rows) < 1])
    inside = np.clip(np.concatenate(crossed), 0.0, math.pi / 2)
    ends = np.unique(np.concatenate([inside, [0.0, math.pi / 2]]))
    half = np.diff(ends) / 2
    phase, count = (degree + 2) * float(half.max()), 1
    while (math.e * phase / (4 * count)) ** (2 * count) > _ERROR:  # the sine of the highest degree
        count += 1
    u, weight = gauss(count)
    middle = (ends[:-1] + half)[:, None]
    return (middle + half[:, None] * u).ravel(), (half[:, None] * weight).ravel()


def _along_y(
    edges: Array, y: Array, steps: Complex, columns: NDArray[np.int64], degree: int
) -> Complex:
    """Return the integrals of T times normalised P_k over t = y/sqrt(1 - x^2), (2, k, places).

    The first index is for the sum and the difference of the integrals at x and at -x. `y` (places,)
    is the end of the column at each place, and `columns` its number. `steps` (edges, columns) are
    the steps of T across the edges of rows.
    """
    rows = len(edges) - 1
    upper = edges[(rows + 1) // 2 :]
    steps = np.stack([steps + steps[:, ::-1], steps - steps[:, ::-1]])  # of x and -x
    above, below = steps[:, (rows + 1) // 2 :], steps[:, ::-1][:, (rows + 1) // 2 :]
    # the integral of P_k has the parity of k + 1
    parities = np.stack([above - below, above + below]).transpose(3, 0, 1, 2)
    parities[..., upper == 0] /= 2  # an edge on the axis is its own mirror image
    parts = np.stack([parities.real, parities.imag], axis=2)  # (columns, parities, 2, 2, edges)
    parts = parts.reshape(len(parts), 2, 4, len(upper))
    found = np.empty((degree + 1, len(y), 4))
    for first in range(0, len(y), _TOGETHER):
        at = slice(first, first + _TOGETHER)
        t = np.minimum(upper / y[at, None], 1.0)
        jumps = parts[columns[at]]
        last, here, integral = np.ones_like(t), t, t
        for k in range(degree + 1):
            if k > 0:
                after = ((2 * k + 1) / (k + 1)) * t * here - (k / (k + 1)) * last
                integral = (after - last) * (1 / (2 * k + 1))
                last, here = here, after
            found[k, at] = math.sqrt(k + 0.5) * (jumps[:, k % 2] @ integral[:, :, None])[:, :, 0]
    return np.asarray(np.moveaxis(found[..., :2] + 1j * found[..., 2:], 2, 0))


def _across(x: Array, y: Array, degree: int) -> Iterator[Array]:
    """Yield normalised C_j^(k+1)(x) y^k for j = 0, 1, ..., of k = 0 to degree - j, (k, places).

    y is +-sqrt(1 - x^2).
    """
    k = np.arange(degree + 1)
    norm = [0.5 * math.log(2 / math.pi)]  # of 1/sqrt(integral of (1 - x^2)^(k + 1/2))
    for each in k[1:]:
        norm.append(norm[-1] + 0.5 * math.log((2 * each + 2) / (2 * each + 1)))
    with np.errstate(under="ignore", divide="ignore"):
        size = np.exp(np.array(norm)[:, None] + k[:, None] * np.log(np.abs(y)))
    here = size * np.where(y < 0, (-1.0) ** k[:, None], 1.0)
    below = np.zeros_like(here)
    for j in range(degree + 1):
        yield here
        few = k[: degree - j]
        now, after = (_step(each, few)[:, None] for each in (j, j + 1))
        above = (x * here[: len(few)] - now * below[: len(few)]) / after
        below, here = here[: len(few)], above


def _step(j: int, k: NDArray[np.int64]) -> Array:
    """Return the matrix element of x between normalised C_j^(k+1) and C_(j-1)^(k+1)."""
    if j == 0:
        return np.zeros(len(k))
    return np.asarray(0.5 * np.sqrt(j * (j + 2 * k + 1) / ((j + k) * (j + k + 1))))


def _turned_into_orders(found: Complex) -> Complex:
    """Return c_nm from the coefficients of normalised Q_nk, (n, k)."""
    degree = len(found) - 1
    count = 2 * degree + 2
    phi = 2 * math.pi * (np.arange(count) + 0.5) / count
    orders = np.arange(-degree, degree + 1)
    rim = np.zeros((degree + 1, count), np.complex128)
    for j, of_x in enumerate(_across(np.cos(phi), np.sin(phi), degree)):
        k = np.arange(degree + 1 - j)
        rim[k + j] += found[k + j, k, None] * np.sqrt(k + 0.5)[:, None] * of_x
    harmonics = np.fft.fft(rim, axis=1)[:, orders] / count
    return np.asarray(harmonics * np.exp(-0.5j * orders * 2 * math.pi / count))


def radial_sums(coefficients: Complex, rho: Array) -> Complex:
    """Return t_m(rho) = sum_n c_nm R_n^|m|(rho), (orders, radii); see `projected`."""
    degree = len(coefficients) - 1
    found = np.zeros((2 * degree + 1, len(rho)), np.complex128)
    for n, radial in enumerate(_radial(rho, degree)):
        these = slice(n % 2, n + 1, 2)
        of_n, mirrored = coefficients[n, degree:], coefficients[n, degree::-1]
        found[degree:][these] += of_n[these, None] * radial
        if n % 2 == 0:
            mirrored = np.concatenate([[0.0], mirrored[1:]])  # the order 0 counts once
        found[degree::-1][these] += mirrored[these, None] * radial
    return found


def _radial(rho: Array, degree: int) -> Iterator[Array]:
    """Yield R_n^m(rho) for n = 0 to degree: (orders, radii) of the orders m = n%2, ..., n - 2, n.

    The recurrence R_n^m = rho (R_(n-1)^|m-1| + R_(n-1)^(m+1)) - R_(n-2)^m needs no factorials.
    """
    below, here = np.zeros((0, len(rho))), np.ones((1, len(rho)))
    for n in range(degree + 1):
        yield here
        outer = np.zeros((1, len(rho)))
        if n % 2 == 0:  # the next orders are 1, 3, ..., n + 1
            above = here + np.concatenate([here[1:], outer])
        else:  # they are 0, 2, ..., n + 1
            above = np.concatenate([here[:1], here]) + np.concatenate([here, outer])
        above *= rho
        above[: len(below)] -= below
        below, here = here, above


def radial_terms(
    harmonics: Complex, orders: NDArray[np.int64], rho: Array, weight: Array, degree: int
) -> Complex:
    """Return c_nm = 2 (n + 1) integral t_m(rho) R_n^|m|(rho) rho drho, (degree + 1, orders).

    Parameters
    ----------
    harmonics : ndarray, shape (radii, orders)
        Harmonics t_m.
    orders : ndarray, shape (orders,)
        Their orders m.
    rho, weight : ndarray, shape (radii,)
        Radii, and weights of the integral over them.
    degree : int
        Highest degree n.
    """
    weighted = harmonics * (rho * weight)[:, None]
    found = np.zeros((degree + 1, len(orders)), np.complex128)
    for n, radial in enumerate(_radial(rho, degree)):
        there = (np.abs(orders) <= n) & ((orders - n) % 2 == 0)
        of_orders = radial[np.abs(orders[there]) // 2]
        found[n, there] = 2 * (n + 1) * np.einsum("pm,mp->m", weighted[:, there], of_orders)
    return found
