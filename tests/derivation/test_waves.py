"""The waves proven: the algebra of s and J, continuity, energy, and the summands."""

import itertools

import pytest
import sympy as sp

from derivation import symbols as sy
from derivation import waves
from derivation.equations import is_zero
from derivation.waves import Pair, direction, l, pair

# --- the direction between harmonics -------------------------------------------------------------
# n - m and n + m, far enough from 0 for all that two steps reach; every root then splits
j, k = (sp.Symbol(name, nonnegative=True) + 4 for name in "jk")
N, M = (j + k) / 2, (k - j) / 2
#: c(n) at n + i
c_of = {sp.expand(N + i): sp.Symbol(f"c_{i}", positive=True) for i in range(-2, 4)}


def by_direction(component, by_n, n, m):
    """Elements to (n + by_n, m + ...) from (n, m)."""
    scale = l / (n * (n + 1))
    return direction(n, m, lambda degree: c_of[sp.expand(degree)], scale)[component, by_n]


RISE = {"z": 0, "+": 1, "-": -1}


def s(component, state):
    """A component of s on a sum of harmonics {(by_n, by_m): factor}."""
    result = {}
    for (by_n, by_m), factor in state.items():
        for step in (-1, 0, 1):
            to = (by_n + step, by_m + RISE[component])
            element = by_direction(component, step, N + by_n, M + by_m)
            result[to] = result.get(to, 0) + factor * element
    return result


def J(component, state):
    """A component of J likewise."""
    result = {}
    for (by_n, by_m), factor in state.items():
        below, over = j + by_n - by_m, k + by_n + by_m
        element = {
            "z": M + by_m, "+": sp.sqrt(below * (over + 1)), "-": sp.sqrt(over * (below + 1)),
        }[component]  # fmt: skip
        result[by_n, by_m + RISE[component]] = factor * element
    return result


def combined(*terms):
    """Sum of factor * state over (factor, state), as what does not vanish."""
    result = {}
    for factor, state in terms:
        for place, value in state.items():
            result[place] = result.get(place, 0) + factor * value
    solved = {symbol**2: waves.between_scale_squared(degree) for degree, symbol in c_of.items()}
    reduced = {place: sp.factor(sp.expand(value).subs(solved)) for place, value in result.items()}
    return {place: value for place, value in reduced.items() if value != 0}


START = {(0, 0): sp.Integer(1)}


@pytest.mark.parametrize(
    ("of_J", "of_s", "factor", "gives"),
    [
        ("z", "z", 0, "z"), ("z", "+", 1, "+"), ("z", "-", -1, "-"),
        ("+", "z", -1, "+"), ("+", "+", 0, "z"), ("+", "-", 2, "z"),
        ("-", "z", 1, "-"), ("-", "+", -2, "z"), ("-", "-", 0, "z"),
    ],
)  # fmt: skip
def test_direction_is_a_vector(of_J, of_s, factor, gives):
    """[J_i, s_j] = i eps_ijk s_k, for every n, m and l."""
    left = ((1, J(of_J, s(of_s, START))), (-1, s(of_s, J(of_J, START))))
    assert not combined(*left, (-factor, s(gives, START)))


@pytest.mark.parametrize(("one", "other"), [("z", "+"), ("z", "-"), ("+", "-")])
def test_components_of_the_direction_commute(one, other):
    assert not combined((1, s(one, s(other, START))), (-1, s(other, s(one, START))))


def test_direction_has_length_1_and_the_helicity_along_J():
    half = sp.Rational(1, 2)
    pairs = (("z", "z", 1), ("+", "-", half), ("-", "+", half))
    length = [(factor, s(one, s(other, START))) for one, other, factor in pairs]
    helicity = [(factor, s(one, J(other, START))) for one, other, factor in pairs]
    assert combined(*length) == {(0, 0): 1}
    assert combined(*helicity) == {(0, 0): l}


def f(n, m, helicity):
    """The harmonic where cos(theta) = 4/5, times sqrt(4 pi): by Rodrigues' formula."""
    if n < max(1, abs(m)):
        return 0
    u = sp.Symbol("u")
    cos, sin = sp.Rational(4, 5), sp.Rational(3, 5)
    legendre = ((u**2 - 1) ** n).diff(u, n + m) / (2**n * sp.factorial(n))
    value, slope = legendre.subs(u, cos), legendre.diff(u).subs(u, cos)
    Y, over_theta = sin**m * value, m * sin ** (m - 1) * cos * value - sin ** (m + 1) * slope
    norm = sp.Integer(2 * n + 1) * sp.factorial(n - m) / sp.factorial(n + m)
    return (-1) ** abs(m) * sp.sqrt(norm / (n * (n + 1))) * (over_theta + helicity * m * Y / sin)


