"""Steps of a rigid body of any shape with inertia, on the group of its poses.

In the body's frame the inertia M and the resistance R are constant, symmetric and positive. With

    M^-1/2 R M^-1/2 = Q diag(1/tau) Q^T,    P = M^-1/2 Q,

the velocities V = P z of translation and rotation fall apart into six modes

    tau_j z_j' = s_j - z_j + noise,    s = diag(tau) P^T W,

for the wrench W. Under a constant s, each mode z_j and its integral are an exact Ornstein-Uhlenbeck
pair for any step (`propagator`). The force is taken as linear in time between two evaluations. The
twist P int z has two parts. The one by the initial velocity and force is taken before the noise,
and the one by the final force after it. For steps much longer than tau this is the trapezoid of
`tweezer.dynamics.brownian.body`, with the same correction of the noise.

The gyroscopic force is left out: it turns the velocity by kT tau^2/I in the time tau, which is
negligible in a liquid.
"""

from __future__ import annotations

import numpy as np

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.stack import borrowed, on_stack
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.brownian import propagator
from tweezer.dynamics.brownian.batch import Scheme, exact_without_springs
from tweezer.dynamics.brownian.body import (
    corrected,
    drawn,
    evaluate,
    go,
    keep,
    pose_of,
    read_at,
    read_here,
    times,
    wrench_in_body,
)
from tweezer.dynamics.se3 import rotated, rotated_back
from tweezer.forces.data import Data, matrix, packed

#: Entries of the data of a step: P and its inverse, diag(tau) P^T, and the matrix by which normal
#: numbers become the noise of the twist
MODES, INVERSE, SLOW, ROOT = 0, 1, 2, 3


def data_of(body: BodyMotion, kT: float, step: float) -> Data:
    """Return the data that the step reads, for a rigid body, kT (J) and a step (s)."""
    tau, P = body.relaxation_times, body.velocities
    spread = P * propagator.exact(step, tau, np.zeros(6), kT * tau).noise_x
    covariance = spread @ spread.T
    unit = np.sqrt(np.diag(covariance))
    inverse = np.linalg.inv(spread / unit[:, None])
    changed = inverse @ (corrected(covariance) / np.outer(unit, unit)) @ inverse.T  # nearly 1
    root = spread @ np.linalg.cholesky(changed)
    return packed(P, P.T @ body.inertia, tau[:, None] * P.T, root)


@named_njit(inner=True, error_model="numpy")
def _modes_of(beads, inverse, i, V, z):  # type: ignore[no-untyped-def]
    """Fill `z` (6,) with the modes of the velocity of body i; `V` (6,) is workspace."""
    lab, e = on_stack(3, np.float64), beads.e[i]
    for k in range(3):
        lab[k] = beads.v[k, i]
    rotated_back(e, lab, V)
    for k in range(3):
        lab[k] = beads.v[3 + k, i]
    rotated_back(e, lab, lab)
    for k in range(3):
        V[3 + k] = lab[k]
    times(inverse, V, z)


@named_njit(inner=True, error_model="numpy")
def _keep_velocity(beads, P, i, z, V):  # type: ignore[no-untyped-def]
    """Set the velocity of body i, in the laboratory's frame, from its modes `z` (6,).

    The body's orientation is the final one. `V` (6,) is workspace.
    """
    lab, e = on_stack(3, np.float64), beads.e[i]
    times(P, z, V)
    rotated(e, V, lab)
    for k in range(3):
        beads.v[k, i] = lab[k]
        lab[k] = V[3 + k]
    rotated(e, lab, lab)
    for k in range(3):
        beads.v[3 + k, i] = lab[k]


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all bodies by one step with inertia and two force evaluations.

    plan: its drag has the data of `data_of`. weights: exact steps of the six modes. Poses and
    velocities are changed in place.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    data, n, w = plan.drag.data, len(beads.pose.time), weights
    P, inverse, slow, root = (
        matrix(data, MODES), matrix(data, INVERSE), matrix(data, SLOW), matrix(data, ROOT),
    )  # fmt: skip
    q, e, W = on_stack(3, np.float64), on_stack(4, np.float64), on_stack(6, np.float64)
    z, s, way = on_stack(6, np.float64), on_stack(6, np.float64), on_stack(6, np.float64)
    V, xi, work = on_stack(6, np.float64), on_stack(6, np.float64), on_stack(6, np.float64)
    normal, v = beads.normal, beads.v
    read_here(beads)
    evaluate(force, beads, beads.now[0])
    for i in range(n):
        wrench_in_body(plan, beads, i, W)
        times(slow, W, s)
        _modes_of(beads, inverse, i, V, z)
        drawn(root, normal, i, xi)
        pose_of(beads, i, q, e)
        for k in range(6):
            way[k] = w.by_v[k] * z[k] + w.by_u[k] * s[k]
        times(P, way, V)
        go(q, e, 1.0, V, work)
        go(q, e, 1.0, xi, work)
        read_at(beads, i, q, e)
        for k in range(6):
            way[k] -= w.by_rise[k] * s[k]
            shaken = w.noise_xv[k] * normal[k, i] + w.noise_v[k] * normal[6 + k, i]
            v[k, i] = w.decay[k] * z[k] + (w.v_by_u[k] - w.v_by_rise[k]) * s[k] + shaken
        times(P, way, V)
        for k in range(6):
            beads.u[k, i], beads.kick[k, i] = V[k], xi[k]
    evaluate(force, beads, beads.now[0] + plan.step)
    for i in range(n):
        wrench_in_body(plan, beads, i, W)
        times(slow, W, s)
        pose_of(beads, i, q, e)
        go(q, e, 1.0, beads.u[:, i], work)
        go(q, e, 1.0, beads.kick[:, i], work)
        for k in range(6):
            way[k] = w.by_rise[k] * s[k]
            z[k] = v[k, i] + w.v_by_rise[k] * s[k]
        times(P, way, V)
        go(q, e, 1.0, V, work)
        keep(beads, i, q, e)
        _keep_velocity(beads, P, i, z, V)


HEUN = Scheme(step, exact_without_springs, force_calls=2, body=data_of)
