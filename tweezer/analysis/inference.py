"""Keys of a scene from recordings of its trapped bead, by maximum likelihood.

The likelihood is that of the Kalman filter (`tweezer.dynamics.filter`): of the whole scene, the
exact force of its light among it, not of a stiffness. So a record tells what the force depends on:
power, size, index, aperture, the height above a wall; as far as it does.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.constants import Boltzmann
from scipy.optimize import brentq, least_squares
from scipy.stats.qmc import Sobol

from tweezer.analysis.profile import LEVEL
from tweezer.analysis.recording import Recording, load_recording
from tweezer.analysis.residuals import p_value
from tweezer.analysis.spectra import TrappedBead
from tweezer.analysis.whittle import Periodogram
from tweezer.dynamics.filter import Bead, Camera, Filtered, kalman_filter
from tweezer.dynamics.models import bind_translation
from tweezer.dynamics.problem import Problem, bound_once
from tweezer.equilibria import nearest_stable
from tweezer.errors import IntegrationError, PhysicsWarning, ResultError, SceneError, UnitWarning
from tweezer.scene import Scene, checked_scene, described_at, value_at, with_settings
from tweezer.units import Quantity

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
#: Information that everything is taken to have, so that its inverse is finite
_FAINT = 1e-6
#: Number of places that the best start is taken from, and how far they reach
_TRIALS, _ABOUT = 16, 0.5
#: Longest distance at which the filter is asked about a place, and largest distance at which its
#: answer is carried on, in that distance
_ASIDE, _CARRIED = 0.2, 3.0
#: Distance of the best place from where the filter was asked, in standard uncertainties, up to
#: which it is not asked again, and the largest number of times that it is
_NEAR, _TIMES = 0.5, 6
#: Tolerance of the end of an interval, in its distance
_END = 0.01
#: Largest relative difference of a camera's rate from that of a record
_UNEVEN = 1e-3
#: Smallest number of relaxation times, of the slowest axis that is seen
_FEW = 50.0
#: Probability of the residuals below which the scene is not that of the record
_IMPROBABLE = 1e-3
#: Change that a key must be told to within, as a factor or in radii, or it is not determined
_DETERMINED = 0.5
#: Change of a key by which a pair that is not told apart is described
_TEN_PER_CENT = math.log(1.1)
#: Relaxation times of inertia, of the bead with its fluid, in a step: faster records show it
_INERTIA = 3.0


@dataclass(frozen=True)
class FittedKey:
    """A key of a scene, as recordings tell it."""

    key: str
    unit: str
    """SI; "" for a number"""
    value: float
    """of the largest likelihood"""
    uncertainty: float | None
    """standard uncertainty: the interval over 3.92; None if `determined` is False"""
    interval: tuple[float | None, float | None]
    """95 % confidence by profile likelihood; None for an end farther off than a factor of 1.65 or
    half a radius"""
    determined: bool
    """whether both ends are told, within a factor of 1.65 or half a radius of the value"""
    profile: tuple[tuple[float, float], ...]
    """values of the key, and least misfit there, -2 log(likelihood), above the least of all"""


@dataclass(frozen=True)
class SceneFit:
    """What recordings tell of a scene, SI."""

    names: tuple[str, ...]
    """of the recordings"""
    scene: Scene
    """with the fitted values"""
    keys: tuple[FittedKey, ...]
    log_likelihood: float
    """of the coordinates seen, in m: to compare fits to the same recordings"""
    frames: int
    p_value: float
    """how probable residuals are that are as far from white, of the size that the scene says"""
    statement: str
    """what the recordings tell, in words"""

    def __getitem__(self, key: str) -> FittedKey:
        return next(each for each in self.keys if each.key == key)

    def __repr__(self) -> str:
        """In short: what is told."""
        return f"<SceneFit of {', '.join(self.names)}: {self.statement}>"


def fit(
    recordings: Recording | xr.Dataset | str | Path | Sequence[Recording | str | Path],
    scene: Scene | None = None,
    *,
    free: Sequence[str],
    progress: Callable[[float], None] | None = None,
) -> SceneFit:
    """Values of keys of a scene from recordings of its bead at rest in the trap.

    recordings: one or several, of the same scene, or what `load_recording` takes; of x, of x and y,
    or of all three axes. scene: bead, medium, light, and `camera` for exposure and noise; for a run
    of ours its own if not given. free: keys of the scene, such as "bead.diameter", "beam.power",
    "medium.viscosity", "camera.noise"; the scene has the first guesses. progress: called with the
    part done, 0 to 1.

    Assumed: the bead is in equilibrium in the trap throughout; the place of the trap in the record
    is not known, so that the mean of each coordinate is taken from it; the bead has no inertia;
    without a camera, positions are exact and at once, but for the exposure and noise that the
    record has of itself. The start has Boltzmann's distribution. The motion goes by the scene's
    force wherever the bead is.

    The misfit is -2 log(likelihood) of the filter. It differs little from that of the spectra of a
    bead with the scene's stiffness and drag at its equilibrium (P. Whittle, Ark. Mat. 2, 423
    (1953)), which costs next to nothing. So what is minimised is that of the spectra and the
    difference of both, which is measured at a place and to both sides of it along each principal
    direction of the misfit, and taken as a parabola along each; and is measured again where the
    minimum turns out to be, until it stays. The minimum is found by Gauss's and Newton's steps in
    the logarithms of the keys, or in radii for a key that is not positive, from the best of 17
    places about the guesses, up to a factor of 5 or 5 radii from them. The interval of a key holds
    its values whose least misfit over the other keys is less than 3.84 above the least (S. S.
    Wilks, Ann. Math. Stat. 9, 60 (1938)). Keys that the likelihood does not tell apart are named.
    The p-value is that of `tweezer.fit_depth`.

    Raises `ResultError` for what `load_recording` refuses, without a scene, for voltages, for a
    camera of another rate, and where no bead is trapped; `SceneError` for keys that are no
    quantities of the scene, and for light that changes in time.
    """
    loaded = _loaded(recordings)
    scene = loaded[0].scene if scene is None else checked_scene(scene)
    if scene is None:
        raise ResultError(f"{loaded[0].name}: needs a scene")
    free = (free,) if isinstance(free, str) else tuple(free)
    misfit = _Misfit(loaded, scene, free)
    tell = progress or (lambda _: None)
    best = misfit.best(lambda part: tell(0.4 * part))
    found: list[FittedKey] = []
    for i in range(len(free)):
        tell(0.4 + 0.6 * i / len(free))
        found.append(_Interval(misfit, best, i).found())
    paths = misfit.filtered(best.at)
    p = min(len(paths) * min(p_value(path, sized=True) for path in paths), 1.0)
    tell(1.0)
    return SceneFit(
        tuple(each.name for each in loaded), misfit.scene(best.at), tuple(found),
        sum(path.log_likelihood for path in paths),
        sum(len(each.times) for each in loaded), p,
        "; ".join(misfit.told(best, found, p)),
    )  # fmt: skip


def _loaded(recordings: Any) -> list[Recording]:
    several = isinstance(recordings, Sequence) and not isinstance(recordings, str)
    loaded = [
        each if isinstance(each, Recording) else load_recording(each)
        for each in (recordings if several else [recordings])
    ]
    if not loaded:
        raise ResultError("recordings: must be one or more")
    for each in loaded:
        if each.unit != "m":
            raise ResultError(
                f"{each.name}: in volts: a scene is fitted to metres; calibrate it first, or give "
                "the scale"
            )
    return loaded


class _Key:
    """A free key, and its place on a line: a logarithm, or in radii where it is not positive."""

    def __init__(self, scene: Scene, key: str) -> None:
        quantity, _ = described_at(key)
        value = value_at(scene, key)
        if quantity is None or isinstance(value, bool | str):
            raise SceneError(f"free = {key!r}: is not a quantity that can be fitted")
        if not isinstance(value, int | float):
            raise SceneError(f"free = {key!r}: the scene has no value of it to begin with")
        self.key, self.given, self.quantity = key, float(value), quantity
        self.logarithmic = quantity.low >= 0
        if self.logarithmic and value <= 0:
            raise SceneError(f"free = {key!r}: must have a first guess above 0 in the scene")
        self.unit = 1.0
        if not self.logarithmic:
            self.unit = scene.bead.radius if quantity.unit == "m" else abs(self.given) or 1.0

    def value(self, q: float) -> float:
        """In SI."""
        if self.logarithmic:
            return self.given * math.exp(q)
        return self.given + self.unit * q

    def place(self, value: float) -> float:
        if self.logarithmic:
            return math.log(value / self.given)
        return (value - self.given) / self.unit

    @property
    def bounds(self) -> tuple[float, float]:
        """Of the place: what a scene allows, and not farther than `_REACH`."""
        reach = math.log(_REACH) if self.logarithmic else _REACH
        low, high = self.quantity.low, self.quantity.high
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


class _Difference:
    """How the filter's misfit less that of the spectra changes about a place."""

    def __init__(
        self, of: Callable[[Array], float], centre: Array, directions: Array, bounds: Array
    ) -> None:
        """directions: (n, n), in rows, as long as the distances at which it is measured."""
        self._centre, self._inverse = centre, np.linalg.inv(directions)
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
        t = np.clip((q - self._centre) @ self._inverse, -_CARRIED, _CARRIED)
        return float(self._slopes @ t + self._curvatures @ t**2 / 2)

    def distance(self, q: Array) -> float:
        """Of a place from the centre, in the distances of the measurement."""
        return float(np.abs((q - self._centre) @ self._inverse).max())


