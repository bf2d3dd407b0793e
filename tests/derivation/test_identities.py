"""Each step of the derivation proven: differences that expand to zero, or typed pages."""

import numpy as np
import pytest
import sympy as sp

from derivation import drag as dg
from derivation import euler_parameters as ep
from derivation import multiscale as ms
from derivation import ray
from derivation import rigid_body as rb
from derivation import symbols as sy
from derivation.equations import Equation, is_zero
from derivation.symbols import vector


def test_is_zero_can_say_no():
    x = sp.Symbol("x", real=True)
    assert not is_zero(sp.Matrix([0, x]))
    assert is_zero(sp.Matrix([(x + 1) ** 2 / x - x - 2 - 1 / x]))


def test_rotation_matrix_is_the_printed_one():
    e0, e1, e2, e3 = ep.e
    printed = sp.Matrix(
        [
            [e0**2 + e1**2 - e2**2 - e3**2, 2 * (e1 * e2 - e0 * e3), 2 * (e1 * e3 + e0 * e2)],
            [2 * (e1 * e2 + e0 * e3), e0**2 - e1**2 + e2**2 - e3**2, 2 * (e2 * e3 - e0 * e1)],
            [2 * (e1 * e3 - e0 * e2), 2 * (e2 * e3 + e0 * e1), e0**2 - e1**2 - e2**2 + e3**2],
        ]
    )
    assert is_zero(ep.R - printed / ep.norm_squared)


def test_rotation_matrix_is_a_rotation():
    assert is_zero(ep.R * ep.R.T - sp.eye(3))
    assert sp.cancel(ep.R.det()) == 1


def test_L_read_off_the_rotation_is_the_printed_one():
    e0, e1, e2, e3 = ep.e
    printed = 2 * sp.Matrix([[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]])
    assert printed == ep.L
    rates = dict(zip(ep.e, ep.edot, strict=True))
    assert printed.subs(rates, simultaneous=True) == ep.Ldot


def test_identities_of_L():
    assert is_zero(ep.L_TIMES_E.rhs)
    assert is_zero(ep.L_L_TRANSPOSED.rhs - 4 * ep.norm_squared * sp.eye(3))
    assert is_zero(ep.LDOT_EDOT.rhs)


def test_rates_from_omega_give_omega_back_and_keep_the_constraint():
    edot = ep.euler_rates_from_omega
    assert is_zero(ep.L * edot / ep.norm_squared - ep.omega)
    assert is_zero(ep.e.T * edot)


def test_projection_meets_the_constraints():
    assert is_zero(ep.unit_euler_parameters.T * ep.unit_euler_parameters - sp.Matrix([1]))
    assert is_zero(ep.e.T * ep.tangent_euler_rates)


@pytest.mark.parametrize("equation", [rb.NORMALITY, rb.NORMALITY_RATE, rb.NORMALITY_ACCELERATION])
def test_constraint_rows_are_the_printed_ones(equation):
    printed = {
        "A.21": (ep.e.T * ep.e)[0] - 1,
        "A.22": (ep.e.T * ep.edot)[0],
        "A.23": (ep.e.T * rb.eddot)[0] + (ep.edot.T * ep.edot)[0],
    }
    assert is_zero(equation.rhs - printed[equation.number])


def test_K_is_the_printed_one_and_reduces():
    omega = ep.L * ep.edot
    printed = rb.I_AA * ep.Ldot * ep.edot + omega.cross(rb.I_AA * omega)
    assert is_zero(rb.K(rb.I_AA) - printed)
    reduced = rb.reduced_K(rb.I_AA).subs(dict(zip(ep.omega, omega, strict=True)))
    assert is_zero(rb.K(rb.I_AA) - reduced)


def test_K_vanishes_for_a_sphere_and_for_no_other_body():
    assert is_zero(rb.GYROSCOPIC_SPHERE.rhs)
    assert is_zero(rb.reduced_K(rb.I_sphere))
    assert not is_zero(rb.GYROSCOPIC.rhs)


def test_closed_form_solves_A24():
    assert is_zero(rb.I_TILDE.rhs * rb.EULER_ACCELERATION.rhs - rb.M_TILDE.rhs)


