"""Exact force, torque and absorbed power of focused light on a sphere, plane wave by plane wave.

Debye's focus: plane waves in phase at the focus, E(r) = int_cone A(s) exp(ik s.r) dOmega. A sphere
scatters each of them by Mie's S1 and S2 (Bohren and Huffman, Absorption and Scattering of Light by
Small Particles, 1983, chapter 4). The scattered fields are added in every direction. Force and
torque are the momentum and the angular momentum that the light leaves behind, from integrals over
a far sphere; the absorbed power is the energy that it leaves behind.

The light is not expanded in multipoles anywhere. Lengths are in m, powers in W, forces in N. The
time factor is exp(-i w t), Im(n) > 0 absorbs, (1, i)/sqrt2 is helicity +1.

Amplitudes g are scaled so that |g|^2 is the power per solid angle, W/sr, of the light far away.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import mpmath as mp
import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.constants import c as SPEED_OF_LIGHT

Polarisation = tuple[complex, complex] | str | Callable


@dataclass(frozen=True)
class Light:
    """Light that an aplanatic lens focuses into a medium."""

    medium: float
    """refractive index about the sphere"""
    wavelength: float
    """in vacuum, m"""
    angle: float
    """theta_m, half the angle of the cone, rad, below pi/2; before the face of a cover"""
    W: Callable
    """W/sr of the angle to the axis; before the face of a cover"""
    polarisation: Polarisation = "unpolarised"
    """a Jones vector in the pupil of norm 1, as a function of the azimuth or constant, or
    "unpolarised", "radial", "azimuthal" """
    vortex: int = 0
    """l of a factor exp(i l phi) over the pupil"""
    cover: tuple[float, float] | None = None
    """refractive index before a plane face, and the depth of the nominal focus behind it, m"""
    factor: Callable | None = None
    """complex factor of the angle before the face and the azimuth, (n, 1) and (m,): (n, m)"""
    uneven: int = 0
    """number of azimuthal orders and of radial degrees that the factor adds"""

    @property
    def k(self):
        """Wavenumber in the medium, 1/m."""
        return 2 * math.pi * self.medium / self.wavelength

    @property
    def widest(self):
        """Half the angle of the cone in the medium: light beyond the critical angle is lost."""
        if self.cover is None:
            return self.angle
        return math.asin(min(1.0, self.cover[0] / self.medium * math.sin(self.angle)))

    def nodes(self, count):
        """Angles in the medium, and weights of sin(theta) d(theta).

        Gauss-Legendre in v, theta = pi/2 - v^2: roots of cos(theta) at the rim are analytic in v.
        """
        low, high = math.sqrt(math.pi / 2 - self.widest), math.sqrt(math.pi / 2)
        x, weight = leggauss(count)
        v, weight = low + (high - low) * (x + 1) / 2, weight * (high - low) / 2
        theta = math.pi / 2 - v**2
        return theta, 2 * v * weight * np.sin(theta)

    def amplitudes(self, theta, phi):
        """g along theta and phi, sqrt(W/sr), of each state: (states, 2, len(theta), len(phi)).

        Unpolarised light is the mean of two states, other light is one state.
        """
        pupil = np.exp(1j * self.vortex * phi)
        if self.factor is not None:
            index = self.medium if self.cover is None else self.cover[0]
            before = np.arcsin(np.sin(theta) * self.medium / index)
            pupil = pupil * self.factor(before[:, None], phi)
        states = {
            "unpolarised": [(1, 0), (0, 1)],
            "radial": [(np.cos(phi), np.sin(phi))],
            "azimuthal": [(-np.sin(phi), np.cos(phi))],
        }
        given = self.polarisation
        if callable(given):
            states = {given: [given(phi)]}
        g = [
            (
                p[:, None] * (a * np.cos(phi) + b * np.sin(phi)) * pupil,
                s[:, None] * (b * np.cos(phi) - a * np.sin(phi)) * pupil,
            )
            for a, b in states.get(self.polarisation, [self.polarisation])
            for p, s in [self.profile(theta)]
        ]
        return np.array(g)

    def profile(self, theta):
        """g of the light polarised along theta and along phi, without the polarisation's factor.

        A plane face at z = -d passes each plane wave with its lateral wave vector, so that
        A2 dOmega2 = t A1 dOmega1 exp(i d (k2 cos2 - k1 cos1)), and |g|^2 goes as n |A|^2/k^2.
        """
        if self.cover is None:
            g = np.sqrt(self.W(theta)) + 0j
            return g, g
        (n1, depth), n2 = self.cover, self.medium
        before = np.arcsin(n2 / n1 * np.sin(theta))
        cos1, cos2 = np.cos(before), np.cos(theta)
        t_s = 2 * n1 * cos1 / (n1 * cos1 + n2 * cos2)
        t_p = 2 * n1 * cos1 / (n2 * cos1 + n1 * cos2)
        solid_angles = n2**2 * cos2 / (n1**2 * cos1)
        path = 2 * math.pi / self.wavelength * depth * (n2 * cos2 - n1 * cos1)
        common = np.sqrt(self.W(before) * n2 / n1) * n1 / n2 * solid_angles * np.exp(1j * path)
        return t_p * common, t_s * common


def lens(angle, waist=math.inf, ring=0, kind="sine"):
    """W(theta) of 1 W behind a lens of the sine or the tan map, W/sr.

    The pupil of radius R holds the intensity (rho/R)^(2 ring) exp(-2 (rho/(waist R))^2).
    """

    def shape(theta):
        cos = np.cos(theta)
        if kind == "sine":
            rho, spread = np.sin(theta) / math.sin(angle), cos
        else:
            rho, spread = np.tan(theta) / math.tan(angle), cos**-3
        return spread * rho ** (2 * ring) * np.exp(-2 * (rho / waist) ** 2)

    x, weight = leggauss(200)
    theta = angle * (x + 1) / 2
    power = math.pi * angle * weight @ (shape(theta) * np.sin(theta))
    return lambda theta: shape(theta) / power


@dataclass(frozen=True)
class Sphere:
    """A sphere of concentric layers."""

    layers: tuple[tuple[float, complex], ...]
    """outer radius, m, and refractive index of each layer, from the core outwards"""

    @property
    def radius(self):
        """Of the whole sphere, m."""
        return self.layers[-1][0]

    def orders(self, k):
        """Number of Mie's coefficients; the next one is below 1e-15."""
        x = k * self.radius
        return int(x + 5 * x ** (1 / 3) + 5)

    def coefficients(self, k, medium):
        """Mie's a_n and b_n, n = 1, 2, ...: of the electric and the magnetic multipoles.

        psi and chi upward are each wrong by a rounding of the larger one, and grow as exp(|Im z|):
        60 digits, and one for each 1 of |Im z|.
        """
        largest = max(abs(complex(index).imag) for _, index in self.layers)
        with mp.workdps(60 + int(largest / medium * k * self.radius)):
            modes = self._modes(mp.mpf(k), mp.mpf(medium), self.orders(k))
            return tuple(np.array([complex(one) for one in kind]) for kind in modes)

    def _modes(self, k, medium, highest):
        """a_n and b_n from the fields on both sides of each face, from the core outwards.

        The radial function f is A psi(m k r) + B chi(m k r) in a layer of the index ratio m, and
        (1 - a) psi + i a chi outside. m f and f' of electric multipoles are continuous, and f and
        m f' of magnetic ones.
        """
        radii = [mp.mpf(radius) for radius, _ in self.layers]
        ratios = [*(mp.mpc(index) / medium for _, index in self.layers), mp.mpc(1)]
        inside = [riccati(highest, m * k * r) for m, r in zip(ratios, radii, strict=False)]
        outside = [riccati(highest, m * k * r) for m, r in zip(ratios[1:], radii, strict=True)]
        steps = [m / above for m, above in pairwise(ratios)]
        for steps_of_f, steps_of_df in ((steps, [1] * len(steps)), ([1] * len(steps), steps)):
            coefficients = []
            for n in range(highest):
                A, B = 1, 0
                for face, (of_f, of_df) in enumerate(zip(steps_of_f, steps_of_df, strict=True)):
                    (psi, d_psi), (chi, d_chi) = (functions[n] for functions in inside[face])
                    f, df = of_f * (A * psi + B * chi), of_df * (A * d_psi + B * d_chi)
                    (psi, d_psi), (chi, d_chi) = (functions[n] for functions in outside[face])
                    # psi chi' - psi' chi = -1
                    A, B = df * chi - f * d_chi, f * d_psi - df * psi
                coefficients.append(B / (B + 1j * A))
            yield coefficients


