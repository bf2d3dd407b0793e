"""Brownian motion: steps a second, bias against step and cost, and how ensembles scale.

Rates are of 3-D trajectories of one scene under the table of its force, on one core, steady state.
Biases are those of wells of the scene's stiffness where the truth is a quadrature, each with its
standard error over independent trajectories. To make the errors small, what goes along with the
same thermal motion in a harmonic trap, whose moments are known, is taken off (control variates:
Glasserman, Monte Carlo Methods in Financial Engineering, 4.1). Cost is the time of a step under the
table over the length of the step. Against all that, Euler and Maruyama's method for the inertial
equations, in NumPy as a user would write it. The results are plain data for JSON.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib.util
import itertools
import math
import os
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import hermite_e
from numpy.typing import NDArray
from scipy.constants import Boltzmann
from scipy.integrate import quad
from scipy.linalg import expm, solve_discrete_lyapunov
from scipy.optimize import brentq

import tweezer
from tests.benchmarks import numpy_sum
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import Call, dask_clients, in_fresh_process, machine, per_item
from tests.reference.fields import GaussianWell, LinearTrap, QuarticTrap, in_place
from tweezer.dynamics.brownian import euler, noise, propagator
from tweezer.dynamics.brownian.batch import Linear
from tweezer.dynamics.brownian.propagator import Weights
from tweezer.dynamics.walk import Walk, walk
from tweezer.forces.force import bound as bound_force
from tweezer.forces.force import evaluated
from tweezer.scene import Scene

Array = NDArray[np.float64]
Results = dict[str, Any]
Force = Callable[[Array], Array]

SCENE = "silica-1um"
SEED = 1
#: depth of the Gaussian well, kT; c sigma^2 / k of F = -k x - c x^3, sigma^2 = kT/k
DEPTH, QUARTICS = 30.0, (0.05, 0.1)
GAUSSIAN, HARMONIC = f"Gaussian, {DEPTH:g} kT deep", "harmonic"
MILD, STRONG = (f"quartic, c σ² = {quartic:g} k" for quartic in QUARTICS)
#: step of the headline, trap times: 1/kappa = drag/stiffness
STEP = 0.2
#: bias of <x^2> up to which costs are compared
GOOD = 0.01
#: trap times until the begin is forgotten, and over which the autocorrelation falls
_FORGOTTEN, _LAG = 10.0, 0.4
#: samples held at a time
_WINDOW = 128
#: beads and steps of a timed call
_BEADS, _STEPS = 256, 20
#: places of a timed call of a part of a step
_MANY = 1024
#: models and schemes whose step is shown beside its parts
PARTED = (("full", "heun"), ("full", "one-call"), ("overdamped", "heun"))
#: poles of the fluid's memory whose step is shown there; all else is of a fluid without inertia
POLES = (16, 24)

MODELS = (
    ("full", "heun"), ("full", "one-call"), ("full", "harmonic"), ("full", "euler-maruyama"),
    ("full", "baoab"), ("overdamped", "heun"), ("overdamped", "one-call"),
    ("overdamped", "harmonic"), ("overdamped", "euler-maruyama"), ("first-order", "heun"),
)  # fmt: skip


class Way(NamedTuple):
    """A model and a scheme."""

    model: str
    method: str
    spring: bool = False
    """whether the well's stiffness is in the exact part of the step"""

    @property
    def label(self) -> str:
        """In words."""
        spring = ", spring exact" if self.spring else ", without spring"
        return f"{self.model}, {self.method}{spring if self.method == 'heun' else ''}"


DEFAULT = Way("full", "heun", spring=True)
#: ways that are compared with Euler-Maruyama of the same equations
COMPARED = (DEFAULT, Way("full", "one-call"))
#: ways whose step is not bound to the relaxation time
WAYS = (
    *COMPARED, Way("full", "heun"), Way("overdamped", "heun", spring=True),
    Way("overdamped", "heun"), Way("overdamped", "one-call"), Way("overdamped", "euler-maruyama"),
    Way("first-order", "heun", spring=True),
)  # fmt: skip


def way_of(entry: Results) -> Way:
    """The way of an entry."""
    return Way(entry["model"], entry["method"], entry["spring"])


