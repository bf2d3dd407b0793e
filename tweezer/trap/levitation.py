"""Levitation in gas: the drag that circulation requires, recoil heating, and temperatures.

Circulation: light whose force turns about an equilibrium drives a bead out on a spiral unless the
drag exceeds `tweezer.dynamics.linear.LinearMotion.least_drag`. In a gas of mean free path l the
drag on a sphere of radius r depends on the pressure p by Kn = l/r, which is proportional to 1/p.

Energies: a bead of mass m with the damping rate Gamma moves in the force -K x by

    x'' = -Gamma x' - (K/m) x + f/m,

where white forces f of the two-sided spectral density 2 m H heat it at the rate H, (3, 3) W.
With the eigenvalues kappa_j of K/m, their right vectors R and left vectors L = R^-1, the stationary
covariance of the velocity is R W R^H with

    W_jk = Gamma s N_jk/(2 Gamma^2 s + d^2),   N = (2/m) L H L^H,
    s = kappa_j + kappa_k*,   d = kappa_j - kappa_k*,

which follows from the vanishing derivatives of the second moments of z = L x and z'. It is exact at
any damping. Axes without coupling have the energy m <v_i^2> = H_ii/Gamma. A complex pair a +- i b
of K has a stationary motion if and only if m Gamma > |b| sqrt(m/a). Its energy is larger than
without circulation by 1/(1 - (b/Gamma)^2/(a m)).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from tweezer.dynamics import bound_once
from tweezer.dynamics.linear import turning
from tweezer.dynamics.shot_noise import recoil_at
from tweezer.fluid.medium import error_of_slip, medium
from tweezer.forces.equilibria import Equilibrium
from tweezer.scene.media import GASES, MEDIA, PRESSURES, drag_factors
from tweezer.trap import quantities as known
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError
from tweezer.values.measured import Measured
from tweezer.values.rounding import micrometres, with_uncertainty
from tweezer.values.shown import Row
from tweezer.values.vectors import Vector, fixed

if TYPE_CHECKING:
    from tweezer.scene import Scene

#: Millibar, Pa
_MBAR = 100.0
#: Knudsen number beyond which no pressure is searched
_THINNEST = 1e40
#: Relative step of the derivative of the drag over the Knudsen number
_STEP = 1e-4
#: Error of `tweezer.recoil`, relative to the largest entry
_OF_RECOIL = 1e-8
#: Generators of rotations about x, y and z: the matrices of e_x x v, e_y x v and e_z x v
_ROTATIONS = np.cross(np.eye(3)[:, None], np.eye(3)).transpose(0, 2, 1)


class Recoil(NamedTuple):
    """Heating by the recoil of photons at the equilibrium of a trap."""

    diffusion: Vector
    """momentum diffusion S, (3, 3) N^2 s"""
    error: Vector
    """errors of its diagonal, (3,) N^2 s: numerical, and the mean change over the thermal motion"""


class Trap(Protocol):
    """A characterised trap: the part of `tweezer.trap.trap.Trap` that levitation requires."""

    @property
    def scene(self) -> Scene:
        """Scene of the trap."""

    @property
    def equilibria(self) -> tuple[Equilibrium, ...]:
        """Equilibria, stable or not."""

    @property
    def equilibrium(self) -> Equilibrium | None:
        """Stable equilibrium nearest the focus."""

    @property
    def force_error(self) -> float:
        """Largest error of the forces, N."""

    @property
    def least_drag(self) -> float | None:
        """Drag above which every displacement decays, kg/s."""

    @property
    def least_pressure(self) -> float | None:
        """Pressure at which the gas has this drag, Pa."""

    @property
    def photon_recoil(self) -> Recoil | None:
        """Recoil of photons at the equilibrium."""

    @property
    def recoil_heating(self) -> Vector | None:
        """Heating of each axis by recoil, (3,) W."""

    @property
    def recoil_pressures(self) -> Vector | None:
        """Pressures at which the gas heats as much, (3,) Pa."""

    @property
    def temperatures(self) -> Vector | None:
        """Temperature of each axis, (3,) K."""


def pulling_back(trap: Trap) -> Equilibrium | None:
    """Return the equilibrium nearest the focus that pulls a bead back along every axis.

    The drag may be too small for the bead to come to rest there. Returns None without such an
    equilibrium.
    """
    found = (each for each in trap.equilibria if each.stable or each.spiral_rate > 0)
    return min(found, key=lambda each: float(np.linalg.norm(each.position)), default=None)


def least_drag(trap: Trap) -> float | None:
    """Return the drag above which every displacement decays, kg/s; see `Trap.least_drag`."""
    place = pulling_back(trap)
    return None if place is None else bound_once(trap.scene).linear.least_drag(place.stiffness)


def least_drag_error(trap: Trap) -> float:
    """Return the error of `least_drag`, kg/s, from that of the force.

    Near the coupling at which two real eigenvalues of the stiffness meet, a difference of two
    stiffnesses counts as much as twice the push around the axis.
    """
    place = pulling_back(trap)
    assert place is not None
    linear = bound_once(trap.scene).linear
    change = 2 * trap.force_error * known.gradient_of_errors(trap.scene) * _ROTATIONS
    found = linear.least_drag(place.stiffness)
    others = [
        linear.least_drag(place.stiffness + sign * each) for each in change for sign in (1, -1)
    ]
    return max(abs(each - found) for each in others)


def in_named_gas(scene: Scene) -> bool:
    """Return whether the drag of a scene is that in a named gas at its pressure, without walls."""
    by_pressure = "mean_free_path" in scene.medium.filled
    return scene.medium.name in GASES and by_pressure and scene.wall is None


def pressure_of_drag(scene: Scene, drag: float) -> tuple[float, float]:
    """Return the pressure of a gas at which the bead has a drag, Pa, and its relative error.

    The pressure is 0 for no drag, and infinite for a drag that exceeds that at the highest pressure
    of a gas, `PRESSURES`. The error is that of the drag in a gas.

    Parameters
    ----------
    scene : Scene
        Scene with a sphere in a named gas (`in_named_gas`).
    drag : float
        Drag, kg/s.
    """
    from scipy.optimize import brentq  # loads slowly, and most traps do without

    gas, radius = scene.medium, scene.bead.radius
    assert gas.name is not None
    assert gas.pressure is not None
    accommodation = gas.accommodation or 1.0
    wanted = drag / (6 * math.pi * gas.viscosity * radius)
    product = gas.pressure * scene.knudsen  # it does not depend on the pressure

    def excess(log_knudsen: float) -> float:
        """Return the logarithm of the drag over the wanted one."""
        factor, _ = drag_factors(gas.name, math.exp(log_knudsen), accommodation)
        return math.log(factor / wanted)

    if wanted == 0:
        return 0.0, 0.0
    densest = math.log(product / PRESSURES[1])
    if excess(densest) <= 0:
        return math.inf, 0.0
    root = brentq(excess, densest, math.log(_THINNEST), xtol=1e-13)
    slope = (excess(root - _STEP) - excess(root + _STEP)) / (2 * _STEP)
    of_viscosity = MEDIA[gas.name].viscosity_error if "viscosity" in gas.filled else math.nan
    of_drag = math.hypot(of_viscosity, error_of_slip(math.exp(root), accommodation))
    return product / math.exp(root), of_drag / slope


def least_pressure(trap: Trap) -> tuple[float, float] | None:
    """Return the pressure of `Trap.least_pressure` and its error, Pa; None if it is not defined."""
    drag = trap.least_drag
    if drag is None or not in_named_gas(trap.scene):
        return None
    pressure, error = pressure_of_drag(trap.scene, drag)
    if pressure in (0.0, math.inf):
        return pressure, 0.0
    further, _ = pressure_of_drag(trap.scene, drag + least_drag_error(trap))
    return pressure, pressure * error + abs(further - pressure)


def photon_recoil(trap: Trap) -> Recoil | None:
    """Return the recoil at the equilibrium; None without one, and where `recoil` refuses it.

    The thermal motion has the temperature of the medium. Its mean change of the diffusion is half
    the sum of the second derivatives times the mean square displacements.
    """
    place = trap.equilibrium
    if place is None:
        return None
    try:
        there, beside = recoil_at(trap.scene, place.position, place.stiffness_xyz)
    except SceneError:
        return None
    mean_change = np.abs((beside - there).sum(axis=(0, 1)).diagonal() / 2)
    return Recoil(fixed(there), fixed(_OF_RECOIL * np.abs(there).max() + mean_change))


def recoil_heating(trap: Trap) -> Vector | None:
    """Return the heating of `Trap.recoil_heating`, (3,) W."""
    found = trap.photon_recoil
    if found is None:
        return None
    return fixed(found.diffusion.diagonal() / (2 * bound_once(trap.scene).bead.mass))


def recoil_pressures(trap: Trap) -> Vector | None:
    """Return the pressures of `Trap.recoil_pressures`, (3,) Pa."""
    heating, scene = trap.recoil_heating, trap.scene
    if heating is None or not in_named_gas(scene):
        return None
    drags = heating * bound_once(scene).bead.mass / (Boltzmann * scene.noise_temperature)
    return fixed(np.array([pressure_of_drag(scene, drag)[0] for drag in drags.tolist()]))


def steady_energies(rates: Array, damping: float, heating: Array) -> Array:
    """Return the steady energies m <v_i^2> of a damped bead, (3,) J.

    Without coupling of the axes they solve dE/dt = -Gamma E + H = 0. A thermal bath contributes
    Gamma k_B T to H. A process whose heating is proportional to the energy contributes its rate
    times E.

    Parameters
    ----------
    rates : ndarray, shape (3, 3)
        Stiffness over mass, 1/s^2.
    damping : float
        Damping rate Gamma, 1/s.
    heating : ndarray, shape (3, 3)
        Heating H, W, a symmetric matrix.
    """
    kappa, right = np.linalg.eig(rates)
    kappa = np.where(turning(kappa), kappa, kappa.real)
    left = np.linalg.inv(right)
    other = kappa.conj()
    total, difference = kappa[:, None] + other, kappa[:, None] - other
    noise = 2 * left @ heating @ left.conj().T
    moments = damping * total * noise / (2 * damping**2 * total + difference**2)
    return (right @ moments @ right.conj().T).diagonal().real


def temperatures(
    trap: Trap, *, drag_error: float = 0.0, recoil_error: Array | float = 0.0
) -> Vector | None:
    """Return the temperatures of `Trap.temperatures`, (3,) K.

    Parameters
    ----------
    trap : Trap
        The trap.
    drag_error : float, optional
        Relative error by which the drag is smaller.
    recoil_error : float or ndarray, shape (3,), optional
        Error of the diagonal of the momentum diffusion, N^2 s, by which it is larger.
    """
    found, place, scene = trap.photon_recoil, trap.equilibrium, trap.scene
    if found is None or place is None or scene.wall is not None:
        return None
    bead, thermal = bound_once(scene).bead, Boltzmann * scene.noise_temperature
    damping = bead.drag * (1 - drag_error) / bead.mass
    heating = damping * thermal * np.eye(3)
    heating += (found.diffusion + np.eye(3) * recoil_error) / (2 * bead.mass)
    return fixed(steady_energies(place.stiffness / bead.mass, damping, heating) / Boltzmann)


def temperatures_error(trap: Trap) -> Array:
    """Return the errors of `Trap.temperatures`, (3,) K, from drag, photon recoil and force.

    An error is infinite if the bead may not have a steady temperature.
    """
    found, usual = trap.photon_recoil, trap.temperatures
    assert found is not None
    assert usual is not None
    properties = medium(trap.scene)
    of_drag = properties.drag_error / properties.drag
    worst = temperatures(trap, drag_error=of_drag, recoil_error=found.error)
    assert worst is not None
    return np.where(worst < usual, np.inf, worst - usual)


def measured(trap: Trap) -> Iterator[Measured]:
    """Yield the quantities of levitation: the pressure, and recoil and temperatures in thin gas."""
    if (found := least_pressure(trap)) is not None:
        yield known.LEAST_PRESSURE(*found)
    heating, steady = shown(trap)
    if heating is not None and (recoiling := trap.photon_recoil):
        of_heating = recoiling.error / (2 * bound_once(trap.scene).bead.mass)
        yield known.RECOIL_HEATING(heating, of_heating)
    if steady is not None:
        yield known.TEMPERATURE(steady, temperatures_error(trap))


def shown(trap: Trap) -> tuple[Vector | None, Vector | None]:
    """Return recoil heating and temperatures if a result lists them: in a rarefied gas only."""
    if not trap.scene.rarefied:
        return None, None
    return trap.recoil_heating, trap.temperatures


def rows(trap: Trap) -> Iterator[Row]:
    """Yield the rows of a card about levitation in a gas."""
    if (found := least_pressure(trap)) is not None:
        pressure, error = found
        if pressure == 0:
            words = "any pressure"
        elif pressure == math.inf:
            words = f"no pressure up to {PRESSURES[1] / _MBAR:g} mbar"
        else:
            words = f"above {with_uncertainty(pressure / _MBAR, error / _MBAR)} mbar"
        place = pulling_back(trap)
        if place is not None and place is not trap.equilibrium:
            words += f", at z = {micrometres(place.position[2])} um"
        yield Row("stable at", words, of=known.LEAST_PRESSURE.name)
    heating, steady = shown(trap)
    if heating is not None:
        numbers = ", ".join(f"{each:.4g}" for each in heating)
        yield Row("recoil heating (x, y, z)", f"{numbers} W", of=known.RECOIL_HEATING.name)
    if heating is not None and (pressures := trap.recoil_pressures) is not None:
        numbers = ", ".join(f"{each / _MBAR:.3g}" for each in pressures)
        yield Row("  as much as the gas at", f"{numbers} mbar", detail=True)
    if steady is not None:
        numbers = ", ".join(f"{each:.4g}" for each in steady)
        yield Row("temperatures (x, y, z)", f"{numbers} K", of=known.TEMPERATURE.name)


def content_of(trap: Trap) -> dict[str, Any]:
    """Return the numbers of levitation in a gas as plain values, for the file of a trap.

    An infinite pressure is stored as null.
    """
    content: dict[str, Any] = {"least_drag": trap.least_drag, "least_pressure": trap.least_pressure}
    if trap.scene.rarefied:
        found = trap.photon_recoil
        content |= {
            "recoil_heating": trap.recoil_heating,
            "recoil_pressures": trap.recoil_pressures,
            "temperatures": trap.temperatures,
            "photon_recoil": found and found._asdict(),
        }
    return content
