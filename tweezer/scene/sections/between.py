"""Sections of a scene for what acts between several beads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from tweezer.scene.choices import told
from tweezer.scene.courses import NAME, Section, Vector, refusal
from tweezer.scene.laws import BETWEEN, TETHERS, check_keys
from tweezer.values.units import Energy, PositiveLength, Quantity, entries

Stiffness = Annotated[float, Quantity("N/m", 1e-12, 1e3)]
Gap = Annotated[float, Quantity("m", 0, 1e-3)]
BeadName = Annotated[str, Field(pattern=NAME)]
if TYPE_CHECKING:
    TetherName: TypeAlias = str
    BetweenName: TypeAlias = str
else:
    TetherName = Literal[tuple(TETHERS)]
    BetweenName = Literal[tuple(BETWEEN)]


class Tether(Section):
    """A molecule or a spring between the surfaces of two beads, or between a bead and a point."""

    model: TetherName = Field(description=f"law of its tension; {told(TETHERS.values())}")
    between: Annotated[tuple[BeadName, ...], entries(1, 2)] = Field(
        description="names of the beads; one bead if the other end is a `point`"
    )
    point: Vector | None = Field(None, description="fixed end of a tether of one bead")
    contour_length: PositiveLength | None = Field(None, description="contour length of a chain")
    persistence_length: PositiveLength | None = Field(
        None, description="persistence length of a chain; of a freely jointed one, half of Kuhn's"
    )
    stretch_modulus: Annotated[float, Quantity("N", 1e-15, 1e-3)] | None = Field(
        None, description="stretch modulus of a chain. Default: it cannot be stretched"
    )
    stiffness: Stiffness | None = Field(None, description="stiffness of a spring")
    length: Gap | None = Field(None, description="length of a spring at rest. Default: 0")

    @model_validator(mode="after")
    def _some_ends(self) -> Self:
        """Refuse other than two ends, and keys of another law."""
        if (len(self.between) == 1) != (self.point is not None):
            raise refusal("between: must name two beads, or one bead and a point")
        if len(set(self.between)) < len(self.between):
            raise refusal(f"between = {list(self.between)}: must name two different beads")
        keys = vars(self).keys() - {"model", "between", "point"}
        check_keys(TETHERS[self.model], "model", {key: getattr(self, key) for key in sorted(keys)})
        return self


class Between(Section):
    """A force between the surfaces of each two beads."""

    kind: BetweenName = Field(description=f"law of the force; {told(BETWEEN.values())}")
    strength: Energy | None = Field(
        None, description="energy at contact: B of the double layer, or that of WCA"
    )
    debye_length: PositiveLength | None = Field(
        None, description="Debye length l_D of the double layer"
    )
    hamaker_constant: Energy | None = Field(
        None, description="Hamaker constant A_H of the van der Waals attraction. Default: 0"
    )
    range: PositiveLength | None = Field(
        None, description="gap at which WCA would diverge behind contact, or at which soft layers "
        "begin to touch"
    )  # fmt: skip
    modulus: Annotated[float, Quantity("Pa", 1e-3, 1e13)] | None = Field(
        None, description="reduced elastic modulus E* of Hertz's contact"
    )
    stiffness: Stiffness | None = Field(None, description="stiffness of a spring between surfaces")
    gap: Gap | None = Field(None, description="gap at which a spring is at rest. Default: 0")

    @model_validator(mode="after")
    def _keys_of_the_kind(self) -> Self:
        """Refuse missing keys and keys of another kind."""
        keys = vars(self).keys() - {"kind"}
        check_keys(BETWEEN[self.kind], "kind", {key: getattr(self, key) for key in sorted(keys)})
        return self
