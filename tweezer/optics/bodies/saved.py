"""Writing of T-matrices to files of the T-matrix data format, storage version 1 (`.tmat.h5`).

`tweezer.optics.bodies.files` reads them.
"""

from __future__ import annotations

import math
import platform
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from tweezer.values.errors import ResultError
from tweezer.values.files import replacing

if TYPE_CHECKING:
    import h5py

ComplexArray = NDArray[np.complex128]

#: Names of the polarisations in the files: helicity +1 and -1, or electric and magnetic
NAMES = {"helicity": ("positive", "negative"), "electric/magnetic": ("electric", "magnetic")}
#: Key of this package for the radius of the sphere about the origin that encloses the body
ENCLOSING = "circumscribed_radius"


class _TMatrix(Protocol):
    """The properties of a `TMatrix` that a file contains."""

    @property
    def matrix(self) -> ComplexArray: ...
    @property
    def modes(self) -> NDArray[np.int64]: ...
    @property
    def wavenumber(self) -> float: ...
    @property
    def refractive_index(self) -> float: ...
    @property
    def radius(self) -> float: ...
    @property
    def lossless(self) -> bool: ...
    @property
    def error(self) -> float: ...
    @property
    def axial(self) -> bool: ...


def save_t_matrix(
    t_matrix: _TMatrix,
    path: str | Path,
    *,
    polarisation: Literal["helicity", "electric/magnetic"] = "helicity",
    name: str = "",
    description: str = "",
    permittivity: complex | None = None,
) -> Path:
    """Save a T-matrix to a file of the T-matrix data format.

    Parameters
    ----------
    t_matrix : TMatrix
        T-matrix of a body.
    path : str or Path
        Name of the file, ending in .tmat.h5.
    polarisation : {"helicity", "electric/magnetic"}, optional
        Modes of the file.
    name, description : str, optional
        Name and description of the body in the file.
    permittivity : complex, optional
        Relative permittivity of a homogeneous body, stored for other readers.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ResultError
        If the file cannot be written, or its name does not end in .tmat.h5.
    ValueError
        For another polarisation.
    """
    import h5py

    path = Path(path)
    if not path.name.endswith(".tmat.h5"):
        raise ResultError(f"{path}: must end in .tmat.h5")
    if polarisation not in NAMES:
        raise ValueError(
            f"polarisation = {polarisation!r}: must be 'helicity' or 'electric/magnetic'"
        )
    matrix, modes = t_matrix.matrix, t_matrix.modes
    if polarisation == "electric/magnetic":
        matrix = other_basis(matrix)
    n = t_matrix.refractive_index
    keywords = ["passive", "reciprocal", *["lossless"] * t_matrix.lossless]
    keywords += ["czinfinity"] * t_matrix.axial
    with replacing(path) as content, h5py.File(content, "w", libver="v110") as file:
        file.attrs["storage_format_version"] = "v1"
        file.attrs["keywords"] = ", ".join(keywords)
        _describe(file, name or path.name.removesuffix(".tmat.h5"), description)
        file["tmatrix"] = matrix
        file["vacuum_wavelength"] = 2 * math.pi * n / t_matrix.wavenumber * 1e9
        file["vacuum_wavelength"].attrs["unit"] = "nm"
        file["modes/l"], file["modes/m"] = modes[:, 0], modes[:, 1]
        names = [NAMES[polarisation][int(helicity < 0)] for helicity in modes[:, 2]]
        file.create_dataset("modes/polarization", data=names, dtype=h5py.string_dtype())
        file["embedding/relative_permittivity"] = n**2
        file["embedding/relative_permeability"] = 1.0
        file["embedding"].attrs["name"] = "Custom"
        geometry = file.create_group("scatterer/geometry")
        geometry.attrs["unit"] = "nm"
        geometry[ENCLOSING] = t_matrix.radius * 1e9
        geometry[ENCLOSING].attrs["unit"] = "nm"
        material = file.create_group("scatterer/material")
        material.attrs["name"] = "Custom"
        material.attrs["keywords"] = "lossless" if t_matrix.lossless else "absorptive"
        if permittivity is not None:
            material["relative_permittivity"] = permittivity
        computation = file.create_group("computation")
        computation.attrs["name"] = "tweezer"
        computation.attrs["keywords"] = "semi-analytical"
        computation.attrs["accuracy"] = t_matrix.error
        computation.attrs["software"] = ", ".join(
            f"{each}={of}"
            for each, of in [
                ("python", platform.python_version()),
                *((package, version(package)) for package in ("tweezer", "h5py", "numpy")),
            ]
        )
    return path


def other_basis(matrix: ComplexArray) -> ComplexArray:
    """Change T between helicities +, - and electric, magnetic modes, each pair side by side.

    a_+- = (a_electric +- a_magnetic)/sqrt(2), and the inverse has the same form.
    """
    pairs = matrix.reshape(len(matrix) // 2, 2, -1, 2)
    first, second = pairs[:, 0] + pairs[:, 1], pairs[:, 0] - pairs[:, 1]
    rows = np.stack([first, second], axis=1)
    found = np.stack([rows[..., 0] + rows[..., 1], rows[..., 0] - rows[..., 1]], axis=-1)
    return np.ascontiguousarray(found.reshape(matrix.shape) / 2)


def _describe(file: h5py.Group, name: str, description: str) -> None:
    """Write the name and the description of a group, if there are any."""
    for key, text in (("name", name), ("description", description)):
        if text:
            file.attrs[key] = text
