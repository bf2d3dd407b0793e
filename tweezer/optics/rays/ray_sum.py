"""The sum over rays (3.26), compiled from the emitted ray.

It is compiled without the parts that a scene does not need.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

from tweezer.compiled import cache_functions, named_njit
from tweezer.generated import ray
from tweezer.optics.rays.nodes import DG_OF, DQ_OF, FORCE, G_OF, Q_OF, S_OF, U1, U2, U3, WEIGHT

cache_functions(ray)

#: cos^2 of refraction below which a ray counts as totally reflected. Keeps rounding from making the
#: square root imaginary; Q is continuous there
TOTAL_REFLECTION = 1e-15
#: Upper bound on sin^2 of incidence: at grazing incidence the derivative of the force is infinite
_GRAZING = 1.0 - 1e-16


class Rays(NamedTuple):
    """Kind of light and results of a sum over rays; a kernel is compiled for each."""

    polarisation: str
    """see `tweezer.scene.sections.Beam.polarisation`"""
    denser_medium: bool
    """whether n_P < n_m, so that rays may be totally reflected"""
    gradient: bool
    """whether derivatives over the position are computed"""
    moment: bool
    """whether the torque (3.25) is computed"""


class Sphere(NamedTuple):
    """The bead in ray optics."""

    radius: float
    """m"""
    n_mP: float
    """n_m/n_P"""


#: Compiler options of sums. They may be reordered; NaN and infinity keep their meaning
SUMS: dict[str, Any] = {
    "error_model": "numpy", "nogil": True, "fastmath": {"reassoc", "contract", "arcp", "nsz"},
}  # fmt: skip
#: Compiler options of functions that become part of the loop that calls them
INLINE: dict[str, Any] = {**SUMS, "inline": "always", "inner": True}


@named_njit(**INLINE)
def _plus_3(a, b):  # type: ignore[no-untyped-def]
    """Return a + b, of three numbers each."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@named_njit(**INLINE)
def _plus_9(a, b):  # type: ignore[no-untyped-def]
    """Return a + b, of nine numbers each."""
    return (
        a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5],
        a[6] + b[6], a[7] + b[7], a[8] + b[8],
    )  # fmt: skip


@functools.cache
def _efficiencies(rays: Rays) -> Any:
    """Return a compiled function of S: Q_sc and G of a ray, (3.22) and (3.23), and more.

    The function returns Q_sc, G and the terms X, Y that linearly polarised light adds to them. The
    derivatives of Q_sc, G, X and Y over S follow. Numbers that the rays do not need are zero.
    """
    averaged, linear = rays.polarisation == "averaged-reflectance", rays.polarisation == "linear"
    denser_medium, gradient = rays.denser_medium, rays.gradient

    @named_njit(**INLINE)
    def efficiencies(S, n_mP):  # type: ignore[no-untyped-def]
        dQ_sc = dG = 0.0
        if denser_medium and ray.cos_squared_beta(S, n_mP) < TOTAL_REFLECTION:
            if gradient:
                Q_sc, dQ_sc, G, dG = ray.total_reflection_rates(S)
            else:
                Q_sc, G = ray.total_reflection(S)
            X = dX = Y = dY = 0.0
        else:
            if averaged:
                if gradient:
                    Q_sc, dQ_sc, G, dG = ray.averaged_reflectance_rates(S, n_mP)
                else:
                    Q_sc, G = ray.averaged_reflectance(S, n_mP)
            elif gradient:
                Q_sc, dQ_sc, G, dG = ray.circular_rates(S, n_mP)
            else:
                Q_sc, G = ray.circular(S, n_mP)
            X = dX = Y = dY = 0.0
            if linear:
                if gradient:
                    X, dX, Y, dY = ray.split_rates(S, n_mP)
                else:
                    X, Y = ray.split(S, n_mP)
        return Q_sc, G, X, Y, dQ_sc, dG, dX, dY

    return efficiencies


@functools.cache
def efficiencies_of_rings(rays: Rays) -> Any:
    """Return a compiled function that puts the efficiencies of n rings of rays into `room`.

    All rays of a ring have the same efficiencies.
    """
    efficiencies, gradient = _efficiencies(rays), rays.gradient

    @named_njit(**SUMS)
    def of_rings(room, n, count, n_mP):  # type: ignore[no-untyped-def]
        S_of = room[S_OF]
        Q_of, dQ_of, G_of, dG_of = room[Q_OF], room[DQ_OF], room[G_OF], room[DG_OF]
        for i in range(n):
            Q_sc, G, _, _, dQ_sc, dG, _, _ = efficiencies(min(S_of[i], _GRAZING), n_mP)
            Q_of[i], G_of[i] = Q_sc, G
            if gradient:
                dQ_of[i], dG_of[i] = dQ_sc, dG
        for at in range(n, count, n):
            for i in range(n):
                Q_of[at + i] = Q_of[i]
                G_of[at + i] = G_of[i]
                if gradient:
                    dQ_of[at + i] = dQ_of[i]
                    dG_of[at + i] = dG_of[i]

    return of_rings


