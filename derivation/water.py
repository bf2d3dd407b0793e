"""Liquid water at the pressure of the atmosphere: density, viscosity and refractive index.

Density and viscosity follow the supplementary release of IAPWS on liquid water at 0.1 MPa, which
writes them as short sums of powers of the temperature. The isothermal compressibility of the same
release carries the density from 0.1 MPa to one atmosphere. The refractive index follows from the
Lorentz-Lorenz function of the release R9-97, solved for the index.

References
----------
IAPWS SR6-08(2011), Revised Supplementary Release on Properties of Liquid Water at 0.1 MPa:
equations (2), (3) and (7). J. Patek et al., J. Phys. Chem. Ref. Data 38, 21 (2009).
IAPWS R9-97, Release on the Refractive Index of Ordinary Water Substance: equation (1).
"""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from . import symbols as sy
from .equations import Equation

T, wavelength = sy.TEMPERATURE.symbol, sy.WAVELENGTH.symbol
rho, n = sy.DENSITY.symbol, sy.REFRACTIVE_INDEX.symbol
log_T = sy.LOG_TEMPERATURE.symbol

#: one atmosphere over the pressure of the release, 0.1 MPa
PRESSURE = sp.Rational(101325, 100000)
#: R T_R/p_0, m^3/kg: gas constant of water 461.51805 J/(kg K), T_R = 10 K, p_0 = 0.1 MPa
_VOLUME = sp.Float("461.51805e-4")
#: the two reduced temperatures of the release, T_R/(593 K - T) and T_R/(T - 232 K)
_HOT, _COLD = 10 / (593 - T), 10 / (T - 232)


def _series(x: sp.Expr, coefficients: Mapping[int, str]) -> sp.Expr:
    """Return the sum of coefficient * x**power, nested from the highest power inwards."""
    total: sp.Expr = sp.Integer(0)
    for power in range(max(coefficients), 0, -1):
        total = x * (total + sp.Float(coefficients[power]) if power in coefficients else total)
    return total


#: specific volume at 0.1 MPa over `_VOLUME`, equation (2)
_AT_RELEASE = (
    sp.Float("1.93763157e-2")
    + _series(
        _HOT,
        {
            4: "6.74458446e3",
            5: "-2.22521604e5",
            7: "1.00231247e8",
            8: "-1.63552118e9",
            9: "8.32299658e9",
        },
    )
    + _series(
        _COLD,
        {
            1: "5.78545292e-3",
            2: "-1.53195665e-2",
            3: "3.11337859e-2",
            4: "-4.23546241e-2",
            5: "3.38713507e-2",
            6: "-1.19946761e-2",
        },
    )
)
#: its derivative over p/p_0, equation (3)
_BY_PRESSURE = _series(
    _HOT,
    {
        1: "-7.5245878e-6",
        3: "-1.3767418e-2",
        5: "1.0627293e1",
        6: "-2.0457795e2",
        7: "1.2037414e3",
    },
) + _series(
    _COLD,
    {
        1: "-3.1091470e-6",
        3: "2.8964919e-5",
        4: "-1.3112763e-4",
        5: "3.0410453e-4",
        6: "-3.9034594e-4",
        7: "2.3403117e-4",
        9: "-4.8510101e-5",
    },
)
density = 1 / (_VOLUME * (_AT_RELEASE + (PRESSURE - 1) * _BY_PRESSURE))

#: ln(T/300 K)
LOG_TEMPERATURE = sp.log(T / 300)
#: coefficients in Pa s and powers of T/300 K, equation (7)
_VISCOSITY = (
    ("280.68e-6", "-1.9"),
    ("511.45e-6", "-7.7"),
    ("61.131e-6", "-19.6"),
    ("0.45903e-6", "-40"),
)
viscosity = sum(
    sp.Float(factor) * sp.exp(sp.Rational(power) * log_T) for factor, power in _VISCOSITY
)

# --- the refractive index -----------------------------------------------------------------------
#: reduced density, temperature and squared wavelength of the release
_d, _t = rho / 1000, T / sp.Rational("273.15")
_l2 = (wavelength / sp.Rational("0.589e-6")) ** 2
#: (n^2 - 1)/(n^2 + 2): resonances of the ultraviolet at 0.229202, of the infrared at 5.432937
LORENTZ_LORENZ = _d * (
    sp.Float("0.244257733")
    + sp.Float("9.74634476e-3") * _d
    + sp.Float("-3.73234996e-3") * _t
    + sp.Float("2.68678472e-4") * _l2 * _t
    + sp.Float("1.58920570e-3") / _l2
    + sp.Float("2.45934259e-3") / (_l2 - sp.Rational("0.229202") ** 2)
    + sp.Float("0.900704920") / (_l2 - sp.Rational("5.432937") ** 2)
    + sp.Float("-1.66626219e-2") * _d**2
)
X = sy.LORENTZ_LORENZ.symbol


def lorentz_lorenz(index: sp.Expr) -> sp.Expr:
    """Return the Lorentz-Lorenz function of a refractive index."""
    return (index**2 - 1) / (index**2 + 2)


#: the index whose Lorentz-Lorenz function is X
(refractive_index,) = (root for root in sp.solve(lorentz_lorenz(n) - X, n) if root.subs(X, 0) == 1)

DENSITY = Equation("-", "density of liquid water at one atmosphere", r"\rho_m", density)
VISCOSITY = Equation(
    "-", "viscosity of liquid water", r"\mu_m", viscosity.subs(log_T, LOG_TEMPERATURE)
)
REFRACTIVE_INDEX = Equation("-", "refractive index of water", r"n_m", refractive_index)
