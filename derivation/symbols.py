"""Every symbol that reaches the emitted code: thesis symbol, meaning, unit, equation.

The order of the tuples here is the order of states and parameters in `generated/`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Quantity:
    """A real symbol with its unit (SI), meaning and place in the thesis."""

    symbol: sp.Symbol
    unit: str
    meaning: str
    equation: str = ""

    @property
    def name(self) -> str:
        """Name in the emitted code."""
        return str(self.symbol.name)


def _quantity(
    name: str, unit: str, meaning: str, equation: str = "", *, positive: bool = False
) -> Quantity:
    # SymPy drops to weaker assumptions for positive=None, so it is passed only when it holds.
    assumptions = {"positive": True} if positive else {"real": True}
    return Quantity(sp.Symbol(name, **assumptions), unit, meaning, equation)


def _vector(
    names: str, unit: str, meaning: str, equation: str, labels: Sequence[str]
) -> tuple[Quantity, ...]:
    return tuple(
        _quantity(name, unit, f"{meaning} {label}", equation)
        for name, label in zip(names.split(), labels, strict=True)
    )


def vector(quantities: Sequence[Quantity]) -> sp.Matrix:
    """The symbols of `quantities` as a column."""
    return sp.Matrix([quantity.symbol for quantity in quantities])


INERTIAL = ("along N1", "along N2", "along N3")
BODY = ("along P1", "along P2", "along P3")
EULER = ("e0", "e1", "e2", "e3")
PAIRS = tuple(f"{i}{j}" for i in "123" for j in "123")

# --- states ----------------------------------------------------------------------------------
POSITION = _vector("q1 q2 q3", "m", "position of the bead's centre", "2.1", INERTIAL)
VELOCITY = _vector("v1 v2 v3", "m/s", "velocity of the bead's centre", "2.2", INERTIAL)
EULER_PARAMETERS = _vector("e0 e1 e2 e3", "1", "Euler parameter", "2.1", EULER)
EULER_RATES = _vector("edot0 edot1 edot2 edot3", "1/s", "rate of Euler parameter", "2.2", EULER)
ANGULAR_VELOCITY = _vector(
    "omega1 omega2 omega3", "rad/s", "angular velocity, body frame,", "2.2", BODY
)

# --- what the runtime supplies at each evaluation ------------------------------------------------
FORCE = _vector("F1 F2 F3", "N", "force of the light on the bead", "3.26", INERTIAL)
MOMENT = _vector("M1 M2 M3", "N m", "moment of the light about the bead's centre", "3.26", INERTIAL)
FORCE_GRADIENT = tuple(_quantity(f"DF{ij}", "N/m", f"dF{ij[0]}/dq{ij[1]}", "3.26") for ij in PAIRS)
MOMENT_GRADIENT = tuple(_quantity(f"DM{ij}", "N", f"dM{ij[0]}/dq{ij[1]}", "3.26") for ij in PAIRS)
FORCE_RATE = _vector(
    "Fdot1 Fdot2 Fdot3", "N/s", "rate of the light's force along the overdamped motion,", "-",
    INERTIAL,
)  # fmt: skip
MOMENT_RATE = _vector(
    "Mdot1 Mdot2 Mdot3", "N m/s", "rate of the light's moment along the overdamped motion,", "-",
    INERTIAL,
)  # fmt: skip
FORCE_CURVATURE = tuple(
    _quantity(
        f"HF{ij}", "N/(m s)", f"rate of dF{ij[0]}/dq{ij[1]} along the velocity (F + W)/beta_v", "-"
    )
    for ij in PAIRS
)
MOMENT_CURVATURE = tuple(
    _quantity(
        f"HM{ij}", "N/s", f"rate of dM{ij[0]}/dq{ij[1]} along the velocity (F + W)/beta_v", "-"
    )
    for ij in PAIRS
)

MOBILITY = (
    _quantity("b_parallel", "s/kg", "velocity across N3 by a force that way", positive=True),
    _quantity("b_perpendicular", "s/kg", "velocity along N3 by a force that way", positive=True),
    _quantity("b_turn", "1/(N m s)", "angular velocity across N3 by a moment", positive=True),
    _quantity("b_spin", "1/(N m s)", "angular velocity about N3 by a moment", positive=True),
    _quantity("b_roll", "1/(N s)", "velocity along N1 by a moment about N2, rolling"),
)
MOBILITY_GRADIENT = tuple(
    _quantity(f"Db{i}{j}", f"{mobility.unit}/m", f"d{mobility.name}/dq{j}")
    for i, mobility in enumerate(MOBILITY, 1)
    for j in "123"
)

# --- parameters ------------------------------------------------------------------------------
MASS = _quantity("m", "kg", "mass of the bead", "2.3", positive=True)
INERTIA = tuple(
    _quantity(f"I{i}", "kg m^2", f"principal moment of inertia about P{i}", "A.13", positive=True)
    for i in "123"
)
SPHERE_INERTIA = _quantity(
    "I", "kg m^2", "moment of inertia of the sphere, I_PP", "2.6", positive=True
)
DRAG = _quantity("beta_v", "kg/s", "translational drag coefficient", "2.15", positive=True)
ROTATIONAL_DRAG = _quantity("beta_w", "N m s", "rotational drag coefficient", "2.15", positive=True)
SCALING = _quantity("a2", "1", "scaling factor of the generalised active forces", "4.12",
                    positive=True)  # fmt: skip
WEIGHT = _vector(
    "W1 W2 W3", "N", "gravity and buoyancy, one constant force,", "2.11-2.12", INERTIAL
)
TIME = _quantity("t", "s", "time since release", "4.8")
VISCOSITY = _quantity("mu_m", "Pa s", "viscosity of the medium", "2.13", positive=True)

# --- a body of any shape -------------------------------------------------------------------------
TWIST = (
    *_vector("u1 u2 u3", "m/s", "velocity of the centre of mass, body frame,", "-", BODY),
    *ANGULAR_VELOCITY,
)


def _six_by_six(name: str, meaning: str, units: Sequence[str]) -> tuple[Quantity, ...]:
    """Return the entries of a 6x6 matrix row by row, the blocks of translation first.

    units: of the block of translation, of those that couple, and of the block of rotation.
    """
    axes = (*BODY, *(each.replace("along", "about") for each in BODY))
    return tuple(
        _quantity(f"{name}{i + 1}{j + 1}", units[i // 3 + j // 3], f"{meaning} {row}, {column}")
        for i, row in enumerate(axes)
        for j, column in enumerate(axes)
    )


BODY_INERTIA = _six_by_six("M", "inertia", ("kg", "kg m", "kg m^2"))
BODY_INVERSE_INERTIA = _six_by_six("H", "inverse inertia", ("1/kg", "1/(kg m)", "1/(kg m^2)"))
BODY_DRAG = _six_by_six("R", "drag", ("kg/s", "N s", "N m s"))
BODY_MOBILITY = _six_by_six("B", "mobility", ("s/kg", "1/(N s)", "1/(N m s)"))


def upper(entries: Sequence[Quantity]) -> tuple[Quantity, ...]:
    """Return the upper triangle of a 6x6 matrix row by row."""
    return tuple(entries[6 * i + j] for i in range(6) for j in range(i, 6))


# --- a step with drag and noise ------------------------------------------------------------------
STEP = _quantity("h", "s", "step", "-", positive=True)
RELAXATION = _quantity("tau", "s", "relaxation time m/beta_v, epsilon of", "4.6", positive=True)
TRAP_RATE = _quantity("kappa", "1/s", "stiffness over drag, k/beta_v", "-")
DISPLACEMENT = _quantity("d", "s", "displacement by a unit of velocity", "-")
FIRST_INTEGRAL = _quantity("j", "s^2", "integral of d over the step", "-")
SECOND_INTEGRAL = _quantity("l", "s^3", "integral of j over the step", "-")
COVARIANCE_X = _quantity("c_xx", "s^2", "variance of the position over kT/m", "2.19")
COVARIANCE_V = _quantity("c_vv", "1", "variance of the velocity over kT/m", "2.19")
STEP_IN_TAU = _quantity("p", "1", "h/tau", "-")
STEP_IN_SWINGS = _quantity("q", "1", "kappa h^2/tau", "-")
STEP_IN_TRAP = _quantity("g", "1", "kappa h", "-")
# of a fluid with inertia
FREQUENCY = _quantity("w", "rad/s", "angular frequency", "-", positive=True)
VORTICITY_TIME = _quantity(
    "tau_f", "s", "r^2 rho_m/mu_m: vorticity diffuses over r", "-", positive=True
)
ROOT_OF_FREQUENCY = _quantity("y", "1", "sqrt(w tau_f/2)", "-", positive=True)
STIFFNESS = _quantity("k", "N/m", "stiffness of a trap", "-", positive=True)
THERMAL_ENERGY = _quantity("kT", "J", "Boltzmann's constant times temperature", "-", positive=True)

# --- one ray -----------------------------------------------------------------------------------
SINE_SQUARED = _quantity(
    "S", "1", "sin^2 of the angle of incidence, S = sin^2(alpha)", "3.12", positive=True
)
INDEX_RATIO = _quantity("n_mP", "1", "n_m/n_P, medium over bead", "3.14", positive=True)
RADIUS = _quantity("r", "m", "radius of the bead", "2.15", positive=True)
RAY = _vector("u1 u2 u3", "1", "unit direction of the ray", "3.2", INERTIAL)
IMPACT = _vector(
    "n1 n2 n3", "m", "from the bead's centre to the nearest point of the ray,", "3.23", INERTIAL
)
PLACE = _vector("p1 p2 p3", "1", "position of the bead's centre over its radius", "3.12", INERTIAL)
ALONG_RAY = _quantity("s", "1", "the centre's place along the ray, u.p", "3.12")
COS_ALPHA = _quantity("cos_alpha", "1", "cosine of the angle of incidence", "3.11", positive=True)
COS_SQUARED = _quantity("C", "1", "cos^2(alpha)", "3.11", positive=True)
COS_BETA = _quantity(
    "b", "1", "cos(beta)/n_mP, of the angle of refraction beta", "3.15", positive=True
)
SCATTERING = _quantity("Q_sc", "1", "scattering efficiency", "3.19")
SCATTERING_RATE = _quantity("dQ_sc", "1", "dQ_sc/dS", "3.19")
GRADIENT = _quantity("G", "1", "gradient efficiency, -Q_gr/sqrt(S)", "3.21")
GRADIENT_RATE = _quantity("dG", "1", "dG/dS", "3.21")

# Light that is polarised linearly or elliptically.
JONES = tuple(
    _quantity(f"{name}_{part}", "1", f"{about} part of the field along {axis} in the pupil", "-")
    for name, axis in (("a", "x"), ("b", "y"))
    for part, about in (("re", "real"), ("im", "imaginary"))
)
FIELD_REAL = _vector("E1 E2 E3", "1", "electric field of the ray, real part,", "-", INERTIAL)
FIELD_IMAGINARY = _vector("H1 H2 H3", "1", "its imaginary part,", "-", INERTIAL)
POLARISATION = _quantity("sigma", "1", "S times the excess of s- over p-polarised power", "3.17")
POLARISATION_RATES = _vector("dsigma1 dsigma2 dsigma3", "1/m", "dsigma/dp,", "3.17", INERTIAL)
SPLIT_SCATTERING = _quantity("X", "1", "(Q_sc of s less that of p)/(2 S)", "3.19")
SPLIT_SCATTERING_RATE = _quantity("dX", "1", "dX/dS", "3.19")
SPLIT_GRADIENT = _quantity("Y", "1", "(G of s less that of p)/(2 S)", "3.21")
SPLIT_GRADIENT_RATE = _quantity("dY", "1", "dY/dS", "3.21")

# Intermediates of the efficiencies. T, R: power transmitted and reflected at the surface.
_SURFACE = (
    ("q", "cos(alpha) b", "3.17"),
    ("w_s", "cos(alpha) + b", "3.17"),
    ("w_p", "cos(alpha) + n_mP^2 b", "3.17"),
    ("y", "1/(w_s w_p)", "3.17"),
    ("y_s", "1/w_s", "3.17"),
    ("y_p", "1/w_p", "3.17"),
    ("g", "sin(alpha - beta)/(2 n_mP sqrt(S))", "3.20"),
    ("a", "(1 - n_mP^2) (1 - S (1 + n_mP^2))/(2 n_mP)", "3.17"),
    ("X_s", "q R/T, s", "3.17"),
    ("X_p", "q R/T, p", "3.17"),
)
_CIRCULAR = (
    ("D_s", "denominator of the efficiencies, s", "3.19"),
    ("D_p", "denominator of the efficiencies, p", "3.19"),
    ("t_s", "X_s D_p", "3.19"),
    ("t_p", "X_p D_s", "3.19"),
)
_AVERAGED = (
    ("V_s", "T/(4 q), s", "3.18"),
    ("V_p", "T/(4 q), p", "3.18"),
    ("V", "V_s + V_p", "3.18"),
    ("N", "X_s V_s + X_p V_p", "3.17"),
)
_EFFICIENCIES = (
    ("scale", "factor of both efficiencies", "3.19"),
    ("e", "what reflection takes from G/scale", "3.21"),
    ("z", "part of G/scale by refraction, over q + S", "3.21"),
)


def _named(table: tuple[tuple[str, str, str], ...]) -> tuple[Quantity, ...]:
    return tuple(_quantity(name, "1", meaning, number) for name, meaning, number in table)


def over_S(quantity: Quantity) -> Quantity:
    """Return the derivative of a quantity over S."""
    meaning = f"derivative over S of the {quantity.meaning}"
    return _quantity(f"d{quantity.name}", quantity.unit, meaning, quantity.equation)


SURFACE, OF_CIRCULAR, OF_AVERAGED, EFFICIENCIES = map(
    _named, (_SURFACE, _CIRCULAR, _AVERAGED, _EFFICIENCIES)
)
PER_COSINES = _quantity("h", "1", "1/(2 q)")


# --- light as waves ------------------------------------------------------------------------------
def _complex(name: str, meaning: str) -> tuple[Quantity, Quantity]:
    """Real and imaginary part of a dimensionless complex number."""
    return (
        _quantity(f"{name}_re", "1", f"{meaning}, real part"),
        _quantity(f"{name}_im", "1", f"{meaning}, imaginary part"),
    )


def _of_either_kind(name: str, meaning: str) -> Quantity:
    """A dimensionless number that is complex where the bead absorbs."""
    return Quantity(sp.Symbol(name, complex=True), "1", meaning)


DEGREE = _quantity("n", "1", "degree of the harmonic")
ORDER = _quantity("m", "1", "order of the harmonic")

# A reduced logarithmic derivative is z f'(z)/f(z) - (n+1): 0 for psi_n as z goes to 0.
RELATIVE_INDEX = _of_either_kind("m", "index outside of the surface, relative to the medium")
INNER_INDEX = _of_either_kind("m_in", "index inside of the surface, relative to the medium")
FIELD_DERIVATIVE = _of_either_kind("g", "reduced logarithmic derivative of the field")
OUTER_DERIVATIVES = tuple(
    _of_either_kind(f"g_{name}", f"that of {solution} at the surface")
    for name, solution in (("psi", "psi_n"), ("chi", "the second solution"))
)
OUTER_RATIO = _of_either_kind("ratio", "psi_n over chi_n at the surface")
LAYER_DERIVATIVES = tuple(
    _of_either_kind(f"g_{name}_{side}", f"that of {solution} at the layer's {surface} surface")
    for side, surface in (("in", "inner"), ("out", "outer"))
    for name, solution in (("psi", "psi_n"), ("chi", "the second solution"))
)
LAYER_RATIO = _of_either_kind(
    "ratio", "psi_n over the second solution at the inner surface, over the same at the outer"
)

AMPLITUDE = _complex("P", "amplitude at (n, m)")
ABOVE = _complex("above", "amplitude at (n+1, m)")
BEFORE = _complex("before", "amplitude at (n-1, m)")
UP = _complex("up", "amplitude at (n, m+1)")
UP_ABOVE = _complex("up_above", "amplitude at (n+1, m+1)")
UP_BEFORE = _complex("up_before", "amplitude at (n-1, m+1)")
DOWN = _complex("down", "amplitude at (n, m-1)")
DOWN_ABOVE = _complex("down_above", "amplitude at (n+1, m-1)")
DOWN_BEFORE = _complex("down_before", "amplitude at (n-1, m-1)")
PARTNER = _complex("partner", "amplitude of the partner at (n, m)")
PARTNER_UP = _complex("partner_up", "amplitude of the partner at (n, m+1)")
PARTNER_DOWN = _complex("partner_down", "amplitude of the partner at (n, m-1)")

WEIGHT_ABOVE = _complex("U", "weight of the elements between n and n+1")
WEIGHT_BEFORE = _complex("U_before", "weight of the elements between n-1 and n")
WEIGHT_WITHIN = _complex("V", "weight of the elements within n")
WEIGHT_OF_TURN = _quantity("K", "1", "weight of the angular momentum at n")

ALONG = _quantity("al", "1", "<n m|s_z|n-1 m>")
ALONG_ABOVE = _quantity("al_above", "1", "<n+1 m|s_z|n m>")
WITHIN = _quantity("be", "1", "<n m|s_z|n m>")
RAISED = _quantity("e1", "1", "<n+1 m+1|s_+|n m>")
TURNED = _quantity("e0", "1", "<n m+1|s_+|n m>")
LOWERED = _quantity("em", "1", "<n-1 m+1|s_+|n m>")
RAISED_DOWN = _quantity("e1_down", "1", "<n m|s_+|n-1 m-1>")
TURNED_DOWN = _quantity("e0_down", "1", "<n m|s_+|n m-1>")
LOWERED_DOWN = _quantity("em_down", "1", "<n m|s_+|n+1 m-1>")
LIFT = _quantity("lift", "1", "sqrt((n-m)(n+m+1)), of J_+ from m to m+1")
LIFT_DOWN = _quantity("lift_down", "1", "sqrt((n+m)(n-m+1)), of J_+ from m-1 to m")

# Contribution of each neighbour to s_+ P, s_- P and s_z P at (n, m); their sums; the weighted sums.
NEIGHBOURS = {
    (component, place): _complex(f"{component}_{place}", f"what {where} adds to s_{component} P")
    for component in ("plus", "minus", "z")
    for place, where in (("before", "n-1"), ("within", "n"), ("above", "n+1"))
}
DIRECTED = {
    component: _complex(f"s_{component}", f"s_{component} P at (n, m){without}")
    for component, without in (
        ("plus", " over -i"), ("minus", " over i"), ("z", ""),
        ("x", " over i/2"), ("y", " over -1/2"), ("twice_z", ", twice"),
    )
}  # fmt: skip
WEIGHTED = {
    component: _complex(f"h_{component}", f"the same of the change of momentum{without}")
    for component, without in (
        ("plus", " over -i"), ("minus", " over i"), ("z", ""), ("x", " over i"), ("y", " over -1"),
    )
}  # fmt: skip
SENT_ON = _complex("G", "U P")
SENT_BACK = _complex("G_before", "conjugate of U_(n-1), times P")
TURNED_OVER = _complex("H", "V times the partner")

# Light on a body of any shape: amplitudes without the factor i^m, v = p + q of the light before
# and after. Components of the direction s and of the angular momentum J on amplitudes.
CHANGE = _complex("t", "amplitude of t = q - p at (n, m)")


def _on_amplitudes(operator: str, of: str, components: str) -> dict[str, tuple[Quantity, Quantity]]:
    """Components of s or J on the amplitudes `of`, by the component's name."""
    sign = {"plus": "+", "minus": "-"}
    return {
        component: _complex(
            f"{operator}_{component}{of and '_'}{of}",
            f"{operator}_{sign.get(component, component)} {of or 'v'} at (n, m)",
        )
        for component in components.split()
    }


