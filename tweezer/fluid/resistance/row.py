"""Resistance of rigid spheres in a row, by Lamb's solution about each centre.

Outside the spheres the flow is a sum over spheres and degrees n of Lamb's three families (Happel
and Brenner, Low Reynolds Number Hydrodynamics, 3-2),

    u = rot(r chi) + grad Phi - (n-2)/(2n(2n-1) mu) r^2 grad p + (n+1)/(n(2n-1) mu) r p,

with p, Phi and chi solid harmonics of degree -(n+1) about a centre. Motions along and about the row
have the azimuthal order 0, motions across it the order 1. The coefficients follow from the velocity
on all spheres by least squares. Force and torque on a sphere are those of its terms n = 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from tweezer.values.arrays import Array

#: Numbers of degrees whose results are compared, and boundary points for each degree
_DEGREES, _POINTS = (40, 56), 2


class _Flow(NamedTuple):
    """Velocity components of the flow families at boundary points, (points, terms) each."""

    radial: Array
    """component away from the row, with cos(m phi)"""
    along: Array
    """component along the row, with cos(m phi)"""
    around: Array
    """component around the row, with sin(m phi), or 1 for m = 0"""


def row_resistance(places: Array, radii: Array, viscosity: float) -> tuple[Array, float]:
    """Return the resistance of rigid spheres in a row about the origin, and its relative error.

    Parameters
    ----------
    places : ndarray, shape (spheres,)
        Centres along z, m.
    radii : ndarray, shape (spheres,)
        Radii, m. Spheres may touch.
    viscosity : float
        Viscosity, Pa s.

    Returns
    -------
    matrix : ndarray, shape (6, 6)
        Resistance matrix.
    error : float
        Largest relative change of an element of the diagonal from fewer degrees.
    """
    unit = float(np.max(radii))
    coarse, fine = (_matrix(places / unit, radii / unit, degree) for degree in _DEGREES)
    change = np.abs(np.diag(coarse) / np.diag(fine) - 1).max()
    scale = np.array([1.0, 1.0, 1.0, unit, unit, unit])
    return viscosity * unit * scale[:, None] * scale * fine, float(change) + 1e-13


def _matrix(places: Array, radii: Array, degree: int) -> Array:
    """Return the resistance matrix for the viscosity 1 with `degree` terms a sphere."""
    theta = np.arccos(leggauss(_POINTS * degree)[0])
    z = np.concatenate([at + r * np.cos(theta) for at, r in zip(places, radii, strict=True)])
    rho = np.concatenate([r * np.sin(theta) for r in radii])
    matrix = np.zeros((6, 6))
    one, none = np.ones_like(z), np.zeros_like(z)
    # along and about the row
    pushed, turned = (_flow(places, radii, degree, 0, rho, z, families) for families in ("pf", "c"))
    force, _ = _answers(pushed, (none, one, none), radii, degree, 2)
    matrix[2, 2] = force.sum()
    _, torque = _answers(turned, (none, none, rho), radii, degree, 1)
    matrix[5, 5] = torque.sum()
    # across the row along x, and about y
    flow = _flow(places, radii, degree, 1, rho, z, "pfc")
    for column, motion in ((0, (one, none, -one)), (4, (z, -rho, -z))):
        force, torque = _answers(flow, motion, radii, degree, 3)
        matrix[0, column] = force.sum()
        matrix[4, column] = (torque + places * force).sum()
    coupled = (matrix[0, 4] + matrix[4, 0]) / 2
    matrix[0, 4] = matrix[4, 0] = coupled
    matrix[1, 1], matrix[3, 3] = matrix[0, 0], matrix[4, 4]
    matrix[1, 3] = matrix[3, 1] = -coupled
    return matrix


def _flow(
    places: Array, radii: Array, degree: int, m: int, rho: Array, z: Array, families: str
) -> _Flow:
    """Return the flows of the families p, Phi ("f") and chi ("c") about each sphere at points."""
    found: list[tuple[Array, Array, Array]] = []
    for place, radius in zip(places, radii, strict=True):
        r = np.hypot(rho, z - place)
        cosine, sine = (z - place) / r, rho / r
        harmonics, slopes = _legendre(degree, m, cosine, sine)
        for family in families:
            for n in range(1, degree + 1):
                P, slope = harmonics[n], slopes[n]
                power = (radius / r) ** (n + 1)
                around = m * P / sine
                if family == "c":
                    # rot(r chi), chi with sin(m phi): d/dphi gives cos, and so along theta
                    u_r, u_theta, u_phi = 0 * r, power * (around if m else 0 * r), -power * slope
                else:
                    gradient = power * np.stack([-(n + 1) * P, slope, -around]) / r
                    u_r, u_theta, u_phi = gradient
                    if family == "p":
                        one = -(n - 2) / (2 * n * (2 * n - 1))
                        u_r, u_theta, u_phi = one * r**2 * gradient
                        u_r = u_r + (n + 1) / (n * (2 * n - 1)) * r * power * P
                found.append((
                    u_r * sine + u_theta * cosine, u_r * cosine - u_theta * sine, u_phi
                ))  # fmt: skip
    radial, along, around = (np.stack(each, axis=1) for each in zip(*found, strict=True))
    return _Flow(radial, along, around)


def _legendre(degree: int, m: int, cosine: Array, sine: Array) -> tuple[list[Array], list[Array]]:
    """Return P_n^m and dP_n^m/dtheta for n = 0..degree and m = 0 or 1.

    They lack the Condon-Shortley sign and are divided by n^m, to be of order 1.
    """
    values = [sine**0 if m == 0 else 0 * sine, cosine if m == 0 else sine]
    for n in range(2, degree + 1):
        above = (2 * n - 1) * cosine * values[-1] - (n - 1 + m) * values[-2]
        values.append(above / (n - m))
    slopes = [0 * sine]
    slopes += [
        (n * cosine * values[n] - (n + m) * values[n - 1]) / sine for n in range(1, degree + 1)
    ]
    scale = [1.0, *(float(n**m) for n in range(1, degree + 1))]
    return (
        [value / by for value, by in zip(values, scale, strict=True)],
        [slope / by for slope, by in zip(slopes, scale, strict=True)],
    )


def _answers(
    flow: _Flow, motion: tuple[Array, Array, Array], radii: Array, degree: int, families: int
) -> tuple[Array, Array]:
    """Return the drag on each sphere and its torque about the sphere's centre, for a motion.

    `motion` is the velocity at the boundary points, in the components of `_Flow`. The sign is the
    one of the resistance: positive against the motion.
    """
    system = np.concatenate(flow)
    used = np.abs(system).max(axis=1) > 0
    columns = np.linalg.norm(system, axis=0)
    wanted = np.concatenate(motion)
    found = np.linalg.lstsq(system[used] / columns, wanted[used], rcond=None)[0] / columns
    terms = found.reshape(len(radii), families, degree)[:, :, 0]
    none = np.zeros(len(radii))
    # p = a (radius/r)^2 P_1 gives r^3 p = a radius^2 z, and so on
    force = 4 * math.pi * radii**2 * terms[:, 0] if families > 1 else none
    torque = 8 * math.pi * radii**2 * terms[:, -1] if families != 2 else none
    return force, torque
