"""Force and extension of a polymer between two points.

Made by `python -m derivation` from derivation/chains.py; do not edit.
SymPy 1.14.0. 161 operations, 15 temporaries.

Extension is over the contour length, force is F Lp/kT. They also accept arrays.
"""


def marko_siggia(l):
    """Force on a worm-like chain by Marko and Siggia, and its derivative over l.

    l: extension over contour length [1]
    Returns force, slope.
    16 operations, 4 temporaries.
    """
    x0 = 2.0 - l
    x1 = 1.0 - l
    x2 = (1.0 / 4.0) / (x1 * x1)
    x3 = l * x2
    force = l + x0 * x3
    slope = (1.0 / 2.0) * l * x0 / (x1 * x1 * x1) + x0 * x2 - x3 + 1.0
    return force, slope


def bouchiat(l):
    """Force on a worm-like chain by Bouchiat, and its derivative over l.

    l: extension over contour length [1]
    Returns force, slope.
    41 operations, 4 temporaries.
    """
    x0 = 2.0 - l
    x1 = 1.0 - l
    x2 = (1.0 / 4.0) / (x1 * x1)
    x3 = l * x2
    force = (
        (l * l)
        * (
            l * (l * (l * (l * (39.49944 - 14.17718 * l) - 38.87607) + 16.07497) - 2.737418)
            - 0.5164228
        )
        + l
        + x0 * x3
    )
    slope = (
        (1.0 / 2.0) * l * x0 / (x1 * x1 * x1)
        + l
        * (
            l * (l * (l * (l * (236.99664 - 99.24026 * l) - 194.38035) + 64.29988) - 8.212254)
            - 1.0328456
        )
        + x0 * x2
        - x3
        + 1.0
    )
    return force, slope


def odijk(y, s):
    """Extension of a stiff chain that stretches, and its derivative over y.

    y: square root of F Lp/kT [1]
    s: kT/(Lp S) of a chain of stretch modulus S [1]
    Returns extension, slope.
    11 operations, 1 temporaries.
    """
    x0 = y * y
    extension = s * x0 + 1.0 - (1.0 / 2.0) / y
    slope = 2.0 * s * y + (1.0 / 2.0) / x0
    return extension, slope


def twistable(y, s, c_0, c_1):
    """Extension of a stiff chain that stretches and twists, and its derivative over y.

    y: square root of F Lp/kT [1]
    s: kT/(Lp S) of a chain of stretch modulus S [1]
    c_0: twist-stretch coupling over sqrt(S C), at no force [1]
    c_1: its increase with F Lp/kT [1]
    Returns extension, slope.
    24 operations, 4 temporaries.
    """
    x0 = y * y
    x1 = c_0 + c_1 * x0
    x2 = 1.0 - (x1 * x1)
    x3 = s / x2
    extension = x0 * x3 + 1.0 - (1.0 / 2.0) / y
    slope = 4.0 * c_1 * s * x1 * (y * y * y) / (x2 * x2) + 2.0 * x3 * y + (1.0 / 2.0) / x0
    return extension, slope


def langevin(u, e):
    """Extension of freely jointed segments, and its derivative over u.

    u: 2 F Lp/kT [1]
    e: exp(-2 u) [1]
    Returns extension, slope.
    11 operations, 1 temporaries.
    """
    x0 = 1.0 - e
    extension = (e + 1.0) / x0 - 1.0 / u
    slope = -4.0 * e / (x0 * x0) + 1.0 / (u * u)
    return extension, slope


def langevin_series(u):
    """The same for u below 1/2, by 10 terms of a series.

    u: 2 F Lp/kT [1]
    Returns extension, slope.
    58 operations, 1 temporaries.
    """
    x0 = u * u
    extension = u * (
        x0
        * (
            x0
            * (
                x0
                * (
                    x0
                    * (
                        x0
                        * (
                            x0
                            * (
                                x0
                                * (
                                    x0
                                    * (
                                        87734.0 / 38979295480125.0
                                        - 349222.0 / 1531329465290625.0 * x0
                                    )
                                    - 3617.0 / 162820783125.0
                                )
                                + 4.0 / 18243225.0
                            )
                            - 1382.0 / 638512875.0
                        )
                        + 2.0 / 93555.0
                    )
                    - 1.0 / 4725.0
                )
                + 2.0 / 945.0
            )
            - 1.0 / 45.0
        )
        + 1.0 / 3.0
    )
    slope = (
        x0
        * (
            x0
            * (
                x0
                * (
                    x0
                    * (
                        x0
                        * (
                            x0
                            * (
                                x0
                                * (
                                    x0
                                    * (87734.0 / 2292899734125.0 - 349222.0 / 80596287646875.0 * x0)
                                    - 3617.0 / 10854718875.0
                                )
                                + 4.0 / 1403325.0
                            )
                            - 1382.0 / 58046625.0
                        )
                        + 2.0 / 10395.0
                    )
                    - 1.0 / 675.0
                )
                + 2.0 / 189.0
            )
            - 1.0 / 15.0
        )
        + 1.0 / 3.0
    )
    return extension, slope
