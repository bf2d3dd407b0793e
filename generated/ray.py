"""The force of one ray on the bead (3.14)-(3.26).

Made by `python -m derivation` from derivation/ray.py; do not edit.
SymPy 1.14.0. 2160 operations, 410 temporaries.

The ray passes through the focus, the origin, along u. Forces in units of n_m P/c;
moments in n_m P/c times metres. Efficiencies hold for 0 <= S < 1 (and S < 1/n_mP^2).
"""

import math

from numba import njit


@njit(cache=True, error_model="numpy", forceinline=True)
def circular(S, n_mP):
    """Efficiencies of a ray (3.19-3.22), circular or unpolarised light: Q averaged over s and p.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, G.
    102 operations, 14 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    q = cos_alpha * cos_beta
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    y = 1.0 / ((w_p * w_p) * (w_s * w_s))
    V_s = (w_p * w_p) * y
    V_p = (w_s * w_s) * y
    a = -S * ((n_mP * n_mP) + 1.0) + 1.0
    rho2_s = ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    rho2_p = (a * a) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    g = V_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    x0 = cos_alpha * cos_alpha
    x1 = n_mP * n_mP
    x2 = x0 * x1
    x3 = 4.0 * x2
    x4 = rho2_p + x3
    x5 = 8.0 * x2
    x6 = S * (g * g) * x5
    x7 = 4.0 * n_mP * q
    x8 = 2.0 * rho2_s
    x9 = rho2_s + x3
    x10 = V_p * rho2_p
    x11 = 1.0 / (x4 * (x5 + x8))
    x12 = 2.0 * cos_alpha
    x13 = -8.0 * g * x0 * x1 * (S * n_mP + q)
    Q_sc = x11 * (
        x4 * (V_s * rho2_s * (V_s * x0 * x8 + x7) + x6) + x9 * (x10 * (2.0 * x0 * x10 + x7) + x6)
    )
    G = x11 * (
        x4 * (-(V_s * V_s) * (rho2_s * rho2_s) * x12 - x13)
        + x9 * (-(V_p * V_p) * (rho2_p * rho2_p) * x12 - x13)
    )
    return Q_sc, G


@njit(cache=True, error_model="numpy", forceinline=True)
def circular_rates(S, n_mP):
    """Efficiencies of a ray and their derivatives over S, circular or unpolarised light: Q averaged over s and p.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, dQ_sc, G, dG.
    329 operations, 69 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    q = cos_alpha * cos_beta
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    y = 1.0 / ((w_p * w_p) * (w_s * w_s))
    V_s = (w_p * w_p) * y
    V_p = (w_s * w_s) * y
    a = -S * ((n_mP * n_mP) + 1.0) + 1.0
    rho2_s = ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    rho2_p = (a * a) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    g = V_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    dq = -1.0 / 2.0 * cos_alpha * (n_mP * n_mP) / cos_beta - 1.0 / 2.0 * cos_beta / cos_alpha
    dw_s = -1.0 / 2.0 * (n_mP * n_mP) / cos_beta - 1.0 / 2.0 * n_mP / cos_alpha
    dw_p = -1.0 / 2.0 * (n_mP * n_mP * n_mP) / cos_beta - (1.0 / 2.0) / cos_alpha
    dy = -2.0 * dw_p / ((w_p * w_p * w_p) * (w_s * w_s)) - 2.0 * dw_s / (
        (w_p * w_p) * (w_s * w_s * w_s)
    )
    dV_s = 2.0 * dw_p * w_p * y + dy * (w_p * w_p)
    dV_p = 2.0 * dw_s * w_s * y + dy * (w_s * w_s)
    da = -(n_mP * n_mP) - 1.0
    drho2_s = 0.0
    drho2_p = 2.0 * a * da * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    dg = V_s * dw_s * (1.0 - n_mP) * (n_mP + 1.0) + dV_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    x0 = cos_alpha * cos_alpha
    x1 = n_mP * n_mP
    x2 = x0 * x1
    x3 = 4.0 * x2
    x4 = rho2_p + x3
    x5 = 8.0 * x2
    x6 = g * g
    x7 = S * x6
    x8 = x5 * x7
    x9 = 4.0 * n_mP
    x10 = q * x9
    x11 = 2.0 * rho2_s
    x12 = x0 * x11
    x13 = V_s * x12 + x10
    x14 = V_s * x13
    x15 = rho2_s * x14 + x8
    x16 = rho2_s + x3
    x17 = rho2_p * x0
    x18 = 2.0 * V_p
    x19 = x10 + x17 * x18
    x20 = V_p * x19
    x21 = rho2_p * x20 + x8
    x22 = x15 * x4 + x16 * x21
    x23 = 1.0 / x4
    x24 = x11 + x5
    x25 = 1.0 / x24
    x26 = x23 * x25
    x27 = rho2_s * rho2_s
    x28 = V_s * x27
    x29 = dV_s * x25
    x30 = rho2_p * x16
    x31 = rho2_s * x4
    x32 = dq * x26
    x33 = rho2_p * rho2_p
    x34 = dV_p * x16 * x26
    x35 = g * x4
    x36 = 16.0 * S * x2
    x37 = g * x16
    x38 = dg * x26
    x39 = x5 * x6
    x40 = V_p * V_p
    x41 = 2.0 * x40
    x42 = x25 / (x4 * x4)
    x43 = x22 * x42
    x44 = V_s * V_s
    x45 = x23 / (x24 * x24)
    x46 = 2.0 * x45
    x47 = cos_alpha * x1
    x48 = 8.0 * x47
    x49 = 16.0 * x47
    x50 = x45 * x49
    x51 = x27 * x44
    x52 = 4.0 * cos_alpha
    x53 = x49 * x7
    x54 = x40 * x52
    x55 = (1.0 / 2.0) / cos_alpha
    x56 = 2.0 * x51
    x57 = S * n_mP + q
    x58 = -8.0 * g * x0 * x1 * x57
    x59 = cos_alpha * x56 + x58
    x60 = -x59
    x61 = x33 * x41
    x62 = cos_alpha * x61 + x58
    x63 = -x62
    x64 = x16 * x63 + x4 * x60
    x65 = 8.0 * (n_mP * n_mP * n_mP) * x0
    x66 = x5 * x57
    x67 = x42 * x64
    x68 = -16.0 * cos_alpha * g * x1 * x57
    Q_sc = x22 * x26
    dQ_sc = (
        drho2_p * (x26 * (x15 + x16 * (x17 * x41 + x20)) - x43)
        + drho2_s * (-x22 * x46 + x26 * (x21 + x4 * (x12 * x44 + x14)))
        + x26 * (x16 * x39 + x39 * x4)
        + x29 * (rho2_s * x13 + 2.0 * x0 * x28)
        + x32 * (V_p * x30 * x9 + V_s * x31 * x9)
        + x34 * (rho2_p * x19 + x0 * x18 * x33)
        + x38 * (x35 * x36 + x36 * x37)
        + x55
        * (
            x22 * x50
            - x26 * (x15 * x48 + x16 * (x33 * x54 + x53) + x21 * x48 + x4 * (x51 * x52 + x53))
            + x43 * x48
        )
    )
    G = x26 * x64
    dG = (
        -V_p * x33 * x34 * x52
        + drho2_p * (x26 * (-x30 * x54 - x59) - x67)
        + drho2_s * (x26 * (-x31 * x44 * x52 - x62) - x46 * x64)
        + x26 * (x35 * x65 + x37 * x65)
        - x28 * x29 * x52
        + x32 * (x35 * x5 + x37 * x5)
        + x38 * (x16 * x66 + x4 * x66)
        + x55
        * (
            -x26 * (x16 * (-x61 - x68) + x4 * (-x56 - x68) + x48 * x60 + x48 * x63)
            + x48 * x67
            + x50 * x64
        )
    )
    return Q_sc, dQ_sc, G, dG


