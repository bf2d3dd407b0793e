"""Error against time of the optical force: grid, quadrature, map, and the sum written in NumPy; of
rays, and of waves.

All meet in one run, at the same places, in turns. The results are plain data for JSON; keys end in
their unit. Errors are differences to the quadrature of the same theory at a tolerance of 1e-13,
which the tests hold against an independent integral. They are relative to the force there, or to
1e-6 of the largest force where it is smaller.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

import tweezer
from tests.benchmarks import numpy_sum, waves
from tests.benchmarks.timing import Call, calls_over, in_fresh_process, machine, per_item
from tweezer.forces.force import Wrench
from tweezer.optics import grid, light_force
from tweezer.optics.rays.light import light_on_bead
from tweezer.optics.rays.ray_sum import Rays, ray_sum
from tweezer.scene import Scene

Array = NDArray[np.float64]
Results = dict[str, Any]
Sections = dict[str, dict[str, Any]]
Evaluate = Callable[[Array], Array]
Places = list[tuple[Scene, Array]]
"""scenes, and positions (n, 3) m from the focus in each"""

#: the scene of all places but the thesis's starting points
SCENE = "thesis-990nm"
THESIS = ("thesis-500nm", "thesis-990nm", "thesis-1950nm")
#: the light of a scene of rays as waves: its averaged reflectance is that of unpolarised light
WAVES: Sections = {
    "optics": {"theory": "waves", "evaluator": "quadrature"},
    "beam": {"polarisation": "unpolarised"},
}
#: what each way to the force changes in the scene
WAYS: dict[str, Sections] = {
    "grid": {"optics": {"evaluator": "grid"}},
    "quadrature": {"optics": {"evaluator": "quadrature"}},
    "map": {"optics": {"evaluator": "map"}},
    "waves": WAVES,
    "waves' map": {**WAVES, "optics": {**WAVES["optics"], "evaluator": "map"}},
}
#: kinds of places: distance from the focus, radii of the bead
BANDS = {"inside": (0.0, 0.9), "edge": (0.9, 1.1), "outside": (1.1, 3.0), "far": (3.0, 20.0)}
STARTS = "starts"
#: where the map holds; beyond, the quadrature takes over
MAPPED = ("inside", "edge", "outside")
#: tolerance of what errors are measured against
TRUTH = 1e-13
#: Rays in a row, whose data fits in the cache
_RAYS = 4096
#: How often a timed call goes through them
_PASSES = 16
#: part of the largest force below which errors are relative to it
VANISHING = 1e-6


class Effort(NamedTuple):
    """How much is measured."""

    places: int
    """of each kind"""
    timed: int
    """of those, how many are timed at least; more where a force takes less than `CALL`"""
    rounds: int
    processes: int
    """with warm caches, of which the fastest counts"""
    divisions: tuple[int, ...]
    tolerances: tuple[float, ...]
    table_tolerances: tuple[float, ...]


FULL = Effort(
    places=128, timed=16, rounds=10, processes=3,
    divisions=(25, 50, 100, 200, 400, 800, 1600),
    tolerances=tuple(float(f"1e-{k}") for k in range(2, 13)),
    table_tolerances=(1e-5, 1e-6, 1e-7, 1e-8),
)  # fmt: skip
QUICK = Effort(
    places=4, timed=2, rounds=2, processes=1,
    divisions=(25, 100), tolerances=(1e-2, 1e-8), table_tolerances=(1e-7,),
)  # fmt: skip


class Contestant(NamedTuple):
    """One way to the force."""

    family: str
    setting: dict[str, float]
    sections: dict[str, dict[str, Any]]
    """what it changes in a scene"""


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    effort = QUICK if quick else FULL
    results: Results = {"machine": machine(), "quick": quick, "scene": SCENE, "fresh_process": {}}
    for way in WAYS:
        say(f"first force in fresh processes: {way}")
        results["fresh_process"][way] = _fresh(way, effort)
    say("single calls from Python")
    results["single_python_call_us"] = _single_calls(effort)
    kinds = _kinds(effort)
    results["places"] = {}
    for kind, places in kinds.items():
        say(f"error against time: {kind}")
        results["places"][kind] = _compared(places, _contestants(kind, effort), effort)
    say("one ray")
    results["one_ray_ns"] = _one_ray(effort)
    say("place by place")
    exact = {"evaluator": "quadrature", "tolerance": 1e-8}
    results["quadrature_at_the_slowest_place_us"] = {
        kind: max(_place_by_place(places, exact, effort)) for kind, places in kinds.items()
    }
    at_starts = _place_by_place(kinds[STARTS], {"evaluator": "grid"}, effort)
    results["grid_at_thesis_start_us"] = dict(zip(THESIS, at_starts, strict=True))
    results["waves"] = waves.measure(quick=quick, say=say)
    results["headline"] = headline(results)
    rounded: Results = _to_four_digits(results)
    return rounded


def headline(results: Results) -> Results:
    """What the documentation quotes."""
    by_place: dict[str, Results] = {}
    for kind, entries in results["places"].items():
        by_numpy = _entry(entries["numpy"], divisions=100)
        by_grid = _entry(entries["grid"], divisions=100)
        quadrature = _entry(entries["quadrature"], tolerance=1e-8)
        by_waves = _entry(entries["waves"], tolerance=1e-8)
        by_place[kind] = {
            "quadrature_us": quadrature["us"],
            "quadrature_at_the_slowest_place_us": results["quadrature_at_the_slowest_place_us"][
                kind
            ],
            "quadrature_largest_error": quadrature["largest_error"],
            "numpy_us": by_numpy["us"],
            "numpy_over_quadrature": by_numpy["us"] / quadrature["us"],
            "grid_us": by_grid["us"],
            "grid_median_error": by_grid["median_error"],
            "grid_largest_error": by_grid["largest_error"],
            "waves_us": by_waves["us"],
            "waves_largest_error": by_waves["largest_error"],
        }
        if kind in MAPPED:
            by_map = _entry(entries["map"], tolerance=1e-7)
            by_place[kind] |= {
                "map_ns": 1e3 * by_map["us"],
                "map_with_jacobian_ns": 1e3 * by_map["with_jacobian_us"],
                "map_largest_error_over_largest_force": by_map["largest_error_over_largest_force"],
            }
            of_waves = _entry(entries["waves' map"], tolerance=1e-7)
            by_place[kind] |= {
                "waves_map_ns": 1e3 * of_waves["us"],
                "waves_map_with_jacobian_ns": 1e3 * of_waves["with_jacobian_us"],
                "waves_map_largest_error_over_largest_force": of_waves[
                    "largest_error_over_largest_force"
                ],
            }
    inside = _entry(results["places"]["inside"]["grid"], divisions=100)
    fresh = results["fresh_process"]
    return {
        "by_place": by_place,
        "grid_at_thesis_start_us": results["grid_at_thesis_start_us"],
        "ray_that_hits_ns": 1e3 * inside["us"] / inside["rays"],
        "map_made_s": fresh["map"]["empty_table_cache"]["bind_s"],
        "map_loaded_s": fresh["map"]["warm_caches"]["bind_s"],
        "first_force_s": {name: times["warm_caches"]["process_s"] for name, times in fresh.items()},
    }


def _entry(entries: list[Results], **setting: float) -> Results:
    (entry,) = (entry for entry in entries if setting.items() <= entry.items())
    return entry


def _kinds(effort: Effort) -> dict[str, Places]:
    """Places by kind: random ones that the light reaches, and the thesis's starting points."""
    scene = tweezer.load_scene(SCENE)
    rng = np.random.default_rng(20_240)
    kinds: dict[str, Places] = {
        kind: [(scene, _reached(scene, kind, effort.places, rng))] for kind in BANDS
    }
    kinds[STARTS] = [
        (start, np.array([start.start_position])) for start in map(tweezer.load_scene, THESIS)
    ]
    return kinds