def test_angular_acceleration_follows_from_the_closed_form():
    """w' = L e'' + L' e' at |e| = 1, where omega = L e'."""
    omega = ep.L * ep.edot
    from_rates = ep.L * rb.EULER_ACCELERATION.rhs + ep.Ldot * ep.edot
    direct = rb.ANGULAR_ACCELERATION_EQUATION.rhs.subs(dict(zip(ep.omega, omega, strict=True)))
    assert is_zero(from_rates - direct)


def test_expansion_has_the_printed_orders():
    q, u = ms.q_scales, ms.u_scales
    assert is_zero(ms.leading_order - (q.diff(ms.T0) - u))
    assert is_zero(ms.first_order - (q.diff(ms.T0, 2) + q.diff(ms.T1)))
    expected = sum(
        ms.epsilon ** (i + j) * q.diff(a, b)
        for i, a in enumerate((ms.T0, ms.T1))
        for j, b in enumerate((ms.T0, ms.T1))
    )
    assert is_zero(ms.SECOND_TIME_DERIVATIVE.rhs - expected)


def test_dropping_a1_leaves_the_scaled_model():
    q_dot, q_ddot, u = sp.symbols("qdot qddot u", real=True)
    printed = ms.a2 * (q_dot - u) + ms.epsilon * q_ddot
    assert is_zero(ms.SCALED_BALANCE.rhs - printed)


def test_scaled_model_is_the_full_model_of_mass_over_a2():
    """(4.16) divided by a2: the same drag and forces, an inertia of m/a2."""
    full = rb.acceleration.subs(rb.m, rb.m / ms.a2)
    assert is_zero(ms.scaled_acceleration - full)


def test_scaled_angular_acceleration_solves_4_18():
    """I-tilde e'' = M-tilde with a2 M - K, at |e| = 1."""
    eddot = rb.euler_acceleration(rb.I_AA, ms.a2 * rb.M_any, rb.K(rb.I_AA))
    assert is_zero(rb.I_TILDE.rhs * eddot - ms.SCALED_M_TILDE.rhs)
    omega = dict(zip(ep.omega, ep.L * ep.edot, strict=True))
    direct = rb.angular_acceleration(rb.I_AA, ms.a2 * rb.M_any).subs(omega)
    assert is_zero(ep.L * eddot - direct)


STOKES = dict(
    zip(
        vector(sy.MOBILITY),
        (1 / rb.beta_v, 1 / rb.beta_v, 1 / rb.beta_w, 1 / rb.beta_w, 0),
        strict=True,
    )
)


def test_drag_is_the_inverse_of_the_mobilities():
    """What moves a body is balanced by its drag, and the mobilities are symmetric (Onsager)."""
    force, moment = vector(sy.FORCE), vector(sy.MOMENT)
    v, w = dg.velocity(force, moment, dg.n), dg.angular_velocity(force, moment, dg.n)
    assert is_zero(dg.force(v, w, dg.n) + force)
    assert is_zero(dg.moment(v, w, dg.n) + moment)
    matrix = v.col_join(w).jacobian(force.col_join(moment))
    assert is_zero(matrix - matrix.T)
    assert not matrix.is_diagonal()


def test_uniform_drag_is_stokes_drag():
    """(2.13)-(2.14), and with it (A.12), (4.16) and (5.2)."""
    for general, printed in (
        (dg.acceleration, rb.acceleration),
        (dg.acceleration_without_rotation, rb.acceleration),
        (dg.drag_moment, rb.drag_moment),
        (dg.overdamped_velocity, ms.overdamped_velocity),
        (dg.overdamped_velocity_without_rotation, ms.overdamped_velocity),
        (dg.overdamped_angular_velocity, ms.overdamped_angular_velocity),
    ):
        assert is_zero(general.subs(STOKES) - printed)
        assert not is_zero(general - printed)


def test_drag_is_the_same_in_the_frame_of_the_body():
    moment = vector(sy.MOMENT)
    w = ep.R * dg.overdamped_angular_velocity
    assert is_zero(w - dg.angular_velocity(rb.F_others, moment, dg.n))
    turned = ep.R * dg.drag_moment - dg.moment(rb.v, ep.R * ep.omega, dg.n)
    numbers = dict(zip(ep.e, (sp.Rational(1, 2), 3, -2, sp.Rational(5, 7)), strict=True))
    assert is_zero(turned.subs(numbers))


