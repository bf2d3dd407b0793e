"""T-matrices of the shapes that a scene describes."""

from __future__ import annotations

import functools
import hashlib
import math
from typing import Any

import numpy as np

from tweezer.optics import table
from tweezer.optics.bodies.t_matrix import TMatrix, sphere_t_matrix
from tweezer.scene import SceneLike, checked_scene
from tweezer.scene.choices import SHAPES, at
from tweezer.values.errors import SceneError

#: Largest ratio of the axes of a spheroid, and largest k times its larger semi-axis
_LARGEST_ASPECT, _LARGEST_SPHEROID = 5.0, 30.0
#: Largest k times the radius that encloses a cluster
_LARGEST_CLUSTER = 30.0
#: Code that computes the T-matrix of a cluster, which is kept in the cache folder. That of a
#: spheroid takes less time than reading it
_SOURCES = table.sources(
    *(
        f"optics.{name}"
        for name in ("bodies.cluster", "bodies.translation", "bodies.rotation", "waves.sphere")
    )
)
#: Largest error of an element of S - 1
_LARGEST_ERROR = 1e-6


def t_matrix(scene: SceneLike) -> TMatrix:
    """Return the T-matrix of the bead of a scene, about its centre of mass.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene of the bead. All beams must have the same wavelength.

    Returns
    -------
    TMatrix
        The matrix with its modes, error, unitarity and reciprocity.

    Raises
    ------
    SceneError
        For a body outside the range of the method, or a T-matrix in a file for another wavelength
        or medium.

    Examples
    --------
    >>> body = tweezer.t_matrix("silica-1um")
    >>> body.unitarity < 1e-14
    True
    """
    scene = checked_scene(scene)
    wavelengths = {beam.wavelength for beam in scene.beams}
    if len(wavelengths) > 1:
        raise SceneError("beam: a T-matrix requires beams of one wavelength")
    vacuum = 2 * math.pi / wavelengths.pop()
    found: TMatrix = _kept(scene.bead, vacuum, scene.medium.refractive_index)
    return found


@functools.lru_cache(maxsize=8)
def _kept(bead: Any, vacuum: float, refractive_index: float) -> TMatrix:
    """Return the T-matrix of a bead; the last few are kept.

    vacuum: wavenumber in vacuum, 1/m. refractive_index: of the medium.
    """
    found: TMatrix = at(SHAPES[bead.shape].t_matrix)(bead, vacuum * refractive_index,
                                                     refractive_index)  # fmt: skip
    if not found.error <= _LARGEST_ERROR:
        raise SceneError(
            f"bead.shape = {bead.shape!r}: the T-matrix has an error of {found.error:.2g}; allowed:"
            f" {_LARGEST_ERROR:g}; choose a smaller or rounder body"
        )
    return found


def sphere(bead: Any, wavenumber: float, refractive_index: float) -> TMatrix:
    """Return the T-matrix of a sphere in layers, from its Mie coefficients."""
    from tweezer.optics.bodies.spheroid import degree_for
    from tweezer.optics.waves.sphere import mie_coefficients

    shells = tuple((outer, index / refractive_index) for outer, index in bead.shells)
    degree = degree_for(_small_enough(bead, wavenumber, bead.radius, _LARGEST_SPHEROID))
    a, b = mie_coefficients(shells, wavenumber, degree)
    return sphere_t_matrix(
        a, b, wavenumber, refractive_index, bead.radius, lossless=not bead.absorbs
    )


def spheroid(bead: Any, wavenumber: float, refractive_index: float) -> TMatrix:
    """Return the T-matrix of a spheroid, by the extended boundary condition method."""
    across, along = bead.radius, bead.length / 2
    said = f"length = {bead.length:.4g}: is {along / across:.3g} times bead.diameter"
    return _revolved(bead, across, along, said, wavenumber, refractive_index)


