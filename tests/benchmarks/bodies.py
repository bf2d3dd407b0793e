"""Light on spheroids and clusters: time and error of forces, and certificates of T-matrices.

The scene `polystyrene-500nm` provides material and light, with an aperture of 1.2. The positions
are within 0.7 radii of the focus, where the radius is the one of the sphere of the same volume, and
the orientations are random. All times of forces are taken in turn with those of a 1 um sphere, so
that their ratios depend little on the load of the machine.

Errors of forces are differences to the same T-matrix at a tolerance of 1e-13. At some positions
this reference is compared with Maxwell's stress tensor (`tests.optics.bodies.maxwell`). T-matrices
are compared with treams, if it is installed, and with published elements of SMARTIES.
"""

from __future__ import annotations

import functools
import json
import math
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import ROOT, Call, machine, per_item
from tests.optics.bodies.maxwell import force_and_torque
from tweezer.forces.force import Wrench
from tweezer.optics import light_force
from tweezer.optics.bodies import cluster, shapes
from tweezer.optics.bodies.by_sums import LightOnBody
from tweezer.optics.bodies.saved import other_basis
from tweezer.optics.bodies.spheroid import spheroid_t_matrix
from tweezer.optics.bodies.t_matrix import TMatrix
from tweezer.scene import Scene

Array = NDArray[np.float64]
Results = dict[str, Any]

SCENE = "polystyrene-500nm"
TOLERANCES = (1e-4, 1e-6, 1e-8)
#: tolerance of the forces that errors are measured against
TRUTH = 1e-13
#: part of the largest force below which errors are relative to it
VANISHING = 1e-6
#: distance of the positions from the focus, radii of the sphere of the same volume
NEAR = 0.7
#: radii of the spheres of the same volume as the spheroids (um), and length over diameter
RADII, ASPECTS = (0.25, 0.5, 1.0), (2.0, 0.5)
#: refractive index of gold at 1064 nm, Johnson and Christy, Phys. Rev. B 6, 4370 (1972)
GOLD = "0.26+6.97j"
#: published elements of T-matrices
PUBLISHED = ROOT / "tests/data/smarties-gold.json"


class Body(NamedTuple):
    """A body in the light of `SCENE`."""

    name: str
    kind: str
    """spheroid, cluster or sphere"""
    scene: Scene
    radius: float
    """radius of the sphere of the same volume, m"""


class Effort(NamedTuple):
    """How much is measured."""

    radii: tuple[float, ...]
    clusters: int
    poses: int
    rounds: int
    exact: int
    """poses of each body that are compared with the stress tensor"""
    t_matrices: int
    """how often the T-matrix of a spheroid is computed, for its time"""
    degrees: tuple[int, ...]
    """degrees of the spheres that are compared with treams"""


FULL = Effort(
    radii=RADII, clusters=3, poses=64, rounds=60, exact=4, t_matrices=3, degrees=(6, 8, 10)
)
QUICK = Effort(radii=(0.25,), clusters=1, poses=8, rounds=2, exact=1, t_matrices=1, degrees=(3,))


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """Run the whole benchmark; `say` is called with the subject of each measurement."""
    # every T-matrix is kept, because those of clusters take seconds
    with patch.object(shapes, "_kept", functools.cache(shapes._kept.__wrapped__)):
        results: Results = _to_four_digits(_measured(quick, say))
    return results


def _measured(quick: bool, say: Callable[[str], object]) -> Results:
    effort = QUICK if quick else FULL
    matrices = []
    for body in (*_spheroids(effort), *clusters(effort)):
        say(f"T-matrix: {body.name}")
        matrices.append(_t_matrix(body, effort))
    bodies = [spheroid(radius, aspect) for radius in effort.radii for aspect in ASPECTS]
    bodies += clusters(effort)
    say("times of forces")
    forces = _forces(bodies, effort)
    for entry, body in zip(forces["bodies"], bodies, strict=True):
        say(f"errors: {body.name}")
        entry.update(_errors(body, entry["tolerances"], effort))
    say("treams")
    compared = _treams(effort)
    say("published elements")
    return {
        "machine": machine(), "quick": quick, **forces, "t_matrices": matrices,
        "treams": compared, "published": _published(),
    }  # fmt: skip


