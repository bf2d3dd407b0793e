"""Normal random numbers by counter: a function of (seed, trajectory, step, row) and nothing else.

Threefry-4x64 with 20 rounds (Salmon, Moraes, Dror, Shaw, SC'11) turns a key and a counter into four
words. There is no state, so a trajectory is the same however trajectories are batched, spread over
threads or machines, and begun again in the middle.

Four words are three pairs of normal numbers (Box and Muller, Ann. Math. Stat. 29:610 (1958)): the
radius of a pair takes 52 bits, so that it ends at 8.57, and the angle 32. The logarithm, the sine
and the cosine are series without a branch, for eight trajectories at once.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import uint64

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import (
    LANES,
    as_lanes,
    as_words,
    chosen,
    lanes,
    root,
    rotated,
    spread,
    store,
    words,
)
from tweezer.compiled.stack import on_stack

#: purpose of a number, the last word of the counter; attempts at a turn count up from `TURN`
NOISE, START, TURN = 0, 1, 2
#: purpose of a number for a loss within a step, for the noise of the laser, and for a tick of a
#: controller
CROSSING, LASER, FEEDBACK = -2, -3, -4
#: purpose of a number for a camera; the words before it are then frame and trajectory
CAMERA = -1

#: Parity of the key of Threefry
_PARITY = np.uint64(0x1BD11BDAA9FC1A22)
#: Rotations of four rounds of Threefry-4x64, of the next four, and so on in turn
_ODD = tuple(map(np.uint64, (14, 16, 52, 57, 23, 40, 5, 37)))
_EVEN = tuple(map(np.uint64, (25, 33, 46, 12, 58, 22, 32, 32)))

#: Rows of numbers that one block of four words makes
_ROWS = 6
#: Numbers of one block of eight trajectories, and words of their radii and angles
_NUMBERS = _ROWS * LANES
#: Bits of the number 1, and of the numbers from 1 to 2 what distinguishes them
_ONE, _FRACTION = np.uint64(0x3FF0000000000000), np.uint64(0x000FFFFFFFFFFFFF)
#: Bits of sqrt(1/2)
_ROOT_HALF = np.uint64(np.float64(math.sqrt(0.5)).view(np.uint64))
#: Bits of 2^52, whose last bits are a whole number, and its value with the bias of exponents
_WHOLE, _BIAS = np.uint64(0x4330000000000000), 2.0**52 + 1023.0
_SIGN = np.uint64(1 << 63)
_LN_2 = math.log(2.0)

#: Coefficients of atanh(s)/s, sin(x)/x and cos(x), over powers of the square: to 1e-15
_ATANH = tuple(1 / (2 * k + 1) for k in range(9))
_SINE = tuple((-1) ** k / math.factorial(2 * k + 1) for k in range(9))
_COSINE = tuple((-1) ** k / math.factorial(2 * k) for k in range(9))
#: Bits of a word that its radius leaves
_LAST_11 = np.uint64(0x7FF)

_INNER: dict[str, Any] = {"inner": True, "error_model": "numpy", "forceinline": True}


@named_njit(**_INNER)
def _four_rounds(a, b, c, d, by):  # type: ignore[no-untyped-def]
    """Return four words after four rounds of Threefry, with the eight rotations `by`, in bits."""
    a = a + b
    b = rotated(b, by[0]) ^ a
    c = c + d
    d = rotated(d, by[1]) ^ c
    a = a + d
    d = rotated(d, by[2]) ^ a
    c = c + b
    b = rotated(b, by[3]) ^ c
    a = a + b
    b = rotated(b, by[4]) ^ a
    c = c + d
    d = rotated(d, by[5]) ^ c
    a = a + d
    d = rotated(d, by[6]) ^ a
    c = c + b
    b = rotated(b, by[7]) ^ c
    return a, b, c, d


@named_njit(**_INNER)
def threefry(key, a, b, c, d):  # type: ignore[no-untyped-def]
    """Return Threefry-4x64 random words: four vectors of eight words.

    key: four words. a, b, c, d: the counter, each eight words (one for each of eight trajectories).
    """
    k, l, m, n = key
    o = _PARITY ^ k ^ l ^ m ^ n
    a, b, c, d = _four_rounds(a + k, b + l, c + m, d + n, _ODD)
    a, b, c, d = _four_rounds(a + l, b + m, c + n, d + (o + uint64(1)), _EVEN)
    a, b, c, d = _four_rounds(a + m, b + n, c + o, d + (k + uint64(2)), _ODD)
    a, b, c, d = _four_rounds(a + n, b + o, c + k, d + (l + uint64(3)), _EVEN)
    a, b, c, d = _four_rounds(a + o, b + k, c + l, d + (m + uint64(4)), _ODD)
    return a + k, b + l, c + m, d + (n + uint64(5))


@named_njit(**_INNER)
def _series(c, z):  # type: ignore[no-untyped-def]
    """Return the polynomial c[0] + c[1] z + ... + c[8] z^8, for eight numbers z."""
    last = c[5] + z * (c[6] + z * (c[7] + z * c[8]))
    return c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * last))))


@named_njit(**_INNER)
def _logarithm(u):  # type: ignore[no-untyped-def]
    """Return log(u) for eight numbers 0 < u <= 1.

    With u = 2^e m and m from sqrt(1/2) to sqrt(2), it is e log(2) + 2 atanh((m - 1)/(m + 1)).
    """
    above = as_words(u) + (_ONE - _ROOT_HALF)
    e = as_lanes((above >> uint64(52)) | _WHOLE) - _BIAS
    m = as_lanes((above & _FRACTION) + _ROOT_HALF)
    s = (m - 1.0) / (m + 1.0)
    return (s + s) * _series(_ATANH, s * s) + e * _LN_2


@named_njit(**_INNER)
def _pair(radius, angle):  # type: ignore[no-untyped-def]
    """Return two normal numbers for each of eight pairs of random words, by Box and Muller.

    The upper 52 bits of each word in `radius` give the radius. The lower 32 bits of each word in
    `angle` give the angle: 30 bits its position within a quarter of the circle, two the quarter.
    """
    u = as_lanes((radius >> uint64(12)) | _ONE) - (1.0 - 2.0**-53)  # between 0 and 1
    r = root(-2.0 * _logarithm(u))
    r = as_lanes(as_words(r) ^ ((angle << uint64(32)) & _SIGN))
    part = as_lanes(((angle & uint64(0x3FFFFFFF)) << uint64(22)) | _ONE) - (1.5 - 2.0**-31)
    x = (0.5 * math.pi) * part
    sine, cosine = x * _series(_SINE, x * x), _series(_COSINE, x * x)
    other = angle & uint64(0x40000000)
    return r * chosen(other, sine, cosine), r * chosen(other, cosine, sine)


@cached_njit(error_model="numpy", nogil=True)
def normals(seed, trajectories, step, purpose, out):  # type: ignore[no-untyped-def]
    """Fill `out` (m, n) with normal random numbers, one column for each trajectory.

    trajectories: indices, (n,), int64. seed, step, purpose: int64, which with the trajectory and
    the row determine a number. A number does not depend on how many rows or columns are drawn.
    purpose: `NOISE`, `START`, `TURN` and so on.
    """
    zero = uint64(0)
    key = uint64(seed), zero, zero, zero
    rows, n = out.shape
    bits = on_stack(_NUMBERS, np.int64)
    drawn, who = on_stack(_NUMBERS, np.float64), on_stack(LANES, np.int64)
    for i in range(0, n, LANES):
        many = min(LANES, n - i)
        if many < LANES:
            for j in range(LANES):
                who[j] = trajectories[i + min(j, many - 1)]
            whose = words(who, 0)
        else:
            whose = words(trajectories, i)
        for first in range(0, rows, _ROWS):
            block = spread(uint64(first // _ROWS))
            a, b, c, d = threefry(key, block, whose, spread(uint64(step)), spread(uint64(purpose)))
            left = (a & _LAST_11) | ((b & _LAST_11) << uint64(11)) | (c << uint64(22))
            count = min(_ROWS, rows - first)
            for k, word in enumerate((a, b, c)):
                store(bits, k * LANES, word)
            for k, word in enumerate((d, d >> uint64(32), left)):
                store(bits, (3 + k) * LANES, word)
            for k in range((count + 1) // 2):
                one, other = _pair(words(bits, k * LANES), words(bits, (3 + k) * LANES))
                store(drawn, 2 * k * LANES, one)
                store(drawn, (2 * k + 1) * LANES, other)
            for row in range(count):
                if many == LANES:
                    store(out, (first + row) * n + i, lanes(drawn, row * LANES))
                else:
                    for j in range(many):
                        out[first + row, i + j] = drawn[row * LANES + j]
