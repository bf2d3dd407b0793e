"""Open sectors of the pupil, outside of which no light passes.

A sector from the azimuth alpha to beta gives the light the factor T = 1 there, and 0 elsewhere. The
harmonics of T are the same at all radii,

    T = sum_q t_q exp(i q phi),   t_q = sum (exp(-i q alpha) - exp(-i q beta))/(2 pi i q),

with the sum over the sectors, and t_0 = sum (beta - alpha)/(2 pi). The Zernike terms of T are t_m
times integrals of polynomials over the radius.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tweezer.optics.zernike import gauss, radial_terms
from tweezer.values.arrays import Array, Complex

#: Harmonic up to which the transmitted intensity is expanded; light has no higher ones
_OF_POWER = 240
#: Part of the pupil that may be closed by rounding
_ROUNDED = 1e-12


@dataclass(frozen=True)
class Sectors:
    """Factor of the light that is 1 in sectors of the pupil and 0 elsewhere."""

    key: ClassVar[str] = "sectors"
    edges: tuple[tuple[float, float], ...]
    """azimuths between which each sector is open, rad"""

    @property
    def lossless(self) -> bool:
        """Whether all light passes."""
        return sum(end - begin for begin, end in self.edges) > 2 * math.pi * (1 - _ROUNDED)

    def harmonics(self, orders: NDArray[np.int64]) -> Complex:
        """Return the harmonics t_q of T of these orders."""
        found = np.zeros(len(orders), np.complex128)
        for begin, end in self.edges:
            half, middle = (end - begin) / 2, (end + begin) / 2
            size = half / math.pi * np.sinc(orders * half / math.pi)
            found += size * np.exp(-1j * orders * middle)
        return found

    def terms(self, degree: int) -> Complex:
        """Return the coefficients c_nm up to a degree; see `tweezer.optics.zernike.projected`."""
        return _terms(self, degree)

    def transmitted(self, rho: Array, phi: Array) -> Array:
        """Return |T|^2 at radii (n,) and azimuths (m,), (n, m), without its fine details."""
        if self.lossless:
            return np.ones((len(rho), len(phi)))
        orders = np.arange(-_OF_POWER, _OF_POWER + 1)
        around = (self.harmonics(orders) @ np.exp(1j * np.outer(orders, phi))).real
        return np.broadcast_to(around, (len(rho), len(phi)))


@functools.lru_cache(maxsize=32)
def _terms(sectors: Sectors, degree: int) -> Complex:
    """Return the coefficients of sectors; the rule of Gauss is exact for their polynomials."""
    x, weight = gauss(degree // 2 + 1)
    orders = np.arange(-degree, degree + 1)
    harmonics = np.broadcast_to(sectors.harmonics(orders), (len(x), len(orders)))
    return radial_terms(harmonics, orders, (x + 1) / 2, weight / 2, degree)
