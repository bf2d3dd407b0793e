"""Keys of a scene from recordings of its trapped bead, by maximum likelihood.

The likelihood is that of the Kalman filter (`tweezer.dynamics.filter`): of the whole scene, the
exact force of its light among it, not of a stiffness. So a record tells what the force depends on:
power, size, index, aperture, the height above a wall; as far as it does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq

from tweezer.analysis.profile import LEVEL
from tweezer.analysis.recording import Recording, load_recording
from tweezer.analysis.residuals import p_value
from tweezer.analysis.scene_misfit import Least, Misfit
from tweezer.errors import ResultError
from tweezer.optics import rows_of_light
from tweezer.rounding import with_uncertainty
from tweezer.scene import Scene, checked_scene
from tweezer.shown import Card, Row, Shown
from tweezer.units import usual_unit

#: Information that everything is taken to have, so that its inverse is finite
_FAINT = 1e-6
#: Distance from a bound at which a value counts as there
_AT_END = 1e-3
#: Tolerance of the end of an interval, in its distance
_END = 0.01
#: Part of the level that the misfit has reached just before a smooth end
_SMOOTH = 0.9
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
    half a radius, or beyond what a scene may have"""
    determined: bool
    """whether both ends are told, the fit has converged and the residuals are those of the scene"""
    profile: tuple[tuple[float, float], ...]
    """values of the key, and least misfit there, -2 log(likelihood), above the least of all"""

    @property
    def told(self) -> tuple[str, str]:
        """Value and interval in the usual unit of its size, and that it is not determined."""
        factor, unit = usual_unit(self.value, self.unit)
        uncertainty = math.nan if self.uncertainty is None else self.uncertainty / factor
        value = f"{with_uncertainty(self.value / factor, uncertainty)} {unit}".rstrip()
        ends = ["not told" if end is None else f"{end / factor:.4g}" for end in self.interval]
        told = f"{value} (95 %: {ends[0]} to {ends[1]})"
        return told, "" if self.determined else "not determined"