# --- bodies --------------------------------------------------------------------------------------


def spheroid(radius: float, aspect: float, name: str = "", **bead: Any) -> Body:
    """Return a spheroid of the same volume as a sphere of a radius, um."""
    diameter = 2e-6 * radius * aspect ** (-1 / 3)
    # for the drag of the smallest bodies water is no continuum
    with warnings.catch_warnings(action="ignore", category=tweezer.PhysicsWarning):
        scene = tweezer.load_scene(SCENE).replace(
            bead={"shape": "spheroid", "diameter": diameter, "length": aspect * diameter, **bead}
        )
    return Body(name or f"{radius:g} um, {_ratio(aspect)}", "spheroid", scene, 1e-6 * radius)


def _ratio(aspect: float) -> str:
    return f"{aspect:g}:1" if aspect >= 1 else f"1:{1 / aspect:g}"


def clusters(effort: Effort = FULL) -> list[Body]:
    """Return two, three and four touching spheres: in a line, a triangle and a tetrahedron."""
    half, third = 1 / 2, 1 / math.sqrt(3)
    triangle = [
        (third * math.cos(angle), third * math.sin(angle), 0.0)
        for angle in (0, 2 * math.pi / 3, 4 * math.pi / 3)
    ]
    corner = math.sqrt(1 / 8)
    tetrahedron = [(corner * x, corner * y, corner * x * y) for x in (1, -1) for y in (1, -1)]
    found = [
        ("2 spheres of 0.5 um", 0.5, [(0.0, 0.0, -half), (0.0, 0.0, half)]),
        ("3 spheres of 0.4 um", 0.4, triangle),
        ("4 spheres of 0.4 um", 0.4, tetrahedron),
    ]
    return [
        _cluster(name, [(diameter, *(diameter * x for x in at)) for at in positions])
        for name, diameter, positions in found[: effort.clusters]
    ]


def _cluster(name: str, spheres: list[tuple[float, ...]]) -> Body:
    """Return a cluster from the diameter and the position of each sphere, um."""
    index = tweezer.load_scene(SCENE).bead.refractive_index
    scene = tweezer.load_scene(SCENE).replace(
        bead={
            "shape": "spheres",
            "spheres": [
                {
                    "diameter": 1e-6 * d,
                    "position": [1e-6 * x for x in at],
                    "refractive_index": index,
                }
                for d, *at in spheres
            ],
        }
    )
    return Body(name, "cluster", scene, 0.5e-6 * sum(d**3 for d, *_ in spheres) ** (1 / 3))


def apart() -> Body:
    """Return the cluster that is compared with treams: three spheres apart, without symmetry."""
    return _cluster(
        "3 spheres apart",
        [(0.28, 0.0, 0.0, -0.21), (0.28, 0.035, 0.21, 0.14), (0.21, 0.28, -0.07, 0.14)],
    )


def _spheroids(effort: Effort) -> list[Body]:
    """Return the spheroids whose T-matrices are certified."""
    rod = 0.02 * 3 ** (1 / 3)  # 40 nm across, 120 nm along
    found = [
        spheroid(0.5, 2, "polystyrene, 0.5 um, 2:1"),
        spheroid(1, 3, "polystyrene, 1 um, 3:1"),
        spheroid(rod, 3, "gold rod, 40 nm, 3:1", refractive_index=GOLD, density=19300),
    ]
    return found[:: 2 if len(effort.radii) == 1 else 1]


def poses(body: Body, count: int) -> tuple[Array, Array]:
    """Return positions (count, 3) m evenly in a ball, and random Euler parameters (count, 4)."""
    rng = np.random.default_rng(19)
    direction, turned = rng.normal(size=(count, 3)), rng.normal(size=(count, 4))
    distance = NEAR * body.radius * rng.random(count) ** (1 / 3)
    return (
        direction * (distance / _lengths(direction))[:, None],
        turned / _lengths(turned)[:, None],
    )


