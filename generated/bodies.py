"""The force and torque of light on a body of any shape: what is summed over (n, m).

Made by `python -m derivation` from derivation/bodies.py and derivation/waves.py; do not edit.
SymPy 1.14.0. 148 operations, 10 temporaries.

The light before and after the body has the amplitudes p and q = S p, about the body's
origin and in its frame; t = q - p and v = p + q. They have two components, electric and
magnetic, each the other's partner. The elements are those of helicity +1. Sums over n,
m and components are forces in units of n_m/c and torques in those of 1/omega, if |p|^2
is a power. If t ends at the degree N, v is needed to N+1. In a name, before and above
are n-1 and n+1, down and up m-1 and m+1.
"""

from numba import njit


@njit(cache=True, error_model="numpy", forceinline=True)
def force_summand(
    t_re,
    t_im,
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
    """What (n, m) of one component adds to the force, -Re(t* s_i v).

    t_re: amplitude of t = q - p at (n, m), real part [1]
    t_im: amplitude of t = q - p at (n, m), imaginary part [1]
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
    al: <n m|s_z|n-1 m> [1]
    al_above: <n+1 m|s_z|n m> [1]
    be: <n m|s_z|n m> [1]
    e1_down: <n m|s_+|n-1 m-1> [1]
    e0_down: <n m|s_+|n m-1> [1]
    em_down: <n m|s_+|n+1 m-1> [1]
    e1: <n+1 m+1|s_+|n m> [1]
    e0: <n m+1|s_+|n m> [1]
    em: <n-1 m+1|s_+|n m> [1]
    Returns x, y, z.
    47 operations, 2 temporaries.
    """
    s_plus_re = down_above_re * em_down + down_before_re * e1_down + e0_down * partner_down_re
    s_plus_im = down_above_im * em_down + down_before_im * e1_down + e0_down * partner_down_im
    s_minus_re = e0 * partner_up_re + e1 * up_above_re + em * up_before_re
    s_minus_im = e0 * partner_up_im + e1 * up_above_im + em * up_before_im
    s_z_re = above_re * al_above + al * before_re + be * partner_re
    s_z_im = above_im * al_above + al * before_im + be * partner_im
    x0 = 0.5 * t_im
    x1 = 0.5 * t_re
    x = -x0 * (s_minus_im + s_plus_im) - x1 * (s_minus_re + s_plus_re)
    y = x0 * (-s_minus_re + s_plus_re) - x1 * (-s_minus_im + s_plus_im)
    z = -s_z_im * t_im - s_z_re * t_re
    return x, y, z


@njit(cache=True, error_model="numpy", forceinline=True)
def torque_summand(t_re, t_im, down_re, down_im, P_re, P_im, up_re, up_im, m, lift_down, lift):
    """What (n, m) of one component adds to the torque, -Re(t* J_i v), and to the
    absorbed power, -Re(t* v).

    t_re: amplitude of t = q - p at (n, m), real part [1]
    t_im: amplitude of t = q - p at (n, m), imaginary part [1]
    down_re: amplitude at (n, m-1), real part [1]
    down_im: amplitude at (n, m-1), imaginary part [1]
    P_re: amplitude at (n, m), real part [1]
    P_im: amplitude at (n, m), imaginary part [1]
    up_re: amplitude at (n, m+1), real part [1]
    up_im: amplitude at (n, m+1), imaginary part [1]
    m: order of the harmonic [1]
    lift_down: sqrt((n+m)(n-m+1)), of J_+ from m-1 to m [1]
    lift: sqrt((n-m)(n+m+1)), of J_+ from m to m+1 [1]
    Returns x, y, z, absorbed.
    27 operations, 2 temporaries.
    """
    J_plus_re = down_re * lift_down
    J_plus_im = down_im * lift_down
    J_minus_re = lift * up_re
    J_minus_im = lift * up_im
    J_z_re = P_re * m
    J_z_im = P_im * m
    x0 = 0.5 * t_im
    x1 = 0.5 * t_re
    x = -x0 * (J_minus_im + J_plus_im) - x1 * (J_minus_re + J_plus_re)
    y = x0 * (-J_minus_re + J_plus_re) - x1 * (-J_minus_im + J_plus_im)
    z = -J_z_im * t_im - J_z_re * t_re
    absorbed = -P_im * t_im - P_re * t_re
    return x, y, z, absorbed


@njit(cache=True, error_model="numpy", forceinline=True)
def generators(
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
    """s_x, s_y, s_z, J_x, J_y and J_z on amplitudes, at (n, m).

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
    Returns s_x_re, s_x_im, s_y_re, s_y_im, s_z_re, s_z_im, J_x_re, J_x_im, J_y_re, J_y_im, J_z_re, J_z_im.
    54 operations, 6 temporaries.
    """
    s_plus_re = down_above_re * em_down + down_before_re * e1_down + e0_down * partner_down_re
    s_plus_im = down_above_im * em_down + down_before_im * e1_down + e0_down * partner_down_im
    s_minus_re = e0 * partner_up_re + e1 * up_above_re + em * up_before_re
    s_minus_im = e0 * partner_up_im + e1 * up_above_im + em * up_before_im
    s_z_re = above_re * al_above + al * before_re + be * partner_re
    s_z_im = above_im * al_above + al * before_im + be * partner_im
    J_plus_re = down_re * lift_down
    J_plus_im = down_im * lift_down
    J_minus_re = lift * up_re
    J_minus_im = lift * up_im
    J_z_re = P_re * m
    J_z_im = P_im * m
    x0 = 0.5 * s_minus_re
    x1 = 0.5 * s_plus_re
    x2 = 0.5 * s_minus_im
    x3 = 0.5 * J_minus_re
    x4 = 0.5 * J_plus_re
    x5 = 0.5 * J_minus_im
    s_x_re = x0 + x1
    s_x_im = 0.5 * s_plus_im + x2
    s_y_re = 0.5 * s_plus_im - x2
    s_y_im = x0 - x1
    J_x_re = x3 + x4
    J_x_im = 0.5 * J_plus_im + x5
    J_y_re = 0.5 * J_plus_im - x5
    J_y_im = x3 - x4
    return (
        s_x_re,
        s_x_im,
        s_y_re,
        s_y_im,
        s_z_re,
        s_z_im,
        J_x_re,
        J_x_im,
        J_y_re,
        J_y_im,
        J_z_re,
        J_z_im,
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def derivative_summand(
    h_re,
    h_im,
    s_x_p_re,
    s_x_p_im,
    s_y_p_re,
    s_y_p_im,
    s_z_p_re,
    s_z_p_im,
    J_x_p_re,
    J_x_p_im,
    J_y_p_re,
    J_y_p_im,
    J_z_p_re,
    J_z_p_im,
):
    """What (n, m) of one component adds to the derivatives of one component of force
    (A = s_i) or torque (A = J_i) over k r_j and over the angles about the body's
    axes j. Force and torque are in the body's axes, which turn with it. If t ends
    at N, the sum goes to N+1.

    h_re: A t + (S - 1)^+ A q at (n, m), real part [1]
    h_im: A t + (S - 1)^+ A q at (n, m), imaginary part [1]
    s_x_p_re: s_x p at (n, m), real part [1]
    s_x_p_im: s_x p at (n, m), imaginary part [1]
    s_y_p_re: s_y p at (n, m), real part [1]
    s_y_p_im: s_y p at (n, m), imaginary part [1]
    s_z_p_re: s_z p at (n, m), real part [1]
    s_z_p_im: s_z p at (n, m), imaginary part [1]
    J_x_p_re: J_x p at (n, m), real part [1]
    J_x_p_im: J_x p at (n, m), imaginary part [1]
    J_y_p_re: J_y p at (n, m), real part [1]
    J_y_p_im: J_y p at (n, m), imaginary part [1]
    J_z_p_re: J_z p at (n, m), real part [1]
    J_z_p_im: J_z p at (n, m), imaginary part [1]
    Returns x, y, z, about_x, about_y, about_z.
    20 operations, 0 temporaries.
    """
    twice_h_re = 2.0 * h_re
    twice_h_im = 2.0 * h_im
    x = s_x_p_im * twice_h_re - s_x_p_re * twice_h_im
    y = s_y_p_im * twice_h_re - s_y_p_re * twice_h_im
    z = s_z_p_im * twice_h_re - s_z_p_re * twice_h_im
    about_x = J_x_p_im * twice_h_re - J_x_p_re * twice_h_im
    about_y = J_y_p_im * twice_h_re - J_y_p_re * twice_h_im
    about_z = J_z_p_im * twice_h_re - J_z_p_re * twice_h_im
    return x, y, z, about_x, about_y, about_z
