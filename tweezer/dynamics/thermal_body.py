"""Linear motion and time scales of a body of any shape in thermal motion."""

from __future__ import annotations

import numpy as np

from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.layout import ROTATION, TRANSLATION
from tweezer.dynamics.problem import Problem
from tweezer.values.arrays import Array

#: Longest step over the time of rotational diffusion about the fastest axis, and the usual one.
#: The decay rates of the mean axes are then wrong by 0.2 % and 0.05 %, and those of their second
#: moments by 0.6 % and 0.15 %
LONGEST, USUAL = 0.2, 0.1
#: Twist of the differences that give the stiffness, in sizes of the body and in rad
_SHORT = 1e-3


def largest_mobilities(body: BodyMotion) -> Array:
    """Return the largest mobility of translation, s/kg, and of rotation, 1/(N m s), three times
    each, (6,).
    """
    B = body.mobility
    largest = [np.linalg.eigvalsh(B[part, part])[-1] for part in (TRANSLATION, ROTATION)]
    return np.repeat(largest, 3)


def rates_of_wrench(problem: Problem) -> Array:
    """Return the rates of the force and torque at random poses about the foci, (n,) 1/s.

    A rate is the spectral norm of B^(1/2) K B^(1/2), with the mobility B and the derivative K of
    the wrench by a twist, both (6, 6) in the body's frame. For a stable pose without circulation it
    is the largest relaxation rate. For forces that change in time the largest rates are returned.
    """
    found = [_rates(problem, time) for time in problem.times_looked_at()]
    return max(found, key=lambda each: float(np.median(each)))


def _rates(problem: Problem, time: float) -> Array:
    """Return the rates of `rates_of_wrench` at a time, s, (n,) 1/s."""
    from scipy.spatial.transform import Rotation

    assert problem.body is not None
    places = problem.places_about(time)
    n = len(places)
    rng = np.random.default_rng(7)
    turned = Rotation.from_quat(rng.normal(size=(n, 4)), scalar_first=True)
    length = np.repeat([_SHORT * problem.scene.body.size, _SHORT], 3)
    wrenches = np.empty((2, 6, n, 6))
    for sign in (0, 1):
        for k in range(6):
            twist = (2 * sign - 1) * length[k] * np.eye(6)[k]
            there = places + turned.apply(twist[TRANSLATION])
            rotation = turned * Rotation.from_rotvec(twist[ROTATION])
            e = rotation.as_quat(scalar_first=True)
            field = problem.force.field(there, time=time, orientations=e)
            force = field.force + np.array(problem.bead.weight)
            wrenches[sign, k, :, TRANSLATION] = rotation.inv().apply(force)
            wrenches[sign, k, :, ROTATION] = rotation.inv().apply(field.moment)
    slopes = (wrenches[1] - wrenches[0]) / (2 * length[:, None, None])
    root = np.linalg.cholesky(problem.body.mobility)
    scaled = np.einsum("bi,knb,kj->nij", root, slopes, root)
    sizes: Array = np.linalg.norm(scaled, ord=2, axis=(1, 2))
    return sizes