def riccati(highest, z):
    """Values and slopes of psi = z j_n(z) and chi = -z y_n(z), n = 1 to highest."""

    def upward(before, here):
        functions = []
        for n in range(1, highest + 1):
            before, here = here, (2 * n - 1) / z * here - before
            functions.append((here, before - n * here / z))
        return functions

    return upward(mp.cos(z), mp.sin(z)), upward(-mp.sin(z), mp.cos(z))


@dataclass(frozen=True)
class Push:
    """What light does to a sphere."""

    force: np.ndarray
    """(..., 3), N"""
    torque: np.ndarray
    """about the centre of the sphere, (..., 3), N m"""
    absorbed: np.ndarray
    """power, (...), W"""


def push(light, sphere, place, finer=1.0):
    """Force, torque and absorbed power on a sphere at place (..., 3), m from the focus.

    `finer` multiplies the numbers of nodes: a result that it does not change has converged.
    """
    place = np.asarray(place, float)
    r = place.reshape(-1, 3)
    a, b = sphere.coefficients(light.k, light.medium)
    # Phases over the cone, and azimuthal orders of the light about the sphere
    depth = 0 if light.cover is None else light.cover[1] * abs(light.cover[0] - light.medium)
    phase = light.k * (light.widest * (sphere.radius + np.linalg.norm(r, axis=1).max()) + depth)
    across = light.k * math.sin(light.widest) * np.hypot(r[:, 0], r[:, 1]).max()
    bands = across + 5 * across ** (1 / 3) + 8 + abs(light.vortex) + light.uneven
    theta, weight = light.nodes(int(finer * (phase / 2 + 4 * phase ** (1 / 3) + 16 + light.uneven)))
    turns = int(finer * (len(a) + max(len(a), bands) + 6))
    phi = 2 * math.pi * np.arange(turns) / turns
    weight = weight * 2 * math.pi / turns

    s = frame(theta[:, None], phi)[0]
    shift = np.exp(1j * light.k * np.einsum("pi,itf->ptf", r, s))
    g0 = light.amplitudes(theta, phi) * shift[:, None, None]
    weighted = np.fft.fft(g0 * weight[:, None])
    total = np.zeros((len(r), 7))
    for i, angle in enumerate(theta):
        g1 = scattered(a, b, angle, theta, weighted)
        total += 2 * weight[i] * carried(g0[:, :, :, i], g1, angle, phi)
    u, weight = leggauss(int(finer * (len(a) + 4)))
    for angle, share in zip(np.arccos(u), weight * 2 * math.pi / turns, strict=True):
        g1 = scattered(a, b, angle, theta, weighted)
        total += share * carried(g1[0], g1, angle, phi)

    frequency = 2 * math.pi * SPEED_OF_LIGHT / light.wavelength
    total = -total.reshape(*place.shape[:-1], 7)
    return Push(
        force=total[..., :3] * light.medium / SPEED_OF_LIGHT,
        torque=total[..., 3:6] / frequency,
        absorbed=total[..., 6],
    )


