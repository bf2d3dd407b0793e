"""Water derived: the refractive index solves its Lorentz-Lorenz equation; limits of the forms."""

import sympy as sp

from derivation import water
from derivation.equations import is_zero


def test_index_solves_the_lorentz_lorenz_equation():
    assert is_zero(water.lorentz_lorenz(water.refractive_index) - water.X)
    assert water.refractive_index.subs(water.X, 0) == 1


def test_density_is_largest_at_four_degrees():
    """M. Tanaka et al., Metrologia 38, 301 (2001): 999.97495(84) kg/m^3 at 3.983035 degC."""
    warmest = sp.nsolve(water.density.diff(water.T), water.T, 277.0)
    assert abs(warmest - 277.133035) < 0.01
    assert abs(water.density.subs(water.T, warmest) - 999.97495) < 8.4e-4


def test_a_kelvin_changes_the_viscosity_by_two_and_a_half_percent():
    """-2.45 % at 20 degC and -1.95 % at 37 degC: d(ln mu)/dT."""
    mu = water.VISCOSITY.rhs
    by_kelvin = mu.diff(water.T) / mu
    assert abs(by_kelvin.subs(water.T, 293.15) + 0.0245) < 5e-4
    assert abs(by_kelvin.subs(water.T, 310.15) + 0.0195) < 5e-4