DIRECTED_V = _on_amplitudes("s", "", "plus minus z")
TURNED_V = _on_amplitudes("J", "", "plus minus z")
GENERATED = tuple(
    each for operator in "sJ" for each in _on_amplitudes(operator, "p", "x y z").values()
)
RETURNED = _complex("h", "A t + (S - 1)^+ A q at (n, m)")
TWICE_RETURNED = _complex("twice_h", "A t + (S - 1)^+ A q at (n, m), twice")

INDEX_BEFORE_FACE = _quantity("n1", "1", "index before the plane face", positive=True)
INDEX_BEHIND_FACE = _quantity("n2", "1", "index behind the plane face", positive=True)
COSINE_BEFORE_FACE = _quantity("cos1", "1", "cosine of the angle before the face", positive=True)
COSINE_BEHIND_FACE = _quantity("cos2", "1", "cosine of the angle behind the face", positive=True)

# --- water ----------------------------------------------------------------------------------------
TEMPERATURE = _quantity("T", "K", "temperature", positive=True)
WAVELENGTH = _quantity("wavelength", "m", "wavelength of the light in vacuum", positive=True)
DENSITY = _quantity("rho", "kg/m^3", "density", positive=True)
REFRACTIVE_INDEX = _quantity("n", "1", "refractive index", positive=True)
LOG_TEMPERATURE = _quantity("log_T", "1", "ln(T/300 K)")
LORENTZ_LORENZ = _quantity("X", "1", "(n^2 - 1)/(n^2 + 2)", positive=True)