def test_a_body_whose_rotation_is_not_followed_rolls_freely():
    """The rotation on which no moment acts makes the drag that of `..._without_rotation`."""
    rolling = dg.b_roll / dg.b_parallel * dg.n.cross(rb.v)
    assert is_zero(dg.moment(rb.v, rolling, dg.n))
    free = (rb.F_others + dg.force(rb.v, rolling, dg.n)) / rb.m
    assert is_zero(free - dg.acceleration_without_rotation)


def test_balance_and_split_are_the_printed_ones():
    q, u = ms.q_scales, ms.u_scales
    qdot, qddot = ms.TIME_DERIVATIVE.rhs, ms.SECOND_TIME_DERIVATIVE.rhs
    assert is_zero(ms.BALANCE.rhs - (ms.epsilon * qddot - u + qdot))
    assert is_zero(ms.SPLIT.rhs.subs(ms.a1, 1 - ms.a2) - (q.diff(ms.T0) - u))


def test_first_order_model_meets_newtons_law_to_its_order():
    """Insert v = u - tau (Du) u into m dv/dt = F - beta v: what is left is of order m^2."""
    k, x = sp.symbols("k x", positive=True)
    u = sp.Function("u")(x)
    tau = rb.m / rb.beta_v
    v = u - tau * u.diff(x) * u
    residue = rb.m * v.diff(x) * v - rb.beta_v * (u - v)
    assert sp.expand(residue).coeff(rb.m, 0) == 0
    assert sp.simplify(sp.expand(residue).coeff(rb.m, 1)) == 0
    # and the emitted vector form is that v, for a force -k q1 along N1
    F, DF = -k * ms.q[0], -k
    inputs = {sp.Symbol(f"F{i}", real=True): 0 for i in (2, 3)}
    inputs |= {sp.Symbol(f"W{i}", real=True): 0 for i in (1, 2, 3)}
    inputs |= {sp.Symbol("F1", real=True): F, sp.Symbol("Fdot1", real=True): DF * F / rb.beta_v}
    expected = v.subs(u, -k * x / rb.beta_v).doit().subs(x, ms.q[0])
    assert is_zero(ms.first_order_velocity[0].subs(inputs) - expected)


def test_turning_of_the_frame_adds_nothing_to_the_rate_of_the_moment():
    in_body_frame = ep.R.T * ms.moment_rate
    assert is_zero(ms.along_leading_order(rb.M_others) - in_body_frame)


def test_layer_and_matched_start():
    x0, v0, u = sp.symbols("x0 v0 u", real=True)
    assert is_zero(ms.MATCHED_START.rhs - (x0 + ms.epsilon * (v0 - u)))
    s = sp.Symbol("s", positive=True)
    x = ms.LAYER.rhs
    assert is_zero(x.diff(s, 2) + x.diff(s) - ms.epsilon * u)
    assert x.subs(s, 0).expand() == x0
    assert x.diff(s).subs(s, 0).expand() == ms.epsilon * v0


def test_layer_remainder_is_what_dsolve_leaves_to_decay():
    """Slow part plus remainder is the whole layer: at t = 0 the bead is where it was released."""
    remains = ms.layer(rb.I_AA)
    at_release = remains.subs(ms.t, 0)
    assert is_zero(ms.matched_position + at_release[:3, :] - ms.q)
    assert is_zero(ms.overdamped_velocity + at_release[3:6, :] - rb.v)
    turned = ms.matched_euler_parameters(rb.I_AA) - ep.e
    assert is_zero(turned + ep.L.T * at_release[6:9, :] / 4)
    assert is_zero(ms.overdamped_angular_velocity + at_release[9:, :] - ep.omega)
    assert is_zero(remains[:3, :].diff(ms.t) - remains[3:6, :])


def test_series_of_emergent_rays_sums_to_the_printed_efficiencies():
    difference = ray.EMERGENT_RAYS.rhs - (ray.Q_sc + sp.I * ray.Q_gr)
    assert is_zero(sp.expand(sp.expand(difference.rewrite(sp.exp)), power_exp=True))


def test_torque_of_a_lossless_sphere_is_zero():
    assert ray.absorbed_angular_momentum() == 0


