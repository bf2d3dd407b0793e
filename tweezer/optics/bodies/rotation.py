"""Wigner functions, which rotate the amplitudes of vector spherical waves.

A field turned by R = Rz(alpha) Ry(beta) Rz(gamma) has the amplitudes D(R) p, with
D^n_{m'm} = exp(-i alpha m') d^n_{m'm}(beta) exp(-i gamma m), the same for both helicities. All d
follow from the constant Delta^n = d^n(pi/2):

    d^n_{m'm}(beta) = i^(m - m') sum over k of Delta_{m'k} exp(-i k beta) Delta_{mk}.
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import ArrayLike

from tweezer.values.arrays import Array, Complex


def _phased(vectors: Array, angle: float) -> Array:
    """Return d^n(angle) from the eigenvectors of J_x, (2n + 1, 2n + 1), orders k ascending."""
    n = len(vectors) // 2
    m = np.arange(-n, n + 1)
    quarter = 1j ** (m % 4)
    turned = (vectors * np.exp(-1j * angle * m)) @ vectors.T
    return np.ascontiguousarray((quarter.conj()[:, None] * turned * quarter).real)


@functools.lru_cache(maxsize=256)
def _delta(n: int) -> Array:
    """Return Delta^n, (2n + 1, 2n + 1), from the eigenvectors of J_x."""
    m = np.arange(-n, n)
    beside = np.sqrt((n - m) * (n + m + 1.0)) / 2
    _, vectors = np.linalg.eigh(np.diag(beside, 1) + np.diag(beside, -1))
    found = _phased(vectors, np.pi / 2)
    found.setflags(write=False)
    return found


def wigner_delta(degree: int) -> tuple[Array, ...]:
    """Return the Wigner functions Delta^n = d^n(pi/2) of degrees n = 0 to `degree`.

    Parameters
    ----------
    degree : int
        Largest degree.

    Returns
    -------
    tuple of ndarray
        Delta^n at index n, of shape (2n + 1, 2n + 1). Rows are the orders m' from -n to n, columns
        the orders m. The arrays are read-only.
    """
    return tuple(_delta(n) for n in range(degree + 1))


def wigner_d(n: int, beta: float) -> Array:
    """Return the Wigner functions d^n_{m'm}(beta) of one degree, (2n + 1, 2n + 1).

    Rows are the orders m' from -n to n, columns the orders m.
    """
    return _phased(_delta(n), beta)


def euler_angles(rotation: ArrayLike) -> tuple[float, float, float]:
    """Return the angles alpha, beta and gamma (rad) of R = Rz(alpha) Ry(beta) Rz(gamma).

    Rotations about z have beta = 0 and gamma = 0; beta = pi also has gamma = 0.
    """
    R = np.asarray(rotation, np.float64)
    sine = np.hypot(R[0, 2], R[1, 2])
    beta = float(np.arctan2(sine, R[2, 2]))
    if sine == 0:
        # Rz(alpha) Ry(beta) has the second column (-sin(alpha), cos(alpha), 0)
        return float(np.arctan2(-R[0, 1], R[1, 1])), beta, 0.0
    alpha = float(np.arctan2(R[1, 2], R[0, 2]))
    # gamma from the rotation that is left, which keeps its accuracy near beta = 0
    turned = np.cos(alpha) * R[1] - np.sin(alpha) * R[0]
    return alpha, beta, float(np.arctan2(turned[0], turned[1]))


def rotation_blocks(degree: int, rotation: ArrayLike) -> tuple[Complex, ...]:
    """Return D^n(R) of degrees n = 0 to `degree`.

    Parameters
    ----------
    degree : int
        Largest degree.
    rotation : array_like, shape (3, 3)
        Rotation matrix R.

    Returns
    -------
    tuple of ndarray
        D^n at index n, of shape (2n + 1, 2n + 1). Rows are the orders m' from -n to n, columns the
        orders m.
    """
    alpha, beta, gamma = euler_angles(rotation)
    blocks = []
    for n in range(degree + 1):
        m = np.arange(-n, n + 1)
        left, right = np.exp(-1j * alpha * m), np.exp(-1j * gamma * m)
        blocks.append(left[:, None] * wigner_d(n, beta) * right)
    return tuple(blocks)


def rotation_matrix(degree: int, rotation: ArrayLike) -> Complex:
    """Return D(R) between all modes of degrees 1 to `degree`.

    If R turns the body's frame into the laboratory frame, light of the amplitudes p in the
    laboratory has the amplitudes D(R)^+ p in the body's frame. A body turned by R about its origin
    has the scattering matrix D(R) S D(R)^+; T is transformed in the same way.

    Parameters
    ----------
    degree : int
        Largest degree.
    rotation : array_like, shape (3, 3)
        Rotation matrix R.

    Returns
    -------
    ndarray, shape (2 degree (degree + 2), 2 degree (degree + 2))
        D(R), with the modes in the order of `tweezer.optics.bodies.t_matrix.modes_up_to`.
    """
    count = degree * (degree + 2)
    single = np.zeros((count, count), np.complex128)
    for n, block in enumerate(rotation_blocks(degree, rotation)[1:], start=1):
        here = slice(n * n - 1, n * (n + 2))
        single[here, here] = block
    matrix = np.zeros((2 * count, 2 * count), np.complex128)
    matrix[::2, ::2] = matrix[1::2, 1::2] = single
    return matrix
