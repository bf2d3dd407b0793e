"""How badly scenes fit recordings: -2 log(likelihood) over the free keys of a scene."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import Boltzmann
from scipy.optimize import least_squares
from scipy.stats.qmc import Sobol

from tweezer.analysis.recording import Recording
from tweezer.analysis.spectra import TrappedBead
from tweezer.analysis.whittle import Periodogram
from tweezer.dynamics.filter import Bead, Camera, Filtered, kalman_filter
from tweezer.dynamics.models import bind_translation
from tweezer.dynamics.problem import Problem, bound_once
from tweezer.equilibria import nearest_stable
from tweezer.errors import IntegrationError, PhysicsWarning, ResultError, SceneError, UnitWarning
from tweezer.scene import Scene, described_at, value_at, with_settings
from tweezer.units import RefractiveIndex, quantity_of

Array = NDArray[np.float64]

#: Largest factor between a value that is tried and the scene's, or largest distance in radii
_REACH = 5.0
#: Difference of a place for slopes, in a logarithm or in radii
_DIFFERENCE = 1e-3
#: Relative gain of the misfit, which is about 1000, and step of the place, at which a search ends
_GAIN, _SHORT = 1e-5, 1e-4
#: Deviance where there is no trap
_HOPELESS = 1e4
#: Misfit added to the change of a difference, so that its root is a residual
_OFFSET = 1e3
#: Number of places that the best start is taken from, and how far they reach
_TRIALS, _ABOUT = 16, 0.5
#: Longest distance at which the filter is asked about a place; farther off its answer stays
_ASIDE = 0.2
#: Standard uncertainty along a direction above which it is not asked: nothing is told there
_VAGUE = 0.25
#: Distance of the best place from where the filter was asked, in those at which it was, up to which
#: it is not asked again, and the largest number of times that it is
_NEAR, _TIMES = 0.25, 6
#: Keys that the motion of a bead at rest in the trap depends on
_FITTED = re.compile(
    r"(bead|medium|lens|beam(\[\d+\])?|wall|forces)\..+|camera\.(exposure|noise|noise_along)"
)
#: Largest relative difference of a camera's rate from that of a record
_UNEVEN = 1e-3


class FreeKey:
    """A free key, and its place on a line: a logarithm, or in radii where it is not positive."""

    def __init__(self, scene: Scene, key: str) -> None:
        quantity, _ = described_at(key)
        value = value_at(scene, key)
        if quantity is None and key.endswith("refractive_index") and not isinstance(value, str):
            quantity = quantity_of(RefractiveIndex)  # of a bead that does not absorb
        if quantity is None or isinstance(value, bool | str):
            raise SceneError(f"free = {key!r}: is not a quantity that can be fitted")
        if not _FITTED.fullmatch(key):
            raise SceneError(
                f"free = {key!r}: tells nothing of a bead at rest in the trap; allowed: keys of "
                "bead, medium, lens, beam, wall and forces, and camera.exposure, camera.noise and "
                "camera.noise_along"
            )
        if not isinstance(value, int | float):
            raise SceneError(f"free = {key!r}: the scene has no value of it to begin with")
        self.key, self.given, self.quantity = key, float(value), quantity
        self.logarithmic = quantity.low >= 0
        if self.logarithmic and value <= 0:
            raise SceneError(f"free = {key!r}: must have a first guess above 0 in the scene")
        self._most = math.inf
        if key == "camera.exposure" and scene.camera is not None:
            self._most = 1 / scene.camera.rate
        self.unit = 1.0
        if not self.logarithmic:
            self.unit = scene.bead.radius if quantity.unit == "m" else abs(self.given) or 1.0

    def value(self, q: float) -> float:
        """In SI."""
        if self.logarithmic:
            return self.given * math.exp(q)
        return float(self.given + self.unit * q)

    def place(self, value: float) -> float:
        """Of a value in SI."""
        if self.logarithmic:
            return math.log(value / self.given)
        return (value - self.given) / self.unit

    @property
    def reach(self) -> float:
        """Largest distance from the first guess."""
        return math.log(_REACH) if self.logarithmic else _REACH

    @property
    def bounds(self) -> tuple[float, float]:
        """Of the place: what a scene allows, and not farther than `reach`."""
        reach = self.reach
        low, high = self.quantity.low, min(self.quantity.high, self._most)
        lowest = -math.inf if self.logarithmic and low <= 0 else self.place(low)
        return max(lowest, -reach), min(self.place(high), reach)

    def change(self, step: float) -> str:
        """A step of the place, in words."""
        if self.logarithmic:
            part = math.expm1(step)
            return f"{100 * abs(part):.2g} % {'more' if part > 0 else 'less'} {self.key}"
        return f"{self.key} {'+' if step > 0 else '-'} {abs(self.unit * step):.2g}"

    def setting(self, q: float) -> str:
        """The value as `with_settings` takes it."""
        return f"{self.value(q)!r} {self.quantity.unit}".rstrip()


class Difference:
    """How the filter's misfit less that of the spectra changes about a place."""

    def __init__(
        self, of: Callable[[Array], float], centre: Array, directions: Array, bounds: Array
    ) -> None:
        """directions: (d, n), orthogonal, as long as the distances at which it is measured."""
        self._centre = centre
        self._along = directions / (directions**2).sum(axis=1, keepdims=True)
        here = of(centre)
        if not math.isfinite(here):
            raise IntegrationError("the motion cannot be followed")
        slopes, curvatures = [], []
        for direction in directions:
            sides = []
            for way in (-1.0, 1.0):
                t = way * _within(centre, way * direction, bounds)
                sides.append((t, of(centre + t * direction) - here))
            (a, below), (b, above) = sides
            if not (a < 0 < b and math.isfinite(below) and math.isfinite(above)):
                usable = [(t, rise) for t, rise in sides if t and math.isfinite(rise)]
                slopes.append(usable[0][1] / usable[0][0] if usable else 0.0)
                curvatures.append(0.0)
                continue
            # the parabola t (slope + curvature t/2) through both
            slopes.append((below / a * b - above / b * a) / (b - a))
            curvatures.append(2 * (above / b - below / a) / (b - a))
        self._slopes, self._curvatures = np.array(slopes), np.array(curvatures)

    def __call__(self, q: Array) -> float:
        """At a place, above that at the centre."""
        t = np.clip(self._along @ (q - self._centre), -1.0, 1.0)
        return float(self._slopes @ t + self._curvatures @ t**2 / 2)

    def distance(self, q: Array) -> float:
        """Of a place from the centre, in the distances of the measurement."""
        return float(np.abs(self._along @ (q - self._centre)).max(initial=0.0))


