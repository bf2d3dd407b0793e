"""Rotation of a force from the frame with the bead in the plane y = 0 to the scene's frame."""

from __future__ import annotations

import numpy as np

from tweezer.compiled import named_njit


@named_njit(error_model="numpy", inner=True)
def put(found, cosine, sine, gradient, moment, at, wrench):  # type: ignore[no-untyped-def]
    """Add the force on one bead to row `at` of a `Wrench`, turned about z into the scene's frame.

    `found` (24,) are force, torque and their gradients, row by row, with the bead in the plane
    y = 0. The bead's azimuth has this `cosine` and `sine`. Gradients and moments are added if
    `gradient` and `moment` are true.
    """
    wrench.force[at, 0] += cosine * found[0] - sine * found[1]
    wrench.force[at, 1] += sine * found[0] + cosine * found[1]
    wrench.force[at, 2] += found[2]
    if moment:
        wrench.moment[at, 0] += cosine * found[3] - sine * found[4]
        wrench.moment[at, 1] += sine * found[3] + cosine * found[4]
        wrench.moment[at, 2] += found[5]
    if gradient:
        _add_turned(found[6:15], cosine, sine, wrench.force_gradient[at])
        if moment:
            _add_turned(found[15:24], cosine, sine, wrench.moment_gradient[at])


@named_njit(error_model="numpy", nogil=True, inner=True)
def _add_turned(matrix, cosine, sine, out):  # type: ignore[no-untyped-def]
    """Add R J R^T to `out` (3, 3): the matrix J, (9,) row by row, turned about z by R.

    The angle has this `cosine` and `sine`.
    """
    half = np.empty(9)
    for j in range(3):
        half[j] = cosine * matrix[j] - sine * matrix[3 + j]
        half[3 + j] = sine * matrix[j] + cosine * matrix[3 + j]
        half[6 + j] = matrix[6 + j]
    for i in range(3):
        out[i, 0] += cosine * half[3 * i] - sine * half[3 * i + 1]
        out[i, 1] += sine * half[3 * i] + cosine * half[3 * i + 1]
        out[i, 2] += half[3 * i + 2]
