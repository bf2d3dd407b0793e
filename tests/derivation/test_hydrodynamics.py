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