@njit(cache=True, error_model="numpy", forceinline=True)
def averaged_reflectance(S, n_mP):
    """Efficiencies of a ray (3.19-3.22), the thesis's: R averaged over s and p (3.17).

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, G.
    91 operations, 9 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    q = cos_alpha * cos_beta
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    y = 1.0 / ((w_p * w_p) * (w_s * w_s))
    V_s = (w_p * w_p) * y
    V_p = (w_s * w_s) * y
    a = -S * ((n_mP * n_mP) + 1.0) + 1.0
    rho2_s = ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    rho2_p = (a * a) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    g = V_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    x0 = cos_alpha * cos_alpha
    x1 = (n_mP * n_mP) * x0
    x2 = V_p + V_s
    x3 = 2.0 * (V_p * V_p) * rho2_p + 2.0 * (V_s * V_s) * rho2_s
    x4 = x3 / (x2 * x2)
    x5 = 1.0 / (4.0 * x1 + x4)
    x6 = 8.0 * x1
    x7 = (1.0 / 2.0) * V_p + (1.0 / 2.0) * V_s
    x8 = x4 * x7
    Q_sc = x5 * (S * (g * g) * x6 + x8 * (4.0 * n_mP * q + 2.0 * x0 * x8))
    G = x5 * (
        -2.0 * cos_alpha * (x3 * x3) * (x7 * x7) / (x2 * x2 * x2 * x2) + g * x6 * (S * n_mP + q)
    )
    return Q_sc, G


@njit(cache=True, error_model="numpy", forceinline=True)
def averaged_reflectance_rates(S, n_mP):
    """Efficiencies of a ray and their derivatives over S, the thesis's: R averaged over s and p (3.17).

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, dQ_sc, G, dG.
    322 operations, 66 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    q = cos_alpha * cos_beta
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    y = 1.0 / ((w_p * w_p) * (w_s * w_s))
    V_s = (w_p * w_p) * y
    V_p = (w_s * w_s) * y
    a = -S * ((n_mP * n_mP) + 1.0) + 1.0
    rho2_s = ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    rho2_p = (a * a) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    g = V_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    dq = -1.0 / 2.0 * cos_alpha * (n_mP * n_mP) / cos_beta - 1.0 / 2.0 * cos_beta / cos_alpha
    dw_s = -1.0 / 2.0 * (n_mP * n_mP) / cos_beta - 1.0 / 2.0 * n_mP / cos_alpha
    dw_p = -1.0 / 2.0 * (n_mP * n_mP * n_mP) / cos_beta - (1.0 / 2.0) / cos_alpha
    dy = -2.0 * dw_p / ((w_p * w_p * w_p) * (w_s * w_s)) - 2.0 * dw_s / (
        (w_p * w_p) * (w_s * w_s * w_s)
    )
    dV_s = 2.0 * dw_p * w_p * y + dy * (w_p * w_p)
    dV_p = 2.0 * dw_s * w_s * y + dy * (w_s * w_s)
    da = -(n_mP * n_mP) - 1.0
    drho2_s = 0.0
    drho2_p = 2.0 * a * da * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    dg = V_s * dw_s * (1.0 - n_mP) * (n_mP + 1.0) + dV_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    x0 = cos_alpha * cos_alpha
    x1 = n_mP * n_mP
    x2 = x0 * x1
    x3 = V_p + V_s
    x4 = 1.0 / (x3 * x3)
    x5 = V_p * V_p
    x6 = 2.0 * x5
    x7 = V_s * V_s
    x8 = 2.0 * x7
    x9 = rho2_p * x6 + rho2_s * x8
    x10 = x4 * x9
    x11 = x10 + 4.0 * x2
    x12 = 1.0 / x11
    x13 = g * g
    x14 = S * x13
    x15 = 8.0 * x2
    x16 = (1.0 / 2.0) * V_p + (1.0 / 2.0) * V_s
    x17 = 4.0 * n_mP
    x18 = x0 * x10
    x19 = 2.0 * x16
    x20 = q * x17 + x18 * x19
    x21 = x10 * x20
    x22 = x14 * x15 + x16 * x21
    x23 = x12 * x15
    x24 = g * x12
    x25 = x10 * x16
    x26 = cos_alpha * x1
    x27 = 16.0 * x26
    x28 = 1.0 / (x3 * x3 * x3 * x3)
    x29 = x16 * x16
    x30 = x9 * x9
    x31 = x28 * x29 * x30
    x32 = 1.0 / (x11 * x11)
    x33 = x22 * x32
    x34 = 8.0 * x26
    x35 = (1.0 / 2.0) / cos_alpha
    x36 = x4 * x6
    x37 = x29 * x9
    x38 = x37 * x5
    x39 = 4.0 * x0 * x28
    x40 = x16 * x20
    x41 = x4 * x8
    x42 = x37 * x7
    x43 = 4.0 * x4
    x44 = V_p * rho2_p
    x45 = x43 * x44
    x46 = 1.0 / (x3 * x3 * x3)
    x47 = -2.0 * x46 * x9
    x48 = -x45 - x47
    x49 = x0 * x16
    x50 = 8.0 * x4 * x49
    x51 = x46 * x9
    x52 = x18 - 4.0 * x49 * x51
    x53 = (1.0 / 2.0) * x21 - 2.0 * x40 * x51
    x54 = V_s * rho2_s
    x55 = x43 * x54
    x56 = -x47 - x55
    x57 = S * n_mP + q
    x58 = g * x57
    x59 = 2.0 * x31
    x60 = -cos_alpha * x59 + x15 * x58
    x61 = cos_alpha * x28
    x62 = 8.0 * x12 * x61
    x63 = x32 * x60
    x64 = 16.0 * x37 * x61
    x65 = -8.0 * cos_alpha * x29 * x30 / (x3 * x3 * x3 * x3 * x3) + x19 * x30 * x61
    Q_sc = x12 * x22
    dQ_sc = (
        16.0 * S * dg * x2 * x24
        + dV_p * (x12 * (x25 * (x44 * x50 + x52) + x40 * x45 + x53) + x33 * x48)
        + dV_s * (x12 * (x25 * (x50 * x54 + x52) + x40 * x55 + x53) + x33 * x56)
        + dq * x12 * x17 * x25
        + drho2_p * (x12 * (x36 * x40 + x38 * x39) - x33 * x36)
        + drho2_s * (x12 * (x39 * x42 + x40 * x41) - x33 * x41)
        + x13 * x23
        + x35 * (-x12 * (4.0 * cos_alpha * x31 + x14 * x27) + x33 * x34)
    )
    G = x12 * x60
    dG = (
        dV_p * (x12 * (-x44 * x64 - x65) + x48 * x63)
        + dV_s * (x12 * (-x54 * x64 - x65) + x56 * x63)
        + dg * x23 * x57
        + dq * g * x23
        + drho2_p * (-x36 * x63 - x38 * x62)
        + drho2_s * (-x41 * x63 - x42 * x62)
        + 8.0 * (n_mP * n_mP * n_mP) * x0 * x24
        + x35 * (-x12 * (x27 * x58 - x59) + x34 * x63)
    )
    return Q_sc, dQ_sc, G, dG