def _within(centre: Array, direction: Array, bounds: Array) -> float:
    """The part of a direction, up to 1, that does not leave the bounds."""
    ends = np.where(direction > 0, bounds[:, 1], bounds[:, 0])
    moved = direction != 0
    return float(min(1.0, *((ends - centre)[moved] / direction[moved])))


class _Misfit:
    """-2 log(likelihood) of recordings over the places of the free keys."""

    def __init__(self, recordings: Sequence[Recording], scene: Scene, free: Sequence[str]) -> None:
        if not free:
            raise SceneError("free: nothing to fit; name one or more keys of the scene")
        for key in free:
            if list(free).count(key) > 1:
                raise SceneError(f"free = {key!r}: given more than once")
        self._scene, self._recordings = _with_camera(scene, recordings), recordings
        self.keys = [_Key(self._scene, key) for key in free]
        self.bounds = np.array([each.bounds for each in self.keys])
        self._seen = [_seen(each) for each in recordings]
        self._spectra = [
            ("xyz".index(axis), Periodogram.of(positions, each.step))
            for each in recordings
            for axis, positions in zip(each.axes, each.positions.T, strict=True)
        ]
        self._difference: _Difference | None = None
        self._latest: tuple[tuple[float, ...], _Bound | str] | None = None
        begin = self._bound(tuple([0.0] * len(free)))
        if isinstance(begin, str):
            raise ResultError(f"{scene.name}: {begin}; change its first guesses")
        if not begin.problem.force.steady:
            raise SceneError("beam: a scene is fitted whose forces do not change in time")

    def scene(self, q: Array) -> Scene:
        """The scene at a place."""
        settings = {key.key: key.setting(at) for key, at in zip(self.keys, q, strict=True)}
        return with_settings(self._scene, settings)

    def _bound(self, q: tuple[float, ...]) -> _Bound | str:
        """What filters recordings in the scene at a place, or why there is nothing to filter."""
        if self._latest is None or self._latest[0] != q:
            self._latest = q, self._bind(q)
        return self._latest[1]

    def _bind(self, q: tuple[float, ...]) -> _Bound | str:
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
            return "the light holds no bead"
        stiffness = np.array(place.stiffness)
        stiffness = (stiffness + stiffness.T) / 2
        kT = Boltzmann * scene.medium.temperature
        spread = np.sqrt(kT * np.diag(np.linalg.inv(stiffness)))
        mobility = problem.mobilities(np.array([place.position]))[0, :3]
        bead = Bead(scene.bead.radius, 1.0, kT, np.array(place.position), spread, np.zeros(3), 0.0)
        return _Bound(
            scene, problem, bead, np.diag(stiffness), 1 / mobility,
        )  # fmt: skip

    def filtered(self, q: Array) -> list[Filtered]:
        """The recordings as the filter sees them.

        Raises `IntegrationError` where there is no trap, or the motion cannot be followed.
        """
        bound = self._bound(tuple(q.tolist()))
        if isinstance(bound, str):
            raise IntegrationError(bound)
        camera = bound.scene.camera
        assert camera is not None
        out = []
        for recording, seen in zip(self._recordings, self._seen, strict=True):
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
        bound = self._bound(tuple(np.clip(q, *self.bounds.T).tolist()))
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

    def best(self, progress: Callable[[float], None]) -> _Least:
        """The least, from the best of several places; nearer and nearer to that of the filter."""
        n = len(self.keys)
        trials = _ABOUT * (2 * Sobol(n, scramble=False).random(_TRIALS) - 1)
        places = [np.zeros(n), *(np.clip(trial, *self.bounds.T) for trial in trials)]
        found = self.least(min(places, key=lambda q: float((self(q) ** 2).sum())))
        for time in range(_TIMES):
            progress((time + 1) / (_TIMES + 1))
            sizes, directions = np.linalg.eigh(found.information)
            lengths = np.minimum(1 / np.sqrt(np.maximum(sizes, 1e-12)), _ASIDE)
            self._difference = _Difference(
                self._above_the_spectra, found.at, (directions * lengths).T, self.bounds
            )
            found = self.least(found.at)
            if self._difference.distance(found.at) < _NEAR:
                break
        else:
            found = found._replace(converged=False)
        progress(1.0)
        return found

    def least(self, begin: Array, fixed: int | None = None) -> _Least:
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
            return _Least(begin, float((self(begin) ** 2).sum()), np.zeros((0, 0)), True)
        low, high = self.bounds[free].T
        found = least_squares(
            lambda values: self(whole(values)), np.clip(begin[free], low, high), slopes,
            bounds=(low, high), x_scale="jac", ftol=_GAIN, xtol=_SHORT, gtol=None, max_nfev=50,
        )  # fmt: skip
        return _Least(
            whole(found.x), 2 * float(found.cost), found.jac.T @ found.jac, found.status > 0
        )

    def told(self, best: _Least, found: Sequence[FittedKey], p: float) -> list[str]:
        """What the recordings tell, in words; first of all what they do not."""
        lines = []
        lost = [each.key for each in found if not each.determined]
        if not best.converged:
            lines.append("the fit has not converged: nothing of it is to be trusted")
        elif lost:
            lines.append(f"the record does not determine {' and '.join(lost)}")
            lines += self._degenerate(best, lost)
        else:
            lines.append(f"the record determines {' and '.join(each.key for each in found)}")
        low, high = self.bounds.T
        at_ends = [key.key for key, q, a, b in zip(self.keys, best.at, low, high, strict=True)
                   if q <= a or q >= b]  # fmt: skip
        if at_ends:
            lines.append(f"{' and '.join(at_ends)} at an end of what was tried")
        bound = self._bound(tuple(best.at.tolist()))
        assert not isinstance(bound, str)
        axes = max(seen.shape[1] for seen in self._seen)
        slowest = float((bound.drag / bound.stiffness)[:axes].max())
        length = sum(each.step * len(each.times) for each in self._recordings)
        if length < _FEW * slowest:
            lines.append(f"only {length / slowest:.2g} relaxation times: intervals are too short")
        momentum_time = bound.problem.bead.mass / float(bound.drag[0])
        if min(each.step for each in self._recordings) < _INERTIA * momentum_time:
            lines.append("its steps are as short as the bead's inertia lasts, which is left out")
        if p < _IMPROBABLE:
            lines.append(
                f"the residuals are not those of the scene (p = {p:.1g}): what is not free in it "
                "is not that of the record, or its noise or exposure"
            )
        return lines

    def _degenerate(self, best: _Least, lost: Sequence[str]) -> list[str]:
        """The combination of keys that changes the likelihood least, where two are not told."""
        sizes, directions = np.linalg.eigh(best.information)
        direction = directions[:, 0]
        involved = [i for i, key in enumerate(self.keys) if key.key in lost]
        if len(involved) < 2 or sizes[0] > 1 / _DETERMINED**2:
            return []
        first = max(involved, key=lambda i: abs(direction[i]))
        others = [i for i in np.argsort(-np.abs(direction)) if i != first]
        others = [i for i in others if abs(direction[i]) > 0.1 * abs(direction[first])]
        if not others:
            return []
        step = _TEN_PER_CENT / direction[first] * direction
        with_it = " and ".join(self.keys[i].change(step[i]) for i in others)
        return [f"{self.keys[first].change(step[first])} with {with_it} fits as well"]


