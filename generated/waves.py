"""The force of focused light on a sphere, exactly: what is summed over harmonics (n, m).

Made by `python -m derivation` from derivation/waves.py; do not edit.
SymPy 1.14.0. 409 operations, 16 temporaries.

Amplitudes p_nm = 2 pi i^m P_nm about the bead's centre: of one component (light of
helicity +1, its own partner) or of two (electric and magnetic, each the other's
partner). The elements are those of helicity +1. Sums over n, m and components are
forces and gradients over k r in units of 4 pi^2 n_m/c, moments in those of
4 pi^2/omega. In a name, before and above are n-1 and n+1, down and up m-1 and m+1.
"""

import math

from numba import njit


@njit(cache=True, error_model="numpy", forceinline=True)
def squared_elements(n, m):
    """Elements of the direction s between harmonics: the squares of <n m|s_z|n-1 m>,
    <n+1 m+1|s_+|n m> (itself negative), <n m+1|s_+|n m> and <n-1 m+1|s_+|n m>, and
    within = <n m|s_z|n m> itself.

    n: degree of the harmonic [1]
    m: order of the harmonic [1]
    Returns along, within, raised, turned, lowered.
    33 operations, 8 temporaries.
    """
    x0 = m + n
    x1 = 2.0 * n
    x2 = 1.0 / (x1 + 1.0)
    x3 = n + 1.0
    x4 = m - n
    x5 = x4 / (n * n)
    x6 = x2 * x3 * x5 * (n - 1.0) / (x1 - 1.0)
    x7 = (m + x3) / (x3 * x3)
    along = -x0 * x6
    within = m / (n * x3)
    raised = n * x2 * x7 * (n + 2.0) * (x0 + 2.0) / (x1 + 3.0)
    turned = -x5 * x7
    lowered = x6 * (x4 + 1.0)
    return along, within, raised, turned, lowered


@njit(cache=True, error_model="numpy", forceinline=True)
def electric_across(g, m_in, m, n):
    """z f'/f - (n+1) of electric waves outside of a surface, from that inside; that of
    magnetic waves is continuous.

    g: reduced logarithmic derivative of the field [1]
    m_in: index inside of the surface, relative to the medium [1]
    m: index outside of the surface, relative to the medium [1]
    n: degree of the harmonic [1]
    Returns g_out.
    10 operations, 0 temporaries.
    """
    g_out = (g * (m * m) + (m - m_in) * (m + m_in) * (n + 1.0)) / (m_in * m_in)
    return g_out


@njit(cache=True, error_model="numpy", forceinline=True)
def layer(g, g_psi_in, g_chi_in, g_psi_out, g_chi_out, ratio):
    """z f'/f - (n+1) at the outer surface of a layer, from that at its inner surface.

    g: reduced logarithmic derivative of the field [1]
    g_psi_in: that of psi_n at the layer's inner surface [1]
    g_chi_in: that of the second solution at the layer's inner surface [1]
    g_psi_out: that of psi_n at the layer's outer surface [1]
    g_chi_out: that of the second solution at the layer's outer surface [1]
    ratio: psi_n over the second solution at the inner surface, over the same at the outer [1]
    Returns g_out.
    9 operations, 1 temporaries.
    """
    x0 = ratio * (g - g_psi_in)
    g_out = (-g_chi_out * x0 + g_psi_out * (g - g_chi_in)) / (g - g_chi_in - x0)
    return g_out


@njit(cache=True, error_model="numpy", forceinline=True)
def reflected(g, g_psi, g_chi, ratio):
    """P and Q of the Mie coefficient P/(P - iQ), from g just outside of the bead.

    g: reduced logarithmic derivative of the field [1]
    g_psi: that of psi_n at the surface [1]
    g_chi: that of the second solution at the surface [1]
    ratio: psi_n over chi_n at the surface [1]
    Returns P, Q.
    3 operations, 0 temporaries.
    """
    P = ratio * (g - g_psi)
    Q = g - g_chi
    return P, Q


