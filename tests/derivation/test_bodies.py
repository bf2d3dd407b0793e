"""Light on a body proven: generators, rotations, the surface integrals, their limits, translations.

Numbers appear in one test alone, which compares a displaced sphere with its surface integrals.
"""

import itertools
from functools import cache

import numpy as np
import pytest
import sympy as sp
from scipy.linalg import expm
from scipy.special import sph_harm_y, spherical_jn, spherical_yn

from derivation import bodies, waves
from derivation import symbols as sy
from derivation.bodies import INNER, SURFACE, TEST, cross, curl
from derivation.equations import is_zero
from derivation.waves import Pair

# --- the sums ----------------------------------------------------------------------------------
I = sp.I


def hermitian(name):
    real = sp.symbols(f"{name}_1 {name}_2", real=True)
    above = sp.Symbol(f"{name}_12", complex=True)
    return sp.Matrix([[real[0], above], [sp.conjugate(above), real[1]]])


def column(name):
    return sp.Matrix(sp.symbols(f"{name}_1 {name}_2", complex=True))


def bracket(left, operator, right):
    return (left.H * operator * right)[0]


def twice_re(value):
    return value + sp.conjugate(value)


def vanishes(value):
    return sp.expand(value) == 0


def exact(value):
    return value.xreplace({sp.Float(0.5): sp.Rational(1, 2)})


A, B = hermitian("A"), hermitian("B")
p, change = column("p"), sp.Matrix(2, 2, sp.symbols("T_11 T_12 T_21 T_22", complex=True))
t = change * p
q = p + t


def test_force_is_the_change_of_momentum():
    """<q|A|q> - <p|A|p> = Re<t|A|2p+t>, for any A that is Hermitian."""
    gained = bracket(q, A, q) - bracket(p, A, p)
    assert vanishes(2 * gained - twice_re(bracket(t, A, 2 * p + t)))


def test_derivative_by_a_generator():
    """p turns to exp(i x B) p: the derivative of -Re<t|A|2p+t> at x = 0, and what is emitted."""
    dp = I * B * p
    dt = change * dp
    by_definition = bracket(dt, A, 2 * p + t) + bracket(t, A, 2 * dp + dt)
    returned = A * t + change.H * A * q
    closed = 2 * bracket(returned, sp.eye(2), I * B * p)
    assert vanishes(twice_re(by_definition - closed))


def expanded(outputs, parts):
    for quantity, value in reversed(parts):
        outputs = outputs.subs(quantity.symbol, value)
    return exact(outputs)


def inner(one, other):
    return sp.conjugate(one) * other


def test_emitted_derivative_is_the_closed_one():
    """2 Im(h* B p)."""
    h = waves.pair(sy.RETURNED).value
    found = expanded(bodies.DERIVATIVE, bodies.DERIVATIVE_PARTS)
    for rate, names in zip(found, sy.GENERATED, strict=True):
        assert vanishes(rate + twice_re(inner(h, I * waves.pair(names).value)))


def cartesian(plus, minus, along):
    return (plus + minus) / 2, (plus - minus) / (2 * I), along


def value(names):
    """A symbol, or a complex number of two."""
    return waves.pair(names).value if isinstance(names, tuple) else names.symbol


def test_components_of_the_direction_and_the_angular_momentum():
    """Each element <n m|a|n' m'> times the amplitude at (n', m'); within n, the partner's."""
    raised = {  # of s_+, to m from m - 1
        sy.RAISED_DOWN: sy.DOWN_BEFORE, sy.TURNED_DOWN: sy.PARTNER_DOWN,
        sy.LOWERED_DOWN: sy.DOWN_ABOVE,
    }  # fmt: skip
    lowered = {  # of s_-, the adjoint: <n m|s_-|n' m+1> = <n' m+1|s_+|n m>
        sy.RAISED: sy.UP_ABOVE, sy.TURNED: sy.PARTNER_UP, sy.LOWERED: sy.UP_BEFORE,
    }  # fmt: skip
    along = {sy.ALONG: sy.BEFORE, sy.WITHIN: sy.PARTNER, sy.ALONG_ABOVE: sy.ABOVE}
    turned = ({sy.LIFT_DOWN: sy.DOWN}, {sy.LIFT: sy.UP}, {sy.ORDER: sy.AMPLITUDE})
    found = (*bodies.DIRECTED, *bodies.TURNED)
    for component, terms in zip(found, (raised, lowered, along, *turned), strict=True):
        expected = sum(value(element) * value(at) for element, at in terms.items())
        assert vanishes(component.value - expected)


