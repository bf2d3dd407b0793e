"""Fields of force with a closed form, in place of the light of a scene."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from tweezer.dynamics.brownian import propagator
from tweezer.optics import Field

NO_JONES = np.zeros(4)


class Data(NamedTuple):
    """Of any field here: of one type, so that a loop is compiled once for all of them."""

    stiffness: float
    width: float = 0.0
    quartic: float = 0.0
    m1: float = 0.0
    m2: float = 0.0
    m3: float = 0.0


@njit(cache=True)
def _spring(p, source, radius, n_mP, jones, force, moment, gradient, moment_gradient, error):
    for at in range(len(p)):
        for i in range(3):
            force[at, i] = -source.stiffness * p[at, i]
        moment[at, 0], moment[at, 1], moment[at, 2] = source.m1, source.m2, source.m3
        error[at] = 0.0
        if len(gradient) > at:
            moment_gradient[at] = 0.0
            for i in range(3):
                for j in range(3):
                    gradient[at, i, j] = -source.stiffness if i == j else 0.0


@njit(cache=True)
def _bowl(p, source, radius, n_mP, jones, force, moment, gradient, moment_gradient, error):
    for at in range(len(p)):
        error[at] = 0.0
        moment[at] = 0.0
        if len(gradient) > at:
            gradient[at] = 0.0
            moment_gradient[at] = 0.0
        for i in range(3):
            squared = p[at, i] ** 2
            force[at, i] = -(source.stiffness + source.quartic * squared) * p[at, i]
            if len(gradient) > at:
                gradient[at, i, i] = -source.stiffness - 3.0 * source.quartic * squared


@njit(cache=True)
def _well(p, source, radius, n_mP, jones, force, moment, gradient, moment_gradient, error):
    for at in range(len(p)):
        squared = p[at, 0] ** 2 + p[at, 1] ** 2 + p[at, 2] ** 2
        k = source.stiffness * np.exp(-squared / (2 * source.width**2))
        error[at] = 0.0
        moment[at] = 0.0
        for i in range(3):
            force[at, i] = -k * p[at, i]
            if len(gradient) > at:
                moment_gradient[at] = 0.0
                for j in range(3):
                    gradient[at, i, j] = k * p[at, i] * p[at, j] / source.width**2
                    if i == j:
                        gradient[at, i, j] -= k


@dataclass(frozen=True)
class _InPlaceOfLight:
    """The interface of `tweezer.optics.Light`, as far as the dynamics use it."""

    radius = 1.0
    index_ratio = 1.0
    jones = NO_JONES

    @property
    def beyond(self):
        return self

    def field(self, positions, *, gradient=False):
        n = len(positions)
        gradients = n if gradient else 0
        field = Field(
            np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((gradients, 3, 3)),
            np.zeros((gradients, 3, 3)), np.zeros(n),
        )  # fmt: skip
        kernel, source = self.compiled(gradient=gradient)
        kernel(
            positions, source, 1.0, 1.0, NO_JONES, field.force, field.moment,
            field.force_gradient, field.moment_gradient, field.error,
        )  # fmt: skip
        return field


@dataclass(frozen=True)
class LinearTrap(_InPlaceOfLight):
    """F = -k q and M = moment, a constant."""

    stiffness: float
    constant_moment: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def compiled(self, *, gradient):
        return _spring, Data(float(self.stiffness), 0.0, 0.0, *map(float, self.constant_moment))


@dataclass(frozen=True)
class GaussianWell(_InPlaceOfLight):
    """F = -k q exp(-q^2/(2 s^2))."""

    stiffness: float
    width: float

    def compiled(self, *, gradient):
        return _well, Data(float(self.stiffness), width=float(self.width))


@dataclass(frozen=True)
class QuarticTrap(_InPlaceOfLight):
    """F_i = -k q_i - c q_i^3."""

    stiffness: float
    quartic: float

    def compiled(self, *, gradient):
        return _bowl, Data(float(self.stiffness), quartic=float(self.quartic))


def in_field(equations, field):
    """`equations` bound again with a field in place of the light."""
    return type(equations)(equations.scene, equations.module, equations.bead, field)


def in_trap(equations, stiffness, moment=(0.0, 0.0, 0.0)):
    """`equations` bound again with a linear trap in place of the light."""
    return in_field(equations, LinearTrap(stiffness, moment))


def walk_in(walk, field, kappa=0.0):
    """`walk` with a field in place of the light, and a spring of that rate (1/s) taken exactly."""
    weights = walk.weights
    if walk.scene.simulation.method in ("heun", "harmonic"):
        tau = walk.plan.tau * ("vx" in walk.columns)
        rates = np.where(np.arange(len(tau)) < 3, float(kappa), 0.0)
        shaken = walk.plan.diffusion.copy()
        if "vx" not in walk.columns:
            shaken[3:] = 0.0
        weights = propagator.exact(walk.step, tau, rates, shaken)
    return dataclasses.replace(walk, light=field, weights=weights)