class _Least(NamedTuple):
    """A minimum of the misfit."""

    at: Array
    """(n,) place"""
    value: float
    information: Array
    """(free, free): half the second derivatives of the misfit, by the slopes of the deviances"""
    converged: bool


@dataclass(frozen=True)
class _Bound:
    """A scene with a trap."""

    scene: Scene
    problem: Problem
    bead: Bead
    stiffness: Array
    """(3,) N/m, along the axes, where the bead rests"""
    drag: Array
    """(3,) kg/s, there"""


class _Interval:
    """The interval of a key by the least misfit over the others."""

    def __init__(self, misfit: _Misfit, best: _Least, index: int) -> None:
        self._misfit, self._best, self._index = misfit, best, index
        self._low, self._high = misfit.bounds[index]
        covariance = np.linalg.inv(best.information + _FAINT * np.eye(len(best.at)))
        variance = float(covariance[index, index])
        self._spread = math.sqrt(variance)
        # where the others go with it
        self._along = covariance[:, index] / variance
        self._known: dict[float, float] = {float(best.at[index]): 0.0}

    def found(self) -> FittedKey:
        key, at = self._misfit.keys[self._index], float(self._best.at[self._index])
        ends = [self._end(at, way) for way in (-1.0, 1.0)]
        low, high = (None if end is None else key.value(end) for end in ends)
        determined = low is not None and high is not None and self._best.converged
        quantity: Quantity = key.quantity
        return FittedKey(
            key.key, quantity.unit, key.value(at),
            (high - low) / 3.92 if determined and low is not None and high is not None else None,
            (low, high), determined,
            tuple((key.value(q), rise) for q, rise in sorted(self._known.items())),
        )  # fmt: skip

    def _rise(self, q: float) -> float:
        """Square root of the least misfit with the key there, above the least of all."""
        if q not in self._known:
            begin = self._best.at + self._along * (q - self._best.at[self._index])
            begin = np.clip(begin, *self._misfit.bounds.T)
            begin[self._index] = q
            least = self._misfit.least(begin, self._index)
            self._known[q] = least.value - self._best.value
        return math.sqrt(max(self._known[q], 0.0))

    def _end(self, at: float, way: float) -> float | None:
        """Where the misfit has risen by 3.84, None if it does not up to `_DETERMINED`."""
        limit = float(np.clip(at + way * _DETERMINED, self._low, self._high))
        level = math.sqrt(LEVEL)
        inner, outer, step = at, at, level * self._spread
        while outer != limit:
            inner, outer = outer, at + way * min(step, way * (limit - at))
            if self._rise(outer) > level:
                break
            step *= 1.6
        else:
            return None

        def above(q: float) -> float:
            return min(self._rise(q), 10 * level) - level

        return float(brentq(above, inner, outer, xtol=_END * abs(outer - at), rtol=1e-12))


