"""Steps of a rigid body of any shape without inertia: two schemes on the group of its poses.

In the body's frame the mobility B is a constant matrix (6, 6). With the wrench W in this frame, a
pose g of SE(3) moves by the Stratonovich equation

    dg = g (B W dt + sqrt(2 kT) B^(1/2) dw),

which keeps Boltzmann's distribution without a drift term. A free step g exp(xi) with xi from
N(0, 2 kT B h) is of weak order 1 for a body that rotates, because exponentials do not commute. The
covariance 2 kT (B h + kT C h^2) makes it of order 2; C is `correction`.

The trapezoid puts the noise between two half drifts and calls the force twice. It is of weak order
2 for every force, and is Heun's method where nothing rotates:

    u = B W(g),  g~ = g exp(h u) exp(xi),  u~ = B W(g~),  g' = g exp(h u/2) exp(xi) exp(h u~/2).

The step with one call puts the force between two equal halves of the noise. Histograms of g* in
wells then hardly depend on the step:

    g* = g exp(xi/2),  g' = g* exp(h u(g*)) exp(xi/2).
"""

from __future__ import annotations

import numpy as np

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.stack import borrowed, on_stack
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.brownian.batch import Scheme, exact_without_springs
from tweezer.dynamics.layout import ROTATION, TRANSLATION
from tweezer.dynamics.se3 import moved, rotated_back
from tweezer.forces.data import Data, matrix, packed
from tweezer.forces.force import add, clear
from tweezer.values.arrays import Array

#: Entries of the data of a step: the mobility, and a root of the covariance of the noise
MOBILITY, ROOT = 0, 1


