"""The force of one ray on the bead (3.14)-(3.26).

Made by `python -m derivation` from derivation/; do not edit.
SymPy 1.14.0. 988 operations, 154 temporaries.

The ray passes through the focus, the origin, along u. Forces in units of n_m P/c; moments
in n_m P/c times metres. Efficiencies hold for 0 <= S < 1 (and S < 1/n_mP^2).
"""

import math

from numba import njit

SOURCE_DIGEST = "a4a80437caf1e2608ffb231dde5020c50c10acbef26dba280f784913bbe97898"


@njit(cache=True, error_model="numpy")
def circular(S, n_mP):
    """Efficiencies of a ray (3.19-3.22), circular or unpolarised light: Q averaged over s and p.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, G.
    96 operations, 15 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    g = (1.0 - n_mP) * (n_mP + 1.0) / w_s
    rho_s = (1.0 - n_mP) * (n_mP + 1.0) / (w_s * w_s)
    rho_p = (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / (w_p * w_p)
    T_s = 4.0 * cos_alpha * cos_beta * n_mP / (w_s * w_s)
    T_p = 4.0 * cos_alpha * cos_beta * n_mP / (w_p * w_p)
    x0 = T_p * T_p
    x1 = 2.0 * S
    x2 = (g * g) * x1
    x3 = rho_p * rho_p
    x4 = 1.0 - x1
    x5 = cos_beta * cos_beta
    x6 = 4.0 * x5
    x7 = x3 * x6
    x8 = (1.0 / 2.0) / (x0 + x7)
    x9 = T_s * T_s
    x10 = rho_s * rho_s
    x11 = x10 * x6
    x12 = (1.0 / 2.0) / (x11 + x9)
    x13 = 8.0 * cos_alpha * x5
    x14 = 2.0 * g * (S * n_mP + cos_alpha * cos_beta)
    Q_sc = x12 * (x11 * (x10 * x4 + 1.0) + x2 * x9) + x8 * (x0 * x2 + x7 * (x3 * x4 + 1.0))
    G = x12 * (-(rho_s * rho_s * rho_s * rho_s) * x13 + x14 * x9) + x8 * (
        -(rho_p * rho_p * rho_p * rho_p) * x13 + x0 * x14
    )
    return Q_sc, G


@njit(cache=True, error_model="numpy")
def circular_rates(S, n_mP):
    """Efficiencies of a ray and their derivatives over S, circular or unpolarised light: Q averaged over s and p.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, dQ_sc, G, dG.
    336 operations, 65 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    g = (1.0 - n_mP) * (n_mP + 1.0) / w_s
    rho_s = (1.0 - n_mP) * (n_mP + 1.0) / (w_s * w_s)
    rho_p = (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / (w_p * w_p)
    T_s = 4.0 * cos_alpha * cos_beta * n_mP / (w_s * w_s)
    T_p = 4.0 * cos_alpha * cos_beta * n_mP / (w_p * w_p)
    dw_s = -(1.0 / 2.0) * (n_mP * n_mP) / cos_beta - (1.0 / 2.0) * n_mP / cos_alpha
    dw_p = -(1.0 / 2.0) * (n_mP * n_mP * n_mP) / cos_beta - (1.0 / 2.0) / cos_alpha
    dg = -dw_s * (1.0 - n_mP) * (n_mP + 1.0) / (w_s * w_s)
    drho_s = -2.0 * dw_s * (1.0 - n_mP) * (n_mP + 1.0) / (w_s * w_s * w_s)
    drho_p = -2.0 * dw_p * (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / (
        w_p * w_p * w_p
    ) + (1.0 - n_mP) * (n_mP + 1.0) * (-(n_mP * n_mP) - 1.0) / (w_p * w_p)
    dT_s = (
        -8.0 * cos_alpha * cos_beta * dw_s * n_mP / (w_s * w_s * w_s)
        - 2.0 * cos_alpha * (n_mP * n_mP * n_mP) / (cos_beta * (w_s * w_s))
        - 2.0 * cos_beta * n_mP / (cos_alpha * (w_s * w_s))
    )
    dT_p = (
        -8.0 * cos_alpha * cos_beta * dw_p * n_mP / (w_p * w_p * w_p)
        - 2.0 * cos_alpha * (n_mP * n_mP * n_mP) / (cos_beta * (w_p * w_p))
        - 2.0 * cos_beta * n_mP / (cos_alpha * (w_p * w_p))
    )
    x0 = T_p * T_p
    x1 = g * g
    x2 = 2.0 * S
    x3 = x1 * x2
    x4 = rho_p * rho_p
    x5 = 1.0 - x2
    x6 = x4 * x5 + 1.0
    x7 = cos_beta * cos_beta
    x8 = 4.0 * x7
    x9 = x4 * x8
    x10 = x0 * x3 + x6 * x9
    x11 = x0 + x9
    x12 = 1.0 / x11
    x13 = (1.0 / 2.0) * x12
    x14 = T_s * T_s
    x15 = rho_s * rho_s
    x16 = x15 * x5 + 1.0
    x17 = x15 * x8
    x18 = x14 * x3 + x16 * x17
    x19 = x14 + x17
    x20 = 1.0 / x19
    x21 = (1.0 / 2.0) * x20
    x22 = 2.0 * x1
    x23 = rho_p * rho_p * rho_p * rho_p
    x24 = 8.0 * x7
    x25 = x23 * x24
    x26 = -x25
    x27 = rho_s * rho_s * rho_s * rho_s
    x28 = x24 * x27
    x29 = -x28
    x30 = x0 * x12
    x31 = g * x2
    x32 = x14 * x20
    x33 = T_p * x12
    x34 = 1.0 / (x11 * x11)
    x35 = T_p * x34
    x36 = T_s * x20
    x37 = 1.0 / (x19 * x19)
    x38 = T_s * x37
    x39 = rho_p * rho_p * rho_p
    x40 = x24 * x5
    x41 = x10 * x34
    x42 = rho_p * x8
    x43 = rho_s * rho_s * rho_s
    x44 = x18 * x37
    x45 = rho_s * x8
    x46 = 4.0 * cos_beta
    x47 = x4 * x46
    x48 = x15 * x46
    x49 = (1.0 / 2.0) * (n_mP * n_mP) / cos_beta
    x50 = cos_alpha * cos_beta
    x51 = S * n_mP + x50
    x52 = x0 * x51
    x53 = 2.0 * g
    x54 = -cos_alpha * x25 + x52 * x53
    x55 = x14 * x51
    x56 = -cos_alpha * x28 + x53 * x55
    x57 = g * n_mP
    x58 = x51 * x53
    x59 = 16.0 * cos_alpha * x7
    x60 = x34 * x54
    x61 = x37 * x56
    x62 = cos_beta * x53
    x63 = cos_alpha * x53
    x64 = 16.0 * x50
    Q_sc = x10 * x13 + x18 * x21
    dQ_sc = (
        dT_p * (-x10 * x35 + x3 * x33)
        + dT_s * (-x18 * x38 + x3 * x36)
        + dg * (x30 * x31 + x31 * x32)
        + drho_p * ((1.0 / 2.0) * x12 * (rho_p * x24 * x6 + x39 * x40) - x41 * x42)
        + drho_s * ((1.0 / 2.0) * x20 * (rho_s * x16 * x24 + x40 * x43) - x44 * x45)
        + x13 * (x0 * x22 + x26)
        + x21 * (x14 * x22 + x29)
        - x49 * (x12 * x47 * x6 + x16 * x20 * x48 - x41 * x47 - x44 * x48)
    )
    G = x13 * x54 + x21 * x56
    dG = (
        dT_p * (x33 * x58 - x35 * x54)
        + dT_s * (x36 * x58 - x38 * x56)
        + dg * (x12 * x52 + x20 * x55)
        + drho_p * (-x12 * x39 * x59 - x42 * x60)
        + drho_s * (-x20 * x43 * x59 - x45 * x61)
        + x30 * x57
        + x32 * x57
        - x49
        * (
            (1.0 / 2.0) * x12 * (x0 * x63 - x23 * x64)
            + (1.0 / 2.0) * x20 * (x14 * x63 - x27 * x64)
            - x47 * x60
            - x48 * x61
        )
        + (1.0 / 2.0) * (-x13 * (x0 * x62 + x26) - x21 * (x14 * x62 + x29)) / cos_alpha
    )
    return Q_sc, dQ_sc, G, dG


@njit(cache=True, error_model="numpy")
def averaged_reflectance(S, n_mP):
    """Efficiencies of a ray (3.19-3.22), the thesis's: R averaged over s and p (3.17).

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, G.
    83 operations, 8 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    g = (1.0 - n_mP) * (n_mP + 1.0) / w_s
    rho_s = (1.0 - n_mP) * (n_mP + 1.0) / (w_s * w_s)
    rho_p = (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / (w_p * w_p)
    T_s = 4.0 * cos_alpha * cos_beta * n_mP / (w_s * w_s)
    T_p = 4.0 * cos_alpha * cos_beta * n_mP / (w_p * w_p)
    x0 = ((1.0 / 2.0) * T_p + (1.0 / 2.0) * T_s) * ((1.0 / 2.0) * T_p + (1.0 / 2.0) * T_s)
    x1 = cos_beta * cos_beta
    x2 = rho_p * rho_p
    x3 = rho_s * rho_s
    x4 = x1 * (2.0 * x2 + 2.0 * x3)
    x5 = 1.0 / (x0 + x4)
    x6 = 2.0 * S
    x7 = (1.0 / 2.0) * x2 + (1.0 / 2.0) * x3
    Q_sc = x5 * ((g * g) * x0 * x6 + x4 * (x7 * (1.0 - x6) + 1.0))
    G = x5 * (-8.0 * cos_alpha * x1 * (x7 * x7) + 2.0 * g * x0 * (S * n_mP + cos_alpha * cos_beta))
    return Q_sc, G


@njit(cache=True, error_model="numpy")
def averaged_reflectance_rates(S, n_mP):
    """Efficiencies of a ray and their derivatives over S, the thesis's: R averaged over s and p (3.17).

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, dQ_sc, G, dG.
    283 operations, 39 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    g = (1.0 - n_mP) * (n_mP + 1.0) / w_s
    rho_s = (1.0 - n_mP) * (n_mP + 1.0) / (w_s * w_s)
    rho_p = (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / (w_p * w_p)
    T_s = 4.0 * cos_alpha * cos_beta * n_mP / (w_s * w_s)
    T_p = 4.0 * cos_alpha * cos_beta * n_mP / (w_p * w_p)
    dw_s = -(1.0 / 2.0) * (n_mP * n_mP) / cos_beta - (1.0 / 2.0) * n_mP / cos_alpha
    dw_p = -(1.0 / 2.0) * (n_mP * n_mP * n_mP) / cos_beta - (1.0 / 2.0) / cos_alpha
    dg = -dw_s * (1.0 - n_mP) * (n_mP + 1.0) / (w_s * w_s)
    drho_s = -2.0 * dw_s * (1.0 - n_mP) * (n_mP + 1.0) / (w_s * w_s * w_s)
    drho_p = -2.0 * dw_p * (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / (
        w_p * w_p * w_p
    ) + (1.0 - n_mP) * (n_mP + 1.0) * (-(n_mP * n_mP) - 1.0) / (w_p * w_p)
    dT_s = (
        -8.0 * cos_alpha * cos_beta * dw_s * n_mP / (w_s * w_s * w_s)
        - 2.0 * cos_alpha * (n_mP * n_mP * n_mP) / (cos_beta * (w_s * w_s))
        - 2.0 * cos_beta * n_mP / (cos_alpha * (w_s * w_s))
    )
    dT_p = (
        -8.0 * cos_alpha * cos_beta * dw_p * n_mP / (w_p * w_p * w_p)
        - 2.0 * cos_alpha * (n_mP * n_mP * n_mP) / (cos_beta * (w_p * w_p))
        - 2.0 * cos_beta * n_mP / (cos_alpha * (w_p * w_p))
    )
    x0 = (1.0 / 2.0) * T_p + (1.0 / 2.0) * T_s
    x1 = x0 * x0
    x2 = cos_beta * cos_beta
    x3 = rho_p * rho_p
    x4 = rho_s * rho_s
    x5 = 2.0 * x3 + 2.0 * x4
    x6 = x2 * x5
    x7 = x1 + x6
    x8 = 1.0 / x7
    x9 = 2.0 * S
    x10 = g * g
    x11 = x1 * x10
    x12 = 1.0 - x9
    x13 = (1.0 / 2.0) * x3 + (1.0 / 2.0) * x4
    x14 = x12 * x13 + 1.0
    x15 = x11 * x9 + x14 * x6
    x16 = g * x1
    x17 = dg * x8
    x18 = x0 * x8
    x19 = 1.0 / (x7 * x7)
    x20 = -x0 * x19
    x21 = x10 * x18 * x9 + x15 * x20
    x22 = 2.0 * cos_beta * x5
    x23 = x15 * x19
    x24 = (1.0 / 2.0) * (n_mP * n_mP) / cos_beta
    x25 = x12 * x6
    x26 = 4.0 * x2
    x27 = x14 * x26
    x28 = x23 * x26
    x29 = x13 * x13
    x30 = 8.0 * x2 * x29
    x31 = cos_alpha * cos_beta
    x32 = S * n_mP + x31
    x33 = -cos_alpha * x30 + 2.0 * g * x1 * x32
    x34 = 2.0 * x32
    x35 = 16.0 * cos_alpha * x13 * x2 * x8
    x36 = x19 * x33
    x37 = x26 * x36
    x38 = g * x18 * x34 + x20 * x33
    Q_sc = x15 * x8
    dQ_sc = (
        4.0 * S * x16 * x17
        + dT_p * x21
        + dT_s * x21
        + drho_p * (-rho_p * x28 + x8 * (rho_p * x25 + rho_p * x27))
        + drho_s * (-rho_s * x28 + x8 * (rho_s * x25 + rho_s * x27))
        - x24 * (x14 * x22 * x8 - x22 * x23)
        + x8 * (2.0 * x11 + x6 * (-x3 - x4))
    )
    G = x33 * x8
    dG = (
        dT_p * x38
        + dT_s * x38
        + drho_p * (-rho_p * x35 - rho_p * x37)
        + drho_s * (-rho_s * x35 - rho_s * x37)
        + 2.0 * n_mP * x16 * x8
        + x1 * x17 * x34
        - x24 * (-x22 * x36 + x8 * (2.0 * cos_alpha * g * x1 - 16.0 * x29 * x31))
        - (1.0 / 2.0) * x8 * (2.0 * cos_beta * g * x1 - x30) / cos_alpha
    )
    return Q_sc, dQ_sc, G, dG


@njit(cache=True, error_model="numpy")
def total_reflection(S):
    """Efficiencies of a totally reflected ray: S >= 1/n_mP^2, n_mP > 1.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    Returns Q_sc, G.
    7 operations, 0 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    Q_sc = 2.0 * (cos_alpha * cos_alpha)
    G = -2.0 * cos_alpha
    return Q_sc, G


@njit(cache=True, error_model="numpy")
def total_reflection_rates(S):
    """Efficiencies of a totally reflected ray and their derivatives over S.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    Returns Q_sc, dQ_sc, G, dG.
    9 operations, 0 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    Q_sc = 2.0 * (cos_alpha * cos_alpha)
    dQ_sc = -2.0
    G = -2.0 * cos_alpha
    dG = 1.0 / cos_alpha
    return Q_sc, dQ_sc, G, dG


@njit(cache=True, error_model="numpy")
def impact(u1, u2, u3, q1, q2, q3, r):
    """n, from the bead's centre to the nearest point of the ray, and S = |n|^2/r^2.
    The ray hits the bead where S < 1, (3.8).

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    q1: position of the bead's centre along N1 [m]
    q2: position of the bead's centre along N2 [m]
    q3: position of the bead's centre along N3 [m]
    r: radius of the bead [m]
    Returns n1, n2, n3, S.
    28 operations, 0 temporaries.
    """
    n1 = -q1 + u1 * (q1 * u1 + q2 * u2 + q3 * u3)
    n2 = -q2 + u2 * (q1 * u1 + q2 * u2 + q3 * u3)
    n3 = -q3 + u3 * (q1 * u1 + q2 * u2 + q3 * u3)
    S = ((n1 * n1) + (n2 * n2) + (n3 * n3)) / (r * r)
    return n1, n2, n3, S


@njit(cache=True, error_model="numpy")
def force(u1, u2, u3, n1, n2, n3, r, Q_sc, G):
    """Force of the ray on the bead (3.24).

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    n1: from the bead's centre to the nearest point of the ray, along N1 [m]
    n2: from the bead's centre to the nearest point of the ray, along N2 [m]
    n3: from the bead's centre to the nearest point of the ray, along N3 [m]
    r: radius of the bead [m]
    Q_sc: scattering efficiency [1]
    G: gradient efficiency, -Q_gr/sqrt(S) [1]
    Returns F1, F2, F3.
    10 operations, 1 temporaries.
    """
    x0 = G / r
    F1 = Q_sc * u1 + n1 * x0
    F2 = Q_sc * u2 + n2 * x0
    F3 = Q_sc * u3 + n3 * x0
    return F1, F2, F3


@njit(cache=True, error_model="numpy")
def moment(u1, u2, u3, n1, n2, n3, cos_alpha, Q_sc, G):
    """Moment (3.25) of that force, applied where the ray enters the bead.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    n1: from the bead's centre to the nearest point of the ray, along N1 [m]
    n2: from the bead's centre to the nearest point of the ray, along N2 [m]
    n3: from the bead's centre to the nearest point of the ray, along N3 [m]
    cos_alpha: cosine of the angle of incidence [1]
    Q_sc: scattering efficiency [1]
    G: gradient efficiency, -Q_gr/sqrt(S) [1]
    Returns M1, M2, M3.
    14 operations, 1 temporaries.
    """
    x0 = G * cos_alpha + Q_sc
    M1 = x0 * (n2 * u3 - n3 * u2)
    M2 = x0 * (-n1 * u3 + n3 * u1)
    M3 = x0 * (n1 * u2 - n2 * u1)
    return M1, M2, M3


@njit(cache=True, error_model="numpy")
def gradient_of_force(u, n, r, Q_sc, dQ_sc, G, dG, out):
    """dF/dp (3.24), row by row; its derivatives over S come from the `_rates` functions.

    u: (3) u1, u2, u3
    n: (3) n1, n2, n3
    r: radius of the bead [m]
    Q_sc: scattering efficiency [1]
    dQ_sc: dQ_sc/dS [1]
    G: gradient efficiency, -Q_gr/sqrt(S) [1]
    dG: dG/dS [1]
    out: (3, 3) filled with the result.
    49 operations, 11 temporaries.
    """
    u1 = u[0]
    u2 = u[1]
    u3 = u[2]
    n1 = n[0]
    n2 = n[1]
    n3 = n[2]
    x0 = 1.0 / r
    x1 = G * x0
    x2 = dG * x0
    x3 = 2.0 / (r * r)
    x4 = x3 * (dQ_sc * u1 + n1 * x2)
    x5 = u1 * x1
    x6 = u2 * x5
    x7 = u3 * x5
    x8 = x3 * (dQ_sc * u2 + n2 * x2)
    x9 = u2 * u3 * x1
    x10 = x3 * (dQ_sc * u3 + n3 * x2)
    out[0, 0] = -n1 * x4 + x1 * ((u1 * u1) - 1.0)
    out[0, 1] = -n2 * x4 + x6
    out[0, 2] = -n3 * x4 + x7
    out[1, 0] = -n1 * x8 + x6
    out[1, 1] = -n2 * x8 + x1 * ((u2 * u2) - 1.0)
    out[1, 2] = -n3 * x8 + x9
    out[2, 0] = -n1 * x10 + x7
    out[2, 1] = -n2 * x10 + x9
    out[2, 2] = -n3 * x10 + x1 * ((u3 * u3) - 1.0)


@njit(cache=True, error_model="numpy")
def gradient_of_moment(u, n, r, cos_alpha, Q_sc, dQ_sc, G, dG, out):
    """dM/dp of the moment (3.25), row by row.

    u: (3) u1, u2, u3
    n: (3) n1, n2, n3
    r: radius of the bead [m]
    cos_alpha: cosine of the angle of incidence [1]
    Q_sc: scattering efficiency [1]
    dQ_sc: dQ_sc/dS [1]
    G: gradient efficiency, -Q_gr/sqrt(S) [1]
    dG: dG/dS [1]
    out: (3, 3) filled with the result.
    73 operations, 14 temporaries.
    """
    u1 = u[0]
    u2 = u[1]
    u3 = u[2]
    n1 = n[0]
    n2 = n[1]
    n3 = n[2]
    x0 = 2.0 * (-(1.0 / 2.0) * G / cos_alpha + cos_alpha * dG + dQ_sc) / (r * r)
    x1 = x0 * (n2 * u3 - n3 * u2)
    x2 = u2 * u2
    x3 = G * cos_alpha + Q_sc
    x4 = u3 * x3
    x5 = x2 - 1.0
    x6 = u3 * u3
    x7 = x6 - 1.0
    x8 = u2 * x3
    x9 = u1 * u1
    x10 = x9 - 1.0
    x11 = x0 * (-n1 * u3 + n3 * u1)
    x12 = u1 * x3
    x13 = x0 * (n1 * u2 - n2 * u1)
    out[0, 0] = -n1 * x1
    out[0, 1] = -n2 * x1 + u3 * x3 * x5 - x2 * x4
    out[0, 2] = -n3 * x1 + u2 * x3 * x6 - x7 * x8
    out[1, 0] = -n1 * x11 + u3 * x3 * x9 - x10 * x4
    out[1, 1] = -n2 * x11
    out[1, 2] = -n3 * x11 + u1 * x3 * x7 - x12 * x6
    out[2, 0] = -n1 * x13 + u2 * x10 * x3 - x8 * x9
    out[2, 1] = -n2 * x13 + u1 * x2 * x3 - x12 * x5
    out[2, 2] = -n3 * x13