def _reached(scene: Scene, kind: str, count: int, rng: np.random.Generator) -> Array:
    """Random places (count, 3) m where the light exerts a force.

    At the edge the distance to the surface is spread evenly in its logarithm, down to 1e-5 r;
    outside, the distance to the focus.
    """
    low, high = BANDS[kind]
    many = 20 * count
    directions = rng.normal(size=(many, 3))
    directions /= _lengths(directions)[:, None]
    if kind == "inside":
        distances = rng.uniform(low, high, many)
    elif kind == "edge":
        nearness = 10 ** rng.uniform(-5, math.log10(high - 1), many)
        distances = 1 + rng.choice([-1, 1], many) * nearness
    else:
        distances = low * (high / low) ** rng.random(many)
    positions = scene.bead.radius * distances[:, None] * directions
    reached = _field(scene, positions, tolerance=1e-6).force.any(axis=1)
    return positions[reached][:count]


def _contestants(kind: str, effort: Effort) -> Iterator[Contestant]:
    yield Contestant("numpy", {"divisions": 100}, {"beam": {"divisions": 100}})
    for divisions in effort.divisions:
        beam = {"divisions": divisions}
        yield Contestant("grid", beam, {"beam": beam, "optics": {"evaluator": "grid"}})
    for tolerance in effort.tolerances:
        optics = {"evaluator": "quadrature", "tolerance": tolerance}
        yield Contestant("quadrature", {"tolerance": tolerance}, {"optics": optics})
        yield Contestant("waves", {"tolerance": tolerance}, _as_waves(optics))
    for tolerance in effort.table_tolerances if kind in MAPPED else ():
        optics = {"evaluator": "map", "table_tolerance": tolerance}
        yield Contestant("map", {"tolerance": tolerance}, {"optics": optics})
        yield Contestant("waves' map", {"tolerance": tolerance}, _as_waves(optics))


