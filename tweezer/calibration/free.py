"""Diffusion of a bead that is not trapped, from blurred and noisy positions.

A bead with the diffusion coefficient D and the drift velocity v is recorded at even times, dt
apart. Each position is the mean over an exposure W and has a localisation error of variance
sigma^2. Successive steps, less v dt, have the variance 2 D dt + 2 s, where s = sigma^2 - W D/3.
Neighbouring steps have the covariance -s, and other steps are uncorrelated (C. L. Vestergaard,
P. C. Blainey and H. Flyvbjerg, Phys. Rev. E 89, 022726 (2014)). D is therefore determined for any
exposure and error. A sine transform diagonalises the covariance of the steps, so the likelihood is
exact. Below, A = 2 D dt is the power of the steps at low frequencies, and B = A + 4 s their power
at the Nyquist frequency.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import chdtrc, fdtr, ndtr

from tweezer.calibration.by_axis import ByAxis
from tweezer.calibration.findings import IMPROBABLE, REFUTED, Finding, in_words
from tweezer.calibration.quantities import EXPECTED, FREE_DIFFUSION, INFERRED
from tweezer.calibration.steps import EXACT, Steps
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import ResultError
from tweezer.values.measured import Measured, Result
from tweezer.values.printed import in_unit, printed
from tweezer.values.rounding import with_uncertainty
from tweezer.values.shown import Card, Row

#: Rise of -2 log(likelihood) at the ends of a 95 % interval.
_LEVEL = 3.841
#: Largest step of a bead, in standard deviations; a larger step is excluded as a jump.
_JUMP = 6.0
#: Largest fraction of steps that may be excluded as jumps.
_FEW_JUMPS = 0.01
#: Standard deviation of a Gaussian over its median absolute deviation.
_DEVIATION_PER_MEDIAN = 1.4826
#: Scatter of steps that is rounding alone, over the extent of the record.
_ROUNDING = 1e-12
#: Smallest number of steps between two jumps.
_LEAST_STEPS = 3
#: Range of the search for ln A about its initial value.
_SOUGHT = 5.0
#: Range of the search for the ends of an interval, as logarithms of the ratio to the estimate.
_ENDS = (-12.0, 6.0)
#: Numbers of the slowest ordinates that are compared with the others.
_SLOW = (4, 16, 64)
#: Excess kurtosis above which the tails are heavy, in standard deviations.
_TAILED = 4.0
#: Findings against a trapped bead that a free bead explains.
_OBJECTIONS = {"drift", "noise", "spectrum"}
#: Number of frequency bands in which the mean squared ordinates are tested.
_BANDS = 10
#: Largest number of jumps that are listed.
_TOLD = 3
#: Smallest initial value of A, in mean squared steps.
_LEAST_START = 0.05
#: Smallest squared noise that counts as determined, and the distance of its 95 % upper limit, both
#: in standard uncertainties.
_SEEN, _ONE_SIDED = 3.0, 1.645
#: ln(B/A) above which noise hides the diffusion.
_NO_DIFFUSION = 12.0
#: Smallest ratio B/A that motion blur can cause, for an exposure of the whole sampling interval.
_WHOLE_EXPOSURE = 1 / 3

#: Verdict on a bead that was tested for a trap
_NO_TRAP = "no trap is detected; treated as a free bead"


@dataclass(frozen=True)
class FreeAxis:
    """Diffusion of a free bead along one axis, estimated from this axis alone."""

    axis: str
    """"x", "y" or "z\""""
    diffusion: float
    """maximum-likelihood diffusion coefficient, m^2/s"""
    interval: tuple[float, float]
    """95 % confidence interval of `diffusion`, m^2/s"""
    by_covariance: float
    """estimate from the mean squared step and the mean product of successive steps, m^2/s"""
    by_covariance_uncertainty: float
    """standard uncertainty of `by_covariance`, m^2/s"""
    drift: float
    """mean drift velocity, m/s"""
    drift_uncertainty: float
    """standard uncertainty of `drift`, m/s"""
    noise: float | None
    """standard deviation of the localisation error, m; None if the exposure is unknown, or the
    error is too small to be determined"""
    noise_limit: float | None
    """95 % upper limit of the standard deviation of the localisation error, m; None if the exposure
    is unknown"""
    p_value: float
    """p-value of the fit to the spectrum of the steps"""
    jumps: tuple[int, ...]
    """indices of the samples before which the bead jumped; these steps are excluded. Empty for
    several tracks"""


