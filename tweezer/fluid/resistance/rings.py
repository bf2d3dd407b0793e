"""Resistance of a body of revolution, by a single layer of rings.

Forces f per area on the surface of a moving body cause its flow (C. Pozrikidis, Boundary Integral
and Singularity Methods, 1992, chapter 2),

    u(x_0) = 1/(8 pi mu) int G(x_0 - x) f(x) dS,  G = 1/R + X X^T/R^3,  X = x_0 - x.

On a body of revolution f is
(f_r cos(m phi), f_p sin(m phi), f_z cos(m phi)). Motions along and about the axis have m = 0, and
motions across it m = 1. Only the generating curve is divided, into panels with a polynomial each.

The integral round the axis uses Jacobi's amplitude for the angle: psi = pi - 2 am(u). Because
R = R_max dn(u), the integrand is smooth and periodic in u, however close a ring is to the point.
Therefore equal steps in u converge exponentially.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from numpy.typing import NDArray

from tweezer.values.arrays import Array

Indices: TypeAlias = NDArray[np.intp]


class Piece(NamedTuple):
    """Straight line or part of an ellipse of a generating curve, for a parameter from 0 to 1.

    The place is r, z = start + t step + radii (sin, cos)(angle + t turn).
    """

    start: tuple[float, float] = (0.0, 0.0)
    step: tuple[float, float] = (0.0, 0.0)
    radii: tuple[float, float] = (0.0, 0.0)
    angle: float = 0.0
    turn: float = 0.0


class _Division(NamedTuple):
    """Fineness of the division of a curve."""

    nodes: int
    """nodes of a panel"""
    levels: int
    """panels towards a right angle, each shorter by `_GRADING`"""
    longest: float
    """longest panel over the largest radius of its piece"""
    turn: float
    """largest turn within a panel, rad"""


#: Ratio of successive panels towards an edge
_GRADING = 0.15
#: Divisions whose results are compared
_COARSE, _FINE = _Division(6, 5, 1.5, 0.5), _Division(8, 6, 1.2, 0.4)
#: Gauss nodes of a far part of a panel, and of each side of the point on its own panel, where the
#: distance is the power `_POWER` of the variable
_FAR, _OWN, _POWER = 8, 16, 4
#: Steps round the axis, up to these values of K/K' of Jacobi's functions
_ROUND = ((6, 1.1), (10, 2.0), (18, 4.0), (32, math.inf))
#: Smallest complementary modulus
_NEAREST = 1e-12
#: Steps of the arithmetic-geometric mean
_MEANS = 8


def line(start: tuple[float, float], end: tuple[float, float]) -> Piece:
    """Return a straight piece between two points r, z, m."""
    return Piece(start, (end[0] - start[0], end[1] - start[1]))


def arc(height: float, radii: tuple[float, float], start: float, end: float) -> Piece:
    """Return a part of an ellipse whose centre is on the axis.

    Parameters
    ----------
    height : float
        Position of the centre along z, m.
    radii : tuple of float
        Semi-axes along r and z, m.
    start, end : float
        Angles from +z between which the part lies, rad.
    """
    return Piece((0.0, height), (0.0, 0.0), radii, start, end - start)


def revolved_resistance(pieces: Sequence[Piece], viscosity: float) -> tuple[Array, float]:
    """Return the resistance of a body of revolution about the origin, and its relative error.

    Parameters
    ----------
    pieces : sequence of Piece
        Generating curve about the z axis, from the axis to the axis.
    viscosity : float
        Viscosity, Pa s.

    Returns
    -------
    matrix : ndarray, shape (6, 6)
        Resistance matrix.
    error : float
        Largest relative change of an element of the diagonal from a coarser division.
    """
    unit = float(np.abs(_Curve.of(pieces).places(np.arange(len(pieces)), np.ones(1))[0]).max())
    coarse, fine = (_matrix(_panels(pieces, unit, division)) for division in (_COARSE, _FINE))
    change = np.abs(np.diag(coarse) / np.diag(fine) - 1).max()
    scale = np.array([1.0, 1.0, 1.0, unit, unit, unit])
    return viscosity * unit * scale[:, None] * scale * fine, float(change) + 1e-11


class _Curve(NamedTuple):
    """Pieces of a curve as arrays."""

    start: Array
    step: Array
    radii: Array
    angle: Array
    turn: Array

    @classmethod
    def of(cls, pieces: Sequence[Piece], unit: float = 1.0) -> _Curve:
        """Return the curve of these pieces, in a unit of length, m."""
        start, step, radii, angle, turn = (
            np.array(each, float) for each in zip(*pieces, strict=True)
        )
        return cls(start / unit, step / unit, radii / unit, angle, turn)

    def places(self, piece: Indices, t: Array) -> tuple[Array, Array]:
        """Return r and z at parameters of pieces, and the derivatives, (n, 2) each."""
        turn, radii = self.turn[piece], self.radii[piece]
        angle = self.angle[piece] + t * turn
        wave = np.stack([np.sin(angle), np.cos(angle)], axis=1)
        point = self.start[piece] + t[:, None] * self.step[piece] + radii * wave
        speed = self.step[piece] + (radii * turn[:, None]) * wave[:, ::-1] * [1.0, -1.0]
        return point, speed


class _Panels(NamedTuple):
    """Panels of a curve, in units of the body's size."""

    curve: _Curve
    piece: Indices
    """number of the piece of each panel"""
    start: Array
    """parameter of its piece at which each panel starts"""
    end: Array
    """parameter at which it ends"""
    nodes: int
    """nodes of a panel"""

    def places(self, panel: Indices, t: Array) -> tuple[Array, Array]:
        """Return r and z at parameters of panels, (n, 2), and the speeds along the curve, (n,)."""
        point, speed = self.curve.places(self.piece[panel], t)
        return point, np.hypot(speed[:, 0], speed[:, 1])


