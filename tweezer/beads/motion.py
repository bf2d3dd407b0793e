"""Runs of several beads: steps, samples, distances and forces, as a dataset."""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from tweezer.beads import many, two
from tweezer.beads.plane import Plane, plane_of
from tweezer.beads.system import System, system
from tweezer.dynamics.timing import timed
from tweezer.optics import evaluators_of, worth_attributes
from tweezer.optics.mutual_scattering import largest_scattered
from tweezer.results.run import Run, Variable, variable
from tweezer.scene import Scene
from tweezer.scene.several import pairs
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, SceneError, warn
from tweezer.values.version import made_by, versions

#: Longest step over the shortest time of relaxation of the forces
_PART = 0.05
#: Relative bias of the variance by a step, over the square of that ratio
_BIAS = -0.26
#: Number of places on the path at which the forces are compared
_PLACES = 33
#: Largest distance of an equilibrium from the start, in radii
_NEAR = 5.0
#: Energy over kT up to which gaps are reached, number of gaps, and smallest one over the radii
_REACHED, _GAPS, _CLOSEST = 10.0, 400, 1e-5
#: Largest number of steps from sample to sample
_MOST_STEPS = 10**8
#: Stiffness below which beads are free, over the largest one
_FLAT = 1e-6
#: Number of samples that are computed at once
_AT_ONCE = 256
#: Factor of the tolerances in the second integration, which gives the error
_FINER = 0.1


@dataclass(frozen=True, eq=False)
class Coupled:
    """Thermal motion of several beads with fixed steps."""

    system: System
    seed: int
    step: float
    """s"""
    per_sample: int
    """number of steps from sample to sample"""
    why: str
    """reason for the step"""
    fastest: float
    """largest relaxation rate that limits the step, 1/s"""
    start: Array
    """(beads, 3) m"""

    @functools.cached_property
    def times(self) -> Array:
        """Times of the samples, s."""
        simulation = self.system.scene.simulation
        return np.linspace(0.0, simulation.duration, simulation.samples)

    @functools.cached_property
    def plane(self) -> Plane:
        """Tables of the step of two beads."""
        return plane_of(self.system.scalars, self.system.kT)

    def advance(self, x: Array, who: Array, sample: int, out: Array) -> None:
        """Advance copies from the sample with a number by the samples of `out`.

        Parameters
        ----------
        x : ndarray, shape (copies, beads, 3)
            Positions at this sample, m; replaced.
        who : ndarray of int64, shape (copies,)
            Numbers of the trajectories.
        sample : int
            Number of the sample.
        out : ndarray, shape (copies, samples, beads, 3)
            Filled with the positions, m.
        """
        first = sample * self.per_sample
        acting = self.system.acting
        if len(self.system.beads) == 2:
            two.advance(
                acting, self.plane, self.seed, self.step, who, first, self.per_sample, x, out
            )
        else:
            fluid = self.system.fluid
            many.advance(
                acting, fluid, self.system.kT, self.seed, self.step, who, first, self.per_sample,
                x, out,
            )  # fmt: skip
        if not np.isfinite(out).all():
            raise IntegrationError(
                f"{self.system.scene.name}: a position is not finite; the step is too long, or a "
                "tether is longer than its law allows; set a smaller simulation.step"
            )
        if self.system.gaps(out).min() <= 0:
            raise IntegrationError(
                f"{self.system.scene.name}: two beads overlap, which began far from each other; "
                "start them within 8 radii of a gap"
            )


def rates(system: System, positions: Array, time: float = 0.0) -> Array:
    """Return the relaxation rates of the forces at positions (beads, 3), m, (3 beads,) 1/s."""
    values = np.linalg.eigvals(system.mobility(positions) @ system.stiffness(positions, time))
    return np.sort(values.real)


def equilibrium(system: System) -> Array:
    """Return positions near the start at which all forces vanish, (beads, 3) m.

    Raises `SceneError` if no stable equilibrium without overlap is found there.
    """
    start = system.start
    check_forces(system)
    size = min(each.radius for each in system.scene.beads)

    def residual(x: Array) -> Array:
        return system.forces((x * size).reshape(1, *start.shape))[0].ravel() / scale

    scale = float(np.abs(system.stiffness(start)).max()) * size or 1.0
    found = root(residual, start.ravel() / size, tol=1e-10)
    place = found.x.reshape(start.shape) * size
    apart = np.linalg.norm(place - start, axis=1).max()
    held = found.success and apart < _NEAR * size and system.gaps(place).min() > 0
    if not held or rates(system, place)[0] <= 0:
        raise SceneError(
            f"{system.scene.name}: no stable equilibrium of the beads near their starts; change "
            "bead[1].start, or set start.drawn to no"
        )
    return place


