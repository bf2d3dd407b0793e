"""The thesis's search for its scaling factor a2 (4.12): cost and error of each a2."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tweezer.dynamics import Integration, bind, bound_once, integrate
from tweezer.dynamics.budget import TIGHTER, same_steps
from tweezer.dynamics.models import RATE_TIME
from tweezer.dynamics.path import largest_distance
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.values.errors import SceneError, TweezerError
from tweezer.values.printed import printed, with_error
from tweezer.values.rounding import time_taken
from tweezer.values.shown import Card, Row, Shown, Table

#: Number of factors a2 per decade, from epsilon to 1, if none are given
_PER_DECADE = 3


@dataclass(frozen=True)
class Tuned:
    """Cost and error of a run of the scaled model (4.17) with one scaling factor."""

    scaling_factor: float
    """a2; the scaled model divides the inertia of the bead by it, and 1 scales nothing"""
    deviation: float | None
    """largest distance between the scaled and the unscaled bead at equal times, m, from the dense
    output of both runs; None if the run failed"""
    deviation_error: float | None
    """error of `deviation`, m, from a second integration of both with tighter tolerances; None if
    one of these runs failed, or if the tolerances do not change the steps"""
    steps: int
    """number of integration steps"""
    force_calls: int
    """number of evaluations of the force"""
    seconds: float
    """run time, s, compiled"""

    @property
    def off(self) -> str:
        """Deviation and its error in words, in micrometres, or "failed"."""
        if self.deviation is None:
            return "failed"
        return with_error(self.deviation, self.deviation_error, "um")


@dataclass(frozen=True, repr=False)
class Tuning(Shown):
    """Cost and error of the scaled model for several scaling factors, compared with the unscaled
    one.
    """

    entries: list[Tuned]
    """by descending scaling factor"""
    duration: float
    """time of the comparison, s"""
    method: str
    """method of the scaled runs"""
    epsilon: float
    """m/beta_v (4.6) in the thesis's unit of time, 1 ms: its first guess of a2"""
    unscaled: Tuned
    """the unscaled equations by the exponential method"""

    def card(self) -> Card:
        """Return the card with the first guess epsilon, the range of the factors, and the table."""
        last, *_, first = sorted(self.entries, key=lambda each: each.scaling_factor)
        failed = sum(each.deviation is None for each in self.entries)
        return Card(
            "Tuning", "",
            (
                Row("compared over", f"{printed(self.duration, 'ms')}, by {self.method}"),
                Row("epsilon", f"{self.epsilon:.3g}"),
                Row(
                    "scaling factors a2",
                    f"{len(self.entries)}, {first.scaling_factor:.3g} to {last.scaling_factor:.3g}",
                    f"{failed} failed" if failed else "",
                ),
                *(
                    Row(f"off the unscaled bead, a2 = {each.scaling_factor:.3g}", each.off)
                    for each in (first, last)
                ),
            ),
            (self.table(),),
        )  # fmt: skip

    def table(self) -> Table:
        """Return a table with a row for each scaling factor, and one for the unscaled equations."""
        headings = ("a2", "off the unscaled bead", "steps", "force calls", "time")
        rows = tuple(
            (
                "unscaled" if each is self.unscaled else f"{each.scaling_factor:.3g}", each.off,
                f"{each.steps}", f"{each.force_calls}", time_taken(each.seconds),
            )
            for each in [*self.entries, self.unscaled]
        )  # fmt: skip
        return Table(headings, rows)

    def most_scaling_within(self, deviation: float) -> Tuned | None:
        """Return the entry with the smallest a2 whose deviation is small enough.

        Parameters
        ----------
        deviation : float
            Largest allowed deviation from the unscaled bead, m.

        Returns
        -------
        Tuned or None
            The entry; None if all deviate more.
        """
        within = [
            entry
            for entry in self.entries
            if entry.deviation is not None and entry.deviation <= deviation
        ]
        return min(within, key=lambda entry: entry.scaling_factor, default=None)