def _panels(pieces: Sequence[Piece], unit: float, division: _Division) -> _Panels:
    """Divide a curve into panels, graded towards its edges."""
    curve, within = _Curve.of(pieces, unit), np.linspace(0, 1, 65)
    piece: list[int] = []
    starts: list[float] = []
    stops: list[float] = []
    sampled = [curve.places(np.full(65, i), within) for i in range(len(pieces))]
    ends = [np.arctan2(*speed[[0, -1]].T) for _, speed in sampled]
    for i, (points, _) in enumerate(sampled):
        length = np.hypot(*np.diff(points, axis=0).T).sum()
        count = max(1, math.ceil(length / (division.longest * points[:, 0].max()) - 1e-9),
                    math.ceil(abs(pieces[i].turn) / division.turn - 1e-9))  # fmt: skip
        marks = np.linspace(0, 1, count + 1)
        before = abs(ends[i][0] - ends[i - 1][1]) if i else 0.0
        after = abs(ends[i + 1][0] - ends[i][1]) if i + 1 < len(pieces) else 0.0
        lower, upper = (_levels(each, division.levels) for each in (before, after))
        width = marks[1] * (0.5 if count == 1 and lower and upper else 1.0)
        low = width * _GRADING ** np.arange(lower, 0, -1)
        high = 1 - width * _GRADING ** np.arange(1, upper + 1)
        marks = np.unique(np.concatenate([marks, low, high]))
        piece += [i] * (marks.size - 1)
        starts += list(marks[:-1])
        stops += list(marks[1:])
    return _Panels(curve, np.array(piece), np.array(starts), np.array(stops), division.nodes)


def _levels(turn: float, most: int) -> int:
    """Return the number of panels towards an edge at which the curve turns by an angle."""
    turn = min(turn, 2 * math.pi - turn)
    return round(most * min(1.0, turn / 0.8))