@functools.cache
def _put(rays: Rays, *, halves: bool) -> Any:
    """Return a compiled function that adds sums of force, torque and gradients to `found`.

    halves: whether the rays are half of all; sums that the other half cancels are left out.
    """
    gradient, moment = rays.gradient, rays.moment

    @named_njit(**INLINE)
    def put(found, f, m, j, k):  # type: ignore[no-untyped-def]
        if halves:
            f = f[0], 0.0, f[2]
            j = j[0], 0.0, j[2], 0.0, j[4], 0.0, j[6], 0.0, j[8]
            k = 0.0, k[1], 0.0, k[3], 0.0, k[5], 0.0, k[7], 0.0
        for c in range(3):
            found[c] += f[c]
            if moment:
                found[3 + c] += m[c]
        for c in range(9):
            if gradient:
                found[6 + c] += j[c]
            if gradient and moment:
                found[15 + c] += k[c]

    return put


@named_njit(**INLINE)
def _scalar(F, linear):  # type: ignore[no-untyped-def]
    """Return the scalar whose expansion estimates the error of a sum of forces F.

    It is a combination of the components that no symmetry cancels.
    """
    scalar = F[0] + 0.6180339887498949 * F[2]
    if linear:
        scalar += 0.3819660112501051 * F[1]
    return scalar


@functools.cache
def ray_sum(rays: Rays, *, by_grid: bool, in_rings: bool) -> Any:
    """Return a compiled function that adds up the rays from `first` up to `last`.

    It adds their force, torque and gradients to `found` and returns the size of the forces. It is
    separate because the compiler does not vectorise its loop inside a large function. in_rings:
    whether `room` already contains the efficiencies.
    """
    linear, gradient, moment = rays.polarisation == "linear", rays.gradient, rays.moment
    # whether the nearest point to the centre is needed, not only the place along the ray
    nearest = linear or gradient or moment
    efficiencies, put = _efficiencies(rays), _put(rays, halves=not (by_grid or linear))

    @named_njit(**SUMS, inner=True)
    def add_up(room, first, last, p1, p2, p3, radius, n_mP, jones, found):  # type: ignore[no-untyped-def]
        u1_of, u2_of, u3_of = room[U1][first:last], room[U2][first:last], room[U3][first:last]
        weight = room[WEIGHT][first:last]
        if in_rings:
            Q_of, dQ_of, G_of, dG_of = room[Q_OF], room[DQ_OF], room[G_OF], room[DG_OF]
        if not by_grid:
            force_of = room[FORCE]
        place = p1 / radius, p2 / radius, p3 / radius
        size = attraction = 0.0
        f = m = (0.0, 0.0, 0.0)
        j = k = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for i in range(weight.size):
            u = u1_of[i], u2_of[i], u3_of[i]
            if nearest:
                n1, n2, n3, S = ray.impact(*u, p1, p2, p3, radius)
                n = n1, n2, n3
            else:
                s, S = ray.passage(*u, *place)
            w = weight[i] if S < 1.0 else 0.0
            S = min(S, _GRAZING)
            if not in_rings:
                Q_sc, G, X, Y, dQ_sc, dG, dX, dY = efficiencies(S, n_mP)
            elif gradient:
                Q_sc, G, dQ_sc, dG = Q_of[i], G_of[i], dQ_of[i], dG_of[i]
            else:
                Q_sc, G = Q_of[i], G_of[i]
            if linear:
                E = ray.electric_field(*u, *jones)
                sigma = ray.polarisation(*u, *n, radius, *E)
                Q_sc += sigma * X
                G += sigma * Y
            Q_sc *= w
            G *= w
            if nearest:
                F = ray.force(*u, *n, radius, Q_sc, G)
            else:
                F = ray.force_along_ray(*u, s, Q_sc, G)
                attraction += G
            f = _plus_3(f, F)
            if not by_grid:
                if not nearest:
                    F = F[0] - G * place[0], F[1], F[2] - G * place[2]
                force_of[i] = _scalar(F, linear)
                size += abs(F[0]) + abs(F[2])
            if moment:
                cos_alpha = math.sqrt(1.0 - S)
                m = _plus_3(m, ray.moment(*u, *n, cos_alpha, Q_sc, G))
            if gradient:
                if linear:
                    dQ_sc += sigma * dX
                    dG += sigma * dY
                    X *= w
                    Y *= w
                dQ_sc *= w
                dG *= w
                J = ray.gradient_of_force(*u, *n, radius, Q_sc, dQ_sc, G, dG)
                if linear:
                    dsigma = ray.gradient_of_polarisation(*u, *n, radius, *E)
                    J = _plus_9(J, ray.turning_force(*u, *n, radius, X, Y, *dsigma))
                j = _plus_9(j, J)
            if gradient and moment:
                K = ray.gradient_of_moment(*u, *n, radius, cos_alpha, Q_sc, dQ_sc, G, dG)
                if linear:
                    K = _plus_9(K, ray.turning_moment(*u, *n, cos_alpha, X, Y, *dsigma))
                k = _plus_9(k, K)
        f = f[0] - attraction * place[0], f[1] - attraction * place[1], f[2] - attraction * place[2]
        put(found, f, m, j, k)
        return size

    return add_up
