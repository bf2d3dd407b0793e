"""Comparison of two results within their errors, quantity by quantity."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import fdtr, fdtrc, ndtr, ndtri, stdtr

from tweezer.calibration.results import Calibration
from tweezer.calibration.spectra import statistical_inefficiency
from tweezer.results.io import load_result, scene_of
from tweezer.results.run import Run
from tweezer.results.saving import result_in
from tweezer.results.schema import plain
from tweezer.scene import by_key
from tweezer.sweeps.quantities import FAILED, MISSING
from tweezer.trap.body import BodyTrap
from tweezer.trap.trap import Trap
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.measured import DIMENSIONS, STANDARD, Measured, Result
from tweezer.values.prefixes import usual_unit
from tweezer.values.printed import printed
from tweezer.values.saved import COMPARED, kind_of, read_json, refusal
from tweezer.values.shown import Card, Row, Shown, Table, clipped

#: Probability that a comparison with thermal motion wrongly finds a difference
FALSE_ALARM = 0.01
#: Largest number of times at which ensembles are compared
_TIMES = 20
#: Smallest number of independent samples, or of trajectories, for a statistical comparison
_INDEPENDENT = 20
#: Independent samples for each degree of freedom of their standard error. A sum of correlations up
#: to a lag w has n/(2 w + 1) (U. Wolff, Comput. Phys. Commun. 156, 143 (2004)), and w is three
#: statistical inefficiencies.
_WINDOWS = 6
#: Numbers of a dataset read at a time
_READ = 2_000_000
#: Relative rounding error of a time or value
_ROUNDING = 1e-12
#: Attributes of a dataset that are compared in addition to the keys of the scene
_ATTRIBUTES = (
    "model", "method", "fluid_inertia", "theory", "force_evaluator", "step", "seed",
    "trajectories", "of", "tweezer_version", "numpy_version", "scipy_version", "numba_version",
)  # fmt: skip


class Numbers(NamedTuple):
    """Values of one quantity of a result, with their errors."""

    unit: str
    """SI unit of the values and errors"""
    values: Array
    """any shape; if the quantity is a vector, the last axis is its components"""
    errors: Array
    """error of each number, or of each vector (then one axis fewer than `values`): bounds without
    thermal motion, standard errors with it"""
    where: Callable[[tuple[int, ...]], str]
    """function that describes an entry of `errors` by its index, such as "along x\""""
    freedom: float | Array = math.inf
    """degrees of freedom of the standard errors: one number, or one for each error"""
    is_variance: bool = False
    """whether the values are variances, which are compared by their ratio"""
    parts: float | Array = math.nan
    """number n of samples, windows or trajectories whose scatter gives the errors"""
    part: str = ""
    """name of such a part with its spacing or length, such as "window 1 ms". If both results have
    the same, their scatters are pooled; "" if each result uses its own scatter"""

    @property
    def vectors(self) -> bool:
        """Whether the values are vectors with one error each."""
        return self.values.ndim > self.errors.ndim


class Found(NamedTuple):
    """Contents of a result at the times of a comparison."""

    numbers: dict[str, Numbers]
    """numbers of each quantity, by its name"""
    words: dict[str, str] | None = None
    """words by name, such as the outcome of a run, which must be equal in both results"""
    left_out: str = ""
    """note on data that the numbers omit, such as samples without a position; "" for none"""
    obstacle: str = ""
    """reason why the numbers can be tested only for being identical, such as too few samples; ""
    if there is no obstacle"""


class _Apart(NamedTuple):
    """Differences of one quantity between two results, one for each error."""

    difference: Array
    """absolute difference, or distance of two vectors; infinite if errors are bounds and only one
    result has the number"""
    allowed: Array
    """sum of both error bounds, or the standard error of the difference"""
    ratio: Array
    """`difference` over `allowed`; 0 if either is unknown"""
    chance: Array | None
    """probability of a difference at least as large by chance; None if errors are bounds"""
    had: NDArray[np.bool_]
    """whether at least one of the results has the number"""
    known: NDArray[np.bool_]
    """whether the number can be compared"""


class Source(NamedTuple):
    """A result to be compared; its numbers are read or computed on demand."""

    name: str
    """name of its file; "first" or "second" without a file"""
    kind: str
    """kind of result, such as "thermal run"; only results of the same kind are compared"""
    statistical: bool
    """whether errors are standard errors, not bounds"""
    about: dict[str, Any]
    """values of the scene's keys, and attributes such as method and versions"""
    times: Array | None
    """(n,) times at which the result can be compared, s; None for a result without times"""
    found: Callable[[NDArray[np.int64]], Found]
    """function that returns the contents at the times with the given indices into `times`"""
    model_error: float = 0.0
    """model error of the positions of a run, m; added if the two runs have different models"""
    over: str = ""
    """description of the keys of a sweep and their values; "" for other results"""
    dataset: xr.Dataset | None = None
    """the whole dataset; None for a trap or a calibration"""


