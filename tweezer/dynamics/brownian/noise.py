"""Normal random numbers by counter: a function of (seed, trajectory, step, place) and nothing else.

Philox4x64-10 (Salmon, Moraes, Dror, Shaw, SC'11) turns a key and a counter into four words; there
is no state, so a trajectory is the same however trajectories are batched, spread over threads or
machines, and begun again in the middle. A word becomes a normal number by the ziggurat of
Marsaglia and Tsang (J. Stat. Softw. 5:8 (2000)) with 256 layers. One word in 80 is not enough:
further ones come from counters of their own.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from llvmlite import ir
from numba import int64, njit, types, uint64
from numba.extending import intrinsic
from numpy.typing import NDArray

from tweezer.compiled import cached_njit

#: what a number is drawn for, the last word of the counter; attempts at a turn count on
NOISE, START, TURN = 0, 1, 2

#: multipliers and increments of the key of Philox4x64, and its rounds
_M0, _M1 = np.uint64(0xD2E7470EE14C6C93), np.uint64(0xCA5A826395121157)
_W0, _W1 = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBB67AE8584CAA73B)
_ROUNDS = 10

#: layers of the ziggurat, where its base ends, and the area of a layer
_LAYERS = 256
_END = 3.6541528853610088
_AREA = _END * math.exp(-0.5 * _END**2) + math.sqrt(math.pi / 2) * math.erfc(_END / math.sqrt(2))


def _ziggurat() -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Of each layer, first those of the numbers above 0, then those below: width over 2^52; first
    fraction not within the layer above. And the density at the edges of the layers.
    """
    edges = np.empty(_LAYERS + 1)
    edges[0] = _AREA / math.exp(-0.5 * _END**2)
    edges[1] = _END
    for i in range(2, _LAYERS):
        density = _AREA / edges[i - 1] + math.exp(-0.5 * edges[i - 1] ** 2)
        edges[i] = math.sqrt(-2.0 * math.log(density))
    edges[_LAYERS] = 0.0
    width = edges[:-1] / 2.0**52
    within = (edges[1:] / edges[:-1] * 2.0**52).astype(np.int64)
    return np.append(width, -width), np.append(within, within), np.exp(-0.5 * edges**2)


_WIDTH, _WITHIN, _DENSITY = _ziggurat()


@intrinsic
def _high_product(typing_context: Any, a: Any, b: Any) -> Any:  # noqa: ARG001
    """The upper 64 bits of the product of two words."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
        wide = ir.IntType(128)
        first, second = (builder.zext(argument, wide) for argument in arguments)
        high = builder.lshr(builder.mul(first, second), ir.Constant(wide, 64))
        return builder.trunc(high, ir.IntType(64))

    return types.uint64(types.uint64, types.uint64), codegen


@njit(inline="always")
def philox(seed, c0, c1, c2, c3):  # type: ignore[no-untyped-def]
    """Four words of the key (seed, 0) and the counter (c0, c1, c2, c3); all are uint64."""
    k0, k1 = seed, uint64(0)
    for _ in range(_ROUNDS):
        high0, low0 = _high_product(_M0, c0), _M0 * c0
        high1, low1 = _high_product(_M1, c2), _M1 * c2
        c0, c1, c2, c3 = high1 ^ c1 ^ k0, low1, high0 ^ c3 ^ k1, low0
        k0 += _W0
        k1 += _W1
    return c0, c1, c2, c3


@njit(inline="always")
def _uniform(word):  # type: ignore[no-untyped-def]
    """In (0, 1)."""
    return (float(word >> uint64(11)) + 0.5) * 2.0**-53


@njit(inline="always")
def _layer_and_fraction(word):  # type: ignore[no-untyped-def]
    """The lowest nine bits of a word, sign and layer, and the next 52."""
    return int64(word & uint64(0x1FF)), int64((word >> uint64(9)) & uint64(0x000FFFFFFFFFFFFF))


@njit
def _at_the_edge(word, key, place, step, trajectory, purpose):  # type: ignore[no-untyped-def]
    """A normal number of a word that does not fall well within its layer."""
    attempt = uint64(0)
    while True:
        layer, fraction = _layer_and_fraction(word)
        x = float(fraction) * _WIDTH[layer]
        if fraction < _WITHIN[layer]:
            return x
        attempt += uint64(1)
        first, second, word, _ = philox(
            key, (place << uint64(32)) + attempt, step, trajectory, purpose
        )
        below = layer % _LAYERS
        if below > 0:
            low, high = _DENSITY[below], _DENSITY[below + 1]
            if low + _uniform(first) * (high - low) < math.exp(-0.5 * x * x):
                return x
            continue
        while True:  # the tail, of the sign drawn
            over = -math.log(_uniform(first)) / _END
            if -2.0 * math.log(_uniform(second)) > over * over:
                return math.copysign(_END + over, _WIDTH[layer])
            attempt += uint64(1)
            first, second, _, _ = philox(
                key, (place << uint64(32)) + attempt, step, trajectory, purpose
            )


@njit(inline="always")
def _normal(word, key, place, step, trajectory, purpose):  # type: ignore[no-untyped-def]
    """place: not 0, for further words; which number of the row it is."""
    layer, fraction = _layer_and_fraction(word)
    if fraction < _WITHIN[layer]:
        return float(fraction) * _WIDTH[layer]
    return _at_the_edge(word, key, place, step, trajectory, purpose)


@cached_njit(error_model="numpy", nogil=True)
def normals(seed, trajectories, step, purpose, out):  # type: ignore[no-untyped-def]
    """Fill `out` (m, n) with normal numbers: column i of trajectories[i], (n,) int64.

    seed, step, purpose: int64. A number depends on its row, but not on how many there are.
    """
    key, at, why = uint64(seed), uint64(step), uint64(purpose)
    rows = out.shape[0]
    for first in range(0, rows, 4):
        place = uint64(first)
        for i in range(out.shape[1]):
            trajectory = uint64(trajectories[i])
            a, b, c, d = philox(key, place, at, trajectory, why)
            out[first, i] = _normal(a, key, place + uint64(1), at, trajectory, why)
            if first + 1 < rows:
                out[first + 1, i] = _normal(b, key, place + uint64(2), at, trajectory, why)
            if first + 2 < rows:
                out[first + 2, i] = _normal(c, key, place + uint64(3), at, trajectory, why)
            if first + 3 < rows:
                out[first + 3, i] = _normal(d, key, place + uint64(4), at, trajectory, why)