@pytest.mark.parametrize(
    ("outputs", "parts", "components"),
    [
        (bodies.FORCE, bodies.FORCE_PARTS, bodies.DIRECTED),
        (bodies.TORQUE, bodies.TORQUE_PARTS, bodies.TURNED),
    ],
    ids=["force", "torque"],
)
def test_summands(outputs, parts, components):
    """-Re(t* a_i) of a_x = (a_+ + a_-)/2, a_y = (a_+ - a_-)/2i and a_z, and -Re(t* v)."""
    expected = [*cartesian(*(each.value for each in components)), bodies.v.value]
    for summand, operator in zip(expanded(outputs, parts), expected, strict=False):
        assert vanishes(2 * summand + twice_re(inner(bodies.t.value, operator)))


def test_generators_are_the_cartesian_components():
    expected = (
        *cartesian(*(each.value for each in bodies.DIRECTED)),
        *cartesian(*(each.value for each in bodies.TURNED)),
    )
    found = expanded(bodies.parts(bodies.GENERATORS), bodies.GENERATORS_PARTS)
    for at, component in enumerate(expected):
        assert vanishes(Pair(*found[2 * at : 2 * at + 2]).value - component)


# --- rotations ---------------------------------------------------------------------------------
#: exp(i beta/2): every d is a polynomial in it and its inverse
e = sp.Symbol("e")
COSINE, SINE = (e + 1 / e) / 2, (e - 1 / e) / (2 * I)


def orders(n):
    return range(-n, n + 1)


def same(one, other):
    """Whether two matrices of Laurent polynomials in e are equal."""
    return (one - other).applyfunc(sp.expand).is_zero_matrix


@cache
def d(n):
    return bodies.rotation(n, COSINE, SINE).applyfunc(sp.expand)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_rotation_is_generated_by_the_angular_momentum(n):
    """D' over beta, alpha and gamma: -i J_y d, and the turned axes of D = exp d exp."""
    J_x, J_y, J_z = bodies.angular_momentum(n)
    by_beta = d(n).applyfunc(lambda each: I * e / 2 * sp.diff(each, e))
    assert same(by_beta, -I * J_y * d(n))
    # a rotation about the body's axis z is one about R z = (sin(beta), 0, cos(beta)) before it
    cosine, sine = (e**2 + e**-2) / 2, (e**2 - e**-2) / (2 * I)
    assert same(d(n) * J_z, (sine * J_x + cosine * J_z) * d(n))
    # and after a rotation by alpha about z, J_y is J_y cos(alpha) - J_x sin(alpha)
    turn = sp.diag(*(e ** (-2 * m) for m in orders(n)))
    assert same(turn * J_y, (J_y * cosine - J_x * sine) * turn)
    assert same(J_x * J_y - J_y * J_x, I * J_z)


def elements(component, n_to, n_from):
    """Elements of s between harmonics of helicity +1 and two degrees, by their squares."""
    matrix = sp.zeros(2 * n_to + 1, 2 * n_from + 1)
    rise = {"z": 0, "+": 1, "-": -1}[component]
    for m in orders(n_from):
        if abs(m + rise) <= n_to:
            if component == "-":  # the adjoint of s_+
                value = elements("+", n_from, n_to)[m + n_from, m - 1 + n_to]
            else:
                value = _element(component, n_to, n_from, m)
            matrix[m + rise + n_to, m + n_from] = value
    return matrix


@cache
def _element(component, n_to, n_from, m):
    along, within, raised, turned, lowered = waves.SQUARED_ELEMENTS

    def at(value, n, order=m):
        return value.subs({waves.n: n, waves.m: order})

    if component == "z":
        return {
            -1: sp.sqrt(at(along, n_from)), 0: at(within, n_from), 1: sp.sqrt(at(along, n_to)),
        }[n_to - n_from]  # fmt: skip
    return {
        -1: sp.sqrt(at(lowered, n_from)), 0: sp.sqrt(at(turned, n_from)),
        1: -sp.sqrt(at(raised, n_from)),
    }[n_to - n_from]  # fmt: skip


NEIGHBOURS = [(i, j) for i in (1, 2, 3) for j in (1, 2, 3) if abs(i - j) <= 1]