@dataclass(frozen=True)
class Compared:
    """Outcome of the comparison of one quantity, with its most significant difference."""

    name: str
    unit: str
    """SI unit of the difference"""
    count: int
    """number of values, or vectors, that were compared"""
    difference: float
    """largest difference relative to its error"""
    allowed: float
    """sum of the two errors of these values, or the standard error of their difference"""
    where: str
    """description of their position in the result, such as "along x"; "" for a single value"""
    p_value: float | None
    """p-value of the largest of `count` differences; None if errors are bounds"""
    agrees: bool
    """whether the difference is within the errors, or p_value is not below 1 %"""

    @property
    def told(self) -> str:
        """Difference, its error and its probability in words."""
        if math.isinf(self.difference):
            return "a finite number in one alone"
        factor, unit = usual_unit(max(abs(self.difference), self.allowed), self.unit)
        difference, allowed = f"{self.difference / factor:.3g}", f"{self.allowed / factor:.3g}"
        if self.p_value is None:
            return f"{difference} of {allowed} {unit}".rstrip()
        p_value = f"p = {self.p_value:.2g}" if self.p_value > 0 else "p < 1e-300"
        return f"{f'{difference} +- {allowed} {unit}'.rstrip()}, {p_value}"


@dataclass(frozen=True, repr=False)
class Comparison(Shown):
    """Outcome of a comparison of two results."""

    names: tuple[str, str]
    """names of the two results"""
    kind: str
    """kind of both results, such as "run", "thermal run", "ensemble", "statistics", "sweep of
    trap", "trap", "body trap" """
    agrees: bool
    """whether all compared quantities agree"""
    same: bool
    """whether all numbers are the same, bit for bit, and so are their times"""
    quantities: tuple[Compared, ...]
    """outcome of the comparison for each quantity"""
    differing: tuple[tuple[str, str, str], ...]
    """keys of the scene, versions, methods and words that differ, with both values"""
    notes: tuple[str, ...]
    """notes on the method of comparison and on what was not compared"""

    def card(self) -> Card:
        """Return the card with the verdict, a row for each quantity, and differences in how they
        were made.
        """
        verdict = "agree within their errors" if self.agrees else "differ"
        rows = [Row("verdict", "the same numbers" if self.same else verdict)]
        rows += [
            Row(each.name, each.told, "" if each.agrees else f"differs {each.where}".rstrip())
            for each in self.quantities
        ]
        if self.differing:
            keys = ", ".join(key for key, *_ in self.differing)
            rows.append(Row("made with other", keys))
        table = Table(("made with other", *self.names), self.differing)
        of = " and ".join(self.names)
        tables = (table,) if self.differing else ()
        return Card("Comparison", of, tuple(rows), tables, self.notes)


Given = xr.Dataset | Result | str | Path


