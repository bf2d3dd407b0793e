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
    """What the sum over the rays of a scene has to compute; a kernel is compiled for each."""

    polarisation: str
    """see `tweezer.scene.sections.Beam.polarisation`"""
    denser_medium: bool
    """whether n_P < n_m, so that rays may be totally reflected"""
    gradient: bool
    """whether derivatives over the position are computed"""
    moment: bool
    """whether the moment (3.25) is computed"""


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


@functools.cache
def efficiencies_of(rays: Rays) -> Any:
    """Compiled function: efficiencies of n rings of rays, the same for all rays of a ring."""
    averaged = rays.polarisation == "averaged-reflectance"
    denser_medium, gradient = rays.denser_medium, rays.gradient

    @named_njit(**SUMS)
    def efficiencies(room, n, count, n_mP):  # type: ignore[no-untyped-def]
        S_of = room[S_OF]
        Q_of, dQ_of, G_of, dG_of = room[Q_OF], room[DQ_OF], room[G_OF], room[DG_OF]
        for i in range(n):
            S = min(S_of[i], _GRAZING)
            if denser_medium and ray.cos_squared_beta(S, n_mP) < TOTAL_REFLECTION:
                if gradient:
                    Q_of[i], dQ_of[i], G_of[i], dG_of[i] = ray.total_reflection_rates(S)
                else:
                    Q_of[i], G_of[i] = ray.total_reflection(S)
            elif averaged:
                if gradient:
                    Q_of[i], dQ_of[i], G_of[i], dG_of[i] = ray.averaged_reflectance_rates(S, n_mP)
                else:
                    Q_of[i], G_of[i] = ray.averaged_reflectance(S, n_mP)
            elif gradient:
                Q_of[i], dQ_of[i], G_of[i], dG_of[i] = ray.circular_rates(S, n_mP)
            else:
                Q_of[i], G_of[i] = ray.circular(S, n_mP)
        for at in range(n, count, n):
            for i in range(n):
                Q_of[at + i] = Q_of[i]
                G_of[at + i] = G_of[i]
                if gradient:
                    dQ_of[at + i] = dQ_of[i]
                    dG_of[at + i] = dG_of[i]

    return efficiencies


