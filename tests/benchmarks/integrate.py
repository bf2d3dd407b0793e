"""Error against time of the integration: our methods, other solvers, and the thesis's scaling.

All integrate the same scenes with the same compiled force: the thesis's three beads from rest to
rest, by rays and by waves, by map and place by place; a bead that is turned, one in two traps, one
in a moving trap, the time of an event, and a well of closed form. Others get the force by address
(`peers`), at its own cost, and as a user hands it over, through Python. Errors are the largest
distances to the unscaled motion, at times before the bead is within two radii of the focus, and
after. The unscaled motion is known from two independent solvers, whose distance is told. Times are
of the steps alone, from a solver that is set up to the last state, the least of up to 60 runs, the
contestants in turn; compiling and output are not in them. The user's baseline is timed through
`solve_ivp`. The results are plain data for JSON.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import tweezer
from tests.benchmarks import estimate, numpy_sum, peers
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine
from tests.reference.fields import GaussianWell, in_field
from tweezer.dynamics import EquationsOfMotion, Event, bind, integrators
from tweezer.dynamics.integrate import SciPySolver, integrate
from tweezer.dynamics.integrators.modes import NODES
from tweezer.dynamics.solution import Solver
from tweezer.scene import Scene
from tweezer.scene.choices import METHODS
from tweezer.thesis.runs import in_the_light

Array = NDArray[np.float64]
Results = dict[str, Any]

#: how far a table of the force must reach, radii, and until the bead is at rest by rays and waves
SCENES = {
    "thesis-500nm": (13.0, {"rays": "11 ms", "waves": "13 ms"}),
    "thesis-990nm": (11.0, {"rays": "7.5 ms", "waves": "5 ms"}),
    "thesis-1950nm": (10.0, {"rays": "45 ms", "waves": "26 ms"}),
}
BEAD = "thesis-990nm"
WELL, TURNED, ENTRY = "gaussian-well", f"{BEAD} with moment", f"{BEAD}, time of entry"
#: with light that is not one beam at rest, as they are shipped
OTHERS = ("two-traps", "moving-trap")
#: how far a table must reach there, radii
_REACH = 8.0
#: stiffness N/m, width m, start m and time of the well
_WELL = (2e-5, 2.5e-7, (4e-7, 0.0, 3e-7), "3 ms")
#: force calls from which a method is left out
MOST_CALLS = 400_000
#: times at which errors are taken
SAMPLES = 2001
TRUTH = 1e-13
#: error of what the headline compares, um during capture and before
HEADLINE = (2e-6, 2e-8)
#: Most runs of a contestant, and the time for them, s
_RUNS, _BUDGET = 60, 0.25

OURS = (("full", "exponential"), ("first-order", "dop853"), ("first-order", "dormand-prince"),
        ("overdamped", "dop853"))  # fmt: skip
#: Solvers by address, and tolerances
BY_ADDRESS = {
    "odeint": (1e-8, 1e-10, 1e-11, 1e-12), "LSODA": (1e-8, 1e-10, 1e-11, 1e-12),
    "CVODE": (1e-8, 1e-10, 1e-11, 1e-12), "Radau": (1e-6, 1e-7, 1e-8),
}  # fmt: skip
#: those through Python
THROUGH_PYTHON = {"scipy:LSODA": (1e-8, 1e-10, 1e-11, 1e-12), "scipy:Radau": (1e-6, 1e-7, 1e-8)}
EXPLICIT = ("dormand-prince", "dop853")
DIFFRAX = (1e-4, 1e-6, 1e-7, 1e-8)


@dataclass(frozen=True)
class Motion:
    """A scene to integrate, with what gives its force, and its true motion."""

    label: str
    name: str
    evaluator: str
    scene: Scene
    times: Array
    truth: Array
    orientation: Array | None
    """(n, 4), true, of a bead that is turned"""
    near: NDArray[np.bool_]
    """(n,) whether the bead is in the trap"""
    agreement: float
    """um, largest distance of the two solvers"""

    def bound(self, **simulation: Any) -> EquationsOfMotion:
        """Its equations of motion, changed."""
        return _bound(self.name, self.scene.replace(simulation=simulation))


class Followed(NamedTuple):
    """What a contestant found."""

    status: str
    position: Array
    orientation: Array | None
    force_calls: int
    steps: int


class Contestant(NamedTuple):
    """A way to follow a motion."""

    what: Results
    follow: Callable[[], Followed]
    """positions at the times of the motion"""
    seconds: Callable[[], float]
    """takes the steps alone, and their time"""


def _bound(name: str, scene: Scene) -> EquationsOfMotion:
    equations = bind(scene)
    if name == WELL:
        return in_field(equations, GaussianWell(*_WELL[:2]))
    return equations


def _scene(name: str, theory: str, evaluator: str) -> Scene:
    """Without the thesis's approximations, from rest to rest."""
    if name in OTHERS:
        return tweezer.load_scene(name).replace(
            optics={"theory": theory, "evaluator": evaluator, "table_range": _REACH}
        )
    bead = name if name in SCENES else BEAD
    base = tweezer.load_scene(bead)
    if name == WELL:
        return base.replace(
            start={"frame": "focus", "position": list(_WELL[2])},
            forces={"gravity": False, "buoyancy": False}, simulation={"duration": _WELL[3]},
        )  # fmt: skip
    reach, durations = SCENES[bead]
    scene = in_the_light(base, theory).replace(
        optics={"evaluator": evaluator, "table_range": reach, "tolerance": 1e-10},
        simulation={"duration": durations[theory]},
    )
    return scene.replace(beam={"torque": "thesis"}) if name == TURNED else scene


