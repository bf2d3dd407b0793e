"""The fluid's inertia proven: the flow and its drag, the fictitious masses, the closed forms."""

import pytest
import sympy as sp

from derivation import hydrodynamics as hd
from derivation.equations import is_zero
from derivation.hydrodynamics import Omega, U, a, alpha, mu, r, rho, s, x

PLACE = sp.symbols("X Y Z", positive=True)
DISTANCE = sp.sqrt(sum(each**2 for each in PLACE))
#: a place and numbers of all else: what vanishes there vanishes
SOMEWHERE = dict(
    zip(PLACE, (sp.Rational(3, 2), sp.Rational(-2, 3), sp.Rational(5, 4)), strict=True)
)
SOMEWHERE |= {alpha: sp.Rational(7, 5), mu: 2, rho: 3, a: sp.Rational(1, 2), U: 1, Omega: 1}


def laplacian(field):
    return sum(field.diff(each, 2) for each in PLACE)


def vanishes(expression):
    return sp.simplify(expression.subs(SOMEWHERE)) == 0


@pytest.fixture(scope="module")
def flow():
    """u and p about a sphere that moves along z, by Cartesian components."""
    A, B = hd.CONSTANTS.values()
    chi = hd.potential(DISTANCE, A, B)
    u = [chi.diff(PLACE[2], each) for each in PLACE]
    u[2] -= laplacian(chi)
    return u, hd.pressure(PLACE[2] / DISTANCE, DISTANCE, B)


def test_flow_obeys_the_unsteady_stokes_equations(flow):
    u, p = flow
    for component, along in zip(u, PLACE, strict=True):
        assert vanishes(rho * s * component + p.diff(along) - mu * laplacian(component))
    assert vanishes(sum(component.diff(along) for component, along in zip(u, PLACE, strict=True)))


def test_flow_is_the_spheres_velocity_on_it(flow):
    direction = (sp.Rational(2, 7), sp.Rational(3, 7), sp.Rational(6, 7))
    on_it = {along: a * cosine for along, cosine in zip(PLACE, direction, strict=True)}
    for component, expected in zip(flow[0], (0, 0, U), strict=True):
        assert vanishes(component.subs(on_it) - expected)


def test_swirl_obeys_the_unsteady_stokes_equations():
    u = (hd.swirl(r) / r).subs(r, DISTANCE)
    for component in (-PLACE[1] * u, PLACE[0] * u):
        assert vanishes(rho * s * component - mu * laplacian(component))
    assert hd.swirl(a) == Omega * a


def test_drags():
    """Stokes's, his for any frequency, and Landau's of rotation."""
    assert is_zero(hd.TRANSLATION - 6 * sp.pi * mu * a * (1 + x + x**2 / 9))
    assert is_zero(hd.ROTATION - 8 * sp.pi * mu * a**3 * (3 + 3 * x + x**2) / (3 * (1 + x)))


def test_the_last_term_is_half_the_displaced_mass():
    """So that the mass in Z is the bead's own: it would else count twice."""
    displaced = sp.Rational(4, 3) * sp.pi * a**3 * rho
    (slope,) = sp.Poly(hd.TRANSLATION, x).coeffs()[:1]
    assert is_zero(slope * hd.tau_f - displaced / 2)
    assert is_zero(6 * sp.pi * mu * a * hd.tau_f - sp.Rational(9, 2) * displaced)


def test_by_frequency():
    w, y = hd.w, hd.y
    for parts, drag in (
        (hd.TRANSLATION_BY_FREQUENCY / hd.beta, 1 + x + x**2 / 9),
        (hd.ROTATION_BY_FREQUENCY / hd.beta_w, (3 + 3 * x + x**2) / (3 * (1 + x))),
    ):
        whole = parts[0] + sp.I * parts[1] - drag.subs(x, (1 + sp.I) * y)
        assert sp.simplify(whole) == 0
    Z = hd.IMPEDANCE[0] + sp.I * hd.IMPEDANCE[1]
    known = 4 * hd.kT * sp.re(1 / (Z + hd.k / (sp.I * w))) / w**2
    assert sp.simplify(hd.SPECTRUM - known) == 0
    # without inertia Lorentz's curve
    plain = hd.SPECTRUM.subs({y: 0, hd.m: 0})
    assert is_zero(plain - 4 * hd.kT * hd.beta / (hd.k**2 + (hd.beta * w) ** 2))


def test_the_root_is_a_sum_of_poles():
    """With p = q^2: (2/pi) int s/(s + q^2) dq."""
    q, rate = sp.symbols("q sigma", positive=True)
    whole = sp.integrate(2 / sp.pi * rate**2 / (rate**2 + q**2), (q, 0, sp.oo))
    assert sp.simplify(whole - rate) == 0


def test_resolvent_of_the_embedding_is_the_admittance():
    rate = sp.Symbol("s", positive=True)
    resolvent = (rate * sp.eye(hd.K + 1) - hd.EMBEDDED).inv()
    assert is_zero(resolvent[0, 0] / hd.inertia - 1 / hd.impedance(rate))