def tune(
    scene: SceneLike,
    factors: Sequence[float] | None = None,
    *,
    duration: float | None = None,
    method: str = "dormand-prince",
    progress: Callable[[float], None] | None = None,
) -> Tuning:
    """Compare the scaled model (4.17) with the unscaled equations for several scaling factors a2.

    The unscaled equations are integrated by the exponential method. Both motions are computed in a
    fluid without inertia, as in the thesis, regardless of the scene's `medium.inertia`. Each is
    integrated again with a sixteenth of the tolerances, and the distance between the two solutions
    is its error. The tolerances determine the steps, regardless of the scene's step.

    Parameters
    ----------
    scene : Scene or str or Path
        Scene with equal moments of inertia, which the exponential method requires, or its name or
        file.
    factors : sequence of float, optional
        Scaling factors a2, 1e-12 to 1. Default: from epsilon to 1.
    duration : float, optional
        Time of the comparison, s. Default: the scene's. The thesis compares over a short time.
    method : str, optional
        Method of the scaled runs. Default: the thesis's, Dormand-Prince.
    progress : callable, optional
        Called with the finished fraction.

    Returns
    -------
    Tuning
        Cost and error of each scaling factor.

    Raises
    ------
    SceneError
        For a factor out of range, or a scene with unequal moments of inertia.

    Examples
    --------
    >>> tuning = tweezer.tune("thesis-990nm", [1.0, 0.01], duration=1e-4)
    >>> [entry.scaling_factor for entry in tuning.entries]
    [1.0, 0.01]
    """
    scene = checked_scene(scene).replace(medium={"inertia": "none", "poles": None})
    if scene.bead.shape != "sphere":
        raise SceneError(
            f"bead.shape = {scene.bead.shape!r}: models and methods are compared for spheres; "
            "allowed: 'sphere'"
        )
    if duration is not None:
        scene = scene.replace(simulation={"duration": duration})
    scenes = scaled_scenes(scene, factors, method)
    same = {"scaling_factor": None, "step": None, "rotation_state": "angular-velocity"}
    exact = _response(scene.replace(simulation={"model": "full", "method": "exponential", **same}))
    if exact.run.path is None:
        raise TweezerError(f"{scene.name}: the unscaled response could not be integrated")
    entries = []
    for changed in scenes:
        entries.append(_tuned(changed.simulation.scaling_factor or 1.0, _response(changed), exact))
        if progress:
            progress(len(entries) / len(scenes))
    unscaled = Tuned(1.0, 0.0, exact.error, exact.run.steps, exact.run.force_calls, exact.seconds)
    return Tuning(entries, scene.simulation.duration, method, _epsilon(scene), unscaled)


def scaled_scenes(scene: Scene, factors: Sequence[float] | None, method: str) -> list[Scene]:
    """Return the scenes that `tune` compares with the unscaled one, in descending order of a2.

    `method` integrates them. Raises `SceneError` if one of them is not valid.
    """
    if factors is None:
        first = min(max(_epsilon(scene), 1e-12), 0.1)
        factors = np.geomspace(1.0, first, math.ceil(-math.log10(first) * _PER_DECADE) + 1).tolist()
    scaled = {"model": "scaled", "method": method, "step": None}
    return [
        scene.replace(
            simulation={"scaling_factor": factor, "rotation_state": "angular-velocity", **scaled}
        )
        for factor in sorted(factors, reverse=True)
    ]


def _epsilon(scene: Scene) -> float:
    """Return epsilon (4.6): the velocity relaxation time m/beta_v in the thesis's unit of time."""
    return bound_once(scene).relaxation_time / RATE_TIME


@dataclass(frozen=True)
class _Response:
    """A run without thermal motion from the release, with its cost."""

    run: Integration
    error: float | None
    """largest distance from the run with tighter tolerances, m; None if not known"""
    seconds: float
    """wall-clock time of the run, s"""


def _response(scene: Scene) -> _Response:
    """Integrate a scene and measure the time; repeat with tighter tolerances for the error."""
    equations = bind(scene)
    times = np.array([0.0, scene.simulation.duration])
    _uninterrupted(integrate(equations, times * 1e-3))  # compiles, untimed
    began = time.perf_counter()
    run = _uninterrupted(integrate(equations, times, most_held=sys.maxsize))
    seconds = time.perf_counter() - began
    if run.path is None:
        return _Response(run, None, seconds)
    tighter = integrate(equations, times, tightened=TIGHTER, most_held=sys.maxsize)
    path, error = _uninterrupted(tighter).path, None
    if path is not None and not same_steps(run, tighter):
        error = largest_distance(run.path, path).value
    return _Response(run, error, seconds)


def _uninterrupted(run: Integration) -> Integration:
    """Return the run, or raise `KeyboardInterrupt` if Ctrl-C interrupted it."""
    if run.status == "interrupted":
        raise KeyboardInterrupt
    return run


def _tuned(factor: float, response: _Response, exact: _Response) -> Tuned:
    """Return the cost of the scaled response with a2 = `factor`, and its distance from `exact`.

    `exact` is the response of the unscaled equations. The error is the sum of both integration
    errors and the error of the distance itself.
    """
    run, deviation, error = response.run, None, None
    assert exact.run.path is not None
    if run.path is not None:
        found = largest_distance(run.path, exact.run.path)
        deviation = found.value
        if response.error is not None and exact.error is not None:
            error = found.error + response.error + exact.error
    return Tuned(factor, deviation, error, run.steps, run.force_calls, response.seconds)
