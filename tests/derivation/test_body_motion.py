"""Motion of a body of any shape proven: momenta, orders of epsilon, drifts, the free step."""

import itertools

import pytest
import sympy as sp

from derivation import body_motion as bm
from derivation import euler_parameters as ep
from derivation import multiscale as ms
from derivation import rigid_body as rb
from derivation import symbols as sy
from derivation.equations import is_zero
from derivation.symbols import vector

e, R, w = ep.e, ep.R, ep.omega
u = bm.V[:3, :]
q = vector(sy.POSITION)
p, l = (sp.Matrix(sp.symbols(f"{name}1:4", real=True)) for name in "pl")
INERTIA = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"I{min(i, j) + 1}{max(i, j) + 1}", real=True))


def moving(expression):
    """Rate of change of an expression of q and e along the twist V."""
    return ep.along(expression, q, R * u) + ep.along(expression, e, ep.euler_rates_from_omega)


def vanishes(expression):
    return expression.applyfunc(sp.expand).is_zero_matrix


# --- with inertia --------------------------------------------------------------------------------
def test_rate_of_the_rotation_matrix():
    assert is_zero(moving(R) - R * ep.cross_matrix(w))


def test_inertial_wrench_is_the_rate_of_both_momenta():
    """P = R p and J = R l + q x P about the origin; the moment is about the centre of mass."""
    momentum = R * p
    rate = moving(momentum)
    turning = moving(R * l + q.cross(momentum)) - q.cross(rate)
    found = (R.T * rate).col_join(R.T * turning)
    assert is_zero(found - bm.momentum_rate(bm.V, p.col_join(l)))


def test_inertial_wrench_does_no_work():
    assert sp.expand(bm.V.dot(bm.MOMENTUM_RATE.rhs)) == 0


def test_body_without_added_mass_obeys_newton_and_euler():
    """N = (m w x u, w x I w): v' = F/m, and the moment of (A.14)."""
    own = sp.diag(rb.m * sp.eye(3), INERTIA)
    found = bm.kirchhoff(bm.V, own)
    assert vanishes(found[:3, :] - rb.m * w.cross(u))
    assert vanishes(found[3:, :] - w.cross(INERTIA * w))
    assert vanishes(rb.angular_momentum_rate(INERTIA, w, sp.zeros(3, 1)) - found[3:, :])


def test_closed_form_solves_A24_for_a_full_tensor():
    """With a = I^-1 (M_A - K) as unknowns, so that nothing is inverted."""
    a = sp.Matrix(sp.symbols("a1:4", real=True))
    moment = INERTIA * a + rb.K(INERTIA)
    found = ep.L.T * a / (4 * ep.norm_squared) - e * (ep.edot.T * ep.edot)[0] / ep.norm_squared
    assert is_zero(rb.I_tilde(INERTIA) * found - rb.M_tilde(INERTIA, moment))


def test_gyroscopic_moment_of_a_full_tensor():
    spin = ep.L * ep.edot
    assert vanishes(rb.K(INERTIA) - spin.cross(INERTIA * spin))


# --- the orders of epsilon -----------------------------------------------------------------------
@pytest.fixture(scope="module")
def orders():
    return bm.orders()


def test_orders_of_the_balance(orders):
    leading, first = orders
    assert vanishes(leading - (bm.R6 * bm.V_0 - bm.W_along))
    slow = bm.M * bm.V_0.diff(ms.T0) + bm.kirchhoff(bm.V_0, bm.M)
    assert vanishes(first - (slow + bm.R6 * bm.V_1))


def valued(symbols, values):
    return {symbols[i, j]: values[i, j] for i in range(6) for j in range(i, 6)}


def test_expansion_solves_both_orders(orders):
    """For inertia and drag in numbers, which have exact inverses, and any wrench along T0."""
    drag = sp.Matrix(6, 6, lambda i, j: sp.Rational(1, 1 + i + j)) + 2 * sp.eye(6)
    inertia = sp.Matrix(6, 6, lambda i, j: (i + 2) * (j + 2) % 5 - 2) + 9 * sp.eye(6)
    known = valued(bm.R6, drag) | valued(bm.B, drag.inv()) | valued(bm.M, inertia)
    wrench = sp.Matrix(sp.symbols("W_1:7", real=True))
    rate = sp.Matrix(sp.symbols("Wdot_1:7", real=True))
    of_wrench = dict(zip(bm.W, wrench, strict=True))
    of_wrench |= dict(zip(bm.slow_wrench_rate, rate, strict=True))
    slow = bm.slow_twist.xreplace(of_wrench).xreplace(known)
    both = bm.first_order_twist.xreplace(of_wrench).xreplace(known)
    along = dict(zip(bm.V_0.diff(ms.T0), slow.jacobian(wrench) * rate, strict=True))
    along |= dict(zip(bm.V_1, both - slow, strict=True))
    along |= dict(zip(bm.V_0, slow, strict=True))
    along |= dict(zip(bm.W_along, wrench, strict=True))
    for order in orders:
        assert vanishes(order.xreplace(known).xreplace(along))