def _within(centre: Array, direction: Array, bounds: Array) -> float:
    """The part of a direction, up to 1, that does not leave the bounds."""
    ends = np.where(direction > 0, bounds[:, 1], bounds[:, 0])
    moved = direction != 0
    return float(min(1.0, *((ends - centre)[moved] / direction[moved])))


class Least(NamedTuple):
    """A minimum of the misfit."""

    at: Array
    """(n,) place"""
    value: float
    information: Array
    """(free, free): half the second derivatives of the misfit, by the slopes of the deviances"""
    converged: bool


@dataclass(frozen=True)
class Bound:
    """A scene with a trap."""

    scene: Scene
    problem: Problem
    bead: Bead
    stiffness: Array
    """(3,) N/m, along the axes, where the bead rests"""
    drag: Array
    """(3,) kg/s, there"""


class Misfit:
    """-2 log(likelihood) of recordings over the places of the free keys."""

    def __init__(self, recordings: Sequence[Recording], scene: Scene, free: Sequence[str]) -> None:
        if not free:
            raise SceneError("free: nothing to fit; name one or more keys of the scene")
        for key in free:
            if list(free).count(key) > 1:
                raise SceneError(f"free = {key!r}: given more than once")
        self._scene, self.recordings = _with_camera(scene, recordings, free), recordings
        self.keys = [FreeKey(self._scene, key) for key in free]
        self.bounds = np.array([each.bounds for each in self.keys])
        self.seen = [_seen(each) for each in recordings]
        self._spectra = [
            ("xyz".index(axis), Periodogram.of(positions, each.step))
            for each in recordings
            for axis, positions in zip(each.axes, each.positions.T, strict=True)
        ]
        self._difference: Difference | None = None
        self._latest: tuple[tuple[float, ...], Bound | str] | None = None
        begin = self.bound(tuple([0.0] * len(free)))
        if isinstance(begin, str):
            raise ResultError(f"{scene.name}: {begin}")
        if not begin.problem.force.steady:
            raise SceneError("beam: a scene is fitted whose forces do not change in time")

    def scene(self, q: Array) -> Scene:
        """The scene at a place."""
        settings = {key.key: key.setting(at) for key, at in zip(self.keys, q, strict=True)}
        return with_settings(self._scene, settings)

    def bound(self, q: tuple[float, ...]) -> Bound | str:
        """What filters recordings in the scene at a place, or why there is nothing to filter."""
        if self._latest is None or self._latest[0] != q:
            self._latest = q, self._bind(q)
        return self._latest[1]

    def _bind(self, q: tuple[float, ...]) -> Bound | str:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnitWarning)
            warnings.simplefilter("ignore", PhysicsWarning)
            try:
                scene = self.scene(np.array(q))
                problem = bound_once(scene)
            except SceneError as error:
                return str(error)
        place = nearest_stable(problem.equilibria(problem.net_force_apart))
        if place is None:
            return "the light holds no bead; change the first guesses"
        stiffness = np.array(place.stiffness)
        stiffness = (stiffness + stiffness.T) / 2
        kT = Boltzmann * scene.medium.temperature
        spread = np.sqrt(kT * np.diag(np.linalg.inv(stiffness)))
        mobility = problem.mobilities(np.array([place.position]))[0, :3]
        bead = Bead(scene.bead.radius, 1.0, kT, np.array(place.position), spread, np.zeros(3), 0.0)
        return Bound(
            scene, problem, bead, np.diag(stiffness), 1 / mobility,
        )  # fmt: skip

    def filtered(self, q: Array) -> list[Filtered]:
        """The recordings as the filter sees them.

        Raises `IntegrationError` where there is no trap, or the motion cannot be followed.
        """
        bound = self.bound(tuple(q.tolist()))
        if isinstance(bound, str):
            raise IntegrationError(bound)
        camera = bound.scene.camera
        assert camera is not None
        out = []
        for recording, seen in zip(self.recordings, self.seen, strict=True):
            noise = np.array([*camera.noises, camera.noise][: seen.shape[1]])
            out.append(
                kalman_filter(bind_translation(bound.problem, "overdamped"))(
                    bound.bead,
                    Camera(
                        recording.times - recording.times[0],
                        seen + bound.bead.start[: seen.shape[1]], noise, 0.0,
                        min(camera.exposure, recording.step),
                    ),
                )
            )  # fmt: skip
        return out

    def _deviances(self, q: Array) -> Array:
        """Roots of twice the likelihood ratio of each ordinate of the spectra to the best one.

        Of a bead in a linear force; their squares add up to the misfit. Out of reach where there is
        no trap.
        """
        bound = self.bound(tuple(np.clip(q, *self.bounds.T).tolist()))
        if isinstance(bound, str):
            return np.full(sum(each.counts.size for _, each in self._spectra), _HOPELESS)
        camera = bound.scene.camera
        assert camera is not None
        deviances = []
        for axis, spectrum in self._spectra:
            bead = TrappedBead(
                bound.stiffness[axis], bound.drag[axis], bound.scene.medium.temperature,
                exposure=min(camera.exposure, spectrum.step),
                noise=(*camera.noises, camera.noise)[axis],
            )  # fmt: skip
            ratio = spectrum.density / spectrum.expected(bead)
            above = np.maximum(ratio - 1 - np.log(ratio), 0.0)
            deviances.append(np.sign(ratio - 1) * np.sqrt(2 * spectrum.counts * above))
        return np.concatenate(deviances)

    def __call__(self, q: Array) -> Array:
        """What is least in its sum of squares: deviances, and the difference of the filter's."""
        deviances = self._deviances(q)
        if self._difference is None:
            return deviances
        return np.append(deviances, math.sqrt(max(_OFFSET + self._difference(q), 0.0)))

    def _above_the_spectra(self, q: Array) -> float:
        squares = float((self._deviances(q) ** 2).sum())
        try:
            return -2 * sum(each.log_likelihood for each in self.filtered(q)) - squares
        except IntegrationError:
            return math.inf

    def best(self, progress: Callable[[float], None]) -> Least:
        """The least, from the best of several places; nearer and nearer to that of the filter."""
        n = len(self.keys)
        trials = _ABOUT * (2 * Sobol(n, scramble=False).random(_TRIALS) - 1)
        places = [np.zeros(n), *(np.clip(trial, *self.bounds.T) for trial in trials)]
        found = self.least(min(places, key=lambda q: float((self(q) ** 2).sum())))
        for time in range(_TIMES):
            progress((time + 1) / (_TIMES + 1))
            sizes, directions = np.linalg.eigh(found.information)
            told = sizes > 1 / _VAGUE**2
            lengths = np.minimum(2 / np.sqrt(sizes[told]), _ASIDE)
            self._difference = Difference(
                self._above_the_spectra, found.at, (directions[:, told] * lengths).T, self.bounds
            )
            found = self.least(found.at)
            if self._difference.distance(found.at) < _NEAR:
                break
        else:
            found = found._replace(converged=False)
        progress(1.0)
        return found

    def least(self, begin: Array, fixed: int | None = None) -> Least:
        """The least that Gauss's and Newton's steps reach, with all keys free but `fixed`."""
        free = np.arange(len(begin)) != fixed

        def whole(values: Array) -> Array:
            q = begin.copy()
            q[free] = values
            return q

        def slopes(values: Array) -> Array:
            here, q = self(whole(values)), whole(values)
            high = self.bounds[:, 1]
            columns = []
            for i in np.flatnonzero(free):
                step = _DIFFERENCE if q[i] + _DIFFERENCE < high[i] else -_DIFFERENCE
                aside = q.copy()
                aside[i] += step
                columns.append((self(aside) - here) / step)
            return np.stack(columns, axis=1)

        if not free.any():
            return Least(begin, float((self(begin) ** 2).sum()), np.zeros((0, 0)), True)
        low, high = self.bounds[free].T
        found = least_squares(
            lambda values: self(whole(values)), np.clip(begin[free], low, high), slopes,
            bounds=(low, high), x_scale="jac", ftol=_GAIN, xtol=_SHORT, gtol=None, max_nfev=50,
        )  # fmt: skip
        return Least(
            whole(found.x), 2 * float(found.cost), found.jac.T @ found.jac, found.status > 0
        )