@dataclass(frozen=True)
class FreeTrack:
    """Diffusion of one of several beads, fitted with the localisation error common to all."""

    name: str
    """name of the track"""
    diffusion: float
    """diffusion coefficient, m^2/s"""
    uncertainty: float
    """standard uncertainty of `diffusion`, m^2/s"""


@dataclass(frozen=True)
class Inferred:
    """Unknown quantity that follows from diffusion and temperature by Einstein's relation."""

    name: str
    """"viscosity" (Pa s), "radius" (m), "drag" (kg/s) or "Boltzmann" (J/K)"""
    value: float
    interval: tuple[float, float]
    """95 % confidence interval of `value`; infinite without an upper end"""


@dataclass(frozen=True, repr=False)
class Diffusion(Result):
    """Diffusion of one or several free beads, from their motion along one or more axes, in SI."""

    QUANTITIES: ClassVar = (FREE_DIFFUSION, *INFERRED.values(), EXPECTED)

    name: str
    """name of the recording, or of the tracks"""
    diffusion: float
    """diffusion coefficient far from walls, m^2/s (V^2/s for a record in volts)"""
    uncertainty: float
    """standard uncertainty of `diffusion`"""
    interval: tuple[float, float]
    """95 % confidence interval, from the profile likelihood; begins at 0 if no diffusion is
    detected"""
    inferred: Inferred | None
    """quantity that follows from the diffusion; None without temperature, or for volts"""
    expected: float | None
    """Einstein's diffusion coefficient, m^2/s; None unless temperature and drag are known"""
    findings: tuple[Finding, ...]
    """reasons not to trust the diffusion"""
    remarks: tuple[str, ...]
    """remarks about steps that were left out or that widen the interval"""
    axes: ByAxis[FreeAxis]
    """diffusion along each axis alone, by index or by name: axes["x"]"""
    tracks: tuple[FreeTrack, ...] = ()
    """results of the single tracks, if there are several"""
    homogeneity: float | None = None
    """p-value for the same diffusion coefficient in all tracks; None for a single track"""

    def coefficient(self, unit: str = "m") -> Measured:
        """Return the diffusion coefficient of a recording in "m" or "V"."""
        of = FREE_DIFFUSION if unit == "m" else FREE_DIFFUSION._replace(unit="V^2/s")
        return of(self.diffusion, self.uncertainty, *(each.text for each in self.findings))

    def quantities(self) -> Iterator[Measured]:
        """Yield the diffusion, the quantity that follows from it, and Einstein's diffusion."""
        yield self.coefficient()
        if (found := self.inferred) is not None:
            yield INFERRED[found.name](
                found.value, found.value * (self.uncertainty / self.diffusion)
            )
        if self.expected is not None:
            yield EXPECTED(self.expected)

    @property
    def _metric(self) -> bool:
        """Whether the diffusion is known to be in m^2/s."""
        return self.inferred is not None or self.expected is not None

    def card(self) -> Card:
        """Return the card with the diffusion, the derived quantities and the findings."""
        low, high = self.interval
        unit = "m^2/s" if self._metric else "in the square of the record's unit per second"
        told = with_uncertainty(self.diffusion, self.uncertainty)
        rows = [
            Row("axes", ", ".join(each.axis for each in self.axes)),
            Row("diffusion", f"{told} (95 %: {low:.3g} to {high:.3g}) {unit}",
                in_words(self.findings), of="diffusion"),
        ]  # fmt: skip
        if (found := self.inferred) is not None:
            factor, unit = (of := INFERRED[found.name]).scale
            low, high = (factor * end for end in found.interval)
            told = f"{factor * found.value:.4g} (95 %: {low:.3g} to {high:.3g}) {unit}"
            rows.append(Row(of.about, told, of=of.name))
        if self.expected is not None:
            rows.append(Row(EXPECTED.about, f"{self.expected:.4g} m^2/s", of=EXPECTED.name))
        return Card("Diffusion", self.name, tuple(rows), notes=self.remarks)

    def line(self, unit: str, seen: str = _NO_TRAP) -> str:
        """Return the diffusion of a recording in one line.

        Parameters
        ----------
        unit : str
            Unit of the positions, "m" or "V".
        seen : str, optional
            Text before the diffusion, about whether a trap was detected.
        """
        axes = ", ".join(each.axis for each in self.axes)
        found = _with_interval(self.coefficient(unit), self.interval)
        parts = [f"{axes}: {seen}: diffusion {found}"]
        if self.inferred is not None and self.interval[0]:
            of = INFERRED[self.inferred.name]
            found = _with_interval(self.numbers[of.name], self.inferred.interval)
            parts.append(f"{of.about} {found}")
        if self.expected is not None:
            parts.append(f"by Einstein the diffusion is {EXPECTED(self.expected).words}")
        return "; ".join(parts)

    def lines(self, unit: str, seen: str = _NO_TRAP) -> Iterator[str]:
        """Yield `line`, then the remarks, the findings and the differences between tracks.

        Parameters
        ----------
        unit : str
            Unit of the positions, "m" or "V".
        seen : str, optional
            Text before the diffusion, about whether a trap was detected.
        """
        yield self.line(unit, seen)
        for text in (*self.remarks, *(f"not trusted: {each.text}" for each in self.findings)):
            yield f"   {text}"
        if self.homogeneity is not None:
            every = [each.diffusion for each in self.tracks]
            of = "um^2/s" if self._metric else "10^-12 V^2/s"
            ends = f"{in_unit(min(every), of, 3)} to {printed(max(every), of, 3)}"
            yield (
                f"   diffusion of single tracks: {ends}; p = {self.homogeneity:.2g} for one "
                "diffusion of all"
            )


