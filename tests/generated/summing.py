"""Matrices of s and J between all harmonics by quadrature, and the arguments of the summands."""

import importlib

import numpy as np
from scipy.special import sph_harm_y

waves = importlib.import_module("tweezer.generated.waves")

#: highest degree of the harmonics in the matrices
HIGHEST = 6
HARMONICS = [(n, m) for n in range(1, HIGHEST + 1) for m in range(-n, n + 1)]
PLACE = {harmonic: i for i, harmonic in enumerate(HARMONICS)}
N, M = np.transpose(HARMONICS)


def harmonics(helicity, theta):
    """The harmonics at phi = 0: (harmonics, angles)."""
    rows = []
    for n, m in HARMONICS:
        value, gradient = sph_harm_y(n, m, theta, 0, diff_n=1)
        slope = gradient[..., 0]
        rows.append((slope + helicity * m * value / np.sin(theta)).real / np.sqrt(n * (n + 1)))
    return np.array(rows)


def direction():
    """s_x, s_y, s_z between harmonics of both helicities, +1 before -1."""
    cos, weight = np.polynomial.legendre.leggauss(HIGHEST + 2)
    theta = np.arccos(cos)
    size = len(HARMONICS)
    s_z, s_plus = np.zeros((2, 2 * size, 2 * size))
    for block, helicity in ((slice(size), 1), (slice(size, None), -1)):
        f = harmonics(helicity, theta)
        s_z[block, block] = 2 * np.pi * (M[:, None] == M) * ((f * weight * cos) @ f.T)
        raised = M[:, None] == M + 1
        s_plus[block, block] = 2 * np.pi * raised * ((f * weight * np.sin(theta)) @ f.T)
    return np.array([(s_plus + s_plus.T) / 2, (s_plus - s_plus.T) / 2j, s_z])


def angular_momentum():
    """J_x, J_y, J_z likewise."""
    lifted = np.array([[PLACE.get((n, m + 1), -1), (n - m) * (n + m + 1)] for n, m in HARMONICS])
    J_plus = np.zeros((len(HARMONICS), len(HARMONICS)))
    for column, (row, squared) in enumerate(lifted):
        J_plus[row, column] = np.sqrt(squared)
    both = np.kron(np.eye(2), J_plus)
    return np.array([(both + both.T) / 2, (both - both.T) / 2j, np.diag(np.tile(M, 2))])


S = direction()
J = angular_momentum()


def shifted(values, by_n, by_m):
    """Values at (n + by_n, m + by_m), real and imaginary; 0 where there is none."""
    found = [PLACE.get((n + by_n, m + by_m)) for n, m in HARMONICS]
    moved = np.array([0 if i is None else values[i] for i in found])
    return moved.real, moved.imag


def elements(n, m):
    """al, be, e1, e0, em at (n, m); 0 for what is no harmonic."""
    there = (n >= 1) & (abs(m) <= n)
    along, within, raised, turned, lowered = waves.squared_elements.py_func(
        np.where(there, n, 1.0), np.where(there, m, 0.0)
    )
    roots = [np.sqrt(along), within, -np.sqrt(raised), np.sqrt(turned), np.sqrt(lowered)]
    return [np.where(there, each, 0.0) for each in roots]


def elements_about():
    """al, al_above, be and the elements of s_+ from m-1 and to m+1, of every harmonic."""
    al, be, *raising = elements(N, M)
    from_down = [elements(N - 1 + i, M - 1)[2 + i] for i in range(3)]
    return [al, elements(N + 1, M)[0], be, *from_down, *raising]
