"""Rigid bodies in a well for position and orientation, stepped without a scene."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.brownian import batch, march
from tweezer.dynamics.brownian.batch import Plan
from tweezer.dynamics.brownian.crossing import Boundary
from tweezer.dynamics.layout import Layout
from tweezer.forces.data import Part, packed, vector
from tweezer.forces.force import Force, bound

UPRIGHT = np.array([1.0, 0, 0, 0])


@cached_njit(error_model="numpy")
def _well(pose, data, wrench):
    k, k_c, K_3, K_1, torque, swirl, push = vector(data, 0)
    for i in range(len(pose.position)):
        x, y, z = pose.position[i]
        e0, e1, e2, e3 = pose.orientation[i]
        n1, n2, n3 = 2 * (e1 * e3 + e0 * e2), 2 * (e2 * e3 - e0 * e1), 1 - 2 * (e1**2 + e2**2)
        b1, b2, b3 = 1 - 2 * (e2**2 + e3**2), 2 * (e1 * e2 + e0 * e3), 2 * (e1 * e3 - e0 * e2)
        along = k_c * (x * n1 + y * n2 + z * n3)
        wrench.force[i, 0] += -k * x - along * n1 - swirl * y + push
        wrench.force[i, 1] += -k * y - along * n2 + swirl * x
        wrench.force[i, 2] += -k * z - along * n3
        a1, a2, a3 = along * x, along * y, along * z - K_3 * n3
        wrench.moment[i, 0] += n3 * a2 - n2 * a3
        wrench.moment[i, 1] += n1 * a3 - n3 * a1 + K_1 * b1 * b3
        wrench.moment[i, 2] += n2 * a1 - n1 * a2 - K_1 * b1 * b2 + torque


@dataclass(frozen=True)
class Well(Force):
    """Energy (k q^2 + k_c (q.n)^2 - K_3 n_z^2 - K_1 b_x^2)/2, with a torque and a force added.

    n and b are the body's axes 3 and 1. The torque is about z; the force is swirl z x q and a
    constant push along x.
    """

    k: float = 0.0
    k_c: float = 0.0
    K_3: float = 0.0
    K_1: float = 0.0
    torque: float = 0.0
    swirl: float = 0.0
    push: float = 0.0
    oriented = True

    def compiled(self, *, gradient):
        numbers = (self.k, self.k_c, self.K_3, self.K_1, self.torque, self.swirl, self.push)
        return _well, packed(np.array(numbers))


def a_body(mobility, inertia=None):
    """A body with a mobility (6, 6) and an inertia (6, 6)."""
    mobility = np.array(mobility, dtype=float)
    return BodyMotion(np.linalg.inv(mobility), np.eye(6) if inertia is None else inertia)


def _plan(scheme, body, kT, h, seed=1, per_sample=1):
    none = np.zeros(6)
    data = Part(0, scheme.body(body, kT, h))
    return Plan(seed, h, per_sample, none, none, none, none, none, kT, True, data)


def _weights(scheme, body, kT, h, tau):
    none = np.zeros(6)
    tau = none if tau is None else tau
    return scheme.weights(h, batch.Linear(tau, none, kT * tau, 0.0, np.zeros((3, 3))))


def one_step(scheme, body, h, normal, force=None, *, pose=None, velocity=None, kT=1.0, tau=None):
    """Poses (n, 3) and (n, 4), and velocities (n, 6), after a step with `normal` (draws, n)."""
    force = bound(force or Well(), gradient=False)
    n = normal.shape[1]
    beads = batch.beads(n, 6, velocity is not None, False, True, 0, len(normal), True)
    beads.normal[: len(normal), :n] = normal
    q, beads.e[:] = pose or (np.zeros(3), UPRIGHT)
    beads.x[:3, :n] = np.reshape(q, (3, -1))
    if velocity is not None:
        beads.v[:, :n] = np.reshape(velocity, (6, -1))
    scheme.step(force, _plan(scheme, body, kT, h), _weights(scheme, body, kT, h, tau), beads)
    return beads.x[:3, :n].T.copy(), beads.e.copy(), beads.v[:, :n].T.copy()


def follow(
    scheme, body, h, n, samples, per_sample, force=None, *,
    kT=1.0, tau=None, seed=1, states=None,
):  # fmt: skip
    """Samples (n, samples, columns) of n bodies, every `per_sample` steps from the origin."""
    layout = Layout.of_samples(inertial=tau is not None, rotates=True)
    layout = layout.followed_by(lost_time=1)
    if states is None:
        states = np.zeros((n, layout.width))
        states[:, layout.at("orientation")] = UPRIGHT
        states[:, layout.at("lost_time")] = np.inf
    part = bound(force or Well(), gradient=False)
    everywhere = Boundary(1e9, -np.inf, 1e3, 0.0, 1.0, True, part, 0)
    out = np.empty((n, samples, layout.shown.width))
    failed = march.advance(
        part, march.steps(scheme, layout, None), _plan(scheme, body, kT, h, seed, per_sample),
        _weights(scheme, body, kT, h, tau), everywhere, layout, np.arange(n), states, 0, out,
    )  # fmt: skip
    assert failed == -1
    return out


def nodes(many, dims):
    """Gauss's nodes (dims, n) and weights (n,) of a standard normal variable."""
    x, w = np.polynomial.hermite_e.hermegauss(many)
    grid = np.array(list(product(range(many), repeat=dims)))
    return x[grid].T, (w / w.sum())[grid].prod(axis=1)