class Effort(NamedTuple):
    """How much is measured."""

    rounds: int
    compiling: bool
    """whether to time compilation, in a cache of its own"""
    ways: tuple[Way, ...]
    steps: tuple[float, ...]
    """trap times"""
    euler_steps: tuple[float, ...]
    """of the inertial Euler-Maruyama, relaxation times"""
    baoab_steps: tuple[float, ...]
    """trap times"""
    trap_times: float
    """followed of each way at each step, all beads together"""
    longer: float
    """times that for what is compared, at the step of the headline and longer ones"""
    euler_trap_times: float
    beads: int
    ensemble: int
    """trajectories of the timed ensembles"""
    most_workers: int
    """of Dask"""
    repeats: int
    trajectories: tuple[int, ...]
    """of the ensembles whose memory is looked at"""
    theories: tuple[str, ...]
    """of light whose maps are read in steps"""


FULL = Effort(
    rounds=500, compiling=True, ways=WAYS, steps=(0.05, 0.1, STEP, 0.4, 0.8, 1.6),
    euler_steps=(0.5, 1.0, 1.5, 1.9), baoab_steps=(0.002, 0.01, 0.03), trap_times=2e5, longer=16.0,
    euler_trap_times=2e4, beads=512, ensemble=4096, most_workers=64, repeats=6,
    trajectories=(10_000, 100_000, 1_000_000), theories=("rays", "waves"),
)  # fmt: skip
QUICK = Effort(
    rounds=3, compiling=False, ways=(DEFAULT, Way("overdamped", "euler-maruyama")),
    steps=(STEP, 0.8), euler_steps=(1.9,), baoab_steps=(0.03,), trap_times=1e4, longer=1.0,
    euler_trap_times=640.0, beads=64, ensemble=128, most_workers=1, repeats=1, trajectories=(1000,),
    theories=("waves",),
)  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Trap:
    """The bead of the scene, and the stiffness of its trap across the light."""

    scene: Scene
    stiffness: float
    """N/m"""
    mass: float
    drag: float
    tau: float
    """s, relaxation time"""
    kT: float

    @property
    def kappa(self) -> float:
        """Relaxation rate of the bead in the trap, 1/s."""
        return self.stiffness / self.drag

    @property
    def variance(self) -> float:
        """<x^2> of a harmonic trap, m^2."""
        return self.kT / self.stiffness


@dataclasses.dataclass(frozen=True)
class Well:
    """A field of force with a closed form, and what is true of a bead in it."""

    field: GaussianWell | QuarticTrap | LinearTrap
    x2: float
    """m^2"""
    anharmonicity: float | None
    """c sigma^2/k where coordinates are independent of each other"""


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    effort = QUICK if quick else FULL
    trap = trap_of_scene()
    results: Results = {
        "machine": machine(), "quick": quick, "scene": SCENE,
        "trap": {
            "stiffness_N_per_m": trap.stiffness,
            "trap_time_s": 1 / trap.kappa,
            "relaxation_time_s": trap.tau,
        },
        "left_out": [],
    }  # fmt: skip
    say("steps a second")
    results["rates"], ns = _rates(trap, effort)
    say("a step by its parts")
    results["parts"] = parts(trap, effort)
    say("the first step in fresh processes")
    results["fresh_process"] = _fresh(effort)
    results["wells"] = {}
    for name, well in wells(trap).items():
        say(f"bias: {name}")
        results["wells"][name] = list(_biases(trap, name, well, results, effort, say))
    results["baseline"] = _baseline(trap, ns, results["wells"])
    results["cores"] = _cores(trap, results, effort, say)
    results["memory"] = []
    if Path("/proc/self/status").exists():
        results["memory"] = [_memory(trap, n, say) for n in effort.trajectories]
    else:
        results["left_out"].append({"what": "memory", "why": "the peak is read from /proc"})
    results["headline"] = headline(results)
    rounded: Results = _to_four_digits(results)
    return rounded


def trap_of_scene() -> Trap:
    """The trap that all is about."""
    scene = tweezer.load_scene(SCENE).replace(
        forces={"brownian": True}, optics={"evaluator": "map"}, start={"drawn": "boltzmann"},
        medium={"inertia": "none"},
    )  # fmt: skip
    equilibrium = walk(scene).equilibrium
    assert equilibrium is not None
    bead = tweezer.bead_properties(scene)
    return Trap(
        scene, equilibrium.stiffness[0][0], bead.mass, bead.drag, bead.relaxation_time,
        Boltzmann * scene.medium.temperature,
    )  # fmt: skip


# Steps a second


