"""Light on a photodiode in the back focal plane behind a sphere.

The outgoing light in the direction s is, about the sphere at r and up to a phase,

    g(s) = g_0(s) exp(i k s.r) + sum over n, m and l of t^l_nm f^l_nm(theta) exp(i m phi) e_l,

with the light g_0 itself and the scattered waves t = T p. A diode has the signals

    V = integral over the aperture of D(s) |g(s)|^2 dOmega,

D = 1 for all of the light, sign(cos phi) and sign(sin phi) for the halves of a quadrant diode, and
the components of s for momentum. Moving the sphere along i changes g by i k v_i (`scattered`).

Nodes are Gauss's in theta, because halves of the light are odd in sin(theta), with panels inside
and outside of the cone of light. The azimuths phi_j have the weights

    w_j = (2 pi/N) sum over mu of D_mu exp(i mu phi_j)

with the Fourier coefficients D_mu of D. They integrate light with |mu| < N/2 exactly.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.optics.waves.amplitudes import Path
from tweezer.optics.waves.incident import (
    SMALL,
    TOGETHER,
    Incident,
    by_direction,
    directions,
    harmonics_of_both,
    widest_order,
)
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.scattered import moved, scatter, sphere
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

ComplexArray = NDArray[np.complex128]

#: Largest degree of the series of the light over the angle
_MOST_DEGREE = 400
#: Number of angles and of azimuths at which this series is computed
_ANGLES, _AZIMUTHS = 512, 64


@dataclass(frozen=True, eq=False)
class Diode:
    """A photodiode for the light of one beam, at rest and along +z, on a sphere."""

    path: Path
    """the light"""
    half_angle: float
    """of the collected light in the medium, rad"""
    kind: str
    """"quadrant", "linear" or "momentum" """
    forward: bool
    """whether the light is collected along the beam, or against it"""

    def signals(self, positions: Array, *, slopes: bool = False) -> tuple[Array, Array, Array]:
        """Return signals, their slopes and mean squares of their weights, for light of 1 W.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions of the sphere in the frame of the scene, m.
        slopes : bool, optional
            Whether to compute the slopes.

        Returns
        -------
        signals : ndarray, shape (n, 3)
            V for x, y and z, 1.
        slopes : ndarray, shape (n, 3, 3)
            dV/dx_j by signal and axis, 1/m; (n, 3, 0) unless `slopes`.
        squares : ndarray, shape (n, 3)
            Integrals of D^2 |g|^2, 1. The mean of a signal over a time tau has the variance
            hbar omega P/tau times them by shot noise, where P is the power.
        """
        if not len(positions):
            return np.zeros((0, 3)), np.zeros((0, 3, 3 if slopes else 0)), np.zeros((0, 3))
        view = _View(self, positions)
        parts = [
            view.signals(positions[first : first + TOGETHER], slopes=slopes)
            for first in range(0, len(positions), TOGETHER)
        ]
        signals, changes, squares = (np.concatenate(each) for each in zip(*parts, strict=True))
        return signals, changes, squares

    @property
    def light(self) -> Waves:
        """The plane waves of the light about its focus, and the sphere."""
        return self.path.light

    @functools.cached_property
    def mie(self) -> tuple[ComplexArray, ComplexArray]:
        """Mie coefficients a_n and b_n that count, n = 0..N."""
        return sphere(self.light, SMALL)

    @functools.cached_property
    def panels(self) -> tuple[tuple[float, float], ...]:
        """Intervals of the polar angle in which the collected light is smooth, rad."""
        edge = self.light.focus.half_angle
        if not self.forward:
            return ((math.pi - self.half_angle, math.pi),)
        if self.half_angle <= edge:
            return ((0.0, self.half_angle),)
        return (0.0, edge), (edge, self.half_angle)

    @functools.cached_property
    def degree(self) -> int:
        """Degree of the Chebyshev series of the collected light itself over the angle.

        Raises `SceneError` if it is too high.
        """
        if not self.forward:
            return 0
        low, high = self.panels[0]
        theta = low + (high - low) * (1 - np.cos(np.pi * np.arange(_ANGLES + 1) / _ANGLES)) / 2
        phi = 2 * math.pi * np.arange(_AZIMUTHS) / _AZIMUTHS
        values = by_direction(self.light, 2 * np.sin(theta / 2) ** 2, phi)
        rows = np.moveaxis(values, 2, -1).reshape(-1, _ANGLES + 1)
        series = np.fft.fft(np.concatenate([rows, rows[:, -2:0:-1]], axis=1))
        sizes = np.abs(series[:, : _ANGLES + 1]).max(axis=0)
        found = int(np.flatnonzero(sizes > SMALL * sizes.max()).max(initial=0))
        if found > _MOST_DEGREE:
            raise SceneError(
                "beam: the light behind the lens is too uneven for a detector; allowed: a series "
                f"over the angle of degree {_MOST_DEGREE}"
            )
        return found


class _View:
    """Nodes over the aperture of a diode, for positions (n, 3) of the sphere, m."""

    def __init__(self, diode: Diode, positions: Array) -> None:
        self.diode, light = diode, diode.light
        a, _ = diode.mie
        highest = len(a)  # of s_i T p
        self.waves = Incident((diode.path,), positions, highest, 0.0)
        self.focus = diode.path.place.at(0.0)
        far = light.wavenumber * np.linalg.norm(positions - self.focus, axis=1)
        phase = float(far.max(initial=0.0))
        bands = max(highest, widest_order(light) + phase + 5 * phase ** (1 / 3) + 8)
        count = 2 * math.ceil(highest + bands + 2)
        self.phi = 2 * math.pi * np.arange(count) / count
        self.orders = np.arange(-highest, highest + 1)
        turns = highest + max(highest, phase)
        angles, shares = [], []
        for low, high in diode.panels:
            inside = diode.degree if low < light.focus.half_angle else 0
            x = turns * (high - low) / 2
            nodes = math.ceil((max(inside + x, 2 * inside) + 5 * x ** (1 / 3) + 12) / 2)
            at, weight = np.polynomial.legendre.leggauss(nodes)
            angles.append(low + (high - low) * (1 + at) / 2)
            shares.append(weight * (high - low) / 2)
        theta = np.concatenate(angles)
        below = 2 * np.sin(theta / 2) ** 2
        self.harmonics = harmonics_of_both(highest, below)
        lit = diode.forward & (theta < light.focus.half_angle)
        inner = by_direction(light, below[lit], self.phi)
        self.incident = np.zeros((2, count, len(below), len(inner)), np.complex128)
        self.incident[:, :, lit] = inner.transpose(1, 3, 2, 0)
        self.s = directions(below, self.phi)
        share = np.concatenate(shares) * np.sin(theta)
        weights, squares = _weights(diode, self.s)
        self.weights = (share * weights).reshape(3, -1)
        self.squares = (share * squares).reshape(3, -1)

    def signals(self, positions: Array, *, slopes: bool) -> tuple[Array, Array, Array]:
        """Return signals, slopes and squares as `Diode.signals` does."""
        (a, b), k = self.diode.mie, self.diode.light.wavenumber
        p = self.waves.about(positions)
        g = self._far(scatter(p, a, b))
        phase = k * np.einsum("ifq,pi->fqp", self.s, positions - self.focus)
        turned = np.cos(phase) + 1j * np.sin(phase)
        g += self.incident[..., None] * turned[:, :, None]
        intensity = _summed(g.real**2 + g.imag**2)
        changes = np.zeros((3, 3 if slopes else 0, len(positions)))
        for axis, v in enumerate(moved(p, a, b) if slopes else ()):
            changes[:, axis] = -2 * k * (self.weights @ _summed((g.conj() * self._far(v)).imag))
        signals, squares = (self.weights @ intensity).T, (self.squares @ intensity).T
        return signals, changes.transpose(2, 0, 1), squares

    def _far(self, t: ComplexArray) -> ComplexArray:
        """Return light of amplitudes t (n, states, 2, orders, degrees) by direction.

        The result is (2, azimuths, nodes, states, n).
        """
        n, states = t.shape[:2]
        flat = np.ascontiguousarray(t.transpose(2, 3, 4, 1, 0)).reshape(*t.shape[2:], -1)
        around = (self.harmonics @ flat.view(np.float64)).view(np.complex128)
        series = np.zeros((2, len(self.phi), *around.shape[2:]), np.complex128)
        series[:, self.orders] = around
        g = np.fft.ifft(series, axis=1, norm="forward")
        return np.asarray(g.reshape(*g.shape[:3], states, n))


def _summed(each: Array) -> Array:
    """Return a quantity (2, azimuths, nodes, states, n) summed over states: (directions, n)."""
    return each.sum(axis=(0, 3)).reshape(-1, each.shape[-1])


def _weights(diode: Diode, s: Array) -> tuple[Array, Array]:
    """Return weights of the signals and of their mean squares by node, (3, azimuths, nodes).

    They contain the weights of the azimuths. `s` is the direction, (3, azimuths, nodes).
    """
    count, ones = s.shape[1], np.ones_like(s[0])
    step = 2 * math.pi / count
    if diode.kind == "quadrant":
        phi = step * np.arange(count)
        odd = np.arange(1, count // 2, 2)
        # D_mu = 2 sin(mu pi/2)/(pi mu) of sign(cos phi), for mu and -mu
        series = 4 * np.sin(odd * math.pi / 2) / (math.pi * odd)
        x, y = (np.cos(np.outer(phi - turn, odd)) @ series for turn in (0.0, math.pi / 2))
        D = np.stack([x[:, None] * ones, y[:, None] * ones, ones])
        return step * D, step * np.stack([ones] * 3)
    D = s if diode.kind == "momentum" else np.stack([*s[:2] / math.sin(diode.half_angle), ones])
    return step * D, step * D**2
