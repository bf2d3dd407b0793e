"""Bias of the position's variance by the step of thermal motion, known before the run.

Two cases are not small. The method `one-call` has first order in the step for a force that is not a
gradient, such as the force of circularly polarised light. For a bead driven round at the rate c in
a trap with the rate k, the variance after steps h is too large by

    (1 - h k/2)/(1 - h (k^2 + c^2)/(2 k)) - 1.

At low damping exponential Heun loses energy in an anharmonic well. This loss rate is proportional
to h^3 and adds to the loss rate of the drag, without its own noise.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from tweezer.dynamics.brownian.batch import Linear
from tweezer.dynamics.layout import POSITION, TRANSLATION
from tweezer.dynamics.problem import Problem
from tweezer.values.arrays import Array

#: Standard deviations from the trap at which circulation is looked for
_ASIDE = 1.5
#: Step over the size of the rates, short enough for the first order
_SHORT = 1e-3
#: Beads and periods by which the loss of energy is measured where forces cost little, and elsewhere
_MANY, _FEW = (128, 40), (16, 24)
#: Part of these periods at the end, in which the energy is taken
_END = 0.5
#: Factor by which the drag is smaller in this measurement
_LESS_DRAG = 1e-6


def one_call_bias(problem: Problem, mobility: Array, kT: float) -> float:
    """Return the relative error of the variance by the method `one-call`, per step, 1/s.

    It is the largest over the axes and over positions at the stable equilibrium and about it, as a
    force may circulate only away from the axis. Without an equilibrium it is 0. `mobility` (3,) is
    in s/kg, and `kT` in J.
    """
    trap = problem.equilibrium
    if trap is None:
        return 0.0
    stiffness = np.array(trap.stiffness)
    held = (stiffness + stiffness.T) / 2
    apart = _ASIDE * np.sqrt(kT / np.linalg.eigvalsh(held).clip(min=0.1 * held.max()))
    places = np.array(trap.position) + np.vstack([np.zeros(3), np.diag(apart), -np.diag(apart)])
    gradients = -problem.field(places, gradient=True).force_gradient
    return max(
        _bias(mobility[:, None] * (held + (each - each.T) / 2), kT * mobility) for each in gradients
    )


def _bias(rates: Array, diffusion: Array) -> float:
    """Return the error of the largest variance of an axis, divided by the step, 1/s.

    It follows from the Lyapunov equations for `rates` (3, 3), 1/s, which are mobility times
    stiffness, and `diffusion` (3,), m^2/s.
    """
    from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

    exact = solve_continuous_lyapunov(rates, 2 * np.diag(diffusion))
    h = _SHORT / float(np.linalg.norm(rates, 2))
    # the force and the variance are evaluated at x + n/2, and x gains n - h rates x
    half, one = np.eye(3) - 0.5 * h * rates, np.eye(3)
    noise = 2 * h * np.diag(diffusion)
    left = one - h * rates
    found = solve_discrete_lyapunov(left, half @ noise @ half.T) + noise / 4
    return float((np.diag(found) / np.diag(exact) - 1).max()) / h


def energy_loss(walk: Any, linear: Linear) -> float:
    """Return the fraction of the thermal energy that the steps of a walk remove by themselves.

    The loss is measured without drag and noise, for beads with thermal energy. It is the difference
    in energy after some periods between the step and half the step. The loss has order 3, so that
    an eighth of it remains at half the step. A few beads with high energy lose most of it.
    Therefore the result is rough, and it is too small if forces are expensive and few beads are
    followed. At the loss rate r, the thermal energy is too small by r/(r + beta/m).

    `walk` is a `tweezer.dynamics.walk.Walk`, and `linear` belongs to its scheme.
    """
    plan, rng = walk.plan, np.random.default_rng(11)
    cheap = not walk.scene.lit or walk.scene.optics.evaluator == "map"
    number, periods = _MANY if cheap else _FEW
    tau, diffusion = plan.tau[TRANSLATION], plan.diffusion[TRANSLATION]
    x, v = rng.normal(size=(2, number, 3))
    swing = math.sqrt(float(plan.tau[0] / linear.kappa[TRANSLATION].max()))
    steps = math.ceil(periods * 2 * math.pi * swing / walk.step)
    beads, left = np.arange(number), []
    window = np.hanning(int(_END * steps))  # smooth, so that phases do not matter
    for parts in (1, 2):
        freely = linear._replace(
            tau=linear.tau / _LESS_DRAG, kappa=linear.kappa / _LESS_DRAG,
            diffusion=np.zeros_like(linear.diffusion),
        )  # fmt: skip
        calm = dataclasses.replace(
            walk,
            plan=plan._replace(
                step=walk.step / parts, per_sample=parts, mobility=plan.mobility / _LESS_DRAG
            ),
            weights=walk.scheme.weights(walk.step / parts, freely),
            edge=walk.edge._replace(margin=0.0),
        )
        states = calm.start(beads)
        at = calm.layout.at("velocity")
        spread, speed = np.sqrt(diffusion / linear.kappa[TRANSLATION]), np.sqrt(diffusion / tau)
        states[:, POSITION] = plan.centre[TRANSLATION] + x * spread
        states[:, at] = v * speed
        out = np.empty((number, steps, calm.shown.width))
        calm.advance(states, beads, 0, out)
        speeds = (out[:, -window.size :, at] ** 2).sum(axis=2)
        left.append(float(np.nansum(speeds * window)))
    time = (steps - window.size / 2) * walk.step
    rate = max(-math.log(left[0] / left[1]) / time * 8 / 7, 0.0)
    return rate / (rate + 1 / float(plan.tau[0]))
