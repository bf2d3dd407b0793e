"""The beam in the pupil, and the cone of light behind the lens.

rho is the distance from the axis in the pupil, m; theta the angle to the axis behind the lens.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev

from tweezer.optics import shaped
from tweezer.optics.mask import Mask, mask_of
from tweezer.optics.sectors import Sectors
from tweezer.optics.zernike import gauss
from tweezer.scene import Scene
from tweezer.scene.sections import Beam, Lens, Medium
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

Profile = Callable[[Array], Array]

#: rho^2/(2 sigma^2) at which beams are cut, sigma as in `Beam`; Gaussian and donut are below 1e-18
#: of their peak there
_DARK = 47.0
#: Logarithm of the peak over the intensity at which rings are cut
_FAINT = 42.0
#: Smallest part of a beam's power that may pass the pupil
_LEAST_FRACTION = 1e-100
#: Smallest part of the light within the pupil that may pass an annulus, sectors or a mask
_LEAST_PASSED = 1e-9
#: Numbers of rings and azimuths for the power that passes
_RINGS, _AZIMUTHS = 400, 512
#: Largest degree of a series, enough for light up to 85 degrees off the axis
LARGEST_DEGREE = 120


@dataclass(frozen=True)
class Cone:
    """Cone of light behind the lens: it converges on the focus and is symmetric about the axis."""

    half_angle: float
    """rad, polar angle of the outermost rays"""
    series: Array
    """Chebyshev coefficients of the power per solid angle, W/sr, over cos(theta) from
    cos(half_angle), -1 of the series, to 1"""
    power: float
    """W, through the pupil"""
    deviation: float
    """largest difference between the series and the beam's profile, relative to the largest
    radiance; the series of a table may be negative by this amount"""
    shape: Profile
    """power per solid angle, 1/sr, of 1 W, at 1 - cos(theta): the same to full accuracy where it is
    small; of a table, the series where it is positive"""
    inner: float = 0.0
    """rad, polar angle of the innermost rays"""

    def radiance(self, cosine: Array) -> Array:
        """Return the power per solid angle, W/sr, at polar angles of these cosines in the cone."""
        return np.asarray(Chebyshev(self.series)(1 - 2 * (1 - cosine) / _versine(self.half_angle)))

    @functools.cached_property
    def spread(self) -> float:
        """Sine of a mean angle of the light: sqrt(2 <sin^2 theta>), averaged over the power.

        It is sin(half_angle) if the pupil is evenly lit.
        """
        if self.power == 0:
            return math.sin(self.half_angle)
        x, weight = _nodes()
        inner = _versine(self.inner)
        below = inner + (_versine(self.half_angle) - inner) * (1 + x) / 2  # 1 - cos(theta)
        power = weight * self.radiance(1 - below)
        return math.sqrt(2 * float(power @ (below * (2 - below))) / float(power.sum()))


@functools.cache
def _nodes() -> tuple[Array, Array]:
    """Return Gauss-Legendre nodes on [-1, 1] and weights for averages over the light's cone."""
    from numpy.polynomial.legendre import leggauss

    return leggauss(100)


def cone(scene: Scene) -> Cone:
    """Return the cone of light of `scene`, with zero power if it has no light.

    A ring of the pupil carries I(rho) 2 pi rho drho (3.3)-(3.5) into the polar angle theta(rho) of
    the lens map. The power per solid angle is therefore I rho (drho/dtheta)/sin(theta). This is
    I f^2/cos^3(theta) for rho = f tan(theta), and I (R n_m/NA)^2 cos(theta) for
    rho = (R n_m/NA) sin(theta). With a cover it is the light before the face, with the angle theta
    and the index n there.

    The cone ends where the beam does: at the rim of the pupil, where a table ends, or where the
    intensity has fallen below 1e-18 of its peak. Raises `SceneError` if a series of degree 120 does
    not describe the light, because it is almost at a right angle to the axis or its table is too
    uneven.
    """
    lens, beam, medium = scene.lens, scene.beam, scene.medium
    if not scene.lit:
        return Cone(_polar_angle(lens.radius, lens, medium), np.zeros(1), 0.0, 0.0, np.zeros_like)
    power = total_power(lens, beam) * fraction_through_pupil(lens, beam)
    shape = _shape_behind(lens, beam, medium)
    return Cone(
        shape.half_angle, shape.series * power, power, shape.deviation, shape.radiance, shape.inner
    )


