"""Multiple time scales, (4.4)-(4.18), carried to first order, with the matched start.

The thesis stops at (4.11), splits its leading term into a1 + a2 = 1 and drops the large part,
which leaves the scaled model (4.16). Solved order by order instead, the same (4.11) gives the
overdamped model (5.2) and, one order on, a slow model free of stiffness whose start is shifted
by the initial layer.

The small parameter epsilon stands for m_c/beta: it multiplies the whole mass matrix, so one
power of epsilon is one power of m/beta_v and of I/beta_w alike.
"""

from __future__ import annotations

import sympy as sp

from .equations import Equation
from .euler_parameters import L, R, along, e, euler_rates_from_omega, omega
from .rigid_body import (
    I_AA,
    F_others,
    M_any,
    M_others,
    M_tilde,
    angular_momentum_rate,
    beta_v,
    beta_w,
    drag_force,
    m,
    v,
)
from .symbols import (
    FORCE,
    FORCE_GRADIENT,
    FORCE_RATE,
    MOMENT,
    MOMENT_GRADIENT,
    MOMENT_RATE,
    POSITION,
    SCALING,
    TIME,
    vector,
)

epsilon = sp.Symbol("epsilon", positive=True)
t = TIME.symbol
a1, a2 = sp.Symbol("a1", positive=True), SCALING.symbol
T0, T1 = sp.symbols("T0 T1", real=True)


# --- the expansion (4.7)-(4.11), one coordinate --------------------------------------------------
#: coordinate q(T0, T1), and Gamma_others/beta as a function of it
q_scales = sp.Function("q")(T0, T1)
u_scales = sp.Function("u")(q_scales)


def time_derivative(expression: sp.Expr) -> sp.Expr:
    """d/dt = d/dT0 + epsilon d/dT1, the chain rule (4.9) with T_n = epsilon^n t (4.8)."""
    return expression.diff(T0) + epsilon * expression.diff(T1)


qdot_expansion = time_derivative(q_scales)
qddot_expansion = sp.expand(time_derivative(qdot_expansion))

#: (4.7) with A-bar = D = 1: epsilon q'' + q' - Gamma/beta
balance = sp.expand(epsilon * qddot_expansion + qdot_expansion - u_scales)
leading_order = balance.coeff(epsilon, 0)
first_order = balance.coeff(epsilon, 1)

BALANCE = Equation("4.7", "normalised balance", r"0", balance)
TIME_DERIVATIVE = Equation("4.9", "first derivative", r"\dot{q}", qdot_expansion)
SECOND_TIME_DERIVATIVE = Equation("4.10", "second derivative", r"\ddot{q}", qddot_expansion)
EXPANSION = Equation("4.11", "orders of epsilon", r"0", leading_order + epsilon * first_order)


# --- the thesis's split (4.12)-(4.16) ----------------------------------------------------------
def scaled_balance() -> sp.Expr:
    """Return (4.15) times beta/epsilon^0: (4.11) without the part a1.

    With a1 + a2 = 1 the leading order is (a1 + a2) times itself (4.12). The part of a1 is assumed
    to cancel (4.13 to 4.14), and T-derivatives are collected into t.
    """
    split = sp.expand((a1 + a2) * leading_order).coeff(a1, 0)
    qdot, qddot, u = sp.symbols("qdot qddot u", real=True)
    in_t = {
        q_scales.diff(T0, 2): qddot,
        q_scales.diff(T1): 0,
        q_scales.diff(T0): qdot,
        u_scales: u,
    }
    return sp.expand((split + epsilon * first_order).subs(in_t))


SPLIT = Equation("4.12", "leading order split in two", r"0", (a1 + a2) * leading_order)
SCALED_BALANCE = Equation("4.15", "the scaled balance", r"0", scaled_balance())


#: Newton's equation of the scaled model, from A q'' = a2 Gamma (4.16)
scaled_acceleration = a2 * (F_others + drag_force) / m


# --- the orders solved one after the other -----------------------------------------------------
q = vector(POSITION)

#: order epsilon^0: q' = Gamma_others/beta (5.2), and the same for the rotation, body frame
overdamped_velocity = F_others / beta_v
overdamped_angular_velocity = M_others / beta_w


def _as_fields(expression: sp.MatrixBase) -> sp.MatrixBase:
    """The light's force and moment as functions of q, so that the chain rule sees them."""
    fields = {quantity.symbol: sp.Function(quantity.name)(*q) for quantity in (*FORCE, *MOMENT)}
    return expression.subs(fields)


def _as_inputs(expression: sp.MatrixBase) -> sp.MatrixBase:
    """Back again: the fields become the inputs F, M, and their gradients DF, DM."""
    replacements: dict[sp.Basic, sp.Basic] = {}
    for components, gradients in ((FORCE, FORCE_GRADIENT), (MOMENT, MOMENT_GRADIENT)):
        for i, component in enumerate(components):
            field = sp.Function(component.name)(*q)
            for j in range(3):
                replacements[field.diff(q[j])] = gradients[3 * i + j].symbol
            replacements[field] = component.symbol
    return expression.subs(replacements)