@njit(cache=True, error_model="numpy", forceinline=True)
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


@njit(cache=True, error_model="numpy", forceinline=True)
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


@njit(cache=True, error_model="numpy", forceinline=True)
def cos_squared_beta(S, n_mP):
    """cos^2 of the angle of refraction (3.15); negative where all is reflected.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns cos_squared.
    7 operations, 0 temporaries.
    """
    cos_squared = (n_mP * n_mP) * (1.0 - S) + (1.0 - n_mP) * (n_mP + 1.0)
    return cos_squared


@njit(cache=True, error_model="numpy", forceinline=True)
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


@njit(cache=True, error_model="numpy", forceinline=True)
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


@njit(cache=True, error_model="numpy", forceinline=True)
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


@njit(cache=True, error_model="numpy", forceinline=True)
def gradient_of_force(u1, u2, u3, n1, n2, n3, r, Q_sc, dQ_sc, G, dG):
    """dF/dp (3.24), row by row; derivatives over S come from the `_rates` functions.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    n1: from the bead's centre to the nearest point of the ray, along N1 [m]
    n2: from the bead's centre to the nearest point of the ray, along N2 [m]
    n3: from the bead's centre to the nearest point of the ray, along N3 [m]
    r: radius of the bead [m]
    Q_sc: scattering efficiency [1]
    dQ_sc: dQ_sc/dS [1]
    G: gradient efficiency, -Q_gr/sqrt(S) [1]
    dG: dG/dS [1]
    Returns J11, J12, J13, J21, J22, J23, J31, J32, J33.
    49 operations, 11 temporaries.
    """
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
    J11 = -n1 * x4 + x1 * ((u1 * u1) - 1.0)
    J12 = -n2 * x4 + x6
    J13 = -n3 * x4 + x7
    J21 = -n1 * x8 + x6
    J22 = -n2 * x8 + x1 * ((u2 * u2) - 1.0)
    J23 = -n3 * x8 + x9
    J31 = -n1 * x10 + x7
    J32 = -n2 * x10 + x9
    J33 = -n3 * x10 + x1 * ((u3 * u3) - 1.0)
    return J11, J12, J13, J21, J22, J23, J31, J32, J33