def _rates(trap: Trap, effort: Effort) -> tuple[list[Results], dict[str, Results]]:
    """Trajectory-steps a second per core of each model and scheme, least and median time.

    And in the same run ns a step of ours and of NumPy's Euler-Maruyama, by what gives the force.
    """
    calls = {}
    for model, method in MODELS:
        resolving = model == "full" and method in ("euler-maruyama", "baoab")
        step = 0.2 * trap.tau if resolving else 0.1 / trap.kappa
        run = _some_steps(_sampled(trap, model, method, step))
        calls[model, method] = Call(run, _BEADS * _STEPS)
    calls |= _baseline_calls(trap)
    times = dict(
        zip(calls, per_item([[call] for call in calls.values()], effort.rounds), strict=True)
    )
    rates = [
        {
            "model": model, "method": method,
            "force_calls": {"heun": 2, "harmonic": 0}.get(method, 1),
            "steps_per_s": 1 / times[model, method][0],
            "steps_per_s_by_the_median_time": 1 / times[model, method][1],
        }
        for model, method in MODELS
    ]  # fmt: skip
    ns: dict[str, Results] = {}
    for force, method in calls:
        if (force, method) not in MODELS:
            ns.setdefault(force, {})[method] = 1e9 * times[force, method][0]
    ours = {
        method: 1e9 * times["full", method][0] for method in ns["closed form"].keys() - {"numpy"}
    }
    return rates, ns | {force: ours | ns[force] for force in ("table", "ray sum")}


def _sampled(trap: Trap, model: str, method: str, step: float, samples: int = 1000) -> Walk:
    """The scene's bead under the table, a sample every `_STEPS` steps."""
    return walk(
        trap.scene.replace(
            simulation={
                "model": model, "method": method, "step": step, "samples": samples + 1,
                "duration": _STEPS * step * samples,
            }
        ),
        SEED,
    )  # fmt: skip


def _some_steps(bound: Walk) -> Callable[[], object]:
    """A call that takes beads `_STEPS` steps further."""
    trajectories = np.arange(_BEADS)
    states, out = bound.start(trajectories), np.empty((_BEADS, 1, len(bound.columns)))
    samples = itertools.count()
    return lambda: bound.advance(states, trajectories, next(samples), out)


def parts(trap: Trap, effort: Effort) -> dict[str, float]:
    """Least ns of a bead's step, and of its parts: normal numbers and the map; and in NumPy.

    Of many beads at once. NumPy takes Euler and Maruyama's steps on a plain spring.
    """
    who = np.arange(_MANY)
    calls = {}
    for count in (3, 6):
        drawn = np.empty((count, _MANY))
        run = functools.partial(noise.normals, SEED, who, 0, noise.NOISE, drawn)
        calls[f"{count} normal numbers"] = Call(run, _MANY)
    for theory in effort.theories:
        with warnings.catch_warnings(action="ignore", category=tweezer.PhysicsWarning):
            of_theory = dataclasses.replace(
                trap, scene=trap.scene.replace(optics={"theory": theory})
            )
            for model, method in PARTED:
                walked = _sampled(of_theory, model, method, 0.1 / trap.kappa)
                calls[f"{theory}: {model} {method}"] = Call(_some_steps(walked), _BEADS * _STEPS)
        for poles in POLES:
            medium = {"inertia": "memory", "poles": poles}
            remembering = dataclasses.replace(
                of_theory, scene=of_theory.scene.replace(medium=medium)
            )
            walk_with = _sampled(remembering, "full", "heun", 0.1 / trap.kappa)
            calls[f"{theory}: full heun, memory of {poles} poles"] = Call(
                _some_steps(walk_with), _BEADS * _STEPS
            )
        places = np.ascontiguousarray(walked.start(who)[:, :3])
        for what, gradient in (("map", False), ("map with gradient", True)):
            light = bound_force(walked.problem.force, gradient=gradient)
            run = functools.partial(evaluated, light, places, gradient)
            calls[f"{theory}: {what}"] = Call(run, _MANY)
    rng = np.random.default_rng(SEED)
    x = math.sqrt(trap.variance) * rng.standard_normal((_BEADS * 4, 3))
    v = math.sqrt(trap.kT / trap.mass) * rng.standard_normal(x.shape)

    def spring(x: Array) -> Array:
        return -trap.stiffness * x

    run = functools.partial(numpy_euler_maruyama, spring, x, v, 0.5 * trap.tau, _STEPS, trap, rng)
    calls["NumPy: with inertia"] = Call(run, len(x) * _STEPS)
    y = x.copy()
    run = functools.partial(numpy_overdamped, spring, y, 0.1 / trap.kappa, _STEPS, trap, rng)
    calls["NumPy: overdamped"] = Call(run, len(x) * _STEPS)
    times = per_item([[call] for call in calls.values()], effort.rounds)
    return {name: 1e9 * least for name, (least, _) in zip(calls, times, strict=True)}