def check_forces(system: System) -> None:
    """Raise `SceneError` for a force at the start that is not finite, as an overlong chain has."""
    if np.isfinite(system.forces(system.start[None])).all():
        return
    for i, tether in enumerate(system.scene.tether, start=1):
        if tether.contour_length is not None:
            raise SceneError(
                f"tether[{i}].contour_length = {tether.contour_length:g}: a chain is longer at the "
                "start than its law allows; start the beads closer to each other"
            )
    raise SceneError(f"{system.scene.name}: a force at the start is not finite")


def coupled(scene: Scene, seed: int) -> Coupled:
    """Return the thermal motion of the beads of a scene, bound."""
    bound = system(scene)
    check_forces(bound)
    simulation = scene.simulation
    start = equilibrium(bound) if scene.start.drawn == "equilibrium" else bound.start
    course = _course(bound, start)
    fastest = max(
        _diffusion(bound), *(float(rates(bound, x, t)[-1]) for t, x in course),
        *_rates_of_pairs(bound, np.array([x for _, x in course])),
    )  # fmt: skip
    longest, why = _PART / fastest, f"{_PART:g} of the shortest relaxation time"
    if simulation.step is not None:
        longest, why = min((longest, why), (simulation.step, "simulation.step"))
    interval = simulation.duration / (simulation.samples - 1)
    per_sample = max(1, math.ceil(interval / longest * (1 - 1e-12)))
    if per_sample > _MOST_STEPS:
        raise SceneError(
            f"simulation.duration = {simulation.duration:g}: takes {per_sample:.3g} steps from "
            f"sample to sample; allowed: {_MOST_STEPS:g}; use more samples or a shorter duration"
        )
    step = interval / per_sample
    calls = 2 * per_sample * (simulation.samples - 1)
    if calls > simulation.most_force_calls:
        raise SceneError(
            f"simulation.most_force_calls = {simulation.most_force_calls}: the run takes {calls} "
            "force calls; set it to at least this number, or set a shorter duration"
        )
    why = f"steps of {step:.3g} s: {why}"
    return Coupled(bound, seed, step, per_sample, why, fastest, start)


def _course(bound: System, start: Array) -> list[tuple[float, Array]]:
    """Return times, s, and positions (beads, 3), m, on the path of the beads without noise."""
    if bound.steady and not len(bound.acting.laws):
        return [(0.0, start)]
    times = np.linspace(0.0, bound.scene.simulation.duration, _PLACES)
    found = solve_ivp(
        functools.partial(velocities, bound), (0.0, times[-1]), start.ravel(), method="LSODA",
        t_eval=times, rtol=1e-4, atol=1e-9,
    )  # fmt: skip
    if not np.isfinite(found.y).all() or not found.success:
        raise SceneError(
            f"{bound.scene.name}: a force is not finite on the path of the beads; a tether may be "
            "longer than its law allows"
        )
    return [(float(t), y.reshape(start.shape)) for t, y in zip(found.t, found.y.T, strict=True)]


def _rates_of_pairs(bound: System, course: Array) -> list[float]:
    """Return the largest relaxation rate of each pair at gaps that thermal motion may reach, 1/s.

    These gaps begin on the course of the beads, (n, beads, 3) m, and end where the energy of the
    forces between the two beads has increased by `_REACHED` kT.
    """
    found: list[float] = []
    here = bound.gaps(course)
    if not len(bound.acting.laws):
        return found
    for k, (i, j) in enumerate(pairs(len(bound.beads))):
        a, b = bound.acting.radius[i], bound.acting.radius[j]
        low, high = here[:, k].min(), here[:, k].max()
        gaps = np.unique(np.concatenate([
            np.geomspace(_CLOSEST * (a + b), 2 * high + a + b, _GAPS), [low, high],
        ]))  # fmt: skip
        x = np.tile(course[0], (len(gaps), 1, 1))
        x[:, j] = x[:, i] + [[a + b, 0, 0]] + gaps[:, None] * [1, 0, 0]
        pull = bound.tension(x)[:, k]
        known = np.isfinite(pull)
        gaps, pull = gaps[known], pull[known]
        energy = np.concatenate([[0.0], np.cumsum(0.5 * (pull[1:] + pull[:-1]) * np.diff(gaps))])
        most = energy[(gaps >= low) & (gaps <= high)].max() + _REACHED * bound.kT
        first, last = np.searchsorted(gaps, [low, high])
        above = np.flatnonzero(energy > most)
        first = max(above[above < first], default=-1) + 1
        last = min(above[above > last], default=len(gaps))
        mobility = bound.mobility_of_pair(i, j, gaps[first:last])
        slopes = np.abs(np.gradient(pull, gaps))[first:last]
        found.append(float((mobility * slopes).max()))
    return found


