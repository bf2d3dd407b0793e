"""Camera images of a motion: positions averaged over exposures, with detector noise."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.brownian import noise
from tweezer.dynamics.brownian.exposure import (
    DETECTOR,
    OF_A_STEP,
    OF_THE_TIME,
    ROWS,
    expose,
)
from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.path import Path
from tweezer.dynamics.problem import Problem
from tweezer.fluid import Modes
from tweezer.scene import Scene
from tweezer.scene.sections import Camera
from tweezer.values.arrays import Array

Integers = NDArray[np.int64]

#: Relative rounding of the time of a frame
_ROUNDING = 1e-12
#: Nodes and weights of Gauss's rule on the interval from -1 to 1
_GAUSS = np.polynomial.legendre.leggauss(4)
#: Nodes on the interval from 0 to 1
_NODES = (_GAUSS[0] + 1) / 2
#: Their weights
_WEIGHTS = _GAUSS[1] / 2
#: Steps that are looked at for a camera, in times between frames
_LOOKED_AT = (1e-9, 1e3)


@dataclass(frozen=True)
class Frames:
    """The frames of a camera that are exposed within a run."""

    camera: Camera
    duration: float
    """duration of the run, s"""

    @classmethod
    def of(cls, scene: Scene) -> Frames | None:
        """Return the frames of a scene's camera; None without a camera."""
        return None if scene.camera is None else cls(scene.camera, scene.simulation.duration)

    @functools.cached_property
    def opens(self) -> Array:
        """Times at which the exposures begin, (frames,) s."""
        left = self.duration - self.camera.exposure
        count = int(left * self.camera.rate * (1 + _ROUNDING)) + 1
        return np.minimum(np.arange(count) / self.camera.rate, left)

    @functools.cached_property
    def closes(self) -> Array:
        """Times at which the exposures end, (frames,) s."""
        return np.minimum(self.opens + self.camera.exposure, self.duration)

    @property
    def times(self) -> Array:
        """Times of the middle of each exposure, (frames,) s."""
        return (self.opens + self.closes) / 2

    def numbers(self, seed: int, trajectory: int, first: int, last: int) -> Array:
        """Return normal random numbers (ROWS, last - first) of some frames.

        Parameters
        ----------
        seed : int
            Seed of the run.
        trajectory : int
            Index of the trajectory.
        first, last : int
            First frame, and the frame after the last one.
        """
        drawn = np.empty((ROWS, last - first))
        noise.normals(seed, np.arange(first, last), trajectory, noise.CAMERA, drawn)
        return drawn

    def seen(self, path: Path, seed: int) -> tuple[Array, Array]:
        """Return times (n,), s, and recorded positions (n, axes), m, of the frames that end within
        `path`.
        """
        count = int(np.searchsorted(self.closes, path.end * (1 + _ROUNDING), side="right"))
        opens, closes = (np.minimum(each[:count], path.end) for each in (self.opens, self.closes))
        exposed = self.camera.exposure > 0
        places = _averaged(path, opens, closes) if exposed else path.positions(opens)
        axes = len(self.camera.axes)
        drawn = self.numbers(seed, 0, 0, count)[DETECTOR][:axes].T
        return self.times[:count], places[:, :axes] + np.array(self.camera.noises) * drawn


def _averaged(path: Path, opens: Array, closes: Array) -> Array:
    """Return the mean positions (n, 3), m, from times opens[i] to closes[i], s.

    Gauss quadrature is applied to each part of a step, because the path is smooth within steps
    only.
    """
    ends = np.unique(np.concatenate([path.checkpoints, opens, closes]))
    begins, lengths = ends[:-1], np.diff(ends)
    frame = np.searchsorted(opens, begins, side="right") - 1
    exposed = (frame >= 0) & (begins < closes[np.maximum(frame, 0)])
    begins, lengths, frame = begins[exposed], lengths[exposed], frame[exposed]
    times = begins[:, None] + lengths[:, None] * _NODES
    places = path.positions(times.ravel()).reshape(*times.shape, 3)
    parts = lengths[:, None] * np.einsum("j,ijk->ik", _WEIGHTS, places)
    sums = np.zeros((len(opens), 3))
    np.add.at(sums, frame, parts)
    return sums / (closes - opens)[:, None]