_FIRST_STEP = """
import json, time
start = time.perf_counter()
import numpy as np
import tweezer
from tweezer.dynamics.walk import walk
scene = tweezer.load_scene("{scene}").replace(
    forces={{"brownian": True}}, optics={{"evaluator": "map"}}
)
imported = time.perf_counter()
bound = walk(scene)
ready = time.perf_counter()
beads = np.arange(64)
bound.advance(bound.start(beads), beads, 0, np.empty((64, 1, len(bound.columns))))
first = time.perf_counter()
print(json.dumps({{
    "import_s": imported - start, "bind_s": ready - imported, "first_step_s": first - ready,
    "at": time.time(),
}}))
"""


def _fresh(effort: Effort) -> Results:
    """Import, bind, first step, and the whole process until then; the table is at hand."""
    program = _FIRST_STEP.format(scene=SCENE)
    results: Results = {}
    with tempfile.TemporaryDirectory() as folder:
        if effort.compiling:
            results["empty_cache"] = in_fresh_process(program, {"NUMBA_CACHE_DIR": folder})
        results["warm_cache"] = in_fresh_process(program, {})
    return results


# Bias


def wells(trap: Trap) -> dict[str, Well]:
    """Wells of the trap's stiffness."""
    k, variance = trap.stiffness, trap.variance
    width = math.sqrt(DEPTH * variance)

    def average(
        of: Callable[[float], float], energy: Callable[[float], float], end: float
    ) -> float:
        """Over the Boltzmann distribution; energy in kT, length in sigma."""
        above, below = (
            quad(lambda r, f=f: f(r) * math.exp(-energy(r)), 0, end, epsabs=0, epsrel=1e-12)[0]
            for f in (lambda r: of(r) * r * r, of)
        )
        return float(above / below)

    # to where the well is flat: what is beyond matters at 1e-7, and no bead gets there
    radial = average(
        lambda r: r * r, lambda r: -DEPTH * math.expm1(-r * r / (2 * DEPTH)), 3 * math.sqrt(DEPTH)
    )
    found = {GAUSSIAN: Well(GaussianWell(k, width), variance * radial / 3, None)}
    for name, c in zip((MILD, STRONG), QUARTICS, strict=True):
        single = average(lambda _: 1.0, lambda x, c=c: x * x / 2 + c * x**4 / 4, 10.0)
        found[name] = Well(QuarticTrap(k, c * k / variance), variance * single, c)
    return found | {HARMONIC: Well(LinearTrap(k), variance, 0.0)}


def autocorrelation(trap: Trap, anharmonicity: float, times: Array) -> Array:
    """<x(0) x(t)>/<x^2> of the inertial motion with F = -k x - c x^3, at times (n,) s.

    The Kramers operator (Risken, The Fokker-Planck Equation, 10.1) in Hermite polynomials of the
    velocity, orthonormal ones of the position under its Boltzmann distribution: as many as give
    eight digits up to kappa tau = 0.1.
    """
    places, speeds = 16, 4
    x, weights = hermite_e.hermegauss(160)  # in sigma
    weights = weights * np.exp(-anharmonicity * x**4 / 4)
    size = [math.sqrt(math.factorial(m)) for m in range(places)]
    hermite = hermite_e.hermevander(x, places - 1) / size
    Q, R = np.linalg.qr(np.sqrt(weights / weights.sum())[:, None] * hermite)
    lower = np.diag(np.sqrt(np.arange(1.0, places)), 1)
    derivative = R @ lower @ np.linalg.inv(R)
    fall = np.diag(np.sqrt(np.arange(1.0, speeds)), 1)
    rate = math.sqrt(trap.kappa / trap.tau)  # thermal velocity over sigma
    generator = rate * (np.kron(fall.T, derivative) - np.kron(fall, derivative.T))
    generator -= np.kron(fall.T @ fall, np.eye(places)) / trap.tau
    first = np.zeros(places * speeds)
    first[:places] = Q.T @ (np.sqrt(weights / weights.sum()) * x)
    return np.array([first @ expm(t * generator) @ first for t in times]) / (first @ first)


