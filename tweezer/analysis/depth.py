"""The coordinate that a camera does not see: where along the light a bead started.

The motion in the plane depends on where along the light the bead is, for the force does; so a track
(t, x, y) of a bead that falls into the trap tells where it started: the thesis's aim.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.constants import Boltzmann
from scipy.optimize import OptimizeResult, brentq, minimize, minimize_scalar
from scipy.special import chdtrc

from tweezer.analysis.recording import Track, load_track
from tweezer.bead import bead_properties
from tweezer.dynamics.filter import Bead, Camera, Filtered, kalman_filter
from tweezer.errors import ResultError
from tweezer.optics import light
from tweezer.scene import Scene

Array = NDArray[np.float64]

#: 95 % of chi-square with one degree of freedom: what the misfit may be above its least
LEVEL = 3.841458820694124
#: probability that a coordinate is a number from anywhere
_OUTLIERS = 0.01
#: m, of the noise of a camera
_NOISE = (1e-10, 1e-6)
#: places of the scan; range it has if none is given, and the table, in radii
_PLACES, _SEARCH, _TABLE = 121, 15.0, 20.0
#: misfit above the best from which on the noise is not fitted anew
_HOPELESS = 40.0
#: misfit between neighbours near the least from which on there should be a place between them; how
#: often a step of the scan is halved for that, and how many places there may be more
_JUMP, _HALVINGS, _MORE = 2 * LEVEL, 5, 80
#: calls of the likelihood in a fit, for each number that is fitted and one more
_CALLS = 20
#: misfit that is next to nothing, against `LEVEL`
_NOTHING = 0.1
#: in units of what is fitted: step of a derivative, and of a second one
_STEP, _WIDE_STEP = 1e-2, 3e-2
#: frames from which the start is guessed, and how wide the guess is, in steps between them
_FIRST, _GUESS = 7, 4.5
#: lags at which residuals should not be correlated, and how improbable they may be
_LAGS, _IMPROBABLE = 10, 1e-3


class _Free(NamedTuple):
    """A quantity that may be fitted besides the depth, as value = given * exp(fitted)."""

    unit: str
    reach: float
    """largest |fitted|"""


#: what else may be fitted
FREE = {
    "power": _Free("W", math.log(4)),
    "radius": _Free("m", math.log(2)),
    "scaling_factor": _Free("", math.log(1e4)),
    "release": _Free("s", math.inf),
}


@dataclass(frozen=True)
class Minimum:
    """A start that fits better than those about it."""

    z: float
    """m"""
    misfit: float
    """-2 log(likelihood), above the least"""


@dataclass(frozen=True)
class Parameter:
    """What was fitted besides the depth."""

    name: str
    """"noise", "power" (through the pupil), "radius", "scaling_factor" or "release\""""
    value: float
    uncertainty: float | None
    """standard uncertainty, by the curvature of the likelihood; None where that tells nothing, at
    an end of its range or, of the noise, above the value"""
    unit: str


@dataclass(frozen=True)
class DepthFit:
    """Where along the light a bead started, SI; z from the focus, along the light."""

    name: str
    """of the track"""
    scene: str
    z: float
    """m, of the largest likelihood"""
    intervals: tuple[tuple[float, float], ...]
    """m, 95 % confidence by profile likelihood: as many pieces as there are"""
    determined: bool
    """whether that is one piece, shorter than half the search, that does not meet its ends, of a
    profile without jumps about it, and the residuals are white"""
    statement: str
    """what the track tells, in words"""
    minima: tuple[Minimum, ...]
    """of the misfit, best first"""
    noise: float
    """m, standard deviation of a coordinate, given or fitted"""
    parameters: tuple[Parameter, ...]
    search: tuple[float, float]
    """m"""
    start_time: float
    """s, of the first frame with both coordinates: z is where the bead was then"""
    frames: int
    outliers: int
    """coordinates that are rather not the bead's"""
    p_value: float
    """how probable residuals are that are as far from white"""
    profile: tuple[tuple[float, float], ...]
    """z, m, and least misfit with the start there"""
    path: Filtered
    """at the best fit"""


