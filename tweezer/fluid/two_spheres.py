"""Exact resistance of two spheres in Stokes flow, by bispherical harmonics.

The line of centres is z, from sphere 2 to sphere 1. The surfaces are xi = alpha and xi = -beta in
the coordinates z = sinh(xi)/(cosh(xi) - nu), rho = sin(eta)/(cosh(xi) - nu), nu = cos(eta), with
lengths in a scale c. The flow is u = x Q/2 + v with the pressure mu Q, where Q and v are sums of
the harmonics

    f_n = sqrt(cosh(xi) - nu) e^(s (n + 1/2) xi) P_n^m(nu),    s = +1 or -1,

singular in sphere 1 (s = +1) or in sphere 2. On each surface Q and v follow from the unknown W,
the harmonic of v_z. The continuity equation contains the degrees n - 1, n and n + 1
(`derivation.pair` proves both), which makes a block-tridiagonal system.

G. B. Jeffery and M. Stimson (1926) and A. D. Maude (1961) solved the motion along the line. A. J.
Goldman, R. G. Cox and H. Brenner (1966) and M. E. O'Neill and S. R. Majumdar (1970) solved the
motion across it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tweezer.values.arrays import Array

#: The series are summed until their terms have decreased by e^(-DECAY)
DECAY = 38.0
_ROOT = np.sqrt(2.0)


class Geometry(NamedTuple):
    """Bispherical coordinates of two spheres."""

    alpha: float
    """xi of the surface of sphere 1"""
    beta: float
    """-xi of the surface of sphere 2"""
    scale: float
    """c, the unit of length"""

    def terms(self, decay: float = DECAY) -> int:
        """Return the number of degrees after which terms have decreased by e^(-decay)."""
        return int(decay / min(self.alpha, self.beta)) + 12


class Resistances(NamedTuple):
    """Forces and torques on the fluid by moving spheres, over 6 pi mu and powers of length."""

    together: Array
    """forces on both by spheres that move together along the line, (2,): no digits cancel"""
    along: Array
    """forces on both by either of them that moves along the line, (2, 2)"""
    spin: Array
    """torques on both by either of them that turns about the line, (2, 2)"""
    across: Array
    """forces along x and torques about y on both, by translation along x and rotation about y,
    (4, 4)"""


def geometry(radius_1: float, radius_2: float, gap: float) -> Geometry:
    """Return the coordinates of spheres with a gap between their surfaces; no digits cancel."""
    distance = radius_1 + radius_2 + gap
    over = gap / (2 * distance) * np.array([gap + 2 * radius_2, gap + 2 * radius_1])
    over /= np.array([radius_1, radius_2])  # cosh - 1
    alpha, beta = np.log1p(over + np.sqrt(over * (2 + over)))
    product = gap * (gap + 2 * radius_1) * (gap + 2 * radius_2) * (distance + radius_1 + radius_2)
    return Geometry(float(alpha), float(beta), float(np.sqrt(product) / (2 * distance)))


def nearest(radius_1: float, radius_2: float, terms: int) -> float:
    """Return the smallest gap whose series needs no more than a number of degrees."""
    scale = max(radius_1, radius_2) * np.sinh(DECAY / terms)
    return float(sum(scale**2 / (np.hypot(scale, each) + each) for each in (radius_1, radius_2)))


def resistances(radius_1: float, radius_2: float, gap: float, decay: float = DECAY) -> Resistances:
    """Return the exact resistances of two spheres.

    Parameters
    ----------
    radius_1, radius_2 : float
        Radii, in any unit of length.
    gap : float
        Distance between the surfaces, in the same unit.
    decay : float, optional
        Exponent by which the terms of the series decrease before they are left out.
    """
    at = geometry(radius_1, radius_2, gap)
    unit = 6 * np.pi / at.scale
    together, along = _along(at, decay)
    sizes = np.array([1.0, 1.0, at.scale, at.scale])
    across = sizes[:, None] * sizes * _across(at, decay)
    spin = at.scale**2 * _spin(at, decay)
    return Resistances(together / unit, along / unit, spin / unit, across / unit)


# --- operators over the degree -------------------------------------------------------------------
# A tridiagonal matrix is an array (3, degrees): row n contains the elements of n - 1, n and n + 1.


def _product(a: Array, b: Array) -> Array:
    """Return the product of two tridiagonal matrices, without the elements of n - 2 and n + 2.

    They cancel in the continuity equation.
    """
    before, own, after = np.zeros_like(a)
    before[1:] = a[0, 1:] * b[1, :-1]
    before += a[1] * b[0]
    own[1:] = a[0, 1:] * b[2, :-1]
    own += a[1] * b[1]
    own[:-1] += a[2, :-1] * b[0, 1:]
    after[:-1] = a[2, :-1] * b[1, 1:]
    after += a[1] * b[2]
    return np.array([before, own, after])


def _times(a: Array, x: Array) -> Array:
    """Return the product of a tridiagonal matrix with columns x (degrees, columns)."""
    found = a[1, :, None] * x
    found[1:] += a[0, 1:, None] * x[:-1]
    found[:-1] += a[2, :-1, None] * x[1:]
    return found


def _rows(before: Array, own: Array | float, after: Array) -> Array:
    return np.array([before, own + 0 * before, after])


class _Harmonics:
    """Operators on the harmonics of an order m, for degrees from 0."""

    def __init__(self, at: Geometry, order: int, terms: int) -> None:
        self.at, self.order = at, order
        self.n = n = np.arange(terms + 1.0)
        self.k = n + 0.5
        self.signed = (at.alpha, -at.beta)
        #: e^(-(n+1/2) |xi|) on both surfaces
        self.decay = [np.exp(-self.k * xi) for xi in (at.alpha, at.beta)]
        self._over = self.decay[0] * self.decay[1]
        self._rest = -np.expm1(-2 * self.k * (at.alpha + at.beta))
        m = order
        #: multiplication by nu
        self.cosine = _rows((n - m) / np.abs(2 * n - 1), 0.0, (n + m + 1) / (2 * n + 3))
        #: multiplication by sin(eta), which changes the order by 1
        self.raised = _rows(1 / np.abs(2 * n - 1), 0.0, -1 / (2 * n + 3))
        self.raised[0, 0] = 0
        self.lowered = _rows(-n * (n - 1) / np.abs(2 * n - 1), 0.0, (n + 1) * (n + 2) / (2 * n + 3))

    def outgoing(self, boundary: tuple[Array, Array], sphere: int) -> Array:
        """Return the coefficients singular in a sphere, by values on both surfaces.

        They are multiplied by e^((n+1/2) |xi|) of that sphere, so that none of them overflows.
        """
        own, other = boundary[sphere], boundary[1 - sphere]
        return (own - self._over[:, None] * other) / self._rest[:, None]

    def pressure(self, surface: int) -> Array:
        """Return the operator that gives Q on a surface from V_z - W."""
        xi = self.signed[surface]
        return 2 / np.sinh(xi) * (_rows(0 * self.n, np.cosh(xi), 0 * self.n) - self.cosine)

    def lateral(self, surface: int) -> list[Array]:
        """Return the operators that give U_1, or U_0 and U_2, on a surface from V_z - W."""
        over = -1 / np.sinh(self.signed[surface])
        if self.order == 0:
            return [2 * over * self.raised]
        return [over * self.lowered, over * self.raised]

    def divergences(self) -> list[Array]:
        """Return the operators of U_1, or of U_0 and U_2, in the continuity equation."""
        n = self.n
        if self.order == 0:
            return [_rows(n * (n - 1) / 2, -n * (n + 1), (n + 1) * (n + 2) / 2)]
        one = np.ones_like(n)
        return [
            _rows(-one / 2, one, -one / 2),
            _rows((n - 1) * (n - 2) / 2, -(n - 1) * (n + 2), (n + 2) * (n + 3) / 2),
        ]

    def spread(self) -> Array:
        """Return the operator 3 + x.grad of Q in the continuity equation."""
        n, m = self.n, self.order
        return _rows(-(n - m) / 2, 2.5, (n + m + 1) / 2)

    def slope(self, sphere: int) -> Array:
        """Return the operator d/dz of harmonics that are singular in a sphere."""
        n, m = self.n, self.order
        return (1 - 2 * sphere) * _rows(-(n - m) / 2, self.k, -(n + m + 1) / 2)

    def scaled(self, operator: Array, sphere: int) -> Array:
        """Return an operator on coefficients that are multiplied as those of `outgoing`."""
        ratio = np.exp((self.at.alpha, self.at.beta)[sphere])
        return operator * np.array([ratio, 1.0, 1 / ratio])[:, None]

    def columns(self, sphere: int, surface: int) -> Array:
        """Return the factors of `outgoing` of a sphere on the values of a surface."""
        return (1.0 if sphere == surface else -self._over) / self._rest


class _Flow(NamedTuple):
    """Harmonics of a flow, by their values on both surfaces, (degrees, motions) each."""

    pressure: tuple[Array, Array]
    lateral: tuple[Array, Array]
    axial: tuple[Array, Array]


def _flow(h: _Harmonics, axial: Array, lateral: Array) -> _Flow:
    """Solve the continuity equation for W on both surfaces.

    Parameters
    ----------
    h : _Harmonics
        Harmonics of the order of the motion.
    axial : ndarray, shape (2, degrees, motions)
        V_z on both surfaces.
    lateral : ndarray, shape (2, degrees, motions)
        V_rho - V_phi on both surfaces, which U_0 contains. V_rho + V_phi is zero.
    """
    matrix, given = [], []
    for sphere in (0, 1):
        spread = h.scaled(h.spread(), sphere)
        slope = h.scaled(h.slope(sphere), sphere)
        divergences = [h.scaled(each, sphere) for each in h.divergences()]
        known = np.zeros_like(axial[0])
        row = []
        for surface in (0, 1):
            factors = h.columns(sphere, surface)
            block = _product(spread, factors * h.pressure(surface))
            for divergence, boundary in zip(divergences, h.lateral(surface), strict=True):
                block += _product(divergence, factors * boundary)
            identity = _rows(0 * h.n, factors, 0 * h.n)
            # of V_z - W
            row.append(block - 2 * _product(slope, identity))
            known -= 2 * _times(slope, factors[:, None] * axial[surface])
            if h.order == 1:
                known -= _times(divergences[0], factors[:, None] * lateral[surface])
        matrix.append(row)
        given.append(known)
    slip = _solved(matrix, given, h.order)
    first = [h.lateral(surface)[0] for surface in (0, 1)]
    return _Flow(
        (_times(h.pressure(0), slip[0]), _times(h.pressure(1), slip[1])),
        (lateral[0] + _times(first[0], slip[0]), lateral[1] + _times(first[1], slip[1])),
        (axial[0] - slip[0], axial[1] - slip[1]),
    )


def _solved(matrix: list[list[Array]], given: list[Array], first: int) -> Array:
    """Solve a block-tridiagonal system for degrees from `first`, (2, degrees, motions)."""
    from scipy.linalg import solve_banded

    count = len(given[0]) - first
    banded = np.zeros((7, 2 * count))
    for row in (0, 1):
        for column in (0, 1):
            for at, elements in enumerate(matrix[row][column]):
                shift = at - 1
                of = np.arange(max(0, -shift), count - max(0, shift))
                # diagonal of the banded form, whose unknowns alternate between the surfaces
                banded[3 + row - column - 2 * shift, 2 * (of + shift) + column] = elements[
                    of + first
                ]
    sides = np.empty((2 * count, given[0].shape[1]))
    sides[0::2], sides[1::2] = given[0][first:], given[1][first:]
    found = solve_banded((3, 3), banded, sides, overwrite_ab=True, overwrite_b=True)
    slip = np.zeros((2, *given[0].shape))
    slip[0, first:], slip[1, first:] = found[0::2], found[1::2]
    return slip


# --- motions -------------------------------------------------------------------------------------
def _along(at: Geometry, decay: float) -> tuple[Array, Array]:
    """Return forces of spheres that move together, and of either of them, along the line."""
    h = _Harmonics(at, 0, at.terms(decay))
    axial = np.zeros((2, len(h.n), 3))
    for sphere in (0, 1):
        axial[sphere][:, [0, 1 + sphere]] = _ROOT * h.decay[sphere][:, None]
    flow = _flow(h, axial, np.zeros_like(axial))
    weights = 4 * _ROOT * np.pi * (2 * h.n + 1)
    first, second = (
        (weights * h.decay[sphere]) @ h.outgoing(flow.pressure, sphere) for sphere in (0, 1)
    )
    forces = np.array([first, -second])
    return forces[:, 0], forces[:, 1:]


def _spin(at: Geometry, decay: float) -> Array:
    """Return the torques of spheres that turn about the line, which need no equations."""
    h = _Harmonics(at, 1, at.terms(decay))
    turning = np.zeros((2, len(h.n), 2))
    for sphere in (0, 1):
        turning[sphere][:, sphere] = 2 * _ROOT * h.decay[sphere]
    boundary = turning[0], turning[1]
    weights = 8 * _ROOT * np.pi * h.n * (h.n + 1)
    return np.array(
        [(weights * h.decay[sphere]) @ h.outgoing(boundary, sphere) for sphere in (0, 1)]
    )


def _across(at: Geometry, decay: float) -> Array:
    """Return forces and torques by translation along x, and by rotation about y, of either."""
    h = _Harmonics(at, 1, at.terms(decay))
    centres = 1 / np.tanh(at.alpha), -1 / np.tanh(at.beta)
    axial, lateral = np.zeros((2, len(h.n), 4)), np.zeros((2, len(h.n), 4))
    for sphere, (centre, sign) in enumerate(zip(centres, (1, -1), strict=True)):
        unit = 2 * _ROOT * h.decay[sphere]
        lateral[sphere][:, sphere] = unit
        # V = (z - z_c, 0, -x)
        lateral[sphere][:, 2 + sphere] = unit * (sign * 2 * h.k - centre)
        axial[sphere][:, 2 + sphere] = -unit
    flow = _flow(h, axial, lateral)
    squares = h.n * (h.n + 1)
    forces, torques = [], []
    for sphere, (centre, sign) in enumerate(zip(centres, (1, -1), strict=True)):
        pressure, first, along = (h.outgoing(each, sphere) for each in flow)
        unit = 4 * _ROOT * np.pi * h.decay[sphere]
        forces.append((unit * squares) @ pressure)
        turned = sign * h.k[:, None] * first - squares[:, None] * along
        torques.append(unit @ turned - centre * forces[-1])
    return np.array([*forces, *torques])
