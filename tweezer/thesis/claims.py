"""Claims of the thesis, and the motions from which each is judged."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeVar

import numpy as np
import xarray as xr

from tweezer.dynamics import bound_once
from tweezer.forces.equilibria import Equilibrium
from tweezer.runs import Summary
from tweezer.scene import Scene, load_scene
from tweezer.thesis.runs import BEADS, Motions, closest_approach, in_the_light, unscaled_scene
from tweezer.values.errors import TweezerError
from tweezer.values.prefixes import per
from tweezer.values.signs import typeset

_Value = TypeVar("_Value")
#: Models of a motion: names of fields of `Motions`
MODELS = ("thesis", "unscaled")


@dataclass(frozen=True)
class Claim:
    """A claim of the thesis with its verdict."""

    where: str
    """section, figure or equation of the thesis"""
    text: str
    """the claim, paraphrased"""
    reading: str
    """criterion for the verdict"""
    computed: str
    """result in words"""
    thesis: bool | None
    """whether it holds for the thesis's own model; None if this does not apply"""
    unscaled: bool | None
    """whether it holds for the unscaled equations; None if this does not apply"""
    numbers: dict[str, float] = field(default_factory=dict)
    """the numbers in `computed`, in SI units or in the unit in their name"""
    by_waves: Claim | str | None = None
    """the same claim judged with wave optics, or the reason why that is not possible; None if not
    computed"""

    @property
    def verdict(self) -> str:
        """Verdict in words, such as "holds for the scaled model only"."""
        if self.thesis is None or self.unscaled is None:
            known = self.unscaled if self.thesis is None else self.thesis
            return "holds" if known else "does not hold"
        if self.thesis and self.unscaled:
            return "holds"
        if self.thesis:
            return "holds for the scaled model only"
        return "holds for the unscaled model only" if self.unscaled else "does not hold"

    @property
    def verdict_by_waves(self) -> str:
        """Verdict with wave optics in words, or the reason for none; "" if not computed."""
        return self.by_waves.verdict if isinstance(self.by_waves, Claim) else self.by_waves or ""


class Evidence:
    """Motions of the three beads with one theory of light, and quantities for several claims.

    In its methods `which` is a field of `Motions`, such as "unscaled", and `bead` is one of
    `BEADS`.
    """

    def __init__(self, by_bead: Mapping[str, Motions]) -> None:
        """Store the motions by bead (`BEADS`), all with the same theory of light."""
        self.motions = by_bead
        (self.theory,) = {motions.theory for motions in by_bead.values()}
        self._equilibria: dict[str, Equilibrium] = {}

    def run(self, which: str, bead: str) -> xr.Dataset:
        """Return the run `which`, a field of `Motions`, of a bead."""
        run: xr.Dataset = getattr(self.motions[bead], which)
        return run

    def scene(self, bead: str) -> Scene:
        """Return the scene of a bead with the thesis's a2, with the light of the motions."""
        return in_the_light(load_scene(f"thesis-{bead}"), self.theory)

    def unscaled_scene(self, bead: str) -> Scene:
        """Return the scene of the unscaled bead, with the light of the motions."""
        return unscaled_scene(bead, self.theory)

    def radius(self, bead: str) -> float:
        """Return the radius of a bead, m."""
        return self.motions[bead].scene.bead.radius

    def each(self, which: str, quantity: Callable[[xr.Dataset], float]) -> dict[str, float]:
        """Return a quantity of the run `which`, a field of `Motions`, by bead."""
        return {bead: quantity(self.run(which, bead)) for bead in BEADS}

    def of_runs(self, quantity: Callable[[xr.Dataset], float]) -> dict[str, dict[str, float]]:
        """Return a quantity of a run by model ("thesis" or "unscaled"), then by bead."""
        return by_model(lambda which: self.each(which, quantity))

    def of_run(self, bead: str, quantity: Callable[[xr.Dataset], float]) -> dict[str, float]:
        """Return a quantity of the run of one bead by model ("thesis" or "unscaled")."""
        return by_model(lambda which: quantity(self.run(which, bead)))

    def of_summary(self, bead: str, quantity: Callable[[Summary], _Value]) -> dict[str, _Value]:
        """Return a quantity of the summary of one bead's run by model ("thesis" or "unscaled")."""
        return by_model(lambda which: quantity(self.motions[bead].summary(which)))

    def overshoot(self, which: str) -> dict[str, float]:
        """Return the overshoot of q2 across the axis for each bead in the run `which`, m."""
        return {bead: self.motions[bead].summary(which).overshoot for bead in BEADS}

    def captured(self, which: str, bead: str) -> bool:
        """Return whether the run `which` of a bead ends in the trap."""
        return self.motions[bead].summary(which).outcome == "captured"

    def equilibrium(self, bead: str) -> Equilibrium:
        """Return the stable equilibrium of light and weight for the unscaled bead, cached.

        Raises `TweezerError` if there is none.
        """
        if bead not in self._equilibria:
            found = bound_once(self.unscaled_scene(bead)).equilibrium
            if found is None:
                raise TweezerError(f"thesis-{bead}: no stable equilibrium")
            self._equilibria[bead] = found
        return self._equilibria[bead]


