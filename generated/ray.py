"""The force of one ray on the bead (3.14)-(3.26).

Made by `python -m derivation` from derivation/ray.py; do not edit.
SymPy 1.14.0. 1444 operations, 166 temporaries.

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
    79 operations, 0 temporaries.
    """
    C = 1.0 - S
    cos_alpha = math.sqrt(C)
    b = math.sqrt(C + (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP))
    q = b * cos_alpha
    w_s = b + cos_alpha
    w_p = b * (n_mP * n_mP) + cos_alpha
    y = 1.0 / (w_p * w_s)
    y_s = w_p * y
    y_p = w_s * y
    g = (1.0 / 2.0) * y_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    a = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / n_mP
    X_s = g * g
    X_p = (a * a) * (y_p * y_p)
    D_s = C + (1.0 / 4.0) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0)) / (
        n_mP * n_mP
    )
    D_p = C + (a * a)
    t_s = D_p * X_s
    t_p = D_s * X_p
    scale = 2.0 * (n_mP * n_mP) / (D_p * D_s)
    e = 2.0 * cos_alpha * (X_p * t_p + X_s * t_s)
    z = C * g * (D_p + D_s)
    Q_sc = scale * (2.0 * S * g * z + cos_alpha * e + q * (t_p + t_s))
    G = scale * (-e + z * (S + q))
    return Q_sc, G


@njit(cache=True, error_model="numpy", forceinline=True)
def circular_rates(S, n_mP):
    """Efficiencies of a ray and their derivatives over S, circular or unpolarised light: Q averaged over s and p.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, dQ_sc, G, dG.
    214 operations, 10 temporaries.
    """
    C = 1.0 - S
    cos_alpha = math.sqrt(C)
    b = math.sqrt(C + (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP))
    q = b * cos_alpha
    w_s = b + cos_alpha
    w_p = b * (n_mP * n_mP) + cos_alpha
    y = 1.0 / (w_p * w_s)
    y_s = w_p * y
    y_p = w_s * y
    g = (1.0 / 2.0) * y_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    a = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / n_mP
    X_s = g * g
    X_p = (a * a) * (y_p * y_p)
    D_s = C + (1.0 / 4.0) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0)) / (
        n_mP * n_mP
    )
    D_p = C + (a * a)
    t_s = D_p * X_s
    t_p = D_s * X_p
    scale = 2.0 * (n_mP * n_mP) / (D_p * D_s)
    e = 2.0 * cos_alpha * (X_p * t_p + X_s * t_s)
    z = C * g * (D_p + D_s)
    h = (1.0 / 2.0) / q
    dq = -h * ((b * b) + (cos_alpha * cos_alpha))
    dw_s = -h * (b + cos_alpha)
    dw_p = -h * (b + cos_alpha * (n_mP * n_mP))
    dy_s = -dw_s * (y_s * y_s)
    dy_p = -dw_p * (y_p * y_p)
    dg = (1.0 / 2.0) * dy_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    da = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-(n_mP * n_mP) - 1.0) / n_mP
    dX_s = 2.0 * dg * g
    dX_p = 2.0 * (a * a) * dy_p * y_p + 2.0 * a * da * (y_p * y_p)
    dD_s = -1.0
    dD_p = 2.0 * a * da - 1.0
    dt_s = D_p * dX_s + X_s * dD_p
    dt_p = D_s * dX_p + X_p * dD_s
    dscale = -1.0 / 2.0 * (scale * scale) * (D_p * dD_s + D_s * dD_p) / (n_mP * n_mP)
    de = (
        2.0 * X_p * cos_alpha * dt_p
        + 2.0 * X_s * cos_alpha * dt_s
        - b * h * (2.0 * X_p * t_p + 2.0 * X_s * t_s)
        + 2.0 * cos_alpha * dX_p * t_p
        + 2.0 * cos_alpha * dX_s * t_s
    )
    dz = C * dD_p * g + C * dD_s * g + C * dg * (D_p + D_s) - g * (D_p + D_s)
    x0 = t_p + t_s
    x1 = 2.0 * g
    x2 = S * x1
    x3 = cos_alpha * e + q * x0 + x2 * z
    x4 = de * scale
    x5 = q * scale
    x6 = scale * z
    x7 = dz * scale
    x8 = S + q
    x9 = -e + x8 * z
    Q_sc = scale * x3
    dQ_sc = (
        2.0 * S * dg * x6
        - b * e * h * scale
        + cos_alpha * x4
        + dq * scale * x0
        + dscale * x3
        + dt_p * x5
        + dt_s * x5
        + x1 * x6
        + x2 * x7
    )
    G = scale * x9
    dG = dq * x6 + dscale * x9 - x4 + x6 + x7 * x8
    return Q_sc, dQ_sc, G, dG


