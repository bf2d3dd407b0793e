"""Maximum-likelihood fits of a scene's keys to recordings of its trapped bead.

The likelihood uses the power spectrum of the bead in the scene's light, with the inertia of bead
and fluid. The stiffness follows from the scene, so a recording determines the keys on which the
stiffness and the drag depend: power, size, index, aperture, and the height above a wall.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq

from tweezer.calibration.findings import REFUTED
from tweezer.calibration.settling import unsettled
from tweezer.forces.acting import forces_of
from tweezer.forces.force import Force
from tweezer.optics import rows_of_light
from tweezer.reading.recording import Recording, load_recording
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.tracking.profile import LEVEL
from tweezer.tracking.scene_misfit import Least, Misfit
from tweezer.values.errors import ResultError
from tweezer.values.prefixes import usual_unit
from tweezer.values.rounding import time_taken, with_uncertainty
from tweezer.values.shown import Card, Row, Shown

#: Information that is added for every key, so that the matrix can be inverted
_FAINT = 1e-6
#: Distance from a bound below which a value counts as at the bound
_AT_END = 1e-3
#: Tolerance of the end of an interval, over its distance from the best fit
_END = 0.01
#: Fraction of the level that the misfit must reach just before a smooth end
_SMOOTH = 0.9
#: Smallest duration in relaxation times of the slowest recorded axis
_FEW = 50.0
#: Largest distance of an interval's end from a determined value, as a logarithm or in radii
_DETERMINED = 0.5
#: Misfit above the smallest, below which another minimum is not excluded: each fits by chance
_RIVAL = 15.0
#: Smallest systematic error that is reported, over the smallest relative uncertainty of a key
_HARM = 0.5
#: Change of a key in the description of two keys that are not distinguished
_TEN_PER_CENT = math.log(1.1)


@dataclass(frozen=True)
class FittedKey:
    """Key of a scene as determined by recordings: value, uncertainty and confidence interval."""

    key: str
    """key of the scene, such as "beam.power\""""
    unit: str
    """SI unit of `value`; "" for a number"""
    value: float
    """value with the largest likelihood"""
    uncertainty: float | None
    """standard uncertainty: length of the interval over 3.92; None if `determined` is False"""
    interval: tuple[float | None, float | None]
    """95 % confidence interval by profile likelihood; None for an end that is further from `value`
    than a factor of 1.65 or half a radius, or that no scene allows"""
    determined: bool
    """whether both ends are finite, the fit has converged and the residuals agree with the scene"""
    profile: tuple[tuple[float, float], ...]
    """pairs of a value of the key and -2 log(likelihood) minimised over the other keys, less the
    overall minimum"""

    @property
    def told(self) -> tuple[str, str]:
        """Value with interval, in a unit of suitable size, and "not determined" or ""."""
        factor, unit = usual_unit(self.value, self.unit)
        uncertainty = math.nan if self.uncertainty is None else self.uncertainty / factor
        value = f"{with_uncertainty(self.value / factor, uncertainty)} {unit}".rstrip()
        ends = ["not determined" if end is None else f"{end / factor:.4g}" for end in self.interval]
        told = f"{value} (95 %: {ends[0]} to {ends[1]})"
        return told, "" if self.determined else "not determined"


@dataclass(frozen=True, repr=False)
class SceneFit(Shown):
    """Result of a fit of a scene to recordings, in SI."""

    names: tuple[str, ...]
    """names of the recordings"""
    scene: Scene
    """scene with the fitted values"""
    keys: tuple[FittedKey, ...]
    """fitted keys, in the given order"""
    log_likelihood: float
    """largest log-likelihood, to compare fits to the same recordings"""
    frames: int
    """number of frames in all recordings"""
    p_value: float
    """p-value of the spectra, for the fitted scene"""
    likelihood: str
    """description of the fitted spectra: frequencies, sampling intervals and inertia"""
    statement: str
    """sentences on which keys the recordings determine, with the findings against them"""

    @property
    def determined(self) -> bool:
        """Whether every key is determined."""
        return all(each.determined for each in self.keys)

    def __getitem__(self, key: str) -> FittedKey:
        return next(each for each in self.keys if each.key == key)

    def card(self) -> Card:
        """Return the card with a row for each key, the p-value of the residuals, and the light."""
        rows = [Row(each.key, *each.told) for each in self.keys]
        unlikely = self.p_value < REFUTED
        rows += [
            Row("likelihood", self.likelihood),
            Row("frames", f"{self.frames}", detail=True),
            Row("spectrum, p", f"{self.p_value:.2g}",
                "it is not that of the scene" if unlikely else ""),
            *rows_of_light(self.scene),
        ]  # fmt: skip
        names = ", ".join(Path(name).name for name in self.names)
        return Card("SceneFit", names, tuple(rows), notes=(self.statement,))


