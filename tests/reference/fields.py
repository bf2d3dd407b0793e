"""Fields of force with a closed form, in place of the light of a scene."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.dynamics.brownian import propagator
from tweezer.dynamics.layout import Layout
from tweezer.forces.data import number, packed, vector
from tweezer.forces.equilibria import Search
from tweezer.forces.force import Force


@cached_njit()
def _spring(pose, data, wrench):
    stiffness, moment = number(data, 0), vector(data, 1)
    for at in range(len(pose.position)):
        for i in range(3):
            wrench.force[at, i] -= stiffness * pose.position[at, i]
            wrench.moment[at, i] += moment[i]
            if len(wrench.force_gradient) > at:
                wrench.force_gradient[at, i, i] -= stiffness


@cached_njit()
def _bowl(pose, data, wrench):
    stiffness, quartic = number(data, 0), number(data, 1)
    for at in range(len(pose.position)):
        for i in range(3):
            p = pose.position[at, i]
            wrench.force[at, i] -= (stiffness + quartic * p**2) * p
            if len(wrench.force_gradient) > at:
                wrench.force_gradient[at, i, i] -= stiffness + 3.0 * quartic * p**2


@cached_njit()
def _well(pose, data, wrench):
    stiffness, width = number(data, 0), number(data, 1)
    for at in range(len(pose.position)):
        p = pose.position[at]
        k = stiffness * np.exp(-(p[0] ** 2 + p[1] ** 2 + p[2] ** 2) / (2 * width**2))
        for i in range(3):
            wrench.force[at, i] -= k * p[i]
            if len(wrench.force_gradient) > at:
                wrench.force_gradient[at, i, i] -= k
                for j in range(3):
                    wrench.force_gradient[at, i, j] += k * p[i] * p[j] / width**2


@dataclass(frozen=True)
class LinearTrap(Force):
    """F = -k q and M = moment, a constant."""

    stiffness: float
    constant_moment: tuple[float, float, float] = (0.0, 0.0, 0.0)
    #: as the light of a bead of 1 um is searched
    search = Search(near=20e-6, spacing=2e-8, beside=2e-8, reach=20e-6)
    smooth, symmetric = True, False

    def compiled(self, *, gradient):
        return _spring, packed(self.stiffness, self.constant_moment)


@dataclass(frozen=True)
class GaussianWell(Force):
    """F = -k q exp(-q^2/(2 s^2))."""

    stiffness: float
    width: float

    def compiled(self, *, gradient):
        return _well, packed(self.stiffness, self.width)


@dataclass(frozen=True)
class QuarticTrap(Force):
    """F_i = -k q_i - c q_i^3."""

    stiffness: float
    quartic: float

    def compiled(self, *, gradient):
        return _bowl, packed(self.stiffness, self.quartic)


def in_place(problem, field):
    """`problem` with a field in place of the light."""
    return dataclasses.replace(problem, light=field)


def in_field(equations, field):
    """`equations` bound again with a field in place of the light."""
    return type(equations)(in_place(equations.problem, field), equations.module)


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
        if "memory" in walk.layout:
            modes = walk.problem.modes
            weights = propagator.with_memory(walk.step, modes.times, modes.weights, weights, shaken)
            hidden = 3 * weights.memory.shape[2]
            layout = Layout({**walk.layout.blocks, "memory": hidden})
            walk = dataclasses.replace(walk, layout=layout)
    return dataclasses.replace(walk, problem=in_place(walk.problem, field), weights=weights)