def test_rate_of_the_wrench_in_the_body_frame():
    """Constant force and moment of the laboratory change by -w x W in the axes of the body."""
    still = sp.zeros(3, 1)
    assert is_zero(moving(bm.W) - bm.wrench_rate(w, bm.W, still, still))
    force, moment = ms.Fdot, ms.Mdot
    assert bm.wrench_rate(still, bm.W, force, moment) == (R.T * force).col_join(R.T * moment)


def test_sphere_has_the_expansion_of_the_thesis():
    """With any principal moments of inertia, at an orientation of rational entries."""
    known = valued(bm.B, sp.diag(*[1 / rb.beta_v] * 3, *[1 / rb.beta_w] * 3))
    known |= valued(bm.M, sp.diag(*[rb.m] * 3, rb.I_AA)) | dict(
        zip(e, map(sp.Integer, (2, -1, 3, 1)), strict=True)
    )
    velocity = R.T * ms.first_order_velocity
    expected = velocity.col_join(ms.first_order_angular_velocity(rb.I_AA))
    assert vanishes(bm.first_order_twist.xreplace(known) - expected.xreplace(known))


def test_turning_axes_drop_out_of_the_torque_of_a_sphere_alone():
    rotation = bm.B[3:, 3:].subs({bm.B[i, j]: 0 for i in range(3, 6) for j in range(i + 1, 6)})
    turned = (rotation * p).cross(p)
    b1, b2, b3 = rotation.diagonal()
    expected = [p[1] * p[2] * (b2 - b3), p[2] * p[0] * (b3 - b1), p[0] * p[1] * (b1 - b2)]
    assert vanishes(turned - sp.Matrix(expected))


def test_matched_start_by_six_modes():
    """M = P^-T P^-1 and R = P^-T T^-1 P^-1: z = P^-1 (V - V_0) decays with the times in T."""
    P, T = (sp.MatrixSymbol(name, 6, 6) for name in "PT")
    inertia, drag = P.T.I * P.I, P.T.I * T.I * P.I
    by_modes = P * T * P.I
    assert (drag.I * inertia).doit() == by_modes
    # each mode is the layer of one coordinate: the slow start is off by tau z(0)
    tau, z0 = sp.symbols("tau z0", positive=True)
    x0, v0, velocity = sp.symbols("x0 v0 u", real=True)
    start = ms.MATCHED_START.rhs.subs({ms.epsilon: tau, x0: 0, v0: z0, velocity: 0})
    assert start == tau * z0
    assert bm.matched_displacement == bm.B * (bm.M * (bm.twist - bm.slow_twist))


# --- thermal motion ------------------------------------------------------------------------------
def test_drift_of_the_position():
    """The drift is zero where the coupling block is symmetric, at the centre of mobility."""
    B = bm.B
    axial = sp.Matrix([B[2, 4] - B[1, 5], B[0, 5] - B[2, 3], B[1, 3] - B[0, 4]])
    assert is_zero(bm.ito_drift(B)[:3, :] - R * axial)


def test_drift_of_the_euler_parameters():
    assert is_zero(bm.ito_drift(bm.B)[3:, :] + bm.B[3:, 3:].trace() * e / 4)


@pytest.mark.parametrize("a", range(6))
def test_fields_preserve_the_uniform_measure(a):
    """The field does not change |e|, so it has the same divergence on the poses as in (q, e)."""
    field = bm.FIELDS[:, a]
    assert sp.expand(e.dot(field[3:, :])) == 0
    assert sp.simplify(bm.divergence(field)) == 0


@pytest.mark.parametrize(("a", "b"), list(itertools.combinations(range(6), 2)))
def test_commutators_of_the_fields(a, b):
    x, y = bm.FIELDS[:, a], bm.FIELDS[:, b]
    found = y.jacobian(bm.pose) * x - x.jacobian(bm.pose) * y
    for c, factor in bm.bracket(a, b).items():
        found -= factor * bm.FIELDS[:, c]
    assert is_zero(found)


