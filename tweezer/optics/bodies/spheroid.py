"""The T-matrix of a homogeneous spheroid."""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from tweezer.optics.bodies.surface import radial_functions, spheroid_nodes, t_of_order
from tweezer.optics.bodies.t_matrix import TMatrix, modes_up_to

ComplexArray = NDArray[np.complex128]

#: Degrees of the truncated matrices above the degrees kept, tried in this order
_EXTRA = (2, 4, 8, 12, 18, 26, 36, 50)
#: Change of S - 1 from one truncation to the next that is small enough
_CONVERGED = 1e-11


def degree_for(size: float) -> int:
    """Return the degree beyond which S - 1 is below about 1e-11: x + 4 x^(1/3) + 9.

    `size` is x, the wavenumber times the radius of the enclosing sphere.
    """
    return math.ceil(size + 4 * size ** (1 / 3)) + 9


def spheroid_t_matrix(
    across: float,
    along: float,
    index: complex,
    wavenumber: float,
    refractive_index: float,
    degree: int | None = None,
) -> TMatrix:
    """Return the T-matrix of a spheroid whose axis is z.

    The matrices of the method are truncated above the degrees that are kept, further and further
    until S - 1 changes by less than 1e-11. The error is the last change plus the largest element of
    the highest degree, because further degrees have smaller elements.

    Parameters
    ----------
    across, along : float
        Semi-axes across and along the axis, m.
    index : complex
        Refractive index relative to the medium.
    wavenumber : float
        Wavenumber in the medium, 1/m.
    refractive_index : float
        Refractive index of the medium.
    degree : int, optional
        Highest degree. Default: by `degree_for`.
    """
    radius = max(across, along)
    if degree is None:
        degree = degree_for(wavenumber * radius)
    fine = _truncated(wavenumber * across, wavenumber * along, index, degree, degree + _EXTRA[0])
    for extra in _EXTRA[1:]:
        coarse, fine = (
            fine,
            _truncated(wavenumber * across, wavenumber * along, index, degree, degree + extra),
        )
        # each further truncation changes less than the one before
        error = 2 * float(np.abs(fine - coarse).max())
        if error < _CONVERGED:
            break
    left_out = 2 * float(np.abs(fine[:, :, degree]).max(initial=0.0))
    left_out = max(left_out, 2 * float(np.abs(fine[..., degree]).max(initial=0.0)))
    error += left_out
    matrix = _in_helicities(fine, degree)
    return TMatrix(matrix, wavenumber, refractive_index, radius, index.imag == 0, error)


def _truncated(across: float, along: float, index: complex, degree: int, most: int) -> ComplexArray:
    """Return T' up to `degree` from matrices up to the degree `most`, by order m >= 0.

    The shape is (orders, 2, degrees, 2, degrees); see `t_of_order`. across, along: k times the
    semi-axes.
    """
    aspect = max(across / along, along / across)
    count = most + 20 + math.ceil(14 * (aspect - 1))
    nodes = spheroid_nodes(leggauss(count)[0], across, along)
    index = complex(index)
    outside, inside = radial_functions(nodes, index.real, index.imag, most)
    kept = degree + 1
    return np.stack([
        t_of_order(nodes, outside, inside, index.real, index.imag, m)[:, :kept, :, :kept].view(
            np.complex128
        )[..., 0]
        for m in range(kept)
    ])  # fmt: skip


def _in_helicities(blocks: ComplexArray, degree: int) -> ComplexArray:
    """Return T over the modes of `TMatrix` from T' by order, type and degree; see `_truncated`."""
    modes = modes_up_to(degree)
    matrix = np.zeros((len(modes),) * 2, np.complex128)
    for m in range(-degree, degree + 1):
        electric, magnetic = 0, 1
        of_order = blocks[abs(m)]
        turned = 1j if m >= 0 else -1j
        ee, mm = of_order[electric, :, electric], of_order[magnetic, :, magnetic]
        em, me = -turned * of_order[electric, :, magnetic], turned * of_order[magnetic, :, electric]
        lowest = max(abs(m), 1)
        for row in (1, -1):
            for column in (1, -1):
                rows, columns = (
                    np.flatnonzero((modes[:, 1] == m) & (modes[:, 2] == each))
                    for each in (row, column)
                )
                block = (ee + column * em + row * me + row * column * mm) / 2
                matrix[np.ix_(rows, columns)] = block[lowest:, lowest:]
    return matrix
