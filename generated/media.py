"""Mixtures with water, gases, and the drag in a gas.

Made by `python -m derivation` from derivation/media.py; do not edit.
SymPy 1.14.0. 243 operations, 15 temporaries.

Cheng (2008) and Volk and Kaehler (2018) for glycerol, Kestin (1981) for salt water, Lemmon
and Jacobsen (2004) for gases, Beresnev, Chernyak and Fomyagin (1990) for the drag.
"""

import math


def glycerol(T, w, rho_w, mu_w):
    """Density and viscosity of glycerol in water.

    T: temperature [K]
    w: mass fraction of the solute [1]
    rho_w: density of water [kg/m^3]
    mu_w: viscosity of water [Pa s]
    Returns rho, mu_m.
    58 operations, 4 temporaries.
    """
    log_w = math.log(w)
    log_sine = math.log(math.sin(math.pi * math.exp(1.31 * log_w)))
    x0 = T - 5463.0 / 20.0
    x1 = 1.0 - w
    x2 = 1.169355 - 0.0017 * T
    x3 = x1 * (0.036 * T - 4.9334)
    rho = ((-0.000182 * T + 1.78e-6 * (x0 * x0) + 0.0638133) * math.exp(0.81 * log_sine) + 1.0) / (
        w / (1440.495115 - 0.6121 * T) + x1 / rho_w
    )
    mu_m = mu_w * math.exp(
        (-w * (x2 * x2 * x2 * math.sqrt(x2)) * x3 / (w * x2 + (x2 * x2 * math.sqrt(x2)) * x3) + w)
        * (
            x0 * (T - 30123.0 / 20.0) / (70.0 * T - 18441.0 / 2.0)
            + x0 * (T + 19137.0 / 20.0) / (360.0 * T - 62234.0)
            + 8.81874511173217
        )
    )
    return rho, mu_m


def salt_water(T, b, rho_w, mu_w):
    """Density and viscosity of sodium chloride in water.

    T: temperature [K]
    b: solute per mass of water [mol/kg]
    rho_w: density of water [kg/m^3]
    mu_w: viscosity of water [Pa s]
    Returns rho, mu_m.
    62 operations, 6 temporaries.
    """
    x0 = T * T
    x1 = 0.0584428 * b
    x2 = x1 + 1.0
    x3 = b * b
    x4 = b * b * b
    x5 = 5863.0 / 20.0 - T
    rho = rho_w / (
        (
            x1 * (1.11766e-5 * T - 1.70552e-8 * x0 - 0.0025166) / x2
            + 0.00341556087184 * x3 * (-1.54305e-5 * T + 2.23982e-8 * x0 + 0.00284851) / (x2 * x2)
        )
        / (-1.035794e-5 * T + 9.270048e-9 * x0 + 0.005916365 + 100.6741 / x0 - 1.127522 / T)
        + 1.0
    )
    mu_m = mu_w * math.exp(
        0.07653792849112207558 * b
        + 0.008344568377010421676 * x3
        - 0.000432655738973581153 * x4
        + 2.302585092994045684
        * (-0.0396 * b + 0.0102 * x3 - 0.000702 * x4)
        * (
            -1.2378 * T
            + 2.55e-8 * (x5 * x5 * x5 * x5)
            + 3.06e-6 * (x5 * x5 * x5)
            - 0.001303 * (x5 * x5)
            + 362.86107
        )
        / (T - 3543.0 / 20.0)
    )
    return rho, mu_m


def sucrose(T, w, rho_w, mu_w):
    """Density and viscosity of sucrose in water.

    T: temperature [K]
    w: mass fraction of the solute [1]
    rho_w: density of water [kg/m^3]
    mu_w: viscosity of water [Pa s]
    Returns rho, mu_m.
    39 operations, 4 temporaries.
    """
    x0 = 1.0 / (1900.0 - 1800.0 * w)
    x1 = w * x0
    x2 = math.sqrt(w) * math.sqrt(x0)
    x3 = 100.0 * x1
    rho = 1.0 / (
        w * (2.8e-7 * T + 1.6074e-5 * (w * w) + 1.1157e-5 * w + 0.000533198) + (1.0 - w) / rho_w
    )
    mu_m = mu_w * math.exp(
        x3 * (5863.0 / 20.0 - T) * (1156.2 * x2 + 20.071) / (T - 3643.0 / 20.0)
        + x3 * (-10653.0 * x1 + 673.96 * x2 + 44.909)
    )
    return rho, mu_m


def refractive_index(rho, w, refraction, rho_w, n_w):
    """Refractive index of a mixture; without water, w = 1 and n_w = rho_w = 1.

    rho: density [kg/m^3]
    w: mass fraction of the solute [1]
    refraction: (n^2 - 1)/(n^2 + 2)/rho of the solute [m^3/kg]
    rho_w: density of water [kg/m^3]
    n_w: refractive index of water [1]
    Returns n.
    21 operations, 0 temporaries.
    """
    X = rho * (refraction * w + (1.0 - w) * ((n_w * n_w) - 1.0) / (rho_w * ((n_w * n_w) + 2.0)))
    n = math.sqrt(-1.0 / (X - 1.0)) * math.sqrt(2.0 * X + 1.0)
    return n


def gas_viscosity(T, M, sigma, epsilon):
    """Viscosity of a dilute gas.

    T: temperature [K]
    M: mass of a mole of the gas [kg/mol]
    sigma: Lennard-Jones diameter [m]
    epsilon: Lennard-Jones energy over k [K]
    Returns mu_m.
    25 operations, 0 temporaries.
    """
    log_e = math.log(T / epsilon)
    mu_m = (
        9.7237837107394e-25
        * math.sqrt(M)
        * math.sqrt(T)
        * math.exp(
            0.00331 * (log_e * log_e * log_e * log_e)
            - 0.005341 * (log_e * log_e * log_e)
            - 0.08406 * (log_e * log_e)
            + 0.4623 * log_e
        )
        / (math.sqrt(math.pi) * (sigma * sigma))
    )
    return mu_m


def power_viscosity(T, mu_0, exponent, curvature):
    """Viscosity of helium.

    T: temperature [K]
    mu_0: viscosity of the gas at 300 K [Pa s]
    exponent: power of its temperature there [1]
    curvature: change of that power with ln T [1]
    Returns mu_m.
    7 operations, 0 temporaries.
    """
    log_T = math.log((1.0 / 300.0) * T)
    mu_m = mu_0 * math.exp(log_T * (curvature * log_T + exponent))
    return mu_m


def gas(T, p, M, mu_m):
    """Density of an ideal gas, and its mean free path.

    T: temperature [K]
    p: pressure of the gas [Pa]
    M: mass of a mole of the gas [kg/mol]
    mu_m: viscosity of the medium [Pa s]
    Returns rho, mean_free_path.
    14 operations, 0 temporaries.
    """
    rho = 0.120272355042726 * M * p / T
    mean_free_path = 2.0389289612629 * math.sqrt(math.pi) * math.sqrt(T) * mu_m / (math.sqrt(M) * p)
    return rho, mean_free_path


def drag_factors(Kn, a):
    """Drag and rotational drag of a sphere in a gas, over Stokes's.

    Kn: mean free path over the radius [1]
    a: accommodation coefficient [1]
    Returns translation, rotation.
    17 operations, 1 temporaries.
    """
    x0 = (1.0 / 18.0) * math.pi * a + 4.0 / 9.0
    translation = x0 * (0.31 * Kn / ((Kn * Kn) + 1.152 * Kn + 0.785) + 1.0) / (Kn + x0)
    rotation = a / (6.0 * Kn + a)
    return translation, rotation
