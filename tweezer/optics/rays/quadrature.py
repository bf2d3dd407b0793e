"""The integral over the lens: rules are refined until the tolerance is reached."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from tweezer.compiled import cached_njit, named_njit
from tweezer.forces.data import (
    Data,
    matrix,
    number,
    packed,
    tensor,
    tensor_of_four,
    vector,
)
from tweezer.forces.force import KERNEL, Kernel
from tweezer.optics.rays.nodes import rays_of, rays_of_linear, scratch, tails
from tweezer.optics.rays.panels import (
    ARCS,
    AZIMUTHS,
    COLUMNS,
    DISC,
    ERROR_OF_ARCS,
    ERROR_OF_RINGS,
    KIND,
    LEVEL,
    MISSED,
    MOST_PANELS,
    RATE_AZIMUTH,
    RATE_X,
    more_nodes,
    place_of,
    resolve_azimuth,
    rules_of,
    unknown_light,
)
from tweezer.optics.rays.ray_sum import INLINE, SUMS, Rays, Sphere, efficiencies_of_rings, ray_sum
from tweezer.optics.rays.rule import LEVELS, Rule
from tweezer.optics.turning import put

#: Force that counts as zero, as a part of the largest. The largest is estimated as the strength of
#: the light times min(1, 5 |1 - n_m/n_P|)
VANISHING = 3e-7
#: Lower bound on error estimates, as a part of the tolerance
TRUSTED = 0.01


@cached_njit(error_model="numpy", nogil=True)
def _estimate(tail, kind, direction):  # type: ignore[no-untyped-def]
    factor, power = (ERROR_OF_ARCS if kind == ARCS else ERROR_OF_RINGS)[direction]
    return factor * min(tail, 1.0) ** power


@named_njit(error_model="numpy", nogil=True, inner=True)
def _more_where_missed(rule, rules, many, sizes, errors, target, due, linear):  # type: ignore[no-untyped-def]
    """Refine the rules whose error is above `target`, N; returns whether any was refined."""
    again = False
    for k in range(many):
        if errors[k, 0] + errors[k, 1] <= 2.0 * target:
            continue
        # ratio of the digits needed to those reached
        wanted = math.log(max(sizes[k], target) / target)
        along = around = 0.0
        if errors[k, 0] > target:
            along = wanted / max(math.log(sizes[k] / errors[k, 0]), 1.0)
        if rules[k, KIND] != DISC and not linear:
            before = rules[k, AZIMUTHS]
            resolve_azimuth(rule, rules, k, target / sizes[k])
            due[k] |= rules[k, AZIMUTHS] > before
        elif errors[k, 1] > target:
            around = wanted / max(math.log(sizes[k] / errors[k, 1]), 1.0)
        due[k] |= more_nodes(rules, k, along, around)
        again |= due[k]
    return again


def quadrature_data(rule: Rule, sphere: Sphere, jones: Any) -> Data:
    """Return the data of `quadrature_kernel`; jones: Jones vector (4,), as (re, im) pairs."""
    return packed(*sphere, jones, *rule)


@named_njit(error_model="numpy", inner=True)
def _rule(data, first):  # type: ignore[no-untyped-def]
    """Return the `Rule` whose fields begin at the entry `first` of `data`."""
    return Rule(
        number(data, first), vector(data, first + 1), number(data, first + 2),
        vector(data, first + 3), number(data, first + 4), number(data, first + 5),
        number(data, first + 6), tensor_of_four(data, first + 7), tensor(data, first + 8),
        tensor(data, first + 9), tensor(data, first + 10), number(data, first + 11),
        vector(data, first + 12), matrix(data, first + 13),
    )  # fmt: skip


@named_njit(**INLINE)
def _turned(jones, cosine, sine):  # type: ignore[no-untyped-def]
    """Return the Jones vector in the frame with the bead at (lateral, 0, axial)."""
    return (
        cosine * jones[0] + sine * jones[2],
        cosine * jones[1] + sine * jones[3],
        cosine * jones[2] - sine * jones[0],
        cosine * jones[3] - sine * jones[1],
    )


@named_njit(**INLINE)
def _errors(source, rules, k, along, around, size, linear):  # type: ignore[no-untyped-def]
    """Return the errors of the k-th rule along x and in the azimuth, N, from its two `tails`."""
    kind, level = int(rules[k, KIND]), int(rules[k, LEVEL])
    if kind == DISC:  # its ellipses bound the decay of the coefficients
        n, m = LEVELS[level], rules[k, AZIMUTHS]
        error = along * math.exp(-rules[k, RATE_X] * n) + source.aliased[level]
        missed = around * math.exp(-rules[k, RATE_AZIMUTH] * m)
    else:
        error = size * _estimate(along / size, kind, 0)
        missed = size * rules[k, MISSED]
        if linear:
            missed = size * _estimate(around / size, kind, 1)
    return error, missed


@named_njit(**INLINE)
def _force_and_error(found, errors, many, unknown):  # type: ignore[no-untyped-def]
    """Return the force of all rules and its error, N. unknown: error from the light's series, N."""
    f1 = f2 = f3 = 0.0
    error = unknown
    for k in range(many):
        f1 += found[k, 0]
        f2 += found[k, 1]
        f3 += found[k, 2]
        error += errors[k, 0] + errors[k, 1]
    return math.sqrt(f1 * f1 + f2 * f2 + f3 * f3), error


