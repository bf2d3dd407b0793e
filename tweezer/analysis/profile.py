"""Least misfit over a coordinate, with all that is fitted besides it: a profile likelihood.

The misfit is smooth but for what the steps of an integration leave, may have many minima, and may
be impossible, infinite, at places. So it is tried at many points first, then followed to the minima
by Newton's method, from each place and from the places beside it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from tweezer.errors import IntegrationError

Array = NDArray[np.float64]
Misfit = Callable[[Array], float]

#: 95 % of chi-square with one degree of freedom: what the misfit may be above its least
LEVEL = 3.841458820694124
#: places of the scan
_PLACES = 81
#: misfit above the least of the trials from which on they are not followed further
_DISTANT = 120.0
#: misfit above the least from which on a place is not fitted better
_HOPELESS = 30.0
#: misfit between neighbours near the least from which on there should be a place between them
JUMP = 2 * LEVEL
#: how often a step of the scan is halved for a jump, and how many places there may be more
_HALVINGS, _MORE = 5, 80
#: Newton's method: most steps; the gain of misfit at which it ends
_STEPS, _GAIN = 12, 0.02
#: misfit that is next to nothing, against `LEVEL`
_NOTHING = 0.1
#: most scans to and fro
_SCANS = 4


class Likelihood(Protocol):
    """What a profile is of; p: what is fitted besides z, in units of its own."""

    @property
    def unit(self) -> float:
        """Of z."""

    @property
    def bounds(self) -> Array:
        """(n, 2) of p."""

    @property
    def steps(self) -> Array:
        """(n,) over which the misfit is about a parabola; the first of them in z, (n + 1,)."""

    @property
    def trials(self) -> Array:
        """(trials, n) p to begin with, the likeliest first."""

    def misfit(self, z: float, p: Array, most: float = math.inf) -> float:
        """-2 log(likelihood), or a number between `most` and it; infinite where impossible."""


class Fit(NamedTuple):
    """A minimum."""

    value: float
    at: Array
    """(n,)"""
    curvature: Array
    """(n, n) second derivatives"""
    converged: bool
    """whether no more than `_NOTHING` was to be gained"""


def descend(misfit: Misfit, begin: Array, bounds: Array, steps: Array) -> Fit:
    """The minimum below a point, by Newton's method.

    Derivatives are by central differences, over which the misfit rises by about 1. The step goes
    down in every direction of curvature, for its size is taken without its sign (J. Nocedal and S.
    J. Wright, Numerical Optimization, 2006, 3.4); it goes no further than ten of `steps`, and is
    halved until the misfit falls. What meets its bound stays there if the misfit falls beyond it.
    """
    at, value, longest = begin, misfit(begin), 10 * steps
    curvature = np.full((len(at), len(at)), np.nan)
    gain, few = math.inf, steps
    for _ in range(_STEPS):
        if not (len(at) and math.isfinite(value)):
            break
        slope, curvature = _derivatives(misfit, at, value, few)
        if not (np.isfinite(slope).all() and np.isfinite(curvature).all()):
            break
        rise = np.diag(curvature)
        few = np.clip(np.sqrt(2 / np.maximum(rise, 1e-12)), steps / 30, 3 * steps)
        step = _newton_step(at, slope, curvature, bounds, longest)
        gain = -float(slope @ step) / 2
        if gain < _GAIN:
            break
        for halved in 0.5 ** np.arange(6):
            trial = np.clip(at + halved * step, *bounds.T)
            reached = misfit(trial)
            if reached < value:
                break
        else:
            break
        at, value = trial, reached
    return Fit(value, at, curvature, not len(at) or gain < _NOTHING)


def _derivatives(misfit: Misfit, at: Array, value: float, steps: Array) -> tuple[Array, Array]:
    """Slope (n,) and curvature (n, n), by differences."""
    n = len(at)
    aside = np.diag(steps)
    above = np.array([misfit(at + each) for each in aside])
    below = np.array([misfit(at - each) for each in aside])
    curvature = np.diag((above + below - 2 * value) / steps**2)
    for i in range(n):
        for j in range(i):
            both = misfit(at + aside[i] + aside[j])
            curvature[i, j] = (both - above[i] - above[j] + value) / (steps[i] * steps[j])
            curvature[j, i] = curvature[i, j]
    return (above - below) / (2 * steps), curvature


def _newton_step(at: Array, slope: Array, curvature: Array, bounds: Array, longest: Array) -> Array:
    low, high = bounds.T
    free = ~(((at <= low) & (slope > 0)) | ((at >= high) & (slope < 0)))
    step = np.zeros(len(at))
    if free.any():
        scale = longest[free]
        sizes, directions = np.linalg.eigh(curvature[np.ix_(free, free)] * np.outer(scale, scale))
        along = directions.T @ (slope[free] * scale)
        step[free] = scale * (directions @ (-along / np.maximum(np.abs(sizes), 1e-3)))
    step /= max(1.0, float(np.max(np.abs(step) / longest, initial=0.0)))
    return np.clip(at + step, low, high) - at


class Profile:
    """The least misfit over z, at the places where it has been sought."""

    def __init__(
        self,
        likelihood: Likelihood,
        search: tuple[float, float],
        progress: Callable[[float], None] | None,
    ) -> None:
        """The scan; a place that cannot be followed is left out."""
        self._likelihood = likelihood
        self.places = np.linspace(*search, _PLACES)
        self.values = np.full(_PLACES, np.inf)
        self.nuisances = np.tile(likelihood.trials[0], (_PLACES, 1))
        self.converged = np.ones(_PLACES, dtype=bool)
        tell = progress or (lambda _: None)
        self._try(tell)
        self._follow(tell)
        followed = np.isfinite(self.values)
        if not followed.any():
            low, high = search
            raise IntegrationError(f"no motion from z = {low:.6g} to {high:.6g} m can be followed")
        self.places, self.values = self.places[followed], self.values[followed]
        self.nuisances, self.converged = self.nuisances[followed], self.converged[followed]

    def _try(self, progress: Callable[[float], None]) -> None:
        """The best of the trials at each place."""
        trials = self._likelihood.trials
        for done, p in enumerate(trials, 1):
            for i, z in enumerate(self.places):
                most = min(float(self.values.min()) + _DISTANT, float(self.values[i]))
                value = self._likelihood.misfit(z, p, most)
                if value < self.values[i]:
                    self.values[i], self.nuisances[i] = value, p
            progress(0.5 * done / len(trials))

    def _fitted(self, z: float, begin: Array) -> Fit:
        known = self._likelihood
        return descend(lambda p: known.misfit(z, p), begin, known.bounds, known.steps[1:])

    def _follow(self, progress: Callable[[float], None]) -> None:
        """The minima below the trials; then from place to place, until there is no less.

        What is found is no more than what can be followed to from the left, and from the right.
        """
        new = np.zeros(_PLACES, dtype=bool)
        for i in np.argsort(self.values):
            if self.values[i] < self.values.min() + _DISTANT:
                new[i] = True
                self._take(i, self._fitted(self.places[i], self.nuisances[i]))
        for scan in range(_SCANS):
            progress(0.6 + 0.4 * scan / _SCANS)
            lower = np.zeros(_PLACES, dtype=bool)
            for way, order in ((1, range(1, _PLACES)), (-1, range(_PLACES - 2, -1, -1))):
                for i in order:
                    near = self.values[i - way] < self.values.min() + _HOPELESS
                    if near and (new | lower)[i - way]:
                        found = self._fitted(self.places[i], self.nuisances[i - way])
                        lower[i] |= found.value < self.values[i] - _NOTHING
                        self._take(i, found)
            new = lower
            if not new.any():
                break
        self.converged &= ~new
        progress(1.0)

    def _take(self, i: int, found: Fit) -> None:
        if found.value <= self.values[i]:
            self.values[i], self.nuisances[i] = found.value, found.at
            self.converged[i] = found.converged

    def _sought(self, z: float) -> Fit:
        """From the places on both sides."""
        right = int(np.clip(np.searchsorted(self.places, z), 1, len(self.places) - 1))
        sides = [self._fitted(z, self.nuisances[i]) for i in (right - 1, right)]
        return min(sides, key=lambda fit: fit.value)

    def above(self, z: float) -> float:
        """The misfit above the least, at any z; the places stay as they are."""
        return self._sought(z).value - float(self.values.min())

    def _add(self, z: float, found: Fit) -> None:
        i = int(np.searchsorted(self.places, z))
        if i < len(self.places) and self.places[i] == z:
            self._take(i, found)
            return
        self.places = np.insert(self.places, i, z)
        self.values = np.insert(self.values, i, found.value)
        self.nuisances = np.insert(self.nuisances, i, found.at, axis=0)
        self.converged = np.insert(self.converged, i, found.converged)

    @property
    def lowest(self) -> NDArray[np.intp]:
        """The places of the minima that are near the least, the ends of the search among them."""
        around = np.concatenate([[np.inf], self.values, [np.inf]])
        below = (self.values <= around[:-2]) & (self.values < around[2:])
        return np.flatnonzero(below & (self.values < self.values.min() + _HOPELESS))

    def joint(self, i: int) -> Fit:
        """The minimum over z/unit and p below a place, between the places beside it."""
        known = self._likelihood
        ends = self.places[[max(i - 1, 0), min(i + 1, len(self.places) - 1)]] / known.unit
        return descend(
            lambda q: known.misfit(known.unit * q[0], q[1:]),
            np.array([self.places[i] / known.unit, *self.nuisances[i]]),
            np.array([ends, *known.bounds]), known.steps,
        )  # fmt: skip

    def polish(self) -> None:
        """Add the minima between the places."""
        for found in [self.joint(i) for i in self.lowest]:
            self._add(self._likelihood.unit * found.at[0], found._replace(at=found.at[1:]))

    def spread(self) -> Array:
        """(n,) standard uncertainties of p: root mean square deviations from the best.

        A start is as likely as its misfit says; about what fits best there p is spread as the
        curvature at the best says, NaN where that is none of a minimum.
        """
        i = int(self.values.argmin())
        curvature = self._fitted(self.places[i], self.nuisances[i]).curvature
        weights = np.gradient(self.places) * np.exp((self.values[i] - self.values) / 2)
        squared = weights @ (self.nuisances - self.nuisances[i]) ** 2 / weights.sum()
        sizes, directions = np.linalg.eigh(curvature)
        inverse = np.where(sizes > 0, 2 / sizes, np.nan)
        return np.sqrt(squared + directions**2 @ inverse)

    def refine(self) -> None:
        """Add places where the misfit jumps near the least, the widest gap first."""
        finest = float(np.diff(self.places).max()) / 2**_HALVINGS
        for _ in range(_MORE):
            gaps = np.diff(self.places) * self.jumps(JUMP)
            widest = int(gaps.argmax())
            if gaps[widest] < 2 * finest:
                return
            z = float(self.places[widest : widest + 2].mean())
            self._add(z, self._sought(z))

    def jumps(self, near: float) -> NDArray[np.bool_]:
        """(places - 1,) where the misfit jumps from one place to the next, one within `near`."""
        lower = np.minimum(self.values[1:], self.values[:-1]) - self.values.min()
        return (np.abs(np.diff(self.values)) > JUMP) & (lower <= near)


def below(profile: Profile) -> list[tuple[float, float]]:
    """Where the misfit is below the level: pieces between its crossings."""
    at, values = profile.places, profile.values - profile.values.min()
    inside = values <= LEVEL
    tolerance = 2e-5 * (at[-1] - at[0])
    known = dict(zip(at.tolist(), values.tolist(), strict=True))

    def above(z: float) -> float:
        # what was found there: found again it may differ by what a fit is exact to
        return min(known[z] if z in known else profile.above(z), 1e6) - LEVEL

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
