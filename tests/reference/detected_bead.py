"""A trapped bead in a fluid with inertia, before a detector: formulas by hand, exact records.

The spectrum is that of K. Berg-Sorensen and H. Flyvbjerg, Rev. Sci. Instrum. 75, 594 (2004), times
the blur's and the diode's (75, 594, and 77, 063106 (2006)); what is sampled has the sum of its
aliases. A record is drawn with that sum as the variances of its Fourier coefficients, over four
times its length, so that its ends are as far apart as in a record without end: no step, no poles.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import wofz

BOLTZMANN = 1.380649e-23


def density(
    f, k, drag, temperature, mass=0.0, displaced_mass=0.0, exposure=0.0, diode=math.inf, through=0.0
):
    """One-sided spectral density, m^2/Hz, at frequencies f (Hz), which may be negative.

    Their f_nu and f_m, the latter with the added mass: the displaced fluid of m_f has
    gamma_0 = 6 pi eta a, so nu/(pi a^2) = 2 gamma_0/(9 pi m_f).
    """
    f = np.abs(f)
    diffusion = BOLTZMANN * temperature / drag
    corner = k / (2 * math.pi * drag)
    with np.errstate(divide="ignore"):
        per_nu = 9 * math.pi * displaced_mass / (2 * drag)
        per_m = 2 * math.pi * (mass + displaced_mass / 2) / drag
    root = np.sqrt(f * per_nu)
    of_bead = (
        diffusion / math.pi**2 * (1 + root)
        / ((corner - f * root - f**2 * per_m) ** 2 + (f + f * root) ** 2)
    )  # fmt: skip
    low_pass = through**2 + (1 - through**2) / (1 + (f / diode) ** 2)
    return of_bead * np.sinc(f * exposure) ** 2 * low_pass


def correlation(t, k, drag, mass, displaced_mass):
    """<x(0) x(t)> over k_B T/k in the closed form of H. J. H. Clercx and P. P. J. M. Schram, Phys.
    Rev. A 46, 1942 (1992), by Faddeeva's function.
    """
    inertia, memory = mass + displaced_mass / 2, math.sqrt(4.5 * displaced_mass * drag)
    z = np.roots([inertia, memory, drag, 0, k])
    result = np.zeros(np.shape(t), complex)
    for i, root in enumerate(z):
        others = np.prod(root - np.delete(z, i))
        result -= k / inertia * wofz(-1j * root * np.sqrt(t)) / (root * others)
    return result.real


def sampled(f, step, density, aliases):
    """The one-sided density of samples every `step` (s), by its aliases."""
    folds = np.arange(-aliases, aliases + 1) / step
    return np.array([density(each + folds).sum() for each in np.atleast_1d(f)])


def drawn(density, step, samples, seed, records=1, aliases=1000):
    """Records (records, samples) of Gaussian motion with that one-sided density, every `step` (s).

    The sampled density is summed at 500 frequencies, and a spline between: its error is below
    1e-5. The zero frequency counts as the lowest one.
    """
    n = 4 * 2 ** math.ceil(math.log2(samples))
    lowest, nyquist = 1 / (n * step), 0.5 / step
    knots = np.geomspace(lowest, nyquist, 500)
    spline = CubicSpline(np.log(knots), np.log(sampled(knots, step, density, aliases)))
    f = np.fft.rfftfreq(n, step)
    f[0] = lowest
    root = np.sqrt(n * np.exp(spline(np.log(np.minimum(f, nyquist)))) / (4 * step))
    rng = np.random.default_rng(seed)
    positions = np.empty((records, samples))
    for row in positions:
        a, b = rng.standard_normal((2, len(f)))
        both = root * (a + 1j * b)
        both[[0, -1]] = math.sqrt(2) * both[[0, -1]].real
        row[:] = np.fft.irfft(both, n)[:samples]
    return positions