def _biases(
    trap: Trap,
    name: str,
    well: Well,
    results: Results,
    effort: Effort,
    say: Callable[[str], object],
) -> Iterator[Results]:
    """Entries of a well; what cannot be taken is left out, with the reason."""
    times = {
        (each["model"], each["method"]): 1e6 / each["steps_per_s"] for each in results["rates"]
    }
    for way, step, trap_times in _points(trap, name, effort):
        say(f"bias: {name}: {way.model} {way.method}, step of {step:.3g} trap times")
        missing = {"what": f"{name}: {way.label}", "step_trap_times": step}
        try:
            found = bias(trap, well, way, step, trap_times=trap_times, beads=effort.beads)
        except tweezer.IntegrationError as error:
            results["left_out"].append({**missing, "why": str(error)})
            continue
        if well.anharmonicity is not None and "corner_bias" not in found:
            why = "no corner frequency: x is no longer correlated"
            results["left_out"].append({**missing, "why": why})
        yield {
            **way._asdict(), "step_trap_times": step,
            "step_relaxation_times": step / (trap.kappa * trap.tau), **found,
            "force_calls_per_trap_time": {"heun": 2}.get(way.method, 1) / step,
            "us_per_trap_time": times[way.model, way.method] / step,
        }  # fmt: skip


def _points(trap: Trap, name: str, effort: Effort) -> Iterator[tuple[Way, float, float]]:
    """Way, step in trap times, and how many of these."""
    for way in effort.ways:
        for step in effort.steps:
            longer = effort.longer if way in COMPARED and step >= STEP else 1.0
            known = 0.25 if name == HARMONIC else 1.0  # its control has hardly an error
            yield way, step, longer * known * effort.trap_times
    if name == MILD:
        ratio = trap.kappa * trap.tau
        for step in effort.euler_steps:
            yield Way("full", "euler-maruyama"), step * ratio, effort.euler_trap_times
        for step in effort.baoab_steps:
            yield Way("full", "baoab"), step, effort.trap_times / 4


def bias(
    trap: Trap, well: Well, way: Way, step: float, *, trap_times: float, beads: int
) -> Results:
    """Relative bias of <x^2>, <v^2> and corner frequency, with standard errors; step: trap times.

    The corner frequency is that of the exponential by which the autocorrelation falls from one
    sample apart, 0.1 trap times or a step, to `_LAG` more. Truth is always the inertial motion.
    Raises `IntegrationError` if a bead flies off.
    """
    every = max(1, round(0.1 / step))
    interval = step * every
    lags = (1, 1 + max(1, round(_LAG / interval)))
    samples = max(_WINDOW, math.ceil(trap_times / (beads * interval)))
    burnt = math.ceil(_FORGOTTEN / interval)
    run = functools.partial(_moments, beads=beads, burnt=burnt, samples=samples, lags=lags)
    bound = _in_well(trap, well, way, step / trap.kappa, every, samples + burnt)
    x2, v2, near, far = run(bound)
    springy, known = _control(trap, bound, [every * lag for lag in lags])
    controls = [of / mean - 1 for of, mean in zip(run(springy), known, strict=True) if mean > 0]
    result = _named("x2", *_controlled(x2 / well.x2 - 1, controls))
    if way.model == "full":
        result |= _named("v2", *_controlled(v2 * trap.mass / trap.kT - 1, controls))
    if well.anharmonicity is not None:
        apart = np.array(lags) * interval / trap.kappa
        before, after = autocorrelation(trap, well.anharmonicity, apart)
        true = float(after / before)
        off, error = _controlled((far - true * near) / near.mean(), controls)
        if true + off > 3 * error:
            result |= _named(
                "corner", math.log(true + off) / math.log(true) - 1,
                error / (true + off) / -math.log(true),
            )  # fmt: skip
    return result | {"trap_times": beads * samples * interval}


def _named(name: str, value: float, error: float) -> Results:
    return {f"{name}_bias": value, f"{name}_error": error}


def _in_well(trap: Trap, well: Well, way: Way, step: float, every: int, samples: int) -> Walk:
    """The bead in a well instead of the light, a sample every so many steps of `step` s."""
    scene = trap.scene.replace(
        forces={"optical": False, "gravity": False, "buoyancy": False},
        start={"drawn": "no", "position": [0.0, 0.0, 0.0]},
        simulation={
            "model": way.model, "method": way.method, "step": step, "samples": samples + 1,
            "duration": step * every * samples, "loss_distance": 1e-3,
        },
    )  # fmt: skip
    bound = walk(scene, SEED)
    weights = bound.weights
    if way.spring:
        first_order = way.model == "first-order"
        kappa = trap.kappa * (1 + trap.kappa * trap.tau) if first_order else trap.kappa
        inert = bound.plan.tau if way.model == "full" else np.zeros(3)
        weights = propagator.exact(bound.step, inert, np.full(3, kappa), bound.plan.diffusion)
    return dataclasses.replace(bound, problem=in_place(bound.problem, well.field), weights=weights)


