"""Heating by the laser, and the motion of a hot bead.

Made by `python -m derivation` from derivation/heat.py; do not edit.
SymPy 1.14.0. 61 operations, 4 temporaries.

Peterman, Gittes and Schmidt (2003) for water, Rings et al. (2010) for hot Brownian motion,
IAPWS SR6-08(2011) for the conductivity.
"""

import math


def conductivity(T):
    """Thermal conductivity of liquid water.

    T: temperature [K]
    Returns conductivity.
    20 operations, 0 temporaries.
    """
    log_T = math.log((1.0 / 300.0) * T)
    conductivity = (
        1.1567 * math.exp(-6.0 * log_T)
        - 1.7781 * math.exp(-17.0 / 5.0 * log_T)
        - 0.432115 * math.exp(-38.0 / 5.0 * log_T)
        + 1.663 * math.exp(-23.0 / 20.0 * log_T)
    )
    return conductivity


def water_rise(P, absorption, conductivity, wavelength, depth):
    """Temperature rise of a fluid at the focus, beside a plane that conducts heat.

    P: power of the light, or its part that the bead absorbs [W]
    absorption: absorption coefficient of the fluid [1/m]
    conductivity: thermal conductivity [W/(m K)]
    wavelength: wavelength of the light in vacuum [m]
    depth: distance of the focus from the glass [m]
    Returns rise.
    9 operations, 0 temporaries.
    """
    rise = (
        (1.0 / 2.0)
        * P
        * absorption
        * math.log(2.0 * math.pi * depth / wavelength)
        / (math.pi * conductivity)
    )
    return rise


def bead_rise(P, conductivity, r):
    """Temperature rise of a sphere that absorbs light, far from walls.

    P: power of the light, or its part that the bead absorbs [W]
    conductivity: thermal conductivity [W/(m K)]
    r: radius of the bead [m]
    Returns rise.
    4 operations, 0 temporaries.
    """
    rise = (1.0 / 4.0) * P / (math.pi * conductivity * r)
    return rise


def dissipation(u, slope, other_slope, curvature_u, other_curvature_u):
    """Dissipation of two flows about a sphere, per viscosity, 6 pi r and du.

    u: radius over the distance from the centre [1]
    slope: dg/du of a flow [1]
    other_slope: dg/du of another [1]
    curvature_u: d^2g/du^2 of a flow [1]
    other_curvature_u: d^2g/du^2 of another [1]
    Returns dissipation.
    8 operations, 0 temporaries.
    """
    dissipation = (1.0 / 9.0) * curvature_u * other_curvature_u * (u * u) + (
        2.0 / 3.0
    ) * other_slope * slope
    return dissipation


def hot_in_gas(a, T, T_s):
    """Drag over that of a bead as warm as the gas, and temperature of its motion.

    a: accommodation coefficient [1]
    T: temperature [K]
    T_s: temperature of the bead's surface [K]
    Returns drag, temperature.
    20 operations, 4 temporaries.
    """
    x0 = (1.0 / 8.0) * math.pi * a
    x1 = math.sqrt(T)
    x2 = math.sqrt(T_s) * x0
    x3 = 1.0 + x2 / x1
    drag = x3 / (x0 + 1.0)
    temperature = (T * (1.0 - a) + (1.0 / 2.0) * a * (T + T_s) + x1 * x2) / x3
    return drag, temperature
