"""Initial position of a bead along the light, the coordinate that a camera does not record.

The motion in the plane depends on the position along the light, because the force does. A track
(t, x, y) of a bead that moves into the trap therefore determines its initial z, which is the aim of
the thesis.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.stats.qmc import Sobol

from tweezer.calibration.findings import REFUTED
from tweezer.calibration.inertia import Inertia
from tweezer.dynamics.models import EquationsOfMotion, bind_translation
from tweezer.dynamics.problem import bound_once
from tweezer.fluid import drag
from tweezer.optics import light_of_one_beam
from tweezer.reading.recording import Track, load_track
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.scene.bead import bead_properties
from tweezer.scene.choices import evaluator
from tweezer.tracking.filter import Bead, Camera, Filtered, kalman_filter
from tweezer.tracking.profile import JUMP, LEVEL, Profile, below
from tweezer.tracking.residuals import p_value as p_value_of
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import IntegrationError, ResultError, SceneError
from tweezer.values.printed import in_unit, printed, with_error
from tweezer.values.rounding import most
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.units import TABLE_RADII, QuantitiesLike, QuantityLike

#: Probability that a recorded coordinate is an outlier
_OUTLIERS = 0.01
#: Allowed range of the camera noise, m
_NOISE = (1e-10, 1e-6)
#: Lower bound on the fitted noise, as a fraction of the thermal displacement between two frames or,
#: if that is smaller, of the initial value
_LEAST_NOISE = 0.03
#: Upper bound on the fitted noise, over the initial value
_MOST_NOISE = 5.0
#: Default half-width of the search, over the distance to which the force is sampled evenly
#: (`tweezer.forces.equilibria.Search`), which is the range of the force map
_SEARCH = 0.75
#: Number of values of one fitted quantity that are tried at each z of the scan; doubled for each
#: further quantity
_TRIALS = 16
#: Step in z over which the misfit is approximately a parabola, in radii
_Z_STEP = 0.03
#: Smallest gap between the released bead and a wall, in radii
_LEAST_GAP = 1e-3
#: Number of frames from which the initial position is estimated
_FIRST = 7
#: Standard deviation of the estimated initial position, in displacements between frames
_GUESS = 4.5
#: Relative excess of an exposure over the time between frames that is allowed as rounding
_UNEVEN = 1e-3


#: Note in every result on the approximation of the filter
_WITHOUT_MEMORY = (
    "The filter leaves out the memory of the fluid. In water this puts the start of beads of "
    "0.5 to 2 um some 10 to 25 nm too far from the trap."
)


class _Free(NamedTuple):
    """Quantity that may be fitted in addition to z, by its logarithm p: value = given exp(p)."""

    unit: str
    step: float
    """change of p over which the misfit is approximately a parabola"""
    reach: float
    """largest |p|; NaN for noise and release, whose ranges depend on the track"""


#: Quantities that may be fitted in addition to z, by name
FREE = {
    "noise": _Free("m", 0.1, math.nan),
    "power": _Free("W", 0.03, math.log(4)),
    "radius": _Free("m", 0.02, math.log(2)),
    "scaling_factor": _Free("", 0.05, math.log(1e4)),
    "release": _Free("s", 0.2, math.nan),
}


@dataclass(frozen=True)
class Minimum:
    """Initial z at which the misfit has a local minimum."""

    z: float
    """m, from the focus"""
    misfit: float
    """-2 log(likelihood) there, less its smallest value at any z"""


@dataclass(frozen=True)
class Parameter:
    """Value of a quantity that was fitted in addition to the depth."""

    name: str
    """"noise", "power" (through the pupil), "radius", "scaling_factor" or "release\""""
    value: float
    uncertainty: float | None
    """standard uncertainty from the likelihood; None if not determined: if the value is at an end
    of its range or, for the noise, smaller than its uncertainty"""
    unit: str

    @property
    def told(self) -> tuple[str, str]:
        """Value with uncertainty and unit, and "not determined" or ""; lengths in um."""
        unit = "um" if self.unit == "m" else self.unit
        value = with_error(self.value, self.uncertainty, unit)
        return value, "not determined" if self.uncertainty is None else ""