def compare(a: Given, b: Given) -> Comparison:
    """Test whether two results agree within their errors, and report the differences.

    A result is a run, an ensemble (trajectories or statistics), a sweep, a trap, a calibration or a
    wall found by calibrations. Both must be of the same kind, except that a trap can be compared
    with a calibration.

    * Runs without thermal motion: at common times, the distance between the positions must be at
      most the sum of both integration errors. For runs with different models the model errors are
      added. Positions are not interpolated, and the error of the force is not used.
    * Traps, and sweeps of traps or runs without thermal motion: their numbers must agree within the
      sums of their errors.
    * Runs with thermal motion: the mean and the variance along each axis are compared, with
      standard errors that follow from the statistical inefficiency.
    * Ensembles: the mean and the variance of the position over the trajectories are compared at up
      to 20 times, and the fraction of lost beads. For statistics, their means and variances are
      compared.
    * Calibrations: the stiffnesses without findings are compared. For a trap and a calibration,
      each estimate without a finding is compared with the stiffness of the trap along the same
      axis.

    Runs with different outcomes differ, whatever their numbers are. Sweeps also differ if different
    cases failed or were not computed.

    Parameters
    ----------
    a, b : Dataset, Trap, Calibration, Surface, str or Path
        Two results, or their files: .nc, .zarr, and .json of `tweezer.save`, `tweezer trap --out`
        or `tweezer calibrate --out`.

    Returns
    -------
    Comparison
        The verdict `agrees`, and `same`, which is True if all numbers and times are equal bit for
        bit. `notes` states how many numbers of each quantity were left out: numbers without a known
        error and, with thermal motion, numbers that only one result contains. Without thermal
        motion, a number that only one result contains counts as a difference.

    Raises
    ------
    ResultError
        If an argument is not a result, the kinds differ, or there is no common time; also if no
        difference was found but a quantity could not be compared.

    Notes
    -----
    With thermal motion, numbers differ by chance. The difference of two numbers divided by its
    standard error follows Student's distribution. The ratio of two variances follows the F
    distribution, with degrees of freedom from their kurtosis (L. H. Shoemaker, Am. Stat. 57, 105
    (2003)). The errors of variances, and of runs with equal sampling, follow from the pooled
    scatter of both results. The p-value of the largest of n differences is multiplied by n
    (Bonferroni's correction). Two results with the same statistics are therefore called different
    with a probability of at most about 1 %, whatever their sizes are. Results with the same seed
    and steps contain the same numbers.

    Examples
    --------
    >>> run = tweezer.simulate("silica-1um", "1 ms")
    >>> other = tweezer.simulate("silica-1um", "1 ms", method="dop853")
    >>> tweezer.compare(run, other).agrees
    True
    """
    first, second = _source(a, "first"), _source(b, "second")
    names = first.name, second.name
    if {first.kind, second.kind} == {"trap", "calibration"}:
        first, second = _stiffnesses(first, second), _stiffnesses(second, first)
    if first.kind != second.kind:
        raise ResultError(
            f"{names[0]} is of kind {first.kind}, and {names[1]} of kind {second.kind}; only "
            "results of the same kind can be compared"
        )
    if first.over != second.over:
        raise ResultError(f"{names[0]} and {names[1]}: are swept over other keys or values")
    at = _common_times(first, second)
    here, there = first.found(at[0]), second.found(at[1])
    if _model(first) != _model(second):
        here, there = (_off(*each) for each in ((here, first), (there, second)))
    common = [name for name in here.numbers if name in there.numbers]
    if not common:
        raise ResultError(f"{names[0]} and {names[1]}: have no quantity without findings in common")
    statistical = first.statistical
    apart = {
        name: _apart(name, here.numbers[name], there.numbers[name], statistical) for name in common
    }
    count = sum(int(each.known.sum()) for each in apart.values())
    quantities = tuple(
        _compared(name, here.numbers[name], each, count)
        for name, each in apart.items()
        if each.known.any()
    )
    outcomes = tuple(_differing(here.words or {}, there.words or {}))
    same = not outcomes and _same(first, second, here, there)
    if not same and (obstacle := here.obstacle or there.obstacle):
        raise ResultError(obstacle)
    agrees = same or (all(each.agrees for each in quantities) and not outcomes)
    if agrees:
        _check_left(names, apart, same, not statistical and here.words)
    notes = _notes(first, names, here, there, apart, len(at[0]), same)
    return Comparison(
        names, first.kind, agrees, same, quantities,
        (*outcomes, *_differing(first.about, second.about)), tuple(notes),
    )  # fmt: skip


def _check_left(
    names: tuple[str, str], apart: Mapping[str, _Apart], same: bool, words: Any
) -> None:
    """Raise `ResultError` if no value could be compared at all, or none of one quantity.

    `names` are the names of both results, and `apart` the differences by quantity. Identical
    results pass (`same`), and so do results that have `words`, such as an outcome, unless every
    word is "failed" or "not computed".
    """
    told = words and any(word not in (FAILED, MISSING) for word in words.values())
    if not told and not any(each.had.any() for each in apart.values()):
        raise ResultError(f"{' and '.join(names)}: cannot be compared: they contain no number")
    empty = [name for name, each in apart.items() if each.had.any() and not each.known.any()]
    if empty and not same:
        raise ResultError(
            f"{' and '.join(names)}: cannot be compared: both lack a number with a known "
            f"error for {', '.join(empty)}"
        )


def _model(of: Source) -> tuple[Any, ...]:
    """Return the model of motion and fluid inertia; runs with equal ones share a model error."""
    return of.about.get("model"), of.about.get("fluid_inertia")


def _off(found: Found, source: Source) -> Found:
    """Return the contents of a run with the model error of `source`, m, added to each error.

    It is needed for runs with different models; runs with the same model share their model error.
    """
    numbers = {
        name: each._replace(errors=each.errors + source.model_error)
        for name, each in found.numbers.items()
    }
    return found._replace(numbers=numbers)