def total_power(lens: Lens, beam: Beam) -> float:
    """Return the power P_t of (3.4), W, as given or from the power through the pupil.

    Raises `SceneError` as `fraction_through_pupil`.
    """
    if beam.power is not None:
        return beam.power
    assert beam.power_through_pupil is not None
    return beam.power_through_pupil / fraction_through_pupil(lens, beam)


def fraction_through_pupil(lens: Lens, beam: Beam) -> float:
    """Return the fraction of the beam's power that passes the pupil and what is in it.

    Raises `SceneError` as `_within_pupil`, and for a mask as `tweezer.optics.mask.mask_of`.
    """
    return _within_pupil(lens, beam) * _passed(lens, beam)


def _passed(lens: Lens, beam: Beam) -> float:
    """Return the fraction of the light within the pupil that passes what is in it."""
    mask = mask_of(beam, lens.radius)
    if (mask is None or mask.lossless) and beam.annulus is None:
        return 1.0
    phi = 2 * math.pi * np.arange(_AZIMUTHS) / _AZIMUTHS

    def power(low: float, high: float, passing: Mask | Sectors | None) -> float:
        """Return the power between two radii, in any unit, that passes a mask."""
        x, weight = gauss(_RINGS)
        rho = low + (high - low) * (x + 1) / 2
        light = np.broadcast_to(_profile(beam)(rho)[:, None], (_RINGS, _AZIMUTHS))
        if beam.shaped:
            x, y = rho[:, None] * np.cos(phi), rho[:, None] * np.sin(phi)
            light = shaped.amplitude(beam, x, y) ** 2
        if passing is not None:
            light = light * passing.transmitted(rho / lens.radius, phi)
        return float((high - low) * (weight * rho) @ light.mean(axis=1))

    edge = _edge(lens, beam)
    low, high = _open(beam, edge)
    passed = power(low, high, mask) if low < high else 0.0
    fraction = passed / power(0.0, edge, None)
    if not fraction > _LEAST_PASSED:
        key = beam.pattern or "annulus"
        raise SceneError(f"beam.{key} = {getattr(beam, key)!r}: transmits almost none of the light")
    return fraction


def _edge(lens: Lens, beam: Beam) -> float:
    """Return the radius in the pupil, m, beyond which a beam has no light that counts."""
    if beam.sigma is not None and not beam.shaped:
        return min(lens.radius, beam.sigma * math.sqrt(2 * _dark(_ring(beam))))
    if beam.profile == "table":
        return min(lens.radius, _outermost(beam))
    return lens.radius


def _open(beam: Beam, edge: float) -> tuple[float, float]:
    """Return the radii, m, between which the light of a beam passes, up to the `edge`, m."""
    low, high = beam.annulus or (0.0, edge)
    return low, min(high, edge)


def _within_pupil(lens: Lens, beam: Beam) -> float:
    """Return the fraction of the beam's power within the pupil of radius R.

    With t = R^2/(2 sigma^2) a Gaussian has 1 - exp(-t). A beam of intensity t^n exp(-t) has the
    incomplete gamma function P(n + 1, t). For a Gaussian beam with a vortex, which is
    Laguerre-Gauss with p = 0, n = |l|; for the donut (TEM*01), n = 1.
    Raises `SceneError` for a beam that leaves the pupil dark.
    """
    if beam.profile == "uniform":
        return 1.0
    if beam.shaped:
        return shaped.fraction(lens, beam)
    if beam.profile == "table":
        _, within = _interpolated(beam)
        fraction = within(min(lens.radius, _outermost(beam))) / within(_outermost(beam))
        if not fraction > _LEAST_FRACTION:
            raise SceneError(
                f"beam.profile_intensity: no light within lens.radius = {lens.radius:.3g} m"
            )
        return fraction
    assert beam.sigma is not None
    t = (lens.radius / beam.sigma) ** 2 / 2
    if (power := _ring(beam)) == 0:
        return -math.expm1(-t)
    from scipy.special import gammainc

    fraction = float(gammainc(power + 1, t))
    if not fraction > _LEAST_FRACTION:
        raise SceneError(
            f"beam.sigma = {beam.sigma:.3g}: almost no light within lens.radius = "
            f"{lens.radius:.3g} m"
        )
    return fraction