def s_between(n_to, n_from):
    return cartesian(*(elements(component, n_to, n_from) for component in "+-z"))


@pytest.mark.parametrize(("n_to", "n_from"), NEIGHBOURS)
def test_direction_turns_as_a_vector(n_to, n_from):
    """[J_i, s_j] = i eps_ijk s_k, and d^-1 s d = R s, between the degrees to 3."""
    s = s_between(n_to, n_from)
    J_to, J_from = bodies.angular_momentum(n_to), bodies.angular_momentum(n_from)
    for i, j in itertools.product(range(3), repeat=2):
        commutator = J_to[i] * s[j] - s[j] * J_from[i]
        turned = sum((sp.LeviCivita(i, j, k) * s[k] for k in range(3)), sp.zeros(*s[0].shape))
        assert same(commutator, I * turned)
    cosine, sine = (e**2 + e**-2) / 2, (e**2 - e**-2) / (2 * I)
    expected = (cosine * s[0] + sine * s[2], s[1], cosine * s[2] - sine * s[0])
    for before, after in zip(s, expected, strict=True):
        assert same(before * d(n_from), d(n_to) * after)


def reduced(n, row, column, cosine=COSINE, sine=SINE):
    return bodies.reduced_rotation(n, row, column, cosine, sine)


@cache
def quarter(n, row, column):
    """Delta over the roots, times 2^n: an integer over a factorial."""
    return reduced(n, row, column, sp.Integer(1), sp.Integer(1)) / 2**n


@pytest.mark.parametrize("n", range(1, 7))
def test_rotation_is_two_constant_matrices_and_phases(n):
    """d = Z Delta^T E Delta Z*, Z = i^m, E = exp(-i k beta). The roots are common factors."""
    for row, column in itertools.product(orders(n), repeat=2):
        phases = sum(
            bodies.order_norm(n, k) * quarter(n, k, row) * quarter(n, k, column) * e ** (-2 * k)
            for k in orders(n)
        )
        factorised = I ** ((row - column) % 4) * phases
        assert vanishes(reduced(n, row, column) - factorised)


@pytest.mark.parametrize("n", range(1, 7))
def test_symmetries_of_the_rotation_by_a_right_angle(n):
    """Delta_{m,-k} = (-1)^(n+m) Delta_mk, Delta_{-m,k} = (-1)^(n+k) Delta_mk, and the transpose."""
    for m, k in itertools.product(orders(n), repeat=2):
        value = quarter(n, m, k)
        assert quarter(n, m, -k) == (-1) ** (n + m) * value
        assert quarter(n, -m, k) == (-1) ** (n + k) * value
        assert quarter(n, k, m) == sp.Integer(-1) ** (m + k) * value


@pytest.mark.parametrize("n", range(1, 7))
def test_rotation_is_unitary(n):
    """d d^T = 1 for every beta: d is a polynomial in tan(beta/2), times cos^(2n)."""
    tangent = sp.Symbol("tan")
    whole = sp.Poly((1 + tangent**2) ** (2 * n), tangent)
    powers = {
        (row, k): sp.Poly(reduced(n, row, k, sp.Integer(1), tangent), tangent)
        for row, k in itertools.product(orders(n), repeat=2)
    }
    for row, column in itertools.product(orders(n), repeat=2):
        product = sum(
            bodies.order_norm(n, k) * powers[row, k] * powers[column, k] for k in orders(n)
        )
        assert (product * bodies.order_norm(n, row) - int(row == column) * whole).is_zero


# --- the surface of a body ---------------------------------------------------------------------
r, theta, phi = bodies.r, bodies.theta, bodies.phi
x, x_inside, slope, index = bodies.x, bodies.x_inside, bodies.slope, bodies.index


def test_curl_and_divergence_give_the_boundary_integral():
    """div(A x C) = C.curl A - A.curl C, so A x curl B - B x curl A has none if k is the same."""
    a, c = (
        tuple(sp.Function(f"{name}_{i}")(r, theta, phi) for i in range(3)) for name in ("A", "C")
    )
    product = cross(a, c)
    sine = sp.sin(theta)
    divergence = sp.diff(r**2 * product[0], r) / r**2 + (
        sp.diff(sine * product[1], theta) + sp.diff(product[2], phi)
    ) / (r * sine)
    expected = sum(c_i * a_i for c_i, a_i in zip(c, curl(a), strict=True)) - sum(
        a_i * c_i for a_i, c_i in zip(a, curl(c), strict=True)
    )
    assert sp.simplify(divergence - expected) == 0


