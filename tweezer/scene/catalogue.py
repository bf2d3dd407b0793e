"""Common objectives and lasers of optical traps; docs/materials.md describes the sources."""

from __future__ import annotations

from typing import NamedTuple


class Objective(NamedTuple):
    """An objective corrected for an infinite tube length."""

    name: str
    """magnification, numerical aperture and immersion, as engraved on the objective"""
    magnification: float
    numerical_aperture: float
    immersion: str
    """"water", "oil" or "air\""""
    tube_lens: float
    """focal length of the maker's tube lens, m"""
    example: str
    """a commercial objective with these numbers"""

    @property
    def focal_length(self) -> float:
        """Focal length, m: that of the tube lens divided by the magnification."""
        return self.tube_lens / self.magnification

    @property
    def pupil_radius(self) -> float:
        """Radius of the pupil, m: focal length times numerical aperture (Abbe's sine condition)."""
        return self.focal_length * self.numerical_aperture


class Laser(NamedTuple):
    """A laser line used in optical traps."""

    name: str
    wavelength: float
    """vacuum wavelength, m"""
    power: str
    """power through the pupil that `tweezer new` uses if none is given"""
    kind: str
    """description of the laser medium"""


#: Refractive index of immersion oil and cover glass (ISO 8036 has 1.518 at 546 nm)
GLASS = 1.518

OBJECTIVES = {
    each.name: each
    for each in (
        Objective("60x/1.20 water", 60, 1.2, "water", 0.2, "Nikon CFI Plan Apo VC 60x WI"),
        Objective("63x/1.20 water", 63, 1.2, "water", 0.1645, "Zeiss C-Apochromat 63x/1.2 W"),
        Objective("100x/1.30 oil", 100, 1.3, "oil", 0.2, "Nikon CFI Plan Fluor 100x Oil"),
        Objective("100x/1.40 oil", 100, 1.4, "oil", 0.18, "Olympus UPLSAPO 100x Oil"),
        Objective("100x/1.45 oil", 100, 1.45, "oil", 0.2, "Nikon CFI Plan Apo Lambda 100x Oil"),
        Objective("40x/0.75 air", 40, 0.75, "air", 0.2, "Nikon CFI Plan Fluor 40x"),
    )
}

LASERS = {
    each.name: each
    for each in (
        Laser("1064 nm", 1064e-9, "50 mW", "Nd:YAG or ytterbium-doped fibre"),
        Laser("980 nm", 980e-9, "50 mW", "diode"),
        Laser("850 nm", 850e-9, "30 mW", "diode"),
        Laser("830 nm", 830e-9, "30 mW", "diode or titanium-sapphire"),
        Laser("785 nm", 785e-9, "30 mW", "diode"),
        Laser("633 nm", 632.8e-9, "5 mW", "helium-neon"),
        Laser("532 nm", 532e-9, "20 mW", "frequency-doubled Nd:YAG"),
    )
}
