"""The force of waves: error against time by size of the bead, its map, and sums of others.

Called by `tests.benchmarks.force`. Beads of all sizes are of silica in the light of `silica-1um`.
True errors are differences to the quadrature at a tolerance of 1e-13, which has nodes of its own
number, and at some places to plane waves that `tests.reference.plane_waves` scatters one by one.
They are relative to the force there, or to 1e-6 of the largest force where it is smaller.
"""

from __future__ import annotations

import functools
import importlib.util
import math
import os
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

import tweezer
from tests.benchmarks import fatcuda_sum
from tests.benchmarks.timing import Call, calls_over, per_item
from tests.reference import plane_waves
from tests.reference.waves import Light, Sphere, force
from tweezer.forces.force import Wrench
from tweezer.optics import cone, force_map, light_force, table
from tweezer.scene import Scene

Array = NDArray[np.float64]
Results = dict[str, Any]

SCENE = "silica-1um"
#: diameters, um
SIZES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
#: largest diameter of the beads whose map is made, um
MAPPED = 5.0
#: largest diameter of the beads whose force is summed in NumPy too, um
SUMMED = 5.0
#: kinds of places: distance from the focus, radii of the bead
BANDS = {"inside": (0.0, 0.7), "edge": (0.7, 1.6), "outside": (1.6, 5.0), "far": (5.0, 20.0)}
BEADS = ("thesis-500nm", "thesis-990nm", "thesis-1950nm", SCENE)
TOLERANCE, TABLE_TOLERANCE = 1e-8, 1e-7
#: tolerance of what errors are measured against; smaller ones are not resolved
TRUTH = 1e-13
#: part of the largest force below which errors are relative to it
VANISHING = 1e-6
#: by what the largest force is found
_COARSE = {"evaluator": "quadrature", "tolerance": 1e-4}


class Effort(NamedTuple):
    """How much is measured."""

    sizes: tuple[float, ...]
    tolerances: tuple[float, ...]
    places: int
    """of each kind"""
    beads: int
    """places of each of `BEADS`"""
    timed: int
    """of the places of a kind, how many are timed at least"""
    rounds: int
    read: int
    """places a batch that reads a map"""
    exact: int
    """places of each of `BEADS` that plane waves are added at"""
    summed: int
    """places in a batch of the sum in NumPy"""


FULL = Effort(
    sizes=SIZES, tolerances=tuple(float(f"1e-{k}") for k in range(2, 13)), places=64, beads=4000,
    timed=16, rounds=20, read=100_000, exact=10, summed=100,
)  # fmt: skip
QUICK = Effort(
    sizes=(0.5,), tolerances=(1e-2, 1e-8), places=4, beads=8, timed=2, rounds=2, read=100, exact=1,
    summed=4,
)  # fmt: skip


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """All about waves; `say` is told what is being measured."""
    effort = QUICK if quick else FULL
    results: Results = {"beads": {}, "sizes": []}
    for name in BEADS:
        say(f"waves: {name}")
        results["beads"][name] = _bead(as_waves(tweezer.load_scene(name)), effort)
    say("rays, of any size")
    results["rays"] = _bands(tweezer.load_scene(SCENE).replace(optics={"theory": "rays"}), effort)
    for diameter in effort.sizes:
        say(f"waves: {diameter:g} um")
        scene = of_size(diameter)
        results["sizes"].append(
            {
                "diameter_um": diameter,
                "bands": _bands(scene, effort),
                "inside": _by_tolerance(scene, effort),
                "map": _map(scene, effort) if diameter <= MAPPED else None,
                "numpy": _numpy(scene, effort) if diameter <= SUMMED else None,
            }
        )
    say("fatcuda")
    results["fatcuda"] = _fatcuda(of_size(1.0), effort)
    return results


def as_waves(scene: Scene) -> Scene:
    """The same as waves; the thesis's average of reflectances is unpolarised light."""
    light = {"polarisation": "unpolarised"} if scene.theory == "rays" else {}
    return scene.replace(optics={"theory": "waves", "evaluator": "quadrature"}, beam=light)


def of_size(diameter: float) -> Scene:
    """The bead of `SCENE` with another diameter, um."""
    scene = as_waves(tweezer.load_scene(SCENE))
    loss = 10.5 * diameter * 1e-6  # beyond the farthest place
    return scene.replace(
        bead={"diameter": diameter * 1e-6}, simulation={"loss_distance": loss}, start={
            "position": [0.0, 0.0, 0.0]
        },
    )  # fmt: skip


