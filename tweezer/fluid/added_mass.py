"""Added mass of an ellipsoid: the inertia of the fluid that accelerates with it."""

from __future__ import annotations

import numpy as np
from scipy.special import elliprd

from tweezer.values.arrays import Array


def ellipsoid_added_mass(semi_axes: tuple[float, float, float], displaced_mass: float) -> Array:
    """Return the added inertia of an ellipsoid along and about its axes, in potential flow.

    With alpha_i = (2/3) a_1 a_2 a_3 R_Di, where R_Di is Carlson's R_D and the sum of alpha_i is 2,
    the added mass along axis i is m_f alpha_i/(2 - alpha_i). The added moment about axis 1 is

        m_f/5 (a_2^2 - a_3^2)^2 (alpha_3 - alpha_2)
        / (2 (a_2^2 - a_3^2) + (a_2^2 + a_3^2) (alpha_2 - alpha_3)).

    Parameters
    ----------
    semi_axes : tuple of float
        Semi-axes a_1, a_2 and a_3 along x, y and z of the body, m.
    displaced_mass : float
        Mass m_f of the displaced fluid, kg.

    Returns
    -------
    ndarray, shape (6,)
        Added masses, kg, and added moments of inertia, kg m^2.

    References
    ----------
    H. Lamb, Hydrodynamics (6th ed., 1932), sections 114 and 115.
    """
    size = max(semi_axes)
    a = np.array(semi_axes) / size
    squares = a**2
    alpha = np.array([
        2 / 3 * a.prod() * elliprd(squares[(i + 1) % 3], squares[(i + 2) % 3], squares[i])
        for i in range(3)
    ])  # fmt: skip
    moments = []
    for j, k in ((1, 2), (2, 0), (0, 1)):
        apart, change = squares[j] - squares[k], alpha[j] - alpha[k]
        below = 2 * apart + (squares[j] + squares[k]) * change
        # both vanish where the axes are equal, the numerator faster
        moments.append(0.0 if abs(apart) < 1e-6 else -(apart**2) * change / (5 * below))
    return displaced_mass * np.concatenate([alpha / (2 - alpha), np.array(moments) * size**2])
