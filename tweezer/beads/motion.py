"""Runs of several beads: steps, samples, distances and forces, as a dataset."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from tweezer.beads.equilibrium import check_forces, equilibrium, rates, velocities
from tweezer.beads.system import System, system
from tweezer.beads.thermal import coupled, decided
from tweezer.dynamics.timing import timed
from tweezer.optics import evaluators_of, worth_attributes
from tweezer.optics.mutual_scattering import largest_scattered
from tweezer.results.run import Run, Variable, variable
from tweezer.scene import Scene
from tweezer.scene.several import pairs
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, warn
from tweezer.values.version import made_by, versions

#: Stiffness below which beads are free, over the largest one
_FLAT = 1e-6
#: Number of samples that are computed at once
_AT_ONCE = 256
#: Factor of the tolerances in the second integration, which gives the error
_FINER = 0.1


def run_of(scene: Scene, seed: int | None, progress: Callable[[float], None] | None = None) -> Run:
    """Return the run of a scene with several beads.

    Parameters
    ----------
    scene : Scene
        The scene.
    seed : int, optional
        Seed of the thermal motion.
    progress : callable, optional
        Called with the time reached, s.
    """
    given = scene.model_dump_json(exclude_none=True)
    resolved = decided(scene)
    follow = _thermal if scene.forces.brownian else _deterministic
    with timed() as seconds:
        bound, times, x, about = follow(resolved, seed or 0, progress)
    attributes: dict[str, Any] = {
        "title": scene.title,
        "scene": resolved.model_dump_json(exclude_none=True),
        "scene_as_given": given,
        "model": "overdamped",
        "method": resolved.simulation.method,
        "fluid_inertia": "none",
        "force_evaluator": evaluators_of(resolved.alone(1)),
        **worth_attributes(resolved.alone(1)),
        **about,
        **seconds,
        "model_error": inertia_error(bound, x),
        "optical_binding": largest_scattered(resolved, x[0]),
        **versions(),
        **made_by("simulate", dated=True),
    }
    if about["status"] == "failed":
        warn(f"{scene.name}: {about['message']}")
    return Run(*_variables(bound, times, x), attributes)


def inertia_error(bound: System, x: Array) -> float:
    """Return the largest distance by which the inertia of the fluid may change a position, m.

    Vorticity needs the time r^2 rho/mu to the other bead. Within it, the cross mobility is too
    large by about (2/3) r sqrt(omega rho/mu), with the relaxation rate omega of the traps. The
    error is this part, at most 1, of the thermal correlation sqrt(kT/k) mu12/mu11. It is NaN
    without thermal motion, and for beads that no force holds.
    """
    if not bound.scene.forces.brownian:
        return math.nan
    medium, stiffness = bound.scene.medium, bound.stiffness(x[0])
    values = np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T))
    trapped = values[values > _FLAT * np.abs(values).max()]
    if not trapped.size:
        return math.nan
    rate = max(float(rates(bound, x[0])[-1]), 0.0)
    worst = 0.0
    for i, j in pairs(len(bound.beads)):
        r = float(np.linalg.norm(x[0, i] - x[0, j]))
        part = min(1.0, 2 / 3 * r * math.sqrt(rate * medium.density / medium.viscosity))
        size = max(bound.scene.beads[i].radius, bound.scene.beads[j].radius)
        worst = max(worst, part * 1.5 * size / r)
    return worst * math.sqrt(bound.kT / float(trapped.min()))


def _thermal(
    scene: Scene, seed: int, progress: Callable[[float], None] | None
) -> tuple[System, Array, Array, dict[str, Any]]:
    """Return beads, times (n,), positions (n, beads, 3) and attributes of a thermal run."""
    motion = coupled(scene, seed)
    times, beads = motion.times, len(motion.system.beads)
    found = np.empty((1, len(times), beads, 3))
    x = motion.begin[None].copy()
    found[:, 0] = x
    reached, status, message, took = 1, "complete", "", 0.0
    try:
        while reached < len(times) and status == "complete":
            last = min(reached + _AT_ONCE, len(times))
            with timed() as stepping:
                motion.take_steps(x, np.zeros(1, np.int64), reached - 1, found[:, reached:last])
            took += stepping["wall_time"]
            lost = first_loss(motion.system, times[reached:last], found[0, reached:last])
            motion.check(found[0, reached : last - (lost[0] if lost else 0)])
            reached = last
            if lost is not None:
                reached, status, message = last - lost[0], "lost", lost[1]
            if progress:
                progress(float(times[reached - 1]))
    except KeyboardInterrupt:
        status, message = "interrupted", f"interrupted at {times[reached - 1]:.6g} s"
    except IntegrationError as error:
        status, message = "failed", str(error)
    about = {
        "chosen": motion.why, "seed": seed, "step": motion.step, "status": status,
        "message": message, "steps": (reached - 1) * motion.per_sample,
        "force_calls": 2 * (reached - 1) * motion.per_sample,
        "step_time": took, "integration_error": math.nan,
        "variance_bias": motion.variance_bias, "events": "[]",
    }  # fmt: skip
    return motion.system, times[:reached], found[0, :reached], about


def first_loss(bound: System, times: Array, x: Array) -> tuple[int, str] | None:
    """Return how many samples are left from the first at which a bead is lost, and a message.

    times: (n,) s. x: (n, beads, 3) m. Returns None if no bead is lost.
    """
    gone = bound.outside(times, x)
    if not gone.any():
        return None
    first = int(np.argmax(gone.any(axis=1)))
    name = bound.scene.bead_names[int(np.argmax(gone[first]))]
    return len(times) - first, f"bead {name!r} left the trap at {times[first]:.6g} s"


def _deterministic(
    scene: Scene, _: int, progress: Callable[[float], None] | None
) -> tuple[System, Array, Array, dict[str, Any]]:
    """Return beads, times (n,), positions (n, beads, 3) and attributes of a run without noise."""
    bound, simulation = system(scene), scene.simulation
    check_forces(bound)
    start = equilibrium(bound) if scene.start.drawn == "equilibrium" else bound.start
    times = np.linspace(0.0, simulation.duration, simulation.samples)

    def followed(factor: float) -> Any:
        return solve_ivp(
            functools.partial(velocities, bound), (0.0, simulation.duration), start.ravel(),
            method="LSODA", t_eval=times, rtol=max(factor * simulation.relative_tolerance, 1e-12),
            atol=factor * simulation.position_tolerance,
        )  # fmt: skip

    with timed() as stepping:
        found = followed(1.0)
    if not found.success:
        raise IntegrationError(f"{scene.name}: {found.message}")
    finer = followed(_FINER)
    if not finer.success:
        raise IntegrationError(f"{scene.name}: {finer.message}")
    x = found.y.T.reshape(len(found.t), -1, 3)
    status, message = "complete", ""
    if (lost := first_loss(bound, times, x)) is not None:
        status, message = "lost", lost[1]
        x = x[: len(times) - lost[0]]
    if progress:
        progress(simulation.duration)
    about = {
        "chosen": "the mobility of the beads at every position, without inertia",
        "status": status, "message": message, "steps": int(found.nfev),
        "force_calls": int(found.nfev), "step_time": stepping["wall_time"],
        "events": "[]", "integration_error": float(np.abs(found.y - finer.y).max()) / (1 - _FINER),
    }  # fmt: skip
    return bound, times[: len(x)], x, about


def _variables(
    bound: System, times: Array, x: Array
) -> tuple[dict[str, Variable], dict[str, Variable]]:
    """Return coordinates and variables of a run at times (n,), s, and positions (n, beads, 3)."""
    names = bound.scene.bead_names
    both = list(pairs(len(names)))
    between = np.stack([x[:, j] - x[:, i] for i, j in both], axis=1)
    radii = [each.radius for each in bound.scene.beads]
    apart = np.linalg.norm(between, axis=2)
    coordinates: dict[str, Variable] = {
        "time": variable(("time",), times, "s", "time since release"),
        "bead": (("bead",), np.array(names), {"long_name": "name of the bead"}),
        "axis": (("axis",), np.array(["x", "y", "z"]), {"long_name": "axis of the laboratory"}),
        "pair": (
            ("pair",), np.array([f"{names[i]}, {names[j]}" for i, j in both]),
            {"long_name": "names of two beads"},
        ),
    }  # fmt: skip
    light = np.stack(
        [each.field(x[:, k], time=times).force for k, each in enumerate(bound.lights)], axis=1
    )
    variables = {
        "position": variable(
            ("time", "bead", "axis"), x, "m", "position of the bead relative to the origin"
        ),
        "optical_force": variable(("time", "bead", "axis"), light, "N", "force of the light"),
        "distance": variable(("time", "pair"), apart, "m", "distance of the centres"),
        "gap": variable(
            ("time", "pair"), apart - [radii[i] + radii[j] for i, j in both], "m",
            "distance of the surfaces",
        ),
        "force_between": variable(
            ("time", "pair"), bound.tension(x), "N",
            "force between two beads, positive if it pulls them together",
        ),
    }  # fmt: skip
    return coordinates, variables