def _matrix(panels: _Panels) -> Array:
    """Return the resistance matrix for the viscosity 1, in units of the body's size."""
    count, n = panels.start.size, panels.nodes
    x, w = leggauss(n)
    panel = np.repeat(np.arange(count), n)
    half = (panels.end - panels.start)[panel] / 2
    t = panels.start[panel] + half * (1 + np.tile(x, count))
    places, length = panels.places(panel, t)
    r, z = places.T
    round_axis = r * length * half * np.tile(w, count)
    to_values = np.asarray(np.linalg.inv(legvander(x, n - 1)), float)
    rows = np.stack([
        _row(panels, to_values, panel[i], t[i], places[i]) for i in range(t.size)
    ])  # fmt: skip
    one, none = np.ones_like(r), np.zeros_like(r)
    matrix = np.zeros((6, 6))
    # rows: (targets, kind, nodes)
    rr, rz, zr, zz, pp = (rows[:, kind] for kind in range(5))
    # along the axis, where a layer along the normal makes no flow
    found = np.linalg.lstsq(
        np.block([[rr, rz], [zr, zz]]), np.concatenate([none, one]), rcond=1e-13
    )[0]
    matrix[2, 2] = 2 * math.pi * (found[r.size :] @ round_axis)
    matrix[5, 5] = 2 * math.pi * ((np.linalg.solve(pp, r) * r) @ round_axis)
    across = np.block([[rows[:, 5 + 3 * i + j] for j in range(3)] for i in range(3)])
    motions = np.stack([
        np.concatenate([one, -one, none]), np.concatenate([z, -z, -r])
    ], axis=1)  # fmt: skip
    weights = math.pi * motions * np.tile(round_axis, 3)[:, None]
    found = weights.T @ np.linalg.solve(across, motions)
    matrix[0, 0] = matrix[1, 1] = found[0, 0]
    matrix[3, 3] = matrix[4, 4] = found[1, 1]
    coupled = (found[0, 1] + found[1, 0]) / 2
    matrix[0, 4] = matrix[4, 0] = coupled
    matrix[1, 3] = matrix[3, 1] = -coupled
    return 8 * math.pi * matrix


def _row(panels: _Panels, to_values: Array, own: int, at: float, place: Array) -> Array:
    """Return the velocities at a node by the layer's values at all nodes, (14, nodes)."""
    panel, t, weight = _sources(panels, own, at, place)
    points, length = panels.places(panel, t)
    kernels = _kernels(place, points) * (weight * length)
    middle = (panels.start + panels.end)[panel] / 2
    local = (t - middle) / ((panels.end - panels.start)[panel] / 2)
    values = legvander(local, panels.nodes - 1) @ to_values
    found = np.zeros((len(kernels), panels.start.size, panels.nodes))
    np.add.at(np.swapaxes(found, 0, 1), panel, (kernels[:, :, None] * values).swapaxes(0, 1))
    return found.reshape(len(kernels), -1)


def _sources(panels: _Panels, own: int, at: float, place: Array) -> tuple[Indices, Array, Array]:
    """Return panel, parameter and weight of the quadrature nodes for a point on the curve."""
    x, w = leggauss(_OWN)
    x, w = (1 + x) / 2, w / 2
    found: list[tuple[Indices, Array, Array]] = []
    for end in (panels.start[own], panels.end[own]):
        t = at + (end - at) * x**_POWER
        weight = abs(end - at) * _POWER * x ** (_POWER - 1) * w
        found.append((np.full(t.size, own), t, weight))
    x, w = leggauss(_FAR)
    panel = np.delete(np.arange(panels.start.size), own)
    low, high = panels.start[panel], panels.end[panel]
    while panel.size:
        marks = np.stack([low, (low + high) / 2, high])
        points = np.stack([panels.places(panel, each)[0] for each in marks])
        long = np.hypot(*np.moveaxis(np.diff(points, axis=0), 2, 0)).sum(axis=0)
        near = np.linalg.norm(points - place, axis=2).min(axis=0)
        done = long <= near
        half = (high - low)[done] / 2
        t = marks[1][done][:, None] + half[:, None] * x
        found.append((np.repeat(panel[done], x.size), t.ravel(), np.outer(half, w).ravel()))
        low, middle, high = (each[~done] for each in marks)
        panel = np.tile(panel[~done], 2)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    panels_, t, weight = zip(*found, strict=True)
    return np.concatenate(panels_), np.concatenate(t), np.concatenate(weight)