@njit(cache=True, error_model="numpy", forceinline=True)
def force_summand(
    P_re,
    P_im,
    above_re,
    above_im,
    partner_re,
    partner_im,
    up_before_re,
    up_before_im,
    up_re,
    up_im,
    up_above_re,
    up_above_im,
    U_re,
    U_im,
    U_before_re,
    U_before_im,
    V_re,
    V_im,
    al_above,
    be,
    e1,
    e0,
    em,
):
    """What (n, m) of one component adds to the force; each pair of neighbours once.

    P_re: amplitude at (n, m), real part [1]
    P_im: amplitude at (n, m), imaginary part [1]
    above_re: amplitude at (n+1, m), real part [1]
    above_im: amplitude at (n+1, m), imaginary part [1]
    partner_re: amplitude of the partner at (n, m), real part [1]
    partner_im: amplitude of the partner at (n, m), imaginary part [1]
    up_before_re: amplitude at (n-1, m+1), real part [1]
    up_before_im: amplitude at (n-1, m+1), imaginary part [1]
    up_re: amplitude at (n, m+1), real part [1]
    up_im: amplitude at (n, m+1), imaginary part [1]
    up_above_re: amplitude at (n+1, m+1), real part [1]
    up_above_im: amplitude at (n+1, m+1), imaginary part [1]
    U_re: weight of the elements between n and n+1, real part [1]
    U_im: weight of the elements between n and n+1, imaginary part [1]
    U_before_re: weight of the elements between n-1 and n, real part [1]
    U_before_im: weight of the elements between n-1 and n, imaginary part [1]
    V_re: weight of the elements within n, real part [1]
    V_im: weight of the elements within n, imaginary part [1]
    al_above: <n+1 m|s_z|n m> [1]
    be: <n m|s_z|n m> [1]
    e1: <n+1 m+1|s_+|n m> [1]
    e0: <n m+1|s_+|n m> [1]
    em: <n-1 m+1|s_+|n m> [1]
    Returns x, y, z.
    57 operations, 0 temporaries.
    """
    G_re = -P_im * U_im + P_re * U_re
    G_im = P_im * U_re + P_re * U_im
    G_before_re = P_im * U_before_im + P_re * U_before_re
    G_before_im = P_im * U_before_re - P_re * U_before_im
    H_re = -V_im * partner_im + V_re * partner_re
    H_im = V_im * partner_re + V_re * partner_im
    x = (
        e0 * (-H_im * up_re + H_re * up_im)
        + e1 * (-G_im * up_above_re + G_re * up_above_im)
        + em * (-G_before_im * up_before_re + G_before_re * up_before_im)
    )
    y = (
        e0 * (H_im * up_im + H_re * up_re)
        + e1 * (G_im * up_above_im + G_re * up_above_re)
        + em * (G_before_im * up_before_im + G_before_re * up_before_re)
    )
    z = -2.0 * al_above * (G_im * above_im + G_re * above_re) - be * (H_im * P_im + H_re * P_re)
    return x, y, z