def _seen(recording: Recording) -> Array:
    """(n, 2 or 3) m, about the mean; NaN along an axis that the record does not have."""
    axes = "xyz" if "z" in recording.axes else "xy"
    seen = np.full((len(recording.times), len(axes)), np.nan)
    for axis, positions in zip(recording.axes, recording.positions.T, strict=True):
        seen[:, axes.index(axis)] = positions - positions.mean()
    return seen


def _with_camera(scene: Scene, recordings: Sequence[Recording]) -> Scene:
    """The scene with the camera of the recordings, if it has none of its own.

    Raises `ResultError` where its camera is not that of a record.
    """
    for each in recordings:
        rate = 1 / each.step
        if scene.camera is not None and abs(scene.camera.rate / rate - 1) > _UNEVEN:
            raise ResultError(
                f"{each.name}: {rate:.6g} frames a second, and camera.rate = "
                f"{scene.camera.rate:g}: must be the same"
            )
    with_z = any("z" in each.axes for each in recordings)
    camera: dict[str, Any] = {}
    if scene.camera is None:
        first = recordings[0]
        noise = dict(zip(first.axes, first.noise or [0.0] * len(first.axes), strict=True))
        camera = {"rate": 1 / first.step, "exposure": first.exposure or 0.0}
        camera["noise"] = max((value for axis, value in noise.items() if axis != "z"), default=0.0)
        if with_z:
            camera["noise_along"] = noise.get("z", 0.0)
    elif with_z and scene.camera.noise_along is None:
        raise ResultError(
            "camera.noise_along: missing: the record has z, which the scene's camera does not see"
        )
    with warnings.catch_warnings(action="ignore", category=UnitWarning):
        return scene.replace(camera=camera) if camera else scene