@functools.cache
def ray_sum(rays: Rays, *, by_grid: bool, in_rings: bool) -> Any:
    """Compiled function: adds force, moment and gradients of the rays from `first` up to `last`.

    It returns the size of the forces. It is separate because the compiler does not vectorise its
    loop inside a large function. in_rings: whether `room` already holds the efficiencies.
    """
    averaged, linear = rays.polarisation == "averaged-reflectance", rays.polarisation == "linear"
    denser_medium, gradient, moment = rays.denser_medium, rays.gradient, rays.moment
    # whether the nearest point to the centre is needed, not only the place along the ray
    nearest = linear or gradient or moment

    @named_njit(**SUMS, inner=True)
    def add_up(  # type: ignore[no-untyped-def]
        room, first, last, p1, p2, p3, radius, n_mP, a_re, a_im, b_re, b_im, found
    ):
        u1_of, u2_of, u3_of = room[U1][first:last], room[U2][first:last], room[U3][first:last]
        weight = room[WEIGHT][first:last]
        if in_rings:
            Q_of, dQ_of, G_of, dG_of = room[Q_OF], room[DQ_OF], room[G_OF], room[DG_OF]
        if not by_grid:
            force_of = room[FORCE]
        place_1, place_2, place_3 = p1 / radius, p2 / radius, p3 / radius
        f1 = f2 = f3 = size = attraction = 0.0
        m1 = m2 = m3 = 0.0
        j11 = j12 = j13 = j21 = j22 = j23 = j31 = j32 = j33 = 0.0
        k11 = k12 = k13 = k21 = k22 = k23 = k31 = k32 = k33 = 0.0
        for i in range(weight.size):
            u1, u2, u3 = u1_of[i], u2_of[i], u3_of[i]
            if nearest:
                n1, n2, n3, S = ray.impact(u1, u2, u3, p1, p2, p3, radius)
            else:
                s, S = ray.passage(u1, u2, u3, place_1, place_2, place_3)
            w = weight[i] if S < 1.0 else 0.0
            S = min(S, _GRAZING)
            dQ_sc = dG = 0.0
            if in_rings:
                Q_sc, G = Q_of[i], G_of[i]
                if gradient:
                    dQ_sc, dG = dQ_of[i], dG_of[i]
            elif denser_medium and ray.cos_squared_beta(S, n_mP) < TOTAL_REFLECTION:
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
                if linear:
                    if gradient:
                        X, dX, Y, dY = ray.split_rates(S, n_mP)
                    else:
                        X, Y = ray.split(S, n_mP)
            if linear:
                E1, E2, E3, H1, H2, H3 = ray.electric_field(u1, u2, u3, a_re, a_im, b_re, b_im)
                sigma = ray.polarisation(u1, u2, u3, n1, n2, n3, radius, E1, E2, E3, H1, H2, H3)
                Q_sc += sigma * X
                G += sigma * Y
                if gradient:
                    dQ_sc += sigma * dX
                    dG += sigma * dY
            Q_sc *= w
            G *= w
            if nearest:
                F1, F2, F3 = ray.force(u1, u2, u3, n1, n2, n3, radius, Q_sc, G)
            else:
                F1, F2, F3 = ray.force_along_ray(u1, u2, u3, s, Q_sc, G)
                attraction += G
            f1 += F1
            f3 += F3
            if by_grid or linear:
                f2 += F2
            if not by_grid:
                if not nearest:
                    F1 -= G * place_1
                    F3 -= G * place_3
                # scalar whose expansion estimates the error: a combination that no symmetry cancels
                F = F1 + 0.6180339887498949 * F3
                if linear:
                    F += 0.3819660112501051 * F2
                force_of[i] = F
                size += abs(F1) + abs(F3)
            if moment:
                cos_alpha = math.sqrt(1.0 - S)
                M1, M2, M3 = ray.moment(u1, u2, u3, n1, n2, n3, cos_alpha, Q_sc, G)
                m1 += M1
                m2 += M2
                m3 += M3
            if gradient:
                dQ_sc *= w
                dG *= w
                J11, J12, J13, J21, J22, J23, J31, J32, J33 = ray.gradient_of_force(
                    u1, u2, u3, n1, n2, n3, radius, Q_sc, dQ_sc, G, dG
                )
                if linear:
                    X *= w
                    Y *= w
                    d1, d2, d3 = ray.gradient_of_polarisation(
                        u1, u2, u3, n1, n2, n3, radius, E1, E2, E3, H1, H2, H3
                    )
                    T11, T12, T13, T21, T22, T23, T31, T32, T33 = ray.turning_force(
                        u1, u2, u3, n1, n2, n3, radius, X, Y, d1, d2, d3
                    )
                    J11 += T11
                    J12 += T12
                    J13 += T13
                    J21 += T21
                    J22 += T22
                    J23 += T23
                    J31 += T31
                    J32 += T32
                    J33 += T33
                j11 += J11
                j13 += J13
                j22 += J22
                j31 += J31
                j33 += J33
                if by_grid or linear:
                    j12 += J12
                    j21 += J21
                    j23 += J23
                    j32 += J32
                if moment:
                    K11, K12, K13, K21, K22, K23, K31, K32, K33 = (
                        ray.gradient_of_moment(
                            u1, u2, u3, n1, n2, n3, radius, cos_alpha,
                            Q_sc, dQ_sc, G, dG,
                        )
                    )  # fmt: skip
                    if linear:
                        T11, T12, T13, T21, T22, T23, T31, T32, T33 = ray.turning_moment(
                            u1, u2, u3, n1, n2, n3, cos_alpha, X, Y, d1, d2, d3
                        )
                        K11 += T11
                        K12 += T12
                        K13 += T13
                        K21 += T21
                        K22 += T22
                        K23 += T23
                        K31 += T31
                        K32 += T32
                        K33 += T33
                    k12 += K12
                    k21 += K21
                    k23 += K23
                    k32 += K32
                    if by_grid or linear:
                        k11 += K11
                        k13 += K13
                        k22 += K22
                        k31 += K31
                        k33 += K33
        found[0] += f1 - attraction * place_1
        found[1] += f2
        found[2] += f3 - attraction * place_3
        if by_grid:
            found[1] -= attraction * place_2
        if moment:
            found[3] += m1
            found[4] += m2
            found[5] += m3
        if gradient:
            for c, value in enumerate((j11, j12, j13, j21, j22, j23, j31, j32, j33)):
                found[6 + c] += value
        if gradient and moment:
            for c, value in enumerate((k11, k12, k13, k21, k22, k23, k31, k32, k33)):
                found[15 + c] += value
        return size

    return add_up
