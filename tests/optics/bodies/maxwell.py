"""Force and torque of focused light on a body, from Maxwell's stress on a sphere around it.

The incident field on that sphere is a sum over plane waves. Its projections on vector spherical
waves are multiplied by the T-matrix and give the scattered field. All integrals over the sphere
are numerical, and nothing is shared with `tweezer.optics`.

E is scaled so that |E|^2 is the intensity of a plane wave, W/m^2, and h = -i curl E/k is the
magnetic field in the same unit. Fields vary as exp(-i omega t). The spherical waves are
M = z_l(kr) X_lm and N = curl M/k, with X_lm = -i r x grad Y_lm/sqrt(l (l + 1)) and Y_lm with the
Condon-Shortley phase. The modes of helicity +1 and -1 are (N + M)/sqrt(2) and (N - M)/sqrt(2).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.constants import c as SPEED_OF_LIGHT
from scipy.special import sph_harm_y_all, spherical_jn, spherical_yn

#: Complex numbers of one block of plane waves on the sphere
BLOCK = 2**19


def force_and_torque(scene, t_matrix, position, rotation, *, finer=1.0):
    """Return the force and the torque on a body, and the power that it absorbs.

    Parameters
    ----------
    scene : Scene
        Scene with one beam at rest, without a cover glass. Its bead is ignored.
    t_matrix : object
        Has `matrix`, (modes, modes), T in the body's frame, rows scattered and columns incident,
        and `modes`, (modes, 3), degree l, order m and helicity of each mode, in any order.
    position : array_like, shape (3,)
        Origin of the body's frame relative to the focus, m.
    rotation : array_like, shape (3, 3)
        Rotation from the body's frame to the laboratory, v_lab = rotation @ v_body.
    finer : float, optional
        Factor of the numbers of plane waves and of points on the sphere. A result that it does
        not change has converged.

    Returns
    -------
    force : ndarray, shape (3,)
        Force, N, in laboratory axes.
    torque : ndarray, shape (3,)
        Torque about the origin of the body's frame, N m, in laboratory axes.
    absorbed : float
        Absorbed power, W.
    """
    position, rotation = np.asarray(position, float), np.asarray(rotation, float)
    matrix = np.asarray(t_matrix.matrix)
    index = scene.medium.refractive_index
    k = 2 * math.pi * index / scene.beam.wavelength
    sphere = Sphere(t_matrix.modes, finer)
    total = np.zeros(7)
    for share, s, E in plane_waves(scene, sphere.size + k * np.linalg.norm(position), finer):
        there = E * np.exp(1j * k * s @ position)[:, None]
        incident = sphere.plane_waves(s @ rotation, there @ rotation)  # in the body's frame
        scattered = sphere.outgoing(matrix @ sphere.amplitudes(incident))
        total += share * sphere.carried(incident, scattered)
    total *= (sphere.size / k) ** 2
    momentum = index / SPEED_OF_LIGHT
    force, torque = momentum * total[:3], momentum * total[3:6] * sphere.size / k
    return rotation @ force, rotation @ torque, float(total[6])


def plane_waves(scene, phase, finer=1.0):
    """Return the plane waves behind the lens, as one part for each polarised state of the light.

    The field is sum E exp(ik s.r). `phase` is the largest k |r| at which it is used.

    Returns
    -------
    list of tuple
        Share of the power, directions s (waves, 3), and amplitudes E (waves, 3), sqrt(W)/m.
    """
    beam, lens, index = scene.beam, scene.lens, scene.medium.refractive_index
    assert lens.cover is None
    assert beam.direction == "up"
    assert not any(beam.position)
    if lens.map == "sine":
        widest = math.asin(lens.numerical_aperture / index)
    else:
        widest = math.atan(lens.radius / lens.focal_length)
    x, weight = leggauss(int(finer * (widest * phase / 2 + 3 * phase ** (1 / 3) + 24)))
    theta, weight = widest * (1 + x) / 2, widest * weight / 2
    bands = math.sin(widest) * phase
    turns = int(finer * (bands + 6 * bands ** (1 / 3) + 10 + abs(beam.vortex)))
    phi = 2 * math.pi * np.arange(turns) / turns

    # a ring of the pupil goes into a ring of solid angle: I rho d(rho) = W sin d(theta)
    sin, cos = np.sin(theta), np.cos(theta)
    if lens.map == "sine":
        rho, area = sin / math.sin(widest), cos / math.sin(widest) ** 2
    else:
        rho, area = sin / cos / math.tan(widest), 1 / (math.tan(widest) ** 2 * cos**3)
    profile, whole = _pupil(beam, lens)
    within = 2 * math.pi * float(weight @ (profile(rho) * area * sin))
    power = beam.power_through_pupil
    if power is None:
        power = beam.power * within / whole
    W = profile(rho) * area * power / within  # W/sr

    theta, phi = theta[:, None], phi[None, :]
    s, p, q = np.moveaxis(_frame(theta, phi), 1, -1)
    k = 2 * math.pi * index / beam.wavelength
    size = np.sqrt(W) * weight * sin * k / turns  # (k/2 pi) dOmega sqrt(W)
    factor = 1j * size[:, None] * np.exp(1j * beam.vortex * phi)
    states = []
    for share, (a, b) in _states(beam):
        radial, azimuthal = a * np.cos(phi) + b * np.sin(phi), b * np.cos(phi) - a * np.sin(phi)
        E = factor[..., None] * (radial[..., None] * p + azimuthal[..., None] * q)
        states.append((share, s.reshape(-1, 3), E.reshape(-1, 3)))
    return states


def _frame(theta, phi):
    """Return e_r, e_theta and e_phi, (3, 3, polar angles, azimuths)."""
    sin, cos, zero = np.sin(theta), np.cos(theta), np.zeros(np.broadcast(theta, phi).shape)
    e_r = [sin * np.cos(phi), sin * np.sin(phi), cos + zero]
    e_theta = [cos * np.cos(phi), cos * np.sin(phi), zero - sin]
    return np.array([e_r, e_theta, [zero - np.sin(phi), zero + np.cos(phi), zero]])


def _pupil(beam, lens):
    """Return the intensity over rho/R, in any unit, and its integral over all rho/R."""
    if beam.profile == "uniform":
        return np.ones_like, math.pi
    assert beam.profile == "gaussian"
    waist, power = 2 * beam.sigma / lens.radius, abs(beam.vortex)
    whole = math.pi / 2 * waist**2 * (waist**2 / 2) ** power * math.factorial(power)
    return lambda rho: rho ** (2 * power) * np.exp(-2 * (rho / waist) ** 2), whole


def _states(beam):
    """Return the polarised states of the light: share of the power and Jones vector."""
    half = math.sqrt(0.5)
    if beam.polarisation == "linear":
        jones = [complex(*each) for each in np.reshape(beam.jones, (2, 2))]
        return [(1.0, jones)]
    if beam.polarisation == "circular":
        return [(1.0, (half, 1j * half))]
    assert beam.polarisation == "unpolarised"
    return [(0.5, (1, 0)), (0.5, (0, 1))]


class Sphere:
    """A sphere around a body, and the spherical waves on it. Its radius is `size`/k.

    Fields (2, 3, ...) are E and h in Cartesian components at all points, which are a product of
    polar angles and azimuths.
    """

    def __init__(self, modes, finer=1.0):
        self.modes = np.asarray(modes)
        degree = int(self.modes[:, 0].max())
        self.size = degree + 2.0  # no Bessel or Hankel function is very large or small there
        count = int(finer * (degree + 6 + 3 * self.size ** (1 / 3)))
        u, weight = leggauss(count)
        theta, phi = np.arccos(u)[:, None], 2 * math.pi * np.arange(2 * count) / (2 * count)
        self.frame = _frame(theta, phi)
        self.weight = weight[:, None] * math.pi / count
        self.turned = np.exp(1j * np.multiply.outer(self.modes[:, 1], phi))
        x = self.size
        l = np.arange(degree + 1)
        j, slope = spherical_jn(l, x), spherical_jn(l, x, derivative=True)
        self._regular = self._waves(theta[:, 0], j, slope)
        y, slope_y = spherical_yn(l, x), spherical_yn(l, x, derivative=True)
        self._outgoing = self._waves(theta[:, 0], j + 1j * y, slope + 1j * slope_y)

    def _waves(self, theta, z, slope):
        """Return the modes with radial functions z_l at phi = 0: (modes, 2, 3, polar angles)."""
        l, m, helicity = self.modes.T
        harmonics, slopes = sph_harm_y_all(l.max(), l.max(), theta, 0.0, diff_n=1)
        Y, along_theta = harmonics[l, m], slopes[l, m][..., 0]
        x, l, m = self.size, l[:, None], m[:, None]
        norm = np.sqrt(l * (l + 1.0))
        X_theta, X_phi = -m * Y / np.sin(theta) / norm, -1j * along_theta / norm
        z, slope = z[l], slope[l]
        M = np.stack([0 * Y, z * X_theta, z * X_phi], 1)
        # the tangential part of curl(z X) is e_r x X d(rz)/dr/r
        N = np.stack(
            [1j * norm * z * Y / x, -(z / x + slope) * X_phi, (z / x + slope) * X_theta], 1
        )
        helicity = helicity[:, None, None]
        E = (N + helicity * M) / math.sqrt(2)
        return np.stack([E, -1j * helicity * E], 1)

    def plane_waves(self, s, E):
        """Return the field of plane waves E exp(ik s.r), with s and E of shape (waves, 3)."""
        points = self.frame[0].reshape(3, -1).T
        amplitudes = np.concatenate([E, np.cross(s, E)], axis=1)
        rows = max(1, BLOCK // len(s))
        found = []
        for at in range(0, len(points), rows):
            phase = self.size * points[at : at + rows] @ s.T
            wave = np.empty(phase.shape, complex)
            np.cos(phase, out=wave.real)
            np.sin(phase, out=wave.imag)
            found.append(wave @ amplitudes)
        return np.concatenate(found).T.reshape(2, 3, *self.frame.shape[2:])

    def amplitudes(self, field):
        """Return the amplitudes of the regular modes in a field.

        With E and h together the modes are orthogonal on the sphere.
        """
        along = np.einsum("aitp,eitp->eatp", self.frame, field)
        series = np.einsum("eatp,np->neat", along * self.weight, self.turned.conj())
        projected = np.einsum("neat,neat->n", self._regular.conj(), series)
        norm = np.einsum("neat,t->n", np.abs(self._regular) ** 2, self.weight[:, 0])
        return projected / (norm * self.turned.shape[1])

    def outgoing(self, amplitudes):
        """Return the field of outgoing modes."""
        waves = amplitudes[:, None, None, None] * self._outgoing
        along = np.einsum("neat,np->eatp", waves, self.turned)
        return np.einsum("aitp,eatp->eitp", self.frame, along)

    def carried(self, incident, scattered):
        """Return force, torque and power into the sphere, in units of its radius and of n/c.

        The incident light alone carries none, so that its stress is left out.
        """
        normal = self.frame[0]
        stress, power = np.zeros_like(normal), np.zeros_like(normal[0])
        for one, other in ((incident, scattered), (scattered, incident), (scattered, scattered)):
            for a, b in zip(one, other, strict=True):
                stress += (a * (b.conj() * normal).sum(0) - normal * (a * b.conj()).sum(0) / 2).real
            power -= (np.cross(one[0], other[1].conj(), axis=0) * normal).sum(0).real
        moment = np.cross(normal, stress, axis=0)
        return (np.concatenate([stress, moment, power[None]]) * self.weight).sum((1, 2))
