"""Numbers in SI are printed in the units of results."""

import math

import pytest

from tweezer.values.prefixes import per
from tweezer.values.printed import in_unit, pair, printed, signal_unit, with_error
from tweezer.values.units import to_si


@pytest.mark.parametrize(("unit", "si"), [
    ("um", "m"), ("nm", "m"), ("ms", "s"), ("us", "s"), ("kHz", "1/s"), ("pN/um", "N/m"),
    ("pg", "kg"), ("nN s/m", "kg/s"), ("mPa s", "Pa s"), ("zJ", "J"), ("um^2/s", "m^2/s"),
    ("mV", "V"),
])  # fmt: skip
def test_factor_is_that_of_the_units_that_users_write(unit, si):
    assert per(unit) * to_si(f"1 {unit}", si) == pytest.approx(1, rel=1e-12)


def test_number_has_its_unit_and_as_many_digits_as_its_error():
    assert printed(9.41e-9, "nN s/m") == "9.41 nN s/m"
    assert printed(0.25, "") == "0.25"
    assert in_unit(1.23456e-7, "nm", 3) == "123"
    assert with_error(5.0e-5, 4.9e-7, "pN/um") == "50.00 +- 0.49 pN/um"
    assert with_error(5.0e-5, 4.9e-7, "pN/um", "±") == "50.00 ± 0.49 pN/um"
    assert with_error(2e-6, None, "um") == with_error(2e-6, math.nan, "um") == "2 um"
    assert pair(2e-6, 1e-8, "um") == ("2.000", "0.010")
    assert (signal_unit("V"), signal_unit("m")) == ("mV", "nm")
