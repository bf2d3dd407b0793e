"""The force of one ray on the bead (3.14)-(3.26).

Made by `python -m derivation` from derivation/ray.py; do not edit.
SymPy 1.14.0. 1006 operations, 154 temporaries.

The ray passes through the focus, the origin, along u. Forces in units of n_m P/c;
moments in n_m P/c times metres. Efficiencies hold for 0 <= S < 1 (and S < 1/n_mP^2).
"""

import math

from numba import njit

SOURCE_DIGEST = "717019661e359fb9b329fe99a52017708189d199d25bfeee4e876da7a3b75f0f"


@njit(cache=True, error_model="numpy")
def circular(S, n_mP):
    """Efficiencies of a ray (3.19-3.22), circular or unpolarised light: Q averaged over s and p.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, G.
    97 operations, 16 temporaries.
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
    x1 = 2.0 * x0
    x2 = S * (g * g)
    x3 = rho_p * rho_p
    x4 = 2.0 * (cos_alpha * cos_alpha)
    x5 = cos_beta * cos_beta
    x6 = 4.0 * x5
    x7 = x3 * x6
    x8 = (1.0 / 2.0) / (x0 + x7)
    x9 = T_s * T_s
    x10 = 2.0 * x9
    x11 = rho_s * rho_s
    x12 = x11 * x6
    x13 = (1.0 / 2.0) / (x12 + x9)
    x14 = 8.0 * cos_alpha * x5
    x15 = g * (S * n_mP + cos_alpha * cos_beta)
    Q_sc = x13 * (x10 * x2 + x12 * (T_s + x11 * x4)) + x8 * (x1 * x2 + x7 * (T_p + x3 * x4))
    G = x13 * (-(rho_s * rho_s * rho_s * rho_s) * x14 + x10 * x15) + x8 * (
        -(rho_p * rho_p * rho_p * rho_p) * x14 + x1 * x15
    )
    return Q_sc, G


@njit(cache=True, error_model="numpy")
def circular_rates(S, n_mP):
    """Efficiencies of a ray and their derivatives over S, circular or unpolarised light: Q averaged over s and p.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, dQ_sc, G, dG.
    344 operations, 65 temporaries.
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
    dw_s = -1.0 / 2.0 * (n_mP * n_mP) / cos_beta - 1.0 / 2.0 * n_mP / cos_alpha
    dw_p = -1.0 / 2.0 * (n_mP * n_mP * n_mP) / cos_beta - (1.0 / 2.0) / cos_alpha
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
    x0 = g * g
    x1 = S * x0
    x2 = T_p * T_p
    x3 = 2.0 * x2
    x4 = rho_p * rho_p
    x5 = cos_alpha * cos_alpha
    x6 = 2.0 * x5
    x7 = T_p + x4 * x6
    x8 = cos_beta * cos_beta
    x9 = 4.0 * x8
    x10 = x4 * x9
    x11 = x1 * x3 + x10 * x7
    x12 = x10 + x2
    x13 = 1.0 / x12
    x14 = (1.0 / 2.0) * x13
    x15 = T_s * T_s
    x16 = 2.0 * x15
    x17 = rho_s * rho_s
    x18 = T_s + x17 * x6
    x19 = x17 * x9
    x20 = x1 * x16 + x18 * x19
    x21 = x15 + x19
    x22 = 1.0 / x21
    x23 = (1.0 / 2.0) * x22
    x24 = x13 * x2
    x25 = x15 * x22
    x26 = 2.0 * S * g
    x27 = rho_p * rho_p * rho_p * rho_p
    x28 = 8.0 * x8
    x29 = x27 * x28
    x30 = cos_alpha * x29
    x31 = rho_s * rho_s * rho_s * rho_s
    x32 = x28 * x31
    x33 = cos_alpha * x32
    x34 = (1.0 / 2.0) / cos_alpha
    x35 = 4.0 * x1
    x36 = 1.0 / (x12 * x12)
    x37 = T_p * x36
    x38 = 1.0 / (x21 * x21)
    x39 = T_s * x38
    x40 = rho_p * rho_p * rho_p
    x41 = 16.0 * x8
    x42 = x41 * x5
    x43 = x11 * x36
    x44 = rho_p * x9
    x45 = rho_s * rho_s * rho_s
    x46 = x20 * x38
    x47 = rho_s * x9
    x48 = 4.0 * cos_beta
    x49 = x4 * x48
    x50 = x17 * x48
    x51 = (1.0 / 2.0) * (n_mP * n_mP) / cos_beta
    x52 = cos_alpha * cos_beta
    x53 = S * n_mP + x52
    x54 = g * x53
    x55 = x3 * x54 - x30
    x56 = x16 * x54 - x33
    x57 = g * n_mP
    x58 = 2.0 * x54
    x59 = cos_alpha * x41
    x60 = x36 * x55
    x61 = x38 * x56
    x62 = cos_beta * g
    x63 = cos_alpha * g
    x64 = 16.0 * x52
    Q_sc = x11 * x14 + x20 * x23
    dQ_sc = (
        dT_p * (-x11 * x37 + (1.0 / 2.0) * x13 * (T_p * x35 + x10))
        + dT_s * (-x20 * x39 + (1.0 / 2.0) * x22 * (T_s * x35 + x19))
        + dg * (x24 * x26 + x25 * x26)
        + drho_p * ((1.0 / 2.0) * x13 * (rho_p * x28 * x7 + x40 * x42) - x43 * x44)
        + drho_s * ((1.0 / 2.0) * x22 * (rho_s * x18 * x28 + x42 * x45) - x46 * x47)
        + x0 * x24
        + x0 * x25
        + x34 * (-x13 * x30 - x22 * x33)
        - x51 * (x13 * x49 * x7 + x18 * x22 * x50 - x43 * x49 - x46 * x50)
    )
    G = x14 * x55 + x23 * x56
    dG = (
        dT_p * (T_p * x13 * x58 - x37 * x55)
        + dT_s * (T_s * x22 * x58 - x39 * x56)
        + dg * (x24 * x53 + x25 * x53)
        + drho_p * (-x13 * x40 * x59 - x44 * x60)
        + drho_s * (-x22 * x45 * x59 - x47 * x61)
        + x24 * x57
        + x25 * x57
        + x34 * (-x14 * (-x29 + x3 * x62) - x23 * (x16 * x62 - x32))
        - x51
        * (
            (1.0 / 2.0) * x13 * (-x27 * x64 + x3 * x63)
            + (1.0 / 2.0) * x22 * (x16 * x63 - x31 * x64)
            - x49 * x60
            - x50 * x61
        )
    )
    return Q_sc, dQ_sc, G, dG


