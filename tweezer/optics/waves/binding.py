"""The waves of a beam and a sphere, as the compiled sums read them."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled.lanes import LANES
from tweezer.forces.data import Data, packed, renumbered
from tweezer.optics.waves.focus import Focus, Part, State
from tweezer.optics.waves.harmonics import elements, harmonics
from tweezer.optics.waves.kernel import (
    FLOOR,
    OF_ALL,
    STRENGTH,
    guarded_elements,
    guarded_sphere,
)
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.nodes import Nodes, Rule
from tweezer.optics.waves.sphere import mie_coefficients, weights
from tweezer.optics.waves.terms import nodes_of
from tweezer.values.arrays import Array

ComplexArray = NDArray[np.complex128]

#: Error of integrals and sums, as a part of the tolerance: the force is small beside the light
SMALL = 1e-3
#: Smallest error of integrals
ROUNDING = 2e-15
#: Force of the sums, in n_m P/c
UNIT = 4 * math.pi**2


@dataclass(frozen=True)
class Sums:
    """Data that the compiled sums over partial waves read, and the errors of their force."""

    data: Data
    """of `kernel.waves_kernel`"""
    floor: float
    """error of the force where it vanishes, in n_m P/c (refractive index, power, speed of light)"""
    allowed: float
    """wanted error of the force where it vanishes, in n_m P/c; below `floor` if the light's series
    does not converge so far"""

    def of_strength(self, strength: float) -> Sums:
        """Return these data with the power of the light changed; strength: its n_m P/c, N."""
        numbers = {
            STRENGTH: strength * UNIT, OF_ALL: strength, FLOOR: self.floor * strength,
        }  # fmt: skip
        return dataclasses.replace(self, data=renumbered(self.data, numbers))


def highest_degree(a: ComplexArray, b: ComplexArray, tolerance: float) -> int:
    """Return the degree up to which the Mie coefficients a, b (n = 1, 2, ...) count.

    Beyond it the sum of their sizes, with 2n + 1 as weight, is below `tolerance` of the largest.
    """
    n = np.arange(1, len(a) + 1)
    size = (2 * n + 1) * (np.abs(a) + np.abs(b))
    beyond = np.cumsum(size[::-1])[::-1]
    return int((beyond > tolerance * size.max()).sum())


def sums(light: Waves, tolerance: float, reach: float) -> Sums:
    """Return the data of the sums for the force on a bead up to `reach`, m, from the focus.

    light: waves and sphere. tolerance: relative, of the force.
    """
    small = max(SMALL * tolerance, ROUNDING)
    states = light.states if light.uneven else light.harmonic_states
    components = 1 if all(each.pure for each in states) else 2
    sphere, needed, highest = sphere_and_degree(light, small, components)
    light, nodes = nodes_of(light, small, reach)
    grid = uneven_grid(light, nodes, reach, needed + 1) if light.uneven else ()
    data = packed(
        light.strength * UNIT, light.strength, tolerance, nodes.error * light.strength,
        of_states(states), guarded_elements(np.stack(elements(highest))),
        sphere,
        *source(light, states, nodes, reach, highest, small), *grid,
    )  # fmt: skip
    return Sums(data, nodes.error, small)


def sphere_and_degree(light: Waves, small: float, components: int) -> tuple[Array, int, int]:
    """Return `kernel.Weights.sphere` of each component, and the degrees of sums and tables.

    The degrees are the one up to which the sphere scatters more than `small` of the light, and the
    highest of the tables, a multiple of `LANES` less one. There is one component if all light has
    the same helicity, else two.
    """
    x = light.size_parameter
    a, b = mie_coefficients(light.shells, light.wavenumber, int(x + 6 * x ** (1 / 3)) + 12)
    needed = highest_degree(a, b, small)
    stride = -(-(needed + 2) // LANES) * LANES
    highest = stride - 1
    a, b = (np.pad(each, (0, stride))[: highest - 1] for each in (a, b))
    U, V, K = weights(a, b, components)
    rows = np.stack([U.real, U.imag, V.real, V.imag, K], axis=1)
    sphere = guarded_sphere(np.pad(rows, ((0, 0), (0, 0), (1, stride - 1 - rows.shape[2]))))
    return sphere, needed, highest


def source(
    light: Waves, states: tuple[State, ...], nodes: Nodes, reach: float, highest: int, small: float
) -> tuple[Any, ...]:
    """Return the fields of `partial_waves.Source`, from which amplitudes P_nm are computed.

    Parameters
    ----------
    light : Waves
        Waves of the light; its radius is the one within which the bead stays.
    states : tuple of State
        Polarised parts of the light.
    nodes : Nodes
        Choice of nodes over the cone.
    reach : float
        Largest distance of the bead from the focus, m.
    highest : int
        Highest degree, a multiple of `LANES` less one.
    small : float
        Error of the sums, as a part of the light's amplitude.
    """
    stride = highest + 1
    rules = _rules(light, nodes, reach)
    firsts = np.abs(np.arange(-highest, highest + 1)) // LANES * LANES
    tables = [
        np.concatenate([
            of_order[:, first:].ravel()
            for of_order, first in zip(harmonics(highest, rule.below), firsts, strict=True)
        ])
        for rule in rules
    ]  # fmt: skip
    padded = [-(-len(rule.below) // LANES) * LANES for rule in rules]
    begins = np.concatenate([[0], np.cumsum(padded)])
    entries = np.concatenate([[0], np.cumsum([table.size for table in tables])])
    of_rules = np.array([
        [len(rule.below), many, rule.largest_phase, begin, entry]
        for rule, many, begin, entry in zip(rules, padded, begins, entries, strict=False)
    ])  # fmt: skip
    shift = nodes.shift
    parts = [part for state in states for part in state.parts]
    of_nodes = np.concatenate(
        [
            _of_nodes(rule.focus or light.focus, rule, shift, parts, many)
            for rule, many in zip(rules, padded, strict=True)
        ],
        axis=1,
    )
    half_angle = light.focus.half_angle
    # waves of one order m come from several harmonics, by Bessel functions of several orders
    dropped = small if light.pupil is not None else math.sqrt(small)
    return (
        light.wavenumber, shift, light.radius, half_angle, math.sin(half_angle),
        np.array(nodes.variable.phases), dropped, of_rules, of_nodes,
        np.concatenate(tables),
        np.array([
            (part.helicity, part.angular_momentum, part.coefficient.real, part.coefficient.imag)
            for part in parts
        ]),
        np.cumsum(stride - firsts) - (stride - firsts), highest,
    )  # fmt: skip


def uneven_grid(light: Waves, nodes: Nodes, reach: float, top: int) -> tuple[Any, ...]:
    """Return the fields of `grid.Grid` for an uneven pupil.

    The azimuths of a rule resolve the computed orders and all orders of the light about the
    farthest bead of the rule. The latter come from the pupil's factor and from a plane wave there.

    Parameters
    ----------
    light : Waves
        Waves of the light, with a pupil.
    nodes : Nodes
        Choice of nodes over the cone.
    reach : float
        Largest distance of the bead from the focus, m.
    top : int
        Highest order |m| that is computed.
    """
    assert light.pupil is not None
    most = top + max(abs(part.angular_momentum) for each in light.states for part in each.parts)
    least, (across, _) = light.size_parameter * light.focus.half_angle, nodes.variable.phases
    rules, factors, circles, at, turn = [], [], [], 0, 0
    for rule in _rules(light, nodes, reach):
        focus = rule.focus or light.focus
        assert focus.pupil is not None
        widest = max(map(abs, focus.pupil.orders))
        x = (rule.largest_phase - least) / across * math.sin(light.focus.half_angle)
        count = 2 * math.ceil((most + widest + x + 5 * x ** (1 / 3) + 8) / 2)
        phi = 2 * math.pi * np.arange(count) / count
        padded = -(-len(rule.below) // LANES) * LANES
        factor = np.zeros((count, 2, padded))
        values = focus.factor(rule.below, phi).T
        factor[:, 0, : len(rule.below)], factor[:, 1, : len(rule.below)] = values.real, values.imag
        rules.append((count, at, turn))
        factors.append(factor.ravel())
        circles += [np.cos(phi), np.sin(phi)]
        at, turn = at + factor.size, turn + 2 * count
    return np.array(rules, float), np.concatenate(factors), np.concatenate(circles), top, most


def _rules(light: Waves, nodes: Nodes, reach: float) -> list[Rule]:
    """Return the rules of nodes for beads up to `reach`, m, from the focus, fewest nodes first.

    A bead needs nodes for the phase over the cone that its size and its distance from the focus
    add up to. Rules too small for even a bead in the focus are left out, and also those with more
    nodes than a later one. Those of a mask may have them, because each has its own terms. The
    compiled sums have room for the nodes of the last rule.
    """
    least = light.size_parameter * light.focus.half_angle
    across, along = nodes.variable.phases
    most = least + light.wavenumber * reach * math.hypot(across, along)
    most += abs(nodes.shift) * along
    found: list[Rule] = []
    for rule in reversed(nodes.up_to(most)):
        if rule.largest_phase >= least and (not found or len(rule.below) <= len(found[0].below)):
            found.insert(0, rule)
    return found


def _of_nodes(focus: Focus, rule: Rule, shift: float, parts: list[Part], many: int) -> Array:
    """Return the nodes of a rule in the form of `Source.nodes`, (2 + 2 parts, many).

    The rows are 1 - cos(theta), sin(theta), and the real and imaginary part of the amplitude times
    weight for each part of the light, without the phase shift (1 - cos(theta)). The nodes are
    padded with zeros to `many`, whole lanes.
    """
    below = rule.below
    along, across = focus.amplitudes(below)
    turned = rule.weight * np.exp(-1j * shift * below)
    rows = [below, np.sqrt(below * (2 - below))]
    harmonics = focus.harmonics({part.order for part in parts}, below)
    for part in parts:
        light = part.amplitude(along, across) * turned * harmonics[part.order]
        rows += [light.real, light.imag]
    return np.pad(np.stack(rows), ((0, 0), (0, many - len(below))))


def of_states(states: tuple[State, ...]) -> Array:
    """Return the polarised states by the columns SHARE to HIGHEST of `kernel`, (states, 7)."""
    rows, begin = [], 0
    for state in states:
        end = begin + len(state.parts)
        momenta = [part.angular_momentum for part in state.parts]
        components = 1 if state.pure else 2
        rows.append((state.weight, state.handedness, components, begin, end,
                     min(momenta), max(momenta)))  # fmt: skip
        begin = end
    return np.array(rows, float)