@pytest.mark.parametrize(("n", "m"), [(1, 0), (1, 1), (2, -1), (3, 2)])
def test_harmonics_mirror_and_obey_the_recurrence(n, m):
    """f^-_nm = (-1)^m f^+_n,-m, and cos(theta) f_n by the elements of s_z."""
    assert f(n, m, -1) == (-1) ** abs(m) * f(n, -m, 1)
    at = {waves.m: m, l: 1}
    along, above = (waves.along_squared.subs(at).subs(waves.n, degree) for degree in (n, n + 1))
    neighbours = sp.sqrt(along) * f(n - 1, m, 1) + sp.sqrt(above) * f(n + 1, m, 1)
    here = waves.within.subs(at).subs(waves.n, n) * f(n, m, 1)
    assert sp.sqrtdenest(sp.Rational(4, 5) * f(n, m, 1) - neighbours - here) == 0


# --- the sphere --------------------------------------------------------------------------------
x, size, index = sp.Symbol("x", positive=True), waves.n, waves.index
WRONSKIAN = {waves.dchi: (1 + waves.dpsi * waves.chi) / waves.psi}


def reduced(slope, value, at):
    """z f'/f - (n+1)."""
    return at * slope / value - (waves.n + 1)


def test_mie_coefficients_are_the_printed_ones():
    """Bohren and Huffman (4.53), with xi = psi - i chi."""
    psi, dpsi, inside, dinside = waves.psi, waves.dpsi, waves.psi_inside, waves.dpsi_inside
    xi, dxi = psi - sp.I * waves.chi, dpsi - sp.I * waves.dchi
    a = (index * inside * dpsi - psi * dinside) / (index * inside * dxi - xi * dinside)
    b = (inside * dpsi - index * psi * dinside) / (inside * dxi - index * xi * dinside)
    assert is_zero(waves.MIE_ELECTRIC.rhs - a)
    assert is_zero(waves.MIE_MAGNETIC.rhs - b)


@pytest.mark.parametrize("electric", [True, False], ids=["electric", "magnetic"])
def test_emitted_coefficient_is_the_solution_of_continuity(electric):
    g = reduced(waves.dpsi_inside, waves.psi_inside, index * x)
    if electric:
        across = waves.electric_across.subs(
            {waves.inner_index: index, waves.index: 1}, simultaneous=True
        )
        g = across.subs(waves.g, g)
    P, Q = waves.reflected.subs(
        {
            waves.g: g,
            waves.g_psi: reduced(waves.dpsi, waves.psi, x),
            waves.g_chi: reduced(waves.dchi, waves.chi, x),
            waves.ratio: waves.psi / waves.chi,
        }
    )
    difference = P / (P - sp.I * Q) - waves.mie_coefficient(electric=electric)
    assert is_zero(difference.subs(WRONSKIAN))


@pytest.mark.parametrize("electric", [True, False], ids=["electric", "magnetic"])
def test_layer_is_the_transfer_from_surface_to_surface(electric):
    """Value and slope across the inner surface, two solutions through the layer."""
    value, slope, inner_size = sp.symbols("f f' x_1")
    inner, outer = sp.symbols("m_1 m_2")
    at_inner = sp.symbols("p dp q dq")
    at_outer = sp.symbols("P dP Q dQ")
    by_psi, by_chi = sp.symbols("alpha beta")
    crossed = (value * inner / outer, slope) if electric else (value, slope * inner / outer)
    p, dp, q, dq = at_inner
    factors = sp.solve(
        (by_psi * p + by_chi * q - crossed[0], by_psi * dp + by_chi * dq - crossed[1]),
        (by_psi, by_chi),
    )
    P, dP, Q, dQ = at_outer
    expected = reduced(by_psi * dP + by_chi * dQ, by_psi * P + by_chi * Q, outer * x).subs(factors)
    g = reduced(slope, value, inner * inner_size)
    if electric:
        g = waves.electric_across.subs(
            {waves.g: g, waves.inner_index: inner, waves.index: outer}, simultaneous=True
        )
    begin, end = outer * inner_size, outer * x
    found = waves.layer.subs(
        {
            waves.g: g,
            waves.g_psi_in: reduced(dp, p, begin),
            waves.g_chi_in: reduced(dq, q, begin),
            waves.g_psi_out: reduced(dP, P, end),
            waves.g_chi_out: reduced(dQ, Q, end),
            waves.ratio: (p / q) / (P / Q),
        },
        simultaneous=True,
    )
    assert is_zero(found - expected)


