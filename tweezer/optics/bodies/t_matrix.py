"""The T-matrix of a body: how it scatters each vector spherical wave, and how exact that is.

The modes are outgoing and regular vector spherical waves of degree l, order m and helicity +1 or
-1, as in the standard file format (T-matrix data format, storage version 1). Fields vary as
exp(-i omega t). The amplitudes p_nm of plane waves give the modes the amplitudes a = -4 pi i^n p.
In terms of p the scattering matrix is S = 1 + 2T, with

    (S - 1)_{n'm',nm} = 2 i^(n-n') T_{n'm',nm}.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from tweezer.values.arrays import Array
from tweezer.values.printed import printed
from tweezer.values.shown import Card, Row, Shown

ComplexArray = NDArray[np.complex128]
Integers = NDArray[np.int64]

#: Degree up to which a T-matrix is compared with a rotated one, and the change that counts as none,
#: as a part of the matrix
_COMPARED, _UNCHANGED = 20, 1e-5


def modes_up_to(degree: int) -> Integers:
    """Return the modes of degrees 1 to `degree` in the standard order, (2 degree (degree + 2), 3).

    The columns are l, m and the helicity. The helicity varies fastest, +1 first, then m from -l to
    l, then l.
    """
    rows = [
        (l, m, helicity)
        for l in range(1, degree + 1)
        for m in range(-l, l + 1)
        for helicity in (1, -1)
    ]
    return np.array(rows, np.int64)


@dataclass(frozen=True, eq=False, repr=False)
class TMatrix(Shown):
    """T-matrix of a body about its origin, in the body's frame. `tweezer.t_matrix` returns one."""

    matrix: ComplexArray
    """(modes, modes) T; rows are scattered modes, columns incident modes"""
    wavenumber: float
    """wavenumber k in the medium, 1/m"""
    refractive_index: float
    """refractive index of the medium"""
    radius: float
    """radius of the sphere about the origin that encloses the body, m"""
    lossless: bool
    """whether the body absorbs nothing"""
    error: float
    """largest error of an element of S - 1 = 2T, estimated from two truncations"""

    @property
    def degree(self) -> int:
        """Largest degree l of the modes."""
        return round((1 + len(self.matrix) / 2) ** 0.5) - 1

    @functools.cached_property
    def modes(self) -> Integers:
        """Degree l, order m and helicity (+1 or -1) of each mode, (modes, 3).

        The helicity varies fastest, +1 first, then m from -l to l, then l.
        """
        return modes_up_to(self.degree)

    @functools.cached_property
    def change(self) -> ComplexArray:
        """S - 1, the change of the amplitudes p of the light by the body, (modes, modes)."""
        phase = 1j ** (self.modes[:, 0] % 4)
        return 2 * phase.conj()[:, None] * self.matrix * phase[None, :]

    @functools.cached_property
    def unitarity(self) -> float:
        """Largest violation of energy conservation.

        For a body that absorbs nothing it is the largest element of S^+ S - 1. For an absorbing
        body it is the largest eigenvalue of S^+ S - 1, or 0 if none is positive.
        """
        change = self.change
        gain = change + change.conj().T + change.conj().T @ change
        if self.lossless:
            return float(np.abs(gain).max())
        return max(0.0, float(np.linalg.eigvalsh(gain)[-1]))

    @functools.cached_property
    def reciprocity(self) -> float:
        """Largest violation of reciprocity.

        Reciprocity equates the element of 2T from mode (l', m') to (l, m) with the one from
        (l, -m) to (l', -m'), except for the sign (-1)^(m + m').
        """
        l, m, helicity = self.modes.T
        # the mode (l, -m) of the same helicity
        mirrored = 2 * (l * l - 1 + l - m) + (helicity < 0)
        sign = (-1.0) ** m
        swapped = sign[:, None] * sign[None, :] * self.matrix[np.ix_(mirrored, mirrored)].T
        return 2 * float(np.abs(self.matrix - swapped).max())

    @functools.cached_property
    def axial(self) -> bool:
        """Whether the body is one of revolution about z: T couples modes of equal m alone."""
        m = self.modes[:, 1]
        return not self.matrix[m[:, None] != m[None, :]].any()

    @functools.cached_property
    def axes_of_revolution(self) -> Array:
        """Axes about which a rotation of the body does not change T, in the body's frame.

        The shape is (0, 3) without an axis, (1, 3) with one, and (3, 3) for a sphere.
        """
        low = self.cut(_COMPARED)
        l, m, _ = low.modes.T
        raised = scipy.sparse.diags_array(np.sqrt(l * (l + 1.0) - m * (m + 1.0))[:-2], offsets=-2)
        components = (
            (raised + raised.T) / 2, (raised - raised.T) / 2j, scipy.sparse.diags_array(m + 0.0),
        )  # fmt: skip
        # J T - T J is the change of T with the angle of a rotation
        changes = [each @ low.matrix - low.matrix @ each for each in components]
        products = np.array([[np.vdot(a, b).real for a in changes] for b in changes])
        squares, axes = np.linalg.eigh(products)
        return axes.T[squares <= _UNCHANGED**2 * np.vdot(low.matrix, low.matrix).real]

    def save(
        self,
        path: str | Path,
        *,
        polarisation: Literal["helicity", "electric/magnetic"] = "helicity",
        **about: Any,
    ) -> Path:
        """Save this T-matrix to a file of the T-matrix data format.

        Parameters
        ----------
        path : str or Path
            Name of the file, ending in .tmat.h5.
        polarisation : {"helicity", "electric/magnetic"}, optional
            Modes of the file.
        **about
            `name` and `description` of the body, and the relative `permittivity` of a homogeneous
            body.

        Returns
        -------
        Path
            The file.
        """
        from tweezer.optics.bodies.saved import save_t_matrix

        return save_t_matrix(self, path, polarisation=polarisation, **about)

    def card(self) -> Card:
        """Return the card with size, degree and certificates."""
        shape = "body of revolution" if len(self.axes_of_revolution) else "without an axis"
        rows = (
            Row("encloses", f"{printed(self.radius, 'um')} about its origin"),
            Row("modes", f"{len(self.modes)}, up to degree {self.degree}"),
            Row("shape", shape),
            Row("absorbs", "no" if self.lossless else "yes"),
            Row("error", f"{self.error:.1g}"),
            Row("unitarity", f"{self.unitarity:.1g}"),
            Row("reciprocity", f"{self.reciprocity:.1g}"),
        )
        return Card("TMatrix", "", rows)

    def cut(self, degree: int) -> TMatrix:
        """Return this T-matrix without the modes above a degree."""
        if degree >= self.degree:
            return self
        count = 2 * degree * (degree + 2)
        values = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return TMatrix(**{**values, "matrix": np.ascontiguousarray(self.matrix[:count, :count])})


def sphere_t_matrix(
    a: ComplexArray,
    b: ComplexArray,
    wavenumber: float,
    refractive_index: float,
    radius: float,
    *,
    lossless: bool,
) -> TMatrix:
    """Return the T-matrix of a sphere from its Mie coefficients.

    Parameters
    ----------
    a, b : ndarray, shape (degree,)
        Mie coefficients a_n and b_n, n = 1, 2, ...
    wavenumber : float
        Wavenumber in the medium, 1/m.
    refractive_index : float
        Refractive index of the medium.
    radius : float
        Radius, m.
    lossless : bool
        Whether the sphere absorbs nothing.
    """
    modes = modes_up_to(len(a))
    n, helicity = modes[:, 0] - 1, modes[:, 2]
    matrix = np.zeros((len(modes),) * 2, np.complex128)
    every = np.arange(len(modes))
    matrix[every, every] = -(a[n] + b[n]) / 2
    matrix[every, every + helicity] = -(a[n] - b[n]) / 2  # the other helicity is the next mode
    return TMatrix(matrix, wavenumber, refractive_index, radius, lossless, 0.0)