def fit(
    recordings: Recording | xr.Dataset | str | Path | Sequence[Recording | str | Path],
    scene: SceneLike | None = None,
    *,
    free: Sequence[str],
    forces: Sequence[Force | str] = (),
    progress: Callable[[float], None] | None = None,
) -> SceneFit:
    """Fit keys of a scene to recordings of its bead at rest in the trap.

    The likelihood is the Whittle likelihood of each coordinate's whitened power spectrum (P.
    Whittle, Ark. Mat. 2, 423 (1953)). The expected spectrum includes inertia, hydrodynamic memory,
    aliases, motion blur and the noise of the camera, without approximation
    (`TrappedBead.sampled_spectrum`). Stiffness and drag are averaged over the thermal motion in the
    scene's force (statistical linearisation). This is correct to first order in the anharmonic part
    of the trap. The statement reports if the second order may matter.

    The bead is in equilibrium in the trap throughout. Its position in the recording is unknown, so
    the mean of each coordinate is subtracted. The coordinates are treated as independent.

    Parameters
    ----------
    recordings : Recording, dataset, path or a sequence of them
        One or several recordings of the same scene, or sources for `load_recording`, with x, x and
        y, or all three coordinates.
    scene : Scene, optional
        Bead, medium and light, with the first guesses of the free keys, and `camera` for exposure
        and noise. Default: the scene of a run. Without a camera, exposure and noise come from the
        recording, or are zero. `simulation.model` and `medium.inertia` select the inertia. By
        default, the inertia of the bead and hydrodynamic memory are included. A run of tweezer is
        fitted with the inertia with which it was simulated.
    free : sequence of str
        Keys of the scene, such as "bead.diameter", "beam.power", "medium.viscosity" or
        "camera.noise".
    forces : sequence of Force or str, optional
        Your own forces, in addition to the scene's (`tweezer.forces`), or the name of a force in a
        Python file, "handles.py:spring". They must not depend on the free keys.
    progress : callable, optional
        Called with the completed fraction.

    Returns
    -------
    SceneFit
        Values with 95 % confidence intervals. An interval contains the values for which the misfit,
        -2 log(likelihood), minimised over the other keys, is less than 3.84 above its minimum (S.
        S. Wilks, Ann. Math. Stat. 9, 60 (1938)). The search starts at the best eight of 16 points,
        up to a factor of 5 or 5 radii from the first guesses. The statement names keys that the
        likelihood cannot distinguish, and other minima up to 15 above the lowest. The p-value
        combines Bartlett's test of the spectra with a test of their magnitude.

    Raises
    ------
    ResultError
        For a source that `load_recording` refuses, a missing scene, voltages, a camera with another
        rate, a recording that begins before the bead has settled, and a scene that does not trap
        the bead.
    SceneError
        For keys that are not quantities of the scene, and for light that changes in time.

    Examples
    --------
    >>> scene = tweezer.load_scene("silica-1um").replace(forces={"brownian": True})
    >>> scene = scene.replace(start={"drawn": "equilibrium"})
    >>> run = tweezer.simulate(scene, "0.2 s", seed=1)
    >>> tweezer.fit(run, free=["bead.diameter"]).keys[0].determined
    True
    """
    loaded = _loaded(recordings)
    scene = loaded[0].scene if scene is None else checked_scene(scene)
    if scene is None:
        raise ResultError(f"{loaded[0].name}: requires a scene")
    free = (free,) if isinstance(free, str) else tuple(free)
    own = forces_of(forces)
    misfit = Misfit(loaded, scene, free, own)
    for each in loaded:
        _refuse_unsettled(each)
    tell = progress or (lambda _: None)
    best, *others = misfit.minima(lambda part: tell(0.4 * part))
    rivals = [each for each in others if each.value < best.value + _RIVAL]
    p = misfit.p_value(best.at)
    sound = best.converged and p >= REFUTED
    found: list[FittedKey] = []
    for i in range(len(free)):
        tell(0.4 + 0.6 * i / len(free))
        key = _Interval(misfit, best, i).found(rivals, sound=sound)
        if key.uncertainty and misfit.curved(best.at) * abs(key.value) > key.uncertainty:
            key = replace(key, uncertainty=None, determined=False)
        found.append(key)
    tell(1.0)
    return SceneFit(
        tuple(each.name for each in loaded), misfit.scene(best.at), tuple(found), -best.value / 2,
        sum(len(each.times) for each in loaded), p,
        _likelihood(misfit, len(own)), "; ".join(_told(misfit, best, rivals, found, p)),
    )  # fmt: skip