def _common_times(a: Source, b: Source) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the indices, in each result, of the times that both have, except the first time.

    If errors are standard errors, at most 20 evenly spaced times are used, because values at
    neighbouring times are correlated. Raises `ResultError` without a common time.
    """
    if a.times is None or b.times is None:
        none = np.zeros(0, np.int64)
        return none, none
    near = np.clip(np.searchsorted(b.times, a.times), 1, len(b.times) - 1)
    near -= a.times - b.times[near - 1] < b.times[near] - a.times  # the one before, if nearer
    here = np.flatnonzero(np.abs(b.times[near] - a.times) <= _ROUNDING * a.times)
    if not len(here := here[here > 0]):
        raise ResultError(
            f"{a.name} and {b.name}: have no time in common after the release; sample both alike"
        )
    if a.statistical:
        last = len(here) - 1
        here = here[np.unique(np.linspace(0, last, min(_TIMES, last + 1)).round().astype(int))]
    return here, near[here]


def _notes(
    of: Source, names: tuple[str, str], a: Found, b: Found, apart: Mapping[str, _Apart],
    times: int, same: bool,
) -> Iterator[str]:  # fmt: skip
    """Yield sentences on how two results were compared and how many numbers were left out.

    `of` is the first result, `a` and `b` are the contents of both, and `apart` is the differences
    by quantity. `times` is the number of times compared, and `same` whether the results are
    identical.
    """
    if of.statistical and not same:
        yield (
            "the largest difference of each quantity, and its standard error; results of the same "
            f"statistics are found to differ in at most {100 * FALSE_ALARM:g} % of such comparisons"
        )
    elif not same:
        yield "the largest difference of each quantity, and the sum of both errors there"
    if times:
        yield f"at {times} times that both have"
    if lacking := sorted(a.numbers.keys() ^ b.numbers.keys()):
        yield f"not compared, for only one of them has it: {', '.join(lacking)}"
    for name, each in apart.items():
        if left := int((each.had & ~each.known).sum()):
            yield (
                f"{name}: {left} of {int(each.had.sum())} numbers are left out, for not both have "
                "them with a known error"
            )
    for name, found in zip(names, (a, b), strict=True):
        if found.left_out:
            yield f"{name}: {found.left_out}"


def _apart(name: str, a: Numbers, b: Numbers, statistical: bool) -> _Apart:
    """Compute the differences of one quantity between two results, and their probabilities.

    Errors are standard errors if `statistical`, otherwise bounds. With standard errors, Student's
    distribution gives the probability of a difference, and the F distribution that of a ratio of
    variances.
    """
    if a.values.shape != b.values.shape:
        raise ResultError(
            f"{name}: has the shape {a.values.shape} in one result, {b.values.shape} in the other"
        )
    with np.errstate(invalid="ignore"):
        apart = np.abs(a.values - b.values)
    apart[(a.values == b.values) | (np.isnan(a.values) & np.isnan(b.values))] = 0.0
    size = np.fmax(np.abs(a.values), np.abs(b.values))
    had = ~np.all([np.isnan(each.values) for each in (a, b)], axis=0)
    if a.vectors:
        apart, size = np.linalg.norm(apart, axis=-1), np.linalg.norm(size, axis=-1)
        had = np.asarray(had.any(axis=-1))
    alike = apart == 0.0
    if statistical:
        errors, freedom, deviate = _by_chance(a, b)
    else:
        errors = a.errors + b.errors
    one_alone = ~np.isfinite(apart)
    if statistical:
        known = had & ~one_alone & np.isfinite(errors)
    else:  # with bounds, a number that only one result has is a difference, whatever its error
        known = had & (alike | one_alone | np.isfinite(errors))
        apart = np.where(one_alone, math.inf, apart)
    # `allowed` includes rounding, so that identical physics passes where errors are zero
    finite = np.where(alike | ~np.isfinite(size), 0.0, size)
    allowed = np.where(np.isfinite(errors), errors, 0.0) + _ROUNDING * finite
    ratio = np.zeros_like(apart)
    np.divide(apart, allowed, out=ratio, where=known & ~alike)
    chance = None
    if statistical:
        # `deviate` is negative, so its distribution function is the one-sided probability.
        # Quantities other than variances use the ratio instead.
        deviate = np.where(np.isnan(deviate), -ratio, deviate)
        one = np.where(np.isinf(freedom), ndtr(deviate), stdtr(freedom, deviate))
        chance = np.where(known & ~alike, 2 * one, 1.0)
    return _Apart(apart, allowed, ratio, chance, had, known)


def _by_chance(a: Numbers, b: Numbers) -> tuple[Array, Array, Array]:
    """Return the standard errors of the differences, their degrees of freedom, and deviates.

    A deviate expresses a ratio of two variances as a standard normal number with the same one-sided
    probability as the ratio in the F distribution. It is at most 0, and NaN for other quantities. A
    variance s^2 with the standard error e has 2 s^4/e^2 degrees of freedom (L. H. Shoemaker, Am.
    Stat. 57, 105 (2003)), the number of parts less one for Gaussian numbers.

    If both results are sampled alike, their errors and variances are averaged over both, weighted
    by their numbers of parts. In the code, e holds squared standard errors.
    """
    e, variance = [a.errors**2, b.errors**2], [a.values, b.values]
    freedom = np.minimum(a.freedom, b.freedom)
    deviate = np.array(np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        if a.part and a.part == b.part:
            # one result alone could have a small error because a few parts agree by chance
            freedom, both = np.add(a.freedom, b.freedom), np.add(a.parts, b.parts)
            # variance of a single part, n e^2 in each result, averaged over all n_a + n_b parts
            scatter = (a.parts**2 * e[0] + b.parts**2 * e[1]) / both
            e = [scatter / a.parts, scatter / b.parts]
            variance = [(a.parts * a.values + b.parts * b.values) / both] * 2
        if a.is_variance:
            # degrees of freedom of each variance; the smaller tail of the F distribution counts
            of_each = [2 * v**2 / each for v, each in zip(variance, e, strict=True)]
            ratio = a.values / b.values
            deviate = ndtri(np.minimum(fdtr(*of_each, ratio), fdtrc(*of_each, ratio)))
    return np.sqrt(e[0] + e[1]), freedom, deviate


def _compared(name: str, a: Numbers, apart: _Apart, count: int) -> Compared:
    """Return the outcome for one quantity, determined by its least probable difference.

    `count` is the number of values of all quantities together, by which the probability is
    multiplied (Bonferroni).
    """
    ratio = np.where(apart.known, apart.ratio, -1.0)
    chance = np.ones_like(ratio) if apart.chance is None else apart.chance
    # the least probable; among equally probable ones, the largest ratio
    worst = np.lexsort((-ratio.ravel(), chance.ravel()))[0]
    at = tuple(int(i) for i in np.unravel_index(worst, ratio.shape))
    p_value = None if apart.chance is None else float(min(1.0, chance[at] * count))
    agrees = bool(ratio[at] <= 1) if p_value is None else p_value >= FALSE_ALARM
    return Compared(
        name, a.unit, int(apart.known.sum()), float(apart.difference[at]), float(apart.allowed[at]),
        a.where(at), p_value, agrees,
    )  # fmt: skip


def _same(first: Source, second: Source, a: Found, b: Found) -> bool:
    """Return whether all numbers and times of two results are identical, bit for bit.

    Datasets are compared as a whole, other results by their contents `a` and `b`.
    """
    if first.dataset is not None and second.dataset is not None:
        return _alike(first.dataset, second.dataset)
    return (
        a.numbers.keys() == b.numbers.keys()
        and a.words == b.words
        and all(_equal(a.numbers[name].values, b.numbers[name].values) for name in a.numbers)
    )


def _alike(a: xr.Dataset, b: xr.Dataset) -> bool:
    """Return whether two datasets have identical variables.

    Values are read about 2 million at a time, because a dataset may not fit into memory.
    """
    if a.variables.keys() != b.variables.keys() or a.sizes != b.sizes:
        return False
    for name, here in a.variables.items():
        there = b.variables[name]
        if here.dims != there.dims:
            return False
        rows = here.shape[0] if here.ndim else 1
        at_once = max(1, _READ * rows // max(here.size, 1))
        for first in range(0, rows, at_once):
            part = slice(first, first + at_once) if here.ndim else ...
            if not _equal(here[part].values, there[part].values):
                return False
    return True


def _equal(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """Return whether two arrays are equal, where NaN equals NaN."""
    numbers = all(each.dtype.kind in "fc" for each in (a, b))
    return np.array_equal(a, b, equal_nan=numbers)


def _differing(a: dict[str, Any], b: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield each key whose values differ, with both values as text ("none" if one lacks it)."""
    for key in dict.fromkeys([*a, *b]):
        here, there = (clipped(str(each.get(key, "none"))) for each in (a, b))
        if here != there:
            yield key, here, there