def _motion(name: str, theory: str, evaluator: str) -> Motion:
    scene = _scene(name, theory, evaluator)
    scene = scene.replace(simulation={"most_force_calls": MOST_CALLS, "model": "full"})
    times = np.linspace(0, scene.simulation.duration, SAMPLES)
    tight = _tolerances(TRUTH)
    equations = _bound(name, scene.replace(simulation={"method": "exponential", **tight}))
    run = integrate(equations, times)
    if run.status != "complete":
        raise RuntimeError(run.message)
    exact = equations.motion(times, run.states)
    other = peers.states("LSODA", peers.Direct(equations), equations, times)
    apart = _far(equations.motion(times, other).position, exact.position)
    near = np.linalg.norm(exact.position, axis=1) < 2 * scene.bead.radius
    near = np.arange(SAMPLES) >= (near.argmax() if near.any() else SAMPLES)
    label = name if name == WELL else f"{name}, {theory}, {evaluator}"
    return Motion(
        label, name, evaluator, scene, times, exact.position, exact.orientation, near,
        1e6 * float(apart.max()),
    )  # fmt: skip


def _tolerances(tolerance: float) -> Results:
    return {
        "relative_tolerance": tolerance, "position_tolerance": max(1e-6 * tolerance, 1e-18),
        "orientation_tolerance": tolerance,
    }  # fmt: skip


def _far(a: Array, b: Array) -> Array:
    return np.asarray(np.linalg.norm(a - b, axis=1))


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    results: Results = {"machine": machine(), "quick": quick, "motions": {}, "left_out": []}
    with warnings.catch_warnings(action="ignore"):
        for name, theory, evaluator in _motions(quick):
            say(f"reference: {name}, {theory}, {evaluator}")
            motion = _motion(name, theory, evaluator)
            _compete(motion, motion.label, _contestants(motion, quick), quick, say, results)
            found = results["motions"][motion.label]
            found["solvers_agree_to_um"] = motion.agreement
            if name in SCENES and evaluator == "map":
                found["least_force_calls"] = least_force_calls(motion)
            if (name, theory, evaluator) == (BEAD, "rays", "map"):
                _compete(motion, ENTRY, _of_entry(motion, quick), quick, say, results)
        results["missing"] = peers.missing()
        results["headline"] = headline(results)
        results["estimate"] = estimate.measure(estimate.QUICK if quick else estimate.SCENES, say)
        del results["estimate"]["entries"]
    rounded: Results = _to_four_digits(results)
    return rounded