class Judgement(NamedTuple):
    """Result of judging a claim from the motions."""

    computed: str
    """result in words"""
    holds: Mapping[str, bool]
    """whether the claim holds, by model; a model to which it does not apply is missing"""
    numbers: dict[str, float]
    """finite numbers in `computed`"""


def judged(
    computed: str | Callable[[str], str],
    holds: Mapping[str, bool] | Callable[[str], bool],
    /,
    **by_name: Mapping[str, float] | float,
) -> Judgement:
    """Return the judgement of a claim.

    Parameters
    ----------
    computed : str or callable
        Result in words, or the words of each model.
    holds : mapping or callable
        Whether the claim holds, by model.
    **by_name
        Numbers by quantity; several by bead or model.
    """
    if callable(computed):
        computed = "; unscaled ".join(map(computed, MODELS))
    numbers: dict[str, float] = {}
    for name, values in by_name.items():
        if isinstance(values, Mapping):
            numbers |= {f"{name} {key}": float(value) for key, value in values.items()}
        else:
            numbers[name] = float(values)
    finite = {name: value for name, value in numbers.items() if math.isfinite(value)}
    return Judgement(computed, by_model(holds) if callable(holds) else holds, finite)


class Criterion(NamedTuple):
    """A claim of the thesis, its criterion, and the function that judges it from motions."""

    judge: Callable[[Evidence], Judgement]
    where: str
    """section, figure or equation of the thesis"""
    text: str
    """the claim, paraphrased"""
    reading: str
    """condition under which the claim holds"""
    without_waves: str = ""
    """reason why it cannot be judged with wave optics; "" if it can"""

    def __call__(self, evidence: Evidence) -> Claim:
        """Return the claim with its verdict."""
        computed, holds, numbers = self.judge(evidence)
        thesis, unscaled = (bool(holds[which]) if which in holds else None for which in MODELS)
        return Claim(self.where, self.text, self.reading, computed, thesis, unscaled, numbers)


def by_model(quantity: Callable[[str], _Value]) -> dict[str, _Value]:
    """Return a quantity for each model: "thesis" (the scaled model) and "unscaled"."""
    return {which: quantity(which) for which in MODELS}


def in_words(values: Mapping[str, float], unit: str = "", digits: int = 2) -> str:
    """Return values by bead as text, such as '500 nm: 1.2, 990 nm: 3.4 µm'.

    `values` are in SI units and are written in `unit` with this number of significant digits.
    Values that are not finite become "none".
    """
    shown = {
        bead.replace("nm", " nm"): (
            f"{value * (per(unit) if unit else 1.0):.{digits}g}" if math.isfinite(value) else "none"
        )
        for bead, value in values.items()
    }
    listed = ", ".join(f"{bead}: {value}" for bead, value in shown.items())
    return f"{listed} {typeset(unit)}".rstrip()


def number(value: float, unit: str, form: str) -> str:
    """Return an SI value as text in a unit, such as '0.060 µm', with the number format `form`."""
    return f"{value * per(unit):{form}} {typeset(unit)}"


def falling(values: Mapping[str, float]) -> bool:
    """Return whether values by bead decrease with increasing size of the bead."""
    return all(small > large for small, large in itertools.pairwise(values[bead] for bead in BEADS))


def rising(values: Mapping[str, float]) -> bool:
    """Return whether values by bead increase with increasing size of the bead."""
    return all(small < large for small, large in itertools.pairwise(values[bead] for bead in BEADS))


def on_the_way(run: xr.Dataset, name: str) -> np.ndarray:
    """Return the variable `name` of a run until the first closest approach, (samples, ...).

    The release is omitted, because the bead is at rest there. Without an approach the whole run is
    returned.
    """
    approach = closest_approach(run)
    return run[name].values[1 : None if approach is None else approach + 1]


def at_approach(run: xr.Dataset, name: str) -> float:
    """Return the variable `name` of a run at the first closest approach; NaN without one."""
    approach = closest_approach(run)
    return math.nan if approach is None else float(run[name].values[approach])


def net_force(run: xr.Dataset) -> np.ndarray:
    """Return the magnitudes of the net motion force at the samples of a run, (samples,), N."""
    size: np.ndarray = np.linalg.norm(run["net_force"].values, axis=1)
    return size