def fit_depth(
    source: Track | xr.Dataset | str | Path,
    scene: Scene | None = None,
    *,
    noise: float | None = None,
    search: tuple[float, float] | None = None,
    fit: Sequence[str] = (),
    progress: Callable[[float], None] | None = None,
) -> DepthFit:
    """The start in z of a bead from a track of x and y, by maximum likelihood.

    source: a track, or what `load_track` takes. scene: bead, medium and light; for a run of ours
    its own if not given. noise: standard deviation of a coordinate, m; fitted if not given. search:
    where the start may be, m from the focus; 15 radii to both sides if not given. fit: what else is
    not known: "power", "radius", "scaling_factor" (a2 of the scaled model), "release" (the time up
    to which the bead is held where it starts; the first frame if not fitted). progress: called with
    the part done, 0 to 1.

    Assumed of the track: x and y are from the axis of the light, frames have no duration, the noise
    is white and the same in both coordinates, and the scene is known but for what is fitted. The
    bead starts with the scene's velocity if the scene's model is `scaled` (4.17); with any other it
    goes without inertia (5.2), which moves it by less than a camera sees. The force is that of the
    map, made to 20 radii; of the quadrature for linear polarisation.

    The likelihood is that of a Kalman filter (`tweezer.dynamics.filter`), for thermal motion adds
    up: residuals about the motion without it are not independent. The filter takes the force as
    linear over the spread of where the bead may be; once that spread passes about a radius, as it
    can with the inertia of the scaled model, the likelihood means little, and the statement says
    so. x and y of the start are averaged over. A coordinate may be a number from anywhere: to its
    density is added 0.01 over the length that the track extends over (`Camera.outliers`).

    The misfit is least over what else is fitted at 121 places of the search, within its minima, and
    at up to 80 places more where it jumps near the least by more than 7.7 from one to the next,
    down to 1/32 of a step; the interval holds the starts whose misfit is less than 3.84 above the
    least (S. S. Wilks, Ann. Math. Stat. 9, 60 (1938)), so it may be in several pieces or open. It
    is not taken to determine z if such a jump is left at an end of it, if a fit near it has not
    converged, or if the p-value is below 0.001. The p-value is of the correlations of the residuals
    (G. M. Ljung and G. E. P. Box, Biometrika 65, 297 (1978)), and of their size where the noise is
    given.

    Raises `ResultError` for what `load_track` refuses, without a scene, for a noise, a search or a
    name in `fit` that is none; `IntegrationError` where the motion cannot be followed.
    """
    track = source if isinstance(source, Track) else load_track(source)
    scene = track.scene if scene is None else scene
    if scene is None:
        raise ResultError(f"{track.name}: needs a scene")
    if search is None:
        search = (-_SEARCH * scene.bead.radius, _SEARCH * scene.bead.radius)
    _refuse(track, scene, noise, search, fit)
    likelihood = _Likelihood(track, scene, noise, fit)

    profile = _Profile(likelihood, search, progress)
    profile.polish()
    profile.refine((search[1] - search[0]) / (_PLACES - 1) / 2**_HALVINGS)
    at, values = profile.places, profile.values - profile.values.min()
    i = int(values.argmin())
    best, optimum = float(at[i]), profile.nuisances[i]
    intervals = tuple(_below(at, values, profile.above))
    path = likelihood.filtered(best, optimum)
    parameters = tuple(likelihood.parameters(best, optimum))
    p_value = _p_value(path, sized=noise is not None)
    doubts = _doubts(scene.bead.radius, profile, path, p_value)
    (low, high), *more = intervals
    open_end = low <= search[0] or intervals[-1][1] >= search[1]
    determined = (
        not more and not open_end and high - low < (search[1] - search[0]) / 2
        and not any(doubt.refuses for doubt in doubts)
    )  # fmt: skip
    minima = [Minimum(float(at[i]), float(values[i])) for i in profile.lowest]
    return DepthFit(
        track.name, scene.name, best, intervals, determined,
        _statement(best, intervals, search, determined, parameters, doubts),
        tuple(sorted(minima, key=lambda each: each.misfit)), likelihood.noise(optimum),
        parameters, search, float(track.times[0]), len(track.times),
        int((path.weights < 0.5).sum()), p_value,
        tuple(zip(at.tolist(), values.tolist(), strict=True)), path,
    )  # fmt: skip


