"""Identities of the heating by the laser: sources and images, dissipation, hot beads in a gas."""

import sympy as sp

from derivation import heat
from derivation.equations import is_zero
from derivation.heat import P, T, T_s, a, absorption, kappa, u

theta, x, v = sp.symbols("theta x v", positive=True)


def test_water_beside_a_plane_is_the_sum_of_sources_and_images():
    """(a P/2 pi kappa) ln(2 pi h/lambda), up to the sources within lambda/2 pi and their images."""
    unit = absorption * P / (4 * sp.pi * kappa)
    rest = sp.exp(sp.expand_log((heat.beside_plane() - heat.water_rise) / unit, force=True))
    expected = (2 * heat.depth + heat.waist) / (2 * heat.depth - heat.waist)
    assert sp.simplify(rest - expected) == 0


def test_water_within_a_sphere_is_the_formula_of_peterman():
    """(a P/2 pi kappa) (ln(2 pi R/lambda) - 1), up to the shells within lambda/2 pi."""
    R = sp.Symbol("R", positive=True)
    published = absorption * P / (2 * sp.pi * kappa) * (sp.log(R / heat.waist) - 1)
    rest = absorption * P / (2 * sp.pi * kappa) * heat.waist / R
    found = heat.within_sphere(R) - published - rest
    assert sp.simplify(sp.expand_log(found, force=True)) == 0


def test_heat_of_a_bead_flows_outwards():
    temperature = heat.bead_rise * heat.r / x
    assert is_zero(-kappa * 4 * sp.pi * x**2 * sp.diff(temperature, x) - P)
    assert is_zero(sp.diff(x**2 * sp.diff(temperature, x), x))


def test_dissipation_is_that_of_the_strain():
    """2 mu e:e over all directions, with e of the flow in spherical coordinates, r = 1."""
    g = sp.Function("g")
    along = g(x) * sp.cos(theta)
    around = -(g(x) + x * sp.diff(g(x), x) / 2) * sp.sin(theta)
    divergence = sp.diff(x**2 * along, x) / x**2 + sp.diff(around * sp.sin(theta), theta) / (
        x * sp.sin(theta)
    )
    assert sp.simplify(divergence) == 0
    strain = (
        sp.diff(along, x),
        sp.diff(around, theta) / x + along / x,
        along / x + around * sp.cos(theta) / (sp.sin(theta) * x),
    )
    shear = (x * sp.diff(around / x, x) + sp.diff(along, theta) / x) / 2
    density = 2 * (sum(each**2 for each in strain) + 2 * shear**2)
    shell = sp.integrate(
        sp.expand(sp.simplify(density) * 2 * sp.pi * x**2 * sp.sin(theta)), (theta, 0, sp.pi)
    )
    n, m, weight = sp.symbols("n m weight", positive=True)
    flow = u**n + weight * u**m  # a quadratic form that agrees for all pairs agrees for all sums
    in_x = shell.subs(g(x), flow.subs(u, 1 / x)).doit() * x**2  # dx = x^2 du
    values = {
        heat.slope: sp.diff(flow, u), heat.other_slope: sp.diff(flow, u),
        heat.curvature: sp.diff(flow, u, 2), heat.other_curvature: sp.diff(flow, u, 2),
    }  # fmt: skip
    in_u = 6 * sp.pi * heat.dissipation.subs(values).subs(u, 1 / x)
    assert sp.simplify(in_x - in_u) == 0


def test_mean_of_nearness_over_the_dissipation_of_stokes_is_five_twelfths():
    assert heat.dissipated(heat.STOKES, sp.Integer(1)) == 1
    assert heat.dissipated(heat.STOKES, u) == sp.Rational(5, 12)


def moment(power, temperature=1):
    """Mean power of the normal velocity of molecules that cross a plane, for m = k = 1."""
    flux = v * sp.exp(-(v**2) / (2 * temperature))
    return sp.integrate(v**power * flux, (v, 0, sp.oo)) / sp.integrate(flux, (v, 0, sp.oo))


def test_hot_bead_among_free_molecules_follows_from_kinetic_theory():
    """Force and noise of molecules that arrive with T = 1 and leave diffusely or as from a mirror.

    The components along an axis of the sphere are 1/3 of the normal and 2/3 of a tangential one.
    """
    density = sp.exp(-(v**2) / 2) / sp.sqrt(2 * sp.pi)
    arriving = sp.integrate(v * density, (v, 0, sp.oo))
    # a plane that moves against the gas with the speed w sees density(v - w), with d/dw = v density
    more = sp.integrate(v * v * density, (v, 0, sp.oo))
    pressure = sp.integrate(v**2 * v * density, (v, 0, sp.oo))
    drag_in = pressure / 3 + sp.Rational(2, 3) * arriving
    drag_out = more * moment(1, T_s) / 3
    mirrored = 2 * pressure / 3
    drag = (1 - a) * mirrored + a * (drag_in + drag_out)
    normal = moment(2) + moment(2, T_s) + 2 * moment(1) * moment(1, T_s)
    tangential = 1 + T_s
    noise = arriving * (
        (1 - a) * 4 * moment(2) / 3 + a * (normal / 3 + sp.Rational(2, 3) * tangential)
    )
    hot = heat.hot_drag.subs(T, 1)
    assert sp.simplify(drag / drag.subs(T_s, 1) - hot) == 0
    assert sp.simplify(noise / (2 * drag) - heat.hot_temperature.subs(T, 1)) == 0


def test_bead_as_warm_as_the_gas_has_its_temperature():
    assert sp.simplify(heat.hot_temperature.subs(T_s, T) - T) == 0
    assert sp.simplify(heat.hot_drag.subs(T_s, T)) == 1
