"""Zernike terms of a mask that reach a bead, and the nodes that they need.

Let the light of an evenly lit pupil have the factor R_n^m(rho) exp(i m phi). At a distance r from
the focus it is of the order of J_n(k r sin(theta_m)). A bead with waves of degrees up to N at r
is therefore reached by the terms of degrees n < N + k r sin(theta_m) + few alone. Let l_j be the
sizes of the Zernike terms of the remaining light, by their degree j. Let w_N be the part of the
bead's waves that counts, by their degree N. Terms of degree n and higher contribute less than

    sum_j l_j max_N w_N sum_(i >= n - N - j) 2 |J_i(k r sin(theta_m))|.

For a distance along the axis, the argument is k z (1 - cos(theta_m))/2 and the order is i/2.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass

import numpy as np

from tweezer.optics.waves.focus import Focus
from tweezer.optics.waves.light import Waves, waves_on_bead
from tweezer.optics.waves.nodes import Nodes, Rule
from tweezer.optics.waves.sphere import mie_coefficients
from tweezer.optics.zernike import gauss, radial_terms
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.shown import Row

#: Largest degree of the terms of a mask
MOST_TERMS = 480
#: Degree of the terms of the light without the mask, and number of radii at which it is sampled
_OF_LIGHT, _RADII = 240, 400
#: Degree for which light is sampled over the cone, in addition to twice the degree of its terms
_SAMPLED = 160
#: Smallest step of the largest phases of rules, and their smallest ratio
_STEP, _RATIO = 8.0, 1.4
#: Error of integrals as a part of the tolerance, and number of the next degrees that are reported
_SMALL, _NEXT = 1e-3, 16
#: Terms below this part of the largest are rounding
_ROUNDING = 1e-13
#: Smallest wanted error of the integrals, as a part of the integral of the light's amplitude
SMALLEST = 1e-12


@dataclass(frozen=True)
class NodesOfMask(Nodes):
    """Choice of nodes for light through a mask: each rule has the terms that count for its beads.

    Its light has all terms that count anywhere.
    """

    light: Waves | None = None
    """light with all terms of the mask"""
    bead: tuple[float, ...] = ()
    """part w_N of the bead's waves of degree N = 0, 1, ... that counts"""

    @functools.cached_property
    def sizes(self) -> Array:
        """Sizes l_n of the Zernike terms of the light without its mask, (degrees,)."""
        focus = self.focus
        assert focus.pupil is not None
        smooth = dataclasses.replace(focus, pupil=focus.pupil.without_mask)
        found = _by_degree(smooth, self.shift)
        found /= found.max()
        return found[: int(np.flatnonzero(found > _ROUNDING).max()) + 1]

    def degree(self, phase: float) -> int:
        """Return the degree up to which terms count where the distance from the focus adds a phase.

        `phase` is in rad, over the cone. Raises `SceneError` if it is too large.
        """
        from scipy.special import jv

        sine, below = math.sin(self.focus.half_angle), 2 * math.sin(self.focus.half_angle / 2) ** 2
        across, along = self.variable.phases
        k = np.arange(MOST_TERMS + 64)
        left_out = np.zeros(len(k))
        for values in (jv(k, phase * sine / across), jv(k / 2, phase * below / along / 2)):
            left_out = np.maximum(left_out, 2 * np.cumsum(np.abs(values[::-1]))[::-1])
        left_out = np.minimum(left_out, 1.0)
        few = np.max([
            part * np.concatenate([np.ones(N), left_out])[: len(k)]
            for N, part in enumerate(self.bead)
        ], axis=0)  # fmt: skip
        bound = np.array([
            self.sizes[: n + 1] @ few[n - np.arange(min(n + 1, len(self.sizes)))]
            + self.sizes[n + 1 :].sum()
            for n in range(MOST_TERMS)
        ])  # fmt: skip
        good = np.flatnonzero(bound < self.wanted)
        if not good.size:
            assert self.focus.pupil is not None
            assert self.focus.pupil.mask is not None
            raise SceneError(
                f"beam.{self.focus.pupil.mask.key}: more than {MOST_TERMS} orders of its light "
                "count so far from the focus; choose a shorter simulation.loss_distance"
            )
        return int(good[0])

    def up_to(self, phase: float) -> list[Rule]:
        """Return rules for growing phases, each with its own terms; see `Nodes.up_to`."""
        while not self._rules or self._rules[-1].largest_phase < phase:
            self._rules.append(self._next())
        return self._rules

    @functools.cached_property
    def _rules(self) -> list[Rule]:
        """Rules that are known."""
        return []

    def _next(self) -> Rule:
        """Return the rule for larger phases than all that are known."""
        assert self.light is not None
        assert self.focus.pupil is not None
        least = self.light.size_parameter * self.light.focus.half_angle
        largest = self._rules[-1].largest_phase if self._rules else least
        largest = max(largest + _STEP, _RATIO * largest)
        pupil = self.focus.pupil.up_to(self.degree(largest - least))
        light = dataclasses.replace(self.light, pupil=pupil)
        degrees = _SAMPLED + 2 * pupil.degree
        nodes = Nodes(light.focus, light.kinds, self.wanted, self.variable, degrees)
        rule = nodes.up_to(largest)[-1]
        return dataclasses.replace(rule, largest_phase=largest, focus=light.focus)


