"""Thermal motion of several beads with fixed steps, for runs and ensembles."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tweezer.beads import many, two
from tweezer.beads.equilibrium import check_forces, equilibrium, rates, velocities
from tweezer.beads.plane import Plane, plane_of
from tweezer.beads.system import System, system
from tweezer.dynamics.layout import Layout
from tweezer.scene import Scene
from tweezer.scene.several import pairs
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, SceneError

#: Longest step over the shortest time of relaxation of the forces
_PART = 0.05
#: Relative bias of the variance by a step, over the square of that ratio
_BIAS = -0.26
#: Number of places on the path at which the forces are compared
_PLACES = 33
#: Energy over kT up to which gaps are reached, number of gaps, and smallest one over the radii
_REACHED, _GAPS, _CLOSEST = 10.0, 400, 1e-5
#: Largest number of steps from sample to sample
_MOST_STEPS = 10**8


@dataclass(frozen=True, eq=False)
class Coupled:
    """Thermal motion of several beads with fixed steps.

    The state of a copy contains the positions of its beads, m. Its last number is the time at which
    a bead was first lost, s, which is infinite before. Random numbers are functions of the seed,
    the number of the trajectory and the number of the step.
    """

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
    begin: Array
    """(beads, 3) m"""
    exposure = None
    """exposure of a camera, which several beads do not have"""
    others = ()
    """forces of the user, which several beads do not have"""

    @property
    def scene(self) -> Scene:
        """Scene, with its model and method decided."""
        return self.system.scene

    @functools.cached_property
    def shown(self) -> Layout:
        """Layout of a sample."""
        return Layout({"position": 3}, bodies=len(self.system.beads))

    @property
    def variance_bias(self) -> float:
        """Approximate relative error of the variance of a position due to the step."""
        return _BIAS * (self.step * self.fastest) ** 2

    @property
    def loss_caveat(self) -> str:
        """Caveat on the times of losses."""
        return "beads are looked for at the samples only, so losses are late by up to an interval"

    @property
    def origin(self) -> tuple[float, ...]:
        """Position of the beads at the start, one after the other, m."""
        return tuple(self.begin.ravel())

    @functools.cached_property
    def reach(self) -> float:
        """Distance from the origin along an axis within which beads are not lost, m."""
        foci = np.concatenate([self.system.foci(t) for t in (self.times[0], self.times[-1])])
        return self.scene.simulation.loss_distance + float(np.abs([*foci, *self.begin]).max())

    @functools.cached_property
    def times(self) -> Array:
        """Times of the samples, s."""
        simulation = self.scene.simulation
        return np.linspace(0.0, simulation.duration, simulation.samples)

    @functools.cached_property
    def plane(self) -> Plane:
        """Tables of the step of two beads."""
        return plane_of(self.system.scalars, self.system.kT)

    @property
    def coefficients(self) -> tuple[Any, ...]:
        """Numbers from which the steps are computed, without addresses of this process."""
        _, *acting = self.system.acting
        tables = self.plane if len(self.system.beads) == 2 else self.system.fluid
        return (*acting, *tables, self.system.kT, self.begin)

    def start(self, trajectories: NDArray[np.int64]) -> Array:
        """Return the states of trajectories at the start, (n, 3 beads + 1)."""
        state = [*self.begin.ravel(), math.inf]
        return np.tile(state, (len(trajectories), 1))

    def seen(self, states: Array) -> Array:
        """Return the positions in states, (n, beads, 3) m."""
        return states[:, :-1].reshape(len(states), *self.shown.shape)

    def lost(self, states: Array) -> Array:
        """Return the times at which the first bead of each copy was lost, (n,) s."""
        return states[:, -1]

    def frames(self, _: int) -> int:
        """Return the number of camera frames before a sample: none."""
        return 0

    def before_mirror(self, samples: Array) -> NDArray[np.int64]:
        """Return the numbers of samples (n, s, ...) before beads reach a mirror: all."""
        return np.full(len(samples), samples.shape[1])

    def filmed(
        self, states: Array, trajectories: NDArray[np.int64], sample: int, out: Array
    ) -> Array:
        """Advance as `advance`, and return the camera frames (n, 0, 0): several beads have none.

        Parameters
        ----------
        states, trajectories, sample, out
            As in `advance`.
        """
        self.advance(states, trajectories, sample, out)
        return np.empty((len(states), 0, 0))

    def advance(
        self, states: Array, trajectories: NDArray[np.int64], sample: int, out: Array
    ) -> None:
        """Advance copies from a sample, in place.

        Parameters
        ----------
        states : ndarray, shape (n, 3 beads + 1)
            States at this sample; replaced.
        trajectories : ndarray of int64, shape (n,)
            Numbers of the trajectories.
        sample : int
            Number of the sample.
        out : ndarray, shape (n, samples, beads, 3)
            Filled with the positions, m, NaN once a bead of the copy is lost.

        Raises
        ------
        IntegrationError
            If a position is not finite, or if two beads overlap.
        """
        held = np.flatnonzero(np.isinf(self.lost(states)))
        out[:] = np.nan
        if not held.size:
            return
        x, found = self.seen(states[held]), np.empty((len(held), *out.shape[1:]))
        self.take_steps(x, trajectories[held], sample, found)
        times = self.times[sample + 1 : sample + 1 + out.shape[1]]
        gone = np.asarray(self.system.outside(times, found).any(axis=2))
        after = np.maximum.accumulate(gone, axis=1)
        self.check(found[~after])
        found[after] = np.nan
        out[held] = found
        states[held, :-1] = x.reshape(len(held), -1)
        lost = gone.any(axis=1)
        states[held[lost], -1] = times[gone[lost].argmax(axis=1)]

    def take_steps(self, x: Array, who: NDArray[np.int64], sample: int, out: Array) -> None:
        """Advance positions from a sample, in place, without a search for losses.

        Parameters
        ----------
        x : ndarray, shape (copies, beads, 3)
            Positions at this sample, m; replaced.
        who : ndarray of int64, shape (copies,)
            Numbers of the trajectories.
        sample : int
            Number of the sample.
        out : ndarray, shape (copies, samples, beads, 3)
            Filled with the positions after it, m.
        """
        first, step = sample * self.per_sample, self.step
        acting = self.system.acting
        if len(self.system.beads) == 2:
            two.advance(acting, self.plane, self.seed, step, who, first, self.per_sample, x, out)
        else:
            fluid, kT = self.system.fluid, self.system.kT
            many.advance(acting, fluid, kT, self.seed, step, who, first, self.per_sample, x, out)

    def check(self, x: Array) -> None:
        """Raise `IntegrationError` unless positions (n, beads, 3), m, are finite and apart."""
        if not np.isfinite(x).all():
            raise IntegrationError(
                f"{self.scene.name}: a position is not finite; the step is too long, or a "
                "tether is longer than its law allows; set a smaller simulation.step"
            )
        if len(x) and self.system.gaps(x).min() <= 0:
            raise IntegrationError(
                f"{self.scene.name}: two beads overlap, which began far from each other; "
                "start them within 8 radii of a gap"
            )


def decided(scene: Scene) -> Scene:
    """Return a scene of several beads with its model and method decided."""
    method = "heun" if scene.forces.brownian else "scipy:LSODA"
    return scene.decided(
        simulation={"model": "overdamped", "method": method}, medium={"inertia": "none"}
    )


def coupled(scene: Scene, seed: int) -> Coupled:
    """Return the thermal motion of the beads of a scene, bound."""
    bound = system(decided(scene))
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
