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
    from tweezer.optics.bodies.spheroid import spheroid_t_matrix

    across, along = bead.radius, bead.length / 2
    aspect = along / across
    if not 1 / _LARGEST_ASPECT <= aspect <= _LARGEST_ASPECT:
        raise SceneError(
            f"bead.length = {bead.length:.4g}: is {aspect:.3g} times bead.diameter; spheroids are "
            f"computed from 1/{_LARGEST_ASPECT:g} to {_LARGEST_ASPECT:g} times"
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
    """Return the T-matrix of a file, for the light and the medium of a scene."""
    from tweezer.optics.bodies.files import load_t_matrix

    try:
        found: TMatrix = load_t_matrix(
            bead.file, wavelength=2 * math.pi * refractive_index / wavenumber,
            refractive_index=refractive_index, radius=bead.radius,
        )  # fmt: skip
    except SceneError as error:
        raise SceneError(f"bead.file = {error}") from None
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