def _motions(quick: bool) -> Iterator[tuple[str, str, str]]:
    if quick:
        yield from ((BEAD, "rays", "map"), (WELL, "rays", "map"))
        return
    for evaluator in ("map", "quadrature"):
        for theory in ("rays", "waves"):
            for name in SCENES:
                yield name, theory, evaluator
    yield TURNED, "rays", "map"
    for name in OTHERS:
        yield name, "waves", "map"
    yield WELL, "rays", "map"


def _compete(
    motion: Motion, label: str, contestants: Iterator[Contestant], quick: bool,
    say: Callable[[str], object], results: Results,
) -> None:  # fmt: skip
    """Errors of all, then their times in turn."""
    entries: list[Results] = []
    timed: list[tuple[Contestant, int]] = []
    for each in contestants:
        say(f"{label}: {each.what['model']} {each.what['method']}")
        began = time.perf_counter()
        found = each.follow()
        took = time.perf_counter() - began
        if found.status != "complete":
            why = f"more than {MOST_CALLS} force calls, or {found.status}"
            results["left_out"].append({"motion": label, **each.what, "left_out": why})
            continue
        entries.append(each.what | _errors(motion, found))
        # twice at least: it may have been compiled
        timed.append((each, 2 if quick else min(int(_BUDGET / took) + 2, _RUNS)))
    seconds = [np.inf] * len(timed)
    for turn in range(_RUNS):
        for i, (each, runs) in enumerate(timed):
            if turn < runs:
                seconds[i] = min(seconds[i], each.seconds())
    for entry, least in zip(entries, seconds, strict=True):
        entry["ms"] = 1e3 * least
    results["motions"][label] = {"entries": entries}


def _errors(motion: Motion, found: Followed) -> Results:
    off = 1e6 * _far(found.position, motion.truth)
    errors: Results = {
        "before_um": float(np.nanmax(off[~motion.near], initial=0.0)),
        "during_um": float(np.nanmax(off[motion.near], initial=0.0)),
        "force_calls": found.force_calls,
        "steps": found.steps,
    }
    if found.orientation is not None and motion.orientation is not None:
        sign = np.sign(np.sum(found.orientation * motion.orientation, axis=1))[:, None]
        errors["turned_rad"] = 2 * float(_far(sign * found.orientation, motion.orientation).max())
    return errors


def _contestants(motion: Motion, quick: bool) -> Iterator[Contestant]:
    few = [1e-6, 1e-9] if quick else [float(f"1e-{k}") for k in range(4, 13)]
    for tolerance in few if quick else np.geomspace(1e-3, 1e-12, 19):
        yield _ours(motion, "full", "exponential", float(tolerance))
    for method, tolerances in BY_ADDRESS.items():
        if method == "Radau" and (quick or motion.name in (TURNED, *OTHERS)):
            continue
        for tolerance in tolerances[1:2] if quick else tolerances:
            yield from _by_address(motion, method, tolerance)
    if motion.name == BEAD and motion.label.endswith("rays, map") and not quick:
        for tolerance in DIFFRAX:
            yield from _by_address(motion, "diffrax", tolerance)
    if (motion.name != WELL and not motion.label.endswith("rays, map")) or motion.name == TURNED:
        return
    for model, method in OURS[1:]:
        for tolerance in few:
            yield _ours(motion, model, method, tolerance)
    for method in EXPLICIT if not quick else ():
        yield _ours(motion, "full", method, 1e-6)
    for method, tolerances in THROUGH_PYTHON.items():
        for tolerance in tolerances[1:2] if quick else tolerances:
            yield _ours(motion, "full", method, tolerance)
    tau = tweezer.bead_properties(motion.scene).relaxation_time
    for factor in [0.01] if quick else np.geomspace(tau / 1e-3, 1.0, 7):
        yield _ours(motion, "scaled", "dormand-prince", 1e-7, scaling_factor=float(factor))
    if motion.name == WELL:
        for tolerance in [1e-6] if quick else [1e-4, 1e-6, 1e-8, 1e-10]:
            yield from _heyoka(motion, tolerance)
    else:
        yield _baseline(motion, quick)


