"""Partial waves of the light in the frame of a turned body.

A field that is turned by R = Rz(alpha) Ry(beta) Rz(gamma) has the amplitudes D(R) p, and the light
in the body's frame has p_b = D(R)^+ p. With Delta^n = d^n(pi/2),

    p_b = e^(i gamma m) Z* Delta^T e^(-i beta k) Delta Z e^(i alpha m) p,   Z = diag(i^m).

Both products are sums over orders, for eight degrees n at a time. Two symmetries leave a quarter of
the terms, Delta_{-m,k} = (-1)^(n+k) Delta_mk and Delta_{m,-k} = (-1)^(n+m) Delta_mk. The orders m
and -m enter as sums and differences, and even and odd orders are separate.

Amplitudes of one field are an array (2, `length_of(highest)`): the electric and the magnetic
component, each with a guard of LANES numbers, all real parts, all imaginary parts, and a guard. The
parts are rows of `highest` + 1 degrees for the orders from -(highest + 2) to highest + 2.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tweezer.compiled import named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, store
from tweezer.optics.bodies.rotation import wigner_delta
from tweezer.values.arrays import Array

OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "inner": True}

#: Rows of zeros beyond the orders -highest and highest
MARGIN = 2
#: Components of a field: real and imaginary part, electric and magnetic
_FOUR = 4
#: Numbers of an order in a block of eight degrees
_ORDER = _FOUR * LANES
#: Orders k whose sums are computed together; half of the orders in a block have one parity
_TOGETHER = 4


@named_njit(**OPTIONS)
def imaginary_of(highest):  # type: ignore[no-untyped-def]
    """Return the number of real parts of one component: from a real to its imaginary part."""
    return (2 * (highest + MARGIN) + 1) * (highest + 1)


@named_njit(error_model="numpy")
def length_of(highest):  # type: ignore[no-untyped-def]
    """Return the length of one component in an array of amplitudes."""
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
def _add_products(table, at, combined, first, count, sums, to):  # type: ignore[no-untyped-def]
    """Store the sums over `count` orders m of Delta_mk times combinations, for four orders k.

    The combinations begin at the index `first` in `combined`. The numbers Delta, four k for each
    order, begin at the index `at` in `table`. The sums (4 k, 4 components, 8 degrees) are stored in
    `sums`, beginning at the index `to`.
    """
    a0, a1, a2, a3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    b0, b1, b2, b3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    c0, c1, c2, c3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    d0, d1, d2, d3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for _ in range(count):
        w, x = lanes(combined, first), lanes(combined, first + LANES)
        y, z = lanes(combined, first + 2 * LANES), lanes(combined, first + 3 * LANES)
        d = lanes(table, at)
        a0, a1, a2, a3 = a0 + d * w, a1 + d * x, a2 + d * y, a3 + d * z
        d = lanes(table, at + LANES)
        b0, b1, b2, b3 = b0 + d * w, b1 + d * x, b2 + d * y, b3 + d * z
        d = lanes(table, at + 2 * LANES)
        c0, c1, c2, c3 = c0 + d * w, c1 + d * x, c2 + d * y, c3 + d * z
        d = lanes(table, at + 3 * LANES)
        d0, d1, d2, d3 = d0 + d * w, d1 + d * x, d2 + d * y, d3 + d * z
        first += _ORDER
        at += _TOGETHER * LANES
    for i, value in enumerate((a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3, d0, d1, d2, d3)):
        store(sums, to + i * LANES, value)


@named_njit(**OPTIONS)
def _put(combined, half, m, c, plus, minus):  # type: ignore[no-untyped-def]
    """Store the combinations of the order m: `plus` for even k, `minus` for odd k.

    Both are (re, im) of the component c. Even orders come first, then odd ones.
    """
    orders = half // _ORDER
    at = (m // 2 + (m % 2) * (orders // 2)) * _ORDER + 2 * c * LANES
    store(combined, at, plus[0])
    store(combined, at + LANES, plus[1])
    store(combined, half + at, minus[0])
    store(combined, half + at + LANES, minus[1])


@named_njit(**OPTIONS)
def turn(p, table, alternating, highest, degree, most, alpha, beta, gamma, room, out):  # type: ignore[no-untyped-def]
    """Fill `out` with the amplitudes in the body's frame, from `p` in the laboratory's.

    The sums are computed for eight degrees n at a time, from the lowest, whose orders are few.

    Parameters
    ----------
    p : ndarray
        Amplitudes P_nm without the factor i^m (p_nm = i^m P_nm), as described in the module.
    table : ndarray
        Delta_mk, in the order in which the sums read it; see `delta_table`.
    alternating : ndarray, shape (8,)
        1, -1, 1, ...
    highest : int
        Highest degree of the arrays; `highest` + 1 is a multiple of 8.
    degree : int
        Highest degree that is computed.
    most : int
        Highest order of `p` that is not zero.
    alpha, beta, gamma : tuple of float
        (cos, sin) of the Euler angles of the body.
    room : ndarray
        Two lists of combinations of one block, and sums, (3, 8 orders of the last block 8).
    out : ndarray
        Amplitudes p_nm, with the factor i^m, of all orders; zero elsewhere.
    """
    imaginary = imaginary_of(highest)
    first, second, sums = room[0], room[1], room[2]
    sign = lanes(alternating, 0)
    entry = 0
    for block in range(0, degree + 1, LANES):
        orders = block + LANES
        half = orders * _ORDER  # combinations for even k, then for odd k
        top = min(most, orders - 1)
        # Delta_km = (-1)^(k-m) Delta_mk, so that i^m e^(i alpha m) (-1)^m p = e^(i alpha m) P
        re, im = 1.0, 0.0
        for m in range(top + 1):
            above, below = row_of(m, highest) + block, row_of(-m, highest) + block
            for c in range(2):
                own = p[c]
                u, v = _by(lanes(own, above), lanes(own, above + imaginary), re, im)
                if m == 0:
                    _put(first, half, m, c, (u, v), (u, v))
                else:
                    x, y = _by(lanes(own, below), lanes(own, below + imaginary), re, -im)
                    x, y = sign * x, sign * y
                    _put(first, half, m, c, (u + x, v + y), (u - x, v - y))
            re, im = re * alpha[0] - im * alpha[1], re * alpha[1] + im * alpha[0]
        _sums_of_block(table, entry, first, orders, top, sums)
        re, im = 1.0, 0.0  # (-1)^k e^(i beta k)
        for k in range(orders):
            even = _place_of_sum(k, orders)
            odd = even + _TOGETHER * _ORDER
            for c in range(2):
                at = 2 * c * LANES
                e_re, e_im = lanes(sums, even + at), lanes(sums, even + at + LANES)
                o_re, o_im = lanes(sums, odd + at), lanes(sums, odd + at + LANES)
                if k == 0:
                    both = (e_re + o_re, e_im + o_im)
                    _put(second, half, k, c, both, both)
                else:
                    # e^(-i beta k) (even + odd) +- e^(i beta k) (even - odd)
                    x, y = 2.0 * re, 2.0 * im
                    _put(
                        second, half, k, c, (x * e_re + y * o_im, x * e_im - y * o_re),
                        (y * e_im + x * o_re, x * o_im - y * e_re),
                    )  # fmt: skip
            re, im = im * beta[1] - re * beta[0], -(re * beta[1] + im * beta[0])
        _sums_of_block(table, entry, second, orders, orders - 1, sums)
        re, im = 1.0, 0.0  # (-i e^(i gamma))^m
        for m in range(orders):
            above, below = row_of(m, highest) + block, row_of(-m, highest) + block
            even = _place_of_sum(m, orders)
            odd = even + _TOGETHER * _ORDER
            for c in range(2):
                at, field = 2 * c * LANES, out[c]
                e_re, e_im = lanes(sums, even + at), lanes(sums, even + at + LANES)
                o_re, o_im = lanes(sums, odd + at), lanes(sums, odd + at + LANES)
                u, v = _by(e_re + o_re, e_im + o_im, re, im)
                store(field, above, u)
                store(field, above + imaginary, v)
                if m > 0:
                    u, v = _by(sign * (e_re - o_re), sign * (e_im - o_im), re, -im)
                    store(field, below, u)
                    store(field, below + imaginary, v)
            re, im = re * gamma[1] + im * gamma[0], im * gamma[1] - re * gamma[0]
        entry += orders * orders * LANES


@named_njit(**OPTIONS)
def _place_of_sum(k, orders):  # type: ignore[no-untyped-def]
    """Return the entry of the sum over even orders m for the order k; see `_sums_of_block`."""
    group, within = (k // 2) // _TOGETHER, (k // 2) % _TOGETHER
    groups = orders // (2 * _TOGETHER)
    return ((k % 2) * groups + group) * 2 * _TOGETHER * _ORDER + within * _ORDER


@named_njit(**OPTIONS)
def _sums_of_block(table, entry, combined, orders, top, sums):  # type: ignore[no-untyped-def]
    """Fill `sums` with the sums over even and odd orders m up to `top`, for each order k."""
    half = orders * _ORDER
    at, to = entry, 0
    for parity in range(2):
        begin = parity * half
        for _ in range(orders // (2 * _TOGETHER)):
            for odd in range(2):
                count = (top - odd) // 2 + 1
                _add_products(
                    table, at, combined, begin + odd * (orders // 2) * _ORDER, count, sums, to
                )
                at += (orders // 2) * _TOGETHER * LANES
                to += _TOGETHER * _ORDER


def delta_table(degree: int, highest: int) -> Array:
    """Return Delta^n_mk = d^n_mk(pi/2) up to a degree, in the order in which `turn` reads it.

    Each block of eight degrees has the axes (k parity, groups, m parity, m, four k, n). Degrees
    above `degree` up to `highest` are zero.
    """
    whole = np.zeros((highest + 1,) * 3)  # by k, m and n
    for n, delta in enumerate(wigner_delta(degree)):
        whole[: n + 1, : n + 1, n] = delta[n:, n:].T
    found = []
    for block in range(0, highest + 1, LANES):
        orders = block + LANES
        part = whole[:orders, :orders, block:orders]
        part = part.reshape(orders // 8, 4, 2, orders // 2, 2, LANES)  # groups, 4 k, parity; m; n
        found.append(part.transpose(2, 0, 4, 3, 1, 5).ravel())
    return np.concatenate(found)