def generators():
    """X_a as 4x4 matrices: rigid motions on (x, 1)."""
    unit = sp.eye(3)
    moved = [sp.zeros(3).row_join(unit[:, i]) for i in range(3)]
    turned = [ep.cross_matrix(unit[:, i]).row_join(sp.zeros(3, 1)) for i in range(3)]
    return [each.col_join(sp.zeros(1, 4)) for each in (*moved, *turned)]


def test_ordered_products_are_the_same_products():
    X = generators()
    for word in itertools.product(range(6), repeat=3):
        total = sp.zeros(4)
        for each, factor in bm.ordered(word).items():
            assert list(each) == sorted(each)
            total += factor * sp.prod([X[a] for a in each])
        assert total == X[word[0]] * X[word[1]] * X[word[2]]


def test_corrected_step_has_no_error_of_second_order():
    """In all representations and for all 21 entries: fields of orders 1, 3 and 4 cancel, too."""
    C = bm.free_step_correction(bm.B)
    left = dict(bm.step_difference(bm.B))
    for a, b in itertools.product(range(6), repeat=2):
        for word, factor in bm.ordered((a, b)).items():
            left[word] = left.get(word, 0) + factor * C[a, b]
    assert {sp.expand(each) for each in left.values()} == {0}


def test_correction_of_a_turn_about_principal_axes():
    D = sp.symbols("D1:4", positive=True)
    C = bm.free_step_correction(sp.diag(0, 0, 0, *D))
    for i in range(3):
        one, two, three = D[i], D[i - 2], D[i - 1]
        # variance 2 D h + 2 C h^2
        expected = two * three - sp.Rational(2, 3) * one * (two + three)
        assert sp.expand(2 * C[3 + i, 3 + i] - expected) == 0
    sphere = C.subs(dict.fromkeys(D, D[0]))
    assert sphere == sp.diag(0, 0, 0, *[-(D[0] ** 2) / 6] * 3)


def test_correction_by_structure_constants():
    """C = -sym(Q)/6 with T_aed = B_ac B_bd f_bce, as computed at run time, for any mobility."""
    f = {
        (a, b, c): factor
        for a, b in itertools.product(range(6), repeat=2)
        for c, factor in bm.bracket(a, b).items()
    }
    B, Q = bm.B, sp.zeros(6)
    T = {}
    for a, d in itertools.product(range(6), repeat=2):
        for (b, c, n), factor in f.items():
            T[a, n, d] = T.get((a, n, d), 0) + factor * B[a, c] * B[b, d]
    for (a, n, d), value in T.items():
        for p_ in range(6):
            for first, second, row, column, weight in (
                (n, d, a, p_, 1.5), (a, d, p_, n, 1.5), (a, n, d, p_, 1.5), (d, n, a, p_, 1),
            ):  # fmt: skip
                left, right = (p_, column) if row == p_ else (row, p_)
                factor = f.get((first, second, p_), 0)
                Q[left, right] += sp.Rational(weight) * factor * value
    assert vanishes(bm.free_step_correction(B) + (Q + Q.T) / 12)


def test_corrected_step_on_pairs_of_points():
    """Against matrices alone, for second moments: <(xi X)^4>/24 and C with rational entries."""
    root = sp.Matrix(6, 6, lambda i, j: sp.Rational((3 * i + 5 * j) % 7 - 3, 2))
    B = root * root.T
    one = sp.eye(4)
    X = [sp.kronecker_product(x, one) + sp.kronecker_product(one, x) for x in generators()]
    C = bm.free_step_correction(B)
    pairs = [[X[a] * X[b] for b in range(6)] for a in range(6)]
    total = sp.zeros(16)
    for a, b in itertools.product(range(6), repeat=2):
        total += C[a, b] * pairs[a][b]
    free = sp.zeros(16)
    for a, b in itertools.product(range(6), repeat=2):
        free += B[a, b] * pairs[a][b]
    total -= free * free / 2
    # B_ab B_cd (X_a X_b X_c X_d + X_a X_c X_b X_d + X_a X_c X_d X_b)/6
    raised = [sum((B[a, b] * X[b] for b in range(6)), sp.zeros(16)) for a in range(6)]
    total += free * free / 6
    for a, c in itertools.product(range(6), repeat=2):
        inner = X[a] * X[c]
        total += inner * (raised[a] * raised[c] + raised[c] * raised[a]) / 6
    assert total == sp.zeros(16)
