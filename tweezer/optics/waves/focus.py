"""The light behind the lens as plane waves in phase at the focus (Debye's integral).

A plane wave along s, of azimuth phi and polar angle theta, carries the power per solid angle
W(theta) of `tweezer.optics.beam.cone`. Its field is split into helicities,
e_+- = (e_theta +- i e_phi)/sqrt(2). The Jones vector (a, b) of the pupil gives them the amplitudes
c_+- exp(+-i phi), c_+- = (a -+ ib)/sqrt(2). Light of helicity +-1 has the angular momentum
J_z = +-1 per photon, in units of hbar, about the axis. A vortex exp(i l phi) adds l.

A plane face before the focus (`lens.cover`) changes the amplitudes of the parts along e_theta and
e_phi by different factors, which mixes the helicities (Torok, Varga, Laczik and Booker, J. Opt.
Soc. Am. A 12, 325, 1995).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.generated import waves
from tweezer.optics.beam import Cone, behind_face
from tweezer.optics.waves.pupil import Pupil
from tweezer.values.arrays import Array

ComplexArray = NDArray[np.complex128]


class Part(NamedTuple):
    """Part of the light: its plane waves of one helicity and one angular momentum."""

    helicity: int
    """+1 or -1"""
    angular_momentum: int
    """J_z of a photon about the axis, in units of hbar"""
    coefficient: complex
    """of the Jones vector"""
    theta: complex
    """share of the light along e_theta in its amplitude"""
    phi: complex
    """share of the light along e_phi in its amplitude"""
    order: int | None = None
    """harmonic of the pupil's factor that its amplitude contains; None if it contains none"""

    @property
    def odd(self) -> bool:
        """Whether its integrand over the cone is odd in sin(theta), apart from the amplitude.

        Bessel functions and harmonics give it the parity of helicity + J_z.
        """
        return (self.helicity + self.angular_momentum) % 2 == 1

    def amplitude(self, theta: ComplexArray, phi: ComplexArray) -> ComplexArray:
        """Return the amplitude of this part of the light.

        `theta` and `phi` are amplitudes along e_theta and e_phi of plane waves of the whole light.
        """
        return np.asarray(self.theta * theta + self.phi * phi)


@dataclass(frozen=True)
class State:
    """A fully polarised part of the light. The forces of several states add up."""

    weight: float
    """share of the power"""
    parts: tuple[Part, ...]
    """its parts of one helicity and one angular momentum, whose amplitudes add up"""
    handedness: float = 1.0
    """-1 for the mirror image of these parts, y -> -y; 0 for equal shares of both"""

    @property
    def pure(self) -> bool:
        """Whether all of the state's light is of helicity +1."""
        return all(part.helicity > 0 for part in self.parts)


def states(
    polarisation: str,
    jones: Array,
    vortex: int,
    *,
    face: bool,
    uneven: bool = False,
    order: tuple[int, float] = (0, 0.0),
) -> tuple[State, ...]:
    """Return the polarised states whose forces add up to the force of the light in a pupil.

    Parameters
    ----------
    polarisation : str
        Polarisation of the beam.
    jones : ndarray, shape (4,)
        Jones vector of linear light as (re, im) pairs.
    vortex : int
        Vortex charge of the beam.
    face : bool
        Whether the light passes a plane face before the focus.
    uneven : bool, optional
        Whether the pupil's factor differs around the axis, so that it need not be its own mirror
        image.
    order : tuple of int and float, optional
        Order l and angle phi_0, rad, of cylindrical polarisation along (cos, sin)(l phi + phi_0).
    """
    if uneven:
        return _unmirrored(polarisation, jones, vortex, face, order)
    if polarisation == "cylindrical":
        turn, half = cmath.exp(1j * order[1]), math.sqrt(0.5)
        of_right = _parts(1, vortex - order[0], half / turn, face)
        of_left = _parts(-1, vortex + order[0], half * turn, face)
        return (State(1.0, of_right + of_left),)
    if polarisation in ("radial", "azimuthal"):
        along, half = polarisation == "radial", math.sqrt(0.5)
        plus, minus = (
            Part(helicity, vortex, 1.0, half * along, -1j * helicity * half * (not along))
            for helicity in (1, -1)
        )
        return (State(1.0, (plus, minus)),)
    if polarisation == "linear":
        a, b = complex(*jones[:2]), complex(*jones[2:])
        right, left = (a - 1j * b) / math.sqrt(2), (a + 1j * b) / math.sqrt(2)
        least = 1e-14  # of the Jones vector's length
        if abs(left) < least:
            return _circular(vortex, face, abs(right) ** 2, 1.0)
        if abs(right) < least:  # the mirror image of circular light, and of its vortex
            return _circular(-vortex, face, abs(left) ** 2, -1.0)
        return (State(1.0, _parts(1, vortex, right, face) + _parts(-1, vortex, left, face)),)
    if polarisation == "circular":
        return _circular(vortex, face, 1.0, 1.0)
    if vortex == 0:
        return _circular(0, face, 1.0, 0.0)
    return _circular(vortex, face, 0.5, 1.0) + _circular(-vortex, face, 0.5, -1.0)


