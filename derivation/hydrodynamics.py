"""A sphere in a fluid with inertia: drag from the unsteady Stokes flow, its noise, its memory.

Consider slow flow, u = e^(st), about a sphere that moves by U e^(st) along z:

    rho_m s u = -grad p + mu_m lap u,   div u = 0,   u = U z on the sphere, 0 far away.

Its drag is gamma(s) (Boussinesq 1885, Basset 1888; L. D. Landau, E. M. Lifshitz, Fluid Mechanics,
section 24). A fluid in equilibrium exerts a random force with the spectrum 2 kT Re gamma(i w). The
velocity of a free bead therefore has the autocorrelation kT/Z(s), Z = m s + gamma(s).

The root in gamma is represented by fictitious masses m_k that the bead drags through dashpots
beta c_k (`derivation.memory_poles`). The noise of each dashpot pushes bead and mass with equal and
opposite forces. Then all velocities are Maxwell's, and independent, in equilibrium.

A wall reflects the flow, which acts back on the sphere. Along the wall the flow is a sum of waves
e^(i q X). The wall stops both parts of each wave: the dipole's, e^(-q z), and the part with
vorticity, e^(-l z), where l^2 = q^2 + alpha^2.
"""

from __future__ import annotations

import sympy as sp

from . import symbols as sy
from .equations import Equation

# --- the flow -----------------------------------------------------------------------------------
a, mu, rho = sp.symbols("a mu_m rho_m", positive=True)
U, Omega = sp.symbols("U Omega", positive=True)
r, theta = sp.symbols("r theta", positive=True)
#: 1/alpha is how far vorticity diffuses, alpha^2 = rho_m s/mu_m
alpha = sp.Symbol("alpha", positive=True)
s = alpha**2 * mu / rho
#: vorticity diffuses over the radius in this time
tau_f = a**2 * rho / mu
#: alpha a = sqrt(s tau_f)
x = sp.Symbol("x", positive=True)

_A, _B = sp.symbols("A B")


def potential(distance: sp.Expr, vortical: sp.Expr = _A, dipole: sp.Expr = _B) -> sp.Expr:
    """chi of u = grad(d chi/dz) - z lap(chi): a part that has vorticity, and a dipole."""
    return (vortical * sp.exp(-alpha * distance) + dipole) / distance


def pressure(cosine: sp.Expr, distance: sp.Expr, dipole: sp.Expr = _B) -> sp.Expr:
    """p = -rho s d/dz(dipole/r): the dipole alone has one."""
    return rho * s * dipole * cosine / distance**2


def _velocity() -> tuple[sp.Expr, sp.Expr]:
    """u_r over cos(theta), and u_theta over sin(theta)."""
    chi = potential(r)
    return -2 * chi.diff(r) / r, chi.diff(r, 2) + chi.diff(r) / r


def _constants() -> dict[sp.Symbol, sp.Expr]:
    """A and B of a sphere that moves by U along z."""
    radial, polar = (part.subs(r, a) for part in _velocity())
    solved: dict[sp.Symbol, sp.Expr] = sp.solve((radial - U, polar + U), (_A, _B), dict=True)[0]
    return {name: sp.simplify(value) for name, value in solved.items()}


CONSTANTS = _constants()


def _by_x(drag: sp.Expr) -> sp.Expr:
    """A drag in terms of x = alpha a."""
    return sp.factor(sp.simplify(drag.subs(alpha, x / a)))


def _force() -> sp.Expr:
    """Force on the sphere along z: the stress on its surface, over -U."""
    radial, polar = _velocity()
    normal = -pressure(sp.Integer(1), r) + 2 * mu * radial.diff(r)
    shear = mu * (r * (polar / r).diff(r) - radial / r)
    # int cos^2 and int sin^2 over the sphere
    over_sphere = 2 * sp.pi * a**2 * (sp.Rational(2, 3) * normal - sp.Rational(4, 3) * shear)
    return _by_x(-over_sphere.subs(r, a).subs(CONSTANTS) / U)


def swirl(distance: sp.Expr) -> sp.Expr:
    """u_phi/sin(theta) about a sphere that turns by Omega e^(st)."""

    def wave(at: sp.Expr) -> sp.Expr:
        return (1 + alpha * at) * sp.exp(-alpha * at) / at**2

    return Omega * a * wave(distance) / wave(a)


def _moment() -> sp.Expr:
    """Moment on the sphere about its axis, over -Omega."""
    shear = mu * (r * (swirl(r) / r).diff(r)).subs(r, a)
    # int sin^2 over the sphere
    return _by_x(-2 * sp.pi * a**3 * sp.Rational(4, 3) * shear / Omega)


TRANSLATION, ROTATION = _force(), _moment()

DRAG_OF_TRANSLATION = Equation(
    "-",
    r"drag of a sphere in a fluid with inertia, x = \sqrt{s \tau_f}",
    r"\gamma(s)",
    TRANSLATION,
)
DRAG_OF_ROTATION = Equation("-", "that of its rotation", r"\gamma_\omega(s)", ROTATION)