@dataclass(frozen=True, repr=False)
class DepthFit(Shown):
    """Initial position of a bead along the light, in SI units; z is measured from the focus."""

    name: str
    """name of the track"""
    scene: str
    """name of the scene"""
    z: float
    """m, initial z with the largest likelihood"""
    intervals: tuple[tuple[float, float], ...]
    """m, ends of the pieces of the 95 % confidence interval of z, by profile likelihood"""
    determined: bool
    """whether z is determined: the interval is one piece, shorter than half the search range and
    not at its ends, the profile has no jumps near it, and the residuals are white"""
    statement: str
    """sentence on what the track determines, with the findings against it"""
    minima: tuple[Minimum, ...]
    """minima of the misfit, best first"""
    noise: float
    """m, standard deviation of a coordinate, given or fitted"""
    parameters: tuple[Parameter, ...]
    """other fitted quantities"""
    search: tuple[float, float]
    """m, range of initial z that was searched"""
    start_time: float
    """s, time of the first frame with both coordinates; the bead was at z when this frame began"""
    frames: int
    """number of frames"""
    outliers: int
    """number of coordinates with a probability above 1/2 of being outliers"""
    p_value: float
    """p-value of the residuals, for white noise"""
    profile: tuple[tuple[float, float], ...]
    """pairs of an initial z, m, and -2 log(likelihood) minimised over the other fitted quantities;
    z for which the motion cannot be computed are omitted"""
    path: Filtered | None = None
    """filtered track at the best fit; None if loaded from a file of `tweezer fit-depth --out`"""

    def card(self) -> Card:
        """Return the card with initial z, its interval, other minima, parameters and residuals."""
        doubt = "" if self.determined else "not determined"
        pieces = ", ".join(map(_range, self.intervals))
        others = ", ".join(
            f"{printed(each.z, 'um')} (+{each.misfit:.3g})" for each in self.minima[1:]
        )
        rows = [
            Row("start in z", f"{printed(self.z, 'um')} from the focus", doubt),
            Row("95 % confidence", f"{pieces} um"),
            Row("other minima (misfit above)", others or "none", detail=not others),
            *(Row(each.name, *each.told) for each in self.parameters),
            Row("frames, outliers", f"{self.frames}, {self.outliers}", detail=True),
            Row("residuals white, p", f"{self.p_value:.2g}",
                "they are not those of the scene" if self.p_value < REFUTED else ""),
        ]  # fmt: skip
        return Card(
            "DepthFit",
            f"{self.name}, {self.scene}",
            tuple(rows),
            notes=(self.statement, _WITHOUT_MEMORY),
        )