def _unmirrored(
    polarisation: str, jones: Array, vortex: int, face: bool, order: tuple[int, float]
) -> tuple[State, ...]:
    """Return the states of the light, without mirror images."""
    if polarisation not in ("linear", "unpolarised"):
        return states(polarisation, jones, vortex, face=face, order=order)
    along_x_and_y = ((1.0, 0.0), (0.0, 1.0))
    vectors = along_x_and_y if polarisation == "unpolarised" else ((
        complex(*jones[:2]), complex(*jones[2:]),
    ),)  # fmt: skip
    found = []
    for a, b in vectors:
        both = ((1, (a - 1j * b) / math.sqrt(2)), (-1, (a + 1j * b) / math.sqrt(2)))
        parts = (part for l, c in both for part in _parts(l, vortex, c, face))
        found.append(State(1.0 / len(vectors), tuple(parts)))
    return tuple(found)


def of_harmonics(states: tuple[State, ...], orders: Sequence[int]) -> tuple[State, ...]:
    """Return states in light with harmonics q of the pupil's factor, which add q to J_z."""
    return tuple(
        State(each.weight, tuple(
            part._replace(angular_momentum=part.angular_momentum + q, order=q)
            for q in orders for part in each.parts
        ), each.handedness)
        for each in states
    )  # fmt: skip


def _circular(vortex: int, face: bool, weight: float, handedness: float) -> tuple[State, ...]:
    """Return the one state of circular light of helicity +1, or of its mirror image.

    `weight` is its share of the power. `handedness` is -1 for the mirror image, 0 for both.
    """
    return (State(weight, _parts(1, vortex, 1.0, face), handedness),)


def _parts(helicity: int, vortex: int, coefficient: complex, face: bool) -> tuple[Part, ...]:
    """Return the parts of light that has one helicity in the pupil; a face adds the other one.

    `coefficient` is the amplitude of this helicity in the Jones vector.
    """
    j = vortex + helicity
    kept = Part(helicity, j, coefficient, 0.5, 0.5)
    turned = Part(-helicity, j, coefficient, 0.5, -0.5)
    return (kept, turned) if face else (kept,)


@dataclass(frozen=True)
class Face:
    """A plane face before the focus, between two media: the bead is in the one behind it."""

    before: float
    """refractive index in front of the face"""
    behind: float
    """refractive index behind it"""
    phase: float
    """k_0 times the distance from the face to the nominal focus"""


@dataclass(frozen=True)
class Focus:
    """Plane waves of a cone of light of 1 W.

    If a cover glass ends in front of the focus, the angles are measured in the medium behind it.
    """

    cone: Cone
    """in front of the face"""
    face: Face | None = None
    """plane face between the lens and the focus; None without one"""
    pupil: Pupil | None = None
    """phase over the pupil; None if it is even"""

    @property
    def half_angle(self) -> float:
        """Polar angle of the outermost wave, rad."""
        if self.face is None:
            return self.cone.half_angle
        return behind_face(self.cone.half_angle, self.face.before, self.face.behind)

    @property
    def inner(self) -> float:
        """Polar angle of the innermost wave, rad."""
        if self.face is None:
            return self.cone.inner
        return behind_face(self.cone.inner, self.face.before, self.face.behind)

    def amplitudes(self, below: Array) -> tuple[ComplexArray, ComplexArray]:
        """Return the amplitudes of the light along e_theta and e_phi at 1 - cos(theta) = `below`.

        They are in sqrt(1/sr), for light of 1 W that has the amplitude 1 along both in the pupil.
        """
        face, cone = self.face, self.cone
        if face is None:
            size = np.sqrt(cone.shape(below)).astype(np.complex128)
            return size, size
        cosine, below = 1 - below, self._in_front(below)
        before = 1 - below
        size = np.sqrt(cone.shape(below)).astype(np.complex128)
        along, across = waves.cover_amplitudes.py_func(before, cosine, face.before, face.behind)
        size *= np.exp(1j * face.phase * (face.behind * cosine - face.before * before))
        return size * along, size * across

    def harmonics(
        self, orders: Iterable[int | None], below: Array
    ) -> dict[int | None, ComplexArray]:
        """Return harmonics of the pupil's factor at 1 - cos(theta) = `below`; 1 for no order."""
        even = np.ones(len(below), np.complex128)
        if self.pupil is None:
            return dict.fromkeys(orders, even)
        found = self.pupil.harmonics(self._in_front(below))
        known: Sequence[int] = self.pupil.orders
        none = np.zeros(len(below), np.complex128)
        return {
            order: even if order is None else found[order] if order in known else none
            for order in orders
        }

    def factor(self, below: Array, phi: Array) -> ComplexArray:
        """Return the pupil's factor at 1 - cos(theta) = `below` (n,) and azimuths (m,), (n, m)."""
        assert self.pupil is not None  # an even pupil has no factor
        return self.pupil.factor(self.pupil.radius(self._in_front(below)), phi)

    def _in_front(self, below: Array) -> Array:
        """Return 1 - cos(theta) in front of the face, of waves with `below` behind it."""
        if self.face is None:
            return below
        squared = below * (2 - below) * (self.face.behind / self.face.before) ** 2
        return np.asarray(squared / (1 + np.sqrt(np.maximum(1 - squared, 0.0))))
