"""A sphere in a fluid with inertia, by angular frequency: s = i w.

Made by `python -m derivation` from derivation/hydrodynamics.py; do not edit.
SymPy 1.14.0. 106 operations, 3 temporaries.

gamma is the drag in the unsteady Stokes flow; its imaginary part has the added mass.
"""

import math

from numba import njit


@njit(cache=True)
def drag_of_translation(w, beta_v, tau_f):
    """gamma(i w) = beta_v (1 + x + x^2/9), x = sqrt(i w tau_f).

    w: angular frequency [rad/s]
    beta_v: translational drag coefficient [kg/s]
    tau_f: r^2 rho_m/mu_m: vorticity diffuses over r [s]
    Returns real, imaginary.
    16 operations, 0 temporaries.
    """
    y = (1.0 / 2.0) * math.sqrt(2.0) * math.sqrt(tau_f) * math.sqrt(w)
    real = beta_v * (y + 1.0)
    imaginary = (1.0 / 9.0) * beta_v * y * (2.0 * y + 9.0)
    return real, imaginary


@njit(cache=True)
def drag_of_rotation(w, beta_w, tau_f):
    """beta_w (3 + 3 x + x^2)/(3 (1 + x)), x = sqrt(i w tau_f).

    w: angular frequency [rad/s]
    beta_w: rotational drag coefficient [N m s]
    tau_f: r^2 rho_m/mu_m: vorticity diffuses over r [s]
    Returns real, imaginary.
    29 operations, 2 temporaries.
    """
    y = (1.0 / 2.0) * math.sqrt(2.0) * math.sqrt(tau_f) * math.sqrt(w)
    x0 = y * y
    x1 = beta_w / (2.0 * x0 + 2.0 * y + 1.0)
    real = (1.0 / 3.0) * x1 * (6.0 * x0 + 2.0 * (y * y * y) + 6.0 * y + 3.0)
    imaginary = (2.0 / 3.0) * x0 * x1 * (y + 1.0)
    return real, imaginary


@njit(cache=True)
def impedance(w, beta_v, tau_f, m):
    """Z(i w) = i w m + gamma(i w), the force by a unit of velocity.

    w: angular frequency [rad/s]
    beta_v: translational drag coefficient [kg/s]
    tau_f: r^2 rho_m/mu_m: vorticity diffuses over r [s]
    m: mass of the bead [kg]
    Returns real, imaginary.
    18 operations, 0 temporaries.
    """
    y = (1.0 / 2.0) * math.sqrt(2.0) * math.sqrt(tau_f) * math.sqrt(w)
    real = beta_v * (y + 1.0)
    imaginary = (1.0 / 9.0) * beta_v * y * (2.0 * y + 9.0) + m * w
    return real, imaginary


@njit(cache=True)
def noise(w, beta_v, tau_f, kT):
    """Two-sided spectrum of the force of the fluid's noise, 2 kT Re gamma, N^2/Hz.

    w: angular frequency [rad/s]
    beta_v: translational drag coefficient [kg/s]
    tau_f: r^2 rho_m/mu_m: vorticity diffuses over r [s]
    kT: Boltzmann's constant times temperature [J]
    Returns spectrum.
    13 operations, 0 temporaries.
    """
    y = (1.0 / 2.0) * math.sqrt(2.0) * math.sqrt(tau_f) * math.sqrt(w)
    spectrum = 2.0 * beta_v * kT * (y + 1.0)
    return spectrum


@njit(cache=True)
def position(w, beta_v, tau_f, m, k, kT):
    """One-sided spectrum of the position in a trap, m^2/Hz.

    w: angular frequency [rad/s]
    beta_v: translational drag coefficient [kg/s]
    tau_f: r^2 rho_m/mu_m: vorticity diffuses over r [s]
    m: mass of the bead [kg]
    k: stiffness of a trap [N/m]
    kT: Boltzmann's constant times temperature [J]
    Returns spectrum.
    30 operations, 1 temporaries.
    """
    y = (1.0 / 2.0) * math.sqrt(2.0) * math.sqrt(tau_f) * math.sqrt(w)
    x0 = y + 1.0
    spectrum = (
        4.0
        * beta_v
        * kT
        * x0
        / (
            (beta_v * beta_v) * (w * w) * (x0 * x0)
            + (
                (k - w * ((1.0 / 9.0) * beta_v * y * (2.0 * y + 9.0) + m * w))
                * (k - w * ((1.0 / 9.0) * beta_v * y * (2.0 * y + 9.0) + m * w))
            )
        )
    )
    return spectrum