def _what(model: str, method: str, tolerance: float) -> Results:
    return {"model": model, "method": method, "tolerance": tolerance}


def _ours(motion: Motion, model: str, method: str, tolerance: float, **changes: Any) -> Contestant:
    """A method of ours, or of SciPy's with our equations."""
    equations = motion.bound(model=model, method=method, **_tolerances(tolerance), **changes)
    end = float(motion.times[-1])

    def follow() -> Followed:
        done = integrate(equations, motion.times)
        found = equations.motion(done.times, done.states)
        return Followed(
            done.status, found.position, found.orientation, done.force_calls, done.steps
        )

    def seconds() -> float:
        scipys = METHODS[method].solver
        solver = (
            SciPySolver(equations, method, end) if scipys else Solver(equations, method, end=end)
        )
        began = time.perf_counter()
        why = integrators.FULL
        while why == integrators.FULL:
            _, why = solver.advance()
        return time.perf_counter() - began

    return Contestant(_what(model, method, tolerance) | changes, follow, seconds)


def _by_address(motion: Motion, method: str, tolerance: float) -> Iterator[Contestant]:
    """Another solver that calls the compiled force by its address; none if it is not installed."""
    if method in peers.missing():
        return
    equations = motion.bound(model="full", **_tolerances(tolerance))
    direct = peers.Direct(equations)

    def follow() -> Followed:
        direct.calls = 0
        states = peers.states(method, direct, equations, motion.times)
        found = equations.motion(motion.times, states)
        return Followed("complete", found.position, found.orientation, direct.calls, 0)

    ends = motion.times[[0, -1]]

    def seconds() -> float:
        return peers.seconds(method, direct, equations, ends)

    yield Contestant(_what("full", method, tolerance), follow, seconds)


