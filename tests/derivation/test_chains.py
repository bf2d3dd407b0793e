"""Identities of the laws of chains: limits, derivatives, partition function and series."""

import sympy as sp

from derivation import chains
from derivation.chains import c_0, c_1, l, s, u, y
from derivation.equations import is_zero


def test_marko_siggia_is_the_published_sum():
    assert is_zero(chains.marko_siggia - (1 / (4 * (1 - l) ** 2) - sp.Rational(1, 4) + l))


def test_worm_like_chains_are_springs_at_small_extension():
    """f = 3 l/2: the mean square of a long chain is 2 Lp Lc, and the spring 3 kT over it."""
    for law in (chains.marko_siggia, chains.bouchiat):
        assert sp.limit(law / l, l, 0) == sp.Rational(3, 2)


def test_worm_like_chains_diverge_as_a_stiff_one():
    """4 f (1 - l)^2 -> 1, as for l = 1 - 1/(2 sqrt f)."""
    for law in (chains.marko_siggia, chains.bouchiat):
        assert abs(sp.limit(4 * law * (1 - l) ** 2, l, 1) - 1) < 1e-12
    stiff = chains.odijk.subs(s, 0)
    assert is_zero(4 * y**2 * (1 - stiff) ** 2 - 1)


def test_stiff_chain_is_shortened_by_thermal_motion():
    """With the rigidity kT Lp, the shortening over the length is 1/(2 sqrt(F Lp/kT))."""
    A, F, kT, Lp = sp.symbols("A F kT Lp", positive=True)
    found = chains.thermal_shortening().subs(A, kT * Lp)
    assert sp.simplify(found - sp.sqrt(kT / (F * Lp)) / 2) == 0
    assert is_zero(1 - chains.odijk.subs(s, 0) - 1 / (2 * y))


def test_twistable_chain_has_the_modulus_of_coupled_springs():
    """Energy S t^2/2 + C w^2/2 + g t w - F t with a free twist w: t = F C/(S C - g^2)."""
    S, C, g, F, t, w = sp.symbols("S C g F t w", positive=True)
    energy = S * t**2 / 2 + C * w**2 / 2 + g * t * w - F * t
    found = sp.solve([sp.diff(energy, t), sp.diff(energy, w)], [t, w])[t]
    assert is_zero(found - C * F / (S * C - g**2))
    scaled = chains.twistable.subs(c_1, 0) - chains.odijk.subs(s, 0)
    kT, Lp = sp.symbols("kT Lp", positive=True)
    physical = scaled.subs({y: sp.sqrt(F * Lp / kT), s: kT / (Lp * S), c_0: g / sp.sqrt(S * C)})
    assert sp.simplify(physical - found) == 0


def test_langevin_function_follows_from_the_partition_function():
    mean = sp.diff(sp.log(chains.partition), u)
    exact = chains.langevin.subs(chains.e, sp.exp(-2 * u))
    assert sp.simplify((mean - exact).rewrite(sp.exp)) == 0
    slope = chains.LANGEVIN[1].subs(chains.e, sp.exp(-2 * u))
    assert sp.simplify((sp.diff(mean, u) - slope).rewrite(sp.exp)) == 0


def test_series_of_langevin_function():
    """All terms agree, and the first that is left out is below 1e-16 at the largest argument."""
    order = 2 * chains.TERMS
    exact = sp.series(sp.coth(u) - 1 / u, u, 0, order + 2).removeO()
    left_out = sp.expand(exact) - sp.expand(chains.langevin_series())
    assert left_out == exact.coeff(u, order + 1) * u ** (order + 1)
    assert abs(left_out.subs(u, chains.SMALL)) < 1e-16


def test_derivatives():
    pairs = (
        (chains.BOUCHIAT, chains.bouchiat, l),
        (chains.TWISTABLE, chains.twistable, y),
        (chains.LANGEVIN_SERIES, chains.langevin_series(), u),
    )
    for (value, slope), law, variable in pairs:
        for found, expected in ((value, law), (slope, sp.diff(law, variable))):
            difference = sp.lambdify([variable, s, c_0, c_1], found - expected)
            assert abs(difference(0.3, 0.01, -0.2, 0.05)) < 1e-13
