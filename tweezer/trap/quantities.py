"""Quantities of a trap, and the words for the outcome of its bead."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tweezer.scene.theory import largest_wavenumber
from tweezer.values.measured import Quantity

if TYPE_CHECKING:
    from tweezer.scene import Scene

#: Outcomes of a bead in a trap
HELD, RESTS, LOST = "held", "rests on the wall", "not held"
ON_RING = "held on a ring"
#: Word for a trap that the bead can leave by less than `STABLE` along the easiest straight way
SHALLOW = "shallow"
#: Energy in k_B T above which a trap is usually called stable (A. Ashkin et al., Opt. Lett. 11,
#: 288 (1986))
STABLE = 10.0

#: Distance over which the force of ray optics may change, in radii
_RAYS = 0.02

EQUILIBRIUM = Quantity(
    "equilibrium", "m", "equilibrium relative to the focus", "axis",
    compared=True,
)  # fmt: skip
STIFFNESS = Quantity("stiffness", "N/m", "stiffness at the equilibrium", "axis", compared=True)
CORNER = Quantity("corner_frequency", "Hz", "corner frequency at the equilibrium", "axis")
RESONANCE = Quantity("resonance_frequency", "Hz", "resonance frequency along each axis", "axis")
QUALITY = Quantity("quality_factor", "1", "quality factor of this resonance", "axis")
RING = Quantity("ring_radius", "m", "radius of the ring on which the bead is held")
ESCAPE_FORCE = Quantity(
    "escape_force", "N", "largest restoring force on the way out", "direction", compared=True
)
ESCAPE_ENERGY = Quantity(
    "escape_energy", "J", "work of pulling the bead out", "direction", compared=True
)
LIFETIME = Quantity("lifetime", "s", "mean time that thermal motion leaves the bead in the trap")
LEAST_PRESSURE = Quantity(
    "least_pressure", "Pa", "pressure of the gas above which a displaced bead comes to rest",
    compared=True, shown="Pa",
)  # fmt: skip
RECOIL_HEATING = Quantity(
    "recoil_heating", "W", "heating by the recoil of photons along each axis", "axis", shown="W"
)
TEMPERATURE = Quantity(
    "temperatures", "K", "temperature of the motion along each axis in a thin gas", "axis"
)
FORCE_ERROR = Quantity("force_error", "N", "largest error of the force of the light", kind="")
POWER = Quantity(
    "power_through_the_pupil", "W", "power through the pupil", swept=False, compared=True
)
QUANTITIES = (
    EQUILIBRIUM, STIFFNESS, CORNER, RESONANCE, QUALITY, RING, ESCAPE_FORCE, ESCAPE_ENERGY,
    LIFETIME, LEAST_PRESSURE, RECOIL_HEATING, TEMPERATURE, FORCE_ERROR, POWER,
)  # fmt: skip
ROTATIONAL_STIFFNESS = Quantity(
    "rotational_stiffness", "N m", "stiffness against rotation at the equilibrium", "axis",
    swept=False, compared=True,
)  # fmt: skip
ROTATION = Quantity(
    "rotation", "rad/s", "angular velocity of the steady rotation at the equilibrium", "axis",
    swept=False, compared=True,
)  # fmt: skip
#: Quantities of the trap of a body that is not a sphere
OF_BODY = (
    EQUILIBRIUM, STIFFNESS, ROTATIONAL_STIFFNESS, ROTATION, ESCAPE_FORCE, ESCAPE_ENERGY,
    FORCE_ERROR,
)  # fmt: skip


def gradient_of_errors(scene: Scene) -> float:
    """Return the largest gradient of a force error divided by this error, 1/m.

    With wave optics of wavenumber k, the force and its error contain wavenumbers up to 2k. The
    gradient is therefore at most 2k times the largest value (S. Bernstein's inequality). Ray optics
    has no such bound.
    """
    if scene.theory == "waves":
        return 2 * largest_wavenumber(scene.medium, scene.beams)
    return 1 / (_RAYS * scene.body.size)