def test_a_lossless_sphere_gives_back_all_light():
    """|1 - 2 a_n| = 1 for real P and Q; and nothing is reflected at equal indices."""
    P, Q = sp.symbols("P Q", real=True)
    kept = 1 - 2 * P / (P - sp.I * Q)
    assert sp.simplify(kept * kept.conjugate()) == 1
    assert waves.reflected[0].subs(waves.g, waves.g_psi) == 0
    assert waves.electric_across.subs(waves.inner_index, waves.index) == waves.g


def test_recurrence_of_the_reduced_derivative():
    """That of degree n-1 is -z^2/(2 n + 1 + that of n), from psi_n' = psi_(n-1) - n psi_n/z."""
    z, n, value, before = sp.symbols("z n psi_n psi_n-1")
    g = z * (before - n * value / z) / value - (n + 1)
    g_before = z * (n * before / z - value) / before - n
    assert is_zero(g_before + z**2 / (2 * n + 1 + g))


def test_a_small_sphere_is_the_dipole_of_clausius_and_mossotti():
    """a_1 goes to -i (2/3) x^3 (m^2-1)/(m^2+2), and b_1 to -i x^5 (m^2-1)/45."""
    z = sp.Symbol("z", positive=True)
    # sin(z)/z - cos(z) and cos(z)/z + sin(z)
    psi = z**2 / 3 - z**4 / 30 + z**6 / 840
    chi = 1 / z + z / 2 - z**3 / 8
    at_x = {waves.psi: psi, waves.dpsi: psi.diff(z), waves.chi: chi, waves.dchi: chi.diff(z)}
    values = {name: value.subs(z, x) for name, value in at_x.items()}
    values |= {waves.psi_inside: psi.subs(z, index * x)}
    values |= {waves.dpsi_inside: psi.diff(z).subs(z, index * x)}

    def leading(expression):
        return sp.expand(expression.subs(values)).as_leading_term(x)

    for electric, limit in (
        (True, sp.Rational(2, 3) * x**3 * (index**2 - 1) / (index**2 + 2)),
        (False, x**5 * (index**2 - 1) / 45),
    ):
        over, under = sp.fraction(waves.mie_coefficient(electric=electric))
        assert is_zero(leading(over) / leading(under) + sp.I * limit)


# --- the sums ----------------------------------------------------------------------------------
def complex_symbols(names):
    return sp.symbols(names, complex=True)


a, b, a_above, b_above = complex_symbols("a b a_above b_above")


def change_of(first, second):
    """(1 - 2 c)* (1 - 2 d) - 1: one weight."""
    return (1 - 2 * first.conjugate()) * (1 - 2 * second) - 1


def test_weights_follow_from_the_momentum_of_the_light():
    """<q|s|q> - <p|s|p>, q = S p, between n+1 and n and within n, in helicity and in its halves."""
    P, P_above = (sp.Matrix(complex_symbols(names)) for names in ("p_+ p_-", "r_+ r_-"))
    by_helicity = sp.diag(1, -1)

    def scattering(a, b):
        keeps, turns = 1 - a - b, b - a
        return sp.Matrix([[keeps, turns], [turns, keeps]])

    S, S_above = scattering(a, b), scattering(a_above, b_above)
    between = (S_above * P_above).H * (S * P) - P_above.H * P
    within = (S * P).H * by_helicity * (S * P) - P.H * by_helicity * P
    power = (S * P).H * (S * P) - P.H * P
    halves = sp.Matrix([[1, 1], [1, -1]]) / sp.sqrt(2)
    E, E_above = halves * P, halves * P_above
    electric, magnetic = change_of(a_above, a), change_of(b_above, b)
    expected = E_above[0].conjugate() * electric * E[0] + E_above[1].conjugate() * magnetic * E[1]
    assert sp.expand(between[0] - expected) == 0
    V = change_of(a, b)
    exchanged = E[0].conjugate() * V * E[1]
    assert sp.expand(within[0] - exchanged - exchanged.conjugate()) == 0
    K_e, K_m = change_of(a, a), change_of(b, b)
    expected = E[0].conjugate() * K_e * E[0] + E[1].conjugate() * K_m * E[1]
    assert sp.expand(power[0] - expected) == 0
    # light of helicity +1: the means of both
    alone = {P[1]: 0, P_above[1]: 0}
    mean = P_above[0].conjugate() * P[0] * (electric + magnetic) / 2
    assert sp.expand(between[0].subs(alone) - mean) == 0
    assert sp.expand(within[0].subs(alone) - P[0].conjugate() * P[0] * (V + V.conjugate()) / 2) == 0
    assert sp.expand(power[0].subs(alone) - P[0].conjugate() * P[0] * (K_e + K_m) / 2) == 0


