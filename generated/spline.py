"""Uniform splines of degree 7.

Made by `python -m derivation` from derivation/spline.py; do not edit.
SymPy 1.14.0. 71 operations, 0 temporaries.

Between two knots, at 0 and 1, eight coefficients count. Their weights at t are sums of
powers of t.
"""


def spline_weights(out):
    """Coefficients of the weights: row k those of t^k, from the lowest knot up.

    out: (8, 8) filled with the result.
    71 operations, 0 temporaries.
    """
    out[0, 0] = 1.0 / 5040.0
    out[0, 1] = 1.0 / 42.0
    out[0, 2] = 397.0 / 1680.0
    out[0, 3] = 151.0 / 315.0
    out[0, 4] = 397.0 / 1680.0
    out[0, 5] = 1.0 / 42.0
    out[0, 6] = 1.0 / 5040.0
    out[0, 7] = 0.0
    out[1, 0] = -1.0 / 720.0
    out[1, 1] = -7.0 / 90.0
    out[1, 2] = -49.0 / 144.0
    out[1, 3] = 0.0
    out[1, 4] = 49.0 / 144.0
    out[1, 5] = 7.0 / 90.0
    out[1, 6] = 1.0 / 720.0
    out[1, 7] = 0.0
    out[2, 0] = 1.0 / 240.0
    out[2, 1] = 1.0 / 10.0
    out[2, 2] = 1.0 / 16.0
    out[2, 3] = -1.0 / 3.0
    out[2, 4] = 1.0 / 16.0
    out[2, 5] = 1.0 / 10.0
    out[2, 6] = 1.0 / 240.0
    out[2, 7] = 0.0
    out[3, 0] = -1.0 / 144.0
    out[3, 1] = -1.0 / 18.0
    out[3, 2] = 19.0 / 144.0
    out[3, 3] = 0.0
    out[3, 4] = -19.0 / 144.0
    out[3, 5] = 1.0 / 18.0
    out[3, 6] = 1.0 / 144.0
    out[3, 7] = 0.0
    out[4, 0] = 1.0 / 144.0
    out[4, 1] = 0.0
    out[4, 2] = -1.0 / 16.0
    out[4, 3] = 1.0 / 9.0
    out[4, 4] = -1.0 / 16.0
    out[4, 5] = 0.0
    out[4, 6] = 1.0 / 144.0
    out[4, 7] = 0.0
    out[5, 0] = -1.0 / 240.0
    out[5, 1] = 1.0 / 60.0
    out[5, 2] = -1.0 / 48.0
    out[5, 3] = 0.0
    out[5, 4] = 1.0 / 48.0
    out[5, 5] = -1.0 / 60.0
    out[5, 6] = 1.0 / 240.0
    out[5, 7] = 0.0
    out[6, 0] = 1.0 / 720.0
    out[6, 1] = -1.0 / 120.0
    out[6, 2] = 1.0 / 48.0
    out[6, 3] = -1.0 / 36.0
    out[6, 4] = 1.0 / 48.0
    out[6, 5] = -1.0 / 120.0
    out[6, 6] = 1.0 / 720.0
    out[6, 7] = 0.0
    out[7, 0] = -1.0 / 5040.0
    out[7, 1] = 1.0 / 720.0
    out[7, 2] = -1.0 / 240.0
    out[7, 3] = 1.0 / 144.0
    out[7, 4] = -1.0 / 144.0
    out[7, 5] = 1.0 / 240.0
    out[7, 6] = -1.0 / 720.0
    out[7, 7] = 1.0 / 5040.0