def _control(trap: Trap, bound: Walk, apart: list[int]) -> tuple[Walk, list[float]]:
    """The same thermal motion on the spring alone, and its `linear_moments`.

    By the exact step, or by that of Euler and Maruyama.
    """
    kappa = np.full(3, trap.kappa)
    if bound.scene.simulation.method == "euler-maruyama":
        weights = bound.weights._replace(kappa=kappa)
    else:
        inert = bound.plan.tau if "vx" in bound.columns else np.zeros(3)
        weights = propagator.exact(bound.step, inert, kappa, bound.plan.diffusion)
    scene = bound.scene
    if scene.simulation.model == "first-order":
        scene = scene.replace(simulation={"model": "overdamped"})
    scene = scene.replace(simulation={"method": "harmonic"})
    spring = LinearTrap(trap.stiffness)
    problem = dataclasses.replace(bound.problem, scene=scene, light=spring)
    springy = dataclasses.replace(bound, problem=problem, weights=weights)
    return springy, linear_moments(weights, apart)


def linear_moments(weights: Weights, apart: list[int]) -> list[float]:
    """Stationary <x^2>, <v^2>, and <x x'> so many steps apart, of one-force steps on a spring."""
    by_v, by_u, decay, v_by_u, kappa, noise_x, noise_xv, noise_v = (
        float(getattr(weights, name)[0])
        for name in (
            "by_v", "by_u", "decay", "v_by_u", "kappa", "noise_x", "noise_xv", "noise_v",
        )
    )  # fmt: skip
    step = np.array([[1 - by_u * kappa, by_v], [-v_by_u * kappa, decay]])
    noise = np.array([[noise_x, 0.0], [noise_xv, noise_v]])
    # in units of their noise: metres are much less than metres a second
    unit = np.array([noise_x or by_v * noise_v, noise_v or 1.0])
    covariance = solve_discrete_lyapunov(
        step / unit[:, None] * unit, (noise / unit[:, None]) @ (noise / unit[:, None]).T
    ) * np.outer(unit, unit)
    products = [(np.linalg.matrix_power(step, steps) @ covariance)[0, 0] for steps in apart]
    return [float(each) for each in (covariance[0, 0], covariance[1, 1], *products)]


def _moments(bound: Walk, *, beads: int, burnt: int, samples: int, lags: tuple[int, ...]) -> Array:
    """Of every bead, over time and axes: x^2, v^2 (0 without inertia), and x x' of each lag."""
    trajectories = np.arange(beads)
    states = bound.start(trajectories)
    columns = len(bound.columns)
    bound.advance(states, trajectories, 0, np.empty((beads, burnt, columns)))
    sums, counts = np.zeros((2 + len(lags), beads)), np.zeros((2 + len(lags), 1))
    for first in range(0, samples, _WINDOW):
        window = np.empty((beads, min(_WINDOW, samples - first), columns))
        bound.advance(states, trajectories, burnt + first, window)
        x, v = window[..., :3], window[..., 3:]
        pairs = [(x, x), (v, v), *((x[:, :-lag], x[:, lag:]) for lag in lags)]
        for i, (one, other) in enumerate(pairs):
            sums[i] += np.einsum("nsi,nsi->n", one, other)
            counts[i] += 3 * one.shape[1]
    if np.isfinite(states[:, -1]).any():
        raise tweezer.IntegrationError("beads fly off")
    return np.asarray(sums / counts)


def _controlled(values: Array, controls: list[Array]) -> tuple[float, float]:
    """Mean of (n,) with its standard error, less what goes along with controls of mean 0."""
    of = np.column_stack(controls)
    slopes = np.linalg.lstsq(of - of.mean(axis=0), values - values.mean(), rcond=None)[0]
    rest = values - of @ slopes
    free = len(rest) - 1 - len(controls)
    return float(rest.mean()), float(math.sqrt(rest.var() / free))


# The user's Euler-Maruyama


def numpy_euler_maruyama(
    force: Force, x: Array, v: Array, step: float, steps: int, trap: Trap, rng: np.random.Generator
) -> None:
    """Take beads (n, 3) along, in place, by the inertial equations."""
    kick = math.sqrt(2 * trap.drag * trap.kT / step)
    for _ in range(steps):
        a = (force(x) - trap.drag * v + kick * rng.standard_normal(x.shape)) / trap.mass
        x += step * v
        v += step * a


def numpy_overdamped(
    force: Force, x: Array, step: float, steps: int, trap: Trap, rng: np.random.Generator
) -> None:
    """Take beads (n, 3) along, in place, by the equations without inertia."""
    kick = math.sqrt(2 * trap.kT * step / trap.drag)
    for _ in range(steps):
        x += step / trap.drag * force(x) + kick * rng.standard_normal(x.shape)