def frame(theta, phi):
    """Unit vectors s, along theta, along phi; the components come first."""
    sin, cos, zero = np.sin(theta), np.cos(theta), np.zeros(np.broadcast(theta, phi).shape)
    s = np.array([sin * np.cos(phi), sin * np.sin(phi), cos + zero])
    along_theta = np.array([cos * np.cos(phi), cos * np.sin(phi), zero - sin])
    return s, along_theta, np.array([zero - np.sin(phi), zero + np.cos(phi), zero])


def scattered(a, b, angle, theta, weighted):
    """g of the scattered light on a circle about the axis, with its slopes along theta and phi.

    It is -(1/2 pi) times the integral of S(s, s') g0(s'). With components along theta and phi, S
    depends on phi - phi' alone, so that the sum over phi' is a product of Fourier series.
    `weighted` are those of g0 times the weights, (places, states, 2, len(theta), turns).
    """
    turns = weighted.shape[-1]
    S, slope = dyad(a, b, angle, theta[:, None], 2 * math.pi * np.arange(turns) / turns)
    g1, along_theta = (
        -np.einsum("eEtm,psEtm->psem", np.fft.fft(kernel), weighted, optimize=True) / (2 * math.pi)
        for kernel in (S, slope)
    )
    along_phi = 1j * np.fft.fftfreq(turns, 1 / turns) * g1
    return tuple(np.fft.ifft(series) for series in (g1, along_theta, along_phi))


