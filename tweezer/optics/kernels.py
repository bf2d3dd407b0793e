"""The sum over rays (3.26), compiled from the emitted ray.

Numba keys its cache on a function's own bytes and on the values in its closure, not on the
functions it calls by name. So each kernel closes over a digest of the emitted ray: after
`generated/ray.py` changes, no kernel compiled from the old one is found.
"""

from __future__ import annotations

import functools
import hashlib
import inspect
import math
from collections.abc import Callable

import numpy as np
from numba import njit

from generated import ray

Kernel = Callable[..., None]


#: digest of the source that `ray` was imported from, taken at once: by the first call of a kernel
#: the file may have changed under a running program
_EMITTED = hashlib.sha256(inspect.getsource(ray).encode()).hexdigest()

#: cos^2 of refraction below which a ray counts as totally reflected: rounding cannot then put a
#: negative number under the root, and Q is continuous there
TOTAL_REFLECTION = 1e-15


@njit(cache=True)
def _outside_every_ray(q1, q2, q3, half_angle, radius):  # type: ignore[no-untyped-def]
    """Whether the bead lies beside the double cone that holds every ray."""
    lateral = math.hypot(q1, q2)
    beside = math.atan2(lateral, abs(q3)) - half_angle
    # the axis of the nearest ray passes the centre at distance * sin(beside), or more
    return beside > 0.0 and math.hypot(lateral, q3) * math.sin(beside) > radius


@functools.cache
def kernel(*, averaged: bool, denser_medium: bool, gradient: bool, moment: bool) -> Kernel:
    """The sum over rays for one kind of scene; what the scene does not need is not compiled in.

    averaged: efficiencies with the averaged reflectance (3.17), in place of averaged Q.
    denser_medium: n_P < n_m, so that rays may be totally reflected.
    gradient: also derivatives over the position. moment: also the moment (3.25).

    The kernel has the signature
    `(positions, directions, strengths, half_angle, radius, n_mP, force, moment, force_gradient,
    moment_gradient)`: positions (n, 3) m, directions (3, rays), strengths n_m P_i/c (rays,) N,
    half_angle of the cone that holds all directions, and results (n, 3) N, (n, 3) N m,
    (n, 3, 3) N/m, (n, 3, 3) N, of which the ones not asked for stay untouched.
    """
    return _compile(_EMITTED, averaged, denser_medium, gradient, moment)


def _compile(
    digest: str, averaged: bool, denser_medium: bool, gradient: bool, moment: bool
) -> Kernel:
    @njit(
        cache=True, error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"}
    )  # what a sum may do; NaN and infinity keep their meaning
    def sum_over_rays(  # type: ignore[no-untyped-def]
        positions,
        directions,
        strengths,
        half_angle,
        radius,
        n_mP,
        force_out,
        moment_out,
        force_gradient_out,
        moment_gradient_out,
    ):
        _ = digest
        u = np.empty(3)
        n = np.empty(3)
        of_ray = np.empty((3, 3))
        for at in range(positions.shape[0]):
            q1, q2, q3 = positions[at, 0], positions[at, 1], positions[at, 2]
            f1 = f2 = f3 = 0.0
            m1 = m2 = m3 = 0.0
            if gradient:
                force_gradient_out[at] = 0.0
                if moment:
                    moment_gradient_out[at] = 0.0
            if _outside_every_ray(q1, q2, q3, half_angle, radius):
                force_out[at] = 0.0
                if moment:
                    moment_out[at] = 0.0
                continue
            for i in range(strengths.size):
                u1, u2, u3 = directions[0, i], directions[1, i], directions[2, i]
                n1, n2, n3, S = ray.impact(u1, u2, u3, q1, q2, q3, radius)
                if S >= 1.0:
                    continue
                dQ_sc = dG = 0.0
                if denser_medium and ray.cos_squared_beta(S, n_mP) < TOTAL_REFLECTION:
                    if gradient:
                        Q_sc, dQ_sc, G, dG = ray.total_reflection_rates(S)
                    else:
                        Q_sc, G = ray.total_reflection(S)
                elif averaged:
                    if gradient:
                        Q_sc, dQ_sc, G, dG = ray.averaged_reflectance_rates(S, n_mP)
                    else:
                        Q_sc, G = ray.averaged_reflectance(S, n_mP)
                elif gradient:
                    Q_sc, dQ_sc, G, dG = ray.circular_rates(S, n_mP)
                else:
                    Q_sc, G = ray.circular(S, n_mP)
                strength = strengths[i]
                F1, F2, F3 = ray.force(u1, u2, u3, n1, n2, n3, radius, Q_sc, G)
                f1 += strength * F1
                f2 += strength * F2
                f3 += strength * F3
                if moment:
                    cosine = math.sqrt(1.0 - S)
                    M1, M2, M3 = ray.moment(u1, u2, u3, n1, n2, n3, cosine, Q_sc, G)
                    m1 += strength * M1
                    m2 += strength * M2
                    m3 += strength * M3
                if gradient:
                    u[0], u[1], u[2] = u1, u2, u3
                    n[0], n[1], n[2] = n1, n2, n3
                    ray.gradient_of_force(u, n, radius, Q_sc, dQ_sc, G, dG, of_ray)
                    for j in range(3):
                        for k in range(3):
                            force_gradient_out[at, j, k] += strength * of_ray[j, k]
                    if moment:
                        ray.gradient_of_moment(u, n, radius, cosine, Q_sc, dQ_sc, G, dG, of_ray)
                        for j in range(3):
                            for k in range(3):
                                moment_gradient_out[at, j, k] += strength * of_ray[j, k]
            force_out[at, 0], force_out[at, 1], force_out[at, 2] = f1, f2, f3
            if moment:
                moment_out[at, 0], moment_out[at, 1], moment_out[at, 2] = m1, m2, m3

    return sum_over_rays