@named_njit(**INLINE)
def _total(found, many, on_axis):  # type: ignore[no-untyped-def]
    """Return the sum over the rules, (24,); sums that vanish on the axis are exactly zero there."""
    total = found[0]
    if many == 0:
        total[:] = 0.0
    for k in range(1, many):
        for c in range(24):
            total[c] += found[k, c]
    if on_axis:
        total[0] = total[4] = total[8] = total[12] = 0.0
    return total


@functools.cache
def quadrature_kernel(rays: Rays) -> Kernel:
    """Return the kernel that integrates over the lens to the tolerance of a `Rule`.

    It estimates the error of the force.
    """
    efficiencies = efficiencies_of_rings(rays)
    add_up = ray_sum(rays, by_grid=False, in_rings=False)
    add_up_rings = ray_sum(rays, by_grid=False, in_rings=True)
    linear, gradient, moment = rays.polarisation == "linear", rays.gradient, rays.moment
    nodes_of = rays_of_linear if linear else rays_of

    @cached_njit(KERNEL, **SUMS)
    def integrate_over_lens(pose, data, wrench):  # type: ignore[no-untyped-def]
        radius, n_mP, jones = number(data, 0), number(data, 1), vector(data, 2)
        source = _rule(data, 3)
        room = scratch()
        rules = np.empty((MOST_PANELS, COLUMNS))
        found = np.empty((MOST_PANELS, 24))  # sums over the rays of each rule
        errors = np.empty((MOST_PANELS, 2))  # error along x and in the azimuth
        sizes = np.empty(MOST_PANELS)
        due = np.empty(MOST_PANELS, np.bool_)
        least = VANISHING * source.strength * min(5.0 * abs(1.0 - n_mP), 1.0)
        for at in range(pose.position.shape[0]):
            p1, p2, p3 = pose.position[at, 0], pose.position[at, 1], pose.position[at, 2]
            # to the frame with the bead at (lateral, 0, axial)
            cosine, sine = 1.0, 0.0
            lateral = math.hypot(p1, p2)
            if lateral > 0.0:
                cosine, sine = p1 / lateral, p2 / lateral
            p1, p2 = lateral, 0.0
            place = place_of(lateral, p3, radius)
            many = rules_of(place, source, n_mP, rules)
            for k in range(many):
                due[k] = True
            turned = _turned(jones, cosine, sine) if linear else (0.0, 0.0, 0.0, 0.0)
            full = many > 0 and rules[0, KIND] == DISC  # with the full series
            while True:
                for k in range(many):
                    if not due[k]:
                        continue
                    due[k] = False
                    count = nodes_of(place, source, rules, k, full, room, gradient)
                    kind, level = int(rules[k, KIND]), int(rules[k, LEVEL])
                    found[k] = 0.0
                    if linear or kind == DISC:
                        size = add_up(room, 0, count, p1, p2, p3, radius, n_mP, turned, found[k])
                    else:
                        efficiencies(room, LEVELS[level], count, n_mP)
                        size = add_up_rings(
                            room, 0, count, p1, p2, p3, radius, n_mP, turned, found[k]
                        )
                    if not linear:
                        found[k, 3] = found[k, 5] = 0.0  # cancelled by the other half of the rays
                    sizes[k] = size
                    errors[k, 0] = errors[k, 1] = 0.0
                    if size > 0.0:
                        tail = tails(source, rules, k, room, linear, gradient)
                        errors[k, 0], errors[k, 1] = _errors(
                            source, rules, k, tail[0], tail[1], size, linear
                        )
                unknown = unknown_light(place, source, full) if many > 0 else 0.0
                force, error = _force_and_error(found, errors, many, unknown)
                whole = max(force, least)
                if error <= source.tolerance * whole:
                    break
                # the error from the truncated series of the light, and the rules to refine
                again = not full and unknown > 0.1 * source.tolerance * whole
                if again:
                    full = True
                    for k in range(many):
                        due[k] = True
                target = source.tolerance * whole / (2 * many)
                again |= _more_where_missed(source, rules, many, sizes, errors, target, due, linear)
                if not again:
                    break
            total = _total(found, many, p1 == 0.0 and not linear)
            if many > 0:
                error = max(error, TRUSTED * source.tolerance * whole)
            wrench.error[at] += error
            # back to the frame of the scene
            put(total, cosine, sine, gradient, moment, at, wrench)

    return integrate_over_lens