def dyad(a, b, angle, theta, phi):
    """Scattering dyad S from s' = (theta, 0) to s = (angle, phi), and its slope along `angle`.

    S E = A (E - s s.E) - B s x (s' x E) - B' X (X.E) + A' (s' - c s)(s.E), c = s.s', X = s' x s,
    with A = sum E_n a_n P_n'(c), B with b_n, E_n = (2n + 1)/(n (n + 1)). It is S1 across and S2
    along the plane of s and s', and smooth where they are parallel. Rows are the components
    along theta and phi at s, columns those at s'.
    """
    A, B = sums(a, b, np.cos(angle) * np.cos(theta) + np.sin(angle) * np.sin(theta) * np.cos(phi))
    at, before = frame(angle, phi), frame(theta, np.zeros_like(phi))
    R = np.einsum("ai...,bi...->ab...", np.array(at), np.array(before))
    dR = np.array([R[1], -R[0], 0 * R[2]])
    c, dc = R[0, 0], dR[0, 0]
    # e.X of e along theta and phi, and X.E likewise
    eX, deX = (R[2, 0], -R[1, 0]), (dR[2, 0], -dR[1, 0])
    XE, dXE = (-R[0, 2], R[0, 1]), (-dR[0, 2], dR[0, 1])
    first, d_first = A[0] + c * B[0], (A[1] + c * B[1] + B[0]) * dc
    second, d_second = A[1] - B[0], (A[2] - B[1]) * dc
    S, slope = [], []
    for e, E in np.ndindex(2, 2):
        eE, deE = R[e + 1, E + 1], dR[e + 1, E + 1]
        ss, dss = R[e + 1, 0] * R[0, E + 1], dR[e + 1, 0] * R[0, E + 1] + R[e + 1, 0] * dR[0, E + 1]
        XX, dXX = eX[e] * XE[E], deX[e] * XE[E] + eX[e] * dXE[E]
        S.append(first * eE + second * ss - B[1] * XX)
        slope.append(
            d_first * eE + first * deE + d_second * ss + second * dss - B[2] * dc * XX - B[1] * dXX
        )
    return np.reshape(S, (2, 2, *c.shape)), np.reshape(slope, (2, 2, *c.shape))


def sums(a, b, c):
    """A, A', A'' and B, B', B'' at c: sums of the derivatives of Legendre's polynomials."""
    below, here = np.zeros((4, *c.shape)), np.zeros((4, *c.shape))
    below[0], here[0], here[1] = 1, c, 1
    A, B = np.zeros((2, 3, *c.shape), complex)
    for n in range(1, len(a) + 1):
        factor = (2 * n + 1) / (n * (n + 1))
        A += factor * a[n - 1] * here[1:]
        B += factor * b[n - 1] * here[1:]
        above = below.copy()
        above[1:] += (2 * n + 1) * here[:-1]
        above[0] = ((2 * n + 1) * c * here[0] - n * below[0]) / (n + 1)
        below, here = here, above
    return A, B