def _lengths(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))


# --- forces --------------------------------------------------------------------------------------


def _force(scene: Scene, tolerance: float) -> Any:
    """Return the force of the light of a scene at a tolerance."""
    return light_force(scene.replace(optics={"theory": "waves", "tolerance": tolerance}))


def _forces(bodies: list[Body], effort: Effort) -> Results:
    """Return the times of the 1 um sphere and of all bodies, by tolerance."""
    sphere = Body("1 um sphere", "sphere", _sphere(), 0.5e-6)
    every = [(body, tolerance) for body in (sphere, *bodies) for tolerance in TOLERANCES]
    groups = [list(calls) for each in every for calls in _calls(*each, effort)]
    # the sphere comes first, so that it would follow a large body whose data fill the caches
    _, *measured = per_item([groups[0], *groups], effort.rounds)
    least = iter(1e6 * time for time, _ in measured)
    times = {(body.name, tolerance): (next(least), next(least)) for body, tolerance in every}
    found = []
    for body in bodies:
        entries = []
        for tolerance in TOLERANCES:
            force, derivative = times[body.name, tolerance]
            entries.append({
                "tolerance": tolerance, "us": force, "derivative_us": derivative,
                "over_sphere": force / times[sphere.name, tolerance][0],
                "derivative_over_force": derivative / force,
            })  # fmt: skip
        found.append({"name": body.name, "kind": body.kind, "tolerances": entries})
    of_sphere = [
        {"tolerance": tolerance, "us": times[sphere.name, tolerance][0],
         "gradient_us": times[sphere.name, tolerance][1]}
        for tolerance in TOLERANCES
    ]  # fmt: skip
    return {"sphere": of_sphere, "bodies": found}


def _sphere() -> Scene:
    return tweezer.load_scene(SCENE).replace(bead={"diameter": "1 um"})


def _calls(body: Body, tolerance: float, effort: Effort) -> Iterator[Iterator[Call]]:
    """Yield the calls that compute forces, and those that compute derivatives too."""
    force = _force(body.scene, tolerance)
    at, turned = poses(body, effort.poses if body.kind != "sphere" else 4 * effort.poses)
    if isinstance(force, LightOnBody):
        yield iter([Call(partial(force.field, at, orientations=turned), len(at))])
        parts = zip(np.array_split(at, 4), np.array_split(turned, 4), strict=True)
        yield (Call(partial(force.derivative, *part), len(part[0])) for part in parts)
    else:
        yield iter([Call(partial(force.field, at), len(at))])
        yield iter([Call(partial(force.field, at, gradient=True), len(at))])


def _errors(body: Body, entries: list[Results], effort: Effort) -> Results:
    """Add the errors of each tolerance to its entry; return those of the reference."""
    at, turned = poses(body, effort.poses)
    exact = _force(body.scene, TRUTH)
    truth, slopes = exact.field(at, orientations=turned), exact.derivative(at, turned)
    for entry in entries:
        force = _force(body.scene, entry["tolerance"])
        found = force.field(at, orientations=turned)
        off = _lengths(found.force - truth.force)
        size = _lengths(truth.force)
        entry.update({
            "force_error": float((off / np.maximum(size, VANISHING * size.max())).max()),
            "error_over_largest_force": float(off.max() / size.max()),
            "torque_error_over_largest": _largest(found.moment - truth.moment, truth.moment),
            "derivative_error_over_largest": max(
                _largest(part, whole)
                for part, whole in zip(
                    _blocks(force.derivative(at, turned) - slopes), _blocks(slopes), strict=True
                )
            ),
            "least_estimate_over_error": float((found.error / np.maximum(off, 1e-300)).min()),
        })  # fmt: skip
    few = slice(effort.exact)
    by_stress = _by_stress(body, at[few], turned[few])
    return {
        "degree": tweezer.t_matrix(body.scene).degree,
        "force_off_stress": _largest(
            by_stress.force - truth.force[few], by_stress.force
        ),
        "torque_off_stress": _largest(by_stress.moment - truth.moment[few], by_stress.moment),
    }  # fmt: skip


