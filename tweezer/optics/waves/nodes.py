"""Nodes over the cone of light: how many a bead at a place needs, and where they are.

The amplitudes of the light about a bead are integrals over the polar angle, by Gauss and Legendre.
Their integrand has a smooth factor, the amplitude of the light in the cone, and a factor of at most
`phase` radians: the bead's size and its distance from the focus. In Chebyshev series over the cone
the first has coefficients that are computed here, and the second those of exp(i (phase/2) x),
Bessel functions J_k(phase/2). So the degree of their product is known, and n nodes integrate
degrees below 2n.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from tweezer.optics.waves.focus import Focus
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

ComplexArray = NDArray[np.complex128]

#: Degree of the Chebyshev series for which the light in the cone is sampled; largest that is used
_MOST_DEGREES, _MOST_USED = 1024, 400
#: Largest error of the light's series, as a part of its peak
_LARGEST_ERROR = 1e-2
#: Number of nodes up to which the numbers tried grow by 4; above it they grow by an eighth
_FINE = 24
#: Largest number of phases for which the error of a number of nodes is computed
_MOST_ARGUMENTS = 256
#: Largest number of nodes
_MOST_NODES = 4096


@dataclass(frozen=True)
class Variable:
    """Variable of the integrals over the cone of light: 1 - cos(theta), or theta.

    theta is the angle of a plane wave to the axis.
    """

    half_angle: float
    """rad, of the cone"""
    of_angle: bool
    """whether the variable is theta"""
    inner: float = 0.0
    """rad, angle at which the light begins"""

    @property
    def phases(self) -> tuple[float, float]:
        """Largest phase over the cone for a bead 1/k off across, and 1/k off along the light, rad.

        The phase is k r.s of a plane wave along s at r. Its slope over the variable is largest on
        the axis for r across the light; the value is the phase of that slope over all of the cone.
        On the axis sin(theta) is 2 sin(theta_m/2) y, y^2 = (1 - cos(theta))/(1 - cos(theta_m)), and
        even functions of y are functions of y^2 of half the degree. For light that begins at an
        angle, the phases over the whole cone are upper bounds.
        """
        if self.of_angle:
            return self.half_angle, math.sin(self.half_angle) * self.half_angle
        return 2 * math.sin(self.half_angle / 2), 2 * math.sin(self.half_angle / 2) ** 2

    def at(self, x: Array) -> tuple[Array, Array]:
        """Return 1 - cos(theta) and the derivative of cos(theta) over x.

        x goes from -1, the rim of the cone, to 1, the axis or the angle at which light begins.
        """
        if self.of_angle:
            width = self.half_angle - self.inner
            theta = self.inner + width * (1 - x) / 2
            return 2 * np.sin(theta / 2) ** 2, np.sin(theta) * width / 2
        inner = 2 * math.sin(self.inner / 2) ** 2
        width = 2 * math.sin(self.half_angle / 2) ** 2 - inner
        return inner + width * (1 - x) / 2, np.full_like(x, width / 2)


@dataclass(frozen=True)
class Rule:
    """Nodes and weights of one integration rule, and the largest phase that they integrate."""

    below: Array
    """(n,) 1 - cos(theta), from the rim to the axis"""
    weight: Array
    """(n,) of the integral over cos(theta)"""
    largest_phase: float
    """rad"""
    focus: Focus | None = None
    """the light that it integrates; None for all light"""


@dataclass(frozen=True)
class Nodes:
    """Choice of nodes and weights for integrals over the cone of light, of any required phase.

    The integrand is the amplitude of the light times functions that turn by up to so many radians.
    """

    focus: Focus
    """the plane waves of the cone"""
    kinds: frozenset[tuple[int | None, bool]]
    """harmonic of the pupil of each part of the light, and whether the part is odd in sin(theta)
    (`Part.odd`)"""
    wanted: float
    """wanted error of an integral, as a part of the integral of the light's amplitude"""
    given: Variable | None = None
    """variable of integration; chosen if it is None"""
    degrees: int = _MOST_DEGREES
    """degree of the Chebyshev series for which the light is sampled"""

    @property
    def error(self) -> float:
        """Error of the integrals, as a part of the integral of the light's amplitude.

        It is larger than `wanted` if the series of the light does not converge so far.
        """
        return self._series[2]

    @functools.cached_property
    def shift(self) -> float:
        """Slope of the light's phase over 1 - cos(theta), rad: k times its focus's shift in z.

        It is fitted; a face before the focus moves it.
        """
        if self.focus.face is None:
            return 0.0
        below, _ = Variable(self.focus.half_angle, False, self.focus.inner).at(
            np.linspace(-1, 1, 2001)
        )
        along, across = self.focus.amplitudes(below)
        light = along + across
        turned = np.unwrap(np.angle(light))
        return float(np.polyfit(below, turned, 1, w=np.abs(light))[0])

    @functools.cached_property
    def _series(self) -> tuple[Variable, Array, float]:
        """The variable in which the light's amplitude needs fewer nodes, and its Chebyshev series.

        The series is given by the sizes of its coefficients and the error that these leave, both as
        parts of the largest amplitude.
        """
        if self.given is not None:
            return self.given, *self._coefficients(self.given)
        found = [
            (variable, *self._coefficients(variable))
            for variable in (
                Variable(self.focus.half_angle, each, self.focus.inner) for each in (False, True)
            )
        ]
        (_, few, error), (_, other, other_error) = found
        wide = 1.3 * len(other) + 8  # theta needs more nodes for the bead's part
        return found[0] if len(few) <= wide and error <= 2 * other_error else found[1]

    def _coefficients(self, variable: Variable) -> tuple[Array, float]:
        """Return the sizes of the light's Chebyshev coefficients over the cone, and their error.

        Coefficients of high degree that do not count are left out. Sizes and error are parts of the
        largest amplitude. Raises `SceneError` if the series converges too slowly.
        """
        n, used = self.degrees, min(_MOST_USED, 3 * self.degrees // 4)
        below, _ = variable.at(np.cos(np.pi * np.arange(n + 1) / n))
        along, across = self.focus.amplitudes(below)
        light = np.stack([along, across]) * np.exp(-1j * self.shift * below)
        sine = 1.0 if variable.of_angle else np.sqrt(below * (2 - below))
        harmonics = self.focus.harmonics({order for order, _ in self.kinds}, below)
        values = np.concatenate([
            light * harmonics[order] * (sine if odd else 1.0)
            for order, odd in sorted(self.kinds)
        ])  # fmt: skip
        rows = np.concatenate([values.real, values.imag])
        series = np.fft.rfft(np.concatenate([rows, rows[:, -2:0:-1]], axis=1)).real / n
        series[:, [0, -1]] /= 2
        sizes = np.abs(series).max(axis=0) / np.abs(values).max()
        tail = np.cumsum(sizes[::-1])[::-1]
        error = max(self.wanted, float(tail[used]))
        if error > _LARGEST_ERROR and variable.of_angle:
            cause = "beam.profile" if self.focus.face is None else "lens.cover.depth"
            if self.focus.pupil is not None:
                cause = "beam"
            raise SceneError(
                f"{cause}: the light behind the lens is too uneven for wave optics; a series of "
                f"degree {used} differs by {error:.2g} of its peak, allowed: "
                f"{_LARGEST_ERROR:g}"
            )
        # those of high degree are rounding
        least = max(0.1 * error, 2 * float(tail[used]))
        return sizes[: max(1, int((tail > least).sum()))], error

    @functools.cached_property
    def variable(self) -> Variable:
        """Variable of integration in which the light's amplitude is the smoother one."""
        return self._series[0]

    def up_to(self, phase: float) -> list[Rule]:
        """Return rules in the order of their number of nodes, the last for at least `phase`, rad.

        Raises `SceneError` if they are too many.
        """
        rules: list[Rule] = []
        count = 4
        while not rules or rules[-1].largest_phase < phase:
            if count > _MOST_NODES:
                raise SceneError(
                    f"lens, beam: the light's waves differ so much that {_MOST_NODES} nodes over "
                    "the cone do not describe them"
                )
            largest = self._largest_phase(count)
            if largest >= 0.0:
                x, weight = _gauss(count)
                below, slope = self.variable.at(x)
                rules.append(Rule(below, weight * slope, largest))
            count += 4 if count < _FINE else max(4, count // 32 * 4)
        return rules

    def _largest_phase(self, count: int) -> float:
        """Return the largest phase that `count` nodes integrate to the allowed error, rad.

        It is below 0 if they do not even integrate light without a phase.
        """
        sizes = self._series[1]
        degrees = 2 * count
        if degrees <= len(sizes) and sizes[degrees - 1 :].sum() > self.error:
            return -1.0
        # the phases x up to 2 n at which the integrand's coefficients are below the error
        arguments, tail = _tails(degrees)
        of_degree = np.maximum(degrees - np.arange(len(sizes)), 0)
        good = np.flatnonzero(sizes @ tail[of_degree] < self.error)
        return 2.0 * float(arguments[good[-1]]) if good.size else -1.0


#: Nodes and weights of Gauss and Legendre by their number: the same for every light
_gauss = functools.lru_cache(maxsize=128)(leggauss)


@functools.lru_cache(maxsize=64)
def _tails(degree: int) -> tuple[Array, Array]:
    """Return arguments x (n,) up to `degree`, and the sums over k >= j of 2 |J_k(x)|.

    Row j of the sums, (degree + 1, n), is a bound. It limits the part of exp(i x y) that a
    Chebyshev series in y omits beyond degree j - 1. The Bessel functions J_k come from Miller's
    recurrence, downward from an order at which they are negligible.
    """
    x = np.linspace(0.0, degree, min(2 * degree, _MOST_ARGUMENTS) + 1)[1:]
    extra = degree + 30 + int(3 * degree ** (1 / 3))
    values = np.zeros((extra + 2, len(x)))
    values[extra] = 1e-300
    for k in range(extra, 0, -1):
        values[k - 1] = 2 * k / x * values[k] - values[k + 1]
        # rescale columns before they overflow: their common factor is divided out at the end
        large = np.abs(values[k - 1]) > 1e200
        if large.any():
            values[:, large] *= 1e-200
    values /= values[0] + 2 * values[2::2].sum(axis=0)
    return x, 2 * np.cumsum(np.abs(values[::-1]), axis=0)[::-1][: degree + 1]