def carried(bra, ket, angle, phi):
    """Sums over a circle of Re(bra*.s ket), Re(bra*.J ket) and Re(bra*.ket): (places, 7).

    J = -i s x grad - i bra* x ket. `ket` comes with its slopes along theta and phi.
    """
    g, along_theta, along_phi = ket
    cot, sin = np.cos(angle) / np.sin(angle), np.sin(angle)
    turned = along_phi / sin + cot * np.stack([-g[:, :, 1], g[:, :, 0]], axis=2)
    bra = bra.conj()
    power = (bra * g).sum(2)
    spin = -1j * (bra[:, :, 0] * g[:, :, 1] - bra[:, :, 1] * g[:, :, 0])
    J = np.stack([spin, 1j * (bra * turned).sum(2), -1j * (bra * along_theta).sum(2)])
    power, J = power.real.mean(1), J.real.mean(2)
    axes = np.array(frame(angle, phi))
    momentum = np.einsum("if,pf->pi", axes[0], power)
    angular = np.einsum("aif,apf->pi", axes, J)
    return np.concatenate([momentum, angular, power.sum(1)[:, None]], axis=1)


@dataclass(frozen=True)
class Cone:
    """Light of one lens, as a part of coherent light."""

    light: Light
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """position of its focus, m"""
    size: complex = 1.0
    """factor of its amplitude"""
    down: bool = False
    """whether it is turned by half a turn about x"""
    mirror: tuple[float, complex | None] | None = None
    """height of a plane that reflects it, m, and the index behind it; None is a perfect mirror"""


@dataclass(frozen=True)
class Together:
    """Cones of one wavelength whose fields add, with the interface of `Light`."""

    cones: tuple[Cone, ...]

    vortex = 0
    cover = None

    def __getattr__(self, name):
        return getattr(self.cones[0].light, name)

    @property
    def uneven(self):
        """Azimuthal orders and degrees that the shifts of the foci add."""
        far = max(
            np.linalg.norm(each.place) + 2 * abs(each.mirror[0] if each.mirror else 0)
            for each in self.cones
        )
        return int(12 + self.k * far / 2 + max(each.light.uneven for each in self.cones))

    def nodes(self, count):
        """Angles of the light that travels up, then of the light that travels down."""
        theta, weight = self.cones[0].light.nodes(count)
        return np.concatenate([theta, math.pi - theta]), np.concatenate([weight, weight])

    def amplitudes(self, theta, phi):
        """g along theta and phi of the sum, (states, 2, len(theta), len(phi))."""
        half = len(theta) // 2
        total = 0
        for cone in self.cones:
            incoming, turned = theta[:half], (-phi if cone.down else phi)
            g = cone.light.amplitudes(incoming, phi)
            if cone.down:  # the wave to (theta, phi) of the lens travels to (pi - theta, -phi)
                g = -g[..., np.argsort(np.mod(turned, 2 * math.pi), kind="stable")]
                incoming = math.pi - incoming
            s = frame(incoming[:, None], phi)[0]
            shift = -self.k * np.einsum("i,itf->tf", cone.place, s)
            g = cone.size * g * np.exp(1j * shift)
            below = cone.down
            if cone.mirror is not None:
                height, index = cone.mirror
                r_p, r_s = fresnel(np.abs(np.cos(incoming)), self.medium, index)
                path = np.exp(2j * self.k * np.cos(incoming) * height)
                g = g * np.stack([r_p * path, r_s * path])[:, :, None]
                below = not below
            whole = np.zeros((*g.shape[:2], len(theta), len(phi)), complex)
            whole[:, :, half if below else 0 :][:, :, :half] = g
            total = total + whole
        return total


def fresnel(cosine, before, behind):
    """r_p and r_s of a plane face; r_p multiplies the component along e_theta of each wave."""
    if behind is None:
        return np.ones_like(cosine), -np.ones_like(cosine)
    inside = np.sqrt(1 - (before / behind) ** 2 * (1 - cosine**2) + 0j)
    inside = np.where((behind * inside).imag < 0, -inside, inside)
    r_s = (before * cosine - behind * inside) / (before * cosine + behind * inside)
    r_p = (behind * cosine - before * inside) / (behind * cosine + before * inside)
    return r_p, r_s
