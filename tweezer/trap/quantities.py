"""Numbers of a trap, with the errors that follow from that of the force."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from tweezer.scene.theory import largest_wavenumber
from tweezer.values.measured import Measured, Quantity

if TYPE_CHECKING:
    from tweezer.scene import Scene
    from tweezer.trap.trap import Trap

#: What becomes of a bead
HELD, RESTS, LOST = "held", "rests on the wall", "not held"
ON_RING = "held on a ring"
#: Word of a trap out of which the easiest straight way takes less than `STABLE`
SHALLOW = "shallow"
#: Energy in k_B T above which a trap is usually called stable (A. Ashkin et al., Opt. Lett. 11,
#: 288 (1986))
STABLE = 10.0

#: Distance over which the force of rays is taken to change, in radii
_RAYS = 0.02

EQUILIBRIUM = Quantity(
    "equilibrium", "m", "stable equilibrium nearest the focus, measured from it", "axis",
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
FORCE_ERROR = Quantity("force_error", "N", "largest error of the force of the light", kind="")
POWER = Quantity(
    "power_through_the_pupil", "W", "power through the pupil", swept=False, compared=True
)
QUANTITIES = (
    EQUILIBRIUM, STIFFNESS, CORNER, RESONANCE, QUALITY, RING, ESCAPE_FORCE, ESCAPE_ENERGY,
    LIFETIME, FORCE_ERROR, POWER,
)  # fmt: skip


def quantities_of(trap: Trap) -> Iterator[Measured]:
    """Numbers of a trap; see `Trap.quantities`."""
    place, ring, error = trap.equilibrium, trap.ring, trap.force_error
    if place is not None:
        of_stiffness = error * gradient_of_errors(trap.scene)
        yield EQUILIBRIUM(place.position, error / min(place.eigenvalues))
        yield STIFFNESS(place.stiffness_xyz, np.full(3, of_stiffness))
        relative = of_stiffness / np.abs(place.stiffness_xyz)
        for quantity, numbers, power in (
            (CORNER, trap.corner_frequencies, 1.0),
            (RESONANCE, trap.resonance_frequencies, 0.5),
            (QUALITY, trap.quality_factors, 0.5),
        ):
            if numbers is not None:
                yield quantity(numbers, numbers * power * relative)
    if ring is not None:
        yield RING(ring.radius, error / float(np.linalg.eigvals(ring.stiffness).real.min()))
    if place is not None:
        ways = trap.escapes
        lengths = np.array([each.range or each.wall_at or trap.reach for each in ways])
        yield ESCAPE_FORCE([each.force for each in ways], np.full(len(ways), error))
        yield ESCAPE_ENERGY(
            [each.energy for each in ways],
            [each.energy_error for each in ways] + error * lengths,
        )
    if "lifetime" in vars(trap) or trap.other_forces:
        held = trap.lifetime
        yield LIFETIME(held.time, held.error) if held else LIFETIME(None)
    yield FORCE_ERROR(error)
    yield POWER(trap.power_through_pupil, 0.0)


def outcome_of(trap: Trap) -> dict[str, str]:
    """What becomes of the bead in a word, why none is held, and what speaks against the numbers."""
    place, lifetime = trap.equilibrium, trap.lifetime_caveat
    caveats = [trap.caveat, lifetime and f"lifetime: {lifetime}"]
    ways = trap.ring.escapes if trap.ring else trap.escapes
    deep = min((each.energy_kT for each in ways), default=0.0) >= STABLE
    reason = trap.reason
    if trap.ring is not None:
        outcome, reason = ON_RING, trap.reason if trap.too_shallow else ""
    elif place is None:
        outcome = RESTS if trap.rests else LOST
    else:
        outcome = HELD
    if (trap.ring or place) and (trap.too_shallow or not deep):
        outcome = LOST if trap.too_shallow else SHALLOW
    return {"outcome": outcome, "reason": reason, "caveat": "; ".join(filter(None, caveats))}


def gradient_of_errors(scene: Scene) -> float:
    """Largest gradient of an error of the force that is nowhere larger than 1, 1/m.

    A force of waves of the wavenumber k holds wavenumbers up to 2k, and so does its error: the
    gradient is at most 2k times the largest value (S. Bernstein's inequality). Rays have no such
    bound.
    """
    if scene.theory == "waves":
        return 2 * largest_wavenumber(scene.medium, scene.beams)
    return 1 / (_RAYS * scene.bead.radius)