def test_maxwells_distribution_is_stationary():
    """Lyapunov's equation: fluctuation and dissipation, exactly, of any number of poles."""
    assert is_zero(hd.LYAPUNOV.rhs)


def test_sum_rules():
    """Of the weights of 1/Z_K = sum w/(s + lambda): 1/M, and 1/beta for w/lambda."""
    rate = sp.Symbol("s", positive=True)
    Z = hd.impedance(rate)
    assert is_zero(sp.limit(rate / Z, rate, sp.oo) - 1 / hd.inertia)
    assert Z.subs(rate, 0) == 1


def test_density_of_rates():
    """Its transform is 1/Z, by residues in q = sqrt(lambda), at one mass."""
    q, rate = sp.Symbol("q", real=True), sp.Rational(4)
    # two roots of their own: 1 - 4 mu_M > 0
    inertia = sp.Rational(2, 9)
    density = hd.DENSITY_OF_RATES.subs({hd.inertia: inertia, hd.l: q**2})
    integrand = sp.together(sp.sqrtdenest(density.subs(sp.sqrt(q**2), q)) * q / (rate + q**2))
    poles = [z for z in sp.roots(sp.denom(sp.cancel(integrand)), q) if sp.im(z) > 0]
    whole = sp.simplify(2 * sp.pi * sp.I * sum(sp.residue(integrand, q, z) for z in poles))
    assert sp.simplify(whole - 1 / (inertia * rate + sp.sqrt(rate) + 1)) == 0


def test_transform_of_each_term():
    """W = exp(z^2 t) erfc(-z sqrt(t)) obeys W' = z^2 W + z/sqrt(pi t), so L W = 1/(q (q - z))."""
    t, q = sp.symbols("t q", positive=True)
    z = sp.Symbol("z", real=True)
    W = sp.exp(z**2 * t) * sp.erfc(-z * sp.sqrt(t))
    assert sp.simplify(W.diff(t) - z**2 * W - z / sp.sqrt(sp.pi * t)) == 0
    assert W.subs(t, 0) == 1
    # s L - 1 = z^2 L + z/sqrt(s), s = q^2
    L = 1 / (q * (q - z))
    assert is_zero(q**2 * L - 1 - z**2 * L - z / q)


@pytest.mark.parametrize("name", hd.CLOSED_FORMS)
def test_closed_forms_are_partial_fractions(name):
    transform, by_roots = hd.CLOSED_FORMS[name]
    difference = transform - by_roots
    if name in ("settling", "displacement"):
        difference = difference.subs(hd.FREE[1], 1 / hd.FREE[0])
    assert is_zero(difference)


def test_tail_is_of_the_fluid_alone():
    """-sqrt(s tau_f)/beta in 1/Z is sqrt(tau_f)/(2 sqrt(pi) beta) t^(-3/2)."""
    t = hd._t
    beta = 6 * sp.pi * mu * a
    tail = sp.sqrt(hd.tau_f) / (2 * sp.sqrt(sp.pi) * beta) * t ** sp.Rational(-3, 2)
    assert sp.simplify(hd.TAIL.rhs - tail) == 0
    assert a not in hd.TAIL.rhs.free_symbols


def stress_over_sphere(radial, polar, pressure):
    """Force of a flow on the sphere: of u_r/cos, u_theta/sin and p/cos."""
    normal = -pressure + 2 * mu * radial.diff(r)
    shear = mu * (r * (polar / r).diff(r) - radial / r)
    over = 2 * sp.pi * a**2 * (sp.Rational(2, 3) * normal - sp.Rational(4, 3) * shear)
    return over.subs(r, a)


def by_potential(chi):
    return -2 * chi.diff(r) / r, chi.diff(r, 2) + chi.diff(r) / r


#: u_r, u_theta and p of the flows that a sphere at rest is in, each of velocity 1 at its centre
VORTICAL_FLOW = (*by_potential(-3 * sp.sinh(alpha * r) / (2 * alpha**3 * r)), sp.Integer(0))
UNIFORM_FLOW = (sp.Integer(1), sp.Integer(-1), -rho * s * r)


@pytest.mark.parametrize(
    ("flow", "weight"), [(VORTICAL_FLOW, hd.VORTICAL), (UNIFORM_FLOW, hd.DIPOLE)]
)
def test_what_a_sphere_feels_of_a_flow_is_what_it_sends(flow, weight):
    """The flow about it cancels the one it is in; the force of both together. And the two parts of
    the flow of a moving sphere have the same weights, as reciprocity wants.
    """
    radial, polar, _ = flow
    assert sp.limit(radial, r, 0) == 1
    A, B = sp.symbols("A B")
    around = by_potential(hd.potential(r, A, B))
    on_it = [sum(both).subs(r, a) for both in zip((radial, polar), around, strict=True)]
    (found,) = sp.solve(on_it, (A, B), dict=True)
    parts = (*around, hd.pressure(sp.Integer(1), r, B))
    total = stress_over_sphere(*(one + other for one, other in zip(flow, parts, strict=True)))
    force = total.subs(found) / (6 * sp.pi * mu * a)
    numbers = {alpha: sp.Rational(7, 5), mu: 2, rho: 3, a: sp.Rational(1, 2)}
    expected = weight.subs(x, alpha * a)
    assert abs(sp.N((force - expected).subs(numbers), 30)) < 1e-25


