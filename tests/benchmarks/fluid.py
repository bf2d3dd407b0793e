"""Fluid inertia: error against the number of poles, reported errors, force calls, step rates.

Errors of the modes are against closed forms, the largest of four beads (of 250 nm and 1.5 um
radius, polystyrene and silica in water) from 1 ns to 0.1 s. Captures are of the thesis's beads
without its scaling, in the light of rays, and compared with Volterra's equation with the exact
memory, before the bead is caught: after that every error is drawn together. Force calls and times
are for whole captures, from rest to rest with the force map, with memory and without. The reported
errors (`integration_error`) belong to releases in the trap of `silica-1um` with other diameters,
positions and viscosities. They are compared with runs with 40 poles and a tolerance that is
tighter by a factor of 1000. The results are plain data for JSON.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.integrate import SCENES
from tests.benchmarks.timing import commit, least_step_times, machine
from tests.reference.fluid import Path, Sphere
from tweezer.dynamics import EquationsOfMotion, bind, bound_once, decided, error_budget
from tweezer.dynamics.integrate import integrate
from tweezer.dynamics.path import largest_distance
from tweezer.dynamics.walk import walk
from tweezer.fluid.memory import NODES, Modes, modes
from tweezer.scene import Scene
from tweezer.thesis.runs import in_the_light
from tweezer.values.errors import PhysicsWarning

Array = NDArray[np.float64]
Results = dict[str, Any]

#: radius, m, and density, kg/m^3
BEADS = ((250e-9, 1050.0), (250e-9, 2000.0), (1.5e-6, 1050.0), (1.5e-6, 2000.0))
#: stiffness of the trap of the relaxation, N/m
STIFFNESS = 2e-5
#: s, before the bead is caught, and error a piece of the reference may add, m
BEFORE = {"thesis-500nm": 9e-3, "thesis-990nm": 6e-3, "thesis-1950nm": 39e-3}
_EXACTLY = 1e-14
#: tolerances of captures, the scene's own first: relative, and of the position, m
TOLERANCES = ((1e-7, 1e-11), (1e-9, 1e-13))
#: the runs for the reported errors take these viscosities, Pa s, in turn; number of runs, seed
VISCOSITIES = (1e-3, 0.05, 0.2, 1.4)
TOLD_RUNS, _TOLD_SEED = 40, 5
#: poles of the thermal steps
STEPS_WITH = (0, 16, 24, 32)


def measure(quick: bool = False, say: Callable[[str], None] = lambda _: None) -> Results:
    """Everything; quick: less of it, to see that it runs. say: told what is measured."""
    poles = (12, 24) if quick else tuple(NODES)
    beads = ("thesis-990nm",) if quick else tuple(SCENES)
    with warnings.catch_warnings(action="ignore", category=PhysicsWarning):
        results = {
            "machine": machine(),
            "modes": [_modes(n, say) for n in poles],
            "captures": [_capture(bead, poles, say) for bead in beads],
            "calls": [
                _calls(bead, theory, tolerance, say)
                for theory in (("rays",) if quick else ("rays", "waves"))
                for bead in beads
                for tolerance in TOLERANCES[: 1 if quick else None]
            ],
            "told": _told(4 if quick else TOLD_RUNS, say),
            "steps": _steps(quick, say),
        }
    return _to_four_digits(results)


# --- modes against closed forms ------------------------------------------------------------------


def _modes(poles: int, say: Callable[[str], None]) -> Results:
    say(f"modes: {poles} poles")
    worst = dict.fromkeys(("velocity", "displacement", "spectrum", "relaxation", "tail"), 0.0)
    seconds = math.inf
    for radius, density in BEADS:
        sphere = Sphere.of(radius, density)
        for _ in range(5):
            began = time.perf_counter()
            found = modes(sphere.mass, sphere.drag, sphere.displaced_mass, poles)
            seconds = min(seconds, time.perf_counter() - began)
        for name, error in _errors(sphere, found).items():
            worst[name] = max(worst[name], error)
    return {"poles": poles, "seconds": seconds, **worst}


def _errors(sphere: Sphere, found: Modes) -> dict[str, float]:
    """Of the correlation of the velocity (of kT/M), of the mean squared displacement and the
    spectrum below 1 MHz (relative), of the relaxation in a trap (of its begin), and of the
    correlation's tail over five decades (relative).
    """
    tau, a = found
    t = np.geomspace(1e-9, 0.1, 400)
    M = sphere.total_mass
    decays = np.exp(-t[:, None] / tau)
    velocity = decays @ (a / tau) * M / sphere.drag
    exact = sphere.velocity_correlation(t)
    past = t[:, None] / tau
    # without cancellation where a mode has hardly moved
    short = past**2 / 2 * (1 - past / 3 * (1 - past / 4 * (1 - past / 5)))
    moved = 2 * np.where(past < 1e-3, short, past + np.expm1(-past)) @ (a * tau) / sphere.drag
    f = np.geomspace(1.0, 1e6, 200)
    s = 2j * np.pi * f[:, None]
    admittance = (a / (1 + s * tau)).sum(axis=1) / sphere.drag
    spectrum = admittance.real / (1 / sphere.impedance(s[:, 0])).real
    late = np.geomspace(1.0, 1e5, 200) * sphere.vorticity_time
    tail = np.exp(-late[:, None] / tau) @ (a / tau) * M / sphere.drag
    return {
        "velocity": float(np.abs(velocity - exact).max()),
        "displacement": float(np.abs(moved / (2 * sphere.moved(t)) - 1).max()),
        "spectrum": float(np.abs(spectrum - 1).max()),
        "relaxation": float(np.abs(_relaxation(sphere, found, t) - sphere.relaxation(
            t, STIFFNESS)).max()),
        "tail": float(np.abs(tail / sphere.velocity_correlation(late) - 1).max()),
    }  # fmt: skip


def _relaxation(sphere: Sphere, found: Modes, t: Array) -> Array:
    """x(t)/x(0) of the modes in a spring: by the eigenvectors of its symmetric matrix."""
    tau, a = found
    # y = (sqrt(k) x, sqrt(beta tau_j a_j) v_j): y' = [[0, s], [-s^T, -1/tau]] y
    s = np.sqrt(STIFFNESS * a / (sphere.drag * tau))
    A = np.zeros((len(tau) + 1, len(tau) + 1))
    A[0, 1:], A[1:, 0] = s, -s
    A[1:, 1:] = -np.diag(1 / tau)
    values, vectors = np.linalg.eig(A)
    amplitudes = vectors[0] * np.linalg.inv(vectors)[:, 0]
    return (np.exp(t[:, None] * values) @ amplitudes).real


# --- captures against Volterra's equation --------------------------------------------------------


def _unscaled(bead: str, /, **sections: Any) -> Scene:
    scene = tweezer.load_scene(bead).replace(
        simulation={"model": "full", "scaling_factor": None, "method": "exponential"}
    )
    return scene.replace(**sections)


def _followed(scene: Scene, samples: int) -> tuple[EquationsOfMotion, Any, Array]:
    problem, _ = decided(bound_once(scene))
    equations = bind(problem)
    times = np.linspace(0.0, problem.scene.simulation.duration, samples)
    return equations, integrate(equations, times), times


def _capture(bead: str, poles: tuple[int, ...], say: Callable[[str], None]) -> Results:
    say(f"capture: {bead}, exactly")
    scene = _unscaled(
        bead,
        optics={"evaluator": "quadrature", "tolerance": 1e-11},
        simulation={"duration": BEFORE[bead]},
    )
    problem = bound_once(scene)
    known = problem.bead
    sphere = Sphere(known.mass, known.drag, known.displaced_mass)
    exact = Path(sphere, problem.net_force, scene.start_position, BEFORE[bead], _EXACTLY)
    times = np.linspace(0.0, BEFORE[bead], 13)
    places = exact(times[1:])

    def off(relative: float, position: float, medium: dict[str, Any]) -> Results:
        say(f"capture: {bead}, {medium}")
        changed = scene.replace(
            medium={"inertia": "memory", **medium},
            simulation={"relative_tolerance": relative, "position_tolerance": position},
        )
        equations, run, _ = _followed(changed, 13)
        apart = np.linalg.norm(run.states[1:, :3] - places, axis=1)
        return {
            "tolerance": relative, "poles": equations.scene.medium.poles,
            "error_um": 1e6 * float(apart.max()),
        }  # fmt: skip

    without = {"inertia": "none"}
    return {
        "bead": bead,
        "until_ms": 1e3 * BEFORE[bead],
        "usual": [off(*each, {}) for each in TOLERANCES],
        "by_poles": [off(1e-11, 1e-15, {"poles": n}) for n in poles],
        "without_um": off(*TOLERANCES[1], without)["error_um"],
    }


def _calls(
    bead: str, theory: str, tolerance: tuple[float, float], say: Callable[[str], None]
) -> Results:
    say(f"force calls: {bead}, {theory}")
    reach, ends = SCENES[bead]
    relative, position = tolerance
    lit = in_the_light(_unscaled(bead), theory)
    found: Results = {"bead": bead, "theory": theory, "tolerance": relative}
    for inertia in ("none", "memory"):
        scene = lit.replace(
            medium={"inertia": inertia},
            optics={"evaluator": "map", "table_range": reach},
            simulation={
                "duration": ends[theory], "relative_tolerance": relative,
                "position_tolerance": position,
            },
        )  # fmt: skip
        equations, run, times = _followed(scene, 2)
        seconds = min(integrate(equations, times).step_time for _ in range(20))
        found[inertia] = {
            "force_calls": run.force_calls, "steps": run.steps, "ms": 1e3 * seconds,
            "poles": equations.scene.medium.poles or 0,
        }  # fmt: skip
    return found


# --- told errors ---------------------------------------------------------------------------------


def _told(runs: int, say: Callable[[str], None]) -> Results:
    """Return the commit, and the reported and the true error of the positions of each run."""
    rng = np.random.default_rng(_TOLD_SEED)
    lowest, highest = np.log10([VISCOSITIES[0], VISCOSITIES[-1]])
    found = []
    for index in range(runs):
        viscosity = float(10 ** rng.uniform(lowest, highest))
        if index % 4 == 0:  # the ends of the range too
            viscosity = VISCOSITIES[index // 4 % len(VISCOSITIES)]
        size = 10 ** rng.uniform(-0.4, 0.4)
        start = 0.35e-6 * size * rng.uniform(-1, 1, 3)
        duration = 0.02 * rng.uniform(0.2, 2) * min(viscosity / 1e-3, 20)
        say(f"told error: {viscosity:.2g} Pa s, {size:.2g} um")
        scene = _unscaled(
            "silica-1um",
            medium={"viscosity": f"{viscosity!r} Pa s", "inertia": "memory"},
            optics={"evaluator": "map", "theory": "rays"},
            bead={"diameter": 1e-6 * size},
            start={"position": start.tolist()},
            simulation={"duration": duration, "loss_distance": "20 um"},
        )
        problem, _ = decided(bound_once(scene))
        equations = bind(problem)
        times = np.linspace(0.0, duration, 51)
        run = integrate(equations, times)
        told = error_budget(equations, run, equations.motion(run.times, run.states).position)
        exact = bind(problem.decided(medium={"poles": max(NODES)}))
        true = largest_distance(run.path, integrate(exact, times, tightened=1e-3).path).value
        found.append(
            {"viscosity": viscosity, "poles": equations.scene.medium.poles,
             "true_m": true, "told_m": told.integration_error}
        )  # fmt: skip
    return {"commit": commit(), "runs": found}


# --- thermal steps -------------------------------------------------------------------------------


def _steps(quick: bool, say: Callable[[str], None]) -> list[Results]:
    """Steps of exponential Heun of 128 beads by the map, in turn, the least of repeats."""
    beads, samples, rounds = 128, 3, 3 if quick else 60
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True},
        optics={"evaluator": "map"},
        start={"drawn": "boltzmann"},
        simulation={"method": "heun", "duration": "20 ms", "samples": 101},
    )
    walks = {}
    for poles in STEPS_WITH:
        medium = {"inertia": "memory", "poles": poles} if poles else {"inertia": "none"}
        walks[poles] = walk(scene.replace(medium=medium), 1)
    least = least_step_times(
        walks, beads, samples, rounds, lambda poles: say(f"thermal steps: {poles} poles")
    )
    return [
        {"poles": poles, "step_s": walks[poles].step, "ns": 1e9 * least[poles],
         "times": least[poles] / least[0]}
        for poles in walks
    ]  # fmt: skip
