"""The regions in each of which the force of rays is smooth: see `tweezer.optics.rays.charts`."""

from __future__ import annotations

import math

from tweezer.compiled import cached_njit
from tweezer.forces.data import number

#: Lower bound on w, which keeps a bead at the circle off the lines
_LEAST_W = 1e-8
#: Number of the lines in each of P and Q, and one more
_LINES = 5


@cached_njit(error_model="numpy", nogil=True)
def number_of_region(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add to `wrench.error` the number of the region of each bead.

    The number is 0 with the focus inside the bead. Outside it is 1, plus five times the count of
    lines +-tau, +-1/tau that are not above P, plus the count that are not above the coordinate Q
    here. With the bead at the angle gamma to the axis, d radii from the focus, let p, q = gamma -+
    arccos(1/d). Then
    P = tan((p - pi/2)/2), Q = tan((q - pi/2)/2) and tau = tan(theta_m/2). The data of this kernel
    are the radius (m) and the half angle theta_m of the cone of light (rad).
    """
    radius, half_angle = number(data, 0), number(data, 1)
    tau = math.tan(0.5 * half_angle)
    for at in range(len(pose.position)):
        x1, x2 = pose.position[at, 0] / radius, pose.position[at, 1] / radius
        squared, z = x1 * x1 + x2 * x2, pose.position[at, 2] / radius
        dd = squared + z * z
        if dd < 1.0:
            continue
        rho, w = math.sqrt(squared), max(math.sqrt(dd - 1.0), _LEAST_W)
        P = -(z + rho * w) / (dd + rho - z * w)
        Q = -(z - rho * w) / (dd + rho + z * w)
        region = 1
        for line in (-1.0 / tau, -tau, tau, 1.0 / tau):
            region += _LINES * (line <= P) + (line <= Q)
        wrench.error[at] += region
