"""Partial waves of the light in the frame of a turned body.

A field that is turned by R = Rz(alpha) Ry(beta) Rz(gamma) has the amplitudes D(R) p, and the light
in the body's frame has p_b = D(R)^+ p. With Delta^n = d^n(pi/2),

    p_b = e^(i gamma m) Z* Delta^T e^(-i beta k) Delta Z e^(i alpha m) p,   Z = diag(i^m).

Both products are sums over orders, for eight degrees n at a time. The symmetries
Delta_{-m,k} = (-1)^(n+k) Delta_mk and Delta_{m,-k} = (-1)^(n+m) Delta_mk leave a quarter of the
terms: sums and differences of the orders m and -m, with even and odd orders apart.

Amplitudes of one field are an array (2, `length_of(highest)`): the electric and the magnetic
component, each with a guard of LANES numbers, all real parts, all imaginary parts, and a guard. The
parts are rows of `highest` + 1 degrees for the orders from -(highest + 2) to highest + 2.
"""

from __future__ import annotations

from typing import Any

from tweezer.compiled import named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, store

OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "inner": True}

#: Rows of zeros beyond the orders -highest and highest
MARGIN = 2
#: Components of the combinations: real and imaginary part, electric and magnetic
_FOUR = 4


@named_njit(**OPTIONS)
def imaginary_of(highest):  # type: ignore[no-untyped-def]
    """Return the number of real parts of one component: from a real to its imaginary part."""
    return (2 * (highest + MARGIN) + 1) * (highest + 1)


@named_njit(error_model="numpy")
def length_of(highest):  # type: ignore[no-untyped-def]
    """Return the number of entries of one component of an array of amplitudes."""
    return 2 * (2 * (highest + MARGIN) + 1) * (highest + 1) + 2 * LANES


@named_njit(**OPTIONS)
def row_of(m, highest):  # type: ignore[no-untyped-def]
    """Return the entry of the order m and degree 0 in an array of amplitudes."""
    return LANES + (m + highest + MARGIN) * (highest + 1)


@named_njit(**OPTIONS)
def _by(re, im, a, b):  # type: ignore[no-untyped-def]
    """Return (a + i b)(re + i im) for eight numbers re, im."""
    return a * re - b * im, a * im + b * re


@named_njit(**OPTIONS)
def _products(table, combined, k, top, block, stride, alternate):  # type: ignore[no-untyped-def]
    """Return the sums over even and over odd orders m of Delta_mk times combinations, eight each.

    They are four numbers (re, im of the electric, then of the magnetic component) for even m, and
    four for odd m. `combined` are the combinations (2, orders, 4, stride), flattened; `alternate`
    is 0 for even k and 1 for odd k.
    """
    a0, a1, a2, a3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    b0, b1, b2, b3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    last = min(top, block + LANES - 1)
    entry = (k * stride) * stride + block
    begin = alternate * stride * _FOUR * stride + block
    for m in range(0, last + 1, 2):
        d = lanes(table, entry + m * stride)
        at = begin + m * _FOUR * stride
        a0 = a0 + d * lanes(combined, at)
        a1 = a1 + d * lanes(combined, at + stride)
        a2 = a2 + d * lanes(combined, at + 2 * stride)
        a3 = a3 + d * lanes(combined, at + 3 * stride)
    for m in range(1, last + 1, 2):
        d = lanes(table, entry + m * stride)
        at = begin + m * _FOUR * stride
        b0 = b0 + d * lanes(combined, at)
        b1 = b1 + d * lanes(combined, at + stride)
        b2 = b2 + d * lanes(combined, at + 2 * stride)
        b3 = b3 + d * lanes(combined, at + 3 * stride)
    return (a0, a1, a2, a3), (b0, b1, b2, b3)


