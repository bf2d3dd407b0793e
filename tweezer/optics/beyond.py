"""The force outside the range of a table."""

from __future__ import annotations

import numpy as np

from tweezer.compiled import address, cached_njit
from tweezer.forces.data import Part, packed
from tweezer.forces.force import KERNEL, Pose, Wrench, add


def unreached() -> Part:
    """Return a stand-in for the force outside a table, whose infinite error marks the positions.

    It lets a table be read without a force outside it, which would have to be compiled.
    """
    return Part(address(_infinite_error, KERNEL), packed())


@cached_njit(error_model="numpy", nogil=True)
def _infinite_error(pose, data, wrench):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Set the error of every bead to infinity, as a kernel."""
    wrench.error[:] = np.inf


@cached_njit(error_model="numpy", nogil=True)
def add_one(force, pose, at, wrench):  # type: ignore[no-untyped-def]
    """Add a force (`Part`) on the bead number `at` alone to its row of `wrench`."""
    one = slice(at, at + 1)
    add(
        force,
        Pose(pose.time[one], pose.position[one], pose.orientation[one], pose.drive),
        Wrench(
            wrench.force[one], wrench.moment[one], wrench.force_gradient[one],
            wrench.moment_gradient[one], wrench.error[one],
        ),
    )  # fmt: skip
