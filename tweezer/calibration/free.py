"""A bead that is not trapped: its diffusion, by blurred and noisy positions, and what follows.

Positions at even times of a bead with diffusion D and drift v, each the mean over an exposure W and
with a localisation error of variance sigma^2. Successive steps, less v dt, have the variance
2 D dt + 2 s and the covariance -s with their neighbours, s = sigma^2 - W D/3, and no other
(C. L. Vestergaard, P. C. Blainey and H. Flyvbjerg, Phys. Rev. E 89, 022726 (2014)): D is told
whatever blur and error are. Sines diagonalise that covariance, so that the likelihood is exact.
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

#: Rise of twice the negative log-likelihood at the ends of a 95 % interval.
_LEVEL = 3.841
#: Largest step of a bead, in standard deviations; a larger one is a jump, and left out.
_JUMP = 6.0
#: Largest fraction of the steps that are left out as jumps.
_FEW_JUMPS = 0.01
#: Standard deviation of a Gaussian over its median absolute deviation.
_DEVIATION_PER_MEDIAN = 1.4826
#: Scatter of steps that is only rounding, of the extent of a record.
_ROUNDING = 1e-12
#: Smallest number of steps between two jumps.
_LEAST_STEPS = 3
#: Range of ln A about its start, in a fit.
_SOUGHT = 5.0
#: Lowest and highest end of an interval, as logarithms of the ratio to the estimate.
_ENDS = (-12.0, 6.0)
#: Numbers of the slowest ordinates that are compared with the others.
_SLOW = (4, 16, 64)
#: Excess kurtosis that is not chance, in its standard deviations.
_TAILED = 4.0
#: Findings against a trapped bead that a free one can explain.
_OBJECTIONS = {"drift", "noise", "spectrum"}
#: Number of bands of the spectrum whose mean squares are compared.
_BANDS = 10
#: Largest number of jumps that are told.
_TOLD = 3
#: Smallest A, in mean squared steps, from which a fit starts.
_LEAST_START = 0.05
#: Squared noise that is seen, in its standard uncertainties, and the 95 % upper limit of any.
_SEEN, _ONE_SIDED = 3.0, 1.645
#: Smallest logarithm of B/A at which only noise is visible.
_NO_DIFFUSION = 12.0
#: Smallest ratio B/A that an exposure leaves: that of an exposure of the whole step.
_WHOLE_EXPOSURE = 1 / 3

#: Verdict on a bead that was tested for a trap
_NO_TRAP = "no trap is detected; treated as a free bead"


@dataclass(frozen=True)
class FreeAxis:
    """The diffusion along one axis, by itself."""

    axis: str
    diffusion: float
    """by likelihood, m^2/s"""
    interval: tuple[float, float]
    """95 %, m^2/s"""
    by_covariance: float
    """by the means of squared steps and of products of successive ones, m^2/s"""
    by_covariance_uncertainty: float
    """its standard uncertainty, m^2/s"""
    drift: float
    """m/s"""
    drift_uncertainty: float
    """standard uncertainty, m/s"""
    noise: float | None
    """standard deviation of the localisation error, m; None if the exposure is not known, or it is
    not seen"""
    noise_limit: float | None
    """95 % upper limit of it, m; None if the exposure is not known"""
    p_value: float
    """probability of a spectrum of the steps that differs as much or more, in ten bands"""
    jumps: tuple[int, ...]
    """samples before which the bead jumped: those steps are left out; of several tracks none"""


@dataclass(frozen=True)
class FreeTrack:
    """The diffusion of one bead of several, with the localisation error of all."""

    name: str
    diffusion: float
    """m^2/s"""
    uncertainty: float
    """standard uncertainty, m^2/s"""


@dataclass(frozen=True)
class Inferred:
    """What diffusion, temperature and Einstein's relation tell of what is not given."""

    name: str
    """"viscosity" (Pa s), "radius" (m), "drag" (kg/s) or "Boltzmann" (J/K)"""
    value: float
    interval: tuple[float, float]
    """95 %; infinite without an upper end"""