def _structure_constants() -> Array:
    """Return f (6, 6, 6) with [X_a, X_b] = f_abc X_c, for translations and then rotations."""
    epsilon = np.zeros((3, 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        epsilon[i, j, k], epsilon[j, i, k] = 1.0, -1.0
    f = np.zeros((6, 6, 6))
    f[ROTATION, ROTATION, ROTATION] = epsilon
    f[ROTATION, TRANSLATION, TRANSLATION] = f[TRANSLATION, ROTATION, TRANSLATION] = epsilon
    return f


_F = _structure_constants()


def correction(B: Array) -> Array:
    """Return C (6, 6) of the covariance 2 kT (B h + kT C h^2) of a free step.

    The expectation of exp(xi) differs from the exact semigroup in order h^2 by products of four
    fields X_a. Commutators reduce this difference to products of two fields, which C removes.

    Parameters
    ----------
    B : ndarray, shape (6, 6)
        Mobility in the body's frame, of translations first.
    """
    T = np.einsum("ac,bd,bce->aed", B, B, _F)
    Q = np.einsum("aed,edp->ap", 1.5 * T, _F) + np.einsum("aed,adp->pe", 1.5 * T, _F)
    Q += np.einsum("aed,aep->dp", 1.5 * T, _F) + np.einsum("aed,dep->ap", T, _F)
    return -(Q + Q.T) / 12


def corrected(covariance: Array) -> Array:
    """Return the covariance of the twist of a free step, with the correction, (6, 6).

    Parameters
    ----------
    covariance : ndarray, shape (6, 6)
        Covariance without the correction, 2 kT B h for a step h.
    """
    return covariance + 2 * correction(covariance / 2)


def data_of(body: BodyMotion, kT: float, step: float) -> Data:
    """Return the data that the steps read, for a rigid body, kT (J) and a step (s)."""
    return packed(body.mobility, np.linalg.cholesky(corrected(2 * kT * step * body.mobility)))


@named_njit(inner=True, error_model="numpy")
def times(A, b, out):  # type: ignore[no-untyped-def]
    """Fill `out` (6,) with the product of a matrix (6, 6) and a vector (6,)."""
    for i in range(6):
        total = 0.0
        for j in range(6):
            total += A[i, j] * b[j]
        out[i] = total


@named_njit(inner=True, error_model="numpy")
def drawn(root, normal, i, out):  # type: ignore[no-untyped-def]
    """Fill `out` (6,) with a matrix (6, 6) times the normal numbers of body i, `normal` (6, w)."""
    for k in range(6):
        total = 0.0
        for j in range(6):
            total += root[k, j] * normal[j, i]
        out[k] = total


@named_njit(inner=True, error_model="numpy")
def evaluate(force, beads, time):  # type: ignore[no-untyped-def]
    """Fill `beads.wrench` with the force and torque at the poses `beads.pose` and a time, s."""
    pose = beads.pose
    for i in range(len(pose.time)):
        pose.time[i] = time
    clear(beads.wrench)
    add(force, pose, beads.wrench)


@named_njit(inner=True, error_model="numpy")
def wrench_in_body(plan, beads, i, out):  # type: ignore[no-untyped-def]
    """Fill `out` (6,) with the force and torque on body i in its own frame, with its weight.

    They were evaluated at `beads.pose`.
    """
    wrench, e = beads.wrench, beads.pose.orientation[i]
    lab = on_stack(3, np.float64)
    for k in range(3):
        lab[k] = wrench.force[i, k] + plan.load[k]
    rotated_back(e, lab, out)
    for k in range(3):
        lab[k] = wrench.moment[i, k]
    rotated_back(e, lab, lab)
    for k in range(3):
        out[3 + k] = lab[k]


@named_njit(inner=True, error_model="numpy")
def go(q, e, part, twist, xi):  # type: ignore[no-untyped-def]
    """Move the pose (`q` (3,), m, and `e` (4,)) in place by a part of a twist (6,).

    `xi` (6,) is workspace.
    """
    for k in range(6):
        xi[k] = part * twist[k]
    moved(q, e, xi, q, e)


@named_njit(inner=True, error_model="numpy")
def pose_of(beads, i, q, e):  # type: ignore[no-untyped-def]
    """Fill `q` (3,) and `e` (4,) with the pose of body i at the beginning of a step."""
    for k in range(3):
        q[k] = beads.x[k, i]
    for k in range(4):
        e[k] = beads.e[i, k]


@named_njit(inner=True, error_model="numpy")
def read_here(beads):  # type: ignore[no-untyped-def]
    """Set the poses at which the force is read to those at the beginning of a step."""
    for i in range(len(beads.pose.time)):
        pose_of(beads, i, beads.pose.position[i], beads.pose.orientation[i])


@named_njit(inner=True, error_model="numpy")
def read_at(beads, i, q, e):  # type: ignore[no-untyped-def]
    """Set the pose of body i at which the force is read."""
    for k in range(3):
        beads.pose.position[i, k] = q[k]
    for k in range(4):
        beads.pose.orientation[i, k] = e[k]


@named_njit(inner=True, error_model="numpy")
def keep(beads, i, q, e):  # type: ignore[no-untyped-def]
    """Set the pose of body i at the end of a step."""
    for k in range(3):
        beads.x[k, i] = q[k]
    for k in range(4):
        beads.e[i, k] = e[k]


@cached_njit(error_model="numpy", nogil=True)
def trapezoid_step(force, plan, weights, beads):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Advance all bodies by one step of the trapezoid, with two force evaluations.

    plan: its drag has the data of `data_of`. Poses are changed in place.
    """
    force, plan, beads = borrowed((force, plan, beads))
    mobility, root = matrix(plan.drag.data, MOBILITY), matrix(plan.drag.data, ROOT)
    h, n = plan.step, len(beads.pose.time)
    q, e, W = on_stack(3, np.float64), on_stack(4, np.float64), on_stack(6, np.float64)
    u, xi = on_stack(6, np.float64), on_stack(6, np.float64)
    work = on_stack(6, np.float64)
    read_here(beads)
    evaluate(force, beads, beads.now[0])
    for i in range(n):
        wrench_in_body(plan, beads, i, W)
        times(mobility, W, u)
        drawn(root, beads.normal, i, xi)
        for k in range(6):
            beads.u[k, i], beads.kick[k, i] = u[k], xi[k]
        pose_of(beads, i, q, e)
        go(q, e, h, u, work)
        go(q, e, 1.0, xi, work)
        read_at(beads, i, q, e)
    evaluate(force, beads, beads.now[0] + h)
    for i in range(n):
        wrench_in_body(plan, beads, i, W)
        pose_of(beads, i, q, e)
        go(q, e, 0.5 * h, beads.u[:, i], work)
        go(q, e, 1.0, beads.kick[:, i], work)
        times(mobility, W, u)
        go(q, e, 0.5 * h, u, work)
        keep(beads, i, q, e)


@cached_njit(error_model="numpy", nogil=True)
def one_call_step(force, plan, weights, beads):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Advance all bodies by one step with one force evaluation, at the pose g*.

    plan: its drag has the data of `data_of`. The positions of g* are left in `beads.ahead` and its
    orientations in `beads.pose`.
    """
    force, plan, beads = borrowed((force, plan, beads))
    mobility, root = matrix(plan.drag.data, MOBILITY), matrix(plan.drag.data, ROOT)
    h, n = plan.step, len(beads.pose.time)
    q, e, W = on_stack(3, np.float64), on_stack(4, np.float64), on_stack(6, np.float64)
    u, xi = on_stack(6, np.float64), on_stack(6, np.float64)
    work = on_stack(6, np.float64)
    for i in range(n):
        pose_of(beads, i, q, e)
        drawn(root, beads.normal, i, xi)
        go(q, e, 0.5, xi, work)
        read_at(beads, i, q, e)
        for k in range(3):
            beads.ahead[k, i] = q[k]
        for k in range(6):
            beads.kick[k, i] = xi[k]
    evaluate(force, beads, beads.now[0] + 0.5 * h)
    for i in range(n):
        wrench_in_body(plan, beads, i, W)
        times(mobility, W, u)
        position, turned = beads.pose.position[i], beads.pose.orientation[i]
        for k in range(3):
            q[k] = position[k]
        for k in range(4):
            e[k] = turned[k]
        go(q, e, h, u, work)
        go(q, e, 0.5, beads.kick[:, i], work)
        keep(beads, i, q, e)


TRAPEZOID = Scheme(trapezoid_step, exact_without_springs, force_calls=2, body=data_of)
ONE_CALL = Scheme(
    one_call_step, exact_without_springs, force_calls=1, samples_ahead=True, body=data_of
)