def _loaded(recordings: Any) -> list[Recording]:
    """Return recordings, loading files and datasets; refuse voltages."""
    several = isinstance(recordings, Sequence) and not isinstance(recordings, str)
    loaded = [
        each if isinstance(each, Recording) else load_recording(each)
        for each in (recordings if several else [recordings])
    ]
    if not loaded:
        raise ResultError("recordings: none is given; give one or more")
    for each in loaded:
        if each.unit != "m":
            raise ResultError(
                f"{each.name}: in volts: a scene is fitted to positions in metres; calibrate the "
                "recording first, or give the scale"
            )
    return loaded


def _refuse_unsettled(recording: Recording) -> None:
    """Refuse a recording that begins before the bead has settled; state the time to skip."""
    every = zip(recording.axes, recording.positions.T, strict=True)
    found = [(unsettled(positions, recording.step), axis) for axis, positions in every]
    begins = [(each, axis) for each, axis in found if each is not None]
    if begins:
        farthest, axis = max(begins)
        time = time_taken(max(each.time for each, _ in begins))
        raise ResultError(
            f"{recording.name}: {axis} starts {farthest.off:.2g} standard deviations from the "
            f'median, before the bead has settled; omit the beginning: --skip "{time}", or '
            f'Recording.since("{time}")'
        )


def _likelihood(misfit: Misfit, own: int) -> str:
    """Return the description of the fitted spectra: frequencies, sampling intervals and inertia.

    `own` is the number of the user's own forces.
    """
    steps = [each.step for each in misfit.recordings]
    lowest = min(float(each.periodogram.frequencies[0]) for each in misfit.spectra)
    bands = [_short(lowest, "1/s"), _short(0.5 / min(steps), "1/s")]
    every = list(dict.fromkeys(_short(step, "s") for step in sorted(steps)))
    return (
        f"power spectrum from {bands[0]} to {bands[1]}, steps of {' and '.join(every)}, "
        f"{misfit.inertia.words}{_with_own(own)}"
    )


def _with_own(count: int) -> str:
    """Return text for a number of the user's own forces; "" for none."""
    if not count:
        return ""
    return f", with {count} {'force' if count == 1 else 'forces'} of your own"


def _short(value: float, unit: str) -> str:
    """Return an SI value as text with three digits, in a unit of suitable size."""
    factor, name = usual_unit(value, unit)
    return f"{value / factor:.3g} {name}"


def _told(
    misfit: Misfit,
    best: Least,
    rivals: Sequence[Least],
    found: Sequence[FittedKey],
    p: float,
) -> list[str]:
    """Return sentences on which keys the recordings determine, with the most serious doubts first.

    `rivals` are other minima of the misfit that are not excluded, and `p` is the p-value of the
    fit.
    """
    lines = []
    at_ends = [
        key.key
        for key, place in zip(misfit.keys, best.at, strict=True)
        if abs(place) > key.reach - _AT_END
    ]
    lost = [each.key for each in found if not each.determined and each.key not in at_ends]
    if not best.converged:
        lines.append("the fit has not converged, so its values are unreliable")
    if p < REFUTED:
        lines.append(
            f"the spectrum disagrees with the scene (p = {p:.1g}): a fixed key, the noise, the "
            "exposure or the inertia is wrong for the recording"
        )
    if at_ends:
        lines.append(
            f"{' and '.join(at_ends)} reached the end of its range; start with closer values"
        )
    if lost and not lines:
        lines.append(f"the recording does not determine {' and '.join(lost)}")
        lines += _degenerate(misfit, best, lost) or _rivals(misfit, rivals)
    if not lines:
        lines.append(f"the recording determines {' and '.join(each.key for each in found)}")
    slowest = max(bead.relaxation_time for bead in misfit.beads(best.at))
    length = sum(each.step * len(each.times) for each in misfit.recordings)
    if length < _FEW * slowest:
        lines.append(
            f"only {length / slowest:.2g} relaxation times, so the intervals are too short"
        )
    errors = [(high - low) / 3.92 / abs(each.value) for each in found
              for low, high in [each.interval] if low is not None and high is not None]  # fmt: skip
    off = misfit.curved(best.at)
    if errors and off > _HARM * min(errors):
        lines.append(
            f"the trap is not harmonic, with errors of the values of about {100 * off:.2g} %"
        )
    return lines


