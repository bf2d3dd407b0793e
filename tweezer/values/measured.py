"""Numbers of a result, each defined once for cards, commands, pages, sweeps and comparisons.

A kind of result is a subclass of `Result`. `QUANTITIES` lists all numbers that it can have, so that
a table of cases has all of them even if a case failed. `quantities` yields those that it has::

    STIFFNESS = Quantity("stiffness", "N/m", "stiffness at the equilibrium", along="axis")

    @dataclass(frozen=True, repr=False)
    class Found(Result):
        QUANTITIES: ClassVar = (STIFFNESS,)

        def quantities(self) -> Iterator[Measured]:
            yield STIFFNESS(self.stiffness, self.stiffness_error)

        def card(self) -> Card:
            return Card("Found", self.name, tuple(each.row() for each in self.quantities()))

A card whose rows contain more than a number formats them with `printed`, which finds the factor.
It marks each row with its quantity, `Row("stiffness (x, y, z)", printed(k, "pN/um"),
of="stiffness")`, so that a page that lists the quantity can omit the row. Values are in SI units.
Factors to the units of a card are only in `tweezer.values.prefixes`.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tweezer.values.constants import Boltzmann
from tweezer.values.prefixes import in_tables, per
from tweezer.values.rounding import rounded, with_uncertainty
from tweezer.values.shown import Row, Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Names of the entries along the dimensions of quantities
DIMENSIONS = {"axis": ["x", "y", "z"], "direction": ["+x", "-x", "+y", "-y", "+z", "-z"]}
#: Kinds of errors: a bound of the deviation, or a standard error
BOUND, STANDARD = "bound", "standard"


class Quantity(NamedTuple):
    """Name, unit and meaning of a number, or of numbers along a dimension, in a result."""

    name: str
    unit: str
    """SI unit; "1" for a number without a unit"""
    about: str
    """meaning in words, with the conditions on which it depends"""
    along: str = ""
    """dimension of its entries: "axis" or "direction"; "" for one number"""
    kind: str = BOUND
    """kind of error; "" for a quantity without errors"""
    swept: bool = True
    """whether it is a variable of sweeps"""
    compared: bool = False
    """whether `tweezer compare` compares it"""
    shown: str = ""
    """unit of its text; "" for the unit of tables (`in_tables`)"""

    @property
    def entries(self) -> list[str]:
        """Names of its entries; one empty name for a single number."""
        return DIMENSIONS[self.along] if self.along else [""]

    @property
    def scale(self) -> tuple[float, str]:
        """Factor from its SI unit to the unit of its text, and the name of that unit."""
        return (per(self.shown), self.shown) if self.shown else in_tables(self.unit)

    @property
    def in_kT(self) -> Quantity:
        """Quantity with the unit k_B T instead of J; unchanged if it is not an energy."""
        return self._replace(unit="kT") if self.unit == "J" else self

    def __call__(
        self, value: ArrayLike | None, error: ArrayLike | None = None, *findings: str
    ) -> Measured:
        """Return this quantity with its value (NaN for None), its error and its findings."""
        number = np.asarray(np.nan if value is None else value, np.float64)
        known = np.asarray(np.nan if error is None else error, np.float64)
        return Measured(self, number, known if self.kind else None, findings)


class Measured(NamedTuple):
    """A quantity of a result with its value and error: one number, or several along a dimension."""

    of: Quantity
    value: NDArray[np.float64]
    """value, or values along the dimension of the quantity, in its SI unit"""
    error: NDArray[np.float64] | None
    """error of each value, or one error for the length of a vector; NaN if it is not known; None
    for a quantity without errors"""
    findings: tuple[str, ...] = ()
    """findings about the number"""

    @property
    def errors(self) -> NDArray[np.float64]:
        """Error of each value; NaN if it is not known."""
        known = np.nan if self.error is None else self.error
        return np.broadcast_to(known, self.value.shape)

    def in_kT(self, temperature: float) -> Measured:
        """Return this number in k_B T at a temperature (K); unchanged if it is not an energy."""
        if self.of.unit != "J" or self.error is None:
            return self
        thermal = Boltzmann * temperature
        return self._replace(
            of=self.of.in_kT, value=self.value / thermal, error=self.error / thermal
        )

    @property
    def words(self) -> str:
        """Values as text with as many digits as their errors justify, and their unit."""
        factor, unit = self.of.scale
        numbers = (
            with_uncertainty(factor * float(value), factor * float(error))
            for value, error in zip(self.value.flat, self.errors.flat, strict=True)
        )
        return f"{', '.join(numbers)} {unit}".rstrip()

    @property
    def cells(self) -> tuple[str, str]:
        """A single value and its error as text, for a table whose heading contains the unit."""
        factor, _ = self.of.scale
        return rounded(factor * float(self.value), factor * float(self.errors))

    def row(self, name: str = "", *, detail: bool = False) -> Row:
        """Return the row of a card with values and findings; `name` replaces the quantity's
        meaning.
        """
        findings = "; ".join(self.findings)
        return Row(name or self.of.about, self.words, findings, detail, self.of.name)


class Result(Shown):
    """Base of results that list their numbers, as described at the top of this module."""

    QUANTITIES: ClassVar[tuple[Quantity, ...]] = ()
    """every quantity that a result of this kind can have"""

    def quantities(self) -> Iterator[Measured]:
        """Yield the numbers that this result has, in the order of `QUANTITIES`."""
        raise NotImplementedError

    @property
    def numbers(self) -> dict[str, Measured]:
        """Numbers of `quantities` by the names of their quantities."""
        return {each.of.name: each for each in self.quantities()}

    def words(self) -> dict[str, str]:
        """Return the texts of the result: its outcome, the reason and the findings."""
        return {}


def figure(name: str, *drawn: object) -> Figure:
    """Return the figure that a function of `tweezer.plots` draws.

    The function is found by name, because `tweezer.plots` imports the results that it draws.
    """
    drawing: Figure = getattr(importlib.import_module("tweezer.plots"), name)(*drawn)
    return drawing