def _largest(off: Array, whole: Array) -> float:
    """Return the largest length of vectors, or of matrices, over the largest of others."""
    count = len(off)
    return float(_lengths(off.reshape(count, -1)).max() / _lengths(whole.reshape(count, -1)).max())


def _blocks(slopes: Array) -> list[Array]:
    """Return the blocks of the derivative: of force and torque over position and angle."""
    return [slopes[:, i : i + 3, j : j + 3] for i in (0, 3) for j in (0, 3)]


def _by_stress(body: Body, at: Array, turned: Array) -> Wrench:
    """Return force and torque from Maxwell's stress tensor around the body."""
    matrix = tweezer.t_matrix(body.scene)
    found = [
        force_and_torque(
            body.scene, matrix, place, Rotation.from_quat(np.roll(each, -1)).as_matrix()
        )
        for place, each in zip(at, turned, strict=True)
    ]
    none = np.empty((0, 3, 3))
    force, moment = (np.array([each[i] for each in found]) for i in (0, 1))
    return Wrench(force, moment, none, none, np.full(len(at), math.nan))


# --- T-matrices ----------------------------------------------------------------------------------


def _t_matrix(body: Body, effort: Effort) -> Results:
    """Return the time and the certificates of a T-matrix; the code is compiled before."""
    _compiled(body.kind)
    times = []
    for _ in range(effort.t_matrices if body.kind == "spheroid" else 1):
        if body.kind == "spheroid":
            shapes._kept.cache_clear()
        start = time.perf_counter()
        found = tweezer.t_matrix(body.scene)
        times.append(time.perf_counter() - start)
    return {
        "name": body.name, "kind": body.kind, "degree": found.degree, "seconds": min(times),
        "error": found.error, "unitarity": found.unitarity, "reciprocity": found.reciprocity,
    }  # fmt: skip


def _compiled(kind: str) -> None:
    """Compute the T-matrix of a small body, which compiles or loads the code."""
    if kind == "spheroid":
        tweezer.t_matrix(spheroid(0.05, 2).scene)
    else:
        tweezer.t_matrix(_cluster("", [(0.1, 0, 0, 0), (0.1, 0, 0.2, 0.2)]).scene)


def treams_version() -> str | None:
    """Return the version of treams; None if it is not installed."""
    try:
        return version("treams")
    except PackageNotFoundError:
        return None


def _treams(effort: Effort) -> Results:
    """Return the comparison with treams: times, T-matrices, and the force by a file of treams."""
    body = apart()
    results: Results = {"version": treams_version(), "name": body.name, "degrees": []}
    if results["version"] is None:
        return results
    _by_treams(body, 3, _of_degree(body, 3).degree)  # loads the code of both
    for degree in effort.degrees:
        start = time.perf_counter()
        ours = _of_degree(body, degree)
        seconds = time.perf_counter() - start
        start = time.perf_counter()
        theirs = _by_treams(body, degree, ours.degree)
        results["degrees"].append({
            "degree": degree, "tweezer_s": seconds, "treams_s": time.perf_counter() - start,
            "difference": 2 * float(np.abs(_ordered(theirs, ours) - ours.matrix).max()),
        })  # fmt: skip
    return results | _by_file(body, theirs, effort)


def _of_degree(body: Body, degree: int) -> TMatrix:
    """Return the T-matrix of a cluster with waves about its spheres up to a degree."""
    n, beam = body.scene.medium.refractive_index, body.scene.beam
    with patch.object(cluster, "HIGHEST_DEGREE", degree):
        return cluster.cluster_t_matrix(
            [(at, radius, complex(index) / n) for at, radius, index in _placed(body)],
            2 * math.pi * n / beam.wavelength, n, tolerance=1e-16,
        )  # fmt: skip