def places(scene: Scene, band: tuple[float, float], count: int) -> Array:
    """Random places (count, 3) m in a band: distances spread evenly, or their logarithms."""
    rng = np.random.default_rng(19)
    low, high = band
    directions = rng.normal(size=(count, 3))
    directions /= _lengths(directions)[:, None]
    spread = rng.random(count)
    distances = low * (high / low) ** spread if low else high * spread
    return np.asarray(scene.bead.radius * distances[:, None] * directions)


def _bead(scene: Scene, effort: Effort) -> Results:
    """Errors at places to 20 radii from the focus, and times inside."""
    everywhere = places(scene, (0.05, BANDS["far"][1]), effort.beads)
    error, estimate = _errors(scene, everywhere)
    few = places(scene, (0.3, 1.6), effort.exact)
    off = _lengths(_field(scene, few, TRUTH).force - exact(scene, few))
    entry = {
        "largest_error": error,
        "least_estimate_over_error": estimate,
        "truth_off_plane_waves": float((off / _lengths(exact(scene, few))).max()),
    }
    return entry | _times(scene, places(scene, BANDS["inside"], effort.places), effort)


def exact(scene: Scene, at: Array) -> Array:
    """The force (n, 3) N, plane wave by plane wave."""
    lens, beam, bead, medium = scene.lens, scene.beam, scene.bead, scene.medium
    focused = cone(scene)
    shape = plane_waves.lens(focused.half_angle, 2 * beam.sigma / lens.radius, kind=lens.map)
    jones = (math.sqrt(0.5), 1j * math.sqrt(0.5))
    of_lens = plane_waves.Light(
        medium.refractive_index, beam.wavelength, focused.half_angle, shape,
        jones if beam.polarisation == "circular" else "unpolarised",
    )  # fmt: skip
    sphere = plane_waves.Sphere([(bead.radius, bead.index)])
    return np.asarray(focused.power * plane_waves.push(of_lens, sphere, at).force)


def _bands(scene: Scene, effort: Effort) -> Results:
    """Errors and times by kind of place, of those that the light reaches."""
    of_bands: Results = {}
    for band, between in BANDS.items():
        at = places(scene, between, 20 * effort.places if scene.theory == "rays" else effort.places)
        at = at[_field(scene, at, 1e-6).force.any(axis=1)][: effort.places]
        of_bands[band] = {"largest_error": _errors(scene, at)[0], **_times(scene, at, effort)}
    return of_bands


def _by_tolerance(scene: Scene, effort: Effort) -> list[Results]:
    """Error and time inside by tolerance."""
    at = places(scene, BANDS["inside"], effort.places)
    truth = _field(scene, at, TRUTH).force
    return [
        {
            "tolerance": tolerance,
            "largest_error": _relative(light_force(changed).field(at).force - truth, truth, scene),
        }
        | _times(changed, at, effort, gradient=False)
        for tolerance in effort.tolerances
        for changed in [scene.replace(optics={"tolerance": tolerance})]
    ]