def _seen(recording: Recording) -> Array:
    """(n, 2 or 3) m, about the mean; NaN along an axis that the record does not have."""
    axes = "xyz" if "z" in recording.axes else "xy"
    seen = np.full((len(recording.times), len(axes)), np.nan)
    for axis, positions in zip(recording.axes, recording.positions.T, strict=True):
        seen[:, axes.index(axis)] = positions - positions.mean()
    return seen


def _with_camera(scene: Scene, recordings: Sequence[Recording], free: Sequence[str]) -> Scene:
    """The scene with the camera of the recordings, if it has none of its own.

    Raises `ResultError` where its camera is not that of a record.
    """
    if scene.camera is None:
        first = recordings[0]
        noise = dict(zip(first.axes, first.noise or [0.0] * len(first.axes), strict=True))
        camera = {"rate": 1 / first.step, "exposure": first.exposure or 0.0}
        camera["noise"] = max((value for axis, value in noise.items() if axis != "z"), default=0.0)
        if any("z" in each.axes for each in recordings):
            camera["noise_along"] = noise.get("z", 0.0)
        with warnings.catch_warnings(action="ignore", category=UnitWarning):
            scene = scene.replace(camera=camera)
    assert scene.camera is not None
    for each in recordings:
        if "z" in each.axes and scene.camera.noise_along is None:
            raise ResultError(
                "camera.noise_along: missing: the record has z, which the scene's camera does not "
                "see"
            )
        known = {"rate": 1 / each.step, "exposure": each.exposure}
        if each.noise is not None:
            names = ["noise_along" if axis == "z" else "noise" for axis in each.axes]
            known |= dict(zip(names, each.noise, strict=True))
        for name, value in known.items():
            own = getattr(scene.camera, name)
            agrees = value is None or math.isclose(value, own, rel_tol=_UNEVEN)
            if not agrees and f"camera.{name}" not in free:
                raise ResultError(
                    f"{each.name}: its camera has {name} = {value:.6g}, and the scene, or another "
                    f"record, {own:.6g}: must be the same"
                )
    return scene