@njit(cache=True, error_model="numpy", forceinline=True)
def averaged_reflectance(S, n_mP):
    """Efficiencies of a ray (3.19-3.22), the thesis's: R averaged over s and p (3.17).

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, G.
    77 operations, 0 temporaries.
    """
    C = 1.0 - S
    cos_alpha = math.sqrt(C)
    b = math.sqrt(C + (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP))
    q = b * cos_alpha
    w_s = b + cos_alpha
    w_p = b * (n_mP * n_mP) + cos_alpha
    y = 1.0 / (w_p * w_s)
    y_s = w_p * y
    y_p = w_s * y
    g = (1.0 / 2.0) * y_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    a = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / n_mP
    X_s = g * g
    X_p = (a * a) * (y_p * y_p)
    V_s = y_s * y_s
    V_p = (n_mP * n_mP) * (y_p * y_p)
    V = V_p + V_s
    N = V_p * X_p + V_s * X_s
    scale = 4.0 * (n_mP * n_mP) / (C * (V * V) + 2.0 * N * (n_mP * n_mP))
    e = 2.0 * (N * N) * cos_alpha
    z = C * (V * V) * g
    Q_sc = scale * (N * V * q + 2.0 * S * g * z + cos_alpha * e)
    G = scale * (-e + z * (S + q))
    return Q_sc, G


@njit(cache=True, error_model="numpy", forceinline=True)
def averaged_reflectance_rates(S, n_mP):
    """Efficiencies of a ray and their derivatives over S, the thesis's: R averaged over s and p (3.17).

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns Q_sc, dQ_sc, G, dG.
    208 operations, 10 temporaries.
    """
    C = 1.0 - S
    cos_alpha = math.sqrt(C)
    b = math.sqrt(C + (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP))
    q = b * cos_alpha
    w_s = b + cos_alpha
    w_p = b * (n_mP * n_mP) + cos_alpha
    y = 1.0 / (w_p * w_s)
    y_s = w_p * y
    y_p = w_s * y
    g = (1.0 / 2.0) * y_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    a = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / n_mP
    X_s = g * g
    X_p = (a * a) * (y_p * y_p)
    V_s = y_s * y_s
    V_p = (n_mP * n_mP) * (y_p * y_p)
    V = V_p + V_s
    N = V_p * X_p + V_s * X_s
    scale = 4.0 * (n_mP * n_mP) / (C * (V * V) + 2.0 * N * (n_mP * n_mP))
    e = 2.0 * (N * N) * cos_alpha
    z = C * (V * V) * g
    h = (1.0 / 2.0) / q
    dq = -h * ((b * b) + (cos_alpha * cos_alpha))
    dw_s = -h * (b + cos_alpha)
    dw_p = -h * (b + cos_alpha * (n_mP * n_mP))
    dy_s = -dw_s * (y_s * y_s)
    dy_p = -dw_p * (y_p * y_p)
    dg = (1.0 / 2.0) * dy_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    da = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-(n_mP * n_mP) - 1.0) / n_mP
    dX_s = 2.0 * dg * g
    dX_p = 2.0 * (a * a) * dy_p * y_p + 2.0 * a * da * (y_p * y_p)
    dV_s = 2.0 * dy_s * y_s
    dV_p = 2.0 * dy_p * (n_mP * n_mP) * y_p
    dV = dV_p + dV_s
    dN = V_p * dX_p + V_s * dX_s + X_p * dV_p + X_s * dV_s
    dscale = (
        -1.0
        / 4.0
        * (scale * scale)
        * (2.0 * C * V * dV - (V * V) + 2.0 * dN * (n_mP * n_mP))
        / (n_mP * n_mP)
    )
    de = -2.0 * (N * N) * b * h + 4.0 * N * cos_alpha * dN
    dz = C * (V * V) * dg + 2.0 * C * V * dV * g - (V * V) * g
    x0 = N * V
    x1 = 2.0 * g
    x2 = S * x1
    x3 = cos_alpha * e + q * x0 + x2 * z
    x4 = de * scale
    x5 = scale * z
    x6 = q * scale
    x7 = dz * scale
    x8 = S + q
    x9 = -e + x8 * z
    Q_sc = scale * x3
    dQ_sc = (
        N * dV * x6
        + 2.0 * S * dg * x5
        + V * dN * x6
        - b * e * h * scale
        + cos_alpha * x4
        + dq * scale * x0
        + dscale * x3
        + x1 * x5
        + x2 * x7
    )
    G = scale * x9
    dG = dq * x5 + dscale * x9 - x4 + x5 + x7 * x8
    return Q_sc, dQ_sc, G, dG