def _with_interval(found: Measured, ends: tuple[float, float]) -> str:
    """Return a number and its 95 % interval, with the digits that its uncertainty justifies."""
    low, high = ends
    if not low or not math.isfinite(high):
        factor, unit = found.of.scale
        return f"below {factor * high:.2g} {unit} (95 %)"
    first, last = (found._replace(value=np.array(end)).cells[0] for end in ends)
    return f"{found.words} (95 %: {first} to {last})"


class Given(NamedTuple):
    """Known properties of a free bead, its medium and its recording, in SI; None if unknown."""

    temperature: float | None = None
    radius: float | None = None
    viscosity: float | None = None
    drag: float | None = None
    """Stokes drag far from walls, kg/s"""
    exposure: float | None = None
    noise: Mapping[str, float] = {}
    """standard deviation of the localisation error by axis, m; missing axes are unknown"""
    mobilities: Mapping[str, float] = {}
    """mobility by axis, over the mobility far from walls; 1 for missing axes"""
    unit: str = "m"
    """unit of the positions, "m" or "V\""""
    without: Sequence[tuple[float, float]] = ()
    """bands of frequencies (Hz) that are not used"""


def not_trapped(
    name: str, found: Mapping[str, Sequence[Finding]], positions: Array, step: float, given: Given
) -> Diffusion | None:
    """Return the diffusion along the axes on which no trap is detected, or None if all have one.

    The bead is free along an axis if it looks free, or if it has findings and all of them are
    consistent with a free bead.

    Parameters
    ----------
    name : str
        Name of the recording.
    found : mapping of str to sequence of Finding
        Findings against a trapped bead for each axis.
    positions : ndarray, shape (n, axes)
        Positions, m.
    step : float
        Sampling interval, s.
    given : Given
        Known properties of the bead.
    """

    def fitted(axes: Sequence[str]) -> Diffusion | None:
        """Return the diffusion along some axes; None if it cannot be determined."""
        columns = [i for i, axis in enumerate(found) if axis in axes]
        try:
            return free_bead(name, axes, [positions[:, columns]], step, given)
        except ResultError:
            return None

    def free(axis: str, against: set[str]) -> bool:
        """Return whether the bead is free along an axis, by the names of its findings."""
        if against & {"free", "drift"} == {"free"}:
            return True
        alone = fitted([axis]) if against & _OBJECTIONS else None
        return alone is not None and alone.interval[0] > 0 and not alone.findings

    axes = [axis for axis, each in found.items() if free(axis, {one.name for one in each})]
    return fitted(axes) if axes else None