def euler_maruyama_bias(trap: Trap, step: float) -> tuple[float, float]:
    """Relative bias of <x^2> and <v^2> of the inertial Euler-Maruyama, harmonic trap; step: tau."""
    diffusion = np.array([trap.kT / trap.drag])
    linear = Linear(np.array([trap.tau]), np.zeros(1), diffusion, 0.0, np.zeros((3, 3)))
    weights = euler.weights(step * trap.tau, linear)
    x2, v2 = linear_moments(weights._replace(kappa=np.array([trap.kappa])), [])
    return x2 / trap.variance - 1, v2 * trap.mass / trap.kT - 1


def euler_maruyama_step(trap: Trap, bias: float) -> float:
    """The step at which its <x^2> has that bias, relaxation times."""
    return float(brentq(lambda a: euler_maruyama_bias(trap, a)[0] - bias, 1e-4, 1.999, xtol=1e-6))


def _baseline_calls(trap: Trap) -> dict[tuple[str, str], Call]:
    """Steps under forces that both take, by force and method; and the thesis's sum over rays."""
    gaussian = wells(trap)[GAUSSIAN].field
    assert isinstance(gaussian, GaussianWell)
    k, width = gaussian.stiffness, gaussian.width

    def in_closed_form(x: Array) -> Array:
        return -k * np.exp(-np.sum(x * x, axis=1, keepdims=True) / (2 * width**2)) * x

    forces: dict[str, Force] = {
        "closed form": in_closed_form,
        "table": lambda x: tweezer.optical_force(trap.scene, x),
    }
    calls: dict[tuple[str, str], Call] = {}
    for name, force in forces.items():
        rng = np.random.default_rng(SEED)
        x = math.sqrt(trap.variance) * rng.standard_normal((_BEADS * 4, 3))
        v = math.sqrt(trap.kT / trap.mass) * rng.standard_normal(x.shape)
        run = functools.partial(
            numpy_euler_maruyama, force, x, v, 0.5 * trap.tau, _STEPS, trap, rng
        )
        calls[name, "numpy"] = Call(run, len(x) * _STEPS)
    for way in (*COMPARED, Way("full", "euler-maruyama")):
        step = 0.5 * trap.tau if way.method == "euler-maruyama" else STEP / trap.kappa
        bound = _in_well(trap, wells(trap)[GAUSSIAN], way, step, _STEPS, 1000)
        calls["closed form", way.method] = Call(_some_steps(bound), _BEADS * _STEPS)
    thesis = tweezer.load_scene("thesis-990nm")
    rays = numpy_sum.pupil(thesis)
    place = np.array([0.1, -0.1, 0.2]) * thesis.bead.radius
    calls["ray sum", "numpy"] = Call(lambda: numpy_sum.force(thesis, rays, place), 1)
    return calls


def _baseline(trap: Trap, ns: dict[str, Results], biases: dict[str, list[Results]]) -> Results:
    """How much cheaper our steps are than Euler-Maruyama's, from ns a step and biases by well.

    Euler-Maruyama takes the step at which its <x^2> in the harmonic trap is as wrong as ours in the
    anharmonic wells, with twice our standard error added: the most at any step from `STEP` on, as
    biases that change their sign are small by chance.
    """
    compared = []
    for well, way in itertools.product(biases, COMPARED):
        equal = 0.0
        for entry in biases[well] if well != HARMONIC else ():
            if way_of(entry) != way or entry["step_trap_times"] < STEP:
                continue
            equal = max(equal, abs(entry["x2_bias"]) + 2 * entry["x2_error"])
            needed = euler_maruyama_step(trap, equal)
            fewer = entry["step_relaxation_times"] / needed
            compared.append(
                {
                    "well": well, "method": way.method,
                    "step_trap_times": entry["step_trap_times"], "bias": equal,
                    "euler_maruyama_step_relaxation_times": needed,
                    "euler_maruyama_v2_bias": euler_maruyama_bias(trap, needed)[1],
                    "times_fewer_steps": fewer,
                    "times_cheaper": {
                        name: {
                            method: fewer * of[method] / of[way.method]
                            for method in ("numpy", "euler-maruyama")
                        }
                        for name, of in ns.items()
                    },
                }
            )  # fmt: skip
    line = np.geomspace(0.02, 1.95, 40)
    return {
        "ns_per_step": ns, "compared": compared,
        "euler_maruyama_harmonic": {
            "steps_relaxation_times": line.tolist(),
            "x2_bias": [euler_maruyama_bias(trap, step)[0] for step in line],
        },
    }  # fmt: skip