@njit(cache=True, error_model="numpy", forceinline=True)
def force_and_gradient_summand(
    down_before_re,
    down_before_im,
    down_re,
    down_im,
    down_above_re,
    down_above_im,
    before_re,
    before_im,
    P_re,
    P_im,
    above_re,
    above_im,
    up_before_re,
    up_before_im,
    up_re,
    up_im,
    up_above_re,
    up_above_im,
    partner_down_re,
    partner_down_im,
    partner_re,
    partner_im,
    partner_up_re,
    partner_up_im,
    U_re,
    U_im,
    U_before_re,
    U_before_im,
    V_re,
    V_im,
    al,
    al_above,
    be,
    e1_down,
    e0_down,
    em_down,
    e1,
    e0,
    em,
):
    """What (n, m) of one component adds to the force and to dF_i/d(k r_j), row by row.
    Both neighbours of each pair count, so that the summands of the force are not
    those of `force_summand`; the sums are.

    down_before_re: amplitude at (n-1, m-1), real part [1]
    down_before_im: amplitude at (n-1, m-1), imaginary part [1]
    down_re: amplitude at (n, m-1), real part [1]
    down_im: amplitude at (n, m-1), imaginary part [1]
    down_above_re: amplitude at (n+1, m-1), real part [1]
    down_above_im: amplitude at (n+1, m-1), imaginary part [1]
    before_re: amplitude at (n-1, m), real part [1]
    before_im: amplitude at (n-1, m), imaginary part [1]
    P_re: amplitude at (n, m), real part [1]
    P_im: amplitude at (n, m), imaginary part [1]
    above_re: amplitude at (n+1, m), real part [1]
    above_im: amplitude at (n+1, m), imaginary part [1]
    up_before_re: amplitude at (n-1, m+1), real part [1]
    up_before_im: amplitude at (n-1, m+1), imaginary part [1]
    up_re: amplitude at (n, m+1), real part [1]
    up_im: amplitude at (n, m+1), imaginary part [1]
    up_above_re: amplitude at (n+1, m+1), real part [1]
    up_above_im: amplitude at (n+1, m+1), imaginary part [1]
    partner_down_re: amplitude of the partner at (n, m-1), real part [1]
    partner_down_im: amplitude of the partner at (n, m-1), imaginary part [1]
    partner_re: amplitude of the partner at (n, m), real part [1]
    partner_im: amplitude of the partner at (n, m), imaginary part [1]
    partner_up_re: amplitude of the partner at (n, m+1), real part [1]
    partner_up_im: amplitude of the partner at (n, m+1), imaginary part [1]
    U_re: weight of the elements between n and n+1, real part [1]
    U_im: weight of the elements between n and n+1, imaginary part [1]
    U_before_re: weight of the elements between n-1 and n, real part [1]
    U_before_im: weight of the elements between n-1 and n, imaginary part [1]
    V_re: weight of the elements within n, real part [1]
    V_im: weight of the elements within n, imaginary part [1]
    al: <n m|s_z|n-1 m> [1]
    al_above: <n+1 m|s_z|n m> [1]
    be: <n m|s_z|n m> [1]
    e1_down: <n m|s_+|n-1 m-1> [1]
    e0_down: <n m|s_+|n m-1> [1]
    em_down: <n m|s_+|n+1 m-1> [1]
    e1: <n+1 m+1|s_+|n m> [1]
    e0: <n m+1|s_+|n m> [1]
    em: <n-1 m+1|s_+|n m> [1]
    Returns x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz.
    153 operations, 0 temporaries.
    """
    plus_before_re = down_before_re * e1_down
    plus_before_im = down_before_im * e1_down
    plus_within_re = e0_down * partner_down_re
    plus_within_im = e0_down * partner_down_im
    plus_above_re = down_above_re * em_down
    plus_above_im = down_above_im * em_down
    minus_before_re = em * up_before_re
    minus_before_im = em * up_before_im
    minus_within_re = e0 * partner_up_re
    minus_within_im = e0 * partner_up_im
    minus_above_re = e1 * up_above_re
    minus_above_im = e1 * up_above_im
    z_before_re = al * before_re
    z_before_im = al * before_im
    z_within_re = be * partner_re
    z_within_im = be * partner_im
    z_above_re = above_re * al_above
    z_above_im = above_im * al_above
    s_plus_re = plus_above_re + plus_before_re + plus_within_re
    s_plus_im = plus_above_im + plus_before_im + plus_within_im
    s_minus_re = minus_above_re + minus_before_re + minus_within_re
    s_minus_im = minus_above_im + minus_before_im + minus_within_im
    s_z_re = z_above_re + z_before_re + z_within_re
    s_z_im = z_above_im + z_before_im + z_within_im
    s_x_re = s_minus_re - s_plus_re
    s_x_im = s_minus_im - s_plus_im
    s_y_re = s_minus_re + s_plus_re
    s_y_im = s_minus_im + s_plus_im
    s_twice_z_re = 2.0 * s_z_re
    s_twice_z_im = 2.0 * s_z_im
    h_plus_re = (
        -U_before_im * plus_before_im
        + U_before_re * plus_before_re
        + U_im * plus_above_im
        + U_re * plus_above_re
        - V_im * plus_within_im
        + V_re * plus_within_re
    )
    h_plus_im = (
        U_before_im * plus_before_re
        + U_before_re * plus_before_im
        - U_im * plus_above_re
        + U_re * plus_above_im
        + V_im * plus_within_re
        + V_re * plus_within_im
    )
    h_minus_re = (
        -U_before_im * minus_before_im
        + U_before_re * minus_before_re
        + U_im * minus_above_im
        + U_re * minus_above_re
        - V_im * minus_within_im
        + V_re * minus_within_re
    )
    h_minus_im = (
        U_before_im * minus_before_re
        + U_before_re * minus_before_im
        - U_im * minus_above_re
        + U_re * minus_above_im
        + V_im * minus_within_re
        + V_re * minus_within_im
    )
    h_z_re = (
        -U_before_im * z_before_im
        + U_before_re * z_before_re
        + U_im * z_above_im
        + U_re * z_above_re
        - V_im * z_within_im
        + V_re * z_within_re
    )
    h_z_im = (
        U_before_im * z_before_re
        + U_before_re * z_before_im
        - U_im * z_above_re
        + U_re * z_above_im
        + V_im * z_within_re
        + V_re * z_within_im
    )
    h_x_re = 0.5 * h_minus_re - 0.5 * h_plus_re
    h_x_im = 0.5 * h_minus_im - 0.5 * h_plus_im
    h_y_re = 0.5 * h_minus_re + 0.5 * h_plus_re
    h_y_im = 0.5 * h_minus_im + 0.5 * h_plus_im
    x = -P_im * h_x_re + P_re * h_x_im
    y = P_im * h_y_im + P_re * h_y_re
    z = -P_im * h_z_im - P_re * h_z_re
    xx = -h_x_im * s_x_re + h_x_re * s_x_im
    xy = h_x_im * s_y_im + h_x_re * s_y_re
    xz = -h_x_im * s_twice_z_im - h_x_re * s_twice_z_re
    yx = -h_y_im * s_x_im - h_y_re * s_x_re
    yy = -h_y_im * s_y_re + h_y_re * s_y_im
    yz = h_y_im * s_twice_z_re - h_y_re * s_twice_z_im
    zx = h_z_im * s_x_im + h_z_re * s_x_re
    zy = h_z_im * s_y_re - h_z_re * s_y_im
    zz = -h_z_im * s_twice_z_re + h_z_re * s_twice_z_im
    return x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz


@njit(cache=True, error_model="numpy", forceinline=True)
def moment_summand(P_re, P_im, up_re, up_im, K, m, lift):
    """What (n, m) of one component adds to the moment and to the absorbed power.

    P_re: amplitude at (n, m), real part [1]
    P_im: amplitude at (n, m), imaginary part [1]
    up_re: amplitude at (n, m+1), real part [1]
    up_im: amplitude at (n, m+1), imaginary part [1]
    K: weight of the angular momentum at n [1]
    m: order of the harmonic [1]
    lift: sqrt((n-m)(n+m+1)), of J_+ from m to m+1 [1]
    Returns x, y, z, absorbed.
    17 operations, 2 temporaries.
    """
    x0 = K * lift
    x1 = K * ((P_im * P_im) + (P_re * P_re))
    x = -x0 * (P_im * up_re - P_re * up_im)
    y = x0 * (P_im * up_im + P_re * up_re)
    z = -m * x1
    absorbed = -x1
    return x, y, z, absorbed


@njit(cache=True, error_model="numpy", forceinline=True)
def moment_gradient_summand(
    down_before_re,
    down_before_im,
    down_re,
    down_im,
    down_above_re,
    down_above_im,
    before_re,
    before_im,
    P_re,
    P_im,
    above_re,
    above_im,
    up_before_re,
    up_before_im,
    up_re,
    up_im,
    up_above_re,
    up_above_im,
    partner_down_re,
    partner_down_im,
    partner_re,
    partner_im,
    partner_up_re,
    partner_up_im,
    K,
    m,
    lift_down,
    lift,
    al,
    al_above,
    be,
    e1_down,
    e0_down,
    em_down,
    e1,
    e0,
    em,
):
    """What (n, m) of one component adds to dM_i/d(k r_j), row by row.

    down_before_re: amplitude at (n-1, m-1), real part [1]
    down_before_im: amplitude at (n-1, m-1), imaginary part [1]
    down_re: amplitude at (n, m-1), real part [1]
    down_im: amplitude at (n, m-1), imaginary part [1]
    down_above_re: amplitude at (n+1, m-1), real part [1]
    down_above_im: amplitude at (n+1, m-1), imaginary part [1]
    before_re: amplitude at (n-1, m), real part [1]
    before_im: amplitude at (n-1, m), imaginary part [1]
    P_re: amplitude at (n, m), real part [1]
    P_im: amplitude at (n, m), imaginary part [1]
    above_re: amplitude at (n+1, m), real part [1]
    above_im: amplitude at (n+1, m), imaginary part [1]
    up_before_re: amplitude at (n-1, m+1), real part [1]
    up_before_im: amplitude at (n-1, m+1), imaginary part [1]
    up_re: amplitude at (n, m+1), real part [1]
    up_im: amplitude at (n, m+1), imaginary part [1]
    up_above_re: amplitude at (n+1, m+1), real part [1]
    up_above_im: amplitude at (n+1, m+1), imaginary part [1]
    partner_down_re: amplitude of the partner at (n, m-1), real part [1]
    partner_down_im: amplitude of the partner at (n, m-1), imaginary part [1]
    partner_re: amplitude of the partner at (n, m), real part [1]
    partner_im: amplitude of the partner at (n, m), imaginary part [1]
    partner_up_re: amplitude of the partner at (n, m+1), real part [1]
    partner_up_im: amplitude of the partner at (n, m+1), imaginary part [1]
    K: weight of the angular momentum at n [1]
    m: order of the harmonic [1]
    lift_down: sqrt((n+m)(n-m+1)), of J_+ from m-1 to m [1]
    lift: sqrt((n-m)(n+m+1)), of J_+ from m to m+1 [1]
    al: <n m|s_z|n-1 m> [1]
    al_above: <n+1 m|s_z|n m> [1]
    be: <n m|s_z|n m> [1]
    e1_down: <n m|s_+|n-1 m-1> [1]
    e0_down: <n m|s_+|n m-1> [1]
    em_down: <n m|s_+|n+1 m-1> [1]
    e1: <n+1 m+1|s_+|n m> [1]
    e0: <n m+1|s_+|n m> [1]
    em: <n-1 m+1|s_+|n m> [1]
    Returns xx, xy, xz, yx, yy, yz, zx, zy, zz.
    89 operations, 0 temporaries.
    """
    plus_before_re = down_before_re * e1_down
    plus_before_im = down_before_im * e1_down
    plus_within_re = e0_down * partner_down_re
    plus_within_im = e0_down * partner_down_im
    plus_above_re = down_above_re * em_down
    plus_above_im = down_above_im * em_down
    minus_before_re = em * up_before_re
    minus_before_im = em * up_before_im
    minus_within_re = e0 * partner_up_re
    minus_within_im = e0 * partner_up_im
    minus_above_re = e1 * up_above_re
    minus_above_im = e1 * up_above_im
    z_before_re = al * before_re
    z_before_im = al * before_im
    z_within_re = be * partner_re
    z_within_im = be * partner_im
    z_above_re = above_re * al_above
    z_above_im = above_im * al_above
    s_plus_re = plus_above_re + plus_before_re + plus_within_re
    s_plus_im = plus_above_im + plus_before_im + plus_within_im
    s_minus_re = minus_above_re + minus_before_re + minus_within_re
    s_minus_im = minus_above_im + minus_before_im + minus_within_im
    s_z_re = z_above_re + z_before_re + z_within_re
    s_z_im = z_above_im + z_before_im + z_within_im
    s_x_re = s_minus_re - s_plus_re
    s_x_im = s_minus_im - s_plus_im
    s_y_re = s_minus_re + s_plus_re
    s_y_im = s_minus_im + s_plus_im
    s_twice_z_re = 2.0 * s_z_re
    s_twice_z_im = 2.0 * s_z_im
    h_plus_re = K * down_re * lift_down
    h_plus_im = K * down_im * lift_down
    h_minus_re = K * lift * up_re
    h_minus_im = K * lift * up_im
    h_z_re = K * P_re * m
    h_z_im = K * P_im * m
    h_x_re = 0.5 * h_minus_re - 0.5 * h_plus_re
    h_x_im = 0.5 * h_minus_im - 0.5 * h_plus_im
    h_y_re = 0.5 * h_minus_re + 0.5 * h_plus_re
    h_y_im = 0.5 * h_minus_im + 0.5 * h_plus_im
    xx = -h_x_im * s_x_re + h_x_re * s_x_im
    xy = h_x_im * s_y_im + h_x_re * s_y_re
    xz = -h_x_im * s_twice_z_im - h_x_re * s_twice_z_re
    yx = -h_y_im * s_x_im - h_y_re * s_x_re
    yy = -h_y_im * s_y_re + h_y_re * s_y_im
    yz = h_y_im * s_twice_z_re - h_y_re * s_twice_z_im
    zx = h_z_im * s_x_im + h_z_re * s_x_re
    zy = h_z_im * s_y_re - h_z_re * s_y_im
    zz = -h_z_im * s_twice_z_re + h_z_re * s_twice_z_im
    return xx, xy, xz, yx, yy, yz, zx, zy, zz