def free_bead(
    name: str,
    axes: Sequence[str],
    tracks: Sequence[Array],
    step: float,
    given: Given,
    names: Sequence[str] = (),
) -> Diffusion:
    """Return the diffusion of a free bead, or the common diffusion of several beads.

    D maximises the restricted likelihood over D, the drifts and, for each axis, s. If exposure and
    noise are known, s follows from D, unless the recording contradicts it. Steps of more than six
    standard deviations are left out. If the tails of the steps are heavier than a Gaussian's, the
    confidence interval is wider by the same factor.

    The likelihood of several tracks is the product of the likelihoods of the tracks, and each track
    has its own drift. A likelihood ratio tests whether the tracks differ in D (S. S. Wilks, Ann.
    Math. Stat. 9, 60 (1938)).

    Parameters
    ----------
    name : str
    axes : sequence of str
    tracks : sequence of ndarray, shape (n, axes)
        Positions, m, one every `step` (s); NaN where they are missing.
    step : float
    given : Given
    names : sequence of str
        Names of the tracks.

    Raises
    ------
    ResultError
        If all steps are the same, or no four positions are in a row.
    """
    fits = [
        _Fit.of(axis, [each[:, i] for each in tracks], step, given) for i, axis in enumerate(axes)
    ]
    every = [fit for fit in fits if fit is not None]
    if len(every) < len(fits):
        raise ResultError(
            f"{name}: all displacements are equal, so the diffusion coefficient cannot be "
            "determined"
        )

    def misfit(a: float) -> float:
        return sum(fit.misfit(a) for fit in every)

    # best: ln(2 D dt) common to all axes, with D in m^2/s and the sampling interval dt in s
    best, least = _least(misfit, float(np.mean([fit.best for fit in every])))
    informations = [fit.information(best) for fit in every]
    information = sum(informations)
    # the variance of ln D, over that of Gaussian steps
    wider = 1 + sum(
        each**2 * fit.tails / fit.steps.count
        for fit, each in zip(every, informations, strict=True)
    ) / information  # fmt: skip
    ends = _ends(misfit, best, least, _LEVEL * wider)
    D, low, high = (math.exp(a) / (2 * step) for a in (best, *ends))
    error = D * math.sqrt(wider / information)
    if all(fit.noisy(best) for fit in every):
        low = 0.0
    determined = len(names) > 1 and 0 < low < high < math.inf
    if determined:  # fitting a drift uses one step of each track
        error = D * math.log(high / low) / (2 * math.sqrt(_LEVEL))
    findings = [finding for fit in every for finding in fit.findings(step)]
    if determined and not any(each.name == "confined" for each in findings):
        findings += _held(every, best, 2 * (D / error) ** 2)
    apart = max(least - sum(fit.own[2] for fit in every), 0.0) / wider
    unit = "um^2/s" if given.unit == "m" else "10^-12 V^2/s"
    if len(every) > 1 and chdtrc(len(every) - 1, apart) < IMPROBABLE:
        values = " and ".join(in_unit(fit.diffusion(step), unit, 3) for fit in every)
        text = f"its diffusion differs between {' and '.join(axes)}: {values} {unit}"
        findings.append(Finding("axes", text))
    alone, p_value = _alone(every, best, names, step, wider)
    if p_value is not None and p_value < IMPROBABLE:
        farthest = max(alone, key=lambda each: abs(math.log(each.diffusion / D)) / (
            each.uncertainty / each.diffusion
        ))  # fmt: skip
        text = (
            f"the tracks differ in their diffusion (p = {p_value:.2g}), most {farthest.name}: "
            f"{printed(farthest.diffusion, unit, 3)}"
        )
        findings.append(Finding("tracks", text))
    inferred = expected = None
    if given.temperature is not None and given.unit == "m":
        inferred = _inferred(given, D, (low, high))
        if given.drag is not None:
            expected = Boltzmann * given.temperature / given.drag
            rise = max(misfit(math.log(2 * expected * step)) - least, 0.0) / wider
            if chdtrc(1, rise) < IMPROBABLE:
                text = f"its diffusion is {D / expected:.3g} times Einstein's for the given values"
                findings.append(Finding("Einstein", text))
    return Diffusion(
        name, D, error, (low, high), inferred, expected,
        tuple(findings), _remarks(every, step), ByAxis(fit.result(step, given) for fit in every),
        alone, p_value,
    )  # fmt: skip


def _held(fits: Sequence[_Fit], best: float, freedom: float) -> list[Finding]:
    """Return a finding for tracks that end closer to their beginning than those of free beads.

    A drift can only increase the distance. The test is Fisher's F for the fitted drifts. `best` is
    ln(2 D dt), common to all axes, with the diffusion coefficient D, m^2/s, and the sampling
    interval dt, s. `freedom` is the number of degrees of freedom of D.
    """
    squares = np.concatenate([fit.drifts_squared(best) for fit in fits])
    if float(fdtr(len(squares), freedom, squares.mean())) >= IMPROBABLE:
        return []
    text = (
        f"the tracks end closer to their beginning than those of free beads, {squares.mean():.2g} "
        "times the square; the beads may be held"
    )
    return [Finding("confined", text)]