@dataclass(frozen=True, repr=False)
class Diffusion(Result):
    """The diffusion of a free bead, by its motion along one or more axes, SI."""

    QUANTITIES: ClassVar = (FREE_DIFFUSION, *INFERRED.values(), EXPECTED)

    name: str
    diffusion: float
    """far from walls, m^2/s (V^2/s for a record in volts)"""
    uncertainty: float
    """standard uncertainty"""
    interval: tuple[float, float]
    """95 %, by the profile of the likelihood; from 0 if no diffusion is seen"""
    inferred: Inferred | None
    """None without a temperature, or for a record in volts"""
    expected: float | None
    """by Einstein, m^2/s; None unless temperature and drag are known"""
    findings: tuple[Finding, ...]
    """what speaks against it"""
    remarks: tuple[str, ...]
    """what was left out, or widens the interval"""
    axes: ByAxis[FreeAxis]
    """by number or by name: axes["x"]"""
    tracks: tuple[FreeTrack, ...] = ()
    """results of the single tracks, if there are several"""
    homogeneity: float | None = None
    """probability of tracks that differ as much or more; None for a single track"""

    def coefficient(self, unit: str = "m") -> Measured:
        """Return the diffusion coefficient of a recording in "m" or "V"."""
        of = FREE_DIFFUSION if unit == "m" else FREE_DIFFUSION._replace(unit="V^2/s")
        return of(self.diffusion, self.uncertainty, *(each.text for each in self.findings))

    def quantities(self) -> Iterator[Measured]:
        """The diffusion, the quantity that follows from it, and the diffusion by Einstein."""
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
        """The diffusion, and what it tells, with what speaks against it."""
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
        """Return the diffusion of a recording in "m" or "V" in one line.

        `seen` is what the line says of the bead before its diffusion.
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
        """Yield that line; below it what was left out, the findings, and how the tracks differ."""
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
    """Return a number with its 95 % interval, with as many digits as its uncertainty leaves."""
    low, high = ends
    if not low or not math.isfinite(high):
        factor, unit = found.of.scale
        return f"below {factor * high:.2g} {unit} (95 %)"
    first, last = (found._replace(value=np.array(end)).cells[0] for end in ends)
    return f"{found.words} (95 %: {first} to {last})"


class Given(NamedTuple):
    """What is known of a free bead, SI; None: not known."""

    temperature: float | None = None
    radius: float | None = None
    viscosity: float | None = None
    drag: float | None = None
    """far from walls; with the radius and the viscosity it is theirs"""
    exposure: float | None = None
    noise: Mapping[str, float] = {}
    """along each axis; none: not known"""
    mobilities: Mapping[str, float] = {}
    """along each axis, of that far from walls: 1 if not given"""
    unit: str = "m"
    """of the positions"""
    without: Sequence[tuple[float, float]] = ()
    """bands of frequencies (Hz) that are not used"""


def not_trapped(
    name: str, found: Mapping[str, Sequence[Finding]], positions: Array, step: float, given: Given
) -> Diffusion | None:
    """Return the diffusion along the axes without a detected trap; None if there is no such axis.

    `found` contains the findings against a trapped bead for each axis of the positions (n, axes).
    An axis is free if it looks free, or if it has other findings but none against a free bead.
    """

    def fitted(axes: Sequence[str]) -> Diffusion | None:
        columns = [i for i, axis in enumerate(found) if axis in axes]
        try:
            return free_bead(name, axes, [positions[:, columns]], step, given)
        except ResultError:
            return None

    def free(axis: str, against: set[str]) -> bool:
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
        raise ResultError(f"{name}: all of its steps are the same: no diffusion to tell")

    def misfit(a: float) -> float:
        return sum(fit.misfit(a) for fit in every)

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
    if determined:  # each drift takes a step of its track
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
                text = f"its diffusion is {D / expected:.3g} times Einstein's for what is given"
                findings.append(Finding("Einstein", text))
    return Diffusion(
        name, D, error, (low, high), inferred, expected,
        tuple(findings), _remarks(every, step), ByAxis(fit.result(step, given) for fit in every),
        alone, p_value,
    )  # fmt: skip


def _held(fits: Sequence[_Fit], best: float, freedom: float) -> list[Finding]:
    """Return a finding for tracks that end closer to their beginning than those of free beads.

    A drift can only lead away from the beginning. The test is Fisher's F for the fitted drifts;
    `freedom` is the number of degrees of freedom of D.
    """
    squares = np.concatenate([fit.drifts_squared(best) for fit in fits])
    if float(fdtr(len(squares), freedom, squares.mean())) >= IMPROBABLE:
        return []
    text = (
        f"the tracks end closer to their beginning than those of free beads, {squares.mean():.2g} "
        "times the square: are the beads held?"
    )
    return [Finding("confined", text)]


def _alone(
    fits: Sequence[_Fit], best: float, names: Sequence[str], step: float, wider: float
) -> tuple[tuple[FreeTrack, ...], float | None]:
    """Each of several tracks by itself, and the probability of tracks that differ as much."""
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
    """What was left out, what widens the interval, and what looks odd."""
    said = []
    jumps = [f"{step * jump:.4g} s ({fit.axis})" for fit in fits for jump in fit.jumps]
    if of_all := sum(fit.left_out for fit in fits) - len(jumps):
        said.append(f"left out: {of_all} steps as jumps")
    if jumps:
        more = ", ..." if len(jumps) > _TOLD else ""
        said.append(f"left out: jumps before {', '.join(jumps[:_TOLD])}{more}")
    if tailed := [fit.axis for fit in fits if fit.tails]:
        said.append(f"{', '.join(tailed)}: large steps are frequent, so that the interval is wider")
    if smoothed := [fit.axis for fit in fits if fit.smoothed]:
        said.append(
            f"{', '.join(smoothed)}: the bead moves less from sample to sample than a whole "
            "exposure leaves: are the positions smoothed?"
        )
    return tuple(said)


def _least(misfit: Callable[[float], float], about: float) -> tuple[float, float]:
    """Where it is smallest, and that misfit."""
    found = minimize_scalar(
        misfit, bounds=(about - _SOUGHT, about + _SOUGHT), method="bounded",
        options={"xatol": EXACT},
    )  # fmt: skip
    return float(found.x), float(found.fun)


def _ends(
    misfit: Callable[[float], float], best: float, least: float, level: float
) -> tuple[float, float]:
    """Where the misfit has risen by `level`; infinite where it does not."""

    def above(a: float) -> float:
        return misfit(a) - least - level

    low, high = (best + end for end in _ENDS)
    return (
        brentq(above, low, best, xtol=EXACT) if above(low) > 0 else -math.inf,
        brentq(above, best, high, xtol=EXACT) if above(high) > 0 else math.inf,
    )


def _inferred(given: Given, D: float, ends: tuple[float, float]) -> Inferred:
    """By Einstein and Stokes, k_B T = 6 pi mu r D."""
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
    """One axis by itself. The unknown a is ln(2 D dt), D in m^2/s far from walls."""

    axis: str
    steps: Steps
    shift: float
    """ln A is a + shift"""
    known: tuple[float, float] | None
    """exposure over the step, and squared noise over the mean squared step; None: s is fitted"""
    jumps: tuple[int, ...]
    """samples of a single track before which the bead jumped"""
    left_out: int
    """number of jumps of all tracks"""
    tails: float
    """excess kurtosis of the steps; 0 if that may be chance"""
    pieces: Sequence[Array]
    """steps in a row, m"""
    of_track: Sequence[int]
    """number of the track of each piece"""
    without: Sequence[tuple[float, float]]
    """bands of frequencies (Hz) that are not used"""
    by_covariance: tuple[float, float]
    halves: float
    """difference of the diffusion between the halves, in its standard uncertainties"""

    @classmethod
    def of(cls, axis: str, tracks: Sequence[Array], step: float, given: Given) -> _Fit | None:
        """Return the fit of positions (n,), m, of each track; None if all steps are the same."""
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
        """Return whether no diffusion is seen beside the noise, at the common a."""
        return self._at(a + self.shift)[1] - a - self.shift > _NO_DIFFUSION

    def noise_beside(self, a: float) -> tuple[float, float]:
        """4 s where noise prevails, and B/A where the exposure does, at the common a."""
        A = math.exp(a + self.shift)
        B = math.exp(self._at(a + self.shift)[1])
        return (B - A, 1.0) if B > A else (0.0, B / A)

    def _noisy(self, a: float) -> tuple[float, float]:
        """ln B as exposure and noise make it, and its slope by ln A."""
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
        """The smallest misfit with that ln A, and its ln B."""
        if self.known is None or self.contradicted:
            return self.steps.best(a)
        b = self._noisy(a)[0]
        return self.steps.misfit(a, b), b

    @property
    def _start(self) -> float:
        """ln A by the covariances."""
        D, _ = self.by_covariance
        return math.log(max(2 * D * self.steps.step / self.steps.square, _LEAST_START))

    @cached_property
    def own(self) -> tuple[float, float, float]:
        """ln A and ln B that fit this axis best, and the misfit."""
        a, least = _least(lambda a: self._at(a)[0], self._start)
        return a, self._at(a)[1], least

    @property
    def best(self) -> float:
        """a of this axis."""
        return self.own[0] - self.shift

    def drifts_squared(self, a: float) -> Array:
        """Return the square of each track's drift over its uncertainty, at the common a."""
        drifts, errors = self.steps.drifts(a + self.shift, self._at(a + self.shift)[1])
        return np.asarray((drifts / errors) ** 2)

    def misfit(self, a: float) -> float:
        """-2 times the log-likelihood, over drift and, unless known, s."""
        return self._at(a + self.shift)[0]

    def diffusion(self, step: float) -> float:
        """Along this axis, m^2/s."""
        return math.exp(self.own[0]) * self.steps.square / (2 * step)

    def information(self, a: float) -> float:
        """Fisher's, of a."""
        own = a + self.shift
        b = self._at(own)[1]
        drifts = len(set(self.of_track))
        matrix = self.steps.information(own, b) * (1 - drifts / self.steps.count)
        if self.known is None or self.contradicted:
            return float(matrix[0, 0] - matrix[0, 1] ** 2 / matrix[1, 1])
        along = np.array([1.0, self._noisy(own)[1]])
        return float(along @ matrix @ along)

    def findings(self, step: float) -> Iterator[Finding]:
        """What speaks against a free bead with a steady drift."""
        ratios, means = self.steps.ratios(*self.own[:2])
        if self.contradicted:
            text = "exposure and noise as given contradict the record: both are fitted"
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
            text = f"its drift changes, slower than {n / (2 * duration):.2g} Hz"
            yield Finding("drift", f"{self.axis}: {text}")
        elif min(less) < IMPROBABLE / len(slow):
            n = slow[int(np.argmin(less))]
            text = f"it moves less than a free bead over {2 * duration / n:.2g} s and more"
            yield Finding("confined", f"{self.axis}: {text}: is it held?")
        elif self.p_value < REFUTED:
            text = "its steps are not those of a free bead, blurred and with noise"
            yield Finding("spectrum", f"{self.axis}: {text}")
        if 2 * float(ndtr(-abs(self.halves))) < IMPROBABLE / 10:
            yield Finding("halves", f"{self.axis}: its halves differ in how the bead diffuses")

    @cached_property
    def p_value(self) -> float:
        """By the mean squares in bands of the spectrum, of which two parameters are fitted."""
        ratios, means = (np.array_split(each, _BANDS) for each in self.steps.ratios(*self.own[:2]))
        squares = sum(
            float(band.sum() - mean.sum()) ** 2 / (2 * float(mean.sum()))
            for band, mean in zip(ratios, means, strict=True)
        )
        return float(chdtrc(_BANDS - 2, squares))

    @property
    def smoothed(self) -> bool:
        """Whether the bead moves less from sample to sample than an exposure of a step leaves."""
        a, b, least = self.own
        rise = self.steps.misfit(a, a + math.log(_WHOLE_EXPOSURE)) - least
        return b - a < math.log(_WHOLE_EXPOSURE) and bool(chdtrc(1, max(rise, 0.0)) < IMPROBABLE)

    def result(self, step: float, given: Given) -> FreeAxis:
        """This axis, in public."""
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
        """Drift, m/s, and its standard uncertainty: the weighted mean of the tracks'."""
        drifts, errors = self.steps.drifts(a, b)
        weights = 1 / errors**2
        return float(weights @ drifts / weights.sum()), 1 / math.sqrt(weights.sum())

    def _noise(self, exposure: float) -> tuple[float | None, float]:
        """Standard deviation of the localisation error, m, if it is seen, and its upper limit.

        exposure: over the step.
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
    """D and its uncertainty, m^2/s, by covariances; and by how much its halves differ.

    Vestergaard et al., (14) and (16), the drift of each track being its mean step. Several tracks
    have no halves.
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
        square, product = float(squares[part].mean()), float(products[part].mean())
        n = len(squares[part])
        D, s = (square / 2 + product) / step, -product
        ratio = s / (D * step)
        relative = (6 + 4 * ratio + 2 * ratio**2) / n + 4 * (1 + ratio) ** 2 / n**2
        return D * (1 + 3 / count), abs(D) * math.sqrt(relative)

    if len(tracks) > 1:
        return estimated(slice(None)), 0.0
    half = len(squares) // 2
    (first, error), (second, other) = estimated(slice(half)), estimated(slice(half, None))
    return estimated(slice(None)), (first - second) / math.hypot(error, other)