@njit(cache=True, error_model="numpy", forceinline=True)
def total_reflection(S):
    """Efficiencies of a totally reflected ray: S >= 1/n_mP^2, n_mP > 1.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    Returns Q_sc, G.
    6 operations, 0 temporaries.
    """
    C = 1.0 - S
    cos_alpha = math.sqrt(C)
    Q_sc = 2.0 * C
    G = -2.0 * cos_alpha
    return Q_sc, G


@njit(cache=True, error_model="numpy", forceinline=True)
def total_reflection_rates(S):
    """Efficiencies of a totally reflected ray and their derivatives over S.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    Returns Q_sc, dQ_sc, G, dG.
    8 operations, 0 temporaries.
    """
    C = 1.0 - S
    cos_alpha = math.sqrt(C)
    Q_sc = 2.0 * C
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
def passage(u1, u2, u3, p1, p2, p3):
    """s = u.p, the centre's place along the ray, and S = |p|^2 - s^2 by (3.12).
    p is in radii; the digits of |p|^2 are lost.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    p1: position of the bead's centre over its radius along N1 [1]
    p2: position of the bead's centre over its radius along N2 [1]
    p3: position of the bead's centre over its radius along N3 [1]
    Returns s, S.
    12 operations, 0 temporaries.
    """
    s = p1 * u1 + p2 * u2 + p3 * u3
    S = (p1 * p1) + (p2 * p2) + (p3 * p3) - (s * s)
    return s, S