def test_what_a_moving_sphere_sends():
    per_force = 3 * U * a / (2 * alpha**2)
    vortical, dipole = hd.CONSTANTS.values()
    assert sp.simplify(vortical / per_force + hd.VORTICAL.subs(x, alpha * a)) == 0
    assert sp.simplify(dipole / per_force - hd.DIPOLE.subs(x, alpha * a)) == 0


def fast(expression):
    """With l_q^2 = q^2 + alpha^2."""
    return sp.simplify(expression.subs(hd.decay, sp.sqrt(hd.q**2 + alpha**2)))


@pytest.mark.parametrize("across", [False, True])
def test_the_wave_of_a_force(across):
    """No sources, no pressure but the dipole's, and at the force a jump of the stress by it."""
    z_up, q = hd.z_up, hd.q
    along, up = (each.subs({hd._W_p: 1, hd._W_v: 1}) for each in hd.below_a_force(across=across))
    assert sp.simplify(sp.I * q * along + up.diff(z_up)) == 0
    # of the gradient part, u = grad phi and p = -rho s phi
    phi = hd.below_a_force(across=across)[1].subs({hd._W_p: 1, hd._W_v: 0}).integrate(z_up)
    pressure = -mu * alpha**2 * phi
    for component, slope in ((along, sp.I * q * pressure), (up, pressure.diff(z_up))):
        rest = mu * (component.diff(z_up, 2) - q**2 * component) - slope
        assert fast(rest - mu * alpha**2 * component) == 0
    # above it the component along the force is the same, the other and its stress change sign
    stress = -pressure + 2 * mu * up.diff(z_up) if across else mu * along.diff(z_up)
    assert fast((2 * stress).subs(z_up, hd.h) / (2 * mu * alpha**2)) == 1


@pytest.mark.parametrize("across", [False, True])
def test_a_wave_stops_at_the_wall(across):
    found = hd.RETURNED_ACROSS if across else hd.RETURNED_ALONG
    closed = (hd.REFLECTED_ACROSS if across else hd.REFLECTED_ALONG).rhs
    assert sp.simplify(found + closed) == 0


@pytest.mark.parametrize(
    ("across", "terms"), [(False, (-9, 2, -1)), (True, (-18, 8, -2))], ids=["along", "across"]
)
def test_without_inertia_what_is_reflected_is_faxens(across, terms):
    """-9/16 r/h + 1/8 (r/h)^3 - 1/16 (r/h)^5, -9/8 r/h + 1/2 (r/h)^3 - 1/8 (r/h)^5: by the first
    powers of alpha of both parts of the wave, whose difference is of its square.
    """
    q, h = hd.q, hd.h
    decay = q + alpha**2 / (2 * q)
    p = (1 + alpha * a + (alpha * a) ** 2 / 3) * sp.exp(-q * h)
    v = (1 + alpha * a + (alpha * a) ** 2 / 2) * (1 - h * alpha**2 / (2 * q)) * sp.exp(-q * h)
    first = decay * p - q * v if across else q * p - decay * v
    squares = 0
    for weight, difference in ((1, first), (q**2, p - v)):
        powers = sp.expand(difference)
        assert powers.coeff(alpha, 0) == powers.coeff(alpha, 1) == 0
        squares += weight * powers.coeff(alpha, 2) ** 2
    wave = squares * 2 * q  # over l_q - q
    wave = 2 * wave if across else wave + sp.exp(-2 * q * h) / q
    G = -sp.integrate(sp.expand(q * wave), (q, 0, sp.oo)) / (8 * sp.pi * mu)
    expected = sum(n * (a / h) ** power for n, power in zip(terms, (1, 3, 5), strict=True)) / 16
    assert sp.simplify(6 * sp.pi * mu * a * G - expected) == 0


@pytest.mark.parametrize(("across", "part"), [(False, (3, 16)), (True, (3, 8))])
def test_with_inertia_alone_it_is_the_added_mass_of_ideal_flow(across, part):
    """G_s -> (3/16, 3/8) (r/h)^3 of the free one (H. Lamb, Hydrodynamics, section 137)."""
    q, h = hd.q, hd.h
    # the dipole alone comes back: vorticity decays on the way
    wave = (2 * hd.RETURNED_ACROSS if across else hd.RETURNED_ALONG).subs(hd._W_v, 0)
    ideal = sp.limit(wave.subs(hd._W_p, 1), hd.decay, sp.oo)
    G = sp.integrate(q * ideal / (4 * sp.pi), (q, 0, sp.oo)) / (2 * mu * alpha**2)
    sent = 6 * sp.pi * mu * a * (alpha * a) ** 2 / 3
    added = 6 * sp.pi * mu * a * (alpha * a) ** 2 / 9
    assert sp.simplify(-(sent**2) * G / added - sp.Rational(*part) * (a / h) ** 3) == 0
