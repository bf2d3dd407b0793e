"""Drag, spring and thermal noise (2.13-2.20) of one coordinate over a step, exactly.

Made by `python -m derivation` from derivation/langevin.py; do not edit.
SymPy 1.14.0. 389 operations, 17 temporaries.

dx = v dt, dv = ((u - v)/tau - (kappa/tau) x) dt + sqrt(2 (kT/m)/tau) dW; without
inertia dx = (u - kappa x) dt + sqrt(2 D) dW. d is the displacement by a unit of
velocity, without inertia by a unit of u; j its integral, and l that of j.
"""

from numba import njit


@njit(cache=True)
def inertial_of_a_short_step(h, tau, kappa):
    """Taylor's series: complete to rounding where h/tau and |kappa| h <= 1/64, and
    |kappa| h^2/tau <= 1/4096.

    h: step [s]
    tau: relaxation time m/beta_v, epsilon of [s]
    kappa: stiffness over drag, k/beta_v [1/s]
    Returns d, j, l, c_xx, c_vv.
    273 operations, 4 temporaries.
    """
    p = h / tau
    q = (h * h) * kappa / tau
    x0 = (1.0 / 6720.0) * q
    x1 = h * h
    x2 = (1.0 / 60480.0) * q
    x3 = (1.0 / 362880.0) * q
    d = h * (
        p
        * (
            p
            * (
                p
                * (
                    p
                    * (
                        p * (p * (1.0 / 5040.0 - 1.0 / 40320.0 * p) + x0 - 1.0 / 720.0)
                        - 1.0 / 1008.0 * q
                        + 1.0 / 120.0
                    )
                    + q * (1.0 / 180.0 - 1.0 / 4032.0 * q)
                    - 1.0 / 24.0
                )
                + q * ((1.0 / 840.0) * q - 1.0 / 40.0)
                + 1.0 / 6.0
            )
            + q * (q * ((1.0 / 10080.0) * q - 1.0 / 240.0) + 1.0 / 12.0)
            - 1.0 / 2.0
        )
        + q * (q * (1.0 / 120.0 - 1.0 / 5040.0 * q) - 1.0 / 6.0)
        + 1.0
    )
    j = x1 * (
        p
        * (
            p
            * (
                p
                * (
                    p
                    * (
                        p * (p * (1.0 / 40320.0 - 1.0 / 362880.0 * p) + x2 - 1.0 / 5040.0)
                        - 1.0 / 8064.0 * q
                        + 1.0 / 720.0
                    )
                    + q * (1.0 / 1260.0 - 1.0 / 36288.0 * q)
                    - 1.0 / 120.0
                )
                + q * (x0 - 1.0 / 240.0)
                + 1.0 / 24.0
            )
            + q * (q * ((1.0 / 90720.0) * q - 1.0 / 1680.0) + 1.0 / 60.0)
            - 1.0 / 6.0
        )
        + q * (q * (1.0 / 720.0 - 1.0 / 40320.0 * q) - 1.0 / 24.0)
        + 1.0 / 2.0
    )
    l = (h * h * h) * (
        p
        * (
            p
            * (
                p
                * (
                    p
                    * (
                        p
                        * (
                            p * (1.0 / 362880.0 - 1.0 / 3628800.0 * p)
                            + (1.0 / 604800.0) * q
                            - 1.0 / 40320.0
                        )
                        - 1.0 / 72576.0 * q
                        + 1.0 / 5040.0
                    )
                    + q * (1.0 / 10080.0 - x3)
                    - 1.0 / 720.0
                )
                + q * (x2 - 1.0 / 1680.0)
                + 1.0 / 120.0
            )
            + q * (q * ((1.0 / 907200.0) * q - 1.0 / 13440.0) + 1.0 / 360.0)
            - 1.0 / 24.0
        )
        + q * (q * (1.0 / 5040.0 - x3) - 1.0 / 120.0)
        + 1.0 / 6.0
    )
    c_xx = (
        p
        * x1
        * (
            p
            * (
                p
                * (
                    p
                    * (
                        p
                        * (
                            p
                            * (
                                p * (127.0 / 90720.0 - 17.0 / 60480.0 * p)
                                + (107.0 / 75600.0) * q
                                - 1.0 / 160.0
                            )
                            - 43.0 / 7560.0 * q
                            + 31.0 / 1260.0
                        )
                        + q * (7.0 / 360.0 - 37.0 / 18900.0 * q)
                        - 1.0 / 12.0
                    )
                    + q * ((31.0 / 5670.0) * q - 17.0 / 315.0)
                    + 7.0 / 30.0
                )
                + q * (q * ((1.0 / 1575.0) * q - 1.0 / 90.0) + 1.0 / 9.0)
                - 1.0 / 2.0
            )
            + q * (q * (4.0 / 315.0 - 2.0 / 2835.0 * q) - 2.0 / 15.0)
            + 2.0 / 3.0
        )
    )
    c_vv = p * (
        p
        * (
            p
            * (
                p
                * (
                    p
                    * (
                        p
                        * (p * (8.0 / 315.0 - 2.0 / 315.0 * p) + (107.0 / 3360.0) * q - 4.0 / 45.0)
                        - 43.0 / 420.0 * q
                        + 4.0 / 15.0
                    )
                    + q * (49.0 / 180.0 - 37.0 / 840.0 * q)
                    - 2.0 / 3.0
                )
                + q * ((31.0 / 315.0) * q - 17.0 / 30.0)
                + 4.0 / 3.0
            )
            + q * (q * ((1.0 / 70.0) * q - 7.0 / 45.0) + 5.0 / 6.0)
            - 2.0
        )
        + q * (q * (2.0 / 15.0 - 4.0 / 315.0 * q) - 2.0 / 3.0)
        + 2.0
    )
    return d, j, l, c_xx, c_vv