def _alone(
    fits: Sequence[_Fit], best: float, names: Sequence[str], step: float, wider: float
) -> tuple[tuple[FreeTrack, ...], float | None]:
    """Return the diffusion of each of several tracks, and the p-value of a common diffusion.

    `best` is ln(2 D dt), with the common D, m^2/s, and the sampling interval dt = `step`, s. The
    noise along each axis was fitted to all tracks. `wider` is the factor by which heavy tails
    increase the variance of ln D. A single track gives an empty tuple and None.
    """
    if len(names) < 2:
        return (), None
    pairs = [(fit, *fit.noise_beside(best)) for fit in fits]
    gain, found = 0.0, []
    for number, name in enumerate(names):
        parts = [
            (Steps(pieces, step, fit.without, square=fit.steps.square), fit.shift, noise, ratio)
            for fit, noise, ratio in pairs
            if (pieces := [p for p, t in zip(fit.pieces, fit.of_track, strict=True) if t == number])
        ]
        if not parts:
            continue

        def b(a: float, noise: float, ratio: float) -> float:
            """Return ln B for a = ln A, from B = ratio A + noise."""
            return math.log(ratio * math.exp(a) + noise)

        def misfit(a: float, parts: list[tuple[Steps, float, float, float]] = parts) -> float:
            return sum(
                each.misfit(a + shift, b(a + shift, noise, ratio))
                for each, shift, noise, ratio in parts
            )

        own, least = _least(misfit, best)
        gain += max(misfit(best) - least, 0.0)
        information = 0.0
        for each, shift, noise, ratio in parts:
            A = ratio * math.exp(own + shift)
            along = np.array([1.0, A / (A + noise)])
            information += float(
                along @ each.information(own + shift, math.log(A + noise)) @ along
            ) * (1 - 1 / each.count)
        D = math.exp(own) / (2 * step)
        found.append(FreeTrack(name, D, D / math.sqrt(information)))
    return tuple(found), float(chdtrc(max(len(found) - 1, 1), gain / wider))


def _remarks(fits: Sequence[_Fit], step: float) -> tuple[str, ...]:
    """Return remarks on steps excluded as jumps, heavy tails, and steps that look smoothed."""
    said = []
    jumps = [f"{step * jump:.4g} s ({fit.axis})" for fit in fits for jump in fit.jumps]
    if of_all := sum(fit.left_out for fit in fits) - len(jumps):
        said.append(f"omitted: {of_all} steps as jumps")
    if jumps:
        more = ", ..." if len(jumps) > _TOLD else ""
        said.append(f"omitted: jumps before {', '.join(jumps[:_TOLD])}{more}")
    if tailed := [fit.axis for fit in fits if fit.tails]:
        said.append(f"{', '.join(tailed)}: large steps are frequent, so the interval is wider")
    if smoothed := [fit.axis for fit in fits if fit.smoothed]:
        said.append(
            f"{', '.join(smoothed)}: the bead moves less from sample to sample than with the "
            "longest exposure; the positions may be smoothed"
        )
    return tuple(said)


def _least(misfit: Callable[[float], float], about: float) -> tuple[float, float]:
    """Return the argument within `_SOUGHT` of `about` that minimises a misfit, and its minimum."""
    found = minimize_scalar(
        misfit, bounds=(about - _SOUGHT, about + _SOUGHT), method="bounded",
        options={"xatol": EXACT},
    )  # fmt: skip
    return float(found.x), float(found.fun)


def _ends(
    misfit: Callable[[float], float], best: float, least: float, level: float
) -> tuple[float, float]:
    """Return the arguments below and above `best` at which a misfit exceeds `least` by `level`.

    `least` is the misfit at `best`. An end is infinite if the misfit does not rise that much.
    """

    def above(a: float) -> float:
        return misfit(a) - least - level

    low, high = (best + end for end in _ENDS)
    return (
        brentq(above, low, best, xtol=EXACT) if above(low) > 0 else -math.inf,
        brentq(above, best, high, xtol=EXACT) if above(high) > 0 else math.inf,
    )


def _inferred(given: Given, D: float, ends: tuple[float, float]) -> Inferred:
    """Return the unknown quantity in k_B T = 6 pi mu r D (Einstein and Stokes).

    Here mu is the viscosity and r the radius. `D`, m^2/s, has the confidence interval `ends`.
    """
    assert given.temperature is not None
    kT, radius, viscosity = Boltzmann * given.temperature, given.radius, given.viscosity
    if given.drag is not None:
        factor = given.drag / given.temperature
        return Inferred("Boltzmann", factor * D, (factor * ends[0], factor * ends[1]))
    name, factor = "drag", kT
    if radius is not None:
        name, factor = "viscosity", kT / (6 * math.pi * radius)
    elif viscosity is not None:
        name, factor = "radius", kT / (6 * math.pi * viscosity)
    low, high = (factor / end if end else math.inf for end in reversed(ends))
    return Inferred(name, factor / D, (low, high))