def lateral(plus, minus):
    """x and y from + and -."""
    return (plus + minus) / 2, (plus - minus) / (2 * sp.I)


def inner(one, other):
    return one.conjugate() * other


def directed(before, within, above, component):
    """A component of s, of weights 1, U and V, on P, at (n, m); i^m taken out of the amplitudes."""
    e = {"z": (waves.al, waves.be, waves.al_above),
         "+": (waves.e1_down, waves.e0_down, waves.em_down),
         "-": (waves.em, waves.e0, waves.e1)}[component]  # fmt: skip
    P = {"z": (waves.before, waves.partner, waves.above),
         "+": (waves.down_before, waves.partner_down, waves.down_above),
         "-": (waves.up_before, waves.partner_up, waves.up_above)}[component]  # fmt: skip
    phase = {"z": 1, "+": -sp.I, "-": sp.I}[component]
    weighted = zip(e, (before, within, above), P, strict=True)
    return phase * sum(element * weight * p.value for element, weight, p in weighted)


def vector_of(before, within, above):
    plus, minus, z = (directed(before, within, above, component) for component in "+-z")
    return (*lateral(plus, minus), z)


def vanishes(expression):
    return sp.expand(expression) == 0


def twice_re(value):
    return value + value.conjugate()


def expanded(outputs, parts):
    for quantity, value in reversed(parts):
        outputs = outputs.subs(quantity.symbol, value)
    return outputs.xreplace({sp.Float(0.5): sp.Rational(1, 2)})


def test_summands_of_force_and_gradient():
    """-Re(P* h_i) and -2 Re(h_i* i s_j P)."""
    U, U_before, V, P = (each.value for each in (waves.U, waves.U_before, waves.V, waves.P))
    h, v = vector_of(U_before, V, U.conjugate()), vector_of(1, 1, 1)
    found = expanded(waves.FORCE_AND_GRADIENT, waves.GRADIENT_PARTS)
    for i in range(3):
        assert vanishes(2 * found[i] + twice_re(inner(P, h[i])))
    for (i, j), value in zip(itertools.product(range(3), repeat=2), found[3:], strict=True):
        assert vanishes(value + twice_re(inner(h[i], sp.I * v[j])))


def test_force_with_each_pair_once_is_the_hermitian_sum():
    """F_x + i F_y = -(sum P* h_-)*, where what is within n is moved to its partner."""
    found = expanded(waves.FORCE, waves.FORCE_PARTS)
    P, U, U_before, V = (each.value for each in (waves.P, waves.U, waves.U_before, waves.V))
    up_before, up, up_above = (each.value for each in (waves.up_before, waves.up, waves.up_above))
    partner = waves.partner.value
    minus = sp.I * (
        inner(P, waves.e1 * U.conjugate() * up_above + waves.em * U_before * up_before)
        + inner(partner, waves.e0 * V.conjugate() * up)
    )
    assert vanishes(found[0] + sp.I * found[1] + minus.conjugate())
    z = 2 * waves.al_above * U.conjugate() * waves.above.value + waves.be * V * partner
    assert vanishes(2 * found[2] + twice_re(inner(P, z)))


