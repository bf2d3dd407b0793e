"""Medium about the bead in the summary of a page, with the temperatures in the light."""

from __future__ import annotations

import math
from collections.abc import Iterator

from tweezer.optics.heat import heated
from tweezer.scene import Scene
from tweezer.scene.sections import Medium
from tweezer.viewing.content import Row
from tweezer.viewing.rows import of_number, si

#: Millibar, Pa
_MBAR = 100.0


def of_the_medium(scene: Scene) -> Iterator[Row]:
    """Yield the line of the summary on the medium, and with heat those on the temperatures.

    The medium about the bead, the bead's surface and the thermal motion each have a temperature.
    Its error contains that of the absorbed power.
    """
    medium = scene.medium
    yield Row("medium", ", ".join([*_content(medium), f"{medium.temperature:.5g} K"]))
    if scene.heat is None:
        return
    hot = heated(scene).heating
    about = medium.temperature + hot.water
    for name, rise, error in (
        ("medium about the bead", 0.0, 0.0),
        ("surface of the bead", hot.bead, hot.bead_error),
        ("thermal motion", hot.noise, hot.noise_error),
    ):
        both = math.hypot(hot.water_error, error)
        yield of_number(f"temperature, {name}", about + rise, both, "K", in_tables=True)


def _content(medium: Medium) -> Iterator[str]:
    """Yield what a medium consists of, and the pressure of a gas, in words."""
    yield medium.name or f"viscosity {si(medium.viscosity, 'Pa s', 4)}"
    if medium.fraction is not None:
        yield f"mass fraction {medium.fraction:g}"
    if medium.molality is not None:
        yield f"{medium.molality:g} mol/kg"
    if medium.pressure is not None:
        yield f"{medium.pressure / _MBAR:.4g} mbar"
    if medium.viscoelastic:
        yield f"with {medium.relaxation_in_words}"