def _diffusion(bound: System) -> float:
    """Return the rate at which beads diffuse over a fifth of their radius, 1/s."""
    return max(
        bound.kT / each.drag / (0.2 * bead.radius) ** 2
        for each, bead in zip(bound.beads, bound.scene.beads, strict=True)
    )


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
    method = "heun" if scene.forces.brownian else "scipy:LSODA"
    resolved = scene.decided(
        simulation={"model": "overdamped", "method": method}, medium={"inertia": "none"}
    )
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
    x = motion.start[None].copy()
    found[:, 0] = x
    reached, status, message, began = 1, "complete", "", time.perf_counter()
    try:
        while reached < len(times) and status == "complete":
            last = min(reached + _AT_ONCE, len(times))
            motion.advance(x, np.zeros(1, np.int64), reached - 1, found[:, reached:last])
            lost = first_loss(motion.system, times[reached:last], found[0, reached:last])
            reached = last
            if lost is not None:
                reached, status, message = last - lost[0], "lost", lost[1]
            if progress:
                progress(float(times[reached - 1]))
    except KeyboardInterrupt:
        status, message = "interrupted", f"interrupted at {times[reached - 1]:.6g} s"
    except IntegrationError as error:
        status, message = "failed", str(error)
    slow = motion.step * motion.fastest
    about = {
        "chosen": motion.why, "seed": seed, "step": motion.step, "status": status,
        "message": message, "steps": (reached - 1) * motion.per_sample,
        "force_calls": 2 * (reached - 1) * motion.per_sample,
        "step_time": time.perf_counter() - began, "integration_error": math.nan,
        "variance_bias": _BIAS * slow * slow, "events": "[]",
    }  # fmt: skip
    return motion.system, times[:reached], found[0, :reached], about


def first_loss(bound: System, times: Array, x: Array) -> tuple[int, str] | None:
    """Return how many samples are left from the first at which a bead is lost, and a message.

    A bead is lost if it is farther than `simulation.loss_distance` from every focus. times: (n,) s.
    x: (n, beads, 3) m. Returns None if no bead is lost.
    """
    reach = bound.scene.simulation.loss_distance
    foci = np.stack([bound.foci(t) for t in ([times[0]] if bound.steady else times)])
    apart = np.linalg.norm(x[:, :, None] - foci[:, None], axis=-1).min(axis=2)
    gone = apart > reach
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
    began = time.perf_counter()

    def followed(factor: float) -> Any:
        return solve_ivp(
            functools.partial(velocities, bound), (0.0, simulation.duration), start.ravel(),
            method="LSODA", t_eval=times, rtol=max(factor * simulation.relative_tolerance, 1e-12),
            atol=factor * simulation.position_tolerance,
        )  # fmt: skip

    found = followed(1.0)
    if not found.success:
        raise IntegrationError(f"{scene.name}: {found.message}")
    took = time.perf_counter() - began
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
        "force_calls": int(found.nfev), "step_time": took, "events": "[]",
        "integration_error": float(np.abs(found.y - finer.y).max()) / (1 - _FINER),
    }  # fmt: skip
    return bound, times[: len(x)], x, about


def velocities(bound: System, t: float, x: Array) -> Array:
    """Return the velocities u = M F of the beads at a time, s, and positions (3 beads,), m."""
    place = x.reshape(-1, 3)
    found: Array = bound.mobility(place) @ bound.forces(place[None], t)[0].ravel()
    return found


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