# --- other media ----------------------------------------------------------------------------------
MOLAR_MASS = _quantity("M", "kg/mol", "mass of a mole of the gas", positive=True)
PRESSURE = _quantity("p", "Pa", "pressure of the gas", positive=True)
COLLISION_DIAMETER = _quantity("sigma", "m", "Lennard-Jones diameter", positive=True)
WELL_DEPTH = _quantity("epsilon", "K", "Lennard-Jones energy over k", positive=True)
HELIUM = (
    _quantity("mu_0", "Pa s", "viscosity of the gas at 300 K", positive=True),
    _quantity("exponent", "1", "power of its temperature there", positive=True),
    _quantity("curvature", "1", "change of that power with ln T", positive=True),
)
KNUDSEN = _quantity("Kn", "1", "mean free path over the radius", positive=True)
ACCOMMODATION = _quantity("a", "1", "accommodation coefficient", positive=True)
MASS_FRACTION = _quantity("w", "1", "mass fraction of the solute", positive=True)
MOLALITY = _quantity("b", "mol/kg", "solute per mass of water", positive=True)
WATER_DENSITY = _quantity("rho_w", "kg/m^3", "density of water", positive=True)
WATER_VISCOSITY = _quantity("mu_w", "Pa s", "viscosity of water", positive=True)
WATER_INDEX = _quantity("n_w", "1", "refractive index of water", positive=True)
REFRACTION = _quantity(
    "refraction", "m^3/kg", "(n^2 - 1)/(n^2 + 2)/rho of the solute", positive=True
)
LOG_FRACTION = _quantity("log_w", "1", "ln of the mass fraction")
LOG_SINE = _quantity("log_sine", "1", "ln sin(pi w^1.31)")
LOG_REDUCED = _quantity("log_e", "1", "ln(T/epsilon)")