def _in_angles(expression):
    """Trigonometry-free expression back in alpha and beta, with mu from Snell's law (3.14)."""
    mu = sp.sin(ray.beta) / sp.sin(ray.alpha)
    values = {
        ray.C: sp.cos(ray.alpha) ** 2,
        ray.c: sp.cos(ray.alpha),
        ray.b: sp.cos(ray.beta) / mu,
        ray.S: sp.sin(ray.alpha) ** 2,
        ray.mu: mu,
    }
    for part, value in reversed(ray.PARTS.items()):
        expression = expression.subs(part, value)
    return expression.subs(values)


def _vanishes_on_angles(expression):
    """Zero as a polynomial in the sines and cosines, modulo sin^2 + cos^2 = 1."""
    sa, ca, sb, cb = sp.symbols("sa ca sb cb")
    angles = {
        sp.sin(ray.alpha): sa, sp.cos(ray.alpha): ca, sp.sin(ray.beta): sb, sp.cos(ray.beta): cb,
    }  # fmt: skip
    numerator = sp.numer(sp.together(sp.expand_trig(expression).subs(angles)))
    circles = [sa**2 + ca**2 - 1, sb**2 + cb**2 - 1]
    return sp.reduced(sp.expand(numerator), circles, ca, cb, sa, sb)[1] == 0


def test_efficiencies_without_trigonometry_are_the_printed_ones():
    light = ray.polarised(ray.q * ray.R_i / (1 - ray.R_i))  # T = 1 - R
    printed_sc = ray.Q_sc.subs(ray.T_i, 1 - ray.R_i)
    printed_gr = ray.Q_gr.subs(ray.T_i, 1 - ray.R_i)
    assert _vanishes_on_angles(_in_angles(ray.scattering(light)) - printed_sc)
    minus_gr = _in_angles(ray.gradient(light)) * sp.sin(ray.alpha)
    assert _vanishes_on_angles(minus_gr + printed_gr)
    assert not _vanishes_on_angles(minus_gr - printed_gr)


def test_reduced_equations_are_the_printed_ones_for_s_polarised_light():
    """With Fresnel's R = sin^2(alpha - beta)/sin^2(alpha + beta), at 50 digits."""
    at = {ray.alpha: sp.Rational(11, 10), ray.mu: sp.Rational(5, 6)}
    at[ray.beta] = sp.asin(at[ray.mu] * sp.sin(at[ray.alpha]))
    at[ray.S] = sp.sin(at[ray.alpha]) ** 2
    R = (sp.sin(ray.alpha - ray.beta) / sp.sin(ray.alpha + ray.beta)) ** 2
    for equation, printed in (
        (ray.SCATTERING_REDUCED, ray.Q_sc),
        (ray.GRADIENT_REDUCED, -ray.Q_gr / sp.sin(ray.alpha)),
    ):
        reduced = ray.in_S(equation.rhs).subs(at)
        expected = printed.subs({ray.R_i: R, ray.T_i: 1 - R}).subs(at)
        assert abs(sp.N(reduced - expected, 60)) < sp.Float("1e-50", 60)
        assert abs(sp.N(expected, 10)) > 0.1


def test_fresnel_coefficients_are_the_printed_ones():
    n_m, n_p = sp.symbols("n_m n_P", positive=True)
    ca, cb = sp.cos(ray.alpha), sp.cos(ray.beta)
    s = ((n_m * ca - n_p * cb) / (n_m * ca + n_p * cb)) ** 2
    p = ((n_m * cb - n_p * ca) / (n_m * cb + n_p * ca)) ** 2
    snell = {n_p: n_m * sp.sin(ray.alpha) / sp.sin(ray.beta)}
    for X, printed in ((ray.X_s, s), (ray.X_p, p), (ray.N / ray.V, (s + p) / 2)):
        assert _vanishes_on_angles(_in_angles(ray.reflectance(X)) - printed.subs(snell))


def test_denominators_are_those_of_the_reflectance():
    """Of s and p; and T = 2 q V of light whose R is averaged, with T = q/(q + X)."""
    for X, D in ((ray.X_s, ray.D_s), (ray.X_p, ray.D_p)):
        assert _vanishes_on_angles(_in_angles(D - ray.denominator(X)))
    assert _vanishes_on_angles(_in_angles(2 * ray.q * ray.V + 2 * ray.N - 1))


