r"""Media by name: mixtures with water, dilute gases, and the drag from continuum to free molecules.

Mixtures: published formulas give the ratio of a mixture to water at the same temperature, which
multiplies the properties of water (`derivation.water`). A mixture without solute is water exactly.

Gases: the viscosity of a dilute gas of molecules of mass M/N_A follows from Chapman and Enskog's
theory with a collision integral Omega. With the mean free path l = (mu/p) sqrt(pi R T/(2 M)), the
drag on a sphere of radius r depends on the Knudsen number Kn = l/r alone.

Circulation: a force whose stiffness matrix has the eigenvalues a +- i b drives a bead of mass m out
on a spiral unless the drag exceeds |b| sqrt(m/a).

References
----------
N.-S. Cheng, Ind. Eng. Chem. Res. 47, 3285 (2008): viscosity of glycerol in water.
A. Volk and C. J. Kaehler, Exp. Fluids 59, 75 (2018): density of glycerol in water.
J. Kestin, H. E. Khalifa and R. J. Correia, J. Phys. Chem. Ref. Data 10, 71 (1981): salt water.
CRC Handbook of Chemistry and Physics: tables of sucrose, to which the formulas here are fitted.
E. W. Lemmon and R. T. Jacobsen, Int. J. Thermophys. 25, 21 (2004): viscosity of gases.
S. A. Beresnev, V. G. Chernyak and G. A. Fomyagin, J. Fluid Mech. 219, 405 (1990): drag.
P. S. Epstein, Phys. Rev. 23, 710 (1924): drag of free molecules.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from . import symbols as sy
from . import water
from .equations import Equation

T, M, p = sy.TEMPERATURE.symbol, sy.MOLAR_MASS.symbol, sy.PRESSURE.symbol
sigma, epsilon = sy.COLLISION_DIAMETER.symbol, sy.WELL_DEPTH.symbol
mu, rho = sy.VISCOSITY.symbol, sy.DENSITY.symbol
Kn, a = sy.KNUDSEN.symbol, sy.ACCOMMODATION.symbol
w, b = sy.MASS_FRACTION.symbol, sy.MOLALITY.symbol
rho_w, mu_w, n_w = sy.WATER_DENSITY.symbol, sy.WATER_VISCOSITY.symbol, sy.WATER_INDEX.symbol
refraction = sy.REFRACTION.symbol

#: Boltzmann's and Avogadro's constants, J/K and 1/mol, and their product
BOLTZMANN, AVOGADRO = sp.Float("1.380649e-23"), sp.Float("6.02214076e23")
GAS_CONSTANT = sp.Float("8.31446261815324")
#: temperature, degC
_t = T - sp.Rational("273.15")


def _sum(coefficients: Sequence[str], x: sp.Expr, first: int = 0) -> sp.Expr:
    """Return the sum of coefficients times powers of x, which begin with x**first."""
    return sum(sp.Float(each) * x ** (first + i) for i, each in enumerate(coefficients))


# --- glycerol, mass fraction w ------------------------------------------------------------------
log_w, log_sine = sy.LOG_FRACTION.symbol, sy.LOG_SINE.symbol
#: ln of glycerol's viscosity over water's
_CHENG = (
    sp.log(12100 / sp.Float("1.790"))
    + (-1233 + _t) * _t / (9900 + 70 * _t)
    + (1230 + _t) * _t / (36100 + 360 * _t)
)
_A = sp.Float("0.705") - sp.Float("0.0017") * _t
_B = (sp.Float("4.9") + sp.Float("0.036") * _t) * _A ** sp.Rational(5, 2)
GLYCEROL_VISCOSITY = mu_w * sp.exp((w - _A * _B * w * (1 - w) / (_A * w + _B * (1 - w))) * _CHENG)
_VOLK_GLYCEROL = sp.Float("1273.3") - sp.Float("0.6121") * _t
#: contraction: a power 0.81 of sin(pi w^1.31)
_CONTRACTION = sum(
    sp.Float(each) * _t**i for i, each in enumerate(("1.41e-2", "-1.82e-4", "1.78e-6"))
) * sp.exp(sp.Float("0.81") * log_sine)
GLYCEROL_DENSITY = (1 + _CONTRACTION) / ((1 - w) / rho_w + w / _VOLK_GLYCEROL)
LOG_FRACTION = sp.log(w)
LOG_SINE = sp.log(sp.sin(sp.pi * sp.exp(sp.Float("1.31") * log_w)))

# --- salt water, molality b of sodium chloride --------------------------------------------------
#: mass of sodium chloride, kg/mol
_SALT = sp.Float("0.0584428")
#: ln 10
_LN_10 = sp.Float("2.302585092994045684")
#: log10 of water's viscosity over that at 20 degC, equation (3)
_LOG_WATER = _sum(("1.2378", "-1.303e-3", "3.06e-6", "2.55e-8"), 20 - _t, 1) / (96 + _t)
#: equations (4) and (5)
_LOG_SALT = _sum(("3.324e-2", "3.624e-3", "-1.879e-4"), b, 1) + _LOG_WATER * _sum(
    ("-3.96e-2", "1.02e-2", "-7.02e-4"), b, 1
)
SALT_VISCOSITY = mu_w * sp.exp(_LN_10 * _LOG_SALT)
#: specific volume of water, and what the mass fraction and its square add, page 73, m^3/kg
_VOLUME = _sum(("1.006741e2", "-1.127522", "5.916365e-3", "-1.035794e-5", "9.270048e-9"), T, -2)
_BY_FRACTION = _sum(("-2.5166e-3", "1.11766e-5", "-1.70552e-8"), T)
_BY_SQUARE = _sum(("2.84851e-3", "-1.54305e-5", "2.23982e-8"), T)
#: mass fraction
_salt = _SALT * b / (1 + _SALT * b)
SALT_DENSITY = rho_w / (1 + (_salt * _BY_FRACTION + _salt**2 * _BY_SQUARE) / _VOLUME)

# --- sucrose, mass fraction w -------------------------------------------------------------------
#: mole fraction
_x = 100 * w / (1900 - 1800 * w)
SUCROSE_VISCOSITY = mu_w * sp.exp(
    _x * (sp.Float("44.909") + sp.Float("67.396") * sp.sqrt(_x) - sp.Float("106.53") * _x)
    + (20 - _t) / (91 + _t) * _x * (sp.Float("20.071") + sp.Float("115.62") * sp.sqrt(_x))
)
#: specific volume of the solute, m^3/kg
_SUCROSE_VOLUME = _sum(("6.1528e-4", "1.1157e-5", "1.6074e-5"), w) + sp.Float("2.8e-7") * (_t - 20)
SUCROSE_DENSITY = 1 / ((1 - w) / rho_w + w * _SUCROSE_VOLUME)

# --- refractive index ---------------------------------------------------------------------------
#: sum of the Lorentz-Lorenz functions of water and of the solute, by their masses in the volume
LORENTZ_LORENZ = rho * ((1 - w) * water.lorentz_lorenz(n_w) / rho_w + w * refraction)

# --- gases --------------------------------------------------------------------------------------
gas_density = p * M / (GAS_CONSTANT * T)
mean_free_path = mu / p * sp.sqrt(sp.pi * GAS_CONSTANT * T / (2 * M))
#: ln Omega by powers of ln(T/epsilon)
log_e, LOG_REDUCED = sy.LOG_REDUCED.symbol, sp.log(T / epsilon)
_LOG_OMEGA = _sum(("0.431", "-0.4623", "0.08406", "0.005341", "-0.00331"), log_e)
gas_viscosity = (
    sp.Rational(5, 16)
    * sp.sqrt(sp.pi * M / AVOGADRO * BOLTZMANN * T)
    / (sp.pi * sigma**2)
    * sp.exp(-_LOG_OMEGA)
)
mu_0, exponent, curvature = (each.symbol for each in sy.HELIUM)
log_T = sy.LOG_TEMPERATURE.symbol
#: viscosity of a monatomic gas of weak attraction: a power of the temperature that changes slowly
power_viscosity = mu_0 * sp.exp(log_T * (exponent + curvature * log_T))

#: Kn times the factor of free molecules: (4/9)(1 + pi a/8)
FREE = sp.Rational(4, 9) * (1 + sp.pi * a / 8)
drag_factor = (
    FREE
    / (FREE + Kn)
    * (
        1
        + sp.Float("0.31") * Kn / (sp.Float("0.785") + sp.Float("1.152") * Kn + Kn**2)
    )
)  # fmt: skip
#: reciprocals of the drag of the continuum and of free molecules, added
rotational_factor = a / (a + 6 * Kn)

#: mean speed of the molecules, m/s
mean_speed = sp.sqrt(8 * GAS_CONSTANT * T / (sp.pi * M))

# --- circulation --------------------------------------------------------------------------------
m, Gamma = sp.symbols("m Gamma", positive=True)
#: eigenvalues a +- i b of the stiffness matrix, N/m
a_k, b_k = sp.symbols("a b", positive=True)
circulating = sp.Matrix([[a_k, b_k], [-b_k, a_k]])
#: drag above which every displacement decays, kg/s
critical_drag = b_k * sp.sqrt(m / a_k)
#: <v_i^2> of that motion over H/(m Gamma), its value without circulation, at the heating rate H
circulation_factor = 1 / (1 - (critical_drag / (m * Gamma)) ** 2)

DRAG = Equation(
    "-", "drag of a sphere in a gas over Stokes's drag", r"\beta_v/6\pi\mu r", drag_factor
)
MEAN_FREE_PATH = Equation("-", "mean free path in a gas", r"\lambda", mean_free_path)
CRITICAL_DRAG = Equation("-", "drag that circulation requires", r"\beta_c", critical_drag)
VISCOSITY = Equation(
    "-", "viscosity of a dilute gas", r"\mu_m", gas_viscosity.subs(log_e, LOG_REDUCED)
)