@dataclass(frozen=True)
class _Fit:
    """Fit of the diffusion of a free bead along one axis.

    D, m^2/s, is the diffusion coefficient far from walls and dt, s, the sampling interval. The
    parameter common to all axes is ln(2 D dt). The parameter of one axis is ln A, where A is 2 D dt
    times the relative mobility beside walls, in units of the mean squared step. In the same unit,
    B = A + 4 s is the power of the steps at the Nyquist frequency, with -s the covariance of
    successive steps (`Steps`).
    """

    axis: str
    steps: Steps
    shift: float
    """ln A of this axis minus ln(2 D dt)"""
    known: tuple[float, float] | None
    """exposure over sampling interval, and squared noise over mean squared step; None to fit s"""
    jumps: tuple[int, ...]
    """numbers of the samples of a single track before which the bead jumped"""
    left_out: int
    """number of jumps of all tracks"""
    tails: float
    """excess kurtosis of the steps; 0 if it may be due to chance"""
    pieces: Sequence[Array]
    """rows of consecutive steps, m"""
    of_track: Sequence[int]
    """number of the track of each piece"""
    without: Sequence[tuple[float, float]]
    """bands of frequencies (Hz) that are not used"""
    by_covariance: tuple[float, float]
    """diffusion coefficient by covariances of steps, and its standard uncertainty, m^2/s"""
    halves: float
    """difference of the diffusion between the halves of a track, in standard uncertainties"""

    @classmethod
    def of(cls, axis: str, tracks: Sequence[Array], step: float, given: Given) -> _Fit | None:
        """Return the fit to the positions (n,), m, of each track, sampled every `step`, s.

        Jumps are excluded. Returns None if all steps are equal or too few remain.
        """
        moves = [np.diff(x) for x in tracks]
        every = np.concatenate(moves)
        every = every[np.isfinite(every)]
        extent = max((float(np.nanmax(x) - np.nanmin(x)) for x in tracks), default=0.0)
        if not len(every) or np.std(every) <= _ROUNDING * extent:
            return None
        middle = float(np.median(every))
        off = np.abs(every - middle)
        spread = _DEVIATION_PER_MEDIAN * float(np.median(off)) or float(np.std(every))
        limit = _JUMP * spread
        if (off > limit).sum() > _FEW_JUMPS * len(every):
            limit = math.inf
        pieces, of_track, left_out = [], [], 0
        jumps: tuple[int, ...] = ()
        for track, move in enumerate(moves):
            far = np.abs(move - middle) > limit
            left_out += int(far.sum())
            if len(moves) == 1:
                jumps = tuple(map(int, 1 + np.flatnonzero(far)))
            whole = np.concatenate([[False], np.isfinite(move) & ~far, [False]])
            ends = np.flatnonzero(np.diff(whole.astype(int)))
            for first, end in zip(ends[::2], ends[1::2], strict=True):
                if end - first >= _LEAST_STEPS:
                    pieces.append(move[first:end])
                    of_track.append(track)
        if not pieces:
            return None
        numbers = {track: number for number, track in enumerate(dict.fromkeys(of_track))}
        steps = Steps(pieces, step, given.without, [numbers[track] for track in of_track])
        kept = np.concatenate(pieces)
        kurtosis = float(((kept - kept.mean()) ** 4).mean() / np.var(kept) ** 2) - 3
        known = None
        if given.exposure is not None and axis in given.noise:
            known = given.exposure / step, given.noise[axis] ** 2 / steps.square
        mobility = given.mobilities.get(axis, 1.0)
        return cls(
            axis, steps, math.log(mobility / steps.square), known, jumps, left_out,
            kurtosis if kurtosis > _TAILED * math.sqrt(24 / len(kept)) else 0.0,
            pieces, of_track, given.without, *_by_covariance(pieces, of_track, step),
        )  # fmt: skip

    def noisy(self, a: float) -> bool:
        """Return whether noise hides the diffusion, for the common a = ln(2 D dt)."""
        return self._at(a + self.shift)[1] - a - self.shift > _NO_DIFFUSION

    def noise_beside(self, a: float) -> tuple[float, float]:
        """Return a number n and a ratio r such that B = r A + n, for the common a = ln(2 D dt).

        They describe how B of another track follows from its A. If noise prevails, B > A, tracks
        share n = 4 s (and r = 1). If motion blur prevails, they share r = B/A (and n = 0).
        """
        A = math.exp(a + self.shift)
        B = math.exp(self._at(a + self.shift)[1])
        return (B - A, 1.0) if B > A else (0.0, B / A)

    def _noisy(self, a: float) -> tuple[float, float]:
        """Return ln B for the known exposure and noise, and its derivative by a = ln A."""
        assert self.known is not None
        exposure, noise = self.known
        A = math.exp(a)
        B = A * (1 - 2 / 3 * exposure) + 4 * noise
        return math.log(B), (B - 4 * noise) / B

    @cached_property
    def contradicted(self) -> bool:
        """Whether the record excludes the known exposure and noise."""
        if self.known is None:
            return False
        as_known = _least(lambda a: self.steps.misfit(a, self._noisy(a)[0]), self._start)[1]
        fitted = _least(lambda a: self.steps.best(a)[0], self._start)[1]
        return bool(chdtrc(1, max(as_known - fitted, 0.0)) < IMPROBABLE)

    def _at(self, a: float) -> tuple[float, float]:
        """Return the misfit for a = ln A, and the known or best-fitting ln B."""
        if self.known is None or self.contradicted:
            return self.steps.best(a)
        b = self._noisy(a)[0]
        return self.steps.misfit(a, b), b

    @property
    def _start(self) -> float:
        """Initial value of ln A, from the covariances of successive steps."""
        D, _ = self.by_covariance
        return math.log(max(2 * D * self.steps.step / self.steps.square, _LEAST_START))

    @cached_property
    def own(self) -> tuple[float, float, float]:
        """ln A and ln B that minimise the misfit of this axis, and this misfit."""
        a, least = _least(lambda a: self._at(a)[0], self._start)
        return a, self._at(a)[1], least

    @property
    def best(self) -> float:
        """ln(2 D dt), with 2 D dt in m^2, that fits this axis best."""
        return self.own[0] - self.shift

    def drifts_squared(self, a: float) -> Array:
        """Return the squared ratio of each track's drift to its uncertainty, (tracks,).

        `a` is the common ln(2 D dt).
        """
        drifts, errors = self.steps.drifts(a + self.shift, self._at(a + self.shift)[1])
        return np.asarray((drifts / errors) ** 2)

    def misfit(self, a: float) -> float:
        """Return -2 log(likelihood) for the common a = ln(2 D dt).

        The likelihood is integrated over the drifts and maximised over s, unless s is known.
        """
        return self._at(a + self.shift)[0]

    def diffusion(self, step: float) -> float:
        """Return the diffusion coefficient along this axis, m^2/s, for sampling every `step`, s."""
        return math.exp(self.own[0]) * self.steps.square / (2 * step)

    def information(self, a: float) -> float:
        """Return Fisher's information on the common a = ln(2 D dt)."""
        own = a + self.shift
        b = self._at(own)[1]
        drifts = len(set(self.of_track))
        matrix = self.steps.information(own, b) * (1 - drifts / self.steps.count)
        if self.known is None or self.contradicted:
            return float(matrix[0, 0] - matrix[0, 1] ** 2 / matrix[1, 1])
        along = np.array([1.0, self._noisy(own)[1]])
        return float(along @ matrix @ along)

    def findings(self, step: float) -> Iterator[Finding]:
        """Yield the findings against a free bead with a steady drift, sampled every `step`, s."""
        ratios, means = self.steps.ratios(*self.own[:2])
        if self.contradicted:
            text = "the given exposure and noise contradict the recording; both are fitted"
            yield Finding("noise", f"{self.axis}: {text}")
        tracks = len(set(self.of_track))
        slow = [tracks * each for each in _SLOW if tracks * each <= len(ratios) // 4]
        slow = slow or [max(len(ratios) // 4, 1)]
        sums = [(float(means[:each].sum()), float(ratios[:each].sum())) for each in slow]
        more = [float(chdtrc(freedom, total)) for freedom, total in sums]
        less = [1 - each for each in more]
        duration = self.steps.count * step
        if min(more) < IMPROBABLE / len(slow):
            n = slow[int(np.argmin(more))]
            text = f"its drift changes, at frequencies below {n / (2 * duration):.2g} Hz"
            yield Finding("drift", f"{self.axis}: {text}")
        elif min(less) < IMPROBABLE / len(slow):
            n = slow[int(np.argmin(less))]
            text = f"it moves less than a free bead over {2 * duration / n:.2g} s or more"
            yield Finding("confined", f"{self.axis}: {text}; it may be held")
        elif self.p_value < REFUTED:
            text = "its steps disagree with a free bead with motion blur and noise"
            yield Finding("spectrum", f"{self.axis}: {text}")
        if 2 * float(ndtr(-abs(self.halves))) < IMPROBABLE / 10:
            yield Finding("halves", f"{self.axis}: the diffusion differs between its halves")

    @cached_property
    def p_value(self) -> float:
        """Probability of a spectrum of the steps that differs at least as much from the fit.

        The chi-square test compares the mean squares in ten bands, with two degrees of freedom used
        by A and B.
        """
        ratios, means = (np.array_split(each, _BANDS) for each in self.steps.ratios(*self.own[:2]))
        squares = sum(
            float(band.sum() - mean.sum()) ** 2 / (2 * float(mean.sum()))
            for band, mean in zip(ratios, means, strict=True)
        )
        return float(chdtrc(_BANDS - 2, squares))

    @property
    def smoothed(self) -> bool:
        """Whether the bead moves less between samples than with an exposure of a whole interval."""
        a, b, least = self.own
        rise = self.steps.misfit(a, a + math.log(_WHOLE_EXPOSURE)) - least
        return b - a < math.log(_WHOLE_EXPOSURE) and bool(chdtrc(1, max(rise, 0.0)) < IMPROBABLE)

    def result(self, step: float, given: Given) -> FreeAxis:
        """Return the result for this axis, sampled every `step`, s."""
        a, b, least = self.own
        wider = 1 + self.tails * self.information(self.best) / self.steps.count
        ends = _ends(lambda a: self._at(a)[0], a, least, _LEVEL * wider)
        unit = self.steps.square / (2 * step)
        noise: tuple[float | None, float | None] = (None, None)
        if given.exposure is not None:
            noise = self._noise(given.exposure / step)
        return FreeAxis(
            self.axis, unit * math.exp(a), (unit * math.exp(ends[0]), unit * math.exp(ends[1])),
            *self.by_covariance, *self._drift(a, b), *noise, self.p_value, self.jumps,
        )  # fmt: skip

    def _drift(self, a: float, b: float) -> tuple[float, float]:
        """Return the mean drift of the tracks and its standard uncertainty, m/s.

        `a` and `b` are ln A and ln B. The drifts are weighted by their uncertainties.
        """
        drifts, errors = self.steps.drifts(a, b)
        weights = 1 / errors**2
        return float(weights @ drifts / weights.sum()), 1 / math.sqrt(weights.sum())

    def _noise(self, exposure: float) -> tuple[float | None, float]:
        """Return the standard deviation of the localisation error, m, and its 95 % upper limit.

        The former is None if the error is too small to be determined. `exposure` is the exposure
        time over the sampling interval.
        """
        A, B = map(math.exp, self.own[:2])
        slopes = np.array([A * (exposure / 6 - 1 / 4), B / 4])
        square = float(slopes.sum())
        covariance = np.linalg.pinv(self.steps.information(*self.own[:2]))
        error = math.sqrt(float(slopes @ covariance @ slopes))
        unit = math.sqrt(self.steps.square)
        seen = unit * math.sqrt(square) if square > _SEEN * error else None
        return seen, unit * math.sqrt(max(square, 0.0) + _ONE_SIDED * error)


def _by_covariance(
    pieces: Sequence[Array], of_track: Sequence[int], step: float
) -> tuple[tuple[float, float], float]:
    """Return the diffusion and its uncertainty, m^2/s, and the difference between the halves.

    The estimate uses the mean squared step and the mean product of successive steps (equations (14)
    and (16) of Vestergaard et al.), after subtracting the mean step of each track. `pieces` are
    rows of steps, m, sampled every `step`, s, and `of_track` contains the track number of each. The
    difference is in standard uncertainties, and 0 for several tracks.
    """
    tracks = set(of_track)
    count = sum(map(len, pieces)) / len(tracks)
    drift = {
        track: float(np.concatenate(own).mean())
        for track in tracks
        if (own := [piece for piece, of in zip(pieces, of_track, strict=True) if of == track])
    }
    off = [piece - drift[track] for piece, track in zip(pieces, of_track, strict=True)]
    squares = np.concatenate([piece[:-1] ** 2 for piece in off])
    products = np.concatenate([piece[:-1] * piece[1:] for piece in off])

    def estimated(part: slice) -> tuple[float, float]:
        """Return diffusion and uncertainty, m^2/s, from a part of the squares and products."""
        square, product = float(squares[part].mean()), float(products[part].mean())
        n = len(squares[part])
        D, s = (square / 2 + product) / step, -product
        ratio = s / (D * step)  # epsilon in Vestergaard et al.
        relative = (6 + 4 * ratio + 2 * ratio**2) / n + 4 * (1 + ratio) ** 2 / n**2
        return D * (1 + 3 / count), abs(D) * math.sqrt(relative)

    if len(tracks) > 1:
        return estimated(slice(None)), 0.0
    half = len(squares) // 2
    (first, error), (second, other) = estimated(slice(half)), estimated(slice(half, None))
    return estimated(slice(None)), (first - second) / math.hypot(error, other)
