"""A result that lists its numbers, with a dummy result, and the table of units."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from tweezer.sweeps.quantities import values_of
from tweezer.values.constants import Boltzmann
from tweezer.values.measured import Measured, Quantity, Result
from tweezer.values.prefixes import factor, in_tables
from tweezer.values.shown import Card

STIFFNESS = Quantity("stiffness", "N/m", "stiffness at the equilibrium", "axis")
DEPTH = Quantity("depth", "J", "work of pulling the bead out")
COUNT = Quantity("count", "1", "number of escapes", kind="", swept=False)


@dataclass(frozen=True, repr=False)
class Dummy(Result):
    """A result that no command makes."""

    QUANTITIES: ClassVar = (STIFFNESS, DEPTH, COUNT)

    def quantities(self) -> Iterator[Measured]:
        yield STIFFNESS([1e-6, 2e-6, 4e-6], 1e-8)
        yield DEPTH(4e-20, 4e-22, "ray optics is off")
        yield COUNT(3)

    def card(self) -> Card:
        return Card("Dummy", "a scene", tuple(each.row() for each in self.quantities()))


def test_a_result_is_shown_by_its_list():
    stiffness, depth, count = Dummy().card().rows
    assert stiffness.value == "1.000 +- 0.010, 2.000 +- 0.010, 4.000 +- 0.010 pN/um"
    assert stiffness.of == "stiffness"
    assert depth.caveat == "ray optics is off"
    assert count.value == "3"
    assert "stiffness at the equilibrium" in repr(Dummy())
    assert "pN/µm" in Dummy()._repr_html_()


def test_a_sweep_reads_the_list_with_energies_in_kT():
    values = values_of(Dummy(), 300.0)
    assert set(values) == {"stiffness", "stiffness_error", "depth", "depth_error"}
    assert values["stiffness_error"] == [1e-8] * 3
    assert values["depth"] == 4e-20 / (Boltzmann * 300.0)


def test_a_number_that_is_not_known_is_nan():
    measured = DEPTH(None)
    assert math.isnan(measured.value)
    assert np.isnan(measured.errors).all()


def test_a_table_has_the_same_digits_as_a_card():
    """A number and its error are apart, without the unit, which the heading has."""
    error = STIFFNESS(4e-5, 3e-7)
    assert error.words == "40.00 +- 0.30 pN/um"
    assert error.cells == ("40.00", "0.30")
    assert STIFFNESS(4e-5).words == "40 pN/um"


def test_units_of_tables_have_the_factors_of_their_names():
    assert in_tables("m^2/s") == (1e12, "um^2/s")
    assert in_tables("1") == (1.0, "")
    assert in_tables("kg/m^3") == (1.0, "kg/m^3")
    with pytest.raises(ValueError, match="furlong"):
        factor("furlong")