@njit(cache=True, error_model="numpy", forceinline=True)
def gradient_of_moment(u1, u2, u3, n1, n2, n3, r, cos_alpha, Q_sc, dQ_sc, G, dG):
    """dM/dp of the moment (3.25), row by row.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    n1: from the bead's centre to the nearest point of the ray, along N1 [m]
    n2: from the bead's centre to the nearest point of the ray, along N2 [m]
    n3: from the bead's centre to the nearest point of the ray, along N3 [m]
    r: radius of the bead [m]
    cos_alpha: cosine of the angle of incidence [1]
    Q_sc: scattering efficiency [1]
    dQ_sc: dQ_sc/dS [1]
    G: gradient efficiency, -Q_gr/sqrt(S) [1]
    dG: dG/dS [1]
    Returns J11, J12, J13, J21, J22, J23, J31, J32, J33.
    73 operations, 14 temporaries.
    """
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
    J11 = -n1 * x1
    J12 = -n2 * x1 + u3 * x3 * x5 - x2 * x4
    J13 = -n3 * x1 + u2 * x3 * x6 - x7 * x8
    J21 = -n1 * x11 + u3 * x3 * x9 - x10 * x4
    J22 = -n2 * x11
    J23 = -n3 * x11 + u1 * x3 * x7 - x12 * x6
    J31 = -n1 * x13 + u2 * x10 * x3 - x8 * x9
    J32 = -n2 * x13 + u1 * x2 * x3 - x12 * x5
    J33 = -n3 * x13
    return J11, J12, J13, J21, J22, J23, J31, J32, J33


@njit(cache=True, error_model="numpy", forceinline=True)
def electric_field(u1, u2, u3, a_re, a_im, b_re, b_im):
    """Field of a ray, real and imaginary part, from the Jones vector in the pupil.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    a_re: real part of the field along x in the pupil [1]
    a_im: imaginary part of the field along x in the pupil [1]
    b_re: real part of the field along y in the pupil [1]
    b_im: imaginary part of the field along y in the pupil [1]
    Returns E1, E2, E3, H1, H2, H3.
    32 operations, 9 temporaries.
    """
    x0 = b_re * u2
    x1 = 1.0 / (u3 + 1.0)
    x2 = u1 * x1
    x3 = (u1 * u1) * x1
    x4 = a_re * u1
    x5 = u2 * x1
    x6 = (u2 * u2) * x1
    x7 = b_im * u2
    x8 = a_im * u1
    E1 = -a_re * x3 + a_re - x0 * x2
    E2 = -b_re * x6 + b_re - x4 * x5
    E3 = -x0 - x4
    H1 = -a_im * x3 + a_im - x2 * x7
    H2 = -b_im * x6 + b_im - x5 * x8
    H3 = -x7 - x8
    return E1, E2, E3, H1, H2, H3


@njit(cache=True, error_model="numpy", forceinline=True)
def polarisation(u1, u2, u3, n1, n2, n3, r, E1, E2, E3, H1, H2, H3):
    """sigma = S (f_s - f_p), the excess of s-polarised power.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    n1: from the bead's centre to the nearest point of the ray, along N1 [m]
    n2: from the bead's centre to the nearest point of the ray, along N2 [m]
    n3: from the bead's centre to the nearest point of the ray, along N3 [m]
    r: radius of the bead [m]
    E1: electric field of the ray, real part, along N1 [1]
    E2: electric field of the ray, real part, along N2 [1]
    E3: electric field of the ray, real part, along N3 [1]
    H1: its imaginary part, along N1 [1]
    H2: its imaginary part, along N2 [1]
    H3: its imaginary part, along N3 [1]
    Returns sigma.
    38 operations, 3 temporaries.
    """
    x0 = -n2 * u3 + n3 * u2
    x1 = n1 * u3 - n3 * u1
    x2 = -n1 * u2 + n2 * u1
    sigma = (
        -((E1 * n1 + E2 * n2 + E3 * n3) * (E1 * n1 + E2 * n2 + E3 * n3))
        + ((E1 * x0 + E2 * x1 + E3 * x2) * (E1 * x0 + E2 * x1 + E3 * x2))
        - ((H1 * n1 + H2 * n2 + H3 * n3) * (H1 * n1 + H2 * n2 + H3 * n3))
        + ((H1 * x0 + H2 * x1 + H3 * x2) * (H1 * x0 + H2 * x1 + H3 * x2))
    ) / (r * r)
    return sigma