# --- heat -----------------------------------------------------------------------------------------
LIGHT_POWER = _quantity("P", "W", "power of the light, or its part that the bead absorbs",
                        positive=True)  # fmt: skip
ABSORPTION = _quantity("absorption", "1/m", "absorption coefficient of the fluid", positive=True)
CONDUCTIVITY = _quantity("conductivity", "W/(m K)", "thermal conductivity", positive=True)
SINK_DISTANCE = _quantity("depth", "m", "distance of the focus from the glass", positive=True)
SURFACE_TEMPERATURE = _quantity("T_s", "K", "temperature of the bead's surface", positive=True)
NEARNESS = _quantity("u", "1", "radius over the distance from the centre", positive=True)
FLOW_SLOPES = (
    _quantity("slope", "1", "dg/du of a flow"), _quantity("other_slope", "1", "dg/du of another")
)  # fmt: skip
FLOW_CURVATURES = (
    _quantity("curvature_u", "1", "d^2g/du^2 of a flow"),
    _quantity("other_curvature_u", "1", "d^2g/du^2 of another"),
)

# --- chains ---------------------------------------------------------------------------------------
SCALED_EXTENSION = _quantity("l", "1", "extension over contour length", positive=True)
ROOT_FORCE = _quantity("y", "1", "square root of F Lp/kT", positive=True)
COMPLIANCE = _quantity("s", "1", "kT/(Lp S) of a chain of stretch modulus S", positive=True)
LANGEVIN_ARGUMENT = _quantity("u", "1", "2 F Lp/kT", positive=True)
LANGEVIN_DECAY = _quantity("e", "1", "exp(-2 u)", positive=True)
TWIST_COUPLING = (
    _quantity("c_0", "1", "twist-stretch coupling over sqrt(S C), at no force"),
    _quantity("c_1", "1", "its increase with F Lp/kT"),
)
