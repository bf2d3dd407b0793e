"""Fits of force-extension curves: recovery, coverage, errors in both coordinates, refusals."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import tweezer
from tests import chain_coverage as simulated

T = simulated.T
X = np.linspace(0.4e-6, 0.97e-6, 30)
DNA = simulated.POLYMER | {"temperature": T}
FORCE = tweezer.chain_force("bouchiat", X, **DNA)
GIVEN = {"model": "bouchiat", "temperature": T, "extension_error": 1e-9}


@pytest.mark.parametrize("case", simulated.CASES)
def test_parameters_are_recovered_without_noise(case, monkeypatch):
    model, modulus, force, _, more = simulated.CASES[case]
    monkeypatch.setitem(simulated.CASES, case, (model, modulus, force, 1e-14, more))
    (fit,) = simulated.fits(case, 1)
    assert fit.contour_length == pytest.approx(1e-6, rel=1e-6)
    assert fit.persistence_length == pytest.approx(50e-9, rel=1e-5)
    assert fit.stretch_modulus == (modulus and pytest.approx(modulus, rel=1e-5))
    assert fit.findings == ()


@pytest.fixture(scope="module")
def found():
    """Fits of 150 curves, made once."""
    return list(simulated.fits("odijk", 150))


def test_intervals_contain_the_true_values(found):
    """92 to 98 % of 150 curves, of which 95 % are expected; false alarm 17 % for a new seed."""
    within = np.mean([simulated.contained("odijk", each) for each in found], axis=0)
    assert within.shape == (3,)
    assert ((within >= 0.92) & (within <= 0.98)).all()


def test_findings_are_rare(found):
    """On 2 % of correct curves; the probability of 11 or more in 150 is 2e-4."""
    assert sum(bool(each.findings) for each in found) < 11


def test_covariance_is_the_scatter_of_fits(found):
    """The sample covariance has a standard error of 12 %; false alarm 1e-3."""
    scatter = np.cov(
        [(f.contour_length, f.persistence_length, f.stretch_modulus) for f in found], rowvar=False
    )
    mean = np.mean([each.covariance for each in found], axis=0)
    np.testing.assert_allclose(mean, scatter, rtol=0.4)


def test_residuals_have_unit_variance(found):
    """The mean of chi-squared over its degrees of freedom has a standard error of 1.5 %."""
    ratio = sum(f.chi_squared for f in found) / sum(f.degrees_of_freedom for f in found)
    assert ratio == pytest.approx(1, abs=0.05)
    p_values = np.sort([each.p_value for each in found])
    distance = np.abs(p_values - np.linspace(0, 1, len(found))).max()
    assert distance < 1.63 / math.sqrt(len(found))  # Kolmogorov: false alarm 1 %


def test_errors_of_both_coordinates_and_their_correlation():
    """Width by dx/dF from the law alone: (s_x + dx/dF s_F) for -1, and in quadrature for 0."""
    noise = np.random.default_rng(3).normal(size=X.size) * 1e-9
    step = 1e-12
    slope = (
        2
        * step
        / (
            tweezer.chain_force("bouchiat", X + step, **DNA)
            - tweezer.chain_force("bouchiat", X - step, **DNA)
        )
    )
    common = {"model": "bouchiat", "temperature": T, "extension_error": 1e-9}
    alone = tweezer.fit_chain(X + noise, FORCE, **common)
    for correlation, width in ((-1.0, 1e-9 + slope * 1e-13), (0.0, np.hypot(1e-9, slope * 1e-13))):
        both = tweezer.fit_chain(
            X + noise, FORCE, **common, force_error=1e-13, correlation=correlation
        )
        ratio = np.sum((alone.residuals * 1e-9 / width) ** 2)
        assert both.chi_squared == pytest.approx(ratio, rel=0.15)
        assert both.chi_squared < alone.chi_squared


@pytest.mark.parametrize("correlation", [-0.9, 0.5])
def test_residuals_are_shortest_distances(correlation):
    """The least a^2 + b^2 over all points of the fitted curve, by bounded minimisation."""
    rng, s_x, s_F = np.random.default_rng(5), 8e-9, 5e-14
    a, b = rng.normal(size=(2, X.size))
    x = X + s_x * (correlation * a + math.sqrt(1 - correlation**2) * b)
    force = FORCE + s_F * a
    fit = tweezer.fit_chain(
        x, force, model="bouchiat", temperature=T, extension_error=s_x, force_error=s_F,
        correlation=correlation,
    )  # fmt: skip
    fitted = {name: getattr(fit, name) for name in ("contour_length", "persistence_length")}

    def distance(point, i):
        there = tweezer.chain_force("bouchiat", point, **fitted, temperature=T)
        a = (force[i] - there) / s_F
        b = ((x[i] - point) / s_x - correlation * a) / math.sqrt(1 - correlation**2)
        return a**2 + b**2

    for i in range(0, X.size, 3):
        bounds = (x[i] - 5 * s_x, min(x[i] + 5 * s_x, 0.999 * fit.contour_length))
        least = minimize_scalar(distance, bounds=bounds, args=(i,), options={"xatol": 1e-14})
        assert fit.residuals[i] ** 2 == pytest.approx(least.fun, rel=1e-3, abs=1e-4)


def test_units_and_text():
    fit = tweezer.fit_chain(
        [f"{each * 1e9:.6f} nm" for each in X], FORCE,
        model="bouchiat", temperature="24.85 degC", extension_error="1 nm",
    )  # fmt: skip
    assert fit.contour_length == pytest.approx(1e-6, rel=1e-5)
    assert "contour length      1000 nm" in repr(fit)
    assert "pN, given" in repr(tweezer.fit_chain(X, FORCE, **GIVEN, stretch_modulus="1000 pN"))


def test_wrong_law_and_small_errors_are_findings():
    jointed = tweezer.chain_force("fjc", X, **DNA)
    found = tweezer.fit_chain(X, jointed, **GIVEN)
    assert [each.name for each in found.findings] == ["residuals", "trend"]
    noise = np.random.default_rng(4).normal(size=X.size) * 3e-9
    found = tweezer.fit_chain(X + noise, FORCE, **GIVEN)
    assert [each.name for each in found.findings] == ["residuals"]


REFUSED = [
    ({"model": "wlc"}, "model = 'wlc': is unknown"),
    ({"model": "twlc"}, "twist_rigidity: is required"),
    ({"model": "fjc", "stretch_modulus": "fit"}, "stretch_modulus = .*: is not a parameter"),
    ({"model": "odijk", "force": FORCE - 2e-13}, "force = .* is outside the range of model"),
    ({"model": "odijk", "force": FORCE}, "is at the limit of model = 'odijk'"),
    ({"force": FORCE[:5]}, "force: has the shape"),
    ({"extension": [[1e-7]], "force": [[1e-13]]}, "extension: has the shape"),
    ({"force": FORCE * math.nan}, "force: contains values that are not finite"),
    ({"extension_error": 0}, "extension_error, force_error: are 0"),
    ({"extension_error": -1e-9}, "extension_error = -1e-09: must not be negative"),
    ({"correlation": 1.0}, "correlation: must be from -1 to less than 1"),
    ({"extension": -X}, "extension: must contain positive numbers"),
    ({"extension": X[:2], "force": FORCE[:2]}, "must contain more than the 2 fitted parameters"),
    ({"extension": X[:4], "force": FORCE[:4], "stretch_modulus": "fit"}, "not determine"),
]  # fmt: skip


@pytest.mark.parametrize(("changed", "message"), REFUSED)
def test_refusals(changed, message):
    with pytest.raises(tweezer.TweezerError, match=message) as refused:
        tweezer.fit_chain(**{"extension": X, "force": FORCE} | GIVEN | changed)
    assert "\n" not in str(refused.value)