@njit(cache=True, error_model="numpy", forceinline=True)
def gradient_of_polarisation(u1, u2, u3, n1, n2, n3, r, E1, E2, E3, H1, H2, H3):
    """dsigma/dp.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    n1: from the bead's centre to the nearest point of the ray, along N1 [m]
    n2: from the bead's centre to the nearest point of the ray, along N2 [m]
    n3: from the bead's centre to the nearest point of the ray, along N3 [m]
    r: radius of the bead [m]
    E1: electric field of the ray, real part, along N1 [1]
    E2: electric field of the ray, real part, along N2 [1]
    E3: electric field of the ray, real part, along N3 [1]
    H1: its imaginary part, along N1 [1]
    H2: its imaginary part, along N2 [1]
    H3: its imaginary part, along N3 [1]
    Returns dsigma1, dsigma2, dsigma3.
    87 operations, 11 temporaries.
    """
    x0 = 1.0 / (r * r)
    x1 = 2.0 * E1 * n1 + 2.0 * E2 * n2 + 2.0 * E3 * n3
    x2 = 2.0 * H1 * n1 + 2.0 * H2 * n2 + 2.0 * H3 * n3
    x3 = 2.0 * u3
    x4 = 2.0 * u2
    x5 = -n2 * u3 + n3 * u2
    x6 = n1 * u3 - n3 * u1
    x7 = -n1 * u2 + n2 * u1
    x8 = E1 * x5 + E2 * x6 + E3 * x7
    x9 = H1 * x5 + H2 * x6 + H3 * x7
    x10 = 2.0 * u1
    dsigma1 = -x0 * (-E1 * x1 - H1 * x2 + x8 * (E2 * x3 - E3 * x4) + x9 * (H2 * x3 - H3 * x4))
    dsigma2 = -x0 * (
        -E2 * x1 - H2 * x2 + x8 * (-E1 * x3 + 2.0 * E3 * u1) + x9 * (-H1 * x3 + 2.0 * H3 * u1)
    )
    dsigma3 = -x0 * (-E3 * x1 - H3 * x2 + x8 * (E1 * x4 - E2 * x10) + x9 * (H1 * x4 - H2 * x10))
    return dsigma1, dsigma2, dsigma3