def nodes_of(
    light: Waves, small: float, reach: float, change: Array | None = None
) -> tuple[Waves, Nodes]:
    """Return the light that counts for a bead up to `reach`, m, from the focus, and its nodes.

    Parameters
    ----------
    light : Waves
        The light and the bead.
    small : float
        Error of integrals, as a part of the light's amplitude.
    reach : float
        Largest distance of the bead from the focus, m.
    change : ndarray, shape (degrees,), optional
        Sizes of S - 1 by the degree of waves, from 1, with the scattering matrix S of the bead.
        Default: those of the sphere.
    """
    if light.pupil is None or light.pupil.mask is None:
        return light, Nodes(light.focus, light.kinds, small)
    small = max(small, SMALLEST)
    if change is None:
        x = light.size_parameter
        a, b = mie_coefficients(light.shells, light.wavenumber, int(x + 6 * x ** (1 / 3)) + 12)
        change = 2 * np.maximum(np.abs(a), np.abs(b))
    variable = Nodes(light.focus, light.kinds, small).variable
    padded = np.minimum(np.pad(change, 2), 1.0)
    # the force couples waves of neighbouring degrees
    bead = tuple(np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:]).tolist())
    nodes = NodesOfMask(light.focus, light.kinds, small, variable, light=light, bead=bead)
    across, along = variable.phases
    far = light.wavenumber * reach * math.hypot(across, along) + abs(nodes.shift) * along
    whole = dataclasses.replace(light, pupil=light.pupil.up_to(nodes.degree(far)))
    return whole, dataclasses.replace(nodes, focus=whole.focus, kinds=whole.kinds, light=whole)


def _by_degree(focus: Focus, shift: float) -> Array:
    """Return the root mean squares of Zernike terms of the light over the pupil, (degrees,).

    The light is that per area of the pupil, along e_theta and e_phi, without the phase
    `shift` (1 - cos(theta)), and also its product with cos(theta).
    """
    pupil, face = focus.pupil, focus.face
    assert pupil is not None
    x, weight = gauss(_RADII)
    rho, weight = (x + 1) / 2, weight / 2
    sine = rho / pupil.scale
    if pupil.tangent:
        sine = sine / np.hypot(1.0, sine)
    cosine = np.sqrt((1 - sine) * (1 + sine))
    behind = sine if face is None else np.minimum(sine * face.before / face.behind, 1.0)
    cosine_behind = np.sqrt((1 - behind) * (1 + behind))
    area = (cosine**4 if pupil.tangent else 1.0) / np.maximum(cosine_behind, 1e-9)
    below = behind**2 / (1 + cosine_behind)
    orders = pupil.orders
    found, of_order = np.zeros(_OF_LIGHT + 1), focus.harmonics(orders, below)
    for amplitude in focus.amplitudes(below):
        light = amplitude * area * np.exp(-1j * shift * below)
        for factor in (1.0, cosine_behind):
            harmonics = np.stack([light * factor * of_order[q] for q in orders], axis=1)
            terms = radial_terms(harmonics, np.array(orders), rho, weight, _OF_LIGHT)
            found = np.maximum(found, np.abs(terms).sum(axis=1))
    return found / np.sqrt(np.arange(1.0, _OF_LIGHT + 2))


@dataclass(frozen=True)
class MaskLight:
    """Light of a mask or sectors that reaches a bead near the focus, as Zernike terms of them."""

    key: str
    """mask or sectors"""
    degree: int
    """highest degree of the terms that count for a bead up to its radius from the focus"""
    share: float
    """share of the light's power in these terms; the rest is diffracted beyond the bead"""
    left_out: float
    """largest coefficient of the next degrees, as a root mean square over the pupil"""

    def row(self) -> Row:
        """Return the row of a table."""
        words = f"{100 * self.share:.3g} % of its light reaches the bead, in terms up to n = "
        return Row(
            self.key, f"{words}{self.degree}; largest coefficient left out {self.left_out:.2g}"
        )


def mask_light(scene: Scene) -> MaskLight | None:
    """Return the part of the light of a scene's only beam that reaches the bead; None if all does.

    A beam without mask and sectors, and bodies that are not spheres, have none.
    """
    key = scene.beam.pattern
    if scene.more_beams or key is None or scene.bead.shape != "sphere":
        return None
    light = waves_on_bead(scene)
    near, _ = nodes_of(light, _SMALL * scene.optics.tolerance, light.radius)
    pupil = near.pupil
    assert pupil is not None
    assert pupil.mask is not None
    n = np.arange(pupil.degree + _NEXT + 1)
    coefficients = np.abs(pupil.mask.terms(int(n[-1]))) / np.sqrt(n + 1.0)[:, None]
    left_out = float(coefficients[pupil.degree + 1 :].max())
    return MaskLight(key, pupil.degree, pupil.share(near.cone), left_out)
