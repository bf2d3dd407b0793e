"""Chains against published formulas with 30 digits, the exact worm-like chain, and identities."""

import math

import mpmath as mp
import numpy as np
import pytest

import tweezer
from tests.reference import worm_like_chain as reference
from tweezer.forces.chains import LOWEST, STRONGEST, chain, tension
from tweezer.scene.choices import CHAINS
from tweezer.values.constants import Boltzmann

LC, LP, T = 1e-6, 50e-9, 298.0
DNA = {"contour_length": LC, "persistence_length": LP, "temperature": T}
STRETCH = {"stretch_modulus": 1.5e-9}
TWIST = STRETCH | {
    "twist_rigidity": 440e-30, "twist_coupling": -637e-21, "twist_coupling_slope": 17e-9,
    "critical_force": 30.6e-12,
}  # fmt: skip
#: models with parameters, and the formula of each
LAWS = {
    "marko-siggia": ("marko-siggia", {}, lambda x: reference.worm_like(x, *_of(DNA))),
    "extensible-marko-siggia": (
        "marko-siggia", STRETCH, lambda x: reference.worm_like(x, *_of(DNA | STRETCH))
    ),
    "bouchiat": ("bouchiat", {}, lambda x: reference.worm_like(x, *_of(DNA), bouchiat=True)),
    "extensible-bouchiat": (
        "bouchiat", STRETCH, lambda x: reference.worm_like(x, *_of(DNA | STRETCH), bouchiat=True)
    ),
    "odijk": ("odijk", STRETCH, lambda x: reference.odijk(x, *_of(DNA | STRETCH))),
    "fjc": ("fjc", {}, lambda x: reference.jointed(x, *_of(DNA))),
    "efjc": ("efjc", STRETCH, lambda x: reference.jointed(x, *_of(DNA | STRETCH))),
    "twlc": ("twlc", TWIST, lambda x: reference.twistable(x, *_of(DNA | TWIST))),
}  # fmt: skip
ALL = pytest.mark.parametrize("law", LAWS)


def _of(parameters):
    return [mp.mpf(value) for value in parameters.values()]


def made(law):
    model, parameters, _ = LAWS[law]
    return chain(model, **DNA, **parameters)


def extensions(law, n):
    """Extensions over the range of a law, up to 0.5 nN."""
    polymer = made(law)
    first = max(polymer.extensions[0], 1e-12)
    last = polymer.extension(np.array([min(0.5e-9, polymer.forces[1] * 0.999)]))[0][0]
    return np.linspace(first, last, n)


def test_every_model_is_tested():
    assert {model for model, _, _ in LAWS.values()} == set(CHAINS)


@ALL
def test_force_agrees_with_published_formula(law):
    model, parameters, formula = LAWS[law]
    x = extensions(law, 12)
    found = tweezer.chain_force(model, x, **DNA, **parameters)
    with mp.workdps(30):
        for extension, force in zip(x, found, strict=True):
            assert abs(force / formula(mp.mpf(float(extension))) - 1) < 1e-9, extension


@ALL
def test_extension_inverts_force(law):
    polymer, x = made(law), extensions(law, 50)
    force, slope = polymer.force(x)
    found, compliance = polymer.extension(force)
    np.testing.assert_allclose(found, x, rtol=1e-11)
    np.testing.assert_allclose(slope * compliance, 1, rtol=1e-9)


@ALL
def test_slope_is_derivative_of_force(law):
    """Central differences agree with it, away from the kink at the critical force."""
    polymer, x = made(law), extensions(law, 40)[1:-1]
    step = 1e-5 * (LC - x) if polymer.extensions[1] <= LC else np.full_like(x, 1e-13)
    if law == "twlc":
        x, step = x[keep := abs(polymer.force(x)[0] - 30.6e-12) > 1e-12], step[keep]
    differences = (polymer.force(x + step)[0] - polymer.force(x - step)[0]) / (2 * step)
    np.testing.assert_allclose(polymer.force(x)[1], differences, rtol=2e-5)