def test_waves_solve_maxwells_equations():
    """curl N = k M where f is a Riccati-Bessel function and y that of a harmonic."""
    k, nu, m = sp.symbols("k nu m", positive=True)
    f, y = sp.Function("f")(r), sp.Function("y")(theta)
    harmonic = y * sp.exp(I * m * phi)
    magnetic, electric = (bodies.wave(kind, f, harmonic, nu, k) for kind in "MN")
    legendre = -sp.cot(theta) * y.diff() - (nu**2 - m**2 / sp.sin(theta) ** 2) * y
    bessel = (nu**2 / r**2 - k**2) * f

    def reduced_by_the_equations(value):
        value = value.doit().subs(y.diff(theta, 3), legendre.diff(theta))
        for old, new in (
            (y.diff(theta, 2), legendre), (f.diff(r, 2), bessel), (y.diff(theta, 2), legendre),
        ):  # fmt: skip
            value = value.subs(old, new).doit()
        return sp.simplify(value)

    for found, expected in zip(curl(electric), magnetic, strict=True):
        assert reduced_by_the_equations(found - k * expected) == 0


def test_surface_integrands_are_the_printed_ones():
    """The factors -1 and i are taken out at run time."""
    zeta, zeta_slope, y, tau, pi, nu = TEST
    psi, psi_slope, y_1, tau_1, pi_1, nu_1 = INNER
    mixed, equal = pi_1 * tau + tau_1 * pi, pi * pi_1 + tau * tau_1
    along, along_inside = slope * nu * y * zeta / x, slope * nu_1 * y_1 * psi / x_inside
    printed = {
        ("M", "M"): I * zeta * psi * mixed,
        ("N", "N"): I
        * (
            zeta_slope * psi_slope * mixed
            + along * psi_slope * pi_1
            + zeta_slope * pi * along_inside
        ),
        ("N", "M"): -(zeta_slope * psi * equal + along * psi * tau_1),
        ("M", "N"): zeta * psi_slope * equal + zeta * tau * along_inside,
    }
    for kinds, value in printed.items():
        assert vanishes(SURFACE[kinds] - value)


def polar(n, m):
    """y, tau, pi over the norm of the harmonic: (polar part, y'/nu, m y/(nu sin)), and the norm."""
    u = sp.Symbol("u")
    legendre = (((u**2 - 1) ** n).diff(u, n + m) / (2**n * sp.factorial(n))).factor()
    y = sp.sin(theta) ** m * legendre.subs(u, sp.cos(theta))
    nu = sp.sqrt(n * (n + 1))
    norm = sp.sqrt(sp.Rational(2 * n + 1) / (4 * sp.pi) * sp.factorial(n - m) / sp.factorial(n + m))
    return y, sp.diff(y, theta) / nu, m * y / (nu * sp.sin(theta)), nu, norm


def over_surface(value):
    """2 pi times the integral over u = cos(theta) of even powers of the sine and powers of u."""
    u = sp.Symbol("u")
    value = sp.expand(sp.expand_trig(value))
    value = sp.expand(value.subs(sp.sin(theta), sp.sqrt(1 - u**2)).subs(sp.cos(theta), u))
    return 2 * sp.pi * sp.integrate(sp.simplify(value), (u, -1, 1))


PAIRS_OF_DEGREES = [
    (n, n_1, m) for m in (0, 1, 2) for n, n_1 in itertools.product(range(max(1, m), 4), repeat=2)
]


@pytest.mark.parametrize(("n", "n_1", "m"), PAIRS_OF_DEGREES)
def test_harmonics_are_orthonormal_on_a_sphere(n, n_1, m):
    """2 pi int (pi pi' + tau tau') du = 1 where n = n', and pi tau' + tau pi' integrates to 0."""
    _, tau, pi, _, norm = polar(n, m)
    _, tau_1, pi_1, _, norm_1 = polar(n_1, m)
    assert over_surface(norm * norm_1 * (pi * pi_1 + tau * tau_1)) == int(n == n_1)
    assert over_surface(norm * norm_1 * (pi * tau_1 + tau * pi_1)) == 0


