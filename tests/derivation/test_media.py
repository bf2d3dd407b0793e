"""Limits of the equations of mixtures and gases: no solute, continuum, free molecules."""

import sympy as sp

from derivation import media, water
from derivation.equations import is_zero

r = sp.Symbol("r", positive=True)
HUNDREDTHS = sp.Rational(1, 100)


def test_drag_of_a_continuum_is_that_of_stokes():
    assert media.drag_factor.subs(media.Kn, 0) == 1
    assert media.rotational_factor.subs(media.Kn, 0) == 1


def test_drag_of_free_molecules_is_that_of_epstein():
    """(4 pi/3) r^2 rho <c> (1 + pi a/8), in which the viscosity cancels."""
    free = sp.limit(media.drag_factor * media.Kn, media.Kn, sp.oo)
    found = 6 * sp.pi * media.mu * r * free * r / media.mean_free_path
    epstein = (
        sp.pi * sp.Rational(4, 3) * r**2 * media.gas_density * media.mean_speed
        * (1 + sp.pi * media.a / 8)
    )  # fmt: skip
    assert abs(sp.simplify(found / epstein) - 1) < 1e-14
    assert media.mu not in sp.simplify(found).free_symbols


def test_torque_of_free_molecules_is_the_diffuse_one():
    """(2 pi/3) a r^4 rho <c>, the integral of the tangential stress a rho <c> v/4 of a surface."""
    free = sp.limit(media.rotational_factor * media.Kn, media.Kn, sp.oo)
    found = 8 * sp.pi * media.mu * r**3 * free * r / media.mean_free_path
    theta = sp.Symbol("theta")
    arm = r * sp.sin(theta)
    stress = media.a * media.gas_density * media.mean_speed / 4 * arm
    torque = sp.integrate(stress * arm * 2 * sp.pi * r**2 * sp.sin(theta), (theta, 0, sp.pi))
    assert abs(sp.simplify(found / torque) - 1) < 1e-14


def test_mean_free_path_is_that_of_the_viscosity():
    """mu = rho <c> l/2, as in the kinetic theory with l = (mu/p) sqrt(pi k T/2 m)."""
    found = media.gas_density * media.mean_speed * media.mean_free_path / 2
    assert abs(sp.simplify(found / media.mu) - 1) < 1e-14


def test_mixtures_without_solute_are_water():
    assert is_zero(media.SUCROSE_DENSITY.subs(media.w, 0) - media.rho_w)
    assert is_zero(media.SUCROSE_VISCOSITY.subs(media.w, 0) - media.mu_w)
    assert is_zero(media.SALT_DENSITY.subs(media.b, 0) - media.rho_w)
    assert is_zero(media.SALT_VISCOSITY.subs(media.b, 0) - media.mu_w)
    # glycerol: the power of w that contracts it has no value at w = 0, but a limit
    assert is_zero(media.GLYCEROL_VISCOSITY.subs(media.w, 0) - media.mu_w)
    contraction = sp.exp(sp.Float("0.81") * media.log_sine)
    density = media.GLYCEROL_DENSITY.subs(contraction, 0).subs(media.w, 0)
    assert is_zero(density - media.rho_w)
    sine = media.LOG_SINE.subs(media.log_w, media.LOG_FRACTION)
    assert sp.exp(sp.Float("0.81") * sine).subs(media.w, sp.Float("1e-12")) < 1e-9


def test_index_without_solute_is_that_of_water():
    X = media.LORENTZ_LORENZ.subs([(media.w, 0), (media.rho, media.rho_w)])
    assert is_zero(X - water.lorentz_lorenz(media.n_w))


def test_cheng_s_formula_has_the_published_values():
    """Cheng (2008): 50 % at 20 degC, 6.002 mPa s over his water's 1.0050 mPa s."""
    found = media.GLYCEROL_VISCOSITY.subs({media.mu_w: 1, media.w: 50 * HUNDREDTHS,
                                           media.T: 293.15})  # fmt: skip
    assert abs(found / (6.002 / 1.0050) - 1) < 2e-3


def motion_with_circulation():
    """Matrix of (x, y, v_x, v_y) at the damping rate Gamma."""
    zero, one = sp.zeros(2), sp.eye(2)
    return sp.BlockMatrix(
        [[zero, one], [-media.circulating / media.m, -media.Gamma * one]]
    ).as_explicit()


def test_critical_drag_is_the_edge_of_growth():
    """Hurwitz's determinants are positive if and only if the drag exceeds the critical one."""
    s = sp.Symbol("s")
    coefficients = sp.Poly(motion_with_circulation().charpoly(s).as_expr(), s).all_coeffs()
    _, c3, c2, c1, c0 = coefficients
    assert all(each.is_positive for each in (c3, sp.factor(c2), c1, sp.factor(c0)))
    last = sp.factor(c3 * c2 * c1 - c1**2 - c3**2 * c0)
    drag = media.m * media.Gamma
    assert is_zero(
        last - 4 * media.Gamma**2 * media.a_k / media.m**3 * (drag**2 - media.critical_drag**2)
    )


def test_circulation_factor_solves_the_lyapunov_equation():
    A = motion_with_circulation()
    H = sp.Symbol("H", positive=True)
    unknown = sp.symbols("c:10")
    C, k = sp.zeros(4), 0
    for i in range(4):
        for j in range(i + 1):
            C[i, j] = C[j, i] = unknown[k]
            k += 1
    noise = sp.diag(0, 0, 2 * H / media.m, 2 * H / media.m)
    solved = sp.solve(list(A * C + C * A.T + noise), unknown)
    for i in (2, 3):
        found = C[i, i].subs(solved)
        assert is_zero(found - H / (media.m * media.Gamma) * media.circulation_factor)