def _as_waves(optics: dict[str, Any]) -> Sections:
    return {**WAVES, "optics": {**WAVES["optics"], **optics}}


def _ways(family: str, scene: Scene) -> dict[str, Evaluate]:
    """What is timed of a contestant, by the key of the time; "us" is the force (n, 3) N."""
    if family == "numpy":
        rays = numpy_sum.pupil(scene)
        return {"us": lambda places: np.array([numpy_sum.force(scene, rays, p) for p in places])}
    bound = light_force(scene)
    return {
        "us": lambda places: bound.field(places).force,
        "with_jacobian_us": lambda places: bound.field(places, gradient=True).force_gradient,
    }


def _compared(places: Places, contestants: Iterator[Contestant], effort: Effort) -> Results:
    """Errors, and times per position, of all contestants by family."""
    truths = {
        theory: [
            (_field(of, positions, tolerance=TRUTH).force, _largest_force(of))
            for of, positions in ((scene.replace(**sections), at) for scene, at in places)
        ]
        for theory, sections in (("rays", {}), ("waves", WAVES))
    }
    results: Results = {}
    calls: list[list[Call]] = []
    timed: list[tuple[Results, str]] = []
    for family, setting, sections in contestants:
        entry: Results = dict(setting)
        results.setdefault(family, []).append(entry)
        errors: list[float] = []
        over_largest: list[float] = []
        by_key: dict[str, list[Call]] = {}
        theory = "waves" if family.startswith("waves") else "rays"
        for (scene, positions), (truth, largest) in zip(places, truths[theory], strict=True):
            changed = scene.replace(**sections)
            if family == "grid":
                entry["rays"] = len(grid(changed.lens, changed.beam, changed.medium).powers)
            ways = _ways(family, changed)
            missed = _lengths(ways["us"](positions) - truth)
            errors += (missed / np.maximum(_lengths(truth), VANISHING * largest)).tolist()
            over_largest.append(float(missed.max()) / largest)
            for key, evaluate in ways.items():
                by_key.setdefault(key, []).extend(calls_over(evaluate, positions, effort.timed))
        entry["median_error"] = float(np.median(errors))
        entry["largest_error"] = max(errors)
        entry["largest_error_over_largest_force"] = max(over_largest)
        calls += by_key.values()
        timed += [(entry, key) for key in by_key]
    for (entry, key), (least, median) in zip(timed, per_item(calls, effort.rounds), strict=True):
        entry[key] = 1e6 * least
        entry[key.replace("us", "median_us")] = 1e6 * median
    return results


def _place_by_place(places: Places, optics: dict[str, Any], effort: Effort) -> list[float]:
    """Time of a force at each place, us."""
    calls = []
    for scene, positions in places:
        force = _ways(optics["evaluator"], scene.replace(optics=optics))["us"]
        calls += [list(calls_over(force, position[None], 1)) for position in positions]
    return [1e6 * least for least, _ in per_item(calls, effort.rounds)]


def _single_calls(effort: Effort) -> Results:
    """Time of one position a call, inside the trap, us."""
    scene = tweezer.load_scene(SCENE)
    place = np.array([0.3, -0.4, 0.2]) * scene.bead.radius
    calls: dict[tuple[str, str], Call] = {}
    for way, sections in WAYS.items():
        of = scene.replace(**sections)
        calls[way, "optical_force"] = Call(partial(tweezer.optical_force, of, place), 1)
        calls[way, "field"] = Call(partial(light_force(of).field, place[None]), 1)
    times = per_item([[call] for call in calls.values()], 30 * effort.rounds)
    results: Results = {}
    for (way, name), (least, _) in zip(calls, times, strict=True):
        results.setdefault(way, {})[name] = 1e6 * least
    return results


