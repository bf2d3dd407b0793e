"""The section of a scene for heating by the light."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, PrivateAttr

from tweezer.scene.courses import Section
from tweezer.scene.temperatures import Heating
from tweezer.values.units import PositiveLength, Quantity, SwitchOrRise


class Heat(Section):
    """Heating of the medium and of the bead by the light; none if not given."""

    light: SwitchOrRise = Field(
        True, description="whether the medium absorbs light, or its temperature rise at the focus "
        "per power in the sample. Gases do not absorb"
    )  # fmt: skip
    absorption: Annotated[float, Quantity("1/m", 0, 1e6)] | None = Field(
        None, description="absorption coefficient of the medium. Default: that of water from 500 "
        "to 1109 nm; required for other liquids"
    )  # fmt: skip
    distance: PositiveLength | None = Field(
        None, description="distance of the focus from the glass, which keeps its temperature. "
        "Default: that of the walls or of the cover"
    )  # fmt: skip
    bead: SwitchOrRise = Field(
        True, description="whether the light that a sphere absorbs heats it, or its temperature "
        "rise above the medium per power in the sample; in a gas the rise must be given"
    )  # fmt: skip
    conductivity: Annotated[float, Quantity("W/(m K)", 1e-3, 1e4)] | None = Field(
        None, description="thermal conductivity of the medium. Default: that of water; required "
        "for other liquids"
    )  # fmt: skip

    _found: Heating | None = PrivateAttr(None)

    @property
    def found(self) -> Heating | None:
        """Temperatures in the light of the scene; None before `tweezer.optics.heat` computes
        them.
        """
        return self._found

    def with_temperatures(self, found: Heating) -> Self:
        """Return this section with the temperatures in the light of its scene."""
        copy = self.model_copy()
        copy._found = found
        return copy
