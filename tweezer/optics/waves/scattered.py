"""Scattering by a sphere and the operator of the direction, on amplitudes of partial waves.

Amplitudes p_nm are arrays (..., 2, 2N + 1, N + 1): helicity +1 and -1, order m from -N, degree n
from 0. The scattered light is T p with -2 a_n for electric and -2 b_n for magnetic waves, which are
(p^+ + p^-)/sqrt(2) and (p^+ - p^-)/sqrt(2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tweezer.optics.waves.binding import highest_degree
from tweezer.optics.waves.harmonics import elements
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.sphere import mie_coefficients

ComplexArray = NDArray[np.complex128]

_HELICITY = np.array([1.0, -1.0])[:, None, None]


def sphere(light: Waves, tolerance: float) -> tuple[ComplexArray, ComplexArray]:
    """Return the Mie coefficients a_n and b_n that count, n = 0..N, with 0 for n = 0.

    The sum of those left out, weighted by 2n + 1, is below `tolerance` of the largest.
    """
    x = light.size_parameter
    a, b = mie_coefficients(light.shells, light.wavenumber, int(x + 6 * x ** (1 / 3)) + 12)
    count = highest_degree(a, b, tolerance)
    return tuple(np.pad(each[:count], (1, 0)) for each in (a, b))  # type: ignore[return-value]


def scatter(p: ComplexArray, a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """Return T p of amplitudes p to the degree N or higher, by Mie coefficients a, b (N + 1,)."""
    extra = p.shape[-1] - len(a)
    total, difference = (-np.pad(each, (0, extra)) for each in (a + b, a - b))
    return np.asarray(total * p + difference * p[..., ::-1, :, :])


def absorb(p: ComplexArray, a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """Return (1 - S+ S) p with S = 1 + T: its product with p is the absorbed power."""
    extra = p.shape[-1] - len(a)
    of_a, of_b = (np.pad(4 * (each.real - np.abs(each) ** 2), (0, extra)) for each in (a, b))
    return np.asarray((of_a + of_b) / 2 * p + (of_a - of_b) / 2 * p[..., ::-1, :, :])


def directed(p: ComplexArray) -> ComplexArray:
    """Return s_x p, s_y p and s_z p, of which the highest degree lacks its upper neighbour.

    The result has the components of the direction s as its first dimension.
    """
    e = elements(p.shape[-1] - 1)
    plus, minus, along = (np.zeros_like(p) for _ in range(3))
    within, turned = _HELICITY * e.within, _HELICITY * e.turned
    along += within * p
    along[..., 1:] += e.along[:, 1:] * p[..., :-1]
    along[..., :-1] += e.along[:, 1:] * p[..., 1:]
    below, above = p[..., :-1, :], p[..., 1:, :]
    plus[..., 1:, :] += turned[:, :-1] * below
    plus[..., 1:, 1:] += e.raised[:-1, :-1] * below[..., :-1]
    plus[..., 1:, :-1] += e.lowered[:-1, 1:] * below[..., 1:]
    minus[..., :-1, :] += turned[:, :-1] * above
    minus[..., :-1, :-1] += e.raised[:-1, :-1] * above[..., 1:]
    minus[..., :-1, 1:] += e.lowered[:-1, 1:] * above[..., :-1]
    return np.stack([(plus + minus) / 2, (plus - minus) / 2j, along])


def moved(p: ComplexArray, a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """Return v_i = T s_i p - s_i T p: the outgoing light of a bead that moves along axis i is
    changed by i k v_i for each metre.

    `p` contains degrees to N + 1 or higher, if the Mie coefficients a, b (N + 1,) reach N.
    """
    return scatter(directed(p), a, b) - directed(scatter(p, a, b))


def products(bra: ComplexArray, ket: ComplexArray) -> ComplexArray:
    """Return <bra_i|ket_j> (n, 3, 3) of vectors of amplitudes (3, n, ...), summed over states."""
    flat = (each.reshape(*each.shape[:2], -1) for each in (bra.conj(), ket))
    return np.asarray(np.einsum("ipa,jpa->pij", *flat))