def test_small_and_large_extensions():
    """3 kT x/(2 Lp Lc) at small extensions of all chains, and 1/(4 (1 - l)^2) near Lc."""
    kT = Boltzmann * T
    for law in ("marko-siggia", "bouchiat", "fjc"):
        x = np.array([1e-15, 1e-12])
        np.testing.assert_allclose(made(law).force(x)[0], 1.5 * kT * x / (LP * LC), rtol=1e-5)
    near = LC * (1 - np.array([1e-4, 1e-5]))
    for law in ("marko-siggia", "bouchiat"):
        expected = kT / LP / (4 * (1 - near / LC) ** 2)
        np.testing.assert_allclose(made(law).force(near)[0], expected, rtol=1e-6)
    np.testing.assert_allclose(made("fjc").force(near)[0], kT / (2 * LP) / (1 - near / LC), 1e-9)


@pytest.mark.parametrize("model", ["marko-siggia", "bouchiat"])
def test_stiff_bond_does_not_stretch(model):
    x = np.linspace(1e-9, 0.95e-6, 20)
    stiff = tweezer.chain_force(model, x, **DNA, stretch_modulus=1.0)
    np.testing.assert_allclose(stiff, tweezer.chain_force(model, x, **DNA), rtol=1e-6)


def test_twistable_chain_without_change_of_coupling_is_odijk():
    """Below the critical force, the modulus S - g^2/C is constant."""
    x = np.linspace(0.8e-6, 0.95e-6, 10)
    g = -637e-21 + 17e-9 * 30.6e-12
    softer = tweezer.chain_force("odijk", x, **DNA, stretch_modulus=1.5e-9 - g**2 / 440e-30)
    np.testing.assert_allclose(tweezer.chain_force("twlc", x, **DNA, **TWIST), softer, rtol=1e-12)


# --- the exact chain ------------------------------------------------------------------------------
def deviation(model, force, **parameters):
    """Relative error of the force of a law at the extension of the exact chain."""
    x = LC * reference.exact_extension(force)
    return tweezer.chain_force(model, x, **DNA, **parameters) / (force * Boltzmann * T / LP) - 1


def test_worm_like_chains_against_exact_chain():
    """Marko and Siggia up to 17 % too stiff; Bouchiat within 0.04 %, or 0.4 % below l = 0.3."""
    found = [deviation("marko-siggia", f) for f in (0.1, 0.5, 1, 1.3, 2, 5, 20, 100)]
    assert 0.15 < max(found) < 0.17
    assert min(found) > 0
    assert max(abs(deviation("bouchiat", f)) for f in (0.51, 1, 3, 6, 8, 20, 100, 1000)) < 4e-4
    assert max(abs(deviation("bouchiat", f)) for f in (0.01, 0.03, 0.1, 0.2, 0.3)) < 4e-3


def test_odijk_is_refused_where_it_is_wrong():
    almost = {"stretch_modulus": 1.0}
    assert -0.01 < deviation("odijk", 1.02 * LOWEST, **almost) < -0.009
    assert abs(deviation("odijk", 50.0, **almost)) < 1e-3


# --- the table ------------------------------------------------------------------------------------
@ALL
def test_table_agrees_with_law(law):
    polymer = made(law)
    pieces, error = polymer.table()
    x = np.linspace(pieces[0, 0], pieces[-1, 0], 5003)[1:-1]
    found = np.array([tension(each, pieces) for each in x])
    force, slope = polymer.force(x)
    assert abs(found[:, 0] / force - 1).max() <= 1e-6
    assert error <= 1e-6
    assert abs(found[:, 1] / slope - 1).max() < 1e-4
    assert (np.diff(found[:, 0]) > 0).all()
    assert len(pieces) < 260
    end = min(STRONGEST, polymer.forces[1])
    assert tension(pieces[-1, 0], pieces)[0] == pytest.approx(end, rel=1e-6)


