"""Mie coefficients of a sphere in layers, and the weights they give the bilinear sums of the force.

A wave of degree n in a layer is a sum of psi_n(z) and a second solution of z = m k r. From the core
outwards only z f'/f - (n+1) is carried, and of the solutions only ratios are formed, so that
nothing overflows (Yang, Appl. Opt. 42, 1710 (2003)); the formulas are `derivation.waves`'s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.generated import waves

#: Orders above |z| from which the recurrence of psi_n begins: this, and this times |z|^(1/3)
_BEGIN_ABOVE = (15, 7)
#: Largest Im z of a layer in which psi_n and chi_n differ enough to be two solutions
_LARGEST_DECAY_OF_CHI = 1.0

Array = NDArray[np.inexact]
Number = float | complex


@dataclass(frozen=True)
class _Solutions:
    """Two solutions for a wave of degree n = 1, 2, ... at one surface, as numbers without overflow.

    The first is psi_n(z), the Riccati-Bessel function that is regular at 0; the second is chi_n or
    xi_n. The argument is z = m k r, with the index m of the layer relative to the medium, and the
    radius r of the surface.
    """

    #: z f'/f - (n+1) of psi_n and of the second solution
    psi: Array
    second: Array
    #: ratio of psi_n to the second over that of degree n - 1; the first is ratio 1 exp(2 i decay)
    steps: Array
    #: z if the second solution is xi_n, else 0: keeps exponentials of z out of the steps
    decay: Number

    def ratio(self) -> Array:
        """Return psi_n over the second solution, times exp(2 i decay), for n = 1, 2, ..."""
        return np.cumprod(self.steps)

    def ratio_over(self, outer: _Solutions) -> Array:
        """Return the ratio of psi_n to the second solution here, over that ratio at `outer`.

        The exponentials of both, which may overflow, are divided first.
        """
        across = np.exp(2j * (outer.decay - self.decay)) if outer.decay else 1.0
        return across * np.cumprod(self.steps / outer.steps)


def _reduced_derivatives(z: Number, highest: int) -> Array:
    """Return g_n = z psi_n'/psi_n - (n+1) for n = 1..highest, psi_n the Riccati-Bessel function.

    The recurrence goes down, from an order where the start does not matter:
    g_n = -z^2/(2n + 3 + g_(n+1)).
    """
    begin = int(max(highest, abs(z)) + _BEGIN_ABOVE[0] + _BEGIN_ABOVE[1] * abs(z) ** (1 / 3))
    found = np.empty(highest, dtype=type(z))
    g = 0 * z
    for n in range(begin, 0, -1):
        g = -z * z / (2 * n + 3 + g)
        if n <= highest:
            found[n - 1] = g
    return found


def _ratios_upward(first: Number, z: Number, highest: int) -> Array:
    """Return the ratios f_n/f_(n-1) for n = 1..highest of a solution that does not fall with n.

    `first` is the ratio for n = 1. The recurrence of Riccati-Bessel functions is stable upward
    here.
    """
    found = np.empty(highest, dtype=type(z))
    found[0] = first
    for n in range(2, highest + 1):
        found[n - 1] = (2 * n - 1) / z - 1 / found[n - 2]
    return found


def _solutions(z: Number, highest: int, by_xi: bool) -> _Solutions:
    """Return the two solutions at z for n = 1..highest.

    With `by_xi` the second solution is xi_n = psi_n - i chi_n, for a layer that absorbs so strongly
    that psi_n and chi_n are proportional within rounding. Otherwise it is chi_n.
    """
    n = np.arange(1, highest + 1)
    psi = _reduced_derivatives(z, highest)
    rises = z / (2 * n + 1 + psi)
    if by_xi:
        # both without their exponentials exp(-iz) and exp(iz)
        sine, cosine = np.expm1(2j * z) / 2j, (np.exp(2j * z) + 1) / 2
        second_0, second_1, decay = -1j, -(1 + 1j / z), z
    else:
        sine, cosine = np.sin(z), np.cos(z)
        second_0, second_1, decay = cosine, cosine / z + sine, 0.0
    psi_1 = sine / z - cosine
    if abs(psi_1) < abs(sine):
        # psi_0 is far from its zeros
        psi_1 = sine * rises[0]
    second = _ratios_upward(second_1 / second_0, z, highest)
    steps = rises / second
    steps[0] = psi_1 / second_1
    return _Solutions(psi, z / second - (2 * n + 1), steps, decay)


def mie_coefficients(
    shells: tuple[tuple[float, complex], ...], wavenumber: float, highest: int
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Return the Mie coefficients a_n and b_n, n = 1..highest, of a sphere in layers.

    `shells` are listed from the core outwards, each with its outer radius (m) and its index
    relative to the medium; Im > 0 absorbs. `wavenumber` is the one in the medium (1/m). Fields vary
    as exp(-i omega t), and a_n and b_n are defined as in Bohren and Huffman, Absorption and
    Scattering of Light by Small Particles, (4.56) and (4.57). The coefficients are exactly zero for
    indices of 1. Real indices are calculated with real numbers, so that Re a_n of a small sphere
    keeps its digits beside Im a_n.
    """
    n = np.arange(1, highest + 1)
    # equal indices do not form a surface
    surfaces = [
        shell
        for shell, around in zip(shells, (*shells[1:], (np.inf, None)), strict=True)
        if shell[1] != around[1]
    ]
    real = all(complex(index).imag == 0 for _, index in surfaces)
    sizes = [wavenumber * radius for radius, _ in surfaces]
    indices = [complex(index).real if real else complex(index) for _, index in surfaces]
    electric = magnetic = _reduced_derivatives(indices[0] * sizes[0], highest)
    for inner, outer, index_in, index in zip(sizes, sizes[1:], indices, indices[1:], strict=False):
        electric = waves.electric_across.py_func(electric, index_in, index, n)
        by_xi = (index * outer).imag > _LARGEST_DECAY_OF_CHI
        begin, end = (_solutions(index * size, highest, by_xi) for size in (inner, outer))
        between = (begin.psi, begin.second, end.psi, end.second, begin.ratio_over(end))
        electric, magnetic = (waves.layer.py_func(g, *between) for g in (electric, magnetic))
    electric = waves.electric_across.py_func(electric, indices[-1], 1.0, n)
    around = _solutions(sizes[-1], highest, by_xi=False)
    a, b = (
        waves.reflected.py_func(g, around.psi, around.second, around.ratio())
        for g in (electric, magnetic)
    )
    return a[0] / (a[0] - 1j * a[1]), b[0] / (b[0] - 1j * b[1])