def _refuse(
    track: Track,
    scene: Scene,
    noise: float | None,
    search: tuple[float, float],
    fit: Sequence[str],
) -> None:
    low, high = search
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise ResultError(f"search = {low:g} to {high:g} m: must go from a z to a larger one")
    if noise is not None and not _NOISE[0] <= noise <= _NOISE[1]:
        raise ResultError(f"noise = {noise:g} m: must be from {_NOISE[0]:g} to {_NOISE[1]:g} m")
    if isinstance(fit, str):
        raise ResultError(f"fit = {fit!r}: must be a list of names")
    for name in fit:
        if name not in FREE:
            raise ResultError(f"fit = {name!r}: allowed: {', '.join(FREE)}")
        if list(fit).count(name) > 1:
            raise ResultError(f"fit = {name!r}: given more than once")
    if "scaling_factor" in fit and scene.simulation.model != "scaled":
        raise ResultError("fit = 'scaling_factor': needs simulation.model = 'scaled'")
    if "power" in fit and not scene.lit:
        raise ResultError("fit = 'power': the scene has no light")
    farthest = math.hypot(*_start(track.positions), max(abs(low), abs(high)))
    if farthest >= 2 * scene.simulation.loss_distance:
        raise ResultError(
            f"{track.name}: starts up to {farthest:.3g} m from the focus; must be nearer than "
            f"twice simulation.loss_distance = {scene.simulation.loss_distance:.3g} m"
        )


def _start(positions: Array) -> Array:
    """x and y about which the bead starts: one wrong number among the first does not move them."""
    first = positions[:_FIRST]
    middle: Array = np.median(first[np.isfinite(first).all(axis=1)], axis=0)
    return middle


def _usual(numbers: Array, order: int) -> float:
    """Median size of the differences of a coordinate from one place it was seen to the next."""
    return float(np.median(np.abs(np.diff(numbers[np.isfinite(numbers)], order))))


