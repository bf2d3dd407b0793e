"""Two spheres: identities of bispherical harmonics, of the far mobility and of the distance."""

import numpy as np
import pytest
import sympy as sp

from derivation import pair, wall
from derivation.equations import is_zero
from tweezer.fluid import two_spheres

SIGNS = pytest.mark.parametrize("sign", [1, -1])


# --- bispherical harmonics -----------------------------------------------------------------------
@SIGNS
@pytest.mark.parametrize("position", [False, True])
def test_derivatives_along_z_and_x_contain_three_degrees(sign, position):
    assert pair.identity_along(sign, position=position) == 0


@pytest.mark.parametrize(("sign", "order"), [(1, 0), (1, 1), (1, 2), (-1, 0)])
def test_derivative_along_rho_changes_the_order_and_contains_three_degrees(sign, order):
    assert pair.identity_across(sign, order) == 0


@pytest.mark.parametrize(
    ("factors", "order", "to"),
    [(pair.COSINE, 0, 0), (pair.COSINE, 1, 1), (pair.RAISED, 0, 1), (pair.RAISED, 1, 2),
     (pair.LOWERED, 1, 0)],
)  # fmt: skip
def test_products_with_cosine_and_sine_contain_two_degrees(factors, order, to):
    assert pair.identity_product(factors, order, to) == 0


def test_wrong_factor_does_not_pass():
    assert pair.identity_product(pair.RAISED, 1, 0) != 0


def test_harmonics_satisfy_laplaces_equation():
    """The Laplacian d2/dz2 + (d/drho + 1/rho) d/drho of m = 0 vanishes by the derivatives alone."""
    along = pair.rows(pair.ALONG_Z, 0)
    twice = {}
    for after, before in (
        (along, along),
        (pair.rows(pair.ACROSS[1], 1), pair.rows(pair.ACROSS[0], 0)),
    ):
        for first, a in after.items():
            for second, b in before.items():
                shift = first + second
                twice[shift] = twice.get(shift, 0) + a * b.subs(pair.n, pair.n + first)
    assert sorted(twice) == [-2, -1, 0, 1, 2]
    assert all(is_zero(each) for each in twice.values())


# --- surfaces and continuity ---------------------------------------------------------------------
def test_pressure_and_components_give_the_velocity_of_the_surface():
    """2 u_rho = rho Q + U_0 + U_2, 2 u_phi = U_2 - U_0, 2 u_z = z Q + 2 W; U_1 along the line."""
    p = pair
    assert is_zero(p.radius_ * p.Q + p.U_0 + p.U_2 - 2 * p.V_rho)
    assert is_zero(p.U_2 - p.U_0 - 2 * p.V_phi)
    assert is_zero(p.height * p.Q + 2 * p.W - 2 * p.V_z)
    assert is_zero(p.radius_ * p.Q + p.U_1 - 2 * p.V_rho)


@SIGNS
@pytest.mark.parametrize("order", [0, 1])
def test_continuity_is_tridiagonal(order, sign):
    rows = pair.continuity(order, sign)
    assert sorted(rows) == [-2, -1, 0, 1, 2]
    assert is_zero(rows[-2])
    assert is_zero(rows[2])
    assert not is_zero(rows[1])


@pytest.mark.parametrize("order", [0, 1])
def test_solver_uses_the_derived_operators(order):
    """Rows of the degrees 2 to 6; lengths of the other sphere scale the powers of e^xi."""
    h = two_spheres._Harmonics(two_spheres.geometry(1, 1, 1), order, 8)
    spread = [3 * (at == 1) + each for at, each in enumerate(pair.ALONG_X)]
    known = [
        (h.spread(), spread, order), (h.slope(0), pair.ALONG_Z, order),
        (h.cosine, pair.COSINE, order), (h.raised, pair.RAISED, order),
        *zip(h.divergences(), ([pair.ACROSS[1]], [pair.ACROSS[0], pair.ACROSS[2]])[order],
             ((1,), (0, 2))[order], strict=True),
        *([(h.lowered, pair.LOWERED, 1)] if order else []),
    ]  # fmt: skip
    for array, factors, of in known:
        rows = pair.rows(tuple(factors), of)
        expected = [
            [float(rows[shift].subs(pair.n, n)) for n in range(2, 7)] for shift in (-1, 0, 1)
        ]
        np.testing.assert_allclose(array[:, 2:7], expected, rtol=1e-15)


# --- far spheres and Brownian motion -------------------------------------------------------------
@pytest.mark.parametrize("parts", [pair.APART, pair.OVERLAP], ids=["apart", "overlap"])
def test_mobility_of_rotne_and_prager_has_no_divergence(parts):
    assert is_zero(pair.divergence(parts))


def test_mobility_of_rotne_and_prager_is_continuous():
    """Where the spheres touch, and where the small one is inside the large one."""
    a, b, r = pair.a_1, pair.a_2, pair.r
    for one, other in zip(pair.APART, pair.OVERLAP, strict=True):
        assert is_zero((one - other).subs(r, a + b))
    inside = [each.subs(r, a - b) for each in pair.OVERLAP]
    assert is_zero(inside[0] - 1 / a)
    assert is_zero(inside[1])


def test_drift_of_the_relative_position_and_of_the_distance():
    along, across, r = pair.along, pair.across, pair.r
    drift = pair.drift()
    assert is_zero(drift[0])
    assert is_zero(drift[1])
    assert is_zero(drift[2] - along.diff(r) - 2 * (along - across) / r)
    assert is_zero(pair.drift_of_distance() - pair.DISTANCE.rhs)


def test_plane_gives_the_motion_of_the_distance():
    """Ito: the drift a (F + 2/rho) + a' of the wall's plane is that of the distance."""
    mobility = wall.root**2 / 2
    drift = wall.DRIFT_OF_GAP.subs(wall.F, pair.FORCE_IN_PLANE)
    assert is_zero(drift - (mobility * wall.F + wall.mu_g + 2 * mobility / pair.distance))


def test_boltzmanns_density_of_the_distance_has_no_flux():
    """The density is rho^2 e^(-U/kT): its flux by the drift cancels its flux by the noise."""
    r, a = pair.r, pair.along
    phi = sp.Function("phi")(r)
    density = r**2 * sp.exp(phi)
    drift = a * phi.diff(r) + pair.DISTANCE.rhs
    assert is_zero(sp.expand((drift * density - (a * density).diff(r)) / density))