# --- reflection by a wall ------------------------------------------------------------------------
# By a force of 1 at a height h above a wall at z = 0; times 2 mu_m alpha^2, and e^(i q X).
q, h, z_up = sp.symbols("q h z_up", positive=True)
#: decay of the part with vorticity
decay = sp.Symbol("l_q", positive=True)
#: sphere over point force: sizes of both parts of its flow, and of its force in each part
DIPOLE, VORTICAL = 1 + x + x**2 / 3, sp.exp(x)
_W_p, _W_v = sp.symbols("W_p W_v", positive=True)


def below_a_force(*, across: bool) -> tuple[sp.Expr, sp.Expr]:
    """Return the velocity along the wave and up, below a force along the wave, or up."""
    slow, fast = _W_p * sp.exp(q * (z_up - h)), _W_v * sp.exp(decay * (z_up - h))
    if across:
        return sp.I * q * (slow - fast), q * slow - q**2 / decay * fast
    return decay * fast - q * slow, sp.I * q * (slow - fast)


def above_a_wall(dipole: sp.Expr, vortical: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Return the velocity along and up in a wave that leaves the wall, from its two amplitudes."""
    slow, fast = dipole * sp.exp(-q * z_up), vortical * sp.exp(-decay * z_up)
    return sp.I * q * slow + fast, -q * slow + sp.I * q / decay * fast


def _returned(*, across: bool) -> sp.Expr:
    """Return the velocity of the sphere in the reflection of the wave that its force causes."""
    P, V = sp.symbols("P V")
    there = zip(below_a_force(across=across), above_a_wall(P, V), strict=True)
    solved = sp.solve([(down + up).subs(z_up, 0) for down, up in there], (P, V), dict=True)[0]
    felt = above_a_wall(_W_p * solved[P], _W_v * solved[V])[int(across)].subs(z_up, h)
    return sp.simplify(felt)


#: for a force along the wave, up, and along the wall but across the wave (a shear wave)
RETURNED_ALONG, RETURNED_ACROSS = _returned(across=False), _returned(across=True)
RETURNED_SHEAR = -(alpha**2) / decay * _W_v**2 * sp.exp(-2 * decay * h)
#: G(s), the velocity by a force of 1, is int q dq/(4 pi) of the sum of both, over 2 mu_m alpha^2,
#: and across the wall int q dq/(2 pi)
_p, _v = _W_p * sp.exp(-q * h), _W_v * sp.exp(-decay * h)
REFLECTED_ALONG = Equation(
    "-",
    "wave of a force along it that a wall reflects",
    r"-2\mu_m\alpha^2\hat G_\parallel(q)",
    ((q * _p - decay * _v) ** 2 + q * decay * (_p - _v) ** 2) / (decay - q),
)
REFLECTED_ACROSS = Equation(
    "-",
    "wave of a force across the wall",
    r"-2\mu_m\alpha^2\hat G_\perp(q)",
    q / decay * ((decay * _p - q * _v) ** 2 + q * decay * (_p - _v) ** 2) / (decay - q),
)

# --- on s = i w ----------------------------------------------------------------------------------
w, tau, y = sy.FREQUENCY.symbol, sy.VORTICITY_TIME.symbol, sy.ROOT_OF_FREQUENCY.symbol
beta, beta_w, m = sy.DRAG.symbol, sy.ROTATIONAL_DRAG.symbol, sy.MASS.symbol
k, kT = sy.STIFFNESS.symbol, sy.THERMAL_ENERGY.symbol
#: y of w
ROOT = sp.sqrt(w * tau / 2)


def by_frequency(drag: sp.Expr, steady: sp.Expr, coefficient: sp.Symbol) -> sp.Matrix:
    """Real and imaginary part at s = i w of a drag in terms of x = (1 + i) y."""
    relative = sp.cancel(drag / steady).subs(x, (1 + sp.I) * y)
    return sp.Matrix([coefficient * sp.factor(part) for part in relative.as_real_imag()])


TRANSLATION_BY_FREQUENCY = by_frequency(TRANSLATION, TRANSLATION.subs(x, 0), beta)
ROTATION_BY_FREQUENCY = by_frequency(ROTATION, ROTATION.subs(x, 0), beta_w)
#: Z = m s + gamma(s), by parts
IMPEDANCE = TRANSLATION_BY_FREQUENCY + sp.Matrix([0, m * w])
#: two-sided spectrum of the force that the fluid's noise exerts
NOISE = 2 * kT * TRANSLATION_BY_FREQUENCY[0]
#: one-sided spectrum of the position in a trap: 4 kT Re(1/(Z + k/(i w)))/w^2
_in_phase, _against = w * IMPEDANCE[0], k - w * IMPEDANCE[1]
SPECTRUM = 4 * kT * IMPEDANCE[0] / (_in_phase**2 + _against**2)

# --- the memory by fictitious masses, in units of beta and tau_f ---------------------------------
# Symbols of this part: mu_M = M/(beta tau_f), M = m + m_f/2.
inertia = sp.Symbol("mu_M", positive=True)
#: number of masses
K = 2
c = sp.symbols(f"c1:{K + 1}", positive=True)
p = sp.symbols(f"p1:{K + 1}", positive=True)
masses = [weight / pole for weight, pole in zip(c, p, strict=True)]
#: M v' = F - v - sum c_k (v - u_k), m_k u_k' = c_k (v - u_k)
EMBEDDED = sp.zeros(K + 1, K + 1)
EMBEDDED[0, 0] = -(1 + sum(c)) / inertia
for _i in range(K):
    EMBEDDED[0, _i + 1] = c[_i] / inertia
    EMBEDDED[_i + 1, 0], EMBEDDED[_i + 1, _i + 1] = c[_i] / masses[_i], -c[_i] / masses[_i]
#: N: noise of the steady drag, and that of each dashpot, over sqrt(kT)
NOISES = sp.zeros(K + 1, K + 1)
NOISES[0, 0] = sp.sqrt(2) / inertia
for _i in range(K):
    NOISES[0, _i + 1] = sp.sqrt(2 * c[_i]) / inertia
    NOISES[_i + 1, _i + 1] = -sp.sqrt(2 * c[_i]) / masses[_i]
#: Maxwell's distribution: <v^2> = kT/M, <u_k^2> = kT/m_k, over kT
MAXWELL = sp.diag(1 / inertia, *(1 / mass for mass in masses))


def impedance(rate: sp.Expr) -> sp.Expr:
    """Z_K(s) over beta."""
    poles = zip(c, p, strict=True)
    return inertia * rate + 1 + sum(each * rate / (rate + pole) for each, pole in poles)


LYAPUNOV = Equation(
    "-",
    "equilibrium of the bead and its fictitious masses",
    r"A S + S A^\top + N N^\top",
    EMBEDDED * MAXWELL + MAXWELL * EMBEDDED.T + NOISES * NOISES.T,
)

# --- free motion as decays -----------------------------------------------------------------------
l = sp.Symbol("lambda", positive=True)
#: rho(lambda) of 1/Z(s) = int rho/(s + lambda): the jump of 1/Z across the cut, sqrt(s) = i sqrt(l)
DENSITY_OF_RATES = sp.simplify(sp.im(-1 / (1 - inertia * l + sp.I * sp.sqrt(l))) / sp.pi)
RATES = Equation(
    "-",
    r"density of the rates of a free bead's decay, in units of \beta and \tau_f",
    r"\rho(\lambda)",
    DENSITY_OF_RATES,
)

# --- closed forms --------------------------------------------------------------------------------
# In units of M and beta: Z = s + e sqrt(s) + 1 = (z - z_1)(z - z_2), z = sqrt(s), and in a trap
# s Z + kappa = (z - z_1) ... (z - z_4). Each W_i(t) = exp(z_i^2 t) erfc(-z_i sqrt(t)) has the
# transform 1/(z (z - z_i)).
z = sp.Symbol("z", positive=True)
FREE, TRAPPED = sp.symbols("z1:3"), sp.symbols("z1:5")


def of_roots(roots: tuple[sp.Symbol, ...], power: int) -> sp.Expr:
    """Transform of sum z_i^power W_i/P_i, P_i the product of z_i less the other roots."""
    return sum(
        root**power / sp.prod(root - other for other in roots if other is not root)
        / (z * (z - root))
        for root in roots
    )  # fmt: skip


def polynomial(roots: tuple[sp.Symbol, ...]) -> sp.Expr:
    """(z - z_1) (z - z_2) ..."""
    return sp.prod(z - root for root in roots)


#: of the displacement under a constant force: transforms of 1, t and sqrt(t), by their factors
_drift = FREE[0] + FREE[1]
SLOW = 1 / z**4 + _drift / z**3 + (_drift**2 - 1) / z**2
_Z = polynomial(FREE)
#: name: transform, and the same by the roots; free ones hold for z_1 z_2 = 1, which makes beta 1
CLOSED_FORMS = {
    "velocity": (1 / _Z, of_roots(FREE, 1)),
    "settling": (1 / (z**2 * _Z), 1 / z**2 + of_roots(FREE, -1)),
    "displacement": (1 / (z**4 * _Z), SLOW + of_roots(FREE, -3)),
    "velocity in a trap": (z**2 / polynomial(TRAPPED), of_roots(TRAPPED, 3)),
    "relaxation": (
        (1 - sp.prod(TRAPPED) / polynomial(TRAPPED)) / z**2,
        -sp.prod(TRAPPED) * of_roots(TRAPPED, -1),
    ),
}

#: late limit of <v(0) v(t)> over kT, for every sphere
_t = sp.Symbol("t", positive=True)
TAIL = Equation(
    "-",
    "late autocorrelation of the velocity, over kT",
    r"\tfrac{1}{kT}\langle v(0) v(t) \rangle",
    sp.sqrt(rho) / (12 * (sp.pi * mu * _t) ** sp.Rational(3, 2)),
)