def _kernels(place: Array, points: Array) -> Array:
    """Return the velocities at a point by rings of unit forces per length, (14, rings).

    These are rr, rz, zr, zz and pp for m = 0, the first letter of the velocity, and then the nine
    for m = 1, in the order r, p, z.
    """
    (r0, z0), (r, z) = place, points.T
    apart2 = (r - r0) ** 2 + (z - z0) ** 2
    modulus = np.maximum(np.sqrt(apart2 / (apart2 + 4 * r * r0)), _NEAREST)
    # K/K' about as the logarithm of the modulus
    ratio = np.log(4 / modulus) / math.pi * 2
    kernels = np.empty((14, r.size))
    lowest = -math.inf
    for count, largest in _ROUND:
        chosen = (ratio > lowest) & (ratio <= largest)
        lowest = largest
        if chosen.any():
            sine, cosine, weight = _angles(modulus[chosen], count)
            kernels[:, chosen] = _round(place, points[chosen], sine, cosine, weight)
    return kernels * r


def _angles(modulus: Array, count: int) -> tuple[Array, Array, Array]:
    """Return sin and cos of psi/2, and weights of an integral over psi, (n, count) each.

    `modulus` is the complementary modulus k' of the amplitude.
    """
    a, b = np.ones_like(modulus), modulus
    ratios = []
    for _ in range(_MEANS):
        a, b, c = (a + b) / 2, np.sqrt(a * b), (a - b) / 2
        ratios.append((c / a)[:, None])
    quarter = math.pi / (2 * a)
    part = (np.arange(count) + 0.5) / count
    angle = np.broadcast_to(2**_MEANS * math.pi / 2 * part, (modulus.size, count))
    for ratio in reversed(ratios):
        angle = (angle + np.arcsin(ratio * np.sin(angle))) / 2
    cosine, sine = np.sin(angle), np.cos(angle)
    dn = np.hypot(sine, modulus[:, None] * cosine)
    return sine, cosine, 4 * dn * (quarter / count)[:, None]


def _round(place: Array, points: Array, sine: Array, cosine: Array, weight: Array) -> Array:
    """Return the integrals of `_kernels` round the axis, without the radius of the ring."""
    (r0, z0), (r, z) = place, (points.T)[:, :, None]
    c, s = 1 - 2 * sine**2, 2 * sine * cosine
    x, y, h = (r0 - r) + 2 * r * sine**2, -r * s, z0 - z
    square = (r0 - r) ** 2 + 4 * r * r0 * sine**2 + h**2
    single = weight / np.sqrt(square)
    cube = single / square
    xx, yy, zz = single + cube * x * x, single + cube * y * y, single + cube * h * h
    xy, xz, yz = cube * x * y, cube * x * h, cube * y * h
    # columns: forces along r, phi and z of the ring
    of_r = xx * c + xy * s, xy * c + yy * s, xz * c + yz * s
    of_p = -xx * s + xy * c, -xy * s + yy * c, -xz * s + yz * c
    of_z = xz, yz, zz
    each = [of_r[0], of_z[0], of_r[2], of_z[2], of_p[1],
            of_r[0] * c, of_p[0] * s, of_z[0] * c,
            -of_r[1] * s, of_p[1] * c, -of_z[1] * s,
            of_r[2] * c, of_p[2] * s, of_z[2] * c]  # fmt: skip
    return np.stack([one.sum(axis=1) for one in each])
