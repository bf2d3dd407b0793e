"""Vector spherical waves about another point: the matrix elements of exp(i k s.d).

The light about the point d has the amplitudes exp(i k s.d) p. Between harmonics of one helicity and
with d along z,

    <n'm|exp(i k s.d)|nm> = sum over L of i^L (2L+1) j_L(kd) g_L,
    g_L = 2 pi int f_n'm f_nm P_L du
        = (-1)^(m-1) sqrt((2n+1) (2n'+1)) (n' n L; -m m 0) (n' n L; -1 1 0),

with two 3j symbols and L from |n-n'| to n+n'. For waves that leave a neighbour h_L takes the place
of j_L. Other directions follow by rotation. For helicity -1 each term has a sign (-1)^(n+n'+L).
Hence the terms of even n+n'+L, whose sum is called A, couple electric to electric and magnetic to
magnetic waves. The sum B of the terms of odd n+n'+L couples electric to magnetic waves.
"""

from __future__ import annotations

import functools
import math

import numpy as np

from tweezer.optics.bodies.rotation import wigner_d
from tweezer.optics.bodies.t_matrix import Integers
from tweezer.values.arrays import Array, Complex

#: Degrees for which tables are made, so that a few serve all degrees
_DEGREES = (16, 32, 48, 80)


def three_j(shorter: int, longer: Integers, orders: Integers) -> Array:
    """Return the 3j symbols (n' n L; -m m 0) of all L, up to a sign that is common to all orders.

    The sign is (-1)^(n-n'). The three-term recurrence in L (Schulten and Gordon, J. Math. Phys. 16,
    1961 (1975)) is followed from both ends, where it is stable, to a matching point in the range
    that is allowed classically. Symbols that are far smaller than the largest one thus keep their
    relative accuracy.

    Parameters
    ----------
    shorter : int
        Smaller one of the two degrees, n'.
    longer : ndarray, shape (degrees,)
        Larger ones, n >= n'.
    orders : ndarray, shape (orders,)
        Orders m, from 0 to n'.

    Returns
    -------
    ndarray, shape (2n' + 1, orders, degrees)
        3j symbols of L = n - n', ..., n + n'.
    """
    count = 2 * shorter + 1
    m, n = orders[:, None].astype(np.float64), longer[None, :].astype(np.float64)
    L = n - shorter + np.arange(count + 1.0)[:, None, None]
    # side[i] couples L of index i - 1 and i
    side = np.sqrt((L**2 - (n - shorter) ** 2) * np.maximum((n + shorter + 1) ** 2 - L**2, 0.0))
    middle = 2 * m * (2 * L + 1)
    up, down = np.zeros((2, count, m.size, n.size))
    up[0] = down[-1] = 1.0
    for i in range(count - 1):
        below = side[i] * up[i - 1] if i else 0.0
        up[i + 1] = -(middle[i] * up[i] + below) / side[i + 1]
    for i in range(count - 1, 0, -1):
        above = side[i + 1] * down[i + 1] if i < count - 1 else 0.0
        down[i - 1] = -(middle[i] * down[i] + above) / side[i]
    centre = np.sqrt(shorter * (shorter + 1) + n * (n + 1) - 2 * m**2) - (n - shorter)
    at = np.clip(np.rint(centre).astype(np.int64), 0, count - 2)[None]
    pair_up, pair_down = (
        np.concatenate([np.take_along_axis(each, at + i, 0) for i in (0, 1)]) for each in (up, down)
    )
    # in the sense of least squares, as one of the two may be zero
    factor = (pair_up * pair_down).sum(0) / (pair_up**2).sum(0)
    found = np.where(np.arange(count)[:, None, None] <= at, factor * up, down)
    return found / np.sqrt(((2 * L[:-1] + 1) * found**2).sum(0))


@functools.lru_cache(maxsize=4)
def _couplings(degree: int) -> tuple[Array, ...]:
    """Return tables of (2L+1) g_L for m >= 0, that of the smaller degree n' at index n' - 1.

    A table is (orders 0 to n', larger degrees n' to `degree`, L from n - n' to n + n').
    """
    tables = []
    for shorter in range(1, degree + 1):
        orders, n = np.arange(shorter + 1), np.arange(shorter, degree + 1)
        symbols = three_j(shorter, n, orders)
        L = n - shorter + np.arange(2 * shorter + 1.0)[:, None]
        sizes = (2 * L + 1) * np.sqrt((2 * n + 1) * (2 * shorter + 1))
        g = symbols * symbols[:, 1:2] * sizes[:, None, :] * (-1.0) ** (orders - 1)[:, None]
        tables.append(np.ascontiguousarray(np.moveaxis(g, 0, 2)))
    return tuple(tables)