@pytest.mark.parametrize("law", ["bouchiat", "odijk", "twlc"])
def test_table_marks_extensions_outside(law):
    pieces, _ = made(law).table()
    assert tension(0.0, pieces) == tension(-1e-6, pieces) == (0.0, 0.0)
    outside = [pieces[-1, 0] * (1 + 1e-12), 1.0, math.inf, math.nan]
    if pieces[0, 0] > 0:
        outside += [pieces[0, 0] * (1 - 1e-12), 1e-12]
    for x in outside:
        assert all(map(math.isnan, tension(x, pieces)))


def test_table_ends_at_given_force():
    pieces, _ = made("twlc").table(20e-12)  # below the critical force: one branch
    assert tension(pieces[-1, 0], pieces)[0] == pytest.approx(20e-12, rel=1e-6)


# --- the public function --------------------------------------------------------------------------
def test_units_and_shapes():
    given = {"contour_length": "1 um", "persistence_length": "50 nm", "temperature": "24.85 degC"}
    found = tweezer.chain_force("fjc", [["100 nm", "0.9 um"]], **given)
    assert found.shape == (1, 2)
    np.testing.assert_allclose(found, tweezer.chain_force("fjc", [[1e-7, 9e-7]], **DNA))
    assert tweezer.chain_force("fjc", 1e-7, **DNA).shape == ()


@ALL
def test_slack_chain_has_no_force(law):
    model, parameters, _ = LAWS[law]
    assert (tweezer.chain_force(model, [0.0, -1e-9, -1.0], **DNA, **parameters) == 0).all()


REFUSED = [
    ("wlc", 1e-7, {}, "model = 'wlc': is unknown; choose from marko-siggia, bouchiat"),
    ("marko-siggia", 1e-6, {}, "extension = 1e-06 m: reaches the contour length.* give stretch"),
    ("fjc", 1e-6, {}, "must be below 9.99999e-07 m; use 'efjc' with stretch_modulus"),
    ("odijk", 1e-6, {}, "stretch_modulus: is required by model = 'odijk'"),
    ("odijk", 7e-7, STRETCH, "forces below 4.11e-13 N; must be at least .* use 'bouchiat'"),
    ("twlc", 7e-7, TWIST, "forces below 4.11e-13 N"),
    ("twlc", 1.2e-6, TWIST, "forces above 7.13e-11 N, .* must be below 1.0"),
    ("twlc", 1e-6, STRETCH, "twist_rigidity: is required"),
    ("fjc", 1e-7, STRETCH, "stretch_modulus = 1.5e-09: is not a parameter .* marko-siggia"),
    ("bouchiat", math.nan, {}, "extension: contains values that are not finite"),
    ("bouchiat", "7 s", {}, "extension: has the wrong unit"),
    ("bouchiat", 1e30, STRETCH, "must be below"),
    ("twlc", 1e-6, TWIST | {"critical_force": 1e-13}, "critical_force = .* must exceed 4.11e-13"),
    ("twlc", 1e-6, TWIST | {"twist_coupling": 1e-18}, "more than half of the stretch modulus"),
    ("twlc", 1e-6, TWIST | {"twist_coupling": -5.7e-18, "twist_coupling_slope": 170e-9},
     "twist_coupling_slope = .* would fall with the force"),
]  # fmt: skip


@pytest.mark.parametrize(("model", "extension", "parameters", "message"), REFUSED)
def test_refusals(model, extension, parameters, message):
    with pytest.raises(tweezer.SceneError, match=message) as refused:
        tweezer.chain_force(model, extension, **DNA, **parameters)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [("contour_length", 0), ("persistence_length", -1e-9), ("temperature", 0),
     ("stretch_modulus", math.inf)],
)  # fmt: skip
def test_parameters_outside_their_ranges_are_refused(name, value):
    with pytest.raises(tweezer.SceneError, match=name):
        tweezer.chain_force("bouchiat", 1e-7, **DNA | STRETCH | {name: value})
