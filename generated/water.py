"""Liquid water at one atmosphere: density, viscosity and refractive index.

Made by `python -m derivation` from derivation/water.py; do not edit.
SymPy 1.14.0. 126 operations, 8 temporaries.

IAPWS SR6-08(2011) for density and viscosity, R9-97 for the refractive index.
"""

import math


def density(T):
    """Density at one atmosphere, kg/m^3.

    T: temperature [K]
    Returns rho.
    66 operations, 8 temporaries.
    """
    x0 = T - 232.0
    x1 = 1.0 / x0
    x2 = 10.0 * x1
    x3 = 593.0 - T
    x4 = 1.0 / (x3 * x3)
    x5 = 1.0 / x3
    x6 = 10.0 * x5
    x7 = 1.0 / (x0 * x0)
    rho = 1.0 / (
        0.46151805
        * x1
        * (
            x2
            * (
                x2 * (x2 * (x2 * (0.0338713507 - 0.119946761 * x1) - 0.0423546241) + 0.0311337859)
                - 0.0153195665
            )
            + 0.00578545292
        )
        + 0.0061151141625
        * x1
        * (
            100.0
            * x7
            * (
                x2
                * (
                    x2
                    * (
                        x2 * (x2 * (0.00023403117 - 0.0048510101 * x7) - 0.00039034594)
                        + 0.00030410453
                    )
                    - 0.00013112763
                )
                + 2.8964919e-5
            )
            - 3.109147e-6
        )
        + 0.0061151141625
        * x5
        * (
            100.0
            * x4
            * (100.0 * x4 * (x6 * (12037.414 * x5 - 204.57795) + 10.627293) - 0.013767418)
            - 7.5245878e-6
        )
        + 0.000894251943804839
        + 461.51805
        * (
            x6
            * (100.0 * x4 * (x6 * (83229965800.0 * x5 - 1635521180.0) + 100231247.0) - 222521.604)
            + 6744.58446
        )
        / (x3 * x3 * x3 * x3)
    )
    return rho


def viscosity(T):
    """Viscosity, Pa s.

    T: temperature [K]
    Returns mu_m.
    20 operations, 0 temporaries.
    """
    log_T = math.log((1.0 / 300.0) * T)
    mu_m = (
        4.5903e-7 * math.exp(-40.0 * log_T)
        + 6.1131e-5 * math.exp(-98.0 / 5.0 * log_T)
        + 0.00028068 * math.exp(-19.0 / 10.0 * log_T)
        + 0.00051145 * math.exp(-77.0 / 10.0 * log_T)
    )
    return mu_m


def refractive_index(rho, T, wavelength):
    """Refractive index at a density and a wavelength in vacuum.

    rho: density [kg/m^3]
    T: temperature [K]
    wavelength: wavelength of the light in vacuum [m]
    Returns n.
    40 operations, 0 temporaries.
    """
    X = (
        (1.0 / 1000.0)
        * rho
        * (
            2835313.43213006 * T * (wavelength * wavelength)
            - 1.36641038257368e-5 * T
            - 1.66626219e-8 * (rho * rho)
            + 9.74634476e-6 * rho
            + 0.244257733
            + 0.00245934259
            / (
                (1000000000000000000.0 / 346921.0) * (wavelength * wavelength)
                - 13133389201.0 / 250000000000.0
            )
            + 0.90070492
            / (
                (1000000000000000000.0 / 346921.0) * (wavelength * wavelength)
                - 29516804445969.0 / 1000000000000.0
            )
            + 5.513288306497e-16 / (wavelength * wavelength)
        )
    )
    n = math.sqrt(-1.0 / (X - 1.0)) * math.sqrt(2.0 * X + 1.0)
    return n