@njit(cache=True, error_model="numpy", forceinline=True)
def force_along_ray(u1, u2, u3, s, Q_sc, G):
    """F + G p, along the ray, of its force F (3.24) on the bead: p in radii.

    u1: unit direction of the ray along N1 [1]
    u2: unit direction of the ray along N2 [1]
    u3: unit direction of the ray along N3 [1]
    s: the centre's place along the ray, u.p [1]
    Q_sc: scattering efficiency [1]
    G: gradient efficiency, -Q_gr/sqrt(S) [1]
    Returns F1, F2, F3.
    5 operations, 1 temporaries.
    """
    x0 = G * s + Q_sc
    F1 = u1 * x0
    F2 = u2 * x0
    F3 = u3 * x0
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
    116 operations, 16 temporaries.
    """
    C = 1.0 - S
    cos_alpha = math.sqrt(C)
    b = math.sqrt(C + (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP))
    q = b * cos_alpha
    w_s = b + cos_alpha
    w_p = b * (n_mP * n_mP) + cos_alpha
    y = 1.0 / (w_p * w_s)
    y_s = w_p * y
    y_p = w_s * y
    g = (1.0 / 2.0) * y_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    a = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / n_mP
    X_p = (a * a) * (y_p * y_p)
    D_s = C + (1.0 / 4.0) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0)) / (
        n_mP * n_mP
    )
    D_p = C + (a * a)
    x0 = 2.0 * (X_p * X_p)
    x1 = C * S
    x2 = n_mP * n_mP
    x3 = x2 + 1.0
    x4 = x3 * (-S * x3 + 2.0)
    x5 = n_mP + 1.0
    x6 = 1.0 - n_mP
    x7 = (x5 * x5) * (x6 * x6)
    x8 = x4 * x7
    x9 = 4.0 * X_p
    x10 = 1.0 / x2
    x11 = -x10 * x7 * (y * y) + x4 * (y_p * y_p)
    x12 = D_p * x11 * x7
    x13 = (1.0 / 2.0) * D_p * x10 * (x11 * x11) * (x5 * x5 * x5 * x5) * (x6 * x6 * x6 * x6)
    x14 = (1.0 / 2.0) / (D_p * D_s)
    x15 = C * g
    X = x14 * (x1 * x13 + x12 * (C * x9 + q) - x8 * (C * x0 + X_p * q + 2.0 * (g * g) * x1))
    Y = x14 * (
        -S * cos_alpha * x13 - cos_alpha * x12 * x9 - x8 * (S * x15 - cos_alpha * x0 + q * x15)
    )
    return X, Y


@njit(cache=True, error_model="numpy", forceinline=True)
def split_rates(S, n_mP):
    """The same and their derivatives over S.

    S: sin^2 of the angle of incidence, S = sin^2(alpha) [1]
    n_mP: n_m/n_P, medium over bead [1]
    Returns X, dX, Y, dY.
    339 operations, 71 temporaries.
    """
    C = 1.0 - S
    cos_alpha = math.sqrt(C)
    b = math.sqrt(C + (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP))
    q = b * cos_alpha
    w_s = b + cos_alpha
    w_p = b * (n_mP * n_mP) + cos_alpha
    y = 1.0 / (w_p * w_s)
    y_s = w_p * y
    y_p = w_s * y
    g = (1.0 / 2.0) * y_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    a = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-S * ((n_mP * n_mP) + 1.0) + 1.0) / n_mP
    X_p = (a * a) * (y_p * y_p)
    D_s = C + (1.0 / 4.0) * ((1.0 - n_mP) * (1.0 - n_mP)) * ((n_mP + 1.0) * (n_mP + 1.0)) / (
        n_mP * n_mP
    )
    D_p = C + (a * a)
    h = (1.0 / 2.0) / q
    dq = -h * ((b * b) + (cos_alpha * cos_alpha))
    dw_s = -h * (b + cos_alpha)
    dw_p = -h * (b + cos_alpha * (n_mP * n_mP))
    dy = -(y * y) * (dw_p * w_s + dw_s * w_p)
    dy_s = -dw_s * (y_s * y_s)
    dy_p = -dw_p * (y_p * y_p)
    dg = (1.0 / 2.0) * dy_s * (1.0 - n_mP) * (n_mP + 1.0) / (n_mP * n_mP)
    da = (1.0 / 2.0) * (1.0 - n_mP) * (n_mP + 1.0) * (-(n_mP * n_mP) - 1.0) / n_mP
    dX_p = 2.0 * (a * a) * dy_p * y_p + 2.0 * a * da * (y_p * y_p)
    dD_s = -1.0
    dD_p = 2.0 * a * da - 1.0
    x0 = n_mP * n_mP
    x1 = x0 + 1.0
    x2 = S * x1
    x3 = 2.0 - x2
    x4 = x1 * x3
    x5 = X_p * X_p
    x6 = 2.0 * x5
    x7 = C * S
    x8 = 2.0 * (g * g)
    x9 = n_mP + 1.0
    x10 = x9 * x9
    x11 = 1.0 - n_mP
    x12 = x11 * x11
    x13 = x10 * x12
    x14 = x13 * (C * x6 + X_p * q + x7 * x8)
    x15 = 4.0 * X_p
    x16 = C * x15 + q
    x17 = y_p * y_p
    x18 = 1.0 / x0
    x19 = -x13 * x18 * (y * y) + x17 * x4
    x20 = x13 * x19
    x21 = x16 * x20
    x22 = (x11 * x11 * x11 * x11) * x18 * (x9 * x9 * x9 * x9)
    x23 = (1.0 / 2.0) * (x19 * x19) * x22
    x24 = x23 * x7
    x25 = D_p * x21 + D_p * x24 - x14 * x4
    x26 = 1.0 / D_p
    x27 = 1.0 / D_s
    x28 = (1.0 / 2.0) * x27
    x29 = x26 * x28
    x30 = C * x2
    x31 = x13 * x4
    x32 = X_p * x31
    x33 = D_p * x20
    x34 = dq * x29
    x35 = D_p * x16
    x36 = x22 * y
    x37 = 2.0 * D_p
    x38 = (
        (x11 * x11 * x11 * x11 * x11 * x11)
        * x19
        * x37
        * (x9 * x9 * x9 * x9 * x9 * x9)
        * y
        / (n_mP * n_mP * n_mP * n_mP)
    )
    x39 = dy * x29
    x40 = x16 * x31
    x41 = 4.0 * x33
    x42 = dX_p * x29
    x43 = x37 * y_p
    x44 = x19 * x22
    x45 = x30 * x44
    x46 = x3 * x43
    x47 = dy_p * x29
    x48 = x15 * x33
    x49 = D_p * x23
    x50 = S * x49
    x51 = x48 + x50
    x52 = (1.0 / 2.0) * dD_s * x26 / (D_s * D_s)
    x53 = C * x31
    x54 = -x1
    x55 = x1 * x54
    x56 = x13 * x55
    x57 = x17 * x56
    x58 = x17 * x54
    x59 = x28 / (D_p * D_p)
    x60 = S * g
    x61 = g * q
    x62 = C * x60 + C * x61 - cos_alpha * x6
    x63 = -cos_alpha * x48 - cos_alpha * x50 - x31 * x62
    x64 = g * x53
    x65 = x29 * x31
    x66 = D_p * cos_alpha
    x67 = 8.0 * x66
    x68 = S * cos_alpha
    x69 = x2 * x44
    x70 = cos_alpha * x15
    X = x25 * x29
    dX = (
        dD_p * (-x25 * x59 + x29 * (x21 + x24))
        - 2.0 * dg * g * x13 * x26 * x27 * x3 * x30
        - x25 * x52
        - x29 * (-x31 * (S * x8 + x6) + x51)
        + x29 * (C * x49 + D_p * x45 * x58 - x14 * x55 + x35 * x57 - x53 * x8)
        + x34 * (-x32 + x33)
        + x39 * (-2.0 * x35 * x36 - x38 * x7)
        + x42 * (C * x41 - x40)
        + x47 * (x40 * x43 + x45 * x46)
    )
    Y = x29 * x63
    dY = (
        -b * h * x29 * (2.0 * x1 * x10 * x12 * x3 * x5 - x51)
        + dD_p * (x29 * (-x20 * x70 - x23 * x68) - x59 * x63)
        - dg * x65 * (C * q + x7)
        + x29 * (-D_p * x57 * x70 - cos_alpha * x49 - x56 * x62 - x58 * x66 * x69 - x64)
        - x34 * x64
        + x39 * (X_p * x36 * x67 + x38 * x68)
        + x42 * (4.0 * X_p * cos_alpha * x1 * x10 * x12 * x3 - cos_alpha * x41)
        + x47 * (-cos_alpha * x46 * x69 - x32 * x67 * y_p)
        - x52 * x63
        + x65 * (x60 + x61)
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
