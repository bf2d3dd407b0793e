"""Poses of a rigid body as elements of SE(3): a position, and an orientation by Euler parameters.

A twist xi = (rho, theta) has components in the body's frame. The pose g exp(xi) is reached by a
constant velocity rho and a constant angular velocity theta over a unit of time.
"""

from __future__ import annotations

import math

import numpy as np

from tweezer.compiled import named_njit
from tweezer.compiled.stack import on_stack

#: Angle below which functions of an angle are computed by their series, rad
_SMALL = 0.02


@named_njit(inner=True, error_model="numpy")
def rotated(e, v, out):  # type: ignore[no-untyped-def]
    """Fill `out` (3,) with R v: from components in the body's frame to the laboratory's (A.2)."""
    # v + 2 e0 (r x v) + 2 r x (r x v) with r = (e1, e2, e3), for |e| = 1
    e0, e1, e2, e3 = e[0], e[1], e[2], e[3]
    v1, v2, v3 = v[0], v[1], v[2]
    t1 = 2.0 * (e2 * v3 - e3 * v2)
    t2 = 2.0 * (e3 * v1 - e1 * v3)
    t3 = 2.0 * (e1 * v2 - e2 * v1)
    out[0] = v1 + e0 * t1 + e2 * t3 - e3 * t2
    out[1] = v2 + e0 * t2 + e3 * t1 - e1 * t3
    out[2] = v3 + e0 * t3 + e1 * t2 - e2 * t1


@named_njit(inner=True, error_model="numpy")
def rotated_back(e, v, out):  # type: ignore[no-untyped-def]
    """Fill `out` (3,) with R^T v: from components in the laboratory's frame to the body's."""
    e0, e1, e2, e3 = e[0], e[1], e[2], e[3]
    v1, v2, v3 = v[0], v[1], v[2]
    t1 = 2.0 * (e3 * v2 - e2 * v3)
    t2 = 2.0 * (e1 * v3 - e3 * v1)
    t3 = 2.0 * (e2 * v1 - e1 * v2)
    out[0] = v1 + e0 * t1 - e2 * t3 + e3 * t2
    out[1] = v2 + e0 * t2 - e3 * t1 + e1 * t3
    out[2] = v3 + e0 * t3 - e1 * t2 + e2 * t1


@named_njit(inner=True, error_model="numpy")
def turn_in_body(e, w1, w2, w3, out):  # type: ignore[no-untyped-def]
    """Fill `out` (4,) with e exp(w/2): the orientation e turned by a rotation vector w, rad.

    `w1`, `w2` and `w3` are the components of w in the body's frame. `e` and `out` are Euler
    parameters of length 1, and may be the same array.
    """
    squared = w1 * w1 + w2 * w2 + w3 * w3
    if squared < _SMALL * _SMALL:
        c = 1.0 - squared / 8.0 * (1.0 - squared / 48.0)
        over = 0.5 - squared / 48.0 * (1.0 - squared / 80.0)
    else:
        size = math.sqrt(squared)
        c, over = math.cos(0.5 * size), math.sin(0.5 * size) / size
    r1, r2, r3 = over * w1, over * w2, over * w3
    e0, e1, e2, e3 = e[0], e[1], e[2], e[3]
    out[0] = c * e0 - r1 * e1 - r2 * e2 - r3 * e3
    out[1] = c * e1 + r1 * e0 - r2 * e3 + r3 * e2
    out[2] = c * e2 + r2 * e0 - r3 * e1 + r1 * e3
    out[3] = c * e3 + r3 * e0 - r1 * e2 + r2 * e1
    # the same rounding, step after step, would add up: one step of Newton to 1/|e|
    length = out[0] ** 2 + out[1] ** 2 + out[2] ** 2 + out[3] ** 2
    for i in range(4):
        out[i] *= 1.5 - 0.5 * length


@named_njit(inner=True, error_model="numpy")
def moved(position, e, xi, out_position, out_e):  # type: ignore[no-untyped-def]
    """Fill `out_position` (3,) and `out_e` (4,) with the pose g exp(xi) after a twist xi (6,).

    `position` (3,), m, and `e` (4,) are the pose g. They may be the same arrays as the results.
    """
    r1, r2, r3 = xi[0], xi[1], xi[2]
    w1, w2, w3 = xi[3], xi[4], xi[5]
    squared = w1 * w1 + w2 * w2 + w3 * w3
    if squared < _SMALL * _SMALL:
        a = 0.5 - squared / 24.0 * (1.0 - squared / 30.0)
        b = 1.0 / 6.0 - squared / 120.0 * (1.0 - squared / 42.0)
    else:
        size = math.sqrt(squared)
        half = math.sin(0.5 * size)
        a = 2.0 * half * half / squared
        b = (size - math.sin(size)) / (squared * size)
    # rho + a theta x rho + b theta x (theta x rho)
    c1, c2, c3 = w2 * r3 - w3 * r2, w3 * r1 - w1 * r3, w1 * r2 - w2 * r1
    way = on_stack(3, np.float64)
    way[0] = r1 + a * c1 + b * (w2 * c3 - w3 * c2)
    way[1] = r2 + a * c2 + b * (w3 * c1 - w1 * c3)
    way[2] = r3 + a * c3 + b * (w1 * c2 - w2 * c1)
    rotated(e, way, way)
    for i in range(3):
        out_position[i] = position[i] + way[i]
    turn_in_body(e, w1, w2, w3, out_e)


@named_njit(inner=True, error_model="numpy")
def from_middle(theta, w, out):  # type: ignore[no-untyped-def]
    """Fill `out` (3,) with J^-1(theta) w - w for R = R_0 exp(theta), so that theta' = w + `out`.

    J is the right Jacobian of SO(3) and w (3,) the angular velocity in the body's frame, rad/s. The
    sum is w + theta x w/2 + (1/t^2 - cot(t/2)/2t) theta x (theta x w), with t = |theta|.
    """
    w1, w2, w3 = w[0], w[1], w[2]
    a1, a2, a3 = theta[0], theta[1], theta[2]
    squared = a1 * a1 + a2 * a2 + a3 * a3
    if squared < 0.01:
        b = 1.0 / 12.0 + squared / 720.0 * (1.0 + squared / 42.0 * (1.0 + squared / 40.0))
    else:
        size = math.sqrt(squared)
        b = 1.0 / squared - 0.5 / (size * math.tan(0.5 * size))
    c1, c2, c3 = a2 * w3 - a3 * w2, a3 * w1 - a1 * w3, a1 * w2 - a2 * w1
    out[0] = 0.5 * c1 + b * (a2 * c3 - a3 * c2)
    out[1] = 0.5 * c2 + b * (a3 * c1 - a1 * c3)
    out[2] = 0.5 * c3 + b * (a1 * c2 - a2 * c1)
