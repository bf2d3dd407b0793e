"""The force of all the light of a lens, integrated to rounding: slow, and in another way.

The polar axis runs from the focus to the centre of the bead, g is the angle of a ray to it and
psi its azimuth. A ray through the focus meets the bead at sin(alpha) = (d/r) sin(g) whatever its
azimuth, so the efficiencies are functions of g, and of psi only the light is. The integrand over g
is smooth but for known angles, at which it may have a root or almost have one. Between
these the double-exponential rule takes any such end; over psi Gauss-Legendre suffices.

What cancels is in extended precision where the machine has it (`numpy.longdouble`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

SPEED_OF_LIGHT = 299792458.0

#: half the width of the double-exponential rule: beyond, its weights are below 1e-20
EXTENT = 3.45

HALF_CIRCLE = np.longdouble("3.14159265358979323846264338327950288")


def force_and_moment(
    position,
    *,
    radius: float,
    n_bead: float,
    n_medium: float,
    half_angle: float,
    radiance: Callable[[np.ndarray], np.ndarray],
    polarisation: str,
    jones: tuple[complex, complex] = (1, 0),
    tolerance: float = 1e-12,
    smallest: float = 0.0,
    levels: int = 6,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Force (N) and moment (3.25) (N m) on a bead at `position` (m from the focus), and error (N).

    radiance: W/sr as a function of cos(theta), of light up to `half_angle` from the z axis.
    polarisation: "averaged-reflectance", "circular", or "linear" with the normalised `jones`.
    Nodes are doubled in both angles until the force moves by less than `tolerance` of itself or of
    `smallest` (N), or by no more than rounding. The error returned is that last move: the force is
    better.
    """
    position = np.asarray(position, dtype=np.longdouble)
    px, py, pz = position
    lateral = np.hypot(px, py)
    distance = np.hypot(lateral, pz) / radius
    gamma, phi = np.arctan2(lateral, pz), np.arctan2(py, px)
    frame = np.array(
        [
            [np.sin(gamma) * np.cos(phi), np.sin(gamma) * np.sin(phi), np.cos(gamma)],
            [-np.cos(gamma) * np.cos(phi), -np.cos(gamma) * np.sin(phi), np.sin(gamma)],
            [np.sin(phi), -np.cos(phi), 0],
        ],
        dtype=np.longdouble,
    )
    half_angle = np.longdouble(half_angle)
    m = np.longdouble(n_medium) / np.longdouble(n_bead)
    ends = break_points(distance, gamma, half_angle, m)

    def at_level(level):
        g, weight = double_exponential(ends, 2.0**-level)
        sine = distance * np.sin(g)
        opening = arc(g, gamma, half_angle)
        seen = (sine < 1) & (opening > 0)
        g, weight, sine, opening = g[seen], weight[seen], sine[seen], opening[seen]
        light = arc_moments(g, opening, gamma, frame, radiance, polarisation, jones, 6 * 2**level)
        force, moment, rounding = np.zeros(3), np.zeros(3), 0.0
        for Q, (straight, cosine, sine_) in zip(
            efficiencies(sine, m, averaged=polarisation == "averaged-reflectance"),
            light,
            strict=True,
        ):
            area = weight * np.sin(g)
            along = area * (Q.real * np.cos(g) + Q.imag * np.sin(g))
            across = area * (Q.real * np.sin(g) - Q.imag * np.cos(g))
            lever = area * (np.sqrt(1 - sine**2) * Q.imag - sine * Q.real)
            force = force + np.array([along @ straight, across @ cosine, across @ sine_]) @ frame
            moment = moment + np.array([0, -(lever @ sine_), lever @ cosine]) @ frame
            rounding += (area * (1e-16 * np.abs(Q) + 1e-18)) @ straight
        return force, moment, rounding

    strength = n_medium / SPEED_OF_LIGHT
    before = at_level(2)[0]
    for level in range(3, 3 + levels):
        force, moment, rounding = at_level(level)
        error = np.linalg.norm((force - before).astype(float))
        size = max(np.linalg.norm(force.astype(float)), smallest / strength)
        if error <= max(tolerance * size, rounding):
            break
        before = force
    return (
        (strength * force).astype(float),
        (strength * radius * moment).astype(float),
        float(strength * error),
    )


def break_points(distance, gamma, half_angle, m):
    """Angles g, sorted, where a ray grazes, is totally reflected, or an arc opens or closes.

    Also the right angle: just inside the bead's edge the integrand almost has a root there.
    """
    angles = [0, HALF_CIRCLE / 2, HALF_CIRCLE, abs(gamma - half_angle)]
    both = gamma + half_angle
    angles.append(min(both, 2 * HALF_CIRCLE - both))
    for limit in (np.longdouble(1), 1 / m):
        if limit < distance:
            angle = np.arcsin(limit / distance)
            angles += [angle, HALF_CIRCLE - angle]
    return np.unique(np.array(angles, dtype=np.longdouble))


