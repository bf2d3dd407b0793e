r"""The force on spheres by the light that they scatter onto each other.

The light has the amplitudes p_j of partial waves about the sphere j. The waves that leave its
neighbours reach it too, so that it scatters

    t_j = T_j (p_j + g_j),   g_j = (1/2) sum over i of H(r_j - r_i) t_i,

with T_j = -2 a_n for electric and -2 b_n for magnetic waves, and the translation H of outgoing
waves (`tweezer.optics.bodies.translation`). With the direction s of light, a sphere that turns p
into q = p + t receives the momentum <p|s|p> - <q|s|q> = -2 Re <p|s|t> - <t|s|t>. With the waves of
the neighbours p is p_j + g_j, without them it is p_j.

With amplitudes scaled by the root of T no number is large. The equations are then close to
identities, and their solution takes a few iterations.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from tweezer.optics.bodies.t_matrix import Integers
from tweezer.optics.bodies.translation import Translation
from tweezer.optics.waves.amplitudes import Path
from tweezer.optics.waves.binding import highest_degree
from tweezer.optics.waves.incident import Incident
from tweezer.optics.waves.scattered import directed
from tweezer.optics.waves.sphere import mie_coefficients
from tweezer.values.arrays import Array, Complex

#: Error of the force by the light's amplitudes, as a part of n_m P/c
FLOOR = 2e-10
#: Part of the scattered light beyond the first degree
_SMALL = 1e-6
#: Number of degrees by which the series is extended: at least, and as a part of the degree
_MORE, _PART = 4, 4
#: Relative error of the solution of the equations, and the largest number of iterations
_SOLVED, _ITERATIONS = 1e-12, 300
#: Error at which the series ends by default, over the largest scattered force
_WANTED = 1e-5
#: Largest memory for the translations between the spheres, in bytes
_MEMORY = 3e8

Shells = tuple[tuple[float, complex], ...]


@dataclass(frozen=True, eq=False)
class Spheres:
    """Spheres in light of one wavelength."""

    lights: tuple[tuple[Path, ...], ...]
    """paths of each light; those of one light interfere"""
    shells: tuple[Shells, ...]
    """outer radii, m, and relative indices of the layers of each sphere, see `Waves.shells`"""
    places: Array
    """(spheres, 3) positions, m"""

    @property
    def wavenumber(self) -> float:
        """Wavenumber k in the medium, 1/m."""
        return self.lights[0][0].light.wavenumber

    @property
    def strength(self) -> float:
        """Momentum per time of the light, n_m P/c, N."""
        paths = (path for light in self.lights for path in light if path.mirror is None)
        return sum(path.light.strength for path in paths)

    @property
    def least(self) -> int:
        """Degree that suffices for each sphere alone."""
        x = self.wavenumber * max(shells[-1][0] for shells in self.shells)
        enough = int(x + 6 * x ** (1 / 3)) + 12
        degrees = (
            highest_degree(*mie_coefficients(shells, self.wavenumber, enough), _SMALL)
            for shells in self.shells
        )
        return max(1, *degrees)

    def scattered(self, degree: int) -> Array:
        """Return the additional force by mutual scattering with waves up to a degree.

        It is (spheres, 3) N, and NaN where the waves overflow or the equations are not solved.
        """
        n, _ = _modes(degree)
        roots = np.array([
            np.sqrt(-2 * np.array(mie_coefficients(shells, self.wavenumber, degree), np.complex128))
            for shells in self.shells
        ])[:, :, n - 1]  # fmt: skip
        between = _Between(self.places, self.wavenumber, degree)
        force = np.zeros_like(self.places)
        for paths in self.lights:
            # the amplitudes of degree n are integrals that a bead of the radius n/k resolves
            radius = (degree + 1) / self.wavenumber
            wide = tuple(
                dataclasses.replace(path, light=path.light.of_radius(radius)) for path in paths
            )
            light = Incident(wide, self.places, degree + 1, 0.0)
            strength = wide[0].light.momentum_per_energy * light.power
            for p in np.moveaxis(light.about(self.places), 1, 0):
                force += strength * _additional(p, roots, between)
        return force


def _modes(degree: int) -> tuple[Integers, Integers]:
    """Return the degrees n and the orders m of the modes up to a degree, (modes,)."""
    every = np.arange(1, degree + 1, dtype=np.int64)
    n = np.repeat(every, 2 * every + 1)
    return n, np.arange(len(n)) - n * n + 1 - n


class _Between:
    """The waves that spheres send to each other."""

    def __init__(self, places: Array, wavenumber: float, degree: int) -> None:
        self._translations = {}
        for j in range(len(places)):
            for i in range(j):
                of = Translation(places[j] - places[i], wavenumber, outgoing=True)
                rows = [of.rows(n, degree) for n in range(1, degree + 1)]
                A, B = (np.concatenate(each) / 2 for each in zip(*rows, strict=True))
                self._translations[j, i] = A, B
        #: of a translation along -d instead of d
        self._sign = (-1.0) ** _modes(degree)[0][:, None]

    def received(self, t: Complex) -> Complex:
        """Return the waves g about each sphere that leave the others as t.

        Both are (spheres, 2, modes), electric before magnetic waves.
        """
        g = np.zeros(t.shape, np.complex128)
        sign = self._sign
        for (j, i), (A, B) in self._translations.items():
            sent, back = t[i].T, sign * t[j].T
            g[j] += (A @ sent + B @ sent[:, ::-1]).T
            g[i] += (sign * (A @ back - B @ back[:, ::-1])).T
        return g


def _solved(roots: Complex, between: _Between, light: Complex) -> Complex:
    """Return the scaled amplitudes u = t/root of T from the scaled light; NaN if not solved."""
    shape = light.shape

    def apply(u: Complex) -> Complex:
        of = u.reshape(shape)
        return np.asarray(of - roots * between.received(roots * of)).ravel()

    operator = LinearOperator((light.size, light.size), apply, dtype=np.complex128)
    found, missed = gmres(operator, light.ravel(), rtol=_SOLVED, restart=_ITERATIONS, maxiter=1)
    return np.full(shape, np.nan) if missed else found.reshape(shape)


def _additional(p: Complex, roots: Complex, between: _Between) -> Array:
    """Return the additional force in light of one state, as a part of n_m P/c, (spheres, 3)."""
    highest = p.shape[-1] - 1
    n, order = _modes(highest - 1)
    own = roots * _electric_and_magnetic(p)[..., highest + order, n]
    t = roots * _solved(roots, between, own)
    received = _by_helicity(between.received(t), highest)
    return _force(p + received, _by_helicity(t, highest)) - _force(
        p, _by_helicity(roots * own, highest)
    )


def _electric_and_magnetic(p: Complex) -> Complex:
    """Return electric and magnetic waves from those of helicity, (..., 2, orders, degrees)."""
    plus, minus = p[..., 0, :, :], p[..., 1, :, :]
    return np.stack([plus + minus, plus - minus], axis=-3) / np.sqrt(2)


def _by_helicity(t: Complex, highest: int) -> Complex:
    """Return amplitudes by helicity, order and degree up to a higher one from those of modes.

    t: (spheres, 2, modes), electric before magnetic waves.
    """
    degree = round((1 + t.shape[-1]) ** 0.5) - 1
    n, order = _modes(degree)
    found = np.zeros((*t.shape[:-1], 2 * highest + 1, highest + 1), np.complex128)
    found[..., highest + order, n] = t
    return _electric_and_magnetic(found)


def _force(p: Complex, t: Complex) -> Array:
    """Return -2 Re <p|s|t> - <t|s|t> of each sphere, (spheres, 3)."""
    return -np.einsum("jkmn,ijkmn->ji", (2 * p + t).conj(), directed(t)).real


def scattered_force(
    lights: Sequence[Spheres], *, wanted: float = _WANTED, most: float = math.inf
) -> tuple[Array, Array, int]:
    """Return the additional force on spheres by mutual scattering, its error and the degree.

    The degree is raised until the force converges. The error is twice the geometric series of its
    last two changes, or at least the last change.

    Parameters
    ----------
    lights : sequence of Spheres
        The spheres in each light; the lights do not interfere.
    wanted : float, optional
        Error at which the series ends, over the largest scattered force.
    most : float, optional
        Largest degree of partial waves. Default: limited by the memory alone.

    Returns
    -------
    force : ndarray, shape (spheres, 3)
        Force, N.
    error : ndarray, shape (spheres,)
        Estimated error, N. It is infinite if the force does not converge.
    degree : int
        Highest degree of partial waves.
    """
    count = len(lights[0].places)
    floor = FLOOR * sum(each.strength for each in lights)
    force, degree = np.zeros((count, 3)), 0
    error = before = change = np.full(count, np.inf)
    for more in _degrees(max(each.least for each in lights), count, most):
        found = np.sum([each.scattered(more) for each in lights], axis=0)
        if not np.isfinite(found).all():
            break
        if degree > 0:
            change = np.linalg.norm(found - force, axis=1)
        force, degree = found, more
        if np.isfinite(before).all():
            error = floor + _remainder(before, change)
            if error.max() <= max(wanted * np.linalg.norm(force, axis=1).max(), 2 * floor):
                break
        before = change
    return force, error, degree


def _degrees(least: int, count: int, most: float) -> Iterator[int]:
    """Yield degrees up to `most`, whose translations between `count` spheres fit into memory."""
    degree = least
    while degree <= most and 16 * count * (count - 1) * (degree + 1) ** 4 < _MEMORY:
        yield degree
        degree += max(_MORE, degree // _PART)


def _remainder(before: Array, change: Array) -> Array:
    """Return the estimated sum of all further changes; infinite if they do not decrease."""
    falling = np.maximum(before - change, 0.0)
    series = np.divide(2 * change**2, falling, out=np.full_like(change, np.inf), where=falling > 0)
    return np.where(change > 0, np.maximum(change, series), 0.0)