@dataclass(frozen=True, repr=False)
class SceneFit(Shown):
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

    def card(self) -> Card:
        """A row for each key, what the residuals say, and the light."""
        rows = [Row(each.key, *each.told) for each in self.keys]
        unlikely = self.p_value < _IMPROBABLE
        rows += [
            Row("frames", f"{self.frames}", detail=True),
            Row("residuals white, p", f"{self.p_value:.2g}",
                "they are not those of the scene" if unlikely else ""),
            *rows_of_light(self.scene),
        ]  # fmt: skip
        names = ", ".join(Path(name).name for name in self.names)
        return Card("SceneFit", names, tuple(rows), notes=(self.statement,))


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
    direction of the misfit that tells more than a quarter, and taken as a parabola along each,
    level beyond; and is measured again where the minimum turns out to be, until it stays. The
    minimum is found by Gauss's and Newton's steps in the logarithms of the keys, or in radii for a
    key that is not positive, from the best of 17 places about the guesses, up to a factor of 5 or 5
    radii from them. The interval of a key holds its values whose least misfit over the other keys
    is less than 3.84 above the least (S. S. Wilks, Ann. Math. Stat. 9, 60 (1938)). Keys that the
    likelihood does not tell apart are named. The p-value is that of `tweezer.fit_depth`.

    Raises `ResultError` for what `load_recording` refuses, without a scene, for voltages, for a
    camera of another rate, and where no bead is trapped; `SceneError` for keys that are no
    quantities of the scene, and for light that changes in time.
    """
    loaded = _loaded(recordings)
    scene = loaded[0].scene if scene is None else checked_scene(scene)
    if scene is None:
        raise ResultError(f"{loaded[0].name}: needs a scene")
    free = (free,) if isinstance(free, str) else tuple(free)
    misfit = Misfit(loaded, scene, free)
    tell = progress or (lambda _: None)
    best = misfit.best(lambda part: tell(0.4 * part))
    paths = misfit.filtered(best.at)
    p = min(len(paths) * min(p_value(path, sized=True) for path in paths), 1.0)
    sound = best.converged and p >= _IMPROBABLE
    found: list[FittedKey] = []
    for i in range(len(free)):
        tell(0.4 + 0.6 * i / len(free))
        found.append(_Interval(misfit, best, i).found(sound=sound))
    tell(1.0)
    return SceneFit(
        tuple(each.name for each in loaded), misfit.scene(best.at), tuple(found),
        sum(path.log_likelihood for path in paths),
        sum(len(each.times) for each in loaded), p,
        "; ".join(_told(misfit, best, found, p)),
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


def _told(misfit: Misfit, best: Least, found: Sequence[FittedKey], p: float) -> list[str]:
    """What the recordings tell, in words; first of all what they do not."""
    lines = []
    at_ends = [
        key.key
        for key, place in zip(misfit.keys, best.at, strict=True)
        if abs(place) > key.reach - _AT_END
    ]
    lost = [each.key for each in found if not each.determined and each.key not in at_ends]
    if not best.converged:
        lines.append("the fit has not converged: nothing of it is to be trusted")
    if p < _IMPROBABLE:
        lines.append(
            f"the residuals are not those of the scene (p = {p:.1g}): what is not free in it is "
            "not that of the record, or its noise or exposure"
        )
    if at_ends:
        lines.append(f"{' and '.join(at_ends)} at an end of what was tried: begin nearer")
    if lost and not lines:
        lines.append(f"the record does not determine {' and '.join(lost)}")
        lines += _degenerate(misfit, best, lost)
    if not lines:
        lines.append(f"the record determines {' and '.join(each.key for each in found)}")
    bound = misfit.bound(tuple(best.at.tolist()))
    assert not isinstance(bound, str)
    axes = max(seen.shape[1] for seen in misfit.seen)
    slowest = float((bound.drag / bound.stiffness)[:axes].max())
    length = sum(each.step * len(each.times) for each in misfit.recordings)
    if length < _FEW * slowest:
        lines.append(f"only {length / slowest:.2g} relaxation times: intervals are too short")
    momentum_time = bound.problem.bead.mass / float(bound.drag[0])
    if min(each.step for each in misfit.recordings) < _INERTIA * momentum_time:
        lines.append("its steps are as short as the bead's inertia lasts, which is left out")
    return lines


def _degenerate(misfit: Misfit, best: Least, lost: Sequence[str]) -> list[str]:
    """The combination of keys that changes the likelihood least, where two are not told."""
    sizes, directions = np.linalg.eigh(best.information)
    direction = directions[:, 0]
    involved = [i for i, key in enumerate(misfit.keys) if key.key in lost]
    if len(involved) < 2 or sizes[0] > 1 / _DETERMINED**2:
        return []
    first = max(involved, key=lambda i: abs(direction[i]))
    others = [i for i in np.argsort(-np.abs(direction)) if i != first]
    others = [i for i in others if abs(direction[i]) > 0.1 * abs(direction[first])]
    if not others:
        return []
    step = _TEN_PER_CENT / direction[first] * direction
    with_it = " and ".join(misfit.keys[i].change(step[i]) for i in others)
    return [f"{misfit.keys[first].change(step[first])} with {with_it} fits as well"]


class _Interval:
    """The interval of a key by the least misfit over the others."""

    def __init__(self, misfit: Misfit, best: Least, index: int) -> None:
        self._misfit, self._best, self._index = misfit, best, index
        self._low, self._high = misfit.bounds[index]
        covariance = np.linalg.inv(best.information + _FAINT * np.eye(len(best.at)))
        variance = float(covariance[index, index])
        self._spread = math.sqrt(variance)
        # where the others go with it
        self._along = covariance[:, index] / variance
        self._known: dict[float, float] = {float(best.at[index]): 0.0}

    def found(self, *, sound: bool) -> FittedKey:
        """What is told of the key; sound: whether the fit may be trusted."""
        key, at = self._misfit.keys[self._index], float(self._best.at[self._index])
        ends = [self._end(at, way) for way in (-1.0, 1.0)]
        low, high = (None if end is None else key.value(end) for end in ends)
        uncertainty = None
        if sound and low is not None and high is not None:
            uncertainty = (high - low) / 3.92
        return FittedKey(
            key.key, key.quantity.unit, key.value(at), uncertainty, (low, high),
            uncertainty is not None,
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
        """Where the misfit has risen by 3.84.

        None if it does not up to `_DETERMINED`, or at once, where there is no such scene.
        """
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

        tolerance = _END * abs(outer - at)
        end = float(brentq(above, inner, outer, xtol=tolerance, rtol=1e-12))
        return end if self._rise(end - 3 * way * tolerance) > _SMOOTH * level else None
