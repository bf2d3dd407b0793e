"""Far field, photon recoil and detector signals of a sphere, plane wave by plane wave.

As in `tests.reference.plane_waves`, each plane wave of a focus is scattered by Mie's S1 and S2, and
nothing is expanded in multipoles. Amplitudes g are scaled so that |g|^2 is the power per solid
angle of the light far away, in the frame in which the sphere is at the origin.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.constants import c as SPEED_OF_LIGHT
from scipy.constants import hbar

from tests.reference.plane_waves import Light, Sphere, frame, scattered


class Far:
    """Light far from a sphere at one place, (3,) m from the focus.

    `finer` multiplies the numbers of nodes: a result that it does not change has converged.
    """

    def __init__(self, light: Light, sphere: Sphere, place, finer=1.0):
        self.light, self.place, self.finer = light, np.asarray(place, float), finer
        self.a, self.b = sphere.coefficients(light.k, light.medium)
        depth = 0 if light.cover is None else light.cover[1] * abs(light.cover[0] - light.medium)
        phase = light.k * (light.widest * (sphere.radius + np.linalg.norm(self.place)) + depth)
        across = light.k * math.sin(light.widest) * math.hypot(*self.place[:2])
        bands = across + 5 * across ** (1 / 3) + 8 + abs(light.vortex) + light.uneven
        count = int(finer * (phase / 2 + 4 * phase ** (1 / 3) + 16 + light.uneven))
        self.theta, weight = light.nodes(count)
        turns = int(finer * (2 * len(self.a) + bands + 10))
        self.phi = 2 * math.pi * np.arange(turns) / turns
        self.weight = weight * 2 * math.pi / turns
        self.s = frame(self.theta[:, None], self.phi)[0]
        self.g0 = self.incident(self.theta, self.phi)

    def incident(self, theta, phi):
        """g of the light itself, (states, 2, theta, phi), with the power of all states together."""
        s = frame(theta[:, None], phi)[0]
        turned = np.exp(1j * self.light.k * np.einsum("i,itf->tf", np.asarray(self.place), s))
        g = self.light.amplitudes(theta, phi) * turned
        return g / math.sqrt(len(g))

    def scattered(self, angle):
        """g of the scattered light T p on a circle, and of T s_i p: (4, states, 2, turns)."""
        factors = np.concatenate([np.ones((1, *self.s.shape[1:])), self.s])[:, None, None]
        weighted = np.fft.fft(self.g0 * factors * self.weight[:, None])
        return scattered(self.a, self.b, angle, self.theta, weighted)[0]

    def diffusion(self):
        """M_ij = Re<v_i|v_j> with v_i = T s_i p - s_i T p, and Re<s_i p|(1 - S+S)|s_j p>."""
        u, weights = leggauss(int(self.finer * (len(self.a) + 6)))
        M, lost = np.zeros((2, 3, 3))
        share = 2 * math.pi / len(self.phi)
        for angle, weight in zip(np.arccos(u), weights, strict=True):
            s = frame(np.full((1, 1), angle), self.phi)[0][:, 0]
            plain, *turned = self.scattered(angle)
            v = np.array(turned) - s[:, None, None] * plain
            M += weight * share * np.einsum("isef,jsef->ij", v.conj(), v).real
            lost -= weight * share * np.einsum("isef,jsef->ij", np.conj(turned), turned).real
        for q, angle in enumerate(self.theta):
            came = self.s[:, None, None, q] * self.g0[None, :, :, q]
            both = np.einsum("isef,jsef->ij", came.conj(), self.scattered(angle)[1:])
            lost -= self.weight[q] * (both + both.conj().T).real
        return M, lost

    def recoil(self):
        """d<P_i P_j>/dt, N^2 s."""
        omega = 2 * math.pi * SPEED_OF_LIGHT / self.light.wavelength
        return hbar * omega * (self.light.medium / SPEED_OF_LIGHT) ** 2 * sum(self.diffusion())

    def at(self, angle, phi):
        """|g0 + g1|^2 at one polar angle and azimuths phi, by the Fourier series of g1, (phi,)."""
        turns = len(self.phi)
        orders = np.fft.fftfreq(turns, 1 / turns)
        series = np.fft.fft(self.scattered(angle)[0]) / turns
        g = series @ np.exp(1j * orders[:, None] * phi)
        if angle < self.light.widest:
            g = g + self.incident(np.array([angle]), phi)[:, :, 0]
        return (np.abs(g) ** 2).sum(axis=(0, 1))

    def signal(self, edges, weigh, count=24, around=24):
        """Integral of weigh(theta, phi) |g|^2 over the polar angles between `edges`, per watt.

        Gauss's rule is applied to each quarter of the azimuths and between each pair of edges.
        `weigh` returns rows of weights at one polar angle and azimuths (phi,).
        """
        x, weight = leggauss(int(count * self.finer))
        y, across = leggauss(int(around * self.finer))
        quarter = math.pi / 2
        phi = np.concatenate([quarter * (i + (y + 1) / 2) for i in range(4)])
        across = np.tile(across * quarter / 2, 4)
        total = 0.0
        for low, high in pairwise(edges):
            for angle, share in zip(low + (high - low) * (x + 1) / 2, weight, strict=True):
                found = self.at(angle, phi) * across * share * (high - low) / 2 * math.sin(angle)
                total = total + weigh(angle, phi) @ found
        return total
