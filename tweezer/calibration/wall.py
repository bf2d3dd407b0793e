"""Height of a bead above a wall, and its effect on the drag along each axis."""

from __future__ import annotations

from dataclasses import dataclass

from tweezer.values.errors import ResultError
from tweezer.values.units import QuantityLike, to_si

#: Largest standard uncertainty of a height, over the gap
_UNSURE = 0.3
#: Axis along the light, perpendicular to the wall
ACROSS = "z"


@dataclass(frozen=True)
class Height:
    """Height of a bead's centre above a wall perpendicular to the beam."""

    distance: float
    """distance of the bead's centre from the wall, m"""
    uncertainty: float
    """standard uncertainty of `distance`, m"""
    radius: float
    """radius of the bead, m"""

    @classmethod
    def of(
        cls, name: str, wall: QuantityLike | tuple[QuantityLike, QuantityLike], radius: float | None
    ) -> Height:
        """Return the height from a number in m or a text, optionally with an uncertainty.

        `name` is the name of the recording, for messages, and `radius`, m, the radius of the bead.
        Raises `ResultError` for a bead that would be in the wall, without a radius, and for an
        uncertainty comparable to the gap.
        """
        from tweezer.forces.wall import CLOSEST

        if radius is None:
            raise ResultError(f"{name}: wall: requires the bead's radius too")
        told = wall.replace("±", "+-").split("+-") if isinstance(wall, str) else wall
        parts = told if isinstance(told, list | tuple) else (told,)
        try:
            if not 1 <= len(parts) <= 2:
                raise ValueError(
                    'must be a height, optionally with its uncertainty: "1.2 um +- 50 nm"'
                )
            distance, uncertainty = (to_si(each, "m") for each in (*parts, 0.0)[:2])
        except ValueError as error:
            raise ResultError(f"{name}: wall = {wall!r}: {error}") from None
        if distance < radius + CLOSEST:
            raise ResultError(
                f"{name}: wall = {distance:g}: must exceed the bead's radius, {radius:g} m, by the "
                "size of an atom, because it is the distance of the bead's centre"
            )
        if not 0 <= uncertainty <= _UNSURE * (distance - radius):
            raise ResultError(
                f"{name}: wall = {wall!r}: its uncertainty must be from 0 to {_UNSURE:g} of the "
                "gap; omit the wall to fit the drag instead"
            )
        return cls(distance, uncertainty, radius)

    @property
    def radii(self) -> float:
        """Distance from the wall in bead radii."""
        return self.distance / self.radius

    def mobility(self, axis: str) -> float:
        """Return the mobility along an axis over the mobility far from the wall."""
        from tweezer.fluid import steady

        return steady(self.radii - 1)[int(axis == ACROSS)]

    def relative_uncertainty(self, axis: str) -> float:
        """Return the relative uncertainty of the drag along an axis, from that of the height."""
        from tweezer.fluid import steady

        *mobility, along, across = steady(self.radii - 1)
        slope = (along, across)[int(axis == ACROSS)] / self.radius
        return abs(slope) / mobility[int(axis == ACROSS)] * self.uncertainty