@named_njit(**OPTIONS)
def turn(p, table, alternating, highest, most, alpha, beta, gamma, room, out):  # type: ignore[no-untyped-def]
    """Fill `out` with the amplitudes in the body's frame, from `p` in the laboratory's.

    Parameters
    ----------
    p : ndarray
        Amplitudes P_nm without the factor i^m (p_nm = i^m P_nm), as described in the module.
    table : ndarray
        Delta_mk by k, m and n, each from 0 to `highest`, flattened.
    alternating : ndarray, shape (8,)
        1, -1, 1, ...
    highest : int
        Highest degree; `highest` + 1 is a multiple of 8.
    most : int
        Highest order of `p` that is not zero.
    alpha, beta, gamma : tuple of float
        (cos, sin) of the Euler angles of the body.
    room : ndarray
        Two lists of combinations, (2, 2 orders 4 stride).
    out : ndarray
        Amplitudes p_nm, with the factor i^m, of all orders; zero elsewhere.
    """
    stride = highest + 1
    imaginary = imaginary_of(highest)
    first, second = room[0], room[1]
    half = stride * _FOUR * stride
    sign = lanes(alternating, 0)
    top = min(most, highest)
    # Delta_km = (-1)^(k-m) Delta_mk, so that i^m e^(i alpha m) (-1)^m p_nm = e^(i alpha m) P_nm
    re, im = 1.0, 0.0
    for m in range(top + 1):
        above, below = row_of(m, highest), row_of(-m, highest)
        for block in range(m // LANES * LANES, stride, LANES):
            for c in range(2):
                own = above + block
                u, v = _by(lanes(p[c], own), lanes(p[c], own + imaginary), re, im)
                at = (m * _FOUR + 2 * c) * stride + block
                if m == 0:
                    store(first, at, u)
                    store(first, at + stride, v)
                    store(first, half + at, u)
                    store(first, half + at + stride, v)
                else:
                    x, y = _by(
                        lanes(p[c], below + block), lanes(p[c], below + imaginary + block), re, -im
                    )
                    x, y = sign * x, sign * y
                    store(first, at, u + x)
                    store(first, at + stride, v + y)
                    store(first, half + at, u - x)
                    store(first, half + at + stride, v - y)
        re, im = re * alpha[0] - im * alpha[1], re * alpha[1] + im * alpha[0]
    re, im = 1.0, 0.0  # (-1)^k e^(i beta k)
    for k in range(stride):
        for block in range(k // LANES * LANES, stride, LANES):
            even, odd = _products(table, first, k, top, block, stride, k % 2)
            at = k * _FOUR * stride + block
            for c in range(2):
                e_re, e_im = even[2 * c], even[2 * c + 1]
                o_re, o_im = odd[2 * c], odd[2 * c + 1]
                to = at + 2 * c * stride
                if k == 0:
                    store(second, to, e_re + o_re)
                    store(second, to + stride, e_im + o_im)
                    store(second, half + to, e_re + o_re)
                    store(second, half + to + stride, e_im + o_im)
                else:
                    # e^(-i beta k) (even + odd) +- e^(i beta k) (even - odd)
                    store(second, to, 2.0 * re * e_re + 2.0 * im * o_im)
                    store(second, to + stride, 2.0 * re * e_im - 2.0 * im * o_re)
                    store(second, half + to, 2.0 * im * e_im + 2.0 * re * o_re)
                    store(second, half + to + stride, 2.0 * re * o_im - 2.0 * im * e_re)
        re, im = im * beta[1] - re * beta[0], -(re * beta[1] + im * beta[0])
    re, im = 1.0, 0.0  # (-i e^(i gamma))^m
    for m in range(stride):
        above, below = row_of(m, highest), row_of(-m, highest)
        for block in range(m // LANES * LANES, stride, LANES):
            even, odd = _products(table, second, m, highest, block, stride, m % 2)
            for c in range(2):
                u, v = even[2 * c] + odd[2 * c], even[2 * c + 1] + odd[2 * c + 1]
                u, v = _by(u, v, re, im)
                store(out[c], above + block, u)
                store(out[c], above + imaginary + block, v)
                if m > 0:
                    u = sign * (even[2 * c] - odd[2 * c])
                    v = sign * (even[2 * c + 1] - odd[2 * c + 1])
                    u, v = _by(u, v, re, -im)
                    store(out[c], below + block, u)
                    store(out[c], below + imaginary + block, v)
        re, im = re * gamma[1] + im * gamma[0], im * gamma[1] - re * gamma[0]