@pytest.mark.parametrize(("kind", "electric"), [("N", True), ("M", False)])
def test_sphere_has_the_mie_coefficients(kind, electric):
    """r' = 0, and the integrals over angles of the test before; chi_n is minus Mie's."""
    angular = {TEST.pi: 1, INNER.pi: 1, TEST.tau: 0, INNER.tau: 0, slope: 0}
    inside = {INNER.radial: waves.psi_inside, INNER.radial_slope: waves.dpsi_inside}

    def q_matrix(zeta, zeta_slope):
        of = {TEST.radial: zeta, TEST.radial_slope: zeta_slope}
        return bodies.BOUNDARY[kind, kind].subs(angular | inside).subs(of)

    regular = q_matrix(waves.psi, waves.dpsi)
    outgoing = q_matrix(waves.psi - I * waves.chi, waves.dpsi - I * waves.dchi)
    mie = waves.mie_coefficient(electric=electric).subs(waves.index, index)
    assert is_zero(-regular / outgoing + mie)
    other = bodies.BOUNDARY[kind, "MN"[kind == "M"]].subs({slope: 0})
    assert is_zero(other.subs({TEST.tau: -TEST.pi, INNER.tau: INNER.pi}))


# --- small spheroids -----------------------------------------------------------------------------
#: 1 - a^2/c^2 of the semi-axes a across and c along; r = a (1 - flat u^2)^(-1/2)
flat = sp.Symbol("h", positive=True)
U = sp.Symbol("u", real=True)
SPHEROID = 1 - flat * U**2


def riccati(n, z, terms=3, *, regular):
    """The first terms of psi_n or chi_n = z y_n over z^power, as a series in z, and its power."""
    if regular:
        first, power, sign = 1 / sp.factorial2(2 * n + 1), n + 1, 2 * n + 3
    else:
        first, power, sign = -sp.factorial2(2 * n - 1), -n, 1 - 2 * n
    total, term = 0, first * z**power
    for i in range(terms):
        total += term
        term = term * -(z**2) / (2 * (i + 1) * (sign + 2 * i))
    return total


def spheroid_integrand(kinds, n, n_1, m, *, regular):
    """An element of BOUNDARY as a function of u, by powers of x."""
    z = sp.Symbol("z", positive=True)
    y, tau, pi, nu, _ = polar(n, m)
    y_1, tau_1, pi_1, nu_1, _ = polar(n_1, m)
    zeta, psi = riccati(n, z, regular=regular), riccati(n_1, z, regular=True)
    values = dict(
        zip(TEST, (zeta.subs(z, x), zeta.diff(z).subs(z, x), y, tau, pi, nu), strict=True)
    )
    inside = (psi.subs(z, index * x), psi.diff(z).subs(z, index * x), y_1, tau_1, pi_1, nu_1)
    values |= dict(zip(INNER, inside, strict=True))
    values |= {slope: -flat * U * sp.sqrt(1 - U**2) / SPHEROID, x_inside: index * x}
    value = bodies.BOUNDARY[kinds].subs(values, simultaneous=True)
    value = sp.expand_trig(value).subs(sp.sin(theta), sp.sqrt(1 - U**2)).subs(sp.cos(theta), U)
    over, under = sp.fraction(sp.cancel(sp.expand(value)))
    lowest = sp.degree(under, x)
    coefficient = sp.cancel(under / x**lowest)
    return {
        power - lowest: sp.cancel(each / coefficient) for (power,), each in sp.Poly(over, x).terms()
    }


# (test, inner), n, n', m: test wave of a higher degree than the inner wave
HIGHER = [
    (("N", "N"), 3, 1, 0), (("N", "N"), 3, 1, 1), (("N", "N"), 5, 1, 0), (("N", "N"), 5, 1, 1),
    (("M", "N"), 2, 1, 1), (("M", "N"), 4, 1, 1), (("N", "N"), 5, 3, 1), (("N", "M"), 3, 2, 1),
]  # fmt: skip