def intensity(lens: Lens, beam: Beam, medium: Medium) -> Profile:
    """Return the intensity I in the pupil, W/m^2, as a function of rho (m) up to the rim.

    For a beam given by a table it is the intensity of the series. Raises `SceneError` as `cone`.
    """
    total = total_power(lens, beam)
    if beam.profile == "table":
        power = total * fraction_through_pupil(lens, beam)
        shape = _shape_behind(lens, beam, medium)
        edge = min(lens.radius, _outermost(beam))

        def of_series(rho: Array) -> Array:
            """Return the intensity, W/m^2, at pupil radii rho, m; 0 beyond the table."""
            sine, cosine = polar_sine_and_cosine(np.minimum(rho, edge), lens, medium)
            y = 1 - 2 * sine**2 / (1 + cosine) / _versine(shape.half_angle)
            radiance = power * Chebyshev(shape.series)(y)
            return np.where(rho <= edge, radiance / _spread(cosine, lens, medium), 0.0)

        return of_series
    if beam.profile == "uniform":
        return lambda rho: np.full_like(rho, total / (math.pi * lens.radius**2))
    assert beam.sigma is not None
    peak, profile = total / (2 * math.pi * beam.sigma**2), _profile(beam)
    return lambda rho: np.asarray(peak * profile(rho))


def polar_sine_and_cosine(rho: Array, lens: Lens, medium: Medium) -> tuple[Array, Array]:
    """Return sine and cosine of the angle to the axis of a ray from pupil radius `rho` (m).

    `tan`: tan(theta) = rho/f, rays straight from the lens plane to the focus, as in (3.2).
    `sine`: sin(theta) = (rho/R) NA/n, Abbe's sine condition; n is n_m or, with a cover, the index
    before its face.
    """
    if lens.map == "tan":
        assert lens.focal_length is not None
        hypotenuse = np.hypot(rho, lens.focal_length)
        return rho / hypotenuse, lens.focal_length / hypotenuse
    assert lens.numerical_aperture is not None
    sine = rho / lens.radius * lens.numerical_aperture / _index(lens, medium)
    return sine, np.sqrt((1 - sine) * (1 + sine))


def behind_face(angle: float, before: float, behind: float) -> float:
    """Return the angle to the axis, rad, of a ray behind a plane face across it (Snell's law).

    `angle` (rad) is the angle before the face; `before` and `behind` are refractive indices. The
    result is a right angle for a ray that the face reflects totally.
    """
    return math.asin(min(math.sin(angle) * before / behind, 1.0))


@dataclass(frozen=True)
class _Shape:
    """A cone of light of 1 W, with the fields of `Cone`."""

    half_angle: float
    """rad, polar angle of the outermost rays"""
    series: Array
    """Chebyshev coefficients of the power per solid angle, 1/sr"""
    deviation: float
    """largest difference between the series and the beam's profile, as a part of the peak"""
    radiance: Profile
    """power per solid angle, 1/sr, at 1 - cos(theta)"""
    inner: float
    """rad, polar angle of the innermost rays"""


def _shape_behind(lens: Lens, beam: Beam, medium: Medium) -> _Shape:
    """Return the shape of the cone of light, which does not depend on the power of the beam.

    It is therefore computed once for beams of all powers.
    """
    of_one_watt = beam.model_copy(update={"power": None, "power_through_pupil": 1.0})
    return _shape_of_one_watt(lens, of_one_watt, medium)