# --- contents of each kind of result --------------------------------------------------------------


def _source(of: Given, name: str) -> Source:
    """Load `of` if it is a file, and prepare the result for comparison.

    `name` is used in messages if there is no file. Raises `ResultError` for a file or result that
    cannot be compared.
    """
    result: Any = of
    made: dict[str, Any] = {}
    if isinstance(of, str | Path):
        path = Path(of)
        name = path.name
        if path.suffix.lower() == ".json":
            content = read_json(path)
            kind = kind_of(content)
            if kind is None or not kind.compared:
                raise ResultError(f"{path}: {refusal(kind, 'compare', COMPARED)}")
            result = result_in(content, path)
            made = {key: content[key] for key in ("tweezer_version",) if key in content}
        else:
            result = load_result(path)
    kind = kind_of(result)
    if kind is None or not kind.compared:
        raise ResultError(f"{name}: {refusal(kind, 'compare', COMPARED)}")
    if isinstance(result, xr.Dataset):
        made = _about(result.attrs)
    if kind.name in _OF:
        return _OF[kind.name](name, result, made)
    return _of_result(name, kind.name, result, made, result.words())


def _about(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the scene's keys, as they were given, and the attributes that describe a computation.

    `attributes` are the attributes of a dataset.
    """
    scene = json.loads(attributes.get("scene_as_given", attributes["scene"]))
    made = {name: plain(attributes[name]) for name in _ATTRIBUTES if name in attributes}
    return _keys(scene) | made


def _keys(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a scene by `section.key`, omitting top-level texts (its description)."""
    return by_key({key: value for key, value in scene.items() if isinstance(value, dict | list)})


def _of_run(name: str, run: xr.Dataset, about: dict[str, Any]) -> Source:
    """Prepare a run for comparison: by mean and variance with thermal motion, else by positions.

    `name` is used in messages, and `about` contains keys and attributes with their values.
    """
    followed = Run.of(run)
    times, places = followed["time"], followed["position"]
    if scene_of(run).forces.brownian:

        def by_chance(_: NDArray[np.int64]) -> Found:
            """Return mean and variance over the time of the run, of samples with a position."""
            held = places[np.isfinite(places).all(axis=1)]
            lost = len(places) - len(held)
            if not len(held):
                raise ResultError(f"{name}: contains no position")
            left_out = f"{lost} of {len(places)} samples are left out, for they hold no position"
            moments, independent = _moments_in_time(held, times[1] - times[0])
            few = (
                f"{name}: has {math.floor(independent)} independent samples; a comparison needs "
                f"{_INDEPENDENT}"
            )
            return Found(
                moments, {"status": run.attrs["status"]}, left_out if lost else "",
                few if independent < _INDEPENDENT else "",
            )  # fmt: skip

        return Source(name, "thermal run", True, about, None, by_chance, dataset=run)
    bound, of_model = (float(run.attrs[f"{of}_error"]) for of in ("integration", "model"))
    if not math.isfinite(bound):
        raise ResultError(f"{name}: the error of its integration is not known")

    def certain(at: NDArray[np.int64]) -> Found:
        """Return the positions at these indices of time, with the integration error as a
        bound.
        """
        position = Numbers(
            "m", places[at], np.full(len(at), bound), lambda i: f"at {_ms(times[at[i[0]]])}"
        )
        return Found({"distance of the positions": position}, {"status": run.attrs["status"]})

    return Source(name, "run", False, about, times, certain, of_model, dataset=run)


def _ms(time: float) -> str:
    """Return a time, s, as text in milliseconds with six digits."""
    return printed(time, "ms", 6)


def _moments_in_time(places: Array, step: float) -> tuple[dict[str, Numbers], float]:
    """Return the time averages of position and variance along each axis, and independent samples.

    The number of independent samples is the smallest ratio of samples to statistical inefficiency
    (correlation time in samples). `places` (n, 3) are positions, m, at intervals of `step`, s.
    """
    fewest, n = math.inf, len(places)
    found: dict[str, list[tuple[float, float, float]]] = {"mean": [], "variance": []}
    for x in places.T:
        for quantity, series in (("mean", x), ("variance", (x - x.mean()) ** 2)):
            independent = n / statistical_inefficiency(series)
            fewest = min(fewest, independent)
            error = math.sqrt(series.var() / independent)
            found[quantity].append((float(series.mean()), error, independent / _WINDOWS))
    return {
        f"{quantity} over time": Numbers(
            unit,
            np.array([each[0] for each in rows]),
            np.array([each[1] for each in rows]),
            _along,
            np.array([each[2] for each in rows]),
            quantity == "variance",
            n,
            f"sample every {step:.9g} s",
        )
        for (quantity, rows), unit in zip(found.items(), ("m", "m^2"), strict=True)
    }, fewest


def _along(at: tuple[int, ...]) -> str:
    """Return the axis of the last index, as "along x"."""
    return f"along {'xyz'[at[-1]]}"


def _of_ensemble(name: str, runs: xr.Dataset, about: dict[str, Any]) -> Source:
    """Prepare an ensemble for comparison: by moments over trajectories, and the lost fraction.

    `name` is used in messages, and `about` contains keys and attributes with their values.
    """
    times, lost = runs["time"].values, np.isfinite(runs["lost_time"].values)
    if np.isnan(runs["lost_time"].values).any():
        raise ResultError(f"{name}: is not complete")
    if (n := len(lost)) < _INDEPENDENT:
        raise ResultError(f"{name}: has {n} trajectories; a comparison requires {_INDEPENDENT}")

    def found(at: NDArray[np.int64]) -> Found:
        """Return the moments at these indices of time, and the lost fraction, with standard errors.

        Moments over fewer than 20 remaining beads have no error and are not compared.
        """
        places = runs["position"].isel(time=at).values
        left = np.isfinite(places).sum(axis=0)
        with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # no bead remains
            mean = np.nanmean(places, axis=0)
            off = (places - mean) ** 2
            # n/(n - 1) makes the variance of the n remaining beads unbiased
            variance = off.mean(axis=0, where=np.isfinite(off)) * left / (left - 1)
            kurtosis = np.nanmean(off**2, axis=0) / np.nanmean(off, axis=0) ** 2
            of_variance = _error_of_variance(variance, kurtosis, left)
        few, freedom = left < _INDEPENDENT, left - 1.0
        errors = (np.where(few, np.nan, each) for each in (np.sqrt(variance / left), of_variance))

        def where(i: tuple[int, ...]) -> str:
            """Return the time and axis of an error, in words."""
            return f"at {_ms(times[at[i[0]]])} {_along(i)}"

        share = lost.mean()
        # standard error of a fraction; 0.25/n keeps it above 0 if none or all are lost
        part = np.array([math.sqrt((share * (1 - share) + 0.25 / n) / n)])
        numbers = {
            "mean over trajectories": Numbers("m", mean, next(errors), where, freedom),
            "variance over trajectories": Numbers(
                "m^2", variance, next(errors), where, freedom, True, freedom, "trajectory"
            ),
            "part that is lost": Numbers("", np.array([share]), part, lambda _: "", n - 1),
        }
        return Found(numbers)

    return Source(name, "ensemble", True, about, times, found, dataset=runs)


def _error_of_variance(variance: Any, kurtosis: Any, number: Any) -> Any:
    """Return the standard error of a variance from `number` samples with this kurtosis.

    Gaussian numbers have the kurtosis 3. The formula is from L. H. Shoemaker, Am. Stat. 57, 105
    (2003).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return variance * np.sqrt((kurtosis - (number - 3) / (number - 1)) / number)


def _of_statistics(name: str, gathered: xr.Dataset, about: dict[str, Any]) -> Source:
    """Prepare the statistics of an ensemble for comparison: by all their means and variances.

    `name` is used in messages, and `about` contains keys and attributes with their values.
    """
    times = gathered["time"].values
    window = [gathered.attrs.get(key) for key in ("samples_per_window", "samples", "duration")]

    def found(at: NDArray[np.int64]) -> Found:
        """Return means and variances; those that depend on time, at these indices of time."""
        numbers = {}
        for key, each in gathered.data_vars.items():
            of, _, moment = str(key).rpartition("_")
            if moment not in ("mean", "variance") or f"{key}_error" not in gathered:
                continue
            over_time = "time" in each.dims
            timed = {"time": at} if over_time else {}
            parts = gathered["trajectories_left" if over_time else "windows"].isel(timed)
            values = each.isel(timed)
            error = gathered[f"{key}_error"].isel(timed)
            if (is_variance := moment == "variance") and over_time:
                kurtosis = gathered[f"{of}_kurtosis"].isel(timed) + 3
                error = _error_of_variance(values, kurtosis, parts)
            error = error.where(parts >= _INDEPENDENT).transpose(*values.dims)
            freedom = (parts - 1.0).broadcast_like(values).transpose(*values.dims).values

            def where(i: tuple[int, ...], timed: bool = over_time) -> str:
                """Return the time, if any, and the axis of an error, in words."""
                return f"at {_ms(times[at[i[0]]])} {_along(i)}" if timed else _along(i)

            part = f"window {window}" if not over_time else "trajectory"
            numbers[f"{of} {moment}".replace("_", " ")] = Numbers(
                values.attrs["units"], values.values, error.values, where, freedom,
                is_variance, freedom, part if is_variance else "",
            )  # fmt: skip
        return Found(numbers)

    return Source(name, "statistics", True, about, times, found, dataset=gathered)


def _of_sweep(name: str, swept: xr.Dataset, about: dict[str, Any]) -> Source:
    """Prepare a sweep for comparison: by its variables with errors, and the outcomes of its cases.

    `name` is used in messages, and `about` contains keys and attributes with their values.
    """
    of = swept.attrs["of"]
    statistical = of in ("ensemble", "calibrate")
    lasting = (about.get(f"simulation.{key}") for key in ("duration", "samples"))
    window = f"window {(*lasting, swept.attrs.get('skip'))}"

    def freedom_of(key: str, shape: tuple[int, ...]) -> Array:
        """Return the degrees of freedom of the variable `key`, in its shape.

        A sweep of ensembles has the number of remaining beads less one, or of all trajectories for
        the lost fraction. Other sweeps have infinitely many.
        """
        if of != "ensemble":
            return np.full(shape, math.inf)
        trajectories, lost = float(swept.attrs["trajectories"]), swept["lost"].values
        parts = np.full(lost.shape, trajectories) if key == "lost" else trajectories * (1 - lost)
        added = (1,) * (len(shape) - parts.ndim)
        return np.broadcast_to(parts.round().reshape(parts.shape + added) - 1, shape)

    def found(_: NDArray[np.int64]) -> Found:
        """Return the variables that have errors, and the outcome of each case."""
        numbers = {}
        for key, each in swept.data_vars.items():
            error = each.attrs.get("ancillary_variables")
            if error in swept:

                def where(i: tuple[int, ...], dims: tuple[Any, ...] = each.dims) -> str:
                    """Return the values of the swept keys for an error, in words."""
                    named = zip(dims, i, strict=True)
                    return ", ".join(f"{dim} {_value(swept, dim, k)}" for dim, k in named)

                freedom = freedom_of(str(key), each.shape)
                is_variance = key == "variance"
                numbers[str(key).replace("_", " ")] = Numbers(
                    each.attrs["units"], each.values,
                    np.where(freedom >= 1, swept[error].values, np.nan), where, freedom,
                    is_variance, freedom, window if is_variance else "",
                )  # fmt: skip
        words = {}
        for i, outcome in enumerate(str(each) for each in swept["outcome"].values.ravel()):
            by_chance = statistical and outcome not in (FAILED, MISSING)
            words[f"outcome of case {i}"] = "computed" if by_chance else outcome
        return Found(numbers, words)

    over = swept.attrs["over"]
    kind = f"sweep of {of}"
    return Source(name, kind, statistical, about, None, found, over=over, dataset=swept)


def _value(swept: xr.Dataset, dimension: Any, index: int) -> str:
    """Return the value of a swept key at an index as text; the index itself if it has no values."""
    value = swept[dimension].values[index] if dimension in swept.coords else index
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _of_result(
    name: str, kind: str, result: Result, about: dict[str, Any], words: dict[str, str]
) -> Source:
    """Prepare a trap or calibration for comparison: by the quantities it lists, with their errors.

    `about` contains keys and attributes with their values, and `words` must be equal in both
    results.
    """
    listed = [each for each in result.quantities() if each.of.compared]
    statistical = any(each.of.kind == STANDARD for each in listed)
    if statistical:  # given values have no error, and values with findings are not reliable
        given = {each.of.name: each.words for each in listed if np.isnan(each.errors).all()}
        about = about | given
        listed = [each for each in listed if each.of.name not in given and not each.findings]
    numbers = {each.of.name.replace("_", " "): _numbers_of(each) for each in listed}
    return Source(name, kind, statistical, about, None, lambda _: Found(numbers, words))


def _numbers_of(measured: Measured) -> Numbers:
    """Return the values of a measured quantity with their errors and descriptions.

    A vector with a single error stays a vector, so two of them are compared by their distance.
    """
    quantity, values, errors, _ = measured
    where = {"": _nowhere, "axis": _along, "direction": _outwards}[quantity.along]
    assert errors is not None
    if not errors.ndim:
        return Numbers(quantity.unit, values[None], errors[None], _nowhere)
    return Numbers(quantity.unit, values, errors, where)


def _of_trap(name: str, trap: Trap, about: dict[str, Any]) -> Source:
    """Prepare a trap for comparison: by its quantities, and by whether it holds the bead."""
    scene = trap.scene.model_dump(mode="json", exclude_none=True)
    how: dict[str, Any] = {"theory": trap.theory, "evaluator": trap.evaluator}
    if trap.other_forces:
        how["other_forces"] = trap.other_forces
    words = {"held": str(trap.equilibrium is not None)}
    return _of_result(name, "trap", trap, _keys(scene) | how | about, words)


def _of_body_trap(name: str, trap: BodyTrap, about: dict[str, Any]) -> Source:
    """Prepare the trap of a body for comparison, as `_of_trap` does for a sphere."""
    scene = trap.scene.model_dump(mode="json", exclude_none=True)
    words = {"held": str(trap.equilibrium is not None)}
    return _of_result(name, "body trap", trap, _keys(scene) | about, words)


def _outwards(at: tuple[int, ...]) -> str:
    """Return the escape direction of the first index, as "on the way to +z"."""
    return f"on the way to {DIMENSIONS['direction'][at[0]]}"


def _nowhere(_: tuple[int, ...]) -> str:
    """Return "", the description of a quantity that is a single number."""
    return ""


def _of_calibration(name: str, found: Calibration, _: dict[str, Any]) -> Source:
    """Prepare a calibration for comparison: by its stiffness estimates without findings."""
    numbers = {
        f"stiffness {axis.axis}, {each.method}": _numbers_of(each.measured)
        for axis in found.axes
        for each in axis.estimates
        if not each.findings
    }
    about = {
        key: getattr(found, key) for key in ("temperature", "drag", "mass", "exposure", "samples")
    }
    return Source(name, "calibration", True, about, None, lambda _: Found(numbers))


def _stiffnesses(one: Source, other: Source) -> Source:
    """Prepare `one` of a trap and a calibration for comparison with the `other`.

    A trap has one stiffness per axis, a calibration several estimates of it. The trap's stiffness
    is therefore repeated under the name of each estimate.
    """
    nowhere = np.empty(0, np.int64)
    found, estimates = one.found(nowhere), other.found(nowhere).numbers
    if one.kind == "calibration":
        temperature = one.about["temperature"]
    else:
        temperature = one.about.get("medium.temperature")
        trap, numbers = found.numbers.get("stiffness"), {}
        if trap is None:
            raise ResultError(
                f"{one.name}: has no equilibrium, and therefore no stiffness to compare"
            )
        for name in estimates:
            axis = "xyz".index(name.removeprefix("stiffness ")[0])
            one_axis = slice(axis, axis + 1)
            numbers[name] = trap._replace(
                values=trap.values[one_axis], errors=trap.errors[one_axis], where=_nowhere
            )
        found = Found(numbers)
    return one._replace(
        kind="trap and calibration",
        statistical=True,
        about={"temperature": temperature},
        found=lambda _: found._replace(words=None),
    )


#: Function that prepares a dataset, by its kind; other results are compared by their quantities
_OF: dict[str, Callable[[str, Any, dict[str, Any]], Source]] = {
    "sweep": _of_sweep,
    "statistics": _of_statistics,
    "ensemble": _of_ensemble,
    "run": _of_run,
    "trap": _of_trap,
    "body trap": _of_body_trap,
    "calibration": _of_calibration,
}