def _placed(body: Body) -> Iterator[tuple[Array, float, float]]:
    """Yield the position about the centre (m), the radius (m) and the index of each sphere."""
    bead = body.scene.bead
    for at, each in zip(bead.centres, bead.spheres, strict=True):
        yield np.array(at), each.radius, each.refractive_index


def _by_treams(body: Body, degree: int, about_origin: int) -> Any:
    """Return the T-matrix of a cluster by treams, with waves about the origin up to a degree."""
    import treams

    n, beam = body.scene.medium.refractive_index, body.scene.beam
    k0 = 2 * math.pi / beam.wavelength * 1e-9  # in nm, as its files
    spheres = [
        treams.TMatrix.sphere(
            degree, k0, 1e9 * radius, [treams.Material(index**2), treams.Material(n**2)]
        )
        for _, radius, index in _placed(body)
    ]
    whole = treams.TMatrix.cluster(spheres, [1e9 * at for at, *_ in _placed(body)])
    basis = treams.SphericalWaveBasis.default(about_origin)
    return whole.interaction.solve().expand(basis)


def _ordered(theirs: Any, ours: TMatrix) -> NDArray[np.complex128]:
    """Return the T-matrix of treams with the modes in the order of `TMatrix`."""
    basis = theirs.basis
    modes = zip(basis.l, basis.m, np.where(basis.pol == 1, 1, -1), strict=True)
    at = {tuple(int(each) for each in mode): i for i, mode in enumerate(modes)}
    order = [at[tuple(mode)] for mode in ours.modes.tolist()]
    found: NDArray[np.complex128] = np.asarray(theirs)[np.ix_(order, order)]
    return found


def _by_file(body: Body, theirs: Any, effort: Effort) -> Results:
    """Return the deviation of force and torque by a file of treams from those of the cluster."""
    import h5py
    from treams.io import save_hdf5

    at, turned = poses(body, effort.poses)
    expected = _force(body.scene, TOLERANCES[-1]).field(at, orientations=turned)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cluster.tmat.h5"
        with h5py.File(path, "w") as file, warnings.catch_warnings(action="ignore"):
            save_hdf5(file, [theirs], lunit="nm")
        scene = tweezer.load_scene(SCENE).replace(
            bead={
                "shape": "t-matrix", "file": str(path),
                "diameter": 2 * tweezer.t_matrix(body.scene).radius,
            }
        )  # fmt: skip
        found = _force(scene, TOLERANCES[-1]).field(at, orientations=turned)
    return {
        "tolerance": TOLERANCES[-1],
        "force_difference": _largest(found.force - expected.force, expected.force),
        "torque_difference": _largest(found.moment - expected.moment, expected.moment),
    }


def _published() -> list[Results]:
    """Return the deviation from published elements of the T-matrix of a gold spheroid."""
    published = json.loads(PUBLISHED.read_text(encoding="utf-8"))
    n, (across, along) = published["refractive_index"], published["semi_axes_m"]
    found = []
    for each in published["wavelengths"]:
        wavenumber = 2 * math.pi * n / (1e-9 * each["nm"])
        index = complex(*each["permittivity"]) ** 0.5 / n
        T = spheroid_t_matrix(across, along, index, wavenumber, n)
        matrix = other_basis(T.matrix)
        rows = {
            (l, m, "electric" if helicity > 0 else "magnetic"): i
            for i, (l, m, helicity) in enumerate(T.modes.tolist())
        }
        ours = np.array([matrix[rows[tuple(to)], rows[tuple(by)]] for to, by in published["modes"]])
        theirs = np.array([complex(*element) for element in each["elements"]])
        found.append({
            "nm": each["nm"], "elements": len(ours), "largest": float(np.abs(theirs).max()),
            "difference": float(np.abs(ours - theirs).max()), "error": T.error,
            "accuracy": published["accuracy"],
        })  # fmt: skip
    return found
