"""Profile likelihood: the smallest misfit over all other parameters, as a function of one
coordinate.

The misfit is smooth except for jumps, which occur where the number of integration steps changes. It
may have many minima, and it is infinite for impossible parameters. Therefore many trial values are
scanned first. Newton's method then finds the minimum at each point of the scan, starting from the
best trial and from the minima at the neighbouring points.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError

Misfit = Callable[[Array], float]

#: Misfit above the smallest at the ends of a 95 % interval: chi-square, one degree of freedom
LEVEL = 3.841458820694124
#: Number of places in the scan
_PLACES = 81
#: Misfit above the smallest trial beyond which trials are not refined
_DISTANT = 120.0
#: Misfit above the smallest beyond which a place is not refined
_HOPELESS = 30.0
#: Largest jump of the misfit between neighbours near the smallest; at larger ones a place is added
JUMP = 2 * LEVEL
#: Largest number of bisections of a step of the scan at a jump
_HALVINGS = 5
#: Largest number of places added to the scan
_MORE = 80
#: Largest number of steps of Newton's method
_STEPS = 12
#: Gain of misfit below which Newton's method ends
_GAIN = 0.02
#: Misfit that is negligible compared with `LEVEL`
_NOTHING = 0.1
#: Largest number of sweeps in both directions
_SCANS = 4


class Likelihood(Protocol):
    """Misfit for a profile, over a coordinate z, m, and n other parameters p (n,).

    The parameters are in units in which the misfit is smooth, for example logarithms.
    """

    @property
    def unit(self) -> float:
        """Length by which z is divided in a simultaneous fit of z and p, m."""

    @property
    def bounds(self) -> Array:
        """Bounds of p, (n, 2)."""

    @property
    def steps(self) -> Array:
        """Steps over which the misfit is approximately a parabola, in z/unit and p, (n + 1,)."""

    @property
    def trials(self) -> Array:
        """Trial values of p, (trials, n), the most probable first."""

    def misfit(self, z: float, p: Array, most: float = math.inf) -> float:
        """Return -2 log(likelihood); infinite if impossible.

        If the misfit exceeds `most`, any number between the two may be returned, so that the
        computation can stop early.
        """


class Fit(NamedTuple):
    """Minimum of a misfit over n parameters."""

    value: float
    """smallest misfit, -2 log(likelihood)"""
    at: Array
    """(n,) parameters at the minimum"""
    curvature: Array
    """(n, n) second derivatives of the misfit; NaN if they were not computed"""
    converged: bool
    """whether it converged to within `_NOTHING`"""


def descend(misfit: Misfit, begin: Array, bounds: Array, steps: Array) -> Fit:
    """Return the minimum of a misfit that Newton's method reaches from a given point.

    Derivatives are central differences over lengths in which the misfit rises by about 1. The
    absolute values of the curvature's eigenvalues are used, so the step descends (J. Nocedal and S.
    J. Wright, Numerical Optimization, 2006, 3.4). A step is limited to ten of `steps`, and halved
    until the misfit decreases. A parameter at its bound is fixed if the misfit decreases beyond the
    bound.

    Parameters
    ----------
    misfit : callable
        Function of n parameters.
    begin : ndarray, shape (n,)
        Start of the search.
    bounds : ndarray, shape (n, 2)
        Bounds of the parameters.
    steps : ndarray, shape (n,)
        Lengths over which the misfit is approximately a parabola.
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
    """Return the gradient (n,) and the second derivatives (n, n) of `misfit` at `at` (n,).

    `value` is the misfit there, and `steps` (n,) are the lengths of the central differences.
    """
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
    """Return a step (n,) of Newton's method from `at` (n,) that descends and stays in `bounds`.

    `slope` (n,) and `curvature` (n, n) are derivatives of the misfit, `bounds` (n, 2) the ranges of
    the parameters and `longest` (n,) the largest steps. Parameters at a bound beyond which the
    misfit decreases are fixed. Absolute eigenvalues are used, in units of `longest`.
    """
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
    """Profile of the misfit: its minimum over the parameters p, as a function of z.

    The arrays have one row for each point, in ascending order of z: `places` (z, m), `values` (the
    minimum of the misfit), `nuisances` (the p at the minimum) and `converged` (whether the search
    converged).
    """

    def __init__(
        self,
        likelihood: Likelihood,
        search: tuple[float, float],
        progress: Callable[[float], None] | None,
    ) -> None:
        """Scan the range `search` of z, m, omitting points where the motion cannot be computed.

        `progress`, if given, is called with the completed fraction.
        """
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
            raise IntegrationError(
                f"the motion cannot be computed from any z from {low:.6g} to {high:.6g} m"
            )
        self.places, self.values = self.places[followed], self.values[followed]
        self.nuisances, self.converged = self.nuisances[followed], self.converged[followed]

    def _try(self, progress: Callable[[float], None]) -> None:
        """Evaluate all trial values of p at each point, and keep the best."""
        trials = self._likelihood.trials
        for done, p in enumerate(trials, 1):
            for i, z in enumerate(self.places):
                most = min(float(self.values.min()) + _DISTANT, float(self.values[i]))
                value = self._likelihood.misfit(z, p, most)
                if value < self.values[i]:
                    self.values[i], self.nuisances[i] = value, p
            progress(0.5 * done / len(trials))

    def _fitted(self, z: float, begin: Array) -> Fit:
        """Return the minimum over p that is reached from `begin` (n,), at a fixed z, m."""
        known = self._likelihood
        return descend(lambda p: known.misfit(z, p), begin, known.bounds, known.steps[1:])

    def _follow(self, progress: Callable[[float], None]) -> None:
        """Find the minimum at each point from its best trial, then from its neighbours' minima.

        Sweeps in both directions are repeated until no point improves by more than `_NOTHING`. The
        result never exceeds the minimum reached from the left or right neighbour.
        """
        new = np.zeros(_PLACES, dtype=bool)
        for i in np.argsort(self.values):
            if self.values[i] < self.values.min() + _DISTANT:
                new[i] = True
                self._take(i, self._fitted(self.places[i], self.nuisances[i]))
        for scan in range(_SCANS):
            progress(0.6 + 0.4 * scan / _SCANS)
            lower = np.zeros(_PLACES, dtype=bool)  # places that improved in this sweep
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
        """Replace the fit at the point with index i if `found` is not worse."""
        if found.value <= self.values[i]:
            self.values[i], self.nuisances[i] = found.value, found.at
            self.converged[i] = found.converged

    def _sought(self, z: float) -> Fit:
        """Return the better of the fits at z, m, that begin at the p of the adjacent points."""
        right = int(np.clip(np.searchsorted(self.places, z), 1, len(self.places) - 1))
        sides = [self._fitted(z, self.nuisances[i]) for i in (right - 1, right)]
        return min(sides, key=lambda fit: fit.value)

    def above(self, z: float) -> float:
        """Return the profile at z, m, minus its smallest value; the arrays are unchanged."""
        return self._sought(z).value - float(self.values.min())

    def _add(self, z: float, found: Fit) -> None:
        """Insert a point at z, m, with its fit, or improve the existing point there."""
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
        """Indices of the local minima close to the smallest, including ends of the range."""
        around = np.concatenate([[np.inf], self.values, [np.inf]])
        below = (self.values <= around[:-2]) & (self.values < around[2:])
        return np.flatnonzero(below & (self.values < self.values.min() + _HOPELESS))

    def joint(self, i: int) -> Fit:
        """Return the minimum over both z/unit and p that is reached from the point with index i.

        z stays between the neighbours of this point.
        """
        known = self._likelihood
        ends = self.places[[max(i - 1, 0), min(i + 1, len(self.places) - 1)]] / known.unit
        return descend(
            lambda q: known.misfit(known.unit * q[0], q[1:]),
            np.array([self.places[i] / known.unit, *self.nuisances[i]]),
            np.array([ends, *known.bounds]), known.steps,
        )  # fmt: skip

    def polish(self) -> None:
        """Add the exact minima, which usually lie between the points of the scan."""
        for found in [self.joint(i) for i in self.lowest]:
            self._add(self._likelihood.unit * found.at[0], found._replace(at=found.at[1:]))

    def spread(self) -> Array:
        """Standard uncertainties of p, (n,): root mean square deviations from the best fit.

        Each z is weighted with its likelihood. The spread of p around the best fit at each z
        follows from the curvature at the overall best fit, and is NaN if this curvature is not
        positive definite.
        """
        i = int(self.values.argmin())
        curvature = self._fitted(self.places[i], self.nuisances[i]).curvature
        weights = np.gradient(self.places) * np.exp((self.values[i] - self.values) / 2)
        squared = weights @ (self.nuisances - self.nuisances[i]) ** 2 / weights.sum()
        sizes, directions = np.linalg.eigh(curvature)
        inverse = np.where(sizes > 0, 2 / sizes, np.nan)
        return np.sqrt(squared + directions**2 @ inverse)

    def refine(self) -> None:
        """Add points where the profile jumps close to its minimum, in the widest gap first."""
        finest = float(np.diff(self.places).max()) / 2**_HALVINGS
        for _ in range(_MORE):
            gaps = np.diff(self.places) * self.jumps(JUMP)
            widest = int(gaps.argmax())
            if gaps[widest] < 2 * finest:
                return
            z = float(self.places[widest : widest + 2].mean())
            self._add(z, self._sought(z))

    def jumps(self, near: float) -> NDArray[np.bool_]:
        """Return where the profile jumps between neighbours, (places - 1,), and is below `near`."""
        lower = np.minimum(self.values[1:], self.values[:-1]) - self.values.min()
        return (np.abs(np.diff(self.values)) > JUMP) & (lower <= near)


def below(profile: Profile) -> list[tuple[float, float]]:
    """Return the intervals of z, m, in which the misfit exceeds its minimum by at most `LEVEL`."""
    at, values = profile.places, profile.values - profile.values.min()
    inside = values <= LEVEL
    tolerance = 2e-5 * (at[-1] - at[0])
    known = dict(zip(at.tolist(), values.tolist(), strict=True))

    def above(z: float) -> float:
        # use the known value at a place: a repeated fit may differ from it within its tolerance
        return min(known[z] if z in known else profile.above(z), 1e6) - LEVEL

    # z where the misfit crosses the level, by the number of the place before it
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
