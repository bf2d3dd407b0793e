"""The step of drag and thermal noise: its equations hold identically, and at first order in tau."""

import pytest
import sympy as sp

from derivation import langevin as lv
from derivation.equations import is_zero

FUNCTIONS = (lv.d, lv.j, lv.l, lv.c_xx, lv.c_vv)


def closed(expression):
    """An expression of d, j, ... in the two rates and their exponentials."""
    return sp.sympify(expression).subs(lv.BY_RATES).subs(lv.CLOSED)


def test_propagator_obeys_the_equation_of_motion():
    P = lv.PROPAGATOR.rhs
    change = P.applyfunc(lambda entry: lv.over_time(closed(entry)))
    assert is_zero(change - closed(lv.A * P))


def test_covariance_obeys_lyapunovs_equation():
    S = lv.COVARIANCE.rhs
    noise = sp.Matrix([[0, 0], [0, 2 / lv.tau]])
    change = S.applyfunc(lambda entry: lv.over_time(closed(entry)))
    assert is_zero(change - closed(lv.A * S + S * lv.A.T + noise))


def test_integrals_are_integrals():
    assert is_zero(lv.over_time(lv.CLOSED[lv.j]) - lv.CLOSED[lv.d])
    assert is_zero(lv.over_time(lv.CLOSED[lv.l]) - lv.CLOSED[lv.j])


def test_all_begin_at_zero():
    start = {lv.h: 0, lv.E_slow: 1, lv.E_fast: 1}
    assert all(is_zero(lv.CLOSED[name].subs(start)) for name in FUNCTIONS)


@pytest.mark.parametrize("name", FUNCTIONS, ids=str)
def test_a_step_of_2h_from_one_of_h(name):
    assert is_zero(lv.twice(lv.CLOSED[name]) - closed(lv.DOUBLED[name]))


@pytest.mark.parametrize("name", [lv.d, lv.j], ids=str)
def test_a_step_of_2h_without_inertia(name):
    rate, E = sp.Symbol("kappa", positive=True), sp.Symbol("E", positive=True)
    d = (1 - E) / rate
    whole = {lv.d: d, lv.j: (lv.h - d) / rate}
    doubled = whole[name].subs({E: E**2, lv.h: 2 * lv.h}, simultaneous=True)
    expected = lv.DOUBLED_WITHOUT_INERTIA[name].subs(lv.kappa, rate).subs(whole)
    assert is_zero(doubled - expected)


def _order(expression):
    """The lowest power of h, once p and q are put in."""
    by_h = expression.subs({lv.p: lv.h / lv.tau, lv.q: lv.kappa * lv.h**2 / lv.tau})
    if by_h == 0:
        return sp.oo
    return min(power for (power,), _ in sp.Poly(sp.expand(by_h), lv.h).terms())


@pytest.mark.parametrize(
    ("name", "rate", "leading"),
    [
        (lv.d, lv.e_vv, 0),
        (lv.j, lv.d, 1),
        (lv.l, lv.j, 2),
        (lv.c_xx, 2 * lv.d**2 / lv.tau, 2),
        (lv.c_vv, 2 * lv.e_vv**2 / lv.tau, 0),
    ],
    ids=["d", "j", "l", "c_xx", "c_vv"],
)
def test_series_obey_the_equations_to_their_order(name, rate, leading):
    by_h = {lv.p: lv.h / lv.tau, lv.q: lv.kappa * lv.h**2 / lv.tau}
    change = sp.expand(lv.SHORT[name].subs(by_h)).diff(lv.h)
    left = sp.expand(change - sp.sympify(rate).subs(lv.SHORT).subs(by_h))
    assert _order(left) >= leading + lv.ORDER - 1


def test_flux_of_first_order_is_that_of_the_corrected_smoluchowski_equation():
    """Wilemski (1976), Titulaer (1978): J = (1 - tau u') J_0."""
    assert sp.expand(lv.FLUX_1 + lv.u.diff(lv.x) * lv.FLUX_0) == 0
    to_first_order = lv.FLUX_0 + lv.tau * lv.FLUX_1
    assert sp.expand(to_first_order - lv.SMOLUCHOWSKI.rhs) == 0


def test_no_flux_at_boltzmanns_distribution():
    potential = sp.Function("U")(lv.x)
    boltzmann = sp.exp(-potential / lv.D)
    flux = lv.SMOLUCHOWSKI.rhs.subs(lv.u, -potential.diff(lv.x)).subs(lv.density, boltzmann)
    assert sp.simplify(flux.doit()) == 0


def test_arm_of_the_thermal_torque():
    """L_C of (2.17), which the thesis leaves without a value."""
    assert sp.simplify(lv.ARM_OF_TORQUE.rhs - 2 * lv.r / sp.sqrt(3)) == 0


def test_a_step_solves_the_equation_for_a_velocity_that_rises_evenly():
    """x' = v, v' = (u_0 + a s - v)/tau - kappa x/tau, from any x and v; a h is the rise."""
    x, v, u, a = sp.symbols("x v u a", real=True)
    w = {name: closed(weight) for name, weight in lv.STEP_WEIGHTS.items()}
    rise, tau, kappa = a * lv.h, lv.BY_RATES[lv.tau], lv.BY_RATES[lv.kappa]
    X = x + w["by_v"] * v + w["by_u"] * u + w["by_rise"] * rise
    V = w["decay"] * v + w["v_by_u"] * u + w["v_by_rise"] * rise
    assert is_zero(lv.over_time(X) - V)
    slow_now = u + kappa * x + rise  # u is less kappa x at the begin
    assert is_zero(lv.over_time(V) - (slow_now - V - kappa * X) / tau)
    begin = {lv.h: 0, lv.E_slow: 1, lv.E_fast: 1}
    assert is_zero(sp.expand(X).subs(begin) - x)
    assert is_zero(sp.expand(V).subs(begin) - v)


def test_a_step_without_inertia_solves_its_equation():
    """x' = u_0 + a s - kappa x, and (Var x)' = 2 D - 2 kappa Var x."""
    x, u, a = sp.symbols("x u a", real=True)
    rate, E = sp.Symbol("kappa", positive=True), sp.Symbol("E", positive=True)
    d = (1 - E) / rate
    closed_forms = {lv.d: d, lv.j: (lv.h - d) / rate, lv.kappa: rate}
    w = {
        name: sp.sympify(weight).subs(lv.kappa, rate).subs(closed_forms)
        for name, weight in lv.STEP_WEIGHTS_WITHOUT_INERTIA.items()
    }

    def change(expression):
        return expression.diff(lv.h) - rate * E * expression.diff(E)

    X = x + w["by_u"] * u + sp.expand(w["by_rise"] * lv.h) * a
    assert is_zero(change(X) - (u + rate * x + a * lv.h - rate * X))
    assert is_zero(change(w["spread"]) - (2 - 2 * rate * w["spread"]))
    assert w["spread"].subs(E, 1) == 0