@pytest.mark.parametrize(("kinds", "n", "n_1", "m"), HIGHER)
def test_negative_powers_vanish_over_a_spheroid(kinds, n, n_1, m):
    """So that a small spheroid has no quadrupole in its dipole: n > n' does not couple with chi."""
    integrand = spheroid_integrand(kinds, n, n_1, m, regular=False)
    powers = [power for power in integrand if power < 0]
    assert powers
    for power in powers:
        # x^-2j is (k a)^-2j (1 - h u^2)^j
        assert power % 2 == 0
        over = sp.cancel(integrand[power] * SPHEROID ** (-power // 2))
        assert sp.expand(over) != 0
        assert sp.expand(sp.integrate(sp.expand(over), (U, -1, 1))) == 0


#: integral of du/(1 - h u^2) from 0 to 1: artanh(sqrt(h))/sqrt(h), or arctan if h < 0
ARTANH = sp.Symbol("A", positive=True)


def over_axis(value):
    """The integral over u from -1 to 1 of an even polynomial over 1 - h u^2."""
    over, under = sp.fraction(sp.cancel(sp.together(value)))
    factor = sp.cancel(under / SPHEROID)
    whole, rest = sp.div(over, SPHEROID, U)
    assert factor.is_constant(U)
    assert rest.is_constant(U)
    return sp.cancel((sp.integrate(sp.expand(whole), (U, -1, 1)) + 2 * rest * ARTANH) / factor)


def test_depolarisation_factor_of_the_axis():
    """a^2 c/2 int_0^oo ds/((s + c^2)^(3/2) (s + a^2)), by u = c/sqrt(s + c^2)."""
    c = sp.Symbol("c", positive=True)
    V = sp.Symbol("u", positive=True)
    s = c**2 / V**2 - c**2
    a_squared = (1 - flat) * c**2
    integrand = a_squared * c / 2 * -s.diff(V) * (V / c) ** 3 / (s + a_squared)
    value = over_axis(integrand.subs(V, U)) / 2
    expected = bodies.depolarisation_along.subs({bodies.artanh: ARTANH, bodies.flattening: flat})
    assert is_zero(value - expected)


@pytest.mark.parametrize("m", [0, 1], ids=["along", "across"])
def test_small_spheroid_has_the_depolarisation_factors(m):
    """T of (n, m) = (1, m): Clausius and Mossotti with L, and with (1 - L)/2 across the axis."""
    regular = spheroid_integrand(("N", "N"), 1, 1, m, regular=True)[3]
    irregular = spheroid_integrand(("N", "N"), 1, 1, m, regular=False)[0]
    # by x^3 du = (k a)^3 dv, v = u/sqrt(1 - h u^2), which ends at c/a
    v, end = sp.symbols("v c/a", positive=True)
    of_v = sp.cancel(regular.subs(U, v / sp.sqrt(1 + flat * v**2)))
    scattered = 2 * sp.integrate(of_v, (v, 0, end)).subs(flat, 1 - end**-2)
    found = -scattered / (I * over_axis(irregular)).subs(flat, 1 - end**-2)
    along = bodies.depolarisation_along.subs(
        {bodies.artanh: ARTANH, bodies.flattening: 1 - end**-2}
    )
    L = along if m == 0 else (1 - along) / 2
    expected = bodies.small_spheroid.subs({bodies.depolarisation: L, bodies.volume: end})
    assert is_zero(found - expected)
    sphere = bodies.small_spheroid.subs(bodies.depolarisation, sp.Rational(1, 3))
    expected = sp.Rational(2, 3) * I * bodies.volume * (index**2 - 1) / (index**2 + 2)
    assert is_zero(sphere - expected)


# --- translations --------------------------------------------------------------------------------
z, u = sp.Symbol("z", positive=True), sp.Symbol("u", real=True)


def bessel_series(L, highest):
    """j_L(z) to the power `highest`."""
    return sum(
        (-1) ** i * z ** (L + 2 * i) / (2**i * sp.factorial(i) * sp.factorial2(2 * (L + i) + 1))
        for i in range((highest - L) // 2 + 1)
    )


def test_rayleighs_expansion():
    """exp(i z u) = sum i^L (2 L + 1) j_L(z) P_L(u), to z^10."""
    found = sum(bodies.rayleigh_term(sp.Integer(L), u, bessel_series(L, 10)) for L in range(11))
    assert vanishes(found - sum((I * z * u) ** i / sp.factorial(i) for i in range(11)))


@pytest.mark.parametrize("L", range(5))
def test_waves_that_leave_are_displaced_by_the_same_law(L):
    """dX/dz = i u X, whatever solution z_L of the recurrences of j_L and h_L is taken."""
    here = sp.Symbol("z_L")

    def term(degree, radial):
        return bodies.rayleigh_term(sp.Integer(degree), u, radial) if degree >= 0 else 0

    # (2 L + 1) z_L' = L z_(L-1) - (L+1) z_(L+1): what of dX/dz contains z_L
    changed = term(L + 1, sp.Rational(L + 1, 2 * L + 3) * here)
    if L > 0:
        changed -= term(L - 1, sp.Rational(L, 2 * L - 1) * here)
    assert vanishes(changed - I * u * term(L, here))
    # which h_L obeys, too
    for function in (sp.jn, sp.yn):
        h_below, h_here, h_above = (sp.expand_func(function(L + i, z)) for i in (-1, 0, 1))
        slope_of = L * h_below - (L + 1) * h_above
        assert sp.simplify(slope_of - (2 * L + 1) * h_here.diff(z)) == 0


@cache
def harmonic(n, m):
    """f_nm of helicity +1, over its norm and sin(theta)^(|m| - 1), and the square of the norm."""
    legendre = ((u**2 - 1) ** n).diff(u, n + abs(m)) / (2**n * sp.factorial(n))
    # of (1-u^2)^(|m|/2) P: the derivative over theta, and m over the sine
    slope_of = abs(m) * u * legendre - (1 - u**2) * legendre.diff(u)
    sign = (-1) ** abs(m) if m > 0 else 1
    square = sp.Rational(2 * n + 1) * sp.factorial(n - abs(m)) / sp.factorial(n + abs(m))
    return sp.expand(sign * (slope_of + m * legendre)), square / (n * (n + 1))


def coupling(n_to, n_from, m, L):
    """g_L = 2 pi int f_n'm f_nm P_L du."""
    to, norm_to = harmonic(n_to, m)
    of, norm_of = harmonic(n_from, m)
    product = sp.cancel(to * of * (1 - u**2) ** (abs(m) - 1)) * sp.legendre(L, u)
    return sp.sqrt(norm_to * norm_of) * sp.integrate(sp.expand(product), (u, -1, 1)) / 2


PAIRS = [(1, 1, 0), (1, 1, 1), (2, 1, 1), (2, 1, -1), (3, 1, 1), (3, 2, 2), (2, 2, -2), (3, 3, 1)]


@pytest.mark.parametrize(("n_to", "n_from", "m"), PAIRS)
def test_coefficients_of_translations_are_few(n_to, n_from, m):
    """g_L is 0 unless |n - n'| <= L <= n + n'; g_0 is 1 or 0, as harmonics are orthonormal."""
    assert coupling(n_to, n_from, m, 0) == int(n_to == n_from)
    for L in (abs(n_to - n_from) - 1, n_to + n_from + 1, n_to + n_from + 2):
        assert L < 0 or coupling(n_to, n_from, m, L) == 0
    assert coupling(n_to, n_from, m, n_to + n_from) != 0


@pytest.mark.parametrize(("n_to", "n_from", "m"), PAIRS)
def test_translation_is_the_exponential_of_the_direction(n_to, n_from, m):
    """Powers of z to the fourth: <n'm|(i z s_z)^j|nm>/j! by the elements of s_z."""
    power = 4
    degrees = range(max(1, abs(m)), 3 + power + 1)
    s_z = sp.Matrix(
        len(degrees), len(degrees),
        lambda i, j: _element("z", degrees[i], degrees[j], m) if abs(i - j) <= 1 else 0,
    )  # fmt: skip
    vector = sp.zeros(len(degrees), 1)
    vector[degrees.index(n_from)] = 1
    expected = 0
    for j in range(power + 1):
        expected += vector[degrees.index(n_to)]
        vector = (I * z * s_z * vector / (j + 1)).applyfunc(sp.expand)
    found = sum(
        I**L * (2 * L + 1) * bessel_series(L, power) * coupling(n_to, n_from, m, L)
        for L in range(power + 1)
    )
    assert sp.simplify(sp.expand(found - expected)) == 0


@pytest.mark.parametrize(("n_to", "n_from", "m"), PAIRS)
def test_light_of_a_far_body_is_a_plane_wave(n_to, n_from, m):
    """h_L -> (-i)^(L+1) exp(iz)/z leaves sum (2 L + 1) g_L = 4 pi f_n' f_n at u = 1."""
    found = sum((2 * L + 1) * coupling(n_to, n_from, m, L) for L in range(n_to + n_from + 1))
    to, norm_to = harmonic(n_to, m)
    of, norm_of = harmonic(n_from, m)
    sines = (1 - u**2) ** (abs(m) - 1)
    at_axis = sp.sqrt(norm_to * norm_of) * sp.cancel(to * of * sines).subs(u, 1)
    assert sp.simplify(found - at_axis) == 0


# --- a displaced sphere ---------------------------------------------------------------------------
RADIUS, OFF, INDEX, HIGHEST = 1.2, 0.3, 1.2, 14


def riccati_bessel(function, n, at):
    """The function times its argument, and the derivative."""
    return at * function(n, at), function(n, at) + at * function(n, at, True)


def of_mie(degrees):
    """-2 a_n, and -2 b_n after it."""
    psi, dpsi = riccati_bessel(spherical_jn, degrees, RADIUS)
    chi, dchi = riccati_bessel(spherical_yn, degrees, RADIUS)
    inside = riccati_bessel(spherical_jn, degrees, INDEX * RADIUS)
    arguments = (
        waves.psi, waves.dpsi, waves.chi, waves.dchi, waves.psi_inside, waves.dpsi_inside,
        waves.index,
    )  # fmt: skip
    return -2 * np.concatenate([
        sp.lambdify(arguments, waves.mie_coefficient(electric=electric), cse=True)(
            psi, dpsi, -chi, -dchi, *inside, INDEX
        )
        for electric in (True, False)
    ])  # fmt: skip


def by_translation(m):
    """S - 1 of a sphere at z = OFF: exp(-i k s.d) (S_0 - 1) exp(i k s.d); electric, magnetic."""
    degrees = np.arange(max(1, abs(m)), HIGHEST + 10)
    along, within = sp.lambdify((waves.n, waves.m), waves.SQUARED_ELEMENTS[:2])(degrees * 1.0, m)
    between = np.diag(np.sqrt(along[1:]), 1)
    s_z = np.kron(np.eye(2), between + between.T) + np.kron([[0, 1], [1, 0]], np.diag(within))
    displaced = expm(1j * OFF * s_z)
    change = displaced.conj().T @ np.diag(of_mie(degrees)) @ displaced
    return change.reshape(2, len(degrees), 2, -1)


def by_surface(m):
    """T of the same sphere by the boundary integrals."""
    cosine, weight = np.polynomial.legendre.leggauss(60)
    angle, sine = np.arccos(cosine), np.sqrt(1 - cosine**2)
    root = np.sqrt(RADIUS**2 - OFF**2 * sine**2)
    x_at, rate = OFF * cosine + root, -OFF * sine - OFF**2 * sine * cosine / root
    degrees = np.arange(max(1, abs(m)), HIGHEST)[:, None]
    nu = np.sqrt(degrees * (degrees + 1.0))
    value, gradient = (each.real for each in sph_harm_y(degrees, m, angle, 0, diff_n=1))
    angular = value, gradient[..., 0] / nu, m * value / (nu * sine), nu
    inside = (*riccati_bessel(spherical_jn, degrees, INDEX * x_at), *angular)
    arguments = (*TEST, *INNER, slope, x, x_inside, index)

    def matrix(function):
        outside = (*riccati_bessel(function, degrees, x_at), *angular)
        at = (*(each[:, None] for each in outside), *inside, rate / x_at, x_at, INDEX * x_at, INDEX)
        return np.block([
            [
                (sp.lambdify(arguments, bodies.BOUNDARY[test, inner])(*at) * weight).sum(axis=-1)
                for inner in "NM"
            ]
            for test in "NM"
        ])  # fmt: skip

    regular, irregular = matrix(spherical_jn), matrix(spherical_yn)
    T = -np.linalg.solve((regular + 1j * irregular).T, regular.T).T
    return T.reshape(2, len(degrees), 2, -1), degrees[:, 0]


@pytest.mark.parametrize("m", [0, 1, -2])
def test_displaced_sphere_by_its_surface_and_by_translation(m):
    """S - 1 = 2 i^(n'-n) T, with every block of the surface integrals, for both signs of m."""
    T, degrees = by_surface(m)
    phase = 1j ** (degrees % 4)
    found = 2 * phase.conj()[:, None, None] * T * phase
    expected = by_translation(m)
    kept = 5
    np.testing.assert_allclose(
        found[:, :kept, :, :kept], expected[:, :kept, :, :kept], rtol=0, atol=1e-13
    )
    assert m == 0 or abs(expected[0, :kept, 1, :kept]).max() > 1e-3