# Ensembles


def _ensemble_scene(trap: Trap, samples: int) -> Scene:
    return _sampled(trap, "full", "heun", 0.1 / trap.kappa, samples).scene


def _cores(
    trap: Trap, results: Results, effort: Effort, say: Callable[[str], object]
) -> list[Results]:
    """Ensembles, statistics only, on 1, 2, 4 ... threads and Dask workers, in turn."""
    say("cores: threads")
    scene = _ensemble_scene(trap, 200)
    cores = os.cpu_count() or 1
    counts = [2**k for k in range(cores.bit_length())]
    steps = effort.ensemble * 200 * _STEPS
    seconds: dict[tuple[str, int], list[float]] = {}

    def timed(kind: str, count: int, run: Callable[[], object]) -> None:
        began = time.perf_counter()
        run()
        seconds.setdefault((kind, count), []).append(time.perf_counter() - began)

    run = functools.partial(tweezer.ensemble, scene, statistics=True, seed=SEED)
    run(64)
    for _ in range(effort.repeats):
        for count in counts:
            timed("threads", count, functools.partial(run, effort.ensemble, workers=count))
    if importlib.util.find_spec("distributed") is None:
        why = "not installed: pip install tweezer[cluster]"
        results["left_out"].append({"what": "Dask workers", "why": why})
    else:
        say("cores: Dask workers")
        few = [count for count in counts if count <= effort.most_workers]
        with tempfile.TemporaryDirectory() as folder, dask_clients(few) as clients:
            number = itertools.count()

            def by_workers(client: Any, trajectories: int) -> None:
                out = Path(folder) / f"{next(number)}.nc"
                run(trajectories, out=out, scheduler=client)

            for client in clients.values():
                by_workers(client, 64 * 8)
            for _ in range(effort.repeats):
                for count, client in clients.items():
                    call = functools.partial(by_workers, client, effort.ensemble)
                    timed("Dask workers", count, call)
    return [
        {
            "kind": kind, "count": count, "steps_per_s": steps / min(taken),
            "times_one": min(seconds[kind, 1]) / min(taken), "seconds": taken,
        }
        for (kind, count), taken in seconds.items()
    ]  # fmt: skip


_PEAK = """
import json, re, time
from pathlib import Path
import tweezer
from tweezer.scene import Scene
tweezer.ensemble(Scene.model_validate_json({scene!r}), {trajectories}, statistics=True)
at = time.time()
told = Path("/proc/self/status").read_text()
print(json.dumps({{"peak_mb": int(re.search(r"VmHWM:\\s*(\\d+) kB", told)[1]) / 1e3, "at": at}}))
"""


def _memory(trap: Trap, trajectories: int, say: Callable[[str], object]) -> Results:
    """Peak of the resident memory of a process that gathers statistics, MB."""
    say(f"memory: {trajectories} trajectories")
    scene = _ensemble_scene(trap, 4).model_dump_json(exclude_none=True)
    told = in_fresh_process(_PEAK.format(scene=scene, trajectories=trajectories), {})
    return {"trajectories": trajectories, **told}


def headline(results: Results) -> Results:
    """What the documentation quotes."""
    rates = {(each["model"], each["method"]): each["steps_per_s"] for each in results["rates"]}
    cores = {(each["kind"], each["count"]): each["times_one"] for each in results["cores"]}
    cheaper = []
    for _, of in itertools.groupby(
        results["baseline"]["compared"], lambda each: (each["method"], each["well"])
    ):
        good = [each for each in of if each["bias"] < GOOD]
        if not good:
            continue
        at_step, *longer = good
        best = max([at_step, *longer], key=lambda each: each["times_cheaper"]["table"]["numpy"])
        cheaper += [at_step] if best is at_step else [at_step, best]
    return {
        "biases": {
            name: {key: entry[key] for key in ("x2_bias", "x2_error", "v2_bias", "v2_error")}
            for name, entries in results["wells"].items()
            for entry in entries
            if way_of(entry) == DEFAULT and entry["step_trap_times"] == STEP
        },
        "overdamped_one_call_steps_per_s": rates["overdamped", "one-call"],
        "full_heun_steps_per_s": rates["full", "heun"],
        "cheaper": cheaper,
        "two_threads_over_one": cores.get(("threads", 2)),
        "two_dask_workers_over_one": cores.get(("Dask workers", 2)),
        "memory": results["memory"],
    }
