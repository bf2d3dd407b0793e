"""Error against time of the integration: our methods, SciPy's, heyoka, and the thesis's scaling.

All integrate the same scenes with the same compiled force, released from rest, until the bead is at
rest in the trap. Errors are the largest distances to the unscaled motion, at times before the bead
is within two radii of the focus, and after. The unscaled motion is known from two independent
solvers, whose distance is told. Times are of the steps alone, from a solver that is set up to the
last state, the least of up to 60 runs; compiling and output are not in them. The user's baseline is
timed through `solve_ivp`. The results are plain data for JSON.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import tweezer
from tests.benchmarks import numpy_sum
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine
from tests.reference.fields import GaussianWell, in_field
from tweezer.choices import METHODS
from tweezer.dynamics import EquationsOfMotion, bind, integrators
from tweezer.dynamics.integrate import SciPySolver, integrate
from tweezer.dynamics.solution import Solver
from tweezer.scene import Scene

Array = NDArray[np.float64]
Results = dict[str, Any]

#: until the bead is at rest, and how far a table of the force must reach, radii
SCENES = {
    "thesis-500nm": ("11 ms", 13.0),
    "thesis-990nm": ("7.5 ms", 11.0),
    "thesis-1950nm": ("45 ms", 10.0),
}
WELL = "gaussian-well"
#: stiffness N/m, width m, start m and time of the well
_WELL = (2e-5, 2.5e-7, (4e-7, 0.0, 3e-7), "3 ms")
#: force calls from which a method is left out
MOST_CALLS = 400_000
#: times at which errors are taken
SAMPLES = 2001
TRUTH = 1e-13
#: error of what the headline compares, um during capture and before
HEADLINE = (2e-6, 2e-8)

OURS = (("full", "exponential"), ("first-order", "dop853"), ("first-order", "dormand-prince"),
        ("overdamped", "dop853"))  # fmt: skip
IMPLICIT = ("scipy:LSODA", "scipy:Radau", "scipy:BDF")
EXPLICIT = ("dormand-prince", "dop853", "scipy:RK45", "scipy:DOP853")


@dataclass(frozen=True)
class Motion:
    """A scene to integrate, with what gives its force, and its true motion."""

    name: str
    scene: Scene
    times: Array
    truth: Array
    near: NDArray[np.bool_]
    """(n,) whether the bead is in the trap"""
    agreement: float
    """um, largest distance of the two solvers"""

    def bound(self, **simulation: Any) -> EquationsOfMotion:
        """Its equations of motion, changed."""
        return _bound(self.name, self.scene.replace(simulation=simulation))


def _bound(name: str, scene: Scene) -> EquationsOfMotion:
    equations = bind(scene)
    if name == WELL:
        return in_field(equations, GaussianWell(*_WELL[:2]))
    return equations


def _motion(name: str, evaluator: str) -> Motion:
    base = tweezer.load_scene("thesis-990nm" if name == WELL else name)
    if name == WELL:
        duration = _WELL[3]
        scene = base.replace(
            start={"frame": "focus", "position": list(_WELL[2])},
            forces={"gravity": False, "buoyancy": False}, simulation={"duration": duration},
        )  # fmt: skip
    else:
        duration, reach = SCENES[name]
        scene = base.replace(
            optics={"evaluator": evaluator, "table_range": reach, "tolerance": 1e-10},
            simulation={"duration": duration},
        )
    scene = scene.replace(simulation={"most_force_calls": MOST_CALLS})
    times = np.linspace(0, scene.simulation.duration, SAMPLES)
    exact = _positions(_bound(name, scene.replace(simulation=_exactly("exponential"))), times)
    other = _positions(_bound(name, scene.replace(simulation=_exactly("scipy:LSODA"))), times)
    near = np.linalg.norm(exact, axis=1) < 2 * scene.bead.radius
    near = np.arange(SAMPLES) >= (near.argmax() if near.any() else SAMPLES)
    return Motion(name, scene, times, exact, near, 1e6 * float(_far(exact, other).max()))


def _exactly(method: str) -> Results:
    return {"model": "full", "method": method, **_tolerances(TRUTH)}


def _tolerances(tolerance: float) -> Results:
    return {"relative_tolerance": tolerance, "position_tolerance": max(1e-6 * tolerance, 1e-18)}


def _far(a: Array, b: Array) -> Array:
    return np.asarray(np.linalg.norm(a - b, axis=1))


def _positions(equations: EquationsOfMotion, times: Array) -> Array:
    run = integrate(equations, times)
    if run.status != "complete":
        raise RuntimeError(run.message)
    return equations.motion(run.times, run.states).position


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    results: Results = {"machine": machine(), "quick": quick, "motions": {}, "left_out": []}
    for name in ["thesis-990nm", WELL] if quick else [*SCENES, WELL]:
        for evaluator in ("map",) if name == WELL or quick else ("map", "quadrature"):
            label = name if name == WELL else f"{name}, {evaluator}"
            say(f"reference: {label}")
            motion = _motion(name, evaluator)
            entries: list[Results] = []
            for what, run in _contestants(motion, evaluator, quick):
                say(f"{label}: {what['model']} {what['method']}")
                entries.append(what | _entry(motion, run, quick))
                if "left_out" in entries[-1]:
                    results["left_out"].append({"motion": label, **entries.pop()})
            results["motions"][label] = {
                "solvers_agree_to_um": motion.agreement,
                "entries": entries,
            }
    results["headline"] = headline(results)
    rounded: Results = _to_four_digits(results)
    return rounded


def _contestants(motion: Motion, evaluator: str, quick: bool) -> Iterator[tuple[Results, Any]]:
    few = [1e-6, 1e-9] if quick else [float(f"1e-{k}") for k in range(4, 13)]
    fewer = [1e-6] if quick else [1e-4, 1e-6, 1e-8, 1e-10]
    for model, method in OURS:
        for tolerance in few:
            yield _what(model, method, tolerance), _run(motion, model, method, tolerance)
    if evaluator == "quadrature":
        return
    for method in EXPLICIT if not quick else ():
        yield _what("full", method, 1e-6), _run(motion, "full", method, 1e-6)
    for method in IMPLICIT[:1] if quick else IMPLICIT:
        for tolerance in fewer:
            yield _what("full", method, tolerance), _run(motion, "full", method, tolerance)
    tau = tweezer.bead_properties(motion.scene).relaxation_time
    for factor in [0.01] if quick else np.geomspace(tau / 1e-3, 1.0, 7):
        what = _what("scaled", "dormand-prince", 1e-7) | {"scaling_factor": float(factor)}
        yield what, _run(motion, "scaled", "dormand-prince", 1e-7, scaling_factor=float(factor))
    if motion.name == WELL:
        for tolerance in fewer:
            yield _what("full", "heyoka", tolerance), _heyoka(motion, tolerance)
    else:
        yield _what("scaled", "numpy", 1e-7), _baseline(motion, quick)


def _what(model: str, method: str, tolerance: float) -> Results:
    return {"model": model, "method": method, "tolerance": tolerance}


# A contestant gives its positions, force calls and steps; what it is timed on is its second call


def _run(motion: Motion, model: str, method: str, tolerance: float, **changes: Any) -> Any:
    """A method of ours, or of SciPy's with our equations."""

    def run(timed: bool) -> Any:
        equations = motion.bound(model=model, method=method, **_tolerances(tolerance), **changes)
        if not timed:
            done = integrate(equations, motion.times)
            positions = equations.motion(done.times, done.states).position
            return done.status, positions, done.force_calls, done.steps
        end = float(motion.times[-1])
        scipys = METHODS[method].solver
        solver = (
            SciPySolver(equations, method, end) if scipys else Solver(equations, method, end=end)
        )
        began = time.perf_counter()
        why = integrators.FULL
        while why == integrators.FULL:
            _, why = solver.advance()
        return time.perf_counter() - began

    return run


