"""Keys of light that interferes: coherent beams, their phases, and a mirror."""

from __future__ import annotations

from pydantic import Field

from tweezer.scene.courses import NAME, Phasing, Section
from tweezer.values.units import Angle, ComplexIndex, WallPosition


class OfCoherent(Section):
    """Base of a beam, with its phase relative to the beams that it interferes with."""

    coherent: str | None = Field(
        None, pattern=NAME, description="name shared by beams whose fields add; "
        "beams of different names, or without one, add their forces. Requires wave optics, and "
        "polarised light of one wavelength. Default: none"
    )  # fmt: skip
    phase: Angle = Field(0.0, description="phase of a coherent beam at its focus")
    phasing: Phasing | None = Field(
        None, description="phase of a coherent beam in time, added to `phase`. Default: constant"
    )


class Mirror(Section):
    """A plane mirror across the light. It reflects the light that meets it from the bead's side."""

    position: WallPosition = Field(
        description="height z of the plane relative to the origin of the scene"
    )
    refractive_index: ComplexIndex | None = Field(
        None, description="refractive index of the material behind the plane, which reflects by "
        "Fresnel's equations. Default: a perfect mirror"
    )  # fmt: skip