@dataclass(frozen=True)
class Exposure:
    """Exposure of a camera for beads that move in steps (`tweezer.dynamics.brownian.exposure`).

    Between two steps h the mean path is curved: it deviates from a straight line by u kappa s (h -
    s)/2 at the time s, with the slow velocity u and kappa = stiffness over drag. With the Brownian
    bridge these are the first terms, in kappa h, of the exact bridge of an Ornstein-Uhlenbeck
    process.
    """

    frames: Frames
    problem: Problem
    step: float
    """length of a step, s"""
    diffusion: Array
    """(3,) m^2/s, short-time diffusion within a step, where the mobility is `mobility`"""
    mobility: Array
    """(3,) s/kg"""
    kappa: Array
    """(3,) 1/s, trap stiffness over drag"""
    spring: Array | None
    """(3,) m, centre of a spring that replaces the force; None if the force acts"""

    def closed(self, steps: int) -> int:
        """Return the number of frames whose exposure has ended after a number of steps."""
        return _ended(self.frames.closes, steps, self.step) if steps else 0

    def expose(
        self, seed: int, trajectories: Integers, steps: int, places: Array, held: Array
    ) -> Array:
        """Return the recorded positions, (n, frames, axes) m, in the frames that end within some
        steps.

        Parameters
        ----------
        seed : int
            Seed of the run.
        trajectories : ndarray of int, shape (n,)
            Indices of the trajectories, which select the random numbers together with `seed`.
        steps : int
            Number of steps before the first position.
        places : ndarray, shape (n, m + 1, 3)
            Positions after `steps` steps and after each of the next m, m.
        held : ndarray, shape (n, HELD)
            Integrals of the frame being exposed, updated in place.
        """
        frames, last = self.frames, steps + places.shape[1] - 1
        first, done = self.closed(steps), self.closed(last)
        begun = _ended(frames.opens, last, self.step)
        numbers = np.empty((len(trajectories), ROWS, begun - first))
        for one, trajectory in zip(numbers, trajectories, strict=True):
            one[:] = frames.numbers(seed, int(trajectory), first, begun)
        means = np.empty((len(trajectories), begun - first, 3))
        expose(
            steps, self.step, frames.opens[first:begun], frames.closes[first:begun], places,
            self._diffusion(places), numbers, held, means,
        )  # fmt: skip
        means = means[:, : done - first]
        means += self._bend(means, slice(first, done))
        axes = len(frames.camera.axes)
        drawn = numbers[:, DETECTOR, : done - first][:, :axes].transpose(0, 2, 1)
        return means[..., :axes] + np.array(frames.camera.noises) * drawn

    def _diffusion(self, places: Array) -> Array:
        """Return the diffusion by bead, step and axis, m^2/s; one bead and step for a uniform drag.

        places: (n, m + 1, 3) m, at the ends of m steps.
        """
        if self.problem.drag.uniform:
            return self.diffusion[None, None]
        begins = places[:, :-1].reshape(-1, 3)
        there = np.isfinite(begins).all(axis=1)
        found = np.zeros_like(begins)
        found[there] = self.problem.mobilities(begins[there])[:, TRANSLATION] / self.mobility
        return (self.diffusion * found).reshape(len(places), -1, 3)

    def _bend(self, means: Array, which: slice) -> Array:
        """Return the change of mean positions (n, frames, 3), m, by the curvature of the path
        within steps.

        which: frames to which `means` belongs.
        """
        times = np.tile(self.frames.times[which], len(means))
        places = means.reshape(-1, 3)
        there = np.isfinite(places).all(axis=1)
        velocity = np.zeros_like(places)
        if self.spring is not None:
            velocity = -self.kappa * (places - self.spring)
        elif self.kappa.any() and there.any():
            force = self.problem.field(places[there], time=times[there]).force
            slow = self.problem.mobilities(places[there], times[there])[:, TRANSLATION]
            velocity[there] = slow * (force + np.array(self.problem.bead.weight))
        by = bend(self.step, self.frames.opens[which], self.frames.closes[which])
        return self.kappa * by[:, None] * velocity.reshape(means.shape)


def bend(h: float, opens: Array, closes: Array) -> Array:
    """Return the means of s (h - s)/2 over exposures, s^2.

    s is the time since the last step, and h the length of the steps, s. opens, closes: (frames,)
    times at which exposures begin and end, s.
    """
    before, after = (np.floor(times / h) for times in (opens, closes))
    s, t, width = opens - before * h, closes - after * h, closes - opens

    def until(s: Array) -> Array:
        """Return the integral of s (h - s)/2 from 0 to s."""
        return s**2 * h / 4 - s**3 / 6

    whole = (after - before) * h**3 / 12 + until(t) - until(s)
    return np.where(width > 0, whole / np.where(width > 0, width, 1.0), s * (h - s) / 2)


def at_short_times(h: float, diffusion: Array, modes: Modes) -> Array:
    """Return the mean squared displacement of a free bead in a time h (s), divided by 2 h, m^2/s.

    diffusion: D, m^2/s. modes: modes of its velocity. Used as D of the Brownian bridge between
    steps, it gives a bead the same variance within a step as at its ends.
    """
    late = modes.weights * modes.times * np.expm1(-h / modes.times)
    return np.asarray(diffusion * (1 + late.sum() / h))


def longest_step(camera: Camera, modes: Modes, error: float) -> float:
    """Longest step by which the frames of a bead with inertia move as the bead does, s.

    The Brownian bridge within a step does not depend on the earlier motion, so its variance is too
    large. Let 1 - delta be the ratio of `at_short_times` to D, W the exposure and P the time
    between frames. The error of the mean squared displacement between frames is then at most delta
    h/P min(h/W, 1/2). This bound holds for the exact covariances of path and bridge, of beads of 1
    and 3 um in water, P from 50 us to 1 ms, and W from P/20 to P.

    Parameters
    ----------
    camera : Camera
    modes : Modes
        Modes of the bead's velocity.
    error : float
        Largest relative error of this displacement.
    """
    from scipy.optimize import brentq

    def off(logarithm: float) -> float:
        """Return the error of the displacement between frames, less the allowed one.

        logarithm: log of the step in intervals between frames.
        """
        frames = math.exp(logarithm)
        h = frames / camera.rate
        delta = 1 - float(at_short_times(h, np.ones(1), modes)[0])
        exposures = h / camera.exposure if camera.exposure else math.inf
        return delta * frames * min(exposures, 0.5) - error

    shortest, longest = map(math.log, _LOOKED_AT)
    if off(longest) <= 0:
        return math.inf
    return math.exp(brentq(off, shortest, longest)) / camera.rate


def _ended(times: Array, steps: int, step: float) -> int:
    """Return how many of the ascending times, s, have passed after a number of steps, up to
    rounding.
    """
    now = steps * step
    return int(np.searchsorted(times, now + (OF_A_STEP * step + OF_THE_TIME * now), side="right"))