@njit(cache=True, error_model="numpy", forceinline=True)
def cover_amplitudes(cos1, cos2, n1, n2):
    """Amplitudes behind a plane face over those before it, as square roots of power
    per solid angle: field in the plane of incidence, and across it.

    cos1: cosine of the angle before the face [1]
    cos2: cosine of the angle behind the face [1]
    n1: index before the plane face [1]
    n2: index behind the plane face [1]
    Returns p, s.
    15 operations, 1 temporaries.
    """
    x0 = 2.0 * cos2 * (n2 * math.sqrt(n2)) / math.sqrt(n1)
    p = x0 / (cos1 * n2 + cos2 * n1)
    s = x0 / (cos1 * n1 + cos2 * n2)
    return p, s


@njit(cache=True, error_model="numpy", forceinline=True)
def reflect(cos1, cos2, n1, n2):
    """Amplitudes that a plane face reflects over those that meet it: field in the
    plane of incidence, and across it. Cosine and index behind the face may be
    complex.

    cos1: cosine of the angle before the face [1]
    cos2: cosine of the angle behind the face [1]
    n1: index before the plane face [1]
    n2: index behind the plane face [1]
    Returns p, s.
    23 operations, 4 temporaries.
    """
    x0 = n2 * n2
    x1 = n1 * n1
    x2 = cos1 * cos1
    x3 = (n1 - n2) * (n1 + n2)
    p = -x3 * (x0 * x2 + x1 * x2 - x1) / (x0 * ((cos1 * n2 + cos2 * n1) * (cos1 * n2 + cos2 * n1)))
    s = x3 / ((cos1 * n1 + cos2 * n2) * (cos1 * n1 + cos2 * n2))
    return p, s