class _Likelihood:
    """The misfit of a track, -2 log(likelihood), over the start and what else is fitted."""

    def __init__(self, track: Track, scene: Scene, noise: float | None, fit: Sequence[str]) -> None:
        if scene.beam.polarisation != "linear":
            scene = scene.replace(optics={"evaluator": "map", "table_range": _TABLE})
        self._light = light(scene)
        self._kT = Boltzmann * scene.medium.temperature
        self._bead = bead_properties(scene)
        self._velocity = np.array(scene.start.velocity)
        self._tau = 0.0
        if scene.simulation.model == "scaled":
            self._tau = self._bead.relaxation_time / (scene.simulation.scaling_factor or 1.0)
        self._given = {
            "power": self._light.cone.power, "radius": scene.bead.radius,
            "scaling_factor": scene.simulation.scaling_factor,
        }  # fmt: skip
        self._filter = kalman_filter(self._light)
        self._noise, self._fit = noise, tuple(fit)
        self._times = track.times - track.times[0]
        self._positions = np.ascontiguousarray(track.positions)
        extent = float(np.ptp(track.positions[np.isfinite(track.positions)]))
        self._outliers = _OUTLIERS / (extent + 2 * scene.bead.radius)
        both = self._positions[np.isfinite(self._positions).all(axis=1)][:_FIRST]
        least = self.noise(self.guess)
        spread = [_GUESS * max(_usual(seen, 1), least) for seen in both.T]
        self._start, self._spread = _start(self._positions), np.array([*spread, 0.0])

    @property
    def free(self) -> int:
        """How many numbers are fitted besides z."""
        return len(self._fit) + (self._noise is None)

    @property
    def more(self) -> bool:
        """Whether the scene is not known."""
        return bool(self._fit)

    @property
    def guess(self) -> Array:
        """Where a fit begins; noise by the differences of frames, which thermal motion is in."""
        usual = float(np.mean([_usual(seen, 2) for seen in self._positions.T]))
        usual /= 0.6745 * math.sqrt(6)
        start = [] if self._noise else [math.log(min(max(usual, 2e-10), 5e-7))]
        return np.array(start + [0.0] * len(self._fit))

    @property
    def _bounds(self) -> list[tuple[float, float]]:
        noise = [] if self._noise else [(math.log(_NOISE[0]), math.log(_NOISE[1]))]
        every = {name: (-free.reach, free.reach) for name, free in FREE.items()}
        # half of the track, in steps between frames
        every["release"] = (0.0, self._times[-1] / 2 / self._step)
        return noise + [every[name] for name in self._fit]

    @property
    def _step(self) -> float:
        return float(np.median(np.diff(self._times)))

    def noise(self, p: Array) -> float:
        """m, of the camera."""
        return self._noise or math.exp(p[0])

    def _changes(self, p: Array) -> dict[str, float]:
        """What is fitted, as a logarithm of its ratio to what the scene says, or in frames."""
        return dict(zip(self._fit, p[self.free - len(self._fit) :].tolist(), strict=True))

    def filtered(self, z: float, p: Array) -> Filtered:
        """The track as the filter sees it, from a start at z, m."""
        change = self._changes(p)
        power, size, a2 = (
            math.exp(change.get(name, 0.0)) for name in ("power", "radius", "scaling_factor")
        )
        drag = size * self._bead.drag
        moving = Bead(
            size * self._light.radius, power, 1 / drag, size**3 * np.array(self._bead.weight),
            self._kT / drag, self._tau * size**2 / a2, np.append(self._start, z), self._spread,
            self._velocity, change.get("release", 0.0) * self._step,
        )  # fmt: skip
        return self._filter(
            moving, Camera(self._times, self._positions, self.noise(p), self._outliers)
        )

    def misfit(self, z: float, p: Array) -> float:
        """-2 log(likelihood)."""
        return -2 * self.filtered(z, p).log_likelihood

    def profile(self, z: float, p: Array) -> tuple[float, Array, bool]:
        """Least misfit with the start at z, where it is, and whether the fit came to an end: within
        its calls, or because as many calls more gain next to nothing.

        p: where to begin.
        """
        if not self.free:
            return self.misfit(z, p), p, True
        calls = _CALLS * (self.free + 1)

        def sought(begin: Array) -> OptimizeResult:
            return minimize(
                lambda q: self.misfit(z, q), begin, method="L-BFGS-B", bounds=self._bounds,
                options={"eps": _STEP, "ftol": 1e-6, "gtol": 0.5, "maxfun": calls},
            )  # fmt: skip

        found = sought(p)
        if found.nfev < calls:
            return float(found.fun), found.x, True
        more = sought(found.x)
        return float(more.fun), more.x, found.fun - more.fun < _NOTHING

    def parameters(self, z: float, p: Array) -> list[Parameter]:
        """What was fitted, with uncertainties by the curvature of the misfit over z and all."""
        if not self.free:
            return []
        scale = self._light.radius
        variances = 2 * np.diag(np.linalg.pinv(
            _curvature(lambda q: self.misfit(scale * q[0], q[1:]), np.array([z / scale, *p]))
        ))[1:]  # fmt: skip
        names = self._fit if self._noise else ("noise", *self._fit)
        parameters = []
        for name, value, variance, ends in zip(names, p, variances, self._bounds, strict=True):
            untold = min(value - ends[0], ends[1] - value) < 2 * _WIDE_STEP or not variance > 0
            unit = FREE[name].unit if name in FREE else "m"
            size = self._step
            number = value * size
            if name != "release":
                number = size = (self._given.get(name) or 1.0) * math.exp(value)
                untold = untold or (name == "noise" and variance > 1)
            uncertainty = None if untold else float(size * math.sqrt(variance))
            parameters.append(Parameter(name, float(number), uncertainty, unit))
        return parameters