def _change(c: NDArray[np.complex128], d: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return (1 - 2 c)* (1 - 2 d) - 1 (* conjugates) without cancellation for small c and d."""
    return 4 * c.conj() * d - 2 * (c.conj() + d)


def weights(
    a: NDArray[np.complex128], b: NDArray[np.complex128], components: int
) -> tuple[NDArray[np.complex128], NDArray[np.complex128], NDArray[np.float64]]:
    """Return the weights U_n, V_n and K_n of the sums of the force for n = 1..N, (components, N).

    a, b: Mie coefficients a_n and b_n, (N,). The force is a sum over products of two partial waves
    of the light, which these numbers multiply. components: 2 for the electric and the magnetic
    component, 1 for light of one helicity. U_n weighs the elements of the direction between n and
    n+1 (a_(N+1) = b_(N+1) = 0), V_n those within n, K_n the angular momentum and the power. With T
    = 1 - 2 a_n or 1 - 2 b_n they are T_(n+1)* T_n - 1, T* T' - 1 of the two, and |T|^2 - 1, written
    as sums of small terms.
    """
    own = np.array([a, b])
    above = np.append(own[:, 1:], np.zeros((2, 1)), axis=1)
    U, V, K = _change(above, own), _change(own, own[::-1]), _change(own, own).real
    if components == 2:
        return U, V, K
    return tuple(each.mean(axis=0, keepdims=True) for each in (U, V, K))
