"""Harmonics of helicity +1, and the matrix elements of the direction between them.

Y_nm = exp(i m phi) f_nm(theta) e_+, n = 1, 2, ..., |m| <= n, of norm 1 over the sphere. Those of
helicity -1 are their mirror images, f_nm -> (-1)^m f_n,-m. Tables are by order m, from -highest to
highest, and degree n, from 0; entries without a harmonic are 0.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np

from tweezer.generated import waves
from tweezer.values.arrays import Array


class Elements(NamedTuple):
    """Matrix elements between harmonics of the direction s and of the angular momentum J.

    Each field is an array over (m, n), degree n and order m; s_+ = s_x + i s_y, J_+ = J_x + i J_y.
    """

    along: Array
    """<n m|s_z|n-1 m>"""
    within: Array
    """<n m|s_z|n m>"""
    raised: Array
    """<n+1 m+1|s_+|n m>"""
    turned: Array
    """<n m+1|s_+|n m>"""
    lowered: Array
    """<n-1 m+1|s_+|n m>"""
    lift: Array
    """<n m+1|J_+|n m>"""


@functools.lru_cache(maxsize=8)
def elements(highest: int) -> Elements:
    """Return the matrix elements between vector harmonics of degree n and order m.

    They are for m = -highest..highest and n = 0..highest, see `Elements`; 0 where |m| > n or n = 0.
    """
    n = np.arange(highest + 1.0)[None, :]
    m = np.arange(-highest, highest + 1.0)[:, None]
    there = np.broadcast_to((n >= np.maximum(np.abs(m), 1)), (m.size, n.size))
    safe = np.broadcast_to(np.where(n == 0, 1.0, n), there.shape)
    along, within, raised, turned, lowered = (
        np.where(there, each, 0.0)
        for each in waves.squared_elements.py_func(safe, np.broadcast_to(m, there.shape))
    )
    roots = (np.sqrt(np.maximum(each, 0.0)) for each in (along, raised, turned, lowered))
    root_along, root_raised, root_turned, root_lowered = roots
    lift = np.sqrt(np.where(there, np.maximum((n - m) * (n + m + 1), 0.0), 0.0))
    return Elements(root_along, within, -root_raised, root_turned, root_lowered, lift)


def harmonics(highest: int, below: Array) -> Array:
    """Return the harmonics f_nm at 1 - cos(theta) = `below`, (nodes,).

    They are (orders m from -highest to highest, nodes, degrees n from 0 to highest). The recurrence
    from the lowest degree up follows from cos(theta) f_n = sum over n' of <n'|s_z|n> f_n'.
    """
    half_sine, half_cosine = np.sqrt(below / 2), np.sqrt(1 - below / 2)
    cosine = 1 - below
    orders = range(-highest, highest + 1)
    f = np.zeros((highest + 1, len(orders), below.size))
    for at, m in enumerate(orders):
        f[max(abs(m), 1), at] = _lowest(m, half_cosine, half_sine)
    along, within = elements(highest).along.T[:, :, None], elements(highest).within.T[:, :, None]
    for n in range(1, highest):
        has = slice(highest - n, highest + n + 1)  # |m| <= n
        next_along = along[n + 1, has]
        f[n + 1, has] = (
            (cosine - within[n, has]) * f[n, has] - along[n, has] * f[n - 1, has]
        ) / next_along
    return np.ascontiguousarray(np.moveaxis(f, 0, 2))


def _lowest(m: int, half_cosine: Array, half_sine: Array) -> Array:
    """Return the harmonic f_nm of the lowest degree, n = max(|m|, 1), from cos, sin(theta/2).

    Its norm is computed by logarithms, as factorials would overflow.
    """
    if m == 0:
        return -math.sqrt(1.5 / math.pi) * half_sine * half_cosine
    q = abs(m)
    size = 0.5 * (
        math.log((2 * q + 1) / (4 * math.pi))
        + math.lgamma(2 * q + 1) - math.lgamma(q + 2) - math.lgamma(q)
    )  # fmt: skip
    longer = half_cosine if m > 0 else half_sine
    with np.errstate(under="ignore"):
        powers = np.exp(size + (q - 1) * np.log(half_cosine * half_sine)) * longer**2
    return (-1.0) ** q * powers if m > 0 else -powers