def _one_ray(effort: Effort) -> Results:
    """Time of a ray in a row that all hit, ns; and of its roots and divisions alone.

    Circular light on the bead of `SCENE`, by the function that the kernels sum rays with.
    """
    sphere = light_on_bead(tweezer.load_scene(SCENE)).sphere
    sine, azimuth = np.random.default_rng(7).random((2, _RAYS)) * [[0.8], [2 * np.pi]]
    u = [sine * np.cos(azimuth), sine * np.sin(azimuth), np.sqrt(1 - sine**2)]
    rays = np.array([*u, np.ones(_RAYS)])
    squares = np.square(sine)
    count = _PASSES * _RAYS
    calls = {"roots_and_divisions": [Call(partial(_roots_alone, squares, sphere.n_mP), count)]}
    for key, gradient in (("force", False), ("with_gradient", True)):
        kind = Rays("circular", denser_medium=False, gradient=gradient, moment=False)
        add_up = ray_sum(kind, by_grid=True, in_rings=False)
        calls[key] = [Call(partial(_summed, add_up, rays, sphere.n_mP, np.zeros(24)), count)]
    times = per_item(list(calls.values()), 10 * effort.rounds)
    return {key: 1e9 * least for key, (least, _) in zip(calls, times, strict=True)}


@numba.njit(error_model="numpy")
def _summed(add_up, rays, n_mP, found):  # type: ignore[no-untyped-def]
    count = rays.shape[1]
    for _ in range(_PASSES):
        add_up(rays, 0, count, 0.3, -0.4, 0.2, 1.0, n_mP, (0.0, 0.0, 0.0, 0.0), found)


@numba.njit(error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"})
def _roots_alone(squares, n_mP):  # type: ignore[no-untyped-def]
    total = 0.0
    for k in range(_PASSES):
        for i in range(squares.size):
            S = squares[i]
            cos_alpha, cos_beta = math.sqrt(1.0 - S), math.sqrt(1.0 - n_mP * n_mP * S)
            total += 1.0 / (cos_alpha + n_mP * cos_beta) + 1.0 / (cos_beta + k)
    return total


_FIRST_FORCE = """
import json, time
start = time.perf_counter()
import numpy as np
import tweezer
from tweezer.optics import light_force
scene = tweezer.load_scene("{scene}").replace(**{sections})
positions = np.array([[0.3, -0.4, 0.2]]) * scene.bead.radius
imported = time.perf_counter()
bound = light_force(scene)
ready = time.perf_counter()
bound.field(positions)
first = time.perf_counter()
print(json.dumps({{
    "import_s": imported - start, "bind_s": ready - imported, "first_call_s": first - ready,
    "at": time.time(),
}}))
"""


def _fresh(way: str, effort: Effort) -> Results:
    """Import, bind, first call, and the whole process until then, in processes of their own.

    For a map with the cache of tables empty; and with it, and that of compiled code, warm.
    """
    program = _FIRST_FORCE.format(scene=SCENE, sections=WAYS[way])
    results: Results = {}
    with tempfile.TemporaryDirectory() as folder:
        cache = {"XDG_CACHE_HOME": folder}
        if "map" in way:
            results["empty_table_cache"] = in_fresh_process(program, cache)
        warm = [in_fresh_process(program, cache) for _ in range(effort.processes)]
    results["warm_caches"] = {key: min(times[key] for times in warm) for key in warm[0]}
    return results


def _field(scene: Scene, positions: Array, *, tolerance: float) -> Wrench:
    exact = scene.replace(optics={"evaluator": "quadrature", "tolerance": tolerance})
    return light_force(exact).field(positions)


def _largest_force(scene: Scene) -> float:
    """On the bead anywhere, N, to some per cent: it is largest near the edge."""
    x, z = np.meshgrid(np.linspace(0, 1.5, 31), np.linspace(-1.5, 1.5, 61))
    places = scene.bead.radius * np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)
    return float(_lengths(_field(scene, places, tolerance=1e-6).force).max())


def _to_four_digits(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.4g}")
    if isinstance(value, dict):
        return {key: _to_four_digits(entry) for key, entry in value.items()}
    return [_to_four_digits(entry) for entry in value] if isinstance(value, list) else value


def _lengths(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))
