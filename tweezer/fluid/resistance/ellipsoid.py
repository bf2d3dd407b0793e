"""Resistance of an ellipsoid, by Carlson's elliptic integrals."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import elliprd, elliprf

from tweezer.values.arrays import Array


def ellipsoid_resistance(semi_axes: tuple[float, float, float], viscosity: float) -> Array:
    """Return the resistance matrix of an ellipsoid about its centre, (6, 6).

    With R_F and R_D of the squared semi-axes a_i^2 (Carlson), the drag along axis i is
    8 pi mu/(R_F + a_i^2 R_Di/3), and about axis 1 it is
    8 pi mu (a_2^2 + a_3^2)/(a_2^2 R_D2 + a_3^2 R_D3). All terms are positive, so that no digits are
    lost for a sphere, a disc or a needle.

    Parameters
    ----------
    semi_axes : tuple of float
        Semi-axes a_1, a_2 and a_3 along x, y and z of the body, m.
    viscosity : float
        Viscosity mu, Pa s.

    References
    ----------
    F. Perrin, J. Phys. Radium 5, 497 (1934). S. Kim and S. J. Karrila, Microhydrodynamics (1991),
    chapter 3.
    """
    size = max(semi_axes)
    squares = np.array(semi_axes) ** 2 / size**2
    whole = elliprf(*squares)
    each = np.array([
        elliprd(squares[(i + 1) % 3], squares[(i + 2) % 3], squares[i]) for i in range(3)
    ])  # fmt: skip
    parts = squares * each
    along = 8 * math.pi * viscosity * size / (whole + parts / 3)
    about = [
        8 * math.pi * viscosity * size**3 * (squares[j] + squares[k]) / (parts[j] + parts[k])
        for j, k in ((1, 2), (2, 0), (0, 1))
    ]
    return np.diag([*along, *about])
