"""What a step of drag and thermal noise does to each coordinate, from the emitted block."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import cache_functions
from tweezer.generated import langevin

cache_functions(langevin)

Array = NDArray[np.float64]

#: the longest step of the emitted series, in relaxation times and in 1/|kappa|
_SHORT = 1 / 64


class Weights(NamedTuple):
    """A step of each coordinate, all (dims,), for a slow velocity u that rises by du over it.

    x gains by_v v + by_u u + by_rise du + noise_x n, and v becomes
    decay v + v_by_u u + v_by_rise du + noise_xv n + noise_v n', where u is the whole slow velocity
    at x, spring and all, and du what is beyond the spring.
    """

    by_v: Array
    """s"""
    by_u: Array
    """s"""
    by_rise: Array
    """s"""
    decay: Array
    v_by_u: Array
    v_by_rise: Array
    kappa: Array
    """1/s, of the spring that is taken exactly"""
    noise_x: Array
    """m, or rad"""
    noise_xv: Array
    """m/s, or rad/s: the part of the velocity's noise that goes with the position's"""
    noise_v: Array
    """m/s, or rad/s"""


def inertial_block(h: float, tau: float, kappa: float) -> Array:
    """d, j, l, c_xx and c_vv of a step of any length: see `derivation.langevin`."""
    halvings = _halvings(h / tau, abs(kappa) * h, math.sqrt(abs(kappa) / tau) * h)
    h = math.ldexp(h, -halvings)
    block = np.array(langevin.inertial_of_a_short_step(h, tau, kappa))
    for _ in range(halvings):
        block = np.array(langevin.inertial_of_twice_the_step(h, tau, kappa, block))
        h *= 2
    return block


def overdamped_block(h: float, kappa: float) -> Array:
    """d and j of a step of any length."""
    halvings = _halvings(abs(kappa) * h)
    h = math.ldexp(h, -halvings)
    block = np.array(langevin.overdamped_of_a_short_step(h, kappa))
    for _ in range(halvings):
        block = np.array(langevin.overdamped_of_twice_the_step(h, kappa, block))
        h *= 2
    return block


def _halvings(*sizes: float) -> int:
    return max(0, math.ceil(math.log2(max(max(sizes) / _SHORT, 1.0))))


def exact(h: float, tau: Array, kappa: Array, diffusion: Array) -> Weights:
    """The exact step; tau = 0 for a coordinate without inertia. All (dims,).

    diffusion: kT/beta, m^2/s or rad^2/s; kT/m is that over tau.
    """
    columns = [
        _inertial(h, *each) if each[0] > 0 else _overdamped(h, *each[1:])
        for each in zip(tau.tolist(), kappa.tolist(), diffusion.tolist(), strict=True)
    ]
    return Weights(*np.array(columns, dtype=np.float64).T.copy())


def _inertial(h: float, tau: float, kappa: float, diffusion: float) -> tuple[float, ...]:
    block = inertial_block(h, tau, kappa)
    *weights, c_xv = langevin.inertial_step(h, tau, kappa, block)
    c_xx, c_vv = block[3:].tolist()
    size = math.sqrt(diffusion / tau)
    return (
        *weights, kappa, size * math.sqrt(c_xx), size * c_xv / math.sqrt(c_xx),
        size * math.sqrt(c_vv - c_xv * c_xv / c_xx),
    )  # fmt: skip


def _overdamped(h: float, kappa: float, diffusion: float) -> tuple[float, ...]:
    by_u, by_rise, spread = langevin.overdamped_step(h, kappa, overdamped_block(h, kappa))
    return 0.0, by_u, by_rise, 0.0, 0.0, 0.0, kappa, math.sqrt(diffusion * spread), 0.0, 0.0