@njit(cache=True, error_model="numpy")
def averaged_reflectance(S, n_mP):
    """Efficiencies of a ray (3.19-3.22), the thesis's: R averaged over s and p (3.17).

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, G.
    84 operations, 7 temporaries.
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
    x0 = (1.0 / 2.0) * T_p + (1.0 / 2.0) * T_s
    x1 = x0 * x0
    x2 = cos_beta * cos_beta
    x3 = rho_p * rho_p
    x4 = rho_s * rho_s
    x5 = x2 * (2.0 * x3 + 2.0 * x4)
    x6 = 1.0 / (x1 + x5)
    Q_sc = x6 * (2.0 * S * (g * g) * x1 + x5 * ((cos_alpha * cos_alpha) * (x3 + x4) + x0))
    G = x6 * (
        -8.0
        * cos_alpha
        * x2
        * (((1.0 / 2.0) * x3 + (1.0 / 2.0) * x4) * ((1.0 / 2.0) * x3 + (1.0 / 2.0) * x4))
        + 2.0 * g * x1 * (S * n_mP + cos_alpha * cos_beta)
    )
    return Q_sc, G


@njit(cache=True, error_model="numpy")
def averaged_reflectance_rates(S, n_mP):
    """Efficiencies of a ray and their derivatives over S, the thesis's: R averaged over s and p (3.17).

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, dQ_sc, G, dG.
    284 operations, 39 temporaries.
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
    dw_s = -1.0 / 2.0 * (n_mP * n_mP) / cos_beta - 1.0 / 2.0 * n_mP / cos_alpha
    dw_p = -1.0 / 2.0 * (n_mP * n_mP * n_mP) / cos_beta - (1.0 / 2.0) / cos_alpha
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
    x9 = 2.0 * x1
    x10 = g * g
    x11 = S * x10
    x12 = cos_alpha * cos_alpha
    x13 = x3 + x4
    x14 = x0 + x12 * x13
    x15 = x11 * x9 + x14 * x6
    x16 = x8 * x9
    x17 = g * x8
    x18 = 2.0 * x0
    x19 = 1.0 / (x7 * x7)
    x20 = -x0 * x19
    x21 = x15 * x20 + x8 * (x11 * x18 + (1.0 / 2.0) * x6)
    x22 = 2.0 * x12 * x6
    x23 = 4.0 * x2
    x24 = x14 * x23
    x25 = x15 * x19
    x26 = x23 * x25
    x27 = 2.0 * cos_beta * x5
    x28 = (1.0 / 2.0) * (n_mP * n_mP) / cos_beta
    x29 = (1.0 / 2.0) * x3 + (1.0 / 2.0) * x4
    x30 = x29 * x29
    x31 = 8.0 * x2 * x30
    x32 = cos_alpha * cos_beta
    x33 = S * n_mP + x32
    x34 = -cos_alpha * x31 + 2.0 * g * x1 * x33
    x35 = 16.0 * cos_alpha * x2 * x29 * x8
    x36 = x19 * x34
    x37 = x23 * x36
    x38 = x17 * x18 * x33 + x20 * x34
    Q_sc = x15 * x8
    dQ_sc = (
        4.0 * S * dg * x1 * x17
        + dT_p * x21
        + dT_s * x21
        + drho_p * (-rho_p * x26 + x8 * (rho_p * x22 + rho_p * x24))
        + drho_s * (-rho_s * x26 + x8 * (rho_s * x22 + rho_s * x24))
        + x10 * x16
        - x13 * x6 * x8
        - x28 * (x14 * x27 * x8 - x25 * x27)
    )
    G = x34 * x8
    dG = (
        dT_p * x38
        + dT_s * x38
        + dg * x16 * x33
        + drho_p * (-rho_p * x35 - rho_p * x37)
        + drho_s * (-rho_s * x35 - rho_s * x37)
        + g * n_mP * x16
        - x28 * (-x27 * x36 + x8 * (2.0 * cos_alpha * g * x1 - 16.0 * x30 * x32))
        - 1.0 / 2.0 * x8 * (2.0 * cos_beta * g * x1 - x31) / cos_alpha
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
def cos_squared_beta(S, n_mP):
    """cos^2 of the angle of refraction (3.15); negative where all is reflected.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns cos_squared.
    7 operations, 0 temporaries.
    """
    cos_squared = (n_mP * n_mP) * (1.0 - S) + (1.0 - n_mP) * (n_mP + 1.0)
    return cos_squared


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
    """dF/dp (3.24), row by row; derivatives over S come from the `_rates` functions.

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
    x0 = 2.0 * (-1.0 / 2.0 * G / cos_alpha + cos_alpha * dG + dQ_sc) / (r * r)
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