def fit_depth(
    source: Track | xr.Dataset | str | Path,
    scene: SceneLike | None = None,
    *,
    noise: QuantityLike | None = None,
    exposure: QuantityLike | None = None,
    search: QuantitiesLike | None = None,
    fit: Sequence[str] = (),
    progress: Callable[[float], None] | None = None,
) -> DepthFit:
    """Return the initial z of a bead from a track of x and y, by maximum likelihood.

    The coordinates x and y of the track are distances from the beam axis, and both contain white
    noise of the same magnitude. The scene is assumed to be known except for the fitted quantities.
    With the scaled model (4.17) the bead begins with the scene's velocity. With any other model its
    inertia is neglected (5.2), because its effect is below the resolution of a camera. Hydrodynamic
    memory is neglected too. For the thesis's beads in water, this places z 10 to 25 nm too far from
    the trap, which is 0.1 to 0.4 standard uncertainties. Beside a wall the
    mobilities at the position of the bead are used, without inertia. The force comes from a force
    map, which extends to 20 radii, or with wave optics to 5 radii and 10 wavelengths in the medium.
    For linear polarisation it comes from the quadrature.

    The likelihood comes from a Kalman filter (`tweezer.tracking.filter`). A comparison with the
    motion without thermal noise would not suffice: thermal displacements accumulate, so its
    residuals are correlated. The filter assumes that the force is linear over the spread of
    possible positions. If this spread exceeds about a radius, as it can with the inertia of the
    scaled model, the likelihood is unreliable, and the statement reports this. The likelihood is
    averaged over initial x and y. A coordinate may be an outlier, with the probability density 0.01
    over the extent of the track (`Camera.outliers`).

    The misfit, -2 log(likelihood), is minimised over the other fitted quantities at 81 values of z.
    Its minima in z are then refined. Where the misfit jumps by more than 7.7 near its smallest
    value, up to 80 more values of z are added, with distances down to 1/32 of the initial distance.
    At each z, searches begin at many values of the fitted quantities and at the best values for
    neighbouring z. They are repeated until no minimum improves (`tweezer.tracking.profile`). An
    initial z for which the motion cannot be computed is excluded.

    The confidence interval contains each initial z whose misfit is less than 3.84 above the minimum
    (S. S. Wilks, Ann. Math. Stat. 9, 60 (1938)), so it may be in several pieces or open. The track
    does not determine z in any of these cases:

    * A jump remains at an end of the interval, or a fit near it has not converged.
    * Power, radius or scaling factor reaches an end of its range within the interval (1/4 to 4, 1/2
      to 2 and 1e-4 to 1e4 times the scene's value), or noise or release reaches its upper end.
    * The p-value is below 0.01. It tests the correlations of the residuals (G. M. Ljung and G. E.
      P. Box, Biometrika 65, 297 (1978)), and their size if the noise is given.

    Parameters
    ----------
    source : Track, xarray.Dataset, str or Path
        A track, or a source for `load_track`.
    scene : Scene or str or Path, optional
        Bead, medium and light: a scene, its name or its file. Default: the scene of a run of
        tweezer.
    noise : float or str, optional
        Standard deviation of a coordinate, m. Default: fitted.
    exposure : float or str, optional
        Time over which each frame averages, s, at most the shortest time between two frames. Times
        of the track are the middles of the exposures, and z applies to the beginning of the first
        one. Default: the exposure of the camera of a run of tweezer, otherwise 0.
    search : array_like, shape (2,), optional
        Range of initial z, m from the focus. Default: three quarters of the range of the force map
        on both sides, but not beyond a wall. This is 15 radii, or with wave optics about 4 radii
        and 7 wavelengths in the medium.
    fit : sequence of str
        Further unknown quantities: "power", "radius", "scaling_factor" (a2 of the scaled model) and
        "release" (the time until which the bead is held; the first frame if not fitted).
    progress : callable, optional
        Called with the fraction done, 0 to 1.

    Returns
    -------
    DepthFit
        Initial z with its confidence interval, and the other fitted quantities.

    Raises
    ------
    ResultError
        For a source that `load_track` refuses, a missing scene, an invalid noise, exposure, search
        or name in `fit`, and a name in `fit` that is not available beside a wall.
    SceneError
        For more than one beam, and for the scaled model beside a wall.
    IntegrationError
        If the motion cannot be computed from any initial z.

    Examples
    --------
    >>> scene = tweezer.load_scene("silica-1um").replace(forces={"brownian": True})
    >>> run = tweezer.simulate(scene, "2 ms", seed=1)
    >>> tweezer.fit_depth(run.isel(time=slice(None, None, 40))).determined
    True
    """
    track = source if isinstance(source, Track) else load_track(source)
    scene = track.scene if scene is None else checked_scene(scene)
    if scene is None:
        raise ResultError(f"{track.name}: requires a scene")
    noise, exposure = (
        None if value is None else in_si(name, value, unit, error=ResultError)
        for name, value, unit in (("noise", noise, "m"), ("exposure", exposure, "s"))
    )
    if search is None:
        half = _SEARCH * light_of_one_beam(scene).search.near
        within = _between_walls(scene, -half, half)
    else:
        low, high = numbers_in_si("search", search, "m").tolist()
        within = low, high
    _refuse(track, scene, noise, within, fit)
    exposure = (track.exposure or 0.0) if exposure is None else exposure
    shortest = float(np.diff(track.times).min())
    if not 0 <= exposure <= shortest * (1 + _UNEVEN):
        raise ResultError(
            f"exposure = {exposure:g} s: must be from 0 to the shortest time between two frames, "
            f"{most(shortest, 4)} s"
        )
    likelihood = _Likelihood(track, scene, noise, min(exposure, shortest), fit)

    profile = Profile(likelihood, within, progress)
    profile.polish()
    profile.refine()
    at, values = profile.places, profile.values - profile.values.min()
    i = int(values.argmin())
    best, optimum = float(at[i]), profile.nuisances[i]
    intervals = tuple(below(profile))
    path = likelihood.filtered(best, optimum)
    parameters = tuple(likelihood.parameters(optimum, profile.spread()))
    # three for the initial x and y, which come from the first frames, and z
    p_value = p_value_of(path, sized=noise is not None, fitted=3 + len(likelihood.names))
    doubts = _doubts(scene.body.size, likelihood, profile, path, p_value)
    (low, high), *more = intervals
    open_end = low <= at[0] or intervals[-1][1] >= at[-1]
    determined = (
        not more and not open_end and high - low < (within[1] - within[0]) / 2
        and not any(doubt.refuses for doubt in doubts)
    )  # fmt: skip
    minima = [Minimum(float(at[i]), float(values[i])) for i in profile.lowest]
    return DepthFit(
        track.name, scene.name, best, intervals, determined,
        _statement(best, intervals, (at[0], at[-1]), determined, parameters, doubts),
        tuple(sorted(minima, key=lambda each: each.misfit)), likelihood.noise(optimum),
        parameters, within, float(track.times[0]), len(track.times),
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
    """Raise `ResultError` for arguments of `fit_depth` that are invalid for this track and scene.

    `noise` is a standard deviation, m, and `search` the range of initial z, m.
    """
    low, high = search
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise ResultError(f"search = {low:g} to {high:g} m: must be an ascending range of z")
    if noise is not None and not _NOISE[0] <= noise <= _NOISE[1]:
        raise ResultError(f"noise = {noise:g} m: must be from {_NOISE[0]:g} to {_NOISE[1]:g} m")
    if isinstance(fit, str):
        raise ResultError(f"fit = {fit!r}: must be a list of names")
    for name in fit:
        if name not in (allowed := [each for each in FREE if each != "noise"]):
            raise ResultError(f"fit = {name!r}: allowed: {', '.join(allowed)}")
        if list(fit).count(name) > 1:
            raise ResultError(f"fit = {name!r}: given more than once")
    if "scaling_factor" in fit and scene.simulation.model != "scaled":
        raise ResultError("fit = 'scaling_factor': requires simulation.model = 'scaled'")
    if scene.wall is not None:
        _refuse_in_the_wall(scene, search, fit)
    if "power" in fit and not scene.lit:
        raise ResultError("fit = 'power': the scene has no light")
    farthest = math.hypot(*_start(track.positions), max(abs(low), abs(high)))
    if farthest >= 2 * scene.simulation.loss_distance:
        raise ResultError(
            f"{track.name}: starts up to {farthest:.3g} m from the focus; must be nearer than "
            f"twice simulation.loss_distance = {scene.simulation.loss_distance:.3g} m"
        )


def _refuse_in_the_wall(scene: Scene, search: tuple[float, float], fit: Sequence[str]) -> None:
    """Raise an error for a model, search range (m) or fitted quantity that a wall excludes."""
    if scene.simulation.model == "scaled":
        raise SceneError(
            "simulation.model = 'scaled': beside a wall the depth is fitted without inertia; "
            "allowed: full, overdamped"
        )
    if min(map(scene.room, search)) <= 0:
        low, high = _between_walls(scene, -math.inf, math.inf)
        raise ResultError(
            f"search = {search[0]:g} to {search[1]:g} m: reaches into the wall; the bead's centre "
            f"is between {low:.6g} and {high:.6g} m"
        )
    for name in {"power", "radius"}.intersection(fit) if scene.forces.dlvo else ():
        raise ResultError(f"fit = {name!r}: cannot be combined with forces.dlvo")


def _between_walls(scene: Scene, low: float, high: float) -> tuple[float, float]:
    """Return the part of the range `low` to `high` of z, m, in which the bead touches no wall."""
    for plane, normal in scene.wall.planes if scene.wall else ():
        nearest = plane + normal * (1 + _LEAST_GAP) * scene.body.support(normal)
        low, high = (max(low, nearest), high) if normal > 0 else (low, min(high, nearest))
    return low, high


def _start(positions: Array) -> Array:
    """Return initial x and y, (2,), m: the medians of the first frames of `positions` (n, 2), m.

    A single outlier among these frames changes a median only slightly.
    """
    first = positions[:_FIRST]
    middle: Array = np.median(first[np.isfinite(first).all(axis=1)], axis=0)
    return middle


def _usual(numbers: Array, order: int) -> float:
    """Return the median absolute difference, of the given `order`, of a coordinate `numbers` (n,).

    Missing values (NaN) are removed first. The result has the unit of the numbers.
    """
    return float(np.median(np.abs(np.diff(numbers[np.isfinite(numbers)], order))))


class _Likelihood:
    """Misfit, -2 log(likelihood), of a track as a function of z and p.

    z, m, is the initial position along the light. The vector p (n,) contains the other fitted
    quantities in the order of `names`. For the noise it is the logarithm of the value in metres.
    For power, radius and scaling factor it is the logarithm of the ratio to the scene's value. The
    release time is in frames.
    """

    def __init__(
        self, track: Track, scene: Scene, noise: float | None, exposure: float, fit: Sequence[str]
    ) -> None:
        if scene.beam.polarisation != "linear" and evaluator(scene.optics.evaluator).mapped:
            reach = light_of_one_beam(scene).search.near
            radii = round(reach / scene.body.size, 9)
            range_ = radii if radii <= TABLE_RADII[1] else f"{reach:.12g} m"
            scene = scene.replace(optics={"evaluator": "map", "table_range": range_})
        if not scene.plain:
            raise SceneError("beam: a depth is fitted only with one fixed beam from below")
        Inertia.refuse_relaxing(scene)
        self._light = light_of_one_beam(scene)
        self._problem = bound_once(scene)
        self._kT = Boltzmann * self._problem.scene.noise_temperature
        self._velocity = np.array(scene.start.velocity)
        self._given = {
            "power": self._light.light.cone.power, "radius": scene.bead.radius,
            "scaling_factor": scene.simulation.scaling_factor,
        }  # fmt: skip
        self._filters: dict[tuple[float, float], Callable[..., Filtered]] = {}
        self._noise, self._exposure, self._fit = noise, exposure, tuple(fit)
        self._times = track.times - track.times[0]
        self._positions = np.ascontiguousarray(track.positions)
        extent = float(np.ptp(track.positions[np.isfinite(track.positions)]))
        self._outliers = _OUTLIERS / (extent + 2 * scene.body.size)
        both = self._positions[np.isfinite(self._positions).all(axis=1)][:_FIRST]
        least = self._noise or self._guess
        spread = [_GUESS * max(_usual(seen, 1), least) for seen in both.T]
        self._start = _start(self._positions)
        # A frame shows the mean over its exposure. At the beginning of the exposure, the bead was
        # about as far from this mean as it moves until the next frame.
        if exposure:
            heat = math.sqrt(2 * self._kT * self._problem.mobility[0] * exposure)
            spread = [math.hypot(seen[1] - seen[0], heat, least) for seen in both.T]
            self._start = both[0]
        self._spread = np.array([*spread, 0.0])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the components of p, the quantities that are fitted in addition to z."""
        return self._fit if self._noise else ("noise", *self._fit)

    @property
    def reach(self) -> float:
        """Distance from the focus to which the force is tabulated, m."""
        return self._light.search.near

    @functools.cached_property
    def unit(self) -> float:
        """Unit of lengths in a fit: the radius of the bead, m."""
        return self._light.light.radius

    @functools.cached_property
    def _guess(self) -> float:
        """Initial value of the camera noise, m, from the second differences of successive frames.

        It includes some thermal motion. For Gaussian noise the median absolute second difference is
        0.6745 sqrt(6) standard deviations.
        """
        usual = float(np.mean([_usual(seen, 2) for seen in self._positions.T]))
        return min(max(usual / (0.6745 * math.sqrt(6)), 2 * _NOISE[0]), _NOISE[1] / 2)

    @functools.cached_property
    def bounds(self) -> Array:
        """Lower and upper bounds of p, (n, 2): logarithms, or frames for the release time."""
        every = {name: (-free.reach, free.reach) for name, free in FREE.items()}
        every["release"] = (0.0, self._times[-1] / 2 / self._step)  # half of the track
        heat = math.sqrt(2 * self._kT * self._problem.mobility[0] * self._step)
        least = _LEAST_NOISE * min(heat, self._guess)
        every["noise"] = (math.log(least), math.log(_MOST_NOISE * self._guess))
        return np.array([every[name] for name in self.names]).reshape(-1, 2)

    @functools.cached_property
    def steps(self) -> Array:
        """Steps of z, in radii, and of p over which the misfit is about a parabola, (n + 1,)."""
        return np.array([_Z_STEP, *(FREE[name].step for name in self.names)])

    @functools.cached_property
    def trials(self) -> Array:
        """Values of p, (trials, n), that are tried at each z of the scan, the initial ones first.

        The others are spread evenly over the bounds by a Sobol sequence.
        """
        known = [] if self._noise else [math.log(self._guess)]
        begin = np.array([*known, *[0.0] * len(self._fit)])
        if not self._fit:
            return begin[None]
        low, high = self.bounds[len(known) :].T
        count = _TRIALS * 2 ** (len(self._fit) - 1)
        even = Sobol(len(self._fit), scramble=False).random(count) + 0.5 / count
        tried = np.column_stack([np.tile(known, (count, 1)), low + even * (high - low)])
        return np.vstack([begin, tried])

    @functools.cached_property
    def _step(self) -> float:
        """Median time between two frames, s."""
        return float(np.median(np.diff(self._times)))

    def noise(self, p: Array) -> float:
        """Return the standard deviation of the camera noise, m: the given value, or that of p."""
        return self._noise or math.exp(p[0])

    def _changes(self, p: Array) -> dict[str, float]:
        """Return the fitted quantities except the noise, by name, as components of p."""
        return dict(zip(self._fit, p[len(p) - len(self._fit) :].tolist(), strict=True))

    def filtered(self, z: float, p: Array, least: float = -math.inf) -> Filtered:
        """Return the result of the Kalman filter for a bead that begins at z, m, with p (n,).

        The filter stops early if the log-likelihood cannot reach `least` (`kalman_filter`).
        """
        change = self._changes(p)
        power, size, a2 = (
            math.exp(change.get(name, 0.0)) for name in ("power", "radius", "scaling_factor")
        )
        scene = self._problem.scene
        if scene.wall is not None and scene.room(z) <= (size - 1) * self.unit:
            raise IntegrationError(
                f"a bead of {size * self.unit:.4g} m at {z:.6g} m is in the wall"
            )
        if (size, a2) not in self._filters:  # only the most recent filter is cached
            self._filters = {(size, a2): kalman_filter(self._equations(size, a2))}
        moving = Bead(
            size * self.unit, power, self._kT, np.append(self._start, z), self._spread,
            self._velocity, change.get("release", 0.0) * self._step,
        )  # fmt: skip
        return self._filters[size, a2](
            moving,
            Camera(
                self._times,
                self._positions,
                np.full(2, self.noise(p)),
                self._outliers,
                self._exposure,
            ),
            least,
        )

    def _equations(self, size: float, a2: float) -> EquationsOfMotion:
        """Return the equations of motion for another bead radius and scaling factor.

        `size` and `a2` are the ratios of the radius and the scaling factor to those in the scene.
        """
        scene, inertial = self._problem.scene, self._problem.scene.simulation.model == "scaled"
        radius = size * scene.bead.radius
        factor = a2 * (scene.simulation.scaling_factor or 1.0) if inertial else None
        simulation = scene.simulation.model_copy(update={"scaling_factor": factor})
        bead, start = scene.bead.model_copy(update={"radius": radius}), scene.start
        if scene.wall is not None:  # begin where a bead of any radius is clear of the wall
            clear = scene.wall.position + 2 * scene.wall.normal * radius
            start = start.model_copy(update={"frame": "focus", "position": (0.0, 0.0, clear)})
        scene = scene.model_copy(update={"bead": bead, "start": start, "simulation": simulation})
        problem = dataclasses.replace(
            self._problem, scene=scene, bead=bead_properties(scene), drag=drag(scene),
            light=self._light.of_radius(radius),
        )  # fmt: skip
        return bind_translation(problem, "scaled" if inertial else "overdamped")

    def misfit(self, z: float, p: Array, most: float = math.inf) -> float:
        """Return -2 log(likelihood) at z, m, and p (n,); infinite if the motion cannot be computed.

        If the misfit exceeds `most`, any number between the two may be returned, because the filter
        stops early.
        """
        try:
            return -2 * self.filtered(z, p, -most / 2).log_likelihood
        except IntegrationError:
            return math.inf

    def ends(self, p: Array) -> list[str]:
        """Return the names of the quantities in p (n,) that are at the end of their range.

        The lower ends of noise and release time are ignored: less noise makes no difference, and a
        bead is not released before the first frame.
        """
        low, high = self.bounds.T.copy()
        low[[name in ("noise", "release") for name in self.names]] = -np.inf
        return [self.names[i] for i in np.flatnonzero((p <= low) | (p >= high))]

    def parameters(self, p: Array, spread: Array) -> list[Parameter]:
        """Return the fitted quantities in SI; `spread` (n,) has the uncertainties of p (n,)."""
        parameters = []
        for name, value, deviation, ends in zip(self.names, p, spread, self.bounds, strict=True):
            size, number = self._step, value * self._step
            if name != "release":
                number = size = (self._given.get(name) or 1.0) * math.exp(value)
            told = ends[0] < value < ends[1] and deviation < (1 if name == "noise" else np.inf)
            uncertainty = float(size * deviation) if told else None
            parameters.append(Parameter(name, float(number), uncertainty, FREE[name].unit))
        return parameters


class _Doubt(NamedTuple):
    """Reason why the confidence interval of z may be wrong."""

    told: str
    """text for the statement of the result"""
    refuses: bool
    """whether it makes z count as not determined"""


def _doubts(
    radius: float, likelihood: _Likelihood, profile: Profile, path: Filtered, p_value: float
) -> list[_Doubt]:
    """Return the reasons not to trust the interval of a fit.

    `radius`, m, is the radius of the bead, `path` the filtered track at the best fit, and `p_value`
    the probability that white residuals deviate at least as much.
    """
    doubts = []
    if profile.jumps(LEVEL).any():
        doubts.append(
            _Doubt(
                "the misfit jumps at the ends of the interval, so its length is unreliable", True
            )
        )
    near = profile.values - profile.values.min() < JUMP
    if lost := int((~profile.converged & near).sum()):
        doubts.append(_Doubt(f"{lost} of {int(near.sum())} fits near z have not converged", True))
    inside = profile.nuisances[profile.values - profile.values.min() <= LEVEL]
    if ends := sorted({name for p in inside for name in likelihood.ends(p)}):
        doubts.append(_Doubt(f"{' and '.join(ends)} reached an end of its range", True))
    within = np.linalg.norm(path.predicted, axis=1) < likelihood.reach
    widest = float(path.deviations[within, 2].max(initial=0.0))
    if widest > radius:
        doubts.append(
            _Doubt(
                f"z spreads to {printed(widest, 'um', 2)}, over which the force is not linear, "
                "as the likelihood assumes",
                False,
            )
        )
    if p_value < REFUTED:
        doubts.append(
            _Doubt(
                f"the residuals are not white (p = {p_value:.1g}): the scene or the noise is wrong",
                True,
            )
        )
    return doubts


def _range(ends: tuple[float, float]) -> str:
    """Return an interval in m as text in um, without the unit."""
    return " to ".join(in_unit(end, "um") for end in ends)


def _statement(
    z: float,
    intervals: tuple[tuple[float, float], ...],
    search: tuple[float, float],
    determined: bool,
    parameters: tuple[Parameter, ...],
    doubts: Sequence[_Doubt],
) -> str:
    """Return the statement of the result: what the track determines, and reasons for doubt.

    `z`, m, is the best fit, `intervals`, m, are the pieces of the confidence interval, and
    `search`, m, is the range that was searched.
    """
    pieces = " and ".join(map(_range, intervals))
    if determined:
        told = f"the bead was released at z = {printed(z, 'um')}; 95 % confidence: {pieces} um"
    else:
        told = f"the track does not determine z: every release from {pieces} um fits it"
        if any(doubt.refuses for doubt in doubts):
            told = (
                "the track does not determine z: of those tried, releases from "
                f"{pieces} um fit best"
            )
        if len(intervals) > 1:
            told = f"the track allows {len(intervals)} ranges of the release: {pieces} um"
        ends = [
            printed(end, "um")
            for end, reached in (
                (search[0], intervals[0][0] <= search[0]),
                (search[1], intervals[-1][1] >= search[1]),
            )
            if reached
        ]
        if ends:
            told += f"; the interval is open at the end of the search, {' and '.join(ends)}"
    if any(each.name == "noise" and each.uncertainty is None for each in parameters):
        told += "; the noise is too small to be determined"
    return "; ".join([told, *(doubt.told for doubt in doubts)])