@functools.lru_cache(maxsize=16)
def _shape_of_one_watt(lens: Lens, beam: Beam, medium: Medium) -> _Shape:
    """Compute the shape of the cone of a beam of 1 W through the pupil, as a series.

    Raises `SceneError` if the series does not describe it, see `cone`.
    """
    inner, edge = _open(beam, _edge(lens, beam))
    half_angle, inner = (_polar_angle(each, lens, medium) for each in (edge, inner))
    versine = _versine(half_angle)
    profile = _profile(beam)

    def radiance(below: Array) -> Array:
        """Return the power per solid angle, in any unit, at 1 - cos(theta) = `below`.

        From cos(theta) itself the digits of a narrow cone would be lost.
        """
        cosine = 1 - below
        sine = np.sqrt(below * (1 + cosine))
        rho = np.minimum(_pupil_radius(sine, cosine, lens, medium), edge)
        return profile(rho) * _spread(cosine, lens, medium)

    table = beam.profile == "table"
    places = np.append(np.cos(np.linspace(0, np.pi, 4003)), _points(lens, beam, medium, versine))
    # a ring's power of rho multiplies the rounding of rho
    left_out, allowed = (1e-5, 1e-2) if table else (3e-16, 1e-14 * max(1, _ring(beam)))
    series, deviation = _series(
        lambda y: radiance(versine * (1 - y) / 2), left_out=left_out, checked_at=places
    )
    if deviation > allowed:
        if table:
            raise SceneError(
                f"beam.profile_intensity: points too uneven; a series of degree {LARGEST_DEGREE} "
                f"misses the profile by {100 * deviation:.3g} % of its peak, allowed: 1 %"
            )
        raise SceneError(
            f"lens: the light reaches {math.degrees(half_angle):.5g} degrees off the axis, too "
            f"near to 90 for a series of degree {LARGEST_DEGREE}"
        )
    power = math.pi * versine * Chebyshev(series).integ(lbnd=-1)(1 - 2 * _versine(inner) / versine)
    one_watt = Chebyshev(series / power)

    def of_one_watt(below: Array) -> Array:
        """Return the power per solid angle, 1/sr, at 1 - cos(theta) = `below`."""
        if table:
            return np.maximum(one_watt(1 - 2 * below / versine), 0.0)
        return radiance(below) / power

    return _Shape(half_angle, series / power, deviation, of_one_watt, inner)


def _series(function: Profile, *, left_out: float, checked_at: Array) -> tuple[Array, float]:
    """Return Chebyshev coefficients of a function on [-1, 1], and their error.

    The series ends with the last coefficient above `left_out` times the function's peak. The error
    is the largest difference at the points `checked_at`, as a part of the peak.
    """
    exact = function(checked_at)
    peak = exact.max()
    # the interpolant in the extrema of T_n is a cosine transform; numpy's `interpolate`, which
    # multiplies by a matrix, loses two digits at this degree
    n = LARGEST_DEGREE
    values = function(np.cos(np.pi * np.arange(n + 1) / n))
    series = np.fft.rfft(np.append(values, values[-2:0:-1])).real / n
    series[[0, -1]] /= 2
    highest = np.flatnonzero(np.abs(series) > left_out * peak).max(initial=0)
    series = series[: highest + 1]
    return series, float(np.abs(Chebyshev(series)(checked_at) - exact).max() / peak)


def _points(lens: Lens, beam: Beam, medium: Medium, versine: float) -> Array:
    """Return where a table's points are in the variable of the series, from -1 (rim) to 1.

    versine: 1 - cos(half angle of the cone).
    """
    radii = np.array(beam.profile_radius or ())
    sine, cosine = polar_sine_and_cosine(radii[radii <= lens.radius], lens, medium)
    return 1 - 2 * sine**2 / (1 + cosine) / versine