@njit(cache=True)
def inertial_of_twice_the_step(h, tau, kappa, block):
    """From those of h those of 2 h.

    h: step [s]
    tau: relaxation time m/beta_v, epsilon of [s]
    kappa: stiffness over drag, k/beta_v [1/s]
    block: (5) d, j, l, c_xx, c_vv
    Returns d_twice, j_twice, l_twice, c_xx_twice, c_vv_twice.
    47 operations, 8 temporaries.
    """
    d = block[0]
    j = block[1]
    l = block[2]
    c_xx = block[3]
    c_vv = block[4]
    x0 = 1.0 / tau
    x1 = j * kappa * x0
    x2 = x1 - 1.0
    x3 = -x2
    x4 = -d * x0 - x2
    x5 = d * d
    x6 = d * d * d
    x7 = 1.0 / (tau * tau)
    d_twice = d * x3 + d * x4
    j_twice = j * x3 + j + x5
    l_twice = d * j + h * j + l * x3 + l
    c_xx_twice = c_vv * x5 + c_xx * (x3 * x3) + c_xx + x0 * x6 * (2.0 - 2.0 * x1)
    c_vv_twice = (
        c_vv * (x4 * x4) + c_vv + c_xx * (kappa * kappa) * x5 * x7 - 2.0 * kappa * x4 * x6 * x7
    )
    return d_twice, j_twice, l_twice, c_xx_twice, c_vv_twice


@njit(cache=True)
def inertial_step(h, tau, kappa, block):
    """What a step makes of its begin: see `derivation.langevin`.

    h: step [s]
    tau: relaxation time m/beta_v, epsilon of [s]
    kappa: stiffness over drag, k/beta_v [1/s]
    block: (5) d, j, l, c_xx, c_vv
    Returns by_v, by_u, by_rise, decay, v_by_u, v_by_rise, c_xv.
    12 operations, 4 temporaries.
    """
    d = block[0]
    j = block[1]
    l = block[2]
    x0 = 1.0 / tau
    x1 = j * x0
    x2 = 1.0 / h
    x3 = d * x0
    by_v = d
    by_u = x1
    by_rise = l * x0 * x2
    decay = -kappa * x1 - x3 + 1.0
    v_by_u = x3
    v_by_rise = x1 * x2
    c_xv = (d * d) * x0
    return by_v, by_u, by_rise, decay, v_by_u, v_by_rise, c_xv


@njit(cache=True)
def overdamped_of_a_short_step(h, kappa):
    """Taylor's series: complete to rounding where h/tau and |kappa| h <= 1/64, and
    |kappa| h^2/tau <= 1/4096.

    h: step [s]
    kappa: stiffness over drag, k/beta_v [1/s]
    Returns d, j.
    45 operations, 0 temporaries.
    """
    g = h * kappa
    d = h * (
        g
        * (
            g
            * (
                g
                * (
                    g * (g * (g * (1.0 / 5040.0 - 1.0 / 40320.0 * g) - 1.0 / 720.0) + 1.0 / 120.0)
                    - 1.0 / 24.0
                )
                + 1.0 / 6.0
            )
            - 1.0 / 2.0
        )
        + 1.0
    )
    j = (h * h) * (
        g
        * (
            g
            * (
                g
                * (
                    g
                    * (g * (g * (1.0 / 40320.0 - 1.0 / 362880.0 * g) - 1.0 / 5040.0) + 1.0 / 720.0)
                    - 1.0 / 120.0
                )
                + 1.0 / 24.0
            )
            - 1.0 / 6.0
        )
        + 1.0 / 2.0
    )
    return d, j


@njit(cache=True)
def overdamped_of_twice_the_step(h, kappa, block):
    """From those of h those of 2 h.

    h: step [s]
    kappa: stiffness over drag, k/beta_v [1/s]
    block: (2) d, j
    Returns d_twice, j_twice.
    8 operations, 1 temporaries.
    """
    d = block[0]
    j = block[1]
    x0 = -d * kappa + 1.0
    d_twice = d * x0 + d
    j_twice = d * h + j * x0 + j
    return d_twice, j_twice


@njit(cache=True)
def overdamped_step(h, kappa, block):
    """What a step makes of its begin: see `derivation.langevin`.

    h: step [s]
    kappa: stiffness over drag, k/beta_v [1/s]
    block: (2) d, j
    Returns by_u, by_rise, spread.
    4 operations, 0 temporaries.
    """
    d = block[0]
    j = block[1]
    by_u = d
    by_rise = j / h
    spread = d * (-d * kappa + 2.0)
    return by_u, by_rise, spread