def spherical_bessel(x: float, highest: int) -> Array:
    """Return the spherical Bessel functions j_L(x), L = 0..highest, of x >= 0."""
    found = np.zeros(highest + 1)
    if x == 0:
        found[0] = 1.0
        return found
    turn = min(int(x), highest)
    found[0] = np.sin(x) / x
    if turn > 0:
        found[1] = (found[0] - np.cos(x)) / x
    for L in range(1, turn):
        found[L + 1] = (2 * L + 1) / x * found[L] - found[L - 1]
    # above L = x the functions fall, and only their ratios are stable, from the top down
    ratios = np.zeros(highest + int(x) + 22)
    for L in range(len(ratios) - 2, turn, -1):
        ratios[L] = x / (2 * L + 1 - x * ratios[L + 1])
    found[turn + 1 :] = found[turn] * np.cumprod(ratios[turn + 1 : highest + 1])
    return found


def spherical_neumann(x: float, highest: int) -> Array:
    """Return the spherical Neumann functions y_L(x), L = 0..highest, of x > 0.

    They are nan above the degree at which they overflow.
    """
    found = np.full(highest + 1, np.nan)
    below, now = math.sin(x) / x, -math.cos(x) / x
    for L in range(highest + 1):
        if math.isinf(now):
            break
        found[L] = now
        below, now = now, (2 * L + 1) / x * now - below
    return found


@functools.lru_cache(maxsize=32)
def _turned_columns(degree: int, beta: float) -> Array:
    """Return d^n_{m'm}(beta), (m from -degree to degree, modes (n, m') with n <= degree)."""
    columns = np.zeros((2 * degree + 1, degree * (degree + 2)))
    for n in range(1, degree + 1):
        columns[degree - n : degree + n + 1, n * n - 1 : n * (n + 2)] = wigner_d(n, beta).T
    return columns


class Translation:
    """Matrix elements of exp(i k s.d), or those with h_L in place of j_L.

    Modes are (n, m), ordered by n from 1 and then by m from -n to n.
    """

    def __init__(self, vector: Array, wavenumber: float, *, outgoing: bool) -> None:
        x, y, z = (float(each) for each in vector)
        across = np.hypot(x, y)
        self._distance = float(wavenumber * np.hypot(across, z))
        self._outgoing = outgoing
        self._downward = z < 0
        self._alpha, self._beta = float(np.arctan2(y, x)), float(np.arctan2(across, z))
        self._degree = 0
        self._parts = (np.zeros((0, 0, 0), np.complex128),) * 2

    def _along(self, degree: int) -> tuple[Complex, Complex]:
        """Return A and B of a displacement along +z, (orders m >= 0, degrees n', degrees n)."""
        if degree > self._degree:
            self._degree = next((size for size in _DEGREES if size >= degree), degree)
            self._parts = self._made(self._degree)
        return self._parts

    def _made(self, degree: int) -> tuple[Complex, Complex]:
        every = np.arange(2 * degree + 1)
        radial = spherical_bessel(self._distance, 2 * degree).astype(np.complex128)
        if self._outgoing:
            radial.imag = spherical_neumann(self._distance, 2 * degree)
        radial *= 1j ** (every % 4)
        parts = np.zeros((2, degree + 1, degree, degree), np.complex128)
        for shorter, couplings in enumerate(_couplings(degree), start=1):
            above = np.arange(degree + 1 - shorter)[:, None]
            weights = radial[above + np.arange(2 * shorter + 1)]
            for parity in (0, 1):
                sums = np.einsum("mli,li->ml", couplings[..., parity::2], weights[:, parity::2])
                parts[parity, : shorter + 1, shorter - 1, shorter - 1 :] = sums
                parts[parity, : shorter + 1, shorter - 1 :, shorter - 1] = sums
        return parts[0], parts[1]

    def axial(self, n: int, highest: int) -> tuple[Complex, Complex]:
        """Return the rows n of A and B for d along the z axis, (orders 0 to n, degrees to highest).

        `highest` is the largest degree of the columns.
        """
        A, B = (part[: n + 1, n - 1, :highest] for part in self._along(max(n, highest)))
        if self._downward:
            sign = (-1.0) ** (n + np.arange(1, highest + 1))
            return sign * A, -sign * B
        return A, B

    def rows(self, n: int, highest: int) -> tuple[Complex, Complex]:
        """Return the rows of degree n of A and B, (orders -n to n, modes of degrees to highest)."""
        along = self._along(max(n, highest))
        columns = highest * (highest + 2)
        of_mode = np.repeat(np.arange(highest), 2 * np.arange(1, highest + 1) + 1)
        order = np.arange(columns) - of_mode * (of_mode + 2) - (of_mode + 1)
        m = np.arange(-n, n + 1)
        degree = self._degree
        turned = _turned_columns(degree, self._beta)[degree - n : degree + n + 1, :columns]
        left = wigner_d(n, self._beta) * np.exp(-1j * self._alpha * m)[:, None]
        right = np.exp(1j * self._alpha * order)
        A, B = (part[np.abs(m)[:, None], n - 1, of_mode] * turned for part in along)
        return left @ A * right, left @ (np.sign(m)[:, None] * B) * right