def _profile(beam: Beam) -> Profile:
    """Return the relative intensity in the pupil as a function of rho, m.

    It is even for a beam that is not round, whose shape is in the pupil's factor.
    """
    if beam.profile == "uniform" or beam.shaped:
        return np.ones_like
    if beam.profile == "table":
        return _interpolated(beam)[0]
    assert beam.sigma is not None
    two_variances, power = 2 * beam.sigma**2, _ring(beam)
    if power == 0:
        return lambda rho: np.exp(-(rho**2) / two_variances)
    scale = math.factorial(power)

    def ring(rho: Array) -> Array:
        """Return t^n exp(-t)/n!, t = rho^2/(2 sigma^2): a bright ring."""
        t = rho**2 / two_variances
        return np.asarray(t**power / scale * np.exp(-t))

    return ring


def _ring(beam: Beam) -> int:
    """Return n of the intensity t^n exp(-t), t = rho^2/(2 sigma^2); 0 for other profiles."""
    return {"gaussian": abs(beam.vortex), "donut": 1}.get(beam.profile, 0)


def _dark(power: int) -> float:
    """Return t at which t^n exp(-t), n = `power`, is below 1e-18 of its peak (at t = n).

    With t = n + x the logarithm falls by x - n log(1 + x/n) >= x^2/(2 n + 2 x/3) (Bernstein's
    inequality), which is above a for x = a + sqrt(2 a n); here a is `_FAINT`.
    """
    if power <= 1:
        return _DARK
    return power + _FAINT + math.sqrt(2 * _FAINT * power)


def _interpolated(beam: Beam) -> tuple[Profile, Callable[[float], float]]:
    """Return a table's intensity and the power within rho, as functions of rho, m.

    The table is interpolated by monotone cubics in rho^2, its largest point counts as 1. Units of
    the power are arbitrary.
    """
    from scipy.interpolate import PchipInterpolator

    assert beam.profile_radius is not None
    points = np.asarray(beam.profile_intensity)
    # in units of the outermost point: the squares of small lengths underflow
    scale = _outermost(beam)
    curve = PchipInterpolator((np.array(beam.profile_radius) / scale) ** 2, points / points.max())
    total = curve.antiderivative()
    return lambda rho: curve((rho / scale) ** 2), lambda rho: float(total((rho / scale) ** 2))


def _outermost(beam: Beam) -> float:
    """Return the radius of the last point of a beam's table, m."""
    assert beam.profile_radius is not None
    return beam.profile_radius[-1]


def _polar_angle(rho: float, lens: Lens, medium: Medium) -> float:
    """Return the angle to the axis, rad, of the ray from pupil radius `rho`, m."""
    sine, cosine = polar_sine_and_cosine(np.array(rho), lens, medium)
    return math.atan2(sine, cosine)


def _pupil_radius(sine: Array, cosine: Array, lens: Lens, medium: Medium) -> Array:
    """Return the pupil radius, m, of the ray at the polar angle of that sine and cosine."""
    scale = _scale(lens, medium)
    return scale * sine / cosine if lens.map == "tan" else scale * sine


def _spread(cosine: Array, lens: Lens, medium: Medium) -> Array:
    """Return the area of the pupil per solid angle behind it, m^2/sr, at a polar angle."""
    scale = _scale(lens, medium)
    return scale**2 / cosine**3 if lens.map == "tan" else scale**2 * cosine


def _scale(lens: Lens, medium: Medium) -> float:
    """Return the length that scales the lens map, m: f of the tan map, R n/NA of the sine map."""
    if lens.map == "tan":
        assert lens.focal_length is not None
        return lens.focal_length
    assert lens.numerical_aperture is not None
    return lens.radius * _index(lens, medium) / lens.numerical_aperture


def relative_radius(scene: Scene) -> float:
    """Return the pupil radius over R of a ray, over tan(theta) or sin(theta) of the lens map."""
    return _scale(scene.lens, scene.medium) / scene.lens.radius


def _index(lens: Lens, medium: Medium) -> float:
    """Return the refractive index behind the lens: of the cover if there is one, or the medium."""
    return (lens.cover or medium).refractive_index


def _versine(angle: float) -> float:
    """Return 1 - cos(angle), without cancellation for small angles."""
    return 2 * math.sin(angle / 2) ** 2