def _map(scene: Scene, effort: Effort) -> Results:
    """The map at 1e-7: made, loaded, read in batches, and its error."""
    scene = scene.replace(optics={"evaluator": "map", "table_tolerance": TABLE_TOLERANCE})
    made, loaded = [], []
    for _ in range(effort.rounds // 4 + 1):
        with tempfile.TemporaryDirectory() as folder, patch.dict(
            os.environ, {"XDG_CACHE_HOME": folder}
        ):  # fmt: skip
            table._in_memory.clear()
            made.append(force_map(scene).build_time)
            table._in_memory.clear()
            began = time.perf_counter()
            found = force_map(scene)
            loaded.append(time.perf_counter() - began)
    rng = np.random.default_rng(20)
    directions = rng.normal(size=(effort.read, 3))
    directions /= _lengths(directions)[:, None]
    at = found.range * rng.random((effort.read, 1)) ** (1 / 3) * directions
    bound, some = light_force(scene), at[: effort.beads]
    calls = [
        [Call(partial(bound.field, at, gradient=gradient), len(at))] for gradient in (False, True)
    ]
    (read, _), (with_jacobian, _) = per_item(calls, effort.rounds)
    missed = _lengths(bound.field(some).force - _field(scene, some, TRUTH).force).max()
    return {
        "made_s": min(made),
        "loaded_s": min(loaded),
        "read_ns": 1e9 * read,
        "with_jacobian_ns": 1e9 * with_jacobian,
        "pieces": found.pieces,
        "reach_um": 1e6 * found.range,
        "certified_over_largest_force": found.certified_error / found.largest_force,
        "error_over_largest_force": float(missed) / found.largest_force,
    }


def _numpy(scene: Scene, effort: Effort) -> Results:
    """The sum in NumPy inside, place by place and in a batch, and ours of no larger error."""
    lens, n_m = scene.lens, scene.medium.refractive_index
    unit = scene.beam.wavelength / n_m
    of_lens = Light(lens.numerical_aperture / n_m, 2 * scene.beam.sigma / lens.radius)
    sphere = Sphere(scene.bead.radius / unit, scene.bead.index.real / n_m)
    at = places(scene, BANDS["inside"], effort.summed)
    rho, z = np.hypot(at[:, 0], at[:, 1]), at[:, 2]
    at = np.stack([rho, 0 * rho, z], axis=1)
    truth = _field(scene, at, TRUTH).force
    strength = light_force(scene).light.strength
    summed = partial(force, of_lens, sphere)
    error = _relative(strength * summed(rho / unit, z / unit) - truth, truth, scene)
    for tolerance in effort.tolerances:
        ours = scene.replace(optics={"tolerance": tolerance})
        own = _relative(light_force(ours).field(at).force - truth, truth, scene)
        if own <= max(error, TRUTH):
            break
    few = at[: min(4, len(at))]
    calls = [
        [Call(partial(summed, [x / unit], [height / unit]), 1) for x, _, height in few],
        [Call(partial(summed, rho / unit, z / unit), len(at))],
        list(calls_over(light_force(ours).field, at, effort.timed)),
    ]
    (one, _), (batch, _), (quadrature, _) = per_item(calls, effort.rounds // 4 + 1)
    return {
        "us": 1e6 * one,
        "in_batches_us": 1e6 * batch,
        "largest_error": error,
        "quadrature_tolerance": tolerance,
        "quadrature_us": 1e6 * quadrature,
        "quadrature_largest_error": own,
        "numpy_over_quadrature": one / quadrature,
        "numpy_in_batches_over_quadrature": batch / quadrature,
    }


def _fatcuda(scene: Scene, effort: Effort) -> Results | None:
    """Error and time of fatcuda inside; None where it does not run."""
    if sys.version_info < (3, 12) or importlib.util.find_spec("fatcuda") is None:
        return None
    at = places(scene, BANDS["inside"], effort.summed)
    truth = _field(scene, at, TRUTH).force
    found = fatcuda_sum.force(scene, at)
    ((least, _),) = per_item([[Call(partial(fatcuda_sum.force, scene, at), len(at))]], 2)
    return {"us": 1e6 * least, "largest_error": _relative(found - truth, truth, scene)}


def _times(scene: Scene, at: Array, effort: Effort, *, gradient: bool = True) -> Results:
    """Time of a force, and of one with its gradient, us."""
    evaluate = {"us": light_force(scene).field}
    if gradient:
        evaluate["with_jacobian_us"] = partial(light_force(scene).field, gradient=True)
    calls = [list(calls_over(each, at, effort.timed)) for each in evaluate.values()]
    times = per_item(calls, effort.rounds)
    return {key: 1e6 * least for key, (least, _) in zip(evaluate, times, strict=True)}


def _errors(scene: Scene, at: Array) -> tuple[float, float]:
    """Largest error, and the least ratio of the estimated error to the true one."""
    field, truth = light_force(scene).field(at), _field(scene, at, TRUTH).force
    missed = _lengths(field.force - truth)
    ratio = field.error[missed > 0] / missed[missed > 0]
    return _relative(field.force - truth, truth, scene), float(ratio.min(initial=math.inf))


def _relative(missed: Array, truth: Array, scene: Scene) -> float:
    """Largest error, relative to the force or to `VANISHING` of the largest."""
    size = np.maximum(_lengths(truth), VANISHING * _largest_force(scene.replace(optics=_COARSE)))
    return float((_lengths(missed) / size).max())


@functools.cache
def _largest_force(scene: Scene) -> float:
    """On the bead anywhere, N, to some per cent."""
    radius, wavelength = scene.bead.radius, scene.beam.wavelength / scene.medium.refractive_index
    reach = max(1.5 * radius, wavelength)
    x, z = np.meshgrid(np.linspace(0, reach, 11), np.linspace(-reach, reach, 21))
    at = np.stack([x.ravel(), 0 * x.ravel(), z.ravel()], axis=1)
    return float(_lengths(light_force(scene).field(at).force).max())


def _field(scene: Scene, at: Array, tolerance: float) -> Wrench:
    return light_force(
        scene.replace(optics={"evaluator": "quadrature", "tolerance": tolerance})
    ).field(at)


def _lengths(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))