def _baseline(motion: Motion, quick: bool) -> Contestant:
    """What a user has today: the sum in NumPy under SciPy's RK45, with the thesis's scaling."""
    bead = tweezer.bead_properties(motion.scene)
    given = tweezer.load_scene(motion.name)
    factor = given.simulation.scaling_factor or 1.0
    rays = numpy_sum.pupil(given)
    times = motion.times[: len(motion.times) // (50 if quick else 1)]
    done: Results = {}

    def rates(_: float, y: Array) -> Array:
        force = numpy_sum.force(given, rays, y[:3]) + bead.weight
        return np.concatenate([y[3:], factor * (force - bead.drag * y[3:]) / bead.mass])

    def follow() -> Followed:  # once: it takes seconds
        if not done:
            began = time.perf_counter()
            run = solve_ivp(
                rates, (0, times[-1]), [*motion.scene.start_position, 0, 0, 0], "RK45", times,
                rtol=1e-7, atol=[1e-11] * 3 + [1e-8] * 3,
            )  # fmt: skip
            done.update(took=time.perf_counter() - began, run=run)
        padded = np.full((len(motion.times), 3), np.nan)
        padded[: len(times)] = done["run"].y[:3].T
        return Followed("complete", padded, None, done["run"].nfev, 0)

    return Contestant(_what("scaled", "numpy", 1e-7), follow, lambda: float(done["took"]))


def _heyoka(motion: Motion, tolerance: float) -> Iterator[Contestant]:
    """Taylor's method on the well, which has a closed form; none if it is not installed."""
    if "heyoka" in peers.missing():
        return
    import heyoka as hy

    bead = tweezer.bead_properties(motion.scene)
    stiffness, width = _WELL[:2]
    # in um and tau: its variables should be of order 1
    tau = bead.relaxation_time
    q, v = hy.make_vars("x", "y", "z"), hy.make_vars("u", "v", "w")
    squared = sum((x**2 for x in q), hy.expression(0.0))
    pull = stiffness * tau / bead.drag * hy.exp(-squared / (2 * (1e6 * width) ** 2))
    system = [(x, u) for x, u in zip(q, v, strict=True)]
    system += [(u, -pull * x - u) for x, u in zip(q, v, strict=True)]
    start = [1e6 * x for x in motion.scene.start_position] + [0.0] * 3
    integrator = hy.taylor_adaptive(system, start, tol=tolerance)

    def again() -> None:
        integrator.time = 0.0
        integrator.state[:] = start

    def follow() -> Followed:
        again()
        *_, steps, _, states = integrator.propagate_grid(motion.times / tau)
        return Followed("complete", 1e-6 * states[:, :3], None, 0, steps)

    def seconds() -> float:
        again()
        began = time.perf_counter()
        integrator.propagate_until(motion.times[-1] / tau)
        return time.perf_counter() - began

    yield Contestant(_what("full", "heyoka", tolerance), follow, seconds)


def _of_entry(motion: Motion, quick: bool) -> Iterator[Contestant]:
    """The time at which the bead comes within two radii, by each solver's events.

    Their errors are distances: those of the time, by the speed there. A whole run is timed.
    """
    exactly = motion.bound(model="full", method="exponential", **_tolerances(TRUTH))
    edge = 2 * motion.scene.bead.radius
    end = float(motion.times[-1])
    speed = 0.0

    def ours(equations: EquationsOfMotion) -> tuple[float, int]:
        event = Event("entry", lambda _, y: np.linalg.norm(y[:, :3], axis=1) - edge, -1)
        run = integrate(equations, motion.times[[0, -1]], [event])
        return run.events[0].time, run.force_calls

    truth, _ = ours(exactly)
    path = integrate(exactly, motion.times).path
    assert path is not None
    speed = float(path.speeds(np.array([truth]))[0])

    def contestant(what: Results, find: Callable[[], tuple[float, int]]) -> Contestant:
        def follow() -> Followed:
            at, calls = find()
            # the whole error in the trap, none before
            position = motion.truth.copy()
            position[motion.near, 0] += speed * (at - truth)
            return Followed("complete", position, motion.orientation, calls, 0)

        def seconds() -> float:
            began = time.perf_counter()
            find()
            return time.perf_counter() - began

        return Contestant(what, follow, seconds)

    for tolerance in [1e-6] if quick else [float(f"1e-{k}") for k in range(4, 13)]:
        equations = motion.bound(model="full", method="exponential", **_tolerances(tolerance))
        yield contestant(
            _what("full", "exponential", tolerance), lambda equations=equations: ours(equations)
        )
    for method in ("LSODA", "CVODE"):
        if method in peers.missing():
            continue
        for tolerance in BY_ADDRESS[method][:1] if quick else BY_ADDRESS[method]:
            equations = motion.bound(model="full", **_tolerances(tolerance))
            direct = peers.Direct(equations)

            def find(
                method: str = method, direct: Any = direct, equations: Any = equations
            ) -> tuple[float, int]:
                direct.calls = 0
                return peers.entry(method, direct, equations, end, edge), direct.calls

            yield contestant(_what("full", method, tolerance), find)


def least_force_calls(motion: Motion) -> int:
    """Force calls of the fewest polynomials that hold the true motion to the headline's errors.

    Along the true path u = (F + W)/beta is a function of time. From the release on, each piece is
    as long as a polynomial of degree NODES - 1 holds it: the place that it leads to, the integral,
    is off by no more than is allowed there. A displacement at a time t is carried along the path
    as the speed, so allowed is the least over later times t' of the headline's error at t' times
    |v(t)/v(t')|, shared by all pieces. A method that knew each polynomial from one call at its
    nodes would take NODES.
    """
    equations = motion.bound(model="full", method="exponential", **_tolerances(1e-12))
    path = integrate(equations, motion.times).path
    assert path is not None
    speed = path.speeds(motion.times)
    errors = 1e-6 * np.where(motion.near, *HEADLINE)
    # what moves more slowly than this has come to rest
    moving = np.maximum(speed, 1e-9 * speed.max())
    later = np.minimum.accumulate((errors / moving)[::-1])[::-1]
    allowed = np.minimum(errors, later * moving)
    bead, end = equations.bead, float(motion.times[-1])
    points, weights = legendre.leggauss(4 * NODES)
    values = legendre.legvander(points, NODES - 1)
    onto = (values * weights[:, None]).T * (np.arange(NODES)[:, None] + 0.5)
    polynomials = legendre.legvander(points, len(points) - 1)
    to_all = (polynomials * weights[:, None]).T * (np.arange(len(points))[:, None] + 0.5)

    def held(begin: float, length: float, share: int) -> bool:
        times = begin + 0.5 * (points + 1) * length
        force = equations.force.field(path.positions(times), time=times).force
        u = (force + bead.weight) / bead.drag
        rest = to_all @ (u - values @ (onto @ u))
        off = [legendre.legval(points, legendre.legint(each, lbnd=-1)) for each in rest.T]
        least = np.interp(times, motion.times, allowed).min()
        return bool(0.5 * length * np.linalg.norm(off, axis=0).max() <= least / share)

    def pieces(share: int) -> int:
        begin, count, length = 0.0, 0, end
        while begin < end * (1 - 1e-9):
            low, high = 0.0, min(4 * length, end - begin)
            if held(begin, high, share):
                low = high
            while high - low > 2e-2 * high:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if held(begin, middle, share) else (low, middle)
            begin, count, length = begin + low, count + 1, low
        return count

    share = 1
    while (count := pieces(share)) > share:
        share = count
    return NODES * count


def headline(results: Results) -> Results:
    """What the documentation quotes, by motion."""
    told: Results = {}
    for label, of in results["motions"].items():
        entries = of["entries"]
        told[label] = {key: value for key, value in of.items() if key != "entries"}
        for model, method in OURS[:2]:
            told[label][model] = _cheapest(entries, model, method)
        ours = [e for e in entries if (e["model"], e["method"]) == OURS[0]]
        for other in (*BY_ADDRESS, "diffrax", *THROUGH_PYTHON, "numpy", "heyoka"):
            theirs = [e for e in entries if e["method"] == other]
            ratios = [
                e["ms"] / min(mine["ms"] for mine in ours if _no_worse(mine, e))
                for e in theirs
                if any(_no_worse(mine, e) for mine in ours)
            ]
            if not ratios:
                continue
            best = _cheapest(entries, theirs[0]["model"], other)
            mine = told[label]["full"]
            told[label][other] = {
                "at_headline_ms": best and best["ms"],
                "times_slower": best and mine and best["ms"] / mine["ms"],
                "least_times_slower": min(ratios), "most_times_slower": max(ratios),
            }  # fmt: skip
            if other == "numpy":
                (entry,) = theirs
                fastest = min(
                    (each for each in ours if _no_worse(each, entry)), key=lambda each: each["ms"]
                )
                told[label][other] |= {
                    "ms": entry["ms"], "error_um": entry["during_um"],
                    "ours_ms": fastest["ms"], "our_error_um": fastest["during_um"],
                }  # fmt: skip
    return told


def _no_worse(one: Results, other: Results) -> bool:
    return bool(one["during_um"] <= other["during_um"] and one["before_um"] <= other["before_um"])


def _cheapest(entries: list[Results], model: str, method: str) -> Results | None:
    """The fastest run within the headline's errors."""
    good = (
        e for e in entries
        if (e["model"], e["method"]) == (model, method)
        and e["during_um"] <= HEADLINE[0] and e["before_um"] <= HEADLINE[1]
    )  # fmt: skip
    return min(good, key=lambda e: e["ms"], default=None)