@pytest.mark.parametrize("efficiency", [ray.scattering, ray.gradient])
def test_lights_are_brought_to_one_fraction(efficiency):
    """The mean of s and p; R averaged; and both by the parts that the efficiencies share."""
    of_one_fraction = efficiency(ray.CIRCULAR).subs(
        {ray.t_s: ray.X_s * ray.D_p, ray.t_p: ray.X_p * ray.D_s}
    )
    mean = (efficiency(ray.S_POLARISED) + efficiency(ray.P_POLARISED)) / 2
    assert is_zero(of_one_fraction - mean)
    X = ray.N / ray.V
    averaged = efficiency(ray.polarised(X)).subs(ray.q, 1 / (2 * ray.V) - X)
    assert is_zero(efficiency(ray.AVERAGED).subs(ray.q, 1 / (2 * ray.V) - X) - averaged)
    shared = {ray.scattering: ray.shared_scattering, ray.gradient: ray.shared_gradient}[efficiency]
    for light in (ray.CIRCULAR, ray.AVERAGED):
        off = shared(light).subs(ray.efficiency_parts(light)) - efficiency(light)
        assert is_zero(off.subs(ray.C, ray.c**2))


def test_total_reflection_is_the_limit_of_full_reflectance():
    """R = 1, T = 0 in (3.19) and (3.21)."""
    total = {ray.R_i: 1, ray.T_i: 0}
    assert _vanishes_on_angles(ray.Q_sc.subs(total) - _in_angles(ray.TOTAL_SCATTERING))
    minus_gr = _in_angles(ray.TOTAL_GRADIENT) * sp.sin(ray.alpha)
    assert _vanishes_on_angles(ray.Q_gr.subs(total) + minus_gr)


@pytest.mark.parametrize("efficiency", [ray.shared_scattering, ray.shared_gradient])
def test_rates_over_S_are_derivatives(efficiency):
    """The chain rule through the named parts against a derivative of the whole, at 60 digits."""
    S0, mu0 = sp.Rational(37, 100), sp.Rational(5, 6)
    at = {ray.S: S0, ray.mu: mu0}
    for light in (ray.CIRCULAR, ray.AVERAGED):
        parts = {**ray.PARTS, **ray.efficiency_parts(light)}
        by_parts = ray.rate_in_S(efficiency(light))
        for part, value in reversed(parts.items()):
            by_parts = by_parts.subs(ray.PART_RATES[part], ray.rate_of_part(part, value))
        by_parts = ray.in_S(by_parts.subs(ray.h, ray.per_cosines).subs(parts))
        difference = by_parts - ray.in_S(efficiency(light).subs(parts)).diff(ray.S)
        assert abs(sp.N(difference.subs(at), 60)) < sp.Float("1e-55", 60)


def test_gradients_in_space_are_derivatives_of_force_and_moment():
    """Chain rule over n and S against the derivative of the force written over p."""
    u_vector = sp.Matrix([sp.Rational(2, 7), sp.Rational(3, 7), sp.Rational(6, 7)])
    place = sp.Matrix([sp.Rational(1, 10), sp.Rational(-1, 5), sp.Rational(3, 20)])
    S = ray.S_of_p
    Qs, G = 2 + sp.sin(S), sp.exp(S)  # any functions of S
    values = {ray.Qs: Qs, ray.dQs: sp.cos(S), ray.G: G, ray.dG: sp.exp(S), ray.c: sp.sqrt(1 - S)}
    n_values = dict(zip(ray.n, ray.n_of_p, strict=True))
    at = {**dict(zip(ray.u, u_vector, strict=True)), **dict(zip(ray.p, place, strict=True)),
          ray.r: sp.Rational(4, 5)}  # fmt: skip
    for quantity, gradient in (
        (ray.force, ray.force_gradient),
        (ray.moment_reduced, ray.moment_gradient),
    ):
        over_p = quantity.subs(values).subs(n_values)
        difference = over_p.jacobian(ray.p) - gradient.subs(values).subs(n_values)
        assert difference.subs(at).evalf(40).norm() < 1e-35


def test_force_by_the_place_along_the_ray_is_that_by_the_nearest_point():
    """S and force (3.24) of a unit ray, by s = u.p/r in place of n."""
    along = dict(zip(ray.place, ray.p / ray.r, strict=True))
    s = {ray.s: ray.along_ray}
    unit = {ray.u[2]: sp.sqrt(1 - ray.u[0] ** 2 - ray.u[1] ** 2)}
    n = dict(zip(ray.n, ray.n_of_p, strict=True))
    S = ray.S_by_place.subs(s).subs(along)
    assert is_zero((S - ray.S_of_p).subs(unit))
    force = (ray.force_along_ray.subs(s) - ray.G * ray.place).subs(along)
    assert is_zero((force - ray.force.subs(n)).subs(unit))