def test_summands_of_the_moment():
    """-K (<P|J_i|P>), -K |P|^2, and -2 Re(<K J_i P|i s_j P>)."""
    P, up, down = waves.P.value, waves.up.value, waves.down.value
    K, m = waves.K, waves.m
    x, y, z, absorbed = waves.MOMENT
    from_below = -sp.I * inner(up, waves.lift * P)  # <n m+1|J_+|n m>
    assert vanishes(x + sp.I * y + K * from_below)
    assert vanishes(z + K * m * inner(P, P))
    assert vanishes(absorbed + K * inner(P, P))
    turned = (
        *lateral(-sp.I * K * waves.lift_down * down, sp.I * K * waves.lift * up), K * m * P,
    )  # fmt: skip
    v = vector_of(1, 1, 1)
    found = expanded(waves.MOMENT_GRADIENT, waves.MOMENT_GRADIENT_PARTS)
    for (i, j), value in zip(itertools.product(range(3), repeat=2), found, strict=True):
        assert vanishes(value + twice_re(inner(turned[i], sp.I * v[j])))


def test_parts_multiply_as_complex_numbers():
    first, second = pair(sy.AMPLITUDE), pair(sy.ABOVE)
    assert isinstance(first * second, Pair)
    assert vanishes((first * second).value - first.value * second.value)


def test_radiation_pressure_of_a_plane_wave_is_debyes():
    """Amplitudes of a plane wave: p_n1 of the square pi (2 n + 1). x^2 Q_pr/2 of (4.61), (4.62)."""
    n = sp.Symbol("n", positive=True)
    squares = {waves.n: n + 1, waves.m: 1, l: 1}
    product = waves.along_squared.subs(squares) * sp.pi**2 * (2 * n + 1) * (2 * n + 3)
    assert is_zero(product - (sp.pi * n * (n + 2) / (n + 1)) ** 2)
    al_pp, be_pp = sp.pi * n * (n + 2) / (n + 1), sp.pi * (2 * n + 1) / (n * (n + 1))
    assert is_zero(waves.within.subs({waves.n: n, waves.m: 1, l: 1}) * sp.pi * (2 * n + 1) - be_pp)
    # what is linear in a_n, from n with n + 1, n - 1 with n, and within n: extinction
    linear = 2 * al_pp + 2 * al_pp.subs(n, n - 1) + 2 * be_pp
    assert is_zero(linear - 2 * sp.pi * (2 * n + 1))
    # what is quadratic, -(U, V less their linear parts): g Q_sca
    U = (change_of(a_above, a) + change_of(b_above, b)) / 2
    V = (change_of(a, b) + change_of(b, a)) / 2
    whole = -al_pp * (U + U.conjugate()) - be_pp * V
    asymmetry = n * (n + 2) / (n + 1) * (inner(a, a_above) + inner(b, b_above)) + (2 * n + 1) / (
        n * (n + 1)
    ) * inner(a, b)
    extinction = al_pp * (a + b + a_above + b_above) + be_pp * (a + b)
    difference = extinction - 2 * sp.pi * asymmetry
    assert is_zero(sp.expand(whole - difference - difference.conjugate()))


# --- a plane face ---------------------------------------------------------------------------------
def test_power_behind_the_face_is_what_fresnel_lets_through():
    """Continuous fields give t; power behind and reflected power make 1; n sin(theta) is kept."""
    n1, n2, cos1, cos2 = waves.n1, waves.n2, waves.cos1, waves.cos2
    r, t = sp.symbols("r t")
    fields = {
        # E across and H along the face; in the plane of incidence H and E
        "s": (1 + r - t, n1 * cos1 * (1 - r) - n2 * cos2 * t),
        "p": (n1 * (1 + r) - n2 * t, cos1 * (1 - r) - cos2 * t),
    }
    # n1^2 cos1 dOmega1 = n2^2 cos2 dOmega2
    theta1, theta2 = sp.symbols("theta1 theta2", positive=True)
    snell = n1 * sp.sin(theta1) - n2 * sp.sin(theta2)
    slope = -snell.diff(theta1) / snell.diff(theta2)
    kept = n1**2 * sp.cos(theta1) * sp.sin(theta1) - n2**2 * sp.cos(theta2) * sp.sin(theta2) * slope
    assert is_zero(kept.subs(n1, n2 * sp.sin(theta2) / sp.sin(theta1)))
    solid_angles = n2**2 * cos2 / (n1**2 * cos1)
    for name, amplitude in zip("ps", waves.COVER_AMPLITUDES, strict=True):
        solved = sp.solve(fields[name], (r, t))
        through = sp.powsimp(amplitude**2) / solid_angles
        assert is_zero(solved[r] ** 2 + through - 1)
        assert is_zero(through - n2 * cos2 / (n1 * cos1) * solved[t] ** 2)
