"""Minimum power that holds a bead in its trap for a given time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from tweezer.scene import SceneLike, checked_scene
from tweezer.scene.arguments import in_si
from tweezer.trap.holding import DEEP, LONGEST, Lifetime, adds_nothing
from tweezer.trap.trap import Trap, sphere_trap
from tweezer.values.errors import SceneError, warn
from tweezer.values.prefixes import usual_unit
from tweezer.values.rounding import with_uncertainty
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.units import QuantityLike

#: Range of powers in which the minimum is sought, W
_LEAST, _MOST = 1e-9, 100.0
#: Initial power of the search, W, and the logarithm of the factor between tried powers
_FIRST, _STRIDE = 1e-3, math.log(3.0)
#: Relative tolerance of the minimum power, and half the step for the derivative there
_POWER, _SLOPE = 1e-4, 1e-2
#: Shortest lifetime that may be required, s
_SHORTEST = 1e-6


@dataclass(frozen=True, repr=False)
class LeastPower(Shown):
    """Minimum power that holds a bead for a given time, as returned by `least_power`."""

    power: float
    """power through the pupil, W"""
    error: float
    """estimated error of `power`, W"""
    lifetime: Lifetime
    """mean time for which the trap holds the bead at this power"""
    without_light: Lifetime | None = None
    """mean time for which the bead stays within the same distance without light; None if `lifetime`
    is infinite"""
    no_trap_below: bool = False
    """whether there is no trap at all at slightly less power, because the light then does not carry
    the bead's weight. In this case `lifetime` is longer than required"""

    def card(self) -> Card:
        """Return the card with the minimum power, and the lifetimes with and without light."""
        factor, unit = usual_unit(self.power, "W")
        power = f"{with_uncertainty(self.power / factor, self.error / factor)} {unit}"
        below = "below it there is no equilibrium" if self.no_trap_below else ""
        rows = [
            Row("power through the pupil", power, below), Row("held for", self.lifetime.told)
        ]  # fmt: skip
        if self.without_light is not None:
            words = self.without_light.told
            rows.append(
                Row("without light", words, adds_nothing(self.lifetime, self.without_light))
            )
        return Card("LeastPower", "", tuple(rows))


def least_power(scene: SceneLike, time: QuantityLike = "1 h") -> LeastPower | None:
    """Return the minimum power through the pupil at which the trap has a given lifetime.

    The scene's own power is ignored. Returns None if the lifetime is shorter at every power up to
    100 W, which is far beyond the damage threshold of beads and lenses. A `PhysicsWarning` then
    describes the trap at 100 W.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with one beam that does not change in time.
    time : float or str
        Required `Trap.lifetime`, s or with a unit.

    Raises
    ------
    SceneError
        For several beams, no light, or light that changes in time; for a time that is not positive,
        or in which not even a free bead is lost.

    Returns
    -------
    LeastPower or None
        The power, with its error and the lifetime; None if no power up to 100 W suffices.

    Examples
    --------
    >>> least = tweezer.least_power("silica-1um", "1 h")
    >>> 1e-5 < least.power < 1e-3  # W
    True
    """
    from scipy.optimize import brentq

    wanted = in_si("time", time, "s", _SHORTEST, 0.1 * LONGEST)
    scene = checked_scene(scene)
    if scene.bead.shape != "sphere":
        raise SceneError(
            f"bead.shape = {scene.bead.shape!r}: lifetimes are computed for spheres; allowed: "
            "'sphere'"
        )
    if scene.heat is not None:
        raise SceneError(
            "heat: least power compares powers at one temperature; remove [heat] from the scene"
        )
    if not (scene.plain and scene.forces.optical) or scene.forces.dlvo is not None:
        raise SceneError(
            "least power: requires one beam at rest along z through the origin, forces.optical = "
            "true and no forces.dlvo"
        )

    def at(power: float) -> Trap:
        return sphere_trap(scene.of_power(power))

    def above(log_power: float) -> float:
        """Return ln(lifetime/required lifetime) at a power, given as the logarithm of watts."""
        found = at(math.exp(log_power)).lifetime
        if found is None or found.time == 0.0:
            return -DEEP
        return min(math.log(found.time / wanted), DEEP)

    most = math.log(_MOST)
    high = math.log(_FIRST)
    while above(high) < 0:
        if high == most:
            warn(
                "least power: the lifetime is shorter at every power from 1 mW to 100 W; "
                f"{_at_most(at)}"
            )
            return None
        high = min(high + _STRIDE, most)
    low = high - _STRIDE
    while above(low) > 0:
        low, high = low - _STRIDE, low
        if low < math.log(_LEAST):
            raise SceneError(
                f"time = {time!r}: a free bead stays within reach for longer than this; choose a "
                "longer time"
            )
    # add the tolerance, so that the power is on the side where the bead is held
    root = brentq(above, low, high, xtol=_POWER) + _POWER
    power, trap = math.exp(root), at(math.exp(root))
    found = trap.lifetime
    assert found is not None
    relative = 2 * _POWER
    before = above(root - _SLOPE)
    no_trap_below = before == -DEEP  # at that power the light does not carry a heavy bead
    if not no_trap_below:
        slope = (above(root + _SLOPE) - before) / (2 * _SLOPE)
        relative += math.log1p(found.error / found.time) / slope
    return LeastPower(
        power, power * relative, found, trap.lifetime_without_light, no_trap_below
    )  # fmt: skip


def _at_most(at: Callable[[float], Trap]) -> str:
    """Return a description of the trap at the largest power."""
    trap = at(_MOST)
    if trap.lifetime is not None:
        return f"at 100 W it is held for {trap.lifetime.told}"
    return f"at 100 W: {trap.reason or f'lifetime {trap.lifetime_caveat}'}"