def ellipsoid(bead: Any, wavenumber: float, refractive_index: float) -> TMatrix:
    """Return the T-matrix of an ellipsoid: of a file, or of a spheroid about z."""
    x, y, z = bead.semi_axes
    if bead.t_matrix is not None or x != y:
        return from_key(bead, wavenumber, refractive_index)
    if not bead.indexed:
        raise SceneError(
            "bead.refractive_index: missing; the light on an ellipsoid requires it, or the file "
            "bead.t_matrix"
        )
    said = f"semi_axes = {list(bead.semi_axes)}: the last is {z / x:.3g} times the others"
    return _revolved(bead, x, z, said, wavenumber, refractive_index)


def _revolved(
    bead: Any, across: float, along: float, said: str, wavenumber: float, refractive_index: float
) -> TMatrix:
    """Return the T-matrix of a spheroid with these semi-axes, m.

    `said` is the key of the semi-axes with their ratio, for messages.
    """
    from tweezer.optics.bodies.spheroid import spheroid_t_matrix

    aspect = along / across
    if not 1 / _LARGEST_ASPECT <= aspect <= _LARGEST_ASPECT:
        raise SceneError(
            f"bead.{said}; spheroids are computed from 1/{_LARGEST_ASPECT:g} to "
            f"{_LARGEST_ASPECT:g} times"
        )
    _small_enough(bead, wavenumber, max(across, along), _LARGEST_SPHEROID)
    index = bead.index / refractive_index
    return spheroid_t_matrix(across, along, index, wavenumber, refractive_index)


def cluster(bead: Any, wavenumber: float, refractive_index: float) -> TMatrix:
    """Return the T-matrix of a rigid cluster of spheres, by superposition."""
    from tweezer.optics.bodies.cluster import cluster_t_matrix

    _small_enough(bead, wavenumber, bead.body.size, _LARGEST_CLUSTER)
    spheres = tuple(
        (np.array(centre), each.radius, _complex(each.refractive_index) / refractive_index)
        for centre, each in zip(bead.centres, bead.spheres, strict=True)
    )
    said = [(*centre, *rest) for centre, *rest in spheres]
    key = hashlib.sha256(f"{_SOURCES}{said}{wavenumber}{refractive_index}".encode()).hexdigest()
    make = functools.partial(cluster_t_matrix, spheres, wavenumber, refractive_index)
    return table.kept(key, TMatrix, make)[0]


def from_file(bead: Any, wavenumber: float, refractive_index: float) -> TMatrix:
    """Return the T-matrix of the file that is the body, for the light and medium of a scene."""
    return _read(bead, "file", wavenumber, refractive_index)


def from_key(bead: Any, wavenumber: float, refractive_index: float) -> TMatrix:
    """Return the T-matrix of the file of a body of some other shape."""
    if bead.t_matrix is None:
        article = "an" if bead.shape == "ellipsoid" else "a"
        shape = "given body" if bead.shape == "given" else bead.shape
        raise SceneError(
            f"bead.t_matrix: missing; the light on {article} {shape} requires a T-matrix file, or "
            "set the beam's power to 0"
        )
    return _read(bead, "t_matrix", wavenumber, refractive_index)


def _read(bead: Any, key: str, wavenumber: float, refractive_index: float) -> TMatrix:
    """Return the T-matrix in the file that a key of the bead names."""
    from tweezer.optics.bodies.files import load_t_matrix

    try:
        found: TMatrix = load_t_matrix(
            getattr(bead, key), wavelength=2 * math.pi * refractive_index / wavenumber,
            refractive_index=refractive_index, radius=bead.body.size,
        )  # fmt: skip
    except SceneError as error:
        raise SceneError(f"bead.{key} = {error}") from None
    return found


def _small_enough(bead: Any, wavenumber: float, radius: float, largest: float) -> float:
    """Return k times the radius that encloses a body; refuse one above `largest`."""
    size = wavenumber * radius
    if size > largest:
        raise SceneError(
            f"bead.shape = {bead.shape!r}: the body reaches {radius:.4g} m from its centre; "
            f"computed up to {largest / wavenumber:.3g} m"
        )
    return size


def _complex(index: float | tuple[float, float]) -> complex:
    """Return a refractive index, a number or its two parts, as complex."""
    return complex(*index) if isinstance(index, tuple) else complex(index)