@cache
def _gauss_legendre(count):
    return np.polynomial.legendre.leggauss(count)


@cache
def _reference_rule(step):
    """Nodes in (0, 1) and weights of the tanh-sinh rule, the nodes as distances to both ends."""
    count = int(EXTENT / step)
    t = step * np.arange(-count, count + 1).astype(np.longdouble)
    left = 1 / (1 + np.exp(-HALF_CIRCLE * np.sinh(t)))
    right = left[::-1]
    return left, right, step * HALF_CIRCLE * np.cosh(t) * left * right


def double_exponential(ends, step):
    """Nodes and weights over all intervals between `ends`."""
    left, right, weight = _reference_rule(step)
    begin, end = ends[:-1, None], ends[1:, None]
    nodes = np.where(left < right, begin + (end - begin) * left, end - (end - begin) * right)
    return nodes.ravel(), ((end - begin) * weight).ravel()


def arc(g, gamma, half_angle):
    """Half the azimuth over which rays at angle g from the polar axis are lit: 0 to pi.

    cos(psi) = (cos(half_angle) - cos(g) cos(gamma)) / (sin(g) sin(gamma)), with 1 - cos(psi) and
    1 + cos(psi) as products.
    """
    above = np.sin((half_angle + g - gamma) / 2) * np.sin((half_angle - g + gamma) / 2)
    below = np.sin((g + gamma + half_angle) / 2) * np.sin((g + gamma - half_angle) / 2)
    return 2 * np.arctan2(np.sqrt(np.maximum(above, 0)), np.sqrt(np.maximum(below, 0)))


def arc_moments(g, opening, gamma, frame, radiance, polarisation, jones, count):
    """Integrals over psi of the s- and the p-polarised light times 1, cos(psi) and sin(psi).

    Returns (2, 3, nodes), W/sr. Positive light in, nothing cancels: double precision will do.
    """
    nodes, weights = _gauss_legendre(count)
    g, opening, gamma = (np.asarray(angle, float)[..., None] for angle in (g, opening, gamma))
    psi = opening * nodes
    cos_theta = np.cos(g) * np.cos(gamma) + np.sin(g) * np.sin(gamma) * np.cos(psi)
    light = radiance(np.minimum(cos_theta, 1)) * opening * weights
    if polarisation == "linear":
        s_share = s_polarised_share(g, psi, frame.astype(float), jones)
    else:
        s_share = 0.5
    parts = np.stack([s_share * light, (1 - s_share) * light])
    around = (np.ones_like(psi), np.cos(psi), np.sin(psi))
    return np.stack([(parts * factor).sum(axis=2) for factor in around], axis=1)


def s_polarised_share(g, psi, frame, jones):
    """Part of a ray's power polarised across its plane of incidence.

    The lens turns the field of the pupil with the ray, about the axis across both: along x it
    becomes x - u_x (z + u)/(1 + u_z), and likewise along y. s is along u x e, e the polar axis.
    """
    e, e1, e2 = (axis[:, None, None] for axis in frame)
    ux, uy, uz = np.cos(g) * e + np.sin(g) * (np.cos(psi) * e1 + np.sin(psi) * e2)
    sx, sy, sz = np.sin(psi) * e1 - np.cos(psi) * e2
    tilt = (sx * ux + sy * uy + sz * (1 + uz)) / (1 + uz)
    a, b = jones
    return np.abs(a * (sx - ux * tilt) + b * (sy - uy * tilt)) ** 2


def efficiencies(sine, m, *, averaged):
    """Q_s + i Q_g of an s- and a p-polarised ray at sin(alpha), m = n_medium/n_bead.

    averaged: both with the mean of the two reflectances, as (3.17).
    """
    refracted = sine * m < 1
    cos_a = np.sqrt((1 - sine) * (1 + sine))
    sin_b = np.where(refracted, m * sine, 0)
    cos_b = np.sqrt((1 - sin_b) * (1 + sin_b))
    s = ((m * cos_a - cos_b) / (m * cos_a + cos_b)) ** 2
    p = ((cos_a - m * cos_b) / (cos_a + m * cos_b)) ** 2
    turned = (cos_a + 1j * sine) ** 2
    bent = (cos_b + 1j * sin_b) ** 2
    both = []
    for R in ((s + p) / 2, (s + p) / 2) if averaged else (s, p):
        R = np.where(refracted, R, 1)  # noqa: PLW2901
        through = np.where(refracted, (1 - R) ** 2 * turned / (bent + R), 0)
        both.append(1 + R * turned - through)
    return both
