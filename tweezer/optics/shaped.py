"""Amplitude over the pupil of beams that are not round: elliptical, off-centre or Hermite-Gaussian.

With x' and y' from the beam's centre, turned by its angle, the amplitude is

    H_p(x'/(sqrt(2) a)) H_q(y'/(sqrt(2) b)) exp(-x'^2/(4 a^2) - y'^2/(4 b^2)),

where a and b are the standard deviations of the intensity for p = q = 0.
"""

from __future__ import annotations

import functools
import math

import numpy as np

from tweezer.scene.sections import Beam, Lens
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Nodes over the radius for each pupil radius over the smaller standard deviation, and the fewest
_NODES, _FEWEST = 24, 60
#: Largest pupil radius over a standard deviation for which the pupil is resolved
_NARROWEST = 30.0
#: Smallest part of a beam's power that may pass the pupil
_LEAST = 1e-12


def amplitude(beam: Beam, x: Array, y: Array) -> Array:
    """Return the amplitude of a beam that is not round at places in the pupil, m, in any unit."""
    from scipy.special import eval_hermite

    assert beam.sigma is not None  # only Gaussian beams have a shape
    a, b = beam.sigma, beam.sigma_y or beam.sigma
    x, y = x - beam.offset[0], y - beam.offset[1]
    cosine, sine = math.cos(beam.angle), math.sin(beam.angle)
    across, along = (cosine * x + sine * y) / a, (cosine * y - sine * x) / b
    p, q = beam.hermite
    waves = eval_hermite(p, across / math.sqrt(2)) * eval_hermite(q, along / math.sqrt(2))
    return np.asarray(waves * np.exp(-(across**2 + along**2) / 4))


def fraction(lens: Lens, beam: Beam) -> float:
    """Return the fraction of the beam's power that passes the pupil.

    Raises `SceneError` for a beam that leaves the pupil dark, or is too narrow to be resolved.
    """
    assert beam.sigma is not None
    for name, width in (("sigma", beam.sigma), ("sigma_y", beam.sigma_y)):
        if width is not None and width * _NARROWEST < lens.radius:
            raise SceneError(
                f"beam.{name} = {width:.3g}: a beam that is not round must be at least "
                f"{lens.radius / _NARROWEST:.3g} m wide, a {_NARROWEST:g}th of lens.radius"
            )
    p, q = beam.hermite
    whole = 2 * math.pi * beam.sigma * (beam.sigma_y or beam.sigma)
    whole *= 2.0 ** (p + q) * math.factorial(p) * math.factorial(q)
    found = mean_intensity(lens.radius, beam) * math.pi * lens.radius**2 / whole
    if not found > _LEAST:
        raise SceneError(
            f"beam.offset = {list(beam.offset)}: almost no light within lens.radius = "
            f"{lens.radius:.3g} m"
        )
    return found


@functools.lru_cache(maxsize=64)
def mean_intensity(radius: float, beam: Beam) -> float:
    """Return the mean of the squared `amplitude` over a pupil of a radius, m."""
    assert beam.sigma is not None
    narrow = min(beam.sigma, beam.sigma_y or beam.sigma)
    count = _FEWEST + int(_NODES * radius / narrow) + 4 * sum(beam.hermite)
    x, weight = np.polynomial.legendre.leggauss(count)
    rho = radius * (x + 1) / 2
    phi = 2 * math.pi * np.arange(4 * count) / (4 * count)
    places = rho[:, None] * np.cos(phi), rho[:, None] * np.sin(phi)
    around = (amplitude(beam, *places) ** 2).mean(axis=1)
    return float((weight * rho * around).sum() / radius)