def _curvature(function: Callable[[Array], float], at: Array) -> Array:
    """Second derivatives, (n, n), by central differences."""
    n = len(at)
    steps = _WIDE_STEP * np.eye(n)
    second = np.empty((n, n))
    for i in range(n):
        for j in range(i + 1):
            second[i, j] = second[j, i] = sum(
                a * b * function(at + a * steps[i] + b * steps[j])
                for a in (-1, 1)
                for b in (-1, 1)
            ) / (4 * _WIDE_STEP**2)  # fmt: skip
    return second


class _Profile:
    """The least misfit over the start in z, at the places where it has been sought."""

    def __init__(
        self,
        likelihood: _Likelihood,
        search: tuple[float, float],
        progress: Callable[[float], None] | None,
    ) -> None:
        """The scan."""
        self._likelihood = likelihood
        self.places = np.linspace(*search, _PLACES)
        self.values = np.array([likelihood.misfit(z, likelihood.guess) for z in self.places])
        first = self.places[self.values.argmin()]
        _, near_best, _ = likelihood.profile(first, likelihood.guess)
        self.nuisances = np.tile(near_best, (_PLACES, 1))
        self.converged = np.ones(_PLACES, dtype=bool)
        more = likelihood.more
        least = math.inf
        for i, z in enumerate(self.places):
            self.values[i] = likelihood.misfit(z, near_best)
            if more or self.values[i] < least + _HOPELESS:
                begin = self.nuisances[i - 1] if more and i else near_best
                self.values[i], self.nuisances[i], self.converged[i] = likelihood.profile(z, begin)
            least = min(least, self.values[i])
            if progress:
                progress((i + 1) / _PLACES)

    def _sought(self, z: float) -> tuple[float, Array, bool]:
        return self._likelihood.profile(z, self.nuisances[np.abs(self.places - z).argmin()])

    def above(self, z: float) -> float:
        """The misfit above the least, at any z; the places stay as they are."""
        return self._sought(z)[0] - float(self.values.min())

    def _add(self, z: float) -> None:
        value, nuisance, converged = self._sought(z)
        i = int(np.searchsorted(self.places, z))
        self.places = np.insert(self.places, i, z)
        self.values = np.insert(self.values, i, value)
        self.nuisances = np.insert(self.nuisances, i, nuisance, axis=0)
        self.converged = np.insert(self.converged, i, converged)

    @property
    def lowest(self) -> NDArray[np.intp]:
        """The places of the minima that are near the least, the ends of the search among them."""
        around = np.concatenate([[np.inf], self.values, [np.inf]])
        below = (self.values <= around[:-2]) & (self.values < around[2:])
        return np.flatnonzero(below & (self.values < self.values.min() + _HOPELESS))

    def polish(self) -> None:
        """Add the minima between the places."""
        ends = np.concatenate([self.places[:1], self.places, self.places[-1:]])
        for low, high in [(ends[i], ends[i + 2]) for i in self.lowest]:
            near = minimize_scalar(
                lambda z: self._sought(z)[0], bounds=(low, high), method="bounded",
                options={"xatol": 0.01 * (high - low)},
            )  # fmt: skip
            self._add(float(near.x))

    def refine(self, finest: float) -> None:
        """Add places where the misfit jumps near the least, the widest gap first."""
        for _ in range(_MORE):
            gaps = np.diff(self.places) * self.jumps(_JUMP)
            widest = int(gaps.argmax())
            if gaps[widest] < 2 * finest:
                return
            self._add(float(self.places[widest : widest + 2].mean()))

    def jumps(self, near: float) -> NDArray[np.bool_]:
        """(places - 1,) where the misfit jumps from one place to the next, one within `near`."""
        lower = np.minimum(self.values[1:], self.values[:-1]) - self.values.min()
        return (np.abs(np.diff(self.values)) > _JUMP) & (lower <= near)


def _below(at: Array, values: Array, misfit: Callable[[float], float]) -> list[tuple[float, float]]:
    """Where the misfit is below the level: pieces between its crossings."""
    inside = values <= LEVEL
    tolerance = 2e-5 * (at[-1] - at[0])
    known = dict(zip(at.tolist(), values.tolist(), strict=True))

    def above(z: float) -> float:
        # what was found there: found again it may differ by what a fit is exact to
        return (known[z] if z in known else misfit(z)) - LEVEL

    crossings = {
        i: brentq(above, float(at[i]), float(at[i + 1]), xtol=tolerance)
        for i in np.flatnonzero(inside[1:] != inside[:-1])
    }
    starts = [crossings[i] for i in crossings if inside[i + 1]]
    ends = [crossings[i] for i in crossings if inside[i]]
    if inside[0]:
        starts.insert(0, at[0])
    if inside[-1]:
        ends.append(at[-1])
    return [(float(low), float(high)) for low, high in zip(starts, ends, strict=True)]


