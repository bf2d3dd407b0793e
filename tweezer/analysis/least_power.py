"""The least power that holds a bead in its trap for a time."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tweezer.analysis.holding import DEEP, LONGEST, Lifetime
from tweezer.analysis.trap import Trap, characterise
from tweezer.arguments import in_si
from tweezer.errors import SceneError
from tweezer.rounding import with_uncertainty
from tweezer.scene import Scene
from tweezer.shown import Card, Row, Shown
from tweezer.units import QuantityLike, usual_unit

#: Powers between which the least one is sought, W
_LEAST, _MOST = 1e-9, 100.0
#: Power at which the search begins, W, and the factor by which it goes on, as a logarithm
_FIRST, _STRIDE = 1e-3, math.log(3.0)
#: Relative tolerance of the least power, and half the step of the slope there
_POWER, _SLOPE = 1e-4, 1e-2
#: Shortest time that a bead is asked to be held, s
_SHORTEST = 1e-6


@dataclass(frozen=True, repr=False)
class LeastPower(Shown):
    """The least power through the pupil that holds a bead for a time."""

    power: float
    """W"""
    error: float
    """estimated error, W"""
    lifetime: Lifetime
    """at that power"""

    def card(self) -> Card:
        """The power, and the lifetime there."""
        factor, unit = usual_unit(self.power, "W")
        power = f"{with_uncertainty(self.power / factor, self.error / factor)} {unit}"
        rows = Row("power through the pupil", power), Row("held for", self.lifetime.words)
        return Card("LeastPower", "", rows)


def least_power(scene: Scene, time: QuantityLike = "1 h") -> LeastPower | None:
    """The least power through the pupil at which the trap of `scene` holds its bead for a time.

    time: of `Trap.lifetime`, s or with its unit. The power of the scene plays no part. Returns None
    if the bead is not held for so long by any power up to 100 W, which is far beyond what beads and
    lenses survive. Raises `SceneError` for more than one beam, or one that moves or changes, for no
    light, for a time that is none, and for one in which even a free bead is not lost.
    """
    from scipy.optimize import brentq

    wanted = in_si("time", time, "s", _SHORTEST, 0.1 * LONGEST)
    if not (scene.plain and scene.forces.optical) or scene.forces.dlvo is not None:
        raise SceneError(
            "least power: needs one beam at rest along z through the origin, forces.optical = true "
            "and no forces.dlvo"
        )

    def at(power: float) -> Trap:
        return characterise(scene.of_power(power))

    def above(log_power: float) -> float:
        """Logarithm of the lifetime over the time wanted."""
        found = at(math.exp(log_power)).lifetime
        if found is None or found.time == 0.0:
            return -DEEP
        return min(math.log(found.time / wanted), DEEP)

    most = math.log(_MOST)
    high = math.log(_FIRST)
    while above(high) < 0:
        if high == most:
            return None
        high = min(high + _STRIDE, most)
    low = high - _STRIDE
    while above(low) > 0:
        low, high = low - _STRIDE, low
        if low < math.log(_LEAST):
            raise SceneError(f"time = {time!r}: so soon the bead is not lost even without a trap")
    # on the side of the beads that are held
    root = brentq(above, low, high, xtol=_POWER) + _POWER
    power, found = math.exp(root), at(math.exp(root)).lifetime
    assert found is not None
    relative = 2 * _POWER
    if (before := above(root - _SLOPE)) > -DEEP:  # or else a heavy bead has no trap there at all
        slope = (above(root + _SLOPE) - before) / (2 * _SLOPE)
        relative += math.log1p(found.error / found.time) / slope
    return LeastPower(power, power * relative, found)