def along_leading_order(expression: sp.MatrixBase) -> sp.MatrixBase:
    """d/dT0: the rate of change along the order epsilon^0 solution, for q and e together."""
    turning = euler_rates_from_omega.subs(
        dict(zip(omega, overdamped_angular_velocity, strict=True)), simultaneous=True
    )
    field = _as_fields(expression)
    rate = along(field, q, _as_fields(overdamped_velocity)) + along(field, e, _as_fields(turning))
    return _as_inputs(rate)


#: dF/dT0 and dM/dT0, inertial frame: (DF) u and (DM) u with u = (F + W)/beta_v
force_rate = along_leading_order(vector(FORCE))
moment_rate = along_leading_order(vector(MOMENT))
#: the same under names of their own
Fdot, Mdot = vector(FORCE_RATE), vector(MOMENT_RATE)

#: order epsilon^1: dq/dT1 = -(m/beta_v) d^2q/dT0^2, and q' = dq/dT0 + epsilon dq/dT1
first_order_velocity = overdamped_velocity - (m / beta_v) * Fdot / beta_v


def first_order_angular_velocity(inertia: sp.MatrixBase) -> sp.Matrix:
    """omega to first order: the inertia acts on the rate of the leading order, (A.14).

    beta_w omega = M - I dw0/dT0 - w0 x (I w0), w0 = M/beta_w. The body frame turns along w0,
    which is along M, so that dM/dT0 in the body frame is R^T (DM) u: a test holds this to
    `along_leading_order(M_others)`, the full chain rule.
    """
    w0 = overdamped_angular_velocity
    return w0 - angular_momentum_rate(inertia, w0, R.T * Mdot / beta_w) / beta_w


# --- the initial layer -----------------------------------------------------------------------
def layer_solution() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Return x(s), its slow part, and the matched start, for x_ss + x_s = epsilon u, s = t/epsilon.

    In the layer the force has no time to change, so the equation is linear and `dsolve` solves it.
    The slow part is the limit s -> infinity, x0 + epsilon (v0 - u) + u t, so the slow model starts
    at x0 + epsilon (v0 - u(x0)).
    """
    s = sp.Symbol("s", positive=True)
    x0, v0, u = sp.symbols("x0 v0 u", real=True)
    x = sp.Function("x")
    solution = sp.dsolve(
        x(s).diff(s, 2) + x(s).diff(s) - epsilon * u,
        x(s),
        ics={x(0): x0, x(s).diff(s).subs(s, 0): epsilon * v0},
    ).rhs
    solution = sp.expand(solution)
    decaying = solution.coeff(sp.exp(-s))
    slow = sp.expand(solution - decaying * sp.exp(-s))
    return solution, slow, slow.subs(s, 0)


_LAYER, _SLOW, _START = layer_solution()
LAYER = Equation("-", "initial layer, s = t/epsilon", r"x(s)", _LAYER)
MATCHED_START = Equation("-", "matched start of the slow model", r"x(0)", _START)


def _matched(x0: sp.Expr, tau: sp.Expr, v0: sp.Expr, u: sp.Expr) -> sp.Expr:
    x0_, v0_, u_ = sp.symbols("x0 v0 u", real=True)
    return _START.subs({x0_: x0, epsilon: tau, v0_: v0, u_: u}, simultaneous=True)


tau_v = m / beta_v

#: start of the slow model for a bead released at q with velocity v
matched_position = sp.Matrix(
    [_matched(q[i], tau_v, v[i], overdamped_velocity[i]) for i in range(3)]
)


def matched_euler_parameters(inertia: sp.MatrixBase) -> sp.Matrix:
    """Return the start of the slow orientation, e + L^T theta/4 for the angle theta of the layer.

    theta = (I/beta_w)(omega - M/beta_w), body frame, follows from the same layer as the position.
    """
    tau_w = inertia / beta_w
    theta = sp.Matrix(
        [_matched(0, tau_w[i, i], omega[i], overdamped_angular_velocity[i]) for i in range(3)]
    )
    return e + L.T * theta / 4


def layer(inertia: sp.MatrixBase | None) -> sp.Matrix:
    """Return the difference between the motion in the layer and the slow motion at time t.

    It is the decaying part of `layer_solution`: displacement and velocity. For a body with inertia
    the angle turned and the angular velocity follow, in the body frame.
    """
    decay = sp.exp(-t / tau_v)
    velocity = (v - overdamped_velocity) * decay
    parts = [-tau_v * velocity, velocity]
    if inertia is not None:
        tau_w = inertia / beta_w
        excess = omega - overdamped_angular_velocity
        spin = sp.Matrix([excess[i] * sp.exp(-t / tau_w[i, i]) for i in range(3)])
        parts += [-tau_w * spin, spin]
    return sp.Matrix.vstack(*parts)


OVERDAMPED = Equation("5.2", "terminal velocity", r"\dot{\mathbf{q}}", overdamped_velocity)
FIRST_ORDER = Equation("-", "first-order slow model", r"\dot{\mathbf{q}}", first_order_velocity)
SCALED_M_TILDE = Equation(
    "4.18", "scaled moments with the constraint row", r"\tilde{\mathbf{M}}",
    M_tilde(I_AA, a2 * M_any),
)  # fmt: skip
SCALED_ACCELERATION = Equation("4.16", "scaled model", r"\ddot{\mathbf{q}}", scaled_acceleration)
