"""Light over the pupil, as azimuthal harmonics of its complex factor T(rho, phi).

rho is the distance from the axis over the pupil's radius R, and phi the azimuth of the plane wave
that comes from there. An aberration gives the light the factor

    T = exp(2 pi i sum_nm c_nm Z_n^m(rho, phi)) = sum_q t_q(rho) exp(i q phi).

An axicon adds the phase -a rho. The amplitude of a beam that is not round
(`tweezer.optics.shaped`), or 1 + sum_nm a_nm Z_n^m, is another factor. A hologram is
a third: the sum of a exp(i psi - i k s.r) over its foci at r. A mask of pixels is a fourth
(`tweezer.optics.mask`), and open sectors are a fifth (`tweezer.optics.sectors`); only their Zernike
terms up to a degree reach the bead. T is divided by the
root of its mean square, weighted by the power, so that it leaves the power unchanged; that of a
mask includes the light beyond the degree. A harmonic q adds q to the
angular momentum about the axis. Each is therefore a part of the light. t_q(rho) is rho^|q| times an
even function of rho.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.optics.beam import Cone
from tweezer.optics.mask import Mask, harmonic_sum
from tweezer.optics.sectors import Sectors
from tweezer.optics.shaped import amplitude
from tweezer.optics.zernike import gauss, radial_sums
from tweezer.scene.sections import Beam
from tweezer.scene.sections.pupil import Zernike
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

ComplexArray = NDArray[np.complex128]

#: Harmonics below this part of the light's amplitude are left out
_NONE = 1e-13
#: Amplitude of terms below which the light is rounding
_DARK = 1e-6
#: Search for foci: steps to each side, their length over 1/(k sin(theta)), rings over the pupil,
#: smallest intensity over the highest, largest number of foci
_ASIDE, _APART, _RINGS, _BRIGHT, _MOST_FOCI = 24, 0.5, 32, 0.3, 8
#: Number of nodes over the polar angle for the power
_RINGS_OF_POWER = 400
#: Number of pixels over the pupil of the phase of a hologram
_PIXELS = 512
#: Number of azimuths for the power of the light that a mask transmits
_AZIMUTHS_OF_POWER = 512
#: Numbers of azimuths at which T is sampled, and of radii at which its harmonics are compared
_FEWEST_AZIMUTHS, _MOST_AZIMUTHS, _RADII = 32, 4096, 129


@dataclass(frozen=True)
class Shape:
    """Amplitude over the pupil of a beam that is not round."""

    beam: Beam
    radius: float
    """of the pupil, m"""

    def amplitude(self, rho: Array, phi: Array) -> Array:
        """Return the amplitude in any unit at radii (n,) and azimuths (m,)."""
        r = self.radius * rho[:, None]
        return amplitude(self.beam, r * np.cos(phi), r * np.sin(phi))


@dataclass(frozen=True)
class Pupil:
    """Complex factor of the light over the pupil."""

    wavefront: tuple[Zernike, ...]
    """terms of the phase, with amounts in waves"""
    tangent: bool
    """whether rho is proportional to tan(theta), as in the tan map, or to sin(theta)"""
    scale: float
    """rho over tan(theta) or sin(theta)"""
    shape: Shape | None = None
    """amplitude of a beam that is not round; None for a round beam"""
    spots: tuple[tuple[float, float, float, complex], ...] = ()
    """foci of a hologram: position in 1/k of the medium before a cover, and amplitude; empty for
    one focus. A mask contains their phase, if there are both"""
    size: float = 1.0
    """root mean square of T before it is divided by it"""
    mask: Mask | Sectors | None = None
    """array of pixels, or open sectors; None if there are none"""
    degree: int = 32
    """highest degree of the Zernike terms of the mask"""
    modulation: tuple[Zernike, ...] = ()
    """terms of the amplitude, in addition to 1"""
    axicon: float = 0.0
    """phase of an axicon at the rim, rad"""

    def normalised(self, cone: Cone) -> Pupil:
        """Return this pupil with a factor that leaves the power of a cone of light unchanged.

        Raises `SceneError` for terms of the amplitude that leave no light.
        """
        phi = 2 * math.pi * np.arange(_FEWEST_AZIMUTHS) / _FEWEST_AZIMUTHS
        amplitude = 1 + _zernike_sum(self.modulation, np.linspace(0.0, 1.0, _RADII), phi)
        if np.abs(amplitude).max() < _DARK:
            raise SceneError(
                "beam.amplitude_terms: no light passes, because 1 + sum of a Z is 0 in the whole "
                "pupil; change the amounts"
            )
        smooth = self.without_mask

        def intensity(rho: Array, phi: Array) -> Array:
            """Return |T|^2, of a mask without the fine details."""
            found = np.abs(smooth.factor(rho, phi)) ** 2
            return found if self.mask is None else found * self.mask.transmitted(rho, phi)

        count = 2 * smooth._azimuths if self.mask is None else _AZIMUTHS_OF_POWER
        share = self._mean(cone, intensity, count)
        return dataclasses.replace(self, size=self.size * math.sqrt(share))

    def share(self, cone: Cone) -> float:
        """Return the share of the light in the terms of the mask, for a normalised pupil."""
        return self._mean(cone, lambda *at: np.abs(self.factor(*at)) ** 2, 2 * self._azimuths)

    def _mean(self, cone: Cone, values: Callable[[Array, Array], Array], count: int) -> float:
        """Return the mean over the power of a cone of light, by a number of azimuths."""
        x, weight = gauss(_RINGS_OF_POWER)
        inner, outer = (2 * math.sin(each / 2) ** 2 for each in (cone.inner, cone.half_angle))
        below = inner + (outer - inner) * (1 + x) / 2
        phi = 2 * math.pi * np.arange(count) / count
        around = values(self.radius(below), phi).mean(axis=1)
        power = weight * cone.shape(below)
        return float(power @ around / power.sum())

    @property
    def even(self) -> bool:
        """Whether T is the same all around the axis."""
        return self.mask is None and self.orders == (0,)

    @property
    def without_mask(self) -> Pupil:
        """Pupil without the mask."""
        return self if self.mask is None else dataclasses.replace(self, mask=None, spots=())

    def of_phase(self) -> Pupil:
        """Return this pupil with pixels of the phase of its hologram in place of its field."""
        x = (np.arange(_PIXELS) + 0.5) * 2 / _PIXELS - 1
        rho = np.minimum(np.hypot(x, x[:, None]), 1.0).ravel()
        phi = np.arctan2(np.repeat(x, _PIXELS), np.tile(x, _PIXELS))
        phase = np.angle(self._fields(rho, phi)).reshape(_PIXELS, _PIXELS)
        return dataclasses.replace(self, mask=Mask(np.exp(1j * phase), 2.0, 0.0))

    def up_to(self, degree: int) -> Pupil:
        """Return this pupil with the Zernike terms of its mask up to a degree."""
        return dataclasses.replace(self, degree=degree)

    def radius(self, below: Array) -> Array:
        """Return rho at 1 - cos(theta) = `below`, where theta is the angle behind the lens."""
        sine = np.sqrt(below * (2 - below))
        return np.minimum(self.scale * (sine / (1 - below) if self.tangent else sine), 1.0)

    def factor(self, rho: Array, phi: Array) -> ComplexArray:
        """Return T at radii (n,) and azimuths (m,), rad: (n, m)."""
        waves = _zernike_sum(self.wavefront, rho, phi) - self.axicon / (2 * math.pi) * rho[:, None]
        found: ComplexArray = np.exp(2j * math.pi * waves)
        if self.modulation:
            found = found * (1 + _zernike_sum(self.modulation, rho, phi))
        if self.shape is not None:
            found = found * self.shape.amplitude(rho, phi)
        if self.spots and self.mask is None:
            found = found * self._fields(rho[:, None], phi)
        if self.mask is not None:
            terms = self.mask.terms(self.degree)
            found = found * harmonic_sum(radial_sums(terms, rho), phi)
        return found / self.size

    def _fields(self, rho: Array, phi: Array) -> ComplexArray:
        """Return the sum of the fields of all foci at radii and azimuths that broadcast."""
        sine = rho / self.scale
        if self.tangent:
            sine = sine / np.hypot(1.0, sine)
        along, across = np.sqrt((1 - sine) * (1 + sine)), sine
        return np.asarray(sum(
            a * np.exp(-1j * (across * (x * np.cos(phi) + y * np.sin(phi)) + along * z))
            for x, y, z, a in self.spots
        ))  # fmt: skip

    @functools.cached_property
    def orders(self) -> Sequence[int]:
        """Orders q of the harmonics that count, in ascending order.

        Raises `SceneError` if they are too many.
        """
        if self.mask is not None:
            widest = self.degree + max(map(abs, self.without_mask.orders))
            return range(-widest, widest + 1)
        rho = np.linspace(0.0, 1.0, _RADII)
        count = self._azimuths
        sizes = np.abs(self._transformed(rho, count)).max(axis=0)
        sizes /= sizes.max()
        orders = np.fft.fftfreq(count, 1 / count).astype(int)
        return tuple(sorted(orders[sizes > _NONE].tolist()))

    @functools.cached_property
    def _azimuths(self) -> int:
        """Number of azimuths that resolves T: the highest harmonics are then rounding."""
        if self.mask is not None:
            return 2 * len(self.orders)
        rho = np.linspace(0.0, 1.0, _RADII)
        count = _FEWEST_AZIMUTHS
        while count <= _MOST_AZIMUTHS:
            sizes = np.abs(self._transformed(rho, count)).max(axis=0)
            sizes /= sizes.max()
            if sizes[count // 4 : count - count // 4 + 1].max() < _NONE:
                return count
            count *= 2
        raise SceneError(
            f"beam: the pupil needs more than {_MOST_AZIMUTHS // 4} azimuthal harmonics; reduce "
            "the aberration, the offset, or the distances between foci"
        )

    def _transformed(self, rho: Array, count: int) -> ComplexArray:
        """Return the harmonics t_q, (n, count), at radii (n,) in the order of `numpy.fft`."""
        if self.mask is not None and not (self.wavefront or self.shape or self.modulation):
            found = np.zeros((len(rho), count), np.complex128)
            found[:, np.array(self.orders)] = (
                radial_sums(self.mask.terms(self.degree), rho).T / self.size
            )
            return found
        phi = 2 * math.pi * np.arange(count) / count
        return np.asarray(np.fft.fft(self.factor(rho, phi), axis=1) / count)

    def harmonics(self, below: Array) -> ComplexArray:
        """Return t_q at 1 - cos(theta) = `below` (n,): row q, from the end for q < 0."""
        return self._transformed(self.radius(below), self._azimuths).T

    @functools.cached_property
    def foci(self) -> Array:
        """Positions about which light is bright, (n, 3) in 1/k of the medium before a cover.

        They are the foci of a hologram, or the highest maxima of the intensity, for light without
        polarisation, in the plane where tilt and defocus place the focus.
        """
        from scipy.ndimage import maximum_filter  # an even pupil does without

        centre, sine = np.array(self._centre), self._outermost
        if self.spots:
            return centre + np.array([(x, y, z) for x, y, z, _ in self.spots])
        aside = np.arange(-_ASIDE, _ASIDE + 1) * _APART / sine
        rho = (np.arange(_RINGS) + 0.5) / _RINGS
        phi = 2 * math.pi * np.arange(self._azimuths) / self._azimuths
        light = self.factor(rho, phi) * rho[:, None]
        directions = sine * rho[:, None, None] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
        height = np.sqrt(1 - np.minimum(sine * rho, 1.0)[:, None] ** 2) * centre[2]
        light = light * np.exp(1j * (directions @ centre[:2] + height))
        x, y = (np.exp(1j * np.multiply.outer(aside, directions[..., i])) for i in (0, 1))
        size = len(aside)
        field = (x * light).reshape(size, -1) @ y.reshape(size, -1).T
        bright = np.abs(field) ** 2
        peaks = (maximum_filter(bright, 3) == bright) & (bright > _BRIGHT * bright.max())
        found = np.argwhere(peaks)[np.argsort(-bright[peaks])][:_MOST_FOCI]
        return centre + np.column_stack([aside[found], np.zeros(len(found))])

    @property
    def _outermost(self) -> float:
        """Sine of the angle of the plane wave from the rim of the pupil."""
        return 1 / math.hypot(self.scale, 1.0) if self.tangent else 1 / self.scale

    @property
    def _centre(self) -> tuple[float, float, float]:
        """Position of the focus to the first order of tilt and defocus, in the unit of `foci`.

        It is where the phase k s.r cancels the terms in rho cos(phi), rho sin(phi) and rho^2, for
        the sine of the outermost wave.
        """
        amounts = {(each.n, each.m): 2 * math.pi * each.amount for each in self.wavefront}
        sine = self._outermost
        x, y = (-2 * amounts.get((1, m), 0.0) / sine for m in (1, -1))
        return x, y, 4 * math.sqrt(3) * amounts.get((2, 0), 0.0) / sine**2


def _zernike_sum(terms: tuple[Zernike, ...], rho: Array, phi: Array) -> Array:
    """Return the sum of Zernike terms at radii (n,) and azimuths (m,), (n, m)."""
    found = np.zeros((len(rho), len(phi)))
    for term in terms:
        turning = np.cos(term.m * phi) if term.m >= 0 else np.sin(-term.m * phi)
        found += term.amount * zernike_radial(term.n, abs(term.m), rho)[:, None] * turning
    return found


def zernike_radial(n: int, m: int, rho: Array) -> Array:
    """Return N R_n^m(rho), m >= 0, of which the term has a root mean square of 1 over the pupil.

    R_n^m = rho^m P_k^(0, m)(2 rho^2 - 1), k = (n - m)/2, in Jacobi polynomials, and
    N^2 = (n + 1) (2 - delta_m0).
    """
    from scipy.special import eval_jacobi

    norm = math.sqrt((n + 1) * (2 if m else 1))
    return np.asarray(norm * rho**m * eval_jacobi((n - m) // 2, 0, m, 2 * rho**2 - 1))
