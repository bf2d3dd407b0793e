"""The drag of a sphere beside a wall in a fluid with inertia, by quadrature over plane waves.

The flow of a force F e^(st) at the height h, weighted for a sphere, meets the wall as waves
e^(i q X). For each wave two amplitudes, of a gradient and of a flow with vorticity, stop both
components on the wall: they are solved for here as numbers. What comes back, felt with the same
weights (B. U. Felderhof, J. Phys. Chem. B 109, 21406 (2005), for a point), is G. Units: radius,
6 pi eta r and tau_f.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicSpline


def returned(x, height, across, waves=4000):
    """G at one x = sqrt(s tau_f), |x| > 0.01, by the midpoint rule in ln q and long numbers."""
    x = np.clongdouble(x)
    edges = np.linspace(math.log(1e-6), math.log(60 / height), waves + 1, dtype=np.longdouble)
    q = np.exp((edges[1:] + edges[:-1]) / 2)
    step = edges[1] - edges[0]
    l = np.sqrt(q**2 + x**2)
    # weights of a gradient and of a flow with vorticity, of what is sent and of what is felt
    send_p, send_v = 1 + x + x**2 / 3, np.exp(x)
    p, v = send_p * np.exp(-q * height), send_v * np.exp(-l * height)
    eta = 1 / (6 * np.longdouble(np.pi))
    per_force = 1 / (2 * eta * x**2)
    if across:
        along, up = 1j * q * (p - v), q * p - q**2 / l * v
    else:
        along, up = l * v - q * p, 1j * q * (p - v)
    # along + i q P + V = 0 and up - q P + (i q/l) V = 0 on the wall
    determinant = 1j * q * (1j * q / l) + q
    P = (-along * (1j * q / l) + up) / determinant
    V = (-1j * q * up - q * along) / determinant
    felt = -q * P * p + 1j * q / l * V * v if across else 1j * q * P * p + V * v
    total = 2 * felt if across else felt - x**2 / l * v**2
    return complex((q**2 * total).sum() * step * per_force / (4 * np.longdouble(np.pi)))


def drag(x, height, mobility, across):
    """gamma over that far away at s = 0; mobility: the exact one, of slow motion."""
    free = 1 + x + x**2 / 9
    size = 1 / height
    odd = (18, -8, 2) if across else (9, -2, 1)
    still = -sum(n * size**power for n, power in zip(odd, (1, 3, 5), strict=True)) / 16
    return free / (1 + (1 - mobility) / -still * returned(x, height, across) / free)


class Density:
    """One-sided spectrum of the position, m^2/Hz, of a bead in a trap beside a wall."""

    def __init__(self, stiffness, far, temperature, mass, displaced_mass, height, mobility, across):
        self.kT, self.far, self.stiffness, self.mass = (
            1.380649e-23 * temperature, far, stiffness, mass
        )  # fmt: skip
        self.time = 4.5 * displaced_mass / far
        x = np.geomspace(0.01, 40.0, 160)
        found = [drag(each * np.exp(0.25j * np.pi), height, mobility, across) for each in x]
        self.ends = x[0], x[-1]
        self.real, self.imaginary = (
            CubicSpline(np.log(x), part(found)) for part in (np.real, np.imag)
        )
        self.still = found[0]

    def gamma(self, f):
        """Drag, kg/s, at frequencies f > 0, Hz."""
        x = np.sqrt(2 * math.pi * f * self.time)
        at = np.log(np.clip(x, *self.ends))
        # below the table the real part stays, and the imaginary one falls as f
        imaginary = self.imaginary(at) * np.minimum(x / self.ends[0], 1) ** 2
        return self.far * (self.real(at) + 1j * imaginary)

    def __call__(self, f):
        """At frequencies f (Hz), which may be negative."""
        f = np.abs(f)
        w, gamma = 2 * math.pi * f, self.gamma(f)
        force = self.stiffness + 1j * w * gamma - self.mass * w**2
        return 4 * self.kT * gamma.real / np.abs(force) ** 2