def _p_value(path: Filtered, *, sized: bool) -> float:
    """How probable residuals are that are as far from white, of size 1 if `sized`."""
    trusted = np.where(path.weights > 0.5, path.residuals, np.nan)
    statistic, lags = 0.0, 0
    for residuals in trusted.T:
        seen = residuals[np.isfinite(residuals)]
        if not seen.any():  # no correlation with a coordinate that is exactly what was predicted
            continue
        for lag in range(1, min(_LAGS, len(seen) // 5) + 1):
            products = residuals[lag:] * residuals[:-lag]
            pairs = int(np.isfinite(products).sum())
            if pairs:
                statistic += float(np.nansum(products)) ** 2 / pairs / float(np.mean(seen**2)) ** 2
                lags += 1
    p_value = float(chdtrc(lags, statistic)) if lags else 1.0
    if sized:
        seen = trusted[np.isfinite(trusted)]
        above = float(chdtrc(seen.size, (seen**2).sum()))
        p_value = min(2 * min(p_value, 2 * min(above, 1 - above)), 1.0)
    return p_value


class _Doubt(NamedTuple):
    """Why the interval may be wrong."""

    told: str
    refuses: bool
    """whether z is then not determined"""


def _doubts(radius: float, profile: _Profile, path: Filtered, p_value: float) -> list[_Doubt]:
    doubts = []
    if profile.jumps(LEVEL).any():
        doubts.append(
            _Doubt("the misfit jumps at the interval's ends: its length means nothing", True)
        )
    near = profile.values - profile.values.min() < _JUMP
    if lost := int((~profile.converged & near).sum()):
        doubts.append(_Doubt(f"{lost} of {int(near.sum())} fits near it have not converged", True))
    within = np.linalg.norm(path.predicted, axis=1) < _TABLE * radius
    widest = float(path.deviations[within, 2].max(initial=0.0))
    if widest > radius:
        doubts.append(
            _Doubt(
                f"z spreads to {1e6 * widest:.2g} um, over which the force is not linear as the "
                "likelihood takes it",
                False,
            )
        )
    if p_value < _IMPROBABLE:
        doubts.append(
            _Doubt(
                f"the residuals are not white (p = {p_value:.1g}): "
                "scene or noise is not the track's",
                True,
            )
        )
    return doubts


def _statement(
    z: float,
    intervals: tuple[tuple[float, float], ...],
    search: tuple[float, float],
    determined: bool,
    parameters: tuple[Parameter, ...],
    doubts: Sequence[_Doubt],
) -> str:
    pieces = " and ".join(f"{1e6 * low:.4g} to {1e6 * high:.4g}" for low, high in intervals)
    if determined:
        told = f"the bead started at z = {1e6 * z:.4g} um; 95 % confidence: {pieces} um"
    else:
        told = f"the track does not determine z: every start from {pieces} um fits it"
        if any(doubt.refuses for doubt in doubts):
            told = f"the track does not determine z: starts from {pieces} um fit it best"
        if len(intervals) > 1:
            told = f"the track leaves {len(intervals)} places for the start: {pieces} um"
        ends = [
            f"{1e6 * end:.4g} um"
            for end, reached in (
                (search[0], intervals[0][0] <= search[0]),
                (search[1], intervals[-1][1] >= search[1]),
            )
            if reached
        ]
        if ends:
            told += f"; the interval is open at the end of the search, {' and '.join(ends)}"
    stuck = [each.name for each in parameters if each.uncertainty is None]
    if stuck:
        told += f"; not determined: {', '.join(stuck)}"
    return "; ".join([told, *(doubt.told for doubt in doubts)])