def _baseline(motion: Motion, quick: bool) -> Any:
    """What a user has today: the sum in NumPy under SciPy's RK45, with the thesis's scaling."""
    bead = tweezer.bead_properties(motion.scene)
    factor = motion.scene.simulation.scaling_factor or 1.0
    rays = numpy_sum.pupil(motion.scene)
    calls = [0]

    def rates(_: float, y: Array) -> Array:
        calls[0] += 1
        force = numpy_sum.force(motion.scene, rays, y[:3]) + bead.weight
        return np.concatenate([y[3:], factor * (force - bead.drag * y[3:]) / bead.mass])

    def run(timed: bool) -> Any:
        calls[0] = 0
        times = motion.times[: len(motion.times) // (50 if quick else 1)]
        began = time.perf_counter()
        done = solve_ivp(
            rates, (0, times[-1]), [*motion.scene.start_position, 0, 0, 0], "RK45",
            None if timed else times, rtol=1e-7, atol=[1e-11] * 3 + [1e-8] * 3,
        )  # fmt: skip
        if timed:
            return time.perf_counter() - began
        padded = np.full((len(motion.times), 3), np.nan)
        padded[: len(times)] = done.y[:3].T
        return "complete", padded, calls[0], 0

    return run


def _heyoka(motion: Motion, tolerance: float) -> Any:
    """Taylor's method on the well, which has a closed form."""
    try:
        import heyoka as hy
    except ImportError:
        return None
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

    def run(timed: bool) -> Any:
        integrator.time = 0.0
        integrator.state[:] = start
        began = time.perf_counter()
        if timed:
            integrator.propagate_until(motion.times[-1] / tau)
            return time.perf_counter() - began
        *_, steps, _, states = integrator.propagate_grid(motion.times / tau)
        return "complete", 1e-6 * states[:, :3], 0, steps

    return run


def _entry(motion: Motion, run: Any, quick: bool) -> Results:
    """Errors, time and work of a contestant."""
    if run is None:
        return {"left_out": "not installed: pip install heyoka"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        began = time.perf_counter()
        status, positions, calls, steps = run(False)
        if status != "complete":
            return {"left_out": f"more than {MOST_CALLS} force calls, or {status}"}
        took = time.perf_counter() - began
        repeats = 1 if quick or took > 1 else 10 if took > 0.05 else 60
        seconds = min(run(True) for _ in range(repeats))
    off = 1e6 * _far(positions, motion.truth)
    before = off[~motion.near]
    return {
        "before_um": float(np.nanmax(before, initial=0.0)),
        "during_um": float(np.nanmax(off[motion.near], initial=0.0)),
        "ms": 1e3 * seconds,
        "force_calls": calls,
        "steps": steps,
    }


def headline(results: Results) -> Results:
    """What the documentation quotes, by motion."""
    told: Results = {}
    for label, of in results["motions"].items():
        entries = of["entries"]
        told[label] = {"solvers_agree_to_um": of["solvers_agree_to_um"]}
        for model, method in OURS[:2]:
            named = [e for e in entries if (e["model"], e["method"]) == (model, method)]
            good = [
                e for e in named if e["during_um"] <= HEADLINE[0] and e["before_um"] <= HEADLINE[1]
            ]
            best = min(good, key=lambda e: e["ms"], default=None)
            told[label][f"{model}_ms_at_2e-6_um"] = best and best["ms"]
        ours = [e for e in entries if (e["model"], e["method"]) in OURS[:2]]
        for other in ("scipy:LSODA", "numpy"):
            ratios = [
                (e["ms"] / mine["ms"], e, mine)
                for e in entries
                if e["method"] == other
                for mine in ours
                if mine["during_um"] <= e["during_um"] and mine["before_um"] <= e["before_um"]
            ]
            if ratios:
                ratio, theirs, mine = max(ratios, key=lambda each: each[0])
                told[label][other] = {
                    "times_slower": ratio, "ms": theirs["ms"], "error_um": theirs["during_um"],
                    "ours_ms": mine["ms"], "our_error_um": mine["during_um"],
                    "ours": f"{mine['model']}, {mine['method']}",
                }  # fmt: skip
    return told
