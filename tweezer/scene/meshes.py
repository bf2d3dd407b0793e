"""Closed meshes in files: their triangles about the centre of mass, mass and inertia."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np

from tweezer.scene.body import Body
from tweezer.scene.solids import Solid
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Ends of the names of files that are read
_SUFFIXES = (".stl", ".obj", ".ply")


def mesh(bead: Any) -> Body:
    """Return the solid of a homogeneous body with a closed mesh, exact by signed tetrahedra."""
    corners = triangles(bead.file, bead.scale)
    volume = np.linalg.det(corners) / 6
    whole = corners.sum(axis=1)
    products = np.einsum("nki,nkj->nij", corners, corners) + whole[:, :, None] * whole[:, None]
    second = np.einsum("n,nij->ij", volume / 20, products)
    inertia = bead.density * (np.trace(second) * np.eye(3) - second)
    return Solid(
        bead.density * volume.sum(),
        volume.sum(),
        inertia,
        np.unique(corners.reshape(-1, 3), axis=0),
    )


@functools.lru_cache(maxsize=8)
def triangles(file: str, scale: float) -> Array:
    """Return the corners of the triangles of a mesh from its centre of mass, (n, 3, 3) m.

    Parameters
    ----------
    file : str
        File .stl, .obj or .ply.
    scale : float
        Length of a unit of the file, m.

    Raises
    ------
    SceneError
        For a file that cannot be read, and for a mesh that is not closed.
    """
    vertices, faces = _read(file)
    problem = _open(faces)
    if problem:
        raise SceneError(f"file = {file!r}: the mesh {problem}; it must be closed")
    corners = vertices[faces]
    corners = (corners - corners.mean(axis=(0, 1))) * scale
    volume = np.linalg.det(corners) / 6
    if volume.sum() < 0:  # inside out
        corners, volume = corners[:, ::-1], -volume
    if not volume.sum() > 1e-9 * np.abs(volume).sum():
        raise SceneError(f"file = {file!r}: the mesh encloses no volume")
    found: Array = corners - volume @ corners.sum(axis=1) / 4 / volume.sum()
    found.setflags(write=False)
    return found


def _read(file: str) -> tuple[Array, Any]:
    """Return the vertices of a mesh in a file, (n, 3), and the three vertices of each triangle."""
    path = Path(file)
    if path.suffix.lower() not in _SUFFIXES:
        raise SceneError(f"file = {file!r}: a mesh must be a file {', '.join(_SUFFIXES)}")
    if not path.is_file():
        raise SceneError(f"file = {file!r}: no such file")
    try:
        import trimesh
    except ModuleNotFoundError:
        raise SceneError(
            f"file = {file!r}: reading a mesh requires trimesh; install it with pip install "
            '"tweezer[mesh]"'
        ) from None
    try:
        found = trimesh.load_mesh(path, process=False)
        vertices, faces = np.array(found.vertices, float), np.array(found.faces)
    except Exception as error:  # readers of trimesh raise anything
        reason = str(error).splitlines() or [type(error).__name__]
        raise SceneError(f"file = {file!r}: not a readable mesh: {reason[0]}") from None
    if faces.ndim != 2 or not len(faces) or not np.isfinite(vertices).all():
        raise SceneError(f"file = {file!r}: contains no triangles of finite size")
    # corners at the same place are one vertex, whatever the file repeats
    size = np.ptp(vertices, axis=0).max()
    _, first, merged = np.unique(
        np.round(vertices / (1e-7 * size)), axis=0, return_index=True, return_inverse=True
    )
    faces = merged.reshape(-1)[faces]
    distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return vertices[first], faces[distinct]


def _open(faces: Any) -> str:
    """Return why triangles do not form a closed and oriented surface; "" if they do."""
    edges = np.concatenate([faces, np.roll(faces, -1, axis=1)]).reshape(2, -1).T
    _, shared = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    if lonely := int((shared != 2).sum()):
        return f"has {lonely} edges that do not belong to two triangles"
    _, alike = np.unique(edges, axis=0, return_counts=True)
    if turned := int((alike != 1).sum()):
        return f"has {turned} edges at which the orientation changes"
    return ""