@njit(cache=True, error_model="numpy", forceinline=True)
def split(S, n_mP):
    """Half the differences of the efficiencies of s and p, over S: what sigma multiplies.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns X, Y.
    169 operations, 38 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    q = cos_alpha * cos_beta
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    y = 1.0 / ((w_p * w_p) * (w_s * w_s))
    V_s = (w_p * w_p) * y
    V_p = (w_s * w_s) * y
    a = -S * ((n_mP * n_mP) + 1.0) + 1.0
    rho2_s = ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    rho2_p = (a * a) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    g = V_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    x0 = n_mP * q
    x1 = cos_alpha * cos_alpha
    x2 = V_p * x1
    x3 = rho2_p * x2
    x4 = n_mP * n_mP
    x5 = 4.0 * x4
    x6 = x1 * x5
    x7 = rho2_p + x6
    x8 = rho2_s * y
    x9 = S * x7
    x10 = x1 * x9
    x11 = y * y
    x12 = rho2_p * rho2_p
    x13 = rho2_s * rho2_s
    x14 = 2.0 * x13
    x15 = x12 * x14
    x16 = x11 * x15
    x17 = a + 1.0
    x18 = x4 + 1.0
    x19 = S * x8
    x20 = x14 * (x17 * x17) * (x18 * x18) * ((V_p - x19) * (V_p - x19))
    x21 = rho2_p * x19
    x22 = V_p * V_p
    x23 = x12 * x22
    x24 = n_mP * n_mP * n_mP
    x25 = 8.0 * q * x24
    x26 = cos_alpha * cos_alpha * cos_alpha * cos_alpha
    x27 = 8.0 * rho2_p * x4
    x28 = x22 * x27
    x29 = 4.0 * x19
    x30 = 16.0 * x4
    x31 = (S * S) * x11
    x32 = x15 * x31
    x33 = x13 * x27 * x31
    x34 = 2.0 * rho2_s * x17 * x18
    x35 = (1.0 / 2.0) / (x7 * (rho2_s + x6))
    x36 = cos_alpha * x9
    x37 = cos_alpha * g
    X = x35 * (
        -4.0 * rho2_p * x7 * x8 * (x0 + x3)
        + x10 * x16
        + x10 * x20
        + x34
        * (
            -S * (g * g) * x6
            - V_p * x21 * x26 * x30
            - 2.0 * x0 * x21
            - x1 * x19 * x25
            + x1 * x23
            + x1 * x32
            - x12 * x2 * x29
            + x2 * x25
            + x26 * x28
            + x26 * x33
        )
    )
    Y = x35 * (
        4.0 * V_p * cos_alpha * rho2_s * x12 * x7 * y
        - cos_alpha
        * x34
        * (
            4.0 * S * x24 * x37
            - V_p * x12 * x29
            + q * x37 * x5
            + x1 * x28
            + x1 * x33
            - x19 * x3 * x30
            + x23
            + x32
        )
        - x16 * x36
        - x20 * x36
    )
    return X, Y


@njit(cache=True, error_model="numpy", forceinline=True)
def split_rates(S, n_mP):
    """The same and their derivatives over S.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns X, dX, Y, dY.
    751 operations, 156 temporaries.
    """
    cos_alpha = math.sqrt(1.0 - S)
    cos_beta = math.sqrt((cos_alpha * cos_alpha) * (n_mP * n_mP) + (1.0 - n_mP) * (n_mP + 1.0))
    q = cos_alpha * cos_beta
    w_s = cos_alpha * n_mP + cos_beta
    w_p = cos_alpha + cos_beta * n_mP
    y = 1.0 / ((w_p * w_p) * (w_s * w_s))
    V_s = (w_p * w_p) * y
    V_p = (w_s * w_s) * y
    a = -S * ((n_mP * n_mP) + 1.0) + 1.0
    rho2_s = ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    rho2_p = (a * a) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    g = V_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    dq = -1.0 / 2.0 * cos_alpha * (n_mP * n_mP) / cos_beta - 1.0 / 2.0 * cos_beta / cos_alpha
    dw_s = -1.0 / 2.0 * (n_mP * n_mP) / cos_beta - 1.0 / 2.0 * n_mP / cos_alpha
    dw_p = -1.0 / 2.0 * (n_mP * n_mP * n_mP) / cos_beta - (1.0 / 2.0) / cos_alpha
    dy = -2.0 * dw_p / ((w_p * w_p * w_p) * (w_s * w_s)) - 2.0 * dw_s / (
        (w_p * w_p) * (w_s * w_s * w_s)
    )
    dV_s = 2.0 * dw_p * w_p * y + dy * (w_p * w_p)
    dV_p = 2.0 * dw_s * w_s * y + dy * (w_s * w_s)
    da = -(n_mP * n_mP) - 1.0
    drho2_s = 0.0
    drho2_p = 2.0 * a * da * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0))
    dg = V_s * dw_s * (1.0 - n_mP) * (n_mP + 1.0) + dV_s * w_s * (1.0 - n_mP) * (n_mP + 1.0)
    x0 = cos_alpha * cos_alpha
    x1 = n_mP * n_mP
    x2 = x0 * x1
    x3 = 4.0 * x2
    x4 = rho2_s + x3
    x5 = 1.0 / x4
    x6 = (1.0 / 2.0) * x5
    x7 = rho2_p + x3
    x8 = 1.0 / x7
    x9 = 4.0 * rho2_p
    x10 = n_mP * q
    x11 = rho2_p * x0
    x12 = V_p * x11
    x13 = x10 + x12
    x14 = rho2_s * y
    x15 = x13 * x14
    x16 = x15 * x9
    x17 = y * y
    x18 = S * x17
    x19 = rho2_s * rho2_s
    x20 = 2.0 * x19
    x21 = rho2_p * rho2_p
    x22 = x0 * x21
    x23 = x20 * x22
    x24 = x18 * x23
    x25 = x20 * x7
    x26 = S * x14
    x27 = V_p - x26
    x28 = x27 * x27
    x29 = a + 1.0
    x30 = x29 * x29
    x31 = x1 + 1.0
    x32 = x31 * x31
    x33 = x30 * x32
    x34 = x28 * x33
    x35 = x0 * x34
    x36 = S * x35
    x37 = 2.0 * x26
    x38 = x10 * x37
    x39 = V_p * V_p
    x40 = x21 * x39
    x41 = n_mP * n_mP * n_mP
    x42 = q * x41
    x43 = 8.0 * x0
    x44 = x42 * x43
    x45 = g * g
    x46 = x3 * x45
    x47 = 8.0 * x39
    x48 = cos_alpha * cos_alpha * cos_alpha * cos_alpha
    x49 = x1 * x48
    x50 = x47 * x49
    x51 = 4.0 * x21
    x52 = V_p * x51
    x53 = x26 * x52
    x54 = 16.0 * V_p
    x55 = rho2_p * x54
    x56 = x49 * x55
    x57 = S * S
    x58 = x17 * x57
    x59 = x21 * x58
    x60 = x20 * x59
    x61 = x19 * x58
    x62 = 8.0 * x61
    x63 = x49 * x62
    x64 = 2.0 * x31
    x65 = x64 * (
        -S * x46
        + V_p * x44
        - rho2_p * x38
        + rho2_p * x50
        + rho2_p * x63
        + x0 * x40
        - x0 * x53
        + x0 * x60
        - x26 * x44
        - x26 * x56
    )
    x66 = x29 * x65
    x67 = rho2_s * x66 - x16 * x7 + x24 * x7 + x25 * x36
    x68 = x67 * x8
    x69 = 8.0 * S
    x70 = rho2_s * x29 * x31 * x5 * x8
    x71 = dg * x70
    x72 = x7 * x9
    x73 = x6 * x8
    x74 = 4.0 * x7
    x75 = x14 * x74
    x76 = 2.0 * V_p - x37
    x77 = x0 * x33
    x78 = S * x25
    x79 = x26 * x51
    x80 = x26 * x49
    x81 = 16.0 * rho2_p
    x82 = x29 * x64
    x83 = rho2_s * x82
    x84 = dV_p * x73
    x85 = x13 * x72
    x86 = rho2_s * rho2_s * rho2_s
    x87 = x57 * x86
    x88 = x27 * x77
    x89 = x74 * x88
    x90 = S * rho2_s
    x91 = 2.0 * rho2_p * x10
    x92 = x52 * x90
    x93 = dy * x73
    x94 = x28 * x32 * (2.0 * a + 2.0)
    x95 = da * x73
    x96 = x17 * x7
    x97 = S * y
    x98 = x14 * x52
    x99 = x18 * x74
    x100 = 2.0 * x39
    x101 = 8.0 * x26
    x102 = 1.0 / (x7 * x7)
    x103 = x102 * x6
    x104 = 1.0 / (x4 * x4)
    x105 = (1.0 / 2.0) * x104
    x106 = x57 * y
    x107 = x52 * x97
    x108 = 4.0 * cos_alpha
    x109 = x1 * x108
    x110 = x102 * x109 * x5
    x111 = x104 * x109
    x112 = (cos_alpha * cos_alpha * cos_alpha) * x1
    x113 = x18 * x21
    x114 = 16.0 * x19
    x115 = x113 * x114
    x116 = V_p * x21
    x117 = cos_alpha * x1
    x118 = 32.0 * rho2_p * x117
    x119 = x21 * x96
    x120 = S * x108
    x121 = x120 * x19
    x122 = S * x34
    x123 = x114 * x122
    x124 = x34 * x7
    x125 = cos_alpha * x42
    x126 = 2.0 * cos_alpha
    x127 = V_p * x101
    x128 = rho2_p * x39
    x129 = 32.0 * x112
    x130 = rho2_p * x61
    x131 = (1.0 / 2.0) / cos_alpha
    x132 = x126 * x19
    x133 = x113 * x132
    x134 = x122 * x132
    x135 = 4.0 * g
    x136 = x135 * x41
    x137 = S * x136
    x138 = q * x1
    x139 = x135 * x138
    x140 = x2 * x47
    x141 = x2 * x55
    x142 = x2 * x62
    x143 = (
        cos_alpha * x137
        + cos_alpha * x139
        + rho2_p * x140
        + rho2_p * x142
        - x141 * x26
        + x40
        - x53
        + x60
    )
    x144 = cos_alpha * x143
    x145 = 4.0 * V_p * cos_alpha * rho2_s * x21 * x7 * y - x133 * x7 - x134 * x7 - x144 * x83
    x146 = x33 * x7
    x147 = S * x132
    x148 = x2 * x26
    x149 = cos_alpha * x83
    x150 = x19 * x51
    x151 = x2 * x81
    x152 = x151 * x19
    x153 = x145 * x8
    x154 = rho2_s * x120
    x155 = 16.0 * x117
    X = x6 * x68
    dX = (
        dq
        * x73
        * (
            -n_mP * x14 * x72
            + 2.0
            * rho2_s
            * x29
            * x31
            * (8.0 * V_p * x0 * x41 - n_mP * rho2_p * x37 - x26 * x41 * x43)
        )
        + drho2_p
        * (
            -x103 * x67
            + x73
            * (
                x11 * x19 * x99
                - x12 * x75
                - x15 * x74
                - x16
                + x20 * x36
                + x24
                + x83 * (x100 * x11 - x101 * x12 + 4.0 * x11 * x61 - x38 + x50 - x54 * x80 + x63)
            )
        )
        + drho2_s
        * (
            -x105 * x68
            + x73
            * (
                rho2_s * x22 * x99
                - x106 * x19 * x74 * x88
                + x35 * x74 * x90
                + x66
                + x83
                * (
                    16.0 * rho2_p * rho2_s * x1 * x17 * x48 * x57
                    + 4.0 * rho2_s * x0 * x17 * x21 * x57
                    - x0 * x107
                    - x44 * x97
                    - x56 * x97
                    - x91 * x97
                )
                - x85 * y
            )
        )
        - g * x2 * x69 * x71
        + x131
        * (
            x110 * x67
            + x111 * x68
            - x73
            * (
                -8.0 * cos_alpha * x116 * x14 * x7
                + x112 * x115
                + x112 * x123
                - x118 * x15
                + x119 * x121
                + x121 * x124
                + x83
                * (
                    -64.0 * V_p * rho2_p * x112 * x26
                    - cos_alpha * x127 * x21
                    + x108 * x19 * x59
                    - x117 * x45 * x69
                    - 16.0 * x125 * x26
                    + x125 * x54
                    + x126 * x40
                    + x128 * x129
                    + x129 * x130
                )
            )
        )
        + x73
        * (
            x23 * x96
            + x25 * x35
            + x83
            * (
                16.0 * S * rho2_p * x1 * x17 * x19 * x48
                + 4.0 * S * x0 * x17 * x19 * x21
                - x0 * x98
                - x14 * x44
                - x14 * x56
                - x14 * x91
                - x46
            )
            - x86 * x89 * x97
        )
        + x84
        * (
            -x22 * x75
            + x76 * x77 * x78
            + x83 * (2.0 * V_p * x0 * x21 - x0 * x79 + x44 + x56 - x80 * x81)
        )
        + x93
        * (
            4.0 * S * x0 * x19 * x21 * x7 * y
            + 2.0
            * rho2_s
            * x29
            * x31
            * (
                16.0 * rho2_p * x1 * x19 * x48 * x57 * y
                + 4.0 * x0 * x19 * x21 * x57 * y
                - x0 * x92
                - x44 * x90
                - x56 * x90
                - x90 * x91
            )
            - rho2_s * x85
            - x87 * x89
        )
        + x95 * (rho2_s * x65 + x0 * x78 * x94)
    )
    Y = x145 * x73
    dY = (
        -cos_alpha * x71 * (x108 * x138 + x120 * x41)
        - dq * g * x3 * x70
        + drho2_p
        * (
            -x103 * x145
            + x73
            * (
                8.0 * V_p * cos_alpha * rho2_p * rho2_s * x7 * y
                + 4.0 * V_p * cos_alpha * rho2_s * x21 * y
                - rho2_p * x121 * x96
                - x133
                - x134
                - x149 * (rho2_p * x100 - rho2_p * x127 + x140 + x142 - x148 * x54 + x61 * x9)
            )
        )
        + drho2_s
        * (
            -x105 * x153
            + x73
            * (
                4.0 * V_p * cos_alpha * x21 * x7 * y
                + 4.0 * cos_alpha * x19 * x27 * x30 * x32 * x57 * x7 * y
                - x119 * x154
                - x124 * x154
                - x144 * x82
                - x149 * (rho2_s * x151 * x58 + 4.0 * rho2_s * x59 - x107 - x141 * x97)
            )
        )
        + x131
        * (
            x110 * x145
            + x111 * x153
            - x73
            * (
                32.0 * V_p * rho2_s * x0 * x1 * x21 * y
                + 4.0 * V_p * rho2_s * x21 * x7 * y
                - x113 * x25
                - x115 * x2
                - x122 * x25
                - x123 * x2
                - x143 * x83
                - x149 * (-V_p * x118 * x26 + x128 * x155 + x130 * x155 + x137 + x139)
            )
        )
        + x73
        * (
            4.0 * S * cos_alpha * x27 * x30 * x32 * x7 * x86 * y
            - x119 * x132
            - x124 * x132
            - x149 * (cos_alpha * x136 - x14 * x141 + x150 * x18 + x152 * x18 - x98)
        )
        + x84
        * (
            4.0 * cos_alpha * rho2_s * x21 * x7 * y
            - x146 * x147 * x76
            - x149 * (16.0 * V_p * rho2_p * x0 * x1 + 2.0 * V_p * x21 - x148 * x81 - x79)
        )
        + x93
        * (
            rho2_s * x108 * x116 * x7
            + x108 * x146 * x27 * x87
            - x121 * x21 * x7 * y
            - x149 * (x106 * x150 + x106 * x152 - x141 * x90 - x92)
        )
        + x95 * (-rho2_s * x144 * x64 - x147 * x7 * x94)
    )
    return X, dX, Y, dY


@njit(cache=True, error_model="numpy", forceinline=True)
def turning_force(u1, u2, u3, n1, n2, n3, r, X, Y, dsigma1, dsigma2, dsigma3):
    """What the turning plane of incidence adds to dF/dp.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    n1: from the bead's centre to the nearest point of the ray, along N1 [m]
    n2: from the bead's centre to the nearest point of the ray, along N2 [m]
    n3: from the bead's centre to the nearest point of the ray, along N3 [m]
    r: radius of the bead [m]
    X: (Q_sc of s less that of p)/(2 S) [1]
    Y: (G of s less that of p)/(2 S) [1]
    dsigma1: dsigma/dp, along N1 [1/m]
    dsigma2: dsigma/dp, along N2 [1/m]
    dsigma3: dsigma/dp, along N3 [1/m]
    Returns J11, J12, J13, J21, J22, J23, J31, J32, J33.
    19 operations, 4 temporaries.
    """
    x0 = Y / r
    x1 = X * u1 + n1 * x0
    x2 = X * u2 + n2 * x0
    x3 = X * u3 + n3 * x0
    J11 = dsigma1 * x1
    J12 = dsigma2 * x1
    J13 = dsigma3 * x1
    J21 = dsigma1 * x2
    J22 = dsigma2 * x2
    J23 = dsigma3 * x2
    J31 = dsigma1 * x3
    J32 = dsigma2 * x3
    J33 = dsigma3 * x3
    return J11, J12, J13, J21, J22, J23, J31, J32, J33


@njit(cache=True, error_model="numpy", forceinline=True)
def turning_moment(u1, u2, u3, n1, n2, n3, cos_alpha, X, Y, dsigma1, dsigma2, dsigma3):
    """What the turning plane of incidence adds to dM/dp.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    n1: from the bead's centre to the nearest point of the ray, along N1 [m]
    n2: from the bead's centre to the nearest point of the ray, along N2 [m]
    n3: from the bead's centre to the nearest point of the ray, along N3 [m]
    cos_alpha: cosine of the angle of incidence [1]
    X: (Q_sc of s less that of p)/(2 S) [1]
    Y: (G of s less that of p)/(2 S) [1]
    dsigma1: dsigma/dp, along N1 [1/m]
    dsigma2: dsigma/dp, along N2 [1/m]
    dsigma3: dsigma/dp, along N3 [1/m]
    Returns J11, J12, J13, J21, J22, J23, J31, J32, J33.
    23 operations, 4 temporaries.
    """
    x0 = X + Y * cos_alpha
    x1 = x0 * (n2 * u3 - n3 * u2)
    x2 = x0 * (-n1 * u3 + n3 * u1)
    x3 = x0 * (n1 * u2 - n2 * u1)
    J11 = dsigma1 * x1
    J12 = dsigma2 * x1
    J13 = dsigma3 * x1
    J21 = dsigma1 * x2
    J22 = dsigma2 * x2
    J23 = dsigma3 * x2
    J31 = dsigma1 * x3
    J32 = dsigma2 * x3
    J33 = dsigma3 * x3
    return J11, J12, J13, J21, J22, J23, J31, J32, J33