def test_split_is_the_difference_of_s_and_p():
    """(Q_s - Q_p)/(2 S), where nothing is lost by the difference."""
    at = {ray.S: sp.Rational(37, 100), ray.mu: sp.Rational(5, 6)}
    for efficiency in (ray.scattering, ray.gradient):
        difference = efficiency(ray.S_POLARISED) - efficiency(ray.P_POLARISED)
        off = ray.in_S(ray.split(efficiency) - difference / (2 * ray.S)).subs(at)
        assert abs(sp.N(off, 60)) < sp.Float("1e-55", 60)


def test_field_of_a_ray_is_carried_without_turning():
    """Turned with the ray by theta in the plane of z and u, and not about the ray."""
    theta, phi = sp.symbols("theta phi", real=True)
    direction = sp.Matrix([sp.sin(theta) * sp.cos(phi), sp.sin(theta) * sp.sin(phi), sp.cos(theta)])
    e_theta, e_phi = direction.diff(theta), direction.diff(phi) / sp.sin(theta)
    at = dict(zip(ray.u, direction, strict=True))
    jones = [quantity.symbol for quantity in sy.JONES]
    field = ray.field_real.subs(at).subs(dict(zip(jones, (1, 0, 0, 0), strict=True)))
    expected = sp.cos(phi) * e_theta - sp.sin(phi) * e_phi
    assert is_zero(sp.simplify(field - expected))
    across = ray.field_real.subs(at).subs(dict(zip(jones, (0, 0, 1, 0), strict=True)))
    assert is_zero(sp.simplify(across - (sp.sin(phi) * e_theta + sp.cos(phi) * e_phi)))


def test_sigma_is_the_excess_of_s_polarised_power():
    """S (f_s - f_p) by projection on the normal of the plane of incidence, and its derivative."""
    rng = np.random.default_rng(3)
    for _ in range(5):
        direction = rng.normal(size=3)
        direction[2] = abs(direction[2])
        direction /= np.linalg.norm(direction)
        jones = rng.normal(size=4)
        jones /= np.linalg.norm(jones)
        at = dict(zip(ray.u, map(sp.Float, direction), strict=True))
        at |= dict(
            zip([quantity.symbol for quantity in sy.JONES], map(sp.Float, jones), strict=True)
        )
        real = np.array(ray.field_real.subs(at), dtype=float).ravel()
        imaginary = np.array(ray.field_imaginary.subs(at), dtype=float).ravel()
        field = dict(zip((*ray.E, *ray.H), (*real, *imaginary), strict=True))

        def sigma(place, direction=direction, real=real, imaginary=imaginary):
            normal = np.cross(direction, place)
            S = normal @ normal / 0.64
            f_s = abs((real + 1j * imaginary) @ normal) ** 2 / (normal @ normal)
            return S * (2 * f_s - 1)

        place = rng.normal(size=3) * 0.3
        n = (direction @ place) * direction - place
        values = at | field | dict(zip(ray.n, n, strict=True)) | {ray.r: 0.8}
        assert float(ray.sigma.subs(values)) == pytest.approx(sigma(place), abs=1e-14)
        step = 1e-6
        differences = [
            (sigma(place + step * axis) - sigma(place - step * axis)) / (2 * step)
            for axis in np.eye(3)
        ]
        derived = np.array(ray.sigma_gradient.subs(values), dtype=float).ravel()
        np.testing.assert_allclose(derived, differences, atol=1e-8)


def test_moment_reduces_for_a_ray_orthogonal_to_n():
    """(n - r c u) x F with u.n = 0 and |u| = 1."""
    axes = {ray.u[0]: 0, ray.u[1]: 0, ray.u[2]: 1, ray.n[2]: 0}
    assert is_zero((ray.moment - ray.moment_reduced).subs(axes))


def test_equations_show_their_number():
    for equation in (rb.I_TILDE, ms.EXPANSION, ray.SCATTERING_FORCE):
        assert isinstance(equation, Equation)
        assert rf"\tag{{{equation.number}}}$$" in equation._repr_latex_()