def _degenerate(misfit: Misfit, best: Least, lost: Sequence[str]) -> list[str]:
    """Return text on the combination of keys that changes the likelihood least, or nothing.

    `lost` contains the undetermined keys; with fewer than two there is no such combination.
    """
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


def _rivals(misfit: Misfit, rivals: Sequence[Least]) -> list[str]:
    """Return text on the other minima of the misfit that the recordings do not exclude."""
    lines = []
    for rival in rivals:
        values = (
            f"{key.key} = {_short(key.value(float(at)), key.quantity.unit)}"
            for key, at in zip(misfit.keys, rival.at, strict=True)
        )
        lines.append(f"{' with '.join(values)} fits as well")
    return lines


class _Interval:
    """Confidence interval of a key, by the smallest misfit over the other keys.

    `index` is the number of the key and `best` the minimum of the misfit over all keys. A place q
    is the key's coordinate in the fit (`FreeKey`): a logarithm, or a distance in radii.
    """

    def __init__(self, misfit: Misfit, best: Least, index: int) -> None:
        self._misfit, self._best, self._index = misfit, best, index
        self._low, self._high = misfit.bounds[index]
        covariance = np.linalg.inv(best.information + _FAINT * np.eye(len(best.at)))
        variance = float(covariance[index, index])
        self._spread = math.sqrt(variance)
        # change of the other keys at the minimum, per change of this one
        self._along = covariance[:, index] / variance
        self._known: dict[float, float] = {float(best.at[index]): 0.0}

    def found(self, rivals: Sequence[Least], *, sound: bool) -> FittedKey:
        """Return the result for the key.

        `rivals` are other minima that are not excluded, and `sound` is whether the fit is trusted.
        """
        key, at = self._misfit.keys[self._index], float(self._best.at[self._index])
        ends = [self._end(at, way) for way in (-1.0, 1.0)]
        low, high = (None if end is None else key.value(end) for end in ends)
        uncertainty = None
        if sound and low is not None and high is not None:
            others = [key.value(float(each.at[self._index])) for each in rivals]
            if all(low <= other <= high for other in others):
                uncertainty = (high - low) / 3.92
        return FittedKey(
            key.key, key.quantity.unit, key.value(at), uncertainty, (low, high),
            uncertainty is not None,
            tuple((key.value(q), rise) for q, rise in sorted(self._known.items())),
        )  # fmt: skip

    def _rise(self, q: float) -> float:
        """Return the square root of the misfit above its minimum, for the key fixed at place q.

        The other keys are fitted. The square root is nearly linear in the distance from `best`.
        """
        if q not in self._known:
            begin = self._best.at + self._along * (q - self._best.at[self._index])
            begin = np.clip(begin, *self._misfit.bounds.T)
            begin[self._index] = q
            least = self._misfit.least(begin, self._index)
            self._known[q] = least.value - self._best.value
        return math.sqrt(max(self._known[q], 0.0))

    def _end(self, at: float, way: float) -> float | None:
        """Return the place where the misfit exceeds its minimum by 3.84, below or above `at`.

        `way` is -1 for the lower end and 1 for the upper. Returns None if the misfit does not rise
        that much within `_DETERMINED`, or if it jumps there because no such scene exists.
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
            """Return the root of the misfit minus the level, limited where there is no trap."""
            return min(self._rise(q), 10 * level) - level

        tolerance = _END * abs(outer - at)
        end = float(brentq(above, inner, outer, xtol=tolerance, rtol=1e-12))
        return end if self._rise(end - 3 * way * tolerance) > _SMOOTH * level else None
